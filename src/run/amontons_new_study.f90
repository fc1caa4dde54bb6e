!> The choice of the kind of study for a deck.
module amontons_new_study
   use amontons_config, only: config_t
   use amontons_history_study, only: history_study_t
   use amontons_reduced_study, only: reduced_study_t
   use amontons_single_study, only: single_study_t
   use amontons_study, only: study_t
   use amontons_sweep_study, only: sweep_study_t
   implicit none (type, external)
   private

   public :: new_study

contains

   !> Makes the study that a deck describes.
   subroutine new_study(study, config)
      class(study_t), allocatable, intent(out) :: study !! the study
      type(config_t), intent(in) :: config !! the deck

      if (config%reduced%is_given) then
         allocate (reduced_study_t :: study)
      else if (config%history%is_given) then
         allocate (history_study_t :: study)
      else if (config%sweep%is_given()) then
         allocate (sweep_study_t :: study)
      else
         allocate (single_study_t :: study)
      end if
      study%config = config
   end subroutine new_study

end module amontons_new_study
