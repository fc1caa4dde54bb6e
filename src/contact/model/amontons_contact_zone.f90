!> The contact zone: the contact points with their normals and areas. A point is a node, or a cell of constant
!> multipliers. And the rows of pairs, integrated a second time by another rule for the certificate: there the ends of
!> segments are found by bisection between rays that meet different sides, and the quadrature has other points. A
!> segment counts if its middle is within reach, as in the first integration.
module amontons_contact_zone
   use amontons_boundary, only: corner_share, new_patch, patch_t
   use amontons_constraints, only: constraints_t, substitution_t
   use amontons_contact_cells, only: choose_cells, contact_cells_t, new_contact_cells
   use amontons_contact_rows, only: contact_quadrature_t, contact_rows_t, picked_places
   use amontons_contact_set, only: contact_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face_pair, only: find_face_segments
   use amontons_frame, only: new_frames
   use amontons_kinds, only: dp
   use amontons_line, only: line_t
   use amontons_mortar_pair, only: integrate_pair, mortar_pair_t, mortar_points_t, new_mortar_pair, new_slave_alone, &
      take_facing_sides
   use amontons_moved_pair, only: new_moved_pair
   use amontons_obstacle, only: unit_vector
   use amontons_pair_checks, only: check_ends, check_overlap, guided_alone
   use amontons_surface, only: find_segments_again, meshed_body_t, mortar_segment_t
   use amontons_taken, only: taken_t
   implicit none (type, external)
   private

   public :: contact_zone_t, let_guided_slaves_slip, mean_gap, new_contact_zone, &
      recompute_pairs, segments_again, set_moved

   !> The contact points of all contact sets, each set in the order of its patch.
   type :: contact_zone_t
      integer :: n_points = 0 !! number m of contact points
      integer :: n_tangents = 1 !! number of tangential directions of a point; 2 in a twisted body and in space
      integer :: n_rows = 0 !! number of rows of C: (1 + n_tangents) m
      logical, allocatable :: is_own(:)
         !! whether the displacement of the point is made of the own unknowns of one node, and no other point's is (m)
      integer, allocatable :: node(:) !! these nodes, one for each of these points
      integer, allocatable :: mean_point(:)
         !! points on rigid obstacles whose displacement is a mean of that of their node and of others (any)
      logical, allocatable :: is_cell(:) !! whether the point is a cell of constant multipliers; a node otherwise (m)
      type(contact_rows_t) :: rows !! the nodes' shares in the displacements of the points
      type(contact_quadrature_t) :: quadrature !! points where gaps and friction are evaluated
      real(dp), allocatable :: position(:, :) !! coordinates of the node or of the center of the cell (n_dim, m) [L]
      real(dp), allocatable :: acting(:, :) !! where the force acts: mean place of the point on the body (n_dim, m) [L]
      real(dp), allocatable :: foot(:, :)
         !! mean position on the other body of a pair, `acting` without one (n_dim, m) [L]
      type(mortar_pair_t), allocatable :: pairs(:) !! the surfaces of each contact set that is paired (contact sets)
      integer, allocatable :: set(:) !! which contact set the point belongs to (m)
      type(line_t), allocatable :: line !! how the points follow each other; not allocated in space
      real(dp), allocatable :: frame(:, :, :)
         !! unit normal towards the obstacle and tangents, as columns (1 + n_tangents, 1 + n_tangents, m) [-]
      real(dp), allocatable :: weight(:) !! tributary length, or length of the cell (m) [L]
      real(dp), allocatable :: area(:) !! tributary area, or that of the cell: length times depth of the body (m) [L^2]
      logical, allocatable :: is_fixed(:, :) !! whether supports bear its shear along each tangent (n_tangents, m)
      integer, allocatable :: held_node(:)
         !! contact nodes on rigid obstacles that are no points since supports hold them, or hold them along the normal
      integer, allocatable :: held_set(:) !! the contact set of each
      real(dp), allocatable :: held_normal(:, :) !! its unit normal, towards the obstacle (2, any) [-]
      real(dp), allocatable :: held_arc_length(:) !! length along the line up to it (any) [L]
      integer, allocatable :: shared_node(:)
         !! nodes between two contact sets that are points of the set named first alone
      integer, allocatable :: passed_point(:, :)
         !! contact sets whose line continues that of an earlier set, and the point between the two (2, any)
      integer, allocatable :: zero_area_node(:) !! contact nodes that are no points since they have no area
      integer :: n_held_cells = 0 !! number of cells that are no points since supports hold all their nodes
   contains
      procedure :: free_slips => contact_zone_free_slips
      procedure :: global_vectors => contact_zone_global_vectors
      procedure :: last_own_part => contact_zone_last_own_part
      procedure :: nodal_forces => contact_zone_nodal_forces
      procedure :: normal => contact_zone_normal
      procedure :: own_nodes => contact_zone_own_nodes
   end type contact_zone_t

