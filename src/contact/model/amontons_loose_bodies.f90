!> Bodies that contact alone holds: whether contact forces can balance their loads, and where they stay.
!>
!> Equilibrium: the works of the loads on the free rigid motions must be those of contact forces, which form a cone. By
!> Farkas' lemma what the best approximation leaves of them is a rigid motion that the loads drive and that no contact
!> force opposes enough: there is no equilibrium, and the body is free to move along it. Otherwise there may be one:
!> forces on opposite sides can be as large as they like here, and friction with them. Once normal forces are known,
!> friction is not: the same is asked with the friction that they allow, and normal forces without friction.
!>
!> The normals of the facets of a round line miss its center a little, so that huge forces with arms of both signs would
!> balance any moment. A motion on which the normals of the circles through neighboring nodes do no work must therefore
!> be held by friction alone. In a pair the round line is that of the slave.
!>
!> Place: a body moves as little as it can. Where its contact forces leave it free to move, it stays as near to where
!> it was as overlaps allow. Rigid motions cause no elastic forces, so that displacements may be counted from any of
!> them. Displacements that do cause forces may be millions of times smaller than the distance to the obstacle: counted
!> from a place on the obstacle, they keep their digits.
module amontons_loose_bodies
   use amontons_body, only: body_t, find_rigid_modes
   use amontons_cone, only: cone_t, least_squares, new_cone, null_vectors
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t, new_error, no_equilibrium
   use amontons_frame, only: turned
   use amontons_friction_law, only: open_point, tangential_norm
   use amontons_kinds, only: dp
   use amontons_load_family, only: load_case_t
   use amontons_pose, only: pose_t
   use amontons_rigid_motion, only: largest_motion, resting_motions, rigid_motions_t
   use amontons_rounding, only: computed_rounding, difference_rounding, sum_rounding
   implicit none (type, external)
   private

   public :: check_balance, find_origin, find_round_motions, free_motions, rigid_part, settle

