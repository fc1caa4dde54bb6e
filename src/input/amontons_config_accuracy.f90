!> What a deck asks of the accuracy of its results: an error estimate, and the same case on finer meshes.
module amontons_config_accuracy
   use amontons_deck_visitor, only: deck_visitor_t, group_t, key_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: accuracy_options_t, describe_accuracy

   !> The group of the accuracy.
   type(group_t), parameter, public :: accuracy_group = group_t('accuracy')
   !> How errors are estimated, as a deck writes it.
   character(8), parameter :: estimate_names(2) = [character(8) :: 'recovery', 'none']
   !> Fewest refinements that show an order of convergence.
   integer, parameter :: fewest_refinements = 2

   !> What is asked of the accuracy.
   type :: accuracy_options_t
      character(8) :: estimate = 'recovery' !! one of `estimate_names`
      integer :: n_refinements = 0 !! on how many meshes, each refined from the one before, the case is solved again
   contains
      procedure :: wants_estimate => accuracy_wants_estimate
   end type accuracy_options_t

contains

   !> Describes `&accuracy`.
   subroutine describe_accuracy(visitor, accuracy, has_many_cases)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(accuracy_options_t), intent(inout) :: accuracy !! what is asked
      logical, intent(in) :: has_many_cases !! whether the deck has a sweep or a history
      logical :: is_given

      is_given = accuracy%n_refinements > 0
      call visitor%open_group(accuracy_group)
      call visitor%word(key_t('estimate', 'estimate of the error of the stresses of every element: by recovered'// &
         ' stresses, or none, which saves some time', also='error'), accuracy%estimate, estimate_names)
      call visitor%whole(key_t('refinements', 'the case is solved on its mesh and on so many refined ones, and the'// &
         ' key results get error bars', default='none', at_least=real(fewest_refinements, dp), also='refine levels'), &
         accuracy%n_refinements, is_given)
      call visitor%close_group()
      call visitor%only('refinements', .not. has_many_cases, 'a deck without &sweep and &history')
   end subroutine describe_accuracy

   !> Whether errors are estimated.
   pure logical function accuracy_wants_estimate(self)
      class(accuracy_options_t), intent(in) :: self !! what is asked

      accuracy_wants_estimate = self%estimate == estimate_names(1)
   end function accuracy_wants_estimate

end module amontons_config_accuracy
