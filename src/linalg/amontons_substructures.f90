!> The substructures of a matrix: the pieces of its dissection, each with the boundary through which it acts on others.
!>
!> Every piece eliminates its own unknowns. What it leaves behind is a full matrix on its boundary: the unknowns, all of
!> them eliminated later, that its own ones couple to, directly or through the pieces cut off by it, its parts. The
!> boundary lies in the rows, own unknowns and boundary, of the one piece that this piece is a part of.
module amontons_substructures
   use amontons_dissection, only: dissection_t
   use amontons_graph, only: graph_t
   use amontons_kinds, only: dp, int64
   use amontons_sparse_matrix, only: positions, sparse_matrix_t
   implicit none (type, external)
   private

   public :: new_substructures, substructures_t

   !> The substructures, numbered in the order of elimination: the parts of each come before it, the last one is the
   !> top, of which all others are parts.
   type :: substructures_t
      integer :: n = 0 !! number of substructures
      integer, allocatable :: first(:) !! position of the first unknown of each, and past the last one (n + 1)
      integer, allocatable :: part(:, :) !! the two parts of each, 0 for none (2, n)
      integer, allocatable :: first_below(:) !! the first of those that are parts of each or of its parts (n)
      integer(int64), allocatable :: boundary_start(:) !! where the boundary of each starts in `place` (n + 1)
      integer, allocatable :: place(:) !! which row of the next larger substructure each boundary unknown is
      integer(int64), allocatable :: block_start(:)
         !! where the block of each starts, its own columns on all of its rows, when one follows the other (n + 1)
      integer, allocatable :: n_waiting(:)
         !! how many boundary unknowns, of each and of its small parts, wait at most at a time in a substitution (n)
   contains
      procedure :: n_boundary => substructures_n_boundary
      procedure :: n_own => substructures_n_own
      procedure :: n_rows => substructures_n_rows
      procedure :: is_large => substructures_is_large
   end type substructures_t

   !> Lists of groups, one for each substructure: the boundaries before their unknowns are counted.
   type :: lists_t
      integer(int64), allocatable :: start(:) !! where each list starts in `item` (n + 1)
      integer, allocatable :: item(:) !! positions of the groups, ascending in each list, and room for more
   end type lists_t

   !> Substructures with fewer unknowns, those of their parts included, are not worth a task of their own; a round
   !> number, not a measured one.
   integer, parameter :: least_large = 4000

