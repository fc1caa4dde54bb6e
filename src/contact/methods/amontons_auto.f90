!> The default method: Newton, and where it does not arrive soon, other methods to a better start for Newton.
module amontons_auto
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_effort, only: effort_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_lemke, only: lemke_t
   use amontons_newton, only: newton_t
   use amontons_psor, only: psor_t
   use amontons_splitting, only: splitting_t
   implicit none (type, external)
   private

   public :: auto_t

   !> Where fronts advance along a contact line each step is a little better than the one before.
   integer, parameter :: front_stagnation_limit = 20
   real(dp), parameter :: slow_decrease = 0.999_dp
   !> A longer contact line on a band matrix has no dense S: it would take minutes, and gigabytes.
   integer, parameter :: most_dense_points = 1500
   !> Steps of the first stages, and the residual that ends the splitting.
   integer, parameter :: n_first_steps = 20, n_splitting_steps = 40
   !> Another case's solution is a start worth keeping only if Newton's steps from it soon lead on.
   integer, parameter :: stagnation_limit = 3
   real(dp), parameter :: coarse = 1.0e-6_dp
   !> Semidefinite problems with strong friction take most of these steps, and sometimes more than one round of them.
   integer, parameter :: n_newton_steps = 100, n_first_sweeps = 10, growth = 4
   !> Where no number is finite, every round ends at once, but their size grows on.
   integer, parameter :: most_sweeps = 100000000
   !> One path of Lemke's pivots then takes some seconds (0.2 s to 0.8 s at 300 points, 4 s at 700, 9 s to 13 s at
   !> 1000), about as long as the rounds that it saves. Longer lines have the splitting in its place.
   integer, parameter :: most_points = 1000, n_patient_steps = 400
   !> Bounds of Newton's regularization: more ends cycles of its active sets, but is slow where there are none.
   real(dp), parameter :: max_regularizations(2) = [1.0_dp, 30.0_dp]

   !> The default method.
   type, extends(contact_method_t) :: auto_t
   contains
      procedure :: solve => auto_solve
   end type auto_t

   !> What methods that follow each other have come to.
   type :: stages_t
      real(dp) :: tolerance = 0.0_dp !! residual that counts as solved [-]
      integer :: max_iterations = 0 !! most iterations of all together
      type(contact_solution_t) :: best !! the best pair so far
      type(effort_t) :: effort !! what all took
      real(dp), allocatable :: history(:) !! residual after each iteration [-]
   contains
      procedure :: is_done => stages_is_done
      procedure :: run => stages_run
   end type stages_t

