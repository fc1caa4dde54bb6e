!> Time stepping through a history: steps between the planned times, each halved if it does not converge or its energies
!> do not balance; and the records of the cycles.
!>
!> The interval between two planned times is divided by halves, so that a step always begins and ends at a multiple of
!> its own length. Decisions depend on computed numbers rounded to few digits, so that the steps are the same on every
!> machine.
!>
!> The record of a cycle compares it with the cycle before, and has parameters of fretting from surface stresses
!> and slips: those of Ruiz, and that of Smith, Watson and Topper on the critical plane. These are computed from the
!> largest values of some numbers over the steps of the cycle, so that no step needs to be stored.
module amontons_time_stepping
   use amontons_body, only: body_t
   use amontons_checkpoint, only: archive_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_friction_law, only: tangential_norm
   use amontons_history, only: history_t
   use amontons_history_model, only: history_model_t, instant_t, new_step_state, restore_step_state, step_state_t, &
      take_step
   use amontons_kinds, only: dp
   use amontons_result, only: outcome_no_equilibrium, outcome_not_converged, outcome_solved
   use amontons_rounding, only: computed_rounding, first_largest
   use amontons_surface_stress, only: surface_stress_t
   use amontons_text, only: rounded, to_text
   implicit none (type, external)
   private

   public :: cycle_outcomes, n_cycle_numbers, n_parameters, n_plain_numbers, new_time_stepping, parameter_names, &
      time_stepping_t

   !> Classes of cycles: the first; without slip; like the one before; like the one before except for a constant drift
   !> of the points; different from the one before.
   character(10), parameter :: cycle_outcomes(*) = [character(10) :: 'first', 'shakedown', 'steady', 'ratcheting', &
      'changing']
   !> Indices of the classes in `cycle_outcomes`.
   integer, parameter :: first_cycle = 1, shakedown = 2, steady = 3, ratcheting = 4, changing = 5
   !> Number of numbers of a cycle other than those of fretting, as `cycle_record_finish` orders them.
   integer, parameter :: n_plain_numbers = 14
   !> Number of all numbers of a cycle.
   integer, parameter :: n_cycle_numbers = n_plain_numbers + 3
   !> Numbers of each point at the beginning of a cycle: those without direction, and those for each tangent.
   integer, parameter :: n_scalars = 3, n_tangentials = 3

   !> Numbers of angles between the normals of planes through a point and the surface, in the plane and in space: 2 and
   !> 5 degrees apart. In space there are as many directions along the surface for each.
   integer, parameter :: n_angles(2:3) = [90, 36], n_planes(2:3) = [90, 36**2]
   !> Number of directions in which the ranges of slips are measured, in the plane and in space: there 2 degrees apart.
   integer, parameter :: n_ways(2:3) = [1, 90]
   !> Number of values of a point whose largest ones are kept: shear, stress along the surface, slips in all directions
   !> and their opposites; stress, strain and the opposite of the strain along the normal of each plane.
   integer, parameter :: n_extremes(2:3) = 2 + 2*n_ways + 3*n_planes
   !> Number of fretting parameters.
   integer, parameter :: n_parameters = 5
   !> Names of the fretting parameters in tables.
   character(14), parameter :: parameter_names(n_parameters) = [character(14) :: 'surface_stress', 'ruiz_1', 'ruiz_2', &
      'swt', 'swt_angle']

   !> Surface stresses and extremes of a cycle, for the fretting parameters.
   type :: fretting_t
      real(dp), allocatable :: stress(:, :) !! stresses of the surface at the end of the last step (2 n_dim, m) [F/L^2]
      real(dp), allocatable :: extreme(:, :) !! largest values over the cycle (n_extremes, m)
   contains
      procedure :: add => fretting_add
      procedure :: parameters => fretting_parameters
   end type fretting_t

   !> The record of the present cycle and the numbers of the last complete one.
   type :: cycle_record_t
      logical :: is_finished = .false. !! whether the last step ended a cycle
      real(dp) :: numbers(n_cycle_numbers) = 0.0_dp !! the last complete cycle, as `cycle_record_finish` orders them
      type(fretting_t) :: fretting !! stresses and slips of the cycle so far
      logical, private :: is_begun = .false. !! whether the beginning of the cycle was seen
      logical, private :: has_before = .false. !! whether the cycle before was seen from beginning to end
      integer, private :: n_steps = 0 !! steps of the cycle so far
      real(dp), private :: begin = 0.0_dp !! time of its beginning [-]
      real(dp), private :: work = 0.0_dp !! work since rest, at its beginning [F L]
      real(dp), private :: strain_energy = 0.0_dp !! strain energy at its beginning [F L]
      real(dp), private :: turnover = 0.0_dp !! sum of the works of its steps, each counted positive [F L]
      real(dp), private :: dissipation_before = 0.0_dp !! dissipation of the cycle before [F L]
      real(dp), allocatable, private :: points(:, :)
         !! at its beginning contact forces, position, accumulated slip, dissipation; drift of the cycle before (m, any)
   contains
      procedure :: add_step => cycle_record_add_step
      procedure :: saved_numbers => cycle_record_saved_numbers
      procedure :: restore => cycle_record_restore
      procedure, private :: start => cycle_record_start
      procedure, private :: finish => cycle_record_finish
   end type cycle_record_t

   !> Largest number of halvings of a planned step.
   integer, parameter :: most_halvings = 10
   !> Length of a planned step in the smallest steps (ticks).
   integer, parameter :: n_ticks = 2**most_halvings

   !> Number of saved numbers other than those of the state and of the cycle.
   integer, parameter :: n_own = 5

   !> The state of the time stepping after the last accepted step.
   type :: time_stepping_t
      type(step_state_t) :: state !! the state at the end of the last accepted step
      type(cycle_record_t) :: record !! the present cycle
      integer :: n_planned = 0 !! number of planned times reached
      integer :: n_steps = 0 !! number of accepted steps
      integer :: n_rejected = 0 !! number of steps rejected for shorter ones
      integer :: n_iterations = 0 !! iterations of all steps, rejected ones included
      logical :: is_ended = .false. !! whether all times are reached, or a step could not be taken
      character(:), allocatable :: fault !! why a step cannot be taken; empty as long as all could
      integer :: outcome = outcome_solved !! outcome of the last step, accepted or not
      integer :: fault_kind = 0 !! exit status of that error; 0 for a step that does not converge
      real(dp) :: fault_time = 0.0_dp !! the time that the step would have led to [-]
      logical :: is_jump = .false. !! whether the energies of the last step do not balance
      integer, private :: tick = 0 !! progress towards the next planned time, in smallest steps
      integer, private :: length = n_ticks !! length of the next step in smallest steps
   contains
      procedure :: advance => time_stepping_advance
      procedure :: accept => time_stepping_accept
      procedure :: numbers => time_stepping_numbers
      procedure :: point_record => time_stepping_point_record
      procedure :: restore => time_stepping_restore
      procedure, private :: can_halve => time_stepping_can_halve
      procedure, private :: next_time => time_stepping_next_time
   end type time_stepping_t

