!> Lists of known words in the messages about a deck.
module amontons_deck_words
   use amontons_text, only: nearest_word
   implicit none (type, external)
   private

   public :: joined, suggestion, words_of

contains

   !> What a message adds where a known word is near the one found.
   pure function suggestion(word, words, before, behind) result(text)
      character(*), intent(in) :: word !! the word found, in lower case
      character(*), intent(in) :: words(:) !! the words known
      character(*), intent(in) :: before !! what the message puts before a word
      character(*), intent(in) :: behind !! what the message puts behind a word
      character(:), allocatable :: text

      text = nearest_word(word, words)
      if (text /= '') text = '; did you mean '//before//text//behind//'?'
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

   !> The words of a list that has one blank before and behind each.
   pure function words_of(list) result(words)
      character(*), intent(in) :: list !! the list
      character(len(list)), allocatable :: words(:)
      integer :: i, first, last

      allocate (words(count([(list(i:i) == ' ', i=1, len(list))]) - 1))
      last = 0
      do i = 1, size(words)
         first = last + 2
         last = first + index(list(first:), ' ') - 2
         words(i) = list(first:last)
      end do
   end function words_of

end module amontons_deck_words
