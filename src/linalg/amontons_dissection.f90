!> Geometric dissection: cuts through the places of unknowns, the separators of which are eliminated last.
!>
!> A cut goes across the longer side of the box around a set of places, at their median. What lies on one side couples
!> with the other side only through the separator: the places beyond the cut that have neighbours before it.
module amontons_dissection
   use amontons_graph, only: graph_t
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: cut_places, dissect

   !> Sets of at most so many groups are not cut any further; measured, larger ones cost fill and smaller ones time.
   integer, parameter :: leaf_size = 8
   !> What distance between places is taken for rounding errors, relative to the box around them.
   real(dp), parameter :: margin = 1.0e-9_dp

contains

   !> Orders all groups but the trailing ones by nested dissection; the trailing ones follow.
   pure subroutine dissect(graph, place, order)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! where each group sits (2, n groups) [L]
      integer, intent(out) :: order(:) !! position k holds group order(k) (n groups)
      integer, allocatable :: side(:)
      integer :: group

      do group = 1, graph%n
         order(group) = group
      end do
      allocate (side(graph%n), source=0)
      call dissect_groups(graph, place, side, order(:graph%n - graph%n_trailing))
   end subroutine dissect

   !> Orders a set of groups: what lies before the cut, what lies beyond it, the separator.
   pure recursive subroutine dissect_groups(graph, place, side, groups)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! where each group sits (2, n groups) [L]
      integer, intent(inout) :: side(:) !! 0 for all groups, before and after (n groups)
      integer, intent(inout) :: groups(:) !! the groups, in their order on return
      integer, parameter :: before = 1, beyond = 2, separator = 3
      integer, allocatable :: new_order(:)
      logical, allocatable :: is_before(:)
      integer(int64) :: at
      integer :: i, k, n(3)

      if (size(groups) <= leaf_size) return
      call cut_places(place(:, groups), is_before)
      if (.not. any(is_before)) return
      side(groups) = merge(before, beyond, is_before)
      do i = 1, size(groups)
         if (is_before(i)) cycle
         do at = graph%start(groups(i)), graph%start(groups(i) + 1) - 1
            if (side(graph%neighbour(at)) /= before) cycle
            side(groups(i)) = separator
            exit
         end do
      end do
      n = [(count(side(groups) == k), k=before, separator)]
      allocate (new_order, source=[(pack(groups, side(groups) == k), k=before, separator)])
      groups = new_order
      side(groups) = 0
      deallocate (new_order, is_before)
      call dissect_groups(graph, place, side, groups(:n(1)))
      call dissect_groups(graph, place, side, groups(n(1) + 1:n(1) + n(2)))
   end subroutine dissect_groups

   !> Cuts a set of places at the median of the coordinate that varies most, or of a given one.
   pure subroutine cut_places(place, is_before, axis)
      real(dp), intent(in) :: place(:, :) !! the places (2, n) [L]
      logical, allocatable, intent(out) :: is_before(:) !! whether each lies before the cut; none at one place (n)
      integer, intent(in), optional :: axis !! which coordinate
      real(dp) :: extent(2), cut
      integer :: k, across

      allocate (is_before(size(place, 2)), source=.false.)
      if (size(place, 2) == 0) return
      extent = [(maxval(place(k, :)) - minval(place(k, :)), k=1, 2)]
      across = merge(2, 1, extent(2) > (1.0_dp + margin)*extent(1))
      if (present(axis)) across = axis
      if (.not. extent(across) > 0.0_dp) return
      cut = median(place(across, :))
      ! A little before the median, so that rounding errors do not divide a row of places on one line.
      is_before = place(across, :) < cut - margin*extent(across)
      if (.not. any(is_before)) is_before = place(across, :) < cut + margin*extent(across)
      if (all(is_before)) is_before = place(across, :) < cut
   end subroutine cut_places

   !> The number in the middle of a list.
   pure real(dp) function median(numbers)
      real(dp), intent(in) :: numbers(:) !! the list, not empty
      real(dp), allocatable :: list(:)
      real(dp) :: pivot, item
      integer :: first, last, middle, i, k

      allocate (list, source=numbers)
      middle = (size(list) + 1)/2
      first = 1
      last = size(list)
      do while (first < last)
         ! Smaller numbers go before the pivot, larger ones behind it, and the search goes on where the middle is.
         pivot = list(first + (last - first)/2)
         i = first
         k = last
         do while (i <= k)
            do while (list(i) < pivot)
               i = i + 1
            end do
            do while (list(k) > pivot)
               k = k - 1
            end do
            if (i > k) exit
            item = list(i)
            list(i) = list(k)
            list(k) = item
            i = i + 1
            k = k - 1
         end do
         if (k < middle) first = i
         if (i > middle) last = k
      end do
      median = list(middle)
   end function median

end module amontons_dissection
