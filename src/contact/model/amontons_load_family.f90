!> A family of load cases: loads, prescribed displacements and friction in parts, each times a factor, obstacles that
!> may move, and anchors of the slips.
!>
!> A single case is the only member of a family of one part; a row of a sweep has one set of factors, a step of a
!> history those of its time. Condensed loads are linear in the factors, so that one substitution for each part serves
!> all members. The first part contains everything that no factor changes; its factor is 1.
!>
!> The motion of rigid obstacles in a load history is a shift and a turn about a pivot.
module amontons_load_family
   use amontons_assembly, only: to_unknowns
   use amontons_body, only: body_t
   use amontons_constraints, only: constraints_t, support_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_rows, only: turned
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_load_case, only: apply_loads, load_case_t, prescribe, prescribed_slip, set_obstacles
   use amontons_loads, only: load_t
   use amontons_system, only: checksum_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: acting_t, load_family_t, new_load_family, obstacle_motion_t, one_part, parting_t

   !> The motion of an obstacle: it is turned about the pivot and then shifted.
   type :: obstacle_motion_t
      real(dp) :: shift(2) = 0.0_dp !! shift along x and y [L]
      real(dp) :: turn = 0.0_dp !! angle, counterclockwise [rad]
      real(dp) :: pivot(2) = 0.0_dp !! pivot of the rotation [L]
   contains
      procedure :: displacement => obstacle_motion_displacement
      procedure :: is_at_rest => obstacle_motion_is_at_rest
   end type obstacle_motion_t

   !> The part to which each load, each prescribed displacement and the friction of each contact set belong.
   type :: parting_t
      integer :: n_parts = 1 !! number of parts
      integer, allocatable :: load(:) !! part of each load
      integer, allocatable :: support(:) !! part of what each support prescribes
      integer, allocatable :: friction(:) !! part of the friction of each contact set
      integer, allocatable :: driven(:) !! the driven motion that each of the last parts prescribes, to be locked
      logical, allocatable :: is_coefficient(:)
         !! whether the factor of a part is Coulomb's coefficient itself, in the place of the key `friction` (parts)
      logical :: moves_obstacles = .false. !! whether obstacles of members move
   end type parting_t

   !> The parts of a family, and the data that its members share.
   type :: load_family_t
      type(load_case_t) :: base !! supports, loads, contact sets, gaps and slip bounds; no nodal forces or displacements
      type(parting_t) :: parting !! the part to which each load, support and contact set belongs
      type(load_case_t), allocatable :: parts(:)
         !! nodal forces, prescribed displacements and thermal strains of each part at the factor 1 (parts)
      real(dp), allocatable, private :: nodal_force(:, :)
         !! components of its nodal forces at the nodes that any part loads (components, parts) [F]
      logical, allocatable, private :: has_force(:) !! whether it has nodal forces (parts)
      logical, allocatable, private :: has_displacement(:) !! whether it prescribes displacements (parts)
      real(dp), allocatable, private :: friction(:, :) !! friction of each part at the factor 1 (m, parts) [-]
      real(dp), allocatable, private :: prescribed(:, :) !! normal displacements that it prescribes (m, parts) [L]
      real(dp), allocatable, private :: load(:, :) !! its condensed load (n_rows, parts) [F]
      real(dp), allocatable, private :: largest(:) !! its largest prescribed displacement or expansion (parts) [L]
      real(dp), allocatable, private :: feet(:, :) !! feet of the contact points on the obstacles (2, quadrature points)
   contains
      procedure :: at_rest => load_family_at_rest
      procedure :: condense => load_family_condense
      procedure :: contacts_of => load_family_contacts_of
      procedure :: fingerprint => load_family_fingerprint
      procedure :: friction_of => load_family_friction_of
      procedure :: gap_of => load_family_gap_of
      procedure :: largest_force => load_family_largest_force
      procedure :: load_case => load_family_load_case
      procedure :: move => load_family_move
      procedure :: pose => load_family_pose
   end type load_family_t

   !> The data of a member of the family: the factors and, in a history, positions of the obstacles and anchors.
   type :: acting_t
      real(dp), allocatable :: factor(:) !! factor of each part (parts) [-]
      type(obstacle_motion_t), allocatable :: motions(:)
         !! the motion of the obstacle of each contact set; not allocated where all are at their places
      real(dp), allocatable :: gap(:) !! distance d to the obstacle where it is now, with what was worn (m) [L]
      logical, allocatable :: is_in_reach(:) !! whether the normal meets the obstacle (m)
      real(dp), allocatable :: motion(:) !! displacement of the obstacle along the tangent (n_rows - m) [L]
      real(dp), allocatable :: anchor(:) !! tangential displacements that slips are counted from (n_rows - m) [L]
   end type acting_t

