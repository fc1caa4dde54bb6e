!> The segments of a pair of surfaces: the parts of slave sides that face one and the same side of the master.
!>
!> A point of the slave meets the master where the ray along its normal does, ahead or behind. A side of the master
!> counts if its outward normal faces the slave's, which keeps a thin body from meeting the master's far side, and if it
!> is within reach; of several the nearest counts. Segments end where a ray meets a corner of the master, so that
!> integrals over them are those of smooth functions.
module amontons_mortar_segments
   use amontons_kinds, only: dp
   use amontons_obstacle, only: cross_product, steepest_cosine
   use amontons_surface, only: surface_place_t, surface_t
   implicit none (type, external)
   private

   public :: find_segments, meeting_t, meet_master, meet_side, mortar_segment_t, sides_near

   !> A part of a side of the slave.
   type :: mortar_segment_t
      integer :: slave = 0 !! number of the side of the slave
      integer :: master = 0 !! number of the side of the master that it faces
      real(dp) :: range(2) = 0.0_dp !! where it begins and ends on the slave's side, from -1 to 1 [-]
   end type mortar_segment_t

   !> Where a ray meets a side of the master.
   type :: meeting_t
      integer :: side = 0 !! number of the side; 0 where the ray meets none
      real(dp) :: xi = 0.0_dp !! the place on it, from -1 to 1 [-]
      real(dp) :: gap = 0.0_dp !! the way to it along the ray's direction, negative behind [L]
   end type meeting_t

