!> What a deck says of a load history.
module amontons_config_history
   use amontons_constraints, only: support_t
   use amontons_contact_set, only: contact_t
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_history, only: history_t, moved_things, steps_t, stepped_friction, stepped_load, stepped_obstacle, &
      stepped_support
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: describe_history

   !> The group of the times.
   type(group_t), parameter, public :: history_group = group_t('history')
   !> The group of a change.
   type(group_t), parameter, public :: steps_group = group_t('steps', is_repeatable=.true.)
   !> Keys of whose change it is.
   type(key_t), parameter :: name_keys(4) = [ &
      key_t(moved_things(stepped_load), 'with `factor`: the name of the load'), &
      key_t(moved_things(stepped_support), 'with `factor`: the name of the support, whose `ux`, `uy`, `un` and `ut`'// &
      ' are multiplied'), &
      key_t(moved_things(stepped_obstacle), 'with `shift_x`, `shift_y` and `turn`: the `name` or `set` of the'// &
      ' `&contact`'), &
      key_t(moved_things(stepped_friction), 'with `friction_factor`: the `name` or `set` of the `&contact`')]
   !> Number of keys of numbers.
   integer, parameter :: n_value_keys = 5
   !> Keys of its numbers; those of a motion may be left out one by one.
   type(key_t), parameter :: value_keys(n_value_keys) = [ &
      key_t('factor', 'what the loads of that name, or the displacements of the supports, are multiplied by: one'// &
      ' value for each of the `times`', also='value values'), &
      key_t('shift_x', 'how far the obstacle has moved along x at each of the `times`', 'L', default='`0.0`'), &
      key_t('shift_y', 'how far the obstacle has moved along y at each of the `times`', 'L', default='`0.0`'), &
      key_t('turn', 'the angle that the obstacle has turned by about `pivot` at each of the `times`,'// &
      ' counterclockwise', 'rad', default='`0.0`', also='angle rotation'), &
      key_t('friction_factor', 'what the friction of the `&contact` is multiplied by at each of the `times`', &
      at_least=0.0_dp)]
   !> What each of these numbers is for.
   integer, parameter :: first_shift = 2, last_shift = 4, friction_value = 5

