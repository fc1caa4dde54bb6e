!> A load history: loads, prescribed displacements, obstacles and friction that change over a pseudo-time, and the
!> groups of a deck that describe it.
!>
!> All changes are linear between the times of the history; those of a table are linear between its own times.
module amontons_history
   use amontons_constraints, only: support_t
   use amontons_contact_set, only: contact_t
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t, names_text
   use amontons_kinds, only: dp
   use amontons_loads, only: load_on_motion, load_t
   use amontons_rounding, only: computed_rounding, difference_rounding, input_rounding
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: describe_history, fretting_names, history_t, is_shown, moved_things, steps_t

   !> Target of a change: the factor of all loads of a name.
   integer, parameter, public :: stepped_load = 1
   !> Target of a change: the factor of the displacements that supports of a name prescribe.
   integer, parameter, public :: stepped_support = 2
   !> Target of a change: place and angle of the obstacles of contact sets.
   integer, parameter, public :: stepped_obstacle = 3
   !> Target of a change: the factor of the friction of contact sets.
   integer, parameter, public :: stepped_friction = 4

   !> Kinds of the targets of a change, as a deck writes them.
   character(8), parameter :: moved_things(4) = [character(8) :: 'load', 'support', 'obstacle', 'contact']

   !> Whether fretting parameters are computed, as a deck writes it.
   character(10), parameter :: fretting_names(2) = [character(10) :: 'none', 'parameters']

   !> A change over the history: the numbers are one factor, or shift along x, shift along y and, of an obstacle in the
   !> plane, angle, in space shift along z.
   type :: steps_t
      integer :: target = stepped_load !! its kind
      character(:), allocatable :: name !! name of the load or support; name or set of the contact
      real(dp), allocatable :: values(:, :)
         !! its numbers at the times of the history, unless a file has them (1 or 3, times) [-], [L] and [rad]
      real(dp) :: pivot(2) = 0.0_dp !! pivot of the rotation of an obstacle [L]
      character(:), allocatable :: file !! the file of the table; empty or not allocated without one
      real(dp), allocatable :: table(:, :) !! times and numbers of the file, or of the history (2 or 4, rows)
      character(:), allocatable :: origin !! where it was specified, for messages: 'deck.nml:12: '
      logical :: has_twin = .false. !! whether a load and a support of this name change, each in its own way
   contains
      procedure :: acts_on => steps_acts_on
      procedure :: label => steps_label
      procedure :: largest => steps_largest
      procedure :: n_numbers => steps_n_numbers
      procedure, private :: takes => steps_takes
   end type steps_t

   !> The times, the number of steps between them, and the changes.
   type :: history_t
      logical :: is_given = .false. !! whether there is a history
      character(:), allocatable :: name !! name of the pseudo-time in tables
      real(dp), allocatable :: times(:) !! the times, ascending; the body is at rest before the first [-]
      real(dp), allocatable :: substeps(:)
         !! number of equal steps from one time to the next, or that of each leg
      real(dp), allocatable :: planned(:) !! times to which the steps lead, if none is halved [-]
      real(dp) :: step_tolerance = huge(1.0_dp)
         !! a step whose energy error is a larger part of its energies is halved [-]
      real(dp) :: min_step = 0.0_dp !! steps that would become smaller are not halved [-]
      real(dp), allocatable :: cycles(:) !! times at which cycles begin and end; one time with a period [-]
      real(dp) :: period = 0.0_dp !! length of each cycle; 0 where all times are listed [-]
      real(dp) :: cycle_tolerance = 1.0e-3_dp !! a smaller change from one cycle to the next counts as none [-]
      logical :: has_fretting = .false. !! whether stresses of the surface and parameters of fretting are computed
      type(steps_t), allocatable :: steps(:) !! the changes
      integer :: fields_every = 0 !! the fields of the first step and of every so many behind it are written; 0 for none
      integer :: points_every = 0 !! likewise for the table of contact points
      integer :: states_every = 0 !! likewise for the table of saved states
      character(:), allocatable :: start !! file of such states, of which one is the start; empty or not allocated: rest
      integer :: start_step = 0 !! the step of the state; 0 for the last one
      character(:), allocatable :: start_origin !! where it was specified, for messages: 'deck.nml:12: '
      real(dp), allocatable :: probes(:) !! coordinates of nodes whose displacements are shown, one after the other [L]
      character(:), allocatable :: probe_origin !! where they were specified, for messages: 'deck.nml:12: '
   contains
      procedure :: cycle_ends => history_cycle_ends
      procedure :: has_start => history_has_start
      procedure :: n_cycles => history_n_cycles
      procedure :: numbers => history_numbers
      procedure :: nearest_planned_time => history_nearest_planned_time
   end type history_t

   !> The group of the times.
   type(group_t), parameter, public :: history_group = group_t('history')
   !> The group of a change.
   type(group_t), parameter, public :: steps_group = group_t('steps', is_repeatable=.true.)
   !> Keys that name the target of a change.
   type(key_t), parameter :: name_keys(4) = [key_t(moved_things(stepped_load), 'with `factor`: the name of the load'), &
      key_t(moved_things(stepped_support), 'with `factor`: the name of the support, whose prescribed'// &
      ' displacements are multiplied'), &
      key_t(moved_things(stepped_obstacle), 'with `shift_x`, `shift_y`, `shift_z` and `turn`: the `name` or `set`'// &
      ' of the `&contact`'), &
      key_t(moved_things(stepped_friction), 'with `friction_factor`: the `name` or `set` of the `&contact`')]
   !> Number of keys for the numbers of a change.
   integer, parameter :: n_value_keys = 6
   !> Keys of the numbers of a change; those of a motion may be left out one by one.
   type(key_t), parameter :: value_keys(n_value_keys) = [ &
      key_t('factor', 'what the loads of that name, or the displacements of the supports, are multiplied by: one'// &
      ' value for each of the `times`', also='value values'), &
      key_t('shift_x', 'how far the obstacle has moved along x at each of the `times`; around an axis it widens', &
      'L', default='`0.0`'), &
      key_t('shift_y', 'how far the obstacle has moved along y at each of the `times`', 'L', default='`0.0`'), &
      key_t('shift_z', 'of a solid: how far it has moved along z at each of the `times`', 'L', &
      default='0.0, of a solid'), &
      key_t('turn', 'in the plane: the angle that the obstacle has turned by about `pivot` at each of the `times`,'// &
      ' counterclockwise', 'rad', default='`0.0`', also='angle rotation'), &
      key_t('friction_factor', 'what the friction of the `&contact` is multiplied by at each of the `times`', &
      at_least=0.0_dp)]
   !> For each key of numbers, the targets that have it and its place among their numbers.
   character(16), parameter :: value_owners(n_value_keys) = [character(16) :: 'load and support', 'obstacle', &
      'obstacle', 'obstacle', 'obstacle', 'contact']
   integer, parameter :: value_rows(n_value_keys) = [1, 1, 2, 3, 3, 1]

