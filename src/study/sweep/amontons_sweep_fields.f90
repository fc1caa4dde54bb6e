!> The fields of the cases of a sweep: mesh and contact line of every case that the deck asks for.
!>
!> The cases are solved again, chunk by chunk, which gives the same solutions: so an interrupted sweep need not remember
!> any, and a sweep without fields keeps none.
module amontons_sweep_fields
   use amontons_body, only: body_t
   use amontons_case_error, only: estimate_error
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_load_case, only: recover_displacement
   use amontons_manifest, only: collection_t, manifest_t, new_collection
   use amontons_outcome_words, only: outcome_solved
   use amontons_output_file, only: output_file_t, remove_temporaries
   use amontons_result, only: result_t
   use amontons_stress_field, only: new_stress_field
   use amontons_study_monitor, only: study_monitor_t
   use amontons_sweep_chunk, only: chunk_length, chunk_t, new_case, new_chunk, solve_again, sweep_task_t
   use amontons_system, only: make_directory
   use amontons_text, only: to_text
   use amontons_vtu, only: write_grids
   implicit none (type, external)
   private

   public :: write_sweep_fields

contains

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

end module amontons_sweep_fields
