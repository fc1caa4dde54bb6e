!> The check of a solved reduced problem: every condition of the contact law, contact by contact, on W as it was read.
module amontons_reduced_check
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t
   use amontons_reduced_system, only: reduced_system_t
   implicit none (type, external)
   private

   public :: new_reduced_check, reduced_check_t

   !> Violations, each over its natural scale: displacements over the largest of u and q, forces over the largest r.
   type :: reduced_check_t
      real(dp) :: penetration = 0.0_dp !! largest -u_N [-]
      real(dp) :: tension = 0.0_dp !! largest -r_N [-]
      real(dp) :: friction_excess = 0.0_dp !! largest |r_T| - mu r_N [-]
      real(dp) :: complementarity = 0.0_dp !! largest smaller one of u_N and r_N [-]
      real(dp) :: slip_below_bound = 0.0_dp !! largest smaller one of |u_T| and mu r_N - |r_T| [-]
      real(dp) :: wrong_dissipation = 0.0_dp !! largest smaller one of |u_T| and |r_T| where r_T does not oppose u_T [-]
   contains
      procedure :: largest => reduced_check_largest
      procedure :: violations => reduced_check_violations
   end type reduced_check_t

contains

   !> Checks the solution of a reduced problem.
   pure subroutine new_reduced_check(check, system)
      type(reduced_check_t), intent(out) :: check !! the violations
      type(reduced_system_t), intent(in) :: system !! the reduced problem and its solution
      real(dp) :: length, force

      if (system%n_contacts == 0) return
      length = max(maxval(abs(system%u)), maxval(abs(system%q)))
      force = maxval(abs(system%r))
      associate (gap => relative(system%u(1::2), length), slip => relative(system%u(2::2), length), &
         normal => relative(system%r(1::2), force), tangential => relative(system%r(2::2), force))
         check%penetration = maxval(max(0.0_dp, -gap))
         check%tension = maxval(max(0.0_dp, -normal))
         check%friction_excess = maxval(max(0.0_dp, abs(tangential) - system%friction*max(0.0_dp, normal)))
         check%complementarity = maxval(max(0.0_dp, min(gap, normal)))
         check%slip_below_bound = maxval(max(0.0_dp, min(abs(slip), system%friction*normal - abs(tangential))))
         check%wrong_dissipation = maxval(merge(min(abs(slip), abs(tangential)), 0.0_dp, &
            slip*sign(1.0_dp, tangential) > 0.0_dp))
      end associate
   end subroutine new_reduced_check

   !> A ratio; 0 where there is nothing to compare with.
   elemental real(dp) function relative(value, scale)
      real(dp), intent(in) :: value !! the value
      real(dp), intent(in) :: scale !! what to divide by, at least 0

      relative = 0.0_dp
      if (scale > 0.0_dp) relative = value/scale
   end function relative

   !> The violations: what must stay below a limit [-].
   pure function reduced_check_violations(self) result(list)
      class(reduced_check_t), intent(in) :: self !! the check
      type(quantity_t), allocatable :: list(:)

      list = [quantity_t('penetration', 'Penetration', self%penetration, 1.0_dp), &
         quantity_t('tension', 'Tension', self%tension, 1.0_dp), &
         quantity_t('friction_excess', 'Friction excess', self%friction_excess, 1.0_dp), &
         quantity_t('complementarity', 'Complementarity', self%complementarity, 1.0_dp), &
         quantity_t('slip_below_bound', 'Slip below bound', self%slip_below_bound, 1.0_dp), &
         quantity_t('wrong_dissipation', 'Wrong dissipation', self%wrong_dissipation, 1.0_dp)]
   end function reduced_check_violations

   !> The largest of the violations [-].
   pure real(dp) function reduced_check_largest(self) result(largest)
      class(reduced_check_t), intent(in) :: self !! the check
      type(quantity_t), allocatable :: list(:)

      list = self%violations()
      largest = maxval(list%value)
   end function reduced_check_largest

end module amontons_reduced_check
