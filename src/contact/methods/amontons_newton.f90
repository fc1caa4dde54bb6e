!> Semismooth Newton in the form of an active-set method (Alart and Curnier, CMAME 92, 1991): assume the state of
!> every point, solve the linear system that this active set gives, read the next active set off its solution, repeat.
!> Once an active set repeats itself the solution is exact.
!>
!> Steps are proximal: a regularization, a part of the diagonal, holds the unknowns to where they were. As in the method
!> of Levenberg and Marquardt it grows when the residual does and shrinks when the residual does: active sets that leave
!> the system singular are passed, and near the solution the steps are Newton's. Where active sets would repeat in a
!> cycle, single points change (after Murty's principal pivoting, which changes the last index that is infeasible and
!> ends for every P-matrix).
!>
!> The linear system of a Newton step, what an active set leads to, on each kind of operator; and a start for Newton's
!> method on a band.
!>
!> In the displacements, on the condensed stiffness S: the rows of `S v = q - lambda` that hold an unknown displacement,
!> with lambda_N of a closed sliding point eliminated by its own row.
!>
!> In the displacements of a whole slender body, whose condensed stiffness is never made: the rows of K u = f that hold
!> an unknown displacement, the interior's among them; closed u_N and sticking u_T are known, and a closed sliding point
!> has its tangential row less phi times its normal one. It gives the same steps as the condensed stiffness does.
!>
!> In the forces, on a compliance A, dense or sparse: a normal force of a closed point and a tangential one of a
!> sticking point are unknown. A row of `A lambda = B` each, of no distance and of no slip, holds them; the others
!> follow from the law. An active set that stays keeps its factorization, unless its regularization shrinks much.
!>
!> In space all of this is done in turned axes, the first tangent of a sliding point along its slip: that is the plane's
!> system, with the spring across the slip on the diagonal of the second one, or its reciprocal in the forces.
module amontons_newton
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_band_matrix, only: band_lu_t, new_band_matrix
   use amontons_contact_problem, only: active_set_t, contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, effort_t
   use amontons_dense, only: allocate_matrix, cholesky_factor, cholesky_solve, lu_factor, lu_solve, &
      lu_solve_transposed
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_sparse_lu, only: sparse_lu_t
   use amontons_sparse_matrix, only: entries_t
   use amontons_symmetric_matrix, only: symmetric_matrix_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: newton_system_t, newton_t, spring_start_t, visited_sets_t

   !> Divisors of the regularization after a step with a smaller residual, and after one that also left the active set
   !> unchanged. With larger divisors the active sets of semidefinite problems do not settle.
   real(dp), parameter :: reduction = 3.0_dp, fast_reduction = 90.0_dp

   !> Ratio of successive residuals, with the active set unchanged, above which convergence is slow, and the lowest
   !> regularization that is then allowed.
   real(dp), parameter :: slow_convergence = 0.5_dp, lowest_regularization = 1.0e-12_dp

   !> The semismooth Newton method, in the displacements of a body and in the forces of a reduced problem.
   type, extends(contact_method_t) :: newton_t
      real(dp) :: max_regularization = 1.0_dp
         !! largest regularization, as part of the diagonal: more ends cycles, but is slow where there are none [-]
      integer :: patience = huge(1) !! number of steps without a better pair that end the iteration
      real(dp) :: decrease = 0.999_dp !! least residual after a better pair, at the most, over the one before [-]
   contains
      procedure :: solve => newton_solve
   end type newton_t

   !> The active sets since the residual last decreased.
   type :: visited_sets_t
      private
      integer(int64), allocatable :: key(:) !! a number computed from each active set, to recognize it
      real(dp) :: residual = huge(1.0_dp) !! the least residual so far [-]
   contains
      procedure :: add => visited_sets_add
      procedure :: clear_if_smaller => visited_sets_clear_if_smaller
   end type visited_sets_t

   !> The linear equations of active sets on one operator, with the factorization that successive active sets share.
   type :: newton_system_t
      type(effort_t) :: effort !! work of the steps so far
      type(error_t), allocatable :: error !! memory ran out; no step was made then
      type(band_lu_t), private :: band_factors !! band: the factors of the last active set
      type(active_set_t), private :: base !! compliance: the active set that is factorized
      real(dp), private :: regularization = -1.0_dp !! regularization of the factorization; -1 if there is none [-]
      integer, allocatable, private :: unknown(:) !! the forces that are unknown in it
      real(dp), allocatable, private :: diagonal(:) !! diagonal of A, where it is zero the largest of all (n) [L/F]
      real(dp), allocatable, private :: softness(:) !! regularization on the diagonal of the factorized matrix (n) [L/F]
      logical, private :: is_symmetric = .false.
         !! of a dense one, whether no point slides with friction, so that the matrix is symmetric
      real(dp), allocatable, private :: entries(:)
         !! of a dense one, Cholesky factor, or triangular factors of the transposed matrix, and room: memory is costly
         !! to get anew
      integer, allocatable, private :: pivots(:) !! their row exchanges
      type(sparse_lu_t), private :: sparse_factors !! sparse: triangular factors of the transposed matrix
   contains
      procedure :: solve => newton_system_solve
   end type newton_system_t

   !> The equations of one active set on a band, by position.
   type :: equations_t
      logical, allocatable :: is_known(:) !! whether the displacement is known (n)
      real(dp), allocatable :: known(:) !! the known displacements, 0 else (n) [L]
      real(dp), allocatable :: stiffening(:) !! addition to the diagonal (n) [F/L]
      real(dp), allocatable :: load(:) !! loads, with those of the stiffening (n) [F]
      real(dp), allocatable :: slope(:)
         !! factor of the normal row that is subtracted from a point's tangential one (m) [-]
      real(dp), allocatable :: coupling(:) !! stiffness of a point's slip against its normal displacement (m) [F/L]
   end type equations_t

   !> A starting point by springs between the points and the obstacle. The first springs are so soft that the ends of
   !> the line influence each other, the last ones so stiff that neighbors hardly do. Fronts of opening or sliding,
   !> which Newton's steps move by a few points each, are thus found at once.
   type, extends(contact_method_t) :: spring_start_t
   contains
      procedure :: solve => spring_start_solve
   end type spring_start_t

