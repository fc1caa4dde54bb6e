!> NAME.vtu: mesh, displacements, stresses and contact quantities for ParaView and meshio.
module amontons_vtu
   use amontons_body, only: body_t
   use amontons_contact_table, only: contact_point_t, new_contact_point
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_output_file, only: output_file_t
   use amontons_result, only: result_t
   use amontons_stress_field, only: new_stress_field, stress_field_t, von_mises
   use amontons_vtk_file, only: new_vtk_file, vtk_file_t
   implicit none (type, external)
   private

   public :: show_body, write_vtu

   !> VTK's numbers of the element kinds, in the order of `amontons_element`.
   integer, parameter :: vtk_cell_type(*) = [5, 9, 22, 23, 28]
   !> What of a contact point is shown: gap and slip [L], normal and tangential stress [F/L^2].
   integer, parameter :: n_contact_fields = 4

contains

   !> Writes the file under its temporary name.
   subroutine write_vtu(file, path, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(vtk_file_t) :: vtk

      call new_vtk_file(vtk, path, body%mesh%n_nodes, body%mesh%n_elements, error)
      if (allocated(error)) return
      call show_body(vtk, body, result)
      call vtk%finish(file, error)
   end subroutine write_vtu

   !> Hands the body and its result over to a file, to be written or to be compared with.
   subroutine show_body(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(stress_field_t) :: stress
      real(dp), allocatable :: contact(:, :)
      integer, allocatable :: status(:)

      call new_stress_field(stress, body%mesh, body%materials, body%coloring, result%displacement, &
         result%load_case%thermal_strain)
      call spread_contact(body, result, contact, status)
      call put_arrays(vtk, body, result, stress, contact, status)
   end subroutine show_body

   !> Hands over all arrays.
   subroutine put_arrays(vtk, body, result, stress, contact, status)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(stress_field_t), intent(in) :: stress !! the stresses
      real(dp), intent(in) :: contact(:, :) !! contact quantities of all nodes (n_nodes, n_contact_fields)
      integer, intent(in) :: status(:) !! status of all nodes, 0 at those that are no contact points (n_nodes)

      call vtk%put_vectors('PointData', 'displacement', result%displacement)
      call vtk%put_reals('PointData', 'gap', 1, contact(:, 1))
      call vtk%put_reals('PointData', 'slip', 1, contact(:, 2))
      call vtk%put_reals('PointData', 'contact_pressure', 1, contact(:, 3))
      call vtk%put_reals('PointData', 'contact_shear', 1, contact(:, 4))
      call vtk%put_integers('PointData', 'status', status)
      call vtk%put_stresses('PointData', 'nodal_stress', stress%node)
      call vtk%put_reals('PointData', 'nodal_von_mises', 1, all_von_mises(stress%node))
      call vtk%put_stresses('CellData', 'stress', stress%element)
      call vtk%put_reals('CellData', 'von_mises', 1, all_von_mises(stress%element))
      call vtk%put_reals('CellData', 'strain_energy_density', 1, stress%energy_density)
      call vtk%put_integers('CellData', 'material', body%materials%of_element)
      call vtk%put_cells(body%mesh%coordinates, body%mesh%node, body%mesh%node_start(2:) - 1, &
         vtk_cell_type(body%mesh%element_kind))
   end subroutine put_arrays

   !> Von Mises stresses [F/L^2].
   pure function all_von_mises(stress) result(mises)
      real(dp), intent(in) :: stress(:, :) !! the stresses xx, yy, xy, zz (4, any) [F/L^2]
      real(dp) :: mises(size(stress, 2))
      integer :: i

      do i = 1, size(stress, 2)
         mises(i) = von_mises(stress(:, i))
      end do
   end function all_von_mises

   !> Contact quantities of all nodes: 0 at those that are no contact points. A node of cells of constant multipliers
   !> has the mean of theirs, by its shares in them, and the status of the one where its share is largest.
   pure subroutine spread_contact(body, result, contact, status)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      real(dp), allocatable, intent(out) :: contact(:, :) !! the quantities (n_nodes, n_contact_fields)
      integer, allocatable, intent(out) :: status(:) !! the statuses (n_nodes)
      type(contact_point_t) :: point
      real(dp) :: share, total(body%mesh%n_nodes), largest(body%mesh%n_nodes)
      integer :: p, i, node

      allocate (contact(body%mesh%n_nodes, n_contact_fields), source=0.0_dp)
      allocate (status(body%mesh%n_nodes), source=0)
      total = 0.0_dp
      largest = 0.0_dp
      do p = 1, body%zone%n_points
         call new_contact_point(point, body, result, p)
         do i = body%zone%rows%start(p), body%zone%rows%start(p + 1) - 1
            node = body%zone%rows%node(i)
            share = norm2(body%zone%rows%part(:, i))*body%zone%area(p)
            if (.not. share > 0.0_dp) cycle
            total(node) = total(node) + share
            contact(node, :) = contact(node, :) + share/total(node) &
               *([point%gap, point%slip, point%pressure, point%shear] - contact(node, :))
            if (share > largest(node)) status(node) = result%solution%status(p)
            largest(node) = max(largest(node), share)
         end do
      end do
   end subroutine spread_contact

end module amontons_vtu
