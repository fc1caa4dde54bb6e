!> Warnings on the mesh of a solved case: zones of the contact line of few sides, and ends of zones that most
!> of the estimated error comes from.
module amontons_mesh_warnings
   use amontons_body, only: body_t
   use amontons_element, only: n_corners, n_element_nodes
   use amontons_friction_law, only: open_point, stick_point
   use amontons_kinds, only: dp
   use amontons_model_warnings, only: percent
   use amontons_result, only: result_t
   use amontons_text, only: pair_text, to_text
   implicit none (type, external)
   private

   public :: add_mesh_warnings, error_clause

contains

   !> Adds the first of the warnings on the mesh that there is reason for.
   pure subroutine add_mesh_warnings(result, body, status)
      type(result_t), intent(inout) :: result !! the result; gains the warnings
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: status(:) !! statuses of the points, those whose force is rounding open (m)
      logical :: is_end(body%zone%n_points)
      integer :: n_per_side, n_before

      n_before = result%warnings%n()
      associate (zone => body%zone, kind => body%mesh%element_kind)
         n_per_side = merge(2, 1, any(n_element_nodes(kind) > n_corners(kind)) .and. .not. any(zone%is_cell))
         is_end = .false.
         call add_short_zones(result, body, is_end, 'contact', status /= open_point, n_per_side)
         call add_short_zones(result, body, is_end, 'stick', status == stick_point, n_per_side)
      end associate
      if (result%warnings%n() == n_before) call add_uncertain_ends(result, body, is_end)
   end subroutine add_mesh_warnings

   !> Warns of the first zone of a kind that ends within the line, if it has fewer than four sides. One point alone,
   !> as where a line of symmetry meets the line, is no zone.
   pure subroutine add_short_zones(result, body, is_end, name, is_inside, n_per_side)
      type(result_t), intent(inout) :: result !! the result; gains the warning
      type(body_t), intent(in) :: body !! the body
      logical, intent(inout) :: is_end(:) !! which points are beside an end of a zone; gains those of this kind (m)
      character(*), intent(in) :: name !! name of the kind
      logical, intent(in) :: is_inside(:) !! which points belong to such a zone (m)
      integer, intent(in) :: n_per_side !! number of points for each side
      integer, parameter :: enough_sides = 4
      integer :: before(body%zone%n_points), first, last, n, p
      logical :: is_zone(body%zone%n_points)

      before = 0
      do p = 1, body%zone%n_points
         if (body%zone%next(p) > 0) before(body%zone%next(p)) = p
      end do
      associate (zone => body%zone)
         do first = 1, zone%n_points
            if (.not. is_inside(first) .or. is_in(is_inside, before(first))) cycle
            call follow_zone(is_zone, last, first, zone%next, is_inside)
            n = count(is_zone)
            if (before(first) > 0) is_end([before(first), first]) = .true.
            if (zone%next(last) > 0) is_end([last, zone%next(last)]) = .true.
            if (max(before(first), zone%next(last)) == 0 .or. n < 2 .or. (n - 1)/n_per_side >= enough_sides) cycle
            call result%warnings%add('the '//name//' zone from '//pair_text(zone%position(:, first))//' to '// &
               result%warnings%place(zone%position(:, last))//' has fewer than '//to_text(enough_sides)// &
               ' sides: its ends are known to a side only'//error_clause(result, body, is_zone)// &
               '; refine the mesh there, or see the error bars of --refine 2')
            return
         end do
      end associate
   end subroutine add_short_zones

   !> Follows a zone along the line.
   pure subroutine follow_zone(is_zone, last, first, next, is_inside)
      logical, intent(out) :: is_zone(:) !! which points are its (m)
      integer, intent(out) :: last !! its last point
      integer, intent(in) :: first !! its first point
      integer, intent(in) :: next(:) !! the point that follows each, 0 for none (m)
      logical, intent(in) :: is_inside(:) !! which points belong to the zone (m)

      is_zone = .false.
      last = first
      is_zone(last) = .true.
      do while (is_in(is_inside, next(last)))
         last = next(last)
         is_zone(last) = .true.
      end do
   end subroutine follow_zone

   !> Whether there is such a point, and it belongs to the zone.
   pure logical function is_in(is_inside, point)
      logical, intent(in) :: is_inside(:) !! which points belong to the zone (m)
      integer, intent(in) :: point !! the point, 0 for none

      is_in = point > 0
      if (is_in) is_in = is_inside(point)
   end function is_in

   !> Warns where the elements at the ends of zones make more than two thirds of a large estimated error.
   pure subroutine add_uncertain_ends(result, body, is_end)
      type(result_t), intent(inout) :: result !! the result; gains the warning
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_end(:) !! which points are beside an end of a zone (m)
      real(dp), parameter :: large_error = 0.05_dp, most_of_it = 2.0_dp/3.0_dp
      real(dp) :: share
      integer :: p

      if (.not. any(is_end)) return
      if (.not. allocated(result%error_estimate)) return
      if (result%error_estimate%relative < large_error) return
      share = share_at(result, body, is_end)
      if (share <= most_of_it) return
      p = findloc(is_end, .true., dim=1)
      call result%warnings%add(percent(share)//' of the estimated error is in the elements at the ends of the '// &
         'contact and stick zones, the first at '//result%warnings%place(body%zone%position(:, p))// &
         ': refine the mesh there')
   end subroutine add_uncertain_ends

   !> What the estimated error says of some contact points, as a clause behind a sentence; nothing without an estimate.
   pure function error_clause(result, body, is_there) result(clause)
      type(result_t), intent(in) :: result !! the result
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_there(:) !! which points (m)
      character(:), allocatable :: clause
      real(dp) :: share

      clause = ''
      share = share_at(result, body, is_there)
      if (share > 0.0_dp) clause = '; '//percent(share)//' of the estimated error, '// &
         percent(result%error_estimate%relative)//', is in the elements there'
   end function error_clause

   !> The share of the elements at some contact points in the square of the estimated error; 0 where there is no
   !> estimate, and for cells, whose ends are no nodes [-].
   pure real(dp) function share_at(result, body, is_there) result(share)
      type(result_t), intent(in) :: result !! the result
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_there(:) !! which points (m)
      logical, allocatable :: is_near(:)
      integer :: i, p

      share = 0.0_dp
      if (.not. allocated(result%error_estimate) .or. any(body%zone%is_cell)) return
      if (result%error_estimate%norm <= 0.0_dp) return
      allocate (is_near(body%mesh%n_nodes), source=.false.)
      do p = 1, body%zone%n_points
         if (is_there(p)) is_near(body%zone%rows%node(body%zone%rows%start(p))) = .true.
      end do
      associate (estimate => result%error_estimate, mesh => body%mesh)
         do i = 1, mesh%n_elements
            if (.not. any(is_near(mesh%node(mesh%node_start(i):mesh%node_start(i + 1) - 1)))) cycle
            share = share + (estimate%element(i)/estimate%norm)**2
         end do
      end associate
   end function share_at

end module amontons_mesh_warnings
