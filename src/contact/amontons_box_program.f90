!> Strictly convex quadratic programs on a box, solved exactly: min 1/2 x^T A x - b^T x, lower <= x <= upper.
!>
!> Projected Newton (Bertsekas, SIAM J. Control Optim. 20, 1982): the components that their bound holds stay, the
!> others take a Newton step, cut to the box and shortened until the objective falls. Once the bounds in force are
!> found, one step is exact.
module amontons_box_program
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: solve_box_program

   !> More steps than any program seen needs; a degenerate one, whose bounds flicker by rounding, stops here.
   integer, parameter :: max_steps = 200

contains

   !> Solves a box program from a starting point.
   pure subroutine solve_box_program(a, b, lower, upper, x)
      real(dp), intent(in) :: a(:, :) !! the matrix, symmetric positive definite (n, n)
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds, at least the lower ones (n)
      real(dp), intent(inout) :: x(:) !! where to start, and the minimiser (n)
      real(dp) :: gradient(size(b)), step(size(b)), full(size(b))
      logical :: is_free(size(b)), was_free(size(b)), is_newton, is_exact
      integer :: i

      x = min(max(x, lower), upper)
      is_exact = .false.
      was_free = .false.
      do i = 1, max_steps
         gradient = matmul(a, x) - b
         is_free = may_move(x, gradient, lower, upper)
         if (is_exact .and. all(is_free .eqv. was_free)) return
         call newton_step(a, gradient, is_free, step, is_newton)
         full = min(max(x + step, lower), upper)
         ! A Newton step that met no bound is exact on its face: if the face stays, this is the minimiser.
         is_exact = is_newton .and. all(.not. is_free .or. (full > lower .and. full < upper))
         was_free = is_free
         if (is_exact) then
            x = full
         else
            call search_line(a, b, lower, upper, gradient, step, x)
         end if
      end do
   end subroutine solve_box_program

   !> Whether a component is off its bounds, or leaves its bound on the way down.
   elemental logical function may_move(x, gradient, lower, upper)
      real(dp), intent(in) :: x !! the component
      real(dp), intent(in) :: gradient !! derivative of the objective
      real(dp), intent(in) :: lower !! lower bound
      real(dp), intent(in) :: upper !! upper bound

      may_move = (x > lower .or. gradient < 0.0_dp) .and. (x < upper .or. gradient > 0.0_dp)
   end function may_move

   !> The Newton step of the free components: A_ff step_f = -gradient_f; the others stay.
   pure subroutine newton_step(a, gradient, is_free, step, is_newton)
      real(dp), intent(in) :: a(:, :) !! the matrix (n, n)
      real(dp), intent(in) :: gradient(:) !! gradient of the objective (n)
      logical, intent(in) :: is_free(:) !! which components may move (n)
      real(dp), intent(out) :: step(:) !! the step (n)
      logical, intent(out) :: is_newton !! false for a step that merely leads down
      real(dp), allocatable :: block(:, :), right(:)
      integer, allocatable :: free(:)
      integer :: i, info

      step = 0.0_dp
      free = pack([(i, i=1, size(is_free))], is_free)
      block = a(free, free)
      right = -gradient(free)
      call cholesky_factor(block, info)
      is_newton = info == 0
      if (is_newton) then
         call cholesky_solve(block, right)
         step(free) = right
      else
         ! Not positive definite to rounding: the steepest descent, scaled by the diagonal, still leads down.
         step(free) = -gradient(free)/[(a(free(i), free(i)), i=1, size(free))]
      end if
   end subroutine newton_step

   !> Moves along the step, cut to the box, by the first of 1, 1/2, 1/4, ... that lowers the objective enough.
   pure subroutine search_line(a, b, lower, upper, gradient, step, x)
      real(dp), intent(in) :: a(:, :) !! the matrix (n, n)
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds (n)
      real(dp), intent(in) :: gradient(:) !! gradient at x (n)
      real(dp), intent(in) :: step(:) !! the full step (n)
      real(dp), intent(inout) :: x(:) !! the point (n)
      real(dp), parameter :: sufficient = 1.0e-4_dp
      real(dp) :: move(size(b)), length, change
      integer :: halving

      length = 1.0_dp
      do halving = 1, 30
         move = min(max(x + length*step, lower), upper) - x
         change = dot_product(gradient, move) + 0.5_dp*dot_product(move, matmul(a, move))
         if (change <= sufficient*dot_product(gradient, move)) exit
         length = 0.5_dp*length
      end do
      x = x + move
   end subroutine search_line

end module amontons_box_program
