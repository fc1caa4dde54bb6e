!> Lengths of the open, slip and stick zones of the contact line.
module amontons_lengths
   use amontons_contact_zone, only: contact_zone_t
   use amontons_friction_law, only: open_point, stick_point
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t
   implicit none (type, external)
   private

   public :: lengths_t, new_lengths

   !> Lengths of the three zones; together the length of the sides between contact points, of a pair
   !> where they face the master, and of the cells.
   type :: lengths_t
      real(dp) :: open = 0.0_dp !! where one end of a side at least is open [L]
      real(dp) :: slip = 0.0_dp !! where both ends are closed and one at least slips [L]
      real(dp) :: stick = 0.0_dp !! where both ends stick [L]
   contains
      procedure :: quantities => lengths_quantities
   end type lengths_t

contains

   !> Measures the zones side by side, as Table 1 of the paper reads its separated, sliding and sticking parts: the open
   !> zone ends at the first closed node, the slip zone at the first sticking node. A cell of constant multipliers
   !> belongs to one zone as a whole.
   pure subroutine new_lengths(lengths, zone, status, set)
      type(lengths_t), intent(out) :: lengths !! the lengths
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: status(:) !! status of each point (m)
      integer, intent(in), optional :: set !! the contact set to measure; all of them without it
      real(dp) :: length
      integer :: p, ends(2)

      do p = 1, zone%n_points
         if (present(set)) then
            if (zone%set(p) /= set) cycle
         end if
         ends = p
         if (zone%is_cell(p)) then
            length = zone%weight(p)
         else
            if (zone%next(p) == 0) cycle
            ends(2) = zone%next(p)
            length = norm2(zone%position(:, ends(2)) - zone%position(:, p))*covered_share(zone, p)
         end if
         if (any(status(ends) == open_point)) then
            lengths%open = lengths%open + length
         else if (all(status(ends) == stick_point)) then
            lengths%stick = lengths%stick + length
         else
            lengths%slip = lengths%slip + length
         end if
      end do
   end subroutine new_lengths

   !> The share of the side that follows a contact point that may come into contact: of a pair what faces the master.
   pure real(dp) function covered_share(zone, p)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: p !! number of the point

      covered_share = 1.0_dp
      if (.not. allocated(zone%pairs)) return
      associate (pair => zone%pairs(zone%set(p)))
         if (pair%is_set()) covered_share = pair%covered_share(p - findloc(zone%set, zone%set(p), dim=1) + 1)
      end associate
   end function covered_share

   !> The lengths under their names [L].
   pure function lengths_quantities(self) result(list)
      class(lengths_t), intent(in) :: self !! the lengths
      type(quantity_t) :: list(3)

      list = [quantity_t('open_length', 'Open length', self%open, resolution=1.0_dp, dimension='L'), &
         quantity_t('slip_length', 'Slip length', self%slip, resolution=1.0_dp, dimension='L'), &
         quantity_t('stick_length', 'Stick length', self%stick, resolution=1.0_dp, dimension='L')]
   end function lengths_quantities

end module amontons_lengths
