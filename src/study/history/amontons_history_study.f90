!> The study of a load history: from its deck through all steps to its files, the result of its last step, and the text
!> of listing and summary on the history.
module amontons_history_study
   use amontons_body, only: body_t
   use amontons_checkpoint, only: archive_t, checkpoint_t
   use amontons_config, only: config_t, effective_deck
   use amontons_document, only: json_logical, json_number, json_string, quantity_members
   use amontons_error, only: error_t, new_error
   use amontons_history, only: history_t, is_shown, moved_things, stepped_load, steps_t
   use amontons_history_files, only: history_files_t, read_start
   use amontons_history_model, only: find_probes, history_model_t, new_history_model, step_state_t
   use amontons_key_results, only: contact_peaks, lengths_t, new_lengths, resultants
   use amontons_kinds, only: dp
   use amontons_listing, only: quantities_text
   use amontons_manifest, only: manifest_t
   use amontons_model_warnings, only: add_history_warnings
   use amontons_quantity, only: largest_t, quantity_t
   use amontons_report, only: member, study_files_t, write_report
   use amontons_result, only: judge_meshes, outcome_no_equilibrium, outcome_numbers, &
      refined_quantities, result_t, word_no_equilibrium, word_not_converged, word_numerical_failure
   use amontons_result_warnings, only: add_result_warnings, add_tallied_warnings, end_of_set, find_case_warnings, &
      is_limit_of_model, n_case_warnings, tally_t
   use amontons_rounding, only: input_rounding, sum_rounding
   use amontons_sliding, only: take_places
   use amontons_solve_case, only: cache_t, certify, condense_case, describe_factor, prepare_case, take_no_equilibrium
   use amontons_study, only: outcome_t, report_answer, report_size, study_monitor_t, study_options_t, study_t
   use amontons_terminal, only: phase_recover, phase_solve, phase_write
   use amontons_text, only: columns, counted, flush_right, heading, labeled, lower_case, &
      n_characters, newline, scientific, short_text, to_text, unit_of, with_unit
   use amontons_time_stepping, only: cycle_outcomes, n_cycle_numbers, n_plain_numbers, new_time_stepping, &
      time_stepping_t
   use amontons_uniqueness, only: new_uniqueness
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: add_history_results, describe_history, history_result_t, history_study_t, new_step_result, &
      prepare_history, start_history, take_steps

   !> Number of saved numbers for each time that was reached.
   integer, parameter :: n_reached_numbers = 9

   !> Index of a step's largest number: the residual of the contact problem.
   integer, parameter :: of_residual = 1
   !> Index of a step's largest number: the violation of the energy identities.
   integer, parameter :: of_identities = 2
   !> Index of a step's largest number: its energy error over its energies.
   integer, parameter :: of_indicator = 3
   !> Index of a step's largest number: the violation of the certificate.
   integer, parameter :: of_violation = 4
   !> Index of a step's largest number: the energy error of a step that cannot be made shorter, over its energies.
   integer, parameter :: of_jump = 5
   !> Index of a step's largest number: the share of a pressure that the wear of one step removes.
   integer, parameter :: of_feedback = 6
   !> Names of the first of them in the summary.
   character(17), parameter, public :: worst_names(of_violation) = [character(17) :: 'residual', 'energy_identities', &
      'step_indicator', 'violation']
   !> Names of the first of them in the listing.
   character(17), parameter :: worst_labels(of_indicator) = [character(17) :: 'Largest residual', 'Energy identities', &
      'Step indicator']

   !> The result of a history. Its steps are in files.
   type :: history_result_t
      type(result_t) :: last !! the last step, certified on the full model; its times are those of the history
      type(time_stepping_t) :: stepping !! the time stepping after the last step
      type(study_files_t) :: files !! the files that grew with it
      type(checkpoint_t) :: checkpoint !! their checkpoint, locked unless the history was interrupted
      real(dp), allocatable :: reached(:, :)
         !! the times of the deck that were reached, each with zones, forces, strain energy, work, dissipation (9, n)
      real(dp), allocatable :: cycles(:, :) !! the cycles that ended, as `cycle_record_t` has them (n_cycle_numbers, n)
      real(dp), allocatable :: extremes(:, :)
         !! least and greatest of the numbers of all contact sets, of the probes, and of forces by name (n, 2)
      type(largest_t) :: worst(of_feedback) !! the largest of each number of the steps, `of_residual` and so on
      integer :: n_jumps = 0 !! number of steps that cannot be made shorter although their energies do not balance
      type(tally_t) :: warned(n_case_warnings) !! the steps that each warning on a case is about
      integer :: n_certified = 0 !! number of steps that were certified
      integer :: n_resumed = 0 !! number of the last step that an earlier run had done
      logical :: is_interrupted = .false. !! whether the monitor stopped it
   contains
      procedure :: add_warnings => history_result_add_warnings
      procedure :: error_from_rest => history_result_error_from_rest
      procedure :: record_certificate => history_result_record_certificate
      procedure :: record_end => history_result_record_end
      procedure :: record_step => history_result_record_step
      procedure, private :: visit => history_result_visit
   end type history_result_t

   !> The study of a history.
   type, extends(study_t) :: history_study_t
   contains
      procedure :: check => history_study_check
      procedure :: solve => history_study_solve
   end type history_study_t

