!> Superconvergent patch recovery: a stress field one order more accurate than that of the displacements (Zienkiewicz
!> and Zhu, Int. J. Num. Meth. Eng. 33, 1992).
!>
!> The elements of one material around a corner node are its patch. A polynomial of the order of the displacements is
!> fitted to the stresses at the points of the patch where they are most accurate, and to the tractions that are known
!> at its sides on the boundary. In an element the recovered stress is the mean of the polynomials of its corners,
!> weighted by the linear shape functions of the corners (Blacker and Belytschko, Int. J. Num. Meth. Eng. 37, 1994).
module amontons_stress_recovery
   use amontons_bins, only: fill_bins
   use amontons_coloring, only: worth_threads
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry, set_thermal_strain
   use amontons_element, only: n_sampling_points, quad4
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_traction_t
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t
   use amontons_patch_frame, only: max_terms
   use amontons_patch_table, only: patch_table_t
   use amontons_stress_patch, only: fit_polynomial
   implicit none (type, external)
   private

   public :: new_recovered_stress, recovered_stress_t

   !> What a stress field is recovered from.
   type :: recovered_stress_t
      private
      real(dp), allocatable :: sample(:, :) !! the stresses that are fitted: xx, yy, xy, zz (4, n_samples) [F/L^2]
      integer, allocatable :: side_start(:) !! where the sides of a patch begin in `tractions` (patches + 1)
      type(known_traction_t), allocatable :: tractions(:) !! what is known of the tractions, patch by patch
   contains
      procedure, public :: at_sample => recovered_stress_at_sample
      procedure, public :: fit => recovered_stress_fit
   end type recovered_stress_t

contains

   !> Prepares the recovery of the stresses of a displacement field.
   subroutine new_recovered_stress(recovered, patches, mesh, materials, tractions, displacement, thermal_strain)
      type(recovered_stress_t), intent(out) :: recovered !! the recovered stress field
      type(patch_table_t), intent(in) :: patches !! the patches of the mesh
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(known_traction_t), intent(in) :: tractions(:) !! what is known of the tractions on the sides of the boundary
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      integer, allocatable :: side(:)

      call sample_stresses(recovered%sample, patches, mesh, materials, displacement, thermal_strain)
      call sort_sides(recovered%side_start, side, patches, mesh, tractions)
      recovered%tractions = tractions(side)
   end subroutine new_recovered_stress

   !> Fits the polynomials of all patches of a block.
   pure subroutine recovered_stress_fit(self, coefficient, patches, mesh, block)
      class(recovered_stress_t), intent(in) :: self !! the recovered stress field
      real(dp), allocatable, intent(out) :: coefficient(:, :, :)
         !! coefficients of the polynomials, from `fit_polynomial` (component, term, patch of the block)
      type(patch_table_t), intent(in) :: patches !! its patches
      type(mesh_t), intent(in) :: mesh !! its mesh
      integer, intent(in) :: block !! number of the block
      real(dp) :: of_patch(4, max_terms)
      integer :: i

      associate (listed => patches%listed(patches%block_start(block):patches%block_start(block + 1) - 1))
         allocate (coefficient(4, max(3, maxval(patches%frame(listed)%n_terms)), size(listed)))
         do i = 1, size(listed)
            associate (patch => listed(i))
               call fit_polynomial(of_patch, patches, patch, mesh, self%sample, &
                  self%tractions(self%side_start(patch):self%side_start(patch + 1) - 1))
               coefficient(:, :, i) = of_patch(:, :size(coefficient, 2))
            end associate
         end do
      end associate
   end subroutine recovered_stress_fit

   !> Evaluates the stresses where those of an element are most accurate.
   subroutine sample_stresses(stress, patches, mesh, materials, displacement, thermal_strain)
      real(dp), allocatable, intent(out) :: stress(:, :) !! the stresses xx, yy, xy, zz (4, n_samples) [F/L^2]
      type(patch_table_t), intent(in) :: patches !! the patches, with the samples
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:) !! as in `new_recovered_stress` [-]
      type(element_geometry_t) :: geometry
      integer :: i, point

      allocate (stress(4, size(patches%samples%position, 2)))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) private(point) shared(stress, patches, mesh, materials, displacement, thermal_strain)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)), first => patches%samples%start(i) - 1)
            if (mesh%element_kind(i) == quad4 .and. .not. (material%is_axisymmetric .or. material%has_mean_dilatation &
               .or. present(thermal_strain))) then
               stress(:, first + 1) = middle_stress(mesh, i, material, displacement)
               cycle
            end if
            call new_element_geometry(geometry, mesh, i, material, n_sampling_points(mesh%element_kind(i)))
            if (present(thermal_strain)) call set_thermal_strain(geometry, &
               thermal_strain(mesh%node_start(i):mesh%node_start(i + 1) - 1))
            do point = 1, geometry%n_points
               stress(:, first + point) = element_stress(geometry, material, displacement, point)
            end do
         end associate
      end do
      !$omp end parallel do
   end subroutine sample_stresses

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

   !> Sorts the sides of known tractions by the patches of the corners that they begin and end at.
   pure subroutine sort_sides(start, side, patches, mesh, tractions)
      integer, allocatable, intent(out) :: start(:) !! where the sides of a patch begin in `side` (patches + 1)
      integer, allocatable, intent(out) :: side(:) !! the sides
      type(patch_table_t), intent(in) :: patches !! the patches
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(known_traction_t), intent(in) :: tractions(:) !! the sides of known tractions
      integer :: patch(2, size(tractions)), i, k, first

      do i = 1, size(tractions)
         first = mesh%node_start(tractions(i)%element)
         do k = 1, 2
            patch(k, i) = patches%at_corner(tractions(i)%element, first - 1 &
               + findloc(mesh%node(first:mesh%node_start(tractions(i)%element + 1) - 1), tractions(i)%corner(k), dim=1))
         end do
      end do
      call fill_bins(start, side, reshape(patch, [size(patch)]), size(patches%node))
      side = (side + 1)/2
   end subroutine sort_sides

   !> The stress of an element where it is most accurate, at the first point of them: that of all of it, where it is
   !> uniform. xx, yy, xy, zz [F/L^2].
   pure function recovered_stress_at_sample(self, patches, element) result(stress)
      class(recovered_stress_t), intent(in) :: self !! the recovered stress field
      type(patch_table_t), intent(in) :: patches !! its patches
      integer, intent(in) :: element !! the element
      real(dp) :: stress(4)

      stress = self%sample(:, patches%samples%start(element))
   end function recovered_stress_at_sample

end module amontons_stress_recovery
