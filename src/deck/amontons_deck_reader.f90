!> Reads a deck into the variables that a description shows, and tells all its faults at once.
module amontons_deck_reader
   use amontons_deck_contents, only: bare_value, excerpt, find_values, joined, mark_faulty, refuse_value, &
      suggestion, unquoted_value
   use amontons_deck_visitor, only: deck_visitor_t, group_t, key_t, most_values, set_default
   use amontons_input_file, only: beside
   use amontons_kinds, only: dp
   use amontons_system, only: absolute_path
   use amontons_text, only: lower_case, nearest_word, quoted, read_integer, read_real, to_text
   implicit none (type, external)
   private

   public :: deck_reader_t

   !> A deck that is read.
   type, extends(deck_visitor_t) :: deck_reader_t
      type(key_t), allocatable, private :: keys(:) !! the keys of the group visited so far
      character(:), allocatable, private :: missing !! those of them that the group must have and has not
   contains
      procedure :: open_group => reader_open_group
      procedure :: close_group => reader_close_group
      procedure :: reals => reader_reals
      procedure :: text => reader_text
      procedure :: words => reader_words
      procedure, private :: find => reader_find
      procedure, private :: judge => reader_judge
      procedure, private :: refuse_unknown_keys => reader_refuse_unknown_keys
   end type deck_reader_t

