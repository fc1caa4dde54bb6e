!> Meshes in the input format of Abaqus and CalculiX: nodes, plane elements and sets, and on demand materials, supports
!> and loads; everything else is ignored, with a warning where it matters.
module amontons_abaqus
   use amontons_abaqus_lines, only: abaqus_scope_t, find_parameter, get_set, is_at_line_end, next_data_line, &
      next_keyword, read_set, read_surface, resolve_elements, take_comma
   use amontons_abaqus_model, only: finish_materials, finish_temperatures, read_model_keyword
   use amontons_element, only: quad4, quad8, tri3, tri6
   use amontons_file_model, only: line2, line3, n_cell_nodes, no_cell, raw_mesh_t, use_loads, use_materials, &
      use_names, use_supports
   use amontons_input_file, only: input_file_t, printable
   use amontons_kinds, only: dp
   use amontons_text, only: counted, lower_case
   implicit none (type, external)
   private

   public :: ignored_keywords_t, read_abaqus

   !> Keywords that say what the body is made of.
   character(12), parameter :: material_keywords(*) = [character(12) :: 'material', 'elastic', 'density', 'expansion', &
      'solidsection']
   !> Keywords that hold nodes.
   character(12), parameter :: support_keywords(*) = [character(12) :: 'boundary']
   !> Keywords of loads.
   character(12), parameter :: load_keywords(*) = [character(12) :: 'cload', 'dload', 'dsload', 'temperature']
   !> Other keywords that change what a computation gives.
   character(33), parameter :: other_keywords(*) = [character(33) :: 'step', 'amplitude', 'transform', 'plastic', &
      'hyperelastic', 'hyperfoam', 'creep', 'viscoelastic', 'damping', 'contactpair', 'contact', 'contactinclusions', &
      'surfaceinteraction', 'surfacebehavior', 'friction', 'clearance', 'contactinterference', 'tie', 'equation', &
      'mpc', 'coupling', 'kinematic', 'distributing', 'rigidbody', 'spring', 'gap', 'mass', 'initialconditions', &
      'foundation', 'orientation', 'modelchange', 'pre-tensionsection', &
      'cflux', 'dflux', 'film', 'radiate', 'inertiarelief', 'basemotion', 'field', 'nodalthickness', 'usermaterial', &
      'deformationplasticity', 'cyclichardening', 'druckerprager', 'mohrcoulomb', 'concretedamagedplasticity', &
      'nocompression', 'notension', 'swelling', 'submodel', 'dashpot', 'embeddedelement', 'changefriction', &
      'changesurfacebehavior', 'changematerial', 'changesolidsection', 'cyclicsymmetrymodel', 'dynamic', 'frequency', &
      'complexfrequency', 'buckle', 'visco', 'modaldynamic', 'steadystatedynamics', 'heattransfer', &
      'coupledtemperature-displacement', 'uncoupledtemperature-displacement']
   !> Names of keywords are cut in messages.
   integer, parameter :: longest_name = 40
   !> Most keywords that are named.
   integer, parameter :: most_named = 40

   !> The keywords that are ignored.
   type :: ignored_keywords_t
      private
      integer :: n = 0 !! how many there are
      integer :: n_named = 0 !! how many different ones
      character(:), allocatable :: keys !! the different ones in small letters, each between line ends
      character(:), allocatable :: names !! the same as messages name them, ', ' before each
      character(:), allocatable :: warned !! those of them that matter
      logical :: is_readable(size(use_names)) = .false. !! whether some of them could be read
   contains
      procedure :: add => ignored_keywords_add
      procedure :: tell => ignored_keywords_tell
   end type ignored_keywords_t

