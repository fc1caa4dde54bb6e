!> Whole files, and standard input, read into memory, byte by byte as they are; and tables of numbers in text files:
!> a row a line, numbers separated by blanks, commas, semicolons or tabs.
module amontons_text_file
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_system, only: error_text
   use amontons_text, only: line_end, newline, read_real, to_text
   implicit none (type, external)
   private

   public :: beside, read_number_table, read_standard_input, read_text_file

   !> A larger file is refused before it fills the memory [MB].
   integer, parameter :: largest_megabytes = 256
   integer, parameter :: largest_bytes = largest_megabytes*1000000
   !> The memory that the first bytes go to.
   integer, parameter :: first_length = 65536
   !> The system's number of standard input.
   integer(c_int), parameter :: standard_input = 0
   !> What some editors put before UTF-8 text.
   character(*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      function c_open_input(path) bind(c, name='amontons_open_input') result(file)
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_int) :: file
      end function c_open_input

      subroutine c_close_input(file) bind(c, name='amontons_close_input')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: file
      end subroutine c_close_input

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

contains

   !> Reads a file as it is, without the mark some editors put before UTF-8 text; pipes work as well.
   subroutine read_text_file(file, text, error)
      character(*), intent(in) :: file !! name of the file
      character(:), allocatable, intent(out) :: text !! every byte of it
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, is empty or is too large
      character(:), allocatable :: reason
      integer(c_int) :: number

      text = ''
      number = c_open_input(file//c_null_char)
      if (number < 0) then
         reason = error_text(-int(number))
      else
         call read_bytes(number, text, reason)
         call c_close_input(number)
      end if
      call judge(text, file, reason, error)
   end subroutine read_text_file

   !> Reads standard input to its end, without the mark some editors put before UTF-8 text.
   subroutine read_standard_input(name, text, error)
      character(*), intent(in) :: name !! what messages call it
      character(:), allocatable, intent(out) :: text !! every byte of it
      type(error_t), allocatable, intent(out) :: error !! it cannot be read, is empty or is too large
      character(:), allocatable :: reason

      call read_bytes(standard_input, text, reason)
      call judge(text, name, reason, error)
   end subroutine read_standard_input

   !> Reads every byte of an open file, whose size need not be known.
   subroutine read_bytes(number, text, reason)
      integer(c_int), intent(in) :: number !! the system's number of the file
      character(:), allocatable, intent(out) :: text !! every byte of it
      character(:), allocatable, intent(out) :: reason !! why it cannot be read; empty where all is well
      character(:), allocatable :: longer
      integer(c_long) :: n
      integer :: n_read

      allocate (character(first_length) :: text)
      reason = ''
      n_read = 0
      do while (n_read <= largest_bytes)
         n = c_read_input(number, text(n_read + 1:), len(text, c_long) - n_read)
         if (n <= 0) exit
         n_read = n_read + int(n)
         if (n_read < len(text)) cycle
         allocate (character(2*n_read) :: longer)
         longer(:n_read) = text
         call move_alloc(longer, text)
      end do
      if (n_read > largest_bytes) then
         reason = 'it is larger than '//to_text(largest_megabytes)//' MB'
      else if (n < 0) then
         reason = error_text(-int(n))
      end if
      text = text(:n_read)
   end subroutine read_bytes

   !> Refuses a text that is not whole, or empty, and removes the mark before it.
   subroutine judge(text, name, reason, error)
      character(:), allocatable, intent(inout) :: text !! the text
      character(*), intent(in) :: name !! what messages call it
      character(*), intent(in) :: reason !! why it is not whole; empty if it is
      type(error_t), allocatable, intent(out) :: error !! why it is refused

      if (len(reason) > 0) then
         call new_error(error, input_refused, name//': cannot read this file: '//reason)
      else if (len(text) == 0) then
         call new_error(error, input_refused, name//': this file is empty')
      else if (index(text, byte_order_mark) == 1) then
         text = text(4:)
      end if
   end subroutine judge

   !> Name of a file as seen from the directory of another one; a name from the root on stays as it is.
   pure function beside(reference, file) result(path)
      character(*), intent(in) :: reference !! name of the other file
      character(*), intent(in) :: file !! name as written
      character(:), allocatable :: path

      path = file
      if (index(file, '/') /= 1) path = reference(:index(reference, '/', back=.true.))//file
   end function beside

   !> Reads a table. Empty lines, and lines that begin with `#`, are passed over; so is one line of headings above the
   !> numbers, which does not begin as a number does.
   subroutine read_number_table(table, file, error, n_columns)
      real(dp), allocatable, intent(out) :: table(:, :) !! the table (columns, rows), two rows at the least
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error
         !! the file cannot be read, or a row does not hold as many numbers as there are columns
      integer, intent(in), optional :: n_columns !! number of columns, 2 where it is not present
      character(6), parameter :: counts(4) = [character(6) :: 'one', 'two', 'three', 'four']
      character(:), allocatable :: text, numbers
      real(dp), allocatable :: rows(:, :), row(:)
      integer :: first, last, line, n_rows, start
      logical :: is_empty, is_row, may_be_headings

      call read_text_file(file, text, error)
      if (allocated(error)) return
      allocate (row(2))
      if (present(n_columns)) row = spread(0.0_dp, 1, n_columns)
      numbers = trim(counts(size(row)))//' numbers'
      allocate (rows(size(row), count_lines(text)))
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
         if (is_row) then
            n_rows = n_rows + 1
            rows(:, n_rows) = row
         else if (.not. (is_empty .or. may_be_headings .and. scan(text(start:start), '+-.0123456789') == 0)) then
            call new_error(error, input_refused, file//':'//to_text(line)//': expected '//numbers)
            return
         end if
         may_be_headings = may_be_headings .and. is_empty
      end do
      table = rows(:, :n_rows)
      if (n_rows < 2) call new_error(error, input_refused, file//': expected at least two rows of '//numbers)
   end subroutine read_number_table

   !> Number of lines of a text.
   pure integer function count_lines(text)
      character(*), intent(in) :: text !! the text
      integer :: i

      count_lines = 1
      do i = 1, len(text)
         if (text(i:i) == newline) count_lines = count_lines + 1
      end do
   end function count_lines

   !> Reads a line of numbers.
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

end module amontons_text_file
