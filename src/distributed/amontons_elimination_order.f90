!> The order of elimination of a body, found on its mesh: no matrix is needed.
module amontons_elimination_order
   use amontons_dissection, only: dissection_t, new_dissection
   use amontons_dof_map, only: dof_map_t
   use amontons_error, only: error_t
   use amontons_graph, only: graph_t, new_graph
   use amontons_mesh, only: mesh_t
   use amontons_sparse_matrix, only: new_sparse_pattern, sparse_matrix_t
   implicit none (type, external)
   private

   public :: find_positions

contains

   !> Finds the position of each unknown in the order of a nested dissection, the trailing unknowns last.
   subroutine find_positions(position, mesh, dof_map, error)
      integer, allocatable, intent(out) :: position(:) !! position of each unknown (n_dofs)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(sparse_matrix_t) :: coupling
      type(graph_t) :: graph
      type(dissection_t) :: dissection
      integer, allocatable :: node(:), item(:), order(:), start(:), own_node(:)
      integer :: n_schur, k, axis, last

      call list_nodes(node, n_schur, mesh, dof_map)
      allocate (item(mesh%n_nodes), source=0)
      do k = 1, size(node)
         item(node(k)) = k
      end do
      ! Only which nodes couple is of interest.
      call dof_map%substitution%own_nodes_of_elements(mesh%node_start, mesh%node, start, own_node)
      call new_sparse_pattern(coupling, size(node), start, item(own_node), error)
      if (allocated(error)) return
      deallocate (start, own_node)
      deallocate (coupling%value)
      call new_graph(graph, coupling, n_schur)
      coupling = sparse_matrix_t()
      call new_dissection(dissection, graph, mesh%coordinates(:, node(graph%first_unknown(:graph%n - graph%n_schur))))
      allocate (order(size(node)), position(dof_map%n_dofs))
      call graph%expand(dissection%order, order)
      last = 0
      do k = 1, size(order)
         do axis = 1, 2
            associate (dof => dof_map%dof(axis, node(order(k))))
               if (dof == 0) cycle
               last = last + 1
               position(dof) = last
            end associate
         end do
      end do
   end subroutine find_positions

   !> Lists the nodes that have unknowns, in the order of these.
   pure subroutine list_nodes(node, n_last, mesh, dof_map)
      integer, allocatable, intent(out) :: node(:) !! the nodes
      integer, intent(out) :: n_last !! how many of them have trailing unknowns
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      integer, allocatable :: node_of(:)
      integer :: i, axis

      allocate (node_of(dof_map%n_dofs), source=0)
      do i = 1, mesh%n_nodes
         ! The first unknown of a node stands for it.
         axis = merge(1, 2, dof_map%dof(1, i) > 0)
         if (dof_map%dof(axis, i) > 0) node_of(dof_map%dof(axis, i)) = i
      end do
      node = pack(node_of, node_of > 0)
      n_last = count(node_of(dof_map%n_dofs - dof_map%n_schur + 1:) > 0)
   end subroutine list_nodes

end module amontons_elimination_order
