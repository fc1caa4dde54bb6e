!> Makes a mesh of a raw mesh: harmless defects are repaired, with a note; other defects are refused. The file's groups
!> become named sets: boundary sets, node sets, regions.
!>
!> The topology of a mesh is interrupted at slits and at hanging nodes, which lie on the side of an element without
!> belonging to it. At a hanging node the elements on both sides share the ends of the long side, but not the nodes
!> between them. The sides on both faces of a slit, and those at hanging nodes, are then boundary sides, so that only
!> these are searched.
module amontons_mesh_cleanup
   use amontons_element, only: corner_kind, is_solid, mapped_square, n_corners, n_element_nodes, n_side_corners, &
      quad4, quad8, side_nodes, tet4, tri3, tri6
   use amontons_error, only: input_refused, new_error
   use amontons_file_model, only: cell_dimension, n_cell_nodes, raw_mesh_t
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t, new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_mesh, only: jacobian_determinant, jacobian_reference_t, mesh_t, named_set_t, new_jacobian_references, &
      new_side_table, number_pieces, side_element, side_place, side_table_t, sides_per_element
   use amontons_rounding, only: angle_rounding, input_rounding
   use amontons_text, only: counted, to_text
   implicit none (type, external)
   private

   public :: new_clean_mesh

   !> Sides of the boundary, sorted by their end corner.
   type :: incoming_sides_t
      integer, allocatable :: start(:) !! corner that each side comes from (sides)
      integer, allocatable :: before(:) !! side filed before it at the corner it leads to, 0 for none (sides)
      integer, allocatable :: last(:) !! last side filed at each corner, 0 for none (nodes)
   end type incoming_sides_t

   !> Maps from nodes and cells of a raw mesh to nodes and elements of the mesh.
   type :: renumbering_t
      type(tag_map_t) :: place !! from the number of a node in the file to its place in the raw mesh
      integer, allocatable :: node(:) !! node of the mesh of each node of the raw mesh, 0 for none
      integer, allocatable :: element(:) !! element of each cell of the raw mesh, 0 for none
   end type renumbering_t

   !> Members of a set that is being collected: each once, in the order found.
   type :: collection_t
      integer, allocatable :: stamp(:) !! last set that each thing was put into
      type(integer_list_t) :: list !! the things
   contains
      procedure :: put => collection_put
   end type collection_t

   !> The members of a raw group in the mesh.
   type :: group_members_t
      type(collection_t) :: sides !! sides of the boundary
      type(collection_t) :: nodes !! nodes
      type(collection_t) :: elements !! elements
      integer, allocatable :: of_cell(:) !! the last group of each line and point (cells)
      integer :: n_inside = 0 !! number of its sides inside the body
      integer :: n_elsewhere = 0 !! number of its lines without an element
      integer :: n_unused = 0 !! number of its nodes without an element
   end type group_members_t

   !> Largest magnitude of a coordinate: products of larger ones may overflow.
   real(dp), parameter :: largest_coordinate = 1.0e100_dp

