!> The fronts of a matrix: one for each separator of its dissection, with the rows through which it acts on others; and
!> the steps of a substitution that belong to one dense block of columns of a sparse factor.
!>
!> A front eliminates its pivot columns, the unknowns of its separator. Its row structure lists the unknowns, all of
!> them eliminated later, that its pivots couple to, directly or through the domains on the two sides of the separator;
!> the fronts of these are its children. What the elimination leaves on the row structure, the contribution block, goes
!> to the parent: the row structure lies in the rows, pivots and row structure, of that one front.
module amontons_fronts
   use amontons_dissection, only: dissection_t
   use amontons_graph, only: graph_t
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dgemm, dgemv, dtrsm, dtrsv
   use amontons_sparse_matrix, only: positions, sparse_matrix_t
   implicit none (type, external)
   private

   public :: backward_columns, forward_columns, fronts_t, new_fronts

   !> Blocks of at most so many columns are faster without BLAS, whose calls have a lock for all threads; measured.
   integer, parameter :: most_narrow = 16

   !> The fronts, numbered in the order of elimination: the children of each come before it, the last one is the root.
   type :: fronts_t
      integer :: n = 0 !! number of fronts
      integer, allocatable :: first(:) !! position of the first pivot of each, and past the last one (n + 1)
      integer, allocatable :: child(:, :) !! the two children of each, 0 for none (2, n)
      integer, allocatable :: first_descendant(:) !! the first front of the subtree of each (n)
      integer(int64), allocatable :: structure_start(:) !! where the row structure of each starts (n + 1)
      integer, allocatable :: parent_row(:) !! which row of the parent each item of the row structures is
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

   !> Row structures before their unknowns are counted: a list of supervariables for each front.
   type :: lists_t
      integer(int64), allocatable :: start(:) !! where each list starts in `item` (n + 1)
      integer, allocatable :: item(:) !! positions of supervariables, in the end ascending in each list; room for more
   end type lists_t

   !> Subtrees with fewer unknowns are not worth a task of their own; a round number, not a measured one.
   integer, parameter :: least_large = 4000

