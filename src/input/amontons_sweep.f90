!> A sweep: the quantities that vary from case to case, the cases as combinations of their values, and the groups of a
!> deck that describe them.
!>
!> Each quantity has a list of values. A paired quantity changes together with the one before it, value by value; the
!> others are combined in full, the last one varying fastest. Cases are numbered from 1.
module amontons_sweep
   use amontons_contact_set, only: contact_t
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t, most_values, names_text
   use amontons_kinds, only: dp, int64
   use amontons_loads, only: load_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: describe_sweep, key_result_names, largest_n_cases, sweep_t

   !> Target of a swept quantity: the factor of all loads with a name.
   integer, parameter, public :: swept_load = 1
   !> Target of a swept quantity: Coulomb's coefficient, instead of the key `friction` of contact sets.
   integer, parameter, public :: swept_friction = 2
   !> Target of a swept quantity: a factor on the friction of contact sets.
   integer, parameter, public :: swept_friction_factor = 3

   !> Names of these quantities, which are also the keys of their values.
   character(15), parameter :: quantity_names(3) = [character(15) :: 'factor', 'friction', 'friction_factor']
   !> Ways to combine a quantity with those before it, as a deck writes them.
   character(7), parameter :: combination_names(2) = [character(7) :: 'product', 'paired']
   !> Parts of the model whose key results are in the table of a sweep, as a deck writes them.
   character(7), parameter :: key_result_names(3) = [character(7) :: 'contact', 'forces', 'all']
   !> Most cases of a sweep.
   integer, parameter :: largest_n_cases = 1000000000

   !> A quantity and the values it takes.
   type :: sweep_axis_t
      integer :: target = swept_load !! its kind
      character(:), allocatable :: name !! name of the load, or of the contact set; empty for all contact sets
      real(dp), allocatable :: values(:) !! its values [-]
      logical :: is_range = .false. !! whether the values lead in equal steps from the first to the last
      logical :: is_paired = .false. !! whether it goes along with the quantity before it
      character(:), allocatable :: origin !! where it was specified, for messages: 'deck.nml:12: '
   contains
      procedure :: acts_on => sweep_axis_acts_on
      procedure :: label => sweep_axis_label
   end type sweep_axis_t

   !> The quantities of a sweep; without any there is no sweep.
   type :: sweep_t
      type(sweep_axis_t), allocatable :: axes(:) !! the quantities, in the deck's order
      logical :: has_body_results = .false. !! whether the key results of the whole body are kept of each case
      logical :: has_forces = .false. !! whether the forces by name are
      integer :: fields_every = 0 !! the fields of the first case and of every so many behind it are written; 0 for none
   contains
      procedure :: has_fields => sweep_has_fields
      procedure :: is_given => sweep_is_given
      procedure :: n_cases => sweep_n_cases
      procedure :: n_fields => sweep_n_fields
      procedure :: neighbor => sweep_neighbor
      procedure :: places => sweep_places
      procedure :: set_friction => sweep_set_friction
      procedure :: values => sweep_values
   end type sweep_t

   !> The group of a quantity of a sweep.
   type(group_t), parameter, public :: sweep_group = group_t('sweep', is_repeatable=.true.)
   !> Keys of the values of each quantity.
   type(key_t), parameter :: value_keys(*) = [ &
      key_t(quantity_names(1), 'what the loads of that name are multiplied by', also='value values'), &
      key_t(quantity_names(2), "Coulomb's coefficient, instead of the key `friction` of `&contact` (a"// &
      ' `friction_slope` stays)', at_least=0.0_dp, also='mu'), &
      key_t(quantity_names(3), 'what the friction of `&contact` is multiplied by, slope and table included', &
      at_least=0.0_dp)]

