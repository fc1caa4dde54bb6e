!> A grid as it was written, compared with what should stand there: whoever hands the arrays over to a file that is
!> written can hand them over to this one.
module amontons_vtk_check
   use amontons_agreement, only: contradiction, fault_text_t, first_disagreement
   use amontons_kinds, only: dp, int32, int64
   use amontons_text, only: newline, to_text
   use amontons_vtk_file, only: vtk_file_t, vtk_tail
   implicit none (type, external)
   private

   public :: new_vtk_check, read_array, read_displacement, vtk_check_t

   !> What stands before the values.
   character(*), parameter :: before_values = '<AppendedData encoding="raw">'//newline//'_'
   !> No head is longer [byte].
   integer, parameter :: longest_head = 16384
   !> What stands before and behind the place of an array.
   character(*), parameter :: before_offset = ' format="appended" offset="', behind_offset = '"/>'
   !> Components of a vector.
   integer, parameter :: n_space = 3

   !> A grid being compared. After a fault in the head or in the length of an array the rest is not looked at.
   type, extends(vtk_file_t) :: vtk_check_t
      private
      character(:), allocatable :: path !! name of the file
      integer :: unit = -1 !! the open file
      integer(int64) :: position = 1_int64 !! the byte that comes next, from 1
      logical :: is_readable = .true. !! whether what comes next is where it should be
      type(fault_text_t), public :: faults !! what does not agree
   contains
      procedure, public :: begin_data => vtk_check_begin_data
      procedure, public :: close => vtk_check_close
      procedure, public :: put_integers => vtk_check_put_integers
      procedure, public :: put_reals => vtk_check_put_reals
      procedure :: enter_array => vtk_check_enter_array
      procedure :: stop_at => vtk_check_stop_at
   end type vtk_check_t

