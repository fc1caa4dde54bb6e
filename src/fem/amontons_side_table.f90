!> The sides of the elements of a mesh, found by their corners: which element lies on which side of them.
module amontons_side_table
   use amontons_element, only: n_corners
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: new_side_table, side_of_element_t, side_table_t

   !> A side of an element.
   type :: side_of_element_t
      integer :: element = 0 !! number of the element, 0 for none
      integer :: side = 0 !! number of the side in the element
   end type side_of_element_t

   !> The sides of all elements. Each is filed under that of its two corners where fewer elements meet, which keeps
   !> every search short, even around the hub of a fan.
   type :: side_table_t
      integer :: n_sides = 0 !! number of sides
      integer, allocatable :: last(:) !! last side filed under each node, 0 for none (nodes)
      integer, allocatable :: before(:) !! side filed before it under the same node, 0 for none (sides)
      integer, allocatable :: corners(:, :) !! the node a side is filed under, and its other corner (2, sides)
      type(side_of_element_t), allocatable :: along(:) !! the element that the side has on its left (sides)
      type(side_of_element_t), allocatable :: against(:) !! the element that the side has on its right (sides)
      integer, allocatable, private :: valence(:) !! number of elements at each node (nodes)
   contains
      procedure :: boundary => side_table_boundary
      procedure :: find => side_table_find
   end type side_table_t

contains

   !> Files the sides of a mesh; stops at the first side that has two elements on the same side of it.
   pure subroutine new_side_table(table, mesh, overlapping)
      type(side_table_t), intent(out) :: table !! the sides
      type(mesh_t), intent(in) :: mesh !! the mesh, its elements counter-clockwise
      integer, intent(out) :: overlapping(2) !! two elements that lie one over the other, 0 where none do
      integer :: element, i, n, first, most

      most = sum(n_corners(mesh%element_kind))
      allocate (table%last(mesh%n_nodes), table%valence(mesh%n_nodes), source=0)
      allocate (table%before(most), table%corners(2, most), table%along(most), table%against(most))
      do element = 1, mesh%n_elements
         first = mesh%node_start(element)
         do i = first, first + n_corners(mesh%element_kind(element)) - 1
            table%valence(mesh%node(i)) = table%valence(mesh%node(i)) + 1
         end do
      end do
      overlapping = 0
      do element = 1, mesh%n_elements
         first = mesh%node_start(element)
         n = n_corners(mesh%element_kind(element))
         do i = 1, n
            call file_side(table, mesh%node(first + i - 1), mesh%node(first + mod(i, n)), &
               side_of_element_t(element, i), overlapping)
            if (overlapping(1) > 0) return
         end do
      end do
   end subroutine new_side_table

   !> Files a side of an element.
   pure subroutine file_side(table, a, b, owner, overlapping)
      type(side_table_t), intent(inout) :: table !! the sides filed so far
      integer, intent(in) :: a !! first corner of the side; the element lies on the left
      integer, intent(in) :: b !! second corner of the side
      type(side_of_element_t), intent(in) :: owner !! the element and the side in it
      integer, intent(inout) :: overlapping(2) !! the element and the one that is there already, if one is
      integer :: side, home

      side = place_of(table, a, b)
      home = home_of(table, a, b)
      if (side == 0) then
         table%n_sides = table%n_sides + 1
         side = table%n_sides
         table%corners(:, side) = [home, a + b - home]
         table%before(side) = table%last(home)
         table%last(home) = side
      end if
      if (home == a) then
         if (table%along(side)%element > 0) overlapping = [table%along(side)%element, owner%element]
         table%along(side) = owner
      else
         if (table%against(side)%element > 0) overlapping = [table%against(side)%element, owner%element]
         table%against(side) = owner
      end if
   end subroutine file_side

   !> The node that a side is filed under: that of its corners where fewer elements meet.
   pure integer function home_of(table, a, b) result(home)
      type(side_table_t), intent(in) :: table !! the sides
      integer, intent(in) :: a !! one corner
      integer, intent(in) :: b !! the other corner

      if (table%valence(a) == table%valence(b)) then
         home = min(a, b)
      else
         home = merge(a, b, table%valence(a) < table%valence(b))
      end if
   end function home_of

   !> Place in the table of the side between two corners, 0 where no element has it.
   pure integer function place_of(table, a, b) result(side)
      type(side_table_t), intent(in) :: table !! the sides
      integer, intent(in) :: a !! one corner
      integer, intent(in) :: b !! the other corner
      integer :: home

      home = home_of(table, a, b)
      side = table%last(home)
      do while (side > 0)
         if (table%corners(2, side) == a + b - home) return
         side = table%before(side)
      end do
   end function place_of

   !> Finds the elements on both sides of the way from one corner to another.
   pure subroutine side_table_find(self, a, b, left, right)
      class(side_table_t), intent(in) :: self !! the sides
      integer, intent(in) :: a !! the corner to come from
      integer, intent(in) :: b !! the corner to go to
      type(side_of_element_t), intent(out) :: left !! the element on the left
      type(side_of_element_t), intent(out) :: right !! the element on the right
      integer :: side

      side = place_of(self, a, b)
      if (side == 0) return
      left = self%along(side)
      right = self%against(side)
      if (self%corners(1, side) == a) return
      left = self%against(side)
      right = self%along(side)
   end subroutine side_table_find

   !> The element of a side that has one element only; no element for the others.
   pure function side_table_boundary(self, side) result(owner)
      class(side_table_t), intent(in) :: self !! the sides
      integer, intent(in) :: side !! place in the table
      type(side_of_element_t) :: owner

      if (self%against(side)%element == 0) owner = self%along(side)
      if (self%along(side)%element == 0) owner = self%against(side)
   end function side_table_boundary

end module amontons_side_table
