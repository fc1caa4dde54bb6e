!> The stiffness matrix of the unknowns, assembled from the elements; nodal forces of springs and work of thermal
!> strains; and magnitudes of the terms that add up to internal forces.
module amontons_assembly
   use amontons_constraints, only: constraints_t, dof_map_t, spring_side_t
   use amontons_elasticity, only: element_geometry_t, element_stiffness, find_elastic_strains, find_nodal_forces, &
      new_element_geometry, set_element_load
   use amontons_element, only: max_nodes, max_points
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t, max_components, n_strains
   use amontons_mesh, only: coloring_t, mesh_t, worth_threads
   use amontons_sparse_matrix, only: new_sparse_pattern, sparse_matrix_t
   implicit none (type, external)
   private

   public :: assemble_stiffness, from_unknowns, inner_work, is_strained, spring_forces, to_unknowns, uncanceled_force

contains

   !> Assembles the stiffness matrix of the unknowns.
   subroutine assemble_stiffness(stiffness, mesh, materials, springs, coloring, constraints, dof_map, error)
      type(sparse_matrix_t), intent(out) :: stiffness !! stiffness matrix (n_dofs, n_dofs) [F/L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of the elements
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! too large for the memory
      integer, allocatable :: spring_start(:), start(:), node(:), unknowns(:), starts(:)
      real(dp) :: span
      integer :: axis, i, n, n_dim

      ! The unknowns of all elements, one element after the other, then those of all springs; 0 for a held component.
      ! Those around the axis follow as elements and springs of their own: they act on no others.
      allocate (spring_start(size(springs)))
      n = size(mesh%node) + 1
      do i = 1, size(springs)
         n = n + size(springs(i)%node)
         spring_start(i) = n
      end do
      call dof_map%substitution%own_nodes_of_elements([mesh%node_start, spring_start], &
         [mesh%node, (springs(i)%node, i=1, size(springs))], start, node)
      n_dim = size(mesh%coordinates, 1)
      allocate (unknowns(size(dof_map%dof, 1)*size(node)))
      do i = 1, size(node)
         unknowns(n_dim*(i - 1) + 1:n_dim*i) = dof_map%dof(:n_dim, node(i))
      end do
      starts = n_dim*(start - 1) + 1
      if (size(dof_map%dof, 1) > n_dim) then
         unknowns(n_dim*size(node) + 1:) = dof_map%dof(3, node)
         starts = [starts, n_dim*size(node) + start(2:)]
      end if
      call new_sparse_pattern(stiffness, dof_map%n_dofs, starts, unknowns, error)
      if (allocated(error)) return
      ! Where the unknowns sit, for the ordering: those around the axis beside the others.
      span = maxval(maxval(mesh%coordinates, dim=2) - minval(mesh%coordinates, dim=2))
      allocate (stiffness%place(n_dim, dof_map%n_dofs))
      do i = 1, mesh%n_nodes
         do axis = 1, size(dof_map%dof, 1)
            if (dof_map%dof(axis, i) == 0) cycle
            associate (place => stiffness%place(:, dof_map%dof(axis, i)))
               place = mesh%coordinates(:, i)
               if (axis > n_dim) place(1) = -place(1) - span
            end associate
         end do
      end do
      call add_elements(stiffness, mesh, materials, coloring, constraints, dof_map)
      do i = 1, size(springs)
         n = size(dof_map%dof, 1)*size(springs(i)%node)
         call add_block(stiffness, springs(i)%node, reshape(springs(i)%stiffness, [n, n]), constraints, dof_map)
      end do
   end subroutine assemble_stiffness

   !> Adds the stiffness of all elements to that of the unknowns.
   subroutine add_elements(stiffness, mesh, materials, coloring, constraints, dof_map)
      type(sparse_matrix_t), intent(inout) :: stiffness !! stiffness of the unknowns
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of the elements
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(element_geometry_t) :: geometry
      integer :: color, element, i

      do color = 1, coloring%n_colors
         !$omp parallel do default(none) schedule(static) firstprivate(geometry) private(element) &
         !$omp shared(stiffness, mesh, materials, coloring, constraints, dof_map, color) &
         !$omp if (mesh%n_elements >= worth_threads)
         do i = coloring%start(color), coloring%start(color + 1) - 1
            do element = coloring%first(i), coloring%last(i)
               ! Chunks of one color may share the unknowns that substituted displacements are made of.
               if (dof_map%substitution%is_substituted(mesh%node(mesh%node_start(element): &
                  mesh%node_start(element + 1) - 1))) cycle
               call add_element(stiffness, geometry, element, mesh, materials, constraints, dof_map)
            end do
         end do
         !$omp end parallel do
      end do
      do i = 1, mesh%n_elements
         if (.not. dof_map%substitution%is_substituted(mesh%node(mesh%node_start(i):mesh%node_start(i + 1) - 1))) cycle
         call add_element(stiffness, geometry, i, mesh, materials, constraints, dof_map)
      end do
   end subroutine add_elements

   !> Adds the stiffness of one element to that of the unknowns.
   pure subroutine add_element(stiffness, geometry, element, mesh, materials, constraints, dof_map)
      type(sparse_matrix_t), intent(inout) :: stiffness !! stiffness of the unknowns
      type(element_geometry_t), intent(inout) :: geometry !! shape functions, best those of an element of the same kind
      integer, intent(in) :: element !! the element
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of the elements
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      real(dp) :: block(max_components*max_nodes, max_components*max_nodes)
      integer :: n

      associate (material => materials%list(materials%of_element(element)))
         call new_element_geometry(geometry, mesh, element, material)
         call element_stiffness(geometry, material, block)
         n = material%n_components*geometry%n_nodes
         call add_block(stiffness, geometry%node(:geometry%n_nodes), block(:n, :n), constraints, dof_map)
      end associate
   end subroutine add_element

   !> Adds the stiffness between some nodes to that of the unknowns.
   pure subroutine add_block(stiffness, nodes, block, constraints, dof_map)
      type(sparse_matrix_t), intent(inout) :: stiffness !! stiffness of the unknowns
      integer, intent(in) :: nodes(:) !! the nodes
      real(dp), intent(in) :: block(:, :) !! the stiffness, the components of a node beside each other (any, any) [F/L]
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      integer, allocatable :: own(:), plane(:)
      real(dp), allocatable :: transform(:, :), turned(:, :)
      integer :: i, n

      n = size(dof_map%dof, 1)
      if (dof_map%substitution%is_substituted(nodes)) then
         own = dof_map%substitution%element_nodes(nodes)
         transform = dof_map%substitution%transform(nodes, own, 1, n)
         turned = matmul(transpose(transform), matmul(block, transform))
      else
         own = nodes
         turned = block
      end if
      ! Into the frames of supports that are aslant.
      do i = 1, size(own)
         if (.not. constraints%is_turned(own(i))) cycle
         associate (frame => constraints%frame(:, :, own(i)), first => n*(i - 1) + 1)
            turned(first:n*i, :) = matmul(transpose(frame), turned(first:n*i, :))
            turned(:, first:n*i) = matmul(turned(:, first:n*i), frame)
         end associate
      end do
      if (n == size(stiffness%place, 1)) then
         call stiffness%add_element([dof_map%dof(:, own)], turned)
      else
         plane = pack([(i, i=1, size(turned, 1))], [(modulo(i, n) > 0, i=1, size(turned, 1))])
         call stiffness%add_element([dof_map%dof(:2, own)], turned(plane, plane))
         call stiffness%add_element(dof_map%dof(3, own), turned(n::n, n::n))
      end if
   end subroutine add_block

   !> The difference between the work of the stresses on the strains that displacements of the nodes make and that on
   !> the elastic strains: the integral of stress times thermal strain, less the work of body forces on the bubbles that
   !> they move themselves [F L].
   pure real(dp) function inner_work(mesh, materials, displacement, element_load) result(work)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of the elements
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: element_load(:)
         !! what acts inside the elements, from `sum_element_loads` [-], [L]
      type(element_geometry_t) :: geometry
      real(dp) :: stress(n_strains, max_points), forces(max_components, max_nodes)
      integer :: element, point

      work = 0.0_dp
      do element = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(element)))
            call new_element_geometry(geometry, mesh, element, material)
            call set_element_load(geometry, material, mesh, element, element_load)
            call find_elastic_strains(geometry, material, displacement, stress)
            do point = 1, geometry%n_points
               stress(:, point) = material%stress(stress(:, point))
               work = work + geometry%volume(point)*geometry%thermal_strain(point) &
                  *dot_product(stress(:, point), material%expansion_form())
            end do
            if (geometry%n_functions == geometry%n_nodes) cycle
            call find_nodal_forces(forces, geometry, material, stress)
            work = work - dot_product(geometry%loaded_bubble(:geometry%n_dim), &
               forces(:geometry%n_dim, geometry%n_functions))
         end associate
      end do
   end function inner_work

   !> Norm of the nodal forces |K| |u| that would result if no two terms of stiffness times displacement canceled; the
   !> rounding errors of the internal forces are a small share of them [F].
   pure real(dp) function uncanceled_force(mesh, materials, magnitude) result(force)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of the elements
      real(dp), intent(in) :: magnitude(:, :)
         !! magnitudes of the displacements of the nodes, or of what makes them up (components, n_nodes) [L]
      type(element_geometry_t) :: geometry
      real(dp), allocatable :: forces(:, :)
      real(dp) :: stiffness(max_components*max_nodes, max_components*max_nodes)
      integer :: element, n

      allocate (forces, mold=magnitude)
      forces = 0.0_dp
      do element = 1, mesh%n_elements
         associate (nodes => mesh%node(mesh%node_start(element):mesh%node_start(element + 1) - 1), &
            material => materials%list(materials%of_element(element)))
            if (all(magnitude(:, nodes) <= 0.0_dp)) cycle
            call new_element_geometry(geometry, mesh, element, material)
            call element_stiffness(geometry, material, stiffness)
            n = size(magnitude, 1)*size(nodes)
            forces(:, nodes) = forces(:, nodes) + reshape(matmul(abs(stiffness(:n, :n)), &
               reshape(magnitude(:, nodes), [n])), shape(forces(:, nodes)))
         end associate
      end do
      force = norm2(forces)
   end function uncanceled_force

   !> Whether an element bears more than a share of what its forces would be if its nodes had the largest of all
   !> displacements and no two terms canceled. Beside elements that move, the displacements of an element at rest are
   !> rounding errors themselves.
   pure logical function is_strained(mesh, materials, displacement, largest, share)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of the elements
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: largest !! the largest displacement [L]
      real(dp), intent(in) :: share !! the share [-]
      type(element_geometry_t) :: geometry
      real(dp) :: stiffness(max_components*max_nodes, max_components*max_nodes)
      integer :: element, n

      is_strained = .false.
      do element = 1, mesh%n_elements
         associate (nodes => mesh%node(mesh%node_start(element):mesh%node_start(element + 1) - 1), &
            material => materials%list(materials%of_element(element)))
            if (all(abs(displacement(:, nodes)) <= 0.0_dp)) cycle
            call new_element_geometry(geometry, mesh, element, material)
            call element_stiffness(geometry, material, stiffness)
            n = size(displacement, 1)*size(nodes)
            is_strained = maxval(abs(matmul(stiffness(:n, :n), reshape(displacement(:, nodes), [n])))) &
               > share*max(largest*maxval(sum(abs(stiffness(:n, :n)), dim=2)), tiny(largest))
         end associate
         if (is_strained) return
      end do
   end function is_strained

   !> Nodal forces of springs: spring stiffness times displacement (components, n_nodes) [F].
   pure function spring_forces(n_nodes, springs, displacement) result(forces)
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      type(spring_side_t), intent(in) :: springs(:) !! the springs
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), allocatable :: forces(:, :)
      integer :: i

      allocate (forces(size(displacement, 1), n_nodes), source=0.0_dp)
      do i = 1, size(springs)
         associate (nodes => springs(i)%node, n => size(springs(i)%stiffness(:, :, 1, 1)))
            forces(:, nodes) = forces(:, nodes) + reshape(matmul(reshape(springs(i)%stiffness, [n, n]), &
               reshape(displacement(:, nodes), [n])), shape(forces(:, nodes)))
         end associate
      end do
   end function spring_forces

   !> Nodal forces as a vector of the unknowns: their components along the free axes.
   pure function to_unknowns(field, constraints, dof_map) result(vector)
      real(dp), intent(in) :: field(:, :) !! forces on the nodes (components, n_nodes) [F]
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      real(dp), allocatable :: vector(:), own(:, :)
      integer :: node, axis

      allocate (vector(dof_map%n_dofs))
      own = dof_map%substitution%forces(field)
      do node = 1, size(field, 2)
         ! Into the frames of supports that are aslant.
         if (constraints%is_turned(node)) own(:, node) = matmul(own(:, node), constraints%frame(:, :, node))
         do axis = 1, size(own, 1)
            if (dof_map%dof(axis, node) > 0) vector(dof_map%dof(axis, node)) = own(axis, node)
         end do
      end do
   end function to_unknowns

   !> The displacements of the nodes from a vector of the unknowns and the prescribed displacements.
   pure function from_unknowns(vector, prescribed, constraints, dof_map) result(displacement)
      real(dp), intent(in) :: vector(:) !! the unknowns (n_dofs) [L]
      real(dp), intent(in) :: prescribed(:, :) !! prescribed displacements (components, n_nodes) [L]
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      real(dp), allocatable :: displacement(:, :)
      integer :: node, axis

      allocate (displacement(size(prescribed, 1), size(prescribed, 2)), source=0.0_dp)
      do node = 1, size(displacement, 2)
         do axis = 1, size(displacement, 1)
            if (dof_map%dof(axis, node) > 0) displacement(axis, node) = vector(dof_map%dof(axis, node))
         end do
         if (constraints%is_turned(node)) displacement(:, node) = matmul(constraints%frame(:, :, node), &
            displacement(:, node))
      end do
      displacement = prescribed + dof_map%substitution%displacement(displacement)
   end function from_unknowns

end module amontons_assembly
