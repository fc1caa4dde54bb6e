!> All contact methods that must be right, in a table.
module sample_methods
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, new_contact_solution
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_methods, only: acceleration_names, box_names, local_names, method_names, method_options_t, &
      new_contact_method, space_names
   implicit none (type, external)
   private

   public :: label, list_methods, solve_from, solve_from_rest

   !> Relaxations of psor: under, none, over; `test_psor` says why not more.
   real(dp), parameter :: omegas(3) = [0.7_dp, 1.0_dp, 1.2_dp]

contains

   !> Every method of the table of methods: those with quadratic programs once for each solver of these, psor once for
   !> each space and relaxation, treatment of a point and acceleration.
   subroutine list_methods(methods)
      type(method_options_t), allocatable, intent(out) :: methods(:) !! their options
      type(method_options_t) :: options
      integer :: i, k, space

      ! Two digits beyond what the tests ask of the forces; sweeps may be many.
      options%tolerance = 1.0e-12_dp
      options%max_iterations = 20000
      allocate (methods(0))
      do i = 1, size(method_names)
         options%method = trim(method_names(i))
         select case (options%method)
         case ('splitting', 'fixed_point')
            do k = 2, size(box_names)
               options%box = trim(box_names(k))
               methods = [methods, options]
            end do
         case ('psor')
            do space = 1, size(space_names)
               options%space = trim(space_names(space))
               call list_sweeps(methods, options)
            end do
         case default
            methods = [methods, options]
         end select
      end do
      ! The proximal steps of extragradient are small ones: what is left of them adds up to more.
      do i = 1, size(methods)
         if (methods(i)%method == 'extragradient') methods(i)%tolerance = 1.0e-13_dp
      end do
   end subroutine list_methods

   !> Adds psor in one space: each relaxation, and both treatments of a point with each acceleration.
   subroutine list_sweeps(methods, options)
      type(method_options_t), allocatable, intent(inout) :: methods(:) !! the list
      type(method_options_t), intent(in) :: options !! the method and its space
      type(method_options_t) :: own
      integer :: i, k

      own = options
      own%local = trim(local_names(1))
      own%acceleration = trim(acceleration_names(1))
      do i = 1, size(omegas)
         own%omega = omegas(i)
         methods = [methods, own]
      end do
      own%omega = 1.0_dp
      do i = 1, size(local_names)
         own%local = trim(local_names(i))
         do k = 1, size(acceleration_names)
            if (i == 1 .and. k == 1) cycle
            own%acceleration = trim(acceleration_names(k))
            methods = [methods, own]
         end do
      end do
   end subroutine list_sweeps

   !> The name of a method, for messages.
   function label(options)
      type(method_options_t), intent(in) :: options !! the method
      character(:), allocatable :: label
      character(4) :: omega

      write (omega, '(f4.1)') options%omega
      label = trim(options%method)
      select case (options%method)
      case ('psor')
         label = label//' '//trim(options%space)//omega//' '//trim(options%local)//' '//trim(options%acceleration)
      case ('splitting', 'fixed_point')
         label = label//' '//trim(options%box)
      case default
         continue
      end select
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

      call new_contact_solution(solution, problem%n_points, 1)
      call solve_from(solution, problem, options)
   end subroutine solve_from_rest

end module sample_methods
