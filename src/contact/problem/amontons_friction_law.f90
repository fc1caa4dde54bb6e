!> The contact law at one point: unilateral contact and Coulomb friction.
!>
!> With the distance w = u_N - d (negative while open), the slip s = u_T - a, the forces lambda_N (compression positive)
!> and lambda_T (along the slip), and the slip bound b = g + phi lambda_N, of a given part (Tresca) and Coulomb's:
!> `0 <= lambda_N _|_ -w >= 0`, `|lambda_T| <= b`, `s /= 0 => lambda_T = b sign(s)`.
!> For a given bound this is the inequality (2.2) of the paper, and the maximum over the multipliers in its saddle point
!> (P3); Coulomb's part makes b depend on the solution (its remark 1 on section 1).
!>
!> In space slip and lambda_T have two components, and the law says `|lambda_T| <= b`, a disc in the place of the
!> interval, and `s /= 0 => lambda_T = b s/|s|`. It does not depend on the axes.
!>
!> The problem of a point alone is solved exactly by looking at each status in turn. With the compliance W = [w_nn w_nt;
!> w_nt w_tt] and the distance and slip c that the point has without its force x, distance and slip are c - W x. W may
!> be semidefinite, and there may be several solutions or none.
module amontons_friction_law
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t
   use amontons_rounding, only: difference_rounding, sum_rounding
   implicit none (type, external)
   private

   public :: bounded, contact_status, cut_to_bound, disc_violation, law_violation, open_point, point_violations, &
      point_violations_t, slip_minus, slip_plus, slip_point, solve_point, status_names, stick_point, tangential_norm, &
      turned_away

   !> Status of a point that is away from the obstacle.
   integer, parameter :: open_point = 1
   !> Status of a closed point that does not slide.
   integer, parameter :: stick_point = 2
   !> Status of a closed point that slides along +t.
   integer, parameter :: slip_plus = 3
   !> Status of a closed point that slides along -t.
   integer, parameter :: slip_minus = 4
   !> Status of a closed point that slides in space.
   integer, parameter :: slip_point = 5
   !=statuses `open` | away from the obstacle, or touching it without force | 1
   !=statuses `stick` | pressed on the obstacle, not slipping | 2
   !=statuses `slip+` | pressed on the obstacle, slipping along $+t$, friction at its bound | 3
   !=statuses `slip-` | pressed on the obstacle, slipping along $-t$, friction at its bound | 4
   !=statuses `slip` | of a twisted body: slipping along any direction of the surface, friction at its bound | 5
   !> Names of the statuses, as the result files write them.
   character(5), parameter :: status_names(slip_point) = [character(5) :: 'open', 'stick', 'slip+', 'slip-', 'slip']

   !> The largest violations by points of each condition of the law.
   type :: point_violations_t
      real(dp) :: penetration = 0.0_dp !! overlap with the obstacle [-]
      real(dp) :: tension = 0.0_dp !! normal force that pulls [-]
      real(dp) :: friction_excess = 0.0_dp !! tangential force above its bound [-]
      real(dp) :: complementarity = 0.0_dp !! smaller one of gap and normal force [-]
      real(dp) :: slip_below_bound = 0.0_dp
         !! smaller one of the slip and what the tangential force lacks to its bound [-]
      real(dp) :: wrong_dissipation = 0.0_dp
         !! smaller one of what of slip and tangential force is not along the other [-]
   contains
      procedure :: largest => point_violations_largest
      procedure :: violations => point_violations_violations
   end type point_violations_t

