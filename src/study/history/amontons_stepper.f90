!> One step of a load history: from the state at its beginning to the state at its end.
!>
!> The step is a contact problem whose slips count from the anchors: where the points were when it began, moved along
!> with the obstacle (backward Euler; section 10 of doc/theory.md). Nothing of the state before is changed, so that a
!> step can be given up and taken again with another length.
module amontons_stepper
   use amontons_body, only: body_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_friction_law, only: open_point, slip_minus
   use amontons_history_model, only: history_model_t, instant_t
   use amontons_kinds, only: dp
   use amontons_result, only: outcome_no_equilibrium, outcome_not_converged, outcome_numbers, outcome_solved
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: n_state_numbers, new_step_state, restore_step_state, step_state_t, take_step

   !> Numbers of a state that are kept besides those of its contact points.
   integer, parameter :: n_single = 6
   !> Numbers that are kept of each contact point.
   integer, parameter :: n_per_point = 9

   !> Where a step has led to.
   type :: step_state_t
      type(instant_t) :: instant !! what acts
      type(contact_solution_t) :: solution !! forces, displacements and statuses of the contact points
      real(dp), allocatable :: slip(:) !! slip of the step (m) [L]
      real(dp), allocatable :: accumulated_slip(:) !! sum of the |slip| of all steps (m) [L]
      real(dp), allocatable :: bound(:) !! slip bound g + phi lambda_N (m) [F]
      real(dp), allocatable :: dissipation(:) !! work that friction took at each point in all steps (m) [F L]
      real(dp), allocatable :: worn(:) !! normal force times |slip|, summed over all steps (m) [F L]
      real(dp), allocatable :: reaction(:)
         !! what the supports' reactions do on the displacements that each part prescribes (parts) [F L]
      real(dp) :: strain_energy = 0.0_dp !! strain energy of the body [F L]
      real(dp) :: load_work = 0.0_dp !! work of the loads in all steps [F L]
      real(dp) :: support_work = 0.0_dp !! work of the moving supports in all steps [F L]
      real(dp) :: obstacle_work = 0.0_dp !! work of the moving obstacles in all steps [F L]
      real(dp) :: step_dissipation = 0.0_dp !! work that friction took in the step [F L]
      real(dp) :: closing_loss = 0.0_dp !! sum of lambda_N times the gap at the beginning of the step [F L]
      real(dp) :: indicator = 0.0_dp !! energy error of the step over its energies [-]
      real(dp) :: imbalance = 0.0_dp !! violation of the two energy identities of the step over their terms [-]
      integer :: outcome = outcome_not_converged !! what came of the loads
      character(:), allocatable :: reason !! why there is no solution; empty for one, and for one not converged
   contains
      procedure :: energy_error => step_state_energy_error
      procedure :: numbers => step_state_numbers
      procedure :: slip_record => step_state_slip_record
   end type step_state_t

