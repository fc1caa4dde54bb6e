!> Finds where a mesh comes apart: at hanging nodes, which lie in the side of an element without belonging to it, and
!> at slits.
!>
!> At a hanging node the elements on both sides have the ends of the long side in common, and nothing holds the nodes
!> between them to it. Both sides lie on the boundary of the mesh then, so only that is searched; so do those of a slit.
module amontons_mesh_defects
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   use amontons_mesh_topology, only: side_element, side_place, side_table_t
   implicit none (type, external)
   private

   public :: find_hanging_node, find_slits

   !> Sides of the boundary by the corner they lead to.
   type :: incoming_sides_t
      integer, allocatable :: start(:) !! corner that each side comes from (sides)
      integer, allocatable :: before(:) !! side filed before it at the corner it leads to, 0 for none (sides)
      integer, allocatable :: last(:) !! last side filed at each corner, 0 for none (nodes)
   end type incoming_sides_t

contains

   !> Finds an element with a hanging node in one of its sides: shorter sides lead from one end of that side to the
   !> other along it. A slit, with nodes on both faces, is none, nor is its tip.
   pure subroutine find_hanging_node(mesh, table, element, node)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(side_table_t), intent(in) :: table !! the sides of its elements
      integer, intent(out) :: element !! the first element with a hanging node, 0 where there is none
      integer, intent(out) :: node !! the node, 0 for none
      type(incoming_sides_t) :: incoming
      integer :: corners(3), number, side

      call collect_incoming(incoming, mesh, table)
      do side = 1, table%n_sides
         number = table%boundary(side)
         if (number == 0) cycle
         corners = mesh%side(side_element(number), side_place(number))
         call follow(incoming, mesh%coordinates, corners(1), corners(2), node)
         if (node == 0) cycle
         element = side_element(number)
         return
      end do
      element = 0
      node = 0
   end subroutine find_hanging_node

   !> Counts the ends of slits: nodes from which on two sides of the boundary run along each other, the body left and
   !> right of them. A crack is a slit; so is the line between parts that touch without having their nodes in common.
   pure subroutine find_slits(mesh, table, n_ends, node)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(side_table_t), intent(in) :: table !! the sides of its elements
      integer, intent(out) :: n_ends !! number of the ends
      integer, intent(out) :: node !! the first of them, 0 for none
      ! Directions that differ by no more than this angle are one; less is left of them by the digits of a file [-].
      real(dp), parameter :: same = 1.0e-4_dp
      type(incoming_sides_t) :: incoming
      integer :: corners(3), number, other, side
      real(dp) :: along(2), way(2)

      call collect_incoming(incoming, mesh, table)
      n_ends = 0
      node = 0
      do side = 1, table%n_sides
         number = table%boundary(side)
         if (number == 0) cycle
         corners = mesh%side(side_element(number), side_place(number))
         along = mesh%coordinates(:, corners(2)) - mesh%coordinates(:, corners(1))
         other = incoming%last(corners(1))
         do while (other > 0)
            way = mesh%coordinates(:, incoming%start(other)) - mesh%coordinates(:, corners(1))
            other = incoming%before(other)
            if (abs(way(1)*along(2) - way(2)*along(1)) > same*dot_product(way, along)) cycle
            n_ends = n_ends + 1
            if (node == 0) node = corners(1)
         end do
      end do
   end subroutine find_slits

   !> Files the sides of the boundary by the corner they lead to.
   pure subroutine collect_incoming(incoming, mesh, table)
      type(incoming_sides_t), intent(out) :: incoming !! the sides
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(side_table_t), intent(in) :: table !! the sides of its elements
      integer :: corners(3), number, side

      allocate (incoming%start(table%n_sides), incoming%before(table%n_sides), source=0)
      allocate (incoming%last(mesh%n_nodes), source=0)
      do side = 1, table%n_sides
         number = table%boundary(side)
         if (number == 0) cycle
         corners = mesh%side(side_element(number), side_place(number))
         incoming%start(side) = corners(1)
         incoming%before(side) = incoming%last(corners(2))
         incoming%last(corners(2)) = side
      end do
   end subroutine collect_incoming

   !> Goes from one corner of a side to the other along shorter sides of the elements opposite, against their
   !> direction.
   pure subroutine follow(incoming, coordinates, from, to, node)
      type(incoming_sides_t), intent(in) :: incoming !! the sides of the boundary
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, nodes) [L]
      integer, intent(in) :: from !! the corner to come from
      integer, intent(in) :: to !! the corner to go to
      integer, intent(out) :: node !! the first node on the way, 0 if the way does not lead there
      ! Nodes of a curved interface lie beside the chord, by far less than this share of it; but on the element's own
      ! side by no more than what the digits of a file leave: across a thin body there may be a way as well.
      real(dp), parameter :: outer_width = 0.02_dp, inner_width = 1.0e-4_dp
      real(dp) :: along(2), reached, way(2)
      integer :: at, side

      node = 0
      along = (coordinates(:, to) - coordinates(:, from))/sum((coordinates(:, to) - coordinates(:, from))**2)
      reached = 0.0_dp
      at = from
      do
         side = incoming%last(at)
         do while (side > 0)
            way = coordinates(:, incoming%start(side)) - coordinates(:, from)
            ! Along the side, and off it to the right, where no element should be; in parts of the side.
            way = [dot_product(way, along), way(1)*along(2) - way(2)*along(1)]
            if (incoming%start(side) == to) exit
            if (way(1) > reached .and. way(1) < 1.0_dp .and. way(2) > -inner_width .and. way(2) < outer_width) exit
            side = incoming%before(side)
         end do
         if (side == 0) exit
         at = incoming%start(side)
         if (at == to) return
         if (node == 0) node = at
         reached = way(1)
      end do
      node = 0
   end subroutine follow

end module amontons_mesh_defects
