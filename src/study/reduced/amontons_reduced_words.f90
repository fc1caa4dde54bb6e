!> Words of a reduced problem's text file, taken one after the other across lines.
module amontons_reduced_words
   use amontons_input_file, only: input_file_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: refuse_word, take_choice, take_number, take_word

contains

   !> Takes the next integer.
   pure subroutine take_number(input, value, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the number, 0 where there is a fault
      character(*), intent(in) :: what !! what it means, for the message

      call input%skip_white()
      call input%take_numeral(value, what)
   end subroutine take_number

   !> Takes the next integer, which must be one of a few.
   pure subroutine take_choice(input, value, what, choices)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: value !! the number
      character(*), intent(in) :: what !! what it means, for the message
      integer, intent(in) :: choices(:) !! the numbers that are right

      call take_number(input, value, what)
      if (.not. any(choices == value)) call refuse_word(input, 'expected '//what//', found '//to_text(value))
   end subroutine take_choice

   !> Refuses the word just taken.
   pure subroutine refuse_word(input, sentence)
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: sentence !! what is wrong

      call input%refuse(sentence, max(1, input%position - 1))
   end subroutine refuse_word

   !> Takes a given word.
   pure subroutine take_word(input, word)
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: word !! the word
      integer :: last

      if (allocated(input%error)) return
      call input%skip_white()
      last = min(input%position + len(word) - 1, len(input%text))
      if (input%text(input%position:last) == word) then
         input%position = last + 1
      else
         call input%refuse("expected '"//word//"', found "//input%word())
      end if
   end subroutine take_word

end module amontons_reduced_words
