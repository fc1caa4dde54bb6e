!> A sparse matrix as CSparse prints it: triplets, or columns; and the words of a reduced problem's text file, taken one
!> after the other across lines.
!>
!> CSparse prints six digits: counts from a million on tell no more than their size.
module amontons_csparse_text
   use amontons_input_file, only: input_file_t
   use amontons_kinds, only: dp
   use amontons_reduced_system, only: entries_t, reduced_system_t
   use amontons_text, only: ends_word, scan_integer, scan_real, to_text
   implicit none (type, external)
   private

   public :: read_csparse, refuse_word, take_choice, take_number, write_csparse

   !> The number that stands for triplets.
   integer, parameter :: origin_triplets = 1
   !> The number that stands for columns.
   integer, parameter :: origin_columns = 2
   !> From here on counts with six digits may be rounded.
   integer, parameter :: first_rounded = 1000000

contains

   !> Reads what CSparse prints of a matrix.
   pure subroutine read_csparse(entries, input, n, form)
      type(entries_t), intent(out) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      character(:), allocatable, intent(out) :: form !! what kind of file this is
      integer :: origin

      call take_choice(input, origin, 'the origin of W: 1 (triplets) or 2 (columns)', &
         [origin_triplets, origin_columns])
      call take_version(input)
      if (origin == origin_triplets) then
         form = 'Siconos text, CSparse triplets'
         call read_triplets(entries, input, n)
      else
         form = 'Siconos text, CSparse columns'
         call read_compressed(entries, input, n)
      end if
   end subroutine read_csparse

   !> Takes the line that tells the version of CSparse or CXSparse.
   pure subroutine take_version(input)
      type(input_file_t), intent(inout) :: input !! the file
      character(:), allocatable :: line
      integer :: place

      if (allocated(input%error)) return
      call input%skip_white()
      place = input%position
      call input%take_line(line)
      if (index(line, 'CSparse Version') /= 1 .and. index(line, 'CXSparse Version') /= 1) call input%refuse( &
         "expected a line that begins with CSparse Version, found '"//line(:min(40, len(line)))//"'", place)
   end subroutine take_version

   !> Takes a count as CSparse prints it: a number of six digits, followed by text that may touch it.
   pure subroutine take_printed(input, value, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the count; from a million on, about
      character(*), intent(in) :: what !! what it means, for the message
      character(*), parameter :: of_a_number = '0123456789.e+'
      real(dp) :: number
      integer :: last, at
      logical :: ok

      value = 0
      if (allocated(input%error)) return
      call input%skip_white()
      last = input%position - 1
      do while (last < len(input%text))
         if (scan(input%text(last + 1:last + 1), of_a_number) == 0) exit
         last = last + 1
      end do
      at = 1
      call scan_real(input%text(input%position:last), at, number, ok)
      if (ok) ok = number <= huge(value)
      if (.not. ok) then
         call input%refuse('expected '//what//', found '//input%word())
         return
      end if
      value = nint(number)
      input%position = last + 1
   end subroutine take_printed

   !> Whether a count is the one printed with six digits.
   pure logical function is_printed(printed, count)
      integer, intent(in) :: printed !! the count as printed
      integer, intent(in) :: count !! the count

      is_printed = printed == count .or. printed >= first_rounded .and. &
         abs(real(printed, dp) - real(count, dp)) <= 5.0e-6_dp*real(count, dp)
   end function is_printed

   !> Takes `M-by-N, nzmax: a nnz: b`.
   pure subroutine take_head(input, n, n_entries)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      integer, intent(out) :: n_entries !! number of entries, as printed
      integer :: n_rows, n_columns, most

      call take_printed(input, n_rows, 'the number of rows of W, such as '//to_text(n)//'-by-'//to_text(n))
      call take_word(input, '-by-')
      call take_printed(input, n_columns, 'the number of columns of W')
      if (.not. (is_printed(n_rows, n) .and. is_printed(n_columns, n))) call refuse_word(input, 'expected W to be '// &
         to_text(n)//'-by-'//to_text(n)//', found '//to_text(n_rows)//'-by-'//to_text(n_columns))
      call take_word(input, ', nzmax:')
      call take_printed(input, most, 'the room for entries (nzmax)')
      call take_word(input, 'nnz:')
      call take_printed(input, n_entries, 'the number of entries (nnz)')
   end subroutine take_head

   !> Reads triplets: lines `row col : value`, counted from 0.
   pure subroutine read_triplets(entries, input, n)
      type(entries_t), intent(out) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      integer :: n_entries, row, column

      call take_word(input, 'triplet:')
      call take_head(input, n, n_entries)
      do while (.not. allocated(input%error))
         call input%skip_white()
         if (n_entries < first_rounded .and. entries%n >= n_entries .or. .not. is_entry(input, 2)) exit
         call take_index(input, row, n, 'row')
         call take_index(input, column, n, 'column')
         call take_entry(entries, input, row, column)
      end do
      if (.not. is_printed(n_entries, entries%n)) call input%refuse('expected '//to_text(n_entries)// &
         ' lines "row col : value" as nnz says, found '//to_text(entries%n)//' and then '//input%word())
   end subroutine read_triplets

   !> Reads compressed columns: for each a line `col j : locations p to q`, then lines `row : value`, counted from 0.
   pure subroutine read_compressed(entries, input, n)
      type(entries_t), intent(out) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      character(:), allocatable :: norm
      integer :: n_entries, column, place

      call take_head(input, n, n_entries)
      place = input%position
      call take_word(input, ', 1-norm:')
      if (allocated(input%error)) return
      call input%take_line(norm)
      do column = 1, n
         call read_column(entries, input, n, column)
         if (allocated(input%error)) return
      end do
      if (.not. is_printed(n_entries, entries%n)) call input%refuse('expected '//to_text(n_entries)// &
         ' entries as nnz says, found '//to_text(entries%n), place)
   end subroutine read_compressed

   !> Reads one compressed column.
   pure subroutine read_column(entries, input, n, column)
      type(entries_t), intent(inout) :: entries !! the matrix up to here
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      integer, intent(in) :: column !! number of the column, from 1
      integer :: next, row

      call take_column_head(input, column, entries%n, next)
      do while (.not. allocated(input%error))
         call input%skip_white()
         if (next < first_rounded .and. entries%n >= next .or. .not. is_entry(input, 1)) exit
         call take_index(input, row, n, 'row')
         call take_entry(entries, input, row, column)
      end do
      if (.not. is_printed(next, entries%n)) call input%refuse('expected lines "row : value" of column '// &
         to_text(column - 1)//' up to location '//to_text(next - 1)//', found '//input%word())
   end subroutine read_column

   !> Takes the line `col j : locations p to q` of a column.
   pure subroutine take_column_head(input, column, n_read, next)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: column !! number of the column, from 1
      integer, intent(in) :: n_read !! number of entries in the columns before
      integer, intent(out) :: next !! number of entries up to the end of this one
      integer :: found

      call take_word(input, 'col')
      call take_printed(input, found, 'the number of a column')
      if (.not. is_printed(found, column - 1)) call refuse_word(input, 'expected column '//to_text(column - 1)// &
         ', found column '//to_text(found))
      call take_word(input, ': locations')
      call take_printed(input, found, 'the first location of a column')
      if (.not. is_printed(found, n_read)) call refuse_word(input, 'expected the column to begin at location '// &
         to_text(n_read)//', found '//to_text(found))
      call take_word(input, 'to')
      call take_last(input, next)
   end subroutine take_column_head

   !> Takes the last location of a column, which is -1 for an empty first one.
   pure subroutine take_last(input, next)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: next !! the location behind the last one

      next = 0
      if (allocated(input%error)) return
      call input%skip_white()
      if (input%text(input%position:min(input%position + 1, len(input%text))) == '-1') then
         input%position = input%position + 2
      else
         call take_printed(input, next, 'the last location of a column')
         next = next + 1
      end if
   end subroutine take_last

   !> Whether a number of integers and a colon come next: an entry, and not yet the numbers of q.
   pure logical function is_entry(input, n_integers)
      type(input_file_t), intent(in) :: input !! the file, not at white space
      integer, intent(in) :: n_integers !! number of integers
      integer :: at, i, number

      at = input%position
      is_entry = .true.
      do i = 1, n_integers
         if (is_entry) call scan_integer(input%text, at, number, is_entry)
         do while (at <= len(input%text))
            if (.not. ends_word(input%text, at)) exit
            at = at + 1
         end do
      end do
      if (is_entry) is_entry = at <= len(input%text)
      if (is_entry) is_entry = input%text(at:at) == ':'
   end function is_entry

   !> Takes an index that counts from 0.
   pure subroutine take_index(input, value, n, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the index, counted from 1
      integer, intent(in) :: n !! number of rows
      character(*), intent(in) :: what !! 'row' or 'column'

      call input%take_numeral(value, 'a row or column of W')
      if (value < 0 .or. value >= n) then
         call refuse_word(input, 'expected a '//what//' from 0 to '//to_text(n - 1)//', found '//to_text(value))
      else
         value = value + 1
      end if
   end subroutine take_index

   !> Takes a colon and the value of an entry.
   pure subroutine take_entry(entries, input, row, column)
      type(entries_t), intent(inout) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: row !! row of the entry
      integer, intent(in) :: column !! column of the entry
      real(dp) :: value
      integer :: place

      call take_word(input, ':')
      place = input%position
      call input%take_real(value, 'an entry of W')
      if (.not. allocated(input%error)) call entries%append(row, column, value, place)
   end subroutine take_entry

   !> Writes W as CSparse prints columns, but with all digits.
   subroutine write_csparse(unit, system, status)
      integer, intent(in) :: unit !! the unit to write to
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      integer, intent(out) :: status !! 0 where all is well
      real(dp) :: norm
      integer :: j, k

      norm = maxval([(sum(abs(system%entry(system%first(j):system%first(j + 1) - 1))), j=1, size(system%q))])
      write (unit, '(i0/a/i0, 3(a, i0), a)', iostat=status) origin_columns, 'CSparse Version 3', size(system%q), &
         '-by-', size(system%q), ', nzmax: ', size(system%entry), ' nnz: ', size(system%entry), &
         ', 1-norm: '//to_text(norm)
      if (status /= 0) return
      do j = 1, size(system%q)
         associate (first => system%first(j), last => system%first(j + 1) - 1)
            write (unit, '(3(a, i0))', iostat=status) '    col ', j - 1, ' : locations ', first - 1, ' to ', last - 1
            if (status /= 0) return
            do k = first, last
               write (unit, '(6x, i0, a)', iostat=status) system%row(k) - 1, ' : '//to_text(system%entry(k))
               if (status /= 0) return
            end do
         end associate
      end do
   end subroutine write_csparse

   !> Takes the next integer.
   pure subroutine take_number(input, value, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! what it means, for the message

      call input%skip_white()
      call input%take_numeral(value, what)
   end subroutine take_number

   !> Takes the next integer, which must be one of a few.
   pure subroutine take_choice(input, value, what, choices)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the number
      character(*), intent(in) :: what !! what it means, for the message
      integer, intent(in) :: choices(:) !! the numbers that are right

      call take_number(input, value, what)
      if (.not. any(choices == value)) call refuse_word(input, 'expected '//what//', found '//to_text(value))
   end subroutine take_choice

   !> Refuses the word just taken.
   pure subroutine refuse_word(input, sentence)
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: sentence !! what is wrong

      call input%refuse(sentence, max(1, input%position - 1))
   end subroutine refuse_word

   !> Takes a given word.
   pure subroutine take_word(input, word)
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: word !! the word
      integer :: last

      if (allocated(input%error)) return
      call input%skip_white()
      last = min(input%position + len(word) - 1, len(input%text))
      if (input%text(input%position:last) == word) then
         input%position = last + 1
      else
         call input%refuse("expected '"//word//"', found "//input%word())
      end if
   end subroutine take_word

end module amontons_csparse_text
