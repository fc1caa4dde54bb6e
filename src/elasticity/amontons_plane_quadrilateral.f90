!> The four-node quadrilateral of a plane body, its four quadrature points side by side: what `amontons_elasticity` says
!> of every element, in a quarter of the time. Fine meshes have hundreds of thousands of them.
module amontons_plane_quadrilateral
   use amontons_element, only: quad4
   use amontons_kinds, only: dp
   use amontons_material, only: material_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: is_plain_quadrilateral, plane_quadrilateral_t

   ! What the points, in the order of the corners, have of values at the first side and at the last one.
   real(dp), parameter :: near = 0.5_dp + 0.5_dp/sqrt(3.0_dp), far = 1.0_dp - near
   real(dp), parameter :: first(4) = [near, near, far, far], last(4) = [near, far, far, near]
   !> Shape functions (point, corner) [-].
   real(dp), parameter, public :: quadrilateral_shapes(4, 4) = reshape([last*first, (1.0_dp - last)*first, &
      (1.0_dp - last)*(1.0_dp - first), last*(1.0_dp - first)], [4, 4])

   !> The quadrilateral.
   type :: plane_quadrilateral_t
      integer :: node(4) = 0 !! numbers of its corners in the mesh
      real(dp) :: corner(4, 2) = 0.0_dp !! their coordinates (corner, x and y) [L]
      real(dp) :: area(4) = 0.0_dp !! area of the part of the element that each point stands for [L^2]
      real(dp) :: strain(4, 3) = 0.0_dp !! strain at the points, from `deform`: xx, yy, engineering shear 2 xy [-]
      real(dp) :: stress(4, 4) = 0.0_dp !! stress there: xx, yy, xy, zz (point, component) [F/L^2]
      real(dp), private :: by_xi(4, 2) = 0.0_dp !! derivatives of x and y by the first reference coordinate [L]
      real(dp), private :: by_eta(4, 2) = 0.0_dp !! by the second one [L]
   contains
      procedure :: deform => plane_quadrilateral_deform
      procedure :: energy_density => plane_quadrilateral_energy_density
      procedure :: forces => plane_quadrilateral_forces
      procedure :: place => plane_quadrilateral_place
   end type plane_quadrilateral_t

