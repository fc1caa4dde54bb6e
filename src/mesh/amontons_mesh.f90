!> The mesh: nodes, elements, named sets of sides, nodes and elements, with the checks that every mesh must pass; and
!> its topology: elements at each corner node, elements on both sides of each side, connected pieces, and colors of
!> elements that can be processed in parallel.
!>
!> Chunks of one color share no node. A chunk consists of consecutive elements, so that their common data stays in the
!> cache. If the elements are numbered at random, so that all chunks share nodes, every element is a chunk of its own.
module amontons_mesh
   use amontons_element, only: jacobian_degree, mapped_square, max_nodes, n_corners, n_element_nodes, &
      shape_functions, side_nodes
   use amontons_error, only: error_t, input_refused, new_error, warning_list_t
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp, int64
   use amontons_rounding, only: difference_rounding
   use amontons_text, only: lower_case, nearest_word, to_text
   implicit none (type, external)
   private

   public :: coloring_t, find_set, incidence_t, jacobian_determinant, mesh_t, named_set_t, new_coloring, &
      new_incidence, new_side_table, number_pieces, outer_sides, parents_t, side_element, side_number, side_place, &
      side_table_t, sides_per_element, worth_threads

   !> A named set: of sides of elements on the boundary, of nodes, or of elements, which is a region of the body.
   type :: named_set_t
      character(:), allocatable :: name !! name, as a deck writes it
      integer, allocatable :: element(:) !! the elements of a region, or the element of each side
      integer, allocatable :: side(:) !! the number of each side in its element
      integer, allocatable :: node(:) !! the nodes of a set of nodes
   end type named_set_t

   !> The nodes from which the position of a node of refinement follows as a weighted mean.
   type :: parents_t
      integer, allocatable :: start(:) !! where the parents of a node begin in `node` (n_nodes + 1)
      integer, allocatable :: node(:) !! the parents, of lower numbers than the node
      real(dp), allocatable :: weight(:) !! the weight of each [-]
   end type parents_t

   !> A plane mesh; elements may be of different kinds.
   type :: mesh_t
      integer :: n_nodes = 0 !! number of nodes
      integer :: n_elements = 0 !! number of elements
      real(dp), allocatable :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      integer, allocatable :: node_tag(:) !! number of each node in the mesh's file; not allocated without a file
      type(parents_t), allocatable :: parents !! where nodes of refinement come from; not allocated without any
      integer, allocatable :: element_kind(:) !! kind of each element, see `amontons_element` (n_elements)
      integer, allocatable :: node_start(:) !! where the nodes of an element begin in `node` (n_elements + 1)
      integer, allocatable :: node(:) !! nodes of the elements, counter-clockwise
      type(named_set_t), allocatable :: sets(:) !! named boundary sets
      type(named_set_t), allocatable :: node_sets(:) !! named sets of nodes; not allocated means none
      type(named_set_t), allocatable :: regions(:) !! named parts of the body; not allocated means none
      character(:), allocatable :: source !! what it was made of, for listings: a file, or the size of a rectangle
      type(warning_list_t) :: files !! names of the files it was read from
      type(warning_list_t) :: warnings !! warnings on the file it was read from
      logical :: has_pieces = .false. !! whether a file that it was read from has pieces that share no nodes
      character(12) :: hypothesis = '' !! the hypothesis of the elements in its file; empty if the file states none
   contains
      procedure :: check => mesh_check
      procedure :: nearest_node => mesh_nearest_node
      procedure :: region_elements => mesh_region_elements
      procedure :: is_of_refinement => mesh_is_of_refinement
      procedure :: is_turned_over => mesh_is_turned_over
      procedure :: set_nodes => mesh_set_nodes
      procedure :: set_sides => mesh_set_sides
      procedure :: side => mesh_side
   end type mesh_t

   !> The elements with a corner at each node.
   type :: incidence_t
      integer, allocatable :: start(:) !! where the corners at a node begin in `corner` (n_nodes + 1)
      integer, allocatable :: element(:) !! element of each corner, ascending at each node
      integer, allocatable :: corner(:) !! place of each corner in `node` of the mesh
   end type incidence_t

   !> Number of side numbers that every element has, used or not.
   integer, parameter :: sides_per_element = 4

   !> A side between two elements or at the boundary.
   type :: side_t
      integer :: before !! side filed before it under the same node, 0 for none
      integer :: other !! the corner that it is not filed under
      integer :: left !! number of the element's side that runs to the other corner, 0 for none
      integer :: right !! number of the element's side that runs the other way, 0 for none
   end type side_t

   !> The sides of all elements. Each is stored under that one of its two corners where fewer elements meet, which keeps
   !> every search short, even around a node with very many elements.
   type :: side_table_t
      integer :: n_sides = 0 !! number of sides
      type(side_t), allocatable :: sides(:) !! the sides, and room for more
      integer, allocatable :: last(:) !! last side filed under each node, 0 for none (nodes)
      integer, allocatable, private :: valence(:) !! number of elements at each node (nodes)
   contains
      procedure :: boundary => side_table_boundary
      procedure :: find => side_table_find
   end type side_table_t

   !> Smallest number of elements for which threads are worth their start, which takes up to some ten milliseconds.
   integer, parameter :: worth_threads = 10000

   !> Chunks sorted by color. Sums over the elements of a mesh taken color by color are the same for any number of
   !> threads.
   type :: coloring_t
      integer :: n_colors = 0 !! number of colors
      integer, allocatable :: start(:) !! where the chunks of a color begin (n_colors + 1)
      integer, allocatable :: first(:) !! the first element of each chunk (chunks)
      integer, allocatable :: last(:) !! its last one (chunks)
   end type coloring_t

