!> The ranks of a run, which are the processes that share its work: orders of rank 0, messages between two ranks,
!> agreement of all.
!>
!> Rank 0 runs the program; the others wait for its orders and follow them. The rank and the number of ranks are
!> variables of this module, since MPI is initialized once for a process.
module amontons_ranks
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_system, only: action
   implicit none (type, external)
   private

   public :: agree, all_ranks, begin_ranks, broadcast, end_ranks, gather_columns, give_order, has_begun, channel_t, &
      n_ranks, next_order, on_all_ranks, rank, sum_on_machine

   !> Whether MPI is in use.
   logical, protected :: has_begun = .false.
   !> The rank of this process, and the number of ranks.
   integer, protected :: rank = 0, n_ranks = 1

   !> Peer of a channel between rank 0 and all others.
   integer, parameter :: all_ranks = -1

   !> A channel to another rank. Both ends pass the same items in the same order; one end sends and the other receives.
   !> In a channel between all ranks, rank 0 sends.
   type :: channel_t
      integer :: peer = 0 !! the other rank, or `all_ranks`
      logical :: is_sender = .true. !! whether this end sends
   contains
      procedure, private :: pass_number => channel_pass_number
      procedure, private :: pass_text => channel_pass_text
      procedure, private :: pass_numbers => channel_pass_numbers
      procedure, private :: pass_columns => channel_pass_columns
      procedure, private :: pass_real_columns => channel_pass_real_columns
      generic :: pass => pass_number, pass_text, pass_numbers, pass_columns, pass_real_columns
   end type channel_t

   procedure(action), bind(c, name='amontons_mpi_end') :: mpi_end

   ! allow(assumed-size): C takes an address without a shape
   interface
      function mpi_begin(rank, size) bind(c, name='amontons_mpi_begin') result(has_begun)
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(out) :: rank, size
         integer(c_int) :: has_begun
      end function mpi_begin

      subroutine mpi_order(order, is_giver) bind(c, name='amontons_mpi_order')
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(inout) :: order
         integer(c_int), value, intent(in) :: is_giver
      end subroutine mpi_order

      subroutine mpi_pass(bytes, n, peer, is_sender) bind(c, name='amontons_mpi_pass')
         import :: c_int, c_int64_t
         implicit none (type, external)
         ! allow(assumed-size-character-intent): C reads or writes here
         type(*), intent(inout) :: bytes(*)
         integer(c_int64_t), value, intent(in) :: n
         integer(c_int), value, intent(in) :: peer, is_sender
      end subroutine mpi_pass

      function mpi_least(number) bind(c, name='amontons_mpi_least') result(least)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value, intent(in) :: number
         integer(c_int) :: least
      end function mpi_least

      function mpi_sum_here(number) bind(c, name='amontons_mpi_sum_here') result(total)
         import :: c_double
         implicit none (type, external)
         real(c_double), value, intent(in) :: number
         real(c_double) :: total
      end function mpi_sum_here
   end interface

   !> Bytes of a default integer and of a real.
   integer(int64), parameter :: integer_bytes = storage_size(0)/8, real_bytes = storage_size(0.0_dp)/8

