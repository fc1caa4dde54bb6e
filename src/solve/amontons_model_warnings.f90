!> Warnings on a model before it is solved: a body, its contact sets and pairs, a sweep.
module amontons_model_warnings
   use amontons_body, only: body_t
   use amontons_contact_set, only: line_field_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_element, only: n_element_nodes
   use amontons_error, only: error_t, warning_list_t
   use amontons_history, only: history_t, stepped_friction
   use amontons_inf_sup, only: poor_inf_sup
   use amontons_kinds, only: dp
   use amontons_load_family, only: load_case_t
   use amontons_loads, only: load_by_temperature, load_on_nodes
   use amontons_material, only: on_axis
   use amontons_mesh, only: find_set, number_pieces
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_obstacle, only: find_self_crossing
   use amontons_pair_substitution, only: bonds_of
   use amontons_rounding, only: exceeds, input_rounding
   use amontons_surface, only: surface_t
   use amontons_sweep, only: sweep_t, swept_friction, swept_friction_factor
   use amontons_text, only: counted, scientific, short_text, to_text, vector_text
   implicit none (type, external)
   private

   public :: add_history_warnings, add_model_warnings, add_sweep_warnings, facing_lengths, percent

   !> Largest initial overlap without a warning, as a share of the body's size [-].
   real(dp), parameter :: large_overlap = 0.01_dp
   !> Smallest friction coefficient with a warning [-].
   real(dp), parameter :: large_friction = 2.0_dp

