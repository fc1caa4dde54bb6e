!> What became of a case, of a row of a sweep or of a deck, in a word: one list for all files.
module amontons_outcome_words
   implicit none (type, external)
   private

   public :: has_converged, solution_word

   !> Solved: the residual is at most the tolerance, and the certificate, where there is one, passes.
   character(*), parameter, public :: word_solved = 'solved'
   !> Contact and friction cannot balance the loads.
   character(*), parameter, public :: word_no_equilibrium = 'no_equilibrium'
   !> The residual is above the tolerance, or a step of a history cannot be taken.
   character(*), parameter, public :: word_not_converged = 'not_converged'
   !> Converged, but a violation of the certificate is above its limit.
   character(*), parameter, public :: word_not_certified = 'not_certified'

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
