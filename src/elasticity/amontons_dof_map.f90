!> Numbers of the unknowns: free displacement components, those of chosen nodes last.
module amontons_dof_map
   use amontons_constraints, only: constraints_t
   use amontons_substitution, only: substitution_t
   implicit none (type, external)
   private

   public :: dof_map_t, new_dof_map

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

end module amontons_dof_map
