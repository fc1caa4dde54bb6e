!> What the program and the shell that started it tell each other: standard streams, signals, and the line on a terminal
!> that shows what a long run is doing, or its lines in a log.
!>
!> A program opens and closes the line. Between the two it is drawn anew each second, from the end of the first one on;
!> `print_line` removes it, until more work is noted. A log gets a line of
!> its own after 1, 2, 4 ... 64 seconds and each minute from then on. Where no program has opened it, nothing is shown.
module amontons_terminal
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_system, only: error_text
   implicit none (type, external)
   private

   public :: close_status_line, hold_interrupts, is_interrupted, note_work, open_status_line, prepare_process, &
      print_line, release_interrupts, standard_error, standard_output

   !> What `print_line` writes to.
   integer, parameter :: standard_output = 1, standard_error = 2

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      !> Has a closed pipe and a full disk be errors of a write rather than the end of the process, and signals that
      !> ask for the end leave no temporary file. For the program to call first; the library leaves signals alone.
      subroutine prepare_process() bind(c, name='amontons_prepare_process')
         implicit none (type, external)
      end subroutine prepare_process

      function c_print(file, text, n_bytes) bind(c, name='amontons_print') result(code)
         import :: c_char, c_int, c_long
         implicit none (type, external)
         integer(c_int), value :: file
         character(c_char), intent(in) :: text(*)
         integer(c_long), value :: n_bytes
         integer(c_int) :: code
      end function c_print

      function c_interrupt() bind(c, name='amontons_interrupt') result(signal)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: signal
      end function c_interrupt

      !> From now on the first SIGINT or SIGTERM only makes `is_interrupted` true; the second ends the process.
      subroutine hold_interrupts() bind(c, name='amontons_hold_interrupts')
         implicit none (type, external)
      end subroutine hold_interrupts

      !> Lets signals do again what they did before `hold_interrupts`.
      subroutine release_interrupts() bind(c, name='amontons_release_interrupts')
         implicit none (type, external)
      end subroutine release_interrupts

      subroutine c_open_line(name, has_log) bind(c, name='amontons_open_line')
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: name(*)
         integer(c_int), value :: has_log
      end subroutine c_open_line

      subroutine c_note_work(work, is_timed) bind(c, name='amontons_note_work')
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: work(*)
         integer(c_int), value :: is_timed
      end subroutine c_note_work

      !> Closes the line, if there is one, and removes it.
      subroutine close_status_line() bind(c, name='amontons_close_line')
         implicit none (type, external)
      end subroutine close_status_line
   end interface

contains

   !> Prints lines at once, in the place of the status line if there is one, and past the buffers of the run-time
   !> library, which loses them without a word on a full disk.
   subroutine print_line(stream, text, error)
      integer, intent(in) :: stream !! `standard_output` or `standard_error`
      character(*), intent(in) :: text !! the lines, without the last one's end
      type(error_t), allocatable, intent(out) :: error !! not everything could be written
      integer :: code

      code = int(c_print(int(stream, c_int), text//new_line('a'), len(text, c_long) + 1_c_long))
      if (code /= 0) call new_error(error, system_failure, trim(merge('standard output', 'standard error ', &
         stream == standard_output))//': cannot write: '//error_text(code))
   end subroutine print_line

   !> Whether a signal has asked the program to stop since `hold_interrupts`. Any thread may ask.
   logical function is_interrupted()
      is_interrupted = c_interrupt() /= 0
   end function is_interrupted

   !> Opens the line of a case, if standard error is a terminal or a log is to have lines.
   subroutine open_status_line(name, has_log)
      character(*), intent(in) :: name !! name of the case; the line begins with it
      logical, intent(in) :: has_log !! whether standard error gets lines where it is not a terminal

      call c_open_line(name//c_null_char, merge(1_c_int, 0_c_int, has_log))
   end subroutine open_status_line

   !> Notes what is done from now on, for the line if there is one. Any thread may note.
   subroutine note_work(work, is_timed)
      character(*), intent(in) :: work !! what is done
      logical, intent(in) :: is_timed !! whether the seconds since the line was opened follow it

      call c_note_work(work//c_null_char, merge(1_c_int, 0_c_int, is_timed))
   end subroutine note_work

end module amontons_terminal
