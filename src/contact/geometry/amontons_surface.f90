!> A boundary set as a surface: its sides, straight or curved, and a continuous field of normals on them.
!>
!> The normal of a node is the mean of the unit normals of the sides that meet there; between the nodes of a side the
!> shape functions interpolate. At an end of the set it is the one side's own. On a plane of symmetry, where supports
!> hold a line of nodes along one direction, and on the axis of revolution it loses its component along this direction:
!> the plane mirrors the surface.
module amontons_surface
   use amontons_boundary, only: boundary_line_t
   use amontons_constraints, only: constraints_t
   use amontons_element, only: side_shapes
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: join_sides, meshed_body_t, new_surface, side_order, surface_place_t, surface_t

   !> A mesh with its materials and supports.
   type :: meshed_body_t
      type(mesh_t) :: mesh !! the mesh
      type(materials_t) :: materials !! the materials of the elements
      type(constraints_t) :: constraints !! the supports
   end type meshed_body_t

   !> The sides of a boundary set, in the order of its line.
   type :: surface_t
      integer :: n_sides = 0 !! number of sides
      integer, allocatable :: side(:, :)
         !! first corner, second corner, middle or 0, element of each side; body on the left (4, n_sides)
      real(dp), allocatable :: corner(:, :, :)
         !! coordinates of first corner, second corner, middle of each side; the middle of a straight one is that of its
         !! chord (2, 3, n_sides) [L]
      real(dp), allocatable :: normal(:, :, :) !! unit outward normals there (2, 3, n_sides) [-]
      real(dp), allocatable :: arc_length(:)
         !! length along the line where each side begins, chord by chord (n_sides) [L]
      type(material_t), allocatable :: material(:) !! the material behind each side, for the depth (n_sides)
      integer, allocatable :: mirrored_node(:) !! ends that lie on a plane of symmetry, where shear vanishes
      real(dp) :: longest = 0.0_dp !! longest chord of a side [L]
      integer :: corner_node = 0 !! a node where sides meet at so sharp an angle that it has no mean normal; 0 for none
   contains
      procedure :: place => surface_place
   end type surface_t

   !> A place on a side.
   type :: surface_place_t
      real(dp) :: values(3) = 0.0_dp !! shape functions of first corner, second corner, middle [-]
      real(dp) :: position(2) = 0.0_dp !! coordinates [L]
      real(dp) :: along(2) = 0.0_dp !! tangent: derivative of the position by the side's coordinate [L]
      real(dp) :: normal(2) = 0.0_dp !! normal of the continuous field, not of length 1 [-]
      real(dp) :: depth = 0.0_dp !! depth of the body [L]
   contains
      procedure :: outward => surface_place_outward
   end type surface_place_t

