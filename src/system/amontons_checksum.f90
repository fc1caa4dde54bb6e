!> Checksums of files and texts, by which an accidental change is found: the number that `cksum` of POSIX prints.
!>
!> A cyclic redundancy check of 32 bits over the bytes and their number. It grows with what it is of: at any moment it
!> is the checksum of all that was added so far.
module amontons_checksum
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int32_t, c_int64_t, c_null_char
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_system, only: error_text
   implicit none (type, external)
   private

   public :: checksum_t, file_checksum, text_checksum

   !> The checksum of some bytes, and their number: all that is needed to go on behind them.
   type :: checksum_t
      private
      integer(c_int32_t) :: remainder = 0_c_int32_t !! remainder of the bytes' polynomial, 32 bits without sign
      integer(c_int64_t), public :: n_bytes = 0_c_int64_t !! number of bytes
   contains
      generic, public :: add => add_text, add_numbers
      procedure :: add_numbers => checksum_add_numbers
      procedure :: add_text => checksum_add_text
      procedure, public :: value => checksum_value
   end type checksum_t

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      pure subroutine c_add_to_checksum(remainder, bytes, n_bytes) bind(c, name='amontons_add_to_checksum')
         import :: c_char, c_int32_t, c_int64_t
         implicit none (type, external)
         integer(c_int32_t), intent(inout) :: remainder
         character(c_char), intent(in) :: bytes(*)
         integer(c_int64_t), value :: n_bytes
      end subroutine c_add_to_checksum

      pure function c_checksum_value(remainder, n_bytes) bind(c, name='amontons_checksum_value') result(value)
         import :: c_int32_t, c_int64_t
         implicit none (type, external)
         integer(c_int32_t), value :: remainder
         integer(c_int64_t), value :: n_bytes
         integer(c_int64_t) :: value
      end function c_checksum_value

      function c_checksum_of_file(path, most, remainder, n_bytes) bind(c, name='amontons_checksum_of_file') &
         result(code)
         import :: c_char, c_int, c_int32_t, c_int64_t
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_int64_t), value :: most
         integer(c_int32_t), intent(inout) :: remainder
         integer(c_int64_t), intent(inout) :: n_bytes
         integer(c_int) :: code
      end function c_checksum_of_file
   end interface

contains

   !> Adds a text.
   pure subroutine checksum_add_text(self, text)
      class(checksum_t), intent(inout) :: self !! the checksum of what stands before it
      character(*), intent(in) :: text !! the text

      call c_add_to_checksum(self%remainder, text, len(text, c_int64_t))
      self%n_bytes = self%n_bytes + len(text, c_int64_t)
   end subroutine checksum_add_text

   !> Adds the bytes of some numbers.
   pure subroutine checksum_add_numbers(self, numbers)
      class(checksum_t), intent(inout) :: self !! the checksum of what stands before them
      real(dp), intent(in) :: numbers(:) !! the numbers

      call self%add_text(transfer(numbers, repeat(' ', size(numbers)*storage_size(numbers)/8)))
   end subroutine checksum_add_numbers

   !> The checksum, from 0 to 2**32 - 1.
   pure function checksum_value(self) result(value)
      class(checksum_t), intent(in) :: self !! the checksum
      integer(int64) :: value

      value = c_checksum_value(self%remainder, self%n_bytes)
   end function checksum_value

   !> The checksum of a text.
   pure function text_checksum(text) result(value)
      character(*), intent(in) :: text !! the text
      integer(int64) :: value
      type(checksum_t) :: checksum

      call checksum%add(text)
      value = checksum%value()
   end function text_checksum

   !> The checksum of a file, or of its beginning.
   subroutine file_checksum(checksum, path, error, most_bytes)
      type(checksum_t), intent(out) :: checksum !! the checksum of as many bytes as there are
      character(*), intent(in) :: path !! name of the file
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read
      integer(int64), intent(in), optional :: most_bytes !! where to end at the latest; the end of the file by default
      integer(c_int64_t) :: most
      integer :: code

      most = huge(most)
      if (present(most_bytes)) most = most_bytes
      code = int(c_checksum_of_file(path//c_null_char, most, checksum%remainder, checksum%n_bytes))
      if (code /= 0) call new_error(error, system_failure, path//': cannot read this file: '//error_text(code))
   end subroutine file_checksum

end module amontons_checksum
