!> Values as JSON writes them.
module amontons_json
   use amontons_kinds, only: dp
   use amontons_quantity, only: expanded, quantity_t
   use amontons_text, only: longest_decimal, to_text, utf_8_width
   implicit none (type, external)
   private

   public :: json_logical, json_number, json_numbers, json_string, quantity_members

contains

   !> A finite real as a JSON number; null otherwise.
   pure function json_number(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      if (abs(value) <= huge(value)) then
         text = to_text(value)
      else
         text = 'null'
      end if
   end function json_number

   !> Reals as the elements of a JSON array.
   pure function json_numbers(values) result(text)
      real(dp), intent(in) :: values(:) !! the numbers
      character(:), allocatable :: text
      ! A separator, and the longest number.
      integer, parameter :: longest = longest_decimal + 2
      integer :: i, length

      allocate (character(longest*size(values)) :: text)
      length = 0
      do i = 1, size(values)
         associate (element => ', '//json_number(values(i)))
            text(length + 1:length + len(element)) = element
            length = length + len(element)
         end associate
      end do
      text = text(3:length)
   end function json_numbers

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
         text = text//'"'//trim(list(i)%key)//'": '//json_number(list(i)%value)
      end do
   end function quantity_members

   !> A logical as JSON.
   pure function json_logical(value) result(text)
      logical, intent(in) :: value !! the value
      character(:), allocatable :: text

      text = trim(merge('true ', 'false', value))
   end function json_logical

   !> A text as a JSON string. Bytes that are no UTF-8 are taken for Latin-1; JSON would not be JSON with them.
   pure function json_string(value) result(text)
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
   end function json_string

end module amontons_json
