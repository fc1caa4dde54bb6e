!> The result of a case: everything that the reports tell.
module amontons_result
   use amontons_all_solutions, only: all_solutions_t
   use amontons_certificate, only: certificate_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_convergence, only: refined_quantity_t
   use amontons_document, only: document_t
   use amontons_error, only: warning_list_t
   use amontons_key_results, only: lengths_t
   use amontons_kinds, only: dp, int64
   use amontons_load_case, only: load_case_t
   use amontons_methods, only: method_options_t
   use amontons_outcome_words, only: outcome_no_equilibrium, outcome_not_converged, solution_word, word_no_equilibrium
   use amontons_quantity, only: quantity_t
   use amontons_stress_field, only: error_estimate_t, stress_field_t
   use amontons_terminal, only: timings_t
   use amontons_uniqueness, only: uniqueness_t
   use amontons_zone_edges, only: interval_t
   implicit none (type, external)
   private

   public :: certificate_limit, factor_t, outcome_word, result_t, status_not_converged

   !> Exit status of a case that did not converge, or whose certificate failed; the others are the kinds of
   !> `amontons_error`.
   integer, parameter :: status_not_converged = 4

   !> The factorization of the body.
   type :: factor_t
      character(:), allocatable :: name !! its name
      integer(int64) :: n_entries = 0_int64 !! stored entries
      real(dp) :: n_flops = 0.0_dp !! floating-point operations it took
   end type factor_t

   !> Solution, certificate and record of a case.
   type :: result_t
      type(contact_solution_t) :: solution !! forces, displacements and statuses of the contact points
      type(method_options_t) :: method !! the contact method and its options
      type(load_case_t) :: load_case !! loads, prescribed displacements, obstacles and friction
      real(dp), allocatable :: displacement(:, :) !! displacement of all nodes (2, n_nodes) [L]
      type(stress_field_t) :: stress !! stresses of the body, of the displacements
      type(certificate_t) :: certificate !! violations on the full model
      type(warning_list_t) :: warnings !! what is doubtful about the model and the result
      integer :: outcome = outcome_not_converged
         !! what came of its loads, or of those of the next step of a history that ended early
      real(dp) :: condition = 0.0_dp
         !! condition number of the stiffness in the 1-norm, estimated where rounding shows; else 0 [-]
      type(uniqueness_t) :: uniqueness !! the friction below which the solution is the only one
      type(all_solutions_t), allocatable :: all_solutions !! all solutions, where they were asked for
      logical :: has_reduced_files = .false. !! whether its reduced problem was written
      logical :: wants_error_estimate = .false. !! whether the error of the stresses is to be estimated
      type(error_estimate_t), allocatable :: error_estimate !! the estimate, where it is wanted
      type(refined_quantity_t), allocatable :: convergence(:) !! its numbers on refined meshes, where asked for
      type(quantity_t), allocatable :: key_results(:) !! largest values with their places, and what contact sets carry
      type(interval_t), allocatable :: closed(:) !! the closed parts of the contact line
      type(interval_t), allocatable :: stuck(:) !! its parts that stick
      type(lengths_t) :: lengths !! lengths of the open, slip and stick zones
      real(dp) :: method_error = -1.0_dp
         !! largest difference of a contact force from the exact solution, over the largest force; -1 if not asked [-]
      real(dp), allocatable :: slip_record(:, :)
         !! of a load history: slip of its last step [L], accumulated slip [L], dissipation [F L] and the integral of
         !! the pressure over the slip [F/L] of each point; parameters of fretting where they are asked for (m, 4 or 9)
      logical :: is_complete = .true. !! whether a study of several steps has come to its end
      character(:), allocatable :: answer
         !! why there is no state to show: no equilibrium, or a first step of a history that did not converge
      real(dp) :: earlier_violation = 0.0_dp
         !! largest violation of the certificates of earlier steps of a study of several [-]
      type(document_t) :: study_listing !! what a study of several steps says of them in the listing; empty for others
      type(document_t) :: study_members !! what it says in the summary, members of a JSON object
      character(:), allocatable :: shared_with !! the case whose factorization was used; not allocated for an own one
      character(:), allocatable :: started_from !! the case whose solution was the start; not allocated for a cold start
      type(factor_t) :: factor !! the factorization in use
      type(timings_t) :: timings !! where the time went
   end type result_t

contains

   !> What every violation of a certificate must stay below, for a tolerance of the contact method [-].
   !>
   !> A hundred times the tolerance leaves room for what a residual of the small problem becomes on the full model;
   !> below 1e-8 rounding of a large model would speak.
   pure real(dp) function certificate_limit(tolerance)
      real(dp), intent(in) :: tolerance !! tolerance of the contact method [-]

      certificate_limit = max(1.0e-8_dp, 100.0_dp*tolerance)
   end function certificate_limit

   !> What became of a case in a word.
   pure function outcome_word(result) result(word)
      type(result_t), intent(in) :: result !! its result
      character(:), allocatable :: word

      if (result%outcome == outcome_no_equilibrium) then
         word = word_no_equilibrium
      else
         word = solution_word(result%solution%is_converged .and. result%is_complete, &
            max(result%certificate%largest(), result%earlier_violation) <= certificate_limit(result%method%tolerance))
      end if
   end function outcome_word

end module amontons_result
