!> Projected successive over-relaxation (SOR): point by point, each component (or the point as a whole) is relaxed and
!> cut to its bound, with the present slip bound phi lambda_N. omega = 1 is projected Gauss-Seidel.
!>
!> Sweeps can be accelerated: the combination that Anderson's or Aitken's method proposes replaces the result of a sweep
!> if its residual is smaller.
!>
!> A sweep keeps the residual of its equations (distance and slip in the dual space, forces in the primal one) and
!> updates it by a column of the matrix for each component that changes. So each sweep reads the matrix at most once,
!> and the residual after it is known without another product. A point is relaxed component by component, or solved as a
!> whole. In space a component is the normal one or both tangential ones together.
module amontons_psor
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_acceleration, only: acceleration_t, new_acceleration
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, effort_t
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_error, only: error_t
   use amontons_friction_law, only: cut_to_bound, solve_point
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: local_names, psor_t, space_names

   !> The spaces of the sweeps, as a deck writes them: forces (dual) or displacements (primal).
   character(6), parameter :: space_names(2) = [character(6) :: 'dual', 'primal']

   !> Treatments of a point, as a deck writes them: component by component, or as a whole.
   character(5), parameter :: local_names(2) = [character(5) :: 'point', 'block']

   !> The state of the sweeps: unknowns, residual of their equations, and the options.
   type :: relaxation_t
      logical :: is_dual = .true. !! whether they are done in the forces
      logical :: is_block = .false. !! whether a point is solved as a whole
      real(dp) :: omega = 1.0_dp !! relaxation [-]
      real(dp) :: scale = 1.0_dp !! force scale of the problem [F]
      real(dp), allocatable :: unknown(:) !! dual: lambda [F]; primal: v [L] (2m)
      real(dp), allocatable :: residual(:) !! dual: B - A lambda [L]; primal: q - S v [F] (2m)
      type(effort_t) :: effort !! work of the sweeps
      real(dp), allocatable :: center(:) !! proximal center of a dual sweep (2m) [L]
      integer, allocatable, private :: at(:, :) !! components of each point (1 + n_tangents, m)
      real(dp), allocatable, private :: block(:, :, :)
         !! compliance of each point in (n, t1, t2): its block of A, or the inverse of that of S, 0 if there is none
         !! (3, 3, m) [L/F]
      real(dp), allocatable, private :: rho(:) !! reciprocals of the diagonal of A or S (n)
   contains
      procedure :: advance => relaxation_advance
      procedure :: admit => relaxation_admit
      procedure :: pair => relaxation_pair
      procedure :: refresh => relaxation_refresh
      procedure :: scaled_residual => relaxation_scaled_residual
   end type relaxation_t

   !> Projected SOR in the forces (`dual`, on A) or in the displacements (`primal`, on S). A reduced problem has the
   !> dual space only.
   type, extends(contact_method_t) :: psor_t
   contains
      procedure :: prepare => psor_prepare
      procedure :: solve => psor_solve
   end type psor_t

