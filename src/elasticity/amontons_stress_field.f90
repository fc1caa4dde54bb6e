!> Stresses and strain energy density of a whole body, as result files show them, and the nodal forces that they amount
!> to.
module amontons_stress_field
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_elasticity, only: add_point_forces, element_geometry_t, find_elastic_strains, &
      is_plain_quadrilateral, new_element_geometry, plane_quadrilateral_t, set_thermal_strain
   use amontons_element, only: element_names, is_triangle, max_nodes, max_points, n_element_nodes, n_element_points, &
      node_coordinates, quadrature_point
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: coloring_t, mesh_t, worth_threads
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

   !> One element at work.
   type :: element_stress_t
      integer :: n_nodes = 0 !! number of its nodes
      integer :: n_points = 0 !! number of its quadrature points
      integer :: node(max_nodes) = 0 !! its nodes
      logical :: is_plain = .false. !! whether it is a plane quadrilateral without thermal strain
      type(plane_quadrilateral_t) :: plain !! then this
      type(element_geometry_t) :: geometry !! else its shape functions
      real(dp) :: strain(4, max_points) = 0.0_dp !! and the elastic strains at its points [-]
      real(dp) :: stress(4, max_points) = 0.0_dp !! stresses at its points [F/L^2]
   end type element_stress_t

