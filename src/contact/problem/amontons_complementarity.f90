!> Lemke's complementary pivoting for the linear complementarity problem
!> `w = q + M z, w >= 0, z >= 0, w^T z = 0` (Cottle, Pang, Stone: The Linear Complementarity Problem, 1992,
!> section 4.4).
!>
!> A covering vector c > 0 turns the problem into one that a large number z_0 solves, `w = q + M z + c z_0`, z = 0. The
!> pivots follow the solutions from there, one pair of variables after the other, until z_0 is zero or the path leaves
!> on a ray. Ties are broken by the lexicographic rule, so that no basis comes twice.
module amontons_complementarity
   use amontons_contact_solution, only: effort_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: lemke_pivoting, pivoting_ray, pivoting_solved

   !> The pivots ended with z_0 = 0.
   integer, parameter :: pivoting_solved = 0
   !> The path left on a ray.
   integer, parameter :: pivoting_ray = 1
   !> More pivots than allowed; with exact numbers this cannot happen below the number of all bases.
   integer, parameter :: pivoting_stopped = 2

   !> Basic variables as affine functions of the nonbasic ones. Variables are numbered: w from 1 to n, z from n + 1 to
   !> 2n, z_0 is 2n + 1.
   type :: tableau_t
      integer :: n = 0 !! order of the problem
      real(dp), allocatable :: entry(:, :) !! factor of each nonbasic variable; in column 0 the constant (n, 0:n + 1)
      integer, allocatable :: basic(:) !! the variable of each row (n)
      integer, allocatable :: nonbasic(:) !! the variable of each column (n + 1)
      integer, allocatable :: place(:) !! row of each basic variable, minus the column of each other one (2n + 1)
   end type tableau_t

