!> A case under verification, tables of comma-separated fields, and comparisons of the files of a case with their
!> expected contents: texts part by part and word by word, collections entry by entry, grids array by array. Procedures
!> that write a grid can pass a `vtk_check_t` in place of a file: it compares the arrays.
module amontons_file_check
   use amontons_config, only: config_t
   use amontons_document, only: document_t
   use amontons_error, only: error_t, fault_list_t
   use amontons_input_file, only: read_plain_file, read_text_file
   use amontons_integer_list, only: integer_list_t
   use amontons_kinds, only: dp, int32, int64
   use amontons_manifest, only: case_entries, collection_head, collection_tail
   use amontons_report, only: member_value
   use amontons_text, only: line_end, newline, occurrences, read_integer, read_real, replaced, to_text
   use amontons_vtu, only: base64_size, bytes_per_length, decode_base64, vtk_file_t
   implicit none (type, external)
   private

   public :: agree, check_collection, compare_collection, compare_document, compare_line, contradiction, csv_table_t, &
      first_disagreement, new_vtk_check, read_array, read_csv_table, verified_case_t, vtk_check_t

   !> Characters that separate words.
   character(*), parameter :: separators = ' (),;:{}[]'
   !> Largest relative difference of a number in a listing: it has seven digits, of which the last may be rounded
   !> differently [-].
   real(dp), parameter :: rounding = 2.0e-6_dp

   !> Largest difference of two equal numbers, over the largest number of their kind [-].
   real(dp), parameter :: limit = 1.0e-8_dp

   !> A grid under comparison. After a fault in the markup or in the length of an array the rest is not compared.
   type, extends(vtk_file_t) :: vtk_check_t
      private
      character(:), allocatable :: path !! name of the file
      character(:), allocatable :: text !! all bytes of it
      integer :: position = 1 !! the byte that comes next, from 1
      logical :: is_readable = .true. !! whether what comes next is where it should be
      type(fault_list_t), public :: faults !! the disagreement
   contains
      procedure, public :: close => vtk_check_close
      procedure, public :: put_integers => vtk_check_put_integers
      procedure, public :: put_reals => vtk_check_put_reals
      procedure :: compare_markup => vtk_check_compare_markup
      procedure :: read_array => vtk_check_read_array
      procedure :: stop_at => vtk_check_stop_at
   end type vtk_check_t

   !> A case, its faults and its verdict.
   type :: verified_case_t
      character(:), allocatable :: stem !! directory and name of the case
      character(:), allocatable :: summary !! all bytes of its summary; not allocated if it cannot be read
      type(config_t) :: config !! the case as its effective deck has it
      type(config_t) :: solved !! the same, but for a factorization over ranks: it is solved on any number of them
      type(fault_list_t) :: faults !! the disagreement
      logical :: is_certified = .false. !! whether it converged and its certificate passes, or it has no equilibrium
   contains
      procedure :: compare => verified_case_compare
      procedure :: fault => verified_case_fault
      procedure :: number => verified_case_number
      procedure :: value => verified_case_value
   end type verified_case_t

   !> A table. Only the header may have fields with commas.
   type :: csv_table_t
      private
      integer, public :: n_rows = 0 !! number of rows, the header not counted
      character(:), allocatable, public :: header !! its first line
      character(:), allocatable, public :: text !! the whole file
      type(integer_list_t) :: start !! where each row begins in it, and where the file ends (n_rows + 1)
   contains
      procedure, public :: field => csv_table_field
      procedure, public :: column => csv_table_column
      procedure, public :: get_number => csv_table_get_number
      procedure, public :: row => csv_table_row
   end type csv_table_t

