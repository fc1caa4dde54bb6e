!> Text files as they were written, compared with the documents that follow from the other files: line by line, word by
!> word, numbers up to rounding. The parts that only the run knew are passed over.
!>
!> In the build that wrote the files numbers agree to the last bit but where the solver went another way: its
!> displacements of the contact points come from the small problem, those of the check from the whole body. Other
!> compilers round otherwise. Both differences are far below 1e-8 of the largest number of a kind, below which no
!> certificate speaks.
module amontons_document_check
   use amontons_document, only: document_t, part_t
   use amontons_error, only: error_t, fault_list_t
   use amontons_input_file, only: read_text_file
   use amontons_kinds, only: dp
   use amontons_text, only: line_end, newline, read_real, to_text
   implicit none (type, external)
   private

   public :: agree, compare_document, compare_line, contradiction, first_disagreement

   !> What stands between words.
   character(*), parameter :: separators = ' (),;:{}[]'
   !> Numbers of a listing have seven digits; the last may be rounded up in one listing and down in another [-].
   real(dp), parameter :: rounding = 2.0e-6_dp

   !> Largest difference of two numbers that agree, over the largest number of their kind [-].
   real(dp), parameter :: limit = 1.0e-8_dp

contains

   !> Compares a file with its document.
   subroutine compare_document(faults, stem, document)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: stem !! directory and name of the case
      type(document_t), intent(in) :: document !! what should stand in the file
      character(:), allocatable :: stated, path
      type(error_t), allocatable :: error
      integer :: at, i, k
      logical :: is_skipping

      path = stem//document%ending
      call read_text_file(path, stated, error)
      if (allocated(error)) then
         call faults%add(path, 'cannot be read')
         return
      end if
      at = 1
      is_skipping = .false.
      do i = 1, document%n
         associate (part => document%parts(i))
            is_skipping = is_skipping .or. part%is_recorded
            if (part%is_recorded) cycle
            if (is_skipping) then
               k = index(stated(max(1, at - 1):), head_of(part%text))
               if (k == 0) then
                  call faults%add(path, "'"//name_of(head_of(part%text))//"' is missing")
                  cycle
               end if
               at = max(1, at - 1) + k - 1
               ! The line end before a member belongs to the line before it.
               if (part%text(1:1) /= newline) at = at + 1
            end if
            call compare_part(faults, path, stated, at, part, document, is_skipping)
         end associate
      end do
      if (.not. is_skipping .and. at <= len(stated)) call faults%add(path//':'//to_text(line_number(stated, at)), &
         'nothing follows here from the other files')
   end subroutine compare_document

   !> Compares the lines of a part. Where they have other words, the rest of it is passed over.
   subroutine compare_part(faults, path, stated, at, part, document, is_lost)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: stated !! its text
      integer, intent(inout) :: at !! where the part begins in it; behind the part on return
      type(part_t), intent(in) :: part !! what should stand there
      type(document_t), intent(in) :: document !! the whole document
      logical, intent(out) :: is_lost !! whether the lines do not belong to each other
      character(:), allocatable :: fault, header
      real(dp) :: least_difference
      integer :: first, last, last_stated, number

      least_difference = merge(rounding, 0.0_dp, document%ending == '.lst')
      is_lost = .false.
      header = ''
      if (index(document%ending, '.csv') > 0) header = document%parts(1)%text(:index(document%parts(1)%text, newline) &
         - 1)
      first = 1
      number = line_number(stated, at)
      do while (first <= len(part%text))
         last = line_end(part%text, first)
         if (at > len(stated)) then
            call faults%add(path, "it ends before the line '"//part%text(first:last)//"'")
            is_lost = .true.
            return
         end if
         last_stated = line_end(stated, at)
         call compare_line(fault, stated(at:last_stated), part%text(first:last), header, part%scales, &
            least_difference, is_lost)
         if (len(fault) > 0) call faults%add(path//':'//to_text(number), fault)
         ! A listing says the same thing several times: the first line of a part is enough.
         is_lost = is_lost .or. (len(fault) > 0 .and. document%ending == '.lst')
         if (is_lost) return
         first = last + 2
         at = last_stated + 2
         number = number + 1
      end do
   end subroutine compare_part

   !> Compares two lines.
   pure subroutine compare_line(fault, stated, computed, header, scales, least_difference, is_lost)
      character(:), allocatable, intent(out) :: fault !! what does not agree; empty if all does
      character(*), intent(in) :: stated !! the line as it was written
      character(*), intent(in) :: computed !! what should stand there
      character(*), intent(in) :: header !! of a table, the names of its columns; empty otherwise
      real(dp), intent(in) :: scales(:) !! what the first, second ... word is measured by besides itself
      real(dp), intent(in) :: least_difference !! how far numbers may differ, over themselves [-]
      logical, intent(out) :: is_lost !! whether the lines have other words
      integer :: i, j, last_i, last_j, number
      logical :: is_same, is_a, is_b
      real(dp) :: a, b

      fault = ''
      is_lost = .false.
      if (stated == computed .and. len(stated) == len(computed)) return
      ! Compares the words of two lines, up to the end of one of them or to where they do not belong to each other.
      i = 1
      j = 1
      do
         i = next_sign(stated, i)
         j = next_sign(computed, j)
         if (i > len(stated) .or. j > len(computed)) exit
         last_i = i + max(0, scan(stated(i:)//' ', separators) - 2)
         last_j = j + max(0, scan(computed(j:)//' ', separators) - 2)
         if (stated(i:last_i) /= computed(j:last_j)) then
            number = max(1, min(size(scales), n_numbers(computed(:last_j))))
            ! Whether two words are numbers that agree up to rounding.
            call read_real(stated(i:last_i), a, is_a)
            call read_real(computed(j:last_j), b, is_b)
            is_same = .false.
            if (is_a .and. is_b) is_same = agree(a, b, max(abs(a), abs(b), scales(number))) .or. &
               abs(a - b) <= least_difference*max(abs(a), abs(b))
            ! The rest of the line belongs together only if what differs is a word.
            if (.not. is_same .and. scan(stated(i:i)//computed(j:j), separators//'"') > 0) exit
            if (.not. is_same) call add_contradiction(fault, stated(i:last_i), computed(j:last_j), &
               place_name(computed(:j - 1), header))
         end if
         i = last_i + 1
         j = last_j + 1
      end do
      is_lost = i <= len(stated) .or. j <= len(computed)
      if (is_lost) fault = member_contradiction(stated, computed)
      if (fault == '?') fault = "'"//trim(adjustl(stated))//"', but '"// &
         trim(adjustl(computed))//"'"
      if (len(fault) > 0) fault = fault//' follows from the other files'
   end subroutine compare_line

   !> Adds what is said of two words; of one that has no name, only that it differs.
   pure subroutine add_contradiction(fault, stated, computed, name)
      character(:), allocatable, intent(inout) :: fault !! gains the sentence
      character(*), intent(in) :: stated !! the word as it was written
      character(*), intent(in) :: computed !! what should stand there
      character(*), intent(in) :: name !! what the word is called, or nothing

      if (len(name) == 0) then
         fault = '?'
         return
      end if
      if (len(fault) > 0) fault = fault//'; '
      fault = fault//name//' is '//stated//', but '//computed
   end subroutine add_contradiction

   !> What is said of two members of JSON, or of two lines that are none: only that they differ.
   pure function member_contradiction(stated, computed) result(sentence)
      character(*), intent(in) :: stated !! the line as it was written
      character(*), intent(in) :: computed !! what should stand there
      character(:), allocatable :: sentence
      integer :: first

      sentence = '?'
      if (index(computed, '  "') /= 1) return
      first = index(computed, '": ') + 3
      if (index(stated, computed(:first - 1)) == 1) sentence = computed(4:first - 4)//' is '// &
         without_comma(stated(first:))//', but '//without_comma(computed(first:))
   end function member_contradiction

   !> A text without the comma at its end.
   pure function without_comma(text) result(shorter)
      character(*), intent(in) :: text !! the text
      character(:), allocatable :: shorter

      shorter = text
      if (len(text) > 0) then
         if (text(len(text):) == ',') shorter = text(:len(text) - 1)
      end if
   end function without_comma

   !> The place of the next sign that is no blank; behind the end of the line if there is none.
   pure integer function next_sign(line, first) result(place)
      character(*), intent(in) :: line !! the line
      integer, intent(in) :: first !! where to begin

      place = len(line) + 1
      if (first > len(line)) return
      if (verify(line(first:), ' ') > 0) place = first + verify(line(first:), ' ') - 1
   end function next_sign

   !> How many numbers the beginning of a line holds.
   pure integer function n_numbers(line) result(n)
      character(*), intent(in) :: line !! the beginning of a line, up to the end of a word
      real(dp) :: value
      integer :: first, length
      logical :: ok

      n = 0
      first = 1
      do while (first <= len(line))
         length = scan(line(first:)//' ', separators) - 1
         ok = .false.
         if (length > 0) call read_real(line(first:first + length - 1), value, ok)
         if (ok) n = n + 1
         first = first + length + 1
      end do
   end function n_numbers

   !> What the word behind the beginning of a line is called: its column in a table, its members in JSON; else nothing.
   pure function place_name(before, header) result(name)
      character(*), intent(in) :: before !! the line up to the word
      character(*), intent(in) :: header !! the header of a table, or nothing
      character(:), allocatable :: name
      integer :: first, i, last, outer

      name = ''
      if (len(header) > 0) then
         first = 1
         do i = 1, len(before)
            if (before(i:i) == ',') first = first + index(header(first:), ',')
         end do
         name = header(first:first + index(header(first:)//',', ',') - 2)
      else if (index(before, '  "') == 1) then
         name = before(4:index(before, '": ') - 1)
         outer = 0
         do i = 1, len(before)
            if (before(i:i) == '{') outer = i
            if (before(i:i) == '}') outer = index(before(:i), '{')
         end do
         last = index(before, '": ', back=.true.) - 1
         first = index(before(:last), '"', back=.true.)
         if (first > 3) then
            ! The object that it is in, if this is not the member of the line.
            i = index(before(:max(1, outer - 4)), '"', back=.true.)
            if (outer > index(before, '{')) name = name//'.'//before(i + 1:outer - 4)
            name = name//'.'//before(first + 1:last)
         end if
      end if
   end function place_name

   !> What a part is found by: the name of a member, or a heading.
   pure function head_of(text) result(head)
      character(*), intent(in) :: text !! the part
      character(:), allocatable :: head

      if (index(text, '  "') == 1) then
         head = newline//text(:index(text, '": ') + 2)
      else
         head = text(:1 + index(text(2:), newline))
      end if
   end function head_of

   !> The head of a part without quotes, blanks and line ends.
   pure function name_of(head) result(name)
      character(*), intent(in) :: head !! the head
      character(:), allocatable :: name

      name = head(2:len(head) - 1)
      if (index(name, '  "') == 1) name = name(4:index(name, '":') - 1)
   end function name_of

   !> Number of the line that a place of a text is in.
   pure integer function line_number(text, place)
      character(*), intent(in) :: text !! the text
      integer, intent(in) :: place !! the place
      integer :: i

      line_number = 1
      do i = 1, min(place - 1, len(text))
         if (text(i:i) == newline) line_number = line_number + 1
      end do
   end function line_number

   !> Whether two numbers agree. One that is not finite agrees with none.
   elemental logical function agree(stated, computed, scale)
      real(dp), intent(in) :: stated !! the number that a file states
      real(dp), intent(in) :: computed !! the number that follows from the others
      real(dp), intent(in) :: scale !! the largest number of their kind, or more

      agree = abs(stated - computed) <= limit*scale
   end function agree

   !> The place of the first number that does not agree, the largest of them being the scale; 0 if all do.
   pure integer function first_disagreement(stated, computed, scale) result(place)
      real(dp), intent(in) :: stated(:) !! the numbers that a file states
      real(dp), intent(in) :: computed(:) !! the numbers that follow from the others, as many
      real(dp), intent(in), optional :: scale !! the largest number of their kind, if not among them
      real(dp) :: largest

      largest = 0.0_dp
      if (size(computed) > 0) largest = maxval(abs(computed))
      if (present(scale)) largest = max(largest, scale)
      do place = 1, size(stated)
         if (.not. agree(stated(place), computed(place), largest)) return
      end do
      place = 0
   end function first_disagreement

   !> What is said of two numbers that do not agree.
   pure function contradiction(what, stated, computed) result(sentence)
      character(*), intent(in) :: what !! what they are
      real(dp), intent(in) :: stated !! the number that a file states
      real(dp), intent(in) :: computed !! the number that follows from the others
      character(:), allocatable :: sentence

      sentence = what//' is '//shown(stated)//', but '//shown(computed)//' follows from the other files'
   end function contradiction

   !> A number, if it is one.
   pure function shown(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      if (abs(value) <= huge(value)) then
         text = to_text(value)
      else
         text = 'not a finite number'
      end if
   end function shown

end module amontons_document_check
