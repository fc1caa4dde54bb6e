!> The form of a listing: headings, labelled lines, numbers for reading.
module amontons_listing_text
   use amontons_kinds, only: dp
   use amontons_text, only: newline, to_text
   implicit none (type, external)
   private

   public :: heading, line, pair, right, scientific, short

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

   !> Two numbers with six digits.
   pure function pair(values) result(text)
      real(dp), intent(in) :: values(2) !! the numbers
      character(:), allocatable :: text

      text = '('//short(values(1))//', '//short(values(2))//')'
   end function pair

   !> A number with at most seven digits, for reading.
   pure function short(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text
      character(16) :: buffer
      real(dp) :: rounded

      write (buffer, '(es15.6e3)') value
      read (buffer, '(es15.6e3)') rounded
      text = to_text(rounded)
   end function short

   !> A number in scientific form with three digits.
   pure function scientific(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text
      character(12) :: buffer

      write (buffer, '(es10.2e3)') value
      text = trim(adjustl(buffer))
   end function scientific

   !> A text moved to the right end of a column.
   pure function right(value, width) result(text)
      character(*), intent(in) :: value !! the text
      integer, intent(in) :: width !! width of the column
      character(:), allocatable :: text

      text = repeat(' ', max(0, width - len(value)))//value
   end function right

end module amontons_listing_text
