!> Nested dissection of a matrix, and the fronts that eliminate it in this order.
!>
!> Geometric dissection cuts through the places of unknowns, and the separators are eliminated last. A cut goes across
!> the longer side of the box around the places of a domain, at their median; in space it is the best of several, and
!> need not be flat. What lies on one side couples with the other side only through the separator: the places beyond a
!> flat cut that have neighbors before it. The two sides are domains that are cut again, down to small ones.
!>
!> A front eliminates its pivot columns, the unknowns of its separator. Its row structure lists the unknowns, all of
!> them eliminated later, that its pivots couple to, directly or through the domains on the two sides of the separator;
!> the fronts of these are its children. What the elimination leaves on the row structure, the contribution block, goes
!> to the parent: the row structure lies in the rows, pivots and row structure, of that one front.
module amontons_dissection
   use amontons_integer_list, only: fill_bins, integer_list_t
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dgemm, dgemv, dtrsm, dtrsv
   use amontons_rounding, only: computed_rounding
   use amontons_sparse_matrix, only: graph_t, positions, sparse_matrix_t
   use amontons_threads, only: n_threads
   implicit none (type, external)
   private

   public :: backward_columns, cut_places, dissection_t, forward_columns, fronts_t, new_dissection, new_fronts

   !> A dissection. A separator has consecutive positions, right behind those of the domains on its two sides; that of
   !> a domain that is not cut is the whole domain. The last separator holds the Schur variables too.
   type :: dissection_t
      integer, allocatable :: order(:) !! position k holds supervariable order(k) (n supervariables)
      integer, allocatable :: separator_start(:)
         !! first position of the separator that ends at each position; 0 where none ends (n supervariables)
      integer, allocatable :: domain_start(:)
         !! first position of the domain of the separator that ends at each position (n supervariables)
   end type dissection_t

   !> The part of a domain in which a supervariable lies: before the cut, beyond it, or in the separator.
   integer, parameter :: before = 1, beyond = 2, separator = 3
   !> Domains of at most so many supervariables are not cut any further; measured: larger ones cost fill, smaller ones
   !> time.
   integer, parameter :: leaf_size = 8
   !> Domains of more supervariables are a task for a thread of its own.
   integer, parameter :: task_size = 4000

   !> Blocks of at most so many columns are faster without BLAS, whose calls have a lock for all threads; measured.
   integer, parameter :: most_narrow = 16

   !> The fronts, numbered in the order of elimination: the children of each come before it, the last one is the root.
   type :: fronts_t
      integer :: n = 0 !! number of fronts
      integer, allocatable :: first(:) !! position of the first pivot of each, and past the last one (n + 1)
      integer, allocatable :: child(:, :) !! the two children of each, 0 for none (2, n)
      integer, allocatable :: first_descendant(:) !! the first front of the subtree of each (n)
      integer(int64), allocatable :: structure_start(:) !! where the row structure of each starts (n + 1)
      integer, allocatable :: position(:) !! position of each item of the row structures
      integer, allocatable :: parent_row(:) !! which row of the parent it is
      integer(int64), allocatable :: block_start(:)
         !! where the block of each starts, its pivot columns on all of its rows, when one follows the other (n + 1)
      integer, allocatable :: stack_size(:)
         !! how many numbers, of each and of its small descendants, wait at most at a time in a substitution (n)
   contains
      procedure :: n_structure => fronts_n_structure
      procedure :: n_pivots => fronts_n_pivots
      procedure :: n_rows => fronts_n_rows
      procedure :: is_large => fronts_is_large
      procedure :: find_rows => fronts_find_rows
   end type fronts_t

   !> Subtrees with fewer unknowns are not worth a task of their own; a round number, not a measured one.
   integer, parameter :: least_large = 4000

