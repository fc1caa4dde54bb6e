!> NAME.contact.vtu: the contact line alone, as a grid of line segments, and of vertices where a point has no neighbor.
module amontons_contact_vtu
   use amontons_body, only: body_t
   use amontons_contact_rows, only: turned
   use amontons_contact_table, only: column_t, contact_columns
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_output_file, only: output_file_t
   use amontons_result, only: result_t
   use amontons_vtk_file, only: new_vtk_file, vtk_file_t
   implicit none (type, external)
   private

   public :: n_line_cells, show_contact_line, write_contact_vtu

   !> VTK's numbers of a vertex and of a line segment.
   integer, parameter :: vtk_vertex = 1, vtk_line = 3

contains

   !> Writes the file under its temporary name.
   subroutine write_contact_vtu(file, path, units, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: units !! names of the units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(vtk_file_t) :: vtk

      call new_vtk_file(vtk, path, units, body%zone%n_points, n_line_cells(body%zone), error)
      if (allocated(error)) return
      call show_contact_line(vtk, body, result)
      call vtk%finish(file, error)
   end subroutine write_contact_vtu

   !> Hands the contact line and its result over to a file, to be written or to be compared with.
   subroutine show_contact_line(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      integer :: i

      call contact_columns(columns, body, result)
      call vtk%put_vectors('PointData', 'displacement', 'L', point_displacements(body, result))
      call vtk%put_vectors('PointData', 'normal', '', body%zone%normal)
      do i = 1, size(columns)
         if (.not. columns(i)%is_field) cycle
         vtk%scale = columns(i)%scale
         call vtk%put_reals('PointData', trim(columns(i)%key), trim(columns(i)%dimension), 1, columns(i)%values)
      end do
      vtk%scale = 0.0_dp
      call vtk%put_integers('PointData', 'status', result%solution%status)
      call vtk%put_integers('PointData', 'set', body%zone%set)
      call put_line(vtk, body%zone)
   end subroutine show_contact_line

   !> Hands over the points and the cells.
   subroutine put_line(vtk, zone)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, allocatable :: start(:), lone(:)
      integer :: i

      start = pack([(i, i=1, zone%n_points)], zone%next > 0)
      lone = pack([(i, i=1, zone%n_points)], .not. have_neighbor(zone))
      call vtk%put_cells(zone%position, [(start(i), zone%next(start(i)), i=1, size(start)), lone], &
         [(2*i, i=1, size(start)), (2*size(start) + i, i=1, size(lone))], &
         [spread(vtk_line, 1, size(start)), spread(vtk_vertex, 1, size(lone))])
   end subroutine put_line

   !> Number of the cells of the contact line: segments, and vertices where a point has no neighbor.
   pure integer function n_line_cells(zone) result(n)
      type(contact_zone_t), intent(in) :: zone !! the contact points

      n = count(zone%next > 0) + count(.not. have_neighbor(zone))
   end function n_line_cells

   !> Which points are the end of a segment.
   pure function have_neighbor(zone)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      logical :: have_neighbor(zone%n_points)

      have_neighbor = zone%next > 0
      have_neighbor(pack(zone%next, zone%next > 0)) = .true.
   end function have_neighbor

   !> The displacements of the contact points: of nodes their own, of cells the mean (2, m) [L].
   pure function point_displacements(body, result) result(displacements)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      real(dp), allocatable :: displacements(:, :)
      real(dp) :: parts(2*body%zone%n_points)
      integer :: p

      parts = body%zone%rows%displacement(result%displacement)
      displacements = body%zone%normal
      do p = 1, body%zone%n_points
         displacements(:, p) = parts(p)*body%zone%normal(:, p) &
            + parts(p + body%zone%n_points)*turned(body%zone%normal(:, p))
      end do
   end function point_displacements

end module amontons_contact_vtu
