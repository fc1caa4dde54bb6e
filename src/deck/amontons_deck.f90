!> A deck: named groups of assignments, read with line numbers, every fault reported at once; and settings of single
!> keys that take the place of what a deck says, as a command line gives them: `contact(2).friction=0.3`.
!>
!> The form is that of Fortran namelists, `&mesh kind = 'rectangle'  cells = 32, 10 /`, with comments from `!` on. It is
!> narrower where a namelist guesses: a quoted text closes on its line, no value may be left empty, nothing stands
!> between the groups, and a number is finite. `&end` closes a group as `/` does.
!>
!> Reading never fails once the file is open: faults of form, of type and of meaning gather in the deck, and `finish`
!> turns them into one error.
module amontons_deck
   use amontons_deck_contents, only: append_assignment, append_group, append_value, column_text, deck_assignment_t, &
      deck_contents_t, deck_group_t, deck_scanner_t, deck_token_t, deck_value_t, end_token, excerpt, find_key, &
      group_token, has_typographic_quote, is_name, may_be_value, open_quote_token, suggestion, text_token, &
      token_text, word_token
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_input_file, only: beside, read_standard_input, read_text_file
   use amontons_kinds, only: int64
   use amontons_system, only: absolute_path
   use amontons_text, only: line_end, lower_case, newline, quoted, read_integer, to_text
   implicit none (type, external)
   private

   public :: apply_settings, deck_t, new_setting, read_deck, read_deck_text, read_settings, setting_t

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

   !> The value of a key.
   type :: setting_t
      character(:), allocatable :: text !! the setting as it was given
      character(:), allocatable :: group !! name of the group
      integer :: number = 0 !! which of the groups of this name; 0 for the only one
      character(:), allocatable :: assignment !! the assignment as a deck has it: `friction = 0.3`
      character(:), allocatable :: key !! name of the key
   end type setting_t

   !> A deck and what is wrong with it.
   type :: deck_t
      character(:), allocatable :: file !! name the messages give to the deck
      type(deck_contents_t) :: contents !! what stands in it
      type(setting_t), allocatable :: settings(:) !! the settings that are part of it
   contains
      procedure :: count_groups => deck_count_groups
      procedure :: count_values => deck_count_values
      procedure :: fault => deck_fault
      procedure :: finish => deck_finish
      procedure :: has => deck_has
      procedure :: is_sound => deck_is_sound
      procedure :: is_understood => deck_is_understood
      procedure :: knows => deck_knows
      procedure :: line_of => deck_line_of
      procedure :: next_group => deck_next_group
      procedure :: path_of => deck_path_of
      procedure :: refuse_unknown_groups => deck_refuse_unknown_groups
   end type deck_t

