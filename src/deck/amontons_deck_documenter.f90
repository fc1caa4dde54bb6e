!> Documents what a deck may hold: a table in Markdown of the keys of each group that a description shows.
module amontons_deck_documenter
   use amontons_deck_scanner, only: joined
   use amontons_deck_visitor, only: deck_visitor_t, group_t, key_t, set_default
   use amontons_kinds, only: dp
   use amontons_text, only: newline, quoted, to_text
   implicit none (type, external)
   private

   public :: deck_documenter_t

   !> The tables of the groups visited so far.
   type, extends(deck_visitor_t) :: deck_documenter_t
      character(:), allocatable :: wanted !! name of the only group to document; empty for all
      character(:), allocatable :: written !! the tables, their last line not ended
   contains
      procedure :: open_group => documenter_open_group
      procedure :: close_group => documenter_close_group
      procedure :: reals => documenter_reals
      procedure :: text => documenter_text
      procedure :: words => documenter_words
      procedure, private :: write => documenter_write
      procedure, private :: write_row => documenter_write_row
   end type deck_documenter_t

contains

   !> Writes the heading of a group and of its table.
   subroutine documenter_open_group(self, group)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      type(group_t), intent(in) :: group !! the group

      self%group = group
      if (len(self%written) > 0) call self%write(newline//newline)
      call self%write('### `&'//trim(group%name)//'`'//trim(merge(' (may be repeated)', '                  ', &
         group%is_repeatable))//newline//newline//'| key | value | unit | default | meaning |'//newline// &
         '|---|---|---|---|---|')
   end subroutine documenter_open_group

   !> Ends a group.
   subroutine documenter_close_group(self)
      class(deck_documenter_t), intent(inout) :: self !! the documenter

      self%group = group_t()
   end subroutine documenter_close_group

   !> Writes the row of numbers.
   subroutine documenter_reals(self, key, values, is_given)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      type(key_t), intent(in) :: key !! the key
      real(dp), intent(inout) :: values(:) !! the numbers, their defaults; none for a list of any length
      logical, intent(inout), optional :: is_given !! whether these are defaults, if present
      character(:), allocatable :: text, range

      text = key%noun()
      if (size(values) /= 1) text = text//'s'
      if (size(values) > 1) text = to_text(size(values))//' '//text
      range = key%range()
      if (index(range, 'at least') == 1) range = ', '//range
      if (index(range, 'above') == 1) range = ' '//range
      if (key%is_nonzero) range = trim(merge(', not both 0', ', not 0     ', size(values) > 1))
      if (key%is_ascending) range = range//', ascending'
      call self%write_row(key, text//range, key%numbers(values), is_given)
   end subroutine documenter_reals

   !> Writes the row of a text.
   subroutine documenter_text(self, key, value, is_given, choices)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      type(key_t), intent(in) :: key !! the key
      character(:), allocatable, intent(inout) :: value !! the text, its default
      logical, intent(inout), optional :: is_given !! whether this is a default, if present and there are no choices
      character(*), intent(in), optional :: choices(:) !! the words it can be

      call set_default(value, choices)
      if (present(choices)) then
         call self%write_row(key, joined(choices, "`'", "'`"), quoted(value))
      else
         call self%write_row(key, 'text', quoted(value), is_given)
      end if
   end subroutine documenter_text

   !> Writes the row of a list of words.
   subroutine documenter_words(self, key, choices, is_chosen)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: choices(:) !! the words it can have
      logical, intent(inout) :: is_chosen(:) !! which of them it has
      logical :: is_default

      is_default = any(is_chosen)
      call self%write_row(key, 'texts: one or more of '//joined(choices, "`'", "'`"), '', is_default)
   end subroutine documenter_words

   !> Writes a row.
   subroutine documenter_write_row(self, key, values, default, is_given)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: values !! what its values are
      character(*), intent(in) :: default !! its default as a deck has it
      logical, intent(in), optional :: is_given !! whether this is its default, if present
      character(:), allocatable :: name, shown
      logical :: is_default

      name = '`'//trim(key%name)//'`'
      if (key%is_required) name = '**'//name//'**'
      is_default = default /= '' .and. .not. key%is_required
      if (present(is_given)) is_default = is_default .and. is_given
      shown = trim(key%default)
      if (shown == '' .and. is_default) shown = '`'//default//'`'
      call self%write(newline//'| '//name//' | '//values//' |'//cell(trim(key%unit))//cell(shown)//' '// &
         trim(key%meaning)//' |')
   end subroutine documenter_write_row

   !> Writes a text, unless it belongs to a group that is not wanted.
   subroutine documenter_write(self, text)
      class(deck_documenter_t), intent(inout) :: self !! the documenter
      character(*), intent(in) :: text !! the text

      if (self%wanted == '' .or. self%wanted == self%group%name) self%written = self%written//text
   end subroutine documenter_write

   !> A cell that may be empty, its right border included.
   pure function cell(content) result(text)
      character(*), intent(in) :: content !! what stands in it
      character(:), allocatable :: text

      text = ' '
      if (len(content) > 0) text = text//content//' '
      text = text//'|'
   end function cell

end module amontons_deck_documenter
