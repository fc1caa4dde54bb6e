!> What numbers are measured in: dimensions, written in length L and force F as 'L', 'F/L^2', 'F L', 'sqrt(F L)' or '',
!> and the units that a case names for them.
module amontons_units
   implicit none (type, external)
   private

   public :: unit_of, with_unit

contains

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

end module amontons_units
