!> A sweep over the ranks of a run: each solves chunks of its cases, and rank 0 writes their rows.
!>
!> Of the chunks of a batch each rank has those of its number, counted round. A chunk begins at rest wherever it is
!> solved, and all ranks have the same condensed stiffness: the rows are those that one rank would find.
module amontons_sweep_ranks
   use amontons_body, only: body_t
   use amontons_distributed, only: all_ranks, check_room, first_free_order, follow_order, give_order, line_t, n_ranks, &
      next_order, order_end, rank, rank_work_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_study_monitor, only: study_monitor_t
   use amontons_sweep_chunk, only: chunk_length, chunk_t, new_chunk, solve_chunks, sweep_task_t
   use amontons_sweep_passing, only: pass_chunk, receive_sweep, send_sweep
   use amontons_system, only: return_memory
   use amontons_threads, only: n_threads
   implicit none (type, external)
   private

   public :: end_sharing, serve, share_sweep, solve_on_ranks

   !> Orders of rank 0.
   integer, parameter :: order_take = first_free_order, order_solve = order_take + 1, &
      order_gather = order_solve + 1, order_drop = order_gather + 1

   !> What another rank has of a sweep.
   type :: share_t
      type(sweep_task_t), allocatable :: task !! the sweep
      type(body_t), allocatable :: body !! what its cases need of the body
      type(chunk_t), allocatable :: chunks(:) !! the chunks of the last batch
   end type share_t

contains

   !> Gives a sweep to the other ranks, if that is worth it and they have room for it. The whole body, for its
   !> displacements and stresses or as a band matrix, is on rank 0 alone, and so are the surfaces of pairs.
   subroutine share_sweep(n_sharing, task, body, n_left)
      integer, intent(out) :: n_sharing !! number of ranks that share the sweep; 1 if the others do not
      type(sweep_task_t), intent(inout) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: n_left !! number of cases to solve
      type(error_t), allocatable :: error

      n_sharing = 1
      if (n_ranks == 1 .or. n_left <= chunk_length .or. task%sweep%has_body_results .or. &
         allocated(task%model%problem%band) .or. any(body%zone%pairs%is_set())) return
      call give_order(order_take)
      call check_matrices(task%model%problem%n_points, error)
      if (allocated(error)) return
      n_sharing = n_ranks
      call send_sweep(task, body)
   end subroutine share_sweep

   !> Checks on all ranks that their machines have room for the condensed stiffness and its inverse, once and for each
   !> thread, and as much again for a method.
   subroutine check_matrices(n_points, error)
      integer, intent(in) :: n_points !! number of contact points; of rank 0
      type(error_t), allocatable, intent(out) :: error !! there is no room on some rank
      type(line_t) :: line
      integer :: n

      line = line_t(all_ranks, rank == 0)
      n = n_points
      call line%pass(n)
      ! Rank 0 solves the cases in any case.
      if (rank == 0) n = 0
      call check_room('the condensed stiffness', 8.0e-6_dp*(2.0_dp*n)**2*(2 + 4*n_threads()), error)
   end subroutine check_matrices

   !> Solves chunks on all threads of all ranks that share the sweep. Of rank 0's own, those are done that were begun
   !> before the monitor stopped the sweep.
   subroutine solve_on_ranks(n_sharing, task, body, monitor, chunks)
      integer, intent(in) :: n_sharing !! number of ranks that share the sweep
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! consecutive chunks
      type(line_t) :: line
      integer, allocatable :: batch(:)
      integer :: i, k

      if (n_sharing == 1) then
         call solve_chunks(task, body, monitor, chunks)
         return
      end if
      call give_order(order_solve)
      batch = [chunks%first, chunks(size(chunks))%last]
      line = line_t(all_ranks, .true.)
      call line%pass(batch)
      call solve_chunks(task, body, monitor, chunks(1::n_sharing))
      call give_order(order_gather)
      do i = 1, n_sharing - 1
         do k = i + 1, size(chunks), n_sharing
            call pass_chunk(line_t(i, .false.), chunks(k))
         end do
      end do
   end subroutine solve_on_ranks

   !> Has the other ranks forget the sweep.
   subroutine end_sharing(n_sharing)
      integer, intent(in) :: n_sharing !! number of ranks that share it

      if (n_sharing > 1) call give_order(order_drop)
   end subroutine end_sharing

   !> Follows the orders of rank 0 until the last one, those of condensers, too; for the other ranks.
   subroutine serve()
      type(rank_work_t), allocatable :: work
      type(share_t) :: share
      integer :: order

      do
         order = next_order()
         if (order == order_end) exit
         if (order < first_free_order) then
            call follow_order(work, order)
         else
            call follow_sweep_order(share, order)
         end if
      end do
   end subroutine serve

   !> Follows an order of rank 0 for its sweep.
   subroutine follow_sweep_order(share, order)
      type(share_t), intent(inout) :: share !! what this rank has of the sweep
      integer, intent(in) :: order !! the order
      type(error_t), allocatable :: error
      integer :: i

      select case (order)
      case (order_take)
         call check_matrices(0, error)
         if (allocated(error)) return
         allocate (share%task, share%body)
         call receive_sweep(share%task, share%body)
      case (order_solve)
         call solve_share(share)
      case (order_gather)
         do i = 1, size(share%chunks)
            call pass_chunk(line_t(0, .true.), share%chunks(i))
         end do
      case default
         deallocate (share%task, share%body)
         if (allocated(share%chunks)) deallocate (share%chunks)
         call return_memory()
      end select
   end subroutine follow_sweep_order

   !> Solves this rank's share of a batch.
   subroutine solve_share(share)
      type(share_t), intent(inout) :: share !! what this rank has of the sweep; gains the chunks
      type(study_monitor_t) :: monitor
      type(line_t) :: line
      integer, allocatable :: batch(:)
      integer :: i

      line = line_t(all_ranks, .false.)
      call line%pass(batch)
      associate (first => batch(:size(batch) - 1), last => batch(size(batch)))
         if (allocated(share%chunks)) deallocate (share%chunks)
         allocate (share%chunks((size(first) - rank - 1 + n_ranks)/n_ranks))
         do i = 1, size(share%chunks)
            call new_chunk(share%chunks(i), first(rank + 1 + (i - 1)*n_ranks) - 1, last)
         end do
      end associate
      call solve_chunks(share%task, share%body, monitor, share%chunks)
   end subroutine solve_share

end module amontons_sweep_ranks
