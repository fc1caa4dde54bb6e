!> The form of a listing: headings, labeled lines, numbers for reading.
module amontons_listing_text
   use amontons_kinds, only: dp
   use amontons_text, only: newline, to_short_text
   implicit none (type, external)
   private

   public :: columns, heading, line, pair, right, scientific, short

contains

   !> A heading with the line above it empty.
   pure function heading(title) result(text)
      character(*), intent(in) :: title !! the title
      character(:), allocatable :: text

      text = newline//title//newline//repeat('-', len(title))//newline
   end function heading

   !> A line of the listing: a label and what belongs to it.
   pure function line(label, value) result(text)
      character(*), intent(in) :: label !! the label
      character(*), intent(in) :: value !! what belongs to it
      character(:), allocatable :: text
      character(20) :: column

      column = label
      text = '  '//trim(column//value)//newline
   end function line

   !> Two numbers with at most seven digits.
   pure function pair(values) result(text)
      real(dp), intent(in) :: values(2) !! the numbers
      character(:), allocatable :: text

      text = '('//short(values(1))//', '//short(values(2))//')'
   end function pair

   !> A number with at most seven digits, for reading.
   pure function short(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_short_text(value, 7)
   end function short

   !> A number with at most three digits, for what matters by its size alone.
   pure function scientific(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_short_text(value, 3)
   end function scientific

   !> Numbers with at most six digits, each at the right end of a column 13 wide or, if it needs it, wider.
   pure function columns(values) result(text)
      real(dp), intent(in) :: values(:) !! the numbers
      character(:), allocatable :: text
      integer, parameter :: width = 13
      integer :: i

      text = ''
      do i = 1, size(values)
         text = text//right(' '//to_short_text(values(i), 6), width)
      end do
   end function columns

   !> A text moved to the right end of a column.
   pure function right(value, width) result(text)
      character(*), intent(in) :: value !! the text
      integer, intent(in) :: width !! width of the column
      character(:), allocatable :: text

      text = repeat(' ', max(0, width - len(value)))//value
   end function right

end module amontons_listing_text
