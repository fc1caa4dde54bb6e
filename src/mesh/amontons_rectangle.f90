!> Meshes of a rectangle: quadrilaterals, or triangles that halve each cell, linear or quadratic.
module amontons_rectangle
   use amontons_element, only: element_names, is_triangle, n_element_nodes, quad4, tri3
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_mesh, only: boundary_set_t, mesh_t
   use amontons_refined_mesh, only: raise_order
   use amontons_system, only: available_memory_mb
   use amontons_text, only: short_text, to_text
   implicit none (type, external)
   private

   public :: diagonal_names, new_rectangle_mesh, rectangle_t

   !> Ways to halve a cell, as a deck writes them.
   character(11), parameter :: diagonal_names(3) = [character(11) :: 'right', 'left', 'alternating']

   !> A rectangle with its lower left corner at the origin, and how to cut it into cells.
   type :: rectangle_t
      real(dp) :: size(2) = [1.0_dp, 1.0_dp] !! width and height [L]
      integer :: cells(2) = [1, 1] !! number of cells along x and along y
      character(8) :: element = 'quad4' !! one of `element_names`
      character(11) :: diagonal = 'right' !! 'right' (/), 'left' (\) or 'alternating'; read for triangles only
      real(dp) :: grading = 1.0_dp !! height of the last (top) row of cells over that of the first [-]
   end type rectangle_t

