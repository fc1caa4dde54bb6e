!> What a run prints: results told on standard output, what went wrong on standard error.
module amontons_screen
   use amontons_command_line, only: command_line_t
   use amontons_error, only: error_t
   use amontons_terminal, only: print_line, standard_error, standard_output
   use amontons_text, only: newline
   use amontons_warning_list, only: warning_list_t
   implicit none (type, external)
   private

   public :: complain, tell, tell_case

contains

   !> Prints a line unless the run is quiet.
   subroutine tell(command_line, text, error)
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: text !! the line
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more

      if (.not. command_line%is_quiet) call print_line(standard_output, text, error)
   end subroutine tell

   !> Prints the line of a case and its warnings, a line each, unless the run is quiet.
   subroutine tell_case(command_line, text, name, warnings, error)
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: text !! the line
      character(*), intent(in) :: name !! name of the case
      type(warning_list_t), intent(in) :: warnings !! what is doubtful about it
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more
      character(:), allocatable :: lines
      integer :: i

      lines = text
      do i = 1, warnings%n()
         lines = lines//newline//name//': warning: '//warnings%item(i)
      end do
      call tell(command_line, lines, error)
   end subroutine tell_case

   !> Prints what went wrong, one line or several.
   subroutine complain(text)
      character(*), intent(in) :: text !! the lines
      type(error_t), allocatable :: unheard

      ! Where nobody listens on standard error, the exit status has to say it.
      call print_line(standard_error, text, unheard)
   end subroutine complain

end module amontons_screen
