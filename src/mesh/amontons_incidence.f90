!> Which elements meet at each corner node of a mesh, and the pieces of the mesh: elements that share nodes hold
!> together, others do not.
module amontons_incidence
   use amontons_bins, only: fill_bins
   use amontons_element, only: n_corners
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: incidence_t, new_incidence, number_pieces

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

end module amontons_incidence