contains

   !> Finds the group in the deck.
   subroutine reader_open_group(self, group)
      class(deck_reader_t), intent(inout) :: self !! the reader
      type(group_t), intent(in) :: group !! the group

      self%place = self%deck%next_group(trim(group%name), merge(self%place, 0, self%group%name == group%name))
      self%group = group
      if (allocated(self%keys)) deallocate (self%keys)
      allocate (self%keys(0))
      self%missing = ''
   end subroutine reader_open_group

   !> Records the keys that the group cannot have, and that it must have and has not.
   subroutine reader_close_group(self)
      class(deck_reader_t), intent(inout) :: self !! the reader

      call self%refuse_unknown_keys()
      if (len(self%missing) > 0 .and. self%deck%is_understood(self%place)) then
         call self%deck%fault(self%place, '', '&'//trim(self%group%name)//' needs '//self%missing)
      end if
   end subroutine reader_close_group

   !> Reads numbers.
   subroutine reader_reals(self, key, values, is_given)
      class(deck_reader_t), intent(inout) :: self !! the reader
      type(key_t), intent(in) :: key !! the key
      real(dp), intent(inout) :: values(:) !! the numbers; those that are not given stay as they are
      logical, intent(inout), optional :: is_given !! whether the key stands in the group
      character(:), allocatable :: word
      integer :: source(size(values)), i, whole, wrong
      real(dp) :: number
      logical :: ok

      call self%find(key, key%noun(), source, is_given)
      do i = 1, size(values)
         if (source(i) == 0) cycle
         word = bare_value(self%deck%contents, source(i))
         if (key%is_whole) then
            call read_integer(word, whole, ok)
            if (ok) number = whole
         else
            call read_real(word, number, ok)
         end if
         if (ok) then
            values(i) = number
         else
            call refuse_value(self%deck%contents, self%place, key%name, source(i), 'a '//key%noun()// &
               limit_of(word, key%is_whole))
         end if
      end do
      if (all(source == 0)) return
      wrong = findloc(key%admits(values), .false., dim=1)
      if (wrong > 0) call self%judge(key, key%range(), key%numbers(values(wrong:wrong)))
      if (key%is_nonzero .and. all(abs(values) <= 0.0_dp)) call self%judge(key, 'not zero')
      if (key%is_ascending .and. any(values(2:) <= values(:size(values) - 1))) call self%judge(key, 'ascending')
   end subroutine reader_reals

   !> Reads a quoted text; one of a list of words in upper or lower case.
   subroutine reader_text(self, key, value, is_given, choices)
      class(deck_reader_t), intent(inout) :: self !! the reader
      type(key_t), intent(in) :: key !! the key
      character(:), allocatable, intent(inout) :: value !! the text without its quotes, the word as the list has it
      logical, intent(inout), optional :: is_given !! whether the key stands in the group
      character(*), intent(in), optional :: choices(:) !! the words it can be, in lower case, blank padded
      character(:), allocatable :: text
      integer :: source(1)

      call set_default(value, choices)
      call self%find(key, 'quoted text', source, is_given)
      if (source(1) == 0) return
      if (.not. self%deck%contents%values(source(1))%is_text) then
         call refuse_value(self%deck%contents, self%place, key%name, source(1), 'quoted text')
         return
      end if
      text = unquoted_value(self%deck%contents, source(1))
      if (present(choices)) then
         if (any(choices == lower_case(text))) then
            value = trim(lower_case(text))
         else
            call refuse_word(self, key, text, choices)
         end if
      else
         value = text
         if (key%is_filled .and. len_trim(text) == 0) call self%judge(key, 'not empty')
         if (key%is_file .and. len_trim(text) > 0) value = absolute_path(beside(self%deck%file, text))
      end if
   end subroutine reader_text

   !> Reads a list of words.
   subroutine reader_words(self, key, choices, is_chosen)
      class(deck_reader_t), intent(inout) :: self !! the reader
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: choices(:) !! the words it can have, in lower case, blank padded
      logical, intent(inout) :: is_chosen(:) !! which of them it has
      character(:), allocatable :: text
      integer, allocatable :: source(:)
      integer :: i

      allocate (source(self%deck%count_values(self%place, key%name, most_values)))
      call self%find(key, 'quoted text', source)
      is_chosen = .false.
      do i = 1, size(source)
         if (source(i) == 0) cycle
         if (.not. self%deck%contents%values(source(i))%is_text) then
            call refuse_value(self%deck%contents, self%place, key%name, source(i), 'quoted text')
            return
         end if
         text = unquoted_value(self%deck%contents, source(i))
         is_chosen = is_chosen .or. choices == lower_case(text)
         if (any(choices == lower_case(text))) cycle
         call refuse_word(self, key, text, choices)
         return
      end do
   end subroutine reader_words

   !> Finds the values of a key, and notes it as one of the group.
   subroutine reader_find(self, key, noun, source, is_given)
      class(deck_reader_t), intent(inout) :: self !! the reader
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: noun !! what one value is called
      integer, intent(out) :: source(:) !! which value of the deck each element has, 0 for none
      logical, intent(inout), optional :: is_given !! whether the key stands in the group
      logical :: has

      self%keys = [self%keys, key]
      call find_values(self%deck%contents, self%place, key%name, noun, source)
      has = self%has(key%name)
      if (present(is_given)) is_given = has
      if (.not. key%is_required) return
      if (.not. has) then
         if (len(self%missing) > 0) self%missing = self%missing//' and '
         self%missing = self%missing//trim(key%name)
      else if (any(source == 0) .and. any(source > 0)) then
         call self%deck%fault(self%place, key%name, trim(key%name)//': expected '//to_text(size(source))//' '// &
            noun//'s, found '//to_text(count(source > 0)))
         call mark_faulty(self%deck%contents, self%place, key%name)
      end if
   end subroutine reader_find

   !> Records that the value of a key is not what it must be.
   subroutine reader_judge(self, key, rule, found)
      class(deck_reader_t), intent(inout) :: self !! the reader
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: rule !! what the value must be
      character(*), intent(in), optional :: found !! what it is
      character(:), allocatable :: sentence

      sentence = trim(key%name)//' must be '//rule
      if (index(rule, 'not ') == 1) sentence = trim(key%name)//' must not be'//rule(4:)
      if (present(found)) sentence = sentence//', found '//found
      call self%deck%fault(self%place, key%name, sentence)
   end subroutine reader_judge

   !> Records that a text is none of the words that a key takes.
   subroutine refuse_word(self, key, text, choices)
      class(deck_reader_t), intent(inout) :: self !! the reader
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: text !! the text
      character(*), intent(in) :: choices(:) !! the words, in lower case, blank padded
      character(:), allocatable :: near

      near = nearest_word(lower_case(text), choices)
      if (near /= '') near = "; did you mean '"//near//"'?"
      call self%deck%fault(self%place, key%name, trim(key%name)//': expected one of '// &
         joined(choices, "'", "'")//', found '//excerpt(quoted(text))//near)
      call mark_faulty(self%deck%contents, self%place, key%name)
   end subroutine refuse_word

   !> Records the keys that the group cannot have.
   subroutine reader_refuse_unknown_keys(self)
      class(deck_reader_t), intent(inout) :: self !! the reader
      integer :: i

      if (self%place == 0) return
      associate (contents => self%deck%contents, group => self%deck%contents%groups(self%place))
         do i = group%first_assignment, group%last_judged
            associate (assignment => contents%assignments(i))
               if (any(self%keys%name == assignment%key)) cycle
               group%has_unknown_key = .true.
               call contents%faults%add(assignment%line, "unknown key '"//excerpt(contents%text( &
                  assignment%first:assignment%first + len(assignment%key) - 1))//"' in &"//group%name// &
                  suggestion(assignment%key, self%keys%name, self%keys%also, '', 'keys'))
            end associate
         end do
      end associate
   end subroutine reader_refuse_unknown_keys

   !> What a message adds where a word has the form of a number, but one too large or too small.
   pure function limit_of(word, is_whole) result(text)
      character(*), intent(in) :: word !! the word
      logical, intent(in) :: is_whole !! whether a whole number is expected
      character(:), allocatable :: text
      real(dp) :: mantissa
      integer :: at_exponent, exponent
      logical :: has_mantissa, has_exponent

      text = ''
      at_exponent = scan(word, 'eEdD')
      if (is_whole) then
         if (word /= '' .and. verify(word, '+-0123456789') == 0) text = ' of at most '//to_text(huge(exponent))
      else
         call read_real(word(:at_exponent - 1), mantissa, has_mantissa)
         call read_integer(word(at_exponent + 1:), exponent, has_exponent)
         if (has_mantissa .and. has_exponent) text = ' within double precision'
      end if
   end function limit_of

end module amontons_deck_reader
