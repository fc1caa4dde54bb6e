!> A pair of boundary sets that face each other: their surfaces, their segments, and the corners of the slave that carry
!> multipliers.
!>
!> The nodes and sides that contact sets and ties have, so that later ones leave them alone, are kept as the node that
!> follows each node on the sides of such a set; a node of which no side that follows it is taken, as the last one of a
!> line, is followed by itself, and one that no set has by 0.
!>
!> Checks of the contact points of a pair of surfaces: in the pair, the mesh and the supports, out a refusal.
module amontons_mortar_pair
   use amontons_boundary, only: boundary_line_t, new_boundary_line
   use amontons_constraints, only: constraints_t
   use amontons_contact_rows, only: turned
   use amontons_contact_set, only: pairing_t
   use amontons_element, only: side_shapes
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t, new_side_table, side_element, side_place, side_table_t
   use amontons_mortar_points, only: cell_pieces, corner_pieces, integrate_pieces, mortar_piece_t, mortar_points_t, &
      place_on
   use amontons_mortar_segments, only: find_segments, meet_side, mortar_segment_t
   use amontons_obstacle, only: cross_product
   use amontons_surface, only: meshed_body_t, new_surface, surface_place_t, surface_t
   use amontons_text, only: place_text, short_text
   implicit none (type, external)
   private

   public :: check_ends, check_overlap, held_slave_text, integrate_pair, mortar_pair_t, n_quadrature_points, &
      new_mortar_pair, take_facing_sides, take_line

   !> Points of the quadrature on a segment: exact for straight sides, and rounding is all that is left of the normals'
   !> curvature.
   integer, parameter :: n_quadrature_points = 7

   !> The surfaces of a pair.
   type :: mortar_pair_t
      character(:), allocatable :: set !! name of the slave's boundary set
      character(:), allocatable :: against !! name of the master's boundary set
      character(:), allocatable :: label !! what it is called, SLAVE/MASTER
      type(boundary_line_t) :: line !! the slave's line
      type(surface_t) :: slave !! the surface that carries the multipliers
      type(surface_t) :: master !! the other one
      type(mortar_segment_t), allocatable :: segments(:) !! where they face each other
      real(dp) :: search = 0.0_dp !! how far gaps may reach, either way [L]
      integer, allocatable :: node(:) !! the slave's corners that are points, in the order of the line (n)
      integer, allocatable :: next(:) !! the point that follows along the line, 0 for none (n)
      real(dp), allocatable :: covered_share(:)
         !! share of the side that follows a corner that faces the master; not allocated with cells (n) [-]
      logical, allocatable :: is_tangent_fixed(:) !! whether a support guides a point along a line (n)
      logical, allocatable :: gives_shear(:)
         !! whether the shear at such a point is that of its neighbors' multipliers: of bonded surfaces (n)
      integer, allocatable :: held_node(:) !! corners that are no points since supports hold them
      integer, allocatable :: shared_node(:) !! corners that are no points since they belong to an earlier set
      integer, allocatable :: joined_node(:) !! corners that are no points since they are nodes of the master, too
      integer, allocatable :: open_node(:) !! corners that face nothing
      real(dp), allocatable :: idle_side(:, :)
         !! middles of sides that transmit nothing, since earlier sets have both ends, but not the side (2, sides) [L]
      integer, allocatable :: point_of(:, :) !! the point that each corner of each side is, 0 for none (2, sides)
      type(mortar_segment_t), allocatable :: cells(:)
         !! parts of the slave's sides in cells of constant multipliers, and in the place of the master the point that
         !! the cell is, 0 for none; not allocated where the points are corners
      real(dp), allocatable :: normal(:, :) !! unit normal of each point (2, n) [-]
      character(:), allocatable :: shear_fault
         !! what a contact set with friction is refused with; not allocated where shear can act on every side
      integer :: sliver_side = 0 !! a side that faces so little of the master that it is left out, 0 for none
      real(dp) :: sliver_share = 0.0_dp !! what it faces, as a share of the side [-]
   contains
      procedure :: is_set => mortar_pair_is_set
   end type mortar_pair_t

