!> One step of a load history: what acts on the body at a time, that is, factors of loads and positions of obstacles;
!> the solution of the step from the state at its beginning; and its energies, probes and surface stresses.
!>
!> The step is a contact problem whose slips count from the anchors: the positions of the points at its beginning, moved
!> along with the obstacle (backward Euler; section 10 of doc/theory.md). The previous state is not changed, so that a
!> step can be discarded and taken again with another length.
!>
!> Energies are computed without the displacements of nodes. Loads and prescribed displacements are sums of parts, f =
!> sum c_i f_i and u_p = sum c_i u_pi. The field of all nodes is then u = sum c_i u_i + E v: u_i is the response to part
!> i with v = 0, E extends the contact displacements v by equilibrium. Any force field G does the work `v . condense(G)`
!> on E v, so that a few vectors and small matrices, computed once, give every energy of a step in O(m^2) operations.
module amontons_history_model
   use amontons_body, only: body_t, lock_motions
   use amontons_checkpoint, only: archive_t
   use amontons_config, only: config_t
   use amontons_contact_problem, only: contact_problem_t, rounding_share
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_dense, only: transposed_product
   use amontons_error, only: error_t, input_refused, new_error, numerical_failure
   use amontons_friction_law, only: open_point, slip_minus, slip_point, tangential_norm
   use amontons_history, only: history_t, stepped_friction, stepped_load, stepped_obstacle, stepped_support
   use amontons_kinds, only: dp
   use amontons_load_family, only: acting_t, add_part, condensed_force, load_case_t, load_family_t, one_part, parting_t
   use amontons_load_solver, only: load_solver_t, new_load_solver, residual_of_strains
   use amontons_named_forces, only: contact_values, find_responses, force_form_t, force_test_t, named_quantities, &
      named_tests, new_force_form, set_posed_values
   use amontons_pose, only: pose_t, stated_poses
   use amontons_quantity, only: quantity_t
   use amontons_result, only: certificate_limit, outcome_no_equilibrium, outcome_not_converged, outcome_numbers, &
      outcome_solved
   use amontons_rounding, only: exceeds, sum_rounding
   use amontons_sliding, only: beginning_t, take_places, unbalanced_share
   use amontons_surface_stress, only: new_surface_stress, surface_stress_t
   use amontons_text, only: place_text, scientific, to_text
   implicit none (type, external)
   private

   public :: find_probes, history_model_t, instant_t, n_state_numbers, new_history_model, new_step_state, &
      restore_step_state, step_state_t, take_step

   !> Matrices over the parts, and vectors on the contact displacements for each part.
   type :: energy_form_t
      real(dp), allocatable :: field(:, :, :) !! displacements u_i of the nodes (components, n_nodes, parts) [L]
      real(dp), allocatable, private :: strain(:, :) !! u_i . K u_j (parts, parts) [F L]
      real(dp), allocatable, private :: strain_row(:, :) !! condensed K u_i (n_rows, parts) [F]
      real(dp), allocatable, private :: load(:, :) !! f_i . u_j (parts, parts) [F L]
      real(dp), allocatable, private :: load_row(:, :) !! condensed f_i (n_rows, parts) [F]
      type(force_form_t) :: forces
         !! what the reactions of the supports do on the displacements that each part prescribes, their work while its
         !! factor grows by 1 [F L]; then the forces by name [F]
      real(dp) :: stiffness = 0.0_dp !! norm of the body's K [F/L]
      real(dp), allocatable :: prescribed(:, :)
         !! contact displacements that the parts prescribe (n_rows, parts) [L]
   contains
      procedure :: load_work => energy_form_load_work
      procedure :: strain_energy => energy_form_strain_energy
   end type energy_form_t

   !> The data that all steps share.
   type :: history_model_t
      type(history_t) :: history !! times and changes
      type(load_solver_t) :: solver !! loads, obstacles and friction, and the solver of a step
      integer, allocatable, private :: part_of(:) !! part of each change; 0 for obstacles
      type(energy_form_t) :: energies !! energies in terms of factors and contact displacements
      type(surface_stress_t), allocatable :: surface !! stresses of the surface, where they are asked for
      real(dp), allocatable :: cycle_times(:) !! times at which cycles begin and end, ascending; none without cycles [-]
      integer, allocatable :: probe(:) !! nodes whose displacements are followed
      type(quantity_t), allocatable :: probe_names(:) !! names of these displacements, in the order of `probed`
      type(quantity_t), allocatable :: named(:) !! names of the forces by name, and of driven motions
      real(dp), allocatable, private :: probe_row(:, :) !! their displacements per contact displacement (n_rows, any)
      real(dp), allocatable :: wear(:) !! depth that each point loses per normal force and slip (m) [1/F]
      logical, allocatable :: is_slip_fixed(:) !! whether a support holds each point along its tangents (n_rows - m)
      logical, allocatable :: is_pose_held(:, :) !! which motions of pieces that turn supports prescribe (3, pieces)
   contains
      procedure :: acting => history_model_acting
      procedure :: enter_step => history_model_enter_step
      procedure :: set_locks => history_model_set_locks
      procedure :: at => history_model_at
      procedure :: cycle_at => history_model_cycle_at
      procedure :: probed => history_model_probed
   end type history_model_t

   !> What acts on the body at a time.
   type, extends(acting_t) :: instant_t
      real(dp) :: time = 0.0_dp !! the time [-]
      real(dp), allocatable :: numbers(:) !! the numbers of all changes, in the deck's order
   end type instant_t

   !> Number of numbers of a saved state in addition to those of its contact points and locks.
   integer, parameter :: n_single = 8
   !> Numbers of each contact point in a saved state: those without direction, and those along normal and tangents.
   integer, parameter :: n_scalars = 6, n_normals = 2, n_tangentials = 3

   !> The state at the end of a step.
   type :: step_state_t
      type(instant_t) :: instant !! the loads
      type(contact_solution_t) :: solution !! forces, displacements and statuses of the contact points
      real(dp), allocatable :: slip(:) !! slip of the step (n_rows - m) [L]
      real(dp), allocatable :: accumulated_slip(:) !! sum of the |slip| of all steps (m) [L]
      real(dp), allocatable :: bound(:) !! slip bound g + phi lambda_N (m) [F]
      real(dp), allocatable :: dissipation(:) !! work that friction took at each point in all steps (m) [F L]
      real(dp), allocatable :: worn(:) !! normal force times |slip|, summed over all steps (m) [F L]
      real(dp), allocatable :: wear_depth(:) !! depth worn in all steps; the next one has it in its gaps (m) [L]
      real(dp), allocatable :: reaction(:)
         !! what the supports' reactions do on the displacements that each part prescribes (parts) [F L]
      real(dp), allocatable :: named(:) !! forces by name, in the order of `named_quantities` [F]
      real(dp), allocatable :: lock(:) !! where each motion that can be locked was locked; huge before that [L]
      real(dp) :: strain_energy = 0.0_dp !! strain energy of the body [F L]
      real(dp) :: carried_force = 0.0_dp !! largest sum of the contact forces of points in all steps [F]
      real(dp) :: carried_energy = 0.0_dp !! largest strain energy in all steps [F L]
      real(dp) :: load_work = 0.0_dp !! work of the loads in all steps [F L]
      real(dp) :: support_work = 0.0_dp !! work of the moving supports in all steps [F L]
      real(dp) :: obstacle_work = 0.0_dp !! work of the moving obstacles in all steps [F L]
      real(dp) :: step_dissipation = 0.0_dp !! work that friction took in the step [F L]
      real(dp) :: closing_loss = 0.0_dp !! sum of lambda_N times the gap at the beginning of the step [F L]
      real(dp) :: indicator = 0.0_dp !! energy error of the step over its energies [-]
      real(dp) :: imbalance = 0.0_dp !! violation of the two energy identities of the step over their terms [-]
      real(dp) :: wear_feedback = 0.0_dp
         !! share of the pressure of a point that the depth worn in the step relieves, if no other point moves [-]
      integer :: outcome = outcome_not_converged !! the outcome
      character(:), allocatable :: reason !! why there is no solution; empty for one, and for one not converged
      integer :: error_kind = numerical_failure !! the kind of the error that this is
   contains
      procedure :: energy_error => step_state_energy_error
      procedure :: numbers => step_state_numbers
      procedure :: slip_record => step_state_slip_record
   end type step_state_t

