!> The relations that assertions ask about. Not-a-number stands in none of them and raises no floating-point trap.
module funit_relation
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none (type, external)
   private

   public :: is_at_most, is_below, is_near, is_relatively_near

contains

   !> Whether one value is less than the other.
   elemental logical function is_below(left, right)
      real(real64), intent(in) :: left !! the lesser value
      real(real64), intent(in) :: right !! the greater value

      is_below = .false.
      if (.not. (ieee_is_nan(left) .or. ieee_is_nan(right))) is_below = left < right
   end function is_below

   !> Whether one value is less than the other or equal to it.
   elemental logical function is_at_most(left, right)
      real(real64), intent(in) :: left !! the lesser value
      real(real64), intent(in) :: right !! the greater value

      is_at_most = .false.
      if (.not. (ieee_is_nan(left) .or. ieee_is_nan(right))) is_at_most = left <= right
   end function is_at_most

   !> Whether two values are equal, or differ by no more than is allowed; an infinity equals itself.
   elemental logical function is_near(expected, actual, allowed)
      real(real64), intent(in) :: expected !! the expected value
      real(real64), intent(in) :: actual !! the actual value
      real(real64), intent(in) :: allowed !! the largest allowed difference

      is_near = is_at_most(expected, actual) .and. is_at_most(actual, expected)
      if (.not. is_near) is_near = is_at_most(abs(actual - expected), allowed)
   end function is_near

   !> Whether two values differ by no more than a fraction of the expected one; nothing is near to zero.
   elemental logical function is_relatively_near(expected, actual, tolerance)
      real(real64), intent(in) :: expected !! the expected value
      real(real64), intent(in) :: actual !! the actual value
      real(real64), intent(in) :: tolerance !! the largest allowed fraction

      is_relatively_near = .false.
      if (.not. (ieee_is_finite(expected) .and. ieee_is_finite(actual))) return
      if (abs(expected) > 0.0_real64) is_relatively_near = is_near(expected, actual, tolerance*abs(expected))
   end function is_relatively_near

end module funit_relation
