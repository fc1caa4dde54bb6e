!> Writes a deck from the values that a description shows.
module amontons_deck_writer
   use amontons_deck_visitor, only: deck_visitor_t, group_t, key_t, set_default
   use amontons_kinds, only: dp
   use amontons_text, only: newline, quoted
   implicit none (type, external)
   private

   public :: deck_writer_t

   !> Columns of a line; a single key and its values may be longer.
   integer, parameter :: width = 120

   !> A deck that is written.
   type, extends(deck_visitor_t) :: deck_writer_t
      logical :: is_shared_only = .false. !! whether only what decks that share a factorization agree in is written
      character(:), allocatable :: written !! the groups written so far
      character(:), allocatable, private :: line !! the last line of the group being written; empty before its first key
   contains
      procedure :: open_group => writer_open_group
      procedure :: close_group => writer_close_group
      procedure :: reals => writer_reals
      procedure :: text => writer_text
      procedure :: words => writer_words
      procedure, private :: write_key => writer_write_key
   end type deck_writer_t

contains

   !> Begins a group.
   subroutine writer_open_group(self, group)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(group_t), intent(in) :: group !! the group

      self%group = group
      self%line = ''
      if (.not. allocated(self%written)) self%written = ''
   end subroutine writer_open_group

   !> Ends a group; one without keys is not written.
   subroutine writer_close_group(self)
      class(deck_writer_t), intent(inout) :: self !! the writer

      if (self%line /= '') self%written = self%written//self%line//' /'//newline
   end subroutine writer_close_group

   !> Writes numbers.
   subroutine writer_reals(self, key, values, is_given)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      real(dp), intent(inout) :: values(:) !! the numbers
      logical, intent(inout), optional :: is_given !! whether they are written

      call self%write_key(key, key%numbers(values), is_given)
   end subroutine writer_reals

   !> Writes a text.
   subroutine writer_text(self, key, value, is_given, choices)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      character(:), allocatable, intent(inout) :: value !! the text
      logical, intent(inout), optional :: is_given !! whether it is written
      character(*), intent(in), optional :: choices(:) !! the words it can be

      call set_default(value, choices)
      call self%write_key(key, quoted(value), is_given)
   end subroutine writer_text

   !> Writes a list of words; nothing without any.
   subroutine writer_words(self, key, choices, is_chosen)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: choices(:) !! the words it can have
      logical, intent(inout) :: is_chosen(:) !! which of them it has
      character(:), allocatable :: list
      integer :: i

      list = ''
      do i = 1, size(choices)
         if (is_chosen(i)) list = list//', '//quoted(trim(choices(i)))
      end do
      call self%write_key(key, list(min(3, len(list) + 1):), any(is_chosen))
   end subroutine writer_words

   !> Writes a key and its value, on a new line where it would not fit.
   subroutine writer_write_key(self, key, value, is_given)
      class(deck_writer_t), intent(inout) :: self !! the writer
      type(key_t), intent(in) :: key !! the key
      character(*), intent(in) :: value !! the value as a deck has it
      logical, intent(in), optional :: is_given !! whether it is written
      character(:), allocatable :: item

      if (self%is_shared_only .and. .not. (self%group%is_shared .or. key%is_shared)) return
      if (present(is_given)) then
         if (.not. is_given) return
      end if
      item = trim(key%name)//' = '//value
      if (self%is_shared_only .and. key%is_free) item = trim(key%name)
      if (self%line == '') then
         self%line = '&'//trim(self%group%name)//' '//item
      else if (len(self%line) - index(self%line, newline, back=.true.) + len(item) + 4 > width) then
         self%line = self%line//newline//'   '//item
      else
         self%line = self%line//'  '//item
      end if
   end subroutine writer_write_key

end module amontons_deck_writer
