!> Files that are written as a whole or not at all: written under a temporary name, which is removed by signals, and
!> renamed when complete; and locks that keep two runs from changing the same files. Locks end with the process at the
!> latest.
module amontons_output_file
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: int64
   use amontons_system, only: action, close_file, error_text, file_name_t, list_directory, path_action, &
      remove_directory, remove_file, rename_file
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: adopt_file, commit_files, file_lock_t, hold_signals, lock_directory, lock_file, new_output_file, &
      output_file_t, release_signals, remove_temporaries, write_text_file

   !> A file being written. Until `commit` the final name is untouched.
   type :: output_file_t
      private
      integer, public :: unit = -1 !! the unit to write to while the file is open
      character(:), allocatable, public :: path !! final name
      character(:), allocatable, public :: temporary_path !! name until `commit`
      logical :: is_open = .false. !! whether the unit is open
      logical :: is_kept = .false. !! whether it stays under its temporary name if it is discarded
   contains
      procedure, public :: commit => output_file_commit
      procedure, public :: discard => output_file_discard
      procedure, public :: finish => output_file_finish
   end type output_file_t

   !> A lock, which may be absent.
   type :: file_lock_t
      private
      integer(c_int), public :: file = -1 !! the system's number of the open file; -1 for none
   contains
      procedure, public :: release => file_lock_release
   end type file_lock_t

   !> Blocks signals that end the program until `release_signals`, while several files are renamed. Pairs may be nested.
   procedure(action), bind(c, name='amontons_hold_signals') :: hold_signals
   !> Ends the effect of `hold_signals`; a signal that arrived meanwhile now ends the program.
   procedure(action), bind(c, name='amontons_release_signals') :: release_signals
   procedure(path_action), bind(c, name='amontons_lock_directory') :: c_lock_directory

   ! allow(assumed-size): C takes an address without a shape
   interface
      function c_create_temporary(path, text, size) bind(c, name='amontons_create_temporary') result(code)
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_int), value :: size
         integer(c_int) :: code
      end function c_create_temporary

      subroutine c_forget_temporary(name) bind(c, name='amontons_forget_temporary')
         import :: c_char
         implicit none (type, external)
         character(c_char), intent(in) :: name(*)
      end subroutine c_forget_temporary

      function c_lock_path(path, lock) bind(c, name='amontons_lock_path') result(code)
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_int), intent(inout) :: lock
         integer(c_int) :: code
      end function c_lock_path
   end interface