contains

   !> Dissects all supervariables but the Schur variables, which follow in their order.
   subroutine new_dissection(dissection, graph, place)
      type(dissection_t), intent(out) :: dissection !! the dissection
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! position of each supervariable of the interior (n_dim, n - n_schur) [L]
      integer, allocatable :: side(:)
      integer :: n, k

      dissection%order = [(k, k=1, graph%n)]
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

   !> Orders a domain: first the part before the cut, then the part beyond it, last the separator.
   recursive subroutine dissect(graph, place, side, first, last, dissection)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! position of each supervariable of the interior (n_dim, n - n_schur) [L]
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

   !> Splits a domain at a cut into the part before it, the part beyond it and the separator between them, which is
   !> never empty.
   subroutine split(graph, place, side, domain, n_before, n_beyond)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! position of each supervariable of the interior (n_dim, n - n_schur) [L]
      integer, intent(inout) :: side(:) !! 0 for the supervariables of the domain, before and after (n)
      integer, intent(inout) :: domain(:) !! the supervariables of the domain, in their order on return
      integer, intent(out) :: n_before !! number before the cut; 0 if all have the same position
      integer, intent(out) :: n_beyond !! number beyond the cut, without the separator
      integer :: old(size(domain)), next(3), i, k
      logical, allocatable :: is_before(:)

      old = domain
      if (size(place, 1) == 2) then
         call cut_places(place(:, old), is_before)
         side(old) = separator
         if (any(is_before)) call mark_sides(graph, side, old, is_before)
      else
         call find_best_cut(graph, place(:, old), side, old)
      end if
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

   !> Finds the best cut of a domain in space: the one whose separator has the fewest supervariables over the product of
   !> their numbers on both sides. These are the cuts across the longer sides of the box around the places, at their
   !> medians, and the smallest separator in the middle along the best of these sides.
   subroutine find_best_cut(graph, place, side, domain)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: place(:, :) !! positions of the supervariables of the domain (3, any) [L]
      integer, intent(inout) :: side(:)
         !! gains `before`, `beyond`, `separator` for those of the domain; all in the separator if at one place (n)
      integer, intent(in) :: domain(:) !! the supervariables of the domain
      ! In small domains a search costs time and saves nothing; measured.
      integer, parameter :: worth_search = 200
      logical, allocatable :: is_before(:)
      integer, allocatable :: best(:)
      real(dp) :: extent(size(place, 1)), least, cost
      integer :: across, i

      allocate (best(size(domain)), source=separator)
      extent = maxval(place, dim=2) - minval(place, dim=2)
      least = huge(least)
      across = 0
      do i = 1, size(extent) + 1
         if (i <= size(extent)) then
            if (.not. extent(i) > 0.5_dp*maxval(extent)) cycle
            call cut_across(place(i, :), 0.5_dp, extent(i), is_before)
            call mark_sides(graph, side, domain, is_before)
         else
            if (across == 0 .or. size(domain) < worth_search) exit
            call mark_smallest(graph, place(across, :), extent(across), side, domain)
         end if
         cost = real(count(side(domain) == before), dp)*count(side(domain) == beyond)
         cost = merge(count(side(domain) == separator)/max(1.0_dp, cost), real(size(domain), dp), cost > 0.0_dp)
         if (.not. cost < least) cycle
         least = cost
         best = side(domain)
         across = i
      end do
      side(domain) = best
   end subroutine find_best_cut

   !> Marks the smallest separator of a domain in its middle along an axis: as many supervariables as there are paths
   !> through the middle that share none (Menger), and on each the first that no path can be led around.
   subroutine mark_smallest(graph, x, extent, side, domain)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), intent(in) :: x(:) !! coordinates of the supervariables of the domain (any) [L]
      real(dp), intent(in) :: extent !! their range [L]
      integer, intent(inout) :: side(:) !! gains `before`, `beyond`, `separator` for those of the domain (n)
      integer, intent(in) :: domain(:) !! the supervariables of the domain
      ! Share of the domain on each side of the middle: with less a search takes longer than it saves; measured.
      real(dp), parameter :: share = 0.3_dp
      logical, allocatable :: is_end(:), touches(:, :), from_before(:, :), from_beyond(:, :)
      integer, allocatable :: item(:), start(:), near(:), next(:), previous(:)
      real(dp), allocatable :: x_item(:)
      integer(int64) :: at
      integer :: i, k, n, n_found, pass

      call cut_across(x, share, extent, is_end)
      side(domain) = merge(before, separator, is_end)
      call cut_across(-x, share, extent, is_end)
      do i = 1, size(domain)
         if (.not. is_end(i)) cycle
         if (.not. couples(graph, side, domain(i), before)) side(domain(i)) = beyond
      end do
      ! The graph of the middle, whose supervariables have negative numbers for the time being. Neighbors further along
      ! the axis come first, so that paths lead straight across.
      item = pack(domain, side(domain) == separator)
      x_item = pack(x, side(domain) == separator)
      n = size(item)
      side(item) = [(-i, i=1, n)]
      allocate (start(n + 1), near(sum(graph%start(item + 1) - graph%start(item))), next(n), previous(n), source=0)
      allocate (touches(n, before:beyond), from_before(2, n), from_beyond(2, n), source=.false.)
      k = 0
      do i = 1, n
         start(i) = k + 1
         do pass = 1, 2
            do at = graph%start(item(i)), graph%start(item(i) + 1) - 1
               associate (to => side(graph%neighbor(at)))
                  if (to > 0) then
                     touches(i, to) = .true.
                  else if (to < 0) then
                     if ((x_item(-to) > x_item(i)) .neqv. (pass == 1)) cycle
                     k = k + 1
                     near(k) = -to
                  end if
               end associate
            end do
         end do
      end do
      start(n + 1) = k + 1
      side(item) = separator
      n_found = 1
      do while (n_found > 0)
         call add_paths(start, near, touches(:, before), touches(:, beyond), next, previous, from_before, n_found)
      end do
      call add_paths(start, near, touches(:, beyond), touches(:, before), previous, next, from_beyond, n_found)
      ! Of the two separators, each of the first on every path from one side, the better balanced one.
      if (count(side(domain) == before) + count(from_before(2, :)) >= &
         count(side(domain) == beyond) + count(from_beyond(2, :))) then
         side(item) = merge(before, merge(separator, beyond, from_before(1, :)), from_before(2, :))
      else
         side(item) = merge(beyond, merge(separator, before, from_beyond(1, :)), from_beyond(2, :))
      end if
      ! Two sides that do not couple still get a separator, so that no domain is cut in more than two.
      if (all(next == 0)) side(domain(1)) = separator
   end subroutine mark_smallest

   !> Adds paths through a graph to those that it has, each item on one path at most, leading these elsewhere where that
   !> makes room. A search enters an item and leaves it; one that enters an item of a path goes on from the item before
   !> it, and from an item whose successor was taken it may go back further.
   subroutine add_paths(start, near, is_first, is_last, next, previous, seen, n_found)
      integer, intent(in) :: start(:) !! where the neighbors of each item start, and past the last one (n + 1)
      integer, intent(in) :: near(:) !! neighbors of each
      logical, intent(in) :: is_first(:) !! whether a path may start at each (n)
      logical, intent(in) :: is_last(:) !! whether it may end there (n)
      integer, intent(inout) :: next(:) !! which follows each on its path, -1 at the end, 0 on none (n)
      integer, intent(inout) :: previous(:) !! which comes before it, -1 at the start, 0 on none (n)
      logical, intent(out) :: seen(:, :) !! whether a search entered each, and left it (2, n)
      integer, intent(out) :: n_found !! number of paths added
      integer :: path(0:2*size(next)), arc(size(next)), depth, first, i, k

      seen = .false.
      arc = start(:size(next))
      n_found = 0
      do first = 1, size(next)
         if (seen(1, first) .or. .not. is_first(first)) cycle
         ! Items that the search entered are positive, those that it left negative.
         depth = 0
         call go(first)
         do while (depth > 0)
            i = abs(path(depth))
            if (path(depth) > 0) then
               k = merge(i, previous(i), next(i) == 0)
               if (k > 0) then
                  if (.not. seen(2, k)) then
                     call go(-k)
                     cycle
                  end if
               end if
               depth = depth - 1
               cycle
            end if
            if (is_last(i)) then
               n_found = n_found + 1
               next(i) = -1
               do k = depth - 1, 1, -1
                  i = -path(k)
                  if (i < 0) cycle
                  next(i) = merge(0, path(k + 1), path(k + 1) == i)
                  previous(path(k + 1)) = merge(0, i, path(k + 1) == i)
               end do
               previous(first) = -1
               exit
            end if
            if (next(i) /= 0 .and. .not. seen(1, i)) then
               call go(i)
               cycle
            end if
            do while (arc(i) < start(i + 1))
               k = near(arc(i))
               arc(i) = arc(i) + 1
               if (seen(1, k)) cycle
               call go(k)
               exit
            end do
            if (path(depth) == -i) depth = depth - 1
         end do
      end do

   contains

      !> Enters an item, or leaves it.
      subroutine go(to)
         integer, intent(in) :: to !! the item, negative to leave it

         depth = depth + 1
         path(depth) = to
         seen(merge(1, 2, to > 0), abs(to)) = .true.
      end subroutine go

   end subroutine add_paths

   !> Marks for each supervariable of a domain whether it lies before a cut, beyond it or in the separator.
   subroutine mark_sides(graph, side, old, is_before)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(inout) :: side(:) !! 0 for the supervariables of the domain; gains `before`, `beyond`, `separator`
      integer, intent(in) :: old(:) !! the supervariables of the domain
      logical, intent(in) :: is_before(:) !! whether each lies before the cut
      integer :: i, last

      side(old) = merge(before, beyond, is_before)
      ! Mark the separator, which is never empty: two sides that do not couple still get one, so that no domain is cut
      ! in more than two.
      last = 0
      do i = 1, size(old)
         if (side(old(i)) /= beyond) cycle
         last = old(i)
         if (couples(graph, side, old(i), before)) side(old(i)) = separator
      end do
      if (any(side(old) == beyond)) then
         ! Supervariables not coupled to any beyond the separator are removed from it: middle nodes of edges that cross
         ! it.
         do i = 1, size(old)
            if (side(old(i)) /= separator) cycle
            if (.not. couples(graph, side, old(i), beyond)) side(old(i)) = before
         end do
      end if
      if (all(side(old) /= separator)) side(last) = separator
   end subroutine mark_sides

   !> Whether a supervariable is coupled to one on a given side.
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

   !> Cuts a set of positions at the median of the coordinate with the largest range.
   pure subroutine cut_places(place, is_before)
      real(dp), intent(in) :: place(:, :) !! the places (n_dim, n) [L]
      logical, allocatable, intent(out) :: is_before(:) !! whether each lies before the cut; none at one place (n)
      real(dp) :: extent(size(place, 1))
      integer :: k, across

      allocate (is_before(size(place, 2)), source=.false.)
      if (size(place, 2) == 0) return
      extent = [(maxval(place(k, :)) - minval(place(k, :)), k=1, size(extent))]
      across = 1
      do k = 2, size(extent)
         if (extent(k) > (1.0_dp + computed_rounding)*extent(across)) across = k
      end do
      if (extent(across) > 0.0_dp) call cut_across(place(across, :), 0.5_dp, extent(across), is_before)
   end subroutine cut_places

   !> Cuts a set of positions where a share of them lies before the cut.
   pure subroutine cut_across(x, share, extent, is_before)
      real(dp), intent(in) :: x(:) !! one coordinate of the places (n) [L]
      real(dp), intent(in) :: share !! the share [-]
      real(dp), intent(in) :: extent !! the range of the coordinate [L]
      logical, allocatable, intent(out) :: is_before(:) !! whether each lies before the cut (n)
      real(dp) :: cut

      cut = quantile(x, share)
      ! A little before, so that rounding errors do not divide a row of places on one line.
      is_before = x < cut - computed_rounding*extent
      if (.not. any(is_before)) is_before = x < cut + computed_rounding*extent
      if (all(is_before)) is_before = x < cut
   end subroutine cut_across

   !> The number of a list below which a share of them lies; with half of them the median.
   pure real(dp) function quantile(numbers, share)
      real(dp), intent(in) :: numbers(:) !! the list, not empty
      real(dp), intent(in) :: share !! the share [-]
      real(dp), allocatable :: list(:)
      real(dp) :: pivot, item
      integer :: first, last, middle, i, k

      allocate (list, source=numbers)
      middle = min(size(list), max(1, int(share*(size(list) + 1))))
      first = 1
      last = size(list)
      do while (first < last)
         ! Smaller numbers go before the pivot, larger ones after it; the search continues in the part with the middle.
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
      quantile = list(middle)
   end function quantile

   !> Performs the forward substitution of some columns: x_1 := L_11^-1 x_1, x_2 := x_2 - L_21 x_1.
   pure subroutine forward_columns(n_rows, n_columns, l, x)
      integer, intent(in) :: n_rows !! number of rows, those of L_11 first
      integer, intent(in) :: n_columns !! number of columns
      real(dp), intent(in) :: l(n_rows, n_columns) !! the columns of L
      real(dp), intent(inout) :: x(n_rows) !! the vector on the rows
      integer :: j

      if (n_columns > most_narrow) then
         call dtrsv('L', 'N', 'N', n_columns, l, n_rows, x, 1)
         if (n_rows > n_columns) call dgemv('N', n_rows - n_columns, n_columns, -1.0_dp, l(n_columns + 1, 1), n_rows, &
            x, 1, 1.0_dp, x(n_columns + 1), 1)
         return
      end if
      do j = 1, n_columns
         x(j) = x(j)/l(j, j)
         x(j + 1:) = x(j + 1:) - x(j)*l(j + 1:, j)
      end do
   end subroutine forward_columns

   !> Performs the backward substitution of some columns, x_1 := L_11^-T (x_1 - L_21^T x_2), for several vectors, with
   !> one pass over the columns.
   pure subroutine backward_columns(n_rows, n_columns, n_vectors, l, x)
      integer, intent(in) :: n_rows !! number of rows, those of L_11 first
      integer, intent(in) :: n_columns !! number of columns
      integer, intent(in) :: n_vectors !! number of vectors
      real(dp), intent(in) :: l(n_rows, n_columns) !! the columns of L
      real(dp), intent(inout) :: x(n_rows, n_vectors) !! the vectors on the rows
      real(dp) :: taken
      integer :: i, j, k

      if (n_vectors == 1 .and. n_columns > most_narrow) then
         if (n_rows > n_columns) call dgemv('T', n_rows - n_columns, n_columns, -1.0_dp, l(n_columns + 1, 1), n_rows, &
            x(n_columns + 1, 1), 1, 1.0_dp, x, 1)
         call dtrsv('L', 'T', 'N', n_columns, l, n_rows, x, 1)
         return
      end if
      if (n_vectors > 1 .and. n_columns > most_narrow) then
         if (n_rows > n_columns) call dgemm('T', 'N', n_columns, n_vectors, n_rows - n_columns, -1.0_dp, &
            l(n_columns + 1, 1), n_rows, x(n_columns + 1, 1), n_rows, 1.0_dp, x, n_rows)
         call dtrsm('L', 'L', 'T', 'N', n_columns, n_vectors, 1.0_dp, l, n_rows, x, n_rows)
         return
      end if
      ! Few columns stay in the cache from one vector to the next.
      do k = 1, n_vectors
         do j = n_columns, 1, -1
            taken = 0.0_dp
            !$omp simd reduction(+:taken)
            do i = j + 1, n_rows
               taken = taken + l(i, j)*x(i, k)
            end do
            x(j, k) = (x(j, k) - taken)/l(j, j)
         end do
      end do
   end subroutine backward_columns

   !> Makes the fronts of a dissection.
   subroutine new_fronts(fronts, graph, dissection)
      type(fronts_t), intent(out) :: fronts !! the fronts
      type(graph_t), intent(in) :: graph !! the graph of the matrix
      type(dissection_t), intent(in) :: dissection !! its dissection
      integer, allocatable :: start(:), item(:), first_item(:), first_position(:), row(:)
      integer :: at, child, i, k, n, p

      call find_children(fronts, dissection, first_item)
      call list_structures(start, item, fronts, graph, dissection, first_item)
      allocate (first_position(graph%n + 1))
      first_position(1) = 1
      do k = 1, graph%n
         p = dissection%order(k)
         first_position(k + 1) = first_position(k) + graph%first_unknown(p + 1) - graph%first_unknown(p)
      end do
      allocate (fronts%first(fronts%n + 1), fronts%structure_start(fronts%n + 1), fronts%block_start(fronts%n + 1))
      fronts%first = first_position(first_item)
      fronts%structure_start(1) = 1
      fronts%block_start(1) = 1
      allocate (fronts%position(sum(first_position(item + 1) - first_position(item))))
      allocate (row(fronts%first(fronts%n + 1) - 1), fronts%parent_row(size(fronts%position)))
      n = 0
      do k = 1, fronts%n
         do at = start(k), start(k + 1) - 1
            do p = first_position(item(at)), first_position(item(at) + 1) - 1
               n = n + 1
               fronts%position(n) = p
            end do
         end do
         fronts%structure_start(k + 1) = n + 1
         fronts%block_start(k + 1) = fronts%block_start(k) + int(fronts%n_pivots(k), int64)*fronts%n_rows(k)
      end do
      do k = 1, fronts%n
         call number_rows(fronts, k, row)
         do i = 1, 2
            child = fronts%child(i, k)
            if (child == 0) cycle
            associate (first => fronts%structure_start(child), past => fronts%structure_start(child + 1))
               fronts%parent_row(first:past - 1) = row(fronts%position(first:past - 1))
            end associate
         end do
      end do
      ! The vector of the first child waits while the second child is processed; large children are processed on threads
      ! with stacks of their own.
      allocate (fronts%stack_size(fronts%n))
      do k = 1, fronts%n
         associate (children => fronts%child(:, k), stack_size => fronts%stack_size)
            n = max(fronts%n_structure(k), sum(fronts%n_structure(children)))
            if (.not. fronts%is_large(k)) then
               if (children(1) > 0) n = max(n, stack_size(children(1)))
               if (children(2) > 0) n = max(n, fronts%n_structure(children(1)) + stack_size(children(2)))
            end if
            stack_size(k) = n
         end associate
      end do
   end subroutine new_fronts

   !> Numbers the rows of a front: its pivots, then its row structure.
   pure subroutine number_rows(fronts, k, row)
      type(fronts_t), intent(in) :: fronts !! the fronts
      integer, intent(in) :: k !! number of the front
      integer, intent(inout) :: row(:) !! row of each position; those of other positions stay as they are
      integer :: i, n_pivots

      n_pivots = fronts%n_pivots(k)
      do i = 1, n_pivots
         row(fronts%first(k) - 1 + i) = i
      end do
      do i = 1, fronts%n_structure(k)
         row(fronts%position(fronts%structure_start(k) - 1 + i)) = n_pivots + i
      end do
   end subroutine number_rows

   !> Numbers the separators and finds the children of the front of each.
   pure subroutine find_children(fronts, dissection, first_item)
      type(fronts_t), intent(inout) :: fronts !! gains the children
      type(dissection_t), intent(in) :: dissection !! the dissection
      integer, allocatable, intent(out) :: first_item(:)
         !! position of the first supervariable of each front, and past the last
      integer :: orphan(size(dissection%order)), n_orphans, k, p, i

      ! There is a root even where there is no unknown.
      fronts%n = max(1, count(dissection%separator_start > 0))
      allocate (first_item(fronts%n + 1), fronts%first_descendant(fronts%n), source=1)
      allocate (fronts%child(2, fronts%n), source=0)
      k = 0
      n_orphans = 0
      do p = 1, size(dissection%order)
         if (dissection%separator_start(p) == 0) cycle
         k = k + 1
         first_item(k) = dissection%separator_start(p)
         fronts%first_descendant(k) = k
         ! The children of this front are those without a parent that lie in the domain of its separator.
         do i = 2, 1, -1
            if (n_orphans == 0) exit
            if (first_item(orphan(n_orphans)) < dissection%domain_start(p)) exit
            fronts%child(i, k) = orphan(n_orphans)
            fronts%first_descendant(k) = fronts%first_descendant(orphan(n_orphans))
            n_orphans = n_orphans - 1
         end do
         n_orphans = n_orphans + 1
         orphan(n_orphans) = k
      end do
      first_item(fronts%n + 1) = size(dissection%order) + 1
   end subroutine find_children

   !> Lists the supervariables of each row structure, before their unknowns are counted: those of its children and the
   !> neighbors of its pivots, as far as they are eliminated later.
   subroutine list_structures(start, item, fronts, graph, dissection, first_item)
      integer, allocatable, intent(out) :: start(:) !! where each list starts in `item` (n + 1)
      integer, allocatable, intent(out) :: item(:) !! positions of supervariables, ascending in each list
      type(fronts_t), intent(in) :: fronts !! the children
      type(graph_t), intent(in) :: graph !! the graph
      type(dissection_t), intent(in) :: dissection !! the order of the supervariables
      integer, intent(in) :: first_item(:) !! position of the first supervariable of each front, and past the last
      type(integer_list_t) :: items
      integer, allocatable :: found(:), position(:), seen_by(:), list_of(:), item_start(:), place(:), order(:)
      integer(int64) :: at
      integer :: child, i, k, n

      allocate (position, source=positions(dissection%order))
      allocate (found(graph%n))
      allocate (seen_by(graph%n), source=0)
      allocate (start(fronts%n + 1))
      start(1) = 1
      do k = 1, fronts%n
         n = 0
         do i = 1, 2
            child = fronts%child(i, k)
            if (child == 0) cycle
            do at = start(child), start(child + 1) - 1
               call add(items%item(at))
            end do
         end do
         do i = first_item(k), first_item(k + 1) - 1
            do at = graph%start(dissection%order(i)), graph%start(dissection%order(i) + 1) - 1
               call add(position(graph%neighbor(at)))
            end do
         end do
         call items%append_all(found(:n))
         start(k + 1) = items%n + 1
      end do
      ! Sorted by list and item: dealt out to the items, then the items to the lists, which keeps their order.
      allocate (list_of(items%n))
      do k = 1, fronts%n
         list_of(start(k):start(k + 1) - 1) = k
      end do
      item = items%items()
      call fill_bins(item_start, place, item, graph%n)
      call fill_bins(start, order, list_of(place), fronts%n)
      item = item(place(order))

   contains

      !> Finds a position beyond the pivots for the list of the front, once.
      subroutine add(p)
         integer, intent(in) :: p !! the position

         if (p < first_item(k + 1)) return
         if (seen_by(p) == k) return
         seen_by(p) = k
         n = n + 1
         found(n) = p
      end subroutine add

   end subroutine list_structures

   !> Converts the rows of a matrix in the order of elimination to rows of the fronts that its columns belong to.
   pure subroutine fronts_find_rows(self, matrix)
      class(fronts_t), intent(in) :: self !! the fronts
      type(sparse_matrix_t), intent(inout) :: matrix !! the matrix; its rows are positions, and rows of fronts on return
      integer, allocatable :: row(:)
      integer(int64) :: at
      integer :: k

      allocate (row(matrix%n))
      do k = 1, self%n
         call number_rows(self, k, row)
         do at = matrix%column_start(self%first(k)), matrix%column_start(self%first(k + 1)) - 1
            matrix%row(at) = row(matrix%row(at))
         end do
      end do
   end subroutine fronts_find_rows

   !> The number of pivot columns of a front.
   elemental integer function fronts_n_pivots(self, k) result(n_pivots)
      class(fronts_t), intent(in) :: self !! the fronts
      integer, intent(in) :: k !! number of the front

      n_pivots = self%first(k + 1) - self%first(k)
   end function fronts_n_pivots

   !> The number of unknowns in the row structure of a front.
   elemental integer function fronts_n_structure(self, k) result(n_structure)
      class(fronts_t), intent(in) :: self !! the fronts
      integer, intent(in) :: k !! number of the front, or 0 for none

      n_structure = 0
      if (k > 0) n_structure = int(self%structure_start(k + 1) - self%structure_start(k))
   end function fronts_n_structure

   !> The number of rows of a front: its pivots and its row structure.
   elemental integer function fronts_n_rows(self, k) result(n_rows)
      class(fronts_t), intent(in) :: self !! the fronts
      integer, intent(in) :: k !! number of the front

      n_rows = self%n_pivots(k) + self%n_structure(k)
   end function fronts_n_rows

   !> Whether the subtree of a front is worth a task of its own.
   elemental logical function fronts_is_large(self, k) result(is_large)
      class(fronts_t), intent(in) :: self !! the fronts
      integer, intent(in) :: k !! number of the front

      is_large = self%first(k + 1) - self%first(self%first_descendant(k)) >= least_large
   end function fronts_is_large

end module amontons_dissection
