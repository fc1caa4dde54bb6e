!> Patches of the boundary: the faces and nodes of a set, with normals and areas and, in the plane, their order along
!> lines.
!>
!> In space a corner of quadratic faces has an area of 0, or less, and no normal with the shape functions as they are.
!> It takes a share a of those of the middle nodes beside it, N_c + a sum N_m, and leaves them (1 - 2 a) N_m: all
!> functions then have positive integrals, and their sum is 1 as before (Popp, Wohlmuth, Gee, Wall, SIAM Journal on
!> Scientific Computing 34, 2012).
module amontons_boundary
   use amontons_element, only: max_face_nodes
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face, only: face_t, set_faces
   use amontons_kinds, only: dp
   use amontons_line, only: line_t
   use amontons_material, only: materials_t, on_axis
   use amontons_mesh, only: mesh_t
   use amontons_rounding, only: input_rounding
   use amontons_text, only: place_text, to_text
   implicit none (type, external)
   private

   public :: corner_share, n_face_corners, new_patch, patch_t

   !> The share a of the shape function of a middle node that either corner beside it takes, of their choice [-].
   real(dp), parameter :: corner_share = 0.2_dp

   !> The faces and nodes of a boundary set. In the plane both have the order of lines with the body on the left;
   !> several pieces stand one after the other, open ones first.
   type :: patch_t
      type(face_t), allocatable :: faces(:) !! the faces
      integer :: n_nodes = 0 !! number of nodes
      integer, allocatable :: node(:) !! number of each node in the mesh (n_nodes)
      real(dp), allocatable :: normal(:, :) !! unit outward normal, a mean by the shape function (n_dim, n_nodes) [-]
      real(dp), allocatable :: area(:)
         !! tributary area; 0 for a corner of a quadratic side on the axis of revolution (n_nodes) [L^2]
      real(dp), allocatable :: bare_area(:)
         !! of such a corner the integral of its shape function, which may be negative; 0 elsewhere (n_nodes) [L^2]
      real(dp), allocatable :: moment(:)
         !! integral of the node's shape function times the square of x (n_nodes) [L^4]
      real(dp), allocatable :: weight(:)
         !! integral of the node's shape function over the length, in space over the area (n_nodes) [L], [L^2]
      integer, allocatable :: ends(:, :)
         !! in space the places of the corners beside each middle node; 0 for corners and in the plane (2, n_nodes)
      type(line_t), allocatable :: line !! how the nodes follow each other; not allocated in space
   contains
      procedure :: sides => patch_sides
   end type patch_t

