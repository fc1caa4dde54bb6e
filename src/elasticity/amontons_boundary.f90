!> Boundary lines: the sides of a set in consecutive order, with normals and weights.
module amontons_boundary
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face, only: face_t, set_faces
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t, on_axis
   use amontons_mesh, only: mesh_t
   use amontons_rounding, only: input_rounding
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: boundary_line_t, new_boundary_line

   !> The nodes of a boundary set, in order, the body on the left. A set of several pieces lists them one after the
   !> other.
   type :: boundary_line_t
      integer :: n_nodes = 0 !! number of nodes
      integer, allocatable :: node(:) !! number of each node in the mesh (n_nodes)
      real(dp), allocatable :: normal(:, :) !! unit outward normal, a mean by the shape function (2, n_nodes) [-]
      real(dp), allocatable :: area(:)
         !! tributary area; 0 for a corner of a quadratic side on the axis of revolution (n_nodes) [L^2]
      real(dp), allocatable :: bare_area(:)
         !! of such a corner the integral of its shape function, which may be negative; 0 elsewhere (n_nodes) [L^2]
      real(dp), allocatable :: moment(:)
         !! integral of the node's shape function times the square of x (n_nodes) [L^4]
      real(dp), allocatable :: weight(:) !! tributary length: integral of the node's shape function (n_nodes) [L]
      integer, allocatable :: next(:) !! place in this list of the node a side leads to, 0 for none (n_nodes)
   end type boundary_line_t

contains

   !> Orders the sides of a boundary set and computes normals and weights of its nodes.
   subroutine new_boundary_line(line, mesh, set, error, materials)
      type(boundary_line_t), intent(out) :: line !! the line
      type(mesh_t), intent(in) :: mesh !! the mesh
      character(*), intent(in) :: set !! name of the boundary set
      type(error_t), allocatable, intent(out) :: error
         !! no such set, more than two of its sides meet in a node, or two fold back on each other
      type(materials_t), intent(in), optional :: materials
         !! materials of the elements, which give the depth; it is 1 without them
      type(face_t), allocatable :: faces(:)
      integer, allocatable :: after(:), before(:)
      real(dp) :: length
      integer :: i, turn, node, place, first_place

      call set_faces(faces, mesh, set, error, materials)
      if (allocated(error)) return
      ! The node that follows each node, and the corner that comes before each corner.
      allocate (after(mesh%n_nodes), before(mesh%n_nodes), source=0)
      do i = 1, size(faces)
         associate (first => faces(i)%node(1), second => faces(i)%node(2), middle => faces(i)%node(3))
            if (after(first) /= 0 .or. before(second) /= 0) then
               call new_error(error, input_refused, "the sides of the set '"//set// &
                  "' do not form lines: they branch at node "//to_text(merge(first, second, after(first) /= 0)))
               return
            end if
            after(first) = merge(middle, second, middle > 0)
            if (middle > 0) after(middle) = second
            before(second) = first
         end associate
      end do
      ! Open pieces from their first node on, then closed ones.
      allocate (line%node(3*size(faces)), line%next(3*size(faces)))
      do turn = 1, 2
         do i = 1, size(faces)
            node = faces(i)%node(1)
            if (after(node) == 0 .or. (turn == 1 .and. before(node) /= 0)) cycle
            first_place = line%n_nodes + 1
            do
               place = line%n_nodes + 1
               line%n_nodes = place
               line%node(place) = node
               node = after(node)
               after(line%node(place)) = 0
               line%next(place) = merge(place + 1, 0, node > 0)
               if (node == faces(i)%node(1)) line%next(place) = first_place
               if (node == 0 .or. node == faces(i)%node(1)) exit
            end do
         end do
      end do
      line%node = line%node(:line%n_nodes)
      line%next = line%next(:line%n_nodes)
      call measure_faces(line, faces, mesh, materials)
      do i = 1, line%n_nodes
         length = norm2(line%normal(:, i))
         if (.not. length > input_rounding*line%weight(i)) then
            associate (position => mesh%coordinates(:, line%node(i)))
               call new_error(error, input_refused, "the sides of the set '"//set//"' fold back on each other at "// &
                  'the node '//to_text(position(1))//', '//to_text(position(2))//', which leaves it no normal')
            end associate
            return
         end if
         line%normal(:, i) = line%normal(:, i)/length
      end do
   end subroutine new_boundary_line

   !> Integrals of the nodes' shape functions: alone, times the normal and times the depth. Faces on the axis of
   !> revolution are inside the body: they do not contribute to the normals of their ends.
   pure subroutine measure_faces(line, faces, mesh, materials)
      type(boundary_line_t), intent(inout) :: line !! the line, its nodes in order; its normals are no unit vectors yet
      type(face_t), intent(in) :: faces(:) !! its faces
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in), optional :: materials !! materials of the elements
      integer :: place(mesh%n_nodes), i, k, p, point
      logical :: is_bare(mesh%n_nodes), is_on_axis(mesh%n_nodes)
      real(dp) :: axial(2, line%n_nodes)

      place = 0
      place(line%node) = [(i, i=1, line%n_nodes)]
      allocate (line%normal(2, line%n_nodes), line%weight(line%n_nodes), line%area(line%n_nodes), &
         line%moment(line%n_nodes), source=0.0_dp)
      axial = 0.0_dp
      is_bare = .false.
      is_on_axis = .false.
      if (present(materials)) is_on_axis = on_axis(mesh, materials)
      do i = 1, size(faces)
         associate (face => faces(i))
            do point = 1, size(face%area)
               do k = 1, face%n_nodes
                  p = place(face%node(k))
                  associate (value => face%values(k, point))
                     line%weight(p) = line%weight(p) + value*face%length(point)
                     line%area(p) = line%area(p) + value*face%area(point)
                     line%moment(p) = line%moment(p) + value*face%area(point)*face%position(1, point)**2
                     if (all(is_on_axis(face%node(:2)))) then
                        axial(:, p) = axial(:, p) + value*face%outward(:, point)
                     else
                        line%normal(:, p) = line%normal(:, p) + value*face%outward(:, point)
                     end if
                  end associate
               end do
            end do
            if (face%n_nodes > 2) is_bare(face%node(:2)) = is_on_axis(face%node(:2))
         end associate
      end do
      ! What has no other side keeps the normal of the axis.
      where (spread(.not. any(abs(line%normal) > 0.0_dp, dim=1), 1, 2)) line%normal = axial
      ! A corner of a quadratic side on the axis of revolution has no area: that of a straight side is 0; of a curved
      ! one, or with its middle node off the middle, the integral is a small number of either sign, over which a
      ! force is no stress.
      line%bare_area = merge(line%area, 0.0_dp, is_bare(line%node))
      line%area = line%area - line%bare_area
   end subroutine measure_faces

end module amontons_boundary
