!> Lines of the input format of Abaqus and CalculiX: keywords with parameters, and data lines with fields; included
!> files; parts and their instances; sets of nodes and elements, and surfaces.
module amontons_abaqus_lines
   use amontons_element, only: n_sides
   use amontons_error, only: error_t
   use amontons_file_model, only: cell_dimension, file_part_t, identity, longest_name, raw_mesh_t
   use amontons_input_file, only: beside, input_file_t, new_input_file
   use amontons_integer_list, only: integer_list_t, new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_text, only: lower_case, read_integer, read_real, to_text
   implicit none (type, external)
   private

   public :: add_members, assembly_scope, capitals, degree, end_instance, expected_instance, get_set, insert_included, &
      instance_shift, is_at_line_end, name_instance_sets, next_data_line, next_keyword, parameter_of, place_of_name, &
      read_set, read_surface, read_tag, refuse_parameters, resolve_elements, rotation_matrix, set_of_field, &
      start_instance, start_part, take_comma, take_fields, take_line_of_numbers, take_number, take_tag

   character, parameter :: line_feed = achar(10)
   !> Largest length of a keyword line.
   integer, parameter :: longest_line = 2000

   !> Prefix of the name of an assembly's set if an instance has a set of that name.
   character(*), parameter :: assembly_scope = 'assembly.'
   !> Largest number of included files.
   integer, parameter :: most_included = 300
   !> What is wrong with the line of an instance without a name.
   character(*), parameter :: expected_instance = 'expected *INSTANCE, NAME= and a name of at most 80 characters'
   !> Largest number of numbers in a line that defines axes or a translation.
   integer, parameter :: most_numbers = 9
   !> A degree [rad].
   real(dp), parameter :: degree = acos(-1.0_dp)/180.0_dp
   !> Names of the sides of an element.
   character(*), parameter :: side_names(*) = ['s1', 's2', 's3', 's4', 's5', 's6']

