!> Stresses and strain energy density of a whole body, as result files show them, and the nodal forces that they amount
!> to.
module amontons_stress_field
   use amontons_coloring, only: coloring_t, worth_threads
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_elasticity, only: add_point_forces, element_geometry_t, find_elastic_strains, new_element_geometry, &
      set_thermal_strain
   use amontons_element, only: element_names, is_triangle, max_nodes, max_points, n_element_nodes, n_element_points, &
      node_coordinates, quadrature_point
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: find_node_stresses, new_stress_field, stress_field_t, von_mises

   !> Stresses xx, yy, xy, zz; in a body of revolution radial, axial, shear, hoop.
   type :: stress_field_t
      real(dp), allocatable :: element(:, :) !! mean stress of each element (4, n_elements) [F/L^2]
      real(dp), allocatable :: energy_density(:) !! mean strain energy density of each element (n_elements) [F/L^2]
      real(dp), allocatable :: node(:, :)
         !! stress at each node: the mean of what its elements say; 0 at a node without elements (4, n_nodes) [F/L^2]
      real(dp), allocatable :: force(:, :)
         !! nodal forces that the stresses amount to, x and y; K u - f_th where there are no springs (2, n_nodes) [F]
   end type stress_field_t

contains

   !> Evaluates the stresses of a displacement field.
   subroutine new_stress_field(field, mesh, materials, coloring, displacement, thermal_strain)
      type(stress_field_t), intent(out) :: field !! the stresses
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      real(dp), allocatable :: node(:, :, :), strain(:, :)

      allocate (field%element(4, mesh%n_elements), field%energy_density(mesh%n_elements))
      allocate (field%force(2, mesh%n_nodes), source=0.0_dp)
      if (present(thermal_strain)) strain = reshape(thermal_strain, [size(thermal_strain), 1])
      call find_node_stresses(node, mesh, materials, coloring, reshape(displacement, [2, mesh%n_nodes, 1]), strain, &
         field)
      field%node = node(:, :, 1)
   end subroutine new_stress_field

   !> Evaluates the stresses at the nodes of several displacement fields: the shape functions of each element serve all
   !> of them.
   subroutine find_node_stresses(node, mesh, materials, coloring, displacement, thermal_strain, field_of_one)
      real(dp), allocatable, intent(out) :: node(:, :, :) !! stress at each node (4, n_nodes, fields) [F/L^2]
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      real(dp), contiguous, intent(in) :: displacement(:, :, :) !! displacement of the nodes (2, n_nodes, fields) [L]
      real(dp), intent(in), optional :: thermal_strain(:, :)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` (any, fields) [-]
      type(stress_field_t), intent(inout), optional :: field_of_one
         !! gains means and nodal forces of the one displacement field; its arrays made, the forces 0
      type(element_geometry_t) :: geometry
      real(dp) :: to_nodes(max_nodes, max_points, size(element_names)), at_nodes(4, max_nodes)
      real(dp), dimension(4, max_points) :: strain, stress
      integer, allocatable :: n_elements(:)
      integer :: color, element, field, i, k

      to_nodes = extrapolations(materials%list(1)%is_axisymmetric)
      allocate (node(4, mesh%n_nodes, size(displacement, 3)), source=0.0_dp)
      allocate (n_elements(mesh%n_nodes), source=0)
      do color = 1, coloring%n_colors
         !$omp parallel do default(none) schedule(static) firstprivate(geometry) if (mesh%n_elements >= worth_threads) &
         !$omp private(element, field, at_nodes, strain, stress, k) &
         !$omp shared(node, mesh, materials, coloring, displacement, thermal_strain, to_nodes, n_elements, color, &
         !$omp field_of_one)
         do i = coloring%start(color), coloring%start(color + 1) - 1
            element = coloring%element(i)
            associate (material => materials%list(materials%of_element(element)))
               call new_element_geometry(geometry, mesh, element, material)
               do field = 1, size(displacement, 3)
                  if (present(thermal_strain)) call set_thermal_strain(geometry, &
                     thermal_strain(mesh%node_start(element):mesh%node_start(element + 1) - 1, field))
                  call evaluate_points(geometry, material, displacement(:, :, field), strain, stress)
                  call carry_to_nodes(geometry, stress, to_nodes(:, :, mesh%element_kind(element)), at_nodes)
                  do k = 1, geometry%n_nodes
                     node(:, geometry%node(k), field) = node(:, geometry%node(k), field) + at_nodes(:, k)
                  end do
               end do
               if (present(field_of_one)) call evaluate_element(field_of_one, element, geometry, material, strain, &
                  stress)
            end associate
            do k = 1, geometry%n_nodes
               n_elements(geometry%node(k)) = n_elements(geometry%node(k)) + 1
            end do
         end do
         !$omp end parallel do
      end do
      do field = 1, size(node, 3)
         do i = 1, mesh%n_nodes
            node(:, i, field) = node(:, i, field)/max(1, n_elements(i))
         end do
      end do
   end subroutine find_node_stresses

   !> Evaluates one element: means over its volume, and forces at its nodes.
   pure subroutine evaluate_element(field, element, geometry, material, strain, stress)
      type(stress_field_t), intent(inout) :: field !! gains them
      integer, intent(in) :: element !! the element
      type(element_geometry_t), intent(in) :: geometry !! its shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: strain(4, max_points) !! elastic strain at its quadrature points [-]
      real(dp), intent(in) :: stress(4, max_points) !! stress there [F/L^2]
      real(dp) :: mean(4), energy_density, force(2, max_nodes), volume
      integer :: k, point

      mean = 0.0_dp
      energy_density = 0.0_dp
      force = 0.0_dp
      do point = 1, geometry%n_points
         call add_point_forces(force, geometry, material, stress(:, point), point)
         mean = mean + geometry%volume(point)*stress(:, point)
         energy_density = energy_density &
            + 0.5_dp*geometry%volume(point)*dot_product(strain(:, point), stress(:, point))
      end do
      volume = sum(geometry%volume(:geometry%n_points))
      field%element(:, element) = mean/volume
      field%energy_density(element) = energy_density/volume
      do k = 1, geometry%n_nodes
         field%force(:, geometry%node(k)) = field%force(:, geometry%node(k)) + force(:, k)
      end do
   end subroutine evaluate_element

   !> Elastic strain and stress at the quadrature points of one element.
   pure subroutine evaluate_points(geometry, material, displacement, strain, stress)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(inout) :: strain(4, max_points) !! the strains; unchanged past the last point [-]
      real(dp), intent(inout) :: stress(4, max_points) !! the stresses; unchanged past the last point [F/L^2]
      integer :: point

      call find_elastic_strains(geometry, material, displacement, strain)
      do point = 1, geometry%n_points
         stress(:, point) = material%stress(strain(:, point))
      end do
   end subroutine evaluate_points

   !> Carries the stresses of an element from its quadrature points to its nodes.
   pure subroutine carry_to_nodes(geometry, stress, to_nodes, at_nodes)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      real(dp), intent(in) :: stress(4, max_points) !! the stresses at the points [F/L^2]
      real(dp), intent(in) :: to_nodes(max_nodes, max_points)
         !! weights of the quadrature points at each node (node, point) [-]
      real(dp), intent(inout) :: at_nodes(4, max_nodes)
         !! stress at the element's nodes; unchanged past the last node [F/L^2]
      integer :: i, point

      do i = 1, geometry%n_nodes
         at_nodes(:, i) = 0.0_dp
         do point = 1, geometry%n_points
            at_nodes(:, i) = at_nodes(:, i) + to_nodes(i, point)*stress(:, point)
         end do
      end do
   end subroutine carry_to_nodes

   !> The weights of `extrapolation` for every kind of element (node, point, kind) [-].
   pure function extrapolations(is_axisymmetric) result(weights)
      logical, intent(in) :: is_axisymmetric !! whether the elements belong to a body of revolution
      real(dp) :: weights(max_nodes, max_points, size(element_names))
      integer :: kind

      do kind = 1, size(element_names)
         weights(:, :, kind) = extrapolation(kind, n_element_points(kind, is_axisymmetric))
      end do
   end function extrapolations

   !> Weights that carry values from the quadrature points of a kind of element to its nodes: through the polynomial
   !> 1, x, y (and x y in a quadrilateral) that fits them with least squares (node, point) [-].
   pure function extrapolation(kind, n_points) result(weights)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: n_points !! number of quadrature points
      real(dp) :: weights(max_nodes, max_points)
      real(dp), allocatable :: at_points(:, :), normal(:, :), right(:, :)
      real(dp) :: xi(2), unused
      integer :: n_terms, i, info

      n_terms = min(n_points, merge(3, 4, is_triangle(kind)))
      allocate (at_points(n_terms, n_points))
      do i = 1, n_points
         call quadrature_point(kind, n_points, i, xi, unused)
         at_points(:, i) = terms(xi, n_terms)
      end do
      normal = matmul(at_points, transpose(at_points))
      right = at_points
      ! The points of every kind tell these terms apart, so the matrix is positive definite.
      call cholesky_factor(normal, info)
      call cholesky_solve(normal, right)
      weights = 0.0_dp
      do i = 1, n_element_nodes(kind)
         weights(i, :n_points) = matmul(terms(node_coordinates(kind, i), n_terms), right)
      end do
   end function extrapolation

   !> The first terms of 1, x, y, x y.
   pure function terms(xi, n_terms)
      real(dp), intent(in) :: xi(2) !! reference coordinates [-]
      integer, intent(in) :: n_terms !! how many, 1, 3 or 4
      real(dp) :: terms(n_terms)
      real(dp) :: all_terms(4)

      all_terms = [1.0_dp, xi(1), xi(2), xi(1)*xi(2)]
      terms = all_terms(:n_terms)
   end function terms

   !> Von Mises stress [F/L^2].
   pure real(dp) function von_mises(stress)
      real(dp), intent(in) :: stress(4) !! stress xx, yy, xy, zz [F/L^2]

      von_mises = sqrt(0.5_dp*((stress(1) - stress(2))**2 + (stress(2) - stress(4))**2 + (stress(4) - stress(1))**2) &
         + 3.0_dp*stress(3)**2)
   end function von_mises

end module amontons_stress_field
