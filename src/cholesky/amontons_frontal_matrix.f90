!> The dense work on one front: its pivot columns, and the contribution block that their elimination leaves.
!>
!> A contribution block is a lower triangle in panels of columns, each panel full from the first row of its first column
!> on.
module amontons_frontal_matrix
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dgemm, dpotrf, dsyrk, dtrsm
   use amontons_sparse_matrix, only: sparse_matrix_t
   implicit none (type, external)
   private

   public :: add_to_contribution, add_to_pivots, contribution_size, eliminate_pivots, fill_pivots

   !> Number of columns of a panel; measured, like the two below.
   integer, parameter :: panel = 256
   !> Lower triangles of at most this order are computed as full matrices.
   integer, parameter :: narrow = 96
   !> So many columns are factorized at once.
   integer, parameter :: few = 24

contains

   !> Fills the pivot columns with those of the matrix.
   pure subroutine fill_pivots(matrix, first, n_rows, n_pivots, block)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: first !! the first column
      integer, intent(in) :: n_rows !! number of rows
      integer, intent(in) :: n_pivots !! number of pivot columns
      real(dp), intent(out) :: block(n_rows, n_pivots) !! the pivot columns
      integer(int64) :: at
      integer :: j

      block = 0.0_dp
      do j = 1, n_pivots
         do at = matrix%column_start(first - 1 + j), matrix%column_start(first + j) - 1
            block(matrix%row(at), j) = matrix%value(at)
         end do
      end do
   end subroutine fill_pivots

   !> How many numbers a contribution block has.
   pure integer(int64) function contribution_size(n_structure)
      integer, intent(in) :: n_structure !! number of unknowns in the row structure

      contribution_size = row_0(n_structure, n_structure) + n_structure
   end function contribution_size

   !> Where row 0 of a column of a contribution block would be.
   pure integer(int64) function row_0(n, j)
      integer, intent(in) :: n !! order of the contribution block
      integer, intent(in) :: j !! number of the column
      integer(int64) :: before

      before = (j - 1)/panel*panel
      row_0 = before*n - before*(before - panel)/2 + (j - 1 - before)*(n - before) - before
   end function row_0

   !> Adds the contribution block of a child to the pivot columns of its parent.
   pure subroutine add_to_pivots(row, s, n_pivots, n_rows, block)
      integer, intent(in) :: row(:) !! row of the parent of each row of the child's block
      real(dp), contiguous, intent(in) :: s(:) !! the child's block
      integer, intent(in) :: n_pivots !! number of pivot columns
      integer, intent(in) :: n_rows !! number of rows of the parent
      real(dp), contiguous, intent(inout) :: block(:) !! the pivot columns
      integer :: run_end(size(row)), j

      run_end = run_ends(row)
      do j = 1, size(row)
         if (row(j) > n_pivots) exit
         call add_column(row, run_end, j, row_0(size(row), j), s, (row(j) - 1)*int(n_rows, int64), block)
      end do
   end subroutine add_to_pivots

   !> Adds the contribution block of a child to that of its parent.
   pure subroutine add_to_contribution(row, s, n_pivots, n_structure, sum)
      integer, intent(in) :: row(:) !! row of the parent of each row of the child's block
      real(dp), contiguous, intent(in) :: s(:) !! the child's block
      integer, intent(in) :: n_pivots !! number of pivot columns of the parent
      integer, intent(in) :: n_structure !! number of items of its row structure
      real(dp), contiguous, intent(inout) :: sum(:) !! the parent's block
      integer :: run_end(size(row)), j

      run_end = run_ends(row)
      do j = count(row <= n_pivots) + 1, size(row)
         call add_column(row, run_end, j, row_0(size(row), j), s, row_0(n_structure, row(j) - n_pivots) - n_pivots, sum)
      end do
   end subroutine add_to_contribution

   !> Where the run of consecutive rows ends that each row is in.
   pure function run_ends(row) result(run_end)
      integer, intent(in) :: row(:) !! the rows
      integer :: run_end(size(row))
      integer :: i

      do i = size(row), 1, -1
         run_end(i) = i
         if (i == size(row)) cycle
         if (row(i + 1) == row(i) + 1) run_end(i) = run_end(i + 1)
      end do
   end function run_ends

   !> Adds a column of a child's block, from its diagonal on, to a column of the parent.
   pure subroutine add_column(row, run_end, j, s_0, s, sum_0, sum)
      integer, intent(in) :: row(:) !! row of the parent of each row of the child's block
      integer, intent(in) :: run_end(:) !! where the run of each ends
      integer, intent(in) :: j !! number of the column
      integer(int64), intent(in) :: s_0 !! where its row 0 would be
      real(dp), contiguous, intent(in) :: s(:) !! the child's block
      integer(int64), intent(in) :: sum_0 !! where row 0 of the parent's column would be
      real(dp), contiguous, intent(inout) :: sum(:) !! what gains it
      integer :: i, last

      i = j
      do while (i <= size(row))
         last = run_end(i)
         associate (to => sum_0 + row(i))
            sum(to:to + last - i) = sum(to:to + last - i) + s(s_0 + i:s_0 + last)
         end associate
         i = last + 1
      end do
   end subroutine add_column

   !> Factorizes the pivot columns, L_11 L_11^T = F_pp and L_21 = F_bp L_11^-T, and leaves -L_21 L_21^T.
   pure subroutine eliminate_pivots(n_rows, n_pivots, block, s, info)
      integer, intent(in) :: n_rows !! number of rows
      integer, intent(in) :: n_pivots !! number of pivot columns
      real(dp), intent(inout) :: block(n_rows, n_pivots) !! the pivot columns
      real(dp), intent(out) :: s(contribution_size(n_rows - n_pivots)) !! the contribution block
      integer, intent(out) :: info !! 0, or which column has a pivot that is not positive
      integer(int64) :: at
      integer :: j, lds

      call factorize_columns(n_rows, n_rows, n_pivots, block, info)
      if (info > 0) return
      do j = 1, n_rows - n_pivots, panel
         lds = n_rows - n_pivots - j + 1
         at = row_0(n_rows - n_pivots, j) + j
         if (lds <= narrow) then
            ! In so small a matrix the upper triangle costs less than the bookkeeping of leaving it out.
            call dgemm('N', 'T', lds, lds, n_pivots, -1.0_dp, block(n_pivots + j, 1), n_rows, block(n_pivots + j, 1), &
               n_rows, 0.0_dp, s(at), lds)
         else
            call dsyrk('L', 'N', min(panel, lds), n_pivots, -1.0_dp, block(n_pivots + j, 1), n_rows, 0.0_dp, s(at), lds)
         end if
         if (lds > panel) call dgemm('N', 'T', lds - panel, panel, n_pivots, -1.0_dp, block(n_pivots + j + panel, 1), &
            n_rows, block(n_pivots + j, 1), n_rows, 0.0_dp, s(at + panel), lds)
      end do
   end subroutine eliminate_pivots

   !> Factorizes columns: the left half, what it does to the right half, the right half. Most of the work is products of
   !> matrices that way, which a BLAS does faster than it solves with a triangle.
   pure recursive subroutine factorize_columns(ld, n_rows, n, l, info)
      integer, intent(in) :: ld !! distance between columns
      integer, intent(in) :: n_rows !! number of rows
      integer, intent(in) :: n !! number of columns
      real(dp), intent(inout) :: l(ld, n) !! the columns; on return those of L
      integer, intent(out) :: info !! 0, or which column has a pivot that is not positive
      integer :: half

      if (n <= few) then
         call dpotrf('L', n, l, ld, info)
         if (info == 0 .and. n_rows > n) call dtrsm('R', 'L', 'T', 'N', n_rows - n, n, 1.0_dp, l, ld, l(n + 1, 1), ld)
         return
      end if
      half = n/2
      call factorize_columns(ld, n_rows, half, l, info)
      if (info > 0) return
      call dgemm('N', 'T', n_rows - half, n - half, half, -1.0_dp, l(half + 1, 1), ld, l(half + 1, 1), ld, 1.0_dp, &
         l(half + 1, half + 1), ld)
      call factorize_columns(ld, n_rows - half, n - half, l(half + 1, half + 1), info)
      if (info > 0) info = info + half
   end subroutine factorize_columns

end module amontons_frontal_matrix
