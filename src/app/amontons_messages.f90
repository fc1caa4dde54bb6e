!> What a run prints: results on standard output, what went wrong on standard error.
module amontons_messages
   use amontons_command_line, only: command_line_t
   use amontons_error, only: error_t
   use amontons_outcome, only: outcome_t
   use amontons_terminal, only: print_line, standard_error, standard_output
   use amontons_text, only: newline
   implicit none (type, external)
   private

   public :: print_error, print_info, print_outcome

contains

   !> Prints a line unless the run is quiet.
   subroutine print_info(command_line, text, error)
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: text !! the line
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more

      if (.not. command_line%asks('--quiet')) call print_line(standard_output, text, error)
   end subroutine print_info

   !> Prints the line of a deck and its warnings, a line each, unless the run is quiet; and what went wrong.
   subroutine print_outcome(command_line, outcome, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(outcome_t), intent(in) :: outcome !! what became of the deck
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more
      character(:), allocatable :: lines
      integer :: i

      if (len(outcome%text) > 0) then
         lines = outcome%text
         do i = 1, outcome%warnings%n()
            lines = lines//newline//outcome%name//': warning: '//outcome%warnings%item(i)
         end do
         call print_info(command_line, lines, error)
         if (allocated(error)) error%message = outcome%deck//': '//error%message
      end if
      if (len(outcome%message) > 0) call print_error(outcome%message)
   end subroutine print_outcome

   !> Prints what went wrong, one line or several.
   subroutine print_error(text)
      character(*), intent(in) :: text !! the lines
      type(error_t), allocatable :: unheard

      ! Where nobody listens on standard error, the exit status has to say it.
      call print_line(standard_error, text, unheard)
   end subroutine print_error

end module amontons_messages
