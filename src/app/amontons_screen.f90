!> What a run prints.
module amontons_screen
   use, intrinsic :: iso_fortran_env, only: output_unit
   use amontons_command_line, only: command_line_t
   implicit none (type, external)
   private

   public :: tell

contains

   !> Prints a line unless the run is quiet.
   subroutine tell(command_line, text)
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: text !! the line

      if (.not. command_line%is_quiet) write (output_unit, '(a)') text
   end subroutine tell

end module amontons_screen
