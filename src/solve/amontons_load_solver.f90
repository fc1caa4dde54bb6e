!> The solution of a contact problem from a start, in the same way for a case, a row of a sweep and a step of a history.
!>
!> A body that nothing loads or presses needs no method. Else it is first checked whether contact and friction can
!> balance the loads. Then Newton's method is used from the start, if the method is left to the program, and where that
!> does not end well the deck's method, with displacements counted from the body's position on its obstacles.
!> Components of the contact problem are solved each by itself. Solutions are refined with what they leave unbalanced in
!> the whole body, and bodies that they leave free to move stay where they were.
!>
!> `check_balance` assumes unlimited normal forces, and friction with them: friction on opposite sides of a hole bears
!> any moment. Only the solution gives the normal forces. Where no method finds one, or all points of a round line slip,
!> a weak spring against the free motions shows the normal forces while the body moves, and the check is made once more
!> with the friction that they allow.
module amontons_load_solver
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_auto, only: auto_t
   use amontons_body, only: body_t
   use amontons_contact_operator, only: contact_operator_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, new_contact_solution
   use amontons_equilibrium, only: imbalance_of_points
   use amontons_error, only: error_t, no_equilibrium, numerical_failure
   use amontons_friction_law, only: stick_point
   use amontons_kinds, only: dp
   use amontons_load_family, only: acting_t, load_case_t, load_family_t, new_load_family, parting_t
   use amontons_loose_bodies, only: check_balance, find_origin, find_round_motions, free_motions, &
      rigid_part, settle
   use amontons_methods, only: method_options_t, new_contact_method, solve_components
   use amontons_newton, only: newton_t
   use amontons_pose, only: stated_poses
   use amontons_result, only: outcome_no_equilibrium, outcome_not_converged, outcome_numbers, outcome_solved
   use amontons_sliding, only: beginning_t, slide
   use amontons_text, only: short_text
   implicit none (type, external)
   private

   public :: check_balance, load_solver_t, new_load_solver, residual_of_strains

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
   contains
      procedure :: slide => load_solver_slide
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
   end subroutine new_load_solver

   !> Solves the contact problem of a member. Threads may solve members side by side, each with a problem of its own.
   subroutine load_solver_solve(self, body, acting, problem, solution, outcome, reason, error_kind, before)
      class(load_solver_t), intent(in) :: self !! the solver, its loads condensed
      type(body_t), intent(in) :: body !! the body, condensed
      class(acting_t), intent(in) :: acting !! the member
      type(contact_problem_t), intent(inout) :: problem !! its contact problem, posed; may gain its compliance
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      integer, intent(out) :: outcome !! one of the outcomes of `amontons_result`
      character(:), allocatable, intent(out) :: reason !! why there is no solution; empty for one not converged
      integer, intent(out) :: error_kind !! kind of the error that the reason is
      type(contact_solution_t), intent(in), optional :: before !! where the body was; where it is drawn if absent
      type(contact_solution_t) :: place, start, first
      type(load_case_t) :: load_case
      type(error_t), allocatable :: error, ignored
      real(dp), allocatable :: origin(:)
      type(newton_t) :: quick

      reason = ''
      error_kind = no_equilibrium
      call new_contact_solution(place, problem%n_points, problem%matrix%n_tangents)
      if (present(before)) place = before
      call solution%reset()
      if (.not. any(abs(problem%load) > 0.0_dp)) then
         solution%displacement = place%displacement
         solution%force = place%force
         if (.not. any(abs(place%force) > 0.0_dp)) call settle(body, problem, self%method%tolerance, place, solution)
         outcome = outcome_solved
         if (solution%is_converged) return
      end if
      start = solution
      if (self%is_auto .and. has_start_position(solution)) then
         quick = newton_t(tolerance=self%method%tolerance, max_iterations=min(n_newton_steps, &
            self%method%max_iterations), patience=patience, decrease=decrease)
         ! If memory does not suffice for these steps, it may for the deck's method.
         origin = rigid_part(body, solution%displacement)
         call self%solve_from_motion(origin, quick, body, acting, problem, solution, ignored)
      end if
      if (size(body%rigid_modes, 2) > 0 .and. .not. is_surely_held(self, body, problem, solution)) then
         ! gfortran 12 keeps the length of the text that a function returns in a place that all threads share.
         !$omp critical (texts_of_solver)
         call self%loads%load_case(body, acting, load_case)
         call check_balance(body, load_case, error)
         if (allocated(error)) reason = error%message
         !$omp end critical (texts_of_solver)
         outcome = outcome_no_equilibrium
         solution%is_converged = solution%is_converged .and. .not. allocated(error)
         if (allocated(error)) return
      end if
      if (.not. solution%is_converged) then
         first = solution
         solution = start
         call find_origin(origin, body, problem, acting%is_in_reach)
         call self%solve_from_motion(origin, self%method, body, acting, problem, solution, error)
         call solution%prepend(first)
      end if
      call settle(body, problem, self%method%tolerance, place, solution)
      if (allocated(error)) then
         solution%is_converged = .false.
         reason = error%message
         ! Memory ran out, or the method accepts fewer points.
         error_kind = error%kind
         outcome = outcome_numbers
         return
      end if
      !$omp critical (texts_of_solver)
      call self%loads%check_held_nodes(body, acting, error)
      if (allocated(error)) reason = error%message
      !$omp end critical (texts_of_solver)
      if (len(reason) == 0 .and. allocated(load_case%force)) call check_friction(body, load_case, problem, solution, &
         reason)
      outcome = outcome_no_equilibrium
      if (len(reason) == 0) then
         error_kind = numerical_failure
         call check_numbers(self, problem, solution, reason)
         outcome = merge(outcome_solved, outcome_not_converged, solution%is_converged)
         if (len(reason) > 0) outcome = outcome_numbers
      end if
      solution%is_converged = outcome == outcome_solved
   end subroutine load_solver_solve

   !> Solves the contact problem of a member whose points slide far, at their moved places.
   subroutine load_solver_slide(self, body, acting, problem, solution, outcome, reason, error_kind, before)
      class(load_solver_t), intent(in) :: self !! the solver, its loads condensed
      type(body_t), intent(inout) :: body !! the body, condensed; its contact points are left at the places found
      class(acting_t), intent(inout) :: acting !! the member; gains gaps and anchors
      type(contact_problem_t), intent(in) :: problem !! the problem on its retained points, posed
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      integer, intent(out) :: outcome !! one of the outcomes of `amontons_result`
      character(:), allocatable, intent(out) :: reason !! why there is no solution; empty for one not converged
      integer, intent(out) :: error_kind !! kind of the error that the reason is
      type(beginning_t), intent(in), optional :: before !! the end of the step before; at rest if absent
      type(load_case_t) :: load_case
      type(error_t), allocatable :: error

      reason = ''
      error_kind = numerical_failure
      call slide(body, self%loads, self%method, acting, problem, solution, error, before)
      if (.not. (allocated(error) .or. solution%is_converged)) then
         call self%loads%load_case(body, acting, load_case)
         call check_balance(body, load_case, error, poses=stated_poses(body%turning, solution%posed))
      end if
      outcome = merge(outcome_solved, outcome_not_converged, solution%is_converged)
      if (.not. allocated(error)) return
      solution%is_converged = .false.
      reason = error%message
      error_kind = error%kind
      outcome = merge(outcome_no_equilibrium, outcome_numbers, error_kind == no_equilibrium)
   end subroutine load_solver_slide

   !> Whether the contact forces of a solution hold a loose body beyond doubt, without friction at its bound: methods
   !> accept a solution for loads a little above what contact and friction bear, far away, or by ties that lie apart,
   !> which hold a body that tips.
   pure logical function is_surely_held(self, body, problem, solution)
      class(load_solver_t), intent(in) :: self !! the solver, for the size of the body
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(in) :: solution !! the solution, converged or not
      ! Errors of forces are far below what it lacks of 1.
      real(dp), parameter :: nearly_all = 1.0_dp - 1.0e-7_dp

      is_surely_held = solution%is_converged .and. .not. body%is_motion_strained &
         .and. maxval([0.0_dp, abs(solution%displacement)]) <= self%size_of_body
      if (is_surely_held) is_surely_held = size(free_motions(body%rigid_modes, problem, solution%force, &
         nearly_all), 2) == 0
   end function is_surely_held

   !> Whether friction can balance the loads at the normal forces that act. Where there is no solution, or one with all
   !> friction of a round line used up, they are found with weak springs against the free motions, which bear what
   !> friction does not: facets of the line have not yet wedged the body, as they do when it has turned far.
   subroutine check_friction(body, load_case, problem, solution, reason)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads, obstacles and friction
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(in) :: solution !! the solution, converged or not
      character(:), allocatable, intent(inout) :: reason !! empty; gains why there is no equilibrium
      ! Stiffness of the springs over the largest of the points; the weakest ones detect a load 1e-8 above its limit.
      ! With more points this would take minutes.
      real(dp), parameter :: weak(*) = [1.0e-3_dp, 1.0e-5_dp, 1.0e-7_dp, 1.0e-9_dp, 1.0e-11_dp]
      integer, parameter :: most_points = 2000
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: held
      type(contact_solution_t) :: found
      type(error_t), allocatable :: error, ignored
      type(auto_t) :: method
      real(dp), allocatable :: amounts(:, :), moved(:, :), borne(:), bound(:)
      real(dp) :: spring
      integer :: i, trial

      associate (m => problem%n_points)
         if (solution%is_converged) then
            if (any(solution%status == stick_point)) return
            call find_round_motions(amounts, moved, body, load_case%is_in_reach)
            if (size(amounts, 2) == 0) return
         end if
         if (m > most_points) return
         held = problem
         held%matrix => matrix
         do trial = 1, size(weak)
            spring = weak(trial)*maxval(problem%matrix%augmentation)
            call problem%matrix%copy_dense(matrix, ignored)
            if (allocated(ignored)) return
            do i = 1, size(body%travel, 2)
               call matrix%add_motion(spring, body%travel(:, i))
            end do
            call new_contact_solution(found, m, problem%matrix%n_tangents)
            call solve_components(method, held, found, ignored)
            if (allocated(ignored)) return
            if (.not. found%is_converged) cycle
            ! The springs bear a part of the normal forces, too.
            borne = spring*matmul(body%travel(:m, :), matmul(found%displacement, body%travel))
            bound = problem%bound(found%force(:m) + max(0.0_dp, borne))
            !$omp critical (texts_of_solver)
            call check_balance(body, load_case, error, bound)
            if (allocated(error)) reason = error%message
            !$omp end critical (texts_of_solver)
            if (allocated(error)) return
         end do
      end associate
   end subroutine check_friction

   !> Whether a solution has a position of the body to start from: there is none before it meets its obstacles.
   pure logical function has_start_position(solution)
      type(contact_solution_t), intent(in) :: solution !! the start

      has_start_position = any(abs(solution%force) > 0.0_dp) .or. &
         any(abs(solution%displacement(:size(solution%status))) > 0.0_dp)
   end function has_start_position

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
      call solve_components(method, problem%from(motion), solution, error)
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
         change = problem%from(origin + solution%displacement)
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
      motion = rigid_part(body, solution%displacement)
      strains = solution%displacement - motion
      counted = problem%from(motion)
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

end module amontons_load_solver
