!> A sweep: the quantities that vary from case to case, and the cases that their combination makes.
!>
!> Each quantity has a list of values. A quantity that is paired goes along with the one before it, value by value; the
!> others are combined in full, the last one varying fastest. Cases count from 1.
module amontons_sweep
   use amontons_contact_set, only: contact_t
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: combination_names, key_result_names, largest_n_cases, quantity_names, sweep_axis_t, sweep_t

   !> What a sweep may vary: the factor of all loads of a name.
   integer, parameter, public :: swept_load = 1
   !> What a sweep may vary: Coulomb's coefficient, in the place of the key `friction` of contact sets.
   integer, parameter, public :: swept_friction = 2
   !> What a sweep may vary: a factor on the friction of contact sets.
   integer, parameter, public :: swept_friction_factor = 3

   !> Names of these quantities, and the keys that a deck gives their values by.
   character(15), parameter :: quantity_names(3) = [character(15) :: 'factor', 'friction', 'friction_factor']
   !> How a quantity is combined with those before it, as a deck writes it.
   character(7), parameter :: combination_names(2) = [character(7) :: 'product', 'paired']
   !> Whose key results the table of a sweep has, as a deck writes it.
   character(7), parameter :: key_result_names(2) = [character(7) :: 'contact', 'all']
   !> Most cases of a sweep.
   integer, parameter :: largest_n_cases = 1000000000

   !> A quantity and the values it takes.
   type :: sweep_axis_t
      integer :: target = swept_load !! what it is
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

contains

   !> Whether the quantity is the friction of a contact set.
   pure logical function sweep_axis_acts_on(self, set) result(acts)
      class(sweep_axis_t), intent(in) :: self !! the quantity
      character(*), intent(in) :: set !! name of the contact set

      acts = self%target /= swept_load .and. (len(self%name) == 0 .or. self%name == set)
   end function sweep_axis_acts_on

   !> What the quantity is called in tables: 'factor_side', 'friction', 'friction_factor_bottom'.
   pure function sweep_axis_label(self) result(label)
      class(sweep_axis_t), intent(in) :: self !! the quantity
      character(:), allocatable :: label

      label = trim(quantity_names(self%target))
      if (len(self%name) > 0) label = label//'_'//self%name
   end function sweep_axis_label

   !> Whether there is anything to sweep.
   pure logical function sweep_is_given(self)
      class(sweep_t), intent(in) :: self !! the sweep

      sweep_is_given = .false.
      if (allocated(self%axes)) sweep_is_given = size(self%axes) > 0
   end function sweep_is_given

   !> Gives contact sets whose coefficient varies an end of the range that it takes.
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

   !> Number of cases; of more than `largest_n_cases`, some number above it.
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

   !> Which of its values each quantity has in a case.
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

   !> The earlier case that differs from a case by one step of one quantity, the fastest that can step back; 0 for the
   !> first case, which has none.
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

end module amontons_sweep