contains

   !> Collects the contact points. A node that supports hold completely, or along the contact normal, is no point; nor
   !> is one whose sides lie on the axis of revolution, where no pressure acts. A corner of two rigid obstacles is a
   !> point of each; of a slave and an earlier set it is one of the latter alone.
   subroutine new_contact_zone(zone, body, contacts, error, tied)
      type(contact_zone_t), intent(out) :: zone !! the points
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(error_t), allocatable, intent(out) :: error !! a missing set, or no point at all
      type(taken_t), intent(in), optional :: tied !! what ties have; nothing without it
      type(taken_t) :: taken
      integer :: nothing(0), i, k, n_dim

      zone%n_tangents = body%materials%n_components() - 1
      n_dim = size(body%mesh%coordinates, 1)
      allocate (zone%node(0), zone%set(0), zone%held_node(0), zone%held_set(0), zone%held_normal(n_dim, 0), &
         zone%held_arc_length(0), zone%shared_node(0), zone%zero_area_node(0), zone%passed_point(2, 0), &
         zone%mean_point(0), zone%is_own(0), zone%is_cell(0), zone%position(n_dim, 0), zone%acting(n_dim, 0), &
         zone%foot(n_dim, 0), zone%weight(0), zone%area(0), zone%is_fixed(zone%n_tangents, 0), &
         zone%frame(1 + zone%n_tangents, 1 + zone%n_tangents, 0))
      call zone%rows%begin(nothing, 1 + zone%n_tangents)
      call zone%quadrature%begin(nothing, n_dim)
      allocate (zone%pairs(size(contacts)))
      if (size(body%mesh%coordinates, 1) == 2) then
         allocate (zone%line)
         allocate (zone%line%next(0))
      end if
      call taken%begin(body%mesh)
      if (present(tied)) taken = tied
      do i = 1, size(contacts)
         taken%is_slave_again = any([(contacts(k)%set == contacts(i)%set, k=i + 1, size(contacts))])
         if (contacts(i)%pairing%is_pair() .and. contacts(i)%slides_far()) then
            call add_moved_pair(zone, i, contacts(i), body, error)
         else if (contacts(i)%pairing%is_pair()) then
            call add_pair(zone, i, contacts(i), body, taken, error)
         else
            call add_set(zone, i, contacts(i), body, taken, error)
         end if
         if (.not. allocated(error)) cycle
         error%message = contacts(i)%origin//error%message
         return
      end do
      zone%n_rows = (1 + zone%n_tangents)*zone%n_points
      if (size(contacts) == 0 .or. zone%n_points > 0) return
      if (size(zone%zero_area_node) > 0) then
         call new_error(error, input_refused, contacts(1)%origin//'the contact set lies on the axis of revolution, '// &
            'where no pressure can act')
      else
         call new_error(error, input_refused, contacts(1)%origin// &
            'supports hold every contact node; nothing is left that could come into contact')
      end if
   end subroutine new_contact_zone

   !> Adds the points of a set that faces a rigid obstacle.
   subroutine add_set(zone, set, contact, body, taken, error)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set
      type(contact_t), intent(in) :: contact !! the contact set
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(taken_t), intent(inout) :: taken !! what earlier sets have; gains what this one has
      type(error_t), allocatable, intent(out) :: error !! a missing set, or nothing is left of it
      type(patch_t) :: patch
      real(dp), allocatable :: normal(:, :)
      integer :: i

      call new_patch(patch, body%mesh, contact%set, error, body%materials, taken%face)
      if (allocated(error)) return
      normal = patch%normal
      if (any(abs(contact%direction) > 0.0_dp)) normal = spread(unit_vector(contact%direction(:size(normal, 1))), 2, &
         patch%n_nodes)
      if (contact%partition%is_constant) then
         call add_cells(zone, set, contact, patch, body, error)
      else if (3*merge(patch%n_nodes, 0, any(patch%ends > 0)) > contact%partition%most_nodal .and. &
         .not. contact%slides_far()) then
         call add_corners(zone, set, normal, patch, body, taken)
      else
         call add_nodes(zone, set, normal, patch, body, taken)
      end if
      if (all(zone%set /= set) .and. all(taken%node(patch%node))) call new_error(error, input_refused, &
         'every node of this contact set belongs to an earlier one; a set meets one obstacle: split its curve '// &
         'where the other begins, or draw both as one polyline')
      do i = 1, size(patch%faces)
         call taken%add(patch%faces(i), patch%faces(i)%node, is_whole=.true.)
      end do
   end subroutine add_set

   !> Finds the corners of slaves that supports guide, or hold around the axis, but at which friction acts since the
   !> master may slip; and lists the slips that supports fix.
   !>
   !> The part of the slave's displacement that a support prescribes is known, so that the tangential row of the point
   !> acts on unknowns of the master. It must be independent of the rows of the other points, which it is not if
   !> supports hold the master as well. On a plane of symmetry at which both bodies end the shear is 0.
   pure subroutine let_guided_slaves_slip(zone, constraints, substitution)
      type(contact_zone_t), intent(inout) :: zone !! the contact points
      type(constraints_t), intent(in) :: constraints !! the supports
      type(substitution_t), intent(in) :: substitution !! displacements of the nodes in terms of their own unknowns
      ! Smallest share of the shear that the master bears; below it supports bear the shear.
      real(dp), parameter :: least_share = 1.0e-2_dp
      real(dp), allocatable :: row(:, :), rest(:), basis(:, :), transform(:, :)
      integer, allocatable :: points(:), own(:), parts(:)
      real(dp) :: whole
      logical :: is_alone(zone%n_points, zone%n_tangents)
      integer :: i, j, k, n, p, place, tangent

      n = 1 + zone%n_tangents
      do tangent = 1, zone%n_tangents
         is_alone(:, tangent) = is_guided_alone(zone, constraints, tangent)
      end do
      own = substitution%element_nodes(zone%rows%node(picked_places(zone%rows%start, &
         pack([(p, p=1, zone%n_points)], any(is_alone, dim=2)))))
      row = spread(spread(0.0_dp, 1, n), 2, size(own))
      basis = reshape(row(:, :0), [size(row), 0])
      do tangent = 1, zone%n_tangents
         points = pack([(p, p=1, zone%n_points)], is_alone(:, tangent))
         do k = 1, size(points)
            p = points(k)
            row = 0.0_dp
            whole = 0.0_dp
            do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
               whole = hypot(whole, norm2(zone%rows%block(:, 1 + tangent, i)))
               parts = substitution%element_nodes(zone%rows%node(i:i))
               transform = substitution%transform(zone%rows%node(i:i), parts, 1, n)
               do j = 1, size(parts)
                  ! The own unknowns of points are their relative displacements, those of bonded nodes none.
                  if (any(zone%node == parts(j))) cycle
                  if (any(substitution%is_bonded(2*tangent - 1:1 + tangent, parts(j)))) cycle
                  place = findloc(own, parts(j), dim=1)
                  row(:, place) = row(:, place) + matmul(matmul(zone%rows%block(:, 1 + tangent, i), &
                     transform(:, n*(j - 1) + 1:n*j)), constraints%free_projector(parts(j)))
               end do
            end do
            rest = reshape(row, [size(row)])
            rest = rest - matmul(basis, matmul(rest, basis))
            if (norm2(rest) < least_share*whole) cycle
            basis = reshape([basis, rest/norm2(rest)], [size(row), size(basis, 2) + 1])
            zone%is_fixed(tangent, p) = .false.
            zone%is_own(p) = .false.
         end do
      end do
   end subroutine let_guided_slaves_slip

   !> Whether each point is a corner of a slave that supports guide, except where its master ends on the same plane of
   !> symmetry; or one that they hold around the axis, unless it is on the axis: both bodies end there, too.
   pure function is_guided_alone(zone, constraints, tangent) result(is_alone)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: tangent !! which of the tangential displacements supports prescribe
      logical :: is_alone(zone%n_points)
      ! Rounding error of a position on a plane in mesh files, over the longest side.
      real(dp), parameter :: rounding = 1.0e-4_dp
      real(dp) :: held(2)
      integer :: p, i, k

      is_alone = .false.
      do i = 1, merge(0, size(zone%pairs), allocated(zone%line))
         if (zone%pairs(i)%is_set()) is_alone(pack([(p, p=1, zone%n_points)], zone%set == i)) = &
            guided_alone(zone%pairs(i), constraints)
      end do
      is_alone = is_alone .and. zone%is_fixed(tangent, :)
      do p = 1, merge(zone%n_points, 0, allocated(zone%line))
         associate (pair => zone%pairs(zone%set(p)))
            is_alone(p) = zone%is_fixed(tangent, p) .and. &
               .not. zone%is_cell(p) .and. pair%is_set() .and. .not. allocated(pair%shear_fault)
            if (tangent == 2) is_alone(p) = is_alone(p) .and. zone%position(1, p) > rounding*pair%master%longest
            if (.not. is_alone(p) .or. tangent == 2) cycle
            associate (node => pair%node(p - findloc(zone%set, zone%set(p), dim=1) + 1))
               if (all(pair%slave%mirrored_node /= node)) cycle
               held = constraints%held_direction(node)
            end associate
            do i = 1, pair%master%n_sides
               do k = 1, 2
                  associate (node => pair%master%side(k, i))
                     if (any(pair%master%mirrored_node == node) .and. .not. constraints%leaves_free(node, held)) then
                        is_alone(p) = is_alone(p) .and. abs(dot_product(held, pair%master%corner(:, k, i) &
                        - zone%position(:, p))) > rounding*pair%master%longest
                     end if
                  end associate
               end do
            end do
         end associate
      end do
   end function is_guided_alone

   !> The slips of the points along their tangents; 0 where a support bears the shear (n_rows - m) [L].
   pure function contact_zone_free_slips(self, slip) result(free)
      class(contact_zone_t), intent(in) :: self !! the contact points
      real(dp), intent(in) :: slip(:) !! the slips, those that supports prescribe among them (n_rows - m) [L]
      real(dp) :: free(size(slip))

      free = merge(0.0_dp, slip, [transpose(self%is_fixed)])
   end function contact_zone_free_slips

   !> Vectors of the points from their components along normals and tangents (components, m).
   pure function contact_zone_global_vectors(self, components) result(vectors)
      class(contact_zone_t), intent(in) :: self !! the contact points
      real(dp), intent(in) :: components(:) !! the normal ones, then the tangential ones (n_rows)
      real(dp) :: vectors(1 + self%n_tangents, self%n_points)
      integer :: p

      do p = 1, self%n_points
         vectors(:, p) = matmul(self%frame(:, :, p), components(p::self%n_points))
      end do
   end function contact_zone_global_vectors

   !> The last part of a point whose node has results of the point: in space that of the node itself, since the shares
   !> of others are negative.
   pure integer function contact_zone_last_own_part(self, point) result(last)
      class(contact_zone_t), intent(in) :: self !! the contact points
      integer, intent(in) :: point !! the point

      last = self%rows%start(point + 1) - 1
      if (.not. allocated(self%line)) last = self%rows%start(point)
   end function contact_zone_last_own_part

   !> The unit normal of a point, towards the obstacle (n_dim) [-].
   pure function contact_zone_normal(self, point) result(normal)
      class(contact_zone_t), intent(in) :: self !! the contact points
      integer, intent(in) :: point !! the point
      real(dp) :: normal(size(self%position, 1))

      normal = self%frame(:size(normal), 1, point)
   end function contact_zone_normal

   !> The contact forces on the nodes of the points, along their normals and tangents. Of pairs that slide far these are
   !> other numbers than the multipliers, whose functions are hats: over the areas they are the smoother pressures
   !> (n_rows) [F].
   pure function contact_zone_nodal_forces(self, force) result(nodal)
      class(contact_zone_t), intent(in) :: self !! the contact points
      real(dp), intent(in) :: force(:) !! the multipliers (lambda_N; lambda_T) (n_rows) [F]
      real(dp) :: nodal(size(force))
      real(dp) :: vectors(1 + self%n_tangents, self%n_points), share
      integer :: of_node(2, 0:maxval([0, self%rows%node])), i, k, p, set

      nodal = force
      do set = 1, size(self%pairs)
         if (.not. allocated(self%pairs(set)%carrier)) cycle
         associate (pair => self%pairs(set), first => findloc(self%set, set, dim=1) - 1)
            ! The points of each node; a middle node counts half for either corner of its side.
            of_node = 0
            do i = 1, pair%slave%n_sides
               associate (points => first + pair%point_of(:, i))
                  of_node(:, min(ubound(of_node, 2), pair%slave%side(3, i))) = points
                  do k = 1, 2
                     if (pair%slave%side(k, i) <= ubound(of_node, 2)) of_node(:, pair%slave%side(k, i)) = points(k)
                  end do
               end associate
            end do
            of_node(:, 0) = 0
            vectors = 0.0_dp
            do p = first + 1, first + size(pair%node)
               do i = self%rows%start(p), self%rows%start(p + 1) - 1
                  share = dot_product(self%rows%block(:, 1, i), self%frame(:, 1, p))
                  do k = 1, 2
                     associate (q => of_node(k, self%rows%node(i)))
                        if (q > 0) vectors(:, q) = vectors(:, q) + 0.5_dp*share*matmul(self%frame(:, :, p), &
                           force(p::self%n_points))
                     end associate
                  end do
               end do
            end do
            do p = first + 1, first + size(pair%node)
               nodal(p::self%n_points) = matmul(vectors(:, p), self%frame(:, :, p))
            end do
         end associate
      end do
   end function contact_zone_nodal_forces

   !> The nodes whose unknowns contribute to the displacements of the points.
   pure function contact_zone_own_nodes(self, substitution) result(own)
      class(contact_zone_t), intent(in) :: self !! the contact points
      type(substitution_t), intent(in) :: substitution !! displacements of the nodes in terms of their own unknowns
      integer, allocatable :: own(:)
      integer :: p

      own = substitution%element_nodes(self%rows%node(picked_places(self%rows%start, &
         pack([(p, p=1, self%n_points)], .not. self%is_own))))
      own = [self%node, pack(own, [(all(self%node /= own(p)), p=1, size(own))])]
   end function contact_zone_own_nodes

   !> Appends the contact points of one set to the zone.
   pure subroutine add_points(zone, set, is_cell, points)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set that they belong to
      logical, intent(in) :: is_cell !! whether they are cells of constant multipliers
      type(contact_zone_t), intent(in) :: points
         !! the points; their line counts among them, nodes that are no points are left out
      integer :: n

      n = size(points%area)
      zone%set = [zone%set, spread(set, 1, n)]
      if (allocated(zone%line)) zone%line%next = [zone%line%next, merge(zone%n_points + points%line%next, 0, &
         points%line%next > 0)]
      zone%n_points = zone%n_points + n
      zone%is_cell = [zone%is_cell, spread(is_cell, 1, n)]
      zone%is_own = [zone%is_own, points%is_own]
      zone%is_fixed = reshape([zone%is_fixed, points%is_fixed], [zone%n_tangents, zone%n_points])
      zone%position = reshape([zone%position, points%position], [size(zone%position, 1), zone%n_points])
      zone%acting = reshape([zone%acting, points%acting], shape(zone%position))
      zone%foot = reshape([zone%foot, points%acting], shape(zone%position))
      if (allocated(points%foot)) zone%foot(:, zone%n_points - n + 1:) = points%foot
      zone%frame = reshape([zone%frame, points%frame], [shape(zone%frame(:, :, 1)), zone%n_points])
      zone%weight = [zone%weight, points%weight]
      zone%area = [zone%area, points%area]
      call zone%rows%add(points%rows)
      call zone%quadrature%add(points%quadrature)
   end subroutine add_points

   !> Adds the nodes of a patch as points.
   !>
   !> If the patch continues that of an earlier set, the pressure at the node between them acts on the faces of both. A
   !> corner, where the law of the earlier set has another direction, is a point of either set.
   !>
   !> A corner of a quadratic side on the axis of revolution has no area, since pressures do no work on its shape
   !> function N_a. With a share of that of the middle node, N_a + alpha N_b and (1 - alpha) N_b, both have one: the
   !> first unknown is the displacement of the corner, the second is (u_b - alpha u_a) / (1 - alpha) in place of u_b. On
   !> quadratic faces in space all corners take a share from all middle nodes beside them (`amontons_boundary`): these
   !> have (u_b - alpha (u_a + u_c)) / (1 - 2 alpha).
   pure subroutine add_nodes(zone, set, normal, patch, body, taken)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set
      real(dp), intent(in) :: normal(:, :) !! unit normals of its nodes, along which gaps count (n_dim, n_nodes) [-]
      type(patch_t), intent(in) :: patch !! its patch
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(taken_t), intent(in) :: taken !! what earlier sets have
      type(contact_zone_t) :: points
      real(dp) :: area(patch%n_nodes), arc_length(patch%n_nodes)
      integer :: point_of(0:patch%n_nodes), kept(patch%n_nodes), corner(patch%n_nodes)
      integer :: i, k, n, n_corners
      integer, allocatable :: own(:), place(:), stand_in(:), beside(:)
      real(dp), allocatable :: share(:)
      logical :: is_own, points_are_own(patch%n_nodes), has_all_beside(patch%n_nodes)

      point_of = 0
      n = 0
      n_corners = 0
      has_all_beside = taken%has_all_beside(patch)
      arc_length = 0.0_dp
      if (allocated(patch%line)) arc_length = patch%line%arc_length
      area = bearing_areas(patch)
      do k = 1, patch%n_nodes
         associate (node => patch%node(k))
            is_own = .not. taken%node(node) .and. body%constraints%rigid_of(node) == 0
            i = 0
            if (taken%node(node)) i = point_before(zone, node, normal(:, k))
            if (has_all_beside(k) .or. i > 0) zone%shared_node = [zone%shared_node, node]
            if (has_all_beside(k)) cycle
            if (i > 0) then
               zone%weight(i) = zone%weight(i) + patch%weight(k)
               zone%area(i) = zone%area(i) + patch%area(k)
               zone%passed_point = reshape([zone%passed_point, set, i], shape(zone%passed_point) + [0, 1])
            else if (.not. body%constraints%leaves_free(node, normal(:, k))) then
               zone%held_node = [zone%held_node, node]
               zone%held_set = [zone%held_set, set]
               zone%held_normal = reshape([zone%held_normal, normal(:, k)], [size(normal, 1), size(zone%held_node)])
               zone%held_arc_length = [zone%held_arc_length, arc_length(k)]
            else if (.not. abs(area(k)) > 0.0_dp .or. (area(k) < 0.0_dp .and. .not. is_own)) then
               zone%zero_area_node = [zone%zero_area_node, node]
            else
               n = n + 1
               kept(n) = k
               point_of(k) = n
               points_are_own(n) = is_own
               if (area(k) > 0.0_dp) cycle
               n_corners = n_corners + 1
               corner(n_corners) = k
            end if
         end associate
      end do
      ! The point that represents each corner, and the nodes that each point represents.
      allocate (stand_in(n_corners))
      do i = 1, n_corners
         beside = patch%line%beside(corner(i))
         stand_in(i) = maxval(point_of(beside))
      end do
      zone%mean_point = [zone%mean_point, zone%n_points + pack([(i, i=1, n)], [(any(stand_in == i) .or. &
         (patch%ends(1, kept(i)) > 0 .and. points_are_own(i)), i=1, n)])]
      call share_areas(points, place, share, patch, area, kept(:n), corner(:n_corners), stand_in)
      own = [(spread(i, 1, points%rows%start(i + 1) - points%rows%start(i)), i=1, n)]
      if (allocated(patch%line)) then
         allocate (points%line)
         points%line%next = point_of(patch%line%next(kept(:n)))
      end if
      points%is_own = points_are_own(:n)
      points%frame = body%constraints%contact_frames(patch%node(kept(:n)), normal(:, kept(:n)))
      points%is_fixed = body%constraints%fixed_tangents(patch%node(kept(:n)), points%frame)
      points%position = body%mesh%coordinates(:, patch%node(kept(:n)))
      points%rows%node = patch%node(place)
      points%rows%block = points%frame(:, :, own)
      do i = 1, size(own)
         points%rows%block(:, :, i) = points%rows%block(:, :, i)*share(i)
      end do
      call set_nodal_quadrature(points, patch, normal, place, share, body%mesh%coordinates)
      points%area = abs(points%area) + patch%bare_area(kept(:n))
      zone%node = [zone%node, pack(patch%node(kept(:n)), points%is_own)]
      call add_points(zone, set, .false., points)
   end subroutine add_nodes

   !> Sets the nodes of each point as the places where its gap is measured, and the mean of these as that where its
   !> force acts.
   pure subroutine set_nodal_quadrature(points, patch, normal, place, share, coordinates)
      type(contact_zone_t), intent(inout) :: points !! the points, their rows made; gain quadrature and places
      type(patch_t), intent(in) :: patch !! the patch
      real(dp), intent(in) :: normal(:, :) !! unit normals of its nodes, towards the obstacle (n_dim, n_nodes) [-]
      integer, intent(in) :: place(:) !! the node of each part, by its place in the patch (parts)
      real(dp), intent(in) :: share(:) !! its share in the displacement of the point (parts) [-]
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes of the mesh (n_dim, any) [L]
      integer :: p

      points%quadrature = contact_quadrature_t(start=points%rows%start, &
         position=coordinates(:, points%rows%node), normal=normal(:, place), &
         outward=sum(normal(:, place)*patch%normal(:, place), dim=1), arc_length=spread(0.0_dp, 1, size(place)), &
         gap=spread(0.0_dp, 1, size(place)), share=share)
      if (allocated(patch%line)) points%quadrature%arc_length = patch%line%arc_length(place)
      points%acting = points%position
      do p = 1, size(points%acting, 2)
         associate (first => points%rows%start(p), last => points%rows%start(p + 1) - 1)
            points%acting(:, p) = matmul(points%quadrature%position(:, first:last), share(first:last))
         end associate
      end do
   end subroutine set_nodal_quadrature

   !> The areas of the nodes of a patch; that of a corner on the axis is its negative share in the middle node beside
   !> it.
   pure function bearing_areas(patch) result(area)
      type(patch_t), intent(in) :: patch !! the patch
      real(dp) :: area(patch%n_nodes)
      ! Rounding error of an area of 0, over the largest one; next to the axis the area may even be negative.
      real(dp), parameter :: negligible = 1.0e-12_dp
      integer, allocatable :: beside(:)
      integer :: k

      area = merge(patch%area, 0.0_dp, patch%area > negligible*maxval(patch%area))
      do k = 1, patch%n_nodes
         if (area(k) > 0.0_dp .or. .not. allocated(patch%line)) cycle
         ! The share of a corner on the axis is negative among the terms of the middle node beside it: with this one the
         ! pressure on the axis is exact where it is a quadratic function of the radius.
         beside = patch%line%beside(k)
         area(k) = min(0.0_dp, sum(max(area(beside), 0.0_dp)*patch%moment(k)/max(patch%moment(beside), tiny(1.0_dp))))
      end do
   end function bearing_areas

   !> Finds the nodes whose displacements make up those of the points, with their shares, and the areas of the points.
   pure subroutine share_areas(points, place, share, patch, area, kept, corner, stand_in)
      type(contact_zone_t), intent(inout) :: points !! the points; gain weights, areas and the places of their parts
      integer, allocatable, intent(out) :: place(:) !! the node of each part, by its place in the patch (parts)
      real(dp), allocatable, intent(out) :: share(:) !! its share; those of a point sum to 1 (parts) [-]
      type(patch_t), intent(in) :: patch !! the patch
      real(dp), intent(in) :: area(:) !! areas of its nodes, of a corner on the axis a negative share (n_nodes) [L^2]
      integer, intent(in) :: kept(:) !! places of the points' nodes in the patch (points)
      integer, intent(in) :: corner(:) !! those of the corners on the axis (corners)
      integer, intent(in) :: stand_in(:) !! the point that represents each, too (corners)
      integer :: i, n

      n = size(kept)
      allocate (place(n + count(stand_in > 0) + count(patch%ends(:, kept) > 0)))
      allocate (share(size(place)), points%rows%start(n + 1), points%weight(n), points%area(n))
      points%rows%start(1) = 1
      do i = 1, n
         associate (first => points%rows%start(i), last => points%rows%start(i + 1), node => kept(i))
            last = first + count(stand_in == i) + count(patch%ends(:, node) > 0)
            place(first:last) = [node, pack(corner, stand_in == i), pack(patch%ends(:, node), patch%ends(:, node) > 0)]
            if (patch%ends(1, node) > 0) then
               points%weight(i) = patch%weight(node)
               points%area(i) = area(node)
               share(first:last) = [1.0_dp, -corner_share, -corner_share]/(1.0_dp - 2.0_dp*corner_share)
            else
               points%weight(i) = sum(patch%weight(place(first:last)), mask=area(place(first:last))*area(node) > 0.0_dp)
               points%area(i) = sum(area(place(first:last)))
               share(first:last) = area(place(first:last))/points%area(i)
            end if
            last = last + 1
         end associate
      end do
   end subroutine share_areas

   !> The point on a rigid obstacle that an earlier set has at a node, if the line of another set continues that of the
   !> earlier one; 0 at a corner and where there is none.
   pure integer function point_before(zone, node, normal) result(point)
      type(contact_zone_t), intent(in) :: zone !! the zone
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: normal(:) !! the other set's normal there (n_dim) [-]
      ! Smallest cosine between the normals at which a line continues; the angle, 46 degrees, is unlikely in a model.
      real(dp), parameter :: least_cosine = 0.7_dp

      do point = 1, zone%n_points
         if (zone%is_cell(point) .or. allocated(zone%pairs(zone%set(point))%segments) .or. &
            zone%rows%node(zone%rows%start(point)) /= node) cycle
         if (dot_product(zone%normal(point), normal) > least_cosine) return
      end do
      point = 0
   end function point_before

   !> Adds the corners of the faces of a patch in space as points, with multipliers as those of the slave of a pair. The
   !> gap of a point is made of those of its nodes as its displacement is of theirs.
   pure subroutine add_corners(zone, set, normal, patch, body, taken)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set
      real(dp), intent(in) :: normal(:, :) !! unit normals of its nodes, along which gaps count (3, n_nodes) [-]
      type(patch_t), intent(in) :: patch !! its patch
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(taken_t), intent(in) :: taken !! what earlier sets have
      type(contact_zone_t) :: points
      type(mortar_points_t) :: integrals
      integer :: place(body%mesh%n_nodes), i, p
      real(dp), allocatable :: share(:)

      place(patch%node) = [(i, i=1, patch%n_nodes)]
      associate (pair => zone%pairs(set), rows => integrals%rows)
         call new_slave_alone(pair, patch, normal, body, taken)
         zone%held_node = [zone%held_node, pair%held_node]
         zone%held_set = [zone%held_set, spread(set, 1, size(pair%held_node))]
         zone%held_normal = reshape([zone%held_normal, normal(:, place(pair%held_node))], &
            [3, size(zone%held_node)])
         zone%held_arc_length = [zone%held_arc_length, spread(0.0_dp, 1, size(pair%held_node))]
         call integrate_pair(integrals, pair, pair%segments, is_again=.false.)
         zone%shared_node = [zone%shared_node, pair%shared_node]
         call set_moved(points, integrals, pair)
         points%is_fixed = pair%is_fixed
         points%is_own = body%constraints%rigid_of(pair%node) == 0
         zone%node = [zone%node, pack(pair%node, points%is_own)]
         points%position = body%mesh%coordinates(:, pair%node)
         share = [((dot_product(rows%block(:, 1, i), pair%frame(:, 1, p)), i=rows%start(p), rows%start(p + 1) - 1), &
            p=1, size(pair%node))]
         call set_nodal_quadrature(points, patch, normal, place(rows%node), share, body%mesh%coordinates)
      end associate
      call add_points(zone, set, .false., points)
   end subroutine add_corners

   !> Adds the cells of a patch as points. A cell whose nodes supports hold along its normal is no point.
   pure subroutine add_cells(zone, set, contact, patch, body, error)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set
      type(contact_t), intent(in) :: contact !! the contact set
      type(patch_t), intent(in) :: patch !! its patch
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(error_t), allocatable, intent(out) :: error !! the partition does not fit the line
      type(contact_cells_t) :: cells
      type(contact_zone_t) :: points
      integer, allocatable :: kept(:), point_of(:)
      integer :: k

      call new_contact_cells(cells, body, patch, contact%partition, contact%direction(:2), error)
      if (allocated(error)) return
      zone%n_held_cells = zone%n_held_cells + count(cells%is_held)
      kept = pack([(k, k=1, cells%n_cells)], .not. cells%is_held)
      allocate (point_of(0:cells%n_cells), source=0)
      point_of(kept) = [(k, k=1, size(kept))]
      allocate (points%line)
      points%line%next = point_of(cells%line%next(kept))
      points%position = cells%center(:, kept)
      points%frame = new_frames(cells%normal(:, kept), 1 + zone%n_tangents)
      points%weight = cells%length(kept)
      points%area = cells%area(kept)
      points%acting = points%position
      points%rows = cells%rows%picked(kept)
      points%quadrature = cells%quadrature%picked(kept)
      points%is_fixed = cells%is_fixed(:, kept)
      points%is_own = spread(.false., 1, size(kept))
      call add_points(zone, set, .true., points)
   end subroutine add_cells

   !> Adds the points of a pair of surfaces: corners of the slave, or cells.
   subroutine add_pair(zone, set, contact, body, taken, error)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set
      type(contact_t), intent(in) :: contact !! the contact set
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(taken_t), intent(inout) :: taken !! what earlier sets have; gains what this one has
      type(error_t), allocatable, intent(out) :: error !! the sets do not face each other, or overlap by far
      character(*), parameter :: remedy = 'exchange set and against'
      type(mortar_points_t) :: integrals
      type(contact_zone_t) :: points
      type(error_t), allocatable :: shear_fault
      logical :: is_fixed(zone%n_tangents)
      integer :: p

      associate (pair => zone%pairs(set))
         call new_mortar_pair(pair, contact%set, contact%pairing, body, taken, error)
         if (allocated(error)) return
         if (contact%partition%is_constant) then
            call choose_cells(pair, contact%partition, body, error)
         else
            call check_ends(pair, remedy, .false., body%constraints, error)
            call check_ends(pair, remedy, allocated(zone%line), body%constraints, shear_fault)
            if (allocated(shear_fault)) pair%shear_fault = shear_fault%message
         end if
         if (allocated(error)) return
         call integrate_pair(integrals, pair, pair%segments, is_again=.false.)
         if (contact%pairing%has_mesh_gap()) call check_overlap(pair, integrals, body%mesh, error)
         if (allocated(error)) return
         points%line = pair%line
         points%is_fixed = pair%is_fixed
         points%frame = pair%frame
         if (contact%partition%is_constant) then
            points%is_own = spread(.false., 1, size(pair%line%next))
            points%position = integrals%center
            ! Around the axis the master may move, too.
            do p = 1, size(pair%frame, 3)
               associate (nodes => integrals%rows%node(integrals%rows%start(p):integrals%rows%start(p + 1) - 1))
                  is_fixed = all(body%constraints%fixed_tangents(nodes, spread(pair%frame(:, :, p), 3, size(nodes))), &
                     dim=2)
                  points%is_fixed(2:, p) = is_fixed(2:)
               end associate
            end do
         else
            points%is_own = body%constraints%rigid_of(pair%node) == 0
            zone%node = [zone%node, pack(pair%node, points%is_own)]
            points%position = body%mesh%coordinates(:, pair%node)
         end if
         zone%shared_node = [zone%shared_node, pair%shared_node]
         call take_facing_sides(taken, pair)
      end associate
      points%acting = integrals%center
      points%foot = integrals%foot
      points%weight = integrals%length
      points%area = integrals%area
      points%rows = integrals%rows
      points%quadrature = integrals%quadrature
      call add_points(zone, set, contact%partition%is_constant, points)
   end subroutine add_pair

   !> Adds the points of a pair that slides far: all corners of the slave.
   subroutine add_moved_pair(zone, set, contact, body, error)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: set !! number of the contact set
      type(contact_t), intent(in) :: contact !! the contact set
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(error_t), allocatable, intent(out) :: error !! a missing set, common nodes, or a corner in the slave
      type(mortar_points_t) :: integrals
      type(contact_zone_t) :: points

      associate (pair => zone%pairs(set))
         call new_moved_pair(pair, contact%set, contact%pairing, body, error)
         if (allocated(error)) return
         call integrate_pair(integrals, pair, pair%segments, is_again=.false.)
         points%line = pair%line
         points%is_fixed = pair%is_fixed
         points%is_own = spread(.false., 1, size(pair%node))
         points%position = body%mesh%coordinates(:, pair%node)
         call set_moved(points, integrals, pair)
      end associate
      call add_points(zone, set, .false., points)
   end subroutine add_moved_pair

   !> Sets what depends on the places of a pair, which may slide far.
   pure subroutine set_moved(points, integrals, pair)
      type(contact_zone_t), intent(inout) :: points !! gain frames, places, areas, rows and quadrature
      type(mortar_points_t), intent(in) :: integrals !! the integrals of the pair
      type(mortar_pair_t), intent(in) :: pair !! the pair at these places
      real(dp) :: whole(maxval(pair%patch%node))

      points%frame = pair%frame
      points%acting = integrals%center
      points%foot = integrals%foot
      points%weight = integrals%length
      points%area = integrals%area
      ! Where it faces nothing a point has the area of its node, on an axis any other.
      whole(pair%patch%node) = pair%patch%weight
      where (.not. integrals%area > 0.0_dp) points%weight = whole(pair%node)
      whole(pair%patch%node) = merge(pair%patch%area, maxval(pair%patch%area), pair%patch%area > 0.0_dp)
      where (.not. integrals%area > 0.0_dp) points%area = whole(pair%node)
      points%rows = integrals%rows
      points%quadrature = integrals%quadrature
   end subroutine set_moved

   !> Recomputes rows and gaps of the points of pairs in contact; all other rows are copied.
   pure subroutine recompute_pairs(rows, gap_change, zone)
      type(contact_rows_t), intent(out) :: rows !! the rows
      real(dp), allocatable, intent(out) :: gap_change(:)
         !! by how much the gap that the meshes have is larger than in the zone (m) [L]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer :: nothing(0)
      type(mortar_points_t) :: points
      integer :: set, p, i
      integer, allocatable :: of_set(:)

      allocate (gap_change(zone%n_points), source=0.0_dp)
      rows = zone%rows%picked(nothing)
      do set = 1, size(zone%pairs)
         of_set = pack([(p, p=1, zone%n_points)], zone%set == set)
         if (.not. zone%pairs(set)%is_set()) then
            call rows%add(zone%rows%picked(of_set))
            cycle
         end if
         call integrate_pair(points, zone%pairs(set), segments_again(zone%pairs(set)), is_again=.true.)
         call rows%add(points%rows)
         do i = 1, size(of_set)
            gap_change(of_set(i)) = mean_gap(points%quadrature, i) - mean_gap(zone%quadrature, of_set(i))
         end do
      end do
   end subroutine recompute_pairs

   !> The gap of a contact point, a mean over its quadrature points [L].
   pure real(dp) function mean_gap(quadrature, point)
      type(contact_quadrature_t), intent(in) :: quadrature !! the quadrature points of all points
      integer, intent(in) :: point !! the point

      associate (first => quadrature%start(point), last => quadrature%start(point + 1) - 1)
         mean_gap = sum(quadrature%share(first:last)*quadrature%gap(first:last))
      end associate
   end function mean_gap

   !> Cuts the slave's sides a second time, by bisection between rays, in space from those of the master.
   pure function segments_again(pair) result(segments)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_segment_t), allocatable :: segments(:)

      if (size(pair%slave%corner, 1) == 3) then
         call find_face_segments(segments, pair%slave, pair%master, pair%search, .true.)
         segments = pack(segments, sum(pair%part(:, segments%slave), dim=1) > 0.0_dp)
      else
         call find_segments_again(segments, pair%slave, pair%master, pair%search, pair%segments%slave)
      end if
   end function segments_again

end module amontons_contact_zone
