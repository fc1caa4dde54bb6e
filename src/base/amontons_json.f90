!> Values as JSON writes them.
module amontons_json
   use amontons_kinds, only: dp
   use amontons_quantity, only: expanded, quantity_t
   use amontons_text, only: to_text, utf_8_width
   implicit none (type, external)
   private

   public :: number, numbers, quantity_members, string, truth

contains

   !> A finite real as a JSON number; null otherwise.
   pure function number(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      if (abs(value) <= huge(value)) then
         text = to_text(value)
      else
         text = 'null'
      end if
   end function number

   !> Reals as the elements of a JSON array.
   pure function numbers(values) result(text)
      real(dp), intent(in) :: values(:) !! the numbers
      character(:), allocatable :: text
      ! A separator, and the longest number: '-1.2345678901234567e-308'.
      integer, parameter :: longest = 26
      integer :: i, length

      allocate (character(longest*size(values)) :: text)
      length = 0
      do i = 1, size(values)
         associate (element => ', '//number(values(i)))
            text(length + 1:length + len(element)) = element
            length = length + len(element)
         end associate
      end do
      text = text(3:length)
   end function numbers

   !> Quantities as the members of a JSON object.
   pure function quantity_members(quantities) result(text)
      type(quantity_t), intent(in) :: quantities(:) !! the quantities
      character(:), allocatable :: text
      type(quantity_t), allocatable :: list(:)
      integer :: i

      list = expanded(quantities)
      text = ''
      do i = 1, size(list)
         if (i > 1) text = text//', '
         text = text//'"'//trim(list(i)%key)//'": '//number(list(i)%value)
      end do
   end function quantity_members

   !> A logical as JSON.
   pure function truth(value) result(text)
      logical, intent(in) :: value !! the value
      character(:), allocatable :: text

      text = trim(merge('true ', 'false', value))
   end function truth

   !> A text as a JSON string. Bytes that are no UTF-8 are taken for Latin-1; JSON would not be JSON with them.
   pure function string(value) result(text)
      character(*), intent(in) :: value !! the text
      character(:), allocatable :: text
      character(6) :: escape
      integer :: i, width

      text = '"'
      i = 1
      do while (i <= len(value))
         width = utf_8_width(value(i:))
         if (scan(value(i:i), '"\') > 0) text = text//'\'
         if (width == 0) then
            write (escape, '("\u", z4.4)') iachar(value(i:i))
            text = text//escape
         else
            text = text//value(i:i + width - 1)
         end if
         i = i + max(1, width)
      end do
      text = text//'"'
   end function string

end module amontons_json
