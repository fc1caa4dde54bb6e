!> The solution of a case from its configuration to its result: body, load case, solution, certificate and error
!> estimate.
!>
!> Cases that share a body share its factorization, and each starts from the contact state of the one before, or of the
!> coarser mesh. The same procedures solve bodies made in code, and certify cases of sweeps, steps of histories and the
!> results that `--verify` reads.
! allow(S271): gfortran 12 fails if the modules are in order
module amontons_solve_case
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_assembly, only: uncanceled_force
   use amontons_auto, only: auto_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_body, only: body_t, condense_body, new_body
   use amontons_boundary, only: new_patch, patch_t
   use amontons_certificate, only: new_certificate
   use amontons_condensation, only: condensation_options_t
   use amontons_config, only: body_text, check_names, config_t
   use amontons_constraints, only: support_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_equilibrium, only: recover_with_travel
   use amontons_error, only: error_t, new_error, no_equilibrium, numerical_failure
   use amontons_key_results, only: body_peaks, contact_results_t, new_contact_results, wear_results
   use amontons_kinds, only: dp
   use amontons_load_family, only: acting_t, load_case_t, new_load_case, one_part
   use amontons_load_solver, only: check_balance, load_solver_t, new_load_solver
   use amontons_loads, only: load_by_temperature, load_t
   use amontons_mesh, only: mesh_t
   use amontons_mesh_file, only: new_mesh
   use amontons_methods, only: method_options_t
   use amontons_model_warnings, only: add_model_warnings
   use amontons_pose, only: elastic_part, pose_t, stated_poses, turn_forth, turn_vectors, whole_displacement
   use amontons_recovery_tables, only: known_tractions_t, new_recovery_tables, recovery_tables_t
   use amontons_result, only: depth_worn, factor_t, outcome_no_equilibrium, outcome_numbers, result_t
   use amontons_result_warnings, only: add_result_warnings
   use amontons_rounding, only: computed_rounding
   use amontons_sliding, only: take_places
   use amontons_stress_field, only: error_estimate_t, new_error_estimate, new_recovered_stress, new_stress_field, &
      recovered_stress_t
   use amontons_surface, only: surface_t
   use amontons_terminal, only: new_timings, phase_condense, phase_recover, phase_solve, phase_write
   use amontons_uniqueness, only: new_uniqueness, uniqueness_t
   implicit none (type, external)
   private

   public :: cache_t, certify, condense_case, describe_factor, evaluate, prepare_case, prepare_single_case, &
      solve_body, solve_case, take_no_equilibrium

   !> The contact state at the end of a case, from which the next case of the same body starts.
   type :: state_t
      character(:), allocatable :: case_name !! name of the case whose state it is
      type(contact_solution_t) :: solution !! its solution
      type(uniqueness_t) :: uniqueness !! the friction below which it is the only one
      integer, allocatable :: set(:) !! which contact set each point belongs to (m)
      real(dp), allocatable :: position(:, :) !! coordinates of the points (n_dim, m) [L]
      real(dp), allocatable :: area(:) !! their tributary areas (m) [L^2]
   contains
      procedure :: prolong => state_prolong
   end type state_t

   !> The present body, which cases of a run share.
   type :: cache_t
      character(:), allocatable :: key !! the deck text that the body was made from
      type(body_t), allocatable :: body !! the body
      character(:), allocatable :: first_case !! the case that the body was made for
      logical :: is_condensed = .false. !! whether the body is factorized
      type(contact_problem_t) :: problem !! its contact problem, once it is condensed
      type(state_t), allocatable :: state
         !! final contact state of the last case of this body; not allocated before the first
      logical :: is_refining = .false. !! whether the next body is the one at hand on a finer mesh, and keeps its state
   end type cache_t

