!> Subdomains for assembly on several ranks: the elements of a body that one rank owns by its share of the order of
!> elimination. The order is found from the mesh, without a matrix.
module amontons_subdomain
   use amontons_constraints, only: constraints_t, dof_map_t, spring_side_t
   use amontons_dissection, only: dissection_t, new_dissection
   use amontons_error, only: error_t
   use amontons_kinds, only: dp, int64
   use amontons_material, only: materials_t
   use amontons_mesh, only: coloring_t, mesh_t, new_coloring
   use amontons_ranks, only: channel_t
   use amontons_sparse_matrix, only: graph_t, new_graph, new_sparse_pattern, sparse_matrix_t
   implicit none (type, external)
   private

   public :: assembly_mb, find_owners, find_positions, new_subdomain, subdomain_t

   !> A subdomain, with its own numbers of nodes, elements and unknowns.
   type :: subdomain_t
      type(mesh_t) :: mesh !! its elements, and their nodes
      type(materials_t) :: materials !! the materials
      type(spring_side_t), allocatable :: springs(:) !! springs along sides: on rank 0 those of the body, else none
      type(coloring_t) :: coloring !! colors of the elements
      type(constraints_t) :: constraints !! the frames of the nodes
      type(dof_map_t) :: dof_map !! numbers of the unknowns, and what displacements of slaves are made of
      integer, allocatable :: node(:)
         !! the node of the body that each node is: those of elements and springs, then others whose unknowns take part
      integer, allocatable :: unknown(:) !! the unknown of the body that each unknown is
   contains
      procedure :: pass => subdomain_pass
      procedure :: prepare => subdomain_prepare
   end type subdomain_t

