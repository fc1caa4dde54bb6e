!> What stands in a deck: groups, assignments and values, each with its place in the text.
module amontons_deck_contents
   use amontons_deck_scanner, only: column_text, excerpt
   use amontons_fault_list, only: fault_list_t
   use amontons_kinds, only: int64
   use amontons_text, only: counted, to_text
   implicit none (type, external)
   private

   public :: deck_assignment_t, deck_contents_t, deck_group_t, deck_value_t
   public :: append_assignment, append_group, append_value
   public :: bare_value, find_key, find_values, mark_faulty, refuse_value, unquoted_value

   !> A value as it is written.
   type :: deck_value_t
      integer :: first = 1 !! position of its first character in the text, the quote of a quoted text
      integer :: last = 0 !! position of its last character in the text
      integer :: line = 0 !! line it stands on
      integer :: n_times = 1 !! how often it counts: 2 for `2*0.0`
      logical :: is_text = .false. !! whether it stands in quotes
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
      logical :: is_malformed = .false. !! whether its form is at fault
      logical :: is_faulty = .false. !! whether a fault of meaning has been recorded
      logical :: has_unknown_key = .false. !! whether a key is none of the group's
   end type deck_group_t

   !> What stands in a deck, in the deck's order.
   type :: deck_contents_t
      character(:), allocatable :: text !! the whole text
      type(deck_group_t), allocatable :: groups(:) !! the groups, `n_groups` of them
      type(deck_assignment_t), allocatable :: assignments(:) !! the assignments, `n_assignments` of them
      type(deck_value_t), allocatable :: values(:) !! the values, `n_values` of them
      integer :: n_groups = 0 !! number of groups
      integer :: n_assignments = 0 !! number of assignments
      integer :: n_values = 0 !! number of values
      logical :: hides_groups = .false. !! whether text that is no group, or an unknown one, may hide one
      type(fault_list_t) :: faults !! what is wrong with the deck
   end type deck_contents_t

