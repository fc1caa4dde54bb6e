!> Materials in the input format of Abaqus and CalculiX, the sections that put them into sets of elements, and the
!> temperatures of nodes: those at which nothing is strained, and those of the step.
module amontons_abaqus_material
   use amontons_abaqus_line, only: find_parameter, next_data_line, refuse_parameters, take_fields, take_number
   use amontons_abaqus_sets, only: named_group
   use amontons_file_model, only: file_material_t, file_temperatures_t, longest_name, use_materials
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: new_tag_map
   use amontons_kinds, only: dp
   use amontons_raw_mesh, only: raw_mesh_t
   use amontons_text, only: counted, lower_case, read_integer, to_text
   implicit none (type, external)
   private

   public :: finish_materials, finish_temperatures, read_material_keyword, read_temperatures

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

end module amontons_abaqus_material
