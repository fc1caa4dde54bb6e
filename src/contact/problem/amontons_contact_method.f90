!> The abstract contact method, which solves a contact problem, and the options of all methods.
module amontons_contact_method
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: contact_method_t, method_options_t

   !> The choice of a method and its options; those that a method does not use are without effect on it. All of them
   !> are of fixed size, so that they can be passed on as they are.
   type :: method_options_t
      real(dp) :: tolerance = 1.0e-10_dp !! residual that counts as solved [-]
      integer :: max_iterations = 1000 !! most iterations, of the method's own kind
      character(24) :: method = 'auto' !! one of `method_names`
      character(24) :: variant = 'exact' !! of splitting: one of its `variant_names`
      character(24) :: space = 'dual' !! of psor: one of its `space_names`
      character(24) :: box = 'auto' !! of splitting and fixed_point: one of `box_names`
      character(24) :: local = 'point' !! of psor: one of `local_names`
      character(24) :: acceleration = 'none' !! of psor: one of `acceleration_names`
      real(dp) :: omega = 1.0_dp !! of psor: relaxation, above 0 and below 2 [-]
   end type method_options_t

   !> A method with its options. A new method is one new extension of this type.
   type, abstract, extends(method_options_t) :: contact_method_t
   contains
      procedure :: prepare => contact_method_prepare
      procedure(solve_interface), deferred :: solve
   end type contact_method_t

   abstract interface
      !> Solves a contact problem from the forces and displacements in `solution`. Not converged is a result, told by
      !> `solution%is_converged`.
      subroutine solve_interface(self, problem, solution, error)
         import :: contact_method_t, contact_problem_t, contact_solution_t, error_t
         implicit none (type, external)
         class(contact_method_t), intent(in) :: self !! the method
         type(contact_problem_t), intent(in) :: problem !! the problem; its operator may gain dense matrices
         type(contact_solution_t), intent(inout) :: solution !! where to start, and the result
         type(error_t), allocatable, intent(out) :: error !! the problem's data are unusable, or memory ran out
      end subroutine solve_interface
   end interface

contains

   !> Makes the dense matrices that every solution by this method takes, for all problems on an operator: none here.
   subroutine contact_method_prepare(self, problem, error)
      class(contact_method_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! a problem on the operator
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite, or memory ran out

      associate (unused => self, unused_problem => problem)
      end associate
   end subroutine contact_method_prepare

end module amontons_contact_method
