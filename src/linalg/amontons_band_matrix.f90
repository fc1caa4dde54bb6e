!> Band matrices, by LAPACK: symmetric ones with products, Cholesky factor and the entries of the inverse near the
!> diagonal; general ones with LU factorization and row exchanges.
module amontons_band_matrix
   use amontons_kinds, only: dp
   use amontons_lapack, only: dgbtrf, dgbtrs, dpbtrf, dsbmv, dtbsv
   implicit none (type, external)
   private

   public :: band_lu_t, new_band_matrix, new_symmetric_band, symmetric_band_t

   !> A symmetric band matrix, or its Cholesky factor L: entry (i, j), i >= j, is `entry(i - j + 1, j)`.
   type :: symmetric_band_t
      integer :: n = 0 !! order of the matrix
      integer :: width = 0 !! number of subdiagonals
      real(dp), allocatable :: entry(:, :) !! lower triangle (width + 1, n)
   contains
      procedure :: add => symmetric_band_add
      procedure :: decouple => symmetric_band_decouple
      procedure :: element => symmetric_band_element
      procedure :: factorize => symmetric_band_factorize
      procedure :: inverse_band => symmetric_band_inverse_band
      procedure :: multiply => symmetric_band_multiply
      procedure :: solve => symmetric_band_solve
   end type symmetric_band_t

   !> A band matrix, overwritten by its triangular factors: entry (i, j) of the matrix is `entry(2*width + 1 + i - j,
   !> j)`; the rows before are for the fill of row exchanges.
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

   !> Makes a symmetric band matrix of zeros.
   pure subroutine new_symmetric_band(matrix, n, width)
      type(symmetric_band_t), intent(out) :: matrix !! the matrix
      integer, intent(in) :: n !! its order
      integer, intent(in) :: width !! number of subdiagonals

      matrix%n = n
      matrix%width = width
      allocate (matrix%entry(width + 1, n), source=0.0_dp)
   end subroutine new_symmetric_band

   !> Adds a value to an entry and to its mirror image across the diagonal.
   pure subroutine symmetric_band_add(self, row, column, value)
      class(symmetric_band_t), intent(inout) :: self !! the matrix
      integer, intent(in) :: row !! row of the entry
      integer, intent(in) :: column !! its column, at most `width` away
      real(dp), intent(in) :: value !! the addend

      associate (entry => self%entry(abs(row - column) + 1, min(row, column)))
         entry = entry + value
      end associate
   end subroutine symmetric_band_add

   !> An entry of the matrix; 0 outside the band.
   pure real(dp) function symmetric_band_element(self, row, column) result(element)
      class(symmetric_band_t), intent(in) :: self !! the matrix
      integer, intent(in) :: row !! row of the entry
      integer, intent(in) :: column !! its column

      element = 0.0_dp
      if (abs(row - column) <= self%width) element = self%entry(abs(row - column) + 1, min(row, column))
   end function symmetric_band_element

   !> Replaces a row and its column by those of the unit matrix.
   pure subroutine symmetric_band_decouple(self, row)
      class(symmetric_band_t), intent(inout) :: self !! the matrix
      integer, intent(in) :: row !! number of the row
      integer :: column

      do column = max(1, row - self%width), row - 1
         self%entry(row - column + 1, column) = 0.0_dp
      end do
      self%entry(:, row) = 0.0_dp
      self%entry(1, row) = 1.0_dp
   end subroutine symmetric_band_decouple

   !> The product y = A x.
   pure subroutine symmetric_band_multiply(self, x, y)
      class(symmetric_band_t), intent(in) :: self !! the matrix A
      real(dp), contiguous, intent(in) :: x(:) !! the vector (n)
      real(dp), contiguous, intent(out) :: y(:) !! the product (n)

      y = 0.0_dp
      call dsbmv('L', self%n, self%width, 1.0_dp, self%entry, self%width + 1, x, 1, 0.0_dp, y, 1)
   end subroutine symmetric_band_multiply

   !> Replaces a positive definite matrix by its Cholesky factor.
   pure subroutine symmetric_band_factorize(self, info)
      class(symmetric_band_t), intent(inout) :: self !! the matrix, and then L with A = L L^T
      integer, intent(out) :: info !! 0, or the row whose pivot is not positive

      call dpbtrf('L', self%n, self%width, self%entry, self%width + 1, info)
   end subroutine symmetric_band_factorize

   !> Solves A x = b with the factor.
   pure subroutine symmetric_band_solve(self, x)
      class(symmetric_band_t), intent(in) :: self !! the factor of A
      real(dp), contiguous, intent(inout) :: x(:) !! b, and then x (n)

      call dtbsv('L', 'N', 'N', self%n, self%width, self%entry, self%width + 1, x, 1)
      call dtbsv('L', 'T', 'N', self%n, self%width, self%entry, self%width + 1, x, 1)
   end subroutine symmetric_band_solve

   !> The entries of the inverse within a band, from the factor: from the last column to the first, each from those
   !> after it (Takahashi, Fagan and Chen, 1973). With l = L(j+1:, j)/L(j, j), Z the inverse of what comes after j:
   !> A^-1(j+1:, j) = -Z l, A^-1(j, j) = 1/L(j, j)^2 + l.Z l.
   pure subroutine symmetric_band_inverse_band(self, width, inverse)
      class(symmetric_band_t), intent(in) :: self !! the factor of A
      integer, intent(in) :: width !! number of subdiagonals wanted, at least those of the factor
      type(symmetric_band_t), intent(out) :: inverse !! A^-1 within the band
      real(dp), dimension(width) :: l, z
      integer :: j, n, n_below

      call new_symmetric_band(inverse, self%n, width)
      do j = self%n, 1, -1
         n = min(width, self%n - j)
         n_below = min(self%width, n)
         associate (pivot => self%entry(1, j))
            l = 0.0_dp
            l(:n_below) = self%entry(2:n_below + 1, j)/pivot
            inverse%entry(1, j) = 1.0_dp/pivot**2
            if (n == 0) cycle
            z(:n) = 0.0_dp
            call dsbmv('L', n, min(width, n), 1.0_dp, inverse%entry(:, j + 1:), width + 1, l, 1, 0.0_dp, z, 1)
            inverse%entry(2:n + 1, j) = -z(:n)
            inverse%entry(1, j) = inverse%entry(1, j) + dot_product(l(:n), z(:n))
         end associate
      end do
   end subroutine symmetric_band_inverse_band

   !> Makes a zero matrix; reuses the memory of one of the same size.
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

   !> Adds a number to an entry of the matrix.
   pure subroutine band_lu_add(self, row, column, value)
      class(band_lu_t), intent(inout) :: self !! the matrix
      integer, intent(in) :: row !! row of the entry
      integer, intent(in) :: column !! its column, at most `width` away
      real(dp), intent(in) :: value !! the addend

      associate (entry => self%entry(2*self%width + 1 + row - column, column))
         entry = entry + value
      end associate
   end subroutine band_lu_add

   !> Replaces the matrix by its triangular factors.
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

end module amontons_band_matrix
