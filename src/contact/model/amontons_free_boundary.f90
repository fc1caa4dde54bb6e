!> What the contact points miss: nodes of the free boundary beyond the ends of contact sets, on which no contact force
!> acts, and corners of rigid obstacles between contact points. Either may overlap in the displaced shape.
!>
!> From each end of a set the boundary is followed, past corners, up to the next contact set or tie. Distances are
!> measured as at contact points: along the normals of the boundary, for small displacements. A corner of the body is
!> measured along the normals of both its sides. In space every node of the boundary that belongs to no contact set is
!> looked at, along the mean normal of the faces around it.
module amontons_free_boundary
   use amontons_constraints, only: constraints_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_element, only: side_shapes
   use amontons_face, only: face_t, new_face
   use amontons_friction_law, only: open_point
   use amontons_kinds, only: dp
   use amontons_mesh, only: find_set, side_element, side_number, side_place
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_obstacle, only: cross_product, steepest_cosine, unit_vector
   use amontons_rounding, only: difference_rounding, input_rounding, sum_rounding
   use amontons_surface, only: join_sides, meet_master, meet_side, meeting_t, meshed_body_t, sides_near, &
      surface_place_t, surface_t
   implicit none (type, external)
   private

   public :: corner_overlap, free_boundary_t, new_free_boundary, overlap_t

   !> Local coordinates of first corner, second corner and middle of a side [-].
   real(dp), parameter :: places(3) = [-1.0_dp, 1.0_dp, 0.0_dp]

   !> A node of the free boundary, with a direction in which it may meet an obstacle or another body.
   type :: free_node_t
      integer :: node = 0 !! number of the node
      integer :: set = 0 !! the contact set whose obstacle or pair it may meet
      real(dp), allocatable :: normal(:) !! unit outward normal of the body, or the set's given direction (n_dim) [-]
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
      procedure :: overlap => free_boundary_overlap
      procedure :: reached_ends => free_boundary_reached_ends
   end type free_boundary_t

   !> The deepest overlap of some nodes or corners.
   type :: overlap_t
      real(dp) :: depth = 0.0_dp !! the depth; 0 if nothing overlaps by more than a negligible one [L]
      real(dp), allocatable :: place(:) !! where, in the shape at rest; not allocated where nothing overlaps (n_dim) [L]
      integer :: set = 0 !! number of the contact set, 0 for none
   end type overlap_t

   !> A side of a contact set that corners of the obstacle may penetrate.
   type :: displaced_side_t
      integer :: set = 0 !! number of the contact set
      real(dp) :: rest(2, 3) = 0.0_dp !! first corner, second corner, middle of the side [L]
      real(dp) :: moved(2, 3) = 0.0_dp !! the same, displaced along the normal [L]
      real(dp) :: normal(2) = 0.0_dp !! its unit normal [-]
      logical :: has_middle = .false. !! whether it has a node in its middle
   end type displaced_side_t

   !> The boundary of a body, what of it contact sets and ties have, and what of it one contact set.
   type :: outline_t
      integer, allocatable :: side(:, :) !! its sides, as of `mesh_set_sides` (size, sides)
      logical, allocatable :: is_taken(:) !! whether a side belongs to a contact set or tie (sides)
      logical, allocatable :: is_taken_node(:) !! whether a node does (0:nodes)
      real(dp), allocatable :: normal(:, :)
         !! in space: sum of the outward areas of the sides around each node that are not taken (3, nodes) [L^2]
      type(surface_t) :: surface !! in the plane, as what follows: all sides
      integer, allocatable :: beside(:, :)
         !! the side that ends where each side begins, and the one that begins where it ends; 0 for none or, where parts
         !! of a body meet in a single node, for several (2, sides)
      logical, allocatable :: is_own(:, :)
         !! which sides are of the contact set and, of a pair, of that of the other body (sides, 2)
      logical, allocatable :: is_beyond(:, :) !! which follow beyond their ends, and are not taken (sides, 2)
      logical, allocatable :: is_near(:) !! which nodes of a slave lie beside a segment (nodes)
      real(dp) :: least = 0.0_dp !! the least distance of the pair before any load; overlaps beyond it do not count [L]
      real(dp) :: reach = 0.0_dp !! how far nodes look for the other body [L]
   contains
      procedure :: choose => outline_choose
      procedure :: face => outline_face
   end type outline_t

