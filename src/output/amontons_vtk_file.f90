!> Unstructured grids in VTK's XML format, every array in base64 where it belongs: the form that all readers of such
!> files know.
module amontons_vtk_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_base64, only: encode_base64
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp, int32, int64
   use amontons_listing_text, only: unit_of
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_text, only: newline, to_text, xml_escaped
   implicit none (type, external)
   private

   public :: bytes_per_length, new_vtk_file, vtk_file_t

   !> The bytes of an array stand behind their number, an integer of so many bytes.
   integer(int64), parameter :: bytes_per_length = 8_int64

   !> Bytes that are encoded at a time, a multiple of three and of the bytes of a number.
   integer(int64), parameter :: piece_size = 49152_int64

   !> A grid being written.
   type :: vtk_file_t
      private
      character(:), allocatable, public :: markup !! what stands between the array before and the next one
      real(dp), public :: scale = 0.0_dp
         !! what rounding errors of the next reals are measured by, if larger than they are; only comparisons ask
      character(:), allocatable :: section !! the section that is open
      character(:), allocatable, public :: units !! names of the units of the case; empty if it names none
      character(:), allocatable :: label !! unit of the array that is open
      integer :: state = 0 !! status of the last write statement; nothing is written after a failure
      character(:), allocatable :: not_finite !! the first quantity with a number that is not finite
      type(output_file_t) :: file !! the file
   contains
      procedure, public :: begin_array => vtk_file_begin_array
      procedure, public :: begin_grid => vtk_file_begin_grid
      procedure, public :: end_array => vtk_file_end_array
      procedure, public :: end_grid => vtk_file_end_grid
      procedure, public :: finish => vtk_file_finish
      procedure, public :: put_cells => vtk_file_put_cells
      procedure, public :: put_integers => vtk_file_put_integers
      procedure, public :: put_reals => vtk_file_put_reals
      procedure, public :: put_stresses => vtk_file_put_stresses
      procedure, public :: put_vectors => vtk_file_put_vectors
      procedure :: enter => vtk_file_enter
   end type vtk_file_t

