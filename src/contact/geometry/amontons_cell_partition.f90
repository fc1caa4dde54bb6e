!> The multipliers of a contact set: nodal, or constant on the cells of a partition of the contact line (the paper's
!> Lambda_H), and where the cells end.
module amontons_cell_partition
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: cell_partition_t, multiplier_names

   !> Kinds of multipliers, as a deck writes them: at the nodes, constant on cells, or at the corners of a pair's slave.
   character(8), parameter :: multiplier_names(*) = [character(8) :: 'nodal', 'constant', 'mortar']

   !> The multipliers of a contact set. Constant ones have equal cells, cells with given ends or, without either, a
   !> cell for every two sides.
   type :: cell_partition_t
      logical :: is_constant = .false. !! whether the multipliers are constant on cells; nodal otherwise
      integer :: n_cells = 0 !! number of equal cells on each piece of the line; 0 for none asked for
      real(dp), allocatable :: ends(:)
         !! where one cell ends and the next begins, ascending: lengths along the line; not allocated without [L]
   contains
      procedure :: cell_ends => cell_partition_cell_ends
   end type cell_partition_t

contains

   !> The ends of all cells of a piece of the line, from its beginning on.
   pure subroutine cell_partition_cell_ends(self, side_lengths, ends, error)
      class(cell_partition_t), intent(in) :: self !! the partition
      real(dp), intent(in) :: side_lengths(:) !! lengths of the sides of the piece, in order [L]
      real(dp), allocatable, intent(out) :: ends(:) !! 0 and the end of each cell (cells + 1) [L]
      type(error_t), allocatable, intent(out) :: error !! a given end lies beyond the line, or the cells are too many
      real(dp) :: length
      integer :: i, n

      length = sum(side_lengths)
      n = size(side_lengths)
      ! A quadratic side has two nodes of its own; more cells than nodes are never independent.
      if (self%n_cells > 2*n + 1) then
         call new_error(error, input_refused, 'cells must be at least two sides long, found '//to_text(self%n_cells)// &
            ' cells on '//to_text(n)//' sides')
         return
      end if
      if (allocated(self%ends)) then
         if (self%ends(size(self%ends)) >= length) then
            call new_error(error, input_refused, 'cell_ends must lie before the end of the contact line, which '// &
               'ends the last cell: its length is '//to_text(length)//', found '//to_text(self%ends(size(self%ends))))
            return
         end if
         ends = [0.0_dp, self%ends, length]
      else if (self%n_cells > 0) then
         ends = [(length*i/self%n_cells, i=0, self%n_cells)]
      else
         ends = [0.0_dp, (sum(side_lengths(:2*i)), i=1, n/2)]
         if (n == 1) ends = [0.0_dp, 0.0_dp]
         ends(size(ends)) = length
      end if
   end subroutine cell_partition_cell_ends

end module amontons_cell_partition
