!> A study: the task that a deck describes, from its checked configuration to its files; its outcome, and the monitor
!> that may stop it.
!>
!> Each kind extends `study_t` in a folder of its own; `new_study` chooses the kind of a deck.
module amontons_study
   use amontons_body, only: body_t, estimate_body, estimate_t
   use amontons_conditioning, only: rounded
   use amontons_config, only: config_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t, input_refused, new_error, no_equilibrium, numerical_failure, warning_list_t
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t
   use amontons_report, only: study_files_t, write_report
   use amontons_result, only: certificate_limit, outcome_word, result_t, solution_word, status_not_converged, &
      word_no_equilibrium, word_not_certified, word_not_converged, word_numerical_failure, word_solved
   use amontons_rounding, only: difference_rounding
   use amontons_solve_case, only: cache_t
   use amontons_text, only: counted, scientific, to_text
   implicit none (type, external)
   private

   public :: check_study, find_exit_status, method_numbers, outcome_t, report_answer, report_size, solution_line, &
      solve_study, study_monitor_t, study_options_t, study_t, word_no_equilibrium, word_not_certified, &
      word_not_converged, word_solved

   !> Exit status of an interrupted study; the same command continues it.
   integer, parameter, public :: status_interrupted = 5

   !> The outcome of a deck.
   type :: outcome_t
      character(:), allocatable :: deck !! name of the deck
      character(:), allocatable :: name !! name of its case; empty where the deck could not be read
      integer :: status = 0 !! exit status that the deck alone would give
      character(:), allocatable :: word !! its outcome, a word of batch.csv
      character(:), allocatable :: text !! the line on its result; empty without a result
      character(:), allocatable :: message !! what went wrong, beginning with the name of the deck; empty if nothing did
      type(quantity_t), allocatable :: numbers(:) !! numbers of the result; not allocated without a result
      real(dp) :: seconds = 0.0_dp !! time that the deck took [s]
      type(warning_list_t) :: warnings !! warnings on model and result
      logical :: has_grids = .false. !! whether a single converged case left the grids NAME.vtu and NAME.contact.vtu
   contains
      procedure :: begin => outcome_begin
      procedure :: fail => outcome_fail
      procedure :: interrupt => outcome_interrupt
      procedure :: lack => outcome_lack
      procedure :: judge => outcome_judge
   end type outcome_t

   !> A monitor without output that never stops a study; programs extend it.
   type :: study_monitor_t
   contains
      procedure :: is_stopped => study_monitor_is_stopped
      procedure :: report => study_monitor_report
   end type study_monitor_t

   !> The options of a study that are not in the deck.
   type :: study_options_t
      character(:), allocatable :: directory !! output directory, made if it is not there
      logical :: writes_reduced = .false. !! whether the reduced problem is written
      logical :: wants_all_solutions = .false. !! whether every solution of a small problem is listed
   end type study_options_t

   !> A study of one deck.
   type, abstract :: study_t
      type(config_t) :: config !! the deck
   contains
      procedure(check_procedure), deferred :: check
      procedure(solve_procedure), deferred :: solve
      procedure :: has_grids => study_has_grids
   end type study_t

   abstract interface
      !> Checks everything that the deck can get wrong and reports its size, without solving anything.
      subroutine check_procedure(self, cache, outcome, error)
         import :: cache_t, error_t, outcome_t, study_t
         implicit none (type, external)
         class(study_t), intent(in) :: self !! the study
         type(cache_t), intent(inout) :: cache !! the present body, replaced if the study needs another
         type(outcome_t), intent(inout) :: outcome !! gains its line and the warnings
         type(error_t), allocatable, intent(out) :: error !! the faults of the deck
      end subroutine check_procedure

      !> Solves everything that the deck asks for and writes its files.
      subroutine solve_procedure(self, cache, options, monitor, outcome, error)
         import :: cache_t, error_t, outcome_t, study_monitor_t, study_options_t, study_t
         implicit none (type, external)
         class(study_t), intent(in) :: self !! the study
         type(cache_t), intent(inout) :: cache !! the present body, replaced if the study needs another
         type(study_options_t), intent(in) :: options !! the options that are not in the deck
         class(study_monitor_t), intent(inout) :: monitor !! receives the progress of a study, and may stop it
         type(outcome_t), intent(inout) :: outcome !! gains status, line, what is lacking, and the warnings
         type(error_t), allocatable, intent(out) :: error
            !! the deck is invalid, the computation failed numerically, or a file cannot be written
      end subroutine solve_procedure
   end interface

