!> The procedures of `amontons.h`, where they are described.
!>
!> Calls from several threads wait for each other: gfortran 12 keeps the length of a text that a function returns in one
!> place for all threads.
module amontons_c_interface
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, &
      c_null_ptr, c_ptr
   use amontons_config, only: config_t, read_config, read_config_text
   use amontons_error, only: error_t, input_refused, new_error, no_equilibrium
   use amontons_kinds, only: dp
   use amontons_load_stepper, only: load_stepper_t, new_load_stepper
   use amontons_methods, only: method_options_t
   use amontons_new_study, only: new_study
   use amontons_reduced_study, only: reduced_result_t, solve_reduced_system
   use amontons_reduced_system, only: new_dense_system, reduced_system_t
   use amontons_result, only: status_not_converged
   use amontons_solve_case, only: cache_t
   use amontons_study, only: find_exit_status, outcome_t, solve_study, study_monitor_t, study_options_t, study_t, &
      word_no_equilibrium
   use amontons_text, only: to_text
   use amontons_threads, only: set_threads
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: put_c_text, text_of_c

   !> The version as C wants it.
   character(*, c_char), parameter :: version_of_c = version//c_null_char
   character(c_char), target :: version_text(len(version_of_c)) = &
      transfer(version_of_c, [c_null_char], len(version_of_c))

   interface
      !> Waits until no other call runs, and gives the BLAS one thread.
      subroutine begin_call() bind(c, name='amontons_begin_call')
         implicit none (type, external)
      end subroutine begin_call

      !> Ends a call from C, so that a call that waits on another thread can begin.
      subroutine end_call() bind(c, name='amontons_end_call')
         implicit none (type, external)
      end subroutine end_call
   end interface

