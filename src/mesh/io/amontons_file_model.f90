!> The raw contents of a mesh file: nodes and cells with their numbers in the file, and materials, supports and loads.
module amontons_file_model
   use amontons_constraints, only: support_t
   use amontons_element, only: is_solid, n_element_nodes
   use amontons_input_file, only: input_file_t, printable
   use amontons_integer_list, only: integer_list_t, tag_map_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t
   use amontons_material, only: material_t
   use amontons_text, only: lower_case, newline, to_text
   implicit none (type, external)
   private

   public :: cell_dimension, file_condition_t, file_contact_t, file_material_t, file_model_t, file_part_t, &
      file_temperatures_t, identity, line2, line3, longest_name, n_cell_nodes, no_cell, point1, raw_mesh_t

   !> Parts of the model that may be read, as a deck names them.
   character(9), parameter, public :: use_names(4) = [character(9) :: 'materials', 'supports', 'loads', &
      'contact']
   !> Index of the materials in `use_names`.
   integer, parameter, public :: use_materials = 1
   !> Index of the supports in `use_names`.
   integer, parameter, public :: use_supports = 2
   !> Index of the loads in `use_names`.
   integer, parameter, public :: use_loads = 3
   !> Index of contact pairs and ties in `use_names`.
   integer, parameter, public :: use_contact = 4

   !> Largest length of the name of a set or material, as in Abaqus.
   integer, parameter :: longest_name = 80

   !> A material that a file defines, a section that assigns one to a region, or an orientation of axes.
   type :: file_material_t
      character(longest_name) :: name = '' !! name of the material or orientation
      type(material_t) :: material !! its constants; of a section region, thickness and axes; of an orientation the axes
      integer :: place = 0 !! position of the section in the file
   end type file_material_t

   !> Temperatures of the nodes. Each node of the file read so far has a column.
   type :: file_temperatures_t
      type(tag_map_t) :: map !! places of the nodes by their numbers in the file
      real(dp), allocatable :: of_node(:, :)
         !! temperature at which nothing is strained, and that of the step, huge where it gives none (2, nodes) [K]
      logical :: has_initial = .false. !! whether initial temperatures are given
      integer :: n_steps = 0 !! number of steps where OP=NEW was met last
      integer :: place = 0 !! position of those of the step in the file; 0 if it has none
   end type file_temperatures_t

   !> A support or a load on nodes, sides or a region, of one line or of several.
   type :: file_condition_t
      character(:), allocatable :: name !! keyword and kind, as '*dload p' and '*boundary '
      logical :: is_held(3) = .false. !! of a support: the components that are prescribed
      real(dp) :: value = 0.0_dp !! of a support: their displacement; of a load: its first number
      type(load_t) :: load !! the load; of a support its set and origin
      logical :: is_ended = .false. !! whether a later step has ended it
   end type file_condition_t

   !> A pair of surfaces, in contact or bonded, or an interaction that pairs name.
   type :: file_contact_t
      character(longest_name) :: name = '' !! name of the interaction
      character(longest_name) :: set = '' !! name of the slave
      character(longest_name) :: against = '' !! name of the master
      logical :: is_tied = .false. !! whether they are bonded
      real(dp) :: friction = 0.0_dp !! Coulomb's coefficient [-]
      real(dp) :: search = 0.0_dp !! largest distance of the master; 0 for none given [L]
      character(:), allocatable :: origin !! position in the file, as messages begin
   end type file_contact_t

   !> Materials, supports, loads and contact of a mesh file.
   type :: file_model_t
      logical :: is_used(size(use_names)) = .false. !! what is read
      type(file_material_t), allocatable :: definitions(:) !! the materials that the file defines
      type(file_material_t), allocatable :: sections(:) !! the sections
      type(file_material_t), allocatable :: orientations(:) !! the axes of materials
      type(file_temperatures_t) :: temperatures !! the temperatures of the nodes
      type(material_t), allocatable :: materials(:) !! the material of each section, once the file is read
      type(file_condition_t), allocatable :: conditions(:) !! the supports and loads, and room for more
      integer :: n_conditions = 0 !! number of supports and loads
      integer :: n_earlier = 0 !! number of those given before the present step
      type(support_t), allocatable :: supports(:) !! the supports, once the file is read
      type(load_t), allocatable :: loads(:) !! the loads, once the file is read
      type(file_contact_t), allocatable :: interactions(:) !! the interactions of surfaces
      type(file_contact_t), allocatable :: contacts(:) !! pairs and ties; with the friction once the file is read
      integer :: n_steps = 0 !! number of steps
      integer :: step = 0 !! step that is used, with what it keeps of those before; 0 if there is only one
   end type file_model_t

   !> Kind of a cell that is ignored.
   integer, parameter :: no_cell = 0
   !> Kind of a cell that is a point; elements have the kinds of `amontons_element`, which are positive.
   integer, parameter :: point1 = -1
   !> Kind of a cell that is a line between two nodes.
   integer, parameter :: line2 = -2
   !> Kind of a cell that is a line between two nodes over a third.
   integer, parameter :: line3 = -3

   !> Largest number of named sets; more would slow down every search for one.
   integer, parameter :: most_groups = 10000
   !> A file may put as many members into sets as this plus its number of bytes: ranges and sets of sets could otherwise
   !> exceed any memory.
   integer, parameter :: free_members = 1000000

   !> Largest number of notes that are kept.
   integer, parameter :: most_notes = 100

   !> A named set: of elements, of lines and sides, of nodes.
   type :: raw_group_t
      character(:), allocatable :: name !! its name
      integer :: n_scope = 0 !! number of characters of the name that are the name of its instance
      character(:), allocatable, private :: key !! the name for comparisons, in lower case if the format ignores case
      integer :: place = 0 !! the end of the line that names it first
      type(integer_list_t) :: cell !! its cells, and the cells whose sides are in it
      type(integer_list_t) :: side !! the side of each that is in it, 0 for the cell itself
      type(integer_list_t) :: node !! numbers of its nodes in the file
   end type raw_group_t

   !> The rotation of what is not turned.
   real(dp), parameter :: identity(3, 3) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
      1.0_dp], [3, 3])

   !> A part of an Abaqus file, or an instance of one, with its own sets and numbers.
   type :: file_part_t
      character(longest_name) :: name = '' !! its name
      integer :: place = 0 !! where the text of a part begins
      integer :: shift = 0 !! by how much numbers of nodes and elements of an instance are greater than in its text
      real(dp) :: origin(3) = 0.0_dp !! position of the origin of its coordinates [L]
      real(dp) :: rotation(3, 3) = identity !! the rotation of its axes
   end type file_part_t

   !> The contents of a mesh file.
   type :: raw_mesh_t
      type(integer_list_t) :: node_tag !! number of each node in the file
      type(integer_list_t) :: node_place !! position of its definition in the file
      real(dp), allocatable :: coordinates(:, :) !! its coordinates (3, at least the number of nodes) [L]
      type(integer_list_t) :: cell_tag !! number of each cell in the file
      type(integer_list_t) :: cell_place !! position of its definition in the file
      type(integer_list_t) :: cell_kind !! its kind
      type(integer_list_t) :: cell_start !! where its nodes begin in `node`
      type(integer_list_t) :: node !! nodes of the cells, by their numbers in the file
      type(raw_group_t), allocatable :: groups(:) !! the named sets, and room for more
      integer :: n_groups = 0 !! number of named sets
      integer, allocatable, private :: sorted(:) !! the named sets in the order of their keys, and room for more
      integer, private :: n_members = 0 !! number of things in all of them that are not written out
      logical :: ignores_case = .false. !! whether names are compared without regard to case
      logical :: nodes_name_sides = .false. !! whether a set of nodes also names the boundary sides between them
      character(12) :: hypothesis = '' !! the hypothesis of the elements; empty if the file states none
      type(file_model_t) :: model !! materials, supports and loads
      type(file_part_t), allocatable :: parts(:) !! the parts so far
      type(file_part_t), allocatable :: instances(:) !! the instances of parts so far
      logical :: is_in_instance = .false. !! whether the last instance is being read
      integer :: place_behind = 0 !! position in the text after the instance whose part is being read; 0 if none is
      character(:), allocatable :: scope
         !! prefix of the names of sets at this position: that of an instance with a point
      character(:), allocatable :: warning !! warning on relevant contents that are not read, if there are any
      integer, private :: n_notes = 0 !! number of notes
      character(:), allocatable :: notes !! repairs and omissions, a line of text for each
   contains
      procedure :: add_cell => raw_mesh_add_cell
      procedure :: add_note => raw_mesh_add_note
      procedure :: add_node => raw_mesh_add_node
      procedure :: expect_members => raw_mesh_expect_members
      procedure :: find_group => raw_mesh_find_group
      procedure :: get_group => raw_mesh_get_group
      procedure :: n_dim => raw_mesh_n_dim
   end type raw_mesh_t

