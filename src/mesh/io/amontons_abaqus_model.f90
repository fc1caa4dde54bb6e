!> The model in the input format of Abaqus and CalculiX: materials, sections, which assign them to sets of elements,
!> initial temperatures of nodes (without strain) and those of the step, supports and loads; steps keep, replace and end
!> what was given before them.
module amontons_abaqus_model
   use amontons_abaqus_lines, only: add_members, degree, next_data_line, parameter_of, place_of_name, read_tag, &
      refuse_parameters, set_of_field, take_fields, take_line_of_numbers, take_number
   use amontons_constraints, only: new_support, support_t
   use amontons_error, only: error_t
   use amontons_file_model, only: file_material_t, file_model_t, file_temperatures_t, longest_name, raw_mesh_t, &
      use_loads, use_materials, use_supports
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t, new_tag_map
   use amontons_kinds, only: dp, int64
   use amontons_loads, only: load_by_temperature, load_on_nodes, load_on_region, load_t, new_load
   use amontons_material, only: new_material
   use amontons_text, only: counted, lower_case, read_integer, to_text
   implicit none (type, external)
   private

   public :: finish_model, model_keywords, model_uses, read_model_keyword

   !> Keywords that may be read in addition to the mesh.
   character(12), parameter :: model_keywords(*) = [character(12) :: 'material', 'elastic', 'density', 'expansion', &
      'orientation', 'solidsection', 'boundary', 'cload', 'dload', 'dsload', 'temperature']
   !> The part of the model to which each of these keywords belongs: materials, supports or loads.
   integer, parameter :: model_uses(*) = [spread(use_materials, 1, 6), use_supports, spread(use_loads, 1, 4)]
   !> Target of a load that a later step has ended.
   integer, parameter :: no_load = 0
   !> Temperature of a node to which the step gives none.
   real(dp), parameter :: not_given = huge(1.0_dp)
   !> Largest number of fields of a data line; the temperatures of a shell follow that of its first point.
   integer, parameter :: most_fields = 9
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
      case ('boundary')
         call read_boundary(raw, input, line)
      case ('cload', 'dload', 'dsload')
         call read_loads(raw, input, keyword, line)
      case ('temperature', 'initialconditions')
         call read_temperatures(raw, input, keyword, line, is_read)
      case ('step')
         associate (model => raw%model)
            model%n_steps = model%n_steps + 1
            if (model%n_steps > 1 .and. model%step == 0) call input%refuse_line( &
               'a second *STEP: &mesh step = 2 uses the supports and loads of this one, and what it keeps of the first')
            model%n_earlier_supports = model%n_supports
            model%n_earlier_loads = model%n_loads
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
         raw%model%definitions = [raw%model%definitions, file_material_t(name=name)]
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
         associate (material => raw%model%definitions(last))
            if (is_engineering) then
               material%young = values(:3)
               material%poisson = values(4:6)
               material%shear = values(7)
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
      section%region = raw%groups(group)%name
      section%place = input%position - 1
      name = parameter_of(line, 'orientation')
      if (name /= '') then
         i = place_of_name(raw%model%orientations%name, name)
         if (i == 0) call input%refuse_line("*SOLID SECTION: there is no *ORIENTATION '"//name//"' above")
         if (i > 0) section%angle = raw%model%orientations(i)%angle
      end if
      call next_data_line(input, is_there)
      if (is_there) then
         call take_fields(input, fields, n)
         call take_number(input, fields(1), section%thickness)
         if (.not. section%thickness > 0.0_dp) section%thickness = 1.0_dp
      end if
      raw%model%sections = [raw%model%sections, section]
   end subroutine read_section

   !> Reads the axes of an orthotropic material: a point on the first axis and one in the plane of the first two; then,
   !> on a separate line, the axis and the angle of a further rotation. They turn with the instance.
   pure subroutine read_orientation(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      type(file_material_t) :: orientation
      real(dp) :: axis(2), points(most_fields), turn(2)

      call refuse_parameters(input, line)
      call take_line_of_numbers(input, points)
      call take_line_of_numbers(input, turn)
      if (any(abs(points([3, 6])) > 0.0_dp) .or. .not. points(1)*points(5) > points(2)*points(4) &
         .or. (abs(turn(2)) > 0.0_dp .and. nint(turn(1)) /= 3)) call input%refuse_line( &
         '*ORIENTATION: the third axis must be that of z')
      axis = [1.0_dp, 0.0_dp]
      if (raw%is_in_instance) axis = raw%instances(size(raw%instances))%rotation(:2, 1)
      orientation%name = parameter_of(line, 'name')
      orientation%angle = (atan2(points(2), points(1)) + atan2(axis(2), axis(1)))/degree + turn(2)
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
               else if (.not. model%definitions(k)%young(1) > 0.0_dp) then
                  call input%refuse("the material '"//trim(section%name)//"' has no *ELASTIC")
               end if
               if (allocated(input%error)) return
               associate (definition => model%definitions(k))
                  call new_material(material, definition%young(1), merge(0.0_dp, definition%poisson(1), &
                     definition%shear > 0.0_dp), trim(raw%hypothesis), section%thickness, error)
                  material%angle = section%angle
                  if (definition%shear > 0.0_dp .and. .not. allocated(error)) then
                     material%young = definition%young
                     material%poisson = definition%poisson
                     material%shear = definition%shear
                     call material%derive(error)
                  end if
               end associate
               call locate(input, section%place, material%origin, label)
               if (allocated(error)) then
                  error%message = material%origin//error%message
                  call move_alloc(error, input%error)
                  return
               end if
               material%density = model%definitions(k)%density
               material%expansion = model%definitions(k)%expansion
               material%region = trim(section%region)
            end associate
         end do
         call drop_ended(raw)
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
         call model%add_load(load)
         if (.not. temperatures%has_initial) call raw%add_note( &
            '*TEMPERATURE without *INITIAL CONDITIONS, TYPE=TEMPERATURE: nothing is strained at the temperature 0')
      end associate
   end subroutine finish_model

   !> Drops supports and loads that a later step has ended.
   pure subroutine drop_ended(raw)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      integer :: i, n

      associate (model => raw%model)
         n = 0
         do i = 1, model%n_supports
            if (.not. any(model%supports(i)%is_held) .or. is_struck(model%supports(i)%set)) cycle
            n = n + 1
            model%supports(n) = model%supports(i)
         end do
         model%n_supports = n
         n = 0
         do i = 1, model%n_loads
            if (model%loads(i)%target == no_load .or. is_struck(model%loads(i)%set)) cycle
            n = n + 1
            model%loads(n) = model%loads(i)
         end do
         model%n_loads = n
      end associate

   contains

      !> Whether nothing is left of a set that was made of lines.
      pure logical function is_struck(set)
         character(*), intent(in) :: set !! its name

         is_struck = index(set, '*') == 1
         if (is_struck) is_struck = size(members_of(raw, set)) == 0
      end function is_struck

   end subroutine drop_ended

   !> Reads prescribed displacements: nodes, first and last component (or a word for the components), value.
   pure subroutine read_boundary(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      character(longest_name) :: fields(most_fields)
      character(:), allocatable :: label
      type(support_t) :: support, before
      integer :: ends(2), i, n
      logical :: is_there, ok
      real(dp) :: value

      call refuse_parameters(input, line)
      call end_earlier(raw%model, line, '')
      call new_support(before, '')
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call new_support(support, '')
         call locate(input, input%position, support%origin, label)
         call take_fields(input, fields, n)
         if (allocated(input%error)) return
         select case (lower_case(fields(2)))
         case ('encastre', 'pinned')
            support%is_held(:2) = .true.
         case ('xsymm')
            support%is_held(1) = .true.
         case ('ysymm')
            support%is_held(2) = .true.
         case default
            ! The numbers of the first component and of the last.
            if (fields(3) == '') fields(3) = fields(2)
            do i = 1, 2
               call read_integer(trim(fields(i + 1)), ends(i), ok)
               if (.not. ok) call input%refuse_line("*BOUNDARY: expected the number of a component, found '"// &
                  trim(fields(i + 1))//"'")
            end do
            support%is_held(:2) = [ends(1) <= 1 .and. ends(2) >= 1, ends(1) <= 2 .and. ends(2) >= 2]
         end select
         call take_number(input, fields(4), value)
         support%displacement = merge(value, 0.0_dp, support%is_held)
         if (.not. any(support%is_held)) cycle
         ! Nodes of consecutive lines are one set if they have the same prescribed displacements.
         call take_nodes(raw, input, '*BOUNDARY', fields(1), label, all(support%is_held .eqv. before%is_held) &
            .and. .not. any(abs(support%displacement - before%displacement) > 0.0_dp), before%set, support%set)
         if (allocated(input%error)) return
         call replace_earlier(raw, input, '*BOUNDARY', support%set, '', support%is_held(:2))
         if (support%set /= before%set) call raw%model%add_support(support)
         before = support
         if (support%set(1:1) /= '*') before%set = ''
      end do
   end subroutine read_boundary

   !> Finds the nodes of a data line: those of a set, or one by its number. Such a node is put into a new set, or into
   !> the set of the line before if both have the same values.
   pure subroutine take_nodes(raw, input, keyword, field, label, is_same, set_before, set)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: keyword !! the keyword, in capitals with its `*`
      character(*), intent(in) :: field !! the field of the nodes
      character(*), intent(in) :: label !! number of the line, behind the name of an included file
      logical, intent(in) :: is_same !! whether the line has the same content as that before
      character(*), intent(in) :: set_before !! the set that the line before made; empty if it made none
      character(:), allocatable, intent(inout) :: set !! becomes the name of the set
      integer :: group, node
      logical :: is_number

      call read_tag(raw, trim(field), node, is_number)
      if (is_number) then
         set = keyword//':'//label
         if (is_same .and. set_before /= '') set = set_before
         call raw%get_group(input, set, group)
         if (.not. allocated(input%error)) call raw%groups(group)%node%append(node)
      else
         group = set_of_field(raw, trim(field))
         if (group == 0) call input%refuse_line(keyword//": there is no set '"//trim(field)//"' above")
         if (group > 0) set = raw%groups(group)%name
      end if
   end subroutine take_nodes

   !> Reads loads: nodes, elements or a surface; component or kind; values. Nodes of consecutive lines with the same
   !> force, and sides with the same pressure, are one set.
   pure subroutine read_loads(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'cload', 'dload' or 'dsload'
      character(*), intent(in) :: line !! the keyword line
      character(2), parameter :: side_labels(4) = ['p1', 'p2', 'p3', 'p4'], components(2) = ['1 ', '2 ']
      character(longest_name) :: fields(most_fields)
      character(:), allocatable :: label
      type(load_t) :: load, before
      real(dp) :: last, values(most_fields - 2)
      integer :: component, group, i, n, side
      logical :: is_same, is_there

      call refuse_parameters(input, line)
      call end_earlier(raw%model, line, '*'//keyword//' ')
      call new_load(before, '')
      last = 0.0_dp
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call new_load(load, '')
         call locate(input, input%position, load%origin, label)
         call take_fields(input, fields, n)
         do i = 1, size(values)
            call take_number(input, fields(i + 2), values(i))
         end do
         if (allocated(input%error)) return
         group = set_of_field(raw, trim(fields(1)))
         side = findloc(side_labels == lower_case(fields(2)), .true., dim=1)
         load%name = '*'//keyword//' '//lower_case(trim(fields(2)))
         if (keyword == 'dload' .and. side > 0) load%name = '*dload p'
         is_same = load%name == before%name .and. before%set /= '' .and. abs(values(1) - last) <= 0.0_dp
         if (keyword == 'cload') then
            load%target = load_on_nodes
            component = findloc(components == fields(2), .true., dim=1)
            if (component == 0) then
               call input%refuse_line("*CLOAD: expected the component 1 or 2, found '"//trim(fields(2))//"'")
               return
            end if
            load%force(component) = values(1)
            call take_nodes(raw, input, '*CLOAD', fields(1), label, is_same, before%set, load%set)
         else if (keyword == 'dsload' .and. lower_case(fields(2)) == 'p' .and. group > 0) then
            load%pressure = values(1)
            load%set = raw%groups(group)%name
         else if (keyword == 'dload' .and. side > 0) then
            load%pressure = values(1)
            load%set = '*DLOAD:'//label
            if (is_same) load%set = before%set
            call take_sides(raw, input, trim(fields(1)), side, load%set)
         else
            call interpret_dload(raw, input, keyword, group, fields, values, load)
         end if
         if (allocated(input%error)) return
         call replace_earlier(raw, input, load%name, load%set, load%region)
         if (load%set == '' .or. load%set /= before%set) call raw%model%add_load(load)
         before = load
         last = values(1)
         if (index(load%set, '*') /= 1) before%set = ''
      end do
   end subroutine read_loads

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

   !> Ends the supports or loads of a keyword that were given before the present step, at OP=NEW.
   pure subroutine end_earlier(model, line, keyword)
      type(file_model_t), intent(inout) :: model !! the model
      character(*), intent(in) :: line !! the keyword line
      character(*), intent(in) :: keyword !! how the names of the loads begin; empty for supports
      integer :: i

      if (lower_case(parameter_of(line, 'op')) /= 'new') return
      do i = 1, merge(model%n_earlier_supports, 0, keyword == '')
         model%supports(i)%is_held = .false.
      end do
      do i = 1, merge(0, model%n_earlier_loads, keyword == '')
         if (index(model%loads(i)%name, keyword) == 1) model%loads(i)%target = no_load
      end do
   end subroutine end_earlier

   !> Ends what was given before the present step on nodes, sides or a region for which it is given once more.
   pure subroutine replace_earlier(raw, input, name, set, region, is_held)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: name !! kind of load, or '*BOUNDARY'
      character(*), intent(in) :: set !! the set of the line, empty for a region
      character(*), intent(in) :: region !! its region
      logical, intent(in), optional :: is_held(2) !! of a support: its components
      integer(int64), allocatable :: members(:), others(:)
      character(:), allocatable :: earlier
      logical, allocatable :: is_kept(:)
      integer :: group, i, k

      do i = 1, merge(raw%model%n_earlier_supports, raw%model%n_earlier_loads, present(is_held))
         if (present(is_held)) then
            if (.not. any(raw%model%supports(i)%is_held(:2) .and. is_held)) cycle
            earlier = raw%model%supports(i)%set
         else
            if (raw%model%loads(i)%target == no_load .or. raw%model%loads(i)%name /= name) cycle
            earlier = raw%model%loads(i)%set
         end if
         if (earlier == set .and. present(is_held)) then
            where (is_held)
               raw%model%supports(i)%is_held(:2) = .false.
               raw%model%supports(i)%displacement(:2) = 0.0_dp
            end where
            cycle
         end if
         if (earlier == set .and. (set /= '' .or. raw%model%loads(i)%region == region)) then
            raw%model%loads(i)%target = no_load
            cycle
         end if
         if (set /= '') then
            members = members_of(raw, set)
            others = members_of(raw, earlier)
            is_kept = [(all(members /= others(k)), k=1, size(others))]
            if (all(is_kept)) cycle
            group = raw%find_group(earlier)
         end if
         if (present(is_held)) then
            ! Supports of a set keep its nodes: they agree with the new ones, or are refused as contradictory.
            if (earlier(1:1) /= '*' .or. any(raw%model%supports(i)%is_held(:2) .and. .not. is_held)) cycle
         else if (index(earlier, '*') /= 1) then
            call input%refuse_line(name(:index(name, ' '))//'after another load of its kind on a part of the same '// &
               'set or body in an earlier step cannot be used; end that by OP=NEW')
            return
         end if
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
   pure subroutine interpret_dload(raw, input, keyword, group, fields, values, load)
      type(raw_mesh_t), intent(in) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: keyword !! 'dload' or 'dsload'
      integer, intent(in) :: group !! the set that the line names, 0 for none
      character(*), intent(in) :: fields(:) !! the fields of the line
      real(dp), intent(in) :: values(:) !! its numbers, from the third field on
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
      select case (lower_case(fields(2)))
      case ('bx')
         load%body_force(1) = values(1)
      case ('by')
         load%body_force(2) = values(1)
      case ('grav')
         if (.not. norm2(values(2:4)) > 0.0_dp .or. abs(values(4)) > 0.0_dp) call input%refuse_line( &
            'GRAV: expected a direction in the plane')
         if (.not. allocated(input%error)) load%gravity(:2) = values(1)*values(2:3)/norm2(values(2:3))
      case ('centrif')
         ! The square of the angular speed, a point of the axis and its direction. A body of revolution has its own.
         if (values(1) < 0.0_dp) call input%refuse_line('CENTRIF: the square of the angular speed is negative')
         load%angular_speed = sqrt(max(0.0_dp, values(1)))
         if (raw%hypothesis == 'axisymmetric') then
            if (abs(values(2)) > 0.0_dp .or. abs(values(5)) > 0.0_dp) call input%refuse_line( &
               'CENTRIF: a body of revolution spins about its own axis')
            return
         end if
         load%center(:2) = values(2:3)
         load%axis(:2) = values(5:6)
         if (any(abs(load%axis) > 0.0_dp) .and. abs(values(7)) > 0.0_dp) call input%refuse_line( &
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
