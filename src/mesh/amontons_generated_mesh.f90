!> Meshes that the program makes: a rectangle of quadrilaterals, or of triangles that halve each cell; quadratic meshes
!> from linear ones; and uniform refinement of any mesh. Refinement divides every element into four; the middles of
!> sides lie where the shape functions put them, so that curved sides keep their shape.
module amontons_generated_mesh
   use amontons_element, only: corner_kind, element_names, is_triangle, max_nodes, n_corners, n_element_nodes, &
      n_plane_kinds, n_sides, node_coordinates, quad4, quad8, quad9, shape_functions, tri3, tri6
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_mesh, only: mesh_t, new_side_table, parents_t, side_number, side_table_t
   use amontons_system, only: available_memory_mb
   use amontons_text, only: short_text, to_text
   implicit none (type, external)
   private

   public :: diagonal_names, new_rectangle_mesh, raise_order, rectangle_t, refine_mesh

   !> Number of parts of an element.
   integer, parameter :: n_parts = 4
   !> The nodes of a six-node triangle that are the corners of its parts (corner, part). Part i has corner i.
   integer, parameter :: triangle_parts(3, n_parts) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3, 4, 5, 6], [3, n_parts])
   !> The nodes of a nine-node quadrilateral that are the corners of its parts (corner, part).
   integer, parameter :: quad_parts(4, n_parts) = reshape([1, 5, 9, 8, 5, 2, 6, 9, 9, 6, 3, 7, 8, 9, 7, 4], &
      [4, n_parts])

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