contains

   !> Adds an accepted step to the record.
   pure subroutine cycle_record_add_step(self, model, before, after)
      class(cycle_record_t), intent(inout) :: self !! the cycle; gains the step
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: before !! the state at the beginning of the step
      type(step_state_t), intent(in) :: after !! the state at its end

      self%is_finished = .false.
      if (model%cycle_at(before%instant%time) >= 0) call self%start(before)
      if (allocated(model%surface)) then
         if (model%cycle_at(before%instant%time) >= 0) then
            self%fretting%extreme = -huge(1.0_dp)
            call self%fretting%add(model%surface, surface_stress(model, before), position(before))
         end if
         call self%fretting%add(model%surface, surface_stress(model, after), position(after))
      end if
      if (.not. self%is_begun) return
      self%n_steps = self%n_steps + 1
      self%turnover = self%turnover + abs(work(after) - work(before))
      if (model%cycle_at(after%instant%time) > 0 .and. after%instant%time > self%begin) call self%finish(model, after)
   end subroutine cycle_record_add_step

   !> Stresses at the surface in a state, as `surface_stress_stress` orders them (2 n_dim, m) [F/L^2].
   pure function surface_stress(model, state) result(stress)
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: state !! the state
      real(dp), allocatable :: stress(:, :)

      stress = model%surface%stress(state%instant%factor, state%solution%displacement, state%solution%force)
   end function surface_stress

   !> Displacements of the points along their tangents relative to the obstacle (n_rows - m) [L].
   pure function position(state)
      type(step_state_t), intent(in) :: state !! a state
      real(dp) :: position(size(state%instant%motion))

      position = state%solution%displacement(size(state%solution%status) + 1:) - state%instant%motion
   end function position

   !> Work of loads, supports and obstacles since rest [F L].
   pure real(dp) function work(state)
      type(step_state_t), intent(in) :: state !! a state

      work = state%load_work + state%support_work + state%obstacle_work
   end function work

   !> Begins a cycle. The numbers of the one before are kept for the comparison.
   pure subroutine cycle_record_start(self, state)
      class(cycle_record_t), intent(inout) :: self !! the cycle; becomes a new one
      type(step_state_t), intent(in) :: state !! the state at its beginning
      self%is_begun = .true.
      self%n_steps = 0
      self%begin = state%instant%time
      self%work = work(state)
      self%strain_energy = state%strain_energy
      self%turnover = 0.0_dp
      associate (m => size(state%worn), n => size(self%points, 2) - size(state%instant%motion)/max(1, size(state%worn)))
         self%points(:, :n) = reshape([state%solution%force, position(state), state%accumulated_slip, &
            state%dissipation], [m, n])
      end associate
   end subroutine cycle_record_start

   !> Ends a cycle: computes its numbers, and keeps those that the next one is compared with.
   pure subroutine cycle_record_finish(self, model, state)
      class(cycle_record_t), intent(inout) :: self !! the cycle; gains its numbers
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: state !! the state at its end
      real(dp) :: drift(size(state%instant%motion)), slip(size(state%worn)), dissipation, changes(3), largest
      real(dp), allocatable :: parameters(:, :)
      integer :: t, m

      ! The columns: 1 + t forces, t positions, slip, dissipation, t drifts.
      t = (size(self%points, 2) - n_scalars)/n_tangentials
      drift = position(state) - reshape(self%points(:, t + 2:2*t + 1), shape(drift))
      slip = state%accumulated_slip - self%points(:, 2*t + 2)
      dissipation = sum(state%dissipation - self%points(:, 2*t + 3))
      m = size(slip)
      associate (force => state%solution%force, before => reshape(self%points(:, :1 + t), [m*(1 + t)]))
         largest = max(tiny(1.0_dp), maxval(abs(force(:m))), maxval(tangential_norm(force(m + 1:), m)), &
            maxval(abs(before(:m))), maxval(tangential_norm(before(m + 1:), m)))
         changes = [(dissipation - self%dissipation_before)/max(tiny(1.0_dp), dissipation, self%dissipation_before, &
            computed_rounding*self%turnover), max(maxval(abs(force(:m) - before(:m))), &
            maxval(tangential_norm(force(m + 1:) - before(m + 1:), m)))/largest, &
            maxval(tangential_norm(drift - reshape(self%points(:, 2*t + 4:), shape(drift)), m))]
      end associate
      self%numbers = 0.0_dp
      self%numbers(:n_plain_numbers) = [real(model%cycle_at(state%instant%time), dp), self%begin, state%instant%time, &
         real(self%n_steps, dp), work(state) - self%work, state%strain_energy - self%strain_energy, dissipation, &
         work(state) - self%work - (state%strain_energy - self%strain_energy) - dissipation, maxval(slip), &
         maxval(tangential_norm(drift, m)), changes, &
         real(outcome(self%has_before, dissipation <= computed_rounding*self%turnover, changes, maxval(slip), &
         maxval(tangential_norm(drift, m)), model%history%cycle_tolerance), dp)]
      if (allocated(model%surface)) then
         parameters = self%fretting%parameters()
         self%numbers(n_plain_numbers + 1:) = maxval(parameters(:, 2:4), dim=1)
      end if
      self%dissipation_before = dissipation
      self%points(:, 2*t + 4:) = reshape(drift, [m, t])
      self%has_before = .true.
      self%is_begun = .false.
      self%is_finished = .true.
   end subroutine cycle_record_finish

   !> The class of a cycle. In a steady and in a ratcheting cycle dissipation and forces are those of the cycle before;
   !> in the former the points return to their positions, in the latter they drift by the same amount again.
   pure integer function outcome(has_before, is_without_slip, changes, slip, drift, tolerance)
      logical, intent(in) :: has_before !! whether there is a cycle before
      logical, intent(in) :: is_without_slip !! whether nothing slips in it
      real(dp), intent(in) :: changes(3) !! change of dissipation [-], of forces [-], of drift [L]
      real(dp), intent(in) :: slip !! largest accumulated slip [L]
      real(dp), intent(in) :: drift !! largest drift [L]
      real(dp), intent(in) :: tolerance !! a smaller change counts as none [-]

      outcome = changing
      if (changes(2) <= tolerance .and. is_without_slip) then
         outcome = shakedown
      else if (.not. has_before) then
         outcome = first_cycle
      else if (abs(changes(1)) <= tolerance .and. changes(2) <= tolerance) then
         if (changes(3) <= tolerance*drift) outcome = ratcheting
         if (drift <= tolerance*slip) outcome = steady
      end if
   end function outcome

   !> The numbers from which the record is restored.
   pure function cycle_record_saved_numbers(self) result(numbers)
      class(cycle_record_t), intent(in) :: self !! the cycle
      real(dp), allocatable :: numbers(:)
      type(cycle_record_t) :: record
      type(archive_t) :: archive

      record = self
      allocate (archive%numbers(0))
      call visit(record, archive)
      numbers = archive%numbers(:archive%n)
   end function cycle_record_saved_numbers

   !> Writes the numbers of the record to an archive, or reads them.
   pure subroutine visit(record, archive)
      type(cycle_record_t), intent(inout) :: record !! the cycle
      type(archive_t), intent(inout) :: archive !! the archive
      integer :: i

      if (size(record%points) > 0) then
         call archive%pass(record%is_begun)
         call archive%pass(record%has_before)
         call archive%pass(record%n_steps)
         call archive%pass(record%begin)
         call archive%pass(record%work)
         call archive%pass(record%strain_energy)
         call archive%pass(record%turnover)
         call archive%pass(record%dissipation_before)
         do i = 1, size(record%points, 2)
            call archive%pass(record%points(:, i))
         end do
      end if
      do i = 1, size(record%fretting%extreme, 2)
         call archive%pass(record%fretting%extreme(:, i))
      end do
   end subroutine visit

   !> Restores the record from its numbers. Numbers of a history with other cycles are ignored, and the record begins
   !> anew.
   pure subroutine cycle_record_restore(self, model, state, numbers)
      class(cycle_record_t), intent(inout) :: self !! the cycle, new
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: state !! the state at the end of the last step
      real(dp), intent(in) :: numbers(:) !! the numbers
      type(archive_t) :: archive

      self%fretting%extreme = -huge(1.0_dp)
      if (allocated(model%surface)) call self%fretting%add(model%surface, surface_stress(model, state), position(state))
      if (size(numbers) /= size(self%saved_numbers())) return
      archive = archive_t(numbers, is_read=.true.)
      call visit(self, archive)
   end subroutine cycle_record_restore

   !> Adds a state: the end of a step or the beginning of the cycle.
   pure subroutine fretting_add(self, surface, stress, position)
      class(fretting_t), intent(inout) :: self !! the cycle; gains the state
      type(surface_stress_t), intent(in) :: surface !! the surface, for its material
      real(dp), intent(in) :: stress(:, :) !! stresses of the surface (2 n_dim, m) [F/L^2]
      real(dp), intent(in) :: position(:) !! tangential displacements less those of the obstacle (n_rows - m) [L]

      self%stress = stress
      self%extreme = max(self%extreme, sample(surface, stress, position, size(stress, 1)/2))
   end subroutine fretting_add

   !> The values of a state whose largest ones are kept (n_extremes, m).
   pure function sample(surface, stress, position, n_dim)
      type(surface_stress_t), intent(in) :: surface !! the surface, for its material
      real(dp), intent(in) :: stress(:, :) !! stresses of the surface (2 n_dim, m) [F/L^2]
      real(dp), intent(in) :: position(:) !! tangential displacements less those of the obstacle (n_rows - m) [L]
      integer, intent(in) :: n_dim !! number of dimensions
      real(dp) :: sample(n_extremes(n_dim), size(stress, 2))
      real(dp) :: of_strain(3*n_dim - 3, n_planes(n_dim)), of_stress(3*n_dim - 3, n_planes(n_dim)), normal(3)
      real(dp) :: way(2, n_ways(n_dim)), slips(n_ways(n_dim)), strain(2*n_dim)
      real(dp), dimension(n_planes(n_dim)) :: on_planes, strains
      logical :: is_seen(2*size(normal))
      integer :: k, p

      is_seen = [.true., .true., n_dim == 3, .true., n_dim == 3, n_dim == 3]
      do k = 1, n_planes(n_dim)
         normal = plane_normal(k, n_dim)
         of_strain(:, k) = pack([normal(1)*normal, normal(2:)**2, normal(2)*normal(3)], is_seen)
         of_stress(:, k) = of_strain(:, k)*pack([1.0_dp, 2.0_dp, 2.0_dp, 1.0_dp, 1.0_dp, 2.0_dp], is_seen)
      end do
      do k = 1, n_ways(n_dim)
         associate (angle => acos(-1.0_dp)/n_ways(n_dim)*(k - 1))
            way(:, k) = [cos(angle), sin(angle)]
         end associate
      end do
      do p = 1, size(stress, 2)
         on_planes = matmul(stress(:3*n_dim - 3, p), of_stress)
         strain = matmul(surface%compliance(:, :, p), stress(:, p))
         strains = matmul(strain(:3*n_dim - 3), of_strain)
         slips = matmul(position(p::size(stress, 2)), way(:n_dim - 1, :))
         sample(:, p) = [norm2(stress(2:n_dim, p)), tension(stress(:, p)), slips, -slips, on_planes, strains, &
            -strains]
      end do
   end function sample

   !> The normal of a plane along the outward normal of the surface and its tangents; its angle to the surface, towards
   !> the outward normal, is 0, 2, -2, 4, ... degrees in the plane, 0, 5, -5, ... in space (3) [-].
   pure function plane_normal(plane, n_dim) result(normal)
      integer, intent(in) :: plane !! number of the plane
      integer, intent(in) :: n_dim !! number of dimensions
      real(dp) :: normal(3), around

      around = acos(-1.0_dp)/n_angles(n_dim)*modulo(plane - 1, n_planes(n_dim)/n_angles(n_dim))
      associate (angle => plane_angle(plane, n_dim))
         normal = [sin(angle), cos(angle)*cos(around), cos(angle)*sin(around)]
      end associate
   end function plane_normal

   !> The angle between the normal of a plane and the surface, towards the outward normal [rad].
   pure real(dp) function plane_angle(plane, n_dim) result(angle)
      integer, intent(in) :: plane !! number of the plane
      integer, intent(in) :: n_dim !! number of dimensions
      integer :: k

      k = 1 + (plane - 1)/(n_planes(n_dim)/n_angles(n_dim))
      angle = acos(-1.0_dp)/n_angles(n_dim)*(k/2*merge(1, -1, modulo(k, 2) == 0))
   end function plane_angle

   !> The stress along the surface, in space the larger principal stress in it [F/L^2].
   pure real(dp) function tension(stress)
      real(dp), intent(in) :: stress(:) !! stresses of a point (2 n_dim) [F/L^2]

      tension = stress(3)
      if (size(stress) == 6) tension = 0.5_dp*(stress(4) + stress(5)) &
         + hypot(0.5_dp*(stress(4) - stress(5)), stress(6))
   end function tension

   !> The fretting parameters of each point over the cycle so far: stress along the surface at the end of the last step
   !> [F/L^2], Ruiz' first [F/L] and second [F^2/L^3], that of Smith, Watson and Topper [F/L^2] and the angle of its
   !> plane [rad] (m, n_parameters).
   pure function fretting_parameters(self) result(parameters)
      class(fretting_t), intent(in) :: self !! the cycle so far
      real(dp) :: parameters(size(self%extreme, 2), n_parameters)
      real(dp) :: on_planes(n_planes(size(self%stress, 1)/2))
      integer :: p, plane, n, slips, first

      n = size(on_planes)
      slips = n_ways(size(self%stress, 1)/2)
      first = 2 + 2*slips
      do p = 1, size(parameters, 1)
         associate (largest => self%extreme(:, p))
            parameters(p, 1) = tension(self%stress(:, p))
            parameters(p, 2) = largest(1)*maxval(largest(3:2 + slips) + largest(3 + slips:first))
            parameters(p, 3) = max(0.0_dp, largest(2))*parameters(p, 2)
            on_planes = max(0.0_dp, largest(first + 1:first + n))*0.5_dp*(largest(first + n + 1:first + 2*n) &
               + largest(first + 2*n + 1:))
            ! The first of equal ones has the smallest angle.
            plane = first_largest(on_planes)
            parameters(p, 4:5) = [on_planes(plane), plane_angle(plane, size(self%stress, 1)/2)]
         end associate
      end do
   end function fretting_parameters

   !> Makes the state before the first time.
   pure subroutine new_time_stepping(stepping, model, body)
      type(time_stepping_t), intent(out) :: stepping !! the time stepping
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body

      call new_step_state(stepping%state, model, body)
      allocate (stepping%record%points(merge(body%zone%n_points, 0, size(model%cycle_times) > 0), &
         n_scalars + n_tangentials*body%zone%n_tangents), source=0.0_dp)
      allocate (stepping%record%fretting%extreme(n_extremes(size(body%zone%position, 1)), &
         merge(body%zone%n_points, 0, allocated(model%surface))), source=0.0_dp)
      stepping%fault = ''
   end subroutine new_time_stepping

   !> The numbers from which the time stepping is restored.
   pure function time_stepping_numbers(self) result(numbers)
      class(time_stepping_t), intent(in) :: self !! the time stepping
      real(dp), allocatable :: numbers(:)
      real(dp), allocatable :: saved_numbers(:)

      saved_numbers = self%record%saved_numbers()
      numbers = [real([self%n_steps, self%n_rejected, self%n_iterations, self%length, size(saved_numbers)], dp), &
         self%state%numbers(), saved_numbers]
   end function time_stepping_numbers

   !> Restores the time stepping from its numbers, which may be those of a history with other times.
   subroutine time_stepping_restore(self, model, body, problem, numbers, error)
      class(time_stepping_t), intent(inout) :: self !! the time stepping, new
      type(history_model_t), intent(inout) :: model !! the model
      type(body_t), intent(inout) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      real(dp), intent(in) :: numbers(:) !! the numbers
      type(error_t), allocatable, intent(out) :: error !! they do not fit body and history
      type(instant_t) :: instant
      integer :: last
      real(dp) :: start

      last = -1
      if (size(numbers) > n_own) last = size(numbers) - nint(max(0.0_dp, min(numbers(n_own), real(size(numbers), dp))))
      if (last <= n_own) then
         call new_error(error, input_refused, 'it is of '//to_text(size(numbers))//' numbers')
         return
      end if
      associate (time => numbers(n_own + 1), times => model%history%times)
         if (time < times(1) .or. time > times(size(times))) then
            call new_error(error, input_refused, 'it is of the time '//to_text(time)//', the times are from '// &
               to_text(times(1))//' to '//to_text(times(size(times))))
            return
         end if
         call model%at(body, time, instant, error)
      end associate
      if (.not. allocated(error)) call restore_step_state(self%state, model, body, problem, &
         numbers(n_own + 1:last), instant, error)
      if (allocated(error)) return
      call self%record%restore(model, self%state, numbers(last + 1:))
      self%n_steps = nint(numbers(1))
      self%n_rejected = nint(numbers(2))
      self%n_iterations = nint(numbers(3))
      associate (time => self%state%instant%time, history => model%history)
         self%n_planned = count(history%planned <= time)
         self%is_ended = self%n_planned == size(history%planned)
         if (self%is_ended) return
         start = history%planned(self%n_planned)
         self%tick = nint(n_ticks*((time - start)/(history%planned(self%n_planned + 1) - start)))
      end associate
      ! A time of another history may be no multiple of the step: it is rounded to the smallest steps.
      self%length = nint(numbers(4))
      do while (modulo(self%tick, self%length) /= 0)
         self%length = self%length/2
      end do
   end subroutine time_stepping_restore

   !> Takes the next step, with the length at which it succeeds. Does nothing after the last time, or after a step that
   !> could not be taken.
   subroutine time_stepping_advance(self, model, body, problem)
      class(time_stepping_t), intent(inout) :: self !! the time stepping
      type(history_model_t), intent(inout) :: model !! the model
      type(body_t), intent(inout) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(step_state_t) :: next
      type(error_t), allocatable :: error
      character(:), allocatable :: answer
      real(dp) :: time, answer_time
      type(instant_t) :: instant

      self%is_jump = .false.
      answer_time = 0.0_dp
      if (self%is_ended) return
      call model%enter_step(body, problem, self%state, error)
      do
         time = self%next_time(model%history)
         ! Takes a step to a time, and counts its iterations.
         next%outcome = outcome_not_converged
         next%reason = ''
         next%solution%is_converged = .false.
         next%solution%n_iterations = 0
         if (.not. allocated(error)) call model%at(body, time, instant, error)
         if (.not. allocated(error)) call take_step(next, model, body, problem, self%state, instant)
         self%n_iterations = self%n_iterations + next%solution%n_iterations
         if (next%outcome == outcome_no_equilibrium) then
            answer = next%reason
            answer_time = time
         end if
         if (has_balance(next, model%history) .or. .not. self%can_halve(model%history)) exit
         self%n_rejected = self%n_rejected + 1
         self%length = self%length/2
      end do
      if (allocated(answer) .and. next%outcome == outcome_not_converged .and. .not. allocated(error)) then
         ! No equilibrium of a longer step is more informative than no convergence of a shorter one.
         next%outcome = outcome_no_equilibrium
         call move_alloc(answer, next%reason)
         time = answer_time
      end if
      ! Keeps a step that is not made shorter, or ends the time stepping if it could not be taken.
      self%fault_time = time
      self%outcome = next%outcome
      if (allocated(error)) then
         self%fault_kind = error%kind
         call end_stepping(self, time, error%message)
      else if (len(next%reason) > 0) then
         self%fault_kind = next%error_kind
         call end_stepping(self, time, next%reason)
      else if (.not. next%solution%is_converged) then
         call end_stepping(self, time, 'not converged with the smallest step')
      else
         call self%accept(model, next)
      end if
   end subroutine time_stepping_advance

   !> Whether a step converged and its energies balance.
   pure logical function has_balance(state, history)
      type(step_state_t), intent(in) :: state !! the state at the end of the step
      type(history_t), intent(in) :: history !! the history

      has_balance = state%solution%is_converged
      ! Without a tolerance the indicator is not rounded, which takes a tenth of the time of a small step.
      if (has_balance .and. history%step_tolerance < huge(1.0_dp)) has_balance = rounded(state%indicator, 3) &
         <= history%step_tolerance
   end function has_balance

   !> Ends the time stepping at the last accepted step.
   pure subroutine end_stepping(stepping, time, reason)
      type(time_stepping_t), intent(inout) :: stepping !! the time stepping
      real(dp), intent(in) :: time !! the time that the step would have led to [-]
      character(*), intent(in) :: reason !! why it cannot be taken

      stepping%is_ended = .true.
      stepping%fault = 'step '//to_text(stepping%n_steps + 1)//' (to '//to_text(time)//'): '//reason// &
         '; the history ends at step '//to_text(stepping%n_steps)
   end subroutine end_stepping

   !> Accepts a step. The next one is twice as long if it then begins at a multiple of its own length.
   pure subroutine time_stepping_accept(self, model, state)
      class(time_stepping_t), intent(inout) :: self !! the time stepping
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: state !! the state at the end of the step

      call self%record%add_step(model, self%state, state)
      self%state = state
      self%n_steps = self%n_steps + 1
      ! Loads that act at once on a body at rest cause no jump: before the first time shorter steps are impossible.
      self%is_jump = self%n_planned > 0 .and. .not. has_balance(state, model%history)
      self%tick = modulo(self%tick + self%length, n_ticks)
      if (self%tick == 0) self%n_planned = self%n_planned + 1
      self%is_ended = self%n_planned == size(model%history%planned)
      if (modulo(self%tick, 2*self%length) == 0) self%length = min(n_ticks, 2*self%length)
   end subroutine time_stepping_accept

   !> Slip of the step, accumulated slip [L], dissipation [F L], Archard's integral of the pressure over the slip [F/L],
   !> the depth worn [L] and, if they are computed, the fretting parameters (m, 5 or 10).
   pure function time_stepping_point_record(self, body) result(record)
      class(time_stepping_t), intent(in) :: self !! the time stepping
      type(body_t), intent(in) :: body !! the body
      real(dp), allocatable :: record(:, :)

      record = self%state%slip_record(body)
      if (size(self%record%fretting%extreme) > 0) record = reshape([record, self%record%fretting%parameters()], &
         [size(record, 1), size(record, 2) + n_parameters])
   end function time_stepping_point_record

   !> The time at which the next step ends [-].
   pure real(dp) function time_stepping_next_time(self, history) result(time)
      class(time_stepping_t), intent(in) :: self !! the time stepping
      type(history_t), intent(in) :: history !! the history
      real(dp) :: start

      if (self%n_planned == 0) then
         time = history%times(1)
         return
      end if
      time = history%planned(self%n_planned + 1)
      if (self%tick + self%length == n_ticks) return
      start = history%planned(self%n_planned)
      time = start + (time - start)*(real(self%tick + self%length, dp)/n_ticks)
   end function time_stepping_next_time

   !> Whether the next step may be halved: not before the first time, and not below the smallest step.
   pure logical function time_stepping_can_halve(self, history) result(can_halve)
      class(time_stepping_t), intent(in) :: self !! the time stepping
      type(history_t), intent(in) :: history !! the history

      can_halve = .false.
      if (self%n_planned == 0 .or. self%length == 1) return
      associate (planned => history%planned(self%n_planned + 1) - history%planned(self%n_planned))
         can_halve = planned*(real(self%length/2, dp)/n_ticks) >= history%min_step
      end associate
   end function time_stepping_can_halve

end module amontons_time_stepping
