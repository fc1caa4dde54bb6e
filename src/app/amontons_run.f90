!> One run of the program: every deck of the command line, one after the other.
module amontons_run
   use amontons_all_solutions, only: find_all_solutions
   use amontons_body, only: estimate_body, estimate_t
   use amontons_collection, only: collection_t, new_collection
   use amontons_command_line, only: argument_t, command_line_t
   use amontons_condensation, only: condensation_options_t
   use amontons_conditioning, only: rounded
   use amontons_config, only: config_t, read_set_config
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_listing_text, only: scientific, short
   use amontons_output_file, only: commit_files, output_file_t
   use amontons_progress, only: progress_t
   use amontons_report, only: write_report
   use amontons_result, only: certificate_limit, result_t, status_not_converged
   use amontons_run_reduced, only: export_case, run_reduced
   use amontons_screen, only: complain, tell_case
   use amontons_solve_case, only: prepare_case, solve_case, workshop_t
   use amontons_solve_sweep, only: solve_sweep, sweep_result_t
   use amontons_status_line, only: close_status_line, open_status_line
   use amontons_sweep_report, only: write_sweep_report
   use amontons_sweep_tally, only: case_converged
   use amontons_text, only: newline, to_text
   use amontons_timings, only: phase_solve, phase_write
   implicit none (type, external)
   private

   public :: run_decks

   !> Exit status of a sweep that a signal interrupted; the same command goes on with it.
   integer, parameter :: status_interrupted = 5

   !> The files that a deck of the run may write.
   type :: claim_t
      character(:), allocatable :: name !! name of its case; not allocated if it was refused
      logical :: has_grids = .false. !! whether NAME.vtu and NAME.contact.vtu are among them
   end type claim_t

