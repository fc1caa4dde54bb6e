!> Colors of the elements: no two elements of one color share a node, so a color can be worked on in parallel. Elements
!> far apart in their order have different colors: what the elements of one color and the next have in common stays in
!> the cache.
module amontons_coloring
   use amontons_bins, only: fill_bins
   use amontons_kinds, only: int64
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: coloring_t, new_coloring, worth_threads

   !> Fewest elements whose work outweighs waking other threads, which takes up to some ten milliseconds.
   integer, parameter :: worth_threads = 10000

   !> So many elements and their nodes stay in a cache of a few megabytes.
   integer, parameter :: block_size = 8192

   !> Elements sorted by color. Sums over the elements of a mesh taken color by color are the same for any
   !> number of threads.
   type :: coloring_t
      integer :: n_colors = 0 !! number of colors
      integer, allocatable :: start(:) !! where the elements of a color begin in `element` (n_colors + 1)
      integer, allocatable :: element(:) !! the elements, color by color
   end type coloring_t

contains

   !> Colors the elements of a mesh greedily, in their own order, block by block.
   subroutine new_coloring(coloring, mesh)
      type(coloring_t), intent(out) :: coloring !! the colors
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, allocatable :: color(:), used(:), number(:)
      integer :: i, n_each

      color = greedy_colors(mesh)
      n_each = maxval(color)
      color = color + n_each*[((i - 1)/block_size, i=1, mesh%n_elements)]
      ! Not every block has all colors.
      allocate (used(maxval(color)), source=0)
      used(color) = 1
      coloring%n_colors = sum(used)
      number = unpack([(i, i=1, coloring%n_colors)], used == 1, used)
      call fill_bins(coloring%start, coloring%element, number(color), coloring%n_colors)
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
