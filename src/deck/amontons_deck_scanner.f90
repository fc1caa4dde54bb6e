!> Cuts the text of a deck into tokens: words, quoted texts, group names and punctuation.
module amontons_deck_scanner
   use amontons_text, only: lower_case, nearest_word, to_text
   implicit none (type, external)
   private

   public :: deck_scanner_t, deck_token_t, end_token, group_token, open_quote_token, text_token, word_token
   public :: column_text, excerpt, has_typographic_quote, is_name, joined, may_be_value, suggestion, token_text

   !> Kind of the token behind the last one.
   character, parameter :: end_token = ' '
   !> Kind of a group's opening: `&` and the name that touches it.
   character, parameter :: group_token = '&'
   !> Kind of a quoted text, its quotes included.
   character, parameter :: text_token = 't'
   !> Kind of the rest of a line behind a quote that does not close.
   character, parameter :: open_quote_token = 'o'
   !> Kind of everything else that blanks, commas and punctuation surround: keys, numbers, logicals.
   character, parameter :: word_token = 'w'

   character, parameter :: tab = achar(9), line_feed = achar(10), carriage_return = achar(13)
   character(*), parameter :: word_ends = ' ,/=*!&()"'//"'"//tab//line_feed//carriage_return
   integer, parameter :: excerpt_length = 60

   !> A piece of the deck's text.
   type :: deck_token_t
      character :: kind = end_token !! one of the kinds above, or the punctuation mark itself: one of `/=,()*`
      integer :: first = 1 !! position of its first character in the text
      integer :: last = 0 !! position of its last character in the text
      integer :: line = 1 !! line it stands on
      integer :: slash_line = 0 !! line of a comment before it that ends in '/', 0 for none
   end type deck_token_t

   !> A place in the deck's text, moving from token to token.
   type :: deck_scanner_t
      private
      integer :: position = 1 !! position of the next character
      integer :: line = 1 !! line of the next character
   contains
      procedure, public :: advance => deck_scanner_advance
   end type deck_scanner_t

