!> The contact law at one point: unilateral contact and Coulomb friction.
!>
!> With the distance w = u_N - d (negative while open), the slip s = u_T - a, the forces lambda_N (compression positive)
!> and lambda_T (along the slip), and the slip bound b = g + phi lambda_N, of a given part (Tresca) and Coulomb's:
!> `0 <= lambda_N _|_ -w >= 0`, `|lambda_T| <= b`, `s /= 0 => lambda_T = b sign(s)`.
!> For a given bound this is the inequality (2.2) of the paper, and the maximum over the multipliers in its saddle point
!> (P3); Coulomb's part makes b depend on the solution (its remark 1 on section 1).
!>
!> The problem of a point alone is solved exactly by looking at each status in turn. With the compliance W = [w_nn w_nt;
!> w_nt w_tt] and the distance and slip c that the point has without its force x, distance and slip are c - W x. W may
!> be semidefinite, and there may be several solutions or none.
module amontons_friction_law
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: bounded, contact_status, law_violation, open_point, point_violations, point_violations_t, slip_minus, &
      slip_plus, solve_point, status_names, stick_point

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

   !> How far a point is from the conditions of the law, each by itself.
   type :: point_violations_t
      real(dp) :: penetration = 0.0_dp !! overlap with the obstacle [-]
      real(dp) :: tension = 0.0_dp !! normal force that pulls [-]
      real(dp) :: friction_excess = 0.0_dp !! tangential force above its bound [-]
      real(dp) :: complementarity = 0.0_dp !! smaller one of gap and normal force [-]
      real(dp) :: slip_below_bound = 0.0_dp
         !! smaller one of the slip and what the tangential force lacks to its bound [-]
      real(dp) :: wrong_dissipation = 0.0_dp
         !! smaller one of slip and tangential force where they point in opposite directions [-]
   end type point_violations_t

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

   !> How far a point is from the conditions of the law, lengths over one length and forces over one force.
   elemental function point_violations(gap, slip, normal_force, tangential_force, bound) result(violations)
      real(dp), intent(in) :: gap !! distance to the obstacle, d - u_N [-]
      real(dp), intent(in) :: slip !! u_T - a [-]
      real(dp), intent(in) :: normal_force !! lambda_N [-]
      real(dp), intent(in) :: tangential_force !! lambda_T [-]
      real(dp), intent(in) :: bound !! slip bound g + phi max(0, lambda_N) [-]
      type(point_violations_t) :: violations

      violations%penetration = max(0.0_dp, -gap)
      violations%tension = max(0.0_dp, -normal_force)
      violations%friction_excess = max(0.0_dp, abs(tangential_force) - bound)
      violations%complementarity = max(0.0_dp, min(gap, normal_force))
      violations%slip_below_bound = max(0.0_dp, min(abs(slip), bound - abs(tangential_force)))
      if (sign(1.0_dp, tangential_force)*slip < 0.0_dp) violations%wrong_dissipation = min(abs(slip), &
         abs(tangential_force))
   end function point_violations

   !> The force that fulfills the contact law best; of several that do, the one next to a given force.
   pure function solve_point(w_nn, w_nt, w_tt, free, friction, slip_bound, force) result(best)
      real(dp), intent(in) :: w_nn !! normal compliance, at least 0 [L/F]
      real(dp), intent(in) :: w_nt !! compliance that couples normal and tangent [L/F]
      real(dp), intent(in) :: w_tt !! tangential compliance, at least 0 [L/F]
      real(dp), intent(in) :: free(2) !! distance u_N - d and slip u_T without force [L]
      real(dp), intent(in) :: friction !! Coulomb coefficient phi [-]
      real(dp), intent(in) :: slip_bound !! given slip bound g [F]
      real(dp), intent(in) :: force(2) !! a force (lambda_N, lambda_T) to stay near [F]
      real(dp) :: best(2)
      ! What two evaluations of one solution differ by.
      real(dp), parameter :: rounding = 1.0e-12_dp, singular = 1.0e-14_dp
      integer, parameter :: n_trials = 5
      real(dp) :: trial(2, n_trials), pair(2), rho(2), cost, least, det
      integer :: i

      rho = max(w_nn, w_tt)
      if (.not. rho(1) > 0.0_dp) rho = 1.0_dp
      if (w_nn > 0.0_dp) rho(1) = w_nn
      if (w_tt > 0.0_dp) rho(2) = w_tt
      rho = 1.0_dp/rho
      det = w_nn*w_tt - w_nt**2
      ! One component after the other; open; sliding either way; sticking.
      trial(1, 1) = max(0.0_dp, rho(1)*(free(1) - w_nt*force(2)))
      trial(2, 1) = bounded(rho(2)*(free(2) - w_nt*trial(1, 1)), slip_bound + friction*trial(1, 1))
      trial(1, 2) = 0.0_dp
      trial(2, 2) = bounded(rho(2)*free(2), slip_bound)
      trial(:, 3) = sliding(1.0_dp)
      trial(:, 4) = sliding(-1.0_dp)
      trial(:, 5) = trial(:, 1)
      if (det > singular*w_nn*w_tt) trial(:, 5) = [w_tt*free(1) - w_nt*free(2), w_nn*free(2) - w_nt*free(1)]/det
      least = huge(least)
      best = force
      do i = 1, n_trials
         pair = free - [w_nn*trial(1, i) + w_nt*trial(2, i), w_nt*trial(1, i) + w_tt*trial(2, i)]
         cost = max(law_violation(trial(1, i), pair(1), trial(2, i), pair(2), friction, slip_bound, rho(1), rho(2)), &
            rounding*maxval(abs(trial(:, i) - force)))
         if (.not. cost < least) cycle
         least = cost
         best = trial(:, i)
      end do
      best(1) = max(0.0_dp, best(1))
      best(2) = bounded(best(2), slip_bound + friction*best(1))

   contains

      !> The force of a closed point that slides along a direction; without any if no force is determined.
      pure function sliding(direction) result(pair)
         real(dp), intent(in) :: direction !! 1 or -1
         real(dp) :: pair(2)

         pair(1) = w_nn + direction*friction*w_nt
         if (abs(pair(1)) > singular*w_nn) then
            pair(1) = max(0.0_dp, (free(1) - direction*w_nt*slip_bound)/pair(1))
         else
            pair(1) = 0.0_dp
         end if
         pair(2) = direction*(slip_bound + friction*pair(1))
      end function sliding

   end function solve_point

end module amontons_friction_law
