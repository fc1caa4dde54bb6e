!> What acts on a body: a load case, which is one case, one step or one row of a sweep, and a family of load cases:
!> loads, prescribed displacements and friction in parts, each times a factor, obstacles that may move, and anchors of
!> the slips. The body itself never changes, but for the places of contact points that slide far.
!>
!> A single case is the only member of a family of one part; a row of a sweep has one set of factors, a step of a
!> history those of its time. Condensed loads are linear in the factors, so that one substitution for each part serves
!> all members. The first part contains everything that no factor changes; its factor is 1.
!>
!> The motion of rigid obstacles in a load history is a shift and a turn about a pivot.
module amontons_load_family
   use amontons_assembly, only: from_unknowns, to_unknowns
   use amontons_body, only: body_t
   use amontons_condensation, only: condensed_load_t
   use amontons_constraints, only: constraints_t, negligible, new_constraints, support_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t, input_refused, new_error, no_equilibrium
   use amontons_frame, only: new_frame, turned
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t, load_vector, spread_total_force, sum_element_loads
   use amontons_material, only: on_axis
   use amontons_mesh, only: mesh_t
   use amontons_obstacle, only: steepest_cosine
   use amontons_pose, only: pose_t
   use amontons_rounding, only: exceeds, sum_rounding
   use amontons_text, only: place_text, short_text, to_text
   implicit none (type, external)
   private

   public :: acting_t, add_part, check_shear, condensed_force, load_case_t, load_family_t, new_load_case, &
      new_load_family, one_part, out_of_reach, parting_t, recover_displacement, &
      recover_displacements, set_obstacles

   !> Gap of a point that faces nothing, over the body's size [-].
   real(dp), parameter :: out_of_reach = 1.0e3_dp

   !> Loads, prescribed displacements, obstacles and friction of one case.
   type :: load_case_t
      type(support_t), allocatable :: supports(:) !! the supports, with what they prescribe
      type(load_t), allocatable :: loads(:) !! the loads
      real(dp), allocatable :: factor(:)
         !! factor of each load in a sweep or a load history; not allocated if all are 1 (loads) [-]
      type(contact_t), allocatable :: contacts(:) !! the contact sets, with their obstacles
      real(dp), allocatable :: force(:, :) !! nodal forces of the loads (components, n_nodes) [F]
      real(dp) :: uncanceled(2) = 0.0_dp
         !! sum of the norms of the nodal forces of each load, and norm of those that would prevent thermal expansion;
         !! what is left where they cancel has the rounding errors of these [F]
      real(dp), allocatable :: driven(:) !! forces that loads give the driven motions of the body (motions) [F, F L]
      real(dp), allocatable :: posed(:, :)
         !! shift and turn that supports prescribe of the pieces that turn with a rigid set (3, any) [L], [rad]
      real(dp), allocatable :: prescribed(:, :)
         !! displacements that the supports prescribe, with what follows of them for slaves (components, n_nodes) [L]
      real(dp), allocatable :: element_load(:)
         !! what acts inside the elements, from `sum_element_loads`; not allocated where nothing does [-], [L]
      real(dp), allocatable :: gap(:) !! initial distance d to the obstacle along the normal (m) [L]
      real(dp), allocatable :: extra_gap(:)
         !! part of the gap added by the deck, wear or the caller of a stepper (m) [L]
      real(dp), allocatable :: free_gap(:)
         !! the gap less the displacements that supports prescribe: d - n . u_p (m) [L]
      real(dp), allocatable :: anchor(:)
         !! displacement along the tangent that slips are counted from; 0 but in a load history (n_rows - m) [L]
      real(dp), allocatable :: obstacle_motion(:)
         !! way of the obstacle along the tangent since rest; 0 but in a load history (n_rows - m) [L]
      real(dp) :: carried_force = 0.0_dp
         !! largest sum of the points' normal and tangential forces in the load history so far; 0 without one [F]
      logical, allocatable :: is_in_reach(:) !! whether the normal meets the obstacle, so that the point can close (m)
      real(dp), allocatable :: cosine(:) !! of the angle between the normal and the way into the obstacle (m) [-]
      real(dp), allocatable :: depth(:) !! depth in the obstacle of a point out of reach, 0 for the others (m) [L]
      real(dp), allocatable :: foot(:, :)
         !! where normals of quadrature points meet rigid obstacles, elsewhere these points (n_dim, points) [L]
      logical, allocatable :: lies_outside(:)
         !! which nodes of the free boundary lie outside what they face, from `new_load_case` (free nodes)
      real(dp), allocatable :: friction(:)
         !! Coulomb coefficient phi of the forces, that of the stresses where both act on the same area (m) [-]
      real(dp), allocatable :: slip_bound(:) !! given bound g of the tangential force (m) [F]
      type(condensed_load_t) :: condensed !! the condensed load, where its family is condensed
   end type load_case_t

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
      real(dp), allocatable, private :: uncanceled(:, :) !! its sizes of what cancels in the loads (2, parts) [F]
      logical, allocatable, private :: has_force(:) !! whether it has nodal forces (parts)
      logical, allocatable, private :: has_displacement(:) !! whether it prescribes displacements (parts)
      real(dp), allocatable, private :: friction(:, :) !! friction of each part at the factor 1 (m, parts) [-]
      real(dp), allocatable, private :: prescribed(:, :)
         !! normal displacements that it prescribes; 0 where points slide far, as theirs include them (m, parts) [L]
      real(dp), allocatable, private :: load(:, :) !! its condensed load (n_rows, parts) [F]
      real(dp), allocatable, private :: largest(:) !! its largest prescribed displacement or expansion (parts) [L]
   contains
      procedure :: at_rest => load_family_at_rest
      procedure :: check_held_nodes => load_family_check_held_nodes
      procedure :: condense => load_family_condense
      procedure :: contacts_of => load_family_contacts_of
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
      type(pose_t), allocatable :: motions(:)
         !! the motion of the obstacle of each contact set; not allocated where all are at their places
      real(dp), allocatable :: gap(:) !! distance d to the obstacle where it is now, with what was worn (m) [L]
      logical, allocatable :: is_in_reach(:) !! whether the normal meets the obstacle (m)
      real(dp), allocatable :: motion(:) !! displacement of the obstacle along the tangent (n_rows - m) [L]
      real(dp), allocatable :: anchor(:) !! tangential displacements that slips are counted from (n_rows - m) [L]
      real(dp), allocatable :: added_gap(:)
         !! addition to the gaps, given by the caller of a step; after the step with the wear before it; not allocated
         !! without (m) [L]
   end type acting_t

