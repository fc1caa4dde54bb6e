!> Newton's linear system in the forces, on a compliance A: what a dense and a sparse one have in common.
!>
!> A normal force of a closed point and a tangential one of a sticking point are unknown: a row of `A lambda = B` each,
!> of no distance and of no slip, holds them. The others follow from the law.
module amontons_force_system
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_active_set, only: active_set_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_kinds, only: dp
   use amontons_newton_system, only: newton_system_t
   implicit none (type, external)
   private

   public :: force_system_t

   !> The active set that is factorized, and its unknowns; an extension holds the factors.
   type, abstract, extends(newton_system_t) :: force_system_t
      type(active_set_t) :: base !! The active set that is factorized.
      real(dp) :: regularization = -1.0_dp !! Regularization of the factorization; -1 if there is none [-].
      integer, allocatable :: unknown(:) !! The forces that are unknown in it.
      real(dp), allocatable :: diagonal(:) !! Diagonal of A, where it is zero the largest of all (2m) [L/F].
   contains
      procedure :: begin => force_system_begin
      procedure(prepare_interface), deferred :: prepare
      procedure :: solve => force_system_solve
      procedure(solve_forces_interface), deferred :: solve_forces
   end type force_system_t

   abstract interface
      !> Factorizes the system of an active set, unless the factorization that is there serves it.
      subroutine prepare_interface(self, problem, active_set, regularization, info)
         import :: active_set_t, contact_problem_t, dp, force_system_t
         implicit none (type, external)
         class(force_system_t), intent(inout) :: self !! the system
         type(contact_problem_t), intent(in) :: problem !! the problem
         type(active_set_t), intent(in) :: active_set !! state of each point
         real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A that is wanted [-]
         integer, intent(out) :: info !! 0, or nonzero where the system is singular
      end subroutine prepare_interface

      !> Solves the prepared system of an active set.
      subroutine solve_forces_interface(self, problem, active_set, load, center, force, info)
         import :: active_set_t, contact_problem_t, dp, force_system_t
         implicit none (type, external)
         class(force_system_t), intent(inout) :: self !! the system
         type(contact_problem_t), intent(in) :: problem !! the problem
         type(active_set_t), intent(in) :: active_set !! state of each point
         real(dp), intent(in) :: load(:) !! dual load B (2m) [L]
         real(dp), intent(in) :: center(:) !! lambda before the step (2m) [F]
         real(dp), intent(out) :: force(:) !! lambda after it (2m) [F]
         integer, intent(out) :: info !! 0, or nonzero where the system is singular
      end subroutine solve_forces_interface
   end interface

contains

   !> Solves for the forces, then takes the displacements from them.
   subroutine force_system_solve(self, problem, active_set, regularization, displacement, force, imbalance, info)
      class(force_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      real(dp), intent(out) :: imbalance !! 0: the displacements are those of the forces [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp) :: load(size(force)), solution(size(force))

      imbalance = 0.0_dp
      call self%prepare(problem, active_set, regularization, info)
      if (info /= 0) return
      load = problem%dual_load(displacement)
      call self%solve_forces(problem, active_set, load, force, solution, info)
      if (.not. all(ieee_is_finite(solution))) info = 1
      if (info /= 0) return
      force = solution
      displacement = problem%displacement(load, force)
      call self%effort%multiply(1.0_dp)
   end subroutine force_system_solve

   !> Takes up an active set that is to be factorized.
   subroutine force_system_begin(self, problem, active_set, regularization)
      class(force_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A [-]
      integer :: i

      if (.not. allocated(self%diagonal)) self%diagonal = 1.0_dp/problem%augmentation()
      self%base = active_set
      self%regularization = regularization
      self%unknown = pack([(i, i=1, 2*problem%n_points)], [active_set%is_closed, active_set%slip_direction == 0])
   end subroutine force_system_begin

end module amontons_force_system
