!> Geometry of a side: shape functions and tangents at its quadrature points, straight or curved.
module amontons_side
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: n_side_points, new_side_geometry, side_abscissa, side_geometry_t, side_shapes, side_weight

   !> Number of Gauss points of a side.
   integer, parameter :: n_side_points = 3
   !> Where they are, from -1 to 1.
   real(dp), parameter :: side_abscissa(n_side_points) = [-sqrt(0.6_dp), 0.0_dp, sqrt(0.6_dp)]
   !> Their weights.
   real(dp), parameter :: side_weight(n_side_points) = [5.0_dp, 8.0_dp, 5.0_dp]/9.0_dp

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
      real(dp) :: ends(2), slope(3), nodes(2, 3)
      integer :: point

      nodes = 0.0_dp
      nodes(:, :2) = coordinates(:, side(:2))
      if (side(3) > 0) nodes(:, 3) = coordinates(:, side(3))
      ends = [-1.0_dp, 1.0_dp]
      if (present(range)) ends = range
      do point = 1, n_side_points
         call side_shapes(side(3) > 0, 0.5_dp*(sum(ends) + (ends(2) - ends(1))*side_abscissa(point)), &
            geometry%values(:, point), slope)
         geometry%position(:, point) = matmul(nodes, geometry%values(:, point))
         geometry%along(:, point) = 0.5_dp*(ends(2) - ends(1))*side_weight(point)*matmul(nodes, slope)
      end do
   end subroutine new_side_geometry

   !> Shape functions of a side and their derivatives: of first corner, second corner, middle.
   pure subroutine side_shapes(has_middle, xi, values, slopes)
      logical, intent(in) :: has_middle !! whether the side has a node in its middle
      real(dp), intent(in) :: xi !! the place on it, from -1 to 1 [-]
      real(dp), intent(out) :: values(3) !! shape functions [-]
      real(dp), intent(out) :: slopes(3) !! their derivatives by the place [-]

      if (has_middle) then
         values = [0.5_dp*xi*(xi - 1.0_dp), 0.5_dp*xi*(xi + 1.0_dp), 1.0_dp - xi**2]
         slopes = [xi - 0.5_dp, xi + 0.5_dp, -2.0_dp*xi]
      else
         values = [0.5_dp*(1.0_dp - xi), 0.5_dp*(1.0_dp + xi), 0.0_dp]
         slopes = [-0.5_dp, 0.5_dp, 0.0_dp]
      end if
   end subroutine side_shapes

end module amontons_side