contains

   !> Makes body and load case of a case, and so checks everything that its deck may get wrong.
   subroutine prepare_case(cache, config, result, error)
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(out) :: result !! gains the load case, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! mesh, sets, supports, contacts or loads are invalid
      logical :: has_body

      call new_timings(result%timings)
      result%warnings%units = config%units
      result%method = config%method
      has_body = allocated(cache%body) .and. allocated(cache%key)
      if (has_body) has_body = cache%key == body_text(config)
      ! A history may have left motions locked.
      if (has_body .and. cache%is_condensed) has_body = .not. any(cache%body%condensation%is_locked)
      if (has_body) then
         call check_names(config, cache%body%mesh, error)
      else
         call make_body(cache, config, error)
      end if
      if (allocated(error)) return
      result%wants_error_estimate = config%accuracy%wants_estimate()
      call new_load_case(result%load_case, cache%body, config%supports, config%contacts, config%loads, error)
      if (.not. allocated(error)) call add_model_warnings(result%warnings, cache%body, result%load_case)
   end subroutine prepare_case

   !> Makes the body of a case: mesh, materials, supports, contact points.
   subroutine make_body(cache, config, error)
      type(cache_t), intent(inout) :: cache !! gains the body
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(out) :: error !! mesh, sets, supports or contacts are invalid
      type(mesh_t) :: mesh
      character(:), allocatable :: notes

      if (allocated(cache%body)) deallocate (cache%body)
      ! After a failure the cache must not appear to hold the previous body.
      cache%key = ''
      cache%is_condensed = .false.
      allocate (cache%body)
      call new_mesh(mesh, config%meshes, notes, error)
      if (.not. allocated(error)) call check_names(config, mesh, error)
      if (allocated(error)) return
      call new_body(cache%body, mesh, config%materials, config%supports, config%contacts, error, config%ties)
      if (allocated(error)) return
      cache%body%mesh_notes = notes
      cache%key = body_text(config)
      cache%first_case = config%name
      if (allocated(cache%state) .and. .not. cache%is_refining) deallocate (cache%state)
   end subroutine make_body

   !> Makes body and load case of a single case, and checks before the factorization whether its loads have an
   !> equilibrium.
   subroutine prepare_single_case(cache, config, result, error)
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(out) :: result !! gains the load case and the warnings
      type(error_t), allocatable, intent(out) :: error
         !! mesh, sets, supports, contacts or loads are invalid, or there is no equilibrium

      call prepare_case(cache, config, result, error)
      if (allocated(error) .or. cache%body%slides_far) return
      call check_balance(cache%body, result%load_case, error)
   end subroutine prepare_single_case

   !> Makes an error that means no equilibrium the outcome of a case: it is an answer and has files.
   pure subroutine take_no_equilibrium(result, error)
      type(result_t), intent(inout) :: result !! gains outcome and answer
      type(error_t), allocatable, intent(inout) :: error !! the error, if there is one; removed if it is an answer

      if (.not. allocated(error)) return
      if (error%kind /= no_equilibrium) return
      result%outcome = outcome_no_equilibrium
      result%answer = error%message
      deallocate (error)
   end subroutine take_no_equilibrium

   !> Solves a single case. A missing equilibrium is its outcome, not an error.
   subroutine solve_case(cache, config, result, error)
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the deck is invalid, or the computation failed numerically

      call prepare_single_case(cache, config, result, error)
      if (.not. allocated(error)) call condense_case(cache, config, result, error)
      call take_no_equilibrium(result, error)
      if (allocated(error) .or. allocated(result%answer)) return
      ! Starts from where the last case of the same body ended, on a coarser mesh where this one is refined, or from
      ! rest.
      if (cache%is_refining .and. allocated(cache%state)) then
         call cache%state%prolong(result%solution, cache%body%zone)
      else if (allocated(cache%state)) then
         result%solution = cache%state%solution
         result%uniqueness = cache%state%uniqueness
         result%started_from = cache%state%case_name
      else
         call new_contact_solution(result%solution, cache%body%zone%n_points, cache%body%zone%n_tangents)
      end if
      call solve_load_case(result, cache%body, cache%problem, error)
      if (allocated(error)) return
      if (.not. result%solution%is_converged) return
      if (.not. allocated(cache%state)) allocate (cache%state)
      associate (state => cache%state, zone => cache%body%zone)
         state%case_name = config%name
         state%solution = result%solution
         state%uniqueness = result%uniqueness
         state%set = zone%set
         state%position = zone%position
         state%area = zone%area
      end associate
   end subroutine solve_case

   !> Factorizes and condenses the body, and makes the tables of its error estimates, unless an earlier case did.
   subroutine condense_case(cache, config, result, error)
      type(cache_t), intent(inout) :: cache !! the present body
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(inout) :: result !! gains the times, and the case whose factorization it shares
      type(error_t), allocatable, intent(out) :: error !! the body is not held, or its stiffness is degenerate

      if (cache%is_condensed) then
         result%shared_with = cache%first_case
      else
         call condense_body(cache%body, cache%problem, config%condensation, result%timings, error)
         cache%is_condensed = .not. allocated(error)
      end if
      if (allocated(error) .or. .not. result%wants_error_estimate) return
      call result%timings%begin(phase_recover)
      call prepare_estimates(cache%body)
      call result%timings%begin(phase_condense)
   end subroutine condense_case

   !> Interpolates a state to another mesh of the same body, as a starting point: stresses and displacements of a point
   !> are linear between the two nearest points of the state in its set.
   pure subroutine state_prolong(self, solution, zone)
      class(state_t), intent(in) :: self !! the state
      type(contact_solution_t), intent(out) :: solution !! the solution
      type(contact_zone_t), intent(in) :: zone !! the contact points of the other mesh
      real(dp) :: distance(size(self%set)), share(2)
      integer :: axis, nearest(2), m, n, p, k

      m = size(self%set)
      n = zone%n_points
      call new_contact_solution(solution, n, zone%n_tangents)
      do p = 1, n
         distance = merge(hypot(self%position(1, :) - zone%position(1, p), self%position(2, :) - zone%position(2, p)), &
            huge(1.0_dp), self%set == zone%set(p))
         do axis = 3, size(zone%position, 1)
            distance = hypot(distance, self%position(axis, :) - zone%position(axis, p))
         end do
         if (.not. any(self%set == zone%set(p))) cycle
         do k = 1, 2
            nearest(k) = minloc(distance, dim=1)
            share(3 - k) = distance(nearest(k))
            distance(nearest(k)) = huge(1.0_dp)
         end do
         ! A state of one point alone has no second one: its distance is that of other sets.
         share = share/sum(share)
         do k = 1, 2
            associate (q => nearest(k))
               solution%displacement(p::n) = solution%displacement(p::n) + share(k)*self%solution%displacement(q::m)
               if (self%area(q) > 0.0_dp) solution%force(p::n) = solution%force(p::n) &
                  + share(k)*zone%area(p)/self%area(q)*self%solution%force(q::m)
            end associate
         end do
         solution%status(p) = self%solution%status(nearest(1))
      end do
   end subroutine state_prolong

   !> Solves a load case of a body and certifies the result. A missing equilibrium is its outcome, not an error.
   subroutine solve_load_case(result, body, problem, error)
      type(result_t), intent(inout) :: result
         !! the result: with its load case and method, times begun, a solution to start from, and what is known of its
         !! uniqueness from another load case of the body; gains everything else
      type(body_t), intent(inout) :: body !! the body, condensed; points that slide far are left at their places
      type(contact_problem_t), intent(inout) :: problem
         !! its contact problem; left with this load case, and the compliance if the method makes it
      type(error_t), allocatable, intent(out) :: error !! there is no such method, or the computation failed numerically
      type(load_solver_t), allocatable :: solver
      type(acting_t) :: acting
      type(uniqueness_t) :: known
      type(contact_solution_t) :: exact
      type(auto_t) :: exact_method
      integer :: kind

      call result%timings%begin(phase_condense)
      call describe_factor(result%factor, body)
      allocate (solver)
      call new_load_solver(solver, body, result%load_case, one_part(result%load_case), result%method, error)
      if (allocated(error)) return
      call solver%loads%condense(body, problem)
      result%load_case%condensed = solver%loads%parts(1)%condensed
      call solver%loads%at_rest(acting)
      call solver%loads%pose(body, acting, problem)
      call result%timings%begin(phase_solve)
      if (.not. any(abs(problem%load) > 0.0_dp) .and. allocated(result%started_from)) deallocate (result%started_from)
      if (body%slides_far) then
         call solver%slide(body, acting, problem, result%solution, result%outcome, result%answer, kind)
         call solver%loads%load_case(body, acting, result%load_case)
         if (allocated(result%solution%retained)) call take_places(body, solver%loads, acting, result%solution)
      else
         call solver%solve(body, acting, problem, result%solution, result%outcome, result%answer, kind)
      end if
      deallocate (solver)
      if (result%outcome == outcome_numbers) call new_error(error, kind, result%answer)
      if (any(result%outcome == [outcome_no_equilibrium, outcome_numbers])) return
      deallocate (result%answer)
      if (result%solution%is_at_rest) then
         exact_method%tolerance = result%method%tolerance
         call new_contact_solution(exact, problem%n_points, problem%matrix%n_tangents)
         call exact_method%solve(problem, exact, error)
         if (allocated(error)) return
         if (exact%is_converged) result%method_error = maxval(abs(result%solution%force - exact%force)) &
            /max(maxval(abs(exact%force)), tiny(1.0_dp))
      end if
      call result%timings%begin(phase_recover)
      call certify(result, body, error)
      if (allocated(error)) return
      call add_result_warnings(result, body)
      known = result%uniqueness
      if (.not. body%slides_far) call new_uniqueness(result%uniqueness, problem, known)
      ! The caller writes the result next.
      call result%timings%begin(phase_write)
   end subroutine solve_load_case

   !> Records which factorization is in use, and its size.
   pure subroutine describe_factor(factor, body)
      type(factor_t), intent(out) :: factor !! the factorization
      type(body_t), intent(in) :: body !! the body, condensed

      associate (condenser => body%condensation%condenser)
         factor%name = condenser%name
         factor%n_entries = condenser%n_factor_entries
         factor%n_flops = condenser%n_flops
      end associate
   end subroutine describe_factor

   !> Computes the displacements of all nodes, the certificate and the lengths, and refuses numbers that are not finite.
   subroutine certify(result, body, error)
      type(result_t), intent(inout) :: result !! the result, its load case condensed and its contact problem solved
      type(body_t), intent(in) :: body !! the body
      type(error_t), allocatable, intent(out) :: error !! the results left the range of numbers
      real(dp), parameter :: few_digits = 1.0e-6_dp ! of imbalances: six correct digits of a force
      ! A condition number that costs less than half of the digits explains nothing.
      real(dp), parameter :: explaining = 1.0e8_dp
      real(dp) :: condition, forces

      call recover_with_travel(result%displacement, body, result%load_case, result%solution%body_displacement(), &
         result%solution%body_force())
      if (size(body%turning) > 0) result%displacement = whole_displacement(body%turning, stated_poses(body%turning, &
         result%solution%posed), body%mesh%coordinates, result%displacement)
      call evaluate(result, body)
      if (.not. (all(ieee_is_finite(result%displacement)) .and. result%certificate%is_finite())) then
         call new_error(error, numerical_failure, 'displacements, forces or energies leave the range of double '// &
            'precision (1.8e308): choose other units')
         return
      end if
      ! Violations may come from the rounding errors of an ill-conditioned stiffness if one that depends on the whole
      ! model is well above rounding, or if the forces have fewer than six correct digits.
      associate (certificate => result%certificate)
         if (max(certificate%equilibrium, certificate%resultant, certificate%moment, certificate%energy) &
            <= computed_rounding .and. certificate%imbalance <= few_digits) return
      end associate
      condition = body%condensation%condenser%condition()
      ! Cancellation of the forces of the elements, |K| |u| / |f|: for a body held by supports a lower bound of the
      ! condition number. It is not affected by the shift in the factor of a body held by contact alone. Prescribed
      ! displacements and heat are loads without nodal forces.
      forces = max(norm2(result%load_case%force), norm2(result%solution%force))
      if (forces > 0.0_dp .and. .not. (any(abs(result%load_case%prescribed) > 0.0_dp) .or. &
         any(result%load_case%loads%target == load_by_temperature))) then
         condition = max(condition, uncanceled_force(body%mesh, body%materials, abs(result%displacement))/forces)
      end if
      if (condition > explaining) result%condition = min(condition, huge(1.0_dp))
   end subroutine certify

   !> Computes all results that follow from displacements, contact forces and statuses: certificate, lengths, key
   !> results, error estimate.
   subroutine evaluate(result, body)
      type(result_t), intent(inout) :: result !! the result: load case, solution and displacements of all nodes
      type(body_t), intent(in) :: body !! the body
      type(contact_results_t) :: at_points
      real(dp), allocatable :: elastic(:, :), whole(:, :)
      integer :: k

      if (allocated(result%poses)) deallocate (result%poses)
      if (size(body%turning) > 0) then
         result%poses = [(body%turning(k)%pose(body%mesh%coordinates, result%displacement, &
            sum(result%load_case%posed(3, k:min(k, size(result%load_case%posed, 2))))), k=1, size(body%turning))]
         whole = result%displacement
         result%displacement = elastic_part(body%turning, result%poses, body%mesh%coordinates, whole)
      end if
      call move_alloc(result%displacement, elastic)
      associate (solution => result%solution)
         call new_stress_field(result%stress, body%mesh, body%materials, body%coloring, elastic, &
            result%load_case%element_load)
         call new_certificate(result%certificate, body, result%load_case, elastic, solution%force, &
            result%stress%force, result%poses)
         if (result%wants_error_estimate) then
            if (.not. allocated(result%error_estimate)) allocate (result%error_estimate)
            call estimate_error(result%error_estimate, body, result%load_case, elastic, solution%force, result%poses)
         end if
         if (allocated(whole)) then
            call turn_forth(body%turning, result%poses, [(k, k=1, body%mesh%n_nodes)], result%stress%node)
            call turn_forth(body%turning, result%poses, body%mesh%node(body%mesh%node_start(:body%mesh%n_elements)), &
               result%stress%element)
            call move_alloc(whole, result%displacement)
         else
            call move_alloc(elastic, result%displacement)
         end if
         ! They are not needed any more, and the following part of a run takes most memory.
         deallocate (result%stress%force)
         call new_contact_results(at_points, body, solution, result%load_case%slip_bound + result%load_case%friction &
            *solution%force(:body%zone%n_points), result%load_case%free_gap, result%load_case%anchor, &
            result%load_case%obstacle_motion)
         result%lengths = at_points%lengths
         call move_alloc(at_points%closed, result%closed)
         call move_alloc(at_points%stuck, result%stuck)
         result%key_results = [at_points%peaks, body_peaks(body%mesh, result%displacement, result%stress%node), &
            at_points%sets]
         if (allocated(result%slip_record)) result%key_results = [result%key_results, wear_results(body, &
            result%load_case%contacts, result%slip_record(:, depth_worn))]
         ! The listing has the forces by name, the last ones, in a section of their own.
         result%key_results = [result%key_results, result%certificate%named]
      end associate
   end subroutine evaluate

   !> Solves a body made in code, with supports, contact sets and loads as arguments. The body is factorized by the
   !> first call; later calls with the same contact problem may have other loads, prescribed displacements, obstacles or
   !> friction.
   subroutine solve_body(body, problem, supports, contacts, loads, options, result, error)
      type(body_t), intent(inout) :: body !! the body, from `new_body`; gains its factorization with the first load case
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; a new one for the first load case
      type(support_t), intent(in) :: supports(:) !! the supports of `new_body`; their displacements may be others
      type(contact_t), intent(in) :: contacts(:) !! the contact sets of `new_body`; obstacles and friction may be others
      type(load_t), intent(in) :: loads(:) !! the loads
      type(method_options_t), intent(in) :: options !! the contact method
      type(result_t), intent(inout) :: result
         !! the result; one that converged for another load case of this body is where the method starts
      type(error_t), allocatable, intent(out) :: error
         !! supports, contacts or loads are invalid, or the computation failed numerically
      type(contact_solution_t) :: start
      type(uniqueness_t) :: known
      type(result_t) :: empty

      call new_contact_solution(start, body%zone%n_points, body%zone%n_tangents)
      if (result%solution%is_converged) then
         if (size(result%solution%force) == size(start%force)) start = result%solution
         known = result%uniqueness
      end if
      ! It is a start, and no result of this load case.
      start%is_converged = .false.
      result = empty
      result%solution = start
      result%uniqueness = known
      result%method = options
      result%wants_error_estimate = .true.
      call new_timings(result%timings)
      call new_load_case(result%load_case, body, supports, contacts, loads, error)
      if (allocated(error)) return
      if (.not. body%slides_far) call check_balance(body, result%load_case, error)
      if (allocated(error)) return
      call add_model_warnings(result%warnings, body, result%load_case)
      if (.not. allocated(problem%load)) then
         call condense_body(body, problem, condensation_options_t(), result%timings, error)
      end if
      if (allocated(error)) return
      if (result%wants_error_estimate) call prepare_estimates(body)
      call solve_load_case(result, body, problem, error)
      if (result%outcome == outcome_no_equilibrium .and. .not. allocated(error)) call new_error(error, &
         no_equilibrium, result%answer)
   end subroutine solve_body

   !> Makes the tables for the error estimates of a body, unless it has them.
   subroutine prepare_estimates(body)
      type(body_t), intent(inout) :: body !! the body; gains the tables

      if (allocated(body%recovery)) return
      allocate (body%recovery)
      call new_recovery_tables(body%recovery, body%mesh, body%outer, body%materials, body%constraints, body%springs)
   end subroutine prepare_estimates

   !> Estimates the error of the stresses of a load case's solution, with the tables of the body if it has them.
   subroutine estimate_error(estimate, body, load_case, displacement, force, poses)
      type(error_estimate_t), intent(out) :: estimate !! the estimate
      type(body_t), intent(in), target :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads
      real(dp), contiguous, intent(in) :: displacement(:, :)
         !! displacement of the nodes, elastic where pieces turn far (components, n_nodes) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      type(pose_t), intent(in), optional :: poses(:) !! poses of the pieces that turn far; there are none without them
      type(recovery_tables_t), allocatable, target :: own
      type(recovery_tables_t), pointer :: tables
      type(known_tractions_t) :: tractions
      type(recovered_stress_t) :: recovered

      if (allocated(body%recovery)) then
         tables => body%recovery
      else
         allocate (own)
         call new_recovery_tables(own, body%mesh, body%outer, body%materials, body%constraints, body%springs)
         tables => own
      end if
      tractions = tables%sides
      call tractions%add_loads(body%mesh, load_case%loads, load_case%factor)
      call set_contact_tractions(tractions, body, load_case, force, poses)
      call new_recovered_stress(recovered, tables%patches, body%mesh, body%materials, tractions%side, &
         displacement, load_case%element_load)
      call new_error_estimate(estimate, body%mesh, body%materials, displacement, tables%patches, recovered, &
         load_case%element_load)
   end subroutine estimate_error

   !> Sets the tractions on the sides of the contact sets: the forces of the points of each set on its nodes, over their
   !> areas. The tractions on masters and ties are not known side by side.
   subroutine set_contact_tractions(tractions, body, load_case, force, poses)
      type(known_tractions_t), intent(inout) :: tractions !! the sides of the boundary
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its contact sets
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      type(pose_t), intent(in), optional :: poses(:) !! poses of the pieces that turn far
      real(dp), allocatable :: traction(:, :), area(:)
      logical :: is_joined(body%mesh%n_nodes), is_meant(body%zone%n_points)
      integer, allocatable :: place(:)
      type(patch_t) :: patch
      type(error_t), allocatable :: error
      integer :: i, k

      do i = 1, size(load_case%contacts)
         is_meant = body%zone%set == i
         is_meant(pack(body%zone%passed_point(2, :), body%zone%passed_point(1, :) == i)) = .true.
         traction = body%zone%rows%forces(merge(force, 0.0_dp, [(is_meant, k=0, body%zone%n_tangents)]), &
            body%mesh%n_nodes)
         if (present(poses)) call turn_vectors(body%turning, poses, traction, is_back=.true.)
         area = norm2(body%zone%rows%forces([merge(body%zone%area, 0.0_dp, is_meant), 0.0_dp*force], &
            body%mesh%n_nodes), dim=1)
         ! The contact zone was made of these patches, so they are sound.
         call new_patch(patch, body%mesh, load_case%contacts(i)%set, error, body%materials)
         ! The points of a pair have no area where the slave faces nothing.
         area = max(patch%area, area(patch%node))
         if (allocated(patch%line)) then
            ! A corner of a quadratic side on the axis of revolution has none at all, and the traction of the middle
            ! node.
            place = [(k, k=1, patch%n_nodes)]
            where (area <= computed_rounding*maxval(area)) place = merge(patch%line%next, place - 1, &
               patch%line%next > 0)
            traction(:, patch%node) = traction(:, patch%node(place))/spread(max(area(place), tiny(1.0_dp)), 1, 2)
         else
            ! The forces of faces are those of points, whose nodes come first; they are linear between corners.
            traction(:, patch%node) = 0.0_dp
            do k = 1, body%zone%n_points
               if (is_meant(k)) traction(:, body%zone%rows%node(body%zone%rows%start(k))) = &
                  -matmul(body%zone%frame(:, :, k), force(k::body%zone%n_points))/body%zone%area(k)
            end do
            call body%zone%pairs(i)%extend(traction)
         end if
         call tractions%add_nodal(body%mesh, body%constraints, load_case%contacts(i)%set, &
            traction(:size(body%mesh%coordinates, 1), :))
      end do
      is_joined = .false.
      do i = 1, size(body%zone%pairs)
         if (body%zone%pairs(i)%is_set()) call mark_sides(is_joined, body%zone%pairs(i)%master, &
            body%zone%pairs(i)%segments%master)
      end do
      traction = body%zone%rows%forces(force, body%mesh%n_nodes)
      is_joined = is_joined .and. any(abs(traction(:size(body%mesh%coordinates, 1), :)) > 0.0_dp, dim=1)
      do i = 1, size(body%ties)
         call mark_sides(is_joined, body%ties(i)%master, body%ties(i)%segments%master)
         call mark_sides(is_joined, body%ties(i)%slave, body%ties(i)%segments%slave)
      end do
      call tractions%forget(is_joined)
   end subroutine set_contact_tractions

   !> Marks the corners of sides of a surface.
   pure subroutine mark_sides(is_marked, surface, sides)
      logical, intent(inout) :: is_marked(:) !! the marks of the nodes (n_nodes)
      type(surface_t), intent(in) :: surface !! the surface
      integer, intent(in) :: sides(:) !! numbers of sides; one may occur more than once
      integer :: i

      do i = 1, size(sides)
         associate (nodes => surface%side(:size(surface%side, 1) - 1, sides(i)))
            is_marked(pack(nodes, nodes > 0)) = .true.
         end associate
      end do
   end subroutine mark_sides

end module amontons_solve_case
