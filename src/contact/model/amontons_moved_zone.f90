!> Contact points that slide far: where they are now, and the nodes that a body is condensed to for them.
module amontons_moved_zone
   use amontons_constraints, only: constraints_t
   use amontons_contact_rows, only: contact_quadrature_t, contact_rows_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t, mean_gap, set_moved
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_frame, only: new_frame
   use amontons_kinds, only: dp
   use amontons_mortar_pair, only: integrate_pair, mortar_pair_t, mortar_points_t
   use amontons_moved_pair, only: move_pair
   use amontons_surface, only: meshed_body_t
   use amontons_text, only: place_text
   implicit none (type, external)
   private

   public :: check_retained, check_sliding, move_zone, new_retained_zone

contains

   !> Moves the points of sets that slide far to the present places of their nodes: frames, rows, areas and gaps of
   !> pairs anew; frames of points on rigid obstacles along the obstacle's normal.
   subroutine move_zone(zone, contacts, place, gap, is_near, keeps_carriers)
      type(contact_zone_t), intent(inout) :: zone !! the contact points
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they are now
      real(dp), intent(in) :: place(:, :) !! the places of all nodes (n_dim, n_nodes) [L]
      real(dp), intent(out) :: gap(:) !! the gaps there, without extra gaps (m) [L]
      logical, intent(out) :: is_near(:) !! whether a point faces what it may touch (m)
      logical, intent(in) :: keeps_carriers !! whether the same points of pairs as before carry the hats
      type(contact_rows_t) :: rows
      type(contact_quadrature_t) :: quadrature
      type(mortar_points_t) :: integrals
      type(contact_zone_t) :: points
      integer, allocatable :: of_set(:)
      integer :: nothing(0), p, set

      rows = zone%rows%picked(nothing)
      quadrature = zone%quadrature%picked(nothing)
      do set = 1, size(contacts)
         of_set = pack([(p, p=1, zone%n_points)], zone%set == set)
         if (zone%pairs(set)%is_set()) then
            call move_pair(zone%pairs(set), place, keeps_carriers)
            call integrate_pair(integrals, zone%pairs(set), zone%pairs(set)%segments, is_again=.false.)
            call set_moved(points, integrals, zone%pairs(set))
            zone%frame(:, :, of_set) = points%frame
            zone%acting(:, of_set) = points%acting
            zone%foot(:, of_set) = points%foot
            zone%weight(of_set) = points%weight
            zone%area(of_set) = points%area
            call rows%add(points%rows)
            call quadrature%add(points%quadrature)
            do p = 1, size(of_set)
               gap(of_set(p)) = mean_gap(points%quadrature, p)
            end do
            is_near(of_set) = integrals%area > 0.0_dp
         else
            do p = 1, size(of_set)
               call move_to_obstacle(zone, of_set(p), contacts(set), place, gap(of_set(p)), is_near(of_set(p)))
            end do
            call rows%add(zone%rows%picked(of_set))
            call quadrature%add(zone%quadrature%picked(of_set))
         end if
      end do
      zone%rows = rows
      zone%quadrature = quadrature
   end subroutine move_zone

   !> Moves a point on a rigid obstacle: its normal becomes opposite to that of the obstacle at its foot.
   pure subroutine move_to_obstacle(zone, point, contact, place, gap, is_near)
      type(contact_zone_t), intent(inout) :: zone !! the zone
      integer, intent(in) :: point !! the point
      type(contact_t), intent(in) :: contact !! its contact set, with the obstacle where it is now
      real(dp), intent(in) :: place(:, :) !! the places of all nodes (n_dim, n_nodes) [L]
      real(dp), intent(out) :: gap !! the gap there [L]
      logical, intent(out) :: is_near !! whether there is one
      real(dp) :: share, of_part, direction(size(place, 1)), frame(size(zone%frame, 1), size(zone%frame, 2))
      logical :: is_met
      integer :: i

      gap = 0.0_dp
      is_near = .true.
      zone%acting(:, point) = 0.0_dp
      frame = zone%frame(:, :, point)
      do i = zone%rows%start(point), zone%rows%start(point + 1) - 1
         share = dot_product(zone%rows%block(:, 1, i), zone%frame(:, 1, point))
         direction = zone%normal(point)
         associate (x => place(:, zone%rows%node(i)))
            call contact%obstacle%approach(x, direction, of_part, is_met)
            zone%acting(:, point) = zone%acting(:, point) + share*x
         end associate
         is_near = is_near .and. is_met
         ! The node of the point comes first.
         if (i == zone%rows%start(point)) frame = new_frame(direction, size(frame, 1))
         gap = gap + share*of_part*dot_product(direction, frame(:size(direction), 1))
         zone%rows%block(:, :, i) = share*frame
      end do
      if (is_near) zone%foot(:, point) = zone%acting(:, point) + gap*frame(:size(direction), 1)
      zone%frame(:, :, point) = frame
   end subroutine move_to_obstacle

   !> Refuses contact sets that do not slide far together, or in such a body.
   subroutine check_sliding(body, contacts, error)
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(error_t), allocatable, intent(out) :: error !! there are such sets
      integer :: i, k

      if (.not. any(contacts%slides_far())) return
      i = findloc(contacts%slides_far(), .false., dim=1)
      k = findloc(contacts%pairing%is_pair() .and. size(body%mesh%coordinates, 1) == 3, .true., dim=1)
      if (i > 0) then
         call new_error(error, input_refused, contacts(i)%origin//"sliding must be 'finite' for all contact "// &
            'sets, or for none')
      else if (k > 0) then
         call new_error(error, input_refused, contacts(k)%origin//"sliding = 'finite' of pairs of solids is not "// &
            'possible yet')
      else if (body%materials%is_twisted()) then
         call new_error(error, input_refused, contacts(1)%origin//"sliding = 'finite' does not go with twist")
      end if
   end subroutine check_sliding

   !> Refuses sets that slide far and contain nodes that move with others: those of rigid sets and slaves of ties.
   subroutine check_retained(retained, body, ties, contacts, error)
      type(contact_zone_t), intent(in) :: retained !! the nodes of its contact sets
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(mortar_pair_t), intent(in) :: ties(:) !! the surfaces that are bonded
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      type(error_t), allocatable, intent(out) :: error !! there is such a node
      integer :: i, k

      do i = 1, retained%n_points
         associate (node => retained%node(i))
            if (body%constraints%rigid_of(node) == 0 .and. &
               .not. any([(any(ties(k)%slave%side(:size(ties(k)%slave%side, 1) - 1, :) == node), &
               k=1, size(ties))])) cycle
            call new_error(error, input_refused, contacts(1)%origin//"sliding = 'finite': the node at "// &
               place_text(body%mesh%coordinates(:, node))//' moves with a rigid set or tie, too; keep the sets apart')
            return
         end associate
      end do
   end subroutine check_retained

   !> The nodes of sets that slide far, those of masters among them, as points: a body is condensed to these, and rows
   !> of the contact points are made of them in each place anew. Their first direction is free of supports.
   pure subroutine new_retained_zone(retained, nodes, zone, constraints, coordinates)
      type(contact_zone_t), intent(out) :: retained !! these points
      integer, allocatable, intent(out) :: nodes(:) !! these nodes and those that supports hold
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(constraints_t), intent(in) :: constraints !! the supports
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      logical :: is_retained(size(coordinates, 2))
      integer :: i, k, p, n, first

      is_retained = .false.
      is_retained(zone%rows%node) = .true.
      do i = 1, size(zone%pairs)
         if (.not. zone%pairs(i)%is_set()) cycle
         associate (slave => zone%pairs(i)%slave%side, master => zone%pairs(i)%master%side)
            do k = 1, size(slave, 1) - 1
               is_retained(pack(slave(k, :), slave(k, :) > 0)) = .true.
               is_retained(pack(master(k, :), master(k, :) > 0)) = .true.
            end do
         end associate
      end do
      nodes = pack([(i, i=1, size(is_retained))], is_retained)
      retained%node = pack([(i, i=1, size(is_retained))], is_retained .and. any(constraints%is_free, dim=1))
      retained%n_points = size(retained%node)
      retained%n_tangents = zone%n_tangents
      n = 1 + zone%n_tangents
      retained%n_rows = n*retained%n_points
      allocate (retained%frame(n, n, retained%n_points), retained%is_fixed(n - 1, retained%n_points))
      do p = 1, retained%n_points
         associate (is_free => constraints%is_free(:, retained%node(p)))
            first = findloc(is_free, .true., dim=1)
            associate (axes => cshift([(k, k=1, n)], first - 1))
               retained%frame(:, :, p) = constraints%frame(:, axes, retained%node(p))
               retained%is_fixed(:, p) = .not. is_free(axes(2:))
            end associate
         end associate
      end do
      allocate (retained%is_own(retained%n_points), source=.true.)
      allocate (retained%is_cell(retained%n_points), source=.false.)
      allocate (retained%set(retained%n_points), source=1)
      allocate (retained%weight(retained%n_points), retained%area(retained%n_points), source=1.0_dp)
      allocate (retained%mean_point(0), retained%pairs(1))
      if (allocated(zone%line)) allocate (retained%line)
      if (allocated(zone%line)) allocate (retained%line%next(retained%n_points), source=0)
      retained%rows = contact_rows_t([(p, p=1, retained%n_points + 1)], retained%node, retained%frame)
      retained%position = coordinates(:, retained%node)
      retained%acting = retained%position
      retained%foot = retained%position
   end subroutine new_retained_zone

end module amontons_moved_zone