contains

   !> The text of a C string, up to its terminating zero.
   pure function text_of_c(c_text) result(text)
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: c_text(*) !! the characters, up to a zero
      character(:), allocatable :: text
      integer :: i, length

      length = 0
      do while (c_text(length + 1) /= c_null_char)
         length = length + 1
      end do
      allocate (character(length) :: text)
      do i = 1, length
         text(i:i) = c_text(i)
      end do
   end function text_of_c

   !> Copies a text to the buffer of a C program, truncated if necessary, and terminates it with a null character.
   pure subroutine put_c_text(text, size, c_text)
      character(*), intent(in) :: text !! the text
      integer(c_int), intent(in) :: size !! size of the buffer, null character included; nothing is written if it is 0
      character(c_char), intent(inout) :: c_text(size) !! takes the text
      integer :: i, length

      if (size < 1) return
      length = min(len(text), int(size) - 1)
      do i = 1, length
         c_text(i) = text(i:i)
      end do
      c_text(length + 1) = c_null_char
   end subroutine put_c_text

   !> Address of the version of the library, as a C string.
   function amontons_version_text() bind(c, name='amontons_version_text') result(address)
      type(c_ptr) :: address

      address = c_loc(version_text)
   end function amontons_version_text

   !> Sets the number of threads of later calls; see `amontons.h`.
   subroutine amontons_set_threads(n_threads) bind(c, name='amontons_set_threads')
      integer(c_int), value, intent(in) :: n_threads !! number of threads; 1 is taken for less

      call set_threads(max(1, int(n_threads)))
   end subroutine amontons_set_threads

   !> Solves a reduced problem of the plane or of space.
   ! allow(S902): C has no keywords that would make options of the half of them
   function amontons_solve_contacts(dimension, n_contacts, w, q, mu, method, tolerance, max_iterations, r, u, status, &
      residual, n_iterations, message, message_size) bind(c, name='amontons_solve_contacts') result(code)
      integer(c_int), value, intent(in) :: dimension !! number of unknowns of a contact, 2 or 3
      integer(c_int), value, intent(in) :: n_contacts !! number m of contacts
      real(c_double), intent(in) :: w(dimension*n_contacts, dimension*n_contacts) !! W [L/F]
      real(c_double), intent(in) :: q(dimension*n_contacts) !! u without forces [L]
      real(c_double), intent(in) :: mu(n_contacts) !! coefficients of friction [-]
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in), optional :: method(*) !! name of the method
      real(c_double), value, intent(in) :: tolerance !! residual that counts as solved; 0 for the default [-]
      integer(c_int), value, intent(in) :: max_iterations !! most iterations; 0 for the default
      real(c_double), intent(inout) :: r(dimension*n_contacts) !! forces [F]
      real(c_double), intent(inout) :: u(dimension*n_contacts) !! displacements [L]
      integer(c_int), intent(inout) :: status(n_contacts) !! status of each contact
      real(c_double), intent(inout) :: residual !! residual reached [-]
      integer(c_int), intent(inout) :: n_iterations !! number of iterations done
      integer(c_int), value, intent(in) :: message_size !! room in message
      character(c_char), intent(inout) :: message(message_size) !! the failure
      integer(c_int) :: code
      type(method_options_t) :: options
      type(reduced_system_t) :: system
      type(reduced_result_t) :: result
      character(:), allocatable :: sentence
      type(error_t), allocatable :: error
      integer :: exit_status

      call begin_call()
      if (present(method)) options%method = text_of_c(method)
      if (dimension /= 2 .and. dimension /= 3) then
         call new_error(error, input_refused, 'dimension must be 2 or 3, found '//to_text(int(dimension)))
      else if (n_contacts < 0) then
         call new_error(error, input_refused, 'n_contacts must be at least 0, found '//to_text(int(n_contacts)))
      else if (.not. (tolerance >= 0.0_c_double .and. tolerance < 1.0_c_double)) then
         call new_error(error, input_refused, 'tolerance must lie above 0 and below 1, or be 0 for the default')
      else if (max_iterations < 0) then
         call new_error(error, input_refused, 'max_iterations must be at least 1, or 0 for the default')
      end if
      if (tolerance > 0.0_c_double) options%tolerance = tolerance
      if (max_iterations > 0) options%max_iterations = int(max_iterations)
      if (.not. allocated(error)) call new_dense_system(system, w, q, mu, error)
      if (.not. allocated(error)) call solve_reduced_system(system, options, result, error)
      if (allocated(error)) then
         code = int(error%kind, c_int)
         sentence = error%message
      else
         call find_exit_status(result%solution%is_converged, result%solution%residual, result%check%largest(), &
            options%tolerance, exit_status, sentence)
         code = int(exit_status, c_int)
         r = result%system%r
         u = result%system%u
         status = int(result%solution%status, c_int)
         residual = result%solution%residual
         n_iterations = int(result%solution%n_iterations, c_int)
      end if
      call put_c_text(sentence, message_size, message)
      call end_call()
   end function amontons_solve_contacts

   !> Solves a deck and writes its files.
   function amontons_solve_deck(deck, directory, name, name_size, message, message_size) &
      bind(c, name='amontons_solve_deck') result(code)
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: deck(*) !! name of the deck
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: directory(*) !! output directory
      integer(c_int), value, intent(in) :: name_size !! room in name
      character(c_char), intent(inout) :: name(name_size) !! name of the case
      integer(c_int), value, intent(in) :: message_size !! room in message
      character(c_char), intent(inout) :: message(message_size) !! the failure
      integer(c_int) :: code
      type(config_t) :: config
      type(error_t), allocatable :: error

      call begin_call()
      call read_config(config, text_of_c(deck), error)
      call run_deck(config, error, text_of_c(deck), text_of_c(directory), name, message, code)
      call end_call()
   end function amontons_solve_deck

   !> Solves a deck that is a text and writes its files.
   function amontons_solve_deck_text(text, deck, settings, directory, name, name_size, message, message_size) &
      bind(c, name='amontons_solve_deck_text') result(code)
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: text(*) !! the deck
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: deck(*) !! name of the deck
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: settings(*) !! settings, one a line
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: directory(*) !! output directory
      integer(c_int), value, intent(in) :: name_size !! room in name
      character(c_char), intent(inout) :: name(name_size) !! name of the case
      integer(c_int), value, intent(in) :: message_size !! room in message
      character(c_char), intent(inout) :: message(message_size) !! the failure
      integer(c_int) :: code
      type(config_t) :: config
      type(error_t), allocatable :: error

      call begin_call()
      call read_config_text(config, text_of_c(deck), text_of_c(text), text_of_c(settings), error)
      call run_deck(config, error, text_of_c(deck), text_of_c(directory), name, message, code)
      call end_call()
   end function amontons_solve_deck_text

   !> Solves a case and writes its files, as the program does.
   subroutine run_deck(config, error, deck, directory, name, message, code)
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(in) :: error !! the faults of its deck
      character(*), intent(in) :: deck !! name of the deck
      character(*), intent(in) :: directory !! output directory, made if it is not there
      character(c_char), intent(inout) :: name(:) !! takes the name of the case
      character(c_char), intent(inout) :: message(:) !! takes the failure
      integer(c_int), intent(out) :: code !! the code for the C program
      type(outcome_t) :: outcome
      class(study_t), allocatable :: study
      type(cache_t) :: cache
      type(study_options_t) :: options
      type(study_monitor_t) :: monitor

      if (allocated(error)) then
         call outcome%begin(deck, '')
         call outcome%fail(error)
      else
         call new_study(study, config)
         options%directory = directory
         call solve_study(study, cache, options, monitor, outcome)
      end if
      code = int(merge(no_equilibrium, outcome%status, outcome%word == word_no_equilibrium), c_int)
      call put_c_text(outcome%name, size(name, kind=c_int), name)
      call put_c_text(outcome%message, size(message, kind=c_int), message)
   end subroutine run_deck

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
      integer(c_int), intent(out) :: n_changes !! number of changing numbers
      integer(c_int), intent(out) :: n_points !! number of contact points
      integer(c_int), intent(out) :: n_state !! number of numbers in a state
      integer(c_int), value, intent(in) :: columns_size !! room in columns
      character(c_char), intent(inout) :: columns(columns_size) !! names of the numbers of a step
      integer(c_int), value, intent(in) :: message_size !! room in message
      character(c_char), intent(inout) :: message(message_size) !! the failure
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
      gap, status, message, message_size) bind(c, name='amontons_step') result(code)
      type(c_ptr), value, intent(in) :: stepper !! the stepper
      real(c_double), value, intent(in) :: time !! the time at the end of the step [-]
      integer(c_int), value, intent(in) :: n_changes !! number of changing numbers
      real(c_double), intent(in) :: changes(n_changes) !! the numbers of all `&steps`
      integer(c_int), value, intent(in) :: n_state !! number of numbers in a state
      real(c_double), intent(in) :: before(n_state) !! the state at the beginning
      real(c_double), intent(inout) :: after(n_state) !! the state at the end
      integer(c_int), value, intent(in) :: n_columns !! number of numbers of the step to be returned
      real(c_double), intent(inout) :: columns(n_columns) !! the first of them
      integer(c_int), value, intent(in) :: n_points !! room in status
      real(c_double), intent(in), optional :: gap(n_points) !! addition to the gap of each contact point [L]
      integer(c_int), intent(inout) :: status(n_points) !! status of each contact point
      integer(c_int), value, intent(in) :: message_size !! room in message
      character(c_char), intent(inout) :: message(message_size) !! the failure
      integer(c_int) :: code
      type(load_stepper_t), pointer :: made
      type(error_t), allocatable :: error
      real(dp), allocatable :: state(:), numbers(:)
      integer, allocatable :: statuses(:)
      logical :: is_converged

      call begin_call()
      call c_f_pointer(stepper, made)
      call made%step(time, changes, before, state, numbers, statuses, is_converged, error, gap)
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

   !> Returns positions, weights and areas of the contact points of a stepper, and how many tangents they have.
   function amontons_stepper_points(stepper, n_points, points) bind(c, name='amontons_stepper_points') &
      result(n_tangents)
      type(c_ptr), value, intent(in) :: stepper !! the stepper
      integer(c_int), value, intent(in) :: n_points !! number of contact points
      real(c_double), intent(inout) :: points(n_points, 4) !! x, y, weight and area of each
      integer(c_int) :: n_tangents
      type(load_stepper_t), pointer :: made

      call c_f_pointer(stepper, made)
      associate (zone => made%cache%body%zone)
         points = reshape([zone%position(1, :), zone%position(2, :), zone%weight, zone%area], [int(n_points), 4])
         n_tangents = zone%n_tangents
      end associate
   end function amontons_stepper_points

   !> Writes the places of the contact points and the directions of their numbers in a state. Returns the number of
   !> coordinates.
   function amontons_stepper_frames(stepper, n_points, frames) bind(c, name='amontons_stepper_frames') result(n_dim)
      type(c_ptr), value, intent(in) :: stepper !! the stepper
      integer(c_int), value, intent(in) :: n_points !! number of contact points
      real(c_double), intent(inout) :: frames(3, 4, n_points) !! place, normal and tangents of each; 0 what it has not
      integer(c_int) :: n_dim
      type(load_stepper_t), pointer :: made

      call c_f_pointer(stepper, made)
      associate (zone => made%cache%body%zone)
         n_dim = size(zone%position, 1)
         frames = 0.0_c_double
         frames(:n_dim, 1, :) = zone%position
         frames(:size(zone%frame, 1), 2:1 + size(zone%frame, 2), :) = zone%frame
      end associate
   end function amontons_stepper_frames

   !> Frees a stepper made by `amontons_new_stepper`.
   subroutine amontons_free_stepper(stepper) bind(c, name='amontons_free_stepper')
      type(c_ptr), value, intent(in) :: stepper !! the stepper; null for none
      type(load_stepper_t), pointer :: made

      if (.not. c_associated(stepper)) return
      call c_f_pointer(stepper, made)
      deallocate (made)
   end subroutine amontons_free_stepper

end module amontons_c_interface
