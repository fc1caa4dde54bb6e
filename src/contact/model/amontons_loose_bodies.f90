!> Bodies that contact alone holds: whether contact forces can balance their loads or each other, and where they stay.
!>
!> Equilibrium: the works of the loads on the free rigid motions must be those of contact forces, which form a cone. By
!> Farkas' lemma what the best approximation leaves of them is a rigid motion that the loads drive and that no contact
!> force opposes enough: there is no equilibrium, and the body is free to move along it. Otherwise there may be one:
!> forces on opposite sides can be as large as they like here, and the solver decides.
!>
!> The normals of the facets of a round line miss its center a little, so that huge forces with arms of both signs would
!> balance any moment. Loads therefore have no equilibrium either if a remainder is left with the normals of the circles
!> through neighboring nodes. In a pair the round line is that of the slave.
!>
!> Place: rigid motions cause no elastic forces, so that the displacements of such a body may be counted from any of
!> them. Displacements that do cause forces may be millions of times smaller than the distance to the obstacle: counted
!> from a place on the obstacle, they keep their digits. Without loads the body stays where it was but for the least
!> motion that ends all overlaps.
module amontons_loose_bodies
   use amontons_body, only: body_t
   use amontons_cone, only: cone_t, least_squares, new_cone
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t, new_error, no_equilibrium
   use amontons_frame, only: turned
   use amontons_kinds, only: dp
   use amontons_load_family, only: load_case_t
   use amontons_rigid_motion, only: largest_motion
   use amontons_rounding, only: computed_rounding, difference_rounding, sum_rounding
   implicit none (type, external)
   private

   public :: can_be_wedged, check_balance, find_idle_motion, find_origin, fit_travel, is_round, on_round_line

