!> Convex quadratic programs on a box: min 1/2 x^T A x - b^T x, lower <= x <= upper, for a part of the rows of a matrix:
!> the paper's (2.3), for all forces with a given slip bound or for the normal or tangential ones alone.
!>
!> `newton` is the projected Newton method, an active-set method (Bertsekas, SIAM J. Control Optim. 20, 1982): the
!> components that their bound holds stay, the others take a Newton step, cut to the box and shortened until the
!> objective falls. Once the bounds in force are found, one step is exact. `auto` takes it for a dense matrix, and
!> `mprgp` for a sparse one.
!>
!> `mprgp` is modified proportioning with reduced gradient projections (Dostal, Optimal Quadratic Programming
!> Algorithms, 2009, chapter 5), with nothing but products. Conjugate gradients run on the components off their bounds;
!> where a step would leave the box, it ends on the face it meets and a projected gradient step of fixed length follows;
!> where the gradient of the components held by their bounds outweighs that of the others, these are released. The
!> variables are scaled to a unit diagonal, so that no unit matters.
!>
!> In space the tangential forces of a point lie in a disc. Newton's steps are then those on the face that a step down
!> the own parabolas of the components leads to: the normal forces at their bound and the lengths of the tangential
!> forces on the edges of their discs stay, and the force of the edge, over its radius, adds to the curvature along it.
module amontons_box_program
   use amontons_contact_solution, only: effort_t
   use amontons_dense, only: allocate_matrix, cholesky_factor_regularized, cholesky_solve
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_friction_law, only: cut_to_bound
   use amontons_kinds, only: dp
   use amontons_symmetric_matrix, only: symmetric_matrix_t, turned_pairs
   implicit none (type, external)
   private

   public :: box_names, box_violation, solve_box_program, solve_disc_program

   !> Accuracy of the programs within the steps of a method, over the tolerance of the method [-].
   real(dp), parameter, public :: inner_accuracy = 1.0e-2_dp

   !> Names of the solvers, as a deck writes them.
   character(6), parameter :: box_names(3) = [character(6) :: 'auto', 'newton', 'mprgp']

   !> Largest number of steps; more than any program met in practice needs. It ends degenerate programs whose active
   !> bounds alternate by rounding.
   integer, parameter :: max_steps = 200

   !> A step is taken whose descent is this share of what its slope promises: the usual choice of the condition of
   !> Armijo [-].
   real(dp), parameter :: sufficient = 1.0e-4_dp

