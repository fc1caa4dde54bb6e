!> The graph of a sparse symmetric matrix with like unknowns merged, on which orderings work, and orders for a narrow
!> band that leave the Schur variables, the last unknowns, last.
!>
!> The unknowns of one mesh node couple to the same unknowns, so merging them makes the graph a node graph:
!> a quarter of the size, and every ordering made on it keeps the unknowns of a node together.
module amontons_graph
   use amontons_kinds, only: dp, int64
   use amontons_sparse_matrix, only: positions, sorting_order, sparse_matrix_t
   implicit none (type, external)
   private

   public :: graph_places, graph_t, half_bandwidth, new_graph, reverse_cuthill_mckee

   !> Supervariables, consecutive like unknowns, and which of them couple. None is a neighbor of itself.
   type :: graph_t
      integer :: n = 0 !! Number of supervariables.
      integer :: n_schur = 0 !! How many of them, the last ones, hold the Schur variables.
      integer, allocatable :: first_unknown(:) !! First unknown of each, and past the last one (n + 1).
      integer(int64), allocatable :: start(:) !! Where the neighbors of each start (n + 1), from 1.
      integer(int64), allocatable :: neighbor(:) !! Neighbors of each, ascending, from 1.
   contains
      procedure :: expand => graph_expand
   end type graph_t

   !> The supervariables taken so far, in order.
   type :: queue_t
      integer :: n = 0 !! How many were taken.
      integer, allocatable :: item(:) !! Supervariables in the order they were taken.
      logical, allocatable :: has(:) !! Whether each was taken.
   end type queue_t

