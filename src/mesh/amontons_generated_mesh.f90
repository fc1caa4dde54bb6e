!> Meshes that the program makes: a rectangle of quadrilaterals, or of triangles that halve each cell; a box of
!> hexahedra, or of tetrahedra, six in each cell; quadratic meshes from linear ones; and uniform refinement. Refinement
!> divides every element into four, in space into eight; new nodes lie where the shape functions put them, so that
!> curved sides keep their shape.
module amontons_generated_mesh
   use amontons_element, only: corner_kind, element_names, hex20, hex8, line_ends, max_corners, max_nodes, n_corners, &
      n_element_nodes, n_lines, n_plane_kinds, n_side_corners, n_sides, node_coordinates, quad4, quad8, quad9, &
      shape_functions, tet10, tet4, tri3, tri6
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_mesh, only: mesh_t, parents_t
   use amontons_rounding, only: first_largest
   use amontons_system, only: available_memory_mb
   use amontons_text, only: short_text, to_text
   implicit none (type, external)
   private

   public :: box_t, diagonal_names, new_box_mesh, new_rectangle_mesh, raise_order, rectangle_t, refine_mesh

   !> Most parts of an element.
   integer, parameter :: max_parts = 8
   !> The kinds whose nodes, of hexahedra with the centers of the faces and of the element, become corners of parts.
   integer, parameter :: lattice_kind(*) = [tri6, quad9, tri6, quad9, quad9, tet10, tet10, hex20, hex20]
   !> Number of corners of parts of a hexahedron: its 20 nodes, the centers of its six faces, and its own.
   integer, parameter :: n_lattice_nodes = 27
   !> The nodes of a six-node triangle that are the corners of its parts (corner, part). Part i has corner i.
   integer, parameter :: triangle_parts(*, *) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3, 4, 5, 6], [3, 4])
   !> The nodes of a nine-node quadrilateral that are the corners of its parts (corner, part).
   integer, parameter :: quad_parts(*, *) = reshape([1, 5, 9, 8, 5, 2, 6, 9, 9, 6, 3, 7, 8, 9, 7, 4], [4, 4])
   !> The nodes of a ten-node tetrahedron that are the corners of its parts (corner, part): those of four lie around
   !> the diagonal from the middle of 1, 3 to the middle of 2, 4 (J. Bey, Computing 55, 1995). Each has the node
   !> numbers by which its parts are similar to those of the tetrahedron.
   integer, parameter :: tet_parts(*, *) = reshape([1, 5, 7, 8, 5, 2, 6, 9, 7, 6, 3, 10, 8, 9, 10, 4, 5, 7, 8, 9, &
      6, 7, 5, 9, 7, 8, 9, 10, 9, 6, 7, 10], [4, max_parts])
   !> The nodes of a ten-node tetrahedron in an order in which one of its three inner diagonals is the first.
   integer, parameter :: tet_orders(*, *) = reshape([1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 4, 2, 1, 3, 9, 5, 8, 10, 6, 7, &
      2, 3, 1, 4, 6, 7, 5, 9, 10, 8], [10, 3])
   !> The nodes of a hexahedron that are the corners of its parts (corner, part): after those of the 20-node one the
   !> middles of its faces and its center.
   integer, parameter :: hex_parts(*, *) = reshape([1, 9, 21, 12, 17, 23, 27, 26, 9, 2, 10, 21, 23, 18, 24, 27, &
      21, 10, 3, 11, 27, 24, 19, 25, 12, 21, 11, 4, 26, 27, 25, 20, 17, 23, 27, 26, 5, 13, 22, 16, &
      23, 18, 24, 27, 13, 6, 14, 22, 27, 24, 19, 25, 22, 14, 7, 15, 26, 27, 25, 20, 16, 22, 15, 8], [8, max_parts])

   !> Least memory of a node in the plane and in space: mesh, stiffness as it is assembled and in the order of
   !> elimination, and what is computed from its solution [bytes].
   real(dp), parameter :: node_bytes(2:3) = [1000.0_dp, 2000.0_dp]
   !> Ways to divide a cell into two triangles, as a deck writes them.
   character(11), parameter :: diagonal_names(3) = [character(11) :: 'right', 'left', 'alternating']

   !> A rectangle with its lower left corner at the origin, and its division into cells.
   type :: rectangle_t
      real(dp) :: size(2) = [1.0_dp, 1.0_dp] !! width and height [L]
      integer :: cells(2) = [1, 1] !! number of cells along x and along y
      character(8) :: element = 'quad4' !! one of `element_names`
      character(11) :: diagonal = 'right' !! 'right' (/), 'left' (\) or 'alternating'; read for triangles only
      real(dp) :: grading = 1.0_dp !! height of the last (top) row of cells over that of the first [-]
   end type rectangle_t

   !> A box with the corner of its least coordinates at the origin, and its division into cells.
   type :: box_t
      real(dp) :: size(3) = 1.0_dp !! lengths along x, y and z [L]
      integer :: cells(3) = 1 !! number of cells along x, y and z
      character(8) :: element = 'hex8' !! one of `element_names`; six tetrahedra make a cell
   end type box_t

   !> Lines between nodes, each filed under one of its ends.
   type :: line_table_t
      integer :: n_lines = 0 !! number of lines
      integer, allocatable :: last(:) !! the line filed last under each node, 0 for none (nodes)
      integer, allocatable :: before(:) !! the line filed before each one under the same node, 0 for none
      integer, allocatable :: other(:) !! the other end of each line
   contains
      procedure :: find => line_table_find
   end type line_table_t

