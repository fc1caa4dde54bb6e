!> A sweep over the ranks of a run in a build without MPI: there is one rank.
module amontons_sweep_ranks
   use amontons_body, only: body_t
   use amontons_study_monitor, only: study_monitor_t
   use amontons_sweep_chunk, only: chunk_t, solve_chunks, sweep_task_t
   implicit none (type, external)
   private

   public :: end_sharing, serve, share_sweep, solve_on_ranks

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

   !> Serves no one.
   subroutine serve()
   end subroutine serve

end module amontons_sweep_ranks
