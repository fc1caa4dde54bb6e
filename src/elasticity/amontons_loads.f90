!> The loads of a body: tractions and pressures on boundary sets, point forces, body forces.
module amontons_loads
   use amontons_elasticity, only: element_geometry_t, new_element_geometry
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_side, only: new_side_geometry, side_geometry_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: load_t, load_vector, new_load

   !> What a load acts on: the sides of a set.
   integer, parameter, public :: load_on_sides = 1
   !> What a load acts on: the nodes of a set, or the node at a point.
   integer, parameter, public :: load_on_nodes = 2
   !> What a load acts on: a region, or the whole body.
   integer, parameter, public :: load_on_region = 3

   !> A load. Which components count depends on what it acts on.
   type :: load_t
      character(:), allocatable :: name !! its name, by which a sweep knows it; empty without one
      integer :: target = load_on_sides !! sides, nodes or region
      character(:), allocatable :: set !! name of the boundary set or node set; empty where a point or region counts
      character(:), allocatable :: region !! name of the region of a body force; empty for the whole body
      real(dp) :: traction(2) = 0.0_dp !! force per area at the origin, x and y [F/L^2]
      real(dp) :: traction_slope(2, 2) = 0.0_dp !! its change per length: (:, 1) along x, (:, 2) along y [F/L^3]
      real(dp) :: pressure = 0.0_dp !! force per area against the outward normal, at the origin [F/L^2]
      real(dp) :: pressure_slope(2) = 0.0_dp !! its change per length along x and y [F/L^3]
      real(dp) :: point(2) = 0.0_dp !! coordinates of the node of a point force without a set [L]
      real(dp) :: force(2) = 0.0_dp !! point force on the node, or on each node of the set, x and y [F]
      real(dp) :: body_force(2) = 0.0_dp !! force per volume, x and y [F/L^3]
      character(:), allocatable :: origin !! where the load was specified, for messages: 'deck.nml:12: '
   end type load_t

contains

   !> Makes a load on the sides of a boundary set that has no strength yet.
   pure subroutine new_load(load, set)
      type(load_t), intent(out) :: load !! the load
      character(*), intent(in) :: set !! name of the boundary set

      load%set = set
      load%region = ''
      load%name = ''
      load%origin = ''
   end subroutine new_load

   !> Nodal forces of all loads.
   subroutine load_vector(forces, mesh, materials, loads, error)
      real(dp), allocatable, intent(out) :: forces(:, :) !! nodal forces, x and y (2, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(load_t), intent(in) :: loads(:) !! the loads
      type(error_t), allocatable, intent(out) :: error !! a load names a set, region or point that the mesh has not
      integer :: i

      allocate (forces(2, mesh%n_nodes), source=0.0_dp)
      do i = 1, size(loads)
         select case (loads(i)%target)
         case (load_on_sides)
            call add_side_forces(forces, mesh, materials, loads(i), error)
         case (load_on_nodes)
            call add_point_forces(forces, mesh, loads(i), error)
         case default
            call add_body_force(forces, mesh, materials, loads(i), error)
         end select
         if (.not. allocated(error)) cycle
         error%message = loads(i)%origin//error%message
         return
      end do
   end subroutine load_vector

   !> Adds the nodal forces of a traction and a pressure on the sides of a set.
   subroutine add_side_forces(forces, mesh, materials, load, error)
      real(dp), intent(inout) :: forces(:, :) !! nodal forces (2, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(load_t), intent(in) :: load !! the load
      type(error_t), allocatable, intent(out) :: error !! no such set
      integer, allocatable :: sides(:, :)
      type(side_geometry_t) :: geometry
      real(dp) :: force(2)
      integer :: i, k, point

      call mesh%set_sides(load%set, sides, error)
      if (allocated(error)) return
      do i = 1, size(sides, 2)
         call new_side_geometry(geometry, sides(:3, i), mesh%coordinates)
         do point = 1, size(geometry%along, 2)
            associate (x => geometry%position(:, point), along => geometry%along(:, point), &
               material => materials%list(materials%of_element(sides(4, i))))
               force = (load%traction + matmul(load%traction_slope, x))*norm2(along) &
                  - (load%pressure + dot_product(load%pressure_slope, x))*[along(2), -along(1)]
               force = force*material%depth(x(1))
            end associate
            do k = 1, count(sides(:3, i) > 0)
               forces(:, sides(k, i)) = forces(:, sides(k, i)) + geometry%values(k, point)*force
            end do
         end do
      end do
   end subroutine add_side_forces

   !> Adds a point force to the node at a point, or to every node of a set.
   subroutine add_point_forces(forces, mesh, load, error)
      real(dp), intent(inout) :: forces(:, :) !! nodal forces (2, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(load_t), intent(in) :: load !! the load
      type(error_t), allocatable, intent(out) :: error !! no such node set, or no node at the point
      integer, allocatable :: nodes(:)
      integer :: i

      if (len(load%set) == 0) then
         nodes = [mesh%nearest_node(load%point)]
         if (nodes(1) == 0) call new_error(error, input_refused, 'no node at the point '//to_text(load%point(1))// &
            ', '//to_text(load%point(2)))
      else
         call mesh%set_nodes(load%set, nodes, error)
      end if
      if (allocated(error)) return
      do i = 1, size(nodes)
         forces(:, nodes(i)) = forces(:, nodes(i)) + load%force
      end do
   end subroutine add_point_forces

   !> Adds the nodal forces of a constant force per volume.
   subroutine add_body_force(forces, mesh, materials, load, error)
      real(dp), intent(inout) :: forces(:, :) !! nodal forces (2, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(load_t), intent(in) :: load !! the load
      type(error_t), allocatable, intent(out) :: error !! no such region
      type(element_geometry_t) :: geometry
      integer, allocatable :: elements(:)
      real(dp) :: share
      integer :: i, k, n

      call mesh%region_elements(load%region, elements, error)
      if (allocated(error)) return
      do i = 1, size(elements)
         call new_element_geometry(geometry, mesh, elements(i), &
            materials%list(materials%of_element(elements(i))))
         n = geometry%n_points
         do k = 1, geometry%n_nodes
            share = dot_product(geometry%values(k, :n), geometry%volume(:n))
            forces(:, geometry%node(k)) = forces(:, geometry%node(k)) + share*load%body_force
         end do
      end do
   end subroutine add_body_force

end module amontons_loads
