!> Contact that slides far: rows, normals, gaps and arms are those at the moved places.
!>
!> The body is condensed to the nodes of its contact sets once, and its flexibility F there does not change. A step
!> searches for its places: at the places of an iterate the rows w = C v of the contact points are made anew, the
!> compliance A = C F C^T is gathered, and the contact problem on these rows is solved by the same methods as any other;
!> its displacements are the next places. They settle as fast as pressures are small against the modulus: the error of
!> an iterate shrinks by about this ratio, so that no derivative of the rows is needed.
!>
!> Slips are differences of the places relative to each other, in the frame of the point at the end of the step and in
!> that at its beginning: a common motion of both bodies is no slip, and nothing but places is handed over to the next
!> step when partners change.
! allow(S271): gfortran 12 fails if the modules are in order
module amontons_sliding
   use amontons_condensation, only: dependent_row, spring_share
   use amontons_body, only: body_t
   use amontons_contact_operator, only: contact_operator_t, new_stiffness_operator
   use amontons_contact_problem, only: contact_problem_t, new_contact_problem
   use amontons_contact_set, only: contact_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, new_contact_solution
   use amontons_contact_zone, only: contact_zone_t, recompute_pairs
   use amontons_dense, only: cholesky_factor, cholesky_inverse, cholesky_solve, symmetric_multiply
   use amontons_error, only: error_t, input_refused, new_error, no_equilibrium, numerical_failure
   use amontons_frame, only: turned
   use amontons_friction_law, only: open_point
   use amontons_kinds, only: dp
   use amontons_load_family, only: acting_t, load_case_t, load_family_t, out_of_reach
   use amontons_methods, only: solve_components
   use amontons_moved_zone, only: move_zone
   use amontons_pose, only: elastic_part, pose_t, stated_poses, turning_piece_t, whole_displacement
   use amontons_rounding, only: difference_rounding, exceeds
   use amontons_surface, only: meet_master, meeting_t
   use amontons_text, only: place_text, short_text
   implicit none (type, external)
   private

   public :: beginning_t, slide, take_displacement, take_places, unbalanced_share

   !> Largest number of searches for the places of a step.
   integer, parameter :: n_searches = 30

   !> Number of searches that choose which hats are slivers; later ones keep the choice, which could alternate.
   integer, parameter :: n_choices = 3

   !> Change of the places from which on they count as found, over the largest displacement by contact forces; the next
   !> one is smaller by the share that pressures are of the modulus [-].
   real(dp), parameter :: settled = 1.0e-9_dp

   !> The nodes of the contact sets at a time.
   type :: placement_t
      real(dp), allocatable :: prescribed(:, :)
         !! what supports prescribe, 0 at nodes of no contact set (components, n_nodes) [L]
      real(dp), allocatable :: v(:)
         !! displacements of the retained points beside it, in the frames of pieces that turn (retained rows) [L]
      type(pose_t), allocatable :: poses(:) !! the poses of these pieces
      real(dp), allocatable :: base(:, :) !! displacements of the nodes with v = 0 (components, n_nodes) [L]
      real(dp), allocatable :: elastic(:, :)
         !! displacements in the frames of pieces, 0 at other nodes; where pieces turn (components, n_nodes) [L]
      real(dp), allocatable :: moved(:, :) !! displacements of the nodes, 0 at others (components, n_nodes) [L]
      real(dp), allocatable :: place(:, :) !! their places (n_dim, n_nodes) [L]
   contains
      procedure :: begin => placement_begin
      procedure :: set => placement_set
   end type placement_t

   !> The rows C of the points within reach, on the displacements of the retained points.
   type :: near_rows_t
      integer, allocatable :: point(:) !! these points (near)
      integer, allocatable :: start(:) !! first entry of each row, and one beyond the last (rows + 1)
      integer, allocatable :: column(:) !! the row of the retained point (entries)
      real(dp), allocatable :: value(:) !! its coefficient (entries) [-]
      real(dp), allocatable :: base(:) !! what supports prescribe of it (rows) [L]
      logical, allocatable :: is_fixed(:) !! whether supports bear what acts along it (rows)
   contains
      procedure :: multiply => near_rows_multiply
   end type near_rows_t

   !> Where a step begins: what acted then, and the displacements and contact forces of the retained points.
   type, extends(acting_t) :: beginning_t
      real(dp), allocatable :: retained(:, :) !! as of `contact_solution_t` (retained rows, 2) [L], [F]
      real(dp), allocatable :: posed(:, :) !! as of `contact_solution_t` (6, pieces)
   end type beginning_t

   !> A search for the places of a step.
   type :: search_t
      type(placement_t) :: now !! the nodes of the contact sets
      type(near_rows_t) :: rows !! the rows of the points within reach
      real(dp), allocatable :: gap(:) !! the gaps of all points there (m) [L]
      real(dp), allocatable :: force(:) !! contact forces on the retained points (retained rows) [F]
      real(dp), allocatable :: travel(:, :) !! the motions that supports leave free, from `find_travel`
      integer, allocatable :: component(:, :)
         !! of which piece and which of its motions each of them is, 0 else (2, any)
      real(dp) :: strain = 0.0_dp !! largest displacement by contact forces, by loads without them [L]
   end type search_t