contains

   !> Whether there is a pair: a contact set with a rigid obstacle has none.
   elemental logical function mortar_pair_is_set(self) result(is_set)
      class(mortar_pair_t), intent(in) :: self !! the pair

      is_set = allocated(self%segments)
   end function mortar_pair_is_set

   !> Finds where two boundary sets face each other.
   subroutine new_mortar_pair(pair, set, pairing, body, follower, error)
      type(mortar_pair_t), intent(out) :: pair !! the pair
      character(*), intent(in) :: set !! name of the slave's boundary set
      type(pairing_t), intent(in) :: pairing !! the master, and how far gaps may reach
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      integer, intent(in) :: follower(:) !! which nodes earlier sets have, see `amontons_mortar_pair` (nodes)
      type(error_t), allocatable, intent(out) :: error
         !! a missing set, bodies that are joined, corners in the slave, sets that do not face each other, or normals
         !! that cross before they meet the master
      type(boundary_line_t) :: master_line
      real(dp), parameter :: least_share = 1.0e-6_dp
      real(dp), allocatable :: share(:)
      integer :: i

      pair%label = pairing%label(set)
      pair%set = set
      pair%against = pairing%against
      if (set == pair%against) then
         call new_error(error, input_refused, "self contact of the set '"//set//"': split the set in two")
         return
      end if
      call new_boundary_line(pair%line, body%mesh, set, error, body%materials)
      if (allocated(error)) return
      call new_boundary_line(master_line, body%mesh, pair%against, error)
      if (allocated(error)) return
      ! At an end of the slave bodies may be joined, as at a crack's tip.
      associate (line => pair%line)
         do i = 1, line%n_nodes
            if (all(master_line%node /= line%node(i))) cycle
            if (line%next(i) == 0 .or. all(line%next /= i)) cycle
            call new_error(error, input_refused, "'"//pair%set//"' and '"//pair%against//"' share nodes, as at "// &
               place_text(body%mesh%coordinates(:, line%node(i)))//': these bodies are joined there')
            return
         end do
      end associate
      call new_surface(pair%slave, body, set, pair%line, error)
      if (allocated(error)) return
      call new_surface(pair%master, body, pair%against, master_line, error)
      if (allocated(error)) return
      if (pair%slave%corner_node > 0) then
         call new_error(error, input_refused, "the set '"//set//"' has a corner of more than 40 degrees at "// &
            place_text(body%mesh%coordinates(:, pair%slave%corner_node))//': make a set of each side of it')
         return
      end if
      pair%search = pairing%search
      if (.not. pairing%search > 0.0_dp) pair%search = 2.0_dp*max(pair%slave%longest, pair%master%longest)
      call find_segments(pair%segments, pair%slave, pair%master, pair%search)
      ! Sides that face next to nothing are left out.
      share = covered_shares(pair)
      pair%segments = pack(pair%segments, share(pair%segments%slave) >= least_share)
      pair%sliver_side = findloc(share > 0.0_dp .and. share < least_share, .true., dim=1)
      if (pair%sliver_side > 0) pair%sliver_share = share(pair%sliver_side)
      if (size(pair%segments) == 0) then
         call explain_distance(pair, error)
         return
      end if
      call check_rays(pair, error)
      if (allocated(error)) return
      call number_points(pair, body%constraints, follower > 0, master_line, body%mesh%n_nodes, pairing%is_tied)
      call find_idle_sides(pair, follower)
   end subroutine new_mortar_pair

   !> Refuses a slave whose normals cross before they meet the master, as those of a hollow do beyond its center of
   !> curvature: several places would then be opposite one and the same. Feet on the master go along with the slave
   !> where no normals have crossed.
   pure subroutine check_rays(pair, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, with its segments
      type(error_t), allocatable, intent(out) :: error !! they do
      ! What rounding leaves of a way of 0, over that on the slave.
      real(dp), parameter :: rounding = 1.0e-6_dp
      type(surface_place_t) :: place(2), foot
      real(dp) :: feet(2, 2), way(2)
      integer :: i, k

      do i = 1, size(pair%segments)
         associate (segment => pair%segments(i))
            do k = 1, 2
               place(k) = pair%slave%place(segment%slave, segment%range(k))
               foot = pair%master%place(segment%master, place_on(meet_side(pair%master%corner(:, :, segment%master), &
                  place(k)%position, place(k)%normal/norm2(place(k)%normal))))
               feet(:, k) = foot%position
            end do
            way = place(2)%position - place(1)%position
            if (dot_product(feet(:, 2) - feet(:, 1), way) > -rounding*sum(way**2)) cycle
            call new_error(error, input_refused, "normals of '"//pair%set//"' cross before they meet '"// &
               pair%against//"', as at "//place_text(place(1)%position)// &
               ': the gap is larger than the radius of the hollow; exchange the sets, or give a smaller search')
            return
         end associate
      end do
   end subroutine check_rays

   !> Says why two sets do not face each other.
   pure subroutine explain_distance(pair, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, without segments
      type(error_t), allocatable, intent(out) :: error !! the reason
      real(dp) :: distance, least
      integer :: i, k, j, l, at(2)

      least = huge(least)
      at = 1
      do i = 1, pair%slave%n_sides
         do k = 1, pair%master%n_sides
            do j = 1, 3
               do l = 1, 3
                  distance = norm2(pair%slave%corner(:, j, i) - pair%master%corner(:, l, k))
                  if (distance < least) at = [i, k]
                  least = min(least, distance)
               end do
            end do
         end do
      end do
      associate (set => pair%set, against => pair%against)
         if (dot_product(pair%slave%normal(:, 3, at(1)), pair%master%normal(:, 3, at(2))) > 0.0_dp) then
            call new_error(error, input_refused, "the normals of '"//set//"' point away from '"//against// &
               "', or those of '"//against//"' away from '"//set//"': both sets face the same way")
         else
            call new_error(error, input_refused, "the sets '"//set//"' and '"//against//"' do not face each other: "// &
               "no normal of '"//set//"' meets '"//against//"' within search = "//short_text(pair%search)// &
               '; the smallest distance is '//short_text(least))
         end if
      end associate
   end subroutine explain_distance

   !> Chooses the corners that are points: of those that face the master each that supports leave a motion which the
   !> multipliers act on.
   pure subroutine number_points(pair, constraints, is_taken, master_line, n_nodes, is_tied)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its segments
      type(constraints_t), intent(in) :: constraints !! the supports
      logical, intent(in) :: is_taken(:) !! whether a node carries multipliers of an earlier set (nodes)
      type(boundary_line_t), intent(in) :: master_line !! the master's line
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      logical, intent(in) :: is_tied !! whether the surfaces are bonded: a point may then move along its tangent alone
      real(dp) :: normal(2, n_nodes)
      logical :: is_corner(n_nodes), faces(n_nodes)
      integer, allocatable :: facing(:)
      integer :: i, point(n_nodes)
      real(dp) :: share(pair%slave%n_sides)

      is_corner = .false.
      faces = .false.
      do i = 1, pair%slave%n_sides
         is_corner(pair%slave%side(:2, i)) = .true.
         normal(:, pair%slave%side(:2, i)) = pair%slave%normal(:, :2, i)
      end do
      do i = 1, size(pair%segments)
         faces(pair%slave%side(:2, pair%segments(i)%slave)) = .true.
      end do
      pair%open_node = pack(pair%line%node, is_corner(pair%line%node) .and. .not. faces(pair%line%node))
      allocate (pair%held_node(0), pair%shared_node(0), pair%joined_node(0), pair%node(0), pair%is_tangent_fixed(0))
      facing = pack(pair%line%node, faces(pair%line%node))
      do i = 1, size(facing)
         associate (node => facing(i))
            if (is_taken(node)) then
               pair%shared_node = [pair%shared_node, node]
            else if (any(master_line%node == node)) then
               pair%joined_node = [pair%joined_node, node]
            else if (.not. merge(any(constraints%is_free(:, node)), &
               constraints%leaves_free(node, normal(:, node)), is_tied)) then
               pair%held_node = [pair%held_node, node]
            else
               pair%node = [pair%node, node]
               pair%is_tangent_fixed = [pair%is_tangent_fixed, .not. all(constraints%is_free(:, node))]
            end if
         end associate
      end do
      pair%normal = normal(:, pair%node)
      point = 0
      point(pair%node) = [(i, i=1, size(pair%node))]
      allocate (pair%point_of(2, pair%slave%n_sides), pair%next(size(pair%node)))
      pair%next = 0
      do i = 1, pair%slave%n_sides
         pair%point_of(:, i) = point(pair%slave%side(:2, i))
         if (pair%point_of(1, i) > 0) pair%next(pair%point_of(1, i)) = pair%point_of(2, i)
      end do
      allocate (pair%covered_share(size(pair%node)), source=0.0_dp)
      share = covered_shares(pair)
      do i = 1, pair%slave%n_sides
         if (pair%point_of(1, i) > 0) pair%covered_share(pair%point_of(1, i)) = share(i)
      end do
      pair%gives_shear = pair%is_tangent_fixed .and. is_tied
   end subroutine number_points

   !> The share of each side of the slave that faces the master (sides) [-].
   pure function covered_shares(pair) result(share)
      type(mortar_pair_t), intent(in) :: pair !! the pair, with its segments
      real(dp) :: share(pair%slave%n_sides)
      integer :: i

      share = 0.0_dp
      do i = 1, size(pair%segments)
         associate (segment => pair%segments(i))
            share(segment%slave) = share(segment%slave) + 0.5_dp*(segment%range(2) - segment%range(1))
         end associate
      end do
   end function covered_shares

   !> Finds the sides that transmit nothing although no support holds them.
   pure subroutine find_idle_sides(pair, follower)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its points
      integer, intent(in) :: follower(:) !! which nodes earlier sets have, see `amontons_mortar_pair` (nodes)
      logical :: is_idle(pair%slave%n_sides)
      integer :: i, k

      is_idle = .false.
      is_idle(pair%segments%slave) = .true.
      do i = 1, pair%slave%n_sides
         associate (nodes => pair%slave%side(:3, i))
            do k = 1, 2
               is_idle(i) = is_idle(i) .and. pair%point_of(k, i) == 0 .and. all(pair%held_node /= nodes(k))
            end do
            is_idle(i) = is_idle(i) .and. follower(nodes(1)) /= merge(nodes(3), nodes(2), nodes(3) > 0)
         end associate
      end do
      pair%idle_side = pair%slave%corner(:, 3, pack([(i, i=1, size(is_idle))], is_idle))
   end subroutine find_idle_sides

   !> Integrates over the points of a pair.
   pure subroutine integrate_pair(points, pair, segments, n_points)
      type(mortar_points_t), intent(out) :: points !! the points
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_segment_t), intent(in) :: segments(:) !! its segments, or another cut of the same surfaces
      integer, intent(in) :: n_points !! number of points of the quadrature
      type(mortar_piece_t), allocatable :: pieces(:)

      if (allocated(pair%cells)) then
         call cell_pieces(pieces, segments, pair%cells)
      else
         call corner_pieces(pieces, segments, pair%point_of, pair%gives_shear, pair%slave, n_points)
      end if
      call integrate_pieces(points, pieces, size(pair%normal, 2), pair%slave, pair%master, n_points)
      call points%set_normals(pair%normal)
   end subroutine integrate_pair

   !> Takes a line.
   pure subroutine take_line(follower, line)
      integer, intent(inout) :: follower(:) !! the node that follows each node; gains those of the line (nodes)
      type(boundary_line_t), intent(in) :: line !! the line of a set
      integer :: i

      do i = 1, line%n_nodes
         if (line%next(i) > 0) call take_side(follower, line%node([i, line%next(i)]), is_whole=.true.)
      end do
   end subroutine take_line

   !> Takes the nodes of the sides of a slave that face its master, and the sides, but for those that the master covers
   !> in part: what is left of them is another set's.
   pure subroutine take_facing_sides(follower, pair)
      integer, intent(inout) :: follower(:) !! the node that follows each node; gains those of the pair (nodes)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      ! What rounding leaves of a side.
      real(dp), parameter :: rounding = 1.0e-6_dp
      real(dp) :: share(pair%slave%n_sides)
      integer :: i

      share = covered_shares(pair)
      do i = 1, pair%slave%n_sides
         if (.not. share(i) > 0.0_dp) cycle
         associate (nodes => pair%slave%side(:3, i), is_whole => share(i) >= 1.0_dp - rounding)
            if (nodes(3) > 0) then
               call take_side(follower, nodes([1, 3]), is_whole)
               call take_side(follower, nodes([3, 2]), is_whole)
            else
               call take_side(follower, nodes(:2), is_whole)
            end if
         end associate
      end do
   end subroutine take_facing_sides

   !> Takes two nodes that follow each other.
   pure subroutine take_side(follower, nodes, is_whole)
      integer, intent(inout) :: follower(:) !! the node that follows each node (nodes)
      integer, intent(in) :: nodes(2) !! the nodes, in the order of the line
      logical, intent(in) :: is_whole !! whether the set has all between them

      where (follower(nodes) == 0) follower(nodes) = nodes
      if (is_whole) follower(nodes(1)) = nodes(2)
   end subroutine take_side

   !> Refuses a side of the slave that has no multiplier at either end and faces a part of the master that may move
   !> along the normal, or, where shear may act, the same along the tangent: nothing would be transmitted there. Where
   !> earlier sets have both ends the side is taken to be theirs, unless that leaves no point.
   pure subroutine check_ends(pair, remedy, needs_shear, constraints, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, its points corners
      character(*), intent(in) :: remedy !! what to do where supports hold the slave
      logical, intent(in) :: needs_shear !! whether shear may act: friction, or bonded surfaces
      type(constraints_t), intent(in) :: constraints !! the supports
      type(error_t), allocatable, intent(out) :: error !! there is such a side
      ! Between the normal and the tangent of the surface.
      real(dp), parameter :: aslant = 0.707_dp
      real(dp) :: axes(2, 2)
      logical :: is_held(2, 2), lacks(2, 2)
      integer :: i, k, p

      do i = 1, size(pair%segments)
         associate (points => pair%point_of(:, pair%segments(i)%slave), &
            nodes => pair%slave%side(:2, pair%segments(i)%slave), &
            facing => pair%master%side(:2, pair%segments(i)%master))
            axes(:, 1) = pair%slave%normal(:, 3, pair%segments(i)%slave)
            do k = 1, 2
               p = points(k)
               is_held(k, :) = any(pair%held_node == nodes(k))
               lacks(k, :) = p == 0
               if (p == 0) cycle
               is_held(k, 2) = pair%is_tangent_fixed(p)
               lacks(k, 2) = pair%is_tangent_fixed(p)
               axes(:, 1) = pair%normal(:, p)
            end do
            axes(:, 2) = turned(axes(:, 1))
            do k = 1, merge(2, 1, needs_shear)
               if (.not. (all(lacks(:, k)) .and. any(is_held(:, k)))) cycle
               if (.not. (constraints%leaves_free(facing(1), axes(:, k)) .or. &
                  constraints%leaves_free(facing(2), axes(:, k)))) cycle
               call new_error(error, input_refused, held_slave_text(pair, &
                  pair%slave%corner(:, 3, pair%segments(i)%slave), merge('force', 'shear', &
                  abs(dot_product(axes(:, k), pair%slave%normal(:, 3, pair%segments(i)%slave))) > aslant), remedy))
               return
            end do
         end associate
      end do
      if (size(pair%node) == 0) call new_error(error, input_refused, "no node of '"//pair%set//"' that faces '"// &
         pair%against//"' is left: supports hold them, or they belong to earlier sets")
   end subroutine check_ends

   !> Says that a part of a slave has no displacements left that contact forces could act on.
   pure function held_slave_text(pair, position, what, remedy) result(text)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      real(dp), intent(in) :: position(2) !! where the part is [L]
      character(*), intent(in) :: what !! what cannot act: force or shear
      character(*), intent(in) :: remedy !! what to do about it
      character(:), allocatable :: text

      text = "supports hold the slave '"//pair%set//"' at "//place_text(position)//': no '//what// &
         " could act between it and '"//pair%against//"' there; "//remedy
   end function held_slave_text

   !> Refuses meshes that overlap by more than half of a side, or by more than one of the bodies is thick there: what
   !> lies beyond a thin wall was not pressed into it.
   pure subroutine check_overlap(pair, points, mesh, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_points_t), intent(in) :: points !! its integrals
      type(mesh_t), intent(in) :: mesh !! the mesh of both
      type(error_t), allocatable, intent(out) :: error !! they do
      ! What the digits of mesh files leave of a gap of 0, over the longest side.
      real(dp), parameter :: rounding = 1.0e-6_dp
      character(:), allocatable :: overlap
      real(dp) :: thickness
      integer :: q

      if (size(points%quadrature%gap) == 0) return
      ! Of places that differ by rounding alone the first.
      q = findloc(points%quadrature%gap <= (1.0_dp - rounding)*minval(points%quadrature%gap), .true., dim=1)
      if (q == 0) return
      associate (depth => -points%quadrature%gap(q), position => points%quadrature%position(:, q))
         if (depth <= rounding*pair%slave%longest) return
         overlap = "'"//pair%set//"' and '"//pair%against//"' overlap by up to "//short_text(depth)// &
            ' before any load (side at '//place_text(position)//'), '
         if (depth > 0.5_dp*pair%slave%longest) then
            call new_error(error, input_refused, overlap//'more than half a side: give extra_gap for an '// &
               "interference, or gap = 'touching'")
            return
         end if
         thickness = wall_thickness(mesh, position, -points%quadrature%normal(:, q), depth)
         if (thickness < depth) call new_error(error, input_refused, overlap//'through a wall of '// &
            short_text(thickness)//': move the bodies to their own sides of it, or give a smaller search')
      end associate
   end subroutine check_overlap

   !> How thick the body is that begins at a place: the way to the first boundary that it leaves by, huge for none
   !> within a depth. Sides more than 25 degrees aslant belong to corners, which are thin at their tip.
   pure real(dp) function wall_thickness(mesh, position, direction, depth) result(thickness)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: position(2) !! the place, on the boundary of a body [L]
      real(dp), intent(in) :: direction(2) !! the way into it, a unit vector [-]
      real(dp), intent(in) :: depth !! how far to look [L]
      ! The surfaces that overlap themselves lie at both ends of the way; 0.906 is the cosine of 25 degrees.
      real(dp), parameter :: at_an_end = 1.0e-6_dp, aslant = 0.906_dp
      type(side_table_t) :: table
      real(dp) :: corner(2, 3), xi(2), values(3), slopes(3), way, along(2)
      integer :: overlapping(2), number, i, k

      thickness = huge(1.0_dp)
      call new_side_table(table, mesh, overlapping)
      do i = 1, table%n_sides
         number = table%boundary(i)
         if (number == 0) cycle
         associate (nodes => mesh%side(side_element(number), side_place(number)))
            corner(:, :2) = mesh%coordinates(:, nodes(:2))
            corner(:, 3) = 0.5_dp*(corner(:, 1) + corner(:, 2))
            if (nodes(3) > 0) corner(:, 3) = mesh%coordinates(:, nodes(3))
         end associate
         xi = meet_side(corner, position, direction)
         do k = 1, 2
            if (abs(xi(k)) > 1.0_dp) cycle
            call side_shapes(.true., xi(k), values, slopes)
            along = matmul(corner, slopes)
            way = dot_product(matmul(corner, values) - position, direction)
            if (way <= at_an_end*depth .or. way >= (1.0_dp - at_an_end)*depth) cycle
            if (abs(cross_product(along, direction)) > aslant*norm2(along)) thickness = min(thickness, way)
         end do
      end do
   end function wall_thickness

end module amontons_mortar_pair
