!> One run of the program: the decks of the command line, one after the other, or the verification of the results of
!> earlier runs. No two decks may write the same files.
module amontons_run_decks
   use amontons_batch_table, only: find_unchanged, tally_text, update_batch_table
   use amontons_command_line, only: command_line_t
   use amontons_config, only: config_t, new_reduced_config, read_config
   use amontons_error, only: error_t, fault_list_t, input_refused, new_error, warning_list_t
   use amontons_file_check, only: check_collection
   use amontons_kinds, only: dp
   use amontons_manifest, only: case_entries, collection_head, collection_tail
   use amontons_messages, only: print_error, print_info, print_outcome, progress_t
   use amontons_new_study, only: new_study
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_quantity, only: quantity_t
   use amontons_result, only: status_not_converged
   use amontons_solve_case, only: cache_t
   use amontons_study, only: check_study, outcome_t, solve_study, status_interrupted, study_options_t, study_t
   use amontons_system, only: file_name_t, wall_seconds
   use amontons_terminal, only: close_status_line, open_status_line
   use amontons_text, only: newline, to_text
   use amontons_verify, only: find_cases, verdict_t, verify_files
   implicit none (type, external)
   private

   public :: run_decks, verify_directories

   !> Longest time for which rows of batch.csv are kept before they are written [s].
   real(dp), parameter :: seconds_between_rows = 1.0_dp

   !> The files that a deck of the run may write.
   type :: reservation_t
      character(:), allocatable :: name !! name of its case; not allocated if it was refused
      logical :: has_grids = .false. !! whether NAME.vtu and NAME.contact.vtu are among them
   end type reservation_t

