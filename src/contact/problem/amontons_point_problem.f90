!> The contact problem of a single point, solved exactly by looking at each status in turn.
!>
!> With the compliance W = [w_nn w_nt; w_nt w_tt] and the distance and slip c that the point has without its force x,
!> distance and slip are c - W x. W may be semidefinite, and there may be several solutions or none.
module amontons_point_problem
   use amontons_friction_law, only: bounded, law_violation
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: solve_point

contains

   !> The force that fulfils the contact law best; of several that do, the one next to a given force.
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

end module amontons_point_problem
