!> The check of a solved reduced problem: every condition of the contact law, contact by contact, on W as it was read.
module amontons_reduced_check
   use amontons_kinds, only: dp
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

   !> The largest of the violations [-].
   pure real(dp) function reduced_check_largest(self) result(largest)
      class(reduced_check_t), intent(in) :: self !! the violations

      largest = max(self%penetration, self%tension, self%friction_excess, self%complementarity, self%slip_below_bound, &
         self%wrong_dissipation)
   end function reduced_check_largest

end module amontons_reduced_check
