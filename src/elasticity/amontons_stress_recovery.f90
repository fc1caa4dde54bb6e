!> Superconvergent patch recovery: a stress field one order more accurate than that of the displacements (Zienkiewicz
!> and Zhu, Int. J. Num. Meth. Eng. 33, 1992).
!>
!> The elements of one material around a corner node are its patch. A polynomial of the order of the displacements is
!> fitted to the stresses at the points of the patch where they are most accurate, and to the tractions that are known
!> at its sides on the boundary. In an element the recovered stress is the mean of the polynomials of its corners,
!> weighted by the linear shape functions of the corners (Blacker and Belytschko, Int. J. Num. Meth. Eng. 37, 1994).
module amontons_stress_recovery
   use amontons_coloring, only: worth_threads
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry, set_thermal_strain
   use amontons_element, only: n_corners, n_sampling_points
   use amontons_incidence, only: incidence_t, new_incidence
   use amontons_integer_list, only: integer_list_t
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_traction_t
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: new_recovered_stress, recovered_stress_t

   !> Terms of the largest polynomial: 1, x, y, x^2, x y, y^2, x^2 y, x y^2, x^2 y^2.
   integer, parameter :: max_terms = 9
   !> Terms of the polynomial of each kind of element: linear; quadratic, of quadrilaterals in x and in y.
   integer, parameter :: n_kind_terms(*) = [3, 3, 6, 9, 9]

   !> Weight of a sample of the elements that a patch grew by: far samples determine what near ones leave open, no more.
   real(dp), parameter :: far_weight = 0.1_dp

   !> The polynomial of a patch, in coordinates in which the nodes of the patch spread alike in all directions: slender
   !> elements need no other treatment than others.
   type :: patch_t
      real(dp) :: center(2) = 0.0_dp !! mean of the nodes [L]
      real(dp) :: spread(3) = 1.0_dp !! Cholesky factor (xx, yx, yy) of their covariance [L]
      integer :: n_terms = 1 !! terms of the polynomial
      real(dp) :: coefficient(4, max_terms) = 0.0_dp !! of the stresses xx, yy, xy, zz (component, term) [F/L^2]
   end type patch_t

   !> Stresses at the points of the elements where they are most accurate.
   type :: samples_t
      integer, allocatable :: start(:) !! where the samples of an element begin (n_elements + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (2, n_samples) [L]
      real(dp), allocatable :: stress(:, :) !! stress xx, yy, xy, zz (4, n_samples) [F/L^2]
   end type samples_t

   !> The recovered stress field.
   type :: recovered_stress_t
      type(patch_t), allocatable :: patch(:) !! the patches
      integer, allocatable :: of_corner(:) !! patch of each corner of the elements, placed as `node` of the mesh
   contains
      procedure :: stress => recovered_stress_stress
   end type recovered_stress_t

contains

   !> Recovers the stresses of a displacement field.
   subroutine new_recovered_stress(recovered, mesh, materials, tractions, displacement, thermal_strain)
      type(recovered_stress_t), intent(out) :: recovered !! the recovered stress field
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(known_traction_t), intent(in) :: tractions(:) !! what is known of the tractions on the sides of the boundary
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      type(incidence_t) :: incidence
      type(samples_t) :: samples
      type(integer_list_t) :: elements
      integer, allocatable :: node(:), element(:), side_start(:), side(:)
      integer :: i

      call new_incidence(incidence, mesh)
      call new_samples(samples, mesh, materials, displacement, thermal_strain)
      call number_patches(recovered%of_corner, node, element, mesh, materials, incidence)
      call sort_sides(side_start, side, mesh, tractions, recovered%of_corner)
      allocate (recovered%patch(size(node)))
      !$omp parallel do default(none) schedule(dynamic, 256) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(elements) &
      !$omp shared(recovered, mesh, materials, incidence, samples, tractions, node, element, side_start, side)
      do i = 1, size(node)
         call fit_patch(recovered%patch(i), elements, mesh, materials, incidence, samples, &
            tractions(side(side_start(i):side_start(i + 1) - 1)), node(i), element(i))
      end do
      !$omp end parallel do
   end subroutine new_recovered_stress

   !> Evaluates the stresses where those of an element are most accurate.
   subroutine new_samples(samples, mesh, materials, displacement, thermal_strain)
      type(samples_t), intent(out) :: samples !! the stresses
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:) !! as in `new_recovered_stress` [-]
      type(element_geometry_t) :: geometry
      integer :: i, point

      allocate (samples%start(mesh%n_elements + 1))
      samples%start(1) = 1
      do i = 1, mesh%n_elements
         samples%start(i + 1) = samples%start(i) + n_sampling_points(mesh%element_kind(i))
      end do
      allocate (samples%position(2, samples%start(mesh%n_elements + 1) - 1))
      allocate (samples%stress(4, samples%start(mesh%n_elements + 1) - 1))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) private(point) shared(samples, mesh, materials, displacement, thermal_strain)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)), first => samples%start(i) - 1)
            call new_element_geometry(geometry, mesh, i, material, n_sampling_points(mesh%element_kind(i)))
            if (present(thermal_strain)) call set_thermal_strain(geometry, &
               thermal_strain(mesh%node_start(i):mesh%node_start(i + 1) - 1))
            do point = 1, geometry%n_points
               samples%position(:, first + point) = geometry%position(:, point)
               samples%stress(:, first + point) = element_stress(geometry, material, displacement, point)
            end do
         end associate
      end do
      !$omp end parallel do
   end subroutine new_samples

   !> Numbers the patches: one for each corner node and each material there.
   subroutine number_patches(of_corner, node, element, mesh, materials, incidence)
      integer, allocatable, intent(out) :: of_corner(:) !! patch of each corner, placed as `node` of the mesh
      integer, allocatable, intent(out) :: node(:) !! node of each patch
      integer, allocatable, intent(out) :: element(:) !! first element of each patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer :: n, i, k, same

      allocate (of_corner(size(mesh%node)), source=0)
      allocate (node(size(incidence%element)), element(size(incidence%element)))
      n = 0
      do i = 1, mesh%n_nodes
         do k = incidence%start(i), incidence%start(i + 1) - 1
            do same = incidence%start(i), k
               if (materials%of_element(incidence%element(same)) &
                  == materials%of_element(incidence%element(k))) exit
            end do
            if (same == k) then
               n = n + 1
               node(n) = i
               element(n) = incidence%element(k)
               of_corner(incidence%corner(k)) = n
            else
               of_corner(incidence%corner(k)) = of_corner(incidence%corner(same))
            end if
         end do
      end do
      node = node(:n)
      element = element(:n)
   end subroutine number_patches

   !> Sorts the sides of known tractions by the patches of the corners that they begin and end at.
   pure subroutine sort_sides(start, side, mesh, tractions, of_corner)
      integer, allocatable, intent(out) :: start(:) !! where the sides of a patch begin in `side` (patches + 1)
      integer, allocatable, intent(out) :: side(:) !! the sides
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(known_traction_t), intent(in) :: tractions(:) !! the sides of known tractions
      integer, intent(in) :: of_corner(:) !! patch of each corner, placed as `node` of the mesh
      integer :: patch(2, size(tractions)), i, k, first
      integer, allocatable :: next(:)

      allocate (start(maxval(of_corner) + 1), source=0)
      do i = 1, size(tractions)
         first = mesh%node_start(tractions(i)%element)
         do k = 1, 2
            patch(k, i) = of_corner(first - 1 &
               + findloc(mesh%node(first:mesh%node_start(tractions(i)%element + 1) - 1), tractions(i)%corner(k), dim=1))
         end do
         start(patch(:, i) + 1) = start(patch(:, i) + 1) + 1
      end do
      start(1) = 1
      do i = 1, size(start) - 1
         start(i + 1) = start(i + 1) + start(i)
      end do
      next = start
      allocate (side(2*size(tractions)))
      do i = 1, size(tractions)
         side(next(patch(:, i))) = i
         next(patch(:, i)) = next(patch(:, i)) + 1
      end do
   end subroutine sort_sides

   !> Fits the polynomial of a patch. A patch with too few samples for it grows by the elements around it; what no growth
   !> determines is left out.
   subroutine fit_patch(patch, elements, mesh, materials, incidence, samples, tractions, node, first)
      type(patch_t), intent(out) :: patch !! the polynomial
      type(integer_list_t), intent(inout) :: elements !! becomes the elements of the patch; on entry anything
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      type(samples_t), intent(in) :: samples !! the stresses to fit
      type(known_traction_t), intent(in) :: tractions(:) !! the sides of known tractions that meet at the node
      integer, intent(in) :: node !! the node
      integer, intent(in) :: first !! the first element of the patch
      integer, parameter :: most_growths = 2
      integer :: growth, n_near
      logical :: is_determined

      patch%n_terms = n_kind_terms(mesh%element_kind(first))
      elements%n = 0
      call add_elements_at(elements, node, materials, incidence, materials%of_element(first))
      n_near = elements%n
      do growth = 0, most_growths
         if (growth > 0) call grow_patch(elements, mesh, materials, incidence)
         call spread_patch(patch, mesh, elements%item(:elements%n))
         call fit_polynomial(patch, samples, elements%item(:elements%n), n_near, tractions, node, is_determined)
         if (is_determined) exit
      end do
      do while (.not. is_determined)
         patch%n_terms = merge(1, patch%n_terms - 3, patch%n_terms == 3)
         call fit_polynomial(patch, samples, elements%item(:elements%n), n_near, tractions, node, is_determined)
      end do
   end subroutine fit_patch

   !> Adds the elements of a material at a node that are not in a patch yet.
   pure subroutine add_elements_at(elements, node, materials, incidence, material)
      type(integer_list_t), intent(inout) :: elements !! the elements of the patch
      integer, intent(in) :: node !! the node
      type(materials_t), intent(in) :: materials !! the materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer, intent(in) :: material !! number of the material
      integer :: k

      do k = incidence%start(node), incidence%start(node + 1) - 1
         associate (element => incidence%element(k))
            if (materials%of_element(element) /= material) cycle
            if (elements%n > 0) then
               if (any(elements%item(:elements%n) == element)) cycle
            end if
            call elements%append(element)
         end associate
      end do
   end subroutine add_elements_at

   !> Adds the elements around a patch.
   pure subroutine grow_patch(elements, mesh, materials, incidence)
      type(integer_list_t), intent(inout) :: elements !! the elements of the patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer :: i, k

      do i = 1, elements%n
         associate (element => elements%item(i))
            do k = mesh%node_start(element), mesh%node_start(element) + n_corners(mesh%element_kind(element)) - 1
               call add_elements_at(elements, mesh%node(k), materials, incidence, materials%of_element(element))
            end do
         end associate
      end do
   end subroutine grow_patch

   !> Sets the coordinates of a patch from the corners of its elements.
   pure subroutine spread_patch(patch, mesh, elements)
      type(patch_t), intent(inout) :: patch !! the patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: elements(:) !! its elements
      real(dp) :: covariance(3), distance(2)
      integer :: i, k, n, pass

      covariance = 0.0_dp
      patch%center = 0.0_dp
      do pass = 1, 2
         n = 0
         do i = 1, size(elements)
            do k = mesh%node_start(elements(i)), &
               mesh%node_start(elements(i)) + n_corners(mesh%element_kind(elements(i))) - 1
               n = n + 1
               distance = mesh%coordinates(:, mesh%node(k)) - patch%center
               if (pass == 1) then
                  patch%center = patch%center + distance/n
               else
                  covariance = covariance + distance([1, 1, 2])*distance([1, 2, 2])
               end if
            end do
         end do
      end do
      covariance = covariance/n
      patch%spread(1) = sqrt(covariance(1))
      patch%spread(2) = covariance(2)/patch%spread(1)
      patch%spread(3) = sqrt(covariance(3) - patch%spread(2)**2)
   end subroutine spread_patch

   !> The terms of a patch's polynomial at a point; 0 behind the last.
   pure function terms(patch, position)
      type(patch_t), intent(in) :: patch !! the patch
      real(dp), intent(in) :: position(2) !! the point [L]
      real(dp) :: terms(max_terms)
      real(dp) :: x, y

      x = (position(1) - patch%center(1))/patch%spread(1)
      y = (position(2) - patch%center(2) - patch%spread(2)*x)/patch%spread(3)
      terms(:3) = [1.0_dp, x, y]
      terms(4:) = 0.0_dp
      if (patch%n_terms > 3) terms(4:) = [x*x, x*y, y*y, x*x*y, x*y*y, x*x*y*y]
   end function terms

   !> Fits the polynomial of a patch, unless the samples do not determine it.
   pure subroutine fit_polynomial(patch, samples, elements, n_near, tractions, node, is_determined)
      type(patch_t), intent(inout) :: patch !! the patch; gains its coefficients
      type(samples_t), intent(in) :: samples !! the stresses
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      integer, intent(in) :: node !! the node
      logical, intent(out) :: is_determined
         !! whether there is a sample more than terms and the matrix is well conditioned; always for a constant
      ! The samples of a regular patch leave pivots of a few hundredths of their number, a row too few of them leaves 0.
      real(dp), parameter :: least_pivot = 1.0e-4_dp
      real(dp), dimension(patch%n_terms, patch%n_terms) :: normal, factor
      real(dp) :: right(patch%n_terms, 4), p(max_terms), weight
      integer :: i, j, k, n, n_samples, info

      n = patch%n_terms
      normal = 0.0_dp
      right = 0.0_dp
      n_samples = 0
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            n_samples = n_samples + 1
            p = terms(patch, samples%position(:, k))
            do j = 1, n
               normal(:, j) = normal(:, j) + weight*p(j)*p(:n)
            end do
            do j = 1, 4
               right(:, j) = right(:, j) + weight*samples%stress(j, k)*p(:n)
            end do
         end do
      end do
      is_determined = .false.
      if (n > 1 .and. n_samples <= n) return
      factor = normal
      call cholesky_factor(factor, info)
      if (info == 0) is_determined = minval([(factor(i, i)**2, i=1, n)]) > least_pivot*normal(1, 1)
      if (.not. is_determined) return
      if (size(tractions) > 0) call fit_tractions(patch, normal, right, tractions, node)
      call cholesky_solve(factor, right)
      if (size(tractions) > 0) right(:, :3) = transpose(patch%coefficient(:3, :n))
      patch%coefficient(:, :n) = transpose(right)
   end subroutine fit_polynomial

   !> Fits the stresses xx, yy and xy to the samples and, with a large weight, to known tractions.
   pure subroutine fit_tractions(patch, normal, right, tractions, node)
      type(patch_t), intent(inout) :: patch !! the patch; gains their coefficients
      real(dp), intent(in) :: normal(:, :) !! the normal matrix of the samples
      real(dp), intent(in) :: right(:, :) !! its right-hand sides (term, component)
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      integer, intent(in) :: node !! the node
      real(dp) :: matrix(3*patch%n_terms, 3*patch%n_terms), joint(3*patch%n_terms, 1)
      integer :: i, n, info

      n = patch%n_terms
      matrix = 0.0_dp
      do i = 0, 2*n, n
         matrix(i + 1:i + n, i + 1:i + n) = normal
      end do
      joint(:, 1) = reshape(right(:, :3), [3*n])
      call add_tractions(matrix, joint(:, 1), patch, normal(1, 1), tractions, node)
      call cholesky_factor(matrix, info)
      call cholesky_solve(matrix, joint)
      patch%coefficient(:3, :n) = transpose(reshape(joint, [n, 3]))
   end subroutine fit_tractions

   !> Adds the equations of known tractions to the normal equations of a patch: at the middle of each side, and at the
   !> node, where two sides that go on smoothly have the mean of their normals.
   pure subroutine add_tractions(matrix, right, patch, n_samples, tractions, node)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(patch_t), intent(in) :: patch !! the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions
      integer, intent(in) :: node !! the node
      type(known_traction_t) :: smooth
      integer :: i, place(2)

      do i = 1, size(tractions)
         call add_traction(matrix, right, patch, n_samples, tractions(i), 2)
      end do
      place = 0
      do i = 1, min(2, size(tractions))
         place(i) = merge(1, 3, tractions(i)%corner(1) == node)
      end do
      if (size(tractions) == 2) then
         if (tractions(1)%goes_on(tractions(2), place)) then
            smooth = tractions(1)%mean(tractions(2), place)
            call add_traction(matrix, right, patch, n_samples, smooth, 2)
            return
         end if
      end if
      do i = 1, min(2, size(tractions))
         call add_traction(matrix, right, patch, n_samples, tractions(i), place(i))
      end do
   end subroutine add_tractions

   !> Adds the known tractions at a place of a side to the normal equations.
   pure subroutine add_traction(matrix, right, patch, n_samples, side, place)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(patch_t), intent(in) :: patch !! the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: side !! the side
      integer, intent(in) :: place !! 1, 2 or 3: first corner, middle, second corner
      ! Each equation weighs as much as ten times all samples: it holds to a few percent of what they say against it.
      real(dp), parameter :: weight = 10.0_dp
      real(dp) :: row(size(right)), direction(2), p(max_terms)
      integer :: i, n

      n = patch%n_terms
      p = terms(patch, side%position(:, place))
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

   !> The recovered stress at a point of an element: xx, yy, xy, zz [F/L^2].
   pure function recovered_stress_stress(self, mesh, element, position, weights) result(stress)
      class(recovered_stress_t), intent(in) :: self !! the recovered stress field
      type(mesh_t), intent(in) :: mesh !! its mesh
      integer, intent(in) :: element !! the element
      real(dp), intent(in) :: position(2) !! the point [L]
      real(dp), intent(in) :: weights(:) !! linear shape functions of the element's corners there (corners) [-]
      real(dp) :: stress(4)
      real(dp) :: p(max_terms)
      integer :: i, k

      stress = 0.0_dp
      do i = 1, size(weights)
         associate (patch => self%patch(self%of_corner(mesh%node_start(element) - 1 + i)))
            p = weights(i)*terms(patch, position)
            do k = 1, patch%n_terms
               stress = stress + p(k)*patch%coefficient(:, k)
            end do
         end associate
      end do
   end function recovered_stress_stress

end module amontons_stress_recovery
