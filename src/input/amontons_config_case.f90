!> What a deck says of the case as a whole: what it is called, and its units.
module amontons_config_case
   use amontons_case_label, only: case_label_t
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: describe_case

   !> The group of the case.
   type(group_t), parameter, public :: case_group = group_t('case')

contains

   !> Describes `&case`: name and title.
   subroutine describe_case(visitor, label)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      class(case_label_t), intent(inout) :: label !! what the case is called; its file is set
      ! File names end at 255 characters; temporary ones add up to 30 to the name.
      integer, parameter :: longest_name = 200
      integer :: last_point
      logical :: has_units

      if (.not. allocated(label%name)) then
         label%name = label%file(index(label%file, '/', back=.true.) + 1:)
         last_point = index(label%name, '.', back=.true.)
         if (last_point > 1) label%name = label%name(:last_point - 1)
      end if
      call visitor%open_group(case_group)
      call visitor%text(key_t('name', 'name of the case and of its files; 1 to 200 characters, without `/`', &
         default="name of the deck's file without its folder and last extension", also='job id'), label%name)
      call visitor%text(key_t('title', 'what the case is about, for the listing', also='heading description'), &
         label%title)
      has_units = is_filled(label%units)
      call visitor%text(key_t('units', "names of the units of length, force and stress, as `'mm, N, MPa'`, to label"// &
         ' listing, grids, figures and report; nothing is converted', default='none', is_filled=.true., also='unit'), &
         label%units, has_units)
      call visitor%close_group()
      call visitor%require(.not. has_units .or. are_units(label%units), 'units', &
         "units must name a length, a force and, if you like, a stress: 'mm, N, MPa'")
      if (len_trim(label%name) == 0 .or. len(label%name) > longest_name .or. has_unusable_character(label%name)) then
         call visitor%deck%fault(visitor%place, 'name', 'name must be usable as a file name: 1 to '// &
            to_text(longest_name)//" characters without '/' and control characters")
      end if
   end subroutine describe_case

   !> Whether a text is two or three names of units, commas between them.
   pure logical function are_units(text)
      character(*), intent(in) :: text !! the text
      integer :: i, n_commas

      n_commas = 0
      are_units = .true.
      do i = 1, len(text)
         if (text(i:i) /= ',') cycle
         n_commas = n_commas + 1
         are_units = are_units .and. len_trim(text(:i - 1)) > scan(text(:i - 1), ',', back=.true.)
      end do
      are_units = are_units .and. len_trim(text) > scan(text, ',', back=.true.) .and. (n_commas == 1 .or. n_commas == 2)
   end function are_units

   !> Whether a name has a character that file names or decks cannot have.
   pure logical function has_unusable_character(name)
      character(*), intent(in) :: name !! the name
      character, parameter :: blank = ' '
      integer :: i

      has_unusable_character = any([(name(i:i) < blank .or. name(i:i) == '/', i=1, len(name))])
   end function has_unusable_character

end module amontons_config_case
