!> A sparse symmetric matrix and its assembly from small dense blocks; its graph, with unknowns of equal neighbors
!> merged, for orderings; and orders for a narrow band in which the Schur variables, which are the last unknowns, remain
!> last.
!>
!> The unknowns of one mesh node couple to the same unknowns, so merging them makes the graph a node graph: a quarter of
!> the size, and every ordering found with it keeps the unknowns of a node together.
module amontons_sparse_matrix
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp, int64
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: entries_t, graph_places, graph_t, half_bandwidth, new_graph, new_sparse_pattern, positions, &
      reverse_cuthill_mckee, sparse_matrix_t

   !> A symmetric matrix, its lower triangle stored by columns: every column starts with its diagonal entry.
   type :: sparse_matrix_t
      integer :: n = 0 !! Order of the matrix.
      integer(int64), allocatable :: column_start(:) !! Where column j starts in `row` and `value` (n + 1).
      integer, allocatable :: row(:) !! Row of each stored entry, ascending within a column.
      real(dp), allocatable :: value(:) !! Value of each stored entry.
      real(dp), allocatable :: place(:, :) !! Position of each unknown, if positions are known (2, n) [L].
   contains
      procedure :: add_element => sparse_matrix_add_element
      procedure :: diagonal => sparse_matrix_diagonal
      procedure :: multiply => sparse_matrix_multiply
      procedure :: norm => sparse_matrix_norm
      procedure :: permute => sparse_matrix_permute
      procedure :: shift_diagonal => sparse_matrix_shift_diagonal
   end type sparse_matrix_t

   !> A list of entries of a rectangular matrix, in any order; those of one place add up.
   type :: entries_t
      integer :: n = 0 !! Number of entries.
      integer, allocatable :: row(:) !! Rows of the entries, and room for more (at least n).
      integer, allocatable :: column(:) !! Their columns (at least n).
      real(dp), allocatable :: value(:) !! Their values (at least n).
   contains
      procedure :: add => entries_add
      procedure :: multiply => entries_multiply
      procedure :: multiply_transposed => entries_multiply_transposed
   end type entries_t

   !> A graph of supervariables, which are consecutive unknowns with equal neighbors, and of their couplings. None is a
   !> neighbor of itself.
   type :: graph_t
      integer :: n = 0 !! Number of supervariables.
      integer :: n_schur = 0 !! How many of them, the last ones, hold the Schur variables.
      integer, allocatable :: first_unknown(:) !! First unknown of each, and past the last one (n + 1).
      integer(int64), allocatable :: start(:) !! Where the neighbors of each start (n + 1), from 1.
      integer(int64), allocatable :: neighbor(:) !! Neighbors of each, ascending, from 1.
   contains
      procedure :: expand => graph_expand
   end type graph_t

   !> The supervariables visited so far, in order.
   type :: queue_t
      integer :: n = 0 !! How many were taken.
      integer, allocatable :: item(:) !! Supervariables in the order they were taken.
      logical, allocatable :: has(:) !! Whether each was taken.
   end type queue_t

