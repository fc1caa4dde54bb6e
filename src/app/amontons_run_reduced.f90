!> Reduced problems in a run: solved, and written for others.
module amontons_run_reduced
   use amontons_command_line, only: command_line_t
   use amontons_config, only: config_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_error, only: error_t
   use amontons_listing_text, only: scientific
   use amontons_reduced_file, only: write_reduced_file
   use amontons_reduced_report, only: write_reduced_report
   use amontons_reduced_system, only: new_condensed_system, reduced_system_t
   use amontons_result, only: certificate_limit
   use amontons_screen, only: complain, tell, tell_case
   use amontons_solve_reduced, only: find_reduced_solutions, prepare_reduced, reduced_result_t, solve_reduced
   use amontons_text, only: to_text
   use amontons_timings, only: phase_solve, phase_write
   implicit none (type, external)
   private

   public :: export_case, run_reduced

contains

   !> Checks or solves a reduced problem.
   subroutine run_reduced(command_line, config, is_solved, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(config_t), intent(in) :: config !! the case
      logical, intent(out) :: is_solved !! whether it is solved and checked; true where it was only to be read
      type(error_t), allocatable, intent(out) :: error !! the file is at fault, or no files can be written
      type(reduced_result_t) :: result

      is_solved = .true.
      if (command_line%is_check) then
         call check_reduced(command_line, config, error)
         return
      end if
      call solve_reduced(config, result, error)
      if (allocated(error)) return
      if (command_line%writes_reduced) call write_reduced_file(command_line%output, config%name, &
         result%system, error)
      if (allocated(error)) return
      result%has_reduced_files = command_line%writes_reduced
      if (command_line%wants_all_solutions) then
         allocate (result%all_solutions)
         call result%timings%begin(phase_solve)
         call find_reduced_solutions(result%all_solutions, result%system, error)
         if (allocated(error)) return
         call result%timings%begin(phase_write)
      end if
      call write_reduced_report(command_line%output, config, result, error)
      if (allocated(error)) return
      call tell_case(command_line, solved_text(config, result), config%name, result%warnings, error)
      is_solved = result%solution%is_converged
      if (.not. is_solved .or. result%check%largest() <= certificate_limit(config%method%tolerance)) return
      is_solved = .false.
      call complain(config%file//': the check FAILED on the problem as read; see the listing')
   end subroutine run_reduced

   !> Reads a reduced problem and tells its size.
   subroutine check_reduced(command_line, config, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(out) :: error !! the file is at fault
      type(reduced_result_t) :: result

      call prepare_reduced(config, result, error)
      if (.not. allocated(error)) call tell_case(command_line, config%name//': in order; '//result%system%form//', '// &
         to_text(result%system%n_contacts)//' contacts, '//to_text(size(result%system%entry))//' entries of W', &
         config%name, result%warnings, error)
   end subroutine check_reduced

   !> Writes the reduced problem of a solved deck.
   subroutine export_case(command_line, config, problem, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(config_t), intent(in) :: config !! the case
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; gains its compliance
      type(error_t), allocatable, intent(out) :: error !! it has no reduced problem, or the file cannot be written
      type(reduced_system_t) :: system

      call new_condensed_system(system, problem, error)
      if (.not. allocated(error)) call write_reduced_file(command_line%output, config%name, system, error)
   end subroutine export_case

   !> What is told of a solved reduced problem.
   pure function solved_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      text = config%name//': '//trim(merge('solved       ', 'NOT CONVERGED', result%solution%is_converged))//', '// &
         to_text(result%solution%n_iterations)//' iterations, residual '//scientific(result%solution%residual)//'; '// &
         to_text(result%system%n_contacts)//' contacts'
   end function solved_text

end module amontons_run_reduced
