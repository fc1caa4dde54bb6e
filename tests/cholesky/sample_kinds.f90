!> The kinds of Cholesky factorization that this build has, and factorizations of a matrix.
module sample_kinds
   use amontons_condenser, only: cholesky_t
   use amontons_error, only: error_t
   use amontons_new_cholesky, only: new_cholesky
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_suitesparse, only: has_suitesparse
   implicit none (type, external)
   private

   public :: kinds, new_factor

   !> Their words in a deck; without SuiteSparse there is no `sparse`.
   character(12), parameter :: kinds(*) = pack([character(12) :: 'band', 'multifrontal', 'sparse'], &
      [.true., .true., has_suitesparse])

contains

   !> Factorizes a matrix.
   subroutine new_factor(cholesky, kind, matrix, n_schur, error)
      class(cholesky_t), allocatable, intent(out) :: cholesky !! the factorization
      character(*), intent(in) :: kind !! its kind
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! how many unknowns, the last ones, are eliminated last
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory is short

      call new_cholesky(cholesky, kind, matrix, n_schur, error)
      if (.not. allocated(error)) call cholesky%check_memory(error)
      if (.not. allocated(error)) call cholesky%complete(error)
   end subroutine new_factor

end module sample_kinds
