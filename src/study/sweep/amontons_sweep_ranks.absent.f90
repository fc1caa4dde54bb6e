!> A sweep over the ranks of a run in a build without MPI: there is one rank.
module amontons_sweep_ranks
   use amontons_body, only: body_t
   use amontons_rank_service, only: rank_service_t
   use amontons_study_monitor, only: study_monitor_t
   use amontons_sweep_chunk, only: chunk_t, solve_chunks, sweep_task_t
   implicit none (type, external)
   private

   public :: end_sharing, share_sweep, solve_on_ranks, sweep_service_t

   !> What other ranks would do for a sweep.
   type, extends(rank_service_t) :: sweep_service_t
   contains
      procedure :: follow => sweep_service_follow
   end type sweep_service_t

contains

   !> Shares a sweep with no one.
   subroutine share_sweep(n_sharing, task, body, n_left)
      integer, intent(out) :: n_sharing !! 1
      type(sweep_task_t), intent(inout) :: task !! not used, as all that follow
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: n_left !! number of cases to solve

      n_sharing = 1
      associate (unused => task, body => body, n_left => n_left)
      end associate
   end subroutine share_sweep

   !> Solves chunks on all threads.
   subroutine solve_on_ranks(n_sharing, task, body, monitor, chunks)
      integer, intent(in) :: n_sharing !! 1
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! consecutive chunks

      call solve_chunks(task, body, monitor, chunks)
      associate (unused => n_sharing)
      end associate
   end subroutine solve_on_ranks

   !> Ends nothing.
   subroutine end_sharing(n_sharing)
      integer, intent(in) :: n_sharing !! 1

      associate (unused => n_sharing)
      end associate
   end subroutine end_sharing

   !> Follows no order.
   subroutine sweep_service_follow(self, order)
      class(sweep_service_t), intent(inout) :: self !! not used
      integer, intent(in) :: order !! not used

      associate (unused => self, order => order)
      end associate
   end subroutine sweep_service_follow

end module amontons_sweep_ranks
