!> The default method: Newton's method and, where it does not converge soon, other methods that find a better starting
!> point for it. What to try next is decided in this module alone. And the proximal path, a sequence of proximal steps,
!> each solved by Newton's method.
!>
!> Springs hold the points at the displacements of the last step and share the loads with the contact. With stiff
!> springs a step is a problem of nearly independent points, and the body moves by small steps. Springs become softer
!> after a step that is solved, and stiffer after one that is not. In the limit of vanishing steps the springs have no
!> effect. In a reduced problem springs in series with the points, strained by the difference to the last forces, do the
!> same to the forces.
module amontons_auto
   use amontons_contact_operator, only: contact_operator_t, new_softened_operator
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, effort_t, new_contact_solution
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_lemke, only: lemke_t
   use amontons_newton, only: newton_t, spring_start_t
   use amontons_psor, only: psor_t
   use amontons_splitting, only: splitting_t
   implicit none (type, external)
   private

   public :: auto_t, proximal_path_t

   !> The proximal path. Its iterations are Newton's steps.
   type, extends(contact_method_t) :: proximal_path_t
   contains
      procedure :: solve => proximal_path_solve
   end type proximal_path_t

   !> Numbers of steps of the first stages, and of the first stage of a reduced problem in space.
   integer, parameter :: n_first_steps = 20, n_first_in_space = 250, n_splitting_steps = 40

   !> Residual at which the splitting stops, and a stage counts as near the solution: Newton's steps do the rest [-].
   real(dp), parameter :: coarse = 1.0e-6_dp

   !> Newton's steps in a round. Semidefinite problems with strong friction need most of these, and sometimes more than
   !> one round.
   integer, parameter :: n_newton_steps = 100

   !> The default method.
   type, extends(contact_method_t) :: auto_t
   contains
      procedure :: solve => auto_solve
   end type auto_t

   !> The state of a sequence of methods: the best solution so far and the iterations left.
   type :: stages_t
      real(dp) :: tolerance = 0.0_dp !! residual that counts as solved [-]
      integer :: max_iterations = 0 !! most iterations of all together
      type(contact_solution_t) :: best !! the best pair so far
      type(effort_t) :: effort !! work of all methods
      real(dp), allocatable :: history(:) !! residual after each iteration [-]
      type(error_t), allocatable :: refusal !! why one of them could not begin, as without room for a dense matrix
   contains
      procedure :: is_done => stages_is_done
      procedure :: run => stages_run
   end type stages_t

