!> Lines of members that follow each other: in the plane the faces and nodes of a boundary set, cells of constant
!> multipliers and contact points. In space they have no order, and who asks for a line finds none.
module amontons_line
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: line_t

   !> What follows what, on one line or on several.
   type :: line_t
      integer, allocatable :: next(:) !! what follows each member along its line, 0 for none (members)
      real(dp), allocatable :: arc_length(:)
         !! length up to each node, chord by chord from the first node on; not allocated where members are no nodes
         !! (members) [L]
   contains
      procedure :: before => line_before
      procedure :: beside => line_beside
      procedure :: segments => line_segments
      procedure :: walk => line_walk
   end type line_t

contains

   !> What each member follows, 0 for none (members).
   pure function line_before(self) result(before)
      class(line_t), intent(in) :: self !! the lines
      integer :: before(size(self%next)), i

      before = 0
      do i = 1, size(before)
         if (self%next(i) > 0) before(self%next(i)) = i
      end do
   end function line_before

   !> What one member follows, and what follows it: none, one or two.
   pure function line_beside(self, member) result(beside)
      class(line_t), intent(in) :: self !! the lines
      integer, intent(in) :: member !! the member
      integer, allocatable :: beside(:)

      beside = [findloc(self%next, member, dim=1), self%next(member)]
      beside = pack(beside, beside > 0)
   end function line_beside

   !> All pairs of members that follow each other (2, pairs).
   pure function line_segments(self) result(segments)
      class(line_t), intent(in) :: self !! the lines
      integer, allocatable :: segments(:, :)
      integer :: i

      associate (goes_on => self%next > 0)
         segments = reshape([pack([(i, i=1, size(self%next))], goes_on), pack(self%next, goes_on)], &
            [2, count(goes_on)], order=[2, 1])
      end associate
   end function line_segments

   !> Walks along all lines: the open ones, each from its end that follows nothing, then the closed ones, each from its
   !> first member.
   pure subroutine line_walk(self, order, start)
      class(line_t), intent(in) :: self !! the lines
      integer, allocatable, intent(out) :: order(:) !! the members, line by line (members)
      integer, allocatable, intent(out), optional :: start(:)
         !! where each line begins in this list, and one beyond the last (lines + 1)
      integer, dimension(size(self%next)) :: before, first
      logical :: is_met(size(self%next))
      integer :: i, turn, member, n, n_lines

      before = self%before()
      allocate (order(size(before)))
      is_met = .false.
      n = 0
      n_lines = 0
      do turn = 1, 2
         do i = 1, size(before)
            if (is_met(i) .or. (turn == 1 .and. before(i) > 0)) cycle
            n_lines = n_lines + 1
            first(n_lines) = n + 1
            member = i
            do
               n = n + 1
               order(n) = member
               is_met(member) = .true.
               member = self%next(member)
               if (member == 0 .or. member == i) exit
            end do
         end do
      end do
      if (present(start)) start = [first(:n_lines), n + 1]
   end subroutine line_walk

end module amontons_line