contains

   !> Whether an element is such a one: of the standard formulation.
   pure logical function is_plain_quadrilateral(kind, material)
      integer, intent(in) :: kind !! kind of element
      type(material_t), intent(in) :: material !! its material

      is_plain_quadrilateral = kind == quad4 .and. .not. (material%is_axisymmetric .or. material%has_mean_dilatation)
   end function is_plain_quadrilateral

   !> Takes the place of an element.
   pure subroutine plane_quadrilateral_place(self, mesh, element)
      class(plane_quadrilateral_t), intent(inout) :: self !! the quadrilateral; its strains are those of before
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      integer :: i

      self%node = mesh%node(mesh%node_start(element):mesh%node_start(element) + 3)
      do i = 1, 4
         self%corner(i, :) = mesh%coordinates(:, self%node(i))
      end do
      call differentiate(self%corner, self%by_xi, self%by_eta)
      self%area = self%by_xi(:, 1)*self%by_eta(:, 2) - self%by_eta(:, 1)*self%by_xi(:, 2)
   end subroutine plane_quadrilateral_place

   !> Finds strains and stresses of a displacement field.
   pure subroutine plane_quadrilateral_deform(self, material, displacement)
      class(plane_quadrilateral_t), intent(inout) :: self !! the quadrilateral; gains strains and stresses
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp), dimension(4, 2) :: u, by_xi, by_eta
      real(dp) :: mean(4)
      integer :: i

      do i = 1, 4
         u(i, :) = displacement(:, self%node(i))
      end do
      call differentiate(u, by_xi, by_eta)
      associate (x_xi => self%by_xi(:, 1), y_xi => self%by_xi(:, 2), x_eta => self%by_eta(:, 1), &
         y_eta => self%by_eta(:, 2), strain => self%strain)
         strain(:, 1) = (by_xi(:, 1)*y_eta - by_eta(:, 1)*y_xi)/self%area
         strain(:, 2) = (by_eta(:, 2)*x_xi - by_xi(:, 2)*x_eta)/self%area
         strain(:, 3) = (by_eta(:, 1)*x_xi - by_xi(:, 1)*x_eta + by_xi(:, 2)*y_eta - by_eta(:, 2)*y_xi)/self%area
         mean = material%lambda*(strain(:, 1) + strain(:, 2))
         self%stress(:, 1) = mean + 2.0_dp*material%mu*strain(:, 1)
         self%stress(:, 2) = mean + 2.0_dp*material%mu*strain(:, 2)
         self%stress(:, 3) = material%mu*strain(:, 3)
         self%stress(:, 4) = merge(0.0_dp, mean, material%is_plane_stress)
      end associate
   end subroutine plane_quadrilateral_deform

   !> Strain energy densities at the points [F/L^2].
   pure function plane_quadrilateral_energy_density(self) result(density)
      class(plane_quadrilateral_t), intent(in) :: self !! the quadrilateral, deformed
      real(dp) :: density(4)

      associate (strain => self%strain, stress => self%stress)
         density = 0.5_dp*(strain(:, 1)*stress(:, 1) + strain(:, 2)*stress(:, 2) + strain(:, 3)*stress(:, 3))
      end associate
   end function plane_quadrilateral_energy_density

   !> Nodal forces that its stresses amount to: what each derivative of the displacements has to do with the work of the
   !> stresses, handed back to the corners whose differences make it (x and y, corner) [F].
   pure function plane_quadrilateral_forces(self, thickness) result(forces)
      class(plane_quadrilateral_t), intent(in) :: self !! the quadrilateral, deformed
      real(dp), intent(in) :: thickness !! its thickness [L]
      real(dp) :: forces(2, 4)
      ! What derivatives along the first and the third side, and along the last and the second one have to do.
      real(dp), dimension(4, 2) :: along, across
      real(dp) :: side(4), half
      integer :: i

      associate (x_xi => self%by_xi(:, 1), y_xi => self%by_xi(:, 2), x_eta => self%by_eta(:, 1), &
         y_eta => self%by_eta(:, 2), stress => self%stress)
         along(:, 1) = stress(:, 1)*y_eta - stress(:, 3)*x_eta
         along(:, 2) = stress(:, 3)*y_eta - stress(:, 2)*x_eta
         across(:, 1) = stress(:, 3)*x_xi - stress(:, 1)*y_xi
         across(:, 2) = stress(:, 2)*x_xi - stress(:, 3)*y_xi
      end associate
      half = 0.5_dp*thickness
      do i = 1, 2
         ! The weights `first` and `last`, summed where they are alike.
         side(1:2) = half*([near, far]*(along(1, i) + along(2, i)) + [far, near]*(along(3, i) + along(4, i)))
         side(3:4) = half*([near, far]*(across(1, i) + across(4, i)) + [far, near]*(across(2, i) + across(3, i)))
         forces(i, :) = [-side(1) - side(3), side(1) - side(4), side(2) + side(4), side(3) - side(2)]
      end do
   end function plane_quadrilateral_forces

   !> Derivatives by the reference coordinates at the points, from what changes along the sides.
   pure subroutine differentiate(values, by_xi, by_eta)
      real(dp), intent(in) :: values(4, 2) !! values at the corners
      real(dp), intent(out) :: by_xi(4, 2) !! derivatives by the first coordinate (point, value)
      real(dp), intent(out) :: by_eta(4, 2) !! by the second one
      integer :: k

      do k = 1, 2
         associate (v => values(:, k))
            by_xi(:, k) = 0.5_dp*(first*(v(2) - v(1)) + (1.0_dp - first)*(v(3) - v(4)))
            by_eta(:, k) = 0.5_dp*(last*(v(4) - v(1)) + (1.0_dp - last)*(v(3) - v(2)))
         end associate
      end do
   end subroutine differentiate

end module amontons_plane_quadrilateral
