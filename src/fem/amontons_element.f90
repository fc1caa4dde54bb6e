!> Reference elements: shape functions, sides and quadrature of the linear triangle and the bilinear quadrilateral.
module amontons_element
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: element_names, max_nodes, n_element_nodes, n_element_points, quad4, quadrature_point, shape_functions, &
      side_nodes, tri3

   !> Kind of the three-node triangle.
   integer, parameter :: tri3 = 1
   !> Kind of the four-node quadrilateral.
   integer, parameter :: quad4 = 2

   !> Names of the kinds, as a deck writes them.
   character(5), parameter :: element_names(2) = [character(5) :: 'tri3', 'quad4']
   !> Number of nodes of each kind.
   integer, parameter :: n_element_nodes(2) = [3, 4]
   !> Number of quadrature points of each kind: full integration of the stiffness of a parallelogram.
   integer, parameter :: n_element_points(2) = [1, 4]
   !> Most nodes that an element has.
   integer, parameter :: max_nodes = 4

contains

   !> The two corner nodes (local numbers) of a side, in the direction that has the element on its left.
   pure function side_nodes(kind, side) result(nodes)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: side !! side, from 1: side i runs from corner i to corner i + 1
      integer :: nodes(2)

      nodes = [side, mod(side, n_element_nodes(kind)) + 1]
   end function side_nodes

   !> A quadrature point of a reference element.
   pure subroutine quadrature_point(kind, point, xi, weight)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: point !! number of the point, 1 to `n_element_points(kind)`
      real(dp), intent(out) :: xi(2) !! reference coordinates [-]
      real(dp), intent(out) :: weight !! weight; the weights sum to the area of the reference element [-]
      real(dp), parameter :: abscissa = 1.0_dp/sqrt(3.0_dp)
      real(dp), parameter :: corners(2, 4) = reshape( &
         [-1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp], [2, 4])

      if (kind == tri3) then
         xi = 1.0_dp/3.0_dp
         weight = 0.5_dp
      else
         xi = abscissa*corners(:, point)
         weight = 1.0_dp
      end if
   end subroutine quadrature_point

   !> Shape functions and their derivatives at a point of a reference element.
   pure subroutine shape_functions(kind, xi, values, derivatives)
      integer, intent(in) :: kind !! kind of element
      real(dp), intent(in) :: xi(2) !! reference coordinates: 0 to 1 (triangle), -1 to 1 (quadrilateral) [-]
      real(dp), intent(out) :: values(max_nodes) !! value of each node's function, 0 past the last node [-]
      real(dp), intent(out) :: derivatives(2, max_nodes) !! its derivatives by the reference coordinates [-]
      real(dp) :: r, s

      r = xi(1)
      s = xi(2)
      if (kind == tri3) then
         values = [1.0_dp - r - s, r, s, 0.0_dp]
         derivatives(1, :) = [-1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]
         derivatives(2, :) = [-1.0_dp, 0.0_dp, 1.0_dp, 0.0_dp]
      else
         values = 0.25_dp*[(1.0_dp - r)*(1.0_dp - s), (1.0_dp + r)*(1.0_dp - s), &
            (1.0_dp + r)*(1.0_dp + s), (1.0_dp - r)*(1.0_dp + s)]
         derivatives(1, :) = 0.25_dp*[-(1.0_dp - s), 1.0_dp - s, 1.0_dp + s, -(1.0_dp + s)]
         derivatives(2, :) = 0.25_dp*[-(1.0_dp - r), -(1.0_dp + r), 1.0_dp + r, 1.0_dp - r]
      end if
   end subroutine shape_functions

end module amontons_element
