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
!> wrong answer, and says so.
module amontons_splitting
   use amontons_acceleration, only: acceleration_t, new_acceleration
   use amontons_box_program, only: solve_box_program
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_dense, only: cholesky_factor_softly, cholesky_solve
   use amontons_effort, only: effort_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: bounded
   use amontons_kinds, only: dp
   use amontons_newton, only: newton_t
   use amontons_proximal_center, only: accelerate, proximal_center_t
   use amontons_proximal_path, only: finish, follow_proximal_path
   implicit none (type, external)
   private

   public :: splitting_t, variant_names

   !> The readings of the paper's half steps, as a deck writes them.
   character(7), parameter :: variant_names(3) = [character(7) :: 'exact', 'clip', 'printed']

   !> A quarter of A, one of its four blocks.
   real(dp), parameter :: quarter = 0.25_dp

   !> The splitting method.
   type, extends(contact_method_t) :: splitting_t
      integer :: patience = 50 !! how many iterations without a better pair lead to proximal steps
   contains
      procedure :: prepare => splitting_prepare
      procedure :: solve => splitting_solve
   end type splitting_t

   !> The matrices of the printed half steps.
   type :: printed_matrices_t
      real(dp), allocatable :: a11_factor(:, :) !! Cholesky factor of A11, for `clip` and `printed` (m, m)
      real(dp), allocatable :: schur(:, :) !! the paper's S, for `printed` (m, m) [L/F]
   end type printed_matrices_t

