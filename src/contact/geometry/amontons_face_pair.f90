!> Surfaces of faces in space: which faces of two of them face each other, and the integrals of the points of a pair.
!>
!> Both faces are projected on the mean plane of the slave's face along its normal and cut with each other (I. E.
!> Sutherland, G. W. Hodgman, Communications of the ACM 17, 1974). What both cover is integrated as a fan of triangles
!> about its centroid (M. A. Puso, T. A. Laursen, Comput. Meth. Appl. Mech. Eng. 193, 2004); the gap is the way along
!> that normal. The second integration, of the certificate, finds the faces of the slave from those of the master, and
!> cuts the latter by the former.
!>
!> Multipliers belong to the corners of the slave, of quadratic faces too. On each face their functions are dual to the
!> linear functions of the corners that are points, over what the master covers, and their sum is 1: they are
!> combinations of these functions, to which a corner that is no point gives its own. So it is on a rigid obstacle,
!> which covers each face as a whole.
module amontons_face_pair
   use amontons_boundary, only: patch_t
   use amontons_dense, only: lu_factor, lu_solve_transposed, vector_product
   use amontons_element, only: max_face_nodes, max_nodes, shape_functions
   use amontons_face, only: face_kind, face_t
   use amontons_frame, only: new_frame
   use amontons_kinds, only: dp
   use amontons_obstacle, only: cross_product, steepest_cosine, unit_vector
   use amontons_rounding, only: angle_rounding, difference_rounding, exceeds, input_rounding, sum_rounding
   use amontons_surface, only: gauss_rule, gauss_rule_t, is_on_mirror, meshed_body_t, mortar_points_t, &
      mortar_segment_t, most_aslant, sharp, sides_near, surface_t
   implicit none (type, external)
   private

   public :: covered_faces, find_face_segments, integrate_faces, last_of_side, new_face_surface

   !> Most corners of a face, and of a polygon that two faces cover.
   integer, parameter :: max_corners = 4, max_vertices = 2*max_corners

   !> The mean plane of a face.
   type :: plane_t
      real(dp) :: origin(3) = 0.0_dp !! the middle of the corners [L]
      real(dp) :: frame(3, 3) = 0.0_dp
         !! unit outward normal, and two axes of the plane, in which the corners go counterclockwise [-]
   contains
      procedure :: flat => plane_flat
   end type plane_t

   !> The quadrature points of what the master covers of a face.
   type :: samples_t
      integer :: n = 0 !! their number
      integer, allocatable :: start(:) !! the first one of each segment, and one beyond the last (segments + 1)
      real(dp), allocatable :: slave(:, :) !! shape functions of the slave's nodes (max_face_nodes, n) [-]
      real(dp), allocatable :: hats(:, :) !! linear functions of its corners (max_corners, n) [-]
      real(dp), allocatable :: master(:, :) !! shape functions of the master's nodes (max_face_nodes, n) [-]
      real(dp), allocatable :: position(:, :) !! coordinates on the slave (3, n) [L]
      real(dp), allocatable :: foot(:, :) !! coordinates on the master (3, n) [L]
      real(dp), allocatable :: area(:) !! the part of the slave's area that each stands for (n) [L^2]
      real(dp), allocatable :: share(:) !! its projection over that of the whole face (n) [-]
   end type samples_t

   !> What a face of the slave and one of the master cover.
   type :: facing_t
      integer :: master = 0 !! number of the face of the master
      integer :: n = 0 !! number of vertices
      real(dp) :: polygon(2, max_vertices) = 0.0_dp !! they in the mean plane of the slave's face, counterclockwise [L]
      real(dp) :: gap = 0.0_dp !! the way along the normal to the mean plane of the master's, from the centroid [L]
      logical :: counts = .true. !! whether no nearer face covers the same
   end type facing_t

