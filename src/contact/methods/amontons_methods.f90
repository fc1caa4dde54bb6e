!> The table of contact methods and of the words of their options, and the choice of one by its name.
module amontons_methods
   use amontons_acceleration, only: acceleration_names
   use amontons_auto, only: auto_t
   use amontons_box_program, only: box_names
   use amontons_contact_method, only: contact_method_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_extragradient, only: extragradient_t
   use amontons_fixed_point, only: fixed_point_t
   use amontons_kinds, only: dp
   use amontons_lemke, only: lemke_t
   use amontons_newton, only: newton_t
   use amontons_psor, only: psor_t, space_names
   use amontons_relaxation, only: local_names
   use amontons_splitting, only: splitting_t, variant_names
   implicit none (type, external)
   private

   public :: acceleration_names, box_names, local_names, method_names, method_options_t, new_contact_method, &
      set_defaults, space_names, variant_names

   !> Names of the methods, as a deck writes them.
   character(13), parameter :: method_names(*) = [character(13) :: 'auto', 'newton', 'splitting', 'fixed_point', &
      'psor', 'extragradient', 'lemke']

   !> The choice of a method and its options; those that a method does not use are without effect on it.
   type :: method_options_t
      character(:), allocatable :: method !! one of `method_names`; not allocated means 'auto'
      character(:), allocatable :: variant !! of splitting: see `amontons_splitting`; not allocated means 'exact'
      character(:), allocatable :: space !! of psor: see `amontons_psor`; not allocated means 'dual'
      character(:), allocatable :: box
         !! of splitting and fixed_point: the solver of quadratic programs, see `amontons_box_program`; not allocated
         !! means 'auto'
      character(:), allocatable :: local
         !! of psor: how a point is treated, see `amontons_relaxation`; not allocated means 'point'
      character(:), allocatable :: acceleration !! of psor: see `amontons_acceleration`; not allocated means 'none'
      real(dp) :: omega = 1.0_dp !! of psor: relaxation, above 0 and below 2 [-]
      real(dp) :: tolerance = 1.0e-10_dp !! residual that counts as solved [-]
      integer :: max_iterations = 1000 !! most iterations
   end type method_options_t

contains

   !> Gives the options that are not allocated their defaults.
   subroutine set_defaults(options)
      type(method_options_t), intent(inout) :: options !! the options

      call set_default(options%method, method_names(1))
      call set_default(options%variant, variant_names(1))
      call set_default(options%space, space_names(1))
      call set_default(options%box, box_names(1))
      call set_default(options%local, local_names(1))
      call set_default(options%acceleration, acceleration_names(1))
   end subroutine set_defaults

   !> Makes the method of a name.
   subroutine new_contact_method(method, options, error)
      class(contact_method_t), allocatable, intent(out) :: method !! the method
      type(method_options_t), intent(in) :: options !! which one, and its options
      type(error_t), allocatable, intent(out) :: error !! there is no such method
      type(method_options_t) :: chosen

      chosen = options
      call set_defaults(chosen)
      select case (chosen%method)
      case ('auto')
         allocate (auto_t :: method)
      case ('newton')
         allocate (newton_t :: method)
      case ('splitting')
         method = splitting_t(variant=chosen%variant, box=chosen%box)
      case ('fixed_point')
         method = fixed_point_t(box=chosen%box)
      case ('psor')
         method = psor_t(omega=chosen%omega, space=chosen%space, local=chosen%local, acceleration=chosen%acceleration)
      case ('extragradient')
         allocate (extragradient_t :: method)
      case ('lemke')
         allocate (lemke_t :: method)
      case default
         call new_error(error, input_refused, "unknown contact method '"//chosen%method//"'")
         return
      end select
      method%tolerance = chosen%tolerance
      method%max_iterations = chosen%max_iterations
   end subroutine new_contact_method

   !> Gives an option that is not set its default.
   pure subroutine set_default(option, default)
      character(:), allocatable, intent(inout) :: option !! the option
      character(*), intent(in) :: default !! its default

      if (.not. allocated(option)) option = trim(default)
   end subroutine set_default

end module amontons_methods
