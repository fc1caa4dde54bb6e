!> A sparse symmetric matrix and its assembly from small dense blocks.
module amontons_sparse_matrix
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: new_sparse_pattern, positions, sorting_order, sparse_matrix_t

   !> A symmetric matrix, its lower triangle stored by columns: every column starts with its diagonal entry.
   type :: sparse_matrix_t
      integer :: n = 0 !! Order of the matrix.
      integer(int64), allocatable :: column_start(:) !! Where column j starts in `row` and `value` (n + 1).
      integer, allocatable :: row(:) !! Row of each stored entry, ascending within a column.
      real(dp), allocatable :: value(:) !! Value of each stored entry.
      real(dp), allocatable :: place(:, :) !! Where each unknown sits; not allocated where nobody knows (2, n) [L].
   contains
      procedure :: add_element => sparse_matrix_add_element
      procedure :: diagonal => sparse_matrix_diagonal
      procedure :: multiply => sparse_matrix_multiply
      procedure :: norm => sparse_matrix_norm
      procedure :: permute => sparse_matrix_permute
      procedure :: shift_diagonal => sparse_matrix_shift_diagonal
   end type sparse_matrix_t

contains

   !> Makes a zero matrix with room for everything the elements couple, and for the diagonal.
   subroutine new_sparse_pattern(matrix, n, list_start, list, error)
      type(sparse_matrix_t), intent(out) :: matrix !! the matrix, all values zero
      integer, intent(in) :: n !! its order
      integer, contiguous, intent(in) :: list_start(:) !! where each element starts in `list` (n_elements + 1)
      integer, contiguous, intent(in) :: list(:) !! the unknowns of each element, 1 to n; 0 stands for none
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer, allocatable :: element_start(:), element(:)
      integer :: status

      matrix%n = n
      call transpose_lists(n, list_start, list, element_start, element)
      call list_rows(matrix, list_start, list, element_start, element, status)
      if (status == 0) allocate (matrix%value(size(matrix%row, kind=int64)), stat=status)
      if (status == 0) then
         matrix%value = 0.0_dp
      else
         ! not raised: no test may use up the machine's memory
         call new_error(error, system_failure, 'memory ran out for a matrix of '//to_text(n)//' unknowns')
      end if
   end subroutine new_sparse_pattern

   !> Turns the unknowns of each element into the elements of each unknown.
   pure subroutine transpose_lists(n, list_start, list, element_start, element)
      integer, intent(in) :: n !! number of unknowns
      integer, intent(in) :: list_start(:) !! where each element starts in `list` (n_elements + 1)
      integer, intent(in) :: list(:) !! the unknowns of each element; 0 stands for none
      integer, allocatable, intent(out) :: element_start(:) !! where each unknown starts in `element` (n + 1)
      integer, allocatable, intent(out) :: element(:) !! the elements of each unknown
      integer :: e, k, j

      allocate (element_start(n + 1))
      element_start = 0
      do k = 1, size(list)
         if (list(k) > 0) element_start(list(k)) = element_start(list(k)) + 1
      end do
      ! Holds the end of each list first; filling backwards from it leaves the start.
      k = 1
      do j = 1, n
         k = k + element_start(j)
         element_start(j) = k
      end do
      element_start(n + 1) = k
      allocate (element(k - 1))
      do e = size(list_start) - 1, 1, -1
         do k = list_start(e), list_start(e + 1) - 1
            j = list(k)
            if (j == 0) cycle
            element_start(j) = element_start(j) - 1
            element(element_start(j)) = e
         end do
      end do
   end subroutine transpose_lists

   !> Lists the rows of each column: the distinct unknowns that share an element with it and are not below it.
   pure subroutine list_rows(matrix, list_start, list, element_start, element, status)
      type(sparse_matrix_t), intent(inout) :: matrix !! the matrix, its columns made
      integer, intent(in) :: list_start(:) !! where each element starts in `list` (n_elements + 1)
      integer, intent(in) :: list(:) !! the unknowns of each element; 0 stands for none
      integer, intent(in) :: element_start(:) !! where each unknown starts in `element` (n + 1)
      integer, intent(in) :: element(:) !! the elements of each unknown
      integer, intent(out) :: status !! 0, or memory ran out
      integer, allocatable :: last_seen(:), row(:)
      integer(int64) :: at, most_entries, n_rows
      integer :: i, j, k, p

      ! Most entries of a lower triangle: the diagonal, and every pair of unknowns of an element.
      most_entries = matrix%n
      do k = 1, size(list_start) - 1
         n_rows = list_start(k + 1) - list_start(k)
         most_entries = most_entries + n_rows*(n_rows - 1)/2
      end do
      allocate (last_seen(matrix%n), matrix%column_start(matrix%n + 1), row(most_entries), stat=status)
      if (status /= 0) return
      last_seen = 0
      at = 0
      do j = 1, matrix%n
         matrix%column_start(j) = at + 1
         if (is_like_last(j, element_start, element)) then
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
      matrix%column_start(matrix%n + 1) = at + 1
      allocate (matrix%row(at), stat=status)
      if (status == 0) matrix%row = row(:at)
   end subroutine list_rows

   !> Whether an unknown belongs to the same elements as the one before it.
   pure logical function is_like_last(unknown, element_start, element)
      integer, intent(in) :: unknown !! the unknown
      integer, intent(in) :: element_start(:) !! where each unknown starts in `element` (n + 1)
      integer, intent(in) :: element(:) !! the elements of each unknown
      integer :: first, last, n

      is_like_last = .false.
      if (unknown == 1) return
      first = element_start(unknown - 1)
      last = element_start(unknown)
      n = element_start(unknown + 1) - last
      if (n == 0 .or. last - first /= n) return
      is_like_last = all(element(first:first + n - 1) == element(last:last + n - 1))
   end function is_like_last

   !> Adds a small symmetric block. Calls that touch disjoint unknowns may run at the same time.
   pure subroutine sparse_matrix_add_element(self, unknowns, block)
      class(sparse_matrix_t), intent(inout) :: self !! the matrix, its pattern made with this element
      integer, intent(in) :: unknowns(:) !! the element's unknowns, distinct, 0 for a row and column to skip
      real(dp), intent(in) :: block(:, :) !! the block, both triangles (size(unknowns), size(unknowns))
      integer :: sorted(size(unknowns))
      integer(int64) :: at
      integer :: i, j

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

   !> The matrix P K P^T with its unknowns in another order. Rows ascend no more within a column.
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
      do k = 1, size(order)
         position(order(k)) = k
      end do
   end function positions

   !> The product y = K x.
   pure subroutine sparse_matrix_multiply(self, x, y)
      class(sparse_matrix_t), intent(in) :: self !! the matrix K
      real(dp), intent(in) :: x(:) !! the vector (n)
      real(dp), intent(out) :: y(:) !! the product (n)
      real(dp) :: x_j, y_j
      integer(int64) :: at
      integer :: j

      y = 0.0_dp
      do j = 1, self%n
         at = self%column_start(j)
         x_j = x(j)
         y_j = self%value(at)*x_j
         do at = at + 1, self%column_start(j + 1) - 1
            y(self%row(at)) = y(self%row(at)) + self%value(at)*x_j
            y_j = y_j + self%value(at)*x(self%row(at))
         end do
         y(j) = y(j) + y_j
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

   !> Adds addend to the diagonal entries of some consecutive unknowns.
   pure subroutine sparse_matrix_shift_diagonal(self, first, last, addend)
      class(sparse_matrix_t), intent(inout) :: self !! the matrix
      integer, intent(in) :: first !! first unknown
      integer, intent(in) :: last !! last unknown
      real(dp), intent(in) :: addend !! what is added
      integer :: j

      do j = first, last
         self%value(self%column_start(j)) = self%value(self%column_start(j)) + addend
      end do
   end subroutine sparse_matrix_shift_diagonal

end module amontons_sparse_matrix
