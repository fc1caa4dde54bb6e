!> NAME.contact.vtu: the contact line alone, as a grid of line segments, and of vertices where a point has no neighbor.
module amontons_contact_vtu
   use amontons_body, only: body_t
   use amontons_contact_rows, only: turned
   use amontons_contact_table, only: contact_point_t, new_contact_point
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

   !> What is shown of the contact points.
   type :: contact_line_t
      real(dp), allocatable :: position(:, :) !! coordinates (2, m) [L]
      real(dp), allocatable :: displacement(:, :) !! displacement (2, m) [L]
      real(dp), allocatable :: normal(:, :) !! unit outward normal of the body (2, m) [-]
      real(dp), allocatable :: gap(:) !! distance to the obstacle (m) [L]
      real(dp), allocatable :: slip(:) !! tangential displacement (m) [L]
      real(dp), allocatable :: pressure(:) !! normal stress, compression positive (m) [F/L^2]
      real(dp), allocatable :: shear(:) !! tangential stress, along the slip (m) [F/L^2]
      real(dp), allocatable :: bound(:) !! shear stress that friction can bear (m) [F/L^2]
   end type contact_line_t

contains

   !> Writes the file under its temporary name.
   subroutine write_contact_vtu(file, path, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(vtk_file_t) :: vtk

      call new_vtk_file(vtk, path, body%zone%n_points, n_line_cells(body%zone), error)
      if (allocated(error)) return
      call show_contact_line(vtk, body, result)
      call vtk%finish(file, error)
   end subroutine write_contact_vtu

   !> Hands the contact line and its result over to a file, to be written or to be compared with.
   subroutine show_contact_line(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(contact_line_t) :: line
      integer, allocatable :: start(:), lone(:)
      integer :: p

      line = new_contact_line(body, result)
      start = pack([(p, p=1, body%zone%n_points)], body%zone%next > 0)
      lone = pack([(p, p=1, body%zone%n_points)], .not. have_neighbor(body%zone))
      call put_arrays(vtk, line, body%zone%set, result%solution%status, start, body%zone%next(start), lone)
   end subroutine show_contact_line

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

   !> Hands over all arrays.
   subroutine put_arrays(vtk, line, set, status, start, end, lone)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(contact_line_t), intent(in) :: line !! the contact points
      integer, intent(in) :: set(:) !! contact set of each point (m)
      integer, intent(in) :: status(:) !! status of each point (m)
      integer, intent(in) :: start(:) !! point where each segment begins
      integer, intent(in) :: end(:) !! point where each segment ends
      integer, intent(in) :: lone(:) !! points without a segment
      integer :: i

      call vtk%put_vectors('PointData', 'displacement', line%displacement)
      call vtk%put_vectors('PointData', 'normal', line%normal)
      call vtk%put_reals('PointData', 'gap', 1, line%gap)
      call vtk%put_reals('PointData', 'slip', 1, line%slip)
      call vtk%put_reals('PointData', 'contact_pressure', 1, line%pressure)
      call vtk%put_reals('PointData', 'contact_shear', 1, line%shear)
      call vtk%put_reals('PointData', 'shear_bound', 1, line%bound)
      call vtk%put_integers('PointData', 'status', status)
      call vtk%put_integers('PointData', 'set', set)
      call vtk%put_cells(line%position, [(start(i), end(i), i=1, size(start)), lone], &
         [(2*i, i=1, size(start)), (2*size(start) + i, i=1, size(lone))], &
         [spread(vtk_line, 1, size(start)), spread(vtk_vertex, 1, size(lone))])
   end subroutine put_arrays

   !> Gathers what is shown of the contact points.
   pure function new_contact_line(body, result) result(line)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(contact_line_t) :: line
      type(contact_point_t) :: point
      integer :: p, m

      m = body%zone%n_points
      allocate (line%position(2, m), line%normal(2, m), line%gap(m), line%slip(m), line%pressure(m), line%shear(m))
      do p = 1, m
         call new_contact_point(point, body, result, p)
         line%position(:, p) = point%position
         line%normal(:, p) = point%normal
         line%gap(p) = point%gap
         line%slip(p) = point%slip
         line%pressure(p) = point%pressure
         line%shear(p) = point%shear
      end do
      line%displacement = point_displacements(body, result)
      line%bound = result%load_case%friction*max(0.0_dp, line%pressure)
      where (body%zone%area > 0.0_dp) line%bound = line%bound + result%load_case%slip_bound/body%zone%area
   end function new_contact_line

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
