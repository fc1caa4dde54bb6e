!> Elimination orders of a sparse symmetric matrix that leave its trailing unknowns last.
module amontons_ordering
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_graph, only: graph_t, new_graph
   use amontons_kinds, only: dp, int64
   use amontons_sparse_matrix, only: positions, sparse_matrix_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: graph_places, half_bandwidth, minimum_degree, reverse_cuthill_mckee

   !> The groups taken so far, in order.
   type :: queue_t
      integer :: n = 0 !! How many were taken.
      integer, allocatable :: group(:) !! Groups in the order they were taken.
      logical, allocatable :: has(:) !! Whether each group was taken.
   end type queue_t

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      function camd_order(n, start, neighbour, constraint, order) bind(c, name='amontons_camd_order') result(code)
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: n
         integer(c_int64_t), intent(in) :: start(*), neighbour(*), constraint(*)
         integer(c_int64_t), intent(out) :: order(*)
         integer(c_int) :: code
      end function camd_order
   end interface

contains

   !> Approximate minimum degree order: little fill.
   subroutine minimum_degree(matrix, n_trailing, order, error)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_trailing !! number of trailing unknowns
      integer, intent(out) :: order(:) !! position k holds unknown order(k) (n)
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(graph_t) :: graph
      integer(int64), allocatable :: constraint(:), group_order(:)

      call new_graph(graph, matrix, n_trailing)
      allocate (constraint(graph%n), source=0_int64)
      allocate (group_order(graph%n))
      ! The sets in use must be numbered from 0.
      if (graph%n_trailing < graph%n) constraint(graph%n - graph%n_trailing + 1:) = 1
      graph%start = graph%start - 1
      graph%neighbour = graph%neighbour - 1
      if (camd_order(int(graph%n, int64), graph%start, graph%neighbour, constraint, group_order) /= 0) then
         ! not raised: no test may use up the machine's memory
         call new_error(error, system_failure, 'memory ran out while ordering '//to_text(matrix%n)//' unknowns')
         return
      end if
      call graph%expand(int(group_order) + 1, order)
   end subroutine minimum_degree

   !> Reverse Cuthill-McKee order: a narrow band.
   pure subroutine reverse_cuthill_mckee(matrix, n_trailing, order)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_trailing !! number of trailing unknowns
      integer, intent(out) :: order(:) !! position k holds unknown order(k) (n)
      type(graph_t) :: graph

      call new_graph(graph, matrix, n_trailing)
      call graph%expand(narrow_order(graph), order)
   end subroutine reverse_cuthill_mckee

   !> Stands in for places that nobody knows: neighbours in the graph get neighbouring numbers.
   pure function graph_places(graph) result(place)
      type(graph_t), intent(in) :: graph !! the graph
      real(dp), allocatable :: place(:, :)
      integer, allocatable :: position(:)

      allocate (position, source=positions(narrow_order(graph)))
      allocate (place(2, graph%n - graph%n_trailing), source=0.0_dp)
      place(1, :) = position(:graph%n - graph%n_trailing)
   end function graph_places

   !> The groups in reverse Cuthill-McKee order.
   !>
   !> The level structure grows from the trailing unknowns, so that reversed they come last.
   pure function narrow_order(graph) result(group_order)
      type(graph_t), intent(in) :: graph !! the graph
      integer, allocatable :: group_order(:)
      type(queue_t) :: queue
      integer :: seed

      allocate (queue%group(graph%n), queue%has(graph%n))
      queue%has = .false.
      do seed = graph%n - graph%n_trailing + 1, graph%n
         if (.not. queue%has(seed)) call append_component(graph, seed, graph%n - graph%n_trailing + 1, queue)
      end do
      call grow(graph, 1, 1, queue)
      do seed = 1, graph%n - graph%n_trailing
         if (.not. queue%has(seed)) call append_component(graph, seed, 1, queue)
      end do
      group_order = queue%group(graph%n:1:-1)
   end function narrow_order

   !> Takes everything connected to a group, starting from a group far out.
   pure subroutine append_component(graph, seed, lowest, queue)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: seed !! any group of the component, not yet taken
      integer, intent(in) :: lowest !! groups below this one do not count
      type(queue_t), intent(inout) :: queue !! the groups taken, the component added
      integer :: first, start, n_levels, most_levels

      first = queue%n + 1
      start = seed
      most_levels = 0
      do
         queue%n = first
         queue%group(first) = start
         queue%has(start) = .true.
         call grow(graph, first, lowest, queue, n_levels)
         if (n_levels <= most_levels) exit
         ! The last group of the deepest structure so far is a better start.
         most_levels = n_levels
         start = queue%group(queue%n)
         queue%has(queue%group(first:queue%n)) = .false.
      end do
   end subroutine append_component

   !> Takes the untaken neighbours of the groups in the queue, level by level, until there are none.
   pure subroutine grow(graph, first, lowest, queue, n_levels)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: first !! place in the queue of the first group to grow from
      integer, intent(in) :: lowest !! groups below this one do not count
      type(queue_t), intent(inout) :: queue !! the groups taken
      integer, intent(out), optional :: n_levels !! number of levels, the groups grown from included
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
         call take_neighbours(graph, queue%group(at), lowest, queue)
         call sort_by_degree(graph, queue%group(old_n + 1:queue%n))
         at = at + 1
      end do
      if (present(n_levels)) n_levels = depth
   end subroutine grow

   !> Takes the untaken neighbours of one group.
   pure subroutine take_neighbours(graph, group, lowest, queue)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: group !! the group
      integer, intent(in) :: lowest !! groups below this one do not count
      type(queue_t), intent(inout) :: queue !! the groups taken
      integer(int64) :: at
      integer :: other

      do at = graph%start(group), graph%start(group + 1) - 1
         other = int(graph%neighbour(at))
         if (other < lowest) cycle
         if (queue%has(other)) cycle
         queue%has(other) = .true.
         queue%n = queue%n + 1
         queue%group(queue%n) = other
      end do
   end subroutine take_neighbours

   !> Sorts a short list of groups by their number of neighbours, ascending; ties keep their order.
   pure subroutine sort_by_degree(graph, group)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(inout) :: group(:) !! the groups
      integer(int64) :: degree
      integer :: i, k, item

      do i = 2, size(group)
         item = group(i)
         degree = graph%start(item + 1) - graph%start(item)
         do k = i - 1, 1, -1
            if (graph%start(group(k) + 1) - graph%start(group(k)) <= degree) exit
            group(k + 1) = group(k)
         end do
         group(k + 1) = item
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
