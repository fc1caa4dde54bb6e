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
   use amontons_error, only: error_t
   use amontons_friction_law, only: bounded, cut_to_bound, solve_point, solve_point_in_space
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
      real(dp), allocatable, private :: diagonal(:) !! diagonal of A or S (2m)
      real(dp), allocatable, private :: block(:, :, :) !! its block of each point (1 + n_tangents, 1 + n_tangents, m)
      real(dp), allocatable, private :: rho(:) !! reciprocals of the diagonal (2m)
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
         sweep%diagonal = problem%matrix%compliance%diagonal()
         sweep%rho = problem%matrix%compliance%reciprocal_diagonal()
      else
         sweep%unknown = solution%displacement
         sweep%unknown(:m) = min(sweep%unknown(:m), problem%gap)
         sweep%diagonal = problem%matrix%stiffness%diagonal()
         sweep%rho = 1.0_dp/sweep%diagonal
      end if
      n = problem%matrix%n_tangents
      allocate (sweep%block(1 + n, 1 + n, m))
      do i = 1, m
         do j = 0, n
            do k = 0, n
               if (is_dual) sweep%block(j + 1, k + 1, i) = problem%matrix%compliance%element(i + j*m, i + k*m)
               if (.not. is_dual) sweep%block(j + 1, k + 1, i) = problem%matrix%stiffness%element(i + j*m, i + k*m)
            end do
         end do
      end do
      call sweep%refresh(problem)
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
         if (problem%matrix%n_tangents == 2) then
            if (self%is_dual) call relax_force_in_space(self, problem, point)
            if (.not. self%is_dual) call relax_displacement_in_space(self, problem, point)
         else if (self%is_dual) then
            call relax_force(self, problem, point)
         else
            call relax_displacement(self, problem, point)
         end if
      end do
   end subroutine relaxation_advance

   !> Relaxes the force of one point in space, and cuts it to the contact law.
   pure subroutine relax_force_in_space(sweep, problem, n)
      type(relaxation_t), intent(inout) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      integer, intent(in) :: n !! the point
      real(dp) :: goal(3)
      integer :: at(3)

      at = n + [0, 1, 2]*problem%n_points
      associate (x => sweep%unknown, w => sweep%residual, own => sweep%block(:, :, n), omega => sweep%omega)
         if (sweep%is_block) then
            goal = solve_point_in_space(own, w(at) + matmul(own, x(at)), problem%friction(n), &
               problem%slip_bound(n), x(at))
            goal = x(at) + omega*(goal - x(at))
            call set_unknown(sweep, problem, n, max(0.0_dp, goal(1)))
         else
            call set_unknown(sweep, problem, n, max(0.0_dp, x(n) + omega*sweep%rho(n)*w(n)))
            goal = x(at) + omega*sweep%rho(at)*w(at)
         end if
         call set_tangential(sweep, problem, n, cut_to_bound(goal(2:), &
            [problem%slip_bound(n) + problem%friction(n)*x(n)]))
      end associate
   end subroutine relax_force_in_space

   !> Relaxes the displacement of one point in space: the normal one is cut at the gap, the slip is reduced by what
   !> friction holds. With `block` it is solved for its force; a closed point is put exactly on the gap.
   pure subroutine relax_displacement_in_space(sweep, problem, n)
      type(relaxation_t), intent(inout) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: n !! the point
      real(dp), parameter :: singular = 1.0e-12_dp
      real(dp) :: w(3, 3), det, bound, normal, slip(2), goal(3), force(3)
      integer :: at(3)

      at = n + [0, 1, 2]*problem%n_points
      associate (v => sweep%unknown, f => sweep%residual, s => sweep%block(:, :, n), omega => sweep%omega, &
         reference => [problem%gap(n), problem%anchor(at(:2))])
         w(:, 1) = cross(s(:, 2), s(:, 3))
         w(:, 2) = cross(s(:, 3), s(:, 1))
         w(:, 3) = cross(s(:, 1), s(:, 2))
         det = dot_product(s(:, 1), w(:, 1))
         if (sweep%is_block .and. det > singular*s(1, 1)*s(2, 2)*s(3, 3)) then
            w = w/det
            goal = v(at) - reference + matmul(w, f(at))
            force = solve_point_in_space(w, goal, problem%friction(n), problem%slip_bound(n), f(at))
            goal = v(at) + omega*(reference + goal - matmul(w, force) - v(at))
            normal = merge(problem%gap(n), min(problem%gap(n), goal(1)), force(1) > 0.0_dp)
            call set_unknown(sweep, problem, n, normal)
            call set_tangential(sweep, problem, n, goal(2:))
         else
            call set_unknown(sweep, problem, n, min(v(n) + omega*f(n)/s(1, 1), problem%gap(n)))
            bound = problem%slip_bound(n)
            if (.not. v(n) < problem%gap(n)) bound = bound + problem%friction(n)*max(0.0_dp, f(n))
            slip = v(at(2:)) - reference(2:) + omega*sweep%rho(at(2:))*f(at(2:))
            slip = slip*max(0.0_dp, 1.0_dp - omega*sweep%rho(at(2))*bound/max(norm2(slip), tiny(bound)))
            call set_tangential(sweep, problem, n, reference(2:) + slip)
         end if
      end associate

   contains

      !> The cross product of two vectors.
      pure function cross(a, b)
         real(dp), intent(in) :: a(3) !! one vector
         real(dp), intent(in) :: b(3) !! the other
         real(dp) :: cross(3)

         cross = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
      end function cross

   end subroutine relax_displacement_in_space

   !> Sets the tangential components of a point in space, and updates the residual.
   pure subroutine set_tangential(sweep, problem, n, values)
      type(relaxation_t), intent(inout) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: n !! the point
      real(dp), intent(in) :: values(2) !! the values

      call set_unknown(sweep, problem, n + problem%n_points, values(1))
      call set_unknown(sweep, problem, n + 2*problem%n_points, values(2))
   end subroutine set_tangential

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

   !> Relaxes the force of one point, and cuts it to the contact law.
   pure subroutine relax_force(sweep, problem, n)
      type(relaxation_t), intent(inout) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      integer, intent(in) :: n !! the point
      real(dp) :: change(2), solved(2)
      integer :: t

      t = n + problem%n_points
      associate (x => sweep%unknown, w => sweep%residual, a => sweep%diagonal, a_nt => sweep%block(2, 1, n))
         if (sweep%is_block) then
            solved = solve_point(a(n), a_nt, a(t), [w(n) + a(n)*x(n) + a_nt*x(t), w(t) + a_nt*x(n) + a(t)*x(t)], &
               problem%friction(n), problem%slip_bound(n), [x(n), x(t)])
            change = sweep%omega*(solved - [x(n), x(t)])
            call set_unknown(sweep, problem, n, max(0.0_dp, x(n) + change(1)))
         else
            call set_unknown(sweep, problem, n, max(0.0_dp, x(n) + sweep%omega*sweep%rho(n)*w(n)))
            change(2) = sweep%omega*sweep%rho(t)*w(t)
         end if
         call set_unknown(sweep, problem, t, bounded(x(t) + change(2), &
            problem%slip_bound(n) + problem%friction(n)*x(n)))
      end associate
   end subroutine relax_force

   !> Relaxes the displacement of one point: the normal one is cut at the gap, the slip is reduced by what friction
   !> holds. A block is solved as a whole, and put exactly on the gap where it is closed.
   pure subroutine relax_displacement(sweep, problem, n)
      type(relaxation_t), intent(inout) :: sweep !! the sweeps
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: n !! the point
      real(dp), parameter :: singular = 1.0e-12_dp
      real(dp) :: bound, det, w_nn, w_nt, w_tt, free(2), force(2), slip, distance
      integer :: t

      t = n + problem%n_points
      associate (v => sweep%unknown, f => sweep%residual, s => sweep%diagonal, omega => sweep%omega)
         det = s(n)*s(t) - sweep%block(2, 1, n)**2
         if (sweep%is_block .and. det > singular*s(n)*s(t)) then
            w_nn = s(t)/det
            w_nt = -sweep%block(2, 1, n)/det
            w_tt = s(n)/det
            free = [v(n) - problem%gap(n) + w_nn*f(n) + w_nt*f(t), &
               v(t) - problem%anchor(n) + w_nt*f(n) + w_tt*f(t)]
            force = solve_point(w_nn, w_nt, w_tt, free, problem%friction(n), problem%slip_bound(n), [f(n), f(t)])
            distance = free(1) - w_nn*force(1) - w_nt*force(2)
            slip = free(2) - w_nt*force(1) - w_tt*force(2)
            slip = v(t) + omega*(problem%anchor(n) + slip - v(t))
            distance = min(problem%gap(n), v(n) + omega*(problem%gap(n) + distance - v(n)))
            call set_unknown(sweep, problem, n, merge(problem%gap(n), distance, force(1) > 0.0_dp))
            call set_unknown(sweep, problem, t, slip)
         else
            call set_unknown(sweep, problem, n, min(v(n) + omega*f(n)/s(n), problem%gap(n)))
            bound = problem%slip_bound(n)
            if (.not. v(n) < problem%gap(n)) bound = bound + problem%friction(n)*max(0.0_dp, f(n))
            slip = v(t) - problem%anchor(n) + omega*f(t)/s(t)
            call set_unknown(sweep, problem, t, problem%anchor(n) &
               + sign(max(0.0_dp, abs(slip) - omega*bound/s(t)), slip))
         end if
      end associate
   end subroutine relax_displacement

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
      real(dp) :: bound
      integer :: n, t

      do n = 1, problem%n_points
         t = n + problem%n_points
         if (self%is_dual) then
            call set_unknown(self, problem, n, max(0.0_dp, self%unknown(n)))
            bound = problem%slip_bound(n) + problem%friction(n)*self%unknown(n)
            if (problem%matrix%n_tangents == 2) then
               call set_tangential(self, problem, n, cut_to_bound(self%unknown([t, t + problem%n_points]), [bound]))
            else
               call set_unknown(self, problem, t, bounded(self%unknown(t), bound))
            end if
         else if (before(n) < problem%gap(n)) then
            call set_unknown(self, problem, n, min(self%unknown(n), problem%gap(n)))
         else
            call set_unknown(self, problem, n, problem%gap(n))
         end if
      end do
   end subroutine relaxation_admit

end module amontons_psor
