!> The solution of a contact problem from a start, in the same way for a case, a row of a sweep and a step of a history.
!>
!> A body that nothing loads needs no method. Else first Newton's method from the start, if the method is left to the
!> program. If that does not end well, it is checked whether contact and friction can balance the loads, and then the
!> deck's method is used, with displacements counted from the body's position on its obstacles. Solutions are refined
!> with what they leave unbalanced in the whole body. At last motions that friction cannot hold are looked for.
!> Components of the contact problem are solved each by itself.
!>
!> Such motions are a body that turns without end on a round contact line, slides along a flat one, or along walls off
!> its floor, against friction.
!> `check_balance` assumes unlimited normal forces, and friction with them: friction on opposite sides of a hole bears
!> any moment. Only the solution gives the normal forces. A free rigid motion on which the normals of the round line do
!> no work is opposed by friction alone. If the work of the loads on it is more than friction can take at the normal
!> forces found, the unequal facets of the mesh bear the rest, or the method finds no equilibrium. In the latter case,
!> or if all friction is used up, a weak spring against the motion shows the normal forces while the body turns, before
!> facets have wedged it.
module amontons_load_solver
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_auto, only: auto_t
   use amontons_body, only: body_t, find_rigid_modes
   use amontons_cone, only: least_squares, null_vectors
   use amontons_contact_operator, only: contact_operator_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, new_contact_solution
   use amontons_equilibrium, only: imbalance_of_points
   use amontons_error, only: error_t, new_error, no_equilibrium, numerical_failure
   use amontons_friction_law, only: open_point, tangential_norm
   use amontons_kinds, only: dp
   use amontons_load_family, only: acting_t, load_case_t, load_family_t, new_load_family, parting_t
   use amontons_loose_bodies, only: can_be_wedged, check_balance, find_idle_motion, find_origin, fit_travel, is_round, &
      on_round_line
   use amontons_methods, only: method_options_t, new_contact_method, solve_components
   use amontons_newton, only: newton_t
   use amontons_result, only: outcome_no_equilibrium, outcome_not_converged, outcome_numbers, outcome_solved
   use amontons_rigid_motion, only: largest_motion, orthonormal_modes, resting_motions
   use amontons_rounding, only: computed_rounding, difference_rounding
   use amontons_text, only: short_text
   implicit none (type, external)
   private

   public :: check_balance, forget_start, load_solver_t, new_load_solver, residual_of_strains

   !> Largest number of Newton steps from a start, and of those without a better pair.
   integer, parameter :: n_newton_steps = 20, patience = 4
   real(dp), parameter :: decrease = 0.9_dp
   !> A tenth of the default tolerance is rounding of S, as far as v strains the body: the digits of a long slender body
   !> that bends far resolve no less.
   real(dp), parameter :: least_residual = 1.0e-11_dp

   !> The data that all members of a family of loads share.
   type :: load_solver_t
      type(load_family_t) :: loads !! loads, obstacles and friction
      class(contact_method_t), allocatable :: method !! the deck's method
      logical :: is_auto = .false. !! whether the deck leaves the method to the program
      logical :: shares_factor = .false. !! whether ranks that share one factor solve members side by side
      real(dp) :: size_of_body = 0.0_dp !! the larger side of the bounding box of the mesh [L]
      logical, private :: may_spin = .false. !! whether it may have one that friction alone opposes
   contains
      procedure :: find_free_motions => load_solver_find_free_motions
      procedure :: solve => load_solver_solve
      procedure, private :: refine => load_solver_refine
      procedure, private :: solve_from_motion => load_solver_solve_from_motion
   end type load_solver_t

