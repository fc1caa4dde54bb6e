!> Checksums of files and texts, by which an accidental change is found. They keep no secret: who changes a file can
!> compute them again.
!>
!> Fletcher's checksum of 32-bit words with two sums of 64 bits, as 32 hexadecimal digits. It grows with what it is of:
!> at any moment it is the checksum of all that was added so far.
module amontons_checksum
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_null_char
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_system, only: error_text
   use amontons_text, only: lower_case
   implicit none (type, external)
   private

   public :: checksum_length, checksum_t, file_checksum, text_checksum

   !> Digits of a checksum.
   integer, parameter :: checksum_length = 32

   !> The checksum of some bytes, and their number: all that is needed to go on behind them.
   type :: checksum_t
      private
      integer(c_int64_t) :: sums(2) = 0_c_int64_t !! sum of the words, and of these sums, without sign
      integer(c_int64_t), public :: n_bytes = 0_c_int64_t !! number of bytes
   contains
      generic, public :: add => add_text, add_numbers
      procedure :: add_numbers => checksum_add_numbers
      procedure :: add_text => checksum_add_text
      procedure, public :: digits => checksum_digits
   end type checksum_t

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      pure subroutine c_add_to_checksum(sums, n_before, bytes, n_bytes) bind(c, name='amontons_add_to_checksum')
         import :: c_char, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), intent(inout) :: sums(2)
         integer(c_int64_t), value :: n_before, n_bytes
         character(c_char), intent(in) :: bytes(*)
      end subroutine c_add_to_checksum

      function c_checksum_of_file(path, most, sums, n_bytes) bind(c, name='amontons_checksum_of_file') result(code)
         import :: c_char, c_int, c_int64_t
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_int64_t), value :: most
         integer(c_int64_t), intent(inout) :: sums(2), n_bytes
         integer(c_int) :: code
      end function c_checksum_of_file
   end interface

contains

   !> Adds a text.
   pure subroutine checksum_add_text(self, text)
      class(checksum_t), intent(inout) :: self !! the checksum of what stands before it
      character(*), intent(in) :: text !! the text

      call c_add_to_checksum(self%sums, self%n_bytes, text, len(text, c_int64_t))
      self%n_bytes = self%n_bytes + len(text, c_int64_t)
   end subroutine checksum_add_text

   !> Adds the bytes of some numbers.
   pure subroutine checksum_add_numbers(self, numbers)
      class(checksum_t), intent(inout) :: self !! the checksum of what stands before them
      real(dp), intent(in) :: numbers(:) !! the numbers

      call self%add_text(transfer(numbers, repeat(' ', size(numbers)*storage_size(numbers)/8)))
   end subroutine checksum_add_numbers

   !> The checksum as hexadecimal digits.
   pure function checksum_digits(self) result(digits)
      class(checksum_t), intent(in) :: self !! the checksum
      character(checksum_length) :: digits

      write (digits, '(2z16.16)') self%sums
      digits = lower_case(digits)
   end function checksum_digits

   !> The checksum of a text, as digits.
   pure function text_checksum(text) result(digits)
      character(*), intent(in) :: text !! the text
      character(checksum_length) :: digits
      type(checksum_t) :: checksum

      call checksum%add(text)
      digits = checksum%digits()
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
      code = int(c_checksum_of_file(path//c_null_char, most, checksum%sums, checksum%n_bytes))
      if (code /= 0) call new_error(error, system_failure, path//': cannot read this file: '//error_text(code))
   end subroutine file_checksum

end module amontons_checksum
