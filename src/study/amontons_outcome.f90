!> The outcome of a deck: what became of it, whatever kind of study it asks for.
module amontons_outcome
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t, numerical_failure, warning_list_t
   use amontons_kinds, only: dp
   use amontons_outcome_words, only: solution_word, word_no_equilibrium, word_not_certified, word_not_converged, &
      word_solved
   use amontons_quantity, only: quantity_t
   use amontons_result, only: certificate_limit, status_not_converged
   use amontons_text, only: counted, scientific
   implicit none (type, external)
   private

   public :: find_exit_status, method_numbers, outcome_t, solution_line, word_no_equilibrium, &
      word_not_certified, word_not_converged, word_solved

   !> Exit status of a study that was interrupted; the same command goes on with it.
   integer, parameter, public :: status_interrupted = 5

   !> What became of a deck.
   type :: outcome_t
      character(:), allocatable :: deck !! name of the deck
      character(:), allocatable :: name !! name of its case; empty where the deck could not be read
      integer :: status = 0 !! exit status that the deck alone would give
      character(:), allocatable :: word !! what became of it in a word, as batch.csv has it
      character(:), allocatable :: text !! the line on its result; empty without a result
      character(:), allocatable :: message !! what went wrong, beginning with the name of the deck; empty if nothing did
      type(quantity_t), allocatable :: numbers(:) !! numbers of the result; not allocated without a result
      real(dp) :: seconds = 0.0_dp !! time that the deck took [s]
      type(warning_list_t) :: warnings !! what is doubtful about model and result
      logical :: has_grids = .false. !! whether a single converged case left the grids NAME.vtu and NAME.contact.vtu
   contains
      procedure :: begin => outcome_begin
      procedure :: fail => outcome_fail
      procedure :: interrupt => outcome_interrupt
      procedure :: lack => outcome_lack
      procedure :: judge => outcome_judge
   end type outcome_t

contains

   !> Begins the outcome of a deck: nothing happened yet.
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

   !> Takes over an error.
   pure subroutine outcome_fail(self, error)
      class(outcome_t), intent(inout) :: self !! the outcome
      type(error_t), intent(in) :: error !! the error
      character(*), parameter :: words(3) = [character(17) :: 'refused', 'numerical_failure', 'system_failure']

      self%word = trim(words(error%kind))
      self%status = error%kind
      self%message = error%message
   end subroutine outcome_fail

   !> Notes that the study was interrupted.
   pure subroutine outcome_interrupt(self, place)
      class(outcome_t), intent(inout) :: self !! the outcome
      character(*), intent(in) :: place !! what it had come to: 'step 3'

      self%status = status_interrupted
      self%word = 'interrupted'
      self%message = 'interrupted after '//place//'; the same command goes on from there'
   end subroutine outcome_interrupt

   !> Notes that there is no solution, or none of every step or row: status 2 without equilibrium, otherwise 4.
   pure subroutine outcome_lack(self, word, message)
      class(outcome_t), intent(inout) :: self !! the outcome
      character(*), intent(in) :: word !! `word_no_equilibrium` or `word_not_converged`
      character(*), intent(in) :: message !! what is lacking

      self%status = merge(numerical_failure, status_not_converged, word == word_no_equilibrium)
      self%word = word
      self%message = message
   end subroutine outcome_lack

   !> Takes over the judgment of a solution.
   pure subroutine outcome_judge(self, is_converged, residual, violation, tolerance)
      class(outcome_t), intent(inout) :: self !! the outcome
      logical, intent(in) :: is_converged !! whether the method converged
      real(dp), intent(in) :: residual !! its residual [-]
      real(dp), intent(in) :: violation !! largest violation found on the full model, or on the problem as read [-]
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]

      call find_exit_status(is_converged, residual, violation, tolerance, self%status, self%message)
      if (self%status /= 0) self%word = solution_word(is_converged, .false.)
   end subroutine outcome_judge

   !> Iterations and residual of a solution.
   pure function method_numbers(solution) result(numbers)
      type(contact_solution_t), intent(in) :: solution !! the solution
      type(quantity_t) :: numbers(2)

      numbers = [quantity_t('iterations', '', real(solution%n_iterations, dp)), &
         quantity_t('residual', '', solution%residual)]
   end function method_numbers

   !> The beginning of the line on the result of a case: whether it was solved, and how.
   pure function solution_line(name, solution) result(text)
      character(*), intent(in) :: name !! name of the case
      type(contact_solution_t), intent(in) :: solution !! the solution
      character(:), allocatable :: text

      text = name//': '//trim(merge('solved       ', 'NOT CONVERGED', solution%is_converged))//', '// &
         counted(solution%n_iterations, 'iteration')//', residual '//scientific(solution%residual)
   end function solution_line

   !> The exit status of a solution, and what it lacks. That a solution has status 4 is decided
   !> here; that there is none, by `outcome_lack`.
   pure subroutine find_exit_status(is_converged, residual, violation, tolerance, status, fault)
      logical, intent(in) :: is_converged !! whether the method converged
      real(dp), intent(in) :: residual !! its residual [-]
      real(dp), intent(in) :: violation !! largest violation found on the full model, or on the problem as read [-]
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]
      integer, intent(out) :: status !! 0 or `status_not_converged`
      character(:), allocatable, intent(out) :: fault !! what the solution lacks; empty if nothing
      ! A residual of sums of some hundred products; seldom is it less.
      real(dp), parameter :: rounding = 1.0e-14_dp

      status = status_not_converged
      if (.not. is_converged) then
         fault = 'not converged: residual '//scientific(residual)//', tolerance '//scientific(tolerance)
         if (tolerance < rounding) fault = fault//', which is below rounding (about '//scientific(rounding)//')'
      else if (.not. violation <= certificate_limit(tolerance)) then
         fault = 'the certificate FAILED: largest violation '//scientific(violation)//', limit '// &
            scientific(certificate_limit(tolerance))//'; see the listing'
      else
         status = 0
         fault = ''
      end if
   end subroutine find_exit_status

end module amontons_outcome