contains

   !> Appends a group to the deck. A full list doubles its length: what stands in the second half means nothing yet.
   subroutine append_group(contents, group)
      type(deck_contents_t), intent(inout) :: contents !! the deck
      type(deck_group_t), intent(in) :: group !! the group

      if (contents%n_groups == size(contents%groups)) contents%groups = [contents%groups, contents%groups]
      contents%n_groups = contents%n_groups + 1
      contents%groups(contents%n_groups) = group
   end subroutine append_group

   !> Appends an assignment to the deck.
   subroutine append_assignment(contents, assignment)
      type(deck_contents_t), intent(inout) :: contents !! the deck
      type(deck_assignment_t), intent(in) :: assignment !! the assignment

      if (contents%n_assignments == size(contents%assignments)) then
         contents%assignments = [contents%assignments, contents%assignments]
      end if
      contents%n_assignments = contents%n_assignments + 1
      contents%assignments(contents%n_assignments) = assignment
   end subroutine append_assignment

   !> Appends a value to the deck.
   subroutine append_value(contents, value)
      type(deck_contents_t), intent(inout) :: contents !! the deck
      type(deck_value_t), intent(in) :: value !! the value

      if (contents%n_values == size(contents%values)) contents%values = [contents%values, contents%values]
      contents%n_values = contents%n_values + 1
      contents%values(contents%n_values) = value
   end subroutine append_value

   !> Finds the values of a key, one for each element of an array.
   !>
   !> A key may stand several times when its subscripts give different elements. Values behind a fault of form are
   !> not taken: they may belong elsewhere.
   subroutine find_values(contents, group, key, noun, source)
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the faults
      integer, intent(in) :: group !! the group, or 0 where every key is absent
      character(*), intent(in) :: key !! name of the key, in lower case
      character(*), intent(in) :: noun !! what one value is called
      integer, intent(out) :: source(:) !! index of the value of each element, 0 where none is given
      integer :: i, given_at(size(source))

      source = 0
      given_at = 0
      if (group == 0) return
      do i = contents%groups(group)%first_assignment, contents%groups(group)%last_assignment
         if (contents%assignments(i)%key /= key) cycle
         if (contents%assignments(i)%is_faulty .or. i > contents%groups(group)%last_judged) cycle
         call place_values(contents, i, noun, source, given_at)
      end do
   end subroutine find_values

   !> Puts the values of one assignment in their places, or records why they have none and marks it as faulty.
   subroutine place_values(contents, assignment, noun, source, given_at)
      type(deck_contents_t), intent(inout) :: contents !! the deck, gains the fault
      integer, intent(in) :: assignment !! the assignment
      character(*), intent(in) :: noun !! what one value is called
      integer, intent(inout) :: source(:) !! index of the value of each element, 0 where none is given
      integer, intent(inout) :: given_at(:) !! line of the key that gave each element, 0 where none did
      character(:), allocatable :: misfit
      integer :: i, element, last

      associate (given => contents%assignments(assignment))
         misfit = misfit_of(given, contents%values(given%first_value:given%last_value), noun, given_at)
         given%is_faulty = misfit /= ''
         if (given%is_faulty) then
            if (noun == 'number' .and. given%subscript == 0) misfit = misfit//comma_hint(contents, given, size(source))
            call contents%faults%add(given%line, given%key//': '//misfit)
            return
         end if
         element = max(given%subscript, 1)
         do i = given%first_value, given%last_value
            last = element + contents%values(i)%n_times - 1
            source(element:last) = i
            given_at(element:last) = given%line
            element = last + 1
         end do
      end associate
   end subroutine place_values

   !> Why values cannot take the places their assignment gives them; empty where they can.
   pure function misfit_of(assignment, values, noun, given_at) result(misfit)
      type(deck_assignment_t), intent(in) :: assignment !! the assignment
      type(deck_value_t), intent(in) :: values(:) !! its values
      character(*), intent(in) :: noun !! what one value is called
      integer, intent(in) :: given_at(:) !! line of the key that gave each element, 0 where none did
      character(:), allocatable :: misfit
      integer(int64) :: n_given
      integer :: n_places, line

      n_given = sum(int(values%n_times, int64))
      n_places = size(given_at) - max(assignment%subscript, 1) + 1
      misfit = ''
      if (assignment%subscript > 0 .and. size(given_at) == 1) then
         misfit = 'expected no subscript, found ('//to_text(assignment%subscript)//')'
      else if (n_places < 1) then
         misfit = 'expected a subscript from 1 to '//to_text(size(given_at))//', found ('// &
            to_text(assignment%subscript)//')'
      else if (n_given > n_places .or. (n_given < n_places .and. assignment%subscript == 0)) then
         misfit = 'expected '//counted(n_places, noun)//', found '//to_text(n_given)
      else
         line = maxval(given_at(size(given_at) - n_places + 1:size(given_at) - n_places + int(n_given)))
         if (line > 0) misfit = 'given in line '//to_text(line)//' already'
      end if
   end function misfit_of

   !> What a message adds where twice as many whole numbers are given as numbers are expected, a comma in each pair: the
   !> number that a decimal comma was meant to write.
   pure function comma_hint(contents, assignment, n_expected) result(hint)
      type(deck_contents_t), intent(in) :: contents !! the deck
      type(deck_assignment_t), intent(in) :: assignment !! the assignment
      integer, intent(in) :: n_expected !! how many numbers its key takes
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

   !> A value that stands without quotes; empty for a quoted one, which is neither number nor logical.
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
      integer, intent(in) :: value !! index of the value, one that stands in quotes
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
      character(*), intent(in) :: expected !! what was expected

      call contents%faults%add(contents%values(value)%line, trim(key)//': expected '//expected//', found '// &
         excerpt(raw_value(contents, value))//column_text(contents%text, contents%values(value)%first))
      call mark_faulty(contents, group, key)
   end subroutine refuse_value

   !> Marks the value of a key as faulty.
   subroutine mark_faulty(contents, group, key)
      type(deck_contents_t), intent(inout) :: contents !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! name of the key, which stands in the group

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
