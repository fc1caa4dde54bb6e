!> Whether a polyline crosses itself, so that no side of it is the inside.
module amontons_self_crossing
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: find_self_crossing

   !> Segments that share a box: a long line is compared box by box, most of which are apart.
   integer, parameter :: n_in_box = 32

contains

   !> Finds a place where two segments of a polyline pass through each other. That they touch, or lie upon each other,
   !> is no crossing.
   pure subroutine find_self_crossing(line, crosses, place)
      real(dp), intent(in) :: line(:, :) !! the points (2, points) [L]
      logical, intent(out) :: crosses !! whether there is such a place
      real(dp), intent(out) :: place(2) !! the first that was found; 0, 0 without one [L]
      real(dp), allocatable :: box(:, :, :)
      integer :: i, k, n, n_boxes, last

      n = size(line, 2) - 1
      n_boxes = (n + n_in_box - 1)/n_in_box
      allocate (box(2, 2, n_boxes))
      do i = 1, n_boxes
         last = min(i*n_in_box, n) + 1
         box(:, 1, i) = minval(line(:, (i - 1)*n_in_box + 1:last), dim=2)
         box(:, 2, i) = maxval(line(:, (i - 1)*n_in_box + 1:last), dim=2)
      end do
      crosses = .false.
      place = 0.0_dp
      do i = 1, n_boxes
         do k = i, n_boxes
            if (any(box(:, 1, k) > box(:, 2, i)) .or. any(box(:, 1, i) > box(:, 2, k))) cycle
            call compare_boxes(line, (i - 1)*n_in_box + 1, (k - 1)*n_in_box + 1, crosses, place)
            if (crosses) return
         end do
      end do
   end subroutine find_self_crossing

   !> Compares the segments of two boxes.
   pure subroutine compare_boxes(line, first, second, crosses, place)
      real(dp), intent(in) :: line(:, :) !! the points (2, points) [L]
      integer, intent(in) :: first !! first segment of one box
      integer, intent(in) :: second !! first segment of the other one, not before it
      logical, intent(inout) :: crosses !! becomes true where two of them pass through each other
      real(dp), intent(inout) :: place(2) !! where [L]
      integer :: i, k, n

      n = size(line, 2) - 1
      do i = first, min(first + n_in_box - 1, n)
         do k = max(second, i + 2), min(second + n_in_box - 1, n)
            associate (p => line(:, i), a => line(:, i + 1) - line(:, i), &
               q => line(:, k), b => line(:, k + 1) - line(:, k))
               if (.not. (parts(p, a, q, q + b) .and. parts(q, b, p, p + a))) cycle
               crosses = .true.
               place = p + a*cross(q - p, b)/cross(a, b)
               return
            end associate
         end do
      end do
   end subroutine compare_boxes

   !> Whether the line through a segment has two points on either side of it.
   pure logical function parts(start, along, a, b)
      real(dp), intent(in) :: start(2) !! start of the segment [L]
      real(dp), intent(in) :: along(2) !! its way to the end [L]
      real(dp), intent(in) :: a(2) !! one point [L]
      real(dp), intent(in) :: b(2) !! the other one [L]
      ! A point so near to the line, over the lengths of both, is on it.
      real(dp), parameter :: rounding = 1.0e-9_dp
      real(dp) :: sides(2)

      sides = [cross(along, a - start), cross(along, b - start)]
      parts = minval(sides) < 0.0_dp .and. maxval(sides) > 0.0_dp .and. &
         minval(abs(sides)) > rounding*norm2(along)*max(norm2(along), norm2(b - a))
   end function parts

   !> Cross product.
   pure real(dp) function cross(a, b)
      real(dp), intent(in) :: a(2) !! the first
      real(dp), intent(in) :: b(2) !! the second

      cross = a(1)*b(2) - a(2)*b(1)
   end function cross

end module amontons_self_crossing
