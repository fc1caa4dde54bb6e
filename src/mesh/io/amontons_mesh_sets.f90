!> The named sets of a mesh, from the groups of a raw mesh: boundary sets, sets of nodes, regions.
module amontons_mesh_sets
   use amontons_element, only: n_corners
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t, tag_map_t
   use amontons_mesh, only: boundary_set_t, mesh_t, node_set_t, region_t
   use amontons_mesh_topology, only: side_element, side_place, side_table_t, sides_per_element
   use amontons_raw_mesh, only: raw_group_t, raw_mesh_t, point1
   use amontons_text, only: counted, to_text
   implicit none (type, external)
   private

   public :: name_sets, renumbering_t

   !> From the things of a raw mesh to those of a mesh.
   type :: renumbering_t
      type(tag_map_t) :: place !! from the number of a node in the file to its place in the raw mesh
      integer, allocatable :: node(:) !! node of the mesh of each node of the raw mesh, 0 for none
      integer, allocatable :: element(:) !! element of each cell of the raw mesh, 0 for none
      logical, allocatable :: is_turned(:) !! whether an element runs round the other way than its cell (n_elements)
   end type renumbering_t

   !> A set being collected: every member once, in the order found.
   type :: collection_t
      integer, allocatable :: stamp(:) !! last set that each thing was put into
      type(integer_list_t) :: members !! the members
      integer :: set = 0 !! number of the set
   contains
      procedure :: begin => collection_begin
      procedure :: put => collection_put
   end type collection_t

   !> Everything that one name stands for, and what of it could not be found.
   type :: named_things_t
      type(collection_t) :: sides !! numbers of sides
      type(collection_t) :: nodes !! nodes
      type(collection_t) :: elements !! elements
      integer :: n_inside = 0 !! number of sides with elements on both sides
      integer :: n_elsewhere = 0 !! number of lines without an element
      integer :: n_unused = 0 !! number of nodes without an element
   end type named_things_t

