!> What rounding leaves, and comparisons that do not hang on it. A constant here is one that several modules share; a
!> module has its own where its reason is its own.
module amontons_rounding
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: exceeds, first_largest

   !> Of numbers that decks and mesh files give, over their size: limits are round numbers, which lengths, loads and
   !> times of a deck often meet, and coordinates of files carry about eight digits, some of which differences lose [-].
   real(dp), parameter, public :: input_rounding = 1.0e-6_dp

   !> Of angles between short sides of a mesh: a side has some hundredth of the body's size, and its ends the digits of
   !> a file [rad].
   real(dp), parameter, public :: angle_rounding = 1.0e-4_dp

   !> Of a solution, over its largest number: methods leave residuals of 1e-10, and what follows is some ten times as
   !> inaccurate or more [-].
   real(dp), parameter, public :: result_rounding = 1.0e-8_dp

   !> Of one number that is computed in two ways from the same data, in many steps, as lengths along a line, times of
   !> a cycle and works of its steps are [-].
   real(dp), parameter, public :: computed_rounding = 1.0e-9_dp

   !> Of entries of a small matrix of numbers about 1 that pivots have changed [-].
   real(dp), parameter, public :: pivot_rounding = 1.0e-11_dp

   !> Of a sum of some hundred terms that cancel, over the largest of them [-].
   real(dp), parameter, public :: sum_rounding = 1.0e-12_dp

   !> Of a difference of two numbers that a few operations have made equal, over these [-].
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
