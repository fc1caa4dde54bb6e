!> A pair of boundary sets that face each other: their surfaces, their segments, and the corners of the slave that carry
!> multipliers.
!>
!> The contact points of a pair: multipliers on the slave, integrals D and M, gaps.
!>
!> The relative displacement of point p is w_p = (sum D_pj u_j - sum M_pl u_l) / D_p, D_pj the integral of the
!> multiplier's function psi_p times the shape function of the slave's node j, M_pl that times the shape function of the
!> master's node l where the ray meets it, D_p the integral of psi_p. Both are integrated at the same quadrature points,
!> so that sum D_pj = sum M_pl = D_p and the forces on both bodies cancel exactly. The multiplier is a force, stress
!> times D_p.
!>
!> On each side the functions are dual to the hats of its corners over the part that faces the master: the integral of
!> psi_p times the hat of q is 0 for q other than p (B. Wohlmuth, SIAM J. Numer. Anal. 38, 2000). Where the master ends
!> within a side, they are dual to the hats of the part up to this end, where the force of the last one acts. The part
!> begins where the side before begins if the master covers all of that side. Constant multipliers are 1 on their cell.
!> A bonded corner that a support guides has no multiplier along its tangent: the tangential function of its neighbor
!> on the side is 1, so that constant shear stays among the multipliers; D_p of the tangent is then another one than
!> that of the normal.
module amontons_mortar_pair
   use amontons_boundary, only: new_patch, patch_t
   use amontons_constraints, only: constraints_t
   use amontons_contact_set, only: pairing_t
   use amontons_dense, only: small_inverse
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face_pair, only: covered_faces, find_face_segments, integrate_faces, last_of_side, new_face_surface
   use amontons_kinds, only: dp
   use amontons_line, only: line_t
   use amontons_rounding, only: exceeds, input_rounding
   use amontons_surface, only: find_segments, gauss_rule, gauss_rule_t, meet_side, meshed_body_t, mortar_points_t, &
      mortar_segment_t, new_surface, surface_place_t, surface_t
   use amontons_taken, only: taken_t
   use amontons_text, only: place_text, short_text
   implicit none (type, external)
   private

   public :: cell_pieces, find_facing_parts, integrate_pair, least_cover, mortar_pair_t, mortar_piece_t, &
      mortar_points_t, new_mortar_pair, new_pair_surfaces, new_slave_alone, take_facing_sides

   !> Share of a side or cell that the master covers, from one end on, for a multiplier of the other end. Where it is
   !> less the multiplier would hold the master's slope, prolonged by far, and its pressure grow without bound. It is
   !> irrational: no mesh with decimal coordinates has such an end, and rounding would decide there [-].
   real(dp), parameter :: least_cover = sqrt(0.078_dp)

   !> A part of a slave side that faces one master side, and the multiplier functions of up to two points there, which
   !> are combinations of the linear shape functions of the side's corners.
   type :: mortar_piece_t
      type(mortar_segment_t) :: segment !! the part
      integer :: point(2) = 0 !! the points, 0 for none
      real(dp) :: psi(2, 2) = 1.0_dp !! hats that make up the multiplier's function of each point (point, corner) [-]
      real(dp) :: shear(2, 2) = 1.0_dp !! hats that make up its tangential function (point, corner) [-]
      real(dp) :: hat(2, 2) = 1.0_dp
         !! hats that make up the weight of gaps and friction (point, corner) [-]
   end type mortar_piece_t

   !> Nodes that a piece adds to the row of a point: those of both sides.
   integer, parameter :: n_piece_nodes = 6

   !> Points of the quadrature on a segment in the plane, in the first and in the second integration: exact for straight
   !> sides, and rounding is all that is left of the normals' curvature.
   integer, parameter :: n_quadrature_points(2) = [7, 10]

   !> The surfaces of a pair.
   type :: mortar_pair_t
      character(:), allocatable :: set !! name of the slave's boundary set
      character(:), allocatable :: against !! name of the master's boundary set
      character(:), allocatable :: label !! its name, SLAVE/MASTER
      type(patch_t) :: patch !! the slave's patch
      type(surface_t) :: slave !! the surface that carries the multipliers
      type(surface_t) :: master !! the surface of the other body
      type(mortar_segment_t), allocatable :: segments(:) !! segments in which they face each other
      real(dp) :: search = 0.0_dp !! largest magnitude of a gap [L]
      integer, allocatable :: node(:) !! the slave's corners that are points, in the order of the line (n)
      type(line_t) :: line !! how the points follow each other
      real(dp), allocatable :: part(:, :)
         !! means of the hats of the corners of each side over what faces the master, times the share of the side that
         !! does; they sum to this share (corners, sides) [-]
      integer, allocatable :: carrier(:)
         !! the point that carries the hat of each, of an `amontons_moved_pair`; not allocated else (n)
      integer, allocatable :: end_node(:)
         !! ends of both lines of such a pair beyond which the boundary goes on without a corner
      integer, allocatable :: sharp_node(:) !! nodes of its master that have no mean normal
      integer, allocatable :: partner(:)
         !! the node of the master at the same place that a bonded point is joined to alone, 0 for none (n)
      real(dp), allocatable :: covered_share(:)
         !! share of the side that follows a corner that faces the master, with what its functions go on over; not
         !! allocated with cells (n) [-]
      integer, allocatable :: lead_side(:)
         !! the side whose functions each side has: of one that the master covers in part the whole side before it,
         !! else the side itself (sides)
      real(dp), allocatable :: reach(:, :)
         !! how far the functions of each side go on beyond both of its corners, in lengths of the side, negative where
         !! they end before (2, sides) [-]
      logical, allocatable :: is_fixed(:, :) !! whether supports bear the shear of a point (n_tangents, n)
      logical, allocatable :: gives_shear(:)
         !! whether the shear at such a point is that of its neighbors' multipliers: of bonded surfaces (n)
      integer, allocatable :: held_node(:)
         !! corners that are no points since supports hold them; of an `amontons_moved_pair` held nodes of both surfaces
      integer, allocatable :: shared_node(:) !! corners that are no points since they belong to an earlier set
      integer, allocatable :: joined_node(:) !! corners that are no points since they are nodes of the master, too
      integer, allocatable :: open_node(:) !! corners of sides that face nothing
      real(dp), allocatable :: idle_side(:, :)
         !! middles of sides that transmit nothing, since earlier sets have all ends, but not the side (n_dim, sides)
         !! [L]
      integer, allocatable :: point_of(:, :) !! the point that each corner of each side is, 0 for none (corners, sides)
      type(mortar_segment_t), allocatable :: cells(:)
         !! parts of the slave's sides in cells of constant multipliers, and in the place of the master the point that
         !! the cell is, 0 for none; not allocated where the points are corners
      real(dp), allocatable :: frame(:, :, :)
         !! unit normal and tangents of each point, as columns (n_components, n_components, n) [-]
      character(:), allocatable :: shear_fault
         !! error for a contact set with friction; not allocated if shear can act on every side
      real(dp) :: jump(3) = 0.0_dp !! direction of the jump, the mean normal of the slave; 0 without one [-]
      integer :: lead = 0 !! the node whose own unknown along this direction is the jump; 0 without one
      logical :: is_jump_free = .false. !! whether it is an unknown, and not prescribed
      logical :: is_alone = .false. !! whether the surface is that of a set on a rigid obstacle, without a master
   contains
      procedure :: extend => mortar_pair_extend
      procedure :: is_set => mortar_pair_is_set
   end type mortar_pair_t

