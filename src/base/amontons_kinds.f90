!> Kinds of the numbers used everywhere.
module amontons_kinds
   use, intrinsic :: iso_fortran_env, only: int32, int64, real64
   implicit none (type, external)
   private

   public :: dp, int32, int64

   !> Kind of every real number of the library.
   integer, parameter :: dp = real64

end module amontons_kinds
