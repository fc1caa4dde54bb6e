!> Comparisons that do not hang on rounding. Limits are round numbers, and lengths, loads and times of a deck often meet
!> them exactly; coordinates of mesh files carry about eight digits, and computed numbers lose some more.
module amontons_rounding
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: exceeds, first_largest

   !> Numbers that differ by a smaller share of themselves are equal [-].
   real(dp), parameter :: same = 1.0e-6_dp

contains

   !> Whether a number is larger than a limit by more than rounding.
   elemental logical function exceeds(value, limit)
      real(dp), intent(in) :: value !! the number
      real(dp), intent(in) :: limit !! the limit

      exceeds = value > limit + same*abs(limit)
   end function exceeds

   !> Place of the first of the numbers that no other one exceeds; 0 if there are none.
   pure integer function first_largest(values) result(place)
      real(dp), intent(in) :: values(:) !! the numbers

      place = findloc(exceeds(maxval(values), values), .false., dim=1)
   end function first_largest

end module amontons_rounding
