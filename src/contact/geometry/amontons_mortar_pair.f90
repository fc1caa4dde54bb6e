!> A pair of boundary sets that face each other: their surfaces, their segments, and the corners of the slave that carry
!> multipliers.
module amontons_mortar_pair
   use amontons_boundary, only: boundary_line_t, new_boundary_line
   use amontons_constraints, only: constraints_t
   use amontons_contact_set, only: pairing_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_listing_text, only: place_text, short_text
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_mortar_points, only: cell_pieces, corner_pieces, integrate_pieces, mortar_piece_t, mortar_points_t, &
      place_on
   use amontons_mortar_segments, only: find_segments, meet_side, mortar_segment_t
   use amontons_surface, only: new_surface, surface_place_t, surface_t
   implicit none (type, external)
   private

   public :: covered_shares, integrate_pair, mortar_pair_t, n_quadrature_points, new_mortar_pair

   !> Points of the quadrature on a segment: exact for straight sides, and rounding is all that is left of the normals'
   !> curvature.
   integer, parameter :: n_quadrature_points = 7

   !> The surfaces of a pair.
   type :: mortar_pair_t
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
      logical, allocatable :: is_tangent_fixed(:) !! whether a support bears the shear of a point (n)
      logical, allocatable :: gives_shear(:)
         !! whether the shear at such a point, which is none of symmetry, is that of its neighbors' multipliers (n)
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
      procedure, private :: number_points => mortar_pair_number_points
   end type mortar_pair_t

