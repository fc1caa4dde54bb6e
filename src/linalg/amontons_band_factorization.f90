!> Band Cholesky by LAPACK: the plain and quick way for small problems.
module amontons_band_factorization
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_factorization, only: factorization_t
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dpbtrf, dtbsv
   use amontons_ordering, only: half_bandwidth, reverse_cuthill_mckee
   use amontons_sparse_matrix, only: positions, sparse_matrix_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: band_factorization_t

   !> L in band storage: entry (i, j) is `band(i - j + 1, j)`.
   type, extends(factorization_t) :: band_factorization_t
      private
      integer :: width = 0 !! Number of subdiagonals.
      real(dp), allocatable :: band(:, :) !! The factor (width + 1, n).
      type(sparse_matrix_t) :: matrix !! The matrix, from `analyze` to `complete`.
   contains
      procedure, public :: analyze => band_analyze
      procedure, public :: complete => band_complete
      procedure, public :: substitute_forward => band_substitute_forward
      procedure, public :: substitute_backward => band_substitute_backward
      procedure, public :: trailing_factor => band_trailing_factor
      procedure, public :: n_factor_entries => band_n_factor_entries
      procedure, public, nopass :: name => band_name
   end type band_factorization_t

contains

   !> Orders a matrix for a narrow band.
   subroutine band_analyze(self, matrix, n_trailing, error)
      class(band_factorization_t), intent(inout) :: self !! the factorisation
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_trailing !! how many unknowns, the last ones, are eliminated last
      type(error_t), allocatable, intent(out) :: error !! never allocated
      integer, allocatable :: order(:)

      allocate (order(matrix%n))
      call reverse_cuthill_mckee(matrix, n_trailing, order)
      call self%set_order(matrix, n_trailing, order)
      self%width = half_bandwidth(matrix, order)
      ! Each column divides its entries and updates the triangle that they span, adding and multiplying.
      self%n_flops = real(self%n, dp)*(self%width + 1.0_dp)**2
      self%matrix = matrix
      if (allocated(self%band)) deallocate (self%band)
   end subroutine band_analyze

   !> Computes the factor of the matrix that was analysed.
   subroutine band_complete(self, error)
      class(band_factorization_t), intent(inout) :: self !! the factorisation
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      integer :: status

      allocate (self%band(self%width + 1, self%n), stat=status)
      if (status /= 0) then
         ! not raised: no test may use up the machine's memory
         call new_error(error, system_failure, 'memory ran out for a band of '//to_text(self%width + 1)//' by '// &
            to_text(self%n)//' numbers')
         return
      end if
      call fill_band(self%matrix, self%order, self%band)
      self%matrix = sparse_matrix_t()
      call dpbtrf('L', self%n, self%width, self%band, self%width + 1, status)
      if (status > 0) then
         call self%refuse(status, error)
      else
         call self%check_pivots(self%band(1, :), error)
      end if
   end subroutine band_complete

   !> Writes the matrix in band storage.
   pure subroutine fill_band(matrix, order, band)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: order(:) !! position k holds unknown order(k) (n)
      real(dp), intent(out) :: band(:, :) !! its lower triangle by position (width + 1, n)
      integer, allocatable :: position(:)
      integer(int64) :: at
      integer :: i, j, k

      allocate (position, source=positions(order))
      band = 0.0_dp
      do k = 1, matrix%n
         do at = matrix%column_start(k), matrix%column_start(k + 1) - 1
            i = position(matrix%row(at))
            j = position(k)
            band(abs(i - j) + 1, min(i, j)) = matrix%value(at)
         end do
      end do
   end subroutine fill_band

   !> Does the forward steps of the first columns.
   subroutine band_substitute_forward(self, n_steps, y)
      class(band_factorization_t), intent(in) :: self !! the factorisation
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      integer :: j, last

      call dtbsv('L', 'N', 'N', n_steps, self%width, self%band, self%width + 1, y, 1)
      do j = max(1, n_steps - self%width + 1), n_steps
         last = min(self%n, j + self%width)
         y(n_steps + 1:last) = y(n_steps + 1:last) - y(j)*self%band(n_steps - j + 2:last - j + 1, j)
      end do
   end subroutine band_substitute_forward

   !> Does the backward steps of the first columns.
   subroutine band_substitute_backward(self, n_steps, y)
      class(band_factorization_t), intent(in) :: self !! the factorisation
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      integer :: j, last

      do j = max(1, n_steps - self%width + 1), n_steps
         last = min(self%n, j + self%width)
         y(j) = y(j) - dot_product(y(n_steps + 1:last), self%band(n_steps - j + 2:last - j + 1, j))
      end do
      call dtbsv('L', 'T', 'N', n_steps, self%width, self%band, self%width + 1, y, 1)
   end subroutine band_substitute_backward

   !> Copies the last block of L out of the band.
   subroutine band_trailing_factor(self, l22)
      class(band_factorization_t), intent(in) :: self !! the factorisation
      real(dp), contiguous, intent(out) :: l22(:, :)
         !! lower triangular, zeros above, by trailing position (n_trailing, n_trailing)
      integer :: j, below

      l22 = 0.0_dp
      do j = 1, self%n_trailing
         below = min(self%n_trailing, j + self%width)
         l22(j:below, j) = self%band(1:below - j + 1, self%n - self%n_trailing + j)
      end do
   end subroutine band_trailing_factor

   !> The number of stored entries, zeros inside the band included.
   pure function band_n_factor_entries(self) result(n_entries)
      class(band_factorization_t), intent(in) :: self !! the factorisation
      integer(int64) :: n_entries

      n_entries = (self%width + 1_int64)*self%n
   end function band_n_factor_entries

   !> The word `band`.
   pure function band_name() result(name)
      character(:), allocatable :: name

      name = 'band'
   end function band_name

end module amontons_band_factorization
