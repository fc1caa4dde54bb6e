!> Elements that keep their volume where a material hardly changes it: the dilatation is projected to a few polynomials
!> in each element, and functions inside the element, which its neighbors do not share, are condensed.
!>
!> A pressure linear in each element and displacements with a bubble in its middle satisfy the inf-sup condition in the
!> plane (M. Crouzeix and P.-A. Raviart, RAIRO 7, 1973), so that neither displacements nor pressures depend on how near
!> Poisson's ratio is to 0.5. Nothing here knows how many dimensions there are.
module amontons_dilatation
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: condense_inner, mode_values, new_modes, new_projection, projection_t

   !> The projected dilatation of an element, and its bubble, whose function comes after those of the nodes.
   type :: projection_t
      real(dp), allocatable :: center(:)
         !! center of the element, where the linear ones are 0 before they are orthonormal (n_dim) [L]
      real(dp), allocatable :: factor(:, :) !! the polynomials, from `new_modes` (modes, modes)
      real(dp), allocatable :: dilatation(:, :, :)
         !! integral of polynomial times dilatation of a unit displacement (n_dim, function, mode) [L^1/2]
      real(dp), allocatable :: share(:, :) !! integral of polynomial times function (function, mode) [L^3/2]
      real(dp), allocatable :: bubble(:, :)
         !! displacement of the bubble by those of the nodes, all components of one after the other (n_dim, any) [-]
      real(dp), allocatable :: stiffness(:, :) !! stiffness of the bubble (n_dim, n_dim) [F/L]
      real(dp), allocatable :: compliance(:, :) !! its inverse (n_dim, n_dim) [L/F]
   end type projection_t

contains

   !> Makes room for a projection, unless there is room for it already.
   pure subroutine new_projection(projection, n_dim, n_functions, n_modes)
      type(projection_t), intent(inout) :: projection !! the projection, its numbers anything
      integer, intent(in) :: n_dim !! number of dimensions
      integer, intent(in) :: n_functions !! number of functions of the element
      integer, intent(in) :: n_modes !! number of polynomials

      if (allocated(projection%dilatation)) then
         if (all(shape(projection%dilatation) == [n_dim, n_functions, n_modes])) return
         deallocate (projection%center, projection%factor, projection%dilatation, projection%share, projection%bubble, &
            projection%stiffness, projection%compliance)
      end if
      allocate (projection%center(n_dim), projection%factor(n_modes, n_modes), &
         projection%dilatation(n_dim, n_functions, n_modes), projection%share(n_functions, n_modes), &
         projection%bubble(n_dim, n_dim*(n_functions - 1)), projection%stiffness(n_dim, n_dim), &
         projection%compliance(n_dim, n_dim))
   end subroutine new_projection

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
