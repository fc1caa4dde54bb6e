!> A surface of triangles in space: where it ends, which side of it is free, and a tree of boxes that finds the
!> triangles near a line.
!>
!> The triangles are sorted along a curve that fills space (G. M. Morton, 1966), so that consecutive ones are near each
!> other. The boxes of the last level hold four of them each; children of box i are the boxes 2 i and 2 i + 1.
module amontons_triangulation
   use amontons_dense, only: vector_product
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_integer_list, only: fill_bins, integer_list_t, new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_rounding, only: sum_rounding
   use amontons_text, only: place_text
   implicit none (type, external)
   private

   public :: new_triangulation, next_corner, triangulation_t

   !> The corner behind each corner of a triangle.
   integer, parameter :: next_corner(3) = [2, 3, 1]
   !> Number of triangles in a box without children.
   integer, parameter :: n_in_box = 4

   !> A surface of triangles.
   type :: triangulation_t
      real(dp), allocatable :: vertex(:, :) !! the vertices, no two of them at the same place (3, vertices) [L]
      integer, allocatable :: corner(:, :)
         !! vertices of each triangle, counterclockwise seen from the free side (3, triangles)
      real(dp), allocatable :: normal(:, :)
         !! unit normals to the free side; 0 for a triangle without an area, which only joins others (3, triangles) [-]
      logical, allocatable, private :: is_end(:, :)
         !! whether the surface ends at the edge from each corner to the next (3, triangles)
      logical :: has_ends = .false. !! whether there is such an edge
      real(dp) :: rounding = 0.0_dp !! what rounding leaves of a distance that should be 0 [L]
      real(dp), allocatable, private :: box(:, :, :) !! smallest and largest coordinates in each box (3, 2, boxes) [L]
   contains
      procedure :: find_near => triangulation_find_near
      procedure :: find_nearest => triangulation_find_nearest
   end type triangulation_t

