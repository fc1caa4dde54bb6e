!> Decks and files, above the bodies of the module `amontons`: what the program does, for other programs.
!>
!> From a deck of any kind to its files: `read_config`, `new_study`, `solve_study`. To have the result as well:
!> `solve_case`, `write_report`; of a body made in code, `new_case_label` and `write_report`. A history step by step:
!> `new_load_stepper` and its `step`. Files of an earlier run: `find_cases`, `verify_files`.
module amontons_decks
   use amontons_case_label, only: case_label_t, new_case_label
   use amontons_config, only: config_t, new_reduced_config, read_config
   use amontons_load_stepper, only: load_stepper_t, new_load_stepper
   use amontons_new_study, only: new_study
   use amontons_report, only: write_report
   use amontons_solve_case, only: cache_t, solve_case
   use amontons_study, only: check_study, outcome_t, solve_study, study_monitor_t, study_options_t, study_t
   use amontons_system, only: file_name_t
   use amontons_verify, only: find_cases, verdict_t, verify_files
   implicit none (type, external)
   private

   ! Cases
   public :: cache_t, case_label_t, config_t, new_case_label, new_reduced_config, read_config, solve_case, write_report
   ! Studies of any kind
   public :: check_study, new_study, outcome_t, solve_study, study_monitor_t, study_options_t, study_t
   ! Histories step by step
   public :: load_stepper_t, new_load_stepper
   ! Results in files
   public :: file_name_t, find_cases, verdict_t, verify_files

end module amontons_decks
