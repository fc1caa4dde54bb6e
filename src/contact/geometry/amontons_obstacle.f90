!> Rigid obstacles, each given by a point and a normal: plane, circle, parabola and polyline in the plane; plane,
!> sphere, cylinder and paraboloid in space, where a surface of triangles is another one.
!>
!> In the frame of an obstacle h is the last coordinate, along its normal, towards the body, and s are those across it:
!> in the plane along (n_y, -n_x), in space any two, of a cylinder the second along its axis. An obstacle with a
!> positive radius is convex (a punch), one with a negative radius concave (a seat).
!>
!> An obstacle is solid behind its surface and free in front of it. Gaps follow, by the same rule for every kind, from
!> the positions where a line along the normal of the body enters and leaves the obstacle. A polyline or surface must
!> not cross itself, since no side of it would then be the inside.
module amontons_obstacle
   use amontons_dense, only: vector_product
   use amontons_integer_list, only: integer_list_t
   use amontons_kinds, only: dp
   use amontons_rounding, only: computed_rounding, sum_rounding
   use amontons_triangulation, only: next_corner, triangulation_t
   implicit none (type, external)
   private

   public :: cross_product, find_self_crossing, obstacle_dimensions, obstacle_names, obstacle_t, &
      steepest_cosine, unit_vector

   !> Kinds of obstacles, as a deck writes them.
   character(10), parameter :: obstacle_names(*) = [character(10) :: 'plane', 'circle', 'parabola', 'polyline', &
      'sphere', 'cylinder', 'paraboloid', 'surface']

   !> A rigid obstacle. In the plane the third numbers of its vectors have no meaning.
   type :: obstacle_t
      character(10) :: kind = 'plane' !! one of `obstacle_names`
      real(dp) :: point(3) = 0.0_dp !! origin of its frame: a point of its surface, or that of a file [L]
      real(dp) :: normal(3) = 0.0_dp
         !! direction of its outward normal there, of any length; all 0 for the last axis, y in the plane and z in space
         !! [-]
      real(dp) :: axis(3) = 0.0_dp !! direction of the axis of a cylinder, across the normal; any length but zero [-]
      real(dp) :: radius = 1.0_dp
         !! radius of curvature at the point, if the kind has one, of a cylinder across its axis; negative if hollow [L]
      real(dp), allocatable :: line(:, :) !! points (s, h) of a polyline, the free side on the left (2, points) [L]
      character(:), allocatable :: file !! the file of the polyline or surface; empty or not allocated without one
      character(:), allocatable :: part !! the set of this file that is the surface; empty or not allocated for all
      real(dp), allocatable :: inside(:) !! a point behind the surface; not allocated where the file tells its sides [L]
      type(triangulation_t) :: surface !! the surface, in coordinates from `point` on
   contains
      procedure :: approach => obstacle_approach
      procedure, private :: crossings => obstacle_crossings
      procedure :: depth => obstacle_depth
      procedure, private :: frame => obstacle_frame
      procedure :: given_normal => obstacle_given_normal
      procedure, private :: has_ends => obstacle_has_ends
      procedure :: has_radius => obstacle_has_radius
      procedure, private :: is_passed => obstacle_is_passed
      procedure :: measure => obstacle_measure
      procedure :: outward => obstacle_outward
   end type obstacle_t

   !> Smallest cosine between a line and the normal of a surface at which a gap is measured. At a smaller one the length
   !> along the line is more than ten times the distance, and a slip changes it about ten times as much as an approach
   !> of the same length.
   real(dp), parameter :: steepest_cosine = 0.1_dp

   !> A position where a line crosses the surface of an obstacle.
   type :: crossing_t
      real(dp) :: way = 0.0_dp !! the way to it along the line, negative behind the start [L]
      real(dp) :: cosine = 0.0_dp
         !! of the angle between the line's way back and the outward normal: positive where the line enters [-]
      real(dp) :: sine = 0.0_dp !! of this angle, without sign [-]
      real(dp) :: outward(3) = 0.0_dp !! the outward normal there, in the frame of the search [-]
   end type crossing_t

   !> Number of segments in a bounding box: long lines are compared box by box first.
   integer, parameter :: n_in_box = 32