contains

   !> Finds the next token.
   pure subroutine deck_scanner_advance(self, text, token)
      class(deck_scanner_t), intent(inout) :: self !! the place
      character(*), intent(in) :: text !! the deck's text
      type(deck_token_t), intent(out) :: token !! the token there

      call skip_blanks(self, text, token%slash_line)
      token%line = self%line
      token%first = self%position
      if (self%position > len(text)) then
         token%last = len(text)
         return
      end if
      select case (text(self%position:self%position))
      case ("'", '"')
         call find_closing_quote(text, token)
      case ('/', '=', ',', '(', ')', '*')
         token%kind = text(self%position:self%position)
         token%last = self%position
      case ('&')
         token%kind = group_token
         token%last = word_end(text, self%position + 1)
      case default
         token%kind = word_token
         token%last = word_end(text, self%position)
      end select
      self%position = token%last + 1
   end subroutine deck_scanner_advance

   !> Moves over blanks, comments and ends of lines.
   pure subroutine skip_blanks(self, text, slash_line)
      class(deck_scanner_t), intent(inout) :: self !! the place
      character(*), intent(in) :: text !! the deck's text
      integer, intent(out) :: slash_line !! line of a comment that ends in '/', 0 for none
      integer :: end, last

      slash_line = 0
      do while (self%position <= len(text))
         select case (text(self%position:self%position))
         case (' ', tab, carriage_return)
            self%position = self%position + 1
         case (line_feed)
            self%position = self%position + 1
            self%line = self%line + 1
         case ('!')
            last = line_end(text, self%position)
            end = self%position - 1 + verify(text(self%position:last), ' '//tab, back=.true.)
            if (text(end:end) == '/') slash_line = self%line
            self%position = last + 1
         case default
            return
         end select
      end do
   end subroutine skip_blanks

   !> Completes the token of a quoted text, which closes on its own line; a doubled quote inside stands for one.
   pure subroutine find_closing_quote(text, token)
      character(*), intent(in) :: text !! the deck's text
      type(deck_token_t), intent(inout) :: token !! the token, its first position known
      character :: quote
      integer :: next, last

      quote = text(token%first:token%first)
      last = line_end(text, token%first)
      token%kind = text_token
      token%last = token%first
      do
         next = index(text(token%last + 1:last), quote)
         if (next == 0) exit
         token%last = token%last + next
         if (token%last == last) return
         if (text(token%last + 1:token%last + 1) /= quote) return
         token%last = token%last + 1
      end do
      token%kind = open_quote_token
      token%last = last
   end subroutine find_closing_quote

   !> Position of the last character of a word.
   pure integer function word_end(text, start)
      character(*), intent(in) :: text !! the deck's text
      integer, intent(in) :: start !! position in the word
      integer :: length

      length = scan(text(start:), word_ends) - 1
      word_end = merge(start + length - 1, len(text), length >= 0)
   end function word_end

   !> Position of the last character of a line, its end not counted.
   pure integer function line_end(text, start)
      character(*), intent(in) :: text !! the deck's text
      integer, intent(in) :: start !! position in the line
      integer :: length

      length = scan(text(start:), carriage_return//line_feed) - 1
      line_end = merge(start + length - 1, len(text), length >= 0)
   end function line_end

   !> Whether a word can be the name of a key: a letter, then letters, digits and underscores.
   pure logical function is_name(word)
      character(*), intent(in) :: word !! the word, in lower case
      character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz'

      is_name = scan(word(1:1), letters) > 0 .and. verify(word, letters//'0123456789_') == 0
   end function is_name

   !> Whether a word looks like a number or a logical; whether it is one, its key decides.
   pure logical function may_be_value(word)
      character(*), intent(in) :: word !! the word
      character(*), parameter :: words(*) = [character(8) :: 't', 'f', 'true', 'false', 'nan', 'inf', 'infinity']

      may_be_value = scan(word(1:1), '0123456789+-.') > 0
      if (.not. may_be_value) may_be_value = any(words == lower_case(word))
   end function may_be_value

   !> Whether a word has a quote as word processors write it: the UTF-8 characters U+2018 to U+201F, U+00AB or U+00BB.
   pure logical function has_typographic_quote(word) result(has)
      character(*), intent(in) :: word !! the word
      character(*), parameter :: general = char(226)//char(128), latin = char(194)
      integer :: code

      has = index(word, latin//char(171)) > 0 .or. index(word, latin//char(187)) > 0
      do code = 152, 159
         has = has .or. index(word, general//char(code)) > 0
      end do
   end function has_typographic_quote

   !> A token as a message names it: as written, punctuation in quotes.
   pure function token_text(text, token) result(name)
      character(*), intent(in) :: text !! the deck's text
      type(deck_token_t), intent(in) :: token !! the token
      character(:), allocatable :: name

      select case (token%kind)
      case (end_token)
         name = 'the end of the deck'
      case ('/', '=', ',', '(', ')', '*')
         name = "'"//text(token%first:token%last)//"'"
      case default
         name = excerpt(text(token%first:token%last))
      end select
   end function token_text

   !> Where a message says that something stands in its line: ` (column 9)`, counted in bytes from 1.
   pure function column_text(text, position) result(place)
      character(*), intent(in) :: text !! the deck's text
      integer, intent(in) :: position !! position in the text
      character(:), allocatable :: place

      place = ' (column '//to_text(position - index(text(:position - 1), line_feed, back=.true.))//')'
   end function column_text

   !> The beginning of a text, short enough for a message; no UTF-8 character is cut in two.
   pure function excerpt(text) result(beginning)
      character(*), intent(in) :: text !! any text
      character(:), allocatable :: beginning
      integer, parameter :: first_continuation = 128, last_continuation = 191
      integer :: length, code

      beginning = text
      if (len(text) <= excerpt_length) return
      do length = excerpt_length, 1, -1
         code = iachar(text(length + 1:length + 1))
         if (code < first_continuation .or. code > last_continuation) exit
      end do
      beginning = text(:length)//'...'
   end function excerpt

   !> What a message about an unknown word adds: the known word that other programs call so, one that is near or begins
   !> alike, or all known words.
   pure function suggestion(word, words, also, before, noun) result(text)
      character(*), intent(in) :: word !! the word found, in lower case
      character(*), intent(in) :: words(:) !! the words known
      character(*), intent(in) :: also(:) !! what other programs call each of them, blanks between the words
      character(*), intent(in) :: before !! what the message puts before a word
      character(*), intent(in) :: noun !! what the words are
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(words)
         if (len(word) == 0 .or. index(' '//trim(also(i))//' ', ' '//word//' ') == 0) cycle
         text = trim(words(i))
         exit
      end do
      if (text == '') text = nearest_word(word, words)
      if (text == '') text = word_that_begins_alike(word, words)
      if (text /= '') then
         text = '; did you mean '//before//text//'?'
      else
         text = ' ('//noun//': '//joined(words, before, '')//')'
      end if
   end function suggestion

   !> The only known word that begins with the whole of another, or is the first part of it, before an underscore; empty
   !> where there is none or more than one.
   pure function word_that_begins_alike(word, words) result(alike)
      character(*), intent(in) :: word !! the other word
      character(*), intent(in) :: words(:) !! the words known
      character(:), allocatable :: alike
      ! A shorter beginning says little.
      integer, parameter :: shortest = 4
      integer :: i

      alike = ''
      if (len(word) < shortest) return
      do i = 1, size(words)
         if (index(words(i), word) /= 1 .and. index(word, trim(words(i))//'_') /= 1) cycle
         if (alike /= '') then
            alike = ''
            return
         end if
         alike = trim(words(i))
      end do
   end function word_that_begins_alike

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

end module amontons_deck_scanner
