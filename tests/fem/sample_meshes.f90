!> Small meshes for the tests: rectangles of unit cells, whole, mixed, distorted or turned, and meshes written by hand.
module sample_meshes
   use amontons_element, only: n_element_nodes, quad4, tri3
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_mesh, only: boundary_set_t, mesh_t
   use amontons_rectangle, only: new_rectangle_mesh, rectangle_t
   implicit none (type, external)
   private

   public :: add_set, distort, is_on_edge, meshings, mixed_cells, rotation, turn, unit_cells, written_mesh

   !> Ways to mesh a rectangle: quadrilaterals, or triangles by the direction of their diagonals.
   character(11), parameter :: meshings(4) = [character(11) :: 'quad4', 'right', 'left', 'alternating']

contains

   !> A rectangle of cells of size 1 by 1, its lower left corner at the origin.
   subroutine unit_cells(mesh, meshing, columns, rows)
      type(mesh_t), intent(out) :: mesh !! the mesh
      character(*), intent(in) :: meshing !! one of `meshings`
      integer, intent(in) :: columns !! number of cells along x
      integer, intent(in) :: rows !! number of cells along y
      type(rectangle_t) :: rectangle
      type(error_t), allocatable :: error

      rectangle%cells = [columns, rows]
      rectangle%size = real(rectangle%cells, dp)
      if (meshing == 'quad4') then
         rectangle%element = 'quad4'
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
      type(boundary_set_t), allocatable :: sets(:)

      allocate (sets(size(mesh%sets) + 1))
      sets(:size(mesh%sets)) = mesh%sets
      sets(size(sets))%name = name
      sets(size(sets))%element = elements
      sets(size(sets))%side = sides
      call move_alloc(sets, mesh%sets)
   end subroutine add_set

   !> Whether a node of unturned unit cells lies on the edge of the rectangle.
   pure logical function is_on_edge(mesh, node)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: node !! the node

      ! Cells of size 1 have whole coordinates; half a cell tells the edge from what is inside.
      is_on_edge = any(mesh%coordinates(:, node) < 0.5_dp) .or. &
         any(mesh%coordinates(:, node) > maxval(mesh%coordinates, dim=2) - 0.5_dp)
   end function is_on_edge

   !> Moves the inner nodes of unit cells by up to 0.2 in x and in y: no element can turn over.
   subroutine distort(mesh)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      integer :: node

      do node = 1, mesh%n_nodes
         if (is_on_edge(mesh, node)) cycle
         mesh%coordinates(:, node) = mesh%coordinates(:, node) + 0.2_dp*[sin(12.9_dp*node), cos(78.2_dp*node)]
      end do
   end subroutine distort

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

end module sample_meshes
