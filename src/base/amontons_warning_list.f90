!> Warnings: what a user should know before trusting a result that is otherwise in order, a sentence each.
module amontons_warning_list
   use amontons_text, only: newline
   implicit none (type, external)
   private

   public :: warning_list_t

   !> Warnings in the order in which they were found.
   type :: warning_list_t
      private
      character(:), allocatable :: text !! the sentences, each with a line end behind it; not allocated without any
   contains
      procedure :: add => warning_list_add
      procedure :: item => warning_list_item
      procedure :: n => warning_list_n
   end type warning_list_t

contains

   !> Adds a warning.
   pure subroutine warning_list_add(self, sentence)
      class(warning_list_t), intent(inout) :: self !! the warnings
      character(*), intent(in) :: sentence !! the warning, a sentence without a line end

      if (.not. allocated(self%text)) self%text = ''
      self%text = self%text//sentence//newline
   end subroutine warning_list_add

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