contains

   !> Opens a grid under a temporary name.
   subroutine new_vtk_file(vtk, path, units, error)
      type(vtk_file_t), intent(out) :: vtk !! the grid
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: units !! names of the units of the case
      type(error_t), allocatable, intent(out) :: error !! the file cannot be opened

      vtk%units = units
      call new_output_file(vtk%file, path, .true., error)
   end subroutine new_vtk_file

   !> Begins the markup.
   pure subroutine vtk_file_begin_grid(self, n_points, n_cells)
      class(vtk_file_t), intent(inout) :: self !! the grid
      integer, intent(in) :: n_points !! number of points
      integer, intent(in) :: n_cells !! number of cells

      self%section = ''
      self%markup = '<?xml version="1.0"?>'//newline// &
         '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">'//newline// &
         '  <UnstructuredGrid>'//newline//'    <Piece NumberOfPoints="'//to_text(n_points)//'" NumberOfCells="'// &
         to_text(n_cells)//'">'//newline
   end subroutine vtk_file_begin_grid

   !> Completes the markup before an array.
   pure subroutine vtk_file_begin_array(self, section, type, name, n_components, dimension)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section it belongs to
      character(*), intent(in) :: type !! VTK's word for the kind of number
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per point or cell
      character(*), intent(in) :: dimension !! what it is measured in, as `unit_of` takes it

      call self%enter(section)
      self%label = unit_of(self%units, dimension)
      self%markup = self%markup//'        <DataArray type="'//type//'" Name="'//name//'"'
      ! Readers take a stated single component for a column, an unstated one for a plain array.
      if (n_components > 1) self%markup = self%markup//' NumberOfComponents="'//to_text(n_components)//'"'
      self%markup = self%markup//' format="binary">'
   end subroutine vtk_file_begin_array

   !> Begins the markup behind an array.
   pure subroutine vtk_file_end_array(self)
      class(vtk_file_t), intent(inout) :: self !! the grid

      self%markup = ''
      ! The key that readers on VTK know. It follows the numbers, where no other reader looks for them.
      if (len(self%label) > 0) self%markup = '<InformationKey name="UNITS_LABEL" location="vtkDataArray">'// &
         xml_escaped(self%label)//'</InformationKey>'
      self%markup = self%markup//'</DataArray>'//newline
   end subroutine vtk_file_end_array

   !> Completes the markup behind the last array.
   pure subroutine vtk_file_end_grid(self)
      class(vtk_file_t), intent(inout) :: self !! the grid

      call self%enter('')
      self%markup = self%markup//'    </Piece>'//newline//'  </UnstructuredGrid>'//newline//'</VTKFile>'//newline
   end subroutine vtk_file_end_grid

   !> Leaves the present section for another one; none is named ''.
   pure subroutine vtk_file_enter(self, section)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section to enter

      if (section == self%section) return
      if (len(self%section) > 0) self%markup = self%markup//'      </'//self%section//'>'//newline
      if (len(section) > 0) self%markup = self%markup//'      <'//section//'>'//newline
      self%section = section
   end subroutine vtk_file_enter

   !> Hands over an array of reals.
   subroutine vtk_file_put_reals(self, section, name, dimension, n_components, values)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData', 'Points' or 'Cells', in this order
      character(*), intent(in) :: name !! name of the quantity
      character(*), intent(in) :: dimension !! what it is measured in
      integer, intent(in) :: n_components !! numbers per point or cell
      real(dp), intent(in) :: values(:) !! the values, those of one point or cell together

      if (.not. allocated(self%not_finite)) then
         if (.not. all(ieee_is_finite(values))) self%not_finite = name
      end if
      call self%begin_array(section, 'Float64', name, n_components, dimension)
      call write_array(self, size(values, kind=int64), reals=values)
   end subroutine vtk_file_put_reals

   !> Hands over an array of integers.
   subroutine vtk_file_put_integers(self, section, name, values)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData', 'Points' or 'Cells', in this order
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: values(:) !! the values

      call self%begin_array(section, 'Int32', name, 1, '')
      call write_array(self, size(values, kind=int64), integers=values)
   end subroutine vtk_file_put_integers

   !> Writes an array with the markup before it: the number of its bytes, then these, piece by piece, since it may be as
   !> large as anything else that a run holds.
   subroutine write_array(vtk, n, reals, integers)
      class(vtk_file_t), intent(inout) :: vtk !! the grid
      integer(int64), intent(in) :: n !! number of numbers
      real(dp), intent(in), optional :: reals(:) !! the numbers, if they are reals
      integer, intent(in), optional :: integers(:) !! the numbers, if they are integers
      character(piece_size) :: piece
      integer(int64) :: first, last, at, end, bytes_each

      bytes_each = merge(8_int64, 4_int64, present(reals))
      ! allow(C181): `finish` checks the state
      if (vtk%state == 0) write (vtk%file%unit, iostat=vtk%state) vtk%markup
      at = bytes_per_length
      piece(:at) = transfer(bytes_each*n, piece(:at))
      first = 1_int64
      do
         last = min(n, first - 1_int64 + (piece_size - at)/bytes_each)
         end = at + bytes_each*(last - first + 1_int64)
         if (present(reals)) then
            piece(at + 1:end) = transfer(reals(first:last), piece)
         else
            piece(at + 1:end) = transfer(int(integers(first:last), int32), piece)
         end if
         ! allow(C181): `finish` checks the state
         if (vtk%state == 0) write (vtk%file%unit, iostat=vtk%state) encode_base64(piece(:end))
         if (last == n) exit
         first = last + 1_int64
         at = 0_int64
      end do
      call vtk%end_array()
   end subroutine write_array

   !> Hands over plane vectors, as vectors in space.
   subroutine vtk_file_put_vectors(self, section, name, dimension, vectors)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData' or 'Points', in this order
      character(*), intent(in) :: name !! name of the quantity
      character(*), intent(in) :: dimension !! what it is measured in
      real(dp), intent(in) :: vectors(:, :) !! the vectors (2, any)

      call put_spread(self, section, name, dimension, vectors, [1, 2, 0])
   end subroutine vtk_file_put_vectors

   !> Hands over stresses xx, yy, xy, zz as VTK orders them: xx, yy, zz, xy, yz, xz.
   subroutine vtk_file_put_stresses(self, section, name, stresses)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData' or 'CellData', in this order
      character(*), intent(in) :: name !! name of the quantity
      real(dp), intent(in) :: stresses(:, :) !! the stresses (4, any)

      call put_spread(self, section, name, 'F/L^2', stresses, [1, 2, 4, 3, 0, 0])
   end subroutine vtk_file_put_stresses

   !> Hands over an array whose components stand in another order, with zeros between them.
   subroutine put_spread(vtk, section, name, dimension, values, component)
      class(vtk_file_t), intent(inout) :: vtk !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData' or 'Points', in this order
      character(*), intent(in) :: name !! name of the quantity
      character(*), intent(in) :: dimension !! what it is measured in
      real(dp), intent(in) :: values(:, :) !! the values (components, any)
      integer, intent(in) :: component(:) !! which component each number is, 0 for a zero
      real(dp), allocatable :: spread_out(:)
      integer :: i, k

      allocate (spread_out(size(component, kind=int64)*size(values, 2)))
      do i = 1, size(values, 2)
         do k = 1, size(component)
            spread_out((i - 1)*size(component) + k) = merge(values(max(1, component(k)), i), 0.0_dp, component(k) > 0)
         end do
      end do
      call vtk%put_reals(section, name, dimension, size(component), spread_out)
   end subroutine put_spread

   !> Hands over the points and the cells.
   subroutine vtk_file_put_cells(self, coordinates, connectivity, ends, types)
      class(vtk_file_t), intent(inout) :: self !! the grid
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the points (2, n_points) [L]
      integer, intent(in) :: connectivity(:) !! points of the cells, from 1, cell after cell
      integer, intent(in) :: ends(:) !! where the points of each cell end (n_cells)
      integer, intent(in) :: types(:) !! VTK's number of each cell's kind (n_cells)

      call self%put_vectors('Points', 'points', 'L', coordinates)
      call self%put_integers('Cells', 'connectivity', connectivity - 1)
      call self%put_integers('Cells', 'offsets', ends)
      call self%put_integers('Cells', 'types', types)
   end subroutine vtk_file_put_cells

   !> Completes and closes the file; it still has its temporary name.
   subroutine vtk_file_finish(self, file, error)
      class(vtk_file_t), intent(inout) :: self !! the grid
      type(output_file_t), intent(out) :: file !! the finished file
      type(error_t), allocatable, intent(out) :: error !! not everything could be written, or a number is not finite

      call self%end_grid()
      ! allow(C181): the output file's own `finish` checks the state
      if (self%state == 0) write (self%file%unit, iostat=self%state) self%markup
      call self%file%finish(self%state, error)
      file = self%file
      if (allocated(self%not_finite) .and. .not. allocated(error)) call new_error(error, numerical_failure, &
         "the quantity '"//self%not_finite//"' leaves the range of double precision (1.8e308): choose other units")
   end subroutine vtk_file_finish

end module amontons_vtk_file
