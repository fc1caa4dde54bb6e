!> Warnings on a result: limits of the theory, the mesh and the arithmetic that it exceeds; among those on the mesh,
!> zones of the contact line with few sides, and ends of zones that contribute most of the estimated error.
module amontons_result_warnings
   use amontons_body, only: body_t
   use amontons_conditioning, only: conditioning_text, rounded
   use amontons_contact_set, only: contact_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_element, only: max_corners, n_corners, n_element_nodes
   use amontons_error, only: warning_list_t
   use amontons_free_boundary, only: corner_overlap, overlap_t
   use amontons_friction_law, only: open_point, stick_point, tangential_norm
   use amontons_kinds, only: dp
   use amontons_load_family, only: load_case_t
   use amontons_mesh, only: mesh_t
   use amontons_model_warnings, only: percent
   use amontons_pose, only: elastic_part
   use amontons_result, only: result_t
   use amontons_rounding, only: exceeds, result_rounding
   use amontons_text, only: counted, vector_text, to_text
   implicit none (type, external)
   private

   public :: add_conditioning, add_result_warnings, add_tallied_warnings, find_case_warnings, lacks_points, tally_t

   !> Names of the warnings on a case of a sweep, as its row has them.
   character(18), parameter, public :: case_warning_names(*) = [character(18) :: 'large_displacement', 'no_contact', &
      'few_points', 'pressure_jump', 'large_strain', 'end_of_set']
   !> Sentences of these warnings, for rigid obstacles.
   character(99), parameter :: case_warning_sentences(size(case_warning_names)) = [character(99) :: &
      "displacement of contact points above 5 % of the body's size; the theory is for small displacements", &
      'nothing touches the obstacle', &
      'fewer than 3 contact points closed: the mesh is too coarse for the pressure there', &
      'the largest pressure is more than twice that of the points beside it: the mesh is too coarse for it', &
      "contact pressure above 2 % of Young's modulus; the theory is for small strains", &
      'the contact reaches an end of its set and the boundary goes on: enlarge the set, or search']

   !> Number of these warnings.
   integer, parameter, public :: n_case_warnings = size(case_warning_names)
   !> Whether each of them means that theory or model are not valid: displacements or strains that are too large, or a
   !> set that is too small.
   logical, parameter, public :: is_limit_of_model(n_case_warnings) = [.true., .false., .false., .false., .true., &
      .true.]

   !> Index of the warning that there is no contact.
   integer, parameter :: no_contact = 2
   !> Index of the warning that contact reaches the end of a set.
   integer, parameter, public :: end_of_set = 6

   !> The cases or steps that a warning is about.
   type :: tally_t
      integer :: n = 0 !! their number
      integer :: first = 0 !! the first of them; 0 for none
      integer :: last = 0 !! the last of them
   contains
      procedure :: append => tally_append
   end type tally_t

   !> Largest displacement, as a share of the body's size, and largest strain that are considered small [-].
   real(dp), parameter :: large_displacement = 0.05_dp, large_strain = 0.02_dp

