!> Meshes in the input format of Abaqus and CalculiX: nodes, elements and sets, and on demand the model.
!> Everything else is ignored, with a warning where it may affect results.
module amontons_abaqus
   use amontons_abaqus_lines, only: assembly_scope, capitals, end_instance, expected_instance, get_set, &
      insert_included, instance_shift, is_at_line_end, name_instance_sets, next_data_line, next_keyword, parameter_of, &
      read_set, read_surface, resolve_elements, set_of_field, start_instance, start_part, take_comma, take_tag
   use amontons_abaqus_model, only: finish_model, model_keywords, model_uses, read_model_keyword
   use amontons_element, only: hex20, hex8, is_solid, max_nodes, quad4, quad8, quad9, tet10, tet4, tri3, tri6
   use amontons_file_model, only: cell_dimension, line2, line3, n_cell_nodes, no_cell, raw_mesh_t, use_materials, &
      use_names
   use amontons_input_file, only: input_file_t, printable
   use amontons_integer_list, only: integer_list_t
   use amontons_kinds, only: dp
   use amontons_material, only: hypothesis_names
   use amontons_text, only: counted, lower_case, to_text
   implicit none (type, external)
   private

   public :: read_abaqus

   !> Keywords that leave the result of a computation as it is; all others that are not read get a warning.
   character(15), parameter :: idle_keywords(*) = [character(15) :: 'heading', 'preprint', 'restart', 'static', &
      'endstep', 'nodefile', 'elfile', 'contactfile', 'nodeprint', 'elprint', 'contactprint', 'sectionprint', &
      'energyprint', 'output', 'nodeoutput', 'elementoutput', 'contactoutput', 'energyoutput', 'fileformat', &
      'fileoutput', 'monitor', 'print', 'timepoints', 'controls', 'diagnostics', 'node']
   !> Names of keywords are cut to this length in messages.
   integer, parameter :: longest_shown = 40
   !> Largest number of keywords that are named in a message.
   integer, parameter :: most_named = 40

   !> The keywords that are ignored.
   type :: ignored_keywords_t
      private
      integer :: n = 0 !! number of keywords
      integer :: n_named = 0 !! number of different keywords
      character(:), allocatable :: names !! these keywords as messages name them, each after ', '
      character(:), allocatable :: warned !! those that describe physics; they get a warning
      logical :: is_readable(size(use_names)) = .false. !! whether some of them could be read
   contains
      procedure :: add => ignored_keywords_add
      procedure :: report => ignored_keywords_report
   end type ignored_keywords_t

