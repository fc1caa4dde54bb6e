!> A grid as it was written, compared with what should stand there: whoever hands the arrays over to a file that is
!> written can hand them over to this one.
module amontons_vtk_check
   use amontons_document_check, only: contradiction, first_disagreement
   use amontons_error, only: fault_list_t
   use amontons_kinds, only: dp, int32, int64
   use amontons_text, only: to_text
   use amontons_vtu, only: base64_size, bytes_per_length, decode_base64, vtk_file_t
   implicit none (type, external)
   private

   public :: new_vtk_check, read_array, read_displacement, vtk_check_t

   !> Bytes that are searched for the markup of an array at a time.
   integer(int64), parameter :: block_size = 65536_int64
   !> Components of a vector.
   integer, parameter :: n_space = 3

   !> A grid being compared. After a fault in the markup or in the length of an array the rest is not looked at.
   type, extends(vtk_file_t) :: vtk_check_t
      private
      character(:), allocatable :: path !! name of the file
      integer :: unit = -1 !! the open file
      integer(int64) :: position = 1_int64 !! the byte that comes next, from 1
      logical :: is_readable = .true. !! whether what comes next is where it should be
      type(fault_list_t), public :: faults !! what does not agree
   contains
      procedure, public :: close => vtk_check_close
      procedure, public :: put_integers => vtk_check_put_integers
      procedure, public :: put_reals => vtk_check_put_reals
      procedure :: compare_markup => vtk_check_compare_markup
      procedure :: read_array => vtk_check_read_array
      procedure :: stop_at => vtk_check_stop_at
   end type vtk_check_t

