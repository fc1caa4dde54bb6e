!> Meshes in Gmsh's MSH format, versions 2.2 and 4.1, text and binary.
module amontons_gmsh
   use amontons_gmsh_groups, only: gmsh_groups_t
   use amontons_gmsh_sections, only: read_elements_2, read_elements_4, read_entities_4, read_nodes_2, read_nodes_4
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_raw_mesh, only: raw_mesh_t
   use amontons_text, only: ends_word, to_text
   implicit none (type, external)
   private

   public :: read_gmsh

contains

   !> Reads a mesh section by section. Faults go to the input.
   pure subroutine read_gmsh(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, at its first section
      type(gmsh_groups_t) :: groups
      character(:), allocatable :: name, seen
      integer :: version

      version = 0
      seen = ' '
      do
         call input%skip_white()
         if (input%position > len(input%text) .or. allocated(input%error)) exit
         call take_section_name(input, name)
         if (version == 0) call check_first(input, name)
         select case (name)
         case ('MeshFormat', 'PhysicalNames', 'Entities', 'Nodes', 'ParametricNodes', 'Elements')
            if (index(seen, ' '//name//' ') > 0) call input%refuse('a second section $'//name)
            seen = seen//name//' '
            call read_section(raw, groups, input, name, version)
            call end_section(input, name)
         case ('PartitionedEntities')
            call input%refuse('a partitioned mesh; save it as one')
         case default
            call skip_section(input, name)
         end select
      end do
      if (raw%node_tag%n == 0) call input%refuse('the file has no section $Nodes with nodes in it')
      if (raw%cell_tag%n == 0) call input%refuse('the file has no section $Elements with elements in it')
      if (all(raw%cell_kind%items() < 0)) call input%refuse( &
         'no triangles or quadrilaterals: once there are physical groups, Gmsh saves only the surfaces in them')
      if (.not. allocated(input%error)) call groups%put(raw, input)
   end subroutine read_gmsh

   !> Refuses everything but comments before the format; older versions of it begin otherwise.
   pure subroutine check_first(input, name)
      type(input_file_t), intent(inout) :: input !! the file, behind the name
      character(*), intent(in) :: name !! name of a section

      if (name /= 'MeshFormat' .and. name /= 'Comments') call input%refuse( &
         'expected $MeshFormat before $'//name//'; save the mesh as version 2.2 or 4.1')
   end subroutine check_first

   !> Takes the name of a section.
   pure subroutine take_section_name(input, name)
      type(input_file_t), intent(inout) :: input !! the file, at the beginning of a line
      character(:), allocatable, intent(out) :: name !! the name, without its `$`
      integer, parameter :: longest_name = 80
      integer :: last

      last = input%position
      do while (.not. ends_word(input%text, last + 1) .and. last < input%position + longest_name)
         last = last + 1
      end do
      name = input%text(input%position + 1:last)
      if (input%text(input%position:input%position) /= '$') call input%refuse( &
         'expected a section such as $Nodes, found '//input%word())
      input%position = last + 1
   end subroutine take_section_name

   !> Moves behind the end of a section.
   pure subroutine end_section(input, name)
      type(input_file_t), intent(inout) :: input !! the file, behind the contents of the section
      character(*), intent(in) :: name !! name of the section
      integer :: behind

      if (allocated(input%error)) return
      call input%skip_white()
      behind = input%position + len('$End'//name)
      if (index(input%text(input%position:min(behind - 1, len(input%text))), '$End'//name) == 1 &
         .and. ends_word(input%text, behind)) then
         input%position = behind
      else
         call input%refuse('expected $End'//name//' after the numbers announced, found '//input%word())
      end if
   end subroutine end_section

   !> Moves behind the end of a section that does not matter here.
   pure subroutine skip_section(input, name)
      type(input_file_t), intent(inout) :: input !! the file, behind the name of the section
      character(*), intent(in) :: name !! name of the section
      integer :: at

      if (allocated(input%error)) return
      at = index(input%text(input%position:), new_line('a')//'$End'//name)
      if (at == 0) then
         call input%refuse('the section $'//name//' has no end $End'//name)
      else
         input%position = input%position + at
         call end_section(input, name)
      end if
   end subroutine skip_section

   !> Reads the contents of a section.
   pure subroutine read_section(raw, groups, input, name, version)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file, behind the name of the section
      character(*), intent(in) :: name !! name of the section
      integer, intent(inout) :: version !! 2 or 4

      call input%end_line()
      select case (name)
      case ('MeshFormat')
         call read_format(input, version)
         groups%has_entities = version == 4
      case ('PhysicalNames')
         call read_names(raw, groups, input)
      case ('Entities')
         call read_entities_4(groups, input)
      case ('Nodes', 'ParametricNodes')
         if (version == 4) call read_nodes_4(raw, input)
         if (version == 2) call read_nodes_2(raw, input, name == 'ParametricNodes')
      case default
         if (version == 4) call read_elements_4(raw, groups, input)
         if (version == 2) call read_elements_2(raw, groups, input)
      end select
   end subroutine read_section

   !> Reads the version, whether the file is binary, and in which order the bytes of a number stand.
   pure subroutine read_format(input, version)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: version !! 2 or 4
      integer, parameter :: swapped_one = 2**24
      real(dp) :: full_version
      integer :: binary, n_bytes, one, place

      call input%skip_white()
      call input%take_real(full_version, 'the version of the format')
      version = 0
      if (nint(10*full_version) == 22) version = 2
      if (nint(10*full_version) == 41) version = 4
      if (version == 0) call input%refuse('unsupported MSH version '//to_text(full_version)// &
         ' (supported: 2.2, 4.1)')
      call input%take_numeral(binary, 'the type of the file')
      call input%take_numeral(n_bytes, 'the number of bytes of a number')
      if (binary < 0 .or. binary > 1) call input%refuse('the type of the file must be 0 (text) or 1 (binary)')
      if (n_bytes /= 8) call input%refuse('a number of the file must have 8 bytes')
      call input%end_line()
      input%is_binary = binary == 1
      if (binary /= 1 .or. allocated(input%error)) return
      place = input%position
      call input%take_integer(one, 'the number 1')
      input%is_swapped = one == swapped_one
      if (one /= 1 .and. one /= swapped_one) call input%refuse('expected the number 1 in four bytes', place)
   end subroutine read_format

   !> Reads the names of the physical groups.
   pure subroutine read_names(raw, groups, input)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(gmsh_groups_t), intent(inout) :: groups !! the groups
      type(input_file_t), intent(inout) :: input !! the file, at the number of names
      type(tag_map_t) :: map
      integer :: dimension, i, n

      call input%take_count(n, 'names')
      do i = 1, n
         call read_name(raw, groups, input)
         if (allocated(input%error)) return
      end do
      do dimension = 0, 2
         call new_tag_map(map, groups%of_dimension(dimension)%named_tag%items())
         if (map%repeated() > 0) call input%refuse('a physical group is named twice', input%position - 1)
      end do
   end subroutine read_names

   !> Reads the name of a physical group.
   pure subroutine read_name(raw, groups, input)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(gmsh_groups_t), intent(inout) :: groups !! the groups
      type(input_file_t), intent(inout) :: input !! the file
      character(:), allocatable :: name
      integer :: dimension, group, place, tag

      call input%skip_white()
      call input%take_numeral(dimension, 'the dimension of a physical group')
      call input%take_numeral(tag, 'the number of a physical group')
      if (dimension < 0 .or. dimension > 3 .or. tag < 1) call input%refuse( &
         'expected the dimension of a physical group, 0 to 3, and its number, which is positive')
      place = input%position
      call input%take_line(name)
      if (len(name) < 2) then
         call input%refuse('expected the name of a physical group in double quotes', place)
      else if (name(1:1)//name(len(name):) /= '""') then
         call input%refuse('expected the name of a physical group in double quotes', place)
      end if
      if (allocated(input%error) .or. dimension == 3) return
      name = trim(adjustl(name(2:len(name) - 1)))
      if (len(name) == 0) return
      call raw%get_group(input, name, group)
      call groups%of_dimension(dimension)%named_tag%append(tag)
      call groups%of_dimension(dimension)%named_group%append(group)
   end subroutine read_name

end module amontons_gmsh
