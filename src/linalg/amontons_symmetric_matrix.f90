!> A symmetric matrix for products: dense, or sparse with both triangles stored.
!>
!> Its last rows may form pairs, the two tangents of a point in space, whose directions are arbitrary.
module amontons_symmetric_matrix
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp
   use amontons_lapack, only: dgemv, dsymv
   implicit none (type, external)
   private

   public :: new_dense_matrix, new_sparse_matrix, symmetric_matrix_t, turned_pairs

   !> A symmetric matrix. Either `values` is allocated (dense), or the three arrays of the sparse form are.
   type :: symmetric_matrix_t
      integer :: n = 0 !! number of rows
      integer :: n_pairs = 0 !! number of pairs k: the rows n - 2 n_pairs + k and n - n_pairs + k
      real(dp), allocatable :: values(:, :) !! dense: both triangles (n, n)
      integer, allocatable :: first(:) !! sparse: where each column begins in `row` and `entry`, and the end (n + 1)
      integer, allocatable :: row(:) !! sparse: rows of the entries, ascending within a column
      real(dp), allocatable :: entry(:) !! sparse: the entries
   contains
      procedure :: add_column => symmetric_matrix_add_column
      procedure :: block => symmetric_matrix_block
      procedure :: diagonal => symmetric_matrix_diagonal
      procedure :: element => symmetric_matrix_element
      procedure :: fill_block => symmetric_matrix_fill_block
      procedure :: is_sparse => symmetric_matrix_is_sparse
      procedure :: multiply => symmetric_matrix_multiply
      procedure :: part_multiply => symmetric_matrix_part_multiply
      procedure :: reciprocal_diagonal => symmetric_matrix_reciprocal_diagonal
      procedure :: turn => symmetric_matrix_turn
   end type symmetric_matrix_t