contains

   !> Refines a mesh several times, dividing every element into four, in space into eight. The nodes keep their numbers,
   !> new ones follow them; element e of a plane mesh becomes the elements 4 e - 3 to 4 e. Boundary sets and regions
   !> become those of the parts, node sets do not change.
   subroutine refine_mesh(mesh, n_times, error, n_finest)
      type(mesh_t), intent(inout) :: mesh !! a checked mesh, refined on return
      integer, intent(in) :: n_times !! number of uniform refinements
      type(error_t), allocatable, intent(out) :: error !! more nodes than numbers or memory allow
      integer, intent(in), optional :: n_finest !! number of refinements that must be possible later on
      type(mesh_t) :: parent, quadratic
      integer, allocatable :: kinds(:)
      integer :: i, n_dim, n_most

      n_dim = size(mesh%coordinates, 1)
      n_most = n_times
      if (present(n_finest)) n_most = max(n_times, n_finest)
      if (n_most > 0) call check_size('refined '//to_text(n_most)//' times', mesh%n_nodes*real(2**n_dim, dp)**n_most, &
         node_bytes(n_dim), n_dim, error)
      if (allocated(error)) return
      do i = 1, n_times
         kinds = mesh%element_kind
         parent = mesh
         quadratic = mesh
         call raise_order(quadratic, merge(lattice_kind(kinds), kinds, n_element_nodes(kinds) == n_corners(kinds)))
         call cut_elements(mesh, quadratic)
         call raise_order(mesh, [spread(kinds, 1, 2**n_dim)])
         call place_new_nodes(mesh, parent)
         call refine_sets(mesh, quadratic)
      end do
   end subroutine refine_mesh

   !> Refuses a mesh of more nodes than lists can count, or than can be solved in the memory of the machine.
   subroutine check_size(what, n_nodes, bytes, n_dim, error)
      character(*), intent(in) :: what !! what the mesh is, for the message: 'rectangle'
      real(dp), intent(in) :: n_nodes !! number of nodes
      real(dp), intent(in) :: bytes !! what each needs at the least [bytes]
      integer, intent(in) :: n_dim !! number of dimensions
      type(error_t), allocatable, intent(out) :: error !! there are too many, or memory is short
      ! The longest list counts 12 unknowns for the two linear triangles of a cell, and less than three times as many of
      ! quadratic ones; a quadratic hexahedron has nine times the entries. Default integers reach 2^31.
      real(dp), parameter :: most_nodes(2:3) = 2.0_dp**[27, 23]
      real(dp) :: megabytes

      megabytes = 1.0e-6_dp*bytes*n_nodes
      if (n_nodes > most_nodes(n_dim)) then
         call new_error(error, input_refused, what//': more nodes than their numbers allow (about '// &
            trim(merge('134', '8  ', n_dim == 2))//' million)')
      else if (megabytes > available_memory_mb()) then
         call new_error(error, system_failure, what//': not enough memory: '//to_text(nint(n_nodes, int64))// &
            ' nodes need at least '//to_text(nint(megabytes, int64))//' MB, and '// &
            to_text(nint(available_memory_mb(), int64))//' MB are available')
      end if
   end subroutine check_size

   !> Replaces quadratic elements by the linear ones into which each is divided. The centers of eight-node elements of
   !> the plane, and those of the faces and the elements of 20 nodes, become nodes, whose coordinates are not set yet.
   pure subroutine cut_elements(mesh, parent)
      type(mesh_t), intent(inout) :: mesh !! the mesh; gains nodes and elements
      type(mesh_t), intent(in) :: parent !! the same mesh, of quadratic elements
      integer :: node(n_lattice_nodes), element, face, first, i, line, n, n_centers, n_parts, part, ends(2)
      type(line_table_t) :: diagonals

      n_parts = 2**size(parent%coordinates, 1)
      deallocate (mesh%node, mesh%node_start)
      allocate (mesh%node(n_parts*sum(n_corners(parent%element_kind))), mesh%node_start(n_parts*parent%n_elements + 1))
      mesh%node_start(1) = 1
      call new_line_table(diagonals, parent%n_nodes, 6*count(parent%element_kind == hex20))
      ! Those of faces come behind those of elements.
      mesh%n_nodes = parent%n_nodes + count(parent%element_kind == quad8 .or. parent%element_kind == hex20)
      n_centers = 0
      do element = 1, parent%n_elements
         associate (kind => parent%element_kind(element), nodes => parent%node(parent%node_start(element): &
            parent%node_start(element + 1) - 1))
            node(:size(nodes)) = nodes
            if (kind == quad8 .or. kind == hex20) then
               n_centers = n_centers + 1
               node(merge(9, n_lattice_nodes, kind == quad8)) = parent%n_nodes + n_centers
            end if
            if (kind == hex20) then
               ! A face is filed as its diagonal from the corner of the lowest number.
               do face = 1, n_sides(kind)
                  associate (corners => parent%side(element, face))
                     i = minloc(corners(:4), dim=1)
                     ends = corners([i, 1 + mod(i + 1, 4)])
                  end associate
                  call diagonals%find(ends, line)
                  node(n_element_nodes(kind) + face) = mesh%n_nodes + line
               end do
            end if
            n = n_corners(kind)
            do part = 1, n_parts
               associate (start => mesh%node_start(n_parts*(element - 1) + part:n_parts*(element - 1) + part + 1))
                  first = start(1)
                  mesh%node(first:first + n - 1) = node(part_corners(kind, part, part_order(parent, element)))
                  start(2) = first + n
               end associate
            end do
         end associate
      end do
      mesh%element_kind = [spread(corner_kind(parent%element_kind), 1, n_parts)]
      mesh%n_elements = n_parts*parent%n_elements
      mesh%n_nodes = mesh%n_nodes + diagonals%n_lines
      mesh%coordinates = reshape(parent%coordinates, [size(parent%coordinates, 1), mesh%n_nodes], pad=[0.0_dp])
   end subroutine cut_elements

   !> The nodes of a quadratic element that are the corners of a part of it.
   pure function part_corners(kind, part, order) result(corners)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: part !! the part
      integer, intent(in) :: order !! of the nodes of a tetrahedron, from `part_order`
      integer :: corners(n_corners(kind))

      select case (corner_kind(kind))
      case (tri3)
         corners = triangle_parts(:, part)
      case (quad4)
         corners = quad_parts(:, part)
      case (tet4)
         corners = tet_orders(tet_parts(:, part), order)
      case default
         corners = hex_parts(:, part)
      end select
   end function part_corners

   !> The order of the nodes of a tetrahedron in which its shortest inner diagonal is the first; 1 of other elements.
   pure integer function part_order(mesh, element) result(order)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      real(dp) :: length(size(tet_orders, 2))

      order = 1
      if (corner_kind(mesh%element_kind(element)) /= tet4) return
      do order = 1, size(length)
         associate (x => mesh%coordinates(:, mesh%node(mesh%node_start(element) - 1 + tet_orders(:4, order))))
            length(order) = norm2(x(:, 1) + x(:, 3) - x(:, 2) - x(:, 4))
         end associate
      end do
      order = first_largest(-length)
   end function part_order

   !> Sets the coordinates of the new nodes by the shape functions of the elements before, and their parents.
   pure subroutine place_new_nodes(mesh, parent)
      type(mesh_t), intent(inout) :: mesh !! the refined mesh, its new nodes anywhere
      type(mesh_t), intent(in) :: parent !! the mesh before
      real(dp), allocatable :: share(:, :, :, :, :)
      integer, allocatable :: home(:, :)
      type(parents_t) :: parents
      integer :: element, first, i, last, n, node, part, pass

      ! The element of a new node, the part of it and the place in this where the node occurs first.
      associate (n_parts => 2**size(mesh%coordinates, 1))
         allocate (home(3, mesh%n_nodes))
         do element = mesh%n_elements, 1, -1
            first = mesh%node_start(element)
            do i = mesh%node_start(element + 1) - first, 1, -1
               home(:, mesh%node(first + i - 1)) = [(element - 1)/n_parts + 1, mod(element - 1, n_parts) + 1, i]
            end do
         end do
      end associate
      call find_part_shares(share, parent%element_kind)
      n = 0
      allocate (parents%start(mesh%n_nodes + 1), source=1)
      if (allocated(parent%parents)) then
         parents%start(:parent%n_nodes + 1) = parent%parents%start
         n = size(parent%parents%node)
      end if
      do pass = 1, 2
         if (pass == 2) then
            ! Behind those of the mesh before.
            associate (total => parents%start(mesh%n_nodes + 1) - 1)
               allocate (parents%node(total), parents%weight(total))
            end associate
            if (n > 0) parents%node(:n) = parent%parents%node
            if (n > 0) parents%weight(:n) = parent%parents%weight
         end if
         do node = parent%n_nodes + 1, mesh%n_nodes
            element = home(1, node)
            part = home(2, node)
            associate (kind => parent%element_kind(element), nodes => parent%node(parent%node_start(element): &
               parent%node_start(element + 1) - 1))
               associate (weight => share(:size(nodes), home(3, node), part, part_order(parent, element), kind))
                  first = parents%start(node)
                  last = first + count(abs(weight) > 0.0_dp) - 1
                  parents%start(node + 1) = last + 1
                  if (pass == 1) cycle
                  parents%node(first:last) = pack(nodes, abs(weight) > 0.0_dp)
                  parents%weight(first:last) = pack(weight, abs(weight) > 0.0_dp)
                  mesh%coordinates(:, node) = matmul(parent%coordinates(:, nodes), weight)
               end associate
            end associate
         end do
      end do
      mesh%parents = parents
   end subroutine place_new_nodes

   !> Finds the shape functions of elements at the nodes of their parts.
   pure subroutine find_part_shares(share, kinds)
      real(dp), allocatable, intent(out) :: share(:, :, :, :, :)
         !! the shape functions (shape function, node, part, order of `part_order`, kind) [-]
      integer, intent(in) :: kinds(:) !! the kinds that occur
      real(dp), allocatable :: corners(:, :), derivatives(:, :)
      real(dp) :: values(max_nodes)
      integer :: kind, order, part, i

      allocate (share(max_nodes, max_nodes, max_parts, size(tet_orders, 2), size(element_names)), source=0.0_dp)
      do kind = 1, size(element_names)
         if (.not. any(kinds == kind)) cycle
         do order = 1, merge(size(tet_orders, 2), 1, corner_kind(kind) == tet4)
            do part = 1, merge(4, max_parts, kind <= n_plane_kinds)
               corners = lattice(kind, part_corners(kind, part, order))
               derivatives = spread(corners(:, 1), 2, max_nodes)
               do i = 1, n_element_nodes(kind)
                  call shape_functions(corner_kind(kind), node_coordinates(kind, i), values, derivatives)
                  call shape_functions(kind, matmul(corners, values(:n_corners(kind))), values, derivatives)
                  share(:n_element_nodes(kind), i, part, order, kind) = values(:n_element_nodes(kind))
               end do
            end do
         end do
      end do
   end subroutine find_part_shares

   !> Reference coordinates of nodes of a divided element, in the order of its quadratic kind, then the centers of its
   !> faces and its own (n_dim, nodes) [-].
   pure function lattice(kind, nodes) result(xi)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: nodes(:) !! the nodes
      real(dp), allocatable :: xi(:, :)
      real(dp), parameter :: centers(*, *) = reshape(real([0, 0, -1, 0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0, &
         0, 0, 0], dp), [3, n_lattice_nodes - n_element_nodes(hex20)])
      integer :: i

      allocate (xi(merge(2, 3, kind <= n_plane_kinds), size(nodes)))
      do i = 1, size(nodes)
         if (nodes(i) <= n_element_nodes(lattice_kind(kind))) then
            xi(:, i) = node_coordinates(lattice_kind(kind), nodes(i))
         else
            xi(:, i) = centers(:, nodes(i) - n_element_nodes(hex20))
         end if
      end do
   end function lattice

   !> Replaces the sides of the boundary sets and the elements of the regions by their parts: a side of a part lies on a
   !> side of its element that has as many of its corners as there are dimensions.
   pure subroutine refine_sets(mesh, parent)
      type(mesh_t), intent(inout) :: mesh !! the refined mesh, its sets those of the mesh before
      type(mesh_t), intent(in) :: parent !! the mesh before, of quadratic elements
      integer, allocatable :: nodes(:), element(:), side(:)
      integer :: i, k, n, n_dim, n_parts, own, part, place

      n_dim = size(mesh%coordinates, 1)
      n_parts = 2**n_dim
      do i = 1, size(mesh%sets)
         associate (set => mesh%sets(i))
            ! Every side has half as many parts as its element.
            allocate (element(n_parts/2*size(set%element)), side(n_parts/2*size(set%element)))
            n = 0
            do k = 1, size(set%element)
               nodes = parent%side(set%element(k), set%side(k))
               ! The first is that of the part with the number of the side, so that lines stay lines.
               do part = set%side(k), set%side(k) + n_parts - 1
                  own = n_parts*(set%element(k) - 1) + 1 + mod(part - 1, n_parts)
                  do place = 1, n_sides(mesh%element_kind(own))
                     if (count_common(mesh%side(own, place), nodes) < n_dim) cycle
                     n = n + 1
                     element(n) = own
                     side(n) = place
                  end do
               end do
            end do
            call move_alloc(element, set%element)
            call move_alloc(side, set%side)
         end associate
      end do
      if (.not. allocated(mesh%regions)) return
      do i = 1, size(mesh%regions)
         associate (region => mesh%regions(i))
            region%element = [((n_parts*(region%element(k) - 1) + part, part=1, n_parts), k=1, size(region%element))]
         end associate
      end do

   contains

      !> Number of nodes of a side that another one has, too.
      pure integer function count_common(one, other) result(n)
         integer, intent(in) :: one(:) !! nodes of the side, or 0
         integer, intent(in) :: other(:) !! nodes of the other side, or 0
         integer :: k

         n = count([(one(k) > 0 .and. any(other == one(k)), k=1, size(one))])
      end function count_common

   end subroutine refine_sets

   !> Turns linear elements of a mesh into quadratic ones of given kinds; the boundary sets keep their sides.
   pure subroutine raise_order(mesh, kinds)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      integer, intent(in) :: kinds(:)
         !! kind of each element after: a quadratic one in the place of the linear one of the same shape, or its own;
         !! elements that share a side are all raised or all kept (n_elements)
      type(line_table_t) :: lines
      integer, allocatable :: valence(:), node(:), node_start(:)
      real(dp), allocatable :: more(:, :)
      integer :: element, i, n, n_more, first, ends(2), line

      if (all(kinds == mesh%element_kind)) return
      allocate (valence(mesh%n_nodes), source=0)
      do i = 1, size(mesh%node)
         valence(mesh%node(i)) = valence(mesh%node(i)) + 1
      end do
      ! Each line between two corners, which gets a node in its middle, is filed under that corner where fewer elements
      ! meet, which keeps every search short.
      n = sum(n_lines(mesh%element_kind))
      call new_line_table(lines, mesh%n_nodes, n)
      allocate (more(size(mesh%coordinates, 1), n + mesh%n_elements), node(sum(n_element_nodes(kinds))), &
         node_start(mesh%n_elements + 1))
      node_start(1) = 1
      do element = 1, mesh%n_elements
         first = node_start(element)
         node_start(element + 1) = first + n_element_nodes(kinds(element))
         n = mesh%node_start(element + 1) - mesh%node_start(element)
         node(first:first + n - 1) = mesh%node(mesh%node_start(element):mesh%node_start(element + 1) - 1)
         if (kinds(element) == mesh%element_kind(element)) cycle
         do i = 1, n_lines(kinds(element))
            ends = node(first - 1 + line_ends(kinds(element), i))
            if (valence(ends(2)) < valence(ends(1)) .or. (valence(ends(2)) == valence(ends(1)) &
               .and. ends(2) < ends(1))) ends = ends([2, 1])
            call lines%find(ends, line)
            more(:, line) = 0.5_dp*(mesh%coordinates(:, ends(1)) + mesh%coordinates(:, ends(2)))
            node(first + n + i - 1) = mesh%n_nodes + line
         end do
      end do
      n_more = lines%n_lines
      ! The centers of nine-node elements come last.
      do element = 1, mesh%n_elements
         if (kinds(element) /= quad9 .or. mesh%element_kind(element) == quad9) cycle
         first = node_start(element)
         n_more = n_more + 1
         more(:, n_more) = 0.25_dp*sum(mesh%coordinates(:, node(first:first + 3)), dim=2)
         node(first + 8) = mesh%n_nodes + n_more
      end do
      mesh%coordinates = reshape([mesh%coordinates, more(:, :n_more)], &
         [size(more, 1), mesh%n_nodes + n_more])
      mesh%n_nodes = mesh%n_nodes + n_more
      mesh%element_kind = kinds
      call move_alloc(node, mesh%node)
      call move_alloc(node_start, mesh%node_start)
   end subroutine raise_order

   !> Makes an empty table of lines.
   pure subroutine new_line_table(table, n_nodes, n_most)
      type(line_table_t), intent(out) :: table !! the table
      integer, intent(in) :: n_nodes !! number of nodes
      integer, intent(in) :: n_most !! number of lines that it has room for

      allocate (table%last(n_nodes), source=0)
      allocate (table%before(n_most), table%other(n_most))
   end subroutine new_line_table

   !> Finds the line between two nodes, and files it if it is new.
   pure subroutine line_table_find(self, ends, line)
      class(line_table_t), intent(inout) :: self !! the lines
      integer, intent(in) :: ends(2) !! the nodes; the line is filed under the first one
      integer, intent(out) :: line !! number of the line

      line = self%last(ends(1))
      do while (line > 0)
         if (self%other(line) == ends(2)) return
         line = self%before(line)
      end do
      self%n_lines = self%n_lines + 1
      line = self%n_lines
      self%other(line) = ends(2)
      self%before(line) = self%last(ends(1))
      self%last(ends(1)) = line
   end subroutine line_table_find

   !> Makes the mesh of a rectangle, with the boundary sets left, right, bottom and top.
   subroutine new_rectangle_mesh(mesh, rectangle, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(rectangle_t), intent(in) :: rectangle !! the rectangle and its cells
      type(error_t), allocatable, intent(out) :: error !! the rectangle makes no sense, or memory is short
      ! Also what is computed for nodes of the boundary, of which a strip consists; and the factor of nested dissection,
      ! which has 90 to 120 numbers an unknown on squares of 256 to 1024 cells, and more of them the more cells the
      ! shorter side has. Half of that leaves room for doubt.
      real(dp), parameter :: boundary_bytes = 450.0_dp, factor_bytes = 96.0_dp
      real(dp), allocatable :: height(:)
      integer, allocatable :: parts(:, :)
      integer :: i, kind, shape

      kind = findloc(element_names(:n_plane_kinds) == rectangle%element, .true., dim=1)
      if (any(.not. rectangle%size > 0.0_dp) .or. any(rectangle%cells < 1) .or. .not. rectangle%grading > 0.0_dp &
         .or. kind == 0 .or. all(diagonal_names /= rectangle%diagonal)) then
         call new_error(error, input_refused, &
            'rectangle: size, cells and grading must be positive, element and diagonal known words')
         return
      end if
      shape = corner_kind(kind)
      call check_size('rectangle', product(rectangle%cells + 1.0_dp)*merge(1.0_dp, 3.0_dp, kind == shape), &
         node_bytes(2) + boundary_bytes + factor_bytes*log(1.0_dp + minval(rectangle%cells))/log(2.0_dp), 2, error)
      if (allocated(error)) return
      if (shape == quad4) then
         parts = spread([1, 2, 3, 4], 2, 2)
      else
         ! The diagonal to the right, and to the left.
         parts = reshape([1, 2, 3, 3, 4, 1, 4, 1, 2, 2, 3, 4], [6, 2])
         if (rectangle%diagonal == 'right') parts(:, 2) = parts(:, 1)
         if (rectangle%diagonal == 'left') parts(:, 1) = parts(:, 2)
      end if
      call fill_grid(mesh, 'rectangle', rectangle%size, rectangle%cells, kind, parts)
      associate (nx => rectangle%cells(1), ny => rectangle%cells(2))
         if (ny > 1 .and. abs(rectangle%grading - 1.0_dp) > 0.0_dp) then
            ! The heights of the rows are a geometric sequence.
            allocate (height(0:ny))
            height(0) = 0.0_dp
            do i = 1, ny
               height(i) = height(i - 1) + (rectangle%grading**(1.0_dp/real(ny - 1, dp)))**(i - 1)
            end do
            height = height*(rectangle%size(2)/height(ny))
            mesh%coordinates(2, :) = height([((i - 1)/(nx + 1), i=1, mesh%n_nodes)])
         end if
      end associate
      call raise_order(mesh, spread(kind, 1, mesh%n_elements))
   end subroutine new_rectangle_mesh

   !> Makes the mesh of a box, with the boundary sets left, right (along x), front, back (y), bottom and top (z).
   subroutine new_box_mesh(mesh, box, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(box_t), intent(in) :: box !! the box and its cells
      type(error_t), allocatable, intent(out) :: error !! the box makes no sense, or memory is short
      ! The corners of a cell that six tetrahedra have, all around its diagonal, in the orders by which refinement makes
      ! those of smaller cells.
      integer, parameter :: six(*) = [1, 2, 3, 7, 3, 4, 1, 7, 1, 4, 8, 7, 8, 5, 1, 7, 1, 5, 6, 7, 6, 2, 1, 7]
      integer, allocatable :: parts(:)
      integer :: i, kind, shape
      real(dp) :: n_nodes

      kind = findloc(element_names == box%element, .true., dim=1)
      if (any(.not. box%size > 0.0_dp) .or. any(box%cells < 1) .or. kind <= n_plane_kinds) then
         call new_error(error, input_refused, 'box: size and cells must be positive, element that of a solid')
         return
      end if
      shape = corner_kind(kind)
      n_nodes = product(box%cells + 1.0_dp)
      if (kind /= shape) n_nodes = n_nodes*merge(4.0_dp, 8.0_dp, kind == hex20)
      call check_size('box', n_nodes, node_bytes(3), 3, error)
      if (allocated(error)) return
      parts = six
      if (shape == hex8) parts = [(i, i=1, 8)]
      call fill_grid(mesh, 'box', box%size, box%cells, kind, spread(parts, 2, 2))
      call raise_order(mesh, spread(kind, 1, mesh%n_elements))
   end subroutine new_box_mesh

   !> Makes the nodes of a rectangle or box, along x, then y, then z, its linear elements and its boundary sets.
   pure subroutine fill_grid(mesh, noun, lengths, cells, kind, parts)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      character(*), intent(in) :: noun !! what it is called
      real(dp), intent(in) :: lengths(:) !! its length along each axis (n_dim) [L]
      integer, intent(in) :: cells(:) !! number of its cells along each axis (n_dim)
      integer, intent(in) :: kind !! kind of the elements that they are to become
      integer, intent(in) :: parts(:, :)
         !! the corners of a cell that its linear elements have, one after the other, of cells of even and odd places
      character(:), allocatable :: size_text, cell_text
      integer :: corner(max_corners), place(size(cells)), steps(size(cells)), cell, i, shape

      size_text = noun
      cell_text = ''
      do i = 1, size(cells)
         size_text = size_text//trim(merge(' x', '  ', i > 1))//' '//short_text(lengths(i))
         cell_text = cell_text//trim(merge(' x', ', ', i > 1))//' '//to_text(cells(i))
      end do
      mesh%source = size_text//cell_text//' cells of '//trim(element_names(kind))
      steps = [(product(cells(:i - 1) + 1), i=1, size(cells))]
      mesh%n_nodes = product(cells + 1)
      allocate (mesh%coordinates(size(cells), mesh%n_nodes))
      do i = 1, mesh%n_nodes
         mesh%coordinates(:, i) = lengths*mod((i - 1)/steps, cells + 1)/cells
      end do
      shape = corner_kind(kind)
      mesh%n_elements = product(cells)*size(parts, 1)/n_corners(shape)
      allocate (mesh%element_kind(mesh%n_elements), source=shape)
      mesh%node_start = [(1 + n_corners(shape)*i, i=0, mesh%n_elements)]
      allocate (mesh%node(n_corners(shape)*mesh%n_elements))
      do cell = 0, product(cells) - 1
         place = mod(cell/[(product(cells(:i - 1)), i=1, size(cells))], cells)
         corner(:4) = 1 + dot_product(steps, place) + [0, 1, 1 + steps(2), steps(2)]
         corner(5:) = corner(:4) + steps(size(steps))
         mesh%node(size(parts, 1)*cell + 1:size(parts, 1)*(cell + 1)) = corner(parts(:, 1 + mod(sum(place), 2)))
      end do
      call name_sides(mesh, cells)
   end subroutine fill_grid

   !> Makes the boundary sets of the sides of a rectangle, which follow each other counter-clockwise around it, or of
   !> the faces of a box.
   pure subroutine name_sides(mesh, cells)
      type(mesh_t), intent(inout) :: mesh !! the mesh, its elements connected, nodes numbered along x, then y, then z
      integer, intent(in) :: cells(:) !! number of cells along each axis
      character(6), parameter :: names(2, 3) = reshape([character(6) :: 'left', 'right', 'bottom', 'top', 'bottom', &
         'top'], [2, 3])
      integer :: axis, cell, element, end, i, k, n, per_cell, per_face, set, step

      per_cell = mesh%n_elements/product(cells)
      per_face = merge(2, 1, mesh%element_kind(1) == tet4)
      allocate (mesh%sets(2*size(cells)))
      do set = 1, size(mesh%sets)
         axis = (set + 1)/2
         end = 2 - mod(set, 2)
         mesh%sets(set)%name = trim(names(end, axis))
         if (size(cells) == 3 .and. axis == 2) mesh%sets(set)%name = trim(merge('front', 'back ', end == 1))
         n = product(cells)/cells(axis)
         allocate (mesh%sets(set)%element(per_face*n), mesh%sets(set)%side(per_face*n))
         step = product(cells(:axis - 1))
         n = 0
         do k = 0, product(cells)/cells(axis) - 1
            cell = mod(k, step) + step*(cells(axis)*(k/step) + (end - 1)*(cells(axis) - 1))
            do element = per_cell*cell + 1, per_cell*cell + per_cell
               do i = 1, n_sides(mesh%element_kind(element))
                  if (.not. is_on_end(mesh%side(element, i), n_side_corners(mesh%element_kind(element)))) cycle
                  n = n + 1
                  mesh%sets(set)%element(n) = element
                  mesh%sets(set)%side(n) = i
               end do
            end do
         end do
         if (size(cells) == 2 .and. (set == 1 .or. set == 4)) then
            mesh%sets(set)%element = mesh%sets(set)%element(n:1:-1)
            mesh%sets(set)%side = mesh%sets(set)%side(n:1:-1)
         end if
      end do

   contains

      !> Whether all corners of a side lie on the end of the axis.
      pure logical function is_on_end(nodes, n_corners)
         integer, intent(in) :: nodes(:) !! its nodes, corners first
         integer, intent(in) :: n_corners !! number of its corners

         is_on_end = all(mod((nodes(:n_corners) - 1)/product(cells(:axis - 1) + 1), cells(axis) + 1) &
            == (end - 1)*cells(axis))
      end function is_on_end

   end subroutine name_sides

end module amontons_generated_mesh
