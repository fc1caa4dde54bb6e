!> Numbers in long texts, scanned where they stand: much faster than an internal read, and rounded as well.
module amontons_numeral
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: ends_word, scan_integer, scan_real

   !> A longer exponent is refused: no number of any kind has it.
   integer, parameter :: longest_exponent = 4
   !> Up to here powers of ten are numbers of kind `dp`, so that one division or product rounds as it must.
   integer, parameter :: largest_power = 22
   !> Up to here integers are numbers of kind `dp`.
   integer(int64), parameter :: largest_exact = 2_int64**53
   !> More digits may not fit a long integer.
   integer, parameter :: most_digits = 18

contains

   !> Whether a word ends before a position: the text is over, or a blank, a comma or the end of a line stands there.
   pure logical function ends_word(text, position)
      character(*), intent(in) :: text !! any text
      integer, intent(in) :: position !! the position, positive

      if (position > len(text)) then
         ends_word = .true.
         return
      end if
      select case (iachar(text(position:position)))
      case (iachar(' '), iachar(','), 9, 10, 13)
         ends_word = .true.
      case default
         ends_word = .false.
      end select
   end function ends_word

   !> The digit at a position, negative or larger than 9 where there is none.
   pure integer function digit_at(text, position) result(digit)
      character(*), intent(in) :: text !! any text
      integer, intent(in) :: position !! the position, positive

      digit = -1
      if (position <= len(text)) digit = iachar(text(position:position)) - iachar('0')
   end function digit_at

   !> Moves over a sign.
   pure subroutine scan_sign(text, position, is_negative)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: position !! where a sign may stand; behind it on return
      logical, intent(out) :: is_negative !! whether it is a minus

      is_negative = .false.
      if (position > len(text)) return
      is_negative = text(position:position) == '-'
      if (is_negative .or. text(position:position) == '+') position = position + 1
   end subroutine scan_sign

   !> Scans a whole word as an integer.
   pure subroutine scan_integer(text, position, value, ok)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: position !! where the word begins; behind it on success
      integer, intent(out) :: value !! the number, 0 on failure
      logical, intent(out) :: ok !! whether the word is an integer in range
      integer(int64) :: magnitude
      integer :: at, first, digit
      logical :: is_negative

      at = position
      call scan_sign(text, at, is_negative)
      first = at
      magnitude = 0
      do
         digit = digit_at(text, at)
         if (digit < 0 .or. digit > 9) exit
         magnitude = min(10*magnitude + digit, int(huge(value), int64) + 1)
         at = at + 1
      end do
      value = 0
      ok = at > first .and. magnitude <= huge(value) .and. ends_word(text, at)
      if (.not. ok) return
      value = int(magnitude)
      if (is_negative) value = -value
      position = at
   end subroutine scan_integer

   !> Scans a whole word as a finite real: `5`, `5.`, `.5`, `5e-1`, `5d-1`; no number, however small, is taken for 0.
   pure subroutine scan_real(text, position, value, ok)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: position !! where the word begins; behind it on success
      real(dp), intent(out) :: value !! the number, 0 on failure
      logical, intent(out) :: ok !! whether the word is a finite number
      integer(int64) :: mantissa
      integer :: at, power, power_written
      logical :: is_negative, is_exact

      value = 0.0_dp
      at = position
      call scan_sign(text, at, is_negative)
      call scan_mantissa(text, at, mantissa, power, is_exact, ok)
      if (.not. ok) return
      call scan_exponent(text, at, power_written, ok)
      ok = ok .and. ends_word(text, at)
      if (.not. ok) return
      power = power + power_written
      if (mantissa == 0) power = 0
      if (is_exact .and. abs(power) <= largest_power) then
         value = scaled(mantissa, power)
         if (is_negative) value = -value
      else
         call read_rounded(text(position:at - 1), value, ok)
      end if
      if (ok) position = at
   end subroutine scan_real

   !> Scans digits with at most one point among them.
   pure subroutine scan_mantissa(text, position, mantissa, power, is_exact, ok)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: position !! where the digits begin; behind them on return
      integer(int64), intent(out) :: mantissa !! the digits without point
      integer, intent(out) :: power !! power of ten to multiply them by
      logical, intent(out) :: is_exact !! whether the mantissa holds all digits and is a number of kind `dp`
      logical, intent(out) :: ok !! whether there is a digit
      integer(int64), parameter :: full = 10_int64**(most_digits - 1)
      integer :: digit
      logical :: is_behind_point

      mantissa = 0
      power = 0
      is_exact = .true.
      ok = .false.
      is_behind_point = .false.
      do
         digit = digit_at(text, position)
         if (digit >= 0 .and. digit <= 9) then
            ok = .true.
            if (mantissa < full) then
               mantissa = 10*mantissa + digit
               if (is_behind_point) power = power - 1
            else
               is_exact = .false.
            end if
         else if (digit == iachar('.') - iachar('0') .and. .not. is_behind_point) then
            is_behind_point = .true.
         else
            exit
         end if
         position = position + 1
      end do
      is_exact = is_exact .and. mantissa <= largest_exact
   end subroutine scan_mantissa

   !> Scans an exponent, if there is one.
   pure subroutine scan_exponent(text, position, power, ok)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: position !! where its letter may stand; behind the exponent on return
      integer, intent(out) :: power !! the exponent, 0 where there is none
      logical, intent(out) :: ok !! whether digits follow the letter, if there is a letter, and not too many
      integer, parameter :: beyond_every_real = 10000
      integer :: digit, first
      logical :: is_negative

      power = 0
      ok = .true.
      if (position > len(text)) return
      if (scan(text(position:position), 'eEdD') == 0) return
      position = position + 1
      call scan_sign(text, position, is_negative)
      first = position
      do
         digit = digit_at(text, position)
         if (digit < 0 .or. digit > 9) exit
         power = min(10*power + digit, beyond_every_real)
         position = position + 1
      end do
      ok = position > first .and. position <= first + longest_exponent
      if (is_negative) power = -power
   end subroutine scan_exponent

   !> Reads a numeral whose digits or power are too many for one rounding.
   pure subroutine read_rounded(numeral, value, ok)
      character(*), intent(in) :: numeral !! the numeral, well formed, not 0
      real(dp), intent(out) :: value !! the number, 0 on failure
      logical, intent(out) :: ok !! whether it is neither too large nor so small that it rounds to 0
      integer :: status

      read (numeral, *, iostat=status) value
      ok = status == 0 .and. ieee_is_finite(value) .and. abs(value) > 0.0_dp
      if (.not. ok) value = 0.0_dp
   end subroutine read_rounded

   !> An integer times a power of ten, rounded once.
   pure real(dp) function scaled(mantissa, power)
      integer(int64), intent(in) :: mantissa !! the integer, at most `largest_exact`
      integer, intent(in) :: power !! the power, at most `largest_power` in magnitude
      integer :: i
      real(dp), parameter :: powers(0:largest_power) = [(10.0_dp**i, i=0, largest_power)]

      if (power < 0) then
         scaled = real(mantissa, dp)/powers(-power)
      else
         scaled = real(mantissa, dp)*powers(power)
      end if
   end function scaled

end module amontons_numeral