contains

   !> A few steps of Newton from the start, and from rest if that is another one; on a band matrix, whatever lets fronts
   !> pass; the splitting to a coarse tolerance, which gets close where friction is moderate. Then rounds of Newton at
   !> length and of other methods.
   subroutine auto_solve(self, problem, solution, error)
      class(auto_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! never allocated; kept for the common interface
      type(stages_t) :: stages

      stages%tolerance = self%tolerance
      stages%max_iterations = self%max_iterations
      stages%best = solution
      call stages%best%reset()
      allocate (stages%history(0))
      if (any(solution%force > 0.0_dp)) then
         call stages%run(newton_t(tolerance=self%tolerance, max_iterations=n_first_steps, &
            stagnation_limit=stagnation_limit, patience=huge(1)), problem, solution, error)
      end if
      call new_contact_solution(solution, problem%n_points)
      call stages%run(newton_t(tolerance=self%tolerance, max_iterations=n_first_steps, patience=huge(1)), problem, &
         solution, error)
      if (allocated(problem%matrix%band)) call follow_fronts(stages, problem, solution, error)
      solution = stages%best
      if (suits_splitting(problem)) then
         call stages%run(splitting_t(tolerance=max(coarse, self%tolerance), max_iterations=n_splitting_steps), &
            problem, solution, error)
      end if
      call take_rounds(stages, problem, solution, error)
      solution = stages%best
      solution%is_converged = solution%residual <= self%tolerance
      solution%history = stages%history
      solution%effort = stages%effort
      solution%n_iterations = size(stages%history)
   end subroutine auto_solve

   !> Newton from where springs lead; and if they mislead, from where it was, as long as it gets on.
   subroutine follow_fronts(stages, problem, solution, error)
      type(stages_t), intent(inout) :: stages !! the stages so far
      type(contact_problem_t), intent(in) :: problem !! the problem, with a band matrix
      type(contact_solution_t), intent(inout) :: solution !! the last pair
      type(error_t), allocatable, intent(out) :: error !! never allocated
      type(contact_solution_t) :: front

      front = stages%best
      call stages%run(newton_t(tolerance=stages%tolerance, max_iterations=n_newton_steps, &
         stagnation_limit=front_stagnation_limit, starts_with_springs=.true., patience=huge(1)), problem, solution, &
         error)
      solution = front
      call stages%run(newton_t(tolerance=stages%tolerance, max_iterations=stages%max_iterations, &
         stagnation_limit=front_stagnation_limit, decrease=slow_decrease, patience=huge(1)), problem, solution, &
         error)
   end subroutine follow_fronts

   !> Until the iterations are used up, Newton at length and sweeps from the best pair so far, each time four times as
   !> many as before. Lemke's pivoting, where it is quick, has its turn once, else the splitting at length. Where a line
   !> is too long for the sweeps, one round with each regularization.
   subroutine take_rounds(stages, problem, solution, error)
      type(stages_t), intent(inout) :: stages !! the stages so far
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! the last pair
      type(error_t), allocatable, intent(out) :: error !! never allocated
      integer :: n_sweeps, round

      n_sweeps = n_first_sweeps
      round = 0
      do while (.not. (stages%is_done() .or. is_long(problem) .and. round == size(max_regularizations)))
         round = round + 1
         call stages%run(newton_t(tolerance=stages%tolerance, max_iterations=n_newton_steps, &
            max_regularization=max_regularizations(1 + modulo(round - 1, 2))), problem, solution, error)
         if (round == 2 .and. problem%n_points <= most_points) then
            call stages%run(lemke_t(tolerance=stages%tolerance), problem, solution, error)
            cycle
         end if
         solution = stages%best
         if (is_long(problem)) cycle
         if (round == 2 .and. suits_splitting(problem)) then
            call stages%run(splitting_t(tolerance=stages%tolerance, max_iterations=n_patient_steps, &
               patience=huge(1)), problem, solution, error)
            cycle
         end if
         call stages%run(psor_t(tolerance=stages%tolerance, max_iterations=n_sweeps, &
            space=merge('dual  ', 'primal', .not. problem%matrix%has_stiffness())), problem, solution, error)
         n_sweeps = growth*min(n_sweeps, most_sweeps)
      end do
   end subroutine take_rounds

   !> Whether the problem is solved or the iterations are used up.
   pure logical function stages_is_done(self) result(is_done)
      class(stages_t), intent(in) :: self !! the stages so far

      is_done = self%best%residual <= self%tolerance .or. size(self%history) >= self%max_iterations
   end function stages_is_done

   !> Runs one method from a solution, as far as there is need and iterations are left, and appends its record.
   subroutine stages_run(self, method, problem, solution, error)
      class(stages_t), intent(inout) :: self !! the stages so far
      class(contact_method_t), intent(in) :: method !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! never allocated
      class(contact_method_t), allocatable :: limited

      if (self%is_done()) return
      allocate (limited, source=method)
      limited%max_iterations = min(method%max_iterations, self%max_iterations - size(self%history))
      call limited%solve(problem, solution, error)
      self%history = [self%history, solution%history(:solution%n_iterations)]
      call self%effort%add(solution%effort)
      if (solution%residual < self%best%residual) self%best = solution
   end subroutine stages_run

   !> Whether a problem is one of a line too long for the methods that need S as a dense matrix.
   pure logical function is_long(problem)
      type(contact_problem_t), intent(in) :: problem !! the problem

      is_long = allocated(problem%matrix%band) .and. problem%n_points > most_dense_points
   end function is_long

   !> Whether the splitting may lead on: not for a reduced problem with a sparse compliance, whose quadratic programs
   !> are large and, as in a pile of grains, mostly singular, so that each takes seconds.
   pure logical function suits_splitting(problem)
      type(contact_problem_t), intent(in) :: problem !! the problem

      suits_splitting = .not. is_long(problem)
      if (.not. problem%matrix%has_stiffness()) suits_splitting = .not. problem%matrix%compliance%is_sparse()
   end function suits_splitting

end module amontons_auto
