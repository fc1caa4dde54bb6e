!> Meshes in Gmsh's MSH format, versions 2.2, 4.0 and 4.1, text and binary: types of elements and which of them are
!> supported; physical groups with their cells and names; entities, nodes and elements.
module amontons_gmsh
   use amontons_element, only: max_nodes, quad4, quad8, quad9, tri3, tri6
   use amontons_file_model, only: line2, line3, n_cell_nodes, no_cell, point1, raw_mesh_t
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t, new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_text, only: counted, ends_word, to_text
   implicit none (type, external)
   private

   public :: read_gmsh

   !> Versions of the format, times ten.
   integer, parameter :: msh_22 = 22, msh_40 = 40, msh_41 = 41
   !> Kind of cell for each of Gmsh's first element types; `no_cell` for those that are not supported.
   integer, parameter :: kind_of_type(*) = [line2, tri3, quad4, no_cell, no_cell, no_cell, no_cell, line3, tri6, &
      quad9, no_cell, no_cell, no_cell, no_cell, point1, quad8]

   !> The physical groups of one dimension.
   type :: dimension_t
      type(integer_list_t) :: named_tag !! number of each physical group that has a name, positive
      type(integer_list_t) :: named_group !! its set in the raw mesh; a name without members is still a set
      type(integer_list_t) :: entity !! numbers of entities, not negative
      type(integer_list_t) :: entity_tag !! number of a physical group that each belongs to
      type(integer_list_t) :: run_owner !! what a run of cells belongs to: an entity or a physical group
      type(integer_list_t) :: run_first !! first cell of the run
      type(integer_list_t) :: run_last !! last cell of the run
   end type dimension_t

   !> The physical groups of a file by dimension: points, curves, surfaces.
   type :: gmsh_groups_t
      logical :: has_entities = .false. !! whether runs belong to entities, and those to groups
      type(dimension_t) :: of_dimension(0:2) !! the groups of each dimension
   end type gmsh_groups_t

   !> Smallest number of bytes for a number of version 4.1: in text a digit and a blank, in a binary file more.
   integer, parameter :: least_bytes = 2
   !> Largest number of reals of a node: three coordinates and three parameters.
   integer, parameter :: most_numbers = 6

   !> Smallest number of bytes for a node in a text of version 2.2: `1 0 0 0` and the end of the line.
   integer, parameter :: least_node_text = 8
   !> Number of bytes of a node in a binary file of version 2.2: an integer and three reals.
   integer, parameter :: least_node_bytes = 28
   !> Smallest number of bytes for an element of version 2.2: in text `1 15 0 1` and the end of the line; in binary two
   !> integers.
   integer, parameter :: least_element = 8
   !> Largest number of tags of an element; physical group, entity and partitions need a few.
   integer, parameter :: most_tags = 1000