contains

   !> Follows the boundary beyond the ends of all contact sets.
   subroutine new_free_boundary(boundary, body, contacts, zone, ties)
      type(free_boundary_t), intent(out) :: boundary !! the free boundary
      class(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(contact_zone_t), intent(in) :: zone !! their points
      type(mortar_pair_t), intent(in) :: ties(:) !! the surfaces that are bonded
      type(outline_t) :: outline
      integer :: i

      allocate (boundary%nodes(0), boundary%ends(0))
      if (size(contacts) == 0) return
      call new_outline(outline, body, contacts, ties)
      do i = 1, size(contacts)
         if (size(body%mesh%coordinates, 1) == 3) then
            call add_nodes_in_space(boundary, outline, i, contacts(i), body%constraints)
         else
            call outline%choose(i, contacts(i), body, zone)
            call add_nodes(boundary, outline, i, 1, contacts(i)%direction(:2), body%constraints, zone)
            call add_nodes(boundary, outline, i, 2, contacts(i)%direction(:2), body%constraints, zone)
         end if
      end do
   end subroutine new_free_boundary

   !> Adds the nodes of a solid's boundary that belong to no contact set or tie and that supports leave free along the
   !> normal, for a set on a rigid obstacle.
   pure subroutine add_nodes_in_space(boundary, outline, set, contact, constraints)
      type(free_boundary_t), intent(inout) :: boundary !! the free boundary
      type(outline_t), intent(in) :: outline !! the sides of the boundary
      integer, intent(in) :: set !! number of the contact set
      type(contact_t), intent(in) :: contact !! the contact set
      type(constraints_t), intent(in) :: constraints !! the supports
      type(free_node_t) :: found(size(outline%normal, 2))
      integer :: n, node

      if (contact%pairing%is_pair()) return
      n = 0
      do node = 1, size(found)
         if (outline%is_taken_node(node) .or. .not. any(abs(outline%normal(:, node)) > 0.0_dp)) cycle
         associate (outward => unit_vector(outline%normal(:, node)), is_given => any(abs(contact%direction) > 0.0_dp))
            if (.not. (constraints%leaves_free(node, outward) .or. constraints%rigid_of(node) > 0)) cycle
            n = n + 1
            found(n)%node = node
            found(n)%set = set
            found(n)%normal = outward
            if (is_given) found(n)%normal = unit_vector(contact%direction)
            if (dot_product(found(n)%normal, outward) < steepest_cosine) n = n - 1
         end associate
      end do
      boundary%nodes = [boundary%nodes, found(:n)]
   end subroutine add_nodes_in_space

   !> Lists the sides of the boundary, and which of them contact sets and ties have.
   pure subroutine new_outline(outline, body, contacts, ties)
      type(outline_t), intent(out) :: outline !! the sides
      class(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(mortar_pair_t), intent(in) :: ties(:) !! the surfaces that are bonded
      type(face_t) :: face
      integer, dimension(body%mesh%n_nodes) :: from, to
      integer :: i, k, n

      outline%side = boundary_sides(body)
      n = size(outline%side, 1) - 1
      outline%is_taken = spread(.false., 1, size(body%outer))
      do i = 1, size(contacts)
         outline%is_taken = outline%is_taken .or. is_of_set(body, contacts(i)%set)
         if (contacts(i)%pairing%is_pair()) outline%is_taken = outline%is_taken &
            .or. is_of_set(body, contacts(i)%pairing%against)
      end do
      do i = 1, size(ties)
         outline%is_taken = outline%is_taken .or. is_of_set(body, ties(i)%set) .or. is_of_set(body, ties(i)%against)
      end do
      allocate (outline%is_taken_node(0:body%mesh%n_nodes), source=.false.)
      do i = 1, size(body%outer)
         if (outline%is_taken(i)) outline%is_taken_node(outline%side(:n, i)) = .true.
      end do
      if (size(body%mesh%coordinates, 1) == 3) then
         allocate (outline%normal(3, body%mesh%n_nodes), source=0.0_dp)
         do i = 1, size(body%outer)
            if (outline%is_taken(i)) cycle
            call new_face(face, outline%side(:, i), body%mesh)
            do k = 1, face%n_nodes
               outline%normal(:, face%node(k)) = outline%normal(:, face%node(k)) + sum(face%outward, dim=2)
            end do
         end do
         return
      end if
      call join_sides(outline%surface, body, outline%side)
      from = 0
      to = 0
      associate (side => outline%side)
         do i = 1, size(side, 2)
            from(side(1, i)) = merge(i, -1, from(side(1, i)) == 0)
            to(side(2, i)) = merge(i, -1, to(side(2, i)) == 0)
         end do
         outline%beside = reshape([(max(0, to(side(1, i))), max(0, from(side(2, i))), i=1, size(side, 2))], &
            [2, size(side, 2)])
      end associate
   end subroutine new_outline

   !> Chooses a contact set: its sides and the boundary beyond its ends, and the same of the other body of a pair.
   pure subroutine outline_choose(self, set, contact, body, zone)
      class(outline_t), intent(inout) :: self !! the sides of the boundary
      integer, intent(in) :: set !! number of the contact set
      type(contact_t), intent(in) :: contact !! the contact set
      class(meshed_body_t), intent(in) :: body !! mesh and its boundary
      type(contact_zone_t), intent(in) :: zone !! the contact points
      ! Displacements that the theory is for, over the body's size.
      real(dp), parameter :: small = 0.05_dp
      integer :: i, k, p, side

      if (.not. allocated(self%is_own)) allocate (self%is_own(size(self%is_taken), 2), &
         self%is_beyond(size(self%is_taken), 2), self%is_near(0:body%mesh%n_nodes))
      self%is_own = .false.
      self%is_beyond = .false.
      self%is_near = .false.
      self%least = 0.0_dp
      self%is_own(:, 1) = is_of_set(body, contact%set)
      if (contact%pairing%is_pair()) then
         self%is_own(:, 2) = is_of_set(body, contact%pairing%against)
         self%reach = max(zone%pairs(set)%search, small*maxval(maxval(body%mesh%coordinates, dim=2) &
            - minval(body%mesh%coordinates, dim=2)))
         do i = 1, size(zone%pairs(set)%segments)
            associate (segment => zone%pairs(set)%segments(i))
               self%is_near(pack(zone%pairs(set)%slave%side(:3, segment%slave), segment%range(1) <= places &
                  + input_rounding .and. segment%range(2) >= places - input_rounding)) = .true.
            end associate
         end do
         ! Polygons that approximate curves overlap before any load, and these nodes may, too.
         do p = 1, merge(zone%n_points, 0, contact%pairing%has_mesh_gap())
            associate (first => zone%quadrature%start(p), last => zone%quadrature%start(p + 1) - 1)
               if (zone%set(p) == set) self%least = min(self%least, minval(zone%quadrature%gap(first:last)))
            end associate
         end do
      end if
      do p = 1, 2
         do i = 1, size(self%is_taken)
            do k = 1, merge(2, 0, self%is_own(i, p))
               side = self%beside(k, i)
               do while (side > 0)
                  if (self%is_taken(side) .or. self%is_beyond(side, p)) exit
                  self%is_beyond(side, p) = .true.
                  side = self%beside(k, side)
               end do
            end do
         end do
      end do
   end subroutine outline_choose

   !> Adds the nodes of one body that no contact force acts on: those beyond the ends of its set that supports leave
   !> free along the normal, of a slave also those beside no segment, a corner once for each of its normals; and ends.
   pure subroutine add_nodes(boundary, outline, set, of, direction, constraints, zone)
      type(free_boundary_t), intent(inout) :: boundary !! the free boundary
      type(outline_t), intent(in) :: outline !! the sides of the boundary, the contact set chosen
      integer, intent(in) :: set !! number of the contact set
      integer, intent(in) :: of !! 1 for this set, 2 for that of the other body of a pair
      real(dp), intent(in) :: direction(2) !! along which gaps count; 0, 0 for the body's normal [-]
      type(constraints_t), intent(in) :: constraints !! the supports
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(free_node_t) :: found
      logical :: is_place(size(outline%is_taken))
      real(dp) :: seen(2, size(outline%is_near))
      integer :: record(3, size(is_place)), last(size(outline%is_near)), i, k, n, p

      is_place = outline%is_beyond(:, of) .or. (outline%is_own(:, of) .and. of == 1 .and. any(outline%is_own(:, 2)))
      seen = 0.0_dp
      last = 0
      record = 0
      n = size(boundary%nodes)
      boundary%nodes = [boundary%nodes, [(free_node_t(), i=1, 3*count(is_place))]]
      do i = 1, size(is_place)
         do k = 1, merge(3, 0, is_place(i))
            associate (node => outline%surface%side(k, i), normal => outline%surface%normal(:, k, i))
               if (node == 0) cycle
               if (outline%is_beyond(i, of) .and. outline%is_taken_node(node)) cycle
               if (.not. dot_product(seen(:, node), normal) > 1.0_dp - sum_rounding) then
                  seen(:, node) = normal
                  last(node) = 0
                  found%node = 0
                  if (constraints%leaves_free(node, normal) .or. constraints%rigid_of(node) > 0) then
                     found = outline%face(of, i, k, direction)
                  end if
                  if (found%node > 0) then
                     n = n + 1
                     boundary%nodes(n) = found
                     boundary%nodes(n)%set = set
                     p = nearest_point(zone, set, outline%surface%corner(:, k, i))
                     if (p > 0) boundary%nodes(n)%arc_length = zone%quadrature%arc_length(zone%quadrature%start(p))
                     last(node) = n
                  end if
               end if
               record(k, i) = last(node)
            end associate
         end do
      end do
      boundary%nodes = boundary%nodes(:n)
      call add_ends(boundary, outline, set, of, record, zone)
   end subroutine add_nodes

   !> Adds the ends of a set where the boundary continues without a corner, of a slave also those beyond which its next
   !> node faces the master from too far away.
   pure subroutine add_ends(boundary, outline, set, of, record, zone)
      type(free_boundary_t), intent(inout) :: boundary !! the free boundary, its nodes added
      type(outline_t), intent(in) :: outline !! the sides of the boundary, the contact set chosen
      integer, intent(in) :: set !! number of the contact set
      integer, intent(in) :: of !! 1 for this set, 2 for that of the other body of a pair
      integer, intent(in) :: record(:, :) !! free node of each corner and middle, 0 for none (3, sides)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      logical :: is_of_search
      integer :: i, k, next, beyond, point

      associate (surface => outline%surface)
         do i = 1, size(record, 2)
            do k = 1, merge(2, 0, outline%is_own(i, of))
               beyond = 0
               next = outline%beside(k, i)
               if (next > 0) then
                  if (outline%is_beyond(next, of) .and. .not. any(abs(surface%normal(:, 3 - k, next) &
                     - surface%normal(:, k, i)) > 0.0_dp)) beyond = record(merge(3, k, surface%side(3, next) > 0), next)
               end if
               is_of_search = record(3 - k, i) > 0 .and. outline%is_near(surface%side(k, i)) &
                  .and. .not. outline%is_near(surface%side(3 - k, i))
               if (is_of_search) is_of_search = any(outline%is_own(:, 2) .and. surface%side(1, :) &
                  == boundary%nodes(record(3 - k, i))%facing(1))
               if (is_of_search) beyond = record(3 - k, i)
               if (beyond == 0) cycle
               point = nearest_point(zone, set, surface%corner(:, k, i))
               if (point > 0) boundary%ends = [boundary%ends, &
                  set_end_t(set, of == 2, is_of_search, point, beyond, surface%corner(:, k, i))]
            end do
         end do
      end associate
   end subroutine add_ends

   !> Finds what a node faces: along the given direction an obstacle, along its normal the other body of a pair, except
   !> for positions that belong to both sets and nodes of the slave beside a segment. The number of the node is 0 if it
   !> faces nothing.
   pure type(free_node_t) function outline_face(self, of, side, corner, direction) result(found)
      class(outline_t), intent(in) :: self !! the sides of the boundary, the contact set chosen
      integer, intent(in) :: of !! 1 for a node of this set's body, 2 for one of the other body of a pair
      integer, intent(in) :: side !! a side of the node
      integer, intent(in) :: corner !! first corner, second corner or middle of it, 1 to 3
      real(dp), intent(in) :: direction(2) !! along which gaps of an obstacle count; 0, 0 for the body's normal [-]
      type(surface_place_t) :: place
      type(meeting_t) :: meeting
      integer, allocatable :: near(:)
      integer :: k

      associate (surface => self%surface, normal => self%surface%normal(:, corner, side))
         found%normal = normal
         if (.not. any(self%is_own(:, 2))) then
            if (any(abs(direction) > 0.0_dp)) found%normal = unit_vector(direction)
            if (dot_product(found%normal, normal) >= steepest_cosine) found%node = surface%side(corner, side)
            return
         end if
         place = surface%place(side, places(corner))
         near = sides_near(surface, side, surface, self%reach)
         near = pack(near, self%is_own(near, 3 - of) .or. self%is_beyond(near, 3 - of))
         meeting = meet_master(surface, near, place, self%reach)
         if (meeting%side == 0) return
         ! A boundary behind the node is the far side of the other body.
         if (meeting%gap < 2.0_dp*self%least - input_rounding*surface%longest) return
         place = surface%place(meeting%side, meeting%xi)
         k = maxloc(place%values, dim=1)
         if (self%is_own(side, of) .and. self%is_own(meeting%side, 3 - of)) then
            if (self%is_near(surface%side(corner, side))) return
         else if (self%is_own(side, of) .and. place%values(k) > 1.0_dp - input_rounding) then
            ! The corner at which the other set ends belongs to it, on whichever of its two sides rounding puts it.
            if (self%is_taken_node(surface%side(k, meeting%side))) return
         end if
         found%node = surface%side(corner, side)
         found%facing = surface%side(:3, meeting%side)
         found%share = place%values
         found%distance = max(self%least, meeting%gap)
      end associate
   end function outline_face

   !> The contact point of a set nearest to a position; 0 for a set without points.
   pure integer function nearest_point(zone, set, position)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: set !! number of the contact set
      real(dp), intent(in) :: position(2) !! the place [L]

      nearest_point = minloc((zone%position(1, :) - position(1))**2 + (zone%position(2, :) - position(2))**2, dim=1, &
         mask=zone%set == set)
   end function nearest_point

   !> The sides of the boundary, as of `mesh_set_sides` (size, sides).
   pure function boundary_sides(body) result(sides)
      class(meshed_body_t), intent(in) :: body !! mesh and its boundary
      integer, allocatable :: sides(:, :)
      integer :: i, n

      n = size(body%mesh%side(1, 1))
      allocate (sides(n + 1, size(body%outer)))
      do i = 1, size(body%outer)
         sides(n + 1, i) = side_element(body%outer(i))
         sides(:n, i) = body%mesh%side(sides(n + 1, i), side_place(body%outer(i)))
      end do
   end function boundary_sides

   !> Which sides of the boundary belong to a boundary set.
   pure function is_of_set(body, set) result(is_in)
      class(meshed_body_t), intent(in) :: body !! mesh and its boundary
      character(*), intent(in) :: set !! name of the boundary set
      logical, allocatable :: is_in(:)

      allocate (is_in(side_number(body%mesh%n_elements + 1, 0)), source=.false.)
      associate (own => body%mesh%sets(find_set(body%mesh%sets, set)))
         is_in(side_number(own%element, own%side)) = .true.
      end associate
      is_in = is_in(body%outer)
   end function is_of_set

   !> Whether a point lies in a body: its straight sides above the point wind around it. Corners above or below the
   !> point count as lying on its left, so that one of their two sides is met, both or none.
   pure logical function contains_point(sides, coordinates, point) result(is_inside)
      integer, intent(in) :: sides(:, :) !! the sides of the boundary, body on the left (4, sides)
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: point(2) !! the point [L]
      integer :: i, winding

      winding = 0
      do i = 1, size(sides, 2)
         associate (a => coordinates(:, sides(1, i)), b => coordinates(:, sides(2, i)))
            if ((a(1) <= point(1)) .eqv. (b(1) <= point(1))) cycle
            if (a(2) + (point(1) - a(1))*(b(2) - a(2))/(b(1) - a(1)) <= point(2)) cycle
            winding = winding + merge(1, -1, a(1) > b(1))
         end associate
      end do
      is_inside = winding > 0
   end function contains_point

   !> The distance of a point from a straight side [L].
   pure real(dp) function distance_from(a, b, point) result(distance)
      real(dp), intent(in) :: a(2) !! where the side begins [L]
      real(dp), intent(in) :: b(2) !! where it ends [L]
      real(dp), intent(in) :: point(2) !! the point [L]

      distance = norm2(point - a - (b - a)*min(1.0_dp, max(0.0_dp, dot_product(point - a, b - a) &
         /dot_product(b - a, b - a))))
   end function distance_from

   !> Finds the distance of a node to the obstacle or body that it faces, before any displacement.
   pure subroutine measure_node(node, contact, position, gap, is_met)
      type(free_node_t), intent(in) :: node !! the node
      type(contact_t), intent(in) :: contact !! its contact set, the obstacle where it is now
      real(dp), intent(in) :: position(:) !! position of the node (n_dim) [L]
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
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (n_dim, n_nodes) [L]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: gap(:) !! their distances to the obstacle (m) [L]
      logical, allocatable :: lies_outside(:)
      real(dp) :: least(size(contacts)), distance
      integer :: i

      least = [(min(0.0_dp, minval(gap, mask=zone%set == i)), i=1, size(contacts))] &
         - input_rounding*maxval(maxval(coordinates, dim=2) - minval(coordinates, dim=2))
      allocate (lies_outside(size(self%nodes)))
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i))
            call measure_node(node, contacts(node%set), coordinates(:, node%node), distance, lies_outside(i))
            lies_outside(i) = lies_outside(i) .and. distance >= least(node%set)
         end associate
      end do
   end function free_boundary_lies_outside

   !> The node of the free boundary that the displacements move deepest into an obstacle or another body.
   pure type(overlap_t) function free_boundary_overlap(self, contacts, lies_outside, coordinates, displacement) &
      result(deepest)
      class(free_boundary_t), intent(in) :: self !! the free boundary
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they are now
      logical, intent(in) :: lies_outside(:) !! which nodes count (n)
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (n_dim, n_nodes) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (n_dim, n_nodes) [L]
      real(dp) :: x(size(coordinates, 1)), way(size(coordinates, 1)), depth, gap, least
      logical :: is_met
      integer :: i, k

      least = difference_rounding*maxval(abs(coordinates))
      do i = 1, size(self%nodes)
         if (.not. lies_outside(i)) cycle
         associate (node => self%nodes(i), contact => contacts(self%nodes(i)%set))
            x = coordinates(:, node%node)
            way = displacement(:, node%node)
            do k = 1, count(node%facing > 0)
               way = way - node%share(k)*displacement(:, node%facing(k))
            end do
            call measure_node(node, contact, x, gap, is_met)
            depth = dot_product(node%normal, way) - gap
            if (.not. (is_met .and. depth > max(least, deepest%depth))) cycle
            ! Where the obstacle is no plane, a node that slides along it does not enter it; nor one that slides along
            ! the other body, as an overhanging flank does.
            if (node%facing(1) == 0) then
               call measure_node(node, contact, x + way, gap, is_met)
               depth = merge(min(depth, -gap), 0.0_dp, is_met)
            else
               associate (along => coordinates(:, node%facing(2)) - coordinates(:, node%facing(1)))
                  depth = min(depth, dot_product(gap*node%normal - way, unit_vector([along(2), -along(1)])))
               end associate
            end if
            if (depth > max(least, deepest%depth)) deepest = overlap_t(depth, x, node%set)
         end associate
      end do
   end function free_boundary_overlap

   !> The ends of sets that contact reaches: the point next to the end is closed, and the surface that it touches
   !> continues along the boundary as well.
   pure function free_boundary_reached_ends(self, contacts, coordinates, gap, status) result(reached)
      class(free_boundary_t), intent(in) :: self !! the free boundary
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they are now
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (n_dim, n_nodes) [L]
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
   !> limits, see `resolved_depth`. Corners that the motion takes into the body count as well where a side of no set is
   !> the nearest one.
   pure type(overlap_t) function corner_overlap(body, contacts, zone, extra_gap, displacement, limits) result(deepest)
      class(meshed_body_t), intent(in) :: body !! mesh and its boundary
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, the obstacles where they are now
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: extra_gap(:) !! additions of the deck to their gaps (m) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: limits(2) !! these limits, over the largest displacement [-]
      ! Over the largest displacement: a roughness of measured profiles that is smaller does not spoil the pressures.
      real(dp), parameter :: negligible = 1.0e-2_dp
      integer, allocatable :: sides(:, :)
      logical, allocatable :: is_own(:)
      real(dp), allocatable :: corners(:, :), apart(:), displaced(:, :)
      type(displaced_side_t) :: side
      real(dp) :: largest, least
      integer :: i, k, j, l, p

      ! Obstacles in space have no corners.
      if (size(displacement, 1) == 3) return
      largest = maxval(abs(displacement))
      least = max(negligible*largest, difference_rounding*maxval(abs(body%mesh%coordinates)))
      do i = 1, size(contacts)
         corners = corners_of(contacts(i))
         if (size(corners) == 0 .or. all(zone%set /= i)) cycle
         if (.not. allocated(sides)) then
            sides = boundary_sides(body)
            displaced = body%mesh%coordinates + displacement
         end if
         is_own = is_of_set(body, contacts(i)%set)
         do k = 1, size(sides, 2)
            if (.not. is_own(k)) cycle
            associate (nodes => sides(:3, k), x => body%mesh%coordinates)
               side%set = i
               side%has_middle = nodes(3) > 0
               side%normal = unit_vector([x(2, nodes(2)) - x(2, nodes(1)), x(1, nodes(1)) - x(1, nodes(2))])
               side%rest(:, 3) = 0.5_dp*(x(:, nodes(1)) + x(:, nodes(2)))
               do j = 1, count(nodes > 0)
                  side%rest(:, j) = x(:, nodes(j))
                  p = nearest_point(zone, i, x(:, nodes(j)))
                  side%moved(:, j) = x(:, nodes(j)) + (dot_product(displacement(:, nodes(j)), side%normal) &
                     - extra_gap(p))*side%normal
               end do
               if (nodes(3) == 0) side%moved(:, 3) = 0.5_dp*(side%moved(:, 1) + side%moved(:, 2))
               call look_at_side(deepest, contacts(i), side, corners, sides, x, limits*max(largest, least), least)
            end associate
         end do
         do l = 1, size(corners, 2)
            if (contains_point(sides, body%mesh%coordinates, corners(:, l)) .or. &
               .not. contains_point(sides, displaced, corners(:, l))) cycle
            apart = [(distance_from(displaced(:, sides(1, k)), displaced(:, sides(2, k)), corners(:, l)), &
               k=1, size(sides, 2))]
            k = minloc(apart, dim=1)
            if (apart(k) > max(least, deepest%depth) .and. .not. is_own(k)) deepest = overlap_t(apart(k), &
               corners(:, l), i)
         end do
      end do
   end function corner_overlap

   !> Looks for the corner of an obstacle that penetrates a displaced side deepest.
   pure subroutine look_at_side(deepest, contact, side, corners, sides, coordinates, limits, least)
      type(overlap_t), intent(inout) :: deepest !! the deepest overlap so far
      type(contact_t), intent(in) :: contact !! the contact set
      type(displaced_side_t), intent(in) :: side !! the side
      real(dp), intent(in) :: corners(:, :) !! the corners (2, any) [L]
      integer, intent(in) :: sides(:, :) !! the sides of the boundary (4, any)
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: limits(2) !! up to which the depths that are errors of the mesh do not count [L]
      real(dp), intent(in) :: least !! the least depth that counts [L]
      ! The corner itself may lie on the boundary.
      real(dp), parameter :: nearly = 0.99_dp
      real(dp) :: xi(2), values(3), slopes(3), depth, along, ends(2), place(2)
      integer :: j, l

      associate (normal => side%normal)
         ends = [(-cross_product(normal, side%rest(:, j)), j=1, 2)]
         do l = 1, size(corners, 2)
            along = -cross_product(normal, corners(:, l))
            if (along < minval(ends) .or. along > maxval(ends)) cycle
            xi = meet_side(side%moved, corners(:, l), normal)
            do j = 1, 2
               if (abs(xi(j)) > 1.0_dp) cycle
               call side_shapes(.true., xi(j), values, slopes)
               depth = dot_product(matmul(side%moved, values) - corners(:, l), normal)
               if (.not. depth > deepest%depth) cycle
               if (.not. depth - resolved_depth(contact, side, xi(j), limits) > least) cycle
               ! A point beyond the far side of the body does not penetrate it.
               place = matmul(side%rest, values)
               if (.not. contains_point(sides, coordinates, place - 0.5_dp*depth*normal)) cycle
               if (contains_point(sides, coordinates, place - nearly*depth*normal)) deepest = overlap_t(depth, &
                  place, side%set)
            end do
         end do
      end associate
   end subroutine look_at_side

   !> The convex corners of a rigid obstacle: ends of a polyline and points where its line turns to the right, away from
   !> the free side; the apex of a circle or parabola; none of a pair (2, corners) [L].
   pure function corners_of(contact) result(corners)
      type(contact_t), intent(in) :: contact !! the contact set
      real(dp), allocatable :: corners(:, :)
      logical, allocatable :: bulges(:)
      real(dp) :: axis(2)
      integer :: i

      associate (obstacle => contact%obstacle)
         axis = obstacle%outward(2)
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
            corners = reshape(obstacle%point(:2), [2, 1])
         else
            allocate (corners(2, 0))
         end if
      end associate
   end function corners_of

   !> Largest depth to which a surface may reach into a side between two nodes because of the mesh: half the distance of
   !> the nodes times the tangent of half the angle between the surface's directions opposite to them (the height of the
   !> triangle of its tangents, unless one is missing or steeper than warnings allow), plus the difference of their
   !> displacements, each up to its limit, plus the overlap of the nodes [L].
   pure real(dp) function resolved_depth(contact, side, xi, limits) result(depth)
      type(contact_t), intent(in) :: contact !! the contact set
      type(displaced_side_t), intent(in) :: side !! the side
      real(dp), intent(in) :: xi !! the place on it, from -1 to 1 [-]
      real(dp), intent(in) :: limits(2) !! the limits [L]
      ! 30 degrees off the obstacle's normal, as warnings have it.
      real(dp), parameter :: smallest_cosine = 0.866_dp
      real(dp) :: gap, cosine, turn, angle
      logical :: is_met, is_steep
      integer :: beside(2), i

      beside = [1, 2]
      if (side%has_middle) beside(merge(2, 1, xi < 0.0_dp)) = 3
      depth = 0.0_dp
      angle = 0.0_dp
      is_steep = .false.
      do i = 1, 2
         call contact%obstacle%measure(side%rest(:, beside(i)), side%normal, gap, is_met, cosine, turn)
         ! Where there is no surface opposite to a node, the cosine is that of a steeper one, or 0.
         is_steep = is_steep .or. cosine < smallest_cosine
         if (.not. is_met) cycle
         angle = angle + turn
         depth = max(depth, dot_product(side%moved(:, beside(i)) - side%rest(:, beside(i)), side%normal) - gap)
      end do
      if (is_steep) angle = 0.0_dp
      ! At an edge of the obstacle one node is supported, and the other one moves down.
      associate (way => side%moved(:, beside) - side%rest(:, beside))
         depth = depth + sum(min(limits, [0.5_dp*tan(0.5_dp*angle)*norm2(side%rest(:, beside(2)) &
            - side%rest(:, beside(1))), abs(dot_product(way(:, 2) - way(:, 1), side%normal))]))
      end associate
   end function resolved_depth

end module amontons_free_boundary