contains

   !> Tries every deck, unless a signal interrupts a sweep; the largest exit status counts.
   subroutine run_decks(command_line, status)
      type(command_line_t), intent(in) :: command_line !! decks and options
      integer, intent(out) :: status !! exit status of the program
      type(workshop_t) :: workshop
      type(claim_t) :: claims(size(command_line%decks))
      type(argument_t) :: grids(size(command_line%decks))
      type(error_t), allocatable :: error
      integer :: i, deck_status

      status = 0
      do i = 1, size(command_line%decks)
         call run_deck(command_line, command_line%decks(i)%text, workshop, claims(:i), grids(i), deck_status, error)
         call tell_error(error, deck_status)
         status = max(status, deck_status)
         if (deck_status == status_interrupted) exit
      end do
      if (size(grids) == 1) return
      call collect_grids(command_line%output, grids, error)
      call tell_error(error, status)
   end subroutine run_decks

   !> Prints an error, if there is one, and raises the exit status to its kind.
   subroutine tell_error(error, status)
      type(error_t), allocatable, intent(in) :: error !! the error
      integer, intent(inout) :: status !! the exit status

      if (.not. allocated(error)) return
      call complain(error%message)
      status = max(status, error%kind)
   end subroutine tell_error

   !> Writes cases.pvd where there are several to step through: the grids of a run, the number of each deck its time.
   subroutine collect_grids(directory, grids, error)
      character(*), intent(in) :: directory !! output directory
      type(argument_t), intent(in) :: grids(:) !! name of the case of each deck, where it left grids to be shown
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(collection_t) :: collection
      type(output_file_t) :: files(1)
      integer :: i

      if (count([(allocated(grids(i)%text), i=1, size(grids))]) < 2) return
      call new_collection(collection, directory//'/cases.pvd', error)
      if (allocated(error)) return
      do i = 1, size(grids)
         if (allocated(grids(i)%text)) call collection%add(i, grids(i)%text)
      end do
      call collection%finish(files(1), error)
      call commit_files(files, error)
   end subroutine collect_grids

   !> Checks or solves one deck.
   subroutine run_deck(command_line, deck, workshop, claims, grid, status, error)
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: deck !! name of the deck
      type(workshop_t), intent(inout) :: workshop !! what decks share
      type(claim_t), intent(inout) :: claims(:) !! of the decks so far; the last one is this deck's
      type(argument_t), intent(inout) :: grid !! gains the name of a case that left grids to be shown
      integer, intent(out) :: status !! 0, `status_not_converged` or `status_interrupted`
      type(error_t), allocatable, intent(out) :: error !! the deck was refused or could not be solved, or told of
      type(config_t) :: config
      logical :: is_solved

      status = 0
      call read_case(config, command_line, deck, claims, error)
      if (allocated(error)) return
      if (.not. command_line%is_quiet) call open_status_line(config%name)
      if (config%reduced%is_given) then
         call run_reduced(command_line, config, is_solved, error)
         if (.not. is_solved) status = status_not_converged
      else if (command_line%is_check) then
         call check_case(command_line, config, workshop, error)
      else if (config%sweep%is_given()) then
         call report_sweep(command_line, config, workshop, status, error)
      else
         call report_case(command_line, config, workshop, grid, status, error)
      end if
      call close_status_line()
      ! What is wrong with a body or a solution is told with the deck it came from.
      if (.not. allocated(error)) return
      if (index(error%message, config%file) /= 1) error%message = config%file//': '//error%message
   end subroutine run_deck

   !> Reads a case and checks it against the options and the cases so far.
   subroutine read_case(config, command_line, deck, claims, error)
      type(config_t), intent(out) :: config !! the case
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: deck !! name of the deck
      type(claim_t), intent(inout) :: claims(:) !! of the decks so far; the last one is this deck's
      type(error_t), allocatable, intent(out) :: error !! the deck was refused
      integer :: i

      call read_set_config(config, deck, command_line%is_reduced, command_line%settings, error)
      if (allocated(error)) then
         do i = 1, size(command_line%settings)
            error%message = error%message//newline//'   with --set '//command_line%settings(i)%text
         end do
         return
      end if
      call claim_name(claims, config, error)
      if (.not. allocated(error)) call check_options(command_line, config, error)
   end subroutine read_case

   !> Refuses a case that would write over the files of an earlier one of this run.
   subroutine claim_name(claims, config, error)
      type(claim_t), intent(inout) :: claims(:) !! of the decks so far; the last one becomes that of the case
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(out) :: error !! the name is taken
      character(:), allocatable :: grid
      integer :: i

      associate (claim => claims(size(claims)))
         claim%has_grids = .not. (config%reduced%is_given .or. config%sweep%is_given())
         do i = 1, size(claims) - 1
            if (.not. allocated(claims(i)%name)) cycle
            if (claims(i)%name == config%name) then
               call new_error(error, input_refused, config%file//": an earlier deck of this run has the case name '" &
                  //config%name//"' too; give each its own &case name")
               return
            end if
            grid = shared_grid(claims(i)%name, config%name)
            if (len(grid) == 0 .or. .not. (claim%has_grids .and. claims(i)%has_grids)) cycle
            call new_error(error, input_refused, config%file//": an earlier deck of this run, with the case name '"// &
               claims(i)%name//"', leaves a file '"//grid//"' as the case '"//config%name// &
               "' does; give this one another &case name")
            return
         end do
         claim%name = config%name
      end associate
   end subroutine claim_name

   !> The grid that two cases of different names would both write; empty if there is none.
   pure function shared_grid(first, second) result(grid)
      character(*), intent(in) :: first !! name of a case
      character(*), intent(in) :: second !! name of another one
      character(:), allocatable :: grid

      grid = ''
      if (first == second//'.contact') grid = first//'.vtu'
      if (second == first//'.contact') grid = second//'.vtu'
   end function shared_grid

   !> Refuses options that the kind of a case leaves no room for.
   subroutine check_options(command_line, config, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(out) :: error !! the options do not go with the case

      if (config%reduced%is_given .or. .not. config%sweep%is_given()) return
      if (command_line%writes_reduced .or. command_line%wants_all_solutions) call new_error(error, input_refused, &
         config%file//': --write-reduced and --all-solutions take single cases, found a deck with &sweep')
   end subroutine check_options

   !> Checks a case and tells its size.
   subroutine check_case(command_line, config, workshop, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(config_t), intent(in) :: config !! the case
      type(workshop_t), intent(inout) :: workshop !! what decks share
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the case
      type(result_t) :: result
      type(estimate_t) :: estimate

      call prepare_case(workshop, config, result, error)
      if (allocated(error)) return
      call estimate_body(workshop%body, condensation_options_t(config%factorization, config%condensation), &
         result%timings, estimate, error)
      if (.not. allocated(error)) call tell_case(command_line, check_text(config, workshop, estimate), config%name, &
         result%warnings, error)
   end subroutine check_case

   !> Solves a case, writes its files and tells how it went.
   subroutine report_case(command_line, config, workshop, grid, status, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(config_t), intent(in) :: config !! the case
      type(workshop_t), intent(inout) :: workshop !! what decks share
      type(argument_t), intent(inout) :: grid !! gains the name of the case if it converged
      integer, intent(out) :: status !! 0, or `status_not_converged`
      type(error_t), allocatable, intent(out) :: error !! the case cannot be solved, or its files not be written
      type(result_t) :: result

      status = 0
      call solve_case(workshop, config, result, error)
      if (allocated(error)) return
      if (command_line%writes_reduced) then
         call export_case(command_line, config, workshop%problem, error)
         if (allocated(error)) return
         result%has_reduced_files = .true.
      end if
      if (command_line%wants_all_solutions) then
         allocate (result%all_solutions)
         call result%timings%begin(phase_solve)
         call find_all_solutions(result%all_solutions, workshop%problem, error)
         if (allocated(error)) return
         call result%timings%begin(phase_write)
      end if
      call write_report(command_line%output, config, workshop%body, result, error)
      if (allocated(error)) return
      if (result%solution%is_converged) grid%text = config%name
      call tell_case(command_line, solved_text(config, result), config%name, result%warnings, error)
      if (.not. result%solution%is_converged) then
         status = status_not_converged
      else if (.not. result%certificate%largest() <= certificate_limit(config%method%tolerance)) then
         status = status_not_converged
         call complain_of_certificate(config, result%condition)
      end if
   end subroutine report_case

   !> Solves the cases of a sweep, writes its files and tells how it went.
   subroutine report_sweep(command_line, config, workshop, status, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(config_t), intent(in) :: config !! the deck
      type(workshop_t), intent(inout) :: workshop !! what decks share
      integer, intent(out) :: status !! 0, `status_not_converged` or `status_interrupted`
      type(error_t), allocatable, intent(out) :: error !! the sweep cannot be solved or written
      type(sweep_result_t) :: result
      type(progress_t) :: progress

      status = 0
      call solve_sweep(workshop, config, command_line%output, progress, result, error)
      call progress%finish()
      if (allocated(error)) return
      if (result%is_interrupted) then
         status = status_interrupted
         call complain(config%file//': interrupted after '//to_text(result%tally%n_cases)//' of '// &
            to_text(config%sweep%n_cases())//' cases; the same command goes on from there')
         return
      end if
      call write_sweep_report(command_line%output, config, workshop%body, result, error)
      if (allocated(error)) return
      call tell_case(command_line, swept_text(config, result), config%name, result%certified%warnings, error)
      if (result%tally%n_outcomes(case_converged) < result%tally%n_cases) then
         status = status_not_converged
      else if (.not. result%certified%certificate%largest() <= certificate_limit(config%method%tolerance)) then
         status = status_not_converged
         call complain_of_certificate(config, result%certified%condition)
      end if
   end subroutine report_sweep

   !> Says that a solution does not hold on the full model, and how well conditioned this is.
   subroutine complain_of_certificate(config, condition)
      type(config_t), intent(in) :: config !! the deck
      real(dp), intent(in) :: condition !! condition number of the stiffness, 0 where it was not estimated [-]
      character(:), allocatable :: reason

      reason = ''
      if (condition > 0.0_dp) reason = '; the condition number of the stiffness is about '//rounded(condition)
      call complain(config%file//': the certificate FAILED on the full model; see the listing'//reason)
   end subroutine complain_of_certificate

   !> What is told of a checked deck.
   pure function check_text(config, workshop, estimate) result(text)
      type(config_t), intent(in) :: config !! the case
      type(workshop_t), intent(in) :: workshop !! its body
      type(estimate_t), intent(in) :: estimate !! what solving it would take
      character(:), allocatable :: text

      associate (body => workshop%body)
         text = config%name//': in order; '//to_text(body%mesh%n_nodes)//' nodes, '//to_text(body%mesh%n_elements)// &
            ' elements, '//to_text(body%dof_map%n_dofs)//' unknowns, '//to_text(body%zone%n_points)//' contact points'
      end associate
      if (config%sweep%is_given()) text = text//', '//to_text(config%sweep%n_cases())//' cases'
      if (config%sweep%n_fields() > 0) text = text//', fields of '//to_text(config%sweep%n_fields())
      text = text//'; '//contact_matrix_text(estimate)//', '//estimate%factorization//' factor of '// &
         to_text(estimate%n_entries)//' entries, about '// &
         to_text(ceiling(estimate%memory_mb))//' MB of memory'
      if (estimate%memory_mb > estimate%available_mb) text = text//', but only '// &
         to_text(floor(estimate%available_mb))//' MB are available'
   end function check_text

   !> The matrix that the contact problem will be solved on.
   pure function contact_matrix_text(estimate) result(text)
      type(estimate_t), intent(in) :: estimate !! what solving the case would take
      character(:), allocatable :: text

      if (estimate%half_width > 0) then
         text = 'band contact matrix of '//to_text(estimate%n_rows)//' rows with half width '// &
            to_text(estimate%half_width)
      else
         text = 'dense contact matrix of '//to_text(estimate%n_rows)//' rows'
      end if
   end function contact_matrix_text

   !> What is told of a solved deck.
   pure function solved_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      text = config%name//': '//trim(merge('solved       ', 'NOT CONVERGED', result%solution%is_converged))//', '// &
         to_text(result%solution%n_iterations)//' iterations, residual '//scientific(result%solution%residual)// &
         '; open '//short(result%lengths%open)//', slip '//short(result%lengths%slip)// &
         ', stick '//short(result%lengths%stick)
   end function solved_text

   !> What is told of a sweep.
   pure function swept_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (tally => result%tally)
         text = config%name//': '//to_text(tally%n_cases)//' cases, '
         if (tally%n_outcomes(case_converged) == tally%n_cases) then
            text = text//'all solved'
         else
            text = text//to_text(tally%n_cases - tally%n_outcomes(case_converged))//' of them NOT SOLVED'
         end if
         if (tally%residual_case == 0) return
         text = text//', residual at most '//scientific(tally%residual)
      end associate
   end function swept_text

end module amontons_run
