!> The way of a history from its deck to the files that grow with it, and to the result of its last step.
module amontons_solve_history
   use amontons_config, only: config_t
   use amontons_contact_method, only: contact_method_t
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_history_files, only: history_files_t, new_history_files
   use amontons_history_model, only: history_model_t, new_history_model
   use amontons_history_walk, only: history_walk_t, new_history_walk
   use amontons_kinds, only: dp
   use amontons_load_case, only: condense_load_case
   use amontons_manifest, only: manifest_t
   use amontons_methods, only: new_contact_method
   use amontons_report, only: study_files_t
   use amontons_result, only: result_t
   use amontons_result_warnings, only: add_result_warnings
   use amontons_solve_case, only: cache_t, condense_case, prepare_case
   use amontons_solve_load_case, only: certify, set_factor
   use amontons_stepper, only: step_state_t
   use amontons_study_monitor, only: study_monitor_t
   use amontons_text, only: to_text
   use amontons_timings, only: phase_recover, phase_solve, phase_write
   use amontons_uniqueness, only: new_uniqueness
   implicit none (type, external)
   private

   public :: history_result_t, solve_history

   !> The largest of a number over all steps, and where it was.
   type, public :: worst_step_t
      real(dp) :: value = 0.0_dp !! the largest [-]
      integer :: step = 0 !! the step; 0 if none had more than 0
   contains
      procedure :: note => worst_step_note
   end type worst_step_t

   !> The result of a history. Its steps are on the disk.
   type :: history_result_t
      type(result_t) :: last !! the last step, certified on the full model; its times are those of the history
      type(history_walk_t) :: walk !! where the way ended
      type(study_files_t) :: files !! the files that grew with it
      type(step_state_t), allocatable :: reached(:) !! the states at the times of the deck that were reached
      type(worst_step_t) :: residual !! largest residual of the contact problems
      type(worst_step_t) :: imbalance !! largest violation of the energy identities
      type(worst_step_t) :: indicator !! largest energy error of a step over its energies
      type(worst_step_t) :: violation !! largest violation of the certificates
      integer :: n_certified = 0 !! number of steps that were certified
      logical :: is_interrupted = .false. !! whether the monitor stopped it
   end type history_result_t

