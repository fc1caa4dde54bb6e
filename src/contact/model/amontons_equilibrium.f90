!> Bodies that supports do not hold: whether admissible contact forces can balance their loads, and the rigid motion
!> that moves a body which only contact holds onto its obstacles.
!>
!> Equilibrium: the works of the loads on the free rigid motions must be a combination of the works of extreme contact
!> forces: with factors at least 0 those of n + phi t and n - phi t of the contact points (a cone), and those of n,
!> which rounding would lose between them for large friction; and, with factors up to a given slip bound, those of t and
!> -t. Otherwise, by Farkas' lemma, the remainder is a rigid motion that the loads drive and that no contact force
!> opposes enough: there is no equilibrium, and the body is free to move along it.
!>
!> The normals of the facets of a round line miss its center a little, so that huge forces with arms of both signs would
!> balance any moment. Loads therefore have no equilibrium either if a remainder is left with the normals of the circles
!> through neighboring nodes. In a pair the round line is that of the slave.
!>
!> Fit: rigid motions cause no elastic forces, so that the displacements of such a body may be counted from any of them.
!> Displacements that do cause forces may be millions of times smaller than the distance to the obstacle: counted from
!> the body's position on the obstacle, they keep their digits. If the gaps do not determine this position, as for a
!> hollow body that rests on its ends, it is found from the loads, which press a rigid body onto its obstacles, or from
!> the displacements of a start. Without loads it is the least motion from where the body was that ends all overlaps.
module amontons_equilibrium
   use amontons_assembly, only: from_unknowns, to_unknowns
   use amontons_body, only: body_t, largest_motion
   use amontons_condensation, only: condensed_load_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_rows, only: turned
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: bounded_remainder, symmetric_eigenvectors
   use amontons_error, only: error_t, new_error, no_equilibrium
   use amontons_friction_law, only: tangential_norm
   use amontons_kinds, only: dp
   use amontons_load_family, only: load_case_t, recover_displacement
   use amontons_rigid_motion, only: displacement_of_nodes, rigid_motions_t
   implicit none (type, external)
   private

   public :: can_be_wedged, check_balance, find_idle_motion, find_resting_motion, fit_rigid_motion, fit_travel, &
      imbalance_of_points, least_squares_amounts, on_round_line, recover_with_travel, round_normals, travel_of_nodes

   !> Number of directions of the extreme forces of a disc.
   integer, parameter :: n_directions = 16
   !> The ratio of a circle's circumference to its diameter.
   real(dp), parameter :: pi = acos(-1.0_dp)

   ! Gaps are differences of coordinates: some tens of their rounding errors.
   real(dp), parameter :: rounding = 1.0e-14_dp

