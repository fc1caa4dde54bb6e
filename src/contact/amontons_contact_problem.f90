!> The contact problem: the small problem on the contact points that everything turns on.
!>
!> The displacements v = (u_N; u_T) of m contact points and the forces lambda = (lambda_N; lambda_T) obey
!> `S v = q - lambda` and the contact law. S is symmetric and positive semidefinite; its kernel are the rigid motions
!> that only contact holds. All vectors list the m normal components first, the m tangential ones after them.
module amontons_contact_problem
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_dense, only: cholesky_factor, cholesky_inverse, symmetric_multiply
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_friction_law, only: contact_status, law_violation
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: contact_problem_t, new_contact_problem

   !> Stiffness, load, gap and friction on the contact points. One stiffness serves many loads.
   type :: contact_problem_t
      integer :: n_points = 0 !! number m of contact points
      logical :: is_held = .true. !! whether the supports alone hold the body, so that S is positive definite
      real(dp), allocatable :: stiffness(:, :) !! condensed stiffness S (2m, 2m) [F/L]
      real(dp), allocatable :: load(:) !! condensed load q (2m) [F]
      real(dp), allocatable :: gap(:) !! initial distance d to the obstacle along the normal (m) [L]
      real(dp), allocatable :: friction(:) !! Coulomb coefficient phi (m) [-]
      real(dp), allocatable :: slip_bound(:) !! given slip bound g, added to phi lambda_N (m) [F]
      real(dp) :: shift = 0.0_dp
         !! alpha of the proximal iteration: 0 for a held body [F/L]
      real(dp), allocatable :: compliance(:, :)
         !! the paper's dual matrix A = (S + alpha I)^-1, made by `prepare_compliance` (2m, 2m) [L/F]
   contains
      procedure :: bound => contact_problem_bound
      procedure :: displacement => contact_problem_displacement
      procedure :: dual_load => contact_problem_dual_load
      procedure :: force_scale => contact_problem_force_scale
      procedure :: prepare_compliance => contact_problem_prepare_compliance
      procedure :: residual => contact_problem_residual
      procedure :: status => contact_problem_status
   end type contact_problem_t

