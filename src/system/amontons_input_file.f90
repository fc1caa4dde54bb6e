!> Files read into memory: whole files and standard input, byte by byte; tables of numbers, one row per line, separated
!> by blanks, commas, semicolons or tabs; and files read from their beginning to their end, number by number, with the
!> position of the first fault.
!>
!> The first fault is recorded in the file, and every number read after it is 0: a reader need not test after each.
module amontons_input_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use amontons_error, only: error_t, input_refused, new_error, warning_list_t
   use amontons_kinds, only: dp, int64
   use amontons_system, only: close_file, error_text, path_action
   use amontons_text, only: ends_word, line_end, newline, occurrences, read_real, scan_integer, scan_real, to_text
   implicit none (type, external)
   private

   public :: beside, input_file_t, new_input_file, printable, read_number_table, read_plain_file, read_text_file

   !> Largest size of a text that is read into memory [bytes].
   integer, parameter :: largest_text = 256000000
   !> Initial size of the memory for standard input.
   integer, parameter :: first_length = 65536
   !> The file descriptor of standard input.
   integer(c_int), parameter :: standard_input = 0
   !> The mark that some editors put before UTF-8 text.
   character(*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

   procedure(path_action), bind(c, name='amontons_open_input') :: c_open_input

   ! allow(assumed-size): C takes an address without a shape
   interface
      function c_read_input(file, text, n_bytes) bind(c, name='amontons_read_input') result(n_read)
         import :: c_char, c_int, c_long
         implicit none (type, external)
         integer(c_int), value :: file
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_long), value :: n_bytes
         integer(c_long) :: n_read
      end function c_read_input
   end interface

   character, parameter :: line_feed = achar(10)
   !> Longer words are cut in messages.
   integer, parameter :: longest_word = 40

   !> Largest size of a file: its bytes and the items that it names are counted by default integers.
   integer, parameter :: most_bytes = 2000000000

   !> A file and a position in it.
   type :: input_file_t
      character(:), allocatable :: file !! name of the file
      character(:), allocatable :: text !! every byte of it, and of the files that it includes
      type(warning_list_t) :: files !! names of these files, its own first
      integer, private :: counted(2) = 1 !! the place whose line was asked for last, and the line
      integer, allocatable, private :: pieces(:, :)
         !! where each piece of the text begins, the line of its file there, and the number of its file (3, pieces)
      integer :: position = 1 !! position of the next character to be read
      logical :: is_binary = .false. !! whether numbers are bytes rather than digits
      logical :: is_swapped = .false. !! whether the bytes of a number have the other order than on this machine
      type(error_t), allocatable :: error !! the first fault, once there is one
   contains
      procedure :: check_count => input_file_check_count
      procedure :: end_line => input_file_end_line
      procedure :: end_record => input_file_end_record
      procedure :: locate => input_file_locate
      procedure :: refuse => input_file_refuse
      procedure :: refuse_line => input_file_refuse_line
      procedure :: replace => input_file_replace
      procedure :: skip_blanks => input_file_skip_blanks
      procedure :: skip_white => input_file_skip_white
      procedure :: start_record => input_file_start_record
      procedure :: take_count => input_file_take_count
      procedure :: take_integer => input_file_take_integer
      procedure :: take_line => input_file_take_line
      procedure :: take_real => input_file_take_real
      procedure :: take_numeral => input_file_take_numeral
      procedure :: take_size => input_file_take_size
      procedure :: word => input_file_word
   end type input_file_t

