!> Reduced problems in the text files of Siconos (FrictionContactProblem, dimension 2 or 3), read and written. FCLIB's
!> HDF5 files are converted to them first, outside this program.
!>
!> Words separated by white space: dimension, number of contacts, storage of W, W, then q and mu. W is dense (storage 0,
!> column by column), sparse in blocks (1), or what CSparse prints (2).
module amontons_siconos_text
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_input_file, only: input_file_t, new_input_file
   use amontons_kinds, only: dp, int64
   use amontons_output_file, only: commit_files, new_output_file, output_file_t
   use amontons_reduced_system, only: entries_t, new_reduced_system, reduced_system_t
   use amontons_system, only: make_directory
   use amontons_text, only: ends_word, scan_integer, scan_real, to_text
   implicit none (type, external)
   private

   public :: read_reduced_file, write_reduced_file, write_siconos_text

   !> Storage of W: dense.
   integer, parameter :: storage_dense = 0
   !> Storage of W: blocks.
   integer, parameter :: storage_blocks = 1
   !> Storage of W: as CSparse prints it.
   integer, parameter :: storage_csparse = 2

   !> The first bytes of every HDF5 file.
   character(*), parameter :: hdf5_signature = char(137)//'HDF'//achar(13)//achar(10)//achar(26)//achar(10)

   !> CSparse's number for triplets.
   integer, parameter :: origin_triplets = 1
   !> CSparse's number for compressed columns.
   integer, parameter :: origin_columns = 2
   !> Smallest count that may be rounded when printed with six digits.
   integer, parameter :: first_rounded = 1000000

