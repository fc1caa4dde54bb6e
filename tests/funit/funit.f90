!> What a test module sees: a stand-in for the module of the same name in pFUnit.
module funit
   use funit_condition, only: assertAll, assertAny, assertExceptionRaised, assertFail, assertFalse, assertIsFinite, &
      assertIsNaN, assertNone, assertNotAll, assertTrue
   use funit_equality, only: assertEqual, assertNotEqual, assertRelativelyEqual
   use funit_exception, only: anyExceptions, catch, SourceLocation, throw
   use funit_order, only: assertGreaterThan, assertGreaterThanOrEqual, assertLessThan, assertLessThanOrEqual
   implicit none (type, external)
   private

   public :: anyExceptions, assertAll, assertAny, assertEqual, assertExceptionRaised, assertFail, assertFalse, &
      assertGreaterThan, assertGreaterThanOrEqual, assertIsFinite, assertIsNaN, assertLessThan, &
      assertLessThanOrEqual, assertNone, assertNotAll, assertNotEqual, assertRelativelyEqual, assertTrue, catch, &
      SourceLocation, throw

   !> Names that pFUnit exports. They mean nothing here, but a test module that owns one must not compile here either.
   integer, parameter, public :: disable = 0, every = 0, finalize = 0, initialize = 0, is = 0, near = 0, not = 0, &
      run = 0, stub = 0, subject = 0, test = 0
   logical, parameter, public :: false = .false., true = .true.

end module funit
