!> Bodies made in code: what a deck describes, in arguments.
module amontons_solve_body
   use amontons_body, only: body_t, condense_body
   use amontons_condensation, only: condensation_options_t
   use amontons_constraints, only: support_t
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_contact_zone, only: contact_t
   use amontons_equilibrium, only: check_balance
   use amontons_error, only: error_t
   use amontons_load_case, only: new_load_case
   use amontons_loads, only: load_t
   use amontons_methods, only: method_options_t, new_contact_method
   use amontons_model_warnings, only: add_model_warnings
   use amontons_result, only: result_t
   use amontons_solve_load_case, only: solve_load_case
   use amontons_timings, only: new_timings
   implicit none (type, external)
   private

   public :: solve_body

contains

   !> Solves a body under loads. It is factorized once: solve it again with the same contact problem for other loads,
   !> prescribed displacements, obstacles or friction.
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
      class(contact_method_t), allocatable :: method
      type(contact_solution_t) :: start
      type(result_t) :: empty

      call new_contact_solution(start, body%zone%n_points)
      if (result%solution%is_converged) then
         if (size(result%solution%force) == size(start%force)) start = result%solution
      end if
      ! It is a start, and no result of this load case.
      start%is_converged = .false.
      result = empty
      result%solution = start
      result%method = options
      result%wants_error_estimate = .true.
      call new_timings(result%timings)
      call new_load_case(result%load_case, body, supports, contacts, loads, error)
      if (allocated(error)) return
      call check_balance(body, result%load_case, error)
      if (allocated(error)) return
      call add_model_warnings(result%warnings, body, result%load_case)
      call new_contact_method(method, options, error)
      if (allocated(error)) return
      if (.not. allocated(problem%load)) then
         call condense_body(body, problem, condensation_options_t(), result%timings, error)
      end if
      if (allocated(error)) return
      call solve_load_case(result, body, problem, method, error)
   end subroutine solve_body

end module amontons_solve_body