contains

   !> Reads nodes, elements and sets. Faults go to the input.
   pure subroutine read_abaqus(raw, input)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, at its first keyword
      type(abaqus_scope_t) :: scope
      character(:), allocatable :: keyword, line
      type(ignored_keywords_t) :: ignored

      raw%nodes_name_sides = .true.
      raw%ignores_case = .true.
      do
         call next_keyword(input, keyword, line)
         if (keyword == '' .or. allocated(input%error)) exit
         call read_keyword(raw, input, scope, ignored, keyword, line)
      end do
      call ignored%tell(raw)
      if (.not. allocated(input%error)) call resolve_elements(raw, input)
      if (.not. allocated(input%error)) call finish_materials(raw, input)
      if (.not. allocated(input%error)) call finish_temperatures(raw, input)
   end subroutine read_abaqus

   !> Reads a keyword with its data lines.
   pure subroutine read_keyword(raw, input, scope, ignored, keyword, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      type(abaqus_scope_t), intent(inout) :: scope !! where the file is
      type(ignored_keywords_t), intent(inout) :: ignored !! gains the keyword if it is not read
      character(*), intent(in) :: keyword !! the keyword in small letters
      character(*), intent(in) :: line !! the keyword line
      logical :: is_read

      select case (keyword)
      case ('node')
         if (scope%in_assembly) call ignored%add(keyword, line)
         if (.not. scope%in_assembly) call read_nodes(raw, input, scope, line)
      case ('element')
         call read_elements(raw, input, scope, line)
      case ('nset', 'elset')
         call read_set(raw, input, scope, line, keyword)
      case ('surface')
         call read_surface(raw, input, scope, line)
      case ('part', 'instance', 'assembly', 'endassembly')
         call enter_scope(scope, raw, input, keyword)
      case ('include', 'system', 'ngen', 'nfill', 'nmap', 'ncopy', 'elgen', 'elcopy')
         call input%refuse('*'//keyword//' is not read: write the nodes and elements out', input%position - 1)
      case default
         call read_model_keyword(raw, input, keyword, line, is_read)
         if (.not. is_read) call ignored%add(keyword, line)
      end select
   end subroutine read_keyword

   !> Enters a part, an instance or the assembly, or leaves the assembly. There may be one part, in one instance, not
   !> moved.
   pure subroutine enter_scope(scope, raw, input, keyword)
      type(abaqus_scope_t), intent(inout) :: scope !! where the file is
      type(raw_mesh_t), intent(in) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: keyword !! the keyword in small letters
      logical :: is_moved

      select case (keyword)
      case ('part')
         scope%n_parts = scope%n_parts + 1
      case ('instance')
         scope%n_instances = scope%n_instances + 1
         call next_data_line(input, is_moved)
         if (is_moved) call input%refuse('an instance that is moved from where its part is')
      case ('assembly')
         scope%in_assembly = .true.
         scope%n_part_groups = raw%n_groups
      case default
         scope%in_assembly = .false.
      end select
      if (max(scope%n_parts, scope%n_instances) > 1) call input%refuse( &
         'a second part or instance: only one body is read', input%position - 1)
   end subroutine enter_scope

   !> Reads nodes: number and up to three coordinates, absent ones being 0.
   pure subroutine read_nodes(raw, input, scope, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      type(abaqus_scope_t), intent(in) :: scope !! where the file is
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: value
      integer :: group, place, tag
      real(dp) :: x(3)
      logical :: is_there

      call find_parameter(line, 'input', value, is_there)
      if (is_there) call input%refuse('*NODE with INPUT= is not read: write the nodes out', input%position - 1)
      call find_parameter(line, 'system', value, is_there)
      if (is_there .and. lower_case(value) /= 'r') call input%refuse( &
         'nodes in other than rectangular coordinates', input%position - 1)
      call get_set(raw, input, scope, line, 'nset', group)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         place = input%position
         call input%take_integer(tag, 'the number of a node')
         call take_coordinates(input, x)
         if (allocated(input%error)) exit
         call raw%add_node(tag, place, x)
         if (group > 0) call raw%groups(group)%node%append(tag)
      end do
   end subroutine read_nodes

   !> Takes the coordinates of a node; more numbers, as the normals of shells, are skipped.
   pure subroutine take_coordinates(input, x)
      type(input_file_t), intent(inout) :: input !! the file
      real(dp), intent(out) :: x(3) !! the coordinates [L]
      integer, parameter :: most_numbers = 6
      integer :: i
      real(dp) :: numbers(most_numbers)
      logical :: is_there

      numbers = 0.0_dp
      do i = 1, most_numbers
         call take_comma(input, is_there)
         if (.not. is_there) exit
         if (is_at_line_end(input)) exit
         if (input%text(input%position:input%position) == ',') cycle
         call input%take_real(numbers(i), 'a coordinate')
      end do
      x = numbers(:3)
      call input%end_line()
   end subroutine take_coordinates

   !> Reads elements of one type.
   pure subroutine read_elements(raw, input, scope, line)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      type(abaqus_scope_t), intent(in) :: scope !! where the file is
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: value
      integer :: group, kind, place, tag
      logical :: is_there

      call find_parameter(line, 'input', value, is_there)
      if (is_there) call input%refuse('*ELEMENT with INPUT= is not read: write the elements out', input%position - 1)
      call find_parameter(line, 'type', value, is_there)
      call find_kind(input, value, kind)
      if (kind == line2 .or. kind == line3) call raw%add_note('elements of type '//value// &
         ' are taken for names of the boundary, not for bars')
      if (kind > 0 .and. len(value) > 4) call raw%add_note('elements of type '//value// &
         ' are taken for '//value(:4)//': compatible and fully integrated')
      call find_hypothesis(raw, input, value, kind)
      call get_set(raw, input, scope, line, 'elset', group)
      do
         call next_data_line(input, is_there)
         if (.not. is_there) exit
         place = input%position
         call input%take_integer(tag, 'the number of an element')
         call take_nodes(raw, input, kind, tag, place)
         if (allocated(input%error)) exit
         if (group == 0) cycle
         call raw%groups(group)%cell%append(tag)
         call raw%groups(group)%side%append(0)
      end do
   end subroutine read_elements

   !> Notes the hypothesis that elements of a type are of; lines are of none.
   pure subroutine find_hypothesis(raw, input, type, kind)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says; gains the hypothesis
      type(input_file_t), intent(inout) :: input !! the file, behind the keyword line
      character(*), intent(in) :: type !! name of the type
      integer, intent(in) :: kind !! kind of the elements
      character(12) :: before

      if (kind <= 0) return
      before = raw%hypothesis
      select case (lower_case(type(:3)))
      case ('cps')
         raw%hypothesis = 'plane stress'
      case ('cax')
         raw%hypothesis = 'axisymmetric'
      case default
         raw%hypothesis = 'plane strain'
      end select
      if (raw%model%is_used(use_materials) .and. before /= '' .and. before /= raw%hypothesis) call input%refuse( &
         'materials cannot be used: some elements are of type '//trim(before)//', others of '// &
         trim(raw%hypothesis), input%position - 1)
   end subroutine find_hypothesis

   !> Takes the nodes of an element; a comma at the end of a line continues it on the next one.
   pure subroutine take_nodes(raw, input, kind, tag, place)
      type(raw_mesh_t), intent(inout) :: raw !! what the file says
      type(input_file_t), intent(inout) :: input !! the file, behind the number of the element
      integer, intent(in) :: kind !! kind of the element
      integer, intent(in) :: tag !! its number
      integer, intent(in) :: place !! where the file gives it
      integer :: nodes(n_cell_nodes(kind)), i
      logical :: is_there

      do i = 1, size(nodes)
         call take_comma(input, is_there)
         if (.not. is_there) call input%refuse('expected a comma and a node of an element, found '//input%word())
         if (is_at_line_end(input)) call next_data_line(input, is_there)
         call input%take_integer(nodes(i), 'a node of an element')
      end do
      call take_comma(input, is_there)
      call input%end_line()
      if (allocated(input%error)) return
      ! A line over three nodes is given from end to end here.
      if (kind == line3) nodes = nodes([1, 3, 2])
      call raw%add_cell(kind, tag, place, nodes)
   end subroutine take_nodes

   !> Finds the kind of elements of a type.
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
         call input%refuse('3-D mesh: found elements of type '//type//', expected plane elements', input%position - 1)
      else
         call input%refuse("elements of type '"//type//"' are not supported: expected CPE3, CPE4, CPE6, CPE8 or "// &
            'the same of CPS and CAX', input%position - 1)
      end if
   end subroutine find_kind

   !> Adds a keyword.
   pure subroutine ignored_keywords_add(self, keyword, line)
      class(ignored_keywords_t), intent(inout) :: self !! the keywords
      character(*), intent(in) :: keyword !! the keyword in small letters, without blanks
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: name
      integer :: last

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
      name = ', *'//capitals(printable(trim(line(:min(longest_name, last)))))
      self%names = self%names//name
      self%is_readable(use_materials) = self%is_readable(use_materials) .or. any(material_keywords == keyword)
      self%is_readable(use_supports) = self%is_readable(use_supports) .or. any(support_keywords == keyword)
      self%is_readable(use_loads) = self%is_readable(use_loads) .or. any(load_keywords == keyword)
      if (any(material_keywords == keyword) .or. any(support_keywords == keyword) .or. any(load_keywords == keyword) &
         .or. any(other_keywords == keyword)) self%warned = self%warned//name
   end subroutine ignored_keywords_add

   !> Adds a note on what is ignored to a raw mesh, and a warning on what matters.
   pure subroutine ignored_keywords_tell(self, raw)
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
   end subroutine ignored_keywords_tell

   !> A text with capital letters in the place of small ones.
   pure function capitals(text) result(upper)
      character(*), intent(in) :: text !! the text
      character(len(text)) :: upper
      integer :: i

      upper = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') upper(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function capitals

end module amontons_abaqus