contains

   !> Describes `&history` and all `&steps`.
   subroutine describe_history(visitor, history, loads, supports, contacts)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(history_t), intent(inout) :: history !! the history
      type(load_t), intent(in) :: loads(:) !! the loads of the deck
      type(support_t), intent(in) :: supports(:) !! its supports
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      integer :: i
      logical :: are_times_sound

      are_times_sound = history%is_given
      if (history%is_given) call describe_times(visitor, history)
      are_times_sound = are_times_sound .and. history%is_given .and. visitor%is_judging()
      do i = 1, size(history%steps)
         call describe_steps(visitor, history%steps(i))
         if (.not. visitor%is_judging()) cycle
         call visitor%require(history%is_given, '', '&steps needs &history')
         if (.not. visitor%deck%is_sound(visitor%place)) cycle
         if (are_times_sound) call check_times(visitor, history%times, history%steps(i))
         call check_name(visitor, history%steps(:i), loads, supports, contacts)
      end do
   end subroutine describe_history

   !> Describes `&history`.
   subroutine describe_times(visitor, history)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(history_t), intent(inout) :: history !! the history
      logical :: has_times, has_tolerance, has_least, has_start, has_start_step, has_cycles, has_period

      has_times = history%is_given
      has_tolerance = history%step_tolerance < huge(1.0_dp)
      has_least = history%min_step > 0.0_dp
      has_start = is_filled(history%start)
      has_start_step = history%start_step > 0
      has_cycles = allocated(history%cycles)
      has_period = history%period > 0.0_dp
      if (.not. allocated(history%name)) history%name = 'time'
      call visitor%open_group(history_group)
      call visitor%list(key_t('times', 'ascending values of the pseudo-time; the body is at rest and unstressed'// &
         ' before the first, everything changes linearly between them', is_required=.true., is_ascending=.true., &
         also='time'), history%times, has_times)
      call visitor%text(key_t('name', 'what the pseudo-time is called in tables: letters, digits and `_`'), &
         history%name)
      call visitor%whole(key_t('substeps', 'number of equal steps from one of the `times` to the next', &
         at_least=1.0_dp, also='n steps nsteps increments dt'), history%n_substeps)
      call visitor%real(key_t('step_tolerance', 'a step whose energy error is a larger part of its energies is'// &
         ' halved', default='no step is halved for this', above=0.0_dp, also='tolerance tol'), &
         history%step_tolerance, has_tolerance)
      call visitor%real(key_t('min_step', 'steps are not halved below this', default='1/1024 of a step', &
         above=0.0_dp, also='dtmin'), history%min_step, has_least)
      call visitor%list(key_t('cycles', 'times at which cycles begin and end, each at the end of a planned step;'// &
         ' with `period` the one time at which the first begins', default='none', is_ascending=.true., also='cycle'), &
         history%cycles, has_cycles)
      call visitor%real(key_t('period', 'with `cycles`: length of each cycle', default='the times are listed', &
         above=0.0_dp), history%period, has_period)
      call visitor%real(key_t('cycle_tolerance', 'with `cycles`: a cycle whose dissipation, forces and slips differ'// &
         ' less from those of the one before is like it', above=0.0_dp), history%cycle_tolerance)
      call visitor%text(key_t('start', 'a file `NAME.states.csv`: the body is in a state of that file before the'// &
         ' first step, which leads to the time behind it', default='at rest', is_file=.true., is_filled=.true., &
         also='restart initial'), history%start, has_start)
      call visitor%whole(key_t('start_step', 'with `start`: the step of the state', default='the last in the file', &
         at_least=1.0_dp), history%start_step, has_start_step)
      call visitor%close_group()
      history%is_given = has_times
      if (.not. visitor%is_judging()) return
      call visitor%require(visitor%deck%count_groups('sweep') == 0, '', &
         'a deck has either &history or &sweep; give each a deck of its own')
      call visitor%only('start_step', is_filled(history%start), 'start')
      call visitor%only('period', has_cycles, 'cycles')
      if (has_times .and. has_cycles) call judge_cycles(visitor, history)
      call visitor%require( &
         verify(history%name, 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_') == 0 .and. &
         len(history%name) > 0, 'name', 'name must consist of letters, digits and _')
   end subroutine describe_times

   !> Judges the times of cycles.
   subroutine judge_cycles(visitor, history)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(history_t), intent(in) :: history !! the history, with times and cycles
      real(dp), allocatable :: ends(:)
      real(dp) :: nearest, before
      integer :: i
      ! How far the end of a cycle may be from that of a planned step, over the whole history.
      real(dp), parameter :: near = 1.0e-9_dp

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
         call visitor%require(nearest > before .and. abs(nearest - ends(i)) <= near*(history%times(size( &
            history%times)) - history%times(1)), 'cycles', 'no planned step ends at '//to_text(ends(i))// &
            ', where a cycle should begin or end; the nearest ends at '//to_text(nearest))
         if (.not. visitor%deck%is_sound(visitor%place)) return
         before = nearest
      end do
   end subroutine judge_cycles

   !> Describes one `&steps`.
   subroutine describe_steps(visitor, steps)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(steps_t), intent(inout) :: steps !! what changes
      real(dp), allocatable :: values(:)
      logical :: has_name(size(name_keys)), has_values(size(value_keys)), has_pivot, has_table
      integer :: i

      has_name = .false.
      has_name(steps%target) = is_filled(steps%name)
      has_pivot = steps%target == stepped_obstacle
      has_table = is_filled(steps%file)
      call visitor%open_group(steps_group)
      do i = 1, size(name_keys)
         call visitor%text(name_keys(i), steps%name, has_name(i))
         if (visitor%place > 0 .and. has_name(i)) steps%target = i
      end do
      do i = 1, size(value_keys)
         has_values(i) = allocated(steps%values) .and. .not. has_table .and. takes(steps%target, i)
         if (has_values(i)) values = steps%values(row_of(i), :)
         call visitor%list(value_keys(i), values, has_values(i))
         if (visitor%place > 0 .and. has_values(i)) call keep_values(steps, row_of(i), values)
      end do
      call visitor%reals(key_t('pivot', 'with `turn`: what the obstacle turns about', 'L', default='`0.0, 0.0`'), &
         steps%pivot, has_pivot)
      call visitor%text(key_t('table', 'instead of the lists: file of times and numbers in columns, linear between;'// &
         ' of an obstacle time, `shift_x`, `shift_y` and `turn`', is_file=.true., is_filled=.true., also='file'), &
         steps%file, has_table)
      call visitor%table('table', steps%file, steps%table, 1 + steps%n_numbers())
      call visitor%close_group()
      call visitor%locate('load', steps%origin)
      if (visitor%is_judging()) call judge_steps(visitor, steps, has_name, has_values)
   end subroutine describe_steps

   !> Whether a change takes one of the numbers.
   pure logical function takes(target, number)
      integer, intent(in) :: target !! what changes
      integer, intent(in) :: number !! which of `value_keys`

      select case (number)
      case (first_shift:last_shift)
         takes = target == stepped_obstacle
      case (friction_value)
         takes = target == stepped_friction
      case default
         takes = target == stepped_load .or. target == stepped_support
      end select
   end function takes

   !> Where a number is kept.
   pure integer function row_of(number)
      integer, intent(in) :: number !! which of `value_keys`

      row_of = 1
      if (number >= first_shift .and. number <= last_shift) row_of = number - first_shift + 1
   end function row_of

   !> Keeps the numbers of one key. Those that a motion does not give are 0.
   pure subroutine keep_values(steps, row, values)
      type(steps_t), intent(inout) :: steps !! gains the numbers
      integer, intent(in) :: row !! where they are kept
      real(dp), intent(in) :: values(:) !! the numbers

      if (.not. allocated(steps%values)) allocate (steps%values(steps%n_numbers(), size(values)), source=0.0_dp)
      if (row <= size(steps%values, 1) .and. size(values) == size(steps%values, 2)) steps%values(row, :) = values
   end subroutine keep_values

   !> Judges the keys of a `&steps` together.
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
         if (takes(steps%target, i)) cycle
         call visitor%only(trim(value_keys(i)%name), .false., owners(i))
      end do
      call visitor%only('pivot', steps%target == stepped_obstacle, 'obstacle')
      n_given = count(has_values)
      call visitor%require((n_given > 0) .neqv. visitor%has('table'), '', '&steps needs either values or table')
      if (allocated(steps%table)) call judge_table(visitor, steps%target, steps%table)
      if (allocated(steps%values)) call judge_motion(visitor, size(steps%values, 2), has_values)
   end subroutine judge_steps

   !> Judges the table of a `&steps`.
   subroutine judge_table(visitor, target, table)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      integer, intent(in) :: target !! what changes
      real(dp), intent(in) :: table(:, :) !! a time and its numbers in each column

      call visitor%require(all(table(1, 2:) > table(1, :size(table, 2) - 1)), 'table', &
         'table must have times that increase from row to row')
      call visitor%require(target /= stepped_friction .or. all(table(2:, :) >= 0.0_dp), 'table', &
         'table must not have a negative friction_factor')
   end subroutine judge_table

   !> Judges whether the lists of a motion are equally long.
   subroutine judge_motion(visitor, n_values, has_values)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      integer, intent(in) :: n_values !! how many values are kept of each list
      logical, intent(in) :: has_values(:) !! which of `value_keys` are given
      integer :: i

      do i = first_shift, last_shift
         if (.not. has_values(i)) cycle
         call visitor%require(visitor%deck%count_values(visitor%place, trim(value_keys(i)%name), huge(1)) == &
            n_values, trim(value_keys(i)%name), 'shift_x, shift_y and turn need equally many values')
      end do
   end subroutine judge_motion

   !> What takes a number, for messages.
   pure function owners(number) result(text)
      integer, intent(in) :: number !! which of `value_keys`
      character(:), allocatable :: text

      select case (number)
      case (first_shift:last_shift)
         text = 'obstacle'
      case (friction_value)
         text = 'contact'
      case default
         text = 'load and support'
      end select
   end function owners

   !> Checks that a change has a value for each time, or a table that reaches over all of them.
   subroutine check_times(visitor, times, steps)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor, at the group of the change
      real(dp), intent(in) :: times(:) !! the times of the history
      type(steps_t), intent(in) :: steps !! the change

      if (allocated(steps%table)) then
         associate (rows => steps%table(1, :))
            call visitor%require(rows(1) <= times(1), 'table', "table '"//file_part(steps%file)//"' begins at "// &
               to_text(rows(1))//', after the first time '//to_text(times(1)))
            call visitor%require(rows(size(rows)) >= times(size(times)), 'table', "table '"//file_part(steps%file)// &
               "' ends at "//to_text(rows(size(rows)))//', before the last time '//to_text(times(size(times))))
         end associate
      else if (allocated(steps%values)) then
         call visitor%require(size(steps%values, 2) == size(times), '', '&steps '//trim(moved_things(steps%target))// &
            " = '"//steps%name//"' has "//to_text(size(steps%values, 2))//' values, &history has '// &
            to_text(size(times))//' times')
      end if
   end subroutine check_times

   !> The name of a file without its folder.
   pure function file_part(path) result(name)
      character(*), intent(in) :: path !! name of the file
      character(:), allocatable :: name

      name = path(index(path, '/', back=.true.) + 1:)
   end function file_part

   !> Checks that there is what changes, and that it does not change twice.
   subroutine check_name(visitor, steps, loads, supports, contacts)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor, at the group of the last change
      type(steps_t), intent(in) :: steps(:) !! the change, and those before it
      type(load_t), intent(in) :: loads(:) !! the loads
      type(support_t), intent(in) :: supports(:) !! the supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      character(:), allocatable :: thing
      integer :: k

      associate (last => steps(size(steps)))
         if (.not. knows_names(visitor, last%target)) return
         thing = trim(moved_things(last%target))
         call visitor%require(has_target(last, loads, supports, contacts), thing, &
            missing(last%target)//" '"//last%name//"'")
         do k = 1, size(steps) - 1
            call visitor%require(.not. change_the_same(steps(k), last, contacts), thing, &
               thing//" '"//last%name//"' has &steps already")
         end do
      end associate
   end subroutine check_name

   !> Whether the names that a change may have are known, there being no fault in them.
   logical function knows_names(visitor, target)
      class(deck_visitor_t), intent(in) :: visitor !! the visitor
      integer, intent(in) :: target !! what changes

      select case (target)
      case (stepped_load)
         knows_names = visitor%deck%knows('load', 'name')
      case (stepped_support)
         knows_names = visitor%deck%knows('support', 'name')
      case default
         knows_names = visitor%deck%knows('contact', 'set') .and. visitor%deck%knows('contact', 'name')
      end select
   end function knows_names

   !> Whether there is what a change names.
   pure logical function has_target(change, loads, supports, contacts)
      type(steps_t), intent(in) :: change !! the change
      type(load_t), intent(in) :: loads(:) !! the loads
      type(support_t), intent(in) :: supports(:) !! the supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      integer :: i

      select case (change%target)
      case (stepped_load)
         has_target = any([(loads(i)%name == change%name, i=1, size(loads))])
      case (stepped_support)
         has_target = any([(supports(i)%name == change%name .and. any(supports(i)%is_held), i=1, size(supports))])
      case default
         has_target = any([(change%acts_on(contacts(i)) .and. (change%target == stepped_friction .or. &
            .not. contacts(i)%pairing%is_pair()), i=1, size(contacts))])
      end select
   end function has_target

   !> Whether two changes are of the same thing.
   pure logical function change_the_same(first, second, contacts)
      type(steps_t), intent(in) :: first !! a change
      type(steps_t), intent(in) :: second !! another change
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      integer :: i

      change_the_same = first%target == second%target .and. (first%name == second%name .or. &
         any([(second%acts_on(contacts(i)) .and. first%acts_on(contacts(i)), i=1, size(contacts))]))
   end function change_the_same

   !> How a message says that there is nothing of a name.
   pure function missing(target) result(text)
      integer, intent(in) :: target !! what would change
      character(:), allocatable :: text

      select case (target)
      case (stepped_load)
         text = 'no &load has the name'
      case (stepped_support)
         text = 'no &support with ux, uy, un or ut has the name'
      case (stepped_obstacle)
         text = 'no &contact with a rigid obstacle has the name or set'
      case default
         text = 'no &contact has the name or set'
      end select
   end function missing

end module amontons_config_history
