!> The monitor of a study of many cases: it learns how far the study is, and may stop it.
module amontons_study_monitor
   implicit none (type, external)
   private

   public :: study_monitor_t

   !> A monitor that says nothing and never stops a study; programs extend it.
   type :: study_monitor_t
   contains
      procedure :: is_stopped => study_monitor_is_stopped
      procedure :: report => study_monitor_report
      procedure :: report_fields => study_monitor_report_fields
   end type study_monitor_t

contains

   !> Whether the study is to stop. Asked from any thread, at any time.
   logical function study_monitor_is_stopped(self) result(is_stopped)
      class(study_monitor_t), intent(in) :: self !! the monitor

      is_stopped = .false.
      associate (unused => self)
      end associate
   end function study_monitor_is_stopped

   !> Reports how far the study is: before the first batch of cases and after each.
   subroutine study_monitor_report(self, n_done, n_cases, things)
      class(study_monitor_t), intent(inout) :: self !! the monitor
      integer, intent(in) :: n_done !! cases done, those of an earlier run included
      integer, intent(in) :: n_cases !! all cases
      character(*), intent(in) :: things !! what they are: 'cases' or 'steps'

      associate (unused => self, done => n_done, all => n_cases, words => things)
      end associate
   end subroutine study_monitor_report

   !> Reports for how many cases the fields are written: after each of their batches.
   subroutine study_monitor_report_fields(self, n_done, n_fields)
      class(study_monitor_t), intent(inout) :: self !! the monitor
      integer, intent(in) :: n_done !! cases whose fields are written
      integer, intent(in) :: n_fields !! all cases whose fields are asked for

      associate (unused => self, done => n_done, all => n_fields)
      end associate
   end subroutine study_monitor_report_fields

end module amontons_study_monitor
