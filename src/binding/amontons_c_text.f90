!> What all calls from C have in common: texts, which are characters up to a zero, and the frame of a call.
module amontons_c_text
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   implicit none (type, external)
   private

   public :: begin_call, end_call, put_c_text, text_of_c

   interface
      !> Waits until no other call runs, and gives the BLAS one thread.
      subroutine begin_call() bind(c, name='amontons_begin_call')
         implicit none (type, external)
      end subroutine begin_call

      !> Lets the next call run.
      subroutine end_call() bind(c, name='amontons_end_call')
         implicit none (type, external)
      end subroutine end_call
   end interface

contains

   !> The text that a C program passes.
   pure function text_of_c(c_text) result(text)
      ! allow(assumed-size): C passes an address and no length
      character(c_char), intent(in) :: c_text(*) !! the characters, up to a zero
      character(:), allocatable :: text
      integer :: i, length

      length = 0
      do while (c_text(length + 1) /= c_null_char)
         length = length + 1
      end do
      allocate (character(length) :: text)
      do i = 1, length
         text(i:i) = c_text(i)
      end do
   end function text_of_c

   !> Puts a text into the room that a C program offers, cut if need be, with a zero behind it.
   pure subroutine put_c_text(text, size, c_text)
      character(*), intent(in) :: text !! the text
      integer(c_int), intent(in) :: size !! the room, zero included; nothing is written if there is none
      character(c_char), intent(inout) :: c_text(size) !! takes the text
      integer :: i, length

      if (size < 1) return
      length = min(len(text), int(size) - 1)
      do i = 1, length
         c_text(i) = text(i:i)
      end do
      c_text(length + 1) = c_null_char
   end subroutine put_c_text

end module amontons_c_text
