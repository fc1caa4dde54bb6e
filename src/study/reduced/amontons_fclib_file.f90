!> Reduced problems in FCLIB's HDF5 files: the group /fclib_local, dimension 2, read and written.
!>
!> A build without the HDF5 library has `amontons_fclib_file.absent.f90` in this place.
module amontons_fclib_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_hdf5_file, only: create_hdf5_file, hdf5_file_t, open_hdf5_file
   use amontons_kinds, only: dp
   use amontons_output_file, only: output_file_t
   use amontons_reduced_system, only: entries_t, new_reduced_system, reduced_system_t
   use amontons_text, only: to_text
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: has_fclib, read_fclib_file, write_fclib_file

   !> Whether this build reads and writes FCLIB files.
   logical, parameter :: has_fclib = .true.
   !> The value of `nz` that stands for compressed columns.
   integer, parameter :: compressed_columns = -1
   !> The value of `nz` that stands for compressed rows.
   integer, parameter :: compressed_rows = -2

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      function c_ends_well(procedure, argument) bind(c, name='amontons_ends_well') result(answer)
         import :: c_char, c_int
         implicit none (type, external)
         interface
            subroutine procedure(argument) bind(c)
               import :: c_char
               implicit none (type, external)
               character(c_char), intent(in) :: argument(*)
            end subroutine procedure
         end interface
         character(c_char), intent(in) :: argument(*)
         integer(c_int) :: answer
      end function c_ends_well
   end interface

