!> Convex quadratic programs on a box: min 1/2 x^T A x - b^T x, lower <= x <= upper, for a part of the rows of a matrix:
!> the paper's (2.3), for all forces with a given slip bound or for the normal or tangential ones alone.
!>
!> `newton` is the projected Newton method, an active-set method (Bertsekas, SIAM J. Control Optim. 20, 1982): the
!> components that their bound holds stay, the others take a Newton step, cut to the box and shortened until the
!> objective falls. Once the bounds in force are found, one step is exact. `mprgp` needs products only. `auto` takes
!> the first for a dense matrix and the second for a sparse one.
module amontons_box_program
   use amontons_dense, only: cholesky_factor_softly, cholesky_solve
   use amontons_effort, only: effort_t
   use amontons_kinds, only: dp
   use amontons_mprgp, only: box_violation, mprgp
   use amontons_symmetric_matrix, only: symmetric_matrix_t
   implicit none (type, external)
   private

   public :: box_names, solve_box_program

   !> The solvers, as a deck writes them.
   character(6), parameter :: box_names(3) = [character(6) :: 'auto', 'newton', 'mprgp']

   !> More steps than any program seen needs; a degenerate one, whose bounds flicker by rounding, stops here.
   integer, parameter :: max_steps = 200

contains

   !> Solves a box program from a starting point.
   ! allow(S902): a program alone has six parts
   pure subroutine solve_box_program(kind, a, rows, b, lower, upper, accuracy, x, effort)
      character(*), intent(in) :: kind !! one of `box_names`
      type(symmetric_matrix_t), intent(in) :: a !! the matrix, positive semidefinite
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program, n in all
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds, at least the lower ones (n)
      real(dp), intent(in) :: accuracy !! largest move of a component that a step down its own parabola may still make
      real(dp), intent(inout) :: x(:) !! where to start, and the minimizer (n)
      type(effort_t), intent(inout) :: effort !! gains that of the way
      real(dp) :: rho(size(b)), reachable

      if (size(b) == 0) return
      associate (all_rho => a%reciprocal_diagonal())
         rho = all_rho(rows(1):rows(2))
      end associate
      x = min(max(x, lower), upper)
      ! What rounding leaves of sums of such numbers.
      reachable = max(accuracy, 4.0_dp*epsilon(1.0_dp)*maxval(max(abs(x), abs(rho*b))))
      if (kind == 'mprgp' .or. (kind == 'auto' .and. a%is_sparse())) then
         call mprgp(a, rows, b, lower, upper, reachable, x, effort)
      else
         call projected_newton(a, rows, rho, b, lower, upper, reachable, x, effort)
      end if
   end subroutine solve_box_program

   !> The projected Newton method, from a point in the box.
   ! allow(S902): a program alone has six parts
   pure subroutine projected_newton(a, rows, rho, b, lower, upper, accuracy, x, effort)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program
      real(dp), intent(in) :: rho(:) !! reciprocal diagonal of the matrix (n)
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds (n)
      real(dp), intent(in) :: accuracy !! the `box_violation` that is small enough for a point not known to be exact
      real(dp), intent(inout) :: x(:) !! the point, and the minimizer (n)
      type(effort_t), intent(inout) :: effort !! gains that of the way
      real(dp) :: gradient(size(b)), step(size(b)), full(size(b)), share
      logical :: is_free(size(b)), was_free(size(b)), is_newton, is_exact
      integer :: i, n_trials

      share = (real(size(b), dp)/a%n)**2
      is_exact = .false.
      was_free = .false.
      do i = 1, max_steps
         call a%part_multiply(rows, rows, x, gradient)
         call effort%multiply(share)
         gradient = gradient - b
         is_free = may_move(x, gradient, lower, upper)
         if (is_exact) then
            if (all(is_free .eqv. was_free)) return
         else
            if (box_violation(x, rho*gradient, lower, upper, spread(1.0_dp, 1, size(b))) <= accuracy) return
         end if
         call newton_step(a, rows, rho, gradient, is_free, step, is_newton)
         call effort%factorize(any(is_free))
         full = min(max(x + step, lower), upper)
         ! A Newton step that met no bound is exact on its face: if the face stays, this is the minimizer.
         is_exact = is_newton .and. all(is_inside(full, lower, upper) .or. .not. is_free)
         was_free = is_free
         if (is_exact) then
            x = full
         else
            call search_line(a, rows, lower, upper, gradient, step, x, n_trials)
            call effort%multiply(n_trials*share)
         end if
      end do
   end subroutine projected_newton

   !> Whether a component is off its bounds.
   elemental logical function is_inside(x, lower, upper)
      real(dp), intent(in) :: x !! the component
      real(dp), intent(in) :: lower !! lower bound
      real(dp), intent(in) :: upper !! upper bound

      is_inside = x > lower .and. x < upper
   end function is_inside

   !> Whether a component is off its bounds, or leaves its bound on the way down.
   elemental logical function may_move(x, gradient, lower, upper)
      real(dp), intent(in) :: x !! the component
      real(dp), intent(in) :: gradient !! derivative of the objective
      real(dp), intent(in) :: lower !! lower bound
      real(dp), intent(in) :: upper !! upper bound

      may_move = (x > lower .or. gradient < 0.0_dp) .and. (x < upper .or. gradient > 0.0_dp)
   end function may_move

   !> The Newton step of the free components: A_ff step_f = -gradient_f; the others stay. A singular A_ff is held
   !> softly.
   pure subroutine newton_step(a, rows, rho, gradient, is_free, step, is_newton)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program
      real(dp), intent(in) :: rho(:) !! reciprocal diagonal of the matrix (n)
      real(dp), intent(in) :: gradient(:) !! gradient of the objective (n)
      logical, intent(in) :: is_free(:) !! which components may move (n)
      real(dp), intent(out) :: step(:) !! the step (n)
      logical, intent(out) :: is_newton !! false for a step that merely leads down
      real(dp), allocatable :: block(:, :), right(:)
      integer, allocatable :: free(:)
      logical :: is_soft
      integer :: i

      step = 0.0_dp
      free = pack([(i, i=1, size(is_free))], is_free)
      block = a%block(free + rows(1) - 1, free + rows(1) - 1)
      right = -gradient(free)
      call cholesky_factor_softly(block, 1.0_dp/rho(free), is_soft)
      call cholesky_solve(block, right)
      step(free) = right
      is_newton = .not. is_soft
   end subroutine newton_step

   !> Moves along the step, cut to the box, by the first of 1, 1/2, 1/4, ... that lowers the objective enough; stays
   !> where none does.
   pure subroutine search_line(a, rows, lower, upper, gradient, step, x, n_trials)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds (n)
      real(dp), intent(in) :: gradient(:) !! gradient at x (n)
      real(dp), intent(in) :: step(:) !! the full step (n)
      real(dp), intent(inout) :: x(:) !! the point (n)
      integer, intent(out) :: n_trials !! number of lengths tried, a product each
      real(dp), parameter :: sufficient = 1.0e-4_dp
      integer, parameter :: most_trials = 30
      real(dp) :: move(size(x)), image(size(x)), length, slope

      length = 1.0_dp
      do n_trials = 1, most_trials
         move = min(max(x + length*step, lower), upper) - x
         call a%part_multiply(rows, rows, move, image)
         slope = dot_product(gradient, move)
         if (slope + 0.5_dp*dot_product(move, image) <= sufficient*slope) exit
         length = 0.5_dp*length
      end do
      n_trials = min(n_trials, most_trials)
      x = min(max(x + move, lower), upper)
   end subroutine search_line

end module amontons_box_program
