!> A boundary set as a surface: its sides, straight or curved, with a continuous field of normals; and the segments of a
!> pair of surfaces, which are the parts of slave sides that face one and the same side of the master.
!>
!> The normal of a node is the mean of the unit normals of the sides that meet there; between the nodes of a side the
!> shape functions interpolate. At an end of the set it is the normal of the only side. On a plane of symmetry, where
!> supports hold a line of nodes along one direction, and on the axis of revolution it has no component along this
!> direction, since the surface continues as its mirror image.
!>
!> A point of the slave meets the master where the ray along its normal does, ahead or behind. A side of the master
!> counts if its outward normal faces that of the slave, so that a ray does not meet the far side of a thin master, and
!> if it is within reach; of several sides the nearest counts. Segments end where a ray meets a corner of the master, so
!> that integrands are smooth on each segment.
module amontons_surface
   use amontons_boundary, only: patch_t
   use amontons_constraints, only: constraints_t
   use amontons_contact_rows, only: contact_quadrature_t, contact_rows_t
   use amontons_element, only: side_shapes
   use amontons_face, only: place_side
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t, on_axis
   use amontons_mesh, only: mesh_t
   use amontons_obstacle, only: cross_product, steepest_cosine
   use amontons_rounding, only: angle_rounding, computed_rounding, difference_rounding, exceeds, sum_rounding
   implicit none (type, external)
   private

   public :: find_segments, find_segments_again, gauss_rule, gauss_rule_t, is_on_mirror, join_sides, meet_master, &
      meet_side, meeting_t, meshed_body_t, mortar_points_t, mortar_segment_t, most_aslant, new_surface, sharp, &
      sides_near, surface_place_t, surface_t

   !> Cosine of the smallest angle between two sides at a corner: 40 degrees.
   real(dp), parameter :: sharp = 0.766_dp

   !> A direction at less than 59.9 degrees to the normal is held by a support, not by symmetry; that of a guide at 60
   !> degrees has the rounding error of its cosine.
   real(dp), parameter :: most_aslant = 0.501_dp

   !> A quadrature rule on the interval from -1 to 1.
   type :: gauss_rule_t
      real(dp), allocatable :: xi(:) !! abscissas [-]
      real(dp), allocatable :: weight(:) !! weights [-]
   end type gauss_rule_t

   !> A mesh with its materials and supports.
   type :: meshed_body_t
      type(mesh_t) :: mesh !! the mesh
      integer, allocatable :: outer(:) !! numbers of the elements' sides on its boundary, ascending
      type(materials_t) :: materials !! the materials of the elements
      type(constraints_t) :: constraints !! the supports
   end type meshed_body_t

   !> The sides of a boundary set, in the plane in the order of its line.
   type :: surface_t
      integer :: n_sides = 0 !! number of sides
      integer, allocatable :: side(:, :)
         !! first corner, second corner, middle or 0, element of each side, body on the left (4, n_sides); in space the
         !! nodes of the face, as of `mesh_side`, and the element (max_face_nodes + 1, n_sides)
      real(dp), allocatable :: corner(:, :, :)
         !! coordinates of first corner, second corner, middle of each side; the middle of a straight one is that of its
         !! chord (2, 3, n_sides); in space of the nodes, the first for those that a face has not, at last of the middle
         !! of its corners (3, max_face_nodes + 1, n_sides) [L]
      real(dp), allocatable :: normal(:, :, :)
         !! unit outward normals there (2, 3, n_sides); in space at the corners, at last of the face's mean plane
         !! (3, 5, n_sides) [-]
      real(dp), allocatable :: box(:, :, :)
         !! least and largest coordinates of each `n_boxed` sides that follow each other (n_dim, 2, any) [L]
      type(material_t), allocatable :: material(:) !! the material behind each side, for the depth (n_sides)
      integer, allocatable :: next(:) !! the side that follows each, 0 for none; in the plane (n_sides)
      integer, allocatable :: mirrored_node(:) !! ends that lie on a plane of symmetry, where shear vanishes
      real(dp), allocatable :: mirror(:, :) !! unit normals of these planes; in the plane (2, mirrored nodes) [-]
      real(dp) :: longest = 0.0_dp !! longest chord of a side [L]
      integer :: corner_node = 0 !! a node where sides meet at so sharp an angle that it has no mean normal; 0 for none
   contains
      procedure :: move => surface_move
      procedure :: n_corners => surface_n_corners
      procedure :: n_nodes => surface_n_nodes
      procedure :: place => surface_place
      procedure :: set_boxes => surface_set_boxes
   end type surface_t

   !> Number of consecutive sides with a common bounding box.
   integer, parameter :: n_boxed = 64

   !> A position on a side with its derivative and normal.
   type :: surface_place_t
      real(dp) :: values(3) = 0.0_dp !! shape functions of first corner, second corner, middle [-]
      real(dp) :: position(2) = 0.0_dp !! coordinates [L]
      real(dp) :: along(2) = 0.0_dp !! tangent: derivative of the position by the side's coordinate [L]
      real(dp) :: normal(2) = 0.0_dp !! normal of the continuous field, not of length 1 [-]
      real(dp) :: depth = 0.0_dp !! depth of the body [L]
   contains
      procedure :: outward => surface_place_outward
   end type surface_place_t

   !> A part of a side of the slave.
   type :: mortar_segment_t
      integer :: slave = 0 !! number of the side of the slave
      integer :: master = 0 !! number of the side of the master that it faces; 0 for a rigid obstacle
      real(dp) :: range(2) = 0.0_dp
         !! local coordinates of its ends on the slave's side, from -1 to 1; of no meaning in space [-]
   end type mortar_segment_t

   !> Integrals of the points of a pair.
   type :: mortar_points_t
      real(dp), allocatable :: area(:) !! D_p (n) [L^2]
      real(dp), allocatable :: length(:)
         !! tributary length, in space area: the integral of the averaging function (n) [L], [L^2]
      real(dp), allocatable :: center(:, :) !! mean position on the slave, where the force acts (n_dim, n) [L]
      real(dp), allocatable :: foot(:, :) !! mean position on the master (n_dim, n) [L]
      type(contact_rows_t) :: rows !! shares of the nodes in w
      type(contact_quadrature_t) :: quadrature
         !! the quadrature points, with their gaps; in space one, with the means, for each point
   end type mortar_points_t

   !> The intersection of a ray with a side of the master.
   type :: meeting_t
      integer :: side = 0 !! number of the side; 0 where the ray meets none
      real(dp) :: xi = 0.0_dp !! the place on it, from -1 to 1 [-]
      real(dp) :: gap = 0.0_dp !! the way to it along the ray's direction, negative behind [L]
   end type meeting_t

