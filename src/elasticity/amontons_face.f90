!> Faces of the boundary, in the plane its sides, with one quadrature: loads, foundations, areas and normals are sums
!> over its points.
module amontons_face
   use amontons_dense, only: vector_product
   use amontons_element, only: max_nodes, n_corners, n_fine_points, n_side_points, node_coordinates, quad4, quad8, &
      quadrature_point, shape_functions, side_abscissa, side_shapes, side_weight, tri3, tri6
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t
   use amontons_mesh, only: find_set, mesh_t, side_number
   implicit none (type, external)
   private

   public :: center_shapes, face_kind, face_t, new_face, place_face, place_side, set_faces

   !> A face with what is integrated over it at its Gauss points, exact for products of quadratic functions on a line or
   !> a plane.
   type :: face_t
      integer :: n_nodes = 0 !! number of nodes
      integer, allocatable :: node(:) !! its nodes, as of `mesh_side`, then 0
      integer :: element = 0 !! its element
      integer :: number = 0 !! its number among the sides of all elements, `side_number`; 0 from `new_face`
      real(dp), allocatable :: values(:, :) !! shape functions (node, point) [-]
      real(dp), allocatable :: position(:, :) !! coordinates of the points (n_dim, points) [L]
      real(dp), allocatable :: outward(:, :)
         !! outward normal times the part of the length, in space of the area, that each point stands for
         !! (n_dim, points) [L] or [L^2]
      real(dp), allocatable :: length(:) !! this part of the length, in space of the area (points) [L] or [L^2]
      real(dp), allocatable :: depth(:)
         !! thickness, or circumference of the body of revolution [L]; 1 in space (points)
      real(dp), allocatable :: area(:) !! length times depth (points) [L^2]
   end type face_t