contains

   !> Takes all steps of a history. The files keep their temporary names.
   subroutine solve_history(cache, config, directory, monitor, result, error)
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the history needs another
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress of the history, and may stop it
      type(history_result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error
         !! the deck is invalid, the computation failed numerically, or a file cannot be written
      type(history_model_t) :: model
      type(history_files_t) :: files
      type(archive_t), allocatable :: progress
      type(manifest_t) :: inputs
      real(dp), allocatable :: start(:)
      character(:), allocatable :: key
      integer :: i

      call prepare_history(cache, config, model, result%last, error)
      if (allocated(error)) return
      call result%last%timings%begin(phase_solve)
      call start_history(result, cache, model, start, error)
      if (allocated(error)) error%message = config%history%start_origin//error%message
      if (allocated(error)) return
      ! The tables of changes are among the files that were read.
      do i = 1, size(config%history%steps)
         if (allocated(config%history%steps(i)%file)) call inputs%add_input(config%history%steps(i)%file)
      end do
      if (config%history%has_start()) call inputs%add_input(config%history%start)
      ! From the start, or from the last step that an earlier run has saved.
      key = '! Amontons '//version//', a history under way; files '// &
         inputs%fingerprint(cache%body%mesh, config%contacts, config%loads)//newline//effective_deck(config)
      call files%prepare(model, cache%body, result%stepping, directory, config)
      call files%open(key, progress, error)
      if (allocated(error)) return
      if (allocated(progress)) then
         call result%visit(progress)
         call result%stepping%restore(model, cache%body, cache%problem, progress%numbers(progress%n + 1:), error)
         if (allocated(error)) return
         result%n_resumed = result%stepping%n_steps
      end if
      call take_steps(cache, model, files, monitor, result, error)
      if (.not. allocated(error)) call save_progress(files, result, error)
      if (.not. (allocated(error) .or. result%is_interrupted)) call finish_history(cache, model, files, result, error)
      result%files%manifest%inputs = inputs%inputs
      result%checkpoint = files%checkpoint
      if (result%stepping%n_steps == 0 .and. .not. result%is_interrupted) then
         call result%checkpoint%discard()
      else if (result%is_interrupted .or. allocated(error)) then
         call result%checkpoint%close()
      end if
   end subroutine solve_history

   !> Begins before the first step, or at the state that the deck names.
   subroutine start_history(result, cache, model, numbers, error)
      type(history_result_t), intent(inout) :: result !! gains the time stepping, without steps
      type(cache_t), intent(inout) :: cache !! the body; its contact problem becomes that of the state
      type(history_model_t), intent(inout) :: model !! the history
      real(dp), allocatable, intent(out) :: numbers(:) !! the numbers of the state; not allocated where none is named
      type(error_t), allocatable, intent(out) :: error !! there is no such state, or it is none of this deck

      allocate (result%reached(n_reached_numbers, 0), result%cycles(n_cycle_numbers, 0), result%extremes(0, 2))
      call new_time_stepping(result%stepping, model, cache%body)
      if (.not. model%history%has_start()) return
      call read_start(numbers, model%history, error)
      if (allocated(error)) return
      call result%stepping%restore(model, cache%body, cache%problem, numbers, error)
      if (allocated(error)) error%message = model%history%start//': this state cannot be the start: '//error%message
   end subroutine start_history

   !> Puts the steps so far on the disk, so that the history can go on from there.
   subroutine save_progress(files, result, error)
      type(history_files_t), intent(inout) :: files !! the files
      type(history_result_t), intent(inout) :: result !! the history so far
      type(error_t), allocatable, intent(out) :: error !! the files cannot be written
      type(archive_t) :: progress
      real(dp), allocatable :: numbers(:)

      if (result%stepping%n_steps == 0) return
      call result%visit(progress)
      numbers = result%stepping%numbers()
      call progress%pass(numbers)
      call files%checkpoint%save(progress, error)
   end subroutine save_progress

   !> Writes to an archive the record of the steps so far, or reads it.
   pure subroutine history_result_visit(self, archive)
      class(history_result_t), intent(inout) :: self !! the history so far
      type(archive_t), intent(inout) :: archive !! the archive
      integer :: n(3), i

      call archive%pass(self%n_certified)
      call archive%pass(self%worst%value)
      call archive%pass(self%worst%at)
      call archive%pass(self%n_jumps)
      call archive%pass(self%warned%n)
      call archive%pass(self%warned%first)
      call archive%pass(self%warned%last)
      n = [size(self%reached, 2), size(self%cycles, 2), size(self%extremes, 1)]
      call archive%pass(n)
      if (archive%is_read) then
         self%reached = reshape([0.0_dp], [n_reached_numbers, n(1)], pad=[0.0_dp])
         self%cycles = reshape([0.0_dp], [n_cycle_numbers, n(2)], pad=[0.0_dp])
         self%extremes = reshape([0.0_dp], [n(3), 2], pad=[0.0_dp])
      end if
      call archive%pass(self%extremes(:, 1))
      call archive%pass(self%extremes(:, 2))
      do i = 1, n(1)
         call archive%pass(self%reached(:, i))
      end do
      do i = 1, n(2)
         call archive%pass(self%cycles(:, i))
      end do
   end subroutine history_result_visit

   !> Prepares the steps: the condensed body and the model of the history.
   subroutine prepare_history(cache, config, model, last, error)
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the history needs another
      type(config_t), intent(in) :: config !! the deck
      type(history_model_t), intent(out) :: model !! the history
      type(result_t), intent(inout) :: last !! gains what the result of the last step begins with
      type(error_t), allocatable, intent(out) :: error !! the deck is invalid, or the computation failed numerically
      logical :: changes
      integer :: i

      call prepare_case(cache, config, last, error)
      if (allocated(error)) return
      call add_history_warnings(last%warnings, config%history, last%load_case, cache%body%zone%set)
      call condense_case(cache, config, last, error)
      if (.not. allocated(error)) call new_history_model(model, cache%body, cache%problem, last%load_case, config, &
         error)
      if (allocated(error)) return
      changes = .false.
      do i = 1, size(model%history%steps)
         associate (numbers => model%history%steps(i)%table(2:, :))
            changes = changes .or. any(abs(numbers - spread(numbers(:, 1), 2, size(numbers, 2))) > 0.0_dp)
         end associate
      end do
      if (.not. changes) call last%warnings%add('no load, support, obstacle or friction changes over the history')
      call describe_factor(last%factor, cache%body)
   end subroutine prepare_history

   !> Takes the steps until the end, until no step is possible, or until the monitor stops it.
   subroutine take_steps(cache, model, files, monitor, result, error)
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(inout) :: model !! the history
      class(history_files_t), intent(inout) :: files !! gain the steps
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress of the history, and may stop it
      type(history_result_t), intent(inout) :: result !! gains the steps and their extremes
      type(error_t), allocatable, intent(out) :: error !! fields cannot be written
      integer, parameter :: n_between_reports = 64
      integer :: n_kept
      logical :: is_due

      associate (stepping => result%stepping, history => model%history)
         call monitor%report(stepping%n_planned, size(history%planned), 'steps')
         do while (.not. (stepping%is_ended .or. result%is_interrupted))
            n_kept = stepping%n_steps
            call stepping%advance(model, cache%body, cache%problem)
            result%is_interrupted = monitor%is_stopped()
            if (stepping%n_steps == n_kept) exit
            call files%add_step(model, cache%body, stepping)
            call result%record_step(cache%body, model)
            call certify_step(cache, model, files, result, error)
            if (allocated(error)) return
            ! Reports and saves depend on time: a step may take microseconds, or seconds.
            is_due = files%is_due()
            if (is_due .or. modulo(stepping%n_steps, n_between_reports) == 0) call monitor%report(stepping%n_planned, &
               size(history%planned), 'steps')
            if (is_due) call save_progress(files, result, error)
            if (allocated(error)) return
         end do
      end associate
      call result%add_warnings(cache%body)
   end subroutine take_steps

   !> Updates the record of the steps with the last one: largest numbers, extremes and warnings.
   pure subroutine history_result_record_step(self, body, model)
      class(history_result_t), intent(inout) :: self !! the history so far
      type(body_t), intent(in) :: body !! the body
      type(history_model_t), intent(in) :: model !! the history
      type(lengths_t) :: lengths
      type(quantity_t), allocatable :: peaks(:)
      type(quantity_t) :: forces(2)
      real(dp), allocatable :: numbers(:)
      logical :: is_warned(n_case_warnings)

      associate (stepping => self%stepping, state => self%stepping%state, m => body%zone%n_points)
         if (stepping%is_jump) self%n_jumps = self%n_jumps + 1
         call self%worst%update([state%solution%residual, state%imbalance, state%indicator, 0.0_dp, &
            merge(state%indicator, 0.0_dp, stepping%is_jump), state%wear_feedback], stepping%n_steps)
         peaks = contact_peaks(body, state%solution, state%instant%motion)
         forces = resultants(state%solution%force, m, .not. allocated(body%zone%line))
         numbers = [peaks%value, forces%value, model%probed(body, state), &
            state%named]
         if (size(self%extremes) == 0) self%extremes = spread(numbers, 2, 2)
         self%extremes(:, 1) = min(self%extremes(:, 1), numbers)
         self%extremes(:, 2) = max(self%extremes(:, 2), numbers)
         call find_case_warnings(is_warned, body, model%solver%size_of_body, &
            model%solver%loads%contacts_of(state%instant), state%instant%gap, state%solution)
         call self%warned%append(merge(1, 0, is_warned), stepping%n_steps, stepping%n_steps)
         if (stepping%record%is_finished) self%cycles = reshape([self%cycles, stepping%record%numbers], &
            [n_cycle_numbers, size(self%cycles, 2) + 1])
         if (.not. any(abs(state%instant%time - model%history%times) <= 0.0_dp)) return
         call new_lengths(lengths, body%zone, state%solution%status)
         self%reached = reshape([self%reached, state%instant%time, lengths%open, lengths%slip, lengths%stick, &
            forces%value, state%strain_energy, state%load_work + state%support_work + state%obstacle_work, &
            sum(state%dissipation)], &
            [n_reached_numbers, size(self%reached, 2) + 1])
      end associate
   end subroutine history_result_record_step

   !> Adds the numbers of the whole history to the result of the last step: works, the largest accumulated slip, the
   !> numbers of the last cycle, and the extremes of the steps. Those of moments have the scale of forces that balance
   !> each other.
   pure subroutine add_history_results(result, model, body)
      type(history_result_t), intent(inout) :: result !! the history; its last step gains the numbers
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      character(8), parameter :: extreme_words(2) = [character(8) :: 'Least', 'Greatest']
      type(quantity_t), allocatable :: followed(:), list(:), energies(:)
      integer :: i, k

      associate (state => result%stepping%state)
         followed = [contact_peaks(body, state%solution, state%instant%motion), resultants(state%solution%force, &
            body%zone%n_points, .not. allocated(body%zone%line)), model%probe_names, model%named]
      end associate
      energies = energies_of(result%stepping%state)
      list = [energies(:3), energies(5), quantity_t('max_slip_accumulated', 'Max. accumulated slip', max(0.0_dp, &
         maxval(result%stepping%state%accumulated_slip)), dimension='L'), cycle_results(model%history, result%cycles)]
      ! A history that starts at its last time has no steps.
      do i = 1, merge(size(followed), 0, size(result%extremes) > 0)
         do k = 1, 2
            ! The least pressure, shear and slip of a whole line are of no interest.
            if (k == 1 .and. followed(i)%n_dim > 0) cycle
            list = [list, quantity_t(lower_case(trim(extreme_words(k)))//'_'//followed(i)%key, &
               trim(extreme_words(k))//' '//lower_case(followed(i)%label(:1))//followed(i)%label(2:), &
               result%extremes(i, k), max(tiny(1.0_dp), largest_of(followed(i)%dimension), merge(largest_of('F') &
               *model%solver%size_of_body, 0.0_dp, followed(i)%dimension == 'F L')), dimension=followed(i)%dimension)]
         end do
      end do
      call move_alloc(list, result%last%history_results)

   contains

      !> The largest number of one dimension.
      pure real(dp) function largest_of(dimension) result(largest)
         character(*), intent(in) :: dimension !! the dimension

         largest = max(0.0_dp, maxval(abs(result%extremes), mask=spread(followed%dimension == dimension, 2, 2)))
      end function largest_of

   end subroutine add_history_results

   !> The part of the energy error from the first step, at which loads act at once on the body at rest: shorter steps do
   !> not reduce it, only loads that begin at zero. 0 for a history that starts from a saved state [F L].
   pure real(dp) function history_result_error_from_rest(self, history) result(energy_error)
      class(history_result_t), intent(in) :: self !! the history so far
      type(history_t), intent(in) :: history !! the history

      energy_error = 0.0_dp
      if (history%has_start()) return
      ! Strain energy, work and dissipation at the first time.
      associate (energies => self%reached(7:9, 1))
         energy_error = energies(2) - energies(1) - energies(3)
      end associate
   end function history_result_error_from_rest

   !> Records the certificate of the last step.
   pure subroutine history_result_record_certificate(self, violation)
      class(history_result_t), intent(inout) :: self !! the history so far
      real(dp), intent(in) :: violation !! the largest violation of the step [-]

      call self%worst(of_violation)%update(violation, self%stepping%n_steps)
      self%n_certified = self%n_certified + 1
   end subroutine history_result_record_certificate

   !> Records in the result of the last step how the history ended.
   pure subroutine history_result_record_end(self)
      class(history_result_t), intent(inout) :: self !! the history, with its last step

      self%last%is_complete = len(self%stepping%fault) == 0
      self%last%outcome = self%stepping%outcome
      if (self%stepping%n_steps == 0) self%last%answer = self%stepping%fault
   end subroutine history_result_record_end

   !> Warns of jumps, and of displacements and strains of earlier steps that are too large for the theory if those of
   !> the last step are not, which has its own warnings.
   subroutine history_result_add_warnings(self, body)
      class(history_result_t), intent(inout) :: self !! the history; its last step gains the warnings
      type(body_t), intent(in) :: body !! the body
      ! An explicit update of the gaps follows pressures whose share it relieves in a step is well below 1; the stiffest
      ! pattern of pressures, from node to node, is about twice as stiff as a single point.
      real(dp), parameter :: well_below = 0.25_dp
      type(tally_t) :: warned(n_case_warnings)

      associate (n_steps => self%stepping%n_steps, warnings => self%last%warnings)
         associate (feedback => self%worst(of_feedback))
            if (feedback%value > well_below) call warnings%add('the depth worn in step '//to_text(feedback%at)// &
               ' would relieve a contact point of '//short_text(feedback%value)//' times its pressure: from '// &
               short_text(well_below)//' on pressures may swing from step to step; take '// &
               to_text(ceiling(feedback%value/well_below - input_rounding))//' times as many substeps there')
         end associate
         if (self%n_jumps > 0) call warnings%add(to_text(self%n_jumps)//' of '//to_text(n_steps)// &
            ' steps cannot be made shorter although their energy error is above step_tolerance: the state jumps '// &
            'there; most in step '//to_text(self%worst(of_jump)%at)//', '// &
            scientific(self%worst(of_jump)%value)//' of its energies')
         warned = self%warned
         where (warned%last == n_steps .or. .not. is_limit_of_model) warned%n = 0
         call add_tallied_warnings(warnings, warned, n_steps, 'step', body%zone)
      end associate
   end subroutine history_result_add_warnings

   !> Certifies the present step and writes its grids if asked for. If contact reaches the end of a set, penetration
   !> beyond it is checked.
   subroutine certify_step(cache, model, files, result, error)
      type(cache_t), intent(inout) :: cache !! the body; points that slide far are put at their places
      type(history_model_t), intent(in) :: model !! the history
      class(history_files_t), intent(inout) :: files !! gain the grids
      type(history_result_t), intent(inout) :: result !! gains the violation
      type(error_t), allocatable, intent(out) :: error !! the numbers are not finite, or the grids cannot be written
      type(result_t) :: step
      logical :: has_grids

      has_grids = is_shown(result%stepping%n_steps, model%history%fields_every)
      if (.not. (has_grids .or. result%warned(end_of_set)%last == result%stepping%n_steps)) return
      step%wants_error_estimate = result%last%wants_error_estimate
      call new_step_result(step, cache, model, result%stepping, error)
      if (allocated(error)) return
      call result%record_certificate(step%certificate%largest())
      if (has_grids) call files%add_fields(cache%body, result%stepping%n_steps, &
         to_text(result%stepping%state%instant%time), step, error)
   end subroutine certify_step

   !> Makes the result of a step: displacements of all nodes, and their certificate.
   subroutine new_step_result(step, cache, model, stepping, error)
      type(result_t), intent(inout) :: step !! gains load case, solution, displacements and certificate
      type(cache_t), intent(inout) :: cache !! the body; points that slide far are put at their places
      type(history_model_t), intent(in) :: model !! the history
      type(time_stepping_t), intent(in) :: stepping !! the time stepping at the end of the step
      type(error_t), allocatable, intent(out) :: error !! the numbers are not finite

      call model%solver%loads%load_case(cache%body, stepping%state%instant, step%load_case)
      step%load_case%carried_force = stepping%state%carried_force
      step%solution = stepping%state%solution
      if (cache%body%slides_far) call take_places(cache%body, model%solver%loads, stepping%state%instant, step%solution)
      step%slip_record = stepping%point_record(cache%body)
      call certify(step, cache%body, error)
   end subroutine new_step_result

   !> Certifies the last step, adds to it the results that its files show, and completes the tables; without a step
   !> there are none.
   subroutine finish_history(cache, model, files, result, error)
      type(cache_t), intent(inout) :: cache !! the body; its contact problem becomes that of the last step
      type(history_model_t), intent(in) :: model !! the history
      type(history_files_t), intent(inout) :: files !! the files
      type(history_result_t), intent(inout) :: result !! gains the last step
      type(error_t), allocatable, intent(out) :: error
         !! there is no first step, and that is no answer; or the numbers of the last one are not finite

      call result%record_end()
      if (result%stepping%n_steps == 0) then
         ! No equilibrium at the first time is an outcome; a misplaced obstacle is an error.
         associate (stepping => result%stepping)
            if (stepping%fault_kind > 0 .and. stepping%outcome /= outcome_no_equilibrium) call new_error(error, &
               stepping%fault_kind, stepping%fault)
         end associate
         return
      end if
      call result%last%timings%begin(phase_recover)
      associate (state => result%stepping%state)
         call new_step_result(result%last, cache, model, result%stepping, error)
         if (allocated(error)) return
         call result%record_certificate(result%last%certificate%largest())
         call model%solver%loads%pose(cache%body, state%instant, cache%problem)
      end associate
      call add_result_warnings(result%last, cache%body)
      call add_history_results(result, model, cache%body)
      if (.not. cache%body%slides_far) call new_uniqueness(result%last%uniqueness, cache%problem)
      call result%last%timings%begin(phase_write)
      call files%finish(model, result%stepping%n_steps, result%n_resumed, result%files%files, result%files%manifest, &
         error)
   end subroutine finish_history

   !> Adds sections on the history to listing and summary of the last step, with the largest errors of the steps.
   subroutine describe_history(result, config)
      type(history_result_t), intent(inout) :: result !! the history; its last step gains the texts and the violation
      type(config_t), intent(in) :: config !! the deck
      character(13), parameter :: labels(*) = [character(13) :: 'open', 'slip', 'stick', 'normal force', &
         'tang. force', 'strain energy', 'work', 'dissipated']
      character(3) :: dimensions(size(labels))
      type(quantity_t), allocatable :: energies(:), extremes(:), fretting(:)
      real(dp) :: force, length, energy, before(2)
      character(:), allocatable :: text, note, table
      integer :: i, k, n, n_dim, width

      n_dim = size(result%last%load_case%foot, 1)
      result%last%earlier_violation = max(result%worst(of_violation)%value, result%worst(of_identities)%value)
      dimensions = [character(3) :: spread(merge('L^2', 'L  ', n_dim == 3), 1, 3), 'F', 'F', 'F L', &
         'F L', 'F L']
      energies = energies_of(result%stepping%state)
      ! They have a scale, unlike sums over the steps.
      extremes = pack(result%last%history_results, result%last%history_results%scale > 0.0_dp)
      associate (state => result%stepping%state)
         force = max(sum(abs(state%solution%force)), maxval(abs(result%reached(5:6, :))))
         length = max(0.0_dp, maxval(abs(state%solution%displacement)), maxval(abs(result%cycles(9:10, :))))
         energy = max(maxval(abs(energies%value)), maxval(abs(result%reached(7:, :))))
      end associate
      ! Makes the section of the listing.
      associate (history => config%history, stepping => result%stepping)
         text = heading('Load history')
         do i = 1, size(history%steps)
            text = text//labeled('Changes', steps_text(history%steps(i), n_dim))
         end do
         ! Says which loads act in full from the first time on.
         note = ''
         n = 0
         do i = 1, size(config%loads)
            if (.not. any([(config%history%steps(k)%target == stepped_load .and. config%history%steps(k)%name &
               == config%loads(i)%name, k=1, size(config%history%steps))])) n = n + 1
         end do
         if (n > 0) note = labeled('Note', counted(n, 'load')//' without &steps, in full from the first time on')
         text = text//note
         if (len(stepping%fault) > 0) text = text//labeled('INCOMPLETE', stepping%fault)
         text = text//labeled('Steps', to_text(stepping%n_steps)//', row by row in '//config%name//'.history.csv')
         if (history%has_start()) text = text//labeled('Start', history%start)
         if (result%n_resumed > 0) text = text//labeled('Resumed', 'behind step '//to_text(result%n_resumed)// &
            ' of an interrupted run')
         if (stepping%n_rejected > 0) text = text//labeled('Halved', to_text(stepping%n_rejected)//' steps')
         text = text//labeled('Iterations', to_text(stepping%n_iterations)//', '// &
            short_text(real(stepping%n_iterations, dp)/max(1, stepping%n_steps))//' per step')
         do i = 1, size(worst_labels)
            note = scientific(result%worst(i)%value)
            if (result%worst(i)%at > 0) note = note//' in step '//to_text(result%worst(i)%at)
            text = text//labeled(trim(worst_labels(i)), note)
         end do
         text = text//labeled('Certified', counted(result%n_certified, 'step')//'; largest violation '// &
            scientific(result%worst(of_violation)%value)//' in step '//to_text(result%worst(of_violation)%at))
         call result%last%study_listing%add(text)
         text = ''
         if (result%checkpoint%is_anew) text = labeled('Note', 'an interrupted run had left steps of another'// &
            ' deck; all steps were taken anew')
         call result%last%study_listing%record(text)
         text = heading('Energies of the history')//quantities_text(energies, config%units)
         note = ''
         if (abs(result%error_from_rest(history)) > sum_rounding*energy) note = labeled('of it at first', &
            with_unit(short_text(result%error_from_rest(history)), config%units, 'F L')// &
            ' (in the step from rest to the first time, which is not divided)')
         call result%last%study_listing%add(text(:len(text) - 1)// &
            ' (work less strain energy and dissipation; it vanishes with the'//' size of the steps)'//newline//note, &
            [energy])
         ! The states at the times of the deck, with the numbers of the interval before each; columns fit six digits, or
         ! a long unit.
         width = max(14, 1 + n_characters(unit_of(config%units, 'F L')))
         table = heading('States at the times of the deck (work and dissipation: since the time before)')// &
            table_head(history%name(:min(12, len(history%name))), labels, dimensions, config%units, width)
         before = 0.0_dp
         do i = 1, size(result%reached, 2)
            table = table//columns([result%reached(:7, i), result%reached(8:, i) - before], width)//newline
            before = result%reached(8:, i)
         end do
         call result%last%study_listing%add(table, [0.0_dp, spread(0.0_dp, 1, 3), spread(force, 1, 2), spread(energy, &
            1, 3)])
         call result%last%study_listing%add(cycles_table(config, result%cycles, width), [0.0_dp, 0.0_dp, energy, &
            energy, length, length, 1.0_dp])
         fretting = cycle_results(history, result%cycles)
         if (size(fretting) > 1) call result%last%study_listing%add( &
            heading('Fretting, last cycle (largest of all points)')//quantities_text(fretting(2:), config%units))
         if (size(extremes) > 0) call result%last%study_listing%add(heading('Extremes of the steps')// &
            quantities_text(extremes, config%units), [spread(0.0_dp, 1, 3), extremes%scale], is_by_line=.true.)
         call result%last%study_listing%add(heading('Last step')// &
            '  Everything below; max. slip and slips since rest, on the obstacle; stick and slip of the step'//newline)
      end associate
      call result%last%study_members%add(history_members(config, result, [energies, extremes]), &
         [spread(energy, 1, size(energies)), extremes%scale, 0.0_dp])
   end subroutine describe_history

   !> Text naming a change and its least and largest numbers.
   pure function steps_text(steps, n_dim) result(text)
      type(steps_t), intent(in) :: steps !! the change
      integer, intent(in) :: n_dim !! number of dimensions of the body
      character(:), allocatable :: text
      integer :: k

      text = trim(moved_things(steps%target))//" '"//steps%name//"'"
      do k = 1, steps%n_numbers()
         text = text//'; '//steps%label(k, n_dim)//' from '//short_text(minval(steps%table(1 + k, :)))//' to '// &
            short_text(maxval(steps%table(1 + k, :)))
      end do
   end function steps_text

   !> The first line of a table and, if the case names units, the second.
   pure function table_head(first, labels, dimensions, units, width) result(text)
      character(*), intent(in) :: first !! heading of the first column, which has no unit
      character(*), intent(in) :: labels(:) !! headings of the other columns
      character(*), intent(in) :: dimensions(:) !! their dimensions
      character(*), intent(in) :: units !! names of the units of the case
      integer, intent(in) :: width !! width of the columns
      character(:), allocatable :: text
      integer :: i

      text = flush_right(first, width)
      do i = 1, size(labels)
         text = text//flush_right(trim(labels(i)), width)
      end do
      text = text//newline
      if (len_trim(units) == 0) return
      text = text//repeat(' ', width)
      do i = 1, size(dimensions)
         text = text//flush_right(unit_of(units, trim(dimensions(i))), width)
      end do
      text = trim(text)//newline
   end function table_head

   !> The table of the cycles; of many cycles the last ones.
   pure function cycles_table(config, cycles, width) result(text)
      type(config_t), intent(in) :: config !! the deck
      real(dp), intent(in) :: cycles(:, :) !! the cycles that ended (n_cycle_numbers, n)
      integer, intent(in) :: width !! width of the columns
      character(:), allocatable :: text
      integer, parameter :: most_shown = 20
      character(10), parameter :: labels(*) = [character(10) :: 'end', 'work', 'dissipated', 'max. slip', &
         'max. drift', 'd dissip.', 'd forces', 'outcome']
      character(3), parameter :: dimensions(size(labels)) = [character(3) :: '', 'F L', 'F L', 'L', 'L', '', '', '']
      integer :: i, n, n_passed

      text = ''
      n = size(cycles, 2)
      if (n == 0) return
      n_passed = max(0, n - most_shown)
      text = heading('Cycles (d: changes from the one before, over the larger)')//table_head('cycle', labels, &
         dimensions, config%units, width)
      do i = n_passed + 1, n
         text = text//flush_right(to_text(nint(cycles(1, i))), width)//columns(cycles([3, 5, 7, 9, 10, 11, 12], i), &
            width)//flush_right(trim(cycle_outcomes(nint(cycles(n_plain_numbers, i)))), width)//newline
      end do
      if (n_passed > 0) text = text//labeled('Note', 'the first '//to_text(n_passed)//' of '//to_text(n)// &
         ' cycles are in '//config%name//'.cycles.csv')
   end function cycles_table

   !> The members of the summary that a history has besides those of a case.
   function history_members(config, result, numbers) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(history_result_t), intent(in) :: result !! the result
      type(quantity_t), intent(in) :: numbers(:) !! energies and extremes
      character(:), allocatable :: text
      integer :: i, k, since

      associate (stepping => result%stepping, state => result%stepping%state, &
         n_dim => size(result%last%load_case%foot, 1))
         text = '{'//quantity_members(numbers)//', "complete": '//json_logical(len(stepping%fault) == 0)// &
            ', "end": '//json_string(stepping%fault)
         if (len(stepping%fault) > 0) text = text//', "end_time": '//json_number(stepping%fault_time)
         text = text//', "steps": '//to_text(stepping%n_steps)//', "steps_done_earlier": '// &
            to_text(result%n_resumed)//', "steps_given_up": '// &
            to_text(stepping%n_rejected)//', "iterations": '//to_text(stepping%n_iterations)//', "changes": ['
         do i = 1, size(config%history%steps)
            do k = 1, config%history%steps(i)%n_numbers()
               if (i > 1 .or. k > 1) text = text//', '
               text = text//json_string(config%history%steps(i)%label(k, n_dim))
            end do
         end do
         text = text//'], "time": '//json_number(state%instant%time)
      end associate
      do i = 1, size(worst_names)
         text = text//', "'//trim(worst_names(i))//'": '//json_number(result%worst(i)%value)//', "'// &
            trim(worst_names(i))//'_step": '//to_text(result%worst(i)%at)
      end do
      ! Number of cycles, class of the last one, and the first cycle of this class without interruption.
      associate (cycles => result%cycles, n => size(result%cycles, 2))
         since = n
         do while (since > 1)
            if (nint(cycles(n_plain_numbers, since - 1)) /= nint(cycles(n_plain_numbers, n))) exit
            since = since - 1
         end do
         if (n > 0) text = text//', "cycles": '//to_text(n)//', "cycle_outcome": '// &
            json_string(trim(cycle_outcomes(nint(cycles(n_plain_numbers, n)))))//', "cycle_outcome_since": '// &
            to_text(nint(cycles(1, since)))//', '//quantity_members(cycle_results(config%history, cycles))
      end associate
      text = member('load_history', text//'}')
   end function history_members

   !> Checks the history and reports its size.
   subroutine history_study_check(self, cache, outcome, error)
      class(history_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the history needs another
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! the faults of the deck
      type(config_t) :: config
      type(result_t) :: result
      integer, allocatable :: probes(:)

      config = self%config
      config%meshes%n_refinements = config%meshes%n_refinements + config%accuracy%n_refinements
      associate (history => config%history)
         call prepare_case(cache, config, result, error)
         if (allocated(error)) return
         call add_history_warnings(result%warnings, history, result%load_case, cache%body%zone%set)
         call report_size(config, ', '//counted(size(history%planned), 'step'), cache, result, outcome, error)
         if (.not. allocated(error)) call find_probes(probes, history, cache%body, error)
         if (allocated(error)) outcome%text = ''
      end associate
   end subroutine history_study_check

   !> Takes all steps on one mesh after the other, if the deck asks for refined meshes, and judges the convergence of
   !> the numbers of the last step. The history on a coarser mesh has only the files that resuming it needs.
   subroutine solve_on_meshes(cache, config, directory, monitor, result, mesh, error)
      type(cache_t), intent(inout) :: cache !! the present body, replaced by that of the last mesh
      type(config_t), intent(inout) :: config !! the deck; becomes that of the last mesh
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress of the history, and may stop it
      type(history_result_t), intent(out) :: result !! the result on the last mesh
      character(:), allocatable, intent(out) :: mesh !! text naming this mesh: ' on mesh 2'; empty if there is one mesh
      type(error_t), allocatable, intent(out) :: error
         !! the deck is invalid, the computation failed numerically, or a file cannot be written
      type(config_t) :: coarse
      type(checkpoint_t) :: done(config%accuracy%n_refinements)
      type(quantity_t), allocatable :: list(:)
      real(dp), allocatable :: values(:, :)
      integer :: level, i

      config%meshes%n_finest = config%meshes%n_refinements + size(done)
      config%accuracy%n_refinements = 0
      mesh = ''
      do level = 1, size(done)
         mesh = ' on mesh '//to_text(level)
         coarse = config
         coarse%name = config%name//'.mesh_'//to_text(level)
         coarse%history%points_every = 0
         coarse%history%states_every = 0
         coarse%history%fields_every = 0
         call solve_history(cache, coarse, directory, monitor, result, error)
         if (allocated(error) .or. result%is_interrupted) return
         done(level) = result%checkpoint
         call done(level)%close()
         ! A mesh on which the history does not reach its end is the last one; its files report this.
         if (.not. result%last%is_complete) exit
         list = refined_quantities(result%last)
         if (level == 1) allocate (values(size(list), 1 + size(done)))
         values(:, level) = list%value
         config%meshes%n_refinements = config%meshes%n_refinements + 1
      end do
      if (size(done) > 0) mesh = ' on mesh '//to_text(level)
      call solve_history(cache, config, directory, monitor, result, error)
      if (allocated(error) .or. result%is_interrupted) return
      do i = 1, min(level, size(done))
         call done(i)%discard()
      end do
      if (size(done) == 0 .or. level <= size(done) .or. .not. result%last%is_complete) return
      list = refined_quantities(result%last)
      values(:, level) = list%value
      call judge_meshes(result%last, cache%body, values)
   end subroutine solve_on_meshes

   !> Takes the steps and writes their files.
   subroutine history_study_solve(self, cache, options, monitor, outcome, error)
      class(history_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the history needs another
      type(study_options_t), intent(in) :: options !! the options that are not in the deck
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress of the history, and may stop it
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what is lacking, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the history cannot be solved or written
      type(history_result_t) :: result
      type(config_t) :: config
      character(:), allocatable :: word
      real(dp) :: from_rest

      config = self%config
      call solve_on_meshes(cache, config, options%directory, monitor, result, word, error)
      call take_no_equilibrium(result%last, error)
      if (allocated(error)) return
      if (allocated(result%last%answer)) then
         call report_answer(options%directory, config, cache%body, result%last, outcome, error, result%files)
         return
      end if
      if (result%is_interrupted) then
         call outcome%interrupt('step '//to_text(result%stepping%n_steps)//word)
         return
      end if
      if (len(result%stepping%fault) > 0) then
         word = word_not_converged
         if (result%stepping%outcome == outcome_no_equilibrium) word = word_no_equilibrium
         if (result%stepping%outcome == outcome_numbers) word = word_numerical_failure
         call outcome%lack(word, result%stepping%fault)
         ! Memory may have run out.
         if (result%stepping%outcome == outcome_numbers) outcome%status = result%stepping%fault_kind
      end if
      outcome%warnings = result%last%warnings
      call describe_history(result, config)
      call write_report(options%directory, config, cache%body, result%last, error, result%files)
      if (.not. allocated(error)) call result%checkpoint%remove()
      call result%checkpoint%close()
      if (allocated(error)) return
      from_rest = result%error_from_rest(self%config%history)
      associate (stepping => result%stepping)
         outcome%text = self%config%name//': '//counted(stepping%n_steps, 'step')//', '//trim(merge('all solved', &
            'INCOMPLETE', len(stepping%fault) == 0))//', residual at most '// &
            scientific(result%worst(of_residual)%value)// &
            '; dissipation '//with_unit(short_text(sum(stepping%state%dissipation)), self%config%units, 'F L')// &
            ', energy error '//with_unit(short_text(stepping%state%energy_error() - from_rest), self%config%units, &
            'F L')
         if (abs(from_rest) > sum_rounding*stepping%state%strain_energy) outcome%text = outcome%text// &
            ' and, in the first step from rest, '//with_unit(short_text(from_rest), self%config%units, 'F L')
      end associate
      outcome%numbers = [quantity_t('iterations', '', real(result%stepping%n_iterations, dp)), &
         quantity_t('residual', '', result%worst(of_residual)%value), result%last%key_results, &
         resultants(result%last%solution%force, size(result%last%solution%status), result%last%lengths%are_areas)]
      outcome%has_grids = result%last%is_complete
      if (result%last%is_complete) call outcome%judge(.true., result%worst(of_residual)%value, &
         result%last%earlier_violation, self%config%method%tolerance, result%last%condition)
   end subroutine history_study_solve

   !> The energies and works of a history; the error is that of the time stepping.
   pure function energies_of(state) result(list)
      type(step_state_t), intent(in) :: state !! the last state
      type(quantity_t), allocatable :: list(:)

      list = [quantity_t('work_loads', 'Work of loads', state%load_work), &
         quantity_t('work_supports', 'Work of supports', state%support_work), &
         quantity_t('work_obstacles', 'Work of obstacles', state%obstacle_work), &
         quantity_t('strain_energy', 'Strain energy', state%strain_energy), &
         quantity_t('dissipation', 'Dissipation', sum(state%dissipation)), &
         quantity_t('energy_error', 'Energy error', state%energy_error())]
      list%dimension = 'F L'
   end function energies_of

   !> The numbers of the last cycle, with its largest fretting parameters if the deck asks for them; empty without a
   !> cycle.
   pure function cycle_results(history, cycles) result(list)
      type(history_t), intent(in) :: history !! the history
      real(dp), intent(in) :: cycles(:, :) !! the cycles that ended (n_cycle_numbers, n)
      type(quantity_t), allocatable :: list(:)
      integer :: n

      n = size(cycles, 2)
      allocate (list(0))
      if (n == 0) return
      associate (last => cycles(:, n))
         list = [quantity_t('cycle_dissipation', 'Dissipation of cycle', last(7), dimension='F L')]
         if (history%has_fretting) list = [list, &
            quantity_t('max_ruiz_1', 'Ruiz 1', last(n_plain_numbers + 1), dimension='F/L'), &
            quantity_t('max_ruiz_2', 'Ruiz 2', last(n_plain_numbers + 2), dimension='F^2/L^3'), &
            quantity_t('max_swt', 'SWT', last(n_cycle_numbers), dimension='F/L^2')]
      end associate
   end function cycle_results

end module amontons_history_study
