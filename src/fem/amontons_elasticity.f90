!> Elasticity of one element: stiffness, stress, nodal forces.
module amontons_elasticity
   use amontons_element, only: max_nodes, max_points, n_element_nodes, n_element_points, quadrature_point, &
      shape_functions
   use amontons_kinds, only: dp
   use amontons_material, only: material_t
   use amontons_mesh, only: element_jacobian, mesh_t
   implicit none (type, external)
   private

   public :: element_forces, element_geometry_t, element_stiffness, element_strain, element_stress, &
      new_element_geometry

   !> Shape functions and their gradients at the quadrature points of one element.
   type :: element_geometry_t
      ! No defaults here: setting them would take as long as all the rest, once for each element.
      integer :: n_nodes !! number of nodes
      integer :: n_points !! number of quadrature points
      integer :: node(max_nodes) !! numbers of the nodes in the mesh
      real(dp) :: values(max_nodes, max_points) !! shape functions (node, point) [-]
      real(dp) :: gradient(2, max_nodes, max_points) !! their gradients (x and y, node, point) [1/L]
      real(dp) :: position(2, max_points) !! coordinates of the points [L]
      real(dp) :: volume(max_points) !! quadrature weight, Jacobian and depth of each point, 0 past the last [L^3]
   end type element_geometry_t

