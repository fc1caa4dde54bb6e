!> A load history: loads, prescribed displacements, obstacles and friction that change over a pseudo-time.
!>
!> Between the times of the history everything changes linearly; of a table, between its own times.
module amontons_history
   use amontons_contact_set, only: contact_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: fretting_names, history_t, is_shown, moved_things, steps_t

   !> What changes: the factor of all loads of a name.
   integer, parameter, public :: stepped_load = 1
   !> What changes: the factor of the displacements that supports of a name prescribe.
   integer, parameter, public :: stepped_support = 2
   !> What changes: place and angle of the obstacles of contact sets.
   integer, parameter, public :: stepped_obstacle = 3
   !> What changes: the factor of the friction of contact sets.
   integer, parameter, public :: stepped_friction = 4

   !> How a deck writes whose change it is.
   character(8), parameter :: moved_things(4) = [character(8) :: 'load', 'support', 'obstacle', 'contact']

   !> Whether parameters of fretting are computed, as a deck writes it.
   character(10), parameter :: fretting_names(2) = [character(10) :: 'none', 'parameters']

   !> What changes over the history, in numbers: one factor, or shift along x, shift along y and angle of an obstacle.
   type :: steps_t
      integer :: target = stepped_load !! what it is
      character(:), allocatable :: name !! name of the load or support; name or set of the contact
      real(dp), allocatable :: values(:, :)
         !! its numbers at the times of the history, unless there is a table (1 or 3, times) [-], [L] and [rad]
      real(dp) :: pivot(2) = 0.0_dp !! what an obstacle turns about [L]
      character(:), allocatable :: file !! the file of the table; empty or not allocated without one
      real(dp), allocatable :: table(:, :) !! times and numbers of the table (2 or 4, rows)
      character(:), allocatable :: origin !! where it was specified, for messages: 'deck.nml:12: '
   contains
      procedure :: acts_on => steps_acts_on
      procedure :: changes => steps_changes
      procedure :: label => steps_label
      procedure :: largest => steps_largest
      procedure :: n_numbers => steps_n_numbers
   end type steps_t

   !> The times, how the way between them is divided, and what changes.
   type :: history_t
      logical :: is_given = .false. !! whether there is a history
      character(:), allocatable :: name !! what the pseudo-time is called in tables
      real(dp), allocatable :: times(:) !! the times, ascending; the body is at rest before the first [-]
      integer :: n_substeps = 1 !! number of equal steps from one time to the next
      real(dp) :: step_tolerance = huge(1.0_dp)
         !! a step whose energy error is a larger part of its energies is halved [-]
      real(dp) :: min_step = 0.0_dp !! steps that would become smaller are not halved [-]
      real(dp), allocatable :: cycles(:) !! times at which cycles begin and end; one time with a period [-]
      real(dp) :: period = 0.0_dp !! length of each cycle; 0 where all times are listed [-]
      real(dp) :: cycle_tolerance = 1.0e-3_dp !! a smaller change from one cycle to the next counts as none [-]
      logical :: has_fretting = .false. !! whether stresses of the surface and parameters of fretting are computed
      type(steps_t), allocatable :: steps(:) !! what changes
      integer :: fields_every = 0 !! the fields of the first step and of every so many behind it are written; 0 for none
      integer :: points_every = 0 !! the same of the contact points
      integer :: states_every = 0 !! the same of the states from which a history can go on
      character(:), allocatable :: start !! file of such states, of which one is the start; empty or not allocated: rest
      integer :: start_step = 0 !! the step of the state; 0 for the last one
      real(dp), allocatable :: probes(:) !! coordinates of the nodes whose displacements are shown, x and y in turn [L]
   contains
      procedure :: cycle_ends => history_cycle_ends
      procedure :: has_start => history_has_start
      procedure :: n_cycles => history_n_cycles
      procedure :: n_probes => history_n_probes
      procedure :: n_steps => history_n_steps
      procedure :: numbers => history_numbers
      procedure :: nearest_planned_time => history_nearest_planned_time
      procedure :: planned_time => history_planned_time
   end type history_t

