!> Contact problems written by hand or drawn at random, the same every time.
module sample_problems
   use amontons_contact_operator, only: contact_operator_t, new_compliance_operator, new_stiffness_operator
   use amontons_contact_problem, only: contact_problem_t, new_contact_problem, new_reduced_problem
   use amontons_kinds, only: dp, int64
   use amontons_symmetric_matrix, only: new_dense_matrix, new_sparse_matrix, symmetric_matrix_t
   implicit none (type, external)
   private

   public :: arbitrary_matrix, arbitrary_numbers, arbitrary_problem, bar_problem, compliance_problem, free_problem, &
      inverse, keep_matrix, one_point, reduced, semidefinite_problem, sparse_form, stiffness_problem, three_solutions, &
      two_points, written_problem

   !> An operator, and the one that was made before it.
   type :: kept_t
      type(contact_operator_t) :: matrix !! the operator
      type(kept_t), pointer :: before => null() !! the one before
   end type kept_t

   !> The last of the operators, which live as long as the tests.
   type(kept_t), pointer :: last => null()

   !> Stiffness of the point in `one_point`.
   real(dp), parameter :: point_stiffness(2, 2) = reshape([4.0_dp, 1.0_dp, 1.0_dp, 2.0_dp], [2, 2])
   !> Compliance of the problem that has three solutions.
   real(dp), parameter :: coupled_compliance(2, 2) = reshape([1.0_dp, 0.8_dp, 0.8_dp, 1.0_dp], [2, 2])

