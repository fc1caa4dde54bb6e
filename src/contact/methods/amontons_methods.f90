!> The table of contact methods and of the words of their options, the choice of a method by its name, and the solution
!> of a contact problem by its components, which are parts that do not act on each other.
!>
!> Bodies in several pieces and reduced problems of many bodies have several components. Each has its own scale of
!> forces, its own steps and its own pivots: a difficult one does not slow the others, and weak ones keep their digits.
module amontons_methods
   use amontons_acceleration, only: acceleration_names
   use amontons_auto, only: auto_t
   use amontons_box_program, only: box_names
   use amontons_contact_operator, only: contact_operator_t
   use amontons_contact_problem, only: contact_problem_t, new_contact_problem, new_reduced_problem
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, effort_t, method_options_t, &
      new_contact_solution
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_extragradient, only: extragradient_t
   use amontons_fixed_point, only: fixed_point_t
   use amontons_friction_law, only: tangential_norm
   use amontons_kinds, only: dp
   use amontons_lemke, only: lemke_t
   use amontons_newton, only: newton_t
   use amontons_psor, only: local_names, psor_t, space_names
   use amontons_rounding, only: difference_rounding
   use amontons_splitting, only: splitting_t, variant_names
   implicit none (type, external)
   private

   public :: acceleration_names, box_names, local_names, method_names, method_options_t, new_contact_method, &
      solve_components, space_names, variant_names

   !> Names of the methods, as a deck writes them.
   character(13), parameter :: method_names(*) = [character(13) :: 'auto', 'newton', 'splitting', 'fixed_point', &
      'psor', 'extragradient', 'lemke']