contains

   !> Evaluates the stresses of a displacement field.
   subroutine new_stress_field(field, mesh, materials, coloring, displacement, thermal_strain)
      type(stress_field_t), intent(out) :: field !! the stresses
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      real(dp), allocatable :: node(:, :), strain(:, :)

      allocate (field%element(4, mesh%n_elements), field%energy_density(mesh%n_elements), node(4, mesh%n_nodes))
      allocate (field%force(2, mesh%n_nodes), source=0.0_dp)
      if (present(thermal_strain)) strain = reshape(thermal_strain, [size(thermal_strain), 1])
      call find_node_stresses(node, 1, mesh, materials, coloring, displacement, strain, field)
      call move_alloc(node, field%node)
   end subroutine new_stress_field

   !> Evaluates the stresses at the nodes of several displacement fields: the shape functions of each element serve all
   !> of them.
   subroutine find_node_stresses(node, n_fields, mesh, materials, coloring, displacement, thermal_strain, field_of_one)
      integer, intent(in) :: n_fields !! number of fields
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      real(dp), intent(out) :: node(4, mesh%n_nodes, n_fields) !! stress at each node (4, n_nodes, fields) [F/L^2]
      type(materials_t), intent(in) :: materials !! its materials
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      real(dp), intent(in) :: displacement(2, mesh%n_nodes, n_fields) !! displacement of the nodes [L]
      real(dp), intent(in), optional :: thermal_strain(:, :)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` (any, fields) [-]
      type(stress_field_t), intent(inout), optional :: field_of_one
         !! gains means and nodal forces of the one displacement field; its arrays made, the forces 0
      type(element_stress_t) :: own
      real(dp) :: to_nodes(max_nodes, max_points, size(element_names)), at_nodes(4, max_nodes)
      integer, allocatable :: n_elements(:)
      integer :: color, element, field, i, k

      do k = 1, size(element_names)
         to_nodes(:, :, k) = extrapolation(k, n_element_points(k, materials%list(1)%is_axisymmetric))
      end do
      node = 0.0_dp
      allocate (n_elements(mesh%n_nodes), source=0)
      do color = 1, coloring%n_colors
         !$omp parallel do default(none) schedule(static) firstprivate(own) if (mesh%n_elements >= worth_threads) &
         !$omp private(element, field, at_nodes, k) &
         !$omp shared(n_fields, node, mesh, materials, coloring, displacement, thermal_strain, to_nodes, n_elements, &
         !$omp color, field_of_one)
         do i = coloring%start(color), coloring%start(color + 1) - 1
            do element = coloring%first(i), coloring%last(i)
               associate (material => materials%list(materials%of_element(element)), first => mesh%node_start(element))
                  call place(own, mesh, element, material, present(thermal_strain))
                  do field = 1, n_fields
                     if (present(thermal_strain)) call set_thermal_strain(own%geometry, &
                        thermal_strain(first:first + own%n_nodes - 1, field))
                     call deform(own, material, displacement(:, :, field))
                     call carry_to_nodes(own, to_nodes(:, :, mesh%element_kind(element)), at_nodes)
                     do k = 1, own%n_nodes
                        node(:, own%node(k), field) = node(:, own%node(k), field) + at_nodes(:, k)
                     end do
                  end do
                  do k = 1, own%n_nodes
                     n_elements(own%node(k)) = n_elements(own%node(k)) + 1
                  end do
                  if (present(field_of_one)) call integrate(field_of_one, element, own, material)
               end associate
            end do
         end do
         !$omp end parallel do
      end do
      do field = 1, n_fields
         do i = 1, mesh%n_nodes
            node(:, i, field) = node(:, i, field)/max(1, n_elements(i))
         end do
      end do
   end subroutine find_node_stresses

   !> Takes the place of an element.
   pure subroutine place(own, mesh, element, material, is_heated)
      type(element_stress_t), intent(inout) :: own !! the element
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! its number
      type(material_t), intent(in) :: material !! its material
      logical, intent(in) :: is_heated !! whether it has a thermal strain

      own%is_plain = is_plain_quadrilateral(mesh%element_kind(element), material) .and. .not. is_heated
      if (own%is_plain) then
         call own%plain%place(mesh, element)
         own%n_nodes = 4
         own%n_points = 4
         own%node(:4) = own%plain%node
      else
         call new_element_geometry(own%geometry, mesh, element, material)
         own%n_nodes = own%geometry%n_nodes
         own%n_points = own%geometry%n_points
         own%node(:own%n_nodes) = own%geometry%node(:own%n_nodes)
      end if
   end subroutine place

   !> Finds elastic strains and stresses of a displacement field at the quadrature points.
   pure subroutine deform(own, material, displacement)
      type(element_stress_t), intent(inout) :: own !! the element; gains them
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      integer :: point

      if (own%is_plain) then
         call own%plain%deform(material, displacement)
         own%stress(:, :4) = transpose(own%plain%stress)
         return
      end if
      call find_elastic_strains(own%geometry, material, displacement, own%strain)
      do point = 1, own%n_points
         own%stress(:, point) = material%stress(own%strain(:, point))
      end do
   end subroutine deform

   !> Integrates over one element: means over its volume, and forces at its nodes.
   pure subroutine integrate(field, element, own, material)
      type(stress_field_t), intent(inout) :: field !! gains them
      integer, intent(in) :: element !! number of the element
      type(element_stress_t), intent(in) :: own !! the element
      type(material_t), intent(in) :: material !! its material
      real(dp) :: share(max_points), density(max_points), force(2, max_nodes), mean(4)
      integer :: k, point

      associate (n => own%n_points)
         if (own%is_plain) then
            share(:n) = own%plain%area/sum(own%plain%area)
            density(:n) = own%plain%energy_density()
            force(:, :4) = own%plain%forces(material%thickness)
         else
            share(:n) = own%geometry%volume(:n)/sum(own%geometry%volume(:n))
            density(:n) = 0.5_dp*sum(own%strain(:, :n)*own%stress(:, :n), dim=1)
            force = 0.0_dp
            do point = 1, n
               call add_point_forces(force, own%geometry, material, own%stress(:, point), point)
            end do
         end if
         mean = 0.0_dp
         do point = 1, n
            mean = mean + share(point)*own%stress(:, point)
         end do
         field%element(:, element) = mean
         field%energy_density(element) = dot_product(share(:n), density(:n))
      end associate
      do k = 1, own%n_nodes
         field%force(:, own%node(k)) = field%force(:, own%node(k)) + force(:, k)
      end do
   end subroutine integrate

   !> Carries the stresses of an element from its quadrature points to its nodes.
   pure subroutine carry_to_nodes(own, to_nodes, at_nodes)
      type(element_stress_t), intent(in) :: own !! the element
      real(dp), intent(in) :: to_nodes(max_nodes, max_points)
         !! weights of the quadrature points at each node (node, point) [-]
      real(dp), intent(inout) :: at_nodes(4, max_nodes)
         !! stress at the element's nodes; unchanged past the last node [F/L^2]
      integer :: i, point

      do i = 1, own%n_nodes
         at_nodes(:, i) = 0.0_dp
         do point = 1, own%n_points
            at_nodes(:, i) = at_nodes(:, i) + to_nodes(i, point)*own%stress(:, point)
         end do
      end do
   end subroutine carry_to_nodes

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
      real(dp), parameter :: least = tiny(least)/epsilon(least)
      real(dp) :: square
      integer :: power

      square = deviatoric_square(stress)
      if (square > least .and. square < huge(square)) then
         von_mises = sqrt(square)
      else
         ! Squares of numbers near 1 stay in the range of numbers.
         power = exponent(maxval(abs(stress)))
         von_mises = scale(sqrt(deviatoric_square(scale(stress, -power))), power)
      end if
   end function von_mises

   !> The square of the von Mises stress [F^2/L^4].
   pure real(dp) function deviatoric_square(s)
      real(dp), intent(in) :: s(4) !! stress xx, yy, xy, zz [F/L^2]

      deviatoric_square = 0.5_dp*((s(1) - s(2))**2 + (s(2) - s(4))**2 + (s(4) - s(1))**2) + 3.0_dp*s(3)**2
   end function deviatoric_square

end module amontons_stress_field
