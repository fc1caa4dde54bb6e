!> The section of a listing on the model: mesh, materials, supports, contact sets, loads.
module amontons_listing_model
   use amontons_body, only: body_t
   use amontons_constraints, only: support_t, supported_components
   use amontons_contact_rows, only: turned
   use amontons_contact_set, only: contact_t, gap_names, line_field_t
   use amontons_element, only: quad4
   use amontons_kinds, only: dp
   use amontons_listing_text, only: heading, labeled, pair_text, short_text, with_unit
   use amontons_load_case, only: load_case_t
   use amontons_loads, only: load_by_temperature, load_on_nodes, load_on_sides, load_t
   use amontons_material, only: material_t
   use amontons_model_warnings, only: mean_length
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_text, only: counted, line_end, to_text
   implicit none (type, external)
   private

   public :: model_text

contains

   !> Mesh, material, supports, contact sets and loads.
   function model_text(body, load_case, units) result(text)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its supports, obstacles and loads
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer :: i

      text = heading('Model')
      if (allocated(body%mesh%source)) text = text//labeled('Mesh', body%mesh%source)
      text = text//labeled('Nodes, elements', to_text(body%mesh%n_nodes)//', '//to_text(body%mesh%n_elements))// &
         labeled('Unknowns', to_text(body%dof_map%n_dofs)//', of them '//to_text(body%dof_map%n_schur)// &
         ' on the contact line')
      do i = 1, size(body%materials%list)
         text = text//labeled('Material', material_text(body%materials%list(i), any(body%mesh%element_kind == quad4), &
            units))
      end do
      do i = 1, size(load_case%supports)
         text = text//labeled('Support', support_text(load_case%supports(i), units))
      end do
      do i = 1, size(load_case%contacts)
         text = text//labeled('Contact', contact_text(load_case%contacts(i), units))
         if (load_case%contacts(i)%partition%is_constant) text = text//cells_text(body, i, units)
         if (body%zone%pairs(i)%is_set()) text = text//labeled('Sides', roles_text(body%zone%pairs(i), units))
      end do
      do i = 1, size(body%ties)
         text = text//labeled('Tie', body%ties(i)%label//' (slave/master)')// &
            labeled('Sides', roles_text(body%ties(i), units))
      end do
      text = text//labeled('Contact points', to_text(body%zone%n_points))//mesh_notes_text(body)// &
         notes_text(body, load_case, units)
      do i = 1, size(load_case%loads)
         text = text//labeled('Load', load_text(load_case%loads(i), units))
      end do
   end function model_text

   !> What a material is.
   pure function material_text(material, has_quad4, units) result(text)
      type(material_t), intent(in) :: material !! the material
      logical, intent(in) :: has_quad4 !! whether the mesh has linear quadrilaterals
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      text = trim(material%hypothesis)//', Young '//with_unit(short_text(material%young), units, 'F/L^2')// &
         ', Poisson '//short_text(material%poisson)
      if (.not. material%is_axisymmetric) text = text//', thickness '// &
         with_unit(short_text(material%thickness), units, 'L')
      if (material%density > 0.0_dp) text = text//', density '//short_text(material%density)
      if (abs(material%expansion) > 0.0_dp) text = text//', expansion '//short_text(material%expansion)
      if (material%has_mean_dilatation .and. has_quad4) text = text//', quad4 of B-bar formulation'
      if (len(material%region) > 0) text = text//", region '"//material%region//"'"
   end function material_text

   !> What a support holds.
   pure function support_text(support, units) result(text)
      type(support_t), intent(in) :: support !! the support
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer :: k

      if (len(support%set) > 0) then
         text = "set '"//support%set//"'"
      else
         text = 'point '//with_unit(pair_text(support%point), units, 'L')
      end if
      do k = 1, size(supported_components)
         if (support%is_held(k)) text = text//', '//supported_components(k)//' = '// &
            with_unit(short_text(support%displacement(k)), units, 'L')
      end do
      if (any(support%spring > 0.0_dp)) text = text//', springs '// &
         with_unit(pair_text(support%spring), units, 'F/L^3')//' along normal and tangent'
   end function support_text

   !> What a contact set may touch, and how it rubs.
   pure function contact_text(contact, units) result(text)
      type(contact_t), intent(in) :: contact !! the contact set
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      text = "set '"//contact%set//"'"
      if (contact%pairing%is_pair()) text = text//" (slave) against '"//contact%pairing%against//"' (master)"
      text = text//field_text('friction', contact%friction)// &
         field_text('slip bound', contact%slip_bound)
      if (contact%pairing%is_pair()) then
         if (contact%pairing%gap /= gap_names(1)) text = text//', '//trim(contact%pairing%gap)
         if (contact%pairing%search > 0.0_dp) text = text//', search '// &
            with_unit(short_text(contact%pairing%search), units, 'L')
      else
         text = text//obstacle_text(contact, units)
      end if
      if (abs(contact%extra_gap) > 0.0_dp) text = text//', extra gap '// &
         with_unit(short_text(contact%extra_gap), units, 'L')
   end function contact_text

   !> How long the sides of slave and master are, which is what their roles should follow.
   pure function roles_text(pair, units) result(text)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      text = 'slave '//with_unit(short_text(mean_length(pair%slave)), units, 'L')//', master '// &
         with_unit(short_text(mean_length(pair%master)), units, 'L')// &
         ' on average; forces are resolved on the slave, which should be the finer one'
   end function roles_text

   !> The rigid obstacle of a contact set.
   pure function obstacle_text(contact, units) result(text)
      type(contact_t), intent(in) :: contact !! the contact set
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      associate (obstacle => contact%obstacle)
         text = ', '//trim(obstacle%kind)//' at '//with_unit(pair_text(obstacle%point), units, 'L')// &
            ' with normal '//pair_text(obstacle%normal)
         if (obstacle%has_radius()) text = text//', radius '//with_unit(short_text(obstacle%radius), units, 'L')
         if (obstacle%kind == 'polyline') text = text//', points of '//obstacle%file
         if (any(abs(contact%direction) > 0.0_dp)) text = text//', gaps along '//pair_text(contact%direction)
      end associate
   end function obstacle_text

   !> The cells of the constant multipliers of a contact set, and how well the mesh can tell them apart.
   pure function cells_text(body, i, units) result(text)
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: i !! which contact set
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      real(dp), allocatable :: lengths(:)

      lengths = pack(body%zone%weight, body%zone%set == i)
      text = labeled('Multipliers', 'constant on '//to_text(size(lengths))//' cells of length '// &
         short_text(minval(lengths))// &
         ' to '//with_unit(short_text(maxval(lengths)), units, 'L'))// &
         labeled('Inf-sup constant', short_text(body%inf_sup(i)))
   end function cells_text

   !> A quantity along a contact line; nothing where it is zero.
   pure function field_text(name, field) result(text)
      character(*), intent(in) :: name !! what it is
      type(line_field_t), intent(in) :: field !! the quantity
      character(:), allocatable :: text

      text = ''
      if (allocated(field%table)) then
         text = ', '//name//' from '//field%file
      else if (any(abs(field%slope) > 0.0_dp)) then
         text = ', '//name//' '//short_text(field%value)//' + '//pair_text(field%slope)//' . (x, y)'
      else if (abs(field%value) > 0.0_dp .or. name == 'friction') then
         text = ', '//name//' '//short_text(field%value)
      end if
   end function field_text

   !> What was put right in the mesh file.
   pure function mesh_notes_text(body) result(text)
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable :: text
      integer :: first, last

      text = ''
      first = 1
      do while (first <= len(body%mesh_notes))
         last = line_end(body%mesh_notes, first)
         text = text//labeled('Note', body%mesh_notes(first:last))
         first = last + 2
      end do
   end function mesh_notes_text

   !> What the reader must know of the contact points: what supports take over, overlap, free motions.
   pure function notes_text(body, load_case, units) result(text)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer :: i

      text = ''
      associate (zone => body%zone)
         if (any(body%motions%n_free > 0)) text = text//labeled('Note', modes_text(sum(body%motions%n_free)))
         text = text//points_text(body%mesh%coordinates(:, zone%held_node), 'node', &
            ' is not a contact point: supports hold it', ' are not contact points: supports hold them', units)
         text = text//points_text(body%mesh%coordinates(:, zone%zero_area_node), 'node', &
            ' is not a contact point: at the axis it has no area that a pressure could act on', &
            ' are not contact points: at the axis they have no area that a pressure could act on', units)
         text = text//points_text(body%mesh%coordinates(:, zone%shared_node), 'node', &
            ' belongs to two sets: to a tie, or else to the contact set named first', &
            ' belong to two sets: to a tie, or else to the contact set named first', units)
         do i = 1, size(zone%pairs)
            if (zone%pairs(i)%is_set()) text = text//joined_text(body%mesh%coordinates(:, zone%pairs(i)%joined_node), &
               units)
         end do
         do i = 1, size(body%ties)
            text = text//joined_text(body%mesh%coordinates(:, body%ties(i)%joined_node), units)
         end do
         text = text//guided_text(body, units)
         if (zone%n_held_cells > 0) text = text//labeled('Note', 'not contact points, since supports hold '// &
            'their nodes: '//counted(zone%n_held_cells, 'cell')//' of constant multipliers')
         text = text//overlap_text(body, load_case, units)
      end associate
   end function notes_text

   !> A note on the initial overlap, where there is more than rounding leaves of coordinates.
   pure function overlap_text(body, load_case, units) result(text)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      ! What sums and differences of coordinates leave of a gap of 0, over the largest coordinate.
      real(dp), parameter :: rounding = 1.0e-12_dp
      integer :: p

      text = ''
      p = minloc(load_case%gap, dim=1)
      if (p == 0) return
      if (.not. -load_case%gap(p) > rounding*maxval(abs(body%mesh%coordinates))) return
      text = 'the body overlaps the obstacle'
      if (body%zone%pairs(body%zone%set(p))%is_set()) text = 'the bodies overlap'
      text = labeled('Note', text//' by up to '//with_unit(short_text(-load_case%gap(p)), units, 'L')//' at the start')
   end function overlap_text

   !> Where the bodies of a pair are one at an end of the slave.
   pure function joined_text(positions, units) result(text)
      real(dp), intent(in) :: positions(:, :) !! the nodes that slave and master share (2, nodes) [L]
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      text = points_text(positions, 'node', ' is not a contact point: it belongs to slave and master', &
         ' are not contact points: they belong to slave and master', units)
   end function joined_text

   !> What a body without sufficient supports depends on.
   pure function modes_text(n_modes) result(text)
      integer, intent(in) :: n_modes !! how many rigid-body modes the supports leave free, 1 or more
      character(:), allocatable :: text

      text = to_text(n_modes)//' rigid-body modes are not constrained by supports; only contact holds them'
      if (n_modes == 1) text = '1 rigid-body mode is not constrained by supports; only contact holds it'
   end function modes_text

   !> Notes on points that something holds for: one for each or, where there are many, one for all.
   pure function points_text(places, noun, singular, plural, units) result(text)
      real(dp), intent(in) :: places(:, :) !! where they are (2, n) [L]
      character(*), intent(in) :: noun !! what they are called
      character(*), intent(in) :: singular !! what holds for one of them, with a blank before it
      character(*), intent(in) :: plural !! what holds for all of them, with a blank before it
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer, parameter :: few = 3
      integer :: i

      text = ''
      if (size(places, 2) > few) then
         text = labeled('Note', counted(size(places, 2), noun)//', the first at '// &
            with_unit(pair_text(places(:, 1)), units, 'L')//','//plural)
         return
      end if
      do i = 1, size(places, 2)
         text = text//labeled('Note', 'the '//noun//' at '//with_unit(pair_text(places(:, i)), units, 'L')//singular)
      end do
   end function points_text

   !> What supports of contact points do to their friction.
   pure function guided_text(body, units) result(text)
      type(body_t), intent(in) :: body !! the body
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      logical :: is_guided(body%zone%n_points), is_aslant(body%zone%n_points)
      character(4) :: noun
      integer :: p

      associate (zone => body%zone)
         is_guided = zone%is_tangent_fixed
         is_aslant = [(is_guided(p) .and. slides(body, p), p=1, zone%n_points)]
         is_guided = is_guided .and. .not. is_aslant
         noun = merge('cell', 'node', any(zone%is_cell))
         text = points_text(zone%position(:, pack([(p, p=1, zone%n_points)], is_aslant)), noun, &
            ' slides without friction: a support that is aslant to the obstacle guides it', &
            ' slide without friction: a support that is aslant to the obstacle guides them', units)// &
            points_text(zone%position(:, pack([(p, p=1, zone%n_points)], is_guided)), noun, &
            ' cannot slide: a support bears its tangential force', &
            ' cannot slide: a support bears their tangential forces', units)
      end associate
   end function guided_text

   !> Whether a support that is aslant to the obstacle lets a point slide.
   pure logical function slides(body, p)
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: p !! number of the point
      integer :: k

      slides = any([(body%constraints%leaves_free(body%zone%rows%node(k), turned(body%zone%normal(:, p))), &
         k=body%zone%rows%start(p), body%zone%rows%start(p + 1) - 1)])
   end function slides

   !> What a load is.
   pure function load_text(load, units) result(text)
      type(load_t), intent(in) :: load !! the load
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      text = ''
      if (len(load%name) > 0) text = load%name//': '
      if (len(load%set) > 0) text = text//"set '"//load%set//"', "
      if (len(load%region) > 0) text = text//"region '"//load%region//"', "
      select case (load%target)
      case (load_on_sides)
         text = text//'traction '//with_unit(pair_text(load%traction), units, 'F/L^2')// &
            ', pressure '//with_unit(short_text(load%pressure), units, 'F/L^2')
         if (any(abs(load%traction_slope) > 0.0_dp)) text = text//', traction slope '// &
            pair_text(load%traction_slope(:, 1))//' along x, '//pair_text(load%traction_slope(:, 2))//' along y'
         if (any(abs(load%pressure_slope) > 0.0_dp)) text = text//', pressure slope '//pair_text(load%pressure_slope)
      case (load_on_nodes)
         if (len(load%set) == 0) text = text//'point '//with_unit(pair_text(load%point), units, 'L')//', '
         text = text//'force '//with_unit(pair_text(load%force), units, 'F')
      case (load_by_temperature)
         text = text//temperature_text(load)
      case default
         text = text//body_force_text(load, units)
      end select
   end function load_text

   !> What acts on the volume.
   pure function body_force_text(load, units) result(text)
      type(load_t), intent(in) :: load !! the load
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      text = ''
      if (any(abs(load%body_force) > 0.0_dp)) text = text//', body force '//with_unit(pair_text(load%body_force), &
         units, 'F/L^3')
      if (any(abs(load%gravity) > 0.0_dp)) text = text//', gravity '//pair_text(load%gravity)
      if (abs(load%angular_speed) > 0.0_dp) then
         text = text//', angular speed '//short_text(load%angular_speed)//' about '// &
            with_unit(pair_text(load%center), units, 'L')
         if (any(abs(load%axis) > 0.0_dp)) text = text//' along '//pair_text(load%axis)
      end if
      if (text == '') text = ', body force '//with_unit(pair_text(load%body_force), units, 'F/L^3')
      text = text(3:)
   end function body_force_text

   !> What temperature a load is.
   pure function temperature_text(load) result(text)
      type(load_t), intent(in) :: load !! the load
      character(:), allocatable :: text

      if (allocated(load%temperature_table)) then
         text = 'temperature from '//load%temperature_file
      else
         text = 'temperature '//short_text(load%temperature)
         if (any(abs(load%temperature_slope) > 0.0_dp)) text = text//' + '//pair_text(load%temperature_slope)// &
            ' . (x, y)'
      end if
   end function temperature_text

end module amontons_listing_model
