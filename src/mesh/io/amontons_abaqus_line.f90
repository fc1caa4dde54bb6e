!> Lines of the input format of Abaqus and CalculiX: keywords with parameters, data lines with fields.
module amontons_abaqus_line
   use amontons_file_model, only: longest_name
   use amontons_input_file, only: input_file_t
   use amontons_kinds, only: dp
   use amontons_text, only: lower_case, read_real, to_text
   implicit none (type, external)
   private

   public :: find_parameter, is_at_line_end, next_data_line, next_keyword, refuse_parameters, take_comma, take_field, &
      take_fields, take_number

   character, parameter :: line_feed = achar(10)
   !> Longer keyword lines are refused.
   integer, parameter :: longest_line = 2000

contains

   !> Whether nothing but blanks is left on the line.
   pure logical function is_at_line_end(input)
      type(input_file_t), intent(in) :: input !! the file, behind blanks

      is_at_line_end = input%position > len(input%text)
      if (.not. is_at_line_end) is_at_line_end = input%text(input%position:input%position) == line_feed
   end function is_at_line_end

   !> Whether a text begins at the position.
   pure logical function stands_here(input, text)
      type(input_file_t), intent(in) :: input !! the file
      character(*), intent(in) :: text !! the text

      stands_here = input%position + len(text) - 1 <= len(input%text)
      if (stands_here) stands_here = input%text(input%position:input%position + len(text) - 1) == text
   end function stands_here

   !> Moves to the next line that is no comment and not empty.
   pure subroutine skip_comments(input)
      type(input_file_t), intent(inout) :: input !! the file, at the beginning of a line

      do
         call input%skip_white()
         if (.not. stands_here(input, '**')) return
         call skip_line(input)
      end do
   end subroutine skip_comments

   !> Moves to the next line.
   pure subroutine skip_line(input)
      type(input_file_t), intent(inout) :: input !! the file

      do while (.not. is_at_line_end(input))
         input%position = input%position + 1
      end do
      input%position = input%position + 1
   end subroutine skip_line

   !> Moves to the next data line; there is none where a keyword or the end of the file follows.
   pure subroutine next_data_line(input, is_there)
      type(input_file_t), intent(inout) :: input !! the file, at the beginning of a line
      logical, intent(out) :: is_there !! whether there is a data line

      call skip_comments(input)
      is_there = input%position <= len(input%text) .and. .not. stands_here(input, '*') &
         .and. .not. allocated(input%error)
   end subroutine next_data_line

   !> Moves over data lines to the next keyword and takes its line and those that continue it.
   pure subroutine next_keyword(input, keyword, line)
      type(input_file_t), intent(inout) :: input !! the file, at the beginning of a line
      character(:), allocatable, intent(out) :: keyword
         !! the keyword in small letters, without `*` and blanks; empty at the end of the file
      character(:), allocatable, intent(out) :: line !! the whole line, behind the `*`
      integer :: i
      logical :: is_there

      keyword = ''
      line = ''
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call skip_line(input)
      end do
      if (.not. stands_here(input, '*')) return
      call take_keyword_line(input, line)
      if (allocated(input%error)) return
      do i = 1, len(line)
         if (line(i:i) == ',') exit
         if (line(i:i) /= ' ') keyword = keyword//lower_case(line(i:i))
      end do
   end subroutine next_keyword

   !> Takes a keyword line and the lines that continue it.
   pure subroutine take_keyword_line(input, line)
      type(input_file_t), intent(inout) :: input !! the file, at the `*` of the line
      character(:), allocatable, intent(out) :: line !! the whole line, behind the `*`
      character(:), allocatable :: more
      integer :: place
      logical :: is_there

      place = input%position
      input%position = input%position + 1
      call input%take_line(line)
      do while (len(line) > 0 .and. len(line) <= longest_line .and. index(line, ',', back=.true.) == len(line))
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call input%take_line(more)
         line = line//more
      end do
      if (len(line) > longest_line) call input%refuse( &
         'a keyword line of more than '//to_text(longest_line)//' characters', place)
   end subroutine take_keyword_line

   !> Finds a parameter of a keyword line, as in `*NSET, NSET=left, GENERATE`.
   pure subroutine find_parameter(line, name, value, is_there)
      character(*), intent(in) :: line !! the line
      character(*), intent(in) :: name !! name of the parameter, in small letters
      character(:), allocatable, intent(out) :: value !! its value without quotes, empty where there is none
      logical, intent(out) :: is_there !! whether the line has this parameter
      integer :: equals, first, last

      value = ''
      is_there = .false.
      first = index(line//',', ',') + 1
      do while (first <= len(line))
         last = first - 2 + index(line(first:)//',', ',')
         equals = index(line(first:last)//'=', '=')
         if (lower_case(trim(adjustl(line(first:first + equals - 2)))) == name) then
            is_there = .true.
            value = unquoted(trim(adjustl(line(first + equals:last))))
            return
         end if
         first = last + 2
      end do
   end subroutine find_parameter

   !> A text without the double quotes around it.
   pure function unquoted(text) result(inside)
      character(*), intent(in) :: text !! the text
      character(:), allocatable :: inside

      inside = text
      if (len(text) < 2) return
      if (text(1:1) == '"' .and. text(len(text):) == '"') inside = trim(text(2:len(text) - 1))
   end function unquoted

   !> Moves over a comma and the blanks around it.
   pure subroutine take_comma(input, is_there)
      type(input_file_t), intent(inout) :: input !! the file
      logical, intent(out) :: is_there !! whether there is a comma

      call input%skip_blanks()
      is_there = stands_here(input, ',')
      if (.not. is_there) return
      input%position = input%position + 1
      call input%skip_blanks()
   end subroutine take_comma

   !> Takes a field of a data line as a text.
   pure subroutine take_field(input, field)
      type(input_file_t), intent(inout) :: input !! the file
      character(:), allocatable, intent(out) :: field !! the text, without quotes, blanks and the comma behind it
      integer :: first

      first = input%position
      do while (.not. is_at_line_end(input))
         if (stands_here(input, ',')) exit
         input%position = input%position + 1
      end do
      field = input%text(first:input%position - 1)
      if (len(field) == 0) return
      if (field(len(field):) == achar(13)) field = field(:len(field) - 1)
      field = unquoted(trim(field))
   end subroutine take_field

   !> Takes all fields of a data line.
   pure subroutine take_fields(input, fields, n)
      type(input_file_t), intent(inout) :: input !! the file, at the beginning of the line
      character(longest_name), intent(out) :: fields(:) !! the fields, empty behind the last
      integer, intent(out) :: n !! number of fields; those at the end that are empty count
      character(:), allocatable :: field
      logical :: is_there

      fields = ''
      n = 0
      do
         call input%skip_blanks()
         call take_field(input, field)
         if (n == size(fields) .and. field /= '') call input%refuse('more than '//to_text(n)//' fields on a line')
         if (len(field) > len(fields)) call input%refuse('a field of more than '//to_text(len(fields))//' characters')
         if (allocated(input%error)) exit
         n = min(n + 1, size(fields))
         if (field /= '') fields(n) = field
         call take_comma(input, is_there)
         if (.not. is_there) exit
      end do
      call input%end_line()
   end subroutine take_fields

   !> Takes a field as a number.
   pure subroutine take_number(input, field, value)
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: field !! the field
      real(dp), intent(out) :: value !! the number
      logical :: ok

      call read_real(trim(field), value, ok)
      if (.not. ok) call input%refuse("expected a number, found '"//trim(field)//"'", input%position - 1)
   end subroutine take_number

   !> Refuses parameters of a keyword that change what its lines mean.
   pure subroutine refuse_parameters(input, line)
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      ! Those that say what is meant anyway, whatever their value or with this one alone.
      character(8), parameter :: harmless_names(*) = [character(8) :: '', 'elset', 'material', 'zero', 'moduli']
      character(17), parameter :: harmless(*) = [character(17) :: 'op=mod', 'type=displacement', 'type=iso', &
         'type=isotropic', 'type=temperature', 'dependencies=0']
      character(:), allocatable :: field
      integer :: first, last, i

      first = index(line//',', ',') + 1
      do while (first <= len(line))
         last = first - 2 + index(line(first:)//',', ',')
         field = ''
         do i = first, last
            if (line(i:i) /= ' ') field = field//lower_case(line(i:i))
         end do
         if (all(harmless_names /= field(:index(field//'=', '=') - 1)) .and. all(harmless /= field)) then
            call input%refuse('*'//line(:index(line//',', ',') - 1)//' with '//trim(adjustl(line(first:last)))// &
               ' cannot be used', input%position - 1)
            return
         end if
         first = last + 2
      end do
   end subroutine refuse_parameters

end module amontons_abaqus_line
