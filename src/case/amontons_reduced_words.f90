!> Words of a reduced problem's text file, taken one after the other across lines.
module amontons_reduced_words
   use amontons_mesh_source, only: mesh_source_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: refuse_word, take_choice, take_number, take_word

contains

   !> Takes the next integer.
   pure subroutine take_number(source, value, what)
      type(mesh_source_t), intent(inout) :: source !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! what it means, for the message

      call source%skip_white()
      call source%take_numeral(value, what)
   end subroutine take_number

   !> Takes the next integer, which must be one of a few.
   pure subroutine take_choice(source, value, what, choices)
      type(mesh_source_t), intent(inout) :: source !! the file
      integer, intent(out) :: value !! the number
      character(*), intent(in) :: what !! what it means, for the message
      integer, intent(in) :: choices(:) !! the numbers that are right

      call take_number(source, value, what)
      if (.not. any(choices == value)) call refuse_word(source, 'expected '//what//', found '//to_text(value))
   end subroutine take_choice

   !> Refuses the word just taken.
   pure subroutine refuse_word(source, sentence)
      type(mesh_source_t), intent(inout) :: source !! the file
      character(*), intent(in) :: sentence !! what is wrong

      call source%refuse(sentence, max(1, source%position - 1))
   end subroutine refuse_word

   !> Takes a given word.
   pure subroutine take_word(source, word)
      type(mesh_source_t), intent(inout) :: source !! the file
      character(*), intent(in) :: word !! the word
      integer :: last

      if (allocated(source%error)) return
      call source%skip_white()
      last = min(source%position + len(word) - 1, len(source%text))
      if (source%text(source%position:last) == word) then
         source%position = last + 1
      else
         call source%refuse("expected '"//word//"', found "//source%word())
      end if
   end subroutine take_word

end module amontons_reduced_words
