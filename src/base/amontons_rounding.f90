!> What rounding leaves of a number that should be 0, and comparisons that do not hang on it. A constant here is one
!> that several modules share; a module has its own where its reason is its own. All are shares, without unit.
module amontons_rounding
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: exceeds, first_largest

   !> Rounding of numbers that decks and mesh files give, over their size: limits are round numbers, which lengths,
   !> loads and times of a deck often meet, and coordinates of files have about eight digits, fewer in differences.
   real(dp), parameter, public :: input_rounding = 1.0e-6_dp

   !> Rounding of angles between short sides of a mesh: a side has some hundredth of the body's size, and its ends have
   !> the digits of a file.
   real(dp), parameter, public :: angle_rounding = 1.0e-4_dp

   !> Rounding of a solution, over its largest number: methods leave residuals of 1e-10, and what follows from forces is
   !> some ten times as inaccurate or more.
   real(dp), parameter, public :: result_rounding = 1.0e-8_dp

   !> Rounding of a number that is computed in two ways from the same data, in many steps: a length along a line, the
   !> end of a cycle, a sum of works.
   real(dp), parameter, public :: computed_rounding = 1.0e-9_dp

   !> Rounding of entries of a small matrix, all about 1, after its pivots.
   real(dp), parameter, public :: pivot_rounding = 1.0e-11_dp

   !> Rounding of a sum of some hundred terms that cancel, over the largest of them.
   real(dp), parameter, public :: sum_rounding = 1.0e-12_dp

   !> Rounding of the difference of two numbers that a few operations have made equal, over these.
   real(dp), parameter, public :: difference_rounding = 1.0e-14_dp

contains

   !> Whether a number is larger than a limit by more than rounding.
   elemental logical function exceeds(value, limit)
      real(dp), intent(in) :: value !! the number
      real(dp), intent(in) :: limit !! the limit

      exceeds = value > limit + input_rounding*abs(limit)
   end function exceeds

   !> Place of the first of the numbers that no other one exceeds; 0 if there are none.
   pure integer function first_largest(values) result(place)
      real(dp), intent(in) :: values(:) !! the numbers

      place = findloc(exceeds(maxval(values), values), .false., dim=1)
   end function first_largest

end module amontons_rounding
