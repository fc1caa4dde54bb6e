!> A visitor of the groups and keys that a deck may have: it reads a deck and reports all its faults at once. Its
!> extensions write a deck, or document the groups and keys.
!>
!> A group is described once, by a procedure that shows every key to a visitor, together with the variable that holds
!> its value:
!>
!>    call visitor%open_group(mesh_group)
!>    call visitor%real(key_t('grading', 'height of the top row over the bottom row', above=0.0_dp), grading)
!>    call visitor%close_group()
!>
!> A reader sets the variable, a writer writes it into a deck, a documenter makes a row of a Markdown table of it. Rules
!> about several keys follow after the group; a reader checks them, and they have no effect elsewhere.
module amontons_deck_visitor
   use amontons_deck, only: deck_t
   use amontons_deck_contents, only: bare_value, excerpt, find_values, joined, mark_faulty, refuse_value, &
      suggestion, unquoted_value
   use amontons_error, only: error_t
   use amontons_input_file, only: read_number_table
   use amontons_kinds, only: dp
   use amontons_text, only: lower_case, nearest_word, newline, quoted, read_integer, read_real, to_text
   implicit none (type, external)
   private

   public :: body_words, deck_documenter_t, deck_visitor_t, deck_writer_t, group_t, is_filled, key_t, names_text

   !> Largest number of values in a list.
   integer, parameter, public :: most_values = 1000000

   !> A group of a deck.
   type :: group_t
      character(8) :: name = '' !! its name
      logical :: is_repeatable = .false. !! whether it may occur more than once
      logical :: is_shared = .false. !! whether decks that share a factorization agree in all its keys
   end type group_t

   !> A key of a group, with everything that is known about it without its value.
   type :: key_t
      character(17) :: name = '' !! its name
      character(190) :: meaning = '' !! its meaning, in Markdown
      character(6) :: unit = '' !! unit of its values
      character(70) :: default = '' !! the default, in Markdown; empty for the initial value of the variable
      character(48) :: also = '' !! its names in other programs, separated by blanks
      character(24) :: hint = '' !! what else may have been meant by a text that it cannot be
      real(dp) :: above = -huge(1.0_dp) !! its numbers are larger than this
      real(dp) :: at_least = -huge(1.0_dp) !! its numbers are not smaller than this
      real(dp) :: below = huge(1.0_dp) !! its numbers are smaller than this
      logical :: is_whole = .false. !! whether its numbers are whole
      logical :: is_nonzero = .false. !! whether its numbers are not all 0
      logical :: is_ascending = .false. !! whether its numbers ascend
      logical :: is_filled = .false. !! whether its text is not empty
      logical :: is_file = .false. !! whether its text is the name of a file, seen from the deck's directory
      logical :: is_required = .false. !! whether the group must have it
      logical :: is_shared = .false. !! whether decks that share a factorization agree in it
      logical :: is_free = .false. !! whether these may differ in its value, though not in whether it is given
      logical :: is_vector = .false. !! whether its numbers are one for each dimension, or for each pair of them
   contains
      procedure :: includes => key_includes
      procedure :: noun => key_noun
      procedure :: numbers => key_numbers
      procedure :: range => key_range
   end type key_t

   !> A visitor of the groups of a deck: a reader, unless an extension overrides the procedures for groups and keys.
   type :: deck_visitor_t
      type(deck_t) :: deck !! the deck that is read; without groups where none is
      type(group_t) :: group !! the group that is visited
      integer :: place = 0 !! which group of the deck it is; 0 where the deck has none
      integer :: n_dim = 0 !! number of dimensions that the keys visited so far state; 0 where none does
      character(:), allocatable :: dimension_key !! the key that stated them first: 'traction of 3 numbers'
      integer :: dimension_line = 0 !! its line
      type(key_t), allocatable, private :: keys(:) !! the keys of the group visited so far
      character(:), allocatable, private :: missing !! those of them that the group must have and has not
   contains
      procedure :: open_group => visitor_open_group
      procedure :: close_group => visitor_close_group
      procedure :: reals => visitor_reals
      procedure :: text => visitor_text
      procedure :: flag => visitor_flag
      procedure :: words => visitor_words
      procedure :: vector => visitor_vector
      procedure :: state_dimensions => visitor_state_dimensions
      procedure :: real => visitor_real
      procedure :: list => visitor_list
      procedure :: whole => visitor_whole
      procedure :: wholes => visitor_wholes
      procedure :: word => visitor_word
      procedure :: has => visitor_has
      procedure :: is_judging => visitor_is_judging
      procedure :: locate => visitor_locate
      procedure :: only => visitor_only
      procedure :: require => visitor_require
      procedure :: table => visitor_table
      procedure, private :: find => visitor_find
      procedure, private :: judge => visitor_judge
   end type deck_visitor_t

   !> Columns of a line; a key with a single long value may exceed it.
   integer, parameter :: width = 120

   !> A deck that is written.
   type, extends(deck_visitor_t) :: deck_writer_t
      logical :: is_shared_only = .false. !! whether only what decks that share a factorization agree in is written
      logical :: shows_all = .false. !! whether keys without a value are shown, too
      character(:), allocatable :: written !! the groups written so far
      character(:), allocatable, private :: line !! the last line of the group being written; empty before its first key
   contains
      procedure :: open_group => writer_open_group
      procedure :: close_group => writer_close_group
      procedure :: reals => writer_reals
      procedure :: text => writer_text
      procedure :: flag => writer_flag
      procedure :: words => writer_words
      procedure :: write_key => writer_write_key
   end type deck_writer_t

   !> The Markdown tables of the groups visited so far, one row for each key; the last line has no newline yet.
   type, extends(deck_writer_t) :: deck_documenter_t
      character(:), allocatable :: wanted !! name of the only group to document; empty for all
   contains
      procedure :: open_group => documenter_open_group
      procedure :: close_group => documenter_close_group
      procedure, private :: write => documenter_write
      procedure :: write_key => documenter_write_key
   end type deck_documenter_t

