!> Numbers of the unknowns: free displacement components, those of chosen nodes last; and displacements of nodes that
!> are not unknowns themselves: those of the slave of a pair follow from the displacements of other nodes and unknowns
!> of their own, u = P y.
!>
!> Of most nodes u = y. The own unknown of a corner of a slave is its relative displacement w, that of a middle node
!> between two corners its deviation from their mean; a bonded node has none. Stiffness and load of the unknowns are
!> P^T K P and P^T f, computed element by element.
module amontons_dof_map
   use amontons_constraints, only: constraints_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: dof_map_t, new_dof_map, substitution_t

   !> The rows of P of the nodes that are substituted: those of node i from `start(i)` to `start(i + 1) - 1`, none where
   !> u = y.
   type :: substitution_t
      integer, allocatable :: start(:) !! not allocated where no node is substituted (n_nodes + 1)
      integer, allocatable :: node(:) !! node whose own unknowns take part
      real(dp), allocatable :: block(:, :, :) !! how, in x and y: u = sum block y (2, 2, blocks) [-]
      logical, allocatable :: is_bonded(:) !! whether a node has no unknowns of its own; allocated as `start` (n_nodes)
   contains
      procedure :: displacement => substitution_displacement
      procedure :: element_nodes => substitution_element_nodes
      procedure :: forces => substitution_forces
      procedure :: is_substituted => substitution_is_substituted
      procedure :: own_nodes_of_elements => substitution_own_nodes_of_elements
      procedure :: take_part => substitution_take_part
      procedure :: transform => substitution_transform
   end type substitution_t

   !> Which unknown belongs to which component of which node.
   type :: dof_map_t
      integer :: n_dofs = 0 !! number of unknowns
      integer :: n_schur = 0 !! how many of them belong to the nodes put last
      integer, allocatable :: dof(:, :) !! unknown of the component along e1, e2 of a node, 0 if held (2, n_nodes)
      type(substitution_t) :: substitution !! how the displacements of nodes follow from the unknowns
   end type dof_map_t

