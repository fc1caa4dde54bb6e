!> The loads of a body: tractions and pressures on boundary sets, point forces, body forces, and temperatures with their
!> free thermal strain.
module amontons_loads
   use amontons_dense, only: cholesky_factor, cholesky_solve, vector_product
   use amontons_elasticity, only: element_geometry_t, new_element_geometry
   use amontons_element, only: has_bubble
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face, only: face_t, set_faces
   use amontons_integer_list, only: new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t, on_axis
   use amontons_mesh, only: mesh_t
   use amontons_text, only: place_text, to_text
   implicit none (type, external)
   private

   public :: add_point_forces, load_t, load_vector, new_load, spread_total_force, sum_element_loads

   !> Target of a load: the sides of a set.
   integer, parameter, public :: load_on_sides = 1
   !> Target of a load: the nodes of a set, or the node at a point.
   integer, parameter, public :: load_on_nodes = 2
   !> Target of a load: a region, or the whole body.
   integer, parameter, public :: load_on_region = 3
   !> Target of a load: the thermal strain of a region, or of the whole body.
   integer, parameter, public :: load_by_temperature = 4
   !> Target of a load: the motion of a rigid set, or the jump of a preload.
   integer, parameter, public :: load_on_motion = 5

   !> A load. Which components are used depends on its target; a plane body has x and y alone.
   type :: load_t
      character(:), allocatable :: name !! its name, by which sweeps and histories refer to it; empty without one
      integer :: target = load_on_sides !! sides, nodes, region, temperature or motion
      character(:), allocatable :: set !! name of the boundary set or node set; empty where a point or region counts
      character(:), allocatable :: region !! region of a body force or temperature; empty for the whole body
      real(dp) :: traction(3) = 0.0_dp !! force per area at the origin [F/L^2]
      real(dp) :: traction_slope(3, 3) = 0.0_dp !! its change per length: (:, 1) along x, (:, 2) along y, ... [F/L^3]
      real(dp) :: traction_theta = 0.0_dp !! force per area around the axis of a twisted body [F/L^2]
      real(dp) :: torque = 0.0_dp
         !! moment about the axis of a traction around it on the set in proportion to the radius; 0 for none [F L]
      real(dp) :: torque_traction = 0.0_dp !! this traction over the radius [F/L^3]
      real(dp) :: pressure = 0.0_dp !! force per area against the outward normal, at the origin [F/L^2]
      real(dp) :: pressure_slope(3) = 0.0_dp !! its change per length [F/L^3]
      real(dp) :: total_force(3) = 0.0_dp
         !! resultant of a traction on the set, over the thickness or all around the axis; 0 for none [F]
      real(dp) :: total_moment(3) = 0.0_dp !! its moment about a point, on a solid; 0 for none [F L]
      logical :: has_about = .false. !! whether this point is given; else it is the centroid of the set
      real(dp) :: about(3) = 0.0_dp !! the point [L]
      real(dp) :: point(3) = 0.0_dp !! coordinates of the node of a point force without a set [L]
      real(dp) :: force(3) = 0.0_dp
         !! force on the node, on each node of the set, or on the rigid set; the first is that of a preload [F]
      real(dp) :: moment(3) = 0.0_dp
         !! moment on the rigid set about its point; in the plane and about the axis of a twisted body the third [F L]
      real(dp) :: body_force(3) = 0.0_dp !! force per volume [F/L^3]
      real(dp) :: gravity(3) = 0.0_dp !! acceleration that makes a weight of the density [L/T^2]
      real(dp) :: angular_speed = 0.0_dp !! of a rotation: its centrifugal force acts on the density [1/T]
      real(dp) :: center(3) = 0.0_dp !! a point of the axis of this rotation; of no effect in a body of revolution [L]
      real(dp) :: axis(3) = 0.0_dp
         !! direction of this axis, of any length; 0 for one normal to the plane, or of revolution [-]
      real(dp) :: temperature = 0.0_dp !! temperature above that of the body without thermal strain, at the origin [K]
      real(dp) :: temperature_slope(3) = 0.0_dp !! its change along x, y, z [K/L]
      real(dp), allocatable :: temperature_table(:, :)
         !! instead: numbers of nodes as in the mesh's file, and their temperatures (2, entries) [K]
      character(:), allocatable :: temperature_file !! the file of this table; empty or not allocated without one
      character(:), allocatable :: origin !! where the load was specified, for messages: 'deck.nml:12: '
   end type load_t