contains

   !> Finds places and contact forces of a member. What acts on the body is in the posed problem on its retained points.
   subroutine slide(body, loads, method, acting, problem, solution, error, before)
      type(body_t), intent(inout) :: body !! the body, condensed; its contact points are left at the places found
      type(load_family_t), intent(in) :: loads !! the family of loads
      class(contact_method_t), intent(in) :: method !! the contact method
      class(acting_t), intent(inout) :: acting !! the member; gains gaps and anchors at these places
      type(contact_problem_t), intent(in) :: problem !! the problem on the retained points, for its load
      type(contact_solution_t), intent(inout) :: solution !! its forces are the start; the result on return
      type(error_t), allocatable, intent(out) :: error !! contact does not hold the body, or memory ran out
      type(beginning_t), intent(in), optional :: before !! the end of the step before; at rest if absent
      type(placement_t) :: last
      type(search_t) :: search
      type(contact_solution_t) :: found
      type(contact_t), allocatable :: contacts(:)
      real(dp), allocatable :: old_frame(:, :, :), extra(:), before_search(:, :), forces(:, :)
      real(dp) :: reach
      logical :: is_near(body%zone%n_points), is_settled
      integer :: i, k, m

      m = body%zone%n_points
      allocate (search%force(body%retained%n_rows), search%gap(m), source=0.0_dp)
      last%v = search%force
      contacts = loads%base%contacts
      if (present(before)) then
         contacts = loads%contacts_of(before)
         last%v = before%retained(:, 1)
         search%force = before%retained(:, 2)
      end if
      call last%begin(body, loads, before)
      if (present(before)) last%poses = stated_poses(body%turning, before%posed)
      call last%set(body)
      call move_points(body, contacts, last, search%gap, is_near, .false.)
      old_frame = body%zone%frame
      contacts = loads%contacts_of(acting)
      extra = loads%base%extra_gap
      if (allocated(acting%added_gap)) extra = extra + acting%added_gap
      ! A point that lies farther away is near in the next search if it moved there in this one.
      reach = maxval(body%zone%weight)
      if (.not. allocated(body%zone%line)) reach = sqrt(reach)
      reach = 2.0_dp*reach
      ! The search begins with the forces of the step before.
      associate (now => search%now)
         now%poses = last%poses
         call now%begin(body, loads, acting)
         now%v = last%v
         call symmetric_multiply(body%flexibility, problem%load - search%force, now%v)
         ! Free motions are those of the step before.
         now%v = now%v + matmul(body%travel, matmul(last%v - now%v, body%travel))
         ! Without forces bodies that touch would go into each other: where they move by little they are paired before.
         if (.not. any(abs(search%force) > 0.0_dp) .and. maxval(abs(now%v - last%v)) < reach) now%v = last%v
         found = solution
         call solution%reset()
         call now%set(body)
         do i = 1, n_searches
            call find_travel(search%travel, search%component, body, now)
            before_search = now%moved
            call move_points(body, contacts, now, search%gap, is_near, i > n_choices)
            search%gap = search%gap + extra
            call set_anchors(acting, body%zone, body%mesh%coordinates, last, old_frame, before)
            call new_near_rows(search%rows, body, now, is_near .and. search%gap <= reach)
            call solve_near(found, search, body, loads, method, acting, problem, error)
            if (allocated(error)) return
            call now%set(body, may_refit=.true.)
            call found%prepend(solution)
            solution = found
            ! Places have the rounding of coordinates.
            is_settled = maxval(abs(now%moved - before_search)) <= max(settled*search%strain, &
               difference_rounding*maxval([body%size, abs(now%moved)]))
            if (.not. found%is_converged .or. is_settled) exit
         end do
         solution%is_converged = solution%is_converged .and. is_settled
         solution%displacement = body%zone%rows%displacement(now%moved)
         acting%gap = merge(search%gap + solution%displacement(:m), out_of_reach*body%size, is_near)
         acting%is_in_reach = is_near
         solution%retained = reshape([now%v, search%force], [size(now%v), 2])
         allocate (forces, mold=now%moved)
         forces = 0.0_dp
         do i = 1, body%retained%n_points
            forces(:, body%retained%node(i)) = matmul(body%retained%frame(:, :, i), &
               search%force(i::body%retained%n_points))
         end do
         call push_obstacles(solution, body, acting)
         solution%posed = reshape([([now%poses(i)%shift(:2), now%poses(i)%turn, &
            (sum(forces*body%turning(i)%unit_motion(now%poses(i), k, body%mesh%coordinates, now%elastic)), &
            k=1, 3)], i=1, size(now%poses))], [6, size(now%poses)])
      end associate
      if (solution%is_converged) call check_ends(body, contacts, solution, error)
      if (solution%is_converged .and. .not. allocated(error)) call check_passage(body, contacts, is_near, &
         maxval(abs(search%now%moved(:, body%contact_node) - last%moved(:, body%contact_node))), error)
   end subroutine slide

   !> Sums up the contact forces on the rigid obstacles, and their moments about the pivots.
   pure subroutine push_obstacles(solution, body, acting)
      type(contact_solution_t), intent(inout) :: solution !! the solution; gains the sums
      type(body_t), intent(in) :: body !! the body, its contact points at their places
      class(acting_t), intent(in) :: acting !! the member, for the motions of its obstacles
      real(dp) :: force(size(body%zone%frame, 1)), arm(2)
      integer :: p

      associate (zone => body%zone)
         if (allocated(solution%pushed)) deallocate (solution%pushed)
         allocate (solution%pushed(4, size(zone%pairs)), source=0.0_dp)
         do p = 1, zone%n_points
            if (zone%pairs(zone%set(p))%is_set()) cycle
            force = matmul(zone%frame(:, :, p), solution%force(p::zone%n_points))
            arm = zone%acting(:2, p)
            if (allocated(acting%motions)) arm = arm - acting%motions(zone%set(p))%pivot &
               - acting%motions(zone%set(p))%shift(:2)
            associate (pushed => solution%pushed(:, zone%set(p)))
               pushed(:size(force)) = pushed(:size(force)) + force
               pushed(4) = pushed(4) + dot_product(turned(arm), force(:2))
            end associate
         end do
      end associate
   end subroutine push_obstacles

   !> Refuses contact that reaches an end of a set beyond which the boundary goes on, or a corner of a master, where
   !> contact would be on both its sides.
   pure subroutine check_ends(body, contacts, solution, error)
      type(body_t), intent(in) :: body !! the body, its contact points at their places
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(contact_solution_t), intent(in) :: solution !! the solution
      type(error_t), allocatable, intent(out) :: error !! there is such a contact
      real(dp) :: forces(size(body%constraints%is_free, 1), body%mesh%n_nodes)
      integer :: i, k, set

      forces = body%zone%rows%forces(solution%force, body%mesh%n_nodes)
      do set = 1, size(contacts)
         if (.not. body%zone%pairs(set)%is_set()) cycle
         associate (pair => body%zone%pairs(set))
            do i = 1, size(pair%end_node)
               if (.not. any(abs(forces(:, pair%end_node(i))) > 0.0_dp)) cycle
               ! The end of the master matters where sides of the slave go beyond it.
               k = findloc([(any(pair%master%side(:2, pair%segments(k)%master) == pair%end_node(i)) .and. &
                  exceeds(1.0_dp, sum(pair%part(:, pair%segments(k)%slave))), k=1, size(pair%segments))], .true., dim=1)
               if (k == 0 .and. all(pair%node /= pair%end_node(i))) cycle
               call new_error(error, input_refused, contacts(set)%origin//'contact reaches the end of its set at '// &
                  'the node '//place_text(body%mesh%coordinates(:, pair%end_node(i)))//', beyond which the '// &
                  'boundary goes on: make '//pair%label//' longer there')
               return
            end do
            do i = 1, size(pair%sharp_node)
               if (.not. any(abs(forces(:, pair%sharp_node(i))) > 0.0_dp)) cycle
               call new_error(error, input_refused, contacts(set)%origin//"'"//pair%set//"' meets the corner of '"// &
                  pair%against//"' at the node "//place_text(body%mesh%coordinates(:, pair%sharp_node(i)))// &
                  ': exchange set and against, or round the corner')
               return
            end do
         end associate
      end do
   end subroutine check_ends

   !> Refuses a step in which a slave passes through its master: so far that the gaps of the search do not reach back.
   pure subroutine check_passage(body, contacts, is_near, way, error)
      type(body_t), intent(in) :: body !! the body, its contact points at their places
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      logical, intent(in) :: is_near(:) !! whether the points face what they may touch within the search (m)
      real(dp), intent(in) :: way !! largest displacement of a node of a contact set in the step [L]
      type(error_t), allocatable, intent(out) :: error !! a slave does
      type(meeting_t) :: meeting
      integer :: at(2), i, p, set

      do p = 1, size(is_near)
         set = body%zone%set(p)
         if (is_near(p) .or. .not. body%zone%pairs(set)%is_set()) cycle
         associate (pair => body%zone%pairs(set), node => body%zone%rows%node(body%zone%rows%start(p)))
            if (way <= 0.5_dp*pair%search) cycle
            at = findloc(pair%slave%side(:2, :), node)
            meeting = meet_master(pair%master, [(i, i=1, pair%master%n_sides)], pair%slave%place(at(2), &
               real(2*at(1) - 3, dp)), huge(1.0_dp))
            if (meeting%side == 0 .or. meeting%gap > -pair%search) cycle
            call new_error(error, numerical_failure, contacts(set)%origin//"'"//pair%set//"' passes through '"// &
               pair%against//"' at "//place_text(body%zone%position(:, p))//' in one step of '//short_text(way)// &
               ', since its search reaches '//short_text(pair%search)//': take shorter steps, or give a larger search')
         end associate
         return
      end do
   end subroutine check_passage

   !> Moves the contact points to the places of their nodes. Those on rigid obstacles look for them along the normals at
   !> rest, turned with their pieces.
   subroutine move_points(body, contacts, now, gap, is_near, keeps_carriers)
      type(body_t), intent(inout) :: body !! the body; its contact points are moved
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they are now
      type(placement_t), intent(in) :: now !! the places of the nodes
      real(dp), intent(out) :: gap(:) !! the gaps there, without extra gaps (m) [L]
      logical, intent(out) :: is_near(:) !! whether a point faces what it may touch (m)
      logical, intent(in) :: keeps_carriers !! whether the same points of pairs as before carry the hats
      integer :: axis, i, k, p

      associate (zone => body%zone, rest => body%zone_at_rest)
         do p = 1, merge(zone%n_points, 0, size(body%turning) > 0)
            if (zone%pairs(zone%set(p))%is_set()) cycle
            i = zone%rows%start(p)
            k = findloc([(any(body%turning(k)%node == zone%rows%node(i)), k=1, size(body%turning))], .true., dim=1)
            if (k == 0) cycle
            do axis = 1, 2
               zone%frame(:, axis, p) = now%poses(k)%rotated(rest%frame(:, axis, p), is_back=.false.)
               do i = 0, zone%rows%start(p + 1) - zone%rows%start(p) - 1
                  zone%rows%block(:, axis, zone%rows%start(p) + i) = now%poses(k)%rotated(rest%rows%block(:, axis, &
                     rest%rows%start(p) + i), is_back=.false.)
               end do
            end do
         end do
      end associate
      call move_zone(body%zone, contacts, now%place, gap, is_near, keeps_carriers)
   end subroutine move_points

   !> Puts the contact points of a body where a solution has them.
   subroutine take_places(body, loads, acting, solution)
      type(body_t), intent(inout) :: body !! the body
      type(load_family_t), intent(in) :: loads !! the family of loads
      class(acting_t), intent(in) :: acting !! the member
      type(contact_solution_t), intent(in) :: solution !! its solution
      type(placement_t) :: now
      real(dp) :: gap(body%zone%n_points)
      logical :: is_near(body%zone%n_points)

      call now%begin(body, loads, acting)
      now%poses = stated_poses(body%turning, solution%posed)
      now%v = solution%retained(:, 1)
      call now%set(body)
      call move_points(body, loads%contacts_of(acting), now, gap, is_near, .false.)
      call recompute_pairs(body%checked_rows, body%gap_change, body%zone)
   end subroutine take_places

   !> Puts the contact points of a case where its displacements have them, with the gaps and anchors there.
   subroutine take_displacement(load_case, body, displacement)
      type(load_case_t), intent(inout) :: load_case !! the load case; gains gaps and anchors
      type(body_t), intent(inout) :: body !! the body, its points at rest
      real(dp), intent(in) :: displacement(:, :) !! displacements of all nodes (components, n_nodes) [L]
      type(placement_t) :: now, rest
      type(acting_t) :: acting
      real(dp), allocatable :: frame(:, :, :), normal(:)
      real(dp) :: gap(body%zone%n_points)
      integer :: k

      frame = body%zone%frame
      rest%place = body%mesh%coordinates
      rest%moved = 0.0_dp*displacement
      now%place = rest%place + displacement(:size(rest%place, 1), :)
      now%poses = [(body%turning(k)%pose(rest%place, displacement, 0.0_dp), k=1, size(body%turning))]
      call move_points(body, load_case%contacts, now, gap, load_case%is_in_reach, .false.)
      call recompute_pairs(body%checked_rows, body%gap_change, body%zone)
      acting%anchor = load_case%anchor
      acting%motion = load_case%obstacle_motion
      call set_anchors(acting, body%zone, body%mesh%coordinates, rest, frame)
      load_case%anchor = acting%anchor
      load_case%obstacle_motion = acting%motion
      normal = body%zone%rows%displacement(displacement)
      load_case%gap = merge(gap + load_case%extra_gap + normal(:size(gap)), out_of_reach*body%size, &
         load_case%is_in_reach)
      load_case%free_gap = load_case%gap
      load_case%cosine = 1.0_dp
   end subroutine take_displacement

   !> What contact forces and displacements of the retained points leave of the load, |q - S v - f|, over these [-].
   pure real(dp) function unbalanced_share(problem, solution) result(share)
      type(contact_problem_t), intent(in) :: problem !! the problem on the retained points, posed
      type(contact_solution_t), intent(in) :: solution !! the solution
      real(dp) :: strained(problem%matrix%n)

      call problem%matrix%multiply_stiffness(solution%retained(:, 1), strained)
      associate (q => problem%load, f => solution%retained(:, 2))
         share = maxval(abs(q - strained - f))/max(tiny(1.0_dp), maxval(abs(q)), maxval(abs(f)))
      end associate
   end function unbalanced_share

   !> Sets what supports prescribe: displacements of the nodes of the contact sets, and motions of rigid sets that turn.
   !> Tangential displacements of retained points include it.
   pure subroutine placement_begin(self, body, loads, acting)
      class(placement_t), intent(inout) :: self !! the nodes; poses are kept as far as they are not prescribed
      type(body_t), intent(in) :: body !! the body
      type(load_family_t), intent(in) :: loads !! the family of loads
      class(acting_t), intent(in), optional :: acting !! the member; nothing is prescribed if it is absent
      real(dp) :: value(3)
      integer :: axis, i, k

      allocate (self%prescribed(size(body%constraints%is_free, 1), body%mesh%n_nodes), source=0.0_dp)
      self%base = self%prescribed
      self%moved = self%prescribed
      self%place = body%mesh%coordinates
      if (.not. allocated(self%poses)) then
         allocate (self%poses(size(body%turning)))
         do k = 1, size(self%poses)
            self%poses(k)%pivot = body%turning(k)%point
         end do
      end if
      if (.not. present(acting)) return
      do k = 1, count(body%turning%rigid > 0)
         value = [(dot_product(acting%factor, [(loads%parts(i)%posed(axis, k), i=1, size(loads%parts))]), axis=1, 3)]
         associate (pose => self%poses(k), is_held => body%turning(k)%is_held)
            pose%shift(:2) = merge(value(:2), pose%shift(:2), is_held(:2))
            pose%turn = merge(value(3), pose%turn, is_held(3))
         end associate
      end do
      do i = 1, size(body%contact_node)
         associate (node => body%contact_node(i))
            do k = 1, size(loads%parts)
               self%prescribed(:, node) = self%prescribed(:, node) + acting%factor(k)*loads%parts(k)%prescribed(:, node)
            end do
         end associate
      end do
      do i = 1, body%retained%n_points
         associate (frame => body%retained%frame(:, 2:, i), base => self%prescribed(:, body%retained%node(i)), &
            is_fixed => body%retained%is_fixed(:, i))
            base = base - matmul(frame, merge(0.0_dp, matmul(base, frame), is_fixed))
         end associate
      end do
   end subroutine placement_begin

   !> Sets displacements and places from poses and the displacements of the retained points.
   pure subroutine placement_set(self, body, may_refit)
      class(placement_t), intent(inout) :: self !! the nodes
      type(body_t), intent(in) :: body !! the body
      logical, intent(in), optional :: may_refit
         !! whether pieces without a rigid set get the poses of their places anew, which leave no rigid part in v
      integer :: i, k

      associate (retained => body%retained, x => body%mesh%coordinates)
         if (size(body%turning) > 0) self%moved = self%prescribed
         self%moved(:, body%contact_node) = self%prescribed(:, body%contact_node)
         do i = 1, retained%n_points
            associate (node => retained%node(i))
               self%moved(:, node) = self%moved(:, node) + matmul(retained%frame(:, :, i), self%v(i::retained%n_points))
            end associate
         end do
         self%base(:, body%contact_node) = self%prescribed(:, body%contact_node)
         if (size(body%turning) > 0) then
            self%elastic = self%moved
            self%moved = whole_displacement(body%turning, self%poses, x, self%elastic)
            if (present(may_refit)) then
               do k = 1, size(self%poses)
                  if (body%turning(k)%rigid == 0) self%poses(k) = body%turning(k)%pose(x, self%moved, &
                     self%poses(k)%turn)
               end do
               self%elastic = elastic_part(body%turning, self%poses, x, self%moved)
               do i = 1, retained%n_points
                  associate (node => retained%node(i))
                     self%v(i::retained%n_points) = matmul(self%elastic(:, node) - self%prescribed(:, node), &
                        retained%frame(:, :, i))
                  end associate
               end do
            end if
            self%base = whole_displacement(body%turning, self%poses, x, self%prescribed)
         end if
         self%place(:, body%contact_node) = x(:, body%contact_node) + self%moved(:size(x, 1), body%contact_node)
      end associate
   end subroutine placement_set

   !> Finds the motions that supports leave free: those of pieces that turn little, and shifts along x and y and turns
   !> about their points of those that turn far, in the frame of the piece.
   pure subroutine find_travel(travel, component, body, now)
      real(dp), allocatable, intent(out) :: travel(:, :)
         !! displacements of the retained points (retained rows, any) [-]
      integer, allocatable, intent(out) :: component(:, :)
         !! of which piece that turns and which of its motions each of them is; 0 for the others (2, any)
      type(body_t), intent(in) :: body !! the body
      type(placement_t), intent(in) :: now !! the poses
      real(dp) :: field(size(body%constraints%is_free, 1), body%mesh%n_nodes), column(size(body%travel, 1))
      integer :: axis, i, k

      if (size(body%turning) == 0) then
         travel = body%travel
         allocate (component(2, size(travel, 2)), source=0)
         return
      end if
      allocate (component(2, 0), travel(size(body%travel, 1), 0))
      associate (retained => body%retained)
         do i = 1, size(body%travel, 2)
            if (any([(maxval(abs(body%travel(:, i)), mask=is_of(body%turning(k))) > 0.0_dp, &
               k=1, size(body%turning))])) cycle
            travel = reshape([travel, body%travel(:, i)], [size(column), size(travel, 2) + 1])
            component = reshape([component, 0, 0], shape(component) + [0, 1])
         end do
         do k = 1, size(body%turning)
            do axis = 1, 3
               if (body%turning(k)%is_held(axis)) cycle
               field = body%turning(k)%unit_motion(now%poses(k), axis, body%mesh%coordinates, now%elastic)
               do i = 1, retained%n_points
                  column(i::retained%n_points) = matmul(field(:, retained%node(i)), retained%frame(:, :, i))
               end do
               travel = reshape([travel, column], [size(column), size(travel, 2) + 1])
               component = reshape([component, k, axis], shape(component) + [0, 1])
            end do
         end do
      end associate

   contains

      !> Which retained rows are of a piece.
      pure function is_of(piece)
         type(turning_piece_t), intent(in) :: piece !! the piece
         logical :: is_of(size(body%travel, 1)), is_here(body%mesh%n_nodes)

         is_here = .false.
         is_here(piece%node) = .true.
         is_of = [spread(is_here(body%retained%node), 2, 1 + body%retained%n_tangents)]
      end function is_of

   end subroutine find_travel

   !> Sets the tangential displacements that slips count from: relative places at the beginning of the step, each along
   !> the tangents there, so that a common motion is no slip; and the ways of rigid obstacles since rest.
   pure subroutine set_anchors(acting, zone, coordinates, last, old_frame, begin)
      class(acting_t), intent(inout) :: acting !! the member; gains both
      type(contact_zone_t), intent(in) :: zone !! the contact points at their present places
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      type(placement_t), intent(in) :: last !! the nodes at the beginning of the step
      real(dp), intent(in) :: old_frame(:, :, :) !! the frames of the points there (n_dim, n_dim, m) [-]
      type(beginning_t), intent(in), optional :: begin !! what acted then; nothing if it is absent
      real(dp), dimension(size(coordinates, 1)) :: origin, way, anchor, motion
      type(pose_t) :: moved, before
      integer :: i, k, p

      do p = 1, zone%n_points
         anchor = 0.0_dp
         motion = 0.0_dp
         if (.not. zone%pairs(zone%set(p))%is_set()) then
            before = pose_t()
            if (present(begin)) then
               if (allocated(begin%motions)) before = begin%motions(zone%set(p))
            end if
            moved = pose_t()
            if (allocated(acting%motions)) moved = acting%motions(zone%set(p))
         end if
         do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
            associate (node => zone%rows%node(i), block => zone%rows%block(:, :, i))
               if (zone%pairs(zone%set(p))%is_set()) then
                  anchor = anchor + dot_product(block(:, 1), zone%frame(:, 1, p)) &
                     *matmul(last%place(:, node), old_frame(:, :, p)) - matmul(coordinates(:, node), block)
               else
                  ! Where the place of the obstacle that the point met was at rest.
                  origin = before%origin(last%place(:, node))
                  motion = motion + matmul(moved%displacement(origin), block)
                  way = moved%displacement(origin) - before%displacement(origin)
                  anchor = anchor + matmul(last%moved(:, node) + way, block)
               end if
            end associate
         end do
         do k = 1, zone%n_tangents
            acting%anchor(p + (k - 1)*zone%n_points) = merge(0.0_dp, anchor(1 + k), zone%is_fixed(k, p))
            acting%motion(p + (k - 1)*zone%n_points) = motion(1 + k)
         end do
      end do
   end subroutine set_anchors

   !> Makes the rows of some of the points on the displacements of the retained points.
   pure subroutine new_near_rows(rows, body, now, is_near)
      type(near_rows_t), intent(out) :: rows !! the rows
      type(body_t), intent(in) :: body !! the body
      type(placement_t), intent(in) :: now !! the nodes, for what supports prescribe
      logical, intent(in) :: is_near(:) !! the points (m)
      real(dp) :: row(size(body%zone%frame, 1))
      integer, dimension(body%mesh%n_nodes) :: retained_of, piece_of
      integer :: n, near, r, i, j, k, p

      associate (zone => body%zone, retained => body%retained)
         retained_of(body%contact_node) = 0
         piece_of(body%contact_node) = 0
         do k = 1, size(body%turning)
            piece_of(body%turning(k)%node) = k
         end do
         retained_of(retained%node) = [(i, i=1, retained%n_points)]
         rows%point = pack([(p, p=1, zone%n_points)], is_near)
         near = size(rows%point)
         allocate (rows%start((1 + zone%n_tangents)*near + 1), source=1)
         allocate (rows%base(size(rows%start) - 1), source=0.0_dp)
         allocate (rows%is_fixed(size(rows%base)), source=.false.)
         n = size(zone%frame, 1)*(1 + zone%n_tangents)*sum(zone%rows%start(rows%point + 1) &
            - zone%rows%start(rows%point))
         allocate (rows%column(n), rows%value(n))
         n = 0
         do k = 1, 1 + zone%n_tangents
            do r = 1, near
               p = rows%point(r)
               do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
                  associate (node => zone%rows%node(i), at => r + (k - 1)*near)
                     row = zone%rows%block(:, k, i)
                     rows%base(at) = rows%base(at) + dot_product(row, now%base(:, node))
                     if (retained_of(node) == 0) cycle
                     if (piece_of(node) > 0) row = now%poses(piece_of(node))%rotated(row, is_back=.true.)
                     do j = 0, retained%n_tangents
                        if (j > 0) then
                           if (retained%is_fixed(j, retained_of(node))) cycle
                        end if
                        n = n + 1
                        rows%column(n) = retained_of(node) + j*retained%n_points
                        rows%value(n) = dot_product(row, retained%frame(:, j + 1, retained_of(node)))
                     end do
                  end associate
               end do
               associate (at => r + (k - 1)*near)
                  rows%start(at + 1) = n + 1
                  rows%is_fixed(at) = .not. any(abs(rows%value(rows%start(at):n)) > 0.0_dp)
                  if (k > 1) rows%is_fixed(at) = rows%is_fixed(at) .or. zone%is_fixed(k - 1, p)
               end associate
            end do
         end do
      end associate
   end subroutine new_near_rows

   !> C v (rows) [L].
   pure function near_rows_multiply(self, v) result(product)
      class(near_rows_t), intent(in) :: self !! the rows
      real(dp), intent(in) :: v(:) !! displacements of the retained points (retained rows) [L]
      real(dp) :: product(size(self%base))
      integer :: r

      do r = 1, size(product)
         associate (first => self%start(r), last => self%start(r + 1) - 1)
            product(r) = dot_product(self%value(first:last), v(self%column(first:last)))
         end associate
      end do
   end function near_rows_multiply

   !> Factorizes the compliance of rows. Where they depend on each other, as at a corner between two obstacles, springs
   !> between body and multipliers make it definite, as in `new_row_condensation`.
   pure subroutine factorize_compliance(matrix, soft, info)
      real(dp), allocatable, intent(inout) :: matrix(:, :) !! A (r, r); its Cholesky factor on return [L/F]
      real(dp), allocatable, intent(out) :: soft(:) !! compliance of the springs, 0 without (r) [L/F]
      integer, intent(out) :: info !! 0 unless it is not definite
      real(dp), allocatable :: original(:, :)
      integer :: i

      soft = [(matrix(i, i), i=1, size(matrix, 1))]
      original = matrix
      call cholesky_factor(matrix, info)
      if (info == 0) info = findloc([(matrix(i, i)**2 <= dependent_row*soft(i), i=1, size(soft))], .true., dim=1)
      soft = merge(spring_share, 0.0_dp, info /= 0)*soft
      if (info == 0) return
      call move_alloc(original, matrix)
      do i = 1, size(soft)
         matrix(i, i) = matrix(i, i) + soft(i)
      end do
      call cholesky_factor(matrix, info)
   end subroutine factorize_compliance

   !> The forces along the motions that supports leave free: those of the loads, and those given to rigid sets that turn
   !> (motions) [F], [F L].
   pure function given_force(search, body, loads, acting, problem) result(given)
      type(search_t), intent(in) :: search !! the search, for its motions
      type(body_t), intent(in) :: body !! the body
      type(load_family_t), intent(in) :: loads !! the family of loads
      class(acting_t), intent(in) :: acting !! the member
      type(contact_problem_t), intent(in) :: problem !! the problem on the retained points, for its load
      real(dp), allocatable :: given(:)
      integer :: i, k

      given = matmul(problem%load, search%travel)
      do k = 1, size(given)
         if (.not. is_of_set(search, body, k)) cycle
         associate (driven => body%turning(search%component(1, k))%driven(search%component(2, k)))
            given(k) = dot_product(acting%factor, [(loads%parts(i)%driven(driven), i=1, size(loads%parts))])
         end associate
      end do
   end function given_force

   !> Whether a motion is that of a rigid set that turns.
   pure logical function is_of_set(search, body, motion)
      type(search_t), intent(in) :: search !! the search
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: motion !! the motion

      is_of_set = search%component(1, motion) > 0
      if (is_of_set) is_of_set = body%turning(search%component(1, motion))%rigid > 0
   end function is_of_set

   !> Sets the displacements of the retained points, and poses: in the frame of its piece a rigid set is at rest.
   pure subroutine take_motions(search, body, strained, amounts)
      type(search_t), intent(inout) :: search !! the search; gains displacements and poses
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: strained(:) !! displacements of the retained points without free motions [L]
      real(dp), intent(in) :: amounts(:) !! amounts of the free motions (motions) [L], [rad]
      integer :: k

      search%now%v = strained
      do k = 1, size(amounts)
         if (is_of_set(search, body, k)) then
            associate (pose => search%now%poses(search%component(1, k)), axis => search%component(2, k))
               if (axis < 3) pose%shift(axis) = pose%shift(axis) + amounts(k)
               if (axis == 3) pose%turn = pose%turn + amounts(k)
            end associate
         else
            search%now%v = search%now%v + amounts(k)*search%travel(:, k)
         end if
      end do
   end subroutine take_motions

   !> Solves the contact problem of the near points at their present places.
   !>
   !> Displacements are w = C (F (q - C^T lambda) + R b), with the free motions R of the body and R^T q = (C R)^T
   !> lambda. So S w = p - lambda with S = (1 - N) A^-1, p = S C F q + A^-1 G H^-1 R^T q, where A = C F C^T, G = C R,
   !> H = G^T A^-1 G and N = A^-1 G H^-1 G^T; and b = H^-1 (R^T q + G^T A^-1 (w - C F q)).
   subroutine solve_near(found, search, body, loads, method, acting, problem, error)
      type(contact_solution_t), intent(inout) :: found !! the forces of all points to start from; the result on return
      type(search_t), intent(inout) :: search !! rows and gaps; gains displacements and forces of the retained points
      type(body_t), intent(in) :: body !! the body
      type(load_family_t), intent(in) :: loads !! the family of loads
      class(contact_method_t), intent(in) :: method !! the contact method
      class(acting_t), intent(in) :: acting !! the member, with its anchors
      type(contact_problem_t), intent(in) :: problem !! the problem on the retained points, for its load
      type(error_t), allocatable, intent(out) :: error !! contact does not hold the body, or memory ran out
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: small
      type(contact_solution_t) :: near
      real(dp), allocatable :: flexible(:, :), stiffness(:, :), g(:, :), x(:, :), h(:, :), soft(:), &
         free(:), w_free(:), w(:), v(:), b(:), motion(:)
      integer, allocatable :: places(:)
      integer :: i, k, m, n, r, info

      associate (rows => search%rows, force => search%force, travel => search%travel)
         m = size(search%gap)
         n = size(rows%point)
         r = size(rows%base)
         allocate (flexible(size(force), r), stiffness(r, r), free(size(force)), g(r, size(travel, 2)))
         call symmetric_multiply(body%flexibility, problem%load, free)
         motion = given_force(search, body, loads, acting, problem)
         do i = 1, r
            flexible(:, i) = 0.0_dp
            do k = rows%start(i), rows%start(i + 1) - 1
               flexible(:, i) = flexible(:, i) + rows%value(k)*body%flexibility(:, rows%column(k))
            end do
         end do
         do i = 1, r
            stiffness(:, i) = rows%multiply(flexible(:, i))
         end do
         do k = 1, size(g, 2)
            g(:, k) = merge(0.0_dp, rows%multiply(travel(:, k)), rows%is_fixed)
         end do
         w_free = merge(0.0_dp, rows%multiply(free), rows%is_fixed)
         w = merge(0.0_dp, rows%multiply(search%now%v), rows%is_fixed)
         ! Where supports bear what acts along a row, it has a spring of its own that nothing loads.
         do i = 1, r
            if (.not. rows%is_fixed(i)) cycle
            flexible(:, i) = 0.0_dp
            stiffness(:, i) = 0.0_dp
            stiffness(i, :) = 0.0_dp
            stiffness(i, i) = stiffness(1 + modulo(i - 1, n), 1 + modulo(i - 1, n))
            if (.not. stiffness(i, i) > 0.0_dp) stiffness(i, i) = 1.0_dp
         end do
         call factorize_compliance(stiffness, soft, info)
         x = g
         if (info == 0) call cholesky_solve(stiffness, x)
         h = matmul(transpose(g), x)
         if (info == 0) call cholesky_factor(h, info)
         if (info /= 0) then
            call new_error(error, no_equilibrium, 'the contact points that are near what they may touch do not '// &
               'hold the body; let it begin closer, or hold it by supports')
            return
         end if
         call cholesky_inverse(stiffness)
         b = motion
         call cholesky_solve(h, b)
         g = transpose(x)
         call cholesky_solve(h, g)
         stiffness = stiffness - matmul(x, g)
         call new_contact_solution(near, n, body%zone%n_tangents)
         near%residual = 0.0_dp
         near%is_converged = .true.
         places = [(rows%point + k*m, k=0, body%zone%n_tangents)]
         if (n > 0) then
            near%displacement = w
            near%force = found%force(places)
            near%status = found%status(rows%point)
            v = matmul(stiffness, w_free) + matmul(motion, g)
            call new_stiffness_operator(matrix, stiffness, size(travel, 2) == 0, body%zone%n_tangents)
            call new_contact_problem(small, matrix)
            small%load = v
            small%gap = search%gap(rows%point) + w(:n)
            small%anchor = merge(0.0_dp, acting%anchor(places(n + 1:) - m) - rows%base(n + 1:), rows%is_fixed(n + 1:))
            v = loads%friction_of(acting)
            small%friction = v(rows%point)
            small%slip_bound = [(bound_at(rows%point(i)), i=1, n)]
            small%uncanceled = problem%uncanceled
            if (any(soft > 0.0_dp)) small%softness = soft
            call near%reset()
            call solve_components(method, small, near, error)
            if (allocated(error)) return
         end if
         v = matmul(flexible, near%force)
         search%strain = maxval(abs(v))
         if (.not. search%strain > 0.0_dp) search%strain = maxval(abs(free))
         b = b + matmul(g, near%displacement - soft*near%force - w_free)
         call take_motions(search, body, free - v, b)
         search%force = 0.0_dp
         do i = 1, r
            if (rows%is_fixed(i)) cycle
            do k = rows%start(i), rows%start(i + 1) - 1
               force(rows%column(k)) = force(rows%column(k)) + rows%value(k)*near%force(i)
            end do
         end do
         found%force = 0.0_dp
         found%force(places) = near%force
         found%status = open_point
         found%status(rows%point) = near%status
         call move_alloc(found%force, near%force)
         call move_alloc(found%status, near%status)
         near%displacement = 0.0_dp*near%force
         found = near
      end associate

   contains

      !> The given slip bound of a point at its present area [F].
      pure real(dp) function bound_at(point) result(bound)
         integer, intent(in) :: point !! the point
         integer :: q

         bound = 0.0_dp
         associate (quadrature => body%zone%quadrature)
            do q = quadrature%start(point), quadrature%start(point + 1) - 1
               bound = bound + quadrature%share(q)*body%zone%area(point) &
                  *loads%base%contacts(body%zone%set(point))%slip_bound%at(body%zone%position(:, point), &
                  quadrature%arc_length(q))
            end do
         end associate
      end function bound_at

   end subroutine solve_near

end module amontons_sliding