contains

   !> Opens a grid.
   subroutine new_vtk_check(check, path, n_points, n_cells)
      type(vtk_check_t), intent(out) :: check !! the grid
      character(*), intent(in) :: path !! name of the file
      integer, intent(in) :: n_points !! number of points that it should have
      integer, intent(in) :: n_cells !! number of cells that it should have
      logical :: is_open

      check%path = path
      call check%begin_head(n_points, n_cells)
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

   !> Compares the head.
   subroutine vtk_check_begin_data(self)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(:), allocatable :: found
      integer :: status, i

      call self%end_head()
      if (.not. self%is_readable) return
      allocate (character(len(self%head)) :: found)
      read (self%unit, pos=1, iostat=status) found
      self%position = len(found) + 1
      if (status /= 0) then
         call self%stop_at('the file ends within its head')
      else if (found /= self%head) then
         do i = 1, len(found)
            if (found(i:i) /= self%head(i:i)) exit
         end do
         call self%stop_at('the head is not that of this mesh, from byte '//to_text(i)//' on')
      end if
   end subroutine vtk_check_begin_data

   !> Compares an array of reals.
   subroutine vtk_check_put_reals(self, section, name, n_components, values)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section of the array
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per point or cell
      real(dp), intent(in) :: values(:) !! the values that should stand there
      real(dp), allocatable :: found(:)
      integer :: place, status

      if (.not. self%has_head) call self%announce(section, 'Float64', name, n_components, &
         8_int64*size(values, kind=int64))
      if (.not. (self%has_head .and. self%is_readable)) return
      call self%enter_array(name, 8_int64*size(values, kind=int64))
      if (.not. self%is_readable) return
      allocate (found(size(values)))
      read (self%unit, pos=self%position, iostat=status) found
      self%position = self%position + 8_int64*size(values, kind=int64)
      if (status /= 0) then
         call self%stop_at('the file ends within '//name)
         return
      end if
      place = first_disagreement(found, values)
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
      integer(int32), allocatable :: found(:)
      integer :: place, status

      if (.not. self%has_head) call self%announce(section, 'Int32', name, 1, 4_int64*size(values, kind=int64))
      if (.not. (self%has_head .and. self%is_readable)) return
      call self%enter_array(name, 4_int64*size(values, kind=int64))
      if (.not. self%is_readable) return
      allocate (found(size(values)))
      read (self%unit, pos=self%position, iostat=status) found
      self%position = self%position + 4_int64*size(values, kind=int64)
      if (status /= 0) then
         call self%stop_at('the file ends within '//name)
         return
      end if
      do place = 1, size(values)
         if (found(place) == values(place)) cycle
         call self%faults%add(self%path, name//' of '//place_name(section, place, 1)//' is '// &
            to_text(int(found(place)))//', but '//to_text(values(place))//' follows from the other files')
         return
      end do
   end subroutine vtk_check_put_integers

   !> Reads the length of the next array.
   subroutine vtk_check_enter_array(self, name, n_bytes)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: name !! name of the array
      integer(int64), intent(in) :: n_bytes !! the length that it should have
      integer(int64) :: found
      integer :: status

      read (self%unit, pos=self%position, iostat=status) found
      self%position = self%position + 8_int64
      if (status /= 0) then
         call self%stop_at('the file ends before '//name)
      else if (found /= n_bytes) then
         call self%stop_at('the length of '//name//' is '//to_text(found)//', expected '//to_text(n_bytes)//' bytes')
      end if
   end subroutine vtk_check_enter_array

   !> Compares what stands behind the values, and closes the file.
   subroutine vtk_check_close(self)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(len(vtk_tail)) :: found
      integer(int64) :: n_bytes
      integer :: status

      if (self%unit == -1) return
      if (self%is_readable) then
         read (self%unit, pos=self%position, iostat=status) found
         inquire (unit=self%unit, size=n_bytes)
         if (status /= 0 .or. found /= vtk_tail .or. n_bytes /= self%position - 1 + len(vtk_tail)) then
            call self%stop_at('the file does not end as it was written')
         end if
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
      character(longest_head) :: head
      integer(int64) :: n_bytes, found, first
      integer :: unit, status
      logical :: is_open

      fault = ''
      head = ''
      values = 0.0_dp
      call open_grid(unit, path, is_open)
      if (.not. is_open) then
         fault = 'cannot be read'
         return
      end if
      inquire (unit=unit, size=n_bytes)
      read (unit, iostat=status) head(:min(n_bytes, len(head, int64)))
      first = array_place(head, name, n_components)
      if (status /= 0 .or. first < 1 .or. first > n_bytes) then
         fault = 'no '//name//' stands where it was written'
      else
         read (unit, pos=first, iostat=status) found
         if (status /= 0 .or. found /= 8_int64*size(values)) then
            fault = 'the '//name//' is not that of '//to_text(size(values)/n_components)//' points'
         else
            read (unit, iostat=status) values
            if (.not. all(abs(values) <= huge(1.0_dp))) fault = 'not every '//name//' is a finite number'
            if (status /= 0) fault = 'the file ends within the '//name
         end if
      end if
      close (unit)
   end subroutine read_array

   !> Where in a grid an array of reals begins with its length; 0 if its head does not tell.
   pure integer(int64) function array_place(head, name, n_components) result(place)
      character(*), intent(in) :: head !! the head
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per point
      character(:), allocatable :: before
      integer :: first, last, status

      place = 0
      before = '<DataArray type="Float64" Name="'//name//'"'
      if (n_components > 1) before = before//' NumberOfComponents="'//to_text(n_components)//'"'
      before = before//before_offset
      first = index(head, before) + len(before)
      last = first + index(head(first:), behind_offset) - 2
      if (first == len(before) .or. last < first .or. index(head, before_values) == 0) return
      read (head(first:last), *, iostat=status) place
      if (status /= 0 .or. place < 0) place = -longest_head
      place = min(place, huge(place) - longest_head) + index(head, before_values) + len(before_values)
   end function array_place

end module amontons_vtk_check
