!> The procedures of `amontons.h`, where they are described.
!>
!> Calls from several threads wait for each other: gfortran 12 keeps the length of a text that a function returns in one
!> place for all threads.
module amontons_c_interface
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_loc, c_null_char, c_ptr
   use amontons_c_text, only: begin_call, end_call, put_c_text, text_of_c
   use amontons_config, only: config_t, read_config, read_config_text
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_methods, only: method_options_t
   use amontons_new_study, only: new_study
   use amontons_reduced_system, only: new_dense_system, reduced_system_t
   use amontons_solve_case, only: cache_t
   use amontons_solve_reduced, only: reduced_result_t, solve_reduced_system
   use amontons_study, only: find_exit_status, outcome_t, solve_study, study_monitor_t, study_options_t, study_t
   use amontons_text, only: to_text
   use amontons_threads, only: set_threads
   use amontons_version, only: version
   implicit none (type, external)
   private

   !> The version as C wants it.
   character(*, c_char), parameter :: version_of_c = version//c_null_char
   character(c_char), target :: version_text(len(version_of_c)) = &
      transfer(version_of_c, [c_null_char], len(version_of_c))

contains

   !> The version.
   function amontons_version_text() bind(c, name='amontons_version_text') result(address)
      type(c_ptr) :: address

      address = c_loc(version_text)
   end function amontons_version_text

   !> Sets the number of threads.
   subroutine amontons_set_threads(n_threads) bind(c, name='amontons_set_threads')
      integer(c_int), value, intent(in) :: n_threads !! number of threads; 1 is taken for less

      call set_threads(max(1, int(n_threads)))
   end subroutine amontons_set_threads

   !> Solves a reduced problem.
   ! allow(S902): C has no keywords that would make options of the half of them
   function amontons_solve_reduced_problem(n_contacts, w, q, mu, method, tolerance, max_iterations, r, u, status, &
      residual, n_iterations, message, message_size) bind(c, name='amontons_solve_reduced_problem') result(code)
      integer(c_int), value, intent(in) :: n_contacts !! number m of contacts
      real(c_double), intent(in) :: w(2*n_contacts, 2*n_contacts) !! W [L/F]
      real(c_double), intent(in) :: q(2*n_contacts) !! u without forces [L]
      real(c_double), intent(in) :: mu(n_contacts) !! coefficients of friction [-]
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in), optional :: method(*) !! name of the method
      real(c_double), value, intent(in) :: tolerance !! residual that counts as solved; 0 for the default [-]
      integer(c_int), value, intent(in) :: max_iterations !! most iterations; 0 for the default
      real(c_double), intent(inout) :: r(2*n_contacts) !! forces [F]
      real(c_double), intent(inout) :: u(2*n_contacts) !! displacements [L]
      integer(c_int), intent(inout) :: status(n_contacts) !! status of each contact
      real(c_double), intent(inout) :: residual !! residual reached [-]
      integer(c_int), intent(inout) :: n_iterations !! number of iterations done
      integer(c_int), value, intent(in) :: message_size !! room in message
      character(c_char), intent(inout) :: message(message_size) !! what went wrong
      integer(c_int) :: code
      type(method_options_t) :: options
      type(reduced_result_t) :: result
      character(:), allocatable :: sentence
      type(error_t), allocatable :: error

      call begin_call()
      if (present(method)) options%method = text_of_c(method)
      call choose(options, int(n_contacts), tolerance, int(max_iterations), error)
      if (.not. allocated(error)) call solve_arrays(w, q, mu, options, result, code, sentence, error)
      if (allocated(error)) then
         code = int(error%kind, c_int)
         sentence = error%message
      else
         r = result%system%r
         u = result%system%u
         status = int(result%solution%status, c_int)
         residual = result%solution%residual
         n_iterations = int(result%solution%n_iterations, c_int)
      end if
      call put_c_text(sentence, message_size, message)
      call end_call()
   end function amontons_solve_reduced_problem

   !> Solves a reduced problem from arrays and judges the solution.
   subroutine solve_arrays(w, q, mu, options, result, code, sentence, error)
      real(c_double), intent(in) :: w(:, :) !! W [L/F]
      real(c_double), intent(in) :: q(:) !! u without forces [L]
      real(c_double), intent(in) :: mu(:) !! coefficients of friction [-]
      type(method_options_t), intent(in) :: options !! the method
      type(reduced_result_t), intent(out) :: result !! the result
      integer(c_int), intent(out) :: code !! 0 or `status_not_converged`
      character(:), allocatable, intent(out) :: sentence !! what the solution lacks; empty if nothing
      type(error_t), allocatable, intent(out) :: error !! the arrays or the numbers are at fault
      type(reduced_system_t) :: system
      integer :: status

      call new_dense_system(system, w, q, mu, error)
      if (.not. allocated(error)) call solve_reduced_system(system, options, result, error)
      if (allocated(error)) return
      call find_exit_status(result%solution%is_converged, result%solution%residual, result%check%largest(), &
         options%tolerance, status, sentence)
      code = int(status, c_int)
   end subroutine solve_arrays

   !> Checks single numbers among the arguments, and puts the options of a method in place of the defaults.
   pure subroutine choose(options, n_contacts, tolerance, max_iterations, error)
      type(method_options_t), intent(inout) :: options !! the options, with their defaults
      integer, intent(in) :: n_contacts !! number of contacts
      real(c_double), intent(in) :: tolerance !! residual that counts as solved; 0 for the default [-]
      integer, intent(in) :: max_iterations !! most iterations; 0 for the default
      type(error_t), allocatable, intent(out) :: error !! an option out of its range

      if (n_contacts < 0) then
         call new_error(error, input_refused, 'n_contacts must be at least 0, found '//to_text(n_contacts))
      else if (.not. (tolerance >= 0.0_c_double .and. tolerance < 1.0_c_double)) then
         call new_error(error, input_refused, 'tolerance must lie above 0 and below 1, or be 0 for the default')
      else if (max_iterations < 0) then
         call new_error(error, input_refused, 'max_iterations must be at least 1, or 0 for the default')
      end if
      if (tolerance > 0.0_c_double) options%tolerance = tolerance
      if (max_iterations > 0) options%max_iterations = max_iterations
   end subroutine choose

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
      character(c_char), intent(inout) :: message(message_size) !! what went wrong
      integer(c_int) :: code
      type(outcome_t) :: outcome

      type(config_t) :: config
      type(error_t), allocatable :: error

      call begin_call()
      call read_config(config, text_of_c(deck), error)
      call run_deck(config, error, text_of_c(deck), text_of_c(directory), outcome)
      code = int(outcome%status, c_int)
      call put_c_text(outcome%name, name_size, name)
      call put_c_text(outcome%message, message_size, message)
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
      character(c_char), intent(inout) :: message(message_size) !! what went wrong
      integer(c_int) :: code
      type(outcome_t) :: outcome
      type(config_t) :: config
      type(error_t), allocatable :: error

      call begin_call()
      call read_config_text(config, text_of_c(deck), text_of_c(text), text_of_c(settings), error)
      call run_deck(config, error, text_of_c(deck), text_of_c(directory), outcome)
      code = int(outcome%status, c_int)
      call put_c_text(outcome%name, name_size, name)
      call put_c_text(outcome%message, message_size, message)
      call end_call()
   end function amontons_solve_deck_text

   !> Solves a case and writes its files, as the program does.
   subroutine run_deck(config, error, deck, directory, outcome)
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(in) :: error !! what is wrong with its deck
      character(*), intent(in) :: deck !! name of the deck
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(outcome_t), intent(out) :: outcome !! what became of it
      class(study_t), allocatable :: study
      type(cache_t) :: cache
      type(study_options_t) :: options
      type(study_monitor_t) :: monitor

      if (allocated(error)) then
         call outcome%begin(deck, '')
         call outcome%fail(error)
         return
      end if
      call new_study(study, config)
      options%directory = directory
      call solve_study(study, cache, options, monitor, outcome)
   end subroutine run_deck

end module amontons_c_interface
