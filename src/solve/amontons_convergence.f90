!> How a number of a result changes from mesh to mesh: observed order, extrapolated value and error bar.
!>
!> The bar is the grid convergence index of Roache (J. Fluids Eng. 116, 1994; ASME V&V 20) with his factors of safety,
!> not as a ratio: 1.25 where three meshes show an order of convergence, 3 where they do not.
module amontons_convergence
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t
   implicit none (type, external)
   private

   public :: convergence_t, has_bar, has_limit, new_convergence, refined_quantity_t, verdict_names

   !> What the values on the last three meshes do.
   character(11), parameter :: verdict_names(*) = [character(11) :: 'converging', 'slow', 'oscillating', 'diverging', &
      'unchanged', 'absent']
   integer, parameter :: converging = 1, slow = 2, oscillating = 3, diverging = 4, unchanged = 5, absent = 6

   !> A number on meshes of which each halves the sides of the one before.
   type :: convergence_t
      real(dp), allocatable :: value(:) !! its values, on the coarsest mesh first
      integer :: verdict = unchanged !! place in `verdict_names`
      real(dp) :: order = 0.0_dp !! observed order of convergence; 0 where there is none [-]
      real(dp) :: extrapolated = 0.0_dp !! Richardson's extrapolation; the last value where there is no order
      real(dp) :: bar = 0.0_dp !! half width of the error bar around the last value, if it has one, see `has_bar`
   end type convergence_t

   !> A number of a result on refined meshes.
   type :: refined_quantity_t
      type(quantity_t) :: quantity !! the number on the finest mesh
      type(convergence_t) :: convergence !! how it got there
   end type refined_quantity_t

contains

   !> Judges the last three of the values of a number.
   !>
   !> Differences of mesh to mesh that fall by 2^p have the order p. The bar believes no order above 1, that of the
   !> stresses at the end of a contact: where an end lies between two nodes makes a small last difference a matter of
   !> chance, and the one before it counts besides. An order below 0.5 is that of a singular solution: the number may
   !> have no limit. What a mesh cannot resolve, a length between nodes, moves by no less than a side; the bar is not
   !> smaller. A size that is rounding on all three meshes, as a slip where no point slips, says nothing of what a finer
   !> mesh shows: it is absent and has no bar. A sum that cancels, as a force across an axis of symmetry, is unchanged.
   pure subroutine new_convergence(convergence, value, resolution, rounding, is_size)
      type(convergence_t), intent(out) :: convergence !! the judgment
      real(dp), intent(in) :: value(:) !! the values, three at the least, the coarsest mesh first
      real(dp), intent(in) :: resolution !! the smallest change that the last mesh can show; 0 if it shows any
      real(dp), intent(in) :: rounding !! change that is rounding
      logical, intent(in) :: is_size !! whether it is a length or a largest value, of what a mesh may not show
      real(dp), parameter :: least_order = 0.5_dp, most_order = 1.0_dp
      real(dp), parameter :: safety = 1.25_dp, large_safety = 3.0_dp
      real(dp) :: before, last

      convergence%value = value
      convergence%extrapolated = value(size(value))
      before = value(size(value) - 1) - value(size(value) - 2)
      last = value(size(value)) - value(size(value) - 1)
      convergence%verdict = verdict(before, last, rounding)
      if (is_size .and. all(abs(value(size(value) - 2:)) <= rounding)) convergence%verdict = absent
      select case (convergence%verdict)
      case (absent)
         return
      case (unchanged)
         convergence%bar = max(abs(before), rounding)
      case (oscillating)
         convergence%bar = max(abs(before), large_safety*abs(last))
      case (diverging)
         convergence%bar = large_safety*max(abs(before), abs(last))/(2.0_dp**least_order - 1.0_dp)
      case default
         convergence%order = log(before/last)/log(2.0_dp)
         convergence%extrapolated = value(size(value)) + last/(2.0_dp**convergence%order - 1.0_dp)
         if (convergence%order < least_order) then
            convergence%verdict = slow
            convergence%bar = large_safety*abs(last)/(2.0_dp**convergence%order - 1.0_dp)
         else
            convergence%bar = safety*max(abs(last), abs(before)/2.0_dp**most_order) &
               /(2.0_dp**min(convergence%order, most_order) - 1.0_dp)
         end if
      end select
      convergence%bar = max(convergence%bar, resolution)
   end subroutine new_convergence

   !> Whether there is an error bar.
   elemental logical function has_bar(convergence)
      type(convergence_t), intent(in) :: convergence !! the judgment

      has_bar = convergence%verdict /= absent
   end function has_bar

   !> Whether the number seems to have a limit.
   elemental logical function has_limit(convergence)
      type(convergence_t), intent(in) :: convergence !! the judgment

      has_limit = convergence%verdict /= slow .and. convergence%verdict /= diverging
   end function has_limit

   !> What two changes one after the other mean; slow convergence counts as convergence.
   pure integer function verdict(before, last, rounding)
      real(dp), intent(in) :: before !! change from the last mesh but two to the last but one
      real(dp), intent(in) :: last !! change from the last mesh but one to the last
      real(dp), intent(in) :: rounding !! change that is rounding

      if (abs(last) <= rounding) then
         verdict = unchanged
      else if (before*last < 0.0_dp .and. abs(before) > rounding) then
         verdict = oscillating
      else if (abs(last) >= abs(before)) then
         verdict = diverging
      else
         verdict = converging
      end if
   end function verdict

end module amontons_convergence