contains

   !> Makes a contact problem of a stiffness that lives as long as the tests.
   subroutine stiffness_problem(problem, stiffness, is_held, n_tangents)
      type(contact_problem_t), intent(out) :: problem !! the problem
      real(dp), intent(in) :: stiffness(:, :) !! S (2m, 2m)
      logical, intent(in) :: is_held !! whether S is positive definite
      integer, intent(in), optional :: n_tangents !! tangential directions of a point; 1 if it is not given
      real(dp), allocatable :: values(:, :)

      call keep_another()
      allocate (values, source=stiffness)
      call new_stiffness_operator(last%matrix, values, is_held, n_tangents)
      call new_contact_problem(problem, last%matrix)
   end subroutine stiffness_problem

   !> Makes a reduced problem of a compliance that lives as long as the tests.
   subroutine compliance_problem(problem, compliance, free_displacement, friction)
      type(contact_problem_t), intent(out) :: problem !! the problem
      type(symmetric_matrix_t), intent(in) :: compliance !! A (2m, 2m)
      real(dp), intent(in) :: free_displacement(:) !! v_free (2m)
      real(dp), intent(in) :: friction(:) !! phi (m)

      call keep_another()
      call new_compliance_operator(last%matrix, compliance)
      call new_reduced_problem(problem, last%matrix, free_displacement, friction)
   end subroutine compliance_problem

   !> Gives a problem a copy of its operator, which lives as long as the tests and which no other problem has.
   subroutine keep_matrix(problem, factor)
      type(contact_problem_t), intent(inout) :: problem !! the problem
      real(dp), intent(in), optional :: factor !! what the compliance is multiplied by; 1 if it is not given

      call keep_another()
      last%matrix = problem%matrix
      problem%matrix => last%matrix
      if (.not. present(factor)) return
      associate (compliance => problem%matrix%compliance)
         if (allocated(compliance%values)) compliance%values = factor*compliance%values
         if (allocated(compliance%entry)) compliance%entry = factor*compliance%entry
      end associate
      call problem%matrix%find_augmentation()
   end subroutine keep_matrix

   !> Makes room for another operator.
   subroutine keep_another()
      type(kept_t), pointer :: next

      allocate (next)
      next%before => last
      last => next
   end subroutine keep_another

   !> A held problem from its numbers.
   subroutine written_problem(problem, stiffness, load, gap, friction)
      type(contact_problem_t), intent(out) :: problem !! the problem
      real(dp), intent(in) :: stiffness(:, :) !! S (2m, 2m)
      real(dp), intent(in) :: load(:) !! q (2m)
      real(dp), intent(in) :: gap(:) !! d (m)
      real(dp), intent(in) :: friction(:) !! phi (m)

      call stiffness_problem(problem, stiffness, is_held=.true.)
      problem%load = load
      problem%gap = gap
      problem%friction = friction
   end subroutine written_problem

   !> One point with S = [4 1; 1 2], so that A = [2 -1; -1 4]/7; its solution is unique for friction below 2.
   subroutine one_point(problem, load, gap, friction)
      type(contact_problem_t), intent(out) :: problem !! the problem
      real(dp), intent(in) :: load(2) !! q
      real(dp), intent(in) :: gap !! d
      real(dp), intent(in) :: friction !! phi

      call written_problem(problem, point_stiffness, load, [gap], [friction])
   end subroutine one_point

   !> Two points whose normal and tangential directions do not couple: [2 -1; -1 2] in each; gap 0, friction 0.4.
   subroutine two_points(problem, load)
      type(contact_problem_t), intent(out) :: problem !! the problem
      real(dp), intent(in) :: load(4) !! q
      real(dp) :: stiffness(4, 4)

      stiffness = 0.0_dp
      stiffness(:2, :2) = reshape([2.0_dp, -1.0_dp, -1.0_dp, 2.0_dp], [2, 2])
      stiffness(3:, 3:) = stiffness(:2, :2)
      call written_problem(problem, stiffness, load, [0.0_dp, 0.0_dp], [0.4_dp, 0.4_dp])
   end subroutine two_points

   !> Points along a bar: springs of stiffness 1 between neighbors, and one between the first point and the ground, in
   !> one direction; in the other, one of stiffness 1 between each point and the ground. Without its spring to the
   !> ground the bar is free.
   subroutine bar_problem(problem, n_points, is_normal, ground)
      type(contact_problem_t), intent(out) :: problem !! the problem; set its load, gap and friction next
      integer, intent(in) :: n_points !! number of points
      logical, intent(in) :: is_normal !! whether the bar points along the normals, else along the contact line
      real(dp), intent(in) :: ground !! stiffness of the spring to the ground
      real(dp) :: stiffness(2*n_points, 2*n_points)
      integer :: i, first

      stiffness = 0.0_dp
      do i = 1, 2*n_points
         stiffness(i, i) = 1.0_dp
      end do
      first = merge(0, n_points, is_normal)
      do i = first + 1, first + n_points
         stiffness(i, i) = merge(1.0_dp, 2.0_dp, i == first + n_points)
         if (i > first + 1) stiffness(i, i - 1) = -1.0_dp
         if (i < first + n_points) stiffness(i, i + 1) = -1.0_dp
      end do
      stiffness(first + 1, first + 1) = 1.0_dp + ground
      call stiffness_problem(problem, stiffness, is_held=ground > 0.0_dp)
   end subroutine bar_problem

   !> Two points that nothing holds in the normal direction: a spring of stiffness 1 between u_N1 + u_T1 / 2 and u_N2,
   !> the rest of the stiffness 3 in each tangential direction; gap 0, friction 0.5.
   subroutine free_problem(problem, load)
      type(contact_problem_t), intent(out) :: problem !! the problem
      real(dp), intent(in) :: load(4) !! q
      real(dp), parameter :: spring(4) = [1.0_dp, -1.0_dp, 0.5_dp, 0.0_dp]
      real(dp) :: stiffness(4, 4)

      stiffness = spread(spring, 1, 4)*spread(spring, 2, 4)
      stiffness(3, 3) = 3.0_dp
      stiffness(4, 4) = 3.0_dp
      call stiffness_problem(problem, stiffness, is_held=.false.)
      problem%load = load
      problem%friction = 0.5_dp
   end subroutine free_problem

   !> One point with A = [1 0.8; 0.8 1], B = (-0.1, -0.5) and friction 1.5, and its three solutions: open, sliding,
   !> sticking.
   subroutine three_solutions(problem, forces)
      type(contact_problem_t), intent(out) :: problem !! the problem
      real(dp), intent(out) :: forces(2, 3) !! lambda of each solution

      call written_problem(problem, inverse(coupled_compliance), &
         matmul(inverse(coupled_compliance), [-0.1_dp, -0.5_dp]), [0.0_dp], [1.5_dp])
      forces(:, 1) = [0.0_dp, 0.0_dp]
      forces(:, 2) = [0.5_dp, -0.75_dp]
      forces(:, 3) = [5.0_dp/6.0_dp, -7.0_dp/6.0_dp]
   end subroutine three_solutions

   !> The same held problem in its reduced form.
   subroutine reduced(problem, held)
      type(contact_problem_t), intent(out) :: problem !! the reduced form
      type(contact_problem_t), intent(in) :: held !! a problem with a positive definite stiffness
      type(symmetric_matrix_t) :: compliance
      real(dp), allocatable :: values(:, :), displacement(:)

      values = inverse(held%matrix%stiffness%values)
      displacement = matmul(values, held%load)
      displacement(:held%n_points) = displacement(:held%n_points) - held%gap
      call new_dense_matrix(compliance, values)
      call compliance_problem(problem, compliance, displacement, held%friction)
      problem%anchor = held%anchor
      problem%slip_bound = held%slip_bound
   end subroutine reduced

   !> The same reduced problem with its compliance in the sparse form.
   subroutine sparse_form(problem, dense)
      type(contact_problem_t), intent(out) :: problem !! with a sparse compliance
      type(contact_problem_t), intent(in) :: dense !! with a dense one
      type(symmetric_matrix_t) :: compliance
      integer :: i, j, n

      n = 2*dense%n_points
      call new_sparse_matrix(compliance, n, [((i, i=1, n), j=1, n)], [((j, i=1, n), j=1, n)], &
         reshape(dense%matrix%compliance%values, [n*n]))
      call compliance_problem(problem, compliance, dense%free_displacement, dense%friction)
      problem%gap = dense%gap
      problem%anchor = dense%anchor
      problem%slip_bound = dense%slip_bound
   end subroutine sparse_form

   !> A reduced problem with a compliance of a lower rank. Its free displacements are such that forces which press all
   !> points would bring them to rest, so that a solution exists for small friction.
   subroutine semidefinite_problem(problem, n_points, rank, seed, friction)
      type(contact_problem_t), intent(out) :: problem !! the problem
      integer, intent(in) :: n_points !! number of points m
      integer, intent(in) :: rank !! rank of A, at most 2m
      integer, intent(in) :: seed !! which problem
      real(dp), intent(in) :: friction !! phi of all points
      type(symmetric_matrix_t) :: compliance
      real(dp), allocatable :: values(:, :)
      real(dp) :: root(2*n_points, rank), numbers(3*n_points)

      root = reshape(arbitrary_numbers(2*n_points*rank, seed), [2*n_points, rank])
      numbers = arbitrary_numbers(3*n_points, seed + 500)
      values = matmul(root, transpose(root))
      call new_dense_matrix(compliance, values)
      call compliance_problem(problem, compliance, matmul(root, matmul([1.0_dp + numbers(:n_points), &
         0.5_dp*numbers(n_points + 1:2*n_points)], root)) &
         - [abs(numbers(2*n_points + 1:)), spread(0.0_dp, 1, n_points)], spread(friction, 1, n_points))
   end subroutine semidefinite_problem

   !> A problem without visible order: some points open, some closed, gaps from -0.2 to 0.4, friction up to 0.3. If it
   !> is not held, a common normal displacement of all points is free, and the load presses the points down.
   subroutine arbitrary_problem(problem, n_points, seed, is_held)
      type(contact_problem_t), intent(out) :: problem !! the problem
      integer, intent(in) :: n_points !! number of points m
      integer, intent(in) :: seed !! which problem
      logical, intent(in) :: is_held !! whether S is positive definite
      real(dp) :: stiffness(2*n_points, 2*n_points), numbers(4*n_points)

      stiffness = arbitrary_matrix(2*n_points, seed)
      numbers = arbitrary_numbers(4*n_points, seed + 1000)
      if (.not. is_held) then
         associate (rows => stiffness(:n_points, :))
            rows = rows - spread(sum(rows, dim=1)/n_points, 1, n_points)
         end associate
         associate (columns => stiffness(:, :n_points))
            columns = columns - spread(sum(columns, dim=2)/n_points, 2, n_points)
         end associate
      end if
      call stiffness_problem(problem, stiffness, is_held)
      problem%load = numbers(:2*n_points)
      if (.not. is_held) then
         associate (pressure => problem%load(:n_points))
            pressure = pressure + 0.5_dp - sum(pressure)/n_points
         end associate
      end if
      problem%gap = 0.1_dp + 0.3_dp*numbers(2*n_points + 1:3*n_points)
      problem%friction = 0.15_dp*(1.0_dp + numbers(3*n_points + 1:))
   end subroutine arbitrary_problem

   !> A symmetric matrix with eigenvalues between 0.2 and about 1.5, without visible order.
   pure function arbitrary_matrix(n, seed) result(matrix)
      integer, intent(in) :: n !! its order
      integer, intent(in) :: seed !! which matrix
      real(dp) :: matrix(n, n)
      integer :: i

      matrix = reshape(arbitrary_numbers(n*n, seed), [n, n])
      matrix = matmul(matrix, transpose(matrix))/n
      do i = 1, n
         matrix(i, i) = matrix(i, i) + 0.2_dp
      end do
   end function arbitrary_matrix

   !> Numbers between -1 and 1 from a linear congruential generator.
   pure function arbitrary_numbers(n, seed) result(numbers)
      integer, intent(in) :: n !! how many
      integer, intent(in) :: seed !! which ones
      real(dp) :: numbers(n)
      integer(int64), parameter :: factor = 1103515245_int64, increment = 12345_int64, modulus = 2_int64**31
      integer(int64) :: state
      integer :: i

      ! Seeds that follow each other must not begin alike.
      state = modulo(factor*modulo(factor*seed + increment, modulus), modulus)
      do i = 1, n
         state = modulo(factor*state + increment, modulus)
         numbers(i) = 2.0_dp*real(state, dp)/real(modulus, dp) - 1.0_dp
      end do
   end function arbitrary_numbers

   !> The inverse of a symmetric positive definite matrix, by Gauss and Jordan.
   pure function inverse(matrix)
      real(dp), intent(in) :: matrix(:, :) !! the matrix (n, n)
      real(dp) :: inverse(size(matrix, 1), size(matrix, 1))
      real(dp) :: row(size(matrix, 1)), column(size(matrix, 1))
      integer :: k

      inverse = matrix
      do k = 1, size(matrix, 1)
         row = inverse(k, :)/inverse(k, k)
         column = inverse(:, k)
         row(k) = 1.0_dp/inverse(k, k)
         column(k) = 0.0_dp
         inverse(:, k) = 0.0_dp
         inverse(k, :) = 0.0_dp
         inverse = inverse - spread(column, 2, size(row))*spread(row, 1, size(row))
         inverse(k, :) = row
      end do
   end function inverse

end module sample_problems
