!> The study of a reduced problem that another program, or an earlier run, has written.
module amontons_reduced_study
   use amontons_error, only: error_t
   use amontons_outcome, only: method_numbers, outcome_t, solution_line
   use amontons_reduced_report, only: write_reduced_report
   use amontons_siconos_text, only: write_reduced_file
   use amontons_solve_case, only: cache_t
   use amontons_solve_reduced, only: find_reduced_solutions, prepare_reduced, reduced_result_t, solve_reduced
   use amontons_study, only: study_options_t, study_t
   use amontons_study_monitor, only: study_monitor_t
   use amontons_terminal, only: phase_solve, phase_write
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: reduced_study_t

   !> The study of a reduced problem.
   type, extends(study_t) :: reduced_study_t
   contains
      procedure :: check => reduced_study_check
      procedure :: solve => reduced_study_solve
   end type reduced_study_t

contains

   !> Reads the problem and reports its size.
   subroutine reduced_study_check(self, cache, outcome, error)
      class(reduced_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! not used: there is no body
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the problem
      type(error_t), allocatable, intent(out) :: error !! the file is at fault
      type(reduced_result_t) :: result

      call prepare_reduced(self%config, result, error)
      if (allocated(error)) return
      outcome%warnings = result%warnings
      outcome%text = self%config%name//': deck OK; '//result%system%form//', '//to_text(result%system%n_contacts)// &
         ' contacts, '//to_text(size(result%system%entry))//' entries of W'
      associate (unused => cache)
      end associate
   end subroutine reduced_study_check

   !> Solves the problem and writes its files.
   subroutine reduced_study_solve(self, cache, options, monitor, outcome, error)
      class(reduced_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! not used: there is no body
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
      class(study_monitor_t), intent(inout) :: monitor !! not used: there is one case only
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solution lacks, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the file is at fault, or no files can be written
      type(reduced_result_t) :: result

      call solve_reduced(self%config, result, error)
      if (.not. allocated(error)) call add_extras(self%config%name, options, result, error)
      if (.not. allocated(error)) call write_reduced_report(options%directory, self%config, result, error)
      if (allocated(error)) return
      outcome%text = solution_line(self%config%name, result%solution)//'; '// &
         to_text(result%system%n_contacts)//' contacts'
      outcome%warnings = result%warnings
      outcome%numbers = method_numbers(result%solution)
      call outcome%judge(result%solution%is_converged, result%solution%residual, result%check%largest(), &
         self%config%method%tolerance)
      associate (unused => cache, unused_too => monitor)
      end associate
   end subroutine reduced_study_solve

   !> Adds what the options ask for: the problem in a file again, all solutions.
   subroutine add_extras(name, options, result, error)
      character(*), intent(in) :: name !! name of the case
      type(study_options_t), intent(in) :: options !! what is asked for
      type(reduced_result_t), intent(inout) :: result !! the result; gains all solutions
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written, or there are too many contacts

      if (options%writes_reduced) then
         call write_reduced_file(options%directory, name, result%system, error)
         if (allocated(error)) return
         result%has_reduced_files = .true.
      end if
      if (options%wants_all_solutions) then
         allocate (result%all_solutions)
         call result%timings%begin(phase_solve)
         call find_reduced_solutions(result%all_solutions, result%system, error)
         call result%timings%begin(phase_write)
      end if
   end subroutine add_extras

end module amontons_reduced_study