contains

   !> Reads a file to its end, byte by byte, without the byte order mark of UTF-8 text; pipes are supported.
   subroutine read_text_file(file, text, error, is_standard_input, n_bytes)
      character(*), intent(in) :: file !! name of the file, or what messages call standard input
      character(:), allocatable, intent(out) :: text !! every byte of it
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, is empty or is too large
      logical, intent(in), optional :: is_standard_input !! whether standard input is read; not by default
      integer(int64), intent(in), optional :: n_bytes !! its size, which may then be larger than that of a text
      character(:), allocatable :: reason, longer
      integer(c_int) :: number
      integer(c_long) :: n
      integer :: n_read, length, most

      number = standard_input
      if (.not. present(is_standard_input)) number = c_open_input(file//c_null_char)
      reason = ''
      n_read = 0
      n = number
      most = largest_text
      length = first_length
      if (present(n_bytes)) most = most_bytes
      if (present(n_bytes)) length = 1 + int(max(0_int64, min(n_bytes, int(most, int64))))
      allocate (character(length) :: text)
      do while (number >= 0 .and. n_read <= most)
         n = c_read_input(number, text(n_read + 1:), len(text, c_long) - n_read)
         if (n <= 0) exit
         n_read = n_read + int(n)
         if (n_read < len(text) .or. n_read > most) cycle
         allocate (character(2*n_read) :: longer)
         longer(:n_read) = text
         call move_alloc(longer, text)
      end do
      if (number >= 0 .and. .not. present(is_standard_input)) call close_file(number)
      text = text(:n_read)
      if (n_read > most) then
         reason = 'it is larger than '//to_text(most/10**6)//' MB'
      else if (n < 0) then
         reason = error_text(-int(n))
      end if
      if (len(reason) > 0) then
         call new_error(error, input_refused, file//': cannot read this file: '//reason)
      else if (n_read == 0) then
         call new_error(error, input_refused, file//': this file is empty')
      else if (index(text, byte_order_mark) == 1) then
         text = text(4:)
      end if
   end subroutine read_text_file

   !> Path of a file relative to the directory of another one; an absolute path is unchanged.
   pure function beside(reference, file) result(path)
      character(*), intent(in) :: reference !! name of the other file
      character(*), intent(in) :: file !! name as written
      character(:), allocatable :: path

      path = file
      if (index(file, '/') /= 1) path = reference(:index(reference, '/', back=.true.))//file
   end function beside

   !> Reads a table. Empty lines, lines that begin with `#` and one line of headings above the numbers are skipped; the
   !> headings must not begin like a number.
   subroutine read_number_table(table, file, error, n_columns, station, least)
      real(dp), allocatable, intent(out) :: table(:, :) !! the table (columns, rows), two rows at the least
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error
         !! the file cannot be read, or a row does not hold as many numbers as there are columns, or others than allowed
      integer, intent(in), optional :: n_columns !! number of columns, 2 where it is not present
      character(*), intent(in), optional :: station !! what the first column holds if it must increase: 'length'
      real(dp), intent(in), optional :: least !! smallest number allowed in the other columns
      character(6), parameter :: counts(4) = [character(6) :: 'one', 'two', 'three', 'four']
      character(:), allocatable :: text, numbers, expected
      real(dp), allocatable :: rows(:, :), row(:)
      integer :: first, last, line, n_rows, start
      logical :: is_empty, is_row, may_be_headings

      call read_text_file(file, text, error)
      if (allocated(error)) return
      allocate (row(2))
      if (present(n_columns)) row = spread(0.0_dp, 1, n_columns)
      numbers = trim(counts(size(row)))//' numbers'
      allocate (rows(size(row), occurrences(text, newline) + 1))
      n_rows = 0
      first = 1
      line = 0
      may_be_headings = .true.
      do while (first <= len(text))
         line = line + 1
         last = line_end(text, first)
         start = first
         call read_row(text(first:last), row, is_row, is_empty)
         first = last + 2
         expected = ''
         if (is_row) then
            n_rows = n_rows + 1
            rows(:, n_rows) = row
            if (present(station) .and. n_rows > 1) then
               if (row(1) <= rows(1, n_rows - 1)) expected = 'a '//station//' above that of the row before'
            end if
            if (present(least)) then
               if (any(row(2:) < least)) expected = 'numbers of at least '//to_text(least)//' behind the first'
            end if
         else if (.not. (is_empty .or. may_be_headings .and. scan(text(start:start), '+-.0123456789') == 0)) then
            expected = numbers
         end if
         if (expected /= '') then
            call new_error(error, input_refused, file//':'//to_text(line)//': expected '//expected)
            return
         end if
         may_be_headings = may_be_headings .and. is_empty
      end do
      table = rows(:, :n_rows)
      if (n_rows < 2) call new_error(error, input_refused, file//': expected at least two rows of '//numbers)
   end subroutine read_number_table

   !> Reads a line of numbers from a table.
   pure subroutine read_row(line, row, is_row, is_empty)
      character(*), intent(in) :: line !! the line
      real(dp), intent(out) :: row(:) !! the numbers
      logical, intent(out) :: is_row !! whether it holds so many numbers and nothing else
      logical, intent(out) :: is_empty !! whether it holds nothing, or a comment
      character(*), parameter :: separators = ' ,;'//achar(9)//achar(13)
      integer :: first, last, n_words

      row = 0.0_dp
      is_row = .true.
      n_words = 0
      first = verify(line, separators)
      is_empty = first == 0
      if (first > 0) is_empty = line(first:first) == '#'
      do while (first > 0 .and. is_row .and. .not. is_empty)
         last = first + scan(line(first:)//' ', separators) - 2
         n_words = n_words + 1
         is_row = n_words <= size(row)
         if (is_row) call read_real(line(first:last), row(n_words), is_row)
         first = 0
         if (last < len(line)) first = verify(line(last + 1:), separators)
         if (first > 0) first = first + last
      end do
      is_row = is_row .and. n_words == size(row)
   end subroutine read_row

   !> Reads a file of any size, unless it is a pipe or a device: to open a pipe could take for ever.
   subroutine read_plain_file(file, text, error)
      character(*), intent(in) :: file !! name of the file
      character(:), allocatable, intent(out) :: text !! every byte of it
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, is empty or is too large
      integer(int64) :: n_bytes

      inquire (file=file, size=n_bytes)
      if (n_bytes == 0) then
         call new_error(error, input_refused, file//': this file is empty, or no plain file')
      else
         call read_text_file(file, text, error, n_bytes=n_bytes)
      end if
   end subroutine read_plain_file

   !> Makes a file in memory, at its beginning.
   subroutine new_input_file(input, file, error)
      type(input_file_t), intent(out) :: input !! the file in memory
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, is empty or is too large

      input%file = file
      call input%files%add(file)
      input%pieces = reshape([1, 1, 1], [3, 1])
      call read_plain_file(file, input%text, error)
   end subroutine new_input_file

   !> A text without control characters, for messages.
   pure function printable(text)
      character(*), intent(in) :: text !! any text
      character(:), allocatable :: printable
      integer :: i

      printable = text
      do i = 1, len(text)
         if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) printable(i:i) = '?'
      end do
   end function printable

   !> Replaces the text between a place and the present one by the text of another file, as `*INCLUDE` does, and moves
   !> to its beginning.
   pure subroutine input_file_replace(self, other, place)
      class(input_file_t), intent(inout) :: self !! the file
      type(input_file_t), intent(in) :: other !! the other file
      integer, intent(in) :: place !! the place
      character(:), allocatable :: file
      integer :: i, line, n_more, number

      n_more = len(other%text) - other%position + 1 - (self%position - place)
      if (n_more > most_bytes - len(self%text)) call self%refuse('larger than '//to_text(most_bytes/10**6)// &
         ' MB with the files that it includes', place)
      if (allocated(self%error)) return
      call self%locate(self%position, file, line)
      do number = 1, self%files%n()
         if (self%files%item(number) == other%file) exit
      end do
      if (number > self%files%n()) call self%files%add(other%file)
      i = count(self%pieces(1, :) <= place)
      self%pieces = reshape([self%pieces(:, :i), reshape([place, 1, number], [3, 1]), &
         reshape([self%position, line, self%pieces(3, i)], [3, 1]), self%pieces(:, i + 1:)], &
         [3, size(self%pieces, 2) + 2])
      self%pieces(1, i + 2:) = self%pieces(1, i + 2:) + n_more
      self%text = self%text(:place - 1)//other%text(other%position:)//self%text(self%position:)
      self%position = place
      self%counted = self%pieces(:2, 1)
   end subroutine input_file_replace

   !> Finds the file and the line of a position in the text. Lines are counted from the position asked for before, if it
   !> is not behind this one and in the same piece.
   pure subroutine input_file_locate(self, place, file, line)
      class(input_file_t), intent(inout) :: self !! the file
      integer, intent(in) :: place !! the place in the text
      character(:), allocatable, intent(out) :: file !! name of the file
      integer, intent(out) :: line !! number of the line
      integer :: piece

      piece = count(self%pieces(1, :) <= place)
      if (self%counted(1) < self%pieces(1, piece) .or. self%counted(1) > place) self%counted = self%pieces(:2, piece)
      self%counted = [place, self%counted(2) + occurrences(self%text(self%counted(1):min(place, len(self%text) + 1) &
         - 1), line_feed)]
      file = self%files%item(self%pieces(3, piece))
      line = self%counted(2)
   end subroutine input_file_locate

   !> Records a fault, if it is the first: `file:line: sentence`, or `file: sentence (byte n)` in a binary file.
   pure subroutine input_file_refuse(self, sentence, place)
      class(input_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: sentence !! the fault, as a sentence
      integer, intent(in), optional :: place !! where; default: here
      character(:), allocatable :: file
      integer :: at, line

      if (allocated(self%error)) return
      at = self%position
      if (present(place)) at = place
      if (self%is_binary) then
         call new_error(self%error, input_refused, self%file//': '//printable(sentence)//' (byte '//to_text(at)//')')
         return
      end if
      call self%locate(at, file, line)
      call new_error(self%error, input_refused, file//':'//to_text(line)//': '//printable(sentence))
   end subroutine input_file_refuse

   !> Refuses the line that ends before the position.
   pure subroutine input_file_refuse_line(self, sentence)
      class(input_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: sentence !! the fault, as a sentence

      call self%refuse(sentence, self%position - 1)
   end subroutine input_file_refuse_line

   !> The word at the position, for messages.
   pure function input_file_word(self) result(word)
      class(input_file_t), intent(in) :: self !! the file
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
   end function input_file_word

   !> Skips blanks.
   pure subroutine input_file_skip_blanks(self)
      class(input_file_t), intent(inout) :: self !! the file

      do while (self%position <= len(self%text))
         select case (iachar(self%text(self%position:self%position)))
         case (iachar(' '), 9, 13)
            self%position = self%position + 1
         case default
            return
         end select
      end do
   end subroutine input_file_skip_blanks

   !> Skips blanks and ends of lines.
   pure subroutine input_file_skip_white(self)
      class(input_file_t), intent(inout) :: self !! the file

      do
         call self%skip_blanks()
         if (self%position > len(self%text)) return
         if (self%text(self%position:self%position) /= line_feed) return
         self%position = self%position + 1
      end do
   end subroutine input_file_skip_white

   !> Moves to the first number of a record: in text, skips blanks and empty lines.
   pure subroutine input_file_start_record(self)
      class(input_file_t), intent(inout) :: self !! the file

      if (.not. self%is_binary) call self%skip_white()
   end subroutine input_file_start_record

   !> Moves to the end of a record; in text, it must end with its line.
   pure subroutine input_file_end_record(self)
      class(input_file_t), intent(inout) :: self !! the file

      if (.not. self%is_binary) call self%end_line()
   end subroutine input_file_end_record

   !> Moves to the next line of text; only blanks may be left on this one.
   pure subroutine input_file_end_line(self)
      class(input_file_t), intent(inout) :: self !! the file

      if (allocated(self%error)) return
      call self%skip_blanks()
      if (self%position > len(self%text)) return
      if (self%text(self%position:self%position) == line_feed) then
         self%position = self%position + 1
      else
         call self%refuse('expected the end of the line, found '//self%word())
      end if
   end subroutine input_file_end_line

   !> Reads the rest of a line of text, without blanks at its ends, and moves to the next line.
   pure subroutine input_file_take_line(self, line)
      class(input_file_t), intent(inout) :: self !! the file
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
   end subroutine input_file_take_line

   !> Reads an integer: four bytes, or a word of text.
   pure subroutine input_file_take_integer(self, value, what)
      class(input_file_t), intent(inout) :: self !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! meaning of the number, for the message
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
   end subroutine input_file_take_integer

   !> Reads a word of text as an integer, also in a binary file.
   pure subroutine input_file_take_numeral(self, value, what)
      class(input_file_t), intent(inout) :: self !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! meaning of the number, for the message
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
   end subroutine input_file_take_numeral

   !> Reads a count, which is alone on a line of text, also in a binary file.
   pure subroutine input_file_take_count(self, n, things)
      class(input_file_t), intent(inout) :: self !! the file
      integer, intent(out) :: n !! the number, not negative
      character(*), intent(in) :: things !! noun for the items, for messages

      n = 0
      if (allocated(self%error)) return
      call self%skip_white()
      call self%take_numeral(n, 'the number of '//things)
      if (n < 0) call self%refuse('the number of '//things//' is negative: '//to_text(n))
      call self%end_line()
      if (allocated(self%error)) n = 0
   end subroutine input_file_take_count

   !> Reads an integer that must not be negative: eight bytes, or a word of text.
   pure subroutine input_file_take_size(self, value, what)
      class(input_file_t), intent(inout) :: self !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! meaning of the number, for the message
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
   end subroutine input_file_take_size

   !> Reads a finite real: eight bytes, or a word of text.
   pure subroutine input_file_take_real(self, value, what)
      class(input_file_t), intent(inout) :: self !! the file
      real(dp), intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! meaning of the number, for the message
      character(8) :: bytes
      logical :: ok

      value = 0.0_dp
      if (allocated(self%error)) return
      if (self%is_binary) then
         call take_bytes(self, 8, bytes, what)
         value = transfer(bytes, value)
         if (ieee_is_finite(value)) return
         value = 0.0_dp
         call self%refuse('expected '//what//', found a number that is not finite', self%position - 8)
      else
         call self%skip_blanks()
         call scan_real(self%text, self%position, value, ok)
         if (.not. ok) call self%refuse('expected '//what//', found '//self%word())
      end if
   end subroutine input_file_take_real

   !> Reads the bytes of a number and converts them to this machine's byte order.
   pure subroutine take_bytes(input, n, bytes, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of bytes
      character(8), intent(out) :: bytes !! the bytes, all zero where there is a fault
      character(*), intent(in) :: what !! meaning of the number, for the message
      integer :: i

      bytes = repeat(achar(0), len(bytes))
      if (allocated(input%error)) return
      if (input%position > len(input%text) - n + 1) then
         call input%refuse('expected '//what//', found the end of the file')
         return
      end if
      bytes(:n) = input%text(input%position:input%position + n - 1)
      if (input%is_swapped) then
         do i = 1, n
            bytes(i:i) = input%text(input%position + n - i:input%position + n - i)
         end do
      end if
      input%position = input%position + n
   end subroutine take_bytes

   !> Refuses a count of items for which the rest of the file is too short.
   pure subroutine input_file_check_count(self, n, least_bytes, things)
      class(input_file_t), intent(inout) :: self !! the file, behind the number
      integer, intent(in) :: n !! number of things announced, not negative
      integer, intent(in) :: least_bytes !! number of bytes that one takes at least
      character(*), intent(in) :: things !! noun for the items, for the message
      integer :: n_left

      if (allocated(self%error)) return
      n_left = len(self%text) - self%position + 1
      if (n > n_left/least_bytes) call self%refuse(to_text(n)//' '//things// &
         ' are announced, but the file ends after '//to_text(n_left)//' more bytes')
   end subroutine input_file_check_count

end module amontons_input_file
