!> Corners of rigid obstacles between contact points: a tooth, a spike or a narrow circle may penetrate a side whose
!> nodes do not touch it.
module amontons_obstacle_corners
   use amontons_body, only: body_t
   use amontons_contact_set, only: contact_t
   use amontons_element, only: n_corners, side_shapes
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   use amontons_mortar_segments, only: meet_side
   use amontons_obstacle, only: unit_vector
   use amontons_surface, only: cross_product
   implicit none (type, external)
   private

   public :: find_corner_penetration

contains

   !> Finds the corner of a polyline, or the apex of a circle or parabola, that penetrates a contact set deepest.
   !>
   !> As gaps do, the depth counts along the normal of the side, of displacements along it. What a smooth surface or a
   !> single corner between two nodes may reach into the side is the error of the mesh and does not count, see
   !> `resolved_depth`.
   pure subroutine find_corner_penetration(body, contacts, displacement, depth, place, set)
      type(body_t), intent(in) :: body !! the body
      type(contact_t), intent(in) :: contacts(:) !! its contact sets, the obstacles where they are now
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(out) :: depth !! the depth; 0 if no corner penetrates by more than a negligible one [L]
      real(dp), intent(out) :: place(2) !! where the side is penetrated [L]
      integer, intent(out) :: set !! number of the contact set, 0 for none
      ! Over the largest displacement: a roughness of measured profiles that is smaller does not spoil the pressures.
      real(dp), parameter :: negligible = 1.0e-2_dp
      ! The corner itself may lie on the border of two elements.
      real(dp), parameter :: nearly = 0.99_dp
      integer, allocatable :: sides(:, :)
      real(dp), allocatable :: corners(:, :)
      type(error_t), allocatable :: error
      real(dp) :: side(2, 3), moved(2, 3), normal(2), xi(2), values(3), slopes(3), overlap, low, high
      integer :: i, k, j, l, node

      depth = negligible*maxval(abs(displacement))
      place = 0.0_dp
      set = 0
      do i = 1, size(contacts)
         if (contacts(i)%pairing%is_pair()) cycle
         corners = corners_of(contacts(i))
         if (size(corners) == 0) cycle
         call body%mesh%set_sides(contacts(i)%set, sides, error)
         if (allocated(error)) cycle
         do k = 1, size(sides, 2)
            normal = body%mesh%coordinates(:, sides(2, k)) - body%mesh%coordinates(:, sides(1, k))
            normal = unit_vector([normal(2), -normal(1)])
            do j = 1, 3
               node = sides(j, k)
               if (node == 0) then
                  side(:, 3) = 0.5_dp*(side(:, 1) + side(:, 2))
                  moved(:, 3) = 0.5_dp*(moved(:, 1) + moved(:, 2))
               else
                  side(:, j) = body%mesh%coordinates(:, node)
                  moved(:, j) = side(:, j) + (dot_product(displacement(:, node), normal) - contacts(i)%extra_gap)*normal
               end if
            end do
            low = min(-cross_product(normal, side(:, 1)), -cross_product(normal, side(:, 2)))
            high = max(-cross_product(normal, side(:, 1)), -cross_product(normal, side(:, 2)))
            do l = 1, size(corners, 2)
               if (-cross_product(normal, corners(:, l)) < low .or. -cross_product(normal, corners(:, l)) > high) cycle
               xi = meet_side(moved, corners(:, l), normal)
               do j = 1, 2
                  if (abs(xi(j)) > 1.0_dp) cycle
                  call side_shapes(.true., xi(j), values, slopes)
                  overlap = dot_product(matmul(moved, values) - corners(:, l), normal)
                  if (.not. overlap > depth) cycle
                  overlap = overlap - resolved_depth(contacts(i), side, moved, normal, xi(j), sides(3, k) > 0)
                  if (.not. overlap > depth) cycle
                  ! What lies beyond the body, on the far side of it, was not pressed into it.
                  associate (on_side => matmul(side, values))
                     if (.not. (is_inside(body%mesh, on_side - 0.5_dp*overlap*normal) .and. &
                        is_inside(body%mesh, on_side - nearly*overlap*normal))) cycle
                  end associate
                  depth = overlap
                  place = matmul(side, values)
                  set = i
               end do
            end do
         end do
      end do
      if (set == 0) depth = 0.0_dp
   end subroutine find_corner_penetration

   !> The corners of a rigid obstacle that bulge towards the body: ends of a polyline and points where its way turns to
   !> the right, away from the free side; the apex of a circle or parabola (2, corners) [L].
   pure function corners_of(contact) result(corners)
      type(contact_t), intent(in) :: contact !! the contact set
      real(dp), allocatable :: corners(:, :)
      logical, allocatable :: bulges(:)
      real(dp) :: axis(2)
      integer :: i

      associate (obstacle => contact%obstacle)
         axis = unit_vector(obstacle%normal)
         if (obstacle%kind == 'polyline') then
            associate (line => obstacle%line, n => size(obstacle%line, 2))
               allocate (bulges(n), source=.true.)
               do i = 2, n - 1
                  bulges(i) = cross_product(line(:, i) - line(:, i - 1), line(:, i + 1) - line(:, i)) < 0.0_dp
               end do
               allocate (corners(2, count(bulges)))
               corners(1, :) = obstacle%point(1) + pack(axis(2)*line(1, :) + axis(1)*line(2, :), bulges)
               corners(2, :) = obstacle%point(2) + pack(axis(2)*line(2, :) - axis(1)*line(1, :), bulges)
            end associate
         else if (obstacle%has_radius() .and. obstacle%radius > 0.0_dp) then
            corners = reshape(obstacle%point, [2, 1])
         else
            allocate (corners(2, 0))
         end if
      end associate
   end function corners_of

   !> How deep a surface may reach into a side between the two nodes beside a place: half their distance times the
   !> tangent of half the angle between the surface's directions opposite to them, the height of the triangle of its
   !> tangents; the overlap of the nodes; and how much farther one of them moves than the other [L].
   pure real(dp) function resolved_depth(contact, side, moved, normal, xi, has_middle) result(depth)
      type(contact_t), intent(in) :: contact !! the contact set
      real(dp), intent(in) :: side(2, 3) !! first corner, second corner, middle of the side [L]
      real(dp), intent(in) :: moved(2, 3) !! the same, displaced along the normal [L]
      real(dp), intent(in) :: normal(2) !! normal of the side [-]
      real(dp), intent(in) :: xi !! the place on it, from -1 to 1 [-]
      logical, intent(in) :: has_middle !! whether the side has a node in its middle
      real(dp) :: gap, cosine, angle
      logical :: is_met
      integer :: beside(2), i

      beside = [1, 2]
      if (has_middle) beside(merge(2, 1, xi < 0.0_dp)) = 3
      depth = 0.0_dp
      angle = 0.0_dp
      do i = 1, 2
         call contact%obstacle%measure(side(:, beside(i)), normal, gap, is_met, cosine)
         if (.not. is_met) cycle
         angle = angle + acos(min(1.0_dp, cosine))
         depth = max(depth, dot_product(moved(:, beside(i)) - side(:, beside(i)), normal) - gap)
      end do
      ! Across an edge of the obstacle one node stands, and the other one sinks.
      associate (way => moved(:, beside) - side(:, beside))
         depth = depth + 0.5_dp*norm2(side(:, beside(2)) - side(:, beside(1)))*tan(0.5_dp*angle) &
            + abs(dot_product(way(:, 2) - way(:, 1), normal))
      end associate
   end function resolved_depth

   !> Whether a point lies in an element of a mesh, its sides taken straight.
   pure logical function is_inside(mesh, point)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: point(2) !! the point [L]
      integer :: element, i, n

      is_inside = .true.
      do element = 1, mesh%n_elements
         n = n_corners(mesh%element_kind(element))
         associate (nodes => mesh%node(mesh%node_start(element):mesh%node_start(element) + n - 1))
            do i = 1, n
               associate (begin => mesh%coordinates(:, nodes(i)))
                  if (cross_product(mesh%coordinates(:, nodes(mod(i, n) + 1)) - begin, point - begin) < 0.0_dp) exit
               end associate
            end do
            if (i > n) return
         end associate
      end do
      is_inside = .false.
   end function is_inside

end module amontons_obstacle_corners
