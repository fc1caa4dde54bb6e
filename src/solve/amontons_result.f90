!> The result of a case: what became of it, in a word that all files have, and everything that the reports tell.
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
   use amontons_quantity, only: quantity_t
   use amontons_stress_field, only: error_estimate_t, stress_field_t
   use amontons_terminal, only: timings_t
   use amontons_uniqueness, only: uniqueness_t
   use amontons_zone_edges, only: interval_t
   implicit none (type, external)
   private

   public :: certificate_limit, factor_t, has_converged, outcome_names, outcome_word, result_t, solution_word, &
      status_not_converged

   !> Outcome of a load case: the residual is at most the tolerance.
   integer, parameter, public :: outcome_solved = 1
   !> Outcome of a load case: the residual stayed above the tolerance.
   integer, parameter, public :: outcome_not_converged = 2
   !> Outcome of a load case: contact and friction cannot balance the loads.
   integer, parameter, public :: outcome_no_equilibrium = 3
   !> Outcome of a load case: its numbers left the range of numbers, or have no digit.
   integer, parameter, public :: outcome_numbers = 4

   !> Solved: the residual is at most the tolerance, and the certificate, where there is one, passes.
   character(*), parameter, public :: word_solved = 'solved'
   !> Contact and friction cannot balance the loads.
   character(*), parameter, public :: word_no_equilibrium = 'no_equilibrium'
   !> The residual is above the tolerance, or a step of a history cannot be taken.
   character(*), parameter, public :: word_not_converged = 'not_converged'
   !> Converged, but a violation of the certificate is above its limit.
   character(*), parameter, public :: word_not_certified = 'not_certified'

   !> Words for the outcomes that result files have.
   character(14), parameter :: outcome_names(3) = [character(14) :: word_solved, word_not_converged, &
      word_no_equilibrium]

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

   !> The word for a solution.
   pure function solution_word(is_converged, is_certified) result(word)
      logical, intent(in) :: is_converged !! whether the residual is at most the tolerance
      logical, intent(in) :: is_certified !! whether no violation of its certificate is above the limit
      character(:), allocatable :: word

      if (.not. is_converged) then
         word = word_not_converged
      else if (.not. is_certified) then
         word = word_not_certified
      else
         word = word_solved
      end if
   end function solution_word

   !> Whether a word says that the residual is at most the tolerance.
   pure logical function has_converged(word)
      character(*), intent(in) :: word !! the word

      has_converged = word == word_solved .or. word == word_not_certified
   end function has_converged

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
