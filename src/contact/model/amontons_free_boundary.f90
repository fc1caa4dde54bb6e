!> The free boundary beyond the ends of contact sets. No contact force acts on its nodes, which may move into the
!> obstacle of the set or into the other body of a pair. And corners of rigid obstacles between contact points: a tooth,
!> a spike or a narrow circle may penetrate a side whose nodes do not touch it.
!>
!> From each end of a set the boundary is followed, past corners, up to the next contact set or tie. Distances are
!> measured as at contact points: along the normals of the boundary, for small displacements. A corner is measured along
!> the normals of both its sides.
module amontons_free_boundary
   use amontons_constraints, only: constraints_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_element, only: n_corners, side_shapes
   use amontons_error, only: error_t
   use amontons_friction_law, only: open_point
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t, side_element, side_place
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_obstacle, only: cross_product, steepest_cosine, unit_vector
   use amontons_surface, only: join_sides, meet_master, meet_side, meeting_t, meshed_body_t, sides_near, &
      surface_place_t, surface_t
   implicit none (type, external)
   private

   public :: corner_penetration, corner_penetration_t, free_boundary_t, new_free_boundary

   !> Rounding error of a distance of 0, over the coordinates [-].
   real(dp), parameter :: noise = 1.0e-14_dp

   !> A node of the free boundary, with a direction in which it may meet an obstacle or another body.
   type :: free_node_t
      integer :: node = 0 !! number of the node
      integer :: set = 0 !! the contact set whose obstacle or pair it may meet
      real(dp) :: normal(2) = 0.0_dp !! unit outward normal of the body, or the set's given direction [-]
      integer :: facing(3) = 0
         !! first corner, second corner, middle or 0 of the side of the other body that it faces; 0 with an obstacle
      real(dp) :: share(3) = 0.0_dp !! shape functions of these nodes at the place that it faces [-]
      real(dp) :: distance = 0.0_dp !! distance to this place along the normal; 0 with an obstacle [L]
      real(dp) :: arc_length = 0.0_dp !! length along the line of the set up to where this is nearest [L]
   end type free_node_t

   !> An end of a contact set beyond which the boundary of the body continues without a corner; or a node of a slave
   !> beyond which the distance of its master is larger than `search`.
   type :: set_end_t
      integer :: set = 0 !! number of the contact set
      logical :: is_of_master = .false. !! whether it is the set of the other body of the pair that ends
      logical :: is_of_search = .false. !! whether the other body is too far away there, and the set goes on
      integer :: point = 0 !! the contact point next to the end
      integer :: beyond = 0 !! the first node beyond it, its place in `free_boundary_t`
      real(dp) :: position(2) = 0.0_dp !! position of the end [L]
   end type set_end_t

   !> The free boundary beyond the ends of all contact sets of a body.
   type :: free_boundary_t
      type(free_node_t), allocatable :: nodes(:) !! its nodes, a corner twice
      type(set_end_t), allocatable :: ends(:) !! the ends of sets beyond which the boundary continues
   contains
      procedure :: lies_outside => free_boundary_lies_outside
      procedure :: penetration => free_boundary_penetration
      procedure :: reached_ends => free_boundary_reached_ends
   end type free_boundary_t

   !> The depth to which a corner of an obstacle penetrates a contact set.
   type :: corner_penetration_t
      real(dp) :: depth = 0.0_dp !! the depth; 0 if no corner penetrates by more than a negligible one [L]
      real(dp) :: place(2) = 0.0_dp !! where the side is penetrated [L]
      integer :: set = 0 !! number of the contact set, 0 for none
   end type corner_penetration_t

   !> The sides of the boundary of a mesh, and which of them a contact set or tie has.
   type :: outline_t
      integer, allocatable :: side(:, :)
         !! first corner, second corner, middle or 0, element of each side; body on the left (4, sides)
      integer, allocatable :: from(:) !! the side that begins at each node, 0 for none or several (nodes)
      integer, allocatable :: to(:) !! the side that ends there, 0 for none or several (nodes)
      logical, allocatable :: is_taken(:) !! whether a side belongs to a contact set or tie (sides)
      logical, allocatable :: is_taken_node(:) !! whether a node belongs to one (nodes)
   end type outline_t

   !> A boundary set with the free boundary beyond its ends.
   type :: extended_set_t
      integer :: number = 0 !! number of the contact set
      logical :: is_of_master = .false. !! whether it is the set of the other body of the pair
      type(surface_t) :: surface !! the sides of the set, and those beyond its ends
      integer :: n_own = 0 !! number of the former
      integer, allocatable :: end_side(:) !! the sides of the set at its ends (ends)
      integer, allocatable :: beyond(:) !! the sides that follow beyond them (ends)
   end type extended_set_t

