!> The contact zone: the contact points with their normals, gaps, weights and friction.
module amontons_contact_zone
   use amontons_boundary, only: boundary_line_t, new_boundary_line
   use amontons_constraints, only: constraints_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: contact_t, contact_zone_t, new_contact_zone, set_obstacles

   !> A boundary set that may touch a rigid plane.
   type :: contact_t
      character(:), allocatable :: set !! name of the boundary set
      real(dp) :: friction = 0.0_dp !! Coulomb coefficient, at least 0 [-]
      real(dp) :: point(2) = 0.0_dp !! a point of the plane [L]
      real(dp) :: normal(2) = [0.0_dp, 1.0_dp] !! normal of the plane, towards the body; any length [-]
      character(:), allocatable :: origin !! where the contact was specified, for messages: 'deck.nml:12: '
   end type contact_t

   !> The contact points of all contact sets, each set in the order of its line, body on the left.
   type :: contact_zone_t
      integer :: n_points = 0 !! number m of contact points
      integer, allocatable :: node(:) !! node of each point (m)
      integer, allocatable :: set(:) !! which contact set the point belongs to (m)
      integer, allocatable :: next(:) !! the point that follows along the line, 0 for none (m)
      real(dp), allocatable :: normal(:, :) !! unit outward normal n; the tangent is t = (-n_y, n_x) (2, m)
      real(dp), allocatable :: weight(:) !! tributary length (m) [L]
      real(dp), allocatable :: area(:) !! tributary area: length times depth of the body (m) [L^2]
      real(dp), allocatable :: gap(:) !! initial distance d to the obstacle along the normal (m) [L]
      real(dp), allocatable :: friction(:) !! Coulomb coefficient (m) [-]
      logical, allocatable :: is_guided(:) !! whether a support leaves it one direction and bears the shear (m)
      integer, allocatable :: held_node(:) !! contact nodes that are no points since supports hold them
   end type contact_zone_t

contains

   !> Collects the contact points. A node that supports hold completely, or along the contact normal, is no point.
   subroutine new_contact_zone(zone, mesh, materials, contacts, constraints, error)
      type(contact_zone_t), intent(out) :: zone !! the points; obstacles are set by `set_obstacles`
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(constraints_t), intent(in) :: constraints !! the supports
      type(error_t), allocatable, intent(out) :: error !! a missing set, a node in two sets, or no point at all
      type(boundary_line_t), allocatable :: lines(:)
      integer :: place(mesh%n_nodes), i, k, n

      allocate (lines(size(contacts)))
      place = 0
      do i = 1, size(contacts)
         call new_boundary_line(lines(i), mesh, contacts(i)%set, error, materials)
         if (allocated(error)) then
            error%message = contacts(i)%origin//error%message
            return
         end if
         do k = 1, lines(i)%n_nodes
            if (place(lines(i)%node(k)) /= 0) then
               call new_error(error, input_refused, contacts(i)%origin//'the node at '// &
                  position_text(mesh, lines(i)%node(k))//' belongs to two contact sets')
               return
            end if
            place(lines(i)%node(k)) = 1
         end do
      end do
      n = sum(lines%n_nodes)
      allocate (zone%node(n), zone%set(n), zone%next(n), zone%normal(2, n), zone%weight(n), zone%area(n), &
         zone%is_guided(n), zone%held_node(0))
      do i = 1, size(contacts)
         call add_line(zone, i, lines(i), constraints)
      end do
      call trim_zone(zone)
      if (size(contacts) > 0 .and. zone%n_points == 0) call new_error(error, input_refused, contacts(1)%origin// &
         'supports hold every contact node; nothing is left that could come into contact')
   end subroutine new_contact_zone

   !> Coordinates of a node as text.
   pure function position_text(mesh, node) result(text)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: node !! the node
      character(:), allocatable :: text

      text = to_text(mesh%coordinates(1, node))//', '//to_text(mesh%coordinates(2, node))
   end function position_text

   !> Adds the points of one line.
   pure subroutine add_line(zone, set, line, constraints)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set
      type(boundary_line_t), intent(in) :: line !! its line
      type(constraints_t), intent(in) :: constraints !! the supports
      integer :: point_of(line%n_nodes), k, p

      point_of = 0
      do k = 1, line%n_nodes
         if (is_held_normally(constraints, line%node(k), line%normal(:, k))) then
            zone%held_node = [zone%held_node, line%node(k)]
            cycle
         end if
         p = zone%n_points + 1
         zone%n_points = p
         point_of(k) = p
         zone%node(p) = line%node(k)
         zone%set(p) = set
         zone%normal(:, p) = line%normal(:, k)
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
      zone%weight = zone%weight(:n)
      zone%area = zone%area(:n)
      zone%is_guided = zone%is_guided(:n)
   end subroutine trim_zone

   !> Sets gap and friction of every point from the obstacle of its contact set.
   !>
   !> The gap to a plane through P with the unit normal a is d = (x - P) . a / (-n . a), measured along the body's
   !> normal n; it is negative where the body overlaps the plane (interference).
   pure subroutine set_obstacles(zone, mesh, contacts, error)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, in the order of `new_contact_zone`
      type(error_t), allocatable, intent(out) :: error !! the boundary does not face the plane somewhere
      real(dp), parameter :: grazing = 1.0e-3_dp
      real(dp), allocatable :: gap(:), friction(:)
      real(dp) :: plane(2), facing
      integer :: p

      allocate (gap(zone%n_points), friction(zone%n_points))
      do p = 1, zone%n_points
         associate (contact => contacts(zone%set(p)))
            plane = contact%normal/norm2(contact%normal)
            facing = -dot_product(zone%normal(:, p), plane)
            if (facing < grazing) then
               call new_error(error, input_refused, contact%origin//'the boundary does not face the plane at '// &
                  position_text(mesh, zone%node(p))//'; the normal of the plane must point to the body')
               return
            end if
            gap(p) = dot_product(mesh%coordinates(:, zone%node(p)) - contact%point, plane)/facing
            friction(p) = contact%friction
         end associate
      end do
      zone%gap = gap
      zone%friction = friction
   end subroutine set_obstacles

end module amontons_contact_zone
