!> Assertions that two things are equal.
module funit_equality
   use, intrinsic :: iso_fortran_env, only: real64
   use funit_exception, only: fail, SourceLocation
   use funit_pair, only: new_pair, pair_t
   use funit_relation, only: is_near, is_relatively_near
   use funit_text, only: list, to_text
   implicit none (type, external)
   private

   public :: assertEqual, assertNotEqual, assertRelativelyEqual

   character(*), parameter :: labels(2) = ['Expected', 'Actual  ']

   !> Asserts that two things are equal; reals may differ by an absolute tolerance.
   interface assertEqual
      procedure :: equal_integers, equal_reals, equal_logical, equal_logicals, equal_text
   end interface assertEqual

   !> Asserts that two numbers differ.
   interface assertNotEqual
      procedure :: different_integers, different_reals
   end interface assertNotEqual

   !> Asserts that reals differ by no more than a fraction of the expected ones, none of which is zero.
   interface assertRelativelyEqual
      procedure :: relatively_equal_reals
   end interface assertRelativelyEqual

contains

   !> Integers are equal.
   subroutine equal_integers(expected, actual, message, location)
      integer, intent(in) :: expected(..) !! scalar, or of the shape of `actual`
      integer, intent(in) :: actual(..) !! scalar, rank 1 or rank 2
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, expected, actual)
      call pair%judge(is_near(pair%expected, pair%actual, 0.0_real64), 'AssertEqual', labels, &
         message=message, location=location)
   end subroutine equal_integers

   !> Reals are equal within a tolerance.
   subroutine equal_reals(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected(..) !! scalar, or of the shape of `actual`
      real(real64), intent(in) :: actual(..) !! scalar, rank 1 or rank 2
      real(real64), intent(in), optional :: tolerance !! largest allowed difference; absent: 0
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair
      real(real64) :: allowed

      allowed = 0.0_real64
      if (present(tolerance)) allowed = tolerance
      call new_pair(pair, expected, actual)
      call pair%judge(is_near(pair%expected, pair%actual, allowed), 'AssertEqual', labels, allowed, message, location)
   end subroutine equal_reals

   !> Reals are equal within a fraction of the expected ones.
   subroutine relatively_equal_reals(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected(..) !! scalar, or of the shape of `actual`; not zero
      real(real64), intent(in) :: actual(..) !! scalar, rank 1 or rank 2
      real(real64), intent(in) :: tolerance !! largest allowed fraction
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      type(pair_t) :: pair

      call new_pair(pair, expected, actual)
      call pair%judge(is_relatively_near(pair%expected, pair%actual, tolerance), 'AssertRelativelyEqual', labels, &
         tolerance, message, location)
   end subroutine relatively_equal_reals

   !> Logicals are equivalent.
   subroutine equal_logical(expected, actual, message, location)
      logical, intent(in) :: expected !! the expected value
      logical, intent(in) :: actual !! the actual value
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (expected .neqv. actual) call fail('AssertEquivalent failure:', message, location)
   end subroutine equal_logical

   !> Lists of logicals are equivalent.
   subroutine equal_logicals(expected, actual, message, location)
      logical, intent(in) :: expected(:) !! the expected values
      logical, intent(in) :: actual(:) !! the actual values
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (size(expected) /= size(actual)) then
         call fail('Arrays not conformable failure: expected shape '//list(shape(expected))// &
            ', actual shape '//list(shape(actual)), message, location)
      else if (any(expected .neqv. actual)) then
         call fail('AssertEquivalent failure at index: '// &
            to_text(findloc(expected .neqv. actual, .true., dim=1)), message, location)
      end if
   end subroutine equal_logicals

   !> Texts are equal, leading and trailing blanks aside.
   subroutine equal_text(expected, found, message, location)
      character(*), intent(in) :: expected !! the expected text
      character(*), intent(in) :: found !! the text found
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (adjustl(expected) /= adjustl(found)) call fail('String assertion failed:'//new_line('a')// &
         '    expected: <"'//expected//'">'//new_line('a')//'   but found: <"'//found//'">', message, location)
   end subroutine equal_text

   !> Two integers differ.
   subroutine different_integers(expected, actual, message, location)
      integer, intent(in) :: expected !! one value
      integer, intent(in) :: actual !! the other value
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (expected == actual) call fail('AssertNotEqual failure: <'//to_text(actual)//'>', message, location)
   end subroutine different_integers

   !> Two reals differ.
   subroutine different_reals(expected, actual, message, location)
      real(real64), intent(in) :: expected !! one value
      real(real64), intent(in) :: actual !! the other value
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (is_near(expected, actual, 0.0_real64)) then
         call fail('AssertNotEqual failure: <'//to_text(actual)//'>', message, location)
      end if
   end subroutine different_reals

end module funit_equality
