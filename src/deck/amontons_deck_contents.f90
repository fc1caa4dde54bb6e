!> The parsed text of a deck: tokens (words, quoted texts, group names and punctuation), and the groups, assignments and
!> values that they form, each with its position in the text.
module amontons_deck_contents
   use amontons_error, only: fault_list_t
   use amontons_kinds, only: int64
   use amontons_text, only: counted, lower_case, nearest_word, read_integer, to_text
   implicit none (type, external)
   private

   public :: bare_value, deck_contents_t, excerpt, find_key, find_values, is_name, joined, mark_faulty, parse_deck, &
      refuse_value, suggestion, unquoted_value

   !> Kind of a token: the end of the text.
   character, parameter :: end_token = ' '
   !> Kind of a token: the opening of a group, `&` directly followed by its name.
   character, parameter :: group_token = '&'
   !> Kind of a token: a quoted text, its quotes included.
   character, parameter :: text_token = 't'
   !> Kind of a token: the rest of a line behind a quote that is not closed.
   character, parameter :: open_quote_token = 'o'
   !> Kind of a token: any other sequence of characters between blanks, commas and punctuation, that is, a key, a number
   !> or a logical.
   character, parameter :: word_token = 'w'

   character, parameter :: tab = achar(9), line_feed = achar(10), carriage_return = achar(13)
   character(*), parameter :: word_ends = ' ,/=*!&()"'//"'"//tab//line_feed//carriage_return
   integer, parameter :: excerpt_length = 60

   !> Largest number of groups; a deck with more is faulty, since no body has as many loads.
   integer, parameter :: most_groups = 10000
   !> The longest text in quotes; names of files end there.
   integer, parameter :: longest_text = 4096

   !> A piece of the deck's text.
   type :: deck_token_t
      character :: kind = end_token !! one of the kinds above, or the punctuation mark itself: one of `/=,()*`
      integer :: first = 1 !! position of its first character in the text
      integer :: last = 0 !! position of its last character in the text
      integer :: line = 1 !! its line
      integer :: slash_line = 0 !! line of a comment before it that ends in '/', 0 for none
   end type deck_token_t

   !> A position in the deck's text: the current token and the next one.
   type :: cursor_t
      integer :: position = 1 !! position of the next character, behind the two tokens
      integer :: line = 1 !! line of the next character
      type(deck_token_t) :: token !! the token being read
      type(deck_token_t) :: ahead !! the token behind it
      logical :: has_open_quote = .false. !! whether a quote of the group does not close and so may hide its end
      integer :: slash_line = 0 !! line of a comment in the group that ends in '/', 0 for none
   end type cursor_t

   !> A value as it is written.
   type :: deck_value_t
      integer :: first = 1 !! position of its first character in the text, the quote of a quoted text
      integer :: last = 0 !! position of its last character in the text
      integer :: line = 0 !! its line
      integer :: n_times = 1 !! its repeat count: 2 for `2*0.0`
      logical :: is_text = .false. !! whether it is in quotes
   end type deck_value_t

   !> A key and the values given to it.
   type :: deck_assignment_t
      character(:), allocatable :: key !! name of the key, in lower case
      integer :: line = 0 !! line of the key
      integer :: first = 1 !! position of its first character in the text
      integer :: subscript = 0 !! subscript the values start at, 0 where none is written
      integer :: first_value = 1 !! its first value
      integer :: last_value = 0 !! its last value
      logical :: is_faulty = .false. !! whether a fault of its form has been recorded
   end type deck_assignment_t

   !> A group of assignments.
   type :: deck_group_t
      character(:), allocatable :: name !! name of the group without `&`, in lower case
      integer :: line = 0 !! line of its name
      integer :: last = 0 !! position of the last character before its end
      integer :: first_assignment = 1 !! its first assignment
      integer :: last_assignment = 0 !! its last assignment
      integer :: last_judged = 0 !! its last assignment before a fault of form: what follows may belong elsewhere
      logical :: is_malformed = .false. !! whether its form is faulty
      logical :: is_faulty = .false. !! whether a fault of meaning has been recorded
      logical :: has_unknown_key = .false. !! whether a key is none of the group's
   end type deck_group_t

   !> Groups, assignments and values of a deck, in their order.
   type :: deck_contents_t
      character(:), allocatable :: text !! the whole text
      type(deck_group_t), allocatable :: groups(:) !! the groups, `n_groups` of them
      type(deck_assignment_t), allocatable :: assignments(:) !! the assignments, `n_assignments` of them
      type(deck_value_t), allocatable :: values(:) !! the values, `n_values` of them
      integer :: n_groups = 0 !! number of groups
      integer :: n_assignments = 0 !! number of assignments
      integer :: n_values = 0 !! number of values
      logical :: hides_groups = .false. !! whether text that is no group, or an unknown one, may hide one
      type(fault_list_t) :: faults !! the faults of the deck
   end type deck_contents_t

