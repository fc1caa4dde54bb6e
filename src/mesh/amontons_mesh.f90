!> The mesh: nodes, elements, named sets of sides, nodes and elements, with the checks that every mesh must pass; and
!> its topology: elements at each corner node, elements on both sides of each side, connected pieces, and colors of
!> elements that can be processed in parallel.
!>
!> Chunks of one color share no node. A chunk consists of consecutive elements, so that their common data stays in the
!> cache. If the elements are numbered at random, so that all chunks share nodes, every element is a chunk of its own.
module amontons_mesh
   use amontons_element, only: corner_kind, is_solid, jacobian_degree, line_ends, mapped_square, max_face_nodes, &
      max_nodes, n_corners, n_element_nodes, n_side_corners, n_sides, quad9, shape_functions, side_nodes
   use amontons_error, only: error_t, input_refused, new_error, warning_list_t
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp, int64
   use amontons_rounding, only: difference_rounding
   use amontons_text, only: lower_case, nearest_word, to_text
   implicit none (type, external)
   private

   public :: coloring_t, find_set, incidence_t, is_straight, jacobian_determinant, jacobian_reference_t, mesh_t, &
      named_set_t, new_coloring, new_incidence, new_jacobian_references, new_side_table, number_pieces, outer_sides, &
      parents_t, side_element, side_number, side_place, side_table_t, sides_per_element, worth_threads

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

   !> A mesh in the plane or in space; elements may be of different kinds. A side of a solid is one of its faces.
   type :: mesh_t
      integer :: n_nodes = 0 !! number of nodes
      integer :: n_elements = 0 !! number of elements
      real(dp), allocatable :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      integer, allocatable :: node_tag(:) !! number of each node in the mesh's file; not allocated without a file
      type(parents_t), allocatable :: parents !! where nodes of refinement come from; not allocated without any
      integer, allocatable :: element_kind(:) !! kind of each element, see `amontons_element` (n_elements)
      integer, allocatable :: node_start(:) !! where the nodes of an element begin in `node` (n_elements + 1)
      integer, allocatable :: node(:) !! nodes of the elements, as `amontons_element` numbers them
      type(named_set_t), allocatable :: sets(:) !! named boundary sets
      type(named_set_t), allocatable :: node_sets(:) !! named sets of nodes; not allocated means none
      type(named_set_t), allocatable :: regions(:) !! named parts of the body; not allocated means none
      character(:), allocatable :: source !! what it was made of, for listings: a file, or the size of what is generated
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
   integer, parameter :: sides_per_element = 6

   !> A side between two elements or at the boundary.
   type :: side_t
      integer :: before !! side filed before it under the same node, 0 for none
      integer :: other(3)
         !! the corners that it is not filed under: of a face the lower and the higher one beside that, and the opposite
         !! one; 0 for none
      integer :: left !! number of the element's side that runs to the first other corner, 0 for none
      integer :: right !! number of the element's side that runs the other way, 0 for none
   end type side_t

   !> The sides of all elements. Each is stored under that one of its corners where fewest elements meet, which keeps
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

   !> Most values of a Jacobian along one direction of an element, one more than its degree.
   integer, parameter :: most_values = maxval(jacobian_degree) + 1

   !> What the Jacobian of a kind of elements is computed from, at points at equal distances of `mapped_square`.
   type :: jacobian_reference_t
      real(dp), allocatable :: derivatives(:, :, :)
         !! derivatives of the shape functions by the reference coordinates (n_dim, node, point) [-]
      real(dp), allocatable :: to_bernstein(:, :) !! from values along one direction to Bernstein coefficients [-]
   end type jacobian_reference_t

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
      type(jacobian_reference_t), allocatable :: reference(:)
      integer :: element, node

      extent = maxval(maxval(self%coordinates, dim=2) - minval(self%coordinates, dim=2))
      is_used = .false.
      is_used(self%node) = .true.
      if (.not. all(is_used)) then
         node = findloc(is_used, .false., dim=1)
         call new_error(error, input_refused, 'mesh: node '//to_text(node)//' belongs to no element')
         return
      end if
      call new_jacobian_references(reference, self)
      do element = 1, self%n_elements
         if (self%is_turned_over(element, reference)) then
            ! Areas and volumes below the range of full precision do not decide whether an element is valid.
            if (.not. extent**size(self%coordinates, 1) > tiny(extent)/epsilon(extent)) then
               call new_error(error, input_refused, 'mesh: the body measures '//to_text(extent)//', too little for '// &
                  'its '//trim(merge('volumes', 'areas  ', size(self%coordinates, 1) == 3))// &
                  ' to be numbers; choose a smaller unit of length')
               return
            end if
            call new_error(error, input_refused, 'mesh: element '//to_text(element)// &
               ' is degenerate or turned over; its Jacobian must be positive everywhere')
            return
         end if
      end do
   end subroutine mesh_check

   !> Whether the Jacobian of an element is not positive everywhere, beyond its rounding errors. Over the square or
   !> cube onto which an element is mapped, its Jacobian is a polynomial, and lies between its least and its greatest
   !> Bernstein coefficient (Johnen, Remacle, Geuzaine, J. Comp. Phys. 233, 2013).
   pure logical function mesh_is_turned_over(self, element, reference) result(is_turned_over)
      class(mesh_t), intent(in) :: self !! the mesh
      integer, intent(in) :: element !! number of the element
      type(jacobian_reference_t), intent(in) :: reference(:) !! from `new_jacobian_references` (kinds)
      ! Halves in which the sign is still in doubt are halved again, up to this many times: by then the bounds are as
      ! close as the square of their size.
      integer, parameter :: most_halvings = 24
      real(dp) :: coefficients(most_values, most_values**2), least, x(3, max_nodes)
      integer :: axis, i, k, kind, n, m, n_dim, n_nodes

      kind = self%element_kind(element)
      if (is_straight(self, element)) kind = corner_kind(kind)
      n = jacobian_degree(kind) + 1
      n_dim = size(self%coordinates, 1)
      m = n**(n_dim - 1)
      n_nodes = self%node_start(element + 1) - self%node_start(element)
      do i = 1, n_nodes
         x(:n_dim, i) = self%coordinates(:, self%node(self%node_start(element) + i - 1))
      end do
      least = rounding_of_volume(x(:n_dim, :n_nodes))
      do k = 1, m
         do i = 1, n
            coefficients(i, k) = determinant(x(:n_dim, :), reference(kind)%derivatives(:, :, n*(k - 1) + i))
         end do
      end do
      if (n > 2) then
         ! Along one direction after the other, each of which becomes the last.
         do axis = 1, n_dim
            coefficients(:n, :m) = reshape(transpose(matmul(reference(kind)%to_bernstein, coefficients(:n, :m))), &
               [n, m])
         end do
      end if
      is_turned_over = .not. exceeds(coefficients(:n, :m), least, most_halvings)
   end function mesh_is_turned_over

   !> Rounding error of the area or volume of an element: that of one coordinate times the extents along the others
   !> [L^n_dim].
   pure real(dp) function rounding_of_volume(x) result(rounding)
      real(dp), intent(in) :: x(:, :) !! coordinates of its nodes (n_dim, nodes) [L]
      real(dp) :: least(3), most(3), span(3)

      associate (n => size(x, 1))
         least(:n) = minval(x, dim=2)
         most(:n) = maxval(x, dim=2)
         span(:n) = cshift(most(:n) - least(:n), 1)
         if (n == 3) span = span*cshift(span, 1)
         rounding = min(difference_rounding*dot_product(max(abs(least(:n)), abs(most(:n))), span(:n)), huge(rounding))
      end associate
   end function rounding_of_volume

   !> Makes what the Jacobian of elements is computed from, for all kinds that a mesh has and those of their corners.
   pure subroutine new_jacobian_references(reference, mesh)
      type(jacobian_reference_t), allocatable, intent(out) :: reference(:) !! for each kind (kinds)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp) :: place(size(mesh%coordinates, 1)), values(max_nodes), derivatives(size(place), max_nodes)
      integer :: i, kind, n, point

      allocate (reference(size(corner_kind)))
      do kind = 1, size(reference)
         if (.not. any(mesh%element_kind == kind .or. corner_kind(mesh%element_kind) == kind)) cycle
         n = jacobian_degree(kind) + 1
         reference(kind)%to_bernstein = bernstein_matrix(n)
         allocate (reference(kind)%derivatives(size(place), n_element_nodes(kind), n**size(place)))
         do point = 1, n**size(place)
            place = real([(mod((point - 1)/n**(i - 1), n), i=1, size(place))], dp)/max(1, n - 1)
            call shape_functions(kind, mapped_square(kind, place), values, derivatives)
            reference(kind)%derivatives(:, :, point) = derivatives(:, :n_element_nodes(kind))
         end do
      end do
   end subroutine new_jacobian_references

   !> Whether the nodes between the corners of an element lie in the middle between two of them, but for rounding, and
   !> none inside.
   pure logical function is_straight(mesh, element)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element
      integer :: axis, ends(2), first, i

      associate (kind => mesh%element_kind(element))
         is_straight = kind /= quad9
         first = mesh%node_start(element) - 1
         do i = n_corners(kind) + 1, n_element_nodes(kind)
            if (.not. is_straight) return
            ends = mesh%node(first + line_ends(kind, i - n_corners(kind)))
            do axis = 1, size(mesh%coordinates, 1)
               associate (a => mesh%coordinates(axis, ends(1)), b => mesh%coordinates(axis, ends(2)), &
                  middle => mesh%coordinates(axis, mesh%node(first + i)))
                  is_straight = is_straight .and. abs(a + b - 2.0_dp*middle) <= difference_rounding*(abs(a) + abs(b))
               end associate
            end do
         end do
      end associate
   end function is_straight

   !> The matrix from values of a polynomial at equal distances from 0 to 1 to its Bernstein coefficients (n, n).
   pure function bernstein_matrix(n) result(inverse)
      integer, intent(in) :: n !! number of values, the degree and 1
      real(dp) :: inverse(n, n)
      real(dp) :: values(n, n), binomial, t
      integer :: i, k

      inverse = 0.0_dp
      do i = 1, n
         inverse(i, i) = 1.0_dp
         t = real(i - 1, dp)/(n - 1)
         binomial = 1.0_dp
         do k = 1, n
            values(i, k) = binomial*t**(k - 1)*(1.0_dp - t)**(n - k)
            binomial = binomial*real(n - k, dp)/k
         end do
      end do
      ! The values of Bernstein polynomials are totally positive: Gauss-Jordan elimination needs no pivots.
      do k = 1, n
         inverse(k, :) = inverse(k, :)/values(k, k)
         values(k, :) = values(k, :)/values(k, k)
         do i = 1, n
            if (i == k) cycle
            inverse(i, :) = inverse(i, :) - values(i, k)*inverse(k, :)
            values(i, :) = values(i, :) - values(i, k)*values(k, :)
         end do
      end do
   end function bernstein_matrix

   !> Whether a polynomial exceeds a value on all of a square or cube.
   pure recursive logical function exceeds(coefficients, least, n_halvings) result(is_above)
      real(dp), intent(in) :: coefficients(:, :)
         !! its Bernstein coefficients (along the first direction, all others); those at the corners are its values
      real(dp), intent(in) :: least !! the value
      integer, intent(in) :: n_halvings !! how often it may be halved; what is in doubt then does not exceed the value
      real(dp) :: first(size(coefficients, 2), size(coefficients, 1)), second(size(coefficients, 2), &
         size(coefficients, 1))
      integer :: i, m, n

      n = size(coefficients, 1)
      m = size(coefficients, 2)
      is_above = all(coefficients > least)
      if (is_above .or. n_halvings == 0 .or. any(coefficients([1, n], [1, n, m - n + 1, m]) <= least)) return
      ! De Casteljau's algorithm along the first direction, which then becomes the last one.
      second = transpose(coefficients)
      do i = 1, n
         first(:, i) = second(:, 1)
         second(:, :n - i) = 0.5_dp*(second(:, :n - i) + second(:, 2:n - i + 1))
      end do
      is_above = exceeds(reshape(first, [n, m]), least, n_halvings - 1)
      if (is_above) is_above = exceeds(reshape(second, [n, m]), least, n_halvings - 1)
   end function exceeds

   !> Determinant of the Jacobian dx_i / dxi_j of an element at a reference point [L^n_dim].
   pure real(dp) function jacobian_determinant(mesh, element, xi)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element
      real(dp), intent(in) :: xi(:) !! reference coordinates [-]
      real(dp) :: values(max_nodes), derivatives(size(xi), max_nodes)

      call shape_functions(mesh%element_kind(element), xi, values, derivatives)
      associate (x => mesh%coordinates(:, mesh%node(mesh%node_start(element):mesh%node_start(element + 1) - 1)))
         jacobian_determinant = determinant(x, derivatives(:, :size(x, 2)))
      end associate
   end function jacobian_determinant

   !> The same from the derivatives of the shape functions [L^n_dim].
   pure real(dp) function determinant(x, derivatives)
      real(dp), intent(in) :: x(:, :) !! coordinates of the nodes (n_dim, nodes) [L]
      real(dp), intent(in) :: derivatives(:, :)
         !! derivatives by the reference coordinates, of all or the first nodes (n_dim, nodes) [-]
      real(dp) :: jacobian(3, 3)
      integer :: i, k

      jacobian = 0.0_dp
      do i = 1, size(derivatives, 2)
         do k = 1, size(x, 1)
            jacobian(:size(x, 1), k) = jacobian(:size(x, 1), k) + x(:, i)*derivatives(k, i)
         end do
      end do
      determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
      if (size(x, 1) == 3) determinant = determinant*jacobian(3, 3) &
         + (jacobian(2, 1)*jacobian(3, 2) - jacobian(3, 1)*jacobian(2, 2))*jacobian(1, 3) &
         + (jacobian(3, 1)*jacobian(1, 2) - jacobian(1, 1)*jacobian(3, 2))*jacobian(2, 3)
   end function determinant

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
         !! nodes of each side as of `mesh_side`, then its element (4 in the plane, 9 in space; sides)
      type(error_t), allocatable, intent(out) :: error !! there is no such set; the message lists those there are
      character(:), allocatable :: text, nearest, names(:)
      integer :: set, i, n

      set = find_set(self%sets, name)
      if (set > 0) then
         n = side_size(self)
         allocate (sides(n + 1, size(self%sets(set)%element)))
         if (size(sides) == 0) call new_error(error, input_refused, "the set '"//name//"' lies inside the body: "// &
            'the elements on both sides share its nodes, and nothing can act, open or slip there; mesh two bodies '// &
            'without common nodes, each with a set of its own')
         do i = 1, size(sides, 2)
            sides(:n, i) = self%side(self%sets(set)%element(i), self%sets(set)%side(i))
            sides(n + 1, i) = self%sets(set)%element(i)
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
         is_met(sides(:side_size(self), i)) = .true.
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

   !> Number of nodes that a list of the nodes of a side has room for: 3 in the plane, 8 in space.
   pure integer function side_size(mesh)
      type(mesh_t), intent(in) :: mesh !! the mesh

      side_size = merge(max_face_nodes, 3, is_solid(mesh%element_kind(1)))
   end function side_size

   !> The nodes of a side of an element. In the plane its corners, in the direction that has the element on its left,
   !> and its middle or 0; in space its corners, counter-clockwise as seen from outside, the middles of its edges,
   !> then 0.
   pure function mesh_side(self, element, side) result(nodes)
      class(mesh_t), intent(in) :: self !! the mesh
      integer, intent(in) :: element !! number of the element
      integer, intent(in) :: side !! number of the side in the element
      integer :: nodes(side_size(self))

      nodes = side_nodes(self%element_kind(element), side)
      where (nodes > 0) nodes = self%node(self%node_start(element) - 1 + nodes)
   end function mesh_side

   !> The node at given coordinates, within a thousandth of the distance to the next node; 0 if there is none.
   pure integer function mesh_nearest_node(self, point) result(nearest)
      class(mesh_t), intent(in) :: self !! the mesh
      real(dp), intent(in) :: point(:) !! coordinates (n_dim) [L]
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
      type(mesh_t), intent(in) :: mesh !! the mesh, no element turned over
      integer, intent(out) :: overlapping(2) !! two elements that lie one over the other, 0 where none do
      integer :: nodes(max_face_nodes), n, element, first, home, i, key(3), side
      logical :: is_left

      allocate (table%last(mesh%n_nodes), table%valence(mesh%n_nodes), source=0)
      allocate (table%sides(sum(n_sides(mesh%element_kind))))
      do element = 1, mesh%n_elements
         first = mesh%node_start(element)
         do i = first, first + n_corners(mesh%element_kind(element)) - 1
            table%valence(mesh%node(i)) = table%valence(mesh%node(i)) + 1
         end do
      end do
      overlapping = 0
      do element = 1, mesh%n_elements
         first = mesh%node_start(element)
         n = n_side_corners(mesh%element_kind(element))
         do i = 1, n_sides(mesh%element_kind(element))
            nodes(:side_size(mesh)) = mesh%side(element, i)
            call file_side(table, nodes(:n), home, key, is_left)
            side = place_of(table, home, key)
            if (side == 0) then
               table%n_sides = table%n_sides + 1
               side = table%n_sides
               table%sides(side) = side_t(table%last(home), key, 0, 0)
               table%last(home) = side
            end if
            associate (filed => table%sides(side), number => side_number(element, i))
               if (is_left) then
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

   !> Says where a side is stored: under that one of its corners where fewest elements meet.
   pure subroutine file_side(table, corners, home, other, is_left)
      type(side_table_t), intent(in) :: table !! the sides
      integer, intent(in) :: corners(:) !! its corners, 2 in the plane, of a face 3 or 4
      integer, intent(out) :: home !! that corner
      integer, intent(out) :: other(3) !! the others, as of `side_t`
      logical, intent(out) :: is_left !! whether the side runs from the first to the first of these
      integer :: at, i

      at = 1
      do i = 2, size(corners)
         associate (one => corners(at), next => corners(i))
            if (table%valence(next) < table%valence(one) .or. (table%valence(next) == table%valence(one) &
               .and. next < one)) at = i
         end associate
      end do
      home = corners(at)
      other = 0
      if (size(corners) == 2) then
         other(1) = corners(3 - at)
         is_left = at == 1
      else
         associate (next => corners(mod(at, size(corners)) + 1), last => corners(modulo(at - 2, size(corners)) + 1))
            other(:2) = [min(next, last), max(next, last)]
            is_left = next < last
         end associate
         if (size(corners) > 3) other(3) = corners(mod(at + 1, size(corners)) + 1)
      end if
   end subroutine file_side

   !> Place of a side in the table, 0 if no element has it.
   pure integer function place_of(table, home, other) result(side)
      type(side_table_t), intent(in) :: table !! the sides
      integer, intent(in) :: home !! the corner it would be filed under
      integer, intent(in) :: other(3) !! its other corners, as of `side_t`

      side = table%last(home)
      do while (side > 0)
         if (all(table%sides(side)%other == other)) return
         side = table%sides(side)%before
      end do
   end function place_of

   !> Finds the numbers of the element sides to the left and to the right of a line from one corner to another, or of
   !> the element sides that are a face and that are its back.
   pure subroutine side_table_find(self, corners, left, right)
      class(side_table_t), intent(in) :: self !! the sides
      integer, intent(in) :: corners(:) !! the two corners of the line, or the 3 or 4 of the face, in their order
      integer, intent(out) :: left !! number of the side of the element on the left, 0 for none
      integer, intent(out) :: right !! number of the side of the element on the right, 0 for none
      integer :: side, home, other(3)
      logical :: is_left

      left = 0
      right = 0
      call file_side(self, corners, home, other, is_left)
      side = place_of(self, home, other)
      if (side == 0) return
      left = merge(self%sides(side)%left, self%sides(side)%right, is_left)
      right = merge(self%sides(side)%right, self%sides(side)%left, is_left)
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
