!> A quantity along a contact line: constant, linear in the coordinates, or given by a table over the length.
module amontons_line_field
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: line_field_t

   !> A quantity along a contact line.
   type :: line_field_t
      real(dp) :: value = 0.0_dp !! its value at the origin of the coordinates; everywhere if nothing else is set
      real(dp) :: slope(2) = 0.0_dp !! its change along x and y [per L]
      real(dp), allocatable :: table(:, :) !! arc lengths and values, the arc lengths ascending (2, entries) [L, any]
      character(:), allocatable :: file !! the file of the table; empty or not allocated without one
   contains
      procedure :: at => line_field_at
      procedure :: vanishes => line_field_vanishes
   end type line_field_t

contains

   !> Whether the quantity is 0 everywhere.
   pure logical function line_field_vanishes(self) result(vanishes)
      class(line_field_t), intent(in) :: self !! the quantity

      vanishes = .not. (abs(self%value) > 0.0_dp .or. any(abs(self%slope) > 0.0_dp) .or. allocated(self%table))
   end function line_field_vanishes

   !> The quantity at a point of the line; a table is interpolated, and constant beyond its ends.
   pure real(dp) function line_field_at(self, position, arc_length) result(value)
      class(line_field_t), intent(in) :: self !! the quantity
      real(dp), intent(in) :: position(2) !! coordinates of the point [L]
      real(dp), intent(in) :: arc_length !! length along the line from its first node [L]
      real(dp) :: share
      integer :: i

      value = self%value + dot_product(self%slope, position)
      if (.not. allocated(self%table)) return
      associate (arc_lengths => self%table(1, :), values => self%table(2, :))
         i = count(arc_lengths <= arc_length)
         if (i == 0) then
            value = values(1)
         else if (i == size(values)) then
            value = values(i)
         else
            share = (arc_length - arc_lengths(i))/(arc_lengths(i + 1) - arc_lengths(i))
            value = values(i) + share*(values(i + 1) - values(i))
         end if
      end associate
   end function line_field_at

end module amontons_line_field
