!> Reference elements of solids: shape functions, faces and quadrature of linear and quadratic tetrahedra and hexahedra.
!>
!> Nodes are numbered corners first, then the middles of the edges, as VTK and Abaqus number them.
module amontons_solid_element
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: edge_ends, face_nodes, hex20, hex8, solid_bubble, solid_node, solid_quadrature, solid_shapes, tet10, tet4

   !> Kind of the four-node tetrahedron.
   integer, parameter :: tet4 = 6
   !> Kind of the ten-node tetrahedron.
   integer, parameter :: tet10 = 7
   !> Kind of the eight-node hexahedron.
   integer, parameter :: hex8 = 8
   !> Kind of the twenty-node hexahedron.
   integer, parameter :: hex20 = 9

   !> Most nodes that a face has.
   integer, parameter, public :: max_face_nodes = 8

   !> Corners at the ends of the edges of a tetrahedron, in the order of their middles.
   integer, parameter :: tet_edges(*, *) = reshape([1, 2, 2, 3, 3, 1, 1, 4, 2, 4, 3, 4], [2, 6])
   !> Corners at the ends of the edges of a hexahedron, in the order of their middles.
   integer, parameter :: hex_edges(*, *) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 5, 6, 6, 7, 7, 8, 8, 5, 1, 5, 2, 6, 3, 7, &
      4, 8], [2, 12])
   !> Corners of the faces of a tetrahedron, then the middles of their edges; the normal by the right-hand rule points
   !> outward.
   integer, parameter :: tet_faces(*, *) = reshape([1, 3, 2, 7, 6, 5, 1, 2, 4, 5, 9, 8, 2, 3, 4, 6, 10, 9, &
      1, 4, 3, 8, 10, 7], [6, 4])
   !> The same of a hexahedron.
   integer, parameter :: hex_faces(*, *) = reshape([1, 4, 3, 2, 12, 11, 10, 9, 5, 6, 7, 8, 13, 14, 15, 16, &
      1, 2, 6, 5, 9, 18, 13, 17, 2, 3, 7, 6, 10, 19, 14, 18, 3, 4, 8, 7, 11, 20, 15, 19, 4, 1, 5, 8, 12, 17, 16, 20], &
      [8, 6])
   !> Reference coordinates of the corners of the hexahedron.
   real(dp), parameter :: hex_corners(*, *) = reshape([-1.0_dp, -1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, -1.0_dp, &
      1.0_dp, 1.0_dp, -1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, -1.0_dp, -1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, &
      1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, 1.0_dp], [3, 8])
   !> Those of the corners of the tetrahedron.
   real(dp), parameter :: tet_corners(*, *) = reshape([0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, &
      0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [3, 4])

contains

   !> The nodes (local numbers) of a face: its corners, then the middles of its edges, then 0.
   pure function face_nodes(kind, face) result(nodes)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: face !! number of the face, as Abaqus counts
      integer :: nodes(max_face_nodes)

      nodes = 0
      select case (kind)
      case (tet4)
         nodes(:3) = tet_faces(:3, face)
      case (tet10)
         nodes(:6) = tet_faces(:, face)
      case (hex8)
         nodes(:4) = hex_faces(:4, face)
      case default
         nodes = hex_faces(:, face)
      end select
   end function face_nodes

   !> The corners (local numbers) at the ends of an edge of a tetrahedron or hexahedron.
   pure function edge_ends(kind, edge) result(ends)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: edge !! number of the edge, in the order of the nodes in their middles
      integer :: ends(2)

      if (kind <= tet10) then
         ends = tet_edges(:, edge)
      else
         ends = hex_edges(:, edge)
      end if
   end function edge_ends

   !> Reference coordinates of a node [-].
   pure function solid_node(kind, node) result(xi)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: node !! number of the node
      real(dp) :: xi(3)

      if (kind <= tet10) then
         if (node <= 4) xi = tet_corners(:, node)
         if (node > 4) xi = 0.5_dp*sum(tet_corners(:, tet_edges(:, node - 4)), dim=2)
      else
         if (node <= 8) xi = hex_corners(:, node)
         if (node > 8) xi = 0.5_dp*sum(hex_corners(:, hex_edges(:, node - 8)), dim=2)
      end if
   end function solid_node

   !> The function of the bubble: 0 on all faces, 1 in the middle.
   pure subroutine solid_bubble(kind, xi, value, derivative)
      integer, intent(in) :: kind !! kind of element
      real(dp), intent(in) :: xi(3) !! reference coordinates [-]
      real(dp), intent(out) :: value !! the function [-]
      real(dp), intent(out) :: derivative(3) !! its derivatives by the reference coordinates [-]

      associate (next => cshift(xi, 1), last => cshift(xi, 2), first => 1.0_dp - sum(xi))
         if (kind == tet10) then
            value = 256.0_dp*product(xi)*first
            derivative = 256.0_dp*next*last*(first - xi)
         else
            value = product(1.0_dp - xi**2)
            derivative = -2.0_dp*xi*(1.0_dp - next**2)*(1.0_dp - last**2)
         end if
      end associate
   end subroutine solid_bubble

   !> Shape functions and their derivatives at a point of a reference element.
   pure subroutine solid_shapes(kind, xi, values, derivatives)
      integer, intent(in) :: kind !! kind of element
      real(dp), intent(in) :: xi(3) !! reference coordinates: 0 to 1 (tetrahedron), -1 to 1 (hexahedron) [-]
      real(dp), intent(inout) :: values(:) !! value of each node's function; unchanged past the last node [-]
      real(dp), intent(inout) :: derivatives(:, :) !! its derivatives by the reference coordinates [-]
      real(dp), parameter :: gradients(3, 4) = reshape([-1.0_dp, -1.0_dp, -1.0_dp, tet_corners(:, 2:)], [3, 4])
      real(dp) :: l(4), factor(3), slope(3)
      integer :: i

      if (kind <= tet10) then
         l = [1.0_dp - sum(xi), xi]
         values(:4) = l
         derivatives(:, :4) = gradients
         if (kind == tet4) return
         ! l_i (2 l_i - 1) at the corners, 4 l_i l_j on the edges, l the barycentric coordinates.
         do i = 1, 4
            values(i) = l(i)*(2.0_dp*l(i) - 1.0_dp)
            derivatives(:, i) = (4.0_dp*l(i) - 1.0_dp)*gradients(:, i)
         end do
         do i = 1, 6
            associate (a => tet_edges(1, i), b => tet_edges(2, i))
               values(4 + i) = 4.0_dp*l(a)*l(b)
               derivatives(:, 4 + i) = 4.0_dp*(l(a)*gradients(:, b) + l(b)*gradients(:, a))
            end associate
         end do
         return
      end if
      ! (1 + r_i r)(1 + s_i s)(1 + t_i t)/8 at the corners.
      do i = 1, 8
         factor = 0.5_dp*(1.0_dp + hex_corners(:, i)*xi)
         values(i) = product(factor)
         derivatives(:, i) = 0.5_dp*hex_corners(:, i)*cshift(factor, 1)*cshift(factor, 2)
      end do
      if (kind == hex8) return
      ! The middles of the edges have their own, 1 - r^2 along the edge, the corners what these leave them.
      do i = 1, 12
         associate (a => hex_edges(1, i), b => hex_edges(2, i))
            factor = 0.5_dp*(1.0_dp + hex_corners(:, a)*xi)
            slope = 0.5_dp*hex_corners(:, a)
            where (abs(hex_corners(:, a) - hex_corners(:, b)) > 0.0_dp)
               factor = 1.0_dp - xi**2
               slope = -2.0_dp*xi
            end where
            values(8 + i) = product(factor)
            derivatives(:, 8 + i) = slope*cshift(factor, 1)*cshift(factor, 2)
            values([a, b]) = values([a, b]) - 0.5_dp*values(8 + i)
            derivatives(:, a) = derivatives(:, a) - 0.5_dp*derivatives(:, 8 + i)
            derivatives(:, b) = derivatives(:, b) - 0.5_dp*derivatives(:, 8 + i)
         end associate
      end do
   end subroutine solid_shapes

   !> Reference coordinates and weight of a quadrature point: in a tetrahedron one of 1, 4 or 15 points, exact to degree
   !> 1, 2 or 5 (A. H. Stroud, Approximate Calculation of Multiple Integrals, 1971, T3:5-1), in a hexahedron of 1, 2 or
   !> 3 Gauss points in each direction.
   pure subroutine solid_quadrature(kind, n_points, point, xi, weight)
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: n_points !! number of points
      integer, intent(in) :: point !! number of the point, 1 to `n_points`
      real(dp), intent(out) :: xi(3) !! reference coordinates [-]
      real(dp), intent(out) :: weight !! weight; the weights sum to the volume of the reference element [-]
      real(dp), parameter :: root = sqrt(15.0_dp), four_points = (5.0_dp - sqrt(5.0_dp))/20.0_dp
      ! The lesser barycentric coordinates of points towards the corners and towards the faces, with their weights, and
      ! of points towards the edges.
      real(dp), parameter :: by_corners(2) = (7.0_dp + [-root, root])/34.0_dp
      real(dp), parameter :: by_edges = (10.0_dp - 2.0_dp*root)/40.0_dp
      real(dp), parameter :: corner_weights(2) = (2665.0_dp + 14.0_dp*[root, -root])/226800.0_dp
      real(dp), parameter :: gauss(3) = [-sqrt(0.6_dp), 0.0_dp, sqrt(0.6_dp)]
      real(dp), parameter :: gauss_weights(3) = [5.0_dp, 8.0_dp, 5.0_dp]/9.0_dp
      real(dp) :: l(4)
      integer :: place(3)

      if (kind > tet10) then
         place = mod((point - 1)/[1, 3, 9], 3) + 1
         if (n_points == 1) then
            xi = 0.0_dp
            weight = 8.0_dp
         else if (n_points == 8) then
            xi = hex_corners(:, point)/sqrt(3.0_dp)
            weight = 1.0_dp
         else
            xi = gauss(place)
            weight = product(gauss_weights(place))
         end if
         return
      end if
      l = 0.25_dp
      if (n_points == 1) then
         weight = 1.0_dp/6.0_dp
      else if (n_points == 4) then
         weight = 1.0_dp/24.0_dp
         l = four_points
         l(point) = 1.0_dp - 3.0_dp*four_points
      else if (point <= 8) then
         associate (least => by_corners((point + 3)/4))
            weight = corner_weights((point + 3)/4)
            l = least
            l(mod(point - 1, 4) + 1) = 1.0_dp - 3.0_dp*least
         end associate
      else if (point <= 14) then
         weight = 10.0_dp/1134.0_dp
         l = by_edges
         l(tet_edges(:, point - 8)) = 0.5_dp - by_edges
      else
         weight = 8.0_dp/405.0_dp
      end if
      xi = l(2:)
   end subroutine solid_quadrature

end module amontons_solid_element
