!> What the readers of all groups of a deck share: rules a value must obey, tables in files, places for messages.
module amontons_deck_rules
   use amontons_deck, only: deck_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_number_table, only: beside, read_number_table
   use amontons_system, only: absolute_path
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: origin_of, read_table, require

contains

   !> Records a fault unless a value is as it must be.
   subroutine require(deck, group, key, is_right, rule)
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key
      logical, intent(in) :: is_right !! whether the value is as it must be
      character(*), intent(in) :: rule !! what it must do, for the message: 'be positive'

      if (.not. is_right) call deck%fault(group, key, key//' must '//rule)
   end subroutine require

   !> Reads a table of two columns from the file that a key names; a relative name counts from the deck's directory.
   subroutine read_table(deck, group, key, table, file)
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key
      real(dp), allocatable, intent(out) :: table(:, :) !! the table (2, rows); not allocated where the key is absent
      character(:), allocatable, intent(out) :: file !! name of the file from the root on; empty where the key is absent
      type(error_t), allocatable :: error

      file = ''
      call deck%get(group, key, file)
      if (len(file) == 0) return
      file = absolute_path(beside(deck%file, file))
      call read_number_table(table, file, error)
      if (allocated(error)) call deck%fault(group, key, key//': '//error%message)
   end subroutine read_table

   !> Where a key of a group stands, as messages begin: 'deck.nml:12: '.
   function origin_of(deck, group, key) result(origin)
      type(deck_t), intent(in) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key
      character(:), allocatable :: origin

      origin = deck%file//':'//to_text(deck%line_of(group, key))//': '
   end function origin_of

end module amontons_deck_rules
