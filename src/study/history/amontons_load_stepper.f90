!> Steps of a history for another program, which sets the loads at the end of each step and stores the states.
!>
!> A state is an array of numbers with an internal format; all zeros are the state of rest. A step changes only the
!> state it returns, so that it can be taken again from its beginning.
module amontons_load_stepper
   use amontons_config, only: config_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_history_files, only: history_table_t, history_tables, step_numbers
   use amontons_history_model, only: history_model_t, instant_t, n_state_numbers, new_step_state, restore_step_state, &
      step_state_t, take_step
   use amontons_history_study, only: prepare_history
   use amontons_kinds, only: dp
   use amontons_result, only: result_t
   use amontons_solve_case, only: cache_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: load_stepper_t, new_load_stepper

   !> A body whose loads, supports, obstacles and friction the calling program changes.
   type :: load_stepper_t
      type(cache_t) :: cache !! the body
      type(history_model_t) :: model !! the changes
      integer :: n_changes = 0 !! number of changing numbers
      integer :: n_points = 0 !! number of contact points
      integer :: n_state = 0 !! number of numbers in a state
      type(history_table_t), allocatable, private :: tables(:) !! the tables of the history, that of the steps first
      character(:), allocatable :: columns !! names of the numbers that a step returns, commas between them
   contains
      procedure :: step => load_stepper_step
   end type load_stepper_t

contains

   !> Makes a stepper of a deck with `&history`. Its `&steps` name what changes; their values and the times are not
   !> used.
   subroutine new_load_stepper(stepper, config, error)
      type(load_stepper_t), intent(out) :: stepper !! the stepper
      type(config_t), intent(in) :: config !! the deck
      type(error_t), allocatable, intent(out) :: error !! the deck is invalid, or the computation failed numerically
      type(result_t) :: unused
      integer :: i

      if (.not. config%history%is_given) then
         call new_error(error, input_refused, 'a stepper needs a deck with &history, whose &steps say what changes')
      else if (config%history%has_start()) then
         call new_error(error, input_refused, 'start is not for a stepper: its caller has the states')
      else if (config%accuracy%n_refinements > 0) then
         call new_error(error, input_refused, 'refinements are not for a stepper: it has one mesh')
      end if
      if (.not. allocated(error)) call prepare_history(stepper%cache, config, stepper%model, unused, error)
      if (allocated(error)) return
      stepper%n_changes = sum([(config%history%steps(i)%n_numbers(), i=1, size(config%history%steps))])
      stepper%n_points = stepper%cache%body%zone%n_points
      stepper%n_state = 1 + stepper%n_changes + n_state_numbers(stepper%cache%body)
      call history_tables(stepper%tables, stepper%model, stepper%cache%body, 0)
      associate (header => stepper%tables(1)%header)
         stepper%columns = header(len('step,') + 1:index(header, ',iterations,statuses') - 1)
      end associate
   end subroutine new_load_stepper

   !> Takes a step. Not converged is a result, reported in `is_converged`; a shorter step may help.
   ! allow(S902): types for what goes in and what comes out would be made for this call alone
   subroutine load_stepper_step(self, time, changes, before, after, columns, status, is_converged, error, gap)
      class(load_stepper_t), intent(inout) :: self !! the stepper; its contact problem is left with what acts
      real(dp), intent(in) :: time !! the time at the end of the step [-]
      real(dp), intent(in) :: changes(:) !! the numbers of all `&steps`, in the order of the deck (n_changes)
      real(dp), intent(in) :: before(:) !! the state at the beginning (n_state)
      real(dp), allocatable, intent(out) :: after(:) !! the state at the end (n_state)
      real(dp), allocatable, intent(out) :: columns(:) !! the numbers that `columns` names
      integer, allocatable, intent(out) :: status(:) !! status of each contact point (n_points)
      logical, intent(out) :: is_converged !! whether the step converged
      type(error_t), allocatable, intent(out) :: error !! no equilibrium, or the computation failed numerically
      real(dp), intent(in), optional :: gap(:)
         !! addition to the gaps of the contact points; 0 if absent (n_points) [L]
      type(step_state_t) :: start, next
      type(instant_t) :: instant
      real(dp), allocatable :: added(:)

      is_converged = .false.
      added = spread(0.0_dp, 1, self%n_points)
      if (present(gap)) added = gap
      if (size(added) /= self%n_points) then
         call new_error(error, input_refused, 'expected a gap for each of '//to_text(self%n_points)// &
            ' contact points, found '//to_text(size(added)))
      else if (size(changes) /= self%n_changes .or. size(before) /= self%n_state) then
         call new_error(error, input_refused, 'expected '//to_text(self%n_changes)//' changes and a state of '// &
            to_text(self%n_state)//' numbers, found '//to_text(size(changes))//' and '//to_text(size(before)))
      else if (.not. (abs(time) <= huge(time) .and. all(abs([changes, before, added]) <= huge(time)))) then
         call new_error(error, input_refused, 'time, changes, gaps and state must be finite numbers')
      end if
      if (.not. allocated(error)) call restore_start(self, before, start, error)
      if (.not. allocated(error)) call self%model%enter_step(self%cache%body, self%cache%problem, start, error)
      if (.not. allocated(error)) call self%model%acting(self%cache%body, time, changes, instant, error)
      if (allocated(error)) return
      instant%added_gap = added
      call take_step(next, self%model, self%cache%body, self%cache%problem, start, instant)
      if (len(next%reason) > 0) call new_error(error, next%error_kind, next%reason)
      if (allocated(error)) return
      is_converged = next%solution%is_converged
      after = [before(1) + 1.0_dp, changes, next%numbers()]
      columns = step_numbers(self%tables(1), self%model, self%cache%body, next)
      status = next%solution%status
   end subroutine load_stepper_step

   !> Restores the state at the beginning of a step.
   subroutine restore_start(stepper, numbers, state, error)
      class(load_stepper_t), intent(inout) :: stepper !! the stepper
      real(dp), intent(in) :: numbers(:) !! the numbers of the state
      type(step_state_t), intent(out) :: state !! the state
      type(error_t), allocatable, intent(out) :: error !! the numbers are no state
      type(instant_t) :: instant

      if (.not. numbers(1) > 0.0_dp) then
         call new_step_state(state, stepper%model, stepper%cache%body)
         call stepper%model%set_locks(stepper%cache%body, stepper%cache%problem, state, error)
         return
      end if
      associate (changes => numbers(2:1 + stepper%n_changes), own => numbers(2 + stepper%n_changes:))
         call stepper%model%acting(stepper%cache%body, own(1), changes, instant, error)
         if (.not. allocated(error)) call restore_step_state(state, stepper%model, stepper%cache%body, &
            stepper%cache%problem, own, instant, error)
      end associate
      if (allocated(error)) error%message = 'this state cannot be the start of a step: '//error%message
   end subroutine restore_start

end module amontons_load_stepper