contains

   !> Refines a mesh several times, dividing every element into four. The nodes keep their numbers, new ones follow
   !> them; element e becomes the elements 4 e - 3 to 4 e. Boundary sets and regions become those of the parts, node
   !> sets do not change.
   subroutine refine_mesh(mesh, n_times, error, n_finest)
      type(mesh_t), intent(inout) :: mesh !! a checked mesh, refined on return
      integer, intent(in) :: n_times !! number of uniform refinements
      type(error_t), allocatable, intent(out) :: error !! more nodes than numbers or memory allow
      integer, intent(in), optional :: n_finest !! number of refinements that must be possible later on
      ! As many as a generated mesh may have.
      real(dp), parameter :: most_nodes = 2.0_dp**27
      ! Mesh, stiffness as it is assembled and in the order of elimination, and what is computed from its solution.
      real(dp), parameter :: node_bytes = 1000.0_dp
      type(mesh_t) :: parent, quadratic
      integer, allocatable :: kinds(:)
      real(dp) :: n_nodes, megabytes
      integer :: i, n_most

      n_most = n_times
      if (present(n_finest)) n_most = max(n_times, n_finest)
      n_nodes = mesh%n_nodes*real(n_parts, dp)**n_most
      megabytes = 1.0e-6_dp*node_bytes*n_nodes
      if (n_nodes > most_nodes) then
         call new_error(error, input_refused, 'refined '//to_text(n_most)//' times, the mesh has more nodes than '// &
            'node numbers allow (about 134 million)')
      else if (megabytes > available_memory_mb() .and. n_most > 0) then
         call new_error(error, system_failure, 'not enough memory: '//to_text(nint(n_nodes, int64))// &
            ' nodes need at least '//to_text(nint(megabytes, int64))//' MB, and '// &
            to_text(nint(available_memory_mb(), int64))//' MB are available')
      end if
      if (allocated(error)) return
      do i = 1, n_times
         kinds = mesh%element_kind
         parent = mesh
         ! The nodes that become corners of parts are those of quadratic elements.
         quadratic = mesh
         call raise_order(quadratic, merge(merge(tri6, quad9, is_triangle(kinds)), kinds, &
            n_element_nodes(kinds) == n_corners(kinds)))
         call cut_elements(mesh, quadratic)
         call raise_order(mesh, [spread(kinds, 1, n_parts)])
         call place_new_nodes(mesh, parent)
         call refine_sets(mesh)
      end do
   end subroutine refine_mesh

   !> Replaces quadratic elements by the four linear ones into which each is divided. The centers of eight-node elements
   !> become nodes, whose coordinates are not set yet.
   pure subroutine cut_elements(mesh, parent)
      type(mesh_t), intent(inout) :: mesh !! the mesh; gains nodes and elements
      type(mesh_t), intent(in) :: parent !! the same mesh, of quadratic elements
      integer :: node(n_element_nodes(quad9)), element, part, n, n_centers, first

      deallocate (mesh%node, mesh%node_start)
      allocate (mesh%node(n_parts*sum(n_corners(parent%element_kind))), mesh%node_start(n_parts*parent%n_elements + 1))
      mesh%node_start(1) = 1
      n_centers = 0
      do element = 1, parent%n_elements
         associate (kind => parent%element_kind(element), nodes => parent%node(parent%node_start(element): &
            parent%node_start(element + 1) - 1))
            node(:size(nodes)) = nodes
            if (kind == quad8) then
               n_centers = n_centers + 1
               node(size(node)) = parent%n_nodes + n_centers
            end if
            n = n_corners(kind)
            do part = 1, n_parts
               associate (start => mesh%node_start(n_parts*(element - 1) + part:n_parts*(element - 1) + part + 1))
                  first = start(1)
                  mesh%node(first:first + n - 1) = node(part_corners(kind, part))
                  start(2) = first + n
               end associate
            end do
         end associate
      end do
      mesh%element_kind = [spread(corner_kind(parent%element_kind), 1, n_parts)]
      mesh%n_elements = n_parts*parent%n_elements
      mesh%n_nodes = parent%n_nodes + n_centers
      mesh%coordinates = reshape(parent%coordinates, [2, mesh%n_nodes], pad=[0.0_dp])
   end subroutine cut_elements

   !> The nodes of a quadratic element, in the numbering of the nine-node one, that are the corners of a part of it.
   pure function part_corners(kind, part) result(corners)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: part !! the part, 1 to 4
      integer :: corners(n_corners(kind))

      if (is_triangle(kind)) then
         corners = triangle_parts(:, part)
      else
         corners = quad_parts(:, part)
      end if
   end function part_corners

   !> Sets the coordinates of the new nodes by the shape functions of the elements before, and their parents.
   pure subroutine place_new_nodes(mesh, parent)
      type(mesh_t), intent(inout) :: mesh !! the refined mesh, its new nodes anywhere
      type(mesh_t), intent(in) :: parent !! the mesh before
      real(dp) :: share(max_nodes, max_nodes, n_parts, n_plane_kinds)
      logical :: is_placed(mesh%n_nodes)
      type(parents_t) :: parents
      integer :: element, pass, part, i, first, last, n

      share = part_shares()
      allocate (parents%start(mesh%n_nodes + 1))
      do pass = 1, 2
         is_placed = .false.
         is_placed(:parent%n_nodes) = .true.
         if (pass == 2) then
            ! Behind those of the mesh before.
            n = 0
            parents%start(:parent%n_nodes + 1) = 1
            if (allocated(parent%parents)) then
               parents%start(:parent%n_nodes + 1) = parent%parents%start
               n = size(parent%parents%node)
            end if
            do i = parent%n_nodes + 1, mesh%n_nodes
               parents%start(i + 1) = parents%start(i) + parents%start(i + 1)
            end do
            associate (total => parents%start(mesh%n_nodes + 1) - 1)
               allocate (parents%node(total), parents%weight(total))
            end associate
            if (n > 0) parents%node(:n) = parent%parents%node
            if (n > 0) parents%weight(:n) = parent%parents%weight
         end if
         do element = 1, parent%n_elements
            associate (kind => parent%element_kind(element), nodes => parent%node(parent%node_start(element): &
               parent%node_start(element + 1) - 1))
               do part = 1, n_parts
                  do i = 1, size(nodes)
                     associate (node => mesh%node(mesh%node_start(n_parts*(element - 1) + part) + i - 1), &
                        weight => share(:size(nodes), i, part, kind))
                        if (is_placed(node)) cycle
                        is_placed(node) = .true.
                        if (pass == 1) then
                           parents%start(node + 1) = count(abs(weight) > 0.0_dp)
                           cycle
                        end if
                        first = parents%start(node)
                        last = parents%start(node + 1) - 1
                        parents%node(first:last) = pack(nodes, abs(weight) > 0.0_dp)
                        parents%weight(first:last) = pack(weight, abs(weight) > 0.0_dp)
                        mesh%coordinates(:, node) = matmul(parent%coordinates(:, nodes), weight)
                     end associate
                  end do
               end do
            end associate
         end do
      end do
      mesh%parents = parents
   end subroutine place_new_nodes

   !> The shape functions of the elements of every kind at the nodes of their parts (shape function, node, part,
   !> kind) [-].
   pure function part_shares() result(share)
      real(dp) :: share(max_nodes, max_nodes, n_parts, n_plane_kinds)
      real(dp) :: corners(2, 4), xi(2), values(max_nodes), derivatives(2, max_nodes)
      integer :: kind, part, i, shape

      share = 0.0_dp
      do kind = 1, n_plane_kinds
         shape = corner_kind(kind)
         do part = 1, n_parts
            associate (places => part_corners(kind, part))
               do i = 1, size(places)
                  corners(:, i) = node_coordinates(merge(tri6, quad9, is_triangle(kind)), places(i))
               end do
            end associate
            do i = 1, n_element_nodes(kind)
               call shape_functions(shape, node_coordinates(kind, i), values, derivatives)
               xi = matmul(corners(:, :n_corners(kind)), values(:n_corners(kind)))
               call shape_functions(kind, xi, values, derivatives)
               share(:n_element_nodes(kind), i, part, kind) = values(:n_element_nodes(kind))
            end do
         end do
      end do
   end function part_shares

   !> Replaces the sides of the boundary sets and the elements of the regions by their parts: side i of an element is
   !> that of its parts i and i + 1.
   pure subroutine refine_sets(mesh)
      type(mesh_t), intent(inout) :: mesh !! the refined mesh, its sets those of the mesh before
      integer :: i, k, part

      do i = 1, size(mesh%sets)
         associate (set => mesh%sets(i))
            set%element = [(n_parts*(set%element(k) - 1) + set%side(k), n_parts*(set%element(k) - 1) &
               + mod(set%side(k), n_corners(mesh%element_kind(n_parts*set%element(k)))) + 1, k=1, size(set%element))]
            set%side = [(set%side(k), set%side(k), k=1, size(set%side))]
         end associate
      end do
      if (.not. allocated(mesh%regions)) return
      do i = 1, size(mesh%regions)
         associate (region => mesh%regions(i))
            region%element = [((n_parts*(region%element(k) - 1) + part, part=1, n_parts), k=1, size(region%element))]
         end associate
      end do
   end subroutine refine_sets

   !> Turns linear elements of a mesh into quadratic ones of given kinds; the boundary sets keep their sides.
   pure subroutine raise_order(mesh, kinds)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      integer, intent(in) :: kinds(:)
         !! kind of each element after: a quadratic one in the place of the linear one of the same shape, or its own;
         !! elements that share a side are all raised or all kept (n_elements)
      type(side_table_t) :: table
      integer, allocatable :: middle(:), node(:), node_start(:)
      real(dp), allocatable :: more(:, :)
      integer :: element, i, n, n_more, first, left, right, overlapping(2), ends(2)

      if (all(kinds == mesh%element_kind)) return
      call new_side_table(table, mesh, overlapping)
      ! The node in the middle of each side by the side's number, and the nodes that are new.
      allocate (middle(0:side_number(mesh%n_elements + 1, 0)), source=0)
      allocate (more(2, size(mesh%node) + mesh%n_elements), node(sum(n_element_nodes(kinds))), &
         node_start(mesh%n_elements + 1))
      n_more = 0
      node_start(1) = 1
      do element = 1, mesh%n_elements
         first = node_start(element)
         node_start(element + 1) = first + n_element_nodes(kinds(element))
         n = mesh%node_start(element + 1) - mesh%node_start(element)
         node(first:first + n - 1) = mesh%node(mesh%node_start(element):mesh%node_start(element + 1) - 1)
         if (kinds(element) == mesh%element_kind(element)) cycle
         do i = 1, n
            if (middle(side_number(element, i)) == 0) then
               n_more = n_more + 1
               ends = node(first - 1 + [i, mod(i, n) + 1])
               more(:, n_more) = 0.5_dp*(mesh%coordinates(:, ends(1)) + mesh%coordinates(:, ends(2)))
               call table%find(ends(1), ends(2), left, right)
               middle([left, right]) = mesh%n_nodes + n_more
            end if
            node(first + n + i - 1) = middle(side_number(element, i))
         end do
      end do
      ! The centers of nine-node elements come last.
      do element = 1, mesh%n_elements
         if (kinds(element) /= quad9 .or. mesh%element_kind(element) == quad9) cycle
         first = node_start(element)
         n_more = n_more + 1
         more(:, n_more) = 0.25_dp*sum(mesh%coordinates(:, node(first:first + 3)), dim=2)
         node(first + 8) = mesh%n_nodes + n_more
      end do
      mesh%coordinates = reshape([mesh%coordinates, more(:, :n_more)], [2, mesh%n_nodes + n_more])
      mesh%n_nodes = mesh%n_nodes + n_more
      mesh%element_kind = kinds
      call move_alloc(node, mesh%node)
      call move_alloc(node_start, mesh%node_start)
   end subroutine raise_order

   !> Makes the mesh of a rectangle, with the boundary sets left, right, bottom and top.
   subroutine new_rectangle_mesh(mesh, rectangle, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(rectangle_t), intent(in) :: rectangle !! the rectangle and its cells
      type(error_t), allocatable, intent(out) :: error !! the rectangle makes no sense, or memory is short
      ! The longest list counts 12 unknowns for the two linear triangles of a cell, 24 for quadratic ones; default
      ! integers reach 2^31.
      integer(int64), parameter :: most_nodes = 2_int64**27
      ! The least memory, which is refused before a mesh is made: mesh, stiffness as it is assembled and in the order of
      ! elimination, and what is computed from its solution (1200 bytes and more); and the factor of nested dissection,
      ! which has 90 to 120 numbers an unknown on squares of 256 to 1024 cells, and more of them the more cells the
      ! shorter side has. Half of that leaves room for doubt.
      real(dp), parameter :: node_bytes = 1000.0_dp, factor_bytes = 96.0_dp
      real(dp) :: n_nodes, megabytes
      integer :: kind, shape

      kind = findloc(element_names(:n_plane_kinds) == rectangle%element, .true., dim=1)
      if (any(.not. rectangle%size > 0.0_dp) .or. any(rectangle%cells < 1) .or. .not. rectangle%grading > 0.0_dp &
         .or. kind == 0 .or. all(diagonal_names /= rectangle%diagonal)) then
         call new_error(error, input_refused, &
            'rectangle: size, cells and grading must be positive, element and diagonal known words')
         return
      end if
      shape = corner_kind(kind)
      if (product(int(rectangle%cells, int64) + 1)*merge(1, 2, kind == shape) > most_nodes) then
         call new_error(error, input_refused, 'rectangle: more cells than node numbers allow (about 134 million, '// &
            'of quadratic elements half as many)')
         return
      end if
      n_nodes = product(rectangle%cells + 1.0_dp)*merge(1.0_dp, 3.0_dp, kind == shape)
      megabytes = 1.0e-6_dp*n_nodes*(node_bytes + factor_bytes*log(1.0_dp + minval(rectangle%cells))/log(2.0_dp))
      if (megabytes > available_memory_mb()) then
         call new_error(error, system_failure, 'rectangle: not enough memory: '//to_text(nint(n_nodes, int64))// &
            ' nodes need at least '//to_text(nint(megabytes, int64))//' MB, and '// &
            to_text(nint(available_memory_mb(), int64))//' MB are available')
         return
      end if
      mesh%source = 'rectangle '//short_text(rectangle%size(1))//' x '//short_text(rectangle%size(2))//', '// &
         to_text(rectangle%cells(1))//' x '//to_text(rectangle%cells(2))//' cells of '//trim(rectangle%element)
      call place_nodes(mesh, rectangle)
      call connect_cells(mesh, rectangle, shape)
      call name_sides(mesh, rectangle%cells)
      if (kind /= shape) call raise_order(mesh, spread(kind, 1, mesh%n_elements))
   end subroutine new_rectangle_mesh

   !> Sets the coordinates of the nodes row by row, from the lower left corner.
   pure subroutine place_nodes(mesh, rectangle)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      type(rectangle_t), intent(in) :: rectangle !! the rectangle
      real(dp) :: height(0:rectangle%cells(2)), ratio
      integer :: i, j, nx, ny

      nx = rectangle%cells(1)
      ny = rectangle%cells(2)
      ratio = 1.0_dp
      if (ny > 1) ratio = rectangle%grading**(1.0_dp/real(ny - 1, dp))
      height(0) = 0.0_dp
      do j = 1, ny
         height(j) = height(j - 1) + ratio**(j - 1)
      end do
      height = height*(rectangle%size(2)/height(ny))
      ! Even rows are placed by number, so that no rounding piles up.
      if (.not. abs(rectangle%grading - 1.0_dp) > 0.0_dp) height = [(rectangle%size(2)*j/ny, j=0, ny)]

      mesh%n_nodes = (nx + 1)*(ny + 1)
      allocate (mesh%coordinates(2, mesh%n_nodes))
      do j = 0, ny
         do i = 0, nx
            mesh%coordinates(:, 1 + i + j*(nx + 1)) = [rectangle%size(1)*i/nx, height(j)]
         end do
      end do
   end subroutine place_nodes

   !> Connects the nodes to quadrilaterals, or to two triangles a cell.
   pure subroutine connect_cells(mesh, rectangle, kind)
      type(mesh_t), intent(inout) :: mesh !! the mesh, its nodes placed
      type(rectangle_t), intent(in) :: rectangle !! the rectangle
      integer, intent(in) :: kind !! kind of the elements
      integer :: corner(4), i, j, cell, element

      mesh%n_elements = product(rectangle%cells)*merge(2, 1, kind == tri3)
      allocate (mesh%element_kind(mesh%n_elements), source=kind)
      mesh%node_start = [(1 + n_element_nodes(kind)*element, element=0, mesh%n_elements)]
      allocate (mesh%node(n_element_nodes(kind)*mesh%n_elements))
      cell = 0
      do j = 1, rectangle%cells(2)
         do i = 1, rectangle%cells(1)
            corner(1) = i + (j - 1)*(rectangle%cells(1) + 1)
            corner(2:4) = corner(1) + [1, rectangle%cells(1) + 2, rectangle%cells(1) + 1]
            if (kind == quad4) then
               mesh%node(4*cell + 1:4*cell + 4) = corner
            else if (rectangle%diagonal == 'right' .or. &
               (rectangle%diagonal == 'alternating' .and. mod(i + j, 2) == 0)) then
               mesh%node(6*cell + 1:6*cell + 6) = corner([1, 2, 3, 3, 4, 1])
            else
               mesh%node(6*cell + 1:6*cell + 6) = corner([4, 1, 2, 2, 3, 4])
            end if
            cell = cell + 1
         end do
      end do
   end subroutine connect_cells

   !> Makes the boundary sets of the four sides; the sides in a set follow each other counter-clockwise around the
   !> rectangle.
   pure subroutine name_sides(mesh, cells)
      type(mesh_t), intent(inout) :: mesh !! the mesh, its elements connected
      integer, intent(in) :: cells(2) !! number of cells along x and y
      character(6), parameter :: names(4) = [character(6) :: 'left', 'right', 'bottom', 'top']
      integer :: cell(4), cell_step(4), ends(3), node(4), node_step(4), element, i, k, per_cell, side

      ! First corner and cell of each set, and the steps along it.
      node = [mesh%n_nodes - cells(1), cells(1) + 1, 1, mesh%n_nodes]
      cell = [product(cells) - cells(1) + 1, cells(1), 1, product(cells)]
      node_step = [-cells(1) - 1, cells(1) + 1, 1, -1]
      cell_step = [-cells(1), cells(1), 1, -1]
      per_cell = mesh%n_elements/product(cells)
      allocate (mesh%sets(4))
      do k = 1, 4
         associate (set => mesh%sets(k), n => cells(merge(2, 1, k < 3)))
            set%name = trim(names(k))
            allocate (set%element(n), set%side(n))
            do i = 1, n
               do element = per_cell*(cell(k) - 1) + 1, per_cell*cell(k)
                  do side = 1, n_sides(mesh%element_kind(element))
                     ends = mesh%side(element, side)
                     if (any(ends(:2) /= [node(k), node(k) + node_step(k)])) cycle
                     set%element(i) = element
                     set%side(i) = side
                  end do
               end do
               node(k) = node(k) + node_step(k)
               cell(k) = cell(k) + cell_step(k)
            end do
         end associate
      end do
   end subroutine name_sides

end module amontons_generated_mesh
