!> Meshes in the input format of Abaqus and CalculiX: nodes, plane elements and sets; and on demand the model:
!> materials, sections, which assign them to sets of elements, initial temperatures of nodes (without strain) and those
!> of the step, supports and loads. Everything else is ignored, with a warning where it affects results.
module amontons_abaqus
   use amontons_abaqus_lines, only: add_members, assembly_scope, degree, end_instance, find_parameter, get_set, &
      insert_included, is_at_line_end, name_instance_sets, next_data_line, next_keyword, place_of_name, read_set, &
      read_surface, read_tag, refuse_parameters, resolve_elements, set_of_field, start_instance, start_part, &
      take_comma, take_fields, take_line_of_numbers, take_number
   use amontons_constraints, only: new_support, support_t
   use amontons_element, only: max_nodes, quad4, quad8, tri3, tri6
   use amontons_error, only: error_t
   use amontons_file_model, only: file_material_t, file_temperatures_t, line2, line3, longest_name, n_cell_nodes, &
      no_cell, raw_mesh_t, use_loads, use_materials, use_names, use_supports
   use amontons_input_file, only: input_file_t, printable
   use amontons_integer_list, only: integer_list_t, new_tag_map
   use amontons_kinds, only: dp
   use amontons_loads, only: load_by_temperature, load_on_nodes, load_on_region, load_t, new_load
   use amontons_material, only: hypothesis_names, new_material
   use amontons_text, only: counted, lower_case, read_integer, to_text
   implicit none (type, external)
   private

   public :: read_abaqus

   !> Keywords that may be read in addition to the mesh.
   character(12), parameter :: model_keywords(*) = [character(12) :: 'material', 'elastic', 'density', 'expansion', &
      'orientation', 'solidsection', 'boundary', 'cload', 'dload', 'dsload', 'temperature']
   !> The part of the model to which each of these keywords belongs: materials, supports or loads.
   integer, parameter :: model_uses(*) = [spread(use_materials, 1, 6), use_supports, spread(use_loads, 1, 4)]
   !> Other keywords that affect the result of a computation.
   character(33), parameter :: other_keywords(*) = [character(33) :: 'step', 'amplitude', 'transform', 'plastic', &
      'hyperelastic', 'hyperfoam', 'creep', 'viscoelastic', 'damping', 'contactpair', 'contact', 'contactinclusions', &
      'surfaceinteraction', 'surfacebehavior', 'friction', 'clearance', 'contactinterference', 'tie', 'equation', &
      'mpc', 'coupling', 'kinematic', 'distributing', 'rigidbody', 'spring', 'gap', 'mass', 'initialconditions', &
      'foundation', 'modelchange', 'pre-tensionsection', &
      'cflux', 'dflux', 'film', 'radiate', 'inertiarelief', 'basemotion', 'field', 'nodalthickness', 'usermaterial', &
      'deformationplasticity', 'cyclichardening', 'druckerprager', 'mohrcoulomb', 'concretedamagedplasticity', &
      'nocompression', 'notension', 'swelling', 'submodel', 'dashpot', 'embeddedelement', 'changefriction', &
      'changesurfacebehavior', 'changematerial', 'changesolidsection', 'cyclicsymmetrymodel', 'dynamic', 'frequency', &
      'complexfrequency', 'buckle', 'visco', 'modaldynamic', 'steadystatedynamics', 'heattransfer', &
      'coupledtemperature-displacement', 'uncoupledtemperature-displacement']
   !> Names of keywords are cut to this length in messages.
   integer, parameter :: longest_shown = 40
   !> Largest number of keywords that are named in a message.
   integer, parameter :: most_named = 40

   !> The keywords that are ignored.
   type :: ignored_keywords_t
      private
      integer :: n = 0 !! number of keywords
      integer :: n_named = 0 !! number of different keywords
      character(:), allocatable :: keys !! the different keywords in small letters, each between line ends
      character(:), allocatable :: names !! these keywords as messages name them, each after ', '
      character(:), allocatable :: warned !! those that describe physics; they get a warning
      logical :: is_readable(size(use_names)) = .false. !! whether some of them could be read
   contains
      procedure :: add => ignored_keywords_add
      procedure :: report => ignored_keywords_report
   end type ignored_keywords_t

   !> Largest number of fields of a data line; the temperatures of a shell follow that of its first point.
   integer, parameter :: most_fields = 9
   !> Number of constants of an orthotropic material: three moduli, ratios of Poisson and shear moduli.
   integer, parameter :: n_engineering_constants = 9

