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
   use amontons_box_program, only: solve_box_program
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_dense, only: cholesky_factor_softly, cholesky_solve
   use amontons_effort, only: effort_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: bounded
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: splitting_t, variant_names

   !> The readings of the paper's half steps, as a deck writes them.
   character(7), parameter :: variant_names(3) = [character(7) :: 'exact', 'clip', 'printed']

   !> A quarter of A, one of its four blocks.
   real(dp), parameter :: quarter = 0.25_dp

   !> The splitting method.
   type, extends(contact_method_t) :: splitting_t
      character(7) :: variant = 'exact' !! 'exact', 'clip' or 'printed'
      character(6) :: box = 'auto' !! the solver of the exact half steps: 'auto', 'newton' or 'mprgp'
   contains
      procedure :: solve => splitting_solve
   end type splitting_t

contains

   !> Alternates the two half steps until the residual is small or, in the inexact variants, the forces come to rest.
   subroutine splitting_solve(self, problem, solution, error)
      class(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(inout) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite
      real(dp), allocatable :: normal(:), tangential(:), displacement(:), b(:), a11_factor(:, :), schur(:, :)
      ! Forces that rest while the residual is this many tolerances away will not lower it any more.
      real(dp), parameter :: far_from_solved = 1.0e3_dp
      ! Half steps a hundredth as wrong as the forces may be.
      real(dp), parameter :: half_step_part = 1.0e-2_dp
      real(dp) :: change, force_scale, accuracy
      integer :: m, iteration
      logical :: may_continue

      call solution%reset()
      call solution%effort%factorize(.not. allocated(problem%compliance))
      call problem%prepare_compliance(error)
      if (allocated(error)) return
      m = problem%n_points
      normal = max(0.0_dp, solution%force(:m))
      tangential = solution%force(m + 1:)
      b = problem%dual_load(solution%displacement)
      force_scale = problem%force_scale()
      if (self%variant /= 'exact') a11_factor = factor_of_a11(problem)
      call solution%effort%factorize(self%variant /= 'exact')
      if (self%variant == 'printed') then
         schur = printed_schur(problem, a11_factor)
         call solution%effort%multiply(quarter*m)
      end if
      call solution%effort%multiply(1.0_dp)

      do iteration = 1, self%max_iterations
         accuracy = half_step_part*self%tolerance*problem%force_scale([normal, tangential])
         call half_steps(self, problem, b, accuracy, a11_factor, schur, normal, tangential, solution%effort)
         displacement = problem%displacement(b, [normal, tangential])
         call solution%effort%multiply(1.0_dp)
         ! A proximal step counts as the force that it takes.
         change = maxval(abs([[normal, tangential] - solution%force, &
            problem%proximal_parameter*(displacement - solution%displacement)]))/force_scale
         call solution%record(problem, displacement, [normal, tangential], self%tolerance, may_continue)
         if (.not. may_continue) return
         ! The paper's stop, which is no sign of a solution.
         solution%is_at_rest = self%variant /= 'exact' .and. change <= self%tolerance &
            .and. solution%residual > far_from_solved*self%tolerance
         if (solution%is_at_rest) return
         ! A body that only contact holds: a proximal step moves the center to the displacement just found.
         if (problem%is_held) cycle
         b = problem%dual_load(solution%displacement)
         call solution%effort%multiply(1.0_dp)
      end do
   end subroutine splitting_solve

   !> One iteration: lambda_T from lambda_N, then lambda_N from lambda_T, in the reading of the variant.
   pure subroutine half_steps(self, problem, b, accuracy, a11_factor, schur, normal, tangential, effort)
      type(splitting_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: b(:) !! dual load B (2m) [L]
      real(dp), intent(in) :: accuracy !! of the quadratic programs [F]
      real(dp), allocatable, intent(in) :: a11_factor(:, :) !! Cholesky factor of A11, for `clip` and `printed` (m, m)
      real(dp), allocatable, intent(in) :: schur(:, :) !! the paper's S, for `printed` (m, m) [L/F]
      real(dp), intent(inout) :: normal(:) !! lambda_N (m) [F]
      real(dp), intent(inout) :: tangential(:) !! lambda_T (m) [F]
      type(effort_t), intent(inout) :: effort !! gains theirs

      ! A21 lambda_N, or with the paper's S in its place, and A12 lambda_T.
      call effort%multiply(2.0_dp*quarter)
      associate (b1 => b(:problem%n_points), b2 => b(problem%n_points + 1:))
         select case (self%variant)
         case ('exact')
            call tangential_step(self%box, problem, b2, normal, accuracy, tangential, effort)
            call normal_step(self%box, problem, b1, tangential, accuracy, normal, effort)
         case ('clip')
            call tangential_step(self%box, problem, b2, normal, accuracy, tangential, effort)
            call clipped_normal_step(problem, a11_factor, b1, tangential, normal)
         case default
            call printed_tangential_step(schur, b2, problem%bound(normal), tangential)
            call clipped_normal_step(problem, a11_factor, b1, tangential, normal)
         end select
      end associate
   end subroutine half_steps

   !> Tangential half step, (2.3) for lambda_T alone: min 1/2 l.A22 l - l.(B2 - A21 lambda_N), |l| <= g + phi lambda_N.
   !> The paper prints lambda_T := (D - L)^-1 (U lambda_T + B2) such that |lambda_T| <= phi lambda_N (erratum 7).
   pure subroutine tangential_step(box, problem, b2, normal, accuracy, tangential, effort)
      character(*), intent(in) :: box !! the solver of box programs
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: b2(:) !! B2 (m) [L]
      real(dp), intent(in) :: normal(:) !! lambda_N (m) [F]
      real(dp), intent(in) :: accuracy !! of the quadratic program [F]
      real(dp), intent(inout) :: tangential(:) !! lambda_T (m) [F]
      type(effort_t), intent(inout) :: effort !! gains that of the quadratic program
      real(dp) :: coupled(problem%n_points)
      integer :: m

      m = problem%n_points
      call problem%compliance%part_multiply([m + 1, 2*m], [1, m], normal, coupled)
      associate (bound => problem%bound(normal))
         call solve_box_program(box, problem%compliance, [m + 1, 2*m], b2 - coupled, -bound, bound, accuracy, &
            tangential, effort)
      end associate
   end subroutine tangential_step

   !> Normal half step, (2.3) for lambda_N alone: min 1/2 l.A11 l - l.(B1 - A12 lambda_T), l >= 0.
   !> The paper prints lambda_N := A11^-1 (B1 - A12 lambda_T) such that lambda_N >= 0 (erratum 7).
   pure subroutine normal_step(box, problem, b1, tangential, accuracy, normal, effort)
      character(*), intent(in) :: box !! the solver of box programs
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: b1(:) !! B1 (m) [L]
      real(dp), intent(in) :: tangential(:) !! lambda_T (m) [F]
      real(dp), intent(in) :: accuracy !! of the quadratic program [F]
      real(dp), intent(inout) :: normal(:) !! lambda_N (m) [F]
      type(effort_t), intent(inout) :: effort !! gains that of the quadratic program
      real(dp) :: coupled(problem%n_points)
      integer :: m

      m = problem%n_points
      call problem%compliance%part_multiply([1, m], [m + 1, 2*m], tangential, coupled)
      call solve_box_program(box, problem%compliance, [1, m], b1 - coupled, spread(0.0_dp, 1, m), &
         spread(huge(1.0_dp), 1, m), accuracy, normal, effort)
   end subroutine normal_step

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
      call problem%compliance%part_multiply([1, m], [m + 1, 2*m], tangential, normal)
      normal = b1 - normal
      call cholesky_solve(a11_factor, normal)
      normal = max(0.0_dp, normal)
   end subroutine clipped_normal_step

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

   !> The Cholesky factor of A11 (m, m).
   pure function factor_of_a11(problem) result(factor)
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), allocatable :: factor(:, :)
      logical :: is_soft
      integer :: m

      m = problem%n_points
      factor = part(problem, [1, m], [1, m])
      associate (rho => problem%compliance%reciprocal_diagonal())
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

      part = problem%compliance%block([(i, i=rows(1), rows(2))], [(i, i=columns(1), columns(2))])
   end function part

end module amontons_splitting
