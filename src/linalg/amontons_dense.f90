!> Dense linear algebra on small full matrices, by LAPACK.
!>
!> Every matrix argument is square; of a symmetric one the lower triangle is read. `info` = 0 means success.
module amontons_dense
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dgemm, dgetrf, dgetrs, dpotrf, dpotri, dpotrs, dsyev, dsymv, dsyrk, dtrsm
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: allocate_matrix, cholesky_factor, cholesky_factor_regularized, cholesky_factor_tiled, cholesky_inverse, &
      cholesky_solve, fill_upper, lu_factor, lu_solve, lu_solve_transposed, moment, small_inverse, squares, &
      symmetric_eigenvectors, symmetric_multiply, transposed_product, triangular_solve, vector_product

   !> Solves L L^T x = b in place, for one right-hand side or for the columns of a matrix.
   interface cholesky_solve
      module procedure :: cholesky_solve_vector, cholesky_solve_matrix
   end interface cholesky_solve

   !> How many columns of a matrix with zeros in its upper rows are treated together.
   integer, parameter :: n_together = 64

contains

   !> The vector product in space.
   pure function vector_product(a, b) result(product)
      real(dp), intent(in) :: a(3) !! the first vector
      real(dp), intent(in) :: b(3) !! the second one
      real(dp) :: product(3)

      product = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function vector_product

   !> The moment of a force about the origin; in the plane, counter-clockwise, the last of its components.
   pure function moment(place, force)
      real(dp), intent(in) :: place(:) !! where the force acts (2 or 3)
      real(dp), intent(in) :: force(:) !! the force along these coordinates first
      real(dp) :: moment(3), arm(3), push(3)

      arm = 0.0_dp
      push = 0.0_dp
      arm(:size(place)) = place
      push(:size(place)) = force(:size(place))
      moment = vector_product(arm, push)
   end function moment

   !> The inverse of a matrix of one or two rows, not singular.
   pure function small_inverse(matrix) result(inverse)
      real(dp), intent(in) :: matrix(:, :) !! the matrix
      real(dp) :: inverse(size(matrix, 1), size(matrix, 1))

      if (size(matrix, 1) == 1) then
         inverse = 1.0_dp/matrix
      else
         inverse = reshape([matrix(2, 2), -matrix(2, 1), -matrix(1, 2), matrix(1, 1)], [2, 2]) &
            /(matrix(1, 1)*matrix(2, 2) - matrix(1, 2)*matrix(2, 1))
      end if
   end function small_inverse

   !> Allocates a large matrix, with undefined entries.
   pure subroutine allocate_matrix(matrix, n_rows, n_columns, owner, error)
      real(dp), allocatable, intent(inout) :: matrix(:, :) !! the matrix (n_rows, n_columns)
      integer, intent(in) :: n_rows !! number of its rows
      integer, intent(in) :: n_columns !! number of its columns
      character(*), intent(in) :: owner !! name of the matrix for the message
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer :: status

      if (allocated(matrix)) deallocate (matrix)
      allocate (matrix(n_rows, n_columns), stat=status)
      if (status == 0) return
      call new_error(error, system_failure, 'not enough memory: a dense matrix of '//owner//', '//to_text(n_rows)// &
         ' by '//to_text(n_columns)//' numbers, needs '//to_text(nint(8.0e-6_dp*n_rows*n_columns, int64))//' MB')
   end subroutine allocate_matrix

   !> Replaces the lower triangle of a symmetric matrix by its Cholesky factor L, A = L L^T.
   pure subroutine cholesky_factor(a, info)
      real(dp), contiguous, intent(inout) :: a(:, :)
         !! the matrix (n, n); on return L in the lower triangle; the strictly upper part is neither read nor changed
      integer, intent(out) :: info !! 0, or the order of the first leading block that is not positive definite

      call dpotrf('L', size(a, 1), a, max(1, size(a, 1)), info)
   end subroutine cholesky_factor

   !> Replaces the lower triangle of a positive semidefinite matrix by the Cholesky factor of A + r D, with the
   !> smallest regularization of 0, 1e-12, 1e-10, ... that makes it positive definite to rounding.
   pure subroutine cholesky_factor_regularized(a, scales, is_regularized)
      real(dp), contiguous, intent(inout) :: a(:, :) !! the matrix, both triangles (n, n); on return L in the lower one
      real(dp), intent(in) :: scales(:) !! the diagonal D, positive (n)
      logical, intent(out) :: is_regularized !! whether r is not 0
      real(dp), parameter :: least = 1.0e-12_dp, growth = 100.0_dp ! first well above the rounding of a pivot
      real(dp) :: diagonal(size(scales)), regularization
      integer :: i, info

      diagonal = [(a(i, i), i=1, size(scales))]
      regularization = 0.0_dp
      do
         call cholesky_factor(a, info)
         is_regularized = regularization > 0.0_dp
         ! Numbers that are not finite stay so with any regularization.
         if (info == 0 .or. regularization > 1.0_dp) return
         regularization = max(least, growth*regularization)
         ! The upper triangle still has the matrix.
         do i = 1, size(scales)
            a(i:, i) = a(i, i:)
            a(i, i) = diagonal(i) + regularization*scales(i)
         end do
      end do
   end subroutine cholesky_factor_regularized

   !> Replaces the lower triangle of a large symmetric matrix by its Cholesky factor on all threads: tile by tile of the
   !> diagonal the tiles below it, then the remaining matrix. The result does not depend on the number of threads.
   subroutine cholesky_factor_tiled(n, a, info)
      integer, intent(in) :: n !! order of the matrix
      real(dp), intent(inout) :: a(n, n)
         !! the matrix; on return L in the lower triangle; the strictly upper part means nothing
      integer, intent(out) :: info !! 0, or the order of the first leading block that is not positive definite
      integer, parameter :: tile = 192
      integer :: lda, i, j, k, width

      lda = max(1, n)
      info = 0
      do k = 1, n, tile
         width = min(tile, n - k + 1)
         call dpotrf('L', width, a(k, k), lda, info)
         if (info /= 0) then
            info = info + k - 1
            return
         end if
         !$omp parallel default(none) if (n - k >= 2*tile) shared(a, n, lda, k, width) private(i, j)
         !$omp do schedule(dynamic)
         do i = k + tile, n, tile
            call dtrsm('R', 'L', 'T', 'N', min(tile, n - i + 1), width, 1.0_dp, a(k, k), lda, a(i, k), lda)
         end do
         !$omp end do
         !$omp do schedule(dynamic)
         do j = k + tile, n, tile
            call dsyrk('L', 'N', min(tile, n - j + 1), width, -1.0_dp, a(j, k), lda, 1.0_dp, a(j, j), lda)
            if (j + tile <= n) call dgemm('N', 'T', n - j - tile + 1, min(tile, n - j + 1), width, -1.0_dp, &
               a(j + tile, k), lda, a(j, k), lda, 1.0_dp, a(j + tile, j), lda)
         end do
         !$omp end do
         !$omp end parallel
      end do
   end subroutine cholesky_factor_tiled

   !> Solves L L^T x = b for one right-hand side.
   pure subroutine cholesky_solve_vector(l, b)
      real(dp), contiguous, intent(in) :: l(:, :) !! L in the lower triangle (n, n), from `cholesky_factor`
      real(dp), contiguous, intent(inout) :: b(:) !! right-hand side (n), the solution on return
      integer :: info

      call dpotrs('L', size(l, 1), 1, l, max(1, size(l, 1)), b, max(1, size(b)), info)
   end subroutine cholesky_solve_vector

   !> Solves L L^T X = B for several right-hand sides.
   pure subroutine cholesky_solve_matrix(l, b)
      real(dp), contiguous, intent(in) :: l(:, :) !! L in the lower triangle (n, n), from `cholesky_factor`
      real(dp), contiguous, intent(inout) :: b(:, :) !! right-hand sides (n, any), the solutions on return
      integer :: info

      call dpotrs('L', size(l, 1), size(b, 2), l, max(1, size(l, 1)), b, max(1, size(b, 1)), info)
   end subroutine cholesky_solve_matrix

   !> Solves L X = B, some columns at a time: above the first row in which one of them is not 0, X is 0.
   pure subroutine triangular_solve(n, m, l, b)
      integer, intent(in) :: n !! order of L
      integer, intent(in) :: m !! number of right-hand sides
      real(dp), intent(in) :: l(n, n) !! L in the lower triangle
      real(dp), intent(inout) :: b(n, m) !! right-hand sides, the solutions on return
      integer :: first, j, width

      do j = 1, m, n_together
         width = min(n_together, m - j + 1)
         first = first_row(b(:, j:j + width - 1))
         if (first > n) cycle
         call dtrsm('L', 'L', 'N', 'N', n - first + 1, width, 1.0_dp, l(first, first), n, b(first, j), n)
      end do
   end subroutine triangular_solve

   !> The first row of a matrix that is not 0, one past the last where all are.
   pure integer function first_row(a) result(row)
      real(dp), intent(in) :: a(:, :) !! the matrix

      do row = 1, size(a, 1)
         if (any(abs(a(row, :)) > 0.0_dp)) exit
      end do
   end function first_row

   !> Replaces the Cholesky factor L by the full symmetric inverse (L L^T)^-1.
   pure subroutine cholesky_inverse(l)
      real(dp), contiguous, intent(inout) :: l(:, :)
         !! L in the lower triangle (n, n), from `cholesky_factor`; both triangles of the inverse on return
      integer :: info

      call dpotri('L', size(l, 1), l, max(1, size(l, 1)), info)
      call fill_upper(l)
   end subroutine cholesky_inverse

   !> Copies the lower triangle of a matrix to its upper one.
   pure subroutine fill_upper(a)
      real(dp), contiguous, intent(inout) :: a(:, :) !! the matrix (n, n)
      integer, parameter :: tile = 64
      integer :: i, j, first_row, first_column, last_row

      ! Tile by tile, so that the transposed side stays in the cache.
      do first_column = 1, size(a, 2), tile
         do first_row = first_column, size(a, 1), tile
            last_row = min(first_row + tile - 1, size(a, 1))
            do j = first_column, min(first_column + tile - 1, size(a, 2))
               do i = max(first_row, j + 1), last_row
                  a(j, i) = a(i, j)
               end do
            end do
         end do
      end do
   end subroutine fill_upper

   !> Solves A x = b for a general matrix by elimination with row exchanges.
   pure subroutine lu_solve(a, b, info)
      real(dp), contiguous, intent(inout) :: a(:, :) !! the matrix (n, n), its triangular factors on return
      real(dp), contiguous, intent(inout) :: b(:) !! right-hand side (n), the solution on return
      integer, intent(out) :: info !! 0, or the number of the first pivot that is exactly zero; b is then untouched
      integer, allocatable :: pivots(:)

      call lu_factor(a, pivots, info)
      if (info == 0) call dgetrs('N', size(b), 1, a, max(1, size(b)), pivots, b, max(1, size(b)), info)
   end subroutine lu_solve

   !> Replaces a general matrix by its triangular factors, by elimination with row exchanges.
   pure subroutine lu_factor(a, pivots, info)
      real(dp), contiguous, intent(inout) :: a(:, :) !! the matrix (n, n), its factors on return
      integer, allocatable, intent(out) :: pivots(:) !! the row exchanges (n)
      integer, intent(out) :: info !! 0, or the number of the first pivot that is exactly zero

      allocate (pivots(size(a, 1)))
      call dgetrf(size(a, 1), size(a, 2), a, max(1, size(a, 1)), pivots, info)
   end subroutine lu_factor

   !> Solves A^T X = B with the factors of A.
   pure subroutine lu_solve_transposed(factor, pivots, b)
      real(dp), contiguous, intent(in) :: factor(:, :) !! the factors (n, n), from `lu_factor`
      integer, intent(in) :: pivots(:) !! the row exchanges (n)
      real(dp), contiguous, intent(inout) :: b(:, :) !! right-hand sides (n, any), the solutions on return
      integer :: info

      call dgetrs('T', size(factor, 1), size(b, 2), factor, max(1, size(factor, 1)), pivots, b, max(1, size(b, 1)), &
         info)
   end subroutine lu_solve_transposed

   !> The product C = A^T B.
   pure subroutine transposed_product(a, b, c)
      real(dp), contiguous, intent(in) :: a(:, :) !! the matrix A (k, m)
      real(dp), contiguous, intent(in) :: b(:, :) !! the matrix B (k, n)
      real(dp), contiguous, intent(out) :: c(:, :) !! the product (m, n)

      c = 0.0_dp
      call dgemm('T', 'N', size(c, 1), size(c, 2), size(a, 1), 1.0_dp, a, max(1, size(a, 1)), b, max(1, size(b, 1)), &
         0.0_dp, c, max(1, size(c, 1)))
   end subroutine transposed_product

   !> The product C = A^T A, in its lower triangle, some rows at a time: A is 0 in these columns above some row.
   pure subroutine squares(k, n, a, c)
      integer, intent(in) :: k !! number of rows of A
      integer, intent(in) :: n !! number of its columns
      real(dp), intent(in) :: a(k, n) !! A
      real(dp), intent(out) :: c(n, n) !! the product, 0 above the diagonal
      integer :: first, i, width

      c = 0.0_dp
      do i = 1, n, n_together
         width = min(n_together, n - i + 1)
         first = first_row(a(:, i:i + width - 1))
         if (first > k) cycle
         call dgemm('T', 'N', width, i - 1, k - first + 1, 1.0_dp, a(first, i), k, a(first, 1), k, 0.0_dp, c(i, 1), n)
         call dsyrk('L', 'T', width, k - first + 1, 1.0_dp, a(first, i), k, 0.0_dp, c(i, i), n)
      end do
   end subroutine squares

   !> The product y = A x of a symmetric matrix, reading half of it.
   pure subroutine symmetric_multiply(a, x, y)
      real(dp), contiguous, intent(in) :: a(:, :) !! the matrix (n, n); only the lower triangle is read
      real(dp), contiguous, intent(in) :: x(:) !! the vector (n)
      real(dp), contiguous, intent(out) :: y(:) !! the product (n)

      y = 0.0_dp
      call dsymv('L', size(x), 1.0_dp, a, max(1, size(x)), x, 1, 0.0_dp, y, 1)
   end subroutine symmetric_multiply

   !> Computes all eigenvalues of a symmetric matrix, in ascending order, and orthonormal eigenvectors.
   subroutine symmetric_eigenvectors(a, w, info)
      real(dp), contiguous, intent(inout) :: a(:, :)
         !! the matrix (n, n), lower triangle read; on return column k is the eigenvector of value k
      real(dp), contiguous, intent(out) :: w(:) !! the eigenvalues (n)
      integer, intent(out) :: info !! 0, or how many values did not converge
      ! LAPACK asks for (block size + 2) n; its blocks have 32 columns.
      integer, parameter :: work_per_row = 34
      real(dp), allocatable :: work(:)

      allocate (work(max(1, work_per_row*size(a, 1))))
      call dsyev('V', 'L', size(a, 1), a, max(1, size(a, 1)), w, work, size(work), info)
   end subroutine symmetric_eigenvectors

end module amontons_dense
