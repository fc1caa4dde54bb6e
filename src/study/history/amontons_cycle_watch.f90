!> The cycles of a history: what each took, whether it went like the one before, and what the stresses of the surface
!> and the slips of a cycle say about fretting: the parameters of Ruiz, and that of Smith, Watson and Topper on the
!> critical plane. These are made of the largest values of some numbers over the steps of the cycle, so that no step
!> need be kept.
module amontons_cycle_watch
   use amontons_history_model, only: history_model_t
   use amontons_kinds, only: dp
   use amontons_stepper, only: step_state_t
   use amontons_surface_stress, only: surface_stress_t
   implicit none (type, external)
   private

   public :: cycle_outcomes, cycle_watch_t, n_cycle_numbers, n_parameters, n_plain_numbers, new_cycle_watch, &
      parameter_names

   !> What a cycle can be: the first, or without slip, like the one before, like the one before but for a shift, or
   !> another.
   character(10), parameter :: cycle_outcomes(*) = [character(10) :: 'first', 'shakedown', 'steady', 'ratcheting', &
      'changing']
   !> Their numbers.
   integer, parameter :: first_cycle = 1, shakedown = 2, steady = 3, ratcheting = 4, changing = 5
   !> Numbers of a cycle besides those of fretting, in the order of `cycle_numbers`.
   integer, parameter :: n_plain_numbers = 14
   !> Numbers of a cycle, all of them.
   integer, parameter :: n_cycle_numbers = n_plain_numbers + 3
   !> What is noted besides the numbers of the points.
   integer, parameter :: n_single = 8
   !> What is noted of each point.
   integer, parameter :: n_per_point = 6

   !> Planes through a point, by the angle of their normals to the tangent: 2 degrees apart.
   integer, parameter :: n_planes = 90
   !> Numbers of a point whose largest values are kept: shear, stress along the surface, slip and its opposite; stress,
   !> strain and the opposite of the strain along the normal of each plane.
   integer, parameter :: n_extremes = 4 + 3*n_planes
   !> Number of parameters.
   integer, parameter :: n_parameters = 5
   !> What they are called in tables.
   character(14), parameter :: parameter_names(n_parameters) = [character(14) :: 'surface_stress', 'ruiz_1', 'ruiz_2', &
      'swt', 'swt_angle']

   !> The cycle so far.
   type :: fretting_t
      real(dp), allocatable :: stress(:, :) !! stresses of the surface at the end of the last step (4, m) [F/L^2]
      real(dp), allocatable :: extreme(:, :) !! largest values over the cycle (n_extremes, m)
   contains
      procedure :: add => fretting_add
      procedure :: begin => fretting_begin
      procedure :: parameters => fretting_parameters
   end type fretting_t

   !> The cycle that is under way.
   type :: cycle_watch_t
      logical :: is_finished = .false. !! whether the last step ended a cycle
      real(dp) :: numbers(n_cycle_numbers) = 0.0_dp !! that cycle, in the order of `cycle_numbers`
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
         !! at its beginning contact forces, position, accumulated slip, dissipation; drift of the cycle before (m, 6)
   contains
      procedure :: note => cycle_watch_note
      procedure :: noted => cycle_watch_noted
      procedure :: restore => cycle_watch_restore
      procedure, private :: start => cycle_watch_start
      procedure, private :: finish => cycle_watch_finish
   end type cycle_watch_t