contains

   !> Opens a file for writing, under a temporary name in the folder of the final one.
   subroutine new_output_file(file, path, is_binary, error)
      type(output_file_t), intent(out) :: file !! the open file
      character(*), intent(in) :: path !! final name
      logical, intent(in) :: is_binary !! whether bytes are written rather than lines
      type(error_t), allocatable, intent(out) :: error !! the file cannot be opened
      character(4096) :: buffer
      character(256) :: reason
      integer :: code, status

      file%path = path
      code = int(c_create_temporary(path//c_null_char, buffer, len(buffer, c_int)))
      if (code /= 0) then
         call new_error(error, system_failure, path//': cannot write this file: '//error_text(code))
         return
      end if
      file%temporary_path = buffer(:index(buffer, c_null_char) - 1)
      reason = ''
      open (newunit=file%unit, file=file%temporary_path, status='old', action='write', access='stream', &
         form=trim(merge('unformatted', 'formatted  ', is_binary)), iostat=status, iomsg=reason)
      file%is_open = status == 0
      if (status /= 0) call give_up(file, trim(reason), error)
   end subroutine new_output_file

   !> Makes an output file of a complete file that awaits its final name; it is kept under its present name if it does
   !> not get the final one.
   pure subroutine adopt_file(file, path, present_path)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! final name
      character(*), intent(in) :: present_path !! its present name

      file%path = path
      file%temporary_path = present_path
      file%is_kept = .true.
   end subroutine adopt_file

   !> Writes a text, lines with their ends, under a temporary name beside the final one.
   subroutine write_text_file(file, path, text, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! final name
      character(*), intent(in) :: text !! the text
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .true., error)
      if (allocated(error)) return
      write (file%unit, iostat=status) text
      call file%finish(status, error)
   end subroutine write_text_file

   !> Closes the file after checking its size; it still has its temporary name.
   subroutine output_file_finish(self, write_status, error)
      class(output_file_t), intent(inout) :: self !! the open file
      integer, intent(in) :: write_status !! status of the last write statement: nonzero means that it failed
      type(error_t), allocatable, intent(out) :: error !! not everything could be written; the file is then discarded
      character(256) :: reason
      integer(int64) :: next_byte, n_bytes
      integer :: status

      status = write_status
      reason = 'the disk may be full'
      inquire (unit=self%unit, pos=next_byte)
      if (status == 0) flush (self%unit, iostat=status, iomsg=reason)
      if (status == 0) close (self%unit, iostat=status, iomsg=reason)
      if (status == 0) then
         self%is_open = .false.
         ! gfortran 12 reports no error if the disk is full: only the size of the file shows it.
         inquire (file=self%temporary_path, size=n_bytes)
         if (n_bytes == next_byte - 1) return
         reason = 'only '//to_text(max(n_bytes, 0_int64))//' of '//to_text(next_byte - 1)//' bytes could be written'
      end if
      call give_up(self, trim(reason), error)
   end subroutine output_file_finish

   !> Removes a file that cannot be written, and makes the error.
   subroutine give_up(file, reason, error)
      class(output_file_t), intent(inout) :: file !! the file, open or not
      character(*), intent(in) :: reason !! why it cannot be written
      type(error_t), allocatable, intent(out) :: error !! the error, with file and reason

      call file%discard()
      call new_error(error, system_failure, file%path//': cannot write this file: '//reason)
   end subroutine give_up

   !> Gives finished files their final names, all of them even if a signal arrives meanwhile; none after an error. The
   !> renaming of two runs in the same directory does not interleave.
   !>
   !> Files of an earlier run without successor are removed before the last file is renamed: as long as the last file
   !> has its old content, which names them, the next run can complete the renaming of a run that is killed here.
   subroutine commit_files(files, error, earlier)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, or those that were begun before an error
      type(error_t), allocatable, intent(inout) :: error
         !! why they are not complete, if they are not: they are then discarded; or why one cannot be renamed
      type(file_name_t), intent(in), optional :: earlier(:) !! files to remove, and their directories if then empty
      type(file_lock_t) :: lock
      integer :: i, k

      call hold_signals()
      if (.not. allocated(error)) call lock_directory(lock, files(1)%path(:index(files(1)%path, '/', back=.true.)))
      do i = 1, size(files)
         if (i == size(files) .and. present(earlier) .and. .not. allocated(error)) then
            do k = 1, size(earlier)
               call remove_file(earlier(k)%text)
               call remove_directory(earlier(k)%text(:index(earlier(k)%text, '/', back=.true.)))
            end do
         end if
         if (.not. allocated(error)) call files(i)%commit(error, lock%file)
         if (allocated(error)) call files(i)%discard()
      end do
      call lock%release()
      call release_signals()
   end subroutine commit_files

   !> Gives the finished file its final name.
   subroutine output_file_commit(self, error, directory)
      class(output_file_t), intent(inout) :: self !! the finished file
      type(error_t), allocatable, intent(out) :: error !! it cannot be renamed; it is then discarded
      integer(c_int), intent(in), optional :: directory !! the system's number of its directory where that is open

      call hold_signals()
      call rename_file(self%temporary_path, self%path, error, directory)
      if (allocated(error)) then
         call self%discard()
      else
         call c_forget_temporary(self%temporary_path//c_null_char)
      end if
      call release_signals()
   end subroutine output_file_commit

   !> Removes the written file, unless it is to be kept; a file with the final name is unchanged.
   subroutine output_file_discard(self)
      class(output_file_t), intent(inout) :: self !! the file, open or finished
      integer :: status

      ! The content is not wanted: it does not matter whether closing the unit writes it.
      ! allow(C181): see above
      if (self%is_open) close (self%unit, iostat=status)
      self%is_open = .false.
      if (.not. allocated(self%temporary_path)) return
      if (.not. self%is_kept) call remove_file(self%temporary_path)
      call c_forget_temporary(self%temporary_path//c_null_char)
      deallocate (self%temporary_path)
   end subroutine output_file_discard

   !> Removes the temporary grids that a killed run has left in its folder.
   subroutine remove_temporaries(folder)
      character(*), intent(in) :: folder !! the folder, a slash behind it; nobody else writes grids into it
      type(file_name_t), allocatable :: names(:)
      type(error_t), allocatable :: error
      integer, parameter :: n_behind = len('.0a1b2c3d.tmp')
      integer :: i, point, first

      call list_directory(names, folder, error)
      if (allocated(error)) return
      do i = 1, size(names)
         ! The name of a temporary grid is 12.vtu.0a1b2c3d.tmp or 12.contact.vtu.0a1b2c3d.tmp.
         associate (name => names(i)%text)
            point = index(name, '.')
            first = len(name) - n_behind + 1
            if (point < 2 .or. first <= point) cycle
            if (name(point:first - 1) /= '.vtu' .and. name(point:first - 1) /= '.contact.vtu') cycle
            if (verify(name(:point - 1), '0123456789') /= 0) cycle
            if (name(first:first) /= '.' .or. name(len(name) - 3:) /= '.tmp') cycle
            if (verify(name(first + 1:len(name) - 4), '0123456789abcdef') == 0) call remove_file(folder//name)
         end associate
      end do
   end subroutine remove_temporaries

   !> Locks a file, which is made if it does not exist; it must not be renamed or replaced while it is locked.
   subroutine lock_file(lock, path, error)
      type(file_lock_t), intent(out) :: lock !! the lock
      character(*), intent(in) :: path !! name of the file
      type(error_t), allocatable, intent(out) :: error !! another run has it, or the file cannot be made
      integer(c_int), parameter :: taken = -1
      integer(c_int) :: code

      code = c_lock_path(path//c_null_char, lock%file)
      if (code == taken) then
         call new_error(error, input_refused, path//': another run is writing this file; wait until it ends, or '// &
            'choose another directory with --output')
      else if (code /= 0) then
         call new_error(error, system_failure, path//': cannot write this file: '//error_text(int(code)))
      end if
   end subroutine lock_file

   !> Locks a directory while files in it are renamed; has no effect if the directory cannot be locked.
   subroutine lock_directory(lock, path)
      type(file_lock_t), intent(out) :: lock !! the lock
      character(*), intent(in) :: path !! name of the directory

      lock%file = c_lock_directory(path//c_null_char)
   end subroutine lock_directory

   !> Releases the lock.
   subroutine file_lock_release(self)
      class(file_lock_t), intent(inout) :: self !! the lock, none on return

      call close_file(self%file)
      self%file = -1
   end subroutine file_lock_release

end module amontons_output_file
