!> The rows of a sweep on the disk, such that a run which dies at any moment can be gone on with.
!>
!> Two files grow batch by batch and are removed or renamed at the end. NAME.sweep.part holds the table so far.
!> NAME.sweep.checkpoint begins with the key of the sweep, a text that tells sweeps apart; each further line counts the
!> bytes of the table and holds the tally of their cases. A line is written when its rows are on the disk. What stands
!> behind the last whole line, or behind the bytes that it counts, was in flight and is cut off.
module amontons_sweep_checkpoint
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: int64
   use amontons_sweep_tally, only: sweep_tally_t
   use amontons_system, only: cut_file, remove_file, rename_file, synchronize_file
   use amontons_text, only: newline, to_text
   use amontons_text_file, only: read_text_file
   implicit none (type, external)
   private

   public :: open_sweep_checkpoint, sweep_checkpoint_t

   !> What a whole line ends with.
   character(*), parameter :: line_end = ' rows'//newline

   !> The two files.
   type :: sweep_checkpoint_t
      private
      character(:), allocatable, public :: table_path !! where the table grows
      character(:), allocatable :: path !! where its progress is noted
      integer(int64) :: table_bytes = 0 !! bytes of the table
      integer(int64) :: bytes = 0 !! bytes of the notes
   contains
      procedure, public :: append => sweep_checkpoint_append
      procedure, public :: commit => sweep_checkpoint_commit
      procedure, public :: remove => sweep_checkpoint_remove
   end type sweep_checkpoint_t

contains

   !> Opens the checkpoint of a sweep: the one that an earlier run left, if it has the same key, or a new one.
   subroutine open_sweep_checkpoint(checkpoint, stem, key, header, tally, error)
      type(sweep_checkpoint_t), intent(out) :: checkpoint !! the checkpoint
      character(*), intent(in) :: stem !! directory and name of the case
      character(*), intent(in) :: key !! what the rows depend on, lines of text
      character(*), intent(in) :: header !! first line of the table
      type(sweep_tally_t), intent(out) :: tally !! the cases that are done already
      type(error_t), allocatable, intent(out) :: error !! the files cannot be written
      logical :: is_found

      checkpoint%table_path = stem//'.sweep.part'
      checkpoint%path = stem//'.sweep.checkpoint'
      call find_checkpoint(checkpoint, key, tally, is_found)
      if (is_found) then
         call cut_file(checkpoint%table_path, checkpoint%table_bytes, error)
         if (.not. allocated(error)) call cut_file(checkpoint%path, checkpoint%bytes, error)
      else
         ! What has these names now, a link perhaps, is not written through.
         call remove_file(checkpoint%table_path)
         call remove_file(checkpoint%path)
         call write_bytes(checkpoint%table_path, 'new', header, checkpoint%table_bytes, error)
         if (.not. allocated(error)) call write_bytes(checkpoint%path, 'new', key, checkpoint%bytes, error)
      end if
   end subroutine open_sweep_checkpoint

   !> Looks for a checkpoint with the same key, and for its last whole line.
   subroutine find_checkpoint(checkpoint, key, tally, is_found)
      type(sweep_checkpoint_t), intent(inout) :: checkpoint !! gains the bytes of both files that count
      character(*), intent(in) :: key !! what the rows depend on
      type(sweep_tally_t), intent(out) :: tally !! the cases of the last whole line
      logical, intent(out) :: is_found !! whether there is such a line
      type(error_t), allocatable :: error
      type(sweep_tally_t) :: noted
      character(:), allocatable :: text
      integer(int64) :: n_bytes, size_of_table
      integer :: last, first, status
      logical :: ok

      is_found = .false.
      inquire (file=checkpoint%table_path, size=size_of_table)
      call read_text_file(checkpoint%path, text, error)
      if (allocated(error)) return
      if (index(text, key) /= 1) return
      last = index(text, line_end, back=.true.) + len(line_end) - 1
      if (last < len(key) + len(line_end)) return
      first = index(text(:last - len(line_end)), newline, back=.true.) + 1
      read (text(first:last), *, iostat=status) n_bytes
      call noted%read(text(first + index(text(first:last), ' '):last), ok)
      is_found = status == 0 .and. ok .and. n_bytes <= size_of_table
      if (.not. is_found) return
      tally = noted
      checkpoint%table_bytes = n_bytes
      checkpoint%bytes = last
   end subroutine find_checkpoint

   !> Appends the rows of a batch; they are safe on return.
   subroutine sweep_checkpoint_append(self, rows, tally, error)
      class(sweep_checkpoint_t), intent(inout) :: self !! the checkpoint
      character(*), intent(in) :: rows !! the rows, lines of text
      type(sweep_tally_t), intent(in) :: tally !! the cases done, these included
      type(error_t), allocatable, intent(out) :: error !! the files cannot be written

      call write_bytes(self%table_path, 'old', rows, self%table_bytes, error)
      if (allocated(error)) return
      call write_bytes(self%path, 'old', to_text(self%table_bytes)//' '//tally%text()//line_end, self%bytes, error)
   end subroutine sweep_checkpoint_append

   !> Writes bytes to the end of a file, or to a new one, and has them put on the disk.
   subroutine write_bytes(path, file_status, bytes, n_bytes, error)
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: file_status !! 'old' to append, 'new' to begin
      character(*), intent(in) :: bytes !! what is written
      integer(int64), intent(inout) :: n_bytes !! size of the file before, and after
      type(error_t), allocatable, intent(out) :: error !! not everything could be written
      character(256) :: reason
      integer(int64) :: found
      integer :: unit, status

      reason = ''
      open (newunit=unit, file=path, status=file_status, position='append', action='write', access='stream', &
         form='unformatted', iostat=status, iomsg=reason)
      if (status == 0) then
         write (unit, iostat=status, iomsg=reason) bytes
         if (status == 0) flush (unit, iostat=status, iomsg=reason)
         if (status == 0) then
            close (unit, iostat=status, iomsg=reason)
         else
            close (unit, iostat=status)
         end if
      end if
      if (file_status == 'new') n_bytes = 0
      n_bytes = n_bytes + len(bytes)
      ! What a full disk refuses is lost without a word; and no other run may write here meanwhile.
      inquire (file=path, size=found)
      if (status == 0 .and. found /= n_bytes) reason = to_text(found)//' bytes in the place of '//to_text(n_bytes)// &
         ': the disk may be full, or another run may write to it'
      if (len_trim(reason) == 0) then
         call synchronize_file(path, error)
      else
         call new_error(error, system_failure, path//': cannot write this file: '//trim(reason))
      end if
   end subroutine write_bytes

   !> Gives the complete table its final name.
   subroutine sweep_checkpoint_commit(self, path, error)
      class(sweep_checkpoint_t), intent(in) :: self !! the checkpoint
      character(*), intent(in) :: path !! the final name
      type(error_t), allocatable, intent(out) :: error !! it cannot be renamed

      call rename_file(self%table_path, path, error)
   end subroutine sweep_checkpoint_commit

   !> Removes the notes: nothing is left to go on with.
   subroutine sweep_checkpoint_remove(self)
      class(sweep_checkpoint_t), intent(in) :: self !! the checkpoint

      call remove_file(self%path)
   end subroutine sweep_checkpoint_remove

end module amontons_sweep_checkpoint
