!> Superconvergent patch recovery: a stress field one order more accurate than that of the displacements (Zienkiewicz
!> and Zhu, Int. J. Num. Meth. Eng. 33, 1992), and the error of the stresses estimated from it, in the norm of the
!> strain energy (Zienkiewicz and Zhu, Int. J. Num. Meth. Eng. 24, 1987).
!>
!> The elements of one material around a corner node are its patch. A polynomial of the order of the displacements is
!> fitted to the stresses at the points of the patch where they are most accurate, and to the tractions that are known
!> at its sides on the boundary. In an element the recovered stress is the mean of the polynomials of its corners,
!> weighted by the linear shape functions of the corners (Blacker and Belytschko, Int. J. Num. Meth. Eng. 37, 1994).
module amontons_stress_recovery
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_elasticity, only: element_geometry_t, element_stress, find_elastic_strains, is_plain_quadrilateral, &
      new_element_geometry, plane_quadrilateral_t, quadrilateral_shapes, set_thermal_strain
   use amontons_element, only: element_names, is_triangle, max_corners, max_nodes, max_points, n_corners, &
      n_fine_points, n_sampling_points, quad4, quadrature_point, shape_functions, tri3
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t, worth_threads
   use amontons_quantity, only: quantity_t
   use amontons_recovery_tables, only: block_size, far_weight, find_terms, frame_t, is_linear, known_traction_t, &
      max_terms, patch_table_t, samples_t, solve_normal
   implicit none (type, external)
   private

   public :: error_estimate_t, new_error_estimate, new_recovered_stress, recovered_stress_t

   !> The stresses and tractions that a stress field is recovered from.
   type :: recovered_stress_t
      private
      real(dp), allocatable :: sample(:, :) !! the stresses that are fitted: xx, yy, xy, zz (4, n_samples) [F/L^2]
      integer, allocatable :: side_start(:) !! where the sides of a patch begin in `tractions` (patches + 1)
      type(known_traction_t), allocatable :: tractions(:) !! the known tractions, patch by patch
   end type recovered_stress_t

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

   !> Fits the polynomial of a patch.
   pure subroutine fit_polynomial(coefficient, patches, patch, mesh, stress, tractions)
      real(dp), intent(out) :: coefficient(4, max_terms)
         !! coefficients of the stresses xx, yy, xy, zz: those of the terms, nothing behind the last; of a linear
         !! polynomial the stresses at the node and their gradients along x and y, as `add_linear_stresses` takes them
         !! (component, term) [F/L^2]
      type(patch_table_t), intent(in) :: patches !! the patches
      integer, intent(in) :: patch !! number of the patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), contiguous, intent(in) :: stress(:, :) !! the stresses of the samples: xx, yy, xy, zz (4, any) [F/L^2]
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      real(dp) :: normal(max_terms, max_terms), right(4, max_terms), along(4, 2), distance(2), weight
      logical :: is_determined, has_plane
      integer :: i

      has_plane = is_linear(patches%frame(patch))
      associate (frame => patches%frame(patch), n => patches%frame(patch)%n_terms, node => patches%node(patch), &
         elements => patches%element(patches%start(patch):patches%start(patch + 1) - 1))
         if (has_plane) then
            call sum_linear_samples(weight, right, frame, patches%samples, stress, elements, patches%n_near(patch))
            coefficient(:, :3) = right(:, :3)/weight
         else
            call sum_samples(normal, right, frame, patches%samples, stress, elements, patches%n_near(patch))
            call solve_normal(coefficient, n, normal, right, is_determined)
         end if
         if (size(tractions) > 0) then
            if (has_plane) then
               normal(:n, :n) = 0.0_dp
               do i = 1, n
                  normal(i, i) = weight
               end do
            end if
            call fit_tractions(coefficient, frame, normal(:n, :n), transpose(right(:3, :n)), tractions, node)
         end if
         if (.not. has_plane) return
         along(:, 1) = frame%scale(1, 1)*coefficient(:, 2) + frame%scale(2, 1)*coefficient(:, 3)
         along(:, 2) = frame%scale(2, 2)*coefficient(:, 3)
         distance = mesh%coordinates(:, node) - frame%center
         coefficient(:, 1) = coefficient(:, 1) + distance(1)*along(:, 1) + distance(2)*along(:, 2)
         coefficient(:, 2:3) = along
      end associate
   end subroutine fit_polynomial

   !> Sums the normal equations of the samples of a patch.
   pure subroutine sum_samples(normal, right, frame, samples, stress, elements, n_near)
      real(dp), intent(out) :: normal(max_terms, max_terms) !! the lower triangle of their matrix
      real(dp), intent(out) :: right(4, max_terms) !! their right-hand sides (component, term) [F/L^2]
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      type(samples_t), intent(in) :: samples !! the samples of all elements
      real(dp), contiguous, intent(in) :: stress(:, :) !! their stresses (4, n_samples) [F/L^2]
      integer, contiguous, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: p(max_terms), weight
      integer :: i, j, k, n

      n = frame%n_terms
      normal(:n, :n) = 0.0_dp
      right(:, :n) = 0.0_dp
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            call find_terms(frame, n, samples%position(:, k), p)
            do j = 1, n
               normal(j:n, j) = normal(j:n, j) + (weight*p(j))*p(j:n)
               right(:, j) = right(:, j) + (weight*p(j))*stress(:, k)
            end do
         end do
      end do
   end subroutine sum_samples

   !> Sums what the normal equations of a linear polynomial come down to in the coordinates of its patch: their matrix
   !> is the sum of the weights times the identity.
   pure subroutine sum_linear_samples(total, right, frame, samples, stress, elements, n_near)
      real(dp), intent(out) :: total !! sum of the weights [-]
      real(dp), intent(out) :: right(4, max_terms) !! as in `sum_samples` [F/L^2]
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      type(samples_t), intent(in) :: samples !! the samples of all elements
      real(dp), contiguous, intent(in) :: stress(:, :) !! their stresses (4, n_samples) [F/L^2]
      integer, contiguous, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: distance(2), weight, x, y
      integer :: i, k

      total = 0.0_dp
      right(:, :3) = 0.0_dp
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            distance = samples%position(:, k) - frame%center
            x = weight*frame%scale(1, 1)*distance(1)
            y = weight*(frame%scale(2, 1)*distance(1) + frame%scale(2, 2)*distance(2))
            total = total + weight
            right(:, 1) = right(:, 1) + weight*stress(:, k)
            right(:, 2) = right(:, 2) + x*stress(:, k)
            right(:, 3) = right(:, 3) + y*stress(:, k)
         end do
      end do
   end subroutine sum_linear_samples

   !> Fits the stresses xx, yy and xy to the samples and, with a large weight, to known tractions. What the fit leaves
   !> is measured by the norm of the tensor, in which xy counts twice, so that the axes do not matter.
   pure subroutine fit_tractions(coefficient, frame, normal, right, tractions, node)
      real(dp), intent(inout) :: coefficient(4, max_terms) !! coefficients of the stresses; gains those of these three
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: normal(:, :) !! the lower triangle of the normal matrix of the samples
      real(dp), intent(in) :: right(:, :) !! its right-hand sides (term, component)
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      integer, intent(in) :: node !! the node
      real(dp), parameter :: of_tensor(3) = [1.0_dp, 1.0_dp, 2.0_dp]
      real(dp) :: matrix(3*frame%n_terms, 3*frame%n_terms), joint(3*frame%n_terms, 1)
      integer :: i, n, info

      n = frame%n_terms
      matrix = 0.0_dp
      do i = 1, 3
         matrix((i - 1)*n + 1:i*n, (i - 1)*n + 1:i*n) = of_tensor(i)*normal
         joint((i - 1)*n + 1:i*n, 1) = of_tensor(i)*right(:, i)
      end do
      call add_tractions(matrix, joint(:, 1), frame, normal(1, 1), tractions, node)
      call cholesky_factor(matrix, info)
      call cholesky_solve(matrix, joint)
      coefficient(:3, :n) = transpose(reshape(joint, [n, 3]))
   end subroutine fit_tractions

   !> Adds the equations of known tractions to the normal equations of a patch: at the middle of each side, and at the
   !> node, where two sides that go on smoothly have the mean of their normals.
   pure subroutine add_tractions(matrix, right, frame, n_samples, tractions, node)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions
      integer, intent(in) :: node !! the node
      type(known_traction_t) :: smooth
      integer :: i, place(2)

      do i = 1, size(tractions)
         call add_traction(matrix, right, frame, n_samples, tractions(i), 2)
      end do
      place = 0
      do i = 1, min(2, size(tractions))
         place(i) = merge(1, 3, tractions(i)%corner(1) == node)
      end do
      if (size(tractions) == 2) then
         if (tractions(1)%goes_on(tractions(2), place)) then
            smooth = tractions(1)%mean(tractions(2), place)
            call add_traction(matrix, right, frame, n_samples, smooth, 2)
            return
         end if
      end if
      do i = 1, min(2, size(tractions))
         call add_traction(matrix, right, frame, n_samples, tractions(i), place(i))
      end do
   end subroutine add_tractions

   !> Adds the known tractions at a place of a side to the normal equations.
   pure subroutine add_traction(matrix, right, frame, n_samples, side, place)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: side !! the side
      integer, intent(in) :: place !! 1, 2 or 3: first corner, middle, second corner
      ! Each equation weighs as much as ten times all samples: it holds to a few percent of what they say against it.
      real(dp), parameter :: weight = 10.0_dp
      real(dp) :: row(size(right)), direction(2), p(max_terms)
      integer :: i, n

      n = frame%n_terms
      call find_terms(frame, n, side%position(:, place), p)
      associate (normal => side%normal(:, place))
         do i = 1, 2
            if (.not. side%is_known(i)) cycle
            direction = normal
            if (i == 2) direction = [-normal(2), normal(1)]
            row(:n) = direction(1)*normal(1)*p(:n)
            row(n + 1:2*n) = direction(2)*normal(2)*p(:n)
            row(2*n + 1:) = (direction(1)*normal(2) + direction(2)*normal(1))*p(:n)
            matrix = matrix + weight*n_samples*spread(row, 2, 3*n)*spread(row, 1, 3*n)
            right = right + weight*n_samples*row*dot_product(direction, side%traction(:, place))
         end do
      end associate
   end subroutine add_traction

   !> Adds multiples of the stresses of a patch's polynomial at points.
   pure subroutine add_stresses(stress, frame, coefficient, n_points, position, weight)
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(inout) :: stress(4, n_points) !! xx, yy, xy, zz; gains the multiples [F/L^2]
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: coefficient(4, frame%n_terms) !! coefficients of its polynomial (component, term) [F/L^2]
      real(dp), intent(in) :: position(2, n_points) !! the points [L]
      real(dp), intent(in) :: weight(n_points) !! what the stress at each is multiplied by [-]
      real(dp) :: p(max_terms), sum(4)
      integer :: i, point

      do point = 1, n_points
         call find_terms(frame, frame%n_terms, position(:, point), p)
         sum = coefficient(:, 1)
         do i = 2, frame%n_terms
            sum = sum + p(i)*coefficient(:, i)
         end do
         stress(:, point) = stress(:, point) + weight(point)*sum
      end do
   end subroutine add_stresses

   !> Does the same for a linear polynomial.
   pure subroutine add_linear_stresses(stress, origin, coefficient, n_points, position, weight)
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(inout) :: stress(4, n_points) !! xx, yy, xy, zz; gains the multiples [F/L^2]
      real(dp), intent(in) :: origin(2) !! the node of its patch [L]
      real(dp), intent(in) :: coefficient(4, 3) !! stresses there, their gradients along x and y [F/L^2], [F/L^3]
      real(dp), intent(in) :: position(2, n_points) !! the points [L]
      real(dp), intent(in) :: weight(n_points) !! what the stress at each is multiplied by [-]
      integer :: point

      do point = 1, n_points
         stress(:, point) = stress(:, point) + weight(point)*(coefficient(:, 1) &
            + (position(1, point) - origin(1))*coefficient(:, 2) + (position(2, point) - origin(2))*coefficient(:, 3))
      end do
   end subroutine add_linear_stresses

   !> Prepares the recovery of the stresses of a displacement field: its stresses where they are most accurate, and the
   !> sides of known tractions, sorted by the patches of the corners that they begin and end at.
   subroutine new_recovered_stress(recovered, patches, mesh, materials, tractions, displacement, thermal_strain)
      type(recovered_stress_t), intent(out) :: recovered !! the recovered stress field
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions on the sides of the boundary
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      type(element_geometry_t) :: geometry
      integer, allocatable :: side(:)
      integer :: patch(2, size(tractions)), first, i, k, point

      allocate (recovered%sample(4, size(patches%samples%position, 2)))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) private(point) &
      !$omp shared(recovered, patches, mesh, materials, displacement, thermal_strain)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)), before => patches%samples%start(i) - 1)
            if (mesh%element_kind(i) == quad4 .and. .not. (material%is_axisymmetric .or. material%has_mean_dilatation &
               .or. present(thermal_strain))) then
               recovered%sample(:, before + 1) = middle_stress(mesh, i, material, displacement)
               cycle
            end if
            call new_element_geometry(geometry, mesh, i, material, n_sampling_points(mesh%element_kind(i)))
            if (present(thermal_strain)) call set_thermal_strain(geometry, &
               thermal_strain(mesh%node_start(i):mesh%node_start(i + 1) - 1))
            do point = 1, geometry%n_points
               recovered%sample(:, before + point) = element_stress(geometry, material, displacement, point)
            end do
         end associate
      end do
      !$omp end parallel do
      do i = 1, size(tractions)
         first = mesh%node_start(tractions(i)%element)
         do k = 1, 2
            patch(k, i) = patches%at_corner(tractions(i)%element, first - 1 &
               + findloc(mesh%node(first:mesh%node_start(tractions(i)%element + 1) - 1), tractions(i)%corner(k), dim=1))
         end do
      end do
      call fill_bins(recovered%side_start, side, reshape(patch, [size(patch)]), size(patches%node))
      recovered%tractions = tractions((side + 1)/2)
   end subroutine new_recovered_stress

   !> The stress in the middle of a four-node quadrilateral of a plane body, from what changes along its diagonals
   !> [F/L^2].
   pure function middle_stress(mesh, element, material, displacement) result(stress)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material, without a mean dilatation
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp) :: stress(4)
      real(dp), dimension(2) :: dx, dy, du, dv

      associate (node => mesh%node(mesh%node_start(element):mesh%node_start(element) + 3))
         dx = mesh%coordinates(1, node(3:4)) - mesh%coordinates(1, node(1:2))
         dy = mesh%coordinates(2, node(3:4)) - mesh%coordinates(2, node(1:2))
         du = displacement(1, node(3:4)) - displacement(1, node(1:2))
         dv = displacement(2, node(3:4)) - displacement(2, node(1:2))
      end associate
      stress = material%stress([du(1)*dy(2) - du(2)*dy(1), dv(2)*dx(1) - dv(1)*dx(2), &
         du(2)*dx(1) - du(1)*dx(2) + dv(1)*dy(2) - dv(2)*dy(1), 0.0_dp]/(dx(1)*dy(2) - dx(2)*dy(1)))
   end function middle_stress

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
      real(dp) :: of_patch(4, max_terms), weights(max_points, max_corners, size(element_names))
      logical :: is_plain
      integer :: i

      weights = corner_weights()
      associate (listed => patches%listed(patches%block_start(block):patches%block_start(block + 1) - 1))
         allocate (coefficient(4, max(3, maxval(patches%frame(listed)%n_terms)), size(listed)))
         do i = 1, size(listed)
            associate (sides => recovered%side_start(listed(i):listed(i) + 1))
               call fit_polynomial(of_patch, patches, listed(i), mesh, recovered%sample, &
                  recovered%tractions(sides(1):sides(2) - 1))
            end associate
            coefficient(:, :, i) = of_patch(:, :size(coefficient, 2))
         end do
      end associate
      do i = (block - 1)*block_size + 1, min(mesh%n_elements, block*block_size)
         associate (material => materials%list(materials%of_element(i)), kind => mesh%element_kind(i))
            is_plain = .not. (material%is_axisymmetric .or. present(thermal_strain))
            if (kind == tri3 .and. is_plain) then
               squares(:, i) = triangle_squared_norms(mesh, i, material, patches, coefficient, &
                  recovered%sample(:, patches%samples%start(i)), weights(:, :3, tri3))
            else if (is_plain .and. patches%is_linear .and. is_plain_quadrilateral(kind, material)) then
               squares(:, i) = quadrilateral_squared_norms(mesh, i, material, displacement, patches, coefficient)
            else
               call new_element_geometry(geometry, mesh, i, material, n_fine_points(kind))
               if (present(thermal_strain)) call set_thermal_strain(geometry, &
                  thermal_strain(mesh%node_start(i):mesh%node_start(i + 1) - 1))
               squares(:, i) = element_squared_norms(geometry, mesh, i, material, displacement, patches, coefficient, &
                  weights(:, :n_corners(kind), kind))
            end if
         end associate
      end do
   end subroutine estimate_block

   !> The integrals over an element of the squares of the error of its stresses and of these themselves [F L].
   pure function element_squared_norms(geometry, mesh, element, material, displacement, patches, coefficient, weights) &
      result(squares)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit_polynomial`
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
   end function element_squared_norms

   !> Integrals like those of `element_squared_norms` over a three-node triangle of a plane body, whose stress is
   !> uniform; its points weigh alike [F L].
   pure function triangle_squared_norms(mesh, element, material, patches, coefficient, stress, weights) result(squares)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit_polynomial`
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
   end function triangle_squared_norms

   !> Integrals like those of `element_squared_norms` over a four-node quadrilateral of a plane body, its four points
   !> side by side: by the general way, which serves every element, it takes four times as long [F L].
   pure function quadrilateral_squared_norms(mesh, element, material, displacement, patches, coefficient) &
      result(squares)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh, all linear
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit_polynomial`
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
   end function quadrilateral_squared_norms

   !> The recovered stresses at points of an element: xx, yy, xy, zz [F/L^2].
   pure subroutine find_recovered(stress, mesh, element, patches, coefficient, n_points, position, weights)
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(out) :: stress(4, n_points) !! the stresses [F/L^2]
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit_polynomial`
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

end module amontons_stress_recovery
