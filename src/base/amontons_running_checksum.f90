!> Checksums of what grows: whether its beginning is still what it was.
module amontons_running_checksum
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_long, c_long_long, c_null_char
   use amontons_kinds, only: int64
   implicit none (type, external)
   private

   public :: checksum_of_start, running_checksum

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      pure function c_checksum_bytes(before, bytes, n_bytes) bind(c, name='amontons_add_to_checksum') result(sum)
         import :: c_char, c_int64_t, c_long
         implicit none (type, external)
         integer(c_int64_t), value :: before
         character(c_char), intent(in) :: bytes(*)
         integer(c_long), value :: n_bytes
         integer(c_int64_t) :: sum
      end function c_checksum_bytes

      function c_checksum_file(path, n_bytes, sum) bind(c, name='amontons_checksum_of_start') result(code)
         import :: c_char, c_int, c_int64_t, c_long_long
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_long_long), value :: n_bytes
         integer(c_int64_t), intent(out) :: sum
         integer(c_int) :: code
      end function c_checksum_file
   end interface

contains

   !> The checksum of a text, or of one behind another.
   pure integer(int64) function running_checksum(text, before) result(sum)
      character(*), intent(in) :: text !! the text
      integer(int64), intent(in), optional :: before !! the checksum of what stands before it; nothing by default

      sum = 0
      if (present(before)) sum = before
      sum = c_checksum_bytes(sum, text, len(text, c_long))
   end function running_checksum

   !> The checksum of the first bytes of a file.
   subroutine checksum_of_start(path, n_bytes, sum, ok)
      character(*), intent(in) :: path !! name of the file
      integer(int64), intent(in) :: n_bytes !! number of bytes
      integer(int64), intent(out) :: sum !! their checksum
      logical, intent(out) :: ok !! whether the file has so many, and they can be read

      ok = c_checksum_file(path//c_null_char, int(n_bytes, c_long_long), sum) == 0
   end subroutine checksum_of_start

end module amontons_running_checksum