contains

   !> Makes the graph of a matrix. No supervariable holds both a Schur variable and another unknown.
   pure subroutine new_graph(graph, matrix, n_schur)
      type(graph_t), intent(out) :: graph !! the graph
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_schur !! number of Schur variables, the last unknowns
      integer, allocatable :: member_of(:)

      call merge_unknowns(matrix, n_schur, member_of, graph%first_unknown)
      graph%n = size(graph%first_unknown) - 1
      if (n_schur > 0) graph%n_schur = graph%n - member_of(matrix%n - n_schur + 1) + 1
      call list_neighbors(graph, matrix, member_of)
   end subroutine new_graph

   !> Merges consecutive unknowns that couple to the same unknowns.
   pure subroutine merge_unknowns(matrix, n_schur, member_of, first_unknown)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_schur !! number of Schur variables, the last unknowns
      integer, allocatable, intent(out) :: member_of(:) !! supervariable of each unknown (n)
      integer, allocatable, intent(out) :: first_unknown(:) !! first unknown of each, and past the last one
      integer(int64), allocatable :: signature(:)
      integer :: j, n_merged

      allocate (member_of(matrix%n), signature(matrix%n))
      call sign_columns(matrix, signature)
      n_merged = 0
      do j = 1, matrix%n
         if (j == 1 .or. j == matrix%n - n_schur + 1) then
            n_merged = n_merged + 1
         else if (signature(j) /= signature(j - 1)) then
            n_merged = n_merged + 1
         end if
         member_of(j) = n_merged
      end do
      allocate (first_unknown(n_merged + 1))
      do j = matrix%n, 1, -1
         first_unknown(member_of(j)) = j
      end do
      first_unknown(n_merged + 1) = matrix%n + 1
   end subroutine merge_unknowns

   !> Gives every column a number that equal full columns share and, all but surely, no others.
   !>
   !> A wrong merge would only make an ordering worse: it stays a permutation.
   pure subroutine sign_columns(matrix, signature)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer(int64), intent(out) :: signature(:) !! a number for each column (n)
      integer(int64), allocatable :: word(:)
      integer(int64) :: at, state
      integer :: i, j

      allocate (word(matrix%n))
      state = 88172645463325252_int64
      do j = 1, matrix%n
         state = ieor(state, shiftl(state, 13))
         state = ieor(state, shiftr(state, 7))
         state = ieor(state, shiftl(state, 17))
         word(j) = state
      end do
      signature = word
      do j = 1, matrix%n
         do at = matrix%column_start(j) + 1, matrix%column_start(j + 1) - 1
            i = matrix%row(at)
            signature(j) = ieor(signature(j), word(i))
            signature(i) = ieor(signature(i), word(j))
         end do
      end do
   end subroutine sign_columns

   !> Lists the neighbors of every supervariable, read off its first unknown.
   pure subroutine list_neighbors(graph, matrix, member_of)
      type(graph_t), intent(inout) :: graph !! the graph, its supervariables known
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: member_of(:) !! supervariable of each unknown (n)
      integer(int64), allocatable :: next(:)
      integer(int64) :: at
      integer :: pass, g, h, last

      allocate (next(graph%n + 1), source=0_int64)
      ! The first pass counts, the second one writes.
      do pass = 1, 2
         do g = 1, graph%n
            last = g
            do at = matrix%column_start(graph%first_unknown(g)), matrix%column_start(graph%first_unknown(g) + 1) - 1
               h = member_of(matrix%row(at))
               if (h == last) cycle
               last = h
               if (pass == 2) then
                  graph%neighbor(next(g)) = h
                  graph%neighbor(next(h)) = g
               end if
               next(g) = next(g) + 1
               next(h) = next(h) + 1
            end do
         end do
         if (pass == 2) cycle
         allocate (graph%start(graph%n + 1))
         graph%start(1) = 1
         do g = 1, graph%n
            graph%start(g + 1) = graph%start(g) + next(g)
         end do
         next = graph%start
         allocate (graph%neighbor(graph%start(graph%n + 1) - 1))
      end do
   end subroutine list_neighbors

   !> Turns an order of the supervariables into the order of the unknowns.
   pure subroutine graph_expand(self, graph_order, order)
      class(graph_t), intent(in) :: self !! the graph
      integer, intent(in) :: graph_order(:) !! position k holds supervariable graph_order(k) (n supervariables)
      integer, intent(out) :: order(:) !! position k holds unknown order(k) (n unknowns)
      integer :: k, at, j

      at = 0
      do k = 1, self%n
         do j = self%first_unknown(graph_order(k)), self%first_unknown(graph_order(k) + 1) - 1
            at = at + 1
            order(at) = j
         end do
      end do
   end subroutine graph_expand

   !> Reverse Cuthill-McKee order: a narrow band.
   pure subroutine reverse_cuthill_mckee(matrix, n_schur, order)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_schur !! number of Schur variables
      integer, intent(out) :: order(:) !! position k holds unknown order(k) (n)
      type(graph_t) :: graph

      call new_graph(graph, matrix, n_schur)
      call graph%expand(narrow_order(graph), order)
   end subroutine reverse_cuthill_mckee

   !> Stands in for places that nobody knows: neighbors in the graph get neighboring numbers.
   pure function graph_places(graph) result(place)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), allocatable :: place(:, :)
      integer, allocatable :: position(:)

      allocate (position, source=positions(narrow_order(graph)))
      allocate (place(2, graph%n - graph%n_schur), source=0.0_dp)
      place(1, :) = position(:graph%n - graph%n_schur)
   end function graph_places

   !> The supervariables in reverse Cuthill-McKee order.
   !>
   !> The level structure grows from the Schur variables, so that reversed they come last.
   pure function narrow_order(graph) result(graph_order)
      type(graph_t), intent(in) :: graph !! the graph
      integer, allocatable :: graph_order(:)
      type(queue_t) :: queue
      integer :: seed

      allocate (queue%item(graph%n), queue%has(graph%n))
      queue%has = .false.
      do seed = graph%n - graph%n_schur + 1, graph%n
         if (.not. queue%has(seed)) call append_component(graph, seed, graph%n - graph%n_schur + 1, queue)
      end do
      call grow(graph, 1, 1, queue)
      do seed = 1, graph%n - graph%n_schur
         if (.not. queue%has(seed)) call append_component(graph, seed, 1, queue)
      end do
      graph_order = queue%item(graph%n:1:-1)
   end function narrow_order

   !> Takes everything connected to a supervariable, starting from one far out.
   pure subroutine append_component(graph, seed, lowest, queue)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: seed !! any supervariable of the component, not yet taken
      integer, intent(in) :: lowest !! supervariables below this one do not count
      type(queue_t), intent(inout) :: queue !! those taken, the component added
      integer :: first, start, n_levels, most_levels

      first = queue%n + 1
      start = seed
      most_levels = 0
      do
         queue%n = first
         queue%item(first) = start
         queue%has(start) = .true.
         call grow(graph, first, lowest, queue, n_levels)
         if (n_levels <= most_levels) exit
         ! The last one of the deepest structure so far is a better start.
         most_levels = n_levels
         start = queue%item(queue%n)
         queue%has(queue%item(first:queue%n)) = .false.
      end do
   end subroutine append_component

   !> Takes the untaken neighbors of what is in the queue, level by level, until there are none.
   pure subroutine grow(graph, first, lowest, queue, n_levels)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: first !! place in the queue of the first one to grow from
      integer, intent(in) :: lowest !! supervariables below this one do not count
      type(queue_t), intent(inout) :: queue !! the supervariables taken
      integer, intent(out), optional :: n_levels !! number of levels, that grown from included
      integer :: at, depth, level_end, old_n

      at = first
      depth = 1
      level_end = queue%n
      do while (at <= queue%n)
         if (at > level_end) then
            depth = depth + 1
            level_end = queue%n
         end if
         old_n = queue%n
         call take_neighbors(graph, queue%item(at), lowest, queue)
         ! By their number of neighbors, ascending; ties keep their order.
         associate (list => queue%item(old_n + 1:queue%n))
            list = list(sorting_order(int(graph%start(list + 1) - graph%start(list))))
         end associate
         at = at + 1
      end do
      if (present(n_levels)) n_levels = depth
   end subroutine grow

   !> Takes the untaken neighbors of one supervariable.
   pure subroutine take_neighbors(graph, center, lowest, queue)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: center !! the supervariable
      integer, intent(in) :: lowest !! supervariables below this one do not count
      type(queue_t), intent(inout) :: queue !! the supervariables taken
      integer(int64) :: at
      integer :: other

      do at = graph%start(center), graph%start(center + 1) - 1
         other = int(graph%neighbor(at))
         if (other < lowest) cycle
         if (queue%has(other)) cycle
         queue%has(other) = .true.
         queue%n = queue%n + 1
         queue%item(queue%n) = other
      end do
   end subroutine take_neighbors

   !> The largest distance between two positions whose unknowns couple.
   pure integer function half_bandwidth(matrix, order)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: order(:) !! position k holds unknown order(k) (n)
      integer, allocatable :: position(:)
      integer(int64) :: at
      integer :: j

      allocate (position, source=positions(order))
      half_bandwidth = 0
      do j = 1, matrix%n
         do at = matrix%column_start(j), matrix%column_start(j + 1) - 1
            half_bandwidth = max(half_bandwidth, abs(position(matrix%row(at)) - position(j)))
         end do
      end do
   end function half_bandwidth

end module amontons_graph
