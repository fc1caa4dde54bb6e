!> Register of the nodes and sides that contact sets and ties use already: later ones leave these alone.
!>
!> They are kept as the node that follows each node on the sides of such a set; a node of which no side that follows it
!> is taken, as the last one of a line, is followed by itself, and one that no set has by 0.
module amontons_taken_sides
   use amontons_boundary, only: boundary_line_t
   use amontons_kinds, only: dp
   use amontons_mortar_pair, only: covered_shares, mortar_pair_t
   implicit none (type, external)
   private

   public :: take_facing_sides, take_line

contains

   !> Takes a line.
   pure subroutine take_line(follower, line)
      integer, intent(inout) :: follower(:) !! the node that follows each node; gains those of the line (nodes)
      type(boundary_line_t), intent(in) :: line !! the line of a set
      integer :: i

      do i = 1, line%n_nodes
         if (line%next(i) > 0) call take_side(follower, line%node([i, line%next(i)]), is_whole=.true.)
      end do
   end subroutine take_line

   !> Takes the nodes of the sides of a slave that face its master, and the sides, but for those that the master covers
   !> in part: what is left of them is another set's.
   pure subroutine take_facing_sides(follower, pair)
      integer, intent(inout) :: follower(:) !! the node that follows each node; gains those of the pair (nodes)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      ! What rounding leaves of a side.
      real(dp), parameter :: rounding = 1.0e-6_dp
      real(dp) :: share(pair%slave%n_sides)
      integer :: i

      share = covered_shares(pair)
      do i = 1, pair%slave%n_sides
         if (.not. share(i) > 0.0_dp) cycle
         associate (nodes => pair%slave%side(:3, i), is_whole => share(i) >= 1.0_dp - rounding)
            if (nodes(3) > 0) then
               call take_side(follower, nodes([1, 3]), is_whole)
               call take_side(follower, nodes([3, 2]), is_whole)
            else
               call take_side(follower, nodes(:2), is_whole)
            end if
         end associate
      end do
   end subroutine take_facing_sides

   !> Takes two nodes that follow each other.
   pure subroutine take_side(follower, nodes, is_whole)
      integer, intent(inout) :: follower(:) !! the node that follows each node (nodes)
      integer, intent(in) :: nodes(2) !! the nodes, in the order of the line
      logical, intent(in) :: is_whole !! whether the set has all between them

      where (follower(nodes) == 0) follower(nodes) = nodes
      if (is_whole) follower(nodes(1)) = nodes(2)
   end subroutine take_side

end module amontons_taken_sides
