!> The model in the input format of Abaqus and CalculiX: materials, sections, which assign them to sets of elements,
!> initial temperatures of nodes (without strain) and those of the step, supports and loads; steps keep, replace and end
!> what was given before them. And pairs of surfaces, in contact with friction or bonded.
module amontons_abaqus_model
   use amontons_abaqus_lines, only: add_members, capitals, degree, next_data_line, parameter_of, place_of_name, &
      read_tag, refuse_parameters, rotation_matrix, set_of_field, take_fields, take_line_of_numbers, take_number
   use amontons_constraints, only: new_support, supported_components
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_file_model, only: file_condition_t, file_contact_t, file_material_t, file_temperatures_t, &
      longest_name, raw_mesh_t, use_contact, use_loads, use_materials, use_supports
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t, new_tag_map
   use amontons_kinds, only: dp, int64
   use amontons_loads, only: load_by_temperature, load_on_nodes, load_on_region, load_t, new_load
   use amontons_material, only: new_material, no_hypothesis
   use amontons_text, only: counted, lower_case, read_integer, to_text
   implicit none (type, external)
   private

   public :: finish_model, model_keywords, model_uses, read_model_keyword

   !> Keywords that may be read in addition to the mesh.
   character(18), parameter :: model_keywords(*) = [character(18) :: 'material', 'elastic', 'density', 'expansion', &
      'orientation', 'solidsection', 'boundary', 'cload', 'dload', 'dsload', 'temperature', 'surfaceinteraction', &
      'friction', 'surfacebehavior', 'contactpair', 'tie']
   !> The part of the model to which each of these keywords belongs: materials, supports, loads or contact.
   integer, parameter :: model_uses(*) = [spread(use_materials, 1, 6), use_supports, spread(use_loads, 1, 4), &
      spread(use_contact, 1, 5)]
   !> Temperature of a node to which the step gives none.
   real(dp), parameter :: not_given = huge(1.0_dp)
   !> Largest number of fields of a data line; the temperatures of a shell follow that of its first point.
   integer, parameter :: most_fields = 9
   !> Names of pressures on the sides of an element.
   character(*), parameter :: side_labels(*) = ['p1', 'p2', 'p3', 'p4', 'p5', 'p6']
   !> Number of constants of an orthotropic material: three moduli, ratios of Poisson and shear moduli.
   integer, parameter :: n_engineering_constants = 9

