!> Faces of the boundary, in the plane its sides, with one quadrature: loads, foundations, areas and normals are sums
!> over its points.
module amontons_face
   use amontons_element, only: n_side_points, side_abscissa, side_shapes, side_weight
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t
   use amontons_mesh, only: find_set, mesh_t, side_number
   implicit none (type, external)
   private

   public :: face_t, new_face, place_side, set_faces

   !> A face with what is integrated over it at its Gauss points, exact for products of quadratic functions.
   type :: face_t
      integer :: n_nodes = 0 !! number of nodes
      integer :: node(3) = 0 !! its nodes: first corner, second corner, the body on the left of them, middle or 0
      integer :: element = 0 !! its element
      integer :: number = 0 !! its number among the sides of all elements, `side_number`; 0 from `new_face`
      real(dp) :: values(3, n_side_points) = 0.0_dp !! shape functions (node, point) [-]
      real(dp) :: position(2, n_side_points) = 0.0_dp !! coordinates of the points [L]
      real(dp) :: outward(2, n_side_points) = 0.0_dp
         !! outward normal times the part of the length that each point stands for (2, points) [L]
      real(dp) :: length(n_side_points) = 0.0_dp !! this part of the length [L]
      real(dp) :: depth(n_side_points) = 0.0_dp !! thickness, or circumference of the body of revolution [L]
      real(dp) :: area(n_side_points) = 0.0_dp !! length times depth [L^2]
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

   !> Makes a face, or a part of it, from the nodes of a side.
   pure subroutine new_face(face, side, mesh, materials, range)
      type(face_t), intent(out) :: face !! the face
      integer, intent(in) :: side(4) !! first corner, second corner, middle or 0, element, as of `mesh_set_sides`
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in), optional :: materials
         !! the materials of its elements, which give the depth; it is 1 without them
      real(dp), intent(in), optional :: range(2) !! where the part begins and ends; the whole face is -1, 1 [-]
      real(dp) :: along(2), ends(2), half, nodes(2, 3), slope(3)
      integer :: point

      face%n_nodes = count(side(:3) > 0)
      face%node = side(:3)
      face%element = side(4)
      nodes = 0.0_dp
      nodes(:, :face%n_nodes) = mesh%coordinates(:, side(:face%n_nodes))
      ends = [-1.0_dp, 1.0_dp]
      if (present(range)) ends = range
      half = 0.5_dp*(ends(2) - ends(1))
      do point = 1, n_side_points
         call side_shapes(side(3) > 0, 0.5_dp*sum(ends) + half*side_abscissa(point), face%values(:, point), slope)
         face%position(:, point) = matmul(nodes, face%values(:, point))
         along = half*side_weight(point)*matmul(nodes, slope)
         face%outward(:, point) = [along(2), -along(1)]
      end do
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

end module amontons_face
