!> Stresses of a whole body: those in the result files, with strain energy density and nodal forces; and superconvergent
!> patch recovery, a stress field one order more accurate than that of the displacements (Zienkiewicz and Zhu, Int. J.
!> Num. Meth. Eng. 33, 1992), with the error of the stresses estimated from it, in the norm of the strain energy
!> (Zienkiewicz and Zhu, Int. J. Num. Meth. Eng. 24, 1987).
!>
!> The elements of one material around a corner node are its patch. A polynomial of the order of the displacements is
!> fitted to the stresses at the points of the patch where they are most accurate, and to the known tractions on its
!> boundary sides. The recovered stress in an element is the mean of the polynomials of its corners, weighted by the
!> linear shape functions of the corners (Blacker and Belytschko, Int. J. Num. Meth. Eng. 37, 1994).
module amontons_stress_field
   use amontons_assembly, only: spring_forces
   use amontons_constraints, only: spring_side_t
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_elasticity, only: element_geometry_t, find_elastic_strains, find_nodal_forces, &
      is_plain_quadrilateral, new_element_geometry, plane_quadrilateral_t, quadrilateral_shapes, set_element_load
   use amontons_element, only: corner_kind, element_names, max_corners, max_nodes, max_points, &
      is_solid, n_corners, n_element_nodes, n_element_points, n_fine_points, n_sampling_points, node_coordinates, &
      quadrature_point, shape_functions
   use amontons_frame, only: new_frame, turned
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp
   use amontons_material, only: in_plane, material_t, materials_t, max_components, n_strains
   use amontons_mesh, only: coloring_t, mesh_t, worth_threads
   use amontons_quantity, only: quantity_t
   use amontons_recovery_tables, only: block_size, far_weight, find_terms, frame_t, is_linear, known_traction_t, &
      max_terms, patch_table_t, samples_t, solve_normal, sum_samples
   implicit none (type, external)
   private

   public :: error_estimate_t, find_node_stresses, internal_forces, new_error_estimate, new_recovered_stress, &
      new_stress_field, recovered_stress_t, stress_field_t, von_mises

   !> Stresses, in the order of `material_t`.
   type :: stress_field_t
      real(dp), allocatable :: element(:, :) !! mean stress of each element (n_strains, n_elements) [F/L^2]
      real(dp), allocatable :: energy_density(:) !! mean strain energy density of each element (n_elements) [F/L^2]
      real(dp), allocatable :: node(:, :)
         !! stress at each node, the mean of its elements' values; 0 without elements (n_strains, n_nodes) [F/L^2]
      real(dp), allocatable :: force(:, :)
         !! nodal forces that the stresses amount to; K u - f_th where there are no springs (components, n_nodes) [F]
   end type stress_field_t

   !> Geometry, strains and stresses of one element at its quadrature points.
   type :: element_stress_t
      integer :: n_nodes = 0 !! number of its nodes
      integer :: n_points = 0 !! number of its quadrature points
      integer :: node(max_nodes) = 0 !! its nodes
      logical :: is_plain = .false. !! whether it is a plane quadrilateral with nothing acting inside
      type(plane_quadrilateral_t) :: plain !! then this
      type(element_geometry_t) :: geometry !! else its shape functions
      real(dp) :: strain(n_strains, max_points) = 0.0_dp !! and the elastic strains at its points [-]
      real(dp) :: stress(n_strains, max_points) = 0.0_dp !! stresses at its points [F/L^2]
   end type element_stress_t

   !> The stresses and tractions that a stress field is recovered from.
   type :: recovered_stress_t
      private
      real(dp), allocatable :: sample(:, :) !! the stresses that are fitted (n_strains, n_samples) [F/L^2]
      integer, allocatable :: side_start(:) !! where the sides of a patch begin in `tractions` (patches + 1)
      type(known_traction_t), allocatable :: tractions(:) !! the known tractions, patch by patch
   end type recovered_stress_t

   !> The estimated error. The norm of a stress field is the square root of the integral of stress times strain; that of
   !> a solution is the root of twice its strain energy.
   type :: error_estimate_t
      real(dp), allocatable :: element(:) !! norm of the error of each element (n_elements) [sqrt(F L)]
      real(dp) :: norm = 0.0_dp !! norm of the error of the body [sqrt(F L)]
      real(dp) :: relative = 0.0_dp !! its ratio to the norm of the stresses, the error's included [-]
   contains
      procedure :: quantities => error_estimate_quantities
   end type error_estimate_t

