!> The contact zone: the contact points with their normals, gaps, weights and friction.
module amontons_contact_zone
   use amontons_boundary, only: boundary_line_t, new_boundary_line
   use amontons_constraints, only: constraints_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_line_field, only: line_field_t
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_obstacle, only: obstacle_names, obstacle_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: contact_t, contact_zone_t, new_contact, new_contact_zone, set_obstacles

   !> A boundary set that may touch a rigid obstacle, and the friction there: |lambda_T| <= g + phi lambda_N.
   type :: contact_t
      character(:), allocatable :: set !! name of the boundary set
      type(obstacle_t) :: obstacle !! the obstacle
      real(dp) :: direction(2) = 0.0_dp !! along which gaps count, towards the obstacle; 0, 0 for the body's normal [-]
      real(dp) :: extra_gap = 0.0_dp !! added to every gap; negative for an interference [L]
      type(line_field_t) :: friction !! Coulomb's coefficient phi, at least 0 [-]
      type(line_field_t) :: slip_bound !! given (Tresca) bound g of the shear stress, at least 0 [F/L^2]
      character(:), allocatable :: origin !! where the contact was specified, for messages: 'deck.nml:12: '
   end type contact_t

   !> The contact points of all contact sets, each set in the order of its line, body on the left.
   type :: contact_zone_t
      integer :: n_points = 0 !! number m of contact points
      integer, allocatable :: node(:) !! node of each point (m)
      integer, allocatable :: set(:) !! which contact set the point belongs to (m)
      integer, allocatable :: next(:) !! the point that follows along the line, 0 for none (m)
      real(dp), allocatable :: normal(:, :) !! unit normal n towards the obstacle; the tangent is t = (-n_y, n_x) (2, m)
      real(dp), allocatable :: station(:) !! length along the line from its first node (m) [L]
      real(dp), allocatable :: weight(:) !! tributary length (m) [L]
      real(dp), allocatable :: area(:) !! tributary area: length times depth of the body (m) [L^2]
      real(dp), allocatable :: gap(:) !! initial distance d to the obstacle along the normal (m) [L]
      real(dp), allocatable :: friction(:) !! Coulomb coefficient phi (m) [-]
      real(dp), allocatable :: slip_bound(:) !! given bound g of the tangential force (m) [F]
      logical, allocatable :: is_guided(:) !! whether a support leaves it one direction and bears the shear (m)
      integer, allocatable :: held_node(:) !! contact nodes that are no points since supports hold them
      integer, allocatable :: shared_node(:) !! corners of two contact sets: they belong to the set named first
      integer, allocatable :: bare_node(:) !! contact nodes that are no points since they have no area
   end type contact_zone_t