contains

   !> Finds a solution; a basis tells which of each pair of variables may differ from zero.
   !>
   !> Numbers of the matrix and of the right-hand side should be about 1: what is far below counts as zero.
   pure subroutine lemke_pivoting(matrix, right, cover, is_z_basic, z, outcome, effort)
      real(dp), intent(in) :: matrix(:, :) !! M (n, n)
      real(dp), intent(in) :: right(:) !! q (n)
      real(dp), intent(in) :: cover(:) !! c, positive (n)
      logical, intent(out) :: is_z_basic(:) !! whether z_i is basic at the end, w_i nonbasic then (n)
      real(dp), intent(out) :: z(:) !! z at the end, with the rounding errors of all pivots (n)
      integer, intent(out) :: outcome !! `pivoting_solved`, `pivoting_ray` or `pivoting_stopped`
      type(effort_t), intent(inout), optional :: effort
         !! gains a product with M for each pivot, and a factorization for each tableau made anew
      integer, parameter :: pivots_per_row = 50
      type(tableau_t) :: tableau
      integer :: i, n_pivots, row, column, entering, leaving

      z = 0.0_dp
      is_z_basic = .false.
      outcome = pivoting_solved
      if (all(right >= 0.0_dp)) return
      call new_tableau(tableau, matrix, right, cover)
      ! Of rows that tie the last one is least in the lexicographic order.
      row = minloc(right/cover, dim=1, back=.true.)
      column = tableau%n + 1
      outcome = pivoting_stopped
      do n_pivots = 1, pivots_per_row*(tableau%n + 20)
         leaving = tableau%basic(row)
         call exchange(tableau, row, column)
         if (present(effort)) call effort%multiply(1.0_dp)
         if (leaving == 2*tableau%n + 1) then
            outcome = pivoting_solved
            exit
         end if
         ! Rounding errors of one basis pass to the next, and a fresh tableau costs up to n pivots.
         if (modulo(n_pivots, 100 + tableau%n) == 0) then
            call refresh(tableau, matrix, right, cover)
            if (present(effort)) call effort%factorize(.true.)
         end if
         entering = merge(leaving - tableau%n, leaving + tableau%n, leaving > tableau%n)
         column = -tableau%place(entering)
         row = leaving_row(tableau, column)
         if (row == 0) then
            outcome = pivoting_ray
            exit
         end if
      end do
      do i = 1, tableau%n
         row = tableau%place(tableau%n + i)
         is_z_basic(i) = row > 0
         if (row > 0) z(i) = tableau%entry(row, 0)
      end do
   end subroutine lemke_pivoting

   !> The tableau with w basic.
   pure subroutine new_tableau(tableau, matrix, right, cover)
      type(tableau_t), intent(out) :: tableau !! the tableau
      real(dp), intent(in) :: matrix(:, :) !! M (n, n)
      real(dp), intent(in) :: right(:) !! q (n)
      real(dp), intent(in) :: cover(:) !! c (n)
      integer :: i, n

      n = size(right)
      tableau%n = n
      allocate (tableau%entry(n, 0:n + 1))
      tableau%entry(:, 0) = right
      tableau%entry(:, 1:n) = matrix
      tableau%entry(:, n + 1) = cover
      tableau%basic = [(i, i=1, n)]
      tableau%nonbasic = [(n + i, i=1, n + 1)]
      tableau%place = [(i, i=1, n), (-i, i=1, n + 1)]
   end subroutine new_tableau

   !> Makes the nonbasic variable of a column basic and the basic one of a row nonbasic.
   pure subroutine exchange(tableau, row, column)
      type(tableau_t), intent(inout) :: tableau !! the tableau
      integer, intent(in) :: row !! the row
      integer, intent(in) :: column !! the column
      real(dp) :: pivot_row(0:tableau%n + 1), pivot_column(tableau%n), pivot
      integer :: j, leaving

      associate (entry => tableau%entry)
         pivot = entry(row, column)
         pivot_column = entry(:, column)
         pivot_row = -entry(row, :)/pivot
         pivot_row(column) = 1.0_dp/pivot
         pivot_column(row) = 0.0_dp
         do j = 0, tableau%n + 1
            if (j == column) then
               entry(:, j) = pivot_column*pivot_row(j)
            else if (abs(pivot_row(j)) > 0.0_dp) then
               entry(:, j) = entry(:, j) + pivot_column*pivot_row(j)
            end if
         end do
         entry(row, :) = pivot_row
      end associate
      leaving = tableau%basic(row)
      tableau%basic(row) = tableau%nonbasic(column)
      tableau%nonbasic(column) = leaving
      tableau%place(tableau%basic(row)) = row
      tableau%place(leaving) = -column
   end subroutine exchange

   !> Makes the tableau anew from the data, with the largest pivot of each column.
   pure subroutine refresh(tableau, matrix, right, cover)
      type(tableau_t), intent(inout) :: tableau !! the tableau; its basis stays
      real(dp), intent(in) :: matrix(:, :) !! M (n, n)
      real(dp), intent(in) :: right(:) !! q (n)
      real(dp), intent(in) :: cover(:) !! c (n)
      type(tableau_t) :: fresh
      logical :: may_leave(size(right))
      integer :: i, row

      call new_tableau(fresh, matrix, right, cover)
      may_leave = tableau%place(:fresh%n) < 0
      do i = fresh%n + 1, 2*fresh%n + 1
         if (tableau%place(i) < 0) cycle
         row = maxloc(abs(fresh%entry(:, -fresh%place(i))), dim=1, mask=may_leave)
         may_leave(row) = .false.
         call exchange(fresh, row, -fresh%place(i))
      end do
      tableau = fresh
   end subroutine refresh

   !> The row whose variable reaches zero first as the variable of a column grows; 0 if none does. z_0 goes before all
   !> others, these in the lexicographic order.
   pure integer function leaving_row(tableau, column) result(row)
      type(tableau_t), intent(in) :: tableau !! the tableau
      integer, intent(in) :: column !! the column
      ! Data about 1 leave rounding errors of some 1e-14 in the tableau.
      real(dp), parameter :: negligible = 1.0e-11_dp, tie = 1.0e-12_dp
      logical :: is_candidate(tableau%n)
      real(dp) :: factor(tableau%n), value(tableau%n), least
      integer :: k, place

      row = 0
      factor = -tableau%entry(:, column)
      is_candidate = factor > negligible*max(1.0_dp, maxval(abs(factor)))
      if (.not. any(is_candidate)) return
      factor = merge(factor, 1.0_dp, is_candidate)
      value = max(0.0_dp, tableau%entry(:, 0))/factor
      least = minval(value, mask=is_candidate)
      is_candidate = is_candidate .and. value <= least + tie*max(1.0_dp, least)
      row = tableau%place(2*tableau%n + 1)
      if (is_candidate(row)) return
      do k = 1, tableau%n
         if (count(is_candidate) == 1) exit
         ! What a small growth of q_k adds to each basic variable.
         place = tableau%place(k)
         if (place < 0) then
            value = -tableau%entry(:, -place)/factor
         else
            value = 0.0_dp
            value(place) = 1.0_dp/factor(place)
         end if
         least = minval(value, mask=is_candidate)
         is_candidate = is_candidate .and. value <= least + tie*max(1.0_dp, abs(least))
      end do
      row = findloc(is_candidate, .true., dim=1)
   end function leaving_row

end module amontons_complementarity
