!> The study of a sweep: all cases of a deck with `&sweep` with one factorization, solved on all threads of all ranks,
!> and their files, which are written as a whole or not at all.
!>
!> A batch consists of as many chunks as take about a second; after it the rows are saved, so that an interrupted sweep
!> continues there.
!>
!> Chunks with cases whose fields are asked for are solved again, with the same solutions: so an interrupted
!> sweep need not store any, and a sweep without fields keeps none.
module amontons_sweep_study
   use amontons_body, only: body_t
   use amontons_checkpoint, only: archive_t, checkpoint_t, new_checkpoint
   use amontons_config, only: config_t, effective_deck
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_document, only: document_t, json_logical, json_number, json_string
   use amontons_error, only: new_error, error_t
   use amontons_kinds, only: dp
   use amontons_listing, only: certificate_text, factorization_text, head_text, listed_phases, method_text, &
      model_text, quantities_text, times_text, warnings_text
   use amontons_manifest, only: case_entries, collection_head, collection_tail, manifest_t
   use amontons_output_file, only: hold_signals, output_file_t, release_signals, remove_temporaries, write_text_file
   use amontons_quantity, only: quantity_t, scales
   use amontons_report, only: commit_case, write_documents, add_head, certificate_member, last_members, member, &
      quantities_member, size_counts
   use amontons_result, only: outcome_numbers, word_numerical_failure, certificate_limit, outcome_names, &
      outcome_no_equilibrium, outcome_not_converged, outcome_solved, result_t, solution_word, word_no_equilibrium, &
      word_not_converged, word_solved
   use amontons_result_warnings, only: add_conditioning, add_tallied_warnings
   use amontons_solve_case, only: cache_t, certify, condense_case, describe_factor, take_no_equilibrium
   use amontons_study, only: outcome_t, report_answer, report_size, study_monitor_t, study_options_t, study_t
   use amontons_sweep, only: swept_load
   use amontons_sweep_chunk, only: case_keys, chunk_length, chunk_t, new_case, new_chunk, outcome_labels, &
      prepare_sweep, ranked_quantities, solve_cases, sweep_header, sweep_statistics_t, sweep_task_t
   use amontons_sweep_ranks, only: end_sharing, prepare_on_ranks, solve_on_ranks
   use amontons_system, only: make_directory, wall_seconds
   use amontons_terminal, only: phase_recover, phase_solve, phase_write
   use amontons_text, only: as_lines, counted, flush_right, heading, labeled, newline, put_text, scientific, &
      short_text, to_text, with_unit
   use amontons_threads, only: n_threads
   use amontons_version, only: version
   use amontons_vtu, only: write_grids
   implicit none (type, external)
   private

   public :: evaluate_case, n_documents, new_sweep_summary, sweep_documents, sweep_result_t, sweep_study_t

   !> Message of summary and screen on a sweep without any equilibrium.
   character(*), parameter :: nothing_balances = &
      'no case has an equilibrium: contact and friction cannot balance the loads of any'

   !> The result of a sweep. Its rows and its fields are in files.
   type :: sweep_result_t
      type(result_t) :: certified
         !! the converged case with the largest error estimate of its forces, certified on the full model, with that of
         !! its stresses if it is asked for; its times are those of the sweep
      type(sweep_statistics_t) :: statistics !! counts and extremes
      type(checkpoint_t) :: checkpoint !! the table, still under its temporary name
      type(output_file_t), allocatable :: collection
         !! the collection of the fields, if there is one, still under its temporary name
      type(manifest_t) :: grids !! the manifest of the fields
      integer :: n_resumed = 0 !! number of cases that an earlier run had done
      integer :: n_sharing = 1 !! number of ranks that share the others
      character(:), allocatable :: fault !! the message of the first case with a numerical failure; empty without any
      logical :: is_interrupted = .false. !! whether cases are left to do
   contains
      procedure :: cases_per_second => sweep_result_cases_per_second
   end type sweep_result_t

   !> Number of text files other than the summary.
   integer, parameter :: n_documents = 2

   !> The study of a sweep.
   type, extends(study_t) :: sweep_study_t
   contains
      procedure :: check => sweep_study_check
      procedure :: solve => sweep_study_solve
   end type sweep_study_t