contains

   !> Begins the outcome of a deck, without any result yet.
   subroutine outcome_begin(self, deck, name)
      class(outcome_t), intent(out) :: self !! the outcome
      character(*), intent(in) :: deck !! name of the deck
      character(*), intent(in) :: name !! name of its case; empty where the deck could not be read

      self%deck = deck
      self%name = name
      self%word = word_solved
      self%text = ''
      self%message = ''
   end subroutine outcome_begin

   !> Records an error as the outcome of the study.
   pure subroutine outcome_fail(self, error)
      class(outcome_t), intent(inout) :: self !! the outcome
      type(error_t), intent(in) :: error !! the error
      character(*), parameter :: words(no_equilibrium) = [character(17) :: 'refused', word_numerical_failure, &
         'system_failure', word_not_converged, 'interrupted', word_no_equilibrium]

      self%word = trim(words(error%kind))
      self%status = merge(numerical_failure, error%kind, error%kind == no_equilibrium)
      self%message = error%message
   end subroutine outcome_fail

   !> Records that the study was interrupted.
   pure subroutine outcome_interrupt(self, place)
      class(outcome_t), intent(inout) :: self !! the outcome
      character(*), intent(in) :: place !! the progress: 'step 3'

      self%status = status_interrupted
      self%word = 'interrupted'
      self%message = 'interrupted after '//place//'; the same command goes on from there'
   end subroutine outcome_interrupt

   !> Records that there is no solution, or not of every step or row: status 4 without convergence, otherwise 2.
   pure subroutine outcome_lack(self, word, message)
      class(outcome_t), intent(inout) :: self !! the outcome
      character(*), intent(in) :: word !! `word_no_equilibrium`, `word_not_converged` or `word_numerical_failure`
      character(*), intent(in) :: message !! the reason, as a sentence

      self%status = merge(status_not_converged, numerical_failure, word == word_not_converged)
      self%word = word
      self%message = message
   end subroutine outcome_lack

   !> Records whether a solution converged and is certified.
   pure subroutine outcome_judge(self, is_converged, residual, violation, tolerance, condition)
      class(outcome_t), intent(inout) :: self !! the outcome
      logical, intent(in) :: is_converged !! whether the method converged
      real(dp), intent(in) :: residual !! its residual [-]
      real(dp), intent(in) :: violation !! largest violation found on the full model, or on the problem as read [-]
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]
      real(dp), intent(in) :: condition !! condition number of the stiffness; 0 if it explains no violation [-]

      call find_exit_status(is_converged, residual, violation, tolerance, self%status, self%message)
      if (self%status == 0) return
      self%word = solution_word(is_converged, .false.)
      if (is_converged .and. condition > 0.0_dp) self%message = self%message// &
         '; the condition number of the stiffness is about '//rounded(condition)
   end subroutine outcome_judge

   !> Iterations and residual of a solution, as named numbers.
   pure function method_numbers(solution) result(numbers)
      type(contact_solution_t), intent(in) :: solution !! the solution
      type(quantity_t) :: numbers(2)

      numbers = [quantity_t('iterations', '', real(solution%n_iterations, dp)), &
         quantity_t('residual', '', solution%residual)]
   end function method_numbers

   !> The beginning of the result line of a case: whether it was solved, and how.
   pure function solution_line(name, solution) result(text)
      character(*), intent(in) :: name !! name of the case
      type(contact_solution_t), intent(in) :: solution !! the solution
      character(:), allocatable :: text

      text = name//': '//trim(merge('solved       ', 'NOT CONVERGED', solution%is_converged))//', '// &
         counted(solution%n_iterations, 'iteration')//', residual '//scientific(solution%residual)
   end function solution_line

   !> Finds the exit status of a solution, and the sentence on what failed. Status 4 of a solution is decided here; that
   !> there is no solution, by `outcome_lack`.
   pure subroutine find_exit_status(is_converged, residual, violation, tolerance, status, fault)
      logical, intent(in) :: is_converged !! whether the method converged
      real(dp), intent(in) :: residual !! its residual [-]
      real(dp), intent(in) :: violation !! largest violation found on the full model, or on the problem as read [-]
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]
      integer, intent(out) :: status !! 0 or `status_not_converged`
      character(:), allocatable, intent(out) :: fault !! what is wrong with the solution; empty if nothing

      status = status_not_converged
      if (.not. is_converged) then
         fault = 'not converged: residual '//scientific(residual)//', tolerance '//scientific(tolerance)
         if (tolerance < difference_rounding) fault = fault//', which is below rounding (about '// &
            scientific(difference_rounding)//')'
      else if (.not. violation <= certificate_limit(tolerance)) then
         fault = 'the certificate FAILED: largest violation '//scientific(violation)//', limit '// &
            scientific(certificate_limit(tolerance))//'; see the listing'
      else
         status = 0
         fault = ''
      end if
   end subroutine find_exit_status

   !> Whether the study is to stop. May be called from any thread at any time.
   logical function study_monitor_is_stopped(self) result(is_stopped)
      class(study_monitor_t), intent(in) :: self !! the monitor

      is_stopped = .false.
      associate (unused => self)
      end associate
   end function study_monitor_is_stopped

   !> Reports the progress of the study: before the first batch of cases and after each, and after each batch of fields.
   subroutine study_monitor_report(self, n_done, n_cases, things)
      class(study_monitor_t), intent(inout) :: self !! the monitor
      integer, intent(in) :: n_done !! cases done, those of an earlier run included
      integer, intent(in) :: n_cases !! all cases
      character(*), intent(in) :: things !! noun for the items: 'cases', 'steps' or 'fields'

      associate (unused => self, done => n_done, all => n_cases, words => things)
      end associate
   end subroutine study_monitor_report

   !> Checks a study; an error becomes its outcome.
   subroutine check_study(study, cache, options, outcome)
      class(study_t), intent(in) :: study !! the study
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the study needs another
      type(study_options_t), intent(in) :: options !! the options that are not in the deck
      type(outcome_t), intent(out) :: outcome !! the outcome of the deck
      type(error_t), allocatable :: error

      call outcome%begin(study%config%file, study%config%name)
      call refuse_options(study%config, options, error)
      outcome%word = 'checked'
      if (.not. allocated(error)) call study%check(cache, outcome, error)
      call conclude(outcome, error)
   end subroutine check_study

   !> Solves a study and writes its files; an error becomes its outcome.
   subroutine solve_study(study, cache, options, monitor, outcome)
      class(study_t), intent(in) :: study !! the study
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the study needs another
      type(study_options_t), intent(in) :: options !! the options that are not in the deck
      class(study_monitor_t), intent(inout) :: monitor !! receives the progress of a study, and may stop it
      type(outcome_t), intent(out) :: outcome !! the outcome of the deck
      type(error_t), allocatable :: error

      call outcome%begin(study%config%file, study%config%name)
      call refuse_options(study%config, options, error)
      if (.not. allocated(error)) call study%solve(cache, options, monitor, outcome, error)
      call conclude(outcome, error)
   end subroutine solve_study

   !> Writes the files of a case without a solution, or of a study without a first one, and sets its outcome.
   subroutine report_answer(directory, config, body, result, outcome, error, study)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! its body
      type(result_t), intent(inout) :: result !! the load case, and why there is no solution
      type(outcome_t), intent(inout) :: outcome !! gains status, what is lacking, and the warnings
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(study_files_t), intent(in), optional :: study !! the files of a study of several steps

      call outcome%lack(outcome_word(result), result%answer)
      outcome%warnings = result%warnings
      call write_report(directory, config, body, result, error, study)
   end subroutine report_answer

   !> Reports the size of the problem for a body that is ready to be condensed.
   subroutine report_size(config, cases, cache, result, outcome, error)
      type(config_t), intent(in) :: config !! the deck, on its finest mesh
      character(*), intent(in) :: cases !! the cases it has, as they are reported: ', 12 cases'; empty for one
      type(cache_t), intent(inout) :: cache !! its body
      type(result_t), intent(inout) :: result !! the load case as it was prepared
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! the body is not held
      type(estimate_t) :: estimate
      integer :: n_dense
      character(:), allocatable :: text, size_text

      ! How many dense matrices of the contact points a method holds.
      select case (config%method%method)
      case ('auto', 'newton')
         n_dense = 0
      case ('lemke')
         ! Compliance and tableau, of twice as many rows.
         n_dense = 7
      case ('fixed_point')
         n_dense = 4
      case default
         n_dense = 2
      end select
      call estimate_body(cache%body, config%condensation, n_dense, result%timings, estimate, error)
      if (allocated(error)) return
      outcome%warnings = result%warnings
      ! What solving it would take.
      if (estimate%half_width > 0) then
         text = 'band contact matrix of '//to_text(estimate%n_rows)//' rows with half width '// &
            to_text(estimate%half_width)
         if (n_dense > 0) text = text//', made dense for the method'
      else
         text = 'dense contact matrix of '//to_text(estimate%n_rows)//' rows'
      end if
      text = text//', '//estimate%factorization//' factor of '//to_text(estimate%n_entries)//' entries, about '// &
         to_text(ceiling(estimate%memory_mb))//' MB of memory'
      if (estimate%n_ranks > 1) text = text//' on each of '//to_text(estimate%n_ranks)//' ranks at most'
      if (estimate%memory_mb > estimate%available_mb) text = text//', but only '// &
         to_text(floor(estimate%available_mb))//' MB are available'
      size_text = counted(cache%body%mesh%n_nodes, 'node')//', '//counted(cache%body%mesh%n_elements, 'element')// &
         ', '//counted(cache%body%dof_map%n_dofs, 'unknown')//', '//counted(cache%body%zone%n_points, 'contact point')
      if (any(cache%body%zone%pairs%is_alone)) size_text = size_text//' at corners alone'
      if (config%accuracy%n_refinements > 0) size_text = size_text//', on the finest of '// &
         to_text(config%accuracy%n_refinements + 1)//' meshes'
      outcome%text = config%name//': deck OK; '//size_text//cases//'; '//text
   end subroutine report_size

   !> Prefixes the message of an error in body, solution or files with the name of the deck.
   pure subroutine conclude(outcome, error)
      type(outcome_t), intent(inout) :: outcome !! the outcome
      type(error_t), allocatable, intent(in) :: error !! what went wrong, where anything did

      if (allocated(error)) call outcome%fail(error)
      if (len(outcome%message) == 0 .or. index(outcome%message, outcome%deck) == 1) return
      outcome%message = outcome%deck//': '//outcome%message
   end subroutine conclude

   !> Whether the study writes grids NAME.vtu and NAME.contact.vtu.
   pure logical function study_has_grids(self) result(has_grids)
      class(study_t), intent(in) :: self !! the study

      has_grids = .not. (self%config%reduced%is_given .or. self%config%sweep%is_given())
   end function study_has_grids

   !> Refuses options that exist for single cases at the places of rest only.
   pure subroutine refuse_options(config, options, error)
      type(config_t), intent(in) :: config !! the deck
      type(study_options_t), intent(in) :: options !! what is asked for
      type(error_t), allocatable, intent(out) :: error !! an option does not go with the deck

      character(*), parameter :: names = '--write-reduced and --all-solutions '

      if (.not. (options%writes_reduced .or. options%wants_all_solutions)) return
      if (config%sweep%is_given() .or. config%history%is_given) then
         call new_error(error, input_refused, names//'take single cases, found a deck with '// &
            trim(merge('&history', '&sweep  ', config%history%is_given)))
      else if (allocated(config%contacts)) then
         if (any(config%contacts%slides_far())) call new_error(error, input_refused, names//'do not go with '// &
            "sliding = 'finite': there is no reduced problem without the places")
      end if
   end subroutine refuse_options

end module amontons_study
