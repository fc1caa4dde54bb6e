!> Elasticity of one element: stiffness, stress, nodal forces.
module amontons_elasticity
   use amontons_element, only: max_nodes, max_points, n_element_nodes, n_element_points, quadrature_point, shape_functions
   use amontons_kinds, only: dp
   use amontons_material, only: material_t
   use amontons_mesh, only: element_jacobian, mesh_t
   implicit none (type, external)
   private

   public :: element_forces, element_geometry_t, element_stiffness, element_stress, new_element_geometry

   !> Shape functions and their gradients at the quadrature points of one element.
   type :: element_geometry_t
      integer :: n_nodes = 0 !! number of nodes
      integer :: n_points = 0 !! number of quadrature points
      integer :: node(max_nodes) = 0 !! numbers of the nodes in the mesh
      real(dp) :: values(max_nodes, max_points) = 0.0_dp !! shape functions (node, point) [-]
      real(dp) :: gradient(2, max_nodes, max_points) = 0.0_dp !! their gradients (x and y, node, point) [1/L]
      real(dp) :: area(max_points) = 0.0_dp !! weight of each point times the Jacobian determinant [L^2]
   end type element_geometry_t

contains

   !> Evaluates the shape functions of an element.
   pure subroutine new_element_geometry(geometry, mesh, element)
      type(element_geometry_t), intent(out) :: geometry !! the shape functions at the quadrature points
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      integer, intent(in) :: element !! number of the element
      real(dp) :: xi(2), weight, derivatives(2, max_nodes), jacobian(2, 2), inverse(2, 2), determinant
      integer :: kind, point, first

      kind = mesh%element_kind(element)
      first = mesh%node_start(element)
      geometry%n_nodes = n_element_nodes(kind)
      geometry%n_points = n_element_points(kind)
      geometry%node(:geometry%n_nodes) = mesh%node(first:first + geometry%n_nodes - 1)
      do point = 1, geometry%n_points
         call quadrature_point(kind, point, xi, weight)
         call shape_functions(kind, xi, geometry%values(:, point), derivatives)
         jacobian = element_jacobian(mesh%coordinates(:, geometry%node(:geometry%n_nodes)), derivatives)
         determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
         inverse(:, 1) = [jacobian(2, 2), -jacobian(2, 1)]/determinant
         inverse(:, 2) = [-jacobian(1, 2), jacobian(1, 1)]/determinant
         geometry%gradient(:, :, point) = matmul(transpose(inverse), derivatives)
         geometry%area(point) = weight*determinant
      end do
   end subroutine new_element_geometry

   !> Stiffness of an element: sum over the points of area times
   !> lambda g_i g_j^T + mu (g_j g_i^T + (g_i . g_j) I), g the gradients (2 nodes, 2 nodes) [F/L].
   pure function element_stiffness(geometry, material) result(stiffness)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp) :: stiffness(2*max_nodes, 2*max_nodes)
      real(dp) :: lambda, mu, a(2), b(2), along
      integer :: i, j, point

      stiffness = 0.0_dp
      do point = 1, geometry%n_points
         lambda = material%lambda*geometry%area(point)*material%thickness
         mu = material%mu*geometry%area(point)*material%thickness
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
      end do
   end function element_stiffness

   !> Stress at a quadrature point: xx, yy, xy [F/L^2].
   pure function element_stress(geometry, material, displacement, point) result(stress)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: stress(3)
      real(dp) :: strain(3), g(2), u(2)
      integer :: i

      strain = 0.0_dp
      do i = 1, geometry%n_nodes
         g = geometry%gradient(:, i, point)
         u = displacement(:, geometry%node(i))
         strain = strain + [g(1)*u(1), g(2)*u(2), g(2)*u(1) + g(1)*u(2)]
      end do
      stress = material%stress(strain)
   end function element_stress

   !> Nodal forces that the stress of an element amounts to: integral of B^T stress (2, nodes) [F].
   pure function element_forces(geometry, material, displacement) result(forces)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp) :: forces(2, max_nodes)
      real(dp) :: s(3), g(2)
      integer :: i, point

      forces = 0.0_dp
      do point = 1, geometry%n_points
         s = element_stress(geometry, material, displacement, point)*geometry%area(point)*material%thickness
         do i = 1, geometry%n_nodes
            g = geometry%gradient(:, i, point)
            forces(:, i) = forces(:, i) + [s(1)*g(1) + s(3)*g(2), s(3)*g(1) + s(2)*g(2)]
         end do
      end do
   end function element_forces

end module amontons_elasticity
