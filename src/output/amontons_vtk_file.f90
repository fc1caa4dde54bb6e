!> Unstructured grids in VTK's XML format with appended raw data.
!>
!> The arrays are handed over twice in the same order: first they are announced in the head, then, after `begin_data`,
!> their values are written behind it.
module amontons_vtk_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp, int32, int64
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_text, only: newline, to_text
   implicit none (type, external)
   private

   public :: new_vtk_file, vtk_file_t, vtk_tail

   !> What stands behind the values.
   character(*), parameter :: vtk_tail = newline//'  </AppendedData>'//newline//'</VTKFile>'//newline

   !> A grid being written.
   type :: vtk_file_t
      private
      character(:), allocatable, public :: head !! the XML head so far
      character(:), allocatable :: section !! the section that the next array belongs to
      integer(int64) :: offset = 0_int64 !! bytes announced so far
      logical, public :: has_head = .false. !! whether the head is complete, so that values are written
      integer :: state = 0 !! status of the last write statement; nothing is written after a failure
      character(:), allocatable :: not_finite !! the first quantity with a number that is not finite
      type(output_file_t) :: file !! the file
   contains
      procedure, public :: announce => vtk_file_announce
      procedure, public :: begin_data => vtk_file_begin_data
      procedure, public :: begin_head => vtk_file_begin_head
      procedure, public :: end_head => vtk_file_end_head
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
   subroutine new_vtk_file(vtk, path, n_points, n_cells, error)
      type(vtk_file_t), intent(out) :: vtk !! the grid
      character(*), intent(in) :: path !! name of the file
      integer, intent(in) :: n_points !! number of points
      integer, intent(in) :: n_cells !! number of cells
      type(error_t), allocatable, intent(out) :: error !! the file cannot be opened

      call vtk%begin_head(n_points, n_cells)
      call new_output_file(vtk%file, path, .true., error)
   end subroutine new_vtk_file

   !> Begins the head.
   pure subroutine vtk_file_begin_head(self, n_points, n_cells)
      class(vtk_file_t), intent(inout) :: self !! the grid
      integer, intent(in) :: n_points !! number of points
      integer, intent(in) :: n_cells !! number of cells

      self%section = ''
      self%head = '<?xml version="1.0"?>'//newline// &
         '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">'//newline// &
         '  <UnstructuredGrid>'//newline//'    <Piece NumberOfPoints="'//to_text(n_points)//'" NumberOfCells="'// &
         to_text(n_cells)//'">'//newline
   end subroutine vtk_file_begin_head

   !> Completes the head: from here on values are handed over.
   pure subroutine vtk_file_end_head(self)
      class(vtk_file_t), intent(inout) :: self !! the grid

      call self%enter('')
      self%head = self%head//'    </Piece>'//newline//'  </UnstructuredGrid>'//newline// &
         '  <AppendedData encoding="raw">'//newline//'_'
      self%has_head = .true.
   end subroutine vtk_file_end_head

   !> Hands over an array of reals.
   subroutine vtk_file_put_reals(self, section, name, n_components, values)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData', 'Points' or 'Cells', in this order
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per point or cell
      real(dp), intent(in) :: values(:) !! the values, those of one point or cell together

      if (.not. self%has_head) then
         call self%announce(section, 'Float64', name, n_components, 8_int64*size(values, kind=int64))
         return
      end if
      if (.not. allocated(self%not_finite)) then
         if (.not. all(ieee_is_finite(values))) self%not_finite = name
      end if
      ! allow(C181): `finish` checks the state
      if (self%state == 0) write (self%file%unit, iostat=self%state) 8_int64*size(values, kind=int64), values
   end subroutine vtk_file_put_reals

   !> Hands over an array of integers.
   subroutine vtk_file_put_integers(self, section, name, values)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData', 'Points' or 'Cells', in this order
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: values(:) !! the values
      integer(int32), allocatable :: raw(:)

      if (.not. self%has_head) then
         call self%announce(section, 'Int32', name, 1, 4_int64*size(values, kind=int64))
      else if (self%state == 0) then
         ! An expression in the list would be written number by number.
         raw = int(values, int32)
         ! allow(C181): `finish` checks the state
         write (self%file%unit, iostat=self%state) 4_int64*size(values, kind=int64), raw
      end if
   end subroutine vtk_file_put_integers

   !> Hands over plane vectors, as vectors in space.
   subroutine vtk_file_put_vectors(self, section, name, vectors)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData' or 'Points', in this order
      character(*), intent(in) :: name !! name of the quantity
      real(dp), intent(in) :: vectors(:, :) !! the vectors (2, any)

      call put_spread(self, section, name, vectors, [1, 2, 0])
   end subroutine vtk_file_put_vectors

   !> Hands over stresses xx, yy, xy, zz as VTK orders them: xx, yy, zz, xy, yz, xz.
   subroutine vtk_file_put_stresses(self, section, name, stresses)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData' or 'CellData', in this order
      character(*), intent(in) :: name !! name of the quantity
      real(dp), intent(in) :: stresses(:, :) !! the stresses (4, any)

      call put_spread(self, section, name, stresses, [1, 2, 4, 3, 0, 0])
   end subroutine vtk_file_put_stresses

   !> Hands over an array whose components stand in another order, with zeros between them.
   subroutine put_spread(vtk, section, name, values, component)
      class(vtk_file_t), intent(inout) :: vtk !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData' or 'Points', in this order
      character(*), intent(in) :: name !! name of the quantity
      real(dp), intent(in) :: values(:, :) !! the values (components, any)
      integer, intent(in) :: component(:) !! which component each number is, 0 for a zero
      real(dp), allocatable :: spread_out(:)
      integer :: i, k

      ! What is only announced need not be made; its size counts.
      allocate (spread_out(size(component, kind=int64)*size(values, 2)))
      if (vtk%has_head) then
         do i = 1, size(values, 2)
            do k = 1, size(component)
               spread_out((i - 1)*size(component) + k) = &
                  merge(values(max(1, component(k)), i), 0.0_dp, component(k) > 0)
            end do
         end do
      end if
      call vtk%put_reals(section, name, size(component), spread_out)
   end subroutine put_spread

   !> Hands over the points and the cells.
   subroutine vtk_file_put_cells(self, coordinates, connectivity, ends, types)
      class(vtk_file_t), intent(inout) :: self !! the grid
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the points (2, n_points) [L]
      integer, intent(in) :: connectivity(:) !! points of the cells, from 1, cell after cell
      integer, intent(in) :: ends(:) !! where the points of each cell end (n_cells)
      integer, intent(in) :: types(:) !! VTK's number of each cell's kind (n_cells)

      call self%put_vectors('Points', 'points', coordinates)
      call self%put_integers('Cells', 'connectivity', connectivity - 1)
      call self%put_integers('Cells', 'offsets', ends)
      call self%put_integers('Cells', 'types', types)
   end subroutine vtk_file_put_cells

   !> Completes and writes the head.
   subroutine vtk_file_begin_data(self)
      class(vtk_file_t), intent(inout) :: self !! the grid

      call self%end_head()
      ! allow(C181): `finish` checks the state
      write (self%file%unit, iostat=self%state) self%head
   end subroutine vtk_file_begin_data

   !> Closes the file; it still has its temporary name.
   subroutine vtk_file_finish(self, file, error)
      class(vtk_file_t), intent(inout) :: self !! the grid
      type(output_file_t), intent(out) :: file !! the finished file
      type(error_t), allocatable, intent(out) :: error !! not everything could be written, or a number is not finite

      ! allow(C181): the output file's own `finish` checks the state
      if (self%state == 0) write (self%file%unit, iostat=self%state) vtk_tail
      call self%file%finish(self%state, error)
      file = self%file
      if (allocated(self%not_finite) .and. .not. allocated(error)) call new_error(error, numerical_failure, &
         "the quantity '"//self%not_finite//"' leaves the range of double precision (1.8e308): choose other units")
   end subroutine vtk_file_finish

   !> Announces an array in the head.
   pure subroutine vtk_file_announce(self, section, type, name, n_components, n_bytes)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section it belongs to
      character(*), intent(in) :: type !! VTK's word for the kind of number
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per point or cell
      integer(int64), intent(in) :: n_bytes !! length of the values [byte]

      call self%enter(section)
      self%head = self%head//'        <DataArray type="'//type//'" Name="'//name//'"'
      ! Readers take a stated single component for a column, an unstated one for a plain array.
      if (n_components > 1) self%head = self%head//' NumberOfComponents="'//to_text(n_components)//'"'
      self%head = self%head//' format="appended" offset="'//to_text(self%offset)//'"/>'//newline
      ! Each array stands behind its length, a 64-bit integer.
      self%offset = self%offset + 8_int64 + n_bytes
   end subroutine vtk_file_announce

   !> Leaves the present section of the head for another one; none is named ''.
   pure subroutine vtk_file_enter(self, section)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section to enter

      if (section == self%section) return
      if (len(self%section) > 0) self%head = self%head//'      </'//self%section//'>'//newline
      if (len(section) > 0) self%head = self%head//'      <'//section//'>'//newline
      self%section = section
   end subroutine vtk_file_enter

end module amontons_vtk_file
