!> Who sits before the program: whether standard error is a terminal, and whether somebody wants the program to stop.
module amontons_terminal
   use, intrinsic :: iso_c_binding, only: c_int
   implicit none (type, external)
   private

   public :: has_terminal, hold_interrupts, is_interrupted, release_interrupts

   interface
      function c_error_is_terminal() bind(c, name='amontons_error_is_terminal') result(answer)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: answer
      end function c_error_is_terminal

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
   end interface

contains

   !> Whether standard error is shown on a terminal.
   logical function has_terminal()
      has_terminal = c_error_is_terminal() /= 0
   end function has_terminal

   !> Whether a signal has asked the program to stop since `hold_interrupts`. Any thread may ask.
   logical function is_interrupted()
      is_interrupted = c_interrupt() /= 0
   end function is_interrupted

end module amontons_terminal
