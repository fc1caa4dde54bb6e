!> Geometry of a side: shape functions and tangents at its quadrature points, straight or curved.
module amontons_side
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: new_side_geometry, side_geometry_t

   !> A side at three Gauss points, exact for products of quadratic functions.
   type :: side_geometry_t
      real(dp) :: values(3, 3) = 0.0_dp !! shape functions of first corner, second corner, middle (node, point) [-]
      real(dp) :: position(2, 3) = 0.0_dp !! coordinates of the points [L]
      real(dp) :: along(2, 3) = 0.0_dp !! tangent times quadrature weight: they sum to the chord (x and y, point) [L]
   end type side_geometry_t

contains

   !> Evaluates a side, or a part of it.
   pure subroutine new_side_geometry(geometry, side, coordinates, range)
      type(side_geometry_t), intent(out) :: geometry !! the side at its quadrature points
      integer, intent(in) :: side(3) !! first corner, second corner, middle node or 0
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: range(2) !! where the part begins and ends; the whole side is -1, 1 [-]
      real(dp), parameter :: abscissa(3) = [-sqrt(0.6_dp), 0.0_dp, sqrt(0.6_dp)]
      real(dp), parameter :: weight(3) = [5.0_dp, 8.0_dp, 5.0_dp]/9.0_dp
      real(dp) :: r, ends(2), slope(3), nodes(2, 3)
      integer :: point

      nodes = 0.0_dp
      nodes(:, :2) = coordinates(:, side(:2))
      if (side(3) > 0) nodes(:, 3) = coordinates(:, side(3))
      ends = [-1.0_dp, 1.0_dp]
      if (present(range)) ends = range
      do point = 1, 3
         r = 0.5_dp*(sum(ends) + (ends(2) - ends(1))*abscissa(point))
         if (side(3) > 0) then
            geometry%values(:, point) = [0.5_dp*r*(r - 1.0_dp), 0.5_dp*r*(r + 1.0_dp), 1.0_dp - r**2]
            slope = [r - 0.5_dp, r + 0.5_dp, -2.0_dp*r]
         else
            geometry%values(:, point) = [0.5_dp*(1.0_dp - r), 0.5_dp*(1.0_dp + r), 0.0_dp]
            slope = [-0.5_dp, 0.5_dp, 0.0_dp]
         end if
         geometry%position(:, point) = matmul(nodes, geometry%values(:, point))
         geometry%along(:, point) = 0.5_dp*(ends(2) - ends(1))*weight(point)*matmul(nodes, slope)
      end do
   end subroutine new_side_geometry

end module amontons_side
