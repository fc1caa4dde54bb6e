!> What a body consists of and what acts on it as a line of text, for listings: the keys of its group in a deck whose
!> values are not the defaults, also where it comes from a mesh file or from code.
module amontons_group_text
   use amontons_config_groups, only: describe_contact, describe_material, describe_support
   use amontons_config_loads, only: describe_load
   use amontons_constraints, only: support_t
   use amontons_contact_set, only: contact_t
   use amontons_deck_visitor, only: deck_writer_t, key_t
   use amontons_loads, only: load_t
   use amontons_material, only: material_t
   use amontons_text, only: replaced, unit_of
   implicit none (type, external)
   private

   public :: group_text

   !> A visitor that lists keys with their values and units, a comma and a blank before each, except for usual ones.
   type, extends(deck_writer_t) :: lister_t
      character(:), allocatable :: units !! names of the units of the case
      character(:), allocatable :: usual !! what is not to be listed, in the same form
   contains
      procedure :: write_key => lister_write_key
   end type lister_t

contains

   !> The keys of a material, support, contact set or load that are no defaults.
   function group_text(thing, n_dim, units) result(text)
      class(*), intent(in) :: thing !! a `material_t`, `support_t`, `contact_t` or `load_t`
      integer, intent(in) :: n_dim !! number of dimensions of the body
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      type(lister_t) :: lister
      type(material_t) :: material(2)
      type(support_t) :: support(2)
      type(contact_t) :: contact(2)
      type(load_t) :: load(2)
      integer :: i

      lister%n_dim = n_dim
      lister%units = units
      lister%written = ''
      do i = 1, 2
         ! First the defaults.
         lister%usual = lister%written//','
         lister%written = ''
         select type (thing)
         type is (material_t)
            material(2) = thing
            call describe_material(lister, material(i))
         type is (support_t)
            support(2) = thing
            call describe_support(lister, support(i))
         type is (contact_t)
            contact(2) = thing
            call describe_contact(lister, contact(i))
         type is (load_t)
            load(2) = thing
            call describe_load(lister, load(i))
         end select
      end do
      text = lister%written(min(3, len(lister%written) + 1):)
   end function group_text

   !> Lists a key.
   subroutine lister_write_key(self, key, kind, value, is_given)
      class(lister_t), intent(inout) :: self !! the lister
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: kind !! not used: kind of its values
      character(*), intent(in) :: value !! its value as a deck has it
      logical, intent(in) :: is_given !! whether it has this value
      character(:), allocatable :: item

      if (.not. is_given) return
      item = ', '//trim(key%name)//' '//value
      ! Units of length and force can be named.
      if (len(self%units) > 0 .and. verify(trim(key%unit), 'LF/²³') == 0) item = trim(item//' '//unit_of(self%units, &
         replaced(replaced(trim(key%unit), '²', '^2'), '³', '^3')))
      if (index(self%usual, item//',') == 0 .and. key%default /= '`'//value//'`') self%written = &
         self%written//item
      associate (unused => kind)
      end associate
   end subroutine lister_write_key

end module amontons_group_text
