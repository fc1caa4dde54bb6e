!> Whether admissible contact forces can balance the loads of a body that supports do not hold.
!>
!> The load's work on the free rigid motions must be a combination, with factors at least 0, of the works of the extreme
!> forces n + phi t and n - phi t of the contact points (a cone), and of n between them, which large friction leaves to
!> rounding otherwise. If it is none, the part that is left over is, by Farkas' lemma, a rigid motion that the loads
!> drive and no contact force opposes: there is no equilibrium, and along it the body is free.
!>
!> The normals of a round line's facets miss its center a little, so that huge forces of both signs of arm would balance
!> any moment. What normals of the circles through neighboring nodes leave much of has no equilibrium either. For a pair
!> the round line is the slave.
!>
!> A given slip bound is taken for one that bears any shear: what is refused has no equilibrium whatever the bound is.
module amontons_equilibrium
   use amontons_body, only: body_t
   use amontons_contact_rows, only: turned
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp
   use amontons_load_case, only: load_case_t
   use amontons_rigid_modes, only: largest_motion
   use amontons_rigid_motion, only: rigid_motions_t
   implicit none (type, external)
   private

   public :: check_balance, has_nodal_points, nonnegative_remainder, round_normals

   !> What rounding leaves of a zero, over the numbers it came from.
   real(dp), parameter :: negligible = 1.0e-13_dp