contains

   !> The linear shape functions of the two corners of a side (hat functions) [-].
   pure function hats(xi)
      real(dp), intent(in) :: xi !! the place, from -1 to 1 [-]
      real(dp) :: hats(2)

      hats = 0.5_dp*[1.0_dp - xi, 1.0_dp + xi]
   end function hats

   !> Gives the segments the dual functions of the corners that are points. If one corner of a side is no point, the
   !> function of the other is 1, so that constants remain among the multipliers.
   pure subroutine corner_pieces(pieces, pair, segments, n_points)
      type(mortar_piece_t), allocatable, intent(out) :: pieces(:) !! the pieces
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_segment_t), intent(in) :: segments(:) !! the segments, side by side
      integer, intent(in) :: n_points !! number of points of the quadrature
      type(mortar_piece_t) :: piece
      integer :: first, last, side, lead

      allocate (pieces(size(segments)))
      first = 1
      do while (first <= size(segments))
         last = last_of_side(segments, first)
         side = segments(first)%slave
         lead = pair%lead_side(side)
         piece = mortar_piece_t(segments(first), pair%point_of(:, lead))
         if (all(piece%point > 0)) then
            piece%hat = part_hats(pair, side, segments(first:last))
            if (any(pair%reach(:, lead) > 0.0_dp)) then
               piece%psi = matmul(dual_factors(pair, pack(segments, pair%lead_side(segments%slave) == lead), &
                  n_points), piece%hat)
            else
               piece%psi = matmul(dual_factors(pair, segments(first:last), n_points), piece%hat)
            end if
            piece%shear = merge(1.0_dp, piece%psi, spread(pair%gives_shear(piece%point([2, 1])) .and. &
               .not. pair%gives_shear(piece%point), 2, 2))
         end if
         pieces(first:last) = piece
         pieces(first:last)%segment = segments(first:last)
         first = last + 1
      end do
   end subroutine corner_pieces

   !> Gives the segments the hats of the corners, or of those that carry them.
   pure subroutine hat_pieces(pieces, pair, segments)
      type(mortar_piece_t), allocatable, intent(out) :: pieces(:) !! the pieces
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_segment_t), intent(in) :: segments(:) !! the segments
      real(dp), parameter :: own(2, 2) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
      integer :: i

      allocate (pieces(size(segments)))
      do i = 1, size(segments)
         associate (points => pair%carrier(pair%point_of(:, segments(i)%slave)))
            if (points(1) == points(2)) then
               pieces(i) = mortar_piece_t(segments(i), [points(1), 0])
            else
               pieces(i) = mortar_piece_t(segments(i), points, own, own, own)
            end if
         end associate
      end do
   end subroutine hat_pieces

   !> Cuts segments by cells of constant multipliers.
   pure subroutine cell_pieces(pieces, segments, cells)
      type(mortar_piece_t), allocatable, intent(out) :: pieces(:) !! the pieces
      type(mortar_segment_t), intent(in) :: segments(:) !! the segments
      type(mortar_segment_t), intent(in) :: cells(:)
         !! parts of the slave's sides; in the place of the master the point that their cell is, 0 for none
      real(dp) :: range(2)
      integer :: i, k

      allocate (pieces(0))
      do k = 1, size(cells)
         do i = 1, size(segments)
            if (segments(i)%slave /= cells(k)%slave) cycle
            range = [max(segments(i)%range(1), cells(k)%range(1)), min(segments(i)%range(2), cells(k)%range(2))]
            if (.not. range(1) < range(2)) cycle
            pieces = [pieces, mortar_piece_t(mortar_segment_t(segments(i)%slave, segments(i)%master, range), &
               [cells(k)%master, 0])]
         end do
      end do
   end subroutine cell_pieces

   !> The hats of the part of the slave that the functions of a side are for, as combinations of the side's own hats: of
   !> the part of the side that faces the master, or of the length up to the ends of the master (2, 2) [-].
   pure function part_hats(pair, side, segments) result(part)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      integer, intent(in) :: side !! the side of the slave
      type(mortar_segment_t), intent(in) :: segments(:) !! its segments
      real(dp) :: part(2, 2), at(2)
      integer :: lead

      lead = pair%lead_side(side)
      if (any(pair%reach(:, lead) > 0.0_dp)) then
         associate (chord => pair%slave%corner(:, 2, [lead, side]) - pair%slave%corner(:, 1, [lead, side]))
            at = [0.0_dp, norm2(chord(:, 2))/norm2(chord(:, 1))]
         end associate
         if (lead /= side) at = at + merge(1.0_dp, -at(2), pair%slave%side(1, side) == pair%slave%side(2, lead))
         part(2, :) = (at + pair%reach(1, lead))/(1.0_dp + sum(pair%reach(:, lead)))
         part(1, :) = 1.0_dp - part(2, :)
      else
         part = small_inverse(reshape([hats(segments(1)%range(1)), hats(segments(size(segments))%range(2))], [2, 2]))
      end if
   end function part_hats

   !> The functions dual to the hats of a part of the slave, as combinations of these hats: diag(d) M^-1 with d and M
   !> the integrals of the hats and of their products (2, 2) [-].
   pure function dual_factors(pair, segments, n_points) result(dual)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_segment_t), intent(in) :: segments(:) !! the segments of the part
      integer, intent(in) :: n_points !! number of points of the quadrature
      real(dp) :: dual(2, 2), part(2, 2), mean(2), mass(2, 2), local(2), at, area
      type(gauss_rule_t) :: rule
      type(surface_place_t) :: place
      integer :: i, k

      rule = gauss_rule(n_points)
      mean = 0.0_dp
      mass = 0.0_dp
      do i = 1, size(segments)
         part = part_hats(pair, segments(i)%slave, segments)
         do k = 1, n_points
            associate (range => segments(i)%range)
               at = 0.5_dp*(sum(range) + (range(2) - range(1))*rule%xi(k))
               place = pair%slave%place(segments(i)%slave, at)
               area = 0.5_dp*(range(2) - range(1))*rule%weight(k)*norm2(place%along)*place%depth
            end associate
            local = matmul(part, hats(at))
            mean = mean + area*local
            mass(:, 1) = mass(:, 1) + area*local*local(1)
            mass(:, 2) = mass(:, 2) + area*local*local(2)
         end do
      end do
      dual = spread(mean, 2, 2)*small_inverse(mass)
   end function dual_factors

   !> Integrates D, M, normals and gaps over the points of a pair.
   pure subroutine integrate_pair(points, pair, segments, is_again)
      type(mortar_points_t), intent(out) :: points !! the points
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_segment_t), intent(in) :: segments(:) !! its segments, or another cut of the same surfaces
      logical, intent(in) :: is_again !! whether it is the second integration, of the certificate
      real(dp), dimension(size(pair%frame, 3)) :: hat_area, shear_area
      logical :: has_partner(size(pair%frame, 3))
      integer :: axis, i, n, p

      n = size(pair%frame, 3)
      has_partner = .false.
      if (.not. allocated(pair%cells)) has_partner = pair%partner > 0
      allocate (points%area(n), points%length(n), points%center(size(pair%slave%corner, 1), n), source=0.0_dp)
      points%foot = points%center
      if (size(points%center, 1) == 2) then
         call integrate_sides(points, hat_area, shear_area, has_partner, pair, segments, &
            n_quadrature_points(merge(2, 1, is_again)))
      else
         call integrate_faces(points, pair%slave, pair%master, segments, pair%point_of, pair%patch%faces, is_again)
         points%quadrature%normal = pair%frame(:, 1, :)
         hat_area = points%area
         shear_area = points%area
      end if
      do p = 1, n
         if (points%rows%start(p + 1) - points%rows%start(p) == 1) cycle
         if (has_partner(p)) then
            associate (first => points%rows%start(p), corner => findloc(pair%slave%side(:2, :), pair%node(p)))
               points%center(:, p) = pair%slave%corner(:, corner(1), corner(2))
               points%rows%node(first:first + 1) = [pair%node(p), pair%partner(p)]
               do axis = 1, size(pair%frame, 1)
                  points%rows%block(axis, axis, first:first + 1) = [1.0_dp, -1.0_dp]
               end do
            end associate
            cycle
         end if
         points%center(:, p) = points%center(:, p)/points%area(p)
         points%foot(:, p) = points%foot(:, p)/hat_area(p)
         associate (first => points%quadrature%start(p), last => points%quadrature%start(p + 1) - 1)
            points%quadrature%share(first:last) = points%quadrature%share(first:last)/hat_area(p)
         end associate
         associate (first => points%rows%start(p), last => points%rows%start(p + 1) - 1)
            do axis = 1, size(pair%frame, 1)
               points%rows%block(axis, axis, first:last) = points%rows%block(axis, axis, first:last) &
                  /merge(shear_area(p), points%area(p), axis == 2)
            end do
         end associate
      end do
      call points%rows%merge_nodes()
      do p = 1, n
         do i = points%rows%start(p), points%rows%start(p + 1) - 1
            points%rows%block(:, :, i) = matmul(pair%frame(:, :, p), points%rows%block(:, :, i))
         end do
         if (size(points%center, 1) == 2 .and. .not. allocated(pair%carrier)) cycle
         ! In space, and of a moved pair, the node of a point is its first one.
         associate (first => points%rows%start(p), last => points%rows%start(p + 1) - 1)
            i = first - 1 + findloc(points%rows%node(first:last), pair%node(p), dim=1)
            points%rows%node([first, i]) = points%rows%node([i, first])
            points%rows%block(:, :, [first, i]) = points%rows%block(:, :, [i, first])
         end associate
      end do
   end subroutine integrate_pair

   !> Integrates them in the plane, not yet over the areas.
   pure subroutine integrate_sides(points, hat_area, shear_area, has_partner, pair, segments, n_points)
      type(mortar_points_t), intent(inout) :: points !! the points
      real(dp), intent(out) :: hat_area(:) !! integrals of the averaging functions (n) [L^2]
      real(dp), intent(out) :: shear_area(:) !! integrals of the tangential functions (n) [L^2]
      logical, intent(in) :: has_partner(:) !! whether the points are joined to a node of the master alone (n)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_segment_t), intent(in) :: segments(:) !! its segments
      integer, intent(in) :: n_points !! number of points of the quadrature
      type(mortar_piece_t), allocatable :: pieces(:)
      type(gauss_rule_t) :: rule
      integer, dimension(size(hat_area)) :: n_pieces, filled
      integer :: i, k, p, first_node, l, q, axis
      type(surface_place_t) :: place, foot
      real(dp) :: at, area, psi(2), hat, normal(2), begin(maxval(pair%patch%node)), &
         shares(n_piece_nodes, size(pair%frame, 1))

      if (allocated(pair%cells)) then
         call cell_pieces(pieces, segments, pair%cells)
      else if (allocated(pair%carrier)) then
         call hat_pieces(pieces, pair, segments)
      else
         call corner_pieces(pieces, pair, segments, n_points)
      end if
      n_pieces = 0
      do k = 1, 2*size(pieces)
         p = pieces((k + 1)/2)%point(2 - modulo(k, 2))
         if (p > 0) n_pieces(p) = n_pieces(p) + 1
      end do
      call points%rows%begin(max(1, n_piece_nodes*n_pieces + merge(2, 0, has_partner)), size(pair%frame, 1))
      call points%quadrature%begin(merge(n_points*n_pieces, 1, n_pieces > 0 .or. has_partner), size(normal))
      rule = gauss_rule(n_points)
      begin(pair%patch%node) = pair%patch%line%arc_length
      hat_area = 0.0_dp
      shear_area = 0.0_dp
      filled = 0
      ! A point that carries no hat has area 0, the displacement of its node alone, and the largest gap.
      do k = 1, merge(2*pair%slave%n_sides, 0, allocated(pair%carrier))
         associate (side => (k + 1)/2, end => 2 - modulo(k, 2), quadrature => points%quadrature)
            p = pair%point_of(end, side)
            if (n_pieces(p) > 0) cycle
            points%rows%node(points%rows%start(p)) = pair%node(p)
            do axis = 1, size(pair%frame, 1)
               points%rows%block(axis, axis, points%rows%start(p)) = 1.0_dp
            end do
            points%center(:, p) = pair%slave%corner(:, end, side)
            points%foot(:, p) = points%center(:, p)
            q = quadrature%start(p)
            quadrature%position(:, q) = points%center(:, p)
            quadrature%normal(:, q) = pair%frame(:2, 1, p)
            quadrature%outward(q) = 1.0_dp
            quadrature%arc_length(q) = begin(pair%node(p))
            quadrature%gap(q) = pair%search
            quadrature%share(q) = 1.0_dp
         end associate
      end do
      do i = 1, size(pieces)
         associate (segment => pieces(i)%segment, node => points%rows%node, quadrature => points%quadrature, &
            slave => pair%slave, master => pair%master)
            do l = 1, size(rule%xi)
               at = 0.5_dp*(sum(segment%range) + (segment%range(2) - segment%range(1))*rule%xi(l))
               place = slave%place(segment%slave, at)
               normal = place%normal/norm2(place%normal)
               foot = master%place(segment%master, place_on(meet_side(master%corner(:, :, segment%master), &
                  place%position, normal)))
               area = 0.5_dp*(segment%range(2) - segment%range(1))*rule%weight(l)*norm2(place%along)*place%depth
               do k = 1, 2
                  p = pieces(i)%point(k)
                  if (p == 0) cycle
                  first_node = points%rows%start(p) + n_piece_nodes*filled(p) - 1
                  psi = [dot_product(pieces(i)%psi(k, :), hats(at)), dot_product(pieces(i)%shear(k, :), hats(at))]*area
                  hat = dot_product(pieces(i)%hat(k, :), hats(at))*area
                  shares(:, 1) = psi(1)*[place%values, -foot%values]
                  shares(:, 2) = psi(2)*[place%values, -foot%values]
                  ! Around the axis angles are compared: depths are circumferences.
                  if (size(shares, 2) > 2) shares(:, 3) = psi(1)*[place%values, -foot%values*place%depth/foot%depth]
                  ! Blocks are diagonal first, the shares in the displacements along normal and tangents.
                  ! A straight side has no middle node: its part there is 0, and no entry remains of it.
                  node(first_node + 1:first_node + 6) = [slave%side(:3, segment%slave), master%side(:3, segment%master)]
                  associate (block => points%rows%block(:, :, first_node + 1:first_node + 6))
                     do axis = 1, size(shares, 2)
                        block(axis, axis, :) = block(axis, axis, :) + shares(:, axis)
                     end do
                  end associate
                  points%area(p) = points%area(p) + psi(1)
                  shear_area(p) = shear_area(p) + psi(2)
                  points%length(p) = points%length(p) + hat/place%depth
                  points%center(:, p) = points%center(:, p) + psi(1)*place%position
                  points%foot(:, p) = points%foot(:, p) + hat*foot%position
                  hat_area(p) = hat_area(p) + hat
                  q = quadrature%start(p) + size(rule%xi)*filled(p) + l - 1
                  quadrature%position(:, q) = place%position
                  quadrature%normal(:, q) = normal
                  quadrature%outward(q) = 1.0_dp
                  quadrature%arc_length(q) = begin(slave%side(1, segment%slave)) &
                     + norm2(place%position - slave%corner(:, 1, segment%slave))
                  quadrature%share(q) = hat
                  quadrature%gap(q) = dot_product(foot%position - place%position, normal)
               end do
            end do
         end associate
         do k = 1, 2
            p = pieces(i)%point(k)
            if (p > 0) filled(p) = filled(p) + 1
         end do
      end do
   end subroutine integrate_sides

   !> Selects from two local coordinates the one that lies on the side, from -1 to 1.
   pure real(dp) function place_on(xi)
      real(dp), intent(in) :: xi(2) !! the places [-]

      place_on = xi(minloc(abs(xi), dim=1))
   end function place_on

   !> Whether it is a pair of two surfaces: that of a contact set with a rigid obstacle is not.
   elemental logical function mortar_pair_is_set(self) result(is_set)
      class(mortar_pair_t), intent(in) :: self !! the pair

      is_set = allocated(self%segments) .and. .not. self%is_alone
   end function mortar_pair_is_set

   !> Extends values at corners in space that are points to other nodes of their faces: other corners have the mean of
   !> these, as the functions of the multipliers do, and middle nodes that of the corners beside them.
   pure subroutine mortar_pair_extend(self, values)
      class(mortar_pair_t), intent(in) :: self !! the pair
      real(dp), intent(inout) :: values(:, :) !! the values at the nodes (any, n_nodes)
      integer :: i, k

      do i = 1, merge(self%slave%n_sides, 0, allocated(self%segments))
         associate (nodes => self%slave%side(:, i), n => self%slave%n_corners(i))
            associate (own => pack(nodes(:n), self%point_of(:n, i) > 0))
               do k = 1, merge(n, 0, size(own) > 0)
                  if (self%point_of(k, i) == 0) values(:, nodes(k)) = sum(values(:, own), dim=2)/size(own)
               end do
            end associate
            do k = n + 1, self%slave%n_nodes(i)
               values(:, nodes(k)) = 0.5_dp*sum(values(:, nodes([k - n, 1 + modulo(k - n, n)])), dim=2)
            end do
         end associate
      end do
   end subroutine mortar_pair_extend

   !> Finds where two boundary sets face each other.
   subroutine new_mortar_pair(pair, set, pairing, body, taken, error)
      type(mortar_pair_t), intent(out) :: pair !! the pair
      character(*), intent(in) :: set !! name of the slave's boundary set
      type(pairing_t), intent(in) :: pairing !! the master, and how far gaps may reach
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(taken_t), intent(in) :: taken !! what earlier sets have
      type(error_t), allocatable, intent(out) :: error
         !! an error of `new_pair_surfaces`, sets that do not face each other, or normals that cross before they meet
         !! the master
      logical :: is_master(body%mesh%n_nodes)

      call new_pair_surfaces(pair, is_master, set, pairing, body, .false., error)
      if (allocated(error)) return
      call find_facing_parts(pair)
      if (size(pair%segments) == 0) then
         call explain_distance(pair, error)
         return
      end if
      if (size(pair%slave%corner, 1) == 2) call check_rays(pair, error)
      if (allocated(error)) return
      call number_points(pair, body%constraints, taken, is_master, pairing%is_tied)
   end subroutine new_mortar_pair

   !> Makes the slave of a rigid obstacle in space: its points are the corners of its faces, all of which face the
   !> obstacle.
   pure subroutine new_slave_alone(pair, patch, normal, body, taken)
      type(mortar_pair_t), intent(out) :: pair !! the pair, without a master
      type(patch_t), intent(in) :: patch !! the patch of the set
      real(dp), intent(in) :: normal(:, :) !! unit normals of its nodes, along which gaps count (3, n_nodes) [-]
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(taken_t), intent(in) :: taken !! what earlier sets have
      integer :: i

      pair%is_alone = .true.
      pair%patch = patch
      pair%patch%normal = normal
      call new_face_surface(pair%slave, body, pair%patch, patch%node(:0))
      pair%segments = [(mortar_segment_t(slave=i), i=1, pair%slave%n_sides)]
      ! The obstacle covers each function as a whole.
      allocate (pair%part(size(pair%slave%normal, 2) - 1, pair%slave%n_sides), source=1.0_dp)
      call number_points(pair, body%constraints, taken, spread(.false., 1, body%mesh%n_nodes), .false.)
   end subroutine new_slave_alone

   !> Makes the surfaces of two boundary sets.
   subroutine new_pair_surfaces(pair, is_master, set, pairing, body, is_apart, error)
      type(mortar_pair_t), intent(out) :: pair !! the pair, its surfaces set
      logical, intent(out) :: is_master(:) !! the nodes of the master (n_nodes)
      character(*), intent(in) :: set !! name of the slave's boundary set
      type(pairing_t), intent(in) :: pairing !! the master, and how far gaps may reach
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      logical, intent(in) :: is_apart !! whether the bodies must not be joined at the ends of the slave either
      type(error_t), allocatable, intent(out) :: error !! a missing set, bodies that are joined, or corners in the slave
      type(patch_t) :: facing
      integer :: i

      pair%label = pairing%label(set)
      pair%set = set
      pair%against = pairing%against
      if (set == pair%against) then
         call new_error(error, input_refused, "self contact of the set '"//set//"': split the set in two")
         return
      end if
      call new_patch(pair%patch, body%mesh, set, error, body%materials)
      if (allocated(error)) return
      call new_patch(facing, body%mesh, pair%against, error)
      if (allocated(error)) return
      is_master = .false.
      is_master(facing%node) = .true.
      ! At an end of the slave bodies may be joined, as at a crack's tip; in space along edges of faces.
      associate (patch => pair%patch)
         if (allocated(patch%line)) then
            i = findloc(is_master(patch%node) .and. (is_apart .or. patch%line%next > 0 .and. patch%line%before() > 0), &
               .true., dim=1)
            if (i > 0) i = patch%node(i)
         else
            i = findloc([(all(is_master(pack(patch%faces(i)%node, patch%faces(i)%node > 0))), &
               i=1, size(patch%faces))], .true., dim=1)
            if (i > 0) i = patch%faces(i)%node(1)
         end if
         if (i > 0) then
            call new_error(error, input_refused, "'"//pair%set//"' and '"//pair%against//"' share nodes, as at "// &
               place_text(body%mesh%coordinates(:, i))//': these bodies are joined there, or both sets have a side')
            return
         end if
      end associate
      if (allocated(facing%line)) then
         call new_surface(pair%slave, body, pair%patch, facing)
         call new_surface(pair%master, body, facing, pair%patch)
      else
         call new_face_surface(pair%slave, body, pair%patch, facing%node)
         call new_face_surface(pair%master, body, facing, pair%patch%node)
      end if
      if (pair%slave%corner_node > 0) then
         call new_error(error, input_refused, "the set '"//set//"' has a corner of more than 40 degrees at "// &
            place_text(body%mesh%coordinates(:, pair%slave%corner_node))//': make a set of each side of it')
         return
      end if
      pair%search = pairing%search
      if (.not. pairing%search > 0.0_dp) pair%search = 2.0_dp*max(pair%slave%longest, pair%master%longest)
   end subroutine new_pair_surfaces

   !> Finds the segments of a pair, and the parts of the slave's hats that face the master.
   pure subroutine find_facing_parts(pair)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, its surfaces set
      integer :: i

      if (size(pair%slave%corner, 1) == 2) then
         call find_segments(pair%segments, pair%slave, pair%master, pair%search)
         pair%part = covered_parts(pair)
      else
         call find_face_segments(pair%segments, pair%slave, pair%master, pair%search, .false.)
         pair%part = covered_faces(pair%slave, pair%master, pair%segments)
      end if
      ! Sides that face next to nothing are left out.
      do i = 1, pair%slave%n_sides
         if (.not. sum(pair%part(:, i)) >= input_rounding) pair%part(:, i) = 0.0_dp
      end do
      pair%segments = pack(pair%segments, sum(pair%part(:, pair%segments%slave), dim=1) > 0.0_dp)
   end subroutine find_facing_parts

   !> Refuses a slave whose normals cross before they meet the master, as those of a concave surface do beyond its
   !> center of curvature: several slave positions would then face one master position. As long as normals do not cross,
   !> their feet on the master follow the order of the slave.
   pure subroutine check_rays(pair, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, with its segments
      type(error_t), allocatable, intent(out) :: error !! they do
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
            if (dot_product(feet(:, 2) - feet(:, 1), way) > -input_rounding*sum(way**2)) cycle
            call new_error(error, input_refused, "normals of '"//pair%set//"' cross before they meet '"// &
               pair%against//"', as at "//place_text(place(1)%position)// &
               ': the gap is larger than the radius of the hollow; exchange the sets, or give a smaller search')
            return
         end associate
      end do
   end subroutine check_rays

   !> Makes the error that two sets do not face each other, with the reason.
   pure subroutine explain_distance(pair, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, without segments
      type(error_t), allocatable, intent(out) :: error !! the reason
      real(dp) :: distance(size(pair%master%corner(1, :, :))), least
      integer :: i, j, n, at(2)

      least = huge(least)
      at = 1
      n = size(pair%slave%corner, 2)
      do i = 1, pair%slave%n_sides
         do j = 1, n
            distance = norm2(reshape(pair%master%corner, [size(pair%master%corner, 1), size(distance)]) &
               - spread(pair%slave%corner(:, j, i), 2, size(distance)), dim=1)
            if (minval(distance) < least) at = [i, (minloc(distance, dim=1) + n - 1)/n]
            least = min(least, minval(distance))
         end do
      end do
      associate (set => pair%set, against => pair%against, middle => size(pair%slave%normal, 2))
         if (dot_product(pair%slave%normal(:, middle, at(1)), pair%master%normal(:, middle, at(2))) > 0.0_dp) then
            call new_error(error, input_refused, "the normals of '"//set//"' point away from '"//against// &
               "', or those of '"//against//"' away from '"//set//"': both sets face the same way")
         else
            call new_error(error, input_refused, "the sets '"//set//"' and '"//against//"' do not face each other: "// &
               "no normal of '"//set//"' meets '"//against//"' within search = "//short_text(pair%search)// &
               '; the smallest distance is '//short_text(least))
         end if
      end associate
   end subroutine explain_distance

   !> Chooses the corners that are points: those that face the master and that supports leave a motion on which
   !> multipliers act. Finds the sides that transmit no force although no support holds them.
   pure subroutine number_points(pair, constraints, taken, is_master, is_tied)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its segments
      type(constraints_t), intent(in) :: constraints !! the supports
      type(taken_t), intent(in) :: taken !! what earlier sets have
      logical, intent(in) :: is_master(:) !! the nodes of the master (nodes)
      logical, intent(in) :: is_tied !! whether the surfaces are bonded: a point may then move along its tangent alone
      real(dp) :: normal(size(pair%slave%corner, 1), size(is_master))
      logical :: is_open(size(is_master)), faces(size(is_master)), is_idle(pair%slave%n_sides)
      integer, allocatable :: facing(:)
      integer :: i, k, n_dim, point(size(is_master))
      real(dp) :: share(pair%slave%n_sides)

      n_dim = size(normal, 1)
      share = sum(pair%part, dim=1)
      call continue_sides(pair, pair%part, share, constraints)
      is_open(pair%patch%node) = .true.
      do i = 1, size(share)
         associate (n => pair%slave%n_corners(i), nodes => pair%slave%side(:pair%slave%n_nodes(i), i))
            normal(:, nodes(:n)) = pair%slave%normal(:, :n, i)
            if (share(i) > 0.0_dp) is_open(nodes(:n)) = .false.
            is_open(nodes(n + 1:)) = .false.
         end associate
      end do
      pair%open_node = pack(pair%patch%node, is_open(pair%patch%node))
      faces = facing_corners(pair, share, size(is_master))
      ! A single point would be a hinge, as two are in space; but another set may need the corner beyond the end.
      do i = 1, merge(size(share), 0, count(faces(pair%patch%node)) < n_dim .and. .not. taken%is_slave_again)
         if (share(i) > 0.0_dp) faces(pair%slave%side(:pair%slave%n_corners(i), i)) = .true.
      end do
      allocate (pair%held_node(0), pair%shared_node(0), pair%joined_node(0), pair%node(0))
      facing = pack(pair%patch%node, faces(pair%patch%node))
      do i = 1, size(facing)
         associate (node => facing(i))
            if (taken%node(node)) then
               pair%shared_node = [pair%shared_node, node]
            else if (is_master(node)) then
               pair%joined_node = [pair%joined_node, node]
            else if (.not. merge(any(constraints%is_free(:n_dim, node)), &
               constraints%leaves_free(node, normal(:, node)), is_tied)) then
               pair%held_node = [pair%held_node, node]
            else
               pair%node = [pair%node, node]
            end if
         end associate
      end do
      pair%frame = constraints%contact_frames(pair%node, normal(:, pair%node))
      pair%is_fixed = constraints%fixed_tangents(pair%node, pair%frame)
      point = 0
      point(pair%node) = [(i, i=1, size(pair%node))]
      allocate (pair%point_of(size(pair%part, 1), pair%slave%n_sides), source=0)
      allocate (pair%line%next(size(pair%node)), pair%partner(size(pair%node)), source=0)
      allocate (pair%covered_share(size(pair%node)), source=0.0_dp)
      pair%gives_shear = pair%is_fixed(1, :) .and. is_tied
      do i = 1, pair%slave%n_sides
         associate (n => pair%slave%n_corners(i), nodes => pair%slave%side(:, i), first => point(pair%slave%side(1, i)))
            pair%point_of(:n, i) = point(nodes(:n))
            if (first > 0) then
               pair%line%next(first) = pair%point_of(2, i)
               pair%covered_share(first) = share(i) + sum(max(0.0_dp, pair%reach(:, i)))
            end if
            is_idle(i) = share(i) > 0.0_dp .and. all(pair%point_of(:, i) == 0) .and. &
               .not. any([(any(pair%held_node == nodes(k)), k=1, n)]) .and. &
               .not. taken%face(pair%patch%faces(i)%number)
         end associate
      end do
      pair%idle_side = pair%slave%corner(:, size(pair%slave%corner, 2), pack([(i, i=1, size(is_idle))], is_idle))
   end subroutine number_points

   !> Whether the master covers enough of the linear function of each corner for a multiplier: in the plane of a side
   !> beside it, in space of all sides beside it; there one corner of each side has one in any case.
   pure function facing_corners(pair, share, n_nodes) result(faces)
      type(mortar_pair_t), intent(in) :: pair !! the pair, with its segments
      real(dp), intent(in) :: share(:) !! the covered share of each side (sides) [-]
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      logical :: faces(n_nodes)
      real(dp), dimension(n_nodes) :: covered, whole
      integer :: i

      faces = .false.
      covered = 0.0_dp
      whole = 0.0_dp
      do i = 1, size(share)
         associate (n => pair%slave%n_corners(i), nodes => pair%slave%side(:pair%slave%n_corners(i), i), &
            area => sum(pair%patch%faces(i)%area))
            covered(nodes) = covered(nodes) + area*pair%part(:n, i)
            whole(nodes) = whole(nodes) + area/n
            if (pair%lead_side(i) == i) where (pair%part(:n, i) > least_cover/n*share(i)) faces(nodes) = .true.
         end associate
      end do
      if (size(pair%slave%corner, 1) == 2) return
      faces = .false.
      do i = 1, size(share)
         if (.not. share(i) > 0.0_dp) cycle
         associate (nodes => pair%slave%side(:pair%slave%n_corners(i), i))
            where (.not. exceeds(min(least_cover**2, maxval(covered(nodes)/whole(nodes))), &
               covered(nodes)/whole(nodes))) faces(nodes) = .true.
         end associate
      end do
   end function facing_corners

   !> Finds the sides in the plane that the master covers in part, from a corner on. The functions of the side before
   !> this corner go on over them if it is covered as a whole, or from this corner on and the other one by a share below
   !> the least, and no support holds or guides its corners: these have tangential functions of their own.
   pure subroutine continue_sides(pair, part, share, constraints)
      type(mortar_pair_t), intent(inout) :: pair !! the pair
      real(dp), intent(in) :: part(:, :) !! covered parts of the hats of both corners of each side (2, sides) [-]
      real(dp), intent(in) :: share(:) !! their sums: the covered share of each side (sides) [-]
      type(constraints_t), intent(in) :: constraints !! the supports
      ! Share of a whole side: a corner so close beyond the master's end has a multiplier. It is irrational, as
      ! `least_cover` is.
      real(dp), parameter :: whole = sqrt(0.9_dp)
      real(dp) :: length(size(share))
      integer :: i, k, n

      pair%lead_side = [(i, i=1, size(share))]
      allocate (pair%reach(2, size(share)), source=0.0_dp)
      length = norm2(pair%slave%corner(:, 2, :) - pair%slave%corner(:, 1, :), dim=1)
      do i = 1, merge(size(share), 0, size(pair%slave%corner, 1) == 2)
         if (share(i) >= whole .or. .not. share(i) > 0.0_dp) cycle
         do k = 1, 2
            ! The mean of a corner's hat over a part that begins at the other corner is half its share.
            n = findloc(pair%slave%side(3 - k, :), pair%slave%side(k, i), dim=1)
            if (n == 0 .or. exceeds(part(3 - k, i), 0.5_dp*share(i)**2)) cycle
            if (.not. all(constraints%is_free(:2, pair%slave%side(:2, n)))) cycle
            if (exceeds(1.0_dp, share(n))) then
               if (share(i) > least_cover .or. .not. share(n) > least_cover) cycle
               if (exceeds(part(k, n), 0.5_dp*share(n)**2)) cycle
               pair%reach(k, n) = share(n) - 1.0_dp
            end if
            pair%lead_side(i) = n
            pair%reach(3 - k, n) = share(i)*length(i)/length(n)
         end do
      end do
   end subroutine continue_sides

   !> The part of the hats of both corners of each side of the slave that faces the master; their sum is the share of
   !> the side that does (2, sides) [-].
   pure function covered_parts(pair) result(part)
      type(mortar_pair_t), intent(in) :: pair !! the pair, with its segments
      real(dp) :: part(2, pair%slave%n_sides)
      integer :: i

      part = 0.0_dp
      do i = 1, size(pair%segments)
         associate (segment => pair%segments(i))
            part(:, segment%slave) = part(:, segment%slave) &
               + 0.5_dp*(segment%range(2) - segment%range(1))*hats(0.5_dp*sum(segment%range))
         end associate
      end do
   end function covered_parts

   !> Adds what of a slave faces its master to what is taken; of a side that the master covers only in part the rest is
   !> left to another set.
   pure subroutine take_facing_sides(taken, pair)
      type(taken_t), intent(inout) :: taken !! what contact sets and ties have
      type(mortar_pair_t), intent(in) :: pair !! the pair
      real(dp) :: share(pair%slave%n_sides)
      integer :: i, k

      share = sum(pair%part, dim=1)
      do i = 1, pair%slave%n_sides
         if (.not. share(i) > 0.0_dp) cycle
         associate (face => pair%patch%faces(i), n => pair%slave%n_corners(i))
            ! The corner beyond the master's end has no function; in space those that are no points, nor middle nodes
            ! between two of them.
            if (size(pair%slave%corner, 1) == 2) then
               call taken%add(face, face%node(merge(1, 3, pair%lead_side(i) == i):), .not. exceeds(1.0_dp, share(i)))
            else
               call taken%add(face, [(merge(face%node(k), 0, pair%point_of(k, i) > 0), k=1, n), &
                  (merge(face%node(k), 0, any(pair%point_of([k - n, 1 + modulo(k - n, n)], i) > 0)), &
                  k=n + 1, face%n_nodes)], .not. exceeds(1.0_dp, share(i)))
            end if
         end associate
      end do
   end subroutine take_facing_sides

end module amontons_mortar_pair
