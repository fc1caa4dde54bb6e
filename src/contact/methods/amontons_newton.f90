!> Semismooth Newton in the form of an active-set method (Alart and Curnier, CMAME 92, 1991): assume the state of
!> every point, solve the linear system that this active set gives, read the next active set off its solution, repeat.
!> Once an active set repeats itself the solution is exact.
!>
!> Steps are proximal: a regularization, a part of the diagonal, holds the unknowns to where they were. As in the method
!> of Levenberg and Marquardt it grows when the residual does and shrinks when the residual does: active sets that leave
!> the system singular are passed, and near the solution the steps are Newton's. Where active sets would repeat in a
!> cycle, single points change.
module amontons_newton
   use amontons_active_set, only: active_set_t
   use amontons_band_stiffness_system, only: band_stiffness_system_t
   use amontons_compliance_system, only: compliance_system_t
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_effort, only: effort_t
   use amontons_error, only: error_t
   use amontons_force_system, only: sparse_compliance_system_t
   use amontons_friction_law, only: bounded
   use amontons_kinds, only: dp
   use amontons_newton_system, only: newton_system_t, stiffness_system_t
   use amontons_proximal_path, only: follow_proximal_path
   use amontons_visited_sets, only: visited_sets_t
   implicit none (type, external)
   private

   public :: newton_t

   !> What divides the regularization after a step that was better, and after one that left the active set as it was.
   !> More spoils semidefinite problems, whose active sets then never settle.
   real(dp), parameter :: reduction = 3.0_dp, fast_reduction = 90.0_dp

   !> A residual that falls to a larger part of itself in a step that leaves the active set falls slowly; the
   !> regularization may then go below the least one, as far as this.
   real(dp), parameter :: slow_convergence = 0.5_dp, lowest_regularization = 1.0e-12_dp

   !> The semismooth Newton method, in the displacements of a body and in the forces of a reduced problem.
   type, extends(contact_method_t) :: newton_t
      real(dp) :: max_regularization = 1.0_dp !! largest regularization, as part of the diagonal [-]
      integer :: stagnation_limit = huge(1) !! how many steps without a better pair end the iteration
      real(dp) :: decrease = 0.9_dp !! least residual after a better pair, at the most, over the one before [-]
      logical :: starts_with_springs = .false. !! whether springs lead to the first active set, on a band matrix
      integer :: patience = 15 !! how many steps without a better pair lead to proximal ones; none in the forces
   contains
      procedure :: solve => newton_solve
      procedure, private :: find_start => newton_find_start
      procedure, private :: is_stuck => newton_is_stuck
      procedure, private :: record_step => newton_record_step
   end type newton_t