contains

   !> Makes the mesh of a rectangle, with the boundary sets left, right, bottom and top.
   subroutine new_rectangle_mesh(mesh, rectangle, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(rectangle_t), intent(in) :: rectangle !! the rectangle and its cells
      type(error_t), allocatable, intent(out) :: error !! the rectangle makes no sense, or memory is short
      ! The longest list counts 12 unknowns for the two linear triangles of a cell, 24 for quadratic ones; default
      ! integers reach 2^31.
      integer(int64), parameter :: most_nodes = 2_int64**27
      integer :: kind, shape

      kind = findloc(element_names == rectangle%element, .true., dim=1)
      if (any(.not. rectangle%size > 0.0_dp) .or. any(rectangle%cells < 1) .or. .not. rectangle%grading > 0.0_dp &
         .or. kind == 0 .or. all(diagonal_names /= rectangle%diagonal)) then
         call new_error(error, input_refused, &
            'rectangle: size, cells and grading must be positive, element and diagonal known words')
         return
      end if
      shape = merge(tri3, quad4, is_triangle(kind))
      if (product(int(rectangle%cells, int64) + 1)*merge(1, 2, kind == shape) > most_nodes) then
         call new_error(error, input_refused, 'rectangle: more cells than node numbers allow (about 134 million, '// &
            'of quadratic elements half as many)')
         return
      end if
      call check_memory(rectangle%cells, kind /= shape, error)
      if (allocated(error)) return
      mesh%source = 'rectangle '//short_text(rectangle%size(1))//' x '//short_text(rectangle%size(2))//', '// &
         to_text(rectangle%cells(1))//' x '//to_text(rectangle%cells(2))//' cells of '//trim(rectangle%element)
      call place_nodes(mesh, rectangle)
      call connect_cells(mesh, rectangle, shape)
      call name_sides(mesh, rectangle%cells, shape, rectangle%diagonal)
      if (kind /= shape) call raise_order(mesh, spread(kind, 1, mesh%n_elements))
   end subroutine new_rectangle_mesh

   !> Refuses cells whose stiffness and factor the memory cannot hold, by what they take at the very least, before a
   !> mesh of them is made.
   subroutine check_memory(cells, is_quadratic, error)
      integer, intent(in) :: cells(2) !! number of cells along x and along y
      logical, intent(in) :: is_quadratic !! whether the sides have middle nodes
      type(error_t), allocatable, intent(out) :: error !! not enough memory
      ! Mesh and assembled stiffness; the factor of nested dissection has 90 to 120 numbers an unknown on squares of
      ! 256 to 1024 cells, and more of them the more cells the shorter side has. Half of that leaves room for doubt.
      real(dp), parameter :: node_bytes = 500.0_dp, factor_bytes = 96.0_dp
      real(dp) :: n_nodes, megabytes

      n_nodes = real(cells(1) + 1, dp)*real(cells(2) + 1, dp)*merge(3.0_dp, 1.0_dp, is_quadratic)
      megabytes = 1.0e-6_dp*n_nodes*(node_bytes + factor_bytes*log(1.0_dp + minval(cells))/log(2.0_dp))
      if (megabytes <= available_memory_mb()) return
      call new_error(error, system_failure, 'rectangle: not enough memory: '//to_text(nint(n_nodes, int64))// &
         ' nodes need at least '//to_text(nint(megabytes, int64))//' MB, and '// &
         to_text(nint(available_memory_mb(), int64))//' MB are available')
   end subroutine check_memory

   !> Places the nodes row by row, from the lower left corner.
   pure subroutine place_nodes(mesh, rectangle)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      type(rectangle_t), intent(in) :: rectangle !! the rectangle
      real(dp) :: height(0:rectangle%cells(2)), ratio
      integer :: i, j, nx, ny

      nx = rectangle%cells(1)
      ny = rectangle%cells(2)
      ratio = 1.0_dp
      if (ny > 1) ratio = rectangle%grading**(1.0_dp/real(ny - 1, dp))
      height(0) = 0.0_dp
      do j = 1, ny
         height(j) = height(j - 1) + ratio**(j - 1)
      end do
      height = height*(rectangle%size(2)/height(ny))
      ! Even rows are placed by number, so that no rounding piles up.
      if (.not. abs(rectangle%grading - 1.0_dp) > 0.0_dp) height = [(rectangle%size(2)*j/ny, j=0, ny)]

      mesh%n_nodes = (nx + 1)*(ny + 1)
      allocate (mesh%coordinates(2, mesh%n_nodes))
      do j = 0, ny
         do i = 0, nx
            mesh%coordinates(:, 1 + i + j*(nx + 1)) = [rectangle%size(1)*i/nx, height(j)]
         end do
      end do
   end subroutine place_nodes

   !> Connects the nodes to quadrilaterals, or to two triangles a cell.
   pure subroutine connect_cells(mesh, rectangle, kind)
      type(mesh_t), intent(inout) :: mesh !! the mesh, its nodes placed
      type(rectangle_t), intent(in) :: rectangle !! the rectangle
      integer, intent(in) :: kind !! kind of the elements
      integer :: corner(4), i, j, cell, element

      mesh%n_elements = product(rectangle%cells)*merge(2, 1, kind == tri3)
      allocate (mesh%element_kind(mesh%n_elements), source=kind)
      mesh%node_start = [(1 + n_element_nodes(kind)*element, element=0, mesh%n_elements)]
      allocate (mesh%node(n_element_nodes(kind)*mesh%n_elements))
      cell = 0
      do j = 1, rectangle%cells(2)
         do i = 1, rectangle%cells(1)
            corner(1) = i + (j - 1)*(rectangle%cells(1) + 1)
            corner(2:4) = corner(1) + [1, rectangle%cells(1) + 2, rectangle%cells(1) + 1]
            if (kind == quad4) then
               mesh%node(4*cell + 1:4*cell + 4) = corner
            else if (is_right(rectangle%diagonal, i, j)) then
               mesh%node(6*cell + 1:6*cell + 6) = corner([1, 2, 3, 3, 4, 1])
            else
               mesh%node(6*cell + 1:6*cell + 6) = corner([4, 1, 2, 2, 3, 4])
            end if
            cell = cell + 1
         end do
      end do
   end subroutine connect_cells

   !> Whether the diagonal of a cell runs from its lower left to its upper right corner.
   pure logical function is_right(diagonal, i, j)
      character(*), intent(in) :: diagonal !! 'right', 'left' or 'alternating'
      integer, intent(in) :: i !! column of the cell
      integer, intent(in) :: j !! row of the cell

      is_right = diagonal == 'right' .or. (diagonal == 'alternating' .and. mod(i + j, 2) == 0)
   end function is_right

   !> Names the four sides; the sides of a set follow each other counter-clockwise around the rectangle.
   pure subroutine name_sides(mesh, cells, kind, diagonal)
      type(mesh_t), intent(inout) :: mesh !! the mesh, its elements connected
      integer, intent(in) :: cells(2) !! number of cells along x and y
      integer, intent(in) :: kind !! kind of the elements
      character(*), intent(in) :: diagonal !! how triangles halve a cell
      integer :: i, j

      allocate (mesh%sets(4))
      mesh%sets(1) = new_set('left', [(1, j, j=cells(2), 1, -1)], 4)
      mesh%sets(2) = new_set('right', [(cells(1), j, j=1, cells(2))], 2)
      mesh%sets(3) = new_set('bottom', [(i, 1, i=1, cells(1))], 1)
      mesh%sets(4) = new_set('top', [(i, cells(2), i=cells(1), 1, -1)], 3)

   contains

      !> A boundary set of one side of each of the given cells.
      pure function new_set(name, columns_and_rows, cell_side) result(set)
         character(*), intent(in) :: name !! name of the set
         integer, intent(in) :: columns_and_rows(:) !! column and row of each cell, one after the other
         integer, intent(in) :: cell_side !! side of the cell: 1 bottom, 2 right, 3 top, 4 left
         type(boundary_set_t) :: set
         integer :: cell, column, row, k

         set%name = name
         allocate (set%element(size(columns_and_rows)/2), set%side(size(columns_and_rows)/2))
         do k = 1, size(set%element)
            column = columns_and_rows(2*k - 1)
            row = columns_and_rows(2*k)
            cell = column + (row - 1)*cells(1)
            if (kind == quad4) then
               set%element(k) = cell
               set%side(k) = cell_side
            else if (is_right(diagonal, column, row)) then
               ! first triangle: bottom, right, diagonal; second: top, left, diagonal
               set%element(k) = 2*cell - merge(1, 0, cell_side < 3)
               set%side(k) = mod(cell_side - 1, 2) + 1
            else
               ! first triangle: left, bottom, diagonal; second: right, top, diagonal
               set%element(k) = 2*cell - merge(1, 0, cell_side == 1 .or. cell_side == 4)
               set%side(k) = merge(1, 2, cell_side == 4 .or. cell_side == 2)
            end if
         end do
      end function new_set

   end subroutine name_sides

end module amontons_rectangle
