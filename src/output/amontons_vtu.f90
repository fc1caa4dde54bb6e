!> NAME.vtu: mesh, displacements, stresses and contact quantities for ParaView and meshio.
module amontons_vtu
   use amontons_body, only: body_t
   use amontons_contact_table, only: at_nodes, column_t, contact_columns
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_output_file, only: output_file_t
   use amontons_result, only: result_t
   use amontons_stress_field, only: von_mises
   use amontons_vtk_file, only: new_vtk_file, vtk_file_t
   implicit none (type, external)
   private

   public :: show_body, write_vtu

   !> VTK's numbers of the element kinds, in the order of `amontons_element`.
   integer, parameter :: vtk_cell_type(*) = [5, 9, 22, 23, 28]

contains

   !> Writes the file under its temporary name.
   subroutine write_vtu(file, path, units, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: units !! names of the units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(vtk_file_t) :: vtk

      call new_vtk_file(vtk, path, units, body%mesh%n_nodes, body%mesh%n_elements, error)
      if (allocated(error)) return
      call show_body(vtk, body, result)
      call vtk%finish(file, error)
   end subroutine write_vtu

   !> Hands the body and its result over to a file, to be written or to be compared with.
   subroutine show_body(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result

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

end module amontons_vtu
