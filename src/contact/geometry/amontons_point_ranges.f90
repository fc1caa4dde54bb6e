!> Lists in which each contact point has a range: that of point p goes from `start(p)` to `start(p + 1) - 1`.
module amontons_point_ranges
   implicit none (type, external)
   private

   public :: picked_places, picked_start

contains

   !> Where the ranges of some of the points begin when they alone follow each other, and one beyond the last.
   pure function picked_start(start, points) result(picked)
      integer, intent(in) :: start(:) !! beginning of each range, and one beyond the last (m + 1)
      integer, intent(in) :: points(:) !! the points to pick
      integer :: picked(size(points) + 1)
      integer :: k

      picked(1) = 1
      do k = 1, size(points)
         picked(k + 1) = picked(k) + start(points(k) + 1) - start(points(k))
      end do
   end function picked_start

   !> The places in the list of all that belongs to some of the points.
   pure function picked_places(start, points) result(places)
      integer, intent(in) :: start(:) !! beginning of each range, and one beyond the last (m + 1)
      integer, intent(in) :: points(:) !! the points to pick
      integer, allocatable :: places(:)
      integer :: i, k

      places = [([(i, i=start(points(k)), start(points(k) + 1) - 1)], k=1, size(points))]
   end function picked_places

end module amontons_point_ranges