contains

   !> Records that consecutive cells belong to an entity or a group.
   pure subroutine add_run(groups, owner, first, last)
      type(dimension_t), intent(inout) :: groups !! the groups of the dimension of the cells
      integer, intent(in) :: owner !! number of the entity or of the physical group
      integer, intent(in) :: first !! first of the cells
      integer, intent(in) :: last !! last of the cells

      associate (n => groups%run_last%n)
         if (n > 0) then
            if (groups%run_last%item(n) == first - 1 .and. groups%run_owner%item(n) == owner) then
               groups%run_last%item(n) = last
               return
            end if
         end if
      end associate
      call groups%run_owner%append(owner)
      call groups%run_first%append(first)
      call groups%run_last%append(last)
   end subroutine add_run

   !> Makes named sets of a raw mesh from the physical groups. If there are physical surfaces, the body consists of
   !> their elements, and all others are removed.
   pure subroutine add_sets(groups, raw, input)
      type(gmsh_groups_t), intent(in) :: groups !! the groups
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh, its cells complete
      type(input_file_t), intent(inout) :: input !! the file
      logical, allocatable :: is_kept(:)
      logical :: has_surfaces
      integer :: dimension, n_dropped

      is_kept = raw%cell_kind%items() < 0
      if (.not. groups%has_entities .and. raw%n_groups > 0) then
         if (all([(groups%of_dimension(dimension)%run_owner%n == 0, dimension=0, 2)])) call input%refuse( &
            'no element belongs to any of the named physical groups, as version 2.2 leaves it with Mesh.SaveAll: '// &
            'save without that, or as version 4.1')
      end if
      do dimension = 0, 2
         call add_sets_of_dimension(groups%of_dimension(dimension), groups%has_entities, raw, input, is_kept, &
            has_surfaces)
      end do
      n_dropped = count(.not. is_kept)
      if (.not. has_surfaces .or. n_dropped == 0) return
      where (.not. is_kept) raw%cell_kind%item(:raw%cell_kind%n) = no_cell
      call raw%add_note(counted(n_dropped, 'element')//' outside the physical surfaces left out')
   end subroutine add_sets

   !> Makes named sets of a raw mesh from the physical groups of one dimension.
   pure subroutine add_sets_of_dimension(groups, has_entities, raw, input, is_kept, has_any)
      type(dimension_t), intent(in) :: groups !! the groups
      logical, intent(in) :: has_entities !! whether runs belong to entities, and those to groups
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      logical, intent(inout) :: is_kept(:) !! becomes true for the cells in groups
      logical, intent(out) :: has_any !! whether any cell belongs to a group; false after a fault
      type(integer_list_t) :: tag, run
      type(tag_map_t) :: entities, map, names
      integer :: cell, first, group, i, place, named

      has_any = .false.
      ! The physical groups, and the runs that belong to them.
      if (has_entities) then
         call new_tag_map(entities, groups%entity%items())
         do i = 1, groups%run_owner%n
            do place = entities%first(groups%run_owner%item(i)), size(entities%tag)
               if (entities%tag(place) /= groups%run_owner%item(i)) exit
               call tag%append(groups%entity_tag%item(entities%item(place)))
               call run%append(i)
               call raw%expect_members(input, 1)
               if (allocated(input%error)) return
            end do
         end do
      else
         tag = groups%run_owner
         call run%append_all([(i, i=1, tag%n)])
      end if
      call new_tag_map(map, tag%items())
      call new_tag_map(names, groups%named_tag%items())
      has_any = tag%n > 0
      first = 0
      do place = 1, tag%n
         if (map%tag(place) /= first) then
            first = map%tag(place)
            named = names%find(first)
            if (named > 0) group = groups%named_group%item(named)
            if (named == 0) call raw%get_group(input, to_text(first), group)
         end if
         i = run%item(map%item(place))
         call raw%expect_members(input, groups%run_last%item(i) - groups%run_first%item(i) + 1)
         if (allocated(input%error)) return
         do cell = groups%run_first%item(i), groups%run_last%item(i)
            call raw%groups(group)%cell%append(cell)
            call raw%groups(group)%side%append(0)
            is_kept(cell) = .true.
         end do
      end do
   end subroutine add_sets_of_dimension

   !> Reads the type of an element; refuses types that are not supported.
   pure subroutine take_cell_kind(input, kind)
      type(input_file_t), intent(inout) :: input !! the file, at the type
      integer, intent(out) :: kind !! kind of the cell, `no_cell` where there is a fault
      character(:), allocatable :: solid
      integer :: type, place

      place = input%position
      call input%take_integer(type, 'the type of an element')
      kind = no_cell
      if (type >= 1 .and. type <= size(kind_of_type)) kind = kind_of_type(type)
      if (kind /= no_cell) return
      select case (type)
      case (4:7, 11:14, 17:19, 29:33)
         solid = 'solid element'
         if (any(type == [4, 11, 29, 30, 31])) solid = 'tetrahedron'
         if (any(type == [5, 12, 17])) solid = 'hexahedron'
         if (any(type == [6, 13, 18])) solid = 'prism'
         if (any(type == [7, 14, 19])) solid = 'pyramid'
         call input%refuse('3-D mesh: found a '//solid//' (Gmsh type '//to_text(type)// &
            '), expected plane elements', place)
      case (20:28, 36:40)
         call input%refuse('elements of third or higher order (Gmsh type '//to_text(type)//') are not supported; '// &
            'mesh with -order 1 or 2', place)
      case default
         call input%refuse('elements of Gmsh type '//to_text(type)//' are not supported: expected points (15), '// &
            'lines (1, 8), triangles (2, 9), quadrilaterals (3, 10, 16)', place)
      end select
   end subroutine take_cell_kind

   !> Dimension of a kind of cell: 0 for points, 1 for lines, 2 for elements.
   elemental integer function dimension_of(kind)
      integer, intent(in) :: kind !! the kind

      dimension_of = merge(0, 1, kind == point1)
      if (kind > 0) dimension_of = 2
   end function dimension_of

   !> Reads the section of the entities, of which only the physical groups are used.
   pure subroutine read_entities_4(groups, input, version)
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file, at the numbers of entities
      integer, intent(in) :: version !! `msh_40` or `msh_41`
      integer :: n(0:3), dimension, entity, group, i, k, n_more
      real(dp) :: x

      call input%start_record()
      do dimension = 0, 3
         call input%take_size(n(dimension), 'the number of entities of dimension '//to_text(dimension))
         call input%check_count(n(dimension), least_bytes, 'entities')
      end do
      call input%end_record()
      do dimension = 0, 3
         do k = 1, n(dimension)
            ! Its number, its place or box, its physical groups, and what it is bounded by.
            call input%start_record()
            call input%take_integer(entity, 'the number of an entity')
            if (entity < 0) call input%refuse('the number of an entity is negative')
            do i = 1, merge(3, 6, dimension == 0 .and. version == msh_41)
               call input%take_real(x, 'a coordinate of an entity')
            end do
            call input%take_size(n_more, 'the number of physical groups of an entity')
            call input%check_count(n_more, least_bytes, 'physical groups')
            do i = 1, n_more
               call input%take_integer(group, 'a physical group')
               if (allocated(input%error)) return
               if (dimension == 3 .or. group == 0) cycle
               call groups%of_dimension(min(dimension, 2))%entity%append(entity)
               call groups%of_dimension(min(dimension, 2))%entity_tag%append(abs(group))
            end do
            if (dimension > 0) then
               call input%take_size(n_more, 'the number of entities that bound an entity')
               call input%check_count(n_more, least_bytes, 'bounding entities')
               do i = 1, n_more
                  call input%take_integer(entity, 'a bounding entity')
                  if (allocated(input%error)) return
               end do
            end if
            call input%end_record()
            if (allocated(input%error)) return
         end do
      end do
   end subroutine read_entities_4

   !> Reads the section of the nodes: blocks of numbers, followed by coordinates and parameters on the entity. In
   !> version 4.0 each number is followed by the coordinates of its node.
   pure subroutine read_nodes_4(raw, input, version)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file, at the number of blocks
      integer, intent(in) :: version !! `msh_40` or `msh_41`
      integer, allocatable :: tags(:), places(:)
      integer :: block, dimension, entity, i, has_parameters, n, n_blocks, n_left, n_numbers, node
      real(dp) :: x(most_numbers)

      call take_section_header(input, version, n_blocks, n_left, 'nodes')
      if (allocated(input%error)) return
      do block = 1, n_blocks
         call take_entity(input, version, dimension, entity)
         call input%take_integer(has_parameters, 'whether nodes have parameters, 0 or 1')
         if (dimension < 0 .or. dimension > 3 .or. has_parameters < 0 .or. has_parameters > 1) call input%refuse( &
            'expected a dimension from 0 to 3 and whether nodes have parameters, 0 or 1')
         call take_block_size(input, n, n_left, 'nodes')
         if (allocated(input%error)) return
         n_numbers = 3 + merge(dimension, 0, has_parameters == 1)
         tags = spread(0, 1, n)
         places = tags
         do node = 1, merge(n, 0, version == msh_41)
            call input%start_record()
            places(node) = input%position
            call input%take_size(tags(node), 'the number of a node')
         end do
         do node = 1, n
            call input%start_record()
            if (version == msh_40) then
               places(node) = input%position
               call take_tag(input, version, tags(node), 'the number of a node')
            end if
            do i = 1, n_numbers
               call input%take_real(x(i), 'a coordinate or parameter of a node')
            end do
            call input%end_record()
            if (allocated(input%error)) return
            call raw%add_node(tags(node), places(node), x(:3))
         end do
      end do
      if (n_left > 0) call input%refuse('the blocks hold '//to_text(n_left)//' fewer nodes than announced', &
         input%position - 1)
   end subroutine read_nodes_4

   !> Reads dimension and number of the entity of a block; version 4.0 has them in the other order.
   pure subroutine take_entity(input, version, dimension, entity)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: version !! `msh_40` or `msh_41`
      integer, intent(out) :: dimension !! dimension of the entity
      integer, intent(out) :: entity !! number of the entity

      call input%start_record()
      if (version == msh_40) call input%take_integer(entity, 'the number of an entity')
      call input%take_integer(dimension, 'the dimension of an entity')
      if (version == msh_41) call input%take_integer(entity, 'the number of an entity')
   end subroutine take_entity

   !> Reads the header of a section: the numbers of blocks and of items and, except in version 4.0, the smallest and the
   !> largest number of an item.
   pure subroutine take_section_header(input, version, n_blocks, n, things)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: version !! `msh_40` or `msh_41`
      integer, intent(out) :: n_blocks !! number of blocks
      integer, intent(out) :: n !! number of things
      character(*), intent(in) :: things !! noun for the items, for messages
      integer :: least, greatest

      call input%start_record()
      call input%take_size(n_blocks, 'the number of blocks of '//things)
      call input%take_size(n, 'the number of '//things)
      if (version == msh_41) then
         call input%take_size(least, 'the least number of all '//things)
         call input%take_size(greatest, 'the greatest number of all '//things)
      end if
      call input%check_count(n_blocks, 4*least_bytes, 'blocks of '//things)
      call input%check_count(n, 2*least_bytes, things)
      call input%end_record()
   end subroutine take_section_header

   !> Reads the number of items in a block, the last entry of its header.
   pure subroutine take_block_size(input, n, n_left, things)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: n !! number of things in the block
      integer, intent(inout) :: n_left !! number of things that the section still has to hold
      character(*), intent(in) :: things !! noun for the items, for messages

      call input%take_size(n, 'the number of '//things//' of a block')
      if (n > n_left) call input%refuse('the blocks hold more '//things//' than the section announced')
      call input%end_record()
      if (allocated(input%error)) n = 0
      n_left = n_left - n
   end subroutine take_block_size

   !> Reads the number of a node or element.
   pure subroutine take_tag(input, version, tag, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: version !! `msh_40` or `msh_41`
      integer, intent(out) :: tag !! the number
      character(*), intent(in) :: what !! meaning of the number, for the message

      if (version == msh_40) call input%take_integer(tag, what)
      if (version == msh_41) call input%take_size(tag, what)
   end subroutine take_tag

   !> Reads the section of the elements: blocks of elements of one type on one entity.
   pure subroutine read_elements_4(raw, groups, input, version)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file, at the number of blocks
      integer, intent(in) :: version !! `msh_40` or `msh_41`
      integer :: block, dimension, element, entity, first, i, kind, n, n_blocks, n_left, nodes(max_nodes), place, tag

      call take_section_header(input, version, n_blocks, n_left, 'elements')
      if (allocated(input%error)) return
      do block = 1, n_blocks
         call take_entity(input, version, dimension, entity)
         call take_cell_kind(input, kind)
         if (dimension /= dimension_of(kind)) call input%refuse('elements on an entity of dimension '// &
            to_text(dimension)//', which is not their own')
         call take_block_size(input, n, n_left, 'elements')
         first = raw%cell_tag%n + 1
         do element = 1, n
            call input%start_record()
            place = input%position
            call take_tag(input, version, tag, 'the number of an element')
            do i = 1, n_cell_nodes(kind)
               call take_tag(input, version, nodes(i), 'a node of an element')
            end do
            call input%end_record()
            if (allocated(input%error)) return
            call raw%add_cell(kind, tag, place, nodes(:n_cell_nodes(kind)))
         end do
         if (allocated(input%error)) return
         if (n > 0) call add_run(groups%of_dimension(dimension), entity, first, raw%cell_tag%n)
      end do
      if (n_left > 0) call input%refuse('the blocks hold '//to_text(n_left)//' fewer elements than announced', &
         input%position - 1)
   end subroutine read_elements_4

   !> Reads the section of the nodes in version 2.2.
   pure subroutine read_nodes_2(raw, input, is_parametric)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file, at the number of nodes
      logical, intent(in) :: is_parametric !! whether entity and parameters follow the coordinates
      integer :: dimension, entity, i, n, node, tag, place
      real(dp) :: parameter, x(3)

      call input%take_count(n, 'nodes')
      call input%check_count(n, merge(least_node_bytes, least_node_text, input%is_binary), 'nodes')
      if (allocated(input%error)) return
      do node = 1, n
         call input%start_record()
         place = input%position
         call input%take_integer(tag, 'the number of a node')
         do i = 1, 3
            call input%take_real(x(i), 'a coordinate')
         end do
         if (is_parametric) then
            call input%take_integer(dimension, "the dimension of a node's entity")
            call input%take_integer(entity, "the number of a node's entity")
            ! Nodes in volumes have no parameters here.
            if (dimension > 2) dimension = 0
            do i = 1, dimension
               call input%take_real(parameter, 'a parameter of a node')
            end do
         end if
         call input%end_record()
         if (allocated(input%error)) return
         call raw%add_node(tag, place, x)
      end do
   end subroutine read_nodes_2

   !> Reads the section of the elements in version 2.2.
   pure subroutine read_elements_2(raw, groups, input)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file, at the number of elements
      integer :: at, cell, element, group, i, kind, n, n_alike, n_tags, nodes(max_nodes), place, tag, &
         tag_of_element

      call input%take_count(n, 'elements')
      call input%check_count(n, least_element, 'elements')
      n_alike = 0
      do element = 1, n
         if (allocated(input%error)) return
         call input%start_record()
         place = input%position
         if (.not. input%is_binary) call input%take_integer(tag, 'the number of an element')
         ! The type and the number of tags precede all elements of a kind in a binary file, each of them in a text.
         if (n_alike == 0) then
            call take_cell_kind(input, kind)
            n_alike = 1
            at = input%position
            if (input%is_binary) call input%take_integer(n_alike, 'the number of elements of a type')
            if (n_alike < 1 .or. n_alike > n - element + 1) call input%refuse( &
               'the elements of this type are more than those announced, or none', at)
            at = input%position
            call input%take_integer(n_tags, 'the number of tags of an element')
            if (n_tags < 0 .or. n_tags > most_tags) call input%refuse( &
               'the number of tags of an element is out of range', at)
            if (allocated(input%error)) return
         end if
         n_alike = n_alike - 1
         if (input%is_binary) call input%take_integer(tag, 'the number of an element')
         group = 0
         do i = 1, n_tags
            call input%take_integer(tag_of_element, 'a tag of an element')
            ! The first is its physical group; reversed ones have a minus.
            if (i == 1) group = abs(tag_of_element)
         end do
         associate (own => nodes(:n_cell_nodes(kind)))
            do i = 1, size(own)
               call input%take_integer(own(i), 'a node of an element')
            end do
            if (allocated(input%error)) return
            cell = raw%cell_tag%n
            if (.not. is_twin(raw, cell, kind, own)) then
               cell = cell + 1
               call raw%add_cell(kind, tag, place, own)
            end if
         end associate
         if (group > 0) call add_run(groups%of_dimension(dimension_of(kind)), group, cell, cell)
         call input%end_record()
      end do
   end subroutine read_elements_2

   !> Whether an element repeats the one before: the format lists it once for every physical group it belongs to.
   pure logical function is_twin(raw, cell, kind, nodes)
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      integer, intent(in) :: cell !! the element before, 0 for none
      integer, intent(in) :: kind !! kind of the element
      integer, intent(in) :: nodes(:) !! its nodes
      integer :: i

      is_twin = .false.
      if (cell == 0) return
      if (raw%cell_kind%item(cell) /= kind) return
      associate (twin => raw%node%item(raw%cell_start%item(cell):raw%cell_start%item(cell) + size(nodes) - 1))
         do i = 1, size(twin)
            if (all(nodes /= twin(i))) return
         end do
      end associate
      is_twin = .true.
   end function is_twin

   !> Reads a mesh section by section. Faults are recorded in the input.
   pure subroutine read_gmsh(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, at its first section
      type(gmsh_groups_t) :: groups
      integer, parameter :: longest_name = 80
      character(:), allocatable :: name, seen
      integer :: at, last, version

      version = 0
      seen = ' '
      do
         call input%skip_white()
         if (input%position > len(input%text) .or. allocated(input%error)) exit
         last = input%position
         do while (.not. ends_word(input%text, last + 1) .and. last < input%position + longest_name)
            last = last + 1
         end do
         name = input%text(input%position + 1:last)
         if (input%text(input%position:input%position) /= '$') call input%refuse( &
            'expected a section such as $Nodes, found '//input%word())
         input%position = last + 1
         ! Older versions of the format begin otherwise.
         if (version == 0 .and. name /= 'MeshFormat' .and. name /= 'Comments') call input%refuse( &
            'expected $MeshFormat before $'//name//'; save the mesh as version 2.2 or 4.1')
         select case (name)
         case ('MeshFormat', 'PhysicalNames', 'Entities', 'Nodes', 'ParametricNodes', 'Elements')
            if (index(seen, ' '//name//' ') > 0) call input%refuse('a second section $'//name)
            seen = seen//name//' '
            call input%end_line()
            select case (name)
            case ('MeshFormat')
               call read_format(input, version)
               groups%has_entities = version /= msh_22
            case ('PhysicalNames')
               call read_names(raw, groups, input)
            case ('Entities')
               call read_entities_4(groups, input, version)
            case ('Nodes', 'ParametricNodes')
               if (version /= msh_22) call read_nodes_4(raw, input, version)
               if (version == msh_22) call read_nodes_2(raw, input, name == 'ParametricNodes')
            case default
               if (version /= msh_22) call read_elements_4(raw, groups, input, version)
               if (version == msh_22) call read_elements_2(raw, groups, input)
            end select
            call end_section(input, name)
         case ('PartitionedEntities')
            call input%refuse('a partitioned mesh; save it as one')
         case default
            ! Its contents do not matter here.
            at = index(input%text(input%position:), new_line('a')//'$End'//name)
            if (at == 0) call input%refuse('the section $'//name//' has no end $End'//name)
            input%position = input%position + at
            call end_section(input, name)
         end select
      end do
      if (raw%node_tag%n == 0) call input%refuse('the file has no section $Nodes with nodes in it')
      if (raw%cell_tag%n == 0) call input%refuse('the file has no section $Elements with elements in it')
      if (all(raw%cell_kind%items() < 0)) call input%refuse( &
         'no triangles or quadrilaterals: once there are physical groups, Gmsh saves only the surfaces in them')
      if (.not. allocated(input%error)) call add_sets(groups, raw, input)
   end subroutine read_gmsh

   !> Skips the end marker of a section.
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

   !> Reads the version, whether the file is binary, and its byte order.
   pure subroutine read_format(input, version)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: version !! `msh_22`, `msh_40` or `msh_41`
      integer, parameter :: swapped_one = 2**24
      real(dp) :: full_version
      integer :: binary, n_bytes, one, place

      call input%skip_white()
      call input%take_real(full_version, 'the version of the format')
      version = nint(10*full_version)
      if (all(version /= [msh_22, msh_40, msh_41])) call input%refuse('unsupported MSH version '// &
         to_text(full_version)//' (supported: 2.2, 4.0, 4.1)')
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
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(gmsh_groups_t), intent(inout) :: groups !! the groups
      type(input_file_t), intent(inout) :: input !! the file, at the number of names
      type(tag_map_t) :: map
      character(:), allocatable :: name
      integer :: dimension, group, i, n, place, tag

      call input%take_count(n, 'names')
      do i = 1, n
         call input%skip_white()
         call input%take_numeral(dimension, 'the dimension of a physical group')
         call input%take_numeral(tag, 'the number of a physical group')
         if (dimension < 0 .or. dimension > 3 .or. tag < 1) call input%refuse( &
            'expected the dimension of a physical group, 0 to 3, and its number, which is positive')
         place = input%position
         call input%take_line(name)
         if (len(name) < 2) name = '  '
         if (name(1:1)//name(len(name):) /= '""') call input%refuse( &
            'expected the name of a physical group in double quotes', place)
         if (allocated(input%error)) return
         name = trim(adjustl(name(2:len(name) - 1)))
         if (dimension == 3 .or. len(name) == 0) cycle
         call raw%get_group(input, name, group)
         call groups%of_dimension(dimension)%named_tag%append(tag)
         call groups%of_dimension(dimension)%named_group%append(group)
         if (allocated(input%error)) return
      end do
      do dimension = 0, 2
         call new_tag_map(map, groups%of_dimension(dimension)%named_tag%items())
         if (map%repeated() > 0) call input%refuse('a physical group is named twice', input%position - 1)
      end do
   end subroutine read_names

end module amontons_gmsh