contains

   !> Parses the text of a deck; errors of form become faults, and everything sound is kept.
   subroutine parse_deck(text, contents)
      character(*), intent(in) :: text !! the deck's text, its lines ended by LF or CRLF
      type(deck_contents_t), intent(out) :: contents !! its groups, assignments and values
      type(cursor_t) :: cursor
      logical :: is_plain
      type(deck_group_t) :: group
      character(:), allocatable :: next
      integer :: n_faults

      allocate (contents%groups(8), contents%assignments(64), contents%values(64))
      contents%text = text
      call check_characters(contents, is_plain)
      if (.not. is_plain) return
      call advance(cursor, text)
      call advance(cursor, text)
      if (cursor%token%kind == end_token) call contents%faults%add(0, 'expected a group such as &mesh, found none')
      do while (cursor%token%kind /= end_token)
         if (cursor%token%kind == group_token .and. .not. is_legacy_end(text, cursor%token)) then
            ! Reads a group and its end.
            n_faults = contents%faults%n
            group = deck_group_t()
            group%line = cursor%token%line
            group%name = lower_case(contents%text(cursor%token%first + 1:cursor%token%last))
            group%first_assignment = contents%n_assignments + 1
            cursor%has_open_quote = .false.
            cursor%slash_line = 0
            call advance(cursor, contents%text)
            call read_assignments(cursor, contents, group%last_judged)
            group%last_assignment = contents%n_assignments
            group%last = cursor%token%first - 1
            if (cursor%token%kind == '/' .or. is_legacy_end(contents%text, cursor%token)) then
               call advance(cursor, contents%text)
            else if (.not. cursor%has_open_quote) then
               next = "expected '/' before "//token_text(contents%text, cursor%token)
               if (cursor%token%kind /= end_token) next = next//' in line '//to_text(cursor%token%line)
               if (cursor%slash_line > 0) next = "the '/' in line "//to_text(cursor%slash_line)//' is inside a comment'
               call contents%faults%add(group%line, '&'//excerpt(group%name)//' is not closed: '//next)
            end if
            group%is_malformed = contents%faults%n > n_faults
            ! Behind a fault of form, the rest of the group may be the next one, its name spoiled.
            contents%hides_groups = contents%hides_groups .or. group%is_malformed
            ! A full list doubles its length; the second half is overwritten later.
            if (contents%n_groups == size(contents%groups)) contents%groups = [contents%groups, contents%groups]
            contents%n_groups = contents%n_groups + 1
            contents%groups(contents%n_groups) = group
         else
            next = 'expected a group such as &mesh'
            if (scan(text(cursor%token%first:cursor%token%first), '#%') > 0) next = next//' (comments begin with !)'
            call refuse_token(contents, next, cursor%token)
            contents%hides_groups = .true.
            do
               call advance(cursor, text)
               if (cursor%token%kind == end_token .or. cursor%token%kind == group_token) exit
            end do
         end if
         if (contents%n_groups < most_groups .or. cursor%token%kind == end_token) cycle
         call contents%faults%add(cursor%token%line, 'a deck has at most '//to_text(most_groups)//' groups, found more')
         contents%hides_groups = .true.
         exit
      end do
   end subroutine parse_deck

   !> Refuses control characters, which no text file has.
   subroutine check_characters(contents, is_plain)
      type(deck_contents_t), intent(inout) :: contents !! the deck
      logical, intent(out) :: is_plain !! whether there are none
      character(2), parameter :: utf_16_marks(2) = [char(255)//char(254), char(254)//char(255)]
      integer, parameter :: tab = 9, line_feed = 10, carriage_return = 13, blank = 32, delete = 127
      integer :: i, line, code

      line = 1
      is_plain = all(index(contents%text, utf_16_marks) /= 1) .or. index(contents%text(:min(4, len(contents%text))), &
         achar(0)) == 0
      if (.not. is_plain) then
         call contents%faults%add(0, 'expected UTF-8 text, found UTF-16; save the deck in another encoding')
         return
      end if
      do i = 1, len(contents%text)
         code = iachar(contents%text(i:i))
         if (code == line_feed) then
            line = line + 1
         else if (code == carriage_return) then
            is_plain = index(contents%text(i + 1:min(i + 1, len(contents%text))), achar(line_feed)) == 1
         else
            is_plain = (code >= blank .and. code /= delete) .or. code == tab
         end if
         if (is_plain) cycle
         call contents%faults%add(line, 'expected text, found the control character '//to_text(code)// &
            column_text(contents%text, i))
         return
      end do
   end subroutine check_characters

   !> Reads the assignments of a group up to its end, or up to a token that cannot belong to the group.
   subroutine read_assignments(cursor, contents, last_judged)
      type(cursor_t), intent(inout) :: cursor !! the place, behind the group's name
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the assignments
      integer, intent(out) :: last_judged !! the last assignment before a fault
      integer :: n_faults
      type(deck_assignment_t) :: assignment
      type(deck_token_t) :: key

      n_faults = contents%faults%n
      do
         if (contents%faults%n == n_faults) last_judged = contents%n_assignments
         select case (cursor%token%kind)
         case ('/', group_token, end_token)
            return
         case (word_token)
            ! Reads a key, its subscript and its values.
            key = cursor%token
            assignment = deck_assignment_t()
            assignment%key = lower_case(contents%text(key%first:key%last))
            assignment%line = key%line
            assignment%first = key%first
            call advance(cursor, contents%text)
            if (cursor%token%kind == '(') call read_subscript(cursor, contents, assignment)
            if (cursor%token%kind /= '=') then
               call refuse_token(contents, "expected '=' after "//token_text(contents%text, key), cursor%token)
               assignment%is_faulty = .true.
               call skip_to_key(cursor, contents%text)
            else
               call advance(cursor, contents%text)
               assignment%first_value = contents%n_values + 1
               call read_values(cursor, contents, assignment)
               assignment%last_value = contents%n_values
            end if
            if (is_name(assignment%key)) then
               if (contents%n_assignments == size(contents%assignments)) contents%assignments = &
                  [contents%assignments, contents%assignments]
               contents%n_assignments = contents%n_assignments + 1
               contents%assignments(contents%n_assignments) = assignment
            else if (.not. assignment%is_faulty) then
               call refuse_token(contents, 'expected a key of letters, digits and underscores', key)
            end if
         case (open_quote_token)
            call refuse_open_quote(cursor, contents)
         case default
            call refuse_token(contents, "expected a key or '/'", cursor%token)
            call skip_to_key(cursor, contents%text)
         end select
      end do
   end subroutine read_assignments

   !> Reads the subscript of a key or group, a whole number in parentheses.
   subroutine read_subscript(cursor, contents, assignment)
      type(cursor_t), intent(inout) :: cursor !! the place, at the opening parenthesis
      type(deck_contents_t), intent(inout) :: contents !! the deck
      type(deck_assignment_t), intent(inout) :: assignment !! the assignment, gains the subscript
      type(deck_token_t) :: subscript
      logical :: ok

      subscript = cursor%token
      call advance(cursor, contents%text)
      call read_integer(contents%text(cursor%token%first:cursor%token%last), assignment%subscript, ok)
      ok = ok .and. assignment%subscript > 0 .and. cursor%ahead%kind == ')'
      do while (cursor%token%kind /= ')' .and. cursor%token%kind /= '=' .and. .not. is_at_end(cursor))
         call extend(subscript, cursor%token)
         call advance(cursor, contents%text)
      end do
      if (cursor%token%kind == ')') then
         call extend(subscript, cursor%token)
         call advance(cursor, contents%text)
      end if
      if (ok) return
      subscript%kind = word_token
      call refuse_token(contents, excerpt(assignment%key)//': expected a subscript such as (2)', subscript)
      assignment%is_faulty = .true.
   end subroutine read_subscript

   !> Reads the values of a key, separated by blanks or single commas.
   subroutine read_values(cursor, contents, assignment)
      type(cursor_t), intent(inout) :: cursor !! the place, behind the equals sign
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the values
      type(deck_assignment_t), intent(inout) :: assignment !! the assignment, marked where its form is faulty
      logical :: wants_value

      wants_value = .true.
      do while (.not. (is_at_end(cursor) .or. is_at_key(cursor)))
         select case (cursor%token%kind)
         case (word_token, text_token)
            call read_value(cursor, contents, assignment)
            wants_value = .false.
         case (open_quote_token)
            call refuse_open_quote(cursor, contents)
            assignment%is_faulty = .true.
         case default
            if (wants_value .or. cursor%token%kind /= ',') then
               call refuse_value_token(contents, assignment, 'expected a value', cursor%token)
            end if
            wants_value = .true.
            call advance(cursor, contents%text)
         end select
      end do
      if (contents%n_values >= assignment%first_value .or. assignment%is_faulty) return
      call contents%faults%add(assignment%line, excerpt(assignment%key)//': expected a value, found '// &
         token_text(contents%text, cursor%token))
      assignment%is_faulty = .true.
   end subroutine read_values

   !> Reads one value and its repeat count.
   subroutine read_value(cursor, contents, assignment)
      type(cursor_t), intent(inout) :: cursor !! the place, at the value
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the value
      type(deck_assignment_t), intent(inout) :: assignment !! the assignment, marked where its form is faulty
      type(deck_value_t) :: value
      type(deck_token_t) :: count
      logical :: ok, is_joined

      if (cursor%ahead%kind == '*') then
         count = cursor%token
         call read_integer(contents%text(count%first:count%last), value%n_times, ok)
         is_joined = is_touching(cursor)
         call advance(cursor, contents%text)
         is_joined = is_joined .and. is_touching(cursor) .and. scan(cursor%ahead%kind, word_token//text_token) > 0
         call extend(count, cursor%token)
         if (.not. (ok .and. value%n_times > 0 .and. is_joined)) then
            call refuse_value_token(contents, assignment, 'expected a count joined to a value, such as 2*0.0', count)
         end if
         call advance(cursor, contents%text)
      end if
      associate (token => cursor%token)
         if (token%kind /= word_token .and. token%kind /= text_token) return
         value%first = token%first
         value%last = token%last
         value%line = token%line
         value%is_text = token%kind == text_token
         if (.not. (value%is_text .or. may_be_value(contents%text(token%first:token%last)))) then
            call refuse_word(cursor, contents, assignment)
         else if (value%is_text .and. token%last - token%first - 1 > longest_text) then
            call refuse_value_token(contents, assignment, 'expected a text of at most '//to_text(longest_text)// &
               ' characters', token)
         else if (is_touching(cursor) .and. scan(cursor%ahead%kind, word_token//text_token//open_quote_token) > 0) then
            call refuse_value_token(contents, assignment, 'expected a blank or a comma after '// &
               token_text(contents%text, token), cursor%ahead)
         end if
      end associate
      if (contents%n_values == size(contents%values)) contents%values = [contents%values, contents%values]
      contents%n_values = contents%n_values + 1
      contents%values(contents%n_values) = value
      call advance(cursor, contents%text)
   end subroutine read_value

   !> Records a word in the place of a value, unless the key has a fault already.
   subroutine refuse_word(cursor, contents, assignment)
      type(cursor_t), intent(in) :: cursor !! the place, at the word
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault
      type(deck_assignment_t), intent(inout) :: assignment !! the assignment, marked as faulty
      character(:), allocatable :: hint, word

      word = contents%text(cursor%token%first:cursor%token%last)
      hint = typographic_fault(word)
      if (len(hint) == 0) then
         ! What is joined to a slash may be the first part of a path.
         if (is_name(lower_case(word)) .and. .not. (is_touching(cursor) .and. cursor%ahead%kind == '/')) hint = &
            " ('"//excerpt(word)//"')"
         call refuse_value_token(contents, assignment, 'expected a number, .true., .false. or quoted text'//hint// &
            ", or '=' after a key", cursor%token)
      else if (.not. assignment%is_faulty) then
         call contents%faults%add(cursor%token%line, excerpt(assignment%key)//': '//hint//column_text(contents%text, &
            cursor%token%first))
      end if
      assignment%is_faulty = .true.
   end subroutine refuse_word

   !> Extends a token to the end of another one, if both are on one line: quotations in messages end with their line.
   pure subroutine extend(token, next)
      type(deck_token_t), intent(inout) :: token !! the token
      type(deck_token_t), intent(in) :: next !! the token behind it

      if (next%line == token%line) token%last = next%last
   end subroutine extend

   !> Moves on to the next key of the group, or to the group's end.
   subroutine skip_to_key(cursor, text)
      type(cursor_t), intent(inout) :: cursor !! the place
      character(*), intent(in) :: text !! the deck's text

      do while (.not. (is_at_end(cursor) .or. is_at_key(cursor) .or. cursor%token%kind == open_quote_token))
         call advance(cursor, text)
      end do
   end subroutine skip_to_key

   !> Whether the token ends a group, or cannot belong to one.
   pure logical function is_at_end(cursor)
      type(cursor_t), intent(in) :: cursor !! the place

      is_at_end = scan(cursor%token%kind, '/'//group_token//end_token) > 0
   end function is_at_end

   !> Whether the token is a key: a word before an equals sign or a parenthesis.
   pure logical function is_at_key(cursor)
      type(cursor_t), intent(in) :: cursor !! the place

      is_at_key = cursor%token%kind == word_token .and. scan(cursor%ahead%kind, '=(') > 0
   end function is_at_key

   !> Whether no blank separates the token from the next one.
   pure logical function is_touching(cursor)
      type(cursor_t), intent(in) :: cursor !! the place

      is_touching = cursor%ahead%first == cursor%token%last + 1
   end function is_touching

   !> Whether a token is `&end`, which closes a group as `/` does.
   pure logical function is_legacy_end(text, token)
      character(*), intent(in) :: text !! the deck's text
      type(deck_token_t), intent(in) :: token !! the token

      is_legacy_end = token%kind == group_token
      if (is_legacy_end) is_legacy_end = lower_case(text(token%first:token%last)) == '&end'
   end function is_legacy_end

   !> Records a fault at a token.
   subroutine refuse_token(contents, expected, token)
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault
      character(*), intent(in) :: expected !! what was expected there
      type(deck_token_t), intent(in) :: token !! the token found

      call contents%faults%add(token%line, expected//', found '//token_text(contents%text, token)// &
         column_text(contents%text, token%first))
   end subroutine refuse_token

   !> Records a fault among the values of a key, unless the key has one already, which may have caused this one.
   subroutine refuse_value_token(contents, assignment, expected, token)
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault
      type(deck_assignment_t), intent(inout) :: assignment !! the assignment, marked as faulty
      character(*), intent(in) :: expected !! what was expected there
      type(deck_token_t), intent(in) :: token !! the token found

      if (.not. assignment%is_faulty) call refuse_token(contents, excerpt(assignment%key)//': '//expected, token)
      assignment%is_faulty = .true.
   end subroutine refuse_value_token

   !> Records the fault of a quote that is not closed and moves on to the next line.
   subroutine refuse_open_quote(cursor, contents)
      type(cursor_t), intent(inout) :: cursor !! the place, at the quote
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault

      cursor%has_open_quote = .true.
      call refuse_token(contents, 'expected a closing quote on the same line', cursor%token)
      call advance(cursor, contents%text)
   end subroutine refuse_open_quote

   !> Moves on to the next token.
   pure subroutine advance(self, text)
      type(cursor_t), intent(inout) :: self !! the place
      character(*), intent(in) :: text !! the deck's text

      self%token = self%ahead
      if (self%token%slash_line > 0) self%slash_line = self%token%slash_line
      self%ahead = deck_token_t()
      call skip_blanks(self, text)
      self%ahead%line = self%line
      self%ahead%first = self%position
      if (self%position > len(text)) then
         self%ahead%last = len(text)
         return
      end if
      select case (text(self%position:self%position))
      case ("'", '"')
         call find_closing_quote(text, self%ahead)
      case ('/', '=', ',', '(', ')', '*')
         self%ahead%kind = text(self%position:self%position)
         self%ahead%last = self%position
      case ('&')
         self%ahead%kind = group_token
         self%ahead%last = word_end(text, self%position + 1)
      case default
         self%ahead%kind = word_token
         self%ahead%last = word_end(text, self%position)
      end select
      self%position = self%ahead%last + 1
   end subroutine advance

   !> Moves over blanks, comments and ends of lines.
   pure subroutine skip_blanks(self, text)
      type(cursor_t), intent(inout) :: self !! the place; the token ahead gains the line of a comment that ends in '/'
      character(*), intent(in) :: text !! the deck's text
      integer :: end, last

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
            if (text(end:end) == '/') self%ahead%slash_line = self%line
            self%position = last + 1
         case default
            return
         end select
      end do
   end subroutine skip_blanks

   !> Completes the token of a quoted text, which closes on its own line; a doubled quote inside means one.
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

   !> Whether a word may be a number or a logical; the reader of the key decides whether it is one.
   pure logical function may_be_value(word)
      character(*), intent(in) :: word !! the word
      character(*), parameter :: words(*) = [character(8) :: 't', 'f', 'true', 'false', 'nan', 'inf', 'infinity']

      may_be_value = scan(word(1:1), '0123456789+-.') > 0
      if (.not. may_be_value) may_be_value = any(words == lower_case(word))
   end function may_be_value

   !> What is wrong with a word that has a character as word processors and web pages write it, in UTF-8: quotes (U+2018
   !> to U+201F, U+00AB, U+00BB), dashes and the minus (U+2010 to U+2015, U+2212), the non-breaking blank (U+00A0).
   pure function typographic_fault(word) result(fault)
      character(*), intent(in) :: word !! the word
      character(:), allocatable :: fault
      character(*), parameter :: general = char(226)//char(128), latin = char(194)
      character(*), parameter :: quotes = 'typographic quotes; use '' or "'
      integer :: code

      fault = ''
      if (index(word, latin//char(160)) > 0) fault = 'a non-breaking blank; use a plain one'
      if (index(word, char(226)//char(136)//char(146)) > 0) fault = 'a typographic minus; use -'
      if (index(word, latin//char(171)) > 0 .or. index(word, latin//char(187)) > 0) fault = quotes
      do code = 144, 159
         if (index(word, general//char(code)) == 0) cycle
         fault = 'a typographic minus; use -'
         if (code >= 152) fault = quotes
      end do
   end function typographic_fault

   !> A token for a message: as written, punctuation in quotes.
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

   !> The column of a position for a message: ` (column 9)`, counted in bytes from 1.
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

   !> The hint in a message about an unknown word: the known word that other programs call by this name, a similar one
   !> or one with the same beginning, or all known words.
   pure function suggestion(word, words, also, before, noun) result(text)
      character(*), intent(in) :: word !! the word found, in lower case
      character(*), intent(in) :: words(:) !! the words known
      character(*), intent(in) :: also(:) !! names of each in other programs, separated by blanks
      character(*), intent(in) :: before !! text before each word
      character(*), intent(in) :: noun !! noun for the words
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

   !> The only known word that begins with another one, or is its first part, before an underscore; empty if there is
   !> none or more than one.
   pure function word_that_begins_alike(word, words) result(alike)
      character(*), intent(in) :: word !! the other word
      character(*), intent(in) :: words(:) !! the words known
      character(:), allocatable :: alike
      ! Shorter beginnings are shared by many words.
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

   !> The words of a list, separated by commas.
   pure function joined(words, before, behind) result(text)
      character(*), intent(in) :: words(:) !! the words, blank padded
      character(*), intent(in) :: before !! text before each word
      character(*), intent(in) :: behind !! text after each word
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(words)
         if (i > 1) text = text//', '
         text = text//before//trim(words(i))//behind
      end do
      if (text == '') text = 'none'
   end function joined

   !> Finds the values of a key, one for each element of an array.
   !>
   !> A key may occur several times if its subscripts give different elements. Values behind a fault of form are
   !> ignored, since they may belong to another group.
   subroutine find_values(contents, group, key, noun, source)
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0 where every key is absent
      character(*), intent(in) :: key !! name of the key, in lower case
      character(*), intent(in) :: noun !! noun for a value, for messages
      integer, intent(out) :: source(:) !! index of the value of each element, 0 where none is given
      integer :: i, given_at(size(source)), k, element, last, n_places, line
      character(:), allocatable :: misfit
      integer(int64) :: n_given

      source = 0
      given_at = 0
      if (group == 0) return
      do i = contents%groups(group)%first_assignment, contents%groups(group)%last_assignment
         if (contents%assignments(i)%key /= key) cycle
         if (contents%assignments(i)%is_faulty .or. i > contents%groups(group)%last_judged) cycle
         associate (given => contents%assignments(i))
            ! A misfit keeps values from the places that their assignment gives them.
            n_given = sum(int(contents%values(given%first_value:given%last_value)%n_times, int64))
            n_places = size(given_at) - max(given%subscript, 1) + 1
            misfit = ''
            if (given%subscript > 0 .and. size(given_at) == 1) then
               misfit = 'expected no subscript, found ('//to_text(given%subscript)//')'
            else if (n_places < 1) then
               misfit = 'expected a subscript from 1 to '//to_text(size(given_at))//', found ('// &
                  to_text(given%subscript)//')'
            else if (n_given > n_places .or. (n_given < n_places .and. given%subscript == 0)) then
               misfit = 'expected '//counted(n_places, noun)//', found '//to_text(n_given)
            else
               line = maxval(given_at(size(given_at) - n_places + 1:size(given_at) - n_places + int(n_given)))
               if (line > 0) misfit = 'given in line '//to_text(line)//' already'
            end if
            given%is_faulty = misfit /= ''
            if (given%is_faulty) then
               if (noun == 'number' .and. given%subscript == 0) misfit = misfit//comma_hint(contents, given, &
                  size(source))
               call contents%faults%add(given%line, given%key//': '//misfit)
               cycle
            end if
            element = max(given%subscript, 1)
            do k = given%first_value, given%last_value
               last = element + contents%values(k)%n_times - 1
               source(element:last) = k
               given_at(element:last) = given%line
               element = last + 1
            end do
         end associate
      end do
   end subroutine find_values

   !> The hint about a decimal comma, for a message about twice as many whole numbers as expected, with a comma in
   !> each pair: the number with a decimal point.
   pure function comma_hint(contents, assignment, n_expected) result(hint)
      type(deck_contents_t), intent(in) :: contents !! the deck
      type(deck_assignment_t), intent(in) :: assignment !! the assignment
      integer, intent(in) :: n_expected !! number of values of its key
      character(:), allocatable :: hint
      integer :: i

      hint = ''
      if (assignment%last_value - assignment%first_value + 1 /= 2*n_expected) return
      associate (text => contents%text, values => contents%values)
         do i = assignment%first_value, assignment%last_value, 2
            if (values(i + 1)%first /= values(i)%last + 2 .or. any(values(i:i + 1)%n_times > 1)) return
            if (text(values(i)%last + 1:values(i)%last + 1) /= ',') return
            if (verify(text(values(i)%first:values(i)%last), '+-0123456789') > 0) return
            if (verify(text(values(i + 1)%first:values(i + 1)%last), '0123456789eEdD+-') > 0) return
         end do
         i = assignment%first_value
         hint = '; a decimal comma? write '//text(values(i)%first:values(i)%last)//'.'// &
            text(values(i + 1)%first:values(i + 1)%last)
      end associate
   end function comma_hint

   !> A value as it is written, its quotes included.
   pure function raw_value(contents, value) result(raw)
      type(deck_contents_t), intent(in) :: contents !! the deck
      integer, intent(in) :: value !! index of the value
      character(:), allocatable :: raw

      raw = contents%text(contents%values(value)%first:contents%values(value)%last)
   end function raw_value

   !> A value without quotes; empty for a quoted one, which is neither a number nor a logical.
   pure function bare_value(contents, value) result(word)
      type(deck_contents_t), intent(in) :: contents !! the deck
      integer, intent(in) :: value !! index of the value
      character(:), allocatable :: word

      word = ''
      if (.not. contents%values(value)%is_text) word = raw_value(contents, value)
   end function bare_value

   !> A quoted value without its quotes, the doubled ones inside made single.
   pure function unquoted_value(contents, value) result(text)
      type(deck_contents_t), intent(in) :: contents !! the deck
      integer, intent(in) :: value !! index of the value, which is in quotes
      character(:), allocatable :: text, raw
      integer :: i, length

      raw = raw_value(contents, value)
      text = raw
      length = 0
      i = 2
      do while (i < len(raw))
         length = length + 1
         text(length:length) = raw(i:i)
         i = i + merge(2, 1, raw(i:i) == raw(1:1))
      end do
      text = text(:length)
   end function unquoted_value

   !> Records that a value is not what its key expects and marks the key as faulty.
   subroutine refuse_value(contents, group, key, value, expected)
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! name of the key
      integer, intent(in) :: value !! index of the value
      character(*), intent(in) :: expected !! the expected value

      call contents%faults%add(contents%values(value)%line, trim(key)//': expected '//expected//', found '// &
         excerpt(raw_value(contents, value))//column_text(contents%text, contents%values(value)%first))
      call mark_faulty(contents, group, key)
   end subroutine refuse_value

   !> Marks the value of a key as faulty.
   subroutine mark_faulty(contents, group, key)
      type(deck_contents_t), intent(inout) :: contents !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! name of the key, which the group has

      contents%assignments(find_key(contents, group, key))%is_faulty = .true.
   end subroutine mark_faulty

   !> The first assignment of a key in a group, 0 where it has none.
   pure integer function find_key(contents, group, key) result(assignment)
      type(deck_contents_t), intent(in) :: contents !! the deck
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case

      if (group > 0) then
         do assignment = contents%groups(group)%first_assignment, contents%groups(group)%last_assignment
            if (contents%assignments(assignment)%key == key) return
         end do
      end if
      assignment = 0
   end function find_key

end module amontons_deck_contents
