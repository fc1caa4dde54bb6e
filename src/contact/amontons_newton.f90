!> Semismooth Newton on the condensed stiffness S, in the form of an active-set method (Alart and Curnier, CMAME 92,
!> 1991): guess the state of every point, solve the linear system that the guess gives, read the next guess off its
!> solution, repeat. It ends, exactly, as soon as a guess repeats itself.
module amontons_newton
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_dense, only: lu_solve, symmetric_multiply
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: newton_t

   !> The semismooth Newton method.
   type, extends(contact_method_t) :: newton_t
   contains
      procedure :: solve => newton_solve
   end type newton_t

   !> What is guessed of every point.
   type :: guess_t
      logical, allocatable :: is_closed(:) !! whether it touches (m)
      integer, allocatable :: sense(:) !! sign of its slip, 0 if it sticks (m)
   end type guess_t

contains

   !> Takes Newton steps; a step that leads to worse is shortened. From rest the first guess is that all points stick.
   subroutine newton_solve(self, problem, solution, error)
      class(newton_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(inout) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! never allocated; kept for the common interface
      real(dp) :: displacement(2*problem%n_points), force(2*problem%n_points)
      type(guess_t) :: guess
      integer :: iteration, info
      logical :: may_continue

      call solution%begin()
      displacement = solution%displacement
      guess = guess_of(problem, displacement, solution%force)
      if (.not. any(solution%force(:problem%n_points) > 0.0_dp)) then
         guess%is_closed = .true.
         guess%sense = merge(0, 1, problem%friction + problem%slip_bound > 0.0_dp)
      end if
      do iteration = 1, self%max_iterations
         call newton_step(problem, guess, displacement, force, info)
         if (info /= 0) return
         if (iteration > 1) call shorten_step(problem, solution, displacement, force)
         call solution%record(problem, displacement, force, self%tolerance, may_continue)
         if (.not. may_continue) return
         guess = guess_of(problem, displacement, force)
      end do
   end subroutine newton_solve

   !> The guess that a pair (v, lambda) leads to: which side of the law its augmented forces lie on. A point without
   !> any slip bound has nothing to stick by.
   pure function guess_of(problem, displacement, force) result(guess)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: displacement(:) !! v (2m) [L]
      real(dp), intent(in) :: force(:) !! lambda (2m) [F]
      type(guess_t) :: guess
      real(dp) :: normal, tangential, bound
      integer :: p, t

      allocate (guess%is_closed(problem%n_points), guess%sense(problem%n_points))
      do p = 1, problem%n_points
         t = p + problem%n_points
         normal = force(p) + problem%stiffness(p, p)*(displacement(p) - problem%gap(p))
         tangential = force(t) + problem%stiffness(t, t)*displacement(t)
         bound = problem%slip_bound(p) + problem%friction(p)*max(0.0_dp, normal)
         guess%is_closed(p) = normal > 0.0_dp
         guess%sense(p) = 0
         if (abs(tangential) > bound .or. .not. bound > 0.0_dp) guess%sense(p) = nint(sign(1.0_dp, tangential))
      end do
   end function guess_of

   !> The displacements and forces that a guess leads to.
   !>
   !> Closed: u_N = d. Open: lambda_N = 0. Stick: u_T = 0. Slip along s = +1 or -1: lambda_T = s (g + phi lambda_N). The
   !> rows of `S v = q - lambda` that hold an unknown displacement, with lambda_N of a closed sliding point eliminated
   !> by its own row, are the system.
   subroutine newton_step(problem, guess, displacement, force, info)
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(guess_t), intent(in) :: guess !! state of each point
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(out) :: force(:) !! lambda after the step (2m) [F]
      integer, intent(out) :: info !! 0, or nonzero where the guess leaves the system singular
      real(dp) :: factor(problem%n_points), load(2*problem%n_points), v(2*problem%n_points)
      real(dp), allocatable :: matrix(:, :), right(:)
      integer, allocatable :: unknown(:)
      integer :: i, j, m, point

      m = problem%n_points
      factor = merge(problem%friction*guess%sense, 0.0_dp, guess%is_closed)
      v = 0.0_dp
      v(:m) = merge(problem%gap, 0.0_dp, guess%is_closed)
      call symmetric_multiply(problem%stiffness, v, load)
      load = problem%load - load
      load(m + 1:) = load(m + 1:) - guess%sense*problem%slip_bound
      unknown = pack([(i, i=1, 2*m)], [.not. guess%is_closed, guess%sense /= 0])
      allocate (matrix(size(unknown), size(unknown)), right(size(unknown)))
      do j = 1, size(unknown)
         do i = 1, size(unknown)
            matrix(i, j) = problem%stiffness(unknown(i), unknown(j))
         end do
      end do
      right = load(unknown)
      do i = 1, size(unknown)
         point = unknown(i) - m
         if (point < 1) cycle
         if (.not. abs(factor(point)) > 0.0_dp) cycle
         matrix(i, :) = matrix(i, :) - factor(point)*problem%stiffness(unknown, point)
         right(i) = right(i) - factor(point)*load(point)
      end do
      call hold_softly(problem, unknown, displacement, matrix, right)
      call lu_solve(matrix, right, info)
      if (info /= 0) return
      v(unknown) = right
      displacement = v
      call recover_forces(problem, guess, displacement, force)
   end subroutine newton_step

   !> For a body that only contact holds, adds a tiny multiple of the step to the equations (a proximal step), so that
   !> statuses which leave a rigid motion free still give one solution. It vanishes as the steps do.
   pure subroutine hold_softly(problem, unknown, displacement, matrix, right)
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: unknown(:) !! the unknown displacements
      real(dp), intent(in) :: displacement(:) !! v before the step (2m) [L]
      real(dp), intent(inout) :: matrix(:, :) !! the system
      real(dp), intent(inout) :: right(:) !! its right-hand side
      real(dp), parameter :: tiny_share = 1.0e-9_dp
      real(dp) :: alpha
      integer :: i

      if (problem%is_held) return
      do i = 1, size(unknown)
         alpha = tiny_share*problem%stiffness(unknown(i), unknown(i))
         matrix(i, i) = matrix(i, i) + alpha
         right(i) = right(i) + alpha*displacement(unknown(i))
      end do
   end subroutine hold_softly

   !> The forces q - S v, with what the guess says of them put in exactly.
   pure subroutine recover_forces(problem, guess, displacement, force)
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(guess_t), intent(in) :: guess !! state of each point
      real(dp), intent(in) :: displacement(:) !! v (2m) [L]
      real(dp), intent(out) :: force(:) !! lambda (2m) [F]
      integer :: m

      m = problem%n_points
      call symmetric_multiply(problem%stiffness, displacement, force)
      force = problem%load - force
      where (.not. guess%is_closed) force(:m) = 0.0_dp
      where (guess%sense /= 0) force(m + 1:) = guess%sense*(problem%slip_bound + problem%friction*force(:m))
   end subroutine recover_forces

   !> Shortens a step from the last recorded pair, on the line between the two, to the length with the least residual;
   !> a full step that improves is kept.
   pure subroutine shorten_step(problem, solution, displacement, force)
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(in) :: solution !! the pair before the step
      real(dp), intent(inout) :: displacement(:) !! v after the full step, shortened on return (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda after the full step, shortened on return (2m) [F]
      integer, parameter :: n_halvings = 5
      real(dp) :: length, least, residual, best
      integer :: i

      least = problem%residual(displacement, force)
      if (least < solution%residual) return
      best = 1.0_dp
      length = 1.0_dp
      do i = 1, n_halvings
         length = 0.5_dp*length
         residual = problem%residual(between(solution%displacement, displacement), between(solution%force, force))
         if (.not. residual < least) cycle
         least = residual
         best = length
      end do
      length = best
      displacement = between(solution%displacement, displacement)
      force = between(solution%force, force)

   contains

      !> The vector at the present length between two others.
      pure function between(from, to) result(vector)
         real(dp), intent(in) :: from(:) !! where length is 0
         real(dp), intent(in) :: to(:) !! where length is 1
         real(dp) :: vector(size(from))

         vector = from + length*(to - from)
      end function between

   end subroutine shorten_step

end module amontons_newton
