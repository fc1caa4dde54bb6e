!> The contact law at one point: unilateral contact and Coulomb friction.
!>
!> With the distance w = u_N - d (negative while open), the slip s = u_T - a, the forces lambda_N (compression positive)
!> and lambda_T (along the slip), and the slip bound b = g + phi lambda_N, of a given part (Tresca) and Coulomb's:
!> `0 <= lambda_N _|_ -w >= 0`, `|lambda_T| <= b`, `s /= 0 => lambda_T = b sign(s)`.
!> For a given bound this is the inequality (2.2) of the paper, and the maximum over the multipliers in its saddle point
!> (P3); Coulomb's part makes b depend on the solution (its remark 1 on section 1).
module amontons_friction_law
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: bounded, contact_status, law_violation, open_point, slip_minus, slip_plus, status_names, &
      stick_point

   !> Status of a point that is away from the obstacle.
   integer, parameter :: open_point = 1
   !> Status of a closed point that does not slide.
   integer, parameter :: stick_point = 2
   !> Status of a closed point that slides along +t.
   integer, parameter :: slip_plus = 3
   !> Status of a closed point that slides along -t.
   integer, parameter :: slip_minus = 4
   !> Names of the statuses, as the result files write them.
   character(5), parameter :: status_names(4) = [character(5) :: 'open', 'stick', 'slip+', 'slip-']

contains

   !> A value cut to the interval [-bound, bound].
   elemental real(dp) function bounded(value, bound)
      real(dp), intent(in) :: value !! the value
      real(dp), intent(in) :: bound !! half width of the interval, at least 0

      bounded = min(max(value, -bound), bound)
   end function bounded

   !> Status of a point from its augmented forces force + stiffness * displacement, as in Alart and Curnier's
   !> formulation: which bound of the law is active.
   elemental integer function contact_status(augmented_normal, augmented_tangential, friction, slip_bound) &
      result(status)
      real(dp), intent(in) :: augmented_normal !! lambda_N + rho (u_N - d) [F]
      real(dp), intent(in) :: augmented_tangential !! lambda_T + rho s [F]
      real(dp), intent(in) :: friction !! Coulomb coefficient phi [-]
      real(dp), intent(in) :: slip_bound !! given slip bound g [F]

      if (.not. augmented_normal > 0.0_dp) then
         status = open_point
      else if (augmented_tangential > slip_bound + friction*augmented_normal) then
         status = slip_plus
      else if (augmented_tangential < -slip_bound - friction*augmented_normal) then
         status = slip_minus
      else
         status = stick_point
      end if
   end function contact_status

   !> How far a point is from fulfilling the law: the larger of
   !> |lambda_N - max(0, lambda_N + rho_N w)| and
   !> |lambda_T - bounded(lambda_T + rho_T s, g + phi max(0, lambda_N))| [F].
   elemental real(dp) function law_violation(normal_force, distance, tangential_force, slip, friction, slip_bound, &
      rho_normal, rho_tangential) result(violation)
      real(dp), intent(in) :: normal_force !! lambda_N [F]
      real(dp), intent(in) :: distance !! w = u_N - d [L]
      real(dp), intent(in) :: tangential_force !! lambda_T [F]
      real(dp), intent(in) :: slip !! s = u_T - a [L]
      real(dp), intent(in) :: friction !! Coulomb coefficient phi [-]
      real(dp), intent(in) :: slip_bound !! given slip bound g [F]
      real(dp), intent(in) :: rho_normal !! stiffness that turns the distance into a force, positive [F/L]
      real(dp), intent(in) :: rho_tangential !! stiffness that turns the slip into a force, positive [F/L]
      real(dp) :: bound

      bound = slip_bound + friction*max(0.0_dp, normal_force)
      ! The differences above, written so that a large force does not swallow a small distance or slip by rounding.
      violation = max(abs(min(normal_force, -rho_normal*distance)), &
         abs(max(min(-rho_tangential*slip, tangential_force + bound), tangential_force - bound)))
   end function law_violation

end module amontons_friction_law
