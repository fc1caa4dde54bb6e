!> The strain of free thermal expansion that temperatures among the loads of a body cause.
module amontons_thermal_strain
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_loads, only: load_by_temperature, load_t
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_tag_map, only: new_tag_map, tag_map_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: sum_thermal_strain

contains

   !> Thermal strain of all loads together. It is kept by element, since loads and materials may differ from one to the
   !> next.
   subroutine sum_thermal_strain(strain, mesh, materials, loads, error)
      real(dp), allocatable, intent(out) :: strain(:)
         !! expansion coefficient times temperature at the nodes of each element, in the order of `mesh%node`; not
         !! allocated if no load is a temperature [-]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, with their coefficients
      type(load_t), intent(in) :: loads(:) !! the loads
      type(error_t), allocatable, intent(out) :: error
         !! a load names a region that the mesh has not, or gives no temperature for a node
      integer :: i

      if (.not. any(loads%target == load_by_temperature)) return
      allocate (strain(size(mesh%node)), source=0.0_dp)
      do i = 1, size(loads)
         if (loads(i)%target /= load_by_temperature) cycle
         call add_thermal_strain(strain, mesh, materials, loads(i), error)
         if (.not. allocated(error)) cycle
         error%message = loads(i)%origin//error%message
         return
      end do
   end subroutine sum_thermal_strain

   !> Adds the thermal strain of one load.
   subroutine add_thermal_strain(strain, mesh, materials, load, error)
      real(dp), intent(inout) :: strain(:) !! thermal strain at the nodes of each element [-]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials
      type(load_t), intent(in) :: load !! the load
      type(error_t), allocatable, intent(out) :: error !! no such region, or a node without a temperature
      integer, allocatable :: elements(:)
      real(dp), allocatable :: at_nodes(:)
      integer :: first, last, i

      call mesh%region_elements(load%region, elements, error)
      if (.not. allocated(error)) call find_temperatures(at_nodes, mesh, load, elements, error)
      if (allocated(error)) return
      do i = 1, size(elements)
         first = mesh%node_start(elements(i))
         last = mesh%node_start(elements(i) + 1) - 1
         associate (material => materials%list(materials%of_element(elements(i))))
            strain(first:last) = strain(first:last) + material%expansion*at_nodes(mesh%node(first:last))
         end associate
      end do
   end subroutine add_thermal_strain

   !> Temperatures of a load at the nodes of its elements; of its table where it has one. A node of refinement that the
   !> table has not takes the mean of the nodes that it comes from.
   subroutine find_temperatures(temperature, mesh, load, elements, error)
      real(dp), allocatable, intent(out) :: temperature(:) !! temperature of each node (n_nodes) [K]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(load_t), intent(in) :: load !! the load
      integer, intent(in) :: elements(:) !! the elements
      type(error_t), allocatable, intent(out) :: error !! the table lacks a node, or gives one twice
      type(tag_map_t) :: map
      integer, allocatable :: tags(:)
      logical :: is_met(mesh%n_nodes)
      integer :: i, node, row

      temperature = load%temperature + matmul(load%temperature_slope, mesh%coordinates)
      if (.not. allocated(load%temperature_table)) return
      tags = nint(load%temperature_table(1, :))
      call new_tag_map(map, tags)
      row = map%repeated()
      if (row > 0) call new_error(error, input_refused, load%temperature_file//': node '//to_text(tags(row))// &
         ' is given a second time')
      if (allocated(error)) return
      is_met = .false.
      do i = 1, size(elements)
         is_met(mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i) + 1) - 1)) = .true.
      end do
      do node = 1, mesh%n_nodes
         if (.not. is_met(node)) cycle
         row = map%find(tag_of(mesh, node))
         if (row > 0) then
            temperature(node) = load%temperature_table(2, row)
         else if (mesh%is_of_refinement(node)) then
            associate (first => mesh%parents%start(node), last => mesh%parents%start(node + 1) - 1)
               temperature(node) = dot_product(mesh%parents%weight(first:last), &
                  temperature(mesh%parents%node(first:last)))
            end associate
         else
            call new_error(error, input_refused, load%temperature_file//': no temperature of node '// &
               to_text(tag_of(mesh, node)))
            return
         end if
      end do
   end subroutine find_temperatures

   !> The number by which a table knows a node: that in the mesh's file.
   pure integer function tag_of(mesh, node) result(tag)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: node !! the node

      tag = node
      if (.not. allocated(mesh%node_tag)) return
      ! A refined mesh has nodes that its file has not.
      tag = 0
      if (node <= size(mesh%node_tag)) tag = mesh%node_tag(node)
   end function tag_of

end module amontons_thermal_strain
