!> The cut of a matrix in parts that couple only through an interface.
module amontons_substructures
   use amontons_dissection, only: cut_places
   use amontons_kinds, only: dp, int64
   use amontons_ordering, only: positions, reverse_cuthill_mckee
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_threads, only: n_threads
   implicit none (type, external)
   private

   public :: cut_t, n_parts, new_cut, part_unknowns

   !> Number of parts. It is the same for any number of threads, since results depend on it.
   integer, parameter :: n_parts = 2

   !> A cut. The interface and the trailing unknowns are the top.
   type :: cut_t
      integer, allocatable :: part_of(:) !! the part of each unknown, 0 for the top (n)
      integer, allocatable :: top(:) !! the unknowns of the top, ascending
      logical, allocatable :: is_boundary(:, :)
         !! whether each unknown belongs to the top and couples to each part (n, n_parts)
      real(dp), private :: cost = 0.0_dp !! operations, roughly, of one thread for each part
   end type cut_t

contains

   !> Cuts a matrix across one of the axes, whichever promises less work.
   subroutine new_cut(cut, matrix, n_trailing)
      type(cut_t), intent(out) :: cut !! the cut
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_trailing !! number of trailing unknowns, which belong to no part
      type(cut_t) :: across(2)
      real(dp), allocatable :: place(:, :)
      integer :: axis, k

      if (allocated(matrix%place)) then
         place = matrix%place(:, :matrix%n - n_trailing)
      else
         place = graph_places(matrix, n_trailing)
      end if
      !$omp parallel do default(none) schedule(static, 1) num_threads(min(2, n_threads())) shared(matrix, place, across)
      do axis = 1, 2
         call cut_across(matrix, place, axis, across(axis)%part_of)
         call find_boundaries(matrix, across(axis))
         across(axis)%cost = cut_cost(across(axis))
      end do
      !$omp end parallel do
      cut = across(minloc(across%cost, dim=1))
      cut%top = pack([(k, k=1, matrix%n)], cut%part_of == 0)
   end subroutine new_cut

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
   pure subroutine cut_across(matrix, place, axis, part_of)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      real(dp), intent(in) :: place(:, :) !! where each unknown but the trailing ones sits (2, n - n_trailing)
      integer, intent(in) :: axis !! which coordinate
      integer, allocatable, intent(out) :: part_of(:) !! the part of each unknown, 0 for the top (n)
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
   end subroutine cut_across

   !> Finds the unknowns of the top that couple to each part.
   pure subroutine find_boundaries(matrix, cut)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      type(cut_t), intent(inout) :: cut !! the cut, its parts known; gains the boundaries
      integer(int64) :: at
      integer :: j, p, q

      allocate (cut%is_boundary(matrix%n, n_parts), source=.false.)
      do j = 1, matrix%n
         p = cut%part_of(j)
         do at = matrix%column_start(j) + 1, matrix%column_start(j + 1) - 1
            q = cut%part_of(matrix%row(at))
            if (p == 0 .and. q > 0) cut%is_boundary(j, q) = .true.
            if (q == 0 .and. p > 0) cut%is_boundary(matrix%row(at), p) = .true.
         end do
      end do
   end subroutine find_boundaries

   !> What a cut costs: the slower part, its boundary as a dense block, and the top.
   pure real(dp) function cut_cost(cut)
      type(cut_t), intent(in) :: cut !! the cut
      ! Counted on squares of 256 to 1024 cells: so many operations times the power 3/2 of the number of unknowns.
      real(dp), parameter :: operations_per_unknown = 70.0_dp
      integer :: p

      cut_cost = maxval([(operations_per_unknown*real(count(cut%part_of == p), dp)**1.5_dp &
         + 2.0_dp/3.0_dp*real(count(cut%is_boundary(:, p)), dp)**3, p=1, n_parts)]) &
         + real(count(cut%part_of == 0), dp)**3/3.0_dp
   end function cut_cost

   !> Lists the unknowns of a part and its boundary, both ascending.
   pure subroutine part_unknowns(cut, p, own, boundary)
      type(cut_t), intent(in) :: cut !! the cut
      integer, intent(in) :: p !! number of the part
      integer, allocatable, intent(out) :: own(:) !! the unknowns of the part
      integer, allocatable, intent(out) :: boundary(:) !! which unknowns of the top couple to them, by place in it
      integer :: k

      own = pack([(k, k=1, size(cut%part_of))], cut%part_of == p)
      boundary = pack([(k, k=1, size(cut%top))], cut%is_boundary(cut%top, p))
   end subroutine part_unknowns

end module amontons_substructures