contains

   !> Reads a reduced problem from a file in memory; the first fault is recorded there.
   subroutine read_siconos_text(system, input)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      type(input_file_t), intent(inout) :: input !! the file
      type(entries_t) :: entries
      real(dp), allocatable :: q(:), friction(:)
      character(:), allocatable :: form, sentence
      integer :: dimension, n_contacts, storage, place, flag, i, n, again
      logical :: ok

      call take_choice(input, dimension, 'the dimension, 2 or 3', [2, 3])
      call take_number(input, n_contacts, 'the number of contacts')
      if (n_contacts < 0) call refuse_word(input, 'expected a number of contacts that is not negative, found '// &
         to_text(n_contacts))
      call input%check_count(n_contacts, 2, 'contacts')
      call take_choice(input, storage, 'the storage of W: 0 (dense), 1 (sparse block) or 2 (CSparse)', &
         [storage_dense, storage_blocks, storage_csparse])
      if (allocated(input%error)) return
      do i = 1, 2
         call take_number(input, n, 'the number of '//trim(merge('rows   ', 'columns', i == 1))//' of W')
         if (n /= dimension*n_contacts) call refuse_word(input, 'expected '//to_text(dimension*n_contacts)//' '// &
            trim(merge('rows   ', 'columns', i == 1))//' of W, '//trim(merge('two  ', 'three', dimension == 2))// &
            ' for each contact, found '//to_text(n))
      end do
      if (allocated(input%error)) return
      select case (storage)
      case (storage_dense)
         form = 'Siconos text, dense'
         call take_choice(input, again, 'the number of rows of W again, '//to_text(n), [n])
         call take_choice(input, again, 'the number of columns of W again, '//to_text(n), [n])
         if (int(n, int64)**2 > (len(input%text) - input%position)/2 + 1) call input%refuse(to_text(n)//' x '// &
            to_text(n)//' numbers of W are announced, but the file ends after '// &
            to_text(len(input%text) - input%position + 1)//' more bytes')
         call read_columns(entries, input, 0, 0, n, n)
      case (storage_blocks)
         form = 'Siconos text, sparse block'
         call read_blocks(entries, input, n)
      case default
         call read_csparse(entries, input, n, form)
      end select
      if (allocated(input%error)) return
      allocate (q(n), friction(n_contacts), source=0.0_dp)
      do i = 1, size(q)
         call input%skip_white()
         call input%take_real(q(i), 'a number of q')
         if (allocated(input%error)) return
      end do
      do i = 1, size(friction)
         call input%skip_white()
         call input%take_real(friction(i), 'a coefficient of friction mu')
         if (friction(i) < 0.0_dp) call refuse_word(input, 'mu of contact '//to_text(i)//' is '// &
            to_text(friction(i))//': expected a number that is not negative')
         if (allocated(input%error)) return
      end do
      ! Siconos writes a 1 behind the last coefficient.
      call input%skip_white()
      call scan_integer(input%text, input%position, flag, ok)
      call input%skip_white()
      if (input%position <= len(input%text)) then
         call input%refuse('expected the end of the file behind the last mu, found '//input%word())
         return
      end if
      if (entries%n == 0) allocate (entries%row(0), entries%column(0), entries%value(0), entries%place(0))
      call new_reduced_system(system, entries, q, friction, sentence, place)
      system%dimension = dimension
      system%form = form
      if (allocated(sentence)) call input%refuse(sentence, place)
   end subroutine read_siconos_text

   !> Reads the numbers of a block, column by column; zeros are left out.
   pure subroutine read_columns(entries, input, rows_before, columns_before, n_rows, n_columns)
      type(entries_t), intent(inout) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: rows_before !! number of rows above the block
      integer, intent(in) :: columns_before !! number of columns to the left of the block
      integer, intent(in) :: n_rows !! number of its rows
      integer, intent(in) :: n_columns !! number of its columns
      real(dp) :: value
      integer :: i, j, place

      do j = 1, n_columns
         do i = 1, n_rows
            call input%skip_white()
            place = input%position
            call input%take_real(value, 'a number of W')
            if (allocated(input%error)) return
            if (abs(value) > 0.0_dp) call entries%append(rows_before + i, columns_before + j, value, place)
         end do
      end do
   end subroutine read_columns

   !> Reads a matrix of blocks.
   pure subroutine read_blocks(entries, input, n)
      type(entries_t), intent(out) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      integer, allocatable :: row_end(:), column_end(:), first(:), block_column(:)
      integer :: n_blocks, n_block_rows, n_block_columns, number, least, i, k

      call take_count(input, n_blocks, 'blocks', least=0)
      call take_count(input, n_block_rows, 'block rows', least=min(1, n))
      call take_count(input, n_block_columns, 'block columns', least=min(1, n))
      call take_ends(row_end, input, n_block_rows, n, 'row')
      call take_ends(column_end, input, n_block_columns, n, 'column')
      call take_choice(input, number, 'the number of block row pointers, '//to_text(n_block_rows + 1), &
         [n_block_rows + 1])
      call take_choice(input, number, 'the number of blocks again, '//to_text(n_blocks), [n_blocks])
      call input%check_count(n_blocks, 2, 'blocks')
      if (allocated(input%error)) return
      allocate (first(0:n_block_rows), block_column(n_blocks))
      ! Where the blocks of each block row begin, and their end.
      least = 0
      do i = 0, n_block_rows
         call take_number(input, first(i), 'a block row pointer')
         if (i == n_block_rows) least = n_blocks
         if (first(i) < least .or. first(i) > merge(0, n_blocks, i == 0)) call refuse_word(input, 'expected block '// &
            'row pointers that ascend from 0 to '//to_text(n_blocks)//', found '//to_text(first(i)))
         if (allocated(input%error)) return
         least = first(i)
      end do
      do k = 1, n_blocks
         call take_number(input, block_column(k), 'the block column of a block')
         if (block_column(k) < 0 .or. block_column(k) >= n_block_columns) call refuse_word(input, &
            'expected a block column from 0 to '//to_text(n_block_columns - 1)//', found '//to_text(block_column(k)))
      end do
      do i = 1, n_block_rows
         do k = first(i - 1) + 1, first(i)
            call take_choice(input, number, 'the number of the block, '//to_text(k - 1), [k - 1])
            if (allocated(input%error)) return
            associate (j => block_column(k) + 1)
               call read_columns(entries, input, row_end(i - 1), column_end(j - 1), row_end(i) - row_end(i - 1), &
                  column_end(j) - column_end(j - 1))
            end associate
         end do
      end do
   end subroutine read_blocks

   !> Reads a count.
   pure subroutine take_count(input, n_things, things, least)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: n_things !! the number, at least 0 where there is no fault
      character(*), intent(in) :: things !! noun for the items, for messages
      integer, intent(in) :: least !! the least number that is right

      call take_number(input, n_things, 'the number of '//things)
      if (n_things < least) call refuse_word(input, 'expected a number of '//things//' of at least '// &
         to_text(least)//', found '//to_text(n_things))
   end subroutine take_count

   !> Reads the ends of the block rows or columns.
   pure subroutine take_ends(ends, input, n_blocks, n, what)
      integer, allocatable, intent(out) :: ends(:) !! number of rows up to the end of each block row (0:n_blocks)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n_blocks !! number of block rows
      integer, intent(in) :: n !! number of rows
      character(*), intent(in) :: what !! 'row' or 'column'
      integer :: i

      call input%check_count(n_blocks, 2, 'block '//what//'s')
      if (allocated(input%error)) return
      allocate (ends(0:n_blocks), source=0)
      do i = 1, n_blocks
         call take_number(input, ends(i), 'the '//what//' that a block '//what//' ends with')
         if (ends(i) <= ends(i - 1) .or. ends(i) > n .or. i == n_blocks .and. ends(i) /= n) call refuse_word(input, &
            'expected the ends of the block '//what//'s to ascend to '//to_text(n)//', found '//to_text(ends(i)))
         if (allocated(input%error)) return
      end do
   end subroutine take_ends

   !> Writes a reduced problem under a temporary name: dense, or in CSparse's columns if W is sparse.
   subroutine write_siconos_text(file, path, system, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(i0)', iostat=status) system%dimension, system%n_contacts, merge(storage_dense, &
         storage_csparse, system%is_dense()), size(system%q), size(system%q)
      if (status == 0 .and. system%is_dense()) call write_dense(file%unit, system, status)
      if (status == 0 .and. .not. system%is_dense()) call write_csparse(file%unit, system, status)
      if (status == 0) call write_column(file%unit, system%q, status)
      if (status == 0) call write_column(file%unit, system%friction, status)
      call file%finish(status, error)
   end subroutine write_siconos_text

   !> Writes numbers, one per line.
   subroutine write_column(unit, values, status)
      integer, intent(in) :: unit !! the unit to write to
      real(dp), intent(in) :: values(:) !! the numbers
      integer, intent(out) :: status !! 0 where all is well
      integer :: i

      status = 0
      do i = 1, size(values)
         write (unit, '(a)', iostat=status) to_text(values(i))
         if (status /= 0) return
      end do
   end subroutine write_column

   !> Writes W as a dense matrix, one column per line.
   subroutine write_dense(unit, system, status)
      integer, intent(in) :: unit !! the unit to write to
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      integer, intent(out) :: status !! 0 where all is well
      real(dp) :: column(size(system%q))
      integer :: i, j

      write (unit, '(i0, 1x, i0)', iostat=status) size(column), size(column)
      if (status /= 0) return
      do j = 1, size(column)
         column = 0.0_dp
         associate (first => system%first(j), last => system%first(j + 1) - 1)
            column(system%row(first:last)) = system%entry(first:last)
         end associate
         do i = 1, size(column)
            write (unit, '(a)', advance='no', iostat=status) repeat(' ', min(i - 1, 1))//to_text(column(i))
            if (status /= 0) return
         end do
         write (unit, '()', iostat=status)
         if (status /= 0) return
      end do
   end subroutine write_dense

   !> Reads a reduced problem from a file.
   subroutine read_reduced_file(system, file, error)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error !! the first fault of the file, with its position
      type(input_file_t) :: input

      call new_input_file(input, file, error)
      if (allocated(error)) return
      if (index(input%text, hdf5_signature) == 1) then
         call new_error(error, input_refused, file//': this is an HDF5 file; convert it from FCLIB to text first: '// &
            'python -m amontons fclib '//file//' problem.dat')
      else
         call read_siconos_text(system, input)
         call move_alloc(input%error, error)
      end if
   end subroutine read_reduced_file

   !> Writes NAME.reduced.dat.
   subroutine write_reduced_file(directory, name, system, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      character(*), intent(in) :: name !! name of the case
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(output_file_t) :: files(1)

      call make_directory(directory, error)
      if (allocated(error)) return
      call write_siconos_text(files(1), directory//'/'//name//'.reduced.dat', system, error)
      call commit_files(files, error)
   end subroutine write_reduced_file

   !> Reads a matrix as CSparse prints it.
   pure subroutine read_csparse(entries, input, n, form)
      type(entries_t), intent(out) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      character(:), allocatable, intent(out) :: form !! name of the format, for messages
      character(:), allocatable :: line
      integer :: origin, n_entries, row, column, place

      call take_choice(input, origin, 'the origin of W: 1 (triplets) or 2 (columns)', [origin_triplets, origin_columns])
      if (allocated(input%error)) return
      call input%skip_white()
      place = input%position
      call input%take_line(line)
      if (index(line, 'CSparse Version') /= 1 .and. index(line, 'CXSparse Version') /= 1) call input%refuse( &
         "expected a line that begins with CSparse Version, found '"//line(:min(40, len(line)))//"'", place)
      if (origin == origin_triplets) then
         form = 'Siconos text, CSparse triplets'
         ! Lines `row col : value`, counted from 0.
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
      else
         form = 'Siconos text, CSparse columns'
         call read_compressed(entries, input, n)
      end if
   end subroutine read_csparse

   !> Reads a count as CSparse prints it: a number of six digits, possibly followed by text without a blank between.
   pure subroutine take_printed(input, value, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the count; from a million on, about
      character(*), intent(in) :: what !! meaning of the number, for the message
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

   !> Whether a count agrees with one printed with six digits.
   pure logical function is_printed(printed, count)
      integer, intent(in) :: printed !! the count as printed
      integer, intent(in) :: count !! the count

      is_printed = printed == count .or. printed >= first_rounded .and. &
         abs(real(printed, dp) - real(count, dp)) <= 5.0e-6_dp*real(count, dp)
   end function is_printed

   !> Reads the line `M-by-N, nzmax: a nnz: b`.
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

   !> Reads compressed columns: for each a line `col j : locations p to q`, then lines `row : value`, counted from 0.
   pure subroutine read_compressed(entries, input, n)
      type(entries_t), intent(out) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      character(:), allocatable :: norm
      integer :: n_entries, column, place, next, row, found

      call take_head(input, n, n_entries)
      place = input%position
      call take_word(input, ', 1-norm:')
      if (allocated(input%error)) return
      call input%take_line(norm)
      do column = 1, n
         call take_word(input, 'col')
         call take_printed(input, found, 'the number of a column')
         if (.not. is_printed(found, column - 1)) call refuse_word(input, 'expected column '//to_text(column - 1)// &
            ', found column '//to_text(found))
         call take_word(input, ': locations')
         call take_printed(input, found, 'the first location of a column')
         if (.not. is_printed(found, entries%n)) call refuse_word(input, 'expected the column to begin at location '// &
            to_text(entries%n)//', found '//to_text(found))
         call take_word(input, 'to')
         ! The last location of a column is -1 for an empty first one.
         if (allocated(input%error)) return
         call input%skip_white()
         if (input%text(input%position:min(input%position + 1, len(input%text))) == '-1') then
            input%position = input%position + 2
            next = 0
         else
            call take_printed(input, next, 'the last location of a column')
            next = next + 1
         end if
         do while (.not. allocated(input%error))
            call input%skip_white()
            if (next < first_rounded .and. entries%n >= next .or. .not. is_entry(input, 1)) exit
            call take_index(input, row, n, 'row')
            call take_entry(entries, input, row, column)
         end do
         if (.not. is_printed(next, entries%n)) call input%refuse('expected lines "row : value" of column '// &
            to_text(column - 1)//' up to location '//to_text(next - 1)//', found '//input%word())
         if (allocated(input%error)) return
      end do
      if (.not. is_printed(n_entries, entries%n)) call input%refuse('expected '//to_text(n_entries)// &
         ' entries as nnz says, found '//to_text(entries%n), place)
   end subroutine read_compressed

   !> Whether the next words are a number of integers and a colon, as in an entry, and not the numbers of q.
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

   !> Reads an index that counts from 0.
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

   !> Reads a colon and the value of an entry.
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

   !> Writes W in CSparse's format of columns, but with all digits.
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

   !> Reads an integer.
   pure subroutine take_number(input, value, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! meaning of the number, for the message

      call input%skip_white()
      call input%take_numeral(value, what)
   end subroutine take_number

   !> Reads an integer that must be one of a few.
   pure subroutine take_choice(input, value, what, choices)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the number
      character(*), intent(in) :: what !! meaning of the number, for the message
      integer, intent(in) :: choices(:) !! the numbers that are right

      call take_number(input, value, what)
      if (.not. any(choices == value)) call refuse_word(input, 'expected '//what//', found '//to_text(value))
   end subroutine take_choice

   !> Refuses the word just read.
   pure subroutine refuse_word(input, sentence)
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: sentence !! the fault, as a sentence

      call input%refuse(sentence, max(1, input%position - 1))
   end subroutine refuse_word

   !> Reads a word that must be a given one.
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

end module amontons_siconos_text
