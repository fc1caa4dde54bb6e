!> The contact sets that a deck asks for.
module amontons_config_contact
   use amontons_cell_partition, only: cell_partition_t, multiplier_names
   use amontons_contact_zone, only: contact_t
   use amontons_deck, only: deck_t
   use amontons_deck_rules, only: origin_of, read_table, require
   use amontons_kinds, only: dp, int64
   use amontons_line_field, only: line_field_t
   use amontons_obstacle, only: obstacle_names
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: read_contacts

contains

   !> Reads all `&contact`.
   subroutine read_contacts(contacts, deck)
      type(contact_t), allocatable, intent(out) :: contacts(:) !! the contact sets
      type(deck_t), intent(inout) :: deck !! the deck
      integer, allocatable :: groups(:)
      integer :: i

      groups = deck%groups('contact')
      allocate (contacts(size(groups)))
      do i = 1, size(groups)
         call read_contact(contacts(i), deck, groups(i))
      end do
   end subroutine read_contacts

   !> Reads one `&contact`.
   subroutine read_contact(contact, deck, group)
      type(contact_t), intent(inout) :: contact !! the contact set
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      logical :: has_slope(2), has_radius, has_direction

      contact%set = ''
      contact%origin = origin_of(deck, group, 'set')
      contact%obstacle%kind = trim(obstacle_names(1))
      call deck%get(group, 'set', contact%set)
      call deck%get(group, 'friction', contact%friction%value)
      call deck%get(group, 'friction_slope', contact%friction%slope, has_slope(1))
      call read_table(deck, group, 'friction_table', contact%friction%table, contact%friction%file)
      call deck%get(group, 'slip_bound', contact%slip_bound%value)
      call deck%get(group, 'slip_bound_slope', contact%slip_bound%slope, has_slope(2))
      call read_table(deck, group, 'slip_bound_table', contact%slip_bound%table, contact%slip_bound%file)
      call deck%get_word(group, 'obstacle', contact%obstacle%kind, obstacle_names)
      call deck%get(group, 'point', contact%obstacle%point)
      call deck%get(group, 'normal', contact%obstacle%normal)
      call deck%get(group, 'radius', contact%obstacle%radius, has_radius)
      call read_table(deck, group, 'line', contact%obstacle%line, contact%obstacle%file)
      call deck%get(group, 'gap_direction', contact%direction, has_direction)
      call deck%get(group, 'extra_gap', contact%extra_gap)
      call read_partition(contact%partition, deck, group)
      call deck%refuse_unknown(group)
      call require_positive(deck, group, 'friction', contact%friction, has_slope(1))
      call require_positive(deck, group, 'slip_bound', contact%slip_bound, has_slope(2))
      call require(deck, group, 'normal', norm2(contact%obstacle%normal) > 0.0_dp, 'not be zero')
      call require(deck, group, 'gap_direction', norm2(contact%direction) > 0.0_dp .or. .not. has_direction, &
         'not be zero')
      call require(deck, group, 'radius', abs(contact%obstacle%radius) > 0.0_dp, 'not be zero')
      call require_ascending(deck, group, 'friction_table', contact%friction)
      call require_ascending(deck, group, 'slip_bound_table', contact%slip_bound)
      if (.not. deck%is_understood(group)) return
      if (len_trim(contact%set) == 0) call deck%fault(group, 'set', '&contact needs a set')
      call require(deck, group, 'radius', has_radius .eqv. contact%obstacle%has_radius(), &
         'go with obstacle circle or parabola, and only with these')
      call require(deck, group, 'line', len(contact%obstacle%file) > 0 .eqv. contact%obstacle%kind == 'polyline', &
         'go with obstacle polyline, and only with it')
   end subroutine read_contact

   !> Records a fault where a quantity is negative, unless it has a slope that may raise it along the line.
   subroutine require_positive(deck, group, key, field, has_slope)
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key of the quantity
      type(line_field_t), intent(in) :: field !! the quantity
      logical, intent(in) :: has_slope !! whether a slope is given; it is 0 here where its value is at fault

      if (has_slope .and. (any(abs(field%slope) > 0.0_dp) .or. .not. deck%is_understood(group))) return
      call require(deck, group, key, field%value >= 0.0_dp, 'be at least 0, found '//to_text(field%value))
   end subroutine require_positive

   !> Reads the multipliers of a contact set.
   subroutine read_partition(partition, deck, group)
      type(cell_partition_t), intent(inout) :: partition !! the multipliers
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(:), allocatable :: multipliers
      ! More than any mesh can tell apart; a repeat count could ask for more than memory holds.
      integer(int64), parameter :: most_ends = 100000
      real(dp), allocatable :: ends(:)
      logical :: has_cells, has_ends
      integer :: n

      multipliers = trim(multiplier_names(1))
      call deck%get_word(group, 'multipliers', multipliers, multiplier_names)
      partition%is_constant = multipliers == multiplier_names(2)
      call deck%get(group, 'cells', partition%n_cells, has_cells)
      allocate (ends(min(deck%n_values(group, 'cell_ends'), most_ends)), source=0.0_dp)
      call deck%get(group, 'cell_ends', ends, has_ends)
      if (has_ends) partition%ends = ends
      n = size(ends)
      call require(deck, group, 'cells', partition%n_cells > 0 .or. .not. has_cells, 'be positive, found '// &
         to_text(partition%n_cells))
      call require(deck, group, 'cells', partition%is_constant .or. .not. has_cells, 'go with multipliers constant')
      call require(deck, group, 'cell_ends', partition%is_constant .or. .not. has_ends, 'go with multipliers constant')
      call require(deck, group, 'cell_ends', .not. (has_cells .and. has_ends), 'not stand beside cells')
      call require(deck, group, 'cell_ends', all(ends(:min(1, n)) > 0.0_dp) .and. &
         all(ends(2:) > ends(:n - 1)), 'be positive and ascend')
   end subroutine read_partition

   !> Records a fault where the stations of a table do not ascend.
   subroutine require_ascending(deck, group, key, field)
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key of the table
      type(line_field_t), intent(in) :: field !! the quantity with the table
      integer :: n

      if (.not. allocated(field%table)) return
      n = size(field%table, 2)
      call require(deck, group, key, all(field%table(1, 2:) > field%table(1, :n - 1)), &
         'have stations that ascend from row to row')
   end subroutine require_ascending

end module amontons_config_contact
