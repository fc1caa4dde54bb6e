!> Reference elements: shape functions, sides and quadrature of linear and quadratic triangles and quadrilaterals; those
!> of solids are in `amontons_solid_element`.
!>
!> Nodes are numbered corners first, counter-clockwise, then the middles of the sides, then the center. A side of a
!> solid is one of its faces.
module amontons_element
   use amontons_kinds, only: dp
   use amontons_solid_element, only: edge_ends, face_nodes, hex20, hex8, max_face_nodes, solid_bubble, &
      solid_node, solid_quadrature, solid_shapes, tet10, tet4
   implicit none (type, external)
   private

   public :: bubble_function, corner_kind, element_names, has_bubble, hex20, hex8, is_solid, is_triangle, &
      jacobian_degree, line_ends, mapped_square, max_corners, max_face_nodes, max_nodes, max_points, n_corners, &
      n_element_nodes, n_element_points, n_fine_points, n_lines, n_plane_kinds, n_sampling_points, n_side_corners, &
      n_side_points, n_sides, node_coordinates, quad4, quad8, quad9, quadrature_point, shape_functions, side_abscissa, &
      side_nodes, side_shapes, side_weight, tet10, tet4, tri3, tri6

   !> Kind of the three-node triangle.
   integer, parameter :: tri3 = 1
   !> Kind of the four-node quadrilateral.
   integer, parameter :: quad4 = 2
   !> Kind of the six-node triangle.
   integer, parameter :: tri6 = 3
   !> Kind of the eight-node quadrilateral.
   integer, parameter :: quad8 = 4
   !> Kind of the nine-node quadrilateral.
   integer, parameter :: quad9 = 5

   !> Number of kinds of plane elements, which come before those of solids.
   integer, parameter :: n_plane_kinds = 5

   !> Names of the kinds, as a deck writes them.
   character(5), parameter :: element_names(*) = [character(5) :: 'tri3', 'quad4', 'tri6', 'quad8', 'quad9', 'tet4', &
      'tet10', 'hex8', 'hex20']
   !> Number of nodes of each kind.
   integer, parameter :: n_element_nodes(*) = [3, 4, 6, 8, 9, 4, 10, 8, 20]
   !> Number of corners of each kind.
   integer, parameter :: n_corners(*) = [3, 4, 3, 4, 4, 4, 4, 8, 8]
   !> Number of sides of each kind.
   integer, parameter :: n_sides(*) = [3, 4, 3, 4, 4, 4, 4, 6, 6]
   !> Number of lines between corners of each kind: of its sides in the plane, of its edges in space.
   integer, parameter :: n_lines(*) = [3, 4, 3, 4, 4, 6, 6, 12, 12]
   !> Number of corners of a side of each kind.
   integer, parameter :: n_side_corners(*) = [2, 2, 2, 2, 2, 3, 3, 4, 4]
   !> The kind of the same shape that has corners alone.
   integer, parameter :: corner_kind(*) = [tri3, quad4, tri3, quad4, quad4, tet4, tet4, hex8, hex8]
   !> Degree of the Jacobian of each kind in each coordinate of `mapped_square`; that of `tri6` is 2 only.
   integer, parameter :: jacobian_degree(*) = [0, 1, 3, 3, 3, 0, 3, 2, 5]
   !> Number of quadrature points where the stresses of each kind are most accurate: of the rule one order lower.
   integer, parameter :: n_sampling_points(*) = [1, 1, 3, 4, 4, 1, 4, 1, 8]
   !> Number of quadrature points that are exact for products of two stresses of one order higher than those of a kind.
   integer, parameter :: n_fine_points(*) = [3, 4, 6, 9, 9, 4, 15, 8, 27]
   !> Most corners that an element has.
   integer, parameter :: max_corners = 8
   !> Most shape functions that an element has, those of its nodes and of its bubble.
   integer, parameter :: max_nodes = 21
   !> Most quadrature points that an element has.
   integer, parameter :: max_points = 27

   !> Reference coordinates of the nodes of the nine-node quadrilateral, which begin with those of the others.
   real(dp), parameter :: quad_nodes(2, n_element_nodes(quad9)) = reshape([-1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, &
      1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, 0.0_dp, -1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, -1.0_dp, 0.0_dp, 0.0_dp, &
      0.0_dp], [2, n_element_nodes(quad9)])
   !> Reference coordinates of the nodes of the six-node triangle, which begin with those of the other.
   real(dp), parameter :: triangle_nodes(2, n_element_nodes(tri6)) = reshape([0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, &
      0.0_dp, 1.0_dp, 0.5_dp, 0.0_dp, 0.5_dp, 0.5_dp, 0.0_dp, 0.5_dp], [2, n_element_nodes(tri6)])

   !> Number of Gauss points of a side.
   integer, parameter :: n_side_points = 3
   !> Local coordinates of these points, from -1 to 1.
   real(dp), parameter :: side_abscissa(n_side_points) = [-sqrt(0.6_dp), 0.0_dp, sqrt(0.6_dp)]
   !> Weights of these points.
   real(dp), parameter :: side_weight(n_side_points) = [5.0_dp, 8.0_dp, 5.0_dp]/9.0_dp

