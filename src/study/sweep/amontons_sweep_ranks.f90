!> A sweep over the ranks of a run: each solves chunks of its cases, and rank 0 writes their rows.
!>
!> Every rank prepares the sweep from the deck as rank 0 does. The condensed stiffness and the condensed loads of a body
!> that is spread come from rank 0. Ranks whose contact problem agrees with that of rank 0 to the last bit share the
!> cases. The chunks of a batch are assigned to the ranks cyclically. A chunk begins at rest on any rank, so that the
!> rows do not depend on the number of ranks.
module amontons_sweep_ranks
   use amontons_checkpoint, only: archive_t
   use amontons_config, only: config_t, effective_deck, read_config_text
   use amontons_distributed, only: all_ranks, broadcast, check_room, first_free_order, follow_order, give_order, &
      channel_t, n_ranks, next_order, on_all_ranks, order_end, rank, share_condenser
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_manifest, only: manifest_t
   use amontons_result, only: result_t
   use amontons_solve_case, only: cache_t, condense_case
   use amontons_study, only: study_monitor_t
   use amontons_sweep_chunk, only: chunk_length, chunk_t, condense_task, new_chunk, prepare_sweep, &
      solve_chunks, sweep_task_t
   use amontons_system, only: return_memory
   use amontons_text, only: comma_separated, read_reals
   use amontons_threads, only: n_threads
   implicit none (type, external)
   private

   public :: end_sharing, prepare_on_ranks, serve, solve_on_ranks

   !> Orders of rank 0.
   integer, parameter :: order_take = first_free_order, order_solve = order_take + 1, &
      order_gather = order_solve + 1, order_drop = order_gather + 1

   !> The data of a sweep on another rank.
   type :: share_t
      type(config_t) :: config !! the deck
      type(cache_t) :: cache !! the body
      type(result_t) :: result !! the load case of the deck, without factors
      type(sweep_task_t) :: task !! the sweep
      type(chunk_t), allocatable :: chunks(:) !! the chunks of the last batch
   end type share_t

