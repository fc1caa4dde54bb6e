!> Dense linear algebra on small full matrices, by LAPACK, and least squares with bounds on the factors.
!>
!> Every matrix argument is square; of a symmetric one the lower triangle is read. `info` = 0 means success.
module amontons_dense
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dgemm, dgemv, dgetrf, dgetrs, dpotrf, dpotri, dpotrs, dsyev, dsymv, dsyrk, dtrsm
   use amontons_rounding, only: sum_rounding
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: add_product, allocate_matrix, bounded_remainder, cholesky_factor, cholesky_factor_regularized, &
      cholesky_factor_tiled, cholesky_inverse, cholesky_solve, fill_upper, lu_factor, lu_solve, lu_solve_transposed, &
      squares, symmetric_eigenvectors, symmetric_multiply, transposed_product, triangular_solve

   !> Solves L L^T x = b in place, for one right-hand side or for the columns of a matrix.
   interface cholesky_solve
      module procedure :: cholesky_solve_vector, cholesky_solve_matrix
   end interface cholesky_solve

contains

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

   !> Solves L X = B.
   pure subroutine triangular_solve(l, b)
      real(dp), contiguous, intent(in) :: l(:, :) !! L in the lower triangle (n, n)
      real(dp), contiguous, intent(inout) :: b(:, :) !! right-hand sides (n, any), the solutions on return

      call dtrsm('L', 'L', 'N', 'N', size(b, 1), size(b, 2), 1.0_dp, l, max(1, size(l, 1)), b, max(1, size(b, 1)))
   end subroutine triangular_solve

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

   !> Adds a product: y := y + A x.
   pure subroutine add_product(a, x, y)
      real(dp), contiguous, intent(in) :: a(:, :) !! the matrix (m, n)
      real(dp), contiguous, intent(in) :: x(:) !! the vector (n)
      real(dp), contiguous, intent(inout) :: y(:) !! the sum (m)

      call dgemv('N', size(a, 1), size(a, 2), 1.0_dp, a, max(1, size(a, 1)), x, 1, 1.0_dp, y, 1)
   end subroutine add_product

   !> The product C = A^T B.
   pure subroutine transposed_product(a, b, c)
      real(dp), contiguous, intent(in) :: a(:, :) !! the matrix A (k, m)
      real(dp), contiguous, intent(in) :: b(:, :) !! the matrix B (k, n)
      real(dp), contiguous, intent(out) :: c(:, :) !! the product (m, n)

      c = 0.0_dp
      call dgemm('T', 'N', size(c, 1), size(c, 2), size(a, 1), 1.0_dp, a, max(1, size(a, 1)), b, max(1, size(b, 1)), &
         0.0_dp, c, max(1, size(c, 1)))
   end subroutine transposed_product

   !> The product C = A^T A, in its lower triangle.
   pure subroutine squares(a, c)
      real(dp), contiguous, intent(in) :: a(:, :) !! the matrix A (k, n)
      real(dp), contiguous, intent(inout) :: c(:, :) !! the product (n, n); the strictly upper part is not changed

      call dsyrk('L', 'T', size(c, 1), size(a, 1), 1.0_dp, a, max(1, size(a, 1)), 0.0_dp, c, max(1, size(c, 1)))
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

   !> The remainder of a vector after its best approximation by columns with factors from 0 to an upper bound each:
   !> Lawson and Hanson's algorithm (Solving Least Squares Problems, 1974, chapter 23) with upper bounds (P. B. Stark,
   !> R. L. Parker: Bounded-variable least squares, Computational Statistics 10 (1995)).
   pure function bounded_remainder(columns, most, vector) result(remainder)
      real(dp), intent(in) :: columns(:, :) !! the columns (k, n)
      real(dp), intent(in) :: most(:) !! upper bounds of the factors, at least 0; huge if there is none (n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      real(dp) :: remainder(size(vector))
      real(dp) :: unit(size(columns, 1), size(columns, 2)), share, bound
      real(dp), dimension(size(columns, 2)) :: longest, gain, factor, trial, full
      logical, dimension(size(columns, 2)) :: is_used, is_full, is_leaving
      integer :: i, step

      do i = 1, size(columns, 2)
         unit(:, i) = columns(:, i)/max(norm2(columns(:, i)), tiny(1.0_dp))
         longest(i) = most(i)
         if (most(i) < huge(most)) longest(i) = most(i)*norm2(columns(:, i))
      end do
      ! The factors of the columns; which are in use, with a factor between 0 and the most; and which have the most.
      factor = 0.0_dp*longest
      is_used = .false.
      is_full = .false.
      remainder = vector
      do step = 1, 3*size(columns, 2)
         if (norm2(remainder) <= sum_rounding*norm2(vector)) exit
         gain = matmul(remainder, unit)
         where (is_full) gain = -gain
         i = maxloc(gain, dim=1, mask=.not. is_used .and. most > 0.0_dp)
         if (i == 0) exit
         if (gain(i) <= sum_rounding*norm2(remainder)) exit
         is_used(i) = .true.
         factor(i) = merge(longest(i), 0.0_dp, is_full(i))
         is_full(i) = .false.
         ! Moves the factors to the best approximation by the columns in use; where a factor reaches a bound
         ! first, its column is no longer used, and the move starts again from there.
         do
            full = merge(longest, 0.0_dp, is_full)
            call approximate(unit, vector - matmul(unit, full), is_used, trial, remainder)
            is_leaving = is_used .and. .not. (trial > 0.0_dp .and. trial < longest)
            if (.not. any(is_leaving)) exit
            ! The share of the way to the trial on which all factors in use stay in their bounds.
            share = 1.0_dp
            do i = 1, size(factor)
               if (.not. is_leaving(i)) cycle
               bound = merge(longest(i), 0.0_dp, trial(i) > 0.0_dp)
               share = min(share, abs(bound - factor(i))/max(abs(trial(i) - factor(i)), tiny(share)))
            end do
            factor = factor + share*(trial - factor)
            is_full = is_full .or. (is_used .and. factor >= (1.0_dp - sum_rounding)*longest)
            is_used = is_used .and. .not. is_full .and. factor > sum_rounding*maxval(factor)
            factor = merge(factor, 0.0_dp, is_used)
         end do
         factor = trial
      end do
   end function bounded_remainder

   !> Finds the best approximation of a vector by the columns in use, which are orthogonalized one by one (Gram and
   !> Schmidt): no digits are lost for nearly parallel columns, such as those of a flat contact line far from the middle
   !> of the body.
   pure subroutine approximate(columns, vector, is_used, factor, remainder)
      real(dp), intent(in) :: columns(:, :) !! the columns, of length 1 (k, n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      logical, intent(in) :: is_used(:) !! which columns are in use, k at the most (n)
      real(dp), intent(out) :: factor(:) !! their factors; 0 for the others (n)
      real(dp), intent(out) :: remainder(:) !! remainder of the vector (k)
      real(dp) :: axes(size(vector), count(is_used)), share(count(is_used), count(is_used) + 1), length
      integer, allocatable :: column(:)
      integer :: i, n

      column = pack([(i, i=1, size(is_used))], is_used)
      n = size(column)
      do i = 1, n
         axes(:, i) = columns(:, column(i))
         call orthogonalize(axes(:, :i - 1), axes(:, i), share(:i - 1, i))
         length = max(norm2(axes(:, i)), tiny(1.0_dp))
         axes(:, i) = axes(:, i)/length
         share(i, i) = length
      end do
      remainder = vector
      call orthogonalize(axes, remainder, share(:, n + 1))
      factor = 0.0_dp
      do i = n, 1, -1
         factor(column(i)) = (share(i, n + 1) - dot_product(share(i, i + 1:n), factor(column(i + 1:n))))/share(i, i)
      end do
   end subroutine approximate

   !> Subtracts from a vector its components along orthogonal axes, twice, since the first time leaves rounding errors
   !> of them.
   pure subroutine orthogonalize(axes, vector, share)
      real(dp), intent(in) :: axes(:, :) !! the axes, of length 1 (k, n)
      real(dp), intent(inout) :: vector(:) !! the vector (k)
      real(dp), intent(out) :: share(:) !! its components (n)
      real(dp) :: along
      integer :: i, turn

      share = 0.0_dp
      do turn = 1, 2
         do i = 1, size(axes, 2)
            along = dot_product(axes(:, i), vector)
            vector = vector - along*axes(:, i)
            share(i) = share(i) + along
         end do
      end do
   end subroutine orthogonalize

end module amontons_dense
