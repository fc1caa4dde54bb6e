!> Nodes and elements of Gmsh's MSH format, version 2.2, text and binary.
module amontons_gmsh_2
   use amontons_gmsh_groups, only: dimension_of, gmsh_groups_t, take_cell_kind
   use amontons_input_file, only: input_file_t
   use amontons_kinds, only: dp
   use amontons_raw_mesh, only: raw_mesh_t, n_cell_nodes
   implicit none (type, external)
   private

   public :: read_elements_2, read_nodes_2

   !> Bytes that a node of a text takes at least: `1 0 0 0` and the end of the line.
   integer, parameter :: least_node_text = 8
   !> Bytes that a node of a binary file takes: an integer and three reals.
   integer, parameter :: least_node_bytes = 28
   !> Bytes that an element takes at least: in text `1 15 0 1` and the end of the line; in binary two integers.
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
      call raw%expect_nodes(n)
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
      call raw%expect_cells(n)
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

end module amontons_gmsh_2