contains

   !> Reads a file, in another process first: the library of Debian 12, HDF5 1.10, crashes on some damaged files.
   subroutine read_fclib_file(system, name, error)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      character(*), intent(in) :: name !! name of the file
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file

      if (c_ends_well(try_file, name//c_null_char) /= 0) then
         call read_contents(system, name, error)
      else
         call new_error(error, input_refused, name//': this HDF5 file is damaged')
      end if
   end subroutine read_fclib_file

   !> Reads a file for nothing.
   ! allow(assumed-size): C gives an address and knows no shape
   subroutine try_file(name) bind(c)
      character(c_char), intent(in) :: name(*) !! name of the file, ended by a zero
      type(reduced_system_t) :: system
      type(error_t), allocatable :: error
      character(:), allocatable :: text
      integer :: i

      text = ''
      i = 1
      do while (name(i) /= c_null_char)
         text = text//name(i)
         i = i + 1
      end do
      call read_contents(system, text, error)
   end subroutine try_file

   !> Reads what a file holds.
   subroutine read_contents(system, name, error)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      character(*), intent(in) :: name !! name of the file
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file
      type(hdf5_file_t) :: file
      type(entries_t) :: entries
      real(dp), allocatable :: q(:), friction(:)
      character(:), allocatable :: sentence
      integer :: n, place

      call open_hdf5_file(file, name)
      call check_kind(file)
      call take_count(file, '/fclib_local/W/n', n)
      if (mod(n, 2) /= 0) call file%refuse('/fclib_local/W/n is '//to_text(n)//': expected an even number, two for '// &
         'each contact')
      call read_matrix(entries, file, n)
      call read_vector(q, file, '/fclib_local/vectors/q', n)
      call read_vector(friction, file, '/fclib_local/vectors/mu', n/2)
      if (any(friction < 0.0_dp)) call file%refuse('/fclib_local/vectors/mu: expected numbers that are not '// &
         'negative, found '//to_text(minval(friction))//' of contact '//to_text(minloc(friction, dim=1)))
      if (.not. allocated(file%error)) then
         call new_reduced_system(system, entries, q, friction, sentence, place)
         if (allocated(sentence)) call file%refuse('/fclib_local/W: '//sentence)
         system%form = 'FCLIB, HDF5'
      end if
      call file%close()
      call move_alloc(file%error, error)
   end subroutine read_contents

   !> Refuses what is no reduced problem in the plane.
   subroutine check_kind(file)
      type(hdf5_file_t), intent(inout) :: file !! the file
      integer :: dimension

      if (allocated(file%error)) return
      if (.not. file%has('/fclib_local')) then
         call file%refuse('expected the group /fclib_local of a reduced problem, found none')
      else if (file%has('/fclib_local/R')) then
         call file%refuse('/fclib_local has equality constraints (R): expected a problem u = W r + q alone')
      end if
      call take_count(file, '/fclib_local/spacedim', dimension)
      if (dimension /= 2) call file%refuse('/fclib_local/spacedim is '//to_text(dimension)//': expected 2')
   end subroutine check_kind

   !> Takes a data set of one integer.
   subroutine take_number(file, path, value)
      type(hdf5_file_t), intent(inout) :: file !! the file
      character(*), intent(in) :: path !! path of the data set
      integer, intent(out) :: value !! the number, 0 where there is a fault
      integer, allocatable :: values(:)

      value = 0
      call file%read_integers(path, values)
      if (size(values) == 1) then
         value = values(1)
      else
         call file%refuse(path//': expected one number, found '//to_text(size(values)))
      end if
   end subroutine take_number

   !> Takes a data set of one integer that is not negative.
   subroutine take_count(file, path, value)
      type(hdf5_file_t), intent(inout) :: file !! the file
      character(*), intent(in) :: path !! path of the data set
      integer, intent(out) :: value !! the number, 0 where there is a fault

      call take_number(file, path, value)
      if (value < 0) call file%refuse(path//' is '//to_text(value)//': expected a number that is not negative')
      value = max(0, value)
   end subroutine take_count

   !> Reads a vector of finite numbers.
   subroutine read_vector(values, file, path, n)
      real(dp), allocatable, intent(out) :: values(:) !! the vector (n), of any length where there is a fault
      type(hdf5_file_t), intent(inout) :: file !! the file
      character(*), intent(in) :: path !! path of the data set
      integer, intent(in) :: n !! number of its values
      integer :: i

      call file%read_reals(path, values)
      if (size(values) < n) call file%refuse(path//': expected '//to_text(n)//' numbers, found '//to_text(size(values)))
      do i = 1, size(values)
         if (.not. ieee_is_finite(values(i))) call file%refuse(path//': number '//to_text(i)//' is not finite')
      end do
      if (.not. allocated(file%error)) values = values(:n)
   end subroutine read_vector

   !> Reads W: triplets, compressed columns or compressed rows, counted from 0.
   subroutine read_matrix(entries, file, n)
      type(entries_t), intent(out) :: entries !! W
      type(hdf5_file_t), intent(inout) :: file !! the file
      integer, intent(in) :: n !! number of rows
      integer, allocatable :: p(:), i(:)
      integer :: m, nz, k
      logical :: is_by_column

      call take_count(file, '/fclib_local/W/m', m)
      if (m /= n) call file%refuse('/fclib_local/W is '//to_text(m)//' x '//to_text(n)//': expected as many rows '// &
         'as columns')
      call take_number(file, '/fclib_local/W/nz', nz)
      if (nz < compressed_rows) call file%refuse('/fclib_local/W/nz is '//to_text(nz)//': expected the number of '// &
         'triplets, -1 (compressed columns) or -2 (compressed rows)')
      call file%read_integers('/fclib_local/W/p', p)
      call file%read_integers('/fclib_local/W/i', i)
      is_by_column = nz == compressed_columns
      if (nz < 0) call expand(p, nz, file, n, size(i))
      if (allocated(file%error)) return
      call check_indices(p, nz, file, n, '/fclib_local/W/p')
      call check_indices(i, nz, file, n, '/fclib_local/W/i')
      call read_vector(entries%value, file, '/fclib_local/W/x', nz)
      entries%n = nz
      if (allocated(file%error)) entries%n = 0
      entries%row = merge(i(:entries%n), p(:entries%n), is_by_column) + 1
      entries%column = merge(p(:entries%n), i(:entries%n), is_by_column) + 1
      entries%place = [(k, k=1, entries%n)]
   end subroutine read_matrix

   !> Turns the pointers of compressed columns or rows into the row or column of every entry.
   subroutine expand(p, nz, file, n, n_indices)
      integer, allocatable, intent(inout) :: p(:) !! pointers (n + 1); rows or columns of the entries on return
      integer, intent(inout) :: nz !! number of entries on return
      type(hdf5_file_t), intent(inout) :: file !! the file
      integer, intent(in) :: n !! number of rows
      integer, intent(in) :: n_indices !! number of indices that the entries can have
      character(*), parameter :: path = '/fclib_local/W/p'
      integer :: j

      if (size(p) < n + 1) call file%refuse(path//': expected '//to_text(n + 1)//' pointers, found '//to_text(size(p)))
      if (allocated(file%error)) return
      if (p(1) /= 0 .or. any(p(2:n + 1) < p(:n))) call file%refuse(path//': expected pointers that ascend from 0')
      if (allocated(file%error)) return
      if (p(n + 1) > n_indices) call file%refuse(path//': expected pointers up to the number of indices, '// &
         to_text(n_indices)//', found '//to_text(p(n + 1)))
      if (allocated(file%error)) return
      nz = p(n + 1)
      p = [(spread(j - 1, 1, p(j + 1) - p(j)), j=1, n)]
   end subroutine expand

   !> Refuses indices that are too few or out of range.
   subroutine check_indices(indices, n_entries, file, n, path)
      integer, intent(in) :: indices(:) !! the indices, counted from 0
      integer, intent(in) :: n_entries !! number of entries
      type(hdf5_file_t), intent(inout) :: file !! the file
      integer, intent(in) :: n !! number of rows
      character(*), intent(in) :: path !! path of the data set
      integer :: k

      if (size(indices) < n_entries) call file%refuse(path//': expected '//to_text(n_entries)//' indices, found '// &
         to_text(size(indices)))
      do k = 1, min(n_entries, size(indices))
         if (indices(k) < 0 .or. indices(k) >= n) call file%refuse(path//': expected indices from 0 to '// &
            to_text(n - 1)//', found '//to_text(indices(k)))
      end do
   end subroutine check_indices

   !> Writes a reduced problem, W in compressed columns.
   subroutine write_fclib_file(file, path, system, title, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      character(*), intent(in) :: title !! name of the case, for the file's information
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(hdf5_file_t) :: contents

      call create_hdf5_file(contents)
      call contents%make_group('/fclib_local')
      call contents%write_integers('/fclib_local/spacedim', [2])
      call contents%make_group('/fclib_local/W')
      call contents%write_integers('/fclib_local/W/m', [size(system%q)])
      call contents%write_integers('/fclib_local/W/n', [size(system%q)])
      call contents%write_integers('/fclib_local/W/nzmax', [size(system%entry)])
      call contents%write_integers('/fclib_local/W/nz', [compressed_columns])
      call contents%write_integers('/fclib_local/W/p', system%first - 1)
      call contents%write_integers('/fclib_local/W/i', system%row - 1)
      call contents%write_reals('/fclib_local/W/x', system%entry)
      call contents%make_group('/fclib_local/vectors')
      call contents%write_reals('/fclib_local/vectors/q', system%q)
      call contents%write_reals('/fclib_local/vectors/mu', system%friction)
      call contents%make_group('/fclib_local/info')
      call contents%write_text('/fclib_local/info/title', title)
      call contents%write_text('/fclib_local/info/description', 'plane contact with Coulomb friction, u = W r + q')
      call contents%write_text('/fclib_local/info/math_info', 'written by Amontons '//version)
      if (allocated(system%u)) then
         call contents%make_group('/solution')
         call contents%write_reals('/solution/u', system%u)
         call contents%write_reals('/solution/r', system%r)
      end if
      call contents%save(file, path, error)
   end subroutine write_fclib_file

end module amontons_fclib_file