contains

   !> Takes steps and, where these lead nowhere, proximal steps from the start. Where these lead nowhere either, the
   !> first steps go on: a front may take long to arrive. Keeps the best pair where none is the solution.
   recursive subroutine newton_solve(self, problem, solution, error)
      class(newton_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! never allocated; kept for the common interface
      ! Of a step between springs; those that are solved take about three.
      integer, parameter :: steps_of_one = 6
      ! Of all of them: paths that arrive have taken no more.
      integer, parameter :: steps_of_path = 750
      type(contact_solution_t) :: first, start
      type(newton_t) :: alone

      alone = self
      if (.not. problem%matrix%has_stiffness()) alone%patience = huge(1)
      start = solution
      first = solution
      call take_steps(alone, problem, first)
      if (first%is_converged .or. first%n_iterations >= self%max_iterations .or. alone%patience == huge(1)) then
         solution = first
         return
      end if
      alone%patience = huge(1)
      alone%max_iterations = steps_of_one
      alone%starts_with_springs = .false.
      call follow_proximal_path(alone, problem, min(steps_of_path, self%max_iterations - first%n_iterations), &
         solution, error)
      call solution%follow(first)
      call solution%take_better(first)
      if (solution%is_converged .or. allocated(error) .or. solution%n_iterations >= self%max_iterations) return
      alone = self
      alone%patience = huge(1)
      alone%max_iterations = self%max_iterations - solution%n_iterations
      call take_steps(alone, problem, start)
      first = solution
      solution = start
      call solution%follow(first)
      call solution%take_better(first)
   end subroutine newton_solve

   !> Takes steps, and keeps the best pair where none is the solution.
   subroutine take_steps(self, problem, solution)
      class(newton_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      class(newton_system_t), allocatable :: system
      type(active_set_t) :: active_set, last
      type(visited_sets_t) :: visited
      real(dp), dimension(2*problem%n_points) :: displacement, force, rho, before
      real(dp) :: scale, regularization, min_regularization, residual, previous, violation, imbalance
      integer :: n_spring_steps, info
      logical :: is_repeated, may_continue

      call solution%reset()
      call new_system(system, problem)
      rho = problem%augmentation()
      scale = problem%force_scale()
      displacement = solution%displacement
      force = solution%force
      call self%find_start(system, problem, rho, scale, active_set, displacement, solution)
      n_spring_steps = solution%n_iterations
      regularization = system%first_regularization
      min_regularization = system%min_regularization
      previous = huge(previous)
      do while (solution%n_iterations < self%max_iterations)
         before = displacement
         call system%solve(problem, active_set, regularization, displacement, force, imbalance, info)
         call solution%effort%add(system%effort)
         system%effort = effort_t()
         if (info /= 0) then
            ! No step: the same active set again, held more firmly, unless it was held as firmly as can be.
            if (.not. regularization < self%max_regularization) exit
            call solution%record_residual(previous)
            call grow(regularization, self%max_regularization)
            cycle
         end if
         last = active_set
         call halt(problem, scale, before, displacement, force, imbalance, solution%effort)
         call active_set%update(problem, rho, displacement, force, violation)
         residual = max(violation, imbalance)/problem%force_scale(force, displacement)
         call self%record_step(problem, displacement, force, residual, solution, may_continue)
         if (.not. may_continue) return
         call visited%note_residual(residual)
         call visited%avoid(active_set, last, is_repeated)
         ! Singular active sets have led the body far away.
         if (is_repeated) displacement = problem%reference()
         call adapt(regularization, min_regularization, system%min_regularization, self%max_regularization, &
            residual/previous, active_set%equals(last))
         previous = residual
         if (self%is_stuck(solution, n_spring_steps)) exit
      end do
      ! A residual still at its first value, the largest number, means that there was no step.
      if (solution%residual < huge(solution%residual)) call solution%measure(problem)
   end subroutine take_steps

   !> Makes the first active set. From rest it is that all points stick, unless nothing acts.
   subroutine newton_find_start(self, system, problem, rho, scale, active_set, displacement, solution)
      class(newton_t), intent(in) :: self !! the method
      class(newton_system_t), intent(inout) :: system !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: rho(:) !! stiffness of the points (2m) [F/L]
      real(dp), intent(in) :: scale !! the force that residuals are measured by [F]
      type(active_set_t), intent(inout) :: active_set !! state of each point
      real(dp), intent(inout) :: displacement(:) !! v (2m) [L]
      type(contact_solution_t), intent(inout) :: solution !! gains a record of the steps, if there are any
      real(dp) :: violation

      call active_set%update(problem, rho, displacement, solution%force, violation)
      if (.not. (any(solution%force(:problem%n_points) > 0.0_dp) .or. problem%is_unloaded())) then
         call active_set%assume_stick(problem, rho, scale)
      end if
      select type (system)
      type is (band_stiffness_system_t)
         if (self%starts_with_springs) call harden(system, problem, rho, scale, self%max_iterations, active_set, &
            displacement, solution)
      end select
   end subroutine newton_find_start

   !> Finds a first active set in a way that lets fronts of opening or sliding pass, which Newton's steps move by a few
   !> points each: by springs between the points and the obstacle, so soft at first that the ends of the line feel each
   !> other, and so hard at last that neighbors hardly do.
   subroutine harden(system, problem, rho, scale, max_iterations, active_set, displacement, solution)
      type(band_stiffness_system_t), intent(inout) :: system !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: rho(:) !! stiffness of the points (2m) [F/L]
      real(dp), intent(in) :: scale !! the force that residuals are measured by [F]
      integer, intent(in) :: max_iterations !! most steps
      type(active_set_t), intent(inout) :: active_set !! state of each point
      real(dp), intent(inout) :: displacement(:) !! v, and then that of the hardest springs (2m) [L]
      type(contact_solution_t), intent(inout) :: solution !! gains a record of the steps
      real(dp), parameter :: hardest = 10.0_dp, factor = 10.0_dp
      integer, parameter :: most_steps = 4
      real(dp), dimension(size(rho)) :: next, force, no_force
      type(active_set_t) :: last
      real(dp) :: hardness, violation
      integer :: step, info

      no_force = 0.0_dp
      call active_set%assume_stick(problem, rho, scale)
      hardness = 1.0_dp/real(problem%n_points, dp)**2
      do while (hardness <= hardest)
         do step = 1, most_steps
            call system%solve_softened(problem, active_set, hardness*rho, next, force, info)
            call solution%effort%add(system%effort)
            system%effort = effort_t()
            if (info /= 0 .or. solution%n_iterations >= max_iterations) exit
            displacement = next
            call solution%record_residual(problem%violation(displacement, force)/scale)
            last = active_set
            call active_set%update(problem, hardness*rho, displacement, no_force, violation)
            if (active_set%equals(last)) exit
         end do
         hardness = factor*hardness
      end do
   end subroutine harden

   !> Ends a step of a loose body that its active set lets slide or fly, held by the regularization alone, much longer
   !> than forces of the size at hand deform a body, where the contact law would end it: where the forces of springs
   !> between the points and the obstacle, cut to the law, first do as much work against the step as the loads do along
   !> it.
   pure subroutine halt(problem, scale, before, displacement, force, imbalance, effort)
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
      rho = problem%augmentation()
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
         augmented = force + rho*(before + middle*step - problem%reference())
         augmented(:m) = max(0.0_dp, augmented(:m))
         augmented(m + 1:) = bounded(augmented(m + 1:), problem%bound(augmented(:m)))
         if (dot_product(step, drive - middle*stiffening - augmented) > 0.0_dp) then
            low = middle
         else
            high = middle
         end if
      end do
      displacement = before + high*step
      imbalance = scale
   end subroutine halt

   !> Whether the last steps brought no pair that is better. Cycles of active sets may creep on all the same.
   pure logical function newton_is_stuck(self, solution, n_spring_steps) result(is_stuck)
      class(newton_t), intent(in) :: self !! the method
      type(contact_solution_t), intent(in) :: solution !! the solution
      integer, intent(in) :: n_spring_steps !! how many steps went before, with springs
      ! Fronts that advance along a contact line may make each step only a little better than the one before.
      real(dp), parameter :: slow_decrease = 0.999_dp

      is_stuck = solution%is_stagnant(self%stagnation_limit, self%decrease, n_spring_steps + 1) &
         .or. solution%is_stagnant(self%patience, slow_decrease, n_spring_steps + 1)
   end function newton_is_stuck

   !> Makes the regularization of the next step.
   pure subroutine adapt(regularization, least, first_min, most, ratio, stays)
      real(dp), intent(inout) :: regularization !! the regularization [-]
      real(dp), intent(inout) :: least !! the least that it may be [-]
      real(dp), intent(in) :: first_min !! the least that it may be as long as active sets change [-]
      real(dp), intent(in) :: most !! the largest that it may be [-]
      real(dp), intent(in) :: ratio !! residual after the step over the one before [-]
      logical, intent(in) :: stays !! whether the step left the active set as it was
      real(dp), parameter :: travels = 2.0_dp

      ! A singular active set stays, with the same residual, while the body travels to where another one begins.
      if (ratio > merge(travels, 1.0_dp, stays)) then
         call grow(regularization, most)
      else if (.not. stays) then
         least = first_min
         regularization = max(least, regularization/reduction)
      else
         ! The statuses are found, and only the regularization stands between them and their forces.
         if (ratio > slow_convergence) least = min(least, max(lowest_regularization, least/fast_reduction))
         regularization = max(least, regularization/fast_reduction)
      end if
   end subroutine adapt

   !> Makes a regularization larger.
   pure subroutine grow(regularization, most)
      real(dp), intent(inout) :: regularization !! the regularization [-]
      real(dp), intent(in) :: most !! the largest that it may be [-]
      real(dp), parameter :: factor = 10.0_dp, from_nothing = 1.0e-9_dp

      regularization = min(most, max(from_nothing, factor*regularization))
   end subroutine grow

   !> Counts an iteration, and keeps its pair (v, lambda) in the solution if it is better than the one there; measures
   !> it by the problem if it seems to be solved.
   pure subroutine newton_record_step(self, problem, displacement, force, residual, solution, may_continue)
      class(newton_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: displacement(:) !! v (2m) [L]
      real(dp), intent(in) :: force(:) !! lambda (2m) [F]
      real(dp), intent(in) :: residual !! residual of this pair [-]
      type(contact_solution_t), intent(inout) :: solution !! the solution
      logical, intent(out) :: may_continue !! false when solved

      may_continue = .true.
      if (residual <= self%tolerance) then
         call solution%record(problem, displacement, force, self%tolerance, may_continue)
         return
      end if
      call solution%record_residual(residual)
      if (.not. residual < solution%residual) return
      solution%displacement = displacement
      solution%force = force
      solution%residual = residual
   end subroutine newton_record_step

   !> The linear system that suits a problem. In the displacements a regularization slows the motions that move all
   !> points together, so there is none as long as all goes well; in the forces it costs nothing, and makes the active
   !> sets of semidefinite problems settle.
   subroutine new_system(system, problem)
      class(newton_system_t), allocatable, intent(out) :: system !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem

      if (.not. problem%matrix%has_stiffness()) then
         if (problem%matrix%compliance%is_sparse()) then
            allocate (sparse_compliance_system_t :: system)
         else
            allocate (compliance_system_t :: system)
         end if
         system%min_regularization = 1.0e-5_dp
      else
         if (allocated(problem%matrix%band)) then
            allocate (band_stiffness_system_t :: system)
         else
            allocate (stiffness_system_t :: system)
         end if
         if (.not. problem%matrix%is_held) system%min_regularization = 1.0e-9_dp
         system%first_regularization = system%min_regularization
      end if
   end subroutine new_system

end module amontons_newton
