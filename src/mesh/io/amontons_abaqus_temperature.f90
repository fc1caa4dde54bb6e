!> Temperatures of nodes in the input format of Abaqus and CalculiX: those at which nothing is strained, and those of
!> the step.
module amontons_abaqus_temperature
   use amontons_abaqus_line, only: find_parameter, next_data_line, refuse_parameters, take_fields, take_number
   use amontons_abaqus_sets, only: named_group
   use amontons_file_model, only: file_temperatures_t, longest_name, use_materials
   use amontons_input_file, only: input_file_t
   use amontons_kinds, only: dp
   use amontons_raw_mesh, only: raw_mesh_t
   use amontons_tag_map, only: new_tag_map
   use amontons_text, only: lower_case, read_integer, to_text
   implicit none (type, external)
   private

   public :: finish_temperatures, read_temperatures

   !> Most fields of a data line: the temperatures of a shell follow that of its first point.
   integer, parameter :: most_fields = 9

contains

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
      real(dp), allocatable :: zeros(:)
      logical, allocatable :: none(:)
      integer :: n

      n = 0
      if (allocated(temperatures%step)) n = size(temperatures%step)
      if (allocated(temperatures%step) .and. n == size(tags)) return
      allocate (zeros(size(tags) - n), source=0.0_dp)
      allocate (none(size(tags) - n), source=.false.)
      if (n == 0) then
         temperatures%initial = zeros
         temperatures%step = zeros
         temperatures%is_given = none
      else
         temperatures%initial = [temperatures%initial, zeros]
         temperatures%step = [temperatures%step, zeros]
         temperatures%is_given = [temperatures%is_given, none]
      end if
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

end module amontons_abaqus_temperature
