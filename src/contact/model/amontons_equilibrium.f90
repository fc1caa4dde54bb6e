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
   use amontons_rigid_motion, only: rigid_motions_t
   implicit none (type, external)
   private

   public :: check_balance, round_normals

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
      real(dp) :: scale, of_places

      call balance(pieces, body, load_case, body%zone%rows%part, remainder, scale)
      ! Levers have the rounding errors of coordinates.
      of_places = epsilon(scale)*maxval(abs(body%mesh%coordinates))/minval(body%motions(pieces)%radius)
      if (norm2(remainder) > (unbalanced + of_places)*scale) then
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
         call balance(pieces, body, load_case, round_parts(body%zone), remainder, scale)
         if (norm2(remainder) > unbalanced_when_round*scale) call new_error(error, numerical_failure, &
            'no equilibrium but for the irregularities of the mesh: contact and friction on the round line that '// &
            'its nodes lie on cannot balance the loads; '//largest_motion(body%motions(pieces), remainder)// &
            '; add a support or friction')
      end if
   end subroutine check_pieces

   !> The remainder of the works of the loads on the free motions of some pieces after the best combination of the works
   !> of contact forces, by least squares.
   pure subroutine balance(pieces, body, load_case, part, remainder, scale)
      integer, intent(in) :: pieces(:) !! the pieces
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      real(dp), intent(in) :: part(:, :) !! the parts of the points: normal times share (2, parts) [-]
      real(dp), allocatable, intent(out) :: remainder(:) !! the remainder, piece after piece (n_free of all)
      real(dp), intent(out) :: scale !! sum of the magnitudes of what makes up the works
      real(dp), allocatable :: cone(:, :), most(:), work(:)
      integer :: first, last, k, n_edges, n_given

      last = sum([(body%motions(pieces(k))%n_free, k=1, size(pieces))])
      n_edges = merge(3, 1 + n_directions, body%zone%n_tangents == 1)
      n_given = body%zone%n_rows - body%zone%n_points
      allocate (cone(last, n_edges*body%zone%n_points + 2*n_given), work(last), source=0.0_dp)
      scale = 0.0_dp
      last = 0
      do k = 1, size(pieces)
         first = last + 1
         last = last + body%motions(pieces(k))%n_free
         call add_piece_works(cone(first:last, :), work(first:last), scale, body%motions(pieces(k)), body, load_case, &
            part, n_edges)
      end do
      most = [spread(huge(1.0_dp), 1, n_edges*body%zone%n_points), (load_case%slip_bound, k=1, &
         2*body%zone%n_tangents)]
      allocate (remainder, source=bounded_remainder(cone, most, work))
   end subroutine balance

   !> The parts of the points, turned from their normals to those of the round line (2, parts) [-].
   pure function round_parts(zone) result(part)
      type(contact_zone_t), intent(in) :: zone !! the contact points, each of a node
      real(dp), allocatable :: part(:, :)
      real(dp) :: normals(2, zone%n_points), along, across
      integer :: i, p

      part = zone%rows%part
      normals = round_normals(zone)
      do p = 1, zone%n_points
         along = dot_product(normals(:, p), zone%normal(:, p))
         across = dot_product(normals(:, p), turned(zone%normal(:, p)))
         do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
            part(:, i) = along*part(:, i) + across*turned(part(:, i))
         end do
      end do
   end function round_parts

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

   !> Adds the works on the free motions of a piece: those of the loads, and those of the extreme contact forces of the
   !> points, one column for each. Forces are of unit normal force, or of unit given slip bound.
   pure subroutine add_piece_works(cone, work, scale, motions, body, load_case, part, n_edges)
      real(dp), intent(inout) :: cone(:, :)
         !! works of the extreme forces: some for each point, then t of each, then -t (n_free, any)
      real(dp), intent(inout) :: work(:) !! works of the loads (n_free)
      real(dp), intent(inout) :: scale !! sum of the magnitudes of what makes up these works
      type(rigid_motions_t), intent(in) :: motions !! the motions of the piece that the supports leave free
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      real(dp), intent(in) :: part(:, :) !! the parts of the points: normal times share (2, parts) [-]
      integer, intent(in) :: n_edges !! number of extreme forces of a point: 3, of discs as many directions and n
      real(dp) :: motion(motions%n_components, motions%n_free), shear(2), angle
      real(dp), dimension(motions%n_free) :: pressed, sheared, twisted
      logical :: is_inside(body%mesh%n_nodes)
      integer :: i, k, p

      do i = 1, size(motions%node)
         associate (force => load_case%force(:, motions%node(i)))
            if (.not. any(abs(force) > 0.0_dp)) cycle
            motion = motions%displacement(body%mesh%coordinates(:, motions%node(i)), motions%node(i))
            work = work + matmul(force, motion)
            scale = scale + maxval(abs(matmul(force, motion)))
         end associate
      end do
      is_inside = .false.
      is_inside(motions%node) = .true.
      associate (zone => body%zone)
         do p = 1, zone%n_points
            do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
               if (.not. is_inside(zone%rows%node(i))) cycle
               motion = motions%displacement(body%mesh%coordinates(:, zone%rows%node(i)), zone%rows%node(i))
               associate (normal => part(:, i), given => n_edges*zone%n_points + p, last => n_edges*p)
                  shear = turned(normal)
                  if (zone%pairs(zone%set(p))%is_set()) shear = zone%rows%tangent(:, i)
                  if (zone%is_tangent_fixed(p)) shear = 0.0_dp
                  pressed = matmul(normal, motion(:2, :))
                  sheared = matmul(shear, motion(:2, :))
                  ! A given slip bound holds open points, too.
                  cone(:, given) = cone(:, given) + sheared
                  twisted = 0.0_dp
                  if (n_edges > 3) then
                     if (.not. zone%is_slip_fixed(zone%n_points + p)) twisted = zone%rows%around(i)*motion(3, :)
                     cone(:, given + zone%n_points) = cone(:, given + zone%n_points) + twisted
                  end if
                  if (.not. load_case%is_in_reach(p)) cycle
                  cone(:, last) = cone(:, last) + pressed
                  if (n_edges == 3) then
                     cone(:, last - 2) = cone(:, last - 2) + (pressed + load_case%friction(p)*sheared)
                     cone(:, last - 1) = cone(:, last - 1) + (pressed - load_case%friction(p)*sheared)
                     cycle
                  end if
                  ! Edges of a polygonal cone around the round one: loads that they cannot balance have no equilibrium.
                  do k = 1, n_directions
                     angle = 2.0_dp*pi*k/n_directions
                     cone(:, last - k) = cone(:, last - k) + (pressed + load_case%friction(p)/cos(pi/n_directions) &
                        *(cos(angle)*sheared + sin(angle)*twisted))
                  end do
               end associate
            end do
         end do
         associate (edges => n_edges*zone%n_points, given => zone%n_rows - zone%n_points)
            cone(:, edges + given + 1:) = -cone(:, edges + 1:edges + given)
         end associate
      end associate
   end subroutine add_piece_works

end module amontons_equilibrium