contains

   !> Replaces each `*INCLUDE` by the text of the included file. Faults are recorded in the input.
   subroutine insert_included(input)
      type(input_file_t), intent(inout) :: input !! the file; its text gains the others
      type(error_t), allocatable :: error
      type(input_file_t) :: included
      character(:), allocatable :: file, keyword, line, name
      integer :: n_included, number, place, start

      start = input%position
      n_included = 0
      call blank_tabs(input%text)
      do
         call next_keyword(input, keyword, line, place)
         if (keyword == '' .or. allocated(input%error)) exit
         if (keyword /= 'include') cycle
         n_included = n_included + 1
         name = parameter_of(line, 'input')
         if (name == '') call input%refuse('*INCLUDE: expected INPUT= and the name of a file', place)
         if (n_included > most_included) call input%refuse('*INCLUDE: more than '//to_text(most_included)// &
            ' files; do they include each other?', place)
         if (allocated(input%error)) exit
         call input%locate(place, file, number)
         call new_input_file(included, beside(file, name), error)
         if (allocated(error)) call input%refuse(error%message, place)
         if (allocated(input%error)) exit
         ! The last line may have no end.
         included%text = included%text//line_feed
         call blank_tabs(included%text)
         call input%replace(included, place)
      end do
      input%position = start
   end subroutine insert_included

   !> Replaces tabs by blanks.
   pure subroutine blank_tabs(text)
      character(:), allocatable, intent(inout) :: text !! the text
      integer :: i

      do i = 1, len(text)
         if (text(i:i) == achar(9)) text(i:i) = ' '
      end do
   end subroutine blank_tabs

   !> Whether only blanks are left on the line.
   pure logical function is_at_line_end(input)
      type(input_file_t), intent(in) :: input !! the file, behind blanks

      is_at_line_end = input%position > len(input%text)
      if (.not. is_at_line_end) is_at_line_end = input%text(input%position:input%position) == line_feed
   end function is_at_line_end

   !> Whether the file continues with a given text at its position.
   pure logical function continues_with(input, text)
      type(input_file_t), intent(in) :: input !! the file
      character(*), intent(in) :: text !! the text

      continues_with = input%position + len(text) - 1 <= len(input%text)
      if (continues_with) continues_with = input%text(input%position:input%position + len(text) - 1) == text
   end function continues_with

   !> Moves to the next line.
   pure subroutine skip_line(input)
      type(input_file_t), intent(inout) :: input !! the file

      integer :: length

      length = index(input%text(input%position:), line_feed)
      input%position = merge(input%position + length, len(input%text) + 2, length > 0)
   end subroutine skip_line

   !> Moves to the next data line, if there is one before the next keyword or the end of the file.
   pure subroutine next_data_line(input, is_there)
      type(input_file_t), intent(inout) :: input !! the file, at the beginning of a line
      logical, intent(out) :: is_there !! whether there is a data line

      do
         call input%skip_white()
         if (.not. continues_with(input, '**')) exit
         call skip_line(input)
      end do
      is_there = input%position <= len(input%text) .and. .not. continues_with(input, '*') &
         .and. .not. allocated(input%error)
   end subroutine next_data_line

   !> Moves to the next keyword and reads its line with the continuation lines.
   pure subroutine next_keyword(input, keyword, line, place)
      type(input_file_t), intent(inout) :: input !! the file, at the beginning of a line
      character(:), allocatable, intent(out) :: keyword
         !! the keyword in small letters, without `*` and blanks; empty at the end of the file
      character(:), allocatable, intent(out) :: line !! the whole line, behind the `*`
      integer, intent(out), optional :: place !! where the `*` stands
      character(:), allocatable :: more
      integer :: first, i
      logical :: is_there

      keyword = ''
      line = ''
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call skip_line(input)
      end do
      if (.not. continues_with(input, '*')) return
      first = input%position
      if (present(place)) place = first
      input%position = first + 1
      call input%take_line(line)
      do while (len(line) > 0 .and. len(line) <= longest_line .and. index(line, ',', back=.true.) == len(line))
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call input%take_line(more)
         line = line//more
      end do
      if (len(line) > longest_line) call input%refuse( &
         'a keyword line of more than '//to_text(longest_line)//' characters', first)
      if (allocated(input%error)) return
      do i = 1, len(line)
         if (line(i:i) == ',') exit
         if (line(i:i) /= ' ') keyword = keyword//lower_case(line(i:i))
      end do
   end subroutine next_keyword

   !> The value of a parameter of a keyword line, as in `*NSET, NSET=left, GENERATE`, without quotes; its own name, in
   !> small letters, where it has no value; empty if the line has no such parameter.
   pure function parameter_of(line, name) result(value)
      character(*), intent(in) :: line !! the line
      character(*), intent(in) :: name !! name of the parameter, in small letters
      character(:), allocatable :: value
      integer :: equals, first, last

      value = ''
      first = index(line//',', ',') + 1
      do while (first <= len(line) .and. value == '')
         last = first - 2 + index(line(first:)//',', ',')
         equals = index(line(first:last)//'=', '=')
         if (lower_case(trim(adjustl(line(first:first + equals - 2)))) == name) then
            value = name
            if (first + equals - 1 <= last) value = unquoted(trim(adjustl(line(first + equals:last))))
         end if
         first = last + 2
      end do
   end function parameter_of

   !> A text without the double quotes around it.
   pure function unquoted(text) result(inside)
      character(*), intent(in) :: text !! the text
      character(:), allocatable :: inside

      inside = text
      if (len(text) < 2) return
      if (text(1:1) == '"' .and. text(len(text):) == '"') inside = trim(text(2:len(text) - 1))
   end function unquoted

   !> A text in capital letters.
   pure function capitals(text) result(upper)
      character(*), intent(in) :: text !! the text
      character(len(text)) :: upper
      integer :: i

      upper = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') upper(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function capitals

   !> Skips a comma and the blanks around it, if there is one.
   pure subroutine take_comma(input, is_there)
      type(input_file_t), intent(inout) :: input !! the file
      logical, intent(out) :: is_there !! whether there is a comma

      call input%skip_blanks()
      is_there = continues_with(input, ',')
      if (.not. is_there) return
      input%position = input%position + 1
      call input%skip_blanks()
   end subroutine take_comma

   !> Reads a field of a data line as a text.
   pure subroutine take_field(input, field)
      type(input_file_t), intent(inout) :: input !! the file
      character(:), allocatable, intent(out) :: field !! the text, without quotes, blanks and the comma behind it
      integer :: first

      first = input%position
      do while (.not. is_at_line_end(input))
         if (continues_with(input, ',')) exit
         input%position = input%position + 1
      end do
      field = input%text(first:input%position - 1)
      if (len(field) == 0) return
      if (field(len(field):) == achar(13)) field = field(:len(field) - 1)
      field = unquoted(trim(field))
   end subroutine take_field

   !> Reads all fields of a data line.
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

   !> Converts a field to a number; a blank one is 0.
   pure subroutine take_number(input, field, value)
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: field !! the field
      real(dp), intent(out) :: value !! the number
      logical :: ok

      value = 0.0_dp
      ok = field == ''
      if (.not. ok) call read_real(trim(field), value, ok)
      if (.not. ok) call input%refuse_line("expected a number, found '"//trim(field)//"'")
   end subroutine take_number

   !> Refuses parameters of a keyword that change what its lines mean.
   pure subroutine refuse_parameters(input, line)
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      ! Those that say what is meant anyway, whatever their value or with this one alone.
      character(17), parameter :: harmless_names(*) = [character(17) :: '', 'elset', 'material', 'name', 'zero', &
         'moduli', 'interaction', 'smallsliding', 'positiontolerance', 'lagrange', 'sliptolerance', 'elasticslip']
      character(32), parameter :: harmless(*) = [character(32) :: 'op=mod', 'op=new', 'type=displacement', &
         'type=iso', 'type=isotropic', 'type=engineeringconstants', 'type=temperature', 'dependencies=0', &
         'system=rectangular', 'type=nodetosurface', 'type=surfacetosurface', 'type=mortar', 'type=linmortar', &
         'adjust=no', 'adjust=yes', 'pressure-overclosure=hard', 'pressure-overclosure=linear', &
         'pressure-overclosure=exponential', 'penalty', 'augmentedlagrange']
      character(:), allocatable :: field
      integer :: first, last, i

      first = index(line//',', ',') + 1
      do while (first <= len(line))
         last = first - 2 + index(line(first:)//',', ',')
         field = ''
         do i = first, last
            if (line(i:i) /= ' ') field = field//lower_case(line(i:i))
         end do
         if (all(harmless_names /= field(:index(field//'=', '=') - 1)) .and. all(harmless /= field) .and. .not. &
            (field == 'type=ortho' .and. index(lower_case(line), 'expansion') > 0)) then
            call input%refuse_line('*'//line(:index(line//',', ',') - 1)//' with '//trim(adjustl(line(first:last)))// &
               ' cannot be used')
            return
         end if
         first = last + 2
      end do
   end subroutine refuse_parameters

   !> Records where the text of a part begins, and skips it.
   pure subroutine start_part(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file so far
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: keyword, more, name
      type(file_part_t) :: part

      name = parameter_of(line, 'name')
      if (name == '' .or. len(name) > longest_name .or. place_of_name(raw%parts%name, name) > 0) call &
         input%refuse_line('expected *PART, NAME= and a name that no part has above')
      part%name = name
      part%place = input%position
      raw%parts = [raw%parts, part]
      do
         call next_keyword(input, keyword, more)
         if (keyword == 'endpart' .or. keyword == '') exit
      end do
      if (keyword == '') call input%refuse('*PART without *END PART', part%place - 1)
   end subroutine start_part

   !> Prefix of the names of an instance's sets.
   pure function scope_of(instance) result(scope)
      type(file_part_t), intent(in) :: instance !! the instance
      character(:), allocatable :: scope

      scope = ''
      if (instance%name /= '') scope = trim(instance%name)//'.'
   end function scope_of

   !> Starts an instance: reads its translation and rotation, and moves to the text of its part. Its nodes and elements
   !> get numbers above all others.
   pure subroutine start_instance(raw, input, name, part)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file so far
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: name !! its name; empty for the only part of a file without instances
      character(*), intent(in) :: part !! name of its part; empty where its contents follow
      type(file_part_t) :: instance
      real(dp) :: turn(most_numbers)
      integer :: i
      logical :: is_there

      if (len(name) > longest_name) call input%refuse_line(expected_instance)
      if (place_of_name(raw%instances%name, name) > 0) call input%refuse_line("a second instance '"//name//"'")
      i = place_of_name(raw%parts%name, part)
      if (part /= '' .and. i == 0) call input%refuse_line("there is no part '"//part//"' above")
      call take_line_of_numbers(input, instance%origin)
      call take_line_of_numbers(input, turn)
      call next_data_line(input, is_there)
      if (is_there) call input%refuse('*INSTANCE has two data lines at most: a translation and a rotation')
      if (abs(turn(7)) > 0.0_dp) then
         if (.not. norm2(turn(4:6) - turn(:3)) > 0.0_dp) then
            call input%refuse_line( &
               'expected two different points of the axis about which an instance is turned, and the angle')
            return
         end if
         instance%rotation = rotation_matrix(turn(4:6) - turn(:3), turn(7))
         instance%origin = turn(:3) + matmul(instance%rotation, instance%origin - turn(:3))
      end if
      instance%name = name
      instance%shift = maxval([0, raw%node_tag%items(), raw%cell_tag%items()])
      raw%instances = [raw%instances, instance]
      raw%is_in_instance = .true.
      raw%scope = scope_of(instance)
      if (i == 0) return
      raw%place_behind = input%position
      input%position = raw%parts(i)%place
   end subroutine start_instance

   !> Ends an instance, if one has begun.
   pure subroutine end_instance(raw, input, keyword)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file so far
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: keyword !! the keyword that ends it; empty at the end of the file

      if (raw%is_in_instance .and. keyword /= 'endinstance' .and. raw%scope /= '') call input%refuse_line( &
         "the instance '"//raw%scope(:len(raw%scope) - 1)//"' does not end: expected *END INSTANCE")
      raw%is_in_instance = .false.
      raw%scope = assembly_scope
   end subroutine end_instance

   !> The matrix of a rotation about an axis, by Rodrigues' formula.
   pure function rotation_matrix(axis, angle) result(matrix)
      real(dp), intent(in) :: axis(3) !! direction of the axis, of any length but 0
      real(dp), intent(in) :: angle !! the angle [degrees]
      real(dp) :: matrix(3, 3)

      associate (k => axis/norm2(axis), c => cos(angle*degree), s => sin(angle*degree))
         matrix = c*identity + s*reshape([0.0_dp, k(3), -k(2), -k(3), 0.0_dp, k(1), k(2), -k(1), 0.0_dp], [3, 3]) &
            + (1.0_dp - c)*spread(k, 2, 3)*spread(k, 1, 3)
      end associate
   end function rotation_matrix

   !> Reads the first numbers of a data line; all are zero if there is no data line.
   pure subroutine take_line_of_numbers(input, values)
      type(input_file_t), intent(inout) :: input !! the file
      real(dp), intent(out) :: values(:) !! the numbers
      character(longest_name) :: fields(most_numbers)
      integer :: i, n
      logical :: is_there

      values = 0.0_dp
      call next_data_line(input, is_there)
      n = 0
      if (is_there) call take_fields(input, fields, n)
      do i = 1, min(n, size(values))
         call take_number(input, fields(i), values(i))
      end do
   end subroutine take_line_of_numbers

   !> Index of a name in a list, irrespective of upper and lower case; 0 if it is not there.
   pure integer function place_of_name(names, name) result(place)
      character(*), intent(in) :: names(:) !! the list
      character(*), intent(in) :: name !! the name

      do place = size(names), 1, -1
         if (lower_case(trim(names(place))) == lower_case(name)) exit
      end do
   end function place_of_name

   !> The number added to node and element numbers of an instance, given the prefix of its sets; 0 outside of instances.
   pure integer function instance_shift(raw, scope) result(shift)
      type(raw_mesh_t), intent(in) :: raw !! contents of the file
      character(*), intent(in) :: scope !! prefix of the names of its sets
      integer :: instance

      instance = place_of_name(raw%instances%name, scope(:len(scope) - 1))
      shift = 0
      if (instance > 0) shift = raw%instances(instance)%shift
   end function instance_shift

   !> Reads the number of a node or element of the present instance.
   pure subroutine take_tag(input, shift, tag, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: shift !! by how much numbers of the instance are greater than in its text
      integer, intent(out) :: tag !! the number, behind those of the instances before
      character(*), intent(in) :: what !! meaning of the number, for the message

      call input%take_integer(tag, what)
      if (tag > huge(tag) - shift) call input%refuse('the number '//to_text(tag)// &
         ' is too large for a node or element of an instance behind others')
      tag = tag + merge(0, shift, allocated(input%error))
   end subroutine take_tag

   !> Reads a field that is the number of a node or element, possibly preceded by the name of its instance and a point.
   pure subroutine read_tag(raw, field, tag, is_number)
      type(raw_mesh_t), intent(in) :: raw !! contents of the file
      character(*), intent(in) :: field !! the field
      integer, intent(out) :: tag !! the number, behind those of the instances before
      logical, intent(out) :: is_number !! whether it is one
      character(:), allocatable :: scope
      integer :: shift

      scope = field(:index(field, '.', back=.true.))
      call read_integer(field(len(scope) + 1:), tag, is_number)
      if (scope == '') scope = raw%scope
      shift = instance_shift(raw, scope)
      is_number = is_number .and. tag <= huge(tag) - shift
      if (is_number) tag = tag + shift
   end subroutine read_tag

   !> Finds the set that a keyword line names, or makes a new one.
   pure subroutine get_set(raw, input, line, parameter, group)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      character(*), intent(in) :: parameter !! name of the parameter, in small letters
      integer, intent(out) :: group !! the set, 0 where the line names none
      character(:), allocatable :: name

      group = 0
      name = parameter_of(line, parameter)
      if (name == '') return
      call raw%get_group(input, raw%scope//name, group)
      raw%groups(group)%n_scope = len(raw%scope)
   end subroutine get_set

   !> Reads a set of nodes or elements: numbers and names of earlier sets; or ranges, each with a first number, a last
   !> one and an increment, which is 1 if missing.
   pure subroutine read_set(raw, input, line, keyword)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      character(*), intent(in) :: keyword !! 'nset' or 'elset', which is also the parameter that names the set
      character(:), allocatable :: instance, scope
      type(integer_list_t) :: members
      integer :: group
      logical :: is_left_out

      instance = parameter_of(line, 'instance')
      if (instance /= '' .and. place_of_name(raw%instances%name, instance) == 0) call input%refuse_line( &
         "there is no instance '"//instance//"' above")
      if (keyword == 'nset' .and. parameter_of(line, 'elset') /= '') then
         call raw%add_note('a set of the nodes of an element set left out: '//line)
         return
      end if
      call get_set(raw, input, line, keyword, group)
      scope = raw%scope
      if (instance /= '') raw%scope = instance//'.'
      if (group == 0) call input%refuse_line('expected '//keyword//'= and a name')
      call take_set_lines(raw, input, keyword, parameter_of(line, 'generate') /= '', members, is_left_out)
      raw%scope = scope
      if (allocated(input%error)) return
      if (is_left_out) then
         call raw%add_note('a set of other things than nodes and elements left out: '//line)
      else if (keyword == 'nset') then
         call raw%groups(group)%node%append_all(members%items())
      else
         call raw%groups(group)%cell%append_all(members%items())
         call raw%groups(group)%side%append_all(spread(0, 1, members%n))
      end if
   end subroutine read_set

   !> Reads the data lines of a set of nodes or elements.
   pure subroutine take_set_lines(raw, input, keyword, is_range, members, is_left_out)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'nset' or 'elset'
      logical, intent(in) :: is_range !! whether the lines are ranges
      type(integer_list_t), intent(out) :: members !! numbers of the nodes or elements
      logical, intent(out) :: is_left_out !! whether some of them are no numbers of nodes or elements
      character(:), allocatable :: field
      integer :: first, i, increment, last, n, shift
      logical :: is_there

      shift = instance_shift(raw, raw%scope)
      is_left_out = is_range .and. raw%scope == assembly_scope
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         if (is_range) then
            call take_range(input, shift, first, last, increment)
            n = (last - first)/max(1, increment)
            call raw%expect_members(input, n)
            call input%end_line()
            if (.not. allocated(input%error)) call members%append_all([(first + i*increment, i=0, n)])
         else
            do
               call take_field(input, field)
               ! A number in the assembly itself is that of a point of reference.
               is_left_out = is_left_out .or. (raw%scope == assembly_scope .and. field /= '' .and. &
                  verify(field, '0123456789') == 0)
               if (.not. is_left_out) call add_members(raw, input, 'there is no set', keyword == 'nset', field, &
                  members)
               call take_comma(input, is_there)
               if (is_at_line_end(input) .or. allocated(input%error)) exit
            end do
         end if
      end do
      ! Some programs write sets of their own with numbers below 1.
      if (members%n > 0) is_left_out = is_left_out .or. any(members%items() < 1 + shift)
   end subroutine take_set_lines

   !> Reads a range: its first number, its last one and an increment.
   pure subroutine take_range(input, shift, first, last, increment)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: shift !! by how much numbers of the instance are greater than in its text
      integer, intent(out) :: first !! the first number
      integer, intent(out) :: last !! the last number, or a bound of it
      integer, intent(out) :: increment !! the increment, 1 where it is absent
      logical :: is_there

      call take_tag(input, shift, first, 'the first number of a range')
      call take_comma(input, is_there)
      call take_tag(input, shift, last, 'the last number of a range')
      call take_comma(input, is_there)
      increment = 1
      if (.not. is_at_line_end(input)) call input%take_integer(increment, 'the increment of a range')
      call take_comma(input, is_there)
      if (first <= shift .or. last < first .or. increment < 1) call input%refuse( &
         'expected a range: two positive numbers, the second not the smaller one, and a positive increment')
   end subroutine take_range

   !> Index of the set that a field names, 0 if there is none: the set of this name in the present instance, or in the
   !> named one; otherwise that of the assembly; otherwise that of the only instance.
   pure integer function set_of_field(raw, field) result(group)
      type(raw_mesh_t), intent(in) :: raw !! contents of the file
      character(*), intent(in) :: field !! the name, perhaps with the name of an instance and a point before

      group = raw%find_group(raw%scope//field)
      if (group == 0) group = raw%find_group(field)
      if (group > 0) return
      associate (name => field(index(field, '.', back=.true.) + 1:))
         group = raw%find_group(assembly_scope//name)
         if (group == 0) group = raw%find_group(name)
         if (group == 0 .and. size(raw%instances) == 1) group = raw%find_group(scope_of(raw%instances(1))//name)
      end associate
   end function set_of_field

   !> Removes the prefix from the names of sets that only one instance has, and of sets of the assembly whose name no
   !> instance has; renames the sets of supports, loads and sections accordingly.
   pure subroutine name_instance_sets(raw)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      character(:), allocatable :: name
      integer :: group, i, n

      do group = 1, raw%n_groups
         associate (own => raw%groups(group))
            if (own%n_scope == 0) cycle
            name = own%name(own%n_scope + 1:)
            n = count([(raw%find_group(scope_of(raw%instances(i))//name) > 0, i=1, size(raw%instances))])
            if (own%name(:own%n_scope) == assembly_scope) n = n + 1
            if (n == 1 .and. raw%find_group(name) == 0) own%name = name
         end associate
      end do
      do i = 1, raw%model%n_conditions
         associate (load => raw%model%conditions(i)%load)
            load%set = final_name(load%set)
            load%region = final_name(load%region)
         end associate
      end do
      do i = 1, size(raw%model%sections)
         raw%model%sections(i)%material%region = final_name(raw%model%sections(i)%material%region)
      end do

   contains

      !> The name that a set of an instance gets in the whole mesh.
      pure function final_name(before) result(name)
         character(*), intent(in) :: before !! its name before
         character(:), allocatable :: name
         integer :: group

         name = before
         group = raw%find_group(before)
         if (group > 0) name = raw%groups(group)%name
      end function final_name

   end subroutine name_instance_sets

   !> Adds the members that a field names: a node or element by its number, or all members of a set.
   pure subroutine add_members(raw, input, refusal, of_nodes, field, members)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the field
      character(*), intent(in) :: refusal !! the message on a missing set, up to its name
      logical, intent(in) :: of_nodes !! whether the things are nodes rather than elements
      character(*), intent(in) :: field !! the field, perhaps with the name of an instance and a point before
      type(integer_list_t), intent(inout) :: members !! numbers of the things
      integer :: group, number
      logical :: is_number

      if (len(field) == 0) return
      call read_tag(raw, field, number, is_number)
      if (is_number) then
         call members%append(number)
         return
      end if
      group = set_of_field(raw, field)
      if (group == 0) then
         call input%refuse_line(refusal//" '"//field(index(field, '.', back=.true.) + 1:)//"' above")
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

   !> Reads a surface: each line has an element or a set, and a side of it; for a surface of nodes, nodes. A surface
   !> with anything else is left out.
   pure subroutine read_surface(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: field, type
      type(integer_list_t) :: members
      integer :: group, n, side
      logical :: is_there, of_nodes

      type = lower_case(parameter_of(line, 'type'))
      of_nodes = type == 'node'
      if (parameter_of(line, 'combine') /= '' .or. all(type /= [character(7) :: '', 'node', 'element'])) then
         call raw%add_note('a surface of other things than sides and nodes left out: '//line)
         return
      end if
      call get_set(raw, input, line, 'name', group)
      if (group == 0) call input%refuse_line('expected NAME= and a name')
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
            if (side == 0) call input%refuse("expected one of the sides S1 to S6, found '"//field//"'")
            call raw%groups(group)%side%append_all(spread(side, 1, members%n - n))
         end if
         call take_comma(input, is_there)
         call input%end_line()
      end do
      if (allocated(input%error)) return
      if (of_nodes) call raw%groups(group)%node%append_all(members%items())
      if (.not. of_nodes) call raw%groups(group)%cell%append_all(members%items())
   end subroutine read_surface

   !> Replaces element numbers in the sets by indices in the list of cells.
   pure subroutine resolve_elements(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file
      type(tag_map_t) :: map
      integer :: cell, group, i, n, n_dim, tag

      n_dim = raw%n_dim()
      call new_tag_map(map, raw%cell_tag%items())
      do group = 1, raw%n_groups
         do i = 1, raw%groups(group)%cell%n
            tag = raw%groups(group)%cell%item(i)
            cell = map%find(tag)
            ! Only elements of the body have sides, not lines, nor faces of solids.
            n = 0
            if (cell > 0) n = merge(n_sides(max(1, raw%cell_kind%item(cell))), 0, &
               cell_dimension(raw%cell_kind%item(cell)) == n_dim)
            if (cell == 0) then
               call input%refuse("the set '"//raw%groups(group)%name//"' names element "//to_text(tag)// &
                  ', which the file does not give', raw%groups(group)%place)
            else if (raw%groups(group)%side%item(i) > n) then
               call input%refuse("the surface '"//raw%groups(group)%name//"' names a side that element "// &
                  to_text(tag)//' has not', raw%groups(group)%place)
            end if
            if (allocated(input%error)) return
            raw%groups(group)%cell%item(i) = cell
         end do
      end do
   end subroutine resolve_elements

end module amontons_abaqus_lines
