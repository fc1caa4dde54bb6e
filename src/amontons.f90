!> The public interface of the Amontons library, on one screen.
!>
!> From a deck of any kind to its files: `read_config`, `new_study`, `solve_study`. With the result at hand:
!> `solve_case`, `write_report`, or `solve_sweep`, `write_sweep_report`. A history step by step: `new_load_stepper` and
!> its `step`. In code: `new_rectangle_mesh` or `read_mesh_file`, `new_material`, `new_support`, `new_contact`,
!> `new_body`, `new_load`, `solve_body`. A contact problem alone: `new_contact_problem` or `new_reduced_problem`,
!> `new_contact_method`, `new_contact_solution`. A reduced problem from a file: `new_reduced_config`, `solve_reduced`,
!> `write_reduced_report`; to one: `new_condensed_system`, `write_reduced_file`; from arrays: `new_dense_system`,
!> `solve_reduced_system`. Files of an earlier run: `find_cases`, `verify_files`.
module amontons
   use amontons_all_solutions, only: all_solutions_t, find_all_solutions
   use amontons_body, only: body_t, condense_body, new_body
   use amontons_case_label, only: case_label_t, new_case_label
   use amontons_certificate, only: certificate_t, new_certificate
   use amontons_condensation, only: condensation_options_t
   use amontons_config, only: config_t, new_reduced_config, read_config
   use amontons_constraints, only: new_support, support_t
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_operator, only: contact_operator_t, new_compliance_operator, new_stiffness_operator
   use amontons_contact_problem, only: contact_problem_t, new_contact_problem, new_reduced_problem
   use amontons_contact_set, only: contact_t, new_contact, new_tie, tie_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_dense_system, only: new_dense_system
   use amontons_error, only: error_t, input_refused, numerical_failure, system_failure
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, status_names, stick_point
   use amontons_joined_mesh, only: append_mesh, name_mesh
   use amontons_kinds, only: dp
   use amontons_load_case, only: load_case_t, new_load_case
   use amontons_load_stepper, only: load_stepper_t, new_load_stepper
   use amontons_loads, only: load_t, new_load
   use amontons_material, only: material_t, new_material
   use amontons_mesh, only: mesh_t
   use amontons_mesh_file, only: read_mesh_file
   use amontons_methods, only: method_names, method_options_t, new_contact_method
   use amontons_new_study, only: new_study
   use amontons_outcome, only: outcome_t
   use amontons_rectangle, only: new_rectangle_mesh, rectangle_t
   use amontons_reduced_report, only: write_reduced_report
   use amontons_reduced_system, only: new_condensed_system, reduced_system_t
   use amontons_report, only: write_report
   use amontons_result, only: result_t
   use amontons_siconos_text, only: read_reduced_file, write_reduced_file
   use amontons_solve_case, only: cache_t, prepare_case, solve_case
   use amontons_solve_load_case, only: solve_body
   use amontons_solve_reduced, only: find_reduced_solutions, reduced_result_t, solve_reduced, solve_reduced_system
   use amontons_solve_sweep, only: solve_sweep, sweep_result_t
   use amontons_study, only: check_study, solve_study, study_options_t, study_t
   use amontons_study_monitor, only: study_monitor_t
   use amontons_sweep_report, only: write_sweep_report
   use amontons_symmetric_matrix, only: new_dense_matrix, new_sparse_matrix, symmetric_matrix_t
   use amontons_system, only: file_name_t
   use amontons_threads, only: set_threads
   use amontons_uniqueness, only: new_uniqueness, uniqueness_t
   use amontons_verify, only: find_cases, verdict_t, verify_files
   use amontons_version, only: version
   implicit none (type, external)
   private

   ! Values
   public :: dp, error_t, input_refused, numerical_failure, system_failure, version
   ! Cases
   public :: load_stepper_t, new_load_stepper
   public :: cache_t, case_label_t, config_t, new_case_label, prepare_case, read_config, result_t, solve_case, &
      write_report
   ! Results in files
   public :: file_name_t, find_cases, verdict_t, verify_files
   ! Studies of any kind
   public :: check_study, new_study, outcome_t, solve_study, study_monitor_t, study_options_t, study_t
   ! Sweeps
   public :: solve_sweep, sweep_result_t, write_sweep_report
   ! Reduced problems of others
   public :: find_reduced_solutions, new_condensed_system, new_dense_system, new_reduced_config, read_reduced_file, &
      reduced_result_t, reduced_system_t, solve_reduced, solve_reduced_system, write_reduced_file, write_reduced_report
   ! Bodies
   public :: append_mesh, body_t, condensation_options_t, condense_body, contact_t, load_case_t, load_t, material_t, &
      mesh_t, name_mesh, new_body, new_contact, new_load, new_load_case, new_material, new_rectangle_mesh, &
      new_support, new_tie, read_mesh_file, rectangle_t, solve_body, support_t, tie_t
   ! Contact problems and methods
   public :: contact_method_t, contact_operator_t, contact_problem_t, contact_solution_t, method_names, &
      method_options_t, new_compliance_operator, new_contact_method, new_contact_problem, new_contact_solution, &
      new_dense_matrix, new_reduced_problem, new_sparse_matrix, new_stiffness_operator, symmetric_matrix_t
   public :: all_solutions_t, find_all_solutions, new_uniqueness, uniqueness_t
   public :: open_point, slip_minus, slip_plus, status_names, stick_point
   ! Certificates
   public :: certificate_t, new_certificate
   ! Threads
   public :: set_threads

end module amontons
