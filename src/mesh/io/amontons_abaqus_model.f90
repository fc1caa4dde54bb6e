!> The model in the input format of Abaqus and CalculiX: materials, the sections that put them into sets of elements,
!> the temperatures of nodes (those at which nothing is strained, and those of the step), supports and loads.
module amontons_abaqus_model
   use amontons_abaqus_lines, only: find_parameter, named_group, next_data_line, refuse_parameters, take_fields, &
      take_number
   use amontons_file_model, only: file_body_force, file_force, file_gravity, file_load_t, file_material_t, &
      file_rotation, file_support_t, file_temperatures_t, longest_name, raw_mesh_t, use_loads, use_materials, &
      use_supports
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: new_tag_map
   use amontons_kinds, only: dp
   use amontons_text, only: counted, lower_case, read_integer, to_text
   implicit none (type, external)
   private

   public :: finish_materials, finish_temperatures, read_model_keyword

   !> Most fields of a data line that is read here; the temperatures of a shell follow that of its first point.
   integer, parameter :: most_fields = 9

contains

   !> Reads a keyword of a material, or the section that says where it is.
   pure subroutine read_material_keyword(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! the keyword in small letters
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: name
      logical :: is_there

      if (.not. allocated(raw%model%definitions)) allocate (raw%model%definitions(0), raw%model%materials(0))
      select case (keyword)
      case ('material')
         call find_parameter(line, 'name', name, is_there)
         if (name == '' .or. len(name) > longest_name) call input%refuse('expected NAME= and the name of a material', &
            input%position - 1)
         raw%model%definitions = [raw%model%definitions, file_material_t(name=name)]
      case ('solidsection')
         call read_section(raw, input, line)
      case default
         call read_constants(raw, input, keyword, line)
      end select
   end subroutine read_material_keyword

   !> Reads constants of the last material.
   pure subroutine read_constants(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'elastic', 'density' or 'expansion'
      character(*), intent(in) :: line !! the keyword line
      real(dp) :: values(2)
      integer :: n

      call refuse_parameters(input, line)
      n = size(raw%model%definitions)
      if (n == 0) call input%refuse('*'//keyword//' before any *MATERIAL', input%position - 1)
      call take_constants(input, keyword, values(:merge(2, 1, keyword == 'elastic')))
      if (allocated(input%error)) return
      associate (material => raw%model%definitions(n))
         select case (keyword)
         case ('elastic')
            material%young = values(1)
            material%poisson = values(2)
         case ('density')
            material%density = values(1)
         case default
            material%expansion = values(1)
         end select
      end associate
   end subroutine read_constants

   !> Takes the constants of a material, which must not depend on the temperature.
   pure subroutine take_constants(input, keyword, values)
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! the keyword
      real(dp), intent(out) :: values(:) !! the constants
      character(longest_name) :: fields(most_fields)
      integer :: i, n
      logical :: is_there

      values = 0.0_dp
      call next_data_line(input, is_there)
      n = 0
      if (is_there) call take_fields(input, fields, n)
      if (n < size(values)) call input%refuse('*'//keyword//': expected '//counted(size(values), 'number'), &
         input%position - 1)
      do i = 1, min(n, size(values))
         call take_number(input, fields(i), values(i))
      end do
      call next_data_line(input, is_there)
      if (is_there) call input%refuse('*'//keyword//' that depends on the temperature cannot be used')
   end subroutine take_constants

   !> Reads a section: the region of a material, and its thickness.
   pure subroutine read_section(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      type(file_material_t) :: section
      character(:), allocatable :: region, material
      character(longest_name) :: fields(most_fields)
      integer :: group, n
      logical :: is_there

      call find_parameter(line, 'elset', region, is_there)
      call find_parameter(line, 'material', material, is_there)
      group = named_group(raw, region)
      if (group == 0) call input%refuse("*SOLID SECTION: there is no set '"//region//"' above", input%position - 1)
      if (material == '' .or. len(material) > longest_name) call input%refuse( &
         '*SOLID SECTION: expected MATERIAL= and the name of a material', input%position - 1)
      if (allocated(input%error)) return
      section%name = material
      section%region = raw%groups(group)%name
      call raw%model%line_at(input%text, input%position - 1, section%line)
      call next_data_line(input, is_there)
      if (is_there) then
         call take_fields(input, fields, n)
         if (n > 0 .and. fields(1) /= '') call take_number(input, fields(1), section%thickness)
         if (.not. section%thickness > 0.0_dp) section%thickness = 1.0_dp
      end if
      raw%model%materials = [raw%model%materials, section]
   end subroutine read_section

   !> Gives each section its material, once the file is read.
   pure subroutine finish_materials(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, at its end
      integer :: i, k

      associate (model => raw%model)
         model%hypothesis = raw%hypothesis
         if (.not. model%is_used(use_materials)) return
         if (.not. allocated(model%materials)) allocate (model%definitions(0), model%materials(0))
         do i = 1, size(model%materials)
            associate (section => model%materials(i))
               do k = 1, size(model%definitions)
                  if (lower_case(model%definitions(k)%name) == lower_case(section%name)) exit
               end do
               if (k > size(model%definitions)) then
                  call input%refuse("*SOLID SECTION: there is no material '"//trim(section%name)//"'")
               else if (.not. model%definitions(k)%young > 0.0_dp) then
                  call input%refuse("the material '"//trim(section%name)//"' has no *ELASTIC")
               end if
               if (allocated(input%error)) return
               section%young = model%definitions(k)%young
               section%poisson = model%definitions(k)%poisson
               section%density = model%definitions(k)%density
               section%expansion = model%definitions(k)%expansion
            end associate
         end do
      end associate
   end subroutine finish_materials

   !> Reads the lines of `*INITIAL CONDITIONS, TYPE=TEMPERATURE` or of `*TEMPERATURE`: nodes and their temperature. Of
   !> two lines for one node the later one counts.
   pure subroutine read_temperatures(raw, input, keyword, line, is_read)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says; gains the temperatures of its nodes
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'initialconditions' or 'temperature'
      character(*), intent(in) :: line !! the keyword line
      logical, intent(out) :: is_read !! whether it is read: initial conditions of another type are not
      character(longest_name) :: fields(most_fields)
      character(:), allocatable :: name, type
      integer, allocatable :: nodes(:)
      integer :: n
      real(dp) :: value
      logical :: is_there

      call find_parameter(line, 'type', type, is_read)
      is_read = keyword == 'temperature' .or. lower_case(type) == 'temperature'
      if (.not. is_read) return
      call refuse_parameters(input, line)
      call expect_nodes(raw%model%temperatures, raw%node_tag%items())
      name = '*'//line(:index(line//',', ',') - 1)//': '
      associate (temperatures => raw%model%temperatures)
         if (keyword == 'temperature') call raw%model%line_at(input%text, input%position - 1, temperatures%line)
         if (keyword /= 'temperature') temperatures%has_initial = .true.
         do
            call next_data_line(input, is_there)
            if (.not. is_there) exit
            call take_fields(input, fields, n)
            if (any(fields(3:) /= '')) call input%refuse(name//'expected nodes and one temperature', input%position - 1)
            call take_number(input, fields(2), value)
            call find_nodes(raw, input, name, trim(fields(1)), nodes)
            if (allocated(input%error)) return
            if (keyword == 'temperature') then
               temperatures%step(nodes) = value
               temperatures%is_given(nodes) = .true.
            else
               temperatures%initial(nodes) = value
            end if
         end do
      end associate
   end subroutine read_temperatures

   !> Makes room for the temperatures of the nodes so far. They are 0 before anything is read.
   pure subroutine expect_nodes(temperatures, tags)
      type(file_temperatures_t), intent(inout) :: temperatures !! the temperatures
      integer, intent(in) :: tags(:) !! numbers of the nodes in the file
      integer :: n

      if (.not. allocated(temperatures%step)) allocate (temperatures%initial(0), temperatures%step(0), &
         temperatures%is_given(0))
      n = size(tags) - size(temperatures%step)
      if (n == 0 .and. allocated(temperatures%map%tag)) return
      temperatures%initial = [temperatures%initial, spread(0.0_dp, 1, n)]
      temperatures%step = [temperatures%step, spread(0.0_dp, 1, n)]
      temperatures%is_given = [temperatures%is_given, spread(.false., 1, n)]
      call new_tag_map(temperatures%map, tags)
   end subroutine expect_nodes

   !> Finds the nodes of a line: one by its number, or those of a set.
   pure subroutine find_nodes(raw, input, name, field, nodes)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: name !! the keyword, as a message begins
      character(*), intent(in) :: field !! the field of the nodes
      integer, allocatable, intent(out) :: nodes(:) !! the nodes, by their places in the list of all
      integer, allocatable :: tags(:)
      integer :: group, i, tag
      logical :: is_number

      call read_integer(field, tag, is_number)
      if (is_number) then
         tags = [tag]
      else
         allocate (tags(0))
         group = named_group(raw, field)
         if (group > 0) tags = raw%groups(group)%node%items()
         if (size(tags) == 0) call input%refuse(name//"there is no node set '"//field//"' above", input%position - 1)
         call raw%expect_members(input, size(tags))
      end if
      allocate (nodes(size(tags)))
      do i = 1, size(tags)
         nodes(i) = raw%model%temperatures%map%find(tags(i))
         if (nodes(i) == 0) call input%refuse(name//'there is no node '//to_text(tags(i))//' above', input%position - 1)
      end do
   end subroutine find_nodes

   !> Makes a load of the temperatures of the step, once the file and its materials are read: their difference from
   !> the initial ones, which nodes without a temperature keep.
   pure subroutine finish_temperatures(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, at its end

      if (raw%model%temperatures%line == 0) return
      call expect_nodes(raw%model%temperatures, raw%node_tag%items())
      associate (model => raw%model, temperatures => raw%model%temperatures)
         allocate (temperatures%table(2, raw%node_tag%n))
         temperatures%table(1, :) = raw%node_tag%items()
         temperatures%table(2, :) = merge(temperatures%step - temperatures%initial, 0.0_dp, temperatures%is_given)
         if (.not. temperatures%has_initial) call raw%add_note( &
            '*TEMPERATURE without *INITIAL CONDITIONS, TYPE=TEMPERATURE: nothing is strained at the temperature 0')
         if (.not. model%is_used(use_materials)) return
         if (.not. any(abs(model%materials%expansion) > 0.0_dp)) call input%refuse( &
            '*TEMPERATURE has no effect: no *SOLID SECTION has a material with *EXPANSION')
      end associate
   end subroutine finish_temperatures

   !> Reads a keyword with its data lines if it is one of those that are to be used.
   pure subroutine read_model_keyword(raw, input, keyword, line, is_read)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says; gains materials, supports, loads and their sets
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! the keyword in small letters
      character(*), intent(in) :: line !! the keyword line
      logical, intent(out) :: is_read !! whether it was one

      associate (is_used => raw%model%is_used)
         select case (keyword)
         case ('material', 'elastic', 'density', 'expansion', 'solidsection')
            is_read = is_used(use_materials)
            if (is_read) call read_material_keyword(raw, input, keyword, line)
         case ('boundary')
            is_read = is_used(use_supports)
            if (is_read) call read_boundary(raw, input, line)
         case ('cload')
            is_read = is_used(use_loads)
            if (is_read) call read_cload(raw, input, line)
         case ('dload', 'dsload')
            is_read = is_used(use_loads)
            if (is_read) call read_dload(raw, input, keyword, line)
         case ('temperature', 'initialconditions')
            is_read = is_used(use_loads)
            if (is_read) call read_temperatures(raw, input, keyword, line, is_read)
         case ('step')
            is_read = is_used(use_supports) .or. is_used(use_loads)
            if (is_read) call read_step(raw, input, line, is_read)
         case ('transform')
            is_read = is_used(use_supports) .or. is_used(use_loads)
            if (is_read) call input%refuse('supports and loads in the directions of a *TRANSFORM cannot be used', &
               input%position - 1)
         case default
            is_read = .false.
         end select
      end associate
   end subroutine read_model_keyword

   !> Reads the beginning of a step.
   pure subroutine read_step(raw, input, line, is_linear)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      logical, intent(out) :: is_linear !! whether displacements are small; else it is named among what is not read
      character(:), allocatable :: value
      logical :: is_there

      raw%model%n_steps = raw%model%n_steps + 1
      if (raw%model%n_steps > 1) call input%refuse('a second *STEP: the supports and loads of one step can be used', &
         input%position - 1)
      call find_parameter(line, 'nlgeom', value, is_there)
      is_linear = .not. is_there .or. lower_case(value) == 'no'
   end subroutine read_step

   !> Reads prescribed displacements: nodes, first and last component, value.
   pure subroutine read_boundary(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      character(longest_name) :: fields(most_fields)
      type(file_support_t) :: support, before
      integer :: n
      logical :: is_there

      call refuse_parameters(input, line)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call raw%model%line_at(input%text, input%position, support%line)
         call take_fields(input, fields, n)
         if (allocated(input%error)) return
         support%value = 0.0_dp
         call find_components(input, fields(2:3), support%is_held)
         if (n > 3) call take_number(input, fields(4), support%value)
         if (.not. any(support%is_held)) cycle
         ! Numbers of nodes that follow each other are one set, if the same holds for them.
         call take_nodes(raw, input, '*BOUNDARY', fields(1), support%line, &
            all(support%is_held .eqv. before%is_held) .and. .not. abs(support%value - before%value) > 0.0_dp, &
            before%set, support%set)
         if (allocated(input%error)) return
         if (support%set /= before%set) call raw%model%add_support(support)
         before = support
         if (support%set(1:1) /= '*') before%set = ''
      end do
   end subroutine read_boundary

   !> Finds which components a support holds: numbers of the first and the last, or a word.
   pure subroutine find_components(input, fields, is_held)
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: fields(2) !! the fields of the components
      logical, intent(out) :: is_held(2) !! whether x and y are among them
      integer :: ends(2)

      select case (lower_case(fields(1)))
      case ('encastre', 'pinned')
         is_held = .true.
      case ('xsymm')
         is_held = [.true., .false.]
      case ('ysymm')
         is_held = [.false., .true.]
      case default
         call take_component(input, fields(1), ends(1))
         ends(2) = ends(1)
         if (fields(2) /= '') call take_component(input, fields(2), ends(2))
         is_held = [ends(1) <= 1 .and. ends(2) >= 1, ends(1) <= 2 .and. ends(2) >= 2]
      end select
   end subroutine find_components

   !> Takes a field as the number of a component.
   pure subroutine take_component(input, field, component)
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: field !! the field
      integer, intent(out) :: component !! the number, 0 where there is a fault
      logical :: ok

      call read_integer(trim(field), component, ok)
      if (.not. ok) call input%refuse("*BOUNDARY: expected the number of a component, found '"//trim(field)//"'", &
         input%position - 1)
   end subroutine take_component

   !> Reads forces on nodes: nodes, component, value.
   pure subroutine read_cload(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      character(longest_name) :: fields(most_fields)
      type(file_load_t) :: load, before
      integer :: n, component
      real(dp) :: value
      logical :: is_there, ok

      call refuse_parameters(input, line)
      load%kind = file_force
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call raw%model%line_at(input%text, input%position, load%line)
         call take_fields(input, fields, n)
         call read_integer(trim(fields(2)), component, ok)
         if (.not. ok .or. component < 1 .or. component > 2) call input%refuse( &
            "*CLOAD: expected the component 1 or 2, found '"//trim(fields(2))//"'", input%position - 1)
         call take_number(input, fields(3), value)
         if (allocated(input%error)) return
         load%value = 0.0_dp
         load%value(component) = value
         call take_nodes(raw, input, '*CLOAD', fields(1), load%line, all(abs(load%value - before%value) <= 0.0_dp), &
            before%set, load%set)
         if (allocated(input%error)) return
         if (load%set /= before%set) call raw%model%add_load(load)
         before = load
         if (load%set(1:1) /= '*') before%set = ''
      end do
   end subroutine read_cload

   !> Takes the nodes of a line: those of a set, or one by its number, which goes into a set of the line or into that of
   !> the line before.
   pure subroutine take_nodes(raw, input, keyword, field, line, is_same, set_before, set)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: keyword !! the keyword, in capitals with its `*`
      character(*), intent(in) :: field !! the field of the nodes
      integer, intent(in) :: line !! number of the line
      logical, intent(in) :: is_same !! whether the line says the same as that before
      character(*), intent(in) :: set_before !! the set that the line before made; empty if it made none
      character(longest_name), intent(out) :: set !! name of the set
      integer :: group, node
      logical :: is_number

      call read_integer(trim(field), node, is_number)
      if (is_number) then
         set = keyword//':'//to_text(line)
         if (is_same .and. set_before /= '') set = set_before
         call raw%get_group(input, trim(set), group)
         if (.not. allocated(input%error)) call raw%groups(group)%node%append(node)
      else
         group = named_group(raw, trim(field))
         if (group == 0) call input%refuse(keyword//": there is no set '"//trim(field)//"' above", input%position - 1)
         if (group > 0) set = raw%groups(group)%name
      end if
   end subroutine take_nodes

   !> Reads distributed loads: elements or a surface, kind, value.
   pure subroutine read_dload(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'dload' or 'dsload'
      character(*), intent(in) :: line !! the keyword line
      character(longest_name) :: fields(most_fields)
      type(file_load_t) :: load
      real(dp) :: values(most_fields - 2)
      integer :: i, n
      logical :: is_there

      call refuse_parameters(input, line)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         load = file_load_t()
         call raw%model%line_at(input%text, input%position, load%line)
         call take_fields(input, fields, n)
         values = 0.0_dp
         do i = 3, n
            if (fields(i) /= '') call take_number(input, fields(i), values(i - 2))
         end do
         if (allocated(input%error)) return
         call interpret_dload(raw, input, keyword, fields, values, load)
         if (allocated(input%error)) return
         call raw%model%add_load(load)
      end do
   end subroutine read_dload

   !> Finds what a line of distributed loads means.
   pure subroutine interpret_dload(raw, input, keyword, fields, values, load)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: keyword !! 'dload' or 'dsload'
      character(*), intent(in) :: fields(:) !! the fields of the line
      real(dp), intent(in) :: values(:) !! its numbers, from the third field on
      type(file_load_t), intent(inout) :: load !! the load, its line known
      character(2), parameter :: side_labels(4) = ['p1', 'p2', 'p3', 'p4']
      character(longest_name) :: kind
      integer :: group, side, element
      logical :: is_number

      kind = lower_case(fields(2))
      load%value(1) = values(1)
      group = named_group(raw, trim(fields(1)))
      if (group > 0) load%set = raw%groups(group)%name
      side = findloc(side_labels, kind, dim=1)
      if (keyword == 'dsload' .and. kind == 'p' .and. group > 0) return
      if (keyword == 'dload' .and. side > 0) then
         call gather_sides(raw, input, trim(fields(1)), group, side, load)
         return
      end if
      call read_integer(trim(fields(1)), element, is_number)
      if (group == 0 .and. is_number) then
         call input%refuse('*'//keyword//': '//trim(fields(2))//' on the single element '//trim(fields(1))// &
            ' cannot be used; name an element set', input%position - 1)
      else if (group == 0 .and. fields(1) /= '') then
         call input%refuse('*'//keyword//": there is no set '"//trim(fields(1))//"' above", input%position - 1)
      end if
      if (allocated(input%error)) return
      call interpret_body_load(input, keyword, fields(2), raw%hypothesis, values, load)
   end subroutine interpret_dload

   !> Finds what a load on the inside of elements means.
   pure subroutine interpret_body_load(input, keyword, kind, hypothesis, values, load)
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: keyword !! 'dload' or 'dsload'
      character(*), intent(in) :: kind !! the field of the kind
      character(*), intent(in) :: hypothesis !! hypothesis of the elements
      real(dp), intent(in) :: values(:) !! the numbers of the line
      type(file_load_t), intent(inout) :: load !! the load, its first value known

      select case (lower_case(kind))
      case ('bx')
         load%kind = file_body_force
      case ('by')
         load%kind = file_body_force
         load%value = [0.0_dp, values(1)]
      case ('grav')
         load%kind = file_gravity
         if (.not. norm2(values(2:4)) > 0.0_dp .or. abs(values(4)) > 0.0_dp) call input%refuse( &
            'GRAV: expected a direction in the plane', input%position - 1)
         if (.not. allocated(input%error)) load%value = values(1)*values(2:3)/norm2(values(2:3))
      case ('centrif')
         load%kind = file_rotation
         call find_axis(input, hypothesis, values, load)
      case default
         call input%refuse('*'//keyword//": loads of the kind '"//trim(kind)//"' cannot be used", &
            input%position - 1)
      end select
   end subroutine interpret_body_load

   !> Gathers the sides that a pressure acts on in a set of its own.
   pure subroutine gather_sides(raw, input, field, from, side, load)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: field !! the field of the elements
      integer, intent(in) :: from !! the set that it names, 0 for none
      integer, intent(in) :: side !! number of the side in each element
      type(file_load_t), intent(inout) :: load !! the load; gains the set
      integer, allocatable :: elements(:)
      integer :: element, group
      logical :: is_number

      call read_integer(field, element, is_number)
      if (is_number) then
         elements = [element]
      else if (from > 0) then
         elements = pack(raw%groups(from)%cell%items(), raw%groups(from)%side%items() == 0)
      else
         call input%refuse("*DLOAD: there is no set '"//field//"' above", input%position - 1)
      end if
      if (.not. allocated(input%error)) call raw%expect_members(input, size(elements))
      if (allocated(input%error)) return
      load%set = '*DLOAD:'//to_text(load%line)
      call raw%get_group(input, trim(load%set), group)
      if (allocated(input%error)) return
      call raw%groups(group)%cell%append_all(elements)
      call raw%groups(group)%side%append_all(spread(side, 1, size(elements)))
   end subroutine gather_sides

   !> Finds the axis of a rotation: a point and a direction. A body of revolution has its own.
   pure subroutine find_axis(input, hypothesis, values, load)
      type(input_file_t), intent(inout) :: input !! the file, behind the line
      character(*), intent(in) :: hypothesis !! hypothesis of the elements
      real(dp), intent(in) :: values(:) !! the numbers of the line: square of the angular speed, a point, a direction
      type(file_load_t), intent(inout) :: load !! the load

      if (values(1) < 0.0_dp) call input%refuse('CENTRIF: the square of the angular speed is negative', &
         input%position - 1)
      load%value = [sqrt(max(0.0_dp, values(1))), 0.0_dp]
      if (hypothesis == 'axisymmetric') then
         if (abs(values(2)) > 0.0_dp .or. abs(values(5)) > 0.0_dp) call input%refuse( &
            'CENTRIF: a body of revolution spins about its own axis', input%position - 1)
         return
      end if
      load%center = values(2:3)
      load%axis = values(5:6)
      if (any(abs(load%axis) > 0.0_dp) .and. abs(values(7)) > 0.0_dp) call input%refuse( &
         'CENTRIF: expected an axis in the plane or normal to it', input%position - 1)
   end subroutine find_axis

end module amontons_abaqus_model
