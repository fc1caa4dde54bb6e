!> Orders of a sparse symmetric matrix for a narrow band that leave its Schur variables, the last unknowns, last.
module amontons_ordering
   use amontons_graph, only: graph_t, new_graph
   use amontons_kinds, only: dp, int64
   use amontons_sparse_matrix, only: positions, sparse_matrix_t
   implicit none (type, external)
   private

   public :: graph_places, half_bandwidth, reverse_cuthill_mckee

   !> The supervariables taken so far, in order.
   type :: queue_t
      integer :: n = 0 !! How many were taken.
      integer, allocatable :: item(:) !! Supervariables in the order they were taken.
      logical, allocatable :: has(:) !! Whether each was taken.
   end type queue_t

contains

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
         call sort_by_degree(graph, queue%item(old_n + 1:queue%n))
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

   !> Sorts a short list of supervariables by their number of neighbors, ascending; ties keep their order.
   pure subroutine sort_by_degree(graph, list)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(inout) :: list(:) !! the list
      integer(int64) :: degree
      integer :: i, k, item

      do i = 2, size(list)
         item = list(i)
         degree = graph%start(item + 1) - graph%start(item)
         do k = i - 1, 1, -1
            if (graph%start(list(k) + 1) - graph%start(list(k)) <= degree) exit
            list(k + 1) = list(k)
         end do
         list(k + 1) = item
      end do
   end subroutine sort_by_degree

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

end module amontons_ordering
