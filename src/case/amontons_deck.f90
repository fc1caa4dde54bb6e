!> A deck: named groups of assignments, read with line numbers, every fault reported at once.
!>
!> The form is that of Fortran namelists, `&mesh kind = 'rectangle'  cells = 32, 10 /`, with comments from `!` on. It is
!> narrower where a namelist guesses: a quoted text closes on its line, no value may be left empty, nothing stands
!> between the groups, and a number is finite. `&end` closes a group as `/` does.
!>
!> Reading never fails once the file is open: faults of form, of type and of meaning gather in the deck, and `finish`
!> turns them into one error.
module amontons_deck
   use amontons_deck_contents, only: bare_value, deck_contents_t, find_key, find_values, hides_meaning, &
      mark_faulty, refuse_value, understands_group, understands_key, unquoted_value
   use amontons_deck_parser, only: parse_deck
   use amontons_deck_scanner, only: excerpt
   use amontons_deck_words, only: joined, suggestion, words_of
   use amontons_error, only: error_t
   use amontons_kinds, only: dp, int64
   use amontons_text, only: lower_case, quoted, read_integer, read_real, to_text
   use amontons_text_file, only: read_standard_input, read_text_file
   implicit none (type, external)
   private

   public :: deck_t, read_deck, read_deck_text

   !> A deck and what is wrong with it.
   type :: deck_t
      private
      character(:), allocatable, public :: file !! name the messages give to the deck
      type(deck_contents_t) :: contents !! what stands in it
   contains
      procedure, public :: group => deck_group
      procedure, public :: groups => deck_groups
      generic, public :: get => get_real, get_reals, get_integer, get_integers, get_logical, get_text
      procedure, public :: get_word => deck_get_word
      procedure, public :: is_sound => deck_is_sound
      procedure, public :: is_understood => deck_is_understood
      procedure, public :: knows => deck_knows
      procedure, public :: line_of => deck_line_of
      procedure, public :: n_values => deck_n_values
      procedure, public :: fault => deck_fault
      procedure, public :: refuse_unknown => deck_refuse_unknown
      procedure, public :: refuse_unknown_groups => deck_refuse_unknown_groups
      procedure, public :: finish => deck_finish
      procedure, private :: get_real => deck_get_real
      procedure, private :: get_reals => deck_get_reals
      procedure, private :: get_integer => deck_get_integer
      procedure, private :: get_integers => deck_get_integers
      procedure, private :: get_logical => deck_get_logical
      procedure, private :: get_text => deck_get_text
   end type deck_t

