!> Tables of a long study in files, from which a run that ends at any moment can be resumed.
!>
!> The tables have temporary names until the end. STEM.checkpoint begins with the key of the study, a text that
!> distinguishes studies; each further line has the sizes of the tables, the numbers from which the study continues, the
!> checksums of the tables and that of the line. A line is written after its rows are on the disk. Data behind the last
!> complete line, or behind the sizes that it gives, were being written and are cut off. If a checksum is wrong, the
!> study starts anew.
!>
!> The numbers are those of an archive: one visit of the parts of a study writes and reads them.
!>
!> The checkpoint is locked while its run is active, so that no other run writes to the same tables.
module amontons_checkpoint
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_input_file, only: read_text_file
   use amontons_kinds, only: dp, int64
   use amontons_output_file, only: adopt_file, file_lock_t, lock_file, output_file_t
   use amontons_system, only: append_to_file, checksum_t, cut_file, file_checksum, remove_file, text_checksum, &
      wall_seconds
   use amontons_text, only: append_text, comma_separated, newline, read_reals, replaced, to_text
   implicit none (type, external)
   private

   public :: archive_t, checkpoint_t, new_checkpoint

   !> The end of each complete line.
   character(*), parameter :: line_end = ' rows'//newline

   !> Numbers to which the parts of a study are written, or from which they are read, in the same order.
   type :: archive_t
      real(dp), allocatable :: numbers(:) !! the numbers, and room for more while they are written
      logical :: is_read = .false. !! whether they are read
      logical :: is_whole = .true. !! whether no part was asked for that is not there
      integer :: n = 0 !! number of numbers passed
   contains
      procedure, private :: pass_integer => archive_pass_integer
      procedure, private :: pass_integers => archive_pass_integers
      procedure, private :: pass_logical => archive_pass_logical
      procedure, private :: pass_real => archive_pass_real
      procedure, private :: pass_reals => archive_pass_reals
      generic :: pass => pass_integer, pass_integers, pass_logical, pass_real, pass_reals
   end type archive_t

   !> A growing table.
   type :: growing_table_t
      character(:), allocatable :: path !! path of the growing file
      character(:), allocatable :: header !! its first lines
      character(:), allocatable :: rows !! rows that are not on the disk yet, and room for more
      integer :: length = 0 !! their length
      type(checksum_t) :: checksum !! checksum and bytes of what is on the disk
   end type growing_table_t

   !> The tables of a study and their checkpoint file.
   type :: checkpoint_t
      private
      character(:), allocatable :: path !! path of the checkpoint file
      type(growing_table_t), allocatable :: tables(:) !! the tables
      logical, public :: is_anew = .false. !! whether an earlier run left rows that could not be gone on with
      real(dp) :: start = 0.0_dp !! when it was opened [s]
      real(dp) :: last_save = 0.0_dp !! when rows were last put on the disk [s]
      type(file_lock_t) :: lock !! the lock on the notes
   contains
      procedure, public :: add_rows => checkpoint_add_rows
      procedure, public :: add_table => checkpoint_add_table
      procedure, public :: checksum => checkpoint_checksum
      procedure, public :: close => checkpoint_close
      procedure, public :: discard => checkpoint_discard
      procedure, public :: end_table => checkpoint_end_table
      procedure, public :: is_due => checkpoint_is_due
      procedure, public :: open => checkpoint_open
      procedure, public :: remove => checkpoint_remove
      procedure, public :: rows => checkpoint_rows
      procedure, public :: save => checkpoint_save
      procedure, public :: table_file => checkpoint_table_file
   end type checkpoint_t

