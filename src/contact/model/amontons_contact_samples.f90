!> Where gap, friction and slip bound of the contact points are measured: a node at itself, a cell at its quadrature
!> points.
module amontons_contact_samples
   use amontons_kinds, only: dp
   use amontons_point_ranges, only: picked_places, picked_start
   implicit none (type, external)
   private

   public :: contact_samples_t

   !> The samples of all points, those of point p from `start(p)` to `start(p + 1) - 1`.
   type :: contact_samples_t
      integer, allocatable :: start(:) !! first sample of each point, and one beyond the last (m + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (2, samples) [L]
      real(dp), allocatable :: normal(:, :) !! unit normal n towards the obstacle (2, samples) [-]
      real(dp), allocatable :: outward(:)
         !! cosine of the angle between n and the body's outward normal: 1 unless n is a given direction (samples) [-]
      real(dp), allocatable :: station(:) !! length along the line from its first node (samples) [L]
      real(dp), allocatable :: share(:) !! share of the point's area; they sum to 1 over a point (samples) [-]
   contains
      procedure :: add => contact_samples_add
      procedure :: picked => contact_samples_picked
   end type contact_samples_t

contains

   !> Adds the points of other samples behind those that are there.
   pure subroutine contact_samples_add(self, others)
      class(contact_samples_t), intent(inout) :: self !! the samples
      type(contact_samples_t), intent(in) :: others !! the samples to add
      integer :: n

      self%start = [self%start, size(self%share) + others%start(2:)]
      n = size(self%share) + size(others%share)
      self%position = reshape([self%position, others%position], [2, n])
      self%normal = reshape([self%normal, others%normal], [2, n])
      self%outward = [self%outward, others%outward]
      self%station = [self%station, others%station]
      self%share = [self%share, others%share]
   end subroutine contact_samples_add

   !> The samples of some of the points.
   pure function contact_samples_picked(self, points) result(picked)
      class(contact_samples_t), intent(in) :: self !! the samples
      integer, intent(in) :: points(:) !! the points to pick
      type(contact_samples_t) :: picked
      integer, allocatable :: places(:)

      places = picked_places(self%start, points)
      picked%start = picked_start(self%start, points)
      picked%position = self%position(:, places)
      picked%normal = self%normal(:, places)
      picked%outward = self%outward(places)
      picked%station = self%station(places)
      picked%share = self%share(places)
   end function contact_samples_picked

end module amontons_contact_samples
