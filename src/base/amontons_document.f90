!> A text file of a result as a list of parts, the fields of its tables, and its values in JSON. `--verify` makes the
!> same parts from the contents of the other files and compares them: a part follows from these, unless it is marked as
!> a record of the run that wrote it.
!>
!> Rows of tables are made on several threads without functions that return a text: gfortran 12 keeps the length of such
!> a text in a variable that all threads share.
module amontons_document
   use amontons_kinds, only: dp
   use amontons_quantity, only: expanded, quantity_t
   use amontons_text, only: append_text, longest_decimal, put_integer, put_text, read_integer, replaced, to_text, &
      utf_8_width
   implicit none (type, external)
   private

   public :: document_t, field, json_logical, json_number, json_numbers, json_string, quantity_members, &
      read_status_runs, status_runs

   !> Letters of the statuses, in the order of their numbers in `amontons_friction_law`.
   character(*), parameter :: letters = 'os+-*'

   !> A part of a text: whole lines.
   type :: part_t
      character(:), allocatable :: text !! the lines, with their ends
      real(dp), allocatable :: scales(:)
         !! scales of the first, second ... number of a line, if larger than these; the last one is for the rest
      logical :: is_recorded = .false. !! whether it cannot be computed again from the files
      logical :: is_by_line = .false. !! whether the scales are those of the first, second ... line instead
   end type part_t

   !> A text file.
   type :: document_t
      character(:), allocatable :: ending !! suffix of its name, after the name of the case
      integer :: n = 0 !! number of its parts
      type(part_t), allocatable :: parts(:) !! the parts, and room for more
   contains
      procedure :: add => document_add
      procedure :: append => document_append
      procedure :: record => document_record
      procedure :: text => document_text
   end type document_t