contains

   !> Number of quadrature points of a kind: full integration, exact for the stiffness of a parallelogram or
   !> parallelepiped; in the plane also for area and patch test of a triangle with curved sides. In a body of revolution
   !> it is exact except for the square of the hoop strain, which is a rational function; with a single point a linear
   !> triangle would have a motion without energy.
   elemental integer function n_element_points(kind, is_raised) result(n_points)
      integer, intent(in) :: kind !! kind of element
      logical, intent(in) :: is_raised
         !! whether its terms are of higher degree: in a body of revolution, with a bubble, in a curved tetrahedron
      integer, parameter :: usual(*) = [1, 4, 3, 9, 9, 1, 4, 8, 27], raised(*) = [3, 4, 6, 9, 9, 1, 15, 8, 27]

      n_points = merge(raised(kind), usual(kind), is_raised)
   end function n_element_points

   !> Whether a kind of element is one of solids.
   elemental logical function is_solid(kind)
      integer, intent(in) :: kind !! kind of element

      is_solid = kind > n_plane_kinds
   end function is_solid

   !> Whether a kind of element is a triangle.
   elemental logical function is_triangle(kind)
      integer, intent(in) :: kind !! kind of element

      is_triangle = kind == tri3 .or. kind == tri6
   end function is_triangle

   !> Whether a kind of element has a bubble where its material is nearly incompressible: a quadratic one without a node
   !> inside.
   elemental logical function has_bubble(kind)
      integer, intent(in) :: kind !! kind of element

      has_bubble = kind == tri6 .or. kind == quad8 .or. kind == tet10 .or. kind == hex20
   end function has_bubble

   !> The function of the bubble: 0 on all sides, 1 in the middle.
   pure subroutine bubble_function(kind, xi, value, derivative)
      integer, intent(in) :: kind !! kind of element
      real(dp), intent(in) :: xi(:) !! reference coordinates [-]
      real(dp), intent(out) :: value !! the function [-]
      real(dp), intent(out) :: derivative(:) !! its derivatives by the reference coordinates [-]

      if (is_solid(kind)) then
         call solid_bubble(kind, xi, value, derivative)
      else if (is_triangle(kind)) then
         associate (last => 1.0_dp - xi(1) - xi(2))
            value = 27.0_dp*xi(1)*xi(2)*last
            derivative = 27.0_dp*xi([2, 1])*(last - xi)
         end associate
      else
         value = product(1.0_dp - xi**2)
         derivative = -2.0_dp*xi*(1.0_dp - xi([2, 1])**2)
      end if
   end subroutine bubble_function

   !> Reference coordinates of a node, 2 or 3 [-].
   pure function node_coordinates(kind, node) result(xi)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: node !! number of the node
      real(dp) :: xi(merge(3, 2, is_solid(kind)))

      if (is_solid(kind)) then
         xi = solid_node(kind, node)
      else if (is_triangle(kind)) then
         xi = triangle_nodes(:, node)
      else
         xi = quad_nodes(:, node)
      end if
   end function node_coordinates

   !> Reference coordinates of a point of the unit square or cube, which covers the reference element; in a triangle the
   !> side 0, 1 of the square becomes one side, and its opposite side a corner [-].
   pure function mapped_square(kind, place) result(xi)
      integer, intent(in) :: kind !! kind of element
      real(dp), intent(in) :: place(:) !! the point, from 0 to 1 [-]
      real(dp) :: xi(size(place))
      integer :: i

      xi = 2.0_dp*place - 1.0_dp
      if (.not. any(corner_kind(kind) == [tri3, tet4])) return
      do i = 1, size(place)
         xi(i) = place(i)*product(1.0_dp - place(:i - 1))
      end do
   end function mapped_square

   !> The nodes (local numbers) of a side. In the plane: its corners, in the direction that has the element on its left,
   !> and its middle, 0 for a linear element; of a face of a solid: its corners, counter-clockwise as seen from outside,
   !> then the middles of its edges, then 0 (3 or 8).
   pure function side_nodes(kind, side) result(nodes)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: side !! side, from 1: side i of a plane element runs from corner i to corner i + 1
      integer :: nodes(merge(max_face_nodes, 3, is_solid(kind)))

      if (is_solid(kind)) then
         nodes = face_nodes(kind, side)
         return
      end if
      nodes = [side, mod(side, n_corners(kind)) + 1, 0]
      if (n_element_nodes(kind) > n_corners(kind)) nodes(3) = n_corners(kind) + side
   end function side_nodes

   !> The corners (local numbers) at the ends of a line between corners: a side in the plane, an edge in space. The node
   !> in its middle has the line's number plus `n_corners`.
   pure function line_ends(kind, line) result(ends)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: line !! number of the line
      integer :: ends(2)

      if (is_solid(kind)) then
         ends = edge_ends(kind, line)
      else
         ends = [line, mod(line, n_corners(kind)) + 1]
      end if
   end function line_ends

   !> Reference coordinates and weight of a quadrature point.
   pure subroutine quadrature_point(kind, n_points, point, xi, weight)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: n_points !! number of points, by `n_element_points` or `n_sampling_points`
      integer, intent(in) :: point !! number of the point, 1 to `n_points`
      real(dp), intent(out) :: xi(:) !! reference coordinates [-]
      real(dp), intent(out) :: weight !! weight; the weights sum to the area or volume of the reference element [-]
      real(dp), parameter :: two_points = 1.0_dp/sqrt(3.0_dp)
      ! In a triangle 1, 3 or 6 points, exact to degree 1, 2 or 4. Two of the barycentric coordinates of each triple of
      ! points are alike. The rule of degree 4 is Cowper's (Int. J. Num. Meth. Eng. 7, 1973) in closed form.
      real(dp), parameter :: root = sqrt(38.0_dp - 44.0_dp*sqrt(0.4_dp))
      real(dp), parameter :: six_points(2) = (8.0_dp - sqrt(10.0_dp) + [root, -root])/18.0_dp
      real(dp), parameter :: difference = sqrt(213125.0_dp - 53320.0_dp*sqrt(10.0_dp))
      real(dp), parameter :: six_weights(2) = (620.0_dp + [difference, -difference])/7440.0_dp
      integer :: row, column, other

      if (is_solid(kind)) then
         call solid_quadrature(kind, n_points, point, xi, weight)
      else if (is_triangle(kind) .and. n_points == 1) then
         xi = 1.0_dp/3.0_dp
         weight = 0.5_dp
      else if (is_triangle(kind)) then
         xi = 1.0_dp/6.0_dp
         weight = 1.0_dp/6.0_dp
         if (n_points > 3) xi = six_points((point + 2)/3)
         if (n_points > 3) weight = six_weights((point + 2)/3)
         other = mod(point - 1, 3)
         if (other > 0) xi(other) = 1.0_dp - 2.0_dp*xi(other)
      else if (n_points == 1) then
         xi = 0.0_dp
         weight = 4.0_dp
      else if (n_points == 4) then
         xi = two_points*quad_nodes(:, point)
         weight = 1.0_dp
      else
         column = mod(point - 1, 3) + 1
         row = (point - 1)/3 + 1
         xi = side_abscissa([column, row])
         weight = side_weight(column)*side_weight(row)
      end if
   end subroutine quadrature_point

   !> Shape functions and their derivatives at a point of a reference element.
   pure subroutine shape_functions(kind, xi, values, derivatives)
      integer, intent(in) :: kind !! kind of element
      real(dp), contiguous, intent(in) :: xi(:)
         !! reference coordinates: 0 to 1 in triangles and tetrahedra, else -1 to 1 [-]
      real(dp), intent(out) :: values(max_nodes) !! value of each node's function, 0 past the last node [-]
      real(dp), intent(out) :: derivatives(size(xi), max_nodes) !! its derivatives by the reference coordinates [-]

      values = 0.0_dp
      derivatives = 0.0_dp
      if (is_solid(kind)) then
         call solid_shapes(kind, xi, values, derivatives)
      else
         call plane_shapes(kind, xi, values, derivatives)
      end if
   end subroutine shape_functions

   !> Those of the kinds of plane elements.
   pure subroutine plane_shapes(kind, xi, values, derivatives)
      integer, intent(in) :: kind !! kind of element
      real(dp), intent(in) :: xi(2) !! reference coordinates [-]
      real(dp), intent(inout) :: values(max_nodes) !! value of each node's function [-]
      real(dp), intent(inout) :: derivatives(2, max_nodes) !! its derivatives by the reference coordinates [-]
      real(dp), parameter :: gradients(2, 3) = reshape([-1.0_dp, -1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 3])
      real(dp) :: barycentric(3), bubble, linear, lagrange(2), slope(2)
      integer :: i, j, along, across, before

      barycentric = [1.0_dp - xi(1) - xi(2), xi(1), xi(2)]
      select case (kind)
      case (tri3)
         values(:3) = barycentric
         derivatives(:, :3) = gradients
      case (tri6)
         ! l_i (2 l_i - 1) at the corners, 4 l_i l_j on the sides, l the barycentric coordinates.
         associate (l => barycentric)
            do i = 1, 3
               j = mod(i, 3) + 1
               values(i) = l(i)*(2.0_dp*l(i) - 1.0_dp)
               derivatives(:, i) = (4.0_dp*l(i) - 1.0_dp)*gradients(:, i)
               values(3 + i) = 4.0_dp*l(i)*l(j)
               derivatives(:, 3 + i) = 4.0_dp*(l(i)*gradients(:, j) + l(j)*gradients(:, i))
            end do
         end associate
      case (quad4, quad8)
         ! (1 + r_i r)(1 + s_i s)/4 at the corners.
         do i = 1, 4
            lagrange = 1.0_dp + quad_nodes(:, i)*xi
            values(i) = 0.25_dp*lagrange(1)*lagrange(2)
            derivatives(:, i) = 0.25_dp*quad_nodes(:, i)*lagrange([2, 1])
         end do
         if (kind == quad4) return
         ! The middles of the sides have their own, the corners what these leave them.
         do i = 5, 8
            along = merge(1, 2, mod(i, 2) == 1)
            across = 3 - along
            bubble = 1.0_dp - xi(along)**2
            linear = 1.0_dp + quad_nodes(across, i)*xi(across)
            values(i) = 0.5_dp*bubble*linear
            derivatives(along, i) = -xi(along)*linear
            derivatives(across, i) = 0.5_dp*bubble*quad_nodes(across, i)
         end do
         do i = 1, 4
            before = 5 + mod(i + 2, 4)
            values(i) = values(i) - 0.5_dp*(values(4 + i) + values(before))
            derivatives(:, i) = derivatives(:, i) - 0.5_dp*(derivatives(:, 4 + i) + derivatives(:, before))
         end do
      case (quad9)
         ! Products of quadratic Lagrange polynomials.
         do i = 1, 9
            where (abs(quad_nodes(:, i)) > 0.0_dp)
               lagrange = 0.5_dp*xi*(xi + quad_nodes(:, i))
               slope = xi + 0.5_dp*quad_nodes(:, i)
            else where
               lagrange = 1.0_dp - xi**2
               slope = -2.0_dp*xi
            end where
            values(i) = product(lagrange)
            derivatives(:, i) = slope*lagrange([2, 1])
         end do
      case default
         ! All zero: an element without an area, which no mesh may have.
      end select
   end subroutine plane_shapes

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

end module amontons_element
