!> Whole files, and standard input, read into memory, byte by byte as they are.
module amontons_text_file
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_system, only: error_text
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: read_standard_input, read_text_file

   !> A larger file is refused before it fills the memory [MB].
   integer, parameter :: largest_megabytes = 256
   integer, parameter :: largest_bytes = largest_megabytes*1000000
   !> The memory that the first bytes go to.
   integer, parameter :: first_length = 65536
   !> The system's number of standard input.
   integer(c_int), parameter :: standard_input = 0
   !> What some editors put before UTF-8 text.
   character(*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      function c_open_input(path) bind(c, name='amontons_open_input') result(file)
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_int) :: file
      end function c_open_input

      subroutine c_close_input(file) bind(c, name='amontons_close_input')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: file
      end subroutine c_close_input

      function c_read_input(file, text, n_bytes) bind(c, name='amontons_read_input') result(n_read)
         import :: c_char, c_int, c_long
         implicit none (type, external)
         integer(c_int), value :: file
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_long), value :: n_bytes
         integer(c_long) :: n_read
      end function c_read_input
   end interface

contains

   !> Reads a file as it is, without the mark some editors put before UTF-8 text; pipes work as well.
   subroutine read_text_file(file, text, error)
      character(*), intent(in) :: file !! name of the file
      character(:), allocatable, intent(out) :: text !! every byte of it
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, is empty or is too large
      character(:), allocatable :: reason
      integer(c_int) :: number

      text = ''
      number = c_open_input(file//c_null_char)
      if (number < 0) then
         reason = error_text(-int(number))
      else
         call read_bytes(number, text, reason)
         call c_close_input(number)
      end if
      call judge(text, file, reason, error)
   end subroutine read_text_file

   !> Reads standard input to its end, without the mark some editors put before UTF-8 text.
   subroutine read_standard_input(name, text, error)
      character(*), intent(in) :: name !! what messages call it
      character(:), allocatable, intent(out) :: text !! every byte of it
      type(error_t), allocatable, intent(out) :: error !! it cannot be read, is empty or is too large
      character(:), allocatable :: reason

      call read_bytes(standard_input, text, reason)
      call judge(text, name, reason, error)
   end subroutine read_standard_input

   !> Reads every byte of an open file, whose size need not be known.
   subroutine read_bytes(number, text, reason)
      integer(c_int), intent(in) :: number !! the system's number of the file
      character(:), allocatable, intent(out) :: text !! every byte of it
      character(:), allocatable, intent(out) :: reason !! why it cannot be read; empty where all is well
      character(:), allocatable :: longer
      integer(c_long) :: n
      integer :: n_read

      allocate (character(first_length) :: text)
      reason = ''
      n_read = 0
      do while (n_read <= largest_bytes)
         n = c_read_input(number, text(n_read + 1:), len(text, c_long) - n_read)
         if (n <= 0) exit
         n_read = n_read + int(n)
         if (n_read < len(text)) cycle
         allocate (character(2*n_read) :: longer)
         longer(:n_read) = text
         call move_alloc(longer, text)
      end do
      if (n_read > largest_bytes) then
         reason = 'it is larger than '//to_text(largest_megabytes)//' MB'
      else if (n < 0) then
         reason = error_text(-int(n))
      end if
      text = text(:n_read)
   end subroutine read_bytes

   !> Refuses a text that is not whole, or empty, and removes the mark before it.
   subroutine judge(text, name, reason, error)
      character(:), allocatable, intent(inout) :: text !! the text
      character(*), intent(in) :: name !! what messages call it
      character(*), intent(in) :: reason !! why it is not whole; empty if it is
      type(error_t), allocatable, intent(out) :: error !! why it is refused

      if (len(reason) > 0) then
         call new_error(error, input_refused, name//': cannot read this file: '//reason)
      else if (len(text) == 0) then
         call new_error(error, input_refused, name//': this file is empty')
      else if (index(text, byte_order_mark) == 1) then
         text = text(4:)
      end if
   end subroutine judge

end module amontons_text_file
