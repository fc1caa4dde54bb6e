!> A way to the solution of a contact problem in proximal steps, each of them solved by a method of its own.
!>
!> Springs hold the points to where the last step led, and share the loads with the contact. With stiff springs a
!> step is a problem of nearly independent points, which any method solves; the body creeps. Springs become softer
!> where steps are solved, and stiffer where one is not. Where steps vanish, springs have no effect.
module amontons_proximal_path
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_operator, only: contact_operator_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: finish, follow_proximal_path

contains

   !> Takes proximal steps from where a solution is.
   recursive subroutine follow_proximal_path(method, problem, max_iterations, solution, error, last)
      class(contact_method_t), intent(in) :: method !! the method that solves each step, its iterations limited
      type(contact_problem_t), intent(in) :: problem !! the problem, with a stiffness
      integer, intent(in) :: max_iterations !! most iterations of all steps
      type(contact_solution_t), intent(inout) :: solution !! where to begin, and the result
      type(error_t), allocatable, intent(out) :: error !! what the method refuses
      class(contact_method_t), intent(in), optional :: last
         !! the method that takes the last steps, without springs, its iterations limited
      ! Stiff springs spoil a step more than its residual does.
      real(dp), parameter :: stiffest = 1.0e3_dp, coarse = 1.0e-6_dp, first_factor = 10.0_dp
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: step
      type(contact_solution_t) :: found, best
      class(contact_method_t), allocatable :: limited
      real(dp), dimension(2*problem%n_points) :: center, rho
      real(dp) :: share, factor
      logical :: may_continue

      allocate (limited, source=method)
      call problem%matrix%copy_stiffness(matrix, error)
      if (allocated(error)) return
      rho = problem%augmentation()
      call solution%reset()
      best = solution
      found = solution
      center = solution%displacement
      share = 1.0_dp
      factor = first_factor
      may_continue = .true.
      do while (may_continue .and. solution%n_iterations < max_iterations .and. share <= stiffest)
         step = problem
         call step%count_from(center)
         call matrix%set_springs(problem%matrix, share*rho)
         step%matrix => matrix
         limited%tolerance = max(method%tolerance, min(coarse, share))
         limited%max_iterations = min(method%max_iterations, max_iterations - solution%n_iterations)
         found%displacement = 0.0_dp
         call limited%solve(step, found, error)
         if (allocated(error)) return
         call append(solution, found)
         call change_springs(share, factor, found%is_converged, found%n_iterations)
         if (found%is_converged) then
            center = center + found%displacement
            call solution%record(problem, center, found%force, method%tolerance, may_continue)
            call best%take_better(solution)
            if (may_continue) call finish(problem, max_iterations, solution, error, last)
            if (solution%is_converged) exit
         else if (found%residual <= coarse) then
            center = center + found%displacement
         else
            found%force = solution%force
         end if
      end do
      call solution%take_better(best)
   end subroutine follow_proximal_path

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

   !> Goes on from a solution that is close by a method that may find it, if there is one and room for its iterations;
   !> keeps the pair otherwise, with the record of both.
   recursive subroutine finish(problem, max_iterations, solution, error, method)
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: max_iterations !! most iterations of both
      type(contact_solution_t), intent(inout) :: solution !! where to begin, and the result
      type(error_t), allocatable, intent(out) :: error !! what the method refuses
      class(contact_method_t), intent(in), optional :: method !! the method, its iterations limited
      ! Statuses are then mostly right.
      real(dp), parameter :: close_by = 1.0e-4_dp
      type(contact_solution_t) :: first

      if (.not. present(method) .or. solution%residual > close_by) return
      if (solution%n_iterations + method%max_iterations > max_iterations) return
      first = solution
      call method%solve(problem, solution, error)
      call solution%follow(first)
      call solution%take_better(first)
   end subroutine finish

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
