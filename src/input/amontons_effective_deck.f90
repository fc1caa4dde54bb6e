!> The effective deck: a configuration written out as a deck, every default in place. Reading it again gives the same
!> case.
module amontons_effective_deck
   use amontons_config, only: config_t, describe_config
   use amontons_deck_writer, only: deck_writer_t
   implicit none (type, external)
   private

   public :: body_text, effective_deck

contains

   !> The whole deck.
   function effective_deck(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      text = written(config, .false.)
   end function effective_deck

   !> The part of the deck that a factorization depends on: two cases whose texts agree can share it.
   function body_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      text = written(config, .true.)
   end function body_text

   !> The deck, or what decks that share a factorization agree in.
   function written(config, is_shared_only) result(text)
      type(config_t), intent(in) :: config !! the case
      logical, intent(in) :: is_shared_only !! whether only what such decks agree in is written
      character(:), allocatable :: text
      type(deck_writer_t) :: writer
      type(config_t) :: copy

      copy = config
      writer%is_shared_only = is_shared_only
      call describe_config(writer, copy)
      text = writer%written
   end function written

end module amontons_effective_deck
