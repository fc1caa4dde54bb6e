!> The abstract linear system of a Newton step, what an active set leads to; and the one in the displacements, on the
!> condensed stiffness S.
module amontons_newton_system
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_active_set, only: active_set_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: effort_t
   use amontons_dense, only: allocate_matrix, lu_solve
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: newton_system_t, stiffness_system_t

   !> A way to solve the linear equations of an active set. It may keep what serves the next active set as well.
   type, abstract :: newton_system_t
      type(effort_t) :: effort !! what the steps took so far
      type(error_t), allocatable :: error !! memory ran out; no step was made then
      real(dp) :: first_regularization = 1.0_dp !! regularization, as part of the diagonal in the first step [-]
      real(dp) :: min_regularization = 0.0_dp !! least regularization in any step [-]
   contains
      procedure(solve_interface), deferred :: solve
   end type newton_system_t

   abstract interface
      !> Solves the equations of an active set, a proximal step: `regularization` times the diagonal, times the
      !> step, is added to them, so that an active set which leaves them singular still gives a step.
      subroutine solve_interface(self, problem, active_set, regularization, displacement, force, imbalance, info)
         import :: active_set_t, contact_problem_t, dp, newton_system_t
         implicit none (type, external)
         class(newton_system_t), intent(inout) :: self !! the system
         type(contact_problem_t), intent(in) :: problem !! the problem, the same in all steps
         type(active_set_t), intent(in) :: active_set !! state of each point
         real(dp), intent(in) :: regularization !! regularization, as part of the diagonal [-]
         real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
         real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
         real(dp), intent(out) :: imbalance !! largest violation of the equilibrium by the pair after the step [F]
         integer, intent(out) :: info !! 0, or nonzero where the system has no finite solution; no step is made then
      end subroutine solve_interface
   end interface

   !> The rows of `S v = q - lambda` that hold an unknown displacement, with lambda_N of a closed sliding point
   !> eliminated by its own row.
   type, extends(newton_system_t) :: stiffness_system_t
      private
      real(dp), allocatable :: diagonal(:) !! Diagonal of S (2m) [F/L].
   contains
      procedure, public :: solve => stiffness_system_solve
   end type stiffness_system_t

contains

   !> Solves for the displacements, then takes the forces from the equilibrium.
   subroutine stiffness_system_solve(self, problem, active_set, regularization, displacement, force, imbalance, info)
      class(stiffness_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a stiffness
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of S [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      real(dp), intent(out) :: imbalance !! largest violation of S v = q - lambda by the pair after the step [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), allocatable :: matrix(:, :), right(:)
      integer, allocatable :: unknown(:)
      real(dp) :: load(size(force)), slope(problem%n_points)
      integer :: m, n, i, point

      m = problem%n_points
      if (.not. allocated(self%diagonal)) self%diagonal = problem%augmentation()
      unknown = pack([(i, i=1, 2*m)], .not. active_set%gives_force())
      n = size(unknown)
      slope = merge(problem%friction*active_set%slip_direction, 0.0_dp, active_set%is_closed)
      call take_known_load(problem, active_set, load, self%effort)
      info = 1
      call allocate_matrix(matrix, n, n, "Newton's unknowns", self%error)
      if (allocated(self%error)) return
      allocate (right(n))
      call problem%matrix%stiffness%fill_block(unknown, unknown, matrix)
      do i = 1, n
         matrix(i, i) = matrix(i, i) + regularization*self%diagonal(unknown(i))
         right(i) = load(unknown(i)) + regularization*self%diagonal(unknown(i))*displacement(unknown(i))
      end do
      do i = 1, n
         point = unknown(i) - m
         if (point < 1) cycle
         if (.not. abs(slope(point)) > 0.0_dp) cycle
         matrix(i, :) = matrix(i, :) - slope(point)*problem%matrix%stiffness%values(unknown, point)
         right(i) = right(i) - slope(point)*load(point)
      end do
      call self%effort%factorize(n > 0)
      call lu_solve(matrix, right, info)
      if (.not. all(ieee_is_finite(right))) info = 1
      if (info /= 0) return
      displacement = problem%reference()
      displacement(unknown) = right
      call problem%matrix%multiply_stiffness(displacement, force)
      force = problem%load - force
      call active_set%impose(problem, force, imbalance)
      call self%effort%multiply(1.0_dp)
   end subroutine stiffness_system_solve

   !> The load less what the known displacements and the given slip bounds take of it.
   pure subroutine take_known_load(problem, active_set, load, effort)
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(out) :: load(:) !! what is left (2m) [F]
      type(effort_t), intent(inout) :: effort !! gains that of the product, if there is one
      real(dp) :: known(2*problem%n_points)
      integer :: m

      m = problem%n_points
      known = merge(problem%reference(), 0.0_dp, active_set%gives_force())
      load = 0.0_dp
      if (any(abs(known) > 0.0_dp)) then
         call problem%matrix%multiply_stiffness(known, load)
         call effort%multiply(1.0_dp)
      end if
      load = problem%load - load
      load(m + 1:) = load(m + 1:) - active_set%slip_direction*problem%slip_bound
   end subroutine take_known_load

end module amontons_newton_system