contains

   !> Makes a surface of triangles. Corners at the same place are joined; a triangle with two of them there is left out.
   pure subroutine new_triangulation(surface, place, error, inside)
      type(triangulation_t), intent(out) :: surface !! the surface
      real(dp), intent(in) :: place(:, :) !! places of the corners, three after three (3, 3 triangles) [L]
      type(error_t), allocatable, intent(out) :: error !! there is no triangle, or they have no common free side
      real(dp), intent(in), optional :: inside(:)
         !! a point behind each piece of the surface (3); without it the free side of a triangle is that from which its
         !! corners are counterclockwise [L]
      integer, allocatable :: twin(:, :)
      integer :: n, node, n_leaves, t
      real(dp) :: normal(3), extent

      call join_corners(surface, place)
      n = size(surface%corner, 2)
      if (n == 0) call new_error(error, input_refused, 'no triangle has three corners at different places')
      if (n > 0) call find_twins(surface, twin, error)
      if (.not. allocated(error)) call orient(surface, twin, error, inside)
      if (allocated(error)) return
      extent = maxval(maxval(surface%vertex, dim=2) - minval(surface%vertex, dim=2))
      surface%rounding = sum_rounding*maxval(abs(surface%vertex))
      n_leaves = 1
      do while (n_leaves*n_in_box < n)
         n_leaves = 2*n_leaves
      end do
      allocate (surface%box(3, 2, 2*n_leaves - 1), source=huge(1.0_dp))
      surface%box(:, 2, :) = -huge(1.0_dp)
      allocate (surface%normal(3, n), source=0.0_dp)
      do t = 1, n
         associate (p => surface%vertex(:, surface%corner(:, t)), box => surface%box(:, :, n_leaves + (t - 1)/n_in_box))
            box(:, 1) = min(box(:, 1), minval(p, dim=2))
            box(:, 2) = max(box(:, 2), maxval(p, dim=2))
            normal = vector_product(p(:, 2) - p(:, 1), p(:, 3) - p(:, 1))
            if (norm2(normal) > surface%rounding*extent) surface%normal(:, t) = normal/norm2(normal)
         end associate
      end do
      associate (box => surface%box)
         do node = n_leaves - 1, 1, -1
            box(:, 1, node) = min(box(:, 1, 2*node), box(:, 1, 2*node + 1))
            box(:, 2, node) = max(box(:, 2, 2*node), box(:, 2, 2*node + 1))
         end do
      end associate
   end subroutine new_triangulation

   !> Joins corners whose coordinates agree in the digits of an integer, and sorts the triangles.
   pure subroutine join_corners(surface, place)
      type(triangulation_t), intent(inout) :: surface !! gains vertices and corners
      real(dp), intent(in) :: place(:, :) !! places of the corners, three after three (3, 3 triangles) [L]
      integer, parameter :: n_bits = 10
      integer, allocatable :: tag(:, :), order(:), vertex(:), key(:), corner(:, :)
      type(tag_map_t) :: map
      real(dp) :: low(3), extent
      integer :: axis, bit, i, n

      low = minval(place, dim=2)
      extent = max(tiny(extent), maxval(maxval(place, dim=2) - low))
      allocate (tag(3, size(place, 2)), vertex(size(place, 2)))
      allocate (key(size(place, 2)/3), source=0)
      order = [(i, i=1, size(vertex))]
      do axis = 1, 3
         tag(axis, :) = int((place(axis, :) - low(axis))/extent*huge(1))
         call new_tag_map(map, tag(axis, order))
         order = order(map%item)
         ! The highest bits of the coordinates in turn are those of the way along the curve.
         do bit = 0, n_bits - 1
            where (btest(tag(axis, 1::3), bit_size(1) - 1 - n_bits + bit)) key = ibset(key, 3*bit + axis - 1)
         end do
      end do
      n = 0
      do i = 1, size(order)
         if (n > 0) n = n + merge(1, 0, any(tag(:, order(i)) /= tag(:, order(i - 1))))
         n = max(n, 1)
         vertex(order(i)) = n
      end do
      allocate (surface%vertex(3, n))
      do i = 1, size(order)
         surface%vertex(:, vertex(i)) = place(:, i)
      end do
      call new_tag_map(map, key)
      corner = reshape(vertex, [3, size(key)])
      corner = corner(:, map%item)
      surface%corner = corner(:, pack([(i, i=1, size(key))], all(corner /= corner(next_corner, :), dim=1)))
   end subroutine join_corners

   !> Finds the other edge between the same vertices for each edge of a triangle; an end of the surface has none.
   pure subroutine find_twins(surface, twin, error)
      type(triangulation_t), intent(inout) :: surface !! the surface; gains its ends
      integer, allocatable, intent(out) :: twin(:, :)
         !! that edge, its number counted over all triangles; 0 for none (3, triangles)
      type(error_t), allocatable, intent(out) :: error !! more than two triangles have an edge
      integer, allocatable :: ends(:, :), start(:), by_upper(:), order(:), of_edge(:)
      integer :: i, n

      n = size(surface%corner)
      ends = reshape([min(surface%corner, surface%corner(next_corner, :)), &
         max(surface%corner, surface%corner(next_corner, :))], [n, 2])
      call fill_bins(start, by_upper, ends(:, 2), size(surface%vertex, 2))
      call fill_bins(start, order, ends(by_upper, 1), size(surface%vertex, 2))
      order = by_upper(order)
      allocate (of_edge(n), source=0)
      do i = 2, n
         associate (edge => order(i), before => order(i - 1))
            if (any(ends(edge, :) /= ends(before, :))) cycle
            if (of_edge(before) > 0) then
               call new_error(error, input_refused, 'more than two triangles have the edge from '//place_text( &
                  surface%vertex(:, ends(edge, 1)))//' to '//place_text(surface%vertex(:, ends(edge, 2))))
               return
            end if
            of_edge([edge, before]) = [before, edge]
         end associate
      end do
      twin = reshape(of_edge, [3, n/3])
      surface%is_end = twin == 0
      surface%has_ends = any(surface%is_end)
   end subroutine find_twins

   !> Turns the triangles so that their corners are counterclockwise seen from the free side, from neighbor to neighbor.
   pure subroutine orient(surface, twin, error, inside)
      type(triangulation_t), intent(inout) :: surface !! the surface
      integer, intent(in) :: twin(:, :) !! the other edge at each edge, 0 for none (3, triangles)
      type(error_t), allocatable, intent(out) :: error !! the triangles have no common free side
      real(dp), intent(in), optional :: inside(:) !! a point behind each piece (3); none to leave them as they are [L]
      logical, allocatable :: is_turned(:), is_met(:)
      type(integer_list_t) :: piece
      integer :: i, k, seed, t, other
      logical :: turns

      allocate (is_turned(size(twin, 2)), is_met(size(twin, 2)), source=.false.)
      do seed = 1, size(twin, 2)
         if (is_met(seed)) cycle
         piece%n = 0
         call piece%append(seed)
         i = 0
         do while (i < piece%n)
            i = i + 1
            t = piece%item(i)
            is_met(t) = .true.
            do k = 1, 3
               if (twin(k, t) == 0) cycle
               other = (twin(k, t) + 2)/3
               ! Edges of two triangles with the same free side lead in opposite directions.
               turns = is_turned(t) .neqv. surface%corner(k, t) == surface%corner(twin(k, t) - 3*(other - 1), other)
               if (.not. is_met(other)) then
                  is_met(other) = .true.
                  is_turned(other) = turns
                  call piece%append(other)
               end if
               if ((is_turned(other) .eqv. turns) .and. (present(inside) .or. .not. turns)) cycle
               call new_error(error, input_refused, 'the triangles at the edge from '//place_text(surface%vertex(:, &
                  surface%corner(k, t)))//' to '//place_text(surface%vertex(:, surface%corner(next_corner(k), t)))// &
                  trim(merge(' have no common free side: the surface is twisted          ', &
                  ' are turned against each other; give inside, a point behind', present(inside))))
               return
            end do
         end do
         if (.not. present(inside)) cycle
         if (is_behind(surface, piece%items(), is_turned, inside)) cycle
         is_turned(piece%items()) = .not. is_turned(piece%items())
      end do
      do t = 1, size(twin, 2)
         if (.not. is_turned(t)) cycle
         surface%corner(:, t) = surface%corner([1, 3, 2], t)
         surface%is_end(:, t) = surface%is_end([3, 2, 1], t)
      end do
   end subroutine orient

   !> Whether a point is behind a piece of the surface: the normals lead away from it, in the mean over solid angles; a
   !> closed piece that does not contain it must be hollow.
   pure logical function is_behind(surface, triangles, is_turned, point)
      type(triangulation_t), intent(in) :: surface !! the surface
      integer, intent(in) :: triangles(:) !! the triangles of the piece
      logical, intent(in) :: is_turned(:) !! which triangles have their corners in the other order
      real(dp), intent(in) :: point(:) !! the point (3) [L]
      real(dp) :: angle, volume, p(3, 3), length(3), determinant
      integer :: i

      angle = 0.0_dp
      volume = 0.0_dp
      do i = 1, size(triangles)
         p = surface%vertex(:, surface%corner(:, triangles(i))) - spread(point, 2, 3)
         length = norm2(p, dim=1)
         determinant = merge(-1.0_dp, 1.0_dp, is_turned(triangles(i))) &
            *dot_product(p(:, 1), vector_product(p(:, 2), p(:, 3)))
         volume = volume + determinant
         ! A. van Oosterom, J. Strackee, The solid angle of a plane triangle, 1983, equation 8.
         angle = angle + 2.0_dp*atan2(determinant, product(length) + length(1)*dot_product(p(:, 2), p(:, 3)) &
            + length(2)*dot_product(p(:, 3), p(:, 1)) + length(3)*dot_product(p(:, 1), p(:, 2)))
      end do
      is_behind = angle > 0.0_dp
      ! That of a closed piece is 4 pi or 0.
      if (.not. any(surface%is_end(:, triangles)) .and. abs(angle) < 1.0_dp) is_behind = volume < 0.0_dp
   end function is_behind

   !> Finds the triangles whose boxes are within some reach of a line.
   pure subroutine triangulation_find_near(self, position, direction, reach, near)
      class(triangulation_t), intent(in) :: self !! the surface
      real(dp), intent(in) :: position(3) !! a point of the line [L]
      real(dp), intent(in) :: direction(3) !! its direction, a unit vector [-]
      real(dp), intent(in) :: reach !! how far the boxes may be away along each axis [L]
      type(integer_list_t), intent(out) :: near !! the triangles
      integer :: boxes(bit_size(1)), n, node, t
      real(dp) :: slope(3), low(3), high(3)

      slope = 1.0_dp/sign(max(abs(direction), sum_rounding), direction)
      boxes(1) = 1
      n = 1
      do while (n > 0)
         node = boxes(n)
         n = n - 1
         low = self%box(:, 1, node) - reach - position
         high = self%box(:, 2, node) + reach - position
         ! Some pairs of faces cut parts from the line that have nothing in common; an empty box has none.
         if (low(1) > high(1) .or. maxval(min(low*slope, high*slope)) > minval(max(low*slope, high*slope))) cycle
         if (2*node < size(self%box, 3)) then
            boxes(n + 1:n + 2) = [2*node, 2*node + 1]
            n = n + 2
         else
            associate (last => n_in_box*(node - size(self%box, 3)/2))
               call near%append_all([(t, t=last - n_in_box + 1, min(last, size(self%corner, 2)))])
            end associate
         end if
      end do
   end subroutine triangulation_find_near

   !> Finds the distance of a point from the surface.
   pure subroutine triangulation_find_nearest(self, position, reach, distance, is_beyond)
      class(triangulation_t), intent(in) :: self !! the surface
      real(dp), intent(in) :: position(3) !! the point [L]
      real(dp), intent(in) :: reach !! a bound of the distance [L]
      real(dp), intent(out) :: distance !! the distance [L]
      logical, intent(out) :: is_beyond !! whether the nearest place is an end of the surface, the point beyond it
      integer :: boxes(bit_size(1)), n, node, k, last, t
      real(dp) :: p(3, 3), along(3, 3), apart(3), share, way
      logical :: is_above

      distance = reach
      is_beyond = .false.
      boxes(1) = 1
      n = 1
      do while (n > 0)
         node = boxes(n)
         n = n - 1
         apart = max(0.0_dp, self%box(:, 1, node) - position, position - self%box(:, 2, node))
         if (.not. norm2(apart) <= distance + self%rounding) cycle
         if (2*node < size(self%box, 3)) then
            boxes(n + 1:n + 2) = [2*node, 2*node + 1]
            n = n + 2
            cycle
         end if
         last = n_in_box*(node - size(self%box, 3)/2)
         do t = last - n_in_box + 1, min(last, size(self%corner, 2))
            p = self%vertex(:, self%corner(:, t)) - spread(position, 2, 3)
            along = p(:, next_corner) - p
            is_above = any(abs(self%normal(:, t)) > 0.0_dp) .and. all([(dot_product(vector_product(p(:, k), &
               along(:, k)), self%normal(:, t)), k=1, 3)] >= -self%rounding*norm2(along, dim=1))
            do k = 1, 3
               share = -dot_product(p(:, k), along(:, k))/dot_product(along(:, k), along(:, k))
               way = norm2(p(:, k) + min(1.0_dp, max(0.0_dp, share))*along(:, k))
               if (is_above) way = abs(dot_product(p(:, k), self%normal(:, t)))
               ! A vertex is an end if any edge there is one.
               is_beyond = way < distance + self%rounding .and. self%is_end(k, t) .and. .not. is_above .or. &
                  is_beyond .and. way > distance - self%rounding
               distance = min(distance, way)
            end do
         end do
      end do
   end subroutine triangulation_find_nearest

end module amontons_triangulation