contains

   !> Makes a load of zero on the sides of a boundary set.
   pure subroutine new_load(load, set)
      type(load_t), intent(out) :: load !! the load
      character(*), intent(in) :: set !! name of the boundary set

      load%set = set
      load%region = ''
      load%name = ''
      load%origin = ''
   end subroutine new_load

   !> Nodal forces of all loads but those on motions; temperatures cause none here, see `sum_element_loads`.
   subroutine load_vector(forces, mesh, materials, loads, error, uncanceled)
      real(dp), allocatable, intent(out) :: forces(:, :) !! nodal forces (components, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(load_t), intent(in) :: loads(:) !! the loads
      type(error_t), allocatable, intent(out) :: error !! a load names a set, region or point that the mesh has not
      real(dp), intent(out), optional :: uncanceled !! sum of the norms of the forces of each load [F]
      real(dp), allocatable :: before(:, :)
      integer :: i

      allocate (forces(materials%n_components(), mesh%n_nodes), source=0.0_dp)
      if (present(uncanceled)) uncanceled = 0.0_dp
      do i = 1, size(loads)
         before = forces
         select case (loads(i)%target)
         case (load_on_sides)
            call add_side_forces(forces, mesh, materials, loads(i), error)
         case (load_on_nodes)
            call add_point_forces(forces, mesh, materials, loads(i), error)
         case (load_on_region)
            call add_body_force(forces, mesh, materials, loads(i), error)
         case default
            ! A temperature strains the body and is no force; forces on motions come from `driven_forces`.
            cycle
         end select
         if (allocated(error)) error%message = loads(i)%origin//error%message
         if (allocated(error)) return
         if (present(uncanceled)) uncanceled = uncanceled + norm2(forces - before)
      end do
   end subroutine load_vector

   !> Replaces the total force of a load by the uniform traction with this resultant, its moment by that which increases
   !> with the distance from an axis through the centroid, and a torque by the one around the axis of revolution.
   subroutine spread_total_force(load, mesh, materials, error)
      type(load_t), intent(inout) :: load !! the load; gains the traction if it has a total force, a moment or a torque
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(error_t), allocatable, intent(out) :: error !! no such set, or one without area
      type(face_t), allocatable :: faces(:)
      real(dp) :: area, polar_moment, centroid(size(mesh%coordinates, 1))
      integer :: i, n_dim, point

      n_dim = size(centroid)
      if (.not. any(abs([load%total_force, load%total_moment, load%torque]) > 0.0_dp)) return
      call set_faces(faces, mesh, load%set, error, materials)
      if (allocated(error)) return
      area = 0.0_dp
      polar_moment = 0.0_dp
      centroid = 0.0_dp
      do i = 1, size(faces)
         do point = 1, size(faces(i)%area)
            area = area + faces(i)%area(point)
            centroid = centroid + faces(i)%area(point)*faces(i)%position(:n_dim, point)
            polar_moment = polar_moment + faces(i)%area(point)*faces(i)%position(1, point)**2
         end do
      end do
      if (area > 0.0_dp) then
         if (any(abs([load%total_force, load%total_moment]) > 0.0_dp)) load%traction = load%total_force/area
         load%torque_traction = load%torque/polar_moment
         if (any(abs(load%total_moment) > 0.0_dp)) call spread_total_moment(load, faces, centroid/area)
      else
         call new_error(error, input_refused, merge('torque     ', 'total_force', abs(load%torque) > 0.0_dp)// &
            ": set '"//load%set//"' lies on the axis of revolution and has no area")
      end if
   end subroutine spread_total_force

   !> Adds the traction b x (x - c) with the moment of a load on a set of faces in space; c is their centroid.
   subroutine spread_total_moment(load, faces, centroid)
      type(load_t), intent(inout) :: load !! the load, with the uniform traction of its total force
      type(face_t), intent(in) :: faces(:) !! the faces
      real(dp), intent(in) :: centroid(:) !! their centroid (3) [L]
      real(dp) :: inertia(3, 3), arm(3), b(3)
      integer :: i, info, n_dim, point

      n_dim = size(centroid)
      inertia = 0.0_dp
      do i = 1, size(faces)
         do point = 1, size(faces(i)%area)
            arm = faces(i)%position(:n_dim, point) - centroid
            inertia = inertia + faces(i)%area(point)*(norm2(arm)**2*reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3]) &
               - spread(arm, 1, 3)*spread(arm, 2, 3))
         end do
      end do
      b = load%total_moment
      if (load%has_about) b = b + vector_product(load%about - centroid, load%total_force)
      call cholesky_factor(inertia, info)
      call cholesky_solve(inertia, b)
      load%traction = load%traction - vector_product(b, centroid)
      load%traction_slope = reshape([0.0_dp, b(3), -b(2), -b(3), 0.0_dp, b(1), b(2), -b(1), 0.0_dp], [3, 3])
   end subroutine spread_total_moment

   !> Adds the nodal forces of a traction and a pressure on the sides of a set.
   subroutine add_side_forces(forces, mesh, materials, given, error)
      real(dp), intent(inout) :: forces(:, :) !! nodal forces (components, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(load_t), intent(in) :: given !! the load
      type(error_t), allocatable, intent(out) :: error !! no such set, or a total force on one without area
      type(load_t) :: load
      type(face_t), allocatable :: faces(:)
      real(dp) :: force(3)
      integer :: i, k, point

      load = given
      if (any(abs([load%traction_theta, load%torque]) > 0.0_dp) .and. .not. materials%is_twisted()) then
         call new_error(error, input_refused, 'torque and traction_theta need twist = .true. in &material')
      end if
      if (.not. allocated(error)) call spread_total_force(load, mesh, materials, error)
      if (.not. allocated(error)) call set_faces(faces, mesh, load%set, error, materials)
      if (allocated(error)) return
      do i = 1, size(faces)
         associate (face => faces(i), n_dim => size(mesh%coordinates, 1))
            do point = 1, size(face%area)
               associate (x => face%position(:n_dim, point), length => face%length(point))
                  force(3) = (load%traction_theta + load%torque_traction*x(1))*length
                  force(:n_dim) = (load%traction(:n_dim) + matmul(load%traction_slope(:n_dim, :n_dim), x))*length &
                     - (load%pressure + dot_product(load%pressure_slope(:n_dim), x))*face%outward(:n_dim, point)
               end associate
               force = force*face%depth(point)
               do k = 1, face%n_nodes
                  forces(:, face%node(k)) = forces(:, face%node(k)) + face%values(k, point)*force(:size(forces, 1))
               end do
            end do
         end associate
      end do
   end subroutine add_side_forces

   !> Adds a point force to the node at a point, or to every node of a set.
   subroutine add_point_forces(forces, mesh, materials, load, error)
      real(dp), intent(inout) :: forces(:, :) !! nodal forces (components, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials; they record whether it is a body of revolution
      type(load_t), intent(in) :: load !! the load
      type(error_t), allocatable, intent(out) :: error
         !! no such node set, no node at the point, or a force away from the axis of revolution
      integer, allocatable :: nodes(:)
      logical :: is_on_axis(mesh%n_nodes)
      integer :: i, n_dim

      n_dim = size(mesh%coordinates, 1)
      if (len(load%set) == 0) then
         nodes = [mesh%nearest_node(load%point(:n_dim))]
         if (nodes(1) == 0) call new_error(error, input_refused, 'no node at the point '//place_text( &
            load%point(:n_dim)))
      else
         call mesh%set_nodes(load%set, nodes, error)
      end if
      if (allocated(error)) return
      is_on_axis = on_axis(mesh, materials)
      if (abs(load%force(1)) > 0.0_dp .and. any(is_on_axis(nodes))) then
         call new_error(error, input_refused, 'a force on the axis of revolution must be along it: force = 0.0, ...')
         return
      end if
      do i = 1, size(nodes)
         forces(:n_dim, nodes(i)) = forces(:n_dim, nodes(i)) + load%force(:n_dim)
      end do
   end subroutine add_point_forces

   !> Adds the nodal forces of a force per volume.
   subroutine add_body_force(forces, mesh, materials, load, error)
      real(dp), intent(inout) :: forces(:, :) !! nodal forces (components, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for depth and density
      type(load_t), intent(in) :: load !! the load
      type(error_t), allocatable, intent(out) :: error !! no such region, no density, or a force that turns the axis
      type(element_geometry_t) :: geometry
      integer, allocatable :: elements(:)
      real(dp) :: force(size(mesh%coordinates, 1))
      logical :: spins
      integer :: i, k, point, n_dim

      n_dim = size(mesh%coordinates, 1)
      call mesh%region_elements(load%region, elements, error)
      if (allocated(error)) return
      spins = abs(load%angular_speed) > 0.0_dp
      if (any(materials%list%is_axisymmetric)) then
         if (abs(load%gravity(1)) > 0.0_dp) then
            call new_error(error, input_refused, 'the gravity on a body of revolution must be along its axis: '// &
               'gravity = 0.0, ...')
         else if (spins .and. any(abs([load%center, load%axis]) > 0.0_dp)) then
            call new_error(error, input_refused, 'a body of revolution spins about its own axis, x = 0: leave out '// &
               'center and axis')
         end if
      else if (spins .and. any(materials%list%is_solid) .and. .not. any(abs(load%axis) > 0.0_dp)) then
         call new_error(error, input_refused, 'angular_speed of a solid needs the axis of its rotation')
      end if
      if ((spins .or. any(abs(load%gravity) > 0.0_dp)) .and. &
         any(.not. materials%list(materials%of_element(elements))%density > 0.0_dp)) call new_error(error, &
         input_refused, 'gravity and angular_speed need the density of every &material they act on')
      if (allocated(error)) return
      do i = 1, size(elements)
         associate (material => materials%list(materials%of_element(elements(i))))
            call new_element_geometry(geometry, mesh, elements(i), material)
            do point = 1, geometry%n_points
               force = geometry%volume(point)*force_density(load, material, geometry%position(:n_dim, point))
               do k = 1, geometry%n_nodes
                  forces(:n_dim, geometry%node(k)) = forces(:n_dim, geometry%node(k)) &
                     + geometry%values(k, point)*force
               end do
            end do
            if (geometry%n_functions == geometry%n_nodes) cycle
            force = force_on_bubble(load, material, geometry, n_dim)
            do k = 1, geometry%n_nodes
               forces(:n_dim, geometry%node(k)) = forces(:n_dim, geometry%node(k)) &
                  + matmul(force, geometry%projection%bubble(:, n_dim*(k - 1) + 1:n_dim*k))
            end do
         end associate
      end do
   end subroutine add_body_force

   !> Force per volume at a place: body force, weight and centrifugal force [F/L^3].
   pure function force_density(load, material, position) result(density)
      type(load_t), intent(in) :: load !! the load
      type(material_t), intent(in) :: material !! the material there
      real(dp), intent(in) :: position(:) !! the place [L]
      real(dp) :: density(size(position))
      real(dp), dimension(size(position)) :: along, way
      integer :: n

      ! The way from the axis of rotation, along which the centrifugal acceleration acts.
      n = size(position)
      way = position - load%center(:n)
      if (material%is_axisymmetric) then
         way(2) = 0.0_dp
      else if (any(abs(load%axis) > 0.0_dp)) then
         along = load%axis(:n)/norm2(load%axis)
         way = way - dot_product(way, along)*along
      end if
      density = load%body_force(:n) + material%density*(load%gravity(:n) + load%angular_speed**2*way)
   end function force_density

   !> The part of a force per volume that acts on the bubble of an element [F].
   pure function force_on_bubble(load, material, geometry, n_dim) result(force)
      type(load_t), intent(in) :: load !! the load
      type(material_t), intent(in) :: material !! the material of the element
      type(element_geometry_t), intent(in) :: geometry !! its shape functions, with a bubble
      integer, intent(in) :: n_dim !! number of dimensions
      real(dp) :: force(n_dim)
      integer :: point

      force = 0.0_dp
      do point = 1, geometry%n_points
         force = force + geometry%values(geometry%n_functions, point)*geometry%volume(point) &
            *force_density(load, material, geometry%position(:n_dim, point))
      end do
   end function force_on_bubble

   !> What all loads together do inside the elements with their nodes at rest: thermal strain, stored by element, since
   !> loads and materials may differ from one element to the next, and the displacements of bubbles by body forces.
   subroutine sum_element_loads(inside, mesh, materials, loads, error)
      real(dp), allocatable, intent(out) :: inside(:)
         !! largest coefficient times temperature at the nodes of each element, in the order of `mesh%node`, then the
         !! components of the displacement of the bubble of each; not allocated without temperatures and bubbles that
         !! body forces move [-], [L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, with their coefficients
      type(load_t), intent(in) :: loads(:) !! the loads
      type(error_t), allocatable, intent(out) :: error
         !! a load names a region that the mesh has not, or gives no temperature for a node
      type(element_geometry_t) :: geometry
      integer, allocatable :: elements(:)
      real(dp), allocatable :: at_nodes(:)
      logical :: has_bubbles
      integer :: first, last, i, k, n_dim

      n_dim = size(mesh%coordinates, 1)
      has_bubbles = any(has_bubble(mesh%element_kind) .and. materials%list(materials%of_element)%is_b_bar)
      if (.not. any(loads%target == load_by_temperature .or. (loads%target == load_on_region .and. has_bubbles))) return
      allocate (inside(size(mesh%node) + n_dim*mesh%n_elements), source=0.0_dp)
      do i = 1, size(loads)
         if (all(loads(i)%target /= [load_by_temperature, load_on_region])) cycle
         call mesh%region_elements(loads(i)%region, elements, error)
         if (.not. allocated(error) .and. loads(i)%target == load_by_temperature) then
            call find_temperatures(at_nodes, mesh, loads(i), elements, error)
         end if
         if (allocated(error)) error%message = loads(i)%origin//error%message
         if (allocated(error)) return
         do k = 1, size(elements)
            associate (material => materials%list(materials%of_element(elements(k))))
               if (loads(i)%target == load_by_temperature) then
                  first = mesh%node_start(elements(k))
                  last = mesh%node_start(elements(k) + 1) - 1
                  inside(first:last) = inside(first:last) &
                     + at_nodes(mesh%node(first:last))*material%largest_expansion()
               else if (has_bubbles) then
                  call new_element_geometry(geometry, mesh, elements(k), material)
                  last = size(mesh%node) + n_dim*elements(k)
                  first = last - n_dim + 1
                  if (geometry%n_functions > geometry%n_nodes) inside(first:last) = inside(first:last) &
                     + matmul(geometry%projection%compliance, force_on_bubble(loads(i), material, geometry, n_dim))
               end if
            end associate
         end do
      end do
   end subroutine sum_element_loads

   !> Temperatures of a load at the nodes of its elements, from its table if it has one. A node of refinement that is
   !> not in the table gets the weighted mean of its parents.
   subroutine find_temperatures(temperature, mesh, load, elements, error)
      real(dp), allocatable, intent(out) :: temperature(:) !! temperature of each node (n_nodes) [K]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(load_t), intent(in) :: load !! the load
      integer, intent(in) :: elements(:) !! the elements
      type(error_t), allocatable, intent(out) :: error !! the table lacks a node, or gives one twice
      type(tag_map_t) :: map
      integer, allocatable :: tags(:)
      logical :: is_met(mesh%n_nodes)
      integer :: i, node, row, tag

      temperature = load%temperature + matmul(load%temperature_slope(:size(mesh%coordinates, 1)), mesh%coordinates)
      if (.not. allocated(load%temperature_table)) return
      tags = nint(load%temperature_table(1, :))
      call new_tag_map(map, tags)
      row = map%repeated()
      if (row > 0) call new_error(error, input_refused, load%temperature_file//': node '//to_text(tags(row))// &
         ' is given a second time')
      if (allocated(error)) return
      is_met = .false.
      do i = 1, size(elements)
         is_met(mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i) + 1) - 1)) = .true.
      end do
      do node = 1, mesh%n_nodes
         if (.not. is_met(node)) cycle
         ! The table knows a node by its number in the mesh's file, which a node of refinement has not.
         tag = node
         if (allocated(mesh%node_tag)) then
            tag = 0
            if (node <= size(mesh%node_tag)) tag = mesh%node_tag(node)
         end if
         row = map%find(tag)
         if (row > 0) then
            temperature(node) = load%temperature_table(2, row)
         else if (mesh%is_of_refinement(node)) then
            associate (first => mesh%parents%start(node), last => mesh%parents%start(node + 1) - 1)
               temperature(node) = dot_product(mesh%parents%weight(first:last), &
                  temperature(mesh%parents%node(first:last)))
            end associate
         else
            call new_error(error, input_refused, load%temperature_file//': no temperature of node '//to_text(tag))
            return
         end if
      end do
   end subroutine find_temperatures

end module amontons_loads