contains

   !> Whether the quantity is the friction of a given contact set.
   pure logical function sweep_axis_acts_on(self, set) result(acts)
      class(sweep_axis_t), intent(in) :: self !! the quantity
      character(*), intent(in) :: set !! name of the contact set

      acts = self%target /= swept_load .and. (len(self%name) == 0 .or. self%name == set)
   end function sweep_axis_acts_on

   !> Column name of the quantity: 'factor_side', 'friction', 'friction_factor_bottom'.
   pure function sweep_axis_label(self) result(label)
      class(sweep_axis_t), intent(in) :: self !! the quantity
      character(:), allocatable :: label

      label = trim(quantity_names(self%target))
      if (len(self%name) > 0) label = label//'_'//self%name
   end function sweep_axis_label

   !> Whether the deck has a sweep.
   pure logical function sweep_is_given(self)
      class(sweep_t), intent(in) :: self !! the sweep

      sweep_is_given = .false.
      if (allocated(self%axes)) sweep_is_given = size(self%axes) > 0
   end function sweep_is_given

   !> Sets the coefficients of contact sets whose friction varies to the least or largest swept value.
   pure subroutine sweep_set_friction(self, contacts, is_least)
      class(sweep_t), intent(in) :: self !! the sweep
      type(contact_t), intent(inout) :: contacts(:) !! the contact sets
      logical, intent(in) :: is_least !! whether the least value is meant, or the largest one
      integer :: i, k

      if (.not. self%is_given()) return
      do i = 1, size(self%axes)
         if (self%axes(i)%target /= swept_friction) cycle
         do k = 1, size(contacts)
            if (self%axes(i)%acts_on(contacts(k)%set)) contacts(k)%friction%value = merge( &
               minval(self%axes(i)%values), maxval(self%axes(i)%values), is_least)
         end do
      end do
   end subroutine sweep_set_friction

   !> Number of cases; some number above `largest_n_cases` if there are more.
   pure integer(int64) function sweep_n_cases(self) result(n_cases)
      class(sweep_t), intent(in) :: self !! the sweep
      integer :: i

      n_cases = 1
      do i = 1, size(self%axes)
         if (.not. self%axes(i)%is_paired) n_cases = n_cases*size(self%axes(i)%values)
         if (n_cases > largest_n_cases) return
      end do
   end function sweep_n_cases

   !> Number of cases whose fields are asked for.
   pure integer(int64) function sweep_n_fields(self) result(n_fields)
      class(sweep_t), intent(in) :: self !! the sweep

      n_fields = 0
      if (self%fields_every > 0) n_fields = (self%n_cases() - 1)/self%fields_every + 1
   end function sweep_n_fields

   !> Whether the fields of one of these cases are asked for.
   pure logical function sweep_has_fields(self, first, last) result(has_fields)
      class(sweep_t), intent(in) :: self !! the sweep
      integer, intent(in) :: first !! number of the first case
      integer, intent(in) :: last !! number of the last case

      has_fields = .false.
      if (self%fields_every > 0) has_fields = modulo(1 - first, self%fields_every) <= last - first
   end function sweep_has_fields

   !> For each quantity the index of its value in a case.
   pure function sweep_places(self, number) result(places)
      class(sweep_t), intent(in) :: self !! the sweep
      integer, intent(in) :: number !! number of the case
      integer :: places(size(self%axes))
      integer :: rest, i

      rest = number - 1
      do i = size(self%axes), 1, -1
         associate (n => size(self%axes(i)%values))
            places(i) = mod(rest, n) + 1
            if (.not. self%axes(i)%is_paired) rest = rest/n
         end associate
      end do
   end function sweep_places

   !> The value that each quantity has in a case [-].
   pure function sweep_values(self, number) result(values)
      class(sweep_t), intent(in) :: self !! the sweep
      integer, intent(in) :: number !! number of the case
      real(dp) :: values(size(self%axes))
      integer :: places(size(self%axes)), i

      places = self%places(number)
      do i = 1, size(values)
         values(i) = self%axes(i)%values(places(i))
      end do
   end function sweep_values

   !> The earlier case that differs from a case by one step of one quantity, the fastest-varying one that can step back;
   !> 0 for the first case.
   pure integer function sweep_neighbor(self, number) result(neighbor)
      class(sweep_t), intent(in) :: self !! the sweep
      integer, intent(in) :: number !! number of the case
      integer :: places(size(self%axes)), stride, i

      places = self%places(number)
      stride = 1
      neighbor = 0
      do i = size(places), 1, -1
         if (places(i) > 1) then
            neighbor = number - stride
            return
         end if
         if (.not. self%axes(i)%is_paired) stride = stride*size(self%axes(i)%values)
      end do
   end function sweep_neighbor

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
      ! Wide enough that the steps from 0.1 to 1.0 in tenths are the tenths, to the last bit. Not every compiler has 30
      ! digits.
      integer, parameter :: wide = max(selected_real_kind(p=30), selected_real_kind(p=18))
      real(wide) :: ends(2)

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
      if (axis%is_range) then
         ! Turns two values, the first and the last, into a number of values in equal steps.
         call visitor%require(size(axis%values) == 2, trim(value_keys(axis%target)%name), &
            'count needs two values, the first and the last; found '//to_text(size(axis%values)))
         call visitor%require(n_steps <= most_values, 'count', 'count must be at most '//to_text(most_values)// &
            ', found '//to_text(n_steps))
         if (size(axis%values) /= 2 .or. n_steps < 2 .or. n_steps > most_values) return
         ends = real(axis%values, wide)
         axis%values = [(real((ends(1)*(n_steps - i) + ends(2)*(i - 1))/(n_steps - 1), dp), i=1, n_steps)]
      end if
   end subroutine describe_axis

   !> Checks that the target of a quantity exists, and that it does not conflict with those of earlier quantities.
   subroutine check_axis(visitor, axes, loads, contacts)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor, at the group of the last quantity
      type(sweep_axis_t), intent(in) :: axes(:) !! the quantity, and those before it
      type(load_t), intent(in) :: loads(:) !! the loads
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      character(:), allocatable :: names
      integer :: i, n, k
      logical :: is_found

      associate (axis => axes(size(axes)))
         if (axis%target /= swept_load) then
            if (visitor%deck%knows('contact', 'set')) then
               ! Checks that there are contact sets whose friction a quantity can be.
               is_found = .false.
               names = ''
               do i = 1, size(contacts)
                  names = names//', '//contacts(i)%set
                  if (.not. axis%acts_on(contacts(i)%set)) cycle
                  is_found = .true.
                  call visitor%require(.not. (axis%target == swept_friction .and. &
                     allocated(contacts(i)%friction%table)), 'friction', "the friction of contact set '"// &
                     contacts(i)%set//"' comes from a table; use friction_factor, which multiplies it")
               end do
               call visitor%require(is_found, 'contact', trim(quantity_names(axis%target))//' needs a &contact'// &
                  repeat(" with the set '"//axis%name//"'", min(1, len(axis%name)))//names_text('sets', names))
            end if
         else if (all([visitor%deck%knows('load', 'name'), visitor%deck%knows('rigid', 'name'), &
               visitor%deck%knows('preload', 'name')])) then
            names = ''
            do i = 1, size(loads)
               if (len(loads(i)%name) > 0) names = names//', '//loads(i)%name
            end do
            call visitor%require(any([(len(loads(i)%name) > 0 .and. loads(i)%name == axis%name, &
               i=1, size(loads))]), 'load', "no load has the name '"//axis%name//"'"//names_text('named loads', names))
         end if
      end associate
      ! Checks a quantity against those before it: nothing varies twice, and what is paired has as many values.
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
   end subroutine check_axis

end module amontons_sweep