contains

   !> Whether there is a pair: a contact set with a rigid obstacle has none.
   elemental logical function mortar_pair_is_set(self) result(is_set)
      class(mortar_pair_t), intent(in) :: self !! the pair

      is_set = allocated(self%segments)
   end function mortar_pair_is_set

   !> Finds where two boundary sets face each other.
   subroutine new_mortar_pair(pair, set, pairing, mesh, materials, constraints, follower, error)
      type(mortar_pair_t), intent(out) :: pair !! the pair
      character(*), intent(in) :: set !! name of the slave's boundary set
      type(pairing_t), intent(in) :: pairing !! the master, and how far gaps may reach
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the areas of the line
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: follower(:) !! which nodes earlier sets have, see `amontons_taken_sides` (nodes)
      type(error_t), allocatable, intent(out) :: error
         !! a missing set, bodies that are joined, corners in the slave, sets that do not face each other, or normals
         !! that cross before they meet the master
      type(boundary_line_t) :: master_line
      character(:), allocatable :: against

      pair%label = pairing%label(set)
      against = pairing%against
      if (set == against) then
         call new_error(error, input_refused, "self contact of the set '"//set//"': split the set in two")
         return
      end if
      call new_boundary_line(pair%line, mesh, set, error, materials)
      if (allocated(error)) return
      call new_boundary_line(master_line, mesh, against, error)
      if (allocated(error)) return
      call check_joints(pair%line, master_line, set, against, mesh, error)
      if (allocated(error)) return
      call new_surface(pair%slave, mesh, set, pair%line, materials, constraints, error)
      if (allocated(error)) return
      call new_surface(pair%master, mesh, against, master_line, materials, constraints, error)
      if (allocated(error)) return
      if (pair%slave%corner_node > 0) then
         call new_error(error, input_refused, "the set '"//set//"' has a corner of more than 40 degrees at "// &
            place_text(mesh%coordinates(:, pair%slave%corner_node))//': make a set of each side of it')
         return
      end if
      pair%search = pairing%search
      if (.not. pairing%search > 0.0_dp) pair%search = 2.0_dp*max(pair%slave%longest, pair%master%longest)
      call find_segments(pair%segments, pair%slave, pair%master, pair%search)
      call drop_slivers(pair)
      if (size(pair%segments) == 0) then
         call explain_distance(pair, set, against, error)
         return
      end if
      call check_rays(pair, set, against, error)
      if (allocated(error)) return
      call pair%number_points(constraints, follower > 0, master_line, mesh%n_nodes, pairing%is_tied)
      call find_idle_sides(pair, follower)
      call find_shear_givers(pair, pairing%is_tied)
   end subroutine new_mortar_pair

   !> Refuses bodies that are joined where they should meet; at an end of the slave they may be, as at a crack's tip.
   pure subroutine check_joints(line, master_line, set, against, mesh, error)
      type(boundary_line_t), intent(in) :: line !! the slave's line
      type(boundary_line_t), intent(in) :: master_line !! the master's line
      character(*), intent(in) :: set !! name of the slave's set
      character(*), intent(in) :: against !! name of the master's set
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(error_t), allocatable, intent(out) :: error !! they share a node that is no end
      integer :: i

      do i = 1, line%n_nodes
         if (all(master_line%node /= line%node(i))) cycle
         if (line%next(i) == 0 .or. all(line%next /= i)) cycle
         call new_error(error, input_refused, "'"//set//"' and '"//against//"' share nodes, as at "// &
            place_text(mesh%coordinates(:, line%node(i)))//': these bodies are joined there')
         return
      end do
   end subroutine check_joints

   !> Leaves out sides of the slave that face next to nothing.
   pure subroutine drop_slivers(pair)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its segments
      real(dp), parameter :: least_share = 1.0e-6_dp
      real(dp) :: share(pair%slave%n_sides)

      share = covered_shares(pair)
      pair%segments = pack(pair%segments, share(pair%segments%slave) >= least_share)
      pair%sliver_side = findloc(share > 0.0_dp .and. share < least_share, .true., dim=1)
      if (pair%sliver_side > 0) pair%sliver_share = share(pair%sliver_side)
   end subroutine drop_slivers

   !> Refuses a slave whose normals cross before they meet the master, as those of a hollow do beyond its center of
   !> curvature: several places would then be opposite one and the same. Feet on the master go along with the slave
   !> where no normals have crossed.
   pure subroutine check_rays(pair, set, against, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, with its segments
      character(*), intent(in) :: set !! name of the slave's set
      character(*), intent(in) :: against !! name of the master's set
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
            call new_error(error, input_refused, "normals of '"//set//"' cross before they meet '"//against// &
               "', as at "//place_text(place(1)%position)// &
               ': the gap is larger than the radius of the hollow; exchange the sets, or give a smaller search')
            return
         end associate
      end do
   end subroutine check_rays

   !> Says why two sets do not face each other.
   pure subroutine explain_distance(pair, set, against, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, without segments
      character(*), intent(in) :: set !! name of the slave's set
      character(*), intent(in) :: against !! name of the master's set
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
      if (dot_product(pair%slave%normal(:, 3, at(1)), pair%master%normal(:, 3, at(2))) > 0.0_dp) then
         call new_error(error, input_refused, "the normals of '"//set//"' point away from '"//against// &
            "', or those of '"//against//"' away from '"//set//"': both sets face the same way")
      else
         call new_error(error, input_refused, "the sets '"//set//"' and '"//against//"' do not face each other: no "// &
            "normal of '"//set//"' meets '"//against//"' within search = "//short_text(pair%search)// &
            '; the smallest distance is '//short_text(least))
      end if
   end subroutine explain_distance

   !> Chooses the corners that are points.
   pure subroutine mortar_pair_number_points(self, constraints, is_taken, master_line, n_nodes, is_tied)
      class(mortar_pair_t), intent(inout) :: self !! the pair, with its segments
      type(constraints_t), intent(in) :: constraints !! the supports
      logical, intent(in) :: is_taken(:) !! whether a node carries multipliers of an earlier set (nodes)
      type(boundary_line_t), intent(in) :: master_line !! the master's line
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      logical, intent(in) :: is_tied !! whether the surfaces are bonded: a point may then move along its tangent alone
      real(dp) :: normal(2, n_nodes)
      logical :: is_corner(n_nodes), faces(n_nodes)
      integer, allocatable :: facing(:)
      integer :: i

      is_corner = .false.
      faces = .false.
      do i = 1, self%slave%n_sides
         is_corner(self%slave%side(:2, i)) = .true.
         normal(:, self%slave%side(:2, i)) = self%slave%normal(:, :2, i)
      end do
      do i = 1, size(self%segments)
         faces(self%slave%side(:2, self%segments(i)%slave)) = .true.
      end do
      self%open_node = pack(self%line%node, is_corner(self%line%node) .and. .not. faces(self%line%node))
      allocate (self%held_node(0), self%shared_node(0), self%joined_node(0), self%node(0), self%is_tangent_fixed(0))
      facing = pack(self%line%node, faces(self%line%node))
      do i = 1, size(facing)
         associate (node => facing(i))
            if (is_taken(node)) then
               self%shared_node = [self%shared_node, node]
            else if (any(master_line%node == node)) then
               self%joined_node = [self%joined_node, node]
            else if (.not. may_move(constraints, node, normal(:, node), is_tied)) then
               self%held_node = [self%held_node, node]
            else
               self%node = [self%node, node]
               self%is_tangent_fixed = [self%is_tangent_fixed, .not. all(constraints%is_free(:, node))]
            end if
         end associate
      end do
      self%normal = normal(:, self%node)
      call link_points(self, n_nodes)
   end subroutine mortar_pair_number_points

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
      integer, intent(in) :: follower(:) !! which nodes earlier sets have, see `amontons_taken_sides` (nodes)
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

   !> Notes the guided points whose shear is that of their neighbors: all of a tie, else those that are not of symmetry.
   pure subroutine find_shear_givers(pair, is_tied)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its points
      logical, intent(in) :: is_tied !! whether the surfaces are bonded
      integer :: i

      pair%gives_shear = pair%is_tangent_fixed .and. [(is_tied .or. all(pair%slave%mirrored_node /= pair%node(i)), &
         i=1, size(pair%node))]
   end subroutine find_shear_givers

   !> Whether supports leave a corner a motion that the multipliers of a pair act on.
   pure logical function may_move(constraints, node, normal, is_tied)
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: node !! the corner
      real(dp), intent(in) :: normal(2) !! its normal [-]
      logical, intent(in) :: is_tied !! whether the surfaces are bonded

      may_move = constraints%leaves_free(node, normal)
      if (is_tied) may_move = any(constraints%is_free(:, node))
   end function may_move

   !> Notes which corners of the sides are points, which point follows each, and how much of the side between them faces
   !> the master.
   pure subroutine link_points(pair, n_nodes)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its points
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      real(dp) :: share(pair%slave%n_sides)
      integer :: point(n_nodes), i

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
   end subroutine link_points

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

end module amontons_mortar_pair
