!> The default method: the paper's splitting until the statuses are nearly right, then Newton to the last digit.
module amontons_auto
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_newton, only: newton_t
   use amontons_psor, only: psor_t
   use amontons_splitting, only: splitting_t
   implicit none (type, external)
   private

   public :: auto_t

   !> The default method.
   type, extends(contact_method_t) :: auto_t
   contains
      procedure :: solve => auto_solve
   end type auto_t

contains

   !> Splitting to a coarse tolerance, then Newton; while Newton fails, splitting to a finer one; at last sweeps in the
   !> displacements, which converge where nothing else does.
   subroutine auto_solve(self, problem, solution, error)
      class(auto_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(inout) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite
      real(dp), parameter :: coarse(3) = [1.0e-6_dp, 1.0e-8_dp, 0.0_dp]
      ! Where the splitting converges at all, a few dozen steps are enough; Newton needs fewer.
      integer, parameter :: n_splitting_steps = 100, n_newton_steps = 20
      type(contact_solution_t) :: best
      real(dp), allocatable :: history(:)
      integer :: i

      best = solution
      call best%begin()
      allocate (history(0))
      do i = 1, size(coarse)
         call run(splitting_t(max(coarse(i), self%tolerance), n_splitting_steps))
         if (allocated(error)) return
         call run(newton_t(self%tolerance, n_newton_steps))
         if (allocated(error) .or. best%residual <= self%tolerance) exit
      end do
      if (best%residual > self%tolerance) call run(psor_t(self%tolerance, self%max_iterations, space='primal'))
      solution = best
      solution%is_converged = solution%residual <= self%tolerance
      solution%history = history
      solution%n_iterations = size(history)

   contains

      !> Runs one method from the best pair so far, as far as iterations are left, and appends its record.
      subroutine run(method)
         class(contact_method_t), intent(in) :: method !! the method
         class(contact_method_t), allocatable :: limited

         allocate (limited, source=method)
         limited%max_iterations = min(method%max_iterations, self%max_iterations - size(history))
         if (limited%max_iterations < 1) return
         solution%force = best%force
         solution%displacement = best%displacement
         call limited%solve(problem, solution, error)
         if (allocated(error)) return
         history = [history, solution%history(:solution%n_iterations)]
         if (solution%residual < best%residual) best = solution
      end subroutine run

   end subroutine auto_solve

end module amontons_auto
