!> Assertions about the order of numbers.
module funit_order
   use, intrinsic :: iso_fortran_env, only: real64
   use funit_exception, only: SourceLocation
   use funit_pair, only: new_pair, pair_t
   use funit_relation, only: is_at_most, is_below
   implicit none (type, external)
   private

   public :: assertGreaterThan, assertGreaterThanOrEqual, assertLessThan, assertLessThanOrEqual

   character(*), parameter :: labels(2) = ['Left ', 'Right']

   !> Asserts that numbers are less than others.
   interface assertLessThan
      procedure :: less_integers, less_reals
   end interface assertLessThan

   !> Asserts that numbers are less than or equal to others.
   interface assertLessThanOrEqual
      procedure :: at_most_integers, at_most_reals
   end interface assertLessThanOrEqual

   !> Asserts that numbers are greater than others.
   interface assertGreaterThan
      procedure :: greater_integers, greater_reals
   end interface assertGreaterThan

   !> Asserts that numbers are greater than or equal to others.
   interface assertGreaterThanOrEqual
      procedure :: at_least_integers, at_least_reals
   end interface assertGreaterThanOrEqual

contains

   !> Integers are less than others.
   subroutine less_integers(left, right, message, location)
      integer, intent(in) :: left(..) !! scalar, or of the shape of `right`
      integer, intent(in) :: right(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, left, right)
      call pair%judge(is_below(pair%expected, pair%actual), 'AssertLessThan', labels, &
         message=message, location=location)
   end subroutine less_integers

   !> Reals are less than others.
   subroutine less_reals(left, right, message, location)
      real(real64), intent(in) :: left(..) !! scalar, or of the shape of `right`
      real(real64), intent(in) :: right(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, left, right)
      call pair%judge(is_below(pair%expected, pair%actual), 'AssertLessThan', labels, &
         message=message, location=location)
   end subroutine less_reals

   !> Integers are less than or equal to others.
   subroutine at_most_integers(left, right, message, location)
      integer, intent(in) :: left(..) !! scalar, or of the shape of `right`
      integer, intent(in) :: right(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, left, right)
      call pair%judge(is_at_most(pair%expected, pair%actual), 'AssertLessThanOrEqual', labels, &
         message=message, location=location)
   end subroutine at_most_integers

   !> Reals are less than or equal to others.
   subroutine at_most_reals(left, right, message, location)
      real(real64), intent(in) :: left(..) !! scalar, or of the shape of `right`
      real(real64), intent(in) :: right(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, left, right)
      call pair%judge(is_at_most(pair%expected, pair%actual), 'AssertLessThanOrEqual', labels, &
         message=message, location=location)
   end subroutine at_most_reals

   !> Integers are greater than others.
   subroutine greater_integers(left, right, message, location)
      integer, intent(in) :: left(..) !! scalar, or of the shape of `right`
      integer, intent(in) :: right(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, left, right)
      call pair%judge(is_below(pair%actual, pair%expected), 'AssertGreaterThan', labels, &
         message=message, location=location)
   end subroutine greater_integers

   !> Reals are greater than others.
   subroutine greater_reals(left, right, message, location)
      real(real64), intent(in) :: left(..) !! scalar, or of the shape of `right`
      real(real64), intent(in) :: right(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, left, right)
      call pair%judge(is_below(pair%actual, pair%expected), 'AssertGreaterThan', labels, &
         message=message, location=location)
   end subroutine greater_reals

   !> Integers are greater than or equal to others.
   subroutine at_least_integers(left, right, message, location)
      integer, intent(in) :: left(..) !! scalar, or of the shape of `right`
      integer, intent(in) :: right(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, left, right)
      call pair%judge(is_at_most(pair%actual, pair%expected), 'AssertGreaterThanOrEqual', labels, &
         message=message, location=location)
   end subroutine at_least_integers

   !> Reals are greater than or equal to others.
   subroutine at_least_reals(left, right, message, location)
      real(real64), intent(in) :: left(..) !! scalar, or of the shape of `right`
      real(real64), intent(in) :: right(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, left, right)
      call pair%judge(is_at_most(pair%actual, pair%expected), 'AssertGreaterThanOrEqual', labels, &
         message=message, location=location)
   end subroutine at_least_reals

end module funit_order
