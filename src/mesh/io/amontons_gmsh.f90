!> Meshes in Gmsh's MSH format, versions 2.2, 4.0 and 4.1, text and binary: types of elements and which of them are
!> supported; physical groups with their cells and names; entities, nodes and elements.
module amontons_gmsh
   use amontons_element, only: hex20, hex8, max_nodes, quad4, quad8, quad9, tet10, tet4, tri3, tri6
   use amontons_file_model, only: cell_dimension, line2, line3, n_cell_nodes, no_cell, point1, raw_mesh_t
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t
   use amontons_kinds, only: dp
   use amontons_text, only: counted, ends_word, to_text
   implicit none (type, external)
   private

   public :: read_gmsh

   !> Versions of the format, times ten.
   integer, parameter :: msh_22 = 22, msh_40 = 40, msh_41 = 41
   !> Kind of cell for each of Gmsh's first element types; `no_cell` for those that are not supported.
   integer, parameter :: kind_of_type(*) = [line2, tri3, quad4, tet4, hex8, no_cell, no_cell, line3, tri6, quad9, &
      tet10, no_cell, no_cell, no_cell, point1, quad8, hex20]
   !> Places of the nodes of quadratic solids in Gmsh's order.
   integer, parameter :: order_tet10(*) = [1, 2, 3, 4, 5, 6, 7, 8, 10, 9], order_hex20(*) = [1, 2, 3, 4, 5, 6, 7, 8, &
      9, 12, 14, 10, 17, 19, 20, 18, 11, 13, 15, 16]

   !> The physical groups of one dimension.
   type :: groups_t
      type(integer_list_t) :: tag !! number of each physical group met so far, positive
      type(integer_list_t) :: group !! its set in the raw mesh; a name without members is still a set
      integer :: latest = 0 !! place of the one met last
      type(integer_list_t) :: entity !! numbers of entities, each once for every physical group that it belongs to
      type(integer_list_t) :: entity_tag !! number of this group
   end type groups_t

   !> Smallest number of bytes for a number: in text a digit and a blank, in a binary file more.
   integer, parameter :: least_bytes = 2
   !> Largest number of tags of an element; physical group, entity and partitions need a few.
   integer, parameter :: most_tags = 1000

