!> Key results: the largest values at contact points and nodes with their positions, the force and zones of each contact
!> set, the lengths of the zones, and the positions of their ends between contact points.
!>
!> The sum T of the forces from a position s of a zone to its end a is proportional to (a - s)^(3/2) where the stress
!> goes to zero like a square root, as the pressure of Hertz or, at the end of a stick zone, the distance of the shear
!> from its bound; to (a - s)^(1/2) where it is singular, as at the corner of a punch. So T^(2/3), or T^2, is linear in
!> s, and two sums give a. Sums are taken at the ends of the tributary lengths of nodes.
!>
!> The gap beyond the end of a closed zone, and the slip beyond the end of a stick zone, grow with (s - a)^(3/2). If
!> enough points beyond the end are open, they are more accurate than the forces, which alternate at the nodes of
!> quadratic sides: the position is a polynomial of their power 2/3, and its value at 0 is the end.
module amontons_key_results
   use amontons_body, only: body_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: moment
   use amontons_element, only: n_corners, n_element_nodes
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, slip_point, stick_point, tangential_norm
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_named_set, only: of_contact
   use amontons_quantity, only: at_place, quantity_t
   use amontons_rounding, only: computed_rounding, exceeds, input_rounding, sum_rounding
   use amontons_stress_field, only: von_mises
   implicit none (type, external)
   private

   public :: all_von_mises, body_peaks, body_peaks_at_rest, contact_peaks, contact_results_t, interval_t, lengths_t, &
      new_contact_results, new_lengths, resultants, wear_results

   !> A part of the contact line that belongs to a zone.
   type :: interval_t
      integer :: set = 0 !! number of its contact set
      real(dp) :: length = 0.0_dp !! its length along the contact line [L]
      real(dp) :: ends(2, 2) = 0.0_dp !! its ends, in the order of the points (x and y, first and last) [L]
   end type interval_t

   !> The numbers from which ends of zones are found: forces inside of a zone, gaps or slips beyond.
   type :: trace_t
      real(dp), allocatable :: force(:) !! the forces that vanish outside of the zones (m) [F]
      integer :: n_summed = 1 !! number of points of each of the two sums of forces
      real(dp), allocatable :: gap(:) !! the gaps beyond closed zones; 0 where they are not used (m) [L]
      real(dp), allocatable :: slip(:) !! the slips beyond stick zones; 0 where they are not used (m) [L]
   end type trace_t

   !> Consecutive points of a contact set.
   type :: chain_t
      integer, allocatable :: point(:) !! the points (n)
      real(dp), allocatable :: arc(:) !! where they are along the line, from the first one on (n) [L]
      real(dp), allocatable :: bound(:) !! ends of their tributary lengths (0:n) [L]
   end type chain_t

   !> Lengths of the three zones. Their sum is the length of the sides between contact points, for a pair of the parts
   !> that face the master, and of the cells. In space, where points have no order, they are areas: of the points.
   type :: lengths_t
      logical :: are_areas = .false. !! whether they are areas
      real(dp) :: open = 0.0_dp !! length of sides with an open end, or area of open points [L], [L^2]
      real(dp) :: slip = 0.0_dp
         !! length of sides with closed ends of which at least one slips, or area of slipping points [L], [L^2]
      real(dp) :: stick = 0.0_dp !! length of sides with two sticking ends, or area of sticking points [L], [L^2]
   contains
      procedure :: quantities => lengths_quantities
   end type lengths_t

   !> The results at the contact points.
   type :: contact_results_t
      type(lengths_t) :: lengths !! lengths of the zones
      type(interval_t), allocatable :: closed(:) !! the closed parts of the contact line
      type(interval_t), allocatable :: stuck(:) !! its parts that stick
      type(quantity_t), allocatable :: peaks(:) !! largest values, from `contact_peaks`
      type(quantity_t), allocatable :: sets(:) !! results of each contact set
   end type contact_results_t

