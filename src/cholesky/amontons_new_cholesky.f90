!> The choice of a factorization, by name or by the expected cost; and band Cholesky by LAPACK, the simplest and fastest
!> one for small problems.
module amontons_new_cholesky
   use amontons_condenser, only: cholesky_t
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dpbtrf, dtbsv
   use amontons_multifrontal, only: multifrontal_t
   use amontons_sparse_matrix, only: half_bandwidth, reverse_cuthill_mckee, sparse_matrix_t
   use amontons_suitesparse, only: new_sparse_cholesky
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: factorization_names, new_cholesky

   !> L in band storage: entry (i, j) is `band(i - j + 1, j)`.
   type, extends(cholesky_t) :: band_cholesky_t
      private
      integer :: width = 0 !! Number of subdiagonals.
      real(dp), allocatable :: band(:, :) !! The factor (width + 1, n).
   contains
      procedure, public :: analyze => band_analyze
      procedure, public :: complete => band_complete
      procedure, public :: substitute_forward => band_substitute_forward
      procedure, public :: substitute_backward => band_substitute_backward
      procedure, public :: schur_factor => band_schur_factor
   end type band_cholesky_t

   !> Kinds of factorizations, as a deck writes them; the first means the quicker one of band and multifrontal on
   !> one rank, for distributed on several; the last is the former word for multifrontal.
   character(13), parameter :: factorization_names(*) = [character(13) :: 'auto', 'band', 'multifrontal', 'sparse', &
      'distributed', 'substructured']

   !> Largest number of operations for which the band factorization is faster; measured on squares, where both take the
   !> same time at about 4 000 unknowns.
   real(dp), parameter :: most_band_operations = 3.0e7_dp
   !> Largest number of unknowns for which the bandwidth is computed at all.
   integer, parameter :: most_band_unknowns = 10000

contains

   !> Takes a matrix in the order for a narrow band that `new_cholesky` found.
   subroutine band_analyze(self, matrix, n_schur, error)
      class(band_cholesky_t), intent(inout) :: self !! the factorization
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! number of Schur variables, which are the last unknowns
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer, allocatable :: order(:)

      self%name = 'band'
      order = self%order
      self%width = half_bandwidth(matrix, order)
      call self%set_order(matrix, n_schur, order, error)
      self%n_factor_entries = (self%width + 1_int64)*self%n
      ! Each column divides its entries and updates the triangle that they span, adding and multiplying.
      self%n_flops = real(self%n, dp)*(self%width + 1.0_dp)**2
   end subroutine band_analyze

   !> Computes the factor of the matrix that was analyzed.
   subroutine band_complete(self, error)
      class(band_cholesky_t), intent(inout) :: self !! the factorization
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      integer(int64) :: at
      integer :: j, status

      allocate (self%band(self%width + 1, self%n), stat=status)
      if (status /= 0) then
         ! not raised: no test may use up the machine's memory
         call new_error(error, system_failure, 'memory ran out for a band of '//to_text(self%width + 1)//' by '// &
            to_text(self%n)//' numbers')
         return
      end if
      self%band = 0.0_dp
      do j = 1, self%n
         do at = self%matrix%column_start(j), self%matrix%column_start(j + 1) - 1
            self%band(self%matrix%row(at) - j + 1, j) = self%matrix%value(at)
         end do
      end do
      self%matrix = sparse_matrix_t()
      call dpbtrf('L', self%n, self%width, self%band, self%width + 1, status)
      if (status > 0) then
         call self%refuse(self%order(status), error)
      else
         call self%check_factor(error)
      end if
   end subroutine band_complete

   !> Performs the forward substitution of the first columns.
   subroutine band_substitute_forward(self, n_steps, y)
      class(band_cholesky_t), intent(in) :: self !! the factorization
      integer, intent(in) :: n_steps !! number of columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      integer :: j, last

      call dtbsv('L', 'N', 'N', n_steps, self%width, self%band, self%width + 1, y, 1)
      do j = max(1, n_steps - self%width + 1), n_steps
         last = min(self%n, j + self%width)
         y(n_steps + 1:last) = y(n_steps + 1:last) - y(j)*self%band(n_steps - j + 2:last - j + 1, j)
      end do
   end subroutine band_substitute_forward

   !> Performs the backward substitution of the first columns.
   subroutine band_substitute_backward(self, n_steps, y)
      class(band_cholesky_t), intent(in) :: self !! the factorization
      integer, intent(in) :: n_steps !! number of columns
      real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)
      integer :: j, k, last

      do k = 1, size(y, 2)
         do j = max(1, n_steps - self%width + 1), n_steps
            last = min(self%n, j + self%width)
            y(j, k) = y(j, k) - dot_product(y(n_steps + 1:last, k), self%band(n_steps - j + 2:last - j + 1, j))
         end do
         call dtbsv('L', 'T', 'N', n_steps, self%width, self%band, self%width + 1, y(:, k), 1)
      end do
   end subroutine band_substitute_backward

   !> Copies the last block of L out of the band.
   subroutine band_schur_factor(self, l22)
      class(band_cholesky_t), intent(in) :: self !! the factorization
      real(dp), contiguous, intent(out) :: l22(:, :)
         !! lower triangular, zeros above, in the order `schur_order` (n_schur, n_schur)
      integer :: j, below

      l22 = 0.0_dp
      do j = 1, self%n_schur
         below = min(self%n_schur, j + self%width)
         l22(j:below, j) = self%band(1:below - j + 1, self%n - self%n_schur + j)
      end do
   end subroutine band_schur_factor

   !> Makes a factorization of a kind and has it analyze a matrix. `check_memory` and `complete` follow, which need the
   !> matrix no more.
   subroutine new_cholesky(cholesky, kind, matrix, n_schur, error)
      class(cholesky_t), allocatable, intent(out) :: cholesky !! the factorization
      character(*), intent(in) :: kind !! one of `factorization_names`
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! number of Schur variables, which are the last unknowns
      type(error_t), allocatable, intent(out) :: error !! this build has no such kind, or memory ran out
      integer, allocatable :: order(:)
      logical :: is_band

      is_band = kind == 'band'
      if (is_band .or. (kind == 'auto' .and. matrix%n <= most_band_unknowns)) then
         allocate (order(matrix%n))
         call reverse_cuthill_mckee(matrix, n_schur, order)
         is_band = is_band .or. real(matrix%n, dp)*real(half_bandwidth(matrix, order), dp)**2 <= most_band_operations
      end if
      if (kind == 'sparse') then
         call new_sparse_cholesky(cholesky, error)
      else if (is_band) then
         allocate (band_cholesky_t :: cholesky)
         call move_alloc(order, cholesky%order)
      else
         allocate (multifrontal_t :: cholesky)
      end if
      if (.not. allocated(error)) call cholesky%analyze(matrix, n_schur, error)
   end subroutine new_cholesky

end module amontons_new_cholesky
