!> The study of a sweep: all cases of a deck with `&sweep` on one factorization, solved by all threads of all ranks, and
!> their files, all of them, each whole, or none.
!>
!> As many chunks as take about a second are a batch, after which the rows are put on the disk: an interrupted sweep
!> goes on there.
!>
!> The cases whose fields are asked for are solved again, chunk by chunk, which gives the same solutions: so an
!> interrupted sweep need not remember any, and a sweep without fields keeps none.
module amontons_sweep_study
   use amontons_body, only: body_t
   use amontons_checkpoint, only: checkpoint_t, new_checkpoint
   use amontons_conditioning, only: rounded
   use amontons_config, only: config_t, effective_deck
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_document, only: document_t, json_logical, json_number, json_string
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_listing, only: certificate_text, factorization_text, head_text, listed_phases, method_text, &
      model_text, quantities_text, times_text, warnings_text
   use amontons_load_case, only: recover_displacement
   use amontons_manifest, only: collection_t, find_earlier_files, manifest_t, new_collection, with_manifest
   use amontons_output_file, only: commit_files, hold_signals, output_file_t, release_signals, remove_temporaries, &
      write_text_file
   use amontons_quantity, only: quantity_t, scales
   use amontons_report, only: add_head, certificate_member, last_members, member, quantities_member, size_counts
   use amontons_result, only: certificate_limit, outcome_names, outcome_no_equilibrium, outcome_not_converged, &
      outcome_solved, result_t, solution_word, word_no_equilibrium, word_not_converged, word_solved
   use amontons_result_warnings, only: add_conditioning
   use amontons_solve_case, only: cache_t, certify, condense_case, estimate_error, set_factor
   use amontons_stress_field, only: new_stress_field
   use amontons_study, only: outcome_t, report_size, study_monitor_t, study_options_t, study_t
   use amontons_sweep, only: sweep_axis_t, sweep_t, swept_load
   use amontons_sweep_chunk, only: case_keys, chunk_length, chunk_t, new_case, new_chunk, outcome_labels, &
      prepare_sweep, ranked_quantities, solve_again, sweep_header, sweep_statistics_t, sweep_task_t
   use amontons_sweep_ranks, only: end_sharing, prepare_on_ranks, solve_on_ranks
   use amontons_system, only: file_name_t, make_directory, wall_seconds
   use amontons_terminal, only: phase_recover, phase_solve, phase_write
   use amontons_text, only: counted, flush_right, heading, labeled, newline, scientific, short_text, to_text, with_unit
   use amontons_threads, only: n_threads
   use amontons_version, only: version
   use amontons_vtu, only: write_grids
   implicit none (type, external)
   private

   public :: n_documents, new_sweep_summary, solve_sweep, sweep_documents, sweep_result_t, sweep_study_t, &
      write_sweep_report

   !> The result of a sweep. Its rows and its fields are on the disk.
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
      logical :: is_interrupted = .false. !! whether cases are left to do
      logical :: has_certificate = .true. !! whether the certificate is known, not only recorded in files
   contains
      procedure :: cases_per_second => sweep_result_cases_per_second
   end type sweep_result_t

   !> Number of files that every sweep leaves, the table not counted.
   integer, parameter :: n_files = 3
   !> Number of those that are made of text and are not the summary.
   integer, parameter :: n_documents = 2

   !> The study of a sweep.
   type, extends(study_t) :: sweep_study_t
   contains
      procedure :: check => sweep_study_check
      procedure :: solve => sweep_study_solve
   end type sweep_study_t

