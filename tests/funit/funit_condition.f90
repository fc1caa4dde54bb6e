!> Assertions about logicals, single reals and exceptions.
module funit_condition
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: real64
   use funit_exception, only: anyExceptions, catch, fail, SourceLocation
   implicit none (type, external)
   private

   public :: assertAll, assertAny, assertExceptionRaised, assertFail, assertFalse, assertIsFinite, assertIsNaN, &
      assertNone, assertNotAll, assertTrue

   !> Asserts that a condition holds, or all of several.
   interface assertTrue
      procedure :: true_scalar, assertAll
   end interface assertTrue

   !> Asserts that a condition does not hold, or none of several.
   interface assertFalse
      procedure :: false_scalar, assertNone
   end interface assertFalse

contains

   !> The condition holds.
   subroutine true_scalar(condition, message, location)
      logical, intent(in) :: condition !! the condition
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (.not. condition) call fail('', message, location)
   end subroutine true_scalar

   !> The condition does not hold.
   subroutine false_scalar(condition, message, location)
      logical, intent(in) :: condition !! the condition
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (condition) call fail('', message, location)
   end subroutine false_scalar

   !> Asserts that a condition holds somewhere.
   subroutine assertAny(conditions, message, location)
      logical, intent(in) :: conditions(:) !! the conditions
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (.not. any(conditions)) call fail('', message, location)
   end subroutine assertAny

   !> Asserts that a condition holds everywhere.
   subroutine assertAll(conditions, message, location)
      logical, intent(in) :: conditions(:) !! the conditions
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (.not. all(conditions)) call fail('', message, location)
   end subroutine assertAll

   !> Asserts that a condition holds nowhere.
   subroutine assertNone(conditions, message, location)
      logical, intent(in) :: conditions(:) !! the conditions
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (any(conditions)) call fail('', message, location)
   end subroutine assertNone

   !> Asserts that a condition does not hold everywhere.
   subroutine assertNotAll(conditions, message, location)
      logical, intent(in) :: conditions(:) !! the conditions
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (all(conditions)) call fail('', message, location)
   end subroutine assertNotAll

   !> Asserts that a value is not a number.
   subroutine assertIsNaN(value, message, location)
      real(real64), intent(in) :: value !! the value
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (.not. ieee_is_nan(value)) call fail('', message, location)
   end subroutine assertIsNaN

   !> Asserts that a value is a finite number.
   subroutine assertIsFinite(value, message, location)
      real(real64), intent(in) :: value !! the value
      character(*), intent(in), optional :: message !! what a failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (.not. ieee_is_finite(value)) call fail('', message, location)
   end subroutine assertIsFinite

   !> Asserts that an exception is pending, and removes it.
   subroutine assertExceptionRaised(message, location)
      character(*), intent(in), optional :: message !! exact message of the exception; absent: the youngest one
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      if (present(message)) then
         if (.not. catch(message)) call fail('Failed to throw exception: '//message, location=location)
      else
         if (.not. catch()) call fail('Failed to throw exception.', location=location)
      end if
   end subroutine assertExceptionRaised

   !> Fails always.
   subroutine assertFail(message, location)
      character(*), intent(in) :: message !! what the failure means
      type(SourceLocation), intent(in), optional :: location !! place of the assertion

      call fail('', message, location)
   end subroutine assertFail

end module funit_condition