contains

   !> Begins at rest, where no cycle has begun.
   pure subroutine new_cycle_watch(watch, model, n_points)
      type(cycle_watch_t), intent(out) :: watch !! the cycle
      type(history_model_t), intent(in) :: model !! the model
      integer, intent(in) :: n_points !! number of contact points

      allocate (watch%points(merge(n_points, 0, size(model%cycle_times) > 0), n_per_point), source=0.0_dp)
      allocate (watch%fretting%extreme(n_extremes, merge(n_points, 0, allocated(model%surface))), source=0.0_dp)
   end subroutine new_cycle_watch

   !> Notes a step that was kept.
   pure subroutine cycle_watch_note(self, model, before, after)
      class(cycle_watch_t), intent(inout) :: self !! the cycle; gains the step
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: before !! the state at the beginning of the step
      type(step_state_t), intent(in) :: after !! the state at its end

      self%is_finished = .false.
      if (model%cycle_at(before%instant%time) >= 0) call self%start(before)
      if (allocated(model%surface)) then
         if (model%cycle_at(before%instant%time) >= 0) call self%fretting%begin(model%surface, &
            surface_stress(model, before), position(before))
         call self%fretting%add(model%surface, surface_stress(model, after), position(after))
      end if
      if (.not. self%is_begun) return
      self%n_steps = self%n_steps + 1
      self%turnover = self%turnover + abs(work(after) - work(before))
      if (model%cycle_at(after%instant%time) > 0 .and. after%instant%time > self%begin) call self%finish(model, after)
   end subroutine cycle_watch_note

   !> Stresses of the surface in a state (4, m) [F/L^2].
   pure function surface_stress(model, state) result(stress)
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: state !! the state
      real(dp) :: stress(4, size(state%solution%force)/2)

      stress = model%surface%stress(state%instant%factor, state%solution%displacement, state%solution%force)
   end function surface_stress

   !> How far the points have moved along their tangents, on the obstacle (m) [L].
   pure function position(state)
      type(step_state_t), intent(in) :: state !! a state
      real(dp) :: position(size(state%solution%force)/2)

      position = state%solution%displacement(size(position) + 1:) - state%instant%motion
   end function position

   !> Work of loads, supports and obstacles since rest [F L].
   pure real(dp) function work(state)
      type(step_state_t), intent(in) :: state !! a state

      work = state%load_work + state%support_work + state%obstacle_work
   end function work

   !> Begins a cycle. What the one before has left stays.
   pure subroutine cycle_watch_start(self, state)
      class(cycle_watch_t), intent(inout) :: self !! the cycle; becomes a new one
      type(step_state_t), intent(in) :: state !! the state at its beginning
      integer :: m

      m = size(state%solution%force)/2
      self%is_begun = .true.
      self%n_steps = 0
      self%begin = state%instant%time
      self%work = work(state)
      self%strain_energy = state%strain_energy
      self%turnover = 0.0_dp
      self%points(:, :5) = reshape([state%solution%force, position(state), state%accumulated_slip, state%dissipation], &
         [m, 5])
   end subroutine cycle_watch_start

   !> Ends a cycle: its numbers, and what the next one is compared with.
   pure subroutine cycle_watch_finish(self, model, state)
      class(cycle_watch_t), intent(inout) :: self !! the cycle; gains its numbers
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: state !! the state at its end
      ! What rounding leaves of the slips of a cycle in which nothing slips, over the energy that went in and out.
      real(dp), parameter :: rounding = 1.0e-9_dp
      real(dp), dimension(size(state%solution%force)/2) :: drift, slip
      real(dp), allocatable :: parameters(:, :)
      real(dp) :: dissipation, changes(3), force
      integer :: m

      m = size(state%solution%force)/2
      drift = position(state) - self%points(:, 3)
      slip = state%accumulated_slip - self%points(:, 4)
      dissipation = sum(state%dissipation - self%points(:, 5))
      force = max(tiny(1.0_dp), maxval(abs(state%solution%force)), maxval(abs(self%points(:, :2))))
      changes = [(dissipation - self%dissipation_before)/max(tiny(1.0_dp), dissipation, self%dissipation_before, &
         rounding*self%turnover), maxval(abs(state%solution%force - reshape(self%points(:, :2), [2*m])))/force, &
         maxval(abs(drift - self%points(:, 6)))]
      self%numbers = 0.0_dp
      self%numbers(:n_plain_numbers) = [real(model%cycle_at(state%instant%time), dp), self%begin, state%instant%time, &
         real(self%n_steps, dp), work(state) - self%work, state%strain_energy - self%strain_energy, dissipation, &
         work(state) - self%work - (state%strain_energy - self%strain_energy) - dissipation, maxval(slip), &
         maxval(abs(drift)), changes, &
         real(outcome(self%has_before, dissipation <= rounding*self%turnover, changes, maxval(slip), &
         maxval(abs(drift)), model%history%cycle_tolerance), dp)]
      if (allocated(model%surface)) then
         parameters = self%fretting%parameters()
         self%numbers(n_plain_numbers + 1:) = maxval(parameters(:, 2:4), dim=1)
      end if
      self%dissipation_before = dissipation
      self%points(:, 6) = drift
      self%has_before = .true.
      self%is_begun = .false.
      self%is_finished = .true.
   end subroutine cycle_watch_finish

   !> What a cycle is. In a steady one and in one that ratchets dissipation and forces are those of the cycle before; in
   !> the first of these the points come back to where they were, in the second they drift as far as before.
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

   !> What the cycle must be restored from.
   pure function cycle_watch_noted(self) result(numbers)
      class(cycle_watch_t), intent(in) :: self !! the cycle
      real(dp), allocatable :: numbers(:)

      numbers = reshape(self%fretting%extreme, [size(self%fretting%extreme)])
      if (size(self%points) > 0) numbers = [merge(1.0_dp, 0.0_dp, [self%is_begun, self%has_before]), &
         real(self%n_steps, dp), self%begin, self%work, self%strain_energy, self%turnover, self%dissipation_before, &
         reshape(self%points, [size(self%points)]), numbers]
   end function cycle_watch_noted

   !> Restores the cycle from its numbers. Those of a history with other cycles leave it to begin anew.
   pure subroutine cycle_watch_restore(self, model, state, numbers)
      class(cycle_watch_t), intent(inout) :: self !! the cycle, new
      type(history_model_t), intent(in) :: model !! the model
      type(step_state_t), intent(in) :: state !! the state at the end of the last step
      real(dp), intent(in) :: numbers(:) !! the numbers
      integer :: n

      if (allocated(model%surface)) call self%fretting%begin(model%surface, surface_stress(model, state), &
         position(state))
      n = merge(n_single + size(self%points), 0, size(self%points) > 0)
      if (size(numbers) /= n + size(self%fretting%extreme)) return
      self%fretting%extreme = reshape(numbers(n + 1:), shape(self%fretting%extreme))
      if (n == 0) return
      self%is_begun = numbers(1) > 0.0_dp
      self%has_before = numbers(2) > 0.0_dp
      self%n_steps = nint(numbers(3))
      self%begin = numbers(4)
      self%work = numbers(5)
      self%strain_energy = numbers(6)
      self%turnover = numbers(7)
      self%dissipation_before = numbers(n_single)
      self%points = reshape(numbers(n_single + 1:n), shape(self%points))
   end subroutine cycle_watch_restore

   !> Begins a cycle.
   pure subroutine fretting_begin(self, surface, stress, position)
      class(fretting_t), intent(inout) :: self !! the cycle; becomes a new one
      type(surface_stress_t), intent(in) :: surface !! the surface, for its material
      real(dp), intent(in) :: stress(:, :) !! stresses of the surface (4, m) [F/L^2]
      real(dp), intent(in) :: position(:) !! tangential displacements less those of the obstacle (m) [L]

      self%stress = stress
      self%extreme = sample(surface, stress, position)
   end subroutine fretting_begin

   !> Adds the end of a step.
   pure subroutine fretting_add(self, surface, stress, position)
      class(fretting_t), intent(inout) :: self !! the cycle; gains the step
      type(surface_stress_t), intent(in) :: surface !! the surface, for its material
      real(dp), intent(in) :: stress(:, :) !! stresses of the surface (4, m) [F/L^2]
      real(dp), intent(in) :: position(:) !! tangential displacements less those of the obstacle (m) [L]

      self%stress = stress
      self%extreme = max(self%extreme, sample(surface, stress, position))
   end subroutine fretting_add

   !> The numbers of which the largest values are kept (n_extremes, m).
   pure function sample(surface, stress, position)
      type(surface_stress_t), intent(in) :: surface !! the surface, for its material
      real(dp), intent(in) :: stress(:, :) !! stresses of the surface (4, m) [F/L^2]
      real(dp), intent(in) :: position(:) !! tangential displacements less those of the obstacle (m) [L]
      real(dp) :: sample(n_extremes, size(position))
      real(dp) :: frames(3, n_planes), on_planes(n_planes), strains(n_planes)
      integer :: k, p

      do k = 1, n_planes
         associate (angle => plane_angle(k))
            frames(:, k) = [sin(angle)**2, 2.0_dp*sin(angle)*cos(angle), cos(angle)**2]
         end associate
      end do
      do p = 1, size(position)
         on_planes = matmul(stress(:3, p), frames)
         strains = ((1.0_dp + surface%poisson(p))*on_planes - surface%poisson(p)*sum(stress([1, 3, 4], p))) &
            /surface%young(p)
         sample(:, p) = [abs(stress(2, p)), stress(3, p), position(p), -position(p), on_planes, strains, -strains]
      end do
   end function sample

   !> The angle of the normal of a plane to the tangent, towards the outward normal: 0, 2, -2, 4, ... degrees [rad].
   pure real(dp) function plane_angle(plane) result(angle)
      integer, intent(in) :: plane !! number of the plane

      angle = acos(-1.0_dp)/n_planes*(plane/2*merge(1, -1, modulo(plane, 2) == 0))
   end function plane_angle

   !> The parameters of each point over the cycle so far: stress along the surface at the end of the last step [F/L^2],
   !> Ruiz' first [F/L] and second [F^2/L^3], that of Smith, Watson and Topper [F/L^2] and the angle of its plane [rad]
   !> (m, n_parameters).
   pure function fretting_parameters(self) result(parameters)
      class(fretting_t), intent(in) :: self !! the cycle so far
      real(dp) :: parameters(size(self%extreme, 2), n_parameters)
      ! Planes whose values differ by rounding are the same; the first of them has the smallest angle.
      real(dp), parameter :: rounding = 1.0e-9_dp
      real(dp) :: on_planes(n_planes)
      integer :: p, plane

      do p = 1, size(parameters, 1)
         associate (largest => self%extreme(:, p))
            parameters(p, 1) = self%stress(3, p)
            parameters(p, 2) = largest(1)*(largest(3) + largest(4))
            parameters(p, 3) = max(0.0_dp, largest(2))*parameters(p, 2)
            on_planes = max(0.0_dp, largest(5:4 + n_planes))*0.5_dp*(largest(5 + n_planes:4 + 2*n_planes) &
               + largest(5 + 2*n_planes:))
            plane = findloc(on_planes >= (1.0_dp - rounding)*maxval(on_planes), .true., dim=1)
            parameters(p, 4:5) = [on_planes(plane), plane_angle(plane)]
         end associate
      end do
   end function fretting_parameters

end module amontons_cycle_watch
