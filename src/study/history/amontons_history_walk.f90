!> The way through a history: step after step, halved where a step does not converge or its energies do not balance.
!>
!> The way from one of the planned times to the next is divided by halves, so that a step always begins and ends at a
!> multiple of its own length. What decides is computed numbers alone, rounded so that their last digits have no say:
!> the steps are the same on every machine.
module amontons_history_walk
   use amontons_body, only: body_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_cycle_watch, only: cycle_watch_t, n_parameters, new_cycle_watch
   use amontons_error, only: error_t, input_refused, new_error, numerical_failure
   use amontons_history, only: history_t
   use amontons_history_model, only: history_model_t, instant_t
   use amontons_kinds, only: dp
   use amontons_result, only: outcome_no_equilibrium, outcome_not_converged, outcome_solved
   use amontons_stepper, only: new_step_state, restore_step_state, step_state_t, take_step
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: history_walk_t, new_history_walk

   !> A planned step can be halved this many times at the most.
   integer, parameter :: most_halvings = 10
   !> Its length in the smallest steps.
   integer, parameter :: n_ticks = 2**most_halvings

   !> Numbers that the way keeps besides those of its state.
   integer, parameter :: n_own = 5

   !> Where the way has come to.
   type :: history_walk_t
      type(step_state_t) :: state !! the state at the end of the last step that was kept
      type(cycle_watch_t) :: watch !! the cycle that is under way
      integer :: n_planned = 0 !! number of planned times reached
      integer :: n_steps = 0 !! number of steps kept
      integer :: n_given_up = 0 !! number of steps given up for shorter ones
      integer :: n_iterations = 0 !! iterations of all steps, those given up included
      logical :: is_ended = .false. !! whether there is no way on: all times are reached, or a step cannot be taken
      character(:), allocatable :: fault !! why a step cannot be taken; empty as long as all could
      integer :: outcome = outcome_solved !! what came of the last step, kept or not
      integer :: fault_kind = 0 !! the kind of the error that it is; 0 for a step that does not converge
      real(dp) :: fault_time = 0.0_dp !! the time that the step would have led to [-]
      logical :: is_jump = .false. !! whether the energies of the last step do not balance
      integer, private :: tick = 0 !! how far it is on the way to the next planned time, in smallest steps
      integer, private :: length = n_ticks !! length of the next step in smallest steps
   contains
      procedure :: advance => history_walk_advance
      procedure :: keep => history_walk_keep
      procedure :: numbers => history_walk_numbers
      procedure :: point_record => history_walk_point_record
      procedure :: restore => history_walk_restore
      procedure :: shorten => history_walk_shorten
      procedure, private :: can_halve => history_walk_can_halve
      procedure, private :: plan => history_walk_plan
   end type history_walk_t