contains

   !> Collects the faces of a boundary set and computes normals and areas of its nodes.
   pure subroutine new_patch(patch, mesh, set, error, materials, taken)
      type(patch_t), intent(out) :: patch !! the patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      character(*), intent(in) :: set !! name of the boundary set
      type(error_t), allocatable, intent(out) :: error
         !! no such set, more than two sides meet in a node, or two faces fold back on each other
      type(materials_t), intent(in), optional :: materials
         !! materials of the elements, which give the depth; it is 1 without them
      logical, intent(in), optional :: taken(:)
         !! which faces of a solid are left out, by `side_number`; none without it
      real(dp) :: length
      integer :: i

      call set_faces(patch%faces, mesh, set, error, materials)
      if (allocated(error)) return
      if (size(mesh%coordinates, 1) == 2) then
         call order_faces(patch%faces, set, mesh%n_nodes, error)
      else if (present(taken)) then
         patch%faces = pack(patch%faces, .not. taken(patch%faces%number))
      end if
      if (allocated(error)) return
      call list_nodes(patch, mesh)
      call measure_faces(patch, mesh, materials)
      do i = 1, patch%n_nodes
         length = norm2(patch%normal(:, i))
         if (.not. length > input_rounding*patch%weight(i)) then
            call new_error(error, input_refused, "the sides of the set '"//set//"' fold back on each other at "// &
               'the node '//place_text(mesh%coordinates(:, patch%node(i)))//', which leaves it no normal')
            return
         end if
         patch%normal(:, i) = patch%normal(:, i)/length
      end do
   end subroutine new_patch

   !> First corner, second corner, middle or 0, element of each side, as of `mesh_set_sides` (4, faces).
   pure function patch_sides(self) result(sides)
      class(patch_t), intent(in) :: self !! the patch
      integer :: sides(4, size(self%faces)), i

      do i = 1, size(self%faces)
         sides(:, i) = [self%faces(i)%node, self%faces(i)%element]
      end do
   end function patch_sides

   !> Orders the sides of a set along lines.
   pure subroutine order_faces(faces, set, n_nodes, error)
      type(face_t), allocatable, intent(inout) :: faces(:) !! the sides
      character(*), intent(in) :: set !! name of the set
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      type(error_t), allocatable, intent(out) :: error !! more than two of them meet in a node
      type(line_t) :: line
      integer, dimension(n_nodes) :: from, to
      integer, allocatable :: order(:)
      integer :: i

      from = 0
      to = 0
      do i = 1, size(faces)
         associate (first => faces(i)%node(1), second => faces(i)%node(2))
            if (from(first) > 0 .or. to(second) > 0) then
               call new_error(error, input_refused, "the sides of the set '"//set// &
                  "' do not form lines: they branch at node "//to_text(merge(first, second, from(first) > 0)))
               return
            end if
            from(first) = i
            to(second) = i
         end associate
      end do
      line%next = [(from(faces(i)%node(2)), i=1, size(faces))]
      call line%walk(order)
      faces = faces(order)
   end subroutine order_faces

   !> Lists the nodes of the faces, each where it occurs first, and their line in the plane.
   pure subroutine list_nodes(patch, mesh)
      type(patch_t), intent(inout) :: patch !! the patch, its faces in order
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, allocatable :: along(:)
      integer :: place(0:mesh%n_nodes), i, k, n

      place = 0
      ! In the plane first corner, middle, second corner.
      along = [1, 3, 2]
      if (size(mesh%coordinates, 1) > 2) along = [(i, i=1, max_face_nodes)]
      allocate (patch%node(size(along)*size(patch%faces)))
      do i = 1, size(patch%faces)
         do k = 1, size(along)
            associate (node => patch%faces(i)%node(along(k)))
               if (node == 0 .or. place(node) > 0) cycle
               patch%n_nodes = patch%n_nodes + 1
               patch%node(patch%n_nodes) = node
               place(node) = patch%n_nodes
            end associate
         end do
      end do
      patch%node = patch%node(:patch%n_nodes)
      allocate (patch%ends(2, patch%n_nodes), source=0)
      if (size(mesh%coordinates, 1) > 2) then
         do i = 1, size(patch%faces)
            associate (face => patch%faces(i))
               n = n_face_corners(face)
               do k = n + 1, face%n_nodes
                  patch%ends(:, place(face%node(k))) = place(face%node([k - n, 1 + modulo(k - n, n)]))
               end do
            end associate
         end do
         return
      end if
      allocate (patch%line)
      associate (line => patch%line, x => mesh%coordinates(:, patch%node))
         allocate (line%next(patch%n_nodes), source=0)
         allocate (line%arc_length(patch%n_nodes), source=0.0_dp)
         do i = 1, size(patch%faces)
            associate (ends => place(patch%faces(i)%node(:2)), middle => place(patch%faces(i)%node(3)))
               line%next(ends(1)) = merge(middle, ends(2), middle > 0)
               if (middle > 0) line%next(middle) = ends(2)
            end associate
         end do
         do i = 2, patch%n_nodes
            line%arc_length(i) = line%arc_length(i - 1) + norm2(x(:, i) - x(:, i - 1))
         end do
      end associate
   end subroutine list_nodes

   !> Integrals of the nodes' shape functions: alone, times the normal and times the depth. Faces on the axis of
   !> revolution are inside the body: they do not contribute to the normals of their ends.
   pure subroutine measure_faces(patch, mesh, materials)
      type(patch_t), intent(inout) :: patch !! the patch, its nodes listed; its normals are no unit vectors yet
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in), optional :: materials !! materials of the elements
      integer :: place(mesh%n_nodes), i, k, p, point
      logical :: is_bare(mesh%n_nodes), is_on_axis(mesh%n_nodes)
      real(dp) :: axial(size(mesh%coordinates, 1), patch%n_nodes)
      real(dp), allocatable :: values(:, :)

      place = 0
      place(patch%node) = [(i, i=1, patch%n_nodes)]
      allocate (patch%normal(size(axial, 1), patch%n_nodes), patch%weight(patch%n_nodes), patch%area(patch%n_nodes), &
         patch%moment(patch%n_nodes), source=0.0_dp)
      axial = 0.0_dp
      is_bare = .false.
      is_on_axis = .false.
      if (present(materials)) is_on_axis = on_axis(mesh, materials)
      do i = 1, size(patch%faces)
         associate (face => patch%faces(i))
            values = face%values
            if (size(axial, 1) > 2) call share_middles(values, face)
            do point = 1, size(face%area)
               do k = 1, face%n_nodes
                  p = place(face%node(k))
                  associate (value => values(k, point))
                     patch%weight(p) = patch%weight(p) + value*face%length(point)
                     patch%area(p) = patch%area(p) + value*face%area(point)
                     patch%moment(p) = patch%moment(p) + value*face%area(point)*face%position(1, point)**2
                     if (all(is_on_axis(face%node(:2)))) then
                        axial(:, p) = axial(:, p) + value*face%outward(:, point)
                     else
                        patch%normal(:, p) = patch%normal(:, p) + value*face%outward(:, point)
                     end if
                  end associate
               end do
            end do
            if (face%n_nodes > 2) is_bare(face%node(:2)) = is_on_axis(face%node(:2))
         end associate
      end do
      ! What has no other side keeps the normal of the axis.
      where (spread(.not. any(abs(patch%normal) > 0.0_dp, dim=1), 1, size(axial, 1))) patch%normal = axial
      ! A corner of a quadratic side on the axis of revolution has no area: that of a straight side is 0; of a curved
      ! one, or with its middle node off the middle, the integral is a small number of either sign, over which a
      ! force is no stress.
      patch%bare_area = merge(patch%area, 0.0_dp, is_bare(patch%node))
      patch%area = patch%area - patch%bare_area
   end subroutine measure_faces

   !> Number of corners of a face in space.
   pure integer function n_face_corners(face) result(n)
      type(face_t), intent(in) :: face !! the face

      n = face%n_nodes
      if (n > 4) n = n/2
   end function n_face_corners

   !> Gives the corners of a face in space their shares of the shape functions of middle nodes.
   pure subroutine share_middles(values, face)
      real(dp), intent(inout) :: values(:, :) !! the shape functions (node, point) [-]
      type(face_t), intent(in) :: face !! the face
      integer :: n

      n = n_face_corners(face)
      if (n == face%n_nodes) return
      associate (corners => values(:n, :), middles => values(n + 1:face%n_nodes, :))
         corners = corners + corner_share*(middles + cshift(middles, -1, dim=1))
         middles = (1.0_dp - 2.0_dp*corner_share)*middles
      end associate
   end subroutine share_middles

end module amontons_boundary