contains

   !> Solves all cases of a sweep that no earlier run has solved. The table keeps its temporary name and its lock until
   !> it is reported, unless the sweep was interrupted.
   subroutine solve_sweep(cache, config, directory, monitor, result, error)
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the sweep needs another
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress of the sweep, and may stop it
      type(sweep_result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error
         !! the deck is invalid, the computation failed numerically, or a file cannot be written
      type(sweep_task_t) :: task

      call prepare_sweep(task, cache, config, result%certified, error)
      if (allocated(error)) return
      call condense_case(cache, config, result%certified, error)
      if (allocated(error)) return
      call describe_factor(result%certified%factor, cache%body)
      call prepare_on_ranks(result%n_sharing, task, cache, config, error)
      if (.not. allocated(error)) call solve_batches(task, cache, directory, config, monitor, result, error)
      call end_sharing(result%n_sharing)
      if (.not. allocated(error)) then
         call result%certified%timings%begin(phase_write)
         result%is_interrupted = result%statistics%n_cases < task%sweep%n_cases()
         if (.not. result%is_interrupted .and. task%sweep%n_fields() > 0) call write_sweep_fields(result%collection, &
            result%grids, task, cache%body, cache%problem, directory//'/'//config%name, monitor, &
            result%is_interrupted, error)
      end if
      if (.not. (allocated(error) .or. result%is_interrupted)) call finish_sweep(task, cache, result, error)
      if (allocated(error) .or. result%is_interrupted) call result%checkpoint%close()
   end subroutine solve_sweep

   !> Solves the case with the largest error estimate again and certifies it on the full model; and the first case with
   !> a numerical failure, for its message.
   subroutine finish_sweep(task, cache, result, error)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(cache_t), intent(inout) :: cache !! the body; its contact problem becomes that of some case
      type(sweep_result_t), intent(inout) :: result !! gains the case and its certificate, and the reason
      type(error_t), allocatable, intent(out) :: error !! numbers of the case are not finite
      type(chunk_t) :: chunk
      type(contact_solution_t) :: solutions(chunk_length)
      integer :: number

      call result%certified%timings%begin(phase_recover)
      number = result%statistics%failed_case
      if (number > 0) then
         call new_chunk(chunk, number - 1 - mod(number - 1, chunk_length), number)
         call solve_cases(task, cache%body, cache%problem, chunk, solutions)
         result%fault = chunk%fault
         if (len(chunk%fault) == 0) result%fault = 'its forces or displacements leave the range of double precision'
      end if
      number = result%statistics%force_error%at
      associate (certified => result%certified)
         if (number > 0) then
            call new_chunk(chunk, number - 1 - mod(number - 1, chunk_length), number)
            call solve_cases(task, cache%body, cache%problem, chunk, solutions)
            call evaluate_case(certified, task, cache%body, number, solutions(number - chunk%first + 1), error)
            if (allocated(error)) return
            call add_conditioning(certified, cache%body)
         end if
         call add_tallied_warnings(certified%warnings, result%statistics%warned, result%statistics%n_cases, 'case', &
            cache%body%zone)
         call certified%timings%begin(phase_write)
      end associate
   end subroutine finish_sweep

   !> Computes the results of a case on the full model, and its certificate.
   subroutine evaluate_case(result, task, body, number, solution, error)
      type(result_t), intent(inout) :: result !! gains solution, load case, and what follows
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the case
      type(contact_solution_t), intent(in) :: solution !! its solution
      type(error_t), allocatable, intent(out) :: error !! numbers of the case are not finite

      result%solution = solution
      result%wants_error_estimate = task%wants_error_estimate
      call new_case(result%load_case, task, body, number)
      call certify(result, body, error)
   end subroutine evaluate_case

   !> Opens the table, with the rows of an earlier run if there are any, and solves batch after batch until all cases
   !> are done or the monitor stops the sweep.
   subroutine solve_batches(task, cache, directory, config, monitor, result, error)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(cache_t), intent(in) :: cache !! the body
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(config_t), intent(in) :: config !! the deck
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress of the sweep, and may stop it
      type(sweep_result_t), intent(inout) :: result !! gains the table, and the statistics of its rows
      type(error_t), allocatable, intent(out) :: error
         !! the table cannot be written, or another run writes it; memory ran out
      real(dp), parameter :: batch_seconds = 1.0_dp
      type(chunk_t), allocatable :: chunks(:)
      type(archive_t), allocatable :: progress
      type(manifest_t) :: files
      character(:), allocatable :: rows
      real(dp) :: start, growth
      integer :: n_cases, n_chunks, i, length

      call result%certified%timings%begin(phase_solve)
      call make_directory(directory, error)
      if (allocated(error)) return
      associate (statistics => result%statistics, stem => directory//'/'//config%name//'.sweep')
         call new_checkpoint(result%checkpoint, stem)
         call result%checkpoint%add_table(stem//'.part', sweep_header(config%sweep, case_keys(cache%body, &
            config%sweep)))
         call result%checkpoint%open('! Amontons '//version//', a sweep under way; files '// &
            files%fingerprint(cache%body%mesh, config%contacts, config%loads)//newline//effective_deck(config), &
            progress, error)
         if (allocated(error)) return
         if (allocated(progress)) call statistics%visit(progress)
         result%n_resumed = statistics%n_cases
         n_cases = int(task%sweep%n_cases())
         n_chunks = result%n_sharing*n_threads()
         call monitor%report(statistics%n_cases, n_cases, 'cases')
         do while (statistics%n_cases < n_cases .and. .not. monitor%is_stopped())
            start = wall_seconds()
            allocate (chunks(min(n_chunks, (n_cases - statistics%n_cases - 1)/chunk_length + 1)))
            do i = 1, size(chunks)
               call new_chunk(chunks(i), statistics%n_cases + (i - 1)*chunk_length, n_cases)
            end do
            call solve_on_ranks(result%n_sharing, task, cache, monitor, chunks)
            i = findloc(chunks%is_broken(), .true., dim=1)
            if (i > 0) call new_error(error, chunks(i)%fault_kind, chunks(i)%fault)
            if (allocated(error)) return
            ! The chunks that are done, as far as no chunk is missing before them.
            chunks = chunks(:findloc([chunks%is_done, .false.], .false., dim=1) - 1)
            allocate (character(sum([(len(chunks(i)%rows), i=1, size(chunks))])) :: rows)
            length = 0
            do i = 1, size(chunks)
               call put_text(rows, length, chunks(i)%rows)
               call statistics%append(chunks(i)%statistics)
            end do
            call result%checkpoint%add_rows(1, rows)
            progress = archive_t()
            call statistics%visit(progress)
            if (len(rows) > 0) call result%checkpoint%save(progress, error)
            if (allocated(error)) return
            deallocate (chunks, rows)
            call monitor%report(statistics%n_cases, n_cases, 'cases')
            growth = min(4.0_dp, batch_seconds/max(wall_seconds() - start, tiny(1.0_dp)))
            n_chunks = max(result%n_sharing*n_threads(), int(n_chunks*growth))
         end do
      end associate
   end subroutine solve_batches

   !> Number of cases per second in this run; 0 if it had none to solve.
   pure real(dp) function sweep_result_cases_per_second(self) result(rate)
      class(sweep_result_t), intent(in) :: self !! the result

      rate = (self%statistics%n_cases - self%n_resumed)/max(self%certified%timings%seconds(phase_solve), &
         epsilon(1.0_dp))
   end function sweep_result_cases_per_second

   !> Writes NAME.sweep/NUMBER.vtu and NAME.sweep/NUMBER.contact.vtu of the cases that converged, and NAME.sweep.pvd,
   !> which keeps its temporary name. The latter is not written if there is no such case, after an error, or if the
   !> monitor stops the sweep.
   ! allow(S902): two results, the sweep with body and problem, and what every writer of many files has
   subroutine write_sweep_fields(file, manifest, task, body, problem, stem, monitor, is_stopped, error)
      type(output_file_t), allocatable, intent(out) :: file !! the finished collection, if there is one
      type(manifest_t), intent(out) :: manifest !! the manifest of the grids
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      character(*), intent(in) :: stem !! directory and name of the case
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress, and may stop it
      logical, intent(out) :: is_stopped !! whether it did
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      character(:), allocatable :: folder, entry, entries(:)
      type(contact_solution_t) :: solutions(chunk_length)
      type(result_t) :: result
      type(chunk_t) :: chunk
      integer :: n_cases, n_before, n_entries, slash, number, i

      is_stopped = .false.
      slash = index(stem, '/', back=.true.)
      folder = stem(slash + 1:)//'.sweep/'
      call make_directory(stem//'.sweep', error)
      if (allocated(error)) return
      call remove_temporaries(stem//'.sweep/')
      n_cases = int(task%sweep%n_cases())
      entry = case_entries(to_text(n_cases), folder//to_text(n_cases))
      allocate (character(len(entry)) :: entries(task%sweep%n_fields()))
      n_entries = 0
      do n_before = 0, n_cases - 1, chunk_length
         call new_chunk(chunk, n_before, n_cases)
         if (.not. task%sweep%has_fields(chunk%first, chunk%last)) cycle
         is_stopped = monitor%is_stopped()
         if (is_stopped) exit
         call solve_cases(task, body, problem, chunk, solutions)
         do number = chunk%first, chunk%last
            i = number - chunk%first + 1
            if (.not. task%sweep%has_fields(number, number) .or. chunk%results(i)%outcome /= outcome_solved) cycle
            call evaluate_case(result, task, body, number, solutions(i), error)
            if (allocated(error)) return
            call write_grids(manifest, task%units, stem(:slash), folder//to_text(number), body, result, error)
            if (allocated(error)) return
            entry = case_entries(to_text(number), folder//to_text(number))
            n_entries = n_entries + 1
            entries(n_entries) = entry(:len(entry) - 1)
         end do
         call monitor%report((chunk%last - 1)/task%sweep%fields_every + 1, int(task%sweep%n_fields()), 'fields')
      end do
      if (is_stopped .or. n_entries == 0) return
      allocate (file)
      call write_text_file(file, stem//'.sweep.pvd', collection_head//as_lines(entries(:n_entries))// &
         collection_tail, error)
   end subroutine write_sweep_fields

   !> Writes NAME.lst, NAME.deck.nml and NAME.summary.json and gives NAME.sweep.csv and, if there are fields,
   !> NAME.sweep.pvd their final names. The files get them when all are complete; the checkpoint is removed last.
   subroutine write_sweep_report(directory, config, body, result, error)
      character(*), intent(in) :: directory !! output directory
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(inout) :: result !! the result of all cases; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(n_documents + 2 + merge(1, 0, allocated(result%collection)))
      type(document_t) :: documents(n_documents), summary
      type(manifest_t) :: manifest
      character(:), allocatable :: stem

      stem = directory//'/'//config%name
      call sweep_documents(documents, config, body, result)
      call write_documents(files, stem, documents, error)
      associate (n => size(files) - 1)
         if (allocated(result%collection)) files(n - 1) = result%collection
         manifest = result%grids
         if (.not. allocated(error)) call manifest%add_outputs(files(:n - 1), '', error)
         call result%checkpoint%table_file(files(n), 1, stem//'.sweep.csv')
      end associate
      if (.not. allocated(error)) then
         associate (load_case => result%certified%load_case, table => result%checkpoint%checksum(1))
            call manifest%outputs%append_known(config%name//'.sweep.csv', table%n_bytes, table%value())
            call manifest%add_inputs(body%mesh, load_case%contacts, load_case%loads)
         end associate
         call result%certified%timings%begin(phase_write)
         call new_sweep_summary(summary, config, body, result)
      end if
      call hold_signals()
      call commit_case(files, manifest, directory, config%name, summary, error)
      if (.not. allocated(error)) call result%checkpoint%remove()
      call result%checkpoint%close()
      call release_signals()
   end subroutine write_sweep_report

   !> Makes the text files of a sweep, except for the table and the summary.
   subroutine sweep_documents(documents, config, body, result)
      type(document_t), intent(out) :: documents(n_documents) !! the files: listing and deck
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result of all cases
      integer, parameter :: width = 14
      type(quantity_t), allocatable :: list(:)
      character(:), allocatable :: text
      integer :: name_width, i

      documents(1)%ending = '.lst'
      documents(2)%ending = '.deck.nml'
      call documents(2)%add(config%deck_text())
      call documents(1)%record(head_text(config))
      associate (listing => documents(1), certified => result%certified, statistics => result%statistics, &
         units => config%units)
         call listing%add(warnings_text(certified%warnings))
         call listing%add(model_text(body, certified%load_case, units)//list_axes(config))
         ! How the cases were solved.
         call listing%add(heading('Solution')//labeled('Method', method_text(config%method)))
         call listing%record(labeled('Factorization', factorization_text(certified)))
         text = labeled('Converged', to_text(statistics%n_outcomes(outcome_solved))//' of '// &
            to_text(statistics%n_cases)//' cases')
         do i = 1, size(outcome_labels)
            if (i /= outcome_solved .and. statistics%n_outcomes(i) > 0) text = text// &
               labeled(trim(outcome_labels(i)), counted(statistics%n_outcomes(i), 'case'))
         end do
         text = text//labeled('Iterations', to_text(statistics%n_iterations)//', '// &
            scientific(real(statistics%n_iterations, dp)/max(1, statistics%n_cases))//' per case')
         if (statistics%residual%at > 0) text = text//labeled('Largest residual', &
            scientific(statistics%residual%value)//' in case '//to_text(statistics%residual%at)//', tolerance '// &
            scientific(config%method%tolerance))
         call listing%add(text)
         text = ''
         if (result%n_resumed > 0) text = labeled('Done earlier', counted(result%n_resumed, 'case'))
         if (result%checkpoint%is_anew) text = text// &
            labeled('Note', 'the rows of an interrupted run are damaged or '// &
            'of another deck or version: all cases were solved again')
         text = text//labeled('Cases per second', short_text(result%cases_per_second()))
         if (result%n_sharing > 1) text = text//labeled('Solved by', counted(result%n_sharing, 'rank'))
         call listing%record(text)
         if (statistics%residual%at > 0) then
            list = ranked_quantities(body, config%sweep)
            name_width = maxval(len_trim(list%key))
            text = heading('Extremes of the cases that converged')//repeat(' ', name_width + 2)// &
               flush_right('least', width)// &
               flush_right('in case', width)//flush_right('greatest', width)//flush_right('in case', width)//newline
            do i = 1, size(list)
               text = text//'  '//list(i)%key(:name_width)//with_unit( &
                  flush_right(short_text(-statistics%extremes(i, 1)%value), width)// &
                  flush_right(to_text(statistics%extremes(i, 1)%at), width)// &
                  flush_right(short_text(statistics%extremes(i, 2)%value), width)// &
                  flush_right(to_text(statistics%extremes(i, 2)%at), width), units, trim(list(i)%dimension))//newline
            end do
            call listing%add(text)
            ! The certificate of the case with the largest error estimate, and how accurate its stresses are.
            text = certificate_text(certified%certificate, certified%method%tolerance)// &
               labeled('Worst case', to_text(statistics%force_error%at)//', by the estimated error of its forces')
            if (allocated(certified%error_estimate)) text = text//heading('Accuracy of the worst case '// &
               '(energy norm of the stress error)')//quantities_text(certified%error_estimate%quantities(), units)
            call listing%add(text, [1.0_dp])
         end if
         call listing%record(times_text(certified%timings, listed_phases))
      end associate
   end subroutine sweep_documents

   !> Text describing what varies, and in which combination; of many values the first and the last ones.
   pure function list_axes(config) result(text)
      type(config_t), intent(in) :: config !! the deck
      character(:), allocatable :: text, values
      integer, parameter :: n_shown = 8
      integer :: i, k

      text = heading('Sweep')
      do i = 1, size(config%sweep%axes)
         associate (axis => config%sweep%axes(i), n => size(config%sweep%axes(i)%values))
            values = axis%label()//': '
            if (axis%target == swept_load) values = "factor of load '"//axis%name//"': "
            values = values//counted(n, 'value')//', '
            do k = 1, n
               if (k == n_shown .and. n > n_shown) values = values//'... '
               if (k >= n_shown .and. k < n) cycle
               values = values//short_text(axis%values(k))
               if (k < n) values = values//', '
            end do
            text = text//labeled(trim(merge('along with', 'vary      ', axis%is_paired)), values)
         end associate
      end do
      text = text//labeled('Cases', to_text(config%sweep%n_cases())//', row by row in '//config%name//'.sweep.csv')
      if (config%sweep%n_fields() > 0) text = text//labeled('Fields', 'of '//to_text(config%sweep%n_fields())// &
         ' cases, those that converged, in '//config%name//'.sweep.pvd')
   end function list_axes

   !> Makes the summary of a sweep.
   subroutine new_sweep_summary(summary, config, body, result)
      type(document_t), intent(out) :: summary !! the summary
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result
      type(quantity_t), allocatable :: list(:)
      character(:), allocatable :: text
      integer :: i

      associate (statistics => result%statistics, certified => result%certified, &
         certificate => result%certified%certificate, limit => certificate_limit(config%method%tolerance))
         text = statistics%outcome()
         if (text == word_solved) text = solution_word(.true., certificate%largest() <= limit)
         call add_head(summary, config, config%method%method, text, certified%warnings)
         if (statistics%outcome() == word_no_equilibrium) call summary%add(member('message', &
            json_string(nothing_balances)))
         call summary%add(member('iterations', to_text(statistics%n_iterations)))
         ! Counts of the cases, and how fast they were solved.
         text = '"cases": '//to_text(statistics%n_cases)
         do i = 1, size(outcome_names)
            if (i /= outcome_numbers .or. statistics%failed_case > 0) text = text//', "'//trim(outcome_names(i))// &
               '": '//to_text(statistics%n_outcomes(i))
         end do
         call summary%add(member('sweep', '{'//text//', "done_earlier": '//to_text(result%n_resumed)// &
            ', "cases_per_second": '//json_number(result%cases_per_second())//'}'))
         text = ''
         do i = 1, size(config%sweep%axes)
            associate (axis => config%sweep%axes(i))
               text = text//', {"name": '//json_string(axis%label())//', "values": '//to_text(size(axis%values))// &
                  ', "least": '//json_number(minval(axis%values))//', "greatest": '// &
                  json_number(maxval(axis%values))//', "paired": '//json_logical(axis%is_paired)//'}'
            end associate
         end do
         call summary%add(member('quantities', '['//text(3:)//']'))
         if (statistics%residual%at > 0) then
            call summary%add(member('residual', json_number(statistics%residual%value)))
            text = ''
            list = ranked_quantities(body, config%sweep)
            do i = 1, size(list)
               associate (least => statistics%extremes(i, 1), greatest => statistics%extremes(i, 2))
                  text = text//', '//json_string(trim(list(i)%key))//': {"least": '//json_number(-least%value)// &
                     ', "least_case": '//to_text(least%at)//', "greatest": '//json_number(greatest%value)// &
                     ', "greatest_case": '//to_text(greatest%at)//'}'
               end associate
            end do
            call summary%add(member('extremes', '{'//text(3:)//'}'))
            ! The certificate of the case with the largest error estimate, and how accurate its stresses are.
            call summary%add(certificate_member(certificate%violations(), limit, certificate%energies(), '"case": '// &
               to_text(statistics%force_error%at)//', '), [1.0_dp, 1.0_dp, scales([certificate%violations(), &
               certificate%energies()])])
            if (allocated(certified%error_estimate)) call summary%add(quantities_member('accuracy', &
               certified%error_estimate%quantities()), scales(certified%error_estimate%quantities()))
         end if
         if (certified%condition > 0.0_dp) call summary%record(member('condition', json_number(certified%condition)))
         call summary%add(member('counts', '{'//size_counts(body)//'}'))
         call summary%record(last_members(certified%timings))
      end associate
   end subroutine new_sweep_summary

   !> Checks the sweep and reports its size.
   subroutine sweep_study_check(self, cache, outcome, error)
      class(sweep_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the sweep needs another
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! the faults of the deck
      type(sweep_task_t) :: task
      type(result_t) :: result
      character(:), allocatable :: cases

      associate (sweep => self%config%sweep)
         cases = ', '//counted(int(sweep%n_cases()), 'case')
         if (sweep%n_fields() > 0) cases = cases//', fields of '//to_text(sweep%n_fields())
      end associate
      call prepare_sweep(task, cache, self%config, result, error)
      if (.not. allocated(error)) call report_size(self%config, cases, cache, result, outcome, error)
   end subroutine sweep_study_check

   !> Solves the cases, writes their files and judges the sweep by its statistics and by the certificate of one case.
   subroutine sweep_study_solve(self, cache, options, monitor, outcome, error)
      class(sweep_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the sweep needs another
      type(study_options_t), intent(in) :: options !! the options that are not in the deck
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress of the sweep, and may stop it
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solutions lack, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the sweep cannot be solved or written
      type(sweep_result_t) :: result
      integer, parameter :: unsolved(3) = [outcome_no_equilibrium, outcome_not_converged, outcome_numbers]
      character(19), parameter :: words(3) = [character(19) :: 'without equilibrium', 'NOT CONVERGED', &
         'FAILED NUMERICALLY']
      type(quantity_t), allocatable :: ranked(:)
      integer :: i

      call solve_sweep(cache, self%config, options%directory, monitor, result, error)
      call take_no_equilibrium(result%certified, error)
      if (allocated(error)) return
      if (allocated(result%certified%answer)) then
         call report_answer(options%directory, self%config, cache%body, result%certified, outcome, error)
         return
      end if
      if (result%is_interrupted) then
         call outcome%interrupt(to_text(result%statistics%n_cases)//' of '// &
            to_text(self%config%sweep%n_cases())//' cases')
         return
      end if
      call write_sweep_report(options%directory, self%config, cache%body, result, error)
      if (allocated(error)) return
      outcome%warnings = result%certified%warnings
      associate (statistics => result%statistics, n => result%statistics%n_outcomes)
         outcome%text = self%config%name//': '//counted(statistics%n_cases, 'case')//', '
         if (n(outcome_solved) == statistics%n_cases) outcome%text = outcome%text//'all solved'
         if (n(outcome_solved) < statistics%n_cases) outcome%text = outcome%text//to_text(n(outcome_solved))//' solved'
         do i = 1, size(unsolved)
            if (n(unsolved(i)) > 0) outcome%text = outcome%text//', '//to_text(n(unsolved(i)))//' '//trim(words(i))
         end do
         allocate (outcome%numbers(0))
         ! Iterations of all cases together, and of those that converged the largest residual and peaks.
         if (statistics%residual%at > 0) then
            outcome%text = outcome%text//', residual at most '//scientific(statistics%residual%value)
            outcome%numbers = [quantity_t('iterations', '', real(statistics%n_iterations, dp)), &
               quantity_t('residual', '', statistics%residual%value)]
            ranked = ranked_quantities(cache%body, self%config%sweep)
            do i = 1, size(ranked)
               ranked(i)%value = statistics%extremes(i, 2)%value
               if (index(ranked(i)%key, 'max_') == 1) outcome%numbers = [outcome%numbers, ranked(i)]
            end do
         end if
         if (statistics%failed_case > 0) then
            call outcome%lack(word_numerical_failure, to_text(n(outcome_numbers))//' of '// &
               to_text(statistics%n_cases)//' cases of the sweep failed numerically, case '// &
               to_text(statistics%failed_case)//' the first: '//result%fault)
         else if (n(outcome_not_converged) > 0) then
            call outcome%lack(word_not_converged, to_text(n(outcome_not_converged))//' of '// &
               to_text(statistics%n_cases)//' cases of the sweep did not converge')
         else if (statistics%outcome() == word_no_equilibrium) then
            call outcome%lack(word_no_equilibrium, nothing_balances)
         else
            call outcome%judge(.true., statistics%residual%value, result%certified%certificate%largest(), &
               self%config%method%tolerance, result%certified%condition)
         end if
      end associate
   end subroutine sweep_study_solve

end module amontons_sweep_study