contains

   !> Computes the form from the load cases of the parts.
   subroutine new_energy_form(form, body, parts)
      type(energy_form_t), intent(out) :: form !! the form
      type(body_t), intent(in) :: body !! the body, condensed
      type(load_case_t), intent(in) :: parts(:) !! force and prescribed displacement of each part, condensed
      type(force_test_t), allocatable :: tests(:), named(:)
      real(dp), allocatable :: forces(:, :), loads(:, :, :), fields(:, :), internal(:, :)
      integer :: j, m, n

      m = body%retained%n_rows
      n = size(parts)
      form%stiffness = body%condensation%condenser%matrix_norm
      allocate (form%strain(n, n), form%load(n, n), form%strain_row(m, n), form%load_row(m, n), form%prescribed(m, n))
      named = named_tests(body)
      allocate (tests(n + size(named)))
      tests(n + 1:) = named
      call find_responses(form%field, loads, body, parts)
      fields = reshape(form%field, [size(parts(1)%force), n])
      allocate (internal, mold=fields)
      call transposed_product(reshape(loads, shape(fields)), fields, form%load)
      do j = 1, n
         call body%internal_forces(forces, form%field(:, :, j))
         internal(:, j) = [forces]
         form%strain_row(:, j) = condensed_force(body, forces)
         form%load_row(:, j) = condensed_force(body, loads(:, :, j))
         if (any(abs(parts(j)%prescribed) > 0.0_dp)) tests(j)%held = parts(j)%prescribed
         form%prescribed(:, j) = body%retained%rows%displacement(parts(j)%prescribed)
      end do
      call transposed_product(fields, internal, form%strain)
      call new_force_form(form%forces, body, tests, parts, form%field, loads)
   end subroutine new_energy_form

   !> Strain energy u . K u / 2 [F L].
   pure real(dp) function energy_form_strain_energy(self, problem, factor, v) result(energy)
      class(energy_form_t), intent(in) :: self !! the form
      type(contact_problem_t), intent(in) :: problem !! the contact problem, for its stiffness
      real(dp), intent(in) :: factor(:) !! factors c of the parts [-]
      real(dp), contiguous, intent(in) :: v(:) !! contact displacements (n_rows) [L]
      real(dp) :: force(size(v))

      call problem%matrix%multiply_stiffness(v, force)
      energy = dot_product(v, 0.5_dp*force + matmul(self%strain_row, factor)) &
         + 0.5_dp*dot_product(factor, matmul(self%strain, factor))
      ! What S stores in springs is not in the body.
      if (allocated(problem%softness)) energy = energy - 0.5_dp*sum(problem%softness*force**2)
   end function energy_form_strain_energy

   !> Work of the loads with given factors on a change of the field [F L].
   pure real(dp) function energy_form_load_work(self, factor, change, v_change) result(work)
      class(energy_form_t), intent(in) :: self !! the form
      real(dp), intent(in) :: factor(:) !! factors c of the parts [-]
      real(dp), intent(in) :: change(:) !! by how much the factors change [-]
      real(dp), intent(in) :: v_change(:) !! by how much the contact displacements change (n_rows) [L]

      work = dot_product(factor, matmul(self%load, change) + matmul(v_change, self%load_row))
   end function energy_form_load_work

   !> Makes a part of the loads for each change of a history, and condenses all parts.
   subroutine new_history_model(model, body, problem, prepared, config, error)
      type(history_model_t), intent(out) :: model !! the model
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(load_case_t), intent(in) :: prepared !! the load case of the deck, without factors
      type(config_t), intent(in) :: config !! the deck
      type(error_t), allocatable, intent(out) :: error !! no such method; loads, supports or probes do not fit the body
      character(6) :: displacements(3)
      type(parting_t) :: parting
      integer :: i, k

      model%history = config%history
      model%wear = prepared%contacts(body%zone%set)%wear/body%zone%area
      model%is_slip_fixed = [transpose(body%zone%is_fixed)]
      model%is_pose_held = reshape([(body%turning(i)%is_held, i=1, size(body%turning))], [3, size(body%turning)])
      ! Gives every change of a load, support or friction a part.
      parting = one_part(prepared)
      parting%moves_obstacles = any(config%history%steps%target == stepped_obstacle)
      allocate (model%part_of(size(config%history%steps)), source=0)
      do i = 1, size(model%part_of)
         associate (change => config%history%steps(i), loads => prepared%loads, supports => prepared%supports, &
            contacts => prepared%contacts)
            if (change%target == stepped_obstacle) cycle
            call add_part(parting, &
               [(change%target == stepped_load .and. change%name == loads(k)%name, k=1, size(loads))], &
               [(change%target == stepped_support .and. change%name == supports(k)%name, k=1, size(supports))], &
               [(change%target == stepped_friction .and. change%acts_on(contacts(k)), k=1, size(contacts))])
            model%part_of(i) = parting%n_parts
         end associate
      end do
      parting%driven = body%lockable
      parting%n_parts = parting%n_parts + size(parting%driven)
      parting%is_coefficient = spread(.false., 1, parting%n_parts)
      call new_load_solver(model%solver, body, prepared, parting, config%method, error)
      if (allocated(error)) return
      model%cycle_times = model%history%cycle_ends()
      call find_probes(model%probe, model%history, body, error)
      if (.not. allocated(error)) call condense_history(model, body, problem, error)
      if (allocated(error)) return
      model%named = named_quantities(body)
      allocate (model%probe_names(size(model%probe_row, 2)))
      displacements = [character(6) :: 'ux', 'uy', merge('utheta', 'uz    ', body%materials%is_twisted())]
      do i = 1, size(model%probe_names)
         associate (name => model%probe_names(i), n => 1 + body%zone%n_tangents)
            name%key = trim(displacements(1 + modulo(i - 1, n)))//'_'//to_text(1 + (i - 1)/n)
            name = quantity_t(name%key, name%key, dimension='L')
         end associate
      end do
   end subroutine new_history_model

   !> Condenses the parts, and computes the data of energies, probes and surface stresses.
   subroutine condense_history(model, body, problem, error)
      type(history_model_t), intent(inout) :: model !! the model
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(error_t), allocatable, intent(out) :: error !! stresses of the surface cannot be computed
      real(dp) :: unit(1 + body%zone%n_tangents, body%mesh%n_nodes)
      integer :: i, component

      associate (loads => model%solver%loads)
         call loads%condense(body, problem)
         call new_energy_form(model%energies, body, loads%parts)
         if (model%history%has_fretting) then
            if (allocated(model%surface)) deallocate (model%surface)
            allocate (model%surface)
            call new_surface_stress(model%surface, body, loads%base%contacts, loads%parts, model%energies%field, error)
            if (allocated(error)) return
         end if
      end associate
      ! Finds what the displacements of the probes are in terms of the contact displacements.
      if (allocated(model%probe_row)) deallocate (model%probe_row)
      associate (n => size(unit, 1))
         allocate (model%probe_row(body%retained%n_rows, n*size(model%probe)))
         do i = 1, size(model%probe)
            do component = 1, n
               unit = 0.0_dp
               unit(component, model%probe(i)) = 1.0_dp
               model%probe_row(:, n*(i - 1) + component) = condensed_force(body, unit)
            end do
         end do
      end associate
   end subroutine condense_history

   !> Locks the motions of the body that are locked in a state, and frees the others.
   subroutine history_model_set_locks(self, body, problem, state, error)
      class(history_model_t), intent(inout) :: self !! the model
      type(body_t), intent(inout) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(step_state_t), intent(inout) :: state !! the state; the factors of what it locks become those of the locks
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      logical :: is_locked(size(state%lock))

      is_locked = state%lock < huge(1.0_dp)
      associate (factor => state%instant%factor)
         factor(size(factor) - size(is_locked) + 1:) = merge(state%lock, 0.0_dp, is_locked)
      end associate
      if (all(is_locked .eqv. body%condensation%is_locked)) return
      call lock_motions(body, problem, is_locked, error)
      if (allocated(error)) return
      call condense_history(self, body, problem, error)
   end subroutine history_model_set_locks

   !> Before a step, locks the motions whose lock time is reached at their present values. Nothing moves: displacements,
   !> forces and energies of the state are unchanged.
   subroutine history_model_enter_step(self, body, problem, state, error)
      class(history_model_t), intent(inout) :: self !! the model
      type(body_t), intent(inout) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(step_state_t), intent(inout) :: state !! the state at the beginning of the step
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      logical :: is_due(size(body%lockable))

      is_due = body%driven(body%lockable)%lock_time <= state%instant%time .and. .not. state%lock < huge(1.0_dp)
      if (.not. any(is_due)) return
      where (is_due) state%lock = state%named(size(state%named) - 2*size(body%driven) - 1 + 2*body%lockable)
      call self%set_locks(body, problem, state, error)
   end subroutine history_model_enter_step

   !> Number of the cycle that ends at a time: 0 where the first one begins, -1 if none ends there.
   pure integer function history_model_cycle_at(self, time) result(cycle)
      class(history_model_t), intent(in) :: self !! the model
      real(dp), intent(in) :: time !! the time [-]
      integer :: n

      n = count(self%cycle_times <= time)
      cycle = -1
      if (n == 0) return
      if (self%cycle_times(n) >= time) cycle = n - 1
   end function history_model_cycle_at

   !> Finds the nodes whose displacements the deck asks for by `probe`.
   subroutine find_probes(nodes, history, body, error)
      integer, allocatable, intent(out) :: nodes(:) !! the nodes (probes)
      type(history_t), intent(in) :: history !! the history
      type(body_t), intent(in) :: body !! the body
      type(error_t), allocatable, intent(out) :: error !! no node is there
      integer :: i, n

      n = size(body%mesh%coordinates, 1)
      allocate (nodes(0))
      if (.not. allocated(history%probes)) return
      do i = n, size(history%probes), n
         associate (position => history%probes(i - n + 1:i))
            nodes = [nodes, body%mesh%nearest_node(position)]
            if (nodes(i/n) > 0) cycle
            call new_error(error, input_refused, history%probe_origin//'probe: no node at the point '// &
               place_text(position))
            return
         end associate
      end do
   end subroutine find_probes

   !> Finds factors of loads and positions of obstacles at a time.
   subroutine history_model_at(self, body, time, instant, error)
      class(history_model_t), intent(in) :: self !! the model
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: time !! the time, not outside of the history [-]
      type(instant_t), intent(out) :: instant !! the loads
      type(error_t), allocatable, intent(out) :: error !! an obstacle has moved too far into the body, or past it
      real(dp), allocatable :: numbers(:)
      integer :: i

      allocate (numbers(0))
      do i = 1, size(self%history%steps)
         numbers = [numbers, self%history%numbers(i, time)]
      end do
      call self%acting(body, time, numbers, instant, error)
   end subroutine history_model_at

   !> Finds factors of loads and positions of obstacles for given numbers of the changes.
   subroutine history_model_acting(self, body, time, numbers, instant, error)
      class(history_model_t), intent(in) :: self !! the model
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: time !! the time [-]
      real(dp), intent(in) :: numbers(:) !! the numbers of all changes, in the deck's order
      type(instant_t), intent(out) :: instant !! the loads
      type(error_t), allocatable, intent(out) :: error !! an obstacle has moved too far into the body, or past it
      type(pose_t) :: motions(size(self%solver%loads%base%contacts))
      integer :: i, k, first

      call self%solver%loads%at_rest(instant)
      instant%time = time
      instant%numbers = numbers
      instant%added_gap = spread(0.0_dp, 1, size(self%wear))
      first = 1
      do i = 1, size(self%history%steps)
         associate (change => self%history%steps(i))
            if (self%part_of(i) > 0) instant%factor(self%part_of(i)) = numbers(first)
            do k = 1, size(motions)
               if (change%target /= stepped_obstacle) exit
               if (.not. change%acts_on(self%solver%loads%base%contacts(k))) cycle
               motions(k) = pose_t([numbers(first:first + 1), 0.0_dp], numbers(first + 2), change%pivot)
               if (size(body%mesh%coordinates, 1) == 3) motions(k) = pose_t(numbers(first:first + 2))
            end do
            first = first + change%n_numbers()
         end associate
      end do
      call self%solver%loads%move(body, motions, instant, error)
   end subroutine history_model_acting

   !> The displacements of the probes, all components of one after the other (any) [L].
   pure function history_model_probed(self, body, state) result(displacement)
      class(history_model_t), intent(in) :: self !! the model
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state
      real(dp) :: displacement(size(self%probe_row, 2))
      integer :: i, k

      displacement = matmul(state%solution%body_displacement(), self%probe_row)
      do i = 1, size(self%probe)
         associate (n => size(self%energies%field, 1))
            displacement(n*(i - 1) + 1:n*i) = displacement(n*(i - 1) + 1:n*i) &
               + matmul(self%energies%field(:, self%probe(i), :), state%instant%factor)
            do k = 1, size(body%turning)
               if (all(body%turning(k)%node /= self%probe(i))) cycle
               associate (pose => stated_poses(body%turning, state%solution%posed), place => body%mesh%coordinates(:, &
                  self%probe(i)))
                  displacement(n*(i - 1) + 1:n*i) = pose(k)%displacement(place) + pose(k)%rotated( &
                     displacement(n*(i - 1) + 1:n*i), is_back=.false.)
               end associate
            end do
         end associate
      end do
   end function history_model_probed

   !> Makes the state before the first step: without stress and loads; obstacles that the body overlaps just touch it.
   pure subroutine new_step_state(state, model, body)
      type(step_state_t), intent(out) :: state !! the state
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      integer :: m

      m = body%zone%n_points
      call new_contact_solution(state%solution, m, body%zone%n_tangents)
      if (body%slides_far) allocate (state%solution%retained(body%retained%n_rows, 2), &
         state%solution%posed(6, size(body%turning)), state%solution%pushed(4, size(body%zone%pairs)), source=0.0_dp)
      call model%solver%loads%at_rest(state%instant)
      state%instant%factor = 0.0_dp
      state%slip = 0.0_dp*state%instant%anchor
      allocate (state%accumulated_slip(m), state%dissipation(m), state%worn(m), state%wear_depth(m), &
         state%instant%added_gap(m), source=0.0_dp)
      state%reaction = state%instant%factor
      state%named = spread(0.0_dp, 1, size(model%named))
      allocate (state%lock(size(body%lockable)), source=huge(1.0_dp))
      state%instant%time = model%history%times(1)
      state%instant%gap = max(0.0_dp, state%instant%gap)
      state%bound = merge(0.0_dp, model%solver%loads%base%slip_bound, all(body%zone%is_fixed, dim=1))
   end subroutine new_step_state

   !> Takes a step to the loads and obstacles at its end. The outcome is part of the state.
   subroutine take_step(after, model, body, problem, before, instant)
      type(step_state_t), intent(out) :: after !! the state at the end of the step
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(inout) :: body !! the body; points that slide far are left at their places
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left as that of the step
      type(step_state_t), intent(in) :: before !! the state at the beginning of the step
      type(instant_t), intent(in) :: instant !! loads, obstacles and friction at its end
      type(beginning_t) :: begin
      integer :: m
      logical :: is_held, may_continue

      m = body%zone%n_points
      after%instant = instant
      after%lock = before%lock
      associate (first => size(instant%factor) - size(after%lock) + 1)
         after%instant%factor(first:) = before%instant%factor(first:)
      end associate
      after%instant%anchor = body%zone%free_slips(before%solution%displacement(m + 1:) &
         + (instant%motion - before%instant%motion))
      after%instant%added_gap = instant%added_gap + before%wear_depth
      after%instant%gap = instant%gap + after%instant%added_gap
      call model%solver%loads%pose(body, after%instant, problem)
      after%solution = before%solution
      is_held = allocated(before%instant%numbers) .and. .not. body%slides_far
      if (is_held) is_held = .not. any(abs(instant%numbers - before%instant%numbers) > 0.0_dp)
      if (is_held) then
         ! Nothing moves. Rounding would decide on the statuses of points on a bound of the law: all statuses are kept.
         call after%solution%reset()
         call after%solution%record(problem, before%solution%displacement, before%solution%force, &
            model%solver%method%tolerance, may_continue)
         is_held = after%solution%is_converged
      end if
      if (is_held) then
         after%solution%status = before%solution%status
         after%outcome = outcome_solved
         after%reason = ''
      else if (body%slides_far) then
         begin%acting_t = before%instant%acting_t
         begin%retained = before%solution%retained
         begin%posed = before%solution%posed
         call model%solver%slide(body, after%instant, problem, after%solution, after%outcome, after%reason, &
            after%error_kind, begin)
      else
         ! Under loads the previous slip is repeated, so that the method starts from the previous statuses.
         if (any(abs(problem%load) > 0.0_dp)) then
            after%solution%displacement(m + 1:) = after%instant%anchor + before%slip
         end if
         call model%solver%solve(body, after%instant, problem, after%solution, after%outcome, after%reason, &
            after%error_kind, before%solution)
      end if
      if (any(after%outcome == [outcome_no_equilibrium, outcome_numbers])) return
      after%slip = after%solution%displacement(m + 1:) - after%instant%anchor
      after%accumulated_slip = before%accumulated_slip + tangential_norm(after%slip, m)
      call complete(after, model, body, problem)
      after%carried_force = max(before%carried_force, sum(after%solution%force(:m)) &
         + sum(tangential_norm(after%solution%force(m + 1:), m)))
      after%carried_energy = max(before%carried_energy, after%strain_energy)
      call add_works(after, model, problem, before)
   end subroutine take_step

   !> Computes the numbers of a state that follow from its forces and displacements.
   pure subroutine complete(state, model, body, problem)
      type(step_state_t), intent(inout) :: state !! the state
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! the contact problem of its step
      real(dp), allocatable :: forces(:)

      associate (factor => state%instant%factor, v => state%solution%body_displacement(), &
         force => state%solution%body_force(), normal => state%solution%force(:size(state%solution%status)), &
         loads => model%solver%loads)
         state%bound = loads%base%slip_bound + loads%friction_of(state%instant)*max(0.0_dp, normal)
         where (all(body%zone%is_fixed, dim=1)) state%bound = 0.0_dp
         forces = model%energies%forces%values(factor, v, force)
         state%reaction = forces(:size(factor))
         state%named = forces(size(factor) + 1:)
         if (body%slides_far) then
            state%named = state%named + contact_values(body, state%solution%force)
            call set_posed_values(state%named, body, stated_poses(body%turning, state%solution%posed), &
               given_forces(loads, factor), state%solution%posed(4:, :))
         end if
         state%strain_energy = model%energies%strain_energy(problem, factor, problem%strained(v, force))
      end associate
   end subroutine complete

   !> The forces that loads give the driven motions (motions) [F, F L].
   pure function given_forces(loads, factor) result(given)
      type(load_family_t), intent(in) :: loads !! the family of loads
      real(dp), intent(in) :: factor(:) !! factors of its parts [-]
      real(dp) :: given(size(loads%parts(1)%driven))
      integer :: k

      given = 0.0_dp
      do k = 1, size(factor)
         given = given + factor(k)*loads%parts(k)%driven
      end do
   end function given_forces

   !> Number of numbers from which a state is restored.
   pure integer function n_state_numbers(body)
      type(body_t), intent(in) :: body !! the body

      n_state_numbers = n_single + size(body%lockable) + (n_scalars + n_normals + n_tangentials*body%zone%n_tangents) &
         *body%zone%n_points
      if (body%slides_far) n_state_numbers = n_state_numbers + body%zone%n_rows + 2*body%retained%n_rows &
         + 6*size(body%turning) + 4*size(body%zone%pairs)
   end function n_state_numbers

   !> The numbers from which a state is restored, the time first; everything else follows.
   pure function step_state_numbers(self) result(numbers)
      class(step_state_t), intent(in) :: self !! the state
      real(dp), allocatable :: numbers(:)
      type(step_state_t) :: state
      type(archive_t) :: archive

      state = self
      call visit(state, archive)
      numbers = archive%numbers(:archive%n)
   end function step_state_numbers

   !> Writes to an archive the numbers from which a state is restored, or reads them.
   pure subroutine visit(state, archive)
      type(step_state_t), intent(inout) :: state !! the state
      type(archive_t), intent(inout) :: archive !! the archive
      integer :: k

      call archive%pass(state%instant%time)
      call archive%pass(state%load_work)
      call archive%pass(state%support_work)
      call archive%pass(state%obstacle_work)
      call archive%pass(state%carried_force)
      call archive%pass(state%carried_energy)
      call archive%pass(state%solution%residual)
      call archive%pass(state%solution%n_iterations)
      call archive%pass(state%lock)
      call archive%pass(state%solution%status)
      call archive%pass(state%solution%force)
      call archive%pass(state%solution%displacement)
      call archive%pass(state%instant%anchor)
      call archive%pass(state%accumulated_slip)
      call archive%pass(state%dissipation)
      call archive%pass(state%worn)
      call archive%pass(state%instant%added_gap)
      call archive%pass(state%wear_depth)
      if (.not. allocated(state%solution%retained)) return
      call archive%pass(state%instant%gap)
      call archive%pass(state%instant%motion)
      call archive%pass(state%solution%retained(:, 1))
      call archive%pass(state%solution%retained(:, 2))
      do k = 1, size(state%solution%posed, 2)
         call archive%pass(state%solution%posed(:, k))
      end do
      do k = 1, size(state%solution%pushed, 2)
         call archive%pass(state%solution%pushed(:, k))
      end do
   end subroutine visit

   !> Restores a state from its numbers, to the last bit. It must be in equilibrium with the body: the state of another
   !> one or under other loads would have energy that no load has supplied.
   subroutine restore_step_state(state, model, body, problem, numbers, instant, error)
      type(step_state_t), intent(out) :: state !! the state
      type(history_model_t), intent(inout) :: model !! the model
      type(body_t), intent(inout) :: body !! the body; locked as it was
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left as that of the step
      real(dp), intent(in) :: numbers(:) !! the numbers
      type(instant_t), intent(in) :: instant !! loads, obstacles and friction at the time among the numbers
      type(error_t), allocatable, intent(out) :: error !! they are those of another body
      ! In an ill-conditioned body rounding may leave more than the limit of the certificate.
      real(dp), parameter :: least_limit = 1.0e-6_dp
      type(archive_t) :: archive
      integer :: m
      real(dp) :: violation

      m = body%zone%n_points
      if (size(numbers) /= n_state_numbers(body)) then
         call new_error(error, input_refused, 'it is of '//to_text((size(numbers) - n_single - size(body%lockable)) &
            /(n_scalars + n_normals + n_tangentials*body%zone%n_tangents))//' contact points, the body has '// &
            to_text(m))
         return
      end if
      state%instant = instant
      call new_contact_solution(state%solution, m, body%zone%n_tangents)
      allocate (state%lock(size(body%lockable)), state%accumulated_slip(m), state%dissipation(m), state%worn(m), &
         state%wear_depth(m))
      if (body%slides_far) allocate (state%solution%retained(body%retained%n_rows, 2), &
         state%solution%posed(6, size(body%turning)), state%solution%pushed(4, size(body%zone%pairs)))
      archive = archive_t(numbers, is_read=.true.)
      call visit(state, archive)
      if (body%slides_far) then
         call take_places(body, model%solver%loads, state%instant, state%solution)
      else
         state%instant%gap = state%instant%gap + state%instant%added_gap
      end if
      call model%set_locks(body, problem, state, error)
      if (allocated(error)) return
      state%solution%history = spread(state%solution%residual, 1, state%solution%n_iterations)
      state%solution%is_converged = .true.
      state%slip = state%solution%displacement(m + 1:) - state%instant%anchor
      call model%solver%loads%pose(body, state%instant, problem)
      if (body%slides_far) then
         violation = unbalanced_share(problem, state%solution)
      else
         violation = residual_of_strains(body, problem, state%solution, state%carried_force)
      end if
      if (.not. violation <= max(least_limit, certificate_limit(max(model%solver%method%tolerance, &
         state%solution%residual)))) call new_error(error, input_refused, 'it is not in equilibrium with the body '// &
         'and what acts on it at the time '//to_text(state%instant%time)//' (violation '//scientific(violation)// &
         '): mesh, materials, supports, friction and loads at that time must be those of the history that left it')
      if (allocated(error)) return
      state%outcome = outcome_solved
      ! For a held point on a bound of the law the status does not follow from the forces.
      associate (force => state%solution%force, status => state%solution%status)
         if (.not. body%slides_far) status = merge(max(open_point, min(merge(slip_minus, slip_point, &
            body%zone%n_tangents == 1), status)), problem%status(state%solution%displacement, force), &
            .not. exceeds(problem%bound(force(:m)), tangential_norm(force(m + 1:), m)))
      end associate
      call complete(state, model, body, problem)
   end subroutine restore_step_state

   !> Adds works and dissipation of a step, and measures the error of its energy balance.
   !>
   !> In a step the work of the loads is that of their means over both ends (they are linear in time). Friction acts
   !> with the mean of both bounds on the slip, which is right under reversal as well, where the force jumps but the
   !> bound does not.
   pure subroutine add_works(after, model, problem, before)
      type(step_state_t), intent(inout) :: after !! the state; gains works and dissipation
      type(history_model_t), intent(in) :: model !! the model
      type(contact_problem_t), intent(in) :: problem !! the contact problem of the step
      type(step_state_t), intent(in) :: before !! the state before it
      ! `rounding_share` is that of energies that cancel each other, over these. For a body that moves as a whole they
      ! are the energies of single nodes with this displacement: the elements of a slender body are far stiffer than its
      ! contact points. It is the share of the forces before that unloading leaves, too, and of energies its square.
      ! Of the violation of the identities: the energy of a rigid motion, which S has by rounding, is none.
      real(dp), parameter :: limit = 1.0e-9_dp
      real(dp), dimension(size(after%bound)) :: approach, taken, missing, way, pressed
      real(dp) :: slip(size(after%slip))
      real(dp), dimension(problem%matrix%n) :: force, mean_force, v, v_change, strained, whole_change, moved, stiffness
      real(dp), dimension(size(after%reaction)) :: change
      real(dp) :: load_work, support_work, obstacle_work, energies, end_work, own_energy, energy_change, size_of_terms
      real(dp), allocatable :: of_poses(:, :)
      integer :: m, n

      m = size(after%bound)
      n = problem%n_points
      force = after%solution%body_force()
      v = after%solution%body_displacement()
      change = after%instant%factor - before%instant%factor
      mean_force = 0.0_dp*force
      v_change = v
      if (allocated(after%solution%retained) .eqv. allocated(before%solution%retained)) then
         mean_force = before%solution%body_force()
         v_change = v - before%solution%body_displacement()
      end if
      strained = problem%strained(v_change, force - mean_force)
      mean_force = 0.5_dp*(force + mean_force)
      moved = matmul(model%energies%prescribed, change)
      ! The normal displacements of the contact problem exclude prescribed parts; the tangential ones include them.
      whole_change = v_change
      whole_change(:n) = v_change(:n) + moved(:n)
      load_work = model%energies%load_work(0.5_dp*(after%instant%factor + before%instant%factor), change, strained)
      support_work = dot_product(0.5_dp*(after%reaction + before%reaction), change)
      taken = 0.5_dp*(after%bound + before%bound)*tangential_norm(after%slip, m)
      pressed = 0.5_dp*(after%solution%force(:m) + before%solution%force(:m))
      slip = after%slip
      if (allocated(after%solution%retained)) then
         ! In the frame of its piece a rigid set does no work.
         of_poses = 0.5_dp*(after%solution%posed(4:, :) + before%solution%posed(4:, :)) &
            *(after%solution%posed(:3, :) - before%solution%posed(:3, :))
         obstacle_work = -sum(0.5_dp*(after%solution%pushed + before%solution%pushed) &
            *(ways(after%instant) - ways(before%instant)))
         missing = 0.0_dp
         missing(:min(1, m)) = dot_product(mean_force, whole_change) + sum(of_poses) + obstacle_work - sum(taken)
      else
         ! An obstacle that loses or meets a point does no work on the jump of the gap.
         approach = merge(after%instant%gap - before%instant%gap, 0.0_dp, &
            after%instant%is_in_reach .and. before%instant%is_in_reach)
         obstacle_work = -dot_product(mean_force, [approach, after%instant%motion - before%instant%motion])
         approach = approach - whole_change(:m)
         ! The remainder of the contact work: the points' shares of the energy error.
         missing = mean_force(m + 1:2*m)*after%slip(:m) - taken - mean_force(:m)*approach
         if (problem%matrix%n_tangents == 2) missing = missing + mean_force(2*m + 1:)*after%slip(m + 1:)
         ! A point that a support holds along its tangent wears as well where the obstacle slides along it.
         where (model%is_slip_fixed) slip = moved(m + 1:) - (after%instant%motion - before%instant%motion)
      end if
      after%closing_loss = dot_product(after%solution%force(:m), merge(model%solver%loads%gap_of(before%instant) &
         - before%solution%displacement(:m), 0.0_dp, before%instant%is_in_reach))
      after%step_dissipation = sum(taken)
      after%dissipation = before%dissipation + taken
      way = tangential_norm(slip, m)
      after%worn = before%worn + pressed*way
      after%wear_depth = before%wear_depth + model%wear*pressed*way
      if (any(model%wear > 0.0_dp) .and. m == n) then
         stiffness = problem%matrix%augmentation
         after%wear_feedback = max(0.0_dp, maxval(model%wear*way*stiffness(:m), mask=pressed > 0.0_dp))
      end if
      after%load_work = before%load_work + load_work
      after%support_work = before%support_work + support_work
      if (allocated(of_poses)) then
         associate (is_held => reshape([model%is_pose_held], shape(of_poses)))
            after%load_work = after%load_work + sum(of_poses, mask=.not. is_held)
            after%support_work = after%support_work + sum(of_poses, mask=is_held)
         end associate
      end if
      after%obstacle_work = before%obstacle_work + obstacle_work
      ! For a body that moves as a whole the scale is the energy of single points with the same displacement.
      energies = max(sum_rounding*max(after%carried_energy, maxval([problem%matrix%augmentation, 0.0_dp])*max( &
         0.0_dp, maxval(abs(after%solution%displacement)), problem%prescribed)**2), after%step_dissipation, &
         abs(after%strain_energy - before%strain_energy), abs(after%load_work - before%load_work + after%support_work &
         - before%support_work + obstacle_work))
      if (energies > 0.0_dp) after%indicator = sum(abs(missing))/energies
      ! Checks the two identities that hold exactly for a step in equilibrium at both ends.
      energy_change = after%strain_energy - before%strain_energy
      own_energy = model%energies%strain_energy(problem, change, strained)
      end_work = model%energies%load_work(after%instant%factor, change, strained) + dot_product(after%reaction, change)
      size_of_terms = max(after%strain_energy, before%strain_energy, rounding_share**2*after%carried_energy, &
         abs(load_work), abs(support_work), abs(end_work), dot_product(abs(force), abs(whole_change)), &
         max(rounding_share*model%energies%stiffness, problem%rounding/limit)*max(sum(v**2), sum((v - v_change)**2), &
         problem%prescribed**2), rounding_share*norm2(force)*max(norm2(force)/model%energies%stiffness, &
         sqrt(max(0.0_dp, after%strain_energy)/model%energies%stiffness)))
      if (.not. size_of_terms > 0.0_dp) return
      after%imbalance = max(abs(load_work + support_work - energy_change - dot_product(mean_force, whole_change)), &
         abs(end_work - energy_change - own_energy - dot_product(force, whole_change)))/size_of_terms

   contains

      !> Shifts and turns of the obstacles (4, sets) [L], [rad].
      pure function ways(instant)
         type(instant_t), intent(in) :: instant !! what acts
         real(dp) :: ways(4, size(after%solution%pushed, 2))
         integer :: i

         ways = 0.0_dp
         if (.not. allocated(instant%motions)) return
         do i = 1, size(ways, 2)
            ways(:, i) = [instant%motions(i)%shift, instant%motions(i)%turn]
         end do
      end function ways

   end subroutine add_works

   !> Slip of the step, in space its length, accumulated slip [L], dissipation [F L], Archard's integral of the pressure
   !> over the slip [F/L] and the depth worn [L] (m, 5).
   pure function step_state_slip_record(self, body) result(record)
      class(step_state_t), intent(in) :: self !! the state
      type(body_t), intent(in) :: body !! the body
      real(dp), allocatable :: record(:, :), slip(:)

      slip = self%slip
      if (size(slip) > size(self%worn)) slip = tangential_norm(self%slip, size(self%worn))
      record = reshape([slip, self%accumulated_slip, self%dissipation, self%worn/body%zone%area, &
         self%wear_depth], [size(slip), 5])
   end function step_state_slip_record

   !> The works minus strain energy and dissipation: the error of the time stepping [F L].
   pure real(dp) function step_state_energy_error(self) result(energy_error)
      class(step_state_t), intent(in) :: self !! the state

      energy_error = self%load_work + self%support_work + self%obstacle_work - self%strain_energy &
         - sum(self%dissipation)
   end function step_state_energy_error

end module amontons_history_model
