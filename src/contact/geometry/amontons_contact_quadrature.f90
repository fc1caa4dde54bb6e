!> Where gap, friction and slip bound of the contact points are measured: a node at itself, a cell at its quadrature
!> points.
module amontons_contact_quadrature
   use amontons_kinds, only: dp
   use amontons_point_ranges, only: picked_places, picked_start
   implicit none (type, external)
   private

   public :: contact_quadrature_t

   !> The quadrature points of all points, those of point p from `start(p)` to `start(p + 1) - 1`.
   type :: contact_quadrature_t
      integer, allocatable :: start(:) !! first quadrature point of each point, and one beyond the last (m + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (2, quadrature points) [L]
      real(dp), allocatable :: normal(:, :) !! unit normal n towards the obstacle (2, quadrature points) [-]
      real(dp), allocatable :: outward(:)
         !! cosine of the angle between n and the body's outward normal: 1 unless n is given (quadrature points) [-]
      real(dp), allocatable :: arc_length(:) !! length along the line from its first node (quadrature points) [L]
      real(dp), allocatable :: gap(:)
         !! distance to the other body of a pair, along n; of no meaning with a rigid obstacle (quadrature points) [L]
      real(dp), allocatable :: share(:) !! share of the point's area; they sum to 1 over a point (quadrature points) [-]
   contains
      procedure :: add => contact_quadrature_add
      procedure :: picked => contact_quadrature_picked
   end type contact_quadrature_t

contains

   !> Adds those of other points behind those that are there.
   pure subroutine contact_quadrature_add(self, others)
      class(contact_quadrature_t), intent(inout) :: self !! the quadrature points
      type(contact_quadrature_t), intent(in) :: others !! the quadrature points to add
      integer :: n

      self%start = [self%start, size(self%share) + others%start(2:)]
      n = size(self%share) + size(others%share)
      self%position = reshape([self%position, others%position], [2, n])
      self%normal = reshape([self%normal, others%normal], [2, n])
      self%outward = [self%outward, others%outward]
      self%arc_length = [self%arc_length, others%arc_length]
      self%gap = [self%gap, others%gap]
      self%share = [self%share, others%share]
   end subroutine contact_quadrature_add

   !> The quadrature points of some of the points.
   pure function contact_quadrature_picked(self, points) result(picked)
      class(contact_quadrature_t), intent(in) :: self !! the quadrature points
      integer, intent(in) :: points(:) !! the points to pick
      type(contact_quadrature_t) :: picked
      integer, allocatable :: places(:)

      places = picked_places(self%start, points)
      picked%start = picked_start(self%start, points)
      picked%position = self%position(:, places)
      picked%normal = self%normal(:, places)
      picked%outward = self%outward(places)
      picked%arc_length = self%arc_length(places)
      picked%gap = self%gap(places)
      picked%share = self%share(places)
   end function contact_quadrature_picked

end module amontons_contact_quadrature