contains

   !> Cuts the sides of the slave into segments, side by side, each from -1 to 1; parts that face nothing have none.
   pure subroutine find_segments(segments, slave, master, search)
      type(mortar_segment_t), allocatable, intent(out) :: segments(:) !! the segments
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      real(dp), intent(in) :: search !! how far a gap may reach, either way [L]
      type(meeting_t) :: meeting
      type(surface_place_t) :: middle
      integer, allocatable :: near(:)
      real(dp), allocatable :: ends(:)
      integer :: side, i, n

      allocate (segments(2*slave%n_sides + 2*master%n_sides))
      n = 0
      do side = 1, slave%n_sides
         near = sides_near(slave, side, master, search)
         if (size(near) == 0) cycle
         ends = breakpoints(slave, side, master, near)
         do i = 1, size(ends) - 1
            middle = slave%place(side, 0.5_dp*(ends(i) + ends(i + 1)))
            meeting = meet_master(master, near, middle, search)
            if (meeting%side == 0) cycle
            n = n + 1
            if (n > size(segments)) segments = [segments, segments]
            segments(n) = mortar_segment_t(side, meeting%side, ends(i:i + 1))
         end do
      end do
      segments = segments(:n)
   end subroutine find_segments

   !> The sides of the master whose boxes come within reach of that of a side of the slave.
   pure function sides_near(slave, side, master, search) result(near)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      type(surface_t), intent(in) :: master !! the master
      real(dp), intent(in) :: search !! how far a gap may reach, either way [L]
      integer, allocatable :: near(:)
      ! A curved side may bulge out of the box of its nodes by an eighth of its length at the most.
      real(dp), parameter :: bulge = 0.125_dp
      real(dp) :: low(2), high(2), reach
      logical :: is_near(master%n_sides)
      integer :: i

      reach = search + bulge*(slave%longest + master%longest)
      low = minval(slave%corner(:, :, side), dim=2) - reach
      high = maxval(slave%corner(:, :, side), dim=2) + reach
      do i = 1, master%n_sides
         is_near(i) = all(maxval(master%corner(:, :, i), dim=2) >= low .and. &
            minval(master%corner(:, :, i), dim=2) <= high)
      end do
      near = pack([(i, i=1, master%n_sides)], is_near)
   end function sides_near

   !> Where segments may end on a side of the slave: at its own ends, and where rays meet corners of the master's sides.
   pure function breakpoints(slave, side, master, near) result(ends)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      type(surface_t), intent(in) :: master !! the master
      integer, intent(in) :: near(:) !! the sides of the master to look at
      real(dp), allocatable :: ends(:)
      ! Places nearer to each other than this are one.
      real(dp), parameter :: sliver = 1.0e-8_dp
      real(dp), allocatable :: sorted(:)
      integer :: i, k
      real(dp) :: least

      allocate (sorted(0))
      do i = 1, size(near)
         do k = 1, 2
            ! A corner that the side before it has, too, is looked at there.
            if (k == 1 .and. any(master%side(2, near) == master%side(1, near(i)))) cycle
            sorted = [sorted, places_facing(slave, side, master%corner(:, k, near(i)))]
         end do
      end do
      ends = [-1.0_dp]
      do
         least = ends(size(ends)) + sliver
         if (.not. any(sorted > least .and. sorted < 1.0_dp - sliver)) exit
         ends = [ends, minval(sorted, mask=sorted > least)]
      end do
      ends = [ends, 1.0_dp]
   end function breakpoints

   !> The places of a side of the slave whose rays meet a point: changes of sign of a polynomial of degree 4 at most.
   pure function places_facing(slave, side, point) result(places)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      real(dp), intent(in) :: point(2) !! the point [L]
      real(dp), allocatable :: places(:)
      integer, parameter :: n_parts = 8
      real(dp) :: xi(0:n_parts), value(0:n_parts)
      integer :: i

      do i = 0, n_parts
         xi(i) = -1.0_dp + 2.0_dp*i/n_parts
         value(i) = aside(slave, side, point, xi(i))
      end do
      allocate (places(0))
      do i = 1, n_parts
         if (value(i - 1)*value(i) > 0.0_dp .or. .not. abs(value(i)) > 0.0_dp .and. i == n_parts) cycle
         if (.not. abs(value(i - 1)) > 0.0_dp .and. i == 1) cycle
         places = [places, zero_between(slave, side, point, xi(i - 1), xi(i), value(i - 1), value(i))]
      end do
   end function places_facing

   !> How far a point lies aside of the ray of a place on the slave, times the length of the normal there [L].
   pure real(dp) function aside(slave, side, point, xi)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      real(dp), intent(in) :: point(2) !! the point [L]
      real(dp), intent(in) :: xi !! the place, from -1 to 1 [-]
      type(surface_place_t) :: place

      place = slave%place(side, xi)
      aside = cross_product(point - place%position, place%normal)
   end function aside

   !> The place between two others whose ray meets a point: false position, one end's value halved where it stays
   !> (Illinois); on a straight side with one normal its first step is the last.
   pure real(dp) function zero_between(slave, side, point, low, high, value_low, value_high) result(xi)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: side !! number of its side
      real(dp), intent(in) :: point(2) !! the point [L]
      real(dp), intent(in) :: low !! the one place [-]
      real(dp), intent(in) :: high !! the other place [-]
      real(dp), intent(in) :: value_low !! how far the point lies aside there, of another sign than [L]
      real(dp), intent(in) :: value_high !! at the other place [L]
      integer, parameter :: most_steps = 60
      real(dp) :: a, b, f_a, f_b, f
      integer :: step

      a = low
      b = high
      f_a = value_low
      f_b = value_high
      xi = a
      if (.not. abs(f_a) > 0.0_dp) return
      do step = 1, most_steps
         xi = (a*f_b - b*f_a)/(f_b - f_a)
         f = aside(slave, side, point, xi)
         if (f*f_b < 0.0_dp) then
            a = b
            f_a = f_b
         else
            f_a = 0.5_dp*f_a
         end if
         if (.not. abs(f) > 0.0_dp .or. abs(b - xi) <= 2.0_dp*epsilon(1.0_dp)) return
         b = xi
         f_b = f
      end do
   end function zero_between

   !> Where the ray of a place on the slave meets the master.
   pure type(meeting_t) function meet_master(master, near, place, search) result(nearest)
      type(surface_t), intent(in) :: master !! the master
      integer, intent(in) :: near(:) !! the sides to look at
      type(surface_place_t), intent(in) :: place !! the place on the slave
      real(dp), intent(in) :: search !! how far a gap may reach, either way [L]
      ! How far beyond its ends a side is still met: rays through a corner meet one of its sides.
      real(dp), parameter :: beyond = 1.0e-12_dp
      type(meeting_t) :: meeting
      type(surface_place_t) :: foot
      real(dp) :: normal(2), xi(2)
      integer :: i, k

      normal = place%normal/norm2(place%normal)
      do i = 1, size(near)
         xi = meet_side(master%corner(:, :, near(i)), place%position, normal)
         do k = 1, 2
            if (abs(xi(k)) > 1.0_dp + beyond) cycle
            foot = master%place(near(i), xi(k))
            if (dot_product(foot%outward(), normal) > -steepest_cosine) cycle
            meeting = meeting_t(near(i), xi(k), dot_product(foot%position - place%position, normal))
            if (abs(meeting%gap) > search) cycle
            if (nearest%side == 0 .or. abs(meeting%gap) < abs(nearest%gap)) nearest = meeting
         end do
      end do
   end function meet_master

   !> The places where a line meets a side: zeros of a quadratic polynomial; huge for none.
   pure function meet_side(corner, position, direction) result(xi)
      real(dp), intent(in) :: corner(2, 3) !! coordinates of first corner, second corner, middle [L]
      real(dp), intent(in) :: position(2) !! a point of the line [L]
      real(dp), intent(in) :: direction(2) !! its direction, a unit vector [-]
      real(dp) :: xi(2)
      ! What rounding leaves of a curvature or a slope of 0.
      real(dp), parameter :: negligible = 1.0e-14_dp
      real(dp) :: c(3), square, slope, root
      integer :: k

      c = [(cross_product(corner(:, k) - position, direction), k=1, 3)]
      square = 0.5_dp*(c(1) + c(2)) - c(3)
      slope = 0.5_dp*(c(2) - c(1))
      xi = huge(1.0_dp)
      if (max(abs(square), abs(slope)) <= negligible*norm2(corner(:, 2) - corner(:, 1))) return
      if (abs(square) <= negligible*abs(slope)) then
         xi(1) = -c(3)/slope
      else if (slope**2 >= 4.0_dp*square*c(3)) then
         root = -0.5_dp*(slope + sign(sqrt(slope**2 - 4.0_dp*square*c(3)), slope))
         xi(1) = root/square
         if (abs(root) > 0.0_dp) xi(2) = c(3)/root
      end if
   end function meet_side

end module amontons_mortar_segments
