!> The contents of a mesh file before they are checked: nodes and cells by their numbers in the file, and beside the
!> mesh materials, supports and loads; and the named sets of a mesh that the file's groups become: boundary sets, sets
!> of nodes, regions.
module amontons_file_model
   use amontons_element, only: n_corners, n_element_nodes
   use amontons_input_file, only: input_file_t, printable
   use amontons_integer_list, only: integer_list_t, tag_map_t
   use amontons_kinds, only: dp
   use amontons_mesh, only: boundary_set_t, mesh_t, node_set_t, region_t, side_element, side_place, side_table_t, &
      sides_per_element
   use amontons_text, only: counted, lower_case, newline, to_text
   implicit none (type, external)
   private

   public :: file_load_t, file_material_t, file_model_t, file_support_t, file_temperatures_t, line2, line3, &
      longest_name, n_cell_nodes, name_sets, no_cell, point1, raw_group_t, raw_mesh_t, renumbering_t

   !> What may be read of it, as a deck names it.
   character(9), parameter, public :: use_names(3) = [character(9) :: 'materials', 'supports', 'loads']
   !> Which of these are the materials.
   integer, parameter, public :: use_materials = 1
   !> Which of these are the supports.
   integer, parameter, public :: use_supports = 2
   !> Which of these are the loads.
   integer, parameter, public :: use_loads = 3

   !> Kind of a load: pressure on sides.
   integer, parameter, public :: file_pressure = 1
   !> Kind of a load: force on nodes.
   integer, parameter, public :: file_force = 2
   !> Kind of a load: force per volume.
   integer, parameter, public :: file_body_force = 3
   !> Kind of a load: weight.
   integer, parameter, public :: file_gravity = 4
   !> Kind of a load: centrifugal force.
   integer, parameter, public :: file_rotation = 5

   !> Longest name of a set or material, as Abaqus has it.
   integer, parameter :: longest_name = 80

   !> A material of a region.
   type :: file_material_t
      character(longest_name) :: name = '' !! its name
      character(longest_name) :: region = '' !! region that it fills; empty before a section says it
      real(dp) :: young = 0.0_dp !! Young's modulus; 0 if it is not given [F/L^2]
      real(dp) :: poisson = 0.0_dp !! Poisson's ratio [-]
      real(dp) :: density = 0.0_dp !! mass per volume [M/L^3]
      real(dp) :: expansion = 0.0_dp !! coefficient of thermal expansion [1/K]
      real(dp) :: thickness = 1.0_dp !! thickness of the region [L]
      integer :: line = 0 !! line of the file that specifies it
   end type file_material_t

   !> Displacements that are prescribed to a set of nodes.
   type :: file_support_t
      character(longest_name) :: set = '' !! name of the set
      logical :: is_held(2) = .false. !! whether it is held along x and y
      real(dp) :: value = 0.0_dp !! displacement along these [L]
      integer :: line = 0 !! line of the file that specifies it
   end type file_support_t

   !> A load.
   type :: file_load_t
      integer :: kind = file_pressure !! its kind
      character(longest_name) :: set = '' !! the set of sides or nodes, or the region; empty for the whole body
      real(dp) :: value(2) = 0.0_dp
         !! pressure [F/L^2], force [F], force per volume [F/L^3], acceleration [L/T^2], or angular speed [1/T]
      real(dp) :: center(2) = 0.0_dp !! a point of the axis of rotation [L]
      real(dp) :: axis(2) = 0.0_dp !! its direction in the plane; 0, 0 if it is normal to the plane [-]
      integer :: line = 0 !! line of the file that specifies it
   end type file_load_t

   !> Temperatures of the nodes. Arrays have a place for each node of the file, in its order, as far as it is read.
   type :: file_temperatures_t
      type(tag_map_t) :: map !! places of the nodes by their numbers in the file
      real(dp), allocatable :: initial(:) !! temperatures at which nothing is strained [K]
      real(dp), allocatable :: step(:) !! temperatures of the step [K]
      logical, allocatable :: is_given(:) !! whether the step gives a temperature
      logical :: has_initial = .false. !! whether initial temperatures are given
      integer :: line = 0 !! line of the file that gives those of the step; 0 if none does
      real(dp), allocatable :: table(:, :)
         !! numbers of the nodes and their temperatures above the initial ones; not allocated before the file is read,
         !! nor if it gives none (2, number of nodes) [K]
   end type file_temperatures_t

   !> All that is read beside the mesh.
   type :: file_model_t
      logical :: is_used(size(use_names)) = .false. !! what is read
      character(12) :: hypothesis = '' !! the hypothesis of the elements; empty if they differ or say none
      type(file_material_t), allocatable :: definitions(:) !! the materials that the file defines
      type(file_material_t), allocatable :: materials(:) !! the material of each section
      type(file_support_t), allocatable :: supports(:) !! the supports
      type(file_load_t), allocatable :: loads(:) !! the loads
      type(file_temperatures_t) :: temperatures !! the temperatures of the nodes
      integer :: n_supports = 0 !! number of supports; there may be room for more
      integer :: n_loads = 0 !! number of loads; there may be room for more
      integer :: n_steps = 0 !! number of steps
      integer, private :: n_counted = 0 !! number of characters of the file whose lines are counted
      integer, private :: n_lines = 0 !! number of line ends among them
   contains
      procedure :: line_at => file_model_line_at
      procedure :: add_load => file_model_add_load
      procedure :: add_support => file_model_add_support
   end type file_model_t

   !> Kind of a cell that is left out.
   integer, parameter :: no_cell = 0
   !> Kind of a cell that is a point; elements have the kinds of `amontons_element`, which are positive.
   integer, parameter :: point1 = -1
   !> Kind of a cell that is a line between two nodes.
   integer, parameter :: line2 = -2
   !> Kind of a cell that is a line between two nodes over a third.
   integer, parameter :: line3 = -3

   !> More named sets are refused: they would only slow down every search for one.
   integer, parameter :: most_groups = 10000
   !> A file may put this many things into sets, and one more for each of its bytes: ranges and sets of sets could
   !> otherwise name more than any memory holds.
   integer, parameter :: free_members = 1000000

   !> How many notes are told; the first ones say enough.
   integer, parameter :: most_notes = 100

   !> A named set: of elements, of lines and sides, of nodes.
   type :: raw_group_t
      character(:), allocatable :: name !! its name
      character(:), allocatable, private :: key !! what tells it from the others: the name, with or without its case
      integer :: place = 0 !! the end of the line that names it first
      type(integer_list_t) :: cell !! its cells, and the cells whose sides are in it
      type(integer_list_t) :: side !! the side of each that is in it, 0 for the cell itself
      type(integer_list_t) :: node !! numbers of its nodes in the file
   end type raw_group_t

   !> The contents of a mesh file.
   type :: raw_mesh_t
      type(integer_list_t) :: node_tag !! number of each node in the file
      type(integer_list_t) :: node_place !! where the file gives it
      real(dp), allocatable :: coordinates(:, :) !! its coordinates (3, at least the number of nodes) [L]
      type(integer_list_t) :: cell_tag !! number of each cell in the file
      type(integer_list_t) :: cell_place !! where the file gives it
      type(integer_list_t) :: cell_kind !! its kind
      type(integer_list_t) :: cell_start !! where its nodes begin in `node`
      type(integer_list_t) :: node !! nodes of the cells, by their numbers in the file
      type(raw_group_t), allocatable :: groups(:) !! the named sets, and room for more
      integer :: n_groups = 0 !! number of named sets
      integer, allocatable, private :: sorted(:) !! the named sets in the order of their keys, and room for more
      integer, private :: n_members = 0 !! number of things in all of them that are not written out
      logical :: ignores_case = .false. !! whether capital letters do not tell names apart
      logical :: nodes_name_sides = .false. !! whether a set of nodes also names the boundary sides between them
      character(12) :: hypothesis = '' !! the hypothesis that the elements are of; empty if the file says none
      type(file_model_t) :: model !! what is read beside the mesh
      character(:), allocatable :: warning !! what the file says that matters and is not read; not allocated if nothing
      integer, private :: n_notes = 0 !! number of notes
      character(:), allocatable :: notes !! what was put right or left out, a line of text for each
   contains
      procedure :: add_cell => raw_mesh_add_cell
      procedure :: add_note => raw_mesh_add_note
      procedure :: add_node => raw_mesh_add_node
      procedure :: expect_members => raw_mesh_expect_members
      procedure :: find_group => raw_mesh_find_group
      procedure :: get_group => raw_mesh_get_group
   end type raw_mesh_t

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

   !> Number of the line of a place in the file. Places must not descend.
   pure subroutine file_model_line_at(self, text, place, line)
      class(file_model_t), intent(inout) :: self !! the model, which remembers how far lines are counted
      character(*), intent(in) :: text !! the whole file
      integer, intent(in) :: place !! the place
      integer, intent(out) :: line !! number of its line
      integer :: i

      do i = self%n_counted + 1, place - 1
         if (text(i:i) == achar(10)) self%n_lines = self%n_lines + 1
      end do
      self%n_counted = max(self%n_counted, place - 1)
      line = self%n_lines + 1
   end subroutine file_model_line_at

   !> Adds a support.
   pure subroutine file_model_add_support(self, support)
      class(file_model_t), intent(inout) :: self !! the model
      type(file_support_t), intent(in) :: support !! the support

      if (.not. allocated(self%supports)) allocate (self%supports(4))
      if (self%n_supports == size(self%supports)) self%supports = [self%supports, self%supports]
      self%n_supports = self%n_supports + 1
      self%supports(self%n_supports) = support
   end subroutine file_model_add_support

   !> Adds a load.
   pure subroutine file_model_add_load(self, load)
      class(file_model_t), intent(inout) :: self !! the model
      type(file_load_t), intent(in) :: load !! the load

      if (.not. allocated(self%loads)) allocate (self%loads(4))
      if (self%n_loads == size(self%loads)) self%loads = [self%loads, self%loads]
      self%n_loads = self%n_loads + 1
      self%loads(self%n_loads) = load
   end subroutine file_model_add_load

   !> Number of nodes of a kind of cell.
   elemental integer function n_cell_nodes(kind)
      integer, intent(in) :: kind !! the kind

      n_cell_nodes = -kind
      if (kind > 0) n_cell_nodes = n_element_nodes(kind)
   end function n_cell_nodes

   !> Adds a note; the same note again is not another one.
   pure subroutine raw_mesh_add_note(self, sentence)
      class(raw_mesh_t), intent(inout) :: self !! the raw mesh
      character(*), intent(in) :: sentence !! what was put right or left out

      if (.not. allocated(self%notes)) then
         self%notes = printable(sentence)
      else if (self%n_notes == most_notes) then
         self%notes = self%notes//newline//'there is more to note'
      else if (self%n_notes < most_notes) then
         if (index(self%notes, printable(sentence)) > 0) return
         self%notes = self%notes//newline//printable(sentence)
      end if
      self%n_notes = self%n_notes + 1
   end subroutine raw_mesh_add_note

   !> Adds a node.
   pure subroutine raw_mesh_add_node(self, tag, place, coordinates)
      class(raw_mesh_t), intent(inout) :: self !! the raw mesh
      integer, intent(in) :: tag !! its number in the file
      integer, intent(in) :: place !! where the file gives it
      real(dp), intent(in) :: coordinates(3) !! its coordinates [L]
      integer, parameter :: least_room = 16
      real(dp), allocatable :: longer(:, :)
      integer :: n

      n = self%node_tag%n
      if (.not. allocated(self%coordinates)) then
         allocate (self%coordinates(3, least_room))
      else if (n == size(self%coordinates, 2)) then
         allocate (longer(3, n + n/2 + least_room))
         longer(:, :n) = self%coordinates
         call move_alloc(longer, self%coordinates)
      end if
      self%coordinates(:, n + 1) = coordinates
      call self%node_tag%append(tag)
      call self%node_place%append(place)
   end subroutine raw_mesh_add_node

   !> Adds a cell.
   pure subroutine raw_mesh_add_cell(self, kind, tag, place, nodes)
      class(raw_mesh_t), intent(inout) :: self !! the raw mesh
      integer, intent(in) :: kind !! its kind
      integer, intent(in) :: tag !! its number in the file
      integer, intent(in) :: place !! where the file gives it
      integer, intent(in) :: nodes(:) !! its nodes, by their numbers in the file

      call self%cell_kind%append(kind)
      call self%cell_tag%append(tag)
      call self%cell_place%append(place)
      call self%cell_start%append(self%node%n + 1)
      call self%node%append_all(nodes)
   end subroutine raw_mesh_add_cell

   !> What tells a name from others.
   pure function key_of(raw, name) result(key)
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      character(*), intent(in) :: name !! the name
      character(:), allocatable :: key

      key = name
      if (raw%ignores_case) key = lower_case(name)
   end function key_of

   !> Place in the sorted list of the first named set whose key is not before a given one.
   pure integer function place_of(raw, key) result(place)
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      character(*), intent(in) :: key !! the key
      integer :: low, middle

      low = 0
      place = raw%n_groups + 1
      do while (place - low > 1)
         middle = (low + place)/2
         if (raw%groups(raw%sorted(middle))%key < key) then
            low = middle
         else
            place = middle
         end if
      end do
   end function place_of

   !> The named set of a name, 0 where there is none.
   pure integer function raw_mesh_find_group(self, name) result(group)
      class(raw_mesh_t), intent(in) :: self !! the raw mesh
      character(*), intent(in) :: name !! the name
      character(:), allocatable :: key
      integer :: place

      group = 0
      key = key_of(self, name)
      place = place_of(self, key)
      if (place > self%n_groups) return
      if (self%groups(self%sorted(place))%key == key) group = self%sorted(place)
   end function raw_mesh_find_group

   !> The named set of a name; a new one where there is none.
   pure subroutine raw_mesh_get_group(self, input, name, group)
      class(raw_mesh_t), intent(inout) :: self !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: name !! the name
      integer, intent(out) :: group !! the set
      integer :: place

      if (.not. allocated(self%groups)) allocate (self%groups(most_groups), self%sorted(most_groups))
      group = self%find_group(name)
      if (group > 0) return
      if (printable(name) /= name) call input%refuse("the name '"//name//"' holds a control character", &
         input%position - 1)
      if (self%n_groups == most_groups) then
         call input%refuse('more than '//to_text(most_groups)//' named sets', input%position - 1)
         group = most_groups
         return
      end if
      place = place_of(self, key_of(self, name))
      self%sorted(place + 1:self%n_groups + 1) = self%sorted(place:self%n_groups)
      self%n_groups = self%n_groups + 1
      group = self%n_groups
      self%sorted(place) = group
      self%groups(group)%name = name
      self%groups(group)%key = key_of(self, name)
      self%groups(group)%place = input%position - 1
   end subroutine raw_mesh_get_group

   !> Must be asked before sets get things that are not all written out: a range or another set. Refuses more than a
   !> file of this length may name.
   pure subroutine raw_mesh_expect_members(self, input, n_more)
      class(raw_mesh_t), intent(inout) :: self !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: n_more !! number of things to come

      if (n_more > free_members + len(input%text) - self%n_members) then
         call input%refuse('the sets have more members than a file of this size can define')
      else
         self%n_members = self%n_members + n_more
      end if
   end subroutine raw_mesh_expect_members

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
      character(:), allocatable :: label
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
         label = "set '"//raw%groups(group)%name//"'"
         if (things%n_inside > 0) call raw%add_note(label//': '//counted(things%n_inside, 'side')// &
            ' inside the body left out')
         if (things%n_elsewhere > 0) call raw%add_note(label//': '//counted(things%n_elsewhere, 'line')// &
            ' without an element left out')
         if (things%n_unused > 0) call raw%add_note(label//': '//counted(things%n_unused, 'node')// &
            ' without an element left out')
         if (things%sides%members%n + things%nodes%members%n + things%elements%members%n &
            + things%n_inside + things%n_elsewhere + things%n_unused == 0) call raw%add_note( &
            label//' left out: it is empty')
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
      integer :: i, cell, node, nodes(3), number, place

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
         ! The boundary sides all of whose nodes are in the set.
         do i = 1, things%nodes%members%n
            place = table%last(things%nodes%members%item(i))
            do while (place > 0)
               number = table%boundary(place)
               place = table%sides(place)%before
               if (number == 0) cycle
               nodes = mesh%side(side_element(number), side_place(number))
               if (nodes(3) == 0) nodes(3) = nodes(1)
               if (all(things%nodes%stamp(nodes) == things%nodes%set)) call things%sides%put(number)
            end do
         end do
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
      integer, allocatable :: nodes(:)
      integer :: left, right, side(3)

      associate (first => raw%cell_start%item(cell))
         nodes = renumbering%node(raw%node%item(first:first + n_cell_nodes(raw%cell_kind%item(cell)) - 1))
      end associate
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
   end subroutine put_line

end module amontons_file_model
