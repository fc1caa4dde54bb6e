!> The names of sets and regions in a deck, held against the mesh all at once.
module amontons_name_check
   use amontons_config, only: config_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_fault_list, only: fault_list_t
   use amontons_loads, only: load_on_nodes, load_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: check_names

contains

   !> Refuses the names of a case that its mesh has not, all of them in one error.
   subroutine check_names(config, mesh, error)
      type(config_t), intent(in) :: config !! the case
      type(mesh_t), intent(in) :: mesh !! its mesh
      type(error_t), allocatable, intent(out) :: error !! the names that are unknown, a line of text for each
      type(fault_list_t) :: faults
      integer :: i

      do i = 1, size(config%materials)
         call check_region(config%materials(i)%origin, config%materials(i)%region, mesh, faults)
      end do
      do i = 1, size(config%supports)
         call check_set(config%supports(i)%origin, config%supports(i)%set, mesh, faults)
      end do
      do i = 1, size(config%loads)
         call check_set(config%loads(i)%origin, config%loads(i)%set, mesh, faults)
         call check_region(config%loads(i)%origin, config%loads(i)%region, mesh, faults)
         if (config%accuracy%n_refinements > 0) call check_point_forces(config%loads(i), mesh, faults)
      end do
      do i = 1, size(config%contacts)
         call check_set(config%contacts(i)%origin, config%contacts(i)%set, mesh, faults)
         call check_set(config%contacts(i)%origin, config%contacts(i)%pairing%against, mesh, faults)
      end do
      do i = 1, size(config%ties)
         call check_set(config%ties(i)%origin, config%ties(i)%set, mesh, faults)
         call check_set(config%ties(i)%origin, config%ties(i)%to, mesh, faults)
      end do
      if (faults%n > 0) call new_error(error, input_refused, faults%text())
   end subroutine check_names

   !> Records a set that is unknown.
   subroutine check_set(origin, name, mesh, faults)
      character(*), intent(in) :: origin !! where the name stands, as messages begin
      character(*), intent(in) :: name !! name of the set; empty for none
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(fault_list_t), intent(inout) :: faults !! gains a name that is unknown
      type(error_t), allocatable :: fault
      integer, allocatable :: sides(:, :)

      if (len(name) == 0) return
      if (mesh%find_set(name) > 0 .or. mesh%find_node_set(name) > 0) return
      call mesh%set_sides(name, sides, fault)
      if (allocated(fault)) call faults%add(0, origin//fault%message)
   end subroutine check_set

   !> Records a region that is unknown.
   subroutine check_region(origin, name, mesh, faults)
      character(*), intent(in) :: origin !! where the name stands, as messages begin
      character(*), intent(in) :: name !! name of the region; empty for the whole body
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(fault_list_t), intent(inout) :: faults !! gains a name that is unknown
      type(error_t), allocatable :: fault
      integer, allocatable :: elements(:)

      if (len(name) == 0) return
      if (mesh%find_region(name) > 0) return
      call mesh%region_elements(name, elements, fault)
      if (allocated(fault)) call faults%add(0, origin//fault%message)
   end subroutine check_region

   !> Records a force on every node of a boundary set, which would grow with the number of nodes from mesh to mesh.
   subroutine check_point_forces(load, mesh, faults)
      type(load_t), intent(in) :: load !! the load
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(fault_list_t), intent(inout) :: faults !! gains one if so

      if (load%target /= load_on_nodes .or. len(load%set) == 0) return
      if (mesh%find_set(load%set) == 0 .or. mesh%find_node_set(load%set) > 0) return
      call faults%add(0, load%origin//"refinements: the force on every node of '"//load%set// &
         "' would grow with the number of nodes; give a traction")
   end subroutine check_point_forces

end module amontons_name_check
