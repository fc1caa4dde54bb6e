!> The certificate: the conditions of the solution checked on the full model, from displacements and contact forces
!> alone; and the sums of nodal forces and their work that it needs, computed in one pass.
module amontons_certificate
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_assembly, only: inner_work, is_strained, spring_forces, uncanceled_force
   use amontons_body, only: body_t, find_motions
   use amontons_constraints, only: constraints_t
   use amontons_contact_rows, only: contact_rows_t
   use amontons_dense, only: moment
   use amontons_equilibrium, only: travel_of_nodes
   use amontons_free_boundary, only: corner_overlap, overlap_t
   use amontons_friction_law, only: point_violations, point_violations_t, tangential_norm
   use amontons_kinds, only: dp
   use amontons_load_family, only: load_case_t
   use amontons_loads, only: load_by_temperature
   use amontons_named_forces, only: force_values, named_quantities, set_named_values, set_posed_values
   use amontons_pose, only: pose_t, turn_vectors, whole_displacement
   use amontons_quantity, only: quantity_t, relative
   use amontons_rigid_motion, only: rigid_motions_t
   implicit none (type, external)
   private

   public :: certificate_t, new_certificate

   !> Forces and their work, summed up over the nodes.
   type :: node_sums_t
      real(dp) :: largest_load = 0.0_dp !! largest component of a nodal load [F]
      real(dp) :: largest_contact = 0.0_dp !! of a contact force [F]
      real(dp) :: largest_reaction = 0.0_dp !! of a reaction [F]
      real(dp) :: load(3) = 0.0_dp !! resultant of the loads [F]
      real(dp) :: contact(3) = 0.0_dp !! of the contact forces [F]
      real(dp) :: reaction(3) = 0.0_dp !! of the reactions of supports and springs [F]
      real(dp) :: forces = 0.0_dp !! magnitudes of all these, components taken singly: the scale of resultants [F]
      real(dp) :: springs = 0.0_dp !! magnitudes of the forces of the springs [F]
      real(dp) :: internal_work = 0.0_dp !! work of the internal forces [F L]
      real(dp) :: internal_size = 0.0_dp !! sum of its magnitudes [F L]
      real(dp) :: external_work = 0.0_dp !! work of loads and contact forces [F L]
      real(dp) :: support_work = 0.0_dp !! work of the reactions on the prescribed displacements [F L]
      real(dp) :: external_size = 0.0_dp !! sum of the magnitudes of both [F L]
   end type node_sums_t

   !> Violations of the conditions that define the solution, each over its natural scale, and the resultants. Those of
   !> the law at the points are over force_scale and length_scale.
   type, extends(point_violations_t) :: certificate_t
      real(dp) :: equilibrium = 0.0_dp
         !! |K u - f_th - f + C^T lambda| on the unknowns / size of the forces, or more [-]
      real(dp) :: penetration_outside = 0.0_dp
         !! largest overlap of the free boundary beyond the ends of contact sets / largest displacement [-]
      real(dp) :: penetration_between = 0.0_dp
         !! largest overlap of obstacle corners between contact points / largest displacement; 0 if negligible [-]
      real(dp) :: resultant = 0.0_dp !! |loads + reactions + contact forces| / sum of their magnitudes [-]
      real(dp) :: moment = 0.0_dp !! |moment of these| / (sum of their magnitudes times half the body's size) [-]
      real(dp) :: energy = 0.0_dp
         !! |u . (K u - f_th) - work of all forces| / sum of the magnitudes of the terms, or more [-]
      logical :: has_pairs = .false. !! whether there are pairs of bodies
      real(dp) :: pair_force = 0.0_dp
         !! |sum of the contact forces on both bodies of the pairs| / sum of their magnitudes [-]
      real(dp) :: pair_moment = 0.0_dp
         !! |their moment less the couple of the forces across the gaps| / (these magnitudes times half the size) [-]
      logical :: has_ties = .false. !! whether there are bonded surfaces
      real(dp) :: tie_moment = 0.0_dp !! likewise for the forces of bonded surfaces [-]
      real(dp), allocatable :: couple(:)
         !! the couple that the forces of each contact set, then of each tie make across its gap, 0 on rigid obstacles
         !! and in a body of revolution [F L]
      real(dp), allocatable :: couple_scale(:)
         !! sum of the moments of these forces about the middle of the slave, each in magnitude [F L]
      logical :: has_duality_gap = .false. !! whether no point rubs by Coulomb's law, so that both energies exist
      real(dp) :: duality_gap = 0.0_dp
         !! |primal energy of u - dual energy of lambda| / the same, of a given slip bound or none [-]
      real(dp) :: imbalance = 0.0_dp !! the norm that equilibrium is made of / size of the forces, never more [-]
      real(dp) :: force_scale = 0.0_dp !! scale of contact forces: the largest nodal force, or more [F]
      real(dp) :: length_scale = 0.0_dp !! scale of gaps and slips: the largest displacement, or more [L]
      real(dp) :: strain_energy = 0.0_dp !! half of stress times elastic strain and of spring force times way [F L]
      real(dp) :: dissipation = 0.0_dp !! work of friction: sum of lambda_T (u_T - a) [F L]
      real(dp) :: load(3) = 0.0_dp !! resultant of the loads, along x, y and, in space, z [F]
      real(dp) :: reaction(3) = 0.0_dp !! resultant of the support reactions [F]
      real(dp) :: contact(3) = 0.0_dp !! resultant of the obstacle's forces on the body [F]
      type(quantity_t), allocatable :: named(:) !! the forces on the body by name [F]
   contains
      procedure :: energies => certificate_energies
      procedure :: is_finite => certificate_is_finite
      procedure :: violations => certificate_violations
   end type certificate_t

   !> Violations above this limit are also compared with the rounding errors of the forces.
   real(dp), parameter :: suspicious = 1.0e-10_dp
   !> Share of |K| |u|, or of forces that the body carried before, that is well above the largest rounding errors.
   real(dp), parameter :: rounding_share = 1.0e-5_dp
   !> Share of |K| |x|, x the coordinates, beside which their rounding errors are below the limit.
   real(dp), parameter :: coordinate_share = 1.0e-8_dp

contains

   !> Computes the certificate of a solution on the full model, from its displacements and contact forces.
   subroutine new_certificate(certificate, body, load_case, displacement, force, of_stresses, poses)
      type(certificate_t), intent(out) :: certificate !! the certificate
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      real(dp), intent(in) :: displacement(:, :)
         !! displacement of the nodes, elastic where pieces turn far (components, n_nodes) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), intent(in), optional :: of_stresses(:, :)
         !! nodal forces that the stresses amount to, from `new_stress_field`, if known (components, n_nodes) [F]
      type(pose_t), intent(in), optional :: poses(:) !! poses of the pieces that turn far; there are none without them
      real(dp), allocatable :: internal(:, :), springs(:, :), contact(:, :), reaction(:, :), tied(:), named(:), &
         moved(:, :), on_nodes(:, :), thrust(:, :), turned_forces(:, :)
      type(node_sums_t) :: sums
      real(dp) :: force_size, least_scale, work
      integer :: i, node

      springs = spring_forces(body%mesh%n_nodes, body%springs, displacement)
      if (present(of_stresses)) then
         internal = of_stresses + springs
      else
         call body%internal_forces(internal, displacement, load_case%element_load)
      end if
      contact = body%zone%rows%forces(force, body%mesh%n_nodes)
      if (present(poses)) then
         moved = whole_displacement(body%turning, poses, body%mesh%coordinates, displacement)
         on_nodes = contact
         call turn_vectors(body%turning, poses, contact, is_back=.true.)
      end if
      reaction = internal - load_case%force - contact
      named = force_values(body, reaction, displacement, force, load_case%driven)
      if (present(poses)) then
         thrust = reshape([(body%turning(i)%thrust(poses(i), body%mesh%coordinates, displacement, reaction, &
            contact), i=1, size(poses))], &
            [3, size(poses)])
         call set_posed_values(named, body, poses, load_case%driven, thrust)
      end if
      ! The reactions of bonded nodes are the forces that the surfaces exert on each other.
      reaction = body%dof_map%substitution%forces(reaction)
      call split_tie_forces(tied, reaction, body)
      allocate (certificate%couple(size(body%zone%pairs) + size(body%ties)), source=0.0_dp)
      certificate%couple_scale = certificate%couple
      call split_imbalance(body%constraints, reaction, certificate%equilibrium)
      if (present(poses)) then
         ! A rigid set that turns exerts the given force where it is free.
         do i = 1, count(body%turning%rigid > 0)
            associate (piece => body%turning(i), length => body%constraints%rigid(body%turning(i)%rigid)%length)
               certificate%equilibrium = norm2([certificate%equilibrium, merge(0.0_dp, (thrust(:, i) &
                  - load_case%driven(piece%driven))/[1.0_dp, 1.0_dp, length], piece%is_held)])
            end associate
         end do
      end if
      call body%constraints%spread_resultants(reaction)
      associate (loads => load_case%force, prescribed => load_case%prescribed)
         ! Sum forces and their work over the nodes, all in one pass.
         do node = 1, size(loads, 2)
            do i = 1, size(loads, 1)
               associate (f => loads(i, node), c => contact(i, node), r => reaction(i, node), k => internal(i, node), &
                  s => springs(i, node), u => displacement(i, node), p => prescribed(i, node))
                  sums%largest_load = max(sums%largest_load, abs(f))
                  sums%largest_contact = max(sums%largest_contact, abs(c))
                  sums%largest_reaction = max(sums%largest_reaction, abs(r))
                  sums%load(i) = sums%load(i) + f
                  sums%contact(i) = sums%contact(i) + c
                  sums%reaction(i) = sums%reaction(i) + (r - s)
                  sums%forces = sums%forces + (abs(f) + abs(c) + abs(r - s))
                  sums%springs = sums%springs + abs(s)
                  sums%internal_work = sums%internal_work + k*u
                  sums%internal_size = sums%internal_size + abs(k*u)
                  sums%external_work = sums%external_work + (f + c)*u
                  sums%support_work = sums%support_work + r*p
                  sums%external_size = sums%external_size + (abs(f*u) + abs(c*u) + abs(r*p))
               end associate
            end do
         end do
         if (present(poses)) then
            ! Resultants are along the axes of the body.
            turned_forces = reaction - springs
            call turn_vectors(body%turning, poses, turned_forces, is_back=.false.)
            sums%reaction(:size(contact, 1)) = sum(turned_forces, dim=2)
            sums%contact(:size(contact, 1)) = sum(on_nodes, dim=2)
         end if
         force_size = max(norm_of(loads, sums%largest_load), norm_of(reaction, sums%largest_reaction), &
            norm_of(contact, sums%largest_contact))
         ! Unloading leaves rounding errors of the forces before.
         least_scale = rounding_share*load_case%carried_force/max(1, body%zone%n_points)
         ! So do loads that cancel, and free expansion.
         least_scale = max(least_scale, rounding_share*sum(load_case%uncanceled))
         do i = 1, size(body%motions)
            least_scale = max(least_scale, resting_scale(body, body%motions(i)%node, displacement, load_case, &
               reaction, contact, force_size, moved))
         end do
         certificate%force_scale = max(sums%largest_load, sums%largest_reaction, sums%largest_contact, least_scale)
         if (present(poses)) then
            call check_points(certificate, body, load_case, moved, force)
            call check_pairs(certificate, body, moved, on_nodes, force)
         else
            call check_points(certificate, body, load_case, displacement, force)
            call check_pairs(certificate, body, displacement, contact, force)
         end if
         call check_ties(certificate, body, tied, contact)
         if (any(body%ties%lead > 0)) then
            work = -dot_product(tied, body%tie_rows%displacement(displacement))
            sums%support_work = sums%support_work + work
            sums%external_size = sums%external_size + abs(work)
         end if
         call check_resultants(certificate, body, max(least_scale, rounding_share*load_case%carried_force, &
            sums%springs), sums, loads, contact, reaction, springs)
         certificate%named = named_quantities(body)
         call set_named_values(certificate%named, body, named, max(least_scale, sums%forces), maxval(abs(displacement)))
         certificate%imbalance = relative(certificate%equilibrium, max(force_size, least_scale))
         ! Rounding errors of displacements far larger than their differences are no imbalance, as long as resultants
         ! and energy are not affected: a share of |K| |u| is a scale, too.
         if (certificate%equilibrium > suspicious*max(force_size, least_scale)) then
            force_size = max(force_size, rounding_share*uncanceled_force(body%mesh, body%materials, &
               magnitudes(body, displacement)))
            ! Gaps, and displacements with them, have the rounding errors of coordinates.
            least_scale = max(least_scale, coordinate_share*uncanceled_force(body%mesh, body%materials, &
               0.0_dp*displacement + maxval(abs(body%mesh%coordinates))))
         end if
         certificate%equilibrium = relative(certificate%equilibrium, max(force_size, least_scale))
         certificate%strain_energy = 0.5_dp*sums%internal_work
         if (allocated(load_case%element_load)) certificate%strain_energy = certificate%strain_energy &
            - 0.5_dp*inner_work(body%mesh, body%materials, displacement, load_case%element_load)
         ! If a load acts on nodes that a support moves, both do work that causes no strain. Heat causes strain without
         ! work of forces. And loads that contact bears where they act leave their rounding errors to do work.
         work = max(sums%internal_size, certificate%strain_energy, sums%external_size, &
            max(rounding_share*force_size, least_scale)*norm2(displacement))
         certificate%energy = energy_violation(body, internal, load_case%force + contact, reaction, displacement, &
            sums%internal_work - sums%external_work - sums%support_work, work)
         ! A slip that the given bounds prevent has the rounding errors of displacements.
         certificate%duality_gap = relative(certificate%duality_gap, max(work, rounding_share &
            *sum(load_case%slip_bound)*maxval(abs(displacement))))
      end associate
   end subroutine new_certificate

   !> The violation of the balance of work, over the size of the works. If that is too large, the larger violation of
   !> two parts: the work on the nearest rigid motion of each piece, on which all forces together do none, and the work
   !> on the rest, each over its own size. So rounding errors of forces on a long way are measured by that work. Soft
   !> springs count as holding no piece, since the piece may move far against them; nor do supports count as holding a
   !> twisted piece around the axis, which they may turn far.
   real(dp) function energy_violation(body, internal, external, reaction, displacement, missing, work) result(violation)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: internal(:, :) !! nodal forces of stresses and springs (components, n_nodes) [F]
      real(dp), intent(in) :: external(:, :) !! those of loads and contact (components, n_nodes) [F]
      real(dp), intent(in) :: reaction(:, :) !! those of supports (components, n_nodes) [F]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: missing !! work of the former less that of the latter and of the supports [F L]
      real(dp), intent(in) :: work !! the size of the works [F L]
      type(constraints_t) :: constraints
      type(rigid_motions_t), allocatable :: free(:)
      integer :: n_dim
      real(dp), allocatable :: travel(:, :)
      real(dp) :: of_travel, size_of_travel

      violation = relative(abs(missing), work)
      if (.not. violation > suspicious) return
      constraints = body%constraints
      n_dim = size(body%mesh%coordinates, 1)
      constraints%is_free(n_dim + 1:, :) = .true.
      call find_motions(free, body, constraints, body%springs(:0))
      travel = travel_of_nodes(free, body%mesh%coordinates, displacement)
      of_travel = sum(travel*(internal - external)) - sum(travel(n_dim + 1:, :)*reaction(n_dim + 1:, :))
      size_of_travel = max(work, sum(abs(external))*maxval(abs(travel)))
      violation = max(relative(abs(missing - of_travel), work), relative(abs(of_travel), size_of_travel))
   end function energy_violation

   !> The smallest scale of the forces on a piece without loads: a share of |K| |u| if these forces are all rounding
   !> errors and no element is strained, otherwise 0. Forces in a strained soft part may be as small relative to the |K|
   !> |u| of a stiff part without being errors. Heat strains elements without forces [F].
   real(dp) function resting_scale(body, nodes, displacement, load_case, reaction, contact, force_size, whole) &
      result(scale)
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: nodes(:) !! the nodes of the piece
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      type(load_case_t), intent(in) :: load_case !! the loads
      real(dp), intent(in) :: reaction(:, :) !! nodal reactions (components, n_nodes) [F]
      real(dp), intent(in) :: contact(:, :) !! nodal forces of the obstacle (components, n_nodes) [F]
      real(dp), intent(in) :: force_size !! size of the forces on all pieces [F]
      real(dp), intent(in), optional :: whole(:, :)
         !! displacements with the poses of pieces that turn far, whose rounding elastic ones have (components, n_nodes)
         !! [L]
      ! Some hundred times the relative rounding error of a sum of a few dozen terms.
      real(dp), parameter :: rounding = 1.0e-13_dp
      ! Displacements have the rounding errors of the whole solution, more of them in a soft part beside a stiff one.
      real(dp), parameter :: negligible_share = 1.0e-8_dp
      ! Forces that are a larger share of those on other pieces need no separate scale.
      real(dp), parameter :: least_share = 1.0e-5_dp
      real(dp), allocatable :: moved(:, :), magnitude(:, :)
      real(dp) :: size_here, uncanceled

      scale = 0.0_dp
      size_here = max(maxval(abs(reaction(:, nodes))), maxval(abs(contact(:, nodes))))
      if (any(abs(load_case%force(:, nodes)) > 0.0_dp)) return
      if (any(abs(load_case%force) > 0.0_dp) .and. size_here > least_share*force_size) return
      allocate (moved, magnitude, mold=displacement)
      moved = 0.0_dp
      magnitude = 0.0_dp
      moved(:, nodes) = displacement(:, nodes)
      associate (of_all => magnitudes(body, displacement))
         magnitude(:, nodes) = of_all(:, nodes)
      end associate
      if (present(whole)) magnitude(:, nodes) = max(magnitude(:, nodes), abs(whole(:, nodes)))
      if (.not. any(load_case%loads%target == load_by_temperature)) then
         if (is_strained(body%mesh, body%materials, moved, maxval(magnitude), negligible_share)) return
      end if
      uncanceled = uncanceled_force(body%mesh, body%materials, magnitude)
      if (size_here <= rounding*uncanceled) scale = rounding_share*uncanceled
   end function resting_scale

   !> Magnitudes of the nodal displacements; for slaves those of the terms of their sums. The displacement of a body at
   !> rest may be the difference between that of another body and the gap, and has the rounding errors of both
   !> (components, n_nodes) [L].
   pure function magnitudes(body, displacement) result(magnitude)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), allocatable :: magnitude(:, :)
      real(dp) :: of_others(size(displacement, 1))
      integer :: node, i

      magnitude = abs(displacement)
      associate (rows => body%dof_map%substitution)
         if (.not. allocated(rows%start)) return
         do node = 1, size(magnitude, 2)
            of_others = 0.0_dp
            do i = rows%start(node), rows%start(node + 1) - 1
               if (rows%node(i) /= node) of_others = of_others &
                  + matmul(abs(rows%block(:, :, i)), abs(displacement(:, rows%node(i))))
            end do
            magnitude(:, node) = max(magnitude(:, node), of_others)
         end do
      end associate
   end function magnitudes

   !> Splits the residual of equilibrium into reactions (held directions) and imbalance (free directions).
   pure subroutine split_imbalance(constraints, reaction, imbalance)
      type(constraints_t), intent(in) :: constraints !! the supports
      real(dp), intent(inout) :: reaction(:, :)
         !! residual of equilibrium; on return its part along held directions (components, n_nodes) [F]
      real(dp), intent(out) :: imbalance !! norm of the part along free directions [F]
      real(dp) :: along(size(reaction, 1)), unit
      integer :: node

      ! Squares over that of the largest force neither overflow nor vanish.
      unit = binary_scale(max(maxval(abs(reaction)), tiny(unit)))
      imbalance = 0.0_dp
      do node = 1, size(reaction, 2)
         if (all(constraints%is_free(:, node))) then
            imbalance = imbalance + sum((reaction(:, node)*unit)**2)
            reaction(:, node) = 0.0_dp
            cycle
         end if
         associate (frame => constraints%frame(:, :, node), is_free => constraints%is_free(:, node))
            along = matmul(reaction(:, node), frame)
            imbalance = imbalance + sum((along*unit)**2, mask=is_free)
            reaction(:, node) = matmul(frame, merge(0.0_dp, along, is_free))
         end associate
      end do
      imbalance = sqrt(imbalance)/unit
   end subroutine split_imbalance

   !> Checks the contact law at every point.
   pure subroutine check_points(certificate, body, load_case, displacement, force)
      type(certificate_t), intent(inout) :: certificate !! the certificate, its scale of forces set
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! gaps and friction
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: force(:) !! (lambda_N; lambda_T) (n_rows) [F]
      ! An edge that lies half as deep in the body as that moves is no error of the mesh any more. What the tangents of
      ! the obstacle explain is one, even where next to nothing moves.
      real(dp), parameter :: unresolved(2) = [1.0e30_dp, 0.5_dp]
      real(dp) :: distance(body%zone%n_points), slip(body%zone%n_rows - body%zone%n_points)
      real(dp) :: at_points(body%zone%n_rows)
      type(overlap_t) :: outside, between
      integer :: m

      m = body%zone%n_points
      at_points = body%checked_rows%displacement(displacement)
      distance = load_case%gap - at_points(:m)
      where (load_case%contacts(body%zone%set)%pairing%has_mesh_gap()) distance = distance + body%gap_change
      slip = body%zone%free_slips(at_points(m + 1:) - load_case%anchor)
      ! Loads on the contact points themselves strain nothing: what is left then is rounding. They would press other
      ! points about so far into the stiffest part of the body.
      associate (list => body%materials%list)
         certificate%length_scale = max(maxval(abs(displacement)), certificate%force_scale &
            /maxval(body%zone%area/body%zone%weight)/maxval([list%young(1), list%young(2), list%young(3)]))
      end associate
      associate (moved => displacement(:size(body%mesh%coordinates, 1), :))
         outside = body%free_boundary%overlap(load_case%contacts, load_case%lies_outside, body%mesh%coordinates, moved)
         certificate%penetration_outside = relative(outside%depth, certificate%length_scale)
         if (.not. body%slides_far) between = corner_overlap(body, load_case%contacts, body%zone, &
            load_case%extra_gap, moved, unresolved)
         certificate%penetration_between = relative(between%depth, certificate%length_scale)
      end associate
      associate (normal => force(:m), tangential => force(m + 1:), &
         bound => load_case%slip_bound + load_case%friction*max(0.0_dp, force(:m)), &
         largest_force => certificate%force_scale, largest_displacement => certificate%length_scale)
         certificate%point_violations_t = point_violations(relative(distance, largest_displacement), &
            relative(slip, largest_displacement), relative(normal, largest_force), &
            relative(tangential, largest_force), relative(bound, largest_force))
         certificate%dissipation = sum(tangential*slip)
         ! The difference of the energies of displacements and forces in equilibrium is the sum of these terms of the
         ! points.
         certificate%has_duality_gap = all(all(body%zone%is_fixed, dim=1) .or. .not. load_case%friction > 0.0_dp)
         if (certificate%has_duality_gap) certificate%duality_gap = abs(sum(normal*distance) &
            + sum(bound*tangential_norm(slip, m)) - certificate%dissipation)
      end associate
   end subroutine check_points

   !> Moves the forces that bonded surfaces exert on each other from the reactions of the nodes to the forces of the
   !> ties.
   pure subroutine split_tie_forces(force, reaction, body)
      real(dp), allocatable, intent(out) :: force(:) !! (lambda_N; lambda_T) of the points of all ties (2n) [F]
      real(dp), intent(inout) :: reaction(:, :) !! the reactions; keeps those of supports (components, n_nodes) [F]
      type(body_t), intent(in) :: body !! the body
      real(dp), dimension(size(reaction, 1)) :: exerted, pushed, jump
      integer :: i, p, n, k

      n = size(body%tie_rows%start) - 1
      allocate (force(size(reaction, 1)*n), source=0.0_dp)
      k = 0
      do i = 1, size(body%ties)
         ! The own unknown of a preload's leading corner is that of all others, too.
         pushed = 0.0_dp
         jump = body%ties(i)%jump(:size(jump))
         associate (tie => body%ties(i))
            do p = 1, size(tie%node)
               if (tie%node(p) /= tie%lead) pushed = pushed + matmul(body%constraints%free_projector(tie%node(p)), &
                  reaction(:, tie%node(p)))
            end do
         end associate
         pushed = dot_product(pushed, jump)*jump
         do p = 1, size(body%ties(i)%node)
            k = k + 1
            associate (node => body%ties(i)%node(p))
               exerted = matmul(body%constraints%free_projector(node), reaction(:, node))
               reaction(:, node) = reaction(:, node) - exerted
               if (node == body%ties(i)%lead) then
                  ! The residual of equilibrium of a free jump is an imbalance.
                  if (body%ties(i)%is_jump_free) reaction(:, node) = reaction(:, node) &
                     + dot_product(exerted, jump)*jump
                  exerted = exerted - pushed
               end if
               force(k::n) = -matmul(exerted, body%ties(i)%frame(:, :, p))
            end associate
         end do
      end do
   end subroutine split_tie_forces

   !> Checks that the forces on the two bodies of every pair cancel, and their moments except for the couple that they
   !> form across a gap. In a body of revolution the forces around the axis have no moment in the plane.
   pure subroutine check_pairs(certificate, body, displacement, contact, force)
      type(certificate_t), intent(inout) :: certificate !! the certificate
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: contact(:, :) !! nodal contact forces (components, n_nodes) [F]
      real(dp), intent(in) :: force(:) !! (lambda_N; lambda_T) (n_rows) [F]
      real(dp), allocatable :: on_nodes(:, :), place(:, :)
      real(dp) :: of_pairs(size(force)), moment, reach(body%zone%n_points)
      logical :: is_paired(body%zone%n_points)
      integer :: p

      is_paired = body%zone%pairs(body%zone%set)%is_set()
      certificate%has_pairs = any(is_paired)
      if (.not. certificate%has_pairs) return
      of_pairs = force
      do p = 1, size(is_paired)
         if (.not. is_paired(p)) of_pairs(p::size(is_paired)) = 0.0_dp
      end do
      on_nodes = contact
      if (.not. all(is_paired)) on_nodes = body%zone%rows%forces(of_pairs, body%mesh%n_nodes)
      ! Around the axis moments cancel, not forces.
      if (body%materials%is_twisted()) on_nodes(3, :) = on_nodes(3, :)*body%mesh%coordinates(1, :) &
         /maxval(body%mesh%coordinates(1, :))
      certificate%pair_force = relative(norm2(sum(on_nodes, dim=2)), sum(abs(on_nodes)))
      if (body%is_axisymmetric) return
      ! In space the weight is an area.
      reach = 0.25_dp*merge(body%zone%weight, sqrt(body%zone%weight), allocated(body%zone%line))
      ! Of what slides far the moments are those at the moved places.
      place = body%mesh%coordinates
      if (body%slides_far) place = place + displacement(:size(place, 1), :)
      call check_moment(moment, certificate, place, body%checked_rows, body%zone%set, reach, of_pairs, on_nodes)
      certificate%pair_moment = moment
   end subroutine check_pairs

   !> Checks the moments of the forces that bonded surfaces exert on each other like those of pairs, and adds these
   !> forces, whose couple acts across the gaps, to the contact forces.
   pure subroutine check_ties(certificate, body, tied, contact)
      type(certificate_t), intent(inout) :: certificate !! the certificate
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: tied(:) !! (lambda_N; lambda_T) of the points of all ties (2n) [F]
      real(dp), intent(inout) :: contact(:, :) !! nodal contact forces (components, n_nodes) [F]
      real(dp), allocatable :: on_nodes(:, :)
      real(dp) :: moment
      integer, allocatable :: set(:)
      integer :: i, p

      certificate%has_ties = size(tied) > 0
      if (.not. certificate%has_ties) return
      on_nodes = body%tie_rows%forces(tied, body%mesh%n_nodes)
      contact = contact + on_nodes
      if (body%is_axisymmetric) return
      set = [([(size(body%zone%pairs) + i, p=1, size(body%ties(i)%node))], i=1, size(body%ties))]
      call check_moment(moment, certificate, body%mesh%coordinates, body%checked_tie_rows, set, &
         spread(0.0_dp, 1, size(set)), tied, on_nodes)
      certificate%tie_moment = moment
   end subroutine check_ties

   !> Checks that the sum of the moments of the forces on both sides of some points is the couple of these forces across
   !> the gaps.
   pure subroutine check_moment(violation, certificate, x, rows, set, reach, force, on_nodes)
      real(dp), intent(out) :: violation
         !! missing moment over the magnitudes of the forces times half the body's size [-]
      type(certificate_t), intent(inout) :: certificate
         !! gains the couple of the points of each set, and the magnitude of their moments about their middle
      real(dp), intent(in) :: x(:, :) !! places of the nodes (n_dim, n_nodes) [L]
      type(contact_rows_t), intent(in) :: rows !! the rows of the points, integrated a second time
      integer, intent(in) :: set(:) !! which set each point belongs to (n)
      real(dp), intent(in) :: reach(:) !! mean distance of the stress of each point from its middle (n) [L]
      real(dp), intent(in) :: force(:) !! (lambda_N; lambda_T) of the points (2n) [F]
      real(dp), intent(in) :: on_nodes(:, :)
         !! these forces on the nodes, made from the rows of the solution (components, n_nodes) [F]
      real(dp) :: magnitude(size(set)), place(size(x, 1), size(set)), middle(size(place, 1))
      real(dp) :: total(3), couple(3)
      integer :: i, k, n

      n = size(set)
      magnitude = hypot(force(:n), tangential_norm(force(n + 1:), n))
      place = reshape([(x(:, rows%node(rows%start(i))), i=1, n)], shape(place))
      total = moment_of(x, on_nodes)
      do i = minval(set), maxval(set)
         couple = moment_of(x, rows%forces(merge(force, 0.0_dp, [(set == i, k=1, size(force)/n)]), size(x, 2)))
         certificate%couple(i) = certificate%couple(i) + norm2(couple)
         total = total - couple
      end do
      violation = norm2(total)
      violation = relative(violation, sum(abs(on_nodes))*0.5_dp*maxval(maxval(x, dim=2) - minval(x, dim=2)))
      do i = minval(set), maxval(set)
         middle = matmul(place, merge(magnitude, 0.0_dp, set == i))/max(tiny(1.0_dp), sum(magnitude, mask=set == i))
         ! A single point that is closed transmits a moment, too.
         certificate%couple_scale(i) = certificate%couple_scale(i) + sum(magnitude*max(reach, norm2(place &
            - spread(middle, 2, n), dim=1)), mask=set == i)
      end do
   end subroutine check_moment

   !> The moment of nodal forces about the origin [F L].
   pure function moment_of(coordinates, forces) result(total)
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      real(dp), intent(in) :: forces(:, :) !! their forces (components, n_nodes) [F]
      real(dp) :: total(3)
      integer :: node

      total = 0.0_dp
      do node = 1, size(forces, 2)
         total = total + moment(coordinates(:, node), forces(:, node))
      end do
   end function moment_of

   !> Checks that all forces on the body balance. In a body of revolution only those along the axis need to, and the
   !> moments about it if it is twisted.
   pure subroutine check_resultants(certificate, body, least_scale, sums, loads, contact, reaction, springs)
      type(certificate_t), intent(inout) :: certificate !! the certificate
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: least_scale !! smallest scale of the forces [F]
      type(node_sums_t), intent(in) :: sums !! sums of the forces
      real(dp), intent(in) :: loads(:, :) !! nodal forces of the loads (components, n_nodes) [F]
      real(dp), intent(in) :: contact(:, :) !! nodal forces of the obstacle (components, n_nodes) [F]
      real(dp), intent(in) :: reaction(:, :) !! nodal reactions (components, n_nodes) [F]
      real(dp), intent(in) :: springs(:, :) !! nodal forces of the springs (components, n_nodes) [F]
      real(dp) :: norm, radius
      real(dp), dimension(size(body%mesh%coordinates, 1)) :: center, resultant

      certificate%load(:size(resultant)) = sums%load(:size(resultant))
      certificate%reaction(:size(resultant)) = sums%reaction(:size(resultant))
      certificate%contact(:size(resultant)) = sums%contact(:size(resultant))
      norm = max(sums%forces, least_scale)
      resultant = sums%load(:size(resultant)) + sums%reaction(:size(resultant)) + sums%contact(:size(resultant))
      if (body%is_axisymmetric) resultant(1) = 0.0_dp
      certificate%resultant = relative(norm2(resultant), norm)
      if (body%materials%is_twisted()) certificate%moment = relative(abs(dot_product(body%mesh%coordinates(1, :), &
         loads(3, :) + (reaction(3, :) - springs(3, :)) + contact(3, :))), norm*maxval(body%mesh%coordinates(1, :)))
      if (body%is_axisymmetric) return
      center = 0.5_dp*(minval(body%mesh%coordinates, dim=2) + maxval(body%mesh%coordinates, dim=2))
      radius = maxval(maxval(body%mesh%coordinates, dim=2) - center)
      certificate%moment = relative(norm2(moment_of(body%mesh%coordinates - spread(center, 2, body%mesh%n_nodes), &
         loads + (reaction - springs) + contact)), norm*radius)
   end subroutine check_resultants

   !=certificate `equilibrium` | norm of the unbalanced nodal forces along free directions | largest of the norms of
   !=   loads, reactions, contact forces (or more, see below)
   !=certificate `penetration` | largest overlap with the obstacle | largest displacement component
   !=certificate `penetration_outside` | the same of the nodes of the free boundary beyond the ends of the contact sets,
   !=   see below | the same
   !=certificate `penetration_between` | the same of corners of obstacles between contact points, see below | the same
   !=certificate `tension` | largest $-\lambda_N$ | largest nodal force of loads, reactions and contact (or more)
   !=certificate `friction_excess` | largest $\lvert\lambda_T\rvert - g - \varphi\lambda_N$ | the same
   !=certificate `complementarity` | largest value of the smaller of force and gap at a point | force by the largest
   !=   nodal force, gap by the largest displacement component
   !=certificate `slip_below_bound` | largest value of the smaller of the slip $\lvert u_T - a\rvert$ and $g +
   !=   \varphi\lambda_N - \lvert\lambda_T\rvert$ at a point whose tangential direction no support holds | as above
   !=certificate `wrong_dissipation` | largest value of the smaller of $\lvert\lambda_T\rvert$ and $\lvert u_T -
   !=   a\rvert$ where $\lambda_T (u_T - a) < 0$; in space of what of each is not along the other | as above
   !=certificate `resultant` | sum of loads, reactions and contact forces | sum of the magnitudes of all their
   !=   components (or more)
   !=certificate `moment` | moment of these, and of the forces that bonded surfaces exert on each other, about the
   !=   middle of the body | that sum times half the body's larger side
   !=certificate `energy` | $u \cdot (K u - f_\vartheta)$ minus the work of loads, contact forces and reactions | sum of
   !=   the magnitudes of the terms of the former or, if larger, of these works, or the strain energy (or more)
   !=certificate `pair_force` | sum of the contact forces on both bodies of all pairs; around an axis of their moments,
   !=   over the largest radius | sum of their magnitudes
   !=certificate `pair_moment` | sum of their moments about the origin, less the couple that the forces make across the
   !=   gaps (0 where the bodies touch); none in a body of revolution | sum of their magnitudes times half the body's
   !=   larger side
   !=certificate `tie_moment` | as pair_moment, of the forces that bonded surfaces exert on each other | the same
   !=certificate `duality_gap` | primal energy of $u$ minus dual energy of $\lambda$ | the same
   !> The violations, each over its natural scale; all must be below the limit [-].
   pure function certificate_violations(self) result(list)
      class(certificate_t), intent(in) :: self !! the certificate
      type(quantity_t), allocatable :: list(:), of_law(:)

      of_law = self%point_violations_t%violations()
      list = [quantity_t('equilibrium', 'Equilibrium', self%equilibrium, 1.0_dp), of_law(1), &
         quantity_t('penetration_outside', 'Penetration outside the sets', self%penetration_outside, 1.0_dp), &
         quantity_t('penetration_between', 'Penetration between points', self%penetration_between, 1.0_dp), &
         of_law(2:), quantity_t('resultant', 'Resultant', self%resultant, 1.0_dp), &
         quantity_t('moment', 'Moment', self%moment, 1.0_dp), &
         quantity_t('energy', 'Energy balance', self%energy, 1.0_dp)]
      if (self%has_pairs) list = [list, quantity_t('pair_force', 'Forces of pairs', self%pair_force, 1.0_dp), &
         quantity_t('pair_moment', 'Moments of pairs', self%pair_moment, 1.0_dp)]
      if (self%has_ties) list = [list, quantity_t('tie_moment', 'Moments of ties', self%tie_moment, 1.0_dp)]
      if (self%has_duality_gap) list = [list, quantity_t('duality_gap', 'Duality gap', self%duality_gap, 1.0_dp)]
   end function certificate_violations

   !> The energies and works of the result, which are not violations [F L].
   pure function certificate_energies(self) result(list)
      class(certificate_t), intent(in) :: self !! the certificate
      type(quantity_t) :: list(2)

      list = [quantity_t('strain_energy', 'Strain energy', self%strain_energy, self%strain_energy, dimension='F L'), &
         quantity_t('work_of_friction', 'Work of friction', self%dissipation, self%strain_energy, dimension='F L')]
   end function certificate_energies

   !> Whether every number of the certificate is finite.
   pure logical function certificate_is_finite(self) result(is_finite)
      class(certificate_t), intent(in) :: self !! the certificate
      type(quantity_t), allocatable :: list(:)

      list = self%violations()
      is_finite = all(ieee_is_finite([list%value, self%strain_energy, self%dissipation, self%load, self%reaction, &
         self%contact]))
   end function certificate_is_finite

   !> The Euclidean norm of nodal forces, scaled by the largest one so that squares neither overflow nor underflow [F].
   pure real(dp) function norm_of(forces, largest) result(norm)
      real(dp), intent(in) :: forces(:, :) !! the forces (components, n_nodes) [F]
      real(dp), intent(in) :: largest !! their largest component [F]
      real(dp) :: unit
      integer :: node

      norm = 0.0_dp
      if (.not. largest > 0.0_dp) return
      unit = binary_scale(largest)
      do node = 1, size(forces, 2)
         norm = norm + sum((forces(:, node)*unit)**2)
      end do
      norm = sqrt(norm)/unit
   end function norm_of

   !> The power of two near the reciprocal of a number: scaling by it is exact and faster than a division.
   pure real(dp) function binary_scale(number) result(unit)
      real(dp), intent(in) :: number !! the number, positive
      ! Beyond it a power of two, or the number times it, would leave the range.
      integer, parameter :: most = 1000

      unit = scale(1.0_dp, max(-most, min(most, -exponent(number))))
   end function binary_scale

end module amontons_certificate