contains

   !> Makes a contact set on the floor y = 0.
   pure subroutine new_contact(contact, set, friction)
      type(contact_t), intent(out) :: contact !! the contact set
      character(*), intent(in) :: set !! name of the boundary set
      real(dp), intent(in) :: friction !! Coulomb's coefficient phi, at least 0 [-]

      contact%set = set
      contact%obstacle%kind = trim(obstacle_names(1))
      contact%friction%value = friction
      contact%origin = ''
   end subroutine new_contact

   !> Collects the contact points. A node that supports hold completely, or along the contact normal, is no point; nor
   !> is a corner of a quadratic side on the axis of revolution: its area is 0, so that no pressure acts on it. A corner
   !> of two contact sets belongs to the first of them.
   subroutine new_contact_zone(zone, mesh, materials, contacts, constraints, error)
      type(contact_zone_t), intent(out) :: zone !! the points; obstacles are set by `set_obstacles`
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(constraints_t), intent(in) :: constraints !! the supports
      type(error_t), allocatable, intent(out) :: error !! a missing set, or no point at all
      type(boundary_line_t), allocatable :: lines(:)
      logical :: is_taken(mesh%n_nodes)
      integer :: i, n

      allocate (lines(size(contacts)))
      do i = 1, size(contacts)
         call new_boundary_line(lines(i), mesh, contacts(i)%set, error, materials)
         if (.not. allocated(error)) cycle
         error%message = contacts(i)%origin//error%message
         return
      end do
      n = sum(lines%n_nodes)
      allocate (zone%node(n), zone%set(n), zone%next(n), zone%normal(2, n), zone%weight(n), zone%area(n), &
         zone%is_guided(n), zone%station(n), zone%held_node(0), zone%shared_node(0), zone%bare_node(0))
      is_taken = .false.
      do i = 1, size(contacts)
         if (all(is_taken(lines(i)%node))) then
            call new_error(error, input_refused, contacts(i)%origin// &
               'every node of this contact set belongs to an earlier one')
            return
         end if
         call add_line(zone, i, contacts(i)%direction, lines(i), mesh, constraints, is_taken)
         is_taken(lines(i)%node) = .true.
      end do
      call trim_zone(zone)
      if (size(contacts) == 0 .or. zone%n_points > 0) return
      if (size(zone%bare_node) > 0) then
         call new_error(error, input_refused, contacts(1)%origin//'the contact set lies on the axis of revolution, '// &
            'where no pressure can act')
      else
         call new_error(error, input_refused, contacts(1)%origin// &
            'supports hold every contact node; nothing is left that could come into contact')
      end if
   end subroutine new_contact_zone

   !> Coordinates of a node as text.
   pure function position_text(mesh, node) result(text)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: node !! the node
      character(:), allocatable :: text

      text = to_text(mesh%coordinates(1, node))//', '//to_text(mesh%coordinates(2, node))
   end function position_text

   !> Adds the points of one line.
   pure subroutine add_line(zone, set, direction, line, mesh, constraints, is_taken)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set
      real(dp), intent(in) :: direction(2) !! along which its gaps count; 0, 0 for the body's normal [-]
      type(boundary_line_t), intent(in) :: line !! its line
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      logical, intent(in) :: is_taken(:) !! whether a node belongs to an earlier contact set (nodes)
      ! What rounding leaves of an area of 0, over the largest one.
      real(dp), parameter :: negligible = 1.0e-12_dp
      real(dp) :: station, normal(2)
      integer :: point_of(line%n_nodes), k, p

      point_of = 0
      station = 0.0_dp
      do k = 1, line%n_nodes
         if (k > 1) station = station &
            + norm2(mesh%coordinates(:, line%node(k)) - mesh%coordinates(:, line%node(k - 1)))
         if (is_taken(line%node(k))) then
            zone%shared_node = [zone%shared_node, line%node(k)]
            cycle
         end if
         normal = line%normal(:, k)
         if (any(abs(direction) > 0.0_dp)) normal = direction/norm2(direction)
         if (is_held_normally(constraints, line%node(k), normal)) then
            zone%held_node = [zone%held_node, line%node(k)]
            cycle
         end if
         if (abs(line%area(k)) <= negligible*maxval(line%area)) then
            zone%bare_node = [zone%bare_node, line%node(k)]
            cycle
         end if
         p = zone%n_points + 1
         zone%n_points = p
         point_of(k) = p
         zone%node(p) = line%node(k)
         zone%set(p) = set
         zone%normal(:, p) = normal
         zone%station(p) = station
         zone%weight(p) = line%weight(k)
         zone%area(p) = line%area(k)
         zone%is_guided(p) = .not. all(constraints%is_free(:, line%node(k)))
      end do
      do k = 1, line%n_nodes
         if (point_of(k) == 0) cycle
         zone%next(point_of(k)) = 0
         if (line%next(k) > 0) zone%next(point_of(k)) = point_of(line%next(k))
      end do
   end subroutine add_line

   !> Whether supports leave a node no motion along a normal.
   pure logical function is_held_normally(constraints, node, normal)
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: normal(2) !! the normal [-]
      real(dp), parameter :: square = 1.0e-6_dp
      real(dp) :: along(2)

      along = abs(matmul(normal, constraints%frame(node)))
      is_held_normally = .not. any(constraints%is_free(:, node) .and. along > square)
   end function is_held_normally

   !> Cuts the arrays to the number of points.
   pure subroutine trim_zone(zone)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer :: n

      n = zone%n_points
      zone%node = zone%node(:n)
      zone%set = zone%set(:n)
      zone%next = zone%next(:n)
      zone%normal = zone%normal(:, :n)
      zone%station = zone%station(:n)
      zone%weight = zone%weight(:n)
      zone%area = zone%area(:n)
      zone%is_guided = zone%is_guided(:n)
   end subroutine trim_zone

   !> Sets gap, friction and slip bound of every point from its contact set.
   !>
   !> The gap is the distance to the obstacle along the point's normal; it is negative where the body overlaps the
   !> obstacle (interference). A point whose normal never meets the obstacle gets a gap that nothing closes.
   pure subroutine set_obstacles(zone, mesh, contacts, error)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, in the order of `new_contact_zone`
      type(error_t), allocatable, intent(out) :: error !! a boundary that faces away, or a negative friction
      real(dp), parameter :: out_of_reach = 1.0e3_dp
      real(dp) :: size_of_body
      logical :: is_met(zone%n_points)
      integer :: p, i

      size_of_body = norm2(maxval(mesh%coordinates, dim=2) - minval(mesh%coordinates, dim=2))
      zone%gap = spread(0.0_dp, 1, zone%n_points)
      zone%friction = zone%gap
      zone%slip_bound = zone%gap
      do p = 1, zone%n_points
         associate (contact => contacts(zone%set(p)), position => mesh%coordinates(:, zone%node(p)))
            call contact%obstacle%measure(position, zone%normal(:, p), zone%gap(p), is_met(p))
            zone%gap(p) = zone%gap(p) + contact%extra_gap
            if (.not. is_met(p)) zone%gap(p) = out_of_reach*size_of_body
            zone%friction(p) = contact%friction%at(position, zone%station(p))
            zone%slip_bound(p) = contact%slip_bound%at(position, zone%station(p))*zone%area(p)
            if (min(zone%friction(p), zone%slip_bound(p)) < 0.0_dp) then
               call new_error(error, input_refused, contact%origin//'friction or slip bound is negative at '// &
                  position_text(mesh, zone%node(p)))
               return
            end if
         end associate
      end do
      do i = 1, size(contacts)
         if (any(is_met .and. zone%set == i) .or. all(zone%set /= i)) cycle
         call new_error(error, input_refused, contacts(i)%origin//'the boundary does not face its obstacle; '// &
            'the normal of the obstacle must point to the body')
         return
      end do
   end subroutine set_obstacles

end module amontons_contact_zone