contains

   !> Makes the surface of a boundary set in space. A corner has the mean normal of its faces; on planes of symmetry it
   !> has no component across them.
   pure subroutine new_face_surface(surface, body, patch, facing_nodes)
      type(surface_t), intent(out) :: surface !! the surface
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(patch_t), intent(in) :: patch !! the patch of the set
      integer, intent(in) :: facing_nodes(:) !! the nodes of the other body's set, none with a rigid obstacle
      real(dp) :: normal(3, body%mesh%n_nodes), mean(3)
      integer :: axis, i, k, n

      n = size(patch%faces)
      surface%n_sides = n
      allocate (surface%side(max_face_nodes + 1, n), surface%corner(3, max_face_nodes + 1, n), &
         surface%normal(3, max_corners + 1, n), surface%mirrored_node(0))
      normal(:, patch%node) = patch%normal
      do i = 1, patch%n_nodes
         associate (node => patch%node(i))
            do axis = 1, 3
               associate (held => body%constraints%frame(:, axis, node))
                  if (body%constraints%is_free(axis, node) .or. patch%ends(1, i) > 0) cycle
                  associate (across => abs(dot_product(held, normal(:, node))))
                     if (across <= input_rounding .or. across > most_aslant) cycle
                  end associate
                  if (.not. is_on_mirror(body, node, held, facing_nodes)) cycle
                  normal(:, node) = unit_vector(normal(:, node) - dot_product(held, normal(:, node))*held)
               end associate
            end do
         end associate
      end do
      do i = 1, n
         surface%side(:, i) = [patch%faces(i)%node, patch%faces(i)%element]
         associate (corner => surface%corner(:, :, i), nodes => patch%faces(i)%node, c => surface%n_corners(i))
            corner(:, :max_face_nodes) = body%mesh%coordinates(:, merge(nodes, nodes(1), nodes > 0))
            corner(:, max_face_nodes + 1) = sum(corner(:, :c), dim=2)/c
            mean = 0.0_dp
            do k = 1, c
               associate (middle => corner(:, max_face_nodes + 1), next => corner(:, 1 + modulo(k, c)))
                  surface%longest = max(surface%longest, norm2(next - corner(:, k)))
                  mean = mean + vector_product(corner(:, k) - middle, next - middle)
               end associate
            end do
            surface%normal(:, :, i) = spread(unit_vector(mean), 2, max_corners + 1)
            surface%normal(:, :c, i) = normal(:, nodes(:c))
            do k = 1, c
               ! Half the angle between two sides.
               if (dot_product(surface%normal(:, k, i), surface%normal(:, max_corners + 1, i)) &
                  < sqrt(0.5_dp*(1.0_dp + sharp))) surface%corner_node = nodes(k)
            end do
         end associate
      end do
      surface%material = body%materials%list(body%materials%of_element(surface%side(max_face_nodes + 1, :)))
      call surface%set_boxes()
   end subroutine new_face_surface

   !> Finds the faces of the master that each face of the slave faces, within reach along its normal. Of several that
   !> cover the same part the nearest counts.
   pure subroutine find_face_segments(segments, slave, master, search, is_again)
      type(mortar_segment_t), allocatable, intent(out) :: segments(:) !! the faces, ordered by those of the slave
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      real(dp), intent(in) :: search !! largest magnitude of a gap [L]
      logical, intent(in) :: is_again !! whether the master's faces are cut by the slave's
      type(facing_t), allocatable :: found(:)
      integer, allocatable :: near(:)
      real(dp) :: common(2, max_vertices)
      integer :: i, k, n, n_common, side

      allocate (segments(0))
      do side = 1, slave%n_sides
         near = sides_near(slave, side, master, search)
         allocate (found(size(near)))
         n = 0
         do k = 1, size(near)
            found(n + 1) = faces_of(slave, side, master, near(k), is_again)
            if (found(n + 1)%n > 0 .and. .not. exceeds(abs(found(n + 1)%gap), search)) n = n + 1
         end do
         do i = 1, n
            do k = 1, n
               if (.not. abs(found(k)%gap) < abs(found(i)%gap)) cycle
               associate (own => found(i)%polygon(:, :found(i)%n))
                  call clip(common, n_common, own, found(k)%polygon(:, :found(k)%n))
                  found(i)%counts = found(i)%counts .and. &
                     polygon_area(common(:, :n_common)) <= input_rounding*polygon_area(own)
               end associate
            end do
         end do
         segments = [segments, pack([(mortar_segment_t(side, found(k)%master, 0.0_dp), k=1, n)], found(:n)%counts)]
         deallocate (found)
      end do
   end subroutine find_face_segments

   !> What a face of the slave and one of the master cover, without vertices if that is rounding or they face the same
   !> way.
   pure type(facing_t) function faces_of(slave, side, master, other, is_again) result(facing)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its face
      type(surface_t), intent(in) :: master !! the master
      integer, intent(in) :: other !! number of its face
      logical, intent(in) :: is_again !! whether the master's face is cut by the slave's
      type(plane_t) :: plane, behind

      plane = mean_plane(slave, side)
      behind = mean_plane(master, other)
      facing%master = other
      associate (own => plane%flat(slave%corner(:, :slave%n_corners(side), side)), &
         cosine => dot_product(plane%frame(:, 1), behind%frame(:, 1)))
         if (cosine > -steepest_cosine) return
         call cut_faces(facing%polygon, facing%n, own, plane%flat(master%corner(:, :master%n_corners(other), other)), &
            is_again)
         if (polygon_area(facing%polygon(:, :facing%n)) <= sum_rounding*polygon_area(own)) facing%n = 0
         if (facing%n > 0) facing%gap = dot_product(behind%origin - plane%origin &
            - matmul(plane%frame(:, 2:), centroid(facing%polygon(:, :facing%n))), behind%frame(:, 1))/cosine
      end associate
   end function faces_of

   !> The mean plane of a face.
   pure type(plane_t) function mean_plane(surface, side) result(plane)
      type(surface_t), intent(in) :: surface !! the surface
      integer, intent(in) :: side !! number of the face

      plane = plane_t(surface%corner(:, max_face_nodes + 1, side), &
         new_frame(surface%normal(:, max_corners + 1, side), 3))
      plane%frame(:, 3) = vector_product(plane%frame(:, 1), plane%frame(:, 2))
   end function mean_plane

   !> The coordinates of points in a plane, by their projections (2, points) [L].
   pure function plane_flat(self, points) result(flat)
      class(plane_t), intent(in) :: self !! the plane
      real(dp), intent(in) :: points(:, :) !! the points (3, points) [L]
      real(dp) :: flat(2, size(points, 2))

      flat = matmul(transpose(self%frame(:, 2:)), points - spread(self%origin, 2, size(points, 2)))
   end function plane_flat

   !> The area of a polygon, its vertices counterclockwise; 0 of less than three [L^2].
   pure real(dp) function polygon_area(polygon) result(area)
      real(dp), intent(in) :: polygon(:, :) !! its vertices (2, vertices) [L]
      integer :: k

      area = 0.0_dp
      do k = 2, size(polygon, 2) - 1
         area = area + 0.5_dp*cross_product(polygon(:, k) - polygon(:, 1), polygon(:, k + 1) - polygon(:, 1))
      end do
   end function polygon_area

   !> The centroid of a polygon with an area [L].
   pure function centroid(polygon) result(middle)
      real(dp), intent(in) :: polygon(:, :) !! its vertices, counterclockwise (2, vertices) [L]
      real(dp) :: middle(2), area, total
      integer :: k

      middle = 0.0_dp
      total = 0.0_dp
      do k = 2, size(polygon, 2) - 1
         area = cross_product(polygon(:, k) - polygon(:, 1), polygon(:, k + 1) - polygon(:, 1))
         middle = middle + area*(polygon(:, k) + polygon(:, k + 1) - 2.0_dp*polygon(:, 1))/3.0_dp
         total = total + area
      end do
      middle = polygon(:, 1) + middle/total
   end function centroid

   !> The polygon that two faces cover in the plane of the slave's face. Curved edges count as straight.
   pure subroutine cut_faces(polygon, n, own, facing, is_again)
      real(dp), intent(out) :: polygon(2, max_vertices) !! its vertices, counterclockwise [L]
      integer, intent(out) :: n !! their number, 0 where the faces have nothing in common
      real(dp), intent(in) :: own(:, :) !! the projections of the corners of the slave's face (2, corners) [L]
      real(dp), intent(in) :: facing(:, :) !! those of the master's, clockwise (2, corners) [L]
      logical, intent(in) :: is_again !! whether the master's face is cut by the slave's
      real(dp) :: turned(2, size(facing, 2))
      integer :: k

      turned = facing(:, [(k, k=size(turned, 2), 1, -1)])
      if (is_again) then
         call clip(polygon, n, turned, own)
      else
         call clip(polygon, n, own, turned)
      end if
   end subroutine cut_faces

   !> Cuts a convex polygon by the edges of another one.
   pure subroutine clip(polygon, n, subject, by)
      real(dp), intent(out) :: polygon(2, max_vertices) !! what both cover [L]
      integer, intent(out) :: n !! number of its vertices, 0 if there is none
      real(dp), intent(in) :: subject(:, :) !! the polygon, counterclockwise (2, vertices) [L]
      real(dp), intent(in) :: by(:, :) !! the other one, counterclockwise (2, vertices) [L]
      real(dp) :: beyond(max_vertices), after(2, 2*max_vertices)
      integer :: edge, i, n_before, next

      n = size(subject, 2)
      polygon(:, :n) = subject
      do edge = 1, size(by, 2)
         n_before = n
         associate (first => by(:, edge), way => by(:, 1 + modulo(edge, size(by, 2))) - by(:, edge))
            do i = 1, n_before
               beyond(i) = cross_product(way, polygon(:, i) - first)
            end do
         end associate
         n = 0
         do i = 1, n_before
            next = 1 + modulo(i, n_before)
            if (beyond(i) >= 0.0_dp) then
               n = n + 1
               after(:, n) = polygon(:, i)
            end if
            if (.not. beyond(i)*beyond(next) < 0.0_dp) cycle
            n = n + 1
            after(:, n) = polygon(:, i) + beyond(i)/(beyond(i) - beyond(next))*(polygon(:, next) - polygon(:, i))
         end do
         ! An edge adds one vertex at the most to a convex polygon.
         n = min(n, max_vertices)
         polygon(:, :n) = after(:, :n)
      end do
   end subroutine clip

   !> Shape functions of a face at the place that a point of a plane is the projection of, by Newton's method.
   pure subroutine meet_face(values, slopes, xi, flat, point)
      real(dp), intent(out) :: values(max_nodes) !! shape functions [-]
      real(dp), intent(out) :: slopes(2, max_nodes) !! their derivatives by the reference coordinates [-]
      real(dp), intent(out) :: xi(2) !! the reference coordinates of the place [-]
      real(dp), intent(in) :: flat(:, :) !! the projections of the face's nodes (2, nodes) [L]
      real(dp), intent(in) :: point(2) !! the point [L]
      integer, parameter :: most_steps = 20
      real(dp) :: rest(2), jacobian(2, 2)
      integer :: n, step

      n = size(flat, 2)
      xi = merge(1.0_dp/3.0_dp, 0.0_dp, mod(n, 3) == 0)
      do step = 1, most_steps
         call shape_functions(face_kind(n), xi, values, slopes)
         rest = point - matmul(flat, values(:n))
         jacobian = matmul(flat, transpose(slopes(:, :n)))
         if (maxval(abs(rest)) <= difference_rounding*maxval(abs(flat))) exit
         xi = xi + [cross_product(rest, jacobian(:, 2)), cross_product(jacobian(:, 1), rest)] &
            /cross_product(jacobian(:, 1), jacobian(:, 2))
      end do
   end subroutine meet_face

   !> Whether a face is flat and its shape functions are polynomials in its plane, as those of a triangle or
   !> parallelogram with straight edges.
   pure logical function is_affine(surface, side)
      type(surface_t), intent(in) :: surface !! the surface
      integer, intent(in) :: side !! number of the face
      integer :: c, k

      c = surface%n_corners(side)
      associate (x => surface%corner(:, :, side), error => angle_rounding*surface%longest)
         is_affine = c == 3 .or. norm2(x(:, 1) - x(:, 2) + x(:, 3) - x(:, 4)) <= error
         do k = c + 1, surface%n_nodes(side)
            is_affine = is_affine .and. norm2(x(:, k) - 0.5_dp*(x(:, k - c) + x(:, 1 + modulo(k - c, c)))) <= error
         end do
      end associate
   end function is_affine

   !> Finds the quadrature points of what the master covers of a face of the slave: of each triangle those of a square
   !> of which one side is the vertex in the centroid, exact to degree 4 where both faces are affine, else to degree 8.
   pure subroutine sample_face(samples, rules, slave, master, segments, is_again)
      type(samples_t), intent(out) :: samples !! the points
      type(gauss_rule_t), intent(in) :: rules(2) !! the rules for both: of 3 and of 5 points
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      type(mortar_segment_t), intent(in) :: segments(:) !! the face of the slave, and each of the master that it faces
      logical, intent(in) :: is_again !! whether the master's faces are cut by the slave's
      integer, parameter :: most_points = 25
      type(plane_t) :: plane
      real(dp) :: polygon(2, max_vertices), middle(2), point(2), xi(2), values(max_nodes), slopes(2, max_nodes), &
         tangents(3, 2), area, at(2), part, whole
      real(dp), allocatable :: own(:, :), facing(:, :)
      integer :: c, i, k, n, place(2), q, side

      n = max_vertices*most_points*size(segments)
      allocate (samples%start(size(segments) + 1), samples%slave(max_face_nodes, n), samples%hats(max_corners, n), &
         samples%master(max_face_nodes, n), samples%position(3, n), samples%foot(3, n), samples%area(n), &
         samples%share(n))
      side = segments(1)%slave
      c = slave%n_corners(side)
      plane = mean_plane(slave, side)
      own = plane%flat(slave%corner(:, :slave%n_nodes(side), side))
      whole = polygon_area(own(:, :c))
      do i = 1, size(segments)
         associate (other => segments(i)%master, j => samples%n, &
            rule => rules(merge(1, 2, is_affine(slave, side) .and. is_affine(master, segments(i)%master))))
            samples%start(i) = j + 1
            facing = plane%flat(master%corner(:, :master%n_nodes(other), other))
            call cut_faces(polygon, n, own(:, :c), facing(:, :master%n_corners(other)), is_again)
            if (n < 3) cycle
            middle = centroid(polygon(:, :n))
            do k = 1, n
               associate (from => polygon(:, k) - middle, to => polygon(:, 1 + modulo(k, n)) - middle)
                  area = 0.5_dp*cross_product(from, to)
                  if (.not. area > 0.0_dp) cycle
                  do q = 1, size(rule%xi)**2
                     j = j + 1
                     place = [1 + (q - 1)/size(rule%xi), 1 + modulo(q - 1, size(rule%xi))]
                     at = 0.5_dp*(1.0_dp + rule%xi(place))
                     part = 0.5_dp*area*at(1)*product(rule%weight(place))
                     point = middle + at(1)*(from + at(2)*(to - from))
                     call meet_face(values, slopes, xi, facing, point)
                     samples%master(:, j) = values(:max_face_nodes)
                     samples%foot(:, j) = matmul(master%corner(:, :max_face_nodes, other), values(:max_face_nodes))
                     call meet_face(values, slopes, xi, own, point)
                     samples%slave(:, j) = values(:max_face_nodes)
                     samples%position(:, j) = matmul(slave%corner(:, :max_face_nodes, side), values(:max_face_nodes))
                     ! The area of the face over that of its projection.
                     tangents = matmul(slave%corner(:, :max_face_nodes, side), transpose(slopes(:, :max_face_nodes)))
                     samples%area(j) = part*norm2(vector_product(tangents(:, 1), tangents(:, 2))) &
                     /abs(dot_product(vector_product(tangents(:, 1), tangents(:, 2)), plane%frame(:, 1)))
                     samples%share(j) = part/whole
                     call shape_functions(face_kind(c), xi, values, slopes)
                     samples%hats(:, j) = values(:max_corners)
                  end do
               end associate
            end do
         end associate
      end do
      samples%start(i) = samples%n + 1
   end subroutine sample_face

   !> Takes the quadrature points of a face that a rigid obstacle covers.
   pure subroutine sample_whole(samples, face, n_corners)
      type(samples_t), intent(out) :: samples !! the points
      type(face_t), intent(in) :: face !! the face
      integer, intent(in) :: n_corners !! number of its corners

      samples%n = size(face%area)
      samples%start = [1, samples%n + 1]
      samples%position = face%position
      samples%foot = face%position
      samples%area = face%area
      allocate (samples%slave(max_face_nodes, samples%n), samples%hats(max_corners, samples%n), &
         samples%master(max_face_nodes, samples%n), source=0.0_dp)
      samples%slave(:face%n_nodes, :) = face%values
      samples%hats(:n_corners, :) = face%values(:n_corners, :)
      if (face%n_nodes == n_corners) return
      associate (middles => face%values(n_corners + 1:, :))
         samples%hats(:n_corners, :) = samples%hats(:n_corners, :) + 0.5_dp*(middles + cshift(middles, -1, dim=1))
      end associate
   end subroutine sample_whole

   !> The last of the segments of the same face of the slave as a given one.
   pure integer function last_of_side(segments, first) result(last)
      type(mortar_segment_t), intent(in) :: segments(:) !! the segments, side by side
      integer, intent(in) :: first !! the first one of the face

      do last = first, size(segments) - 1
         if (segments(last + 1)%slave /= segments(first)%slave) return
      end do
      last = size(segments)
   end function last_of_side

   !> The means of the linear functions of the corners of each face over the part of it that the master covers, times
   !> the covered share: their sum is this share (max_corners, faces) [-].
   pure function covered_faces(slave, master, segments) result(part)
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      type(mortar_segment_t), intent(in) :: segments(:) !! the faces that face each other, side by side
      real(dp) :: part(max_corners, slave%n_sides)
      type(samples_t) :: samples
      type(gauss_rule_t) :: rules(2)
      integer :: first, last

      rules = [gauss_rule(3), gauss_rule(5)]
      part = 0.0_dp
      first = 1
      do while (first <= size(segments))
         last = last_of_side(segments, first)
         call sample_face(samples, rules, slave, master, segments(first:last), .false.)
         part(:, segments(first)%slave) = matmul(samples%hats(:, :samples%n), samples%share(:samples%n))
         first = last + 1
      end do
   end function covered_faces

   !> Integrates D, M and gaps over the points of a pair, see `amontons_mortar_pair`. Gaps have the multipliers'
   !> functions for weights, as displacements have, so that curved surfaces meet where they are.
   pure subroutine integrate_faces(points, slave, master, segments, point_of, faces, is_again)
      type(mortar_points_t), intent(inout) :: points !! the points; gain the integrals, not yet over their areas
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      type(mortar_segment_t), intent(in) :: segments(:) !! the faces that face each other, side by side
      integer, intent(in) :: point_of(:, :)
         !! the point that each corner of each face is, 0 for none (max_corners, faces)
      type(face_t), intent(in) :: faces(:) !! the faces of the slave
      logical, intent(in) :: is_again !! whether the master's faces are cut by the slave's
      integer, parameter :: n_nodes = 2*max_face_nodes
      type(samples_t) :: samples
      type(gauss_rule_t) :: rules(2)
      real(dp), allocatable :: psi(:, :), shares(:)
      integer :: filled(size(points%area)), axis, first, i, k, last, p, side

      rules = [gauss_rule(3), gauss_rule(5)]
      filled = 0
      do i = 1, size(segments)
         do k = 1, max_corners
            p = point_of(k, segments(i)%slave)
            if (p > 0) filled(p) = filled(p) + 1
         end do
      end do
      call points%rows%begin(n_nodes*filled, 3)
      call points%quadrature%begin(spread(1, 1, size(filled)), 3)
      filled = 0
      first = 1
      do while (first <= size(segments))
         last = last_of_side(segments, first)
         side = segments(first)%slave
         if (any(point_of(:, side) > 0)) then
            if (segments(first)%master > 0) then
               call sample_face(samples, rules, slave, master, segments(first:last), is_again)
            else
               call sample_whole(samples, faces(side), slave%n_corners(side))
            end if
            call multiply_functions(psi, samples, point_of(:, side), slave%n_corners(side))
            do i = first, last
               do k = 1, max_corners
                  p = point_of(k, side)
                  if (p == 0) cycle
                  associate (begin => points%rows%start(p) + n_nodes*filled(p), from => samples%start(i - first + 1), &
                     to => samples%start(i - first + 2) - 1)
                     points%rows%node(begin:begin + max_face_nodes - 1) = slave%side(:max_face_nodes, side)
                     if (segments(i)%master > 0) points%rows%node(begin + max_face_nodes:begin + n_nodes - 1) = &
                        master%side(:max_face_nodes, segments(i)%master)
                     shares = [matmul(samples%slave(:, from:to), psi(k, from:to)), &
                        -matmul(samples%master(:, from:to), psi(k, from:to))]
                     do axis = 1, 3
                        points%rows%block(axis, axis, begin:begin + n_nodes - 1) = shares
                     end do
                     points%area(p) = points%area(p) + sum(psi(k, from:to))
                     points%center(:, p) = points%center(:, p) + matmul(samples%position(:, from:to), psi(k, from:to))
                     points%foot(:, p) = points%foot(:, p) + matmul(samples%foot(:, from:to), psi(k, from:to))
                     points%quadrature%gap(p) = points%quadrature%gap(p) + dot_product(psi(k, from:to), &
                        matmul(slave%normal(:, max_corners + 1, side), samples%foot(:, from:to) &
                        - samples%position(:, from:to)))
                  end associate
                  filled(p) = filled(p) + 1
               end do
            end do
         end if
         first = last + 1
      end do
      points%length = points%area
      points%quadrature%share = points%area
      points%quadrature%outward = 1.0_dp
      points%quadrature%gap = points%quadrature%gap/points%area
      points%quadrature%position = points%center/spread(points%area, 1, 3)
   end subroutine integrate_faces

   !> The multipliers' functions of the corners of a face that are points, times the area, at its quadrature points.
   !> They are dual to the linear functions B of these corners, and combinations of these and of what the other corners
   !> give to the points beside them.
   pure subroutine multiply_functions(psi, samples, point, n_corners)
      real(dp), allocatable, intent(out) :: psi(:, :) !! the functions (max_corners, samples) [L^2]
      type(samples_t), intent(in) :: samples !! the quadrature points
      integer, intent(in) :: point(:) !! the points that the corners are, 0 for none (max_corners)
      integer, intent(in) :: n_corners !! number of corners of the face
      real(dp) :: given(max_corners, max_corners)
      real(dp), allocatable :: hat(:, :), mass(:, :), inverse(:, :)
      integer, allocatable :: own(:), beside(:), pivots(:)
      integer :: i, info, k

      own = pack([(k, k=1, n_corners)], point(:n_corners) > 0)
      given = 0.0_dp
      do k = 1, n_corners
         beside = 1 + modulo([k - 2, k], n_corners)
         beside = pack(beside, point(beside) > 0)
         if (size(beside) == 0) beside = own
         if (point(k) > 0) beside = [k]
         given(beside, k) = 1.0_dp/size(beside)
      end do
      associate (n => samples%n)
         hat = matmul(given, samples%hats(:, :n))
         do i = 1, n
            hat(:, i) = samples%area(i)*hat(:, i)
         end do
         ! The transpose of the matrix of the integrals of both kinds of functions, each column over that of B.
         mass = matmul(samples%hats(own, :n), transpose(hat(own, :)))
         do k = 1, size(own)
            mass(k, :) = mass(k, :)/dot_product(samples%hats(own(k), :n), samples%area(:n))
         end do
         allocate (inverse(size(own), size(own)), source=0.0_dp)
         do k = 1, size(own)
            inverse(k, k) = 1.0_dp
         end do
         call lu_factor(mass, pivots, info)
         psi = 0.0_dp*hat
         if (info /= 0) return
         call lu_solve_transposed(mass, pivots, inverse)
         psi(own, :) = matmul(inverse, hat(own, :))
      end associate
   end subroutine multiply_functions

end module amontons_face_pair