contains

   !> Makes a zero matrix with entries for all couplings by elements, and for the diagonal.
   subroutine new_sparse_pattern(matrix, n, list_start, list, error)
      type(sparse_matrix_t), intent(out) :: matrix !! the matrix, all values zero
      integer, intent(in) :: n !! its order
      integer, contiguous, intent(in) :: list_start(:) !! where each element starts in `list` (n_elements + 1)
      integer, contiguous, intent(in) :: list(:) !! the unknowns of each element, 1 to n; 0 stands for none
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer, allocatable :: element_start(:), element(:), element_of(:), last_seen(:), row(:)
      integer(int64) :: at, most_entries, n_rows
      integer :: i, j, k, p, status
      logical :: is_like_last

      matrix%n = n
      ! The elements of each unknown, from the unknowns of each element; and the most entries of a lower triangle: the
      ! diagonal, and every pair of unknowns of an element.
      allocate (element_of(size(list)))
      most_entries = n
      do k = 1, size(list_start) - 1
         element_of(list_start(k):list_start(k + 1) - 1) = k
         n_rows = list_start(k + 1) - list_start(k)
         most_entries = most_entries + n_rows*(n_rows - 1)/2
      end do
      call fill_bins(element_start, element, list, n)
      element = element_of(element)
      deallocate (element_of)
      allocate (last_seen(n), matrix%column_start(n + 1), row(most_entries), stat=status)
      if (status == 0) then
         ! The rows of each column: the distinct unknowns that share an element with it and are not below it.
         last_seen = 0
         at = 0
         do j = 1, n
            matrix%column_start(j) = at + 1
            associate (first => element_start(j), past => element_start(j + 1))
               is_like_last = j > 1 .and. past > first
               if (is_like_last) is_like_last = first - element_start(j - 1) == past - first
               if (is_like_last) is_like_last = all(element(element_start(j - 1):first - 1) == element(first:past - 1))
            end associate
            if (is_like_last) then
               ! Of two unknowns of a node the second couples to what the first does, but for the first itself.
               n_rows = at - matrix%column_start(j - 1)
               row(at + 1:at + n_rows) = row(at - n_rows + 1:at)
               at = at + n_rows
               cycle
            end if
            at = at + 1
            row(at) = j
            do p = element_start(j), element_start(j + 1) - 1
               do k = list_start(element(p)), list_start(element(p) + 1) - 1
                  i = list(k)
                  if (i <= j) cycle
                  if (last_seen(i) == j) cycle
                  last_seen(i) = j
                  at = at + 1
                  row(at) = i
               end do
            end do
            associate (rows => row(matrix%column_start(j):at))
               rows = rows(sorting_order(rows))
            end associate
         end do
         matrix%column_start(n + 1) = at + 1
         allocate (matrix%row(at), stat=status)
      end if
      if (status == 0) then
         matrix%row = row(:at)
         deallocate (row)
         allocate (matrix%value(at), stat=status)
      end if
      if (status == 0) then
         matrix%value = 0.0_dp
      else
         ! not raised: no test may use up the machine's memory
         call new_error(error, system_failure, 'memory ran out for a matrix of '//to_text(n)//' unknowns')
      end if
   end subroutine new_sparse_pattern

   !> Adds a small symmetric block. Calls that touch disjoint unknowns may run at the same time.
   pure subroutine sparse_matrix_add_element(self, unknowns, block)
      class(sparse_matrix_t), intent(inout) :: self !! the matrix, its pattern made with this element
      integer, intent(in) :: unknowns(:) !! the element's unknowns, distinct, 0 for a row and column to skip
      real(dp), intent(in) :: block(:, :) !! the block, both triangles (size(unknowns), size(unknowns))
      integer :: sorted(size(unknowns)), i, j
      integer(int64) :: at

      sorted = sorting_order(unknowns)
      do j = 1, size(unknowns)
         if (unknowns(sorted(j)) == 0) cycle
         at = self%column_start(unknowns(sorted(j)))
         do i = j, size(unknowns)
            do while (self%row(at) < unknowns(sorted(i)))
               at = at + 1
            end do
            self%value(at) = self%value(at) + block(sorted(i), sorted(j))
         end do
      end do
   end subroutine sparse_matrix_add_element

   !> The positions of a short list's items in ascending order of the items.
   pure function sorting_order(list) result(order)
      integer, intent(in) :: list(:) !! the list
      integer :: order(size(list))
      integer :: i, k

      do i = 1, size(list)
         do k = i - 1, 1, -1
            if (list(order(k)) <= list(i)) exit
            order(k + 1) = order(k)
         end do
         order(k + 1) = i
      end do
   end function sorting_order

   !> The matrix P K P^T, with its unknowns in another order. Rows within a column are then not in ascending order.
   subroutine sparse_matrix_permute(self, order, permuted, error)
      class(sparse_matrix_t), intent(in) :: self !! the matrix K
      integer, intent(in) :: order(:) !! position k holds unknown order(k) (n)
      type(sparse_matrix_t), intent(out) :: permuted !! the matrix by position, without places
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer, allocatable :: position(:)
      integer(int64) :: at, place
      integer :: i, j, k, status

      permuted%n = self%n
      allocate (permuted%row(size(self%row, kind=int64)), permuted%value(size(self%row, kind=int64)), stat=status)
      if (status /= 0) then
         ! not raised: no test may use up the machine's memory
         call new_error(error, system_failure, 'memory ran out for a matrix of '//to_text(self%n)//' unknowns')
         return
      end if
      allocate (position, source=positions(order))
      allocate (permuted%column_start(self%n + 1), source=0_int64)
      do k = 1, self%n
         do at = self%column_start(k), self%column_start(k + 1) - 1
            j = min(position(self%row(at)), position(k))
            permuted%column_start(j) = permuted%column_start(j) + 1
         end do
      end do
      ! Holds the end of each column first; filling backwards from it leaves the start.
      permuted%column_start(1) = permuted%column_start(1) + 1
      do j = 2, self%n + 1
         permuted%column_start(j) = permuted%column_start(j) + permuted%column_start(j - 1)
      end do
      do k = self%n, 1, -1
         do at = self%column_start(k + 1) - 1, self%column_start(k), -1
            i = max(position(self%row(at)), position(k))
            j = min(position(self%row(at)), position(k))
            place = permuted%column_start(j) - 1
            permuted%row(place) = i
            permuted%value(place) = self%value(at)
            permuted%column_start(j) = place
         end do
      end do
   end subroutine sparse_matrix_permute

   !> The position of every unknown: the inverse of an order.
   pure function positions(order) result(position)
      integer, intent(in) :: order(:) !! position k holds unknown order(k) (n)
      integer, allocatable :: position(:)
      integer :: k

      allocate (position(size(order)))
      position(order) = [(k, k=1, size(order))]
   end function positions

   !> The products K x of two vectors, side by side with one pass over the matrix.
   pure subroutine sparse_matrix_multiply(self, x, y)
      class(sparse_matrix_t), intent(in) :: self !! the matrix K
      real(dp), contiguous, intent(in) :: x(:, :) !! the vectors (2, n)
      real(dp), contiguous, intent(out) :: y(:, :) !! the products (2, n)
      real(dp) :: x_j(2), y_j(2)
      integer(int64) :: at
      integer :: j

      y = 0.0_dp
      do j = 1, self%n
         at = self%column_start(j)
         x_j = x(:2, j)
         y_j = self%value(at)*x_j
         do at = at + 1, self%column_start(j + 1) - 1
            y(:2, self%row(at)) = y(:2, self%row(at)) + self%value(at)*x_j
            y_j = y_j + self%value(at)*x(:2, self%row(at))
         end do
         y(:2, j) = y(:2, j) + y_j
      end do
   end subroutine sparse_matrix_multiply

   !> The diagonal of the matrix.
   pure function sparse_matrix_diagonal(self) result(diagonal)
      class(sparse_matrix_t), intent(in) :: self !! the matrix
      real(dp) :: diagonal(self%n)

      diagonal = self%value(self%column_start(:self%n))
   end function sparse_matrix_diagonal

   !> The 1-norm: the largest sum of magnitudes in a column.
   pure real(dp) function sparse_matrix_norm(self) result(norm)
      class(sparse_matrix_t), intent(in) :: self !! the matrix
      real(dp), allocatable :: total(:)
      integer(int64) :: at
      integer :: j

      total = abs(self%diagonal())
      do j = 1, self%n
         do at = self%column_start(j) + 1, self%column_start(j + 1) - 1
            total(j) = total(j) + abs(self%value(at))
            total(self%row(at)) = total(self%row(at)) + abs(self%value(at))
         end do
      end do
      norm = maxval(total)
   end function sparse_matrix_norm

   !> Adds a number to the diagonal entries of consecutive unknowns.
   pure subroutine sparse_matrix_shift_diagonal(self, first, last, addend)
      class(sparse_matrix_t), intent(inout) :: self !! the matrix
      integer, intent(in) :: first !! first unknown
      integer, intent(in) :: last !! last unknown
      real(dp), intent(in) :: addend !! the addend
      integer :: j

      do j = first, last
         self%value(self%column_start(j)) = self%value(self%column_start(j)) + addend
      end do
   end subroutine sparse_matrix_shift_diagonal

   !> Adds an entry, unless its row or column is 0.
   pure subroutine entries_add(self, row, column, value)
      class(entries_t), intent(inout) :: self !! the entries
      integer, intent(in) :: row !! its row
      integer, intent(in) :: column !! its column
      real(dp), intent(in) :: value !! its value
      integer, parameter :: least_room = 64

      if (min(row, column) == 0) return
      if (.not. allocated(self%value)) allocate (self%row(least_room), self%column(least_room), self%value(least_room))
      if (self%n == size(self%value)) then
         self%row = [self%row, self%row]
         self%column = [self%column, self%column]
         self%value = [self%value, self%value]
      end if
      self%n = self%n + 1
      self%row(self%n) = row
      self%column(self%n) = column
      self%value(self%n) = value
   end subroutine entries_add

   !> The product C x.
   pure function entries_multiply(self, x, n_rows) result(y)
      class(entries_t), intent(in) :: self !! the entries of the matrix C
      real(dp), intent(in) :: x(:) !! the vector
      integer, intent(in) :: n_rows !! number of rows
      real(dp) :: y(n_rows)
      integer :: k

      y = 0.0_dp
      do k = 1, self%n
         y(self%row(k)) = y(self%row(k)) + self%value(k)*x(self%column(k))
      end do
   end function entries_multiply

   !> The product C^T y.
   pure function entries_multiply_transposed(self, y, n_columns) result(x)
      class(entries_t), intent(in) :: self !! the entries of the matrix C
      real(dp), intent(in) :: y(:) !! the vector
      integer, intent(in) :: n_columns !! number of columns
      real(dp) :: x(n_columns)
      integer :: k

      x = 0.0_dp
      do k = 1, self%n
         x(self%column(k)) = x(self%column(k)) + self%value(k)*y(self%row(k))
      end do
   end function entries_multiply_transposed

   !> Makes the graph of a matrix. No supervariable holds both a Schur variable and another unknown.
   pure subroutine new_graph(graph, matrix, n_schur)
      type(graph_t), intent(out) :: graph !! the graph
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_schur !! number of Schur variables, the last unknowns
      integer, allocatable :: member_of(:)
      integer(int64), allocatable :: word(:), signature(:), next(:)
      integer(int64) :: at, state
      integer :: pass, i, j, g, h, last

      ! Gives every column a number that equal full columns share and, all but surely, no others. A wrong merge would
      ! only make an ordering worse: it stays a permutation.
      allocate (word(matrix%n), member_of(matrix%n))
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
      ! Merges consecutive unknowns that couple to the same unknowns.
      do j = 1, matrix%n
         if (j == 1 .or. j == matrix%n - n_schur + 1) then
            graph%n = graph%n + 1
         else if (signature(j) /= signature(j - 1)) then
            graph%n = graph%n + 1
         end if
         member_of(j) = graph%n
      end do
      allocate (graph%first_unknown(graph%n + 1))
      do j = matrix%n, 1, -1
         graph%first_unknown(member_of(j)) = j
      end do
      graph%first_unknown(graph%n + 1) = matrix%n + 1
      if (n_schur > 0) graph%n_schur = graph%n - member_of(matrix%n - n_schur + 1) + 1
      deallocate (word, signature)
      ! The neighbors of every supervariable, read off its first unknown: the first pass counts, the second one writes.
      allocate (next(graph%n + 1), source=0_int64)
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
   end subroutine new_graph

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

   !> Coordinates along a line for supervariables that have no place in the plane, as nested dissection needs them:
   !> neighbors in the graph get neighboring numbers.
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
   !> The level structure starts from the Schur variables, so that they come last in reverse order.
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

   !> Appends all supervariables connected to a given one, starting from one at the far end of the component.
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

   !> Appends the unvisited neighbors of the supervariables in the queue, level by level, until there are none.
   pure subroutine grow(graph, first, lowest, queue, n_levels)
      type(graph_t), intent(in) :: graph !! the graph
      integer, intent(in) :: first !! place in the queue of the first one to grow from
      integer, intent(in) :: lowest !! supervariables below this one do not count
      type(queue_t), intent(inout) :: queue !! the supervariables taken
      integer, intent(out), optional :: n_levels !! number of levels, that grown from included
      integer(int64) :: k
      integer :: at, depth, level_end, old_n, other

      at = first
      depth = 1
      level_end = queue%n
      do while (at <= queue%n)
         if (at > level_end) then
            depth = depth + 1
            level_end = queue%n
         end if
         old_n = queue%n
         do k = graph%start(queue%item(at)), graph%start(queue%item(at) + 1) - 1
            other = int(graph%neighbor(k))
            if (other < lowest) cycle
            if (queue%has(other)) cycle
            queue%has(other) = .true.
            queue%n = queue%n + 1
            queue%item(queue%n) = other
         end do
         ! By their number of neighbors, ascending; ties keep their order.
         associate (list => queue%item(old_n + 1:queue%n))
            if (size(list) > 1) list = list(sorting_order(int(graph%start(list + 1) - graph%start(list))))
         end associate
         at = at + 1
      end do
      if (present(n_levels)) n_levels = depth
   end subroutine grow

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

end module amontons_sparse_matrix
