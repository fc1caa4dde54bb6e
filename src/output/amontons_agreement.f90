!> When a stated number and the one that follows from other files are taken for the same, and what is said otherwise.
!>
!> In the build that wrote the files they agree to the last bit but where the solver went another way: its displacements
!> of the contact points come from the small problem, those of the check from the whole body. Other compilers round
!> otherwise. Both differences are far below 1e-8 of the largest number of a kind, below which no certificate speaks.
module amontons_agreement
   use amontons_kinds, only: dp
   use amontons_text, only: newline, to_text
   implicit none (type, external)
   private

   public :: agree, contradiction, fault_text_t, first_disagreement

   !> Largest difference of two numbers that agree, over the largest number of their kind [-].
   real(dp), parameter :: limit = 1.0e-8_dp

   !> How many faults are told: the first ones show what was changed, the others only how much.
   integer, parameter :: most_told = 20

   !> A fault.
   type :: fault_t
      character(:), allocatable :: text !! what is wrong with which file, lines of text
   end type fault_t

   !> Faults found so far.
   type :: fault_text_t
      private
      type(fault_t) :: told(most_told) !! the first of them
      integer, public :: n = 0 !! number of faults
   contains
      procedure, public :: add => fault_text_add
      procedure, public :: append => fault_text_append
      procedure, public :: text => fault_text_text
   end type fault_text_t

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

   !> Adds a fault.
   pure subroutine fault_text_add(self, file, sentence)
      class(fault_text_t), intent(inout) :: self !! the faults
      character(*), intent(in) :: file !! name of the file
      character(*), intent(in) :: sentence !! what is wrong with it

      self%n = self%n + 1
      if (self%n <= most_told) self%told(self%n)%text = file//': '//printable(sentence)
   end subroutine fault_text_add

   !> A text that quotes what was changed, with question marks for all that is no letter, digit or sign.
   pure function printable(text)
      character(*), intent(in) :: text !! the text, lines
      character(len(text)) :: printable
      integer :: i

      printable = text
      do i = 1, len(text)
         if (text(i:i) == newline .or. (iachar(text(i:i)) >= 32 .and. iachar(text(i:i)) < 127)) cycle
         printable(i:i) = '?'
      end do
   end function printable

   !> Adds the faults of another list.
   pure subroutine fault_text_append(self, other)
      class(fault_text_t), intent(inout) :: self !! the faults
      type(fault_text_t), intent(in) :: other !! the other list
      integer :: i

      do i = 1, min(other%n, most_told - self%n)
         self%told(self%n + i)%text = other%told(i)%text
      end do
      self%n = self%n + other%n
   end subroutine fault_text_append

   !> The faults as lines of text, without the end of the last one; empty if there is none.
   pure function fault_text_text(self) result(text)
      class(fault_text_t), intent(in) :: self !! the faults
      character(:), allocatable :: text
      integer :: i

      text = ''
      if (self%n == 0) return
      text = self%told(1)%text
      do i = 2, min(self%n, most_told)
         text = text//newline//self%told(i)%text
      end do
      if (self%n > most_told) text = text//newline//to_text(self%n - most_told)//' more faults follow'
   end function fault_text_text

end module amontons_agreement
