!> Reals as decimal text: the shortest that reads back as the same number.
module amontons_decimal
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: longest_decimal, put_decimal, rounded_decimal

   !> Most characters of such a text: '-1.2345678901234567e-308'.
   integer, parameter :: longest_decimal = 24

   ! allow(assumed-size, C072): C takes an address and knows no shape
   interface
      pure subroutine c_write_decimal(value, text, length) bind(c, name='amontons_write_decimal')
         import :: c_char, c_double, c_int
         implicit none (type, external)
         real(c_double), value :: value
         character(c_char), intent(inout) :: text(*)
         integer(c_int), intent(out) :: length
      end subroutine c_write_decimal

      pure function c_rounded_decimal(value, n_digits) bind(c, name='amontons_rounded_decimal') result(rounded)
         import :: c_double, c_int
         implicit none (type, external)
         real(c_double), value :: value
         integer(c_int), value :: n_digits
         real(c_double) :: rounded
      end function c_rounded_decimal
   end interface

contains

   !> Puts a number behind what a text holds so far: 0.1, 1250.0 or 1.25e-11, valid in JSON and in a namelist.
   ! allow(C072): the text is the caller's, who knows its room
   pure subroutine put_decimal(text, length, value)
      character(*), intent(inout) :: text !! the text, with room for `longest_decimal` characters more
      integer, intent(inout) :: length !! how much of it is filled
      real(dp), intent(in) :: value !! the number
      character(longest_decimal) :: decimal
      integer(c_int) :: n

      call c_write_decimal(real(value, c_double), decimal, n)
      text(length + 1:length + n) = decimal(:n)
      length = length + n
   end subroutine put_decimal

   !> A number rounded to a few decimal digits; unchanged where it would be rounded up beyond all.
   pure real(dp) function rounded_decimal(value, n_digits)
      real(dp), intent(in) :: value !! the number
      integer, intent(in) :: n_digits !! number of significant digits, at most 17

      rounded_decimal = real(c_rounded_decimal(real(value, c_double), int(n_digits, c_int)), dp)
   end function rounded_decimal

end module amontons_decimal
