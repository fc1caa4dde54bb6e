!> A deck: named groups of assignments, read with line numbers, with all its faults reported at once; and settings of
!> single keys that replace values of a deck, as a command line gives them: `contact(2).friction=0.3`.
!>
!> The form is that of Fortran namelists, `&mesh kind = 'rectangle'  cells = 32, 10 /`, with comments from `!` on. It is
!> stricter where a namelist guesses: a quoted text closes on its line, no value may be left empty, nothing is
!> between the groups, and a number is finite. `&end` closes a group as `/` does.
!>
!> Reading never fails once the file is open: faults of form, of type and of meaning are collected in the deck, and
!> `finish` makes one error of them.
module amontons_deck
   use amontons_deck_contents, only: deck_contents_t, excerpt, find_key, is_name, parse_deck, suggestion
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_input_file, only: beside, read_text_file
   use amontons_kinds, only: int64
   use amontons_system, only: absolute_path
   use amontons_text, only: line_end, lower_case, newline, quoted, read_integer, to_text
   implicit none (type, external)
   private

   public :: apply_settings, deck_t, new_setting, read_deck, read_deck_text, read_settings, setting_t

   !> The value of a key.
   type :: setting_t
      character(:), allocatable :: text !! the setting as it was given
      character(:), allocatable :: group !! name of the group
      integer :: number = 0 !! which of the groups of this name; 0 for the only one
      character(:), allocatable :: assignment !! the assignment as a deck has it: `friction = 0.3`
      character(:), allocatable :: key !! name of the key
   end type setting_t

   !> A deck and its faults.
   type :: deck_t
      character(:), allocatable :: file !! name the messages give to the deck
      type(deck_contents_t) :: contents !! its groups, assignments and values
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

   !> Reads a deck from a file, or from standard input, which messages call 'stdin'.
   subroutine read_deck(deck, file, error)
      type(deck_t), intent(out) :: deck !! the deck
      character(*), intent(in) :: file !! name of the file, `-` for standard input
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, or holds no group
      character(:), allocatable :: text, name

      name = file
      if (file == '-') then
         name = 'stdin'
         call read_text_file(name, text, error, is_standard_input=.true.)
      else
         call read_text_file(file, text, error)
      end if
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

   !> The next group with a name after a given group, 0 if there is none.
   pure integer function deck_next_group(self, name, group) result(next)
      class(deck_t), intent(in) :: self !! the deck
      character(*), intent(in) :: name !! name of the group, in lower case, without `&`
      integer, intent(in) :: group !! the group before, or 0

      do next = group + 1, self%contents%n_groups
         if (self%contents%groups(next)%name == name) return
      end do
      next = 0
   end function deck_next_group

   !> Number of groups of a name in the deck.
   pure integer function deck_count_groups(self, name) result(n_groups)
      class(deck_t), intent(in) :: self !! the deck
      character(*), intent(in) :: name !! name of the groups, in lower case, without `&`
      integer :: i

      n_groups = count([(self%contents%groups(i)%name == name, i=1, self%contents%n_groups)])
   end function deck_count_groups

   !> Whether a group gives a value to a key.
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

   !> Records a fault of meaning at the line of a key, or of the group if the key is absent.
   !>
   !> The call has no effect on a key whose value already has a fault, nor behind a fault of form: neither has a meaning
   !> that could be judged.
   subroutine deck_fault(self, group, key, sentence)
      class(deck_t), intent(inout) :: self !! the deck, gains the fault
      integer, intent(in) :: group !! the group, or 0 for the deck as a whole
      character(*), intent(in) :: key !! name of the key, in lower case
      character(*), intent(in) :: sentence !! the fault and what was expected, as a sentence

      if (group > 0) then
         if (hides_meaning(self%contents, group, key)) return
         self%contents%groups(group)%is_faulty = .true.
      end if
      call self%contents%faults%add(self%line_of(group, key), sentence)
   end subroutine deck_fault

   !> Whether a recorded fault makes the meaning of a key unknown: its value is faulty, or it may be behind a fault
   !> of form.
   pure logical function hides_meaning(contents, group, key)
      type(deck_contents_t), intent(in) :: contents !! groups, assignments and values of the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! name of the key
      integer :: assignment

      assignment = find_key(contents, group, key)
      if (assignment > 0) then
         hides_meaning = contents%assignments(assignment)%is_faulty .or. assignment > contents%groups(group)%last_judged
      else
         hides_meaning = contents%groups(group)%is_malformed
      end if
   end function hides_meaning

   !> Whether the form, the keys and the values of a group have no faults, so that its keys can be judged together. An
   !> absent group may be one that another fault hides: it counts as understood only if the whole deck has no faults.
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

   !> Whether a group is understood and has no fault of meaning so far.
   pure logical function deck_is_sound(self, group) result(is_sound)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0

      is_sound = self%is_understood(group)
      if (group > 0) is_sound = is_sound .and. .not. self%contents%groups(group)%is_faulty
   end function deck_is_sound

   !> Whether a key is understood in all groups of a name, so that other groups can be judged by it: no fault hides such
   !> a group, or the key in one.
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

   !> Number of values of a key, repeat counts included; 0 if the key is absent.
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

   !> The path of a file that a key names: relative to the deck's folder, or to the current one if a setting names the
   !> file.
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

   !> Records unknown groups, and groups that occur more often than they may.
   subroutine deck_refuse_unknown_groups(self, known_names, also, repeatable_names)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      character(*), intent(in) :: known_names(:) !! names of all groups a deck may have, in lower case, blank padded
      character(*), intent(in) :: also(:) !! names of each in other programs, separated by blanks
      character(*), intent(in) :: repeatable_names(:) !! those of them that may occur more than once
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

   !> Makes one error of all faults, one line of text each.
   subroutine deck_finish(self, error)
      class(deck_t), intent(in) :: self !! the deck
      type(error_t), allocatable, intent(out) :: error !! the faults, ordered by line, where there is any

      call self%contents%faults%finish(self%file, error)
   end subroutine deck_finish

   !> Parses a setting. A value that is neither quoted nor consists of numbers is a text.
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
      ! Whether a value is in quotes, or looks like numbers.
      is_literal = scan(value(:min(1, len(value))), '''"') > 0 .or. &
         (verify(value, digits//'+-.,* eEdD') == 0 .and. scan(value(:min(1, len(value))), digits//'+-.') > 0)
      if (.not. is_literal) value = quoted(value)
      ! A key that is unknown is shown as it was given.
      setting%assignment = text(point + 1:equals - 1)//' = '//value
   end subroutine new_setting

   !> Parses the values that `--set` gives, one in each line.
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

   !> Replaces values of a deck by those of settings, or inserts them. Line numbers do not change.
   subroutine apply_settings(deck, settings)
      type(deck_t), intent(inout) :: deck !! the deck; gains a fault where a setting does not name its group
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

   !> The text of a deck with a setting: in place of the assignment of its key; otherwise at the end of its group, or in
   !> a new group behind all others.
   subroutine apply_setting(deck, setting, text)
      type(deck_t), intent(in) :: deck !! the deck
      type(setting_t), intent(in) :: setting !! the setting
      character(:), allocatable, intent(out) :: text !! the text
      integer :: group, first, i, k

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
            if (contents%assignments(i)%key /= setting%key) cycle
            do k = last_place(i - 1) + 1, last_place(i)
               if (text(k:k) /= newline) text(k:k) = ' '
            end do
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

end module amontons_deck
