!> The files that grow with the steps of a history: its table, the table of the contact points, the grids of some steps.
module amontons_history_files
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_collection, only: collection_t, new_collection
   use amontons_error, only: error_t
   use amontons_grids, only: write_grids
   use amontons_history_model, only: history_model_t
   use amontons_history_table, only: history_header, history_row, points_header, points_rows
   use amontons_manifest, only: manifest_t
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_result, only: result_t
   use amontons_stepper, only: step_state_t
   use amontons_system, only: make_directory
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: history_files_t, new_history_files

   !> The files, under their temporary names until the history is reported.
   type :: history_files_t
      private
      character(:), allocatable :: directory !! output directory, a slash behind it
      character(:), allocatable :: folder !! folder of the grids in it, a slash behind it
      type(output_file_t) :: table !! NAME.history.csv
      type(output_file_t) :: points !! NAME.points.csv
      type(collection_t) :: collection !! NAME.history.pvd
      logical :: has_points = .false. !! whether the contact points are written
      logical :: has_fields = .false. !! whether grids are written
      integer :: state = 0 !! status of the last write statement; nothing is written after a failure
   contains
      procedure, public :: add_fields => history_files_add_fields
      procedure, public :: add_step => history_files_add_step
      procedure, public :: discard => history_files_discard
      procedure, public :: finish => history_files_finish
   end type history_files_t

contains

   !> Opens the files that the deck asks for.
   subroutine new_history_files(files, model, directory, label, error)
      type(history_files_t), intent(out) :: files !! the files
      type(history_model_t), intent(in) :: model !! the history
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(case_label_t), intent(in) :: label !! what the case is called
      type(error_t), allocatable, intent(out) :: error !! a file cannot be opened
      integer :: state

      files%directory = directory//'/'
      files%folder = label%name//'.history/'
      call make_directory(directory, error)
      if (.not. allocated(error)) call new_output_file(files%table, &
         files%directory//label%name//'.history.csv', .true., error)
      if (allocated(error)) return
      write (files%table%unit, iostat=state) history_header(model%history)
      files%state = state
      if (model%history%points_every > 0) then
         call new_output_file(files%points, files%directory//label%name//'.points.csv', .true., error)
         if (allocated(error)) return
         files%has_points = .true.
         if (state == 0) write (files%points%unit, iostat=state) points_header(model%history)
         files%state = state
      end if
      if (model%history%fields_every == 0) return
      call make_directory(files%directory//files%folder, error)
      if (.not. allocated(error)) call new_collection(files%collection, &
         files%directory//label%name//'.history.pvd', label%units, error)
      files%has_fields = .not. allocated(error)
   end subroutine new_history_files

   !> Writes the row of a step, and the rows of its contact points where they are asked for.
   subroutine history_files_add_step(self, model, body, number, state)
      class(history_files_t), intent(inout) :: self !! the files
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the step
      type(step_state_t), intent(in) :: state !! the state at its end

      ! allow(C181): `finish` checks the state
      if (self%state == 0) write (self%table%unit, iostat=self%state) history_row(model, body, number, state)
      if (.not. self%has_points) return
      if (modulo(number - 1, model%history%points_every) /= 0) return
      ! allow(C181): `finish` checks the state
      if (self%state == 0) write (self%points%unit, iostat=self%state) points_rows(model, body, number, state)
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
      if (.not. allocated(error)) call self%collection%add(time, self%folder//to_text(number))
   end subroutine history_files_add_fields

   !> Closes all files; they still have their temporary names.
   subroutine history_files_finish(self, finished, manifest, error)
      class(history_files_t), intent(inout) :: self !! the files
      type(output_file_t), allocatable, intent(out) :: finished(:) !! the finished files
      type(manifest_t), intent(out) :: manifest !! the manifest of the grids
      type(error_t), allocatable, intent(out) :: error !! not everything could be written
      integer :: n

      allocate (finished(1 + count([self%has_points, self%has_fields])))
      call self%table%finish(self%state, error)
      if (allocated(error)) return
      finished(1) = self%table
      n = 1
      if (self%has_points) then
         call self%points%finish(0, error)
         if (allocated(error)) return
         n = n + 1
         finished(n) = self%points
      end if
      if (.not. self%has_fields) return
      call self%collection%finish(finished(n + 1), error)
      manifest = self%collection%grids
   end subroutine history_files_finish

   !> Removes what was written, but for grids that have their names already.
   subroutine history_files_discard(self)
      class(history_files_t), intent(inout) :: self !! the files

      call self%table%discard()
      if (self%has_points) call self%points%discard()
      if (self%has_fields) call self%collection%discard()
   end subroutine history_files_discard

end module amontons_history_files