contains

   !> Abscissas and weights of Gauss's rule on the interval from -1 to 1: zeros of the Legendre polynomial by Newton's
   !> method.
   pure type(gauss_rule_t) function gauss_rule(n) result(rule)
      integer, intent(in) :: n !! number of points
      real(dp), parameter :: pi = acos(-1.0_dp)
      integer, parameter :: n_steps = 10
      real(dp) :: p(0:n), slope
      integer :: i, k, step

      allocate (rule%xi(n), rule%weight(n))
      do i = 1, n
         associate (xi => rule%xi(i))
            xi = cos(pi*(i - 0.25_dp)/(n + 0.5_dp))
            do step = 1, n_steps
               p(0) = 1.0_dp
               p(1) = xi
               do k = 2, n
                  p(k) = ((2*k - 1)*xi*p(k - 1) - (k - 1)*p(k - 2))/k
               end do
               slope = n*(xi*p(n) - p(n - 1))/(xi**2 - 1.0_dp)
               xi = xi - p(n)/slope
            end do
            rule%weight(i) = 2.0_dp/((1.0_dp - xi**2)*slope**2)
         end associate
      end do
   end function gauss_rule

   !> Makes the surface of a boundary set.
   pure subroutine new_surface(surface, body, patch, facing)
      type(surface_t), intent(out) :: surface !! the surface
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(patch_t), intent(in) :: patch !! the patch of the set
      type(patch_t), intent(in) :: facing !! that of the other body's set
      logical :: is_free(2), is_on_axis(body%mesh%n_nodes), is_corner(2, body%mesh%n_nodes)
      real(dp) :: held(2)
      integer :: i, k

      call join_sides(surface, body, patch%sides())
      is_on_axis = on_axis(body%mesh, body%materials)
      is_corner = .false.
      is_corner(1, surface%side(1, :)) = .true.
      is_corner(2, surface%side(2, :)) = .true.
      do i = 1, surface%n_sides
         do k = 1, 2
            associate (node => surface%side(k, i), normal => surface%normal(:, k, i))
               if (is_corner(3 - k, node)) cycle
               is_free = body%constraints%is_free(:2, node)
               if (is_free(1) .neqv. is_free(2)) then
                  held = body%constraints%held_direction(node)
                  if (.not. is_on_mirror(body, node, held, facing%node)) cycle
               else if (is_on_axis(node)) then
                  held = [1.0_dp, 0.0_dp]
               else
                  cycle
               end if
               if (abs(dot_product(held, normal)) > most_aslant) cycle
               surface%mirrored_node = [surface%mirrored_node, node]
               surface%mirror = reshape([surface%mirror, held], [2, size(surface%mirrored_node)])
            end associate
         end do
      end do
      call surface%move(body%mesh%coordinates)
   end subroutine new_surface

   !> Makes a surface of sides of the boundary. Its ends have the normals of their sides on planes of symmetry as well.
   pure subroutine join_sides(surface, body, sides)
      type(surface_t), intent(out) :: surface !! the surface
      class(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      integer, intent(in) :: sides(:, :)
         !! first corner, second corner, middle or 0, element of each side; body on the left (4, sides)
      integer :: i, side_from(body%mesh%n_nodes)

      surface%side = sides
      surface%n_sides = size(sides, 2)
      surface%material = body%materials%list(body%materials%of_element(surface%side(4, :)))
      side_from = 0
      side_from(surface%side(1, :)) = [(i, i=1, surface%n_sides)]
      surface%next = side_from(surface%side(2, :))
      allocate (surface%corner(2, 3, surface%n_sides), surface%normal(2, 3, surface%n_sides), &
         surface%mirrored_node(0), surface%mirror(2, 0))
      call surface%move(body%mesh%coordinates)
   end subroutine join_sides

   !> Puts a surface in the plane where its nodes are. What is mirrored stays so.
   pure subroutine surface_move(self, coordinates)
      class(surface_t), intent(inout) :: self !! the surface
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (2, n_nodes) [L]
      real(dp) :: mean(2)
      integer :: i, at(2)

      self%corner_node = 0
      self%longest = 0.0_dp
      do i = 1, self%n_sides
         associate (corner => self%corner(:, :, i))
            call place_side(corner, self%normal(:, :, i), self%side(:3, i), coordinates)
            self%longest = max(self%longest, norm2(corner(:, 2) - corner(:, 1)))
         end associate
      end do
      call self%set_boxes()
      ! Nodes between two sides have the mean of their normals, unless these differ too much.
      do i = 1, self%n_sides
         if (self%next(i) == 0) cycle
         associate (before => self%normal(:, 2, i), behind => self%normal(:, 1, self%next(i)))
            if (dot_product(before, behind) < sharp) then
               self%corner_node = self%side(2, i)
            else
               mean = before + behind
               before = mean/norm2(mean)
               behind = before
            end if
         end associate
      end do
      do i = 1, size(self%mirrored_node)
         at = findloc(self%side(:2, :), self%mirrored_node(i))
         associate (normal => self%normal(:, at(1), at(2)), held => self%mirror(:, i))
            normal = normal - dot_product(held, normal)*held
            normal = normal/norm2(normal)
         end associate
      end do
   end subroutine surface_move

   !> Sets the bounding boxes of the sides.
   pure subroutine surface_set_boxes(self)
      class(surface_t), intent(inout) :: self !! the surface
      integer :: i

      if (.not. allocated(self%box)) then
         allocate (self%box(size(self%corner, 1), 2, (self%n_sides + n_boxed - 1)/n_boxed))
      end if
      do i = 1, size(self%box, 3)
         associate (corner => self%corner(:, :, n_boxed*(i - 1) + 1:min(n_boxed*i, self%n_sides)))
            self%box(:, 1, i) = minval(minval(corner, dim=3), dim=2)
            self%box(:, 2, i) = maxval(maxval(corner, dim=3), dim=2)
         end associate
      end do
   end subroutine surface_set_boxes

   !> Number of nodes of a side.
   pure integer function surface_n_nodes(self, side) result(n)
      class(surface_t), intent(in) :: self !! the surface
      integer, intent(in) :: side !! number of the side

      n = count(self%side(:size(self%side, 1) - 1, side) > 0)
   end function surface_n_nodes

   !> Number of corners of a side.
   pure integer function surface_n_corners(self, side) result(n)
      class(surface_t), intent(in) :: self !! the surface
      integer, intent(in) :: side !! number of the side

      n = self%n_nodes(side)
      if (n > 4) n = n/2
      if (size(self%corner, 1) == 2) n = 2
   end function surface_n_corners

   !> Whether a node that is held along a direction lies on a plane of symmetry: one of its neighbors and a node of the
   !> other body lie there and are held along the same direction.
   pure logical function is_on_mirror(body, node, held, facing)
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: held(:) !! the direction, a unit vector (n_dim) [-]
      integer, intent(in) :: facing(:) !! the nodes of the other body's set
      integer :: element, i

      is_on_mirror = any([(lies_there(facing(i)), i=1, size(facing))])
      do element = 1, merge(body%mesh%n_elements, 0, is_on_mirror)
         associate (nodes => body%mesh%node(body%mesh%node_start(element):body%mesh%node_start(element + 1) - 1))
            if (all(nodes /= node)) cycle
            if (any([(nodes(i) /= node .and. lies_there(nodes(i)), i=1, size(nodes))])) return
         end associate
      end do
      is_on_mirror = .false.

   contains

      !> Whether another node lies on the plane and is held along the direction.
      pure logical function lies_there(other)
         integer, intent(in) :: other !! the node

         associate (way => body%mesh%coordinates(:, other) - body%mesh%coordinates(:, node))
            lies_there = .not. body%constraints%leaves_free(other, held) .and. &
               abs(dot_product(way, held)) <= angle_rounding*norm2(way)
         end associate
      end function lies_there

   end function is_on_mirror

   !> Evaluates position, derivative and normal at a local coordinate of a side.
   pure type(surface_place_t) function surface_place(self, side, xi) result(place)
      class(surface_t), intent(in) :: self !! the surface
      integer, intent(in) :: side !! number of the side
      real(dp), intent(in) :: xi !! the place on it, from -1 to 1 [-]
      real(dp) :: slope(3)

      call side_shapes(self%side(3, side) > 0, xi, place%values, slope)
      place%position = matmul(self%corner(:, :, side), place%values)
      place%along = matmul(self%corner(:, :, side), slope)
      place%normal = matmul(self%normal(:, :, side), place%values)
      place%depth = self%material(side)%depth(place%position(1))
   end function surface_place

   !> The unit outward normal of the side, not of the interpolated field [-].
   pure function surface_place_outward(self) result(outward)
      class(surface_place_t), intent(in) :: self !! the place
      real(dp) :: outward(2)

      outward = [self%along(2), -self%along(1)]/norm2(self%along)
   end function surface_place_outward

   !> Cuts the sides of the slave into segments, each with local coordinates from -1 to 1 of its side; parts that face
   !> no master have none.
   pure subroutine find_segments(segments, slave, master, search)
      type(mortar_segment_t), allocatable, intent(out) :: segments(:) !! the segments
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      real(dp), intent(in) :: search !! largest magnitude of a gap [L]
      type(meeting_t) :: meeting
      type(surface_place_t) :: middle
      integer, allocatable :: near(:)
      real(dp), allocatable :: ends(:)
      integer :: side, i, n

      allocate (segments(2*slave%n_sides + 2*master%n_sides))
      n = 0
      do side = 1, slave%n_sides
         near = sides_near(slave, side, master, search)
         if (size(near) == 0) cycle
         ends = breakpoints(slave, side, master, near)
         do i = 1, size(ends) - 1
            middle = slave%place(side, 0.5_dp*(ends(i) + ends(i + 1)))
            meeting = meet_master(master, near, middle, search)
            if (meeting%side == 0) cycle
            n = n + 1
            if (n > size(segments)) segments = [segments, segments]
            segments(n) = mortar_segment_t(side, meeting%side, ends(i:i + 1))
         end do
      end do
      segments = segments(:n)
   end subroutine find_segments

   !> Cuts sides of the slave a second time, by bisection between rays that meet different sides of the master.
   pure subroutine find_segments_again(segments, slave, master, search, facing)
      type(mortar_segment_t), allocatable, intent(out) :: segments(:) !! the segments
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      real(dp), intent(in) :: search !! largest magnitude of a gap [L]
      integer, intent(in) :: facing(:) !! the sides of the slave that face the master, any number of times
      ! Parts of a side to begin with, for each side of the master that is near, or would be if all were as short as the
      ! shortest; a part is cut further where its ends meet different sides. What a side meets last at either end may be
      ! short.
      integer, parameter :: n_parts = 8
      real(dp), parameter :: edge = 1.0e-9_dp, most = 1.0e5_dp ! beside a corner the side is certain
      type(meeting_t) :: meeting
      integer, allocatable :: near(:)
      logical, allocatable :: counts(:)
      real(dp) :: low, high
      logical :: faces(slave%n_sides)
      integer :: side, part, n

      faces = .false.
      faces(facing) = .true.
      allocate (segments(0))
      do side = 1, slave%n_sides
         if (.not. faces(side)) cycle
         near = sides_near(slave, side, master, search)
         low = edge - 1.0_dp
         segments = [segments, mortar_segment_t(side, met_side(slave, master, side, near, low), [-1.0_dp, -1.0_dp])]
         associate (others => master%corner(:, :, near), own => slave%corner(:, :, side))
            n = n_parts*max(size(near), ceiling(min(most, norm2(own(:, 2) - own(:, 1)) &
               /minval(norm2(others(:, 2, :) - others(:, 1, :), dim=1)))))
         end associate
         do part = 1, n
            high = min(1.0_dp - edge, 2.0_dp*part/n - 1.0_dp)
            call cut_by_rays(segments, slave, master, near, low, high, met_side(slave, master, side, near, high))
            low = high
         end do
         segments(size(segments))%range(2) = 1.0_dp
      end do
      allocate (counts(size(segments)), source=.false.)
      do part = 1, size(segments)
         associate (segment => segments(part))
            if (segment%master == 0) cycle
            meeting = meet_master(master, [segment%master], slave%place(segment%slave, 0.5_dp*sum(segment%range)), &
               search)
            counts(part) = meeting%side > 0
         end associate
      end do
      segments = pack(segments, counts)
   end subroutine find_segments_again

   !> The master's side that the ray from a position on the slave meets, at any distance; 0 if there is none.
   pure integer function met_side(slave, master, side, near, xi) result(met)
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      integer, intent(in) :: side !! the slave's side
      integer, intent(in) :: near(:) !! the master's sides in reach of it
      real(dp), intent(in) :: xi !! the place on it [-]
      type(meeting_t) :: meeting

      meeting = meet_master(master, near, slave%place(side, xi), huge(1.0_dp))
      met = meeting%side
   end function met_side

   !> Cuts part of a slave's side where the rays begin to meet another side of the master, by recursive bisection; the
   !> last segment ends at each cut.
   pure recursive subroutine cut_by_rays(segments, slave, master, near, low, high, last)
      type(mortar_segment_t), allocatable, intent(inout) :: segments(:) !! the segments so far, the last one without end
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      integer, intent(in) :: near(:) !! the master's sides in reach of the slave's side
      real(dp), intent(in) :: low !! a place in the last segment [-]
      real(dp), intent(in) :: high !! the place up to which [-]
      integer, intent(in) :: last !! the side that its ray meets, 0 for none
      real(dp) :: middle
      integer :: met, side

      if (segments(size(segments))%master == last) return
      side = segments(size(segments))%slave
      middle = 0.5_dp*(low + high)
      if (high - low <= 4.0_dp*epsilon(1.0_dp)) then
         segments(size(segments))%range(2) = middle
         segments = [segments, mortar_segment_t(side, last, [middle, middle])]
         return
      end if
      met = met_side(slave, master, side, near, middle)
      call cut_by_rays(segments, slave, master, near, low, middle, met)
      call cut_by_rays(segments, slave, master, near, middle, high, last)
   end subroutine cut_by_rays

   !> The sides of the master whose bounding boxes are within reach of that of a side of the slave.
   pure function sides_near(slave, side, master, search) result(near)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      type(surface_t), intent(in) :: master !! the master
      real(dp), intent(in) :: search !! largest magnitude of a gap [L]
      integer, allocatable :: near(:)
      ! A curved side may bulge out of the box of its nodes by an eighth of its length at the most.
      real(dp), parameter :: bulge = 0.125_dp
      real(dp), dimension(size(slave%corner, 1)) :: low, high
      real(dp) :: reach
      logical :: is_near(n_boxed)
      integer :: i, k, box, before, n

      reach = search + bulge*(slave%longest + master%longest)
      low = minval(slave%corner(:, :, side), dim=2) - reach
      high = maxval(slave%corner(:, :, side), dim=2) + reach
      allocate (near(0))
      do box = 1, size(master%box, 3)
         if (any(master%box(:, 1, box) > high .or. master%box(:, 2, box) < low)) cycle
         before = n_boxed*(box - 1)
         n = min(n_boxed, master%n_sides - before)
         do i = 1, n
            is_near(i) = .true.
            do k = 1, size(low)
               associate (x => master%corner(k, :, before + i))
                  is_near(i) = is_near(i) .and. any(x >= low(k)) .and. any(x <= high(k))
               end associate
            end do
         end do
         near = [near, pack([(before + i, i=1, n)], is_near(:n))]
      end do
   end function sides_near

   !> The possible ends of segments on a side of the slave: its own ends, and the local coordinates whose rays meet
   !> corners of the master [-].
   pure function breakpoints(slave, side, master, near) result(ends)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      type(surface_t), intent(in) :: master !! the master
      integer, intent(in) :: near(:) !! the sides of the master to look at
      real(dp), allocatable :: ends(:)
      real(dp), allocatable :: sorted(:)
      integer :: i, k
      real(dp) :: least

      allocate (sorted(0))
      do i = 1, size(near)
         do k = 1, 2
            ! A corner shared with the preceding side is considered with that side.
            if (k == 1 .and. any(master%side(2, near) == master%side(1, near(i)))) cycle
            sorted = [sorted, places_facing(slave, side, master%corner(:, k, near(i)))]
         end do
      end do
      ends = [-1.0_dp]
      do
         least = ends(size(ends)) + computed_rounding
         if (.not. any(sorted > least .and. sorted < 1.0_dp - computed_rounding)) exit
         ends = [ends, minval(sorted, mask=sorted > least)]
      end do
      ends = [ends, 1.0_dp]
   end function breakpoints

   !> The local coordinates of a slave side whose rays meet a point: zeros of a polynomial of degree 4 at most, located
   !> by its changes of sign [-].
   pure function places_facing(slave, side, point) result(places)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      real(dp), intent(in) :: point(2) !! the point [L]
      real(dp), allocatable :: places(:)
      integer, parameter :: n_parts = 8
      real(dp) :: xi(0:n_parts), value(0:n_parts)
      integer :: i

      do i = 0, n_parts
         xi(i) = -1.0_dp + 2.0_dp*i/n_parts
         value(i) = aside(slave, side, point, xi(i))
      end do
      allocate (places(0))
      do i = 1, n_parts
         if (value(i - 1)*value(i) > 0.0_dp .or. .not. abs(value(i)) > 0.0_dp .and. i == n_parts) cycle
         if (.not. abs(value(i - 1)) > 0.0_dp .and. i == 1) cycle
         places = [places, zero_between(slave, side, point, xi(i - 1), xi(i), value(i - 1), value(i))]
      end do
   end function places_facing

   !> The distance of a point from the ray of a local coordinate on the slave, times the length of the normal there;
   !> positive on one side, negative on the other [L].
   pure real(dp) function aside(slave, side, point, xi)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      real(dp), intent(in) :: point(2) !! the point [L]
      real(dp), intent(in) :: xi !! the place, from -1 to 1 [-]
      type(surface_place_t) :: place

      place = slave%place(side, xi)
      aside = cross_product(point - place%position, place%normal)
   end function aside

   !> The local coordinate between two others whose ray meets a point, by false position with the value at an unchanged
   !> end halved (Illinois); on a straight side with a constant normal the first step is exact [-].
   pure real(dp) function zero_between(slave, side, point, low, high, value_low, value_high) result(xi)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      real(dp), intent(in) :: point(2) !! the point [L]
      real(dp), intent(in) :: low !! the one place [-]
      real(dp), intent(in) :: high !! the other place [-]
      real(dp), intent(in) :: value_low !! value of `aside` there, of the opposite sign [L]
      real(dp), intent(in) :: value_high !! at the other place [L]
      integer, parameter :: most_steps = 60
      real(dp) :: a, b, f_a, f_b, f
      integer :: step

      a = low
      b = high
      f_a = value_low
      f_b = value_high
      xi = a
      if (.not. abs(f_a) > 0.0_dp) return
      do step = 1, most_steps
         xi = (a*f_b - b*f_a)/(f_b - f_a)
         f = aside(slave, side, point, xi)
         if (f*f_b < 0.0_dp) then
            a = b
            f_a = f_b
         else
            f_a = 0.5_dp*f_a
         end if
         if (.not. abs(f) > 0.0_dp .or. abs(b - xi) <= 2.0_dp*epsilon(1.0_dp)) return
         b = xi
         f_b = f
      end do
   end function zero_between

   !> Finds the intersection of the ray from a position on the slave with the master.
   pure type(meeting_t) function meet_master(master, near, place, search) result(nearest)
      type(surface_t), intent(in) :: master !! the master
      integer, intent(in) :: near(:) !! the sides to look at
      type(surface_place_t), intent(in) :: place !! the place on the slave
      real(dp), intent(in) :: search !! largest magnitude of a gap [L]
      type(meeting_t) :: meeting
      type(surface_place_t) :: foot
      real(dp) :: normal(2), xi(2)
      integer :: i, k

      normal = place%normal/norm2(place%normal)
      do i = 1, size(near)
         xi = meet_side(master%corner(:, :, near(i)), place%position, normal)
         do k = 1, 2
            ! Rays through a corner meet one of its sides.
            if (abs(xi(k)) > 1.0_dp + sum_rounding) cycle
            foot = master%place(near(i), xi(k))
            if (dot_product(foot%outward(), normal) > -steepest_cosine) cycle
            meeting = meeting_t(near(i), xi(k), dot_product(foot%position - place%position, normal))
            if (exceeds(abs(meeting%gap), search)) cycle
            if (nearest%side == 0 .or. abs(meeting%gap) < abs(nearest%gap)) nearest = meeting
         end do
      end do
   end function meet_master

   !> The local coordinates where a line meets a side: zeros of a quadratic polynomial; huge if there is none.
   pure function meet_side(corner, position, direction) result(xi)
      real(dp), intent(in) :: corner(2, 3) !! coordinates of first corner, second corner, middle [L]
      real(dp), intent(in) :: position(2) !! a point of the line [L]
      real(dp), intent(in) :: direction(2) !! its direction, a unit vector [-]
      real(dp) :: xi(2)
      real(dp) :: c(3), square, slope, root
      integer :: k

      c = [(cross_product(corner(:, k) - position, direction), k=1, 3)]
      square = 0.5_dp*(c(1) + c(2)) - c(3)
      slope = 0.5_dp*(c(2) - c(1))
      xi = huge(1.0_dp)
      if (max(abs(square), abs(slope)) <= difference_rounding*norm2(corner(:, 2) - corner(:, 1))) return
      if (abs(square) <= difference_rounding*abs(slope)) then
         xi(1) = -c(3)/slope
      else if (slope**2 >= 4.0_dp*square*c(3)) then
         root = -0.5_dp*(slope + sign(sqrt(slope**2 - 4.0_dp*square*c(3)), slope))
         xi(1) = root/square
         if (abs(root) > 0.0_dp) xi(2) = c(3)/root
      end if
   end function meet_side

end module amontons_surface