contains

   !> Computes the results at the contact points of a case, of a row of a sweep, or of a step.
   pure subroutine new_contact_results(results, body, solution, bound, gap, anchor, motion)
      type(contact_results_t), intent(out) :: results !! the results
      type(body_t), intent(in) :: body !! the body
      type(contact_solution_t), intent(in) :: solution !! displacements, forces and statuses of the points
      real(dp), intent(in) :: bound(:) !! slip bounds g + phi lambda_N of the tangential forces (m) [F]
      real(dp), intent(in) :: gap(:) !! gaps of the points without displacements, d (m) [L]
      real(dp), intent(in), optional :: anchor(:) !! what slips of the step count from; default 0 (n_rows - m) [L]
      real(dp), intent(in), optional :: motion(:) !! motion of the obstacles since rest; default none (n_rows - m) [L]
      real(dp) :: slip(body%zone%n_rows - body%zone%n_points)

      call new_lengths(results%lengths, body%zone, solution%status)
      slip = solution%displacement(size(gap) + 1:)
      if (present(anchor)) slip = slip - anchor
      ! What supports prescribe counts as no slip: displacements of a solution lack it, those of a grid do not.
      slip = body%zone%free_slips(slip)
      call find_zones(results%closed, results%stuck, body, solution%force, solution%status, bound, &
         [gap - solution%displacement(:size(gap)), slip], solution%displacement)
      results%peaks = contact_peaks(body, solution, motion)
      results%sets = set_results(body, solution%force, results%closed, results%stuck)
   end subroutine new_contact_results

   !> Finds the intervals of the contact line that belong to a zone.
   pure subroutine find_intervals(intervals, zone, is_inside, trace)
      type(interval_t), allocatable, intent(out) :: intervals(:) !! the parts
      type(contact_zone_t), intent(in) :: zone !! the contact points
      logical, intent(in) :: is_inside(:) !! which points belong to the zone (m)
      type(trace_t), intent(in) :: trace !! forces, gaps and slips from which the ends of the zone are found
      type(chain_t) :: chain
      integer, allocatable :: order(:), start(:)
      integer :: first, last, n, p, k, n_intervals

      allocate (intervals(merge(count(is_inside), 0, allocated(zone%line))))
      if (size(intervals) == 0) return
      n_intervals = 0
      call zone%line%walk(order, start)
      do k = 1, size(start) - 1
         call new_chain(chain, zone, order(start(k):start(k + 1) - 1))
         n = size(chain%point)
         last = 0
         do p = 1, n
            if (p <= last .or. .not. is_inside(chain%point(p))) cycle
            first = p
            last = first
            do while (last < n)
               if (.not. is_inside(chain%point(last + 1))) exit
               last = last + 1
            end do
            n_intervals = n_intervals + 1
            call set_interval(intervals(n_intervals), zone, chain, first, last, trace)
         end do
      end do
      intervals = intervals(:n_intervals)
   end subroutine find_intervals

   !> Finds where the points of one line are along it, and where their tributary lengths end.
   pure subroutine new_chain(chain, zone, order)
      type(chain_t), intent(out) :: chain !! the points
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: order(:) !! those of the line, one or more
      real(dp) :: share
      integer :: i

      chain%point = order
      associate (n => size(order))
         allocate (chain%arc(n), chain%bound(0:n))
         chain%arc(1) = 0.0_dp
         do i = 2, n
            chain%arc(i) = chain%arc(i - 1) + norm2(zone%position(:, order(i)) - zone%position(:, order(i - 1)))
         end do
         ! The tributary length of the first one begins at an end point of the line, before any other, as where a
         ! support holds the node before.
         chain%bound(0) = -0.5_dp*zone%weight(order(1))
         if (n == 2 .and. zone%weight(order(1)) < 0.75_dp*chain%arc(n)) chain%bound(0) = 0.0_dp
         if (n >= 3 .and. .not. zone%is_cell(order(1))) then
            ! The second point's tributary length, over the half of the sides or half sides next to it, is 1 for a node
            ! of linear sides, 2/3 for a corner of quadratic ones and 4/3 for a middle. It begins accordingly: in the
            ! middle of the side before, at two thirds or at one third of the half side before.
            associate (ratio => 2.0_dp*zone%weight(order(2))/(chain%arc(3) - chain%arc(1)))
               share = 0.5_dp
               if (ratio < 5.0_dp/6.0_dp) share = 2.0_dp/3.0_dp
               if (ratio > 7.0_dp/6.0_dp) share = 1.0_dp/3.0_dp
            end associate
            chain%bound(0) = share*chain%arc(2) - zone%weight(order(1))
         end if
         if (allocated(zone%pairs)) call begin_where_covered(chain%bound(0), zone%pairs(zone%set(order(1))), &
            order(1) - findloc(zone%set, zone%set(order(1)), dim=1) + 1)
         do i = 1, n
            chain%bound(i) = chain%bound(i - 1) + zone%weight(order(i))
         end do
      end associate
   end subroutine new_chain

   !> Moves the beginning of a chain of slave corners to where the master begins to face them, which may be in the
   !> middle of a side.
   pure subroutine begin_where_covered(begin, pair, point)
      real(dp), intent(inout) :: begin !! position of the beginning, as a length from the first point [L]
      type(mortar_pair_t), intent(in) :: pair !! the pair, or none
      integer, intent(in) :: point !! number of that point in the pair
      real(dp) :: length
      integer :: i

      if (.not. pair%is_set() .or. allocated(pair%cells)) return
      ! Segments go along the line: the first one of the first side with this corner.
      do i = 1, size(pair%segments)
         associate (segment => pair%segments(i), points => pair%point_of(:, pair%segments(i)%slave))
            if (all(points /= point)) cycle
            ! A line without ends begins at any of its points.
            if (all(points > 0) .and. points(2) == point) return
            length = norm2(pair%slave%corner(:, 2, segment%slave) - pair%slave%corner(:, 1, segment%slave))
            begin = 0.5_dp*length*(segment%range(1) + merge(1.0_dp, -1.0_dp, points(1) == point))
            return
         end associate
      end do
   end subroutine begin_where_covered

   !> Finds the ends of a run of consecutive points inside of a zone.
   pure subroutine set_interval(interval, zone, chain, first, last, trace)
      type(interval_t), intent(out) :: interval !! the part of the line
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(chain_t), intent(in) :: chain !! the points that follow each other
      integer, intent(in) :: first !! the first point inside
      integer, intent(in) :: last !! the last point inside
      type(trace_t), intent(in) :: trace !! forces, gaps and slips from which the ends of the zone are found
      real(dp) :: begin, end
      integer :: n

      n = size(chain%point)
      begin = chain%bound(first - 1)
      if (first > 1) begin = -zone_end(-chain%arc(first:1:-1), -chain%bound(last:first - 1:-1), &
         trace%force(chain%point(last:first:-1)), trace%n_summed, trace%gap(chain%point(first - 1:1:-1)), &
         trace%slip(chain%point(first - 1:1:-1)))
      end = chain%bound(last)
      if (last < n) end = zone_end(chain%arc(last:), chain%bound(first - 1:last), &
         trace%force(chain%point(first:last)), trace%n_summed, trace%gap(chain%point(last + 1:)), &
         trace%slip(chain%point(last + 1:)))
      interval%set = zone%set(chain%point(first))
      interval%length = max(0.0_dp, end - begin)
      interval%ends(:, 1) = place_at(zone, chain, begin)
      interval%ends(:, 2) = place_at(zone, chain, end)
   end subroutine set_interval

   !> The position of the end of a zone with points beyond it: from its forces; of a closed zone rather from three of
   !> the gaps beyond it, of which the first is the least accurate; of a stick zone from two of the slips beyond it.
   !> There the first slip is not used: the points next to the true end often have the other status, so that the end may
   !> lie beyond the first point that slips.
   pure real(dp) function zone_end(arc, bound, force, n_summed, gap, slip)
      real(dp), intent(in) :: arc(0:) !! where its last point and those beyond it lie (0:k) [L]
      real(dp), intent(in) :: bound(0:) !! where the tributary lengths of its points end (0:n) [L]
      real(dp), intent(in) :: force(:) !! their forces (n) [F]
      integer, intent(in) :: n_summed !! number of points of each sum
      real(dp), intent(in) :: gap(:) !! gaps of the points beyond it (k) [L]
      real(dp), intent(in) :: slip(:) !! slips of the points beyond it (k) [L]
      integer, parameter :: gaps(3) = [2, 4, 6], fewest = 3, most = 5
      ! Which slips are used where three, four, or five points and more in a row slip: if possible two corners or two
      ! middles.
      integer, parameter :: slips(2, fewest:most) = reshape([2, 3, 2, 4, 3, 5], shape(slips))
      ! Powers of the stress over the distance from the end: where it grows towards it, and where it falls.
      real(dp), parameter :: falling = 2.0_dp/3.0_dp, growing = 2.0_dp
      real(dp) :: outer, inner
      logical :: is_growing
      integer :: k, n

      n = size(force)
      zone_end = bound(n)
      is_growing = .false.
      ! Both sums together take at most half of the points: the zone may end on the other side as well.
      k = min(n_summed, n/4)
      outer = sum(force(n - k + 1:))
      inner = sum(force(n - 2*k + 1:n - k))
      if (min(outer, inner) > 0.0_dp) then
         is_growing = outer*(bound(n - k) - bound(n - 2*k)) > inner*(bound(n) - bound(n - k))
         ! Over the larger sum, neither power overflows.
         associate (ratio => (outer/(outer + inner))**merge(growing, falling, is_growing))
            zone_end = bound(n - k) + (bound(n - k) - bound(n - 2*k))*ratio/(1.0_dp - ratio)
         end associate
         zone_end = max(bound(n - 1), min(arc(1), zone_end))
      end if
      if (.not. is_growing .and. n_growing(gap) >= gaps(3)) then
         ! A smaller gap may be what rounding leaves of a point that touches without force.
         if (gap(1) > max(input_rounding*gap(2), sum_rounding*(arc(gaps(3)) - arc(0)))) zone_end = max(bound(n - 1), &
            min(arc(1), extrapolated_zero(arc(gaps), gap(gaps))))
      end if
      n = min(n_growing(slip), most)
      if (n >= fewest) zone_end = max(arc(0), min(arc(2), extrapolated_zero(arc(slips(:, n)), slip(slips(:, n)))))
   end function zone_end

   !> Number of leading values that have one sign and increase in magnitude.
   pure integer function n_growing(values) result(n)
      real(dp), intent(in) :: values(:) !! the numbers

      n = 0
      do while (n < size(values))
         if (.not. values(n + 1)*values(1) > 0.0_dp) exit
         if (n > 0) then
            if (.not. exceeds(abs(values(n + 1)), abs(values(n)))) exit
         end if
         n = n + 1
      end do
   end function n_growing

   !> The position where a quantity is 0 whose power 2/3 is linear in the position, by extrapolation of two values; with
   !> three values the position is a quadratic polynomial of the power (Lagrange) [L].
   pure real(dp) function extrapolated_zero(place, values) result(zero)
      real(dp), intent(in) :: place(:) !! the places, two or three [L]
      real(dp), intent(in) :: values(:) !! the numbers there, of one sign, each larger than the one before
      real(dp) :: root(size(place)), weight
      integer :: i, k

      root = (abs(values)/abs(values(size(values))))**(2.0_dp/3.0_dp)
      zero = 0.0_dp
      do i = 1, size(place)
         weight = 1.0_dp
         do k = 1, size(place)
            if (k /= i) weight = weight*root(k)/(root(k) - root(i))
         end do
         zero = zero + weight*place(i)
      end do
   end function extrapolated_zero

   !> The position at an arc length along a chain, which may lie beyond its ends [L].
   pure function place_at(zone, chain, arc) result(place)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(chain_t), intent(in) :: chain !! the points that follow each other
      real(dp), intent(in) :: arc !! the length [L]
      real(dp) :: place(size(zone%position, 1))
      integer :: i, n

      n = size(chain%point)
      place = zone%position(:, chain%point(1))
      if (n == 1) return
      i = max(1, min(n - 1, count(chain%arc <= arc)))
      associate (from => zone%position(:, chain%point(i)), to => zone%position(:, chain%point(i + 1)))
         place = from + (arc - chain%arc(i))/(chain%arc(i + 1) - chain%arc(i))*(to - from)
      end associate
   end function place_at

   !> The sums of the normal and the tangential contact forces, the latter in magnitude in space.
   pure function resultants(force, m, in_space) result(list)
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      integer, intent(in) :: m !! number of points
      logical, intent(in) :: in_space !! whether the tangential forces are vectors on a face
      type(quantity_t) :: list(2)
      real(dp) :: tangential

      tangential = sum(force(m + 1:2*m))
      if (in_space) tangential = sum(tangential_norm(force(m + 1:), m))
      list = [quantity_t('normal_force', 'Normal forces', sum(force(:m)), sum(abs(force)), dimension='F'), &
         quantity_t('tangential_force', 'Tangential forces', tangential, sum(abs(force)), dimension='F')]
   end function resultants

   !=key_results `max_contact_pressure` | F/L² | largest contact pressure of a contact point
   !=key_results `max_contact_shear` | F/L² | largest magnitude of the contact shear
   !=key_results `max_slip` | L | largest magnitude of the slip of a closed point, without what a support prescribes;
   !=   points that a support holds tangentially are left out
   !=key_results `max_von_mises` | F/L² | largest `nodal_von_mises` of `NAME.vtu`; of sweeps with [`key_results =
   !=   'all'`](decks.md#output)
   !=key_results `max_displacement` | L | largest magnitude of the displacement of a node; of sweeps likewise
   !=key_results `contact_width`, `stick_width` | L | length of what is closed, and of what sticks, of a contact set,
   !=   with [ends between the nodes](#zones-and-their-ends)
   !=key_results `contact_centroid_x`, `contact_centroid_y` | L | center of pressure, the mean of the places weighted by
   !=   the normal forces; 0 without normal forces
   !=key_results `contact_force_x`, `contact_force_y` | F | resultant of the contact forces on the body
   !=key_results `contact_moment` | F L | their moment about the origin, counter-clockwise positive; not of bodies of
   !=   revolution
   !=key_results `contact_torque` | F L | of a [twisted](theory.md#twist) body: their moment about the axis
   !=key_results `rigid_NAME_ux`, `rigid_NAME_uy`, `rigid_NAME_turn` | L, L, none | motion of the [rigid
   !=   set](decks.md#rigid-may-be-repeated-may-be-absent) NAME; of bodies of revolution `rigid_NAME_uy` only, if
   !=   they twist `rigid_NAME_turn` as well
   !=key_results `rigid_NAME_force_x`, `rigid_NAME_force_y`, `rigid_NAME_moment` | F, F, F L | what drives it: given
   !=   force and moment, or what it takes to prescribe the motion; the moment about its point, of a
   !=   twisted body about the axis
   !=key_results `preload_NAME_shortening`, `preload_NAME_force` | L, F | shortening and force of the
   !=   [preload](decks.md#preload-may-be-repeated-may-be-absent) NAME, of bodies of revolution all around the axis
   !=key_results `max_wear_depth` | L | of a history with `wear`: the largest depth worn
   !=key_results `wear_volume_NAME` | L³ | the volume that a contact set or pair of this name has lost
   !=key_results `reaction_x_NAME`, `reaction_y_NAME` | F | [force by name](#forces-by-name): what a support, with its
   !=   elastic foundation, exerts on the body
   !=key_results `reaction_moment_NAME` | F L | its moment about the origin
   !=key_results `force_normal_NAME`, `force_tangential_NAME` | F | sums of the normal and tangential forces of a
   !=   contact set or pair
   !=key_results `force_x_NAME`, `force_y_NAME` | F | its force on the body, of a pair on that of `set`
   !=key_results `force_moment_NAME` | F L | its moment about the origin
   !=key_results `tie_x_NAME`, `tie_y_NAME` | F | what a tie exerts on the body of its `set`
   !=key_results `tie_moment_NAME` | F L | its moment about the origin; of a preload about the middle of the cut
   !=key_results `tie_tangential_NAME` | F | shear of a preload along the cut, on the body of its `set`; in a
   !=   solid `tie_x_NAME`, `tie_y_NAME` and `tie_z_NAME` are the shear
   !=key_results `reaction_torque_NAME`, `force_torque_NAME`, `tie_torque_NAME` | F L | of a twisted body: moments about
   !=   the axis
   !> The largest pressure, shear and slip of the contact points. The slip of open points, and of points whose
   !> tangential direction a support holds, is left out. A body without contact points has no such results.
   pure function contact_peaks(body, solution, motion) result(list)
      type(body_t), intent(in) :: body !! the body
      type(contact_solution_t), intent(in) :: solution !! displacements, forces and statuses of the points
      real(dp), intent(in), optional :: motion(:) !! motion of the obstacles since rest; default none (n_rows - m) [L]
      type(quantity_t), allocatable :: list(:)
      real(dp) :: area(body%zone%n_points), slip(body%zone%n_rows - body%zone%n_points), scale, extent
      real(dp) :: nodal(body%zone%n_rows)
      integer :: i, m

      m = body%zone%n_points
      allocate (list(merge(3, 0, m > 0)))
      if (m == 0) return
      scale = maxval(abs(solution%displacement))
      slip = solution%displacement(m + 1:)
      if (present(motion)) slip = slip - motion
      associate (zone => body%zone, force => solution%force, status => solution%status)
         area = merge(zone%area, 1.0_dp, zone%area > 0.0_dp)
         nodal = zone%nodal_forces(force)
         list(1) = peak('max_contact_pressure', 'Max. pressure', nodal(:m)/area, zone%position, 0.0_dp, 'F/L^2')
         list(2) = peak('max_contact_shear', 'Max. shear', tangential_norm(nodal(m + 1:), m)/area, zone%position, &
            list(1)%value, 'F/L^2')
         ! The slip of what sticks is a rounding error, if not of what has moved then of what forces of this size move.
         extent = body%size/maxval(body%materials%list%young(1))
         do i = 0, zone%n_tangents
            scale = max(scale, maxval(abs(force(i*m + 1:i*m + m))/area)*extent)
         end do
         ! What supports prescribe counts as no slip.
         list(3) = peak('max_slip', 'Max. slip', merge(tangential_norm(zone%free_slips(slip), m), &
            0.0_dp, status /= open_point .and. .not. all(zone%is_fixed, dim=1)), zone%position, scale, 'L')
      end associate
   end function contact_peaks

   !> The largest depth worn, and the worn volume of each contact by name; nothing if there is no wear.
   pure function wear_results(body, contacts, depth) result(list)
      type(body_t), intent(in) :: body !! the body
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      real(dp), intent(in) :: depth(:) !! depth worn at each point (m) [L]
      type(quantity_t), allocatable :: list(:)
      integer :: i, p

      allocate (list(0))
      if (.not. any(contacts%wear > 0.0_dp)) return
      list = [peak('max_wear_depth', 'Max. wear depth', depth, body%zone%position, 0.0_dp, 'L')]
      do i = 1, size(body%named)
         associate (named => body%named(i))
            if (named%kind /= of_contact) cycle
            if (.not. any(contacts(named%member)%wear > 0.0_dp)) cycle
            list = [list, quantity_t('wear_volume_'//named%name, 'Wear volume '//named%name, sum(depth*body%zone%area, &
               mask=[(any(named%member == body%zone%set(p)), p=1, size(depth))]), dimension='L^3')]
         end associate
      end do
   end function wear_results

   !> Finds the intervals of the contact line that are closed, and those that stick.
   pure subroutine find_zones(closed, stuck, body, force, status, bound, motion, displacement)
      type(interval_t), allocatable, intent(out) :: closed(:) !! the closed parts
      type(interval_t), allocatable, intent(out) :: stuck(:) !! the parts that stick
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      integer, intent(in) :: status(:) !! statuses of the points (m)
      real(dp), intent(in) :: bound(:) !! slip bounds g + phi lambda_N of the tangential forces (m) [F]
      real(dp), intent(in) :: motion(:) !! gaps and slips of the points (2m) [L]
      real(dp), intent(in) :: displacement(:) !! displacements of the points, normal and tangential (2m) [L]
      type(trace_t) :: trace
      real(dp), allocatable :: slip(:)
      logical :: has_middles
      integer :: m

      m = size(status)
      trace%force = force(:m)
      trace%n_summed = 2
      trace%gap = merge(motion(:m), 0.0_dp, status == open_point)
      trace%slip = 0.0_dp*motion(:m)
      call find_intervals(closed, body%zone, status /= open_point, trace)
      trace%force = bound - tangential_norm(force(m + 1:), m)
      slip = motion(m + 1:2*m)
      if (body%zone%n_tangents == 2) slip = tangential_norm(motion(m + 1:), m)
      has_middles = any(n_element_nodes(body%mesh%element_kind) > n_corners(body%mesh%element_kind))
      ! Of quadratic sides a corner and a middle together.
      trace%n_summed = merge(2, 1, has_middles)
      trace%gap = 0.0_dp*motion(:m)
      if (has_middles) trace%slip = merge(slip, 0.0_dp, (status == slip_plus .or. status == slip_minus .or. &
         status == slip_point) .and. abs(slip) > sum_rounding*maxval(abs(displacement)))
      ! Without friction rounding makes a point stick or slip.
      call find_intervals(stuck, body%zone, status == stick_point .and. bound > 0.0_dp, trace)
   end subroutine find_zones

   !> The results of each contact set: forces, largest pressure, and ends of its zones.
   pure function set_results(body, force, closed, stuck) result(list)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      type(interval_t), intent(in) :: closed(:) !! the closed parts of the contact line
      type(interval_t), intent(in) :: stuck(:) !! its parts that stick
      type(quantity_t), allocatable :: list(:)
      ! Ends between nodes are found to about a tenth of a side each.
      real(dp), parameter :: between_nodes = 0.2_dp
      character, parameter :: axes(3) = ['x', 'y', 'z']
      character(12) :: number
      character(13) :: suffix
      real(dp), dimension(1 + body%zone%n_tangents) :: force_sum, acting
      real(dp), dimension(size(body%zone%position, 1)) :: at, center
      ! Moments about the axes in space, in the plane the last about the origin or, of a twisted body, the axis.
      real(dp) :: total(3), turning(3), normal, length, scale
      integer :: i, k, p, n_sets

      n_sets = maxval(body%zone%set)
      ! A single set needs no number.
      number = ''
      suffix = ''
      allocate (list(0))
      do i = 1, n_sets
         if (n_sets > 1) write (number, '(i0)') i
         if (n_sets > 1) suffix = '_'//number
         force_sum = 0.0_dp
         total = 0.0_dp
         normal = 0.0_dp
         center = 0.0_dp
         associate (zone => body%zone)
            do p = 1, zone%n_points
               if (zone%set(p) /= i) cycle
               acting = -matmul(zone%frame(:, :, p), force(p::zone%n_points))
               at = zone%acting(:, p)
               turning = moment(at, acting)
               if (body%materials%is_twisted()) turning(3) = at(1)*acting(3)
               force_sum = force_sum + acting
               total = total + turning
               normal = normal + force(p)
               center = center + force(p)*at
            end do
            if (abs(normal) > 0.0_dp) center = center/normal
            length = maxval(abs(zone%position))
            scale = sum(abs(force))
         end associate
         if (size(center) == 2) then
            list = [list, quantity_t('contact_width'//suffix, 'Contact width '//number, sum(closed%length, &
               mask=closed%set == i), length, between_nodes, dimension='L'), &
               quantity_t('stick_width'//suffix, 'Stick width '//number, sum(stuck%length, mask=stuck%set == i), &
               length, between_nodes, dimension='L')]
         else
            list = [list, quantity_t('contact_area'//suffix, 'Contact area '//number, sum(body%zone%area, &
               mask=body%zone%set == i .and. force(:body%zone%n_points) > 0.0_dp), resolution=1.0_dp, dimension='L^2')]
         end if
         do k = 1, size(center)
            list = [list, quantity_t('contact_centroid_'//axes(k)//suffix, 'Centroid '//axes(k)//' '//number, &
               center(k), length, dimension='L')]
         end do
         do k = 1, size(center)
            list = [list, quantity_t('contact_force_'//axes(k)//suffix, 'Force '//axes(k)//' '//number, force_sum(k), &
               scale, dimension='F')]
         end do
         if (size(center) == 3) then
            do k = 1, 3
               list = [list, quantity_t('contact_moment_'//axes(k)//suffix, 'Moment '//axes(k)//' '//number, &
                  total(k), length*scale, dimension='F L')]
            end do
         else
            ! In a body of revolution forces have no moment but that about the axis.
            associate (is_twisted => body%materials%is_twisted())
               if (.not. body%is_axisymmetric .or. is_twisted) list = [list, quantity_t('contact_'//merge('torque', &
                  'moment', is_twisted)//suffix, merge('Torque ', 'Moment ', is_twisted)//number, total(3), &
                  length*scale, dimension='F L')]
            end associate
         end if
      end do
   end function set_results

   !> The largest displacement and the largest von Mises stress of the nodes.
   pure function body_peaks(mesh, displacement, stress) result(list)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: stress(:, :) !! stress at each node (n_strains, n_nodes) [F/L^2]
      type(quantity_t) :: list(2)

      list = body_peaks_at_rest(size(mesh%coordinates, 1))
      call find_peak(list(1), all_von_mises(stress), mesh%coordinates)
      call find_peak(list(2), norm2(displacement, dim=1), mesh%coordinates)
   end function body_peaks

   !> Von Mises stresses of the nodes [F/L^2].
   pure function all_von_mises(stress) result(mises)
      real(dp), intent(in) :: stress(:, :) !! the stresses (n_strains, any) [F/L^2]
      real(dp) :: mises(size(stress, 2))
      integer :: i

      do i = 1, size(stress, 2)
         mises(i) = von_mises(stress(:, i))
      end do
   end function all_von_mises

   !> The results of `body_peaks` for a body without loads.
   pure function body_peaks_at_rest(n_dim) result(list)
      integer, intent(in) :: n_dim !! number of dimensions
      type(quantity_t) :: list(2)
      real(dp) :: origin(n_dim)

      origin = 0.0_dp
      list = [at_place('max_von_mises', 'Max. von Mises', 0.0_dp, origin, 0.0_dp, 'F/L^2'), &
         at_place('max_displacement', 'Max. displacement', 0.0_dp, origin, 0.0_dp, 'L')]
   end function body_peaks_at_rest

   !> The largest of some values, with its position.
   pure function peak(key, label, values, places, scale, dimension) result(quantity)
      character(*), intent(in) :: key !! its name in files
      character(*), intent(in) :: label !! its name in listings
      real(dp), intent(in) :: values(:) !! the values (any)
      real(dp), intent(in) :: places(:, :) !! where each is found (n_dim, any) [L]
      real(dp), intent(in) :: scale !! scale of its rounding errors
      character(*), intent(in) :: dimension !! its dimension
      type(quantity_t) :: quantity

      quantity = at_place(key, label, 0.0_dp, spread(0.0_dp, 1, size(places, 1)), scale, dimension)
      call find_peak(quantity, values, places)
   end function peak

   !> Finds the largest of some values, of those that differ by rounding only the first; the result is 0 if all are
   !> rounding errors.
   pure subroutine find_peak(quantity, values, places)
      type(quantity_t), intent(inout) :: quantity !! 0, with its scale; gains value and place
      real(dp), intent(in) :: values(:) !! the values (any)
      real(dp), intent(in) :: places(:, :) !! where each is found (n_dim, any) [L]
      integer :: i

      if (.not. any(values > computed_rounding*quantity%scale)) return
      i = findloc(values >= (1.0_dp - computed_rounding)*maxval(values), .true., dim=1)
      quantity%value = values(i)
      quantity%place(:size(places, 1)) = places(:, i)
   end subroutine find_peak

   !> Measures the zones along the sides, with the convention of Table 1 of the paper for its separated, sliding and
   !> sticking parts: the open zone ends at the first closed node, the slip zone at the first sticking node. A cell of
   !> constant multipliers belongs to one zone as a whole. In space the areas of the points are summed up.
   pure subroutine new_lengths(lengths, zone, status, set)
      type(lengths_t), intent(out) :: lengths !! the lengths
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: status(:) !! status of each point (m)
      integer, intent(in), optional :: set !! the contact set to measure; all of them without it, or with 0
      real(dp) :: length
      integer :: p, ends(2)

      lengths%are_areas = .not. allocated(zone%line)
      do p = 1, zone%n_points
         if (present(set)) then
            if (set > 0 .and. zone%set(p) /= set) cycle
         end if
         ends = p
         if (lengths%are_areas) then
            length = zone%area(p)
         else if (zone%is_cell(p)) then
            length = zone%weight(p)
         else
            if (zone%line%next(p) == 0) cycle
            ends(2) = zone%line%next(p)
            length = norm2(zone%position(:, ends(2)) - zone%position(:, p))
            ! Of a side of a pair the share that faces the master counts.
            if (allocated(zone%pairs)) then
               associate (pair => zone%pairs(zone%set(p)), first => findloc(zone%set, zone%set(p), dim=1))
                  if (pair%is_set()) length = length*pair%covered_share(p - first + 1)
               end associate
            end if
         end if
         if (any(status(ends) == open_point)) then
            lengths%open = lengths%open + length
         else if (all(status(ends) == stick_point)) then
            lengths%stick = lengths%stick + length
         else
            lengths%slip = lengths%slip + length
         end if
      end do
   end subroutine new_lengths

   !> Open, slip and stick length or area, as quantities with their names [L], [L^2].
   pure function lengths_quantities(self) result(list)
      class(lengths_t), intent(in) :: self !! the lengths
      type(quantity_t) :: list(3)

      if (self%are_areas) then
         list = [quantity_t('open_area', 'Open area', self%open, resolution=1.0_dp, dimension='L^2'), &
            quantity_t('slip_area', 'Slip area', self%slip, resolution=1.0_dp, dimension='L^2'), &
            quantity_t('stick_area', 'Stick area', self%stick, resolution=1.0_dp, dimension='L^2')]
         return
      end if
      list = [quantity_t('open_length', 'Open length', self%open, resolution=1.0_dp, dimension='L'), &
         quantity_t('slip_length', 'Slip length', self%slip, resolution=1.0_dp, dimension='L'), &
         quantity_t('stick_length', 'Stick length', self%stick, resolution=1.0_dp, dimension='L')]
   end function lengths_quantities

end module amontons_key_results
