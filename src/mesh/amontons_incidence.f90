!> Which elements meet at each corner node of a mesh.
module amontons_incidence
   use amontons_element, only: n_corners
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: incidence_t, new_incidence

   !> The elements with a corner at each node.
   type :: incidence_t
      integer, allocatable :: start(:) !! where the corners at a node begin in `corner` (n_nodes + 1)
      integer, allocatable :: element(:) !! element of each corner, ascending at each node
      integer, allocatable :: corner(:) !! place of each corner in `node` of the mesh
   end type incidence_t

contains

   !> Lists the corners of all elements by their nodes.
   pure subroutine new_incidence(incidence, mesh)
      type(incidence_t), intent(out) :: incidence !! the lists
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer :: next(mesh%n_nodes), element, i, node

      allocate (incidence%start(mesh%n_nodes + 1), source=0)
      do element = 1, mesh%n_elements
         do i = mesh%node_start(element), last_corner(mesh, element)
            incidence%start(mesh%node(i) + 1) = incidence%start(mesh%node(i) + 1) + 1
         end do
      end do
      incidence%start(1) = 1
      do node = 1, mesh%n_nodes
         incidence%start(node + 1) = incidence%start(node + 1) + incidence%start(node)
      end do
      next = incidence%start(:mesh%n_nodes)
      allocate (incidence%element(incidence%start(mesh%n_nodes + 1) - 1))
      allocate (incidence%corner(size(incidence%element)))
      do element = 1, mesh%n_elements
         do i = mesh%node_start(element), last_corner(mesh, element)
            node = mesh%node(i)
            incidence%element(next(node)) = element
            incidence%corner(next(node)) = i
            next(node) = next(node) + 1
         end do
      end do
   end subroutine new_incidence

   !> Place of the last corner of an element in `node` of the mesh.
   pure integer function last_corner(mesh, element)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element

      last_corner = mesh%node_start(element) + n_corners(mesh%element_kind(element)) - 1
   end function last_corner

end module amontons_incidence
