!> The form of a listing: headings, labeled lines, numbers for reading, and what these are measured in: dimensions,
!> written in length L and force F as 'L', 'F/L^2', 'F L', 'sqrt(F L)' or '', and the units that a case names for them.
module amontons_listing_text
   use amontons_kinds, only: dp
   use amontons_text, only: n_characters, newline, to_short_text
   implicit none (type, external)
   private

   public :: columns, flush_right, heading, labeled, pair_text, place_text, scientific, short_text, unit_of, with_unit

contains

   !> A heading with the line above it empty.
   pure function heading(title) result(text)
      character(*), intent(in) :: title !! the title
      character(:), allocatable :: text

      text = newline//title//newline//repeat('-', n_characters(title))//newline
   end function heading

   !> A line of the listing: a label and what belongs to it.
   pure function labeled(label, value) result(text)
      character(*), intent(in) :: label !! the label
      character(*), intent(in) :: value !! what belongs to it
      character(:), allocatable :: text
      character(20) :: column

      column = label
      text = '  '//trim(column//value)//newline
   end function labeled

   !> Two numbers with at most seven digits.
   pure function pair_text(values) result(text)
      real(dp), intent(in) :: values(2) !! the numbers
      character(:), allocatable :: text

      text = '('//place_text(values)//')'
   end function pair_text

   !> Coordinates, for reading, without brackets around them.
   pure function place_text(position) result(text)
      real(dp), intent(in) :: position(2) !! the coordinates [L]
      character(:), allocatable :: text

      text = short_text(position(1))//', '//short_text(position(2))
   end function place_text

   !> A number with at most seven digits, for reading.
   pure function short_text(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_short_text(value, 7)
   end function short_text

   !> A number with at most three digits, for what matters by its size alone.
   pure function scientific(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_short_text(value, 3)
   end function scientific

   !> Numbers with at most six digits, each at the right end of a column or, if it needs it, of a wider one.
   pure function columns(values, width) result(text)
      real(dp), intent(in) :: values(:) !! the numbers
      integer, intent(in) :: width !! width of a column
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(values)
         text = text//flush_right(' '//to_short_text(values(i), 6), width)
      end do
   end function columns

   !> A text moved to the right end of a column.
   pure function flush_right(value, width) result(text)
      character(*), intent(in) :: value !! the text
      integer, intent(in) :: width !! width of the column
      character(:), allocatable :: text

      text = repeat(' ', max(0, width - n_characters(value)))//value
   end function flush_right

   !> The unit of a dimension; empty where the case names no units or the number has no dimension.
   pure function unit_of(units, dimension) result(unit)
      character(*), intent(in) :: units !! names of the units of length, force and, perhaps, stress: 'mm, N, MPa'
      character(*), intent(in) :: dimension !! the dimension
      character(:), allocatable :: unit
      integer :: first, last, i

      unit = ''
      if (len_trim(units) == 0) return
      first = index(units, ',')
      last = index(units, ',', back=.true.)
      if (dimension == 'F/L^2' .and. last > first) then
         unit = trim(adjustl(units(last + 1:)))
         return
      end if
      if (last == first) last = len(units) + 1
      do i = 1, len_trim(dimension)
         select case (dimension(i:i))
         case ('L')
            unit = unit//trim(adjustl(units(:first - 1)))
         case ('F')
            unit = unit//trim(adjustl(units(first + 1:last - 1)))
         case default
            unit = unit//dimension(i:i)
         end select
      end do
   end function unit_of

   !> A text with the unit of its number behind it, a blank between them; without a unit the text alone.
   pure function with_unit(text, units, dimension) result(labeled)
      character(*), intent(in) :: text !! the text
      character(*), intent(in) :: units !! names of the units of a case
      character(*), intent(in) :: dimension !! the dimension of the number
      character(:), allocatable :: labeled

      labeled = trim(text//' '//unit_of(units, dimension))
   end function with_unit

end module amontons_listing_text
