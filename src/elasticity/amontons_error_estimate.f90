!> How far the stresses of a finite element solution are from those of the continuum: the error in the norm of the
!> strain energy, estimated by a recovered stress field in the place of the true one (Zienkiewicz and Zhu, Int. J. Num.
!> Meth. Eng. 24, 1987).
module amontons_error_estimate
   use amontons_coloring, only: worth_threads
   use amontons_elasticity, only: element_geometry_t, find_elastic_strains, new_element_geometry, set_thermal_strain
   use amontons_element, only: element_names, is_triangle, max_corners, max_nodes, max_points, n_corners, &
      n_fine_points, quad4, quadrature_point, shape_functions, tri3
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t
   use amontons_patch_frame, only: is_linear
   use amontons_patch_table, only: block_size, patch_table_t
   use amontons_plane_quadrilateral, only: is_plain_quadrilateral, plane_quadrilateral_t, quadrilateral_shapes
   use amontons_quantity, only: quantity_t
   use amontons_stress_patch, only: add_linear_stresses, add_stresses
   use amontons_stress_recovery, only: recovered_stress_t
   implicit none (type, external)
   private

   public :: error_estimate_t, new_error_estimate

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
   subroutine new_error_estimate(estimate, mesh, materials, displacement, patches, recovered, thermal_strain)
      type(error_estimate_t), intent(out) :: estimate !! the estimate
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      type(recovered_stress_t), intent(in) :: recovered !! the recovered stresses
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      real(dp), allocatable :: squares(:, :)
      real(dp) :: sums(2)
      integer :: block

      allocate (squares(2, mesh%n_elements))
      !$omp parallel do default(none) schedule(dynamic) if (mesh%n_elements >= worth_threads) &
      !$omp shared(squares, mesh, materials, displacement, patches, recovered, thermal_strain)
      do block = 1, size(patches%block_start) - 1
         call estimate_block(squares, mesh, materials, displacement, patches, recovered, block, thermal_strain)
      end do
      !$omp end parallel do
      sums = sum(squares, dim=2)
      estimate%norm = sqrt(sums(1))
      if (estimate%norm > 0.0_dp) estimate%relative = estimate%norm/sqrt(sum(sums))
      estimate%element = sqrt(squares(1, :))
   end subroutine new_error_estimate

   !> Estimates the error of a block of elements.
   pure subroutine estimate_block(squares, mesh, materials, displacement, patches, recovered, block, thermal_strain)
      real(dp), intent(inout) :: squares(:, :)
         !! squares of the norms of error and stresses of all elements; gains those of the block (2, n_elements) [F L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      type(recovered_stress_t), intent(in) :: recovered !! the recovered stresses
      integer, intent(in) :: block !! number of the block
      real(dp), intent(in), optional :: thermal_strain(:) !! as in `new_error_estimate` [-]
      type(element_geometry_t) :: geometry
      real(dp), allocatable :: coefficient(:, :, :)
      real(dp) :: weights(max_points, max_corners, size(element_names))
      logical :: is_plain
      integer :: i

      weights = corner_weights()
      call recovered%fit(coefficient, patches, mesh, block)
      do i = (block - 1)*block_size + 1, min(mesh%n_elements, block*block_size)
         associate (material => materials%list(materials%of_element(i)), kind => mesh%element_kind(i))
            is_plain = .not. (material%is_axisymmetric .or. present(thermal_strain))
            if (kind == tri3 .and. is_plain) then
               squares(:, i) = triangle_squares(mesh, i, material, patches, coefficient, &
                  recovered%at_sample(patches, i), weights(:, :3, tri3))
            else if (is_plain .and. patches%is_linear .and. is_plain_quadrilateral(kind, material)) then
               squares(:, i) = quadrilateral_squares(mesh, i, material, displacement, patches, coefficient)
            else
               call new_element_geometry(geometry, mesh, i, material, n_fine_points(kind))
               if (present(thermal_strain)) call set_thermal_strain(geometry, &
                  thermal_strain(mesh%node_start(i):mesh%node_start(i + 1) - 1))
               squares(:, i) = element_squares(geometry, mesh, i, material, displacement, patches, coefficient, &
                  weights(:, :n_corners(kind), kind))
            end if
         end associate
      end do
   end subroutine estimate_block

   !> The integrals over an element of the squares of the error of its stresses and of these themselves [F L].
   pure function element_squares(geometry, mesh, element, material, displacement, patches, coefficient, weights) &
      result(squares)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit`
      real(dp), contiguous, intent(in) :: weights(:, :) !! linear shape functions of the corners (points, corners) [-]
      real(dp) :: squares(2)
      real(dp) :: strain(4, max_points), stress(4), smooth(4, max_points)
      integer :: point

      call find_recovered(smooth, mesh, element, patches, coefficient, geometry%n_points, geometry%position, weights)
      call find_elastic_strains(geometry, material, displacement, strain)
      squares = 0.0_dp
      do point = 1, geometry%n_points
         stress = material%stress(strain(:, point))
         squares(1) = squares(1) + geometry%volume(point)*material%squared_norm(smooth(:, point) - stress)
         squares(2) = squares(2) + geometry%volume(point)*dot_product(strain(:, point), stress)
      end do
   end function element_squares

   !> The same of a three-node triangle of a plane body, whose stress is uniform; its points weigh alike [F L].
   pure function triangle_squares(mesh, element, material, patches, coefficient, stress, weights) result(squares)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit`
      real(dp), intent(in) :: stress(4) !! the stress of its displacements [F/L^2]
      real(dp), contiguous, intent(in) :: weights(:, :) !! shape functions (points, corners) [-]
      real(dp) :: squares(2)
      integer, parameter :: n_points = n_fine_points(tri3)
      real(dp) :: x(2, 3), position(2, n_points), smooth(4, n_points), volume
      integer :: i, point

      do i = 1, 3
         x(:, i) = mesh%coordinates(:, mesh%node(mesh%node_start(element) - 1 + i))
      end do
      do point = 1, n_points
         position(:, point) = weights(point, 1)*x(:, 1) + weights(point, 2)*x(:, 2) + weights(point, 3)*x(:, 3)
      end do
      call find_recovered(smooth, mesh, element, patches, coefficient, n_points, position, weights)
      volume = 0.5_dp*material%thickness &
         *((x(1, 2) - x(1, 1))*(x(2, 3) - x(2, 1)) - (x(2, 2) - x(2, 1))*(x(1, 3) - x(1, 1)))
      squares = [0.0_dp, volume*material%squared_norm(stress)]
      do point = 1, n_points
         squares(1) = squares(1) + volume/n_points*material%squared_norm(smooth(:, point) - stress)
      end do
   end function triangle_squares

   !> The same of a four-node quadrilateral of a plane body, its four points side by side: by the general way, which
   !> serves every element, it takes four times as long [F L].
   pure function quadrilateral_squares(mesh, element, material, displacement, patches, coefficient) result(squares)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh, all linear
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit`
      real(dp) :: squares(2)
      type(plane_quadrilateral_t) :: plain
      real(dp) :: position(4, 2), difference(4, 3)
      integer :: i, k, point

      call plain%place(mesh, element)
      call plain%deform(material, displacement)
      position = matmul(quadrilateral_shapes, plain%corner)
      difference = -plain%stress(:, :3)
      do i = 1, 4
         associate (c => coefficient(:, :, patches%of_corner(mesh%node_start(element) - 1 + i)))
            do k = 1, 3
               !$omp simd
               do point = 1, 4
                  difference(point, k) = difference(point, k) + quadrilateral_shapes(point, i)*(c(k, 1) &
                     + (position(point, 1) - plain%corner(i, 1))*c(k, 2) &
                     + (position(point, 2) - plain%corner(i, 2))*c(k, 3))
               end do
            end do
         end associate
      end do
      squares(1) = material%thickness*dot_product(plain%area, material%squared_norms(difference))
      squares(2) = 2.0_dp*material%thickness*dot_product(plain%area, plain%energy_density())
   end function quadrilateral_squares

   !> The recovered stresses at points of an element: xx, yy, xy, zz [F/L^2].
   pure subroutine find_recovered(stress, mesh, element, patches, coefficient, n_points, position, weights)
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(out) :: stress(4, n_points) !! the stresses [F/L^2]
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit`
      real(dp), intent(in) :: position(2, n_points) !! the points [L]
      real(dp), contiguous, intent(in) :: weights(:, :) !! shape functions of the corners there (points, corners) [-]
      integer :: i, corner

      stress = 0.0_dp
      do i = 1, size(weights, 2)
         corner = mesh%node_start(element) - 1 + i
         associate (of_patch => coefficient(:, :, patches%of_corner(corner)), &
            frame => patches%frame(patches%at_corner(element, corner)))
            if (is_linear(frame)) then
               call add_linear_stresses(stress, mesh%coordinates(:, mesh%node(corner)), of_patch, n_points, position, &
                  weights(:, i))
            else
               call add_stresses(stress, frame, of_patch, n_points, position, weights(:, i))
            end if
         end associate
      end do
   end subroutine find_recovered

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
