!> All contact methods that must be right, in a table.
module sample_methods
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_methods, only: method_names, method_options_t, new_contact_method
   use amontons_psor, only: space_names
   use amontons_splitting, only: variant_names
   implicit none (type, external)
   private

   public :: label, list_methods, solve_from, solve_from_rest

   !> Relaxations of psor: under, none, over; `test_psor` says why not more.
   real(dp), parameter :: omegas(3) = [0.7_dp, 1.0_dp, 1.2_dp]

contains

   !> Every method of the table of methods, psor once for each space and relaxation.
   subroutine list_methods(methods)
      type(method_options_t), allocatable, intent(out) :: methods(:) !! their options
      type(method_options_t) :: options
      integer :: i, space, relaxation

      options%variant = trim(variant_names(1))
      options%space = trim(space_names(1))
      ! Two digits beyond what the tests ask of the forces; sweeps may be many.
      options%tolerance = 1.0e-12_dp
      options%max_iterations = 20000
      allocate (methods(0))
      do i = 1, size(method_names)
         options%method = trim(method_names(i))
         if (options%method /= 'psor') then
            methods = [methods, options]
            cycle
         end if
         do space = 1, size(space_names)
            options%space = trim(space_names(space))
            do relaxation = 1, size(omegas)
               options%omega = omegas(relaxation)
               methods = [methods, options]
            end do
         end do
      end do
   end subroutine list_methods

   !> The name of a method, for messages.
   function label(options)
      type(method_options_t), intent(in) :: options !! the method
      character(:), allocatable :: label
      character(4) :: omega

      write (omega, '(f4.1)') options%omega
      label = options%method
      if (label == 'psor') label = label//' '//options%space//omega
      if (label == 'splitting') label = label//' '//options%variant
   end function label

   !> Solves a problem from the forces and displacements of a solution.
   subroutine solve_from(solution, problem, options)
      type(contact_solution_t), intent(inout) :: solution !! start and result; not converged if the method fails
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(method_options_t), intent(in) :: options !! the method
      class(contact_method_t), allocatable :: method
      type(contact_problem_t) :: own
      type(error_t), allocatable :: error

      own = problem
      call new_contact_method(method, options, error)
      if (.not. allocated(error)) call method%solve(own, solution, error)
      if (allocated(error)) solution%is_converged = .false.
   end subroutine solve_from

   !> Solves a problem from rest.
   subroutine solve_from_rest(solution, problem, options)
      type(contact_solution_t), intent(out) :: solution !! the result; not converged if the method fails
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(method_options_t), intent(in) :: options !! the method

      call new_contact_solution(solution, problem%n_points)
      call solve_from(solution, problem, options)
   end subroutine solve_from_rest

end module sample_methods
