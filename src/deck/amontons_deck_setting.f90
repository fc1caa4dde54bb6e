!> Settings of single keys that take the place of what a deck says, as a command line gives them:
!> `contact(2).friction=0.3`.
module amontons_deck_setting
   use amontons_deck, only: deck_t, read_deck_text
   use amontons_deck_contents, only: find_key
   use amontons_deck_scanner, only: is_name
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_text, only: line_end, lower_case, newline, quoted, read_integer, to_text
   implicit none (type, external)
   private

   public :: apply_settings, new_setting, read_settings, setting_t

   !> The value of a key.
   type :: setting_t
      character(:), allocatable :: text !! the setting as it was given
      character(:), allocatable :: group !! name of the group
      integer :: number = 0 !! which of the groups of this name; 0 for the only one
      character(:), allocatable :: assignment !! the assignment as a deck has it: `friction = 0.3`
      character(:), allocatable :: key !! name of the key
   end type setting_t

contains

   !> Takes a setting apart. A value that is neither quoted nor made of numbers counts as text.
   subroutine new_setting(setting, text, error)
      type(setting_t), intent(out) :: setting !! the setting
      character(*), intent(in) :: text !! the setting as it is given: `GROUP.KEY=VALUE` or `GROUP(2).KEY=VALUE`
      type(error_t), allocatable, intent(out) :: error !! it has not this form
      character(:), allocatable :: value
      integer :: equals, point, parenthesis
      logical :: ok

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
      if (.not. is_literal(value)) value = quoted(value)
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

   !> Whether a value stands in quotes, or looks like numbers.
   pure logical function is_literal(value)
      character(*), intent(in) :: value !! the value
      character(*), parameter :: digits = '0123456789'

      is_literal = scan(value(:min(1, len(value))), '''"') > 0 .or. &
         (verify(value, digits//'+-.,* eEdD') == 0 .and. scan(value(:min(1, len(value))), digits//'+-.') > 0)
   end function is_literal

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

end module amontons_deck_setting
