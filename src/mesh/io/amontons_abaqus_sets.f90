!> Sets of nodes and elements and surfaces in the input format of Abaqus and CalculiX.
module amontons_abaqus_sets
   use amontons_abaqus_line, only: find_parameter, is_at_line_end, next_data_line, take_comma, take_field
   use amontons_element, only: n_corners
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t, new_tag_map, tag_map_t
   use amontons_raw_mesh, only: raw_group_t, raw_mesh_t
   use amontons_text, only: lower_case, read_integer, to_text
   implicit none (type, external)
   private

   public :: abaqus_scope_t, get_set, named_group, read_set, read_surface, resolve_elements

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

   !> Reads a set of nodes or elements.
   pure subroutine read_set(raw, input, scope, line, keyword)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      type(abaqus_scope_t), intent(in) :: scope !! where the file is
      character(*), intent(in) :: line !! the keyword line
      character(*), intent(in) :: keyword !! 'nset' or 'elset', which is also the parameter that names the set
      character(:), allocatable :: value
      type(integer_list_t) :: members
      integer :: group
      logical :: has_elements, is_in_instance, is_range

      call find_parameter(line, 'elset', value, has_elements)
      call find_parameter(line, 'instance', value, is_in_instance)
      call find_parameter(line, 'generate', value, is_range)
      if (keyword == 'nset' .and. has_elements) then
         call raw%add_note('a set of the nodes of an element set left out: '//line)
      else if (scope%in_assembly .and. .not. is_in_instance) then
         call raw%add_note('a set outside the instance left out: '//line)
      else
         call get_set(raw, input, scope, line, keyword, group)
         if (group == 0) call input%refuse('expected '//keyword//'= and a name', input%position - 1)
         if (is_range) call take_ranges(raw, input, members)
         if (.not. is_range) call take_members(raw, input, keyword == 'nset', members)
         if (group > 0) call put(raw%groups(group), keyword == 'nset', members%items(), spread(0, 1, members%n))
      end if
   end subroutine read_set

   !> Puts nodes, or elements and sides, into a set.
   pure subroutine put(group, of_nodes, members, sides)
      type(raw_group_t), intent(inout) :: group !! the set
      logical, intent(in) :: of_nodes !! whether the members are nodes rather than elements
      integer, intent(in) :: members(:) !! their numbers in the file
      integer, intent(in) :: sides(:) !! side of each element, 0 for the element itself

      if (of_nodes) then
         call group%node%append_all(members)
      else
         call group%cell%append_all(members)
         call group%side%append_all(sides)
      end if
   end subroutine put

   !> Takes ranges: first number, last number, and an increment that is 1 where it is absent.
   pure subroutine take_ranges(raw, input, members)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file
      type(integer_list_t), intent(inout) :: members !! the numbers in the ranges
      integer :: first, i, increment, last, n
      logical :: is_there

      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
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
         if (allocated(input%error)) exit
         call members%append_all([(first + i*increment, i=0, n)])
      end do
   end subroutine take_ranges

   !> Takes the members of a set: numbers and names of sets above.
   pure subroutine take_members(raw, input, of_nodes, members)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file
      logical, intent(in) :: of_nodes !! whether the members are nodes rather than elements
      type(integer_list_t), intent(inout) :: members !! their numbers
      character(:), allocatable :: field
      logical :: is_there

      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         do
            call take_field(input, field)
            call add_members(raw, input, of_nodes, field, members)
            call take_comma(input, is_there)
            if (is_at_line_end(input) .or. allocated(input%error)) exit
         end do
      end do
   end subroutine take_members

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
   pure subroutine add_members(raw, input, of_nodes, field, members)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file
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
         call input%refuse("there is no set '"//field(index(field, '.', back=.true.) + 1:)//"' above")
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

   !> Reads a surface: sides of elements, or nodes. One that names anything else is left out.
   pure subroutine read_surface(raw, input, scope, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      type(abaqus_scope_t), intent(in) :: scope !! where the file is
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: type, value
      type(integer_list_t) :: members, sides
      integer :: group
      logical :: is_combined, is_typed, of_nodes

      call find_parameter(line, 'type', type, is_typed)
      call find_parameter(line, 'combine', value, is_combined)
      of_nodes = lower_case(type) == 'node'
      if (is_combined .or. (is_typed .and. .not. of_nodes .and. lower_case(type) /= 'element')) then
         call raw%add_note('a surface of other things than sides and nodes left out: '//line)
         return
      end if
      call get_set(raw, input, scope, line, 'name', group)
      if (group == 0) call input%refuse('expected NAME= and a name', input%position - 1)
      call take_sides(raw, input, of_nodes, members, sides)
      if (allocated(input%error)) return
      call put(raw%groups(group), of_nodes, members%items(), sides%items())
   end subroutine read_surface

   !> Takes the lines of a surface: an element, or a set, and a side of it; of a surface of nodes, nodes.
   pure subroutine take_sides(raw, input, of_nodes, members, sides)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file
      logical, intent(in) :: of_nodes !! whether the surface is one of nodes
      type(integer_list_t), intent(inout) :: members !! numbers of the elements or nodes
      type(integer_list_t), intent(inout) :: sides !! side of each element, 0 for nodes
      character(:), allocatable :: field
      integer :: side
      logical :: is_there

      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call take_field(input, field)
         call add_members(raw, input, of_nodes, field, members)
         call take_comma(input, is_there)
         call take_field(input, field)
         side = 0
         if (.not. of_nodes) then
            side = findloc(side_names, lower_case(field), dim=1)
            if (side == 0) call input%refuse("expected one of the sides S1 to S4, found '"//field//"'")
         end if
         call sides%append_all(spread(side, 1, members%n - sides%n))
         call take_comma(input, is_there)
         call input%end_line()
      end do
   end subroutine take_sides

   !> Replaces the numbers of elements in the sets by places in the list of cells.
   pure subroutine resolve_elements(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file
      type(tag_map_t) :: map
      integer :: cell, group, i, tag

      call new_tag_map(map, raw%cell_tag%items())
      do group = 1, raw%n_groups
         do i = 1, raw%groups(group)%cell%n
            tag = raw%groups(group)%cell%item(i)
            cell = map%find(tag)
            if (cell == 0) then
               call input%refuse("the set '"//raw%groups(group)%name//"' names element "//to_text(tag)// &
                  ', which the file does not give', raw%groups(group)%place)
            else if (raw%groups(group)%side%item(i) > n_sides(raw%cell_kind%item(cell))) then
               call input%refuse("the surface '"//raw%groups(group)%name//"' names a side that element "// &
                  to_text(tag)//' has not', raw%groups(group)%place)
            end if
            if (allocated(input%error)) return
            raw%groups(group)%cell%item(i) = cell
         end do
      end do
   end subroutine resolve_elements

   !> Number of sides of a kind of cell, none for lines.
   elemental integer function n_sides(kind)
      integer, intent(in) :: kind !! the kind

      n_sides = 0
      if (kind > 0) n_sides = n_corners(kind)
   end function n_sides

end module amontons_abaqus_sets
