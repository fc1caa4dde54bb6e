!> Quadratic meshes from linear ones, and uniform refinement: every element in four, its sides halved where its shape
!> functions put their middles, so that curved sides keep their curve.
module amontons_refined_mesh
   use amontons_element, only: element_names, is_triangle, max_nodes, n_corners, n_element_nodes, node_coordinates, &
      quad4, quad8, quad9, shape_functions, tri3, tri6
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_mesh, only: mesh_t, parents_t
   use amontons_system, only: available_memory_mb
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: raise_order, refine_mesh

   !> Number of parts of an element.
   integer, parameter :: n_parts = 4
   !> The nodes of a six-node triangle that are the corners of its parts (corner, part). Part i has corner i.
   integer, parameter :: triangle_parts(3, n_parts) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3, 4, 5, 6], [3, n_parts])
   !> The nodes of a nine-node quadrilateral that are the corners of its parts (corner, part).
   integer, parameter :: quad_parts(4, n_parts) = reshape([1, 5, 9, 8, 5, 2, 6, 9, 9, 6, 3, 7, 8, 9, 7, 4], &
      [4, n_parts])

   !> The sides met so far, found by their lower-numbered corner.
   type :: side_table_t
      integer, allocatable :: first(:) !! last side entered of each corner, 0 for none (corners)
      integer, allocatable :: before(:) !! the side entered before it at the same corner, 0 for none (sides)
      integer, allocatable :: higher(:) !! its higher-numbered corner (sides)
      integer :: n_sides = 0 !! number of sides entered
   end type side_table_t