contains

   !> Runs a few Newton steps from the start, and from rest if that is another point; on a band matrix the methods that
   !> move fronts; the splitting to a coarse tolerance, which comes close to the solution where friction is moderate.
   !> Then rounds of many Newton steps and of other methods. A reduced problem in space gets more first steps, since
   !> steps from rest that are broken off would have to be repeated: of 300 piles of rigid bodies all but six are solved
   !> within 250 of them.
   subroutine auto_solve(self, problem, solution, error)
      class(auto_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! not solved, and memory ran out for one of the methods
      ! The solution of another case is a good starting point only if Newton's steps from it soon reduce the residual.
      integer, parameter :: start_patience = 3
      real(dp), parameter :: start_decrease = 0.9_dp
      type(stages_t) :: stages

      stages%tolerance = self%tolerance
      stages%max_iterations = self%max_iterations
      stages%best = solution
      call stages%best%reset()
      allocate (stages%history(0))
      if (any(solution%force > 0.0_dp)) then
         call stages%run(newton_t(max_iterations=n_first_steps, patience=start_patience, decrease=start_decrease), &
            problem, solution)
      end if
      call new_contact_solution(solution, problem%n_points, problem%matrix%n_tangents)
      call stages%run(newton_t(max_iterations=merge(n_first_steps, n_first_in_space, &
         problem%matrix%n_tangents == 1 .or. problem%matrix%has_stiffness())), problem, solution)
      if (allocated(problem%matrix%band)) call newton_after_springs(stages, problem)
      if (suits_splitting(problem)) call stages%run(splitting_t(max_iterations=n_splitting_steps), problem, &
         tolerance=coarse)
      call alternate_methods(stages, problem)
      solution = stages%best
      solution%is_converged = solution%residual <= self%tolerance
      solution%history = stages%history
      solution%effort = stages%effort
      solution%n_iterations = size(stages%history)
      if (.not. solution%is_converged .and. allocated(stages%refusal)) call move_alloc(stages%refusal, error)
   end subroutine auto_solve

   !> Runs Newton's method from the solution with springs between points and obstacle; if that does not converge, from
   !> the best pair so far. For a band matrix: fronts of opening or sliding move along a contact line by a few points in
   !> each Newton step.
   subroutine newton_after_springs(stages, problem)
      type(stages_t), intent(inout) :: stages !! the stages so far
      type(contact_problem_t), intent(in) :: problem !! the problem, with a band matrix
      integer, parameter :: patience = 20
      real(dp), parameter :: decrease = 0.9_dp
      type(contact_solution_t) :: front, before

      before = stages%best
      front = before
      call stages%run(spring_start_t(max_iterations=n_newton_steps), problem, front)
      call stages%run(newton_t(max_iterations=n_newton_steps, patience=patience, decrease=decrease), problem, front)
      call stages%run(newton_t(max_iterations=stages%max_iterations, patience=patience), problem, before)
   end subroutine newton_after_springs

   !> Alternates many Newton steps with sweeps from the best pair so far, four times as many in each round, until the
   !> iterations are used up. Lemke's pivoting, where it is fast, is tried once, otherwise the splitting. Both start
   !> from rest, since nothing may lead on from the best pair. Where a line is too long for the sweeps, there is one
   !> round with each regularization, followed by Newton from rest without a limit: fronts that pass the edges of
   !> a profile one by one need many steps.
   subroutine alternate_methods(stages, problem)
      type(stages_t), intent(inout) :: stages !! the stages so far
      type(contact_problem_t), intent(in) :: problem !! the problem
      ! One path of Lemke's pivots takes some seconds on more points (0.2 s to 0.8 s at 300, 4 s at 700, 9 s to 13 s at
      ! 1000), about as long as the rounds that it saves. Longer lines have the splitting in its place.
      integer, parameter :: most_points = 1000, n_patient_steps = 400
      ! Where no number is finite, every round ends at once, but their size grows on.
      integer, parameter :: n_first_sweeps = 10, growth = 4, most_sweeps = 100000000
      real(dp), parameter :: max_regularizations(2) = [1.0_dp, 30.0_dp]
      type(contact_solution_t) :: rest
      integer :: n_sweeps, round

      n_sweeps = n_first_sweeps
      round = 0
      do while (.not. (stages%is_done() .or. is_long(problem) .and. round == size(max_regularizations)))
         round = round + 1
         call newton_then_path(stages, problem, max_regularizations(1 + modulo(round - 1, 2)))
         if (is_long(problem)) cycle
         if (round == 2 .and. problem%n_points <= most_points .and. problem%matrix%n_tangents == 1) then
            call stages%run(lemke_t(), problem)
         else if (round == 2 .and. suits_splitting(problem)) then
            call new_contact_solution(rest, problem%n_points, problem%matrix%n_tangents)
            call stages%run(splitting_t(max_iterations=n_patient_steps), problem, rest)
         else
            call stages%run(psor_t(max_iterations=n_sweeps, space='primal'), problem)
            n_sweeps = growth*min(n_sweeps, most_sweeps)
         end if
      end do
      ! Residuals near the tolerance are rounding errors, which no starting point avoids.
      if (stages%best%residual <= coarse) return
      call new_contact_solution(rest, problem%n_points, problem%matrix%n_tangents)
      call stages%run(newton_t(max_iterations=stages%max_iterations, max_regularization=maxval(max_regularizations)), &
         problem, rest)
   end subroutine alternate_methods

   !> Runs Newton's method with many steps from the best pair. If it stagnates, the proximal path follows from there; if
   !> that stagnates too, Newton's steps continue, since a front may need many. A reduced problem uses the path only in
   !> space, in place of Lemke's pivoting.
   subroutine newton_then_path(stages, problem, max_regularization)
      type(stages_t), intent(inout) :: stages !! the stages so far
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: max_regularization !! largest regularization of Newton's steps [-]
      integer, parameter :: patience = 15
      type(contact_solution_t) :: start, first
      integer :: n_end

      start = stages%best
      first = start
      n_end = size(stages%history) + n_newton_steps
      if (.not. problem%matrix%has_stiffness()) then
         call stages%run(newton_t(max_iterations=n_newton_steps, max_regularization=max_regularization), problem, first)
         if (problem%matrix%n_tangents == 1) return
         first = stages%best
         call stages%run(proximal_path_t(max_iterations=n_newton_steps), problem, first)
         return
      end if
      call stages%run(newton_t(max_iterations=n_newton_steps, max_regularization=max_regularization, &
         patience=patience), problem, first)
      first = start
      call stages%run(proximal_path_t(max_iterations=n_end - size(stages%history)), problem, first)
      call stages%run(newton_t(max_iterations=n_end - size(stages%history), max_regularization=max_regularization), &
         problem, start)
   end subroutine newton_then_path

   !> Whether the problem is solved or the iterations are used up.
   pure logical function stages_is_done(self) result(is_done)
      class(stages_t), intent(in) :: self !! the stages so far

      is_done = self%best%residual <= self%tolerance .or. size(self%history) >= self%max_iterations
   end function stages_is_done

   !> Runs one method, unless the problem is solved or no iterations are left, and appends its record.
   subroutine stages_run(self, method, problem, solution, tolerance)
      class(stages_t), intent(inout) :: self !! the stages so far
      class(contact_method_t), intent(in) :: method !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout), optional :: solution !! start and result; from the best pair if absent
      real(dp), intent(in), optional :: tolerance
         !! residual that is small enough for the method; that of all if absent [-]
      class(contact_method_t), allocatable :: limited
      type(contact_solution_t) :: found
      type(error_t), allocatable :: error

      if (self%is_done() .or. method%max_iterations < 1) return
      allocate (limited, source=method)
      limited%max_iterations = min(method%max_iterations, self%max_iterations - size(self%history))
      limited%tolerance = self%tolerance
      if (present(tolerance)) limited%tolerance = max(tolerance, self%tolerance)
      found = self%best
      if (present(solution)) found = solution
      call limited%solve(problem, found, error)
      if (allocated(error)) then
         if (.not. allocated(self%refusal)) call move_alloc(error, self%refusal)
         return
      end if
      self%history = [self%history, found%history(:found%n_iterations)]
      call self%effort%add(found%effort)
      if (found%residual < self%best%residual) self%best = found
      if (present(solution)) solution = found
   end subroutine stages_run

   !> Whether a line on a band matrix is too long for methods that need S as a dense matrix: they would take minutes and
   !> gigabytes.
   pure logical function is_long(problem)
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, parameter :: most_dense_points = 1500

      is_long = allocated(problem%matrix%band) .and. problem%n_points > most_dense_points
   end function is_long

   !> Whether the splitting is worth trying: not for a reduced problem with a sparse compliance, whose quadratic
   !> programs are large and, as in a pile of grains, mostly singular, so that each takes seconds.
   pure logical function suits_splitting(problem)
      type(contact_problem_t), intent(in) :: problem !! the problem

      suits_splitting = .not. is_long(problem)
      if (allocated(problem%matrix%compliance)) suits_splitting = suits_splitting .and. &
         .not. problem%matrix%compliance%is_sparse()
   end function suits_splitting

   !> Runs proximal steps from a starting point, and keeps the best pair.
   subroutine proximal_path_solve(self, problem, solution, error)
      class(proximal_path_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      ! Stiff springs make a step less useful than a large residual does. Solved steps take about three Newton steps.
      real(dp), parameter :: stiffest = 1.0e3_dp, first_factor = 10.0_dp
      integer, parameter :: steps_of_one = 6
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: step
      type(contact_solution_t) :: found, best
      type(newton_t) :: newton
      real(dp), dimension(problem%matrix%n) :: center, rho
      real(dp) :: share, factor
      integer :: i
      logical :: may_continue, is_dual
      ! Chosen on twenty-five bodies that Newton's steps alone do not solve.
      real(dp), parameter :: softest = 1.0e-14_dp, back = 10.0_dp, most = 100.0_dp, change = 1.5_dp
      integer, parameter :: few = 3

      call solution%reset()
      is_dual = .not. problem%matrix%has_stiffness()
      if (.not. is_dual) call problem%matrix%copy_stiffness(matrix, error)
      if (allocated(error)) return
      rho = problem%matrix%augmentation
      if (is_dual) call solution%measure(problem)
      best = solution
      found = solution
      center = merge(solution%force, solution%displacement, is_dual)
      share = 1.0_dp
      factor = first_factor
      may_continue = .true.
      do while (may_continue .and. solution%n_iterations < self%max_iterations .and. share <= stiffest)
         step = problem
         if (is_dual) then
            step%free_displacement = problem%free_displacement + share/rho*center
            call new_softened_operator(matrix, problem%matrix, share/rho)
            found%force = center
            found%displacement = problem%displacement(problem%dual_load(center), center)
         else
            call step%count_from(center)
            call matrix%set_springs(problem%matrix, share*rho)
            found%displacement = 0.0_dp
         end if
         step%matrix => matrix
         newton%tolerance = max(self%tolerance, min(coarse, share))
         newton%max_iterations = min(steps_of_one, self%max_iterations - solution%n_iterations)
         call newton%solve(step, found, error)
         if (allocated(error)) return
         call solution%effort%add(found%effort)
         ! The last iteration of a step that is solved is recorded with the pair that it leads to.
         do i = 1, found%n_iterations - merge(1, 0, found%is_converged)
            call solution%record_residual(max(found%history(i), merge(best%residual, 0.0_dp, is_dual)))
         end do
         if (found%is_converged) then
            share = max(softest, share/factor)
            if (found%n_iterations <= few) factor = min(most, change*factor)
         else
            share = back*share
            factor = change
         end if
         if (is_dual) then
            if (found%is_converged .or. found%residual <= coarse) center = found%force
            if (found%is_converged) call solution%record(problem, problem%displacement(problem%dual_load(center), &
               center), center, self%tolerance, may_continue)
            if (found%is_converged) call best%take_better(solution)
         else if (found%is_converged) then
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

end module amontons_auto
