!> How far the stresses of a finite element solution are from those of the continuum: the error in the norm of the
!> strain energy, estimated by a recovered stress field in the place of the true one (Zienkiewicz and Zhu, Int. J. Num.
!> Meth. Eng. 24, 1987).
module amontons_error_estimate
   use amontons_coloring, only: worth_threads
   use amontons_elasticity, only: elastic_strain, element_geometry_t, new_element_geometry, set_thermal_strain
   use amontons_element, only: element_names, is_triangle, max_nodes, max_points, n_corners, n_fine_points, quad4, &
      quadrature_point, shape_functions, tri3
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t
   use amontons_quantity, only: quantity_t
   use amontons_stress_recovery, only: recovered_stress_t
   implicit none (type, external)
   private

   public :: error_estimate_t, new_error_estimate

   !> Most corners that an element has.
   integer, parameter :: max_corners = 4

   !> The estimate. The norm of a stress field is the root of the integral of stress times strain: that of a solution
   !> is the root of twice its strain energy.
   type :: error_estimate_t
      real(dp), allocatable :: element(:) !! norm of the error of each element (n_elements) [sqrt(F L)]
      real(dp) :: norm = 0.0_dp !! norm of the error of the body [sqrt(F L)]
      real(dp) :: relative = 0.0_dp !! its ratio to the norm of the stresses, the error's included [-]
   contains
      procedure :: quantities => error_estimate_quantities
   end type error_estimate_t

contains

   !> Estimates the error of a displacement field.
   subroutine new_error_estimate(estimate, mesh, materials, displacement, recovered, thermal_strain)
      type(error_estimate_t), intent(out) :: estimate !! the estimate
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(recovered_stress_t), intent(inout) :: recovered !! the recovered stresses
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      ! Blocks whose patches take little memory beside all else, and few of whose elements share patches with others.
      integer, parameter :: block_size = 25000
      type(element_geometry_t) :: geometry
      real(dp) :: weights(max_points, max_corners, size(element_names))
      real(dp) :: squares(2, block_size), energy
      integer :: first, last, i

      weights = corner_weights()
      allocate (estimate%element(mesh%n_elements))
      energy = 0.0_dp
      do first = 1, mesh%n_elements, block_size
         last = min(mesh%n_elements, first + block_size - 1)
         call recovered%fit(mesh, materials, first, last)
         !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) firstprivate(geometry) &
         !$omp shared(mesh, materials, displacement, recovered, thermal_strain, squares, weights, first, last)
         do i = first, last
            associate (material => materials%list(materials%of_element(i)), kind => mesh%element_kind(i))
               if (kind == tri3 .and. .not. (material%is_axisymmetric .or. present(thermal_strain))) then
                  squares(:, i - first + 1) = triangle_squares(mesh, i, material, recovered, weights(:, :3, tri3))
                  cycle
               end if
               call new_element_geometry(geometry, mesh, i, material, n_fine_points(kind))
               if (present(thermal_strain)) call set_thermal_strain(geometry, &
                  thermal_strain(mesh%node_start(i):mesh%node_start(i + 1) - 1))
               squares(:, i - first + 1) = element_squares(geometry, mesh, i, material, displacement, recovered, &
                  weights(:, :n_corners(kind), kind))
            end associate
         end do
         !$omp end parallel do
         estimate%element(first:last) = squares(1, :last - first + 1)
         energy = energy + sum(squares(2, :last - first + 1))
      end do
      estimate%norm = sqrt(sum(estimate%element))
      if (estimate%norm > 0.0_dp) estimate%relative = estimate%norm/sqrt(energy + sum(estimate%element))
      estimate%element = sqrt(estimate%element)
   end subroutine new_error_estimate

   !> The integrals over an element of the squares of the error of its stresses and of these themselves [F L].
   pure function element_squares(geometry, mesh, element, material, displacement, recovered, weights) result(squares)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(recovered_stress_t), intent(in) :: recovered !! the recovered stresses
      real(dp), contiguous, intent(in) :: weights(:, :) !! linear shape functions of the corners (points, corners) [-]
      real(dp) :: squares(2)
      real(dp) :: strain(4), stress(4), smooth(4, max_points)
      integer :: point

      call recovered%find(mesh, element, geometry%n_points, geometry%position, weights, smooth)
      squares = 0.0_dp
      do point = 1, geometry%n_points
         strain = elastic_strain(geometry, material, displacement, point)
         stress = material%stress(strain)
         squares(1) = squares(1) + geometry%volume(point)*material%squared_norm(smooth(:, point) - stress)
         squares(2) = squares(2) + geometry%volume(point)*dot_product(strain, stress)
      end do
   end function element_squares

   !> The same of a three-node triangle of a plane body, whose stress is uniform; its points weigh alike [F L].
   pure function triangle_squares(mesh, element, material, recovered, weights) result(squares)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      type(recovered_stress_t), intent(in) :: recovered !! the recovered stresses
      real(dp), contiguous, intent(in) :: weights(:, :) !! shape functions (points, corners) [-]
      real(dp) :: squares(2)
      integer, parameter :: n_points = n_fine_points(tri3)
      real(dp) :: x(2, 3), position(2, n_points), smooth(4, n_points), stress(4), volume
      integer :: i, point

      do i = 1, 3
         x(:, i) = mesh%coordinates(:, mesh%node(mesh%node_start(element) - 1 + i))
      end do
      do point = 1, n_points
         position(:, point) = weights(point, 1)*x(:, 1) + weights(point, 2)*x(:, 2) + weights(point, 3)*x(:, 3)
      end do
      call recovered%find(mesh, element, n_points, position, weights, smooth)
      stress = recovered%sample(element)
      volume = 0.5_dp*material%thickness &
         *((x(1, 2) - x(1, 1))*(x(2, 3) - x(2, 1)) - (x(2, 2) - x(2, 1))*(x(1, 3) - x(1, 1)))
      squares = [0.0_dp, volume*material%squared_norm(stress)]
      do point = 1, n_points
         squares(1) = squares(1) + volume/n_points*material%squared_norm(smooth(:, point) - stress)
      end do
   end function triangle_squares

   !> The estimate of the whole body under its names.
   pure function error_estimate_quantities(self) result(list)
      class(error_estimate_t), intent(in) :: self !! the estimate
      type(quantity_t) :: list(2)

      list = [quantity_t('error_norm', 'Error of stresses', self%norm, dimension='sqrt(F L)'), &
         quantity_t('relative_error', 'Relative error', self%relative)]
   end function error_estimate_quantities

   !> The linear shape functions of the corners at the quadrature points of every kind of element (point, corner, kind)
   !> [-].
   pure function corner_weights() result(weights)
      real(dp) :: weights(max_points, max_corners, size(element_names))
      real(dp) :: xi(2), weight, values(max_nodes), derivatives(2, max_nodes)
      integer :: kind, point

      weights = 0.0_dp
      do kind = 1, size(element_names)
         do point = 1, n_fine_points(kind)
            call quadrature_point(kind, n_fine_points(kind), point, xi, weight)
            call shape_functions(merge(tri3, quad4, is_triangle(kind)), xi, values, derivatives)
            weights(point, :, kind) = values(:max_corners)
         end do
      end do
   end function corner_weights

end module amontons_error_estimate