contains

   !> Whether the unknowns of the sweeps are the forces.
   pure logical function is_dual_for(self, problem) result(is_dual)
      class(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem

      is_dual = self%space == 'dual' .or. .not. problem%matrix%has_stiffness()
   end function is_dual_for

   !> Makes the matrix that the sweeps read.
   subroutine psor_prepare(self, problem, error)
      class(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! a problem on the operator
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite (dual sweeps), or no memory

      if (is_dual_for(self, problem)) then
         call problem%matrix%prepare_compliance(error)
      else
         call problem%matrix%prepare_stiffness(error)
      end if
   end subroutine psor_prepare

   !> Sweeps until the residual is small.
   subroutine psor_solve(self, problem, solution, error)
      class(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite (dual sweeps)
      integer, parameter :: n_until_refresh = 100
      type(acceleration_t) :: acceleration
      type(relaxation_t) :: sweep, before
      integer :: i
      logical :: is_dual, may_continue, is_last
      real(dp), dimension(problem%matrix%n) :: displacement, force, change
      real(dp) :: residual

      call solution%reset()
      is_dual = is_dual_for(self, problem)
      call solution%effort%factorize(is_dual .and. .not. allocated(problem%matrix%compliance))
      call self%prepare(problem, error)
      if (allocated(error)) return
      call new_relaxation(sweep, problem, is_dual, self%local == 'block', self%omega, solution)
      call new_acceleration(acceleration, self%acceleration)
      do i = 1, self%max_iterations
         before = sweep
         call sweep%advance(problem)
         ! The residual of a sweep is known without a product; it is computed independently if it is small, and at the
         ! end.
         residual = sweep%scaled_residual(problem)
         is_last = solution%n_iterations + 1 >= self%max_iterations .or. residual >= huge(residual)
         may_continue = .true.
         if (residual > self%tolerance .and. .not. is_last) then
            call solution%record_residual(residual)
         else
            call sweep%pair(problem, displacement, force)
            call solution%record(problem, displacement, force, self%tolerance, may_continue)
            call sweep%refresh(problem)
         end if
         if (.not. may_continue) exit
         if (mod(i, n_until_refresh) == 0) call sweep%refresh(problem)
         if (is_dual .and. .not. problem%matrix%is_held) then
            call sweep%pair(problem, displacement, force)
            call problem%matrix%compliance%multiply( &
               problem%matrix%proximal_parameter*(displacement - sweep%center), change)
            call sweep%effort%multiply(1.0_dp)
            sweep%residual = sweep%residual + change
            sweep%center = displacement
         end if
         call accelerate(acceleration, problem, before, sweep)
      end do
      call solution%effort%add(sweep%effort)
   end subroutine psor_solve

   !> Replaces the result of a sweep by the proposal of the acceleration if its residual is smaller.
   pure subroutine accelerate(acceleration, problem, before, sweep)
      type(acceleration_t), intent(inout) :: acceleration !! the acceleration
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(relaxation_t), intent(in) :: before !! the state before the sweep
      type(relaxation_t), intent(inout) :: sweep !! the state after the sweep
      type(relaxation_t) :: proposed
      real(dp) :: proposal(3*size(sweep%unknown))
      integer :: n
      logical :: is_given

      if (acceleration%depth == 0) return
      n = size(sweep%unknown)
      ! The parameter turns the center into a force. Where it is 0, or displacements are swept, the center stays.
      call acceleration%extrapolate([before%unknown, problem%matrix%proximal_parameter*before%center], &
         [sweep%unknown, problem%matrix%proximal_parameter*sweep%center, sweep%residual], proposal, is_given)
      if (.not. is_given) return
      proposed = sweep
      proposed%unknown = proposal(:n)
      if (problem%matrix%proximal_parameter > 0.0_dp) proposed%center = &
         proposal(n + 1:2*n)/problem%matrix%proximal_parameter
      proposed%residual = proposal(2*n + 1:)
      call proposed%admit(problem, sweep%unknown)
      if (proposed%scaled_residual(problem) < sweep%scaled_residual(problem)) then
         sweep = proposed
      else
         sweep%effort = proposed%effort
         call acceleration%forget()
      end if
   end subroutine accelerate

   !> Makes the state of the sweeps from a solution.
   pure subroutine new_relaxation(sweep, problem, is_dual, is_block, omega, solution)
      type(relaxation_t), intent(out) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared for dual sweeps
      logical, intent(in) :: is_dual !! whether to sweep in the forces
      logical, intent(in) :: is_block !! whether to solve each point as a whole
      real(dp), intent(in) :: omega !! relaxation [-]
      type(contact_solution_t), intent(in) :: solution !! starting point
      integer :: i, j, k, m, n

      m = problem%n_points
      sweep%is_dual = is_dual
      sweep%is_block = is_block
      sweep%omega = omega
      sweep%scale = problem%force_scale()
      sweep%center = solution%displacement
      if (is_dual) then
         sweep%unknown = solution%force
         sweep%rho = problem%matrix%compliance%reciprocal_diagonal()
      else
         sweep%unknown = solution%displacement
         sweep%unknown(:m) = min(sweep%unknown(:m), problem%gap)
         sweep%rho = 1.0_dp/problem%matrix%stiffness%diagonal()
      end if
      n = problem%matrix%n_tangents
      allocate (sweep%block(3, 3, m), source=0.0_dp)
      sweep%at = transpose(reshape([(i, i=1, (1 + n)*m)], [m, 1 + n]))
      do i = 1, m
         do j = 0, n
            do k = 0, n
               if (is_dual) sweep%block(j + 1, k + 1, i) = problem%matrix%compliance%element(i + j*m, i + k*m)
               if (.not. is_dual) sweep%block(j + 1, k + 1, i) = problem%matrix%stiffness%element(i + j*m, i + k*m)
            end do
         end do
         if (.not. is_dual) call invert(sweep%block(:1 + n, :1 + n, i))
      end do
      call sweep%refresh(problem)

   contains

      !> Replaces the stiffness of a point by its inverse, by 0 if it is singular.
      pure subroutine invert(own)
         real(dp), contiguous, intent(inout) :: own(:, :) !! the stiffness [F/L]; on return the compliance [L/F]
         real(dp), parameter :: singular = 1.0e-6_dp ! root of what rounding leaves of a determinant of 0
         real(dp) :: factor(size(own, 1), size(own, 1)), root(size(own, 1))
         integer :: info, k

         root = [(sqrt(own(k, k)), k=1, size(root))]
         factor = own
         call cholesky_factor(factor, info)
         own = 0.0_dp
         if (info /= 0) return
         if (product([(factor(k, k)/root(k), k=1, size(root))]) <= singular) return
         do k = 1, size(root)
            own(k, k) = 1.0_dp
         end do
         call cholesky_solve(factor, own)
      end subroutine invert

   end subroutine new_relaxation

   !> Recomputes the residual, which many updates have left with rounding errors.
   pure subroutine relaxation_refresh(self, problem)
      class(relaxation_t), intent(inout) :: self !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp) :: product(size(self%unknown))

      if (self%is_dual) then
         self%residual = problem%displacement(problem%dual_load(self%center), self%unknown)
         call self%effort%multiply(merge(2.0_dp, 1.0_dp, problem%matrix%has_stiffness()))
         self%residual = self%residual - problem%reference()
      else
         call problem%matrix%stiffness%multiply(self%unknown, product)
         self%residual = problem%load - product
         call self%effort%multiply(1.0_dp)
      end if
   end subroutine relaxation_refresh

   !> Performs one sweep over all contact points.
   pure subroutine relaxation_advance(self, problem)
      class(relaxation_t), intent(inout) :: self !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer :: point

      do point = 1, problem%n_points
         if (self%is_dual) call relax_force(self, problem, self%at(:, point))
         if (.not. self%is_dual) call relax_displacement(self, problem, self%at(:, point))
      end do
   end subroutine relaxation_advance

   !> Relaxes the force of one point, and cuts it to the contact law.
   pure subroutine relax_force(sweep, problem, at)
      type(relaxation_t), intent(inout) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      integer, contiguous, intent(in) :: at(:) !! the components of the point (1 + n_tangents)
      real(dp) :: here(3), free(3), goal(3), bound, length
      integer :: i

      here = 0.0_dp
      free = 0.0_dp
      goal = 0.0_dp
      associate (x => sweep%unknown, w => sweep%residual, n => at(1), own => sweep%block(:, :, at(1)), &
         omega => sweep%omega, k => size(at))
         if (sweep%is_block) then
            do i = 1, k
               here(i) = x(at(i))
               free(i) = w(at(i))
            end do
            goal = solve_point(own, free + matmul(own, here), problem%friction(n), problem%slip_bound(n), here)
            goal = here + omega*(goal - here)
            call set_unknown(sweep, problem, n, max(0.0_dp, goal(1)))
         else
            call set_unknown(sweep, problem, n, max(0.0_dp, x(n) + omega*sweep%rho(n)*w(n)))
            do i = 2, k
               goal(i) = x(at(i)) + omega*sweep%rho(at(i))*w(at(i))
            end do
         end if
         bound = problem%slip_bound(n) + problem%friction(n)*x(n)
         length = hypot(goal(2), goal(3))
         if (length > bound) goal(2:) = bound/length*goal(2:)
         do i = 2, k
            call set_unknown(sweep, problem, at(i), goal(i))
         end do
      end associate
   end subroutine relax_force

   !> Relaxes the displacement of one point: the normal one is cut at the gap, the slip is reduced by what friction
   !> holds. With `block` it is solved for its force; a closed point is put exactly on the gap.
   pure subroutine relax_displacement(sweep, problem, at)
      type(relaxation_t), intent(inout) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, contiguous, intent(in) :: at(:) !! the components of the point (1 + n_tangents)
      real(dp), dimension(3) :: here, force, free, goal, reference
      real(dp) :: bound, length
      integer :: i

      here = 0.0_dp
      force = 0.0_dp
      goal = 0.0_dp
      reference = 0.0_dp
      associate (v => sweep%unknown, f => sweep%residual, n => at(1), own => sweep%block(:, :, at(1)), &
         omega => sweep%omega, k => size(at))
         reference(1) = problem%gap(n)
         do i = 2, k
            reference(i) = problem%anchor(at(i) - problem%n_points)
         end do
         if (sweep%is_block .and. own(1, 1) > 0.0_dp) then
            do i = 1, k
               here(i) = v(at(i))
               force(i) = f(at(i))
            end do
            free = here - reference + matmul(own, force)
            force = solve_point(own, free, problem%friction(n), problem%slip_bound(n), force)
            goal = here + omega*(reference + free - matmul(own, force) - here)
            call set_unknown(sweep, problem, n, merge(problem%gap(n), min(problem%gap(n), goal(1)), force(1) > 0.0_dp))
         else
            call set_unknown(sweep, problem, n, min(v(n) + omega*sweep%rho(n)*f(n), problem%gap(n)))
            bound = problem%slip_bound(n)
            if (.not. v(n) < problem%gap(n)) bound = bound + problem%friction(n)*max(0.0_dp, f(n))
            do i = 2, k
               goal(i) = v(at(i)) - reference(i) + omega*sweep%rho(at(i))*f(at(i))
            end do
            bound = omega*sweep%rho(at(2))*bound
            length = hypot(goal(2), goal(3))
            goal(2:k) = reference(2:k) + max(0.0_dp, length - bound)/max(length, tiny(bound))*goal(2:k)
         end if
         do i = 2, k
            call set_unknown(sweep, problem, at(i), goal(i))
         end do
      end associate
   end subroutine relax_displacement

   !> Sets one component, and updates the residual.
   pure subroutine set_unknown(sweep, problem, i, value)
      type(relaxation_t), intent(inout) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: i !! index of the component
      real(dp), intent(in) :: value !! its value
      real(dp) :: change

      change = value - sweep%unknown(i)
      sweep%unknown(i) = value
      if (.not. abs(change) > 0.0_dp) return
      call sweep%effort%multiply(1.0_dp/size(sweep%residual))
      if (sweep%is_dual) then
         call problem%matrix%compliance%add_column(i, -change, sweep%residual)
      else
         call problem%matrix%stiffness%add_column(i, -change, sweep%residual)
      end if
   end subroutine set_unknown

   !> Displacements and forces at the end of a sweep; in the primal space the forces are the residual of equilibrium,
   !> cut to the contact law.
   pure subroutine relaxation_pair(self, problem, displacement, force)
      class(relaxation_t), intent(in) :: self !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(out) :: displacement(:) !! v (2m) [L]
      real(dp), intent(out) :: force(:) !! lambda (2m) [F]
      integer :: m

      m = problem%n_points
      if (self%is_dual) then
         displacement = self%residual + problem%reference()
         force = self%unknown
      else
         displacement = self%unknown
         force = self%residual
         force(:m) = merge(0.0_dp, max(0.0_dp, force(:m)), displacement(:m) < problem%gap)
         force(m + 1:) = cut_to_bound(force(m + 1:), problem%bound(force(:m)))
      end if
   end subroutine relaxation_pair

   !> The residual of the present pair as the contact problem measures it, except for rounding: the missing equilibrium
   !> is the move of the proximal center in the dual space, and the part of the forces that the contact law cut off in
   !> the primal one [-].
   pure real(dp) function relaxation_scaled_residual(self, problem) result(residual)
      class(relaxation_t), intent(in) :: self !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), dimension(size(self%unknown)) :: displacement, force, imbalance

      call self%pair(problem, displacement, force)
      if (self%is_dual) then
         imbalance = problem%matrix%proximal_parameter*(displacement - self%center)
      else
         imbalance = self%residual - force
      end if
      residual = huge(residual)
      if (.not. all(ieee_is_finite(self%residual))) return
      residual = max(0.0_dp, maxval(abs(imbalance)), problem%violation(displacement, force))/self%scale
   end function relaxation_scaled_residual

   !> Makes a combination of points admissible: forces are cut to the contact law; a displacement stays out of the
   !> obstacle, and on its surface where it was there before.
   pure subroutine relaxation_admit(self, problem, before)
      class(relaxation_t), intent(inout) :: self !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: before(:) !! the unknowns before (n)
      real(dp), allocatable :: cut(:)
      real(dp) :: bound
      integer :: i, n

      do n = 1, problem%n_points
         if (self%is_dual) then
            call set_unknown(self, problem, n, max(0.0_dp, self%unknown(n)))
            bound = problem%slip_bound(n) + problem%friction(n)*self%unknown(n)
            cut = cut_to_bound(self%unknown(self%at(2:, n)), [bound])
            do i = 1, size(cut)
               call set_unknown(self, problem, self%at(1 + i, n), cut(i))
            end do
         else if (before(n) < problem%gap(n)) then
            call set_unknown(self, problem, n, min(self%unknown(n), problem%gap(n)))
         else
            call set_unknown(self, problem, n, problem%gap(n))
         end if
      end do
   end subroutine relaxation_admit

end module amontons_psor
