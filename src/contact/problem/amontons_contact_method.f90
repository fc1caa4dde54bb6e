!> The abstract contact method: what solves a contact problem.
module amontons_contact_method
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: contact_method_t

   !> A method with its stopping rule. A new method is one new extension of this type.
   type, abstract :: contact_method_t
      real(dp) :: tolerance = 1.0e-10_dp !! residual that counts as solved [-]
      integer :: max_iterations = 1000 !! most iterations, of the method's own kind
   contains
      procedure(solve_interface), deferred :: solve
   end type contact_method_t

   abstract interface
      !> Solves a contact problem from the forces and displacements in `solution`. Not converged is a result, told by
      !> `solution%is_converged`.
      subroutine solve_interface(self, problem, solution, error)
         import :: contact_method_t, contact_problem_t, contact_solution_t, error_t
         implicit none (type, external)
         class(contact_method_t), intent(in) :: self !! the method
         type(contact_problem_t), intent(inout) :: problem !! the problem; its dual matrix may be added to it
         type(contact_solution_t), intent(inout) :: solution !! where to start, and the result
         type(error_t), allocatable, intent(out) :: error !! the problem's data are unusable
      end subroutine solve_interface
   end interface

end module amontons_contact_method
