!> The BLAS and LAPACK routines for band matrices beyond those that a band factorisation of a body takes. What each one
!> computes is in the LAPACK manual.
module amontons_lapack_band
   implicit none (type, external)
   private

   public :: dgbtrf, dgbtrs, dsbmv

   ! allow(assumed-size): these routines take the shape apart from the address
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

      pure subroutine dsbmv(uplo, n, k, alpha, a, lda, x, incx, beta, y, incy)
         use amontons_kinds, only: dp
         implicit none (type, external)
         character, intent(in) :: uplo
         integer, intent(in) :: n, k, lda, incx, incy
         real(dp), intent(in) :: alpha, beta, a(lda, *), x(*)
         real(dp), intent(inout) :: y(*)
      end subroutine dsbmv
   end interface

end module amontons_lapack_band
