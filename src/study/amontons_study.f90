!> A study: what a deck asks for, from its checked configuration to its files.
!>
!> Each kind extends `study_t` in a folder of its own; `new_study` chooses the kind of a deck.
module amontons_study
   use amontons_config, only: config_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_outcome, only: outcome_t
   use amontons_solve_case, only: cache_t
   use amontons_study_monitor, only: study_monitor_t
   implicit none (type, external)
   private

   public :: check_study, solve_study, study_options_t, study_t

   !> What is asked for besides the deck.
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
         type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the study needs another
         type(outcome_t), intent(inout) :: outcome !! gains its line and the warnings
         type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck
      end subroutine check_procedure

      !> Solves everything that the deck asks for and writes its files.
      subroutine solve_procedure(self, cache, options, monitor, outcome, error)
         import :: cache_t, error_t, outcome_t, study_monitor_t, study_options_t, study_t
         implicit none (type, external)
         class(study_t), intent(in) :: self !! the study
         type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the study needs another
         type(study_options_t), intent(in) :: options !! what is asked for besides the deck
         class(study_monitor_t), intent(inout) :: monitor !! learns how far a study of many cases is, and may stop it
         type(outcome_t), intent(inout) :: outcome !! gains status, line, what is lacking, and the warnings
         type(error_t), allocatable, intent(out) :: error !! the deck, the numbers or the disk are at fault
      end subroutine solve_procedure
   end interface

contains

   !> Checks a study; an error becomes its outcome.
   subroutine check_study(study, cache, options, outcome)
      class(study_t), intent(in) :: study !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the study needs another
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
      type(outcome_t), intent(out) :: outcome !! what became of the deck
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
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the study needs another
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
      class(study_monitor_t), intent(inout) :: monitor !! learns how far a study of many cases is, and may stop it
      type(outcome_t), intent(out) :: outcome !! what became of the deck
      type(error_t), allocatable :: error

      call outcome%begin(study%config%file, study%config%name)
      call refuse_options(study%config, options, error)
      if (.not. allocated(error)) call study%solve(cache, options, monitor, outcome, error)
      call conclude(outcome, error)
   end subroutine solve_study

   !> Puts the name of the deck before what went wrong with its body, its solution or its files.
   pure subroutine conclude(outcome, error)
      type(outcome_t), intent(inout) :: outcome !! the outcome
      type(error_t), allocatable, intent(in) :: error !! what went wrong, where anything did

      if (allocated(error)) call outcome%fail(error)
      if (len(outcome%message) == 0 .or. index(outcome%message, outcome%deck) == 1) return
      outcome%message = outcome%deck//': '//outcome%message
   end subroutine conclude

   !> Whether the study leaves grids NAME.vtu and NAME.contact.vtu.
   pure logical function study_has_grids(self) result(has_grids)
      class(study_t), intent(in) :: self !! the study

      has_grids = .not. (self%config%reduced%is_given .or. self%config%sweep%is_given())
   end function study_has_grids

   !> Refuses what is asked for besides a deck of many cases or steps, and is there for single cases only.
   pure subroutine refuse_options(config, options, error)
      type(config_t), intent(in) :: config !! the deck
      type(study_options_t), intent(in) :: options !! what is asked for
      type(error_t), allocatable, intent(out) :: error !! an option does not go with the deck

      if (.not. (config%sweep%is_given() .or. config%history%is_given)) return
      if (options%writes_reduced .or. options%wants_all_solutions) call new_error(error, input_refused, &
         '--write-reduced and --all-solutions take single cases, found a deck with '// &
         trim(merge('&history', '&sweep  ', config%history%is_given)))
   end subroutine refuse_options

end module amontons_study
