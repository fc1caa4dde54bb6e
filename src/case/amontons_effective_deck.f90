!> The effective deck: a configuration written out as a deck, every default in place. Reading it again gives the same
!> case.
module amontons_effective_deck
   use amontons_cell_partition, only: cell_partition_t, multiplier_names
   use amontons_config, only: config_t
   use amontons_constraints, only: support_t, supported_components
   use amontons_contact_zone, only: contact_t
   use amontons_kinds, only: dp
   use amontons_line_field, only: line_field_t
   use amontons_loads, only: load_on_nodes, load_on_sides, load_t
   use amontons_material, only: material_t
   use amontons_sweep, only: quantity_names, swept_load
   use amontons_text, only: newline, quoted, to_text
   implicit none (type, external)
   private

   public :: body_text, effective_deck

contains

   !> The whole deck.
   pure function effective_deck(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text
      integer :: i

      text = '&case name = '//quoted(config%name)//'  title = '//quoted(config%title)//' /'//newline
      if (config%reduced%is_given) then
         text = text//problem_text(config)//solver_text(config)//output_text(config)
         return
      end if
      text = text//model_text(config)
      do i = 1, size(config%loads)
         text = text//load_text(config%loads(i))
      end do
      do i = 1, size(config%contacts)
         text = text//contact_text(config%contacts(i))
      end do
      if (config%sweep%is_given()) then
         do i = 1, size(config%sweep%axes)
            text = text//sweep_text(config, i)
         end do
      end if
      text = text//solver_text(config)//output_text(config)
   end function effective_deck

   !> The part of the deck that a factorisation depends on: two cases whose texts agree can share it.
   pure function body_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text
      integer :: i

      text = model_text(config)//config%factorization//' '//config%condensation
      do i = 1, size(config%contacts)
         text = text//quoted(config%contacts(i)%set)//pair(config%contacts(i)%direction) &
            //multipliers_text(config%contacts(i)%partition)
      end do
   end function body_text

   !> Mesh, materials and supports.
   pure function model_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text
      integer :: i

      text = mesh_text(config)
      do i = 1, size(config%materials)
         text = text//material_text(config%materials(i))
      end do
      do i = 1, size(config%supports)
         text = text//support_text(config%supports(i))
      end do
   end function model_text

   !> `&problem`.
   pure function problem_text(config) result(text)
      type(config_t), intent(in) :: config !! the case, of a reduced problem
      character(:), allocatable :: text

      text = "&problem kind = 'reduced'  file = "//quoted(config%reduced%path)
      if (config%reduced%has_friction) text = text//'  friction = '//to_text(config%reduced%friction)
      text = text//' /'//newline
   end function problem_text

   !> `&mesh`.
   pure function mesh_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      if (len(config%mesh_file) > 0) then
         text = "&mesh kind = 'file'  file = "//quoted(config%mesh_file)//' /'//newline
         return
      end if
      associate (r => config%rectangle)
         text = "&mesh kind = 'rectangle'  size = "//pair(r%size)//'  cells = '//to_text(r%cells(1))//', ' &
            //to_text(r%cells(2))//'  element = '//quoted(r%element)//'  diagonal = '//quoted(r%diagonal) &
            //'  grading = '//to_text(r%grading)//' /'//newline
      end associate
   end function mesh_text

   !> One `&material`.
   pure function material_text(material) result(text)
      type(material_t), intent(in) :: material !! the material
      character(:), allocatable :: text

      text = '&material young = '//to_text(material%young)//'  poisson = '//to_text(material%poisson) &
         //'  hypothesis = '//quoted(material%hypothesis)//'  thickness = '//to_text(material%thickness)
      if (len(material%region) > 0) text = text//'  region = '//quoted(material%region)
      text = text//' /'//newline
   end function material_text

   !> One `&support`.
   pure function support_text(support) result(text)
      type(support_t), intent(in) :: support !! the support
      character(:), allocatable :: text
      integer :: k

      if (len(support%set) > 0) then
         text = '&support set = '//quoted(support%set)
      else
         text = '&support point = '//pair(support%point)
      end if
      do k = 1, size(supported_components)
         if (support%is_held(k)) text = text//'  '//supported_components(k)//' = '//to_text(support%displacement(k))
      end do
      if (any(support%spring > 0.0_dp)) text = text//'  spring_n = '//to_text(support%spring(1))//'  spring_t = ' &
         //to_text(support%spring(2))
      text = text//' /'//newline
   end function support_text

   !> One `&load`.
   pure function load_text(load) result(text)
      type(load_t), intent(in) :: load !! the load
      character(:), allocatable :: text

      text = '&load'
      if (len(load%name) > 0) text = text//' name = '//quoted(load%name)
      if (len(load%set) > 0) text = text//' set = '//quoted(load%set)
      if (len(load%region) > 0) text = text//' region = '//quoted(load%region)
      select case (load%target)
      case (load_on_sides)
         text = text//'  traction = '//pair(load%traction)//'  traction_slope = '//pair(load%traction_slope(:, 1)) &
            //', '//pair(load%traction_slope(:, 2))//'  pressure = '//to_text(load%pressure) &
            //'  pressure_slope = '//pair(load%pressure_slope)
      case (load_on_nodes)
         if (len(load%set) == 0) text = text//' point = '//pair(load%point)
         text = text//'  force = '//pair(load%force)
      case default
         text = text//'  body_force = '//pair(load%body_force)
      end select
      text = text//' /'//newline
   end function load_text

   !> One `&contact`.
   pure function contact_text(contact) result(text)
      type(contact_t), intent(in) :: contact !! the contact set
      character(:), allocatable :: text

      associate (obstacle => contact%obstacle)
         text = '&contact set = '//quoted(contact%set)//field_text('friction', contact%friction) &
            //field_text('slip_bound', contact%slip_bound)//newline//'   obstacle = '//quoted(obstacle%kind) &
            //'  point = '//pair(obstacle%point)//'  normal = '//pair(obstacle%normal)
         if (obstacle%has_radius()) text = text//'  radius = '//to_text(obstacle%radius)
         if (obstacle%kind == 'polyline') text = text//'  line = '//quoted(obstacle%file)
         text = text//'  extra_gap = '//to_text(contact%extra_gap)
         if (any(abs(contact%direction) > 0.0_dp)) text = text//'  gap_direction = '//pair(contact%direction)
         text = text//newline//'   '//multipliers_text(contact%partition)
      end associate
      text = text//' /'//newline
   end function contact_text

   !> The keys of the multipliers of a contact set.
   pure function multipliers_text(partition) result(text)
      type(cell_partition_t), intent(in) :: partition !! the multipliers
      character(:), allocatable :: text

      text = 'multipliers = '//quoted(trim(merge(multiplier_names(2), multiplier_names(1), partition%is_constant)))
      if (partition%n_cells > 0) text = text//'  cells = '//to_text(partition%n_cells)
      if (allocated(partition%ends)) then
         text = text//'  cell_ends = '
         call append_list(text, partition%ends)
      end if
   end function multipliers_text

   !> The keys of a quantity along a contact line.
   pure function field_text(key, field) result(text)
      character(*), intent(in) :: key !! the key of its constant part
      type(line_field_t), intent(in) :: field !! the quantity
      character(:), allocatable :: text

      text = '  '//key//' = '//to_text(field%value)//'  '//key//'_slope = '//pair(field%slope)
      if (allocated(field%table)) text = text//'  '//key//'_table = '//quoted(field%file)
   end function field_text

   !> One `&sweep`.
   pure function sweep_text(config, i) result(text)
      type(config_t), intent(in) :: config !! the case
      integer, intent(in) :: i !! which quantity
      character(:), allocatable :: text

      associate (axis => config%sweep%axes(i))
         text = '&sweep combine = '//quoted(trim(merge('paired ', 'product', axis%is_paired)))
         if (len(axis%name) > 0) text = text//'  '//trim(merge('load   ', 'contact', axis%target == swept_load))// &
            ' = '//quoted(axis%name)
         text = text//'  '//trim(quantity_names(axis%target))//' = '
         if (axis%is_range) then
            text = text//pair(axis%values([1, size(axis%values)]))//'  count = '//to_text(size(axis%values))
         else
            call append_list(text, axis%values)
         end if
      end associate
      text = text//' /'//newline
   end function sweep_text

   !> Appends numbers separated by commas, about ten on a line. Halves are joined, since a text that grows value by
   !> value would be copied as often as there are values; and by a subroutine, since gfortran 12 forgets the length of a
   !> text that a function returns when the function calls itself.
   pure recursive subroutine append_list(text, values)
      character(:), allocatable, intent(inout) :: text !! the text
      real(dp), intent(in) :: values(:) !! the numbers, one at the least
      integer, parameter :: values_per_line = 10
      character(:), allocatable :: rest
      integer :: half

      half = size(values)/2
      if (half == 0) then
         text = text//to_text(values(1))
         return
      end if
      rest = ', '
      if (size(values) > values_per_line) rest = ','//newline//'   '
      call append_list(rest, values(half + 1:))
      call append_list(text, values(:half))
      text = text//rest
   end subroutine append_list

   !> `&solver`.
   pure function solver_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      associate (m => config%method)
         text = '&solver method = '//quoted(m%method)//'  variant = '//quoted(m%variant)//'  space = ' &
            //quoted(m%space)//'  omega = '//to_text(m%omega)//newline//'   box = '//quoted(m%box)//'  local = ' &
            //quoted(m%local)//'  acceleration = '//quoted(m%acceleration)//newline &
            //'   tolerance = '//to_text(m%tolerance)//'  max_iterations = '//to_text(m%max_iterations) &
            //newline//'   factorization = '//quoted(config%factorization) &
            //'  condensation = '//quoted(config%condensation)//' /'//newline
      end associate
   end function solver_text

   !> `&output`.
   pure function output_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      text = '&output'
      if (config%sweep%fields_every > 0) text = text//' fields_every = '//to_text(config%sweep%fields_every)
      text = text//' /'//newline
   end function output_text

   !> Two numbers separated by a comma.
   pure function pair(values) result(text)
      real(dp), intent(in) :: values(2) !! the numbers
      character(:), allocatable :: text

      text = to_text(values(1))//', '//to_text(values(2))
   end function pair

end module amontons_effective_deck