contains

   !> A finite real as a JSON number; `null` for NaN and infinity.
   pure function json_number(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      if (abs(value) <= huge(value)) then
         text = to_text(value)
      else
         text = 'null'
      end if
   end function json_number

   !> Reals as the elements of a JSON array.
   pure function json_numbers(values) result(text)
      real(dp), intent(in) :: values(:) !! the numbers
      character(:), allocatable :: text
      ! A separator, and the longest number.
      integer, parameter :: longest = longest_decimal + 2
      integer :: i, length

      allocate (character(longest*size(values)) :: text)
      length = 0
      do i = 1, size(values)
         call put_text(text, length, ', '//json_number(values(i)))
      end do
      text = text(3:length)
   end function json_numbers

   !> Quantities as the members of a JSON object.
   pure function quantity_members(quantities) result(text)
      type(quantity_t), intent(in) :: quantities(:) !! the quantities
      character(:), allocatable :: text
      type(quantity_t), allocatable :: list(:)
      integer :: i, length

      list = expanded(quantities)
      text = ''
      length = 0
      do i = 1, size(list)
         if (i > 1) call append_text(text, length, ', ')
         call append_text(text, length, json_string(trim(list(i)%key))//': '//json_number(list(i)%value))
      end do
      text = text(:length)
   end function quantity_members

   !> The JSON word of a logical value.
   pure function json_logical(value) result(text)
      logical, intent(in) :: value !! the value
      character(:), allocatable :: text

      text = trim(merge('true ', 'false', value))
   end function json_logical

   !> A text as a JSON string. Bytes that are not valid UTF-8 are converted from Latin-1, so that the result is valid
   !> JSON.
   pure function json_string(value) result(text)
      character(*), intent(in) :: value !! the text
      character(:), allocatable :: text
      character(6) :: escape
      integer :: i, width

      text = '"'
      i = 1
      do while (i <= len(value))
         width = utf_8_width(value(i:))
         if (scan(value(i:i), '"\') > 0) text = text//'\'
         if (width == 0) then
            write (escape, '("\u", z4.4)') iachar(value(i:i))
            text = text//escape
         else
            text = text//value(i:i + width - 1)
         end if
         i = i + max(1, width)
      end do
      text = text//'"'
   end function json_string

   !> The statuses along the contact lines as run lengths, `4o 12+ 17s`: o open, s stick, + and - slip, * slip of a
   !> twisted body; a bar separates two contact sets.
   pure subroutine status_runs(runs, status, set)
      character(:), allocatable, intent(out) :: runs !! the run lengths
      integer, intent(in) :: status(:) !! status of each point (m)
      integer, intent(in) :: set(:) !! contact set of each point (m)
      character(11) :: run
      integer :: first, length, p

      runs = ''
      first = 1
      do p = 1, size(status)
         if (p < size(status)) then
            if (status(p + 1) == status(p) .and. set(p + 1) == set(p)) cycle
         end if
         length = 0
         call put_integer(run, length, p - first + 1)
         runs = runs//run(:length)//letters(status(p):status(p))
         first = p + 1
         if (p == size(status)) exit
         if (set(p + 1) /= set(p)) runs = runs//' |'
         runs = runs//' '
      end do
   end subroutine status_runs

   !> Reads statuses from their run lengths.
   pure subroutine read_status_runs(status, runs, ok)
      integer, intent(out) :: status(:) !! status of each point (m)
      character(*), intent(in) :: runs !! the run lengths
      logical, intent(out) :: ok !! whether they are those of m points
      integer :: first, last, length, n, state

      status = 0
      n = 0
      first = 1
      ok = .true.
      do while (ok .and. first <= len(runs))
         last = first + index(runs(first:)//' ', ' ') - 2
         if (runs(first:last) /= '|') then
            call read_integer(runs(first:last - 1), length, ok)
            state = index(letters, runs(max(last, 1):max(last, 1)))
            ok = ok .and. state > 0 .and. length > 0 .and. length <= size(status) - n
            if (ok) status(n + 1:n + length) = state
            if (ok) n = n + length
         end if
         first = last + 2
      end do
      ok = ok .and. n == size(status)
   end subroutine read_status_runs

   !> A text as a field of a CSV table, quoted where necessary.
   pure function field(value) result(text)
      character(*), intent(in) :: value !! the text
      character(:), allocatable :: text

      text = value
      if (scan(value, ',"') > 0) text = '"'//replaced(value, '"', '""')//'"'
   end function field

   !> Appends text that follows from deck, mesh, displacements, contact forces and statuses.
   pure subroutine document_add(self, text, scales, is_by_line)
      class(document_t), intent(inout) :: self !! the document
      character(*), intent(in) :: text !! whole lines
      real(dp), intent(in), optional :: scales(:)
         !! scales of the first, second ... number of a line, if larger than these; the last is for the rest; default 0
      logical, intent(in), optional :: is_by_line !! whether the scales are those of the lines; not by default
      type(part_t) :: part

      if (len(text) == 0) return
      part%text = text
      part%scales = [0.0_dp]
      if (present(scales)) part%scales = scales
      if (present(is_by_line)) part%is_by_line = is_by_line
      call append(self, part)
   end subroutine document_add

   !> Appends a record of the run that solved the case, such as iterations and times, which cannot be recomputed.
   pure subroutine document_record(self, text)
      class(document_t), intent(inout) :: self !! the document
      character(*), intent(in) :: text !! whole lines
      type(part_t) :: part

      part%text = text
      part%is_recorded = .true.
      call append(self, part)
   end subroutine document_record

   !> Appends the parts of another document.
   pure subroutine document_append(self, other)
      class(document_t), intent(inout) :: self !! the document
      type(document_t), intent(in) :: other !! the other document
      integer :: i

      do i = 1, other%n
         call append(self, other%parts(i))
      end do
   end subroutine document_append

   !> Appends a part to the document.
   pure subroutine append(document, part)
      class(document_t), intent(inout) :: document !! the document
      type(part_t), intent(in) :: part !! the part

      if (.not. allocated(document%parts)) allocate (document%parts(16))
      if (document%n == size(document%parts)) document%parts = [document%parts, document%parts]
      document%n = document%n + 1
      document%parts(document%n) = part
   end subroutine append

   !> The text of all parts of the document.
   pure function document_text(self) result(text)
      class(document_t), intent(in) :: self !! the document
      character(:), allocatable :: text
      integer :: i, length

      allocate (character(sum([(len(self%parts(i)%text), i=1, self%n)])) :: text)
      length = 0
      do i = 1, self%n
         call put_text(text, length, self%parts(i)%text)
      end do
   end function document_text

end module amontons_document