contains

   !> Solves all cases of a sweep that no earlier run has done. The table keeps its temporary name, and its lock until
   !> it is written, unless the sweep was interrupted.
   subroutine solve_sweep(cache, config, directory, monitor, result, error)
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the sweep needs another
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(study_monitor_t), intent(inout) :: monitor !! is told how far the sweep is, and may stop it
      type(sweep_result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the deck, the numbers or the disk are at fault
      type(sweep_task_t) :: task

      call prepare_sweep(task, cache, config, result%certified, error)
      if (allocated(error)) return
      call condense_case(cache, config, result%certified, error)
      if (allocated(error)) return
      call set_factor(result%certified%factor, cache%body)
      call prepare_on_ranks(result%n_sharing, task, cache, config, error)
      if (.not. allocated(error)) call open_table(result, task, cache, directory, config, error)
      if (.not. allocated(error)) call solve_batches(task, cache, monitor, result, error)
      call end_sharing(result%n_sharing)
      if (.not. allocated(error)) call finish_sweep(task, cache, directory, config, monitor, result, error)
      if (allocated(error) .or. result%is_interrupted) call result%checkpoint%close()
   end subroutine solve_sweep

   !> Opens the table, with the rows of an earlier run if there are any.
   subroutine open_table(result, task, cache, directory, config, error)
      type(sweep_result_t), intent(inout) :: result !! gains the table, and the statistics of its rows
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(cache_t), intent(in) :: cache !! the body
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(config_t), intent(in) :: config !! the deck
      type(error_t), allocatable, intent(out) :: error !! the table cannot be written, or another run writes it

      call result%certified%timings%begin(phase_solve)
      call make_directory(directory, error)
      if (allocated(error)) return
      associate (stem => directory//'/'//config%name//'.sweep')
         call new_checkpoint(result%checkpoint, stem)
         call result%checkpoint%add_table(stem//'.part', sweep_header(config%sweep, case_keys(cache%body, &
            config%sweep)))
      end associate
      call result%checkpoint%open('! Amontons '//version//', a sweep under way; contact problem '// &
         task%solver%loads%fingerprint(cache%body, cache%problem)//newline//effective_deck(config), &
         result%statistics, error)
      result%n_resumed = result%statistics%n_cases
   end subroutine open_table

   !> Keeps the fields that are asked for and certifies one case, unless the sweep was interrupted.
   subroutine finish_sweep(task, cache, directory, config, monitor, result, error)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(cache_t), intent(inout) :: cache !! the body; its contact problem may become that of some case
      character(*), intent(in) :: directory !! output directory
      type(config_t), intent(in) :: config !! the deck
      class(study_monitor_t), intent(inout) :: monitor !! is told how far the fields are, and may stop the sweep
      type(sweep_result_t), intent(inout) :: result !! gains the case and its certificate
      type(error_t), allocatable, intent(out) :: error !! the fields cannot be written

      call result%certified%timings%begin(phase_write)
      result%is_interrupted = result%statistics%n_cases < task%sweep%n_cases()
      if (.not. result%is_interrupted .and. task%sweep%n_fields() > 0) call write_sweep_fields(result%collection, &
         result%grids, task, cache%body, cache%problem, directory//'/'//config%name, monitor, &
         result%is_interrupted, error)
      if (allocated(error)) return
      call result%certified%timings%begin(phase_recover)
      if (.not. result%is_interrupted .and. result%statistics%worst_case > 0) then
         call certify_worst(task, cache, result, error)
         if (allocated(error)) return
      end if
      call result%statistics%add_warnings(cache%body%zone, result%certified%warnings)
      call result%certified%timings%begin(phase_write)
   end subroutine finish_sweep

   !> Solves batch after batch until all cases are done or the monitor stops the sweep.
   subroutine solve_batches(task, cache, monitor, result, error)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(cache_t), intent(in) :: cache !! the body
      class(study_monitor_t), intent(inout) :: monitor !! is told how far the sweep is, and may stop it
      type(sweep_result_t), intent(inout) :: result !! gains the statistics
      type(error_t), allocatable, intent(out) :: error !! the rows cannot be written
      real(dp), parameter :: batch_seconds = 1.0_dp
      type(chunk_t), allocatable :: chunks(:)
      character(:), allocatable :: rows
      real(dp) :: start, growth
      integer :: n_cases, n_chunks, i

      n_cases = int(task%sweep%n_cases())
      n_chunks = result%n_sharing*n_threads()
      call monitor%report(result%statistics%n_cases, n_cases, 'cases')
      do while (result%statistics%n_cases < n_cases .and. .not. monitor%is_stopped())
         start = wall_seconds()
         allocate (chunks(min(n_chunks, (n_cases - result%statistics%n_cases - 1)/chunk_length + 1)))
         do i = 1, size(chunks)
            call new_chunk(chunks(i), result%statistics%n_cases + (i - 1)*chunk_length, n_cases)
         end do
         call solve_on_ranks(result%n_sharing, task, cache, monitor, chunks)
         call gather_chunks(chunks, rows, result%statistics)
         deallocate (chunks)
         call result%checkpoint%add_rows(1, rows)
         if (len(rows) > 0) call result%checkpoint%save(result%statistics, error)
         if (allocated(error)) return
         call monitor%report(result%statistics%n_cases, n_cases, 'cases')
         growth = min(4.0_dp, batch_seconds/max(wall_seconds() - start, tiny(1.0_dp)))
         n_chunks = max(result%n_sharing*n_threads(), int(n_chunks*growth))
      end do
   end subroutine solve_batches

   !> Gathers the chunks that are done, as far as no chunk is missing before them.
   pure subroutine gather_chunks(chunks, rows, statistics)
      type(chunk_t), intent(in) :: chunks(:) !! the chunks
      character(:), allocatable, intent(out) :: rows !! their rows
      type(sweep_statistics_t), intent(inout) :: statistics !! gains their cases
      integer :: n_done, i, first

      n_done = findloc([chunks%is_done, .false.], .false., dim=1) - 1
      allocate (character(sum([(len(chunks(i)%rows), i=1, n_done)])) :: rows)
      first = 1
      do i = 1, n_done
         rows(first:first + len(chunks(i)%rows) - 1) = chunks(i)%rows
         first = first + len(chunks(i)%rows)
         call statistics%append(chunks(i)%statistics)
      end do
   end subroutine gather_chunks

   !> Solves the case with the largest error estimate again and certifies it on the full model.
   subroutine certify_worst(task, cache, result, error)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(cache_t), intent(inout) :: cache !! the body; its contact problem becomes that of the case
      type(sweep_result_t), intent(inout) :: result !! gains the case and its certificate
      type(error_t), allocatable, intent(out) :: error !! its numbers are not finite
      type(contact_solution_t) :: solutions(chunk_length)
      type(chunk_t) :: chunk
      integer :: i

      associate (number => result%statistics%worst_case, certified => result%certified)
         call new_chunk(chunk, number - 1 - mod(number - 1, chunk_length), number)
         call solve_again(task, cache%body, cache%problem, chunk, [(i == number, i=chunk%first, number)], solutions)
         certified%solution = solutions(number - chunk%first + 1)
         call new_case(certified%load_case, task, cache%body, number)
         certified%wants_error_estimate = task%wants_error_estimate
         call certify(certified, cache%body, error)
         if (.not. allocated(error)) call add_conditioning(certified, cache%body)
      end associate
   end subroutine certify_worst

   !> Number of cases that this run solved in a second; 0 if it had none to solve.
   pure real(dp) function sweep_result_cases_per_second(self) result(rate)
      class(sweep_result_t), intent(in) :: self !! the result

      rate = (self%statistics%n_cases - self%n_resumed)/max(self%certified%timings%seconds(phase_solve), &
         epsilon(1.0_dp))
   end function sweep_result_cases_per_second

   !> Writes NAME.sweep/NUMBER.vtu and NAME.sweep/NUMBER.contact.vtu of the cases that converged, and NAME.sweep.pvd,
   !> which keeps its temporary name. There is none without such cases, after an error, or where the monitor stops it.
   ! allow(S902): two results, the sweep with body and problem, and what every writer of many files has
   subroutine write_sweep_fields(file, manifest, task, body, problem, stem, monitor, is_stopped, error)
      type(output_file_t), allocatable, intent(out) :: file !! the finished collection, if there is one
      type(manifest_t), intent(out) :: manifest !! the manifest of the grids
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      character(*), intent(in) :: stem !! directory and name of the case
      class(study_monitor_t), intent(inout) :: monitor !! is told how far it is, and may stop it
      logical, intent(out) :: is_stopped !! whether it did
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(collection_t) :: collection
      type(chunk_t) :: chunk
      integer :: n_cases, n_before, slash

      is_stopped = .false.
      slash = index(stem, '/', back=.true.)
      call make_directory(stem//'.sweep', error)
      if (allocated(error)) return
      call remove_temporaries(stem//'.sweep/')
      call new_collection(collection, stem//'.sweep.pvd', task%units, error)
      if (allocated(error)) return
      n_cases = int(task%sweep%n_cases())
      do n_before = 0, n_cases - 1, chunk_length
         call new_chunk(chunk, n_before, n_cases)
         if (.not. task%sweep%has_fields(chunk%first, chunk%last)) cycle
         is_stopped = monitor%is_stopped()
         if (is_stopped) exit
         call write_chunk(collection, task, body, problem, chunk, stem(:slash), stem(slash + 1:)//'.sweep/', error)
         if (allocated(error)) exit
         call monitor%report_fields((chunk%last - 1)/task%sweep%fields_every + 1, int(task%sweep%n_fields()))
      end do
      if (is_stopped .or. allocated(error) .or. collection%n_cases == 0) then
         call collection%discard()
      else
         allocate (file)
         call collection%finish(file, error)
         manifest = collection%grids
      end if
   end subroutine write_sweep_fields

   !> Solves a chunk again and writes the fields of its cases.
   subroutine write_chunk(collection, task, body, problem, chunk, directory, folder, error)
      type(collection_t), intent(inout) :: collection !! gains the cases and the manifest of their grids
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(chunk_t), intent(inout) :: chunk !! the chunk
      character(*), intent(in) :: directory !! output directory, a slash behind it
      character(*), intent(in) :: folder !! folder of the grids in it, a slash behind it
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(contact_solution_t) :: solutions(chunk_length)
      type(result_t) :: result
      integer :: number, i

      call solve_again(task, body, problem, chunk, [(task%sweep%has_fields(number, number), &
         number=chunk%first, chunk%last)], solutions)
      do number = chunk%first, chunk%last
         i = number - chunk%first + 1
         if (.not. task%sweep%has_fields(number, number) .or. chunk%results(i)%outcome /= outcome_solved) cycle
         result%solution = solutions(i)
         call new_case(result%load_case, task, body, number)
         call recover_displacement(result%displacement, body, result%load_case, result%solution%displacement)
         call new_stress_field(result%stress, body%mesh, body%materials, body%coloring, result%displacement, &
            result%load_case%thermal_strain)
         if (task%wants_error_estimate) then
            if (.not. allocated(result%error_estimate)) allocate (result%error_estimate)
            call estimate_error(result%error_estimate, body, result%load_case, result%displacement, &
               result%solution%force)
         end if
         call write_grids(collection, directory, folder, to_text(number), body, result, error)
         if (allocated(error)) return
         call collection%add(to_text(number), folder//to_text(number))
      end do
   end subroutine write_chunk

   !> Writes NAME.lst, NAME.deck.nml and NAME.summary.json and gives NAME.sweep.csv and, where there are fields,
   !> NAME.sweep.pvd their names. Names change hands only after every file is complete; the checkpoint goes last.
   subroutine write_sweep_report(directory, config, body, result, error)
      character(*), intent(in) :: directory !! output directory
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(inout) :: result !! the result of all cases; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(n_files + merge(1, 0, allocated(result%collection)))
      type(file_name_t), allocatable :: earlier(:)
      type(output_file_t) :: table
      type(manifest_t) :: manifest
      character(:), allocatable :: stem

      if (allocated(result%collection)) files(n_files) = result%collection
      stem = directory//'/'//config%name
      call write_files(files, manifest, stem, config, body, result, error)
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, config%name, manifest)
      call hold_signals()
      call result%checkpoint%table_file(table, 1, stem//'.sweep.csv')
      if (.not. allocated(error)) call table%commit(error)
      call commit_files(files, error, earlier)
      if (.not. allocated(error)) call result%checkpoint%remove()
      call result%checkpoint%close()
      call release_signals()
   end subroutine write_sweep_report

   !> Makes the text files of a sweep, but for the table and the summary.
   subroutine sweep_documents(documents, config, body, result)
      type(document_t), intent(out) :: documents(n_documents) !! the files
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result of all cases

      call new_sweep_listing(documents(1), config, body, result)
      documents(2)%ending = '.deck.nml'
      call documents(2)%add(config%deck_text())
   end subroutine sweep_documents

   !> Writes all files under their temporary names; the summary last, since it tells the time of writing.
   subroutine write_files(files, manifest, stem, config, body, result, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, the summary last
      type(manifest_t), intent(out) :: manifest !! their manifest
      character(*), intent(in) :: stem !! directory and name of the case
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(document_t) :: documents(n_documents), summary
      integer :: i

      call sweep_documents(documents, config, body, result)
      do i = 1, size(documents)
         call write_text_file(files(i), stem//documents(i)%ending, documents(i)%text(), error)
         if (allocated(error)) return
      end do
      manifest = result%grids
      call manifest%add_outputs(files, '', error)
      if (allocated(error)) return
      associate (load_case => result%certified%load_case, table => result%checkpoint%checksum(1))
         call manifest%outputs%append_known(config%name//'.sweep.csv', table%n_bytes, table%value())
         call manifest%add_inputs(body%mesh, load_case%contacts, load_case%loads)
      end associate
      call result%certified%timings%begin(phase_write)
      call new_sweep_summary(summary, config, body, result)
      call write_text_file(files(size(files)), stem//summary%ending, with_manifest(summary%text(), manifest), error)
   end subroutine write_files

   !> Makes the listing.
   subroutine new_sweep_listing(listing, config, body, result)
      type(document_t), intent(out) :: listing !! the listing
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result

      listing%ending = '.lst'
      call listing%record(head_text(config))
      associate (certified => result%certified, statistics => result%statistics)
         call listing%add(warnings_text(certified%warnings))
         call listing%add(model_text(body, certified%load_case, config%units)//list_axes(config))
         call listing%record(list_solution(config, result))
         if (statistics%residual_case > 0) then
            call listing%add(list_extremes(ranked_quantities(body, config%sweep), statistics, config%units))
            call list_certificate(listing, result, config%units)
         end if
         call listing%record(times_text(certified%timings, listed_phases))
      end associate
   end subroutine new_sweep_listing

   !> Adds the certificate of the case with the largest error estimate, and how accurate its stresses are.
   subroutine list_certificate(listing, result, units)
      type(document_t), intent(inout) :: listing !! the listing
      type(sweep_result_t), intent(in) :: result !! the result
      character(*), intent(in) :: units !! names of the units
      character(:), allocatable :: text

      text = certificate_text(result%certified%certificate, result%certified%method%tolerance)// &
         labeled('Worst case', to_text(result%statistics%worst_case)//', by the estimated error of its forces')
      if (allocated(result%certified%error_estimate)) text = text//heading('Accuracy of the worst case '// &
         '(energy norm of the stress error)')//quantities_text(result%certified%error_estimate%quantities(), units)
      if (result%has_certificate) then
         call listing%add(text, [1.0_dp])
      else
         call listing%record(text)
      end if
   end subroutine list_certificate

   !> What varies, and in which combination.
   pure function list_axes(config) result(text)
      type(config_t), intent(in) :: config !! the deck
      character(:), allocatable :: text
      integer :: i

      text = heading('Sweep')
      do i = 1, size(config%sweep%axes)
         associate (axis => config%sweep%axes(i))
            text = text//labeled(trim(merge('along with', 'vary      ', axis%is_paired)), axis_text(axis))
         end associate
      end do
      text = text//labeled('Cases', to_text(config%sweep%n_cases())//', row by row in '//config%name//'.sweep.csv')
      if (config%sweep%n_fields() > 0) text = text//labeled('Fields', 'of '//to_text(config%sweep%n_fields())// &
         ' cases, those that converged, in '//config%name//'.sweep.pvd')
   end function list_axes

   !> A quantity and its values; of many values the first and the last ones.
   pure function axis_text(axis) result(text)
      type(sweep_axis_t), intent(in) :: axis !! the quantity
      character(:), allocatable :: text
      integer, parameter :: n_shown = 8
      integer :: i

      if (axis%target == swept_load) then
         text = "factor of load '"//axis%name//"': "
      else
         text = axis%label()//': '
      end if
      text = text//counted(size(axis%values), 'value')//', '
      do i = 1, size(axis%values)
         if (i == n_shown .and. size(axis%values) > n_shown) text = text//'... '
         if (i >= n_shown .and. i < size(axis%values)) cycle
         text = text//short_text(axis%values(i))
         if (i < size(axis%values)) text = text//', '
      end do
   end function axis_text

   !> How the cases were solved.
   function list_solution(config, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      associate (statistics => result%statistics)
         text = heading('Solution')//labeled('Method', method_text(config%method))// &
            labeled('Factorization', factorization_text(result%certified))// &
            labeled('Converged', to_text(statistics%n_outcomes(outcome_solved))//' of '//to_text(statistics%n_cases)// &
            ' cases')
         do i = 1, size(outcome_labels)
            if (i /= outcome_solved .and. statistics%n_outcomes(i) > 0) text = text// &
               labeled(trim(outcome_labels(i)), counted(statistics%n_outcomes(i), 'case'))
         end do
         text = text//labeled('Iterations', to_text(statistics%n_iterations)//', '// &
            scientific(real(statistics%n_iterations, dp)/max(1, statistics%n_cases))//' per case')
         if (statistics%residual_case > 0) text = text//labeled('Largest residual', scientific(statistics%residual)// &
            ' in case '//to_text(statistics%residual_case)//', tolerance '//scientific(config%method%tolerance))
         if (result%n_resumed > 0) text = text//labeled('Done earlier', counted(result%n_resumed, 'case'))
         if (result%checkpoint%is_anew) text = text// &
            labeled('Note', 'the rows of an interrupted run are damaged or '// &
            'of another deck or version: all cases were solved again')
         text = text//labeled('Cases per second', short_text(result%cases_per_second()))
         if (result%n_sharing > 1) text = text//labeled('Solved by', counted(result%n_sharing, 'rank'))
      end associate
   end function list_solution

   !> Extremes of the cases that converged.
   pure function list_extremes(list, statistics, units) result(text)
      type(quantity_t), intent(in) :: list(:) !! what cases are ranked by
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer, parameter :: width = 14
      integer :: name_width, i

      name_width = maxval(len_trim(list%key))
      text = heading('Extremes of the cases that converged')//repeat(' ', name_width + 2)// &
         flush_right('least', width)// &
         flush_right('in case', width)//flush_right('greatest', width)//flush_right('in case', width)//newline
      do i = 1, size(list)
         text = text//'  '//list(i)%key(:name_width)//with_unit(flush_right(short_text(statistics%least(i)), width)// &
            flush_right(to_text(statistics%least_case(i)), width)// &
            flush_right(short_text(statistics%greatest(i)), width)// &
            flush_right(to_text(statistics%greatest_case(i)), width), units, trim(list(i)%dimension))//newline
      end do
   end function list_extremes

   !> Makes the summary.
   subroutine new_sweep_summary(summary, config, body, result)
      type(document_t), intent(out) :: summary !! the summary
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result

      associate (statistics => result%statistics, certified => result%certified)
         call add_head(summary, config, config%method%method, outcome_word(result), certified%warnings)
         if (statistics%outcome() == word_no_equilibrium) call summary%add(member('message', json_string( &
            'no case has an equilibrium: contact and friction cannot balance the loads of any')))
         call summary%add(member('iterations', to_text(statistics%n_iterations)))
         call summary%add(member('sweep', '{'//count_members(result)//'}'))
         call summary%add(member('quantities', '['//axis_members(config%sweep)//']'))
         if (statistics%residual_case > 0) then
            call summary%add(member('residual', json_number(statistics%residual)))
            call summary%add(member('extremes', '{'//extreme_members(body, config%sweep, statistics)//'}'))
            call add_certificate_members(summary, result)
         end if
         if (certified%condition > 0.0_dp) call summary%record(member('condition', json_number(certified%condition)))
         call summary%add(member('counts', '{'//size_counts(body)//'}'))
         call summary%record(last_members(certified%timings))
      end associate
   end subroutine new_sweep_summary

   !> What became of the sweep in a word.
   pure function outcome_word(result) result(word)
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: word

      word = result%statistics%outcome()
      if (word == word_solved) word = solution_word(.true., result%certified%certificate%largest() &
         <= certificate_limit(result%certified%method%tolerance))
   end function outcome_word

   !> Adds the certificate of the case with the largest error estimate, and how accurate its stresses are.
   subroutine add_certificate_members(summary, result)
      type(document_t), intent(inout) :: summary !! the summary
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (certificate => result%certified%certificate)
         text = certificate_member(certificate%violations(), certificate_limit(result%certified%method%tolerance), &
            certificate%energies(), '"case": '//to_text(result%statistics%worst_case)//', ')
         if (result%has_certificate) then
            call summary%add(text, [1.0_dp, 1.0_dp, scales([certificate%violations(), certificate%energies()])])
         else
            call summary%record(text)
         end if
         if (.not. allocated(result%certified%error_estimate)) return
         associate (accuracy => result%certified%error_estimate%quantities())
            if (result%has_certificate) then
               call summary%add(quantities_member('accuracy', accuracy))
            else
               call summary%record(quantities_member('accuracy', accuracy))
            end if
         end associate
      end associate
   end subroutine add_certificate_members

   !> Counts of the cases, and how fast they were solved.
   pure function count_members(result) result(text)
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      text = '"cases": '//to_text(result%statistics%n_cases)
      do i = 1, size(outcome_names)
         text = text//', "'//trim(outcome_names(i))//'": '//to_text(result%statistics%n_outcomes(i))
      end do
      text = text//', "done_earlier": '//to_text(result%n_resumed)//', "cases_per_second": '// &
         json_number(result%cases_per_second())
   end function count_members

   !> What varies: name, number of values, the least and the greatest of them.
   pure function axis_members(sweep) result(text)
      type(sweep_t), intent(in) :: sweep !! the sweep
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(sweep%axes)
         if (i > 1) text = text//', '
         associate (axis => sweep%axes(i))
            text = text//'{"name": '//json_string(axis%label())// &
               ', "values": '//to_text(size(axis%values))// &
               ', "least": '//json_number(minval(axis%values))// &
               ', "greatest": '//json_number(maxval(axis%values))// &
               ', "paired": '//json_logical(axis%is_paired)//'}'
         end associate
      end do
   end function axis_members

   !> Extremes of the cases that converged.
   pure function extreme_members(body, sweep, statistics) result(text)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      character(:), allocatable :: text
      type(quantity_t), allocatable :: list(:)
      integer :: i

      text = ''
      list = ranked_quantities(body, sweep)
      do i = 1, size(list)
         if (i > 1) text = text//', '
         text = text//'"'//trim(list(i)%key)//'": {"least": '//json_number(statistics%least(i))//', "least_case": '// &
            to_text(statistics%least_case(i))//', "greatest": '//json_number(statistics%greatest(i))// &
            ', "greatest_case": '//to_text(statistics%greatest_case(i))//'}'
      end do
   end function extreme_members

   !> Checks the sweep and reports its size.
   subroutine sweep_study_check(self, cache, outcome, error)
      class(sweep_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the sweep needs another
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck
      type(sweep_task_t) :: task
      type(result_t) :: result
      character(:), allocatable :: cases

      associate (sweep => self%config%sweep)
         cases = ', '//to_text(sweep%n_cases())//' cases'
         if (sweep%n_fields() > 0) cases = cases//', fields of '//to_text(sweep%n_fields())
      end associate
      call prepare_sweep(task, cache, self%config, result, error)
      if (.not. allocated(error)) call report_size(self%config, cases, cache, result, outcome, error)
   end subroutine sweep_study_check

   !> Solves the cases and writes their files.
   subroutine sweep_study_solve(self, cache, options, monitor, outcome, error)
      class(sweep_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the sweep needs another
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
      class(study_monitor_t), intent(inout) :: monitor !! learns how far the sweep is, and may stop it
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solutions lack, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the sweep cannot be solved or written
      type(sweep_result_t) :: result

      call solve_sweep(cache, self%config, options%directory, monitor, result, error)
      if (allocated(error)) return
      if (result%is_interrupted) then
         call outcome%interrupt(to_text(result%statistics%n_cases)//' of '// &
            to_text(self%config%sweep%n_cases())//' cases')
         return
      end if
      call write_sweep_report(options%directory, self%config, cache%body, result, error)
      if (allocated(error)) return
      outcome%text = swept_text(self%config%name, result)
      outcome%warnings = result%certified%warnings
      outcome%numbers = swept_numbers(cache%body, self%config%sweep, result%statistics)
      call judge_sweep(result, self%config%method%tolerance, outcome)
   end subroutine sweep_study_solve

   !> Judges a sweep by its cases, and by the certificate of one of them.
   pure subroutine judge_sweep(result, tolerance, outcome)
      type(sweep_result_t), intent(in) :: result !! the result
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]
      type(outcome_t), intent(inout) :: outcome !! gains status, and what the solutions lack

      if (.not. result%statistics%is_answered()) then
         call outcome%lack(word_not_converged, to_text(result%statistics%n_outcomes(outcome_not_converged))//' of '// &
            to_text(result%statistics%n_cases)//' cases of the sweep did not converge')
         return
      end if
      if (result%statistics%outcome() == word_no_equilibrium) then
         outcome%word = word_no_equilibrium
         return
      end if
      call outcome%judge(.true., result%statistics%residual, result%certified%certificate%largest(), tolerance)
      if (outcome%status /= 0 .and. result%certified%condition > 0.0_dp) outcome%message = outcome%message// &
         '; the condition number of the stiffness is about '//rounded(result%certified%condition)
   end subroutine judge_sweep

   !> Iterations of all cases together, and of those that converged the largest residual and peaks.
   pure function swept_numbers(body, sweep, statistics) result(list)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      type(quantity_t), allocatable :: list(:), ranked(:)
      integer :: i

      ranked = ranked_quantities(body, sweep)
      allocate (list(0))
      if (statistics%residual_case == 0) return
      list = [quantity_t('iterations', '', real(statistics%n_iterations, dp)), &
         quantity_t('residual', '', statistics%residual)]
      do i = 1, size(ranked)
         ranked(i)%value = statistics%greatest(i)
         if (index(ranked(i)%key, 'max_') == 1) list = [list, ranked(i)]
      end do
   end function swept_numbers

   !> The line on the result of a sweep.
   pure function swept_text(name, result) result(text)
      character(*), intent(in) :: name !! name of the case
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (statistics => result%statistics)
         text = name//': '//counted(statistics%n_cases, 'case')//', '
         if (statistics%n_outcomes(outcome_solved) == statistics%n_cases) then
            text = text//'all solved'
         else
            text = text//to_text(statistics%n_outcomes(outcome_solved))//' solved'
         end if
         if (statistics%n_outcomes(outcome_no_equilibrium) > 0) text = text//', '// &
            to_text(statistics%n_outcomes(outcome_no_equilibrium))//' without equilibrium'
         if (.not. statistics%is_answered()) text = text//', '// &
            to_text(statistics%n_outcomes(outcome_not_converged))//' NOT CONVERGED'
         if (statistics%residual_case == 0) return
         text = text//', residual at most '//scientific(statistics%residual)
      end associate
   end function swept_text

end module amontons_sweep_study
