!> A mesh file in memory, read from its beginning to its end: numbers, lines and the place of the first fault.
!>
!> The first fault stays with the source, and every number taken after it is 0: a reader need not ask after each.
module amontons_mesh_source
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp, int64
   use amontons_numeral, only: ends_word, scan_integer, scan_real
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: mesh_source_t, new_mesh_source, printable

   character, parameter :: line_feed = achar(10)
   !> Longer words are cut in messages.
   integer, parameter :: longest_word = 40

   !> Larger files are refused: their bytes and the things they name are counted by default integers.
   integer, parameter :: most_bytes = 2000000000

   !> A mesh file and a position in it.
   type :: mesh_source_t
      character(:), allocatable :: file !! name of the file
      character(:), allocatable :: text !! every byte of it
      integer :: position = 1 !! where to read next
      logical :: is_binary = .false. !! whether numbers are bytes rather than digits
      logical :: is_swapped = .false. !! whether the bytes of a number stand in the other order than this machine's
      type(error_t), allocatable :: error !! the first fault, once there is one
   contains
      procedure :: check_count => mesh_source_check_count
      procedure :: end_line => mesh_source_end_line
      procedure :: end_record => mesh_source_end_record
      procedure :: refuse => mesh_source_refuse
      procedure :: skip_blanks => mesh_source_skip_blanks
      procedure :: skip_white => mesh_source_skip_white
      procedure :: start_record => mesh_source_start_record
      procedure :: take_count => mesh_source_take_count
      procedure :: take_integer => mesh_source_take_integer
      procedure :: take_line => mesh_source_take_line
      procedure :: take_real => mesh_source_take_real
      procedure :: take_numeral => mesh_source_take_numeral
      procedure :: take_size => mesh_source_take_size
      procedure :: word => mesh_source_word
   end type mesh_source_t