contains

   !> Refuses loads that no contact forces can balance. Pieces that share contact points are considered together.
   pure subroutine check_balance(body, load_case, error)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium; names the motion
      integer :: leader(size(body%motions)), i

      leader = leading_pieces(body)
      do i = 1, size(leader)
         if (leader(i) == i .and. body%motions(i)%n_free > 0) call check_pieces(pack([(i, i=1, size(leader))], &
            leader == i), body, load_case, error)
         if (allocated(error)) return
      end do
   end subroutine check_balance

   !> For each piece the first of the pieces that it shares contact points with, directly or through others, among those
   !> that supports do not hold.
   pure function leading_pieces(body) result(leader)
      type(body_t), intent(in) :: body !! the body
      integer :: leader(size(body%motions)), piece(body%mesh%n_nodes), p, i, first, second

      do i = 1, size(leader)
         piece(body%motions(i)%node) = i
         leader(i) = i
      end do
      associate (rows => body%zone%rows)
         do p = 1, body%zone%n_points
            first = 0
            do i = rows%start(p), rows%start(p + 1) - 1
               second = leader(piece(rows%node(i)))
               if (body%motions(piece(rows%node(i)))%n_free == 0 .or. second == first) cycle
               if (first > 0) where (leader == max(first, second)) leader = min(first, second)
               first = merge(second, min(first, second), first == 0)
            end do
         end do
      end associate
   end function leading_pieces

   !> Refuses loads that no contact forces on some pieces can balance.
   pure subroutine check_pieces(pieces, body, load_case, error)
      integer, intent(in) :: pieces(:) !! the pieces
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium; names the motion
      ! A hundredth of the residual of methods, whose scale may be a small part of the loads that cancel; the other
      ! limit is for the center of gravity of a round body, whose position depends on the mesh.
      real(dp), parameter :: unbalanced = 1.0e-12_dp, unbalanced_when_round = 1.0e-2_dp
      real(dp), allocatable :: remainder(:)
      character(:), allocatable :: motion
      real(dp) :: scale, rounding, least

      ! Levers have the rounding errors of coordinates.
      rounding = unbalanced + epsilon(scale)*maxval(abs(body%mesh%coordinates))/minval(body%motions(pieces)%radius)
      ! Loads that cancel, each other or with reactions, leave theirs, and those of the directions of sides.
      least = rounding*load_case%uncanceled(1)
      call balance(pieces, body, load_case, body%rigid_modes, rounding, remainder, scale)
      if (norm2(remainder) > max(rounding*scale, least)) then
         motion = largest_motion(body%motions(pieces), remainder)
         if (body%zone%n_points == 0) then
            call new_error(error, no_equilibrium, 'no equilibrium: nothing balances the loads; '//motion// &
               '; add a support or a contact set')
         else
            call new_error(error, no_equilibrium, &
               'no equilibrium: contact and friction cannot balance the loads; '//motion// &
               '; add a support, or a load that presses the body on its obstacle')
         end if
      else if (.not. any(body%zone%is_cell)) then
         call balance(pieces, body, load_case, on_round_line(body%zone, body%rigid_modes), rounding, remainder, scale)
         if (norm2(remainder) > max(unbalanced_when_round*scale, least)) call new_error(error, no_equilibrium, &
            'no equilibrium but for the irregularities of the mesh: contact and friction on the round line that '// &
            'its nodes lie on cannot balance the loads; '//largest_motion(body%motions(pieces), remainder)// &
            '; add a support or friction')
      end if
   end subroutine check_pieces

   !> The remainder of the works of the loads on the free motions of some pieces after the best combination of the works
   !> of contact forces, by least squares. Contact forces are of unit normal force, or of unit given slip bound.
   pure subroutine balance(pieces, body, load_case, modes, rounding, remainder, scale)
      integer, intent(in) :: pieces(:) !! the pieces
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      real(dp), intent(in) :: modes(:, :) !! displacements of the points under all free motions (n_rows, motions) [-]
      real(dp), intent(in) :: rounding !! rounding errors of the work of a unit force on a motion [-]
      real(dp), allocatable, intent(out) :: remainder(:) !! the remainder, piece after piece (n_free of all)
      real(dp), intent(out) :: scale !! sum of the magnitudes of what makes up the works
      ! The work of a force across a motion is rounding, which grows with the force.
      real(dp), parameter :: least_share = 1.0e-4_dp
      real(dp), allocatable :: cone(:, :), edge(:, :), most(:), own(:), moved(:, :)
      integer, allocatable :: mine(:)
      real(dp) :: work(size(modes, 2)), friction(body%zone%n_points), angle
      logical :: is_mine(size(modes, 2))
      integer :: first, last, i, k, m, n_edges, n_given

      scale = 0.0_dp
      work = 0.0_dp
      is_mine = .false.
      do k = 1, size(pieces)
         associate (motions => body%motions(pieces(k)))
            last = sum(body%motions(:pieces(k))%n_free)
            first = last + 1 - motions%n_free
            is_mine(first:last) = .true.
            do i = 1, size(motions%node)
               associate (force => load_case%force(:, motions%node(i)))
                  if (.not. any(abs(force) > 0.0_dp)) cycle
                  moved = motions%displacement(body%mesh%coordinates(:, motions%node(i)), motions%node(i))
                  own = matmul(force, moved)
                  work(first:last) = work(first:last) + own
                  scale = scale + max(maxval(abs(own)), least_share*norm2(force)*maxval(norm2(moved, dim=1)))
               end associate
            end do
         end associate
      end do
      m = body%zone%n_points
      n_given = body%zone%n_rows - m
      n_edges = merge(2, n_directions, body%zone%n_tangents == 1)
      allocate (cone(size(work), (n_edges + 1)*m + 2*n_given))
      friction = load_case%friction
      ! Edges of a polygonal cone around the round one: loads that they cannot balance have no equilibrium.
      if (n_edges > 2) friction = friction/cos(pi/n_directions)
      do k = 1, n_edges + 1
         if (k > n_edges) friction = 0.0_dp
         angle = 2.0_dp*pi*k/n_edges
         edge = modes(:m, :) + spread(friction, 2, size(work))*(cos(angle)*modes(m + 1:2*m, :) &
            + sin(angle)*modes(n_given + 1:, :))
         cone(:, (k - 1)*m + 1:k*m) = transpose(merge(edge, 0.0_dp, spread(load_case%is_in_reach, 2, size(work))))
      end do
      ! A given slip bound holds open points, too.
      last = (n_edges + 1)*m
      cone(:, last + 1:last + n_given) = transpose(modes(m + 1:, :))
      cone(:, last + n_given + 1:) = -transpose(modes(m + 1:, :))
      ! Without this the unlimited force of a wall, times what rounding leaves of its work, would bear a load along it.
      where (spread(norm2(cone, 1) <= rounding, 1, size(work))) cone = 0.0_dp
      most = [spread(huge(1.0_dp), 1, last), (load_case%slip_bound, k=1, 2*body%zone%n_tangents)]
      mine = pack([(i, i=1, size(work))], is_mine)
      allocate (remainder, source=bounded_remainder(cone(mine, :), most, work(mine)))
   end subroutine balance

   !> Turns the displacements of points to the normals and tangents of the round line on which the points lie
   !> (n_rows, motions) [-].
   pure function on_round_line(zone, modes) result(on_round)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: modes(:, :) !! the displacements, in their own frames (n_rows, motions) [-]
      real(dp), allocatable :: on_round(:, :)
      real(dp) :: normals(2, zone%n_points), along, across
      integer :: p, m

      m = zone%n_points
      normals = round_normals(zone)
      on_round = modes
      do p = 1, m
         along = dot_product(normals(:, p), zone%normal(:, p))
         across = dot_product(normals(:, p), turned(zone%normal(:, p)))
         on_round(p, :) = along*modes(p, :) + across*modes(m + p, :)
         on_round(m + p, :) = along*modes(m + p, :) - across*modes(p, :)
      end do
   end function on_round_line

   !> The normals of the points on the circles through each point and its neighbors; where the line is straight, ends or
   !> turns by more than 35 degrees, those of the facets (2, m) [-]. A circle of twelve sides turns by 30.
   pure function round_normals(zone) result(normals)
      type(contact_zone_t), intent(in) :: zone !! the contact points; a cell keeps the normal of its sides
      real(dp), allocatable :: normals(:, :)
      real(dp), parameter :: least_cosine = 0.82_dp, straight = 1.0e-9_dp ! the rounding of unit vectors
      real(dp) :: before(2), after(2), tangent(2), lengths
      integer :: p, q, r

      normals = zone%normal
      do q = 1, zone%n_points
         p = zone%next(q)
         if (p == 0) cycle
         if (zone%is_cell(p)) cycle
         r = zone%next(p)
         ! A direction that the deck gives is the same at all points.
         if (r == 0 .or. norm2(zone%normal(:, p) - zone%normal(:, q)) < straight) cycle
         before = zone%position(:, p) - zone%position(:, q)
         after = zone%position(:, r) - zone%position(:, p)
         lengths = norm2(before)*norm2(after)
         if (.not. dot_product(before, after) > least_cosine*lengths) cycle
         ! On a circle a chord and the tangent make an angle whose sine goes with the chord's length.
         tangent = before/norm2(before)**2 + after/norm2(after)**2
         normals(:, p) = sign(1.0_dp, dot_product(turned(tangent), zone%normal(:, p)))*turned(tangent)/norm2(tangent)
      end do
   end function round_normals

   !> Finds the free rigid motion that comes closest to the gaps of the points in reach, without a slip; none if much of
   !> the gaps remains.
   subroutine fit_rigid_motion(motion, body, load_case)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles and anchors
      real(dp), parameter :: much = 0.1_dp
      real(dp) :: aim(body%zone%n_rows)
      logical :: counts(body%zone%n_rows)

      counts = counted(body, load_case)
      aim = merge([load_case%free_gap, load_case%anchor], 0.0_dp, counts)
      motion = matmul(body%rigid_modes, least_squares_amounts(merge(body%rigid_modes, 0.0_dp, spread(counts, 2, &
         size(body%rigid_modes, 2))), aim))
      if (maxval(abs(aim - motion), mask=counts) > max(much*maxval(abs(aim)), &
         rounding*maxval(abs(body%zone%position)))) motion = 0.0_dp
   end subroutine fit_rigid_motion

   !> Finds the free rigid motion by which loads press a rigid body onto its obstacles, with the least possible slip: of
   !> all positions without overlap the one nearest to a distant point in the direction of the loads. None if there is
   !> no such position, or if the motion is much longer than the gaps.
   subroutine find_resting_motion(motion, body, load_case, load)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles and anchors
      real(dp), intent(in) :: load(:) !! condensed load (n_rows) [F]
      ! Length of the way without obstacles, over the largest gap.
      real(dp), parameter :: far = 100.0_dp
      ! The Gram matrix of the modes has half of their digits.
      real(dp), parameter :: longest = 10.0_dp, impossible = 1.0e-10_dp, negligible = 1.0e-12_dp
      real(dp), allocatable :: in_modes(:, :), way(:, :), columns(:, :), remainder(:), slip(:, :)
      real(dp), dimension(size(body%rigid_modes, 2), size(body%rigid_modes, 2)) :: vector
      real(dp) :: value(size(body%rigid_modes, 2))
      real(dp) :: aim(body%zone%n_rows), drive(size(body%rigid_modes, 2)), amounts(size(body%rigid_modes, 2)), unit
      logical :: counts(body%zone%n_rows)
      integer :: info, k, m, n, n_slips

      m = body%zone%n_points
      counts = counted(body, load_case)
      aim = merge([load_case%free_gap, load_case%anchor], 0.0_dp, counts)
      allocate (motion(size(aim)), source=0.0_dp)
      unit = maxval(abs(aim(:m)))
      if (size(body%rigid_modes, 2) == 0 .or. .not. unit > 0.0_dp) return
      ! The motions with normal displacements of the points, each with the least slip and with the mean square 1 along
      ! the normals.
      associate (normal => merge(body%rigid_modes(:m, :), 0.0_dp, spread(counts(:m), 2, size(value))))
         vector = matmul(transpose(normal), normal)
      end associate
      call symmetric_eigenvectors(vector, value, info)
      n_slips = size(value)
      if (info == 0) n_slips = count(value <= negligible*maxval(value))
      slip = matmul(body%rigid_modes, vector)
      slip = merge(slip, 0.0_dp, spread(counts .and. [(k > m, k=1, size(counts))], 2, size(value)))
      do k = n_slips + 1, size(value)
         vector(:, k) = (vector(:, k) - matmul(vector(:, :n_slips), least_squares_amounts(slip(:, :n_slips), slip(:, &
            k)))) *sqrt(real(count(counts(:m)), dp)/value(k))
      end do
      in_modes = vector(:, n_slips + 1:)
      way = matmul(body%rigid_modes, in_modes)
      n = size(way, 2)
      amounts = least_squares_amounts(merge(body%rigid_modes, 0.0_dp, spread(counts, 2, size(body%rigid_modes, 2))), &
         aim)
      drive(:n) = matmul(load, way)
      amounts = amounts + far*unit*matmul(in_modes, drive(:n)/max(norm2(drive(:n)), tiny(1.0_dp)))
      motion = matmul(body%rigid_modes, amounts)
      ! The least distance under inequalities, G x >= h, from least squares (Lawson and Hanson, chapter 23).
      allocate (columns(n + 1, count(counts(:m))))
      do k = 1, n
         columns(k, :) = -pack(way(:m, k), counts(:m))
      end do
      columns(n + 1, :) = pack(motion(:m) - aim(:m), counts(:m))/unit
      remainder = bounded_remainder(columns, spread(huge(1.0_dp), 1, size(columns, 2)), [spread(0.0_dp, 1, n), 1.0_dp])
      if (remainder(n + 1) <= impossible) then
         motion = 0.0_dp
      else
         ! The amounts are summed, not the displacements: a difference of long displacements has their rounding errors,
         ! and would be no rigid motion.
         motion = matmul(body%rigid_modes, amounts - unit/remainder(n + 1)*matmul(in_modes, remainder(:n)))
         if (maxval(abs(motion)) > longest*unit) motion = 0.0_dp
      end if
   end subroutine find_resting_motion

   !> Finds where a body stays that nothing loads: the free rigid motion that leaves no overlap, nearest to where it
   !> was: points that were pressed keep touching, and those with a given slip bound move along with the obstacle. It
   !> causes no forces. There is none where a load acts, where overlaps press, and where such a point would slip.
   subroutine find_idle_motion(motion, body, problem, before, force)
      real(dp), allocatable, intent(out) :: motion(:)
         !! its displacements (u_N; u_T) of the points; not allocated if there is none (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      real(dp), intent(in) :: before(:) !! displacements of the points before (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces before (n_rows) [F]
      ! Gaps that count as wide, over the largest overlap: no least motion reaches them. And what rounding leaves.
      real(dp), parameter :: wide = 1.0e4_dp, impossible = 1.0e-10_dp, few = 1.0e-10_dp, same = 1.0e-9_dp
      real(dp) :: place(size(body%travel, 2)), remainder(size(place) + 1), none, unit
      real(dp), allocatable :: columns(:, :), lacking(:), slip(:)
      logical :: is_idle, is_pressed(body%zone%n_rows), is_stuck(body%zone%n_rows - problem%n_points)
      integer :: i

      if (.not. all(abs(problem%load) <= 0.0_dp)) return
      place = matmul(before, body%travel)
      is_pressed = [(force(:problem%n_points) > 0.0_dp, i=0, body%zone%n_tangents)]
      place = place + least_squares_amounts(merge(body%travel, 0.0_dp, spread(is_pressed, 2, size(place))), &
         merge(before - matmul(body%travel, place), 0.0_dp, is_pressed))
      ! A body is where it is drawn but for the rounding errors of coordinates.
      if (all(abs(matmul(body%travel, place)) <= rounding*maxval(abs(body%zone%position)))) place = 0.0_dp
      associate (m => problem%n_points, n => size(body%travel, 2))
         ! A given slip bound holds its point along the tangents, either way.
         motion = matmul(body%travel, place)
         lacking = motion - [problem%gap, problem%anchor]
         is_stuck = [(problem%slip_bound > 0.0_dp, i=1, body%zone%n_tangents)]
         lacking = [lacking(:m), pack(lacking(m + 1:), is_stuck), -pack(lacking(m + 1:), is_stuck)]
         unit = maxval(lacking)
         if (unit > 0.0_dp) then
            ! The least distance under inequalities, G x >= h, from least squares (Lawson and Hanson, chapter 23).
            allocate (columns(n + 1, size(lacking)))
            do i = 1, n
               slip = pack(body%travel(m + 1:, i), is_stuck)
               columns(i, :) = -[body%travel(:m, i), slip, -slip]
            end do
            ! A point that a motion moves across its normal would hold the body by what rounding leaves of its way.
            where (abs(columns(:n, :)) <= same) columns(:n, :) = 0.0_dp
            columns(n + 1, :) = max(lacking/unit, -wide)
            remainder = bounded_remainder(columns, spread(huge(1.0_dp), 1, size(lacking)), [spread(0.0_dp, 1, n), &
               1.0_dp])
            if (remainder(n + 1) > impossible) motion = matmul(body%travel, place &
               - unit/remainder(n + 1)*remainder(:n))
         end if
         ! A motion back to where the body is drawn has the errors of the place that it leads back from.
         none = few*maxval(abs([motion, matmul(body%travel, place)]))
         is_idle = all(motion(:m) - problem%gap <= none .and. (.not. problem%slip_bound > 0.0_dp .or. &
            tangential_norm(motion(m + 1:) - problem%anchor, m) <= none))
         if (.not. is_idle) deallocate (motion)
      end associate
   end subroutine find_idle_motion

   !> Whether contact forces alone can balance each other, as those on a body between two walls: if no free rigid motion
   !> opens all contacts against friction. Given slip bounds hold open points, too.
   pure logical function can_be_wedged(body, problem, is_in_reach)
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      ! The square of an angle.
      real(dp), parameter :: least_remainder = 1.0e-10_dp
      real(dp), allocatable :: columns(:, :), edge(:, :), remainder(:)
      integer :: k, n

      can_be_wedged = any(problem%slip_bound > 0.0_dp)
      if (can_be_wedged) return
      n = size(body%travel, 2)
      allocate (columns(n + 1, 0))
      associate (m => problem%n_points, travel => body%travel)
         do k = 1, 2*body%zone%n_tangents
            ! In space a pyramid around the cone.
            edge = travel(:m, :) + spread((-1.0_dp)**k*sqrt(real(body%zone%n_tangents, dp))*problem%friction, 2, n) &
               *travel(m*((k + 1)/2) + 1:m*((k + 1)/2) + m, :)
            edge = edge/spread(max(norm2(edge, dim=2), tiny(1.0_dp)), 2, n)
            columns = reshape([columns, transpose(reshape([pack(edge, spread(is_in_reach, 2, n)), &
               spread(1.0_dp, 1, count(is_in_reach))], [count(is_in_reach), n + 1]))], &
               [n + 1, size(columns, 2) + count(is_in_reach)])
         end do
      end associate
      remainder = bounded_remainder(columns, spread(huge(1.0_dp), 1, size(columns, 2)), [spread(0.0_dp, 1, n), 1.0_dp])
      can_be_wedged = remainder(n + 1) <= least_remainder
   end function can_be_wedged

   !> Finds the free rigid motion that makes up nearly all of the displacements of the points; 0 if there is none.
   subroutine fit_travel(motion, body, displacement)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:) !! displacements (u_N; u_T) of the points (n_rows) [L]
      real(dp), parameter :: much = 0.01_dp

      motion = matmul(body%travel, matmul(displacement, body%travel))
      if (maxval(abs(displacement - motion)) > max(much*maxval(abs(displacement)), &
         rounding*maxval(abs(body%zone%position)))) motion = 0.0_dp
   end subroutine fit_travel

   !> Computes the displacements of all nodes from the solution of the contact problem. The free rigid motion in it is
   !> recovered apart from the rest, which so keeps its digits; a step of refinement follows.
   subroutine recover_with_travel(displacement, body, load_case, solution, force)
      real(dp), allocatable, intent(out) :: displacement(:, :) !! displacements of all nodes (components, n_nodes) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case, condensed
      real(dp), intent(in) :: solution(:) !! displacements v of the contact problem (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp) :: amounts(size(body%rigid_modes, 2))

      amounts = 0.0_dp
      if (.not. body%is_motion_strained) amounts = least_squares_amounts(body%rigid_modes, solution)
      call recover_displacement(displacement, body, load_case, solution - matmul(body%rigid_modes, amounts), force)
      displacement = displacement + displacement_of_nodes(body%motions, body%mesh%coordinates, amounts)
      call refine_displacement(displacement, body, load_case, force)
   end subroutine recover_with_travel

   !> Improves displacements by a step of iterative refinement with those of the contact points as they are, if the
   !> others need it and it leaves less imbalance. A stiff body that supports move by far more than it is strained would
   !> otherwise keep forces of rounding size, as large as those of a soft body that it presses.
   subroutine refine_displacement(displacement, body, load_case, force)
      real(dp), allocatable, intent(inout) :: displacement(:, :) !! displacements of all nodes (components, n_nodes) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), parameter :: negligible = 1.0e-12_dp ! the rounding of sums of forces
      type(condensed_load_t) :: rest
      real(dp), allocatable :: lacking(:), strained(:), refined(:, :), unknowns(:, :)

      lacking = imbalance(body, load_case, displacement, force)
      if (norm2(lacking) <= negligible*max(load_case%uncanceled(1), norm2(force))) return
      call body%condensation%condense_load(lacking, rest)
      strained = 0.0_dp*force
      if (allocated(body%condensation%softness)) strained = -body%condensation%softness*rest%load
      call body%condensation%recover([rest], spread(strained, 2, 1), unknowns)
      refined = displacement + from_unknowns(unknowns(:, 1), 0.0_dp*displacement, body%constraints, body%dof_map)
      if (norm2(imbalance(body, load_case, refined, force)) < norm2(lacking)) displacement = refined
   end subroutine refine_displacement

   !> The load q - S v - lambda that contact displacements and forces leave unbalanced, from the strains of the whole
   !> body: S itself, and q, have the rounding errors of the factorization (n_rows) [F].
   function imbalance_of_points(body, load_case, solution, force) result(lacking)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case, condensed
      real(dp), intent(in) :: solution(:)
         !! displacements v of the contact problem, which may be counted from a free rigid motion (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), allocatable :: lacking(:)
      type(condensed_load_t) :: rest
      real(dp), allocatable :: displacement(:, :)

      call recover_displacement(displacement, body, load_case, solution, force)
      call body%condensation%condense_load(imbalance(body, load_case, displacement, force), rest)
      lacking = rest%load
   end function imbalance_of_points

   !> Loads and contact forces less the forces of stresses and springs on all unknowns (n) [F].
   function imbalance(body, load_case, displacement, force)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), allocatable :: imbalance(:), internal(:, :)

      call body%internal_forces(internal, displacement, load_case%element_load)
      imbalance = to_unknowns(load_case%force + body%zone%rows%forces(force, body%mesh%n_nodes, &
         size(displacement, 1)) - internal, body%constraints, body%dof_map)
   end function imbalance

   !> The rigid motion of each piece that is closest to the displacements of its nodes, by least squares (components,
   !> n_nodes) [L].
   function travel_of_nodes(free, coordinates, displacement) result(travel)
      type(rigid_motions_t), intent(in) :: free(:) !! the motions of each piece that are free
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (components, n_nodes) [L]
      real(dp), allocatable :: travel(:, :)
      real(dp), allocatable :: modes(:, :)
      integer :: i, j, n

      allocate (travel, source=0.0_dp*displacement)
      do j = 1, size(free)
         associate (motions => free(j))
            if (motions%n_free == 0) cycle
            n = size(displacement, 1)
            allocate (modes(n*size(motions%node), motions%n_free))
            do i = 1, size(motions%node)
               modes(n*(i - 1) + 1:n*i, :) = motions%displacement(coordinates(:, motions%node(i)), motions%node(i))
            end do
            travel(:, motions%node) = reshape(matmul(modes, least_squares_amounts(modes, &
               reshape(displacement(:, motions%node), [size(modes, 1)]))), [n, size(motions%node)])
            deallocate (modes)
         end associate
      end do
   end function travel_of_nodes

   !> The displacements of the points for which gaps and slips give a target value (n_rows).
   pure function counted(body, load_case) result(counts)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles
      logical :: counts(body%zone%n_rows)
      integer :: k

      counts(:body%zone%n_points) = load_case%is_in_reach
      counts(body%zone%n_points + 1:) = .not. body%zone%is_slip_fixed .and. [load_case%is_in_reach, &
         (load_case%is_in_reach, k=2, body%zone%n_tangents)]
   end function counted

   !> The coefficients of some modes whose sum is closest to a target, by least squares; of several solutions the
   !> smallest.
   function least_squares_amounts(modes, aim) result(amounts)
      real(dp), intent(in) :: modes(:, :) !! displacements under each mode, 0 where they do not count (n_rows, k) [-]
      real(dp), intent(in) :: aim(:) !! displacements to come close to, 0 where they do not count (n_rows) [L]
      real(dp) :: amounts(size(modes, 2))
      ! The Gram matrix of the modes has half of their digits.
      real(dp), parameter :: negligible = 1.0e-12_dp
      real(dp) :: gram(size(modes, 2), size(modes, 2)), values(size(modes, 2))
      integer :: info, k

      amounts = 0.0_dp
      if (size(modes, 2) == 0) return
      gram = matmul(transpose(modes), modes)
      call symmetric_eigenvectors(gram, values, info)
      if (info /= 0) return
      do k = 1, size(values)
         if (values(k) > negligible*maxval(values)) amounts = amounts &
            + gram(:, k)*dot_product(matmul(aim, modes), gram(:, k))/values(k)
      end do
   end function least_squares_amounts

end module amontons_equilibrium
