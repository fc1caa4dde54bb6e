!> Geometric dissection: cuts through the places of unknowns, the separators of which are eliminated last.
!>
!> A cut goes across the longer side of the box around a set of places, at their median. What lies on one side couples
!> with the other side only through the separator: the places beyond the cut that have neighbours before it. Both sides
!> are cut again, down to small pieces.
module amontons_dissection
   use amontons_graph, only: graph_t
   use amontons_kinds, only: dp, int64
   use amontons_threads, only: n_threads
   implicit none (type, external)
   private

   public :: cut_places, dissection_t, new_dissection

   !> A dissection. Its pieces are the sets that are not cut, and the separators; the last one holds the trailing groups
   !> too. A piece has consecutive positions, right behind those of the sets on its two sides.
   type :: dissection_t
      integer, allocatable :: order(:) !! position k holds group order(k) (n groups)
      integer, allocatable :: piece_start(:)
         !! first position of the piece that ends at each position; 0 where none ends (n groups)
      integer, allocatable :: set_start(:)
         !! first position of the set that the piece was cut from or, if it was not cut, is (n groups)
   end type dissection_t

   !> Where a group of a set lies.
   integer, parameter :: before = 1, beyond = 2, separator = 3
   !> Sets of at most so many groups are not cut any further; measured, larger ones cost fill and smaller ones time.
   integer, parameter :: leaf_size = 8
   !> Sets of more groups are a task for a thread of its own.
   integer, parameter :: task_size = 4000
   !> What distance between places is taken for rounding errors, relative to the box around them.
   real(dp), parameter :: margin = 1.0e-9_dp

contains

   !> Dissects all groups but the trailing ones, which follow in their order.
   subroutine new_dissection(dissection, graph, place)
      type(dissection_t), intent(out) :: dissection !! the dissection
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! where each group but the trailing ones sits (2, n groups - n_trailing) [L]
      integer, allocatable :: side(:)
      integer :: group, n

      allocate (dissection%order(graph%n))
      do group = 1, graph%n
         dissection%order(group) = group
      end do
      allocate (dissection%piece_start(graph%n), dissection%set_start(graph%n), side(graph%n), source=0)
      n = graph%n - graph%n_trailing
      !$omp parallel default(none) num_threads(n_threads()) shared(graph, place, side, n, dissection)
      !$omp single
      call dissect(graph, place, side, 1, n, dissection)
      !$omp end single
      !$omp end parallel
      if (graph%n_trailing == 0) return
      ! The trailing groups join the last separator.
      dissection%set_start(graph%n) = 1
      dissection%piece_start(graph%n) = n + 1
      if (n == 0) return
      dissection%piece_start(graph%n) = dissection%piece_start(n)
      dissection%piece_start(n) = 0
   end subroutine new_dissection

   !> Orders a set of groups: what lies before the cut, what lies beyond it, the separator.
   recursive subroutine dissect(graph, place, side, first, last, dissection)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! where each group but the trailing ones sits (2, n groups - n_trailing) [L]
      integer, intent(inout) :: side(:) !! 0 for the groups of the set, before and after (n groups)
      integer, intent(in) :: first !! position of the first group of the set
      integer, intent(in) :: last !! position of the last one
      type(dissection_t), intent(inout) :: dissection !! gains the order and the pieces of the set
      integer :: n_before, n_beyond

      if (last < first) return
      n_before = 0
      n_beyond = 0
      if (last - first >= leaf_size) call split(graph, place, side, dissection%order(first:last), n_before, n_beyond)
      dissection%set_start(last) = first
      dissection%piece_start(last) = first + n_before + n_beyond
      !$omp task default(none) shared(graph, place, side, first, n_before, dissection) if (n_before > task_size)
      call dissect(graph, place, side, first, first + n_before - 1, dissection)
      !$omp end task
      call dissect(graph, place, side, first + n_before, first + n_before + n_beyond - 1, dissection)
      !$omp taskwait
   end subroutine dissect

   !> Splits a set at a cut; the separator, what is left, comes last and is never empty.
   subroutine split(graph, place, side, groups, n_before, n_beyond)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! where each group but the trailing ones sits (2, n groups - n_trailing) [L]
      integer, intent(inout) :: side(:) !! 0 for the groups of the set, before and after (n groups)
      integer, intent(inout) :: groups(:) !! the groups of the set, in their order on return
      integer, intent(out) :: n_before !! how many lie before the cut; none if all lie at one place
      integer, intent(out) :: n_beyond !! how many lie beyond it and are not of the separator
      integer :: old(size(groups)), next(3), i, k
      logical, allocatable :: is_before(:)

      n_before = 0
      n_beyond = 0
      call cut_places(place(:, groups), is_before)
      if (.not. any(is_before)) return
      old = groups
      side(old) = merge(before, beyond, is_before)
      call mark_separator(graph, old, side)
      n_before = count(side(old) == before)
      n_beyond = count(side(old) == beyond)
      next = [1, n_before + 1, n_before + n_beyond + 1]
      do i = 1, size(old)
         k = side(old(i))
         groups(next(k)) = old(i)
         next(k) = next(k) + 1
      end do
      side(old) = 0
   end subroutine split

   !> Marks the separator of a set whose groups lie before a cut or beyond it. It is never empty: two sides that do not
   !> couple still get one, so that no set is cut in more than two.
   pure subroutine mark_separator(graph, groups, side)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: groups(:) !! the groups of the set
      integer, intent(inout) :: side(:) !! the side of each group
      integer :: last, i

      last = 0
      do i = 1, size(groups)
         if (side(groups(i)) /= beyond) cycle
         last = groups(i)
         if (couples(graph, side, groups(i), before)) side(groups(i)) = separator
      end do
      if (any(side(groups) == beyond)) then
         ! What couples to nothing beyond the separator need not be of it: nodes in the middle of edges that cross it.
         do i = 1, size(groups)
            if (side(groups(i)) /= separator) cycle
            if (.not. couples(graph, side, groups(i), beyond)) side(groups(i)) = before
         end do
      end if
      if (all(side(groups) /= separator)) side(last) = separator
   end subroutine mark_separator

   !> Whether a group couples to one on a given side.
   pure logical function couples(graph, side, group, with)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: side(:) !! the side of each group
      integer, intent(in) :: group !! the group
      integer, intent(in) :: with !! the side
      integer(int64) :: at

      do at = graph%start(group), graph%start(group + 1) - 1
         couples = side(graph%neighbour(at)) == with
         if (couples) return
      end do
      couples = .false.
   end function couples

   !> Cuts a set of places at the median of the coordinate that varies most.
   pure subroutine cut_places(place, is_before)
      real(dp), intent(in) :: place(:, :) !! the places (2, n) [L]
      logical, allocatable, intent(out) :: is_before(:) !! whether each lies before the cut; none at one place (n)
      real(dp) :: extent(2), cut
      integer :: k, across

      allocate (is_before(size(place, 2)), source=.false.)
      if (size(place, 2) == 0) return
      extent = [(maxval(place(k, :)) - minval(place(k, :)), k=1, 2)]
      across = merge(2, 1, extent(2) > (1.0_dp + margin)*extent(1))
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
