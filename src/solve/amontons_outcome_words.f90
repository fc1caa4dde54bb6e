!> What became of a case, of a row of a sweep or of a deck, in a word: one list for all files.
module amontons_outcome_words
   implicit none (type, external)
   private

   public :: has_converged, outcome_names, solution_word

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

end module amontons_outcome_words