contains

   !> Evaluates the stresses of a displacement field.
   subroutine new_stress_field(field, mesh, materials, coloring, displacement, element_load)
      type(stress_field_t), intent(out) :: field !! the stresses
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in), optional :: element_load(:)
         !! what acts inside the elements, from `sum_element_loads` [-], [L]
      real(dp), allocatable :: node(:, :), inside(:, :)

      allocate (field%element(n_strains, mesh%n_elements), field%energy_density(mesh%n_elements), &
         node(n_strains, mesh%n_nodes), field%force(size(displacement, 1), mesh%n_nodes))
      field%element = 0.0_dp
      field%energy_density = 0.0_dp
      field%force = 0.0_dp
      if (present(element_load)) inside = reshape(element_load, [size(element_load), 1])
      call find_node_stresses(node, 1, mesh, materials, coloring, displacement, inside, field)
      call move_alloc(node, field%node)
   end subroutine new_stress_field

   !> Nodal forces of the stresses and springs under a displacement field, K u - f_th, computed without assembling K.
   subroutine internal_forces(forces, mesh, materials, springs, coloring, displacement, element_load)
      real(dp), allocatable, intent(out) :: forces(:, :) !! nodal forces (components, n_nodes) [F]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of the elements
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in), optional :: element_load(:) !! as in `new_stress_field` [-]
      type(stress_field_t) :: field

      call new_stress_field(field, mesh, materials, coloring, displacement, element_load)
      forces = field%force + spring_forces(mesh%n_nodes, springs, displacement)
   end subroutine internal_forces

   !> Evaluates the stresses at the nodes under several displacement fields; the shape functions of each element are
   !> computed once, and not at all where nothing is strained.
   subroutine find_node_stresses(node, n_fields, mesh, materials, coloring, displacement, element_load, field_of_one)
      integer, intent(in) :: n_fields !! number of fields
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), intent(out) :: node(n_strains, mesh%n_nodes, n_fields) !! stress at each node [F/L^2]
      type(coloring_t), intent(in) :: coloring !! colors of the elements
      real(dp), intent(in) :: displacement(materials%list(1)%n_components, mesh%n_nodes, n_fields)
         !! displacement of the nodes [L]
      real(dp), intent(in), optional :: element_load(:, :)
         !! what acts inside the elements, from `sum_element_loads` (any, fields) [-], [L]
      type(stress_field_t), intent(inout), optional :: field_of_one
         !! gains means and nodal forces of the one displacement field; its arrays made, 0
      type(element_stress_t) :: own
      real(dp) :: to_nodes(max_nodes, max_points, size(element_names), 2)
      integer, allocatable :: n_elements(:)
      integer :: color, element, field, i, k

      do k = 1, size(element_names)
         if (.not. any(mesh%element_kind == k)) cycle
         to_nodes(:, :, k, 1) = extrapolation(k, n_element_points(k, .false.))
         to_nodes(:, :, k, 2) = extrapolation(k, n_element_points(k, .true.))
      end do
      node = 0.0_dp
      allocate (n_elements(mesh%n_nodes), source=0)
      do color = 1, coloring%n_colors
         !$omp parallel do default(none) schedule(static) firstprivate(own) if (mesh%n_elements >= worth_threads) &
         !$omp private(element, field, k) &
         !$omp shared(n_fields, node, mesh, materials, coloring, displacement, element_load, to_nodes, n_elements, &
         !$omp color, field_of_one)
         do i = coloring%start(color), coloring%start(color + 1) - 1
            do element = coloring%first(i), coloring%last(i)
               associate (material => materials%list(materials%of_element(element)), &
                  nodes => mesh%node(mesh%node_start(element):mesh%node_start(element + 1) - 1))
                  n_elements(nodes) = n_elements(nodes) + 1
                  if (.not. present(element_load) .and. all(abs(displacement(:, nodes, :)) <= 0.0_dp)) cycle
                  call set_element(own, mesh, element, material, present(element_load))
                  do field = 1, n_fields
                     if (present(element_load)) call set_element_load(own%geometry, material, mesh, element, &
                        element_load(:, field))
                     call compute_stresses(own, material, displacement(:, :, field))
                     k = merge(1, 2, own%n_points == n_element_points(mesh%element_kind(element), .false.))
                     call carry_to_nodes(own, to_nodes(:, :, mesh%element_kind(element), k), node(:, :, field))
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

   !> Sets nodes and geometry to those of an element.
   pure subroutine set_element(own, mesh, element, material, is_loaded)
      type(element_stress_t), intent(inout) :: own !! the element
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! its number
      type(material_t), intent(in) :: material !! its material
      logical, intent(in) :: is_loaded !! whether something acts inside it

      own%is_plain = is_plain_quadrilateral(mesh%element_kind(element), material) .and. .not. is_loaded
      if (own%is_plain) then
         call own%plain%set_element(mesh, element)
         own%n_nodes = 4
         own%n_points = 4
         own%node(:4) = own%plain%node
      else
         call new_element_geometry(own%geometry, mesh, element, material)
         own%n_nodes = own%geometry%n_nodes
         own%n_points = own%geometry%n_points
         own%node(:own%n_nodes) = own%geometry%node(:own%n_nodes)
      end if
   end subroutine set_element

   !> Computes elastic strains and stresses of a displacement field at the quadrature points.
   pure subroutine compute_stresses(own, material, displacement)
      type(element_stress_t), intent(inout) :: own !! the element; gains them
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      integer :: point

      if (own%is_plain) then
         call own%plain%compute_stresses(material, displacement)
         own%stress(:4, :4) = transpose(own%plain%stress)
         return
      end if
      call find_elastic_strains(own%geometry, material, displacement, own%strain)
      do point = 1, own%n_points
         own%stress(:, point) = material%stress(own%strain(:, point))
      end do
   end subroutine compute_stresses

   !> Integrates over one element: means over its volume, and forces at its nodes.
   pure subroutine integrate(field, element, own, material)
      type(stress_field_t), intent(inout) :: field !! gains them
      integer, intent(in) :: element !! number of the element
      type(element_stress_t), intent(in) :: own !! the element
      type(material_t), intent(in) :: material !! its material
      real(dp) :: share(max_points), density(max_points), force(max_components, max_nodes), mean(n_strains)
      integer :: k, point

      associate (n => own%n_points)
         if (own%is_plain) then
            share(:n) = own%plain%area/sum(own%plain%area)
            density(:n) = own%plain%energy_density()
            force(:2, :4) = own%plain%forces(material%thickness)
         else
            share(:n) = own%geometry%volume(:n)/sum(own%geometry%volume(:n))
            density(:n) = 0.5_dp*sum(own%strain(:, :n)*own%stress(:, :n), dim=1)
            call find_nodal_forces(force, own%geometry, material, own%stress)
         end if
         mean = 0.0_dp
         do point = 1, n
            mean = mean + share(point)*own%stress(:, point)
         end do
         field%element(:, element) = mean
         field%energy_density(element) = dot_product(share(:n), density(:n))
      end associate
      do k = 1, own%n_nodes
         field%force(:, own%node(k)) = field%force(:, own%node(k)) + force(:material%n_components, k)
      end do
   end subroutine integrate

   !> Adds the stresses of an element, extrapolated from its quadrature points, to its nodes.
   pure subroutine carry_to_nodes(own, to_nodes, node)
      type(element_stress_t), intent(in) :: own !! the element
      real(dp), intent(in) :: to_nodes(max_nodes, max_points)
         !! weights of the quadrature points at each node (node, point) [-]
      real(dp), contiguous, intent(inout) :: node(:, :) !! stress at the nodes of the mesh; gains these [F/L^2]
      real(dp) :: sum(n_strains)
      integer :: i, k, point

      do i = 1, own%n_nodes
         sum = 0.0_dp
         do point = 1, own%n_points
            !$omp simd
            do k = 1, n_strains
               sum(k) = sum(k) + to_nodes(i, point)*own%stress(k, point)
            end do
         end do
         !$omp simd
         do k = 1, n_strains
            node(k, own%node(i)) = node(k, own%node(i)) + sum(k)
         end do
      end do
   end subroutine carry_to_nodes

   !> Weights of the extrapolation from the quadrature points of a kind of element to its nodes, by the least-squares
   !> fit of the polynomial 1, x, y, z (and of products of these in a quadrilateral or hexahedron) (node, point) [-].
   pure function extrapolation(kind, n_points) result(weights)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: n_points !! number of quadrature points
      real(dp) :: weights(max_nodes, max_points), terms(max_corners), unused
      real(dp), allocatable :: at_points(:, :), normal(:, :), right(:, :), xi(:)
      integer :: n_terms, i, info

      xi = node_coordinates(kind, 1)
      n_terms = min(n_points, n_corners(kind))
      allocate (at_points(n_terms, n_points))
      do i = 1, n_points
         call quadrature_point(kind, n_points, i, xi, unused)
         terms = products(xi)
         at_points(:, i) = terms(:n_terms)
      end do
      normal = matmul(at_points, transpose(at_points))
      right = at_points
      ! The points of every kind distinguish these terms, so the matrix is positive definite.
      call cholesky_factor(normal, info)
      call cholesky_solve(normal, right)
      weights = 0.0_dp
      do i = 1, n_element_nodes(kind)
         xi = node_coordinates(kind, i)
         terms = products(xi)
         weights(i, :n_points) = matmul(terms(:n_terms), right)
      end do
   end function extrapolation

   !> The coordinates of a point and their products: 1, x, y, x y; in space 1, x, y, z, x y, y z, x z, x y z; then 0.
   pure function products(xi) result(terms)
      real(dp), intent(in) :: xi(:) !! the point [-]
      real(dp) :: terms(max_corners)

      terms = 0.0_dp
      terms(:size(xi) + 1) = [1.0_dp, xi]
      if (size(xi) == 3) terms(5:7) = xi*cshift(xi, 1)
      terms(2**size(xi)) = product(xi)
   end function products

   !> Von Mises stress of a stress tensor [F/L^2].
   pure real(dp) function von_mises(stress)
      real(dp), intent(in) :: stress(n_strains) !! the stress [F/L^2]
      real(dp), parameter :: least = tiny(least)/epsilon(least) ! smaller squares lose digits
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
      real(dp), intent(in) :: s(n_strains) !! the stress [F/L^2]

      deviatoric_square = 0.5_dp*((s(1) - s(2))**2 + (s(2) - s(3))**2 + (s(3) - s(1))**2) &
         + 3.0_dp*(s(4)**2 + s(5)**2 + s(6)**2)
   end function deviatoric_square

   !> Fits a polynomial to the stresses of the elements of a patch, by least squares.
   pure subroutine fit_polynomial(coefficient, patches, patch, mesh, stress, tractions)
      real(dp), intent(out) :: coefficient(n_strains, max_terms)
         !! coefficients of the stresses: those of the terms, nothing behind the last; of a linear polynomial the
         !! stresses at the node and their gradients along the axes (component, term) [F/L^2], [F/L^3]
      type(patch_table_t), intent(in) :: patches !! the patches
      integer, intent(in) :: patch !! number of the patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), contiguous, intent(in) :: stress(:, :) !! the stresses of the samples (n_strains, any) [F/L^2]
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      real(dp) :: normal(max_terms, max_terms), right(n_strains, max_terms), along(n_strains, 3), weight
      logical :: is_determined, has_plane
      integer :: fitted(n_strains), i, k, n_dim, n_fitted

      has_plane = is_linear(patches%frame(patch))
      n_dim = size(mesh%coordinates, 1)
      associate (frame => patches%frame(patch), n => patches%frame(patch)%n_terms, node => patches%node(patch), &
         elements => patches%element(patches%start(patch):patches%start(patch + 1) - 1))
         if (has_plane) then
            call sum_linear_samples(weight, right, frame, patches%samples, stress, elements, patches%n_near(patch))
            coefficient(:, :n_dim + 1) = right(:, :n_dim + 1)/weight
         else
            call sum_samples(normal, right, frame, patches%samples, elements, patches%n_near(patch), stress)
            call solve_normal(coefficient, n, normal, right, is_determined)
         end if
         if (size(tractions) > 0) then
            if (has_plane) then
               normal(:n, :n) = 0.0_dp
               do i = 1, n
                  normal(i, i) = weight
               end do
            end if
            n_fitted = merge(n_strains, size(in_plane), n_dim == 3)
            fitted = [(i, i=1, n_strains)]
            if (n_dim == 2) fitted(:n_fitted) = in_plane
            call fit_tractions(coefficient, fitted(:n_fitted), frame, normal(:n, :n), &
               transpose(right(fitted(:n_fitted), :n)), tractions, node)
         end if
         if (.not. has_plane) return
         do k = 1, n_dim
            along(:, k) = frame%scale(k, k)*coefficient(:, k + 1)
            do i = k + 1, n_dim
               along(:, k) = along(:, k) + frame%scale(i, k)*coefficient(:, i + 1)
            end do
         end do
         do k = 1, n_dim
            coefficient(:, 1) = coefficient(:, 1) + (mesh%coordinates(k, node) - frame%center(k))*along(:, k)
            coefficient(:, k + 1) = along(:, k)
         end do
      end associate
   end subroutine fit_polynomial

   !> Sums the normal equations of a linear polynomial in the coordinates of its patch, where their matrix is the sum of
   !> the weights times the identity.
   pure subroutine sum_linear_samples(total, right, frame, samples, stress, elements, n_near)
      real(dp), intent(out) :: total !! sum of the weights [-]
      real(dp), intent(out) :: right(n_strains, max_terms) !! their right-hand sides (component, term) [F/L^2]
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      type(samples_t), intent(in) :: samples !! the samples of all elements
      real(dp), contiguous, intent(in) :: stress(:, :) !! their stresses (n_strains, n_samples) [F/L^2]
      integer, contiguous, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! number of leading elements of the patch, which meet at its node
      real(dp) :: p(max_terms), weight
      integer :: i, j, k, component

      total = 0.0_dp
      right(:, :4) = 0.0_dp
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            call find_terms(frame, frame%n_dim + 1, samples%position(:, k), p)
            total = total + weight
            do j = 1, frame%n_dim + 1
               !$omp simd
               do component = 1, n_strains
                  right(component, j) = right(component, j) + weight*p(j)*stress(component, k)
               end do
            end do
         end do
      end do
   end subroutine sum_linear_samples

   !> Fits stresses, in the plane xx, yy and xy, to the samples and, with a large weight, to known tractions: in the
   !> middle of each side, and at the node, where sides with a smooth transition have the mean of their normals. The
   !> remainder is measured by the norm of the tensor, in which shear stresses count twice, so that the axes have no
   !> effect. Tractions around an axis are left to the fit.
   pure subroutine fit_tractions(coefficient, fitted, frame, normal, right, tractions, node)
      real(dp), intent(inout) :: coefficient(n_strains, max_terms)
         !! coefficients of the stresses; gains those of the fitted ones
      integer, intent(in) :: fitted(:) !! the stresses that are fitted
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: normal(:, :) !! the lower triangle of the normal matrix of the samples
      real(dp), intent(in) :: right(:, :) !! its right-hand sides (term, component)
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      integer, intent(in) :: node !! the node
      ! Sides continue each other smoothly where their normals differ by less than 30 degrees.
      real(dp), parameter :: smooth = cos(acos(-1.0_dp)/6.0_dp)
      real(dp), parameter :: of_tensor(n_strains) = [1.0_dp, 1.0_dp, 1.0_dp, 2.0_dp, 2.0_dp, 2.0_dp]
      real(dp) :: matrix(size(fitted)*frame%n_terms, size(fitted)*frame%n_terms), joint(size(matrix, 1), 1)
      type(known_traction_t) :: mean
      integer :: i, k, n, info, n_met, place(size(tractions))

      n = frame%n_terms
      matrix = 0.0_dp
      do i = 1, size(fitted)
         matrix((i - 1)*n + 1:i*n, (i - 1)*n + 1:i*n) = of_tensor(fitted(i))*normal
         joint((i - 1)*n + 1:i*n, 1) = of_tensor(fitted(i))*right(:, i)
      end do
      do i = 1, size(tractions)
         call add_traction(matrix, joint(:, 1), fitted, frame, normal(1, 1), tractions(i), &
            tractions(i)%n_corners + 1)
         place(i) = findloc(tractions(i)%node, node, dim=1)
      end do
      do i = 1, size(tractions)
         ! Sides that an earlier one has been taken with have no place any more.
         if (place(i) == 0) cycle
         mean = tractions(i)
         n_met = 1
         associate (mean_normal => mean%normal(:, place(i)), mean_traction => mean%traction(:, place(i)))
            do k = i + 1, size(tractions)
               if (place(k) == 0 .or. any(tractions(i)%is_known .neqv. tractions(k)%is_known)) cycle
               if (dot_product(tractions(i)%normal(:, place(i)), tractions(k)%normal(:, place(k))) <= smooth) cycle
               n_met = n_met + 1
               mean_normal = mean_normal + tractions(k)%normal(:, place(k))
               mean_traction = mean_traction + tractions(k)%traction(:, place(k))
               place(k) = 0
            end do
            if (n_met > 1) mean_normal = mean_normal/norm2(mean_normal)
            mean_traction = mean_traction/n_met
         end associate
         call add_traction(matrix, joint(:, 1), fitted, frame, normal(1, 1), mean, place(i))
      end do
      call cholesky_factor(matrix, info)
      call cholesky_solve(matrix, joint)
      coefficient(fitted, :n) = transpose(reshape(joint, [n, size(fitted)]))
   end subroutine fit_tractions

   !> Adds the known tractions at a position on a side to the normal equations.
   pure subroutine add_traction(matrix, right, fitted, frame, n_samples, side, place)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the fitted stresses
      real(dp), intent(inout) :: right(:) !! its right-hand side
      integer, intent(in) :: fitted(:) !! the stresses that are fitted
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: side !! the side
      integer, intent(in) :: place !! number of a corner, or of the middle behind the last
      ! Each equation weighs as much as ten times all samples: samples that contradict it change it by a few percent.
      real(dp), parameter :: weight = 10.0_dp
      real(dp) :: row(size(right)), frame_of_side(3, 3), of_stress(n_strains), p(max_terms)
      integer :: i, k, n

      n = frame%n_terms
      call find_terms(frame, n, side%position(:frame%n_dim, place), p)
      frame_of_side(:, 1) = side%normal(:, place)
      if (frame%n_dim == 2) frame_of_side(:, 2) = [turned(side%normal(:2, place)), 0.0_dp]
      if (frame%n_dim == 3) frame_of_side = new_frame(side%normal(:, place), 3)
      do i = 1, frame%n_dim
         if (.not. side%is_known(i)) cycle
         associate (normal => side%normal(:, place), d => frame_of_side(:, i))
            of_stress = [d*normal, d(1)*normal(2) + d(2)*normal(1), d(2)*normal(3) + d(3)*normal(2), &
               d(1)*normal(3) + d(3)*normal(1)]
            do k = 1, size(fitted)
               row((k - 1)*n + 1:k*n) = of_stress(fitted(k))*p(:n)
            end do
            do k = 1, size(row)
               matrix(:, k) = matrix(:, k) + weight*n_samples*row*row(k)
            end do
            right = right + weight*n_samples*row*dot_product(d, side%traction(:, place))
         end associate
      end do
   end subroutine add_traction

   !> Prepares the recovery of the stresses of a displacement field: its stresses where they are most accurate, and the
   !> sides of known tractions, sorted by the patches of their two corners.
   subroutine new_recovered_stress(recovered, patches, mesh, materials, tractions, displacement, element_load)
      type(recovered_stress_t), intent(out) :: recovered !! the recovered stress field
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions on the sides of the boundary
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in), optional :: element_load(:)
         !! what acts inside the elements, from `sum_element_loads` [-], [L]
      type(element_geometry_t) :: geometry
      real(dp) :: strain(n_strains, max_points)
      integer, allocatable :: side(:)
      integer :: patch(4, size(tractions)), first, i, k, most, point

      allocate (recovered%sample(n_strains, size(patches%samples%position, 2)))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) private(point, strain) &
      !$omp shared(recovered, patches, mesh, materials, displacement, element_load)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)), before => patches%samples%start(i) - 1)
            if (is_plain_quadrilateral(mesh%element_kind(i), material) .and. .not. present(element_load)) then
               recovered%sample(:, before + 1) = center_stress(mesh, i, material, displacement)
               cycle
            end if
            call new_element_geometry(geometry, mesh, i, material, n_sampling_points(mesh%element_kind(i)))
            if (present(element_load)) call set_element_load(geometry, material, mesh, i, element_load)
            call find_elastic_strains(geometry, material, displacement, strain)
            do point = 1, geometry%n_points
               recovered%sample(:, before + point) = material%stress(strain(:, point))
            end do
         end associate
      end do
      !$omp end parallel do
      most = maxval(tractions%n_corners)
      patch = 0
      do i = 1, size(tractions)
         first = mesh%node_start(tractions(i)%element)
         do k = 1, tractions(i)%n_corners
            patch(k, i) = patches%at_corner(tractions(i)%element, first - 1 &
               + findloc(mesh%node(first:mesh%node_start(tractions(i)%element + 1) - 1), tractions(i)%node(k), dim=1))
         end do
      end do
      call fill_bins(recovered%side_start, side, reshape(patch(:most, :), [most*size(tractions)]), size(patches%node))
      recovered%tractions = tractions((side + most - 1)/most)
   end subroutine new_recovered_stress

   !> The stress at the center of a four-node quadrilateral of a plane body, from the differences along its diagonals
   !> [F/L^2].
   pure function center_stress(mesh, element, material, displacement) result(stress)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material, without a mean dilatation
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp) :: stress(n_strains)
      real(dp), dimension(2) :: dx, dy, du, dv

      associate (node => mesh%node(mesh%node_start(element):mesh%node_start(element) + 3))
         dx = mesh%coordinates(1, node(3:4)) - mesh%coordinates(1, node(1:2))
         dy = mesh%coordinates(2, node(3:4)) - mesh%coordinates(2, node(1:2))
         du = displacement(1, node(3:4)) - displacement(1, node(1:2))
         dv = displacement(2, node(3:4)) - displacement(2, node(1:2))
      end associate
      stress = material%stress([du(1)*dy(2) - du(2)*dy(1), dv(2)*dx(1) - dv(1)*dx(2), 0.0_dp, &
         du(2)*dx(1) - du(1)*dx(2) + dv(1)*dy(2) - dv(2)*dy(1), 0.0_dp, 0.0_dp]/(dx(1)*dy(2) - dx(2)*dy(1)))
   end function center_stress

   !> Estimates the error of a displacement field.
   subroutine new_error_estimate(estimate, mesh, materials, displacement, patches, recovered, element_load)
      type(error_estimate_t), intent(out) :: estimate !! the estimate
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      type(recovered_stress_t), intent(in) :: recovered !! the recovered stresses
      real(dp), intent(in), optional :: element_load(:)
         !! what acts inside the elements, from `sum_element_loads` [-], [L]
      real(dp), allocatable :: squares(:, :)
      real(dp) :: sums(2)
      integer :: block

      allocate (squares(2, mesh%n_elements))
      !$omp parallel do default(none) schedule(dynamic) if (mesh%n_elements >= worth_threads) &
      !$omp shared(squares, mesh, materials, displacement, patches, recovered, element_load)
      do block = 1, size(patches%block_start) - 1
         call estimate_block(squares, mesh, materials, displacement, patches, recovered, block, element_load)
      end do
      !$omp end parallel do
      sums = sum(squares, dim=2)
      estimate%norm = sqrt(sums(1))
      if (estimate%norm > 0.0_dp) estimate%relative = estimate%norm/sqrt(sum(sums))
      estimate%element = sqrt(squares(1, :))
   end subroutine new_error_estimate

   !> Estimates the error of a block of elements.
   pure subroutine estimate_block(squares, mesh, materials, displacement, patches, recovered, block, element_load)
      real(dp), intent(inout) :: squares(:, :)
         !! squares of the norms of error and stresses of all elements; gains those of the block (2, n_elements) [F L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      type(recovered_stress_t), intent(in) :: recovered !! the recovered stresses
      integer, intent(in) :: block !! number of the block
      real(dp), intent(in), optional :: element_load(:) !! as in `new_error_estimate` [-]
      type(element_geometry_t) :: geometry
      real(dp), allocatable :: coefficient(:, :, :)
      real(dp) :: of_patch(n_strains, max_terms), weights(max_points, max_corners, size(element_names))
      integer :: i

      weights = corner_weights(size(mesh%coordinates, 1))
      associate (listed => patches%listed(patches%block_start(block):patches%block_start(block + 1) - 1))
         allocate (coefficient(n_strains, max(size(mesh%coordinates, 1) + 1, &
            maxval(patches%frame(listed)%n_terms)), size(listed)))
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
            if (patches%is_linear .and. is_plain_quadrilateral(kind, material) .and. .not. present(element_load)) then
               squares(:, i) = plain_squared_norms(mesh, i, material, displacement, patches, coefficient)
            else
               call new_element_geometry(geometry, mesh, i, material, n_fine_points(kind))
               if (present(element_load)) call set_element_load(geometry, material, mesh, i, element_load)
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
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit_polynomial`
      real(dp), contiguous, intent(in) :: weights(:, :) !! linear shape functions of the corners (points, corners) [-]
      real(dp) :: squares(2)
      real(dp) :: strain(n_strains, max_points), stress(n_strains), smooth(n_strains, max_points)
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

   !> Integrals like those of `element_squared_norms` over a four-node quadrilateral of a plane body, for its four
   !> points at once: ten times as fast as the general procedure [F L].
   pure function plain_squared_norms(mesh, element, material, displacement, patches, coefficient) result(squares)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh, all linear
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit_polynomial`
      real(dp) :: squares(2)
      type(plane_quadrilateral_t) :: plain
      real(dp) :: x(4), y(4), difference(4, 3), c(3, 3), shape(4)
      integer :: i, k, point

      call plain%set_element(mesh, element)
      call plain%compute_stresses(material, displacement)
      x = 0.0_dp
      y = 0.0_dp
      do i = 1, 4
         !$omp simd
         do point = 1, 4
            x(point) = x(point) + quadrilateral_shapes(point, i)*plain%corner(i, 1)
            y(point) = y(point) + quadrilateral_shapes(point, i)*plain%corner(i, 2)
         end do
      end do
      difference = -plain%stress(:, in_plane)
      do i = 1, 4
         c = coefficient(in_plane, :3, patches%of_corner(mesh%node_start(element) - 1 + i))
         shape = quadrilateral_shapes(:, i)
         do k = 1, 3
            !$omp simd
            do point = 1, 4
               difference(point, k) = difference(point, k) + shape(point)*(c(k, 1) &
                  + (x(point) - plain%corner(i, 1))*c(k, 2) + (y(point) - plain%corner(i, 2))*c(k, 3))
            end do
         end do
      end do
      squares(1) = material%thickness*dot_product(plain%area, material%squared_norms(difference))
      squares(2) = 2.0_dp*material%thickness*dot_product(plain%area, plain%energy_density())
   end function plain_squared_norms

   !> The recovered stresses at points of an element [F/L^2].
   pure subroutine find_recovered(stress, mesh, element, patches, coefficient, n_points, position, weights)
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(out) :: stress(n_strains, n_points) !! the stresses [F/L^2]
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      real(dp), contiguous, intent(in) :: coefficient(:, :, :) !! the polynomials of its block, from `fit_polynomial`
      real(dp), intent(in) :: position(size(mesh%coordinates, 1), n_points) !! the points [L]
      real(dp), contiguous, intent(in) :: weights(:, :) !! shape functions of the corners there (points, corners) [-]
      real(dp) :: p(max_terms), sum(n_strains)
      integer :: i, k, corner, point

      stress = 0.0_dp
      do i = 1, size(weights, 2)
         corner = mesh%node_start(element) - 1 + i
         associate (of_patch => coefficient(:, :, patches%of_corner(corner)), &
            frame => patches%frame(patches%at_corner(element, corner)))
            do point = 1, n_points
               if (is_linear(frame)) then
                  p(2:size(position, 1) + 1) = position(:, point) - mesh%coordinates(:, mesh%node(corner))
               else
                  call find_terms(frame, frame%n_terms, position(:, point), p)
               end if
               sum = of_patch(:, 1)
               do k = 2, frame%n_terms
                  sum = sum + p(k)*of_patch(:, k)
               end do
               stress(:, point) = stress(:, point) + weights(point, i)*sum
            end do
         end associate
      end do
   end subroutine find_recovered

   !> The estimate of the whole body as named quantities.
   pure function error_estimate_quantities(self) result(list)
      class(error_estimate_t), intent(in) :: self !! the estimate
      type(quantity_t) :: list(2)

      ! An error far below the stresses is rounding.
      list = [quantity_t('error_norm', 'Error of stresses', self%norm, self%norm/max(self%relative, tiny(1.0_dp)), &
         dimension='sqrt(F L)'), quantity_t('relative_error', 'Relative error', self%relative, 1.0_dp)]
   end function error_estimate_quantities

   !> The linear shape functions of the corners at the quadrature points of every kind of element (point, corner, kind)
   !> [-].
   pure function corner_weights(n_dim) result(weights)
      integer, intent(in) :: n_dim !! number of dimensions; the weights of other kinds are 0
      real(dp) :: weights(max_points, max_corners, size(element_names))
      real(dp) :: weight, values(max_nodes)
      real(dp), allocatable :: xi(:), derivatives(:, :)
      integer :: kind, point

      weights = 0.0_dp
      do kind = 1, size(element_names)
         if (is_solid(kind) .neqv. n_dim == 3) cycle
         xi = node_coordinates(kind, 1)
         derivatives = spread(xi, 2, max_nodes)
         do point = 1, n_fine_points(kind)
            call quadrature_point(kind, n_fine_points(kind), point, xi, weight)
            call shape_functions(corner_kind(kind), xi, values, derivatives)
            weights(point, :, kind) = values(:max_corners)
         end do
      end do
   end function corner_weights

end module amontons_stress_field
