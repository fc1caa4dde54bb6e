!> How a history ended, checked: the step that has no equilibrium is tried again.
module amontons_verify_history_end
   use amontons_answer_report, only: answer_documents
   use amontons_config, only: config_t
   use amontons_contact_method, only: contact_method_t
   use amontons_document, only: document_t
   use amontons_document_check, only: compare_document
   use amontons_error, only: error_t
   use amontons_history_model, only: history_model_t, instant_t
   use amontons_kinds, only: dp
   use amontons_solve_case, only: cache_t
   use amontons_solve_history, only: history_result_t
   use amontons_stepper, only: step_state_t, take_step
   use amontons_summary_file, only: summary_file_t
   implicit none (type, external)
   private

   public :: check_end, solve_again, verify_answer

contains

   !> Checks the files of a history without a first state: takes the first step again, and makes them once more.
   subroutine verify_answer(summary, cache, model, method, config, stem, result, is_certified)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! directory and name of the case
      type(history_result_t), intent(inout) :: result !! the way where it begins
      logical, intent(out) :: is_certified !! whether the answer is that there is no equilibrium
      type(document_t) :: listing, answer

      call result%walk%advance(model, cache%body, cache%problem, method)
      result%last%is_complete = len(result%walk%fault) == 0
      result%last%has_no_equilibrium = result%walk%has_no_equilibrium
      call answer_documents(listing, answer, config, cache%body, result%last, result%walk%fault)
      call compare_document(summary%faults, stem, answer)
      call compare_document(summary%faults, stem, listing)
      is_certified = result%walk%has_no_equilibrium
   end subroutine verify_answer

   !> Checks why a history ended: where its summary says that the next step has no equilibrium, tries it again.
   subroutine check_end(summary, cache, model, method, before, has_no_equilibrium)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the fault
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(step_state_t), intent(in) :: before !! the last state
      logical, intent(in) :: has_no_equilibrium !! what the summary says
      type(step_state_t) :: next
      character(:), allocatable :: fault
      real(dp) :: time

      if (.not. has_no_equilibrium) return
      time = summary%number('load_history', 'end_time')
      associate (times => model%history%times)
         fault = 'end_time is not behind the last step'
         if (time > before%instant%time .and. time <= times(size(times))) then
            call solve_again(next, fault, cache, model, method, before, time)
            if (next%has_no_equilibrium) return
            fault = 'the step that is said to have no equilibrium has one'
         end if
      end associate
      call summary%faults%add(summary%path, fault)
   end subroutine check_end

   !> Solves a step again.
   subroutine solve_again(next, fault, cache, model, method, before, time)
      type(step_state_t), intent(out) :: next !! the state at its end
      character(:), allocatable, intent(inout) :: fault !! gains why it has none
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(step_state_t), intent(in) :: before !! the state at its beginning
      real(dp), intent(in) :: time !! the time that it leads to [-]
      type(instant_t) :: instant
      type(error_t), allocatable :: error

      call model%at(cache%body, time, instant, error)
      if (.not. allocated(error)) call take_step(next, model, cache%body, cache%problem, method, before, instant, error)
      if (allocated(error)) then
         fault = error%message
      else if (.not. next%solution%is_converged) then
         fault = 'the step does not converge again'
      end if
   end subroutine solve_again

end module amontons_verify_history_end
