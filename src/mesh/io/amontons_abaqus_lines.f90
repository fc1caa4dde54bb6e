!> Lines of the input format of Abaqus and CalculiX, keywords with parameters and data lines with fields; and what they
!> define first: sets of nodes and elements, and surfaces.
module amontons_abaqus_lines
   use amontons_element, only: n_corners
   use amontons_file_model, only: longest_name, raw_mesh_t
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t, new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_text, only: lower_case, read_integer, read_real, to_text
   implicit none (type, external)
   private

   public :: abaqus_scope_t, add_members, find_parameter, get_set, is_at_line_end, named_group, next_data_line, &
      next_keyword, read_set, read_surface, refuse_parameters, resolve_elements, take_comma, take_fields, take_number

   character, parameter :: line_feed = achar(10)
   !> Longer keyword lines are refused.
   integer, parameter :: longest_line = 2000

   !> Where in the file a keyword stands. Names in the assembly are others than those in the part.
   type :: abaqus_scope_t
      integer :: n_parts = 0 !! number of parts so far
      integer :: n_instances = 0 !! number of instances so far
      logical :: in_assembly = .false. !! whether the assembly has begun and not ended
      integer :: n_part_groups = 0 !! number of named sets before the assembly
   end type abaqus_scope_t

   !> What precedes the name of a set of the assembly when the part has a set of that name.
   character(*), parameter :: assembly_prefix = 'assembly.'
   !> Names of the sides of an element.
   character(*), parameter :: side_names(4) = ['s1', 's2', 's3', 's4']

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

      do
         call input%skip_white()
         if (.not. stands_here(input, '**')) exit
         call skip_line(input)
      end do
      is_there = input%position <= len(input%text) .and. .not. stands_here(input, '*') &
         .and. .not. allocated(input%error)
   end subroutine next_data_line

   !> Moves over data lines to the next keyword and takes its line and those that continue it.
   pure subroutine next_keyword(input, keyword, line)
      type(input_file_t), intent(inout) :: input !! the file, at the beginning of a line
      character(:), allocatable, intent(out) :: keyword
         !! the keyword in small letters, without `*` and blanks; empty at the end of the file
      character(:), allocatable, intent(out) :: line !! the whole line, behind the `*`
      character(:), allocatable :: more
      integer :: i, place
      logical :: is_there

      keyword = ''
      line = ''
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call skip_line(input)
      end do
      if (.not. stands_here(input, '*')) return
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
      if (allocated(input%error)) return
      do i = 1, len(line)
         if (line(i:i) == ',') exit
         if (line(i:i) /= ' ') keyword = keyword//lower_case(line(i:i))
      end do
   end subroutine next_keyword

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

   !> The set that a keyword line names, a new one if need be.
   pure subroutine get_set(raw, input, scope, line, parameter, group)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      type(abaqus_scope_t), intent(in) :: scope !! where the file is
      character(*), intent(in) :: line !! the keyword line
      character(*), intent(in) :: parameter !! name of the parameter, in small letters
      integer, intent(out) :: group !! the set, 0 where the line names none
      character(:), allocatable :: name
      logical :: is_there

      group = 0
      call find_parameter(line, parameter, name, is_there)
      if (name == '') return
      if (scope%in_assembly) then
         group = raw%find_group(name)
         if (group > 0 .and. group <= scope%n_part_groups) then
            name = assembly_prefix//name
         end if
      end if
      call raw%get_group(input, name, group)
   end subroutine get_set

   !> Reads a set of nodes or elements: numbers and names of sets above; or ranges, each a first number, a last one and
   !> an increment that is 1 where it is absent.
   pure subroutine read_set(raw, input, scope, line, keyword)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      type(abaqus_scope_t), intent(in) :: scope !! where the file is
      character(*), intent(in) :: line !! the keyword line
      character(*), intent(in) :: keyword !! 'nset' or 'elset', which is also the parameter that names the set
      character(:), allocatable :: field, value
      type(integer_list_t) :: members
      integer :: first, group, i, increment, last, n
      logical :: has_elements, is_in_instance, is_range, is_there

      call find_parameter(line, 'elset', value, has_elements)
      call find_parameter(line, 'instance', value, is_in_instance)
      call find_parameter(line, 'generate', value, is_range)
      if (keyword == 'nset' .and. has_elements) then
         call raw%add_note('a set of the nodes of an element set left out: '//line)
         return
      end if
      if (scope%in_assembly .and. .not. is_in_instance) then
         call raw%add_note('a set outside the instance left out: '//line)
         return
      end if
      call get_set(raw, input, scope, line, keyword, group)
      if (group == 0) call input%refuse('expected '//keyword//'= and a name', input%position - 1)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         if (is_range) then
            call input%take_integer(first, 'the first number of a range')
            call take_comma(input, is_there)
            call input%take_integer(last, 'the last number of a range')
            call take_comma(input, is_there)
            increment = 1
            if (.not. is_at_line_end(input)) call input%take_integer(increment, 'the increment of a range')
            call take_comma(input, is_there)
            if (first < 1 .or. last < first .or. increment < 1) call input%refuse( &
               'expected a range: two positive numbers, the second not the smaller one, and a positive increment')
            n = (last - first)/max(1, increment)
            call raw%expect_members(input, n)
            call input%end_line()
            if (.not. allocated(input%error)) call members%append_all([(first + i*increment, i=0, n)])
         else
            do
               call take_field(input, field)
               call add_members(raw, input, 'there is no set', keyword == 'nset', field, members)
               call take_comma(input, is_there)
               if (is_at_line_end(input) .or. allocated(input%error)) exit
            end do
         end if
      end do
      if (allocated(input%error)) return
      if (keyword == 'nset') then
         call raw%groups(group)%node%append_all(members%items())
      else
         call raw%groups(group)%cell%append_all(members%items())
         call raw%groups(group)%side%append_all(spread(0, 1, members%n))
      end if
   end subroutine read_set

   !> The set that a field names, 0 for none: that of the assembly, if there is one.
   pure integer function named_group(raw, field) result(group)
      type(raw_mesh_t), intent(in) :: raw !! what the file says
      character(*), intent(in) :: field !! the name, perhaps with the name of an instance and a point before

      associate (name => field(index(field, '.', back=.true.) + 1:))
         group = raw%find_group(assembly_prefix//name)
         if (group == 0) group = raw%find_group(name)
      end associate
   end function named_group

   !> Adds what a field names: one thing by its number, or the things of a set.
   pure subroutine add_members(raw, input, refusal, of_nodes, field, members)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the field
      character(*), intent(in) :: refusal !! what a message says before the name of a set that is not there
      logical, intent(in) :: of_nodes !! whether the things are nodes rather than elements
      character(*), intent(in) :: field !! the field, perhaps with the name of an instance and a point before
      type(integer_list_t), intent(inout) :: members !! numbers of the things
      integer :: group, number
      logical :: is_number

      if (len(field) == 0) return
      call read_integer(field(index(field, '.', back=.true.) + 1:), number, is_number)
      if (is_number) then
         call members%append(number)
         return
      end if
      group = named_group(raw, field)
      if (group == 0) then
         call input%refuse(refusal//" '"//field(index(field, '.', back=.true.) + 1:)//"' above", input%position - 1)
      else if (of_nodes) then
         call raw%expect_members(input, raw%groups(group)%node%n)
         if (.not. allocated(input%error)) call members%append_all(raw%groups(group)%node%items())
      else
         associate (cells => raw%groups(group)%cell%items(), sides => raw%groups(group)%side%items())
            call raw%expect_members(input, size(cells))
            if (.not. allocated(input%error)) call members%append_all(pack(cells, sides == 0))
         end associate
      end if
   end subroutine add_members

   !> Reads a surface: lines of an element, or a set, and a side of it; of a surface of nodes, nodes. One that names
   !> anything else is left out.
   pure subroutine read_surface(raw, input, scope, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      type(abaqus_scope_t), intent(in) :: scope !! where the file is
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: field, type, value
      type(integer_list_t) :: members
      integer :: group, n, side
      logical :: is_combined, is_there, is_typed, of_nodes

      call find_parameter(line, 'type', type, is_typed)
      call find_parameter(line, 'combine', value, is_combined)
      of_nodes = lower_case(type) == 'node'
      if (is_combined .or. (is_typed .and. .not. of_nodes .and. lower_case(type) /= 'element')) then
         call raw%add_note('a surface of other things than sides and nodes left out: '//line)
         return
      end if
      call get_set(raw, input, scope, line, 'name', group)
      if (group == 0) call input%refuse('expected NAME= and a name', input%position - 1)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         n = members%n
         call take_field(input, field)
         call add_members(raw, input, 'there is no set', of_nodes, field, members)
         call take_comma(input, is_there)
         call take_field(input, field)
         side = findloc(side_names == lower_case(field), .true., dim=1)
         if (.not. of_nodes) then
            if (side == 0) call input%refuse("expected one of the sides S1 to S4, found '"//field//"'")
            call raw%groups(group)%side%append_all(spread(side, 1, members%n - n))
         end if
         call take_comma(input, is_there)
         call input%end_line()
      end do
      if (allocated(input%error)) return
      if (of_nodes) call raw%groups(group)%node%append_all(members%items())
      if (.not. of_nodes) call raw%groups(group)%cell%append_all(members%items())
   end subroutine read_surface

   !> Replaces the numbers of elements in the sets by places in the list of cells.
   pure subroutine resolve_elements(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file
      type(tag_map_t) :: map
      integer :: cell, group, i, n_sides, tag

      call new_tag_map(map, raw%cell_tag%items())
      do group = 1, raw%n_groups
         do i = 1, raw%groups(group)%cell%n
            tag = raw%groups(group)%cell%item(i)
            cell = map%find(tag)
            ! Lines have no sides.
            n_sides = 0
            if (cell > 0) n_sides = merge(n_corners(max(1, raw%cell_kind%item(cell))), 0, raw%cell_kind%item(cell) > 0)
            if (cell == 0) then
               call input%refuse("the set '"//raw%groups(group)%name//"' names element "//to_text(tag)// &
                  ', which the file does not give', raw%groups(group)%place)
            else if (raw%groups(group)%side%item(i) > n_sides) then
               call input%refuse("the surface '"//raw%groups(group)%name//"' names a side that element "// &
                  to_text(tag)//' has not', raw%groups(group)%place)
            end if
            if (allocated(input%error)) return
            raw%groups(group)%cell%item(i) = cell
         end do
      end do
   end subroutine resolve_elements

end module amontons_abaqus_lines