contains

   !> Finds the position of each unknown in the order of a nested dissection, the Schur variables last.
   subroutine find_positions(position, mesh, dof_map, error)
      integer, allocatable, intent(out) :: position(:) !! position of each unknown (n_dofs)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(sparse_matrix_t) :: coupling
      type(graph_t) :: graph
      type(dissection_t) :: dissection
      integer, allocatable :: node(:), node_of(:), item(:), order(:), start(:), own_node(:)
      integer :: n_schur, k, axis, last

      ! The nodes that have unknowns, in the order of these; the first unknown of a node stands for it.
      allocate (node_of(dof_map%n_dofs), source=0)
      do k = 1, mesh%n_nodes
         axis = merge(1, 2, dof_map%dof(1, k) > 0)
         if (dof_map%dof(axis, k) > 0) node_of(dof_map%dof(axis, k)) = k
      end do
      node = pack(node_of, node_of > 0)
      n_schur = count(node_of(dof_map%n_dofs - dof_map%n_schur + 1:) > 0)
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

   !> Finds the rank that owns each element: the one whose share of the order of elimination contains the first unknown
   !> of the element to be eliminated. A rank owns whole subtrees of the dissection where possible, so that subdomains
   !> are compact. The shares are equal except that of rank 0: this holds mesh, loads and the last front for all
   !> unknowns of the body in addition, while each unknown of a share takes about 190 bytes until it is factorized. Its
   !> share is smaller by so much that all ranks hold about the same.
   pure subroutine find_owners(owner, n_ranks, position, mesh, dof_map)
      integer, allocatable, intent(out) :: owner(:) !! the rank of each element
      integer, intent(in) :: n_ranks !! number of ranks
      integer, intent(in) :: position(:) !! position of each unknown
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      ! Further memory of rank 0, over that of a share, measured on two ranks and two million unknowns.
      real(dp), parameter :: burden = 0.57_dp
      integer, allocatable :: node_start(:), node(:)
      integer :: i, k, axis, first, n_own

      n_own = int(max(0.0_dp, 1.0_dp - burden*(n_ranks - 1))*size(position)/n_ranks)
      call dof_map%substitution%own_nodes_of_elements(mesh%node_start, mesh%node, node_start, node)
      allocate (owner(mesh%n_elements), source=0)
      do i = 1, mesh%n_elements
         first = size(position)
         do k = node_start(i), node_start(i + 1) - 1
            do axis = 1, 2
               associate (dof => dof_map%dof(axis, node(k)))
                  if (dof > 0) first = min(first, position(dof))
               end associate
            end do
         end do
         if (first > n_own .and. n_ranks > 1) owner(i) = 1 + int((first - n_own - 1)*int(n_ranks - 1, int64) &
            /(size(position) - n_own))
      end do
   end subroutine find_owners

   !> The memory for the stiffness of each rank's elements during assembly, estimated as that of their element matrices:
   !> 12 bytes for each entry of a triangle, in a triangular matrix of the subdomain in which shared entries are merged
   !> [MB].
   pure function assembly_mb(owner, n_ranks, mesh)
      integer, intent(in) :: owner(:) !! the rank of each element
      integer, intent(in) :: n_ranks !! number of ranks
      type(mesh_t), intent(in) :: mesh !! the mesh of the body
      real(dp) :: assembly_mb(0:n_ranks - 1)
      integer :: n, i

      assembly_mb = 0.0_dp
      do i = 1, size(owner)
         n = 2*(mesh%node_start(i + 1) - mesh%node_start(i))
         assembly_mb(owner(i)) = assembly_mb(owner(i)) + 12.0e-6_dp*(n*(n + 1)/2)
      end do
   end function assembly_mb

   !> Cuts a subdomain out of a body: elements, nodes and unknowns.
   pure subroutine new_subdomain(subdomain, elements, springs, last_nodes, number, mesh, dof_map)
      type(subdomain_t), intent(out) :: subdomain !! the subdomain; to be prepared where it is used
      integer, intent(in) :: elements(:) !! its elements
      type(spring_side_t), intent(in) :: springs(:) !! its springs
      integer, intent(in) :: last_nodes(:) !! further nodes whose unknowns it has
      integer, intent(inout) :: number(:) !! work space, zero on entry and on return (n_nodes)
      type(mesh_t), intent(in) :: mesh !! the mesh of the body
      type(dof_map_t), intent(in) :: dof_map !! numbers of its unknowns
      integer, allocatable :: start(:), node(:)
      integer :: n_displaced, i

      associate (own => subdomain%mesh)
         own%n_elements = size(elements)
         own%element_kind = mesh%element_kind(elements)
         allocate (own%node_start(size(elements) + 1))
         own%node_start(1) = 1
         do i = 1, size(elements)
            own%node_start(i + 1) = own%node_start(i) + mesh%node_start(elements(i) + 1) - mesh%node_start(elements(i))
         end do
         allocate (own%node(own%node_start(size(elements) + 1) - 1))
         do i = 1, size(elements)
            own%node(own%node_start(i):own%node_start(i + 1) - 1) = &
               mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i) + 1) - 1)
         end do
      end associate
      allocate (subdomain%node(0))
      call number_nodes(subdomain%node, number, [subdomain%mesh%node, (springs(i)%node(:springs(i)%n_nodes), &
         i=1, size(springs))])
      ! After those whose displacements are of interest come those whose unknowns these are made of.
      n_displaced = size(subdomain%node)
      call dof_map%substitution%own_nodes_of_elements([(i, i=1, n_displaced + 1)], subdomain%node, start, node)
      call number_nodes(subdomain%node, number, [node, last_nodes])
      subdomain%mesh%n_nodes = size(subdomain%node)
      subdomain%mesh%node = number(subdomain%mesh%node)
      subdomain%mesh%coordinates = mesh%coordinates(:, subdomain%node)
      subdomain%dof_map%dof = dof_map%dof(:, subdomain%node)
      call subdomain%dof_map%substitution%take_part(dof_map%substitution, subdomain%node(:n_displaced), number)
      subdomain%springs = springs
      do i = 1, size(springs)
         associate (spring => subdomain%springs(i))
            spring%node(:spring%n_nodes) = number(spring%node(:spring%n_nodes))
         end associate
      end do
      number(subdomain%node) = 0
   end subroutine new_subdomain

   !> Gives consecutive numbers to nodes that have none yet.
   pure subroutine number_nodes(node, number, more)
      integer, allocatable, intent(inout) :: node(:) !! the numbered nodes
      integer, intent(inout) :: number(:) !! their numbers, 0 for none (n_nodes)
      integer, intent(in) :: more(:) !! nodes, some many times, some numbered
      integer, allocatable :: new(:)
      integer :: i, n

      allocate (new(size(more)))
      n = 0
      do i = 1, size(more)
         if (number(more(i)) > 0) cycle
         n = n + 1
         new(n) = more(i)
         number(more(i)) = size(node) + n
      end do
      node = [node, new(:n)]
   end subroutine number_nodes

   !> Passes a subdomain, with all that its assembly needs, from rank 0 to its owner.
   subroutine subdomain_pass(self, channel)
      class(subdomain_t), intent(inout) :: self !! the subdomain
      type(channel_t), intent(in) :: channel !! the channel between the ranks
      real(dp), allocatable :: blocks(:, :), numbers(:, :)
      integer, allocatable :: is(:, :)
      integer :: i, n_blocks

      associate (mesh => self%mesh)
         call channel%pass(mesh%n_elements)
         call channel%pass(mesh%coordinates)
         call channel%pass(mesh%element_kind)
         call channel%pass(mesh%node_start)
         call channel%pass(mesh%node)
      end associate
      call channel%pass(self%node)
      call channel%pass(self%constraints%axis)
      call channel%pass(self%dof_map%dof)
      associate (substitution => self%dof_map%substitution)
         n_blocks = 0
         if (allocated(substitution%node)) n_blocks = size(substitution%node)
         call channel%pass(n_blocks)
         if (n_blocks > 0) then
            call channel%pass(substitution%start)
            call channel%pass(substitution%node)
            if (channel%is_sender) blocks = reshape(substitution%block, [4, n_blocks])
            call channel%pass(blocks)
            substitution%block = reshape(blocks, [2, 2, n_blocks])
         end if
      end associate
      call channel%pass(self%materials%of_element)
      if (channel%is_sender) then
         associate (list => self%materials%list)
            numbers = reshape([(list(i)%thickness, list(i)%lambda, list(i)%mu, list(i)%law, i=1, size(list))], &
               [3 + size(list(1)%law), size(list)])
            is = merge(1, 0, reshape([list%has_mean_dilatation, list%is_plane_stress, list%is_axisymmetric], &
               [size(list), 3]))
         end associate
      end if
      call channel%pass(numbers)
      call channel%pass(is)
      if (channel%is_sender) return
      allocate (self%materials%list(size(is, 1)))
      do i = 1, size(is, 1)
         associate (material => self%materials%list(i))
            material%thickness = numbers(1, i)
            material%lambda = numbers(2, i)
            material%mu = numbers(3, i)
            material%law = reshape(numbers(4:, i), shape(material%law))
            material%has_mean_dilatation = is(i, 1) > 0
            material%is_plane_stress = is(i, 2) > 0
            material%is_axisymmetric = is(i, 3) > 0
         end associate
      end do
      self%mesh%n_nodes = size(self%node)
      allocate (self%springs(0))
   end subroutine subdomain_pass

   !> Numbers the unknowns of the subdomain and colors its elements.
   subroutine subdomain_prepare(self)
      class(subdomain_t), intent(inout) :: self !! the subdomain
      integer :: i, axis

      associate (dof_map => self%dof_map)
         allocate (self%unknown(count(dof_map%dof > 0)))
         do i = 1, size(dof_map%dof, 2)
            do axis = 1, 2
               if (dof_map%dof(axis, i) == 0) cycle
               dof_map%n_dofs = dof_map%n_dofs + 1
               self%unknown(dof_map%n_dofs) = dof_map%dof(axis, i)
               dof_map%dof(axis, i) = dof_map%n_dofs
            end do
         end do
      end associate
      ! Of many ranks and few elements a rank may have none.
      if (self%mesh%n_elements > 0) call new_coloring(self%coloring, self%mesh)
   end subroutine subdomain_prepare

end module amontons_subdomain
