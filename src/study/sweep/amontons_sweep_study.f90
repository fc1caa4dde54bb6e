!> The study of a sweep: all cases of a deck with `&sweep`.
module amontons_sweep_study
   use amontons_body, only: body_t
   use amontons_conditioning, only: rounded
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t
   use amontons_result, only: outcome_no_equilibrium, outcome_not_converged, outcome_solved, result_t, &
      word_no_equilibrium, word_not_converged
   use amontons_solve_case, only: cache_t
   use amontons_solve_sweep, only: solve_sweep, sweep_result_t
   use amontons_study, only: outcome_t, report_size, study_monitor_t, study_options_t, study_t
   use amontons_sweep, only: sweep_t
   use amontons_sweep_chunk, only: prepare_sweep, sweep_task_t
   use amontons_sweep_report, only: write_sweep_report
   use amontons_sweep_table, only: ranked_quantities, sweep_statistics_t
   use amontons_text, only: counted, scientific, to_text
   implicit none (type, external)
   private

   public :: sweep_study_t

   !> The study of a sweep.
   type, extends(study_t) :: sweep_study_t
   contains
      procedure :: check => sweep_study_check
      procedure :: solve => sweep_study_solve
   end type sweep_study_t

contains

   !> Checks the sweep and reports its size.
   subroutine sweep_study_check(self, cache, outcome, error)
      class(sweep_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the sweep needs another
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck
      type(sweep_task_t) :: task
      type(result_t) :: result
      character(:), allocatable :: cases

      associate (sweep => self%config%sweep)
         cases = ', '//to_text(sweep%n_cases())//' cases'
         if (sweep%n_fields() > 0) cases = cases//', fields of '//to_text(sweep%n_fields())
      end associate
      call prepare_sweep(task, cache, self%config, result, error)
      if (.not. allocated(error)) call report_size(self%config, cases, cache, result, outcome, error)
   end subroutine sweep_study_check

   !> Solves the cases and writes their files.
   subroutine sweep_study_solve(self, cache, options, monitor, outcome, error)
      class(sweep_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the sweep needs another
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
      class(study_monitor_t), intent(inout) :: monitor !! learns how far the sweep is, and may stop it
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solutions lack, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the sweep cannot be solved or written
      type(sweep_result_t) :: result

      call solve_sweep(cache, self%config, options%directory, monitor, result, error)
      if (allocated(error)) return
      if (result%is_interrupted) then
         call outcome%interrupt(to_text(result%statistics%n_cases)//' of '// &
            to_text(self%config%sweep%n_cases())//' cases')
         return
      end if
      call write_sweep_report(options%directory, self%config, cache%body, result, error)
      if (allocated(error)) return
      outcome%text = swept_text(self%config%name, result)
      outcome%warnings = result%certified%warnings
      outcome%numbers = swept_numbers(cache%body, self%config%sweep, result%statistics)
      call judge_sweep(result, self%config%method%tolerance, outcome)
   end subroutine sweep_study_solve

   !> Judges a sweep by its cases, and by the certificate of one of them.
   pure subroutine judge_sweep(result, tolerance, outcome)
      type(sweep_result_t), intent(in) :: result !! the result
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]
      type(outcome_t), intent(inout) :: outcome !! gains status, and what the solutions lack

      if (.not. result%statistics%is_answered()) then
         call outcome%lack(word_not_converged, to_text(result%statistics%n_outcomes(outcome_not_converged))//' of '// &
            to_text(result%statistics%n_cases)//' cases of the sweep did not converge')
         return
      end if
      if (result%statistics%outcome() == word_no_equilibrium) then
         outcome%word = word_no_equilibrium
         return
      end if
      call outcome%judge(.true., result%statistics%residual, result%certified%certificate%largest(), tolerance)
      if (outcome%status /= 0 .and. result%certified%condition > 0.0_dp) outcome%message = outcome%message// &
         '; the condition number of the stiffness is about '//rounded(result%certified%condition)
   end subroutine judge_sweep

   !> Iterations of all cases together, and of those that converged the largest residual and peaks.
   pure function swept_numbers(body, sweep, statistics) result(list)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      type(quantity_t), allocatable :: list(:), ranked(:)
      integer :: i

      ranked = ranked_quantities(body, sweep)
      allocate (list(0))
      if (statistics%residual_case == 0) return
      list = [quantity_t('iterations', '', real(statistics%n_iterations, dp)), &
         quantity_t('residual', '', statistics%residual)]
      do i = 1, size(ranked)
         ranked(i)%value = statistics%greatest(i)
         if (index(ranked(i)%key, 'max_') == 1) list = [list, ranked(i)]
      end do
   end function swept_numbers

   !> The line on the result of a sweep.
   pure function swept_text(name, result) result(text)
      character(*), intent(in) :: name !! name of the case
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (statistics => result%statistics)
         text = name//': '//counted(statistics%n_cases, 'case')//', '
         if (statistics%n_outcomes(outcome_solved) == statistics%n_cases) then
            text = text//'all solved'
         else
            text = text//to_text(statistics%n_outcomes(outcome_solved))//' solved'
         end if
         if (statistics%n_outcomes(outcome_no_equilibrium) > 0) text = text//', '// &
            to_text(statistics%n_outcomes(outcome_no_equilibrium))//' without equilibrium'
         if (.not. statistics%is_answered()) text = text//', '// &
            to_text(statistics%n_outcomes(outcome_not_converged))//' NOT CONVERGED'
         if (statistics%residual_case == 0) return
         text = text//', residual at most '//scientific(statistics%residual)
      end associate
   end function swept_text

end module amontons_sweep_study
