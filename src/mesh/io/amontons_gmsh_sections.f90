!> Entities, nodes and elements of Gmsh's MSH format, versions 2.2 and 4.1, text and binary.
module amontons_gmsh_sections
   use amontons_gmsh_groups, only: dimension_of, gmsh_groups_t, take_cell_kind
   use amontons_input_file, only: input_file_t
   use amontons_kinds, only: dp
   use amontons_raw_mesh, only: n_cell_nodes, raw_mesh_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: read_elements_2, read_elements_4, read_entities_4, read_nodes_2, read_nodes_4

   !> Bytes that a number of version 4.1 takes at least: in text a digit and a blank, in a binary file more.
   integer, parameter :: least_bytes = 2
   !> A node has three coordinates and up to three parameters.
   integer, parameter :: most_numbers = 6

   !> Bytes that a node of a text of version 2.2 takes at least: `1 0 0 0` and the end of the line.
   integer, parameter :: least_node_text = 8
   !> Bytes that a node of a binary file of version 2.2 takes: an integer and three reals.
   integer, parameter :: least_node_bytes = 28
   !> Bytes that an element of version 2.2 takes at least: in text `1 15 0 1` and the end of the line; in binary two
   !> integers.
   integer, parameter :: least_element = 8
   !> More tags of an element are refused: physical group, entity and partitions are a few.
   integer, parameter :: most_tags = 1000

   !> What precedes the elements in a binary file, and each of them in a text.
   type :: element_header_t
      integer :: kind = 0 !! kind of the cell
      integer :: n_tags = 0 !! number of tags
      integer :: n_left = 0 !! number of elements that the header still holds for
   end type element_header_t