contains

   !> Assigns everything to the first part.
   pure function one_part(load_case) result(parting)
      type(load_case_t), intent(in) :: load_case !! the load case
      type(parting_t) :: parting

      allocate (parting%load(size(load_case%loads)), parting%support(size(load_case%supports)), &
         parting%friction(size(load_case%contacts)), source=1)
      allocate (parting%driven(0))
      allocate (parting%is_coefficient(1), source=.false.)
   end function one_part

   !> Divides a load case into parts; the body need not be condensed.
   subroutine new_load_family(family, body, load_case, parting, error)
      type(load_family_t), intent(out) :: family !! the family
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case with all factors 1
      type(parting_t), intent(in) :: parting !! the part to which each load, support and contact set belongs
      type(error_t), allocatable, intent(out) :: error !! a load or support does not fit the mesh
      real(dp) :: prescribed(body%zone%n_rows)
      logical, allocatable :: is_loaded(:, :)
      integer :: k, p

      family%parting = parting
      family%base = load_case
      family%feet = find_feet(body%zone, load_case%contacts)
      deallocate (family%base%force, family%base%prescribed)
      if (allocated(load_case%thermal_strain)) deallocate (family%base%thermal_strain)
      allocate (family%parts(parting%n_parts))
      allocate (family%load(body%zone%n_rows, parting%n_parts), family%largest(parting%n_parts))
      allocate (family%prescribed(body%zone%n_points, parting%n_parts), family%has_force(parting%n_parts), &
         family%has_displacement(parting%n_parts))
      allocate (is_loaded, mold=body%constraints%is_free)
      is_loaded = .false.
      do k = 1, parting%n_parts
         call fill_part(family%parts(k), k, body, load_case, parting, error)
         if (allocated(error)) return
         is_loaded = is_loaded .or. abs(family%parts(k)%force) > 0.0_dp
         family%has_force(k) = any(abs(family%parts(k)%force) > 0.0_dp)
         family%has_displacement(k) = any(abs(family%parts(k)%prescribed) > 0.0_dp)
         prescribed = body%zone%rows%displacement(family%parts(k)%prescribed)
         family%prescribed(:, k) = prescribed(:body%zone%n_points)
      end do
      allocate (family%nodal_force(count(is_loaded), parting%n_parts))
      do k = 1, parting%n_parts
         family%nodal_force(:, k) = pack(family%parts(k)%force, is_loaded)
      end do
      allocate (family%friction(body%zone%n_points, parting%n_parts), source=0.0_dp)
      do p = 1, body%zone%n_points
         k = parting%friction(body%zone%set(p))
         if (parting%is_coefficient(k)) then
            family%friction(p, k) = 1.0_dp
            family%friction(p, 1) = dot_product(load_case%contacts(body%zone%set(p))%friction%slope, &
               body%zone%position(:, p))
         else
            family%friction(p, k) = load_case%friction(p)
         end if
      end do
   end subroutine new_load_family

   !> Sums the loads and the prescribed displacements of a part. If one part has a thermal strain, all have one.
   subroutine fill_part(part, number, body, load_case, parting, error)
      type(load_case_t), intent(inout) :: part !! gains nodal forces, prescribed displacements, thermal strain
      integer, intent(in) :: number !! number of the part
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case with all factors 1
      type(parting_t), intent(in) :: parting !! the part to which each load, support and contact set belongs
      type(error_t), allocatable, intent(out) :: error !! a load or support does not fit the mesh
      type(constraints_t) :: constraints
      type(support_t), allocatable :: supports(:)
      type(load_t), allocatable :: loads(:)
      integer :: i

      if (parting%n_parts == 1) then
         part%force = load_case%force
         part%driven = load_case%driven
         part%prescribed = load_case%prescribed
         if (allocated(load_case%thermal_strain)) part%thermal_strain = load_case%thermal_strain
         return
      end if
      allocate (loads(count(parting%load == number)))
      associate (places => pack([(i, i=1, size(parting%load))], parting%load == number))
         do i = 1, size(loads)
            loads(i) = load_case%loads(places(i))
         end do
      end associate
      call apply_loads(part, body, loads, error)
      if (allocated(error)) return
      if (allocated(load_case%thermal_strain) .and. .not. allocated(part%thermal_strain)) then
         part%thermal_strain = 0.0_dp*load_case%thermal_strain
      end if
      supports = load_case%supports
      do i = 1, size(supports)
         if (parting%support(i) /= number) supports(i)%displacement = 0.0_dp
      end do
      call prescribe(part, constraints, body, supports, error)
      i = number - (parting%n_parts - size(parting%driven))
      if (i > 0) part%prescribed = body%driven_field(parting%driven(i))
   end subroutine fill_part

   !> Condenses the loads of the parts, with prescribed displacements and thermal strains. For a body that is spread
   !> over ranks, all ranks that share the family call it at the same time.
   subroutine load_family_condense(self, body, problem)
      class(load_family_t), intent(inout) :: self !! the family
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      real(dp), allocatable :: forces(:, :), internal(:, :)
      real(dp) :: slip(body%zone%n_rows - body%zone%n_points), from_slip(body%zone%n_rows)
      integer :: k

      do k = 1, size(self%parts)
         associate (part => self%parts(k))
            forces = part%force
            if (any(abs(part%prescribed) > 0.0_dp) .or. allocated(part%thermal_strain)) then
               call body%internal_forces(internal, part%prescribed, part%thermal_strain)
               forces = forces - internal
            end if
            call body%condensation%condense_load(to_unknowns(forces, body%constraints, body%dof_map), part%condensed)
            self%load(:, k) = part%condensed%load
            self%largest(k) = maxval(abs(part%prescribed))
            ! Upper bound of the expansion of the body, by its highest temperature.
            if (allocated(part%thermal_strain)) self%largest(k) = max(self%largest(k), &
               maxval(abs(part%thermal_strain))*maxval(maxval(body%mesh%coordinates, dim=2) &
               - minval(body%mesh%coordinates, dim=2)))
            ! Tangential displacements include prescribed parts, as the anchors do: such a part, for example at one node
            ! of a cell, becomes a load.
            slip = prescribed_slip(body, part)
         end associate
         if (.not. any(abs(slip) > 0.0_dp)) cycle
         call problem%matrix%multiply_stiffness([0.0_dp*self%prescribed(:, k), slip], from_slip)
         self%load(:, k) = self%load(:, k) + from_slip
      end do
   end subroutine load_family_condense

   !> Sets the member whose factors are all 1, with its obstacles at their initial positions.
   pure subroutine load_family_at_rest(self, acting)
      class(load_family_t), intent(in) :: self !! the family
      class(acting_t), intent(inout) :: acting !! the member

      acting%factor = spread(1.0_dp, 1, size(self%parts))
      if (allocated(acting%motions)) deallocate (acting%motions)
      acting%gap = self%base%gap
      acting%is_in_reach = self%base%is_in_reach
      acting%motion = 0.0_dp*self%base%anchor
      acting%anchor = acting%motion
   end subroutine load_family_at_rest

   !> Moves the obstacles of a member.
   subroutine load_family_move(self, body, motions, acting, error)
      class(load_family_t), intent(in) :: self !! the family
      type(body_t), intent(in) :: body !! the body
      type(obstacle_motion_t), intent(in) :: motions(:) !! the motion of the obstacle of each contact set
      class(acting_t), intent(inout) :: acting !! the member, its obstacles at their places
      type(error_t), allocatable, intent(out) :: error !! an obstacle has moved too far into the body, or past it
      type(load_case_t) :: moved
      integer :: i, p

      if (all(motions%is_at_rest())) return
      acting%motions = motions
      call set_obstacles(moved, body%zone, body%mesh, self%contacts_of(acting), error)
      if (allocated(error)) return
      acting%gap = moved%gap
      acting%is_in_reach = moved%is_in_reach
      ! Along the tangent of each point, at its foot; for a cell the mean.
      associate (zone => body%zone, quadrature => body%zone%quadrature)
         acting%motion(:zone%n_points) = 0.0_dp
         do p = 1, zone%n_points
            do i = quadrature%start(p), quadrature%start(p + 1) - 1
               acting%motion(p) = acting%motion(p) + quadrature%share(i)*dot_product( &
                  turned(quadrature%normal(:, i)), motions(zone%set(p))%displacement(self%feet(:, i)))
            end do
         end do
      end associate
   end subroutine load_family_move

   !> The contact sets of a member, with the present positions of their obstacles.
   pure function load_family_contacts_of(self, acting) result(contacts)
      class(load_family_t), intent(in) :: self !! the family
      class(acting_t), intent(in) :: acting !! the member
      type(contact_t), allocatable :: contacts(:)
      integer :: i

      contacts = self%base%contacts
      if (.not. allocated(acting%motions)) return
      do i = 1, size(contacts)
         associate (obstacle => contacts(i)%obstacle, motion => acting%motions(i))
            obstacle%point = obstacle%point + motion%displacement(obstacle%point)
            obstacle%normal = cos(motion%turn)*obstacle%normal + sin(motion%turn)*turned(obstacle%normal)
         end associate
      end do
   end function load_family_contacts_of

   !> Sets load, gap, anchor, friction and slip bound of the body's contact problem to those of a member.
   pure subroutine load_family_pose(self, body, acting, problem)
      class(load_family_t), intent(in) :: self !! the family, condensed
      type(body_t), intent(in) :: body !! the body
      class(acting_t), intent(in) :: acting !! the member
      type(contact_problem_t), intent(inout) :: problem !! the contact problem

      problem%load = matmul(self%load, acting%factor)
      problem%prescribed = dot_product(self%largest, abs(acting%factor))
      problem%gap = self%gap_of(acting)
      problem%anchor = merge(0.0_dp, acting%anchor, body%zone%is_slip_fixed)
      associate (is_fixed => body%zone%is_shear_fixed)
         problem%friction = merge(0.0_dp, self%friction_of(acting), is_fixed)
         problem%slip_bound = merge(0.0_dp, self%base%slip_bound, is_fixed)
      end associate
   end subroutine load_family_pose

   !> Coulomb coefficients of the points in a member (m) [-].
   pure function load_family_friction_of(self, acting) result(friction)
      class(load_family_t), intent(in) :: self !! the family
      class(acting_t), intent(in) :: acting !! the member
      real(dp) :: friction(size(self%friction, 1))

      friction = matmul(self%friction, acting%factor)
   end function load_family_friction_of

   !> The gaps in a member, less the displacements that supports prescribe: d - n . u_p (m) [L].
   pure function load_family_gap_of(self, acting) result(gap)
      class(load_family_t), intent(in) :: self !! the family
      class(acting_t), intent(in) :: acting !! the member
      real(dp) :: gap(size(self%prescribed, 1))

      gap = acting%gap - matmul(self%prescribed, acting%factor)
   end function load_family_gap_of

   !> The load case of a member, condensed if the family is.
   subroutine load_family_load_case(self, body, acting, load_case)
      class(load_family_t), intent(in) :: self !! the family
      type(body_t), intent(in) :: body !! the body
      class(acting_t), intent(in) :: acting !! the member
      type(load_case_t), intent(out) :: load_case !! the load case
      type(error_t), allocatable :: error
      integer :: k

      load_case = self%base
      ! No error: the member was made with the same obstacles.
      if (allocated(acting%motions)) call set_obstacles(load_case, body%zone, body%mesh, self%contacts_of(acting), &
         error)
      load_case%extra_gap = load_case%extra_gap + (acting%gap - load_case%gap)
      load_case%gap = acting%gap
      if (size(self%parts) > 1) load_case%factor = acting%factor(self%parting%load)
      load_case%force = acting%factor(1)*self%parts(1)%force
      load_case%driven = acting%factor(1)*self%parts(1)%driven
      load_case%prescribed = acting%factor(1)*self%parts(1)%prescribed
      load_case%condensed = self%parts(1)%condensed
      if (allocated(self%parts(1)%thermal_strain)) load_case%thermal_strain = &
         acting%factor(1)*self%parts(1)%thermal_strain
      do k = 2, size(self%parts)
         load_case%driven = load_case%driven + acting%factor(k)*self%parts(k)%driven
         if (self%has_force(k)) load_case%force = load_case%force + acting%factor(k)*self%parts(k)%force
         if (self%has_displacement(k)) load_case%prescribed = load_case%prescribed &
            + acting%factor(k)*self%parts(k)%prescribed
         if (allocated(load_case%condensed%load)) call load_case%condensed%add(acting%factor(k), &
            self%parts(k)%condensed)
         if (allocated(load_case%thermal_strain)) load_case%thermal_strain = load_case%thermal_strain &
            + acting%factor(k)*self%parts(k)%thermal_strain
      end do
      load_case%free_gap = self%gap_of(acting)
      load_case%friction = self%friction_of(acting)
      load_case%anchor = acting%anchor
      load_case%obstacle_motion = acting%motion
   end subroutine load_family_load_case

   !> The largest component of the nodal forces of a member [F].
   pure real(dp) function load_family_largest_force(self, factor) result(largest)
      class(load_family_t), intent(in) :: self !! the family
      real(dp), intent(in) :: factor(:) !! factor of each part (parts) [-]

      largest = max(0.0_dp, maxval(abs(matmul(self%nodal_force, factor))))
   end function load_family_largest_force

   !> A text that is equal for two families of the same body only if they agree to the last bit: files that a deck names
   !> may have changed although the deck has not.
   pure function load_family_fingerprint(self, body, problem) result(text)
      class(load_family_t), intent(in) :: self !! the family, condensed
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      character(:), allocatable :: text
      type(checksum_t) :: checksum
      integer :: j

      if (allocated(problem%matrix%band)) then
         call checksum%add(reshape(problem%matrix%band%whole%entry, [size(problem%matrix%band%whole%entry)]))
      else
         do j = 1, problem%matrix%n
            call checksum%add(problem%matrix%stiffness%values(:, j))
         end do
      end if
      call checksum%add(reshape(body%mesh%coordinates, [size(body%mesh%coordinates)]))
      call checksum%add([self%base%gap, self%base%slip_bound])
      do j = 1, size(self%parts)
         call checksum%add([self%load(:, j), self%friction(:, j), self%prescribed(:, j), self%largest(j)])
      end do
      text = to_text(checksum%value())
   end function load_family_fingerprint

   !> Whether the obstacle is at its initial position.
   elemental logical function obstacle_motion_is_at_rest(self) result(is_at_rest)
      class(obstacle_motion_t), intent(in) :: self !! the motion

      is_at_rest = .not. (any(abs(self%shift) > 0.0_dp) .or. abs(self%turn) > 0.0_dp)
   end function obstacle_motion_is_at_rest

   !> Displacement of a point of the obstacle. 1 - cos is written as a square of a sine, so that small angles keep their
   !> digits (2) [L].
   pure function obstacle_motion_displacement(self, position) result(displacement)
      class(obstacle_motion_t), intent(in) :: self !! the motion
      real(dp), intent(in) :: position(2) !! initial position of the point [L]
      real(dp) :: displacement(2)

      associate (arm => position - self%pivot)
         displacement = self%shift + sin(self%turn)*turned(arm) - 2.0_dp*sin(0.5_dp*self%turn)**2*arm
      end associate
   end function obstacle_motion_displacement

   !> The feet of the contact points: where the normals meet the obstacles, or the points themselves where they do not
   !> (2, quadrature points) [L].
   pure function find_feet(zone, contacts) result(feet)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they were
      real(dp), allocatable :: feet(:, :)
      real(dp) :: gap, cosine
      logical :: is_met
      integer :: p, i

      associate (quadrature => zone%quadrature)
         allocate (feet, source=quadrature%position)
         do p = 1, zone%n_points
            do i = quadrature%start(p), quadrature%start(p + 1) - 1
               call contacts(zone%set(p))%obstacle%measure(quadrature%position(:, i), quadrature%normal(:, i), gap, &
                  is_met, cosine)
               if (is_met) feet(:, i) = feet(:, i) + gap*quadrature%normal(:, i)
            end do
         end do
      end associate
   end function find_feet

end module amontons_load_family
