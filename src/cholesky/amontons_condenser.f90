!> The seam between contact and whatever factorizes a body: condensation of a symmetric positive definite system.
!>
!> The Schur variables c are the last unknowns of the matrix K, the interior i are the others. A condenser makes
!> S = K_cc - K_ci K_ii^-1 K_ic, for any load b the condensed load q = b_c - K_ci K_ii^-1 b_i, and from the Schur
!> variables v, given or found by S v = q, all unknowns. How and where it keeps its factors is its own affair.
module amontons_condenser
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dlacn2
   use amontons_system, only: available_memory_mb, return_memory
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: condenser_t

   !> A condenser. What comes after `complete` only reads it, so several threads may use one at the same time.
   type, abstract :: condenser_t
      character(:), allocatable :: name !! The word for its kind; like all that follows, known after `analyze`.
      integer :: n = 0 !! Number of unknowns.
      integer :: n_schur = 0 !! Number of Schur variables.
      integer(int64) :: n_factor_entries = 0 !! Entries of the factor, stored zeros included.
      integer(int64) :: n_work_entries = 0 !! Numbers that `complete` holds for a while, beside the factor's.
      real(dp) :: n_flops = 0.0_dp !! Floating-point operations of `complete`.
      real(dp) :: matrix_norm = 0.0_dp !! 1-norm of the matrix.
      real(dp) :: regularization = 0.0_dp
         !! What one that assembles the matrix itself has added to the diagonal entries of the Schur variables.
      integer :: refused_unknown = 0 !! The unknown whose pivot was not positive, 0 for none.
   contains
      procedure(complete), deferred :: complete
      procedure(schur_complement), deferred :: schur_complement
      procedure(condense), deferred :: condense
      procedure(expand), deferred :: expand
      procedure(solve), deferred :: solve
      procedure :: expand_all => condenser_expand_all
      procedure :: check_memory => condenser_check_memory
      procedure :: memory_mb => condenser_memory_mb
      procedure :: condition => condenser_condition
      procedure :: least_refused_condition => condenser_least_refused_condition
   end type condenser_t

   abstract interface
      !> Computes the factor of the matrix that was analyzed.
      subroutine complete(self, error)
         import :: condenser_t, error_t
         implicit none (type, external)
         class(condenser_t), intent(inout) :: self !! the condenser
         type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      end subroutine complete

      !> The Schur complement S.
      subroutine schur_complement(self, s)
         import :: condenser_t, dp
         implicit none (type, external)
         class(condenser_t), intent(in) :: self !! the condenser
         real(dp), contiguous, intent(out) :: s(:, :)
            !! S, both triangles, Schur variables in matrix order (n_schur, n_schur)
      end subroutine schur_complement

      !> Eliminates the interior from a load.
      subroutine condense(self, b, partial, q)
         import :: condenser_t, dp
         implicit none (type, external)
         class(condenser_t), intent(in) :: self !! the condenser
         real(dp), intent(in) :: b(:) !! the load (n)
         real(dp), contiguous, intent(out) :: partial(:) !! what `expand` needs of the load (n)
         real(dp), intent(out) :: q(:) !! the condensed load, Schur variables in matrix order (n_schur)
      end subroutine condense

      !> All unknowns from the Schur variables: K_ii x_i = b_i - K_ic v.
      subroutine expand(self, partial, v, x)
         import :: condenser_t, dp
         implicit none (type, external)
         class(condenser_t), intent(in) :: self !! the condenser
         real(dp), intent(in) :: partial(:) !! what `condense` made of the load (n)
         real(dp), intent(in) :: v(:) !! the Schur variables in matrix order (n_schur)
         real(dp), intent(out) :: x(:) !! all unknowns (n), the last ones equal to v
      end subroutine expand

      !> Solves K x = b.
      subroutine solve(self, b, x)
         import :: condenser_t, dp
         implicit none (type, external)
         class(condenser_t), intent(in) :: self !! the condenser
         real(dp), intent(in) :: b(:) !! right-hand side (n)
         real(dp), intent(out) :: x(:) !! the solution (n)
      end subroutine solve
   end interface

contains

   !> All unknowns from the Schur variables under several loads. What can share its passes over the factor between them
   !> overrides this.
   subroutine condenser_expand_all(self, partial, v, x)
      class(condenser_t), intent(in) :: self !! the condenser
      real(dp), contiguous, intent(in) :: partial(:, :) !! what `condense` made of the loads (n, loads)
      real(dp), contiguous, intent(in) :: v(:, :) !! the Schur variables in matrix order (n_schur, loads)
      real(dp), contiguous, intent(out) :: x(:, :) !! all unknowns (n, loads)
      integer :: k

      do k = 1, size(v, 2)
         call self%expand(partial(:, k), v(:, k), x(:, k))
      end do
   end subroutine condenser_expand_all

   !> The memory that `complete` takes [MB].
   pure real(dp) function condenser_memory_mb(self)
      class(condenser_t), intent(in) :: self !! the condenser, the matrix analyzed

      condenser_memory_mb = 8.0e-6_dp*real(self%n_factor_entries + self%n_work_entries, dp)
   end function condenser_memory_mb

   !> Refuses a factor that the memory cannot hold, before anything is allocated for it. What the analysis has freed
   !> goes back to the system first.
   subroutine condenser_check_memory(self, error)
      class(condenser_t), intent(in) :: self !! the condenser, the matrix analyzed
      type(error_t), allocatable, intent(out) :: error !! not enough memory

      call return_memory()
      if (self%memory_mb() <= available_memory_mb()) return
      call new_error(error, system_failure, 'not enough memory: the '//self%name//' factor of '// &
         to_text(self%n)//' unknowns needs '//to_text(nint(self%memory_mb(), int64))//' MB, and '// &
         to_text(nint(available_memory_mb(), int64))//' MB are available')
   end subroutine condenser_check_memory

   !> Estimates the condition number in the 1-norm with four or five solutions, by Higham's estimator of the norm of the
   !> inverse: a bound from below, rarely less than a third of the number.
   real(dp) function condenser_condition(self) result(condition)
      class(condenser_t), intent(in) :: self !! the condenser, complete
      real(dp), allocatable :: v(:), x(:), y(:)
      real(dp) :: inverse_norm
      integer, allocatable :: signs(:)
      integer :: next, state(3)

      allocate (v(self%n), x(self%n), y(self%n), signs(self%n))
      next = 0
      inverse_norm = 0.0_dp
      do
         call dlacn2(self%n, v, x, signs, inverse_norm, next, state)
         if (next == 0) exit
         call self%solve(x, y)
         x = y
      end do
      condition = self%matrix_norm*inverse_norm
   end function condenser_condition

   !> The least condition number of a matrix whose pivots have shrunk to rounding errors: its norm is at least the
   !> diagonal entry, that of its inverse at least the inverse of the pivot.
   pure real(dp) function condenser_least_refused_condition(self) result(condition)
      class(condenser_t), intent(in) :: self !! the condenser

      condition = 1.0_dp/(epsilon(1.0_dp)*self%n)
   end function condenser_least_refused_condition

end module amontons_condenser