contains

   !> Solves a box program from a starting point.
   ! allow(S902): a program alone has six parts
   subroutine solve_box_program(kind, a, rows, b, lower, upper, accuracy, x, effort, error)
      character(*), intent(in) :: kind !! one of `box_names`
      type(symmetric_matrix_t), intent(in) :: a !! the matrix, positive semidefinite
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program, n in all
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds, at least the lower ones (n)
      real(dp), intent(in) :: accuracy !! largest move of a component that a step down its own parabola may still make
      real(dp), intent(inout) :: x(:) !! starting point; the minimizer on return (n)
      type(effort_t), intent(inout) :: effort !! gains that of the descent
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp) :: rho(size(b)), reachable
      logical :: is_pressed(size(b))

      if (size(b) == 0) return
      associate (all_rho => a%reciprocal_diagonal())
         rho = all_rho(rows(1):rows(2))
      end associate
      x = min(max(x, lower), upper)
      ! Rounding error of sums of such numbers, without those that hold a component at its bound, however large.
      is_pressed = (.not. x > lower .and. b < 0.0_dp) .or. (.not. x < upper .and. b > 0.0_dp)
      reachable = max(accuracy, 4.0_dp*epsilon(1.0_dp)*maxval(max(abs(x), merge(0.0_dp, abs(rho*b), is_pressed))))
      if (kind == 'mprgp' .or. (kind == 'auto' .and. a%is_sparse())) then
         call mprgp(a, rows, b, lower, upper, reachable, x, effort)
      else
         call projected_newton(a, rows, rho, b, lower, upper, reachable, x, effort, error)
      end if
   end subroutine solve_box_program

   !> Solves min 1/2 x^T A x - b^T x for changes x of forces that stay in their bounds, for the last rows of a matrix:
   !> of all forces, or of the tangential ones alone.
   ! allow(S902): a program alone has six parts
   pure subroutine solve_disc_program(kind, a, rows, b, force, radius, accuracy, x, effort, error)
      character(*), intent(in) :: kind !! one of `box_names`
      type(symmetric_matrix_t), intent(in) :: a !! the matrix, positive semidefinite, its last rows in pairs
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program, n in all
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: force(:) !! the forces that x is added to (n) [F]
      real(dp), intent(in) :: radius(:) !! longest tangential force of each point, at least 0 (m) [F]
      real(dp), intent(in) :: accuracy !! largest move of a component that a step down its own parabola may still make
      real(dp), intent(inout) :: x(:) !! starting point; the minimizer on return (n)
      type(effort_t), intent(inout) :: effort !! gains that of the descent
      type(error_t), allocatable, intent(out) :: error !! the solver is one for boxes, or memory ran out
      real(dp), parameter :: enough = 4.0_dp*epsilon(1.0_dp) ! no shorter move changes its numbers
      integer, parameter :: most_trials = 30
      type(symmetric_matrix_t) :: turned
      real(dp), dimension(size(b)) :: rho, gradient, goal, step, hold, move, image
      real(dp) :: axes(2, size(radius)), share, length, slope
      logical :: is_free(size(b)), is_regularized
      real(dp), allocatable :: block(:, :), right(:)
      integer, allocatable :: free(:)
      integer :: i, k, n_trials, first, second

      if (kind == 'mprgp') then
         call new_error(error, input_refused, "box = 'mprgp' is for the plane: it solves programs on intervals, "// &
            "not on discs; take 'newton'")
         return
      end if
      associate (m => size(radius), all_rho => a%reciprocal_diagonal())
         rho = all_rho(rows(1):rows(2))
         first = size(b) - 2*m
         second = size(b) - m
      end associate
      share = (real(size(b), dp)/a%n)**2
      x = projection(force + x) - force
      do i = 1, max_steps
         call a%part_multiply(rows, rows, x, gradient)
         call effort%multiply(share)
         gradient = gradient - b
         goal = force + x - rho*gradient
         is_free(:first) = goal(:first) > 0.0_dp
         is_free(first + 1:) = .true.
         move = projection(goal) - force - x
         length = max(accuracy, enough*maxval(abs([x, rho*b]), mask=[is_free, is_free]))
         if (maxval(abs(move)) <= length) return
         ! In axes along the edges of the discs: the known components of a step, and the added stiffness of the others.
         axes = spread([1.0_dp, 0.0_dp], 2, size(radius))
         step = 0.0_dp
         where (.not. is_free) step = -force - x
         hold = 0.0_dp
         do k = 1, size(radius)
            length = hypot(goal(first + k), goal(second + k))
            if (.not. length > radius(k)) cycle
            axes(:, k) = goal([first + k, second + k])/length
            is_free([first + k, second + k]) = [.false., radius(k) > 0.0_dp]
            if (radius(k) > 0.0_dp) hold(second + k) = (length/radius(k) - 1.0_dp)/rho(second + k)
         end do
         call a%turn(axes, turned)
         image = turned_pairs(force + x, axes, 1)
         do k = 1, size(radius)
            if (.not. is_free(first + k)) step(first + k) = radius(k) - image(first + k)
            if (.not. is_free(second + k)) step(second + k) = -image(second + k)
         end do
         right = turned_pairs(gradient, axes, 1) + hold*image
         call turned%part_multiply(rows, rows, step, image)
         free = pack([(k, k=1, size(b))], is_free)
         right = -right(free) - image(free)
         call allocate_matrix(block, size(free), size(free), 'the forces of a half step', error)
         if (allocated(error)) return
         call turned%fill_block(free + rows(1) - 1, free + rows(1) - 1, block)
         do k = 1, size(free)
            block(k, k) = block(k, k) + hold(free(k))
         end do
         call cholesky_factor_regularized(block, 1.0_dp/rho(free), is_regularized)
         call cholesky_solve(block, right)
         step(free) = right
         call effort%factorize(size(free) > 0)
         step = turned_pairs(step, axes, -1)
         ! If no part of the step decreases the objective, a short step down the own parabolas of the components does.
         length = 1.0_dp
         do n_trials = 1, 2*most_trials
            if (n_trials == most_trials) length = 1.0_dp
            if (n_trials < most_trials) move = projection(force + x + length*step) - force - x
            if (n_trials >= most_trials) move = projection(force + x - length*rho*gradient) - force - x
            call a%part_multiply(rows, rows, move, image)
            slope = dot_product(gradient, move)
            if (slope < 0.0_dp .and. slope + 0.5_dp*dot_product(move, image) <= sufficient*slope) exit
            length = 0.5_dp*length
         end do
         call effort%multiply(min(n_trials, 2*most_trials)*share)
         if (n_trials > 2*most_trials) return
         x = x + move
      end do

   contains

      !> The nearest forces within their bounds (n) [F].
      pure function projection(wanted)
         real(dp), intent(in) :: wanted(:) !! the forces wanted (n) [F]
         real(dp) :: projection(size(wanted))

         projection(:first) = max(0.0_dp, wanted(:first))
         projection(first + 1:) = cut_to_bound(wanted(first + 1:), radius)
      end function projection

   end subroutine solve_disc_program

   !> The projected Newton method, from a point in the box.
   ! allow(S902): a program alone has six parts
   pure subroutine projected_newton(a, rows, rho, b, lower, upper, accuracy, x, effort, error)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program
      real(dp), intent(in) :: rho(:) !! reciprocal diagonal of the matrix (n)
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds (n)
      real(dp), intent(in) :: accuracy !! the `box_violation` that is small enough for a point not known to be exact
      real(dp), intent(inout) :: x(:) !! the point, and the minimizer (n)
      type(effort_t), intent(inout) :: effort !! gains that of the descent
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp) :: gradient(size(b)), step(size(b)), full(size(b)), share, move(size(x)), image(size(x)), length, slope
      logical :: is_free(size(b)), was_free(size(b)), is_exact, is_regularized
      integer :: i, k, n_trials
      real(dp), allocatable :: block(:, :), right(:)
      integer, allocatable :: free(:)
      integer, parameter :: most_trials = 30

      share = (real(size(b), dp)/a%n)**2
      is_exact = .false.
      was_free = .false.
      do i = 1, max_steps
         call a%part_multiply(rows, rows, x, gradient)
         call effort%multiply(share)
         gradient = gradient - b
         ! Off its bounds, or on its way down from one.
         is_free = (x > lower .or. gradient < 0.0_dp) .and. (x < upper .or. gradient > 0.0_dp)
         if (is_exact) then
            if (all(is_free .eqv. was_free)) return
         else
            if (box_violation(x, rho*gradient, lower, upper, spread(1.0_dp, 1, size(b))) <= accuracy) return
         end if
         ! A_ff step_f = -gradient_f of the free components; the others stay. A singular A_ff is held softly.
         step = 0.0_dp
         free = pack([(k, k=1, size(b))], is_free)
         call allocate_matrix(block, size(free), size(free), 'the forces of a half step', error)
         if (allocated(error)) return
         call a%fill_block(free + rows(1) - 1, free + rows(1) - 1, block)
         right = -gradient(free)
         call cholesky_factor_regularized(block, 1.0_dp/rho(free), is_regularized)
         call cholesky_solve(block, right)
         step(free) = right
         call effort%factorize(any(is_free))
         full = min(max(x + step, lower), upper)
         ! A Newton step that met no bound is exact on its face: if the face stays, this is the minimizer.
         is_exact = .not. is_regularized .and. all(full > lower .and. full < upper .or. .not. is_free)
         was_free = is_free
         if (is_exact) then
            x = full
         else
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
            call effort%multiply(n_trials*share)
         end if
      end do
   end subroutine projected_newton

   !> Minimizes 1/2 x^T A x - b^T x on lower <= x <= upper from a starting point, for a part of the rows of A. If the
   !> program has no minimum (A singular and the box open there), the descent ends where that is found.
   subroutine mprgp(a, rows, b, lower, upper, accuracy, x, effort)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix, positive semidefinite
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program, n in all
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds, at least the lower ones (n)
      real(dp), intent(in) :: accuracy !! the `box_violation` that is small enough
      real(dp), intent(inout) :: x(:) !! starting point; the minimizer on return (n)
      type(effort_t), intent(inout) :: effort !! gains that of the descent
      ! All scaled to a unit diagonal: what has its unit back by the scale, bounds, the point with the gradient there,
      ! and the conjugate direction, to be taken backwards.
      real(dp), allocatable, dimension(:) :: scale, low, high, y, gradient, direction
      real(dp), dimension(size(b)) :: free, chopped, reduced
      ! The largest curvature seen, per length squared.
      real(dp) :: norm
      logical :: is_bounded
      integer :: step, n_products

      associate (rho => a%reciprocal_diagonal())
         scale = sqrt(rho(rows(1):rows(2)))
      end associate
      ! An infinite bound must not overflow.
      low = max(lower, -huge(1.0_dp)*min(1.0_dp, scale))/scale
      high = min(upper, huge(1.0_dp)*min(1.0_dp, scale))/scale
      y = min(max(x/scale, low), high)
      norm = 1.0_dp
      n_products = 0
      allocate (gradient(size(b)))
      call refresh_gradient()
      direction = free_part()
      do step = 1, 1000 + 10*size(b)
         if (box_violation(y, gradient, low, high, scale) <= accuracy) then
            ! The gradient was updated from step to step: only a recomputed one ends the iteration.
            call refresh_gradient()
            if (box_violation(y, gradient, low, high, scale) <= accuracy) exit
            direction = free_part()
         end if
         free = free_part()
         ! The gradient of the components that would leave their bound inwards.
         chopped = 0.0_dp
         where (y <= low .and. y < high) chopped = min(0.0_dp, gradient)
         where (y >= high .and. y > low) chopped = max(0.0_dp, gradient)
         ! The free gradient, as far as a step of length 1/norm against it stays in the box.
         reduced = free
         where (free > 0.0_dp) reduced = min(free, norm*min(y - low, huge(1.0_dp)/norm))
         where (free < 0.0_dp) reduced = max(free, norm*max(y - high, -huge(1.0_dp)/norm))
         if (dot_product(chopped, chopped) <= dot_product(reduced, free)) then
            call take_step()
         else
            direction = chopped
            call take_step()
            direction = free_part()
         end if
         if (.not. is_bounded) exit
      end do
      call effort%multiply(n_products*(real(size(b), dp)/a%n)**2)
      x = min(max(scale*y, lower), upper)

   contains

      !> Steps along the direction to the least objective, and makes the next direction conjugate; or to the end of the
      !> box, and expands the face met there. A point from which the objective falls without end stays.
      subroutine take_step()
         real(dp), dimension(size(b)) :: image, old, old_gradient, move
         real(dp) :: curvature, length, room, used

         call multiply(direction, image)
         curvature = dot_product(direction, image)
         norm = max(norm, norm2(image)/max(norm2(direction), tiny(1.0_dp)))
         length = huge(length)
         ! A curvature as small as rounding errors counts as 0.
         if (curvature > 10.0_dp*epsilon(1.0_dp)*norm*dot_product(direction, direction)) then
            length = dot_product(gradient, direction)/curvature
         end if
         room = least_room(y, low, high, direction)
         is_bounded = min(length, room) < huge(length)
         if (.not. is_bounded) return
         y = min(max(y - min(length, room)*direction, low), high)
         gradient = gradient - min(length, room)*image
         free = free_part()
         if (length <= room) then
            direction = free - dot_product(free, image)/curvature*direction
            return
         end if
         ! A projected gradient step on the face, as long as the largest curvature seen allows; taken anew where a move
         ! meets one of more than twice that.
         old = y
         old_gradient = gradient
         do
            used = norm
            y = min(max(old - free/used, low), high)
            call refresh_gradient()
            move = y - old
            norm = max(norm, dot_product(move, gradient - old_gradient)/max(dot_product(move, move), tiny(1.0_dp)))
            if (.not. norm > 2.0_dp*used) exit
         end do
         direction = free_part()
      end subroutine take_step

      !> Computes the product of the matrix, scaled to a unit diagonal, with a vector.
      subroutine multiply(vector, product)
         real(dp), intent(in) :: vector(:) !! the vector (n)
         real(dp), intent(out) :: product(:) !! the product (n)

         call a%part_multiply(rows, rows, scale*vector, product)
         product = scale*product
         n_products = n_products + 1
      end subroutine multiply

      !> Recomputes the gradient at the current point.
      subroutine refresh_gradient()
         call multiply(y, gradient)
         gradient = gradient - scale*b
      end subroutine refresh_gradient

      !> The components of the gradient that are off their bounds (n).
      function free_part()
         real(dp) :: free_part(size(b))

         free_part = merge(gradient, 0.0_dp, y > low .and. y < high)
      end function free_part

   end subroutine mprgp

   !> The largest step against a direction that stays in the box; huge if no bound limits it.
   pure real(dp) function least_room(y, low, high, direction) result(room)
      real(dp), intent(in) :: y(:) !! the point (n)
      real(dp), intent(in) :: low(:) !! lower bounds (n)
      real(dp), intent(in) :: high(:) !! upper bounds (n)
      real(dp), intent(in) :: direction(:) !! the direction (n)
      ! Larger bounds count as infinite.
      real(dp), parameter :: far = sqrt(huge(1.0_dp))
      integer :: i

      room = huge(room)
      do i = 1, size(y)
         if (direction(i) > 0.0_dp .and. low(i) > -far) room = min(room, (y(i) - low(i))/direction(i))
         if (direction(i) < 0.0_dp .and. high(i) < far) room = min(room, (y(i) - high(i))/direction(i))
      end do
   end function least_room

   !> The distance of a point from the minimizer: the largest projected step of a component to the minimum of its own
   !> parabola.
   pure real(dp) function box_violation(y, gradient, low, high, scale) result(violation)
      real(dp), intent(in) :: y(:) !! the point, scaled to a unit diagonal (n)
      real(dp), intent(in) :: gradient(:) !! the gradient there (n)
      real(dp), intent(in) :: low(:) !! lower bounds (n)
      real(dp), intent(in) :: high(:) !! upper bounds (n)
      real(dp), intent(in) :: scale(:) !! factors from scaled components to components (n)

      violation = 0.0_dp
      if (size(y) > 0) violation = maxval(scale*abs(y - min(max(y - gradient, low), high)))
   end function box_violation

end module amontons_box_program
