!> Solution and certificate of a load case, from its loads to its result, for decks and for bodies made in code; sweeps,
!> histories and `--verify` certify their cases and steps with the same procedures.
module amontons_solve_load_case
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_assembly, only: uncanceled_forces
   use amontons_auto, only: auto_t
   use amontons_body, only: body_t, condense_body
   use amontons_case_error, only: estimate_error, prepare_estimates
   use amontons_certificate, only: new_certificate
   use amontons_condensation, only: condensation_options_t
   use amontons_constraints, only: support_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_equilibrium, only: check_balance
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_key_results, only: body_peaks, contact_peaks, find_zones, new_lengths, set_results
   use amontons_kinds, only: dp
   use amontons_load_case, only: new_load_case, recover_displacement
   use amontons_load_family, only: acting_t, one_part
   use amontons_load_solver, only: forget_start, load_solver_t, new_load_solver
   use amontons_loads, only: load_t
   use amontons_methods, only: method_options_t
   use amontons_model_warnings, only: add_model_warnings
   use amontons_outcome_words, only: outcome_no_equilibrium, outcome_numbers
   use amontons_result, only: factor_t, result_t
   use amontons_result_warnings, only: add_result_warnings
   use amontons_stress_field, only: new_stress_field
   use amontons_terminal, only: new_timings, phase_condense, phase_recover, phase_solve, phase_write
   use amontons_uniqueness, only: new_uniqueness, uniqueness_t
   implicit none (type, external)
   private

   public :: certify, evaluate, set_factor, solve_body, solve_load_case

