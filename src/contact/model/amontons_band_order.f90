!> The choice between a dense condensed stiffness and a band matrix of the whole body, and the order of that band.
module amontons_band_order
   use amontons_contact_zone, only: contact_zone_t
   use amontons_kinds, only: dp
   use amontons_sparse_matrix, only: half_bandwidth, reverse_cuthill_mckee, sparse_matrix_t
   implicit none (type, external)
   private

   public :: find_band_order, may_suit_band

   !> How many times slower an operation on a band is than one on a dense matrix; a round number.
   real(dp), parameter :: slowness = 50.0_dp

contains

   !> Finds an order that makes K a narrow band, if S should stay a band matrix of the whole body: asked for, or quicker
   !> by far in Newton's method. A step takes about 4 n w^2 operations of n rows of half width w, against 2/3 m^3 faster
   !> ones, or a few times as many, with a dense S; w is about the number of unknowns that there are for each point, or
   !> more. Of few points the bound of friction is to be found, which takes a dense S anyway; a cell of constant
   !> multipliers has no place in a band.
   pure subroutine find_band_order(matrix, form, zone, order)
      type(sparse_matrix_t), intent(in) :: matrix !! K [F/L]
      character(*), intent(in) :: form !! which form of S, one of `condensation_names`
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, allocatable, intent(out) :: order(:) !! position k holds unknown order(k); allocated if it suits (n)

      if (.not. may_suit_band(matrix%n, form, zone)) return
      allocate (order(matrix%n))
      call reverse_cuthill_mckee(matrix, 0, order)
      if (form == 'band') return
      associate (half_width => real(half_bandwidth(matrix, order), dp))
         if (slowness*matrix%n*half_width**2 > real(zone%n_points, dp)**3) deallocate (order)
      end associate
   end subroutine find_band_order

   !> Whether the number of unknowns leaves it possible that a band suits.
   pure logical function may_suit_band(n_unknowns, form, zone)
      integer, intent(in) :: n_unknowns !! number of unknowns
      character(*), intent(in) :: form !! which form of S, one of `condensation_names`
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, parameter :: least_points = 501

      may_suit_band = form /= 'dense' .and. zone%is_nodal
      associate (n => real(n_unknowns, dp), m => real(zone%n_points, dp))
         if (form == 'auto') may_suit_band = may_suit_band .and. zone%n_points >= least_points &
            .and. .not. slowness*n*(n/m)**2 > m**3
      end associate
   end function may_suit_band

end module amontons_band_order
