!> Elimination of a general sparse matrix in a build without SuiteSparse: in a band, by LAPACK.
module amontons_sparse_lu
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_lapack, only: dgbtrf, dgbtrs
   use amontons_sparse_matrix, only: entries_t, half_bandwidth, new_sparse_pattern, positions, &
      reverse_cuthill_mckee, sparse_matrix_t
   implicit none (type, external)
   private

   public :: sparse_lu_t

   !> The triangular factors of a matrix.
   type :: sparse_lu_t
      private
      integer :: width = 0 !! Number of diagonals on each side.
      integer, allocatable :: order(:) !! Position k holds unknown order(k) (n).
      integer, allocatable :: pivots(:) !! The row exchanges (n).
      real(dp), allocatable :: band(:, :) !! The factors as LAPACK has them (3 width + 1, n).
   contains
      procedure, public :: factorize => sparse_lu_factorize
      procedure, public :: solve_transposed => sparse_lu_solve_transposed
   end type sparse_lu_t

contains

   !> Factorizes the matrix of some entries.
   subroutine sparse_lu_factorize(self, n, entries, info)
      class(sparse_lu_t), intent(inout) :: self !! the factors
      integer, intent(in) :: n !! order of the matrix, at least 1
      type(entries_t), intent(in) :: entries !! its entries
      integer, intent(out) :: info !! 0, or nonzero where the matrix is singular or too large for the memory
      type(sparse_matrix_t) :: pattern
      type(error_t), allocatable :: error
      integer, allocatable :: position(:)
      integer :: i, j, k

      if (allocated(self%band)) deallocate (self%band)
      ! The symmetric pattern, each entry an element of two unknowns.
      call new_sparse_pattern(pattern, n, [(2*k - 1, k=1, entries%n + 1)], &
         [(entries%row(k), entries%column(k), k=1, entries%n)], error)
      info = merge(1, 0, allocated(error))
      if (info /= 0) return
      self%order = [(k, k=1, n)]
      call reverse_cuthill_mckee(pattern, 0, self%order)
      self%width = half_bandwidth(pattern, self%order)
      allocate (self%band(3*self%width + 1, n), stat=info)
      if (info /= 0) return
      self%band = 0.0_dp
      position = positions(self%order)
      do k = 1, entries%n
         i = position(entries%row(k))
         j = position(entries%column(k))
         associate (entry => self%band(2*self%width + 1 + i - j, j))
            entry = entry + entries%value(k)
         end associate
      end do
      self%pivots = self%order
      call dgbtrf(n, n, self%width, self%width, self%band, size(self%band, 1), self%pivots, info)
   end subroutine sparse_lu_factorize

   !> Solves A^T x = b.
   subroutine sparse_lu_solve_transposed(self, b, info)
      class(sparse_lu_t), intent(in) :: self !! the factors of A
      real(dp), intent(inout) :: b(:) !! right-hand side (n), the solution on return
      integer, intent(out) :: info !! 0
      real(dp) :: x(size(b))

      x = b(self%order)
      call dgbtrs('T', size(b), self%width, self%width, 1, self%band, size(self%band, 1), self%pivots, x, size(b), info)
      b(self%order) = x
   end subroutine sparse_lu_solve_transposed

end module amontons_sparse_lu
