!> Messages of a run: results on standard output, errors on standard error, and the progress of a sweep or history on
!> the status line. A signal may interrupt the run.
module amontons_messages
   use amontons_command_line, only: command_line_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_study, only: outcome_t, study_monitor_t
   use amontons_system, only: wall_seconds
   use amontons_terminal, only: hold_interrupts, is_interrupted, note_work, print_line, release_interrupts, &
      standard_error, standard_output
   use amontons_text, only: newline, to_text
   implicit none (type, external)
   private

   public :: print_error, print_info, print_outcome, progress_t

   !> The monitor of a study that shows its progress. From the first report until `finish`, SIGINT and SIGTERM stop the
   !> study after the current case or step.
   type, extends(study_monitor_t) :: progress_t
      private
      character(6) :: things = '' !! noun of the last report; blank before the first one
      real(dp) :: start = 0.0_dp !! when the first report about them came [s]
      integer :: n_before = 0 !! number of them done then
   contains
      procedure, public :: finish => progress_finish
      procedure, public :: is_stopped => progress_is_stopped
      procedure, public :: report => progress_report
   end type progress_t

contains

   !> Prints a line unless the run is quiet.
   subroutine print_info(command_line, text, error)
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: text !! the line
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more

      if (.not. command_line%asks('--quiet')) call print_line(standard_output, text, error)
   end subroutine print_info

   !> Prints the result line of a deck and its warnings, one line each, unless the run is quiet; and then the error, if
   !> any.
   subroutine print_outcome(command_line, outcome, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(outcome_t), intent(in) :: outcome !! the outcome of the deck
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

   !> Prints an error message of one or several lines on standard error.
   subroutine print_error(text)
      character(*), intent(in) :: text !! the lines
      type(error_t), allocatable :: unheard

      ! Where nobody listens on standard error, the exit status has to say it.
      call print_line(standard_error, text, unheard)
   end subroutine print_error

   !> Whether a signal has asked the program to stop.
   logical function progress_is_stopped(self) result(is_stopped)
      class(progress_t), intent(in) :: self !! the watch

      is_stopped = is_interrupted()
      associate (unused => self)
      end associate
   end function progress_is_stopped

   !> Shows the progress of the study, its speed and the time left: '128 of 861 cases, 10500 per second, 0:00:12 left'.
   subroutine progress_report(self, n_done, n_cases, things)
      class(progress_t), intent(inout) :: self !! the watch
      integer, intent(in) :: n_done !! cases done
      integer, intent(in) :: n_cases !! all cases
      character(*), intent(in) :: things !! noun for the items: 'cases', 'steps' or 'fields'
      real(dp), parameter :: longest = 3.6e8_dp, hundred = 100.0_dp
      character(:), allocatable :: text
      character(8) :: minutes
      real(dp) :: rate, seconds
      integer :: left

      if (self%things == '') call hold_interrupts()
      if (self%things /= things) then
         self%things = things
         self%n_before = n_done
         self%start = wall_seconds()
      end if
      text = to_text(n_done)//' of '//to_text(n_cases)//' '//things
      seconds = wall_seconds() - self%start
      if (n_done > self%n_before .and. seconds > 0.0_dp) then
         rate = (n_done - self%n_before)/seconds
         left = nint(min(longest, (n_cases - n_done)/rate))
         write (minutes, '(i2.2, ":", i2.2)') mod(left/60, 60), mod(left, 60)
         if (rate >= hundred) then
            text = text//', '//to_text(nint(rate))
         else
            text = text//', '//to_text(real(nint(rate*hundred), dp)/hundred)
         end if
         text = text//' per second, '//to_text(left/3600)//':'//trim(minutes)//' left'
      end if
      call note_work(text, is_timed=.false.)
   end subroutine progress_report

   !> Stops watching for signals.
   subroutine progress_finish(self)
      class(progress_t), intent(inout) :: self !! the watch

      if (self%things /= '') call release_interrupts()
   end subroutine progress_finish

end module amontons_messages