contains

   !> Refuses loads that drive a piece of the body away. Pieces that share points of contact are looked at together.
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

   !> The first of the pieces that supports do not hold and that share points of contact with each piece.
   pure function leading_pieces(body) result(leader)
      type(body_t), intent(in) :: body !! the body
      integer :: leader(size(body%motions))
      integer :: piece(body%mesh%n_nodes), p, i, first, second

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

   !> Refuses loads that drive some of the pieces away.
   pure subroutine check_pieces(pieces, body, load_case, error)
      integer, intent(in) :: pieces(:) !! the pieces
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium; names the motion
      ! Between these a mesh may place the center of gravity of a round body.
      real(dp), parameter :: unbalanced = 1.0e-9_dp, unbalanced_when_round = 1.0e-2_dp
      real(dp), allocatable :: remainder(:)
      character(:), allocatable :: motion
      real(dp) :: scale

      call balance(pieces, body, load_case, body%zone%rows%part, remainder, scale)
      if (norm2(remainder) > unbalanced*scale) then
         motion = largest_motion(body%motions(pieces), remainder)
         if (body%zone%n_points == 0) then
            call new_error(error, numerical_failure, 'no equilibrium: nothing balances the loads; '//motion// &
               '; add a support or a contact set')
         else
            call new_error(error, numerical_failure, &
               'no equilibrium: contact and friction cannot balance the loads; '//motion// &
               '; add a support, or a load that presses the body on its obstacle')
         end if
      else if (has_nodal_points(body%zone)) then
         call balance(pieces, body, load_case, round_parts(body%zone), remainder, scale)
         if (norm2(remainder) > unbalanced_when_round*scale) call new_error(error, numerical_failure, &
            'no equilibrium but for the irregularities of the mesh: contact and friction on the round line that '// &
            'its nodes lie on cannot balance the loads; '//largest_motion(body%motions(pieces), remainder)// &
            '; add a support or friction')
      end if
   end subroutine check_pieces

   !> What is left of the works of the loads on the free motions of some pieces when contact forces balance them best.
   pure subroutine balance(pieces, body, load_case, part, remainder, scale)
      integer, intent(in) :: pieces(:) !! the pieces
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      real(dp), intent(in) :: part(:, :) !! the parts of the points: normal times share (2, parts) [-]
      real(dp), allocatable, intent(out) :: remainder(:) !! what is left, piece after piece (n_free of all)
      real(dp), intent(out) :: scale !! sum of the magnitudes of what makes up the works
      real(dp), allocatable :: cone(:, :), work(:)
      integer :: first, last, k

      last = sum([(body%motions(pieces(k))%n_free, k=1, size(pieces))])
      allocate (cone(last, 3*body%zone%n_points), work(last), source=0.0_dp)
      scale = 0.0_dp
      last = 0
      do k = 1, size(pieces)
         first = last + 1
         last = last + body%motions(pieces(k))%n_free
         call add_works(cone(first:last, :), work(first:last), scale, body%motions(pieces(k)), body, load_case, part)
      end do
      allocate (remainder, source=nonnegative_remainder(cone, work))
   end subroutine balance

   !> Whether each contact point belongs to one node of its line, so that it lies on a line with its neighbors.
   pure logical function has_nodal_points(zone)
      type(contact_zone_t), intent(in) :: zone !! the contact points

      has_nodal_points = .not. any(zone%is_cell)
   end function has_nodal_points

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
      type(contact_zone_t), intent(in) :: zone !! the contact points, each of a node
      real(dp), allocatable :: normals(:, :)
      real(dp), parameter :: least_cosine = 0.8660254037844386_dp, straight = 1.0e-9_dp
      real(dp) :: before(2), after(2), tangent(2), lengths
      integer :: p, q, r

      normals = zone%normal
      do q = 1, zone%n_points
         p = zone%next(q)
         if (p == 0) cycle
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

   !> Adds the works on the free motions of a piece: those of the loads, and those of the extreme forces of the points.
   pure subroutine add_works(cone, work, scale, motions, body, load_case, part)
      real(dp), intent(inout) :: cone(:, :) !! works of the extreme forces (n_free, 3m)
      real(dp), intent(inout) :: work(:) !! works of the loads (n_free)
      real(dp), intent(inout) :: scale !! sum of the magnitudes of what makes up these works
      type(rigid_motions_t), intent(in) :: motions !! the motions of the piece that the supports leave free
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      real(dp), intent(in) :: part(:, :) !! the parts of the points: normal times share (2, parts) [-]
      real(dp) :: motion(2, motions%n_free)
      logical :: is_inside(body%mesh%n_nodes)
      integer :: i, p

      do i = 1, size(motions%node)
         associate (force => load_case%force(:, motions%node(i)))
            if (.not. any(abs(force) > 0.0_dp)) cycle
            motion = motions%displacement(body%mesh%coordinates(:, motions%node(i)))
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
               motion = motions%displacement(body%mesh%coordinates(:, zone%rows%node(i)))
               call add_point(cone(:, 3*p - 2:3*p), motion, part(:, i), merge(0.0_dp, load_case%friction(p), &
                  zone%is_tangent_fixed(p)), load_case%is_in_reach(p), &
                  load_case%slip_bound(p) > 0.0_dp .and. .not. zone%is_tangent_fixed(p))
            end do
         end do
      end associate
   end subroutine add_works

   !> Adds the works of the extreme forces of a part of a point.
   pure subroutine add_point(works, motion, part, friction, is_in_reach, is_bonded)
      real(dp), intent(inout) :: works(:, :) !! works of the three forces (n_free, 3)
      real(dp), intent(in) :: motion(:, :) !! displacement of the node of the part under each motion (2, n_free) [-]
      real(dp), intent(in) :: part(2) !! normal times share [-]
      real(dp), intent(in) :: friction !! Coulomb's coefficient, 0 where a support bears the shear [-]
      logical, intent(in) :: is_in_reach !! whether the point can close
      logical, intent(in) :: is_bonded !! whether it bears shear when it is open, too
      real(dp) :: normal(2), shear(2)

      normal = merge(part, 0.0_dp, is_in_reach)
      shear = friction*turned(normal)
      if (is_bonded) shear = turned(part)
      works(:, 1) = works(:, 1) + matmul(merge(0.0_dp, normal, is_bonded) + shear, motion)
      works(:, 2) = works(:, 2) + matmul(merge(0.0_dp, normal, is_bonded) - shear, motion)
      works(:, 3) = works(:, 3) + matmul(normal, motion)
   end subroutine add_point

   !> What is left of a vector after its best approximation by columns with factors at least 0: Lawson and Hanson's
   !> algorithm (Solving Least Squares Problems, 1974, chapter 23).
   pure function nonnegative_remainder(columns, vector) result(remainder)
      real(dp), intent(in) :: columns(:, :) !! the columns (k, n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      real(dp) :: remainder(size(vector))
      real(dp) :: unit(size(columns, 1), size(columns, 2)), gain(size(columns, 2)), factor(size(columns, 2))
      logical :: is_used(size(columns, 2))
      integer :: step, best

      do step = 1, size(columns, 2)
         unit(:, step) = columns(:, step)/max(norm2(columns(:, step)), tiny(1.0_dp))
      end do
      factor = 0.0_dp
      is_used = .false.
      remainder = vector
      do step = 1, 3*size(columns, 2)
         if (norm2(remainder) <= negligible*norm2(vector)) return
         gain = matmul(remainder, unit)
         best = maxloc(gain, dim=1, mask=.not. is_used)
         if (best == 0) return
         if (gain(best) <= negligible*norm2(remainder)) return
         is_used(best) = .true.
         call settle_factors(unit, vector, is_used, factor, remainder)
      end do
   end function nonnegative_remainder

   !> Moves the factors to the best approximation by the columns in use; a column whose factor meets zero on the way
   !> is given up, and the way goes on from there.
   pure subroutine settle_factors(columns, vector, is_used, factor, remainder)
      real(dp), intent(in) :: columns(:, :) !! the columns, of length 1 (k, n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      logical, intent(inout) :: is_used(:) !! which columns are in use (n)
      real(dp), intent(inout) :: factor(:) !! the factors, at least 0 (n)
      real(dp), intent(inout) :: remainder(:) !! what the columns leave of the vector (k)
      real(dp) :: trial(size(factor)), length

      do while (any(is_used))
         call approximate(columns, vector, is_used, trial, remainder)
         if (all(trial > 0.0_dp .or. .not. is_used)) then
            factor = trial
            return
         end if
         length = minval(factor/(factor - trial), mask=is_used .and. .not. trial > 0.0_dp)
         factor = factor + length*(trial - factor)
         is_used = is_used .and. factor > negligible*maxval(factor)
         factor = merge(factor, 0.0_dp, is_used)
      end do
      remainder = vector
   end subroutine settle_factors

   !> Approximates a vector best by the columns in use, made orthogonal one by one (Gram and Schmidt): of columns that
   !> are all but parallel, as those of a flat contact line far from the middle of the body, no digit is lost.
   pure subroutine approximate(columns, vector, is_used, factor, remainder)
      real(dp), intent(in) :: columns(:, :) !! the columns, of length 1 (k, n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      logical, intent(in) :: is_used(:) !! which columns are in use, k at the most (n)
      real(dp), intent(out) :: factor(:) !! their factors; 0 for the others (n)
      real(dp), intent(out) :: remainder(:) !! what they leave of the vector (k)
      real(dp) :: axes(size(vector), count(is_used)), share(count(is_used), count(is_used) + 1), length
      integer, allocatable :: column(:)
      integer :: i, n

      column = pack([(i, i=1, size(is_used))], is_used)
      n = size(column)
      do i = 1, n
         axes(:, i) = columns(:, column(i))
         call orthogonalize(axes(:, :i - 1), axes(:, i), share(:i - 1, i))
         length = max(norm2(axes(:, i)), tiny(1.0_dp))
         axes(:, i) = axes(:, i)/length
         share(i, i) = length
      end do
      remainder = vector
      call orthogonalize(axes, remainder, share(:, n + 1))
      factor = 0.0_dp
      do i = n, 1, -1
         factor(column(i)) = (share(i, n + 1) - dot_product(share(i, i + 1:n), factor(column(i + 1:n))))/share(i, i)
      end do
   end subroutine approximate

   !> Takes from a vector its components along orthogonal axes; what rounding leaves of them, a second time.
   pure subroutine orthogonalize(axes, vector, share)
      real(dp), intent(in) :: axes(:, :) !! the axes, of length 1 (k, n)
      real(dp), intent(inout) :: vector(:) !! the vector (k)
      real(dp), intent(out) :: share(:) !! its components (n)
      real(dp) :: along
      integer :: i, turn

      share = 0.0_dp
      do turn = 1, 2
         do i = 1, size(axes, 2)
            along = dot_product(axes(:, i), vector)
            vector = vector - along*axes(:, i)
            share(i) = share(i) + along
         end do
      end do
   end subroutine orthogonalize

end module amontons_equilibrium
