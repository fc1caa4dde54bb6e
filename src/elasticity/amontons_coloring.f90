!> Colors of the elements: no two elements of one color share a node, so a color can be worked on in parallel.
module amontons_coloring
   use amontons_bins, only: fill_bins
   use amontons_kinds, only: int64
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: coloring_t, new_coloring, worth_threads

   !> Fewest elements whose work outweighs waking other threads, which takes up to some ten milliseconds.
   integer, parameter :: worth_threads = 10000

   !> Elements sorted by color. Sums over the elements of a mesh taken color by color are the same for any
   !> number of threads.
   type :: coloring_t
      integer :: n_colors = 0 !! number of colors
      integer, allocatable :: start(:) !! where the elements of a color begin in `element` (n_colors + 1)
      integer, allocatable :: element(:) !! the elements, color by color
   end type coloring_t

contains

   !> Colors the elements of a mesh greedily, in their own order.
   subroutine new_coloring(coloring, mesh)
      type(coloring_t), intent(out) :: coloring !! the colors
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, allocatable :: color(:)

      color = greedy_colors(mesh)
      coloring%n_colors = maxval(color)
      call fill_bins(coloring%start, coloring%element, color, coloring%n_colors)
   end subroutine new_coloring

   !> The color of each element: the first that none of its neighbors took before it.
   pure function greedy_colors(mesh) result(color)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, allocatable :: color(:)
      integer, parameter :: n_bits = bit_size(0_int64)
      integer(int64) :: taken(mesh%n_nodes), used
      integer :: element, i, n_lonely

      allocate (color(mesh%n_elements))
      taken = 0_int64
      n_lonely = 0
      do element = 1, mesh%n_elements
         used = 0_int64
         do i = mesh%node_start(element), mesh%node_start(element + 1) - 1
            used = ior(used, taken(mesh%node(i)))
         end do
         color(element) = trailz(not(used)) + 1
         if (color(element) > n_bits) then
            ! The bits of a node where very many elements meet are used up: the element gets a color of its own.
            n_lonely = n_lonely + 1
            color(element) = n_bits + n_lonely
            cycle
         end if
         do i = mesh%node_start(element), mesh%node_start(element + 1) - 1
            taken(mesh%node(i)) = ibset(taken(mesh%node(i)), color(element) - 1)
         end do
      end do
   end function greedy_colors

end module amontons_coloring
