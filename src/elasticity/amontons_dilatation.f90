!> Elements that keep their volume where a material hardly changes it: the dilatation is projected to a few polynomials
!> in each element, and functions inside the element, which its neighbors do not share, are condensed.
!>
!> A pressure linear in each element and displacements with a bubble in its middle satisfy the inf-sup condition in the
!> plane (M. Crouzeix and P.-A. Raviart, RAIRO 7, 1973), so that neither displacements nor pressures depend on how near
!> Poisson's ratio is to 0.5. Nothing here knows how many dimensions there are.
module amontons_dilatation
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_element, only: max_nodes
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: condense_inner, mode_values, new_modes, projection_t

   !> Most polynomials: 1, x, y.
   integer, parameter, public :: max_modes = 3

   !> The projected dilatation of an element, and its bubble, whose function comes after those of the nodes.
   type :: projection_t
      ! No defaults: setting them would take as long as all the rest, once for each element.
      real(dp) :: center(2) !! center of the element, where the linear ones are 0 before they are orthonormal [L]
      real(dp) :: factor(max_modes, max_modes) !! the polynomials, from `new_modes`
      real(dp) :: dilatation(2, max_nodes, max_modes)
         !! integral of polynomial times dilatation of a unit displacement (x and y, function, mode) [L^1/2]
      real(dp) :: share(max_nodes, max_modes) !! integral of polynomial times function (function, mode) [L^3/2]
      real(dp) :: bubble(2, 2*max_nodes) !! displacement of the bubble by those of the nodes (x and y, any) [-]
      real(dp) :: stiffness(2, 2) !! stiffness of the bubble [F/L]
      real(dp) :: compliance(2, 2) !! its inverse [L/F]
   end type projection_t

contains

   !> Makes the polynomials 1, x, y, ... orthonormal over an element: the Cholesky factor of their integrals.
   pure subroutine new_modes(center, factor, position, volume)
      real(dp), intent(out) :: center(:) !! center of the element, where the linear ones are 0 before that (axes) [L]
      real(dp), contiguous, intent(out) :: factor(:, :)
         !! the factor, in the lower triangle, of the integrals of products (modes, modes); one mode is the constant
      real(dp), intent(in) :: position(:, :) !! coordinates of the quadrature points (axes, points) [L]
      real(dp), intent(in) :: volume(:) !! their volumes (points) [L^3]
      real(dp) :: terms(size(center) + 1)
      integer :: info, j, point

      center = matmul(position, volume)/sum(volume)
      factor = 0.0_dp
      terms(1) = 1.0_dp
      do point = 1, size(volume)
         terms(2:) = position(:, point) - center
         do j = 1, size(factor, 2)
            factor(:, j) = factor(:, j) + volume(point)*terms(j)*terms(:size(factor, 1))
         end do
      end do
      ! The points of a checked element are no line, so the integrals are positive definite.
      call cholesky_factor(factor, info)
   end subroutine new_modes

   !> The orthonormal polynomials at a point (modes) [L^-3/2].
   pure function mode_values(center, factor, position) result(values)
      real(dp), intent(in) :: center(:) !! from `new_modes` (axes) [L]
      real(dp), intent(in) :: factor(:, :) !! from `new_modes` (modes, modes)
      real(dp), intent(in) :: position(:) !! the point (axes) [L]
      real(dp) :: values(size(factor, 1))
      integer :: i

      values = 1.0_dp
      values(2:) = position(:size(values) - 1) - center(:size(values) - 1)
      do i = 1, size(values)
         values(i) = (values(i) - dot_product(factor(i, :i - 1), values(:i - 1)))/factor(i, i)
      end do
   end function mode_values

   !> Condenses the unknowns inside an element.
   pure subroutine condense_inner(motion, compliance, stiffness)
      real(dp), contiguous, intent(out) :: motion(:, :) !! their displacements by those outside (inner, outer) [-]
      real(dp), contiguous, intent(out) :: compliance(:, :) !! inverse of their stiffness (inner, inner) [L/F]
      real(dp), intent(in) :: stiffness(:, :) !! their rows of the stiffness, outer unknowns first (inner, all) [F/L]
      real(dp) :: factor(size(compliance, 1), size(compliance, 1))
      integer :: i, info

      factor = stiffness(:, size(motion, 2) + 1:)
      compliance = 0.0_dp
      do i = 1, size(compliance, 1)
         compliance(i, i) = 1.0_dp
      end do
      ! Whatever moves inside alone is strained, so the stiffness is positive definite.
      call cholesky_factor(factor, info)
      call cholesky_solve(factor, compliance)
      motion = -matmul(compliance, stiffness(:, :size(motion, 2)))
   end subroutine condense_inner

end module amontons_dilatation
