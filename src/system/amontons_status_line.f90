!> The line on a terminal that shows what a long run is doing, or its lines in a log.
!>
!> A program opens and closes it. Between the two it is drawn anew each second, from the end of the first one on;
!> `print_line` removes it, until more work is noted. A log gets a line of
!> its own after 1, 2, 4 ... 64 seconds and each minute from then on. Where no program has opened it, nothing is shown.
module amontons_status_line
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   implicit none (type, external)
   private

   public :: close_status_line, note_work, open_status_line

   ! allow(assumed-size): C takes an address and knows no shape
   interface
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

end module amontons_status_line