contains

   !> Takes all steps of a history. The files keep their temporary names.
   subroutine solve_history(cache, config, directory, monitor, result, error)
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the history needs another
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(study_monitor_t), intent(inout) :: monitor !! learns how far the history is, and may stop it
      type(history_result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the deck, the numbers or the disk are at fault
      class(contact_method_t), allocatable :: method
      type(history_model_t) :: model
      type(history_files_t) :: files

      call prepare_history(cache, config, method, model, result%last, error)
      if (allocated(error)) return
      call result%last%timings%begin(phase_solve)
      call new_history_files(files, model, directory, config, error)
      if (.not. allocated(error)) call take_steps(cache, model, method, files, monitor, result, error)
      if (.not. (allocated(error) .or. result%is_interrupted)) call finish_history(cache, model, result, error)
      if (.not. (allocated(error) .or. result%is_interrupted)) call finish_files(files, config, result%files, error)
      if (allocated(error) .or. result%is_interrupted) call files%discard()
   end subroutine solve_history

   !> Makes what the steps need: the condensed body, the method and the model of the history.
   subroutine prepare_history(cache, config, method, model, last, error)
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the history needs another
      type(config_t), intent(in) :: config !! the deck
      class(contact_method_t), allocatable, intent(out) :: method !! the deck's method
      type(history_model_t), intent(out) :: model !! the history
      type(result_t), intent(inout) :: last !! gains what the result of the last step begins with
      type(error_t), allocatable, intent(out) :: error !! the deck or the numbers are at fault

      call prepare_case(cache, config, last, error)
      if (.not. allocated(error)) call condense_case(cache, config, last, error)
      if (.not. allocated(error)) call new_contact_method(method, config%method, error)
      if (.not. allocated(error)) call new_history_model(model, cache%body, cache%problem, last%load_case, config, &
         error)
      if (allocated(error)) return
      if (.not. any_changes(model)) call last%warnings%add( &
         'no load, support, obstacle or friction changes over the history')
      call set_factor(last%factor, cache%body)
   end subroutine prepare_history

   !> Closes the files of a history, and lists them together with the tables that were read.
   subroutine finish_files(files, config, finished, error)
      type(history_files_t), intent(inout) :: files !! the files
      type(config_t), intent(in) :: config !! the deck
      type(study_files_t), intent(inout) :: finished !! gains the finished files and their manifest
      type(error_t), allocatable, intent(out) :: error !! not everything could be written

      call files%finish(finished%files, finished%manifest, error)
      if (.not. allocated(error)) call add_tables(finished%manifest, config)
   end subroutine finish_files

   !> Adds the tables of changes to the files that were read.
   subroutine add_tables(manifest, config)
      type(manifest_t), intent(inout) :: manifest !! the manifest
      type(config_t), intent(in) :: config !! the deck
      integer :: i

      do i = 1, size(config%history%steps)
         if (allocated(config%history%steps(i)%file)) call manifest%add_input(config%history%steps(i)%file)
      end do
   end subroutine add_tables

   !> Whether anything changes.
   pure logical function any_changes(model)
      type(history_model_t), intent(in) :: model !! the history
      integer :: i

      any_changes = any([(model%history%steps(i)%changes(), i=1, size(model%history%steps))])
   end function any_changes

   !> Takes the steps, as far as there is a way and the monitor does not stop it.
   subroutine take_steps(cache, model, method, files, monitor, result, error)
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(history_files_t), intent(inout) :: files !! gain the steps
      class(study_monitor_t), intent(inout) :: monitor !! learns how far the history is, and may stop it
      type(history_result_t), intent(inout) :: result !! gains the way and its extremes
      type(error_t), allocatable, intent(out) :: error !! fields cannot be written
      integer, parameter :: n_between_reports = 64
      integer :: n_kept, n_reached

      associate (walk => result%walk, history => model%history)
         call new_history_walk(walk, model, cache%body)
         call monitor%report(0, history%n_steps())
         allocate (result%reached(size(history%times)))
         n_reached = 0
         do while (.not. (walk%is_ended .or. result%is_interrupted))
            n_kept = walk%n_steps
            call walk%advance(model, cache%body, cache%problem, method)
            if (modulo(walk%n_steps, n_between_reports) == 0) call monitor%report(walk%n_planned, history%n_steps())
            result%is_interrupted = monitor%is_stopped()
            if (walk%n_steps == n_kept) exit
            if (len(walk%notes) > 0) call result%last%warnings%add(walk%notes)
            call files%add_step(model, cache%body, walk%n_steps, walk%state)
            call result%residual%note(walk%state%solution%residual, walk%n_steps)
            call result%imbalance%note(walk%state%imbalance, walk%n_steps)
            call result%indicator%note(walk%state%indicator, walk%n_steps)
            if (.not. walk%state%instant%time < history%times(n_reached + 1)) then
               n_reached = n_reached + 1
               result%reached(n_reached) = walk%state
            end if
            if (history%fields_every > 0) then
               if (modulo(walk%n_steps - 1, history%fields_every) == 0) call add_fields(cache, model, files, result, &
                  error)
               if (allocated(error)) return
            end if
         end do
         result%reached = result%reached(:n_reached)
      end associate
   end subroutine take_steps

   !> Certifies the present step and writes its grids.
   subroutine add_fields(cache, model, files, result, error)
      type(cache_t), intent(in) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      type(history_files_t), intent(inout) :: files !! gain the grids
      type(history_result_t), intent(inout) :: result !! gains the violation
      type(error_t), allocatable, intent(out) :: error !! the grids cannot be written
      type(result_t) :: step

      call new_step_result(step, cache, model, result%walk%state, error)
      if (allocated(error)) return
      call result%violation%note(step%certificate%largest(), result%walk%n_steps)
      result%n_certified = result%n_certified + 1
      call files%add_fields(cache%body, result%walk%n_steps, to_text(result%walk%state%instant%time), step, error)
   end subroutine add_fields

   !> Makes the result of a step: displacements of all nodes, and their certificate.
   subroutine new_step_result(step, cache, model, state, error)
      type(result_t), intent(inout) :: step !! gains load case, solution, displacements and certificate
      type(cache_t), intent(in) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      type(step_state_t), intent(in) :: state !! the state at the end of the step
      type(error_t), allocatable, intent(out) :: error !! the numbers are not finite

      call model%load_case(cache%body, state%instant, state%anchor, step%load_case, error)
      if (allocated(error)) return
      call condense_load_case(step%load_case, cache%body)
      step%solution = state%solution
      call certify(step, cache%body, error)
   end subroutine new_step_result

   !> Certifies the last step, and gives it what its files show.
   subroutine finish_history(cache, model, result, error)
      type(cache_t), intent(inout) :: cache !! the body; its contact problem becomes that of the last step
      type(history_model_t), intent(in) :: model !! the history
      type(history_result_t), intent(inout) :: result !! gains the last step
      type(error_t), allocatable, intent(out) :: error !! there is no step, or its numbers are not finite

      if (result%walk%n_steps == 0) call new_error(error, numerical_failure, result%walk%fault)
      if (allocated(error)) return
      call result%last%timings%begin(phase_recover)
      associate (state => result%walk%state)
         call new_step_result(result%last, cache, model, state, error)
         if (allocated(error)) return
         call result%violation%note(result%last%certificate%largest(), result%walk%n_steps)
         result%n_certified = result%n_certified + 1
         result%last%slip_record = reshape([state%slip, state%accumulated_slip, state%dissipation], &
            [size(state%slip), 3])
         call model%pose(cache%body, state%instant, state%anchor, cache%problem)
      end associate
      call add_result_warnings(result%last, cache%body)
      call new_uniqueness(result%last%uniqueness, cache%problem)
      call result%last%timings%begin(phase_write)
   end subroutine finish_history

   !> Notes the number of a step.
   pure subroutine worst_step_note(self, value, step)
      class(worst_step_t), intent(inout) :: self !! the largest so far
      real(dp), intent(in) :: value !! that of the step [-]
      integer, intent(in) :: step !! the step

      if (.not. value > self%value) return
      self%value = value
      self%step = step
   end subroutine worst_step_note

end module amontons_solve_history