contains

   !> Begins another set.
   pure subroutine collection_begin(self)
      class(collection_t), intent(inout) :: self !! the collection

      self%set = self%set + 1
      self%members%n = 0
   end subroutine collection_begin

   !> Puts a thing into the set, unless it is there already.
   pure subroutine collection_put(self, thing)
      class(collection_t), intent(inout) :: self !! the collection
      integer, intent(in) :: thing !! the thing

      if (self%stamp(thing) == self%set) return
      self%stamp(thing) = self%set
      call self%members%append(thing)
   end subroutine collection_put

   !> Gives a mesh the named sets of a raw mesh. Faults go to the input, notes to the raw mesh.
   pure subroutine name_sets(mesh, raw, input, table, renumbering)
      type(mesh_t), intent(inout) :: mesh !! the mesh, complete but for its sets
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      type(side_table_t), intent(in) :: table !! the sides of the elements
      type(renumbering_t), intent(in) :: renumbering !! from the raw mesh to the mesh
      type(boundary_set_t), allocatable :: sets(:)
      type(node_set_t), allocatable :: node_sets(:)
      type(region_t), allocatable :: regions(:)
      type(named_things_t) :: things
      integer :: group, n_sets, n_node_sets, n_regions

      allocate (things%sides%stamp(sides_per_element*mesh%n_elements), things%nodes%stamp(mesh%n_nodes), &
         things%elements%stamp(mesh%n_elements), source=0)
      allocate (sets(raw%n_groups), node_sets(raw%n_groups), regions(raw%n_groups))
      n_sets = 0
      n_node_sets = 0
      n_regions = 0
      do group = 1, raw%n_groups
         call collect(things, mesh, raw, raw%groups(group), input, table, renumbering)
         if (allocated(input%error)) return
         associate (name => raw%groups(group)%name, sides => things%sides%members%items())
            if (size(sides) > 0) then
               n_sets = n_sets + 1
               sets(n_sets) = boundary_set_t(name, side_element(sides), side_place(sides))
            end if
            if (things%nodes%members%n > 0) then
               n_node_sets = n_node_sets + 1
               node_sets(n_node_sets) = node_set_t(name, things%nodes%members%items())
            end if
            if (things%elements%members%n > 0) then
               n_regions = n_regions + 1
               regions(n_regions) = region_t(name, things%elements%members%items())
            end if
         end associate
         call note_losses(raw, raw%groups(group)%name, things)
      end do
      allocate (mesh%sets, source=sets(:n_sets))
      if (n_node_sets > 0) allocate (mesh%node_sets, source=node_sets(:n_node_sets))
      if (n_regions > 0) allocate (mesh%regions, source=regions(:n_regions))
   end subroutine name_sets

   !> Collects everything that a group names.
   pure subroutine collect(things, mesh, raw, group, input, table, renumbering)
      type(named_things_t), intent(inout) :: things !! what it names
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      type(raw_group_t), intent(in) :: group !! the group
      type(input_file_t), intent(inout) :: input !! the file
      type(side_table_t), intent(in) :: table !! the sides of the elements
      type(renumbering_t), intent(in) :: renumbering !! from the raw mesh to the mesh
      integer :: i, cell, node

      call things%sides%begin()
      call things%nodes%begin()
      call things%elements%begin()
      things%n_inside = 0
      things%n_elsewhere = 0
      things%n_unused = 0
      do i = 1, group%cell%n
         cell = group%cell%item(i)
         if (group%side%item(i) > 0) then
            call put_side(things, mesh, table, renumbering, cell, group%side%item(i))
         else if (raw%cell_kind%item(cell) > 0) then
            call things%elements%put(renumbering%element(cell))
         else if (raw%cell_kind%item(cell) == point1) then
            call put_node(things, renumbering%node(raw%node%item(raw%cell_start%item(cell))))
         else
            call put_line(things, mesh, raw, input, table, renumbering, cell)
         end if
      end do
      do i = 1, group%node%n
         node = renumbering%place%find(group%node%item(i))
         if (node == 0) then
            call input%refuse("the set '"//group%name//"' names node "//to_text(group%node%item(i))// &
               ', which the file does not give', group%place)
            return
         end if
         call put_node(things, renumbering%node(node))
      end do
      if (raw%nodes_name_sides .and. things%sides%members%n + things%n_inside == 0) then
         call put_sides_between(things, mesh, table)
      end if
   end subroutine collect

   !> Puts a node into a set, if elements have it.
   pure subroutine put_node(things, node)
      type(named_things_t), intent(inout) :: things !! the set
      integer, intent(in) :: node !! the node, 0 for one that no element has

      if (node > 0) then
         call things%nodes%put(node)
      else
         things%n_unused = things%n_unused + 1
      end if
   end subroutine put_node

   !> Puts a side of a cell into a set, if it belongs to the boundary.
   pure subroutine put_side(things, mesh, table, renumbering, cell, cell_side)
      type(named_things_t), intent(inout) :: things !! the set
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(side_table_t), intent(in) :: table !! the sides of the elements
      type(renumbering_t), intent(in) :: renumbering !! from the raw mesh to the mesh
      integer, intent(in) :: cell !! the cell
      integer, intent(in) :: cell_side !! the side of the cell
      integer :: element, side, corners(3), left, right

      element = renumbering%element(cell)
      side = cell_side
      if (renumbering%is_turned(element)) side = n_corners(mesh%element_kind(element)) + 1 - side
      corners = mesh%side(element, side)
      call table%find(corners(1), corners(2), left, right)
      if (right > 0) then
         things%n_inside = things%n_inside + 1
      else
         call things%sides%put(left)
      end if
   end subroutine put_side

   !> Puts the side that a line carries into a set, if it belongs to the boundary.
   pure subroutine put_line(things, mesh, raw, input, table, renumbering, cell)
      type(named_things_t), intent(inout) :: things !! the set
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      type(side_table_t), intent(in) :: table !! the sides of the elements
      type(renumbering_t), intent(in) :: renumbering !! from the raw mesh to the mesh
      integer, intent(in) :: cell !! the line
      integer :: left, right, side(3)

      associate (nodes => renumbering%node(raw%cell_nodes(cell)))
         left = 0
         right = 0
         if (all(nodes(:2) > 0)) call table%find(nodes(1), nodes(2), left, right)
         if (min(left, right) > 0) then
            things%n_inside = things%n_inside + 1
            return
         end if
         if (max(left, right) == 0) then
            things%n_elsewhere = things%n_elsewhere + 1
            return
         end if
         call things%sides%put(max(left, right))
         side = mesh%side(side_element(max(left, right)), side_place(max(left, right)))
         if (size(nodes) == 3 .and. side(3) > 0) then
            if (nodes(3) /= side(3)) call input%refuse('line '//to_text(raw%cell_tag%item(cell))// &
               ' has another middle node than the element at its side', raw%cell_place%item(cell))
         end if
      end associate
   end subroutine put_line

   !> Puts the boundary sides all of whose nodes are in a set into the set.
   pure subroutine put_sides_between(things, mesh, table)
      type(named_things_t), intent(inout) :: things !! the set, its nodes complete
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(side_table_t), intent(in) :: table !! the sides of the elements
      integer :: i, number, place, nodes(3)

      do i = 1, things%nodes%members%n
         place = table%last(things%nodes%members%item(i))
         do while (place > 0)
            number = table%boundary(place)
            place = table%sides(place)%before
            if (number == 0) cycle
            nodes = mesh%side(side_element(number), side_place(number))
            if (nodes(3) == 0) nodes(3) = nodes(1)
            if (any(things%nodes%stamp(nodes) /= things%nodes%set)) cycle
            call things%sides%put(number)
         end do
      end do
   end subroutine put_sides_between

   !> Notes what a name stands for in the file and not in the mesh.
   pure subroutine note_losses(raw, name, things)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      character(*), intent(in) :: name !! the name
      type(named_things_t), intent(in) :: things !! what was found and what was not

      if (things%n_inside > 0) call raw%add_note("set '"//name//"': "//counted(things%n_inside, 'side')// &
         ' inside the body left out')
      if (things%n_elsewhere > 0) call raw%add_note("set '"//name//"': "//counted(things%n_elsewhere, 'line')// &
         ' without an element left out')
      if (things%n_unused > 0) call raw%add_note("set '"//name//"': "//counted(things%n_unused, 'node')// &
         ' without an element left out')
      if (things%sides%members%n + things%nodes%members%n + things%elements%members%n &
         + things%n_inside + things%n_elsewhere + things%n_unused == 0) call raw%add_note( &
         "set '"//name//"' left out: it is empty")
   end subroutine note_losses

end module amontons_mesh_sets
