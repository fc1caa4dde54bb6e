!> The rows of a sweep on the disk, such that a run which dies at any moment can be gone on with.
!>
!> Two files grow batch by batch and are removed or renamed at the end. NAME.sweep.part holds the table so far.
!> NAME.sweep.checkpoint begins with the key of the sweep, a text that tells sweeps apart; each further line counts the
!> bytes of the table and holds the statistics of their cases, the checksum of the table and that of the line. A line is
!> written when its rows are on the disk. What stands behind the last whole line, or behind the bytes that it counts,
!> was in flight and is cut off. Where a checksum is wrong, all begins anew.
!>
!> The checkpoint is locked as long as its run is at work: no second one writes to the same table.
module amontons_sweep_checkpoint
   use amontons_checksum, only: checksum_t, file_checksum, text_checksum
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_file_lock, only: file_lock_t, lock_file
   use amontons_kinds, only: int64
   use amontons_sweep_statistics, only: sweep_statistics_t
   use amontons_system, only: append_to_file, cut_file, remove_file, rename_file
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
      character(:), allocatable :: table_path !! where the table grows
      character(:), allocatable :: path !! where its progress is noted
      logical, public :: is_anew = .false. !! whether an earlier run left rows that could not be gone on with
      type(checksum_t), public :: table !! checksum and bytes of the table
      type(file_lock_t) :: lock !! the lock on the notes
   contains
      procedure, public :: append => sweep_checkpoint_append
      procedure, public :: close => sweep_checkpoint_close
      procedure, public :: commit => sweep_checkpoint_commit
      procedure, public :: remove => sweep_checkpoint_remove
   end type sweep_checkpoint_t

