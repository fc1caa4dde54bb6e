!> What --reference prints: the groups of a deck and their keys.
module amontons_reference
   use amontons_command_line, only: argument_t
   use amontons_config, only: reference_text
   use amontons_error, only: error_t
   use amontons_messages, only: print_error
   use amontons_terminal, only: print_line, standard_output
   implicit none (type, external)
   private

   public :: print_reference

contains

   !> Prints the reference of the groups named, or of all groups where none is.
   subroutine print_reference(groups, status, error)
      type(argument_t), intent(in) :: groups(:) !! names of the groups
      integer, intent(out) :: status !! exit status
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more
      integer :: i

      status = 0
      if (size(groups) == 0) call print_group('', '', status, error)
      do i = 1, size(groups)
         call print_group(groups(i)%text, repeat(new_line('a'), merge(1, 0, i > 1)), status, error)
         if (allocated(error)) return
      end do
   end subroutine print_reference

   !> Prints the reference of one group.
   subroutine print_group(name, before, status, error)
      character(*), intent(in) :: name !! its name; empty for all groups
      character(*), intent(in) :: before !! what separates it from the group before
      integer, intent(inout) :: status !! exit status, raised where there is no such group
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more
      type(error_t), allocatable :: unknown
      character(:), allocatable :: text

      call reference_text(name, text, unknown)
      if (allocated(unknown)) then
         call print_error('amontons: '//unknown%message)
         status = max(status, unknown%kind)
      else
         call print_line(standard_output, before//text, error)
      end if
   end subroutine print_group

end module amontons_reference
