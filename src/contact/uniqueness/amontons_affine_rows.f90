!> Affine functions in the rows of a matrix, the constant in column 0: elimination of unknowns by equations, and what
!> inequalities allow. Numbers should be about 1.
module amontons_affine_rows
   use amontons_complementarity, only: lemke_pivoting, pivoting_solved
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: eliminate, has_extent, loose, no_pivot

   !> Smaller factors are rounding errors.
   real(dp), parameter :: no_pivot = 1.0e-11_dp
   !> What pivots that are not much larger leave of rounding errors in a value.
   real(dp), parameter :: loose = 1.0e-7_dp

contains

   !> Eliminates unknowns by the equations in the last rows, the largest pivot first; those without a pivot are left to
   !> points to come.
   pure subroutine eliminate(rows, n_kept, n_equations, n_left, least_pivot, is_possible, &
      is_singular)
      real(dp), intent(inout) :: rows(:, 0:)
         !! the rows; on return equations and unknowns that are left follow those before them without gaps
      integer, intent(in) :: n_kept !! number of the first unknowns, which are not to be eliminated
      integer, intent(in) :: n_equations !! number of equations, and of the unknowns to be eliminated
      integer, intent(out) :: n_left !! number of equations and unknowns that are left
      real(dp), intent(in) :: least_pivot !! least pivot
      logical, intent(out) :: is_possible !! false if an equation that is left contradicts itself
      logical, intent(out) :: is_singular !! whether an equation that is left says nothing, whatever the points to come
      integer :: at(2), first, row, column, j, i

      first = size(rows, 1) - n_equations
      do n_left = n_equations, 1, -1
         associate (equations => rows(first + 1:first + n_left, n_kept + 1:n_kept + n_left))
            at = maxloc(abs(equations))
            if (.not. abs(equations(at(1), at(2))) > least_pivot) exit
         end associate
         row = first + at(1)
         column = n_kept + at(2)
         rows([row, first + n_left], :) = rows([first + n_left, row], :)
         rows(:, [column, n_kept + n_left]) = rows(:, [n_kept + n_left, column])
         row = first + n_left
         column = n_kept + n_left
         rows(row, :column) = rows(row, :column)/rows(row, column)
         do j = 0, column - 1
            rows(:row - 1, j) = rows(:row - 1, j) - rows(:row - 1, column)*rows(row, j)
         end do
      end do
      is_possible = .true.
      is_singular = .false.
      do i = first + 1, first + n_left
         if (any(abs(rows(i, 1:n_kept + n_left)) > no_pivot)) cycle
         is_singular = .true.
         is_possible = is_possible .and. abs(rows(i, 0)) <= loose
      end do
   end subroutine eliminate

   !> Whether inequalities hold for more than one point: whether a linear function of the unknowns without any symmetry
   !> has different values among them. Its extremes are linear programs, their optimality conditions are
   !> complementarity problems.
   pure logical function has_extent(inequalities)
      real(dp), intent(in) :: inequalities(:, 0:) !! constants and factors of the inequalities (k, 0:n)
      real(dp), parameter :: far = 1.0e3_dp, slack = 1.0e-9_dp, golden = 0.61803398874989485_dp
      real(dp), dimension(size(inequalities, 1) + 2*ubound(inequalities, 2)) :: right, cover, z
      real(dp) :: matrix(size(right), size(right)), slope(ubound(inequalities, 2)), extreme(2)
      logical :: is_basic(size(right))
      integer :: i, n, direction, outcome

      n = size(slope)
      has_extent = .false.
      cover = 1.0_dp + modulo([(golden*i, i=1, size(cover))], 1.0_dp)
      slope = 0.5_dp + modulo([(golden*i, i=1, n)], 1.0_dp)
      associate (upper => size(right) - n)
         ! z holds the unknowns, moved by `far` so as to be positive, and the multipliers of inequalities and of upper
         ! bounds.
         matrix = 0.0_dp
         matrix(n + 1:upper, :n) = inequalities(:, 1:)
         right(n + 1:upper) = inequalities(:, 0) + slack - far*sum(inequalities(:, 1:), dim=2)
         do i = 1, n
            matrix(upper + i, i) = -1.0_dp
         end do
         right(upper + 1:) = 2.0_dp*far
      end associate
      matrix(:n, n + 1:) = -transpose(matrix(n + 1:, :n))
      do direction = 1, 2
         right(:n) = merge(slope, -slope, direction == 1)
         call lemke_pivoting(matrix, right, cover, is_basic, z, outcome)
         if (outcome /= pivoting_solved) return
         extreme(direction) = dot_product(slope, z(:n))
      end do
      has_extent = extreme(2) - extreme(1) > sqrt(slack)
   end function has_extent

end module amontons_affine_rows