contains

   !> Condenses the loads of a sweep, also on the other ranks if these can share its cases. For a spread body the
   !> displacements of all nodes need all ranks, so that rank 0 alone solves the cases if each needs them.
   subroutine prepare_on_ranks(n_sharing, task, cache, config, error)
      integer, intent(out) :: n_sharing !! number of ranks that share the sweep; 1 if the others do not
      type(sweep_task_t), intent(inout) :: task !! the sweep; its loads are condensed
      type(cache_t), intent(inout) :: cache !! the body, condensed
      type(config_t), intent(in) :: config !! the deck
      type(error_t), allocatable, intent(out) :: error !! S is not positive definite, or memory ran out
      character(:), allocatable :: file, deck
      logical :: is_shared

      is_shared = n_ranks > 1 .and. task%sweep%n_cases() > chunk_length .and. &
         .not. (is_spread(cache) .and. task%sweep%has_forces)
      if (is_shared) then
         call give_order(order_take)
         file = config%file
         deck = effective_deck(config)
         call pass_deck(file, deck)
         is_shared = has_room(memory_mb(cache))
      end if
      if (is_shared) is_shared = on_all_ranks(.true.)
      if (is_shared) call share_condenser(cache%body%condensation%condenser)
      task%solver%shares_factor = is_shared .and. is_spread(cache)
      call condense_task(task, cache%body, cache%problem, error)
      if (is_shared) is_shared = is_same(config, cache, .not. allocated(error))
      n_sharing = merge(n_ranks, 1, is_shared)
   end subroutine prepare_on_ranks

   !> Prepares a sweep of rank 0 and keeps it if all ranks succeed; called on the other ranks.
   subroutine receive_sweep(share)
      type(share_t), allocatable, intent(out) :: share !! the sweep; not allocated if it is not shared
      type(share_t), allocatable :: taken
      type(error_t), allocatable :: error
      character(:), allocatable :: file, deck

      call pass_deck(file, deck)
      if (.not. has_room(0.0_dp)) return
      allocate (taken)
      call read_config_text(taken%config, file, deck, '', error)
      if (.not. allocated(error)) call prepare_sweep(taken%task, taken%cache, taken%config, taken%result, error)
      if (.not. on_all_ranks(.not. allocated(error))) return
      call condense_case(taken%cache, taken%config, taken%result, error)
      if (.not. allocated(error)) taken%task%solver%shares_factor = is_spread(taken%cache)
      if (.not. allocated(error)) call condense_task(taken%task, taken%cache%body, taken%cache%problem, error)
      if (is_same(taken%config, taken%cache, .not. allocated(error))) call move_alloc(taken, share)
   end subroutine receive_sweep

   !> Passes the text of a deck from rank 0 to all ranks.
   subroutine pass_deck(file, deck)
      character(:), allocatable, intent(inout) :: file !! its name
      character(:), allocatable, intent(inout) :: deck !! the effective deck
      type(channel_t) :: channel

      channel = channel_t(all_ranks, rank == 0)
      call channel%pass(file)
      call channel%pass(deck)
   end subroutine pass_deck

   !> Whether a body is spread over the ranks.
   pure logical function is_spread(cache)
      type(cache_t), intent(in) :: cache !! the body, condensed

      is_spread = cache%body%condensation%condenser%name == 'distributed'
   end function is_spread

   !> The memory that another rank would take for a sweep: mesh, loads and numbers of the unknowns, the factor unless
   !> the body is spread; and the matrix of the contact problem and its inverse, once and for each thread, and as much
   !> again for a method [MB].
   real(dp) function memory_mb(cache)
      type(cache_t), intent(in) :: cache !! the body, condensed
      ! For each unknown 90 bytes of mesh, supports and numbers, and 50 for each load, of which there are a few.
      real(dp), parameter :: body_bytes = 300.0_dp
      real(dp) :: n_entries

      if (allocated(cache%problem%matrix%band)) then
         n_entries = 2.0_dp*size(cache%problem%matrix%band%whole%entry)
      else
         n_entries = (2.0_dp*cache%problem%n_points)**2
      end if
      memory_mb = 1.0e-6_dp*(body_bytes*cache%body%dof_map%n_dofs + 8.0_dp*n_entries*(2 + 4*n_threads()))
      if (.not. is_spread(cache)) memory_mb = memory_mb + cache%body%condensation%condenser%memory_mb()
   end function memory_mb

   !> Whether the machines have enough memory for a sweep on the other ranks. Rank 0 solves the cases in any case.
   logical function has_room(wanted_mb)
      real(dp), intent(in) :: wanted_mb !! the memory that each would take; of rank 0 [MB]
      type(error_t), allocatable :: error
      real(dp) :: megabytes(1)

      megabytes = wanted_mb
      call broadcast(megabytes)
      call check_room('the sweep', merge(0.0_dp, megabytes(1), rank == 0), error)
      has_room = .not. allocated(error)
   end function has_room

   !> Whether all ranks have the files of rank 0.
   logical function is_same(config, cache, is_ready)
      type(config_t), intent(in) :: config !! the deck
      type(cache_t), intent(in) :: cache !! its body
      logical, intent(in) :: is_ready !! whether its loads are condensed
      character(:), allocatable :: own, expected
      type(manifest_t) :: files
      type(channel_t) :: channel

      own = ''
      if (is_ready) own = files%fingerprint(cache%body%mesh, config%contacts, config%loads)
      expected = own
      channel = channel_t(all_ranks, rank == 0)
      call channel%pass(expected)
      is_same = on_all_ranks(is_ready .and. own == expected)
   end function is_same

   !> Solves chunks on all threads of all ranks that share the sweep. On rank 0 only the chunks are solved that began
   !> before the monitor stopped the sweep.
   subroutine solve_on_ranks(n_sharing, task, cache, monitor, chunks)
      integer, intent(in) :: n_sharing !! number of ranks that share the sweep
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(cache_t), intent(in) :: cache !! the body
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! consecutive chunks
      type(channel_t) :: channel
      integer, allocatable :: batch(:)
      integer :: i, k

      if (n_sharing > 1) then
         call give_order(order_solve)
         batch = [chunks%first, chunks(size(chunks))%last]
         channel = channel_t(all_ranks, .true.)
         call channel%pass(batch)
      end if
      call solve_chunks(task, cache%body, cache%problem, monitor, chunks(1::n_sharing))
      if (n_sharing > 1) call give_order(order_gather)
      do i = 1, n_sharing - 1
         do k = i + 1, size(chunks), n_sharing
            call pass_chunk(channel_t(i, .false.), chunks(k))
         end do
      end do
   end subroutine solve_on_ranks

   !> Passes the rows of a chunk and the statistics of its cases.
   subroutine pass_chunk(channel, chunk)
      type(channel_t), intent(in) :: channel !! the channel
      type(chunk_t), intent(inout) :: chunk !! the chunk, solved; of the receiver, not yet
      type(archive_t) :: archive
      character(:), allocatable :: text

      if (channel%is_sender) call chunk%statistics%visit(archive)
      if (channel%is_sender) text = comma_separated(archive%numbers(:archive%n))
      call channel%pass(chunk%rows)
      call channel%pass(chunk%fault)
      call channel%pass(chunk%fault_kind)
      call channel%pass(text)
      if (channel%is_sender) return
      archive%is_read = .true.
      call read_reals(text, archive%numbers, chunk%is_done)
      if (chunk%is_done) call chunk%statistics%visit(archive)
   end subroutine pass_chunk

   !> Ends a shared sweep on the other ranks.
   subroutine end_sharing(n_sharing)
      integer, intent(in) :: n_sharing !! number of ranks that share it

      if (n_sharing > 1) call give_order(order_drop)
   end subroutine end_sharing

   !> Follows the orders of rank 0, those about condensers included, until the last one; called on the other ranks.
   subroutine serve()
      type(share_t), allocatable :: share
      integer :: order, i

      do
         order = next_order()
         select case (order)
         case (order_end)
            exit
         case (order_take)
            call receive_sweep(share)
         case (order_solve)
            call solve_share(share)
         case (order_gather)
            do i = 1, size(share%chunks)
               call pass_chunk(channel_t(0, .true.), share%chunks(i))
            end do
         case (order_drop)
            deallocate (share)
            call return_memory()
         case default
            call follow_order(order)
         end select
      end do
   end subroutine serve

   !> Solves this rank's share of a batch.
   subroutine solve_share(share)
      type(share_t), intent(inout) :: share !! the data of the sweep on this rank; gains the chunks
      type(study_monitor_t) :: monitor
      type(channel_t) :: channel
      integer, allocatable :: batch(:)
      integer :: i

      channel = channel_t(all_ranks, .false.)
      call channel%pass(batch)
      associate (first => batch(:size(batch) - 1), last => batch(size(batch)))
         if (allocated(share%chunks)) deallocate (share%chunks)
         allocate (share%chunks((size(first) - rank - 1 + n_ranks)/n_ranks))
         do i = 1, size(share%chunks)
            call new_chunk(share%chunks(i), first(rank + 1 + (i - 1)*n_ranks) - 1, last)
         end do
      end associate
      call solve_chunks(share%task, share%cache%body, share%cache%problem, monitor, share%chunks)
   end subroutine solve_share

end module amontons_sweep_ranks
