!> A body: mesh, supports, contact zone, factorized and condensed stiffness, and the rigid-body modes that supports
!> leave free, as displacements of the contact points.
module amontons_body
   use amontons_assembly, only: assemble_stiffness
   use amontons_condensation, only: condensation_options_t, condensation_t, find_band_order, may_suit_band, &
      new_condensation, new_distributed_condensation, new_flexibility
   use amontons_condenser, only: cholesky_t, condenser_t
   use amontons_conditioning, only: conditioning_text
   use amontons_constraints, only: constraints_t, dof_map_t, longest_name, new_constraints, new_dof_map, &
      new_foundation, spring_side_t, substitution_t, support_t
   use amontons_contact_problem, only: contact_problem_t, new_contact_problem
   use amontons_contact_rows, only: contact_rows_t, share_parts
   use amontons_contact_set, only: contact_t, tie_t
   use amontons_contact_zone, only: contact_zone_t, let_guided_slaves_slip, new_contact_zone, recompute_pairs, &
      segments_again
   use amontons_distributed, only: n_ranks, new_distributed_condenser
   use amontons_error, only: error_t, input_refused, new_error, no_equilibrium
   use amontons_frame, only: new_frame
   use amontons_free_boundary, only: free_boundary_t, new_free_boundary
   use amontons_inf_sup, only: inf_sup_constant
   use amontons_kinds, only: dp, int64
   use amontons_loads, only: load_on_motion, load_t
   use amontons_material, only: material_t, new_materials
   use amontons_mesh, only: coloring_t, mesh_t, new_coloring, outer_sides
   use amontons_mortar_pair, only: integrate_pair, mortar_pair_t, mortar_points_t
   use amontons_moved_zone, only: check_retained, check_sliding, new_retained_zone
   use amontons_named_set, only: named_forces_t, name_forces
   use amontons_new_cholesky, only: new_cholesky
   use amontons_pair_substitution, only: bonds_of, join_corners, new_pair_substitution, new_tied_pairs
   use amontons_pose, only: find_turning_pieces, turning_piece_t
   use amontons_recovery_tables, only: recovery_tables_t
   use amontons_rigid_motion, only: displacement_of_nodes, largest_motion, new_rigid_motions, orthonormal_modes, &
      resting_motions, rigid_motions_t
   use amontons_rigid_set, only: rigid_components
   use amontons_rounding, only: sum_rounding
   use amontons_sparse_matrix, only: half_bandwidth, sparse_matrix_t
   use amontons_stress_field, only: forces_of_stress => internal_forces
   use amontons_surface, only: meshed_body_t
   use amontons_system, only: available_memory_mb, peak_memory_mb, resident_memory_mb, return_memory
   use amontons_taken, only: taken_t
   use amontons_terminal, only: phase_assemble, phase_condense, phase_factorize, timings_t
   use amontons_text, only: place_text
   implicit none (type, external)
   private

   public :: body_t, condense_body, estimate_body, estimate_t, find_motions, find_rigid_modes, lock_motions, new_body

   !> A motion that no contact law acts on: a component of the motion of a rigid set, or the jump of a preload. It is an
   !> unknown of a node. The nodal forces of a unit of the driving force do work on this motion alone.
   type :: driven_motion_t
      character(longest_name) :: name = '' !! name of the rigid set or preload
      character(16) :: words(2) = '' !! names of the motion and of its force, as 'ux' and 'force_x'
      character(7) :: kind = '' !! rigid or preload
      character(3) :: dimensions(2) = '' !! their dimensions
      integer :: support = 0 !! number of the support that may prescribe it
      integer :: component = 0 !! index among the components of the support, and among force and moment of the load
      real(dp) :: lock_time = huge(1.0_dp) !! when a history locks it; huge where it cannot be locked [-]
      integer :: lead = 0 !! the node
      integer :: axis = 1 !! of a rigid set which of the node's own unknowns it is
      integer :: tie = 0 !! of a preload the tie
      real(dp) :: own(3) = 0.0_dp !! own unknowns of the node in a motion of 1
      real(dp) :: length = 1.0_dp !! displacement of nodes in a motion of 1 [L]
      integer, allocatable :: node(:) !! the nodes that its force acts on
      real(dp), allocatable :: force(:, :) !! the nodal forces of a force of 1 (components, nodes) [-]
   end type driven_motion_t

   !> A body, which many load cases share; constant once it is condensed.
   type, extends(meshed_body_t) :: body_t
      character(:), allocatable :: mesh_notes !! repairs by its reader, a line of text for each
      type(spring_side_t), allocatable :: springs(:) !! springs along sides
      real(dp) :: size = 0.0_dp !! its larger extent along x and y [L]
      logical :: is_axisymmetric = .false. !! whether it is a body of revolution
      type(coloring_t) :: coloring !! colors of the elements
      type(rigid_motions_t), allocatable :: motions(:) !! the rigid motions of each piece that the supports leave free
      real(dp), allocatable :: rigid_modes(:, :)
         !! displacements (u_N; u_T) of the contact points under each of these (n_rows, motions) [-]
      real(dp), allocatable :: travel(:, :)
         !! displacements of the contact points under those of them that strain nothing, of each piece orthonormal
         !! (n_rows, any) [-]
      real(dp), allocatable :: common_motions(:, :)
         !! combinations of these motions that no contact point notices (motions, any) [-]
      logical :: is_motion_strained = .false. !! whether a free motion strains bonded pieces or meets supports a little
      type(contact_zone_t) :: zone !! the contact points; where they slide far, at their present places
      type(contact_zone_t) :: retained
         !! the points that the body is condensed to: the contact points, or the nodes of sets that slide far
      logical :: slides_far = .false. !! whether the contact points slide far
      type(contact_zone_t), allocatable :: zone_at_rest !! the contact points at rest, where they slide far
      integer, allocatable :: contact_node(:) !! the nodes of contact sets, where they slide far
      type(turning_piece_t), allocatable :: may_turn(:)
         !! the pieces that may turn far, where they slide far; the rigid sets of the first ones count as held
      type(turning_piece_t), allocatable :: turning(:) !! those of them that the loads let turn, from `new_load_case`
      type(rigid_motions_t), allocatable :: unheld(:)
         !! the rigid motions that supports leave free with those of these rigid sets; allocated where some may turn
      real(dp), allocatable :: flexibility(:, :)
         !! inverse of S on the retained points, where the points slide far; of a body with free motions that of S and a
         !! multiple of their squares (retained rows, retained rows) [L/F]
      type(free_boundary_t) :: free_boundary !! the boundary beyond the ends of the contact sets
      real(dp), allocatable :: inf_sup(:) !! inf-sup constant of each contact set; 1 with nodal multipliers [-]
      type(mortar_pair_t), allocatable :: ties(:) !! the surfaces that are bonded
      integer, allocatable :: partner(:)
         !! the node that each node shares its contact points with: itself, or that which it is joined to (n_nodes)
      type(contact_rows_t) :: checked_rows !! the rows of the points, those of pairs integrated on another way
      real(dp), allocatable :: gap_change(:) !! how much larger the meshes' gaps are on that way (m) [L]
      type(contact_rows_t) :: tie_rows !! the rows of the points of all ties, one tie after the other
      type(contact_rows_t) :: checked_tie_rows !! these rows, integrated on another way
      type(named_forces_t), allocatable :: named(:) !! contact sets, supports and ties that exert forces on it, by name
      type(driven_motion_t), allocatable :: driven(:) !! the motions of rigid sets, and jumps of preloads
      integer, allocatable :: lockable(:) !! those of them that a history may lock
      type(dof_map_t) :: dof_map !! numbers of the unknowns
      type(condensation_t) :: condensation !! the factorized stiffness, after `condense_body`
      type(recovery_tables_t), allocatable :: recovery !! tables for error estimates, after `prepare_estimates`
   contains
      procedure :: driven_field => body_driven_field
      procedure :: driven_forces => body_driven_forces
      procedure :: internal_forces => body_internal_forces
   end type body_t

   !> Estimate of time and memory that the condensation of a body takes.
   type :: estimate_t
      character(:), allocatable :: factorization !! the kind of factorization
      integer(int64) :: n_entries = 0 !! entries of the factor
      integer :: n_rows = 0 !! rows of the matrix that the contact problem is solved on
      integer :: n_ranks = 1 !! number of ranks that the body is spread over
      integer :: half_width = 0 !! number of its subdiagonals if it is a band matrix of the whole body, else 0
      real(dp) :: memory_mb = 0.0_dp !! the most memory the program would hold, of several ranks each at most [MB]
      real(dp) :: available_mb = 0.0_dp !! the memory there is for it, what it holds already included [MB]
   end type estimate_t

