!> Small meshes for the tests: rectangles of unit cells, whole, mixed, distorted or turned, and meshes written by hand.
module sample_meshes
   use amontons_element, only: element_names, n_corners, n_element_nodes, quad4, quad9, tri3
   use amontons_error, only: error_t
   use amontons_generated_mesh, only: new_rectangle_mesh, rectangle_t
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t, named_set_t
   implicit none (type, external)
   private

   public :: add_node_set, add_region, add_set, corners, distort, element_kinds, is_on_edge, meshings, mixed_cells, &
      polygon_area, quadratic_meshings, rotation, turn, unit_cells, written_mesh

   !> Ways to mesh a rectangle: quadrilaterals, or triangles by the direction of their diagonals.
   character(11), parameter :: meshings(4) = [character(11) :: 'quad4', 'right', 'left', 'alternating']
   !> Ways to mesh it with quadratic elements.
   character(11), parameter :: quadratic_meshings(3) = [character(11) :: 'tri6', 'quad8', 'quad9']
   !> A way to mesh it with each kind of element.
   character(11), parameter :: element_kinds(*) = [character(11) :: 'right', 'quad4', quadratic_meshings]

contains

   !> A rectangle of cells of size 1 by 1, its lower left corner at the origin.
   subroutine unit_cells(mesh, meshing, columns, rows)
      type(mesh_t), intent(out) :: mesh !! the mesh
      character(*), intent(in) :: meshing !! one of `meshings` or `quadratic_meshings`
      integer, intent(in) :: columns !! number of cells along x
      integer, intent(in) :: rows !! number of cells along y
      type(rectangle_t) :: rectangle
      type(error_t), allocatable :: error

      rectangle%cells = [columns, rows]
      rectangle%size = real(rectangle%cells, dp)
      if (any(element_names == meshing)) then
         rectangle%element = trim(meshing)
         rectangle%diagonal = 'right'
      else
         rectangle%element = 'tri3'
         rectangle%diagonal = trim(meshing)
      end if
      call new_rectangle_mesh(mesh, rectangle, error)
   end subroutine unit_cells

   !> Unit cells of which every second is cut into two triangles; without boundary sets.
   subroutine mixed_cells(mesh, columns, rows)
      type(mesh_t), intent(out) :: mesh !! the mesh
      integer, intent(in) :: columns !! number of cells along x
      integer, intent(in) :: rows !! number of cells along y
      type(mesh_t) :: whole
      integer, allocatable :: kinds(:), nodes(:)
      integer :: cell

      call unit_cells(whole, 'quad4', columns, rows)
      allocate (kinds(0), nodes(0))
      do cell = 1, whole%n_elements
         associate (corner => whole%node(4*cell - 3:4*cell))
            if (mod(cell, 2) == 0) then
               kinds = [kinds, quad4]
               nodes = [nodes, corner]
            else
               kinds = [kinds, tri3, tri3]
               nodes = [nodes, corner([1, 2, 3]), corner([3, 4, 1])]
            end if
         end associate
      end do
      call written_mesh(mesh, whole%coordinates, kinds, nodes)
   end subroutine mixed_cells

   !> A mesh from its numbers, without boundary sets.
   subroutine written_mesh(mesh, coordinates, kinds, nodes)
      type(mesh_t), intent(out) :: mesh !! the mesh
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, nodes) [L]
      integer, intent(in) :: kinds(:) !! kind of each element
      integer, intent(in) :: nodes(:) !! nodes of the elements, one element after the other
      integer :: element

      mesh%n_nodes = size(coordinates, 2)
      mesh%n_elements = size(kinds)
      mesh%coordinates = coordinates
      mesh%element_kind = kinds
      mesh%node_start = [(1 + sum(n_element_nodes(kinds(:element))), element=0, size(kinds))]
      mesh%node = nodes
      allocate (mesh%sets(0))
   end subroutine written_mesh

   !> Adds a boundary set to a mesh.
   subroutine add_set(mesh, name, elements, sides)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      character(*), intent(in) :: name !! name of the set
      integer, intent(in) :: elements(:) !! element of each side
      integer, intent(in) :: sides(:) !! number of each side in its element
      type(named_set_t), allocatable :: sets(:)

      allocate (sets(size(mesh%sets) + 1))
      sets(:size(mesh%sets)) = mesh%sets
      sets(size(sets))%name = name
      sets(size(sets))%element = elements
      sets(size(sets))%side = sides
      call move_alloc(sets, mesh%sets)
   end subroutine add_set

   !> Adds a named part of the body to a mesh.
   subroutine add_region(mesh, name, elements)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      character(*), intent(in) :: name !! name of the region
      integer, intent(in) :: elements(:) !! its elements
      type(named_set_t), allocatable :: regions(:)
      integer :: n

      n = 0
      if (allocated(mesh%regions)) n = size(mesh%regions)
      allocate (regions(n + 1))
      if (n > 0) regions(:n) = mesh%regions
      regions(n + 1)%name = name
      regions(n + 1)%element = elements
      call move_alloc(regions, mesh%regions)
   end subroutine add_region

   !> Gives a mesh one named set of nodes.
   subroutine add_node_set(mesh, name, nodes)
      type(mesh_t), intent(inout) :: mesh !! the mesh, without node sets
      character(*), intent(in) :: name !! name of the set
      integer, intent(in) :: nodes(:) !! its nodes

      allocate (mesh%node_sets(1))
      mesh%node_sets(1) = named_set_t(name=name, node=nodes)
   end subroutine add_node_set

   !> Whether a node of unturned unit cells lies on the edge of the rectangle.
   pure logical function is_on_edge(mesh, node)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: node !! the node

      ! Nodes of cells of size 1 are half a cell apart at the least; half of that tells the edge from what is inside.
      is_on_edge = any(mesh%coordinates(:, node) < 0.25_dp) .or. &
         any(mesh%coordinates(:, node) > maxval(mesh%coordinates, dim=2) - 0.25_dp)
   end function is_on_edge

   !> Moves the inner corners of unit cells by up to 0.2 in x and in y: no element turns over, all sides stay straight.
   subroutine distort(mesh)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      integer :: node

      do node = 1, mesh%n_nodes
         if (is_on_edge(mesh, node)) cycle
         mesh%coordinates(:, node) = mesh%coordinates(:, node) + 0.2_dp*[sin(12.9_dp*node), cos(78.2_dp*node)]
      end do
      call straighten(mesh)
   end subroutine distort

   !> Puts the middle nodes of quadratic elements halfway between the corners, and the centers between all of them.
   subroutine straighten(mesh)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      integer :: element, side, nodes(3), first

      do element = 1, mesh%n_elements
         associate (kind => mesh%element_kind(element))
            if (n_element_nodes(kind) == n_corners(kind)) cycle
            do side = 1, n_corners(kind)
               nodes = mesh%side(element, side)
               mesh%coordinates(:, nodes(3)) = 0.5_dp*sum(mesh%coordinates(:, nodes(:2)), dim=2)
            end do
            first = mesh%node_start(element)
            if (kind == quad9) mesh%coordinates(:, mesh%node(first + 8)) = &
               0.25_dp*sum(mesh%coordinates(:, mesh%node(first:first + 3)), dim=2)
         end associate
      end do
   end subroutine straighten

   !> The matrix that turns a vector counter-clockwise.
   pure function rotation(degrees) result(matrix)
      real(dp), intent(in) :: degrees !! the angle
      real(dp) :: matrix(2, 2)
      real(dp) :: angle

      angle = degrees*acos(-1.0_dp)/180.0_dp
      matrix(:, 1) = [cos(angle), sin(angle)]
      matrix(:, 2) = [-sin(angle), cos(angle)]
   end function rotation

   !> Turns a mesh counter-clockwise about the origin.
   subroutine turn(mesh, degrees)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      real(dp), intent(in) :: degrees !! the angle

      mesh%coordinates = matmul(rotation(degrees), mesh%coordinates)
   end subroutine turn

   !> Area of a polygon by the shoelace formula.
   pure real(dp) function polygon_area(corner)
      real(dp), intent(in) :: corner(:, :) !! its corners (2, n)
      integer :: i, j

      polygon_area = 0.0_dp
      do i = 1, size(corner, 2)
         j = mod(i, size(corner, 2)) + 1
         polygon_area = polygon_area + 0.5_dp*(corner(1, i)*corner(2, j) - corner(1, j)*corner(2, i))
      end do
   end function polygon_area

   !> Coordinates of the corners of an element (2, corners).
   pure function corners(mesh, element)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element
      real(dp), allocatable :: corners(:, :)

      associate (first => mesh%node_start(element))
         corners = mesh%coordinates(:, mesh%node(first:first + n_corners(mesh%element_kind(element)) - 1))
      end associate
   end function corners

end module sample_meshes