contains

   !> Makes the method with a given name.
   subroutine new_contact_method(method, options, error)
      class(contact_method_t), allocatable, intent(out) :: method !! the method
      type(method_options_t), intent(in) :: options !! name of the method, and its options
      type(error_t), allocatable, intent(out) :: error !! there is no such method

      select case (options%method)
      case ('auto')
         allocate (auto_t :: method)
      case ('newton')
         allocate (newton_t :: method)
      case ('splitting')
         allocate (splitting_t :: method)
      case ('fixed_point')
         allocate (fixed_point_t :: method)
      case ('psor')
         allocate (psor_t :: method)
      case ('extragradient')
         allocate (extragradient_t :: method)
      case ('lemke')
         allocate (lemke_t :: method)
      case default
         call new_error(error, input_refused, "unknown contact method '"//trim(options%method)//"'")
         return
      end select
      method%method_options_t = options
   end subroutine new_contact_method

   !> Solves each component of a problem by itself.
   recursive subroutine solve_components(method, problem, solution, error)
      class(contact_method_t), intent(in) :: method !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! the method does not accept the problem
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: part
      type(contact_solution_t) :: found
      integer, allocatable :: component(:), points(:), rows(:)
      real(dp), allocatable :: displacement(:), force(:)
      logical :: is_at_rest, are_converged
      real(dp) :: residual, scale
      integer :: i, k, n_components, n
      type(effort_t) :: effort

      if (allocated(problem%softness)) then
         call solve_without_springs(method, problem, solution, error)
         return
      end if
      call problem%matrix%find_parts(problem%n_points, component, n_components)
      if (n_components < 2) then
         call method%solve(problem, solution, error)
         call drop_small_forces(problem, method%tolerance, solution)
         return
      end if
      displacement = solution%displacement
      force = solution%force
      is_at_rest = .false.
      are_converged = .true.
      residual = 0.0_dp
      scale = problem%force_scale()
      call solution%reset()
      do k = 1, n_components
         points = pack([(i, i=1, problem%n_points)], component == k)
         rows = [(points + n*problem%n_points, n=0, problem%matrix%n_tangents)]
         call problem%matrix%cut(rows, matrix, error)
         if (allocated(error)) return
         if (allocated(problem%load)) then
            call new_contact_problem(part, matrix)
            part%load = problem%load(rows)
            part%friction = problem%friction(points)
            part%prescribed = problem%prescribed
            part%rounding = problem%rounding
            part%uncanceled = problem%uncanceled
         else
            call new_reduced_problem(part, matrix, problem%free_displacement(rows), problem%friction(points))
         end if
         part%gap = problem%gap(points)
         part%anchor = problem%anchor(rows(size(points) + 1:) - problem%n_points)
         part%slip_bound = problem%slip_bound(points)
         call new_contact_solution(found, size(points), problem%matrix%n_tangents)
         found%displacement = displacement(rows)
         found%force = force(rows)
         call method%solve(part, found, error)
         if (allocated(error)) return
         call drop_small_forces(part, method%tolerance, found)
         displacement(rows) = found%displacement
         force(rows) = found%force
         is_at_rest = is_at_rest .or. found%is_at_rest
         if (.not. found%is_converged .and. part%force_scale() > difference_rounding*scale) then
            are_converged = .false.
            residual = max(residual, found%residual)
         end if
         effort = found%effort
         effort%n_products = (real(size(points), dp)/problem%n_points)**2*effort%n_products
         call solution%effort%add(effort)
         do n = solution%n_iterations + 1, found%n_iterations
            call solution%record_residual(0.0_dp)
         end do
         n = found%n_iterations
         solution%history(:n) = max(solution%history(:n), found%history(:n))
      end do
      solution%displacement = displacement
      solution%force = force
      call solution%measure(problem)
      ! The residual of a small component may be hidden in that of the whole problem.
      solution%residual = max(solution%residual, residual)
      solution%is_converged = are_converged .and. solution%residual <= method%tolerance
      if (solution%n_iterations > 0) solution%history(solution%n_iterations) = solution%residual
      solution%is_at_rest = is_at_rest .and. .not. solution%is_converged
   end subroutine solve_components

   !> Solves a problem whose points depend on each other, by proximal steps: the springs between them and the body are
   !> strained by the change of the forces alone, S v = q + S E lambda_0 - lambda, and then not at all. The first step
   !> has lambda_0 = 0, so that which of many forces are found does not depend on the starting point.
   recursive subroutine solve_without_springs(method, problem, solution, error)
      class(contact_method_t), intent(in) :: method !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! the method does not accept the problem
      ! A step leaves about a thousandth of the way, where points depend on each other by friction more.
      integer, parameter :: n_steps = 20
      ! What is left of a step counts as well as what its method leaves.
      real(dp), parameter :: tighter = 0.1_dp, much = 0.5_dp
      class(contact_method_t), allocatable :: inner
      type(contact_problem_t) :: step
      type(contact_solution_t) :: before
      real(dp) :: center(problem%matrix%n), last
      logical :: may_continue
      integer :: i

      step = problem
      deallocate (step%softness)
      center = 0.0_dp
      last = huge(last)
      allocate (inner, source=method)
      call solution%reset()
      do i = 1, n_steps
         before = solution
         call problem%matrix%multiply_stiffness(problem%softness*center, step%load)
         step%load = problem%load + step%load
         call solve_components(inner, step, solution, error)
         if (allocated(error)) return
         call solution%prepend(before)
         may_continue = solution%is_converged
         if (.not. (may_continue .or. inner%tolerance < method%tolerance)) return
         call solution%measure(problem)
         solution%is_converged = solution%residual <= method%tolerance
         if (solution%n_iterations > 0) solution%history(solution%n_iterations) = solution%residual
         if (solution%is_converged .or. .not. may_continue) return
         if (solution%residual > much*last) inner%tolerance = tighter*method%tolerance
         last = solution%residual
         center = solution%force
      end do
   end subroutine solve_without_springs

   !> Opens the points of a body whose forces are 0 to within the tolerance: otherwise zones and centroids of an
   !> unloaded surface would depend on rounding.
   pure subroutine drop_small_forces(problem, tolerance, solution)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: tolerance !! residual that counts as solved [-]
      type(contact_solution_t), intent(inout) :: solution !! the solution, converged or not
      type(contact_solution_t) :: without
      logical :: is_none(problem%n_points)
      real(dp) :: force(problem%n_points)
      integer :: n

      if (.not. (solution%is_converged .and. problem%matrix%has_stiffness())) return
      force = max(abs(solution%force(:problem%n_points)), tangential_norm(solution%force(problem%n_points + 1:), &
         problem%n_points))
      is_none = force > 0.0_dp .and. force <= tolerance*solution%force_scale
      if (.not. any(is_none)) return
      without = solution
      without%force = merge(0.0_dp, solution%force, [(is_none, n=0, problem%matrix%n_tangents)])
      call without%measure(problem)
      if (without%n_iterations > 0) without%history(without%n_iterations) = without%residual
      if (without%residual <= tolerance) solution = without
   end subroutine drop_small_forces

end module amontons_methods
