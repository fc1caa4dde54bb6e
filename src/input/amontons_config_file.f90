!> Materials, supports and loads that a deck takes from its mesh file.
module amontons_config_file
   use amontons_constraints, only: support_t
   use amontons_error, only: error_t
   use amontons_file_model, only: file_body_force, file_force, file_gravity, file_load_t, file_model_t, file_pressure
   use amontons_kinds, only: dp
   use amontons_loads, only: load_by_temperature, load_on_nodes, load_on_region, load_t, new_load
   use amontons_material, only: material_t, new_material
   use amontons_mesh_file, only: mesh_part_t, read_file_model
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: take_file

   !> The name by which a sweep knows the loads of a mesh file.
   character(*), parameter :: file_load_name = 'mesh file'

contains

   !> Takes what a mesh file says besides the mesh.
   subroutine take_file(part, materials, supports, loads, error)
      type(mesh_part_t), intent(in) :: part !! the part of the mesh that names the file
      type(material_t), allocatable, intent(inout) :: materials(:) !! become those of the file
      type(support_t), allocatable, intent(inout) :: supports(:) !! become those of the file
      type(load_t), allocatable, intent(inout) :: loads(:) !! become those of the file
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file, and where
      type(file_model_t) :: model

      if (len(part%file) == 0) return
      call read_file_model(model, part%file, part%is_used, error)
      if (.not. allocated(error)) call take_file_materials(materials, model, part%file, error)
      if (allocated(error)) return
      call take_file_supports(supports, model, part%file)
      call take_file_loads(loads, model, part%file)
   end subroutine take_file

   !> Takes the materials.
   subroutine take_file_materials(materials, model, file, error)
      type(material_t), allocatable, intent(out) :: materials(:) !! the materials
      type(file_model_t), intent(in) :: model !! what the file says
      character(*), intent(in) :: file !! its name
      type(error_t), allocatable, intent(out) :: error !! a constant out of its range
      integer :: i, n

      n = 0
      if (allocated(model%materials)) n = size(model%materials)
      allocate (materials(n))
      do i = 1, n
         associate (material => model%materials(i))
            call new_material(materials(i), material%young, material%poisson, trim(model%hypothesis), &
               material%thickness, error)
            if (allocated(error)) error%message = origin_of(file, material%line)//error%message
            if (allocated(error)) return
            materials(i)%density = material%density
            materials(i)%expansion = material%expansion
            materials(i)%region = trim(material%region)
            materials(i)%origin = origin_of(file, material%line)
         end associate
      end do
   end subroutine take_file_materials

   !> Takes the supports.
   subroutine take_file_supports(supports, model, file)
      type(support_t), allocatable, intent(out) :: supports(:) !! the supports
      type(file_model_t), intent(in) :: model !! what the file says
      character(*), intent(in) :: file !! its name
      integer :: i

      allocate (supports(model%n_supports))
      do i = 1, size(supports)
         supports(i)%set = trim(model%supports(i)%set)
         supports(i)%is_held(:2) = model%supports(i)%is_held
         supports(i)%displacement(:2) = merge(model%supports(i)%value, 0.0_dp, model%supports(i)%is_held)
         supports(i)%origin = origin_of(file, model%supports(i)%line)
      end do
   end subroutine take_file_supports

   !> Takes the loads.
   subroutine take_file_loads(loads, model, file)
      type(load_t), allocatable, intent(out) :: loads(:) !! the loads
      type(file_model_t), intent(in) :: model !! what the file says
      character(*), intent(in) :: file !! its name
      integer :: i

      allocate (loads(model%n_loads + merge(1, 0, allocated(model%temperatures%table))))
      do i = 1, model%n_loads
         call take_load(loads(i), model%loads(i))
         loads(i)%name = file_load_name
         loads(i)%origin = origin_of(file, model%loads(i)%line)
      end do
      if (.not. allocated(model%temperatures%table)) return
      associate (load => loads(size(loads)))
         call new_load(load, '')
         load%name = file_load_name
         load%target = load_by_temperature
         load%temperature_table = model%temperatures%table
         load%temperature_file = file
         load%origin = origin_of(file, model%temperatures%line)
      end associate
   end subroutine take_file_loads

   !> Takes a load.
   pure subroutine take_load(load, given)
      type(load_t), intent(out) :: load !! the load
      type(file_load_t), intent(in) :: given !! the load as the file says it

      call new_load(load, trim(given%set))
      if (given%kind /= file_pressure .and. given%kind /= file_force) then
         load%set = ''
         load%region = trim(given%set)
         load%target = load_on_region
      end if
      select case (given%kind)
      case (file_pressure)
         load%pressure = given%value(1)
      case (file_force)
         load%target = load_on_nodes
         load%force = given%value
      case (file_body_force)
         load%body_force = given%value
      case (file_gravity)
         load%gravity = given%value
      case default
         load%angular_speed = given%value(1)
         load%center = given%center
         load%axis = given%axis
      end select
   end subroutine take_load

   !> Where something stands in the file, as messages begin.
   pure function origin_of(file, line) result(origin)
      character(*), intent(in) :: file !! name of the file
      integer, intent(in) :: line !! the line
      character(:), allocatable :: origin

      origin = file//':'//to_text(line)//': '
   end function origin_of

end module amontons_config_file
