!> Where the time of a case goes, phase by phase.
module amontons_timings
   use amontons_kinds, only: dp
   use amontons_system, only: wall_seconds
   use amontons_terminal, only: note_work
   implicit none (type, external)
   private

   public :: new_timings, phase_assemble, phase_condense, phase_factorize, phase_names, phase_read, phase_recover, &
      phase_solve, phase_write, timings_t

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
      real(dp), private :: last = 0.0_dp !! until when the time is booked [s]
      integer, private :: phase = phase_read !! the phase under way
   contains
      procedure :: begin => timings_begin
   end type timings_t

contains

   !> Starts the clock in the phase of reading.
   subroutine new_timings(timings)
      type(timings_t), intent(out) :: timings !! the clock

      timings%last = wall_seconds()
      call note_work(trim(phase_names(timings%phase)), is_timed=.true.)
   end subroutine new_timings

   !> Books the time since the last call on the phase under way, and begins another or goes on with the same.
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

end module amontons_timings