contains

   !> Solves a load case of a body and certifies the result. That there is no equilibrium is its outcome, not an error.
   subroutine solve_load_case(result, body, problem, error)
      type(result_t), intent(inout) :: result
         !! the result: with its load case and method, times begun, a solution to start from, and what is known of its
         !! uniqueness from another load case of the body; gains everything else
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(inout) :: problem
         !! its contact problem; left with this load case, and the compliance if the method makes it
      type(error_t), allocatable, intent(out) :: error !! there is no such method, or the numbers are at fault
      type(load_solver_t), allocatable :: solver
      type(acting_t) :: acting
      type(uniqueness_t) :: known
      integer :: kind

      call result%timings%begin(phase_condense)
      call set_factor(result%factor, body)
      allocate (solver)
      call new_load_solver(solver, body, result%load_case, one_part(result%load_case), result%method, error)
      if (allocated(error)) return
      call solver%loads%condense(body, problem)
      result%load_case%condensed = solver%loads%parts(1)%condensed
      call solver%loads%at_rest(acting)
      call solver%loads%pose(body, acting, problem)
      call result%timings%begin(phase_solve)
      if (problem%is_unloaded() .and. allocated(result%started_from)) deallocate (result%started_from)
      call forget_start(problem, result%solution)
      call solver%solve(body, acting, problem, result%solution, result%outcome, result%answer, kind)
      deallocate (solver)
      if (result%outcome == outcome_numbers) call new_error(error, kind, result%answer)
      if (any(result%outcome == [outcome_no_equilibrium, outcome_numbers])) return
      deallocate (result%answer)
      if (result%solution%is_at_rest) call compare_with_exact(problem, result%method%tolerance, result, error)
      if (allocated(error)) return
      call result%timings%begin(phase_recover)
      call certify(result, body, error)
      if (allocated(error)) return
      call add_result_warnings(result, body)
      known = result%uniqueness
      call new_uniqueness(result%uniqueness, problem, known)
      ! What the caller does with the result is to write it.
      call result%timings%begin(phase_write)
   end subroutine solve_load_case

   !> Notes which factorization is in use.
   pure subroutine set_factor(factor, body)
      type(factor_t), intent(out) :: factor !! the factorization
      type(body_t), intent(in) :: body !! the body, condensed

      associate (condenser => body%condensation%condenser)
         factor%name = condenser%name
         factor%n_entries = condenser%n_factor_entries
         factor%n_flops = condenser%n_flops
      end associate
   end subroutine set_factor

   !> Computes the displacements of all nodes, the certificate and the lengths, and refuses numbers that are not finite.
   subroutine certify(result, body, error)
      type(result_t), intent(inout) :: result !! the result, its load case condensed and its contact problem solved
      type(body_t), intent(in) :: body !! the body
      type(error_t), allocatable, intent(out) :: error !! the results left the range of numbers
      ! A condition number that leaves more than half of the digits explains nothing.
      real(dp), parameter :: explaining = 1.0e8_dp
      real(dp) :: condition

      call recover_displacement(result%displacement, body, result%load_case, result%solution%displacement)
      call evaluate(result, body)
      if (.not. (all(ieee_is_finite(result%displacement)) .and. result%certificate%is_finite())) then
         call new_error(error, numerical_failure, 'displacements, forces or energies leave the range of double '// &
            'precision (1.8e308): choose other units')
         return
      end if
      if (.not. shows_rounding(result)) return
      condition = max(body%condensation%condenser%condition(), cancellation(body, result))
      if (condition > explaining) result%condition = min(condition, huge(1.0_dp))
   end subroutine certify

   !> Computes all that follows from displacements, contact forces and statuses: certificate, lengths, key results,
   !> error estimate.
   subroutine evaluate(result, body)
      type(result_t), intent(inout) :: result !! the result: load case, solution and displacements of all nodes
      type(body_t), intent(in) :: body !! the body
      real(dp) :: slip(body%zone%n_points)
      integer :: m

      m = body%zone%n_points
      slip = result%solution%displacement(m + 1:)
      if (allocated(result%load_case%anchor)) slip = slip - result%load_case%anchor
      associate (solution => result%solution)
         call new_stress_field(result%stress, body%mesh, body%materials, body%coloring, result%displacement, &
            result%load_case%thermal_strain)
         call new_certificate(result%certificate, body, result%load_case, result%displacement, solution%force, &
            result%stress%force)
         ! What comes now is where a run holds most, and no one needs them any more.
         deallocate (result%stress%force)
         call new_lengths(result%lengths, body%zone, solution%status)
         call find_zones(result%closed, result%stuck, body, solution%force, solution%status, &
            result%load_case%slip_bound + result%load_case%friction*solution%force(:m), &
            [result%load_case%free_gap - solution%displacement(:m), slip], solution%displacement)
         ! The slip since rest, as `contact_columns` has it.
         slip = solution%displacement(m + 1:)
         if (allocated(result%load_case%obstacle_motion)) slip = slip - result%load_case%obstacle_motion
         result%key_results = [contact_peaks(body, slip, solution%force, solution%status, &
            maxval(abs(result%displacement))), body_peaks(body%mesh, result%displacement, result%stress%node), &
            set_results(body, solution%force, result%closed, result%stuck)]
      end associate
      if (result%wants_error_estimate) then
         if (.not. allocated(result%error_estimate)) allocate (result%error_estimate)
         call estimate_error(result%error_estimate, body, result%load_case, result%displacement, &
            result%solution%force)
      end if
   end subroutine evaluate

   !> How far the forces of the elements cancel, |K| |u| / |f|: of a body that its supports hold still, a bound from
   !> below of the condition number. It sees what the shift in the factor of a body held by contact alone hides.
   real(dp) function cancellation(body, result)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! its displacements and forces
      real(dp) :: forces

      cancellation = 0.0_dp
      ! Prescribed displacements and heat are loads that no force tells.
      if (any(abs(result%load_case%prescribed) > 0.0_dp) .or. allocated(result%load_case%thermal_strain)) return
      forces = max(norm2(result%load_case%force), norm2(result%solution%force))
      if (forces > 0.0_dp) cancellation = uncanceled_forces(body%mesh, body%materials, result%displacement)/forces
   end function cancellation

   !> Whether what the certificate finds may come from the rounding errors of an ill-conditioned stiffness: of what
   !> depends on the whole model, something is well above rounding, or the forces keep fewer than six digits.
   pure logical function shows_rounding(result)
      type(result_t), intent(in) :: result !! the result
      real(dp), parameter :: suspicious = 1.0e-9_dp, few_digits = 1.0e-6_dp

      associate (certificate => result%certificate)
         shows_rounding = max(certificate%equilibrium, certificate%resultant, certificate%moment, &
            certificate%energy) > suspicious .or. certificate%imbalance > few_digits
      end associate
   end function shows_rounding

   !> Measures the forces of a method that came to rest against the exact ones.
   subroutine compare_with_exact(problem, tolerance, result, error)
      type(contact_problem_t), intent(inout) :: problem !! the contact problem
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]
      type(result_t), intent(inout) :: result !! the result, gains the error of the method
      type(error_t), allocatable, intent(out) :: error !! the exact solution cannot be computed
      type(contact_solution_t) :: exact
      type(auto_t) :: method

      method%tolerance = tolerance
      call new_contact_solution(exact, problem%n_points)
      call method%solve(problem, exact, error)
      if (allocated(error) .or. .not. exact%is_converged) return
      result%method_error = maxval(abs(result%solution%force - exact%force))/max(maxval(abs(exact%force)), tiny(1.0_dp))
   end subroutine compare_with_exact

   !> Solves a body made in code under loads: what a deck describes, in arguments. It is factorized once: solve it again
   !> with the same contact problem for other loads, prescribed displacements, obstacles or friction.
   subroutine solve_body(body, problem, supports, contacts, loads, options, result, error)
      type(body_t), intent(inout) :: body !! the body, from `new_body`; gains its factorization with the first load case
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; a new one for the first load case
      type(support_t), intent(in) :: supports(:) !! the supports of `new_body`; their displacements may be others
      type(contact_t), intent(in) :: contacts(:) !! the contact sets of `new_body`; obstacles and friction may be others
      type(load_t), intent(in) :: loads(:) !! the loads
      type(method_options_t), intent(in) :: options !! the contact method
      type(result_t), intent(inout) :: result
         !! the result; one that converged for another load case of this body is where the method starts
      type(error_t), allocatable, intent(out) :: error !! supports, contacts, loads or the numbers are at fault
      type(contact_solution_t) :: start
      type(uniqueness_t) :: known
      type(result_t) :: empty

      call new_contact_solution(start, body%zone%n_points)
      if (result%solution%is_converged) then
         if (size(result%solution%force) == size(start%force)) start = result%solution
         known = result%uniqueness
      end if
      ! It is a start, and no result of this load case.
      start%is_converged = .false.
      result = empty
      result%solution = start
      result%uniqueness = known
      result%method = options
      result%wants_error_estimate = .true.
      call new_timings(result%timings)
      call new_load_case(result%load_case, body, supports, contacts, loads, error)
      if (allocated(error)) return
      call check_balance(body, result%load_case, error)
      if (allocated(error)) return
      call add_model_warnings(result%warnings, body, result%load_case)
      if (.not. allocated(problem%load)) then
         call condense_body(body, problem, condensation_options_t(), result%timings, error)
      end if
      if (allocated(error)) return
      call prepare_estimates(body)
      call solve_load_case(result, body, problem, error)
      if (result%outcome == outcome_no_equilibrium .and. .not. allocated(error)) call new_error(error, &
         numerical_failure, result%answer)
   end subroutine solve_body

end module amontons_solve_load_case