contains

   !> Makes the faces of a boundary set.
   pure subroutine set_faces(faces, mesh, set, error, materials)
      type(face_t), allocatable, intent(out) :: faces(:) !! the faces, in the order of the set
      type(mesh_t), intent(in) :: mesh !! the mesh
      character(*), intent(in) :: set !! name of the boundary set
      type(error_t), allocatable, intent(out) :: error !! there is no such set
      type(materials_t), intent(in), optional :: materials !! as of `new_face`
      integer, allocatable :: sides(:, :)
      integer :: i

      call mesh%set_sides(set, sides, error)
      if (allocated(error)) return
      allocate (faces(size(sides, 2)))
      associate (own => mesh%sets(find_set(mesh%sets, set)))
         do i = 1, size(faces)
            call new_face(faces(i), sides(:, i), mesh, materials)
            faces(i)%number = side_number(own%element(i), own%side(i))
         end do
      end associate
   end subroutine set_faces

   !> Makes a face, or in the plane a part of it, from the nodes of a side.
   pure subroutine new_face(face, side, mesh, materials, range)
      type(face_t), intent(out) :: face !! the face
      integer, intent(in) :: side(:) !! its nodes and its element, as of `mesh_set_sides`
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in), optional :: materials
         !! the materials of its elements, which give the depth; it is 1 without them
      real(dp), intent(in), optional :: range(2) !! where the part begins and ends; the whole face is -1, 1 [-]
      real(dp) :: along(2), ends(2), half, slope(3)
      integer :: n_points, point

      associate (n_dim => size(mesh%coordinates, 1), n => size(side) - 1)
         face%n_nodes = count(side(:n) > 0)
         face%node = side(:n)
         face%element = side(n + 1)
         n_points = n_side_points
         if (n_dim == 3) n_points = n_fine_points(merge(tri6, quad8, mod(face%n_nodes, 3) == 0))
         allocate (face%values(max(3, face%n_nodes), n_points), face%position(n_dim, n_points), &
            face%outward(n_dim, n_points), face%depth(n_points))
      end associate
      if (size(face%position, 1) == 3) then
         call integrate_face(face, mesh%coordinates(:, side(:face%n_nodes)))
      else
         ends = [-1.0_dp, 1.0_dp]
         if (present(range)) ends = range
         half = 0.5_dp*(ends(2) - ends(1))
         associate (n => face%n_nodes, x => mesh%coordinates(:, side(:face%n_nodes)))
            do point = 1, n_points
               call side_shapes(n > 2, 0.5_dp*sum(ends) + half*side_abscissa(point), face%values(:, point), slope)
               face%position(:, point) = matmul(x, face%values(:n, point))
               along = half*side_weight(point)*matmul(x, slope(:n))
               face%outward(:, point) = [along(2), -along(1)]
            end do
         end associate
      end if
      face%length = norm2(face%outward, dim=1)
      face%depth = 1.0_dp
      if (present(materials)) face%depth = materials%list(materials%of_element(face%element))%depth(face%position(1, :))
      face%area = face%length*face%depth
   end subroutine new_face

   !> Evaluates a side at its first corner, its second corner and its middle, that of the chord where it is straight.
   pure subroutine place_side(position, normal, nodes, coordinates)
      real(dp), intent(out) :: position(2, 3) !! coordinates of the three places [L]
      real(dp), intent(out) :: normal(2, 3) !! unit outward normals there [-]
      integer, intent(in) :: nodes(3) !! first corner, second corner, middle or 0; body on the left
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (2, n_nodes) [L]
      real(dp), parameter :: xi(3) = [-1.0_dp, 1.0_dp, 0.0_dp]
      real(dp) :: values(3), slopes(3), along(2)
      integer :: k

      position(:, :2) = coordinates(:, nodes(:2))
      position(:, 3) = 0.5_dp*(position(:, 1) + position(:, 2))
      if (nodes(3) > 0) position(:, 3) = coordinates(:, nodes(3))
      do k = 1, 3
         call side_shapes(nodes(3) > 0, xi(k), values, slopes)
         along = matmul(position, slopes)
         normal(:, k) = [along(2), -along(1)]/norm2(along)
      end do
   end subroutine place_side

   !> Evaluates a face in space at its corners and in its middle.
   pure subroutine place_face(position, normal, nodes, coordinates)
      real(dp), intent(out) :: position(:, :) !! coordinates of the places (3, corners + 1) [L]
      real(dp), intent(out) :: normal(:, :) !! unit outward normals there (3, corners + 1) [-]
      integer, intent(in) :: nodes(:) !! its nodes, as of `mesh_side`
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (3, n_nodes) [L]
      real(dp) :: values(max_nodes), derivatives(2, max_nodes), tangents(3, 2)
      integer :: k, n

      n = count(nodes > 0)
      do k = 1, size(position, 2)
         call shape_functions(face_kind(n), face_place(n, k), values, derivatives)
         position(:, k) = matmul(coordinates(:, nodes(:n)), values(:n))
         tangents = matmul(coordinates(:, nodes(:n)), transpose(derivatives(:, :n)))
         normal(:, k) = vector_product(tangents(:, 1), tangents(:, 2))
         normal(:, k) = normal(:, k)/norm2(normal(:, k))
      end do
   end subroutine place_face

   !> Reference coordinates of a corner of a face in space, or of its center behind the last [-].
   pure function face_place(n_nodes, place) result(xi)
      integer, intent(in) :: n_nodes !! number of nodes of the face
      integer, intent(in) :: place !! number of the corner
      real(dp) :: xi(2)

      associate (kind => face_kind(n_nodes))
         if (place <= n_corners(kind)) then
            xi = node_coordinates(kind, place)
         else
            xi = merge(1.0_dp/3.0_dp, 0.0_dp, n_corners(kind) == 3)
         end if
      end associate
   end function face_place

   !> The shape functions of a side in its middle, those of its corners first [-].
   pure function center_shapes(n_nodes, n_dim) result(values)
      integer, intent(in) :: n_nodes !! number of nodes of the side
      integer, intent(in) :: n_dim !! number of dimensions
      real(dp) :: values(max_nodes)
      real(dp) :: derivatives(2, max_nodes), slopes(3)

      if (n_dim == 2) then
         values = 0.0_dp
         call side_shapes(n_nodes > 2, 0.0_dp, values(:3), slopes)
      else
         call shape_functions(face_kind(n_nodes), face_place(n_nodes, n_nodes + 1), values, derivatives)
      end if
   end function center_shapes

   !> Sets shape functions, positions and area vectors at the points of a face in space.
   pure subroutine integrate_face(face, x)
      type(face_t), intent(inout) :: face !! the face, its arrays allocated
      real(dp), intent(in) :: x(:, :) !! coordinates of its nodes (3, nodes) [L]
      real(dp) :: xi(2), weight, values(max_nodes), derivatives(2, max_nodes), tangents(3, 2)
      integer :: kind, point

      kind = face_kind(face%n_nodes)
      associate (n => face%n_nodes)
         do point = 1, size(face%values, 2)
            call quadrature_point(kind, size(face%values, 2), point, xi, weight)
            call shape_functions(kind, xi, values, derivatives)
            face%values(:, point) = values(:n)
            face%position(:, point) = matmul(x, values(:n))
            tangents = matmul(x, transpose(derivatives(:, :n)))
            face%outward(:, point) = weight*vector_product(tangents(:, 1), tangents(:, 2))
         end do
      end associate
   end subroutine integrate_face

   !> The kind of plane element whose shape functions a face of a solid has.
   elemental integer function face_kind(n_nodes)
      integer, intent(in) :: n_nodes !! number of nodes of the face: 3, 4, 6 or 8

      select case (n_nodes)
      case (3)
         face_kind = tri3
      case (4)
         face_kind = quad4
      case (6)
         face_kind = tri6
      case default
         face_kind = quad8
      end select
   end function face_kind

end module amontons_face
