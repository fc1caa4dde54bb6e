!> Base64 (RFC 4648): bytes as letters, three as four.
module amontons_base64
   use amontons_kinds, only: int64
   implicit none (type, external)
   private

   public :: base64_size, decode_base64, encode_base64

   !> The letters of the numbers 0 to 63.
   character(*), parameter :: letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/'
   !> Letters, pairs of them, and characters there are.
   integer, parameter :: n_letters = len(letters), n_pairs = n_letters**2, n_characters = 256
   integer :: i, j
   !> The two letters of the numbers 0 to 4095.
   character(2), parameter :: pair(0:n_pairs - 1) = [((letters(i:i)//letters(j:j), j=1, n_letters), i=1, n_letters)]
   !> The number of each letter; -1 for every other character.
   integer, parameter :: number(0:n_characters - 1) = [(index(letters, char(i)) - 1, i=0, n_characters - 1)]

contains

   !> How many letters a number of bytes become, the final `=` signs included.
   pure integer(int64) function base64_size(n_bytes)
      integer(int64), intent(in) :: n_bytes !! number of bytes

      base64_size = 4_int64*((n_bytes + 2_int64)/3_int64)
   end function base64_size

   !> Encodes bytes.
   pure function encode_base64(bytes) result(text)
      character(*), intent(in) :: bytes !! the bytes
      character(base64_size(len(bytes, int64))) :: text
      integer(int64) :: group, n_whole
      integer :: n_left

      n_whole = len(bytes, int64)/3_int64
      do group = 0_int64, n_whole - 1_int64
         text(4*group + 1:4*group + 4) = four_letters(bytes(3*group + 1:3*group + 3))
      end do
      n_left = int(len(bytes, int64) - 3_int64*n_whole)
      if (n_left == 0) return
      text(4*n_whole + 1:) = four_letters(bytes(3*n_whole + 1:)//repeat(char(0), 3 - n_left))
      text(4*n_whole + n_left + 2:) = repeat('=', 3 - n_left)
   end function encode_base64

   !> Encodes three bytes.
   pure character(4) function four_letters(bytes)
      character(3), intent(in) :: bytes !! the bytes
      integer :: word

      word = ior(ishft(ichar(bytes(1:1)), 16), ior(ishft(ichar(bytes(2:2)), 8), ichar(bytes(3:3))))
      four_letters(:2) = pair(ishft(word, -12))
      four_letters(3:) = pair(iand(word, n_pairs - 1))
   end function four_letters

   !> Decodes letters.
   pure subroutine decode_base64(text, n_bytes, bytes, is_valid)
      character(*), intent(in) :: text !! the letters, `base64_size` of the number of bytes
      integer(int64), intent(in) :: n_bytes !! number of bytes
      character(:), allocatable, intent(out) :: bytes !! the bytes; undefined if the letters are not valid
      logical, intent(out) :: is_valid !! whether these are the letters of so many bytes
      integer(int64) :: group, n_whole
      character(3) :: last
      integer :: n_left

      is_valid = .true.
      allocate (character(n_bytes) :: bytes)
      n_whole = n_bytes/3_int64
      do group = 0_int64, n_whole - 1_int64
         call decode_group(text(4*group + 1:4*group + 4), bytes(3*group + 1:3*group + 3), is_valid)
      end do
      n_left = int(n_bytes - 3_int64*n_whole)
      if (n_left == 0) return
      call decode_group(text(4*n_whole + 1:4*n_whole + n_left + 1)//repeat('A', 3 - n_left), last, is_valid)
      is_valid = is_valid .and. text(4*n_whole + n_left + 2:) == repeat('=', 3 - n_left)
      bytes(3*n_whole + 1:) = last(:n_left)
   end subroutine decode_base64

   !> Decodes four letters.
   pure subroutine decode_group(text, bytes, is_valid)
      character(4), intent(in) :: text !! the letters
      character(3), intent(out) :: bytes !! the bytes
      logical, intent(inout) :: is_valid !! becomes false if one of them is no letter of base64
      integer :: numbers(4), word, k

      do k = 1, 4
         numbers(k) = number(ichar(text(k:k)))
      end do
      is_valid = is_valid .and. all(numbers >= 0)
      word = ior(ior(ishft(numbers(1), 18), ishft(numbers(2), 12)), ior(ishft(numbers(3), 6), numbers(4)))
      do k = 1, 3
         bytes(k:k) = char(iand(ishft(word, 8*(k - 3)), n_characters - 1))
      end do
   end subroutine decode_group

end module amontons_base64
