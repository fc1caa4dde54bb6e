!> Tables of numbers in text files: a row a line, numbers separated by blanks, commas, semicolons or tabs.
module amontons_number_table
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_text, only: line_end, newline, read_real, to_text
   use amontons_text_file, only: read_text_file
   implicit none (type, external)
   private

   public :: beside, read_number_table

contains

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
         else if (.not. (is_empty .or. may_be_headings .and. is_word(text(start:)))) then
            call new_error(error, input_refused, file//':'//to_text(line)//': expected '//numbers)
            return
         end if
         may_be_headings = may_be_headings .and. is_empty
      end do
      table = rows(:, :n_rows)
      if (n_rows < 2) call new_error(error, input_refused, file//': expected at least two rows of '//numbers)
   end subroutine read_number_table

   !> Whether a text begins as no number does.
   pure logical function is_word(text)
      character(*), intent(in) :: text !! the text

      is_word = scan(text(:1), '+-.0123456789') == 0
   end function is_word

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

end module amontons_number_table