contains

   !> Opens a grid.
   subroutine new_vtk_check(check, path, units)
      type(vtk_check_t), intent(out) :: check !! the grid
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: units !! names of the units of the case
      logical :: is_open

      check%path = path
      check%units = units
      call open_grid(check%unit, path, is_open)
      if (.not. is_open) call check%stop_at('cannot be read')
   end subroutine new_vtk_check

   !> Opens a grid to read from it.
   subroutine open_grid(unit, path, is_open)
      integer, intent(out) :: unit !! its unit; -1 if it cannot be opened
      character(*), intent(in) :: path !! name of the file
      logical, intent(out) :: is_open !! whether it is a plain file that can be read
      integer(int64) :: n_bytes
      integer :: status

      unit = -1
      is_open = .false.
      ! The size is asked for first: to open a pipe could take for ever.
      inquire (file=path, size=n_bytes)
      if (n_bytes < 1) return
      open (newunit=unit, file=path, status='old', action='read', access='stream', form='unformatted', iostat=status)
      is_open = status == 0
      if (.not. is_open) unit = -1
   end subroutine open_grid

   !> Compares an array of reals.
   subroutine vtk_check_put_reals(self, section, name, dimension, n_components, values)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section of the array
      character(*), intent(in) :: name !! name of the quantity
      character(*), intent(in) :: dimension !! what it is measured in
      integer, intent(in) :: n_components !! numbers per point or cell
      real(dp), intent(in) :: values(:) !! the values that should stand there
      character(:), allocatable :: bytes
      real(dp), allocatable :: found(:)
      integer :: place

      call self%begin_array(section, 'Float64', name, n_components, dimension)
      call self%read_array(name, 8_int64*size(values, kind=int64), bytes)
      if (.not. self%is_readable) return
      found = transfer(bytes, values, size(values))
      place = first_disagreement(found, values, self%scale)
      if (place == 0) return
      call self%faults%add(self%path, contradiction(name//' of '//place_name(section, place, n_components), &
         found(place), values(place)))
   end subroutine vtk_check_put_reals

   !> Compares an array of integers.
   subroutine vtk_check_put_integers(self, section, name, values)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section of the array
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: values(:) !! the values that should stand there
      character(:), allocatable :: bytes
      integer(int32), allocatable :: found(:)
      integer :: place

      call self%begin_array(section, 'Int32', name, 1, '')
      call self%read_array(name, 4_int64*size(values, kind=int64), bytes)
      if (.not. self%is_readable) return
      found = transfer(bytes, 0_int32, size(values))
      do place = 1, size(values)
         if (found(place) == values(place)) cycle
         call self%faults%add(self%path, name//' of '//place_name(section, place, 1)//' is '// &
            to_text(int(found(place)))//', but '//to_text(values(place))//' follows from the other files')
         return
      end do
   end subroutine vtk_check_put_integers

   !> Compares the markup before an array and reads the array.
   subroutine vtk_check_read_array(self, name, n_bytes, bytes)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: name !! name of the array
      integer(int64), intent(in) :: n_bytes !! its length
      character(:), allocatable, intent(out) :: bytes !! the array as the machine has it, if it can be read
      character(:), allocatable :: fault

      call self%compare_markup('before '//name)
      if (.not. self%is_readable) return
      call read_bytes(self%unit, self%position, name, n_bytes, bytes, fault)
      if (len(fault) > 0) call self%stop_at(fault)
      self%position = self%position + base64_size(bytes_per_length + n_bytes)
      call self%end_array()
   end subroutine vtk_check_read_array

   !> Compares the markup.
   subroutine vtk_check_compare_markup(self, place)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: place !! where in the file it stands
      character(len(self%markup)) :: found
      integer :: status, i

      if (.not. self%is_readable) return
      read (self%unit, pos=self%position, iostat=status) found
      if (status /= 0) then
         call self%stop_at('the file ends '//place)
      else if (found /= self%markup) then
         do i = 1, len(found)
            if (found(i:i) /= self%markup(i:i)) exit
         end do
         call self%stop_at('from byte '//to_text(self%position + int(i - 1, int64))//' on, '//place// &
            ', it is not a grid of this mesh')
      end if
      self%position = self%position + len(found, int64)
   end subroutine vtk_check_compare_markup

   !> Compares what stands behind the last array, and closes the file.
   subroutine vtk_check_close(self)
      class(vtk_check_t), intent(inout) :: self !! the grid
      integer(int64) :: n_bytes
      integer :: status

      if (self%unit == -1) return
      call self%end_grid()
      call self%compare_markup('behind the last array')
      inquire (unit=self%unit, size=n_bytes)
      if (self%is_readable .and. n_bytes /= self%position - 1) then
         call self%stop_at('bytes follow the end of the grid')
      end if
      ! It was only read.
      ! allow(C181): nothing can be lost
      close (self%unit, iostat=status)
      self%unit = -1
   end subroutine vtk_check_close

   !> Notes a fault behind which nothing is where it should be.
   subroutine vtk_check_stop_at(self, sentence)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: sentence !! the fault

      self%is_readable = .false.
      call self%faults%add(self%path, sentence)
   end subroutine vtk_check_stop_at

   !> Where in a grid a number of an array stands.
   pure function place_name(section, place, n_components) result(name)
      character(*), intent(in) :: section !! the section of the array
      integer, intent(in) :: place !! which of its numbers, from 1
      integer, intent(in) :: n_components !! numbers per point or cell
      character(:), allocatable :: name

      select case (section)
      case ('PointData', 'Points')
         name = 'point '
      case ('CellData')
         name = 'cell '
      case default
         name = 'entry '
      end select
      name = name//to_text((place - 1)/n_components + 1)
      if (n_components > 1) name = name//', component '//to_text(modulo(place - 1, n_components) + 1)
   end function place_name

   !> Reads the displacements from a grid of the body.
   subroutine read_displacement(path, n_points, displacement, fault)
      character(*), intent(in) :: path !! name of the file
      integer, intent(in) :: n_points !! number of points that it should have
      real(dp), allocatable, intent(out) :: displacement(:, :) !! the displacements (2, n_points) [L]
      character(:), allocatable, intent(out) :: fault !! why they cannot be read; empty if they can
      real(dp) :: vectors(n_space*n_points)

      call read_array(path, 'displacement', n_space, vectors, fault)
      if (len(fault) == 0) displacement = reshape([vectors(1::n_space), vectors(2::n_space)], [2, n_points], &
         order=[2, 1])
   end subroutine read_displacement

   !> Reads an array of reals from a grid.
   subroutine read_array(path, name, n_components, values, fault)
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per point
      real(dp), intent(out) :: values(:) !! the values, those of one point together; 0 after a fault
      character(:), allocatable, intent(out) :: fault !! why they cannot be read; empty if they can
      character(:), allocatable :: markup, bytes
      integer(int64) :: first
      integer :: unit
      logical :: is_open

      values = 0.0_dp
      call open_grid(unit, path, is_open)
      if (.not. is_open) then
         fault = 'cannot be read'
         return
      end if
      markup = '<DataArray type="Float64" Name="'//name//'"'
      if (n_components > 1) markup = markup//' NumberOfComponents="'//to_text(n_components)//'"'
      markup = markup//' format="binary">'
      first = place_behind(unit, markup)
      if (first == 0) then
         fault = 'no '//name//' stands where it was written'
      else
         call read_bytes(unit, first, name, 8_int64*size(values, kind=int64), bytes, fault)
         if (len(fault) == 0) values = transfer(bytes, values, size(values))
         if (.not. all(abs(values) <= huge(1.0_dp))) fault = 'not every '//name//' is a finite number'
      end if
      close (unit)
   end subroutine read_array

   !> The byte behind a piece of markup, from 1; 0 if the file does not hold it.
   integer(int64) function place_behind(unit, markup) result(place)
      integer, intent(in) :: unit !! the open file
      character(*), intent(in) :: markup !! the markup
      character(block_size) :: text
      integer(int64) :: n_bytes, start
      integer :: status, found

      place = 0
      inquire (unit=unit, size=n_bytes)
      ! Blocks overlap: the markup may lie across the end of one.
      do start = 1_int64, n_bytes, block_size - len(markup)
         text = ''
         read (unit, pos=start, iostat=status) text(:min(block_size, n_bytes - start + 1))
         found = index(text, markup)
         if (found > 0) place = start - 1 + found + len(markup)
         if (found > 0 .or. status /= 0) return
      end do
   end function place_behind

   !> Reads the bytes of an array, which stand behind their number.
   subroutine read_bytes(unit, position, name, n_bytes, bytes, fault)
      integer, intent(in) :: unit !! the open file
      integer(int64), intent(in) :: position !! where its letters begin, from 1
      character(*), intent(in) :: name !! name of the array
      integer(int64), intent(in) :: n_bytes !! number of bytes that it should have
      character(:), allocatable, intent(out) :: bytes !! the bytes, if they can be read
      character(:), allocatable, intent(out) :: fault !! why they cannot be read; empty if they can
      character(:), allocatable :: text, all_bytes
      integer(int64) :: found
      integer :: status
      logical :: is_valid

      fault = ''
      allocate (character(base64_size(bytes_per_length + n_bytes)) :: text)
      read (unit, pos=position, iostat=status) text
      if (status /= 0) then
         fault = 'the file ends within '//name
         return
      end if
      call decode_base64(text, bytes_per_length + n_bytes, all_bytes, is_valid)
      found = transfer(all_bytes(:bytes_per_length), found)
      if (.not. is_valid) then
         fault = name//' is not '//to_text(bytes_per_length + n_bytes)//' bytes in base64'
      else if (found /= n_bytes) then
         fault = 'the length of '//name//' is '//to_text(found)//', expected '//to_text(n_bytes)//' bytes'
      else
         bytes = all_bytes(bytes_per_length + 1:)
      end if
   end subroutine read_bytes

end module amontons_vtk_check
