!> The choice of a factorization: by name, or by what the matrix would cost.
module amontons_new_cholesky
   use amontons_band_cholesky, only: band_cholesky_t
   use amontons_condenser, only: cholesky_t, condenser_t
   use amontons_error, only: error_t
   use amontons_graph, only: half_bandwidth, reverse_cuthill_mckee
   use amontons_kinds, only: dp
   use amontons_multifrontal, only: multifrontal_t
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_suitesparse, only: new_sparse_cholesky
   implicit none (type, external)
   private

   public :: factorization_names, new_cholesky, new_condenser

   !> Kinds of factorizations, as a deck writes them; the first stands for the quicker one of band and multifrontal on
   !> one rank, for distributed on several; the last is the former word for multifrontal.
   character(13), parameter :: factorization_names(*) = [character(13) :: 'auto', 'band', 'multifrontal', 'sparse', &
      'distributed', 'substructured']

   !> Number of operations of a band factorization up to which it is the quicker one; measured on squares, where it
   !> meets the multifrontal one at about 4 000 unknowns.
   real(dp), parameter :: most_band_operations = 3.0e7_dp
   !> Number of unknowns beyond which the width of the band is not even looked at.
   integer, parameter :: most_band_unknowns = 10000

contains

   !> Makes a condenser of a matrix and has it analyze the matrix: everything that needs the matrix. What is left is
   !> `check_memory` and `complete`.
   subroutine new_condenser(condenser, kind, matrix, n_schur, error)
      class(condenser_t), allocatable, intent(out) :: condenser !! the condenser
      character(*), intent(in) :: kind !! one of `factorization_names`
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! how many unknowns, the last ones, are Schur variables
      type(error_t), allocatable, intent(out) :: error !! this build has no such kind, or memory ran out
      class(cholesky_t), allocatable :: cholesky

      call choose(cholesky, kind, matrix, n_schur, error)
      if (allocated(error)) return
      call cholesky%analyze(matrix, n_schur, error)
      call move_alloc(cholesky, condenser)
   end subroutine new_condenser

   !> Makes a Cholesky factorization of a matrix.
   subroutine new_cholesky(cholesky, kind, matrix, n_schur, error)
      class(cholesky_t), allocatable, intent(out) :: cholesky !! the factorization
      character(*), intent(in) :: kind !! one of `factorization_names`
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! how many unknowns, the last ones, are eliminated last
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory is short

      call choose(cholesky, kind, matrix, n_schur, error)
      if (allocated(error)) return
      call cholesky%factorize(matrix, n_schur, error)
   end subroutine new_cholesky

   !> Chooses a kind.
   subroutine choose(cholesky, kind, matrix, n_schur, error)
      class(cholesky_t), allocatable, intent(out) :: cholesky !! a factorization without a matrix
      character(*), intent(in) :: kind !! one of `factorization_names`
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! number of Schur variables
      type(error_t), allocatable, intent(out) :: error !! this build has no such kind
      integer, allocatable :: order(:)
      logical :: is_band

      is_band = kind == 'band'
      if (kind == 'auto' .and. matrix%n <= most_band_unknowns) then
         allocate (order(matrix%n))
         call reverse_cuthill_mckee(matrix, n_schur, order)
         is_band = real(matrix%n, dp)*real(half_bandwidth(matrix, order), dp)**2 <= most_band_operations
      end if
      if (kind == 'sparse') then
         call new_sparse_cholesky(cholesky, error)
      else if (is_band) then
         allocate (band_cholesky_t :: cholesky)
      else
         allocate (multifrontal_t :: cholesky)
      end if
   end subroutine choose

end module amontons_new_cholesky
