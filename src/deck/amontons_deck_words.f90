!> Lists of known words in the messages about a deck.
module amontons_deck_words
   use amontons_text, only: nearest_word
   implicit none (type, external)
   private

   public :: joined, suggestion

contains

   !> What a message about an unknown word adds: the known word that is near, or all known words where none is.
   pure function suggestion(word, words, before, noun) result(text)
      character(*), intent(in) :: word !! the word found, in lower case
      character(*), intent(in) :: words(:) !! the words known
      character(*), intent(in) :: before !! what the message puts before a word
      character(*), intent(in) :: noun !! what the words are
      character(:), allocatable :: text

      text = nearest_word(word, words)
      if (text /= '') then
         text = '; did you mean '//before//text//'?'
      else
         text = ' ('//noun//': '//joined(words, before, '')//')'
      end if
   end function suggestion

   !> Words separated by commas.
   pure function joined(words, before, behind) result(text)
      character(*), intent(in) :: words(:) !! the words, blank padded
      character(*), intent(in) :: before !! what is put before each word
      character(*), intent(in) :: behind !! what is put behind each word
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(words)
         if (i > 1) text = text//', '
         text = text//before//trim(words(i))//behind
      end do
      if (text == '') text = 'none'
   end function joined

end module amontons_deck_words
