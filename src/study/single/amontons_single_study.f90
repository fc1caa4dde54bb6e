!> The study of a single case, on its mesh and on uniformly refined ones where the deck asks for them: the files are
!> those of the finest mesh, its key results with observed order, extrapolated value and error bar.
module amontons_single_study
   use amontons_all_solutions, only: find_all_solutions
   use amontons_body, only: body_t
   use amontons_conditioning, only: rounded
   use amontons_config, only: config_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp
   use amontons_listing, only: closed_text
   use amontons_loads, only: add_point_forces, load_on_nodes
   use amontons_quantity, only: quantity_t, value_of
   use amontons_reduced_system, only: new_condensed_system, reduced_system_t
   use amontons_report, only: write_report
   use amontons_result, only: has_limit, new_convergence, outcome_no_equilibrium, result_t, word_no_equilibrium
   use amontons_siconos_text, only: write_reduced_file
   use amontons_solve_case, only: cache_t, prepare_single_case, solve_case
   use amontons_study, only: method_numbers, outcome_t, report_size, solution_line, study_monitor_t, study_options_t, &
      study_t
   use amontons_terminal, only: phase_solve, phase_write
   use amontons_text, only: pair_text, short_text, to_text, with_unit
   implicit none (type, external)
   private

   public :: judge_meshes, refined_quantities, single_study_t

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
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the case needs another
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck
      type(config_t) :: config
      type(result_t) :: result
      character(:), allocatable :: meshes

      config = self%config
      meshes = ''
      associate (n => config%accuracy%n_refinements)
         if (n > 0) meshes = ', on the finest of '//to_text(n + 1)//' meshes'
         config%meshes%n_refinements = config%meshes%n_refinements + n
      end associate
      call prepare_single_case(cache, config, result, error)
      if (.not. allocated(error) .and. result%outcome == outcome_no_equilibrium) call new_error(error, &
         numerical_failure, result%answer)
      if (.not. allocated(error)) call report_size(config, meshes, cache, result, outcome, error)
   end subroutine single_study_check

   !> Solves the case on every mesh, the coarsest first, and writes the files of the finest.
   subroutine single_study_solve(self, cache, options, monitor, outcome, error)
      class(single_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the case needs another
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
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

   !> The numbers of a result that are followed over refined meshes.
   pure function refined_quantities(result) result(list)
      type(result_t), intent(in) :: result !! the result on one of the meshes
      type(quantity_t), allocatable :: list(:)

      associate (energies => result%certificate%energies())
         list = [result%lengths%quantities(), result%key_results, energies(:1)]
      end associate
   end function refined_quantities

   !> Judges how each number changes from mesh to mesh. Where a point force acts, a continuum has neither stress nor
   !> displacement: what is largest there grows with every mesh.
   subroutine judge_meshes(result, body, values)
      type(result_t), intent(inout) :: result !! the result on the finest mesh; gains the judgments, and a warning
      type(body_t), intent(in) :: body !! its body
      real(dp), intent(in) :: values(:, :) !! `refined_quantities` of each mesh, a column for a mesh, the coarsest first
      ! Residuals of the contact problem are at most 1e-10 of the largest force; ten times that and more is left of it.
      real(dp), parameter :: rounding = 1.0e-8_dp
      type(quantity_t), allocatable :: list(:)
      type(error_t), allocatable :: error
      character(:), allocatable :: names
      logical :: is_beside(body%mesh%n_nodes)
      real(dp) :: side, forces(2, body%mesh%n_nodes)
      integer :: i, node

      forces = 0.0_dp
      do i = 1, size(result%load_case%loads)
         if (result%load_case%loads(i)%target == load_on_nodes) call add_point_forces(forces, body%mesh, &
            body%materials, result%load_case%loads(i), error)
      end do
      is_beside = .false.
      do i = 1, body%mesh%n_elements
         associate (nodes => body%mesh%node(body%mesh%node_start(i):body%mesh%node_start(i + 1) - 1))
            if (any(abs(forces(:, nodes)) > 0.0_dp)) is_beside(nodes) = .true.
         end associate
      end do
      names = ''
      side = side_at_ends(body%zone, result%solution%status)
      list = refined_quantities(result)
      allocate (result%convergence(size(list)))
      do i = 1, size(list)
         result%convergence(i)%quantity = list(i)
         call new_convergence(result%convergence(i)%convergence, values(i, :), list(i)%resolution*side, &
            rounding*max(maxval(abs(values(i, :))), list(i)%scale), &
            list(i)%has_place .or. list(i)%resolution > 0.0_dp)
         if (.not. list(i)%has_place .or. has_limit(result%convergence(i)%convergence)) cycle
         node = body%mesh%nearest_node(list(i)%place)
         if (any(is_beside(max(1, node):node))) names = names//', '//trim(list(i)%label)//' at '// &
            pair_text(list(i)%place)
      end do
      if (len(names) > 0) call result%warnings%add('numbers that have no limit as the mesh is refined are found '// &
         'where a point force acts: '//names(3:)//'; spread it over a set, by traction or total_force')
   end subroutine judge_meshes

   !> The longest side beside an end of a zone, where one status follows another; of the whole line, if none does [L].
   !> Points within a quadratic side count for their share of it.
   pure real(dp) function side_at_ends(zone, status) result(side)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: status(:) !! their statuses (m)
      integer :: p

      side = 0.0_dp
      do p = 1, zone%n_points
         if (zone%next(p) == 0) cycle
         if (status(p) /= status(zone%next(p))) side = max(side, zone%weight(p), zone%weight(zone%next(p)))
      end do
      if (side <= 0.0_dp .and. zone%n_points > 0) side = maxval(zone%weight)
   end function side_at_ends

   !> Writes the files of a case and says what became of it.
   subroutine report_case(config, cache, options, result, outcome, error)
      type(config_t), intent(in) :: config !! the case
      type(cache_t), intent(inout) :: cache !! its body; the contact problem may gain its compliance
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
      type(result_t), intent(inout) :: result !! the result; gains what the options ask for
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solution lacks, and the warnings
      type(error_t), allocatable, intent(inout) :: error
         !! on entry that the case could not be solved; on return that, or that its files cannot be written

      if (allocated(error)) return
      if (result%outcome == outcome_no_equilibrium) then
         ! This is its answer, not a failure: it has files.
         call outcome%lack(word_no_equilibrium, result%answer)
         outcome%warnings = result%warnings
         call write_report(options%directory, config, cache%body, result, error)
         return
      end if
      call add_extras(config, cache, options, result, error)
      if (.not. allocated(error)) call write_report(options%directory, config, cache%body, result, error)
      if (allocated(error)) return
      outcome%text = solved_text(config%name, result, config%units)
      outcome%warnings = result%warnings
      outcome%numbers = [method_numbers(result%solution), result%key_results, resultants(result%solution%force)]
      outcome%has_grids = result%solution%is_converged
      call outcome%judge(result%solution%is_converged, result%solution%residual, result%certificate%largest(), &
         config%method%tolerance)
      if (result%solution%is_converged .and. outcome%status /= 0 .and. result%condition > 0.0_dp) outcome%message = &
         outcome%message//'; the condition number of the stiffness is about '//rounded(result%condition)
   end subroutine report_case

   !> Adds what the options ask for: the reduced problem in a file, all solutions.
   subroutine add_extras(config, cache, options, result, error)
      type(config_t), intent(in) :: config !! the case
      type(cache_t), intent(inout) :: cache !! its body; the contact problem gains its compliance
      type(study_options_t), intent(in) :: options !! what is asked for
      type(result_t), intent(inout) :: result !! the result; gains all solutions
      type(error_t), allocatable, intent(out) :: error !! there is no reduced problem, or too many points
      type(reduced_system_t) :: system

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
   end subroutine add_extras

   !> The line on the result of a case.
   pure function solved_text(name, result, units) result(text)
      character(*), intent(in) :: name !! name of the case
      type(result_t), intent(in) :: result !! the result
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      text = solution_line(name, result%solution)
      if (size(result%solution%status) == 0) then
         text = text//'; no contact set, largest von Mises stress '// &
            number('max_von_mises', 'F/L^2')//', displacement '//number('max_displacement', 'L')
      else
         text = text//'; open '//length(result%lengths%open)//', slip '//length(result%lengths%slip)// &
            ', stick '//length(result%lengths%stick)//'; '//closed_text(result%solution%status)// &
            ', peak pressure '//number('max_contact_pressure', 'F/L^2')
      end if

   contains

      !> A key result with its unit.
      pure function number(key, dimension) result(labeled)
         character(*), intent(in) :: key !! its name
         character(*), intent(in) :: dimension !! its dimension
         character(:), allocatable :: labeled

         labeled = with_unit(short_text(value_of(result%key_results, key)), units, dimension)
      end function number

      !> A length with its unit.
      pure function length(value) result(labeled)
         real(dp), intent(in) :: value !! the length [L]
         character(:), allocatable :: labeled

         labeled = with_unit(short_text(value), units, 'L')
      end function length
   end function solved_text

end module amontons_single_study
