!> The algorithm of Pop and Zelina (2005), section 3: Gauss-Seidel on their dual problem (2.3), split into tangential
!> and normal contact forces.
!>
!> A = [A11 A12; A21 A22] and B = (B1; B2) are those of (2.3), on the normal (1) and the tangential (2) forces of the
!> contact points; phi is the friction, g a slip bound that the problem gives. On the left the paper as it is printed,
!> on the right what is solved here, in between the number of the erratum (doc/theory.md, section 9):
!>
!>     lambda_N := g;  lambda_T := 0                   (8)   lambda_N, lambda_T: the start of the run
!>     repeat                                                repeat
!>        lambda_T := (D - L)^-1 (U lambda_T + B2)     (7)      lambda_T := arg min  1/2 l.A22 l - l.(B2 - A21 lambda_N)
!>           such that |lambda_T| <= phi lambda_N                  over |l| <= g + phi lambda_N
!>        lambda_N := A11^-1 (B1 - A12 lambda_T)       (7)      lambda_N := arg min  1/2 l.A11 l - l.(B1 - A12 lambda_T)
!>           such that lambda_N >= 0                               over l >= 0
!>     until |lambda - previous lambda| <= Tol         (8)   until the residual of the contact problem <= tolerance
!>
!> D - L - U is the paper's S = A21 A11^-1 A12 - A22. On the right each half step is (2.3) with the other forces held
!> (Haslinger, Dostal and Kucera, CMAME 191, 2002): "such that" means the minimizer under the bounds, not the solution
!> without them, cut afterwards.
!>
!> Variant `exact` is the right-hand side. `clip` solves the normal half step without its bound and cuts the result at
!> zero, which is right only if nothing separates. `printed` is the left-hand side to the letter; it comes to rest at a
!> wrong answer, and says so. In space |lambda_T| is the length of a vector, and `exact` the only variant: the printed
!> lines are those of one tangential direction.
module amontons_splitting
   use amontons_acceleration, only: accelerate, acceleration_t, new_acceleration, proximal_center_t
   use amontons_box_program, only: inner_accuracy, solve_box_program, solve_disc_program
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, dual_method_t, effort_t
   use amontons_dense, only: allocate_matrix, cholesky_factor_regularized, cholesky_solve
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_friction_law, only: bounded, cut_to_bound
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: splitting_t, variant_names

   !> Variants of the paper's half steps, as a deck writes them.
   character(7), parameter :: variant_names(3) = [character(7) :: 'exact', 'clip', 'printed']

   !> A quarter of A, one of its four blocks.
   real(dp), parameter :: quarter = 0.25_dp

   !> The splitting method.
   type, extends(dual_method_t) :: splitting_t
   contains
      procedure :: solve => splitting_solve
   end type splitting_t

   !> The matrices of the printed half steps.
   type :: printed_matrices_t
      real(dp), allocatable :: a11_factor(:, :) !! Cholesky factor of A11, for `clip` and `printed` (m, m)
      real(dp), allocatable :: schur(:, :) !! the paper's S, for `printed` (m, m) [L/F]
   end type printed_matrices_t