contains

   !> Reads the section of the entities, of which only their physical groups matter.
   pure subroutine read_entities_4(groups, input)
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file, at the numbers of entities
      integer :: n(0:3), dimension, entity

      call input%start_record()
      do dimension = 0, 3
         call input%take_size(n(dimension), 'the number of entities of dimension '//to_text(dimension))
      end do
      do dimension = 0, 3
         call input%check_count(n(dimension), least_bytes, 'entities')
      end do
      call input%end_record()
      do dimension = 0, 3
         do entity = 1, n(dimension)
            call read_entity(groups, input, dimension)
            if (allocated(input%error)) return
         end do
      end do
   end subroutine read_entities_4

   !> Reads an entity: its number, its place or box, its physical groups, and what it is bounded by.
   pure subroutine read_entity(groups, input, dimension)
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: dimension !! dimension of the entity
      integer :: entity, group, i, n
      real(dp) :: x

      call input%start_record()
      call input%take_integer(entity, 'the number of an entity')
      if (entity < 0) call input%refuse('the number of an entity is negative')
      do i = 1, merge(3, 6, dimension == 0)
         call input%take_real(x, 'a coordinate of an entity')
      end do
      call input%take_size(n, 'the number of physical groups of an entity')
      call input%check_count(n, least_bytes, 'physical groups')
      do i = 1, n
         call input%take_integer(group, 'a physical group')
         if (allocated(input%error)) return
         if (dimension == 3 .or. group == 0) cycle
         call groups%of_dimension(dimension)%entity%append(entity)
         call groups%of_dimension(dimension)%entity_tag%append(abs(group))
      end do
      if (dimension > 0) then
         call input%take_size(n, 'the number of entities that bound an entity')
         call input%check_count(n, least_bytes, 'bounding entities')
         do i = 1, n
            call input%take_integer(entity, 'a bounding entity')
            if (allocated(input%error)) return
         end do
      end if
      call input%end_record()
   end subroutine read_entity

   !> Reads the section of the nodes.
   pure subroutine read_nodes_4(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file, at the number of blocks
      integer :: block, n_blocks, n_left

      call take_section_header(input, n_blocks, n_left, 'nodes')
      if (allocated(input%error)) return
      do block = 1, n_blocks
         call read_node_block(raw, input, n_left)
         if (allocated(input%error)) return
      end do
      call check_none_left(input, n_left, 'nodes')
   end subroutine read_nodes_4

   !> Takes the numbers of blocks and of things in a section, and the least and the greatest number of the things.
   pure subroutine take_section_header(input, n_blocks, n, things)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: n_blocks !! number of blocks
      integer, intent(out) :: n !! number of things
      character(*), intent(in) :: things !! what the things are
      integer :: least, greatest

      call input%start_record()
      call input%take_size(n_blocks, 'the number of blocks of '//things)
      call input%take_size(n, 'the number of '//things)
      call input%take_size(least, 'the least number of all '//things)
      call input%take_size(greatest, 'the greatest number of all '//things)
      call input%check_count(n_blocks, 4*least_bytes, 'blocks of '//things)
      call input%check_count(n, 2*least_bytes, things)
      call input%end_record()
   end subroutine take_section_header

   !> Refuses a section whose blocks hold fewer things than it announced.
   pure subroutine check_none_left(input, n_left, things)
      type(input_file_t), intent(inout) :: input !! the file, behind the section
      integer, intent(in) :: n_left !! number of things announced that no block held
      character(*), intent(in) :: things !! what the things are

      if (n_left > 0) call input%refuse('the blocks hold '//to_text(n_left)//' fewer '//things//' than announced', &
         input%position - 1)
   end subroutine check_none_left

   !> Takes the number of things in a block, the last of its header.
   pure subroutine take_block_size(input, n, n_left, things)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(out) :: n !! number of things in the block
      integer, intent(inout) :: n_left !! number of things that the section still has to hold
      character(*), intent(in) :: things !! what the things are

      call input%take_size(n, 'the number of '//things//' of a block')
      if (n > n_left) call input%refuse('the blocks hold more '//things//' than the section announced')
      call input%end_record()
      if (allocated(input%error)) n = 0
      n_left = n_left - n
   end subroutine take_block_size

   !> Reads a block of nodes: their numbers, then their coordinates and the parameters on their entity.
   pure subroutine read_node_block(raw, input, n_left)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file, at the block's header
      integer, intent(inout) :: n_left !! number of nodes that the section still has to hold
      integer, allocatable :: tags(:), places(:)
      integer :: dimension, entity, i, has_parameters, n, n_numbers, node
      real(dp) :: x(most_numbers)

      call input%start_record()
      call input%take_integer(dimension, 'the dimension of an entity')
      call input%take_integer(entity, 'the number of an entity')
      call input%take_integer(has_parameters, 'whether nodes have parameters, 0 or 1')
      if (dimension < 0 .or. dimension > 3 .or. has_parameters < 0 .or. has_parameters > 1) call input%refuse( &
         'expected a dimension from 0 to 3 and whether nodes have parameters, 0 or 1')
      call take_block_size(input, n, n_left, 'nodes')
      n_numbers = 3 + merge(dimension, 0, has_parameters == 1)
      allocate (tags(n), places(n))
      do node = 1, n
         call input%start_record()
         places(node) = input%position
         call input%take_size(tags(node), 'the number of a node')
      end do
      do node = 1, n
         call input%start_record()
         do i = 1, n_numbers
            call input%take_real(x(i), 'a coordinate or parameter of a node')
         end do
         call input%end_record()
         if (allocated(input%error)) return
         call raw%add_node(tags(node), places(node), x(:3))
      end do
   end subroutine read_node_block

   !> Reads the section of the elements.
   pure subroutine read_elements_4(raw, groups, input)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file, at the number of blocks
      integer :: block, n_blocks, n_left

      call take_section_header(input, n_blocks, n_left, 'elements')
      if (allocated(input%error)) return
      do block = 1, n_blocks
         call read_element_block(raw, groups, input, n_left)
         if (allocated(input%error)) return
      end do
      call check_none_left(input, n_left, 'elements')
   end subroutine read_elements_4

   !> Reads a block of elements of one type on one entity.
   pure subroutine read_element_block(raw, groups, input, n_left)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file, at the block's header
      integer, intent(inout) :: n_left !! number of elements that the section still has to hold
      integer :: dimension, element, entity, first, kind, n

      call input%start_record()
      call input%take_integer(dimension, 'the dimension of an entity')
      call input%take_integer(entity, 'the number of an entity')
      call take_cell_kind(input, kind)
      if (dimension /= dimension_of(kind)) call input%refuse('elements on an entity of dimension '// &
         to_text(dimension)//', which is not their own')
      call take_block_size(input, n, n_left, 'elements')
      first = raw%cell_tag%n + 1
      do element = 1, n
         call read_element(raw, input, kind)
         if (allocated(input%error)) return
      end do
      if (n > 0) call groups%add_run(dimension, entity, first, raw%cell_tag%n)
   end subroutine read_element_block

   !> Reads an element: its number and its nodes.
   pure subroutine read_element(raw, input, kind)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: kind !! kind of the element
      integer :: i, nodes(n_cell_nodes(kind)), place, tag

      call input%start_record()
      place = input%position
      call input%take_size(tag, 'the number of an element')
      do i = 1, size(nodes)
         call input%take_size(nodes(i), 'a node of an element')
      end do
      call input%end_record()
      if (.not. allocated(input%error)) call raw%add_cell(kind, tag, place, nodes)
   end subroutine read_element

   !> Reads the section of the nodes.
   pure subroutine read_nodes_2(raw, input, is_parametric)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file, at the number of nodes
      logical, intent(in) :: is_parametric !! whether entity and parameters follow the coordinates
      integer :: i, n, node, tag, place
      real(dp) :: x(3)

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
         if (is_parametric) call skip_parameters(input)
         call input%end_record()
         if (allocated(input%error)) return
         call raw%add_node(tag, place, x)
      end do
   end subroutine read_nodes_2

   !> Moves over the entity of a node and the parameters of the node on it.
   pure subroutine skip_parameters(input)
      type(input_file_t), intent(inout) :: input !! the file
      real(dp) :: parameter
      integer :: dimension, entity, i

      call input%take_integer(dimension, "the dimension of a node's entity")
      call input%take_integer(entity, "the number of a node's entity")
      ! Nodes in volumes have no parameters here.
      if (dimension > 2) return
      do i = 1, dimension
         call input%take_real(parameter, 'a parameter of a node')
      end do
   end subroutine skip_parameters

   !> Reads the section of the elements.
   pure subroutine read_elements_2(raw, groups, input)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file, at the number of elements
      type(element_header_t) :: header
      integer :: element, group, n, place, tag

      call input%take_count(n, 'elements')
      call input%check_count(n, least_element, 'elements')
      if (allocated(input%error)) return
      do element = 1, n
         call input%start_record()
         place = input%position
         if (input%is_binary) then
            if (header%n_left == 0) call take_header(input, header, n - element + 1)
            call input%take_integer(tag, 'the number of an element')
         else
            call input%take_integer(tag, 'the number of an element')
            call take_header(input, header, n - element + 1)
         end if
         header%n_left = header%n_left - 1
         call take_tags(input, header%n_tags, group)
         call take_element(raw, groups, input, header%kind, tag, group, place)
         call input%end_record()
         if (allocated(input%error)) return
      end do
   end subroutine read_elements_2

   !> Takes the type, in a binary file the number of elements of it, and the number of tags.
   pure subroutine take_header(input, header, n_left)
      type(input_file_t), intent(inout) :: input !! the file
      type(element_header_t), intent(inout) :: header !! the header
      integer, intent(in) :: n_left !! number of elements that are still to come
      integer :: place

      call take_cell_kind(input, header%kind)
      header%n_left = 1
      place = input%position
      if (input%is_binary) call input%take_integer(header%n_left, 'the number of elements of a type')
      if (header%n_left < 1 .or. header%n_left > n_left) call input%refuse( &
         'the elements of this type are more than those announced, or none', place)
      place = input%position
      call input%take_integer(header%n_tags, 'the number of tags of an element')
      if (header%n_tags < 0 .or. header%n_tags > most_tags) call input%refuse( &
         'the number of tags of an element is out of range', place)
      if (allocated(input%error)) header%n_tags = 0
   end subroutine take_header

   !> Takes the tags of an element, of which the first is its physical group; reversed ones have a minus.
   pure subroutine take_tags(input, n_tags, group)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n_tags !! number of tags
      integer, intent(out) :: group !! number of the physical group, 0 for none
      integer :: i, tag

      group = 0
      do i = 1, n_tags
         call input%take_integer(tag, 'a tag of an element')
         if (i == 1) group = abs(tag)
      end do
   end subroutine take_tags

   !> Takes the nodes of an element.
   pure subroutine take_element(raw, groups, input, kind, tag, group, place)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(gmsh_groups_t), intent(inout) :: groups !! what belongs to which physical group
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: kind !! kind of the element
      integer, intent(in) :: tag !! its number
      integer, intent(in) :: group !! its physical group, 0 for none
      integer, intent(in) :: place !! where the file gives it
      integer :: nodes(n_cell_nodes(kind)), cell, i

      do i = 1, size(nodes)
         call input%take_integer(nodes(i), 'a node of an element')
      end do
      if (allocated(input%error)) return
      cell = raw%cell_tag%n
      if (.not. is_twin(raw, cell, kind, nodes)) then
         cell = cell + 1
         call raw%add_cell(kind, tag, place, nodes)
      end if
      if (group > 0) call groups%add_run(dimension_of(kind), group, cell, cell)
   end subroutine take_element

   !> Whether an element is the one before once more: the format repeats it for every physical group it belongs to.
   pure logical function is_twin(raw, cell, kind, nodes)
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      integer, intent(in) :: cell !! the element before, 0 for none
      integer, intent(in) :: kind !! kind of the element
      integer, intent(in) :: nodes(:) !! its nodes
      integer :: i

      is_twin = .false.
      if (cell == 0) return
      if (raw%cell_kind%item(cell) /= kind) return
      associate (twin => raw%cell_nodes(cell))
         do i = 1, size(twin)
            if (all(nodes /= twin(i))) return
         end do
      end associate
      is_twin = .true.
   end function is_twin

end module amontons_gmsh_sections
