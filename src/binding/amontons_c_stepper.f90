!> The stepper of `amontons.h`, where it is described.
module amontons_c_stepper
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr
   use amontons_c_text, only: begin_call, end_call, put_c_text, text_of_c
   use amontons_config, only: config_t, read_config_text
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_load_stepper, only: load_stepper_t, new_load_stepper
   use amontons_result, only: status_not_converged
   implicit none (type, external)
   private

contains

   !> Makes a stepper.
   ! allow(S902): C has no types that would gather these sizes
   function amontons_new_stepper(text, deck, settings, stepper, n_changes, n_points, n_state, columns, columns_size, &
      message, message_size) bind(c, name='amontons_new_stepper') result(code)
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: text(*) !! the deck
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: deck(*) !! name of the deck
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: settings(*) !! settings, one a line
      type(c_ptr), intent(out) :: stepper !! the stepper; null if there is none
      integer(c_int), intent(out) :: n_changes !! how many numbers change
      integer(c_int), intent(out) :: n_points !! number of contact points
      integer(c_int), intent(out) :: n_state !! how many numbers a state has
      integer(c_int), value, intent(in) :: columns_size !! room in columns
      character(c_char), intent(inout) :: columns(columns_size) !! names of the numbers of a step
      integer(c_int), value, intent(in) :: message_size !! room in message
      character(c_char), intent(inout) :: message(message_size) !! what went wrong
      integer(c_int) :: code
      type(load_stepper_t), pointer :: made
      type(config_t) :: config
      type(error_t), allocatable :: error

      call begin_call()
      stepper = c_null_ptr
      allocate (made)
      call read_config_text(config, text_of_c(deck), text_of_c(text), text_of_c(settings), error)
      if (.not. allocated(error)) call new_load_stepper(made, config, error)
      n_changes = int(made%n_changes, c_int)
      n_points = int(made%n_points, c_int)
      n_state = int(made%n_state, c_int)
      if (allocated(error)) then
         deallocate (made)
         code = int(error%kind, c_int)
         call put_c_text(error%message, message_size, message)
      else
         code = 0
         stepper = c_loc(made)
         call put_c_text(made%columns, columns_size, columns)
         call put_c_text('', message_size, message)
      end if
      call end_call()
   end function amontons_new_stepper

   !> Takes a step.
   ! allow(S902): C has no types that would gather these arrays
   function amontons_step(stepper, time, n_changes, changes, n_state, before, after, n_columns, columns, n_points, &
      status, message, message_size) bind(c, name='amontons_step') result(code)
      type(c_ptr), value, intent(in) :: stepper !! the stepper
      real(c_double), value, intent(in) :: time !! the time at the end of the step [-]
      integer(c_int), value, intent(in) :: n_changes !! how many numbers change
      real(c_double), intent(in) :: changes(n_changes) !! the numbers of all `&steps`
      integer(c_int), value, intent(in) :: n_state !! how many numbers a state has
      real(c_double), intent(in) :: before(n_state) !! the state at the beginning
      real(c_double), intent(inout) :: after(n_state) !! the state at the end
      integer(c_int), value, intent(in) :: n_columns !! how many numbers of the step are wanted
      real(c_double), intent(inout) :: columns(n_columns) !! the first of them
      integer(c_int), value, intent(in) :: n_points !! room in status
      integer(c_int), intent(inout) :: status(n_points) !! status of each contact point
      integer(c_int), value, intent(in) :: message_size !! room in message
      character(c_char), intent(inout) :: message(message_size) !! what went wrong
      integer(c_int) :: code
      type(load_stepper_t), pointer :: made
      type(error_t), allocatable :: error
      real(dp), allocatable :: state(:), numbers(:)
      integer, allocatable :: statuses(:)
      logical :: is_converged

      call begin_call()
      call c_f_pointer(stepper, made)
      call made%step(time, changes, before, state, numbers, statuses, is_converged, error)
      if (allocated(error)) then
         code = int(error%kind, c_int)
         call put_c_text(error%message, message_size, message)
      else
         after = state
         associate (n => min(n_columns, size(numbers, kind=c_int)), m => min(n_points, size(statuses, kind=c_int)))
            columns(:n) = numbers(:n)
            status(:m) = int(statuses(:m), c_int)
         end associate
         code = merge(0_c_int, int(status_not_converged, c_int), is_converged)
         call put_c_text(trim(merge('              ', 'not converged ', is_converged)), message_size, message)
      end if
      call end_call()
   end function amontons_step

   !> Gives a stepper up.
   subroutine amontons_free_stepper(stepper) bind(c, name='amontons_free_stepper')
      type(c_ptr), value, intent(in) :: stepper !! the stepper; null for none
      type(load_stepper_t), pointer :: made

      if (.not. c_associated(stepper)) return
      call c_f_pointer(stepper, made)
      deallocate (made)
   end subroutine amontons_free_stepper

end module amontons_c_stepper
