!> The steps of a substitution that belong to one dense block of columns of a sparse factor.
module amontons_supernode
   use amontons_kinds, only: dp
   use amontons_lapack, only: dgemm, dgemv, dtrsm, dtrsv
   implicit none (type, external)
   private

   public :: backward_columns, forward_columns

   !> Blocks of at most so many columns are faster without BLAS, whose calls have a lock for all threads; measured.
   integer, parameter :: most_narrow = 16

contains

   !> Does the forward steps of some columns: x_1 := L_11^-1 x_1, x_2 := x_2 - L_21 x_1.
   pure subroutine forward_columns(n_rows, n_columns, l, x)
      integer, intent(in) :: n_rows !! how many rows, those of L_11 first
      integer, intent(in) :: n_columns !! how many columns
      real(dp), intent(in) :: l(n_rows, n_columns) !! the columns of L
      real(dp), intent(inout) :: x(n_rows) !! the vector on the rows
      integer :: j

      if (n_columns > most_narrow) then
         call dtrsv('L', 'N', 'N', n_columns, l, n_rows, x, 1)
         if (n_rows > n_columns) call dgemv('N', n_rows - n_columns, n_columns, -1.0_dp, l(n_columns + 1, 1), n_rows, &
            x, 1, 1.0_dp, x(n_columns + 1), 1)
         return
      end if
      do j = 1, n_columns
         x(j) = x(j)/l(j, j)
         x(j + 1:) = x(j + 1:) - x(j)*l(j + 1:, j)
      end do
   end subroutine forward_columns

   !> Does the backward steps of some columns: x_1 := L_11^-T (x_1 - L_21^T x_2).
   pure subroutine backward_vector(n_rows, n_columns, l, x)
      integer, intent(in) :: n_rows !! how many rows, those of L_11 first
      integer, intent(in) :: n_columns !! how many columns
      real(dp), intent(in) :: l(n_rows, n_columns) !! the columns of L
      real(dp), intent(inout) :: x(n_rows) !! the vector on the rows
      real(dp) :: taken
      integer :: i, j

      if (n_columns > most_narrow) then
         if (n_rows > n_columns) call dgemv('T', n_rows - n_columns, n_columns, -1.0_dp, l(n_columns + 1, 1), n_rows, &
            x(n_columns + 1), 1, 1.0_dp, x, 1)
         call dtrsv('L', 'T', 'N', n_columns, l, n_rows, x, 1)
         return
      end if
      do j = n_columns, 1, -1
         taken = 0.0_dp
         !$omp simd reduction(+:taken)
         do i = j + 1, n_rows
            taken = taken + l(i, j)*x(i)
         end do
         x(j) = (x(j) - taken)/l(j, j)
      end do
   end subroutine backward_vector

   !> Does the backward steps of some columns for several vectors, with one pass over the columns.
   pure subroutine backward_columns(n_rows, n_columns, n_vectors, l, x)
      integer, intent(in) :: n_rows !! how many rows, those of L_11 first
      integer, intent(in) :: n_columns !! how many columns
      integer, intent(in) :: n_vectors !! how many vectors
      real(dp), intent(in) :: l(n_rows, n_columns) !! the columns of L
      real(dp), intent(inout) :: x(n_rows, n_vectors) !! the vectors on the rows
      integer :: k

      if (n_vectors > 1 .and. n_columns > most_narrow) then
         if (n_rows > n_columns) call dgemm('T', 'N', n_columns, n_vectors, n_rows - n_columns, -1.0_dp, &
            l(n_columns + 1, 1), n_rows, x(n_columns + 1, 1), n_rows, 1.0_dp, x, n_rows)
         call dtrsm('L', 'L', 'T', 'N', n_columns, n_vectors, 1.0_dp, l, n_rows, x, n_rows)
         return
      end if
      ! Few columns stay in the cache from one vector to the next.
      do k = 1, n_vectors
         call backward_vector(n_rows, n_columns, l, x(:, k))
      end do
   end subroutine backward_columns

end module amontons_supernode