contains

   !> Makes a contact problem without load, gap, friction or slip bound.
   pure subroutine new_contact_problem(problem, stiffness, is_held)
      type(contact_problem_t), intent(out) :: problem !! the problem; set its load, gap and friction next
      real(dp), intent(in) :: stiffness(:, :) !! S (2m, 2m) [F/L]
      logical, intent(in) :: is_held !! whether S is positive definite

      problem%n_points = size(stiffness, 1)/2
      problem%is_held = is_held
      problem%stiffness = stiffness
      allocate (problem%load(2*problem%n_points), problem%gap(problem%n_points), &
         problem%friction(problem%n_points), problem%slip_bound(problem%n_points), source=0.0_dp)
   end subroutine new_contact_problem

   !> The slip bounds g + phi max(0, lambda_N) of given normal forces (m) [F].
   pure function contact_problem_bound(self, normal_force) result(bound)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: normal_force(:) !! lambda_N (m) [F]
      real(dp), allocatable :: bound(:)

      bound = self%slip_bound + self%friction*max(0.0_dp, normal_force)
   end function contact_problem_bound

   !> Makes the dual matrix A = (S + alpha I)^-1 unless it is there already.
   !>
   !> A body that only contact holds has no S^-1: alpha is then a third of the mean diagonal of S shared among the
   !> points, and the methods iterate v_k (see `dual_load`) until the shift has no effect. So the rigid motion, which
   !> all points resist together, is held about as firmly as one point on any mesh: measured on the long bar, less
   !> slows the sweeps and more slows the proximal iteration.
   subroutine contact_problem_prepare_compliance(self, error)
      class(contact_problem_t), intent(inout) :: self !! the problem
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite
      real(dp), parameter :: share = 1.0_dp/3.0_dp
      real(dp), allocatable :: factor(:, :)
      integer :: i, info

      if (allocated(self%compliance)) return
      factor = self%stiffness
      if (.not. self%is_held) then
         self%shift = share*sum([(factor(i, i), i=1, size(factor, 1))])/(size(factor, 1)*self%n_points)
         do i = 1, size(factor, 1)
            factor(i, i) = factor(i, i) + self%shift
         end do
      end if
      call cholesky_factor(factor, info)
      if (info /= 0) then
         call new_error(error, numerical_failure, 'the condensed stiffness of the contact points is not positive '// &
            'definite: the supports do not hold the body, or its stiffness is degenerate')
         return
      end if
      call cholesky_inverse(factor)
      call move_alloc(factor, self%compliance)
   end subroutine contact_problem_prepare_compliance

   !> The paper's dual load B = A (q + alpha v_k) - (d; 0), with the proximal centre v_k (2m) [L].
   pure function contact_problem_dual_load(self, center) result(b)
      class(contact_problem_t), intent(in) :: self !! the problem, its compliance prepared
      real(dp), intent(in) :: center(:) !! v_k; without effect for a held body (2m) [L]
      real(dp), allocatable :: b(:)

      allocate (b(2*self%n_points))
      call symmetric_multiply(self%compliance, self%load + self%shift*center, b)
      b(:self%n_points) = b(:self%n_points) - self%gap
   end function contact_problem_dual_load

   !> The displacements v = B - A lambda + (d; 0) of given forces (2m) [L].
   pure function contact_problem_displacement(self, dual_load, force) result(displacement)
      class(contact_problem_t), intent(in) :: self !! the problem, its compliance prepared
      real(dp), intent(in) :: dual_load(:) !! B (2m) [L]
      real(dp), intent(in) :: force(:) !! lambda (2m) [F]
      real(dp), allocatable :: displacement(:)

      allocate (displacement(2*self%n_points))
      call symmetric_multiply(self%compliance, force, displacement)
      displacement = dual_load - displacement
      displacement(:self%n_points) = displacement(:self%n_points) + self%gap
   end function contact_problem_displacement

   !> The force that residuals are measured by: the largest force that would act on a point if none could move,
   !> interference included; 1 where nothing acts at all [F].
   pure real(dp) function contact_problem_force_scale(self) result(scale)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp) :: bound(2*self%n_points), force(2*self%n_points)

      force = 0.0_dp
      if (any(self%gap < 0.0_dp)) then
         bound = 0.0_dp
         bound(:self%n_points) = min(0.0_dp, self%gap)
         call symmetric_multiply(self%stiffness, bound, force)
      end if
      scale = maxval(abs(self%load - force))
      if (.not. scale > 0.0_dp) scale = 1.0_dp
   end function contact_problem_force_scale

   !> The residual of a pair (v, lambda): largest violation of `S v = q - lambda` and of the contact law, over the
   !> force scale. It depends on no method and on no unit, and is zero at a solution only; numbers that are not finite
   !> make it huge [-].
   pure real(dp) function contact_problem_residual(self, displacement, force) result(residual)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: displacement(:) !! v (2m) [L]
      real(dp), intent(in) :: force(:) !! lambda (2m) [F]
      real(dp) :: imbalance(2*self%n_points), violation
      integer :: p, m

      m = self%n_points
      call symmetric_multiply(self%stiffness, displacement, imbalance)
      imbalance = imbalance - self%load + force
      ! maxval passes over what is not a number.
      residual = huge(residual)
      if (.not. all(ieee_is_finite(imbalance))) return
      violation = 0.0_dp
      do p = 1, m
         violation = max(violation, law_violation(force(p), displacement(p) - self%gap(p), force(m + p), &
            displacement(m + p), self%friction(p), self%slip_bound(p), self%stiffness(p, p), &
            self%stiffness(m + p, m + p)))
      end do
      residual = max(maxval(abs(imbalance)), violation)/self%force_scale()
   end function contact_problem_residual

   !> Status of every point of a pair (v, lambda): which bound of the law is active (m).
   pure function contact_problem_status(self, displacement, force) result(status)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: displacement(:) !! v (2m) [L]
      real(dp), intent(in) :: force(:) !! lambda (2m) [F]
      integer, allocatable :: status(:)
      integer :: p, m

      m = self%n_points
      status = [(contact_status(force(p) + self%stiffness(p, p)*(displacement(p) - self%gap(p)), &
         force(m + p) + self%stiffness(m + p, m + p)*displacement(m + p), self%friction(p), &
         self%slip_bound(p)), p=1, m)]
   end function contact_problem_status

end module amontons_contact_problem
