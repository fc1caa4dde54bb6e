!> Rigid obstacles: plane, circle, parabola, polyline, each placed by a point and a normal.
!>
!> In the frame of an obstacle h counts along its normal, towards the body, and s along (n_y, -n_x); its surface is
!> h = f(s) near the origin. A positive radius bulges towards the body (a punch), a negative one is hollow (a seat).
module amontons_obstacle
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: obstacle_names, obstacle_t

   !> Kinds of obstacles, as a deck writes them.
   character(8), parameter :: obstacle_names(*) = [character(8) :: 'plane', 'circle', 'parabola', 'polyline']

   !> A rigid obstacle.
   type :: obstacle_t
      character(:), allocatable :: kind !! one of `obstacle_names`
      real(dp) :: point(2) = 0.0_dp !! origin of its frame: a point of its surface, or where 0, 0 of a polyline is [L]
      real(dp) :: normal(2) = [0.0_dp, 1.0_dp] !! direction of its outward normal there; any length but zero [-]
      real(dp) :: radius = 1.0_dp !! radius of curvature at the point: circle and parabola; negative if hollow [L]
      real(dp), allocatable :: line(:, :) !! points (s, h) of a polyline, the free side on the left (2, points) [L]
      character(:), allocatable :: file !! the file of the polyline; empty or not allocated without one
   contains
      procedure :: has_radius => obstacle_has_radius
      procedure :: measure => obstacle_measure
   end type obstacle_t

contains

   !> Distance from a point to the obstacle along a direction: the way to the surface, entered from its free side;
   !> negative where the point is inside already.
   pure subroutine obstacle_measure(self, position, direction, distance, is_met)
      class(obstacle_t), intent(in) :: self !! the obstacle
      real(dp), intent(in) :: position(2) !! the point [L]
      real(dp), intent(in) :: direction(2) !! the direction, a unit vector [-]
      real(dp), intent(out) :: distance !! the distance [L]
      logical, intent(out) :: is_met !! false if the line along the direction never enters the obstacle
      real(dp) :: axis(2), x(2), e(2)

      axis = self%normal/norm2(self%normal)
      x = in_frame(axis, position - self%point)
      e = in_frame(axis, direction)
      select case (self%kind)
      case ('circle')
         ! On the circle |x + d e - c| = R with the centre c = (0, -R); hollow circles are left rather than entered.
         call enter_conic(1.0_dp, 2.0_dp*(dot_product(x, e) + self%radius*e(2)), &
            dot_product(x, x) + 2.0_dp*self%radius*x(2), sign(1.0_dp, self%radius), distance, is_met)
      case ('parabola')
         ! On the parabola h + s^2 / (2 R) = 0.
         call enter_conic(e(1)**2/(2.0_dp*self%radius), e(2) + x(1)*e(1)/self%radius, &
            x(2) + x(1)**2/(2.0_dp*self%radius), 1.0_dp, distance, is_met)
      case ('polyline')
         call enter_polyline(self%line, x, e, distance, is_met)
      case default
         call enter_conic(0.0_dp, e(2), x(2), 1.0_dp, distance, is_met)
      end select
   end subroutine obstacle_measure

   !> Whether an obstacle of this kind has a radius.
   pure logical function obstacle_has_radius(self) result(has_radius)
      class(obstacle_t), intent(in) :: self !! the obstacle

      has_radius = self%kind == 'circle' .or. self%kind == 'parabola'
   end function obstacle_has_radius

   !> The coordinates (s, h) of a vector in the frame of an axis.
   pure function in_frame(axis, vector) result(local)
      real(dp), intent(in) :: axis(2) !! the axis h, a unit vector [-]
      real(dp), intent(in) :: vector(2) !! the vector
      real(dp) :: local(2)

      local = [axis(2)*vector(1) - axis(1)*vector(2), dot_product(axis, vector)]
   end function in_frame

   !> Where side * (a d^2 + b d + c) falls through zero: of two such places there is only one.
   pure subroutine enter_conic(a, b, c, side, distance, is_met)
      real(dp), intent(in) :: a !! quadratic coefficient
      real(dp), intent(in) :: b !! linear coefficient
      real(dp), intent(in) :: c !! constant
      real(dp), intent(in) :: side !! 1, or -1 where the function is negative on the free side
      real(dp), intent(out) :: distance !! d
      logical, intent(out) :: is_met !! whether there is such a place
      real(dp), parameter :: grazing = 1.0e-3_dp
      real(dp) :: root

      distance = 0.0_dp
      root = b**2 - 4.0_dp*a*c
      is_met = root > 0.0_dp
      if (.not. is_met) return
      ! The slope 2 a d + b at the place sought is -root, so that d = -(b + root)/(2 a) = 2 c/(root - b): of the two
      ! forms the one that loses no digits.
      root = side*sqrt(root)
      if (-b*root > 0.0_dp) then
         is_met = abs(a) > 0.0_dp .or. abs(b) > grazing
         distance = 2.0_dp*c/(root - b)
      else if (abs(a) > 0.0_dp) then
         distance = -(b + root)/(2.0_dp*a)
      else
         is_met = .false.
      end if
   end subroutine enter_conic

   !> The nearest place where a line enters a polyline from its left side.
   pure subroutine enter_polyline(line, x, e, distance, is_met)
      real(dp), intent(in) :: line(:, :) !! points of the polyline (2, points) [L]
      real(dp), intent(in) :: x(2) !! where the line starts [L]
      real(dp), intent(in) :: e(2) !! its direction [-]
      real(dp), intent(out) :: distance !! signed way along the line [L]
      logical, intent(out) :: is_met !! whether there is such a place
      real(dp), parameter :: rounding = 1.0e-12_dp
      real(dp) :: along(2), to_start(2), cross, way, place
      integer :: i

      is_met = .false.
      distance = huge(distance)
      do i = 1, size(line, 2) - 1
         along = line(:, i + 1) - line(:, i)
         cross = e(1)*along(2) - e(2)*along(1)
         ! Entered from the left: the direction points to the right of the segment.
         if (.not. cross > rounding*norm2(along)) cycle
         to_start = line(:, i) - x
         way = (to_start(1)*along(2) - to_start(2)*along(1))/cross
         place = (to_start(1)*e(2) - to_start(2)*e(1))/cross
         if (place < -rounding .or. place > 1.0_dp + rounding) cycle
         if (is_met .and. abs(way) >= abs(distance)) cycle
         is_met = .true.
         distance = way
      end do
      if (.not. is_met) distance = 0.0_dp
   end subroutine enter_polyline

end module amontons_obstacle
