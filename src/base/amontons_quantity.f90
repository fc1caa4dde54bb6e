!> A number of a result with its names in files and in listings; and the largest of a number over cases or steps.
module amontons_quantity
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: at_place, expanded, largest_t, longest_key, quantity_t, relative, scales, value_of

   !> Largest length of a key: the key of a force contains the name of its set.
   integer, parameter :: longest_key = 96

   !> A named number and the position where it occurs. Writers and verification go through lists of these, so that a new
   !> number is named in one place.
   type :: quantity_t
      character(longest_key) :: key = '' !! its name in files
      character(longest_key) :: label = '' !! its name in listings
      real(dp) :: value = 0.0_dp !! the number
      real(dp) :: scale = 0.0_dp !! scale of its rounding errors, if larger than the number itself
      real(dp) :: resolution = 0.0_dp !! share of a side that it is known to: 1 for a length from node to node [-]
      character(9) :: dimension = '' !! its dimension, as `unit_of` takes it
      integer :: n_dim = 0 !! number of coordinates of the place that it is found at; 0 without one
      real(dp) :: place(3) = 0.0_dp !! the place; in files KEY_x, KEY_y and, in space, KEY_z [L]
   end type quantity_t

   !> The largest value of a number over cases or steps.
   type :: largest_t
      real(dp) :: value = 0.0_dp !! the largest, or a bound below it
      integer :: at = 0 !! the first case or step that has it; 0 where none is above the bound
   contains
      procedure :: update => largest_update
   end type largest_t

contains

   !> Updates the largest value with that of further cases or steps.
   elemental subroutine largest_update(self, value, at)
      class(largest_t), intent(inout) :: self !! the largest so far
      real(dp), intent(in) :: value !! the value
      integer, intent(in) :: at !! the first case or step that has it

      if (.not. value > self%value) return
      self%value = value
      self%at = at
   end subroutine largest_update

   !> Makes a quantity that occurs at a position.
   pure function at_place(key, label, value, place, scale, dimension) result(quantity)
      character(*), intent(in) :: key !! its name in files
      character(*), intent(in) :: label !! its name in listings
      real(dp), intent(in) :: value !! the number
      real(dp), intent(in) :: place(:) !! the place (n_dim) [L]
      real(dp), intent(in) :: scale !! scale of its rounding errors
      character(*), intent(in) :: dimension !! its dimension
      type(quantity_t) :: quantity

      quantity = quantity_t(key, label, value, scale, dimension=dimension, n_dim=size(place))
      quantity%place(:size(place)) = place
   end function at_place

   !> A number over its scale; 0 where the scale is 0.
   elemental real(dp) function relative(value, scale)
      real(dp), intent(in) :: value !! the number
      real(dp), intent(in) :: scale !! its scale, at least 0

      relative = 0.0_dp
      if (scale > 0.0_dp) relative = value/scale
   end function relative

   !> Quantities in the order of the files: all of them, then the coordinates of their positions.
   pure function expanded(list) result(all)
      type(quantity_t), intent(in) :: list(:) !! the quantities
      type(quantity_t), allocatable :: all(:)
      character, parameter :: axes(3) = ['x', 'y', 'z']
      integer :: i, k, n

      n = size(list)
      allocate (all(n + sum(list%n_dim)))
      all(:n) = list
      do i = 1, size(list)
         do k = 1, list(i)%n_dim
            n = n + 1
            all(n)%key = trim(list(i)%key)//'_'//axes(k)
            all(n)%value = list(i)%place(k)
         end do
      end do
   end function expanded

   !> Scales of the rounding errors of quantities, and of the coordinates of their places, in the order of `expanded`.
   pure function scales(list)
      type(quantity_t), intent(in) :: list(:) !! the quantities
      real(dp), allocatable :: scales(:)
      type(quantity_t), allocatable :: all(:)

      all = expanded(list)
      scales = all%scale
   end function scales

   !> The value of the quantity that has a name; 0 if none has.
   pure real(dp) function value_of(list, key)
      type(quantity_t), intent(in) :: list(:) !! the quantities
      character(*), intent(in) :: key !! the name in files
      integer :: i

      value_of = 0.0_dp
      do i = 1, size(list)
         if (list(i)%key == key) value_of = list(i)%value
      end do
   end function value_of

end module amontons_quantity
