!> The choice of a factorisation: by name, or by what the matrix would cost.
module amontons_new_factorization
   use amontons_band_factorization, only: band_factorization_t
   use amontons_error, only: error_t
   use amontons_factorization, only: factorization_t
   use amontons_kinds, only: dp
   use amontons_ordering, only: half_bandwidth, reverse_cuthill_mckee
   use amontons_sparse_factorization, only: sparse_factorization_t
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_substructured_factorization, only: substructured_factorization_t
   implicit none (type, external)
   private

   public :: analyze_matrix, factorization_names, new_factorization

   !> Kinds of factorisations, as a deck writes them; the first stands for the quickest of the others.
   character(13), parameter :: factorization_names(*) = [character(13) :: 'auto', 'band', 'sparse', 'substructured']

   !> Number of operations of a band factorisation up to which it is the quicker one; measured on squares, where it
   !> meets the substructured one at about 4 000 unknowns.
   real(dp), parameter :: most_band_operations = 3.0e7_dp
   !> Number of unknowns beyond which the width of the band is not even looked at.
   integer, parameter :: most_band_unknowns = 10000

contains

   !> Makes a factorisation of a matrix with its last unknowns eliminated last.
   subroutine new_factorization(factorization, kind, matrix, n_trailing, error)
      class(factorization_t), allocatable, intent(out) :: factorization !! the factorisation
      character(*), intent(in) :: kind !! one of `factorization_names`
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_trailing !! how many unknowns, the last ones, are eliminated last
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory is short

      call analyze_matrix(factorization, kind, matrix, n_trailing, error)
      if (allocated(error)) return
      call factorization%check_memory(error)
      if (allocated(error)) return
      call factorization%complete(error)
   end subroutine new_factorization

   !> Prepares a factorisation: everything that needs the matrix. What is left is `check_memory` and `complete`.
   subroutine analyze_matrix(factorization, kind, matrix, n_trailing, error)
      class(factorization_t), allocatable, intent(out) :: factorization !! the factorisation
      character(*), intent(in) :: kind !! one of `factorization_names`
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_trailing !! how many unknowns, the last ones, are eliminated last
      type(error_t), allocatable, intent(out) :: error !! memory ran out

      select case (kind)
      case ('band')
         allocate (band_factorization_t :: factorization)
      case ('sparse')
         allocate (sparse_factorization_t :: factorization)
      case ('substructured')
         allocate (substructured_factorization_t :: factorization)
      case default
         if (suits_band(matrix, n_trailing)) then
            allocate (band_factorization_t :: factorization)
         else if (.not. allocated(matrix%place)) then
            allocate (sparse_factorization_t :: factorization)
         else
            allocate (substructured_factorization_t :: factorization)
         end if
      end select
      call factorization%analyze(matrix, n_trailing, error)
      factorization%matrix_norm = matrix%norm()
   end subroutine analyze_matrix

   !> Whether a band factorisation should be quicker than a sparse one.
   pure logical function suits_band(matrix, n_trailing)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_trailing !! number of trailing unknowns
      integer, allocatable :: order(:)
      real(dp) :: n_operations

      suits_band = .false.
      if (matrix%n > most_band_unknowns) return
      allocate (order(matrix%n))
      call reverse_cuthill_mckee(matrix, n_trailing, order)
      n_operations = real(matrix%n, dp)*real(half_bandwidth(matrix, order), dp)**2
      suits_band = n_operations <= most_band_operations
   end function suits_band

end module amontons_new_factorization
