!> The way of a body made in code to its result: what `solve_case` does for a deck.
module amontons_solve_body
   use amontons_body, only: body_t, condense_body
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_solution, only: new_contact_solution
   use amontons_contact_zone, only: contact_t, set_obstacles
   use amontons_equilibrium, only: check_balance
   use amontons_error, only: error_t
   use amontons_loads, only: load_t, load_vector
   use amontons_methods, only: method_options_t, new_contact_method
   use amontons_result, only: result_t
   use amontons_solve_case, only: certify, check_finite, load_body
   use amontons_timings, only: new_timings, phase_condense, phase_recover, phase_solve, phase_write
   use amontons_uniqueness, only: new_uniqueness
   implicit none (type, external)
   private

   public :: solve_body

contains

   !> Solves a body under loads. It is factorised once: solve it again for other loads, obstacles or friction.
   subroutine solve_body(body, contacts, loads, options, result, error)
      type(body_t), intent(inout) :: body !! the body, from `new_body`; gains its factorisation and contact problem
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, in the order of `new_body`
      type(load_t), intent(in) :: loads(:) !! the loads
      type(method_options_t), intent(in) :: options !! the contact method
      type(result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! loads, contacts or the numbers are at fault
      class(contact_method_t), allocatable :: method

      call new_timings(result%timings)
      call set_obstacles(body%zone, body%mesh, contacts, error)
      if (allocated(error)) return
      call load_vector(result%loads, body%mesh, body%materials, loads, error)
      if (allocated(error)) return
      call check_balance(body%motions, body%mesh, body%zone, result%loads, error)
      if (allocated(error)) return
      call new_contact_method(method, options, error)
      if (allocated(error)) return
      if (.not. allocated(body%problem%load)) call condense_body(body, 'auto', 'auto', result%timings, error)
      if (allocated(error)) return
      call result%timings%begin(phase_condense)
      call load_body(body, result%loads)

      call result%timings%begin(phase_solve)
      call new_contact_solution(result%solution, body%zone%n_points)
      call method%solve(body%problem, result%solution, error)
      if (allocated(error)) return
      call check_finite(result%solution, error)
      if (allocated(error)) return

      call result%timings%begin(phase_recover)
      call certify(body, result, error)
      if (allocated(error)) return
      call new_uniqueness(result%uniqueness, body%problem)
      ! What the caller does with the result is to write it.
      call result%timings%begin(phase_write)
   end subroutine solve_body

end module amontons_solve_body
