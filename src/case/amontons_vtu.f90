!> NAME.vtu: mesh, displacements, stresses and contact quantities for ParaView and meshio, in VTK's XML format with
!> appended raw data.
module amontons_vtu
   use amontons_body, only: body_t
   use amontons_contact_table, only: contact_point_t, new_contact_point
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry
   use amontons_error, only: error_t
   use amontons_kinds, only: dp, int32, int64
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_result, only: result_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: write_vtu

   character(*), parameter :: newline = new_line('a')
   !> VTK's numbers of the element kinds, in the order of `amontons_element`.
   integer, parameter :: vtk_cell_type(*) = [5, 9, 22, 23, 28]

   !> The XML head under construction, and the length of the data it announces.
   type :: head_t
      character(:), allocatable :: text !! the head so far
      integer(int64) :: offset = 0_int64 !! bytes announced so far
   contains
      procedure :: announce => head_announce
   end type head_t

contains

   !> Writes the file under its temporary name.
   subroutine write_vtu(file, path, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      real(dp), allocatable :: points(:, :), displacement(:, :), stress(:, :), contact(:, :)
      integer(int32), allocatable :: status(:)
      integer :: state, n, p

      n = body%mesh%n_nodes
      allocate (points(3, n), displacement(3, n), contact(n, 4), source=0.0_dp)
      allocate (status(n), source=0_int32)
      points(:2, :) = body%mesh%coordinates
      displacement(:2, :) = result%displacement
      stress = cell_stresses(body, result%displacement)
      do p = 1, body%zone%n_points
         call put_point(body, result, p, contact(body%zone%node(p), :))
         status(body%zone%node(p)) = int(result%solution%status(p), int32)
      end do

      call new_output_file(file, path, .true., error)
      if (allocated(error)) return
      write (file%unit, iostat=state) head_text(n, body%mesh%n_elements, size(body%mesh%node))
      call put_reals(file%unit, reshape(displacement, [3*n]), state)
      do p = 1, size(contact, 2)
         call put_reals(file%unit, contact(:, p), state)
      end do
      call put_integers(file%unit, status, state)
      call put_reals(file%unit, reshape(stress(:6, :), [6*size(stress, 2)]), state)
      call put_reals(file%unit, stress(7, :), state)
      call put_reals(file%unit, reshape(points, [3*n]), state)
      call put_integers(file%unit, int(body%mesh%node - 1, int32), state)
      call put_integers(file%unit, int(body%mesh%node_start(2:) - 1, int32), state)
      call put_integers(file%unit, int(vtk_cell_type(body%mesh%element_kind), int32), state)
      if (state == 0) write (file%unit, iostat=state) newline//'  </AppendedData>'//newline//'</VTKFile>'//newline
      call file%finish(state, error)
   end subroutine write_vtu

   !> Appends a block of reals behind its length in bytes.
   subroutine put_reals(unit, values, state)
      integer, intent(in) :: unit !! the unit to write to
      real(dp), intent(in) :: values(:) !! the block
      integer, intent(inout) :: state !! status of the last write statement; nothing is written after a failure

      if (state /= 0) return
      ! allow(C181): the caller checks the state
      write (unit, iostat=state) 8_int64*size(values, kind=int64), values
   end subroutine put_reals

   !> Appends a block of integers behind its length in bytes.
   subroutine put_integers(unit, values, state)
      integer, intent(in) :: unit !! the unit to write to
      integer(int32), intent(in) :: values(:) !! the block
      integer, intent(inout) :: state !! status of the last write statement; nothing is written after a failure

      if (state /= 0) return
      ! allow(C181): the caller checks the state
      write (unit, iostat=state) 4_int64*size(values, kind=int64), values
   end subroutine put_integers

   !> Gap, slip, normal and tangential stress of a contact point.
   pure subroutine put_point(body, result, p, values)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      integer, intent(in) :: p !! number of the point
      real(dp), intent(out) :: values(4) !! gap and slip [L], normal and tangential stress [F/L^2]
      type(contact_point_t) :: point

      call new_contact_point(point, body, result, p)
      values = [point%gap, point%slip, point%normal_stress, point%tangential_stress]
   end subroutine put_point

   !> Mean stress of each element, xx, yy, zz, xy, yz, xz as VTK orders them, and von Mises (7, n_elements) [F/L^2].
   pure function cell_stresses(body, displacement) result(stress)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), allocatable :: stress(:, :)
      type(element_geometry_t) :: geometry
      real(dp) :: mean(4)
      integer :: element, point

      allocate (stress(7, body%mesh%n_elements), source=0.0_dp)
      do element = 1, body%mesh%n_elements
         associate (material => body%materials%list(body%materials%of_element(element)))
            call new_element_geometry(geometry, body%mesh, element, material)
            mean = 0.0_dp
            do point = 1, geometry%n_points
               mean = mean + geometry%volume(point)*element_stress(geometry, material, displacement, point)
            end do
         end associate
         mean = mean/sum(geometry%volume(:geometry%n_points))
         stress(:4, element) = mean([1, 2, 4, 3])
         stress(7, element) = sqrt(0.5_dp*((mean(1) - mean(2))**2 + (mean(2) - mean(4))**2 + (mean(4) - mean(1))**2) &
            + 3.0_dp*mean(3)**2)
      end do
   end function cell_stresses

   !> The XML head: what blocks follow, and where.
   pure function head_text(n_nodes, n_elements, n_corners) result(text)
      integer, intent(in) :: n_nodes !! number of nodes
      integer, intent(in) :: n_elements !! number of elements
      integer, intent(in) :: n_corners !! total number of nodes of the elements
      character(:), allocatable :: text
      type(head_t) :: head

      head%text = '<?xml version="1.0"?>'//newline// &
         '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">'//newline// &
         '  <UnstructuredGrid>'//newline//'    <Piece NumberOfPoints="'//to_text(n_nodes)//'" NumberOfCells="'// &
         to_text(n_elements)//'">'//newline//'      <PointData>'//newline
      call head%announce('Float64', 'displacement', 3, n_nodes)
      call head%announce('Float64', 'gap', 1, n_nodes)
      call head%announce('Float64', 'slip', 1, n_nodes)
      call head%announce('Float64', 'contact_normal_stress', 1, n_nodes)
      call head%announce('Float64', 'contact_tangential_stress', 1, n_nodes)
      call head%announce('Int32', 'contact_status', 1, n_nodes)
      head%text = head%text//'      </PointData>'//newline//'      <CellData>'//newline
      call head%announce('Float64', 'stress', 6, n_elements)
      call head%announce('Float64', 'von_mises', 1, n_elements)
      head%text = head%text//'      </CellData>'//newline//'      <Points>'//newline
      call head%announce('Float64', 'points', 3, n_nodes)
      head%text = head%text//'      </Points>'//newline//'      <Cells>'//newline
      call head%announce('Int32', 'connectivity', 1, n_corners)
      call head%announce('Int32', 'offsets', 1, n_elements)
      call head%announce('Int32', 'types', 1, n_elements)
      text = head%text//'      </Cells>'//newline//'    </Piece>'//newline//'  </UnstructuredGrid>'//newline// &
         '  <AppendedData encoding="raw">'//newline//'_'
   end function head_text

   !> Announces a block of data.
   pure subroutine head_announce(self, type, name, n_components, n_tuples)
      class(head_t), intent(inout) :: self !! the head
      character(*), intent(in) :: type !! VTK's word for the kind of number
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per tuple
      integer, intent(in) :: n_tuples !! number of tuples

      self%text = self%text//'        <DataArray type="'//type//'" Name="'//name//'"'
      ! Readers take a stated single component for a column, an unstated one for a plain array.
      if (n_components > 1) self%text = self%text//' NumberOfComponents="'//to_text(n_components)//'"'
      self%text = self%text//' format="appended" offset="'//to_text(self%offset)//'"/>'//newline
      self%offset = self%offset + 8_int64 + int(n_components, int64)*n_tuples*merge(8, 4, type == 'Float64')
   end subroutine head_announce

end module amontons_vtu
