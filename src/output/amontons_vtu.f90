!> The grids of a case for ParaView and meshio. NAME.vtu: mesh, displacements, stresses and contact quantities.
!> NAME.contact.vtu: the contact line alone, as a grid of line segments, and of vertices where a point has no neighbor;
!> behind it the lines of the masters of pairs, with what is transmitted to them.
module amontons_vtu
   use amontons_body, only: body_t
   use amontons_collection, only: collection_t
   use amontons_contact_rows, only: contact_rows_t, turned
   use amontons_contact_table, only: at_nodes, column_t, contact_columns
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_master_line, only: master_line_t, new_master_line, side_rows
   use amontons_output_file, only: commit_files, output_file_t
   use amontons_result, only: result_t
   use amontons_stress_field, only: von_mises
   use amontons_vtk_file, only: new_vtk_file, vtk_file_t
   implicit none (type, external)
   private

   public :: n_line_points, show_body, show_contact_line, write_case_grids, write_grids

   !> VTK's numbers of the element kinds, in the order of `amontons_element`.
   integer, parameter :: vtk_cell_type(*) = [5, 9, 22, 23, 28]
   !> VTK's numbers of a vertex and of a line segment.
   integer, parameter :: vtk_vertex = 1, vtk_line = 3

contains

   !> Writes the two grids of one case or step in a folder of many, and gives them their names.
   subroutine write_grids(collection, directory, folder, name, body, result, error)
      type(collection_t), intent(inout) :: collection !! its manifest gains them
      character(*), intent(in) :: directory !! output directory, a slash behind it
      character(*), intent(in) :: folder !! folder of the grids in it, a slash behind it
      character(*), intent(in) :: name !! name of the files without endings
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(2)

      call write_case_grids(files, directory//folder//name, collection%units, body, result, error)
      if (.not. allocated(error)) call collection%grids%add_outputs(files, folder, error)
      call commit_files(files, error)
   end subroutine write_grids

   !> Writes both grids under their temporary names.
   subroutine write_case_grids(files, stem, units, body, result, error)
      type(output_file_t), intent(inout) :: files(2) !! the finished files
      character(*), intent(in) :: stem !! name of the files without endings
      character(*), intent(in) :: units !! names of the units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(vtk_file_t) :: vtk

      call new_vtk_file(vtk, stem//'.vtu', units, error)
      if (allocated(error)) return
      call show_body(vtk, body, result)
      call vtk%finish(files(1), error)
      if (.not. allocated(error)) call new_vtk_file(vtk, stem//'.contact.vtu', units, error)
      if (allocated(error)) return
      call show_contact_line(vtk, body, result)
      call vtk%finish(files(2), error)
   end subroutine write_case_grids

   !> Hands the body and its result over to a file, to be written or to be compared with.
   subroutine show_body(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result

      call vtk%begin_grid(body%mesh%n_nodes, body%mesh%n_elements)
      call vtk%put_vectors('PointData', 'displacement', 'L', result%displacement)
      call put_contact(vtk, body, result)
      call vtk%put_stresses('PointData', 'nodal_stress', result%stress%node)
      call vtk%put_reals('PointData', 'nodal_von_mises', 'F/L^2', 1, all_von_mises(result%stress%node))
      call vtk%put_stresses('CellData', 'stress', result%stress%element)
      call vtk%put_reals('CellData', 'von_mises', 'F/L^2', 1, all_von_mises(result%stress%element))
      call vtk%put_reals('CellData', 'strain_energy_density', 'F/L^2', 1, result%stress%energy_density)
      if (allocated(result%error_estimate)) then
         vtk%scale = result%error_estimate%norm
         call vtk%put_reals('CellData', 'error_norm', 'sqrt(F L)', 1, result%error_estimate%element)
         vtk%scale = 0.0_dp
      end if
      call vtk%put_integers('CellData', 'material', body%materials%of_element)
      call vtk%put_cells(body%mesh%coordinates, body%mesh%node, body%mesh%node_start(2:) - 1, &
         vtk_cell_type(body%mesh%element_kind))
   end subroutine show_body

   !> Von Mises stresses [F/L^2].
   pure function all_von_mises(stress) result(mises)
      real(dp), intent(in) :: stress(:, :) !! the stresses xx, yy, xy, zz (4, any) [F/L^2]
      real(dp) :: mises(size(stress, 2))
      integer :: i

      do i = 1, size(stress, 2)
         mises(i) = von_mises(stress(:, i))
      end do
   end function all_von_mises

   !> Hands over the contact quantities of all nodes: 0 at those that are no contact points. A node of cells of constant
   !> multipliers has the mean of theirs, by its shares in them, and the status of the one where its share is largest.
   subroutine put_contact(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      real(dp) :: share, largest(body%mesh%n_nodes)
      integer :: status(body%mesh%n_nodes), all_nodes(body%mesh%n_nodes), i, k, p

      call contact_columns(columns, body, result)
      all_nodes = [(i, i=1, body%mesh%n_nodes)]
      do i = 1, size(columns)
         if (.not. columns(i)%is_field) cycle
         vtk%scale = columns(i)%scale
         call vtk%put_reals('PointData', trim(columns(i)%key), trim(columns(i)%dimension), 1, &
            at_nodes(body, columns(i)%values, all_nodes))
      end do
      vtk%scale = 0.0_dp
      status = 0
      largest = 0.0_dp
      associate (rows => body%zone%rows)
         do p = 1, body%zone%n_points
            do k = rows%start(p), rows%start(p + 1) - 1
               share = norm2(rows%part(:, k))*body%zone%area(p)
               if (share > largest(rows%node(k))) status(rows%node(k)) = result%solution%status(p)
               largest(rows%node(k)) = max(largest(rows%node(k)), share)
            end do
         end do
      end associate
      call vtk%put_integers('PointData', 'status', status)
   end subroutine put_contact

   !> Hands the contact line and its result over to a file, to be written or to be compared with.
   subroutine show_contact_line(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      type(master_line_t) :: line
      integer :: i

      call contact_columns(columns, body, result)
      call new_master_line(line, body%zone)
      associate (zone => body%zone)
         call vtk%begin_grid(n_line_points(zone), count(zone%next > 0) + count(.not. have_neighbor(zone)) &
            + size(line%segment, 2))
      end associate
      call put_vectors(vtk, body, result, line)
      do i = 1, size(columns)
         if (.not. columns(i)%is_field) cycle
         vtk%scale = columns(i)%scale
         call vtk%put_reals('PointData', trim(columns(i)%key), trim(columns(i)%dimension), 1, &
            [columns(i)%values, at_nodes(body, columns(i)%values, line%node)])
      end do
      vtk%scale = 0.0_dp
      call vtk%put_integers('PointData', 'status', [result%solution%status, 0*line%node])
      call vtk%put_integers('PointData', 'set', [body%zone%set, line%set])
      call put_line(vtk, body, line)
   end subroutine show_contact_line

   !> Hands over displacements and normals; where there are pairs, how far they move apart, and the forces, too.
   subroutine put_vectors(vtk, body, result, line)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(master_line_t), intent(in) :: line !! the lines of the masters
      type(contact_rows_t) :: slave

      associate (zone => body%zone, u => result%displacement, force => result%solution%force)
         slave = side_rows(zone, .false.)
         call vtk%put_vectors('PointData', 'displacement', 'L', &
            joined(vectors(zone, slave%displacement(u)), u(:, line%node)))
         call vtk%put_vectors('PointData', 'normal', '', joined(zone%normal, line%normal))
         if (line%n_nodes == 0) return
         vtk%scale = maxval(abs(u))
         call vtk%put_vectors('PointData', 'jump', 'L', &
            joined(vectors(zone, zone%rows%displacement(u)), 0.0_dp*line%normal))
         vtk%scale = maxval([0.0_dp, abs(force)])
         call vtk%put_vectors('PointData', 'force', 'F', &
            joined(-vectors(zone, force), line%forces(zone, force, body%mesh%n_nodes)))
         vtk%scale = 0.0_dp
      end associate
   end subroutine put_vectors

   !> Vectors of the contact points, those of the masters' nodes behind them.
   pure function joined(at_points, at_masters)
      real(dp), intent(in) :: at_points(:, :) !! the vectors of the points (2, m)
      real(dp), intent(in) :: at_masters(:, :) !! those of the nodes (2, n_nodes)
      real(dp), allocatable :: joined(:, :)

      allocate (joined(2, size(at_points, 2) + size(at_masters, 2)))
      joined(:, :size(at_points, 2)) = at_points
      joined(:, size(at_points, 2) + 1:) = at_masters
   end function joined

   !> Hands over the points and the cells.
   subroutine put_line(vtk, body, line)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(master_line_t), intent(in) :: line !! the lines of the masters
      integer, allocatable :: start(:), lone(:)
      integer :: i, n_lines

      associate (zone => body%zone)
         start = pack([(i, i=1, zone%n_points)], zone%next > 0)
         lone = pack([(i, i=1, zone%n_points)], .not. have_neighbor(zone))
         n_lines = size(start) + size(line%segment, 2)
         call vtk%put_cells(joined(zone%position, body%mesh%coordinates(:, line%node)), &
            [(start(i), zone%next(start(i)), i=1, size(start)), zone%n_points + [line%segment], lone], &
            [(2*i, i=1, n_lines), (2*n_lines + i, i=1, size(lone))], &
            [spread(vtk_line, 1, n_lines), spread(vtk_vertex, 1, size(lone))])
      end associate
   end subroutine put_line

   !> Number of the points of the contact line's grid: contact points and nodes of masters.
   pure integer function n_line_points(zone) result(n)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(master_line_t) :: line

      call new_master_line(line, zone)
      n = zone%n_points + line%n_nodes
   end function n_line_points

   !> Which points are the end of a segment.
   pure function have_neighbor(zone)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      logical :: have_neighbor(zone%n_points)

      have_neighbor = zone%next > 0
      have_neighbor(pack(zone%next, zone%next > 0)) = .true.
   end function have_neighbor

   !> Vectors of the contact points from their components along normals and tangents (2, m).
   pure function vectors(zone, components)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: components(:) !! the normal ones, then the tangential ones (2m)
      real(dp) :: vectors(2, zone%n_points)
      integer :: p

      do p = 1, zone%n_points
         vectors(:, p) = components(p)*zone%normal(:, p) + components(p + zone%n_points)*turned(zone%normal(:, p))
      end do
   end function vectors

end module amontons_vtu