contains

   !> Makes a body from its mesh, materials, supports and contact sets, without assembly and factorization.
   subroutine new_body(body, mesh, materials, supports, contacts, error, ties)
      type(body_t), intent(out) :: body !! the body
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(material_t), intent(in) :: materials(:) !! its materials
      type(support_t), intent(in) :: supports(:) !! its supports
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      type(error_t), allocatable, intent(out) :: error !! mesh, supports or contact sets do not fit together
      type(tie_t), intent(in), optional :: ties(:) !! its bonded sets; none without them
      type(substitution_t) :: substitution
      real(dp), allocatable :: prescribed(:, :), joined_area(:)
      type(tie_t), allocatable :: all_ties(:)
      type(taken_t) :: tied
      type(mortar_points_t) :: points
      type(meshed_body_t) :: joined
      integer :: nothing(0), i
      ! Rounding errors are about the square root of the precision; a few digits to spare.
      real(dp), parameter :: dependent = 1.0e-6_dp
      ! Gaps are differences of coordinates: some tens of their rounding errors.
      real(dp), parameter :: rounding = 1.0e-14_dp

      call mesh%check(error)
      if (allocated(error)) return
      allocate (all_ties(0))
      if (present(ties)) all_ties = ties
      body%mesh = mesh
      body%size = maxval(maxval(mesh%coordinates, dim=2) - minval(mesh%coordinates, dim=2))
      body%outer = outer_sides(mesh)
      body%mesh_notes = ''
      call new_materials(body%materials, materials, mesh, error)
      if (allocated(error)) return
      call new_coloring(body%coloring, mesh)
      call new_foundation(body%springs, mesh, body%materials, supports, error)
      if (allocated(error)) return
      call new_constraints(body%constraints, prescribed, mesh, supports, error, body%materials)
      if (.not. allocated(error)) call check_rigid_sets(body%meshed_body_t, error, all_ties)
      if (allocated(error)) return
      body%is_axisymmetric = materials(1)%is_axisymmetric
      call new_tied_pairs(body%ties, tied, all_ties, body%meshed_body_t, error)
      if (allocated(error)) return
      call join_corners(body%ties, body%partner, joined_area, contacts, body%meshed_body_t)
      call set_preload_jumps(body, supports, all_ties)
      call add_rigid_drives(body, supports)
      joined = body%meshed_body_t
      joined%mesh%node = body%partner(mesh%node)
      call check_sliding(body%meshed_body_t, contacts, error)
      if (allocated(error)) return
      call new_contact_zone(body%zone, joined, contacts, error, tied)
      if (allocated(error)) return
      body%slides_far = any(contacts%slides_far())
      call new_free_boundary(body%free_boundary, body%meshed_body_t, pack(contacts, .not. body%slides_far), body%zone, &
         body%ties)
      call recompute_pairs(body%checked_rows, body%gap_change, body%zone)
      where (abs(body%gap_change) <= rounding*maxval(abs(mesh%coordinates))) body%gap_change = 0.0_dp
      call body%tie_rows%begin(nothing, 1 + body%zone%n_tangents)
      call body%checked_tie_rows%begin(nothing, 1 + body%zone%n_tangents)
      do i = 1, size(body%ties)
         call integrate_pair(points, body%ties(i), body%ties(i)%segments, is_again=.false.)
         call body%tie_rows%add(points%rows)
         if (ties(i)%has_jump) call add_jump_drive(body, supports, ties(i)%name, i, points)
         call integrate_pair(points, body%ties(i), segments_again(body%ties(i)), is_again=.true.)
         call body%checked_tie_rows%add(points%rows)
      end do
      call choose_retained(body, substitution, contacts, joined_area, error)
      if (allocated(error)) return
      call hold_turning_sets(body)
      call set_motions(body)
      call number_unknowns(body, substitution, error)
      if (allocated(error)) return
      if (body%dof_map%n_dofs == 0) then
         call new_error(error, input_refused, 'the supports prescribe the displacements of all nodes: nothing is '// &
            'left to compute')
         return
      end if
      ! Cells that the displacements of the mesh cannot distinguish are refused.
      allocate (body%inf_sup(size(contacts)), source=1.0_dp)
      do i = 1, size(contacts)
         if (.not. contacts(i)%partition%is_constant .or. all(body%zone%set /= i)) cycle
         body%inf_sup(i) = inf_sup_constant(body%zone, i, contacts(i)%set, joined)
         if (body%inf_sup(i) > dependent) cycle
         call new_error(error, input_refused, contacts(i)%origin//'the cells of the constant multipliers are too '// &
            'small: the displacements of this mesh cannot tell them apart; make them at least two sides long')
         return
      end do
      call name_forces(body%named, supports, contacts, all_ties, error)
   end subroutine new_body

   !> Which free motions strain something: those that rotate pieces whose ties lie apart, or meet supports a little
   !> (motions). The jump of a free preload strains nothing.
   function strained_motions(body) result(is_strained)
      type(body_t), intent(in) :: body !! the body, with its free motions
      logical :: is_strained(sum(body%motions%n_free))
      ! Of motions by about 1: rounding errors of coordinates, of matching surfaces too, are smaller.
      real(dp), parameter :: negligible = 1.0e-10_dp
      type(rigid_motions_t) :: without_jumps(size(body%motions))
      real(dp) :: only(size(is_strained))
      real(dp), allocatable :: moved(:, :)
      integer, allocatable :: held(:)
      integer :: i, k

      without_jumps = body%motions
      do k = 1, size(without_jumps)
         associate (n => without_jumps(k)%n_motions)
            without_jumps(k)%mode(n + 1:n + without_jumps(k)%n_jumps, :) = 0.0_dp
         end associate
      end do
      held = pack([(i, i=1, body%mesh%n_nodes)], body%constraints%rigid_of == 0 .and. &
         .not. all(body%constraints%is_free, dim=1))
      do k = 1, size(is_strained)
         only = [(merge(1.0_dp, 0.0_dp, i == k), i=1, size(only))]
         moved = displacement_of_nodes(body%motions, body%mesh%coordinates, only)
         is_strained(k) = any([(any(abs(matmul(moved(:, held(i)), body%constraints%frame(:, :, held(i)))) &
            > negligible .and. .not. body%constraints%is_free(:, held(i))), i=1, size(held))])
         if (size(body%ties) == 0 .or. body%is_axisymmetric) cycle
         moved = displacement_of_nodes(without_jumps, body%mesh%coordinates, only)
         is_strained(k) = is_strained(k) .or. any(abs(body%tie_rows%displacement(moved)) > negligible)
      end do
   end function strained_motions

   !> Chooses the points that the body is condensed to, and makes displacements of slaves sums of others.
   subroutine choose_retained(body, substitution, contacts, joined_area, error)
      type(body_t), intent(inout) :: body !! the body, its contact points and ties found
      type(substitution_t), intent(out) :: substitution !! displacements of the nodes in terms of the unknowns
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      real(dp), intent(in) :: joined_area(:) !! areas of nodes that share contact points (n_nodes) [L^2]
      type(error_t), allocatable, intent(out) :: error !! slaves that do not go together; sets that cannot slide far
      integer :: nothing(0)

      associate (zone => body%zone, x => body%mesh%coordinates)
         if (.not. body%slides_far) then
            call new_pair_substitution(substitution, body%ties, zone%pairs, zone%rows%picked(zone%mean_point), &
               zone%frame(:, :, zone%mean_point), body%constraints, x, error)
            if (allocated(error)) return
            call share_parts(zone%rows, body%partner, joined_area)
            call let_guided_slaves_slip(zone, body%constraints, substitution)
            body%retained = zone
         else
            call new_retained_zone(body%retained, body%contact_node, zone, body%constraints, x)
            call check_retained(body%retained, body%meshed_body_t, body%ties, contacts, error)
            if (.not. allocated(error)) call new_pair_substitution(substitution, body%ties, zone%pairs(:0), &
               zone%rows%picked(nothing), zone%frame(:, :, nothing), body%constraints, x, error)
            body%zone_at_rest = zone
         end if
      end associate
   end subroutine choose_retained

   !> Finds the pieces of a plane body that may turn far, and holds their rigid sets: in the frame of its piece a set is
   !> at rest.
   subroutine hold_turning_sets(body)
      type(body_t), intent(inout) :: body !! the body; gains the pieces
      type(rigid_motions_t), allocatable :: motions(:)
      integer :: i, k

      allocate (body%may_turn(0), body%turning(0))
      if (.not. body%slides_far .or. body%is_axisymmetric .or. size(body%mesh%coordinates, 1) == 3) return
      call find_motions(motions, body, body%constraints, body%springs)
      call find_turning_pieces(body%may_turn, motions, body%constraints, body%springs, body%mesh%coordinates, &
         body%contact_node)
      ! A motion that is locked later is an unknown.
      body%may_turn = pack(body%may_turn, [(all(body%driven%lock_time >= huge(1.0_dp) .or. all(spread( &
         body%driven%lead, 2, size(body%may_turn(k)%node)) /= spread(body%may_turn(k)%node, 1, size(body%driven)), &
         dim=2)), k=1, size(body%may_turn))])
      do k = 1, count(body%may_turn%rigid > 0)
         associate (piece => body%may_turn(k), rigid => body%constraints%rigid(body%may_turn(k)%rigid))
            do i = 1, 3
               piece%driven(i) = findloc(body%driven%kind == 'rigid' .and. body%driven%lead == rigid%lead(i) .and. &
                  body%driven%component == rigid%component(i), .true., dim=1)
               body%constraints%is_free(rigid%axis(i), rigid%lead(i)) = .false.
            end do
         end associate
      end do
      if (any(body%may_turn%rigid > 0)) call move_alloc(motions, body%unheld)
   end subroutine hold_turning_sets

   !> Refuses rigid sets that share nodes with the slave of a tie, which could follow only one of them.
   subroutine check_rigid_sets(body, error, ties)
      type(meshed_body_t), intent(in) :: body !! mesh and supports
      type(error_t), allocatable, intent(out) :: error !! there is such a node
      type(tie_t), intent(in) :: ties(:) !! the bonded sets
      type(error_t), allocatable :: fault
      integer, allocatable :: nodes(:)
      integer :: i, k

      do i = 1, size(ties)
         call body%mesh%set_nodes(ties(i)%set, nodes, fault)
         ! A missing set is reported later.
         if (allocated(fault)) return
         k = findloc(body%constraints%rigid_of(nodes) > 0, .true., dim=1)
         if (k == 0) cycle
         call new_error(error, input_refused, ties(i)%origin//"set '"//ties(i)%set//"' shares the node at "// &
            place_text(body%mesh%coordinates(:, nodes(k)))//' with a rigid set that moves it already; exchange set '// &
            'and to')
         return
      end do
   end subroutine check_rigid_sets

   !> Makes the jumps of preloads free or prescribed, as in the supports of the preloads, and turns a free axis of the
   !> leading nodes along each jump.
   pure subroutine set_preload_jumps(body, supports, ties)
      type(body_t), intent(inout) :: body !! the body, its ties found
      type(support_t), intent(in) :: supports(:) !! the supports
      type(tie_t), intent(in) :: ties(:) !! the bonded sets
      integer, allocatable :: free(:)
      integer :: i, k, n_dim

      n_dim = size(body%mesh%coordinates, 1)
      do i = 1, size(ties)
         if (.not. ties(i)%has_jump) cycle
         associate (pair => body%ties(i))
            pair%is_jump_free = .not. supports(support_of_jump(supports, ties(i)%name))%is_held(1)
            free = pack([(k, k=1, n_dim)], body%constraints%is_free(:n_dim, pair%lead))
            associate (frame => body%constraints%frame(:n_dim, free, pair%lead))
               if (size(free) > 1) body%constraints%frame(:n_dim, free, pair%lead) = matmul(frame, &
                  new_frame(matmul(pair%jump(:n_dim), frame), size(free)))
            end associate
         end associate
      end do
   end subroutine set_preload_jumps

   !> Number of the support that prescribes the jump of a preload.
   pure integer function support_of_jump(supports, name) result(number)
      type(support_t), intent(in) :: supports(:) !! the supports
      character(*), intent(in) :: name !! name of the preload

      do number = 1, size(supports)
         if (supports(number)%is_jump .and. supports(number)%name == name) exit
      end do
   end function support_of_jump

   !> Adds the motions of rigid sets to the driven motions. In a body of revolution they move along the axis and,
   !> if it is twisted, turn about it.
   pure subroutine add_rigid_drives(body, supports)
      type(body_t), intent(inout) :: body !! the body; gains the motions
      type(support_t), intent(in) :: supports(:) !! the supports
      character(8), parameter :: drives(size(rigid_components)) = [character(8) :: 'force_x', 'force_y', 'force_z', &
         'moment_x', 'moment_y', 'moment_z']
      type(driven_motion_t) :: driven
      real(dp), allocatable :: unit(:)
      integer :: i, k, last, n, number
      logical, allocatable :: moves(:)

      moves = .not. body%is_axisymmetric .or. [.false., .true., body%materials%is_twisted()]
      if (size(body%mesh%coordinates, 1) == 3) moves = [(.true., k=1, size(rigid_components))]
      allocate (body%driven(count(moves)*size(body%constraints%rigid)))
      number = 0
      last = 0
      do i = 1, size(supports)
         if (.not. supports(i)%rigid%is_given) cycle
         number = number + 1
         associate (rigid => body%constraints%rigid(number))
            do k = 1, size(moves)
               if (.not. moves(k)) cycle
               driven%name = supports(i)%name
               driven%kind = 'rigid'
               driven%support = i
               driven%component = rigid%component(k)
               driven%words = [character(16) :: rigid_components(driven%component), drives(driven%component)]
               ! The plane has one turn.
               if (size(moves) == 3 .and. k == 3) driven%words = [character(16) :: 'turn', 'moment']
               driven%dimensions = merge(['   ', 'F L'], ['L  ', 'F  '], driven%component > 3)
               driven%length = merge(rigid%length, 1.0_dp, driven%component > 3)
               driven%lock_time = merge(huge(1.0_dp), supports(i)%lock_time, supports(i)%is_held(driven%component))
               driven%lead = rigid%lead(k)
               driven%axis = rigid%axis(k)
               driven%own = merge(driven%length, 0.0_dp, [1, 2, 3] == driven%axis)
               driven%node = rigid%carrier
               unit = [(0.0_dp, n=1, size(moves))]
               unit(k) = 1.0_dp
               driven%force = rigid%carrier_forces(unit)
               last = last + 1
               body%driven(last) = driven
            end do
         end associate
      end do
   end subroutine add_rigid_drives

   !> Adds the jump of a preload to the driven motions. Its force is a uniform pressure on both sides.
   pure subroutine add_jump_drive(body, supports, name, tie, points)
      type(body_t), intent(inout) :: body !! the body; gains the motion
      type(support_t), intent(in) :: supports(:) !! the supports
      character(*), intent(in) :: name !! name of the preload
      integer, intent(in) :: tie !! number of the tie that its two sides are
      type(mortar_points_t), intent(in) :: points !! their points
      type(driven_motion_t) :: driven
      real(dp), allocatable :: force(:, :)
      real(dp) :: share(size(body%constraints%is_free, 1)*size(points%area))
      integer :: i, p

      driven%support = support_of_jump(supports, name)
      share = 0.0_dp
      associate (pair => body%ties(tie))
         do p = 1, size(points%area)
            share(p::size(points%area)) = -points%area(p)/sum(points%area) &
               *matmul(pair%jump(:size(pair%frame, 1)), pair%frame(:, :, p))
         end do
         driven%lead = pair%lead
         driven%own = pair%jump
      end associate
      force = points%rows%forces(share, body%mesh%n_nodes)
      driven%name = name
      driven%kind = 'preload'
      driven%words = [character(16) :: 'shortening', 'force']
      driven%dimensions = ['L', 'F']
      driven%component = 1
      driven%tie = tie
      driven%lock_time = merge(huge(1.0_dp), supports(driven%support)%lock_time, supports(driven%support)%is_held(1))
      driven%node = pack([(i, i=1, size(force, 2))], any(abs(force) > 0.0_dp, dim=1))
      driven%force = force(:, driven%node)
      body%driven = [body%driven, driven]
   end subroutine add_jump_drive

   !> The forces of loads on the driven motions (motions) [F, F L].
   pure function body_driven_forces(self, loads) result(force)
      class(body_t), intent(in) :: self !! the body
      type(load_t), intent(in) :: loads(:) !! the loads
      real(dp), allocatable :: force(:)
      real(dp) :: given(size(rigid_components))
      integer :: i, k

      allocate (force(size(self%driven)), source=0.0_dp)
      do i = 1, size(loads)
         if (loads(i)%target /= load_on_motion) cycle
         given = [loads(i)%force, loads(i)%moment]
         do k = 1, size(force)
            if (self%driven(k)%name == loads(i)%name) force(k) = force(k) + given(self%driven(k)%component)
         end do
      end do
   end function body_driven_forces

   !> The displacements of all nodes for a unit of one driven motion (components, n_nodes) [L].
   pure function body_driven_field(self, number) result(field)
      class(body_t), intent(in) :: self !! the body
      integer, intent(in) :: number !! index of the motion
      real(dp), allocatable :: field(:, :)

      allocate (field(size(self%constraints%is_free, 1), self%mesh%n_nodes), source=0.0_dp)
      field(:, self%driven(number)%lead) = self%driven(number)%own(:size(field, 1))
      field = self%dof_map%substitution%displacement(field)
   end function body_driven_field

   !> Numbers the unknowns: first the interior, then the contact points, last the motions that a history may lock.
   pure subroutine number_unknowns(body, substitution, error)
      type(body_t), intent(inout) :: body !! the body; gains the numbers
      type(substitution_t), intent(in) :: substitution !! displacements of the nodes in terms of the unknowns
      type(error_t), allocatable, intent(out) :: error !! cells of constant multipliers move with what may be locked
      integer, allocatable :: own(:), leads(:)
      integer :: i

      body%lockable = pack([(i, i=1, size(body%driven))], body%driven%lock_time < huge(1.0_dp))
      own = body%retained%own_nodes(substitution)
      allocate (leads(0))
      do i = 1, size(body%lockable)
         associate (driven => body%driven(body%lockable(i)))
            if (all(leads /= driven%lead)) leads = [leads, driven%lead]
            ! Otherwise the prescribed motion would be part of the displacements of contact points.
            if (any(own == driven%lead)) call new_error(error, input_refused, 'lock_time: contact acts on nodes '// &
               "that '"//trim(driven%name)//"' moves itself; keep them apart")
         end associate
      end do
      call new_dof_map(body%dof_map, body%constraints, [own, leads], substitution)
      body%dof_map%n_lockable = size(body%lockable)
   end subroutine number_unknowns

   !> Locks driven motions at their prescribed values, or frees them. The factorization remains valid.
   subroutine lock_motions(body, problem, is_locked, error)
      type(body_t), intent(inout) :: body !! the body, condensed
      type(contact_problem_t), intent(out) :: problem !! its contact problem; a load case sets load, gap and friction
      logical, intent(in) :: is_locked(:) !! whether each of the lockable motions is locked
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer :: i

      do i = 1, size(is_locked)
         associate (driven => body%driven(body%lockable(i)))
            if (driven%tie > 0) then
               body%ties(driven%tie)%is_jump_free = .not. is_locked(i)
            else
               body%constraints%is_free(driven%axis, driven%lead) = .not. is_locked(i)
            end if
         end associate
      end do
      call set_motions(body)
      body%condensation%is_held = all(body%motions%n_free == 0)
      body%condensation%is_locked = is_locked
      call pose_body(body, problem, error)
   end subroutine lock_motions

   !> Finds the rigid motions that supports and locks leave free, and how contact points move under them.
   subroutine set_motions(body)
      type(body_t), intent(inout) :: body !! the body, its contact points found
      logical, allocatable :: is_strained(:)
      real(dp), allocatable :: travel(:, :)
      integer :: first, i, k, last, n

      call find_motions(body%motions, body, body%constraints, body%springs)
      call find_rigid_modes(body%rigid_modes, body%retained, body%motions, body%mesh%coordinates, is_mated=.false.)
      body%common_motions = resting_motions(body%rigid_modes)
      is_strained = strained_motions(body)
      body%is_motion_strained = any(is_strained)
      allocate (travel(body%retained%n_rows, size(is_strained)))
      last = 0
      n = 0
      do i = 1, size(body%motions)
         first = last + 1
         last = last + body%motions(i)%n_free
         associate (own => orthonormal_modes(body%rigid_modes(:, pack([(k, k=first, last)], &
            .not. is_strained(first:last)))))
            travel(:, n + 1:n + size(own, 2)) = own
            n = n + size(own, 2)
         end associate
      end do
      body%travel = travel(:, :n)
   end subroutine set_motions

   !> Finds the rigid motions that supports leave free, or a part of them, with the free jumps of preloads.
   subroutine find_motions(motions, body, constraints, springs)
      type(rigid_motions_t), allocatable, intent(out) :: motions(:) !! the motions of each piece
      class(body_t), intent(in) :: body !! the body
      type(constraints_t), intent(in) :: constraints !! its supports, or those of them that count
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      integer :: i, n

      n = size(body%mesh%coordinates, 1)
      call new_rigid_motions(motions, body%mesh, body%outer, constraints, springs, body%is_axisymmetric, &
         bonds_of(body%ties, constraints), &
         reshape([(body%ties(i)%jump(:n), i=1, size(body%ties))], [n, size(body%ties)]))
   end subroutine find_motions

   !> Assembles and factorizes the stiffness and condenses it to the contact points; the clock is left in the phase of
   !> condensing.
   subroutine condense_body(body, problem, options, timings, error)
      type(body_t), intent(inout) :: body !! the body, from `new_body`
      type(contact_problem_t), intent(out) :: problem
         !! its contact problem, on an operator of the body; a load case sets load, gap and friction
      type(condensation_options_t), intent(in) :: options !! options of the condensation
      type(timings_t), intent(inout) :: timings !! gains the time of each step
      type(error_t), allocatable, intent(out) :: error !! the body is not held, or its stiffness is degenerate
      type(sparse_matrix_t) :: stiffness
      class(condenser_t), allocatable :: condenser
      type(condensation_options_t) :: suited
      logical :: is_held

      call timings%begin(phase_assemble)
      call check_held(body, error)
      if (allocated(error)) return
      is_held = all(body%motions%n_free == 0)
      suited = suited_options(body, options)
      if (is_distributed(body, suited)) then
         call timings%begin(phase_factorize)
         call new_distributed_condenser(condenser, is_held, body%mesh, body%materials, body%springs, &
            body%constraints, body%dof_map, error)
         if (allocated(error)) return
         call new_distributed_condensation(body%condensation, condenser, is_held, body%retained, body%constraints, &
            body%dof_map, error)
      else
         call assemble_stiffness(stiffness, body%mesh, body%materials, body%springs, body%coloring, &
            body%constraints, body%dof_map, error)
         if (allocated(error)) return
         call timings%begin(phase_factorize)
         call new_condensation(body%condensation, stiffness, suited, is_held, body%retained, body%constraints, &
            body%dof_map, error)
      end if
      if (allocated(error)) call explain_refusal(body, error)
      if (allocated(error)) return
      call timings%begin(phase_condense)
      call pose_body(body, problem, error)
   end subroutine condense_body

   !> Makes the contact problem of a factorized body, without load.
   subroutine pose_body(body, problem, error)
      type(body_t), intent(inout) :: body !! the body
      type(contact_problem_t), intent(out) :: problem !! its contact problem, on an operator of the body
      type(error_t), allocatable, intent(out) :: error !! no room for S, or the cells of multipliers are too small
      real(dp), allocatable :: force(:), motion(:)
      integer :: most_motions, i

      if (size(body%common_motions, 2) > 0) body%condensation%unnoticed = contact_motions(body)
      call body%condensation%condense_stiffness(error)
      if (allocated(error)) return
      call new_contact_problem(problem, body%condensation%matrix)
      if (allocated(body%condensation%softness)) problem%softness = body%condensation%softness
      ! Free motions cause no strain: their product with S is the rounding error of the condensation of stiff bodies.
      allocate (force(body%retained%n_rows))
      ! The products of all pieces are summed.
      most_motions = maxval(body%motions%n_motions)
      do i = 1, min(most_motions, size(body%travel, 2))
         motion = sum(body%travel(:, i::most_motions), dim=2)
         call problem%matrix%multiply_stiffness(motion, force)
         if (any(abs(motion) > 0.0_dp)) problem%rounding = max(problem%rounding, maxval(abs(force)) &
            /maxval(abs(motion)))
      end do
      if (body%slides_far) call new_flexibility(body%flexibility, problem%matrix, body%retained%n_points, body%travel, &
         error)
   end subroutine pose_body

   !> The displacements of the contact unknowns under the free motions that leave all contact points at rest (n_schur,
   !> any) [-].
   pure function contact_motions(body) result(motions)
      type(body_t), intent(in) :: body !! the body
      real(dp), allocatable :: motions(:, :)
      real(dp), allocatable :: moved(:, :), own(:, :)
      logical :: is_at_rest(body%mesh%n_nodes)
      type(mortar_pair_t), allocatable :: pairs(:)
      integer :: axis, i, k, row

      ! The unknown of a node may be the displacement of its point, or the jump of a tie.
      is_at_rest = .false.
      is_at_rest(body%retained%rows%node(body%retained%rows%start(body%retained%mean_point))) = .true.
      pairs = [body%ties, body%retained%pairs]
      do i = 1, size(pairs)
         if (allocated(pairs(i)%segments) .and. .not. allocated(pairs(i)%cells)) is_at_rest(pairs(i)%node) = .true.
      end do
      allocate (motions(body%dof_map%n_schur - body%dof_map%n_lockable, size(body%common_motions, 2)), source=0.0_dp)
      do k = 1, size(motions, 2)
         moved = displacement_of_nodes(body%motions, body%mesh%coordinates, body%common_motions(:, k))
         own = merge(0.0_dp, moved, spread(is_at_rest, 1, size(moved, 1)))
         ! Middle nodes count from the corners beside them, which go with the other body: pair by pair.
         do i = 0, size(pairs)
            own = merge(own, own + moved - body%dof_map%substitution%displacement(own), &
               spread(is_at_rest, 1, size(moved, 1)))
         end do
         do i = 1, size(body%constraints%rigid)
            associate (rigid => body%constraints%rigid(i))
               own(:, rigid%carrier(:2)) = rigid%own_unknowns(moved(:, rigid%carrier))
            end associate
         end do
         do i = 1, size(own, 2)
            own(:, i) = matmul(own(:, i), body%constraints%frame(:, :, i))
            do axis = 1, size(own, 1)
               row = body%dof_map%dof(axis, i) - body%dof_map%n_dofs + body%dof_map%n_schur
               if (row > 0 .and. row <= size(motions, 1)) motions(row, k) = own(axis, i)
            end do
         end do
      end do
   end function contact_motions

   !> The options of the condensation as a body needs them: where contact slides far S is inverted, as a dense matrix.
   pure type(condensation_options_t) function suited_options(body, options) result(suited)
      type(body_t), intent(in) :: body !! the body
      type(condensation_options_t), intent(in) :: options !! the deck's

      suited = options
      if (body%slides_far) suited%form = 'dense'
   end function suited_options

   !> Whether a body is spread over the ranks of the run. Small bodies are faster on one rank; band matrices stay on
   !> rank 0; and a body without unknowns other than those of the contact points has nothing to spread.
   pure logical function is_distributed(body, options)
      type(body_t), intent(in) :: body !! the body
      type(condensation_options_t), intent(in) :: options !! options of the condensation
      ! Above the size for which a band factorization is considered.
      integer, parameter :: least_unknowns = 10000

      associate (n => body%dof_map%n_dofs)
         is_distributed = body%dof_map%n_schur < n .and. (options%factorization == 'distributed' .or. &
            (options%factorization == 'auto' .and. n_ranks > 1 .and. n > least_unknowns .and. &
            .not. may_suit_band(n, options%form, body%retained)))
      end associate
   end function is_distributed

   !> Nodal forces of the stresses and springs under a displacement field, K u - f_th, computed without assembling K.
   subroutine body_internal_forces(self, forces, displacement, element_load)
      class(body_t), intent(in) :: self !! the body
      real(dp), allocatable, intent(out) :: forces(:, :) !! nodal forces (components, n_nodes) [F]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in), optional :: element_load(:)
         !! what acts inside the elements, from `sum_element_loads` [-], [L]

      call forces_of_stress(forces, self%mesh, self%materials, self%springs, self%coloring, displacement, &
         element_load)
   end subroutine body_internal_forces

   !> Refuses a body with a piece that neither supports nor contact points hold, or the loose end of a free preload, and
   !> pieces that contact holds only to each other.
   subroutine check_held(body, error)
      type(body_t), intent(in) :: body !! the body
      type(error_t), allocatable, intent(out) :: error !! nothing holds a piece; names a motion
      ! Of displacements in a motion that moves the body by about 1: a slender body moves its end by little as it turns.
      real(dp), parameter :: rounding = 1.0e-13_dp
      logical :: may_touch(body%mesh%n_nodes)
      real(dp), allocatable :: amounts(:, :)
      integer :: i

      if (body%slides_far .and. body%is_motion_strained) then
         call new_error(error, input_refused, "sliding = 'finite': a free motion strains bonded pieces or meets "// &
            'supports a little; hold the body by supports')
         return
      end if
      may_touch = .false.
      may_touch(body%retained%rows%node) = .true.
      do i = 1, size(body%motions)
         associate (motions => body%motions(i))
            if (motions%n_free == 0 .or. any(may_touch(motions%node))) cycle
            call new_error(error, no_equilibrium, motions%describe([1.0_dp, &
               spread(0.0_dp, 1, motions%n_free - 1)])//': nothing holds it; add a support or a contact set')
            return
         end associate
      end do
      if (size(body%common_motions, 2) == 0) return
      ! The contact points may be at rest while nodes of their sets move: cells have means.
      associate (at_nodes => contact_motions(body))
         amounts = resting_motions(at_nodes)
         if (size(amounts, 2) == 0) return
         if (maxval(abs(matmul(at_nodes, amounts(:, 1)))) > rounding) return
      end associate
      if (any(body%zone%pairs%is_set())) then
         call new_error(error, no_equilibrium, 'nothing holds the bodies together against a common motion: '// &
            largest_motion(body%motions, matmul(body%common_motions, amounts(:, 1)))// &
            '; contact between them cannot; add a support')
      else
         call new_error(error, no_equilibrium, largest_motion(body%motions, matmul(body%common_motions, &
            amounts(:, 1)))//': nothing holds it; add a support or a contact set')
      end if
   end subroutine check_held

   !> Puts a place and likely reasons into the error of a refused factor.
   subroutine explain_refusal(body, error)
      type(body_t), intent(in) :: body !! the body, its factorization refused
      type(error_t), intent(inout) :: error !! gains the words; unchanged if memory ran out
      integer :: place(2)

      if (.not. allocated(body%condensation%condenser)) return
      associate (condenser => body%condensation%condenser)
         if (condenser%refused_unknown == 0) return
         place = findloc(body%dof_map%dof, condenser%refused_unknown)
         error%message = 'the stiffness is singular to rounding at the node '// &
            place_text(body%mesh%coordinates(:, place(2)))//conditioning_text(body%mesh, body%materials, body%springs)
      end associate
   end subroutine explain_refusal

   !> Estimates time and memory: assembles the stiffness and finds the order of elimination, but computes no factor. In
   !> an MPI run rank 0 holds the most memory besides the factor.
   subroutine estimate_body(body, options, n_dense, timings, estimate, error)
      type(body_t), intent(in) :: body !! the body
      type(condensation_options_t), intent(in) :: options !! options of the condensation
      integer, intent(in) :: n_dense
         !! number of dense matrices of the contact points that the method holds; 0 if it needs none
      type(timings_t), intent(inout) :: timings !! gains the time of assembly
      type(estimate_t), intent(out) :: estimate !! the estimate
      type(error_t), allocatable, intent(out) :: error !! the body is not held, or too large for the memory
      type(sparse_matrix_t) :: stiffness
      class(cholesky_t), allocatable :: cholesky
      class(condenser_t), allocatable :: condenser
      type(condensation_options_t) :: suited
      integer, allocatable :: order(:)
      ! Measured on 20 000 points: a row of the table, of the listing and of the grid, as numbers and as text [MB].
      real(dp), parameter :: of_point = 1.1e-3_dp
      real(dp) :: n_entries

      call check_held(body, error)
      if (allocated(error)) return
      call timings%begin(phase_assemble)
      estimate%n_rows = body%retained%n_rows
      suited = suited_options(body, options)
      if (is_distributed(body, suited)) then
         estimate%n_ranks = n_ranks
         call timings%begin(phase_factorize)
         call new_distributed_condenser(condenser, all(body%motions%n_free == 0), body%mesh, body%materials, &
            body%springs, body%constraints, body%dof_map, error)
         if (allocated(error)) return
      else
         call assemble_stiffness(stiffness, body%mesh, body%materials, body%springs, body%coloring, &
            body%constraints, body%dof_map, error)
         if (allocated(error)) return
         call timings%begin(phase_factorize)
         call find_band_order(stiffness, suited%form, body%retained, order)
         if (allocated(order)) then
            estimate%half_width = half_bandwidth(stiffness, order)
            estimate%n_rows = stiffness%n
         end if
         call new_cholesky(cholesky, trim(suited%factorization), stiffness, &
            merge(0, body%dof_map%n_schur, allocated(order)), error)
         if (allocated(error)) return
         call move_alloc(cholesky, condenser)
         stiffness = sparse_matrix_t()
      end if
      call return_memory()
      estimate%factorization = condenser%name
      estimate%n_entries = condenser%n_factor_entries
      ! The contact problem: dense matrices, of contact points, of a step for Newton's method, of nodes behind cells,
      ! the flexibility and that of a body; of a band the matrix and its factor, both twice, and the factors of a step;
      ! and the rows of its points in files.
      n_entries = real(max(n_dense, merge(0, 2, estimate%half_width > 0)), dp)*real(body%retained%n_rows, dp)**2
      if (body%slides_far) n_entries = n_entries + 2.0_dp*real(body%retained%n_rows, dp)**2
      if (.not. all(body%retained%is_own)) n_entries = n_entries &
         + real(body%dof_map%n_schur + body%retained%n_rows, dp)**2
      if (estimate%half_width > 0) n_entries = n_entries + 7.0_dp*(estimate%half_width + 1)*estimate%n_rows
      estimate%memory_mb = max(peak_memory_mb(), resident_memory_mb() + condenser%memory_mb() &
         + (8.0e-6_dp*n_entries + of_point*body%zone%n_points))
      estimate%available_mb = resident_memory_mb() + available_memory_mb()
   end subroutine estimate_body

   !> Computes the displacements of the points under each free rigid motion of each piece. All nodes that contribute to
   !> a point of a pair may be taken to lie at the point: the two sides as if they were in contact. The normal
   !> displacements under rotations then depend neither on the facets of the master nor on the gap, which is along the
   !> normal.
   pure subroutine find_rigid_modes(modes, zone, motions, coordinates, is_mated)
      real(dp), allocatable, intent(out) :: modes(:, :)
         !! (u_N; u_T) of the points under each motion (n_rows, motions) [-]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions of each piece
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      logical, intent(in) :: is_mated !! whether the nodes of pairs are taken to lie at the points
      logical, allocatable :: is_inside(:)
      real(dp), allocatable :: motion(:, :)
      real(dp) :: position(size(coordinates, 1)), errors
      logical :: is_fixed(zone%n_rows)
      integer :: i, j, k, p

      allocate (modes(zone%n_rows, sum(motions%n_free)), source=0.0_dp)
      allocate (is_inside(maxval([0, zone%rows%node])))
      k = 0
      do j = 1, size(motions)
         is_inside = .false.
         is_inside(pack(motions(j)%node, motions(j)%node <= size(is_inside))) = .true.
         do p = 1, zone%n_points
            do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
               if (.not. is_inside(zone%rows%node(i))) cycle
               position = coordinates(:, zone%rows%node(i))
               if (is_mated .and. zone%pairs(zone%set(p))%is_set()) position = zone%position(:, p)
               motion = motions(j)%displacement(position, zone%rows%node(i))
               associate (at_point => modes(p::zone%n_points, k + 1:k + motions(j)%n_free))
                  at_point = at_point + matmul(transpose(zone%rows%block(:, :, i)), motion)
               end associate
            end do
         end do
         k = k + motions(j)%n_free
      end do
      ! Levers have the rounding errors of coordinates. The unlimited force of a wall, times what rounding leaves of its
      ! work, would bear a load along it. The slip that a support prevents is no unknown of the contact problem.
      errors = sum_rounding + epsilon(errors)*maxval(abs(coordinates))/minval(motions%radius)
      is_fixed = [spread(.false., 1, zone%n_points), transpose(zone%is_fixed)]
      do p = 1, zone%n_rows
         if (is_fixed(p) .or. norm2(modes(p, :)) <= errors) modes(p, :) = 0.0_dp
      end do
   end subroutine find_rigid_modes

end module amontons_body
