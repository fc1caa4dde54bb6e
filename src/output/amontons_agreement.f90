!> When a stated number and the one that follows from other files are taken for the same, and what is said otherwise.
!>
!> In the build that wrote the files they agree to the last bit but where the solver went another way: its displacements
!> of the contact points come from the small problem, those of the check from the whole body. Other compilers round
!> otherwise. Both differences are far below 1e-8 of the largest number of a kind, below which no certificate speaks.
module amontons_agreement
   use amontons_kinds, only: dp
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: agree, contradiction, first_disagreement

   !> Largest difference of two numbers that agree, over the largest number of their kind [-].
   real(dp), parameter :: limit = 1.0e-8_dp

contains

   !> Whether two numbers agree. One that is not finite agrees with none.
   elemental logical function agree(stated, computed, scale)
      real(dp), intent(in) :: stated !! the number that a file states
      real(dp), intent(in) :: computed !! the number that follows from the others
      real(dp), intent(in) :: scale !! the largest number of their kind, or more

      agree = abs(stated - computed) <= limit*scale
   end function agree

   !> The place of the first number that does not agree, the largest of them being the scale; 0 if all do.
   pure integer function first_disagreement(stated, computed, scale) result(place)
      real(dp), intent(in) :: stated(:) !! the numbers that a file states
      real(dp), intent(in) :: computed(:) !! the numbers that follow from the others, as many
      real(dp), intent(in), optional :: scale !! the largest number of their kind, if not among them
      real(dp) :: largest

      largest = 0.0_dp
      if (size(computed) > 0) largest = maxval(abs(computed))
      if (present(scale)) largest = max(largest, scale)
      do place = 1, size(stated)
         if (.not. agree(stated(place), computed(place), largest)) return
      end do
      place = 0
   end function first_disagreement

   !> What is said of two numbers that do not agree.
   pure function contradiction(what, stated, computed) result(sentence)
      character(*), intent(in) :: what !! what they are
      real(dp), intent(in) :: stated !! the number that a file states
      real(dp), intent(in) :: computed !! the number that follows from the others
      character(:), allocatable :: sentence

      sentence = what//' is '//shown(stated)//', but '//shown(computed)//' follows from the other files'
   end function contradiction

   !> A number, if it is one.
   pure function shown(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      if (abs(value) <= huge(value)) then
         text = to_text(value)
      else
         text = 'not a finite number'
      end if
   end function shown

end module amontons_agreement