contains

   !> Reads nodes, elements and sets; faults are recorded in the input. The text of a part is read once for each of its
   !> instances, at the end of the file if there are none.
   subroutine read_abaqus(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, at its first keyword
      character(:), allocatable :: keyword, line
      type(ignored_keywords_t) :: ignored
      type(integer_list_t) :: section_group, section_place
      integer :: i, n_dim
      logical :: is_read

      call insert_included(input)
      raw%nodes_name_sides = .true.
      raw%ignores_case = .true.
      raw%scope = ''
      allocate (raw%parts(0), raw%instances(0), raw%model%definitions(0), raw%model%sections(0), &
         raw%model%orientations(0), raw%model%conditions(4), raw%model%interactions(0), raw%model%contacts(0))
      do
         call next_keyword(input, keyword, line)
         if (keyword == '' .and. size(raw%parts) > 0 .and. size(raw%instances) == 0) then
            if (size(raw%parts) > 1) call input%refuse_line( &
               'several of *PART, but no *INSTANCE that says where they are')
            call start_instance(raw, input, '', trim(raw%parts(1)%name))
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
            if (keyword == 'instance') then
               if (parameter_of(line, 'name') == '') call input%refuse_line(expected_instance)
               call start_instance(raw, input, parameter_of(line, 'name'), parameter_of(line, 'part'))
            end if
            if (keyword == 'endassembly') raw%scope = ''
         case ('system', 'ngen', 'nfill', 'nmap', 'ncopy', 'elgen', 'elcopy')
            call input%refuse_line('*'//keyword//' is not read: write the nodes and elements out')
         case default
            if (index(keyword, 'section') > 0) then
               call section_group%append(set_of_field(raw, parameter_of(line, 'elset')))
               call section_place%append(input%position - 1)
            end if
            call read_model_keyword(raw, input, keyword, line, is_read)
         end select
         if (.not. is_read) call ignored%add(keyword, line)
      end do
      call ignored%report(raw)
      call end_instance(raw, input, '')
      raw%scope = ''
      call name_instance_sets(raw)
      if (.not. allocated(input%error)) call resolve_elements(raw, input)
      n_dim = raw%n_dim()
      do i = 1, section_group%n
         if (section_group%item(i) == 0) cycle
         associate (name => raw%groups(section_group%item(i))%name, cells => &
            raw%groups(section_group%item(i))%cell%items())
            if (any(cell_dimension(raw%cell_kind%item(cells)) < n_dim)) call input%refuse( &
               "a section makes bars or shells of the lines or faces of set '"//name//"', and these cannot be "// &
               'computed: leave them out; without a section they name the boundary', section_place%item(i))
         end associate
      end do
      if (.not. allocated(input%error)) call finish_model(raw, input)
   end subroutine read_abaqus

   !> Reads nodes: number and up to three coordinates; missing ones are 0.
   pure subroutine read_nodes(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      ! Numbers behind the coordinates, as the normals of shells, are skipped.
      integer, parameter :: most_numbers = 6
      integer :: group, i, place, shift, tag
      real(dp) :: numbers(most_numbers)
      logical :: is_there

      if (parameter_of(line, 'input') /= '') call input%refuse_line( &
         '*NODE with INPUT= is not read: write the nodes out')
      if (all(lower_case(parameter_of(line, 'system')) /= ['r', ' '])) call input%refuse_line( &
         'nodes in other than rectangular coordinates')
      call get_set(raw, input, line, 'nset', group)
      shift = instance_shift(raw, raw%scope)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         place = input%position
         call take_tag(input, shift, tag, 'the number of a node')
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
         if (raw%is_in_instance) then
            associate (instance => raw%instances(size(raw%instances)))
               numbers(:3) = instance%origin + matmul(instance%rotation, numbers(:3))
            end associate
         end if
         call raw%add_node(tag, place, numbers(:3))
         if (group > 0) call raw%groups(group)%node%append(tag)
      end do
   end subroutine read_nodes

   !> Reads elements of one type with its hypothesis; lines and some plane types have none. A comma at the end of a line
   !> continues it on the next one.
   pure subroutine read_elements(raw, input, line)
      type(raw_mesh_t), intent(inout) :: raw !! contents of the file
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: line !! the keyword line
      ! The first letters of the types of each of `hypothesis_names`.
      character(3), parameter :: families(3) = ['cpe', 'cps', 'cax']
      character(:), allocatable :: value
      character(12) :: before
      integer :: family, group, i, kind, last, n, nodes(max_nodes), place, shift, tag
      logical :: is_there

      if (parameter_of(line, 'input') /= '') call input%refuse_line( &
         '*ELEMENT with INPUT= is not read: write the elements out')
      value = parameter_of(line, 'type')
      call find_kind(input, value, kind, last)
      family = 0
      if (kind > 0 .and. scan(value, 'pP', back=.true.) < 4) family = findloc(families == lower_case(value(:3)), &
         .true., dim=1)
      if (kind == line2 .or. kind == line3) then
         call raw%add_note('elements of type '//value//' are taken for names of the boundary, not for bars')
      else if (family == 0 .and. .not. is_solid(kind)) then
         call raw%add_note('elements of type '//value//' are taken for plane elements; the deck says of which kind')
      else if (len(value) > last) then
         call raw%add_note('elements of type '//value//' are taken for '//value(:last)// &
            ': compatible and fully integrated')
      end if
      before = raw%hypothesis
      if (family > 0) raw%hypothesis = hypothesis_names(family)
      if (raw%model%is_used(use_materials) .and. before /= '' .and. before /= raw%hypothesis) call input%refuse_line( &
         'materials cannot be used: some elements are of type '//trim(before)//', others of '//trim(raw%hypothesis))
      n = n_cell_nodes(kind)
      shift = instance_shift(raw, raw%scope)
      call get_set(raw, input, line, 'elset', group)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         place = input%position
         call take_tag(input, shift, tag, 'the number of an element')
         do i = 1, n
            call take_comma(input, is_there)
            if (.not. is_there) call input%refuse('expected a comma and a node of an element, one of '//to_text(n)// &
               ' of type '//value//', found '//input%word())
            if (is_at_line_end(input)) call next_data_line(input, is_there)
            call take_tag(input, shift, nodes(i), 'a node of an element')
         end do
         call take_comma(input, is_there)
         call input%end_line()
         if (allocated(input%error)) exit
         call raw%add_cell(kind, tag, place, nodes(:n))
         if (group == 0) cycle
         call raw%groups(group)%cell%append(tag)
         call raw%groups(group)%side%append(0)
      end do
   end subroutine read_elements

   !> Finds the kind of cell of an element type.
   pure subroutine find_kind(input, type, kind, last)
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: type !! name of the type
      integer, intent(out) :: kind !! kind of the elements, `no_cell` where there is a fault
      integer, intent(out) :: last !! number of characters of the name up to the number of nodes
      character(3), parameter :: plane(*) = ['cpe', 'cps', 'cax', 'm3d', 'r3d']
      character(*), parameter :: plane_digits = '34689'
      integer, parameter :: plane_kinds(0:len(plane_digits)) = [no_cell, tri3, quad4, tri6, quad8, quad9]
      character(:), allocatable :: name

      name = lower_case(type)//'     '
      last = 2 + verify(name(4:), '0123456789')
      kind = no_cell
      select case (name(:last))
      case ('c3d4')
         kind = tet4
      case ('c3d8')
         kind = hex8
      case ('c3d10')
         kind = tet10
      case ('c3d20')
         kind = hex20
      case ('t2d2', 't3d2', 'b21', 'b31')
         kind = line2
      case ('t2d3', 't3d3', 'b22', 'b32')
         kind = line3
      case default
         if (any(plane == name(:3)) .and. last == 4) kind = plane_kinds(index(plane_digits, name(4:4)))
      end select
      if (verify(trim(name(last + 1:)), 'rhimtps') > 0) kind = no_cell
      if (kind == no_cell) call input%refuse_line("elements of type '"//type//"' are not supported: expected CPE3, "// &
         'CPE4, CPE6, CPE8 or the same of CPS and CAX, C3D4, C3D8, C3D10, C3D20')
   end subroutine find_kind

   !> Adds a keyword of the file to those that are ignored.
   pure subroutine ignored_keywords_add(self, keyword, line)
      class(ignored_keywords_t), intent(inout) :: self !! the keywords
      character(*), intent(in) :: keyword !! the keyword in small letters, without blanks
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: name
      integer :: last, place

      if (self%n == 0) self%names = ''
      if (self%n == 0) self%warned = ''
      self%n = self%n + 1
      last = index(line//',', ',') - 1
      ! What kind of step it is may matter, and of what the initial conditions are.
      if (keyword == 'step' .or. keyword == 'initialconditions') last = len(line)
      name = ', *'//capitals(printable(trim(line(:min(longest_shown, last)))))
      if (index(self%names//',', name//',') > 0 .or. self%n_named == most_named) return
      self%n_named = self%n_named + 1
      self%names = self%names//name
      place = findloc(model_keywords == keyword, .true., dim=1)
      if (place > 0) self%is_readable(model_uses(place)) = .true.
      if (all(idle_keywords /= keyword)) self%warned = self%warned//name
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

end module amontons_abaqus