contains

   !> Refuses loads that no contact forces can balance.
   pure subroutine check_balance(body, load_case, error)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium; names the motion
      ! A hundredth of the residual of methods, whose scale may be a small part of the loads that cancel; the other
      ! limit is for the center of gravity of a round body, whose position depends on the mesh.
      real(dp), parameter :: unbalanced_when_round = 1.0e-2_dp
      real(dp), allocatable :: work(:), remainder(:)
      character(:), allocatable :: motion
      real(dp) :: scale, share, least

      if (all(body%motions%n_free == 0)) return
      call find_works(work, scale, body, load_case)
      ! Levers have the rounding errors of coordinates. Of a round cone the square of the remainder is rounding.
      share = merge(sum_rounding, sqrt(sum_rounding), body%zone%n_tangents == 1) + epsilon(scale)*maxval(abs( &
         body%mesh%coordinates))/minval(body%motions%radius, mask=body%motions%n_free > 0)
      ! Loads that cancel, each other or with reactions, leave their rounding errors, and those of directions of sides.
      least = share*load_case%uncanceled(1)
      remainder = unbalanced_work(body, load_case, body%rigid_modes, work)
      if (norm2(remainder) > max(share*scale, least)) then
         motion = largest_motion(body%motions, remainder)
         if (body%zone%n_points == 0) then
            call new_error(error, no_equilibrium, 'no equilibrium: nothing balances the loads; '//motion// &
               '; add a support or a contact set')
         else
            call new_error(error, no_equilibrium, &
               'no equilibrium: contact and friction cannot balance the loads; '//motion// &
               '; add a support, or a load that presses the body on its obstacle')
         end if
      else if (is_round(body%zone) .and. .not. any(body%zone%is_cell)) then
         remainder = unbalanced_work(body, load_case, on_round_line(body%zone, body%rigid_modes), work)
         if (norm2(remainder) > max(unbalanced_when_round*scale, least)) call new_error(error, no_equilibrium, &
            'no equilibrium but for the irregularities of the mesh: contact and friction on the round line that '// &
            'its nodes lie on cannot balance the loads; '//largest_motion(body%motions, remainder)// &
            '; add a support or friction')
      end if
   end subroutine check_balance

   !> Finds the works of the loads on the free motions, and how large the terms are that they are sums of.
   pure subroutine find_works(work, scale, body, load_case)
      real(dp), allocatable, intent(out) :: work(:) !! the works (motions) [F]
      real(dp), intent(out) :: scale !! sum of the magnitudes of what makes up the works [F]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads
      ! The work of a force across a motion is rounding, which grows with the force.
      real(dp), parameter :: least_share = 1.0e-4_dp
      real(dp), allocatable :: own(:), moved(:, :)
      integer :: i, k, last

      scale = 0.0_dp
      last = 0
      allocate (work(sum(body%motions%n_free)), source=0.0_dp)
      do k = 1, size(body%motions)
         associate (motions => body%motions(k), of_piece => work(last + 1:last + body%motions(k)%n_free))
            if (motions%n_free == 0) cycle
            last = last + motions%n_free
            do i = 1, size(motions%node)
               associate (force => load_case%force(:, motions%node(i)))
                  if (.not. any(abs(force) > 0.0_dp)) cycle
                  moved = motions%displacement(body%mesh%coordinates(:, motions%node(i)), motions%node(i))
                  own = matmul(force, moved)
                  of_piece = of_piece + own
                  scale = scale + max(maxval(abs(own)), least_share*norm2(force)*maxval(norm2(moved, dim=1)))
               end associate
            end do
         end associate
      end do
   end subroutine find_works

   !> The works of the loads on the free motions that contact forces do not balance: a motion along which the loads do
   !> work, and no contact force does more against it (motions) [F].
   pure function unbalanced_work(body, load_case, modes, work) result(remainder)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles and friction
      real(dp), intent(in) :: modes(:, :) !! displacements of the points under all free motions (n_rows, motions) [-]
      real(dp), intent(in) :: work(:) !! the works of the loads (motions) [F]
      real(dp), allocatable :: remainder(:)
      type(cone_t) :: cone

      call new_cone(cone, modes, merge(load_case%friction, -1.0_dp, load_case%is_in_reach))
      ! A given slip bound holds open points, too.
      cone%slip_bound = load_case%slip_bound
      cone%set = body%zone%set
      remainder = cone%remainder(work)
   end function unbalanced_work

   !> Whether contact forces alone can balance each other, as those on a body between two walls: if no free rigid motion
   !> opens all contacts against friction. Given slip bounds hold open points, too.
   pure logical function can_be_wedged(body, problem, is_in_reach)
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      ! The square of an angle.
      real(dp), parameter :: least_remainder = 1.0e-10_dp
      type(cone_t) :: cone
      real(dp) :: remainder(size(body%travel, 2) + 1)
      integer :: k, n

      can_be_wedged = any(problem%slip_bound > 0.0_dp)
      if (can_be_wedged) return
      n = size(body%travel, 2)
      ! The sum of the normal forces is 1, and their works on all motions are 0.
      associate (m => problem%n_points, n_rows => problem%matrix%n)
         call new_cone(cone, reshape([body%travel, spread(1.0_dp, 1, m), spread(0.0_dp, 1, n_rows - m)], &
            [n_rows, n + 1]), merge(problem%friction, -1.0_dp, is_in_reach))
      end associate
      remainder = cone%remainder([(0.0_dp, k=1, n), 1.0_dp])
      can_be_wedged = remainder(n + 1) <= least_remainder
   end function can_be_wedged

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
         along = dot_product(normals(:, p), zone%normal(p))
         across = dot_product(normals(:, p), zone%frame(:2, 2, p))
         on_round(p, :) = along*modes(p, :) + across*modes(m + p, :)
         on_round(m + p, :) = along*modes(m + p, :) - across*modes(p, :)
      end do
   end function on_round_line

   !> The normals of the points on the circles through each point and its neighbors; where the line is straight, ends or
   !> turns by more than 35 degrees, those of the facets (2, m) [-]. A circle of twelve sides turns by 30.
   pure function round_normals(zone) result(normals)
      type(contact_zone_t), intent(in) :: zone !! the contact points; a cell keeps the normal of its sides
      real(dp), allocatable :: normals(:, :)
      real(dp), parameter :: least_cosine = 0.82_dp
      real(dp) :: before(2), after(2), tangent(2), lengths
      integer :: p, q, r

      normals = zone%frame(:2, 1, :)
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

   !> Whether points lie on a round line: facets and circles have different normals.
   pure logical function is_round(zone)
      type(contact_zone_t), intent(in) :: zone !! the contact points

      is_round = any(abs(round_normals(zone) - zone%frame(:2, 1, :)) > computed_rounding)
   end function is_round

   !> Finds the place of a body that displacements are counted from: the free rigid motion that comes closest to the
   !> gaps of the points in reach, without a slip. If much of the gaps remains, as below a hollow body, the least motion
   !> from there that ends all overlaps follows. None if there is no such place, or if it is much farther away than gaps
   !> are.
   pure subroutine find_origin(motion, body, load_case)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles and anchors
      real(dp), parameter :: much = 0.1_dp, far = 10.0_dp
      real(dp), allocatable :: amounts(:), change(:)
      real(dp) :: aim(body%zone%n_rows)
      logical :: counts(body%zone%n_rows)
      integer, allocatable :: near(:)
      integer :: p

      counts = counted(body, load_case)
      aim = merge([load_case%free_gap, load_case%anchor], 0.0_dp, counts)
      amounts = least_squares(merge(body%travel, 0.0_dp, spread(counts, 2, size(body%travel, 2))), aim)
      motion = matmul(body%travel, amounts)
      if (maxval(abs(aim - motion), mask=counts) <= max(much*maxval(abs(aim)), &
         difference_rounding*maxval(abs(body%zone%position)))) return
      near = pack([(p, p=1, body%zone%n_points)], load_case%is_in_reach)
      call find_least_motion(change, body%travel(near, :), motion(near) - aim(near))
      ! The amounts are summed, not the displacements: these have rounding errors, and would be no rigid motion.
      if (allocated(change)) motion = matmul(body%travel, amounts + change)
      if (.not. allocated(change) .or. maxval(abs(motion)) > far*maxval(abs(aim))) motion = 0.0_dp
   end subroutine find_origin

   !> Finds where a body stays that nothing loads: the free rigid motion that leaves no overlap, nearest to where it
   !> was: points that were pressed keep touching, and those with a given slip bound move along with the obstacle. It
   !> causes no forces. There is none where a load acts, where overlaps press, and where such a point would slip.
   pure subroutine find_idle_motion(motion, body, problem, before, force)
      real(dp), allocatable, intent(out) :: motion(:)
         !! its displacements (u_N; u_T) of the points; not allocated if there is none (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      real(dp), intent(in) :: before(:) !! displacements of the points before (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces before (n_rows) [F]
      real(dp), allocatable :: place(:), change(:), lacking(:)
      integer, allocatable :: pressed(:), stuck(:)
      integer :: i, p

      if (any(abs(problem%load) > 0.0_dp)) return
      associate (m => problem%n_points, travel => body%travel)
         place = least_squares(travel, before)
         pressed = pack([(p, p=1, m)], force(:m) > 0.0_dp)
         place = place + least_squares(travel(pressed, :), before(pressed) - matmul(travel(pressed, :), place))
         ! A body is where it is drawn but for the rounding errors of coordinates.
         if (all(abs(matmul(travel, place)) <= difference_rounding*maxval(abs(body%zone%position)))) place = 0.0_dp
         motion = matmul(travel, place)
         ! A given slip bound holds its point along the tangents, either way.
         stuck = pack([(m + p, p=1, size(motion) - m)], [(problem%slip_bound > 0.0_dp, i=1, body%zone%n_tangents)])
         lacking = motion - [problem%gap, problem%anchor]
         lacking = [lacking(:m), lacking(stuck), -lacking(stuck)]
         call find_least_motion(change, travel([(p, p=1, m), stuck, stuck], :)*spread([(1.0_dp, p=1, m + size(stuck)), &
            (-1.0_dp, p=1, size(stuck))], 2, size(place)), lacking)
         if (allocated(change)) then
            motion = matmul(travel, place + change)
         else if (any(lacking > difference_rounding*maxval(abs([body%zone%position, motion])))) then
            deallocate (motion)
         end if
      end associate
   end subroutine find_idle_motion

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

   !> Finds the free rigid motion that makes up nearly all of the displacements of the points; 0 if there is none.
   subroutine fit_travel(motion, body, displacement)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:) !! displacements (u_N; u_T) of the points (n_rows) [L]
      real(dp), parameter :: much = 0.01_dp

      motion = matmul(body%travel, least_squares(body%travel, displacement))
      if (maxval(abs(displacement - motion)) > max(much*maxval(abs(displacement)), &
         difference_rounding*maxval(abs(body%zone%position)))) motion = 0.0_dp
   end subroutine fit_travel

   !> The displacements of the points for which gaps and slips give a target value (n_rows).
   pure function counted(body, load_case) result(counts)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles
      logical :: counts(body%zone%n_rows)
      integer :: k

      counts(:body%zone%n_points) = load_case%is_in_reach
      counts(body%zone%n_points + 1:) = .not. [transpose(body%zone%is_fixed)] .and. [load_case%is_in_reach, &
         (load_case%is_in_reach, k=2, body%zone%n_tangents)]
   end function counted

end module amontons_loose_bodies