contains

   !> All positions where a line crosses the surface of the obstacle.
   pure function obstacle_crossings(self, position, direction) result(crossings)
      class(obstacle_t), intent(in) :: self !! the obstacle
      real(dp), intent(in) :: position(:) !! a point of the line (n_dim) [L]
      real(dp), intent(in) :: direction(:) !! its direction, a unit vector (n_dim) [-]
      type(crossing_t), allocatable :: crossings(:)
      real(dp) :: frame(size(position), size(position))
      real(dp), dimension(size(position)) :: x, e
      integer :: i

      frame = self%frame(size(position))
      x = matmul(transpose(frame), position - self%point(:size(position)))
      e = matmul(transpose(frame), direction)
      allocate (crossings(0))
      select case (self%kind)
      case ('circle', 'sphere')
         crossings = conic_crossings(self%radius, spread(1.0_dp, 1, size(x)), x, e)
      case ('parabola', 'paraboloid')
         crossings = conic_crossings(self%radius, [spread(1.0_dp, 1, size(x) - 1), 0.0_dp], x, e)
      case ('cylinder')
         crossings = conic_crossings(self%radius, [1.0_dp, 0.0_dp, 1.0_dp], x, e)
      case ('polyline')
         crossings = polyline_crossings(self%line, x, e)
      case ('surface')
         crossings = surface_crossings(self%surface, position - self%point, direction)
      case default
         associate (n => size(x))
            if (abs(e(n)) > sum_rounding) crossings = [crossing_t(-x(n)/e(n), -e(n), norm2(e(:n - 1)), &
               in_space([(0.0_dp, i=2, n), 1.0_dp]))]
         end associate
      end select
      if (self%kind == 'surface') return
      do i = 1, size(crossings)
         crossings(i)%outward(:size(x)) = matmul(frame, crossings(i)%outward(:size(x)))
      end do
   end function obstacle_crossings

   !> The positions where a line crosses a polyline; it enters the obstacle from the polyline's left side.
   pure function polyline_crossings(line, x, e) result(crossings)
      real(dp), intent(in) :: line(:, :) !! points of the polyline (2, points) [L]
      real(dp), intent(in) :: x(2) !! starting point of the line, in the frame [L]
      real(dp), intent(in) :: e(2) !! its direction, in the frame [-]
      type(crossing_t), allocatable :: crossings(:)
      real(dp) :: along(2), to_start(2), cross, place, near, way
      integer :: i

      allocate (crossings(0))
      do i = 1, size(line, 2) - 1
         along = line(:, i + 1) - line(:, i)
         cross = e(1)*along(2) - e(2)*along(1)
         to_start = line(:, i) - x
         ! Most segments lie on one side of the line.
         if (abs(to_start(1)*e(2) - to_start(2)*e(1) - 0.5_dp*cross) > 0.5_dp*abs(cross) &
            + sum_rounding*max(sum(abs(along)), maxval(abs(x)))) cycle
         if (.not. abs(cross) > sum_rounding*norm2(along)) cycle
         place = (to_start(1)*e(2) - to_start(2)*e(1))/cross
         near = sum_rounding*max(norm2(along), maxval(abs(x)))/norm2(along)
         if (place < -near .or. place > 1.0_dp + near) cycle
         way = (to_start(1)*along(2) - to_start(2)*along(1))/cross
         ! At their common end two segments are crossed at the same position.
         if (abs(place*(1.0_dp - place)) <= near) way = dot_product(line(:, merge(i, i + 1, place < 0.5_dp)) - x, e)
         crossings = [crossings, crossing_t(way, cross/norm2(along), abs(dot_product(e, along))/norm2(along), &
            [-along(2), along(1), 0.0_dp]/norm2(along))]
      end do
   end function polyline_crossings

   !> The positions where a line crosses a surface of triangles; it enters the obstacle from their free side.
   pure function surface_crossings(surface, x, e) result(crossings)
      type(triangulation_t), intent(in) :: surface !! the surface
      real(dp), intent(in) :: x(3) !! starting point of the line [L]
      real(dp), intent(in) :: e(3) !! its direction, a unit vector [-]
      type(crossing_t), allocatable :: crossings(:)
      type(integer_list_t) :: near
      real(dp) :: p(3, 3), height(3), along(3), inward(3), share, way, reach
      integer :: i, k, edge, ends(2)

      allocate (crossings(0))
      reach = surface%rounding + sum_rounding*maxval(abs(x))
      call surface%find_near(x, e, reach, near)
      do i = 1, near%n
         associate (normal => surface%normal(:, near%item(i)), corner => surface%corner(:, near%item(i)))
            if (.not. abs(dot_product(normal, e)) > sum_rounding) cycle
            ! Along the line, and across it.
            p = surface%vertex(:, corner) - spread(x, 2, 3)
            height = matmul(e, p)
            do k = 1, 3
               p(:, k) = p(:, k) - height(k)*e
            end do
            do k = 1, 3
               along = p(:, next_corner(k)) - p(:, k)
               inward(k) = sign(1.0_dp, dot_product(normal, e))*dot_product(vector_product(p(:, k), along), e) &
                  /max(norm2(along), reach)
            end do
            if (any(inward < -reach)) cycle
            way = dot_product(normal, height(1)*e + p(:, 1))/dot_product(normal, e)
            ! At a common edge or corner triangles are crossed at the same position.
            if (any(inward <= reach)) then
               edge = minloc(inward, dim=1)
               ends = [edge, next_corner(edge)]
               if (corner(ends(1)) > corner(ends(2))) ends = ends(2:1:-1)
               along = p(:, ends(2)) - p(:, ends(1))
               share = min(1.0_dp, max(0.0_dp, -dot_product(p(:, ends(1)), along)/dot_product(along, along)))
               way = height(ends(1)) + share*(height(ends(2)) - height(ends(1)))
               if (count(inward <= reach) > 1) way = height(minloc(norm2(p, dim=1), dim=1))
            end if
            if (abs(way) <= reach) way = 0.0_dp
            crossings = [crossings, crossing_t(way, -dot_product(normal, e), sine(e, normal), normal)]
         end associate
      end do
   end function surface_crossings

   !> Depth of a point in the obstacle, measured along the obstacle's normal: back to where the line entered or, at a
   !> concave surface, forward to where it leaves; behind a steep flank the distance to it; 0 in free space [L].
   pure real(dp) function obstacle_depth(self, position) result(depth)
      class(obstacle_t), intent(in) :: self !! the obstacle
      real(dp), intent(in) :: position(:) !! the point (n_dim) [L]
      type(crossing_t), allocatable :: crossings(:)
      real(dp) :: direction(size(position)), gap, cosine
      logical :: is_met, is_beyond
      integer :: first

      direction = -self%outward(size(position))
      call self%measure(position, direction, gap, is_met, cosine)
      depth = max(0.0_dp, -gap)
      ! Behind a steep flank the distance from the flank counts, not the length up to its upper end.
      if (.not. is_met) depth = depth*cosine
      if (self%kind == 'surface' .and. gap < 0.0_dp) call self%surface%find_nearest(position - self%point, -gap, &
         depth, is_beyond)
      if (is_met .or. depth > 0.0_dp .or. self%has_ends()) return
      crossings = self%crossings(position, direction)
      if (size(crossings) == 0) return
      ! A line whose first crossing leaves the obstacle has begun inside.
      first = minloc(crossings%way, dim=1)
      if (crossings(first)%cosine < 0.0_dp) depth = max(0.0_dp, crossings(first)%way)
   end function obstacle_depth

   !> The number of dimensions of the bodies that a kind of obstacle is for, 0 for any.
   elemental integer function obstacle_dimensions(kind) result(n_dim)
      character(*), intent(in) :: kind !! one of `obstacle_names`

      select case (kind)
      case ('circle', 'parabola', 'polyline')
         n_dim = 2
      case ('sphere', 'cylinder', 'paraboloid', 'surface')
         n_dim = 3
      case default
         n_dim = 0
      end select
   end function obstacle_dimensions

   !> The outward unit normal at the obstacle's point [-].
   pure function obstacle_outward(self, n_dim) result(normal)
      class(obstacle_t), intent(in) :: self !! the obstacle
      integer, intent(in) :: n_dim !! number of dimensions
      real(dp) :: normal(n_dim)

      normal = unit_vector(self%given_normal(n_dim))
   end function obstacle_outward

   !> The direction of the normal as it was given, of any length; the last axis without one [-].
   pure function obstacle_given_normal(self, n_dim) result(normal)
      class(obstacle_t), intent(in) :: self !! the obstacle
      integer, intent(in) :: n_dim !! number of dimensions
      real(dp) :: normal(n_dim)

      normal = self%normal(:n_dim)
      if (.not. any(abs(normal) > 0.0_dp)) normal(n_dim) = 1.0_dp
   end function obstacle_given_normal

   !> The axes of the obstacle's frame as columns, the last one its normal (n_dim, n_dim) [-].
   pure function obstacle_frame(self, n_dim) result(frame)
      class(obstacle_t), intent(in) :: self !! the obstacle
      integer, intent(in) :: n_dim !! number of dimensions
      real(dp) :: frame(n_dim, n_dim), axis(3)

      associate (normal => self%outward(n_dim))
         frame(:, n_dim) = normal
         if (n_dim == 2) then
            frame(:, 1) = [normal(2), -normal(1)]
         else
            ! What is a body of revolution about its normal has any axis across it, the one nearest to it here.
            axis = 0.0_dp
            axis(minloc(abs(normal), dim=1)) = 1.0_dp
            if (self%kind == 'cylinder') axis = self%axis
            frame(:, 1) = unit_vector(vector_product(axis, normal))
            frame(:, 2) = vector_product(normal, frame(:, 1))
         end if
      end associate
   end function obstacle_frame

   !> Whether the surface of the obstacle has ends, beyond which inside and outside are not defined.
   pure logical function obstacle_has_ends(self) result(has_ends)
      class(obstacle_t), intent(in) :: self !! the obstacle
      integer :: n

      has_ends = .false.
      if (self%kind == 'surface') has_ends = self%surface%has_ends
      if (self%kind /= 'polyline') return
      n = size(self%line, 2)
      has_ends = norm2(self%line(:, n) - self%line(:, 1)) > sum_rounding*maxval(abs(self%line))
   end function obstacle_has_ends

   !> Whether a point lies beyond an end of the surface: the nearest position of the surface is an end.
   pure logical function obstacle_is_passed(self, position, reach) result(is_passed)
      class(obstacle_t), intent(in) :: self !! the obstacle
      real(dp), intent(in) :: position(:) !! the point (n_dim) [L]
      real(dp), intent(in) :: reach !! a bound of its distance from the surface [L]
      real(dp) :: x(size(position)), share, nearest, distance
      integer :: i, n

      is_passed = .false.
      if (self%kind == 'surface') call self%surface%find_nearest(position - self%point, reach, distance, is_passed)
      if (self%kind == 'surface' .or. .not. self%has_ends()) return
      x = matmul(transpose(self%frame(size(x))), position - self%point(:size(x)))
      n = size(self%line, 2) - 1
      nearest = huge(nearest)
      do i = 1, n
         associate (start => self%line(:, i), along => self%line(:, i + 1) - self%line(:, i))
            if (.not. any(abs(along) > 0.0_dp)) cycle
            share = dot_product(x - start, along)/dot_product(along, along)
            distance = norm2(x - start - min(1.0_dp, max(0.0_dp, share))*along)
         end associate
         if (.not. distance < nearest) cycle
         nearest = distance
         is_passed = (i == 1 .and. share < -sum_rounding) .or. (i == n .and. share > 1.0_dp + sum_rounding)
      end do
   end function obstacle_is_passed

   !> Whether an obstacle of this kind has a radius.
   pure logical function obstacle_has_radius(self) result(has_radius)
      class(obstacle_t), intent(in) :: self !! the obstacle

      has_radius = all(self%kind /= [character(10) :: 'plane', 'polyline', 'surface'])
   end function obstacle_has_radius

   !> The unit vector along a nonzero vector, whose square may overflow or underflow [-].
   pure function unit_vector(vector)
      real(dp), intent(in) :: vector(:) !! the vector (n_dim)
      real(dp) :: unit_vector(size(vector))

      unit_vector = vector/maxval(abs(vector))
      unit_vector = unit_vector/norm2(unit_vector)
   end function unit_vector

   !> The positions where a line crosses F = h + (sum of w x^2)/(2 R) = 0, x the coordinates (s, h) and w the weights of
   !> their squares: all 1 for a circle or sphere, 0 for h of a parabola or paraboloid, 0 for s along the axis of a
   !> cylinder; F is positive on the free side.
   pure function conic_crossings(radius, w, x, e) result(crossings)
      real(dp), intent(in) :: radius !! the radius of curvature R; negative if hollow [L]
      real(dp), intent(in) :: w(:) !! the weights (n_dim) [-]
      real(dp), intent(in) :: x(:) !! starting point of the line, in the frame (n_dim) [L]
      real(dp), intent(in) :: e(:) !! its direction, in the frame, a unit vector (n_dim) [-]
      type(crossing_t), allocatable :: crossings(:)
      ! A root farther away than this many lengths does not count.
      real(dp), parameter :: far = 1.0e100_dp
      real(dp) :: length, start(size(x)), height, square, linear, constant, root, q
      integer :: n

      n = size(x)
      allocate (crossings(0))
      ! Lengths are divided by the largest one, so that no square overflows or underflows.
      length = max(maxval(abs(x)), 2.0_dp*abs(radius))
      start = x/length
      height = 2.0_dp*radius/length
      ! 2 R F along the line is square t^2 + linear t + constant.
      square = sum(w*e**2)
      linear = height*e(n) + 2.0_dp*sum(w*start*e)
      constant = sum([height*start(n), w*start**2])
      root = linear**2 - 4.0_dp*square*constant
      if (.not. root > 0.0_dp) return
      ! Its slopes at the zeros are root and -root; of the two formulas for each zero the one without cancellation is
      ! used.
      root = sign(sqrt(root), linear)
      q = -0.5_dp*(linear + root)
      if (abs(q) > 0.0_dp) crossings = [zero_crossing(constant/q, root)]
      if (abs(q) < far*square) crossings = [crossings, zero_crossing(q/square, -root)]

   contains

      !> The crossing at a zero of 2 R F with a slope.
      pure type(crossing_t) function zero_crossing(way, slope) result(crossing)
         real(dp), intent(in) :: way !! the way to it, in `length` [-]
         real(dp), intent(in) :: slope !! slope there [-]
         real(dp) :: gradient(size(x))

         gradient = 2.0_dp*w*(start + way*e)
         gradient(n) = gradient(n) + height
         crossing = crossing_t(length*way, -slope*sign(1.0_dp, radius)/norm2(gradient), sine(e, gradient), &
            in_space(sign(1.0_dp, radius)/norm2(gradient)*gradient))
      end function zero_crossing

   end function conic_crossings

   !> A vector with three components, the last one 0 in the plane.
   pure function in_space(vector)
      real(dp), intent(in) :: vector(:) !! the vector (n_dim)
      real(dp) :: in_space(3)

      in_space = 0.0_dp
      in_space(:size(vector)) = vector
   end function in_space

   !> The sine of the angle between a unit vector and another vector, from 0 to 1 [-].
   pure real(dp) function sine(e, vector)
      real(dp), intent(in) :: e(:) !! the unit vector (n_dim) [-]
      real(dp), intent(in) :: vector(:) !! the other vector (n_dim)

      if (size(e) == 2) then
         sine = abs(cross_product(e, vector))/norm2(vector)
      else
         sine = norm2(vector_product(e, vector))/norm2(vector)
      end if
   end function sine

   !> The gap from a point along a direction. In free space it is the distance to the first position ahead where the
   !> line enters; inside it is minus the distance back to the position where the line entered last. A line that does
   !> not enter, or enters at too small a cosine, has no gap. Beyond the end of a polyline no point is inside.
   pure subroutine obstacle_measure(self, position, direction, gap, is_met, cosine, angle, outward)
      class(obstacle_t), intent(in) :: self !! the obstacle
      real(dp), intent(in) :: position(:) !! the point (n_dim) [L]
      real(dp), intent(in) :: direction(:) !! the direction, a unit vector (n_dim) [-]
      real(dp), intent(out) :: gap !! the gap [L]
      logical, intent(out) :: is_met !! whether there is one
      real(dp), intent(out) :: cosine !! of the angle between the direction and the way into the surface there [-]
      real(dp), intent(out), optional :: angle !! this angle, whose cosine loses the digits of small ones [-]
      real(dp), intent(out), optional :: outward(:) !! the outward normal there; -direction without a gap (n_dim) [-]
      type(crossing_t), allocatable :: crossings(:)
      integer :: found

      crossings = self%crossings(position, direction)
      if (any(.not. crossings%way > 0.0_dp .and. crossings%cosine > 0.0_dp)) then
         if (self%is_passed(position, minval(abs(crossings%way)))) crossings = pack(crossings, crossings%way > 0.0_dp)
      end if
      found = find_entry(crossings)
      gap = 0.0_dp
      cosine = 0.0_dp
      if (present(outward)) outward = -direction
      if (found > 0) then
         if (present(outward)) outward = crossings(found)%outward(:size(outward))
         gap = crossings(found)%way
         cosine = crossings(found)%cosine
         if (present(angle)) angle = atan2(crossings(found)%sine, cosine)
      end if
      is_met = cosine >= steepest_cosine
   end subroutine obstacle_measure

   !> The gap from a point along the normal of the obstacle: the directions from which it is measured follow the
   !> normals at their feet, so that the last one is that of the nearest position as the gap closes.
   pure subroutine obstacle_approach(self, position, direction, gap, is_met)
      class(obstacle_t), intent(in) :: self !! the obstacle
      real(dp), intent(in) :: position(:) !! the point (n_dim) [L]
      real(dp), intent(inout) :: direction(:)
         !! a direction towards the obstacle, a unit vector; that opposite to its normal on return (n_dim) [-]
      real(dp), intent(out) :: gap !! the gap along it [L]
      logical, intent(out) :: is_met !! whether there is one
      integer, parameter :: n_steps = 8
      real(dp) :: outward(size(direction)), cosine
      integer :: step

      do step = 1, n_steps
         call self%measure(position, direction, gap, is_met, cosine, outward=outward)
         if (.not. is_met .or. norm2(direction + outward) <= computed_rounding) exit
         direction = -outward
      end do
   end subroutine obstacle_approach

   !> The crossing where a line entered the obstacle that its start is in, or where it enters next; 0 if there is none.
   !> There is none either for a start on a surface that the line leaves there: the points behind the start lie inside.
   pure integer function find_entry(crossings) result(found)
      type(crossing_t), intent(in) :: crossings(:) !! the crossings of the line with the surface
      logical :: is_here(size(crossings)), enters(size(crossings))
      integer :: last, next

      found = 0
      enters = crossings%cosine > 0.0_dp
      associate (way => crossings%way)
         ! The start lies on a surface that it faces away from.
         is_here = abs(way) <= computed_rounding*maxval(abs(way))
         if (any(is_here .and. .not. enters)) then
            ! If the line enters and leaves a tip at the same position, its start is outside.
            found = minloc(abs(way), dim=1, mask=is_here .and. enters)
            return
         end if
         next = minloc(way, dim=1, mask=enters .and. way > 0.0_dp)
         if (next > 0) then
            if (way(next) <= minval(way, mask=way > 0.0_dp)) found = next
         end if
         last = maxloc(way, dim=1, mask=enters .and. way <= 0.0_dp)
         if (last > 0) then
            if (way(last) > maxval(way, mask=way <= 0.0_dp .and. .not. enters)) found = last
         end if
         ! At a corner of a polyline the line meets the segment that faces it more.
         if (found > 0) found = maxloc(crossings%cosine, dim=1, mask=abs(way - way(found)) &
            <= computed_rounding*maxval(abs(way)))
      end associate
   end function find_entry

   !> Finds a position where two segments of a polyline cross. Segments that only touch or overlap do not cross.
   pure subroutine find_self_crossing(line, crosses, place)
      real(dp), intent(in) :: line(:, :) !! the points (2, points) [L]
      logical, intent(out) :: crosses !! whether there is such a place
      real(dp), intent(out) :: place(2) !! the first that was found; 0, 0 without one [L]
      real(dp), allocatable :: box(:, :, :)
      integer :: i, k, n, n_boxes, last, first, second

      n = size(line, 2) - 1
      n_boxes = (n + n_in_box - 1)/n_in_box
      allocate (box(2, 2, n_boxes))
      do i = 1, n_boxes
         last = min(i*n_in_box, n) + 1
         box(:, 1, i) = minval(line(:, (i - 1)*n_in_box + 1:last), dim=2)
         box(:, 2, i) = maxval(line(:, (i - 1)*n_in_box + 1:last), dim=2)
      end do
      crosses = .false.
      place = 0.0_dp
      do i = 1, n_boxes
         do k = i, n_boxes
            if (any(box(:, 1, k) > box(:, 2, i)) .or. any(box(:, 1, i) > box(:, 2, k))) cycle
            do first = (i - 1)*n_in_box + 1, min(i*n_in_box, n)
               do second = max((k - 1)*n_in_box + 1, first + 2), min(k*n_in_box, n)
                  associate (p => line(:, first), a => line(:, first + 1) - line(:, first), &
                     q => line(:, second), b => line(:, second + 1) - line(:, second))
                     if (.not. (separates(p, a, q, q + b) .and. separates(q, b, p, p + a))) cycle
                     crosses = .true.
                     place = p + a*cross_product(q - p, b)/cross_product(a, b)
                     return
                  end associate
               end do
            end do
         end do
      end do
   end subroutine find_self_crossing

   !> Whether the line through a segment has two points on either side of it.
   pure logical function separates(start, along, a, b)
      real(dp), intent(in) :: start(2) !! start of the segment [L]
      real(dp), intent(in) :: along(2) !! its way to the end [L]
      real(dp), intent(in) :: a(2) !! one point [L]
      real(dp), intent(in) :: b(2) !! the other one [L]
      real(dp) :: sides(2)

      sides = [cross_product(along, a - start), cross_product(along, b - start)]
      separates = minval(sides) < 0.0_dp .and. maxval(sides) > 0.0_dp .and. &
         minval(abs(sides)) > computed_rounding*norm2(along)*max(norm2(along), norm2(b - a))
   end function separates

   !> The third component of the cross product of two vectors.
   pure real(dp) function cross_product(a, b)
      real(dp), intent(in) :: a(2) !! the first
      real(dp), intent(in) :: b(2) !! the second

      cross_product = a(1)*b(2) - a(2)*b(1)
   end function cross_product

end module amontons_obstacle