contains

   !> Whether the steps are of the obstacle or the friction of a contact set.
   pure logical function steps_acts_on(self, contact) result(acts)
      class(steps_t), intent(in) :: self !! the steps
      type(contact_t), intent(in) :: contact !! the contact set

      acts = self%target >= stepped_obstacle .and. contact%set == self%name
      if (self%target >= stepped_obstacle .and. allocated(contact%name)) acts = acts .or. contact%name == self%name
   end function steps_acts_on

   !> Whether the numbers of the steps differ anywhere.
   pure logical function steps_changes(self) result(changes)
      class(steps_t), intent(in) :: self !! the steps

      if (allocated(self%table)) then
         changes = any(abs(self%table(2:, :) - spread(self%table(2:, 1), 2, size(self%table, 2))) > 0.0_dp)
      else
         changes = any(abs(self%values - spread(self%values(:, 1), 2, size(self%values, 2))) > 0.0_dp)
      end if
   end function steps_changes

   !> What one of the numbers is called in tables: 'factor_F', 'shift_x_floor', 'friction_factor_bottom'.
   pure function steps_label(self, number) result(label)
      class(steps_t), intent(in) :: self !! the steps
      integer, intent(in) :: number !! which of its numbers
      character(:), allocatable :: label
      character(7), parameter :: motions(3) = [character(7) :: 'shift_x', 'shift_y', 'turn']

      select case (self%target)
      case (stepped_obstacle)
         label = trim(motions(number))//'_'//self%name
      case (stepped_friction)
         label = 'friction_factor_'//self%name
      case default
         label = 'factor_'//self%name
      end select
   end function steps_label

   !> The largest of their numbers [-], [L] or [rad].
   pure real(dp) function steps_largest(self) result(largest)
      class(steps_t), intent(in) :: self !! the steps

      if (allocated(self%table)) then
         largest = maxval(self%table(2:, :))
      else
         largest = maxval(self%values)
      end if
   end function steps_largest

   !> How many numbers change at once.
   pure integer function steps_n_numbers(self) result(n)
      class(steps_t), intent(in) :: self !! the steps

      n = merge(3, 1, self%target == stepped_obstacle)
   end function steps_n_numbers

   !> Whether something of a step is written.
   pure logical function is_shown(step, every)
      integer, intent(in) :: step !! the step
      integer, intent(in) :: every !! it is written of the first step and of every so many behind it; 0 for none

      is_shown = .false.
      if (every > 0) is_shown = modulo(step - 1, every) == 0
   end function is_shown

   !> Whether the history starts from a state of another, not from rest.
   pure logical function history_has_start(self) result(has_start)
      class(history_t), intent(in) :: self !! the history

      has_start = .false.
      if (allocated(self%start)) has_start = len(self%start) > 0
   end function history_has_start

   !> Number of nodes whose displacements are written.
   pure integer function history_n_probes(self) result(n)
      class(history_t), intent(in) :: self !! the history

      n = 0
      if (allocated(self%probes)) n = size(self%probes)/2
   end function history_n_probes

   !> Number of steps if none is halved.
   pure integer function history_n_steps(self) result(n)
      class(history_t), intent(in) :: self !! the history

      n = 1 + (size(self%times) - 1)*self%n_substeps
   end function history_n_steps

   !> The time that a step leads to if none is halved [-].
   pure real(dp) function history_planned_time(self, step) result(time)
      class(history_t), intent(in) :: self !! the history
      integer, intent(in) :: step !! number of the step
      integer :: interval, substep

      interval = 1 + (step - 2)/self%n_substeps
      substep = 1 + modulo(step - 2, self%n_substeps)
      if (step == 1) then
         time = self%times(1)
      else if (substep == self%n_substeps) then
         time = self%times(interval + 1)
      else
         time = self%times(interval) + (self%times(interval + 1) - self%times(interval))*(real(substep, dp) &
            /self%n_substeps)
      end if
   end function history_planned_time

   !> The time of a planned step that is nearest to a time within the history [-].
   pure real(dp) function history_nearest_planned_time(self, time) result(nearest)
      class(history_t), intent(in) :: self !! the history
      real(dp), intent(in) :: time !! the time [-]
      integer :: interval

      interval = max(1, min(count(self%times <= time), size(self%times) - 1))
      if (size(self%times) == 1) then
         nearest = self%times(1)
      else
         associate (begin => self%times(interval), end => self%times(interval + 1))
            nearest = self%planned_time(1 + self%n_substeps*(interval - 1) &
               + nint(self%n_substeps*max(0.0_dp, min(1.0_dp, (time - begin)/(end - begin)))))
         end associate
      end if
   end function history_nearest_planned_time

   !> How many cycles of the period end within the history. No more than there are planned steps.
   pure integer function history_n_cycles(self) result(n)
      class(history_t), intent(in) :: self !! the history, with a period
      ! A cycle that ends this little behind the last time, over its length, is whole.
      real(dp), parameter :: rounding = 1.0e-6_dp

      n = int(max(0.0_dp, min(real(self%n_steps(), dp), (self%times(size(self%times)) - self%cycles(1))/self%period &
         + rounding)))
   end function history_n_cycles

   !> The times at which cycles begin and end, those of planned steps; none without cycles [-].
   pure function history_cycle_ends(self) result(ends)
      class(history_t), intent(in) :: self !! the history
      real(dp), allocatable :: ends(:)
      integer :: i

      allocate (ends(0))
      if (allocated(self%cycles)) ends = self%cycles
      if (size(ends) > 0 .and. self%period > 0.0_dp) ends = ends(1) + self%period*[(i, i=0, self%n_cycles())]
      do i = 1, size(ends)
         ends(i) = self%nearest_planned_time(ends(i))
      end do
   end function history_cycle_ends

   !> The numbers of one of the changes at a time (1 or 3).
   pure function history_numbers(self, which, time) result(numbers)
      class(history_t), intent(in) :: self !! the history
      integer, intent(in) :: which !! which of the changes
      real(dp), intent(in) :: time !! the time [-]
      real(dp), allocatable :: numbers(:)

      associate (steps => self%steps(which))
         if (allocated(steps%table)) then
            numbers = interpolated(steps%table(1, :), steps%table(2:, :), time)
         else
            numbers = interpolated(self%times, steps%values, time)
         end if
      end associate
   end function history_numbers

   !> Numbers between those of given times, on straight lines; at a given time its own to the last bit.
   pure function interpolated(times, values, time) result(numbers)
      real(dp), intent(in) :: times(:) !! ascending times [-]
      real(dp), intent(in) :: values(:, :) !! numbers at these times (n, times)
      real(dp), intent(in) :: time !! the time, not outside of them [-]
      real(dp) :: numbers(size(values, 1))
      real(dp) :: share
      integer :: next

      next = findloc(times >= time, .true., dim=1)
      if (next == 0) next = size(times)
      numbers = values(:, next)
      if (next == 1 .or. .not. times(next) > time) return
      share = (time - times(next - 1))/(times(next) - times(next - 1))
      numbers = (1.0_dp - share)*values(:, next - 1) + share*values(:, next)
   end function interpolated

end module amontons_history
