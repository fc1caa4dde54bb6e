!> Sparse Cholesky in a build without SuiteSparse: it is refused.
module amontons_suitesparse
   use amontons_condenser, only: cholesky_t
   use amontons_error, only: error_t, input_refused, new_error
   implicit none (type, external)
   private

   public :: has_suitesparse, new_sparse_cholesky, suitesparse_text

   !> Whether this build has SuiteSparse.
   logical, parameter :: has_suitesparse = .false.

contains

   !> Refuses to make a factorization.
   subroutine new_sparse_cholesky(cholesky, error)
      class(cholesky_t), allocatable, intent(inout) :: cholesky !! not allocated on return
      type(error_t), allocatable, intent(out) :: error !! the reason

      if (allocated(cholesky)) deallocate (cholesky)
      call new_error(error, input_refused, "factorization = 'sparse' needs SuiteSparse, and this program was built "// &
         "without it (AMONTONS_SUITESPARSE=OFF); choose 'auto', 'band' or 'multifrontal'")
   end subroutine new_sparse_cholesky

   !> The text that replaces SuiteSparse's versions in --version.
   pure function suitesparse_text() result(text)
      character(:), allocatable :: text

      text = 'none'
   end function suitesparse_text

end module amontons_suitesparse