contains

   !> Makes a dense matrix from a full array, which it takes over.
   pure subroutine new_dense_matrix(matrix, values, n_pairs)
      type(symmetric_matrix_t), intent(out) :: matrix !! the matrix
      real(dp), allocatable, intent(inout) :: values(:, :) !! both triangles (n, n); not allocated on return
      integer, intent(in), optional :: n_pairs !! number of its pairs; 0 if it is not given

      if (present(n_pairs)) matrix%n_pairs = n_pairs
      matrix%n = size(values, 1)
      call move_alloc(values, matrix%values)
   end subroutine new_dense_matrix

   !> Makes a sparse matrix from the entries of both triangles, in any order; entries at the same position are summed.
   pure subroutine new_sparse_matrix(matrix, n, row, column, entry)
      type(symmetric_matrix_t), intent(out) :: matrix !! the matrix
      integer, intent(in) :: n !! number of rows
      integer, intent(in) :: row(:) !! rows of the entries, 1 to n
      integer, intent(in) :: column(:) !! their columns, 1 to n
      real(dp), intent(in) :: entry(:) !! their values
      integer, allocatable :: by_row(:), by_column(:), start(:)
      integer :: i, j, last, previous

      ! Sorted by row and then, stably, by column: the entries of a column stand in the order of their rows.
      call fill_bins(start, by_row, row, n)
      call fill_bins(start, by_column, column(by_row), n)
      matrix%n = n
      allocate (matrix%first(n + 1), matrix%row(size(row)), matrix%entry(size(row)))
      last = 0
      do j = 1, n
         matrix%first(j) = last + 1
         previous = 0
         do i = start(j), start(j + 1) - 1
            associate (k => by_row(by_column(i)))
               if (row(k) == previous) then
                  matrix%entry(last) = matrix%entry(last) + entry(k)
               else
                  last = last + 1
                  matrix%row(last) = row(k)
                  matrix%entry(last) = entry(k)
                  previous = row(k)
               end if
            end associate
         end do
      end do
      matrix%first(n + 1) = last + 1
      matrix%row = matrix%row(:last)
      matrix%entry = matrix%entry(:last)
   end subroutine new_sparse_matrix

   !> Whether the matrix is stored as sparse.
   pure logical function symmetric_matrix_is_sparse(self)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix

      symmetric_matrix_is_sparse = .not. allocated(self%values)
   end function symmetric_matrix_is_sparse

   !> The product y = A x.
   pure subroutine symmetric_matrix_multiply(self, x, y)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix A
      real(dp), contiguous, intent(in) :: x(:) !! the vector (n)
      real(dp), contiguous, intent(out) :: y(:) !! the product (n)

      call self%part_multiply([1, self%n], [1, self%n], x, y)
   end subroutine symmetric_matrix_multiply

   !> The product y = A(rows, columns) x of a block of consecutive rows and columns.
   pure subroutine symmetric_matrix_part_multiply(self, rows, columns, x, y)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix A
      integer, intent(in) :: rows(2) !! first and last row of the part
      integer, intent(in) :: columns(2) !! its first and last column
      real(dp), contiguous, intent(in) :: x(:) !! the vector, one number for each column of the part
      real(dp), contiguous, intent(out) :: y(:) !! the product, one number for each row of the part
      integer :: i, k

      y = 0.0_dp
      if (allocated(self%values)) then
         if (size(x) == 0 .or. size(y) == 0) return
         if (all(rows == columns)) then
            call dsymv('L', size(x), 1.0_dp, self%values(rows(1), rows(1)), self%n, x, 1, 0.0_dp, y, 1)
         else
            call dgemv('N', size(y), size(x), 1.0_dp, self%values(rows(1), columns(1)), self%n, x, 1, 0.0_dp, y, 1)
         end if
         return
      end if
      ! A row is read as the column of its number.
      do i = rows(1), rows(2)
         do k = self%first(i), self%first(i + 1) - 1
            if (self%row(k) < columns(1)) cycle
            if (self%row(k) > columns(2)) exit
            y(i - rows(1) + 1) = y(i - rows(1) + 1) + self%entry(k)*x(self%row(k) - columns(1) + 1)
         end do
      end do
   end subroutine symmetric_matrix_part_multiply

   !> Adds a multiple of one column to a vector: the change of A x with one component of x.
   pure subroutine symmetric_matrix_add_column(self, column, factor, y)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix A
      integer, intent(in) :: column !! number of the column
      real(dp), intent(in) :: factor !! factor of the column
      real(dp), contiguous, intent(inout) :: y(:) !! the vector (n)
      integer :: k

      if (allocated(self%values)) then
         y = y + factor*self%values(:, column)
      else
         do k = self%first(column), self%first(column + 1) - 1
            y(self%row(k)) = y(self%row(k)) + factor*self%entry(k)
         end do
      end if
   end subroutine symmetric_matrix_add_column

   !> An entry of the matrix, from either triangle.
   pure real(dp) function symmetric_matrix_element(self, row, column) result(element)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix
      integer, intent(in) :: row !! its row
      integer, intent(in) :: column !! its column
      integer :: k

      if (allocated(self%values)) then
         element = self%values(row, column)
         return
      end if
      element = 0.0_dp
      do k = self%first(column), self%first(column + 1) - 1
         if (self%row(k) == row) element = self%entry(k)
      end do
   end function symmetric_matrix_element

   !> The diagonal; for a pair the largest eigenvalue of its block, which is independent of the axes (n).
   pure function symmetric_matrix_diagonal(self) result(diagonal)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix
      real(dp) :: diagonal(self%n)
      integer :: i, j

      diagonal = [(self%element(j, j), j=1, self%n)]
      do j = self%n - self%n_pairs + 1, self%n
         i = j - self%n_pairs
         diagonal(j) = 0.5_dp*(diagonal(i) + diagonal(j)) &
            + hypot(0.5_dp*(diagonal(i) - diagonal(j)), self%element(i, j))
         diagonal(i) = diagonal(j)
      end do
   end function symmetric_matrix_diagonal

   !> The reciprocals of the diagonal, as a stiffness of each row; where the diagonal is not positive, the smallest of
   !> the others, or 1 if there is none (n).
   pure function symmetric_matrix_reciprocal_diagonal(self) result(reciprocal)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix
      real(dp) :: reciprocal(self%n)

      reciprocal = self%diagonal()
      if (.not. any(reciprocal > 0.0_dp)) reciprocal = 1.0_dp
      reciprocal = 1.0_dp/merge(reciprocal, maxval(reciprocal), reciprocal > 0.0_dp)
   end function symmetric_matrix_reciprocal_diagonal

   !> A vector with its last pairs transformed to other axes, or back (n).
   pure function turned_pairs(vector, axes, sense) result(turned)
      real(dp), intent(in) :: vector(:) !! the vector (n)
      real(dp), intent(in) :: axes(:, :) !! first axis of each pair; the second is a quarter turn ahead (2, n_pairs) [-]
      integer, intent(in) :: sense !! 1 to the axes, -1 back
      real(dp) :: turned(size(vector))

      associate (second => size(vector) - size(axes, 2), first => size(vector) - 2*size(axes, 2))
         turned(:first) = vector(:first)
         turned(first + 1:second) = axes(1, :)*vector(first + 1:second) + sense*axes(2, :)*vector(second + 1:)
         turned(second + 1:) = axes(1, :)*vector(second + 1:) - sense*axes(2, :)*vector(first + 1:second)
      end associate
   end function turned_pairs

   !> The matrix with its pairs transformed to other axes.
   pure subroutine symmetric_matrix_turn(self, axes, turned)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix
      real(dp), intent(in) :: axes(:, :) !! first axis of each pair; the second is a quarter turn ahead (2, n_pairs) [-]
      type(symmetric_matrix_t), intent(out) :: turned !! the matrix in these axes, dense or sparse as it is
      real(dp) :: weight(2, self%n), before(self%n)
      integer :: at(2, self%n), i, j, k, l, n
      integer, allocatable :: row(:), column(:)
      real(dp), allocatable :: entry(:)

      associate (m => self%n_pairs, plain => self%n - 2*self%n_pairs)
         if (allocated(self%values)) then
            turned%n = self%n
            allocate (turned%values, mold=self%values)
            do j = 1, self%n
               turned%values(:, j) = turned_pairs(self%values(:, j), axes, 1)
            end do
            do k = 1, m
               associate (first => turned%values(:, plain + k), second => turned%values(:, plain + m + k))
                  before = first
                  first = axes(1, k)*before + axes(2, k)*second
                  second = axes(1, k)*second - axes(2, k)*before
               end associate
            end do
         else
            ! Each row is a sum of at most two of the turned matrix.
            at(1, :) = [(i, i=1, self%n)]
            weight(1, :) = 1.0_dp
            weight(2, :) = 0.0_dp
            do k = 1, m
               at(:, plain + k) = [plain + k, plain + m + k]
               at(:, plain + m + k) = [plain + m + k, plain + k]
               weight(:, plain + k) = [axes(1, k), -axes(2, k)]
               weight(:, plain + m + k) = axes(:, k)
            end do
            n = 4*size(self%row)
            allocate (row(n), column(n), entry(n))
            n = 0
            do j = 1, self%n
               do k = self%first(j), self%first(j + 1) - 1
                  do i = 1, 4
                     l = (i + 1)/2
                     associate (share => weight(l, j)*weight(i + 2 - 2*l, self%row(k)))
                        if (.not. abs(share) > 0.0_dp) cycle
                        n = n + 1
                        row(n) = at(i + 2 - 2*l, self%row(k))
                        column(n) = at(l, j)
                        entry(n) = share*self%entry(k)
                     end associate
                  end do
               end do
            end do
            call new_sparse_matrix(turned, self%n, row(:n), column(:n), entry(:n))
         end if
         turned%n_pairs = m
      end associate
   end subroutine symmetric_matrix_turn

   !> The dense block of given rows and columns.
   pure function symmetric_matrix_block(self, rows, columns) result(block)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix
      integer, intent(in) :: rows(:) !! numbers of the rows, each at most once
      integer, intent(in) :: columns(:) !! numbers of the columns
      real(dp), allocatable :: block(:, :)

      allocate (block(size(rows), size(columns)))
      call self%fill_block(rows, columns, block)
   end function symmetric_matrix_block

   !> Fills an array with the block of given rows and columns.
   pure subroutine symmetric_matrix_fill_block(self, rows, columns, block)
      class(symmetric_matrix_t), intent(in) :: self !! the matrix
      integer, intent(in) :: rows(:) !! numbers of the rows, each at most once
      integer, intent(in) :: columns(:) !! numbers of the columns
      real(dp), intent(out) :: block(:, :) !! the block (rows, columns)
      integer :: place(self%n), i, j, k

      if (allocated(self%values)) then
         block = self%values(rows, columns)
         return
      end if
      place = 0
      place(rows) = [(i, i=1, size(rows))]
      block = 0.0_dp
      do j = 1, size(columns)
         do k = self%first(columns(j)), self%first(columns(j) + 1) - 1
            i = place(self%row(k))
            if (i > 0) block(i, j) = self%entry(k)
         end do
      end do
   end subroutine symmetric_matrix_fill_block

end module amontons_symmetric_matrix
