!> A way to the solution of a contact problem in proximal steps, each of them solved by a method of its own.
!>
!> Springs hold the points to where the last step led, and share the loads with the contact. With stiff springs a
!> step is a problem of nearly independent points, which any method solves; the body creeps. Springs become softer
!> where steps are solved, and stiffer where one is not. Where steps vanish, springs have no effect.
module amontons_proximal_path
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: follow_proximal_path

contains

   !> Takes proximal steps from where a solution is.
   recursive subroutine follow_proximal_path(method, problem, max_iterations, solution, error)
      class(contact_method_t), intent(in) :: method !! the method that solves each step, its iterations limited
      type(contact_problem_t), intent(in) :: problem !! the problem, with a stiffness
      integer, intent(in) :: max_iterations !! most iterations of all steps
      type(contact_solution_t), intent(inout) :: solution !! where to begin, and the result
      type(error_t), allocatable, intent(out) :: error !! what the method refuses
      real(dp), parameter :: stiffest = 1.0e3_dp, softest = 1.0e-14_dp
      ! Quotients of the stiffness of springs that follow each other, and what changes them. Chosen, as the iterations
      ! of a step are, for few iterations on twenty-five bodies that Newton's steps alone do not solve.
      real(dp), parameter :: usual = 10.0_dp, most = 100.0_dp, change = 1.5_dp
      integer, parameter :: few = 3
      ! Stiff springs spoil a step more than its residual does.
      real(dp), parameter :: coarse = 1.0e-6_dp
      type(contact_problem_t) :: step
      type(contact_solution_t) :: found, best
      class(contact_method_t), allocatable :: limited
      real(dp), dimension(2*problem%n_points) :: center, rho
      real(dp) :: share, factor
      logical :: may_continue

      allocate (limited, source=method)
      rho = problem%augmentation()
      call solution%reset()
      best = solution
      found = solution
      center = solution%displacement
      share = 1.0_dp
      factor = usual
      may_continue = .true.
      do while (may_continue .and. solution%n_iterations < max_iterations .and. share <= stiffest)
         step = problem
         call step%add_springs(share*rho, center)
         limited%tolerance = max(method%tolerance, min(coarse, share))
         limited%max_iterations = min(method%max_iterations, max_iterations - solution%n_iterations)
         call limited%solve(step, found, error)
         if (allocated(error)) return
         call append(solution, found)
         if (found%is_converged) then
            center = found%displacement
            call solution%record(problem, found%displacement, found%force, method%tolerance, may_continue)
            if (solution%residual < best%residual) best = solution
            share = max(softest, share/factor)
            if (found%n_iterations <= few) factor = min(most, change*factor)
         else
            factor = change
            share = usual*share
            found%displacement = center
            found%force = solution%force
         end if
      end do
      if (.not. solution%is_converged) call solution%take_pair(best)
   end subroutine follow_proximal_path

   !> Adds the record of a step, but for its last iteration where the pair that this leads to is recorded next.
   pure subroutine append(solution, found)
      type(contact_solution_t), intent(inout) :: solution !! gains the record
      type(contact_solution_t), intent(in) :: found !! solution of the step
      integer :: i

      call solution%effort%add(found%effort)
      do i = 1, found%n_iterations - merge(1, 0, found%is_converged)
         call solution%record_residual(found%history(i))
      end do
   end subroutine append

end module amontons_proximal_path