contains

   !> Alternates the two half steps until the residual is small or, in the inexact variants, the forces stop changing;
   !> returns the best pair if none is a solution.
   subroutine splitting_solve(self, problem, solution, error)
      class(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite, or memory ran out
      ! An iteration that leaves more of the residual may have met the rounding errors of A.
      real(dp), parameter :: slow = 0.9_dp
      ! Iterations that make less of the residual are accelerated.
      integer, parameter :: recent = 10
      real(dp), parameter :: tenth = 0.1_dp
      ! If the forces stop changing while the residual is this many times the tolerance, it will not decrease any more.
      real(dp), parameter :: far_from_solved = 1.0e3_dp
      type(printed_matrices_t) :: printed
      type(proximal_center_t) :: center
      type(acceleration_t) :: acceleration
      type(contact_solution_t) :: best
      real(dp), dimension(problem%matrix%n) :: force, displacement, product, start, b
      real(dp), allocatable :: place(:)
      real(dp) :: force_scale, previous, accuracy
      integer :: iteration
      logical :: is_exact, may_continue, is_refining

      call solution%reset()
      best = solution
      call solution%effort%factorize(.not. allocated(problem%matrix%compliance))
      call self%prepare(problem, error)
      if (allocated(error)) return
      is_exact = self%variant == 'exact'
      if (.not. is_exact) call new_printed_matrices(printed, self%variant, problem, solution%effort, error)
      if (allocated(error)) return
      call new_acceleration(acceleration, 'anderson')
      b = 0.0_dp
      force = solution%force
      force(:problem%n_points) = max(0.0_dp, force(:problem%n_points))
      center%place = solution%displacement
      displacement = problem%displacement(problem%dual_load(center%place), force)
      force_scale = problem%force_scale()
      call solution%effort%multiply(2.0_dp)
      previous = huge(previous)
      is_refining = .false.

      associate (alpha => problem%matrix%proximal_parameter, a => problem%matrix%compliance)
         do iteration = 1, self%max_iterations
            start = force
            place = center%place
            accuracy = inner_accuracy*self%tolerance*problem%force_scale(force)
            ! On an ill-conditioned A a small move down its parabolas may violate the law by a large force.
            if (is_refining) accuracy = accuracy*minval(a%reciprocal_diagonal()/problem%matrix%augmentation)
            if (.not. is_exact) b = problem%dual_load(center%place)
            call half_steps(self, problem, displacement - problem%reference(), accuracy, b, printed, force, &
               solution%effort, error)
            if (allocated(error)) return
            call a%multiply(force - start, product)
            displacement = displacement - product
            call solution%effort%multiply(1.0_dp)
            if (is_refining) call refine(problem, center%place, force, displacement, solution%effort)

            call solution%record(problem, displacement, force, self%tolerance, may_continue)
            if (.not. may_continue) return
            ! The paper's stopping rule does not imply a solution. A proximal step counts as the force that it causes.
            if (.not. is_exact) solution%is_at_rest = solution%residual > far_from_solved*self%tolerance .and. &
               maxval(abs([force - start, alpha*(displacement - center%place)]))/force_scale <= self%tolerance
            if (solution%is_at_rest) return
            call best%take_better(solution)
            is_refining = is_refining .or. solution%residual > slow*previous .and. problem%matrix%has_stiffness()
            previous = solution%residual

            if (.not. problem%matrix%is_held) call center%move(problem, displacement, solution%effort)
            if (is_exact .and. solution%is_stagnant(recent, tenth)) call accelerate(acceleration, problem, &
               [start, alpha*place], force, center%place, displacement, solution)
         end do
      end associate
      call solution%take_better(best)
   end subroutine splitting_solve

   !> The two half steps: lambda_T within the bounds of lambda_N, then lambda_N. With `exact` both are (2.3) with the
   !> other forces held, with `clip` the first alone; with `printed` both are as the paper prints them.
   subroutine half_steps(self, problem, distance, accuracy, b, printed, force, effort, error)
      class(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: distance(:) !! B - A lambda, of the forces at the start (2m) [L]
      real(dp), intent(in) :: accuracy !! of the quadratic programs [F]
      real(dp), intent(in) :: b(:) !! B (2m) [L]
      type(printed_matrices_t), intent(in) :: printed !! the matrices of the printed lines
      real(dp), intent(inout) :: force(:) !! lambda (2m) [F]
      type(effort_t), intent(inout) :: effort !! gains theirs
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp), dimension(problem%n_points) :: bound, coupled
      real(dp) :: change(size(force) - problem%n_points)
      integer :: m, i

      m = problem%n_points
      bound = problem%bound(force(:m))
      if (self%variant == 'printed') then
         ! lambda_T := (D - L)^-1 (U lambda_T + B2) such that |lambda_T| <= phi lambda_N
         ! One sweep of Gauss-Seidel on S lambda_T = B2, cut at the slip bound. Where nothing slides or separates,
         ! -S lambda_T = B2 - A21 A11^-1 B1 is right: the matrix has the wrong sign, and a term lacks (erratum 7).
         associate (tangential => force(m + 1:), schur => printed%schur)
            do i = 1, m
               tangential(i) = tangential(i) + (b(m + i) - dot_product(schur(:, i), tangential))/schur(i, i)
            end do
            tangential = bounded(tangential, bound)
         end associate
         call effort%multiply(quarter)
      else if (problem%matrix%n_tangents == 2) then
         ! the same over discs
         change = 0.0_dp
         call solve_disc_program(self%box, problem%matrix%compliance, [m + 1, size(force)], distance(m + 1:), &
            force(m + 1:), bound, accuracy, change, effort, error)
         force(m + 1:) = cut_to_bound(force(m + 1:) + change, bound)
         if (allocated(error)) return
      else
         ! lambda_T := arg min  1/2 l.A22 l - l.(B2 - A21 lambda_N)  over |l| <= g + phi lambda_N
         call minimize(self%box, problem, [m + 1, 2*m], distance(m + 1:), -bound, bound, accuracy, force(m + 1:), &
            change, effort, error)
         if (allocated(error)) return
      end if
      if (self%variant == 'exact') then
         ! lambda_N := arg min  1/2 l.A11 l - l.(B1 - A12 lambda_T)  over l >= 0
         call problem%matrix%compliance%part_multiply([1, m], [m + 1, size(force)], change, coupled)
         call effort%multiply(real(m, dp)*size(change)/real(size(force), dp)**2)
         call minimize(self%box, problem, [1, m], distance(:m) - coupled, spread(0.0_dp, 1, m), &
            spread(huge(1.0_dp), 1, m), accuracy, force(:m), change(:m), effort, error)
      else
         ! lambda_N := A11^-1 (B1 - A12 lambda_T) such that lambda_N >= 0
         ! solved without the bound, then cut at zero, which is right where nothing is cut
         call problem%matrix%compliance%part_multiply([1, m], [m + 1, 2*m], force(m + 1:), force(:m))
         force(:m) = b(:m) - force(:m)
         call cholesky_solve(printed%a11_factor, force(:m))
         force(:m) = max(0.0_dp, force(:m))
         call effort%multiply(1.0_dp + quarter)
      end if
   end subroutine half_steps

   !> A half step, (2.3) for the forces of one direction alone: min 1/2 l.A l - l.(B - A' l') between bounds, l' the
   !> other forces. It is solved for the change of the forces: its linear term is then the distance, small at last, and
   !> loses no digits as that of the forces does, the difference of large displacements.
   ! allow(S902): a program alone has six parts
   subroutine minimize(box, problem, rows, distance, lower, upper, accuracy, force, change, effort, error)
      character(*), intent(in) :: box !! the solver of box programs
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      integer, intent(in) :: rows(2) !! first and last row of the direction
      real(dp), intent(in) :: distance(:) !! B - A lambda in this direction, of the forces at the start (m) [L]
      real(dp), intent(in) :: lower(:) !! least forces (m) [F]
      real(dp), intent(in) :: upper(:) !! largest forces (m) [F]
      real(dp), intent(in) :: accuracy !! of the quadratic program [F]
      real(dp), intent(inout) :: force(:) !! the forces of the direction (m) [F]
      real(dp), intent(out) :: change(:) !! change of the forces (m) [F]
      type(effort_t), intent(inout) :: effort !! gains that of the quadratic program
      type(error_t), allocatable, intent(out) :: error !! memory ran out

      change = 0.0_dp
      call solve_box_program(box, problem%matrix%compliance, rows, distance, lower - force, upper - force, accuracy, &
         change, effort, error)
      force = min(max(force + change, lower), upper)
   end subroutine minimize

   !> Makes the Cholesky factor of A11 and, for `printed`, the paper's S = A21 A11^-1 A12 - A22, minus the Schur
   !> complement that it is called.
   subroutine new_printed_matrices(printed, variant, problem, effort, error)
      type(printed_matrices_t), intent(out) :: printed !! the matrices
      character(*), intent(in) :: variant !! variant, one of `variant_names`
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      type(effort_t), intent(inout) :: effort !! gains theirs
      type(error_t), allocatable, intent(out) :: error !! the problem is one in space, or memory ran out
      character(*), parameter :: owner = 'the normal or tangential contact forces'
      real(dp), allocatable :: columns(:, :), block(:, :)
      logical :: is_regularized
      integer :: i, m

      if (problem%matrix%n_tangents == 2) call new_error(error, input_refused, "variant = '"//trim(variant)// &
         "' is for the plane: the paper prints its algorithm for one tangential direction; take 'exact'")
      if (allocated(error)) return
      m = problem%n_points
      associate (a => problem%matrix%compliance, normal => [(i, i=1, m)], tangential => [(m + i, i=1, m)])
         call allocate_matrix(printed%a11_factor, m, m, owner, error)
         if (allocated(error)) return
         call a%fill_block(normal, normal, printed%a11_factor)
         associate (rho => a%reciprocal_diagonal())
            call cholesky_factor_regularized(printed%a11_factor, 1.0_dp/rho(:m), is_regularized)
         end associate
         call effort%factorize(.true.)
         if (variant /= 'printed') return
         call allocate_matrix(columns, m, m, owner, error)
         if (.not. allocated(error)) call allocate_matrix(block, m, m, owner, error)
         if (.not. allocated(error)) call allocate_matrix(printed%schur, m, m, owner, error)
         if (allocated(error)) return
         call a%fill_block(normal, tangential, columns)
         call cholesky_solve(printed%a11_factor, columns)
         call a%fill_block(tangential, normal, block)
         printed%schur(:, :) = matmul(block, columns)
         call a%fill_block(tangential, tangential, block)
         printed%schur(:, :) = printed%schur - block
         call effort%multiply(quarter*m)
      end associate
   end subroutine new_printed_matrices

   !> Removes rounding errors of A from displacements, by one step of iterative refinement with S.
   pure subroutine refine(problem, center, force, displacement, effort)
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: center(:) !! center of the proximal step (2m) [L]
      real(dp), intent(in) :: force(:) !! lambda (2m) [F]
      real(dp), intent(inout) :: displacement(:) !! v by A, and then by S (2m) [L]
      type(effort_t), intent(inout) :: effort !! gains that of the products
      real(dp), dimension(size(force)) :: defect, change

      call problem%matrix%multiply_stiffness(displacement, defect)
      defect = problem%load - defect - force + problem%matrix%proximal_parameter*(center - displacement)
      call problem%matrix%compliance%multiply(defect, change)
      call effort%multiply(2.0_dp)
      displacement = displacement + change
   end subroutine refine

end module amontons_splitting