contains

   !> Makes a load case and checks its input; whether it has an equilibrium is checked by `check_balance`.
   subroutine new_load_case(load_case, body, supports, contacts, loads, error)
      type(load_case_t), intent(out) :: load_case !! the load case, not condensed yet
      type(body_t), intent(inout) :: body !! the body; contact points that slide far are put where they are at rest
      type(support_t), intent(in) :: supports(:)
         !! the supports that the body was made with; their prescribed displacements may be others
      type(contact_t), intent(in) :: contacts(:)
         !! the contact sets that the body was made with; their obstacles, gaps and friction may be others
      type(load_t), intent(in) :: loads(:) !! the loads
      type(error_t), allocatable, intent(out) :: error !! supports, contacts or loads do not fit the body
      type(constraints_t) :: constraints
      real(dp) :: prescribed(body%zone%n_rows)
      integer :: i

      if (body%slides_far) body%zone = body%zone_at_rest
      call check_shear(body%zone, contacts, error)
      if (allocated(error)) return
      load_case%supports = supports
      load_case%loads = loads
      call prescribe(load_case, constraints, body, supports, error)
      if (allocated(error)) return
      if (any(constraints%is_free .neqv. body%constraints%is_free)) then
         call new_error(error, input_refused, &
            'the supports of a load case hold other components than those of its body')
         return
      end if
      if (any(abs(load_case%prescribed(1, :)) > 0.0_dp .and. on_axis(body%mesh, body%materials))) then
         call new_error(error, input_refused, 'a support moves nodes on the axis of revolution away from it: their '// &
            'radial displacement can be 0 only')
         return
      end if
      call set_obstacles(load_case, body%zone, body%mesh, contacts, error)
      if (allocated(error)) return
      load_case%lies_outside = body%free_boundary%lies_outside(contacts, body%mesh%coordinates, body%zone, &
         load_case%gap)
      prescribed = body%zone%rows%displacement(load_case%prescribed)
      load_case%free_gap = load_case%gap - prescribed(:body%zone%n_points)
      do i = 1, size(loads)
         call spread_total_force(load_case%loads(i), body%mesh, body%materials, error)
         if (.not. allocated(error)) cycle
         error%message = loads(i)%origin//error%message
         return
      end do
      call apply_loads(load_case, body, load_case%loads, error)
      if (.not. allocated(error)) call let_turn(body, load_case, error)
   end subroutine new_load_case

   !> Lets pieces that no nodal forces act on turn far: such forces would keep their directions. Forces and moments of
   !> rigid sets do.
   pure subroutine let_turn(body, load_case, error)
      type(body_t), intent(inout) :: body !! the body; gains the pieces that turn
      type(load_case_t), intent(in) :: load_case !! the loads
      type(error_t), allocatable, intent(out) :: error !! forces act on a piece that has a rigid set
      integer :: k

      if (allocated(body%turning)) deallocate (body%turning)
      allocate (body%turning(0))
      do k = 1, size(body%may_turn)
         associate (piece => body%may_turn(k))
            if (.not. any(abs(load_case%force(:, piece%node)) > 0.0_dp)) then
               body%turning = [body%turning, piece]
            else if (piece%rigid > 0) then
               associate (set => load_case%supports(body%driven(piece%driven(1))%support))
                  call new_error(error, input_refused, set%origin//"sliding = 'finite': loads act on the body of '"// &
                     set%name//"', which may turn far; give their force and moment to this rigid set")
               end associate
               return
            end if
         end associate
      end do
   end subroutine let_turn

   !> Sets the displacements that supports prescribe, with those that follow from them by substitution.
   subroutine prescribe(load_case, constraints, body, supports, error)
      type(load_case_t), intent(inout) :: load_case !! gains the displacements
      type(constraints_t), intent(out) :: constraints !! the components that supports hold
      type(body_t), intent(in) :: body !! the body
      type(support_t), intent(in) :: supports(:) !! the supports
      type(error_t), allocatable, intent(out) :: error !! the supports do not fit the mesh
      integer :: i, k

      call new_constraints(constraints, load_case%prescribed, body%mesh, supports, error, body%materials)
      if (allocated(error)) return
      ! A rigid set that turns far is at rest in the frame of its piece.
      allocate (load_case%posed(3, count(body%may_turn%rigid > 0)))
      do k = 1, size(load_case%posed, 2)
         associate (piece => body%may_turn(k), rigid => constraints%rigid(body%may_turn(k)%rigid))
            do i = 1, 3
               associate (value => load_case%prescribed(rigid%axis(i), rigid%lead(i)), &
                  is_free => constraints%is_free(rigid%axis(i), rigid%lead(i)))
                  load_case%posed(i, k) = value/merge(rigid%length, 1.0_dp, i == 3)
                  value = 0.0_dp
                  is_free = is_free .eqv. piece%is_held(i)
               end associate
            end do
         end associate
      end do
      do k = 1, size(body%driven)
         associate (driven => body%driven(k), support => supports(body%driven(k)%support))
            if (support%is_jump) load_case%prescribed(:, driven%lead) = load_case%prescribed(:, driven%lead) &
               + merge(support%displacement(1), 0.0_dp, support%is_held(1))*driven%own(:size(load_case%prescribed, 1))
         end associate
      end do
      load_case%prescribed = body%dof_map%substitution%displacement(load_case%prescribed)
   end subroutine prescribe

   !> Sets the nodal forces and the thermal strain of loads, and their forces on driven motions.
   subroutine apply_loads(load_case, body, loads, error)
      type(load_case_t), intent(inout) :: load_case !! gains all these
      type(body_t), intent(in) :: body !! the body
      type(load_t), intent(in) :: loads(:) !! the loads
      type(error_t), allocatable, intent(out) :: error !! a load does not fit the mesh
      real(dp), allocatable :: of_heat(:, :)
      integer :: i, k

      call load_vector(load_case%force, body%mesh, body%materials, loads, error, load_case%uncanceled(1))
      if (.not. allocated(error)) call sum_element_loads(load_case%element_load, body%mesh, body%materials, loads, &
         error)
      if (allocated(error)) return
      if (allocated(load_case%element_load)) then
         call body%internal_forces(of_heat, 0.0_dp*load_case%force, load_case%element_load)
         load_case%uncanceled(2) = norm2(of_heat)
      end if
      load_case%driven = body%driven_forces(loads)
      do k = 1, size(body%driven)
         associate (driven => body%driven(k))
            if (any([(any(body%may_turn(i)%driven == k), i=1, size(body%may_turn))])) cycle
            load_case%force(:, driven%node) = load_case%force(:, driven%node) + load_case%driven(k)*driven%force
            load_case%uncanceled(1) = load_case%uncanceled(1) + abs(load_case%driven(k))*norm2(driven%force)
         end associate
      end do
   end subroutine apply_loads

   !> Refuses friction on a slave that supports guide if then no shear can act on some side of it.
   pure subroutine check_shear(zone, contacts, error)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, in the order of `new_contact_zone`
      type(error_t), allocatable, intent(out) :: error !! there is such a slave
      integer :: i

      do i = 1, size(contacts)
         if (contacts(i)%friction%vanishes() .and. contacts(i)%slip_bound%vanishes()) cycle
         if (.not. allocated(zone%pairs(i)%shear_fault)) cycle
         call new_error(error, input_refused, contacts(i)%origin//zone%pairs(i)%shear_fault)
         return
      end do
   end subroutine check_shear

   !> Sets gap, friction and slip bound of every point from its contact set.
   !>
   !> The gap is the distance to the obstacle along the normal of the point, negative where the body overlaps the
   !> obstacle (interference). A point whose normal does not meet the obstacle gets a gap that no displacement closes. A
   !> cell has the means over its area.
   pure subroutine set_obstacles(load_case, zone, mesh, contacts, error)
      type(load_case_t), intent(inout) :: load_case !! the load case
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, in the order of `new_contact_zone`
      type(error_t), allocatable, intent(out) :: error
         !! a boundary that faces away, an overlap larger than the body, or a negative friction
      real(dp) :: corners(size(mesh%coordinates, 1), 2), size_of_body, extent, gap, cosine, weight, &
         share_of_gap
      integer :: p, i, q
      character(:), allocatable :: hint
      logical :: is_met

      load_case%contacts = contacts
      corners(:, 1) = minval(mesh%coordinates, dim=2)
      corners(:, 2) = maxval(mesh%coordinates, dim=2)
      size_of_body = norm2(corners(:, 2) - corners(:, 1))
      load_case%gap = spread(0.0_dp, 1, zone%n_points)
      load_case%anchor = spread(0.0_dp, 1, zone%n_rows - zone%n_points)
      load_case%obstacle_motion = load_case%anchor
      load_case%friction = load_case%gap
      load_case%slip_bound = load_case%gap
      load_case%depth = load_case%gap
      load_case%foot = zone%quadrature%position
      load_case%extra_gap = load_case%gap
      load_case%cosine = spread(1.0_dp, 1, zone%n_points)
      load_case%is_in_reach = spread(.true., 1, zone%n_points)
      do p = 1, zone%n_points
         associate (quadrature => zone%quadrature, contact => contacts(zone%set(p)))
            do q = quadrature%start(p), quadrature%start(p + 1) - 1
               associate (position => quadrature%position(:, q), share => quadrature%share(q))
                  if (contact%pairing%is_pair()) then
                     gap = merge(quadrature%gap(q), 0.0_dp, contact%pairing%has_mesh_gap())
                     is_met = .true.
                     cosine = 1.0_dp
                  else
                     call contact%obstacle%measure(position, quadrature%normal(:, q), gap, is_met, cosine)
                     if (is_met) load_case%foot(:, q) = position + gap*quadrature%normal(:, q)
                     ! A given direction must lead out of the body.
                     is_met = is_met .and. quadrature%outward(q) >= steepest_cosine
                  end if
                  if (.not. is_met) load_case%depth(p) = max(load_case%depth(p), contact%obstacle%depth(position))
                  load_case%is_in_reach(p) = load_case%is_in_reach(p) .and. is_met
                  load_case%cosine(p) = min(load_case%cosine(p), cosine)
                  ! A node with shares of others, which are negative, has the friction at its own place. Gaps of the
                  ! others are vectors along their own normals, as displacements are.
                  weight = share
                  share_of_gap = share
                  if (.not. (zone%is_cell(p) .or. contact%pairing%is_pair())) then
                     weight = merge(1.0_dp, 0.0_dp, q == quadrature%start(p))
                     if (q > quadrature%start(p)) share_of_gap = share*dot_product(quadrature%normal(:, q), &
                        zone%normal(p))
                  end if
                  load_case%gap(p) = load_case%gap(p) + share_of_gap*gap
                  load_case%extra_gap(p) = load_case%extra_gap(p) &
                     + share_of_gap*contact%extra_gap%at(position, quadrature%arc_length(q))
                  load_case%friction(p) = load_case%friction(p) &
                     + weight*contact%friction%at(position, quadrature%arc_length(q))
                  load_case%slip_bound(p) = load_case%slip_bound(p) &
                     + weight*contact%slip_bound%at(position, quadrature%arc_length(q))*zone%area(p)
               end associate
            end do
         end associate
         load_case%gap(p) = merge(load_case%gap(p) + load_case%extra_gap(p), out_of_reach*size_of_body, &
            load_case%is_in_reach(p))
         ! An overlap by the rounding of coordinates would cause forces between unloaded bodies.
         if (abs(load_case%gap(p)) <= sum_rounding*maxval(abs(corners))) load_case%gap(p) = 0.0_dp
         ! Extent of the bounding box of the body behind the point.
         extent = sum(max((zone%position(:, p) - corners(:, 1))*zone%normal(p), &
            (zone%position(:, p) - corners(:, 2))*zone%normal(p)))
         if (exceeds(-load_case%gap(p), extent)) then
            call new_error(error, input_refused, contacts(zone%set(p))%origin//'the body overlaps the obstacle by '// &
               to_text(-load_case%gap(p))//' at '//place_text(zone%position(:, p))// &
               ', more than its own depth there; check point, normal and extra_gap of the obstacle')
         else if (min(load_case%friction(p), load_case%slip_bound(p)) < 0.0_dp) then
            call new_error(error, input_refused, contacts(zone%set(p))%origin// &
               'friction or slip bound is negative at '//place_text(zone%position(:, p)))
         end if
         if (allocated(error)) return
      end do
      do i = 1, size(contacts)
         if (any(load_case%is_in_reach .and. zone%set == i) .or. all(zone%set /= i)) cycle
         if (contacts(i)%slides_far()) cycle
         hint = ''
         if (contacts(i)%obstacle%kind == 'polyline') hint = ', its free side on the left of the way along its points'
         if (contacts(i)%obstacle%kind == 'surface') hint = ', its triangles counterclockwise seen from the free side'
         call new_error(error, input_refused, contacts(i)%origin//'the boundary does not face its obstacle; '// &
            'check the place of the obstacle, and that its normal points to the body'//hint)
         return
      end do
   end subroutine set_obstacles

   !> The part of every slip that supports prescribe; 0 where a support prevents the slip
   !> (n_rows - m) [L].
   pure function prescribed_slip(body, load_case) result(slip)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      real(dp) :: slip(body%retained%n_rows - body%retained%n_points), prescribed(body%retained%n_rows)

      prescribed = body%retained%rows%displacement(load_case%prescribed)
      slip = body%retained%free_slips(prescribed(body%retained%n_points + 1:))
   end function prescribed_slip

   !> Computes the displacements of all nodes from the solution of the contact problem.
   subroutine recover_displacement(displacement, body, load_case, solution, force)
      real(dp), allocatable, intent(out) :: displacement(:, :) !! displacements of all nodes (components, n_nodes) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case, condensed
      real(dp), intent(in) :: solution(:) !! displacements v of the contact problem (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), allocatable :: one(:, :, :)

      call recover_displacements(one, body, [load_case], spread(solution, 2, 1), spread(force, 2, 1))
      displacement = one(:, :, 1)
   end subroutine recover_displacement

   !> Computes the displacements of all nodes from the solutions of several contact problems, with one pass over the
   !> factor.
   subroutine recover_displacements(displacement, body, load_cases, solution, force)
      real(dp), allocatable, intent(out) :: displacement(:, :, :)
         !! displacements of all nodes (components, n_nodes, problems) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_cases(:) !! the load cases, condensed (problems)
      real(dp), intent(in) :: solution(:, :) !! displacements v of the contact problems (n_rows, problems) [L]
      real(dp), intent(in) :: force(:, :) !! their contact forces (lambda_N; lambda_T) (n_rows, problems) [F]
      real(dp), allocatable :: unknowns(:, :), v(:, :)
      integer :: k, m

      m = body%retained%n_points
      v = solution
      do k = 1, size(load_cases)
         v(m + 1:, k) = v(m + 1:, k) - prescribed_slip(body, load_cases(k))
         if (allocated(body%condensation%softness)) v(:, k) = v(:, k) - body%condensation%softness*force(:, k)
      end do
      call body%condensation%recover(load_cases%condensed, v, unknowns)
      allocate (displacement(size(load_cases(1)%prescribed, 1), body%mesh%n_nodes, size(load_cases)))
      do k = 1, size(load_cases)
         displacement(:, :, k) = from_unknowns(unknowns(:, k), load_cases(k)%prescribed, body%constraints, body%dof_map)
      end do
   end subroutine recover_displacements

   !> The condensed vector of nodal forces: its product with contact displacements v is the work of the forces when the
   !> other displacements follow v by equilibrium (n_rows) [F].
   function condensed_force(body, forces) result(row)
      type(body_t), intent(in) :: body !! the body, condensed
      real(dp), intent(in) :: forces(:, :) !! nodal forces (components, n_nodes) [F]
      real(dp), allocatable :: row(:)
      type(condensed_load_t) :: condensed

      call body%condensation%condense_load(to_unknowns(forces, body%constraints, body%dof_map), condensed)
      row = condensed%load
   end function condensed_force

   !> Assigns everything to the first part.
   pure function one_part(load_case) result(parting)
      type(load_case_t), intent(in) :: load_case !! the load case
      type(parting_t) :: parting

      allocate (parting%load(size(load_case%loads)), parting%support(size(load_case%supports)), &
         parting%friction(size(load_case%contacts)), source=1)
      allocate (parting%driven(0))
      allocate (parting%is_coefficient(1), source=.false.)
   end function one_part

   !> Adds a part, to which some of the loads, supports and contact sets belong.
   pure subroutine add_part(parting, loads, supports, contacts)
      type(parting_t), intent(inout) :: parting !! the parts so far
      logical, intent(in) :: loads(:) !! whether each load belongs to the new part
      logical, intent(in) :: supports(:) !! whether the displacements that each support prescribes do
      logical, intent(in) :: contacts(:) !! whether the friction of each contact set does

      parting%n_parts = parting%n_parts + 1
      where (loads) parting%load = parting%n_parts
      where (supports) parting%support = parting%n_parts
      where (contacts) parting%friction = parting%n_parts
   end subroutine add_part

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
      deallocate (family%base%force, family%base%prescribed)
      if (allocated(load_case%element_load)) deallocate (family%base%element_load)
      allocate (family%parts(parting%n_parts))
      allocate (family%load(body%retained%n_rows, parting%n_parts), family%largest(parting%n_parts))
      allocate (family%prescribed(body%zone%n_points, parting%n_parts), family%has_force(parting%n_parts), &
         family%has_displacement(parting%n_parts), family%uncanceled(2, parting%n_parts))
      allocate (is_loaded, mold=body%constraints%is_free)
      is_loaded = .false.
      do k = 1, parting%n_parts
         call fill_part(family%parts(k), k, body, load_case, parting, error)
         if (allocated(error)) return
         family%uncanceled(:, k) = family%parts(k)%uncanceled
         is_loaded = is_loaded .or. abs(family%parts(k)%force) > 0.0_dp
         family%has_force(k) = any(abs(family%parts(k)%force) > 0.0_dp)
         family%has_displacement(k) = any(abs(family%parts(k)%prescribed) > 0.0_dp)
         prescribed = body%zone%rows%displacement(family%parts(k)%prescribed)
         family%prescribed(:, k) = merge(0.0_dp, prescribed(:body%zone%n_points), body%slides_far)
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
            associate (slope => load_case%contacts(body%zone%set(p))%friction%slope, x => body%zone%position(:, p))
               family%friction(p, 1) = dot_product(slope(:size(x)), x)
            end associate
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
         part%uncanceled = load_case%uncanceled
         part%driven = load_case%driven
         part%posed = load_case%posed
         part%prescribed = load_case%prescribed
         if (allocated(load_case%element_load)) part%element_load = load_case%element_load
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
      if (allocated(load_case%element_load) .and. .not. allocated(part%element_load)) then
         part%element_load = 0.0_dp*load_case%element_load
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
      real(dp) :: slip(body%retained%n_rows - body%retained%n_points), from_slip(body%retained%n_rows)
      integer :: k

      do k = 1, size(self%parts)
         associate (part => self%parts(k))
            forces = part%force
            if (any(abs(part%prescribed) > 0.0_dp) .or. allocated(part%element_load)) then
               call body%internal_forces(internal, part%prescribed, part%element_load)
               forces = forces - internal
            end if
            call body%condensation%condense_load(to_unknowns(forces, body%constraints, body%dof_map), part%condensed)
            self%load(:, k) = part%condensed%load
            self%largest(k) = maxval(abs(part%prescribed))
            ! Upper bound of the expansion of the body, by its highest temperature.
            if (allocated(part%element_load)) self%largest(k) = max(self%largest(k), &
               maxval(abs(part%element_load(:size(body%mesh%node))))*body%size)
            ! Tangential displacements include prescribed parts, as the anchors do: such a part, for example at one node
            ! of a cell, becomes a load.
            slip = prescribed_slip(body, part)
         end associate
         if (.not. any(abs(slip) > 0.0_dp)) cycle
         call problem%matrix%multiply_stiffness([spread(0.0_dp, 1, body%retained%n_points), slip], from_slip)
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

   !> Moves the rigid obstacles to their places in a step of a history, and measures the gaps from there.
   subroutine load_family_move(self, body, motions, acting, error)
      class(load_family_t), intent(in) :: self !! the family
      type(body_t), intent(in) :: body !! the body
      type(pose_t), intent(in) :: motions(:) !! the motion of the obstacle of each contact set
      class(acting_t), intent(inout) :: acting !! the member, its obstacles at their places
      type(error_t), allocatable, intent(out) :: error !! an obstacle has moved too far into the body, or past it
      type(load_case_t) :: moved
      real(dp) :: frame(1 + body%zone%n_tangents, 1 + body%zone%n_tangents)
      integer :: i, p

      if (all(motions%is_at_rest()) .and. .not. body%slides_far) return
      ! The work on an obstacle is that of its moment about the pivot, before it moves, too.
      acting%motions = motions
      if (body%slides_far) return
      call set_obstacles(moved, body%zone, body%mesh, self%contacts_of(acting), error)
      if (allocated(error)) return
      acting%gap = moved%gap
      acting%is_in_reach = moved%is_in_reach
      ! Along the tangents of each point, at its foot; for a cell the mean.
      associate (zone => body%zone, quadrature => body%zone%quadrature)
         acting%motion = 0.0_dp
         do p = 1, zone%n_points
            do i = quadrature%start(p), quadrature%start(p + 1) - 1
               frame = zone%frame(:, :, p)
               if (zone%is_cell(p)) frame = new_frame(quadrature%normal(:, i), size(frame, 1))
               acting%motion(p::zone%n_points) = acting%motion(p::zone%n_points) + quadrature%share(i) &
                  *matmul(motions(zone%set(p))%displacement(self%base%foot(:, i)), &
                  frame(:size(self%base%foot, 1), 2:))
            end do
         end do
      end associate
   end subroutine load_family_move

   !> The contact sets of one member of the family, with the obstacles at their present places.
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
            if (size(self%base%foot, 1) == 2) obstacle%normal(:2) = cos(motion%turn)*obstacle%outward(2) &
               + sin(motion%turn)*turned(obstacle%outward(2))
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
      problem%uncanceled = matmul(self%uncanceled, abs(acting%factor))
      ! The law of contact that slides far is that at moved places.
      if (body%slides_far) return
      problem%gap = self%gap_of(acting)
      problem%anchor = body%zone%free_slips(acting%anchor)
      associate (is_fixed => all(body%zone%is_fixed, dim=1))
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

   !> Refuses prescribed displacements that take a node of a contact set into its rigid obstacle: no contact force acts
   !> on a node that supports hold along the normal.
   subroutine load_family_check_held_nodes(self, body, acting, error)
      class(load_family_t), intent(in) :: self !! the family
      type(body_t), intent(in) :: body !! the body
      class(acting_t), intent(in) :: acting !! the member
      type(error_t), allocatable, intent(out) :: error !! names support, node and set
      type(contact_t), allocatable :: contacts(:)
      character(:), allocatable :: support
      real(dp) :: place(size(body%mesh%coordinates, 1)), push, gap, cosine
      logical :: is_met
      integer :: i, k, axis

      if (size(body%zone%held_node) == 0) return
      contacts = self%contacts_of(acting)
      do i = 1, size(body%zone%held_node)
         associate (node => body%zone%held_node(i), contact => contacts(body%zone%held_set(i)), &
            normal => body%zone%held_normal(:, i))
            place = body%mesh%coordinates(:, node)
            push = dot_product(normal, [(dot_product(acting%factor, [(self%parts(k)%prescribed(axis, node), k=1, &
               size(self%parts))]), axis=1, size(place))])
            call contact%obstacle%measure(place, normal, gap, is_met, cosine)
            gap = gap + contact%extra_gap%at(place, body%zone%held_arc_length(i))
            ! Meshes lie in obstacles by the rounding of their files.
            if (.not. is_met .or. push - gap &
               <= negligible*abs(push) + max(0.0_dp, min(-gap, negligible*body%size))) cycle
            associate (holder => self%base%supports(maxval(body%constraints%holder(:, node))))
               support = holder%set
               if (len(holder%name) > 0) support = holder%name
               if (len(support) == 0) support = 'at '//place_text(holder%point(:size(body%mesh%coordinates, 1)))
               call new_error(error, no_equilibrium, holder%origin//"the support '"//support//"' holds the node at "// &
                  place_text(place)//" of the contact set '"//contact%set//"' "//short_text(push - gap)// &
                  ' deep in its rigid obstacle: no contact force can move it out')
            end associate
         end associate
         return
      end do
   end subroutine load_family_check_held_nodes

   !> The load case of a member, condensed if the family is.
   subroutine load_family_load_case(self, body, acting, load_case)
      class(load_family_t), intent(in) :: self !! the family
      type(body_t), intent(in) :: body !! the body
      class(acting_t), intent(in) :: acting !! the member
      type(load_case_t), intent(out) :: load_case !! the load case
      type(error_t), allocatable :: error
      integer :: k

      load_case = self%base
      if (body%slides_far) then
         load_case%contacts = self%contacts_of(acting)
         load_case%is_in_reach = acting%is_in_reach
         load_case%cosine = 1.0_dp
         if (allocated(acting%added_gap)) load_case%extra_gap = load_case%extra_gap + acting%added_gap
      else
         ! No error: the member was made with the same obstacles.
         if (allocated(acting%motions)) call set_obstacles(load_case, body%zone, body%mesh, self%contacts_of(acting), &
            error)
         load_case%extra_gap = load_case%extra_gap + (acting%gap - load_case%gap)
      end if
      load_case%gap = acting%gap
      if (size(self%parts) > 1) load_case%factor = acting%factor(self%parting%load)
      load_case%uncanceled = matmul(self%uncanceled, abs(acting%factor))
      load_case%force = acting%factor(1)*self%parts(1)%force
      load_case%driven = acting%factor(1)*self%parts(1)%driven
      load_case%posed = acting%factor(1)*self%parts(1)%posed
      load_case%prescribed = acting%factor(1)*self%parts(1)%prescribed
      load_case%condensed = self%parts(1)%condensed
      if (allocated(self%parts(1)%element_load)) load_case%element_load = &
         acting%factor(1)*self%parts(1)%element_load
      do k = 2, size(self%parts)
         load_case%driven = load_case%driven + acting%factor(k)*self%parts(k)%driven
         load_case%posed = load_case%posed + acting%factor(k)*self%parts(k)%posed
         if (self%has_force(k)) load_case%force = load_case%force + acting%factor(k)*self%parts(k)%force
         if (self%has_displacement(k)) load_case%prescribed = load_case%prescribed &
            + acting%factor(k)*self%parts(k)%prescribed
         if (allocated(load_case%condensed%load)) call load_case%condensed%add(acting%factor(k), &
            self%parts(k)%condensed)
         if (allocated(load_case%element_load)) load_case%element_load = load_case%element_load &
            + acting%factor(k)*self%parts(k)%element_load
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

end module amontons_load_family
