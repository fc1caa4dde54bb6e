!> The files that grow with the steps of a history: its table, that of the contact points, that of the states from which
!> it can go on, the grids of some steps.
!>
!> The tables are those of a checkpoint: a history that dies goes on behind the rows that it noted last.
module amontons_history_files
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_checkpoint, only: checkpoint_t, milestone_t, new_checkpoint
   use amontons_collection, only: case_entries, collection_t, collection_tail
   use amontons_error, only: error_t
   use amontons_history, only: is_shown
   use amontons_history_model, only: history_model_t
   use amontons_history_table, only: history_table_t, history_tables, of_grids, table_rows
   use amontons_history_walk, only: history_walk_t
   use amontons_manifest, only: manifest_t
   use amontons_output_file, only: output_file_t, remove_temporaries
   use amontons_result, only: result_t
   use amontons_system, only: make_directory
   use amontons_text, only: to_text
   use amontons_vtu, only: write_grids
   implicit none (type, external)
   private

   public :: history_files_t, new_history_files

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

end module amontons_history_files
