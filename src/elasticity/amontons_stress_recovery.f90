!> Superconvergent patch recovery: a stress field one order more accurate than that of the displacements (Zienkiewicz
!> and Zhu, Int. J. Num. Meth. Eng. 33, 1992).
!>
!> The elements of one material around a corner node are its patch. A polynomial of the order of the displacements is
!> fitted to the stresses at the points of the patch where they are most accurate, and to the tractions that are known
!> at its sides on the boundary. In an element the recovered stress is the mean of the polynomials of its corners,
!> weighted by the linear shape functions of the corners (Blacker and Belytschko, Int. J. Num. Meth. Eng. 37, 1994).
module amontons_stress_recovery
   use amontons_coloring, only: worth_threads
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry, set_thermal_strain
   use amontons_element, only: n_corners, n_sampling_points
   use amontons_incidence, only: incidence_t, new_incidence
   use amontons_integer_list, only: integer_list_t
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_traction_t
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_stress_patch, only: add_stresses, fit_polynomial, frame_t, n_kind_terms, patch_t, samples_t, &
      spread_patch
   implicit none (type, external)
   private

   public :: new_recovered_stress, recovered_stress_t

   !> The recovered stress field. Polynomials are kept of the patches of some elements at a time: those of all would
   !> take more memory than anything else but a factor.
   type :: recovered_stress_t
      private
      type(frame_t), allocatable :: frame(:) !! coordinates of the patches at hand
      real(dp), allocatable :: coefficient(:, :, :) !! their polynomials (component, term, patch at hand) [F/L^2]
      integer, allocatable :: place(:) !! where each patch is in `frame`, 0 if it is not at hand (patches)
      integer, allocatable :: of_corner(:) !! patch of each corner of the elements, placed as `node` of the mesh
      integer, allocatable :: node(:) !! node of each patch
      integer, allocatable :: element(:) !! first element of each patch
      type(incidence_t) :: incidence !! the elements at each node
      type(samples_t) :: samples !! the stresses to fit
      integer, allocatable :: side_start(:) !! where the sides of a patch begin in `tractions` (patches + 1)
      type(known_traction_t), allocatable :: tractions(:) !! what is known of the tractions, patch by patch
   contains
      procedure, public :: fit => recovered_stress_fit
      procedure, public :: find => recovered_stress_find
      procedure, public :: sample => recovered_stress_sample
   end type recovered_stress_t

