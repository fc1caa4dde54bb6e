!> Reduced problems in the text files of Siconos (FrictionContactProblem, dimension 2), read and written. FCLIB's HDF5
!> files are converted to them first, outside this program.
!>
!> Words separated by white space: dimension, number of contacts, storage of W, W, then q and mu. W is dense (storage 0,
!> column by column), sparse in blocks (1), or what CSparse prints (2).
module amontons_siconos_text
   use amontons_csparse_text, only: read_csparse, refuse_word, take_choice, take_number, write_csparse
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_input_file, only: input_file_t, new_input_file
   use amontons_kinds, only: dp, int64
   use amontons_output_file, only: commit_files, new_output_file, output_file_t
   use amontons_reduced_system, only: entries_t, new_reduced_system, reduced_system_t
   use amontons_system, only: make_directory
   use amontons_text, only: scan_integer, to_text
   implicit none (type, external)
   private

   public :: read_reduced_file, write_reduced_file, write_siconos_text

   !> W written in full.
   integer, parameter :: storage_dense = 0
   !> W written as blocks.
   integer, parameter :: storage_blocks = 1
   !> W as CSparse prints it.
   integer, parameter :: storage_csparse = 2

   !> The first bytes of every HDF5 file.
   character(*), parameter :: hdf5_signature = char(137)//'HDF'//achar(13)//achar(10)//achar(26)//achar(10)

contains

   !> Reads a file that is in memory already; its first fault stays with it.
   subroutine read_siconos_text(system, input)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      type(input_file_t), intent(inout) :: input !! the file
      type(entries_t) :: entries
      real(dp), allocatable :: q(:), friction(:)
      character(:), allocatable :: form, sentence
      integer :: dimension, n_contacts, storage, place

      call take_choice(input, dimension, 'the dimension 2', [2])
      call take_number(input, n_contacts, 'the number of contacts')
      if (n_contacts < 0) call refuse_word(input, 'expected a number of contacts that is not negative, found '// &
         to_text(n_contacts))
      call input%check_count(n_contacts, 2, 'contacts')
      call take_choice(input, storage, 'the storage of W: 0 (dense), 1 (sparse block) or 2 (CSparse)', &
         [storage_dense, storage_blocks, storage_csparse])
      if (.not. allocated(input%error)) call take_size(input, n_contacts)
      if (allocated(input%error)) return
      select case (storage)
      case (storage_dense)
         form = 'Siconos text, dense'
         call read_dense(entries, input, 2*n_contacts)
      case (storage_blocks)
         form = 'Siconos text, sparse block'
         call read_blocks(entries, input, 2*n_contacts)
      case default
         call read_csparse(entries, input, 2*n_contacts, form)
      end select
      call read_vectors(q, friction, input, n_contacts)
      call check_end(input)
      if (allocated(input%error)) return
      if (entries%n == 0) allocate (entries%row(0), entries%column(0), entries%value(0), entries%place(0))
      call new_reduced_system(system, entries, q, friction, sentence, place)
      system%form = form
      if (allocated(sentence)) call input%refuse(sentence, place)
   end subroutine read_siconos_text

   !> Takes the number of rows and that of columns.
   pure subroutine take_size(input, n_contacts)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n_contacts !! number of contacts
      integer :: size, i

      do i = 1, 2
         call take_number(input, size, 'the number of '//trim(merge('rows   ', 'columns', i == 1))//' of W')
         if (size /= 2*n_contacts) call refuse_word(input, 'expected '//to_text(2*n_contacts)//' '// &
            trim(merge('rows   ', 'columns', i == 1))//' of W, two for each contact, found '//to_text(size))
      end do
   end subroutine take_size

   !> Reads the numbers of a full matrix, column by column; zeros are left out.
   pure subroutine read_dense(entries, input, n)
      type(entries_t), intent(out) :: entries !! the matrix
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n !! number of rows
      integer :: again

      call take_choice(input, again, 'the number of rows of W again, '//to_text(n), [n])
      call take_choice(input, again, 'the number of columns of W again, '//to_text(n), [n])
      if (int(n, int64)**2 > (len(input%text) - input%position)/2 + 1) call input%refuse(to_text(n)//' x '// &
         to_text(n)//' numbers of W are announced, but the file ends after '// &
         to_text(len(input%text) - input%position + 1)//' more bytes')
      call read_columns(entries, input, 0, 0, n, n)
   end subroutine read_dense

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
      integer :: n_blocks, n_block_rows, n_block_columns, number, i, k

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
      call take_pointers(first, input, n_blocks)
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

   !> Takes a number of things.
   pure subroutine take_count(input, n_things, things, least)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: n_things !! the number, at least 0 where there is no fault
      character(*), intent(in) :: things !! what the things are
      integer, intent(in) :: least !! the least number that is right

      call take_number(input, n_things, 'the number of '//things)
      if (n_things < least) call refuse_word(input, 'expected a number of '//things//' of at least '// &
         to_text(least)//', found '//to_text(n_things))
   end subroutine take_count

   !> Takes where the block rows or columns end.
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

   !> Takes where the blocks of each block row begin, and their end.
   pure subroutine take_pointers(first, input, n_blocks)
      integer, intent(inout) :: first(0:) !! number of blocks in the block rows before each
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n_blocks !! number of blocks
      integer :: i, least, most

      first = 0
      least = 0
      do i = 0, ubound(first, 1)
         call take_number(input, first(i), 'a block row pointer')
         most = merge(0, n_blocks, i == 0)
         if (i == ubound(first, 1)) least = n_blocks
         if (first(i) < least .or. first(i) > most) call refuse_word(input, 'expected block row pointers that '// &
            'ascend from 0 to '//to_text(n_blocks)//', found '//to_text(first(i)))
         if (allocated(input%error)) return
         least = first(i)
      end do
   end subroutine take_pointers

   !> Reads q and mu.
   pure subroutine read_vectors(q, friction, input, n_contacts)
      real(dp), allocatable, intent(out) :: q(:) !! u without forces (2m) [L]
      real(dp), allocatable, intent(out) :: friction(:) !! mu (m) [-]
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n_contacts !! number m of contacts
      integer :: i

      allocate (q(2*n_contacts), friction(n_contacts), source=0.0_dp)
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
   end subroutine read_vectors

   !> Refuses what follows the last coefficient, but for the 1 that Siconos writes there.
   pure subroutine check_end(input)
      type(input_file_t), intent(inout) :: input !! the file
      integer :: flag
      logical :: ok

      if (allocated(input%error)) return
      call input%skip_white()
      call scan_integer(input%text, input%position, flag, ok)
      call input%skip_white()
      if (input%position <= len(input%text)) call input%refuse('expected the end of the file behind the last '// &
         'mu, found '//input%word())
   end subroutine check_end

   !> Writes a reduced problem under its temporary name: dense, or as CSparse's columns where W is sparse.
   subroutine write_siconos_text(file, path, system, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(i0)', iostat=status) 2, system%n_contacts, merge(storage_dense, storage_csparse, &
         system%is_dense()), size(system%q), size(system%q)
      if (status == 0 .and. system%is_dense()) call write_dense(file%unit, system, status)
      if (status == 0 .and. .not. system%is_dense()) call write_csparse(file%unit, system, status)
      if (status == 0) call write_column(file%unit, system%q, status)
      if (status == 0) call write_column(file%unit, system%friction, status)
      call file%finish(status, error)
   end subroutine write_siconos_text

   !> Writes numbers, one a line.
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

   !> Writes W in full, a column a line.
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

   !> Reads a reduced problem.
   subroutine read_reduced_file(system, file, error)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file, and where
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

end module amontons_siconos_text
