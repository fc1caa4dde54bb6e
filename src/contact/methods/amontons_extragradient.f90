!> Extragradient method (Korpelevich, Matecon 12, 1976) with Khobotov's adaptive step (USSR Comput. Math. Math. Phys.
!> 27, 1987) on the dual problem in De Saxce's form (De Saxce and Feng, Math. Comput. Modelling 28, 1998): no
!> factorization, two products with A an iteration.
!>
!> With distance and slip w = B - A lambda and the set C of forces with lambda_N >= 0, |lambda_T| <= g + phi lambda_N,
!> the contact law says that w - (phi |w_T|; 0) is normal to C at lambda. An iteration goes from lambda along that
!> vector to a trial point of C, and then from lambda along the vector found there. Components are scaled to a unit
!> diagonal of A, so that no unit matters.
module amontons_extragradient
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, dual_method_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: cut_to_bound, tangential_norm
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: extragradient_t

   !> The extragradient method.
   type, extends(dual_method_t) :: extragradient_t
   contains
      procedure :: solve => extragradient_solve
   end type extragradient_t

contains

   !> Iterates until the residual is small. The residual of the method, which needs no further product, is checked by
   !> the independent one where it is small enough, and at the end.
   subroutine extragradient_solve(self, problem, solution, error)
      class(extragradient_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite
      ! How fast the vector may change along a step, over the step, and what the step is multiplied by beyond.
      real(dp), parameter :: too_fast = 0.9_dp, slow = 0.4_dp, shorter = 2.0_dp/3.0_dp
      real(dp), dimension(problem%matrix%n) :: force, displacement, center, b, rho, trial, vector, trial_vector
      real(dp) :: step, rate, residual, scale
      integer :: iteration
      logical :: may_continue

      call solution%reset()
      call solution%effort%factorize(.not. allocated(problem%matrix%compliance))
      call self%prepare(problem, error)
      if (allocated(error)) return
      rho = problem%matrix%compliance%reciprocal_diagonal()
      scale = problem%force_scale()
      center = solution%displacement
      b = problem%dual_load(center)
      force = projection(problem, rho, solution%force)
      displacement = problem%displacement(b, force)
      call solution%effort%multiply(2.0_dp)
      step = 1.0_dp
      do iteration = 1, self%max_iterations
         ! To a trial point, as far as the vector found there is near that at the start, and then along it.
         vector = driving_vector(problem, displacement)
         do
            trial = projection(problem, rho, force + step*rho*vector)
            trial_vector = driving_vector(problem, problem%displacement(b, trial))
            call solution%effort%multiply(1.0_dp)
            rate = step*norm2(sqrt(rho)*(trial_vector - vector))/max(norm2((trial - force)/sqrt(rho)), tiny(rate))
            if (.not. rate > too_fast) exit
            step = step*shorter*min(1.0_dp, 1.0_dp/rate)
         end do
         force = projection(problem, rho, force + step*rho*trial_vector)
         if (rate < slow) step = step/shorter
         displacement = problem%displacement(b, force)
         call solution%effort%multiply(1.0_dp)
         residual = max(0.0_dp, problem%matrix%proximal_parameter*maxval(abs(displacement - center)), &
            problem%violation(displacement, force))/scale
         if (residual > self%tolerance .and. residual < huge(residual) .and. iteration < self%max_iterations) then
            call solution%record_residual(residual)
         else
            call solution%record(problem, displacement, force, self%tolerance, may_continue)
            if (.not. may_continue) return
         end if
         if (problem%matrix%is_held) cycle
         ! A body that only contact holds: a proximal step moves the center to the displacement just found.
         center = displacement
         b = problem%dual_load(center)
         displacement = problem%displacement(b, force)
         call solution%effort%multiply(2.0_dp)
      end do
   end subroutine extragradient_solve

   !> The vector that an extragradient step follows: w - (phi |w_T|; 0), w = v - (d; a) (2m) [L].
   pure function driving_vector(problem, displacement) result(vector)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: displacement(:) !! v (2m) [L]
      real(dp) :: vector(size(displacement))
      integer :: m

      m = problem%n_points
      vector = displacement - problem%reference()
      vector(:m) = vector(:m) - problem%friction*tangential_norm(vector(m + 1:), m)
   end function driving_vector

   !> The admissible forces nearest to given ones, in the scaled components (2m) [F].
   pure function projection(problem, rho, force) result(nearest)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: rho(:) !! reciprocal diagonal of A (2m) [F/L]
      real(dp), intent(in) :: force(:) !! (lambda_N; lambda_T) (2m) [F]
      real(dp) :: nearest(size(force))
      real(dp) :: slope, length(problem%n_points)
      integer :: n

      associate (m => problem%n_points)
         length = tangential_norm(force(m + 1:), m)
         nearest(:m) = force(:m)
         do n = 1, m
            associate (friction => problem%friction(n), bound => problem%slip_bound(n))
               if (.not. length(n) > bound + friction*force(n)) cycle
               ! The foot on the edge of the cone, in components over the square roots of rho.
               slope = friction*rho(n)/rho(m + n)
               nearest(n) = (force(n) + slope*(length(n) - bound))/(1.0_dp + slope*friction)
            end associate
         end do
         nearest(:m) = max(0.0_dp, nearest(:m))
         nearest(m + 1:) = cut_to_bound(force(m + 1:), problem%bound(nearest(:m)))
      end associate
   end function projection

end module amontons_extragradient