contains

   !> Checks that the mesh is valid: positive Jacobians, every node used.
   subroutine mesh_check(self, error)
      class(mesh_t), intent(in) :: self !! the mesh
      type(error_t), allocatable, intent(out) :: error !! the first element or node that fails a check
      logical :: is_used(self%n_nodes)
      real(dp) :: extent
      integer :: element, node

      extent = maxval(maxval(self%coordinates, dim=2) - minval(self%coordinates, dim=2))
      is_used = .false.
      is_used(self%node) = .true.
      if (.not. all(is_used)) then
         node = findloc(is_used, .false., dim=1)
         call new_error(error, input_refused, 'mesh: node '//to_text(node)//' belongs to no element')
         return
      end if
      do element = 1, self%n_elements
         if (self%is_turned_over(element)) then
            ! Areas below the range of full precision do not decide whether an element is valid.
            if (.not. extent**2 > tiny(extent)/epsilon(extent)) then
               call new_error(error, input_refused, 'mesh: the body measures '//to_text(extent)// &
                  ', too little for its areas to be numbers; choose a smaller unit of length')
               return
            end if
            call new_error(error, input_refused, 'mesh: element '//to_text(element)// &
               ' is degenerate or turned over; its Jacobian must be positive everywhere')
            return
         end if
      end do
   end subroutine mesh_check

   !> Whether the Jacobian of an element is not positive everywhere, beyond its rounding errors. Over the square onto
   !> which an element is mapped, its Jacobian is a polynomial, and lies between its least and its greatest Bernstein
   !> coefficient (Johnen, Remacle, Geuzaine, J. Comp. Phys. 233, 2013).
   pure logical function mesh_is_turned_over(self, element) result(is_turned_over)
      class(mesh_t), intent(in) :: self !! the mesh
      integer, intent(in) :: element !! number of the element
      ! From values at equal distances to Bernstein coefficients of cubic polynomials.
      real(dp), parameter :: to_bernstein(4, 4) = reshape([6.0_dp, -5.0_dp, 2.0_dp, 0.0_dp, 0.0_dp, 18.0_dp, -9.0_dp, &
         0.0_dp, 0.0_dp, -9.0_dp, 18.0_dp, 0.0_dp, 0.0_dp, 2.0_dp, -5.0_dp, 6.0_dp], [4, 4])/6.0_dp
      ! Halves in which the sign is still in doubt are halved again, up to this many times: by then the bounds are as
      ! close as the square of their size.
      integer, parameter :: most_halvings = 24
      real(dp) :: coefficients(4, 4), least
      integer :: i, j, kind, n

      kind = self%element_kind(element)
      associate (x => self%coordinates(:, self%node(self%node_start(element):self%node_start(element + 1) - 1)))
         least = min(difference_rounding*dot_product(maxval(abs(x), dim=2), &
            abs(cshift(maxval(x, dim=2) - minval(x, dim=2), 1))), huge(least))
      end associate
      n = jacobian_degree(kind) + 1
      do j = 1, n
         do i = 1, n
            coefficients(i, j) = jacobian_determinant(self, element, &
               mapped_square(kind, [real(dp) :: i - 1, j - 1]/max(1, n - 1)))
         end do
      end do
      if (n > 2) coefficients = matmul(to_bernstein, matmul(coefficients, transpose(to_bernstein)))
      is_turned_over = .not. exceeds(coefficients(:n, :n), least, most_halvings)
   end function mesh_is_turned_over

   !> Whether a polynomial exceeds a value on all of a square.
   pure recursive logical function exceeds(coefficients, least, n_halvings) result(is_above)
      real(dp), intent(in) :: coefficients(:, :) !! its Bernstein coefficients; those at the corners are its values
      real(dp), intent(in) :: least !! the value
      integer, intent(in) :: n_halvings !! how often the square may be halved; what is in doubt then does not exceed it
      real(dp) :: first(size(coefficients, 2), size(coefficients, 1)), second(size(coefficients, 2), &
         size(coefficients, 1))
      integer :: i, n

      n = size(coefficients, 1)
      is_above = all(coefficients > least)
      if (is_above .or. n_halvings == 0 .or. any(coefficients([1, n], [1, size(coefficients, 2)]) <= least)) return
      ! De Casteljau's algorithm along the first direction, which then becomes the other one.
      second = transpose(coefficients)
      do i = 1, n
         first(:, i) = second(:, 1)
         second(:, :n - i) = 0.5_dp*(second(:, :n - i) + second(:, 2:n - i + 1))
      end do
      is_above = exceeds(first, least, n_halvings - 1)
      if (is_above) is_above = exceeds(second, least, n_halvings - 1)
   end function exceeds

   !> Determinant of the Jacobian dx_i / dxi_j of an element at a reference point [L^2].
   pure real(dp) function jacobian_determinant(mesh, element, xi) result(determinant)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element
      real(dp), intent(in) :: xi(2) !! reference coordinates [-]
      real(dp) :: values(max_nodes), derivatives(2, max_nodes), jacobian(2, 2)
      integer :: kind, i

      kind = mesh%element_kind(element)
      call shape_functions(kind, xi, values, derivatives)
      jacobian = 0.0_dp
      do i = 1, n_element_nodes(kind)
         associate (x => mesh%coordinates(:, mesh%node(mesh%node_start(element) + i - 1)))
            jacobian(:, 1) = jacobian(:, 1) + x*derivatives(1, i)
            jacobian(:, 2) = jacobian(:, 2) + x*derivatives(2, i)
         end associate
      end do
      determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
   end function jacobian_determinant

   !> Index of the set with a given name, 0 if there is none.
   pure integer function find_set(sets, name) result(set)
      type(named_set_t), intent(in), optional :: sets(:) !! the sets; may be not allocated
      character(*), intent(in) :: name !! the name

      if (present(sets)) then
         do set = 1, size(sets)
            if (sets(set)%name == name) return
         end do
      end if
      set = 0
   end function find_set

   !> Whether a node was made by a refinement of the mesh.
   pure logical function mesh_is_of_refinement(self, node) result(is_of_refinement)
      class(mesh_t), intent(in) :: self !! the mesh
      integer, intent(in) :: node !! the node

      is_of_refinement = allocated(self%parents)
      if (is_of_refinement) is_of_refinement = self%parents%start(node + 1) > self%parents%start(node)
   end function mesh_is_of_refinement

   !> The sides of a named boundary set.
   pure subroutine mesh_set_sides(self, name, sides, error)
      class(mesh_t), intent(in) :: self !! the mesh
      character(*), intent(in) :: name !! name of the set
      integer, allocatable, intent(out) :: sides(:, :)
         !! first corner, second corner, middle or 0, element of each side; body on the left (4, sides)
      type(error_t), allocatable, intent(out) :: error !! there is no such set; the message lists those there are
      character(:), allocatable :: text, nearest, names(:)
      integer :: set, i

      set = find_set(self%sets, name)
      if (set > 0) then
         allocate (sides(4, size(self%sets(set)%element)))
         if (size(sides) == 0) call new_error(error, input_refused, "the set '"//name//"' lies inside the body: "// &
            'the elements on both sides share its nodes, and nothing can act, open or slip there; mesh two bodies '// &
            'without common nodes, each with a set of its own')
         do i = 1, size(sides, 2)
            sides(:3, i) = self%side(self%sets(set)%element(i), self%sets(set)%side(i))
            sides(4, i) = self%sets(set)%element(i)
         end do
         return
      end if
      if (find_set(self%node_sets, name) > 0) then
         call new_error(error, input_refused, "the set '"//name//"' has nodes, but no side of the boundary lies "// &
            'between them; where both sides of a line share its nodes, it lies inside the body')
         return
      end if
      text = '; it has no sets at all: name its boundaries in the mesh file, in Gmsh as physical curves'
      if (size(self%sets) > 0) then
         allocate (character(maxval([(len(self%sets(i)%name), i=1, size(self%sets))])) :: names(size(self%sets)))
         text = '; its sets are: '
         do i = 1, size(names)
            names(i) = self%sets(i)%name
            if (i > 1) text = text//', '
            text = text//self%sets(i)%name
         end do
         nearest = nearest_word(lower_case(name), names)
         if (nearest /= '') text = text//"; did you mean '"//nearest//"'?"
      end if
      call new_error(error, input_refused, "the mesh has no set '"//name//"'"//text)
   end subroutine mesh_set_sides

   !> The nodes of a named set: of a node set, or of all sides of a boundary set.
   pure subroutine mesh_set_nodes(self, name, nodes, error)
      class(mesh_t), intent(in) :: self !! the mesh
      character(*), intent(in) :: name !! name of the set
      integer, allocatable, intent(out) :: nodes(:) !! the nodes, each once
      type(error_t), allocatable, intent(out) :: error !! there is no such set
      integer, allocatable :: sides(:, :)
      logical :: is_met(0:self%n_nodes)
      integer :: set, i

      set = find_set(self%node_sets, name)
      if (set > 0) then
         nodes = self%node_sets(set)%node
         return
      end if
      call self%set_sides(name, sides, error)
      if (allocated(error)) return
      is_met = .false.
      do i = 1, size(sides, 2)
         is_met(sides(:3, i)) = .true.
      end do
      nodes = pack([(i, i=1, self%n_nodes)], is_met(1:))
   end subroutine mesh_set_nodes

   !> The elements of a named region.
   pure subroutine mesh_region_elements(self, name, elements, error)
      class(mesh_t), intent(in) :: self !! the mesh
      character(*), intent(in) :: name !! name of the region; empty for the whole body
      integer, allocatable, intent(out) :: elements(:) !! its elements
      type(error_t), allocatable, intent(out) :: error !! there is no such region
      character(:), allocatable :: text
      integer :: region, i

      region = find_set(self%regions, name)
      if (len(name) == 0) then
         elements = [(i, i=1, self%n_elements)]
      else if (region > 0) then
         elements = self%regions(region)%element
      else
         text = '; it has no regions at all'
         if (allocated(self%regions)) then
            text = '; its regions are: '
            do i = 1, size(self%regions)
               if (i > 1) text = text//', '
               text = text//self%regions(i)%name
            end do
         end if
         call new_error(error, input_refused, "the mesh has no region '"//name//"'"//text)
      end if
   end subroutine mesh_region_elements

   !> The corners of a side of an element, in the direction that has the element on its left, and its middle or 0.
   pure function mesh_side(self, element, side) result(nodes)
      class(mesh_t), intent(in) :: self !! the mesh
      integer, intent(in) :: element !! number of the element
      integer, intent(in) :: side !! number of the side in the element
      integer :: nodes(3)

      nodes = side_nodes(self%element_kind(element), side)
      where (nodes > 0) nodes = self%node(self%node_start(element) - 1 + nodes)
   end function mesh_side

   !> The node at given coordinates, within a thousandth of the distance to the next node; 0 if there is none.
   pure integer function mesh_nearest_node(self, point) result(nearest)
      class(mesh_t), intent(in) :: self !! the mesh
      real(dp), intent(in) :: point(2) !! coordinates [L]
      real(dp) :: distance, least, second
      integer :: node

      nearest = 0
      least = huge(least)
      second = huge(second)
      do node = 1, self%n_nodes
         distance = norm2(self%coordinates(:, node) - point)
         if (distance < least) then
            second = least
            least = distance
            nearest = node
         else
            second = min(second, distance)
         end if
      end do
      if (least > 1.0e-3_dp*second) nearest = 0
   end function mesh_nearest_node

   !> Lists the corners of all elements by their nodes.
   pure subroutine new_incidence(incidence, mesh)
      type(incidence_t), intent(out) :: incidence !! the lists
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, allocatable :: node(:), element_of(:)
      integer :: element, first, last

      allocate (node(size(mesh%node)), element_of(size(mesh%node)), source=0)
      do element = 1, mesh%n_elements
         first = mesh%node_start(element)
         last = first + n_corners(mesh%element_kind(element)) - 1
         node(first:last) = mesh%node(first:last)
         element_of(first:last) = element
      end do
      call fill_bins(incidence%start, incidence%corner, node, mesh%n_nodes)
      incidence%element = element_of(incidence%corner)
   end subroutine new_incidence

   !> Finds the connected pieces of a mesh and numbers them in the order of their first nodes.
   pure subroutine number_pieces(mesh, piece, n_pieces, bonds)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, allocatable, intent(out) :: piece(:) !! the piece that each node belongs to (n_nodes)
      integer, intent(out) :: n_pieces !! number of pieces
      integer, intent(in), optional :: bonds(:, :) !! pairs of nodes that hold together, too (2, bonds)
      integer :: parent(mesh%n_nodes), element, i, node, one, other

      ! Every node points to another one of its piece that comes before it, the first node of each piece to itself.
      parent = [(node, node=1, mesh%n_nodes)]
      do element = 1, mesh%n_elements
         one = mesh%node(mesh%node_start(element))
         call find_root(parent, one)
         do i = mesh%node_start(element) + 1, mesh%node_start(element + 1) - 1
            other = mesh%node(i)
            call find_root(parent, other)
            parent(max(one, other)) = min(one, other)
            one = min(one, other)
         end do
      end do
      if (present(bonds)) then
         do i = 1, size(bonds, 2)
            one = bonds(1, i)
            other = bonds(2, i)
            call find_root(parent, one)
            call find_root(parent, other)
            parent(max(one, other)) = min(one, other)
         end do
      end if
      allocate (piece(mesh%n_nodes))
      n_pieces = 0
      do node = 1, mesh%n_nodes
         if (parent(node) == node) then
            n_pieces = n_pieces + 1
            piece(node) = n_pieces
         else
            piece(node) = piece(parent(node))
         end if
      end do
   end subroutine number_pieces

   !> Finds the root of a node in a union-find forest, the node that is its own parent, and shortens the path to it.
   pure subroutine find_root(parent, node)
      integer, intent(inout) :: parent(:) !! the parent of each node
      integer, intent(inout) :: node !! the node; its root on return

      do while (parent(node) /= node)
         parent(node) = parent(parent(node))
         node = parent(node)
      end do
   end subroutine find_root

   !> Number of a side of an element, counted over all elements.
   elemental integer function side_number(element, place)
      integer, intent(in) :: element !! the element
      integer, intent(in) :: place !! the side's place in the element, from 1

      side_number = sides_per_element*(element - 1) + place
   end function side_number

   !> The element that a numbered side belongs to, 0 for number 0.
   elemental integer function side_element(number)
      integer, intent(in) :: number !! number of the side, or 0

      side_element = (number + sides_per_element - 1)/sides_per_element
   end function side_element

   !> The local number of a numbered side in its element.
   elemental integer function side_place(number)
      integer, intent(in) :: number !! number of the side

      side_place = mod(number - 1, sides_per_element) + 1
   end function side_place

   !> Makes the table of a mesh's sides; stops at the first side that has two elements on the same side of it.
   pure subroutine new_side_table(table, mesh, overlapping)
      type(side_table_t), intent(out) :: table !! the sides
      type(mesh_t), intent(in) :: mesh !! the mesh, its elements counter-clockwise
      integer, intent(out) :: overlapping(2) !! two elements that lie one over the other, 0 where none do
      integer :: a, b, element, home, i, n, first, side

      allocate (table%last(mesh%n_nodes), table%valence(mesh%n_nodes), source=0)
      allocate (table%sides(sum(n_corners(mesh%element_kind))))
      do element = 1, mesh%n_elements
         first = mesh%node_start(element)
         do i = first, first + n_corners(mesh%element_kind(element)) - 1
            table%valence(mesh%node(i)) = table%valence(mesh%node(i)) + 1
         end do
      end do
      overlapping = 0
      do element = 1, mesh%n_elements
         first = mesh%node_start(element)
         n = n_corners(mesh%element_kind(element))
         do i = 1, n
            a = mesh%node(first + i - 1)
            b = mesh%node(first + mod(i, n))
            home = home_of(table, a, b)
            side = place_of(table, home, a + b - home)
            if (side == 0) then
               table%n_sides = table%n_sides + 1
               side = table%n_sides
               table%sides(side) = side_t(table%last(home), a + b - home, 0, 0)
               table%last(home) = side
            end if
            associate (filed => table%sides(side), number => side_number(element, i))
               if (home == a) then
                  if (filed%left > 0) overlapping = side_element([filed%left, number])
                  filed%left = number
               else
                  if (filed%right > 0) overlapping = side_element([filed%right, number])
                  filed%right = number
               end if
            end associate
            if (overlapping(1) > 0) return
         end do
      end do
   end subroutine new_side_table

   !> The node under which a side is stored: that one of its corners where fewer elements meet.
   pure integer function home_of(table, a, b) result(home)
      type(side_table_t), intent(in) :: table !! the sides
      integer, intent(in) :: a !! one corner
      integer, intent(in) :: b !! the other corner

      if (table%valence(a) == table%valence(b)) then
         home = min(a, b)
      else
         home = merge(a, b, table%valence(a) < table%valence(b))
      end if
   end function home_of

   !> Place of a side in the table, 0 if no element has it.
   pure integer function place_of(table, home, other) result(side)
      type(side_table_t), intent(in) :: table !! the sides
      integer, intent(in) :: home !! the corner it would be filed under
      integer, intent(in) :: other !! its other corner

      side = table%last(home)
      do while (side > 0)
         if (table%sides(side)%other == other) return
         side = table%sides(side)%before
      end do
   end function place_of

   !> Finds the numbers of the element sides to the left and to the right of the line from one corner to another.
   pure subroutine side_table_find(self, a, b, left, right)
      class(side_table_t), intent(in) :: self !! the sides
      integer, intent(in) :: a !! the corner to come from
      integer, intent(in) :: b !! the corner to go to
      integer, intent(out) :: left !! number of the side of the element on the left, 0 for none
      integer, intent(out) :: right !! number of the side of the element on the right, 0 for none
      integer :: side, home

      left = 0
      right = 0
      home = home_of(self, a, b)
      side = place_of(self, home, a + b - home)
      if (side == 0) return
      left = merge(self%sides(side)%left, self%sides(side)%right, home == a)
      right = merge(self%sides(side)%right, self%sides(side)%left, home == a)
   end subroutine side_table_find

   !> Number of the element side of a side on the boundary, 0 for a side between two elements.
   pure integer function side_table_boundary(self, side) result(number)
      class(side_table_t), intent(in) :: self !! the sides
      integer, intent(in) :: side !! place in the table

      associate (left => self%sides(side)%left, right => self%sides(side)%right)
         number = merge(max(left, right), 0, min(left, right) == 0)
      end associate
   end function side_table_boundary

   !> Numbers of the element sides on the boundary of a mesh, in ascending order.
   pure function outer_sides(mesh) result(numbers)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, allocatable :: numbers(:)
      type(side_table_t) :: table
      integer :: overlapping(2), i

      call new_side_table(table, mesh, overlapping)
      numbers = [(table%boundary(i), i=1, table%n_sides)]
      numbers = pack(numbers, numbers > 0)
   end function outer_sides

   !> Colors the elements of a mesh greedily, in the order of their numbers.
   subroutine new_coloring(coloring, mesh)
      type(coloring_t), intent(out) :: coloring !! the colors
      type(mesh_t), intent(in) :: mesh !! the mesh
      ! Elements of a chunk, whose nodes fit into a cache; fewest chunks of a color, for many threads.
      integer, parameter :: usual_size = 512, fewest = 32
      integer, allocatable :: color(:), chunk(:)
      integer :: chunk_size

      chunk_size = usual_size
      color = greedy_colors(mesh, chunk_size)
      if (size(color) < fewest*maxval(color)) then
         chunk_size = 1
         color = greedy_colors(mesh, chunk_size)
      end if
      coloring%n_colors = maxval(color)
      call fill_bins(coloring%start, chunk, color, coloring%n_colors)
      coloring%first = (chunk - 1)*chunk_size + 1
      coloring%last = min(mesh%n_elements, chunk*chunk_size)
   end subroutine new_coloring

   !> The color of each chunk: the first that none of its neighbors with smaller numbers has.
   pure function greedy_colors(mesh, chunk_size) result(color)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: chunk_size !! number of elements of a chunk
      integer, allocatable :: color(:)
      integer, parameter :: n_bits = bit_size(0_int64)
      integer(int64) :: taken(mesh%n_nodes), used
      integer :: chunk, i, n_lonely

      allocate (color((mesh%n_elements + chunk_size - 1)/chunk_size))
      taken = 0_int64
      n_lonely = 0
      do chunk = 1, size(color)
         associate (first => mesh%node_start((chunk - 1)*chunk_size + 1), &
            past => mesh%node_start(min(mesh%n_elements, chunk*chunk_size) + 1))
            used = 0_int64
            do i = first, past - 1
               used = ior(used, taken(mesh%node(i)))
            end do
            color(chunk) = trailz(not(used)) + 1
            if (color(chunk) > n_bits) then
               ! The bits of a node where very many chunks meet are used up: the chunk gets a color of its own.
               n_lonely = n_lonely + 1
               color(chunk) = n_bits + n_lonely
               cycle
            end if
            do i = first, past - 1
               taken(mesh%node(i)) = ibset(taken(mesh%node(i)), color(chunk) - 1)
            end do
         end associate
      end do
   end function greedy_colors

end module amontons_mesh