contains

   !> Runs the decks one after the other until a signal interrupts one; returns the largest exit status.
   subroutine run_decks(command_line, status)
      type(command_line_t), intent(in) :: command_line !! decks and options
      integer, intent(out) :: status !! exit status of the program
      type(cache_t) :: cache
      type(reservation_t) :: reservations(size(command_line%decks))
      type(outcome_t) :: outcomes(size(command_line%decks))
      type(error_t), allocatable :: error
      real(dp) :: start, noted_at
      integer :: i, n_done, n_noted
      logical :: is_heard

      status = 0
      n_noted = 0
      noted_at = wall_seconds()
      is_heard = .true.
      do i = 1, size(outcomes)
         start = wall_seconds()
         call run_deck(command_line, command_line%decks(i)%text, cache, reservations(:i), outcomes(i))
         outcomes(i)%seconds = wall_seconds() - start
         n_done = i
         status = max(status, outcomes(i)%status)
         call print_outcome(command_line, outcomes(i), error)
         is_heard = is_heard .and. .not. allocated(error)
         call report_error(error, status)
         if (outcomes(i)%status == status_interrupted) exit
         ! A run that is killed leaves its rows.
         if (wall_seconds() - noted_at < seconds_between_rows) cycle
         call write_batch_rows(command_line, outcomes(n_noted + 1:i), status)
         n_noted = i
         noted_at = wall_seconds()
      end do
      call write_batch_rows(command_line, outcomes(n_noted + 1:n_done), status)
      if (size(outcomes) == 1) return
      call collect_grids(command_line%output, outcomes(:n_done), error)
      call report_error(error, status)
      if (.not. is_heard) return
      call print_info(command_line, tally_text(outcomes(:n_done), size(outcomes)), error)
      call report_error(error, status)
   end subroutine run_decks

   !> Writes rows of finished decks to batch.csv, if the command line asks for it.
   subroutine write_batch_rows(command_line, outcomes, status)
      type(command_line_t), intent(in) :: command_line !! decks and options
      type(outcome_t), intent(in) :: outcomes(:) !! what became of the decks
      integer, intent(inout) :: status !! exit status of the program
      type(warning_list_t) :: notes
      type(error_t), allocatable :: error
      integer :: i

      if (command_line%asks('--check')) return
      if (size(command_line%decks) == 1 .and. .not. command_line%asks('--skip-unchanged')) return
      call update_batch_table(command_line%output, outcomes, notes, error)
      do i = 1, notes%n()
         call print_error(notes%item(i))
      end do
      call report_error(error, status)
   end subroutine write_batch_rows

   !> Prints an error, if there is one, and raises the exit status to that of its kind.
   subroutine report_error(error, status)
      type(error_t), allocatable, intent(in) :: error !! the error
      integer, intent(inout) :: status !! the exit status

      if (.not. allocated(error)) return
      call print_error(error%message)
      status = max(status, error%kind)
   end subroutine report_error

   !> Writes cases.pvd if several decks of the run have grids: each grid is listed with the number of its deck as the
   !> time.
   subroutine collect_grids(directory, outcomes, error)
      character(*), intent(in) :: directory !! output directory
      type(outcome_t), intent(in) :: outcomes(:) !! the outcome of each deck
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(output_file_t) :: files(1)
      character(:), allocatable :: entries
      integer :: i

      if (count(outcomes%has_grids) < 2) return
      entries = ''
      do i = 1, size(outcomes)
         if (outcomes(i)%has_grids) entries = entries//case_entries(to_text(i), outcomes(i)%name)
      end do
      call write_text_file(files(1), directory//'/cases.pvd', collection_head//entries//collection_tail, error)
      call commit_files(files, error)
   end subroutine collect_grids

   !> Checks or solves one deck.
   subroutine run_deck(command_line, deck, cache, reservations, outcome)
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: deck !! name of the deck
      type(cache_t), intent(inout) :: cache !! the body that decks share
      type(reservation_t), intent(inout) :: reservations(:) !! of the decks so far; the last one is this deck's
      type(outcome_t), intent(out) :: outcome !! its outcome
      class(study_t), allocatable :: study
      type(study_options_t) :: options
      type(progress_t) :: progress
      type(quantity_t), allocatable :: numbers(:)
      type(error_t), allocatable :: error
      logical :: is_unchanged

      call read_study(study, command_line, deck, error)
      if (.not. allocated(error)) call reserve_files(reservations, study, error)
      if (allocated(error)) then
         call outcome%begin(deck, '')
         call outcome%fail(error)
         return
      end if
      options%directory = command_line%output
      options%writes_reduced = command_line%asks('--write-reduced')
      options%wants_all_solutions = command_line%asks('--all-solutions')
      if (command_line%asks('--skip-unchanged') .and. .not. command_line%asks('--check')) then
         call find_unchanged(is_unchanged, numbers, study%config, command_line%output)
         if (is_unchanged) then
            call outcome%begin(deck, study%config%name)
            call move_alloc(numbers, outcome%numbers)
            outcome%word = 'unchanged'
            outcome%text = study%config%name//': unchanged, not solved again'
            outcome%has_grids = study%has_grids()
            return
         end if
      end if
      if (command_line%asks('--progress') .or. .not. command_line%asks('--quiet')) then
         call open_status_line(study%config%name, has_log=command_line%asks('--progress'))
      end if
      if (command_line%asks('--check')) then
         call check_study(study, cache, options, outcome)
      else
         call solve_study(study, cache, options, progress, outcome)
         call progress%finish()
      end if
      call close_status_line()
   end subroutine run_deck

   !> Reads a deck with the settings of the command line.
   subroutine read_study(study, command_line, deck, error)
      class(study_t), allocatable, intent(out) :: study !! the study that it asks for
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: deck !! name of the deck
      type(error_t), allocatable, intent(out) :: error !! the deck was refused
      type(config_t) :: config
      integer :: i

      if (command_line%asks('--reduced')) then
         call new_reduced_config(config, deck, error, command_line%settings)
      else
         call read_config(config, deck, error, command_line%settings)
      end if
      if (.not. allocated(error)) then
         call new_study(study, config)
         return
      end if
      do i = 1, size(command_line%settings)
         error%message = error%message//newline//'   with --set '//command_line%settings(i)%text
      end do
   end subroutine read_study

   !> Reserves the file names of a study; refuses a study that would overwrite the files of an earlier one of this run.
   subroutine reserve_files(reservations, study, error)
      type(reservation_t), intent(inout) :: reservations(:) !! of the decks so far; the last becomes the study's
      class(study_t), intent(in) :: study !! the study
      type(error_t), allocatable, intent(out) :: error !! the name is taken
      character(:), allocatable :: grid
      integer :: i

      associate (reservation => reservations(size(reservations)), config => study%config)
         reservation%has_grids = study%has_grids()
         do i = 1, size(reservations) - 1
            if (.not. allocated(reservations(i)%name)) cycle
            if (reservations(i)%name == config%name) then
               call new_error(error, input_refused, config%file//": an earlier deck of this run has the case name '" &
                  //config%name//"' too; give each its own &case name")
               return
            end if
            grid = ''
            if (reservations(i)%name == config%name//'.contact') grid = reservations(i)%name//'.vtu'
            if (config%name == reservations(i)%name//'.contact') grid = config%name//'.vtu'
            if (len(grid) == 0 .or. .not. (reservation%has_grids .and. reservations(i)%has_grids)) cycle
            call new_error(error, input_refused, config%file//": an earlier deck of this run, with the case name '"// &
               reservations(i)%name//"', leaves a file '"//grid//"' as the case '"//config%name// &
               "' does; give this one another &case name")
            return
         end do
         reservation%name = config%name
      end associate
   end subroutine reserve_files

   !> Verifies every case in every directory; the largest exit status counts.
   subroutine verify_directories(command_line, status)
      type(command_line_t), intent(in) :: command_line !! the directories, and the options
      integer, intent(out) :: status !! 0 if all are verified and certified
      type(file_name_t), allocatable :: names(:)
      type(verdict_t) :: verdict
      type(cache_t) :: cache
      type(error_t), allocatable :: error
      type(fault_list_t) :: faults
      integer :: i, k

      status = 0
      do i = 1, size(command_line%decks)
         associate (directory => command_line%decks(i)%text)
            call find_cases(names, directory, error)
            if (.not. allocated(error)) then
               do k = 1, size(names)
                  call verify_files(verdict, cache, directory, names(k)%text)
                  if (verdict%is_verified .and. verdict%is_certified) then
                     call print_info(command_line, names(k)%text//': verified'//verdict%remark, error)
                     if (allocated(error)) exit
                  else
                     status = max(status, status_not_converged)
                     if (verdict%is_verified) then
                        call print_error(names(k)%text//': as it was written, but not converged or not certified')
                     else
                        call print_error(names(k)%text//': NOT VERIFIED'//newline//verdict%faults)
                     end if
                  end if
               end do
               call check_collection(faults, directory)
               if (faults%n > 0) then
                  status = max(status, status_not_converged)
                  call print_error('cases.pvd: NOT VERIFIED'//newline//faults%text())
               end if
            end if
         end associate
         if (.not. allocated(error)) cycle
         call print_error(error%message)
         status = max(status, error%kind)
      end do
   end subroutine verify_directories

end module amontons_run_decks
