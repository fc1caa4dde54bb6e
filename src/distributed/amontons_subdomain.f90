!> Subdomains: the elements of a body that one rank owns, and what assembly needs of them.
module amontons_subdomain
   use amontons_coloring, only: coloring_t, new_coloring
   use amontons_constraints, only: constraints_t
   use amontons_dof_map, only: dof_map_t
   use amontons_foundation, only: spring_side_t
   use amontons_kinds, only: dp, int64
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_ranks, only: line_t
   implicit none (type, external)
   private

   public :: find_owners, new_subdomain, subdomain_t

   !> A subdomain, its nodes, elements and unknowns numbered anew.
   type :: subdomain_t
      type(mesh_t) :: mesh !! its elements, and their nodes
      type(materials_t) :: materials !! the materials
      type(spring_side_t), allocatable :: springs(:) !! springs along sides: on rank 0 those of the body
      type(coloring_t) :: coloring !! colors of the elements
      type(constraints_t) :: constraints !! the frames of the nodes
      type(dof_map_t) :: dof_map !! numbers of the unknowns
      integer, allocatable :: node(:) !! the node of the body that each node is
      integer, allocatable :: unknown(:) !! the unknown of the body that each unknown is
      integer, allocatable :: place(:) !! which item of the body's `mesh%node` each item of `mesh%node` is
   contains
      procedure :: pass => subdomain_pass
      procedure :: prepare => subdomain_prepare
   end type subdomain_t