contains

   !> Visits a key that has one real number.
   subroutine visitor_real(self, key, value, is_given)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      real(dp), intent(inout) :: value !! the number
      logical, intent(inout), optional :: is_given !! see the procedure for reals
      real(dp) :: values(1)

      values = value
      call self%reals(key, values, is_given)
      value = values(1)
   end subroutine visitor_real

   !> Visits a key that has one whole number.
   subroutine visitor_whole(self, key, value, is_given)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      integer, intent(inout) :: value !! the number
      logical, intent(inout), optional :: is_given !! see the procedure for reals
      integer :: values(1)

      values = value
      call self%wholes(key, values, is_given)
      value = values(1)
   end subroutine visitor_whole

   !> Visits a fixed number of whole numbers.
   subroutine visitor_wholes(self, key, values, is_given)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      integer, intent(inout) :: values(:) !! the numbers
      logical, intent(inout), optional :: is_given !! see the procedure for reals
      type(key_t) :: whole_key
      real(dp) :: numbers(size(values))

      whole_key = key
      whole_key%is_whole = .true.
      numbers = values
      call self%reals(whole_key, numbers, is_given)
      values = nint(numbers)
   end subroutine visitor_wholes

   !> Visits a vector, which has two numbers in the plane and three in a solid, or the gradient of one, which has the
   !> square of this: all components of its change along x, then of that along y, and so on.
   subroutine visitor_vector(self, key, values, is_given)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      real(dp), intent(inout) :: values(:)
         !! the numbers in space (3 or 9); those that the plane has not stay as they are
      logical, intent(inout), optional :: is_given !! see the procedure for reals
      type(key_t) :: vector_key
      real(dp), allocatable :: own(:)
      integer :: n, n_dim
      logical :: is_own(3, 3)

      n = 0
      n_dim = merge(3, 2, self%n_dim == 3)
      if (self%has(key%name)) n = self%deck%count_values(self%place, key%name, size(values) + 1)
      if (n == size(values)) n_dim = 3
      if (n == 2 .and. size(values) == 3 .or. n == 4) n_dim = 2
      vector_key = key
      vector_key%is_vector = .true.
      is_own = .false.
      is_own(:n_dim, :n_dim) = .true.
      associate (is_chosen => pack(is_own(:, :size(values)/3), .true.))
         own = pack(values, is_chosen)
         call self%reals(vector_key, own, is_given)
         values = unpack(own, is_chosen, values)
      end associate
      if (n == size(own)) call self%state_dimensions(n_dim, key%name, ' of '//to_text(n)//' numbers')
   end subroutine visitor_vector

   !> Notes that keys, where they are given, are those of a plane body or of a solid, and refuses those that contradict
   !> each other.
   subroutine visitor_state_dimensions(self, n_dim, keys, form)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      integer, intent(in) :: n_dim !! number of dimensions, 2 or 3
      character(*), intent(in) :: keys !! names of the keys, a blank between two
      character(*), intent(in), optional :: form !! what about them states it: ' of 3 numbers'
      character(:), allocatable :: stating
      integer :: first, last

      last = -1
      do while (last < len_trim(keys))
         first = last + 2
         last = first + index(trim(keys(first:))//' ', ' ') - 2
         if (.not. self%has(keys(first:last))) cycle
         stating = keys(first:last)
         if (present(form)) stating = stating//form
         if (self%n_dim == 0) then
            self%n_dim = n_dim
            self%dimension_key = stating
            self%dimension_line = self%deck%line_of(self%place, keys(first:last))
         end if
         call self%require(self%n_dim == n_dim, keys(first:last), stating//body_words(n_dim)//', but '// &
            self%dimension_key//' in line '//to_text(self%dimension_line)//body_words(self%n_dim))
      end do
   end subroutine visitor_state_dimensions

   !> What keys of so many dimensions are for, as a sentence on one of them ends.
   pure function body_words(n_dim) result(words)
      integer, intent(in) :: n_dim !! number of dimensions, 2 or 3
      character(:), allocatable :: words

      words = ' is for '//trim(merge('a solid     ', 'a plane body', n_dim == 3))
   end function body_words

   !> Visits a list of real numbers of any length.
   subroutine visitor_list(self, key, values, is_given)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      real(dp), allocatable, intent(inout) :: values(:) !! the numbers; they stay as they are where none are given
      logical, intent(inout), optional :: is_given !! see the procedure for reals
      real(dp), allocatable :: numbers(:)
      logical :: is_empty

      is_empty = .not. allocated(values)
      if (present(is_given)) is_empty = is_empty .or. .not. is_given
      if (self%has(key%name)) then
         allocate (numbers(self%deck%count_values(self%place, key%name, most_values)), source=0.0_dp)
      else if (is_empty) then
         allocate (numbers(0))
      else
         numbers = values
      end if
      call self%reals(key, numbers, is_given)
      if (self%has(key%name)) call move_alloc(numbers, values)
   end subroutine visitor_list

   !> Visits a key that has one word of a list.
   subroutine visitor_word(self, key, value, choices, is_given)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      ! allow(C072): words of different keys have different lengths
      character(*), intent(inout) :: value !! the word, blank padded
      character(*), intent(in) :: choices(:) !! the words it can be, in lower case, blank padded
      logical, intent(inout), optional :: is_given !! see the procedure for reals
      character(:), allocatable :: word

      word = trim(value)
      call self%text(key, word, is_given, choices)
      value = word
   end subroutine visitor_word

   !> Whether the group being read has a key; false if none is being read.
   logical function visitor_has(self, key) result(has)
      class(deck_visitor_t), intent(in) :: self !! the visitor
      character(*), intent(in) :: key !! name of the key

      has = self%deck%has(self%place, key)
   end function visitor_has

   !> Whether a group is being read and is understood, so that its keys can be judged together.
   logical function visitor_is_judging(self) result(is_judging)
      class(deck_visitor_t), intent(in) :: self !! the visitor

      is_judging = self%place > 0 .and. self%deck%is_understood(self%place)
   end function visitor_is_judging

   !> Finds the line of a key of the group being read, or of the group if it has no such key, in the form in which
   !> messages begin: 'deck.nml:12: '.
   subroutine visitor_locate(self, key, origin)
      class(deck_visitor_t), intent(in) :: self !! the visitor
      character(*), intent(in) :: key !! name of the key
      character(:), allocatable, intent(inout) :: origin !! the place; stays as it is where none is read

      if (self%place > 0) origin = self%deck%file//':'//to_text(self%deck%line_of(self%place, key))//': '
   end subroutine visitor_locate

   !> Refuses keys that are given although they have no meaning there.
   subroutine visitor_only(self, keys, is_allowed, condition)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      character(*), intent(in) :: keys !! names of the keys, a blank between two
      logical, intent(in) :: is_allowed !! whether they may be given
      character(*), intent(in) :: condition !! when they may, for the message: "kind = 'file'"
      integer :: first, last

      first = 1
      do while (first <= len(keys))
         last = first + index(keys(first:)//' ', ' ') - 2
         associate (key => keys(first:last))
            if (self%has(key)) call self%require(is_allowed, key, key//' is only for '//condition)
         end associate
         first = last + 2
      end do
   end subroutine visitor_only

   !> Records a fault of the group being read unless a condition holds.
   subroutine visitor_require(self, holds, key, sentence)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      logical, intent(in) :: holds !! the condition
      character(*), intent(in) :: key !! name of the key at whose line the fault is reported
      character(*), intent(in) :: sentence !! the fault, as a sentence

      if (self%place > 0 .and. .not. holds) call self%deck%fault(self%place, key, sentence)
   end subroutine visitor_require

   !> Reads the table in a file that a key of the group names.
   subroutine visitor_table(self, key, file, table, n_columns, station, least)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      character(*), intent(in) :: key !! name of the key
      character(:), allocatable, intent(in) :: file !! name of the file from the root on; empty without one
      real(dp), allocatable, intent(inout) :: table(:, :) !! the table (columns, rows)
      integer, intent(in), optional :: n_columns !! number of columns, 2 where it is not present
      character(*), intent(in), optional :: station !! what the first column holds if it must increase
      real(dp), intent(in), optional :: least !! smallest number allowed in the other columns
      type(error_t), allocatable :: error

      if (.not. (self%has(key) .and. is_filled(file))) return
      call read_number_table(table, file, error, n_columns, station, least)
      if (allocated(error)) call self%require(.false., key, key//': '//error%message)
   end subroutine visitor_table

   !> Whether a number is within the range of a key.
   elemental logical function key_includes(self, number)
      class(key_t), intent(in) :: self !! the key
      real(dp), intent(in) :: number !! the number

      key_includes = number >= self%at_least .and. (number > self%above .or. self%above <= -huge(1.0_dp)) .and. &
         (number < self%below .or. self%below >= huge(1.0_dp))
   end function key_includes

   !> The range of the numbers of a key in words: 'above -1 and below 0.5'; empty if there is none.
   pure function key_range(self) result(text)
      class(key_t), intent(in) :: self !! the key
      character(:), allocatable :: text

      text = ''
      if (self%at_least > -huge(1.0_dp)) text = 'at least '//bound_text(self%at_least)
      if (self%above > -huge(1.0_dp)) text = 'above '//bound_text(self%above)
      if (self%below < huge(1.0_dp)) text = text//' and below '//bound_text(self%below)
   end function key_range

   !> A bound in the shortest form: `0` rather than `0.0`.
   pure function bound_text(bound) result(text)
      real(dp), intent(in) :: bound !! the bound
      character(:), allocatable :: text

      text = to_text(bound)
      if (index(text, '.0') == len(text) - 1) text = text(:len(text) - 2)
   end function bound_text

   !> Noun for the values that a key expects, for messages: `number` or `whole number`.
   pure function key_noun(self) result(noun)
      class(key_t), intent(in) :: self !! the key
      character(:), allocatable :: noun

      noun = 'number'
      if (self%is_whole) noun = 'whole number'
   end function key_noun

   !> The numbers of a key separated by commas, about ten in a line. The two halves of a list are converted and joined:
   !> appending one value after the other would copy the text as often as there are values.
   pure function key_numbers(self, values) result(text)
      class(key_t), intent(in) :: self !! the key
      real(dp), intent(in) :: values(:) !! the numbers
      character(:), allocatable :: text

      text = ''
      if (size(values) > 0) call append_list(text, values, self%is_whole)
   end function key_numbers

   !> Appends numbers separated by commas; a subroutine, since gfortran 12 forgets the length of a text that a function
   !> returns when the function calls itself.
   pure recursive subroutine append_list(text, values, are_whole)
      character(:), allocatable, intent(inout) :: text !! the text
      real(dp), intent(in) :: values(:) !! the numbers, one at the least
      logical, intent(in) :: are_whole !! whether they are whole
      integer, parameter :: values_per_line = 10
      character(:), allocatable :: rest
      integer :: half

      half = size(values)/2
      if (half == 0 .and. are_whole) then
         text = text//to_text(nint(values(1)))
      else if (half == 0) then
         text = text//to_text(values(1))
      else
         rest = ', '
         if (size(values) > values_per_line) rest = ','//newline//'   '
         call append_list(rest, values(half + 1:), are_whole)
         call append_list(text, values(:half), are_whole)
         text = text//rest
      end if
   end subroutine append_list

   !> Sets a text that is not allocated, or an empty word, to its default.
   pure subroutine set_default(text, choices)
      character(:), allocatable, intent(inout) :: text !! the text
      character(*), intent(in), optional :: choices(:) !! the words it can be, the default first; empty without any

      if (.not. allocated(text)) text = ''
      if (present(choices) .and. len(text) == 0) text = trim(choices(1))
   end subroutine set_default

   !> Whether a text is allocated and not empty.
   pure logical function is_filled(text)
      character(:), allocatable, intent(in) :: text !! the text

      is_filled = allocated(text)
      if (is_filled) is_filled = len_trim(text) > 0
   end function is_filled

   !> Writes the opening of a group, `&name`.
   subroutine writer_open_group(self, group)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(group_t), intent(in) :: group !! the group

      self%group = group
      self%line = ''
      if (.not. allocated(self%written)) self%written = ''
   end subroutine writer_open_group

   !> Writes the end of a group; a group without keys is omitted.
   subroutine writer_close_group(self)
      class(deck_writer_t), intent(inout) :: self !! the writer

      if (self%line /= '') self%written = self%written//self%line//' /'//newline
   end subroutine writer_close_group

   !> Writes a key and its numbers.
   subroutine writer_reals(self, key, values, is_given)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      real(dp), intent(inout) :: values(:) !! the numbers
      logical, intent(inout), optional :: is_given
         !! whether they are written; for tables, whether they are defaults; default whether the key can have them
      character(:), allocatable :: kind, range
      logical :: is_written

      is_written = all(key%includes(values)) .and. .not. (key%is_nonzero .and. all(abs(values) <= 0.0_dp))
      if (present(is_given)) is_written = is_given
      if (.not. (is_written .or. self%shows_all)) return
      kind = key%noun()
      if (size(values) /= 1) kind = kind//'s'
      if (key%is_vector) then
         kind = trim(merge('2 or 3', '4 or 9', size(values) < 4))//' '//kind
      else if (size(values) > 1) then
         kind = to_text(size(values))//' '//kind
      end if
      range = key%range()
      if (index(range, 'at least') == 1) range = ', '//range
      if (index(range, 'above') == 1) range = ' '//range
      if (key%is_nonzero) range = trim(merge(', not both 0', ', not 0     ', size(values) == 2 &
         .and. .not. key%is_vector))
      if (key%is_ascending) range = range//', ascending'
      call self%write_key(key, kind//range, key%numbers(values), is_written .and. size(values) > 0)
   end subroutine writer_reals

   !> Writes a key and its text, in quotes.
   subroutine writer_text(self, key, value, is_given, choices)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      character(:), allocatable, intent(inout) :: value !! the text
      logical, intent(inout), optional :: is_given !! see the procedure for reals
      character(*), intent(in), optional :: choices(:) !! the words it can be
      character(:), allocatable :: kind
      logical :: is_written

      call set_default(value, choices)
      kind = 'text'
      if (present(choices)) kind = joined(choices, "`'", "'`")
      is_written = is_filled(value) .or. .not. (key%is_filled .or. key%is_file .or. key%default /= '')
      if (present(is_given)) is_written = is_given
      call self%write_key(key, kind, quoted(value), is_written)
   end subroutine writer_text

   !> Writes a logical value that is true.
   subroutine writer_flag(self, key, value)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      logical, intent(inout) :: value !! the value

      call self%write_key(key, 'logical value: `.true.` or `.false.`', trim(merge('.true. ', '.false.', value)), value)
   end subroutine writer_flag

   !> Writes a list of words; nothing if it is empty.
   subroutine writer_words(self, key, choices, is_chosen)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: choices(:) !! the words it can have
      logical, intent(inout) :: is_chosen(:) !! whether each of them is chosen
      character(:), allocatable :: list
      integer :: i

      list = ''
      do i = 1, size(choices)
         if (is_chosen(i)) list = list//', '//quoted(trim(choices(i)))
      end do
      call self%write_key(key, 'texts: one or more of '//joined(choices, "`'", "'`"), list(min(3, len(list) + 1):), &
         any(is_chosen))
   end subroutine writer_words

   !> Writes a key and its value, on a new line if it does not fit.
   subroutine writer_write_key(self, key, kind, value, is_given)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: kind !! kind of its values, for tables
      character(*), intent(in) :: value !! the value as a deck has it
      logical, intent(in) :: is_given !! whether it is written
      character(:), allocatable :: item

      if (key%is_vector .and. self%n_dim == 0) return
      if (.not. is_given .or. (self%is_shared_only .and. .not. (self%group%is_shared .or. key%is_shared))) return
      item = trim(key%name)//' = '//value
      if (self%is_shared_only .and. key%is_free) item = trim(key%name)
      if (self%line == '') then
         self%line = '&'//trim(self%group%name)//' '//item
      else if (len(self%line) - index(self%line, newline, back=.true.) + len(item) + 4 > width) then
         self%line = self%line//newline//'   '//item
      else
         self%line = self%line//'  '//item
      end if
      associate (unused => kind)
      end associate
   end subroutine writer_write_key

   !> Writes the heading of a group and of its table.
   subroutine documenter_open_group(self, group)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      type(group_t), intent(in) :: group !! the group

      self%group = group
      self%shows_all = .true.
      if (len(self%written) > 0) call self%write(newline//newline)
      call self%write('### `&'//trim(group%name)//'`'//trim(merge(' (may be repeated)', '                  ', &
         group%is_repeatable))//newline//newline//'| key | value | unit | default | meaning |'//newline// &
         '|---|---|---|---|---|')
   end subroutine documenter_open_group

   !> Ends the table of a group.
   subroutine documenter_close_group(self)
      class(deck_documenter_t), intent(inout) :: self !! the documenter

      self%group = group_t()
   end subroutine documenter_close_group

   !> Writes the row of a key in the table of its group.
   subroutine documenter_write_key(self, key, kind, value, is_given)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: kind !! kind of its values
      character(*), intent(in) :: value !! its default as a deck has it
      logical, intent(in) :: is_given !! whether this is its default
      character(:), allocatable :: name, shown

      name = '`'//trim(key%name)//'`'
      if (key%is_required) name = '**'//name//'**'
      shown = trim(key%default)
      if (shown == '' .and. is_given .and. .not. key%is_required) shown = '`'//value//'`'
      ! A cell that is empty has one blank.
      call self%write(newline//'| '//name//' | '//kind//' |'//trim(' '//key%unit)//' |'//trim(' '//shown)//' | '// &
         trim(key%meaning)//' |')
   end subroutine documenter_write_key

   !> Writes a text, unless it belongs to a group that was not asked for.
   subroutine documenter_write(self, text)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      character(*), intent(in) :: text !! the text

      if (self%wanted == '' .or. self%wanted == self%group%name) self%written = self%written//text
   end subroutine documenter_write

   !> Opens a group: finds it in the deck, the next one with this name if the group is the same as before.
   subroutine visitor_open_group(self, group)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(group_t), intent(in) :: group !! the group

      self%place = self%deck%next_group(trim(group%name), merge(self%place, 0, self%group%name == group%name))
      self%group = group
      if (allocated(self%keys)) deallocate (self%keys)
      allocate (self%keys(0))
      self%missing = ''
   end subroutine visitor_open_group

   !> Closes a group: records unknown keys and missing ones. Rules about the keys may follow.
   subroutine visitor_close_group(self)
      class(deck_visitor_t), intent(inout) :: self !! the visitor

      integer :: i

      if (self%place > 0) then
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
      end if
      if (len(self%missing) > 0 .and. self%deck%is_understood(self%place)) then
         call self%deck%fault(self%place, '', '&'//trim(self%group%name)//' needs '//self%missing)
      end if
   end subroutine visitor_close_group

   !> Visits a fixed number of reals, or of whole numbers if the key requires them.
   subroutine visitor_reals(self, key, values, is_given)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      real(dp), intent(inout) :: values(:)
         !! the numbers; those that a deck does not give stay as they are; none for a list of any length
      logical, intent(inout), optional :: is_given
         !! whether the key is to be written; on return from a reader, whether the group has it
      character(:), allocatable :: word, limits
      integer :: source(size(values)), i, whole, wrong, at_exponent, exponent
      real(dp) :: number, mantissa
      logical :: ok, has_mantissa, has_exponent

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
            ! A word that has the form of a number, but is too large or too small, gets its limit in the message.
            limits = ''
            at_exponent = scan(word, 'eEdD')
            if (key%is_whole) then
               if (word /= '' .and. verify(word, '+-0123456789') == 0) limits = ' of at most '//to_text(huge(exponent))
            else
               call read_real(word(:at_exponent - 1), mantissa, has_mantissa)
               call read_integer(word(at_exponent + 1:), exponent, has_exponent)
               if (has_mantissa .and. has_exponent) limits = ' within double precision'
            end if
            call refuse_value(self%deck%contents, self%place, key%name, source(i), 'a '//key%noun()//limits)
         end if
      end do
      if (all(source == 0)) return
      wrong = findloc(key%includes(values), .false., dim=1)
      if (wrong > 0) call self%judge(key, key%range(), key%numbers(values(wrong:wrong)))
      if (key%is_nonzero .and. all(abs(values) <= 0.0_dp)) call self%judge(key, 'not zero')
      if (key%is_ascending .and. any(values(2:) <= values(:size(values) - 1))) call self%judge(key, 'ascending')
   end subroutine visitor_reals

   !> Visits a quoted text; if it is one of a list of words, upper and lower case are the same.
   subroutine visitor_text(self, key, value, is_given, choices)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      character(:), allocatable, intent(inout) :: value
         !! the text; an empty one where it is not allocated, and where that is no choice, the first of them
      logical, intent(inout), optional :: is_given !! see the procedure for reals
      character(*), intent(in), optional :: choices(:) !! the words it can be, in lower case, blank padded
      character(:), allocatable :: text
      integer :: source(1)

      call set_default(value, choices)
      call self%find(key, expected_text(key), source, is_given)
      if (source(1) == 0) return
      if (.not. self%deck%contents%values(source(1))%is_text) then
         call refuse_value(self%deck%contents, self%place, key%name, source(1), expected_text(key, choices))
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
         if (key%is_file .and. len_trim(text) > 0) value = self%deck%path_of(self%place, key%name, text)
      end if
   end subroutine visitor_text

   !> Visits a key that has a logical value.
   subroutine visitor_flag(self, key, value)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      logical, intent(inout) :: value !! the value; stays as it is where the deck does not give it
      character(*), parameter :: noun = 'logical value'
      character(:), allocatable :: word
      integer :: source(1)

      call self%find(key, noun, source)
      if (source(1) == 0) return
      word = lower_case(bare_value(self%deck%contents, source(1)))
      value = any(word == [character(6) :: '.true.', 'true', 't'])
      if (.not. (value .or. any(word == [character(7) :: '.false.', 'false', 'f']))) call refuse_value( &
         self%deck%contents, self%place, key%name, source(1), '.true. or .false.')
   end subroutine visitor_flag

   !> Visits a key that has one or more words of a list.
   subroutine visitor_words(self, key, choices, is_chosen)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: choices(:) !! the words it can have, in lower case, blank padded
      logical, intent(inout) :: is_chosen(:) !! whether each of them is chosen
      character(:), allocatable :: text
      integer, allocatable :: source(:)
      integer :: i

      allocate (source(self%deck%count_values(self%place, key%name, most_values)))
      call self%find(key, 'quoted text', source)
      is_chosen = .false.
      do i = 1, size(source)
         if (source(i) == 0) cycle
         if (.not. self%deck%contents%values(source(i))%is_text) then
            call refuse_value(self%deck%contents, self%place, key%name, source(i), expected_text(key, choices))
            return
         end if
         text = unquoted_value(self%deck%contents, source(i))
         is_chosen = is_chosen .or. choices == lower_case(text)
         if (any(choices == lower_case(text))) cycle
         call refuse_word(self, key, text, choices)
         return
      end do
   end subroutine visitor_words

   !> Finds the values of a key, and adds the key to those that the group may have.
   subroutine visitor_find(self, key, noun, source, is_given)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: noun !! noun for a value, for messages
      integer, intent(out) :: source(:) !! which value of the deck each element has, 0 for none
      logical, intent(inout), optional :: is_given !! whether the group has the key
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
   end subroutine visitor_find

   !> Records that the value of a key violates a rule.
   subroutine visitor_judge(self, key, rule, found)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: rule !! the rule, for the message
      character(*), intent(in), optional :: found !! its kind
      character(:), allocatable :: sentence

      sentence = trim(key%name)//' must be '//rule
      if (index(rule, 'not ') == 1) sentence = trim(key%name)//' must not be'//rule(4:)
      if (present(found)) sentence = sentence//', found '//found
      call self%deck%fault(self%place, key%name, sentence)
   end subroutine visitor_judge

   !> The values that a key with a text accepts, for messages.
   pure function expected_text(key, choices) result(text)
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in), optional :: choices(:) !! the words it can be, in lower case, blank padded
      character(:), allocatable :: text

      text = 'quoted text'
      if (present(choices)) text = 'one of '//joined(choices, "'", "'")
      if (key%hint /= '') text = text//' ('//trim(key%hint)//')'
   end function expected_text

   !> The names there are, for messages on a name that is not among them.
   pure function names_text(noun, names) result(text)
      character(*), intent(in) :: noun !! noun for the names
      character(*), intent(in) :: names !! the names, each with ', ' before it
      character(:), allocatable :: text

      text = 'none'
      if (len(names) > 0) text = names(3:)
      text = ' ('//noun//': '//text//')'
   end function names_text

   !> Records that a text is none of the words that a key accepts.
   subroutine refuse_word(self, key, text, choices)
      class(deck_visitor_t), intent(inout) :: self !! the visitor
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: text !! the text
      character(*), intent(in) :: choices(:) !! the words, in lower case, blank padded
      character(:), allocatable :: near

      near = nearest_word(lower_case(text), choices)
      if (near /= '') near = "; did you mean '"//near//"'?"
      call self%deck%fault(self%place, key%name, trim(key%name)//': expected '//expected_text(key, choices)// &
         ', found '//excerpt(quoted(text))//near)
      call mark_faulty(self%deck%contents, self%place, key%name)
   end subroutine refuse_word

end module amontons_deck_visitor