contains

   !> Opens the checkpoint of a sweep: the one that an earlier run left, if it has the same key, or a new one.
   subroutine open_sweep_checkpoint(checkpoint, stem, key, header, statistics, error)
      type(sweep_checkpoint_t), intent(out) :: checkpoint !! the checkpoint
      character(*), intent(in) :: stem !! directory and name of the case
      character(*), intent(in) :: key !! what the rows depend on, lines of text
      character(*), intent(in) :: header !! first line of the table
      type(sweep_statistics_t), intent(out) :: statistics !! the cases that are done already
      type(error_t), allocatable, intent(out) :: error !! the files cannot be written, or another run writes them
      integer(int64) :: notes_bytes
      logical :: is_found

      checkpoint%table_path = stem//'.sweep.part'
      checkpoint%path = stem//'.sweep.checkpoint'
      call lock_file(checkpoint%lock, checkpoint%path, error)
      if (allocated(error)) return
      call find_checkpoint(checkpoint, key, statistics, notes_bytes, is_found)
      if (is_found) then
         call cut_file(checkpoint%table_path, checkpoint%table%n_bytes, error)
         if (.not. allocated(error)) call cut_file(checkpoint%path, notes_bytes, error)
      else
         ! What has this name now, a link perhaps, is not written through. The notes keep their file, which is locked.
         call remove_file(checkpoint%table_path)
         call append_to_file(checkpoint%table_path, .true., header, error)
         call checkpoint%table%add(header)
         if (.not. allocated(error)) call cut_file(checkpoint%path, 0_int64, error)
         if (.not. allocated(error)) call append_to_file(checkpoint%path, .false., key, error)
      end if
      if (allocated(error)) call checkpoint%close()
   end subroutine open_sweep_checkpoint

   !> Looks for a checkpoint with the same key, and for its last whole line.
   subroutine find_checkpoint(checkpoint, key, statistics, notes_bytes, is_found)
      type(sweep_checkpoint_t), intent(inout) :: checkpoint !! gains the bytes of the table that count
      character(*), intent(in) :: key !! what the rows depend on
      type(sweep_statistics_t), intent(out) :: statistics !! the cases of the last whole line
      integer(int64), intent(out) :: notes_bytes !! the bytes of the notes that count
      logical, intent(out) :: is_found !! whether there is such a line, and the table that it tells of
      type(error_t), allocatable :: error
      type(sweep_statistics_t) :: noted
      character(:), allocatable :: text
      type(checksum_t) :: found
      integer(int64) :: n_bytes, noted_checksum
      integer :: last, first
      logical :: ok

      is_found = .false.
      notes_bytes = 0
      call read_text_file(checkpoint%path, text, error)
      if (allocated(error)) return
      checkpoint%is_anew = index(text, line_end) > 0
      if (index(text, key) /= 1) return
      last = index(text, line_end, back=.true.) + len(line_end) - 1
      if (last < len(key) + len(line_end)) return
      first = index(text(:last - len(line_end)), newline, back=.true.) + 1
      call read_line(text(first:last - len(line_end)), n_bytes, noted, noted_checksum, ok)
      if (.not. ok) return
      call file_checksum(found, checkpoint%table_path, error, n_bytes)
      is_found = .not. allocated(error) .and. found%n_bytes == n_bytes .and. found%value() == noted_checksum
      if (.not. is_found) return
      checkpoint%is_anew = .false.
      checkpoint%table = found
      statistics = noted
      notes_bytes = last
   end subroutine find_checkpoint

   !> Reads a line of the notes.
   subroutine read_line(line, n_bytes, statistics, table_checksum, ok)
      character(*), intent(in) :: line !! the line without its end
      integer(int64), intent(out) :: n_bytes !! bytes of the table
      type(sweep_statistics_t), intent(out) :: statistics !! the statistics of their cases
      integer(int64), intent(out) :: table_checksum !! their checksum
      logical, intent(out) :: ok !! whether the line is as it was written
      integer :: first, last, own, status

      n_bytes = 0
      table_checksum = 0
      ! Behind bytes and statistics: a blank, the checksum of the table, a blank, that of the line.
      first = index(line, ' ')
      own = index(line, ' ', back=.true.)
      last = index(line(:max(0, own - 1)), ' ', back=.true.)
      ok = first > 0 .and. first < last
      if (ok) ok = line == with_checksum(line(:own - 1))
      if (ok) read (line(:first), *, iostat=status) n_bytes
      if (ok) ok = status == 0
      if (ok) read (line(last:own), *, iostat=status) table_checksum
      if (ok) ok = status == 0
      if (ok) call statistics%read(line(first:last - 1), ok)
   end subroutine read_line

   !> A line of the notes with its checksum.
   pure function with_checksum(line) result(text)
      character(*), intent(in) :: line !! the line
      character(:), allocatable :: text

      text = line//' '//to_text(text_checksum(line))
   end function with_checksum

   !> Appends the rows of a batch; they are safe on return.
   subroutine sweep_checkpoint_append(self, rows, statistics, error)
      class(sweep_checkpoint_t), intent(inout) :: self !! the checkpoint
      character(*), intent(in) :: rows !! the rows, lines of text
      type(sweep_statistics_t), intent(in) :: statistics !! the cases done, these included
      type(error_t), allocatable, intent(out) :: error !! the files cannot be written
      character(:), allocatable :: line
      integer(int64) :: found

      ! Not every file system has locks.
      inquire (file=self%table_path, size=found)
      if (found == self%table%n_bytes) then
         call append_to_file(self%table_path, .false., rows, error)
      else
         call new_error(error, system_failure, self%table_path//': cannot write this file: '//to_text(found)// &
            ' bytes in the place of '//to_text(self%table%n_bytes)//': another run may write to it')
      end if
      if (allocated(error)) return
      call self%table%add(rows)
      line = to_text(self%table%n_bytes)//' '//statistics%text()//' '//to_text(self%table%value())
      call append_to_file(self%path, .false., with_checksum(line)//line_end, error)
   end subroutine sweep_checkpoint_append

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

   !> Lets another run have the files.
   subroutine sweep_checkpoint_close(self)
      class(sweep_checkpoint_t), intent(inout) :: self !! the checkpoint

      call self%lock%release()
   end subroutine sweep_checkpoint_close

end module amontons_sweep_checkpoint