contains

   !> Reads a file into memory.
   subroutine new_mesh_source(source, file, error)
      type(mesh_source_t), intent(out) :: source !! the file in memory
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, is empty or is too large
      character(*), parameter :: no_text = ': this file is empty, or no plain file'
      character(*), parameter :: byte_order_mark = char(239)//char(187)//char(191)
      character(256) :: reason
      integer(int64) :: n_bytes
      integer :: unit, status, at_cause

      source%file = file
      reason = ''
      ! The size is asked for first: to open a pipe could take for ever.
      inquire (file=file, size=n_bytes)
      if (n_bytes == 0) then
         call new_error(error, input_refused, file//no_text)
         return
      end if
      if (n_bytes > most_bytes) then
         call new_error(error, input_refused, file//': this file is larger than '//to_text(most_bytes/10**6)//' MB')
         return
      end if
      open (newunit=unit, file=file, status='old', action='read', access='stream', form='unformatted', &
         iostat=status, iomsg=reason)
      at_cause = index(reason, "': ", back=.true.)
      if (at_cause > 0) reason = reason(at_cause + 3:)
      if (status == 0) then
         allocate (character(n_bytes) :: source%text, stat=status, errmsg=reason)
         if (status == 0) read (unit, iostat=status, iomsg=reason) source%text
         close (unit)
      end if
      if (status /= 0) then
         call new_error(error, input_refused, file//': cannot read this file: '//trim(reason))
      else if (len(source%text) == 0) then
         call new_error(error, input_refused, file//no_text)
      else if (index(source%text(:min(3, len(source%text))), byte_order_mark) == 1) then
         source%position = 4
      end if
   end subroutine new_mesh_source

   !> A text without control characters, which have no place in a message.
   pure function printable(text)
      character(*), intent(in) :: text !! any text
      character(:), allocatable :: printable
      integer :: i

      printable = text
      do i = 1, len(text)
         if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) printable(i:i) = '?'
      end do
   end function printable

   !> Notes a fault, if it is the first: `file:line: sentence`, or `file: sentence (byte n)` in a binary file.
   pure subroutine mesh_source_refuse(self, sentence, place)
      class(mesh_source_t), intent(inout) :: self !! the file
      character(*), intent(in) :: sentence !! what is wrong
      integer, intent(in), optional :: place !! where; default: here
      integer :: at, line, i

      if (allocated(self%error)) return
      at = self%position
      if (present(place)) at = place
      if (self%is_binary) then
         call new_error(self%error, input_refused, self%file//': '//printable(sentence)//' (byte '//to_text(at)//')')
         return
      end if
      line = 1
      do i = 1, min(at, len(self%text) + 1) - 1
         if (self%text(i:i) == line_feed) line = line + 1
      end do
      call new_error(self%error, input_refused, self%file//':'//to_text(line)//': '//printable(sentence))
   end subroutine mesh_source_refuse

   !> The word at the position, as messages quote it.
   pure function mesh_source_word(self) result(word)
      class(mesh_source_t), intent(in) :: self !! the file
      character(:), allocatable :: word
      integer :: last, i

      if (self%position > len(self%text)) then
         word = 'the end of the file'
         return
      end if
      last = self%position - 1
      do while (.not. ends_word(self%text, last + 1) .and. last - self%position < longest_word)
         last = last + 1
      end do
      word = "'"//self%text(self%position:last)//"'"
      do i = 1, len(word)
         if (iachar(word(i:i)) < 32 .or. iachar(word(i:i)) > 126) word(i:i) = '?'
      end do
      if (last < self%position) word = 'the end of the line'
      if (self%text(self%position:self%position) == ',') word = 'a comma'
   end function mesh_source_word

   !> Moves over blanks.
   pure subroutine mesh_source_skip_blanks(self)
      class(mesh_source_t), intent(inout) :: self !! the file

      do while (self%position <= len(self%text))
         select case (iachar(self%text(self%position:self%position)))
         case (iachar(' '), 9, 13)
            self%position = self%position + 1
         case default
            return
         end select
      end do
   end subroutine mesh_source_skip_blanks

   !> Moves over blanks and ends of lines.
   pure subroutine mesh_source_skip_white(self)
      class(mesh_source_t), intent(inout) :: self !! the file

      do
         call self%skip_blanks()
         if (self%position > len(self%text)) return
         if (self%text(self%position:self%position) /= line_feed) return
         self%position = self%position + 1
      end do
   end subroutine mesh_source_skip_white

   !> Moves to the first number of a record: in text, over blanks and empty lines.
   pure subroutine mesh_source_start_record(self)
      class(mesh_source_t), intent(inout) :: self !! the file

      if (.not. self%is_binary) call self%skip_white()
   end subroutine mesh_source_start_record

   !> Moves behind a record; in text, it must end with its line.
   pure subroutine mesh_source_end_record(self)
      class(mesh_source_t), intent(inout) :: self !! the file

      if (.not. self%is_binary) call self%end_line()
   end subroutine mesh_source_end_record

   !> Moves to the next line of text; only blanks may be left on this one.
   pure subroutine mesh_source_end_line(self)
      class(mesh_source_t), intent(inout) :: self !! the file

      if (allocated(self%error)) return
      call self%skip_blanks()
      if (self%position > len(self%text)) return
      if (self%text(self%position:self%position) == line_feed) then
         self%position = self%position + 1
      else
         call self%refuse('expected the end of the line, found '//self%word())
      end if
   end subroutine mesh_source_end_line

   !> Takes the rest of a line of text, without blanks at its ends, and moves to the next line.
   pure subroutine mesh_source_take_line(self, line)
      class(mesh_source_t), intent(inout) :: self !! the file
      character(:), allocatable, intent(out) :: line !! the rest of the line
      integer :: first

      call self%skip_blanks()
      first = self%position
      do while (self%position <= len(self%text))
         if (self%text(self%position:self%position) == line_feed) exit
         self%position = self%position + 1
      end do
      line = trim(self%text(first:self%position - 1))
      self%position = self%position + 1
      if (len(line) == 0) return
      if (line(len(line):) == achar(13)) line = trim(line(:len(line) - 1))
   end subroutine mesh_source_take_line

   !> Takes an integer: four bytes, or a word of text.
   pure subroutine mesh_source_take_integer(self, value, what)
      class(mesh_source_t), intent(inout) :: self !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! what it means, for the message
      character(8) :: bytes

      value = 0
      if (allocated(self%error)) return
      if (self%is_binary) then
         call take_bytes(self, 4, bytes, what)
         value = transfer(bytes(:4), value)
         if (value < -huge(value)) call self%refuse('expected '//what//', found a number out of range', &
            self%position - 4)
         if (allocated(self%error)) value = 0
      else
         call self%take_numeral(value, what)
      end if
   end subroutine mesh_source_take_integer

   !> Takes a word of text as an integer, even in a binary file.
   pure subroutine mesh_source_take_numeral(self, value, what)
      class(mesh_source_t), intent(inout) :: self !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! what it means, for the message
      character(:), allocatable :: found
      logical :: ok

      value = 0
      if (allocated(self%error)) return
      call self%skip_blanks()
      call scan_integer(self%text, self%position, value, ok)
      if (ok) return
      found = self%word()
      if (verify(found, "'0123456789") == 0) found = found//', which is out of range'
      call self%refuse('expected '//what//', found '//found)
   end subroutine mesh_source_take_numeral

   !> Takes a number of things, which stands alone on a line of text, even in a binary file.
   pure subroutine mesh_source_take_count(self, n, things)
      class(mesh_source_t), intent(inout) :: self !! the file
      integer, intent(out) :: n !! the number, not negative
      character(*), intent(in) :: things !! what the things are

      n = 0
      if (allocated(self%error)) return
      call self%skip_white()
      call self%take_numeral(n, 'the number of '//things)
      if (n < 0) call self%refuse('the number of '//things//' is negative: '//to_text(n))
      call self%end_line()
      if (allocated(self%error)) n = 0
   end subroutine mesh_source_take_count

   !> Takes an integer that is not negative: eight bytes, or a word of text.
   pure subroutine mesh_source_take_size(self, value, what)
      class(mesh_source_t), intent(inout) :: self !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! what it means, for the message
      character(8) :: bytes
      integer(int64) :: long
      integer :: place

      place = self%position
      if (self%is_binary) then
         call take_bytes(self, 8, bytes, what)
         long = transfer(bytes, long)
      else
         call self%take_integer(value, what)
         long = value
      end if
      if (long < 0 .or. long > huge(value)) call self%refuse( &
         'expected '//what//', found the number '//to_text(long)//', which is out of range', place)
      value = 0
      if (.not. allocated(self%error)) value = int(long)
   end subroutine mesh_source_take_size

   !> Takes a finite real: eight bytes, or a word of text.
   pure subroutine mesh_source_take_real(self, value, what)
      class(mesh_source_t), intent(inout) :: self !! the file
      real(dp), intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! what it means, for the message
      character(8) :: bytes
      logical :: ok

      value = 0.0_dp
      if (allocated(self%error)) return
      if (self%is_binary) then
         call take_bytes(self, 8, bytes, what)
         value = transfer(bytes, value)
         if (ieee_is_finite(value)) return
         value = 0.0_dp
         call self%refuse('expected '//what//', found a number that is not finite', &
            self%position - 8)
      else
         call self%skip_blanks()
         call scan_real(self%text, self%position, value, ok)
         if (.not. ok) call self%refuse('expected '//what//', found '//self%word())
      end if
   end subroutine mesh_source_take_real

   !> Takes the bytes of a number, in this machine's order.
   pure subroutine take_bytes(source, n, bytes, what)
      type(mesh_source_t), intent(inout) :: source !! the file
      integer, intent(in) :: n !! number of bytes
      character(8), intent(out) :: bytes !! the bytes, all zero where there is a fault
      character(*), intent(in) :: what !! what the number means, for the message
      integer :: i

      bytes = repeat(achar(0), len(bytes))
      if (allocated(source%error)) return
      if (source%position > len(source%text) - n + 1) then
         call source%refuse('expected '//what//', found the end of the file')
         return
      end if
      bytes(:n) = source%text(source%position:source%position + n - 1)
      if (source%is_swapped) then
         do i = 1, n
            bytes(i:i) = source%text(source%position + n - i:source%position + n - i)
         end do
      end if
      source%position = source%position + n
   end subroutine take_bytes

   !> Refuses a number of things that the rest of the file cannot hold.
   pure subroutine mesh_source_check_count(self, n, least_bytes, things)
      class(mesh_source_t), intent(inout) :: self !! the file, behind the number
      integer, intent(in) :: n !! number of things announced, not negative
      integer, intent(in) :: least_bytes !! number of bytes that one takes at least
      character(*), intent(in) :: things !! what they are, for the message
      integer :: n_left

      if (allocated(self%error)) return
      n_left = len(self%text) - self%position + 1
      if (n > n_left/least_bytes) call self%refuse(to_text(n)//' '//things// &
         ' are announced, but the file ends after '//to_text(n_left)//' more bytes')
   end subroutine mesh_source_check_count

end module amontons_mesh_source