contains

   !> Reads nodes, elements and sets; faults are recorded in the input. The text of a part is read once for each of its
   !> instances, at the end of the file if there are none.
   subroutine read_abaqus(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, at its first keyword
      character(:), allocatable :: keyword, line
      type(ignored_keywords_t) :: ignored
      logical :: is_read

      call insert_included(input)
      raw%nodes_name_sides = .true.
      raw%ignores_case = .true.
      raw%scope = ''
      allocate (raw%parts(0), raw%instances(0), raw%model%definitions(0), raw%model%sections(0), &
         raw%model%orientations(0), raw%model%supports(4), raw%model%loads(4))
      do
         call next_keyword(input, keyword, line)
         if (keyword == '' .and. size(raw%parts) > 0 .and. size(raw%instances) == 0) then
            if (size(raw%parts) > 1) call input%refuse_line( &
               'several of *PART, but no *INSTANCE that says where they are')
            call start_instance(raw, input, 'instance, name, part='//raw%parts(1)%name)
            cycle
         end if
         if (keyword == '' .or. allocated(input%error)) exit
         is_read = .true.
         select case (keyword)
         case ('node')
            ! Nodes of the assembly are points of reference.
            is_read = raw%scope /= assembly_scope
            if (is_read) call read_nodes(raw, input, line)
         case ('element')
            call read_elements(raw, input, line)
         case ('nset', 'elset')
            call read_set(raw, input, line, keyword)
         case ('surface')
            call read_surface(raw, input, line)
         case ('part')
            call start_part(raw, input, line)
         case ('endpart')
            if (raw%place_behind > 0) input%position = raw%place_behind
            raw%place_behind = 0
         case ('assembly', 'instance', 'endinstance', 'endassembly')
            call end_instance(raw, input, keyword)
            if (keyword == 'instance') call start_instance(raw, input, line)
            if (keyword == 'endassembly') raw%scope = ''
         case ('system', 'ngen', 'nfill', 'nmap', 'ncopy', 'elgen', 'elcopy')
            call input%refuse_line('*'//keyword//' is not read: write the nodes and elements out')
         case default
            call read_model_keyword(raw, input, keyword, line, is_read)
         end select
         if (.not. is_read) call ignored%add(keyword, line)
      end do
      call ignored%report(raw)
      call end_instance(raw, input, '')
      raw%scope = ''
      call name_instance_sets(raw)
      if (.not. allocated(input%error)) call resolve_elements(raw, input)
      if (.not. allocated(input%error)) call finish_model(raw, input)
   end subroutine read_abaqus

   !> Reads nodes: number and up to three coordinates; missing ones are 0.
   pure subroutine read_nodes(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      ! Numbers behind the coordinates, as the normals of shells, are skipped.
      integer, parameter :: most_numbers = 6
      character(:), allocatable :: value
      integer :: group, i, place, tag
      real(dp) :: numbers(most_numbers)
      logical :: is_there

      call find_parameter(line, 'input', value, is_there)
      if (is_there) call input%refuse_line('*NODE with INPUT= is not read: write the nodes out')
      call find_parameter(line, 'system', value, is_there)
      if (is_there .and. lower_case(value) /= 'r') call input%refuse_line('nodes in other than rectangular coordinates')
      call get_set(raw, input, line, 'nset', group)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         place = input%position
         call input%take_integer(tag, 'the number of a node')
         numbers = 0.0_dp
         do i = 1, most_numbers
            call take_comma(input, is_there)
            if (.not. is_there) exit
            if (is_at_line_end(input)) exit
            if (input%text(input%position:input%position) == ',') cycle
            call input%take_real(numbers(i), 'a coordinate')
         end do
         call input%end_line()
         if (allocated(input%error)) exit
         call raw%add_node(tag, place, numbers(:3))
         if (group > 0) call raw%groups(group)%node%append(tag)
      end do
   end subroutine read_nodes

   !> Reads elements of one type with its hypothesis; lines have none. A comma at the end of a line continues it on the
   !> next one.
   pure subroutine read_elements(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      ! The first letters of the types of each of `hypothesis_names`.
      character(3), parameter :: families(3) = ['cpe', 'cps', 'cax']
      character(:), allocatable :: value
      character(12) :: before
      integer :: group, i, kind, n, nodes(max_nodes), place, tag
      logical :: is_there

      call find_parameter(line, 'input', value, is_there)
      if (is_there) call input%refuse_line('*ELEMENT with INPUT= is not read: write the elements out')
      call find_parameter(line, 'type', value, is_there)
      call find_kind(input, value, kind)
      if (kind == line2 .or. kind == line3) call raw%add_note('elements of type '//value// &
         ' are taken for names of the boundary, not for bars')
      if (kind > 0 .and. len(value) > 4) call raw%add_note('elements of type '//value// &
         ' are taken for '//value(:4)//': compatible and fully integrated')
      before = raw%hypothesis
      if (kind > 0) raw%hypothesis = hypothesis_names(findloc(families == lower_case(value(:3)), .true., dim=1))
      if (raw%model%is_used(use_materials) .and. before /= '' .and. before /= raw%hypothesis) call input%refuse_line( &
         'materials cannot be used: some elements are of type '//trim(before)//', others of '//trim(raw%hypothesis))
      n = n_cell_nodes(kind)
      call get_set(raw, input, line, 'elset', group)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         place = input%position
         call input%take_integer(tag, 'the number of an element')
         do i = 1, n
            call take_comma(input, is_there)
            if (.not. is_there) call input%refuse('expected a comma and a node of an element, found '//input%word())
            if (is_at_line_end(input)) call next_data_line(input, is_there)
            call input%take_integer(nodes(i), 'a node of an element')
         end do
         call take_comma(input, is_there)
         call input%end_line()
         if (allocated(input%error)) exit
         ! A line over three nodes is given from end to end here.
         if (kind == line3) nodes(:n) = nodes([1, 3, 2])
         call raw%add_cell(kind, tag, place, nodes(:n))
         if (group == 0) cycle
         call raw%groups(group)%cell%append(tag)
         call raw%groups(group)%side%append(0)
      end do
   end subroutine read_elements

   !> Finds the kind of cell of an element type.
   pure subroutine find_kind(input, type, kind)
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: type !! name of the type
      integer, intent(out) :: kind !! kind of the elements, `no_cell` where there is a fault
      ! By the digit behind the first three letters.
      integer, parameter :: plane_kinds(0:4) = [no_cell, tri3, quad4, tri6, quad8]
      integer, parameter :: line_kinds(0:2) = [no_cell, line2, line3]
      character(:), allocatable :: name

      name = lower_case(type)//'     '
      select case (name(:3))
      case ('cpe', 'cps', 'cax')
         kind = plane_kinds(index('3468', name(4:4)))
      case ('t2d', 't3d')
         kind = line_kinds(index('23', name(4:4)))
      case default
         kind = no_cell
      end select
      if (verify(trim(name(5:)), 'rhimt') > 0) kind = no_cell
      if (kind /= no_cell) return
      if (name(:3) == 'c3d') then
         call input%refuse_line('3-D mesh: found elements of type '//type//', expected plane elements')
      else
         call input%refuse_line("elements of type '"//type//"' are not supported: expected CPE3, CPE4, CPE6, CPE8 "// &
            'or the same of CPS and CAX')
      end if
   end subroutine find_kind

   !> Adds a keyword of the file to those that are ignored.
   pure subroutine ignored_keywords_add(self, keyword, line)
      class(ignored_keywords_t), intent(inout) :: self !! the keywords
      character(*), intent(in) :: keyword !! the keyword in small letters, without blanks
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: name
      integer :: last, place

      if (.not. allocated(self%keys)) then
         self%keys = achar(10)
         self%names = ''
         self%warned = ''
      end if
      self%n = self%n + 1
      if (index(self%keys, achar(10)//keyword//achar(10)) > 0 .or. self%n_named == most_named) return
      self%n_named = self%n_named + 1
      self%keys = self%keys//keyword//achar(10)
      last = index(line//',', ',') - 1
      ! What kind of step it is may matter, and of what the initial conditions are.
      if (keyword == 'step' .or. keyword == 'initialconditions') last = len(line)
      name = ', *'//capitals(printable(trim(line(:min(longest_shown, last)))))
      self%names = self%names//name
      place = findloc(model_keywords == keyword, .true., dim=1)
      if (place > 0) self%is_readable(model_uses(place)) = .true.
      if (place > 0 .or. any(other_keywords == keyword)) self%warned = self%warned//name
   end subroutine ignored_keywords_add

   !> Adds a note on the ignored keywords to a raw mesh, and a warning on those that affect results.
   pure subroutine ignored_keywords_report(self, raw)
      class(ignored_keywords_t), intent(in) :: self !! the keywords
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      character(:), allocatable :: words
      integer :: i

      if (self%n == 0) return
      call raw%add_note(counted(self%n, 'keyword')//' ignored (not mesh data): '//self%names(3:))
      if (self%warned == '') return
      raw%warning = 'not read from the mesh file: '//self%warned(3:)
      words = ''
      do i = 1, size(use_names)
         if (self%is_readable(i)) words = words//", '"//trim(use_names(i))//"'"
      end do
      if (words /= '') raw%warning = raw%warning//'; give them in the deck, or &mesh use = '//words(3:)
   end subroutine ignored_keywords_report

   !> A text in capital letters.
   pure function capitals(text) result(upper)
      character(*), intent(in) :: text !! the text
      character(len(text)) :: upper
      integer :: i

      upper = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') upper(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function capitals

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
         call find_parameter(line, 'name', name, is_there)
         if (name == '' .or. len(name) > longest_name) call input%refuse_line( &
            'expected NAME= and the name of a material')
         raw%model%definitions = [raw%model%definitions, file_material_t(name=name)]
      case default
         call refuse_parameters(input, line)
         last = size(raw%model%definitions)
         if (last == 0) call input%refuse_line('*'//keyword//' before any *MATERIAL')
         call find_parameter(line, 'type', name, is_there)
         is_engineering = index(lower_case(name), 'engineering') == 1
         n_values = merge(2, 1, keyword == 'elastic')
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
               material%expansion = values(1)
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

      call find_parameter(line, 'elset', region, is_there)
      call find_parameter(line, 'material', name, is_there)
      group = set_of_field(raw, region)
      if (group == 0) call input%refuse_line("*SOLID SECTION: there is no set '"//region//"' above")
      if (name == '' .or. len(name) > longest_name) call input%refuse_line( &
         '*SOLID SECTION: expected MATERIAL= and the name of a material')
      if (allocated(input%error)) return
      section%name = name
      section%region = raw%groups(group)%name
      section%place = input%position - 1
      call find_parameter(line, 'orientation', name, is_there)
      if (is_there) then
         i = place_of_name(raw%model%orientations%name, name)
         if (i == 0) call input%refuse_line("*SOLID SECTION: there is no *ORIENTATION '"//name//"' above")
         if (i > 0) section%angle = raw%model%orientations(i)%angle
      end if
      call next_data_line(input, is_there)
      if (is_there) then
         call take_fields(input, fields, n)
         if (n > 0 .and. fields(1) /= '') call take_number(input, fields(1), section%thickness)
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
      character(:), allocatable :: name
      real(dp) :: axis(2), points(most_fields), turn(2)
      logical :: is_there

      call refuse_parameters(input, line)
      call find_parameter(line, 'name', name, is_there)
      call take_line_of_numbers(input, points)
      call take_line_of_numbers(input, turn)
      if (any(abs(points([3, 6])) > 0.0_dp) .or. .not. points(1)*points(5) > points(2)*points(4) &
         .or. (abs(turn(2)) > 0.0_dp .and. nint(turn(1)) /= 3)) call input%refuse_line( &
         '*ORIENTATION: the third axis must be that of z')
      axis = [1.0_dp, 0.0_dp]
      if (raw%is_in_instance) axis = raw%instances(size(raw%instances))%axis
      orientation%name = name
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
      character(:), allocatable :: name, type
      type(integer_list_t) :: tags
      integer :: i, n, node
      real(dp) :: value
      logical :: is_there

      call find_parameter(line, 'type', type, is_read)
      is_read = keyword == 'temperature' .or. lower_case(type) == 'temperature'
      if (.not. is_read) return
      call refuse_parameters(input, line)
      call expect_nodes(raw%model%temperatures, raw%node_tag%items())
      name = '*'//line(:index(line//',', ',') - 1)//': '
      associate (temperatures => raw%model%temperatures)
         if (keyword == 'temperature') temperatures%place = input%position - 1
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
               if (keyword == 'temperature') then
                  temperatures%step(node) = value
                  temperatures%is_given(node) = .true.
               else
                  temperatures%initial(node) = value
               end if
            end do
         end do
      end associate
   end subroutine read_temperatures

   !> Allocates temperatures for the nodes read so far, with the initial value 0.
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
                  if (definition%shear > 0.0_dp .and. .not. allocated(error)) then
                     material%young = definition%young
                     material%poisson = definition%poisson
                     material%shear = definition%shear
                     material%angle = section%angle
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
         if (temperatures%place == 0) return
         call expect_nodes(temperatures, raw%node_tag%items())
         call new_load(load, '')
         load%target = load_by_temperature
         allocate (load%temperature_table(2, raw%node_tag%n))
         load%temperature_table(1, :) = raw%node_tag%items()
         load%temperature_table(2, :) = merge(temperatures%step - temperatures%initial, 0.0_dp, temperatures%is_given)
         load%temperature_file = input%file
         call locate(input, temperatures%place, load%origin, label)
         call model%add_load(load)
         if (.not. temperatures%has_initial) call raw%add_note( &
            '*TEMPERATURE without *INITIAL CONDITIONS, TYPE=TEMPERATURE: nothing is strained at the temperature 0')
         if (.not. model%is_used(use_materials)) return
         if (.not. any(abs(model%materials%largest_expansion()) > 0.0_dp)) call input%refuse( &
            '*TEMPERATURE has no effect: no *SOLID SECTION has a material with *EXPANSION')
      end associate
   end subroutine finish_model

   !> Reads a keyword with its data lines if the deck uses this part of the model.
   pure subroutine read_model_keyword(raw, input, keyword, line, is_read)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file; gains materials, supports, loads and their sets
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! the keyword in small letters
      character(*), intent(in) :: line !! the keyword line
      logical, intent(out) :: is_read !! whether it was one; of a step: whether displacements are small
      character(:), allocatable :: value
      integer :: place
      logical :: is_there

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
      case ('cload')
         call read_cload(raw, input, line)
      case ('dload', 'dsload')
         call read_dload(raw, input, keyword, line)
      case ('temperature', 'initialconditions')
         call read_temperatures(raw, input, keyword, line, is_read)
      case ('step')
         raw%model%n_steps = raw%model%n_steps + 1
         if (raw%model%n_steps > 1) call input%refuse_line( &
            'a second *STEP: the supports and loads of one step can be used')
         call find_parameter(line, 'nlgeom', value, is_there)
         is_read = .not. is_there .or. lower_case(value) == 'no'
      case ('transform')
         call input%refuse_line('supports and loads in the directions of a *TRANSFORM cannot be used')
      case default
         is_read = .false.
      end select
   end subroutine read_model_keyword

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
         value = 0.0_dp
         if (n > 3) call take_number(input, fields(4), value)
         support%displacement = merge(value, 0.0_dp, support%is_held)
         if (.not. any(support%is_held)) cycle
         ! Nodes of consecutive lines are one set if they have the same prescribed displacements.
         call take_nodes(raw, input, '*BOUNDARY', fields(1), label, all(support%is_held .eqv. before%is_held) &
            .and. .not. any(abs(support%displacement - before%displacement) > 0.0_dp), before%set, support%set)
         if (allocated(input%error)) return
         if (support%set /= before%set) call raw%model%add_support(support)
         before = support
         if (support%set(1:1) /= '*') before%set = ''
      end do
   end subroutine read_boundary

   !> Reads forces on nodes: nodes, component, value.
   pure subroutine read_cload(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      character(longest_name) :: fields(most_fields)
      character(:), allocatable :: label
      type(load_t) :: load, before
      integer :: component, n
      real(dp) :: value
      logical :: is_there, ok

      call refuse_parameters(input, line)
      call new_load(before, '')
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call new_load(load, '')
         load%target = load_on_nodes
         call locate(input, input%position, load%origin, label)
         call take_fields(input, fields, n)
         call read_integer(trim(fields(2)), component, ok)
         if (.not. ok .or. component < 1 .or. component > 2) call input%refuse_line( &
            "*CLOAD: expected the component 1 or 2, found '"//trim(fields(2))//"'")
         call take_number(input, fields(3), value)
         if (allocated(input%error)) return
         load%force(component) = value
         call take_nodes(raw, input, '*CLOAD', fields(1), label, &
            all(abs(load%force - before%force) <= 0.0_dp), before%set, load%set)
         if (allocated(input%error)) return
         if (load%set /= before%set) call raw%model%add_load(load)
         before = load
         if (load%set(1:1) /= '*') before%set = ''
      end do
   end subroutine read_cload

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

   !> Reads distributed loads: elements or a surface, kind, value. A set is made of the sides under pressure.
   pure subroutine read_dload(raw, input, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: keyword !! 'dload' or 'dsload'
      character(*), intent(in) :: line !! the keyword line
      character(2), parameter :: side_labels(4) = ['p1', 'p2', 'p3', 'p4']
      character(longest_name) :: fields(most_fields)
      character(:), allocatable :: label
      type(integer_list_t) :: elements
      type(load_t) :: load
      real(dp) :: values(most_fields - 2)
      integer :: group, i, n, side
      logical :: is_there

      call refuse_parameters(input, line)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         call new_load(load, '')
         call locate(input, input%position, load%origin, label)
         call take_fields(input, fields, n)
         values = 0.0_dp
         do i = 3, n
            if (fields(i) /= '') call take_number(input, fields(i), values(i - 2))
         end do
         if (allocated(input%error)) return
         load%pressure = values(1)
         group = set_of_field(raw, trim(fields(1)))
         side = findloc(side_labels == lower_case(fields(2)), .true., dim=1)
         if (keyword == 'dsload' .and. lower_case(fields(2)) == 'p' .and. group > 0) then
            load%set = raw%groups(group)%name
         else if (keyword == 'dload' .and. side > 0) then
            load%set = '*DLOAD:'//label
            elements%n = 0
            call add_members(raw, input, '*DLOAD: there is no set', .false., trim(fields(1)), elements)
            if (elements%n == 0) call input%refuse_line("*DLOAD: there is no set '"//trim(fields(1))//"' above")
            if (.not. allocated(input%error)) call raw%get_group(input, load%set, group)
            if (allocated(input%error)) return
            call raw%groups(group)%cell%append_all(elements%items())
            call raw%groups(group)%side%append_all(spread(side, 1, elements%n))
         else
            call interpret_dload(raw, input, keyword, group, fields, values, load)
         end if
         if (allocated(input%error)) return
         call raw%model%add_load(load)
      end do
   end subroutine read_dload

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
      load%pressure = 0.0_dp
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
         if (.not. allocated(input%error)) load%gravity = values(1)*values(2:3)/norm2(values(2:3))
      case ('centrif')
         ! The square of the angular speed, a point of the axis and its direction. A body of revolution has its own.
         if (values(1) < 0.0_dp) call input%refuse_line('CENTRIF: the square of the angular speed is negative')
         load%angular_speed = sqrt(max(0.0_dp, values(1)))
         if (raw%hypothesis == 'axisymmetric') then
            if (abs(values(2)) > 0.0_dp .or. abs(values(5)) > 0.0_dp) call input%refuse_line( &
               'CENTRIF: a body of revolution spins about its own axis')
            return
         end if
         load%center = values(2:3)
         load%axis = values(5:6)
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
      integer :: line

      call input%locate(place, origin, line)
      label = to_text(line)
      if (origin /= input%file) label = origin//':'//label
      origin = origin//':'//to_text(line)//': '
   end subroutine locate

end module amontons_abaqus