contains

   !> Begins before the first time.
   pure subroutine new_history_walk(walk, model, body)
      type(history_walk_t), intent(out) :: walk !! the way
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body

      call new_step_state(walk%state, model, body)
      call new_cycle_watch(walk%watch, model, body%zone%n_points)
      walk%fault = ''
   end subroutine new_history_walk

   !> What the way must be restored from.
   pure function history_walk_numbers(self) result(numbers)
      class(history_walk_t), intent(in) :: self !! the way
      real(dp), allocatable :: numbers(:)
      real(dp), allocatable :: noted(:)

      noted = self%watch%noted()
      numbers = [real([self%n_steps, self%n_given_up, self%n_iterations, self%length, size(noted)], dp), &
         self%state%numbers(), noted]
   end function history_walk_numbers

   !> Goes to where the way was when it gave its numbers, perhaps through a history of other times.
   subroutine history_walk_restore(self, model, body, problem, numbers, error)
      class(history_walk_t), intent(inout) :: self !! the way, new
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      real(dp), intent(in) :: numbers(:) !! the numbers
      type(error_t), allocatable, intent(out) :: error !! they do not fit body and history
      type(instant_t) :: instant
      integer :: i, last
      real(dp) :: start

      last = -1
      if (size(numbers) > n_own) last = size(numbers) - nint(max(0.0_dp, min(numbers(n_own), real(size(numbers), dp))))
      if (last <= n_own) then
         call new_error(error, input_refused, 'it is of '//to_text(size(numbers))//' numbers')
         return
      end if
      associate (time => numbers(n_own + 1), times => model%history%times)
         if (time < times(1) .or. time > times(size(times))) then
            call new_error(error, input_refused, 'it is of the time '//to_text(time)//', the times are from '// &
               to_text(times(1))//' to '//to_text(times(size(times))))
            return
         end if
         call model%at(body, time, instant, error)
      end associate
      if (.not. allocated(error)) call restore_step_state(self%state, model, body, problem, &
         numbers(n_own + 1:last), instant, error)
      if (allocated(error)) return
      call self%watch%restore(model, self%state, numbers(last + 1:))
      self%n_steps = nint(numbers(1))
      self%n_given_up = nint(numbers(2))
      self%n_iterations = nint(numbers(3))
      associate (time => self%state%instant%time, history => model%history)
         self%n_planned = count([(history%planned_time(i) <= time, i=1, history%n_steps())])
         self%is_ended = self%n_planned == history%n_steps()
         if (self%is_ended) return
         start = history%planned_time(self%n_planned)
         self%tick = nint(n_ticks*((time - start)/(history%planned_time(self%n_planned + 1) - start)))
      end associate
      ! Times of another history may lie elsewhere: from one of its smallest steps to the next it goes on anyway.
      self%length = nint(numbers(4))
      do while (modulo(self%tick, self%length) /= 0)
         self%length = self%length/2
      end do
   end subroutine history_walk_restore

   !> Takes the next step, as short as it must be. At the end of all times, or where there is no way on, it stays.
   subroutine history_walk_advance(self, model, body, problem)
      class(history_walk_t), intent(inout) :: self !! the way
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(step_state_t) :: next
      type(error_t), allocatable :: error
      character(:), allocatable :: answer
      real(dp) :: time, answer_time

      self%is_jump = .false.
      answer_time = 0.0_dp
      if (self%is_ended) return
      do
         time = self%plan(model%history)
         call try_step(self, model, body, problem, time, next, error)
         if (next%outcome == outcome_no_equilibrium) then
            answer = next%reason
            answer_time = time
         end if
         if (has_balance(next, model%history) .or. .not. self%can_halve(model%history)) exit
         call halve(self)
      end do
      if (allocated(answer) .and. next%outcome == outcome_not_converged .and. .not. allocated(error)) then
         ! That a longer step has no equilibrium says more than that a shorter one does not converge.
         next%outcome = outcome_no_equilibrium
         call move_alloc(answer, next%reason)
         time = answer_time
      end if
      call end_step(self, model, time, next, error)
   end subroutine history_walk_advance

   !> Keeps a step that is not made shorter, or ends the way where it could not be taken.
   pure subroutine end_step(walk, model, time, next, error)
      type(history_walk_t), intent(inout) :: walk !! the way
      type(history_model_t), intent(in) :: model !! the model
      real(dp), intent(in) :: time !! the time that the step leads to [-]
      type(step_state_t), intent(in) :: next !! the state at its end
      type(error_t), allocatable, intent(in) :: error !! that an obstacle is out of place, if so

      walk%fault_time = time
      walk%outcome = next%outcome
      if (allocated(error)) then
         walk%fault_kind = error%kind
         call give_up(walk, time, error%message)
      else if (len(next%reason) > 0) then
         walk%fault_kind = numerical_failure
         call give_up(walk, time, next%reason)
      else if (.not. next%solution%is_converged) then
         call give_up(walk, time, 'not converged with the smallest step')
      else
         call walk%keep(model, next)
      end if
   end subroutine end_step

   !> Takes a step to a time, and counts its iterations. Whether it is kept is decided later.
   subroutine try_step(walk, model, body, problem, time, next, error)
      type(history_walk_t), intent(inout) :: walk !! the way; gains the iterations
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      real(dp), intent(in) :: time !! the time that the step leads to [-]
      type(step_state_t), intent(inout) :: next !! the state at its end, and what came of it
      type(error_t), allocatable, intent(out) :: error !! an obstacle is out of place
      type(instant_t) :: instant

      next%outcome = outcome_not_converged
      next%reason = ''
      next%solution%is_converged = .false.
      next%solution%n_iterations = 0
      call model%at(body, time, instant, error)
      if (.not. allocated(error)) call take_step(next, model, body, problem, walk%state, instant)
      walk%n_iterations = walk%n_iterations + next%solution%n_iterations
   end subroutine try_step

   !> Whether a step that was taken converged and its energies balance.
   pure logical function has_balance(state, history)
      type(step_state_t), intent(in) :: state !! the state at the end of the step
      type(history_t), intent(in) :: history !! the history

      has_balance = state%solution%is_converged
      ! Without a tolerance the digits are not asked for: they take as long as a tenth of a small step.
      if (has_balance .and. history%step_tolerance < huge(1.0_dp)) has_balance = rounded(state%indicator) &
         <= history%step_tolerance
   end function has_balance

   !> Ends the way at the last step that was kept.
   pure subroutine give_up(walk, time, reason)
      type(history_walk_t), intent(inout) :: walk !! the way
      real(dp), intent(in) :: time !! the time that the step would have led to [-]
      character(*), intent(in) :: reason !! why it cannot be taken

      walk%is_ended = .true.
      walk%fault = 'step '//to_text(walk%n_steps + 1)//' (to '//to_text(time)//'): '//reason// &
         '; the history ends at step '//to_text(walk%n_steps)
   end subroutine give_up

   !> Gives the next step up for one of half its length.
   pure subroutine halve(walk)
      type(history_walk_t), intent(inout) :: walk !! the way

      walk%n_given_up = walk%n_given_up + 1
      walk%length = walk%length/2
   end subroutine halve

   !> Halves the next step until it leads to a given time, as `advance` did when it went there.
   pure subroutine history_walk_shorten(self, history, time, leads_there)
      class(history_walk_t), intent(inout) :: self !! the way; its next step becomes shorter
      type(history_t), intent(in) :: history !! the history
      real(dp), intent(in) :: time !! the time [-]
      logical, intent(out) :: leads_there !! whether a step of this history leads to the time
      real(dp) :: rounding

      rounding = 1.0e-12_dp*maxval(abs(history%times))
      do while (self%plan(history) > time + rounding .and. self%can_halve(history))
         call halve(self)
      end do
      leads_there = abs(self%plan(history) - time) <= rounding
   end subroutine history_walk_shorten

   !> Keeps a step and goes on behind it. The next one is twice as long where that ends at a multiple of its length.
   pure subroutine history_walk_keep(self, model, state)
      class(history_walk_t), intent(inout) :: self !! the way
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: state !! the state at the end of the step

      call self%watch%note(model, self%state, state)
      self%state = state
      self%n_steps = self%n_steps + 1
      ! What is loaded at once from rest jumps nowhere: before the first time there is no way for shorter steps.
      self%is_jump = self%n_planned > 0 .and. .not. has_balance(state, model%history)
      self%tick = modulo(self%tick + self%length, n_ticks)
      if (self%tick == 0) self%n_planned = self%n_planned + 1
      self%is_ended = self%n_planned == model%history%n_steps()
      if (modulo(self%tick, 2*self%length) == 0) self%length = min(n_ticks, 2*self%length)
   end subroutine history_walk_keep

   !> Slip of the step, accumulated slip [L], dissipation [F L], Archard's integral [F/L] and, where they are asked for,
   !> the parameters of fretting (m, 4 or 9).
   pure function history_walk_point_record(self, body) result(record)
      class(history_walk_t), intent(in) :: self !! the way
      type(body_t), intent(in) :: body !! the body
      real(dp), allocatable :: record(:, :)

      record = self%state%slip_record(body)
      if (size(self%watch%fretting%extreme) > 0) record = reshape([record, self%watch%fretting%parameters()], &
         [size(record, 1), size(record, 2) + n_parameters])
   end function history_walk_point_record

   !> The time that the next step leads to [-].
   pure real(dp) function history_walk_plan(self, history) result(time)
      class(history_walk_t), intent(in) :: self !! the way
      type(history_t), intent(in) :: history !! the history
      real(dp) :: start

      if (self%n_planned == 0) then
         time = history%times(1)
         return
      end if
      time = history%planned_time(self%n_planned + 1)
      if (self%tick + self%length == n_ticks) return
      start = history%planned_time(self%n_planned)
      time = start + (time - start)*(real(self%tick + self%length, dp)/n_ticks)
   end function history_walk_plan

   !> Whether the next step may be halved. There is nothing to halve before the first time.
   pure logical function history_walk_can_halve(self, history) result(can_halve)
      class(history_walk_t), intent(in) :: self !! the way
      type(history_t), intent(in) :: history !! the history

      can_halve = .false.
      if (self%n_planned == 0 .or. self%length == 1) return
      associate (planned => history%planned_time(self%n_planned + 1) - history%planned_time(self%n_planned))
         can_halve = planned*(real(self%length/2, dp)/n_ticks) >= history%min_step
      end associate
   end function history_walk_can_halve

   !> A number with three digits.
   pure real(dp) function rounded(value)
      real(dp), intent(in) :: value !! the number, at least 0
      character(12) :: buffer

      write (buffer, '(es12.2e4)') min(value, huge(1.0_dp)/10.0_dp)
      read (buffer, '(es12.2e4)') rounded
   end function rounded

end module amontons_history_walk
