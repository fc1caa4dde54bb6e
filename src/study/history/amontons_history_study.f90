!> The study of a load history: all steps of a deck with `&history`.
module amontons_history_study
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_history_model, only: find_probes
   use amontons_history_report, only: describe_history
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp
   use amontons_model_warnings, only: add_history_warnings
   use amontons_quantity, only: quantity_t
   use amontons_report, only: write_report
   use amontons_result, only: outcome_no_equilibrium, result_t, word_no_equilibrium, word_not_converged
   use amontons_solve_case, only: cache_t, prepare_case
   use amontons_solve_history, only: history_result_t, solve_history
   use amontons_study, only: outcome_t, report_size, study_monitor_t, study_options_t, study_t
   use amontons_text, only: scientific, short_text, to_text, with_unit
   implicit none (type, external)
   private

   public :: history_study_t

   !> The study of a history.
   type, extends(study_t) :: history_study_t
   contains
      procedure :: check => history_study_check
      procedure :: solve => history_study_solve
   end type history_study_t

contains

   !> Checks the history and reports its size.
   subroutine history_study_check(self, cache, outcome, error)
      class(history_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the history needs another
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck
      type(result_t) :: result
      integer, allocatable :: probes(:)

      associate (history => self%config%history)
         call prepare_case(cache, self%config, result, error)
         if (allocated(error)) return
         call add_history_warnings(result%warnings, history, result%load_case, cache%body%zone%set)
         call report_size(self%config, ', '//to_text(history%n_steps())//' steps', cache, result, outcome, error)
         if (.not. allocated(error)) call find_probes(probes, history, cache%body, error)
         if (allocated(error)) outcome%text = ''
      end associate
   end subroutine history_study_check

   !> Takes the steps and writes their files.
   subroutine history_study_solve(self, cache, options, monitor, outcome, error)
      class(history_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the history needs another
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
      class(study_monitor_t), intent(inout) :: monitor !! learns how far the history is, and may stop it
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what is lacking, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the history cannot be solved or written
      type(history_result_t) :: result
      character(:), allocatable :: word

      call solve_history(cache, self%config, options%directory, monitor, result, error)
      if (allocated(error)) return
      if (result%is_interrupted) then
         call outcome%interrupt('step '//to_text(result%walk%n_steps))
         return
      end if
      if (len(result%walk%fault) > 0) then
         word = word_not_converged
         if (result%walk%outcome == outcome_no_equilibrium) word = word_no_equilibrium
         call outcome%lack(word, result%walk%fault)
      end if
      outcome%warnings = result%last%warnings
      if (result%walk%n_steps == 0) then
         result%last%answer = outcome%message
         call write_report(options%directory, self%config, cache%body, result%last, error, result%files)
         return
      end if
      call describe_history(result, self%config)
      call write_report(options%directory, self%config, cache%body, result%last, error, result%files)
      if (.not. allocated(error)) call result%checkpoint%remove()
      call result%checkpoint%close()
      if (allocated(error)) return
      outcome%text = solved_text(self%config, result)
      outcome%numbers = [quantity_t('iterations', '', real(result%walk%n_iterations, dp)), &
         quantity_t('residual', '', result%residual%value), result%last%key_results, &
         resultants(result%last%solution%force)]
      outcome%has_grids = result%last%is_complete
      if (result%last%is_complete) call outcome%judge(.true., result%residual%value, &
         result%last%earlier_violation, self%config%method%tolerance)
   end subroutine history_study_solve

   !> The line on the result of a history.
   pure function solved_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(history_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      real(dp), parameter :: rounding = 1.0e-12_dp
      real(dp) :: from_rest

      from_rest = result%error_from_rest(config%history)
      associate (walk => result%walk)
         text = config%name//': '//to_text(walk%n_steps)//' steps, '//trim(merge('all solved', 'INCOMPLETE', &
            len(walk%fault) == 0))//', residual at most '//scientific(result%residual%value)//'; dissipation '// &
            with_unit(short_text(sum(walk%state%dissipation)), config%units, 'F L')//', energy error '// &
            with_unit(short_text(walk%state%energy_error() - from_rest), config%units, 'F L')
         if (abs(from_rest) > rounding*walk%state%strain_energy) text = text//' and, in the first step from rest, '// &
            with_unit(short_text(from_rest), config%units, 'F L')
      end associate
   end function solved_text

end module amontons_history_study
