!> Semismooth Newton in the form of an active-set method (Alart and Curnier, CMAME 92, 1991): assume the state of
!> every point, solve the linear system that this active set gives, read the next active set off its solution, repeat.
!> Once an active set repeats itself the solution is exact.
!>
!> Steps are proximal: a regularization, a part of the diagonal, holds the unknowns to where they were. As in the method
!> of Levenberg and Marquardt it grows when the residual does and shrinks when the residual does: active sets that leave
!> the system singular are passed, and near the solution the steps are Newton's. Where active sets would repeat in a
!> cycle, single points change (after Murty's principal pivoting, which changes the last index that is infeasible and
!> ends for every P-matrix).
module amontons_newton
   use amontons_contact_problem, only: active_set_t, contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, effort_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: bounded
   use amontons_kinds, only: dp, int64
   use amontons_newton_system, only: newton_system_t
   implicit none (type, external)
   private

   public :: newton_t, visited_sets_t

   !> What divides the regularization after a step that was better, and after one that left the active set as it was.
   !> More spoils semidefinite problems, whose active sets then never settle.
   real(dp), parameter :: reduction = 3.0_dp, fast_reduction = 90.0_dp

   !> A residual that falls to a larger part of itself in a step that leaves the active set falls slowly; the
   !> regularization may then go below the least one, as far as this.
   real(dp), parameter :: slow_convergence = 0.5_dp, lowest_regularization = 1.0e-12_dp

   !> The semismooth Newton method, in the displacements of a body and in the forces of a reduced problem.
   type, extends(contact_method_t) :: newton_t
      real(dp) :: max_regularization = 1.0_dp
         !! largest regularization, as part of the diagonal: more ends cycles, but is slow where there are none [-]
      integer :: patience = huge(1) !! how many steps without a better pair end the iteration
      real(dp) :: decrease = 0.999_dp !! least residual after a better pair, at the most, over the one before [-]
   contains
      procedure :: solve => newton_solve
   end type newton_t

   !> The active sets since the residual last fell.
   type :: visited_sets_t
      private
      integer(int64), allocatable :: key(:) !! a number for each of them
      real(dp) :: residual = huge(1.0_dp) !! the least residual so far [-]
   contains
      procedure :: avoid => visited_sets_avoid
      procedure :: note_residual => visited_sets_note_residual
   end type visited_sets_t

contains

   !> Takes steps, and keeps the best pair where none is the solution.
   subroutine newton_solve(self, problem, solution, error)
      class(newton_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(newton_system_t) :: system
      type(active_set_t) :: active_set, last
      type(visited_sets_t) :: visited
      real(dp), dimension(2*problem%n_points) :: displacement, force, rho, before
      real(dp) :: scale, regularization, min_regularization, least, residual, previous, imbalance
      integer :: info
      logical :: is_repeated, may_continue
      real(dp), parameter :: travels = 2.0_dp, least_in_forces = 1.0e-5_dp, least_of_loose_body = 1.0e-9_dp

      call solution%reset()
      rho = problem%augmentation()
      scale = problem%force_scale()
      displacement = solution%displacement
      force = solution%force
      ! From rest the first active set is that all points stick, unless nothing acts.
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
         before = displacement
         call system%solve(problem, active_set, regularization, displacement, force, imbalance, info)
         call solution%effort%add(system%effort)
         system%effort = effort_t()
         if (allocated(system%error)) then
            call move_alloc(system%error, error)
            return
         end if
         if (info /= 0) then
            ! No step: the same active set again, held more firmly, unless it was held as firmly as can be.
            if (.not. regularization < self%max_regularization) exit
            call solution%record_residual(previous)
            call grow(regularization, self%max_regularization)
            cycle
         end if
         last = active_set
         call halt(problem, scale, before, displacement, force, imbalance, solution%effort)
         call active_set%update(problem, rho, displacement, force)
         residual = max(problem%violation(displacement, force), imbalance)/problem%force_scale(force, displacement)
         if (residual <= self%tolerance) then
            call solution%record(problem, displacement, force, self%tolerance, may_continue)
            if (.not. may_continue) return
         else
            call solution%record_residual(residual)
            if (residual < solution%residual) then
               solution%displacement = displacement
               solution%force = force
               solution%residual = residual
            end if
         end if
         call visited%note_residual(residual)
         call visited%avoid(active_set, last, is_repeated)
         ! Singular active sets have led the body far away.
         if (is_repeated) displacement = problem%reference()
         ! A singular active set stays, with the same residual, while the body travels to where another begins.
         if (residual/previous > merge(travels, 1.0_dp, active_set%equals(last))) then
            call grow(regularization, self%max_regularization)
         else if (.not. active_set%equals(last)) then
            min_regularization = least
            regularization = max(min_regularization, regularization/reduction)
         else
            ! The statuses are found, and only the regularization stands between them and their forces.
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

   !> Ends a step of a loose body that its active set lets slide or fly, held by the regularization alone, much longer
   !> than forces of this size deform a body, where the contact law would end it: where the forces of springs between
   !> the points and the obstacle, cut to the law, first do as much work against the step as the loads do along it.
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

   !> Makes a regularization larger.
   pure subroutine grow(regularization, most)
      real(dp), intent(inout) :: regularization !! the regularization [-]
      real(dp), intent(in) :: most !! the largest that it may be [-]
      real(dp), parameter :: factor = 10.0_dp, from_nothing = 1.0e-9_dp

      regularization = min(most, max(from_nothing, factor*regularization))
   end subroutine grow

   !> Forgets the active sets where the residual falls: what leads on is no circle.
   pure subroutine visited_sets_note_residual(self, residual)
      class(visited_sets_t), intent(inout) :: self !! the active sets
      real(dp), intent(in) :: residual !! residual after a step [-]
      real(dp), parameter :: decrease = 0.9_dp

      if (allocated(self%key) .and. .not. residual < decrease*self%residual) return
      self%residual = min(residual, self%residual)
      if (allocated(self%key)) deallocate (self%key)
      allocate (self%key(0))
   end subroutine visited_sets_note_residual

   !> Adds the active set that a step leads to; changes it if it is there already. If the change of no single point
   !> leads to a new one, it stays: the regularization has to lead on then.
   pure subroutine visited_sets_avoid(self, active_set, last, is_repeated)
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
            if (trial%equals(last)) cycle
            if (all(self%key /= key_of(trial))) exit
            ! The way from one direction of slip to the other leads through sticking.
            if (trial%slip_direction(p)*last%slip_direction(p) >= 0) cycle
            trial%slip_direction(p) = 0
            if (all(self%key /= key_of(trial))) exit
         end do
         if (p > 0) active_set = trial
      end if
      self%key = [self%key, key_of(active_set)]
   end subroutine visited_sets_avoid

   !> A number that tells active sets apart, all but surely.
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

end module amontons_newton
