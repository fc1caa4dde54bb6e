!> Projected successive over-relaxation: point by point, the normal component and then the tangential one, each cut to
!> its bound on the spot, with the slip bound phi lambda_N of the moment. omega = 1 is projected Gauss-Seidel.
module amontons_psor
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: bounded
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: psor_t, space_names

   !> The spaces that sweeps can be done in, as a deck writes them.
   character(6), parameter :: space_names(2) = [character(6) :: 'dual', 'primal']

   !> Projected SOR in the forces (`dual`, on A) or in the displacements (`primal`, on S).
   type, extends(contact_method_t) :: psor_t
      real(dp) :: omega = 1.0_dp !! relaxation, above 0 and below 2 [-]
      character(6) :: space = 'dual' !! 'dual' or 'primal'
   contains
      procedure :: solve => psor_solve
   end type psor_t

contains

   !> Sweeps until the residual is small.
   subroutine psor_solve(self, problem, solution, error)
      class(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(inout) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite (dual sweeps)

      call solution%begin()
      if (self%space == 'dual') then
         call problem%prepare_compliance(error)
         if (allocated(error)) return
         call iterate_dual(self, problem, solution)
      else
         call iterate_primal(self, problem, solution)
      end if
   end subroutine psor_solve

   !> Sweeps in the forces. For a body that only contact holds, each sweep is followed by a proximal step.
   pure subroutine iterate_dual(self, problem, solution)
      type(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      type(contact_solution_t), intent(inout) :: solution !! start and result
      real(dp) :: force(2*problem%n_points), b(2*problem%n_points), rho(2*problem%n_points)
      integer :: sweep
      logical :: may_continue

      force = solution%force
      rho = problem%compliance%reciprocal_diagonal()
      b = problem%dual_load(solution%displacement)
      do sweep = 1, self%max_iterations
         call sweep_forces(problem, b, self%omega, rho, force)
         call solution%record(problem, problem%displacement(b, force), force, self%tolerance, may_continue)
         if (.not. may_continue) return
         if (.not. problem%is_held) b = problem%dual_load(solution%displacement)
      end do
   end subroutine iterate_dual

   !> One sweep over the forces of all points: w = B - A lambda is the distance (normal) or the slip (tangential).
   pure subroutine sweep_forces(problem, b, omega, rho, force)
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: b(:) !! dual load B (2m) [L]
      real(dp), intent(in) :: omega !! relaxation [-]
      real(dp), intent(in) :: rho(:) !! reciprocal diagonal of A (2m) [F/L]
      real(dp), intent(inout) :: force(:) !! lambda (2m) [F]
      integer :: n, t

      associate (a => problem%compliance)
         do n = 1, problem%n_points
            t = n + problem%n_points
            force(n) = max(0.0_dp, force(n) + omega*rho(n)*(b(n) - a%column_product(n, force)))
            force(t) = bounded(force(t) + omega*rho(t)*(b(t) - a%column_product(t, force)), &
               problem%slip_bound(n) + problem%friction(n)*force(n))
         end do
      end associate
   end subroutine sweep_forces

   !> Sweeps in the displacements (Raous's form): no inverse is needed, and a body that only contact holds is as good
   !> as any other.
   pure subroutine iterate_primal(self, problem, solution)
      type(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      real(dp) :: displacement(2*problem%n_points), force(2*problem%n_points)
      integer :: sweep
      logical :: may_continue

      displacement = solution%displacement
      displacement(:problem%n_points) = min(displacement(:problem%n_points), problem%gap)
      do sweep = 1, self%max_iterations
         call sweep_displacements(problem, self%omega, displacement)
         force = contact_forces(problem, displacement)
         call solution%record(problem, displacement, force, self%tolerance, may_continue)
         if (.not. may_continue) return
      end do
   end subroutine iterate_primal

   !> One sweep over the displacements of all points: the normal one is cut at the gap, the tangential one is shrunk by
   !> what friction holds.
   pure subroutine sweep_displacements(problem, omega, v)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: omega !! relaxation [-]
      real(dp), intent(inout) :: v(:) !! displacements (2m) [L]
      real(dp) :: force, bound, step
      integer :: n, t

      associate (s => problem%stiffness, q => problem%load)
         do n = 1, problem%n_points
            t = n + problem%n_points
            force = q(n) - dot_product(s(:, n), v)
            step = min(v(n) + omega*force/s(n, n), problem%gap(n)) - v(n)
            v(n) = v(n) + step
            bound = problem%slip_bound(n)
            if (.not. v(n) < problem%gap(n)) bound = bound + problem%friction(n)*max(0.0_dp, force - s(n, n)*step)
            force = q(t) - dot_product(s(:, t), v)
            v(t) = shrunk(v(t) + omega*force/s(t, t), omega*bound/s(t, t))
         end do
      end associate
   end subroutine sweep_displacements

   !> A value moved towards zero by a distance, at most to zero itself.
   pure real(dp) function shrunk(value, distance)
      real(dp), intent(in) :: value !! the value
      real(dp), intent(in) :: distance !! how far, at least 0

      shrunk = sign(max(0.0_dp, abs(value) - distance), value)
   end function shrunk

   !> The forces lambda = q - S v of given displacements, cut to the contact law (2m) [F].
   pure function contact_forces(problem, displacement) result(force)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: displacement(:) !! v (2m) [L]
      real(dp) :: force(2*problem%n_points)
      integer :: m

      m = problem%n_points
      force = problem%load - matmul(problem%stiffness, displacement)
      force(:m) = merge(0.0_dp, max(0.0_dp, force(:m)), displacement(:m) < problem%gap)
      force(m + 1:) = bounded(force(m + 1:), problem%bound(force(:m)))
   end function contact_forces

end module amontons_psor
