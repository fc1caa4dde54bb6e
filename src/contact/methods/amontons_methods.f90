!> The table of contact methods and of the words of their options, and the choice of one by its name.
module amontons_methods
   use amontons_acceleration, only: acceleration_names
   use amontons_auto, only: auto_t
   use amontons_box_program, only: box_names
   use amontons_contact_method, only: contact_method_t, method_options_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_extragradient, only: extragradient_t
   use amontons_fixed_point, only: fixed_point_t
   use amontons_lemke, only: lemke_t
   use amontons_newton, only: newton_t
   use amontons_psor, only: local_names, psor_t, space_names
   use amontons_splitting, only: splitting_t, variant_names
   implicit none (type, external)
   private

   public :: acceleration_names, box_names, local_names, method_names, method_options_t, new_contact_method, &
      space_names, variant_names

   !> Names of the methods, as a deck writes them.
   character(13), parameter :: method_names(*) = [character(13) :: 'auto', 'newton', 'splitting', 'fixed_point', &
      'psor', 'extragradient', 'lemke']

contains

   !> Makes the method of a name.
   subroutine new_contact_method(method, options, error)
      class(contact_method_t), allocatable, intent(out) :: method !! the method
      type(method_options_t), intent(in) :: options !! which one, and its options
      type(error_t), allocatable, intent(out) :: error !! there is no such method

      select case (options%method)
      case ('auto')
         allocate (auto_t :: method)
      case ('newton')
         allocate (newton_t :: method)
      case ('splitting')
         allocate (splitting_t :: method)
      case ('fixed_point')
         allocate (fixed_point_t :: method)
      case ('psor')
         allocate (psor_t :: method)
      case ('extragradient')
         allocate (extragradient_t :: method)
      case ('lemke')
         allocate (lemke_t :: method)
      case default
         call new_error(error, input_refused, "unknown contact method '"//trim(options%method)//"'")
         return
      end select
      method%method_options_t = options
   end subroutine new_contact_method

end module amontons_methods
