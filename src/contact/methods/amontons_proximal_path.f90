!> A way to the solution of a contact problem in proximal steps, each of them solved by Newton's method.
!>
!> Springs hold the points to where the last step led, and share the loads with the contact. With stiff springs a
!> step is a problem of nearly independent points; the body creeps. Springs become softer where steps are solved, and
!> stiffer where one is not. Where steps vanish, springs have no effect.
module amontons_proximal_path
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_operator, only: contact_operator_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_newton, only: newton_t
   implicit none (type, external)
   private

   public :: proximal_path_t

   !> The proximal path. Its iterations are Newton's steps.
   type, extends(contact_method_t) :: proximal_path_t
   contains
      procedure :: solve => proximal_path_solve
   end type proximal_path_t

contains

   !> Takes proximal steps from where a solution is, and keeps the best pair.
   subroutine proximal_path_solve(self, problem, solution, error)
      class(proximal_path_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, with a stiffness
      type(contact_solution_t), intent(inout) :: solution !! where to begin, and the result
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      ! Stiff springs spoil a step more than its residual does. Steps that are solved take about three of Newton's.
      real(dp), parameter :: stiffest = 1.0e3_dp, coarse = 1.0e-6_dp, first_factor = 10.0_dp
      integer, parameter :: steps_of_one = 6
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: step
      type(contact_solution_t) :: found, best
      type(newton_t) :: newton
      real(dp), dimension(2*problem%n_points) :: center, rho
      real(dp) :: share, factor
      integer :: i
      logical :: may_continue

      call solution%reset()
      call problem%matrix%copy_stiffness(matrix, error)
      if (allocated(error)) return
      rho = problem%augmentation()
      best = solution
      found = solution
      center = solution%displacement
      share = 1.0_dp
      factor = first_factor
      may_continue = .true.
      do while (may_continue .and. solution%n_iterations < self%max_iterations .and. share <= stiffest)
         step = problem
         call step%count_from(center)
         call matrix%set_springs(problem%matrix, share*rho)
         step%matrix => matrix
         newton%tolerance = max(self%tolerance, min(coarse, share))
         newton%max_iterations = min(steps_of_one, self%max_iterations - solution%n_iterations)
         found%displacement = 0.0_dp
         call newton%solve(step, found, error)
         if (allocated(error)) return
         call solution%effort%add(found%effort)
         ! The last iteration of a step that is solved is recorded with the pair that it leads to.
         do i = 1, found%n_iterations - merge(1, 0, found%is_converged)
            call solution%record_residual(found%history(i))
         end do
         call change_springs(share, factor, found%is_converged, found%n_iterations)
         if (found%is_converged) then
            center = center + found%displacement
            call solution%record(problem, center, found%force, self%tolerance, may_continue)
            call best%take_better(solution)
         else if (found%residual <= coarse) then
            center = center + found%displacement
         else
            found%force = solution%force
         end if
      end do
      call solution%take_better(best)
   end subroutine proximal_path_solve

   !> Makes the springs of the next step softer, or stiffer after one that is not solved.
   pure subroutine change_springs(share, factor, is_solved, n_iterations)
      real(dp), intent(inout) :: share !! their stiffness over the diagonal of S [-]
      real(dp), intent(inout) :: factor !! quotient of springs that follow each other [-]
      logical, intent(in) :: is_solved !! whether the step is solved
      integer, intent(in) :: n_iterations !! iterations that it took
      ! Chosen on twenty-five bodies that Newton's steps alone do not solve.
      real(dp), parameter :: softest = 1.0e-14_dp, back = 10.0_dp, most = 100.0_dp, change = 1.5_dp
      integer, parameter :: few = 3

      if (is_solved) then
         share = max(softest, share/factor)
         if (n_iterations <= few) factor = min(most, change*factor)
      else
         share = back*share
         factor = change
      end if
   end subroutine change_springs

end module amontons_proximal_path