contains

   !> Adds the warnings on a result to those on its model.
   subroutine add_result_warnings(result, body)
      type(result_t), intent(inout) :: result !! the result; gains the warnings
      type(body_t), intent(in) :: body !! the body
      ! The cosine of 30 degrees, rounded down.
      real(dp), parameter :: smallest_cosine = 0.866_dp
      ! Depth of a corner of an obstacle between two nodes, over the largest displacement.
      real(dp), parameter :: badly_resolved(2) = 0.2_dp
      integer, allocatable :: reached(:)
      real(dp), allocatable :: nodal(:)
      integer :: peak, i, first
      type(overlap_t) :: corner

      call add_conditioning(result, body)
      if (.not. result%solution%is_converged) return
      if (allocated(result%poses)) then
         call add_size_warnings(result%warnings, body, elastic_part(body%turning, result%poses, body%mesh%coordinates, &
            result%displacement))
      else
         call add_size_warnings(result%warnings, body, result%displacement)
      end if
      reached = body%free_boundary%reached_ends(result%load_case%contacts, body%mesh%coordinates, &
         result%load_case%gap, result%solution%status)
      call add_reached_ends(result, body, reached)
      if (.not. body%slides_far) corner = corner_overlap(body, result%load_case%contacts, body%zone, &
         result%load_case%extra_gap, result%displacement(:size(body%mesh%coordinates, 1), :), badly_resolved)
      if (corner%set > 0) call result%warnings%add("contact set '"//result%load_case%contacts(corner%set)%set// &
         "': a corner or apex of the obstacle penetrates the body by "//result%warnings%number(corner%depth, 'L')// &
         ' at '//result%warnings%place(corner%place)//', between contact points: refine the mesh there until its '// &
         'sides are smaller than the obstacle, or put a node opposite to the corner')
      associate (is_closed => result%solution%status /= open_point, zone => body%zone, &
         lacks => lacks_points(result%solution%status))
         if (lacks(1)) then
            call add_no_contact(result, body)
         else if (lacks(2)) then
            call result%warnings%add('only '//counted(count(is_closed), 'contact point')// &
               ' closed: the mesh is too coarse for the pressure there'//error_clause(result, body, is_closed)// &
               '; refine it there, or see with --refine 2 what converges')
         else if (zone%n_points > 2) then
            nodal = zone%nodal_forces(result%solution%force)
            associate (pressure => nodal(:zone%n_points)/zone%area)
               peak = jump_at(zone, pressure)
               ! The pressure grows at an end because the set ends there, not because the mesh is coarse.
               if (peak > 0 .and. .not. is_at_end(body, reached, peak)) then
                  peak = jump_at(body%zone, pressure)
                  call result%warnings%add('the largest pressure '// &
                     result%warnings%number(pressure(peak), 'F/L^2')//' at '// &
                     result%warnings%place(body%zone%position(:, peak))//' is more than twice that of the points '// &
                     'beside it: the mesh is too coarse for it, or it grows without bound at an edge'// &
                     error_clause(result, body, [(i == peak, i=1, size(pressure))])//'; refine it there, or see '// &
                     'with --refine 2 whether it converges')
               else if (peak == 0) then
                  call add_mesh_warnings(result, body, result%solution%status)
               end if
            end associate
         end if
         associate (is_aslant => is_closed .and. result%load_case%cosine < smallest_cosine)
            first = findloc(is_aslant, .true., dim=1)
            if (first > 0) call result%warnings%add(counted(count(is_aslant), 'closed contact point')// &
               ', the first at '//result%warnings%place(zone%position(:, first))// &
               ", more than 30 degrees off the obstacle's normal; end the "// &
               'contact set at the corner, or give gap_direction')
         end associate
      end associate
      if (.not. body%slides_far) then
         call add_passed_points(result%warnings, body, result%load_case, result%displacement)
         call add_far_slips(result%warnings, body%zone, result%displacement, result%solution%status)
         call add_lost_friction(result, body)
      end if
      call add_couples(result, body)
   end subroutine add_result_warnings

   !> Warns of contact that reaches an end of its set beyond which body and obstacle continue.
   subroutine add_reached_ends(result, body, reached)
      type(result_t), intent(inout) :: result !! the result; gains the warnings
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: reached(:) !! these ends, places in the body's free boundary
      character(:), allocatable :: set
      type(overlap_t) :: deepest
      integer :: i

      deepest = body%free_boundary%overlap(result%load_case%contacts, result%load_case%lies_outside, &
         body%mesh%coordinates, result%displacement(:size(body%mesh%coordinates, 1), :))
      do i = 1, size(reached)
         associate (set_end => body%free_boundary%ends(reached(i)))
            set = result%load_case%contacts(set_end%set)%set
            if (set_end%is_of_master) set = result%load_case%contacts(set_end%set)%pairing%against
            call result%warnings%add('the contact reaches the end of '// &
               trim(merge('search ', 'its set', set_end%is_of_search))//' at '// &
               result%warnings%place(set_end%position)//' and the boundary goes on: enlarge '// &
               trim(merge('search of', 'the set  ', set_end%is_of_search))//" '"//set//"'")
         end associate
      end do
      if (deepest%set > 0) call result%warnings%add('the boundary outside the contact sets penetrates the obstacle '// &
         'or the other body by '//result%warnings%number(deepest%depth, 'L')//' at '// &
         result%warnings%place(deepest%place)//': enlarge the sets, or search, so that they contain all that may '// &
         'touch, or end the obstacle')
   end subroutine add_reached_ends

   !> Appends further cases or steps to those that a warning is about.
   elemental subroutine tally_append(self, n, first, last)
      class(tally_t), intent(inout) :: self !! those before
      integer, intent(in) :: n !! number of the further ones
      integer, intent(in) :: first !! the first of them
      integer, intent(in) :: last !! the last of them

      if (n == 0) return
      if (self%n == 0) self%first = first
      self%n = self%n + n
      self%last = last
   end subroutine tally_append

   !> Adds a warning for each kind that cases of a sweep or steps of a history have.
   pure subroutine add_tallied_warnings(warnings, tallies, n, noun, zone)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(tally_t), intent(in) :: tallies(n_case_warnings) !! those that each warning is about
      integer, intent(in) :: n !! number of all cases or steps
      character(*), intent(in) :: noun !! noun for one
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer :: i

      do i = 1, n_case_warnings
         if (tallies(i)%n > 0) call warnings%add(to_text(tallies(i)%n)//' of '//to_text(n)//' '//noun//'s, '//noun// &
            ' '//to_text(tallies(i)%first)//' the first: '//case_warning_sentence(i, zone))
      end do
   end subroutine add_tallied_warnings

   !> The sentence of a warning on a case of a sweep.
   pure function case_warning_sentence(kind, zone) result(sentence)
      integer, intent(in) :: kind !! index in `case_warning_names`
      type(contact_zone_t), intent(in) :: zone !! the contact points
      character(:), allocatable :: sentence

      sentence = trim(case_warning_sentences(kind))
      if (kind == no_contact .and. all(zone%pairs%is_set())) sentence = 'the bodies do not touch each other'
   end function case_warning_sentence

   !> Warns that no point is closed, with the distance of the nearest point from its obstacle or the other body.
   subroutine add_no_contact(result, body)
      type(result_t), intent(inout) :: result !! the result; gains the warning
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable :: sentence
      real(dp), allocatable :: displacement(:), gap(:)
      integer :: p

      sentence = case_warning_sentence(no_contact, body%zone)
      if (body%slides_far .and. .not. any(result%load_case%is_in_reach)) then
         call result%warnings%add(sentence//'; no point is within search of what it may touch')
         return
      end if
      displacement = body%zone%rows%displacement(result%displacement)
      gap = result%load_case%gap - displacement(:body%zone%n_points)
      ! Of points that differ by rounding alone the first.
      p = findloc(gap <= minval(gap) + 1.0e-6_dp*abs(minval(gap)), .true., dim=1)
      associate (travel => max(maxval(abs(displacement)), abs(result%load_case%gap(p))))
         ! A body that lies on its obstacle without any force touches it, too. The position of one that nothing holds is
         ! rounding, and so is its gap.
         if (gap(p) > epsilon(1.0_dp)*travel .and. all(body%motions%n_free == 0)) then
            call result%warnings%add(sentence//'; the smallest gap is '//result%warnings%number(gap(p), 'L')//' at '// &
               result%warnings%place(body%zone%position(:, p)))
         else
            call result%warnings%add(sentence//' with a force')
         end if
      end associate
   end subroutine add_no_contact

   !> Warns of pairs that slide so far in the plane that points no longer face the positions which they faced initially.
   pure subroutine add_far_slips(warnings, zone, displacement, status)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      integer, intent(in) :: status(:) !! status of each point (m)
      ! Distances below half of a side are not resolved by the pressures.
      real(dp), parameter :: far = 0.5_dp
      real(dp), allocatable :: at_points(:)
      integer :: set, p

      if (.not. any(zone%pairs%is_set())) return
      at_points = zone%rows%displacement(displacement)
      ! A slip around the axis changes no faces.
      associate (slip => tangential_norm(at_points(zone%n_points + 1:size(zone%position)), zone%n_points))
         do set = 1, size(zone%pairs)
            if (.not. any(zone%set == set .and. status /= open_point) .or. .not. zone%pairs(set)%is_set()) cycle
            p = maxloc(slip, dim=1, mask=zone%set == set .and. status /= open_point)
            if (.not. slip(p) > far*zone%pairs(set)%slave%longest) cycle
            call warnings%add(zone%pairs(set)%label//': slip of '//warnings%number(slip(p), 'L')//' at '// &
               warnings%place(zone%position(:, p))//', more than half a side of the slave: the sides that face '// &
               'each other are those of the undeformed bodies and do not follow')
         end do
      end associate
   end subroutine add_far_slips

   !> Warns of contact sets with a part of their normal force without friction, since supports prescribe the slip there:
   !> that of a body on its obstacle, or those of both bodies.
   pure subroutine add_lost_friction(result, body)
      type(result_t), intent(inout) :: result !! the result; gains the warnings
      type(body_t), intent(in) :: body !! the body
      ! Slips, over the largest displacement, and shares of the force that count [-].
      real(dp), parameter :: least_slip = 1.0e-3_dp, least_share = 1.0e-4_dp
      character(*), parameter :: without = ' of the normal force slides without friction: supports hold '
      real(dp) :: lost(body%zone%n_points), slip(body%zone%n_rows), share
      integer :: i, nearest, p, set, t

      slip = body%zone%rows%displacement(result%displacement)
      associate (zone => body%zone, normal => result%solution%force(:body%zone%n_points), &
         load_case => result%load_case, largest => maxval(abs(result%displacement)))
         ! Since rest, as tables have it.
         if (allocated(load_case%obstacle_motion)) slip(zone%n_points + 1:) = slip(zone%n_points + 1:) &
            - load_case%obstacle_motion
         lost = 0.0_dp
         do p = 1, zone%n_points
            if (.not. any(zone%is_fixed(:, p)) .or. zone%is_cell(p) .or. &
               .not. max(load_case%friction(p), load_case%slip_bound(p)) > 0.0_dp) cycle
            ! By how much a corner of a slave slides along the nearest corner of its master that supports hold, too [L].
            if (zone%pairs(zone%set(p))%is_set()) then
               associate (zone => body%zone, pair => body%zone%pairs(body%zone%set(p)))
                  associate (corners => pack(pair%master%side(:size(pair%master%side, 1) - 1, :), &
                     pair%master%side(:size(pair%master%side, 1) - 1, :) > 0), &
                     own => pair%node(p - findloc(zone%set, zone%set(p), dim=1) + 1))
                     do t = 1, zone%n_tangents
                        associate (along => zone%frame(:, 1 + t, p))
                           nearest = minloc(norm2(body%mesh%coordinates(:, corners) &
                              - spread(zone%position(:, p), 2, size(corners)), dim=1), dim=1, &
                              mask=[(.not. body%constraints%leaves_free(corners(i), along), i=1, size(corners))])
                           slip(t*zone%n_points + p) = 0.0_dp
                           if (nearest > 0) slip(t*zone%n_points + p) = dot_product(along, &
                              result%displacement(:, own) - result%displacement(:, corners(nearest)))
                        end associate
                     end do
                  end associate
               end associate
            end if
            if (any(zone%is_fixed(:, p) .and. abs(slip(zone%n_points + p::zone%n_points)) &
               > least_slip*largest)) lost(p) = normal(p)
         end do
         do set = 1, size(zone%pairs)
            if (.not. any(lost > 0.0_dp .and. zone%set == set)) cycle
            share = sum(lost, mask=zone%set == set)/sum(normal, mask=zone%set == set)
            if (.not. share > least_share) cycle
            p = findloc(lost > 0.0_dp .and. zone%set == set, .true., dim=1)
            if (zone%pairs(set)%is_set()) then
               call result%warnings%add(zone%pairs(set)%label//': '//percent(share)//without//'both bodies at '// &
                  result%warnings%place(zone%position(:, p))//'; hold one of them at some distance from the contact')
            else
               call result%warnings%add("contact set '"//load_case%contacts(set)%set//"': "//percent(share)//without// &
                  'the body at '//result%warnings%place(zone%position(:, p))//'; their reactions lack this friction')
            end if
         end do
      end associate
   end subroutine add_lost_friction

   !> Warns of contact pairs and ties whose forces form a considerable couple across the gap between them.
   pure subroutine add_couples(result, body)
      type(result_t), intent(inout) :: result !! the result; gains the warnings
      type(body_t), intent(in) :: body !! the body
      ! Largest couple without a warning, as a share of the moment that a pair transmits [-].
      real(dp), parameter :: large = 0.05_dp
      character(:), allocatable :: label
      integer :: i

      associate (couple => abs(result%certificate%couple), scale => result%certificate%couple_scale, &
         n_pairs => size(body%zone%pairs))
         do i = 1, size(couple)
            if (couple(i) <= max(large*scale(i), result_rounding*result%certificate%force_scale*body%size)) cycle
            if (i <= n_pairs) label = body%zone%pairs(i)%label
            if (i > n_pairs) label = body%ties(i - n_pairs)%label
            call result%warnings%add(label//': the forces across the gap make a couple of '// &
               result%warnings%number(couple(i), 'F L')//', '//percent(couple(i)/scale(i))// &
               ' of the moment that they transmit, which small displacements leave out; move the bodies together')
         end do
      end associate
   end subroutine add_couples

   !> Finds the warnings on the solution of a contact problem that do not depend on the displacements of the body.
   pure subroutine find_case_warnings(is_raised, body, size_of_body, contacts, gap, solution)
      logical, intent(out) :: is_raised(size(case_warning_names)) !! whether each warning applies
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: size_of_body !! the larger side of the bounding box of the mesh [L]
      type(contact_t), intent(in) :: contacts(:) !! the contact sets, their obstacles where they are now
      real(dp), intent(in) :: gap(:) !! distances of the points before any displacement (m) [L]
      type(contact_solution_t), intent(in) :: solution !! the solution
      integer, allocatable :: reached(:)
      real(dp), allocatable :: nodal(:)
      integer :: m, peak

      m = body%zone%n_points
      is_raised = .false.
      if (m == 0) return
      is_raised(1) = .not. body%slides_far .and. exceeds(maxval(hypot(solution%displacement(:m), &
         tangential_norm(solution%displacement(m + 1:), m))), large_displacement*size_of_body)
      is_raised(2:3) = lacks_points(solution%status)
      nodal = body%zone%nodal_forces(solution%force)
      is_raised(5) = exceeds(maxval(nodal(:m)/body%zone%area), &
         large_strain*maxval(body%materials%list%young(1)))
      reached = body%free_boundary%reached_ends(contacts, body%mesh%coordinates, gap, solution%status)
      is_raised(end_of_set) = size(reached) > 0
      if (m <= 2 .or. any(is_raised(2:3))) return
      peak = jump_at(body%zone, nodal(:m)/body%zone%area)
      is_raised(4) = peak > 0 .and. .not. is_at_end(body, reached, peak)
   end subroutine find_case_warnings

   !> Whether a point is at an end of a set that contact reaches, or next to such a point.
   pure logical function is_at_end(body, reached, point)
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: reached(:) !! these ends, places in the body's free boundary
      integer, intent(in) :: point !! the point, 0 for none
      integer :: i

      is_at_end = .false.
      if (point == 0) return
      associate (at_ends => body%free_boundary%ends(reached)%point, near => [point, body%zone%line%beside(point)])
         is_at_end = any([(any(at_ends == near(i)), i=1, size(near))])
      end associate
   end function is_at_end

   !> Whether no contact point is closed (1), and whether one or two are, too few for a pressure distribution (2).
   pure function lacks_points(status) result(lacks)
      integer, intent(in) :: status(:) !! their statuses (m)
      logical :: lacks(2)

      associate (n_closed => count(status /= open_point))
         lacks(1) = size(status) > 0 .and. n_closed == 0
         lacks(2) = size(status) > 2 .and. n_closed > 0 .and. n_closed < 3
      end associate
   end function lacks_points

   !> Warns of a stiffness so ill-conditioned that rounding affects the certificate.
   pure subroutine add_conditioning(result, body)
      type(result_t), intent(inout) :: result !! the result; gains the warning
      type(body_t), intent(in) :: body !! the body
      ! Strains of displacements so much larger keep fewer than ten of 16 digits.
      real(dp), parameter :: far = 1.0e6_dp
      character(:), allocatable :: travel
      real(dp) :: strain, turn, distance
      integer :: at

      if (.not. result%condition > 0.0_dp) return
      call find_largest_strain(body%mesh, result%displacement, strain, turn, at)
      distance = maxval(norm2(result%displacement, dim=1))
      travel = ''
      if (distance > far*strain*body%size) travel = '; the body moves by '// &
         result%warnings%number(distance, 'L')//', far more than it is strained: place it closer to its obstacle'
      call result%warnings%add('the stiffness is ill-conditioned, condition number about '// &
         rounded(result%condition)//': rounding may cost '//to_text(min(16, nint(log10(result%condition))))// &
         ' of 16 digits'//conditioning_text(body%mesh, body%materials, body%springs)//travel)
   end subroutine add_conditioning

   !> Warns of displacements and strains that are not small.
   pure subroutine add_size_warnings(warnings, body, displacement)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:, :)
         !! displacement of the nodes, elastic where pieces turn far (components, n_nodes) [L]
      real(dp) :: strain, turn, largest
      integer :: node, at

      largest = maxval(norm2(displacement, dim=1))
      if (exceeds(largest, large_displacement*body%size) .and. .not. body%slides_far) call warnings%add( &
         'displacement of '//warnings%number(largest, 'L')//', '// &
         percent(largest/body%size)//" of the body's size; the theory is for small displacements (up to "// &
         percent(large_displacement)//'); check units, loads and moduli')
      call find_largest_strain(body%mesh, displacement, strain, turn, at)
      if (body%slides_far .and. exceeds(turn, large_displacement)) call warnings%add('a turn of '// &
         warnings%number(turn, '')//" rad: with sliding = 'finite' bodies move any way, but the theory is for "// &
         'small turns of them (up to '//warnings%number(large_displacement, '')//' rad)')
      if (body%is_axisymmetric) then
         do node = 1, body%mesh%n_nodes
            associate (radius => body%mesh%coordinates(1, node), widening => abs(displacement(1, node)))
               if (.not. widening > strain*radius .or. .not. radius > 0.0_dp) cycle
               strain = widening/radius
               at = node
            end associate
         end do
      end if
      if (exceeds(strain, large_strain)) call warnings%add('strain of '//percent(strain)//' at '// &
         warnings%place(body%mesh%coordinates(:, at))//'; the theory is for small strains (up to '// &
         percent(large_strain)//')')
   end subroutine add_size_warnings

   !> Finds the largest change of distance between two corners of an element, over the distance, and the largest motion
   !> of one about the other.
   pure subroutine find_largest_strain(mesh, displacement, strain, turn, at)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(out) :: strain !! its size, over the distance [-]
      real(dp), intent(out) :: turn !! the motion across the distance, over it [rad]
      integer, intent(out) :: at !! one of the two nodes; 0 if there is no strain
      real(dp), dimension(size(mesh%coordinates, 1), max_corners) :: x, u
      real(dp) :: distance(size(mesh%coordinates, 1)), across, elongation, square
      integer :: element, i, k, n, n_dim, node

      strain = 0.0_dp
      turn = 0.0_dp
      at = 0
      n_dim = size(distance)
      do element = 1, mesh%n_elements
         n = n_corners(mesh%element_kind(element))
         do i = 1, n
            node = mesh%node(mesh%node_start(element) - 1 + i)
            x(:, i) = mesh%coordinates(:, node)
            u(:, i) = displacement(:n_dim, node)
            do k = 1, i - 1
               distance = x(:, i) - x(:, k)
               ! Times the distance, whose square an element's area has in it, too.
               elongation = abs(dot_product(u(:, i) - u(:, k), distance))
               square = dot_product(distance, distance)
               across = sum((u(:, i) - u(:, k))**2)*square - elongation**2
               if (across > turn*square**2) turn = across/square**2
               if (.not. exceeds(elongation, strain*square)) cycle
               strain = elongation/square
               at = node
            end do
         end do
      end do
      turn = sqrt(turn)
   end subroutine find_largest_strain

   !> The point of the largest pressure, if this is more than twice the pressure of each neighbor; otherwise, and where
   !> points have no order, 0.
   pure integer function jump_at(zone, pressure) result(peak)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: pressure(:) !! their pressures (m) [F/L^2]
      real(dp), parameter :: large_jump = 2.0_dp

      peak = merge(maxloc(pressure, dim=1), 0, allocated(zone%line))
      if (peak == 0) return
      if (.not. pressure(peak) > large_jump*maxval([0.0_dp, pressure(zone%line%beside(peak))])) peak = 0
   end function jump_at

   !> Warns of points out of reach of the obstacle that the displacements move into it.
   subroutine add_passed_points(warnings, body, load_case, displacement)
      type(warning_list_t), intent(inout) :: warnings !! gains the warning
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its load case
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), parameter :: negligible = 0.1_dp
      real(dp), allocatable :: at_points(:)
      real(dp) :: depth
      integer :: n_passed, p

      n_passed = 0
      associate (zone => body%zone)
         if (all(load_case%is_in_reach)) return
         at_points = zone%rows%displacement(displacement)
         do p = 1, zone%n_points
            if (load_case%is_in_reach(p) .or. load_case%depth(p) > 0.0_dp) cycle
            associate (contact => load_case%contacts(zone%set(p)))
               depth = contact%obstacle%depth(zone%position(:, p) + matmul(zone%frame(:size(zone%position, 1), :, p), &
                  at_points(p::zone%n_points)))
               if (depth - load_case%extra_gap(p) > negligible*maxval(abs(displacement))) n_passed = n_passed + 1
            end associate
         end do
      end associate
      if (n_passed > 0) call warnings%add('the body moves into the obstacle unhindered at '// &
         counted(n_passed, 'contact point')//' out of reach')
   end subroutine add_passed_points

   !> Adds the first warning on the mesh that applies.
   pure subroutine add_mesh_warnings(result, body, status)
      type(result_t), intent(inout) :: result !! the result; gains the warnings
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: status(:) !! statuses of the points, those whose force is rounding open (m)
      real(dp), parameter :: most_of_it = 2.0_dp/3.0_dp
      real(dp), parameter :: large_error = 0.05_dp
      logical :: is_end(body%zone%n_points)
      integer :: n_per_side, n_before, p
      real(dp) :: share

      n_before = result%warnings%n()
      associate (zone => body%zone, kind => body%mesh%element_kind)
         n_per_side = merge(2, 1, any(n_element_nodes(kind) > n_corners(kind)) .and. .not. any(zone%is_cell))
         is_end = .false.
         call add_short_zones(result, body, is_end, 'contact', status /= open_point, n_per_side)
         call add_short_zones(result, body, is_end, 'stick', status == stick_point, n_per_side)
      end associate
      if (result%warnings%n() == n_before) then
         ! Warns where the elements at the ends of zones make more than two thirds of a large estimated error.
         if (.not. any(is_end)) return
         if (.not. allocated(result%error_estimate)) return
         if (result%error_estimate%relative < large_error) return
         share = share_at(result, body, is_end)
         if (share <= most_of_it) return
         p = findloc(is_end, .true., dim=1)
         call result%warnings%add(percent(share)//' of the estimated error is in the elements at the ends of the '// &
            'contact and stick zones, the first at '//result%warnings%place(body%zone%position(:, p))// &
            ': refine the mesh there')
      end if
   end subroutine add_mesh_warnings

   !> Warns of the first zone of a kind that ends within the line, if it has fewer than four sides. A single point, as
   !> where a line of symmetry meets the line, is no zone.
   pure subroutine add_short_zones(result, body, is_end, name, is_inside, n_per_side)
      type(result_t), intent(inout) :: result !! the result; gains the warning
      type(body_t), intent(in) :: body !! the body
      logical, intent(inout) :: is_end(:) !! which points are beside an end of a zone; gains those of this kind (m)
      character(*), intent(in) :: name !! name of the kind
      logical, intent(in) :: is_inside(:) !! which points belong to such a zone (m)
      integer, intent(in) :: n_per_side !! number of points for each side
      integer, parameter :: enough_sides = 4
      integer :: before(body%zone%n_points), first, last, n
      logical :: is_zone(body%zone%n_points)

      if (.not. allocated(body%zone%line)) return
      before = body%zone%line%before()
      associate (zone => body%zone, next => body%zone%line%next)
         do first = 1, zone%n_points
            if (.not. is_inside(first) .or. is_in(is_inside, before(first))) cycle
            ! Follows a zone along the line.
            is_zone = .false.
            last = first
            is_zone(last) = .true.
            do while (is_in(is_inside, next(last)))
               last = next(last)
               is_zone(last) = .true.
            end do
            n = count(is_zone)
            if (before(first) > 0) is_end([before(first), first]) = .true.
            if (next(last) > 0) is_end([last, next(last)]) = .true.
            if (max(before(first), next(last)) == 0 .or. n < 2 .or. (n - 1)/n_per_side >= enough_sides) cycle
            call result%warnings%add('the '//name//' zone from '//vector_text(zone%position(:, first))//' to '// &
               result%warnings%place(zone%position(:, last))//' has fewer than '//to_text(enough_sides)// &
               ' sides: its ends are known to a side only'//error_clause(result, body, is_zone)// &
               '; refine the mesh there, or see the error bars of --refine 2')
            return
         end do
      end associate
   end subroutine add_short_zones

   !> Whether a point exists and belongs to the zone.
   pure logical function is_in(is_inside, point)
      logical, intent(in) :: is_inside(:) !! which points belong to the zone (m)
      integer, intent(in) :: point !! the point, 0 for none

      is_in = point > 0
      if (is_in) is_in = is_inside(point)
   end function is_in

   !> A clause on the estimated error at some contact points, for the end of a sentence; empty without an estimate.
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

   !> The share of the elements at some contact points in the square of the estimated error; 0 without an estimate, and
   !> for cells, whose ends are no nodes [-].
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

end module amontons_result_warnings
