!> What --reference prints: the groups of a deck and their keys.
module amontons_reference
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use amontons_command_line, only: argument_t
   use amontons_deck_reference, only: reference_text
   use amontons_error, only: error_t
   implicit none (type, external)
   private

   public :: tell_reference

contains

   !> Prints the reference of the groups named, or of all groups where none is.
   subroutine tell_reference(groups, status)
      type(argument_t), intent(in) :: groups(:) !! names of the groups
      integer, intent(out) :: status !! exit status
      integer :: i

      status = 0
      if (size(groups) == 0) call tell_group('', status)
      do i = 1, size(groups)
         if (i > 1) write (output_unit, '()')
         call tell_group(groups(i)%text, status)
      end do
   end subroutine tell_reference

   !> Prints the reference of one group.
   subroutine tell_group(name, status)
      character(*), intent(in) :: name !! its name; empty for all groups
      integer, intent(inout) :: status !! exit status, raised where there is no such group
      character(:), allocatable :: text
      type(error_t), allocatable :: error

      call reference_text(name, text, error)
      if (allocated(error)) then
         write (error_unit, '(a)') 'amontons: '//error%message
         status = max(status, error%kind)
      else
         write (output_unit, '(a)') text
      end if
   end subroutine tell_group

end module amontons_reference