contains

   !> Number of nodes of a kind of cell.
   elemental integer function n_cell_nodes(kind)
      integer, intent(in) :: kind !! the kind

      n_cell_nodes = -kind
      if (kind > 0) n_cell_nodes = n_element_nodes(kind)
   end function n_cell_nodes

   !> Dimension of a kind of cell: 0 for points, 1 for lines, 2 for plane elements, 3 for solids.
   elemental integer function cell_dimension(kind)
      integer, intent(in) :: kind !! the kind

      cell_dimension = merge(0, 1, kind == point1)
      if (kind > 0) cell_dimension = merge(3, 2, is_solid(kind))
   end function cell_dimension

   !> Number of dimensions of the mesh, 2 or 3. Cells of this dimension are its elements, others name sides and nodes.
   pure integer function raw_mesh_n_dim(self) result(n_dim)
      class(raw_mesh_t), intent(in) :: self !! the raw mesh

      n_dim = max(2, maxval(cell_dimension(self%cell_kind%items())))
   end function raw_mesh_n_dim

   !> Adds a note, unless it is there already.
   pure subroutine raw_mesh_add_note(self, sentence)
      class(raw_mesh_t), intent(inout) :: self !! the raw mesh
      character(*), intent(in) :: sentence !! the repair or omission

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

   !> Adds a node to the mesh as the file has it.
   pure subroutine raw_mesh_add_node(self, tag, place, coordinates)
      class(raw_mesh_t), intent(inout) :: self !! the raw mesh
      integer, intent(in) :: tag !! its number in the file
      integer, intent(in) :: place !! position of its definition in the file
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

   !> Adds a cell to the mesh as the file has it.
   pure subroutine raw_mesh_add_cell(self, kind, tag, place, nodes)
      class(raw_mesh_t), intent(inout) :: self !! the raw mesh
      integer, intent(in) :: kind !! its kind
      integer, intent(in) :: tag !! its number in the file
      integer, intent(in) :: place !! position of its definition in the file
      integer, intent(in) :: nodes(:) !! its nodes, by their numbers in the file

      call self%cell_kind%append(kind)
      call self%cell_tag%append(tag)
      call self%cell_place%append(place)
      call self%cell_start%append(self%node%n + 1)
      call self%node%append_all(nodes)
   end subroutine raw_mesh_add_cell

   !> The key by which named sets are sorted and found: the name, in lower case if the format ignores case.
   pure function key_of(raw, name) result(key)
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      character(*), intent(in) :: name !! the name
      character(:), allocatable :: key

      key = name
      if (raw%ignores_case) key = lower_case(name)
   end function key_of

   !> Place in the sorted list of the first named set whose key is not less than a given one.
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

   !> Index of the named set with a given name, 0 if there is none.
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

   !> Finds the named set with a given name, or makes a new one.
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

   !> Refuses more members of sets than a file of this length may name. To be called before members are added that are
   !> not written one by one: those of a range or of another set.
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

end module amontons_file_model
