!> The loads of a body: tractions and pressures on boundary sets, body forces.
module amontons_loads
   use amontons_elasticity, only: element_geometry_t, new_element_geometry
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_material, only: material_t
   use amontons_mesh, only: mesh_t
   use amontons_side, only: new_side_geometry, side_geometry_t
   implicit none (type, external)
   private

   public :: load_t, load_vector

   !> A load on a boundary set (traction, pressure) or on the whole body (body force).
   type :: load_t
      character(:), allocatable :: set !! name of the boundary set; empty for a body force
      real(dp) :: traction(2) = 0.0_dp !! force per area, x and y [F/L^2]
      real(dp) :: pressure = 0.0_dp !! force per area against the outward normal [F/L^2]
      real(dp) :: body_force(2) = 0.0_dp !! force per volume, x and y [F/L^3]
      character(:), allocatable :: origin !! where the load was specified, for messages: 'deck.nml:12: '
   end type load_t

contains

   !> Nodal forces of all loads.
   subroutine load_vector(forces, mesh, material, loads, error)
      real(dp), allocatable, intent(out) :: forces(:, :) !! nodal forces, x and y (2, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(material_t), intent(in) :: material !! the material, for its thickness
      type(load_t), intent(in) :: loads(:) !! the loads
      type(error_t), allocatable, intent(out) :: error !! a load names a set that the mesh has not
      integer :: i

      allocate (forces(2, mesh%n_nodes), source=0.0_dp)
      do i = 1, size(loads)
         if (len(loads(i)%set) == 0) then
            call add_body_force(forces, mesh, loads(i)%body_force*material%thickness)
         else
            call add_side_forces(forces, mesh, loads(i), material%thickness, error)
            if (.not. allocated(error)) cycle
            error%message = loads(i)%origin//error%message
            return
         end if
      end do
   end subroutine load_vector

   !> Adds the nodal forces of a traction and a pressure on the sides of a set.
   subroutine add_side_forces(forces, mesh, load, thickness, error)
      real(dp), intent(inout) :: forces(:, :) !! nodal forces (2, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(load_t), intent(in) :: load !! the load
      real(dp), intent(in) :: thickness !! thickness of the body [L]
      type(error_t), allocatable, intent(out) :: error !! no such set
      integer, allocatable :: sides(:, :)
      type(side_geometry_t) :: geometry
      real(dp) :: force(2)
      integer :: i, k, point

      call mesh%set_sides(load%set, sides, error)
      if (allocated(error)) return
      do i = 1, size(sides, 2)
         call new_side_geometry(geometry, sides(:, i), mesh%coordinates)
         do point = 1, size(geometry%along, 2)
            associate (along => geometry%along(:, point))
               force = thickness*(load%traction*norm2(along) - load%pressure*[along(2), -along(1)])
            end associate
            do k = 1, count(sides(:, i) > 0)
               forces(:, sides(k, i)) = forces(:, sides(k, i)) + geometry%values(k, point)*force
            end do
         end do
      end do
   end subroutine add_side_forces

   !> Adds the nodal forces of a constant force per volume.
   pure subroutine add_body_force(forces, mesh, density)
      real(dp), intent(inout) :: forces(:, :) !! nodal forces (2, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: density(2) !! force per area of the plane [F/L^2]
      type(element_geometry_t) :: geometry
      real(dp) :: share
      integer :: element, i

      do element = 1, mesh%n_elements
         call new_element_geometry(geometry, mesh, element)
         do i = 1, geometry%n_nodes
            share = dot_product(geometry%values(i, :geometry%n_points), geometry%area(:geometry%n_points))
            forces(:, geometry%node(i)) = forces(:, geometry%node(i)) + share*density
         end do
      end do
   end subroutine add_body_force

end module amontons_loads
