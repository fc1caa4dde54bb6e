!> Solves a reduced problem of two contacts, given by the paper's A and B, and prints forces and displacements.
!>
!> All normal unknowns stand before the tangential ones: u = B - A lambda. The first contact sticks, the second
!> slides backwards.
program reduced_problem
   use, intrinsic :: iso_fortran_env, only: error_unit
   use amontons, only: contact_method_t, contact_operator_t, contact_problem_t, contact_solution_t, dp, error_t, &
      method_options_t, new_compliance_operator, new_contact_method, new_contact_solution, new_dense_matrix, &
      new_reduced_problem, status_names, symmetric_matrix_t
   implicit none (type, external)
   real(dp), allocatable :: a(:, :)
   real(dp), parameter :: b(4) = [1.0_dp, 2.0_dp, -0.5_dp, -4.0_dp], friction(2) = [0.75_dp, 0.5_dp]
   type(symmetric_matrix_t) :: matrix
   type(contact_operator_t), target :: compliance
   type(contact_problem_t) :: problem
   type(contact_solution_t) :: solution
   class(contact_method_t), allocatable :: method
   type(error_t), allocatable :: error
   integer :: p

   a = reshape([2.0_dp, 0.5_dp, -0.5_dp, 0.0_dp, &
                0.5_dp, 2.0_dp, 0.0_dp, 0.5_dp, &
               -0.5_dp, 0.0_dp, 3.0_dp, 0.25_dp, &
                0.0_dp, 0.5_dp, 0.25_dp, 3.0_dp], [4, 4])
   call new_dense_matrix(matrix, a)
   call new_compliance_operator(compliance, matrix)
   call new_reduced_problem(problem, compliance, b, friction)
   call new_contact_solution(solution, problem%n_points, problem%matrix%n_tangents)
   call new_contact_method(method, method_options_t(method='auto'), error)
   if (.not. allocated(error)) call method%solve(problem, solution, error)
   if (allocated(error)) then
      write (error_unit, '(a)') error%message
      stop error%kind, quiet=.true.
   end if

   print '(a, i0, a, es8.1)', 'iterations: ', solution%n_iterations, ', residual:', solution%residual
   print '(a)', '  lambda_N  lambda_T       u_N       u_T  status'
   do p = 1, problem%n_points
      print '(4f10.6, 2x, a)', solution%force([p, p + 2]), solution%displacement([p, p + 2]), &
         trim(status_names(solution%status(p)))
   end do

end program reduced_problem
