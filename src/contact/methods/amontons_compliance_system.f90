!> Newton's linear system in the forces, on a dense compliance A.
!>
!> Each force has one row: an unknown one that of `A lambda = B`, the others that of the law which gives them.
module amontons_compliance_system
   use amontons_contact_problem, only: contact_problem_t
   use amontons_dense, only: cholesky_factor, cholesky_solve, lu_factor, lu_solve_transposed
   use amontons_force_system, only: force_system_t
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: compliance_system_t

   !> The system and its factorization.
   type, extends(force_system_t) :: compliance_system_t
      private
      logical :: is_symmetric = .false. !! Whether no point slides with friction, so that its matrix is symmetric.
      real(dp), allocatable :: entries(:)
         !! Cholesky factor, or triangular factors of the transposed matrix, and room: memory is costly to get anew.
      integer, allocatable :: pivots(:) !! Their row exchanges.
   contains
      procedure, public :: factorize => compliance_system_factorize
      procedure, public :: solve_unknown => compliance_system_solve_unknown
   end type compliance_system_t

contains

   !> Factorizes the system of the base.
   subroutine compliance_system_factorize(self, problem, info)
      class(compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), allocatable :: entries(:)
      integer :: n

      if (.not. allocated(self%entries)) allocate (self%entries(0))
      n = size(self%unknown)
      if (size(self%entries, kind=int64) < int(n, int64)**2) then
         deallocate (self%entries)
         allocate (self%entries(int(n, int64)**2))
      end if
      self%is_symmetric = .not. any(self%base%is_closed .and. self%base%slip_direction /= 0 &
         .and. problem%friction > 0.0_dp)
      ! No argument may hold what another one writes.
      call move_alloc(self%entries, entries)
      call factorize_entries(self, problem, n, entries, info)
      call move_alloc(entries, self%entries)
   end subroutine compliance_system_factorize

   !> Writes the transposed matrix of the active set to the first of its entries, and makes its factor of it.
   subroutine factorize_entries(self, problem, n, factor, info)
      class(compliance_system_t), intent(inout) :: self !! the system, without its entries; gains the row exchanges
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: n !! order of the matrix
      real(dp), intent(out) :: factor(n, n) !! the factor
      integer, intent(out) :: info !! 0, or nonzero where the matrix is singular
      real(dp) :: slopes(problem%n_points)
      integer :: i, j

      slopes = self%base%slip_direction*problem%friction
      associate (a => problem%matrix%compliance%values, unknown => self%unknown, m => problem%n_points)
         do i = 1, n
            do j = 1, n
               factor(j, i) = a(unknown(j), unknown(i))
            end do
            do j = 1, count(unknown <= m)
               factor(j, i) = factor(j, i) + slopes(unknown(j))*a(m + unknown(j), unknown(i))
            end do
            factor(i, i) = factor(i, i) + self%regularization*self%diagonal(unknown(i))
         end do
      end associate
      if (self%is_symmetric) then
         call cholesky_factor(factor, info)
      else
         call lu_factor(factor, self%pivots, info)
      end if
   end subroutine factorize_entries

   !> Solves the factorized system for its unknown forces.
   subroutine compliance_system_solve_unknown(self, right, info)
      class(compliance_system_t), intent(in) :: self !! the system
      real(dp), contiguous, intent(inout) :: right(:, :) !! right-hand sides, the solutions on return
      integer, intent(out) :: info !! 0, as a factor that was made is not singular

      info = 0
      call solve_entries(self, size(right, 1), self%entries, right)
   end subroutine compliance_system_solve_unknown

   !> Solves with the first of the entries as a matrix.
   subroutine solve_entries(self, n, factor, right)
      class(compliance_system_t), intent(in) :: self !! the system
      integer, intent(in) :: n !! order of the matrix
      real(dp), intent(in) :: factor(n, n) !! the factor
      real(dp), contiguous, intent(inout) :: right(:, :) !! right-hand sides, the solutions on return

      if (self%is_symmetric) then
         call cholesky_solve(factor, right)
      else
         call lu_solve_transposed(factor, self%pivots, right)
      end if
   end subroutine solve_entries

end module amontons_compliance_system