contains

   !> Refines a mesh several times, cutting every element in four. The nodes keep their numbers, the new ones come
   !> behind them; element e becomes the elements 4 e - 3 to 4 e. Boundary sets and regions become those of the parts,
   !> sets of nodes stay as they are.
   subroutine refine_mesh(mesh, n_times, error)
      type(mesh_t), intent(inout) :: mesh !! a checked mesh, refined on return
      integer, intent(in) :: n_times !! how often every element is cut in four
      type(error_t), allocatable, intent(out) :: error !! more nodes than numbers or memory allow
      ! As many as a generated mesh may have.
      real(dp), parameter :: most_nodes = 2.0_dp**27
      ! Mesh and assembled stiffness alone.
      real(dp), parameter :: node_bytes = 500.0_dp
      type(mesh_t) :: parent, quadratic
      integer, allocatable :: kinds(:)
      real(dp) :: n_nodes, megabytes, available
      integer :: i

      n_nodes = mesh%n_nodes*real(n_parts, dp)**n_times
      megabytes = 1.0e-6_dp*node_bytes*n_nodes
      available = available_memory_mb()
      if (n_nodes > most_nodes) then
         call new_error(error, input_refused, 'refined '//to_text(n_times)//' times, the mesh has more nodes than '// &
            'node numbers allow (about 134 million)')
      else if (n_times > 0 .and. megabytes > available) then
         call new_error(error, system_failure, 'not enough memory: '//to_text(nint(n_nodes, int64))// &
            ' nodes need at least '//to_text(nint(megabytes, int64))//' MB, and '// &
            to_text(nint(available, int64))//' MB are available')
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
         call place_nodes(mesh, parent)
         call refine_sets(mesh)
      end do
   end subroutine refine_mesh

   !> Replaces the elements of a mesh by the linear ones that its quadratic ones are cut into. The centers of eight-node
   !> elements become nodes, which are not placed yet.
   pure subroutine cut_elements(mesh, parent)
      type(mesh_t), intent(inout) :: mesh !! the mesh; gains nodes and elements
      type(mesh_t), intent(in) :: parent !! the same mesh, of quadratic elements
      integer :: node(max_nodes), element, part, n, n_centers, first

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
               node(max_nodes) = parent%n_nodes + n_centers
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
      mesh%element_kind = [spread(merge(tri3, quad4, is_triangle(parent%element_kind)), 1, n_parts)]
      mesh%n_elements = n_parts*parent%n_elements
      mesh%n_nodes = parent%n_nodes + n_centers
      mesh%coordinates = reshape(parent%coordinates, [2, mesh%n_nodes], pad=[0.0_dp])
   end subroutine cut_elements

   !> The nodes of a quadratic element, as the nine-node one numbers them, that are the corners of a part of it.
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

   !> Puts the nodes that are new where the shape functions of the elements before have them, and notes their parents.
   pure subroutine place_nodes(mesh, parent)
      type(mesh_t), intent(inout) :: mesh !! the refined mesh, its new nodes anywhere
      type(mesh_t), intent(in) :: parent !! the mesh before
      real(dp) :: share(max_nodes, max_nodes, n_parts, size(element_names))
      logical :: is_placed(mesh%n_nodes)
      type(parents_t) :: parents
      integer :: element, pass, part, i, first, last

      share = part_shares()
      allocate (parents%start(mesh%n_nodes + 1))
      do pass = 1, 2
         is_placed = .false.
         is_placed(:parent%n_nodes) = .true.
         if (pass == 2) call begin_parents(parents, parent)
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
   end subroutine place_nodes

   !> Begins the lists of parents with those of the mesh before.
   pure subroutine begin_parents(parents, parent)
      type(parents_t), intent(inout) :: parents !! number of parents of each new node, behind it; then where each begins
      type(mesh_t), intent(in) :: parent !! the mesh before
      integer :: i, n

      n = 0
      parents%start(:parent%n_nodes + 1) = 1
      if (allocated(parent%parents)) then
         parents%start(:parent%n_nodes + 1) = parent%parents%start
         n = size(parent%parents%node)
      end if
      do i = parent%n_nodes + 1, size(parents%start) - 1
         parents%start(i + 1) = parents%start(i) + parents%start(i + 1)
      end do
      associate (total => parents%start(size(parents%start)) - 1)
         allocate (parents%node(total), parents%weight(total))
      end associate
      if (n == 0) return
      parents%node(:n) = parent%parents%node
      parents%weight(:n) = parent%parents%weight
   end subroutine begin_parents

   !> The shape functions of the elements of every kind at the nodes of their parts (shape function, node, part,
   !> kind) [-].
   pure function part_shares() result(share)
      real(dp) :: share(max_nodes, max_nodes, n_parts, size(element_names))
      real(dp) :: corners(2, 4), xi(2), values(max_nodes), derivatives(2, max_nodes)
      integer :: kind, part, i, shape

      share = 0.0_dp
      do kind = 1, size(element_names)
         shape = merge(tri3, quad4, is_triangle(kind))
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
      integer, allocatable :: node(:), node_start(:)
      real(dp), allocatable :: middle(:, :)
      logical, allocatable :: is_raised(:)
      integer :: element, i, n, first, side, corners(4)

      is_raised = kinds /= mesh%element_kind
      if (.not. any(is_raised)) return
      n = size(mesh%node)
      allocate (table%first(mesh%n_nodes), source=0)
      allocate (table%before(n), table%higher(n), source=0)
      allocate (middle(2, n), node(sum(n_element_nodes(kinds))), node_start(mesh%n_elements + 1))
      node_start(1) = 1
      do element = 1, mesh%n_elements
         first = node_start(element)
         node_start(element + 1) = first + n_element_nodes(kinds(element))
         n = mesh%node_start(element + 1) - mesh%node_start(element)
         node(first:first + n - 1) = mesh%node(mesh%node_start(element):mesh%node_start(element + 1) - 1)
         if (.not. is_raised(element)) cycle
         corners(:n) = node(first:first + n - 1)
         do i = 1, n
            call find_side(table, corners(i), corners(mod(i, n) + 1), side)
            middle(:, side) = 0.5_dp*(mesh%coordinates(:, corners(i)) + mesh%coordinates(:, corners(mod(i, n) + 1)))
            node(first + n + i - 1) = mesh%n_nodes + side
         end do
      end do
      mesh%coordinates = reshape([mesh%coordinates, middle(:, :table%n_sides)], [2, mesh%n_nodes + table%n_sides])
      mesh%n_nodes = mesh%n_nodes + table%n_sides
      mesh%element_kind = kinds
      mesh%node = node
      mesh%node_start = node_start
      call add_centers(mesh, is_raised)
   end subroutine raise_order

   !> The number of the side between two corners; a new one is entered.
   pure subroutine find_side(table, a, b, side)
      type(side_table_t), intent(inout) :: table !! the sides met so far
      integer, intent(in) :: a !! one corner
      integer, intent(in) :: b !! the other corner
      integer, intent(out) :: side !! the side's number

      side = table%first(min(a, b))
      do while (side > 0)
         if (table%higher(side) == max(a, b)) return
         side = table%before(side)
      end do
      table%n_sides = table%n_sides + 1
      side = table%n_sides
      table%higher(side) = max(a, b)
      table%before(side) = table%first(min(a, b))
      table%first(min(a, b)) = side
   end subroutine find_side

   !> Gives new nine-node elements their center, the mean of their corners.
   pure subroutine add_centers(mesh, is_raised)
      type(mesh_t), intent(inout) :: mesh !! the mesh, complete but for the centers
      logical, intent(in) :: is_raised(:) !! whether an element is new (n_elements)
      real(dp) :: center(2, count(is_raised .and. mesh%element_kind == quad9))
      integer :: element, first, n

      n = 0
      do element = 1, mesh%n_elements
         if (.not. is_raised(element) .or. mesh%element_kind(element) /= quad9) cycle
         n = n + 1
         first = mesh%node_start(element)
         center(:, n) = 0.25_dp*sum(mesh%coordinates(:, mesh%node(first:first + 3)), dim=2)
         mesh%node(first + 8) = mesh%n_nodes + n
      end do
      mesh%coordinates = reshape([mesh%coordinates, center], [2, mesh%n_nodes + n])
      mesh%n_nodes = mesh%n_nodes + n
   end subroutine add_centers

end module amontons_refined_mesh
