!> Key results: from contact points and displacements the largest values with their places, what each contact set
!> carries, and the lengths of the zones.
module amontons_key_results
   use amontons_body, only: body_t
   use amontons_contact_rows, only: turned
   use amontons_contact_zone, only: contact_zone_t
   use amontons_element, only: n_corners, n_element_nodes
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   use amontons_quantity, only: at_place, quantity_t
   use amontons_stress_field, only: von_mises
   use amontons_zone_edges, only: find_edges, interval_t, trace_t
   implicit none (type, external)
   private

   public :: body_peaks, body_peaks_at_rest, contact_peaks, find_zones, lengths_t, new_lengths, resultants, set_results

   !> Lengths of the three zones; together the length of the sides between contact points, of a pair
   !> where they face the master, and of the cells.
   type :: lengths_t
      real(dp) :: open = 0.0_dp !! where one end of a side at least is open [L]
      real(dp) :: slip = 0.0_dp !! where both ends are closed and one at least slips [L]
      real(dp) :: stick = 0.0_dp !! where both ends stick [L]
   contains
      procedure :: quantities => lengths_quantities
   end type lengths_t

contains

   !> Sums of the contact forces [F].
   pure function resultants(force) result(list)
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      type(quantity_t) :: list(2)

      list = [quantity_t('normal_force', 'Normal forces', sum(force(:size(force)/2)), sum(abs(force)), &
         dimension='F'), &
         quantity_t('tangential_force', 'Tangential forces', sum(force(size(force)/2 + 1:)), &
         sum(abs(force)), dimension='F')]
   end function resultants

   !> The largest pressure, shear and slip of the contact points. The slip of a point that is open, or whose tangential
   !> direction a support holds, is left out. A body without contact points has none of these.
   pure function contact_peaks(body, slip, force, status, displacement) result(list)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: slip(:) !! slip of the points (m) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      integer, intent(in) :: status(:) !! statuses of the points (m)
      real(dp), intent(in) :: displacement !! largest displacement that is known [L]
      type(quantity_t), allocatable :: list(:)
      real(dp) :: area(size(status)), scale
      integer :: m

      m = size(status)
      allocate (list(merge(3, 0, m > 0)))
      if (m == 0) return
      associate (zone => body%zone)
         area = merge(zone%area, 1.0_dp, zone%area > 0.0_dp)
         list(1) = peak('max_contact_pressure', 'Max. pressure', force(:m)/area, zone%position, 0.0_dp, 'F/L^2')
         list(2) = peak('max_contact_shear', 'Max. shear', abs(force(m + 1:))/area, zone%position, list(1)%value, &
            'F/L^2')
         ! The slip of what sticks is a rounding error, if not of what has moved then of what forces of this size move.
         scale = max(displacement, maxval([0.0_dp, abs(force/[area, area])])/maxval(body%materials%list%young) &
            *maxval([0.0_dp, maxval(zone%position, dim=2) - minval(zone%position, dim=2)]))
         list(3) = peak('max_slip', 'Max. slip', merge(abs(slip), 0.0_dp, &
            status /= open_point .and. .not. zone%is_tangent_fixed), zone%position, scale, 'L')
      end associate
   end function contact_peaks

   !> Finds the parts of the contact line that are closed, and those that stick.
   pure subroutine find_zones(closed, stuck, body, force, status, bound, motion, displacement)
      type(interval_t), allocatable, intent(out) :: closed(:) !! the closed parts
      type(interval_t), allocatable, intent(out) :: stuck(:) !! the parts that stick
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      integer, intent(in) :: status(:) !! statuses of the points (m)
      real(dp), intent(in) :: bound(:) !! slip bounds g + phi lambda_N of the tangential forces (m) [F]
      real(dp), intent(in) :: motion(:) !! gaps and slips of the points (2m) [L]
      real(dp), intent(in) :: displacement(:) !! displacements of the points, normal and tangential (2m) [L]
      ! Slips that are as small beside the displacements are what rounding leaves of none.
      real(dp), parameter :: rounding = 1.0e-12_dp
      type(trace_t) :: trace
      logical :: has_middles
      integer :: m

      m = size(status)
      trace%force = force(:m)
      trace%n_summed = 2
      trace%gap = merge(motion(:m), 0.0_dp, status == open_point)
      trace%slip = 0.0_dp*motion(:m)
      call find_edges(closed, body%zone, status /= open_point, trace)
      trace%force = bound - abs(force(m + 1:))
      has_middles = any(n_element_nodes(body%mesh%element_kind) > n_corners(body%mesh%element_kind))
      ! Of quadratic sides a corner and a middle together.
      trace%n_summed = merge(2, 1, has_middles)
      trace%gap = 0.0_dp*motion(:m)
      if (has_middles) trace%slip = merge(motion(m + 1:), 0.0_dp, (status == slip_plus .or. status == slip_minus) &
         .and. abs(motion(m + 1:)) > rounding*maxval(abs(displacement)))
      call find_edges(stuck, body%zone, status == stick_point, trace)
   end subroutine find_zones

   !> What each contact set carries.
   pure function set_results(body, force, closed, stuck) result(list)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      type(interval_t), intent(in) :: closed(:) !! the closed parts of the contact line
      type(interval_t), intent(in) :: stuck(:) !! its parts that stick
      type(quantity_t), allocatable :: list(:)
      character(12) :: number
      integer :: i, n_sets

      n_sets = 0
      if (body%zone%n_points > 0) n_sets = maxval(body%zone%set)
      number = ''
      allocate (list(0))
      do i = 1, n_sets
         if (n_sets > 1) write (number, '(i0)') i
         list = [list, results_of_set(body, force, [sum(closed%length, mask=closed%set == i), &
            sum(stuck%length, mask=stuck%set == i)], i, trim(number))]
      end do
   end function set_results

   !> What a contact set carries.
   pure function results_of_set(body, force, widths, set, number) result(list)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      real(dp), intent(in) :: widths(2) !! lengths of what is closed and of what sticks [L]
      integer, intent(in) :: set !! number of the set
      character(*), intent(in) :: number !! what tells it from others; empty for the only one
      type(quantity_t), allocatable :: list(:)
      ! Ends between nodes are found to about a tenth of a side each.
      real(dp), parameter :: between_nodes = 0.2_dp
      character(:), allocatable :: suffix
      real(dp) :: sums(2), moment, center(2), acting(2), normal_force, length, scale
      integer :: p

      sums = 0.0_dp
      center = 0.0_dp
      moment = 0.0_dp
      normal_force = 0.0_dp
      associate (zone => body%zone)
         do p = 1, zone%n_points
            if (zone%set(p) /= set) cycle
            acting = -force(p)*zone%normal(:, p) - force(zone%n_points + p)*turned(zone%normal(:, p))
            sums = sums + acting
            moment = moment + zone%position(1, p)*acting(2) - zone%position(2, p)*acting(1)
            center = center + force(p)*zone%position(:, p)
            normal_force = normal_force + force(p)
         end do
         if (abs(normal_force) > 0.0_dp) center = center/normal_force
         length = maxval(abs(zone%position))
         scale = sum(abs(force))
      end associate
      suffix = number
      if (len(number) > 0) suffix = '_'//number
      list = [quantity_t('contact_width'//suffix, 'Contact width '//number, widths(1), length, between_nodes, &
         dimension='L'), &
         quantity_t('stick_width'//suffix, 'Stick width '//number, widths(2), length, between_nodes, dimension='L'), &
         quantity_t('contact_centroid_x'//suffix, 'Centroid x '//number, center(1), length, dimension='L'), &
         quantity_t('contact_centroid_y'//suffix, 'Centroid y '//number, center(2), length, dimension='L'), &
         quantity_t('contact_force_x'//suffix, 'Force x '//number, sums(1), scale, dimension='F'), &
         quantity_t('contact_force_y'//suffix, 'Force y '//number, sums(2), scale, dimension='F')]
      ! In a body of revolution the forces around the axis have no moment.
      if (.not. body%is_axisymmetric) list = [list, quantity_t('contact_moment'//suffix, 'Moment '//number, moment, &
         length*scale, dimension='F L')]
   end function results_of_set

   !> The largest displacement and von Mises stress of a node.
   pure function body_peaks(mesh, displacement, stress) result(list)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: stress(:, :) !! stress at each node (4, n_nodes) [F/L^2]
      type(quantity_t) :: list(2)
      real(dp), allocatable :: mises(:)
      integer :: i

      allocate (mises(mesh%n_nodes))
      do i = 1, mesh%n_nodes
         mises(i) = von_mises(stress(:, i))
      end do
      list = body_peaks_at_rest()
      call find_peak(list(1), mises, mesh%coordinates)
      call find_peak(list(2), hypot(displacement(1, :), displacement(2, :)), mesh%coordinates)
   end function body_peaks

   !> What `body_peaks` finds of a body that nothing loads.
   pure function body_peaks_at_rest() result(list)
      type(quantity_t) :: list(2)
      real(dp), parameter :: origin(2) = 0.0_dp

      list = [at_place('max_von_mises', 'Max. von Mises', 0.0_dp, origin, 0.0_dp, 'F/L^2'), &
         at_place('max_displacement', 'Max. displacement', 0.0_dp, origin, 0.0_dp, 'L')]
   end function body_peaks_at_rest

   !> The largest of some values, with its place.
   pure function peak(key, label, values, places, scale, dimension) result(quantity)
      character(*), intent(in) :: key !! its name in files
      character(*), intent(in) :: label !! its name in listings
      real(dp), intent(in) :: values(:) !! the values (any)
      real(dp), intent(in) :: places(:, :) !! where each is found (2, any) [L]
      real(dp), intent(in) :: scale !! what rounding errors of it are measured by
      character(*), intent(in) :: dimension !! what it is measured in
      type(quantity_t) :: quantity

      quantity = at_place(key, label, 0.0_dp, [0.0_dp, 0.0_dp], scale, dimension)
      call find_peak(quantity, values, places)
   end function peak

   !> Finds the largest of some values, the first of those that are equal but for rounding; 0 stays where all are
   !> rounding errors.
   pure subroutine find_peak(quantity, values, places)
      type(quantity_t), intent(inout) :: quantity !! 0, with its scale; gains value and place
      real(dp), intent(in) :: values(:) !! the values (any)
      real(dp), intent(in) :: places(:, :) !! where each is found (2, any) [L]
      real(dp), parameter :: rounding = 1.0e-9_dp
      integer :: i

      if (.not. any(values > rounding*quantity%scale)) return
      i = findloc(values >= (1.0_dp - rounding)*maxval(values), .true., dim=1)
      quantity%value = values(i)
      quantity%place = places(:, i)
   end subroutine find_peak

   !> Measures the zones side by side, as Table 1 of the paper reads its separated, sliding and sticking parts: the open
   !> zone ends at the first closed node, the slip zone at the first sticking node. A cell of constant multipliers
   !> belongs to one zone as a whole.
   pure subroutine new_lengths(lengths, zone, status, set)
      type(lengths_t), intent(out) :: lengths !! the lengths
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: status(:) !! status of each point (m)
      integer, intent(in), optional :: set !! the contact set to measure; all of them without it
      real(dp) :: length
      integer :: p, ends(2)

      do p = 1, zone%n_points
         if (present(set)) then
            if (zone%set(p) /= set) cycle
         end if
         ends = p
         if (zone%is_cell(p)) then
            length = zone%weight(p)
         else
            if (zone%next(p) == 0) cycle
            ends(2) = zone%next(p)
            length = norm2(zone%position(:, ends(2)) - zone%position(:, p))*covered_share(zone, p)
         end if
         if (any(status(ends) == open_point)) then
            lengths%open = lengths%open + length
         else if (all(status(ends) == stick_point)) then
            lengths%stick = lengths%stick + length
         else
            lengths%slip = lengths%slip + length
         end if
      end do
   end subroutine new_lengths

   !> The share of the side that follows a contact point that may come into contact: of a pair what faces the master.
   pure real(dp) function covered_share(zone, p)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: p !! number of the point

      covered_share = 1.0_dp
      if (.not. allocated(zone%pairs)) return
      associate (pair => zone%pairs(zone%set(p)))
         if (pair%is_set()) covered_share = pair%covered_share(p - findloc(zone%set, zone%set(p), dim=1) + 1)
      end associate
   end function covered_share

   !> The lengths under their names [L].
   pure function lengths_quantities(self) result(list)
      class(lengths_t), intent(in) :: self !! the lengths
      type(quantity_t) :: list(3)

      list = [quantity_t('open_length', 'Open length', self%open, resolution=1.0_dp, dimension='L'), &
         quantity_t('slip_length', 'Slip length', self%slip, resolution=1.0_dp, dimension='L'), &
         quantity_t('stick_length', 'Stick length', self%stick, resolution=1.0_dp, dimension='L')]
   end function lengths_quantities

end module amontons_key_results