contains

   !> Performs Newton steps until the residual is small; returns the best pair if none is a solution.
   subroutine newton_solve(self, problem, solution, error)
      class(newton_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(newton_system_t) :: system
      type(active_set_t) :: active_set, last
      type(visited_sets_t) :: visited
      real(dp), dimension(problem%matrix%n) :: displacement, force, rho, before
      real(dp) :: scale, regularization, min_regularization, least, residual, previous, imbalance
      integer :: info
      logical :: is_repeated, is_last, may_continue
      ! Growth of the residual by which a step travels; least regularizations, by trial.
      real(dp), parameter :: travels = 2.0_dp, least_in_forces = 1.0e-5_dp, least_of_loose_body = 1.0e-9_dp

      call solution%reset()
      rho = problem%matrix%augmentation
      scale = problem%force_scale()
      displacement = solution%displacement
      force = solution%force
      ! At rest all points of the first active set stick, unless nothing acts.
      call active_set%update(problem, rho, displacement, force)
      if (.not. (any(force(:problem%n_points) > 0.0_dp) .or. problem%is_unloaded())) then
         call active_set%assume_stick(problem, rho, scale)
      end if
      ! In the displacements a regularization slows the motions that move all points together, so there is none as long
      ! as all goes well; in the forces it costs nothing, and makes the active sets of semidefinite problems settle.
      if (problem%matrix%has_stiffness()) then
         least = merge(0.0_dp, least_of_loose_body, problem%matrix%is_held)
         regularization = least
      else
         least = least_in_forces
         regularization = 1.0_dp
      end if
      min_regularization = least
      previous = huge(previous)
      do while (solution%n_iterations < self%max_iterations)
         is_last = solution%is_converged
         before = displacement
         call system%solve(problem, active_set, regularization, displacement, force, imbalance, info)
         call solution%effort%add(system%effort)
         system%effort = effort_t()
         if (allocated(system%error)) then
            call move_alloc(system%error, error)
            return
         end if
         if (info /= 0) then
            ! No step: the same active set is used again with a larger regularization, unless this is the largest one.
            if (is_last .or. .not. regularization < self%max_regularization) exit
            call solution%record_residual(previous)
            call increase(regularization, self%max_regularization)
            cycle
         end if
         last = active_set
         call limit_step(problem, scale, before, displacement, force, imbalance, solution%effort)
         call active_set%update(problem, rho, displacement, force)
         call stick_before_return(active_set, last, problem%slip_bound)
         residual = max(problem%violation(displacement, force), imbalance)/problem%force_scale(force, displacement)
         call record_step(problem, displacement, force, residual, self%tolerance, solution, may_continue)
         if (is_last .or. .not. may_continue) return
         call visited%clear_if_smaller(residual)
         call visited%add(active_set, last, is_repeated)
         ! Singular active sets have led the body far away.
         if (is_repeated) displacement = problem%reference()
         ! A singular active set stays, with the same residual, while the body travels to where another begins.
         if (residual/previous > merge(travels, 1.0_dp, active_set%equals(last))) then
            call increase(regularization, self%max_regularization)
         else if (.not. active_set%equals(last)) then
            min_regularization = least
            regularization = max(min_regularization, regularization/reduction)
         else
            ! The statuses are found: without regularization the forces follow at once.
            if (residual/previous > slow_convergence) min_regularization = min(min_regularization, &
               max(lowest_regularization, min_regularization/fast_reduction))
            regularization = max(min_regularization, regularization/fast_reduction)
         end if
         previous = residual
         if (solution%is_stagnant(self%patience, self%decrease)) exit
      end do
      ! A residual still at its first value, the largest number, means that there was no step.
      if (solution%residual < huge(solution%residual)) call solution%measure(problem)
   end subroutine newton_solve

   !> Records the pair at the end of a step, if it is the best so far.
   pure subroutine record_step(problem, displacement, force, residual, tolerance, solution, may_continue)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: displacement(:) !! v (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      real(dp), intent(in) :: residual !! residual of the pair, that of the balance of the step included [-]
      real(dp), intent(in) :: tolerance !! residual that counts as solved [-]
      type(contact_solution_t), intent(inout) :: solution !! the record
      logical, intent(out) :: may_continue !! false when the pair is a solution that a further step would not improve
      real(dp), parameter :: exact = 1.0e-3_dp ! over the tolerance: a further step would gain rounding alone
      ! Forces that are only so many times the tolerance are rounding errors of a body that nothing presses.
      real(dp), parameter :: small = 1.0e3_dp

      if (residual <= min(tolerance, solution%residual)) then
         call solution%record(problem, displacement, force, tolerance, may_continue)
         ! Discs are curved: one more step takes what a solution just within the tolerance misses. It also takes what is
         ! no rounding of a body that nothing presses.
         may_continue = may_continue .or. (solution%residual > exact*tolerance .and. (problem%matrix%n_tangents > 1 &
            .or. problem%largest(force) <= small*tolerance*solution%force_scale))
      else
         may_continue = .true.
         call solution%record_residual(residual)
         if (.not. residual < solution%residual) return
         solution%displacement = displacement
         solution%force = force
         solution%residual = residual
      end if
   end subroutine record_step

   !> Lets an open point stick that would reverse its slip: given bounds would push it to and fro.
   pure subroutine stick_before_return(active_set, last, slip_bound)
      type(active_set_t), intent(inout) :: active_set !! the active set that a step leads to
      type(active_set_t), intent(in) :: last !! the active set before it
      real(dp), intent(in) :: slip_bound(:) !! given bounds (m) [F]
      real(dp) :: along(size(slip_bound))

      along = active_set%slip_direction*last%slip_direction
      if (allocated(active_set%axes)) along = along*sum(active_set%axes*last%axes, dim=1)
      where (slip_bound > 0.0_dp .and. .not. (active_set%is_closed .or. last%is_closed) .and. along < 0.0_dp) &
         active_set%slip_direction = 0
   end subroutine stick_before_return

   !> Shortens a step of a loose body that, with the assumed active set, slides or flies much farther than forces of
   !> this size deform a body, since only the regularization holds it. The step ends where the forces of springs between
   !> points and obstacle, cut to the law, do as much work against it as the loads do along it.
   pure subroutine limit_step(problem, scale, before, displacement, force, imbalance, effort)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: scale !! the force that residuals are measured by [F]
      real(dp), intent(in) :: before(:) !! v before the step (2m) [L]
      real(dp), intent(inout) :: displacement(:) !! v after the step, and then where it halts (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda after the step, and then that of no shear (2m) [F]
      real(dp), intent(inout) :: imbalance !! violation of the equilibrium, and then the scale: it is not known [F]
      type(effort_t), intent(inout) :: effort !! gains that of the products
      real(dp), parameter :: longest = 1.0e3_dp
      integer, parameter :: n_halvings = 100
      real(dp), dimension(size(force)) :: step, drive, stiffening, augmented, rho
      real(dp) :: low, high, middle
      integer :: i, m

      if (problem%matrix%is_held) return
      m = problem%n_points
      rho = problem%matrix%augmentation
      step = displacement - before
      if (.not. any(rho*abs(step) > longest*m*scale)) return
      call problem%matrix%multiply_stiffness(before, drive)
      drive = problem%load - drive
      call problem%matrix%multiply_stiffness(step, stiffening)
      call effort%multiply(2.0_dp)
      force(:m) = max(0.0_dp, force(:m))
      force(m + 1:) = 0.0_dp
      low = 0.0_dp
      high = 1.0_dp
      do i = 1, n_halvings
         middle = 0.5_dp*(low + high)
         augmented = problem%cut(force + rho*(before + middle*step - problem%reference()))
         if (dot_product(step, drive - middle*stiffening - augmented) > 0.0_dp) then
            low = middle
         else
            high = middle
         end if
      end do
      displacement = before + high*step
      imbalance = scale
   end subroutine limit_step

   !> Increases the regularization tenfold, from 0 to a small number, up to a bound.
   pure subroutine increase(regularization, most)
      real(dp), intent(inout) :: regularization !! the regularization [-]
      real(dp), intent(in) :: most !! the largest that it may be [-]
      real(dp), parameter :: factor = 10.0_dp, from_nothing = 1.0e-9_dp ! slows a step by less than Newton gains

      regularization = min(most, max(from_nothing, factor*regularization))
   end subroutine increase

   !> Clears the list of active sets after a step with a smaller residual: the iteration is not in a cycle.
   pure subroutine visited_sets_clear_if_smaller(self, residual)
      class(visited_sets_t), intent(inout) :: self !! the active sets
      real(dp), intent(in) :: residual !! residual after a step [-]
      real(dp), parameter :: decrease = 0.9_dp

      if (allocated(self%key) .and. .not. residual < decrease*self%residual) return
      self%residual = min(residual, self%residual)
      if (allocated(self%key)) deallocate (self%key)
      allocate (self%key(0))
   end subroutine visited_sets_clear_if_smaller

   !> Adds the active set of a step to the list; if it is there already, changes single points until it is new. If no
   !> such change leads to a new one, it stays, and the regularization has to break the cycle.
   pure subroutine visited_sets_add(self, active_set, last, is_repeated)
      class(visited_sets_t), intent(inout) :: self !! the active sets
      type(active_set_t), intent(inout) :: active_set !! the active set that a step leads to
      type(active_set_t), intent(in) :: last !! the active set before it
      logical, intent(out) :: is_repeated !! whether it is there already
      type(active_set_t) :: trial
      integer :: p

      is_repeated = .false.
      if (active_set%equals(last)) return
      is_repeated = any(self%key == key_of(active_set))
      if (is_repeated) then
         do p = size(last%is_closed), 1, -1
            trial = last
            trial%is_closed(p) = active_set%is_closed(p)
            trial%slip_direction(p) = active_set%slip_direction(p)
            if (allocated(active_set%axes)) trial%axes = active_set%axes
            if (allocated(active_set%axes)) trial%spring = active_set%spring
            if (trial%equals(last)) cycle
            if (all(self%key /= key_of(trial))) exit
            ! A point changes its direction of slip by sticking in between.
            if (trial%slip_direction(p)*last%slip_direction(p) >= 0) cycle
            trial%slip_direction(p) = 0
            if (all(self%key /= key_of(trial))) exit
         end do
         if (p > 0) active_set = trial
      end if
      self%key = [self%key, key_of(active_set)]
   end subroutine visited_sets_add

   !> A hash of an active set: equal for equal sets, different for different ones with near certainty.
   pure integer(int64) function key_of(active_set) result(key)
      type(active_set_t), intent(in) :: active_set !! the active set
      integer(int64), parameter :: factor = 8121341234567_int64
      integer :: p

      key = 0
      do p = 1, size(active_set%is_closed)
         associate (state => active_set%slip_direction(p) + merge(2, 5, active_set%is_closed(p)))
            key = ieor(ishftc(key, 7), factor*state + p)
         end associate
      end do
   end function key_of

   !> Solves the equations of an active set, a proximal step: `regularization` times the diagonal, times the step, is
   !> added to them, so that an active set which leaves them singular still gives a step.
   subroutine newton_system_solve(self, problem, active_set, regularization, displacement, force, imbalance, info)
      class(newton_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, the same in all steps; its compliance prepared
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of S or A [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      real(dp), intent(out) :: imbalance !! largest violation of the equilibrium by the pair after the step [F]
      integer, intent(out) :: info !! 0, or nonzero where the system has no finite solution; no step is made then
      type(symmetric_matrix_t) :: turned
      integer :: m

      m = problem%n_points
      imbalance = 0.0_dp
      if (allocated(problem%matrix%band)) then
         call step_on_band()
      else if (.not. allocated(active_set%axes)) then
         if (allocated(problem%matrix%stiffness)) then
            call step_on_stiffness(problem%matrix%stiffness)
         else
            call step_on_compliance(self, problem, problem%matrix%compliance, active_set, regularization, &
               displacement, force, info)
         end if
      else if (allocated(problem%matrix%stiffness)) then
         call problem%matrix%stiffness%turn(active_set%slip_axes(), turned)
         call step_on_stiffness(turned)
      else
         call problem%matrix%compliance%turn(active_set%slip_axes(), turned)
         call step_on_compliance(self, problem, turned, active_set, regularization, displacement, force, info)
      end if

   contains

      !> Solves for the displacements, then takes the forces from the equilibrium.
      subroutine step_on_stiffness(stiffness)
         type(symmetric_matrix_t), intent(in) :: stiffness !! S in the axes of the slips
         real(dp), allocatable :: matrix(:, :), right(:)
         integer, allocatable :: unknown(:)
         real(dp) :: slope(m)
         real(dp), dimension(problem%matrix%n) :: load, known, before
         integer :: n, i, point

         unknown = pack([(i, i=1, size(load))], .not. active_set%gives_force())
         n = size(unknown)
         slope = merge(problem%friction*active_set%slip_direction, 0.0_dp, active_set%is_closed)
         known = merge(problem%reference(), 0.0_dp, active_set%gives_force())
         load = 0.0_dp
         if (any(abs(known) > 0.0_dp)) then
            call problem%matrix%multiply_stiffness(known, load)
            call self%effort%multiply(1.0_dp)
         end if
         load = problem%load - load
         call active_set%turn(load, 1)
         load(m + 1:2*m) = load(m + 1:2*m) - active_set%slip_direction*problem%slip_bound
         before = displacement
         call active_set%turn(before, 1)
         info = 1
         call allocate_matrix(matrix, n, n, "Newton's unknowns", self%error)
         if (allocated(self%error)) return
         allocate (right(n))
         call stiffness%fill_block(unknown, unknown, matrix)
         do i = 1, n
            associate (held => regularization*problem%matrix%augmentation(unknown(i)))
               matrix(i, i) = matrix(i, i) + held
               right(i) = load(unknown(i)) + held*before(unknown(i))
            end associate
         end do
         if (allocated(active_set%axes)) then
            known = problem%reference()
            call active_set%turn(known, 1)
            do i = 1, n
               point = unknown(i) - 2*m
               if (point < 1) cycle
               matrix(i, i) = matrix(i, i) + active_set%spring(point)
               right(i) = right(i) + active_set%spring(point)*known(unknown(i))
            end do
         end if
         do i = 1, n
            point = unknown(i) - m
            if (point < 1 .or. point > m) cycle
            if (.not. abs(slope(point)) > 0.0_dp) cycle
            matrix(i, :) = matrix(i, :) - slope(point)*stiffness%values(unknown, point)
            right(i) = right(i) - slope(point)*load(point)
         end do
         call self%effort%factorize(n > 0)
         call lu_solve(matrix, right, info)
         if (.not. all(ieee_is_finite(right))) info = 1
         if (info /= 0) return
         displacement = problem%reference()
         displacement(unknown) = right
         call active_set%turn(displacement, -1)
         call problem%matrix%multiply_stiffness(displacement, force)
         force = problem%load - force
         call active_set%impose(problem, force, imbalance)
         call self%effort%multiply(1.0_dp)
      end subroutine step_on_stiffness

      !> Solves for the displacements of the whole body, then takes the forces from the equilibrium.
      subroutine step_on_band()
         type(equations_t) :: equations
         real(dp), allocatable :: x(:), balanced(:)

         associate (band => problem%matrix%band, place => problem%matrix%band%place)
            call new_equations(equations, problem, active_set%slip_direction)
            equations%is_known(place) = active_set%gives_force()
            equations%known(place) = merge(problem%reference(), 0.0_dp, equations%is_known(place))
            equations%stiffening(place) = regularization*band%diagonal
            equations%load(place) = equations%load(place) + regularization*band%diagonal*displacement
            equations%slope = merge(problem%friction*active_set%slip_direction, 0.0_dp, active_set%is_closed)
            call solve_equations(self, problem, equations, x, info)
            if (info /= 0) return
            displacement = x(place)
            allocate (balanced(size(x)))
            call band%whole%multiply(x, balanced)
            balanced(place) = balanced(place) - problem%load
            force = -balanced(place)
            balanced(place) = 0.0_dp
            call active_set%impose(problem, force, imbalance)
            imbalance = max(imbalance, maxval(abs(balanced)))
         end associate
         call self%effort%multiply(1.0_dp)
      end subroutine step_on_band

   end subroutine newton_system_solve

   !> Solves for the forces, then takes the displacements from them: there is no imbalance.
   subroutine step_on_compliance(self, problem, compliance, active_set, regularization, displacement, force, info)
      class(newton_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(symmetric_matrix_t), intent(in) :: compliance !! A in the axes of the slips
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), allocatable :: right(:, :)
      real(dp), dimension(size(force)) :: load, solution, known
      logical :: is_unknown(size(force)), is_kept
      ! Largest ratio of the factorized regularization to the required one; a smaller one does not suffice, a much
      ! larger one is slow.
      real(dp), parameter :: spread = 10.0_dp
      integer :: i, m

      m = problem%n_points
      if (.not. allocated(self%diagonal)) self%diagonal = 1.0_dp/problem%matrix%augmentation
      info = 0
      is_kept = self%regularization >= regularization .and. self%regularization <= spread*regularization &
         .and. .not. allocated(active_set%axes)
      if (is_kept) is_kept = active_set%equals(self%base)
      if (.not. is_kept) then
         self%base = active_set
         self%regularization = regularization
         self%softness = regularization*self%diagonal
         is_unknown = active_set%gives_force()
         if (allocated(active_set%axes)) then
            associate (spring => active_set%spring, across => self%softness(2*m + 1:))
               is_unknown(2*m + 1:) = is_unknown(2*m + 1:) .or. spring > 0.0_dp
               where (spring > 0.0_dp .and. active_set%slip_direction /= 0) across = across + 1.0_dp/spring
            end associate
         end if
         self%unknown = pack([(i, i=1, size(force))], is_unknown)
         call self%effort%factorize(size(self%unknown) > 0)
         if (compliance%is_sparse()) then
            call factorize_sparse(self, problem, compliance, info)
         else
            call factorize_dense(self, problem, compliance%values, info)
         end if
         if (info /= 0) self%regularization = -1.0_dp
         if (info /= 0) return
      end if
      load = problem%dual_load(displacement)
      call active_set%turn(load, 1)
      call active_set%turn(force, 1)
      solution = 0.0_dp
      solution(m + 1:2*m) = self%base%slip_direction*problem%slip_bound
      known = 0.0_dp
      if (any(abs(solution) > 0.0_dp)) then
         call compliance%multiply(solution, known)
         call self%effort%multiply(1.0_dp)
      end if
      associate (unknown => self%unknown)
         allocate (right(size(unknown), 1))
         right(:, 1) = load(unknown) - known(unknown) + self%regularization*self%diagonal(unknown)*force(unknown)
         call solve_unknown(self, right, info)
         solution(unknown) = right(:, 1)
      end associate
      solution(m + 1:2*m) = solution(m + 1:2*m) + self%base%slip_direction*problem%friction*solution(:m)
      if (.not. all(ieee_is_finite(solution))) info = 1
      if (info == 0) force = solution
      call active_set%turn(force, -1)
      if (info /= 0) return
      call active_set%turn(load, -1)
      displacement = problem%displacement(load, force)
      call self%effort%multiply(1.0_dp)
   end subroutine step_on_compliance

   !> Finds the pair of the stiffest springs.
   subroutine spring_start_solve(self, problem, solution, error)
      class(spring_start_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, on a band
      type(contact_solution_t), intent(inout) :: solution !! the result
      type(error_t), allocatable, intent(out) :: error !! never allocated; kept for the common interface
      real(dp), parameter :: hardest = 10.0_dp, factor = 10.0_dp
      integer, parameter :: most_steps = 4
      type(newton_system_t) :: system
      type(equations_t) :: equations
      type(active_set_t) :: active_set, last
      real(dp), dimension(problem%matrix%n) :: rho, force, no_force
      real(dp), allocatable :: x(:)
      real(dp) :: scale, hardness
      integer :: step, info, m

      m = problem%n_points
      call solution%reset()
      rho = problem%matrix%augmentation
      scale = problem%force_scale()
      no_force = 0.0_dp
      call active_set%assume_stick(problem, rho, scale)
      hardness = 1.0_dp/real(m, dp)**2
      do while (hardness <= hardest)
         do step = 1, most_steps
            associate (place => problem%matrix%band%place)
               call new_equations(equations, problem, active_set%slip_direction)
               equations%stiffening(place) = merge(hardness*rho, 0.0_dp, active_set%gives_force())
               equations%load(place) = equations%load(place) + equations%stiffening(place)*problem%reference()
               equations%coupling = active_set%slip_direction*problem%friction*equations%stiffening(place(:m))
               equations%load(place(m + 1:)) = equations%load(place(m + 1:)) + equations%coupling*problem%gap
               call solve_equations(system, problem, equations, x, info)
               if (info /= 0 .or. solution%n_iterations >= self%max_iterations) exit
               solution%displacement = x(place)
               call problem%matrix%band%whole%multiply(x, equations%load)
               force = problem%load - equations%load(place)
            end associate
            call solution%record_residual(problem%violation(solution%displacement, force)/scale)
            last = active_set
            call active_set%update(problem, hardness*rho, solution%displacement, no_force)
            if (active_set%equals(last)) exit
         end do
         ! Forces of the springs, cut to the contact law: Newton's first active set is that of these springs.
         solution%force = hardness*rho*(solution%displacement - problem%reference())
         hardness = factor*hardness
      end do
      solution%force = problem%cut(solution%force)
      solution%effort = system%effort
      call solution%measure(problem)
   end subroutine spring_start_solve

   !> Makes the equations of a body without contact forces except for the given slip bounds.
   pure subroutine new_equations(equations, problem, direction)
      type(equations_t), intent(out) :: equations !! the equations
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: direction(:) !! sign of the slip of each point, 0 if it sticks (m)

      associate (n => problem%matrix%band%whole%n, m => problem%n_points)
         allocate (equations%is_known(n), source=.false.)
         allocate (equations%known(n), equations%stiffening(n), equations%load(n), source=0.0_dp)
         allocate (equations%slope(m), equations%coupling(m), source=0.0_dp)
         equations%load(problem%matrix%band%place) = problem%load - [spread(0.0_dp, 1, m), direction*problem%slip_bound]
      end associate
   end subroutine new_equations

   !> Solves the equations, with one step of refinement: the condition of a slender body is high. In their matrix the
   !> rows and columns of known displacements are those of the unit matrix.
   subroutine solve_equations(system, problem, equations, x, info)
      class(newton_system_t), intent(inout) :: system !! gains the factors
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(equations_t), intent(in) :: equations !! the equations
      real(dp), allocatable, intent(out) :: x(:) !! all displacements by position (n) [L]
      integer, intent(out) :: info !! 0, or nonzero where the equations have no finite solution
      real(dp), allocatable :: right(:)
      integer :: i, j, p

      associate (whole => problem%matrix%band%whole, is_known => equations%is_known, slope => equations%slope, &
         normal => problem%matrix%band%place(:problem%n_points), matrix => system%band_factors, &
         tangential => problem%matrix%band%place(problem%n_points + 1:))
         ! A tangential row reaches as far as its normal one.
         call new_band_matrix(matrix, whole%n, whole%width + problem%matrix%band%reach)
         do j = 1, whole%n
            if (is_known(j)) then
               call matrix%add(j, j, 1.0_dp)
               cycle
            end if
            call matrix%add(j, j, whole%entry(1, j) + equations%stiffening(j))
            do i = j + 1, min(whole%n, j + whole%width)
               if (is_known(i)) cycle
               call matrix%add(i, j, whole%entry(i - j + 1, j))
               call matrix%add(j, i, whole%entry(i - j + 1, j))
            end do
         end do
         do p = 1, problem%n_points
            if (abs(equations%coupling(p)) > 0.0_dp) call matrix%add(tangential(p), normal(p), equations%coupling(p))
            if (.not. abs(slope(p)) > 0.0_dp) cycle
            do j = max(1, normal(p) - whole%width), min(whole%n, normal(p) + whole%width)
               if (.not. is_known(j)) call matrix%add(tangential(p), j, -slope(p)*whole%element(normal(p), j))
            end do
         end do
         call matrix%factorize(info)
         call system%effort%factorize(.true.)
         x = equations%known
         if (info /= 0) return
         allocate (right, mold=x)
         do i = 1, 2
            ! The load minus the forces that the given displacements cause; 0 in the rows of known displacements.
            call whole%multiply(x, right)
            right(tangential) = right(tangential) - slope*(right(normal) - problem%load(:problem%n_points))
            right = equations%load - right - equations%stiffening*x
            right(tangential) = right(tangential) - equations%coupling*x(normal)
            where (is_known) right = 0.0_dp
            call matrix%solve(right)
            x = x + right
         end do
      end associate
      if (.not. all(ieee_is_finite(x))) info = 1
   end subroutine solve_equations

   !> Factorizes the system of the base on a dense compliance: writes the transposed matrix of the active set to the
   !> first of its entries, and makes its factor of it.
   subroutine factorize_dense(self, problem, a, info)
      class(newton_system_t), target, intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), contiguous, intent(in) :: a(:, :) !! A in the axes of the slips (n, n) [L/F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), pointer, contiguous :: factor(:, :)
      real(dp) :: slopes(problem%n_points)
      integer :: i, j, n

      if (.not. allocated(self%entries)) allocate (self%entries(0))
      n = size(self%unknown)
      if (size(self%entries, kind=int64) < int(n, int64)**2) then
         deallocate (self%entries)
         allocate (self%entries(int(n, int64)**2), stat=info)
         if (info /= 0) then
            call new_error(self%error, system_failure, 'not enough memory: a dense matrix of '//to_text(n)// &
               ' unknown contact forces needs '//to_text(nint(8.0e-6_dp*real(n, dp)**2, int64))//' MB')
            return
         end if
      end if
      self%is_symmetric = .not. any(self%base%is_closed .and. self%base%slip_direction /= 0 &
         .and. problem%friction > 0.0_dp)
      factor(1:n, 1:n) => self%entries
      slopes = self%base%slip_direction*problem%friction
      associate (unknown => self%unknown, m => problem%n_points)
         do i = 1, n
            do j = 1, n
               factor(j, i) = a(unknown(j), unknown(i))
            end do
            do j = 1, count(unknown <= m)
               factor(j, i) = factor(j, i) + slopes(unknown(j))*a(m + unknown(j), unknown(i))
            end do
            factor(i, i) = factor(i, i) + self%softness(unknown(i))
         end do
      end associate
      if (self%is_symmetric) then
         call cholesky_factor(factor, info)
      else
         call lu_factor(factor, self%pivots, info)
      end if
   end subroutine factorize_dense

   !> Solves the factorized system for the unknown forces.
   subroutine solve_unknown(self, right, info)
      class(newton_system_t), target, intent(in) :: self !! the system
      real(dp), contiguous, intent(inout) :: right(:, :) !! right-hand side, then the solution (any, 1)
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), pointer, contiguous :: factor(:, :)

      info = 0
      if (.not. allocated(self%entries)) then
         if (size(right) > 0) call self%sparse_factors%solve_transposed(right(:, 1), info)
         return
      end if
      factor(1:size(right), 1:size(right)) => self%entries
      if (self%is_symmetric) then
         call cholesky_solve(factor, right)
      else
         call lu_solve_transposed(factor, self%pivots, right)
      end if
   end subroutine solve_unknown

   !> Factorizes the system of the base on a sparse compliance, which stays sparse.
   subroutine factorize_sparse(self, problem, a, info)
      class(newton_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(symmetric_matrix_t), intent(in) :: a !! A in the axes of the slips [L/F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      type(entries_t) :: entries
      integer :: place(problem%matrix%n), i, k, m, point
      real(dp) :: share

      m = problem%n_points
      place = 0
      place(self%unknown) = [(i, i=1, size(self%unknown))]
      do i = 1, size(self%unknown)
         call entries%add(i, i, self%softness(self%unknown(i)))
         do k = a%first(self%unknown(i)), a%first(self%unknown(i) + 1) - 1
            point = a%row(k)
            share = 1.0_dp
            ! The entries of a sliding point's tangential row are added to the column of its normal force.
            if (place(point) == 0 .and. point > m .and. point <= 2*m) then
               point = point - m
               share = self%base%slip_direction(point)*problem%friction(point)
            end if
            call entries%add(place(point), i, share*a%entry(k))
         end do
      end do
      info = 0
      if (size(self%unknown) > 0) call self%sparse_factors%factorize(size(self%unknown), entries, info)
   end subroutine factorize_sparse

end module amontons_newton