contains

   !> Starts MPI, if the program was started on several ranks.
   subroutine begin_ranks()
      integer(c_int) :: own, all

      has_begun = mpi_begin(own, all) /= 0
      rank = int(own)
      n_ranks = int(all)
   end subroutine begin_ranks

   !> Ends MPI. Every rank calls it.
   subroutine end_ranks()
      if (has_begun) call mpi_end()
      has_begun = .false.
   end subroutine end_ranks

   !> Sends an order to the other ranks; called on rank 0.
   subroutine give_order(order)
      integer, intent(in) :: order !! the order
      integer(c_int) :: given

      given = int(order, c_int)
      if (n_ranks > 1) call mpi_order(given, 1_c_int)
   end subroutine give_order

   !> Waits for the next order of rank 0; called on the other ranks.
   integer function next_order() result(order)
      integer(c_int) :: given

      call mpi_order(given, 0_c_int)
      order = int(given)
   end function next_order

   !> Makes an error of any rank known to all. The error of the first rank that failed replaces that of rank 0; the
   !> others get an error without details, so that all ranks return.
   subroutine agree(error)
      type(error_t), allocatable, intent(inout) :: error !! what went wrong on this rank; then, what did on any
      type(error_t), allocatable :: first
      type(channel_t) :: channel
      integer :: failing

      if (.not. has_begun) return
      failing = int(mpi_least(int(merge(rank, n_ranks, allocated(error)), c_int)))
      if (failing == n_ranks) return
      if (.not. allocated(error)) call new_error(error, system_failure, '')
      if (failing == 0) return
      if (rank == failing) then
         channel = channel_t(0, .true.)
      else if (rank == 0) then
         channel = channel_t(failing, .false.)
      else
         return
      end if
      allocate (first, source=error)
      call channel%pass(first%kind)
      call channel%pass(first%message)
      call move_alloc(first, error)
   end subroutine agree

   !> Whether a condition holds on all ranks. Every rank calls it.
   logical function on_all_ranks(is_so)
      logical, intent(in) :: is_so !! whether it is so on this rank

      on_all_ranks = mpi_least(merge(1_c_int, 0_c_int, is_so)) > 0
   end function on_all_ranks

   !> The sum of a number over the ranks that share the memory of this one.
   real(dp) function sum_on_machine(number) result(total)
      real(dp), intent(in) :: number !! the number of this rank

      total = number
      if (has_begun) total = mpi_sum_here(number)
   end function sum_on_machine

   !> Sends bytes to another rank or to all, or receives them.
   subroutine pass_bytes(channel, bytes, n)
      class(channel_t), intent(in) :: channel !! the channel
      ! allow(assumed-size, assumed-size-character-intent): bytes of any type, for C
      type(*), intent(inout) :: bytes(*) !! the bytes
      integer(int64), intent(in) :: n !! the count

      call mpi_pass(bytes, int(n, c_int64_t), int(channel%peer, c_int), merge(1_c_int, 0_c_int, channel%is_sender))
   end subroutine pass_bytes

   !> Sends numbers of rank 0 to all ranks. Every rank calls it with an array of the same size.
   subroutine broadcast(list)
      real(dp), contiguous, intent(inout) :: list(:) !! the numbers

      call pass_bytes(channel_t(all_ranks, rank == 0), list, real_bytes*size(list))
   end subroutine broadcast

   !> Sends a whole number through the channel, or receives it.
   subroutine channel_pass_number(self, number)
      class(channel_t), intent(in) :: self !! the channel
      integer, intent(inout) :: number !! the number
      integer :: list(1)

      list = number
      call pass_bytes(self, list, integer_bytes)
      number = list(1)
   end subroutine channel_pass_number

   !> Sends a text through the channel, or receives it.
   subroutine channel_pass_text(self, text)
      class(channel_t), intent(in) :: self !! the channel
      character(:), allocatable, intent(inout) :: text !! the text
      integer, allocatable :: code(:)
      integer :: i

      if (self%is_sender) code = [(iachar(text(i:i)), i=1, len(text))]
      call self%pass(code)
      if (self%is_sender) return
      text = repeat(' ', size(code))
      do i = 1, size(code)
         text(i:i) = achar(code(i))
      end do
   end subroutine channel_pass_text

   !> Sends a list of whole numbers through the channel, or receives it.
   subroutine channel_pass_numbers(self, list)
      class(channel_t), intent(in) :: self !! the channel
      integer, allocatable, intent(inout) :: list(:) !! the numbers
      integer :: length

      if (self%is_sender) length = size(list)
      call self%pass(length)
      if (.not. self%is_sender) then
         if (allocated(list)) deallocate (list)
         allocate (list(length))
      end if
      call pass_bytes(self, list, integer_bytes*length)
   end subroutine channel_pass_numbers

   !> Sends a table of whole numbers through the channel, or receives it.
   subroutine channel_pass_columns(self, columns)
      class(channel_t), intent(in) :: self !! the channel
      integer, allocatable, intent(inout) :: columns(:, :) !! the numbers
      integer, allocatable :: list(:), extent(:)

      if (self%is_sender) then
         extent = shape(columns)
         list = reshape(columns, [size(columns)])
      end if
      call self%pass(extent)
      call self%pass(list)
      if (.not. self%is_sender) columns = reshape(list, [extent(1), extent(2)])
   end subroutine channel_pass_columns

   !> Sends a table of real numbers through the channel, or receives it.
   subroutine channel_pass_real_columns(self, columns)
      class(channel_t), intent(in) :: self !! the channel
      real(dp), allocatable, intent(inout) :: columns(:, :) !! the numbers
      integer, allocatable :: extent(:)

      if (self%is_sender) extent = shape(columns)
      call self%pass(extent)
      if (.not. self%is_sender) then
         if (allocated(columns)) deallocate (columns)
         allocate (columns(extent(1), extent(2)))
      end if
      call pass_bytes(self, columns, real_bytes*extent(1)*extent(2))
   end subroutine channel_pass_real_columns

   !> Appends columns of every rank to those of the whole on rank 0, in the order of the ranks. Every rank calls it.
   subroutine gather_columns(columns, place, whole)
      real(dp), allocatable, intent(inout) :: columns(:, :) !! the columns of this rank
      integer, allocatable, intent(inout) :: place(:) !! indices of the columns in the whole
      real(dp), intent(inout) :: whole(:, :) !! the columns of the whole; not used on ranks other than 0
      type(channel_t) :: channel
      real(dp), allocatable :: received(:, :)
      integer, allocatable :: to(:)
      integer :: i, k

      if (rank > 0) then
         channel = channel_t(0, .true.)
         call channel%pass(place)
         call channel%pass(columns)
         return
      end if
      whole(:, place) = whole(:, place) + columns
      do i = 1, n_ranks - 1
         channel = channel_t(i, .false.)
         call channel%pass(to)
         call channel%pass(received)
         do k = 1, size(to)
            whole(:, to(k)) = whole(:, to(k)) + received(:, k)
         end do
      end do
   end subroutine gather_columns

end module amontons_ranks
