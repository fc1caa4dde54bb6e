!> A study: what a deck asks for, from its checked configuration to its files.
!>
!> Each kind extends `study_t` in a folder of its own; `new_study` chooses the kind of a deck.
module amontons_study
   use amontons_body, only: body_t, estimate_body, estimate_t
   use amontons_config, only: config_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_outcome, only: outcome_t
   use amontons_result, only: result_t
   use amontons_solve_case, only: cache_t
   use amontons_study_monitor, only: study_monitor_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: check_study, report_size, solve_study, study_options_t, study_t

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

   !> Reports the size of a deck with a body that is ready to be condensed.
   subroutine report_size(config, cases, cache, result, outcome, error)
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: cases !! the cases it has, as they are reported: ', 12 cases'; empty for one
      type(cache_t), intent(inout) :: cache !! its body
      type(result_t), intent(inout) :: result !! the load case as it was prepared
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! the body is not held
      type(estimate_t) :: estimate
      integer :: n_dense

      n_dense = dense_matrices(config%method%method)
      call estimate_body(cache%body, config%condensation, n_dense, result%timings, estimate, error)
      if (allocated(error)) return
      outcome%warnings = result%warnings
      outcome%text = config%name//': deck OK; '//size_text(cache%body)//cases//'; '// &
         estimate_text(estimate, n_dense > 0)
   end subroutine report_size

   !> How many dense matrices of the contact points a method holds; 0 for Newton's, which works on a band, too.
   pure integer function dense_matrices(method) result(n)
      character(*), intent(in) :: method !! name of the method

      select case (method)
      case ('auto', 'newton')
         n = 0
      case ('lemke')
         ! Compliance and tableau, of twice as many rows.
         n = 7
      case ('fixed_point')
         n = 4
      case default
         n = 2
      end select
   end function dense_matrices

   !> The size of a body.
   pure function size_text(body) result(text)
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable :: text

      text = to_text(body%mesh%n_nodes)//' nodes, '//to_text(body%mesh%n_elements)//' elements, '// &
         to_text(body%dof_map%n_dofs)//' unknowns, '//to_text(body%zone%n_points)//' contact points'
   end function size_text

   !> What solving it would take.
   pure function estimate_text(estimate, is_dense) result(text)
      type(estimate_t), intent(in) :: estimate !! what solving the deck would take
      logical, intent(in) :: is_dense !! whether the method makes a dense matrix of a band
      character(:), allocatable :: text

      if (estimate%half_width > 0) then
         text = 'band contact matrix of '//to_text(estimate%n_rows)//' rows with half width '// &
            to_text(estimate%half_width)
         if (is_dense) text = text//', made dense for the method'
      else
         text = 'dense contact matrix of '//to_text(estimate%n_rows)//' rows'
      end if
      text = text//', '//estimate%factorization//' factor of '//to_text(estimate%n_entries)//' entries, about '// &
         to_text(ceiling(estimate%memory_mb))//' MB of memory'
      if (estimate%n_ranks > 1) text = text//' on each of '//to_text(estimate%n_ranks)//' ranks at most'
      if (estimate%memory_mb > estimate%available_mb) text = text//', but only '// &
         to_text(floor(estimate%available_mb))//' MB are available'
   end function estimate_text

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