contains

   !> Prepares the recovery of the stresses of a displacement field.
   subroutine new_recovered_stress(recovered, mesh, materials, tractions, displacement, thermal_strain)
      type(recovered_stress_t), intent(out) :: recovered !! the recovered stress field
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(known_traction_t), intent(in) :: tractions(:) !! what is known of the tractions on the sides of the boundary
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      integer, allocatable :: side(:)

      call new_incidence(recovered%incidence, mesh)
      call number_patches(recovered%of_corner, recovered%node, recovered%element, mesh, materials, recovered%incidence)
      deallocate (recovered%incidence%corner)
      call sort_sides(recovered%side_start, side, mesh, tractions, recovered%of_corner)
      recovered%tractions = tractions(side)
      allocate (recovered%place(size(recovered%node)), source=0)
      call new_samples(recovered%samples, mesh, materials, displacement, thermal_strain)
   end subroutine new_recovered_stress

   !> Fits the polynomials of all patches that some elements have corners in.
   subroutine recovered_stress_fit(self, mesh, materials, first, last)
      class(recovered_stress_t), intent(inout) :: self !! the recovered stress field
      type(mesh_t), intent(in) :: mesh !! its mesh
      type(materials_t), intent(in) :: materials !! the mesh's materials
      integer, intent(in) :: first !! the first of the elements
      integer, intent(in) :: last !! the last one
      type(integer_list_t) :: list, elements
      type(patch_t) :: patch
      integer :: i, element

      self%place = 0
      do element = first, last
         do i = mesh%node_start(element), mesh%node_start(element) + n_corners(mesh%element_kind(element)) - 1
            associate (place => self%place(self%of_corner(i)))
               if (place > 0) cycle
               call list%append(self%of_corner(i))
               place = list%n
            end associate
         end do
      end do
      if (allocated(self%frame)) deallocate (self%frame, self%coefficient)
      allocate (self%frame(list%n), self%coefficient(4, maxval(n_kind_terms(mesh%element_kind(first:last))), list%n))
      !$omp parallel do default(none) schedule(dynamic, 256) if (mesh%n_elements >= worth_threads) &
      !$omp shared(self, mesh, materials, list) firstprivate(elements) private(patch)
      do i = 1, list%n
         call fit_patch(patch, self, mesh, materials, list%item(i), elements)
         self%frame(i) = patch%frame
         self%coefficient(:, :, i) = patch%coefficient(:, :size(self%coefficient, 2))
      end do
      !$omp end parallel do
   end subroutine recovered_stress_fit

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
      n = 0
      do i = 1, mesh%n_nodes
         do k = incidence%start(i), incidence%start(i + 1) - 1
            do same = incidence%start(i), k
               if (materials%of_element(incidence%element(same)) &
                  == materials%of_element(incidence%element(k))) exit
            end do
            if (same == k) then
               n = n + 1
               of_corner(incidence%corner(k)) = n
            else
               of_corner(incidence%corner(k)) = of_corner(incidence%corner(same))
            end if
         end do
      end do
      allocate (node(n), element(n))
      do i = mesh%n_nodes, 1, -1
         do k = incidence%start(i + 1) - 1, incidence%start(i), -1
            associate (patch => of_corner(incidence%corner(k)))
               node(patch) = i
               element(patch) = incidence%element(k)
            end associate
         end do
      end do
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

   !> Fits the polynomial of a patch. A patch with too few samples for it grows by the elements around it; what no
   !> growth determines is left out.
   subroutine fit_patch(patch, recovered, mesh, materials, number, elements)
      type(patch_t), intent(out) :: patch !! the polynomial
      class(recovered_stress_t), intent(in) :: recovered !! the recovered stress field
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      integer, intent(in) :: number !! number of the patch
      type(integer_list_t), intent(inout) :: elements
         !! room for the elements of the patch: to make it anew for each would take longer than to fit the polynomial
      integer, parameter :: most_growths = 2
      integer :: growth, n_near
      logical :: is_determined

      associate (node => recovered%node(number), first => recovered%element(number), samples => recovered%samples, &
         tractions => recovered%tractions(recovered%side_start(number):recovered%side_start(number + 1) - 1))
         patch%frame%n_terms = n_kind_terms(mesh%element_kind(first))
         elements%n = 0
         call add_elements_at(elements, node, materials, recovered%incidence, materials%of_element(first))
         n_near = elements%n
         do growth = 0, most_growths
            if (growth > 0) call grow_patch(elements, mesh, materials, recovered%incidence)
            call spread_patch(patch%frame, mesh, elements%item(:elements%n))
            call fit_polynomial(patch, samples, elements%item(:elements%n), n_near, tractions, node, is_determined)
            if (is_determined) exit
         end do
         do while (.not. is_determined)
            patch%frame%n_terms = merge(1, patch%frame%n_terms - 3, patch%frame%n_terms == 3)
            call fit_polynomial(patch, samples, elements%item(:elements%n), n_near, tractions, node, is_determined)
         end do
      end associate
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
      integer :: i, k, element

      do i = 1, elements%n
         ! A copy: the list may move to a larger place as it grows.
         element = elements%item(i)
         do k = mesh%node_start(element), mesh%node_start(element) + n_corners(mesh%element_kind(element)) - 1
            call add_elements_at(elements, mesh%node(k), materials, incidence, materials%of_element(element))
         end do
      end do
   end subroutine grow_patch

   !> The recovered stresses at points of an element, one of those that `fit` was called for: xx, yy, xy, zz [F/L^2].
   pure subroutine recovered_stress_find(self, mesh, element, n_points, position, weights, stress)
      class(recovered_stress_t), intent(in) :: self !! the recovered stress field
      type(mesh_t), intent(in) :: mesh !! its mesh
      integer, intent(in) :: element !! the element
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(in) :: position(2, n_points) !! the points [L]
      real(dp), contiguous, intent(in) :: weights(:, :)
         !! linear shape functions of the corners there (points, corners) [-]
      real(dp), intent(out) :: stress(4, n_points) !! the stresses [F/L^2]
      integer :: i, patch

      stress = 0.0_dp
      do i = 1, size(weights, 2)
         patch = self%place(self%of_corner(mesh%node_start(element) - 1 + i))
         call add_stresses(self%frame(patch), self%coefficient(:, :, patch), n_points, position, weights(:, i), stress)
      end do
   end subroutine recovered_stress_find

   !> The stress of an element where it is most accurate, at the first point of them: that of all of it, where it is
   !> uniform. xx, yy, xy, zz [F/L^2].
   pure function recovered_stress_sample(self, element) result(stress)
      class(recovered_stress_t), intent(in) :: self !! the recovered stress field
      integer, intent(in) :: element !! the element
      real(dp) :: stress(4)

      stress = self%samples%stress(:, self%samples%start(element))
   end function recovered_stress_sample

end module amontons_stress_recovery
