!> Geometric dissection: cuts through the places of unknowns, the separators of which are eliminated last.
!>
!> A cut goes across the longer side of the box around the places of a domain, at their median. What lies on one side
!> couples with the other side only through the separator: the places beyond the cut that have neighbors before it. The
!> two sides are domains that are cut again, down to small ones.
module amontons_dissection
   use amontons_graph, only: graph_t
   use amontons_kinds, only: dp, int64
   use amontons_threads, only: n_threads
   implicit none (type, external)
   private

   public :: cut_places, dissection_t, new_dissection

   !> A dissection. A separator has consecutive positions, right behind those of the domains on its two sides; that of
   !> a domain that is not cut is the whole domain. The last separator holds the Schur variables too.
   type :: dissection_t
      integer, allocatable :: order(:) !! position k holds supervariable order(k) (n supervariables)
      integer, allocatable :: separator_start(:)
         !! first position of the separator that ends at each position; 0 where none ends (n supervariables)
      integer, allocatable :: domain_start(:)
         !! first position of the domain of the separator that ends at each position (n supervariables)
   end type dissection_t

   !> Where a supervariable of a domain lies.
   integer, parameter :: before = 1, beyond = 2, separator = 3
   !> Domains of at most so many supervariables are not cut any further; measured: larger ones cost fill, smaller ones
   !> time.
   integer, parameter :: leaf_size = 8
   !> Domains of more supervariables are a task for a thread of its own.
   integer, parameter :: task_size = 4000
   !> What distance between places is taken for rounding errors, relative to the box around them.
   real(dp), parameter :: margin = 1.0e-9_dp

contains

   !> Dissects all supervariables but the Schur variables, which follow in their order.
   subroutine new_dissection(dissection, graph, place)
      type(dissection_t), intent(out) :: dissection !! the dissection
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! where each supervariable of the interior sits (2, n - n_schur) [L]
      integer, allocatable :: side(:)
      integer :: n, k

      allocate (dissection%order(graph%n))
      do k = 1, graph%n
         dissection%order(k) = k
      end do
      allocate (dissection%separator_start(graph%n), dissection%domain_start(graph%n), side(graph%n), source=0)
      n = graph%n - graph%n_schur
      !$omp parallel default(none) num_threads(n_threads()) shared(graph, place, side, n, dissection)
      !$omp single
      call dissect(graph, place, side, 1, n, dissection)
      !$omp end single
      !$omp end parallel
      if (graph%n_schur == 0) return
      ! The Schur variables join the last separator.
      dissection%domain_start(graph%n) = 1
      dissection%separator_start(graph%n) = n + 1
      if (n == 0) return
      dissection%separator_start(graph%n) = dissection%separator_start(n)
      dissection%separator_start(n) = 0
   end subroutine new_dissection

   !> Orders a domain: what lies before the cut, what lies beyond it, the separator.
   recursive subroutine dissect(graph, place, side, first, last, dissection)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! where each supervariable of the interior sits (2, n - n_schur) [L]
      integer, intent(inout) :: side(:) !! 0 for the supervariables of the domain, before and after (n)
      integer, intent(in) :: first !! position of the first supervariable of the domain
      integer, intent(in) :: last !! position of the last one
      type(dissection_t), intent(inout) :: dissection !! gains the order and the separators of the domain
      integer :: n_before, n_beyond

      if (last < first) return
      n_before = 0
      n_beyond = 0
      if (last - first >= leaf_size) call split(graph, place, side, dissection%order(first:last), n_before, n_beyond)
      dissection%domain_start(last) = first
      dissection%separator_start(last) = first + n_before + n_beyond
      !$omp task default(none) shared(graph, place, side, first, n_before, dissection) if (n_before > task_size)
      call dissect(graph, place, side, first, first + n_before - 1, dissection)
      !$omp end task
      call dissect(graph, place, side, first + n_before, first + n_before + n_beyond - 1, dissection)
      !$omp taskwait
   end subroutine dissect

   !> Splits a domain at a cut; the separator, what is left, comes last and is never empty.
   subroutine split(graph, place, side, domain, n_before, n_beyond)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! where each supervariable of the interior sits (2, n - n_schur) [L]
      integer, intent(inout) :: side(:) !! 0 for the supervariables of the domain, before and after (n)
      integer, intent(inout) :: domain(:) !! the supervariables of the domain, in their order on return
      integer, intent(out) :: n_before !! how many lie before the cut; none if all lie at one place
      integer, intent(out) :: n_beyond !! how many lie beyond it and are not of the separator
      integer :: old(size(domain)), next(3), i, k
      logical, allocatable :: is_before(:)

      n_before = 0
      n_beyond = 0
      call cut_places(place(:, domain), is_before)
      if (.not. any(is_before)) return
      old = domain
      side(old) = merge(before, beyond, is_before)
      call mark_separator(graph, old, side)
      n_before = count(side(old) == before)
      n_beyond = count(side(old) == beyond)
      next = [1, n_before + 1, n_before + n_beyond + 1]
      do i = 1, size(old)
         k = side(old(i))
         domain(next(k)) = old(i)
         next(k) = next(k) + 1
      end do
      side(old) = 0
   end subroutine split

   !> Marks the separator of a domain that lies before a cut and beyond it. It is never empty: two sides that do not
   !> couple still get one, so that no domain is cut in more than two.
   pure subroutine mark_separator(graph, domain, side)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: domain(:) !! the supervariables of the domain
      integer, intent(inout) :: side(:) !! the side of each supervariable
      integer :: last, i

      last = 0
      do i = 1, size(domain)
         if (side(domain(i)) /= beyond) cycle
         last = domain(i)
         if (couples(graph, side, domain(i), before)) side(domain(i)) = separator
      end do
      if (any(side(domain) == beyond)) then
         ! What couples to nothing beyond the separator need not be of it: nodes in the middle of edges that cross it.
         do i = 1, size(domain)
            if (side(domain(i)) /= separator) cycle
            if (.not. couples(graph, side, domain(i), beyond)) side(domain(i)) = before
         end do
      end if
      if (all(side(domain) /= separator)) side(last) = separator
   end subroutine mark_separator

   !> Whether a supervariable couples to one on a given side.
   pure logical function couples(graph, side, item, with)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: side(:) !! the side of each supervariable
      integer, intent(in) :: item !! the supervariable
      integer, intent(in) :: with !! the side
      integer(int64) :: at

      do at = graph%start(item), graph%start(item + 1) - 1
         couples = side(graph%neighbor(at)) == with
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
