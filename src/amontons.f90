!> The public interface of the Amontons library up to the solution of one body, on one screen. Decks and their files are
!> in `amontons_decks`.
!>
!> A body: `new_rectangle_mesh` or `read_mesh_file`, `new_material`, `new_support`, `new_contact`, `new_body`,
!> `new_load`, `solve_body`. A contact problem alone: `new_compliance_operator` and `new_reduced_problem`,
!> `new_contact_method`, `new_contact_solution`. A reduced problem in arrays: `new_dense_system`,
!> `solve_reduced_system`.
module amontons
   use amontons_body, only: body_t, new_body
   use amontons_constraints, only: new_support, support_t
   use amontons_contact_operator, only: contact_operator_t, new_compliance_operator
   use amontons_contact_problem, only: contact_problem_t, new_reduced_problem
   use amontons_contact_set, only: contact_t, new_contact, new_tie, tie_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, new_contact_solution
   use amontons_error, only: error_t
   use amontons_friction_law, only: status_names
   use amontons_generated_mesh, only: new_rectangle_mesh, rectangle_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t, new_load
   use amontons_material, only: material_t, new_material
   use amontons_mesh, only: mesh_t
   use amontons_mesh_file, only: read_mesh_file
   use amontons_methods, only: method_options_t, new_contact_method
   use amontons_reduced_study, only: reduced_result_t, solve_reduced_system
   use amontons_reduced_system, only: new_dense_system, reduced_system_t
   use amontons_result, only: result_t
   use amontons_solve_case, only: solve_body
   use amontons_symmetric_matrix, only: new_dense_matrix, symmetric_matrix_t
   use amontons_threads, only: set_threads
   use amontons_version, only: version
   implicit none (type, external)
   private

   ! Values, errors, threads
   public :: dp, error_t, set_threads, version
   ! Meshes
   public :: mesh_t, new_rectangle_mesh, read_mesh_file, rectangle_t
   ! Bodies
   public :: body_t, contact_t, load_t, material_t, new_body, new_contact, new_load, new_material, new_support, &
      new_tie, result_t, solve_body, support_t, tie_t
   ! Contact problems and methods
   public :: contact_method_t, contact_operator_t, contact_problem_t, contact_solution_t, method_options_t, &
      new_compliance_operator, new_contact_method, new_contact_solution, new_dense_matrix, new_reduced_problem, &
      status_names, symmetric_matrix_t
   ! Reduced problems in arrays
   public :: new_dense_system, reduced_result_t, reduced_system_t, solve_reduced_system

end module amontons
