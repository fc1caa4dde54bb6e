!> The names of sets and regions in a deck, held against the mesh all at once.
module amontons_name_check
   use amontons_config, only: config_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_mesh, only: mesh_t
   use amontons_text, only: newline
   implicit none (type, external)
   private

   public :: check_names

contains

   !> Refuses the names of a case that its mesh has not, all of them in one error.
   subroutine check_names(config, mesh, error)
      type(config_t), intent(in) :: config !! the case
      type(mesh_t), intent(in) :: mesh !! its mesh
      type(error_t), allocatable, intent(out) :: error !! the names that are unknown, a line of text for each
      integer :: i

      do i = 1, size(config%materials)
         call check_region(config%materials(i)%origin, config%materials(i)%region, mesh, error)
      end do
      do i = 1, size(config%supports)
         call check_set(config%supports(i)%origin, config%supports(i)%set, mesh, error)
      end do
      do i = 1, size(config%loads)
         call check_set(config%loads(i)%origin, config%loads(i)%set, mesh, error)
         call check_region(config%loads(i)%origin, config%loads(i)%region, mesh, error)
      end do
      do i = 1, size(config%contacts)
         call check_set(config%contacts(i)%origin, config%contacts(i)%set, mesh, error)
         call check_set(config%contacts(i)%origin, config%contacts(i)%pairing%against, mesh, error)
      end do
      do i = 1, size(config%ties)
         call check_set(config%ties(i)%origin, config%ties(i)%set, mesh, error)
         call check_set(config%ties(i)%origin, config%ties(i)%to, mesh, error)
      end do
   end subroutine check_names

   !> Notes a set that is unknown.
   subroutine check_set(origin, name, mesh, error)
      character(*), intent(in) :: origin !! where the name stands, as messages begin
      character(*), intent(in) :: name !! name of the set; empty for none
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(error_t), allocatable, intent(inout) :: error !! the names that are unknown
      type(error_t), allocatable :: fault
      integer, allocatable :: sides(:, :)

      if (len(name) == 0) return
      if (mesh%find_set(name) > 0 .or. mesh%find_node_set(name) > 0) return
      call mesh%set_sides(name, sides, fault)
      call note(origin, fault, error)
   end subroutine check_set

   !> Notes a region that is unknown.
   subroutine check_region(origin, name, mesh, error)
      character(*), intent(in) :: origin !! where the name stands, as messages begin
      character(*), intent(in) :: name !! name of the region; empty for the whole body
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(error_t), allocatable, intent(inout) :: error !! the names that are unknown
      type(error_t), allocatable :: fault
      integer, allocatable :: elements(:)

      if (len(name) == 0) return
      if (mesh%find_region(name) > 0) return
      call mesh%region_elements(name, elements, fault)
      call note(origin, fault, error)
   end subroutine check_region

   !> Puts a fault behind those before it.
   subroutine note(origin, fault, error)
      character(*), intent(in) :: origin !! where it stands
      type(error_t), allocatable, intent(in) :: fault !! the fault
      type(error_t), allocatable, intent(inout) :: error !! the faults

      if (allocated(error)) then
         error%message = error%message//newline//origin//fault%message
      else
         call new_error(error, input_refused, origin//fault%message)
      end if
   end subroutine note

end module amontons_name_check
