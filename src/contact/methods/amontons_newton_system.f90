!> The abstract linear system of a Newton step: what an active set leads to.
module amontons_newton_system
   use amontons_active_set, only: active_set_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_effort, only: effort_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: newton_system_t

   !> A way to solve the linear equations of an active set. It may keep what serves the next active set as well.
   type, abstract :: newton_system_t
      type(effort_t) :: effort !! what the steps took so far
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

end module amontons_newton_system