contains

   !> Makes the compliance.
   subroutine splitting_prepare(self, problem, error)
      class(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! a problem on the operator
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite, or memory ran out

      associate (unused => self)
      end associate
      call problem%matrix%prepare_compliance(error)
   end subroutine splitting_prepare

   !> Alternates the two half steps. Where these lead nowhere, the statuses may be right all the same, so that a linear
   !> system gives the forces; else takes proximal steps from the start, until they are.
   recursive subroutine splitting_solve(self, problem, solution, error)
      class(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite
      ! Of a step between springs; and of Newton's, one more than exact statuses need.
      integer, parameter :: steps_of_one = 30, n_last_steps = 3
      type(splitting_t) :: alone
      type(newton_t) :: last
      type(contact_solution_t) :: first

      alone = self
      if (.not. problem%matrix%has_stiffness() .or. self%variant /= 'exact') alone%patience = huge(1)
      first = solution
      call alternate(alone, problem, first, error)
      if (allocated(error)) return
      last = newton_t(tolerance=self%tolerance, max_iterations=n_last_steps, patience=huge(1))
      if (alone%patience < huge(1)) then
         if (.not. first%is_converged) call finish(problem, self%max_iterations, first, error, last)
      end if
      if (first%is_converged .or. first%n_iterations >= self%max_iterations .or. alone%patience == huge(1)) then
         solution = first
         return
      end if
      alone%patience = huge(1)
      alone%max_iterations = steps_of_one
      call follow_proximal_path(alone, problem, self%max_iterations - first%n_iterations, solution, error, last)
      if (allocated(error)) return
      call solution%follow(first)
      call solution%take_better(first)
   end subroutine splitting_solve

   !> Alternates the two half steps until the residual is small, the forces come to rest in the inexact variants, or
   !> nothing is better for long; keeps the best pair where none is the solution.
   subroutine alternate(self, problem, solution, error)
      type(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite
      real(dp), allocatable :: force(:), displacement(:), place(:)
      type(printed_matrices_t) :: printed
      type(proximal_center_t) :: center
      type(acceleration_t) :: acceleration
      type(contact_solution_t) :: best
      ! An iteration that leaves more of the residual may have met the rounding errors of A.
      real(dp), parameter :: slow = 0.9_dp
      real(dp), parameter :: half = 0.5_dp
      real(dp) :: change, force_scale, previous
      integer :: iteration
      logical :: may_continue, is_refining

      call solution%reset()
      best = solution
      call solution%effort%factorize(.not. allocated(problem%matrix%compliance))
      call self%prepare(problem, error)
      if (allocated(error)) return
      call new_acceleration(acceleration, 'anderson')
      force = solution%force
      force(:problem%n_points) = max(0.0_dp, force(:problem%n_points))
      center%place = solution%displacement
      allocate (displacement, source=problem%displacement(problem%dual_load(center%place), force))
      force_scale = problem%force_scale()
      call new_printed_matrices(printed, self%variant, problem, solution%effort)
      call solution%effort%multiply(2.0_dp)
      previous = huge(previous)
      is_refining = .false.

      do iteration = 1, self%max_iterations
         solution%force = force
         place = center%place
         call iterate(self, problem, center%place, is_refining, printed, force, displacement, solution%effort)
         ! A proximal step counts as the force that it takes.
         change = maxval(abs([force - solution%force, problem%matrix%proximal_parameter &
            *(displacement - center%place)]))/force_scale
         associate (start => [solution%force, problem%matrix%proximal_parameter*place])
            call solution%record(problem, displacement, force, self%tolerance, may_continue)
            if (.not. may_continue) return
            solution%is_at_rest = is_stopped(self, change, solution%residual)
            if (solution%is_at_rest) return
            call best%take_better(solution)
            if (solution%is_stagnant(self%patience, half)) exit
            is_refining = is_refining .or. solution%residual > slow*previous .and. problem%matrix%has_stiffness()
            previous = solution%residual
            call move_on(self, problem, start, center, force, displacement, acceleration, solution)
         end associate
      end do
      call solution%take_better(best)
   end subroutine alternate

   !> Makes the start of the next iteration: moves the center of a loose body, and accelerates slow iterations.
   subroutine move_on(self, problem, start, center, force, displacement, acceleration, solution)
      type(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: start(:) !! forces, and the center times alpha, before the iteration (4m) [F]
      type(proximal_center_t), intent(inout) :: center !! the center
      real(dp), intent(inout) :: force(:) !! lambda after it (2m) [F]
      real(dp), intent(inout) :: displacement(:) !! v of these forces and the center (2m) [L]
      type(acceleration_t), intent(inout) :: acceleration !! the last iterations
      type(contact_solution_t), intent(inout) :: solution !! its record
      integer, parameter :: recent = 10
      real(dp), parameter :: tenth = 0.1_dp

      if (.not. problem%matrix%is_held) call center%move(problem, displacement, solution%effort)
      if (self%variant /= 'exact' .or. .not. solution%is_stagnant(recent, tenth)) return
      call accelerate(acceleration, problem, start, force, center%place, displacement, solution)
   end subroutine move_on

   !> One iteration: both half steps, and the displacements of the forces that they lead to.
   pure subroutine iterate(self, problem, center, is_refining, printed, force, displacement, effort)
      class(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: center(:) !! center of the proximal step (2m) [L]
      logical, intent(in) :: is_refining !! whether rounding errors of A are taken out
      type(printed_matrices_t), intent(in) :: printed !! what the printed lines take besides A
      real(dp), intent(inout) :: force(:) !! lambda (2m) [F]
      real(dp), intent(inout) :: displacement(:) !! v of these forces (2m) [L]
      type(effort_t), intent(inout) :: effort !! gains theirs
      ! Half steps a hundredth as wrong as the forces may be.
      real(dp), parameter :: half_step_part = 1.0e-2_dp
      real(dp), dimension(size(force)) :: before, product
      real(dp) :: accuracy

      before = force
      accuracy = half_step_part*self%tolerance*problem%force_scale(force)
      ! On an ill-conditioned A a small move down its parabolas may violate the law by a large force.
      if (is_refining) accuracy = accuracy &
         *minval(problem%matrix%compliance%reciprocal_diagonal()/problem%augmentation())
      call half_steps(self, problem, center, displacement - problem%reference(), accuracy, printed, force, effort)
      call problem%matrix%compliance%multiply(force - before, product)
      displacement = displacement - product
      call effort%multiply(1.0_dp)
      if (is_refining) call refine(problem, center, force, displacement, effort)
   end subroutine iterate

   !> Both half steps, lambda_T within the bounds of lambda_N and then lambda_N: each as the paper prints it, in the
   !> comment above, or as it is right (`minimize`).
   pure subroutine half_steps(self, problem, center, distance, accuracy, printed, force, effort)
      class(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: center(:) !! center of the proximal step (2m) [L]
      real(dp), intent(in) :: distance(:) !! B - A lambda, of the forces at the start (2m) [L]
      real(dp), intent(in) :: accuracy !! of the quadratic programs [F]
      type(printed_matrices_t), intent(in) :: printed !! what the printed lines take besides A
      real(dp), intent(inout) :: force(:) !! lambda (2m) [F]
      type(effort_t), intent(inout) :: effort !! gains theirs
      real(dp) :: b(2*problem%n_points)
      real(dp), dimension(problem%n_points) :: bound, change, coupled
      integer :: m

      m = problem%n_points
      bound = problem%bound(force(:m))
      b = 0.0_dp
      if (self%variant /= 'exact') then
         b = problem%dual_load(center)
         call effort%multiply(1.0_dp)
      end if

      ! lambda_T := (D - L)^-1 (U lambda_T + B2) such that |lambda_T| <= phi lambda_N
      if (self%variant == 'printed') then
         call printed_tangential_step(printed%schur, b(m + 1:), bound, force(m + 1:))
         call effort%multiply(quarter)
      else
         call minimize(self%box, problem, [m + 1, 2*m], distance(m + 1:), -bound, bound, accuracy, force(m + 1:), &
            change, effort)
      end if

      ! lambda_N := A11^-1 (B1 - A12 lambda_T) such that lambda_N >= 0
      if (self%variant /= 'exact') then
         call clipped_normal_step(problem, printed%a11_factor, b(:m), force(m + 1:), force(:m))
      else
         call problem%matrix%compliance%part_multiply([1, m], [m + 1, 2*m], change, coupled)
         call minimize(self%box, problem, [1, m], distance(:m) - coupled, spread(0.0_dp, 1, m), &
            spread(huge(1.0_dp), 1, m), accuracy, force(:m), change, effort)
      end if
      call effort%multiply(quarter)
   end subroutine half_steps

   !> A half step, (2.3) for the forces of one direction alone: min 1/2 l.A l - l.(B - A' l') between bounds, l' the
   !> other forces. It is solved for the change of the forces: its linear term is then the distance, small at last, and
   !> loses no digits as that of the forces does, the difference of large displacements.
   ! allow(S902): a program alone has six parts
   pure subroutine minimize(box, problem, rows, distance, lower, upper, accuracy, force, change, effort)
      character(*), intent(in) :: box !! the solver of box programs
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      integer, intent(in) :: rows(2) !! first and last row of the direction
      real(dp), intent(in) :: distance(:) !! B - A lambda in this direction, of the forces at the start (m) [L]
      real(dp), intent(in) :: lower(:) !! least forces (m) [F]
      real(dp), intent(in) :: upper(:) !! largest forces (m) [F]
      real(dp), intent(in) :: accuracy !! of the quadratic program [F]
      real(dp), intent(inout) :: force(:) !! the forces of the direction (m) [F]
      real(dp), intent(out) :: change(:) !! what they change by (m) [F]
      type(effort_t), intent(inout) :: effort !! gains that of the quadratic program

      change = 0.0_dp
      call solve_box_program(box, problem%matrix%compliance, rows, distance, lower - force, upper - force, accuracy, &
         change, effort)
      force = min(max(force + change, lower), upper)
   end subroutine minimize

   !> Tangential half step as printed: (D - L)^-1 (U lambda_T + B2), then cut at the slip bound. That is one sweep of
   !> Gauss-Seidel on S lambda_T = B2. Where nothing slides and nothing separates, -S lambda_T = B2 - A21 A11^-1 B1 is
   !> right: the matrix has the wrong sign, and the right-hand side lacks a term (erratum 7).
   pure subroutine printed_tangential_step(schur, b2, bound, tangential)
      real(dp), intent(in) :: schur(:, :) !! the paper's S = D - L - U (m, m) [L/F]
      real(dp), intent(in) :: b2(:) !! B2 (m) [L]
      real(dp), intent(in) :: bound(:) !! slip bound phi lambda_N (m) [F]
      real(dp), intent(inout) :: tangential(:) !! lambda_T (m) [F]
      integer :: i

      do i = 1, size(b2)
         tangential(i) = tangential(i) + (b2(i) - dot_product(schur(:, i), tangential))/schur(i, i)
      end do
      tangential = bounded(tangential, bound)
   end subroutine printed_tangential_step

   !> Normal half step as printed: A11^-1 (B1 - A12 lambda_T), solved without the bound, then cut at zero. Right where
   !> nothing is cut.
   pure subroutine clipped_normal_step(problem, a11_factor, b1, tangential, normal)
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: a11_factor(:, :) !! Cholesky factor of A11 (m, m)
      real(dp), intent(in) :: b1(:) !! B1 (m) [L]
      real(dp), intent(in) :: tangential(:) !! lambda_T (m) [F]
      real(dp), intent(out) :: normal(:) !! lambda_N (m) [F]
      integer :: m

      m = problem%n_points
      call problem%matrix%compliance%part_multiply([1, m], [m + 1, 2*m], tangential, normal)
      normal = b1 - normal
      call cholesky_solve(a11_factor, normal)
      normal = max(0.0_dp, normal)
   end subroutine clipped_normal_step

   !> Whether the paper's stop ends the iteration, which is no sign of a solution.
   pure logical function is_stopped(self, change, residual)
      class(splitting_t), intent(in) :: self !! the method
      real(dp), intent(in) :: change !! largest change of a force, over the force scale [-]
      real(dp), intent(in) :: residual !! the residual [-]
      ! Forces that rest while the residual is this many tolerances away will not lower it any more.
      real(dp), parameter :: far_from_solved = 1.0e3_dp

      is_stopped = self%variant /= 'exact' .and. change <= self%tolerance &
         .and. residual > far_from_solved*self%tolerance
   end function is_stopped

   !> Makes what the printed half steps take besides A.
   pure subroutine new_printed_matrices(printed, variant, problem, effort)
      type(printed_matrices_t), intent(out) :: printed !! the matrices
      character(*), intent(in) :: variant !! which reading
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      type(effort_t), intent(inout) :: effort !! gains theirs

      if (variant == 'exact') return
      printed%a11_factor = factor_of_a11(problem)
      call effort%factorize(.true.)
      if (variant /= 'printed') return
      printed%schur = printed_schur(problem, printed%a11_factor)
      call effort%multiply(quarter*problem%n_points)
   end subroutine new_printed_matrices

   !> The Cholesky factor of A11 (m, m).
   pure function factor_of_a11(problem) result(factor)
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), allocatable :: factor(:, :)
      logical :: is_soft
      integer :: m

      m = problem%n_points
      factor = part(problem, [1, m], [1, m])
      associate (rho => problem%matrix%compliance%reciprocal_diagonal())
         call cholesky_factor_softly(factor, 1.0_dp/rho(:m), is_soft)
      end associate
   end function factor_of_a11

   !> The paper's S = A21 A11^-1 A12 - A22, minus the Schur complement that it is called (m, m) [L/F].
   pure function printed_schur(problem, a11_factor) result(schur)
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: a11_factor(:, :) !! Cholesky factor of A11 (m, m)
      real(dp), allocatable :: schur(:, :)
      real(dp), allocatable :: columns(:, :)
      integer :: m

      m = problem%n_points
      columns = part(problem, [1, m], [m + 1, 2*m])
      call cholesky_solve(a11_factor, columns)
      schur = matmul(part(problem, [m + 1, 2*m], [1, m]), columns) - part(problem, [m + 1, 2*m], [m + 1, 2*m])
   end function printed_schur

   !> A part of A as a full array.
   pure function part(problem, rows, columns)
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      integer, intent(in) :: rows(2) !! first and last row of the part
      integer, intent(in) :: columns(2) !! its first and last column
      real(dp), allocatable :: part(:, :)
      integer :: i

      part = problem%matrix%compliance%block([(i, i=rows(1), rows(2))], [(i, i=columns(1), columns(2))])
   end function part

   !> Takes the rounding errors of A out of displacements, by one step of refinement with S.
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
