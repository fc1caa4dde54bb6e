!> Quadratic meshes from linear ones: nodes in the middle of every side, and in the center of nine-node elements.
module amontons_quadratic_mesh
   use amontons_element, only: n_element_nodes, quad9
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: raise_order

   !> The sides met so far, found by their lower-numbered corner.
   type :: side_table_t
      integer, allocatable :: first(:) !! last side entered of each corner, 0 for none (corners)
      integer, allocatable :: before(:) !! the side entered before it at the same corner, 0 for none (sides)
      integer, allocatable :: higher(:) !! its higher-numbered corner (sides)
      integer :: n_sides = 0 !! number of sides entered
   end type side_table_t

contains

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

end module amontons_quadratic_mesh