contains

   !> Makes the substructures of a dissection.
   subroutine new_substructures(substructures, graph, dissection, matrix)
      type(substructures_t), intent(out) :: substructures !! the substructures
      type(graph_t), intent(in) :: graph !! the graph of the matrix
      type(dissection_t), intent(in) :: dissection !! its dissection
      type(sparse_matrix_t), intent(inout) :: matrix
         !! the matrix in the order of elimination; its rows become rows of the substructures
      type(lists_t) :: boundaries
      integer, allocatable :: first_group(:), first_position(:)
      integer :: k

      call list_pieces(substructures, dissection, first_group)
      call list_boundaries(boundaries, substructures, graph, dissection, first_group)
      allocate (first_position(graph%n + 1))
      first_position(1) = 1
      do k = 1, graph%n
         associate (group => dissection%order(k))
            first_position(k + 1) = first_position(k) + graph%first_unknown(group + 1) - graph%first_unknown(group)
         end associate
      end do
      allocate (substructures%first(substructures%n + 1))
      substructures%first = first_position(first_group)
      call size_substructures(substructures, boundaries, first_position)
      call find_places(substructures, boundaries, first_position, matrix)
   end subroutine new_substructures

   !> Numbers the pieces and finds the parts of each.
   pure subroutine list_pieces(substructures, dissection, first_group)
      type(substructures_t), intent(inout) :: substructures !! gains the parts
      type(dissection_t), intent(in) :: dissection !! the dissection
      integer, allocatable, intent(out) :: first_group(:)
         !! position of the first group of each piece, and past the last
      integer :: waiting(size(dissection%order)), n_waiting, k, p, i

      ! There is a top even where there is no unknown.
      substructures%n = max(1, count(dissection%piece_start > 0))
      allocate (first_group(substructures%n + 1), substructures%first_below(substructures%n), source=1)
      allocate (substructures%part(2, substructures%n), source=0)
      k = 0
      n_waiting = 0
      do p = 1, size(dissection%order)
         if (dissection%piece_start(p) == 0) cycle
         k = k + 1
         first_group(k) = dissection%piece_start(p)
         substructures%first_below(k) = k
         ! Those that wait are no parts yet. The parts of this one lie in the set it was cut from.
         do i = 2, 1, -1
            if (n_waiting == 0) exit
            if (first_group(waiting(n_waiting)) < dissection%set_start(p)) exit
            substructures%part(i, k) = waiting(n_waiting)
            substructures%first_below(k) = substructures%first_below(waiting(n_waiting))
            n_waiting = n_waiting - 1
         end do
         n_waiting = n_waiting + 1
         waiting(n_waiting) = k
      end do
      first_group(substructures%n + 1) = size(dissection%order) + 1
   end subroutine list_pieces

   !> Lists the groups of each boundary.
   subroutine list_boundaries(boundaries, substructures, graph, dissection, first_group)
      type(lists_t), intent(out) :: boundaries !! the lists
      type(substructures_t), intent(in) :: substructures !! the parts
      type(graph_t), intent(in) :: graph !! the graph
      type(dissection_t), intent(in) :: dissection !! the order of the groups
      integer, intent(in) :: first_group(:) !! position of the first group of each piece, and past the last
      integer, allocatable :: position(:), seen_by(:), list(:)
      integer(int64) :: at
      integer :: i, k, n, n_merged, p

      allocate (position, source=positions(dissection%order))
      allocate (seen_by(graph%n), source=0)
      allocate (list(graph%n), boundaries%start(substructures%n + 1))
      allocate (boundaries%item(8*graph%n))
      boundaries%start(1) = 1
      do k = 1, substructures%n
         call merge_parts(boundaries, substructures%part(:, k), first_group(k + 1), list, n_merged)
         seen_by(list(:n_merged)) = k
         n = n_merged
         do i = first_group(k), first_group(k + 1) - 1
            associate (group => dissection%order(i))
               do at = graph%start(group), graph%start(group + 1) - 1
                  p = position(graph%neighbour(at))
                  if (p < first_group(k + 1)) cycle
                  if (seen_by(p) == k) cycle
                  seen_by(p) = k
                  n = n + 1
                  list(n) = p
               end do
            end associate
         end do
         if (n > n_merged) call sort(list(:n))
         call append(boundaries, k, list(:n))
      end do
   end subroutine list_boundaries

   !> Merges the boundaries of two parts, as far as they lie beyond the piece that they are parts of.
   pure subroutine merge_parts(boundaries, part, past, list, n)
      type(lists_t), intent(in) :: boundaries !! the boundaries so far
      integer, intent(in) :: part(2) !! the parts, 0 for none
      integer, intent(in) :: past !! the first position beyond the piece
      integer, intent(inout) :: list(:) !! the merged list, ascending
      integer, intent(out) :: n !! its length
      integer(int64) :: at(2), past_end(2)
      integer :: i, item(2)

      do i = 1, 2
         at(i) = 1
         past_end(i) = 1
         if (part(i) == 0) cycle
         at(i) = boundaries%start(part(i))
         past_end(i) = boundaries%start(part(i) + 1)
         do while (at(i) < past_end(i))
            if (boundaries%item(at(i)) >= past) exit
            at(i) = at(i) + 1
         end do
      end do
      n = 0
      do while (any(at < past_end))
         item = huge(1)
         if (at(1) < past_end(1)) item(1) = boundaries%item(at(1))
         if (at(2) < past_end(2)) item(2) = boundaries%item(at(2))
         n = n + 1
         list(n) = minval(item)
         where (item == list(n)) at = at + 1
      end do
   end subroutine merge_parts

   !> Puts the list of a substructure behind those before it.
   pure subroutine append(lists, k, list)
      type(lists_t), intent(inout) :: lists !! the lists
      integer, intent(in) :: k !! number of the substructure
      integer, intent(in) :: list(:) !! its list
      integer, allocatable :: item(:)

      lists%start(k + 1) = lists%start(k) + size(list)
      if (lists%start(k + 1) - 1 > size(lists%item, kind=int64)) then
         allocate (item(2*lists%start(k + 1)))
         item(:lists%start(k) - 1) = lists%item(:lists%start(k) - 1)
         call move_alloc(item, lists%item)
      end if
      lists%item(lists%start(k):lists%start(k + 1) - 1) = list
   end subroutine append

   !> Sorts a list by merging the runs that ascend in it, of which there are few.
   pure subroutine sort(list)
      integer, intent(inout) :: list(:) !! the list, ascending on return
      integer :: merged(size(list)), first, middle, last, n_runs

      do
         n_runs = 0
         last = 0
         do while (last < size(list))
            first = last + 1
            middle = run_end(list, first)
            last = middle
            if (middle < size(list)) last = run_end(list, middle + 1)
            call merge_runs(list(first:middle), list(middle + 1:last), merged(first:last))
            n_runs = n_runs + 1
         end do
         list = merged
         if (n_runs <= 1) return
      end do
   end subroutine sort

   !> Where the run ends that ascends from a place on.
   pure integer function run_end(list, first)
      integer, intent(in) :: list(:) !! the list
      integer, intent(in) :: first !! the place

      run_end = first
      do while (run_end < size(list))
         if (list(run_end + 1) < list(run_end)) exit
         run_end = run_end + 1
      end do
   end function run_end

   !> Merges two ascending lists.
   pure subroutine merge_runs(a, b, merged)
      integer, intent(in) :: a(:) !! one list
      integer, intent(in) :: b(:) !! the other one
      integer, intent(out) :: merged(:) !! the items of both, ascending
      integer :: i, j, k

      i = 1
      j = 1
      do k = 1, size(merged)
         if (j > size(b)) then
            merged(k) = a(i)
            i = i + 1
         else if (i > size(a)) then
            merged(k) = b(j)
            j = j + 1
         else if (a(i) <= b(j)) then
            merged(k) = a(i)
            i = i + 1
         else
            merged(k) = b(j)
            j = j + 1
         end if
      end do
   end subroutine merge_runs

   !> Counts the unknowns of the boundaries and the entries of the columns.
   pure subroutine size_substructures(substructures, boundaries, first_position)
      type(substructures_t), intent(inout) :: substructures !! gains where boundaries and columns start
      type(lists_t), intent(in) :: boundaries !! the groups of the boundaries
      integer, intent(in) :: first_position(:) !! position of the first unknown of each group, by position of the group
      integer(int64) :: at
      integer :: k, n_boundary

      allocate (substructures%boundary_start(substructures%n + 1), substructures%block_start(substructures%n + 1))
      substructures%boundary_start(1) = 1
      substructures%block_start(1) = 1
      do k = 1, substructures%n
         n_boundary = 0
         do at = boundaries%start(k), boundaries%start(k + 1) - 1
            n_boundary = n_boundary + first_position(boundaries%item(at) + 1) - first_position(boundaries%item(at))
         end do
         substructures%boundary_start(k + 1) = substructures%boundary_start(k) + n_boundary
         substructures%block_start(k + 1) = substructures%block_start(k) &
            + int(substructures%n_own(k), int64)*(substructures%n_own(k) + n_boundary)
      end do
      call count_waiting(substructures)
   end subroutine size_substructures

   !> Counts what waits. The second part is done while the boundary of the first one waits; large parts are done apart.
   pure subroutine count_waiting(substructures)
      type(substructures_t), intent(inout) :: substructures !! the substructures, their boundaries counted
      integer :: k, n

      allocate (substructures%n_waiting(substructures%n))
      do k = 1, substructures%n
         associate (part => substructures%part(:, k), waiting => substructures%n_waiting)
            n = max(substructures%n_boundary(k), sum(substructures%n_boundary(part)))
            if (.not. substructures%is_large(k)) then
               if (part(1) > 0) n = max(n, waiting(part(1)))
               if (part(2) > 0) n = max(n, substructures%n_boundary(part(1)) + waiting(part(2)))
            end if
            waiting(k) = n
         end associate
      end do
   end subroutine count_waiting

   !> Finds which row of the next larger substructure each boundary unknown is, and which row of its own substructure
   !> each row of the matrix.
   subroutine find_places(substructures, boundaries, first_position, matrix)
      type(substructures_t), intent(inout) :: substructures !! gains the places
      type(lists_t), intent(in) :: boundaries !! the groups of the boundaries
      integer, intent(in) :: first_position(:) !! position of the first unknown of each group, by position of the group
      type(sparse_matrix_t), intent(inout) :: matrix !! the matrix in the order of elimination
      integer, allocatable :: row(:)
      integer(int64) :: at, entry, to
      integer :: i, k, n, p, part

      allocate (row(matrix%n))
      allocate (substructures%place(substructures%boundary_start(substructures%n + 1) - 1))
      do k = 1, substructures%n
         do n = 1, substructures%n_own(k)
            row(substructures%first(k) - 1 + n) = n
         end do
         n = substructures%n_own(k)
         do at = boundaries%start(k), boundaries%start(k + 1) - 1
            do p = first_position(boundaries%item(at)), first_position(boundaries%item(at) + 1) - 1
               n = n + 1
               row(p) = n
            end do
         end do
         do entry = matrix%column_start(substructures%first(k)), matrix%column_start(substructures%first(k + 1)) - 1
            matrix%row(entry) = row(matrix%row(entry))
         end do
         do i = 1, 2
            part = substructures%part(i, k)
            if (part == 0) cycle
            to = substructures%boundary_start(part)
            do at = boundaries%start(part), boundaries%start(part + 1) - 1
               do p = first_position(boundaries%item(at)), first_position(boundaries%item(at) + 1) - 1
                  substructures%place(to) = row(p)
                  to = to + 1
               end do
            end do
         end do
      end do
   end subroutine find_places

   !> The number of unknowns of a substructure's own.
   elemental integer function substructures_n_own(self, k) result(n_own)
      class(substructures_t), intent(in) :: self !! the substructures
      integer, intent(in) :: k !! number of the substructure

      n_own = self%first(k + 1) - self%first(k)
   end function substructures_n_own

   !> The number of unknowns on the boundary of a substructure.
   elemental integer function substructures_n_boundary(self, k) result(n_boundary)
      class(substructures_t), intent(in) :: self !! the substructures
      integer, intent(in) :: k !! number of the substructure, or 0 for none

      n_boundary = 0
      if (k > 0) n_boundary = int(self%boundary_start(k + 1) - self%boundary_start(k))
   end function substructures_n_boundary

   !> The number of rows of a substructure: its own unknowns and its boundary.
   elemental integer function substructures_n_rows(self, k) result(n_rows)
      class(substructures_t), intent(in) :: self !! the substructures
      integer, intent(in) :: k !! number of the substructure

      n_rows = self%n_own(k) + self%n_boundary(k)
   end function substructures_n_rows

   !> Whether a substructure, together with its parts, is worth a task of its own.
   elemental logical function substructures_is_large(self, k) result(is_large)
      class(substructures_t), intent(in) :: self !! the substructures
      integer, intent(in) :: k !! number of the substructure

      is_large = self%first(k + 1) - self%first(self%first_below(k)) >= least_large
   end function substructures_is_large

end module amontons_substructures
