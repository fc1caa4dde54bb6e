!> What a mesh file says of the body beside its mesh: materials, supports, loads.
module amontons_file_model
   use amontons_integer_list, only: tag_map_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: file_load_t, file_material_t, file_model_t, file_support_t, file_temperatures_t, longest_name

   !> What may be read of it, as a deck names it.
   character(9), parameter, public :: use_names(3) = [character(9) :: 'materials', 'supports', 'loads']
   !> Which of these are the materials.
   integer, parameter, public :: use_materials = 1
   !> Which of these are the supports.
   integer, parameter, public :: use_supports = 2
   !> Which of these are the loads.
   integer, parameter, public :: use_loads = 3

   !> Kind of a load: pressure on sides.
   integer, parameter, public :: file_pressure = 1
   !> Kind of a load: force on nodes.
   integer, parameter, public :: file_force = 2
   !> Kind of a load: force per volume.
   integer, parameter, public :: file_body_force = 3
   !> Kind of a load: weight.
   integer, parameter, public :: file_gravity = 4
   !> Kind of a load: centrifugal force.
   integer, parameter, public :: file_rotation = 5

   !> Longest name of a set or material, as Abaqus has it.
   integer, parameter :: longest_name = 80

   !> A material of a region.
   type :: file_material_t
      character(longest_name) :: name = '' !! its name
      character(longest_name) :: region = '' !! region that it fills; empty before a section says it
      real(dp) :: young = 0.0_dp !! Young's modulus; 0 if it is not given [F/L^2]
      real(dp) :: poisson = 0.0_dp !! Poisson's ratio [-]
      real(dp) :: density = 0.0_dp !! mass per volume [M/L^3]
      real(dp) :: expansion = 0.0_dp !! coefficient of thermal expansion [1/K]
      real(dp) :: thickness = 1.0_dp !! thickness of the region [L]
      integer :: line = 0 !! line of the file that specifies it
   end type file_material_t

   !> Displacements that are prescribed to a set of nodes.
   type :: file_support_t
      character(longest_name) :: set = '' !! name of the set
      logical :: is_held(2) = .false. !! whether it is held along x and y
      real(dp) :: value = 0.0_dp !! displacement along these [L]
      integer :: line = 0 !! line of the file that specifies it
   end type file_support_t

   !> A load.
   type :: file_load_t
      integer :: kind = file_pressure !! its kind
      character(longest_name) :: set = '' !! the set of sides or nodes, or the region; empty for the whole body
      real(dp) :: value(2) = 0.0_dp
         !! pressure [F/L^2], force [F], force per volume [F/L^3], acceleration [L/T^2], or angular speed [1/T]
      real(dp) :: center(2) = 0.0_dp !! a point of the axis of rotation [L]
      real(dp) :: axis(2) = 0.0_dp !! its direction in the plane; 0, 0 if it is normal to the plane [-]
      integer :: line = 0 !! line of the file that specifies it
   end type file_load_t

   !> Temperatures of the nodes. Arrays have a place for each node of the file, in its order, as far as it is read.
   type :: file_temperatures_t
      type(tag_map_t) :: map !! places of the nodes by their numbers in the file
      real(dp), allocatable :: initial(:) !! temperatures at which nothing is strained [K]
      real(dp), allocatable :: step(:) !! temperatures of the step [K]
      logical, allocatable :: is_given(:) !! whether the step gives a temperature
      logical :: has_initial = .false. !! whether initial temperatures are given
      integer :: line = 0 !! line of the file that gives those of the step; 0 if none does
      real(dp), allocatable :: table(:, :)
         !! numbers of the nodes and their temperatures above the initial ones; not allocated before the file is read,
         !! nor if it gives none (2, number of nodes) [K]
   end type file_temperatures_t

   !> All that is read beside the mesh.
   type :: file_model_t
      logical :: is_used(size(use_names)) = .false. !! what is read
      character(12) :: hypothesis = '' !! the hypothesis of the elements; empty if they differ or say none
      type(file_material_t), allocatable :: definitions(:) !! the materials that the file defines
      type(file_material_t), allocatable :: materials(:) !! the material of each section
      type(file_support_t), allocatable :: supports(:) !! the supports
      type(file_load_t), allocatable :: loads(:) !! the loads
      type(file_temperatures_t) :: temperatures !! the temperatures of the nodes
      integer :: n_supports = 0 !! number of supports; there may be room for more
      integer :: n_loads = 0 !! number of loads; there may be room for more
      integer :: n_steps = 0 !! number of steps
      integer, private :: n_counted = 0 !! number of characters of the file whose lines are counted
      integer, private :: n_lines = 0 !! number of line ends among them
   contains
      procedure :: line_at => file_model_line_at
      procedure :: add_load => file_model_add_load
      procedure :: add_support => file_model_add_support
   end type file_model_t

contains

   !> Number of the line of a place in the file. Places must not descend.
   pure subroutine file_model_line_at(self, text, place, line)
      class(file_model_t), intent(inout) :: self !! the model, which remembers how far lines are counted
      character(*), intent(in) :: text !! the whole file
      integer, intent(in) :: place !! the place
      integer, intent(out) :: line !! number of its line
      integer :: i

      do i = self%n_counted + 1, place - 1
         if (text(i:i) == achar(10)) self%n_lines = self%n_lines + 1
      end do
      self%n_counted = max(self%n_counted, place - 1)
      line = self%n_lines + 1
   end subroutine file_model_line_at

   !> Adds a support.
   pure subroutine file_model_add_support(self, support)
      class(file_model_t), intent(inout) :: self !! the model
      type(file_support_t), intent(in) :: support !! the support

      if (.not. allocated(self%supports)) allocate (self%supports(4))
      if (self%n_supports == size(self%supports)) self%supports = [self%supports, self%supports]
      self%n_supports = self%n_supports + 1
      self%supports(self%n_supports) = support
   end subroutine file_model_add_support

   !> Adds a load.
   pure subroutine file_model_add_load(self, load)
      class(file_model_t), intent(inout) :: self !! the model
      type(file_load_t), intent(in) :: load !! the load

      if (.not. allocated(self%loads)) allocate (self%loads(4))
      if (self%n_loads == size(self%loads)) self%loads = [self%loads, self%loads]
      self%n_loads = self%n_loads + 1
      self%loads(self%n_loads) = load
   end subroutine file_model_add_load

end module amontons_file_model
