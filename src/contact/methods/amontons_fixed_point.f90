!> Fixed point on the slip bound: a Tresca problem with the bound b, solved exactly; then b := g + phi lambda_N; repeat.
!>
!> The Tresca problem is (P1) of the paper, in its dual form (2.3) with |lambda_T| <= b (not |lambda_1|: erratum 5).
!> Coulomb's solution is a fixed point of the map from the bound phi lambda_N to the normal forces of that problem: the
!> paper's remark 2 on section 1, with the friction that it leaves out (erratum 3; theory, section 5).
module amontons_fixed_point
   use amontons_box_program, only: inner_accuracy, solve_box_program, solve_disc_program
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, dual_method_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: fixed_point_t

   !> The fixed-point method.
   type, extends(dual_method_t) :: fixed_point_t
   contains
      procedure :: solve => fixed_point_solve
   end type fixed_point_t

contains

   !> Solves Tresca problems until the residual of the Coulomb problem is small.
   subroutine fixed_point_solve(self, problem, solution, error)
      class(fixed_point_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite
      real(dp), allocatable :: force(:), bound(:), b(:), lower(:), upper(:)
      real(dp) :: accuracy
      integer :: m, iteration
      logical :: may_continue

      call solution%reset()
      call solution%effort%factorize(.not. allocated(problem%matrix%compliance))
      call self%prepare(problem, error)
      if (allocated(error)) return
      m = problem%n_points
      force = solution%force
      b = problem%dual_load(solution%displacement)
      call solution%effort%multiply(1.0_dp)
      do iteration = 1, self%max_iterations
         accuracy = inner_accuracy*self%tolerance*problem%force_scale(force)
         bound = problem%bound(force(:m))
         if (problem%matrix%n_tangents == 2) then
            call solve_disc_program(self%box, problem%matrix%compliance, [1, size(b)], b, 0.0_dp*b, bound, accuracy, &
               force, solution%effort, error)
         else
            lower = [spread(0.0_dp, 1, m), -bound]
            upper = [spread(huge(1.0_dp), 1, m), bound]
            call solve_box_program(self%box, problem%matrix%compliance, [1, 2*m], b, lower, upper, accuracy, force, &
               solution%effort, error)
         end if
         if (allocated(error)) return
         call solution%effort%multiply(1.0_dp)
         call solution%record(problem, problem%displacement(b, force), force, self%tolerance, may_continue)
         if (.not. may_continue) return
         if (problem%matrix%is_held) cycle
         b = problem%dual_load(solution%displacement)
         call solution%effort%multiply(1.0_dp)
      end do
   end subroutine fixed_point_solve

end module amontons_fixed_point
