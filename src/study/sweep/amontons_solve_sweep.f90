!> The way of a sweep from its deck to its table: all cases on one factorization, solved by all threads of all ranks.
!>
!> As many chunks as take about a second are a batch, after which the rows are put on the disk: an interrupted sweep
!> goes on there.
!>
!> The cases whose fields are asked for are solved again, chunk by chunk, which gives the same solutions: so an
!> interrupted sweep need not remember any, and a sweep without fields keeps none.
module amontons_solve_sweep
   use amontons_body, only: body_t
   use amontons_checkpoint, only: checkpoint_t, new_checkpoint
   use amontons_config, only: config_t, effective_deck
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_load_case, only: recover_displacement
   use amontons_manifest, only: collection_t, manifest_t, new_collection
   use amontons_output_file, only: output_file_t, remove_temporaries
   use amontons_result, only: outcome_solved, result_t
   use amontons_result_warnings, only: add_conditioning
   use amontons_solve_case, only: cache_t, certify, condense_case, estimate_error, set_factor
   use amontons_stress_field, only: new_stress_field
   use amontons_study, only: study_monitor_t
   use amontons_sweep_chunk, only: chunk_length, chunk_t, new_case, new_chunk, prepare_sweep, solve_again, sweep_task_t
   use amontons_sweep_ranks, only: end_sharing, prepare_on_ranks, solve_on_ranks
   use amontons_sweep_table, only: case_keys, sweep_header, sweep_statistics_t
   use amontons_system, only: make_directory, wall_seconds
   use amontons_terminal, only: phase_recover, phase_solve, phase_write
   use amontons_text, only: newline, to_text
   use amontons_threads, only: n_threads
   use amontons_version, only: version
   use amontons_vtu, only: write_grids
   implicit none (type, external)
   private

   public :: solve_sweep, sweep_result_t

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

end module amontons_solve_sweep
