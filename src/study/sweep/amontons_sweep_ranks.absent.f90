!> A sweep over the ranks of a run in a build without MPI: there is one rank.
module amontons_sweep_ranks
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_solve_case, only: cache_t
   use amontons_study, only: study_monitor_t
   use amontons_sweep_chunk, only: chunk_t, condense_task, solve_chunks, sweep_task_t
   implicit none (type, external)
   private

   public :: end_sharing, prepare_on_ranks, serve, solve_on_ranks

contains

   !> Condenses the loads of a sweep, which no other rank shares.
   subroutine prepare_on_ranks(n_sharing, task, cache, config, error)
      integer, intent(out) :: n_sharing !! 1
      type(sweep_task_t), intent(inout) :: task !! the sweep; its loads are condensed
      type(cache_t), intent(inout) :: cache !! the body, condensed
      type(config_t), intent(in) :: config !! not used
      type(error_t), allocatable, intent(out) :: error !! S is not positive definite, or memory ran out

      n_sharing = 1
      call condense_task(task, cache%body, cache%problem, error)
      associate (unused => config)
      end associate
   end subroutine prepare_on_ranks

   !> Solves chunks on all threads.
   subroutine solve_on_ranks(n_sharing, task, cache, monitor, chunks)
      integer, intent(in) :: n_sharing !! 1
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(cache_t), intent(in) :: cache !! the body
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! consecutive chunks

      call solve_chunks(task, cache%body, cache%problem, monitor, chunks)
      associate (unused => n_sharing)
      end associate
   end subroutine solve_on_ranks

   !> Ends the sharing of a sweep among ranks; has no effect in a build without MPI.
   subroutine end_sharing(n_sharing)
      integer, intent(in) :: n_sharing !! 1

      associate (unused => n_sharing)
      end associate
   end subroutine end_sharing

   !> Lets a rank work for rank 0; has no effect in a build without MPI.
   subroutine serve()
   end subroutine serve

end module amontons_sweep_ranks
