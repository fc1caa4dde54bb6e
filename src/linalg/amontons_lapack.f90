!> The BLAS and LAPACK routines in use, with their interfaces. What each one computes is in the LAPACK manual.
module amontons_lapack
   implicit none (type, external)
   private

   public :: dgbtrf, dgbtrs, dgemm, dgemv, dgetrf, dgetrs, dlacn2, dlauum, dpbtrf, dpotrf, dpotri, &
      dpotrs, dsbmv, dsyev, dsymv, dsyrk, dtbsv, dtrsm, dtrsv

   ! allow(assumed-size): these routines take the shape apart from the address
   abstract interface
      !> Changes a symmetric matrix, or its factor, given by one triangle.
      pure subroutine change_triangle(uplo, n, a, lda, info)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo !! which triangle: 'U' or 'L'
         integer, intent(in) :: n !! order of the matrix
         integer, intent(in) :: lda !! first extent of a
         real(dp), intent(inout) :: a(lda, *) !! the triangle
         integer, intent(out) :: info !! 0, or nonzero where the result does not exist
      end subroutine change_triangle
   end interface

   !> Product U U^T or L^T L of a factor, Cholesky factor of a matrix, and inverse of a matrix from its factor.
   procedure(change_triangle) :: dlauum, dpotrf, dpotri

   ! allow(assumed-size): see above
   interface
      pure subroutine dgbtrf(m, n, kl, ku, ab, ldab, ipiv, info)
         use amontons_kinds, only: dp
         implicit none (type, external)
         integer, intent(in) :: m, n, kl, ku, ldab
         real(dp), intent(inout) :: ab(ldab, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgbtrf

      pure subroutine dgbtrs(trans, n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: trans
         integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb
         real(dp), intent(in) :: ab(ldab, *)
         integer, intent(in) :: ipiv(*)
         real(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgbtrs

      pure subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: transa, transb
         integer, intent(in) :: m, n, k, lda, ldb, ldc
         real(dp), intent(in) :: alpha, beta, a(lda, *), b(ldb, *)
         real(dp), intent(inout) :: c(ldc, *)
      end subroutine dgemm

      pure subroutine dgemv(trans, m, n, alpha, a, lda, x, incx, beta, y, incy)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: trans
         integer, intent(in) :: m, n, lda, incx, incy
         real(dp), intent(in) :: alpha, beta, a(lda, *), x(*)
         real(dp), intent(inout) :: y(*)
      end subroutine dgemv

      pure subroutine dgetrf(m, n, a, lda, ipiv, info)
         use amontons_kinds, only: dp
         implicit none (type, external)
         integer, intent(in) :: m, n, lda
         real(dp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgetrf

      pure subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(in) :: a(lda, *)
         integer, intent(in) :: ipiv(*)
         real(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgetrs

      pure subroutine dlacn2(n, v, x, isgn, est, kase, isave)
         use amontons_kinds, only: dp
         implicit none (type, external)
         integer, intent(in) :: n
         real(dp), intent(inout) :: v(*), x(*), est
         integer, intent(inout) :: isgn(*), kase, isave(3)
      end subroutine dlacn2

      pure subroutine dpbtrf(uplo, n, kd, ab, ldab, info)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo
         integer, intent(in) :: n, kd, ldab
         real(dp), intent(inout) :: ab(ldab, *)
         integer, intent(out) :: info
      end subroutine dpbtrf

      pure subroutine dpotrs(uplo, n, nrhs, a, lda, b, ldb, info)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dpotrs

      pure subroutine dsbmv(uplo, n, k, alpha, a, lda, x, incx, beta, y, incy)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo
         integer, intent(in) :: n, k, lda, incx, incy
         real(dp), intent(in) :: alpha, beta, a(lda, *), x(*)
         real(dp), intent(inout) :: y(*)
      end subroutine dsbmv

      pure subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: jobz, uplo
         integer, intent(in) :: n, lda, lwork
         real(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: w(*), work(*)
         integer, intent(out) :: info
      end subroutine dsyev

      pure subroutine dsymv(uplo, n, alpha, a, lda, x, incx, beta, y, incy)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo
         integer, intent(in) :: n, lda, incx, incy
         real(dp), intent(in) :: alpha, beta, a(lda, *), x(*)
         real(dp), intent(inout) :: y(*)
      end subroutine dsymv

      pure subroutine dsyrk(uplo, trans, n, k, alpha, a, lda, beta, c, ldc)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo, trans
         integer, intent(in) :: n, k, lda, ldc
         real(dp), intent(in) :: alpha, beta, a(lda, *)
         real(dp), intent(inout) :: c(ldc, *)
      end subroutine dsyrk

      pure subroutine dtbsv(uplo, trans, diag, n, k, a, lda, x, incx)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo, trans, diag
         integer, intent(in) :: n, k, lda, incx
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(inout) :: x(*)
      end subroutine dtbsv

      pure subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: side, uplo, transa, diag
         integer, intent(in) :: m, n, lda, ldb
         real(dp), intent(in) :: alpha, a(lda, *)
         real(dp), intent(inout) :: b(ldb, *)
      end subroutine dtrsm

      pure subroutine dtrsv(uplo, trans, diag, n, a, lda, x, incx)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo, trans, diag
         integer, intent(in) :: n, lda, incx
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(inout) :: x(*)
      end subroutine dtrsv
   end interface

end module amontons_lapack
