!> The matrix of one substructure: its own columns, and what their elimination leaves on the boundary.
!>
!> What is left is a lower triangle in panels of columns, each panel full from the first row of its first column on.
module amontons_frontal_matrix
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dgemm, dpotrf, dsyrk, dtrsm
   use amontons_sparse_matrix, only: sparse_matrix_t
   implicit none (type, external)
   private

   public :: add_to_boundary, add_to_own, eliminate_own, fill_own, n_remaining

   !> Number of columns of a panel; measured, like the two below.
   integer, parameter :: panel = 256
   !> Lower triangles of at most this order are computed as full matrices.
   integer, parameter :: narrow = 96
   !> So many columns are factorised at once.
   integer, parameter :: few = 24

contains

   !> Fills the own columns with those of the matrix.
   pure subroutine fill_own(matrix, first, n_rows, n_own, block)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: first !! the first column
      integer, intent(in) :: n_rows !! number of rows
      integer, intent(in) :: n_own !! number of own unknowns
      real(dp), intent(out) :: block(n_rows, n_own) !! the own columns
      integer(int64) :: at
      integer :: j

      block = 0.0_dp
      do j = 1, n_own
         do at = matrix%column_start(first - 1 + j), matrix%column_start(first + j) - 1
            block(matrix%row(at), j) = matrix%value(at)
         end do
      end do
   end subroutine fill_own

   !> How many numbers are left on a boundary.
   pure integer(int64) function n_remaining(n_boundary)
      integer, intent(in) :: n_boundary !! number of unknowns on it

      n_remaining = row_0(n_boundary, n_boundary) + n_boundary
   end function n_remaining

   !> Where row 0 of a column of what is left would be.
   pure integer(int64) function row_0(n, j)
      integer, intent(in) :: n !! number of unknowns on the boundary
      integer, intent(in) :: j !! number of the column
      integer(int64) :: before

      before = (j - 1)/panel*panel
      row_0 = before*n - before*(before - panel)/2 + (j - 1 - before)*(n - before) - before
   end function row_0

   !> Adds what a part has left in the columns of the own unknowns.
   pure subroutine add_to_own(place, s, n_own, n_rows, block)
      integer, intent(in) :: place(:) !! the rows of the part's boundary
      real(dp), contiguous, intent(in) :: s(:) !! what it has left there, in panels
      integer, intent(in) :: n_own !! number of own unknowns
      integer, intent(in) :: n_rows !! number of rows
      real(dp), contiguous, intent(inout) :: block(:) !! the own columns
      integer :: run_end(size(place)), j

      run_end = run_ends(place)
      do j = 1, size(place)
         if (place(j) > n_own) exit
         call add_column(place, run_end, j, row_0(size(place), j), s, (place(j) - 1)*int(n_rows, int64), block)
      end do
   end subroutine add_to_own

   !> Adds what a part has left in the columns of the boundary.
   pure subroutine add_to_boundary(place, s, n_own, n_boundary, sum)
      integer, intent(in) :: place(:) !! the rows of the part's boundary
      real(dp), contiguous, intent(in) :: s(:) !! what it has left there, in panels
      integer, intent(in) :: n_own !! number of own unknowns of the substructure
      integer, intent(in) :: n_boundary !! number of its boundary unknowns
      real(dp), contiguous, intent(inout) :: sum(:) !! what it leaves, in panels
      integer :: run_end(size(place)), j

      run_end = run_ends(place)
      do j = count(place <= n_own) + 1, size(place)
         call add_column(place, run_end, j, row_0(size(place), j), s, row_0(n_boundary, place(j) - n_own) - n_own, sum)
      end do
   end subroutine add_to_boundary

   !> Where the run of consecutive rows ends that each row is in.
   pure function run_ends(place) result(run_end)
      integer, intent(in) :: place(:) !! the rows
      integer :: run_end(size(place))
      integer :: i

      do i = size(place), 1, -1
         run_end(i) = i
         if (i == size(place)) cycle
         if (place(i + 1) == place(i) + 1) run_end(i) = run_end(i + 1)
      end do
   end function run_ends

   !> Adds a column of what a part has left, from its diagonal on, to a column of the larger substructure.
   pure subroutine add_column(place, run_end, j, s_0, s, sum_0, sum)
      integer, intent(in) :: place(:) !! the rows of the part's boundary
      integer, intent(in) :: run_end(:) !! where the run of each ends
      integer, intent(in) :: j !! number of the column
      integer(int64), intent(in) :: s_0 !! where its row 0 would be
      real(dp), contiguous, intent(in) :: s(:) !! what is left
      integer(int64), intent(in) :: sum_0 !! where row 0 of the larger column would be
      real(dp), contiguous, intent(inout) :: sum(:) !! what gains it
      integer :: i, last

      i = j
      do while (i <= size(place))
         last = run_end(i)
         associate (to => sum_0 + place(i))
            sum(to:to + last - i) = sum(to:to + last - i) + s(s_0 + i:s_0 + last)
         end associate
         i = last + 1
      end do
   end subroutine add_column

   !> Factorises the own columns, L_11 L_11^T = F_pp and L_21 = F_bp L_11^-T, and leaves -L_21 L_21^T.
   pure subroutine eliminate_own(n_rows, n_own, block, s, info)
      integer, intent(in) :: n_rows !! number of rows
      integer, intent(in) :: n_own !! number of own unknowns
      real(dp), intent(inout) :: block(n_rows, n_own) !! the own columns
      real(dp), intent(out) :: s(n_remaining(n_rows - n_own)) !! lower triangle in panels
      integer, intent(out) :: info !! 0, or which own unknown has a pivot that is not positive
      integer(int64) :: at
      integer :: j, lds

      call factorize_columns(n_rows, n_rows, n_own, block, info)
      if (info > 0) return
      do j = 1, n_rows - n_own, panel
         lds = n_rows - n_own - j + 1
         at = row_0(n_rows - n_own, j) + j
         if (lds <= narrow) then
            ! In so small a matrix the upper triangle costs less than the bookkeeping of leaving it out.
            call dgemm('N', 'T', lds, lds, n_own, -1.0_dp, block(n_own + j, 1), n_rows, block(n_own + j, 1), n_rows, &
               0.0_dp, s(at), lds)
         else
            call dsyrk('L', 'N', min(panel, lds), n_own, -1.0_dp, block(n_own + j, 1), n_rows, 0.0_dp, s(at), lds)
         end if
         if (lds > panel) call dgemm('N', 'T', lds - panel, panel, n_own, -1.0_dp, block(n_own + j + panel, 1), &
            n_rows, block(n_own + j, 1), n_rows, 0.0_dp, s(at + panel), lds)
      end do
   end subroutine eliminate_own

   !> Factorises columns: the left half, what it does to the right half, the right half. Most of the work is products of
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
