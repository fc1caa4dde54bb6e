!> Contact problems that fall into parts which do not act on each other: each is solved by itself.
!>
!> Bodies in several pieces and reduced problems of many bodies are such problems. A part has its own scale of forces,
!> its own steps and its own pivots: a difficult one does not slow the others, and weak ones keep their digits.
module amontons_components
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t, new_contact_problem, new_reduced_problem
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_effort, only: effort_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_symmetric_matrix, only: new_dense_matrix, new_sparse_matrix, symmetric_matrix_t
   implicit none (type, external)
   private

   public :: component_numbers, solve_components

   !> A part with fewer points has a dense compliance, which all methods take.
   integer, parameter :: least_sparse_points = 100

contains

   !> Solves a problem, each of its parts by itself.
   subroutine solve_components(method, problem, solution, error)
      class(contact_method_t), intent(in) :: method !! the method
      type(contact_problem_t), intent(inout) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! what the method refuses
      type(contact_problem_t) :: part
      type(contact_solution_t) :: found
      integer, allocatable :: component(:), points(:), rows(:)
      real(dp), allocatable :: displacement(:), force(:)
      logical :: is_at_rest
      integer :: i, k, n_components

      call component_numbers(problem, component, n_components)
      if (n_components < 2) then
         call method%solve(problem, solution, error)
         return
      end if
      displacement = solution%displacement
      force = solution%force
      is_at_rest = .false.
      call solution%reset()
      do k = 1, n_components
         points = pack([(i, i=1, problem%n_points)], component == k)
         rows = [points, problem%n_points + points]
         call new_part(part, problem, points, rows)
         call new_contact_solution(found, size(points))
         found%displacement = displacement(rows)
         found%force = force(rows)
         call method%solve(part, found, error)
         if (allocated(error)) return
         displacement(rows) = found%displacement
         force(rows) = found%force
         is_at_rest = is_at_rest .or. found%is_at_rest
         call add_record(solution, found, (real(size(points), dp)/problem%n_points)**2)
      end do
      solution%displacement = displacement
      solution%force = force
      call solution%measure(problem)
      solution%is_converged = solution%residual <= method%tolerance
      if (solution%n_iterations > 0) solution%history(solution%n_iterations) = solution%residual
      solution%is_at_rest = is_at_rest .and. .not. solution%is_converged
   end subroutine solve_components

   !> Numbers the parts of a problem: two points are in one if an entry of the matrix couples them. A band is one part.
   pure subroutine component_numbers(problem, component, n_components)
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, allocatable, intent(out) :: component(:) !! number of the part of each point (m)
      integer, intent(out) :: n_components !! number of parts
      integer :: parent(problem%n_points), i, m

      m = problem%n_points
      parent = [(i, i=1, m)]
      if (problem%is_reduced()) then
         associate (a => problem%compliance)
            if (allocated(a%values)) call join_coupled(parent, a%values)
            if (a%is_sparse()) call join_entries(parent, a)
         end associate
      else if (allocated(problem%band)) then
         parent = 1
      else
         call join_coupled(parent, problem%stiffness)
      end if
      allocate (component(m))
      n_components = 0
      do i = 1, m
         if (parent(i) == i) then
            n_components = n_components + 1
            component(i) = n_components
         else
            component(i) = component(root_of(parent, i))
         end if
      end do
   end subroutine component_numbers

   !> Joins the parts of points that a sparse matrix couples.
   pure subroutine join_entries(parent, matrix)
      integer, intent(inout) :: parent(:) !! a point of the same part, of a lower number or the same (m)
      type(symmetric_matrix_t), intent(in) :: matrix !! the matrix (2m, 2m)
      integer :: i, j, m

      m = size(parent)
      do j = 1, 2*m
         do i = matrix%first(j), matrix%first(j + 1) - 1
            if (abs(matrix%entry(i)) > 0.0_dp) call join(parent, 1 + mod(matrix%row(i) - 1, m), 1 + mod(j - 1, m))
         end do
      end do
   end subroutine join_entries

   !> Joins the parts of points that a dense matrix couples.
   pure subroutine join_coupled(parent, matrix)
      integer, intent(inout) :: parent(:) !! a point of the same part, of a lower number or the same (m)
      real(dp), intent(in) :: matrix(:, :) !! the matrix (2m, 2m)
      integer :: i, j, m

      m = size(parent)
      do j = 1, 2*m
         do i = j + 1, 2*m
            if (abs(matrix(i, j)) > 0.0_dp) call join(parent, 1 + mod(i - 1, m), 1 + mod(j - 1, m))
         end do
         ! A body in one piece couples all points in the first column.
         if (all(parent == 1)) return
      end do
   end subroutine join_coupled

   !> Joins the parts of two points.
   pure subroutine join(parent, i, j)
      integer, intent(inout) :: parent(:) !! a point of the same part, of a lower number or the same (m)
      integer, intent(in) :: i !! a point
      integer, intent(in) :: j !! another one
      integer :: low, high

      low = min(root_of(parent, i), root_of(parent, j))
      high = max(root_of(parent, i), root_of(parent, j))
      parent(high) = low
      parent(i) = low
      parent(j) = low
   end subroutine join

   !> The first point of the part of a point.
   pure integer function root_of(parent, point) result(root)
      integer, intent(in) :: parent(:) !! a point of the same part, of a lower number or the same (m)
      integer, intent(in) :: point !! the point

      root = point
      do while (parent(root) /= root)
         root = parent(root)
      end do
   end function root_of

   !> Makes the contact problem of a part.
   subroutine new_part(part, problem, points, rows)
      type(contact_problem_t), intent(out) :: part !! the part
      type(contact_problem_t), intent(in) :: problem !! the whole
      integer, intent(in) :: points(:) !! points of the part
      integer, intent(in) :: rows(:) !! their rows
      type(symmetric_matrix_t) :: compliance

      if (problem%is_reduced()) then
         call cut_matrix(compliance, problem%compliance, rows)
         call new_reduced_problem(part, compliance, problem%free_displacement(rows), problem%friction(points))
      else
         call new_contact_problem(part, problem%stiffness(rows, rows), problem%is_held)
         part%load = problem%load(rows)
         part%friction = problem%friction(points)
         part%prescribed = problem%prescribed
      end if
      part%gap = problem%gap(points)
      part%anchor = problem%anchor(points)
      part%slip_bound = problem%slip_bound(points)
   end subroutine new_part

   !> The rows and columns of a part.
   pure subroutine cut_matrix(part, matrix, rows)
      type(symmetric_matrix_t), intent(out) :: part !! the part
      type(symmetric_matrix_t), intent(in) :: matrix !! the whole
      integer, intent(in) :: rows(:) !! the rows
      real(dp), allocatable :: values(:, :), entry(:)
      integer, allocatable :: place(:), row(:), column(:)
      integer :: i, j, n

      if (.not. matrix%is_sparse() .or. size(rows) < 2*least_sparse_points) then
         values = matrix%block(rows, rows)
         call new_dense_matrix(part, values)
         return
      end if
      allocate (place(matrix%n), source=0)
      place(rows) = [(i, i=1, size(rows))]
      n = sum(matrix%first(rows + 1) - matrix%first(rows))
      allocate (row(n), column(n), entry(n))
      n = 0
      do j = 1, size(rows)
         do i = matrix%first(rows(j)), matrix%first(rows(j) + 1) - 1
            if (place(matrix%row(i)) == 0) cycle
            n = n + 1
            row(n) = place(matrix%row(i))
            column(n) = j
            entry(n) = matrix%entry(i)
         end do
      end do
      call new_sparse_matrix(part, size(rows), row(:n), column(:n), entry(:n))
   end subroutine cut_matrix

   !> Adds the record of a part, as if all parts were solved side by side: of each iteration the largest residual.
   pure subroutine add_record(solution, found, part)
      type(contact_solution_t), intent(inout) :: solution !! gains the record
      type(contact_solution_t), intent(in) :: found !! solution of the part
      real(dp), intent(in) :: part !! size of its matrix over that of the whole [-]
      type(effort_t) :: effort
      integer :: n

      effort = found%effort
      effort%n_products = part*effort%n_products
      call solution%effort%add(effort)
      do n = solution%n_iterations + 1, found%n_iterations
         call solution%record_residual(0.0_dp)
      end do
      n = found%n_iterations
      solution%history(:n) = max(solution%history(:n), found%history(:n))
   end subroutine add_record

end module amontons_components
