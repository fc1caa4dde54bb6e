!> Matrices whose inverses are known, and reproducible arbitrary ones.
module sample_matrices
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_sparse_matrix, only: new_sparse_pattern, sparse_matrix_t
   implicit none (type, external)
   private

   public :: arbitrary_matrix, arbitrary_numbers, chain_inverse, chain_matrix, dense_matrix, grid_matrix, &
      grid_places, plate_matrix, plate_places, product_of, smallest_grid_eigenpair

contains

   !> Springs of stiffness 1 in a row, held at both ends: 2 on the diagonal, -1 beside it.
   subroutine chain_matrix(matrix, n)
      type(sparse_matrix_t), intent(out) :: matrix !! the matrix
      integer, intent(in) :: n !! number of unknowns

      call grid_matrix(matrix, n, 1)
      call matrix%shift_diagonal(1, n, -2.0_dp)
   end subroutine chain_matrix

   !> The inverse of `chain_matrix`: entry (i, j) is min(i, j) (n + 1 - max(i, j)) / (n + 1).
   pure function chain_inverse(n) result(inverse)
      integer, intent(in) :: n !! number of unknowns
      real(dp) :: inverse(n, n)
      integer :: i, j

      do j = 1, n
         do i = 1, n
            inverse(i, j) = real(min(i, j)*(n + 1 - max(i, j)), dp)/real(n + 1, dp)
         end do
      end do
   end function chain_inverse

   !> Springs of stiffness 1 between the neighbors of a grid, held all around: 4 on the diagonal.
   subroutine grid_matrix(matrix, n_columns, n_rows)
      type(sparse_matrix_t), intent(out) :: matrix !! the matrix; unknown i + (j - 1) n_columns sits at (i, j)
      integer, intent(in) :: n_columns !! points in a row
      integer, intent(in) :: n_rows !! number of rows
      real(dp), parameter :: coupling(2, 2) = reshape([0.0_dp, -1.0_dp, -1.0_dp, 0.0_dp], [2, 2])
      type(error_t), allocatable :: error
      integer :: pair(2, 2*n_columns*n_rows), n_pairs, i, j, k

      n_pairs = 0
      do j = 1, n_rows
         do i = 1, n_columns
            k = i + (j - 1)*n_columns
            if (i < n_columns) call append(k + 1)
            if (j < n_rows) call append(k + n_columns)
         end do
      end do
      call new_sparse_pattern(matrix, n_columns*n_rows, [(2*k - 1, k=1, n_pairs + 1)], [pair(:, :n_pairs)], error)
      do k = 1, n_pairs
         call matrix%add_element(pair(:, k), coupling)
      end do
      call matrix%shift_diagonal(1, matrix%n, 4.0_dp)

   contains

      !> Adds a spring between point k and another.
      subroutine append(other)
         integer, intent(in) :: other !! the other point

         n_pairs = n_pairs + 1
         pair(:, n_pairs) = [k, other]
      end subroutine append

   end subroutine grid_matrix

   !> Where the unknowns of `grid_matrix` sit.
   pure function grid_places(n_columns, n_rows) result(place)
      integer, intent(in) :: n_columns !! points in a row
      integer, intent(in) :: n_rows !! number of rows
      real(dp) :: place(2, n_columns*n_rows)
      integer :: i, j

      do j = 1, n_rows
         do i = 1, n_columns
            place(:, i + (j - 1)*n_columns) = real([i, j], dp)
         end do
      end do
   end function grid_places

   !> The lowest eigenvector of `grid_matrix`, a half wave in each direction, and its eigenvalue.
   pure subroutine smallest_grid_eigenpair(n_columns, n_rows, value, vector)
      integer, intent(in) :: n_columns !! points in a row
      integer, intent(in) :: n_rows !! number of rows
      real(dp), intent(out) :: value !! the eigenvalue
      real(dp), intent(out) :: vector(:) !! the eigenvector (n_columns n_rows)
      real(dp), parameter :: pi = acos(-1.0_dp)
      integer :: i, j

      do j = 1, n_rows
         do i = 1, n_columns
            vector(i + (j - 1)*n_columns) = sin(pi*i/(n_columns + 1))*sin(pi*j/(n_rows + 1))
         end do
      end do
      value = 4.0_dp - 2.0_dp*cos(pi/(n_columns + 1)) - 2.0_dp*cos(pi/(n_rows + 1))
   end subroutine smallest_grid_eigenpair

   !> A square of cells with two unknowns per corner, like a plate in plane strain; the first row of corners comes last.
   subroutine plate_matrix(matrix, n_cells)
      type(sparse_matrix_t), intent(out) :: matrix !! the matrix, 2 (n_cells + 1)^2 unknowns
      integer, intent(in) :: n_cells !! cells along a side
      integer, parameter :: n_cell_unknowns = 8
      type(error_t), allocatable :: error
      integer :: corner(0:n_cells, 0:n_cells), cell(4), list(n_cell_unknowns, n_cells**2), i, j, k

      corner = reshape([(k, k=1, (n_cells + 1)**2)], shape(corner))
      corner = cshift(corner, -1, dim=2)
      do j = 1, n_cells
         do i = 1, n_cells
            cell = [corner(i - 1, j - 1), corner(i, j - 1), corner(i, j), corner(i - 1, j)]
            list(1::2, i + (j - 1)*n_cells) = 2*cell - 1
            list(2::2, i + (j - 1)*n_cells) = 2*cell
         end do
      end do
      call new_sparse_pattern(matrix, 2*size(corner), [(1 + n_cell_unknowns*(k - 1), k=1, n_cells**2 + 1)], [list], &
         error)
      call add_blocks(matrix, list)
   end subroutine plate_matrix

   !> Where the unknowns of `plate_matrix` sit.
   pure function plate_places(n_cells) result(place)
      integer, intent(in) :: n_cells !! cells along a side
      real(dp) :: place(2, 2*(n_cells + 1)**2)

      place(:, 1::2) = grid_places(n_cells + 1, n_cells + 1)
      ! The first row of corners comes last.
      place(2, 1::2) = modulo(place(2, 1::2), real(n_cells + 1, dp))
      place(:, 2::2) = place(:, 1::2)
   end function plate_places

   !> Blocks that couple unknowns all over the place; some unknowns may have none, some elements lack an unknown.
   subroutine arbitrary_matrix(matrix, n, n_elements)
      type(sparse_matrix_t), intent(out) :: matrix !! the matrix, positive definite
      integer, intent(in) :: n !! number of unknowns
      integer, intent(in) :: n_elements !! number of elements, four unknowns each
      type(error_t), allocatable :: error
      integer :: list(4, n_elements), k

      list = int(reshape((n + 1)*(0.5_dp + 0.5_dp*arbitrary_numbers(4*n_elements)), shape(list)))
      do k = 2, 4
         ! An element names an unknown once.
         where (any(list(:k - 1, :) == spread(list(k, :), 1, k - 1), dim=1)) list(k, :) = 0
      end do
      call new_sparse_pattern(matrix, n, [(4*k - 3, k=1, n_elements + 1)], [list], error)
      call add_blocks(matrix, list)
      call matrix%shift_diagonal(1, n, 1.0_dp)
   end subroutine arbitrary_matrix

   !> Adds an arbitrary positive definite block for each element.
   subroutine add_blocks(matrix, list)
      type(sparse_matrix_t), intent(inout) :: matrix !! the matrix
      integer, intent(in) :: list(:, :) !! unknowns of the elements (n_unknowns, n_elements)
      real(dp) :: block(size(list, 1), size(list, 1)), numbers(size(list, 1)**2*size(list, 2))
      integer :: i, k, m

      m = size(list, 1)
      numbers = arbitrary_numbers(size(numbers))
      do k = 1, size(list, 2)
         block = reshape(numbers(m*m*(k - 1) + 1:m*m*k), shape(block))
         block = matmul(block, transpose(block))
         do i = 1, m
            block(i, i) = block(i, i) + 0.1_dp
         end do
         call matrix%add_element(list(:, k), block)
      end do
   end subroutine add_blocks

   !> Numbers between -1 and 1 without visible order, the same every time.
   pure function arbitrary_numbers(n) result(numbers)
      integer, intent(in) :: n !! how many
      real(dp) :: numbers(n)
      integer :: i

      do i = 1, n
         numbers(i) = 2.0_dp*modulo(43758.5453123_dp*sin(12.9898_dp*i), 1.0_dp) - 1.0_dp
      end do
   end function arbitrary_numbers

   !> A sparse matrix with all its entries written out.
   pure function dense_matrix(matrix) result(dense)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      real(dp) :: dense(matrix%n, matrix%n)
      integer :: j, k

      dense = 0.0_dp
      do j = 1, matrix%n
         do k = int(matrix%column_start(j)), int(matrix%column_start(j + 1)) - 1
            dense(matrix%row(k), j) = matrix%value(k)
            dense(j, matrix%row(k)) = matrix%value(k)
         end do
      end do
   end function dense_matrix

   !> The product of a matrix and one vector, the first of the two that the matrix multiplies.
   pure function product_of(matrix, x) result(y)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      real(dp), intent(in) :: x(:) !! the vector
      real(dp) :: y(size(x)), products(2, size(x))

      call matrix%multiply(spread(x, 1, 2), products)
      y = products(1, :)
   end function product_of

end module sample_matrices
