!> Finds the groups, assignments and values in the text of a deck, and what is wrong with their form.
module amontons_deck_parser
   use amontons_deck_contents, only: append_assignment, append_group, append_value, deck_assignment_t, &
      deck_contents_t, deck_group_t, deck_value_t
   use amontons_deck_scanner, only: column_text, deck_scanner_t, deck_token_t, end_token, excerpt, group_token, &
      has_typographic_quote, is_name, may_be_value, open_quote_token, text_token, token_text, word_token
   use amontons_text, only: lower_case, read_integer, to_text
   implicit none (type, external)
   private

   public :: parse_deck

   !> A deck with more groups was made by a fault: no body has as many loads.
   integer, parameter :: most_groups = 10000
   !> The longest text in quotes; names of files end there.
   integer, parameter :: longest_text = 4096

   !> The token being read and the one behind it.
   type :: cursor_t
      type(deck_scanner_t) :: scanner !! place behind the two tokens
      type(deck_token_t) :: token !! the token being read
      type(deck_token_t) :: ahead !! the token behind it
      logical :: has_open_quote = .false. !! whether a quote of the group does not close and so may hide its end
      integer :: slash_line = 0 !! line of a comment in the group that ends in '/', 0 for none
   end type cursor_t

contains

   !> Takes a deck's text apart; what is wrong with its form becomes faults, and everything sound is kept.
   subroutine parse_deck(text, contents)
      character(*), intent(in) :: text !! the deck's text, its lines ended by LF or CRLF
      type(deck_contents_t), intent(out) :: contents !! what stands in it
      type(cursor_t) :: cursor
      logical :: is_plain

      allocate (contents%groups(8), contents%assignments(64), contents%values(64))
      contents%text = text
      call check_characters(contents, is_plain)
      if (.not. is_plain) return
      call advance(cursor, text)
      call advance(cursor, text)
      if (cursor%token%kind == end_token) call contents%faults%add(0, 'expected a group such as &mesh, found none')
      do while (cursor%token%kind /= end_token)
         if (cursor%token%kind == group_token .and. .not. is_legacy_end(text, cursor%token)) then
            call read_group(cursor, contents)
         else
            call refuse_token(contents, 'expected a group such as &mesh', cursor%token)
            contents%hides_groups = .true.
            call skip_to_group(cursor, text)
         end if
         if (contents%n_groups < most_groups .or. cursor%token%kind == end_token) cycle
         call contents%faults%add(cursor%token%line, 'a deck has at most '//to_text(most_groups)//' groups, found more')
         contents%hides_groups = .true.
         exit
      end do
   end subroutine parse_deck

   !> Refuses control characters: a file that has them is no text.
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

   !> Reads a group and its end.
   subroutine read_group(cursor, contents)
      type(cursor_t), intent(inout) :: cursor !! the place, at the group's name
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the group
      type(deck_group_t) :: group
      character(:), allocatable :: next
      integer :: n_faults

      n_faults = contents%faults%n
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
      call append_group(contents, group)
   end subroutine read_group

   !> Reads the assignments of a group up to its end, or to what stands in the place of one.
   subroutine read_assignments(cursor, contents, last_judged)
      type(cursor_t), intent(inout) :: cursor !! the place, behind the group's name
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the assignments
      integer, intent(out) :: last_judged !! the last assignment before a fault
      integer :: n_faults

      n_faults = contents%faults%n
      do
         if (contents%faults%n == n_faults) last_judged = contents%n_assignments
         select case (cursor%token%kind)
         case ('/', group_token, end_token)
            return
         case (word_token)
            call read_assignment(cursor, contents)
         case (open_quote_token)
            call refuse_open_quote(cursor, contents)
         case default
            call refuse_token(contents, "expected a key or '/'", cursor%token)
            call skip_to_key(cursor, contents%text)
         end select
      end do
   end subroutine read_assignments

   !> Reads a key, its subscript and its values.
   subroutine read_assignment(cursor, contents)
      type(cursor_t), intent(inout) :: cursor !! the place, at the key
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the assignment
      type(deck_assignment_t) :: assignment
      type(deck_token_t) :: key

      key = cursor%token
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
         call append_assignment(contents, assignment)
      else if (.not. assignment%is_faulty) then
         call refuse_token(contents, 'expected a key of letters, digits and underscores', key)
      end if
   end subroutine read_assignment

   !> Reads a subscript in parentheses.
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
               call refuse_value(contents, assignment, 'expected a value', cursor%token)
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

      if (cursor%ahead%kind == '*') call read_repeat_count(cursor, contents, assignment, value%n_times)
      associate (token => cursor%token)
         if (token%kind /= word_token .and. token%kind /= text_token) return
         value%first = token%first
         value%last = token%last
         value%line = token%line
         value%is_text = token%kind == text_token
         if (.not. (value%is_text .or. may_be_value(contents%text(token%first:token%last)))) then
            call refuse_word(contents, assignment, token)
         else if (value%is_text .and. token%last - token%first - 1 > longest_text) then
            call refuse_value(contents, assignment, 'expected a text of at most '//to_text(longest_text)// &
               ' characters', token)
         else if (is_touching(cursor) .and. scan(cursor%ahead%kind, word_token//text_token//open_quote_token) > 0) then
            call refuse_value(contents, assignment, 'expected a blank or a comma after '// &
               token_text(contents%text, token), cursor%ahead)
         end if
      end associate
      call append_value(contents, value)
      call advance(cursor, contents%text)
   end subroutine read_value

   !> Records a word in the place of a value.
   subroutine refuse_word(contents, assignment, token)
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault
      type(deck_assignment_t), intent(inout) :: assignment !! the assignment, marked as faulty
      type(deck_token_t), intent(in) :: token !! the word

      if (.not. has_typographic_quote(contents%text(token%first:token%last))) then
         call refuse_value(contents, assignment, "expected a number or quoted text, or '=' after a key", token)
      else if (.not. assignment%is_faulty) then
         call contents%faults%add(token%line, excerpt(assignment%key)//': typographic quotes; use '' or "'// &
            column_text(contents%text, token%first))
      end if
      assignment%is_faulty = .true.
   end subroutine refuse_word

   !> Reads a repeat count and its star, to which the value must be joined: behind a blank it would be another value.
   subroutine read_repeat_count(cursor, contents, assignment, n_times)
      type(cursor_t), intent(inout) :: cursor !! the place, at the count; at the value on return
      type(deck_contents_t), intent(inout) :: contents !! the deck
      type(deck_assignment_t), intent(inout) :: assignment !! the assignment, marked where its form is faulty
      integer, intent(out) :: n_times !! how often the value counts
      type(deck_token_t) :: count
      logical :: ok, is_joined

      count = cursor%token
      call read_integer(contents%text(count%first:count%last), n_times, ok)
      is_joined = is_touching(cursor)
      call advance(cursor, contents%text)
      is_joined = is_joined .and. is_touching(cursor) .and. scan(cursor%ahead%kind, word_token//text_token) > 0
      call extend(count, cursor%token)
      if (.not. (ok .and. n_times > 0 .and. is_joined)) then
         call refuse_value(contents, assignment, 'expected a count joined to a value, such as 2*0.0', count)
      end if
      call advance(cursor, contents%text)
   end subroutine read_repeat_count

   !> Joins a token to one before it, if both stand on one line: what a message quotes ends with its line.
   pure subroutine extend(token, next)
      type(deck_token_t), intent(inout) :: token !! the token
      type(deck_token_t), intent(in) :: next !! the token behind it

      if (next%line == token%line) token%last = next%last
   end subroutine extend

   !> Moves on to the next token.
   subroutine advance(cursor, text)
      type(cursor_t), intent(inout) :: cursor !! the place
      character(*), intent(in) :: text !! the deck's text

      cursor%token = cursor%ahead
      if (cursor%token%slash_line > 0) cursor%slash_line = cursor%token%slash_line
      call cursor%scanner%advance(text, cursor%ahead)
   end subroutine advance

   !> Moves on to the next key of the group, or to the group's end.
   subroutine skip_to_key(cursor, text)
      type(cursor_t), intent(inout) :: cursor !! the place
      character(*), intent(in) :: text !! the deck's text

      do while (.not. (is_at_end(cursor) .or. is_at_key(cursor) .or. cursor%token%kind == open_quote_token))
         call advance(cursor, text)
      end do
   end subroutine skip_to_key

   !> Moves on from stray text to the next group, or to the end.
   subroutine skip_to_group(cursor, text)
      type(cursor_t), intent(inout) :: cursor !! the place
      character(*), intent(in) :: text !! the deck's text

      call advance(cursor, text)
      do while (cursor%token%kind /= end_token .and. cursor%token%kind /= group_token)
         call advance(cursor, text)
      end do
   end subroutine skip_to_group

   !> Whether the place is a group's end, or what stands in the place of one.
   pure logical function is_at_end(cursor)
      type(cursor_t), intent(in) :: cursor !! the place

      is_at_end = scan(cursor%token%kind, '/'//group_token//end_token) > 0
   end function is_at_end

   !> Whether the place is a key: a word before an equals sign or a parenthesis.
   pure logical function is_at_key(cursor)
      type(cursor_t), intent(in) :: cursor !! the place

      is_at_key = cursor%token%kind == word_token .and. scan(cursor%ahead%kind, '=(') > 0
   end function is_at_key

   !> Whether nothing separates the token from the one behind it.
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

   !> Records a fault among the values of a key, the first one only: what follows is its echo.
   subroutine refuse_value(contents, assignment, expected, token)
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault
      type(deck_assignment_t), intent(inout) :: assignment !! the assignment, marked as faulty
      character(*), intent(in) :: expected !! what was expected there
      type(deck_token_t), intent(in) :: token !! the token found

      if (.not. assignment%is_faulty) call refuse_token(contents, excerpt(assignment%key)//': '//expected, token)
      assignment%is_faulty = .true.
   end subroutine refuse_value

   !> Records the fault of a quote that does not close and moves on to the next line.
   subroutine refuse_open_quote(cursor, contents)
      type(cursor_t), intent(inout) :: cursor !! the place, at the quote
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault

      cursor%has_open_quote = .true.
      call refuse_token(contents, 'expected a closing quote on the same line', cursor%token)
      call advance(cursor, contents%text)
   end subroutine refuse_open_quote

end module amontons_deck_parser