contains

   !> Finds the rank that owns each element: that of its unknown that is eliminated first, when the order of elimination
   !> is dealt out evenly. Ranks own subtrees of the dissection as far as they go, so that subdomains are compact.
   pure subroutine find_owners(owner, n_ranks, position, mesh, dof_map)
      integer, allocatable, intent(out) :: owner(:) !! the rank of each element, from 0
      integer, intent(in) :: n_ranks !! number of ranks
      integer, intent(in) :: position(:) !! position of each unknown
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      integer :: element, i, axis, first

      allocate (owner(mesh%n_elements))
      do element = 1, mesh%n_elements
         first = size(position)
         do i = mesh%node_start(element), mesh%node_start(element + 1) - 1
            do axis = 1, 2
               associate (dof => dof_map%dof(axis, mesh%node(i)))
                  if (dof > 0) first = min(first, position(dof))
               end associate
            end do
         end do
         owner(element) = int((first - 1)*int(n_ranks, int64)/size(position))
      end do
   end subroutine find_owners

   !> Cuts the subdomain of a rank out of a body. That of rank 0 has the springs, and the nodes of all trailing
   !> unknowns.
   subroutine new_subdomain(subdomain, rank, owner, mesh, materials, springs, constraints, dof_map)
      type(subdomain_t), intent(out) :: subdomain !! the subdomain; to be prepared where it is used
      integer, intent(in) :: rank !! the rank
      integer, intent(in) :: owner(:) !! the rank of each element
      type(mesh_t), intent(in) :: mesh !! the mesh of the body
      type(materials_t), intent(in) :: materials !! its materials
      type(spring_side_t), intent(in) :: springs(:) !! its springs
      type(constraints_t), intent(in) :: constraints !! its supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of its unknowns
      integer, allocatable :: local(:)
      integer :: i

      call take_elements(subdomain, rank, owner, mesh)
      allocate (local(mesh%n_nodes), source=0)
      local(mesh%node(subdomain%place)) = 1
      allocate (subdomain%springs(merge(size(springs), 0, rank == 0)))
      if (rank == 0) then
         subdomain%springs = springs
         do i = 1, size(springs)
            local(springs(i)%node(:springs(i)%n_nodes)) = 1
         end do
         do i = 1, mesh%n_nodes
            if (any(dof_map%dof(:, i) > dof_map%n_dofs - dof_map%n_trailing)) local(i) = 1
         end do
      end if
      allocate (subdomain%node(count(local > 0)))
      associate (n => subdomain%mesh%n_nodes)
         do i = 1, mesh%n_nodes
            if (local(i) == 0) cycle
            n = n + 1
            local(i) = n
            subdomain%node(n) = i
         end do
      end associate
      subdomain%mesh%node = local(mesh%node(subdomain%place))
      subdomain%mesh%coordinates = mesh%coordinates(:, subdomain%node)
      subdomain%constraints%axis = constraints%axis(:, subdomain%node)
      subdomain%dof_map%dof = dof_map%dof(:, subdomain%node)
      do i = 1, size(subdomain%springs)
         associate (spring => subdomain%springs(i))
            spring%node(:spring%n_nodes) = local(spring%node(:spring%n_nodes))
         end associate
      end do
      subdomain%materials%list = materials%list
      subdomain%materials%of_element = pack(materials%of_element, owner == rank)
   end subroutine new_subdomain

   !> Takes the elements of a rank.
   pure subroutine take_elements(subdomain, rank, owner, mesh)
      type(subdomain_t), intent(inout) :: subdomain !! gains its elements, but for their nodes
      integer, intent(in) :: rank !! the rank
      integer, intent(in) :: owner(:) !! the rank of each element
      type(mesh_t), intent(in) :: mesh !! the mesh of the body
      integer :: element, n_items, i, first

      associate (own => subdomain%mesh)
         own%element_kind = pack(mesh%element_kind, owner == rank)
         own%n_elements = size(own%element_kind)
         allocate (own%node_start(own%n_elements + 1))
         own%n_elements = 0
         own%node_start(1) = 1
         do element = 1, mesh%n_elements
            if (owner(element) /= rank) cycle
            n_items = mesh%node_start(element + 1) - mesh%node_start(element)
            own%n_elements = own%n_elements + 1
            own%node_start(own%n_elements + 1) = own%node_start(own%n_elements) + n_items
         end do
         allocate (subdomain%place(own%node_start(own%n_elements + 1) - 1))
         n_items = 0
         do element = 1, mesh%n_elements
            if (owner(element) /= rank) cycle
            first = mesh%node_start(element)
            do i = first, mesh%node_start(element + 1) - 1
               n_items = n_items + 1
               subdomain%place(n_items) = i
            end do
         end do
      end associate
   end subroutine take_elements

   !> Passes a subdomain from rank 0 to the rank that owns it.
   subroutine subdomain_pass(self, line)
      class(subdomain_t), intent(inout) :: self !! the subdomain
      type(line_t), intent(in) :: line !! the line between the ranks
      real(dp), allocatable :: numbers(:, :)
      integer, allocatable :: dof(:)

      associate (mesh => self%mesh)
         call line%pass(mesh%n_elements)
         call line%pass(mesh%coordinates)
         call line%pass(mesh%element_kind)
         call line%pass(mesh%node_start)
         call line%pass(mesh%node)
      end associate
      call line%pass(self%node)
      call line%pass(self%place)
      call line%pass(self%constraints%axis)
      if (line%is_sender) dof = reshape(self%dof_map%dof, [2*size(self%node)])
      call line%pass(dof)
      call line%pass(self%materials%of_element)
      if (line%is_sender) numbers = material_numbers(self%materials)
      call line%pass(numbers)
      if (line%is_sender) return
      self%mesh%n_nodes = size(self%node)
      self%dof_map%dof = reshape(dof, [2, size(self%node)])
      call set_materials(self%materials, numbers)
      allocate (self%springs(0))
   end subroutine subdomain_pass

   !> Numbers the unknowns anew and colors the elements.
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

   !> What stiffness and stress need of materials, a column for each.
   pure function material_numbers(materials) result(numbers)
      type(materials_t), intent(in) :: materials !! the materials
      real(dp), allocatable :: numbers(:, :)
      integer :: i

      allocate (numbers(6, size(materials%list)))
      do i = 1, size(materials%list)
         associate (material => materials%list(i))
            numbers(:, i) = [material%thickness, material%lambda, material%mu, &
               merge(1.0_dp, 0.0_dp, [material%has_mean_dilatation, material%is_plane_stress, &
               material%is_axisymmetric])]
         end associate
      end do
   end function material_numbers

   !> Sets materials from these numbers.
   pure subroutine set_materials(materials, numbers)
      type(materials_t), intent(inout) :: materials !! gains its list
      real(dp), intent(in) :: numbers(:, :) !! the numbers of each material
      integer :: i

      allocate (materials%list(size(numbers, 2)))
      do i = 1, size(numbers, 2)
         associate (material => materials%list(i))
            material%thickness = numbers(1, i)
            material%lambda = numbers(2, i)
            material%mu = numbers(3, i)
            material%has_mean_dilatation = numbers(4, i) > 0.0_dp
            material%is_plane_stress = numbers(5, i) > 0.0_dp
            material%is_axisymmetric = numbers(6, i) > 0.0_dp
         end associate
      end do
   end subroutine set_materials

end module amontons_subdomain
