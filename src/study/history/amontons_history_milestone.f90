!> How far a history is, in numbers: what an interrupted run goes on from, and what another history can start from.
module amontons_history_milestone
   use amontons_checkpoint, only: milestone_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_history, only: history_t
   use amontons_kinds, only: dp
   use amontons_text, only: comma_separated, line_end, newline, read_reals, to_text
   use amontons_text_file, only: read_text_file
   implicit none (type, external)
   private

   public :: history_milestone_t, read_start

   !> The numbers, as a line of a checkpoint.
   type, extends(milestone_t) :: history_milestone_t
      real(dp), allocatable :: numbers(:) !! the numbers; not allocated where there are none
   contains
      procedure :: read => history_milestone_read
      procedure :: text => history_milestone_text
   end type history_milestone_t

contains

   !> Reads the numbers.
   pure subroutine history_milestone_read(self, text, ok)
      class(history_milestone_t), intent(inout) :: self !! gains the numbers
      character(*), intent(in) :: text !! the line
      logical, intent(out) :: ok !! whether it holds numbers and nothing else

      call read_reals(trim(adjustl(text)), self%numbers, ok)
   end subroutine history_milestone_read

   !> The numbers as a line.
   pure function history_milestone_text(self) result(text)
      class(history_milestone_t), intent(in) :: self !! the numbers
      character(:), allocatable :: text

      text = comma_separated(self%numbers)
   end function history_milestone_text

   !> Reads the numbers of the state that a history starts from.
   subroutine read_start(numbers, history, error)
      real(dp), allocatable, intent(out) :: numbers(:) !! the numbers
      type(history_t), intent(in) :: history !! the history, with a start
      type(error_t), allocatable, intent(out) :: error !! there is no such state
      character(:), allocatable :: text
      integer :: first
      logical :: ok

      call read_text_file(history%start, text, error)
      if (allocated(error)) return
      if (history%start_step > 0) then
         first = index(text, newline//to_text(history%start_step)//',') + 1
      else
         first = index(text(:len(text) - 1), newline, back=.true.) + 1
      end if
      ok = index(text, 'step,') == 1
      if (ok .and. history%start_step > 0 .and. first == 1) then
         call new_error(error, input_refused, history%start//': it has no state of step '// &
            to_text(history%start_step)//', only of '//steps_text(text))
         return
      end if
      if (ok) call read_reals(text(first:line_end(text, first)), numbers, ok)
      if (.not. ok) call new_error(error, input_refused, history%start//': expected states of a history, as'// &
         ' NAME.states.csv has them')
   end subroutine read_start

   !> The numbers of the steps whose states a file has; of many the first ones and the last.
   pure function steps_text(states) result(text)
      character(*), intent(in) :: states !! what the file says
      character(:), allocatable :: text
      integer, parameter :: most_named = 12
      integer, allocatable :: starts(:)
      integer :: i, n

      starts = pack([(i, i=1, len(states) - 1)], [(states(i:i) == newline, i=1, len(states) - 1)]) + 1
      n = size(starts)
      text = ''
      do i = 1, n
         if (n > most_named .and. i > most_named - 2 .and. i < n) cycle
         if (n > most_named .and. i == n) text = text//', ...'
         if (i > 1) text = text//', '
         text = text//states(starts(i):starts(i) + index(states(starts(i):)//',', ',') - 2)
      end do
   end function steps_text

end module amontons_history_milestone