contains

   !> Writes real numbers to the archive, or reads them. Missing ones are left unchanged.
   pure subroutine archive_pass_reals(self, values)
      class(archive_t), intent(inout) :: self !! the archive
      real(dp), intent(inout) :: values(:) !! the numbers
      integer :: last

      if (.not. allocated(self%numbers)) allocate (self%numbers(0))
      last = self%n + size(values)
      if (self%is_read) then
         self%is_whole = self%is_whole .and. last <= size(self%numbers)
         if (self%is_whole) values = self%numbers(self%n + 1:last)
      else
         if (last > size(self%numbers)) self%numbers = [self%numbers, values, self%numbers]
         self%numbers(self%n + 1:last) = values
      end if
      self%n = last
   end subroutine archive_pass_reals

   !> Writes a real number to the archive, or reads it.
   pure subroutine archive_pass_real(self, value)
      class(archive_t), intent(inout) :: self !! the archive
      real(dp), intent(inout) :: value !! the number
      real(dp) :: values(1)

      values = value
      call self%pass(values)
      value = values(1)
   end subroutine archive_pass_real

   !> Writes integers to the archive, or reads them.
   pure subroutine archive_pass_integers(self, values)
      class(archive_t), intent(inout) :: self !! the archive
      integer, intent(inout) :: values(:) !! the numbers
      real(dp) :: reals(size(values))

      reals = values
      call self%pass(reals)
      values = nint(max(-real(huge(values), dp), min(real(huge(values), dp), reals)))
   end subroutine archive_pass_integers

   !> Writes an integer to the archive, or reads it.
   pure subroutine archive_pass_integer(self, value)
      class(archive_t), intent(inout) :: self !! the archive
      integer, intent(inout) :: value !! the number
      integer :: values(1)

      values = value
      call self%pass(values)
      value = values(1)
   end subroutine archive_pass_integer

   !> Writes a logical to the archive, or reads it.
   pure subroutine archive_pass_logical(self, value)
      class(archive_t), intent(inout) :: self !! the archive
      logical, intent(inout) :: value !! whether it is
      integer :: number

      number = merge(1, 0, value)
      call self%pass(number)
      value = number > 0
   end subroutine archive_pass_logical

   !> Makes a checkpoint with a name. Tables are added before it is opened.
   pure subroutine new_checkpoint(checkpoint, stem)
      type(checkpoint_t), intent(out) :: checkpoint !! the checkpoint
      character(*), intent(in) :: stem !! its file without .checkpoint

      checkpoint%path = stem//'.checkpoint'
      allocate (checkpoint%tables(0))
   end subroutine new_checkpoint

   !> Adds a table to those that grow row by row during a run and whose progress the checkpoint records.
   pure subroutine checkpoint_add_table(self, path, header)
      class(checkpoint_t), intent(inout) :: self !! the checkpoint, not open
      character(*), intent(in) :: path !! path of the growing file
      character(*), intent(in) :: header !! its first lines
      type(growing_table_t) :: table

      table%path = path
      table%header = header
      table%rows = ''
      self%tables = [self%tables, table]
   end subroutine checkpoint_add_table

   !> Opens the checkpoint that an earlier run left, if it has the same key, or a new one.
   subroutine checkpoint_open(self, key, progress, error)
      class(checkpoint_t), intent(inout) :: self !! the checkpoint, with its tables
      character(*), intent(in) :: key !! everything that the rows depend on, lines of text
      type(archive_t), allocatable, intent(out) :: progress
         !! the progress of an earlier run; not allocated if there is none
      type(error_t), allocatable, intent(out) :: error !! the files cannot be written, or another run writes them
      integer(int64) :: notes_bytes
      logical :: is_found
      integer :: i

      call lock_file(self%lock, self%path, error)
      if (allocated(error)) return
      self%start = wall_seconds()
      self%last_save = self%start
      call find_progress(self, key, progress, notes_bytes)
      is_found = allocated(progress)
      do i = 1, size(self%tables)
         if (allocated(error)) exit
         associate (table => self%tables(i))
            if (is_found) then
               call cut_file(table%path, table%checksum%n_bytes, error)
            else
               ! What has this name now, a link perhaps, is not written through.
               call remove_file(table%path)
               call append_to_file(table%path, .true., table%header, error)
               table%checksum = checksum_t()
               call table%checksum%add(table%header)
            end if
         end associate
      end do
      ! The notes keep their file, which is locked.
      if (.not. allocated(error)) call cut_file(self%path, notes_bytes, error)
      if (.not. (allocated(error) .or. is_found)) call append_to_file(self%path, .false., key, error)
      if (allocated(error)) call self%close()
   end subroutine checkpoint_open

   !> Looks for a checkpoint file with the same key, and for its last complete line.
   subroutine find_progress(checkpoint, key, progress, notes_bytes)
      class(checkpoint_t), intent(inout) :: checkpoint !! gains the bytes of the tables that count
      character(*), intent(in) :: key !! everything that the rows depend on
      type(archive_t), allocatable, intent(out) :: progress
         !! that of the last whole line; not allocated unless the tables are those that it describes
      integer(int64), intent(out) :: notes_bytes !! the bytes of the notes that count
      type(error_t), allocatable :: error
      character(:), allocatable :: text
      real(dp), allocatable :: numbers(:)
      integer :: last, first, own, i
      logical :: ok

      notes_bytes = 0_int64
      call read_text_file(checkpoint%path, text, error)
      if (allocated(error)) return
      checkpoint%is_anew = index(text, line_end) > 0
      if (index(text, key) /= 1) return
      last = index(text, line_end, back=.true.) + len(line_end) - 1
      if (last < len(key) + len(line_end)) return
      first = index(text(:last - len(line_end)), newline, back=.true.) + 1
      text = text(first:last - len(line_end))
      own = index(text, ' ', back=.true.)
      if (own == 0) return
      if (text(own:) /= checksum_of(text(:own - 1))) return
      call read_reals(replaced(text(:own - 1), ' ', ','), numbers, ok)
      associate (tables => checkpoint%tables, n => size(checkpoint%tables))
         if (.not. ok .or. size(numbers) < 2*n) return
         do i = 1, n
            call file_checksum(tables(i)%checksum, tables(i)%path, error, nint(numbers(i), int64))
            if (allocated(error)) return
            if (any([tables(i)%checksum%n_bytes, tables(i)%checksum%value()] &
               /= nint([numbers(i), numbers(size(numbers) - n + i)], int64))) return
         end do
         allocate (progress, source=archive_t(numbers(n + 1:size(numbers) - n), is_read=.true.))
      end associate
      checkpoint%is_anew = .false.
      notes_bytes = last
   end subroutine find_progress

   !> What a line of the checkpoint file ends with: its checksum.
   pure function checksum_of(line) result(text)
      character(*), intent(in) :: line !! the line
      character(:), allocatable :: text

      text = ' '//to_text(text_checksum(line))
   end function checksum_of

   !> Adds rows to a table; they are written by the next save.
   pure subroutine checkpoint_add_rows(self, number, rows)
      class(checkpoint_t), intent(inout) :: self !! the checkpoint
      integer, intent(in) :: number !! number of the table, in the order in which they were added
      character(*), intent(in) :: rows !! the rows, lines of text

      call append_text(self%tables(number)%rows, self%tables(number)%length, rows)
   end subroutine checkpoint_add_rows

   !> The rows of a table that are not on the disk yet.
   pure function checkpoint_rows(self, number) result(rows)
      class(checkpoint_t), intent(in) :: self !! the checkpoint
      integer, intent(in) :: number !! number of the table
      character(:), allocatable :: rows

      rows = self%tables(number)%rows(:self%tables(number)%length)
   end function checkpoint_rows

   !> Whether rows should be saved: there are many, or the oldest are older than a second and a hundredth of the run
   !> time, which limits the cost of saving a large progress.
   logical function checkpoint_is_due(self) result(is_due)
      class(checkpoint_t), intent(in) :: self !! the checkpoint
      integer, parameter :: many = 2**20
      real(dp) :: now

      now = wall_seconds()
      is_due = sum(self%tables%length) > many .or. now - self%last_save > max(1.0_dp, 0.01_dp*(now - self%start))
   end function checkpoint_is_due

   !> Writes the added rows to the disk, and the progress that belongs to them.
   subroutine checkpoint_save(self, progress, error)
      class(checkpoint_t), intent(inout) :: self !! the checkpoint
      type(archive_t), intent(in) :: progress !! the progress, two numbers or more, the first one whole
      type(error_t), allocatable, intent(out) :: error !! the files cannot be written
      character(:), allocatable :: line, checksums
      integer(int64) :: found
      integer :: i, length

      line = ''
      checksums = ''
      do i = 1, size(self%tables)
         associate (table => self%tables(i))
            ! Not every file system has locks.
            inquire (file=table%path, size=found)
            if (found == table%checksum%n_bytes) then
               call append_to_file(table%path, .false., table%rows(:table%length), error)
            else
               call new_error(error, system_failure, table%path//': cannot write this file: '//to_text(found)// &
                  ' bytes in the place of '//to_text(table%checksum%n_bytes)//': another run may write to it')
            end if
            if (allocated(error)) return
            call table%checksum%add(table%rows(:table%length))
            table%length = 0
            line = line//to_text(table%checksum%n_bytes)//' '
            checksums = checksums//' '//to_text(table%checksum%value())
         end associate
      end do
      ! The first number, which counts what is done, is written as a whole number.
      line = line//to_text(nint(progress%numbers(1)))//' '
      length = len(line)
      call append_text(line, length, comma_separated(progress%numbers(2:progress%n)))
      call append_text(line, length, checksums)
      call append_text(line, length, checksum_of(line(:length))//line_end)
      call append_to_file(self%path, .false., line(:length), error)
      self%last_save = wall_seconds()
   end subroutine checkpoint_save

   !> Writes the last lines of a table to the disk. A resumed run removes them.
   subroutine checkpoint_end_table(self, number, text, error)
      class(checkpoint_t), intent(inout) :: self !! the checkpoint, all rows saved
      integer, intent(in) :: number !! number of the table
      character(*), intent(in) :: text !! the end
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written

      call append_to_file(self%tables(number)%path, .false., text, error)
      call self%tables(number)%checksum%add(text)
   end subroutine checkpoint_end_table

   !> Checksum and size of the rows of a table.
   pure function checkpoint_checksum(self, number) result(checksum)
      class(checkpoint_t), intent(in) :: self !! the checkpoint
      integer, intent(in) :: number !! number of the table
      type(checksum_t) :: checksum

      checksum = self%tables(number)%checksum
   end function checkpoint_checksum

   !> A complete table as a finished file that awaits its final name.
   pure subroutine checkpoint_table_file(self, file, number, path)
      class(checkpoint_t), intent(in) :: self !! the checkpoint
      type(output_file_t), intent(out) :: file !! the file
      integer, intent(in) :: number !! number of the table
      character(*), intent(in) :: path !! the final name

      call adopt_file(file, path, self%tables(number)%path)
   end subroutine checkpoint_table_file

   !> Removes the checkpoint file, after the last step.
   subroutine checkpoint_remove(self)
      class(checkpoint_t), intent(in) :: self !! the checkpoint

      call remove_file(self%path)
   end subroutine checkpoint_remove

   !> Removes tables and checkpoint file.
   subroutine checkpoint_discard(self)
      class(checkpoint_t), intent(inout) :: self !! the checkpoint
      integer :: i

      do i = 1, size(self%tables)
         call remove_file(self%tables(i)%path)
      end do
      call self%remove()
      call self%close()
   end subroutine checkpoint_discard

   !> Releases the files for another run.
   subroutine checkpoint_close(self)
      class(checkpoint_t), intent(inout) :: self !! the checkpoint

      call self%lock%release()
   end subroutine checkpoint_close

end module amontons_checkpoint