contains

   !> Warns of the ends of slits: nodes at which two boundary sides with the body on opposite sides coincide in
   !> direction. A crack is a slit; so is the line between parts that touch without common nodes.
   pure subroutine warn_of_slits(mesh, table, incoming)
      type(mesh_t), intent(inout) :: mesh !! the mesh; gains the warning
      type(side_table_t), intent(in) :: table !! the sides of its elements
      type(incoming_sides_t), intent(in) :: incoming !! those of the boundary
      integer :: corners(3), n_ends, node, number, other, side
      real(dp) :: along(2), way(2)

      n_ends = 0
      do side = 1, table%n_sides
         number = table%boundary(side)
         if (number == 0) cycle
         corners = mesh%side(side_element(number), side_place(number))
         along = mesh%coordinates(:, corners(2)) - mesh%coordinates(:, corners(1))
         other = incoming%last(corners(1))
         do while (other > 0)
            way = mesh%coordinates(:, incoming%start(other)) - mesh%coordinates(:, corners(1))
            other = incoming%before(other)
            if (abs(way(1)*along(2) - way(2)*along(1)) > angle_rounding*dot_product(way, along)) cycle
            n_ends = n_ends + 1
            if (n_ends == 1) node = corners(1)
         end do
      end do
      if (n_ends > 0) call mesh%warnings%add(counted(n_ends, 'end')//' of slits, the first at '// &
         to_text(mesh%coordinates(1, node))//', '//to_text(mesh%coordinates(2, node))// &
         ': from there on, elements touch without sharing their nodes')
   end subroutine warn_of_slits

   !> Follows shorter sides of the elements on the other face from one corner of a side to the other, against their
   !> direction.
   pure subroutine follow_sides(incoming, coordinates, from, to, node)
      type(incoming_sides_t), intent(in) :: incoming !! the sides of the boundary
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, nodes) [L]
      integer, intent(in) :: from !! the corner to come from
      integer, intent(in) :: to !! the corner to go to
      integer, intent(out) :: node !! the first node on the way, 0 if the way does not lead there
      ! Nodes of a curved interface lie beside the chord, by far less than this share of it; but on the element's own
      ! side by no more than what the digits of a file leave: across a thin body there may be a way as well.
      real(dp), parameter :: outer_width = 0.02_dp
      real(dp) :: along(2), reached, way(2)
      integer :: at, side

      node = 0
      along = (coordinates(:, to) - coordinates(:, from))/sum((coordinates(:, to) - coordinates(:, from))**2)
      reached = 0.0_dp
      at = from
      do
         side = incoming%last(at)
         do while (side > 0)
            way = coordinates(:, incoming%start(side)) - coordinates(:, from)
            ! Along the side, and off it to the right, where no element should be; in parts of the side.
            way = [dot_product(way, along), way(1)*along(2) - way(2)*along(1)]
            if (incoming%start(side) == to) exit
            if (way(1) > reached .and. way(1) < 1.0_dp .and. way(2) > -angle_rounding .and. way(2) < outer_width) exit
            side = incoming%before(side)
         end do
         if (side == 0) exit
         at = incoming%start(side)
         if (at == to) return
         if (node == 0) node = at
         reached = way(1)
      end do
      node = 0
   end subroutine follow_sides

   !> Makes a mesh of a raw mesh. Faults are recorded in the input, notes in the raw mesh.
   subroutine new_clean_mesh(mesh, raw, input)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh; its cells name their nodes by place on return
      type(input_file_t), intent(inout) :: input !! the file
      type(renumbering_t) :: renumbering
      type(side_table_t) :: table
      type(incoming_sides_t) :: incoming
      integer, allocatable :: cell_of(:), piece(:)
      integer :: cell, element, i, n_dim, n_pieces, node

      call check_tags(input, 'node', raw%node_tag%items(), raw%node_place%items())
      call check_tags(input, 'element', raw%cell_tag%items(), raw%cell_place%items())
      if (allocated(input%error)) return
      call new_tag_map(renumbering%place, raw%node_tag%items())
      do cell = 1, raw%cell_tag%n
         do i = raw%cell_start%item(cell), raw%cell_start%item(cell) + n_cell_nodes(raw%cell_kind%item(cell)) - 1
            node = renumbering%place%find(raw%node%item(i))
            if (node == 0) call refuse_cell(input, raw, cell, 'names node '//to_text(raw%node%item(i))// &
               ', which the file does not give')
            raw%node%item(i) = node
         end do
         if (allocated(input%error)) return
      end do
      n_dim = raw%n_dim()
      call connect_elements(mesh, raw, input, n_dim, cell_of)
      if (allocated(input%error)) return
      call place_nodes(mesh, raw, input, n_dim, renumbering%node)
      if (allocated(input%error)) return
      call turn_elements(mesh, raw, input, cell_of)
      if (allocated(input%error)) return
      call check_neighbors(mesh, raw, input, cell_of, table, incoming)
      if (allocated(input%error)) return
      call number_pieces(mesh, piece, n_pieces)
      mesh%has_pieces = n_pieces > 1
      if (n_dim == 2) call warn_of_slits(mesh, table, incoming)
      allocate (renumbering%element(raw%cell_tag%n), source=0)
      renumbering%element(cell_of) = [(element, element=1, mesh%n_elements)]
      call name_sets(mesh, raw, input, table, renumbering)
      if (n_dim == 2) mesh%hypothesis = raw%hypothesis
      if (allocated(raw%warning)) call mesh%warnings%add(raw%warning)
   end subroutine new_clean_mesh

   !> Refuses numbers of nodes or of cells that are not positive or given twice.
   pure subroutine check_tags(input, thing, tags, places)
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: thing !! noun for the items, for messages
      integer, intent(in) :: tags(:) !! their numbers
      integer, intent(in) :: places(:) !! positions of their definitions in the file
      type(tag_map_t) :: map
      integer :: item

      item = findloc(tags < 1, .true., dim=1)
      if (item > 0) call input%refuse(thing//' '//to_text(tags(item))//': its number must be positive', places(item))
      if (allocated(input%error)) return
      call new_tag_map(map, tags)
      item = map%repeated()
      if (item > 0) call input%refuse(thing//' '//to_text(tags(item))//' is given a second time', places(item))
   end subroutine check_tags

   !> Refuses a cell of the mesh file, at its place in the file.
   pure subroutine refuse_cell(input, raw, cell, sentence)
      type(input_file_t), intent(inout) :: input !! the file
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      integer, intent(in) :: cell !! the cell
      character(*), intent(in) :: sentence !! what is wrong with it, behind its number

      call input%refuse('element '//to_text(raw%cell_tag%item(cell))//' '//sentence, raw%cell_place%item(cell))
   end subroutine refuse_cell

   !> Makes elements of the cells of the highest dimension; their nodes are still indices in the list of the raw mesh. A
   !> quadrilateral of which one side has a single node is a triangle.
   pure subroutine connect_elements(mesh, raw, input, n_dim, cell_of)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n_dim !! number of dimensions
      integer, allocatable, intent(out) :: cell_of(:) !! cell of each element (n_elements)
      integer, allocatable :: nodes(:)
      integer :: cell, element, first, i, kind, n, n_collapsed, side

      cell_of = pack([(cell, cell=1, raw%cell_tag%n)], cell_dimension(raw%cell_kind%items()) == n_dim)
      mesh%n_elements = size(cell_of)
      if (mesh%n_elements == 0) call input%refuse( &
         'the file holds no triangles, quadrilaterals, tetrahedra or hexahedra', len(input%text))
      mesh%element_kind = raw%cell_kind%item(cell_of)
      allocate (mesh%node_start(mesh%n_elements + 1), mesh%node(sum(n_element_nodes(mesh%element_kind))))
      n = 0
      n_collapsed = 0
      do element = 1, mesh%n_elements
         kind = mesh%element_kind(element)
         first = raw%cell_start%item(cell_of(element))
         nodes = raw%node%item(first:first + n_element_nodes(kind) - 1)
         side = 0
         if (kind == quad4 .or. kind == quad8) side = findloc(nodes(:4) == cshift(nodes(:4), 1), .true., dim=1)
         if (side > 0) then
            ! The node in the middle of this side is the same, too.
            if (all(nodes(4 + side:size(nodes):4) == nodes(side))) then
               n_collapsed = n_collapsed + 1
               nodes = pack(nodes, [(mod(i - side, 4) /= 0, i=1, size(nodes))])
               mesh%element_kind(element) = merge(tri3, tri6, kind == quad4)
            end if
         end if
         do i = 2, size(nodes)
            if (any(nodes(:i - 1) == nodes(i))) call refuse_cell(input, raw, cell_of(element), 'names node '// &
               to_text(raw%node_tag%item(nodes(i)))//' twice')
         end do
         mesh%node_start(element) = n + 1
         mesh%node(n + 1:n + size(nodes)) = nodes
         n = n + size(nodes)
      end do
      mesh%node_start(mesh%n_elements + 1) = n + 1
      mesh%node = mesh%node(:n)
      if (n_collapsed > 0) call raw%add_note(counted(n_collapsed, 'quadrilateral')// &
         ' with two corners at one node read as a triangle')
   end subroutine connect_elements

   !> Keeps the nodes of elements. Refuses coordinates that are out of range or, without solid elements, outside of the
   !> plane z = constant of the first node.
   pure subroutine place_nodes(mesh, raw, input, n_dim, node_of)
      type(mesh_t), intent(inout) :: mesh !! the mesh, its elements connected; they get the mesh's node numbers
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n_dim !! number of dimensions
      integer, allocatable, intent(out) :: node_of(:) !! node of the mesh of each node of the raw mesh, 0 for none
      integer, allocatable :: kept(:)
      real(dp) :: lowest(3), highest(3), x(3), allowed
      integer :: i, node

      allocate (node_of(raw%node_tag%n), source=0)
      node_of(mesh%node) = 1
      kept = pack([(node, node=1, size(node_of))], node_of > 0)
      mesh%n_nodes = size(kept)
      if (mesh%n_nodes < size(node_of)) call raw%add_note( &
         counted(size(node_of) - mesh%n_nodes, 'node')//' without an element left out')
      node_of(kept) = [(node, node=1, mesh%n_nodes)]
      mesh%node = node_of(mesh%node)
      mesh%coordinates = raw%coordinates(:n_dim, kept)
      mesh%node_tag = raw%node_tag%item(kept)
      lowest = largest_coordinate
      highest = -largest_coordinate
      do i = 1, size(kept)
         x = raw%coordinates(:, kept(i))
         if (any(abs(x) > largest_coordinate)) call input%refuse('the coordinates of node '// &
            to_text(mesh%node_tag(i))//' are out of range', raw%node_place%item(kept(i)))
         if (allocated(input%error)) return
         lowest = min(lowest, x)
         highest = max(highest, x)
      end do
      allowed = input_rounding*maxval(highest(:2) - lowest(:2))
      if (n_dim == 3 .or. highest(3) - lowest(3) <= allowed) return
      node = findloc(abs(raw%coordinates(3, kept) - raw%coordinates(3, kept(1))) > 0.5_dp*allowed, .true., dim=1)
      call input%refuse('node '//to_text(mesh%node_tag(node))//' lies at z = '// &
         to_text(raw%coordinates(3, kept(node)))//', node '//to_text(mesh%node_tag(1))//' at z = '// &
         to_text(raw%coordinates(3, kept(1)))//': the body must lie in a plane z = constant, unless it has '// &
         'tetrahedra or hexahedra', &
         raw%node_place%item(kept(node)))
   end subroutine place_nodes

   !> Reverses elements that are given the other way round; refuses those whose map from the reference element is not
   !> one to one.
   pure subroutine turn_elements(mesh, raw, input, cell_of)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: cell_of(:) !! cell of each element (n_elements)
      ! The nodes of each shape in the other order round the first corner.
      integer, parameter :: triangle(*) = [1, 3, 2, 6, 5, 4], quadrilateral(*) = [1, 4, 3, 2, 8, 7, 6, 5, 9], &
         tetrahedron(*) = [1, 3, 2, 4, 7, 6, 5, 8, 10, 9], hexahedron(*) = [1, 4, 3, 2, 5, 8, 7, 6, 12, 11, 10, 9, 16, &
         15, 14, 13, 17, 20, 19, 18]
      character(:), allocatable :: shape
      type(jacobian_reference_t), allocatable :: reference(:)
      integer :: element, kind, n_dim, n_turned

      n_dim = size(mesh%coordinates, 1)
      n_turned = 0
      call new_jacobian_references(reference, mesh)
      do element = 1, mesh%n_elements
         kind = mesh%element_kind(element)
         if (jacobian_determinant(mesh, element, mapped_square(kind, spread(0.5_dp, 1, n_dim))) < 0.0_dp) then
            n_turned = n_turned + 1
            associate (nodes => mesh%node(mesh%node_start(element):mesh%node_start(element + 1) - 1))
               select case (corner_kind(kind))
               case (tri3)
                  nodes = nodes(triangle(:size(nodes)))
               case (quad4)
                  nodes = nodes(quadrilateral(:size(nodes)))
               case (tet4)
                  nodes = nodes(tetrahedron(:size(nodes)))
               case default
                  nodes = nodes(hexahedron(:size(nodes)))
               end select
            end associate
         end if
         if (.not. mesh%is_turned_over(element, reference)) cycle
         shape = ': its corners must go round a convex area'
         if (is_solid(kind)) shape = ': its corners must be those of a convex solid, in the order of its type'
         if (n_corners(kind) == n_element_nodes(kind)) then
            shape = 'is degenerate'//shape
         else
            shape = 'is folded'//shape//', and the nodes in the middle of its sides lie near the middle'
            if (is_solid(kind)) shape = shape//'; Gmsh mends most by Mesh.HighOrderOptimize = 2'
         end if
         call refuse_cell(input, raw, cell_of(element), shape)
         return
      end do
      if (n_turned > 0) call raw%add_note(counted(n_turned, trim(merge('left-handed', 'clockwise  ', &
         n_dim == 3))//' element')//' turned round')
   end subroutine turn_elements

   !> Refuses overlapping elements, hanging nodes, and neighbors with different nodes in the middle of their common
   !> side. At a hanging node shorter sides lead from one end of an element's side to the other along it; a slit, with
   !> nodes on both faces, is no hanging node, nor is its tip. In space, hanging nodes are not looked for.
   pure subroutine check_neighbors(mesh, raw, input, cell_of, table, incoming)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: cell_of(:) !! cell of each element (n_elements)
      type(side_table_t), intent(out) :: table !! the sides of the elements
      type(incoming_sides_t), intent(out) :: incoming !! those of the boundary
      integer, allocatable :: one(:), other(:)
      integer :: elements(2), i, n_lines, node, number, numbers(2), overlapping(2), side

      call new_side_table(table, mesh, overlapping)
      if (overlapping(1) > 0) then
         call refuse_cell(input, raw, cell_of(overlapping(2)), 'lies over element '// &
            to_text(raw%cell_tag%item(cell_of(overlapping(1)))))
         return
      end if
      allocate (incoming%start(table%n_sides), incoming%before(table%n_sides), source=0)
      allocate (incoming%last(mesh%n_nodes), source=0)
      n_lines = merge(table%n_sides, 0, size(mesh%coordinates, 1) == 2)
      do side = 1, n_lines
         number = table%boundary(side)
         if (number == 0) cycle
         one = mesh%side(side_element(number), side_place(number))
         incoming%start(side) = one(1)
         incoming%before(side) = incoming%last(one(2))
         incoming%last(one(2)) = side
      end do
      do side = 1, n_lines
         number = table%boundary(side)
         if (number == 0) cycle
         one = mesh%side(side_element(number), side_place(number))
         call follow_sides(incoming, mesh%coordinates, one(1), one(2), node)
         if (node == 0) cycle
         call refuse_cell(input, raw, cell_of(side_element(number)), 'has a hanging node in one of its sides, at '// &
            to_text(mesh%coordinates(1, node))//', '//to_text(mesh%coordinates(2, node))// &
            ': neighbors must share whole sides')
         return
      end do
      if (all(n_element_nodes(mesh%element_kind) == n_corners(mesh%element_kind))) return
      do side = 1, table%n_sides
         if (table%boundary(side) > 0) cycle
         numbers = [table%sides(side)%left, table%sides(side)%right]
         one = mesh%side(side_element(numbers(1)), side_place(numbers(1)))
         other = mesh%side(side_element(numbers(2)), side_place(numbers(2)))
         if (count(one > 0) == count(other > 0) .and. all([(any(other == one(i)), i=1, size(one))])) cycle
         elements = side_element([minval(numbers), maxval(numbers)])
         call refuse_cell(input, raw, cell_of(elements(2)), 'shares a side with element '// &
            to_text(raw%cell_tag%item(cell_of(elements(1))))//' but not the node in its middle')
         return
      end do
   end subroutine check_neighbors

   !> Makes the named sets of a mesh from the groups of a raw mesh. Faults are recorded in the input, notes in the raw
   !> mesh.
   subroutine name_sets(mesh, raw, input, table, renumbering)
      type(mesh_t), intent(inout) :: mesh !! the mesh, complete but for its sets
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      type(side_table_t), intent(in) :: table !! the sides of the elements
      type(renumbering_t), intent(in) :: renumbering !! from the raw mesh to the mesh
      type(named_set_t), allocatable :: sets(:), node_sets(:), regions(:)
      type(group_members_t) :: members
      character(:), allocatable :: label
      integer :: group, n_sets, n_node_sets, n_regions

      allocate (members%sides%stamp(sides_per_element*mesh%n_elements), members%nodes%stamp(mesh%n_nodes), &
         members%elements%stamp(mesh%n_elements), members%of_cell(raw%cell_tag%n), source=0)
      allocate (sets(raw%n_groups), node_sets(raw%n_groups), regions(raw%n_groups))
      n_sets = 0
      n_node_sets = 0
      n_regions = 0
      do group = 1, raw%n_groups
         members%sides%list%n = 0
         members%nodes%list%n = 0
         members%elements%list%n = 0
         members%n_inside = 0
         members%n_elsewhere = 0
         members%n_unused = 0
         call collect_cells(members, mesh, raw, input, table, renumbering, group)
         call collect_nodes(members, mesh, raw, input, table, renumbering, group)
         if (allocated(input%error)) return
         call refuse_lost(raw, input, group, members)
         if (allocated(input%error)) return
         associate (sides => members%sides%list%items())
            ! A set inside the body is one without sides, so that its name is known.
            if (size(sides) > 0 .or. (members%n_inside > 0 .and. members%nodes%list%n == 0)) then
               n_sets = n_sets + 1
               sets(n_sets)%name = raw%groups(group)%name
               sets(n_sets)%element = side_element(sides)
               sets(n_sets)%side = side_place(sides)
            end if
         end associate
         if (members%nodes%list%n > 0) then
            n_node_sets = n_node_sets + 1
            node_sets(n_node_sets)%name = raw%groups(group)%name
            node_sets(n_node_sets)%node = members%nodes%list%items()
         end if
         if (members%elements%list%n > 0) then
            n_regions = n_regions + 1
            regions(n_regions)%name = raw%groups(group)%name
            regions(n_regions)%element = members%elements%list%items()
         end if
         label = "set '"//raw%groups(group)%name//"'"
         associate (left_out => [members%n_inside, members%n_elsewhere, members%n_unused])
            if (left_out(1) > 0) call raw%add_note(label//': '//counted(left_out(1), 'side')// &
               ' inside the body left out')
            if (left_out(2) > 0) call raw%add_note(label//': '//counted(left_out(2), noun_of_sides(raw))// &
               ' without an element left out')
            if (left_out(3) > 0) call raw%add_note(label//': '//counted(left_out(3), 'node')// &
               ' without an element left out')
            if (members%sides%list%n + members%nodes%list%n + members%elements%list%n + sum(left_out) == 0) then
               call raw%add_note(label//' left out: it is empty')
            end if
         end associate
      end do
      allocate (mesh%sets, source=sets(:n_sets))
      if (n_node_sets > 0) allocate (mesh%node_sets, source=node_sets(:n_node_sets))
      if (n_regions > 0) allocate (mesh%regions, source=regions(:n_regions))
   end subroutine name_sets

   !> Refuses loads of the file of which a part would be left out, and supports that hold nothing.
   pure subroutine refuse_lost(raw, input, group, members)
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: group !! number of the group
      type(group_members_t), intent(in) :: members !! its members in the mesh
      character(*), parameter :: cure = ': points of reference of *RIGID BODY, *COUPLING and *PRE-TENSION SECTION '// &
         'become &rigid and &preload in the deck, with their forces and supports'
      character(:), allocatable :: what
      logical :: is_empty
      integer :: i

      is_empty = members%nodes%list%n + members%sides%list%n == 0
      what = ''
      if (is_empty .or. members%n_unused > 0) what = counted(max(1, members%n_unused), 'node')// &
         ' of no element cannot be used'//cure
      if (members%n_elsewhere > 0) what = counted(members%n_elsewhere, noun_of_sides(raw))// &
         ' of no element cannot be used'
      if (members%n_inside > 0) what = counted(members%n_inside, 'side')//' inside the body, between two elements, '// &
         'cannot be used'
      if (what == '') return
      associate (model => raw%model, name => raw%groups(group)%name)
         do i = 1, model%n_conditions
            associate (given => model%conditions(i))
               if (given%is_ended .or. given%load%set /= name .or. (any(given%is_held) .and. .not. is_empty)) cycle
               if (.not. allocated(input%error)) call new_error(input%error, input_refused, given%load%origin// &
                  trim(merge('a support of', 'a load on   ', any(given%is_held)))//' '//what)
            end associate
         end do
      end associate
   end subroutine refuse_lost

   !> Collects the mesh entities of a group's cells and sides of cells. Sides are found by their corners, whatever their
   !> direction; cells below the dimension of sides name their nodes.
   subroutine collect_cells(members, mesh, raw, input, table, renumbering, group)
      type(group_members_t), intent(inout) :: members !! the members of the group; gains those
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      type(side_table_t), intent(in) :: table !! the sides of the elements
      type(renumbering_t), intent(in) :: renumbering !! from the raw mesh to the mesh
      integer, intent(in) :: group !! number of the group
      integer, allocatable :: nodes(:), on_side(:)
      integer :: cell, i, k, kind, left, n, right, side

      do i = 1, raw%groups(group)%cell%n
         cell = raw%groups(group)%cell%item(i)
         side = raw%groups(group)%side%item(i)
         kind = raw%cell_kind%item(cell)
         if (side == 0) then
            if (renumbering%element(cell) > 0) call members%elements%put(renumbering%element(cell), group)
            if (renumbering%element(cell) > 0 .or. members%of_cell(cell) == group) cycle
            members%of_cell(cell) = group
            nodes = [(k, k=1, n_cell_nodes(kind))]
            n = 2
            if (cell_dimension(kind) == 2) n = n_corners(kind)
         else
            n = n_side_corners(kind)
            nodes = side_nodes(kind, side)
            nodes = pack(nodes, nodes > 0)
         end if
         nodes = renumbering%node(raw%node%item(raw%cell_start%item(cell) - 1 + nodes))
         if (side == 0 .and. cell_dimension(kind) < size(mesh%coordinates, 1) - 1) then
            do k = 1, size(nodes)
               call put_node(members, nodes(k), group)
            end do
            cycle
         end if
         ! The side of a quadrilateral that is a triangle.
         if (nodes(1) == nodes(2)) cycle
         call find_side(table, nodes, n, left, right)
         if (min(left, right) > 0) then
            members%n_inside = members%n_inside + 1
         else if (max(left, right) == 0) then
            members%n_elsewhere = members%n_elsewhere + 1
         else
            call members%sides%put(max(left, right), group)
            on_side = mesh%side(side_element(max(left, right)), side_place(max(left, right)))
            if (count(on_side > 0) == size(nodes) .and. any([(all(on_side /= nodes(k)), k=1, size(nodes))])) call &
               input%refuse(noun_of_sides(raw)//' '//to_text(raw%cell_tag%item(cell))// &
               ' has another middle node than the element at its side', raw%cell_place%item(cell))
         end if
      end do
   end subroutine collect_cells

   !> What a cell is called that is a side of elements.
   pure function noun_of_sides(raw) result(noun)
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      character(4) :: noun

      noun = merge('face', 'line', raw%n_dim() == 3)
   end function noun_of_sides

   !> Finds the sides of elements on both sides of a line or face.
   pure subroutine find_side(table, nodes, n, left, right)
      type(side_table_t), intent(in) :: table !! the sides of the elements
      integer, intent(inout) :: nodes(:) !! its nodes; on return the corners are the first
      integer, intent(in) :: n !! number of its corners
      integer, intent(out) :: left !! number of the side of the element on the left, 0 for none
      integer, intent(out) :: right !! number of the side of the element on the right, 0 for none

      left = 0
      right = 0
      if (all(nodes(:n) > 0)) call table%find(nodes(:n), left, right)
      if (n > 2 .or. size(nodes) /= 3 .or. max(left, right) > 0) return
      ! Some programs give the middle second.
      nodes = nodes([1, 3, 2])
      if (all(nodes(:n) > 0)) call table%find(nodes(:n), left, right)
   end subroutine find_side

   !> Collects the nodes of a group and, if the group names no sides otherwise, the boundary sides between these nodes.
   subroutine collect_nodes(members, mesh, raw, input, table, renumbering, group)
      type(group_members_t), intent(inout) :: members !! the members of the group, its cells taken; gains those
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      type(side_table_t), intent(in) :: table !! the sides of the elements
      type(renumbering_t), intent(in) :: renumbering !! from the raw mesh to the mesh
      integer, intent(in) :: group !! number of the group
      integer, allocatable :: nodes(:)
      integer :: i, node, number, place

      do i = 1, raw%groups(group)%node%n
         node = renumbering%place%find(raw%groups(group)%node%item(i))
         if (node == 0) call input%refuse("the set '"//raw%groups(group)%name//"' names node "// &
            to_text(raw%groups(group)%node%item(i))//', which the file does not give', raw%groups(group)%place)
         if (allocated(input%error)) return
         call put_node(members, renumbering%node(node), group)
      end do
      if (.not. raw%nodes_name_sides .or. members%sides%list%n + members%n_inside > 0) return
      do i = 1, members%nodes%list%n
         place = table%last(members%nodes%list%item(i))
         do while (place > 0)
            number = table%boundary(place)
            place = table%sides(place)%before
            if (number == 0) cycle
            nodes = mesh%side(side_element(number), side_place(number))
            if (all(members%nodes%stamp(pack(nodes, nodes > 0)) == group)) call members%sides%put(number, group)
         end do
      end do
   end subroutine collect_nodes

   !> Adds a node to a group, if the node belongs to an element.
   subroutine put_node(members, node, group)
      type(group_members_t), intent(inout) :: members !! the members of the group
      integer, intent(in) :: node !! the node, 0 for one that no element has
      integer, intent(in) :: group !! number of the group

      if (node > 0) call members%nodes%put(node, group)
      if (node == 0) members%n_unused = members%n_unused + 1
   end subroutine put_node

   !> Adds a member to a set that is being collected, unless it is there already.
   pure subroutine collection_put(self, thing, set)
      class(collection_t), intent(inout) :: self !! the things of the set
      integer, intent(in) :: thing !! the thing
      integer, intent(in) :: set !! number of the set

      if (self%stamp(thing) == set) return
      self%stamp(thing) = set
      call self%list%append(thing)
   end subroutine collection_put

end module amontons_mesh_cleanup
