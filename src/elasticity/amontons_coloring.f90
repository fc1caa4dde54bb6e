!> Colors of the elements: those of one color can be worked on in parallel.
!>
!> Elements in a row are a chunk, since what they have in common stays in the cache; no two chunks of one color share a
!> node. Where the elements of a mesh are numbered at random, so that all chunks touch each other, every element is a
!> chunk of its own.
module amontons_coloring
   use amontons_bins, only: fill_bins
   use amontons_kinds, only: int64
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: coloring_t, new_coloring, worth_threads

   !> Fewest elements whose work outweighs waking other threads, which takes up to some ten milliseconds.
   integer, parameter :: worth_threads = 10000

   !> Chunks sorted by color. Sums over the elements of a mesh taken color by color are the same for any number of
   !> threads.
   type :: coloring_t
      integer :: n_colors = 0 !! number of colors
      integer, allocatable :: start(:) !! where the chunks of a color begin (n_colors + 1)
      integer, allocatable :: first(:) !! the first element of each chunk (chunks)
      integer, allocatable :: last(:) !! its last one (chunks)
   end type coloring_t

contains

   !> Colors the elements of a mesh greedily, in their own order.
   subroutine new_coloring(coloring, mesh)
      type(coloring_t), intent(out) :: coloring !! the colors
      type(mesh_t), intent(in) :: mesh !! the mesh
      ! Elements of a chunk, whose nodes fit into a cache; fewest chunks of a color, for many threads.
      integer, parameter :: usual_size = 512, fewest = 32
      integer, allocatable :: color(:), chunk(:)
      integer :: chunk_size

      chunk_size = usual_size
      color = greedy_colors(mesh, chunk_size)
      if (size(color) < fewest*maxval(color)) then
         chunk_size = 1
         color = greedy_colors(mesh, chunk_size)
      end if
      coloring%n_colors = maxval(color)
      call fill_bins(coloring%start, chunk, color, coloring%n_colors)
      coloring%first = (chunk - 1)*chunk_size + 1
      coloring%last = min(mesh%n_elements, chunk*chunk_size)
   end subroutine new_coloring

   !> The color of each chunk: the first that none of its neighbors took before it.
   pure function greedy_colors(mesh, chunk_size) result(color)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: chunk_size !! number of elements of a chunk
      integer, allocatable :: color(:)
      integer, parameter :: n_bits = bit_size(0_int64)
      integer(int64) :: taken(mesh%n_nodes), used
      integer :: chunk, i, n_lonely

      allocate (color((mesh%n_elements + chunk_size - 1)/chunk_size))
      taken = 0_int64
      n_lonely = 0
      do chunk = 1, size(color)
         associate (first => mesh%node_start((chunk - 1)*chunk_size + 1), &
            past => mesh%node_start(min(mesh%n_elements, chunk*chunk_size) + 1))
            used = 0_int64
            do i = first, past - 1
               used = ior(used, taken(mesh%node(i)))
            end do
            color(chunk) = trailz(not(used)) + 1
            if (color(chunk) > n_bits) then
               ! The bits of a node where very many chunks meet are used up: the chunk gets a color of its own.
               n_lonely = n_lonely + 1
               color(chunk) = n_bits + n_lonely
               cycle
            end if
            do i = first, past - 1
               taken(mesh%node(i)) = ibset(taken(mesh%node(i)), color(chunk) - 1)
            end do
         end associate
      end do
   end function greedy_colors

end module amontons_coloring
