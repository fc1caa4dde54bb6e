!> The sides of the elements of a mesh, found by their corners: which element lies on which side of them.
module amontons_side_table
   use amontons_element, only: n_corners
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: new_side_table, side_element, side_number, side_place, side_table_t, sides_per_element

   !> Every element has this many numbers for its sides, used or not.
   integer, parameter :: sides_per_element = 4

   !> A side between two elements or at the boundary.
   type :: side_t
      integer :: before !! side filed before it under the same node, 0 for none
      integer :: other !! the corner that it is not filed under
      integer :: left !! number of the element's side that runs to the other corner, 0 for none
      integer :: right !! number of the element's side that runs the other way, 0 for none
   end type side_t

   !> The sides of all elements. Each is filed under that of its two corners where fewer elements meet, which keeps
   !> every search short, even around the hub of a wheel.
   type :: side_table_t
      integer :: n_sides = 0 !! number of sides
      type(side_t), allocatable :: sides(:) !! the sides, and room for more
      integer, allocatable :: last(:) !! last side filed under each node, 0 for none (nodes)
      integer, allocatable, private :: valence(:) !! number of elements at each node (nodes)
   contains
      procedure :: boundary => side_table_boundary
      procedure :: find => side_table_find
   end type side_table_t

contains

   !> Number of a side of an element.
   elemental integer function side_number(element, place)
      integer, intent(in) :: element !! the element
      integer, intent(in) :: place !! the side's place in the element, from 1

      side_number = sides_per_element*(element - 1) + place
   end function side_number

   !> The element of a numbered side, 0 for number 0.
   elemental integer function side_element(number)
      integer, intent(in) :: number !! number of the side, or 0

      side_element = (number + sides_per_element - 1)/sides_per_element
   end function side_element

   !> The place of a numbered side in its element.
   elemental integer function side_place(number)
      integer, intent(in) :: number !! number of the side

      side_place = mod(number - 1, sides_per_element) + 1
   end function side_place

   !> Files the sides of a mesh; stops at the first side that has two elements on the same side of it.
   pure subroutine new_side_table(table, mesh, overlapping)
      type(side_table_t), intent(out) :: table !! the sides
      type(mesh_t), intent(in) :: mesh !! the mesh, its elements counter-clockwise
      integer, intent(out) :: overlapping(2) !! two elements that lie one over the other, 0 where none do
      integer :: element, i, n, first

      allocate (table%last(mesh%n_nodes), table%valence(mesh%n_nodes), source=0)
      allocate (table%sides(sum(n_corners(mesh%element_kind))))
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
            call file_side(table, mesh%node(first + i - 1), mesh%node(first + mod(i, n)), side_number(element, i), &
               overlapping)
            if (overlapping(1) > 0) return
         end do
      end do
   end subroutine new_side_table

   !> Files a side of an element.
   pure subroutine file_side(table, a, b, number, overlapping)
      type(side_table_t), intent(inout) :: table !! the sides filed so far
      integer, intent(in) :: a !! first corner of the side; the element lies on the left
      integer, intent(in) :: b !! second corner of the side
      integer, intent(in) :: number !! number of the side
      integer, intent(inout) :: overlapping(2) !! the element that is there already, if one is, and this one
      integer :: side, home

      home = home_of(table, a, b)
      side = place_of(table, home, a + b - home)
      if (side == 0) then
         table%n_sides = table%n_sides + 1
         side = table%n_sides
         table%sides(side) = side_t(table%last(home), a + b - home, 0, 0)
         table%last(home) = side
      end if
      associate (filed => table%sides(side))
         if (home == a) then
            if (filed%left > 0) overlapping = side_element([filed%left, number])
            filed%left = number
         else
            if (filed%right > 0) overlapping = side_element([filed%right, number])
            filed%right = number
         end if
      end associate
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

   !> Place in the table of a side, 0 where no element has it.
   pure integer function place_of(table, home, other) result(side)
      type(side_table_t), intent(in) :: table !! the sides
      integer, intent(in) :: home !! the corner it would be filed under
      integer, intent(in) :: other !! its other corner

      side = table%last(home)
      do while (side > 0)
         if (table%sides(side)%other == other) return
         side = table%sides(side)%before
      end do
   end function place_of

   !> Finds the elements' sides on both sides of the way from one corner to another.
   pure subroutine side_table_find(self, a, b, left, right)
      class(side_table_t), intent(in) :: self !! the sides
      integer, intent(in) :: a !! the corner to come from
      integer, intent(in) :: b !! the corner to go to
      integer, intent(out) :: left !! number of the side of the element on the left, 0 for none
      integer, intent(out) :: right !! number of the side of the element on the right, 0 for none
      integer :: side, home

      left = 0
      right = 0
      home = home_of(self, a, b)
      side = place_of(self, home, a + b - home)
      if (side == 0) return
      left = merge(self%sides(side)%left, self%sides(side)%right, home == a)
      right = merge(self%sides(side)%right, self%sides(side)%left, home == a)
   end subroutine side_table_find

   !> Number of the element's side at a side of the boundary, 0 at a side between two elements.
   pure integer function side_table_boundary(self, side) result(number)
      class(side_table_t), intent(in) :: self !! the sides
      integer, intent(in) :: side !! place in the table

      number = 0
      if (min(self%sides(side)%left, self%sides(side)%right) == 0) then
         number = max(self%sides(side)%left, self%sides(side)%right)
      end if
   end function side_table_boundary

end module amontons_side_table
