!> Existence of equilibrium: whether admissible contact forces can balance the loads of a body that supports do not
!> hold.
!>
!> The works of the loads on the free rigid motions must be a combination of the works of extreme contact forces: with
!> factors at least 0 those of n + phi t and n - phi t of the contact points (a cone), and those of n, which rounding
!> would lose between them for large friction; and, with factors up to a given slip bound, those of t and -t. Otherwise,
!> by Farkas' lemma, the remainder is a rigid motion that the loads drive and that no contact force opposes enough:
!> there is no equilibrium, and the body is free to move along it.
!>
!> The normals of the facets of a round line miss its center a little, so that huge forces with arms of both signs would
!> balance any moment. Loads therefore have no equilibrium either if a remainder is left with the normals of the circles
!> through neighboring nodes. In a pair the round line is that of the slave.
module amontons_equilibrium
   use amontons_body, only: body_t, largest_motion
   use amontons_contact_rows, only: turned
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: bounded_remainder
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp
   use amontons_load_case, only: load_case_t
   implicit none (type, external)
   private

   public :: check_balance, on_round_line, round_normals

   !> Number of directions of the extreme forces of a disc.
   integer, parameter :: n_directions = 16
   !> The ratio of a circle's circumference to its diameter.
   real(dp), parameter :: pi = acos(-1.0_dp)

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
      ! A tenth of the residual of methods; the other limit is for the center of gravity of a round body, whose position
      ! depends on the mesh.
      real(dp), parameter :: unbalanced = 1.0e-11_dp, unbalanced_when_round = 1.0e-2_dp
      real(dp), allocatable :: remainder(:)
      character(:), allocatable :: motion
      real(dp) :: scale, rounding

      ! Levers have the rounding errors of coordinates.
      rounding = unbalanced + epsilon(scale)*maxval(abs(body%mesh%coordinates))/minval(body%motions(pieces)%radius)
      call balance(pieces, body, load_case, body%rigid_modes, rounding, remainder, scale)
      if (norm2(remainder) > rounding*scale) then
         motion = largest_motion(body%motions(pieces), remainder)
         if (body%zone%n_points == 0) then
            call new_error(error, numerical_failure, 'no equilibrium: nothing balances the loads; '//motion// &
               '; add a support or a contact set')
         else
            call new_error(error, numerical_failure, &
               'no equilibrium: contact and friction cannot balance the loads; '//motion// &
               '; add a support, or a load that presses the body on its obstacle')
         end if
      else if (.not. any(body%zone%is_cell)) then
         call balance(pieces, body, load_case, on_round_line(body%zone, body%rigid_modes), rounding, remainder, scale)
         if (norm2(remainder) > unbalanced_when_round*scale) call new_error(error, numerical_failure, &
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
      real(dp), allocatable :: cone(:, :), edge(:, :), most(:), own(:)
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
                  own = matmul(force, motions%displacement(body%mesh%coordinates(:, motions%node(i)), motions%node(i)))
                  work(first:last) = work(first:last) + own
                  scale = scale + maxval(abs(own))
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
      cone(:, k*m - m + 1:k*m - m + n_given) = transpose(modes(m + 1:, :))
      cone(:, k*m - m + n_given + 1:) = -transpose(modes(m + 1:, :))
      ! Without this the unlimited force of a wall, times what rounding leaves of its work, would bear a load along it.
      where (spread(norm2(cone, 1) <= rounding, 1, size(work))) cone = 0.0_dp
      most = [spread(huge(1.0_dp), 1, (n_edges + 1)*m), (load_case%slip_bound, k=1, 2*body%zone%n_tangents)]
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
   !> turns by more than 30 degrees, those of the facets (2, m) [-].
   pure function round_normals(zone) result(normals)
      type(contact_zone_t), intent(in) :: zone !! the contact points; a cell keeps the normal of its sides
      real(dp), allocatable :: normals(:, :)
      real(dp), parameter :: least_cosine = 0.8660254037844386_dp, straight = 1.0e-9_dp
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

end module amontons_equilibrium
