!> Warnings: what a user should know before trusting a result that is otherwise in order, a sentence each.
module amontons_warning_list
   use amontons_kinds, only: dp
   use amontons_text, only: newline, pair_text, short_text, with_unit
   implicit none (type, external)
   private

   public :: warning_list_t

   !> Warnings in the order in which they were found.
   type :: warning_list_t
      private
      character(:), allocatable :: text !! the sentences, each with a line end behind it; not allocated without any
      character(:), allocatable, public :: units !! names of the units of the case; may be left out
   contains
      procedure :: add => warning_list_add
      procedure :: item => warning_list_item
      procedure :: n => warning_list_n
      procedure :: number => warning_list_number
      procedure :: place => warning_list_place
   end type warning_list_t

contains

   !> Adds a warning.
   pure subroutine warning_list_add(self, sentence)
      class(warning_list_t), intent(inout) :: self !! the warnings
      character(*), intent(in) :: sentence !! the warning, a sentence without a line end

      if (.not. allocated(self%text)) self%text = ''
      self%text = self%text//sentence//newline
   end subroutine warning_list_add

   !> A number for a warning, with its unit where the case names it.
   pure function warning_list_number(self, value, dimension) result(text)
      class(warning_list_t), intent(in) :: self !! the warnings
      real(dp), intent(in) :: value !! the number
      character(*), intent(in) :: dimension !! its dimension, as `unit_of` reads it
      character(:), allocatable :: text

      text = short_text(value)
      if (allocated(self%units)) text = with_unit(text, self%units, dimension)
   end function warning_list_number

   !> A place for a warning, with its unit where the case names it.
   pure function warning_list_place(self, position) result(text)
      class(warning_list_t), intent(in) :: self !! the warnings
      real(dp), intent(in) :: position(2) !! the place [L]
      character(:), allocatable :: text

      text = pair_text(position)
      if (allocated(self%units)) text = with_unit(text, self%units, 'L')
   end function warning_list_place

   !> Number of warnings.
   pure integer function warning_list_n(self) result(n)
      class(warning_list_t), intent(in) :: self !! the warnings
      integer :: i

      n = 0
      if (.not. allocated(self%text)) return
      do i = 1, len(self%text)
         if (self%text(i:i) == newline) n = n + 1
      end do
   end function warning_list_n

   !> One of the warnings.
   pure function warning_list_item(self, number) result(sentence)
      class(warning_list_t), intent(in) :: self !! the warnings
      integer, intent(in) :: number !! which one, 1 to `n`
      character(:), allocatable :: sentence
      integer :: first, i

      first = 1
      do i = 1, number - 1
         first = first + index(self%text(first:), newline)
      end do
      sentence = self%text(first:first + index(self%text(first:), newline) - 2)
   end function warning_list_item

end module amontons_warning_list