contains

   !> The state before the first step: unstressed, no load acts, and obstacles that the body overlaps just touch it.
   pure subroutine new_step_state(state, model, body)
      type(step_state_t), intent(out) :: state !! the state
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      integer :: m

      m = body%zone%n_points
      call new_contact_solution(state%solution, m)
      call model%solver%loads%at_rest(state%instant)
      state%instant%factor = 0.0_dp
      allocate (state%slip(m), state%accumulated_slip(m), state%dissipation(m), state%worn(m), source=0.0_dp)
      state%reaction = state%instant%factor
      state%instant%time = model%history%times(1)
      state%instant%gap = max(0.0_dp, state%instant%gap)
      state%bound = merge(0.0_dp, model%solver%loads%base%slip_bound, body%zone%is_tangent_fixed)
   end subroutine new_step_state

   !> Takes a step to what acts at its end. The state says what came of it.
   subroutine take_step(after, model, body, problem, before, instant)
      type(step_state_t), intent(out) :: after !! the state at the end of the step
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left with what acts
      type(step_state_t), intent(in) :: before !! the state at the beginning of the step
      type(instant_t), intent(in) :: instant !! what acts at its end
      integer :: m
      logical :: is_held, may_continue

      m = body%zone%n_points
      after%instant = instant
      after%instant%anchor = merge(0.0_dp, before%solution%displacement(m + 1:) + (instant%motion &
         - before%instant%motion), body%zone%is_tangent_fixed)
      call model%solver%loads%pose(body, after%instant, problem)
      after%solution = before%solution
      is_held = allocated(before%instant%numbers)
      if (is_held) is_held = .not. any(abs(instant%numbers - before%instant%numbers) > 0.0_dp)
      if (is_held) then
         ! Nothing moves. Points on a bound of the law would slip or stick as rounding has it: they stay what they are.
         call after%solution%reset()
         call after%solution%record(problem, before%solution%displacement, before%solution%force, &
            model%solver%method%tolerance, may_continue)
         is_held = after%solution%is_converged
      end if
      if (is_held) then
         after%solution%status = before%solution%status
         after%outcome = outcome_solved
         after%reason = ''
      else
         ! The slip before goes on, so that the method begins with the statuses before.
         after%solution%displacement(m + 1:) = after%instant%anchor + before%slip
         call model%solver%solve(body, after%instant, problem, after%solution, after%outcome, after%reason)
      end if
      if (any(after%outcome == [outcome_no_equilibrium, outcome_numbers])) return
      after%slip = after%solution%displacement(m + 1:) - after%instant%anchor
      after%accumulated_slip = before%accumulated_slip + abs(after%slip)
      call complete(after, model, problem)
      call add_works(after, model, problem, before)
   end subroutine take_step

   !> Gives a state what follows from its forces and displacements.
   pure subroutine complete(state, model, problem)
      type(step_state_t), intent(inout) :: state !! the state
      type(history_model_t), intent(in) :: model !! the model
      type(contact_problem_t), intent(in) :: problem !! the contact problem of its step

      associate (factor => state%instant%factor, v => state%solution%displacement, force => state%solution%force)
         state%bound = problem%bound(force(:problem%n_points))
         state%reaction = model%energies%reactions(factor, v, force)
         state%strain_energy = model%energies%strain_energy(problem, factor, v)
      end associate
   end subroutine complete

   !> How many numbers a state is restored from.
   pure integer function n_state_numbers(n_points)
      integer, intent(in) :: n_points !! number of contact points

      n_state_numbers = n_single + n_per_point*n_points
   end function n_state_numbers

   !> What a state must be restored from, the time first: all else follows.
   pure function step_state_numbers(self) result(numbers)
      class(step_state_t), intent(in) :: self !! the state
      real(dp), allocatable :: numbers(:)

      numbers = [self%instant%time, self%load_work, self%support_work, self%obstacle_work, self%solution%residual, &
         real([self%solution%n_iterations, self%solution%status], dp), self%solution%force, &
         self%solution%displacement, self%instant%anchor, self%accumulated_slip, self%dissipation, self%worn]
   end function step_state_numbers

   !> Restores a state from its numbers, to the last bit.
   subroutine restore_step_state(state, model, body, problem, numbers, instant, error)
      type(step_state_t), intent(out) :: state !! the state
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left with what acts
      real(dp), intent(in) :: numbers(:) !! the numbers
      type(instant_t), intent(in) :: instant !! what acted, at the time among the numbers
      type(error_t), allocatable, intent(out) :: error !! they are those of another body
      ! Of a bound, as far as forces that a method left or a file rounded reach it.
      real(dp), parameter :: nearly = 1.0_dp - 1.0e-6_dp
      integer :: m

      m = body%zone%n_points
      if (size(numbers) /= n_state_numbers(m)) then
         call new_error(error, input_refused, 'it is of '//to_text((size(numbers) - n_single)/n_per_point)// &
            ' contact points, the body has '//to_text(m))
         return
      end if
      state%instant = instant
      state%load_work = numbers(2)
      state%support_work = numbers(3)
      state%obstacle_work = numbers(4)
      call new_contact_solution(state%solution, m)
      associate (solution => state%solution, points => numbers(n_single + m + 1:))
         solution%residual = numbers(5)
         solution%n_iterations = nint(numbers(n_single))
         solution%history = spread(solution%residual, 1, solution%n_iterations)
         solution%is_converged = .true.
         solution%force = points(:2*m)
         solution%displacement = points(2*m + 1:4*m)
         state%instant%anchor = points(4*m + 1:5*m)
         state%slip = solution%displacement(m + 1:) - state%instant%anchor
         state%accumulated_slip = points(5*m + 1:6*m)
         state%dissipation = points(6*m + 1:7*m)
         state%worn = points(7*m + 1:)
      end associate
      call model%solver%loads%pose(body, state%instant, problem)
      state%outcome = outcome_solved
      state%solution%status = problem%status(state%solution%displacement, state%solution%force)
      ! On a bound of the law, where a held point stays what it was, forces do not tell.
      associate (force => state%solution%force, status => numbers(n_single + 1:n_single + m))
         where (abs(force(m + 1:)) >= nearly*problem%bound(force(:m))) state%solution%status = &
            nint(max(real(open_point, dp), min(real(slip_minus, dp), status)))
      end associate
      call complete(state, model, problem)
   end subroutine restore_step_state

   !> Adds works and dissipation of a step, and measures how well its energies balance.
   !>
   !> Over a step the loads do the mean of their work at both ends (they lie on a ramp), and friction takes the mean of
   !> both bounds times the slip, which is right under reversal, too, where the force jumps but the bound does not.
   pure subroutine add_works(after, model, problem, before)
      type(step_state_t), intent(inout) :: after !! the state; gains works and dissipation
      type(history_model_t), intent(in) :: model !! the model
      type(contact_problem_t), intent(in) :: problem !! the contact problem of the step
      type(step_state_t), intent(in) :: before !! the state before it
      ! Of sums of some hundred products that cancel each other.
      real(dp), parameter :: rounding = 1.0e-13_dp
      real(dp), dimension(problem%n_points) :: approach, taken, missing
      real(dp), dimension(2*problem%n_points) :: mean_force, v_change
      real(dp), dimension(size(after%reaction)) :: change
      real(dp) :: load_work, support_work, obstacle_work, energies
      integer :: m

      m = problem%n_points
      change = after%instant%factor - before%instant%factor
      v_change = after%solution%displacement - before%solution%displacement
      mean_force = 0.5_dp*(after%solution%force + before%solution%force)
      load_work = model%energies%load_work(0.5_dp*(after%instant%factor + before%instant%factor), change, v_change)
      support_work = dot_product(0.5_dp*(after%reaction + before%reaction), change)
      ! An obstacle that a point loses, or meets, does nothing on the way that the gap jumps.
      approach = merge(after%instant%gap - before%instant%gap, 0.0_dp, &
         after%instant%is_in_reach .and. before%instant%is_in_reach)
      obstacle_work = -dot_product(mean_force, [approach, after%instant%motion - before%instant%motion])
      taken = 0.5_dp*(after%bound + before%bound)*abs(after%slip)
      approach = approach - matmul(model%energies%prescribed(:m, :), change) - v_change(:m)
      ! What is left of the contact work: the points' shares of the energy error.
      missing = mean_force(m + 1:)*after%slip - taken - mean_force(:m)*approach
      after%step_dissipation = sum(taken)
      after%dissipation = before%dissipation + taken
      after%worn = before%worn + mean_force(:m)*abs(after%slip)
      after%load_work = before%load_work + load_work
      after%support_work = before%support_work + support_work
      after%obstacle_work = before%obstacle_work + obstacle_work
      after%closing_loss = dot_product(after%solution%force(:m), merge(before%instant%gap, 0.0_dp, &
         before%instant%is_in_reach) - matmul(model%energies%prescribed(:m, :), before%instant%factor) &
         - before%solution%displacement(:m))
      ! Of a body that moves as a whole: measured by the energy that single points would have that move as far.
      energies = max(rounding*maxval([problem%augmentation(), 0.0_dp])*max(0.0_dp, &
         maxval(abs(after%solution%displacement)), problem%prescribed)**2, after%step_dissipation, &
         abs(after%strain_energy - before%strain_energy), abs(load_work + support_work + obstacle_work))
      if (energies > 0.0_dp) after%indicator = sum(abs(missing))/energies
      call check_identities(after, model, problem, before, change, v_change, mean_force, load_work + support_work)
   end subroutine add_works

   !> Checks the two identities that hold exactly for a step in equilibrium at both ends: the work of loads, supports,
   !> by their means over the step, is the change of strain energy and the mean contact forces' work; by their values at
   !> the end, it is that and the strain energy of the step's own displacements more.
   pure subroutine check_identities(after, model, problem, before, change, v_change, mean_force, mean_work)
      type(step_state_t), intent(inout) :: after !! the state; gains the violation
      type(history_model_t), intent(in) :: model !! the model
      type(contact_problem_t), intent(in) :: problem !! the contact problem of the step
      type(step_state_t), intent(in) :: before !! the state before it
      real(dp), intent(in) :: change(:) !! by how much the factors changed (parts) [-]
      real(dp), contiguous, intent(in) :: v_change(:) !! by how much the contact displacements changed (2m) [L]
      real(dp), intent(in) :: mean_force(:) !! mean contact forces (2m) [F]
      real(dp), intent(in) :: mean_work !! work of loads and supports by their means [F L]
      ! What rounding leaves of energies that cancel each other is negligible in this share of them. Of a body that
      ! moves as a whole they are those of single nodes that do: the elements of a slender body are far stiffer than
      ! its contact points.
      real(dp), parameter :: rounding_share = 1.0e-5_dp
      real(dp), dimension(2*problem%n_points) :: whole_change
      real(dp) :: end_work, own_energy, energy_change, size_of_terms

      ! The normal displacements of the contact problem lack what supports prescribe; the tangential ones are whole.
      whole_change = v_change
      associate (m => problem%n_points)
         whole_change(:m) = whole_change(:m) + matmul(model%energies%prescribed(:m, :), change)
      end associate
      energy_change = after%strain_energy - before%strain_energy
      own_energy = model%energies%strain_energy(problem, change, v_change)
      end_work = model%energies%load_work(after%instant%factor, change, v_change) &
         + dot_product(after%reaction, change)
      size_of_terms = max(after%strain_energy, before%strain_energy, abs(mean_work), abs(end_work), &
         dot_product(abs(after%solution%force), abs(whole_change)), rounding_share*model%energies%stiffness &
         *max(sum(after%solution%displacement**2), problem%prescribed**2))
      if (.not. size_of_terms > 0.0_dp) return
      after%imbalance = max(abs(mean_work - energy_change - dot_product(mean_force, whole_change)), &
         abs(end_work - energy_change - own_energy - dot_product(after%solution%force, whole_change)))/size_of_terms
   end subroutine check_identities

   !> Slip of the step, accumulated slip [L], dissipation [F L], and what wear is proportional to after Archard: the
   !> integral of the pressure over the slip [F/L] (m, 4).
   pure function step_state_slip_record(self, body) result(record)
      class(step_state_t), intent(in) :: self !! the state
      type(body_t), intent(in) :: body !! the body
      real(dp), allocatable :: record(:, :)

      record = reshape([self%slip, self%accumulated_slip, self%dissipation, self%worn/body%zone%area], &
         [size(self%slip), 4])
   end function step_state_slip_record

   !> What is left of all works but strain energy and dissipation: the error of the steps' size [F L].
   pure real(dp) function step_state_energy_error(self) result(energy_error)
      class(step_state_t), intent(in) :: self !! the state

      energy_error = self%load_work + self%support_work + self%obstacle_work - self%strain_energy &
         - sum(self%dissipation)
   end function step_state_energy_error

end module amontons_stepper
