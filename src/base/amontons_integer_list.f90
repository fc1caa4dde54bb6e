!> Growing lists of integers; sorting of items into bins; and maps from the numbers that a file gives its nodes and
!> elements, in any order and with gaps, to their places in a list.
module amontons_integer_list
   implicit none (type, external)
   private

   public :: fill_bins, integer_list_t, new_tag_map, tag_map_t

   !> A list of integers.
   type :: integer_list_t
      integer :: n = 0 !! number of items
      integer, allocatable :: item(:) !! the items and room for more (at least n); not allocated before the first
   contains
      procedure :: append => integer_list_append
      procedure :: append_all => integer_list_append_all
      procedure :: items => integer_list_items
   end type integer_list_t

   !> A map from tags to the items of a list: the tags in ascending order, with the item of each.
   type :: tag_map_t
      integer, allocatable :: tag(:) !! the tags, ascending
      integer, allocatable :: item(:) !! place of each in the list; equal tags in the order of the list
   contains
      procedure :: find => tag_map_find
      procedure :: first => tag_map_first
      procedure :: repeated => tag_map_repeated
   end type tag_map_t

contains

   !> Sorts items by their bins; items of one bin keep their order.
   pure subroutine fill_bins(start, thing, bin, n_bins)
      integer, allocatable, intent(out) :: start(:) !! first place of each bin in `thing` (n_bins + 1)
      integer, allocatable, intent(out) :: thing(:) !! the things, bin by bin
      integer, intent(in) :: bin(:) !! bin of each thing, 1 to `n_bins`; 0 for none
      integer, intent(in) :: n_bins !! number of bins
      integer, allocatable :: next(:)
      integer :: i

      allocate (start(n_bins + 1), source=0)
      do i = 1, size(bin)
         if (bin(i) > 0) start(bin(i) + 1) = start(bin(i) + 1) + 1
      end do
      start(1) = 1
      do i = 1, n_bins
         start(i + 1) = start(i + 1) + start(i)
      end do
      allocate (next, source=start)
      allocate (thing(start(n_bins + 1) - 1))
      do i = 1, size(bin)
         if (bin(i) == 0) cycle
         thing(next(bin(i))) = i
         next(bin(i)) = next(bin(i)) + 1
      end do
   end subroutine fill_bins

   !> Appends a number to the list, which grows as needed.
   pure subroutine integer_list_append(self, item)
      class(integer_list_t), intent(inout) :: self !! the list
      integer, intent(in) :: item !! the item

      call make_room(self, 1)
      self%n = self%n + 1
      self%item(self%n) = item
   end subroutine integer_list_append

   !> Appends several numbers to the list, which grows as needed.
   pure subroutine integer_list_append_all(self, items)
      class(integer_list_t), intent(inout) :: self !! the list
      integer, intent(in) :: items(:) !! the items

      call make_room(self, size(items))
      self%item(self%n + 1:self%n + size(items)) = items
      self%n = self%n + size(items)
   end subroutine integer_list_append_all

   !> The items of the list, without the unused capacity.
   pure function integer_list_items(self) result(items)
      class(integer_list_t), intent(in) :: self !! the list
      integer, allocatable :: items(:)

      if (allocated(self%item)) then
         items = self%item(:self%n)
      else
         allocate (items(0))
      end if
   end function integer_list_items

   !> Reserves capacity for more items; a capacity that does not suffice grows by at least half.
   pure subroutine make_room(list, n_more)
      type(integer_list_t), intent(inout) :: list !! the list
      integer, intent(in) :: n_more !! number of items to come
      integer, parameter :: least_room = 16
      integer, allocatable :: longer(:)

      if (allocated(list%item)) then
         if (list%n + n_more <= size(list%item)) return
         allocate (longer(max(list%n + n_more, list%n + list%n/2)))
         longer(:list%n) = list%item(:list%n)
         call move_alloc(longer, list%item)
      else
         allocate (list%item(max(n_more, least_room)))
      end if
   end subroutine make_room

   !> Makes the map of a list of tags, in a time proportional to their number.
   pure subroutine new_tag_map(map, tags)
      type(tag_map_t), intent(out) :: map !! the map
      integer, intent(in) :: tags(:) !! the tags, not negative
      integer, parameter :: n_bits = 11
      integer, allocatable :: start(:), order(:)
      integer :: i, n, shift

      n = size(tags)
      allocate (map%tag(n), map%item(n))
      map%tag = tags
      map%item = [(i, i=1, n)]
      do shift = 0, bit_size(n) - 1, n_bits
         if (all(map%tag(2:) >= map%tag(:n - 1))) exit
         ! By some bits of the tags; equal ones keep their order.
         call fill_bins(start, order, 1 + ibits(map%tag, shift, min(n_bits, bit_size(shift) - shift)), 2**n_bits)
         map%tag = map%tag(order)
         map%item = map%item(order)
      end do
   end subroutine new_tag_map

   !> The first item of the list that has a tag, 0 if none has it.
   pure integer function tag_map_find(self, tag) result(item)
      class(tag_map_t), intent(in) :: self !! the map
      integer, intent(in) :: tag !! the tag
      integer :: place

      item = 0
      place = self%first(tag)
      if (place <= size(self%tag)) then
         if (self%tag(place) == tag) item = self%item(place)
      end if
   end function tag_map_find

   !> Place in the map of the first tag that is not smaller than a given one; one past the last place if all are
   !> smaller.
   pure integer function tag_map_first(self, tag) result(place)
      class(tag_map_t), intent(in) :: self !! the map
      integer, intent(in) :: tag !! the tag
      integer :: low, high, middle

      low = 0
      high = size(self%tag) + 1
      if (high > 1) then
         ! Tags without gaps are found at once.
         place = max(tag, 1) - max(self%tag(1), 1) + 1
         if (place > 1 .and. place < high) then
            if (self%tag(place) >= tag) high = place
            if (self%tag(place - 1) < tag) low = place - 1
         end if
      end if
      do while (high - low > 1)
         middle = low + (high - low)/2
         if (self%tag(middle) < tag) then
            low = middle
         else
            high = middle
         end if
      end do
      place = high
   end function tag_map_first

   !> The first item of the list whose tag an earlier item has, 0 if all tags differ.
   pure integer function tag_map_repeated(self) result(repeated)
      class(tag_map_t), intent(in) :: self !! the map
      integer :: place

      repeated = 0
      do place = 2, size(self%tag)
         if (self%tag(place) /= self%tag(place - 1)) cycle
         if (repeated == 0) repeated = self%item(place)
         repeated = min(repeated, self%item(place))
      end do
   end function tag_map_repeated

end module amontons_integer_list
