!> The files that grow with the steps of a history: its table, that of the contact points, that of the states from which
!> it can go on, the grids of some steps.
!>
!> The tables are those of a checkpoint: a history that dies goes on behind the rows that it noted last. How far it is,
!> is a line of numbers, from which another history can start, too.
module amontons_history_files
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_checkpoint, only: checkpoint_t, milestone_t, new_checkpoint
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_history, only: history_t, is_shown
   use amontons_history_model, only: history_model_t
   use amontons_history_table, only: history_table_t, history_tables, of_grids, table_rows
   use amontons_history_walk, only: history_walk_t
   use amontons_input_file, only: read_text_file
   use amontons_kinds, only: dp
   use amontons_manifest, only: case_entries, collection_t, collection_tail, manifest_t
   use amontons_output_file, only: output_file_t, remove_temporaries
   use amontons_result, only: result_t
   use amontons_system, only: make_directory
   use amontons_text, only: comma_separated, line_end, newline, read_reals, to_text
   use amontons_vtu, only: write_grids
   implicit none (type, external)
   private

   public :: history_files_t, history_milestone_t, new_history_files, read_start

   !> The files, under names of their own until the history is reported.
   type :: history_files_t
      private
      character(:), allocatable :: directory !! output directory, a slash behind it
      character(:), allocatable :: name !! name of the case
      character(:), allocatable :: folder !! folder of the grids in it, a slash behind it
      type(checkpoint_t), public :: checkpoint !! the tables as they grow
      type(history_table_t), allocatable :: tables(:) !! what they have, in the same order
      integer :: grids_table = 0 !! which of them lists the grids; 0 without grids
      type(collection_t) :: collection !! the units of the grids, and their manifest
   contains
      procedure, public :: add_fields => history_files_add_fields
      procedure, public :: add_step => history_files_add_step
      procedure, public :: finish => history_files_finish
      procedure, public :: open => history_files_open
   end type history_files_t

   !> The numbers, as a line of a checkpoint.
   type, extends(milestone_t) :: history_milestone_t
      real(dp), allocatable :: numbers(:) !! the numbers; not allocated where there are none
   contains
      procedure :: read => history_milestone_read
      procedure :: text => history_milestone_text
   end type history_milestone_t

