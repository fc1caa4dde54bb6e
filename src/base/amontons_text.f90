!> Conversion between numbers and text; words; lines of a listing (headings, labels, rounded numbers). Numbers in long
!> texts are scanned in place, which is much faster than an internal read, with the same rounding.
!>
!> Dimensions of numbers are written in length L and force F: 'L', 'F/L^2', 'F L', 'sqrt(F L)' or ''; a case may name
!> units for them.
module amontons_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: append_text, as_lines, columns, comma_separated, counted, ends_word, flush_right, heading, labeled, &
      line_end, longest_decimal, lower_case, n_characters, nearest_word, newline, occurrences, place_text, &
      put_decimals, put_integer, put_text, quoted, read_integer, read_real, read_reals, replaced, rounded, &
      scan_integer, scan_real, scientific, short_text, to_short_text, to_text, unit_of, utf_8_width, vector_text, &
      with_unit, xml_escaped

   !> Largest number of digits of an exponent; longer ones are refused, since no real of any kind has them.
   integer, parameter :: longest_exponent = 4
   !> Largest power of ten that a real of kind `dp` holds exactly, so that one division or product is rounded correctly.
   integer, parameter :: largest_power = 22
   !> Largest integer up to which all integers are exact in kind `dp`.
   integer(int64), parameter :: largest_exact = 2_int64**53
   !> Largest number of digits that always fits a 64-bit integer.
   integer, parameter :: most_digits = 18

   !> The end of a line.
   character(*), parameter :: newline = new_line('a')

   !> Shortest text that reads back as the same value.
   interface to_text
      module procedure :: integer_to_text, long_to_text, real_to_text
   end interface to_text

   !> Largest length of such a text: '-1.2345678901234567e-308'.
   integer, parameter :: longest_decimal = 24

   ! allow(assumed-size, C072): C takes an address without a shape
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

   !> Whether a word ends before a position: there is the end of the text, a blank, a comma or the end of a line.
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

   !> The digit at a position; negative or larger than 9 if there is no digit.
   pure integer function digit_at(text, position) result(digit)
      character(*), intent(in) :: text !! any text
      integer, intent(in) :: position !! the position, positive

      digit = -1
      if (position <= len(text)) digit = iachar(text(position:position)) - iachar('0')
   end function digit_at

   !> Skips the sign of a number, if there is one, and returns whether it is a minus.
   pure subroutine scan_sign(text, position, is_negative)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: position !! position of a possible sign; the one after it on return
      logical, intent(out) :: is_negative !! whether it is a minus

      is_negative = .false.
      if (position > len(text)) return
      is_negative = text(position:position) == '-'
      if (is_negative .or. text(position:position) == '+') position = position + 1
   end subroutine scan_sign

   !> Scans a word that must be an integer.
   pure subroutine scan_integer(text, position, value, ok)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: position !! position of the word; the one after it on success
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

   !> Scans a word that must be a finite real: `5`, `5.`, `.5`, `5e-1`, `5d-1`; a number too small for kind `dp` is
   !> refused, not read as 0.
   pure subroutine scan_real(text, position, value, ok)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: position !! position of the word; the one after it on success
      real(dp), intent(out) :: value !! the number, 0 on failure
      logical, intent(out) :: ok !! whether the word is a finite number
      integer, parameter :: beyond_every_real = 10000
      integer :: i
      real(dp), parameter :: powers(0:largest_power) = [(10.0_dp**i, i=0, largest_power)]
      integer(int64) :: mantissa
      integer :: at, digit, first, power, power_written, status
      logical :: is_negative, is_power_negative, is_exact

      value = 0.0_dp
      at = position
      call scan_sign(text, at, is_negative)
      call scan_mantissa(text, at, mantissa, power, is_exact, ok)
      if (.not. ok) return
      if (scan(text(at:min(at, len(text))), 'eEdD') > 0) then
         at = at + 1
         call scan_sign(text, at, is_power_negative)
         first = at
         power_written = 0
         do
            digit = digit_at(text, at)
            if (digit < 0 .or. digit > 9) exit
            power_written = min(10*power_written + digit, beyond_every_real)
            at = at + 1
         end do
         ok = at > first .and. at <= first + longest_exponent
         power = power + merge(-power_written, power_written, is_power_negative)
      end if
      ok = ok .and. ends_word(text, at)
      if (.not. ok) return
      if (mantissa == 0) power = 0
      if (is_exact .and. mantissa <= largest_exact .and. abs(power) <= largest_power) then
         ! One division or product rounds as it must.
         if (power < 0) then
            value = real(mantissa, dp)/powers(-power)
         else
            value = real(mantissa, dp)*powers(power)
         end if
         if (is_negative) value = -value
      else
         read (text(position:at - 1), *, iostat=status) value
         ! Neither too large nor so small that it rounds to 0.
         ok = status == 0 .and. ieee_is_finite(value) .and. abs(value) > 0.0_dp
         if (.not. ok) value = 0.0_dp
      end if
      if (ok) position = at
   end subroutine scan_real

   !> Scans digits with at most one decimal point among them.
   pure subroutine scan_mantissa(text, at, mantissa, power, is_exact, ok)
      character(*), intent(in) :: text !! any text
      integer, intent(inout) :: at !! position of the digits; the one after them on return
      integer(int64), intent(out) :: mantissa !! their number, without the point
      integer, intent(out) :: power !! the power of ten that the point stands for
      logical, intent(out) :: is_exact !! whether the mantissa has all digits
      logical, intent(out) :: ok !! whether there are digits
      integer(int64), parameter :: full = 10_int64**(most_digits - 1)
      integer :: digit
      logical :: is_behind_point

      mantissa = 0
      power = 0
      is_exact = .true.
      ok = .false.
      is_behind_point = .false.
      do
         digit = digit_at(text, at)
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
         at = at + 1
      end do
   end subroutine scan_mantissa

   !> How often a letter occurs in a text.
   pure integer function occurrences(text, letter) result(n)
      character(*), intent(in) :: text !! the text
      character, intent(in) :: letter !! the letter
      integer :: i

      n = 0
      do i = 1, len(text)
         if (text(i:i) == letter) n = n + 1
      end do
   end function occurrences

   !> Position of the last character of a line, before the newline or the end of the text.
   pure integer function line_end(text, first)
      character(*), intent(in) :: text !! the text
      integer, intent(in) :: first !! position of the first character of the line

      line_end = first + index(text(first:), newline) - 2
      if (line_end < first - 1) line_end = len(text)
   end function line_end

   !> A count with its noun: `1 node`, `2 nodes`.
   pure function counted(n, noun) result(text)
      integer, intent(in) :: n !! the count
      character(*), intent(in) :: noun !! name of one
      character(:), allocatable :: text

      text = to_text(n)//' '//noun
      if (n /= 1) text = text//'s'
   end function counted

   !> A default integer as text without blanks.
   pure function integer_to_text(value) result(text)
      integer, intent(in) :: value !! the number
      character(:), allocatable :: text
      character(20) :: buffer
      integer :: length

      length = 0
      call put_integer(buffer, length, value)
      text = buffer(:length)
   end function integer_to_text

   !> A 64-bit integer as text without blanks.
   pure function long_to_text(value) result(text)
      integer(int64), intent(in) :: value !! the number
      character(:), allocatable :: text
      character(20) :: buffer

      write (buffer, '(i0)') value
      text = trim(buffer)
   end function long_to_text

   !> A real as the shortest decimal text that reads back as the same number; valid in JSON and in a namelist.
   pure function real_to_text(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text
      character(longest_decimal) :: buffer
      integer :: length

      length = 0
      call put_decimal(buffer, length, value)
      text = buffer(:length)
   end function real_to_text

   !> A real rounded to a few significant digits, for reading.
   pure function to_short_text(value, n_digits) result(text)
      real(dp), intent(in) :: value !! the number
      integer, intent(in) :: n_digits !! number of digits, at most 17
      character(:), allocatable :: text

      text = real_to_text(rounded(value, n_digits))
   end function to_short_text

   !> A real rounded to a few significant digits.
   pure real(dp) function rounded(value, n_digits)
      real(dp), intent(in) :: value !! the number
      integer, intent(in) :: n_digits !! number of digits, 1 to 16

      rounded = real(c_rounded_decimal(real(value, c_double), int(n_digits, c_int)), dp)
   end function rounded

   !> Reals with commas between them, as the tables hold them.
   pure function comma_separated(values) result(text)
      real(dp), intent(in) :: values(:) !! the numbers, one at the least
      character(:), allocatable :: text
      character((longest_decimal + 1)*size(values)) :: buffer
      integer :: length

      length = 0
      call put_decimals(buffer, length, values)
      text = buffer(2:length)
   end function comma_separated

   !> Reads reals separated by commas. The text is not copied: copies of a long line, which an array constructor or a
   !> comma appended to it would make, overflow flang's stack.
   pure subroutine read_reals(text, values, ok)
      character(*), intent(in) :: text !! the text
      real(dp), allocatable, intent(out) :: values(:) !! the numbers
      logical, intent(out) :: ok !! whether there is nothing else
      integer :: i, first, comma

      allocate (values(occurrences(text, ',') + 1))
      comma = 0
      do i = 1, size(values)
         first = comma + 1
         comma = index(text(first:), ',') + comma
         if (i == size(values)) comma = len(text) + 1
         call read_real(text(first:comma - 1), values(i), ok)
         if (.not. ok) return
      end do
   end subroutine read_reals

   !> Appends a piece to the used part of a text whose room grows with it, in a time proportional to the piece. What
   !> `//` makes of millions of characters lies on the stack with flang 19.
   pure subroutine append_text(text, length, piece)
      character(:), allocatable, intent(inout) :: text !! the text, and room for more
      integer, intent(inout) :: length !! number of characters in use
      character(*), intent(in) :: piece !! the piece
      character(:), allocatable :: longer

      if (length + len(piece) > len(text)) then
         allocate (character(2*(length + len(piece))) :: longer)
         longer(:length) = text(:length)
         call move_alloc(longer, text)
      end if
      call put_text(text, length, piece)
   end subroutine append_text

   !> Appends a piece to the used part of a text.
   ! allow(C072): the text is the caller's, who provides the room
   pure subroutine put_text(text, length, piece)
      character(*), intent(inout) :: text !! the text, with room for the piece
      integer, intent(inout) :: length !! number of characters in use
      character(*), intent(in) :: piece !! the piece

      text(length + 1:length + len(piece)) = piece
      length = length + len(piece)
   end subroutine put_text

   !> Appends an integer to the used part of a text; twenty times as fast as the format `i0` of the runtime library.
   ! allow(C072): the text is the caller's, who provides the room
   pure subroutine put_integer(text, length, value)
      character(*), intent(inout) :: text !! the text, with room for 11 characters more
      integer, intent(inout) :: length !! number of characters in use
      integer, intent(in) :: value !! the number
      integer, parameter :: base = 10
      character(11) :: digits
      integer :: first, rest

      rest = value
      do first = len(digits), 1, -1
         digits(first:first) = achar(iachar('0') + abs(mod(rest, base)))
         rest = rest/base
         if (rest == 0) exit
      end do
      if (value < 0) first = first - 1
      if (value < 0) digits(first:first) = '-'
      call put_text(text, length, digits(first:))
   end subroutine put_integer

   !> Appends numbers to the used part of a text, each after a comma.
   ! allow(C072): the text is the caller's, who provides the room
   pure subroutine put_decimals(text, length, values)
      character(*), intent(inout) :: text !! the text, with room for 25 characters more for each number
      integer, intent(inout) :: length !! number of characters in use
      real(dp), intent(in) :: values(:) !! the numbers
      integer :: i

      do i = 1, size(values)
         call put_text(text, length, ',')
         call put_decimal(text, length, values(i))
      end do
   end subroutine put_decimals

   !> Lines joined to one text, without trailing blanks, each with a newline.
   pure function as_lines(lines) result(text)
      character(*), intent(in) :: lines(:) !! the lines, blank padded
      character(:), allocatable :: text
      integer :: i, first, last

      allocate (character((len(lines) + 1)*size(lines)) :: text)
      last = 0
      do i = 1, size(lines)
         first = last + 1
         last = last + len_trim(lines(i)) + 1
         text(first:last - 1) = lines(i)
         text(last:last) = newline
      end do
      text = text(:last)
   end function as_lines

   !> Text as a quoted namelist string; quotes inside are doubled.
   pure function quoted(text) result(literal)
      character(*), intent(in) :: text !! the text
      character(:), allocatable :: literal

      literal = "'"//replaced(text, "'", "''")//"'"
   end function quoted

   !> A text with every occurrence of a part replaced.
   pure function replaced(text, old, new) result(changed)
      character(*), intent(in) :: text !! the text
      character(*), intent(in) :: old !! the part
      character(*), intent(in) :: new !! the replacement
      character(:), allocatable :: changed
      integer :: i, last, length
      logical :: is_old

      allocate (character(len(text)*max(1, len(new))) :: changed)
      length = 0
      i = 1
      do while (i <= len(text))
         last = i + len(old) - 1
         is_old = last <= len(text)
         if (is_old) is_old = text(i:last) == old
         if (.not. is_old) last = i
         if (is_old) call put_text(changed, length, new)
         if (.not. is_old) call put_text(changed, length, text(i:i))
         i = last + 1
      end do
      changed = changed(:length)
   end function replaced

   !> The text with its letters in lower case (ASCII).
   elemental function lower_case(text) result(lower)
      character(*), intent(in) :: text !! any text
      character(len(text)) :: lower
      integer :: i, code

      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code >= iachar('A') .and. code <= iachar('Z')) code = code + 32
         lower(i:i) = achar(code)
      end do
   end function lower_case

   !> Reads a whole word as an integer; blanks, signs alone and surplus characters make it fail.
   pure subroutine read_integer(word, value, ok)
      character(*), intent(in) :: word !! the word, without blanks
      integer, intent(out) :: value !! the number, 0 on failure
      logical, intent(out) :: ok !! whether the whole word is an integer in range
      integer, parameter :: longest = 32
      integer :: position

      position = 1
      call scan_integer(word, position, value, ok)
      ok = ok .and. position > len(word) .and. len(word) <= longest
      if (.not. ok) value = 0
   end subroutine read_integer

   !> Reads a whole word as a finite real, as `scan_real` does.
   pure subroutine read_real(word, value, ok)
      character(*), intent(in) :: word !! the word, without blanks
      real(dp), intent(out) :: value !! the number, 0 on failure
      logical, intent(out) :: ok !! whether the whole word is a finite number
      integer :: position

      position = 1
      call scan_real(word, position, value, ok)
      ok = ok .and. position > len(word)
      if (.not. ok) value = 0.0_dp
   end subroutine read_real

   !> The word of a list with the smallest edit distance to a misspelt word; empty if none is near.
   pure function nearest_word(word, words) result(nearest)
      character(*), intent(in) :: word !! the word as written
      character(*), intent(in) :: words(:) !! the words known, blank padded
      character(:), allocatable :: nearest
      integer :: i, distance, least

      nearest = ''
      least = max(1, len_trim(word)/3) + 1
      do i = 1, size(words)
         if (abs(len_trim(word) - len_trim(words(i))) >= least) cycle
         distance = edit_distance(trim(word), trim(words(i)))
         if (distance >= least) cycle
         least = distance
         nearest = trim(words(i))
      end do
   end function nearest_word

   !> Number of insertions, deletions, substitutions and swaps of neighbors that turn one word into another.
   pure integer function edit_distance(a, b) result(distance)
      character(*), intent(in) :: a !! one word
      character(*), intent(in) :: b !! the other word
      integer :: table(-1:len(a), -1:len(b)), i, j

      table = len(a) + len(b)
      table(0:, 0) = [(i, i=0, len(a))]
      table(0, 0:) = [(j, j=0, len(b))]
      do j = 1, len(b)
         do i = 1, len(a)
            table(i, j) = min(table(i - 1, j) + 1, table(i, j - 1) + 1, &
               table(i - 1, j - 1) + merge(0, 1, a(i:i) == b(j:j)))
            if (i == 1 .or. j == 1) cycle
            ! Two neighbors that changed places.
            if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) table(i, j) = min(table(i, j), &
               table(i - 2, j - 2) + 1)
         end do
      end do
      distance = table(len(a), len(b))
   end function edit_distance

   !> Number of bytes of the UTF-8 character that a text begins with; 0 for none, or for a control character.
   pure integer function utf_8_width(text) result(width)
      character(*), intent(in) :: text !! the text
      integer, parameter :: blank = 32, delete = 127
      ! The first bytes of characters of two bytes, of three and of four, and what is behind them.
      integer, parameter :: firsts(4) = [194, 224, 240, 245]
      integer :: first, second, i

      width = 0
      if (len(text) == 0) return
      first = iachar(text(1:1))
      if (first >= blank .and. first < delete) width = 1
      if (first < firsts(1) .or. first >= firsts(4)) return
      width = 1 + count(first >= firsts)
      if (len(text) < width) then
         width = 0
         return
      end if
      ! A character must not be longer than need be, nor half a pair of UTF-16, nor beyond the last character.
      second = iachar(text(2:2))
      if (any([first == 224 .and. second < 160, first == 237 .and. second >= 160, first == 240 .and. second < 144, &
         first == 244 .and. second >= 144]) .or. .not. all([(continues(text(i:i)), i=2, width)])) width = 0
   end function utf_8_width

   !> Whether a byte is a continuation byte of UTF-8.
   pure logical function continues(byte)
      character, intent(in) :: byte !! the byte

      continues = iachar(byte) >= 128 .and. iachar(byte) < 192
   end function continues

   !> Number of characters of a text of UTF-8: bytes that begin one.
   pure integer function n_characters(text)
      character(*), intent(in) :: text !! the text
      integer :: i

      n_characters = count([(.not. continues(text(i:i)), i=1, len(text))])
   end function n_characters

   !> Text as XML has it, in an attribute or between tags.
   pure function xml_escaped(text) result(value)
      character(*), intent(in) :: text !! the text
      character(:), allocatable :: value

      value = replaced(replaced(replaced(text, '&', '&amp;'), '<', '&lt;'), '"', '&quot;')
   end function xml_escaped

   !> Appends a real to the used part of a text: 0.1, 1250.0 or 1.25e-11, valid in JSON and in a namelist.
   ! allow(C072): the text is the caller's, who provides the room
   pure subroutine put_decimal(text, length, value)
      character(*), intent(inout) :: text !! the text, with room for `longest_decimal` characters more
      integer, intent(inout) :: length !! number of characters in use
      real(dp), intent(in) :: value !! the number
      character(longest_decimal) :: decimal
      integer(c_int) :: n

      call c_write_decimal(real(value, c_double), decimal, n)
      call put_text(text, length, decimal(:n))
   end subroutine put_decimal

   !> A heading with the line above it empty.
   pure function heading(title) result(text)
      character(*), intent(in) :: title !! the title
      character(:), allocatable :: text

      text = newline//title//newline//repeat('-', n_characters(title))//newline
   end function heading

   !> A line of the listing: a label and its value, in the column of all or behind the label with its blanks.
   pure function labeled(label, value) result(text)
      character(*), intent(in) :: label !! the label
      character(*), intent(in) :: value !! its value
      character(:), allocatable :: text

      text = '  '//trim(label//repeat(' ', max(1, 20 - len(label)))//value)//newline
   end function labeled

   !> Numbers in parentheses, with at most seven digits each, such as (1.5, -2.0).
   pure function vector_text(values) result(text)
      real(dp), intent(in) :: values(:) !! the numbers, one at the least
      character(:), allocatable :: text

      text = '('//place_text(values)//')'
   end function vector_text

   !> Coordinates with at most seven digits, without brackets.
   pure function place_text(position) result(text)
      real(dp), intent(in) :: position(:) !! the coordinates, one at the least [L]
      character(:), allocatable :: text
      integer :: i

      text = short_text(position(1))
      do i = 2, size(position)
         text = text//', '//short_text(position(i))
      end do
   end function place_text

   !> A number with at most seven digits, for reading.
   pure function short_text(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_short_text(value, 7)
   end function short_text

   !> A number with at most three digits, for residuals and other numbers of which only the size matters.
   pure function scientific(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_short_text(value, 3)
   end function scientific

   !> Numbers with at most six digits, right-aligned in columns; a column is widened if its number needs it.
   pure function columns(values, width) result(text)
      real(dp), intent(in) :: values(:) !! the numbers
      integer, intent(in) :: width !! width of a column
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(values)
         text = text//flush_right(' '//to_short_text(values(i), 6), width)
      end do
   end function columns

   !> A text right-aligned in a column.
   pure function flush_right(value, width) result(text)
      character(*), intent(in) :: value !! the text
      integer, intent(in) :: width !! width of the column
      character(:), allocatable :: text

      text = repeat(' ', max(0, width - n_characters(value)))//value
   end function flush_right

   !> The unit of a dimension; empty if the case names no units or the number has no dimension.
   pure function unit_of(units, dimension) result(unit)
      character(*), intent(in) :: units !! names of the units of length, force and, perhaps, stress: 'mm, N, MPa'
      character(*), intent(in) :: dimension !! the dimension
      character(:), allocatable :: unit
      integer :: first, last, i

      unit = ''
      if (len_trim(units) == 0) return
      first = index(units, ',')
      last = index(units, ',', back=.true.)
      if (dimension == 'F/L^2' .and. last > first) then
         unit = trim(adjustl(units(last + 1:)))
         return
      end if
      if (last == first) last = len(units) + 1
      do i = 1, len_trim(dimension)
         select case (dimension(i:i))
         case ('L')
            unit = unit//trim(adjustl(units(:first - 1)))
         case ('F')
            unit = unit//trim(adjustl(units(first + 1:last - 1)))
         case default
            unit = unit//dimension(i:i)
         end select
      end do
   end function unit_of

   !> A text followed by a blank and the unit of its number; the text alone if there is no unit.
   pure function with_unit(text, units, dimension) result(labeled)
      character(*), intent(in) :: text !! the text
      character(*), intent(in) :: units !! names of the units of a case
      character(*), intent(in) :: dimension !! the dimension of the number
      character(:), allocatable :: labeled

      labeled = trim(text//' '//unit_of(units, dimension))
   end function with_unit

end module amontons_text
