!> The sweep that a deck asks for.
module amontons_config_sweep
   use amontons_contact_zone, only: contact_t
   use amontons_deck, only: deck_t
   use amontons_deck_rules, only: origin_of, require
   use amontons_kinds, only: dp, int64
   use amontons_loads, only: load_t
   use amontons_sweep, only: combination_names, largest_n_cases, quantity_names, sweep_axis_t, sweep_t, &
      swept_friction, swept_load
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: read_sweep

   !> Most values of a quantity.
   integer, parameter :: most_values = 1000000

contains

   !> Reads all `&sweep`: each varies one quantity.
   subroutine read_sweep(sweep, deck, loads, contacts)
      type(sweep_t), intent(out) :: sweep !! the sweep
      type(deck_t), intent(inout) :: deck !! the deck
      type(load_t), intent(in) :: loads(:) !! its loads
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      integer, allocatable :: groups(:)
      integer :: i

      groups = deck%groups('sweep')
      allocate (sweep%axes(size(groups)))
      do i = 1, size(groups)
         call read_axis(sweep%axes(i), deck, groups(i))
      end do
      if (.not. all_are_sound(deck, groups)) return
      do i = 1, size(groups)
         if (sweep%axes(i)%target /= swept_load) then
            if (deck%knows('contact', 'set')) call check_contacts(sweep%axes(i), deck, groups(i), contacts)
         else if (deck%knows('load', 'name')) then
            call check_load(sweep%axes(i), deck, groups(i), loads)
         end if
         call check_combination(sweep%axes(:i), deck, groups(i), contacts)
      end do
      if (size(groups) == 0 .or. .not. all_are_sound(deck, groups)) return
      if (sweep%n_cases() > largest_n_cases) call deck%fault(groups(size(groups)), 'count', &
         'the sweep has too many cases: expected at most '//to_text(largest_n_cases))
   end subroutine read_sweep

   !> Whether no group has a fault so far.
   pure logical function all_are_sound(deck, groups)
      type(deck_t), intent(in) :: deck !! the deck
      integer, intent(in) :: groups(:) !! the groups
      integer :: i

      all_are_sound = all([(deck%is_sound(groups(i)), i=1, size(groups))])
   end function all_are_sound

   !> Reads one `&sweep`.
   subroutine read_axis(axis, deck, group)
      type(sweep_axis_t), intent(inout) :: axis !! the quantity
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(:), allocatable :: set, combination
      real(dp), allocatable :: values(:)
      integer :: n_steps, i
      logical :: has_load, has_set, has_count, has_values(3)

      axis%origin = origin_of(deck, group, 'load')
      axis%name = ''
      set = ''
      combination = trim(combination_names(1))
      n_steps = 0
      call deck%get(group, 'load', axis%name, has_load)
      call deck%get(group, 'contact', set, has_set)
      do i = 1, size(quantity_names)
         call read_values(values, deck, group, trim(quantity_names(i)))
         has_values(i) = allocated(values)
         if (.not. allocated(values)) cycle
         axis%target = i
         call move_alloc(values, axis%values)
      end do
      call deck%get(group, 'count', n_steps, has_count)
      call deck%get_word(group, 'combine', combination, combination_names)
      call deck%refuse_unknown(group)
      if (.not. deck%is_sound(group)) return
      axis%is_paired = combination == combination_names(2)
      if (has_set) axis%name = set
      call require(deck, group, 'factor', count(has_values) == 1, 'be given, or friction or friction_factor; each '// &
         '&sweep varies one of them')
      if (.not. deck%is_sound(group)) return
      call check_keys(axis, deck, group, has_load, has_set)
      axis%is_range = has_count
      if (has_count) call spread_values(axis%values, deck, group, trim(quantity_names(axis%target)), n_steps)
   end subroutine read_axis

   !> Checks that the keys of a group belong together.
   subroutine check_keys(axis, deck, group, has_load, has_set)
      type(sweep_axis_t), intent(in) :: axis !! the quantity
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! its group
      logical, intent(in) :: has_load !! whether it names a load
      logical, intent(in) :: has_set !! whether it names a contact set

      if (axis%target == swept_load) then
         call require(deck, group, 'load', has_load, 'go with factor, and name the load')
         call require(deck, group, 'contact', .not. has_set, 'go with friction or friction_factor')
      else
         call require(deck, group, 'load', .not. has_load, 'go with factor')
         call require(deck, group, 'contact', .not. has_set .or. len_trim(axis%name) > 0, 'not be empty')
         call require(deck, group, trim(quantity_names(axis%target)), all(axis%values >= 0.0_dp), &
            'be at least 0, found '//to_text(minval(axis%values)))
      end if
   end subroutine check_keys

   !> Reads a list of values of any length.
   subroutine read_values(values, deck, group, key)
      real(dp), allocatable, intent(out) :: values(:) !! the values; not allocated where the key is absent
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key
      logical :: is_given

      allocate (values(int(max(1_int64, min(deck%n_values(group, key), int(most_values, int64))))), source=0.0_dp)
      call deck%get(group, key, values, is_given)
      if (.not. is_given) deallocate (values)
   end subroutine read_values

   !> Turns two values, the first and the last, into a number of values in equal steps.
   subroutine spread_values(values, deck, group, key, n_steps)
      real(dp), allocatable, intent(inout) :: values(:) !! first and last value, all of them on return
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key of the values
      integer, intent(in) :: n_steps !! how many values there are to be
      ! Wide enough that the steps from 0.1 to 1.0 in tenths are the tenths, to the last bit. Not every compiler has 30
      ! digits.
      integer, parameter :: wide = max(selected_real_kind(p=30), selected_real_kind(p=18))
      real(wide) :: ends(2)
      integer :: i

      call require(deck, group, key, size(values) == 2, 'be the first and the last value where count is given, found ' &
         //to_text(size(values))//' values')
      call require(deck, group, 'count', n_steps >= 2 .and. n_steps <= most_values, 'lie between 2 and '// &
         to_text(most_values)//', found '//to_text(n_steps))
      if (size(values) /= 2 .or. n_steps < 2 .or. n_steps > most_values) return
      ends = real(values, wide)
      values = [(real((ends(1)*(n_steps - i) + ends(2)*(i - 1))/(n_steps - 1), dp), i=1, n_steps)]
   end subroutine spread_values

   !> Checks that there is a load of the name that a quantity multiplies.
   subroutine check_load(axis, deck, group, loads)
      type(sweep_axis_t), intent(in) :: axis !! the quantity
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! its group
      type(load_t), intent(in) :: loads(:) !! the loads
      character(:), allocatable :: names
      integer :: i

      names = ''
      do i = 1, size(loads)
         if (len(loads(i)%name) == 0) cycle
         if (loads(i)%name == axis%name) return
         names = names//', '//loads(i)%name
      end do
      call deck%fault(group, 'load', "no load has the name '"//axis%name//"'"//list('named loads', names))
   end subroutine check_load

   !> Checks that there are contact sets whose friction a quantity can be.
   subroutine check_contacts(axis, deck, group, contacts)
      type(sweep_axis_t), intent(in) :: axis !! the quantity
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! its group
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
         if (axis%target == swept_friction .and. allocated(contacts(i)%friction%table)) call deck%fault(group, &
            'friction', "the friction of contact set '"//contacts(i)%set// &
            "' comes from a table: expected friction_factor, which multiplies it")
      end do
      if (.not. is_found) call deck%fault(group, 'contact', "no &contact has the set '"//axis%name//"'"// &
         list('sets', names))
   end subroutine check_contacts

   !> What a message adds to tell the names there are.
   pure function list(noun, names) result(text)
      character(*), intent(in) :: noun !! what they name
      character(*), intent(in) :: names !! the names, each with ', ' before it
      character(:), allocatable :: text

      text = ' ('//noun//': '
      if (len(names) == 0) then
         text = text//'none)'
      else
         text = text//names(3:)//')'
      end if
   end function list

   !> Checks a quantity against those before it: nothing varies twice, and what is paired has as many values.
   subroutine check_combination(axes, deck, group, contacts)
      type(sweep_axis_t), intent(in) :: axes(:) !! the quantity, and those before it
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group of the last of them
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      integer :: n, i, k

      n = size(axes)
      do i = 1, n - 1
         if (axes(i)%target == swept_load .and. axes(n)%target == swept_load) call require(deck, group, 'load', &
            axes(i)%name /= axes(n)%name, "not be swept twice, found '"//axes(n)%name//"' again")
         do k = 1, size(contacts)
            if (axes(i)%acts_on(contacts(k)%set) .and. axes(n)%acts_on(contacts(k)%set)) call deck%fault(group, &
               'contact', "the friction of contact set '"//contacts(k)%set//"' is swept already")
         end do
      end do
      if (.not. axes(n)%is_paired) return
      if (n == 1) then
         call deck%fault(group, 'combine', 'the first &sweep has none before it to be paired with')
      else
         call require(deck, group, 'combine', size(axes(n)%values) == size(axes(n - 1)%values), &
            "be 'paired' only with as many values as the &sweep before it has: expected "// &
            to_text(size(axes(n - 1)%values))//', found '//to_text(size(axes(n)%values)))
      end if
   end subroutine check_combination

end module amontons_config_sweep