contains

   !> Compares a file with the document that it should contain.
   subroutine compare_document(faults, stem, document)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: stem !! directory and name of the case
      type(document_t), intent(in) :: document !! the expected document
      character(:), allocatable :: stated, path, fault, header, head
      type(error_t), allocatable :: error
      real(dp) :: least_difference
      integer :: at, i, k, first, last, last_stated, number
      logical :: is_skipping

      path = stem//document%ending
      call read_text_file(path, stated, error)
      if (allocated(error)) then
         call faults%add(path, 'cannot be read')
         return
      end if
      least_difference = merge(rounding, 0.0_dp, document%ending == '.lst')
      header = ''
      if (index(document%ending, '.csv') > 0) header = document%parts(1)%text(:index(document%parts(1)%text, newline) &
         - 1)
      at = 1
      is_skipping = .false.
      do i = 1, document%n
         associate (part => document%parts(i))
            is_skipping = is_skipping .or. part%is_recorded
            if (part%is_recorded) cycle
            if (is_skipping) then
               ! A part is found by its heading, or the name of its member.
               head = part%text(:1 + index(part%text(2:), newline))
               if (index(part%text, '  "') == 1) head = newline//part%text(:index(part%text, '": ') + 2)
               k = index(stated(max(1, at - 1):), head)
               if (k == 0) then
                  ! The head without quotes, blanks and line ends.
                  head = head(2:len(head) - 1)
                  if (index(head, '  "') == 1) head = head(4:index(head, '":') - 1)
                  call faults%add(path, "'"//head//"' is missing")
                  cycle
               end if
               at = max(1, at - 1) + k - 1
               ! The line end before a member belongs to the line before it.
               if (part%text(1:1) /= newline) at = at + 1
            end if
            ! Compares the lines of the part, up to the first one with different words.
            is_skipping = .false.
            first = 1
            number = line_number(stated, at)
            k = number - 1
            do while (first <= len(part%text) .and. .not. is_skipping)
               last = line_end(part%text, first)
               if (at > len(stated)) then
                  call faults%add(path, "it ends before the line '"//part%text(first:last)//"'")
                  is_skipping = .true.
                  cycle
               end if
               last_stated = line_end(stated, at)
               associate (line => min(number - k, size(part%scales)))
                  call compare_line(fault, stated(at:last_stated), part%text(first:last), header, &
                     part%scales(merge(line, 1, part%is_by_line):merge(line, size(part%scales), part%is_by_line)), &
                     least_difference, is_skipping)
               end associate
               if (len(fault) > 0) call faults%add(path//':'//to_text(number), fault)
               ! A listing says the same thing several times: the first line of a part is enough.
               is_skipping = is_skipping .or. (len(fault) > 0 .and. document%ending == '.lst')
               if (is_skipping) cycle
               first = last + 2
               at = last_stated + 2
               number = number + 1
            end do
         end associate
      end do
      if (.not. is_skipping .and. at <= len(stated)) call faults%add(path//':'//to_text(line_number(stated, at)), &
         'nothing follows here from the other files')
   end subroutine compare_document

   !> Compares a line of a file with the line expected there.
   pure subroutine compare_line(fault, stated, computed, header, scales, least_difference, is_lost)
      character(:), allocatable, intent(out) :: fault !! the disagreement; empty if there is none
      character(*), intent(in) :: stated !! the line as it was written
      character(*), intent(in) :: computed !! the expected text
      character(*), intent(in) :: header !! of a table, the names of its columns; empty otherwise
      real(dp), intent(in) :: scales(:) !! scale of the first, second ... word, if larger than the word itself
      real(dp), intent(in) :: least_difference !! largest relative difference of numbers [-]
      logical, intent(out) :: is_lost !! whether the lines have other words
      character(:), allocatable :: name
      integer :: i, j, last_i, last_j, number
      logical :: is_same, is_a, is_b
      real(dp) :: a, b

      fault = ''
      is_lost = .false.
      if (stated == computed .and. len(stated) == len(computed)) return
      ! Compares the words of two lines, up to the end of one of them or to where they do not belong to each other.
      i = 1
      j = 1
      number = 0
      do
         i = next_sign(stated, i)
         j = next_sign(computed, j)
         if (i > len(stated) .or. j > len(computed)) exit
         last_i = i + max(0, word_length(stated, i) - 1)
         last_j = j + max(0, word_length(computed, j) - 1)
         call read_real(computed(j:last_j), b, is_b)
         if (is_b) number = number + 1
         if (stated(i:last_i) /= computed(j:last_j)) then
            ! Whether two words are numbers that agree up to rounding.
            call read_real(stated(i:last_i), a, is_a)
            is_same = .false.
            if (is_a .and. is_b) is_same = agree(a, b, max(abs(a), abs(b), scales(min(size(scales), number)))) .or. &
               abs(a - b) <= least_difference*max(abs(a), abs(b))
            ! The rest of the line belongs together only if what differs is a word.
            if (.not. is_same .and. scan(stated(i:i)//computed(j:j), separators//'"') > 0) exit
            if (.not. is_same) then
               name = place_name(computed(:j - 1), header)
               if (len(name) == 0) then
                  ! Of a word without a name, only that it differs is reported.
                  fault = '?'
               else
                  if (len(fault) > 0) fault = fault//'; '
                  fault = fault//name//' is '//stated(i:last_i)//', but '//computed(j:last_j)
               end if
            end if
         end if
         i = last_i + 1
         j = last_j + 1
      end do
      is_lost = i <= len(stated) .or. j <= len(computed)
      if (is_lost) then
         fault = '?'
         ! Two members of JSON.
         i = index(computed, '": ') + 3
         if (index(computed, '  "') == 1 .and. index(stated, computed(:i - 1)) == 1) fault = computed(4:i - 4)// &
            ' is '//without_comma(stated(i:))//', but '//without_comma(computed(i:))
      end if
      if (fault == '?') fault = "'"//trim(adjustl(stated))//"', but '"//trim(adjustl(computed))//"'"
      if (len(fault) > 0) fault = fault//' follows from the other files'
   end subroutine compare_line

   !> A text without a comma at its end.
   pure function without_comma(text) result(shorter)
      character(*), intent(in) :: text !! the text
      character(:), allocatable :: shorter

      shorter = text(:len(text) - merge(1, 0, scan(text, ',', back=.true.) == len(text)))
   end function without_comma

   !> The position of the next character that is no blank; one past the end of the line if there is none.
   pure integer function next_sign(line, first) result(place)
      character(*), intent(in) :: line !! the line
      integer, intent(in) :: first !! first position to be searched

      place = len(line) + 1
      if (first > len(line)) return
      if (verify(line(first:), ' ') > 0) place = first + verify(line(first:), ' ') - 1
   end function next_sign

   !> Number of characters before the next separator, or the end of the line. The rest of the line is not copied: for
   !> each word of a long line a copy would overflow the stack.
   pure integer function word_length(line, first) result(length)
      character(*), intent(in) :: line !! the line
      integer, intent(in) :: first !! first position to be searched

      length = scan(line(first:), separators) - 1
      if (length < 0) length = len(line) - first + 1
   end function word_length

   !> The name of a word in a line: its column in a table, its members in JSON; otherwise empty.
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

   !> Number of the line that contains a position of a text.
   pure integer function line_number(text, place)
      character(*), intent(in) :: text !! the text
      integer, intent(in) :: place !! the place

      line_number = 1 + occurrences(text(:min(place - 1, len(text))), newline)
   end function line_number

   !> Whether two numbers agree. A number that is not finite agrees with none.
   elemental logical function agree(stated, computed, scale)
      real(dp), intent(in) :: stated !! the number that a file states
      real(dp), intent(in) :: computed !! the number that follows from the others
      real(dp), intent(in) :: scale !! the largest number of their kind, or more

      agree = abs(stated - computed) <= limit*scale
   end function agree

   !> The index of the first number that does not agree, with the largest of them as the scale; 0 if all do.
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

   !> Text describing two numbers that do not agree.
   pure function contradiction(what, stated, computed) result(sentence)
      character(*), intent(in) :: what !! their kind
      real(dp), intent(in) :: stated !! the number that a file states
      real(dp), intent(in) :: computed !! the number that follows from the others
      character(:), allocatable :: sentence

      sentence = what//' is '//number_text(stated)//', but '//number_text(computed)//' follows from the other files'
   end function contradiction

   !> A number as text; words for one that is not finite.
   pure function number_text(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      if (abs(value) <= huge(value)) then
         text = to_text(value)
      else
         text = 'not a finite number'
      end if
   end function number_text

   !> Checks cases.pvd of a directory, if it exists: its form, the order of its steps, and that the named files exist.
   subroutine check_collection(faults, directory)
      type(fault_list_t), intent(inout) :: faults !! gains what is wrong
      character(*), intent(in) :: directory !! the directory
      character(*), parameter :: before_number = '<DataSet timestep="', &
         behind_number = '" part="0" name="body" file="', behind_stem = '.vtu"/>'
      character(:), allocatable :: path, text, stem, entries
      type(error_t), allocatable :: error
      integer :: at, number, last_number, first, middle, last
      logical :: is_there, ok

      path = directory//'/cases.pvd'
      inquire (file=path, exist=is_there)
      if (.not. is_there) return
      call read_text_file(path, text, error)
      if (allocated(error)) text = ''
      at = 1
      if (index(text, collection_head) == 1) at = len(collection_head) + 1
      last_number = 0
      do while (at > 1 .and. at <= len(text))
         if (text(at:) == collection_tail) return
         ! Reads the number and the files of the next case.
         first = at + index(text(at:), before_number) + len(before_number) - 1
         middle = first + index(text(first:), behind_number) - 1
         last = middle + index(text(middle + 1:), behind_stem)
         call read_integer(text(first:middle - 1), number, ok)
         if (.not. ok .or. number <= last_number .or. last <= middle + len(behind_number)) exit
         stem = text(middle + len(behind_number):last - 1)
         stem = replaced(replaced(replaced(stem, '&quot;', '"'), '&lt;', '<'), '&amp;', '&')
         entries = case_entries(to_text(number), stem)
         if (index(text(at:min(len(text), at + len(entries) - 1)), entries) /= 1) exit
         call expect_file(stem//'.vtu')
         call expect_file(stem//'.contact.vtu')
         at = at + len(entries)
         last_number = number
      end do
      call faults%add(path, 'not as the program writes a collection, from byte '//to_text(at)//' on')

   contains

      !> Refuses a collection that names a file which is not there.
      subroutine expect_file(name)
         character(*), intent(in) :: name !! name of the file, without its directory

         inquire (file=directory//'/'//name, exist=is_there)
         if (.not. is_there) call faults%add(path, "it names '"//name//"', which is not there")
      end subroutine expect_file

   end subroutine check_collection

   !> Compares a collection for ParaView with the entries that it should have.
   subroutine compare_collection(faults, path, entries)
      type(fault_list_t), intent(inout) :: faults !! gains what is wrong
      character(*), intent(in) :: path !! name of the collection
      character(*), intent(in) :: entries !! the entries of its cases or steps, in their order
      character(:), allocatable :: text
      type(error_t), allocatable :: error
      logical :: is_same

      call read_text_file(path, text, error)
      is_same = .not. allocated(error)
      if (is_same) is_same = text == collection_head//entries//collection_tail
      if (.not. is_same) call faults%add(path, 'it does not list the grids that it should, in their order')
   end subroutine compare_collection

   !> Opens a grid, whose arrays are to be compared.
   subroutine new_vtk_check(check, path, units)
      type(vtk_check_t), intent(out) :: check !! the grid
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: units !! names of the units of the case
      type(error_t), allocatable :: error

      check%path = path
      check%units = units
      call read_plain_file(path, check%text, error)
      if (allocated(error)) call check%stop_at('cannot be read')
   end subroutine new_vtk_check

   !> Compares the next array of a grid with real numbers.
   subroutine vtk_check_put_reals(self, section, name, dimension, n_components, values)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section of the array
      character(*), intent(in) :: name !! name of the quantity
      character(*), intent(in) :: dimension !! its dimension, as `unit_of` takes it
      integer, intent(in) :: n_components !! numbers per point or cell
      real(dp), intent(in) :: values(:) !! the expected values
      character(:), allocatable :: bytes
      real(dp), allocatable :: found(:)
      integer :: place

      call self%begin_array(section, 'Float64', name, n_components, dimension)
      call self%read_array(name, 8_int64*size(values, kind=int64), bytes)
      if (.not. self%is_readable) return
      found = transfer(bytes, values, size(values))
      place = first_disagreement(found, values, self%scale)
      if (place == 0) return
      call self%faults%add(self%path, contradiction(name//' of '//entry_name(section, place, n_components), &
         found(place), values(place)))
   end subroutine vtk_check_put_reals

   !> Compares the next array of a grid with whole numbers.
   subroutine vtk_check_put_integers(self, section, name, values)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section of the array
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: values(:) !! the expected values
      character(:), allocatable :: bytes
      integer(int32), allocatable :: found(:)
      integer :: place

      call self%begin_array(section, 'Int32', name, 1, '')
      call self%read_array(name, 4_int64*size(values, kind=int64), bytes)
      if (.not. self%is_readable) return
      found = transfer(bytes, 0_int32, size(values))
      do place = 1, size(values)
         if (found(place) == values(place)) cycle
         call self%faults%add(self%path, name//' of '//entry_name(section, place, 1)//' is '// &
            to_text(int(found(place)))//', but '//to_text(values(place))//' follows from the other files')
         return
      end do
   end subroutine vtk_check_put_integers

   !> Compares the markup before an array and reads the array.
   subroutine vtk_check_read_array(self, name, n_bytes, bytes)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: name !! name of the array
      integer(int64), intent(in) :: n_bytes !! its length
      character(:), allocatable, intent(out) :: bytes !! the array as the machine has it, if it can be read
      character(:), allocatable :: fault

      call self%compare_markup('before '//name)
      if (.not. self%is_readable) return
      call take_bytes(self%text, self%position, name, n_bytes, bytes, fault)
      if (len(fault) > 0) call self%stop_at(fault)
      call self%end_array()
   end subroutine vtk_check_read_array

   !> Compares the markup of a grid up to its next array.
   subroutine vtk_check_compare_markup(self, place)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: place !! its position in the file
      integer :: i

      if (.not. self%is_readable) return
      associate (found => self%text(self%position:min(self%position + len(self%markup) - 1, len(self%text))))
         if (len(found) < len(self%markup)) then
            call self%stop_at('the file ends '//place)
         else if (found /= self%markup) then
            do i = 1, len(found)
               if (found(i:i) /= self%markup(i:i)) exit
            end do
            call self%stop_at('from byte '//to_text(self%position + i - 1)//' on, '//place// &
               ', it is not a grid of this mesh')
         end if
      end associate
      self%position = self%position + len(self%markup)
   end subroutine vtk_check_compare_markup

   !> Compares the text after the last array.
   subroutine vtk_check_close(self)
      class(vtk_check_t), intent(inout) :: self !! the grid

      call self%end_grid()
      call self%compare_markup('behind the last array')
      if (self%is_readable .and. self%position <= len(self%text)) then
         call self%stop_at('bytes follow the end of the grid')
      end if
   end subroutine vtk_check_close

   !> Records a fault after which the file cannot be compared any further.
   subroutine vtk_check_stop_at(self, sentence)
      class(vtk_check_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: sentence !! the fault

      self%is_readable = .false.
      call self%faults%add(self%path, sentence)
   end subroutine vtk_check_stop_at

   !> The name of a number of an array in a grid, for messages.
   pure function entry_name(section, place, n_components) result(name)
      character(*), intent(in) :: section !! the section of the array
      integer, intent(in) :: place !! index of the number, from 1
      integer, intent(in) :: n_components !! numbers per point or cell
      character(:), allocatable :: name

      select case (section)
      case ('PointData', 'Points')
         name = 'point '
      case ('CellData')
         name = 'cell '
      case default
         name = 'entry '
      end select
      name = name//to_text((place - 1)/n_components + 1)
      if (n_components > 1) name = name//', component '//to_text(modulo(place - 1, n_components) + 1)
   end function entry_name

   !> Reads an array of reals from a grid.
   subroutine read_array(path, name, n_components, values, fault)
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per point
      real(dp), intent(out) :: values(:) !! the values, those of one point together; 0 after a fault
      character(:), allocatable, intent(out) :: fault !! why they cannot be read; empty if they can
      type(error_t), allocatable :: error
      character(:), allocatable :: text, markup, bytes
      integer :: first

      values = 0.0_dp
      call read_plain_file(path, text, error)
      if (allocated(error)) then
         fault = 'cannot be read'
         return
      end if
      markup = '<DataArray type="Float64" Name="'//name//'"'
      if (n_components > 1) markup = markup//' NumberOfComponents="'//to_text(n_components)//'"'
      markup = markup//' format="binary">'
      first = index(text, markup)
      if (first == 0) then
         fault = 'no '//name//' stands where it was written'
      else
         first = first + len(markup)
         call take_bytes(text, first, name, 8_int64*size(values, kind=int64), bytes, fault)
         if (len(fault) == 0) values = transfer(bytes, values, size(values))
         if (.not. all(abs(values) <= huge(1.0_dp))) fault = 'not every '//name//' is a finite number'
      end if
   end subroutine read_array

   !> Takes the bytes of an array from the text of a grid, in which they follow after their number.
   subroutine take_bytes(text, position, name, n_bytes, bytes, fault)
      character(*), intent(in) :: text !! the text
      integer, intent(inout) :: position !! position of its first letter, from 1; behind its last one on return
      character(*), intent(in) :: name !! name of the array
      integer(int64), intent(in) :: n_bytes !! number of bytes that it should have
      character(:), allocatable, intent(out) :: bytes !! the bytes, if they can be read
      character(:), allocatable, intent(out) :: fault !! why they cannot be read; empty if they can
      character(:), allocatable :: all_bytes
      integer(int64) :: found, last
      logical :: is_valid

      fault = ''
      last = position - 1 + base64_size(bytes_per_length + n_bytes)
      if (last > len(text)) then
         fault = 'the file ends within '//name
         return
      end if
      call decode_base64(text(position:last), bytes_per_length + n_bytes, all_bytes, is_valid)
      position = int(last) + 1
      found = transfer(all_bytes(:bytes_per_length), found)
      if (.not. is_valid) then
         fault = name//' is not '//to_text(bytes_per_length + n_bytes)//' bytes in base64'
      else if (found /= n_bytes) then
         fault = 'the length of '//name//' is '//to_text(found)//', expected '//to_text(n_bytes)//' bytes'
      else
         bytes = all_bytes(bytes_per_length + 1:)
      end if
   end subroutine take_bytes

   !> Compares the text files with the texts that follow from the other files.
   subroutine verified_case_compare(self, documents, summary)
      class(verified_case_t), intent(inout) :: self !! the case; gains the faults
      type(document_t), intent(in) :: documents(:) !! the texts, but for the summary
      type(document_t), intent(in) :: summary !! the summary
      integer :: i

      call compare_document(self%faults, self%stem, summary)
      do i = size(documents), 1, -1
         call compare_document(self%faults, self%stem, documents(i))
      end do
   end subroutine verified_case_compare

   !> Adds a fault of a file, if there is one.
   pure subroutine verified_case_fault(self, ending, sentence)
      class(verified_case_t), intent(inout) :: self !! the case; gains the fault
      character(*), intent(in) :: ending !! suffix of the file name, after the name of the case
      character(*), intent(in) :: sentence !! the fault, as a sentence; empty if there is none

      if (len(sentence) > 0) call self%faults%add(self%stem//ending, sentence)
   end subroutine verified_case_fault

   !> A member of the summary as a number; 0 if it is no number.
   pure real(dp) function verified_case_number(self, section, member) result(number)
      class(verified_case_t), intent(in) :: self !! the case
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      logical :: ok

      call read_real(self%value(section, member), number, ok)
      if (.not. ok) number = 0.0_dp
   end function verified_case_number

   !> The text of a member of the summary; empty if there is no such member.
   pure function verified_case_value(self, section, member) result(value)
      class(verified_case_t), intent(in) :: self !! the case
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      character(:), allocatable :: value

      value = member_value(self%summary, section, member)
   end function verified_case_value

   !> Reads a table of results, with its header.
   subroutine read_csv_table(table, path, header, n_columns, fault)
      type(csv_table_t), intent(out) :: table !! the table
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in), optional :: header !! the first line that it should have, with its end; default any
      integer, intent(in), optional :: n_columns !! number of fields of a row; default that of the first line
      character(:), allocatable, intent(out) :: fault !! why it is no such table; empty if it is
      type(error_t), allocatable :: error
      integer :: i, n_commas, n

      fault = ''
      table%header = ''
      call read_text_file(path, table%text, error)
      if (allocated(error)) then
         fault = error%message(len(path) + 3:)
      else if (len(table%text) == 0) then
         fault = 'it is empty'
      else if (table%text(len(table%text):) /= newline) then
         fault = 'the last line does not end'
      else
         table%header = table%text(:index(table%text, newline) - 1)
         if (present(header)) then
            if (table%header//newline /= header) fault = 'the first line is not the header of this table'
         end if
      end if
      if (len(fault) > 0) return
      n = occurrences(table%header, ',') + 1
      if (present(n_columns)) n = n_columns
      do i = len(table%header) + 1, len(table%text)
         if (table%text(i:i) == newline) call table%start%append(i + 1)
      end do
      table%n_rows = table%start%n - 1
      do i = 1, table%n_rows
         n_commas = occurrences(table%row(i), ',')
         if (n_commas == n - 1) cycle
         fault = 'line '//to_text(i + 1)//' has '//to_text(n_commas + 1)//' fields, expected '//to_text(n)
         return
      end do
   end subroutine read_csv_table

   !> Number of the column with a given name; 0 if there is none. No name before it may contain a comma.
   pure integer function csv_table_column(self, name) result(column)
      class(csv_table_t), intent(in) :: self !! the table
      character(*), intent(in) :: name !! the name

      column = index(','//self%header//',', ','//name//',')
      if (column > 0) column = occurrences(self%header(:column - 1), ',') + 1
   end function csv_table_column

   !> The text of a row, without the end of its line.
   pure function csv_table_row(self, row) result(text)
      class(csv_table_t), intent(in) :: self !! the table
      integer, intent(in) :: row !! number of the row
      character(:), allocatable :: text

      text = self%text(self%start%item(row):self%start%item(row + 1) - 2)
   end function csv_table_row

   !> The text of a field of the table.
   pure function csv_table_field(self, row, column) result(text)
      class(csv_table_t), intent(in) :: self !! the table
      integer, intent(in) :: row !! its row
      integer, intent(in) :: column !! its column
      character(:), allocatable :: text
      integer :: first, i

      first = self%start%item(row)
      do i = 2, column
         first = first + index(self%text(first:), ',')
      end do
      text = self%text(first:first + scan(self%text(first:), ','//newline) - 2)
   end function csv_table_field

   !> The number in a field of the table.
   pure subroutine csv_table_get_number(self, row, column, value, fault)
      class(csv_table_t), intent(in) :: self !! the table
      integer, intent(in) :: row !! its row
      integer, intent(in) :: column !! its column
      real(dp), intent(out) :: value !! the number, 0 if there is none
      character(:), allocatable, intent(inout) :: fault !! gains why it is no number, unless it has a fault already
      logical :: ok

      call read_real(self%field(row, column), value, ok)
      if (ok .or. len(fault) > 0) return
      fault = 'line '//to_text(row + 1)//', field '//to_text(column)//": expected a number, found '"// &
         self%field(row, column)//"'"
   end subroutine csv_table_get_number

end module amontons_file_check