contains

   !> Reads a keyword with its data lines if the deck uses this part of the model.
   pure subroutine read_model_keyword(raw, input, keyword, line, is_read)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file; gains materials, supports, loads and their sets
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! the keyword in small letters
      character(*), intent(in) :: line !! the keyword line
      logical, intent(out) :: is_read !! whether it was one; of a step: whether displacements are small
      integer :: place

      place = findloc(model_keywords == keyword, .true., dim=1)
      associate (is_used => raw%model%is_used)
         is_read = any(is_used([use_supports, use_loads]))
         if (place > 0) is_read = is_used(model_uses(place))
         if (keyword == 'initialconditions') is_read = is_used(use_loads)
      end associate
      if (.not. is_read) return
      select case (keyword)
      case ('material', 'elastic', 'density', 'expansion')
         call read_material_keyword(raw, input, keyword, line)
      case ('orientation')
         call read_orientation(raw, input, line)
      case ('solidsection')
         call read_section(raw, input, line)
      case ('boundary', 'cload', 'dload', 'dsload')
         call read_conditions(raw, input, keyword, line)
      case ('temperature', 'initialconditions')
         call read_temperatures(raw, input, keyword, line, is_read)
      case ('surfaceinteraction', 'friction', 'surfacebehavior')
         call read_interaction(raw, input, keyword, line)
      case ('contactpair', 'tie')
         call read_pairs(raw, input, keyword, line)
      case ('step')
         associate (model => raw%model)
            model%n_steps = model%n_steps + 1
            if (model%n_steps > 1 .and. model%step == 0) call input%refuse_line( &
               'a second *STEP: &mesh step = 2 uses the supports and loads of this one, and what it keeps of the first')
            model%n_earlier = model%n_conditions
            if (parameter_of(line, 'perturbation') /= '' .and. model%step > 1) call input%refuse_line( &
               '*STEP with PERTURBATION cannot be used')
            is_read = any(lower_case(parameter_of(line, 'nlgeom')) == ['  ', 'no'])
            ! What comes behind the step that is used does not matter.
            if (model%step > 0 .and. model%n_steps > model%step) then
               is_read = .true.
               input%position = len(input%text) + 1
            end if
         end associate
      case ('transform')
         call input%refuse_line('supports and loads in the directions of a *TRANSFORM cannot be used')
      case default
         is_read = .false.
      end select
   end subroutine read_model_keyword

   !> Reads a keyword of a material. Constants that depend on the temperature are refused.
   pure subroutine read_material_keyword(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! the keyword in small letters
      character(*), intent(in) :: line !! the keyword line
      type(file_material_t) :: definition
      character(:), allocatable :: name
      character(longest_name) :: fields(most_fields)
      real(dp) :: values(n_engineering_constants)
      integer :: i, last, n, n_values
      logical :: is_engineering, is_there

      select case (keyword)
      case ('material')
         name = parameter_of(line, 'name')
         if (name == '' .or. len(name) > longest_name) call input%refuse_line( &
            'expected NAME= and the name of a material')
         definition%name = name
         raw%model%definitions = [raw%model%definitions, definition]
      case default
         call refuse_parameters(input, line)
         last = size(raw%model%definitions)
         if (last == 0) call input%refuse_line('*'//keyword//' before any *MATERIAL')
         name = parameter_of(line, 'type')
         is_engineering = index(lower_case(name), 'engineering') == 1
         n_values = merge(2, 1, keyword == 'elastic')
         if (lower_case(name) == 'ortho') n_values = 3
         if (is_engineering) n_values = n_engineering_constants
         call next_data_line(input, is_there)
         n = 0
         if (is_there) call take_fields(input, fields, n)
         if (is_engineering .and. n >= n_values - 1) then
            ! The last one has a line of its own.
            call next_data_line(input, is_there)
            if (is_there) call take_fields(input, fields(n_values:), n)
            if (is_there .and. n == 1) n = n_values
         end if
         if (n < n_values) call input%refuse_line('*'//keyword//': expected '//counted(n_values, 'number'))
         do i = 1, min(n, n_values)
            call take_number(input, fields(i), values(i))
         end do
         call next_data_line(input, is_there)
         if (is_there) call input%refuse('*'//keyword//' that depends on the temperature cannot be used')
         if (allocated(input%error)) return
         associate (material => raw%model%definitions(last)%material)
            if (is_engineering) then
               material%young = values(:3)
               material%poisson = values(4:6)
               material%shear = values(7:9)
            else if (keyword == 'elastic') then
               material%young = values(1)
               material%poisson = values(2)
            else if (keyword == 'density') then
               material%density = values(1)
            else
               material%expansion = values([1, n_values/2 + 1, n_values])
            end if
         end associate
      end select
   end subroutine read_material_keyword

   !> Reads a section: the element set of a material, the thickness there, and the orientation of its axes.
   pure subroutine read_section(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      type(file_material_t) :: section
      character(:), allocatable :: name, region
      character(longest_name) :: fields(most_fields)
      integer :: group, i, n
      logical :: is_there

      region = parameter_of(line, 'elset')
      name = parameter_of(line, 'material')
      group = set_of_field(raw, region)
      if (group == 0) call input%refuse_line("*SOLID SECTION: there is no set '"//region//"' above")
      if (name == '' .or. len(name) > longest_name) call input%refuse_line( &
         '*SOLID SECTION: expected MATERIAL= and the name of a material')
      if (allocated(input%error)) return
      section%name = name
      section%place = input%position - 1
      name = parameter_of(line, 'orientation')
      if (name /= '') then
         i = place_of_name(raw%model%orientations%name, name)
         if (i == 0) call input%refuse_line("*SOLID SECTION: there is no *ORIENTATION '"//name//"' above")
         if (i > 0) section%material = raw%model%orientations(i)%material
      end if
      call next_data_line(input, is_there)
      if (is_there) then
         call take_fields(input, fields, n)
         call take_number(input, fields(1), section%material%thickness)
      end if
      if (.not. section%material%thickness > 0.0_dp .or. raw%n_dim() == 3) section%material%thickness = 1.0_dp
      section%material%region = raw%groups(group)%name
      raw%model%sections = [raw%model%sections, section]
   end subroutine read_section

   !> Reads the axes of an orthotropic material: a point on the first axis and one in the plane of the first two; then,
   !> on a separate line, the axis and the angle of a further rotation. They turn with the instance.
   pure subroutine read_orientation(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      type(file_material_t) :: orientation
      real(dp) :: points(most_fields), turn(2)

      call refuse_parameters(input, line)
      call take_line_of_numbers(input, points)
      call take_line_of_numbers(input, turn)
      orientation%name = parameter_of(line, 'name')
      associate (material => orientation%material, one => points(:3), two => points(4:6))
         if (.not. norm2(one) > 0.0_dp) call input%refuse_line( &
            '*ORIENTATION: expected two points other than the origin')
         if (allocated(input%error)) return
         material%axis1 = one
         material%axis2 = two
         if (abs(turn(2)) > 0.0_dp .and. nint(turn(1)) < 2) then
            material%axis2 = matmul(rotation_matrix(one, turn(2)), two)
         else if (abs(turn(2)) > 0.0_dp .and. nint(turn(1)) == 2) then
            material%axis1 = matmul(rotation_matrix(two - dot_product(one, two)/dot_product(one, one)*one, turn(2)), &
               one)
         else
            material%angle = turn(2)
         end if
         if (raw%is_in_instance) then
            material%axis1 = matmul(raw%instances(size(raw%instances))%rotation, material%axis1)
            material%axis2 = matmul(raw%instances(size(raw%instances))%rotation, material%axis2)
         end if
      end associate
      raw%model%orientations = [raw%model%orientations, orientation]
   end subroutine read_orientation

   !> Reads the lines of `*INITIAL CONDITIONS, TYPE=TEMPERATURE` or of `*TEMPERATURE`: nodes and their temperature. If a
   !> node occurs twice, the later line counts.
   pure subroutine read_temperatures(raw, input, keyword, line, is_read)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file; gains the temperatures of its nodes
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'initialconditions' or 'temperature'
      character(*), intent(in) :: line !! the keyword line
      logical, intent(out) :: is_read !! whether it is read: initial conditions of another type are not
      character(longest_name) :: fields(most_fields)
      character(:), allocatable :: name
      type(integer_list_t) :: tags
      integer :: i, n, node
      real(dp) :: value
      logical :: is_there

      is_read = keyword == 'temperature' .or. lower_case(parameter_of(line, 'type')) == 'temperature'
      if (.not. is_read) return
      call refuse_parameters(input, line)
      call expect_nodes(raw%model%temperatures, raw%node_tag%items())
      name = '*'//line(:index(line//',', ',') - 1)//': '
      associate (temperatures => raw%model%temperatures)
         if (keyword == 'temperature') temperatures%place = input%position - 1
         if (lower_case(parameter_of(line, 'op')) == 'new' .and. temperatures%n_steps < raw%model%n_steps) then
            temperatures%of_node(2, :) = not_given
            temperatures%n_steps = raw%model%n_steps
         end if
         if (keyword /= 'temperature') temperatures%has_initial = .true.
         do
            call next_data_line(input, is_there)
            if (.not. is_there) exit
            call take_fields(input, fields, n)
            if (any(fields(3:) /= '')) call input%refuse_line(name//'expected nodes and one temperature')
            call take_number(input, fields(2), value)
            tags%n = 0
            call add_members(raw, input, name//'there is no node set', .true., trim(fields(1)), tags)
            if (tags%n == 0) call input%refuse_line(name//"there is no node set '"//trim(fields(1))//"' above")
            do i = 1, tags%n
               node = temperatures%map%find(tags%item(i))
               if (node == 0) call input%refuse_line(name//'there is no node '//to_text(tags%item(i))//' above')
               if (allocated(input%error)) return
               temperatures%of_node(merge(2, 1, keyword == 'temperature'), node) = value
            end do
         end do
      end associate
   end subroutine read_temperatures

   !> Reads a keyword of an interaction of surfaces. What a penalty needs besides the friction is not physics.
   pure subroutine read_interaction(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file; gains the interaction, or its friction
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! the keyword in small letters
      character(*), intent(in) :: line !! the keyword line
      type(file_contact_t) :: interaction
      character(longest_name) :: fields(most_fields)
      integer :: n
      logical :: is_there

      call refuse_parameters(input, line)
      if (keyword == 'surfaceinteraction') then
         interaction%name = parameter_of(line, 'name')
         raw%model%interactions = [raw%model%interactions, interaction]
         return
      end if
      associate (last => size(raw%model%interactions))
         if (last == 0) call input%refuse_line('*'//capitals(keyword)//' before any *SURFACE INTERACTION')
         call next_data_line(input, is_there)
         fields = ''
         if (is_there) call take_fields(input, fields, n)
         if (any(fields(merge(2, 1, keyword == 'friction'):) /= '')) call raw%add_note( &
            'stiffnesses of *SURFACE BEHAVIOR and *FRICTION ignored: surfaces in contact neither overlap nor creep')
         if (allocated(input%error) .or. keyword /= 'friction') return
         call take_number(input, fields(1), raw%model%interactions(last)%friction)
         if (raw%model%interactions(last)%friction < 0.0_dp) call input%refuse_line( &
            '*FRICTION: the coefficient is negative')
         call next_data_line(input, is_there)
         if (is_there) call input%refuse('*FRICTION that depends on pressure, slip or temperature cannot be used')
      end associate
   end subroutine read_interaction

   !> Reads pairs of surfaces, the slave first.
   pure subroutine read_pairs(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file; gains the pairs
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'contactpair' or 'tie'
      character(*), intent(in) :: line !! the keyword line
      type(file_contact_t) :: pair
      character(longest_name) :: fields(most_fields)
      character(:), allocatable :: label
      integer :: n
      logical :: is_there

      call refuse_parameters(input, line)
      pair%name = parameter_of(line, 'interaction')
      pair%is_tied = keyword == 'tie'
      call take_number(input, parameter_of(line, 'position tolerance'), pair%search)
      if (pair%search < 0.0_dp) call input%refuse_line('*TIE: the position tolerance is negative')
      if (.not. pair%is_tied .and. index(lower_case(line), 'small') == 0) call raw%add_note( &
         '*CONTACT PAIR without SMALL SLIDING: its points keep the partners that they face all the same')
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call locate(input, input%position, pair%origin, label)
         call take_fields(input, fields, n)
         if (any(fields(:2) == '') .or. any(fields(3:) /= '')) call input%refuse_line('*'// &
            line(:index(line//',', ',') - 1)//': expected two surfaces, the slave and the master')
         if (allocated(input%error)) return
         pair%set = fields(1)
         pair%against = fields(2)
         raw%model%contacts = [raw%model%contacts, pair]
      end do
   end subroutine read_pairs

   !> Gives pairs the names that their surfaces have in the whole mesh, and the friction of their interactions.
   pure subroutine finish_pairs(raw, error)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(error_t), allocatable, intent(inout) :: error !! a surface or an interaction is missing
      integer :: i, k

      do i = 1, size(raw%model%contacts)
         associate (pair => raw%model%contacts(i), groups => [set_of_field(raw, trim(raw%model%contacts(i)%set)), &
            set_of_field(raw, trim(raw%model%contacts(i)%against))])
            if (any(groups == 0)) then
               call new_error(error, input_refused, pair%origin//"there is no surface '"// &
                  trim(merge(pair%set, pair%against, groups(1) == 0))//"'")
               return
            end if
            pair%set = raw%groups(groups(1))%name
            pair%against = raw%groups(groups(2))%name
            if (pair%is_tied) cycle
            do k = 1, size(raw%model%interactions)
               if (lower_case(raw%model%interactions(k)%name) == lower_case(pair%name)) exit
            end do
            if (k > size(raw%model%interactions)) then
               call new_error(error, input_refused, pair%origin//"there is no *SURFACE INTERACTION '"// &
                  trim(pair%name)//"'")
               return
            end if
            pair%friction = raw%model%interactions(k)%friction
         end associate
      end do
   end subroutine finish_pairs

   !> Makes room for the temperatures of the nodes read so far: 0 at first, and none in the step.
   pure subroutine expect_nodes(temperatures, tags)
      type(file_temperatures_t), intent(inout) :: temperatures !! the temperatures
      integer, intent(in) :: tags(:) !! numbers of the nodes in the file
      integer :: n

      n = 0
      if (allocated(temperatures%map%tag)) n = size(temperatures%map%tag)
      if (n == 0) allocate (temperatures%of_node(2, 0))
      if (n == size(tags)) return
      temperatures%of_node = reshape([temperatures%of_node, spread([0.0_dp, not_given], 2, size(tags) - n)], &
         [2, size(tags)])
      call new_tag_map(temperatures%map, tags)
   end subroutine expect_nodes

   !> Completes the model after the last line: makes the material of each section, and a load of the temperatures of the
   !> step, as differences from the initial ones. Nodes without a temperature in the step keep the initial one.
   pure subroutine finish_model(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, at its end
      character(:), allocatable :: label
      character(len(raw%hypothesis)) :: hypothesis
      type(error_t), allocatable :: error
      type(load_t) :: load
      integer :: i, k

      associate (model => raw%model, temperatures => raw%model%temperatures)
         allocate (model%materials(size(model%sections)))
         do i = 1, size(model%sections)
            associate (section => model%sections(i), material => model%materials(i))
               do k = 1, size(model%definitions)
                  if (lower_case(model%definitions(k)%name) == lower_case(section%name)) exit
               end do
               if (k > size(model%definitions)) then
                  call input%refuse("*SOLID SECTION: there is no material '"//trim(section%name)//"'")
               else if (.not. model%definitions(k)%material%young(1) > 0.0_dp) then
                  call input%refuse("the material '"//trim(section%name)//"' has no *ELASTIC")
               end if
               if (allocated(input%error)) return
               hypothesis = raw%hypothesis
               if (raw%n_dim() == 3) hypothesis = no_hypothesis
               associate (given => model%definitions(k)%material, axes => section%material)
                  call new_material(material, given%young(1), merge(0.0_dp, given%poisson(1), &
                     given%shear(1) > 0.0_dp), trim(hypothesis), axes%thickness, error)
                  material%young = given%young
                  material%poisson = given%poisson
                  material%shear = given%shear
                  material%density = given%density
                  material%expansion = given%expansion
                  material%region = axes%region
                  material%axis1 = axes%axis1
                  material%axis2 = axes%axis2
                  material%angle = axes%angle
               end associate
               call locate(input, section%place, material%origin, label)
               if (.not. allocated(error)) call material%derive(error)
               if (allocated(error)) then
                  error%message = material%origin//error%message
                  call move_alloc(error, input%error)
                  return
               end if
               if (raw%n_dim() == 3) cycle
               if (.not. material%axes(3, 3) >= 1.0_dp) call input%refuse( &
                  '*ORIENTATION: the third axis must be that of z', section%place)
               ! In the plane the angle says all.
               material%angle = atan2(material%axes(2, 1), material%axes(1, 1))/degree
               material%axis1 = [1.0_dp, 0.0_dp, 0.0_dp]
               material%axis2 = [0.0_dp, 1.0_dp, 0.0_dp]
            end associate
         end do
         call keep_conditions(raw)
         call finish_pairs(raw, input%error)
         if (model%step > model%n_steps) call input%refuse('the file has no step '//to_text(model%step)//', only '// &
            to_text(model%n_steps))
         if (temperatures%place == 0) return
         call expect_nodes(temperatures, raw%node_tag%items())
         call new_load(load, '')
         load%target = load_by_temperature
         allocate (load%temperature_table(2, raw%node_tag%n))
         load%temperature_table(1, :) = raw%node_tag%items()
         load%temperature_table(2, :) = merge(temperatures%of_node(2, :) - temperatures%of_node(1, :), 0.0_dp, &
            temperatures%of_node(2, :) < not_given)
         load%temperature_file = input%file
         call locate(input, temperatures%place, load%origin, label)
         model%loads = [model%loads, load]
         if (.not. temperatures%has_initial) call raw%add_note( &
            '*TEMPERATURE without *INITIAL CONDITIONS, TYPE=TEMPERATURE: nothing is strained at the temperature 0')
      end associate
   end subroutine finish_model

   !> Makes supports and loads of the conditions that no later step has ended and that still have members.
   pure subroutine keep_conditions(raw)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      ! Places of the components x, y and z of a support.
      integer, parameter :: places(3) = [findloc(supported_components, 'ux', dim=1), &
         findloc(supported_components, 'uy', dim=1), findloc(supported_components, 'uz', dim=1)]
      integer :: i, n, n_loads, n_supports

      n = count(places > 0)
      associate (model => raw%model)
         ! Counted first: flang 19 cannot assign an empty list to itself.
         n_supports = 0
         n_loads = 0
         do i = 1, model%n_conditions
            associate (given => model%conditions(i))
               if (index(given%load%set, '*') == 1) given%is_ended = given%is_ended .or. &
                  size(members_of(raw, given%load%set)) == 0
               if (given%is_ended) cycle
               n_supports = n_supports + merge(1, 0, any(given%is_held))
               n_loads = n_loads + merge(0, 1, any(given%is_held))
            end associate
         end do
         allocate (model%supports(n_supports), model%loads(n_loads))
         n_supports = 0
         n_loads = 0
         do i = 1, model%n_conditions
            associate (given => model%conditions(i))
               if (given%is_ended) cycle
               if (any(given%is_held)) then
                  n_supports = n_supports + 1
                  associate (support => model%supports(n_supports))
                     call new_support(support, given%load%set)
                     support%origin = given%load%origin
                     support%is_held(places(:n)) = given%is_held(:n)
                     support%displacement(places(:n)) = merge(given%value, 0.0_dp, given%is_held(:n))
                  end associate
               else
                  n_loads = n_loads + 1
                  model%loads(n_loads) = given%load
               end if
            end associate
         end do
      end associate
   end subroutine keep_conditions

   !> Reads supports or loads: nodes, elements or a surface; components or kind; values. Nodes of consecutive lines with
   !> the same content, and sides with the same pressure, are one set.
   pure subroutine read_conditions(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'boundary', 'cload', 'dload' or 'dsload'
      character(*), intent(in) :: line !! the keyword line
      character(longest_name) :: fields(most_fields)
      character(:), allocatable :: label, made
      type(file_condition_t) :: before, condition
      real(dp) :: values(most_fields - 2)
      integer :: i, n, n_dim
      logical :: is_there

      n_dim = raw%n_dim()
      call refuse_parameters(input, line)
      if (lower_case(parameter_of(line, 'op')) == 'new') then
         do i = 1, raw%model%n_earlier
            if (index(raw%model%conditions(i)%name, '*'//keyword//' ') == 1) raw%model%conditions(i)%is_ended = .true.
         end do
      end if
      before%name = ''
      before%load%set = ''
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         condition%is_held = .false.
         call new_load(condition%load, '')
         call locate(input, input%position, condition%load%origin, label)
         call take_fields(input, fields, n)
         do i = 1, size(values)
            call take_number(input, fields(i + 2), values(i))
         end do
         if (allocated(input%error)) return
         condition%name = '*'//keyword//' '//lower_case(trim(fields(2)))
         condition%value = values(1)
         if (keyword == 'dload' .and. any(side_labels == lower_case(fields(2)))) condition%name = '*dload p'
         if (keyword == 'boundary') then
            condition%name = '*boundary '
            condition%value = values(2)
            call find_held(raw, input, fields, n_dim, condition%is_held)
            if (.not. any(condition%is_held)) cycle
         end if
         ! The set that the line makes, or goes on with.
         made = '*'//capitals(keyword)//':'//label
         if (condition%name == before%name .and. all(condition%is_held .eqv. before%is_held) .and. &
            abs(condition%value - before%value) <= 0.0_dp .and. index(before%load%set, '*') == 1) made = before%load%set
         if (keyword == 'boundary') then
            call take_nodes(raw, input, fields(1), made, condition%load%set)
         else
            call interpret_load(raw, input, keyword, fields, values, n_dim, made, condition%load)
         end if
         if (allocated(input%error)) return
         call replace_earlier(raw, input, condition)
         if (index(condition%load%set, '*') /= 1 .or. condition%load%set /= before%load%set) then
            associate (model => raw%model)
               if (model%n_conditions == size(model%conditions)) model%conditions = [model%conditions, model%conditions]
               model%n_conditions = model%n_conditions + 1
               model%conditions(model%n_conditions) = condition
            end associate
         end if
         before = condition
      end do
   end subroutine read_conditions

   !> Finds the components that a line of `*BOUNDARY` prescribes: from a first to a last one, or by a word.
   pure subroutine find_held(raw, input, fields, n_dim, is_held)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file; gains notes
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: fields(:) !! the fields of the line
      integer, intent(in) :: n_dim !! number of dimensions
      logical, intent(out) :: is_held(3) !! whether each component is prescribed; none after a fault
      integer :: ends(2), i
      logical :: ok

      is_held = .false.
      select case (lower_case(fields(2)))
      case ('encastre', 'pinned')
         is_held(:n_dim) = .true.
      case ('xsymm', 'ysymm', 'zsymm')
         is_held(index('xyz', lower_case(fields(2)(1:1)))) = .true.
      case default
         do i = 1, 2
            call read_integer(trim(fields(merge(2, i + 1, fields(i + 1) == ''))), ends(i), ok)
            if (.not. ok) call input%refuse_line("*BOUNDARY: expected the number of a component, found '"// &
               trim(fields(i + 1))//"'")
         end do
         if (allocated(input%error)) return
         is_held = [(ends(1) <= i .and. ends(2) >= i, i=1, 3)]
         if (n_dim == 3 .and. ends(2) > 3) call raw%add_note( &
            '*BOUNDARY: components above 3 ignored, which the nodes of solids have not')
      end select
      is_held(n_dim + 1:) = .false.
   end subroutine find_held

   !> Finds the nodes of a data line: those of a set, or one by its number, which is put into the set of the line.
   pure subroutine take_nodes(raw, input, field, made, set)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: field !! the field of the nodes
      character(*), intent(in) :: made !! the set that the line makes: its keyword, a colon, its number
      character(:), allocatable, intent(inout) :: set !! becomes the name of the set
      integer :: group, node
      logical :: is_number

      call read_tag(raw, trim(field), node, is_number)
      if (is_number) then
         set = made
         call raw%get_group(input, set, group)
         if (.not. allocated(input%error)) call raw%groups(group)%node%append(node)
      else
         group = set_of_field(raw, trim(field))
         if (group == 0) call input%refuse_line(made(:index(made, ':') - 1)//": there is no set '"//trim(field)// &
            "' above")
         if (group > 0) set = raw%groups(group)%name
      end if
   end subroutine take_nodes

   !> Makes a load of a line.
   pure subroutine interpret_load(raw, input, keyword, fields, values, n_dim, made, load)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: keyword !! 'cload', 'dload' or 'dsload'
      character(*), intent(in) :: fields(:) !! the fields of the line
      real(dp), intent(in) :: values(:) !! its numbers, from the third field on
      integer, intent(in) :: n_dim !! number of dimensions
      character(*), intent(in) :: made !! the set that the line makes
      type(load_t), intent(inout) :: load !! the load
      character(*), parameter :: components(*) = ['1', '2', '3']
      integer :: component, group, side

      side = findloc(side_labels == lower_case(fields(2)), .true., dim=1)
      group = set_of_field(raw, trim(fields(1)))
      if (keyword == 'cload') then
         load%target = load_on_nodes
         component = findloc(components(:n_dim) == fields(2), .true., dim=1)
         if (component == 0) call input%refuse_line('*CLOAD: expected a component from 1 to '//to_text(n_dim)// &
            ", found '"//trim(fields(2))//"'")
         if (allocated(input%error)) return
         load%force(component) = values(1)
         call take_nodes(raw, input, fields(1), made, load%set)
      else if (keyword == 'dload' .and. side > 0) then
         load%pressure = values(1)
         load%set = made
         call take_sides(raw, input, trim(fields(1)), side, made)
      else if (keyword == 'dsload' .and. lower_case(fields(2)) == 'p' .and. group > 0) then
         load%pressure = values(1)
         load%set = raw%groups(group)%name
      else
         call interpret_dload(raw, input, keyword, group, fields, values, n_dim, load)
      end if
   end subroutine interpret_load

   !> Adds a side of an element, or of each element of a set, to a set of sides.
   pure subroutine take_sides(raw, input, field, side, set)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: field !! the field of the elements
      integer, intent(in) :: side !! number of the side in each
      character(*), intent(in) :: set !! name of the set
      type(integer_list_t) :: elements
      integer :: group

      call add_members(raw, input, '*DLOAD: there is no set', .false., field, elements)
      if (elements%n == 0) call input%refuse_line("*DLOAD: there is no set '"//field//"' above")
      if (.not. allocated(input%error)) call raw%get_group(input, set, group)
      if (allocated(input%error)) return
      call raw%groups(group)%cell%append_all(elements%items())
      call raw%groups(group)%side%append_all(spread(side, 1, elements%n))
   end subroutine take_sides

   !> Ends what was given before the present step on nodes, sides or a region for which it is given once more.
   pure subroutine replace_earlier(raw, input, given)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      type(file_condition_t), intent(in) :: given !! what is given now
      integer(int64), allocatable :: members(:), others(:)
      logical, allocatable :: is_kept(:)
      integer :: group, i, k

      do i = 1, raw%model%n_earlier
         associate (earlier => raw%model%conditions(i))
            if (earlier%is_ended .or. earlier%name /= given%name) cycle
            if (any(given%is_held) .and. .not. any(earlier%is_held .and. given%is_held)) cycle
            if (earlier%load%set == given%load%set .and. earlier%load%region == given%load%region) then
               earlier%is_held = earlier%is_held .and. .not. given%is_held
               earlier%is_ended = .not. any(earlier%is_held)
               cycle
            end if
            if (given%load%set /= '') then
               members = members_of(raw, given%load%set)
               others = members_of(raw, earlier%load%set)
               is_kept = [(all(members /= others(k)), k=1, size(others))]
               if (all(is_kept)) cycle
               group = raw%find_group(earlier%load%set)
            end if
            if (any(given%is_held)) then
               ! Supports of a set keep its nodes: they agree with the new ones, or are refused as contradictory.
               if (index(earlier%load%set, '*') /= 1 .or. any(earlier%is_held .and. .not. given%is_held)) cycle
            else if (index(earlier%load%set, '*') /= 1) then
               call input%refuse_line(given%name(:index(given%name, ' '))//'after another load of its kind on a '// &
                  'part of the same set or body in an earlier step cannot be used; end that by OP=NEW')
               return
            end if
         end associate
         call keep(raw%groups(group)%node)
         call keep(raw%groups(group)%cell)
         call keep(raw%groups(group)%side)
      end do

   contains

      !> Removes what is not kept from a list.
      pure subroutine keep(list)
         type(integer_list_t), intent(inout) :: list !! the list; empty ones stay so
         integer, allocatable :: items(:)

         if (list%n == 0) return
         items = pack(list%items(), is_kept)
         list%n = 0
         call list%append_all(items)
      end subroutine keep

   end subroutine replace_earlier

   !> Sides of a set, or its nodes, as numbers.
   pure function members_of(raw, set) result(members)
      type(raw_mesh_t), intent(in) :: raw !! contents of the file
      character(*), intent(in) :: set !! name of the set, which is there
      integer(int64), allocatable :: members(:)

      associate (group => raw%groups(raw%find_group(set)))
         if (group%cell%n > 0) then
            members = 8_int64*group%cell%items() + group%side%items()
         else
            members = group%node%items()
         end if
      end associate
   end function members_of

   !> Makes a load of a line of distributed loads on a region.
   pure subroutine interpret_dload(raw, input, keyword, group, fields, values, n_dim, load)
      type(raw_mesh_t), intent(in) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: keyword !! 'dload' or 'dsload'
      integer, intent(in) :: group !! the set that the line names, 0 for none
      character(*), intent(in) :: fields(:) !! the fields of the line
      real(dp), intent(in) :: values(:) !! its numbers, from the third field on
      integer, intent(in) :: n_dim !! number of dimensions
      type(load_t), intent(inout) :: load !! the load
      integer :: element
      logical :: is_number

      call read_integer(trim(fields(1)), element, is_number)
      if (group == 0 .and. is_number) then
         call input%refuse_line('*'//keyword//': '//trim(fields(2))//' on the single element '//trim(fields(1))// &
            ' cannot be used; name an element set')
      else if (group == 0 .and. fields(1) /= '') then
         call input%refuse_line('*'//keyword//": there is no set '"//trim(fields(1))//"' above")
      end if
      if (allocated(input%error)) return
      load%target = load_on_region
      if (group > 0) load%region = raw%groups(group)%name
      ! A plane body has no force across its plane, and an axis in it or normal to it.
      select case (lower_case(fields(2)))
      case ('bx', 'by', 'bz')
         load%body_force(index('xyz', fields(2)(2:2)) + index('XYZ', fields(2)(2:2))) = values(1)
         if (n_dim == 2 .and. abs(load%body_force(3)) > 0.0_dp) call input%refuse_line('BZ: the body is plane')
      case ('grav')
         if (.not. norm2(values(2:4)) > 0.0_dp .or. any(abs(values(2 + n_dim:4)) > 0.0_dp)) then
            call input%refuse_line(trim(merge('GRAV: expected a direction in the plane', &
               'GRAV: expected a direction             ', n_dim == 2)))
         else
            load%gravity = values(1)*values(2:4)/norm2(values(2:4))
         end if
      case ('centrif')
         ! The square of the angular speed, a point of the axis and its direction. A body of revolution has its own.
         if (values(1) < 0.0_dp) call input%refuse_line('CENTRIF: the square of the angular speed is negative')
         load%angular_speed = sqrt(max(0.0_dp, values(1)))
         if (raw%hypothesis == 'axisymmetric' .and. n_dim == 2) then
            if (abs(values(2)) > 0.0_dp .or. abs(values(5)) > 0.0_dp) call input%refuse_line( &
               'CENTRIF: a body of revolution spins about its own axis')
            return
         end if
         load%center(:n_dim) = values(2:1 + n_dim)
         load%axis(:n_dim) = values(5:4 + n_dim)
         if (any(abs(load%axis) > 0.0_dp) .and. any(abs(values(5 + n_dim:7)) > 0.0_dp)) call input%refuse_line( &
            'CENTRIF: expected an axis in the plane or normal to it')
      case default
         call input%refuse_line('*'//keyword//": loads of the kind '"//trim(fields(2))//"' cannot be used")
      end select
   end subroutine interpret_dload

   !> Finds file and line of a position in the text.
   pure subroutine locate(input, place, origin, label)
      type(input_file_t), intent(inout) :: input !! the file
      integer, intent(in) :: place !! the place
      character(:), allocatable, intent(out) :: origin !! file and line, as messages begin
      character(:), allocatable, intent(out) :: label !! number of the line, behind the name of an included file
      character(:), allocatable :: folder
      integer :: line

      call input%locate(place, origin, line)
      label = to_text(line)
      ! Names are the same wherever the files are: an included file is named as seen from the folder of this one.
      folder = input%file(:index(input%file, '/', back=.true.))
      if (origin /= input%file) label = origin(1 + merge(len(folder), 0, index(origin, folder) == 1):)//':'//label
      origin = origin//':'//to_text(line)//': '
   end subroutine locate

end module amontons_abaqus_model
