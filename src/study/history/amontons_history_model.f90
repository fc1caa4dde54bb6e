!> What acts in every step of a history: the factors of its loads, and where its obstacles are, at a time; and what its
!> steps need to compute energies, probes and stresses of the surface from contact displacements alone.
module amontons_history_model
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_energy_form, only: energy_form_t, new_energy_form
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_history, only: history_t, stepped_friction, stepped_load, stepped_obstacle, stepped_support
   use amontons_kinds, only: dp
   use amontons_load_case, only: condensed_force, load_case_t
   use amontons_load_family, only: acting_t, obstacle_motion_t, one_part, parting_t
   use amontons_load_solver, only: load_solver_t, new_load_solver
   use amontons_surface_stress, only: new_surface_stress, surface_stress_t
   use amontons_system, only: checksum_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: find_probes, history_model_t, instant_t, new_history_model

   !> What all steps share.
   type :: history_model_t
      type(history_t) :: history !! times and changes
      type(load_solver_t) :: solver !! loads, obstacles and friction, and the way to the solution of a step
      integer, allocatable, private :: part_of(:) !! part of each change; 0 for obstacles
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
      procedure :: probed => history_model_probed
   end type history_model_t

   !> What acts at a time.
   type, extends(acting_t) :: instant_t
      real(dp) :: time = 0.0_dp !! the time [-]
      real(dp), allocatable :: numbers(:) !! the numbers of all changes, in the deck's order
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
      type(parting_t) :: parting

      model%history = config%history
      call divide(model%part_of, parting, config%history, prepared)
      call new_load_solver(model%solver, body, prepared, parting, config%method, error)
      if (allocated(error)) return
      associate (loads => model%solver%loads)
         call loads%condense(body, problem)
         call new_energy_form(model%energies, body, loads%parts)
         model%cycle_times = model%history%cycle_ends()
         if (model%history%has_fretting) then
            allocate (model%surface)
            call new_surface_stress(model%surface, body, config%contacts, loads%parts, model%energies%field, error)
            if (allocated(error)) return
         end if
      end associate
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

   !> Gives every change of a load, support or friction a part.
   pure subroutine divide(part_of, parting, history, load_case)
      integer, allocatable, intent(out) :: part_of(:) !! part of each change; 0 for obstacles
      type(parting_t), intent(out) :: parting !! what belongs to which part
      type(history_t), intent(in) :: history !! the history
      type(load_case_t), intent(in) :: load_case !! the load case of the deck as it stands
      integer :: i, k

      parting = one_part(load_case)
      parting%moves_obstacles = any(history%steps%target == stepped_obstacle)
      allocate (part_of(size(history%steps)), source=0)
      do i = 1, size(part_of)
         associate (change => history%steps(i))
            if (change%target == stepped_obstacle) cycle
            parting%n_parts = parting%n_parts + 1
            part_of(i) = parting%n_parts
            do k = 1, size(parting%load)
               if (change%target == stepped_load .and. change%name == load_case%loads(k)%name) then
                  parting%load(k) = part_of(i)
               end if
            end do
            do k = 1, size(parting%support)
               if (change%target == stepped_support .and. change%name == load_case%supports(k)%name) then
                  parting%support(k) = part_of(i)
               end if
            end do
            do k = 1, size(parting%friction)
               if (change%target == stepped_friction .and. change%acts_on(load_case%contacts(k))) then
                  parting%friction(k) = part_of(i)
               end if
            end do
         end associate
      end do
      parting%is_coefficient = spread(.false., 1, parting%n_parts)
   end subroutine divide

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
      type(obstacle_motion_t) :: motions(size(self%solver%loads%base%contacts))
      integer :: i, k, first

      call self%solver%loads%at_rest(instant)
      instant%time = time
      instant%numbers = numbers
      first = 1
      do i = 1, size(self%history%steps)
         associate (change => self%history%steps(i))
            if (self%part_of(i) > 0) instant%factor(self%part_of(i)) = numbers(first)
            do k = 1, size(motions)
               if (change%target /= stepped_obstacle) exit
               if (change%acts_on(self%solver%loads%base%contacts(k))) motions(k) = &
                  obstacle_motion_t(numbers(first:first + 1), numbers(first + 2), change%pivot)
            end do
            first = first + change%n_numbers()
         end associate
      end do
      call self%solver%loads%move(body, motions, instant, error)
   end subroutine history_model_acting

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

   !> Text that two models share only if they are the same to the last bit: files that a deck names may have changed
   !> although the deck has not.
   pure function history_model_fingerprint(self, body, problem) result(text)
      class(history_model_t), intent(in) :: self !! the model
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      character(:), allocatable :: text
      type(checksum_t) :: checksum
      integer :: i

      do i = 1, size(self%history%steps)
         associate (steps => self%history%steps(i))
            if (.not. allocated(steps%values)) call checksum%add(reshape(steps%table, [size(steps%table)]))
         end associate
      end do
      text = self%solver%loads%fingerprint(body, problem)//' '//to_text(checksum%value())
   end function history_model_fingerprint

end module amontons_history_model
