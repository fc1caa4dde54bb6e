!> The contact problem of every step of a history: load, gap and friction at a time.
!>
!> The condensed load is linear in the factors of loads and prescribed displacements, so that one substitution for each
!> of them serves all steps. Part 1 is what does not change.
module amontons_history_model
   use amontons_body, only: body_t
   use amontons_checksum, only: checksum_t
   use amontons_config, only: config_t
   use amontons_constraints, only: constraints_t, new_constraints, support_t
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_set, only: contact_t
   use amontons_energy_form, only: energy_form_t, new_energy_form
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_history, only: history_t, stepped_friction, stepped_load, stepped_obstacle, stepped_support
   use amontons_kinds, only: dp
   use amontons_load_case, only: condense_load_case, condensed_force, load_case_t, pose_problem, set_obstacles
   use amontons_loads, only: load_t, load_vector, sum_thermal_strain
   use amontons_methods, only: new_contact_method
   use amontons_model_warnings, only: body_size
   use amontons_obstacle_motion, only: find_feet, obstacle_motion_t, tangential_motion
   use amontons_rigid_modes, only: check_common_motion
   use amontons_spin, only: can_spin
   use amontons_surface_stress, only: new_surface_stress, surface_stress_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: find_probes, history_model_t, instant_t, moved_contacts, new_history_model

   !> What all steps share.
   type :: history_model_t
      type(history_t) :: history !! times and changes
      class(contact_method_t), allocatable :: method !! the contact method
      type(load_case_t) :: fixed !! the load case of the deck as it stands
      integer, allocatable, private :: part_of(:) !! part of each change of a load or support; 0 for the others
      type(load_case_t), allocatable, private :: parts(:) !! force and prescribed displacement of each part
      real(dp), allocatable, private :: load(:, :) !! condensed load of each part (2m, parts) [F]
      real(dp), allocatable, private :: largest(:) !! largest displacement that each part prescribes (parts) [L]
      real(dp), allocatable, private :: feet(:, :) !! feet of the contact points on the obstacles (2, quadrature points)
      real(dp) :: size_of_body = 0.0_dp !! the larger side of the box around the mesh [L]
      logical :: may_spin = .false. !! whether the body may have a motion that friction alone opposes
      logical :: may_move = .false. !! whether it has a free motion that no contact point notices
      type(energy_form_t) :: energies !! energies in terms of factors and contact displacements
      type(surface_stress_t), allocatable :: surface !! stresses of the surface, where they are asked for
      real(dp), allocatable :: cycle_times(:) !! times at which cycles begin and end, ascending; none without cycles [-]
      integer, allocatable :: probe(:) !! nodes whose displacements are followed
      real(dp), allocatable, private :: probe_row(:, :) !! their displacements per contact displacement (2m, 2 probes)
   contains
      procedure :: acting => history_model_acting
      procedure :: at => history_model_at
      procedure :: cycle_at => history_model_cycle_at
      procedure :: fingerprint => history_model_fingerprint
      procedure :: load_case => history_model_load_case
      procedure :: pose => history_model_pose
      procedure :: probed => history_model_probed
   end type history_model_t

   !> What acts at a time.
   type :: instant_t
      real(dp) :: time = 0.0_dp !! the time [-]
      real(dp), allocatable :: numbers(:) !! the numbers of all changes, in the deck's order
      real(dp), allocatable :: factor(:) !! factor of each part [-]
      real(dp), allocatable :: gap(:) !! distance d to the obstacle where it is now (m) [L]
      logical, allocatable :: is_in_reach(:) !! whether the normal meets the obstacle (m)
      real(dp), allocatable :: motion(:) !! how far the obstacle has moved along the tangent (m) [L]
      type(obstacle_motion_t), allocatable :: motions(:) !! the motion of the obstacle of each contact set
      real(dp), allocatable :: friction(:) !! Coulomb coefficient phi (m) [-]
   end type instant_t