contains

   !> Numbers the free components node by node; the given nodes come last, in the order given.
   pure subroutine new_dof_map(dof_map, constraints, last_nodes, substitution)
      type(dof_map_t), intent(out) :: dof_map !! the numbers
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: last_nodes(:) !! nodes whose unknowns come last
      type(substitution_t), intent(in), optional :: substitution
         !! nodes whose displacements are no unknowns; all are without it
      logical :: is_last(size(constraints%is_free, 2)), is_free(2, size(constraints%is_free, 2))
      integer :: i, node

      is_free = constraints%is_free
      if (present(substitution)) then
         dof_map%substitution = substitution
         if (allocated(substitution%is_bonded)) is_free = is_free .and. .not. spread(substitution%is_bonded, 1, 2)
      end if
      is_last = .false.
      is_last(last_nodes) = .true.
      allocate (dof_map%dof(2, size(is_last)), source=0)
      do node = 1, size(is_last)
         if (.not. is_last(node)) call number_node(dof_map, is_free(:, node), node)
      end do
      dof_map%n_schur = -dof_map%n_dofs
      do i = 1, size(last_nodes)
         call number_node(dof_map, is_free(:, last_nodes(i)), last_nodes(i))
      end do
      dof_map%n_schur = dof_map%n_schur + dof_map%n_dofs
   end subroutine new_dof_map

   !> Gives the free components of a node the next numbers.
   pure subroutine number_node(dof_map, is_free, node)
      type(dof_map_t), intent(inout) :: dof_map !! the numbers
      logical, intent(in) :: is_free(2) !! which components are free
      integer, intent(in) :: node !! the node
      integer :: axis

      do axis = 1, 2
         if (.not. is_free(axis)) cycle
         dof_map%n_dofs = dof_map%n_dofs + 1
         dof_map%dof(axis, node) = dof_map%n_dofs
      end do
   end subroutine number_node

   !> Whether any of some nodes is substituted.
   pure logical function substitution_is_substituted(self, nodes) result(is_substituted)
      class(substitution_t), intent(in) :: self !! the substitution
      integer, intent(in) :: nodes(:) !! the nodes

      is_substituted = .false.
      if (allocated(self%start)) is_substituted = any(self%start(nodes + 1) > self%start(nodes))
   end function substitution_is_substituted

   !> P y: the displacements of all nodes.
   pure function substitution_displacement(self, own) result(displacement)
      class(substitution_t), intent(in) :: self !! the substitution
      real(dp), intent(in) :: own(:, :) !! y, the nodes' own unknowns (2, n_nodes) [L]
      real(dp), allocatable :: displacement(:, :)
      integer :: node, i

      displacement = own
      if (.not. allocated(self%start)) return
      do node = 1, size(own, 2)
         if (self%start(node) == self%start(node + 1)) cycle
         displacement(:, node) = 0.0_dp
         do i = self%start(node), self%start(node + 1) - 1
            displacement(:, node) = displacement(:, node) + matmul(self%block(:, :, i), own(:, self%node(i)))
         end do
      end do
   end function substitution_displacement

   !> P^T f: nodal forces on the nodes' own unknowns.
   pure function substitution_forces(self, forces) result(own)
      class(substitution_t), intent(in) :: self !! the substitution
      real(dp), intent(in) :: forces(:, :) !! f, nodal forces (2, n_nodes) [F]
      real(dp), allocatable :: own(:, :)
      integer :: node, i

      own = forces
      if (.not. allocated(self%start)) return
      do node = 1, size(own, 2)
         if (self%start(node) < self%start(node + 1)) own(:, node) = 0.0_dp
      end do
      do node = 1, size(own, 2)
         do i = self%start(node), self%start(node + 1) - 1
            own(:, self%node(i)) = own(:, self%node(i)) + matmul(forces(:, node), self%block(:, :, i))
         end do
      end do
   end function substitution_forces

   !> The nodes whose own unknowns the displacements of some nodes are made of, each once.
   pure function substitution_element_nodes(self, nodes) result(own_nodes)
      class(substitution_t), intent(in) :: self !! the substitution
      integer, intent(in) :: nodes(:) !! the nodes
      integer, allocatable :: own_nodes(:)
      integer :: i, k

      allocate (own_nodes(0))
      do i = 1, size(nodes)
         if (.not. self%is_substituted(nodes(i:i))) then
            if (all(own_nodes /= nodes(i))) own_nodes = [own_nodes, nodes(i)]
            cycle
         end if
         do k = self%start(nodes(i)), self%start(nodes(i) + 1) - 1
            if (all(own_nodes /= self%node(k))) own_nodes = [own_nodes, self%node(k)]
         end do
      end do
   end function substitution_element_nodes

   !> The nodes whose own unknowns the displacements of each element are made of.
   pure subroutine substitution_own_nodes_of_elements(self, start, node, own_start, own_node)
      class(substitution_t), intent(in) :: self !! the substitution
      integer, intent(in) :: start(:) !! where the nodes of each element begin (n_elements + 1)
      integer, intent(in) :: node(:) !! the nodes of the elements
      integer, allocatable, intent(out) :: own_start(:) !! where those of each element begin (n_elements + 1)
      integer, allocatable, intent(out) :: own_node(:) !! the nodes whose own unknowns take part
      integer, allocatable :: own(:)
      integer :: element, turn

      if (.not. allocated(self%start)) then
         own_start = start
         own_node = node
         return
      end if
      allocate (own_start(size(start)))
      ! Counted first, then listed.
      do turn = 1, 2
         own_start(1) = 1
         do element = 1, size(start) - 1
            own = node(start(element):start(element + 1) - 1)
            if (self%is_substituted(own)) own = self%element_nodes(own)
            own_start(element + 1) = own_start(element) + size(own)
            if (turn == 2) own_node(own_start(element):own_start(element + 1) - 1) = own
         end do
         if (turn == 1) allocate (own_node(own_start(size(start)) - 1))
      end do
   end subroutine substitution_own_nodes_of_elements

   !> The substitution of a part of a body, its nodes numbered anew.
   pure subroutine substitution_take_part(self, body, nodes, number)
      class(substitution_t), intent(inout) :: self !! that of the part; nothing yet, nor later if it substitutes none
      type(substitution_t), intent(in) :: body !! that of the body
      integer, intent(in) :: nodes(:) !! nodes of the part whose displacements are of interest: its first ones
      integer, intent(in) :: number(:) !! number in the part of each node of the body
      integer, allocatable :: row(:)
      integer :: i, k

      if (.not. body%is_substituted(nodes)) return
      allocate (self%start(maxval(number) + 1))
      self%start(1) = 1
      do i = 1, size(nodes)
         self%start(i + 1) = self%start(i) + body%start(nodes(i) + 1) - body%start(nodes(i))
      end do
      self%start(size(nodes) + 2:) = self%start(size(nodes) + 1)
      row = [((k, k=body%start(nodes(i)), body%start(nodes(i) + 1) - 1), i=1, size(nodes))]
      self%node = number(body%node(row))
      self%block = body%block(:, :, row)
   end subroutine substitution_take_part

   !> The rows of P of some nodes, in the columns of the nodes of `element_nodes` (2 nodes, 2 own_nodes) [-].
   pure function substitution_transform(self, nodes, own_nodes) result(transform)
      class(substitution_t), intent(in) :: self !! the substitution
      integer, intent(in) :: nodes(:) !! the nodes
      integer, intent(in) :: own_nodes(:) !! the nodes whose own unknowns they are made of
      real(dp), allocatable :: transform(:, :)
      integer :: i, k, j

      allocate (transform(2*size(nodes), 2*size(own_nodes)), source=0.0_dp)
      do i = 1, size(nodes)
         if (.not. self%is_substituted(nodes(i:i))) then
            j = findloc(own_nodes, nodes(i), dim=1)
            transform(2*i - 1, 2*j - 1) = 1.0_dp
            transform(2*i, 2*j) = 1.0_dp
            cycle
         end if
         do k = self%start(nodes(i)), self%start(nodes(i) + 1) - 1
            j = findloc(own_nodes, self%node(k), dim=1)
            transform(2*i - 1:2*i, 2*j - 1:2*j) = transform(2*i - 1:2*i, 2*j - 1:2*j) + self%block(:, :, k)
         end do
      end do
   end function substitution_transform

end module amontons_dof_map
