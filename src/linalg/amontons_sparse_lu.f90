!> Elimination of a general sparse matrix, by UMFPACK.
module amontons_sparse_lu
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_null_ptr, c_ptr
   use amontons_kinds, only: dp
   use amontons_sparse_matrix, only: entries_t
   implicit none (type, external)
   private

   public :: sparse_lu_t

   !> The triangular factors of a matrix.
   type :: sparse_lu_t
      private
      type(c_ptr) :: numeric = c_null_ptr !! UMFPACK's side of the factorization.
   contains
      procedure, public :: factorize => sparse_lu_factorize
      procedure, public :: solve_transposed => sparse_lu_solve_transposed
      final :: sparse_lu_free
   end type sparse_lu_t

   ! allow(assumed-size): C takes an address without a shape
   interface
      function umfpack_factorize(n, n_entries, row, column, value, numeric) &
         bind(c, name='amontons_umfpack_factorize') result(code)
         import :: c_double, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value, intent(in) :: n, n_entries
         integer(c_int), intent(in) :: row(*), column(*)
         real(c_double), intent(in) :: value(*)
         type(c_ptr), intent(inout) :: numeric
         integer(c_int) :: code
      end function umfpack_factorize

      function umfpack_solve_transposed(numeric, right, solution) &
         bind(c, name='amontons_umfpack_solve_transposed') result(code)
         import :: c_double, c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: numeric
         real(c_double), intent(in) :: right(*)
         real(c_double), intent(inout) :: solution(*)
         integer(c_int) :: code
      end function umfpack_solve_transposed

      subroutine umfpack_free(numeric) bind(c, name='amontons_umfpack_free')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: numeric
      end subroutine umfpack_free
   end interface

contains

   !> Factorizes the matrix of some entries.
   subroutine sparse_lu_factorize(self, n, entries, info)
      class(sparse_lu_t), intent(inout) :: self !! the factors
      integer, intent(in) :: n !! order of the matrix, at least 1
      type(entries_t), intent(in) :: entries !! its entries
      integer, intent(out) :: info !! 0, or nonzero where the matrix is singular or too large for the memory

      call umfpack_free(self%numeric)
      self%numeric = c_null_ptr
      associate (m => entries%n)
         info = int(umfpack_factorize(int(n, c_int), int(m, c_int), entries%row(:m) - 1, entries%column(:m) - 1, &
            entries%value(:m), self%numeric))
      end associate
   end subroutine sparse_lu_factorize

   !> Solves A^T x = b.
   subroutine sparse_lu_solve_transposed(self, b, info)
      class(sparse_lu_t), intent(in) :: self !! the factors of A
      real(dp), intent(inout) :: b(:) !! right-hand side (n), the solution on return
      integer, intent(out) :: info !! 0, or nonzero where the matrix is singular
      real(dp) :: solution(size(b))

      solution = 0.0_dp
      info = int(umfpack_solve_transposed(self%numeric, b, solution))
      b = solution
   end subroutine sparse_lu_solve_transposed

   !> Frees the factors.
   impure elemental subroutine sparse_lu_free(self)
      type(sparse_lu_t), intent(inout) :: self !! the factors

      call umfpack_free(self%numeric)
      self%numeric = c_null_ptr
   end subroutine sparse_lu_free

end module amontons_sparse_lu
