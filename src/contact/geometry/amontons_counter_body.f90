!> What a contact set may touch: the counter-body, seen along a line.
!>
!> A counter-body is solid behind its surface and free in front of it. All that contact asks of one is where a line
!> enters it and where it leaves it again; the rule that makes a gap of this is the same for every kind.
module amontons_counter_body
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: counter_body_t, crossing_t, steepest_cosine

   !> Where a line meets a surface at a smaller cosine than this, no gap is measured: the way along the line is more
   !> than ten times the distance, and a slip changes it about ten times as much as an approach of the same length.
   real(dp), parameter :: steepest_cosine = 0.1_dp

   !> A place where a line crosses the surface of a counter-body.
   type :: crossing_t
      real(dp) :: way = 0.0_dp !! the way to it along the line, negative behind the start [L]
      real(dp) :: cosine = 0.0_dp
         !! of the angle between the line's way back and the outward normal: positive where the line enters [-]
   end type crossing_t

   !> A counter-body of any kind.
   type, abstract :: counter_body_t
   contains
      procedure(counter_body_crossings), deferred :: crossings
      procedure, non_overridable :: measure => counter_body_measure
   end type counter_body_t

   abstract interface
      !> All places where a line crosses the surface, in any order.
      pure function counter_body_crossings(self, position, direction) result(crossings)
         import :: counter_body_t, crossing_t, dp
         implicit none (type, external)
         class(counter_body_t), intent(in) :: self !! the counter-body
         real(dp), intent(in) :: position(2) !! a point of the line [L]
         real(dp), intent(in) :: direction(2) !! its direction, a unit vector [-]
         type(crossing_t), allocatable :: crossings(:)
      end function counter_body_crossings
   end interface

contains

   !> The gap from a point along a direction. In free space it is the way to the first place ahead where the line
   !> enters; inside it is the way back, negative, to the place where the line entered last. A line that does not enter,
   !> or enters too aslant, meets nothing.
   pure subroutine counter_body_measure(self, position, direction, gap, is_met, cosine)
      class(counter_body_t), intent(in) :: self !! the counter-body
      real(dp), intent(in) :: position(2) !! the point [L]
      real(dp), intent(in) :: direction(2) !! the direction, a unit vector [-]
      real(dp), intent(out) :: gap !! the gap [L]
      logical, intent(out) :: is_met !! whether there is one
      real(dp), intent(out) :: cosine !! of the angle between the direction and the way into the surface there [-]
      type(crossing_t), allocatable :: crossings(:)
      integer :: found

      crossings = self%crossings(position, direction)
      found = find_entry(crossings)
      gap = 0.0_dp
      cosine = 0.0_dp
      if (found > 0) then
         gap = crossings(found)%way
         cosine = crossings(found)%cosine
      end if
      is_met = cosine >= steepest_cosine
   end subroutine counter_body_measure

   !> The place where a line entered the counter-body that its start is in, or where it enters next; 0 if it does not.
   pure integer function find_entry(crossings) result(found)
      type(crossing_t), intent(in) :: crossings(:) !! where the line crosses the surface
      ! A point this near to a surface that it faces away from lies on it, as a share of the lengths at hand.
      real(dp), parameter :: rounding = 1.0e-9_dp
      real(dp) :: near, last_exit, next_exit
      integer :: last, next

      associate (way => crossings%way, enters => crossings%cosine > 0.0_dp)
         near = rounding*maxval(abs(way))
         last_exit = maxval(way, mask=.not. enters .and. way <= near)
         next_exit = minval(way, mask=.not. enters .and. way > near)
         last = maxloc(way, dim=1, mask=enters .and. way <= 0.0_dp)
         next = minloc(way, dim=1, mask=enters .and. way > 0.0_dp)
      end associate
      found = 0
      if (next > 0) then
         if (crossings(next)%way <= next_exit) found = next
      end if
      if (last > 0) then
         if (crossings(last)%way > last_exit) found = last
      end if
   end function find_entry

end module amontons_counter_body