contains

   !> Does the forward steps of some columns: x_1 := L_11^-1 x_1, x_2 := x_2 - L_21 x_1.
   pure subroutine forward_columns(n_rows, n_columns, l, x)
      integer, intent(in) :: n_rows !! how many rows, those of L_11 first
      integer, intent(in) :: n_columns !! how many columns
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

   !> Does the backward steps of some columns: x_1 := L_11^-T (x_1 - L_21^T x_2).
   pure subroutine backward_vector(n_rows, n_columns, l, x)
      integer, intent(in) :: n_rows !! how many rows, those of L_11 first
      integer, intent(in) :: n_columns !! how many columns
      real(dp), intent(in) :: l(n_rows, n_columns) !! the columns of L
      real(dp), intent(inout) :: x(n_rows) !! the vector on the rows
      real(dp) :: taken
      integer :: i, j

      if (n_columns > most_narrow) then
         if (n_rows > n_columns) call dgemv('T', n_rows - n_columns, n_columns, -1.0_dp, l(n_columns + 1, 1), n_rows, &
            x(n_columns + 1), 1, 1.0_dp, x, 1)
         call dtrsv('L', 'T', 'N', n_columns, l, n_rows, x, 1)
         return
      end if
      do j = n_columns, 1, -1
         taken = 0.0_dp
         !$omp simd reduction(+:taken)
         do i = j + 1, n_rows
            taken = taken + l(i, j)*x(i)
         end do
         x(j) = (x(j) - taken)/l(j, j)
      end do
   end subroutine backward_vector

   !> Does the backward steps of some columns for several vectors, with one pass over the columns.
   pure subroutine backward_columns(n_rows, n_columns, n_vectors, l, x)
      integer, intent(in) :: n_rows !! how many rows, those of L_11 first
      integer, intent(in) :: n_columns !! how many columns
      integer, intent(in) :: n_vectors !! how many vectors
      real(dp), intent(in) :: l(n_rows, n_columns) !! the columns of L
      real(dp), intent(inout) :: x(n_rows, n_vectors) !! the vectors on the rows
      integer :: k

      if (n_vectors > 1 .and. n_columns > most_narrow) then
         if (n_rows > n_columns) call dgemm('T', 'N', n_columns, n_vectors, n_rows - n_columns, -1.0_dp, &
            l(n_columns + 1, 1), n_rows, x(n_columns + 1, 1), n_rows, 1.0_dp, x, n_rows)
         call dtrsm('L', 'L', 'T', 'N', n_columns, n_vectors, 1.0_dp, l, n_rows, x, n_rows)
         return
      end if
      ! Few columns stay in the cache from one vector to the next.
      do k = 1, n_vectors
         call backward_vector(n_rows, n_columns, l, x(:, k))
      end do
   end subroutine backward_columns

   !> Makes the fronts of a dissection.
   subroutine new_fronts(fronts, graph, dissection)
      type(fronts_t), intent(out) :: fronts !! the fronts
      type(graph_t), intent(in) :: graph !! the graph of the matrix
      type(dissection_t), intent(in) :: dissection !! its dissection
      type(lists_t) :: structures
      integer, allocatable :: first_item(:), first_position(:)
      integer :: k

      call find_children(fronts, dissection, first_item)
      call list_structures(structures, fronts, graph, dissection, first_item)
      allocate (first_position(graph%n + 1))
      first_position(1) = 1
      do k = 1, graph%n
         associate (item => dissection%order(k))
            first_position(k + 1) = first_position(k) + graph%first_unknown(item + 1) - graph%first_unknown(item)
         end associate
      end do
      allocate (fronts%first(fronts%n + 1))
      fronts%first = first_position(first_item)
      call size_fronts(fronts, structures, first_position)
      call find_parent_rows(fronts, structures, first_position)
   end subroutine new_fronts

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

   !> Lists the supervariables of each row structure: those of its children and the neighbors of its pivots, as far as
   !> they are eliminated later.
   subroutine list_structures(structures, fronts, graph, dissection, first_item)
      type(lists_t), intent(out) :: structures !! the lists
      type(fronts_t), intent(in) :: fronts !! the children
      type(graph_t), intent(in) :: graph !! the graph
      type(dissection_t), intent(in) :: dissection !! the order of the supervariables
      integer, intent(in) :: first_item(:) !! position of the first supervariable of each front, and past the last
      integer, allocatable :: position(:), seen_by(:), list(:)
      integer(int64) :: at
      integer :: child, i, k, n

      allocate (position, source=positions(dissection%order))
      allocate (seen_by(graph%n), source=0)
      allocate (list(graph%n), structures%start(fronts%n + 1))
      allocate (structures%item(8*graph%n))
      structures%start(1) = 1
      do k = 1, fronts%n
         n = 0
         do i = 1, 2
            child = fronts%child(i, k)
            if (child == 0) cycle
            do at = structures%start(child), structures%start(child + 1) - 1
               call add(structures%item(at))
            end do
         end do
         do i = first_item(k), first_item(k + 1) - 1
            do at = graph%start(dissection%order(i)), graph%start(dissection%order(i) + 1) - 1
               call add(position(graph%neighbor(at)))
            end do
         end do
         call append(structures, k, list(:n))
      end do
      call sort_lists(structures, graph%n)

   contains

      !> Adds a position beyond the pivots to the list, once.
      subroutine add(p)
         integer, intent(in) :: p !! the position

         if (p < first_item(k + 1)) return
         if (seen_by(p) == k) return
         seen_by(p) = k
         n = n + 1
         list(n) = p
      end subroutine add

   end subroutine list_structures

   !> Puts the list of a front behind those before it.
   pure subroutine append(lists, k, list)
      type(lists_t), intent(inout) :: lists !! the lists
      integer, intent(in) :: k !! number of the front
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

   !> Sorts every list: dealt out to its items, the lists come back item by item.
   pure subroutine sort_lists(lists, n_items)
      type(lists_t), intent(inout) :: lists !! the lists, ascending on return
      integer, intent(in) :: n_items !! the largest item
      integer(int64), allocatable :: item_start(:), next(:)
      integer, allocatable :: list_of(:)
      integer(int64) :: at
      integer :: k, p

      allocate (item_start(n_items + 1), source=0_int64)
      do at = 1, lists%start(size(lists%start)) - 1
         item_start(lists%item(at) + 1) = item_start(lists%item(at) + 1) + 1
      end do
      item_start(1) = 1
      do p = 1, n_items
         item_start(p + 1) = item_start(p + 1) + item_start(p)
      end do
      next = item_start
      allocate (list_of(item_start(n_items + 1) - 1))
      do k = 1, size(lists%start) - 1
         do at = lists%start(k), lists%start(k + 1) - 1
            p = lists%item(at)
            list_of(next(p)) = k
            next(p) = next(p) + 1
         end do
      end do
      next = lists%start
      do p = 1, n_items
         do at = item_start(p), item_start(p + 1) - 1
            k = list_of(at)
            lists%item(next(k)) = p
            next(k) = next(k) + 1
         end do
      end do
   end subroutine sort_lists

   !> Counts the unknowns of the row structures, the entries of the blocks and the numbers on the stacks of
   !> substitutions.
   pure subroutine size_fronts(fronts, structures, first_position)
      type(fronts_t), intent(inout) :: fronts !! gains where row structures and blocks start
      type(lists_t), intent(in) :: structures !! the supervariables of the row structures
      integer, intent(in) :: first_position(:) !! position of the first unknown of each supervariable, by its position
      integer(int64) :: at
      integer :: k, n, n_structure

      allocate (fronts%structure_start(fronts%n + 1), fronts%block_start(fronts%n + 1))
      fronts%structure_start(1) = 1
      fronts%block_start(1) = 1
      do k = 1, fronts%n
         n_structure = 0
         do at = structures%start(k), structures%start(k + 1) - 1
            n_structure = n_structure + first_position(structures%item(at) + 1) - first_position(structures%item(at))
         end do
         fronts%structure_start(k + 1) = fronts%structure_start(k) + n_structure
         fronts%block_start(k + 1) = fronts%block_start(k) &
            + int(fronts%n_pivots(k), int64)*(fronts%n_pivots(k) + n_structure)
      end do
      ! What waits in a substitution. The second child is done while the vector of the first one waits; large children
      ! are done apart.
      allocate (fronts%stack_size(fronts%n))
      do k = 1, fronts%n
         associate (child => fronts%child(:, k), stack_size => fronts%stack_size)
            n = max(fronts%n_structure(k), sum(fronts%n_structure(child)))
            if (.not. fronts%is_large(k)) then
               if (child(1) > 0) n = max(n, stack_size(child(1)))
               if (child(2) > 0) n = max(n, fronts%n_structure(child(1)) + stack_size(child(2)))
            end if
            stack_size(k) = n
         end associate
      end do
   end subroutine size_fronts

   !> Finds which row of the parent each item of the row structures is.
   pure subroutine find_parent_rows(fronts, structures, first_position)
      type(fronts_t), intent(inout) :: fronts !! gains the rows
      type(lists_t), intent(in) :: structures !! the supervariables of the row structures
      integer, intent(in) :: first_position(:) !! position of the first unknown of each supervariable, by its position
      integer, allocatable :: row(:)
      integer(int64) :: at, to
      integer :: child, i, k, n, p

      allocate (row(fronts%first(fronts%n + 1) - 1))
      allocate (fronts%parent_row(fronts%structure_start(fronts%n + 1) - 1))
      do k = 1, fronts%n
         n = fronts%n_pivots(k)
         row(fronts%first(k):fronts%first(k + 1) - 1) = [(i, i=1, n)]
         do at = structures%start(k), structures%start(k + 1) - 1
            do p = first_position(structures%item(at)), first_position(structures%item(at) + 1) - 1
               n = n + 1
               row(p) = n
            end do
         end do
         do i = 1, 2
            child = fronts%child(i, k)
            if (child == 0) cycle
            to = fronts%structure_start(child)
            do at = structures%start(child), structures%start(child + 1) - 1
               do p = first_position(structures%item(at)), first_position(structures%item(at) + 1) - 1
                  fronts%parent_row(to) = row(p)
                  to = to + 1
               end do
            end do
         end do
      end do
   end subroutine find_parent_rows

   !> Turns the rows of a matrix in the order of elimination into rows of the fronts that its columns belong to.
   pure subroutine fronts_find_rows(self, matrix)
      class(fronts_t), intent(in) :: self !! the fronts
      type(sparse_matrix_t), intent(inout) :: matrix !! the matrix; its rows are positions, and rows of fronts on return
      integer, allocatable :: row(:)
      integer :: none(0)

      allocate (row(matrix%n))
      call find_subtree_rows(self, self%n, none, row, matrix)
   end subroutine fronts_find_rows

   !> Turns the rows of the pivot columns of a front and of its descendants into rows of these.
   pure recursive subroutine find_subtree_rows(fronts, k, parent, row, matrix)
      type(fronts_t), intent(in) :: fronts !! the fronts
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: parent(:) !! positions of the rows of its parent
      integer, intent(inout) :: row(:) !! row of each position in the front at hand
      type(sparse_matrix_t), intent(inout) :: matrix !! the matrix
      integer :: position(fronts%n_rows(k)), i
      integer(int64) :: at

      associate (n_pivots => fronts%n_pivots(k))
         do i = 1, size(position)
            if (i <= n_pivots) then
               position(i) = fronts%first(k) - 1 + i
            else
               position(i) = parent(fronts%parent_row(fronts%structure_start(k) - 1 + i - n_pivots))
            end if
            row(position(i)) = i
         end do
      end associate
      do at = matrix%column_start(fronts%first(k)), matrix%column_start(fronts%first(k + 1)) - 1
         matrix%row(at) = row(matrix%row(at))
      end do
      do i = 1, 2
         if (fronts%child(i, k) > 0) call find_subtree_rows(fronts, fronts%child(i, k), position, row, matrix)
      end do
   end subroutine find_subtree_rows

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

end module amontons_fronts