contains

   !> Separates what changes from what does not, and condenses each part.
   subroutine new_history_model(model, body, problem, prepared, config, error)
      type(history_model_t), intent(out) :: model !! the model
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(load_case_t), intent(in) :: prepared !! the load case of the deck as it stands
      type(config_t), intent(in) :: config !! the deck
      type(error_t), allocatable, intent(out) :: error !! no such method; loads, supports or probes do not fit the body
      type(contact_problem_t) :: posed
      type(error_t), allocatable :: no_hold
      integer :: i

      call new_contact_method(model%method, config%method, error)
      if (allocated(error)) return
      model%history = config%history
      model%fixed = prepared
      model%size_of_body = body_size(body)
      ! Which points are in reach of an obstacle that moves is known step by step.
      model%may_spin = can_spin(body, model%fixed%is_in_reach .and. .not. any(model%history%steps%target &
         == stepped_obstacle))
      call check_common_motion(body%motions, body%rigid_modes, no_hold)
      model%may_move = allocated(no_hold)
      call number_parts(model)
      do i = 1, size(model%parts)
         call fill_part(model, i, body, config, error)
         if (allocated(error)) return
      end do
      allocate (model%load(2*body%zone%n_points, size(model%parts)), model%largest(size(model%parts)))
      posed = problem
      do i = 1, size(model%parts)
         call condense_load_case(model%parts(i), body)
         call pose_problem(posed, body, model%parts(i))
         model%load(:, i) = posed%load
         model%largest(i) = posed%prescribed
      end do
      call new_energy_form(model%energies, body, model%parts)
      model%feet = find_feet(body%zone, config%contacts)
      model%cycle_times = model%history%cycle_ends()
      if (model%history%has_fretting) then
         allocate (model%surface)
         call new_surface_stress(model%surface, body, config%contacts, model%parts, model%energies%field, error)
         if (allocated(error)) return
      end if
      call find_probes(model%probe, model%history, body, error)
      if (allocated(error)) return
      call condense_probes(model, body)
   end subroutine new_history_model

   !> Which cycle ends at a time: 0 where the first one begins, -1 where none does.
   pure integer function history_model_cycle_at(self, time) result(cycle)
      class(history_model_t), intent(in) :: self !! the model
      real(dp), intent(in) :: time !! the time [-]
      integer :: n

      n = count(self%cycle_times <= time)
      cycle = -1
      if (n == 0) return
      if (self%cycle_times(n) >= time) cycle = n - 1
   end function history_model_cycle_at

   !> Gives every change of a load or support a part.
   pure subroutine number_parts(model)
      type(history_model_t), intent(inout) :: model !! gains the parts, still empty
      integer :: i, n

      allocate (model%part_of(size(model%history%steps)), source=0)
      n = 1
      do i = 1, size(model%part_of)
         if (all(model%history%steps(i)%target /= [stepped_load, stepped_support])) cycle
         n = n + 1
         model%part_of(i) = n
      end do
      allocate (model%parts(n))
   end subroutine number_parts

   !> Sums the loads and the prescribed displacements of a part.
   subroutine fill_part(model, part, body, config, error)
      type(history_model_t), intent(inout) :: model !! the model
      integer, intent(in) :: part !! the part
      type(body_t), intent(in) :: body !! the body
      type(config_t), intent(in) :: config !! the deck
      type(error_t), allocatable, intent(out) :: error !! a load or support does not fit the mesh, or two contradict
      type(constraints_t) :: constraints
      type(support_t), allocatable :: supports(:)
      type(load_t), allocatable :: loads(:)
      integer :: i

      loads = pack_loads(config%loads, [(part_acting(model, stepped_load, config%loads(i)%name) == part, &
         i=1, size(config%loads))])
      supports = config%supports
      do i = 1, size(supports)
         if (part_acting(model, stepped_support, supports(i)%name) /= part) supports(i)%displacement = 0.0_dp
      end do
      model%parts(part) = model%fixed
      call load_vector(model%parts(part)%force, body%mesh, body%materials, loads, error)
      if (.not. allocated(error)) call sum_thermal_strain(model%parts(part)%thermal_strain, body%mesh, &
         body%materials, loads, error)
      if (.not. allocated(error)) call new_constraints(constraints, model%parts(part)%prescribed, body%mesh, &
         supports, error)
      if (allocated(error)) return
      model%parts(part)%prescribed = body%dof_map%substitution%displacement(model%parts(part)%prescribed)
   end subroutine fill_part

   !> The loads that are meant.
   pure function pack_loads(loads, is_meant) result(packed)
      type(load_t), intent(in) :: loads(:) !! the loads
      logical, intent(in) :: is_meant(:) !! whether each is meant
      type(load_t), allocatable :: packed(:)
      integer :: i

      associate (places => pack([(i, i=1, size(loads))], is_meant))
         allocate (packed(size(places)))
         do i = 1, size(places)
            packed(i) = loads(places(i))
         end do
      end associate
   end function pack_loads

   !> The part that a load or support of a name belongs to.
   pure integer function part_acting(model, target, name) result(part)
      type(history_model_t), intent(in) :: model !! the model
      integer, intent(in) :: target !! `stepped_load` or `stepped_support`
      character(*), intent(in) :: name !! the name; empty for none
      integer :: i

      do i = 1, size(model%part_of)
         part = model%part_of(i)
         if (model%history%steps(i)%target == target .and. model%history%steps(i)%name == name) return
      end do
      part = 1
   end function part_acting

   !> Finds the nodes at the probes.
   subroutine find_probes(nodes, history, body, error)
      integer, allocatable, intent(out) :: nodes(:) !! the nodes (probes)
      type(history_t), intent(in) :: history !! the history
      type(body_t), intent(in) :: body !! the body
      type(error_t), allocatable, intent(out) :: error !! no node is there
      integer :: i

      allocate (nodes(history%n_probes()))
      do i = 1, size(nodes)
         associate (position => history%probes(2*i - 1:2*i))
            nodes(i) = body%mesh%nearest_node(position)
            if (nodes(i) > 0) cycle
            call new_error(error, input_refused, 'probe: no node at the point '//to_text(position(1))//', '// &
               to_text(position(2)))
            return
         end associate
      end do
   end subroutine find_probes

   !> Finds what the displacements of the probes are in terms of the contact displacements.
   subroutine condense_probes(model, body)
      type(history_model_t), intent(inout) :: model !! the model, its probes known
      type(body_t), intent(in) :: body !! the body, condensed
      real(dp) :: unit(2, body%mesh%n_nodes)
      integer :: i, component

      allocate (model%probe_row(2*body%zone%n_points, 2*size(model%probe)))
      do i = 1, size(model%probe)
         do component = 1, 2
            unit = 0.0_dp
            unit(component, model%probe(i)) = 1.0_dp
            model%probe_row(:, 2*(i - 1) + component) = condensed_force(body, unit)
         end do
      end do
   end subroutine condense_probes

   !> What acts at a time.
   subroutine history_model_at(self, body, time, instant, error)
      class(history_model_t), intent(in) :: self !! the model
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: time !! the time, not outside of the history [-]
      type(instant_t), intent(out) :: instant !! what acts
      type(error_t), allocatable, intent(out) :: error !! an obstacle has moved too far into the body, or past it
      real(dp), allocatable :: numbers(:)
      integer :: i

      allocate (numbers(0))
      do i = 1, size(self%history%steps)
         numbers = [numbers, self%history%numbers(i, time)]
      end do
      call self%acting(body, time, numbers, instant, error)
   end subroutine history_model_at

   !> What acts if the changes have some numbers.
   subroutine history_model_acting(self, body, time, numbers, instant, error)
      class(history_model_t), intent(in) :: self !! the model
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: time !! the time [-]
      real(dp), intent(in) :: numbers(:) !! the numbers of all changes, in the deck's order
      type(instant_t), intent(out) :: instant !! what acts
      type(error_t), allocatable, intent(out) :: error !! an obstacle has moved too far into the body, or past it
      type(load_case_t) :: moved
      real(dp) :: friction_factor(size(self%fixed%contacts))
      integer :: i, k, first

      instant%time = time
      instant%numbers = numbers
      allocate (instant%factor(size(self%parts)), source=1.0_dp)
      allocate (instant%motions(size(friction_factor)))
      friction_factor = 1.0_dp
      first = 1
      do i = 1, size(self%history%steps)
         if (self%part_of(i) > 0) instant%factor(self%part_of(i)) = numbers(first)
         do k = 1, size(friction_factor)
            if (.not. self%history%steps(i)%acts_on(self%fixed%contacts(k))) cycle
            if (self%history%steps(i)%target == stepped_friction) friction_factor(k) = numbers(first)
            if (self%history%steps(i)%target == stepped_obstacle) instant%motions(k) = &
               obstacle_motion_t(numbers(first:first + 1), numbers(first + 2), self%history%steps(i)%pivot)
         end do
         first = first + self%history%steps(i)%n_numbers()
      end do
      instant%friction = self%fixed%friction*friction_factor(body%zone%set)
      instant%gap = self%fixed%gap
      instant%is_in_reach = self%fixed%is_in_reach
      instant%motion = 0.0_dp*self%fixed%gap
      if (all(instant%motions%is_at_rest())) return
      call set_obstacles(moved, body%zone, body%mesh, moved_contacts(self%fixed%contacts, instant%motions), error)
      if (allocated(error)) return
      instant%gap = moved%gap
      instant%is_in_reach = moved%is_in_reach
      instant%motion = tangential_motion(body%zone, self%feet, instant%motions)
   end subroutine history_model_acting

   !> The contact sets with their obstacles where they have moved to.
   pure function moved_contacts(contacts, motions) result(moved)
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(obstacle_motion_t), intent(in) :: motions(:) !! the motion of each obstacle
      type(contact_t), allocatable :: moved(:)
      integer :: i

      moved = contacts
      do i = 1, size(contacts)
         moved(i)%obstacle = motions(i)%moved(contacts(i)%obstacle)
      end do
   end function moved_contacts

   !> Sets load, gap, anchor and friction of the contact problem to what acts.
   pure subroutine history_model_pose(self, body, instant, anchor, problem)
      class(history_model_t), intent(in) :: self !! the model
      type(body_t), intent(in) :: body !! the body
      type(instant_t), intent(in) :: instant !! what acts
      real(dp), intent(in) :: anchor(:) !! tangential displacements that slips are counted from (m) [L]
      type(contact_problem_t), intent(inout) :: problem !! the contact problem

      problem%load = matmul(self%load, instant%factor)
      problem%prescribed = dot_product(self%largest, abs(instant%factor))
      problem%gap = instant%gap - matmul(self%energies%prescribed(:size(anchor), :), instant%factor)
      associate (is_fixed => body%zone%is_tangent_fixed)
         problem%anchor = merge(0.0_dp, anchor, is_fixed)
         problem%friction = merge(0.0_dp, instant%friction, is_fixed)
         problem%slip_bound = merge(0.0_dp, self%fixed%slip_bound, is_fixed)
      end associate
   end subroutine history_model_pose

   !> The load case of what acts, not condensed.
   subroutine history_model_load_case(self, body, instant, anchor, load_case, error)
      class(history_model_t), intent(in) :: self !! the model
      type(body_t), intent(in) :: body !! the body
      type(instant_t), intent(in) :: instant !! what acts
      real(dp), intent(in) :: anchor(:) !! tangential displacements that slips are counted from (m) [L]
      type(load_case_t), intent(out) :: load_case !! the load case
      type(error_t), allocatable, intent(out) :: error !! an obstacle has moved too far into the body, or past it
      integer :: i

      load_case = self%fixed
      call set_obstacles(load_case, body%zone, body%mesh, moved_contacts(self%fixed%contacts, instant%motions), error)
      if (allocated(error)) return
      load_case%factor = [(instant%factor(part_acting(self, stepped_load, load_case%loads(i)%name)), &
         i=1, size(load_case%loads))]
      load_case%force = 0.0_dp
      load_case%prescribed = 0.0_dp
      if (allocated(load_case%thermal_strain)) load_case%thermal_strain = 0.0_dp
      do i = 1, size(self%parts)
         load_case%force = load_case%force + instant%factor(i)*self%parts(i)%force
         load_case%prescribed = load_case%prescribed + instant%factor(i)*self%parts(i)%prescribed
         if (allocated(self%parts(i)%thermal_strain)) load_case%thermal_strain = load_case%thermal_strain &
            + instant%factor(i)*self%parts(i)%thermal_strain
      end do
      load_case%free_gap = instant%gap - matmul(self%energies%prescribed(:body%zone%n_points, :), instant%factor)
      load_case%friction = instant%friction
      load_case%anchor = anchor
      load_case%obstacle_motion = instant%motion
   end subroutine history_model_load_case

   !> The displacements of the probes, x and y in turn (2 probes) [L].
   pure function history_model_probed(self, factor, v) result(displacement)
      class(history_model_t), intent(in) :: self !! the model
      real(dp), intent(in) :: factor(:) !! factors of the parts [-]
      real(dp), intent(in) :: v(:) !! contact displacements (2m) [L]
      real(dp) :: displacement(2*size(self%probe))
      integer :: i

      displacement = matmul(v, self%probe_row)
      do i = 1, size(self%probe)
         displacement(2*i - 1:2*i) = displacement(2*i - 1:2*i) &
            + matmul(self%energies%field(:, self%probe(i), :), factor)
      end do
   end function history_model_probed

   !> A text that tells whether two models are the same to the last bit: files that a deck names may have changed
   !> although the deck has not.
   pure function history_model_fingerprint(self) result(text)
      class(history_model_t), intent(in) :: self !! the model
      character(:), allocatable :: text
      type(checksum_t) :: checksum
      integer :: i

      call checksum%add([self%fixed%gap, self%fixed%friction, self%fixed%slip_bound])
      do i = 1, size(self%parts)
         call checksum%add(self%load(:, i))
         ! The fields of the parts know the whole stiffness.
         call checksum%add(reshape(self%energies%field(:, :, i), [size(self%energies%field(:, :, i))]))
      end do
      do i = 1, size(self%history%steps)
         if (allocated(self%history%steps(i)%table)) call checksum%add(reshape(self%history%steps(i)%table, &
            [size(self%history%steps(i)%table)]))
      end do
      text = to_text(checksum%value())
   end function history_model_fingerprint

end module amontons_history_model
