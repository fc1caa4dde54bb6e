!> Contact rows of a pair of surfaces, integrated a second time by another rule, for the certificate.
!>
!> Where segments end is found from what single rays meet, by halving; they are integrated by a rule of other points.
!> Which of them count is the pair's own definition: those whose middle is within reach.
module amontons_checked_rows
   use amontons_contact_rows, only: contact_rows_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_kinds, only: dp
   use amontons_mortar_pair, only: integrate_pair, mortar_pair_t, n_quadrature_points
   use amontons_mortar_points, only: mortar_points_t
   use amontons_mortar_segments, only: meet_master, meeting_t, mortar_segment_t, sides_near
   implicit none (type, external)
   private

   public :: integrate_again, recompute_pairs

contains

   !> Recomputes rows and gaps of the points of pairs in contact; those of the others stay.
   pure subroutine recompute_pairs(rows, gap_change, zone)
      type(contact_rows_t), intent(out) :: rows !! the rows
      real(dp), allocatable, intent(out) :: gap_change(:)
         !! by how much the gap that the meshes have is larger than in the zone (m) [L]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer :: nothing(0)
      type(mortar_points_t) :: points
      integer :: set, p, i
      integer, allocatable :: of_set(:)

      allocate (gap_change(zone%n_points), source=0.0_dp)
      rows = zone%rows%picked(nothing)
      do set = 1, size(zone%pairs)
         of_set = pack([(p, p=1, zone%n_points)], zone%set == set)
         if (.not. zone%pairs(set)%is_set()) then
            call rows%add(zone%rows%picked(of_set))
            cycle
         end if
         call integrate_again(points, zone%pairs(set))
         call rows%add(points%rows)
         do i = 1, size(of_set)
            gap_change(of_set(i)) = mean(points%quadrature%start, i, points%quadrature%share*points%quadrature%gap) &
               - mean(zone%quadrature%start, of_set(i), zone%quadrature%share*zone%quadrature%gap)
         end do
      end do
   end subroutine recompute_pairs

   !> Integrates over the points of a pair again: where its segments end is found in another way, and the rule has more
   !> points.
   pure subroutine integrate_again(points, pair)
      type(mortar_points_t), intent(out) :: points !! the points
      type(mortar_pair_t), intent(in) :: pair !! the pair

      call integrate_pair(points, pair, segments_of(pair), n_quadrature_points + 3)
   end subroutine integrate_again

   !> The sum of a point's values.
   pure real(dp) function mean(start, point, values)
      integer, intent(in) :: start(:) !! first value of each point, and one beyond the last
      integer, intent(in) :: point !! the point
      real(dp), intent(in) :: values(:) !! the values

      mean = sum(values(start(point):start(point + 1) - 1))
   end function mean

   !> Cuts the slave's sides by what rays meet.
   pure function segments_of(pair) result(segments)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_segment_t), allocatable :: segments(:)
      ! Parts of a side to begin with, for each side of the master that is near; a part is cut further where its ends
      ! meet different sides. What a side meets last at either end may be short.
      integer, parameter :: n_parts = 8
      real(dp), parameter :: edge = 1.0e-9_dp
      type(meeting_t) :: meeting
      integer, allocatable :: near(:)
      logical, allocatable :: counts(:)
      real(dp) :: low, high
      integer :: side, part

      allocate (segments(0))
      do side = 1, pair%slave%n_sides
         if (all(pair%segments%slave /= side)) cycle
         near = sides_near(pair%slave, side, pair%master, pair%search)
         low = edge - 1.0_dp
         segments = [segments, mortar_segment_t(side, met_side(pair, side, near, low), [-1.0_dp, -1.0_dp])]
         do part = 1, n_parts*size(near)
            high = min(1.0_dp - edge, 2.0_dp*part/(n_parts*size(near)) - 1.0_dp)
            call cut(segments, pair, near, low, high, met_side(pair, side, near, high))
            low = high
         end do
         segments(size(segments))%range(2) = 1.0_dp
      end do
      allocate (counts(size(segments)), source=.false.)
      do part = 1, size(segments)
         associate (segment => segments(part))
            if (segment%master == 0) cycle
            meeting = meet_master(pair%master, [segment%master], pair%slave%place(segment%slave, &
               0.5_dp*sum(segment%range)), pair%search)
            counts(part) = meeting%side > 0
         end associate
      end do
      segments = pack(segments, counts)
   end function segments_of

   !> The master's side that the ray from a place on the slave meets, however far away; 0 for none.
   pure integer function met_side(pair, side, near, xi) result(met)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      integer, intent(in) :: side !! the slave's side
      integer, intent(in) :: near(:) !! the master's sides in reach of it
      real(dp), intent(in) :: xi !! the place on it [-]
      type(meeting_t) :: meeting

      meeting = meet_master(pair%master, near, pair%slave%place(side, xi), huge(1.0_dp))
      met = meeting%side
   end function met_side

   !> Ends the last segment where rays begin to meet other sides, up to a place where they meet a given one.
   pure recursive subroutine cut(segments, pair, near, low, high, last)
      type(mortar_segment_t), allocatable, intent(inout) :: segments(:) !! the segments so far, the last one without end
      type(mortar_pair_t), intent(in) :: pair !! the pair
      integer, intent(in) :: near(:) !! the master's sides in reach of the slave's side
      real(dp), intent(in) :: low !! a place in the last segment [-]
      real(dp), intent(in) :: high !! the place up to which [-]
      integer, intent(in) :: last !! the side that its ray meets, 0 for none
      real(dp) :: middle
      integer :: met, side

      if (segments(size(segments))%master == last) return
      side = segments(size(segments))%slave
      middle = 0.5_dp*(low + high)
      if (high - low <= 4.0_dp*epsilon(1.0_dp)) then
         segments(size(segments))%range(2) = middle
         segments = [segments, mortar_segment_t(side, last, [middle, middle])]
         return
      end if
      met = met_side(pair, side, near, middle)
      call cut(segments, pair, near, low, middle, met)
      call cut(segments, pair, near, middle, high, last)
   end subroutine cut

end module amontons_checked_rows
