!> Elimination of a general band matrix with exchange of rows, by LAPACK.
module amontons_band_lu
   use amontons_kinds, only: dp
   use amontons_lapack, only: dgbtrf, dgbtrs
   implicit none (type, external)
   private

   public :: band_lu_t, new_band_matrix

   !> A band matrix and then its triangular factors: entry (i, j) of the matrix is `entry(2*width + 1 + i - j, j)`; the
   !> rows before are for what the exchanges fill.
   type :: band_lu_t
      integer :: n = 0 !! order of the matrix
      integer :: width = 0 !! number of subdiagonals, and of superdiagonals
      real(dp), allocatable :: entry(:, :) !! the matrix, or its factors (3*width + 1, n)
      integer, allocatable, private :: pivots(:) !! the exchanges of rows (n)
   contains
      procedure :: add => band_lu_add
      procedure :: factorize => band_lu_factorize
      procedure :: solve => band_lu_solve
   end type band_lu_t

contains

   !> Makes a zero matrix; the room of one of the same size is used again.
   pure subroutine new_band_matrix(matrix, n, width)
      type(band_lu_t), intent(inout) :: matrix !! the matrix
      integer, intent(in) :: n !! its order
      integer, intent(in) :: width !! number of subdiagonals, and of superdiagonals

      if (matrix%n /= n .or. matrix%width /= width .or. .not. allocated(matrix%entry)) then
         matrix = band_lu_t(n=n, width=width)
         allocate (matrix%entry(3*width + 1, n), matrix%pivots(n))
      end if
      matrix%entry = 0.0_dp
   end subroutine new_band_matrix

   !> Adds to an entry.
   pure subroutine band_lu_add(self, row, column, value)
      class(band_lu_t), intent(inout) :: self !! the matrix
      integer, intent(in) :: row !! row of the entry
      integer, intent(in) :: column !! its column, at most `width` away
      real(dp), intent(in) :: value !! what is added

      associate (entry => self%entry(2*self%width + 1 + row - column, column))
         entry = entry + value
      end associate
   end subroutine band_lu_add

   !> Puts the triangular factors in the place of the matrix.
   pure subroutine band_lu_factorize(self, info)
      class(band_lu_t), intent(inout) :: self !! the matrix, and then its factors
      integer, intent(out) :: info !! 0, or nonzero where the matrix is singular

      call dgbtrf(self%n, self%n, self%width, self%width, self%entry, 3*self%width + 1, self%pivots, info)
   end subroutine band_lu_factorize

   !> Solves M x = b with the factors.
   pure subroutine band_lu_solve(self, x)
      class(band_lu_t), intent(in) :: self !! the factors of M
      real(dp), contiguous, intent(inout) :: x(:) !! b, and then x (n)
      integer :: info

      call dgbtrs('N', self%n, self%width, self%width, 1, self%entry, 3*self%width + 1, self%pivots, x, self%n, info)
   end subroutine band_lu_solve

end module amontons_band_lu