contains

   !> Evaluates the shape functions of an element.
   pure subroutine new_element_geometry(geometry, mesh, element, material)
      type(element_geometry_t), intent(out) :: geometry !! the shape functions at the quadrature points
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      integer, intent(in) :: element !! number of the element
      type(material_t), intent(in) :: material !! its material, for the depth
      real(dp) :: xi(2), weight, derivatives(2, max_nodes), jacobian(2, 2), inverse(2, 2), determinant
      integer :: kind, point, n

      kind = mesh%element_kind(element)
      n = n_element_nodes(kind)
      geometry%n_nodes = n
      geometry%n_points = n_element_points(kind, material%is_axisymmetric)
      geometry%volume = 0.0_dp
      geometry%node(:n) = mesh%node(mesh%node_start(element):mesh%node_start(element) + n - 1)
      associate (coordinates => mesh%coordinates(:, geometry%node(:n)))
         do point = 1, geometry%n_points
            call quadrature_point(kind, geometry%n_points, point, xi, weight)
            call shape_functions(kind, xi, geometry%values(:, point), derivatives)
            jacobian = element_jacobian(coordinates, derivatives)
            determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
            inverse(:, 1) = [jacobian(2, 2), -jacobian(2, 1)]/determinant
            inverse(:, 2) = [-jacobian(1, 2), jacobian(1, 1)]/determinant
            geometry%gradient(:, :n, point) = matmul(transpose(inverse), derivatives(:, :n))
            geometry%position(:, point) = matmul(coordinates, geometry%values(:n, point))
            geometry%volume(point) = weight*determinant*material%depth(geometry%position(1, point))
         end do
      end associate
   end subroutine new_element_geometry

   !> Stiffness of an element: sum over the points of volume times
   !> lambda g_i g_j^T + mu (g_j g_i^T + (g_i . g_j) I), g the gradients, and in a body of revolution the hoop strain's
   !> part.
   pure subroutine element_stiffness(geometry, material, stiffness)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(out) :: stiffness(2*max_nodes, 2*max_nodes) !! in the first 2 nodes rows and columns [F/L]
      real(dp) :: lambda, mu, a(2), b(2), along
      integer :: i, j, point

      stiffness(:2*geometry%n_nodes, :2*geometry%n_nodes) = 0.0_dp
      do point = 1, geometry%n_points
         lambda = material%lambda*geometry%volume(point)
         mu = material%mu*geometry%volume(point)
         do j = 1, geometry%n_nodes
            b = geometry%gradient(:, j, point)
            do i = 1, geometry%n_nodes
               a = geometry%gradient(:, i, point)
               along = mu*(a(1)*b(1) + a(2)*b(2))
               stiffness(2*i - 1, 2*j - 1) = stiffness(2*i - 1, 2*j - 1) + (lambda + mu)*a(1)*b(1) + along
               stiffness(2*i, 2*j - 1) = stiffness(2*i, 2*j - 1) + lambda*a(2)*b(1) + mu*a(1)*b(2)
               stiffness(2*i - 1, 2*j) = stiffness(2*i - 1, 2*j) + lambda*a(1)*b(2) + mu*a(2)*b(1)
               stiffness(2*i, 2*j) = stiffness(2*i, 2*j) + (lambda + mu)*a(2)*b(2) + along
            end do
         end do
         if (material%is_axisymmetric) call add_hoop_stiffness(geometry, point, lambda, mu, stiffness)
      end do
   end subroutine element_stiffness

   !> Adds what the hoop strain u_r / r contributes to the stiffness at one point.
   pure subroutine add_hoop_stiffness(geometry, point, lambda, mu, stiffness)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      integer, intent(in) :: point !! number of the quadrature point
      real(dp), intent(in) :: lambda !! first Lame coefficient times volume [F L]
      real(dp), intent(in) :: mu !! shear modulus times volume [F L]
      real(dp), intent(inout) :: stiffness(:, :) !! stiffness (2 nodes, 2 nodes) [F/L]
      real(dp) :: a(2), b(2), hoop_a, hoop_b
      integer :: i, j

      do j = 1, geometry%n_nodes
         b = geometry%gradient(:, j, point)
         hoop_b = geometry%values(j, point)/geometry%position(1, point)
         do i = 1, geometry%n_nodes
            a = geometry%gradient(:, i, point)
            hoop_a = geometry%values(i, point)/geometry%position(1, point)
            stiffness(2*i - 1, 2*j - 1) = stiffness(2*i - 1, 2*j - 1) + lambda*(a(1)*hoop_b + hoop_a*b(1)) &
               + (lambda + 2.0_dp*mu)*hoop_a*hoop_b
            stiffness(2*i, 2*j - 1) = stiffness(2*i, 2*j - 1) + lambda*a(2)*hoop_b
            stiffness(2*i - 1, 2*j) = stiffness(2*i - 1, 2*j) + lambda*hoop_a*b(2)
         end do
      end do
   end subroutine add_hoop_stiffness

   !> Stress at a quadrature point: xx, yy, xy, zz; in a body of revolution radial, axial, shear, hoop [F/L^2].
   pure function element_stress(geometry, material, displacement, point) result(stress)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: stress(4)

      stress = material%stress(element_strain(geometry, material, displacement, point))
   end function element_stress

   !> Strain at a quadrature point: xx, yy, the engineering shear 2 xy, and the hoop strain, 0 in the plane [-].
   pure function element_strain(geometry, material, displacement, point) result(strain)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: strain(4)
      real(dp) :: g(2), u(2)
      integer :: i

      strain = 0.0_dp
      do i = 1, geometry%n_nodes
         g = geometry%gradient(:, i, point)
         u = displacement(:, geometry%node(i))
         strain(:3) = strain(:3) + [g(1)*u(1), g(2)*u(2), g(2)*u(1) + g(1)*u(2)]
         if (material%is_axisymmetric) strain(4) = strain(4) &
            + geometry%values(i, point)*u(1)/geometry%position(1, point)
      end do
   end function element_strain

   !> Nodal forces that the stress of an element amounts to: integral of B^T stress (2, nodes) [F].
   pure function element_forces(geometry, material, displacement) result(forces)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp) :: forces(2, max_nodes)
      real(dp) :: s(4), g(2)
      integer :: i, point

      forces = 0.0_dp
      do point = 1, geometry%n_points
         s = element_stress(geometry, material, displacement, point)*geometry%volume(point)
         do i = 1, geometry%n_nodes
            g = geometry%gradient(:, i, point)
            forces(:, i) = forces(:, i) + [s(1)*g(1) + s(3)*g(2), s(3)*g(1) + s(2)*g(2)]
            if (material%is_axisymmetric) forces(1, i) = forces(1, i) &
               + s(4)*geometry%values(i, point)/geometry%position(1, point)
         end do
      end do
   end function element_forces

end module amontons_elasticity
