!> Lists of integers that grow at their end.
module amontons_integer_list
   implicit none (type, external)
   private

   public :: integer_list_t

   !> A list of integers.
   type :: integer_list_t
      integer :: n = 0 !! number of items
      integer, allocatable :: item(:) !! the items and room for more (at least n); not allocated before the first
   contains
      procedure :: append => integer_list_append
      procedure :: append_all => integer_list_append_all
      procedure :: items => integer_list_items
      procedure :: make_room => integer_list_make_room
   end type integer_list_t

contains

   !> Puts an item at the end.
   pure subroutine integer_list_append(self, item)
      class(integer_list_t), intent(inout) :: self !! the list
      integer, intent(in) :: item !! the item

      if (.not. allocated(self%item)) then
         call self%make_room(1)
      else if (self%n == size(self%item)) then
         call self%make_room(1)
      end if
      self%n = self%n + 1
      self%item(self%n) = item
   end subroutine integer_list_append

   !> Puts several items at the end.
   pure subroutine integer_list_append_all(self, items)
      class(integer_list_t), intent(inout) :: self !! the list
      integer, intent(in) :: items(:) !! the items

      call self%make_room(size(items))
      self%item(self%n + 1:self%n + size(items)) = items
      self%n = self%n + size(items)
   end subroutine integer_list_append_all

   !> The items, without the room behind them.
   pure function integer_list_items(self) result(items)
      class(integer_list_t), intent(in) :: self !! the list
      integer, allocatable :: items(:)

      if (allocated(self%item)) then
         items = self%item(:self%n)
      else
         allocate (items(0))
      end if
   end function integer_list_items

   !> Makes room for more items; room that does not suffice grows by at least half.
   pure subroutine integer_list_make_room(self, n_more)
      class(integer_list_t), intent(inout) :: self !! the list
      integer, intent(in) :: n_more !! number of items to come
      integer, parameter :: least_room = 16
      integer, allocatable :: longer(:)

      if (allocated(self%item)) then
         if (self%n + n_more <= size(self%item)) return
         allocate (longer(max(self%n + n_more, self%n + self%n/2)))
         longer(:self%n) = self%item(:self%n)
         call move_alloc(longer, self%item)
      else
         allocate (self%item(max(n_more, least_room)))
      end if
   end subroutine integer_list_make_room

end module amontons_integer_list
