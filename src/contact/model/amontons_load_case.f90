!> A load case: what acts on a body in one case, one step or one row of a sweep. The body itself never changes.
module amontons_load_case
   use amontons_assembly, only: from_unknowns, to_unknowns
   use amontons_body, only: body_t
   use amontons_condensation, only: condensed_load_t
   use amontons_constraints, only: constraints_t, new_constraints, support_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t, load_vector, spread_total_force, sum_thermal_strain
   use amontons_material, only: on_axis
   use amontons_mesh, only: mesh_t
   use amontons_obstacle, only: steepest_cosine
   use amontons_text, only: place_text, to_text
   implicit none (type, external)
   private

   public :: apply_loads, check_shear, condensed_force, load_case_t, new_load_case, prescribe, prescribed_slip, &
      recover_displacement, recover_displacements, set_obstacles

   !> Loads, prescribed displacements, obstacles and friction of one case.
   type :: load_case_t
      type(support_t), allocatable :: supports(:) !! the supports, with what they prescribe
      type(load_t), allocatable :: loads(:) !! the loads
      real(dp), allocatable :: factor(:)
         !! factor of each load in a sweep or a load history; not allocated if all are 1 (loads) [-]
      type(contact_t), allocatable :: contacts(:) !! the contact sets, with their obstacles
      real(dp), allocatable :: force(:, :) !! nodal forces of the loads (components, n_nodes) [F]
      real(dp), allocatable :: driven(:) !! forces that loads give the driven motions of the body (motions) [F, F L]
      real(dp), allocatable :: prescribed(:, :)
         !! displacements that the supports prescribe, with what follows of them for slaves (components, n_nodes) [L]
      real(dp), allocatable :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node`; not allocated
         !! without temperatures [-]
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
         !! largest sum of the normal forces in the load history so far; 0 without one [F]
      logical, allocatable :: is_in_reach(:) !! whether the normal meets the obstacle, so that the point can close (m)
      real(dp), allocatable :: cosine(:) !! of the angle between the normal and the way into the obstacle (m) [-]
      real(dp), allocatable :: depth(:) !! depth in the obstacle of a point out of reach, 0 for the others (m) [L]
      logical, allocatable :: lies_outside(:)
         !! which nodes of the free boundary lie outside what they face, from `new_load_case` (free nodes)
      real(dp), allocatable :: friction(:)
         !! Coulomb coefficient phi of the forces, that of the stresses where both act on the same area (m) [-]
      real(dp), allocatable :: slip_bound(:) !! given bound g of the tangential force (m) [F]
      type(condensed_load_t) :: condensed !! the condensed load, where its family is condensed
   end type load_case_t

contains

   !> Makes a load case and checks its input; whether it has an equilibrium is checked by `check_balance`.
   subroutine new_load_case(load_case, body, supports, contacts, loads, error)
      type(load_case_t), intent(out) :: load_case !! the load case, not condensed yet
      type(body_t), intent(in) :: body !! the body
      type(support_t), intent(in) :: supports(:)
         !! the supports that the body was made with; their prescribed displacements may be others
      type(contact_t), intent(in) :: contacts(:)
         !! the contact sets that the body was made with; their obstacles, gaps and friction may be others
      type(load_t), intent(in) :: loads(:) !! the loads
      type(error_t), allocatable, intent(out) :: error !! supports, contacts or loads do not fit the body
      type(constraints_t) :: constraints
      real(dp) :: prescribed(body%zone%n_rows)
      integer :: i

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
   end subroutine new_load_case

   !> Sets the displacements that supports prescribe, with those that follow from them by substitution.
   subroutine prescribe(load_case, constraints, body, supports, error)
      type(load_case_t), intent(inout) :: load_case !! gains the displacements
      type(constraints_t), intent(out) :: constraints !! the components that supports hold
      type(body_t), intent(in) :: body !! the body
      type(support_t), intent(in) :: supports(:) !! the supports
      type(error_t), allocatable, intent(out) :: error !! the supports do not fit the mesh
      integer :: k

      call new_constraints(constraints, load_case%prescribed, body%mesh, supports, error, body%materials)
      if (allocated(error)) return
      do k = 1, size(body%driven)
         associate (driven => body%driven(k), support => supports(body%driven(k)%support))
            if (support%is_jump) load_case%prescribed(:2, driven%lead) = load_case%prescribed(:2, driven%lead) &
               + merge(support%displacement(1), 0.0_dp, support%is_held(1))*driven%own(:2)
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
      integer :: k

      call load_vector(load_case%force, body%mesh, body%materials, loads, error)
      if (.not. allocated(error)) call sum_thermal_strain(load_case%thermal_strain, body%mesh, body%materials, loads, &
         error)
      if (allocated(error)) return
      load_case%driven = body%driven_forces(loads)
      do k = 1, size(body%driven)
         associate (driven => body%driven(k))
            load_case%force(:, driven%node) = load_case%force(:, driven%node) + load_case%driven(k)*driven%force
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
      real(dp), parameter :: out_of_reach = 1.0e3_dp
      ! Relative difference up to which two lengths are equal.
      real(dp), parameter :: rounding = 1.0e-9_dp
      ! Rounding error of gaps of surfaces that touch, over the coordinates: as an overlap it would cause forces between
      ! unloaded bodies.
      real(dp), parameter :: noise = 1.0e-14_dp
      real(dp) :: corners(2, 2), size_of_body, extent, gap, cosine
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
                     ! A given direction must lead out of the body.
                     is_met = is_met .and. quadrature%outward(q) >= steepest_cosine
                  end if
                  if (.not. is_met) load_case%depth(p) = max(load_case%depth(p), contact%obstacle%depth(position))
                  load_case%is_in_reach(p) = load_case%is_in_reach(p) .and. is_met
                  load_case%cosine(p) = min(load_case%cosine(p), cosine)
                  load_case%gap(p) = load_case%gap(p) + share*gap
                  load_case%extra_gap(p) = load_case%extra_gap(p) &
                     + share*contact%extra_gap%at(position, quadrature%arc_length(q))
                  load_case%friction(p) = load_case%friction(p) &
                     + share*contact%friction%at(position, quadrature%arc_length(q))
                  load_case%slip_bound(p) = load_case%slip_bound(p) &
                     + share*contact%slip_bound%at(position, quadrature%arc_length(q))*zone%area(p)
               end associate
            end do
         end associate
         load_case%gap(p) = load_case%gap(p) + load_case%extra_gap(p)
         if (.not. load_case%is_in_reach(p)) load_case%gap(p) = out_of_reach*size_of_body
         if (contacts(zone%set(p))%pairing%is_pair()) load_case%gap(p) = merge(load_case%gap(p), 0.0_dp, &
            abs(load_case%gap(p)) > noise*maxval(abs(corners)))
         ! Extent of the bounding box of the body behind the point.
         extent = sum(max((zone%position(:, p) - corners(:, 1))*zone%normal(:, p), &
            (zone%position(:, p) - corners(:, 2))*zone%normal(:, p)))
         if (-load_case%gap(p) > (1.0_dp + rounding)*extent) then
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
         hint = ''
         if (contacts(i)%obstacle%kind == 'polyline') hint = ', its free side on the left of the way along its points'
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
      real(dp) :: slip(body%zone%n_rows - body%zone%n_points), prescribed(body%zone%n_rows)

      prescribed = body%zone%rows%displacement(load_case%prescribed)
      slip = merge(0.0_dp, prescribed(body%zone%n_points + 1:), body%zone%is_slip_fixed)
   end function prescribed_slip

   !> Computes the displacements of all nodes from the solution of the contact problem.
   subroutine recover_displacement(displacement, body, load_case, solution)
      real(dp), allocatable, intent(out) :: displacement(:, :) !! displacements of all nodes (components, n_nodes) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case, condensed
      real(dp), intent(in) :: solution(:) !! displacements v of the contact problem (n_rows) [L]
      real(dp), allocatable :: one(:, :, :)

      call recover_displacements(one, body, [load_case], reshape(solution, [size(solution), 1]))
      displacement = one(:, :, 1)
   end subroutine recover_displacement

   !> Computes the displacements of all nodes from the solutions of several contact problems, with one pass over the
   !> factor.
   subroutine recover_displacements(displacement, body, load_cases, solution)
      real(dp), allocatable, intent(out) :: displacement(:, :, :)
         !! displacements of all nodes (components, n_nodes, problems) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_cases(:) !! the load cases, condensed (problems)
      real(dp), intent(in) :: solution(:, :) !! displacements v of the contact problems (n_rows, problems) [L]
      real(dp), allocatable :: unknowns(:, :), v(:, :)
      integer :: k, m

      m = body%zone%n_points
      v = solution
      do k = 1, size(load_cases)
         v(m + 1:, k) = v(m + 1:, k) - prescribed_slip(body, load_cases(k))
      end do
      call body%condensation%recover(load_cases%condensed, v, unknowns)
      allocate (displacement(size(load_cases(1)%prescribed, 1), body%mesh%n_nodes, size(load_cases)))
      do k = 1, size(load_cases)
         displacement(:, :, k) = from_unknowns(unknowns(:, k), load_cases(k)%prescribed, body%constraints, &
            body%dof_map)
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

end module amontons_load_case
