!> The study of a single case, on its mesh and, if the deck asks for it, on uniformly refined ones: the files are those
!> of the finest mesh, its key results with observed order, extrapolated value and error bar.
module amontons_single_study
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp
   use amontons_listing, only: closed_text
   use amontons_quantity, only: quantity_t, value_of
   use amontons_reduced_system, only: new_condensed_system, reduced_system_t
   use amontons_report, only: write_report
   use amontons_result, only: judge_meshes, refined_quantities, result_t
   use amontons_siconos_text, only: write_reduced_file
   use amontons_solve_case, only: cache_t, prepare_single_case, solve_case
   use amontons_study, only: method_numbers, outcome_t, report_answer, report_size, solution_line, study_monitor_t, &
      study_options_t, study_t
   use amontons_terminal, only: phase_solve, phase_write
   use amontons_text, only: short_text, with_unit
   use amontons_uniqueness, only: find_all_solutions
   implicit none (type, external)
   private

   public :: single_study_t

   !> The study of a single case.
   type, extends(study_t) :: single_study_t
   contains
      procedure :: check => single_study_check
      procedure :: solve => single_study_solve
   end type single_study_t

contains

   !> Checks the case, and reports the size of the finest of its meshes.
   subroutine single_study_check(self, cache, outcome, error)
      class(single_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the case needs another
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! the faults of the deck
      type(config_t) :: config
      type(result_t) :: result

      config = self%config
      config%meshes%n_refinements = config%meshes%n_refinements + config%accuracy%n_refinements
      call prepare_single_case(cache, config, result, error)
      if (.not. allocated(error)) call report_size(config, '', cache, result, outcome, error)
   end subroutine single_study_check

   !> Solves the case on every mesh, the coarsest first, and writes the files of the finest one.
   subroutine single_study_solve(self, cache, options, monitor, outcome, error)
      class(single_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the case needs another
      type(study_options_t), intent(in) :: options !! the options that are not in the deck
      class(study_monitor_t), intent(inout) :: monitor !! not used: a mesh is not interrupted
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solution lacks, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the case cannot be solved, or its files not be written
      type(config_t) :: config
      type(result_t) :: result
      type(quantity_t), allocatable :: list(:)
      real(dp), allocatable :: values(:, :)
      integer :: level, n_levels

      config = self%config
      n_levels = 1 + self%config%accuracy%n_refinements
      config%meshes%n_finest = config%meshes%n_refinements + n_levels - 1
      do level = 1, n_levels
         config%meshes%n_refinements = self%config%meshes%n_refinements + level - 1
         call solve_case(cache, config, result, error)
         if (allocated(error)) exit
         ! A mesh without a solution is the last one: the files say so.
         if (.not. result%solution%is_converged) exit
         cache%is_refining = .true.
         list = refined_quantities(result)
         if (level == 1) allocate (values(size(list), n_levels))
         values(:, level) = list%value
      end do
      cache%is_refining = .false.
      if (n_levels > 1 .and. level > n_levels) call judge_meshes(result, cache%body, values)
      ! The files are those of a case on the last mesh.
      config%accuracy%n_refinements = 0
      call report_case(config, cache, options, result, outcome, error)
      associate (unused => monitor)
      end associate
   end subroutine single_study_solve

   !> Writes the files of a case, with the reduced problem and all solutions if the options ask for them, and sets its
   !> outcome.
   subroutine report_case(config, cache, options, result, outcome, error)
      type(config_t), intent(in) :: config !! the case
      type(cache_t), intent(inout) :: cache !! its body; the contact problem may gain its compliance
      type(study_options_t), intent(in) :: options !! the options that are not in the deck
      type(result_t), intent(inout) :: result !! the result; gains what the options ask for
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solution lacks, and the warnings
      type(error_t), allocatable, intent(inout) :: error
         !! on entry that the case could not be solved; on return that, or that its files cannot be written
      type(reduced_system_t) :: system

      if (allocated(error)) return
      if (allocated(result%answer)) then
         call report_answer(options%directory, config, cache%body, result, outcome, error)
         return
      end if
      if (options%writes_reduced) then
         call new_condensed_system(system, cache%problem, error)
         if (.not. allocated(error)) call write_reduced_file(options%directory, config%name, system, error)
         if (allocated(error)) return
         result%has_reduced_files = .true.
      end if
      if (options%wants_all_solutions) then
         allocate (result%all_solutions)
         call result%timings%begin(phase_solve)
         call find_all_solutions(result%all_solutions, cache%problem, error)
         call result%timings%begin(phase_write)
      end if
      if (.not. allocated(error)) call write_report(options%directory, config, cache%body, result, error)
      if (allocated(error)) return
      outcome%text = solved_text(config%name, result, config%units)
      outcome%warnings = result%warnings
      outcome%numbers = [method_numbers(result%solution), result%key_results, resultants( &
         result%solution%force, size(result%solution%status), result%lengths%are_areas)]
      outcome%has_grids = result%solution%is_converged
      call outcome%judge(result%solution%is_converged, result%solution%residual, result%certificate%largest(), &
         config%method%tolerance, result%condition)
   end subroutine report_case

   !> The line on the result of a case.
   pure function solved_text(name, result, units) result(text)
      character(*), intent(in) :: name !! name of the case
      type(result_t), intent(in) :: result !! the result
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text, dimension

      text = solution_line(name, result%solution)
      if (size(result%solution%status) == 0) then
         text = text//'; no contact set, largest von Mises stress '// &
            number(value_of(result%key_results, 'max_von_mises'), 'F/L^2')//', displacement '// &
            number(value_of(result%key_results, 'max_displacement'), 'L')
      else
         dimension = trim(merge('L^2', 'L  ', result%lengths%are_areas))
         text = text//'; open '//number(result%lengths%open, dimension)//', slip '// &
            number(result%lengths%slip, dimension)//', stick '//number(result%lengths%stick, dimension)//'; '// &
            closed_text(result%solution%status)// &
            ', peak pressure '//number(value_of(result%key_results, 'max_contact_pressure'), 'F/L^2')
      end if

   contains

      !> A number with its unit.
      pure function number(value, dimension) result(labeled)
         real(dp), intent(in) :: value !! the number
         character(*), intent(in) :: dimension !! its dimension
         character(:), allocatable :: labeled

         labeled = with_unit(short_text(value), units, dimension)
      end function number
   end function solved_text

end module amontons_single_study