contains

   !> Refuses loads that no contact forces can balance, with friction in proportion to normal forces of any size, or as
   !> large as it is at known ones. Points that slide far are where they have been found, on a line that is not round.
   pure subroutine check_balance(body, load_case, error, bound, poses)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium; names the motion
      real(dp), intent(in), optional :: bound(:) !! what friction bears at the normal forces that were found (m) [F]
      type(pose_t), intent(in), optional :: poses(:) !! the poses of the pieces that turn far
      type(pose_t) :: turn
      real(dp), allocatable :: coordinates(:, :)
      integer :: i, k

      coordinates = body%mesh%coordinates
      if (present(poses)) then
         ! Arms turn; motions are counted from places at rest.
         do k = 1, size(poses)
            turn = pose_t(turn=poses(k)%turn, pivot=poses(k)%pivot)
            do i = 1, size(body%turning(k)%node)
               associate (x => coordinates(:, body%turning(k)%node(i)))
                  x = x + turn%displacement(x)
               end associate
            end do
         end do
      end if
      if (allocated(body%unheld)) then
         call judge_balance(body, body%unheld, coordinates, load_case, error, bound)
      else
         call judge_balance(body, body%motions, coordinates, load_case, error, bound)
      end if
   end subroutine check_balance

   !> Refuses loads that no contact forces can balance along some motions.
   pure subroutine judge_balance(body, motions, coordinates, load_case, error, bound)
      type(body_t), intent(in) :: body !! the body
      type(rigid_motions_t), intent(in) :: motions(:) !! the motions that supports leave free
      real(dp), intent(in) :: coordinates(:, :)
         !! coordinates of the nodes, turned with their pieces (n_dim, n_nodes) [L]
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium; names the motion
      real(dp), intent(in), optional :: bound(:) !! what friction bears at the normal forces that were found (m) [F]
      ! For the center of gravity of a round body, whose position depends on the mesh.
      real(dp), parameter :: unbalanced_when_round = 1.0e-2_dp
      real(dp), allocatable :: amounts(:, :), modes(:, :), moved(:, :), remainder(:), work(:)
      character(:), allocatable :: bearing, advice
      real(dp) :: scale, share, least

      if (all(motions%n_free == 0)) return
      call find_works(work, scale, body, motions, coordinates, load_case)
      ! A hundredth of the residual of methods, whose scale may be a small part of the loads that cancel. Levers have
      ! the rounding errors of coordinates. Of a round cone the square of the remainder is rounding.
      share = merge(sum_rounding, sqrt(sum_rounding), body%zone%n_tangents == 1) + epsilon(scale)*maxval(abs( &
         body%mesh%coordinates))/minval(motions%radius, mask=motions%n_free > 0)
      ! Normal forces that were found have ten times the residual of methods.
      if (present(bound)) share = max(share, computed_rounding)
      ! Loads that cancel, each other or with reactions, leave their rounding errors, and those of directions of sides.
      least = share*load_case%uncanceled(1)
      bearing = 'contact and friction'
      advice = '; add a support, or a load that presses the body on its obstacle'
      if (present(bound)) then
         bearing = 'all contact points slip or open, and friction'
         advice = '; add a support or friction'
      end if
      call find_rigid_modes(modes, body%zone, motions, coordinates, is_mated=.false.)
      remainder = unbalanced_work(body, load_case, modes, work, bound)
      if (norm2(remainder) > max(share*scale, least)) then
         if (body%zone%n_points == 0) then
            call new_error(error, no_equilibrium, 'no equilibrium: nothing balances the loads; '// &
               largest_motion(motions, remainder)//'; add a support or a contact set')
         else
            call new_error(error, no_equilibrium, 'no equilibrium: '//bearing//' cannot balance the loads; '// &
               largest_motion(motions, remainder)//advice)
         end if
      else if (.not. body%slides_far) then
         call find_round_motions(amounts, moved, body, load_case%is_in_reach)
         remainder = matmul(amounts, unbalanced_work(body, load_case, moved, matmul(work, amounts), bound))
         if (norm2(remainder) > max(unbalanced_when_round*scale, least)) call new_error(error, no_equilibrium, &
            'no equilibrium but for the irregularities of the mesh: '//bearing//' on the round line that its nodes '// &
            'lie on cannot balance the loads; '//largest_motion(motions, remainder)//'; add a support or friction')
      end if
   end subroutine judge_balance

   !> Finds the works of the loads on the free motions, and how large the terms are that they are sums of.
   pure subroutine find_works(work, scale, body, motions, coordinates, load_case)
      real(dp), allocatable, intent(out) :: work(:) !! the works (motions) [F]
      real(dp), intent(out) :: scale !! sum of the magnitudes of what makes up the works [F]
      type(body_t), intent(in) :: body !! the body
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions
      real(dp), intent(in) :: coordinates(:, :)
         !! coordinates of the nodes, turned with their pieces (n_dim, n_nodes) [L]
      type(load_case_t), intent(in) :: load_case !! its loads
      ! The work of a force across a motion is rounding, which grows with the force.
      real(dp), parameter :: least_share = 1.0e-4_dp
      real(dp), allocatable :: own(:), moved(:, :), beside(:, :)
      integer :: i, k, last

      scale = 0.0_dp
      last = 0
      allocate (work(sum(motions%n_free)), source=0.0_dp)
      do k = 1, size(motions)
         associate (of_piece => work(last + 1:last + motions(k)%n_free))
            if (motions(k)%n_free == 0) cycle
            last = last + motions(k)%n_free
            do i = 1, size(motions(k)%node)
               associate (node => motions(k)%node(i), force => load_case%force(:, motions(k)%node(i)))
                  if (.not. any(abs(force) > 0.0_dp)) cycle
                  moved = motions(k)%displacement(coordinates(:, node), node)
                  own = matmul(force, moved)
                  of_piece = of_piece + own
                  scale = scale + max(maxval(abs(own)), least_share*norm2(force)*maxval(norm2(moved, dim=1)))
               end associate
            end do
            ! Force and moment of a rigid set that turns act at its point.
            do i = 1, count(body%turning%rigid > 0)
               associate (piece => body%turning(i), given => load_case%driven(body%turning(i)%driven))
                  if (all(motions(k)%node /= piece%node(1)) .or. .not. any(abs(given) > 0.0_dp)) cycle
                  moved = motions(k)%displacement(piece%point, piece%node(1))
                  beside = motions(k)%displacement(piece%point + [1.0_dp, 0.0_dp], piece%node(1))
                  own = matmul(given(:2), moved) + given(3)*(beside(2, :) - moved(2, :))
                  of_piece = of_piece + own
                  scale = scale + max(maxval(abs(own)), least_share*norm2(given(:2))*maxval(norm2(moved, dim=1)))
               end associate
            end do
         end associate
      end do
   end subroutine find_works

   !> The works of the loads on the free motions that contact forces do not balance: a motion along which the loads do
   !> work, and no contact force does more against it (motions) [F].
   pure function unbalanced_work(body, load_case, modes, work, bound) result(remainder)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles and friction
      real(dp), intent(in) :: modes(:, :) !! displacements of the points under all free motions (n_rows, motions) [-]
      real(dp), intent(in) :: work(:) !! the works of the loads (motions) [F]
      real(dp), intent(in), optional :: bound(:) !! what friction bears, whatever the normal forces are (m) [F]
      real(dp), allocatable :: remainder(:)
      type(cone_t) :: cone

      call new_cone(cone, modes, merge(load_case%friction, -1.0_dp, load_case%is_in_reach))
      ! A given slip bound holds open points, too.
      cone%slip_bound = load_case%slip_bound
      if (present(bound)) then
         cone%friction = min(cone%friction, 0.0_dp)
         cone%slip_bound = bound
      end if
      cone%set = body%zone%set
      remainder = cone%remainder(work)
   end function unbalanced_work

   !> Finds the free motions of the points along the round line on which they lie, if the facets of the mesh oppose
   !> them. Both sides of a pair are taken to lie on the line.
   pure subroutine find_round_motions(amounts, moved, body, is_in_reach)
      real(dp), allocatable, intent(out) :: amounts(:, :) !! amounts of the free motions (motions, any)
      real(dp), allocatable, intent(out) :: moved(:, :) !! their displacements of the points (n_rows, any) [-]
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      ! What meshes of curves leave of such a motion.
      real(dp), parameter :: negligible = 1.0e-3_dp
      real(dp), allocatable :: modes(:, :), across(:, :)
      real(dp) :: normals(size(body%zone%position, 1), body%zone%n_points)
      integer :: k, p

      normals = round_normals(body%zone)
      call find_rigid_modes(modes, body%zone, body%motions, body%mesh%coordinates, is_mated=.true.)
      across = 0.0_dp*modes(:body%zone%n_points, :)
      associate (m => body%zone%n_points)
         do k = 0, body%zone%n_tangents
            across = across + spread(sum(normals*body%zone%frame(:size(normals, 1), k + 1, :), dim=1), 2, &
               size(modes, 2))*modes(k*m + 1:(k + 1)*m, :)
         end do
         amounts = null_vectors(across(pack([(p, p=1, m)], is_in_reach), :), negligible*norm2(modes, dim=1))
         if (.not. any(abs(matmul(body%rigid_modes(:m, :), amounts)) > computed_rounding)) amounts = amounts(:, :0)
         moved = matmul(modes, amounts)
         moved(:m, :) = 0.0_dp
      end associate
   end subroutine find_round_motions

   !> The normals of the points on the circles through each point and its neighbors; where the line is straight, ends or
   !> turns by more than 35 degrees, and in space, those of the facets (n_dim, m) [-]. A circle of twelve sides turns by
   !> 30.
   pure function round_normals(zone) result(normals)
      type(contact_zone_t), intent(in) :: zone !! the contact points; a cell keeps the normal of its sides
      real(dp), allocatable :: normals(:, :)
      real(dp), parameter :: least_cosine = 0.82_dp
      real(dp) :: before(2), after(2), tangent(2), lengths
      integer :: p, q, r

      normals = zone%frame(:size(zone%position, 1), 1, :)
      if (.not. allocated(zone%line)) return
      do q = 1, zone%n_points
         p = zone%line%next(q)
         if (p == 0) cycle
         if (zone%is_cell(p)) cycle
         r = zone%line%next(p)
         ! A direction that the deck gives is the same at all points.
         if (r == 0 .or. norm2(zone%normal(p) - zone%normal(q)) < computed_rounding) cycle
         before = zone%position(:, p) - zone%position(:, q)
         after = zone%position(:, r) - zone%position(:, p)
         lengths = norm2(before)*norm2(after)
         if (.not. dot_product(before, after) > least_cosine*lengths) cycle
         ! On a circle a chord and the tangent make an angle whose sine goes with the chord's length.
         tangent = before/norm2(before)**2 + after/norm2(after)**2
         normals(:, p) = sign(1.0_dp, dot_product(turned(tangent), zone%normal(p)))*turned(tangent)/norm2(tangent)
      end do
   end function round_normals

   !> Finds the combination of free motions that brings a body as near to where it was as overlaps allow: points that
   !> were pressed keep touching, and open points with a given slip bound move along with the obstacle. Points that bear
   !> forces stay where they are.
   pure subroutine find_place(place, free, body, problem, before, force_before, force)
      real(dp), allocatable, intent(out) :: place(:)
         !! amounts of the motions; not allocated if none ends all overlaps (motions) [L]
      real(dp), intent(in) :: free(:, :) !! displacements of the points under motions that change no force (n_rows, any)
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      real(dp), intent(in) :: before(:) !! displacements of the points before (n_rows) [L]
      real(dp), intent(in) :: force_before(:) !! contact forces before (n_rows) [F]
      real(dp), intent(in) :: force(:) !! contact forces now (n_rows) [F]
      real(dp), allocatable :: motion(:), change(:), lacking(:), side(:)
      integer, allocatable :: pressed(:), open(:), stuck(:), rows(:)
      integer :: i, p

      associate (m => problem%n_points)
         place = least_squares(free, before)
         pressed = pack([(p, p=1, m)], force_before(:m) > 0.0_dp)
         place = place + least_squares(free(pressed, :), before(pressed) - matmul(free(pressed, :), place))
         ! A body is where it is drawn but for the rounding errors of coordinates.
         if (all(abs(matmul(free, place)) <= difference_rounding*maxval(abs(body%zone%position)))) place = 0.0_dp
         motion = matmul(free, place)
         open = pack([(p, p=1, m)], .not. force(:m) > 0.0_dp)
         ! A given slip bound holds its point along the tangents, either way.
         stuck = pack([(m + p, p=1, size(motion) - m)], [(problem%slip_bound > 0.0_dp .and. .not. force(:m) > 0.0_dp, &
            i=1, body%zone%n_tangents)])
         rows = [open, stuck, stuck]
         side = [(1.0_dp, p=1, size(open) + size(stuck)), (-1.0_dp, p=1, size(stuck))]
         lacking = motion - [problem%gap, problem%anchor]
         lacking = side*lacking(rows)
         call find_least_motion(change, free(rows, :)*spread(side, 2, size(place)), lacking)
         if (allocated(change)) then
            place = place + change
         else if (any(lacking > difference_rounding*maxval(abs([body%zone%position, motion])))) then
            deallocate (place)
         end if
      end associate
   end subroutine find_place

   !> Finds the free rigid motion that lays a body on its obstacles: without a slip it comes closest to the gaps of the
   !> points in reach, but for the least motion that ends all overlaps; 0 if there is none.
   pure subroutine find_origin(motion, body, problem, is_in_reach)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      real(dp), allocatable :: place(:), reach(:)
      integer :: k

      reach = merge(1.0_dp, 0.0_dp, [(is_in_reach, k=0, body%zone%n_tangents)])
      call find_place(place, body%travel*spread(reach, 2, size(body%travel, 2)), body, problem, &
         reach*[problem%gap, problem%anchor], 0.0_dp*reach, 0.0_dp*reach)
      if (.not. allocated(place)) place = spread(0.0_dp, 1, size(body%travel, 2))
      motion = matmul(body%travel, place)
   end subroutine find_origin

   !> The combinations of motions that move no point that bears a normal force along the normal, nor one that bears
   !> friction, up to a share of its bound, along the tangents (motions, any) [-].
   pure function free_motions(motions, problem, force, share) result(free)
      real(dp), intent(in) :: motions(:, :) !! displacements of the points under the motions (n_rows, motions) [-]
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: force(:) !! contact forces (n_rows) [F]
      real(dp), intent(in) :: share
         !! the share, above 1 for all of it; what it lacks of 1, of the largest force, is no force [-]
      real(dp), allocatable :: free(:, :), bound(:)
      logical, dimension(problem%n_points) :: is_closed, sticks
      integer :: i, k

      associate (m => problem%n_points, n_tangents => problem%matrix%n_tangents)
         is_closed = force(:m) > max(0.0_dp, 1.0_dp - share)*maxval([0.0_dp, abs(force)])
         bound = problem%bound(force(:m))
         sticks = is_closed .and. bound > 0.0_dp .and. tangential_norm(force(m + 1:), m) < share*bound
         free = resting_motions(motions(pack([(i, i=1, size(force))], [is_closed, (sticks, k=1, n_tangents)]), :))
      end associate
   end function free_motions

   !> Moves a body that its contact forces leave free to move to the place nearest to where it was, where they are the
   !> same: of its many solutions a method finds any. Without forces that is the least motion that ends all overlaps.
   subroutine settle(body, problem, tolerance, before, solution)
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      real(dp), intent(in) :: tolerance !! residual that counts as solved [-]
      type(contact_solution_t), intent(in) :: before !! where it was
      type(contact_solution_t), intent(inout) :: solution
         !! a solution, moved; without loads, the body at rest in its place if that has no forces
      ! Forces of a body that tolerance wedges, over loads that cancel.
      real(dp), parameter :: small = 1.0e-6_dp
      type(contact_solution_t) :: settled
      real(dp), allocatable :: free(:, :), strains(:), place(:), motion(:)
      real(dp) :: least
      logical :: is_unloaded

      is_unloaded = .not. any(abs(problem%load) > 0.0_dp)
      if (.not. (solution%is_converged .or. is_unloaded)) return
      settled = solution
      ! Forces that the rounding errors of gaps make are none.
      least = max(small*sum(problem%uncanceled), difference_rounding*maxval(abs(body%zone%position)) &
         *maxval(problem%matrix%augmentation))
      if (maxval([0.0_dp, abs(solution%force)]) <= least .or. .not. solution%is_converged) settled%force = 0.0_dp
      associate (force => settled%force)
         is_unloaded = is_unloaded .and. .not. any(abs(force) > 0.0_dp)
         free = matmul(body%travel, free_motions(body%travel, problem, force, huge(least)))
         if (size(free, 2) == 0 .and. .not. is_unloaded) return
         strains = solution%displacement - matmul(free, least_squares(free, solution%displacement))
         if (is_unloaded) strains = 0.0_dp
         call find_place(place, free, body, problem%from(strains), before%displacement - strains, before%force, force)
      end associate
      if (.not. allocated(place)) return
      motion = matmul(free, place)
      settled%displacement = strains
      call settled%measure(problem%from(motion))
      if (is_unloaded) settled%residual = 0.0_dp
      if (is_unloaded) settled%status = open_point
      settled%is_converged = settled%residual <= tolerance
      settled%displacement = strains + motion
      if (settled%is_converged) solution = settled
   end subroutine settle

   !> Finds the least combination of free motions that ends all overlaps: least distance under inequalities, from least
   !> squares (Lawson and Hanson, chapter 23). Such a motion is at most 1e5 times as long as overlaps are.
   pure subroutine find_least_motion(amounts, moved, overlap)
      real(dp), allocatable, intent(out) :: amounts(:) !! amounts of the motions; not allocated if there is none (n) [L]
      real(dp), intent(in) :: moved(:, :) !! how far each motion leads into obstacles (k, n) [-]
      real(dp), intent(in) :: overlap(:) !! how deep points are in obstacles, negative outside (k) [L]
      real(dp), parameter :: longest = 1.0e5_dp
      type(cone_t) :: cone
      real(dp) :: remainder(size(moved, 2) + 1), left(size(overlap)), unit
      integer :: k, n, turn

      n = size(moved, 2)
      allocate (amounts(n), source=0.0_dp)
      ! The second time what rounding has left of the overlaps.
      do turn = 1, 2
         left = overlap + matmul(moved, amounts)
         unit = maxval([0.0_dp, left])
         if (.not. unit > 0.0_dp) return
         call new_cone(cone, reshape([-moved, left/unit], [size(left), n + 1]), spread(0.0_dp, 1, size(left)))
         remainder = cone%remainder([(0.0_dp, k=1, n), 1.0_dp])
         if (remainder(n + 1)*longest**2 > 1.0_dp) then
            amounts = amounts - unit/remainder(n + 1)*remainder(:n)
         else if (turn == 1) then
            deallocate (amounts)
            return
         end if
      end do
   end subroutine find_least_motion

   !> The free rigid motion that is closest to displacements of the points (n_rows) [L].
   pure function rigid_part(body, displacement) result(motion)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:) !! the displacements (u_N; u_T) (n_rows) [L]
      real(dp), allocatable :: motion(:)

      motion = matmul(body%travel, least_squares(body%travel, displacement))
   end function rigid_part

end module amontons_loose_bodies
