!> The label of a case: what the writers of its files need in addition to body and result.
module amontons_case_label
   implicit none (type, external)
   private

   public :: case_label_t, new_case_label

   !> Name, title, units and, for cases that come from one, the deck.
   type :: case_label_t
      character(:), allocatable :: name !! name of the case, and of its files
      character(:), allocatable :: title !! title of the case, for the listing
      character(:), allocatable :: units !! names of the units of length, force and stress; empty if they are not named
      character(:), allocatable :: file !! name of the deck; not allocated for a body made in code
   contains
      procedure :: deck_text => case_label_deck_text
   end type case_label_t

contains

   !> Makes the label of a body made in code.
   pure subroutine new_case_label(label, name, title)
      type(case_label_t), intent(out) :: label !! the label
      character(*), intent(in) :: name !! name of the case, and of its files
      character(*), intent(in), optional :: title !! title of the case; the name if absent

      label%name = name
      label%title = name
      label%units = ''
      if (present(title)) label%title = title
   end subroutine new_case_label

   !> The effective deck, with all defaults, which is written beside the results. A label alone has none: the text is
   !> empty; a configuration has one.
   function case_label_deck_text(self) result(text)
      class(case_label_t), intent(in) :: self !! the label
      character(:), allocatable :: text

      text = repeat(self%name, 0)
   end function case_label_deck_text

end module amontons_case_label