contains

   !> A value cut to the interval [-bound, bound].
   elemental real(dp) function bounded(value, bound)
      real(dp), intent(in) :: value !! the value
      real(dp), intent(in) :: bound !! half width of the interval, at least 0

      bounded = min(max(value, -bound), bound)
   end function bounded

   !> The lengths of tangential vectors, of one component or of two (m).
   pure function tangential_norm(vector, n_points) result(norm)
      real(dp), intent(in) :: vector(:) !! the vectors, all first components before the second ones (n_tangents m)
      integer, intent(in) :: n_points !! number m of points
      real(dp) :: norm(n_points)

      if (size(vector) == n_points) then
         norm = abs(vector)
      else
         norm = hypot(vector(:n_points), vector(n_points + 1:))
      end if
   end function tangential_norm

   !> Tangential vectors cut to their bounds, along themselves (n_tangents m).
   pure function cut_to_bound(vector, bound) result(cut)
      real(dp), intent(in) :: vector(:) !! the vectors (n_tangents m)
      real(dp), intent(in) :: bound(:) !! longest that each may be, at least 0 (m)
      real(dp) :: cut(size(vector))
      real(dp) :: share(size(bound))

      if (size(vector) == size(bound)) then
         cut = bounded(vector, bound)
      else
         share = tangential_norm(vector, size(bound))
         share = merge(bound/max(share, tiny(share)), 1.0_dp, share > bound)
         cut = vector*[share, share]
      end if
   end function cut_to_bound

   !> Status of a point from its augmented forces, force + stiffness * displacement, as in Alart and
   !> Curnier's formulation: the active bound of the law.
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

   !> The violation of the law by a point: the larger one of |lambda_N - max(0, lambda_N + rho_N w)| and |lambda_T -
   !> bounded(lambda_T + rho_T s, g + phi max(0, lambda_N))| [F].
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

   !> The violation of the law by the tangential force of a point in space, for a given bound: the length of lambda_T
   !> minus lambda_T + rho_T s cut to the bound [F].
   elemental real(dp) function disc_violation(force, other_force, slip, other_slip, bound, rho) result(violation)
      real(dp), intent(in) :: force !! first component of lambda_T [F]
      real(dp), intent(in) :: other_force !! its second component [F]
      real(dp), intent(in) :: slip !! first component of the slip s [L]
      real(dp), intent(in) :: other_slip !! its second component [L]
      real(dp), intent(in) :: bound !! slip bound [F]
      real(dp), intent(in) :: rho !! stiffness that turns the slip into a force, positive [F/L]
      real(dp) :: length

      length = hypot(force + rho*slip, other_force + rho*other_slip)
      if (length > bound) then
         length = bound/length
         violation = hypot(force - length*(force + rho*slip), other_force - length*(other_force + rho*other_slip))
      else
         violation = rho*hypot(slip, other_slip)
      end if
   end function disc_violation

   !> The largest violations by points of each condition of the law, lengths over a unit of length and forces over a
   !> unit of force; 0 without points.
   pure function point_violations(gap, slip, normal_force, tangential_force, bound) result(violations)
      real(dp), intent(in) :: gap(:) !! distance to the obstacle, d - u_N (m) [-]
      real(dp), intent(in) :: slip(:) !! u_T - a (n_tangents m) [-]
      real(dp), intent(in) :: normal_force(:) !! lambda_N (m) [-]
      real(dp), intent(in) :: tangential_force(:) !! lambda_T (n_tangents m) [-]
      real(dp), intent(in) :: bound(:) !! slip bound g + phi max(0, lambda_N) (m) [-]
      type(point_violations_t) :: violations
      real(dp) :: shear(size(gap))

      shear = tangential_norm(tangential_force, size(gap))
      violations%penetration = max(0.0_dp, maxval(-gap))
      violations%tension = max(0.0_dp, maxval(-normal_force))
      violations%friction_excess = max(0.0_dp, maxval(shear - bound))
      violations%complementarity = max(0.0_dp, maxval(min(gap, normal_force)))
      violations%slip_below_bound = max(0.0_dp, maxval(min(tangential_norm(slip, size(gap)), bound - shear)))
      violations%wrong_dissipation = max(0.0_dp, maxval(min(turned_away(slip, tangential_force, size(gap)), &
         turned_away(tangential_force, slip, size(gap)))))
   end function point_violations

   !> The violations, each over its natural scale; all must be below the limit [-].
   pure function point_violations_violations(self) result(list)
      class(point_violations_t), intent(in) :: self !! the violations
      type(quantity_t), allocatable :: list(:)

      list = [quantity_t('penetration', 'Penetration', self%penetration, 1.0_dp), &
         quantity_t('tension', 'Tension', self%tension, 1.0_dp), &
         quantity_t('friction_excess', 'Friction excess', self%friction_excess, 1.0_dp), &
         quantity_t('complementarity', 'Complementarity', self%complementarity, 1.0_dp), &
         quantity_t('slip_below_bound', 'Slip below bound', self%slip_below_bound, 1.0_dp), &
         quantity_t('wrong_dissipation', 'Wrong dissipation', self%wrong_dissipation, 1.0_dp)]
   end function point_violations_violations

   !> The largest violation of the contact law at a point, of all kinds [-].
   pure real(dp) function point_violations_largest(self) result(largest)
      class(point_violations_t), intent(in) :: self !! the violations
      type(quantity_t), allocatable :: list(:)

      list = self%violations()
      largest = maxval(list%value)
   end function point_violations_largest

   !> Lengths of the parts of tangential vectors, slips or forces, that are not along others: those across them, and
   !> those in the opposite direction (m).
   pure function turned_away(vector, other, n_points) result(length)
      real(dp), intent(in) :: vector(:) !! the vectors, all first components before the second ones (n_tangents m)
      real(dp), intent(in) :: other(:) !! the others, which may be 0 (n_tangents m)
      integer, intent(in) :: n_points !! number m of points
      real(dp) :: length(n_points)
      real(dp), dimension(size(vector)/max(1, n_points)) :: along, axis
      integer :: p

      do p = 1, n_points
         axis = other(p::n_points)/max(norm2(other(p::n_points)), tiny(axis))
         along = vector(p::n_points)
         length(p) = norm2(along - max(0.0_dp, dot_product(along, axis))*axis)
      end do
   end function turned_away

   !> The force on a point that fulfills the contact law best; of several the one nearest to a given force. In the plane
   !> all that belongs to t2 is 0, and a sliding point goes one way or the other; in space the angle of its slip is a
   !> zero of a function of one variable.
   pure function solve_point(w, free, friction, slip_bound, force) result(best)
      real(dp), intent(in) :: w(3, 3) !! compliance in (n, t1, t2), positive semidefinite [L/F]
      real(dp), intent(in) :: free(3) !! distance u_N - d and slip u_T without force [L]
      real(dp), intent(in) :: friction !! Coulomb coefficient phi [-]
      real(dp), intent(in) :: slip_bound !! given slip bound g [F]
      real(dp), intent(in) :: force(3) !! a force (lambda_N, lambda_T) to stay near [F]
      real(dp) :: best(3)
      ! In each of its steps there is at most one zero but where two of them nearly meet.
      real(dp), parameter :: full_turn = 8.0_dp*atan(1.0_dp)
      integer, parameter :: n_steps = 32, most_steps = 60
      real(dp) :: rho(2), coupling(2), alone(2), least, normal, angle, last_angle, value, last
      integer :: i

      rho = [w(1, 1), 0.5_dp*(w(2, 2) + w(3, 3)) + hypot(0.5_dp*(w(2, 2) - w(3, 3)), w(2, 3))]
      rho = 1.0_dp/merge(rho, merge(maxval(rho), 1.0_dp, any(rho > 0.0_dp)), rho > 0.0_dp)
      least = huge(least)
      best = force
      ! One component after the other; open, and held by a given bound; sticking; sliding.
      normal = max(0.0_dp, rho(1)*(free(1) - dot_product(w(1, 2:), force(2:))))
      call keep_better([normal, within(rho(2)*(free(2:) - w(2:, 1)*normal), slip_bound + friction*normal)], best, least)
      coupling = pair_force(w(2:, 1))
      alone = pair_force(free(2:))
      call keep_better([0.0_dp, within(alone, slip_bound)], best, least)
      value = w(1, 1) - dot_product(w(1, 2:), coupling)
      if (value > difference_rounding*w(1, 1)) then
         value = (free(1) - dot_product(w(1, 2:), alone))/value
         call keep_better([value, alone - coupling*value], best, least)
      end if
      if (.not. (w(3, 3) > 0.0_dp .or. abs(free(3)) > 0.0_dp)) then
         call keep_better(sliding([1.0_dp, 0.0_dp]), best, least)
         call keep_better(sliding([-1.0_dp, 0.0_dp]), best, least)
      else if (friction + slip_bound > 0.0_dp) then
         last_angle = 0.0_dp
         last = turning(last_angle)
         do i = 1, n_steps
            angle = full_turn*i/n_steps
            value = turning(angle)
            if (last*value <= 0.0_dp) call keep_better(sliding(axis(zero_between(last_angle, angle, last, value))), &
               best, least)
            last_angle = angle
            last = value
         end do
      end if
      best(1) = max(0.0_dp, best(1))
      best(2:) = within(best(2:), slip_bound + friction*best(1))

   contains

      !> Replaces the best force so far by a trial force if that is better.
      pure subroutine keep_better(trial, best, least)
         real(dp), intent(in) :: trial(3) !! the force [F]
         real(dp), intent(inout) :: best(3) !! the best force so far [F]
         real(dp), intent(inout) :: least !! its violation of the law [F]
         real(dp) :: distance(3), cost

         distance = free - matmul(w, trial)
         cost = max(abs(min(trial(1), -rho(1)*distance(1))), disc_violation(trial(2), trial(3), distance(2), &
            distance(3), slip_bound + friction*max(0.0_dp, trial(1)), rho(2)), sum_rounding*maxval(abs(trial - force)))
         if (.not. cost < least) return
         least = cost
         best = trial
      end subroutine keep_better

      !> A tangential force cut to a bound, along itself [F].
      pure function within(vector, bound) result(cut)
         real(dp), intent(in) :: vector(2) !! the force [F]
         real(dp), intent(in) :: bound !! the bound, at least 0 [F]
         real(dp) :: cut(2)

         cut = vector
         if (hypot(vector(1), vector(2)) > bound) cut = vector*(bound/hypot(vector(1), vector(2)))
      end function within

      !> The tangential force for a given slip; a limited one if the tangential block is singular.
      pure function pair_force(slip) result(pair)
         real(dp), intent(in) :: slip(2) !! the slip [L]
         real(dp) :: pair(2)

         pair = rho(2)*slip
         associate (det => w(2, 2)*w(3, 3) - w(2, 3)*w(3, 2))
            if (det > difference_rounding*w(2, 2)*w(3, 3)) pair = [w(3, 3)*slip(1) - w(2, 3)*slip(2), &
               w(2, 2)*slip(2) - w(3, 2)*slip(1)]/det
         end associate
      end function pair_force

      !> The force on a point that slides along an axis: that of a closed point if it is compressive, otherwise 0.
      pure function sliding(along) result(trial)
         real(dp), intent(in) :: along(2) !! the axis, a unit vector [-]
         real(dp) :: trial(3), projected

         projected = dot_product(w(1, 2:), along)
         trial(1) = 0.0_dp
         if (abs(w(1, 1) + friction*projected) > difference_rounding*w(1, 1)) trial(1) = max(0.0_dp, &
            (free(1) - projected*slip_bound)/(w(1, 1) + friction*projected))
         trial(2:) = (slip_bound + friction*trial(1))*along
      end function sliding

      !> The axis in space at an angle [-].
      pure function axis(angle)
         real(dp), intent(in) :: angle !! the angle [rad]
         real(dp) :: axis(2)

         axis = [cos(angle), sin(angle)]
      end function axis

      !> Component of the slip, under the force along an angle, perpendicular to this direction, positive to its left
      !> [L].
      pure real(dp) function turning(angle)
         real(dp), intent(in) :: angle !! the angle [rad]

         associate (slip => free(2:) - matmul(w(2:, :), sliding(axis(angle))))
            turning = cos(angle)*slip(2) - sin(angle)*slip(1)
         end associate
      end function turning

      !> The angle between two others at which nothing turns, by the secant through values of both signs; the older one
      !> is halved where it stays (Illinois) [rad].
      pure real(dp) function zero_between(from, to, from_value, to_value) result(high)
         real(dp), intent(in) :: from !! one angle [rad]
         real(dp), intent(in) :: to !! the other [rad]
         real(dp), intent(in) :: from_value !! `turning` at the one [L]
         real(dp), intent(in) :: to_value !! `turning` at the other, of another sign [L]
         real(dp) :: low, middle, low_value, high_value, middle_value
         integer :: k

         low = from
         high = to
         low_value = from_value
         high_value = to_value
         do k = 1, most_steps
            if (.not. abs(high_value - low_value) > 0.0_dp) return
            middle = (low*high_value - high*low_value)/(high_value - low_value)
            if (abs(middle - high) <= epsilon(high)*full_turn) return
            middle_value = turning(middle)
            if (middle_value*high_value > 0.0_dp) then
               low_value = 0.5_dp*low_value
            else
               low = high
               low_value = high_value
            end if
            high = middle
            high_value = middle_value
         end do
      end function zero_between

   end function solve_point

end module amontons_friction_law
