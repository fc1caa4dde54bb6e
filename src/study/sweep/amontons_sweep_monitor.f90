!> Who watches a sweep: told how far it is, asked whether it is to stop.
module amontons_sweep_monitor
   implicit none (type, external)
   private

   public :: sweep_monitor_t

   !> A monitor that says nothing and never stops a sweep; programs extend it.
   type :: sweep_monitor_t
   contains
      procedure :: is_stopped => sweep_monitor_is_stopped
      procedure :: report => sweep_monitor_report
      procedure :: report_fields => sweep_monitor_report_fields
   end type sweep_monitor_t

contains

   !> Whether the sweep is to stop. Asked from any thread, at any time.
   logical function sweep_monitor_is_stopped(self) result(is_stopped)
      class(sweep_monitor_t), intent(in) :: self !! the monitor

      is_stopped = .false.
      associate (unused => self)
      end associate
   end function sweep_monitor_is_stopped

   !> Tells how far the sweep is: before the first batch of cases and after each.
   subroutine sweep_monitor_report(self, n_done, n_cases)
      class(sweep_monitor_t), intent(inout) :: self !! the monitor
      integer, intent(in) :: n_done !! cases done, those of an earlier run included
      integer, intent(in) :: n_cases !! all cases

      associate (unused => self, done => n_done, all => n_cases)
      end associate
   end subroutine sweep_monitor_report

   !> Tells of how many cases the fields are written: after each of their batches.
   subroutine sweep_monitor_report_fields(self, n_done, n_fields)
      class(sweep_monitor_t), intent(inout) :: self !! the monitor
      integer, intent(in) :: n_done !! cases whose fields are written
      integer, intent(in) :: n_fields !! all cases whose fields are asked for

      associate (unused => self, done => n_done, all => n_fields)
      end associate
   end subroutine sweep_monitor_report_fields

end module amontons_sweep_monitor
