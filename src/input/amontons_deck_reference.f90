!> What a deck may hold: every group and every key, with its values, unit, default and meaning.
module amontons_deck_reference
   use amontons_config, only: config_t, describe_config, groups
   use amontons_deck_documenter, only: deck_documenter_t
   use amontons_deck_words, only: suggestion
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_text, only: lower_case
   implicit none (type, external)
   private

   public :: reference_text

contains

   !> The reference of a group as Markdown; of all groups where the name is empty.
   subroutine reference_text(name, text, error)
      character(*), intent(in) :: name !! name of the group, with or without `&`, in upper or lower case; or empty
      character(:), allocatable, intent(out) :: text !! the reference, its last line not ended
      type(error_t), allocatable, intent(out) :: error !! there is no such group
      type(deck_documenter_t) :: documenter
      type(config_t) :: config

      documenter%wanted = lower_case(name)
      if (index(documenter%wanted, '&') == 1) documenter%wanted = documenter%wanted(2:)
      documenter%written = ''
      config%file = ''
      allocate (config%materials(1), config%supports(1), config%loads(1), config%contacts(1), config%sweep%axes(1))
      call describe_config(documenter, config)
      text = documenter%written
      if (len(text) == 0) call new_error(error, input_refused, 'unknown group &'//documenter%wanted// &
         suggestion(documenter%wanted, groups%name, '&', 'groups'))
   end subroutine reference_text

end module amontons_deck_reference
