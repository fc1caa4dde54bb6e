!> The motion of rigid obstacles in a load history: a shift and a turn about a pivot.
module amontons_obstacle_motion
   use amontons_contact_rows, only: turned
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_kinds, only: dp
   use amontons_obstacle, only: obstacle_t
   implicit none (type, external)
   private

   public :: find_feet, obstacle_motion_t, tangential_motion

   !> Where an obstacle has moved: it turned about the pivot, and then shifted.
   type :: obstacle_motion_t
      real(dp) :: shift(2) = 0.0_dp !! shift along x and y [L]
      real(dp) :: turn = 0.0_dp !! angle, counterclockwise [rad]
      real(dp) :: pivot(2) = 0.0_dp !! what it turned about [L]
   contains
      procedure :: displacement => obstacle_motion_displacement
      procedure :: is_at_rest => obstacle_motion_is_at_rest
      procedure :: moved => obstacle_motion_moved
   end type obstacle_motion_t

contains

   !> Whether the obstacle is where it was.
   elemental logical function obstacle_motion_is_at_rest(self) result(is_at_rest)
      class(obstacle_motion_t), intent(in) :: self !! the motion

      is_at_rest = .not. (any(abs(self%shift) > 0.0_dp) .or. abs(self%turn) > 0.0_dp)
   end function obstacle_motion_is_at_rest

   !> How far a point of the obstacle has moved. 1 - cos is written so that small angles keep their digits (2) [L].
   pure function obstacle_motion_displacement(self, position) result(displacement)
      class(obstacle_motion_t), intent(in) :: self !! the motion
      real(dp), intent(in) :: position(2) !! where the point was [L]
      real(dp) :: displacement(2)

      associate (arm => position - self%pivot)
         displacement = self%shift + sin(self%turn)*turned(arm) - 2.0_dp*sin(0.5_dp*self%turn)**2*arm
      end associate
   end function obstacle_motion_displacement

   !> The obstacle where it has moved to.
   pure function obstacle_motion_moved(self, obstacle) result(moved)
      class(obstacle_motion_t), intent(in) :: self !! the motion
      type(obstacle_t), intent(in) :: obstacle !! the obstacle where it was
      type(obstacle_t) :: moved

      moved = obstacle
      moved%point = obstacle%point + self%displacement(obstacle%point)
      moved%normal = cos(self%turn)*obstacle%normal + sin(self%turn)*turned(obstacle%normal)
   end function obstacle_motion_moved

   !> The feet of the contact points: where the normals meet the obstacles, or the points themselves where they do not
   !> (2, quadrature points) [L].
   pure function find_feet(zone, contacts) result(feet)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they were
      real(dp), allocatable :: feet(:, :)
      real(dp) :: gap, cosine
      logical :: is_met
      integer :: p, i

      associate (quadrature => zone%quadrature)
         allocate (feet, source=quadrature%position)
         do p = 1, zone%n_points
            do i = quadrature%start(p), quadrature%start(p + 1) - 1
               call contacts(zone%set(p))%obstacle%measure(quadrature%position(:, i), quadrature%normal(:, i), gap, &
                  is_met, cosine)
               if (is_met) feet(:, i) = feet(:, i) + gap*quadrature%normal(:, i)
            end do
         end do
      end associate
   end function find_feet

   !> How far the obstacle has moved along the tangent of every point, at its foot; of a cell the mean (m) [L].
   pure function tangential_motion(zone, feet, motions) result(motion)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: feet(:, :) !! their feet (2, quadrature points) [L]
      type(obstacle_motion_t), intent(in) :: motions(:) !! the motion of the obstacle of each contact set
      real(dp) :: motion(zone%n_points)
      integer :: p, i

      motion = 0.0_dp
      associate (quadrature => zone%quadrature)
         do p = 1, zone%n_points
            do i = quadrature%start(p), quadrature%start(p + 1) - 1
               motion(p) = motion(p) + quadrature%share(i)*dot_product(turned(quadrature%normal(:, i)), &
                  motions(zone%set(p))%displacement(feet(:, i)))
            end do
         end do
      end associate
   end function tangential_motion

end module amontons_obstacle_motion
