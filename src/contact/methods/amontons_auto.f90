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
   integer, parameter :: front_patience = 20
   real(dp), parameter :: still_better = 0.999_dp
   !> A longer contact line on a band matrix has no dense S: it would take minutes, and gigabytes.
   integer, parameter :: most_dense_points = 1500
   !> Steps of the first stages, and the residual that ends the splitting.
   integer, parameter :: n_first_steps = 20, n_splitting_steps = 40
   !> Another case's solution is a start worth keeping only if Newton's steps from it soon lead on.
   integer, parameter :: patience = 3
   real(dp), parameter :: coarse = 1.0e-6_dp
   !> Semidefinite problems with strong friction take most of these steps, and sometimes more than one round of them.
   integer, parameter :: n_newton_steps = 100, n_first_sweeps = 10, growth = 4
   !> Where no number is finite, every round ends at once, but their size grows on.
   integer, parameter :: most_sweeps = 100000000
   !> One path of Lemke's pivots then takes up to a second (0.2 s to 0.8 s measured at 200 to 300 points).
   integer, parameter :: most_points = 300
   !> Shares of the diagonal: more ends cycles of Newton's guesses, but is slow where there are none.
   real(dp), parameter :: most_shares(2) = [1.0_dp, 30.0_dp]

   !> The default method.
   type, extends(contact_method_t) :: auto_t
   contains
      procedure :: solve => auto_solve
   end type auto_t

contains

   !> A few steps of Newton from the start, and from rest if that is another one; the splitting to a coarse tolerance,
   !> which gets close where friction is moderate. Then, until the iterations are used up, Newton at length and sweeps
   !> from the best pair so far, each time four times as many as before. Lemke's pivoting, where it is quick, has its
   !> turn once.
   subroutine auto_solve(self, problem, solution, error)
      class(auto_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(inout) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! never allocated; kept for the common interface
      type(contact_solution_t) :: best, front
      type(effort_t) :: effort
      real(dp), allocatable :: history(:)
      integer :: n_sweeps, round

      best = solution
      call best%begin()
      allocate (history(0))
      if (any(solution%force > 0.0_dp)) call run(newton_t(self%tolerance, n_first_steps, patience=patience))
      call new_contact_solution(solution, problem%n_points)
      call run(newton_t(self%tolerance, n_first_steps))
      if (allocated(problem%band)) then
         front = best
         call run(newton_t(self%tolerance, n_newton_steps, patience=front_patience, begins_softly=.true.))
         solution = front
         call run(newton_t(self%tolerance, self%max_iterations, patience=front_patience, better=still_better))
      end if
      solution = best
      if (suits_splitting(problem)) call run(splitting_t(max(coarse, self%tolerance), n_splitting_steps))
      n_sweeps = n_first_sweeps
      round = 0
      do while (.not. is_done())
         round = round + 1
         call run(newton_t(self%tolerance, n_newton_steps, most_shares(1 + modulo(round - 1, 2))))
         if (round == 2 .and. problem%n_points <= most_points) then
            call run(lemke_t(self%tolerance))
            cycle
         end if
         solution = best
         if (is_long(problem)) then
            if (round == size(most_shares)) exit
            cycle
         end if
         call run(psor_t(self%tolerance, n_sweeps, space=merge('dual  ', 'primal', problem%is_reduced())))
         n_sweeps = growth*min(n_sweeps, most_sweeps)
      end do
      solution = best
      solution%is_converged = solution%residual <= self%tolerance
      solution%history = history
      solution%effort = effort
      solution%n_iterations = size(history)

   contains

      !> Whether the problem is solved or the iterations are used up.
      pure logical function is_done()
         is_done = best%residual <= self%tolerance .or. size(history) >= self%max_iterations
      end function is_done

      !> Runs one method from the present solution, as far as there is need and iterations are left, and appends its
      !> record.
      subroutine run(method)
         class(contact_method_t), intent(in) :: method !! the method
         class(contact_method_t), allocatable :: limited

         if (is_done()) return
         allocate (limited, source=method)
         limited%max_iterations = min(method%max_iterations, self%max_iterations - size(history))
         call limited%solve(problem, solution, error)
         history = [history, solution%history(:solution%n_iterations)]
         call effort%add(solution%effort)
         if (solution%residual < best%residual) best = solution
      end subroutine run

   end subroutine auto_solve

   !> Whether a problem is one of a line too long for the methods that need S as a dense matrix.
   pure logical function is_long(problem)
      type(contact_problem_t), intent(in) :: problem !! the problem

      is_long = allocated(problem%band) .and. problem%n_points > most_dense_points
   end function is_long

   !> Whether the splitting may lead on: not for a reduced problem with a sparse compliance, whose quadratic programs are
   !> large and, as in a pile of grains, mostly singular, so that each takes seconds.
   pure logical function suits_splitting(problem)
      type(contact_problem_t), intent(in) :: problem !! the problem

      suits_splitting = .not. is_long(problem)
      if (problem%is_reduced()) suits_splitting = .not. problem%compliance%is_sparse()
   end function suits_splitting

end module amontons_auto