contains

   !> Whether the change concerns the obstacle or the friction of a contact set.
   pure logical function steps_acts_on(self, contact) result(acts)
      class(steps_t), intent(in) :: self !! the steps
      type(contact_t), intent(in) :: contact !! the contact set

      acts = self%target >= stepped_obstacle .and. contact%set == self%name
      if (self%target >= stepped_obstacle .and. allocated(contact%name)) acts = acts .or. contact%name == self%name
   end function steps_acts_on

   !> Column name of one of the numbers: 'factor_F', 'shift_x_floor', 'friction_factor_bottom'.
   pure function steps_label(self, number, n_dim) result(label)
      class(steps_t), intent(in) :: self !! the steps
      integer, intent(in) :: number !! index of the number
      integer, intent(in) :: n_dim !! number of dimensions of the body
      character(:), allocatable :: label
      character(7) :: motions(3)

      select case (self%target)
      case (stepped_obstacle)
         motions = [character(7) :: 'shift_x', 'shift_y', merge('shift_z', 'turn   ', n_dim == 3)]
         label = trim(motions(number))//'_'//self%name
      case (stepped_friction)
         label = 'friction_factor_'//self%name
      case default
         label = 'factor_'//self%name
         if (self%has_twin .and. self%target == stepped_support) label = 'motion_'//label
      end select
   end function steps_label

   !> The largest magnitude of the numbers [-], [L] or [rad].
   pure real(dp) function steps_largest(self) result(largest)
      class(steps_t), intent(in) :: self !! the steps

      largest = maxval(self%table(2:, :))
   end function steps_largest

   !> Number of numbers that change at once: 1, or 3 for an obstacle.
   pure integer function steps_n_numbers(self) result(n)
      class(steps_t), intent(in) :: self !! the steps

      n = merge(3, 1, self%target == stepped_obstacle)
   end function steps_n_numbers

   !> Whether one of `value_keys` belongs to the target.
   pure logical function steps_takes(self, number) result(takes)
      class(steps_t), intent(in) :: self !! the steps
      integer, intent(in) :: number !! which of the keys

      takes = index(value_owners(number), trim(moved_things(self%target))) > 0
   end function steps_takes

   !> Whether a step is written to a file that has every n-th step.
   pure logical function is_shown(step, every)
      integer, intent(in) :: step !! the step
      integer, intent(in) :: every !! it is written of the first step and of every so many behind it; 0 for none

      is_shown = .false.
      if (every > 0) is_shown = modulo(step - 1, every) == 0
   end function is_shown

   !> Whether the history starts from a state of another, not from rest.
   pure logical function history_has_start(self) result(has_start)
      class(history_t), intent(in) :: self !! the history

      has_start = is_filled(self%start)
   end function history_has_start

   !> The time of a planned step that is nearest to a time within the history [-].
   pure real(dp) function history_nearest_planned_time(self, time) result(nearest)
      class(history_t), intent(in) :: self !! the history
      real(dp), intent(in) :: time !! the time [-]

      nearest = self%planned(minloc(abs(self%planned - time), dim=1))
   end function history_nearest_planned_time

   !> Number of complete cycles within the history, at most the number of planned steps. One that ends behind the last
   !> time by rounding is complete.
   pure integer function history_n_cycles(self) result(n)
      class(history_t), intent(in) :: self !! the history, with a period

      n = int(max(0.0_dp, min(real(size(self%planned), dp), (self%times(size(self%times)) - self%cycles(1)) &
         /self%period + input_rounding)))
   end function history_n_cycles

   !> The times at which cycles begin and end, which are times of planned steps; empty without cycles [-].
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

   !> The numbers of a change at a time, by linear interpolation of its table; at a time of the table exactly the
   !> tabulated numbers, and no others between equal ones (1 or 3).
   pure function history_numbers(self, which, time) result(numbers)
      class(history_t), intent(in) :: self !! the history
      integer, intent(in) :: which !! index of the change
      real(dp), intent(in) :: time !! the time, not outside of the history [-]
      real(dp), allocatable :: numbers(:)
      real(dp) :: share
      integer :: next

      associate (times => self%steps(which)%table(1, :), values => self%steps(which)%table(2:, :))
         next = findloc(times >= time, .true., dim=1)
         if (next == 0) next = size(times)
         numbers = values(:, next)
         if (next == 1 .or. .not. times(next) > time) return
         share = (time - times(next - 1))/(times(next) - times(next - 1))
         numbers = values(:, next - 1) + share*(values(:, next) - values(:, next - 1))
         ! A number that passes 0 at this time leaves the rounding errors of both: a load that is none must be 0.
         where (abs(numbers) <= difference_rounding*(1.0_dp + maxval(abs(times))/(times(next) - times(next - 1))) &
            *(abs(values(:, next - 1)) + abs(values(:, next)))) numbers = 0.0_dp
      end associate
   end function history_numbers

   !> Describes `&history` and all `&steps`.
   subroutine describe_history(visitor, history, loads, supports, contacts, is_axisymmetric)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(history_t), intent(inout) :: history !! the history
      type(load_t), intent(in) :: loads(:) !! the loads of the deck
      type(support_t), intent(in) :: supports(:) !! its supports
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      logical, intent(in) :: is_axisymmetric !! whether it is a body of revolution
      character(:), allocatable :: file
      integer :: i
      logical :: are_times_sound
      logical, allocatable :: are_known(:)

      are_times_sound = history%is_given
      if (history%is_given) call describe_times(visitor, history)
      are_times_sound = are_times_sound .and. history%is_given .and. visitor%is_judging()
      do i = 1, size(supports)
         if (.not. (are_times_sound .and. supports(i)%lock_time < huge(1.0_dp))) cycle
         call visitor%require(any(abs(history%times - supports(i)%lock_time) <= 0.0_dp), 'times', &
            "lock_time of '"//supports(i)%name//"' is "//to_text(supports(i)%lock_time)//', which is none of the times')
         call visitor%require(history%has_start() .or. history%times(1) < supports(i)%lock_time, 'times', &
            "lock_time of '"//supports(i)%name//"' is the first time, when nothing acts yet; prescribe the motion"// &
            ' instead')
      end do
      do i = 1, size(history%steps)
         call describe_steps(visitor, history%steps(i))
         if (.not. visitor%is_judging()) cycle
         call visitor%require(history%is_given, '', '&steps needs &history')
         if (.not. visitor%deck%is_sound(visitor%place)) cycle
         associate (times => history%times, steps => history%steps(i))
            if (are_times_sound .and. allocated(steps%table)) then
               file = "table '"//steps%file(index(steps%file, '/', back=.true.) + 1:)//"'"
               associate (rows => steps%table(1, :))
                  call visitor%require(rows(1) <= times(1), 'table', file//' begins at '//to_text(rows(1))// &
                     ', after the first time '//to_text(times(1)))
                  call visitor%require(rows(size(rows)) >= times(size(times)), 'table', file//' ends at '// &
                     to_text(rows(size(rows)))//', before the last time '//to_text(times(size(times))))
               end associate
            else if (are_times_sound .and. allocated(steps%values)) then
               call visitor%require(size(steps%values, 2) == size(times), '', '&steps '// &
                  trim(moved_things(steps%target))//" = '"//steps%name//"' has "//to_text(size(steps%values, 2))// &
                  ' values, &history has '//to_text(size(times))//' times')
               if (size(steps%values, 2) == size(times)) then
                  allocate (steps%table(1 + steps%n_numbers(), size(times)))
                  steps%table(1, :) = times
                  steps%table(2:, :) = steps%values
               end if
            end if
            if (is_axisymmetric .and. steps%target == stepped_obstacle .and. allocated(steps%table)) then
               call visitor%require(.not. any(abs(steps%table(4, :)) > 0.0_dp), '', 'an obstacle around an axis '// &
                  'cannot turn: it would become a cone; only shift_y moves it as a rigid body')
            end if
         end associate
         call check_name(visitor, history%steps(:i), are_known, loads, supports, contacts)
      end do
   end subroutine describe_history

   !> Describes `&history`.
   subroutine describe_times(visitor, history)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(history_t), intent(inout) :: history !! the history
      logical :: has_times, has_tolerance

      has_times = history%is_given
      has_tolerance = history%step_tolerance < huge(1.0_dp)
      if (.not. allocated(history%name)) history%name = 'time'
      call visitor%open_group(history_group)
      call visitor%list(key_t('times', 'ascending values of the pseudo-time; the body is at rest and unstressed'// &
         ' before the first, everything changes linearly between them', is_required=.true., is_ascending=.true., &
         also='time'), history%times, has_times)
      call visitor%text(key_t('name', 'what the pseudo-time is called in tables: letters, digits and `_`'), &
         history%name)
      call visitor%list(key_t('substeps', 'number of equal steps from one of the `times` to the next, or that of'// &
         ' each leg, from the first time on', default='`1`', at_least=1.0_dp, is_whole=.true., &
         also='n steps nsteps increments dt'), history%substeps)
      call visitor%real(key_t('step_tolerance', 'a step whose energy error is a larger part of its energies is'// &
         ' halved', default='no step is halved for this', above=0.0_dp, also='tolerance tol'), &
         history%step_tolerance, has_tolerance)
      call visitor%real(key_t('min_step', 'steps are not halved below this', default='1/1024 of a step', &
         above=0.0_dp, also='dtmin'), history%min_step)
      call visitor%list(key_t('cycles', 'times at which cycles begin and end, each at the end of a planned step;'// &
         ' with `period` the one time at which the first begins', default='none', is_ascending=.true., also='cycle'), &
         history%cycles)
      call visitor%real(key_t('period', 'with `cycles`: length of each cycle', default='the times are listed', &
         above=0.0_dp), history%period)
      call visitor%real(key_t('cycle_tolerance', 'with `cycles`: a cycle whose dissipation, forces and slips differ'// &
         ' less from those of the one before is like it', above=0.0_dp), history%cycle_tolerance)
      call visitor%text(key_t('start', 'a file `NAME.states.csv`: the body is in a state of that file before the'// &
         ' first step, which leads to the time behind it', default='at rest', is_file=.true., is_filled=.true., &
         also='restart initial'), history%start)
      call visitor%whole(key_t('start_step', 'with `start`: the step of the state', default='the last in the file', &
         at_least=1.0_dp), history%start_step)
      call visitor%close_group()
      if (.not. allocated(history%start_origin)) history%start_origin = ''
      call visitor%locate('start', history%start_origin)
      history%is_given = has_times
      if (.not. visitor%is_judging()) return
      call visitor%require(visitor%deck%count_groups('sweep') == 0, '', &
         'a deck has either &history or &sweep; give each a deck of its own')
      call visitor%only('start_step', is_filled(history%start), 'start')
      call visitor%only('period', visitor%has('cycles'), 'cycles')
      if (has_times .and. visitor%deck%is_sound(visitor%place)) call plan_steps(visitor, history)
      if (has_times .and. visitor%has('cycles')) call judge_cycles(visitor, history)
      call visitor%require( &
         verify(history%name, 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_') == 0 .and. &
         len(history%name) > 0, 'name', 'name must consist of letters, digits and _')
   end subroutine describe_times

   !> Finds the times of the planned steps.
   subroutine plan_steps(visitor, history)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(history_t), intent(inout) :: history !! the history, with times; gains those of its steps
      real(dp), allocatable :: n_steps(:)
      integer :: leg, i, n
      ! Their times take 80 MB.
      integer, parameter :: most_steps = 10000000

      associate (times => history%times)
         if (.not. allocated(history%substeps)) history%substeps = [1.0_dp]
         n_steps = history%substeps
         if (size(n_steps) == 1) n_steps = [(n_steps(1), leg=1, size(times) - 1)]
         call visitor%require(size(n_steps) == size(times) - 1, 'substeps', 'substeps: expected 1 whole number, or '// &
            to_text(size(times) - 1)//', one for each leg between the times, found '//to_text(size(n_steps)))
         call visitor%require(sum(n_steps) <= most_steps, 'substeps', 'there must be at most '// &
            to_text(most_steps)//' steps, found '//to_text(nint(min(sum(n_steps), real(huge(1), dp)))))
         if (.not. visitor%deck%is_sound(visitor%place)) return
         allocate (history%planned(1 + nint(sum(n_steps))))
         history%planned(1) = times(1)
         n = 1
         do leg = 1, size(n_steps)
            do i = 1, nint(n_steps(leg)) - 1
               history%planned(n + i) = times(leg) + (times(leg + 1) - times(leg))*(i/n_steps(leg))
            end do
            n = n + nint(n_steps(leg))
            history%planned(n) = times(leg + 1)
         end do
      end associate
   end subroutine plan_steps

   !> Refuses cycles that do not begin and end with planned steps, or whose times do not ascend.
   subroutine judge_cycles(visitor, history)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(history_t), intent(in) :: history !! the history, with times and cycles
      real(dp), allocatable :: ends(:)
      real(dp) :: nearest, before
      integer :: i

      if (.not. visitor%deck%is_sound(visitor%place)) return
      ends = history%cycles
      if (history%period > 0.0_dp) then
         call visitor%require(size(ends) == 1, 'cycles', 'with period, cycles is the one time at which the first'// &
            ' cycle begins, found '//to_text(size(ends))//' times')
         ends = ends(1) + history%period*[(i, i=0, max(1, history%n_cycles()))]
      else
         call visitor%require(size(ends) > 1, 'cycles', 'cycles needs two times at least, or a period')
      end if
      before = -huge(1.0_dp)
      do i = 1, size(ends)
         nearest = history%nearest_planned_time(ends(i))
         call visitor%require(nearest > before .and. abs(nearest - ends(i)) <= computed_rounding*(history%times(size( &
            history%times)) - history%times(1)), 'cycles', 'no planned step ends at '//to_text(ends(i))// &
            ', where a cycle should begin or end; the nearest ends at '//to_text(nearest))
         if (.not. visitor%deck%is_sound(visitor%place)) return
         before = nearest
      end do
   end subroutine judge_cycles

   !> Describes one `&steps`.
   subroutine describe_steps(visitor, steps)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(steps_t), intent(inout) :: steps !! the changes
      real(dp), allocatable :: values(:)
      logical :: has_name(size(name_keys)), has_values(size(value_keys)), has_pivot, has_table
      integer :: i

      has_name = .false.
      has_name(steps%target) = is_filled(steps%name)
      has_pivot = steps%target == stepped_obstacle .and. visitor%n_dim == 2
      has_table = is_filled(steps%file)
      call visitor%open_group(steps_group)
      do i = 1, size(name_keys)
         call visitor%text(name_keys(i), steps%name, has_name(i))
         if (visitor%place > 0 .and. has_name(i)) steps%target = i
      end do
      do i = 1, size(value_keys)
         has_values(i) = allocated(steps%values) .and. .not. has_table .and. steps%takes(i)
         if (has_values(i)) values = steps%values(value_rows(i), :)
         ! The third number is an angle in the plane and a shift in space.
         if (value_rows(i) == 3) has_values(i) = has_values(i) .and. &
            visitor%n_dim == merge(3, 2, value_keys(i)%name == 'shift_z')
         call visitor%list(value_keys(i), values, has_values(i))
         if (visitor%place > 0 .and. has_values(i)) then
            ! Numbers that a motion does not give are 0.
            if (.not. allocated(steps%values)) allocate (steps%values(steps%n_numbers(), size(values)), source=0.0_dp)
            if (value_rows(i) <= size(steps%values, 1) .and. size(values) == size(steps%values, 2)) then
               steps%values(value_rows(i), :) = values
            end if
         end if
      end do
      call visitor%reals(key_t('pivot', 'with `turn`: what the obstacle turns about', 'L', default='`0.0, 0.0`'), &
         steps%pivot, has_pivot)
      call visitor%text(key_t('table', 'instead of the lists: file of times and numbers in columns, linear between;'// &
         ' of an obstacle time, `shift_x`, `shift_y` and `turn`, of a solid `shift_z`', is_file=.true., &
         is_filled=.true., also='file'), &
         steps%file, has_table)
      call visitor%table('table', steps%file, steps%table, 1 + steps%n_numbers(), 'time', &
         merge(0.0_dp, -huge(1.0_dp), steps%target == stepped_friction))
      call visitor%close_group()
      call visitor%locate('load', steps%origin)
      if (visitor%is_judging()) call judge_steps(visitor, steps, has_name, has_values)
   end subroutine describe_steps

   !> Checks the keys of a `&steps` together.
   subroutine judge_steps(visitor, steps, has_name, has_values)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(steps_t), intent(inout) :: steps !! what changes; loses values of different numbers
      logical, intent(in) :: has_name(:) !! whose change it is
      logical, intent(in) :: has_values(:) !! which numbers are given
      integer :: i, n_given

      call visitor%require(count(has_name) == 1, '', '&steps needs one of load, support, obstacle and contact; give'// &
         ' each a group of its own')
      if (count(has_name) /= 1) then
         if (allocated(steps%values)) deallocate (steps%values)
         return
      end if
      do i = 1, size(value_keys)
         if (.not. steps%takes(i)) call visitor%only(trim(value_keys(i)%name), .false., trim(value_owners(i)))
      end do
      call visitor%only('pivot', steps%target == stepped_obstacle, 'obstacle')
      call visitor%state_dimensions(2, 'turn pivot')
      call visitor%state_dimensions(3, 'shift_z')
      n_given = count(has_values)
      call visitor%require((n_given > 0) .neqv. visitor%has('table'), '', '&steps needs either values or table')
      if (allocated(steps%values)) then
         do i = 1, size(value_keys)
            if (value_owners(i) /= 'obstacle' .or. .not. has_values(i)) cycle
            call visitor%require(visitor%deck%count_values(visitor%place, trim(value_keys(i)%name), huge(1)) == &
               size(steps%values, 2), trim(value_keys(i)%name), 'shift_x, shift_y, shift_z and turn need equally'// &
               ' many values')
         end do
      end if
   end subroutine judge_steps

   !> Whether all names that changes of a kind may have are known. Names in which a fault was found are not. A rigid set
   !> or preload with any fault is not among the loads.
   pure logical function are_names_known(visitor, target, loads) result(are_known)
      class(deck_visitor_t), intent(in) :: visitor !! the visitor
      integer, intent(in) :: target !! what the changes move
      type(load_t), intent(in) :: loads(:) !! the loads

      associate (deck => visitor%deck)
         if (target <= stepped_support) then
            are_known = all([deck%knows(trim(moved_things(target)), 'name'), deck%knows('rigid', 'name'), &
               deck%knows('preload', 'name'), &
               count(loads%target == load_on_motion) == deck%count_groups('rigid') + deck%count_groups('preload')])
         else
            are_known = deck%knows('contact', 'set') .and. deck%knows('contact', 'name')
         end if
      end associate
   end function are_names_known

   !> Checks that the target of a change exists, and that no other change has it.
   subroutine check_name(visitor, steps, are_known, loads, supports, contacts)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor, at the group of the last change
      type(steps_t), intent(inout) :: steps(:) !! the change, and those before it
      logical, allocatable, intent(inout) :: are_known(:)
         !! whether all names of each kind are known; not allocated before the first change
      type(load_t), intent(in) :: loads(:) !! the loads
      type(support_t), intent(in) :: supports(:) !! the supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      character(61), parameter :: missing(4) = [character(61) :: &
         'no &load, and no force or moment other than 0, has the name', &
         'no &support with a prescribed displacement has the name', &
         'no &contact with a rigid obstacle has the name or set', 'no &contact has the name or set']
      character(:), allocatable :: thing, names
      integer :: i, k
      logical :: is_same, has_target

      if (.not. allocated(are_known)) are_known = [(are_names_known(visitor, i, loads), i=1, size(moved_things))]
      associate (last => steps(size(steps)))
         if (.not. are_known(last%target)) return
         thing = trim(moved_things(last%target))
         call find_targets(last, loads, supports, contacts, names, has_target)
         call visitor%require(has_target, thing, trim(missing(last%target))//" '"//last%name//"'"// &
            names_text('there are', names))
         is_same = .false.
         do k = 1, size(steps) - 1
            if (steps(k)%target + last%target == stepped_load + stepped_support .and. steps(k)%name == last%name) then
               steps([k, size(steps)])%has_twin = .true.
            end if
            if (steps(k)%target /= last%target) cycle
            is_same = is_same .or. steps(k)%name == last%name
            if (last%target > stepped_support) is_same = is_same .or. &
               any([(last%acts_on(contacts(i)) .and. steps(k)%acts_on(contacts(i)), i=1, size(contacts))])
         end do
         call visitor%require(.not. is_same, thing, thing//" '"//last%name//"' has &steps already")
      end associate
   end subroutine check_name

   !> Finds the names that a change of its kind may have as a target, and whether its own is among them.
   subroutine find_targets(change, loads, supports, contacts, names, has_target)
      type(steps_t), intent(in) :: change !! the change
      type(load_t), intent(in) :: loads(:) !! the loads
      type(support_t), intent(in) :: supports(:) !! the supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      character(:), allocatable, intent(out) :: names !! the names, each with ', ' before it
      logical, intent(out) :: has_target !! whether that of the change is one of them

      names = ''
      has_target = .false.
      call take_all(.false.)
      if (.not. has_target) call take_all(.true.)

   contains

      !> Takes all names.
      subroutine take_all(is_listing)
         logical, intent(in) :: is_listing !! whether they are listed, too, which takes long where there are many
         integer :: i

         select case (change%target)
         case (stepped_load)
            do i = 1, size(loads)
               ! Rigid sets and preloads are among the loads, those without a force, too.
               if (loads(i)%target == load_on_motion .and. all(abs([loads(i)%force, loads(i)%moment]) <= 0.0_dp)) cycle
               call take(loads(i)%name, is_listing)
            end do
         case (stepped_support)
            do i = 1, size(supports)
               if (any(supports(i)%is_held)) call take(supports(i)%name, is_listing)
            end do
         case default
            do i = 1, size(contacts)
               if (change%target == stepped_obstacle .and. contacts(i)%pairing%is_pair()) cycle
               call take(contacts(i)%name, is_listing)
               call take(contacts(i)%set, is_listing)
            end do
         end select
      end subroutine take_all

      !> Takes a name, if there is one.
      subroutine take(name, is_listing)
         character(:), allocatable, intent(in) :: name !! the name
         logical, intent(in) :: is_listing !! whether it is listed

         if (.not. is_filled(name)) return
         if (is_listing .and. index(names//', ', ', '//name//', ') == 0) names = names//', '//name
         has_target = has_target .or. name == change%name
      end subroutine take

   end subroutine find_targets

end module amontons_history