contains

   !> The sides in the order of the line.
   pure function side_order(sides, line, n_nodes) result(order)
      integer, intent(in) :: sides(:, :) !! first corner, second corner, middle or 0, element of each side (4, sides)
      type(boundary_line_t), intent(in) :: line !! the line
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      integer, allocatable :: order(:)
      integer :: side_from(n_nodes), i

      side_from = 0
      side_from(sides(1, :)) = [(i, i=1, size(sides, 2))]
      order = pack(side_from(line%node), side_from(line%node) > 0)
   end function side_order

   !> Makes the surface of a boundary set.
   pure subroutine new_surface(surface, body, set, line, error)
      type(surface_t), intent(out) :: surface !! the surface
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      character(*), intent(in) :: set !! name of the boundary set
      type(boundary_line_t), intent(in) :: line !! its line
      type(error_t), allocatable, intent(out) :: error !! there is no such set
      integer, allocatable :: sides(:, :)
      ! A direction at less than 60 degrees to the normal is held against the contact, not by symmetry.
      real(dp), parameter :: most = 0.5_dp
      logical :: is_free(2)
      real(dp) :: held(2)
      integer :: i, k

      call body%mesh%set_sides(set, sides, error)
      if (allocated(error)) return
      call join_sides(surface, body, sides(:, side_order(sides, line, body%mesh%n_nodes)))
      allocate (surface%mirrored_node(0))
      do i = 1, surface%n_sides
         do k = 1, 2
            associate (node => surface%side(k, i), normal => surface%normal(:, k, i))
               if (any(surface%side(3 - k, :) == node)) cycle
               is_free = body%constraints%is_free(:, node)
               if (is_free(1) .neqv. is_free(2)) then
                  held = body%constraints%held_direction(node)
                  if (.not. is_on_mirror(body, node, held)) cycle
               else if (surface%material(i)%is_axisymmetric &
                  .and. .not. abs(body%mesh%coordinates(1, node)) > 0.0_dp) then
                  held = [1.0_dp, 0.0_dp]
               else
                  cycle
               end if
               if (abs(dot_product(held, normal)) > most) cycle
               normal = normal - dot_product(held, normal)*held
               normal = normal/norm2(normal)
               surface%mirrored_node = [surface%mirrored_node, node]
            end associate
         end do
      end do
   end subroutine new_surface

   !> Makes a surface of sides of the boundary. Its ends have the normals of their sides on planes of symmetry, too.
   pure subroutine join_sides(surface, body, sides)
      type(surface_t), intent(out) :: surface !! the surface
      class(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      integer, intent(in) :: sides(:, :)
         !! first corner, second corner, middle or 0, element of each side; body on the left (4, sides)
      real(dp), parameter :: xi(3) = [-1.0_dp, 1.0_dp, 0.0_dp]
      type(surface_place_t) :: place
      real(dp) :: begin
      integer :: i, k, side_from(body%mesh%n_nodes), next
      ! Cosine of the angle from which on two sides make a corner: 40 degrees.
      real(dp), parameter :: sharp = 0.766_dp
      real(dp) :: mean(2)

      surface%side = sides
      surface%n_sides = size(sides, 2)
      surface%material = body%materials%list(body%materials%of_element(surface%side(4, :)))
      allocate (surface%corner(2, 3, surface%n_sides), surface%normal(2, 3, surface%n_sides), &
         surface%arc_length(surface%n_sides))
      begin = 0.0_dp
      do i = 1, surface%n_sides
         associate (corner => surface%corner(:, :, i), nodes => surface%side(:3, i))
            corner(:, :2) = body%mesh%coordinates(:, nodes(:2))
            corner(:, 3) = 0.5_dp*(corner(:, 1) + corner(:, 2))
            if (nodes(3) > 0) corner(:, 3) = body%mesh%coordinates(:, nodes(3))
            surface%arc_length(i) = begin
            begin = begin + norm2(corner(:, 2) - corner(:, 1))
            surface%longest = max(surface%longest, norm2(corner(:, 2) - corner(:, 1)))
         end associate
         surface%normal(:, :, i) = 0.0_dp
         do k = 1, 3
            place = surface%place(i, xi(k))
            surface%normal(:, k, i) = place%outward()
         end do
      end do
      ! Nodes between two sides have the mean of their normals, unless these differ too much.
      side_from = 0
      side_from(surface%side(1, :)) = [(i, i=1, surface%n_sides)]
      do i = 1, surface%n_sides
         next = side_from(surface%side(2, i))
         if (next == 0) cycle
         if (dot_product(surface%normal(:, 2, i), surface%normal(:, 1, next)) < sharp) then
            surface%corner_node = surface%side(2, i)
         else
            mean = surface%normal(:, 2, i) + surface%normal(:, 1, next)
            surface%normal(:, 2, i) = mean/norm2(mean)
            surface%normal(:, 1, next) = surface%normal(:, 2, i)
         end if
      end do
   end subroutine join_sides

   !> Whether a node that is held along a direction lies on a plane of symmetry: a node beside it lies there, too, and
   !> is held likewise.
   pure logical function is_on_mirror(body, node, held)
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: held(2) !! the direction, a unit vector [-]
      ! What the digits of mesh files leave of a right angle.
      real(dp), parameter :: rounding = 1.0e-4_dp
      real(dp) :: way(2)
      integer :: element, i

      is_on_mirror = .true.
      do element = 1, body%mesh%n_elements
         associate (nodes => body%mesh%node(body%mesh%node_start(element):body%mesh%node_start(element + 1) - 1))
            if (all(nodes /= node)) cycle
            do i = 1, size(nodes)
               if (nodes(i) == node .or. body%constraints%leaves_free(nodes(i), held)) cycle
               way = body%mesh%coordinates(:, nodes(i)) - body%mesh%coordinates(:, node)
               if (abs(dot_product(way, held)) <= rounding*norm2(way)) return
            end do
         end associate
      end do
      is_on_mirror = .false.
   end function is_on_mirror

   !> Evaluates a side.
   pure type(surface_place_t) function surface_place(self, side, xi) result(place)
      class(surface_t), intent(in) :: self !! the surface
      integer, intent(in) :: side !! number of the side
      real(dp), intent(in) :: xi !! the place on it, from -1 to 1 [-]
      real(dp) :: slope(3)

      call side_shapes(self%side(3, side) > 0, xi, place%values, slope)
      place%position = matmul(self%corner(:, :, side), place%values)
      place%along = matmul(self%corner(:, :, side), slope)
      place%normal = matmul(self%normal(:, :, side), place%values)
      place%depth = self%material(side)%depth(place%position(1))
   end function surface_place

   !> The unit outward normal of the side itself [-].
   pure function surface_place_outward(self) result(outward)
      class(surface_place_t), intent(in) :: self !! the place
      real(dp) :: outward(2)

      outward = [self%along(2), -self%along(1)]/norm2(self%along)
   end function surface_place_outward

end module amontons_surface
