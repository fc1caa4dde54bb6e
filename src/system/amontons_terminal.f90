!> The times of the phases of a run, and the exchange of the program with the shell that started it: standard streams,
!> signals, and the status line on a terminal, or lines in a log.
!>
!> A program opens and closes the status line. Meanwhile it is drawn each second, after the first one; `print_line`
!> removes it until new work is reported. A log gets a line after 1, 2, 4 ... 64 seconds and then each minute. If no
!> program has opened it, nothing is shown.
module amontons_terminal
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_system, only: action, check_code, wall_seconds
   implicit none (type, external)
   private

   public :: close_status_line, hold_interrupts, is_interrupted, new_timings, note_work, open_status_line, &
      phase_assemble, phase_condense, phase_factorize, phase_names, phase_read, phase_recover, phase_solve, &
      phase_write, prepare_process, print_line, release_interrupts, standard_error, standard_output, timings_t

   !> Streams of `print_line`.
   integer, parameter :: standard_output = 1, standard_error = 2

   !> Makes a closed pipe and a full disk errors of a write instead of the end of the process, and removes temporary
   !> files when a signal ends it. To be called first by the program; the library does not handle signals.
   procedure(action), bind(c, name='amontons_prepare_process') :: prepare_process
   !> Makes the first SIGINT or SIGTERM only set `is_interrupted`; the second ends the process.
   procedure(action), bind(c, name='amontons_hold_interrupts') :: hold_interrupts
   !> Restores the handling of signals from before `hold_interrupts`.
   procedure(action), bind(c, name='amontons_release_interrupts') :: release_interrupts
   !> Removes the status line, if there is one, and closes it.
   procedure(action), bind(c, name='amontons_close_line') :: close_status_line

   ! allow(assumed-size): C takes an address without a shape
   interface
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
   end interface

   !> The phase of reading the deck and making the mesh, supports and contact zone.
   integer, parameter :: phase_read = 1
   !> The phase of element stiffness and assembly.
   integer, parameter :: phase_assemble = 2
   !> The phase of ordering and Cholesky factorization.
   integer, parameter :: phase_factorize = 3
   !> The phase of condensed stiffness and condensed load.
   integer, parameter :: phase_condense = 4
   !> The phase of the contact method.
   integer, parameter :: phase_solve = 5
   !> The phase of recovering the displacements of all nodes, and the certificate.
   integer, parameter :: phase_recover = 6
   !> The phase of writing the result files.
   integer, parameter :: phase_write = 7
   !> Names of the phases.
   character(9), parameter :: phase_names(*) = [character(9) :: 'read', 'assemble', 'factorize', 'condense', 'solve', &
      'recover', 'write']

   !> Wall-clock time spent in each phase.
   type :: timings_t
      real(dp) :: seconds(size(phase_names)) = 0.0_dp !! time of each phase [s]
      real(dp), private :: last = 0.0_dp !! time up to which the phases are measured [s]
      integer, private :: phase = phase_read !! the phase under way
   contains
      procedure :: begin => timings_begin
   end type timings_t

contains

   !> Prints lines at once, in place of the status line if there is one. The buffers of the run-time library are not
   !> used, since they lose lines without an error on a full disk.
   subroutine print_line(stream, text, error)
      integer, intent(in) :: stream !! `standard_output` or `standard_error`
      character(*), intent(in) :: text !! the lines, without the last one's end
      type(error_t), allocatable, intent(out) :: error !! not everything could be written

      call check_code(c_print(int(stream, c_int), text//new_line('a'), len(text, c_long) + 1_c_long), &
         trim(merge('standard output', 'standard error ', stream == standard_output))//': cannot write', error)
   end subroutine print_line

   !> Whether a signal has asked the program to stop since `hold_interrupts`. May be called from any thread.
   logical function is_interrupted()
      is_interrupted = c_interrupt() /= 0
   end function is_interrupted

   !> Opens the status line of a case, if standard error is a terminal or lines of a log are asked for.
   subroutine open_status_line(name, has_log)
      character(*), intent(in) :: name !! name of the case; the line begins with it
      logical, intent(in) :: has_log !! whether standard error gets lines where it is not a terminal

      call c_open_line(name//c_null_char, merge(1_c_int, 0_c_int, has_log))
   end subroutine open_status_line

   !> Notes what the program is doing, for the line on the terminal, if there is one. Any thread may call it.
   subroutine note_work(work, is_timed)
      character(*), intent(in) :: work !! the present work
      logical, intent(in) :: is_timed !! whether the seconds since the line was opened follow it

      call c_note_work(work//c_null_char, merge(1_c_int, 0_c_int, is_timed))
   end subroutine note_work

   !> Starts the clock in the phase of reading.
   subroutine new_timings(timings)
      type(timings_t), intent(out) :: timings !! the clock

      timings%last = wall_seconds()
      call note_work(trim(phase_names(timings%phase)), is_timed=.true.)
   end subroutine new_timings

   !> Adds the time since the last call to the present phase, and begins another one or continues the same.
   subroutine timings_begin(self, phase)
      class(timings_t), intent(inout) :: self !! the clock
      integer, intent(in) :: phase !! the phase that begins
      real(dp) :: now

      now = wall_seconds()
      self%seconds(self%phase) = self%seconds(self%phase) + now - self%last
      self%last = now
      self%phase = phase
      call note_work(trim(phase_names(phase)), is_timed=.true.)
   end subroutine timings_begin

end module amontons_terminal