contains

   !> Takes a deck's text apart; what is wrong with its form becomes faults, and everything sound is kept.
   subroutine parse_deck(text, contents)
      character(*), intent(in) :: text !! the deck's text, its lines ended by LF or CRLF
      type(deck_contents_t), intent(out) :: contents !! what stands in it
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
            call append_group(contents, group)
         else
            call refuse_token(contents, 'expected a group such as &mesh', cursor%token)
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

   !> Reads the assignments of a group up to its end, or to what stands in the place of one.
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
               call append_assignment(contents, assignment)
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
            call refuse_value(contents, assignment, 'expected a count joined to a value, such as 2*0.0', count)
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
            ! Records a word in the place of a value.
            if (.not. has_typographic_quote(contents%text(token%first:token%last))) then
               call refuse_value(contents, assignment, "expected a number or quoted text, or '=' after a key", token)
            else if (.not. assignment%is_faulty) then
               call contents%faults%add(token%line, excerpt(assignment%key)//': typographic quotes; use '' or "'// &
                  column_text(contents%text, token%first))
            end if
            assignment%is_faulty = .true.
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

   !> Reads a deck from a file, or from standard input, which messages call 'stdin'.
   subroutine read_deck(deck, file, error)
      type(deck_t), intent(out) :: deck !! the deck
      character(*), intent(in) :: file !! name of the file, `-` for standard input
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, or holds no group
      character(:), allocatable :: text, name

      name = file
      if (file == '-') name = 'stdin'
      if (file == '-') call read_standard_input(name, text, error)
      if (file /= '-') call read_text_file(file, text, error)
      if (allocated(error)) return
      call read_deck_text(deck, name, text)
      if (deck%contents%n_groups == 0) call deck%finish(error)
   end subroutine read_deck

   !> Reads a deck from a text; one without any group has a fault that says so.
   subroutine read_deck_text(deck, name, text)
      type(deck_t), intent(out) :: deck !! the deck
      character(*), intent(in) :: name !! name the messages give to the deck
      character(*), intent(in) :: text !! the whole text, lines ended by LF or CRLF

      deck%file = name
      call parse_deck(text, deck%contents)
   end subroutine read_deck_text

   !> The next group of a name behind a group, 0 where there is none.
   pure integer function deck_next_group(self, name, group) result(next)
      class(deck_t), intent(in) :: self !! the deck
      character(*), intent(in) :: name !! name of the group, in lower case, without `&`
      integer, intent(in) :: group !! the group before, or 0

      do next = group + 1, self%contents%n_groups
         if (self%contents%groups(next)%name == name) return
      end do
      next = 0
   end function deck_next_group

   !> Number of groups of a name.
   pure integer function deck_count_groups(self, name) result(n_groups)
      class(deck_t), intent(in) :: self !! the deck
      character(*), intent(in) :: name !! name of the groups, in lower case, without `&`
      integer :: i

      n_groups = count([(self%contents%groups(i)%name == name, i=1, self%contents%n_groups)])
   end function deck_count_groups

   !> Whether a group has a key.
   pure logical function deck_has(self, group, key) result(has)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case

      has = find_key(self%contents, group, key) > 0
   end function deck_has

   !> Line of a key; of the group where the key is absent; 0 where there is no group.
   integer function deck_line_of(self, group, key) result(line)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      integer :: assignment

      line = 0
      assignment = find_key(self%contents, group, key)
      if (assignment > 0) then
         line = self%contents%assignments(assignment)%line
      else if (group > 0) then
         line = self%contents%groups(group)%line
      end if
   end function deck_line_of

   !> Records a fault of meaning at the line of a key, or of the group where the key is absent.
   !>
   !> A key whose value has another fault already has no meaning to judge, nor has what stands behind a fault of form:
   !> the call is then without effect.
   subroutine deck_fault(self, group, key, sentence)
      class(deck_t), intent(inout) :: self !! the deck, gains the fault
      integer, intent(in) :: group !! the group, or 0 for the deck as a whole
      character(*), intent(in) :: key !! name of the key, in lower case
      character(*), intent(in) :: sentence !! what is wrong and what was expected

      if (group > 0) then
         if (hides_meaning(self%contents, group, key)) return
         self%contents%groups(group)%is_faulty = .true.
      end if
      call self%contents%faults%add(self%line_of(group, key), sentence)
   end subroutine deck_fault

   !> Whether a fault recorded already hides what a key means: its value is at fault, or it may stand behind a fault of
   !> form.
   pure logical function hides_meaning(contents, group, key)
      type(deck_contents_t), intent(in) :: contents !! what stands in the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! name of the key
      integer :: assignment

      assignment = find_key(contents, group, key)
      if (assignment > 0) then
         hides_meaning = contents%assignments(assignment)%is_faulty .or. &
            assignment > contents%groups(group)%last_judged
      else
         hides_meaning = contents%groups(group)%is_malformed
      end if
   end function hides_meaning

   !> Whether everything that a group says is understood, its form, its keys and their values, so that its keys can be
   !> judged together. A group that is absent may be one that another fault hides: it counts as understood only if the
   !> whole deck is in order.
   pure logical function deck_is_understood(self, group) result(is_understood)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0
      integer :: i

      is_understood = self%contents%faults%n == 0
      if (is_understood .or. group == 0) return
      associate (found => self%contents%groups(group), assignments => self%contents%assignments)
         is_understood = .not. (found%is_malformed .or. found%has_unknown_key .or. &
            any([(assignments(i)%is_faulty, i=found%first_assignment, found%last_assignment)]))
      end associate
   end function deck_is_understood

   !> Whether a group is understood and makes sense so far.
   pure logical function deck_is_sound(self, group) result(is_sound)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0

      is_sound = self%is_understood(group)
      if (group > 0) is_sound = is_sound .and. .not. self%contents%groups(group)%is_faulty
   end function deck_is_sound

   !> Whether it is known what a key says in all groups of a name, so that other groups can be judged by it: no fault
   !> hides such a group, or the key in one.
   pure logical function deck_knows(self, name, key) result(knows)
      class(deck_t), intent(in) :: self !! the deck
      character(*), intent(in) :: name !! name of the groups
      character(*), intent(in) :: key !! name of the key
      integer :: i

      knows = .not. self%contents%hides_groups
      do i = 1, self%contents%n_groups
         if (self%contents%groups(i)%name == name) knows = knows .and. .not. &
            (hides_meaning(self%contents, i, key) .or. self%contents%groups(i)%has_unknown_key)
      end do
   end function deck_knows

   !> Number of values that stand behind a key, repeat counts included; 0 where the key is absent.
   pure integer function deck_count_values(self, group, key, most) result(n_values)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      integer, intent(in) :: most !! more values than this count as so many
      integer :: assignment

      n_values = 0
      assignment = find_key(self%contents, group, key)
      if (assignment == 0) return
      associate (given => self%contents%assignments(assignment))
         n_values = int(min(sum(int(self%contents%values(given%first_value:given%last_value)%n_times, int64)), &
            int(most, int64)))
      end associate
   end function deck_count_values

   !> The full name of a file: seen from the deck's folder, or from the current one where a setting gives it.
   function deck_path_of(self, group, key, name) result(path)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key that names the file, in lower case
      character(*), intent(in) :: name !! name of the file as it is given
      character(:), allocatable :: path
      integer :: number, i

      number = 0
      do i = 1, group
         if (self%contents%groups(i)%name == self%contents%groups(group)%name) number = number + 1
      end do
      path = absolute_path(beside(self%file, name))
      if (.not. allocated(self%settings)) return
      do i = 1, size(self%settings)
         associate (setting => self%settings(i))
            if (setting%group == self%contents%groups(group)%name .and. setting%key == key .and. &
               max(1, setting%number) == number) path = absolute_path(name)
         end associate
      end do
   end function deck_path_of

   !> Records the groups that are unknown, and those that stand more often than they may.
   subroutine deck_refuse_unknown_groups(self, known_names, also, repeatable_names)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      character(*), intent(in) :: known_names(:) !! names of all groups a deck may have, in lower case, blank padded
      character(*), intent(in) :: also(:) !! what other programs call each of them, blanks between the words
      character(*), intent(in) :: repeatable_names(:) !! those of them that may stand more than once
      integer :: i, first_line(size(known_names)), known

      first_line = 0
      do i = 1, self%contents%n_groups
         associate (group => self%contents%groups(i))
            known = findloc(known_names == group%name, .true., dim=1)
            if (known == 0) then
               self%contents%hides_groups = .true.
               call self%contents%faults%add(group%line, 'unknown group &'//excerpt(group%name)// &
                  suggestion(group%name, known_names, also, '&', 'groups'))
            else if (first_line(known) == 0) then
               first_line(known) = group%line
            else if (all(repeatable_names /= group%name)) then
               call self%contents%faults%add(group%line, '&'//group%name//' is given in line '// &
                  to_text(first_line(known))//' already')
            end if
         end associate
      end do
   end subroutine deck_refuse_unknown_groups

   !> Turns the faults into one error that lists them all, a line of text for each.
   subroutine deck_finish(self, error)
      class(deck_t), intent(in) :: self !! the deck
      type(error_t), allocatable, intent(out) :: error !! the faults, ordered by line, where there is any

      call self%contents%faults%finish(self%file, error)
   end subroutine deck_finish

   !> Takes a setting apart. A value that is neither quoted nor made of numbers counts as text.
   subroutine new_setting(setting, text, error)
      type(setting_t), intent(out) :: setting !! the setting
      character(*), intent(in) :: text !! the setting as it is given: `GROUP.KEY=VALUE` or `GROUP(2).KEY=VALUE`
      type(error_t), allocatable, intent(out) :: error !! it has not this form
      character(:), allocatable :: value
      integer :: equals, point, parenthesis
      logical :: ok, is_literal
      character(*), parameter :: digits = '0123456789'

      equals = index(text, '=')
      point = index(text(:max(0, equals - 1)), '.')
      setting%text = text
      setting%group = lower_case(text(:point - 1))
      setting%key = lower_case(text(point + 1:equals - 1))
      parenthesis = index(setting%group, '(')
      ok = .true.
      if (parenthesis > 0) then
         call read_integer(setting%group(parenthesis + 1:len(setting%group) - 1), setting%number, ok)
         ok = ok .and. setting%number > 0 .and. index(setting%group, ')') == len(setting%group)
         setting%group = setting%group(:parenthesis - 1)
      end if
      if (ok) ok = len(setting%group) > 0 .and. len(setting%key) > 0
      if (ok) ok = is_name(setting%group) .and. is_name(setting%key)
      if (.not. ok) then
         call new_error(error, input_refused, "expected GROUP.KEY=VALUE, such as contact.friction=0.3, found '"//text &
            //"'")
         return
      end if
      value = trim(adjustl(text(equals + 1:)))
      ! Whether a value stands in quotes, or looks like numbers.
      is_literal = scan(value(:min(1, len(value))), '''"') > 0 .or. &
         (verify(value, digits//'+-.,* eEdD') == 0 .and. scan(value(:min(1, len(value))), digits//'+-.') > 0)
      if (.not. is_literal) value = quoted(value)
      ! A key that is unknown is shown as it was given.
      setting%assignment = text(point + 1:equals - 1)//' = '//value
   end subroutine new_setting

   !> Takes settings apart, one a line.
   subroutine read_settings(settings, text, error)
      type(setting_t), allocatable, intent(out) :: settings(:) !! the settings
      character(*), intent(in) :: text !! the lines
      type(error_t), allocatable, intent(out) :: error !! one has not the form of a setting
      type(setting_t) :: setting
      integer :: first, last

      allocate (settings(0))
      first = 1
      do while (first <= len(text))
         last = line_end(text, first)
         call new_setting(setting, text(first:last), error)
         if (allocated(error)) return
         settings = [settings, setting]
         first = last + 2
      end do
   end subroutine read_settings

   !> Puts settings in the place of what a deck says, or into it. Every line keeps its number.
   subroutine apply_settings(deck, settings)
      type(deck_t), intent(inout) :: deck !! the deck; gains a fault where a setting says not which group it means
      type(setting_t), intent(in) :: settings(:) !! the settings
      character(:), allocatable :: file, text
      logical :: is_clear(size(settings))
      integer :: i, n_groups

      file = deck%file
      do i = 1, size(settings)
         n_groups = deck%count_groups(settings(i)%group)
         is_clear(i) = settings(i)%number <= max(1, n_groups) .and. (settings(i)%number > 0 .or. n_groups <= 1)
         if (.not. is_clear(i)) cycle
         call apply_setting(deck, settings(i), text)
         call read_deck_text(deck, file, text)
      end do
      deck%settings = settings
      do i = 1, size(settings)
         if (.not. is_clear(i)) call deck%fault(0, '', settings(i)%text//': the deck has '// &
            to_text(deck%count_groups(settings(i)%group))//' &'//settings(i)%group//'; write '//settings(i)%group// &
            '(1).'//settings(i)%key//' for the first')
      end do
   end subroutine apply_settings

   !> The text of a deck with a setting: in the place of the key; at the end of its group, or behind all groups.
   subroutine apply_setting(deck, setting, text)
      type(deck_t), intent(in) :: deck !! the deck
      type(setting_t), intent(in) :: setting !! the setting
      character(:), allocatable, intent(out) :: text !! the text
      integer :: group, first, i

      text = deck%contents%text
      group = 0
      do i = 1, max(1, setting%number)
         group = deck%next_group(setting%group, group)
      end do
      if (group == 0) then
         if (index(text, newline, back=.true.) < len(text)) text = text//newline
         text = text//'&'//setting%group//' '//setting%assignment//' /'
         return
      end if
      associate (contents => deck%contents, found => deck%contents%groups(group))
         ! Behind a fault of form nothing is in its place; the deck is refused in any case.
         if (found%is_malformed) return
         first = find_key(contents, group, setting%key)
         if (first == 0) then
            text = text(:found%last)//' '//setting%assignment//' '//text(found%last + 1:)
            return
         end if
         do i = found%last_assignment, first + 1, -1
            if (contents%assignments(i)%key == setting%key) call blank(text, last_place(i - 1) + 1, last_place(i))
         end do
         text = text(:contents%assignments(first)%first - 1)//setting%assignment//text(last_place(first) + 1:)
      end associate

   contains

      !> Position of the last character of an assignment.
      pure integer function last_place(assignment)
         integer, intent(in) :: assignment !! the assignment

         last_place = deck%contents%values(deck%contents%assignments(assignment)%last_value)%last
      end function last_place

   end subroutine apply_setting

   !> Makes a part of a text blank but for the ends of its lines.
   pure subroutine blank(text, first, last)
      character(:), allocatable, intent(inout) :: text !! the text
      integer, intent(in) :: first !! position of the first character
      integer, intent(in) :: last !! position of the last character
      integer :: i

      do i = first, last
         if (text(i:i) /= newline) text(i:i) = ' '
      end do
   end subroutine blank

end module amontons_deck