contains

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

   !> The first group of a name, 0 where there is none: a getter then finds every key absent.
   integer function deck_group(self, name) result(group)
      class(deck_t), intent(in) :: self !! the deck
      character(*), intent(in) :: name !! name of the group, in lower case, without `&`

      do group = 1, self%contents%n_groups
         if (self%contents%groups(group)%name == name) return
      end do
      group = 0
   end function deck_group

   !> All groups of a name, in the deck's order.
   function deck_groups(self, name) result(groups)
      class(deck_t), intent(in) :: self !! the deck
      character(*), intent(in) :: name !! name of the groups, in lower case, without `&`
      integer, allocatable :: groups(:)
      integer :: i

      groups = pack([(i, i=1, self%contents%n_groups)], &
         [(self%contents%groups(i)%name == name, i=1, self%contents%n_groups)])
   end function deck_groups

   !> Reads a real number; the value stays as it is where the key is absent.
   subroutine deck_get_real(self, group, key, value, is_given)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      real(dp), intent(inout) :: value !! the number
      logical, intent(out), optional :: is_given !! whether the key stands in the group
      real(dp) :: values(1)

      values = value
      call self%get(group, key, values, is_given)
      value = values(1)
   end subroutine deck_get_real

   !> Reads an array of real numbers; an element that is not given stays as it is.
   subroutine deck_get_reals(self, group, key, value, is_given)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      real(dp), intent(inout) :: value(:) !! the numbers
      logical, intent(out), optional :: is_given !! whether the key stands in the group
      character(:), allocatable :: word
      integer :: source(size(value)), i
      real(dp) :: number
      logical :: ok

      call find_values(self%contents, group, key, 'number', source, is_given)
      do i = 1, size(value)
         if (source(i) == 0) cycle
         word = bare_value(self%contents, source(i))
         call read_real(word, number, ok)
         if (ok) then
            value(i) = number
         else if (is_out_of_range(word)) then
            call refuse_value(self%contents, group, key, source(i), 'a number within double precision')
         else
            call refuse_value(self%contents, group, key, source(i), 'a number')
         end if
      end do
   end subroutine deck_get_reals

   !> Reads a whole number; the value stays as it is where the key is absent.
   subroutine deck_get_integer(self, group, key, value, is_given)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      integer, intent(inout) :: value !! the number
      logical, intent(out), optional :: is_given !! whether the key stands in the group
      integer :: values(1)

      values = value
      call self%get(group, key, values, is_given)
      value = values(1)
   end subroutine deck_get_integer

   !> Reads an array of whole numbers; an element that is not given stays as it is.
   subroutine deck_get_integers(self, group, key, value, is_given)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      integer, intent(inout) :: value(:) !! the numbers
      logical, intent(out), optional :: is_given !! whether the key stands in the group
      character(:), allocatable :: word
      integer :: source(size(value)), i, number
      logical :: ok

      call find_values(self%contents, group, key, 'whole number', source, is_given)
      do i = 1, size(value)
         if (source(i) == 0) cycle
         word = bare_value(self%contents, source(i))
         call read_integer(word, number, ok)
         if (ok) then
            value(i) = number
         else if (word /= '' .and. verify(word, '+-0123456789') == 0) then
            call refuse_value(self%contents, group, key, source(i), 'a whole number of at most '//to_text(huge(number)))
         else
            call refuse_value(self%contents, group, key, source(i), 'a whole number')
         end if
      end do
   end subroutine deck_get_integers

   !> Reads a logical; the value stays as it is where the key is absent.
   subroutine deck_get_logical(self, group, key, value, is_given)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      logical, intent(inout) :: value !! the truth value
      logical, intent(out), optional :: is_given !! whether the key stands in the group
      integer :: source(1)

      call find_values(self%contents, group, key, 'logical', source, is_given)
      if (source(1) == 0) return
      select case (lower_case(bare_value(self%contents, source(1))))
      case ('.true.', '.t.', 'true', 't')
         value = .true.
      case ('.false.', '.f.', 'false', 'f')
         value = .false.
      case default
         call refuse_value(self%contents, group, key, source(1), '.true. or .false.')
      end select
   end subroutine deck_get_logical

   !> Reads a quoted text; the value stays as it is where the key is absent.
   subroutine deck_get_text(self, group, key, value, is_given)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      character(:), allocatable, intent(inout) :: value !! the text without its quotes
      logical, intent(out), optional :: is_given !! whether the key stands in the group
      integer :: source(1)

      call find_values(self%contents, group, key, 'quoted text', source, is_given)
      if (source(1) == 0) return
      if (self%contents%values(source(1))%is_text) then
         value = unquoted_value(self%contents, source(1))
      else
         call refuse_value(self%contents, group, key, source(1), 'quoted text')
      end if
   end subroutine deck_get_text

   !> Reads a quoted word that must be one of a list, in upper or lower case; the value stays where the key is absent.
   subroutine deck_get_word(self, group, key, value, choices)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      character(:), allocatable, intent(inout) :: value !! the word as the list has it
      character(*), intent(in) :: choices(:) !! the list, in lower case, blank padded
      character(:), allocatable :: word

      call self%get(group, key, word)
      if (.not. allocated(word)) return
      if (any(choices == lower_case(word))) then
         value = trim(lower_case(word))
      else
         call self%fault(group, key, key//': expected one of '//joined(choices, "'", "'")//', found '// &
            excerpt(quoted(word))//suggestion(lower_case(word), choices, "'", "'"))
         call mark_faulty(self%contents, group, key)
      end if
   end subroutine deck_get_word

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

   !> Whether everything that a group says is understood, so that its keys can be judged together. A group that is
   !> absent may be one that another fault hides: it counts as understood only if the whole deck is in order.
   pure logical function deck_is_understood(self, group) result(is_understood)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0

      is_understood = understands_group(self%contents, group)
   end function deck_is_understood

   !> Whether a group is understood and makes sense so far.
   pure logical function deck_is_sound(self, group) result(is_sound)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0

      is_sound = understands_group(self%contents, group)
      if (group > 0) is_sound = is_sound .and. .not. self%contents%groups(group)%is_faulty
   end function deck_is_sound

   !> Whether it is known what a key says in all groups of a name, so that other groups can be judged by it.
   pure logical function deck_knows(self, name, key) result(knows)
      class(deck_t), intent(in) :: self !! the deck
      character(*), intent(in) :: name !! name of the groups
      character(*), intent(in) :: key !! name of the key

      knows = understands_key(self%contents, name, key)
   end function deck_knows

   !> Number of values that stand behind a key, repeat counts included; 0 where the key is absent.
   pure integer(int64) function deck_n_values(self, group, key) result(n_values)
      class(deck_t), intent(in) :: self !! the deck
      integer, intent(in) :: group !! the group, or 0
      character(*), intent(in) :: key !! name of the key, in lower case
      integer :: assignment

      n_values = 0
      assignment = find_key(self%contents, group, key)
      if (assignment == 0) return
      associate (given => self%contents%assignments(assignment))
         n_values = sum(int(self%contents%values(given%first_value:given%last_value)%n_times, int64))
      end associate
   end function deck_n_values

   !> Records the keys of a group that no getter asked for.
   subroutine deck_refuse_unknown(self, group)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0
      integer :: i

      if (group == 0) return
      associate (contents => self%contents, name => self%contents%groups(group)%name, &
         keys => self%contents%groups(group)%known_keys)
         do i = contents%groups(group)%first_assignment, contents%groups(group)%last_judged
            associate (assignment => contents%assignments(i))
               if (index(keys, ' '//assignment%key//' ') > 0) cycle
               contents%groups(group)%has_unknown_key = .true.
               call contents%faults%add(assignment%line, "'"//excerpt(assignment%key)//"' is not a key of &"//name// &
                  suggestion(assignment%key, words_of(keys), "'", "'")//' (keys: '//joined(words_of(keys), '', '')//')')
            end associate
         end do
      end associate
   end subroutine deck_refuse_unknown

   !> Records the groups that are unknown, and those that stand more often than they may.
   subroutine deck_refuse_unknown_groups(self, known_names, repeatable_names)
      class(deck_t), intent(inout) :: self !! the deck, gains the faults
      character(*), intent(in) :: known_names(:) !! names of all groups a deck may have, in lower case, blank padded
      character(*), intent(in) :: repeatable_names(:) !! those of them that may stand more than once
      integer :: i, first_line(size(known_names)), known

      first_line = 0
      do i = 1, self%contents%n_groups
         associate (group => self%contents%groups(i))
            known = findloc(known_names == group%name, .true., dim=1)
            if (known == 0) then
               self%contents%hides_groups = .true.
               call self%contents%faults%add(group%line, '&'//excerpt(group%name)//' is not a group of a deck'// &
                  suggestion(group%name, known_names, '&', '')//' (groups: '//joined(known_names, '&', '')//')')
            else if (first_line(known) == 0) then
               first_line(known) = group%line
            else if (all(repeatable_names /= group%name)) then
               call self%contents%faults%add(group%line, '&'//group%name//' may stand only once; it stands at line '// &
                  to_text(first_line(known))//' already')
            end if
         end associate
      end do
   end subroutine deck_refuse_unknown_groups

   !> Turns the faults into one error that tells them all, a line of text for each.
   subroutine deck_finish(self, error)
      class(deck_t), intent(in) :: self !! the deck
      type(error_t), allocatable, intent(out) :: error !! the faults, ordered by line, where there is any

      call self%contents%faults%finish(self%file, error)
   end subroutine deck_finish

   !> Whether a word that is not read as a real has the form of one: mantissa and exponent.
   pure logical function is_out_of_range(word)
      character(*), intent(in) :: word !! the word
      real(dp) :: mantissa
      integer :: at_exponent, exponent
      logical :: has_mantissa, has_exponent

      at_exponent = scan(word, 'eEdD')
      call read_real(word(:at_exponent - 1), mantissa, has_mantissa)
      call read_integer(word(at_exponent + 1:), exponent, has_exponent)
      is_out_of_range = has_mantissa .and. has_exponent
   end function is_out_of_range

end module amontons_deck
