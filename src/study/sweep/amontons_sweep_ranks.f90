!> A sweep over the ranks of a run: each solves chunks of its cases, and rank 0 writes their rows.
!>
!> Of the chunks of a batch each rank has those of its number, counted round. A chunk begins at rest wherever it is
!> solved, and all ranks have the same condensed stiffness: the rows are those that one rank would find.
module amontons_sweep_ranks
   use amontons_body, only: body_t
   use amontons_distributed, only: agree, all_ranks, first_service_order, give_order, line_t, n_ranks, rank, &
      rank_service_t, sum_on_machine
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp
   use amontons_study_monitor, only: study_monitor_t
   use amontons_sweep_chunk, only: chunk_length, chunk_t, new_chunk, solve_chunks, sweep_task_t
   use amontons_sweep_passing, only: pass_chunk, receive_sweep, send_sweep
   use amontons_system, only: available_memory_mb, return_memory
   use amontons_threads, only: n_threads
   implicit none (type, external)
   private

   public :: end_sharing, share_sweep, solve_on_ranks, sweep_service_t

   !> Orders of rank 0.
   integer, parameter :: order_take = first_service_order, order_solve = order_take + 1, &
      order_gather = order_solve + 1, order_drop = order_gather + 1

   !> What another rank has of a sweep.
   type, extends(rank_service_t) :: sweep_service_t
      type(sweep_task_t), allocatable :: task !! the sweep
      type(body_t), allocatable :: body !! what its cases need of the body
      type(chunk_t), allocatable :: chunks(:) !! the chunks of the last batch
   contains
      procedure :: follow => sweep_service_follow
   end type sweep_service_t

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
      call check_room(task%model%problem%n_points, error)
      if (allocated(error)) return
      n_sharing = n_ranks
      call send_sweep(task, body)
   end subroutine share_sweep

   !> Checks on all ranks that their machines have room for the condensed stiffness and its inverse, once and for each
   !> thread, and as much again for a method.
   subroutine check_room(n_points, error)
      integer, intent(in) :: n_points !! number of contact points; of rank 0
      type(error_t), allocatable, intent(out) :: error !! there is no room on some rank
      type(line_t) :: line
      integer :: n
      real(dp) :: wanted

      line = line_t(all_ranks, rank == 0)
      n = n_points
      call line%pass(n)
      call return_memory()
      wanted = 8.0e-6_dp*(2.0_dp*n)**2*(2 + 4*n_threads())
      ! Rank 0 solves the cases in any case.
      wanted = sum_on_machine(merge(0.0_dp, wanted, rank == 0))
      if (rank > 0) then
         if (wanted > available_memory_mb()) call new_error(error, system_failure, '')
      end if
      call agree(error)
   end subroutine check_room

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

   !> Follows an order of rank 0.
   subroutine sweep_service_follow(self, order)
      class(sweep_service_t), intent(inout) :: self !! the service
      integer, intent(in) :: order !! the order
      type(error_t), allocatable :: error
      integer :: i

      select case (order)
      case (order_take)
         call check_room(0, error)
         if (allocated(error)) return
         allocate (self%task, self%body)
         call receive_sweep(self%task, self%body)
      case (order_solve)
         call solve_share(self)
      case (order_gather)
         do i = 1, size(self%chunks)
            call pass_chunk(line_t(0, .true.), self%chunks(i))
         end do
      case default
         deallocate (self%task, self%body)
         if (allocated(self%chunks)) deallocate (self%chunks)
         call return_memory()
      end select
   end subroutine sweep_service_follow

   !> Solves this rank's share of a batch.
   subroutine solve_share(service)
      type(sweep_service_t), intent(inout) :: service !! the service; gains the chunks
      type(study_monitor_t) :: monitor
      type(line_t) :: line
      integer, allocatable :: batch(:)
      integer :: i

      line = line_t(all_ranks, .false.)
      call line%pass(batch)
      associate (first => batch(:size(batch) - 1), last => batch(size(batch)))
         if (allocated(service%chunks)) deallocate (service%chunks)
         allocate (service%chunks((size(first) - rank - 1 + n_ranks)/n_ranks))
         do i = 1, size(service%chunks)
            call new_chunk(service%chunks(i), first(rank + 1 + (i - 1)*n_ranks) - 1, last)
         end do
      end associate
      call solve_chunks(service%task, service%body, monitor, service%chunks)
   end subroutine solve_share

end module amontons_sweep_ranks
