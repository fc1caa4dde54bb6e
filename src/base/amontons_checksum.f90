!> Checksums of files and texts, by which an accidental change is found. They keep no secret: who changes a file can
!> compute them again.
!>
!> Fletcher's checksum of 32-bit words with two sums of 64 bits, as 32 hexadecimal digits.
module amontons_checksum
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_long_long, c_null_char
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: int64
   use amontons_system, only: error_text
   implicit none (type, external)
   private

   public :: checksum_length, file_checksum, text_checksum

   !> Digits of a checksum.
   integer, parameter :: checksum_length = 32

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      subroutine c_text_checksum(text, n_bytes, digits) bind(c, name='amontons_checksum_of_text')
         import :: c_char, c_long
         implicit none (type, external)
         character(c_char), intent(in) :: text(*)
         integer(c_long), value :: n_bytes
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: digits(*)
      end subroutine c_text_checksum

      function c_file_checksum(path, digits, n_bytes) bind(c, name='amontons_checksum_of_file') result(code)
         import :: c_char, c_int, c_long_long
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: digits(*)
         integer(c_long_long), intent(out) :: n_bytes
         integer(c_int) :: code
      end function c_file_checksum
   end interface

contains

   !> The checksum of a text.
   function text_checksum(text) result(checksum)
      character(*), intent(in) :: text !! the text
      character(checksum_length) :: checksum
      ! C puts a zero behind the digits.
      character(checksum_length + 1) :: digits

      call c_text_checksum(text, len(text, c_long), digits)
      checksum = digits(:checksum_length)
   end function text_checksum

   !> The checksum of a file, and its size.
   subroutine file_checksum(path, checksum, n_bytes, error)
      character(*), intent(in) :: path !! name of the file
      character(checksum_length), intent(out) :: checksum !! its checksum
      integer(int64), intent(out) :: n_bytes !! its size
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read
      character(checksum_length + 1) :: digits
      integer(c_long_long) :: n
      integer :: code

      n = 0
      digits = repeat('0', checksum_length)
      code = int(c_file_checksum(path//c_null_char, digits, n))
      checksum = digits(:checksum_length)
      n_bytes = n
      if (code /= 0) call new_error(error, system_failure, path//': cannot read this file: '//error_text(code))
   end subroutine file_checksum

end module amontons_checksum
