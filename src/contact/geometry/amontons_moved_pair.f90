!> A pair of boundary sets in the plane whose surfaces move along each other: they are put where their nodes are, and
!> face each other anew.
!>
!> The functions of the multipliers are the hats of the slave's corners, all of which are points, whether they face the
!> master or not; the gap of a point is the mean over the same hat. A hat of which the master covers next to nothing
!> would carry a force over no area: it is added to that of the neighbor. So is the hat of a corner that supports or
!> rigid sets hold, but on a plane of symmetry, where they hold the master as well: its rows would depend on those of
!> the others.
module amontons_moved_pair
   use amontons_contact_set, only: pairing_t
   use amontons_error, only: error_t
   use amontons_face, only: place_side
   use amontons_frame, only: new_frames
   use amontons_kinds, only: dp
   use amontons_mesh, only: side_element, side_place
   use amontons_mortar_pair, only: find_facing_parts, mortar_pair_t, new_pair_surfaces
   use amontons_surface, only: meshed_body_t, sharp, surface_t
   implicit none (type, external)
   private

   public :: move_pair, new_moved_pair

   !> A hat that is covered by a smaller share than this one of that of its neighbor is carried by it [-].
   real(dp), parameter :: sliver = 0.1_dp

contains

   !> Makes the pair of two sets, which need not face each other.
   subroutine new_moved_pair(pair, set, pairing, body, error)
      type(mortar_pair_t), intent(out) :: pair !! the pair, at rest
      character(*), intent(in) :: set !! name of the slave's boundary set
      type(pairing_t), intent(in) :: pairing !! the master, and how far gaps may reach
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(error_t), allocatable, intent(out) :: error !! an error of `new_pair_surfaces`
      logical, dimension(body%mesh%n_nodes) :: is_master, is_corner, is_held
      integer :: point(body%mesh%n_nodes), i, n, n_components

      call new_pair_surfaces(pair, is_master, set, pairing, body, .true., error)
      if (allocated(error)) return
      associate (slave => pair%slave, master => pair%master)
         is_corner = .false.
         is_corner(slave%side(1, :)) = .true.
         is_corner(slave%side(2, :)) = .true.
         pair%node = pack(pair%patch%node, is_corner(pair%patch%node))
         n = size(pair%node)
         point(pair%node) = [(i, i=1, n)]
         pair%point_of = reshape([(point(slave%side(:2, i)), i=1, slave%n_sides)], [2, slave%n_sides])
         allocate (pair%line%next(n), pair%partner(n), source=0)
         pair%line%next(pair%point_of(1, :)) = pair%point_of(2, :)
         n_components = body%materials%n_components()
         allocate (pair%frame(n_components, n_components, n))
         allocate (pair%is_fixed(n_components - 1, n), pair%gives_shear(n), source=.false.)
         pair%is_fixed(1, point(slave%mirrored_node)) = .true.
         is_held = .not. all(body%constraints%is_free(:2, :), dim=1) .or. body%constraints%rigid_of > 0
         is_held([slave%mirrored_node, master%mirrored_node]) = .false.
         pair%held_node = pack([(i, i=1, size(is_held))], is_held .and. (is_corner .or. is_master))
         allocate (pair%shared_node(0), pair%joined_node(0), pair%open_node(0), &
            pair%idle_side(2, 0))
         pair%end_node = [open_ends(slave, body), open_ends(master, body)]
         pair%sharp_node = pack(master%side(2, :), [(is_sharp(i), i=1, master%n_sides)])
      end associate
      call move_pair(pair, body%mesh%coordinates)

   contains

      !> Whether the line of the master has a corner at the end of a side.
      pure logical function is_sharp(side)
         integer, intent(in) :: side !! the side

         is_sharp = .false.
         associate (master => pair%master)
            if (master%next(side) > 0) is_sharp = dot_product(master%normal(:, 2, side), &
               master%normal(:, 1, master%next(side))) < sharp
         end associate
      end function is_sharp

   end subroutine new_moved_pair

   !> The ends of a surface beyond which the boundary goes on without a corner: contact may leave it there.
   pure function open_ends(surface, body) result(nodes)
      type(surface_t), intent(in) :: surface !! the surface
      type(meshed_body_t), intent(in) :: body !! mesh and its boundary
      integer, allocatable :: nodes(:)
      real(dp) :: corner(2, 3), normal(2, 3)
      integer :: i, j, k, nodes_beside(3)

      allocate (nodes(0))
      do i = 1, surface%n_sides
         do k = 1, 2
            associate (node => surface%side(k, i))
               if (any(surface%side(3 - k, :) == node) .or. any(surface%mirrored_node == node)) cycle
               do j = 1, size(body%outer)
                  nodes_beside = body%mesh%side(side_element(body%outer(j)), side_place(body%outer(j)))
                  if (nodes_beside(3 - k) /= node) cycle
                  call place_side(corner, normal, nodes_beside, body%mesh%coordinates)
                  if (dot_product(normal(:, 3 - k), surface%normal(:, k, i)) >= sharp) nodes = [nodes, node]
               end do
            end associate
         end do
      end do
   end function open_ends

   !> Puts both surfaces at present places, and finds where they face each other.
   pure subroutine move_pair(pair, coordinates, keeps_carriers)
      type(mortar_pair_t), intent(inout) :: pair !! the pair
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (2, n_nodes) [L]
      logical, intent(in), optional :: keeps_carriers
         !! whether the same points as before carry the hats; no without it
      real(dp) :: normal(2, size(pair%node))
      integer :: i

      call pair%slave%move(coordinates)
      call pair%master%move(coordinates)
      do i = 1, pair%slave%n_sides
         normal(:, pair%point_of(:, i)) = pair%slave%normal(:, :2, i)
      end do
      pair%frame = new_frames(normal, size(pair%frame, 1))
      call find_facing_parts(pair)
      pair%covered_share = spread(0.0_dp, 1, size(pair%node))
      pair%covered_share(pair%point_of(1, :)) = sum(pair%part, dim=1)
      if (present(keeps_carriers)) then
         if (keeps_carriers) return
      end if
      call choose_carriers(pair)
   end subroutine move_pair

   !> Chooses the points that carry the hats: of a sliver or of a held corner the neighbor that is covered most.
   pure subroutine choose_carriers(pair)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, its covered parts found
      real(dp), dimension(size(pair%node)) :: covered, whole
      logical :: is_held(size(pair%node))
      real(dp) :: length
      integer :: i, j, k, p, q

      covered = 0.0_dp
      whole = 0.0_dp
      do i = 1, pair%slave%n_sides
         length = norm2(pair%slave%corner(:, 2, i) - pair%slave%corner(:, 1, i))
         associate (points => pair%point_of(:, i))
            covered(points) = covered(points) + length*pair%part(:, i)
            whole(points) = whole(points) + 0.5_dp*length
         end associate
      end do
      is_held = .false.
      do i = 1, size(pair%segments)
         associate (segment => pair%segments(i))
            if (.not. any([(any(pair%held_node == pair%master%side(k, segment%master)), k=1, 2)])) cycle
            do k = 1, 2
               p = pair%point_of(k, segment%slave)
               is_held(p) = is_held(p) .or. any(pair%held_node == pair%node(p))
            end do
         end associate
      end do
      covered = merge(0.0_dp, covered/whole, is_held)
      pair%carrier = [(p, p=1, size(pair%node))]
      do j = 1, 2*pair%slave%n_sides
         ! Forth and back along the line: of held corners the last hands on what the others handed to it.
         i = merge(j, 2*pair%slave%n_sides + 1 - j, j <= pair%slave%n_sides)
         if (.not. sum(pair%part(:, i)) > 0.0_dp) cycle
         do k = 1, 2
            p = pair%point_of(k, i)
            q = pair%point_of(3 - k, i)
            if (covered(p) < sliver*covered(q) .and. covered(q) > covered(pair%carrier(p))) pair%carrier(p) = q
            q = pair%carrier(q)
            if (is_held(p) .and. pair%carrier(p) == p .and. covered(q) > 0.0_dp) pair%carrier(p) = q
         end do
      end do
      ! The neighbor's hat may be handed on as well.
      do while (any(pair%carrier(pair%carrier) /= pair%carrier))
         pair%carrier = pair%carrier(pair%carrier)
      end do
   end subroutine choose_carriers

end module amontons_moved_pair