contains

   !> Follows the boundary beyond the ends of all contact sets.
   subroutine new_free_boundary(boundary, body, contacts, zone, ties)
      type(free_boundary_t), intent(out) :: boundary !! the free boundary
      class(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(contact_zone_t), intent(in) :: zone !! their points
      type(mortar_pair_t), intent(in) :: ties(:) !! the surfaces that are bonded
      type(outline_t) :: outline
      type(extended_set_t) :: set, master
      real(dp) :: least
      integer :: i, p, n

      allocate (boundary%nodes(0), boundary%ends(0))
      if (size(contacts) == 0) return
      ! List the sides of the boundary.
      allocate (outline%side(4, size(body%outer)))
      allocate (outline%from(body%mesh%n_nodes), outline%to(body%mesh%n_nodes), source=0)
      do n = 1, size(body%outer)
         outline%side(:3, n) = body%mesh%side(side_element(body%outer(n)), side_place(body%outer(n)))
         outline%side(4, n) = side_element(body%outer(n))
         ! Where parts of a body meet in a single node the boundary branches.
         outline%from(outline%side(1, n)) = merge(n, -1, outline%from(outline%side(1, n)) == 0)
         outline%to(outline%side(2, n)) = merge(n, -1, outline%to(outline%side(2, n)) == 0)
      end do
      outline%from = max(0, outline%from)
      outline%to = max(0, outline%to)
      allocate (outline%is_taken(size(body%outer)), outline%is_taken_node(body%mesh%n_nodes), source=.false.)
      do i = 1, size(contacts)
         call mark_set(outline, body%mesh, contacts(i)%set)
         if (contacts(i)%pairing%is_pair()) call mark_set(outline, body%mesh, contacts(i)%pairing%against)
      end do
      do i = 1, size(ties)
         call mark_set(outline, body%mesh, ties(i)%set)
         call mark_set(outline, body%mesh, ties(i)%against)
      end do
      do i = 1, size(contacts)
         call extend_set(set, contacts(i)%set, i, .false., outline, body)
         if (.not. contacts(i)%pairing%is_pair()) then
            call add_beyond(boundary, set, contacts(i)%direction, outline, body%constraints)
            call add_ends(boundary, set, zone)
            cycle
         end if
         ! Those beyond the ends of both sets, and those of the slave that face the boundary beyond the master's ends,
         ! or the master from farther away than contact is looked for.
         call extend_set(master, contacts(i)%pairing%against, i, .true., outline, body)
         ! Polygons that approximate curves overlap before any load, and these nodes may, too.
         least = 0.0_dp
         if (contacts(i)%pairing%has_mesh_gap()) then
            do p = 1, zone%n_points
               associate (range => zone%quadrature%start(p:p + 1) - [0, 1])
                  if (zone%set(p) == i) least = min(least, minval(zone%quadrature%gap(range(1):range(2))))
               end associate
            end do
         end if
         call add_facing(boundary, set, 1, master, outline, body, zone, least)
         call add_ends(boundary, set, zone)
         call add_ends(boundary, master, zone)
         call add_facing(boundary, master, master%n_own + 1, set, outline, body, zone, least)
      end do
      ! Only tables of gaps need lengths along the line.
      do i = 1, size(boundary%nodes)
         associate (node => boundary%nodes(i))
            if (.not. allocated(contacts(node%set)%extra_gap%table)) cycle
            p = nearest_point(zone, node%set, body%mesh%coordinates(:, node%node))
            if (p > 0) node%arc_length = zone%quadrature%arc_length(zone%quadrature%start(p))
         end associate
      end do
   end subroutine new_free_boundary

   !> The contact point of a set nearest to a position; 0 for a set without points.
   pure integer function nearest_point(zone, set, position)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: set !! number of the contact set
      real(dp), intent(in) :: position(2) !! the place [L]

      nearest_point = minloc((zone%position(1, :) - position(1))**2 + (zone%position(2, :) - position(2))**2, dim=1, &
         mask=zone%set == set)
   end function nearest_point

   !> Adds the nodes beyond the ends of a set that faces a rigid obstacle.
   pure subroutine add_beyond(boundary, extended, direction, outline, constraints)
      type(free_boundary_t), intent(inout) :: boundary !! the free boundary
      type(extended_set_t), intent(in) :: extended !! the set with the boundary beyond it
      real(dp), intent(in) :: direction(2) !! along which its gaps count; 0, 0 for the body's normal [-]
      type(outline_t), intent(in) :: outline !! the sides of the boundary
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, allocatable :: side(:), corner(:)
      real(dp) :: normal(2)
      integer :: i, n

      n = size(boundary%nodes)
      call find_free_places(boundary, extended, extended%n_own + 1, outline, constraints, side, corner)
      do i = 1, size(side)
         associate (outward => extended%surface%normal(:, corner(i), side(i)))
            normal = outward
            if (any(abs(direction) > 0.0_dp)) normal = unit_vector(direction)
            if (dot_product(normal, outward) < steepest_cosine) cycle
            n = n + 1
            boundary%nodes(n) = free_node_t(extended%surface%side(corner(i), side(i)), extended%number, normal)
         end associate
      end do
      boundary%nodes = boundary%nodes(:n)
   end subroutine add_beyond

   !> Marks the sides and nodes of the boundary set of a contact set or tie as taken.
   subroutine mark_set(outline, mesh, set)
      type(outline_t), intent(inout) :: outline !! the sides of the boundary
      type(mesh_t), intent(in) :: mesh !! the mesh
      character(*), intent(in) :: set !! name of the boundary set
      integer, allocatable :: sides(:, :)
      type(error_t), allocatable :: error
      integer :: i

      ! not raised: the contact zone has been made of these sets
      call mesh%set_sides(set, sides, error)
      do i = 1, size(sides, 2)
         outline%is_taken_node(pack(sides(:3, i), sides(:3, i) > 0)) = .true.
         associate (from => outline%from(sides(1, i)), to => outline%to(sides(2, i)))
            if (from > 0) outline%is_taken(from) = outline%is_taken(from) .or. outline%side(2, from) == sides(2, i)
            if (to > 0) outline%is_taken(to) = outline%is_taken(to) .or. outline%side(1, to) == sides(1, i)
         end associate
      end do
   end subroutine mark_set

   !> Extends a boundary set beyond its ends, along sides that belong to no contact set or tie.
   pure subroutine extend_set(extended, set, number, is_of_master, outline, body)
      type(extended_set_t), intent(out) :: extended !! the set with the boundary beyond it
      character(*), intent(in) :: set !! name of the boundary set
      integer, intent(in) :: number !! number of the contact set
      logical, intent(in) :: is_of_master !! whether it is the set of the other body of the pair
      type(outline_t), intent(in) :: outline !! the sides of the boundary
      class(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      integer, allocatable :: sides(:, :)
      type(error_t), allocatable :: error
      integer :: place(size(outline%side, 2)), side, first, i, k, n
      logical :: continues(body%mesh%n_nodes, 2)

      extended%number = number
      extended%is_of_master = is_of_master
      call body%mesh%set_sides(set, sides, error)
      extended%n_own = size(sides, 2)
      continues = .false.
      do k = 1, 2
         continues(sides(3 - k, :), k) = .true.
      end do
      allocate (extended%end_side(0), extended%beyond(0))
      place = 0
      n = extended%n_own
      do i = 1, extended%n_own
         do k = 1, 2
            if (continues(sides(k, i), k)) cycle
            first = next_side(outline, sides(:, i), k)
            side = first
            do while (side > 0)
               if (outline%is_taken(side) .or. place(side) > 0) exit
               n = n + 1
               place(side) = n
               side = next_side(outline, outline%side(:, side), k)
            end do
            if (first == 0) cycle
            if (place(first) == 0) cycle
            extended%end_side = [extended%end_side, i]
            extended%beyond = [extended%beyond, place(first)]
         end do
      end do
      sides = reshape([sides, spread([0, 0, 0, 0], 2, n - extended%n_own)], [4, n])
      do i = 1, size(place)
         if (place(i) > 0) sides(:, place(i)) = outline%side(:, i)
      end do
      call join_sides(extended%surface, body, sides)
   end subroutine extend_set

   !> The side of the boundary beyond an end of a side, 0 for none.
   pure integer function next_side(outline, side, k)
      type(outline_t), intent(in) :: outline !! the sides of the boundary
      integer, intent(in) :: side(:) !! the nodes of the side
      integer, intent(in) :: k !! its end, 1 or 2

      next_side = merge(outline%to(side(1)), outline%from(side(2)), k == 1)
   end function next_side

   !> Lists the positions of an extended set on which no contact force acts: nodes beyond the set that supports leave
   !> free along the normal, a corner once for each of its normals. Allocates entries for them among the nodes of the
   !> free boundary.
   pure subroutine find_free_places(boundary, extended, first, outline, constraints, side, corner)
      class(free_boundary_t), intent(inout) :: boundary !! the free boundary
      type(extended_set_t), intent(in) :: extended !! the set with the boundary beyond it
      integer, intent(in) :: first !! the first side to look at; nodes of the set itself count, too
      type(outline_t), intent(in) :: outline !! the sides of the boundary
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, allocatable, intent(out) :: side(:) !! the side of each place
      integer, allocatable, intent(out) :: corner(:) !! first corner, second corner or middle of it, 1 to 3
      ! Rounding error of the cosine of an angle of 0.
      real(dp), parameter :: same = 1.0_dp - 1.0e-12_dp
      real(dp) :: seen(2, size(outline%from))
      integer :: i, k, n

      associate (surface => extended%surface)
         allocate (side(3*surface%n_sides), corner(3*surface%n_sides))
         seen = 0.0_dp
         n = 0
         do i = first, surface%n_sides
            do k = 1, 3
               associate (node => surface%side(k, i), normal => surface%normal(:, k, i))
                  if (node == 0) cycle
                  if (i > extended%n_own .and. outline%is_taken_node(node)) cycle
                  if (dot_product(seen(:, node), normal) > same) cycle
                  seen(:, node) = normal
                  if (.not. constraints%leaves_free(node, normal) .and. constraints%rigid_of(node) == 0) cycle
                  n = n + 1
                  side(n) = i
                  corner(n) = k
               end associate
            end do
         end do
      end associate
      side = side(:n)
      corner = corner(:n)
      boundary%nodes = [boundary%nodes, [(free_node_t(), i=1, n)]]
   end subroutine find_free_places

   !> Adds the nodes of one body of a pair that face the other one, except for positions that belong to both sets and
   !> nodes of the slave beside a segment; and the ends of the slave's part that faces its master within `search`.
   pure subroutine add_facing(boundary, extended, first, other, outline, body, zone, least)
      type(free_boundary_t), intent(inout) :: boundary !! the free boundary
      type(extended_set_t), intent(in) :: extended !! the boundary of the one body
      integer, intent(in) :: first !! its first side to look at
      type(extended_set_t), intent(in) :: other !! the boundary of the other body
      type(outline_t), intent(in) :: outline !! the sides of the boundary
      class(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: least !! the least distance before any load; overlaps beyond it do not count [L]
      ! Displacements that the theory is for, over the body's size.
      real(dp), parameter :: small = 0.05_dp
      ! Rounding error of a distance of 0 in mesh files, over the longest side.
      real(dp), parameter :: rounding = 1.0e-6_dp
      real(dp), parameter :: xi(3) = [-1.0_dp, 1.0_dp, 0.0_dp]
      type(meeting_t) :: meeting
      type(surface_place_t) :: foot
      integer, allocatable :: side(:), corner(:), near(:)
      logical :: is_near(body%mesh%n_nodes)
      real(dp) :: reach
      integer :: i, k, n, near_of, point

      is_near = .false.
      associate (pair => zone%pairs(extended%number), x => body%mesh%coordinates)
         do i = 1, size(pair%segments)
            associate (range => pair%segments(i)%range, nodes => pair%slave%side(:, pair%segments(i)%slave))
               is_near(pack(nodes(:3), nodes(:3) > 0 .and. range(1) <= xi + rounding .and. range(2) >= xi - rounding)) &
                  = .true.
            end associate
         end do
         reach = max(pair%search, small*maxval(maxval(x, dim=2) - minval(x, dim=2)))
      end associate
      near_of = 0
      n = size(boundary%nodes)
      call find_free_places(boundary, extended, first, outline, body%constraints, side, corner)
      do i = 1, size(side)
         associate (node => extended%surface%side(corner(i), side(i)))
            if (side(i) /= near_of) near = sides_near(extended%surface, side(i), other%surface, reach)
            near_of = side(i)
            meeting = meet_master(other%surface, near, extended%surface%place(side(i), xi(corner(i))), reach)
            if (meeting%side == 0 .or. (side(i) <= extended%n_own .and. meeting%side <= other%n_own &
               .and. is_near(node))) cycle
            ! A boundary behind the node is the far side of the other body.
            if (meeting%gap < 2.0_dp*least - rounding*min(extended%surface%longest, other%surface%longest)) cycle
            foot = other%surface%place(meeting%side, meeting%xi)
            ! The corner at which the other set ends belongs to it, on whichever of its two sides rounding puts it.
            k = maxloc(foot%values, dim=1)
            if (side(i) <= extended%n_own .and. meeting%side > other%n_own .and. foot%values(k) > 1.0_dp - rounding &
               .and. outline%is_taken_node(other%surface%side(k, meeting%side))) cycle
            n = n + 1
            boundary%nodes(n) = free_node_t(node, extended%number, extended%surface%normal(:, corner(i), side(i)), &
               other%surface%side(:3, meeting%side), foot%values, max(least, meeting%gap))
         end associate
      end do
      boundary%nodes = boundary%nodes(:n)
      do i = 1, extended%n_own
         do k = 1, 2
            associate (nodes => extended%surface%side(:, i), position => extended%surface%corner(:, k, i))
               if (.not. is_near(nodes(k)) .or. is_near(nodes(3 - k))) cycle
               n = findloc(boundary%nodes%node == nodes(3 - k) .and. boundary%nodes%set == extended%number, .true., 1)
               point = nearest_point(zone, extended%number, position)
               if (n == 0 .or. point == 0) cycle
               if (any(other%surface%side(1, :other%n_own) == boundary%nodes(n)%facing(1))) boundary%ends = &
                  [boundary%ends, set_end_t(extended%number, .false., .true., point, n, position)]
            end associate
         end do
      end do
   end subroutine add_facing

   !> Adds the ends of a set beyond which the boundary continues without a corner, and where no support holds it.
   pure subroutine add_ends(boundary, extended, zone)
      type(free_boundary_t), intent(inout) :: boundary !! the free boundary, with the nodes beyond the ends
      type(extended_set_t), intent(in) :: extended !! the set, with the boundary beyond it
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(set_end_t) :: added
      integer :: nodes(3), first, i, k, p
      real(dp) :: normal(2)

      do i = 1, size(extended%beyond)
         associate (surface => extended%surface, last => extended%end_side(i), next => extended%beyond(i))
            k = merge(1, 2, surface%side(1, last) == surface%side(2, next))
            normal = surface%normal(:, k, last)
            if (any(abs(surface%normal(:, 3 - k, next) - normal) > 0.0_dp)) cycle
            added = set_end_t(extended%number, extended%is_of_master, position=surface%corner(:, k, last))
            nodes = surface%side(:3, next)
         end associate
         if (extended%is_of_master) then
            added%beyond = nearest_facing(boundary%nodes, extended, added%position, &
               zone%pairs(extended%number)%slave%longest)
         else
            first = merge(nodes(3), nodes(k), nodes(3) > 0)
            ! A corner of the body is there for each of its normals.
            added%beyond = maxloc([(dot_product(boundary%nodes(p)%normal, normal), p=1, size(boundary%nodes))], dim=1, &
               mask=boundary%nodes%set == extended%number .and. boundary%nodes%node == first)
         end if
         if (added%beyond == 0) cycle
         added%point = nearest_point(zone, extended%number, added%position)
         if (added%point > 0) boundary%ends = [boundary%ends, added]
      end do
   end subroutine add_ends

   !> The node of a slave that faces the boundary just beyond an end of the master; 0 if there is none within the length
   !> of a side.
   pure integer function nearest_facing(nodes, master, position, within) result(nearest)
      type(free_node_t), intent(in) :: nodes(:) !! the free nodes
      type(extended_set_t), intent(in) :: master !! the master with the boundary beyond it
      real(dp), intent(in) :: position(2) !! position of the master's end [L]
      real(dp), intent(in) :: within !! largest distance of the position that it faces [L]
      real(dp) :: distance, least
      integer :: i, side

      nearest = 0
      least = within
      associate (surface => master%surface)
         do i = 1, size(nodes)
            if (nodes(i)%set /= master%number) cycle
            side = findloc(surface%side(1, :) == nodes(i)%facing(1), .true., dim=1)
            if (side <= master%n_own) cycle
            distance = norm2(matmul(surface%corner(:, :, side), nodes(i)%share) - position)
            if (distance > least) cycle
            least = distance
            nearest = i
         end do
      end associate
   end function nearest_facing

   !> Finds the distance of a node to the obstacle or body that it faces, before any displacement.
   pure subroutine measure_node(node, contact, position, gap, is_met)
      type(free_node_t), intent(in) :: node !! the node
      type(contact_t), intent(in) :: contact !! its contact set, the obstacle where it is now
      real(dp), intent(in) :: position(2) !! position of the node [L]
      real(dp), intent(out) :: gap !! the distance, negative inside [L]
      logical, intent(out) :: is_met !! whether its normal meets the obstacle or the other body
      real(dp) :: cosine

      if (node%facing(1) > 0) then
         gap = node%distance
         if (.not. contact%pairing%has_mesh_gap()) gap = max(0.0_dp, gap)
         is_met = .true.
      else
         call contact%obstacle%measure(position, node%normal, gap, is_met, cosine)
      end if
      gap = gap + contact%extra_gap%at(position, node%arc_length)
   end subroutine measure_node

   !> Which nodes are not deeper in their obstacles than the points of their set initially: a deeper one is intended,
   !> for example where a plane replaces a short flank.
   pure function free_boundary_lies_outside(self, contacts, coordinates, zone, gap) result(lies_outside)
      class(free_boundary_t), intent(in) :: self !! the free boundary
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles at rest
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (2, n_nodes) [L]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: gap(:) !! their distances to the obstacle (m) [L]
      logical, allocatable :: lies_outside(:)
      ! Rounding error of a distance of 0 in mesh files, over the coordinates.
      real(dp), parameter :: rounding = 1.0e-6_dp
      real(dp) :: least(size(contacts)), distance
      integer :: i

      least = [(min(0.0_dp, minval(gap, mask=zone%set == i)), i=1, size(contacts))] &
         - rounding*maxval(maxval(coordinates, dim=2) - minval(coordinates, dim=2))
      allocate (lies_outside(size(self%nodes)))
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i))
            call measure_node(node, contacts(node%set), coordinates(:, node%node), distance, lies_outside(i))
            lies_outside(i) = lies_outside(i) .and. distance >= least(node%set)
         end associate
      end do
   end function free_boundary_lies_outside

   !> Depth to which the displacements move the deepest node of the free boundary into an obstacle or another body [L].
   pure subroutine free_boundary_penetration(self, contacts, lies_outside, coordinates, displacement, depth, deepest)
      class(free_boundary_t), intent(in) :: self !! the free boundary
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they are now
      logical, intent(in) :: lies_outside(:) !! which nodes count (n)
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (2, n_nodes) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(out) :: depth !! the depth, 0 if none penetrates [L]
      integer, intent(out) :: deepest !! this node, its place in `nodes`; 0 if none penetrates
      real(dp) :: way(2), overlap, gap
      logical :: is_met
      integer :: i, k

      depth = noise*maxval(abs(coordinates))
      deepest = 0
      do i = 1, size(self%nodes)
         if (.not. lies_outside(i)) cycle
         associate (node => self%nodes(i), contact => contacts(self%nodes(i)%set))
            way = displacement(:, node%node)
            do k = 1, 3
               if (node%facing(k) > 0) way = way - node%share(k)*displacement(:, node%facing(k))
            end do
            call measure_node(node, contact, coordinates(:, node%node), gap, is_met)
            overlap = dot_product(node%normal, way) - gap
            if (.not. (is_met .and. overlap > depth)) cycle
            ! Where the obstacle is no plane, a node that slides along it does not enter it; nor one that slides along
            ! the other body, as an overhanging flank does.
            if (node%facing(1) == 0) then
               call measure_node(node, contact, coordinates(:, node%node) + way, gap, is_met)
               overlap = merge(min(overlap, -gap), 0.0_dp, is_met)
            else
               associate (along => coordinates(:, node%facing(2)) - coordinates(:, node%facing(1)))
                  overlap = min(overlap, dot_product(gap*node%normal - way, unit_vector([along(2), -along(1)])))
               end associate
            end if
            if (.not. overlap > depth) cycle
            depth = overlap
            deepest = i
         end associate
      end do
      if (deepest == 0) depth = 0.0_dp
   end subroutine free_boundary_penetration

   !> The ends of sets that contact reaches: the point next to the end is closed, and the surface that it touches
   !> continues along the boundary as well.
   pure function free_boundary_reached_ends(self, contacts, coordinates, gap, status) result(reached)
      class(free_boundary_t), intent(in) :: self !! the free boundary
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they are now
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (2, n_nodes) [L]
      real(dp), intent(in) :: gap(:) !! distances of the contact points before any displacement (m) [L]
      integer, intent(in) :: status(:) !! statuses of the contact points (m)
      integer, allocatable :: reached(:)
      ! The tangent of 40 degrees: surfaces at a larger angle part at a corner.
      real(dp), parameter :: steep = 0.839_dp
      logical :: is_reached(size(self%ends)), is_met
      real(dp) :: distance
      integer :: i

      do i = 1, size(self%ends)
         associate (set_end => self%ends(i), node => self%nodes(self%ends(i)%beyond))
            is_reached(i) = status(set_end%point) /= open_point
            if (.not. is_reached(i)) cycle
            call measure_node(node, contacts(set_end%set), coordinates(:, node%node), distance, is_met)
            is_reached(i) = is_met .and. distance - gap(set_end%point) &
               < steep*norm2(coordinates(:, node%node) - set_end%position)
         end associate
      end do
      reached = pack([(i, i=1, size(is_reached))], is_reached)
   end function free_boundary_reached_ends

   !> The corner of a polyline, or the apex of a circle or parabola, that penetrates a contact set deepest.
   !>
   !> The depth is measured along the normal of the displaced side, like gaps. The depth to which a smooth surface or a
   !> single corner may reach into a side between two nodes is a discretization error and does not count up to
   !> limits, see `resolved_depth`. Corners that the motion takes into the body through a side of no set count as well.
   pure type(corner_penetration_t) function corner_penetration(body, contacts, zone, extra_gap, displacement, limits) &
      result(deepest)
      class(meshed_body_t), intent(in) :: body !! mesh and its boundary
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, the obstacles where they are now
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: extra_gap(:) !! additions of the deck to their gaps (m) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: limits(2) !! these limits, over the largest displacement [-]
      ! Over the largest displacement: a roughness of measured profiles that is smaller does not spoil the pressures.
      real(dp), parameter :: negligible = 1.0e-2_dp
      ! The corner itself may lie on the border of two elements.
      real(dp), parameter :: nearly = 0.99_dp
      integer, allocatable :: sides(:, :)
      real(dp), allocatable :: corners(:, :)
      type(error_t), allocatable :: error
      type(mesh_t) :: displaced
      real(dp), dimension(2, 3) :: side, moved
      real(dp) :: normal(2), xi(2), values(3), slopes(3), overlap, along, ends(2), largest, least
      integer :: i, k, j, l, node, p

      largest = maxval(abs(displacement))
      least = max(negligible*largest, noise*maxval(abs(body%mesh%coordinates)))
      do i = 1, size(contacts)
         corners = corners_of(contacts(i))
         if (size(corners) == 0 .or. all(zone%set /= i)) cycle
         call body%mesh%set_sides(contacts(i)%set, sides, error)
         if (allocated(error)) cycle
         displaced = body%mesh
         displaced%coordinates = displaced%coordinates + displacement
         do k = 1, size(sides, 2)
            normal = body%mesh%coordinates(:, sides(2, k)) - body%mesh%coordinates(:, sides(1, k))
            normal = unit_vector([normal(2), -normal(1)])
            ends = [(-cross_product(normal, body%mesh%coordinates(:, sides(j, k))), j=1, 2)]
            do j = 1, 3
               node = sides(j, k)
               if (node == 0) then
                  side(:, 3) = 0.5_dp*(side(:, 1) + side(:, 2))
                  moved(:, 3) = 0.5_dp*(moved(:, 1) + moved(:, 2))
               else
                  side(:, j) = body%mesh%coordinates(:, node)
                  p = nearest_point(zone, i, side(:, j))
                  moved(:, j) = side(:, j) + (dot_product(displacement(:, node), normal) - extra_gap(p))*normal
               end if
            end do
            do l = 1, size(corners, 2)
               along = -cross_product(normal, corners(:, l))
               if (along < minval(ends) .or. along > maxval(ends)) cycle
               xi = meet_side(moved, corners(:, l), normal)
               do j = 1, 2
                  if (abs(xi(j)) > 1.0_dp) cycle
                  call side_shapes(.true., xi(j), values, slopes)
                  overlap = dot_product(matmul(moved, values) - corners(:, l), normal)
                  if (.not. overlap > deepest%depth) cycle
                  if (.not. overlap - resolved_depth(contacts(i), side, moved, normal, xi(j), sides(3, k) > 0, &
                     limits*max(largest, least)) > least) cycle
                  ! A point beyond the far side of the body does not penetrate it.
                  associate (on_side => matmul(side, values))
                     if (.not. (is_inside(body%mesh, on_side - 0.5_dp*overlap*normal) .and. &
                        is_inside(body%mesh, on_side - nearly*overlap*normal))) cycle
                  end associate
                  deepest = corner_penetration_t(overlap, matmul(side, values), i)
               end do
            end do
         end do
         do l = 1, size(corners, 2)
            overlap = depth_behind(body, displaced, sides, corners(:, l))
            if (overlap > max(least, deepest%depth)) deepest = corner_penetration_t(overlap, corners(:, l), i)
         end do
      end do
   end function corner_penetration

   !> The depth of a place in the displaced body, outside of which it was, behind a side that is none of a contact set;
   !> 0 if one of the set is nearer, as where contact is resolved by its mesh [L].
   pure real(dp) function depth_behind(body, displaced, sides, place) result(depth)
      class(meshed_body_t), intent(in) :: body !! mesh and its boundary
      type(mesh_t), intent(in) :: displaced !! the same mesh, displaced
      integer, intent(in) :: sides(:, :) !! nodes of the sides of the contact set (4, any)
      real(dp), intent(in) :: place(2) !! the place [L]
      real(dp) :: way(2), before(2), distance
      logical :: is_own
      integer :: side(3), i

      depth = huge(depth)
      is_own = .true.
      do i = 1, size(body%outer)
         side = body%mesh%side(side_element(body%outer(i)), side_place(body%outer(i)))
         before = place - displaced%coordinates(:, side(1))
         way = displaced%coordinates(:, side(2)) - displaced%coordinates(:, side(1))
         distance = norm2(before - way*min(1.0_dp, max(0.0_dp, dot_product(before, way)/dot_product(way, way))))
         if (distance < depth) is_own = any(sides(1, :) == side(1) .and. sides(2, :) == side(2))
         depth = min(depth, distance)
      end do
      if (.not. is_own) is_own = is_inside(body%mesh, place) .or. .not. is_inside(displaced, place)
      if (is_own) depth = 0.0_dp
   end function depth_behind

   !> The convex corners of a rigid obstacle: ends of a polyline and points where its line turns to the right, away from
   !> the free side; the apex of a circle or parabola; none of a pair (2, corners) [L].
   pure function corners_of(contact) result(corners)
      type(contact_t), intent(in) :: contact !! the contact set
      real(dp), allocatable :: corners(:, :)
      logical, allocatable :: bulges(:)
      real(dp) :: axis(2)
      integer :: i

      associate (obstacle => contact%obstacle)
         axis = unit_vector(obstacle%normal)
         if (obstacle%kind == 'polyline') then
            associate (line => obstacle%line, n => size(obstacle%line, 2))
               allocate (bulges(n), source=.true.)
               do i = 2, n - 1
                  bulges(i) = cross_product(line(:, i) - line(:, i - 1), line(:, i + 1) - line(:, i)) < 0.0_dp
               end do
               allocate (corners(2, count(bulges)))
               corners(1, :) = obstacle%point(1) + pack(axis(2)*line(1, :) + axis(1)*line(2, :), bulges)
               corners(2, :) = obstacle%point(2) + pack(axis(2)*line(2, :) - axis(1)*line(1, :), bulges)
            end associate
         else if (obstacle%has_radius() .and. obstacle%radius > 0.0_dp) then
            corners = reshape(obstacle%point, [2, 1])
         else
            allocate (corners(2, 0))
         end if
      end associate
   end function corners_of

   !> Largest depth to which a surface may reach into a side between two nodes because of the mesh: half the distance of
   !> the nodes times the tangent of half the angle between the surface's directions opposite to them (the height of the
   !> triangle of its tangents, unless one is missing or steeper than warnings allow), plus the difference of their
   !> displacements, each up to its limit, plus the overlap of the nodes [L].
   pure real(dp) function resolved_depth(contact, side, moved, normal, xi, has_middle, limits) result(depth)
      type(contact_t), intent(in) :: contact !! the contact set
      real(dp), intent(in) :: side(2, 3) !! first corner, second corner, middle of the side [L]
      real(dp), intent(in) :: moved(2, 3) !! the same, displaced along the normal [L]
      real(dp), intent(in) :: normal(2) !! normal of the side [-]
      real(dp), intent(in) :: xi !! the place on it, from -1 to 1 [-]
      logical, intent(in) :: has_middle !! whether the side has a node in its middle
      real(dp), intent(in) :: limits(2) !! the limits [L]
      ! 30 degrees off the obstacle's normal, as warnings have it.
      real(dp), parameter :: smallest_cosine = 0.866_dp
      real(dp) :: gap, cosine, turn, angle
      logical :: is_met, is_steep
      integer :: beside(2), i

      beside = [1, 2]
      if (has_middle) beside(merge(2, 1, xi < 0.0_dp)) = 3
      depth = 0.0_dp
      angle = 0.0_dp
      is_steep = .false.
      do i = 1, 2
         call contact%obstacle%measure(side(:, beside(i)), normal, gap, is_met, cosine, turn)
         ! Where there is no surface opposite to a node, the cosine is that of a steeper one, or 0.
         is_steep = is_steep .or. cosine < smallest_cosine
         if (.not. is_met) cycle
         angle = angle + turn
         depth = max(depth, dot_product(moved(:, beside(i)) - side(:, beside(i)), normal) - gap)
      end do
      if (is_steep) angle = 0.0_dp
      ! At an edge of the obstacle one node is supported, and the other one moves down.
      associate (way => moved(:, beside) - side(:, beside))
         depth = depth + sum(min(limits, [0.5_dp*norm2(side(:, beside(2)) - side(:, beside(1)))*tan(0.5_dp*angle), &
            abs(dot_product(way(:, 2) - way(:, 1), normal))]))
      end associate
   end function resolved_depth

   !> Whether a point lies in an element of a mesh, its sides taken straight.
   pure logical function is_inside(mesh, point)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: point(2) !! the point [L]
      integer :: element, i, n

      is_inside = .true.
      do element = 1, mesh%n_elements
         n = n_corners(mesh%element_kind(element))
         associate (nodes => mesh%node(mesh%node_start(element):mesh%node_start(element) + n - 1))
            do i = 1, n
               associate (begin => mesh%coordinates(:, nodes(i)))
                  if (cross_product(mesh%coordinates(:, nodes(mod(i, n) + 1)) - begin, point - begin) < 0.0_dp) exit
               end associate
            end do
            if (i > n) return
         end associate
      end do
      is_inside = .false.
   end function is_inside

end module amontons_free_boundary
