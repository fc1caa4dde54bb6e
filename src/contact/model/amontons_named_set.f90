!> Names of forces: contact sets, supports and ties with the same name, whose forces on the body are reported together.
module amontons_named_set
   use amontons_constraints, only: support_t
   use amontons_contact_set, only: contact_t, tie_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: name_forces, named_forces_t, of_contact, of_support, of_tie

   !> A kind of force by name: of contact sets.
   integer, parameter :: of_contact = 1
   !> A kind of force by name: of supports and foundations.
   integer, parameter :: of_support = 2
   !> A kind of force by name: of ties.
   integer, parameter :: of_tie = 3

   !> Contact sets, supports or ties with the same name, whose forces are reported together.
   type :: named_forces_t
      integer :: kind = 0 !! their kind
      character(64) :: name = '' !! their name
      integer, allocatable :: member(:) !! their numbers
   end type named_forces_t

contains

   !> Lists the contact sets, supports and ties whose forces on the body are reported, by name.
   pure subroutine name_forces(list, supports, contacts, ties, error)
      type(named_forces_t), allocatable, intent(out) :: list(:) !! the named forces
      type(support_t), intent(in) :: supports(:) !! the supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(tie_t), intent(in) :: ties(:) !! the bonded sets
      type(error_t), allocatable, intent(out) :: error !! a name is too long
      integer :: i

      allocate (list(0))
      do i = 1, size(supports)
         if (.not. supports(i)%is_jump) call add_name(list, of_support, i, supports(i)%set, 'point_'//to_text(i), &
            supports(i)%name, supports(i)%origin, error)
      end do
      do i = 1, size(contacts)
         call add_name(list, of_contact, i, contacts(i)%set, '', contacts(i)%name, contacts(i)%origin, error)
      end do
      do i = 1, size(ties)
         call add_name(list, of_tie, i, ties(i)%set, '', ties(i)%name, ties(i)%origin, error)
      end do
   end subroutine name_forces

   !> Adds a contact set, support or tie to those of its kind and name.
   pure subroutine add_name(list, kind, number, set, other, name, origin, error)
      type(named_forces_t), allocatable, intent(inout) :: list(:) !! the named forces so far
      integer, intent(in) :: kind !! the addend
      integer, intent(in) :: number !! its number
      character(*), intent(in) :: set !! name of its set; may be empty
      character(*), intent(in) :: other !! its name if it has neither name nor set
      character(:), allocatable, intent(in) :: name !! its name, if it has one
      character(*), intent(in) :: origin !! where it was specified, as messages begin
      type(error_t), allocatable, intent(inout) :: error !! its name is too long; an earlier fault stays
      type(named_forces_t) :: named
      character(:), allocatable :: own
      integer :: i

      own = set
      if (allocated(name)) then
         if (len(name) > 0) own = name
      end if
      if (len(own) == 0) own = other
      do i = 1, size(list)
         if (list(i)%kind == kind .and. list(i)%name == own) exit
      end do
      if (len(own) > len(list%name) .and. .not. allocated(error)) call new_error(error, input_refused, origin// &
         "'"//own//"' is too long for the names of results; give a name of at most "//to_text(len(list%name))// &
         ' characters')
      named%kind = kind
      named%name = own
      allocate (named%member(0))
      if (i > size(list)) list = [list, named]
      list(i)%member = [list(i)%member, number]
   end subroutine add_name

end module amontons_named_set