contains

   !> Names the files that the deck asks for.
   subroutine new_history_files(files, model, body, walk, directory, label)
      type(history_files_t), intent(out) :: files !! the files
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      type(history_walk_t), intent(in) :: walk !! the way, where it begins
      character(*), intent(in) :: directory !! output directory
      class(case_label_t), intent(in) :: label !! what the case is called
      integer :: i

      files%directory = directory//'/'
      files%name = label%name
      files%folder = label%name//'.history/'
      files%collection%units = label%units
      call new_checkpoint(files%checkpoint, directory//'/'//label%name//'.history')
      call history_tables(files%tables, model, body, size(walk%watch%noted()))
      files%grids_table = findloc(files%tables%content, of_grids, dim=1)
      do i = 1, size(files%tables)
         call files%checkpoint%add_table(files%directory//files%name//files%tables(i)%ending//'.part', &
            files%tables(i)%header)
      end do
   end subroutine new_history_files

   !> Opens the files, behind what an earlier run has left of the same history.
   subroutine history_files_open(self, model, key, milestone, error)
      class(history_files_t), intent(inout) :: self !! the files
      type(history_model_t), intent(in) :: model !! the history
      character(*), intent(in) :: key !! what the history depends on, lines of text
      class(milestone_t), intent(inout) :: milestone !! none; gains how far the earlier run came
      type(error_t), allocatable, intent(out) :: error !! they cannot be written

      call make_directory(self%directory, error)
      if (.not. allocated(error) .and. model%history%fields_every > 0) call make_directory(self%directory// &
         self%folder, error)
      if (.not. allocated(error)) call self%checkpoint%open(key, milestone, error)
      if (.not. allocated(error) .and. model%history%fields_every > 0) call remove_temporaries(self%directory// &
         self%folder)
   end subroutine history_files_open

   !> Adds the rows of a step to all tables.
   subroutine history_files_add_step(self, model, body, walk)
      class(history_files_t), intent(inout) :: self !! the files
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      type(history_walk_t), intent(in) :: walk !! the way, at the end of the step
      integer :: i

      do i = 1, size(self%tables)
         call self%checkpoint%add_rows(i, table_rows(self%tables(i), model, body, walk))
      end do
   end subroutine history_files_add_step

   !> Writes the grids of a step.
   subroutine history_files_add_fields(self, body, number, time, result, error)
      class(history_files_t), intent(inout) :: self !! the files, with fields
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the step
      character(*), intent(in) :: time !! its time
      type(result_t), intent(in) :: result !! its result
      type(error_t), allocatable, intent(out) :: error !! a grid cannot be written

      call write_grids(self%collection, self%directory, self%folder, to_text(number), body, result, error)
      if (.not. allocated(error)) call self%checkpoint%add_rows(self%grids_table, case_entries(time, &
         self%folder//to_text(number)))
   end subroutine history_files_add_fields

   !> Ends the tables; they still have names of their own. Grids that an earlier run wrote are listed as they are.
   subroutine history_files_finish(self, model, n_steps, n_resumed, finished, manifest, error)
      class(history_files_t), intent(inout) :: self !! the files
      type(history_model_t), intent(in) :: model !! the history
      integer, intent(in) :: n_steps !! number of its last step
      integer, intent(in) :: n_resumed !! number of the last step of an earlier run
      type(output_file_t), allocatable, intent(out) :: finished(:) !! the finished tables
      type(manifest_t), intent(out) :: manifest !! the manifest of the grids
      type(error_t), allocatable, intent(out) :: error !! not everything could be written
      integer :: table, number

      if (self%grids_table > 0) call self%checkpoint%end_table(self%grids_table, &
         collection_tail, error)
      do number = 1, min(n_steps, n_resumed)
         if (allocated(error)) return
         if (.not. is_shown(number, model%history%fields_every)) cycle
         associate (stem => self%directory//self%folder//to_text(number))
            call self%collection%grids%add_written(stem//'.vtu', stem//'.vtu', self%folder, error)
            if (.not. allocated(error)) call self%collection%grids%add_written(stem//'.contact.vtu', &
               stem//'.contact.vtu', self%folder, error)
         end associate
      end do
      if (allocated(error)) return
      manifest = self%collection%grids
      allocate (finished(size(self%tables)))
      do table = 1, size(finished)
         call self%checkpoint%table_file(finished(table), table, self%directory//self%name//self%tables(table)%ending)
      end do
   end subroutine history_files_finish

   !> Reads the numbers.
   pure subroutine history_milestone_read(self, text, ok)
      class(history_milestone_t), intent(inout) :: self !! gains the numbers
      character(*), intent(in) :: text !! the line
      logical, intent(out) :: ok !! whether it holds numbers and nothing else

      call read_reals(trim(adjustl(text)), self%numbers, ok)
   end subroutine history_milestone_read

   !> The numbers as a line.
   pure function history_milestone_text(self) result(text)
      class(history_milestone_t), intent(in) :: self !! the numbers
      character(:), allocatable :: text

      text = comma_separated(self%numbers)
   end function history_milestone_text

   !> Reads the numbers of the state that a history starts from.
   subroutine read_start(numbers, history, error)
      real(dp), allocatable, intent(out) :: numbers(:) !! the numbers
      type(history_t), intent(in) :: history !! the history, with a start
      type(error_t), allocatable, intent(out) :: error !! there is no such state
      character(:), allocatable :: text
      integer :: first
      logical :: ok

      call read_text_file(history%start, text, error)
      if (allocated(error)) return
      if (history%start_step > 0) then
         first = index(text, newline//to_text(history%start_step)//',') + 1
      else
         first = index(text(:len(text) - 1), newline, back=.true.) + 1
      end if
      ok = index(text, 'step,') == 1
      if (ok .and. history%start_step > 0 .and. first == 1) then
         call new_error(error, input_refused, history%start//': it has no state of step '// &
            to_text(history%start_step)//', only of '//steps_text(text))
         return
      end if
      if (ok) call read_reals(text(first:line_end(text, first)), numbers, ok)
      if (.not. ok) call new_error(error, input_refused, history%start//': expected states of a history, as'// &
         ' NAME.states.csv has them')
   end subroutine read_start

   !> The numbers of the steps whose states a file has; of many the first ones and the last.
   pure function steps_text(states) result(text)
      character(*), intent(in) :: states !! what the file says
      character(:), allocatable :: text
      integer, parameter :: most_named = 12
      integer, allocatable :: starts(:)
      integer :: i, n

      starts = pack([(i, i=1, len(states) - 1)], [(states(i:i) == newline, i=1, len(states) - 1)]) + 1
      n = size(starts)
      text = ''
      do i = 1, n
         if (n > most_named .and. i > most_named - 2 .and. i < n) cycle
         if (n > most_named .and. i == n) text = text//', ...'
         if (i > 1) text = text//', '
         text = text//states(starts(i):starts(i) + index(states(starts(i):)//',', ',') - 2)
      end do
   end function steps_text

end module amontons_history_files
