!> What a deck says of a sweep.
module amontons_config_sweep
   use amontons_contact_set, only: contact_t
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t, most_values
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t
   use amontons_sweep, only: combination_names, largest_n_cases, quantity_names, sweep_axis_t, sweep_t, &
      swept_friction, swept_load
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: describe_sweep

   !> The group of a quantity of a sweep.
   type(group_t), parameter, public :: sweep_group = group_t('sweep', is_repeatable=.true.)
   !> Keys of the values of each quantity.
   type(key_t), parameter :: value_keys(*) = [ &
      key_t(quantity_names(1), 'what the loads of that name are multiplied by', also='value values'), &
      key_t(quantity_names(2), "Coulomb's coefficient, in the place of the key `friction` of `&contact` (a"// &
      ' `friction_slope` stays)', at_least=0.0_dp, also='mu'), &
      key_t(quantity_names(3), 'what the friction of `&contact` is multiplied by, slope and table included', &
      at_least=0.0_dp)]

contains

   !> Describes all `&sweep`: each varies one quantity.
   subroutine describe_sweep(visitor, sweep, loads, contacts)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(sweep_t), intent(inout) :: sweep !! the sweep
      type(load_t), intent(in) :: loads(:) !! the loads of the deck
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      integer :: i
      logical :: are_sound

      are_sound = size(sweep%axes) > 0
      do i = 1, size(sweep%axes)
         call describe_axis(visitor, sweep%axes(i))
         are_sound = are_sound .and. visitor%place > 0 .and. visitor%deck%is_sound(visitor%place)
         if (are_sound) call check_axis(visitor, sweep%axes(:i), loads, contacts)
      end do
      if (are_sound) call visitor%require(sweep%n_cases() <= largest_n_cases, 'count', &
         'the sweep has too many cases: expected at most '//to_text(largest_n_cases))
   end subroutine describe_sweep

   !> Describes one `&sweep`.
   subroutine describe_axis(visitor, axis)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(sweep_axis_t), intent(inout) :: axis !! the quantity
      character(len(combination_names)) :: combination
      integer :: n_steps, i
      logical :: has_load, has_set, has_values(size(value_keys))

      has_load = is_filled(axis%name) .and. axis%target == swept_load
      has_set = is_filled(axis%name) .and. .not. has_load
      has_values = .false.
      has_values(axis%target) = allocated(axis%values)
      n_steps = 0
      if (axis%is_range) then
         n_steps = size(axis%values)
         axis%values = axis%values([1, n_steps])
      end if
      combination = combination_names(merge(2, 1, axis%is_paired))
      call visitor%open_group(sweep_group)
      call visitor%text(key_t('load', 'with `factor`, where it is required: the name of the load', also='name'), &
         axis%name, has_load)
      call visitor%text(key_t('contact', 'with `friction` or `friction_factor`: the `set` of the `&contact`', &
         default='all', is_filled=.true., also='set'), axis%name, has_set)
      do i = 1, size(value_keys)
         call visitor%list(value_keys(i), axis%values, has_values(i))
      end do
      call visitor%whole(key_t('count', 'the two numbers given are the first and the last of so many, in equal'// &
         ' steps', at_least=2.0_dp, also='n step steps'), n_steps, axis%is_range)
      call visitor%word(key_t('combine', 'every value with every combination of the groups before, or value by'// &
         ' value along with the group before'), combination, combination_names)
      call visitor%close_group()
      axis%target = max(swept_load, findloc(has_values, .true., dim=1))
      axis%is_paired = combination == combination_names(2)
      call visitor%locate('load', axis%origin)
      if (.not. visitor%is_judging()) return
      call visitor%require(count(has_values) == 1, '', &
         '&sweep needs either factor, friction or friction_factor; give each a group of its own')
      if (count(has_values) /= 1) return
      call visitor%only('load', axis%target == swept_load, 'factor')
      call visitor%only('contact', axis%target /= swept_load, 'friction and friction_factor')
      call visitor%require(has_load .or. axis%target /= swept_load, 'factor', 'factor needs load')
      if (axis%is_range) call spread_values(visitor, axis%values, trim(value_keys(axis%target)%name), n_steps)
   end subroutine describe_axis

   !> Turns two values, the first and the last, into a number of values in equal steps.
   subroutine spread_values(visitor, values, key, n_steps)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      real(dp), allocatable, intent(inout) :: values(:) !! first and last value, all of them on return
      character(*), intent(in) :: key !! the key of the values
      integer, intent(in) :: n_steps !! how many values there are to be
      ! Wide enough that the steps from 0.1 to 1.0 in tenths are the tenths, to the last bit. Not every compiler has 30
      ! digits.
      integer, parameter :: wide = max(selected_real_kind(p=30), selected_real_kind(p=18))
      real(wide) :: ends(2)
      integer :: i

      call visitor%require(size(values) == 2, key, 'count needs two values, the first and the last; found '// &
         to_text(size(values)))
      call visitor%require(n_steps <= most_values, 'count', 'count must be at most '//to_text(most_values)// &
         ', found '//to_text(n_steps))
      if (size(values) /= 2 .or. n_steps < 2 .or. n_steps > most_values) return
      ends = real(values, wide)
      values = [(real((ends(1)*(n_steps - i) + ends(2)*(i - 1))/(n_steps - 1), dp), i=1, n_steps)]
   end subroutine spread_values

   !> Checks that there is what a quantity varies, and that it goes with the quantities before it.
   subroutine check_axis(visitor, axes, loads, contacts)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor, at the group of the last quantity
      type(sweep_axis_t), intent(in) :: axes(:) !! the quantity, and those before it
      type(load_t), intent(in) :: loads(:) !! the loads
      type(contact_t), intent(in) :: contacts(:) !! the contact sets

      associate (axis => axes(size(axes)))
         if (axis%target /= swept_load) then
            if (visitor%deck%knows('contact', 'set')) call check_contacts(visitor, axis, contacts)
         else if (visitor%deck%knows('load', 'name')) then
            call check_load(visitor, axis, loads)
         end if
      end associate
      call check_combination(visitor, axes, contacts)
   end subroutine check_axis

   !> Checks that there is a load of the name that a quantity multiplies.
   subroutine check_load(visitor, axis, loads)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor, at the group of the quantity
      type(sweep_axis_t), intent(in) :: axis !! the quantity
      type(load_t), intent(in) :: loads(:) !! the loads
      character(:), allocatable :: names
      integer :: i

      names = ''
      do i = 1, size(loads)
         if (len(loads(i)%name) == 0) cycle
         if (loads(i)%name == axis%name) return
         names = names//', '//loads(i)%name
      end do
      call visitor%require(.false., 'load', "no load has the name '"//axis%name//"'"//list('named loads', names))
   end subroutine check_load

   !> Checks that there are contact sets whose friction a quantity can be.
   subroutine check_contacts(visitor, axis, contacts)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor, at the group of the quantity
      type(sweep_axis_t), intent(in) :: axis !! the quantity
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      character(:), allocatable :: names
      integer :: i
      logical :: is_found

      is_found = .false.
      names = ''
      do i = 1, size(contacts)
         names = names//', '//contacts(i)%set
         if (.not. axis%acts_on(contacts(i)%set)) cycle
         is_found = .true.
         call visitor%require(.not. (axis%target == swept_friction .and. allocated(contacts(i)%friction%table)), &
            'friction', "the friction of contact set '"//contacts(i)%set// &
            "' comes from a table; use friction_factor, which multiplies it")
      end do
      call visitor%require(is_found, 'contact', "no &contact has the set '"//axis%name//"'"//list('sets', names))
   end subroutine check_contacts

   !> What a message adds to tell the names there are.
   pure function list(noun, names) result(text)
      character(*), intent(in) :: noun !! what they name
      character(*), intent(in) :: names !! the names, each with ', ' before it
      character(:), allocatable :: text

      text = 'none'
      if (len(names) > 0) text = names(3:)
      text = ' ('//noun//': '//text//')'
   end function list

   !> Checks a quantity against those before it: nothing varies twice, and what is paired has as many values.
   subroutine check_combination(visitor, axes, contacts)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor, at the group of the last quantity
      type(sweep_axis_t), intent(in) :: axes(:) !! the quantity, and those before it
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      integer :: n, i, k

      n = size(axes)
      do i = 1, n - 1
         call visitor%require(.not. (axes(i)%target == swept_load .and. axes(n)%target == swept_load .and. &
            axes(i)%name == axes(n)%name), 'load', "load '"//axes(n)%name//"' is swept already")
         do k = 1, size(contacts)
            call visitor%require(.not. (axes(i)%acts_on(contacts(k)%set) .and. axes(n)%acts_on(contacts(k)%set)), &
               'contact', "the friction of contact set '"//contacts(k)%set//"' is swept already")
         end do
      end do
      if (.not. axes(n)%is_paired) return
      call visitor%require(n > 1, 'combine', 'the first &sweep has none before it to be paired with')
      if (n > 1) call visitor%require(size(axes(n)%values) == size(axes(n - 1)%values), 'combine', &
         'a paired &sweep needs as many values as the one before: expected '//to_text(size(axes(n - 1)%values))// &
         ', found '//to_text(size(axes(n)%values)))
   end subroutine check_combination

end module amontons_config_sweep