contains

   !> A share as a percentage of three digits.
   pure function percent(share) result(text)
      real(dp), intent(in) :: share !! the share [-]
      character(:), allocatable :: text
      ! A larger share could be rounded to more than 100 percent.
      real(dp), parameter :: most = 1.0e300_dp

      text = scientific(min(100.0_dp*share, most))//' %'
   end function percent

   !> Adds the warnings on a body and its contact sets.
   pure subroutine add_model_warnings(warnings, body, load_case)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      real(dp), parameter :: radial(2) = [1.0_dp, 0.0_dp]
      integer :: i, n_free, n_pieces, node
      integer, allocatable :: nodes(:), piece(:)
      type(error_t), allocatable :: error

      do i = 1, body%mesh%warnings%n()
         call warnings%add(body%mesh%warnings%item(i))
      end do
      call add_material_warnings(warnings, body, load_case)
      associate (stated => body%mesh%hypothesis, hypothesis => body%materials%list(1)%hypothesis)
         if (stated /= '' .and. stated /= hypothesis) call warnings%add('the elements of the mesh file are of type '// &
            trim(stated)//', the deck computes '//trim(hypothesis))
      end associate
      do i = 1, size(load_case%contacts)
         if (any(body%zone%set == i)) then
            call add_contact_warnings(warnings, body, load_case, i)
         else
            call warnings%add("contact set '"//load_case%contacts(i)%set//"': no contact points; supports hold all "// &
               'its nodes along their normals, or it lies on the axis of revolution')
         end if
         if (.not. body%zone%pairs(i)%is_set()) cycle
         call add_pair_warnings(warnings, body%zone%pairs(i))
         if (load_case%contacts(i)%pairing%has_mesh_gap()) call add_gap_warnings(warnings, body%zone%pairs(i), &
            pack(load_case%gap, body%zone%set == i), pack(load_case%extra_gap, body%zone%set == i))
      end do
      do i = 1, size(body%ties)
         call add_pair_warnings(warnings, body%ties(i))
      end do
      ! Supports and loads at points where bodies that are not joined have nodes.
      do i = 1, size(load_case%supports)
         if (len(load_case%supports(i)%set) == 0) call add_shared_place(warnings, 'support', body%mesh%coordinates, &
            load_case%supports(i)%point)
      end do
      do i = 1, size(load_case%loads)
         if (load_case%loads(i)%target == load_on_nodes .and. len(load_case%loads(i)%set) == 0) call add_shared_place( &
            warnings, 'load', body%mesh%coordinates, load_case%loads(i)%point)
      end do
      ! Forces that act on each node of a boundary set: their sum grows with the number of nodes.
      do i = 1, size(load_case%loads)
         associate (load => load_case%loads(i))
            if (load%target /= load_on_nodes .or. len(load%set) == 0) cycle
            if (find_set(body%mesh%node_sets, load%set) > 0) cycle
            call body%mesh%set_nodes(load%set, nodes, error)
            if (size(nodes) > 1) call warnings%add("the force on set '"//load%set//"' acts on each of its "// &
               to_text(size(nodes))//' nodes, '// &
               vector_text(size(nodes)*load%force(:size(body%mesh%coordinates, 1)))//' in all; total_force '// &
               'gives the sum')
         end associate
      end do
      ! Parts of a mesh that share no nodes and that no contact or tie joins.
      if (body%mesh%has_pieces) then
         associate (bonds => bonds_of([body%ties, body%zone%pairs], body%constraints))
            call number_pieces(body%mesh, piece, n_pieces, bonds(:2, :))
         end associate
         if (n_pieces > 1) call warnings%add('the body consists of '//to_text(n_pieces)//' pieces that share no '// &
            'nodes and that no pair of contact sets or tie joins')
      end if
      nodes = pack([(node, node=1, body%mesh%n_nodes)], on_axis(body%mesh, body%materials))
      n_free = count([(body%constraints%leaves_free(nodes(i), radial), i=1, size(nodes))])
      if (n_free > 0) call warnings%add(counted(n_free, 'node')//' on the axis of revolution '// &
         trim(merge('is ', 'are', n_free == 1))//' not held radially; add a support with ux = 0.0')
   end subroutine add_model_warnings

   !> Adds the warnings on the materials of a body.
   pure subroutine add_material_warnings(warnings, body, load_case)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      logical :: locks(body%mesh%n_elements), is_simplex(body%mesh%n_elements)
      character(:), allocatable :: material, simplex

      associate (list => body%materials%list, of_element => body%materials%of_element, &
         n_dim => size(body%mesh%coordinates, 1))
         is_simplex = n_element_nodes(body%mesh%element_kind) == n_dim + 1
         simplex = trim(merge('tri3', 'tet4', n_dim == 2))
         locks = list(of_element)%locks() .and. (is_simplex .or. .not. list(of_element)%is_b_bar)
         material = " of a nearly incompressible material (Poisson's ratio "//short_text(maxval(list%poisson(1)))//') '
         if (any(locks .and. is_simplex)) call warnings%add(to_text(count(locks .and. is_simplex))// &
            ' linear elements ('//simplex//')'//material//'lock: stresses and forces are too large, by far near '// &
            '0.5; use '//trim(merge('tri6 or quadrilaterals', 'tet10 or hexahedra    ', n_dim == 2)))
         associate (n_stiff => count(is_simplex .and. n_dim == 3 .and. .not. locks))
            if (n_stiff > 0) call warnings%add(counted(n_stiff, 'linear element')//' (tet4): far too stiff in '// &
               "bending, and the more so the larger Poisson's ratio is; use tet10 or hexahedra, or see with "// &
               '--refine 2 what converges')
         end associate
      end associate
      if (any(locks .and. .not. is_simplex)) call warnings%add(to_text(count(locks .and. .not. is_simplex))// &
         ' elements'//material//'are of the standard formulation: linear ones lock, and the stresses of quadratic '// &
         "ones alternate; use formulation = 'b-bar'")
      associate (poisson => minval(body%materials%list%poisson(1)))
         if (poisson < 0.0_dp) call warnings%add("Poisson's ratio of "//short_text(poisson)// &
            '; negative ratios are rare')
      end associate
      if (any(body%materials%list%formulation == 'b-bar') .and. all(is_simplex)) call warnings%add( &
         "formulation = 'b-bar' has no effect: all elements of the mesh are "//simplex)
      if (any(load_case%loads%target == load_by_temperature) .and. .not. &
         any(abs(body%materials%list%largest_expansion()) > 0.0_dp)) call warnings%add( &
         'temperature has no effect: no material has a coefficient of thermal expansion')
   end subroutine add_material_warnings

   !> Warns of a support or load at a point where several bodies that are not joined have a node.
   pure subroutine add_shared_place(warnings, what, coordinates, point)
      type(warning_list_t), intent(inout) :: warnings !! gains the warning
      character(*), intent(in) :: what !! support or load
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      real(dp), intent(in) :: point(3) !! the point [L]
      real(dp) :: reach
      integer :: n, n_dim

      reach = input_rounding*maxval(maxval(coordinates, dim=2) - minval(coordinates, dim=2))
      n_dim = size(coordinates, 1)
      n = count(norm2(coordinates - spread(point(:n_dim), 2, size(coordinates, 2)), dim=1) <= reach)
      if (n > 1) call warnings%add('the '//what//' at the point '//warnings%place(point(:n_dim))// &
         ' acts on one node, of '//to_text(n)// &
         ' there that are not joined: the first of the mesh; name a set to choose another one')
   end subroutine add_shared_place

   !> Adds the warnings on a contact set that do not depend on the solution.
   pure subroutine add_contact_warnings(warnings, body, load_case, set)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      integer, intent(in) :: set !! number of the contact set, which has points
      character(:), allocatable :: name
      logical :: is_of_set(body%zone%n_points), crosses
      real(dp) :: place(2)

      name = "contact set '"//load_case%contacts(set)%set//"': "
      is_of_set = body%zone%set == set
      associate (zone => body%zone, size => body%size)
         if (body%inf_sup(set) < poor_inf_sup) call warnings%add(name//'the inf-sup constant '// &
            short_text(body%inf_sup(set))//' is below '//short_text(poor_inf_sup)// &
            '; forces and statuses may oscillate from cell to cell; make the cells larger')
         associate (overlap => maxval(-load_case%gap, mask=is_of_set))
            if (exceeds(overlap, large_overlap*size)) call warnings%add(name//'initial overlap of '// &
               warnings%number(overlap, 'L')//', '//percent(overlap/size)//" of the body's size")
         end associate
         call add_large_friction(warnings, name, maxval(load_case%friction, mask=is_of_set))
         if (all(all(zone%is_fixed, dim=1) .or. .not. is_of_set) .and. &
            any(is_of_set .and. max(load_case%friction, load_case%slip_bound) > 0.0_dp)) call warnings%add(name// &
            'friction has no effect: supports hold all its points tangentially')
         if (allocated(load_case%contacts(set)%obstacle%line)) then
            call find_self_crossing(load_case%contacts(set)%obstacle%line, crosses, place)
            if (crosses) call warnings%add(name//'the polyline of the obstacle crosses itself at '// &
               warnings%place(place)//' of its file: its inside is undefined there')
         end if
         call add_table_warning(warnings, name//'friction_table', load_case%contacts(set)%friction, zone, set)
         call add_table_warning(warnings, name//'slip_bound_table', load_case%contacts(set)%slip_bound, zone, set)
         call add_table_warning(warnings, name//'gap_table', load_case%contacts(set)%extra_gap, zone, set)
         associate (n_buried => count(is_of_set .and. load_case%depth > input_rounding*size))
            if (n_buried > 0) call warnings%add(name//'left open inside the obstacle: '// &
               counted(n_buried, 'point')//'; their normals do not meet its surface, or at more than '// &
               '84 degrees; check set and obstacle')
         end associate
      end associate
   end subroutine add_contact_warnings

   !> Warns of a table along the line that has no abscissa within the line.
   pure subroutine add_table_warning(warnings, name, field, zone, set)
      type(warning_list_t), intent(inout) :: warnings !! gains the warning
      character(*), intent(in) :: name !! name of the table
      type(line_field_t), intent(in) :: field !! the quantity, with or without a table
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: set !! number of the contact set
      real(dp) :: length
      integer :: p

      if (.not. allocated(field%table)) return
      length = 0.0_dp
      do p = 1, zone%n_points
         if (zone%set(p) == set) length = max(length, maxval(zone%quadrature%arc_length(zone%quadrature%start(p): &
            zone%quadrature%start(p + 1) - 1)))
      end do
      if (exceeds(length, minval(field%table(1, :))) .and. maxval(field%table(1, :)) > 0.0_dp) return
      call warnings%add(name//' has no station on the contact line, whose length is '// &
         warnings%number(length, 'L')//': it gives one value')
   end subroutine add_table_warning

   !> Warns of a friction coefficient that is probably an error.
   pure subroutine add_large_friction(warnings, name, friction)
      type(warning_list_t), intent(inout) :: warnings !! gains the warning
      character(*), intent(in) :: name !! beginning of the warning
      real(dp), intent(in) :: friction !! the largest coefficient [-]

      if (friction > large_friction) call warnings%add(name//'friction of '//short_text(friction)// &
         '; coefficients above '//short_text(large_friction)//' are rare')
   end subroutine add_large_friction

   !> Adds the warnings on the values of a sweep: one given twice, friction that is large or has no effect.
   pure subroutine add_sweep_warnings(warnings, sweep, load_case, set)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(sweep_t), intent(in) :: sweep !! the sweep, which is given
      type(load_case_t), intent(in) :: load_case !! the load case of the deck, without factors
      integer, intent(in) :: set(:) !! the contact set of each point (m)
      logical :: is_varied(size(load_case%contacts))
      integer :: i, k

      do i = 1, size(sweep%axes)
         associate (axis => sweep%axes(i), name => 'sweep of '//sweep%axes(i)%label()//': ')
            ! A value that a list gives twice; equal steps repeat one only if they are 0.
            do k = 2, merge(2, size(axis%values), axis%is_range)
               if (.not. any(abs(axis%values(:k - 1) - axis%values(k)) <= 0.0_dp)) cycle
               call warnings%add(name//'the value '//short_text(axis%values(k))//' is given twice')
               exit
            end do
            if (axis%target == swept_friction) call add_large_friction(warnings, name, maxval(axis%values))
            if (axis%target /= swept_friction_factor) cycle
            is_varied = [(axis%acts_on(load_case%contacts(k)%set), k=1, size(is_varied))]
            call add_large_friction(warnings, name, maxval(axis%values)*maxval(load_case%friction, mask=is_varied(set)))
            is_varied = is_varied .and. [(.not. load_case%contacts(k)%friction%vanishes(), k=1, size(is_varied))]
            if (.not. any(is_varied)) call warnings%add(name//'no effect: the friction is 0')
         end associate
      end do
   end subroutine add_sweep_warnings

   !> Adds the warnings on the changes of a load history.
   pure subroutine add_history_warnings(warnings, history, load_case, set)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(history_t), intent(in) :: history !! the history, which is given
      type(load_case_t), intent(in) :: load_case !! the load case of the deck, without factors
      integer, intent(in) :: set(:) !! the contact set of each point (m)
      logical :: is_varied(size(load_case%contacts))
      integer :: i, k

      do i = 1, size(history%steps)
         associate (steps => history%steps(i))
            if (steps%target /= stepped_friction) cycle
            is_varied = [(steps%acts_on(load_case%contacts(k)), k=1, size(is_varied))]
            call add_large_friction(warnings, steps%label(1, 0)//': ', steps%largest()*maxval(load_case%friction, &
               mask=is_varied(set)))
         end associate
      end do
   end subroutine add_history_warnings

   !> Adds the warnings on a pair, in contact or bonded.
   pure subroutine add_pair_warnings(warnings, pair)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(mortar_pair_t), intent(in) :: pair !! the pair
      ! Sides of the slave that are longer than the master's by more than half spoil the contact.
      real(dp), parameter :: coarse = 1.5_dp
      character(:), allocatable :: name
      real(dp) :: lengths(2), depths(2)

      name = pair%label//': '
      if (size(pair%open_node) > 0) call warnings%add(name//'left open: '// &
         counted(size(pair%open_node), 'node')//' of the slave, without a master within '// &
         warnings%number(pair%search, 'L'))
      if (size(pair%idle_side, 2) > 0) call warnings%add(name//'nothing acts on '// &
         counted(size(pair%idle_side, 2), 'side')//', the first at '//warnings%place(pair%idle_side(:, 1))// &
         ': both ends belong to ties or to contact sets named before; refine the mesh there, or name this set first')
      lengths = facing_lengths(pair)
      if (exceeds(lengths(1), coarse*lengths(2))) call warnings%add(name// &
         'the slave is coarser than the master (sides '// &
         short_text(lengths(1))//' against '//warnings%number(lengths(2), 'L')//'): exchange both sets for a '// &
         'sharper contact')
      depths = [pair%slave%material(1)%thickness, pair%master%material(1)%thickness]
      if (abs(depths(1) - depths(2)) > epsilon(1.0_dp)*depths(1)) call warnings%add(name//'the thicknesses differ ('// &
         short_text(depths(1))//', '//warnings%number(depths(2), 'L')//'): forces are matched, stresses '// &
         'are those of the slave')
   end subroutine add_pair_warnings

   !> Adds the warnings on the gaps that the meshes of a pair in contact have.
   pure subroutine add_gap_warnings(warnings, pair, gap, extra_gap)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(mortar_pair_t), intent(in) :: pair !! the pair
      real(dp), intent(in) :: gap(:) !! gaps of its points, with what the deck adds [L]
      real(dp), intent(in) :: extra_gap(:) !! addition of the deck [L]
      ! Gaps larger than the bulge of sides by this factor are well resolved.
      real(dp), parameter :: resolved = 10.0_dp
      character(:), allocatable :: name
      real(dp) :: bulge, overlap

      if (size(gap) == 0) return
      name = pair%label//': '
      bulge = largest_bulge(pair%slave) + largest_bulge(pair%master)
      overlap = maxval(extra_gap - gap)
      if (bulge > input_rounding*pair%slave%longest .and. maxval(abs(gap)) < resolved*bulge) then
         call warnings%add(name//'gaps and interference of up to '// &
            warnings%number(maxval(abs(gap)), 'L')//' are not much larger than the distance between the two '// &
            'polygons ('//warnings%number(bulge, 'L')//"): refine, use quadratic elements, or gap = 'touching'")
      else if (overlap > input_rounding*pair%slave%longest) then
         call warnings%add(name//'the meshes overlap by up to '// &
            warnings%number(overlap, 'L')//' before any load: give '// &
            "extra_gap for an interference, or gap = 'touching'")
      end if
   end subroutine add_gap_warnings

   !> Mean lengths of the sides of slave and master that face each other (2) [L].
   pure function facing_lengths(pair) result(lengths)
      type(mortar_pair_t), intent(in) :: pair !! the pair, with segments
      real(dp) :: lengths(2)

      lengths = [mean_length(pair%slave, pair%segments%slave), mean_length(pair%master, pair%segments%master)]
   end function facing_lengths

   !> Mean length of some sides of a surface, of all for none [L].
   pure real(dp) function mean_length(surface, sides)
      type(surface_t), intent(in) :: surface !! the surface
      integer, intent(in) :: sides(:) !! numbers of the sides, each any number of times
      logical :: is_met(surface%n_sides)

      is_met = .false.
      is_met(sides) = .true.
      if (size(sides) == 0) is_met = .true.
      mean_length = sum(norm2(surface%corner(:, 2, :) - surface%corner(:, 1, :), dim=1), mask=is_met)/count(is_met)
   end function mean_length

   !> Largest distance of straight sides from the curve that they approximate: their length times the angle between the
   !> normals at both ends, over 8. Curved sides have none [L].
   pure real(dp) function largest_bulge(surface) result(bulge)
      type(surface_t), intent(in) :: surface !! the surface
      integer :: i, k

      bulge = 0.0_dp
      do i = 1, surface%n_sides
         associate (n => surface%n_corners(i), corner => surface%corner(:, :, i), normal => surface%normal(:, :, i))
            if (surface%n_nodes(i) > n) cycle
            do k = 2, n
               bulge = max(bulge, norm2(corner(:, k) - corner(:, k - 1))*norm2(normal(:, k) - normal(:, k - 1))/8.0_dp)
            end do
         end associate
      end do
   end function largest_bulge

end module amontons_model_warnings