contains

   !> Makes the solver of a load case in parts. The loads of the family are not condensed yet.
   subroutine new_load_solver(solver, body, load_case, parting, options, error)
      type(load_solver_t), intent(out) :: solver !! the solver
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case with all factors 1
      type(parting_t), intent(in) :: parting !! the part to which each load, support and contact set belongs
      type(method_options_t), intent(in) :: options !! the deck's method
      type(error_t), allocatable, intent(out) :: error !! there is no such method; a load or support does not fit

      call new_contact_method(solver%method, options, error)
      if (.not. allocated(error)) call new_load_family(solver%loads, body, load_case, parting, error)
      if (allocated(error)) return
      solver%is_auto = options%method == 'auto'
      solver%size_of_body = body%size
      call solver%find_free_motions(body)
   end subroutine new_load_solver

   !> Finds the free motions of the body that only friction may oppose.
   subroutine load_solver_find_free_motions(self, body)
      class(load_solver_t), intent(inout) :: self !! the solver
      type(body_t), intent(in) :: body !! the body
      real(dp), allocatable :: on_round(:, :), spins(:, :)

      ! Whether points are in reach of a moving obstacle depends on the member.
      self%may_spin = size(body%rigid_modes, 2) > 0
      if (self%may_spin) then
         call new_spins(spins, on_round, body, self%loads%base%is_in_reach .and. &
            .not. self%loads%parting%moves_obstacles)
         self%may_spin = size(spins, 2) > 0
      end if
   end subroutine load_solver_find_free_motions

   !> Solves the contact problem of a member. Threads may solve members side by side, each with a problem of its own.
   subroutine load_solver_solve(self, body, acting, problem, solution, outcome, reason, error_kind)
      class(load_solver_t), intent(in) :: self !! the solver, its loads condensed
      type(body_t), intent(in) :: body !! the body, condensed
      class(acting_t), intent(in) :: acting !! the member
      type(contact_problem_t), intent(inout) :: problem !! its contact problem, posed; may gain its compliance
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      integer, intent(out) :: outcome !! one of the outcomes of `amontons_result`
      character(:), allocatable, intent(out) :: reason !! why there is no solution; empty for one not converged
      integer, intent(out) :: error_kind !! kind of the error that the reason is
      type(contact_solution_t) :: start, first
      type(load_case_t) :: load_case
      type(error_t), allocatable :: error, ignored
      logical :: is_sure, is_wedged
      real(dp), allocatable :: motion(:), idle(:)
      type(newton_t) :: quick

      reason = ''
      error_kind = numerical_failure
      call find_idle_motion(idle, body, problem, solution%displacement, solution%force)
      start = solution
      call solution%reset()
      if (allocated(idle)) then
         is_wedged = any(abs(start%force) > 0.0_dp)
         if (is_wedged) is_wedged = can_be_wedged(body, problem, acting%is_in_reach)
         if (.not. is_wedged) call rest(idle, solution)
         outcome = outcome_solved
         if (.not. is_wedged) return
      end if
      if (self%is_auto .and. has_start_position(solution)) then
         quick = newton_t(tolerance=self%method%tolerance, max_iterations=min(n_newton_steps, &
            self%method%max_iterations), patience=patience, decrease=decrease)
         ! Displacements are counted from the rigid motion of the start, if the start is hardly anything else. If
         ! memory does not suffice for these steps, it may for the deck's method.
         call fit_travel(motion, body, solution%displacement)
         call self%solve_from_motion(motion, quick, body, acting, problem, solution, ignored)
      end if
      is_sure = solution%is_converged .and. maxval([0.0_dp, abs(solution%displacement)]) <= self%size_of_body
      if (is_sure) is_sure = .not. may_move(body, problem, solution%force)
      if (.not. is_sure) then
         ! gfortran 12 keeps the length of the text that a function returns in a place that all threads share.
         !$omp critical (texts_of_solver)
         call self%loads%load_case(body, acting, load_case)
         call check_balance(body, load_case, error)
         if (allocated(error)) reason = error%message
         !$omp end critical (texts_of_solver)
         if (allocated(error)) then
            outcome = outcome_no_equilibrium
            error_kind = no_equilibrium
            solution%is_converged = .false.
            return
         end if
         if (.not. solution%is_converged) then
            first = solution
            solution = start
            ! Displacements are counted from where the body meets its obstacles.
            call find_origin(motion, body, load_case)
            call self%solve_from_motion(motion, self%method, body, acting, problem, solution, error)
            call solution%prepend(first)
         end if
      end if
      call leave_in_place(self, body, problem, start, solution)
      ! Where the method finds no forces that balance each other, there are none; those of rounding errors of gaps are
      ! none, either.
      if (allocated(idle)) then
         if (.not. solution%is_converged .or. maxval([0.0_dp, abs(solution%force)]) <= difference_rounding &
            *maxval(abs(body%zone%position))*maxval(problem%matrix%augmentation)) call rest(idle, solution)
      end if
      if (allocated(error)) then
         solution%is_converged = .false.
         reason = error%message
         ! Memory ran out, or the method accepts fewer points.
         error_kind = error%kind
         outcome = outcome_numbers
      else
         call judge_solution(self, body, acting, problem, solution, outcome, reason)
      end if
      error_kind = merge(no_equilibrium, error_kind, outcome == outcome_no_equilibrium)
      solution%is_converged = outcome == outcome_solved
   end subroutine load_solver_solve

   !> Whether a free motion moves no point that bears a normal force along the normal, nor one along the tangent whose
   !> shear is below its bound: methods accept a solution for loads a little above what contact and friction bear. Or
   !> whether it strains ties that lie apart: by that they hold a body that tips.
   pure logical function may_move(body, problem, force)
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      real(dp), intent(in) :: force(:) !! a solution's contact forces (n) [F]
      ! Errors of forces, far above those that methods leave.
      real(dp), parameter :: negligible = 1.0e-7_dp
      integer, allocatable :: held(:)
      integer :: i, k

      may_move = body%is_motion_strained
      if (may_move .or. size(body%rigid_modes, 2) == 0) return
      associate (m => body%zone%n_points, shear => tangential_norm(force(body%zone%n_points + 1:), body%zone%n_points))
         held = pack([(i, i=1, size(force))], [force(:m) > negligible*maxval(abs(force)), &
            (shear < (1.0_dp - negligible)*problem%bound(force(:m)), k=1, body%zone%n_tangents)])
      end associate
      may_move = size(resting_motions(body%rigid_modes(held, :)), 2) > 0
   end function may_move

   !> Finds the outcome of a solution: solved, no equilibrium, numbers out of range, or not converged.
   subroutine judge_solution(self, body, acting, problem, solution, outcome, reason)
      class(load_solver_t), intent(in) :: self !! the solver
      type(body_t), intent(in) :: body !! the body
      class(acting_t), intent(in) :: acting !! the member
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(in) :: solution !! the solution, converged or not
      integer, intent(out) :: outcome !! one of the outcomes of `amontons_result`
      character(:), allocatable, intent(inout) :: reason !! empty; gains why there is no solution
      type(error_t), allocatable :: error
      logical :: is_near

      is_near = solution%is_converged .and. maxval([0.0_dp, abs(solution%displacement)]) <= self%size_of_body
      if (self%may_spin .or. .not. is_near .or. size(body%zone%held_node) > 0) then
         ! gfortran 12 keeps the length of the text that a function returns in a place that all threads share.
         !$omp critical (texts_of_solver)
         call self%loads%check_held_nodes(body, acting, error)
         if (.not. allocated(error) .and. (self%may_spin .or. .not. is_near)) call check_spin(body, &
            acting%is_in_reach, problem, solution, is_near, self%size_of_body, error)
         if (allocated(error)) reason = error%message
         !$omp end critical (texts_of_solver)
      end if
      outcome = outcome_no_equilibrium
      if (allocated(error)) return
      call check_numbers(self, problem, solution, reason)
      outcome = merge(outcome_solved, outcome_not_converged, solution%is_converged)
      if (len(reason) > 0) outcome = outcome_numbers
   end subroutine judge_solution

   !> Whether a solution has a position of the body to start from: there is none before it meets its obstacles.
   pure logical function has_start_position(solution)
      type(contact_solution_t), intent(in) :: solution !! the start

      has_start_position = any(abs(solution%force) > 0.0_dp) .or. &
         any(abs(solution%displacement(:size(solution%status))) > 0.0_dp)
   end function has_start_position

   !> Resets the start to rest if nothing loads the body: it stays where it is drawn, as far as overlaps allow, not
   !> where the loads of another case have moved it.
   pure subroutine forget_start(problem, solution)
      type(contact_problem_t), intent(in) :: problem !! the contact problem, posed
      type(contact_solution_t), intent(inout) :: solution !! the start

      if (.not. any(abs(problem%load) > 0.0_dp)) call new_contact_solution(solution, problem%n_points, &
         problem%matrix%n_tangents)
   end subroutine forget_start

   !> Solves a contact problem, with displacements counted from a rigid motion, and refines the solution.
   subroutine load_solver_solve_from_motion(self, motion, method, body, acting, problem, solution, error)
      class(load_solver_t), intent(in) :: self !! the solver, its loads condensed
      real(dp), intent(in) :: motion(:) !! displacements of the points under the motion (n_rows) [L]
      class(contact_method_t), intent(in) :: method !! the contact method
      type(body_t), intent(in) :: body !! the body
      class(acting_t), intent(in) :: acting !! the member
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! the computation failed numerically

      if (has_start_position(solution)) solution%displacement = solution%displacement - motion
      call solve_components(method, problem_from(motion, problem), solution, error)
      if (.not. allocated(error)) call self%refine(motion, method%tolerance, body, acting, problem, solution)
      solution%displacement = solution%displacement + motion
   end subroutine load_solver_solve_from_motion

   !> Refines a solution if the rounding errors of S may count. Its change is the solution of a contact problem with the
   !> same S, whose load is what the strains of the whole body leave unbalanced, and whose gaps are those that are left.
   !> S of a stiff body that only soft ones hold, or of a slender one, has errors as large as its forces, and long
   !> displacements have as large ones in the product with it. Where more than a millionth stays unbalanced along a
   !> free motion there is no solution: the errors of S may hold a body that nothing else does.
   subroutine load_solver_refine(self, origin, tolerance, body, acting, problem, solution)
      class(load_solver_t), intent(in) :: self !! the solver, its loads condensed
      real(dp), intent(in) :: origin(:) !! motion that displacements are counted from (n_rows) [L]
      real(dp), intent(in) :: tolerance !! residual that counts as solved [-]
      type(body_t), intent(in) :: body !! the body, condensed
      class(acting_t), intent(in) :: acting !! the member
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(inout) :: solution
         !! a solution, or one that is not converged for rounding errors; improved if it can be
      integer, parameter :: most_steps = 4
      real(dp), parameter :: least_gain = 0.5_dp, explained = 10.0_dp, few_digits = 1.0e-6_dp ! digits of a force
      type(contact_problem_t) :: change
      type(contact_solution_t) :: next
      type(load_case_t) :: load_case
      type(newton_t) :: newton
      type(error_t), allocatable :: error
      real(dp), allocatable :: lacking(:), remaining(:)
      real(dp) :: scale, largest, errors
      integer :: step

      ! No rank can use a shared factor by itself.
      if (self%shares_factor .or. solution%is_at_rest) return
      scale = problem%force_scale(solution%force, solution%displacement)
      errors = max(problem%rounding, epsilon(errors)*body%condensation%condenser%matrix_norm)*maxval(abs( &
         solution%displacement))
      if (errors <= tolerance*scale) return
      if (.not. (solution%is_converged .or. solution%residual*scale <= explained*errors)) return
      !$omp critical (texts_of_solver)
      call self%loads%load_case(body, acting, load_case)
      !$omp end critical (texts_of_solver)
      newton = newton_t(tolerance=tolerance, max_iterations=n_newton_steps)
      lacking = imbalance_of_points(body, load_case, solution%displacement, solution%force)
      remaining = lacking
      largest = problem%largest(lacking)
      do step = 1, most_steps
         if (solution%is_converged .and. largest <= least_residual*scale) exit
         change = problem_from(origin + solution%displacement, problem)
         change%load = lacking + solution%force
         if (allocated(problem%softness)) then
            call problem%matrix%multiply_stiffness(problem%softness*solution%force, remaining)
            change%load = change%load - remaining
         end if
         next = solution
         next%displacement = 0.0_dp
         call solve_components(newton, change, next, error)
         next%displacement = solution%displacement + next%displacement
         if (allocated(error) .or. .not. next%is_converged) exit
         remaining = imbalance_of_points(body, load_case, next%displacement, next%force)
         if (solution%is_converged .and. .not. problem%largest(remaining) < least_gain*largest) exit
         call next%prepend(solution)
         solution = next
         lacking = remaining
         largest = problem%largest(lacking)
      end do
      largest = maxval([0.0_dp, abs(matmul(lacking, body%travel))])
      if (largest <= few_digits*scale) return
      solution%is_converged = .false.
      solution%residual = largest/scale
   end subroutine load_solver_refine

   !> Puts a body at rest in its place, without forces.
   pure subroutine rest(motion, solution)
      real(dp), intent(in) :: motion(:) !! displacements of the points (n_rows) [L]
      type(contact_solution_t), intent(inout) :: solution !! keeps its record alone

      solution%displacement = motion
      solution%force = 0.0_dp
      solution%status = open_point
      solution%residual = 0.0_dp
      solution%is_converged = .true.
   end subroutine rest

   !> Puts a body that loads strain, but neither drive nor press onto its obstacles, as near to where it was as overlaps
   !> allow. It has a solution without forces in many places, of which a method finds any.
   subroutine leave_in_place(solver, body, problem, start, solution)
      class(load_solver_t), intent(in) :: solver !! the solver
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(in) :: start !! where it was
      type(contact_solution_t), intent(inout) :: solution !! where it is; moved if it needs no forces
      ! Gaps that no body closes, over its size; and forces of a body that tolerance wedges, over loads that cancel.
      real(dp), parameter :: far = 1.0e6_dp, small = 1.0e-6_dp
      type(contact_problem_t) :: unopposed, unloaded
      type(contact_solution_t) :: strained
      type(error_t), allocatable :: error
      real(dp), allocatable :: motion(:)

      if (.not. solution%is_converged .or. size(body%travel, 2) == 0 .or. maxval([0.0_dp, abs(solution%force)]) &
         > small*sum(problem%uncanceled)) return
      unopposed = problem
      unopposed%gap = far*solver%size_of_body
      call solve_on_springs(unopposed, 1.0_dp, body%travel, strained, error)
      if (allocated(error)) return
      unloaded = problem_from(strained%displacement, problem)
      unloaded%load = 0.0_dp
      call find_idle_motion(motion, body, unloaded, start%displacement - strained%displacement, start%force)
      if (.not. allocated(motion)) return
      strained%force = 0.0_dp
      call strained%measure(problem_from(motion, problem))
      if (strained%residual <= solver%method%tolerance) call rest(strained%displacement + motion, solution)
   end subroutine leave_in_place

   !> The contact problem for the displacements relative to a rigid motion that strains nothing and causes no forces.
   function problem_from(motion, problem) result(counted)
      real(dp), intent(in) :: motion(:) !! displacements of the points under the motion (n_rows) [L]
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      type(contact_problem_t) :: counted

      counted = problem
      counted%gap = problem%gap - motion(:problem%n_points)
      counted%anchor = problem%anchor - motion(problem%n_points + 1:)
   end function problem_from

   !> The residual of a pair (v, lambda), with displacements counted from the nearest free rigid motion. Forces that the
   !> rounding errors of gaps make, which are differences of coordinates, are no residual; nor are rounding errors of
   !> what strains the body and of the forces before unloading [-].
   real(dp) function residual_of_strains(body, problem, solution, carried_force) result(residual)
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(in) :: problem !! its contact problem, posed
      type(contact_solution_t), intent(in) :: solution !! displacements and forces
      real(dp), intent(in) :: carried_force !! largest sum of the points' forces before [F]
      real(dp), parameter :: rounding = 100.0_dp*epsilon(1.0_dp), rounding_share = 1.0e-5_dp ! of coordinates, of forces
      real(dp), dimension(problem%matrix%n) :: motion, strains
      type(contact_problem_t) :: counted
      real(dp) :: scale, of_coordinates

      residual = 0.0_dp
      if (problem%n_points == 0) return
      motion = matmul(body%travel, least_squares(body%travel, solution%displacement))
      strains = solution%displacement - motion
      counted = problem_from(motion, problem)
      call counted%measure(strains, solution%force, residual, scale)
      of_coordinates = rounding*maxval(abs(body%zone%position))*maxval(problem%matrix%augmentation)
      residual = max(0.0_dp, residual*scale - of_coordinates)/max(scale, rounding_share*carried_force &
         /problem%n_points, problem%rounding/least_residual*maxval(abs(strains)))
   end function residual_of_strains

   !> Refuses a solution whose numbers are not finite, or whose displacements are so large that their rounding errors
   !> cause forces as large as the loads.
   subroutine check_numbers(solver, problem, solution, fault)
      type(load_solver_t), intent(in) :: solver !! the solver, for the size of the body
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      type(contact_solution_t), intent(in) :: solution !! the solution
      character(:), allocatable, intent(inout) :: fault !! empty; gains why it is refused, if it is
      ! Below this limit the solution has no forces: an unloaded body beside its obstacle or on its supports.
      real(dp), parameter :: no_digit = 0.1_dp, far = 100.0_dp
      real(dp) :: way, rounding, forces

      ! A residual still at its first value, the largest number, means that no iteration gave a finite one.
      if (.not. (solution%residual < huge(solution%residual) .and. all(ieee_is_finite(solution%force)) &
         .and. all(ieee_is_finite(solution%displacement)))) then
         fault = 'floating-point overflow in the contact method: check the units of stiffness, load and friction'
         return
      end if
      way = maxval(abs(solution%displacement))
      if (.not. way > far*max(solver%size_of_body, problem%prescribed)) return
      rounding = epsilon(rounding)*maxval(problem%matrix%augmentation*abs(solution%displacement))
      forces = max(maxval(abs(problem%load)), maxval(abs(solution%force)))
      if (.not. rounding > no_digit*forces) return
      !$omp critical (texts_of_solver)
      fault = 'the contact points move by '//short_text(way)//', so far that rounding leaves no digit of their '// &
         'forces (up to '//short_text(forces)//'): place the body closer to its obstacle'
      !$omp end critical (texts_of_solver)
   end subroutine check_numbers

   !> Refuses the solution of a contact problem if friction cannot hold the body.
   subroutine check_spin(body, is_in_reach, problem, solution, is_near, size_of_body, error)
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(in) :: solution !! the solution, converged or not
      logical, intent(in) :: is_near !! whether it is converged and moves the body by less than its size
      real(dp), intent(in) :: size_of_body !! the larger side of the bounding box of the mesh [L]
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium; names the motion
      real(dp), allocatable :: amounts(:)
      character(:), allocatable :: motion

      call find_spin(amounts, body, is_in_reach, problem, solution, is_near, size_of_body)
      if (.not. allocated(amounts)) return
      motion = largest_motion(body%motions, amounts)
      if (solution%is_converged .and. is_round(body%zone)) then
         call new_error(error, no_equilibrium, 'no equilibrium but for the irregularities of the mesh: on the '// &
            'round line that its nodes lie on friction is exhausted and cannot balance the loads; '//motion// &
            '; add a support or friction')
      else
         call new_error(error, no_equilibrium, 'no equilibrium: all contact points slip or open, and friction '// &
            'cannot balance the loads; '//motion//'; add a support or friction')
      end if
   end subroutine check_spin

   !> Finds a motion that the loads drive and friction cannot hold: along the round line of the points and, where the
   !> solution is none or far away, one that opens contacts.
   subroutine find_spin(amounts, body, is_in_reach, problem, solution, is_near, size_of_body)
      real(dp), allocatable, intent(out) :: amounts(:)
         !! amounts of the free motions of each piece; not allocated if friction holds them (motions)
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(in) :: solution !! the solution, converged or not
      logical, intent(in) :: is_near !! whether it is converged and moves the body by less than its size
      real(dp), intent(in) :: size_of_body !! the larger side of the bounding box of the mesh [L]
      real(dp), allocatable :: on_round(:, :), spins(:, :)
      real(dp) :: rounding
      real(dp), parameter :: of_loads = 1.0e-13_dp ! the rounding of sums of loads
      logical :: is_driven
      integer :: trial

      if (size(body%rigid_modes, 2) == 0 .or. .not. all(ieee_is_finite(solution%displacement))) return
      ! Only nodal forces drive a spin: heat and prescribed displacements leave rounding errors.
      if (.not. problem%uncanceled(1) > 0.0_dp) return
      ! A body that spins without end moves by more than its size; for smaller motions the product of S with the motion
      ! is no load. Nor are rounding errors of large loads across the motion.
      rounding = problem%rounding*max(problem%prescribed, min(maxval(abs(solution%displacement)), size_of_body)) &
         + of_loads*(maxval(abs(problem%load)) + sum(problem%uncanceled))
      call new_spins(spins, on_round, body, is_in_reach)
      associate (modes => body%rigid_modes)
         if (size(spins, 2) > 0) then
            is_driven = .not. solution%is_converged
            if (solution%is_converged) then
               ! Along what the forces leave of the loads; in space, where friction is not all along that, along the
               ! loads, too.
               do trial = 1, problem%matrix%n_tangents
                  amounts = matmul(problem%load, modes)
                  if (trial == 1) amounts = amounts - matmul(solution%force, on_round)
                  amounts = matmul(matmul(amounts, spins), transpose(spins))
                  if (is_unbalanced(problem, solution%force, rounding, amounts, on_round, modes)) return
               end do
               deallocate (amounts)
               is_driven = is_round(body%zone) .and. is_exhausted(problem, solution%force, spins, on_round, modes)
            end if
            if (is_driven) call find_driven_spin(amounts, problem, is_in_reach, rounding, spins, on_round, modes)
         end if
         if (allocated(amounts) .or. is_near) return
         ! Without a solution, or far away, motions that open contacts count, too.
         call new_spins(spins, on_round, body, spread(.false., 1, size(is_in_reach)))
         call find_driven_spin(amounts, problem, is_in_reach, rounding, spins, on_round, modes)
      end associate
   end subroutine find_spin

   !> Whether the loads drive a motion by more than friction can take at given normal forces.
   pure logical function is_unbalanced(problem, force, rounding, amounts, on_round, modes)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: force(:) !! contact forces (n_rows) [F]
      real(dp), intent(in) :: rounding !! rounding errors of load and force of a point, from those of S [F]
      real(dp), intent(in) :: amounts(:) !! amounts of the free motions of each piece (motions)
      real(dp), intent(in) :: on_round(:, :)
         !! displacements of the points in frames of the round line (n_rows, motions)
      real(dp), intent(in) :: modes(:, :) !! displacements of the points in their own frames (n_rows, motions) [-]
      ! The limit of `check_balance` for errors of the mesh; without such errors ten times the residual of methods.
      real(dp), parameter :: unbalanced_when_round = 1.0e-2_dp
      real(dp) :: motion(problem%matrix%n), drive, capacity, share

      share = merge(unbalanced_when_round, computed_rounding, any(abs(on_round - modes) > computed_rounding))
      motion = matmul(on_round, amounts)
      associate (m => problem%n_points, moved => matmul(modes, amounts))
         drive = dot_product(problem%load, moved) - dot_product(force(:m), motion(:m))
         capacity = sum(problem%bound(force(:m))*tangential_norm(motion(m + 1:), m))
         is_unbalanced = drive > capacity + sum((share*abs(problem%load) + rounding)*abs(moved))
      end associate
   end function is_unbalanced

   !> Whether all friction acts against the spin that the loads drive on a round line. A body with such a line still
   !> turns, until the remaining normal displacements of the facets wedge it: normal forces, and friction with them,
   !> grow until they bear the loads.
   pure logical function is_exhausted(problem, force, spins, on_round, modes)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: force(:) !! contact forces that a method found (n_rows) [F]
      real(dp), intent(in) :: spins(:, :) !! amounts of the free motions (motions, spins)
      real(dp), intent(in) :: on_round(:, :)
         !! displacements of the points in frames of the round line (n_rows, motions)
      real(dp), intent(in) :: modes(:, :) !! displacements of the points in their own frames (n_rows, motions) [-]
      ! Difference of the tangents of facets from those of the round line.
      real(dp), parameter :: almost = 0.99_dp
      real(dp) :: motion(problem%matrix%n), capacity

      motion = matmul(on_round, matmul(matmul(matmul(problem%load, modes), spins), transpose(spins)))
      associate (m => problem%n_points)
         capacity = sum(problem%bound(force(:m))*tangential_norm(motion(m + 1:), m))
         is_exhausted = capacity > 0.0_dp .and. dot_product(force(m + 1:), motion(m + 1:)) >= almost*capacity
      end associate
   end function is_exhausted

   !> Finds the free motions that all points in reach follow along the tangents of the round line.
   subroutine new_spins(spins, on_round, body, is_in_reach)
      real(dp), allocatable, intent(out) :: spins(:, :)
         !! amounts of the free motions (motions, spins)
      real(dp), allocatable, intent(out) :: on_round(:, :)
         !! displacements of the points in frames of the round line (n_rows, motions)
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_in_reach(:) !! which points count (m)
      ! What meshes of curves leave of a motion.
      real(dp), parameter :: negligible = 1.0e-3_dp
      integer :: p

      call find_rigid_modes(on_round, body%zone, body%motions, body%mesh%coordinates, is_mated=.true.)
      on_round = on_round_line(body%zone, on_round)
      associate (modes => body%rigid_modes)
         spins = null_vectors(on_round(pack([(p, p=1, size(is_in_reach))], is_in_reach), :), &
            negligible*norm2(modes, dim=1))
         ! Pieces that touch share the displacements of their points: motions of both may leave them in place.
         associate (moved => matmul(modes, spins))
            spins = spins(:, pack([(p, p=1, size(spins, 2))], norm2(moved, dim=1) > negligible**2))
         end associate
      end associate
   end subroutine new_spins

   !> Finds a motion that friction cannot hold: the displacement of the body under weak springs, which bear the part of
   !> the loads that friction does not. With weaker springs it moves farther, until every point slips or opens that
   !> does so in a motion without end.
   subroutine find_driven_spin(amounts, problem, is_in_reach, rounding, spins, on_round, modes)
      real(dp), allocatable, intent(out) :: amounts(:)
         !! amounts of the free motions of each piece; not allocated if none is found (motions)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      real(dp), intent(in) :: rounding !! rounding errors of load and force of a point, from those of S [F]
      real(dp), intent(in) :: spins(:, :) !! amounts of the free motions that springs oppose (motions, spins)
      real(dp), intent(in) :: on_round(:, :)
         !! displacements of the points in frames of the round line (n_rows, motions)
      real(dp), intent(in) :: modes(:, :) !! displacements of the points in their own frames (n_rows, motions) [-]
      ! Stiffness of the springs over the largest of the points; the weakest ones detect a load 1e-8 above its limit.
      ! With more points this would take minutes.
      real(dp), parameter :: weak(*) = [1.0e-3_dp, 1.0e-5_dp, 1.0e-7_dp, 1.0e-9_dp, 1.0e-11_dp]
      integer, parameter :: most_points = 2000
      real(dp), parameter :: most_residual = 1.0e-6_dp, far = 10.0_dp ! of a solution that is near enough
      type(contact_solution_t) :: found
      type(error_t), allocatable :: error
      real(dp) :: motions(problem%matrix%n, size(spins, 2)), before(problem%matrix%n), inexact
      real(dp), allocatable :: springs(:, :)
      integer :: trial

      if (problem%n_points > most_points) return
      motions = matmul(modes, spins)
      springs = orthonormal_modes(motions)
      before = 0.0_dp
      do trial = 1, size(weak)
         call solve_on_springs(problem, weak(trial), springs, found, error)
         if (allocated(error) .or. .not. found%residual <= most_residual) return
         ! Once all these points slip, the body moves on as a rigid one: the motion is the difference of two trials.
         amounts = matmul(spins, least_squares(motions, found%displacement - before))
         ! Rounding errors of long displacements may be above the tolerance.
         inexact = merge(0.0_dp, far*found%residual*found%force_scale, found%is_converged)
         if (is_unopposed(problem, found%force, is_in_reach, rounding + inexact, amounts, on_round, modes)) return
         if (is_unopposed(problem, found%force, is_in_reach, rounding + inexact, amounts, modes, modes)) return
         deallocate (amounts)
         before = found%displacement
      end do
   end subroutine find_driven_spin

   !> Solves a contact problem with springs against some motions, from rest.
   subroutine solve_on_springs(problem, share, motions, found, error)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: share !! stiffness of the springs over the largest of the points [-]
      real(dp), intent(in) :: motions(:, :) !! displacements of the points under each motion (n_rows, any) [-]
      type(contact_solution_t), intent(out) :: found !! the solution, converged or not
      type(error_t), allocatable, intent(out) :: error !! memory ran out, or the computation failed numerically
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: held
      type(auto_t) :: method
      integer :: i

      call problem%matrix%copy_dense(matrix, error)
      if (allocated(error)) return
      held = problem
      held%matrix => matrix
      do i = 1, size(motions, 2)
         call matrix%add_motion(share*maxval(problem%matrix%augmentation), motions(:, i))
      end do
      call new_contact_solution(found, problem%n_points, problem%matrix%n_tangents)
      call solve_components(method, held, found, error)
   end subroutine solve_on_springs

   !> Whether no closed contact opposes a motion by its normal force, and friction not enough.
   pure logical function is_unopposed(problem, force, is_in_reach, rounding, amounts, frames, modes)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: force(:) !! contact forces (n_rows) [F]
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      real(dp), intent(in) :: rounding !! errors of load and force of a point [F]
      real(dp), intent(in) :: amounts(:) !! amounts of the free motions of each piece (motions)
      real(dp), intent(in) :: frames(:, :)
         !! displacements of the points in their own frames or in those of the round line (n_rows, motions)
      real(dp), intent(in) :: modes(:, :) !! displacements of the points in their own frames (n_rows, motions) [-]
      ! Motion of closed points along their normals, and of others toward the obstacle, over the largest motion.
      real(dp), parameter :: negligible = 1.0e-3_dp
      real(dp) :: way(problem%matrix%n)

      way = matmul(frames, amounts)
      associate (along => way(:problem%n_points), closes => force(:problem%n_points) > 0.0_dp)
         is_unopposed = all(merge(abs(along), along, closes) <= negligible*maxval(abs(way)) .or. .not. is_in_reach)
      end associate
      if (is_unopposed) is_unopposed = is_unbalanced(problem, force, rounding, amounts, frames, modes)
   end function is_unopposed

end module amontons_load_solver
