!> The cut of a matrix in parts that couple only through an interface.
module amontons_substructures
   use amontons_dissection, only: cut_places
   use amontons_kinds, only: dp, int64
   use amontons_ordering, only: positions, reverse_cuthill_mckee
   use amontons_sparse_matrix, only: sparse_matrix_t
   implicit none (type, external)
   private

   public :: cut_matrix, n_parts, part_unknowns

   !> Number of parts. It is the same for any number of threads, since results depend on it.
   integer, parameter :: n_parts = 2

contains

   !> Cuts a matrix across one of the axes, whichever promises less work.
   subroutine cut_matrix(matrix, n_trailing, part_of)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_trailing !! number of trailing unknowns, which belong to no part
      integer, allocatable, intent(out) :: part_of(:) !! the part of each unknown, 0 for interface and trailing ones (n)
      integer, allocatable :: candidate(:)
      real(dp), allocatable :: place(:, :)
      real(dp) :: cost, least
      integer :: axis

      if (allocated(matrix%place)) then
         place = matrix%place(:, :matrix%n - n_trailing)
      else
         place = graph_places(matrix, n_trailing)
      end if
      least = huge(least)
      do axis = 1, 2
         call cut_across(matrix, place, axis, candidate, cost)
         if (cost >= least) cycle
         least = cost
         call move_alloc(candidate, part_of)
      end do
   end subroutine cut_matrix

   !> Stands in for places that nobody knows: neighbours in the matrix get neighbouring numbers.
   function graph_places(matrix, n_trailing) result(place)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_trailing !! number of trailing unknowns
      real(dp), allocatable :: place(:, :)
      integer, allocatable :: order(:), position(:)

      allocate (order(matrix%n))
      call reverse_cuthill_mckee(matrix, n_trailing, order)
      allocate (position, source=positions(order))
      allocate (place(2, matrix%n - n_trailing), source=0.0_dp)
      place(1, :) = position(:matrix%n - n_trailing)
   end function graph_places

   !> Cuts a matrix at the median of one coordinate.
   pure subroutine cut_across(matrix, place, axis, part_of, cost)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      real(dp), intent(in) :: place(:, :) !! where each unknown but the trailing ones sits (2, n - n_trailing)
      integer, intent(in) :: axis !! which coordinate
      integer, allocatable, intent(out) :: part_of(:) !! the part of each unknown, 0 for the top (n)
      real(dp), intent(out) :: cost !! operations, roughly, of two threads
      logical, allocatable :: is_before(:)
      integer(int64) :: at
      integer :: i, j

      call cut_places(place, is_before, axis)
      allocate (part_of(matrix%n), source=0)
      part_of(:size(is_before)) = merge(1, 2, is_before)
      ! The interface is what lies beyond the cut and has neighbours before it.
      do j = 1, size(is_before)
         do at = matrix%column_start(j) + 1, matrix%column_start(j + 1) - 1
            i = matrix%row(at)
            if (i > size(is_before)) cycle
            if (is_before(i) .eqv. is_before(j)) cycle
            part_of(merge(j, i, is_before(i))) = 0
         end do
      end do
      cost = cut_cost(matrix, part_of)
   end subroutine cut_across

   !> What a cut costs: the slower part, its boundary as a dense block, and the top.
   pure real(dp) function cut_cost(matrix, part_of)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: part_of(:) !! the part of each unknown, 0 for the top (n)
      ! Counted on squares of 256 to 1024 cells: so many operations times the power 3/2 of the number of unknowns.
      real(dp), parameter :: operations_per_unknown = 70.0_dp
      real(dp) :: operations(n_parts)
      logical, allocatable :: is_boundary(:)
      integer :: p

      do p = 1, n_parts
         allocate (is_boundary, source=boundary_of(matrix, part_of, p))
         operations(p) = operations_per_unknown*real(count(part_of == p), dp)**1.5_dp &
            + 2.0_dp/3.0_dp*real(count(is_boundary), dp)**3
         deallocate (is_boundary)
      end do
      cut_cost = maxval(operations) + real(count(part_of == 0), dp)**3/3.0_dp
   end function cut_cost

   !> Which unknowns of the top couple to a part.
   pure function boundary_of(matrix, part_of, p) result(is_boundary)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: part_of(:) !! the part of each unknown, 0 for the top (n)
      integer, intent(in) :: p !! number of the part
      logical, allocatable :: is_boundary(:)
      integer(int64) :: at
      integer :: i, j

      allocate (is_boundary(matrix%n), source=.false.)
      do j = 1, matrix%n
         if (part_of(j) /= 0 .and. part_of(j) /= p) cycle
         do at = matrix%column_start(j) + 1, matrix%column_start(j + 1) - 1
            i = matrix%row(at)
            if (part_of(i) == p .and. part_of(j) == 0) is_boundary(j) = .true.
            if (part_of(j) == p .and. part_of(i) == 0) is_boundary(i) = .true.
         end do
      end do
   end function boundary_of

   !> Lists the unknowns of a part and its boundary, both ascending.
   pure subroutine part_unknowns(matrix, part_of, p, top, own, boundary)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: part_of(:) !! the part of each unknown, 0 for the top (n)
      integer, intent(in) :: p !! number of the part
      integer, intent(in) :: top(:) !! the unknowns of the top, ascending
      integer, allocatable, intent(out) :: own(:) !! the unknowns of the part
      integer, allocatable, intent(out) :: boundary(:) !! which unknowns of the top couple to them, by place in `top`
      logical, allocatable :: is_boundary(:)
      integer :: k

      own = pack([(k, k=1, matrix%n)], part_of == p)
      allocate (is_boundary, source=boundary_of(matrix, part_of, p))
      boundary = pack([(k, k=1, size(top))], is_boundary(top))
   end subroutine part_unknowns

end module amontons_substructures
