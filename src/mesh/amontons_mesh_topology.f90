!> How the elements of a mesh hang together: which elements meet at each corner node, which lie on either side of each
!> side, pieces that share no nodes, and colors of elements that can be worked on in parallel.
!>
!> Chunks of one color share no node. Elements in a row are a chunk, since what they have in common stays in the cache.
!> Where the elements of a mesh are numbered at random, so that all chunks touch each other, every element is a chunk of
!> its own.
module amontons_mesh_topology
   use amontons_element, only: n_corners
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: int64
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: coloring_t, incidence_t, new_coloring, new_incidence, new_side_table, number_pieces, side_element, &
      side_number, side_place, side_table_t, sides_per_element, worth_threads

   !> The elements with a corner at each node.
   type :: incidence_t
      integer, allocatable :: start(:) !! where the corners at a node begin in `corner` (n_nodes + 1)
      integer, allocatable :: element(:) !! element of each corner, ascending at each node
      integer, allocatable :: corner(:) !! place of each corner in `node` of the mesh
   end type incidence_t

   !> Every element has this many numbers for its sides, used or not.
   integer, parameter :: sides_per_element = 4

   !> A side between two elements or at the boundary.
   type :: side_t
      integer :: before !! side filed before it under the same node, 0 for none
      integer :: other !! the corner that it is not filed under
      integer :: left !! number of the element's side that runs to the other corner, 0 for none
      integer :: right !! number of the element's side that runs the other way, 0 for none
   end type side_t

   !> The sides of all elements. Each is filed under that of its two corners where fewer elements meet, which keeps
   !> every search short, even around the hub of a wheel.
   type :: side_table_t
      integer :: n_sides = 0 !! number of sides
      type(side_t), allocatable :: sides(:) !! the sides, and room for more
      integer, allocatable :: last(:) !! last side filed under each node, 0 for none (nodes)
      integer, allocatable, private :: valence(:) !! number of elements at each node (nodes)
   contains
      procedure :: boundary => side_table_boundary
      procedure :: find => side_table_find
   end type side_table_t

   !> Fewest elements whose work outweighs waking other threads, which takes up to some ten milliseconds.
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

   !> Numbers the pieces in the order of their first nodes.
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

   !> Follows the parents of a node to the one that points to itself, and shortens the way.
   pure subroutine find_root(parent, node)
      integer, intent(inout) :: parent(:) !! the parent of each node
      integer, intent(inout) :: node !! the node; its root on return

      do while (parent(node) /= node)
         parent(node) = parent(parent(node))
         node = parent(node)
      end do
   end subroutine find_root

   !> Number of a side of an element.
   elemental integer function side_number(element, place)
      integer, intent(in) :: element !! the element
      integer, intent(in) :: place !! the side's place in the element, from 1

      side_number = sides_per_element*(element - 1) + place
   end function side_number

   !> The element of a numbered side, 0 for number 0.
   elemental integer function side_element(number)
      integer, intent(in) :: number !! number of the side, or 0

      side_element = (number + sides_per_element - 1)/sides_per_element
   end function side_element

   !> The place of a numbered side in its element.
   elemental integer function side_place(number)
      integer, intent(in) :: number !! number of the side

      side_place = mod(number - 1, sides_per_element) + 1
   end function side_place

   !> Files the sides of a mesh; stops at the first side that has two elements on the same side of it.
   pure subroutine new_side_table(table, mesh, overlapping)
      type(side_table_t), intent(out) :: table !! the sides
      type(mesh_t), intent(in) :: mesh !! the mesh, its elements counter-clockwise
      integer, intent(out) :: overlapping(2) !! two elements that lie one over the other, 0 where none do
      integer :: element, i, n, first

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
            call file_side(table, mesh%node(first + i - 1), mesh%node(first + mod(i, n)), side_number(element, i), &
               overlapping)
            if (overlapping(1) > 0) return
         end do
      end do
   end subroutine new_side_table

   !> Files a side of an element.
   pure subroutine file_side(table, a, b, number, overlapping)
      type(side_table_t), intent(inout) :: table !! the sides filed so far
      integer, intent(in) :: a !! first corner of the side; the element lies on the left
      integer, intent(in) :: b !! second corner of the side
      integer, intent(in) :: number !! number of the side
      integer, intent(inout) :: overlapping(2) !! the element that is there already, if one is, and this one
      integer :: side, home

      home = home_of(table, a, b)
      side = place_of(table, home, a + b - home)
      if (side == 0) then
         table%n_sides = table%n_sides + 1
         side = table%n_sides
         table%sides(side) = side_t(table%last(home), a + b - home, 0, 0)
         table%last(home) = side
      end if
      associate (filed => table%sides(side))
         if (home == a) then
            if (filed%left > 0) overlapping = side_element([filed%left, number])
            filed%left = number
         else
            if (filed%right > 0) overlapping = side_element([filed%right, number])
            filed%right = number
         end if
      end associate
   end subroutine file_side

   !> The node that a side is filed under: that of its corners where fewer elements meet.
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

   !> Place in the table of a side, 0 where no element has it.
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

   !> Finds the elements' sides on both sides of the way from one corner to another.
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

   !> Number of the element's side at a side of the boundary, 0 at a side between two elements.
   pure integer function side_table_boundary(self, side) result(number)
      class(side_table_t), intent(in) :: self !! the sides
      integer, intent(in) :: side !! place in the table

      number = 0
      if (min(self%sides(side)%left, self%sides(side)%right) == 0) then
         number = max(self%sides(side)%left, self%sides(side)%right)
      end if
   end function side_table_boundary

   !> Colors the elements of a mesh greedily, in their own order.
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

   !> The color of each chunk: the first that none of its neighbors took before it.
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

end module amontons_mesh_topology