contains

   !> Finds the set of a physical group, or makes one, called by the number of the group if that has no name.
   pure subroutine find_group(groups, raw, input, tag, name)
      type(groups_t), intent(inout) :: groups !! the groups of its dimension; the latest is this one on return
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: tag !! number of the group
      character(*), intent(in) :: name !! name of the group
      integer :: group

      if (groups%latest > 0) then
         if (groups%tag%item(groups%latest) == tag) return
      end if
      groups%latest = findloc(groups%tag%items(), tag, dim=1)
      if (groups%latest > 0) return
      call raw%get_group(input, name, group)
      call groups%tag%append(tag)
      call groups%group%append(group)
      groups%latest = groups%tag%n
   end subroutine find_group

   !> Puts consecutive cells into the set of a physical group.
   pure subroutine put_cells(groups, raw, input, tag, first, last)
      type(groups_t), intent(inout) :: groups !! the groups of the dimension of the cells
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: tag !! number of the group
      integer, intent(in) :: first !! first of the cells
      integer, intent(in) :: last !! last of the cells
      integer :: cell

      call raw%expect_members(input, last - first + 1)
      if (.not. allocated(input%error)) call find_group(groups, raw, input, tag, to_text(tag))
      if (allocated(input%error)) return
      associate (group => raw%groups(groups%group%item(groups%latest)))
         do cell = first, last
            call group%cell%append(cell)
            call group%side%append(0)
         end do
      end associate
   end subroutine put_cells

   !> Removes the elements that belong to no physical group, if others do.
   pure subroutine keep_groups(raw, input, groups, version)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh, complete
      type(input_file_t), intent(inout) :: input !! the file
      type(groups_t), intent(in) :: groups(:) !! the physical groups of each dimension
      integer, intent(in) :: version !! version of the format
      logical, allocatable :: is_dropped(:)
      integer :: group, n_dim, n_elements

      if (raw%n_groups > 0 .and. version == msh_22 .and. all(groups%latest == 0)) call input%refuse( &
         'no element belongs to any of the named physical groups, as version 2.2 leaves it with Mesh.SaveAll: '// &
         'save without that, or as version 4.1')
      n_dim = raw%n_dim()
      if (any(raw%cell_kind%items() == quad9) .and. n_dim == 3) call input%refuse( &
         'faces of 9 nodes (Gmsh type 10): mesh solids with Mesh.SecondOrderIncomplete = 1')
      is_dropped = cell_dimension(raw%cell_kind%items()) == n_dim
      n_elements = count(is_dropped)
      do group = 1, raw%n_groups
         is_dropped(raw%groups(group)%cell%items()) = .false.
      end do
      if (all(count(is_dropped) /= [integer :: 0, n_elements])) then
         where (is_dropped) raw%cell_kind%item(:raw%cell_kind%n) = no_cell
         call raw%add_note(counted(count(is_dropped), 'element')//' outside the physical '// &
            trim(merge('volumes ', 'surfaces', n_dim == 3))//' left out')
      end if
   end subroutine keep_groups

   !> Reads the type of an element; refuses types that are not supported.
   pure subroutine take_cell_kind(input, kind)
      type(input_file_t), intent(inout) :: input !! the file, at the type
      integer, intent(out) :: kind !! kind of the cell, `no_cell` where there is a fault
      integer :: type, place

      place = input%position
      call input%take_integer(type, 'the type of an element')
      kind = no_cell
      if (type >= 1 .and. type <= size(kind_of_type)) kind = kind_of_type(type)
      if (kind /= no_cell) return
      select case (type)
      case (6, 7, 13, 14, 18, 19)
         call input%refuse('prisms and pyramids (Gmsh type '//to_text(type)//') are not supported: mesh volumes '// &
            'with tetrahedra, or extrude Layers with Recombine over quadrilaterals', place)
      case (12)
         call input%refuse('hexahedra of 27 nodes (Gmsh type 12) are not supported: mesh with '// &
            'Mesh.SecondOrderIncomplete = 1', place)
      case (20:33, 36:40, 92, 93)
         call input%refuse('elements of third or higher order (Gmsh type '//to_text(type)//') are not supported; '// &
            'mesh with -order 1 or 2', place)
      case default
         call input%refuse('elements of Gmsh type '//to_text(type)//' are not supported: expected points (15), '// &
            'lines (1, 8), triangles (2, 9), quadrilaterals (3, 10, 16), tetrahedra (4, 11), hexahedra (5, 17)', place)
      end select
   end subroutine take_cell_kind

   !> Reads the section of the entities, of which only the physical groups are used.
   pure subroutine read_entities_4(groups, input, version)
      type(groups_t), intent(inout) :: groups(0:) !! the physical groups of each dimension
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
               if (group == 0) cycle
               call groups(dimension)%entity%append(entity)
               call groups(dimension)%entity_tag%append(abs(group))
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

   !> Reads the section of the nodes: blocks of numbers, followed by coordinates and parameters on the entity. Before
   !> version 4.1 each number is followed by the coordinates of its node; version 2.2 has one block.
   pure subroutine read_nodes(raw, input, version, is_parametric)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file, at the number of nodes or blocks
      integer, intent(in) :: version !! `msh_22`, `msh_40` or `msh_41`
      logical, intent(in) :: is_parametric !! of version 2.2: whether entity and parameters follow the coordinates
      integer, allocatable :: tags(:), places(:)
      integer :: block, dimension, entity, i, has_parameters, n, n_blocks, n_left, node
      real(dp) :: parameter, x(3)

      call take_section_header(input, version, n_blocks, n_left, 'nodes')
      has_parameters = 0
      do block = 1, n_blocks
         if (allocated(input%error)) return
         n = n_left
         if (version /= msh_22) then
            call take_entity(input, version, dimension, entity)
            call input%take_integer(has_parameters, 'whether nodes have parameters, 0 or 1')
            if (dimension < 0 .or. dimension > 3 .or. has_parameters < 0 .or. has_parameters > 1) call input%refuse( &
               'expected a dimension from 0 to 3 and whether nodes have parameters, 0 or 1')
            call take_block_size(input, n, n_left, 'nodes')
         end if
         allocate (tags(n), places(n), source=0)
         do node = 1, merge(n, 0, version == msh_41)
            call input%start_record()
            places(node) = input%position
            call input%take_size(tags(node), 'the number of a node')
         end do
         do node = 1, n
            call input%start_record()
            if (version /= msh_41) then
               places(node) = input%position
               call input%take_integer(tags(node), 'the number of a node')
            end if
            do i = 1, 3
               call input%take_real(x(i), 'a coordinate')
            end do
            if (is_parametric .and. version == msh_22) then
               call input%take_integer(dimension, "the dimension of a node's entity")
               call input%take_integer(entity, "the number of a node's entity")
               ! Nodes in volumes have no parameters here.
               has_parameters = merge(0, 1, dimension > 2)
            end if
            do i = 1, has_parameters*dimension
               call input%take_real(parameter, 'a parameter of a node')
            end do
            call input%end_record()
            if (allocated(input%error)) return
            call raw%add_node(tags(node), places(node), x)
         end do
         deallocate (tags, places)
      end do
      if (n_left > 0 .and. version /= msh_22) call input%refuse('the blocks hold '//to_text(n_left)// &
         ' fewer nodes than announced', input%position - 1)
   end subroutine read_nodes

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

   !> Reads the header of a section: the numbers of blocks and of items and, in version 4.1, the least and greatest of
   !> their numbers. Version 2.2 has the number of items only.
   pure subroutine take_section_header(input, version, n_blocks, n, things)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: version !! `msh_22`, `msh_40` or `msh_41`
      integer, intent(out) :: n_blocks !! number of blocks
      integer, intent(out) :: n !! number of things
      character(*), intent(in) :: things !! noun for the items, for messages
      integer :: limit, k

      n_blocks = 1
      if (version == msh_22) then
         call input%take_count(n, things)
      else
         call input%start_record()
         call input%take_size(n_blocks, 'the number of blocks of '//things)
         call input%take_size(n, 'the number of '//things)
         do k = 1, merge(2, 0, version == msh_41)
            call input%take_size(limit, 'the least and the greatest number of all '//things)
         end do
         call input%check_count(n_blocks, 4*least_bytes, 'blocks of '//things)
      end if
      call input%check_count(n, 2*least_bytes, things)
      if (version /= msh_22) call input%end_record()
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

   !> Reads the number of an element and its nodes in a version with blocks, or its nodes alone.
   pure subroutine take_cell(raw, input, version, kind, tag, place)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh; gains the cell, unless it repeats the one before
      type(input_file_t), intent(inout) :: input !! the file, at the first node
      integer, intent(in) :: version !! `msh_22`, `msh_40` or `msh_41`
      integer, intent(in) :: kind !! kind of the cell
      integer, intent(in) :: tag !! number of the element
      integer, intent(in) :: place !! position of its definition
      integer :: i, nodes(max_nodes)

      associate (own => nodes(:n_cell_nodes(kind)))
         do i = 1, size(own)
            call take_tag(input, version, own(i), 'a node of an element')
         end do
         call input%end_record()
         if (allocated(input%error)) return
         if (version == msh_22) then
            if (is_twin(raw, kind, own)) return
         end if
         if (kind == tet10) own = own(order_tet10)
         if (kind == hex20) own = own(order_hex20)
         call raw%add_cell(kind, tag, place, own)
      end associate
   end subroutine take_cell

   !> Reads the number of a node or element.
   pure subroutine take_tag(input, version, tag, what)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: version !! `msh_22`, `msh_40` or `msh_41`
      integer, intent(out) :: tag !! the number
      character(*), intent(in) :: what !! meaning of the number, for the message

      if (version == msh_41) call input%take_size(tag, what)
      if (version /= msh_41) call input%take_integer(tag, what)
   end subroutine take_tag

   !> Reads the section of the elements: blocks of elements of one type on one entity.
   pure subroutine read_elements_4(raw, groups, input, version)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(groups_t), intent(inout) :: groups(0:) !! the physical groups of each dimension
      type(input_file_t), intent(inout) :: input !! the file, at the number of blocks
      integer, intent(in) :: version !! `msh_40` or `msh_41`
      integer :: block, dimension, element, entity, first, i, kind, n, n_blocks, n_left, place, tag

      call take_section_header(input, version, n_blocks, n_left, 'elements')
      do block = 1, n_blocks
         if (allocated(input%error)) return
         call take_entity(input, version, dimension, entity)
         call take_cell_kind(input, kind)
         if (dimension /= cell_dimension(kind)) call input%refuse('elements on an entity of dimension '// &
            to_text(dimension)//', which is not their own')
         call take_block_size(input, n, n_left, 'elements')
         if (allocated(input%error)) return
         first = raw%cell_tag%n + 1
         do element = 1, n
            call input%start_record()
            place = input%position
            call take_tag(input, version, tag, 'the number of an element')
            call take_cell(raw, input, version, kind, tag, place)
            if (allocated(input%error)) return
         end do
         do i = 1, merge(groups(dimension)%entity%n, 0, n > 0)
            if (groups(dimension)%entity%item(i) == entity) call put_cells(groups(dimension), raw, input, &
               groups(dimension)%entity_tag%item(i), first, raw%cell_tag%n)
         end do
      end do
      if (n_left > 0) call input%refuse('the blocks hold '//to_text(n_left)//' fewer elements than announced', &
         input%position - 1)
   end subroutine read_elements_4

   !> Reads the section of the elements in version 2.2.
   pure subroutine read_elements_2(raw, groups, input)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(groups_t), intent(inout) :: groups(0:) !! the physical groups of each dimension
      type(input_file_t), intent(inout) :: input !! the file, at the number of elements
      integer :: at, element, group, i, kind, n, n_alike, n_blocks, n_tags, place, tag, tag_of_element

      call take_section_header(input, msh_22, n_blocks, n, 'elements')
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
         call take_cell(raw, input, msh_22, kind, tag, place)
         if (group > 0) call put_cells(groups(cell_dimension(kind)), raw, input, group, raw%cell_tag%n, raw%cell_tag%n)
      end do
   end subroutine read_elements_2

   !> Whether an element repeats the one before: the format lists it once for every physical group it belongs to.
   pure logical function is_twin(raw, kind, nodes)
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      integer, intent(in) :: kind !! kind of the element
      integer, intent(in) :: nodes(:) !! its nodes
      integer :: i

      is_twin = .false.
      if (raw%cell_kind%n == 0) return
      if (raw%cell_kind%item(raw%cell_kind%n) /= kind) return
      associate (twin => raw%node%item(raw%node%n - size(nodes) + 1:raw%node%n))
         is_twin = all([(any(nodes == twin(i)), i=1, size(twin))])
      end associate
   end function is_twin

   !> Reads a mesh section by section. Faults are recorded in the input.
   pure subroutine read_gmsh(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, at its first section
      type(groups_t) :: groups(0:3)
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
         if (version == 0 .and. all(name /= [character(10) :: 'MeshFormat', 'Comments'])) call input%refuse( &
            'expected $MeshFormat before $'//name//'; save the mesh as version 2.2 or 4.1')
         select case (name)
         case ('MeshFormat', 'PhysicalNames', 'Entities', 'Nodes', 'ParametricNodes', 'Elements')
            if (index(seen, ' '//name//' ') > 0) call input%refuse('a second section $'//name)
            seen = seen//name//' '
            if (raw%cell_tag%n > 0 .and. any(name == [character(13) :: 'PhysicalNames', 'Entities'])) call &
               input%refuse('expected $'//name//' before $Elements')
            call input%end_line()
            select case (name)
            case ('MeshFormat')
               call read_format(input, version)
            case ('PhysicalNames')
               call read_names(raw, groups, input)
            case ('Entities')
               call read_entities_4(groups, input, version)
            case ('Nodes', 'ParametricNodes')
               call read_nodes(raw, input, version, name == 'ParametricNodes')
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
         'no triangles, quadrilaterals, tetrahedra or hexahedra: once there are physical groups, Gmsh saves only '// &
         'what is in them')
      if (.not. allocated(input%error)) call keep_groups(raw, input, groups, version)
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
      type(groups_t), intent(inout) :: groups(0:) !! the physical groups of each dimension
      type(input_file_t), intent(inout) :: input !! the file, at the number of names
      character(:), allocatable :: name
      integer :: dimension, i, n, place, tag

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
         if (len(name) == 0) cycle
         if (any(groups(dimension)%tag%items() == tag)) call input%refuse('a physical group is named twice', &
            input%position - 1)
         call find_group(groups(dimension), raw, input, tag, name)
         if (allocated(input%error)) return
      end do
      groups%latest = 0
   end subroutine read_names

end module amontons_gmsh
