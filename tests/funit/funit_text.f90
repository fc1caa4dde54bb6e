!> Numbers as text, for the messages.
module funit_text
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none (type, external)
   private

   public :: list, to_text

   !> A number as text without blanks.
   interface to_text
      procedure :: integer_to_text, real_to_text
   end interface to_text

contains

   !> An integer as text.
   pure function integer_to_text(value) result(text)
      integer, intent(in) :: value !! the number
      character(:), allocatable :: text
      character(16) :: buffer

      write (buffer, '(i0)') value
      text = trim(buffer)
   end function integer_to_text

   !> A real as text, with all its digits.
   pure function real_to_text(value) result(text)
      real(real64), intent(in) :: value !! the number
      character(:), allocatable :: text
      character(32) :: buffer

      write (buffer, '(g0)') value
      text = trim(buffer)
   end function real_to_text

   !> Integers as a bracketed list.
   pure function list(values) result(text)
      integer, intent(in) :: values(:) !! the integers
      character(:), allocatable :: text
      integer :: position

      text = ''
      do position = 1, size(values)
         if (position > 1) text = text//','
         text = text//to_text(values(position))
      end do
      text = '['//text//']'
   end function list

end module funit_text
