!> A contact problem as one linear relation `y = h - H x` between forces and distances, in dimensionless numbers of
!> order 1, for the methods that decide point by point which condition of the law is active.
!>
!> w = (u_N - d; u_T - a) are the distances. In the dual form x is the force, y = w, H = A and h = B; in the primal form
!> x = w, y is the force, H = S and h = q - S (d; a). In both H is positive semidefinite; it is scaled to a unit
!> diagonal, and forces, distances and friction with it.
!>
!> Lemke's complementary pivoting for the linear complementarity problem `w = q + M z, w >= 0, z >= 0, w^T z = 0`
!> (Cottle, Pang, Stone: The Linear Complementarity Problem, 1992, section 4.4).
!>
!> A covering vector c > 0 makes it a problem that z = 0 and a large number z_0 solve, `w = q + M z + c z_0`. The pivots
!> follow the solutions from there, one pair of variables after the other, until z_0 is zero or the path ends on a ray.
!> Ties are broken by the lexicographic rule, so that no basis is repeated.
module amontons_contact_relation
   use amontons_contact_operator, only: new_dense_stiffness
   use amontons_contact_problem, only: active_set_t, contact_problem_t
   use amontons_contact_solution, only: effort_t
   use amontons_dense, only: allocate_matrix, cholesky_factor, cholesky_inverse, lu_solve
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_rounding, only: pivot_rounding, sum_rounding
   implicit none (type, external)
   private

   public :: contact_relation_t, lemke_pivoting, new_contact_relation, pivoting_ray, pivoting_solved

   !> The relation between forces and distances, with the friction of every point; all dimensionless.
   type :: contact_relation_t
      integer :: n_points = 0 !! number m of contact points
      logical :: is_dual = .true. !! whether x is the force
      real(dp), allocatable :: matrix(:, :) !! H, with the diagonal 1 or 0 (2m, 2m)
      real(dp), allocatable :: vector(:) !! h (2m)
      real(dp), allocatable :: friction(:) !! phi in the units of the relation (m)
      real(dp), allocatable :: slip_bound(:) !! g in the units of the relation (m)
      real(dp), allocatable :: force_unit(:) !! unit of each force (2m) [F]
      real(dp), allocatable :: distance_unit(:) !! unit of each distance (2m) [L]
   contains
      procedure :: invert => contact_relation_invert
      procedure :: solve_states => contact_relation_solve_states
      procedure :: violation => contact_relation_violation
   end type contact_relation_t

   !> Outcome of the pivoting: it ended with z_0 = 0.
   integer, parameter :: pivoting_solved = 0
   !> Outcome of the pivoting: the path ended on a ray.
   integer, parameter :: pivoting_ray = 1
   !> Outcome of the pivoting: the largest number of pivots was reached; in exact arithmetic impossible below the number
   !> of all bases.
   integer, parameter :: pivoting_stopped = 2

   !> Basic variables as affine functions of the nonbasic ones. Variables are numbered: w from 1 to n, z from n + 1 to
   !> 2n, z_0 is 2n + 1.
   type :: tableau_t
      integer :: n = 0 !! order of the problem
      real(dp), allocatable :: entry(:, :)
         !! factor of each nonbasic variable; in the last column the constant (n, n + 2)
      integer, allocatable :: basic(:) !! the variable of each row (n)
      integer, allocatable :: nonbasic(:) !! the variable of each column (n + 1)
      integer, allocatable :: place(:) !! row of each basic variable, minus the column of each other one (2n + 1)
   end type tableau_t

contains

   !> Makes the relation of a contact problem: primal if it has a stiffness, dual if it is a reduced problem.
   subroutine new_contact_relation(relation, problem, error)
      type(contact_relation_t), intent(out) :: relation !! the relation
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp) :: force(problem%matrix%n)
      integer :: i, j, m
      real(dp) :: unit(problem%matrix%n), amount

      relation%is_dual = .not. problem%matrix%has_stiffness()
      if (relation%is_dual) then
         associate (a => problem%matrix%compliance)
            call allocate_matrix(relation%matrix, a%n, a%n, 'the contact points', error)
            if (allocated(error)) return
            call a%fill_block([(i, i=1, a%n)], [(i, i=1, a%n)], relation%matrix)
         end associate
         relation%vector = problem%dual_load(problem%free_displacement)
      else
         call new_dense_stiffness(problem%matrix, relation%matrix, error)
         if (allocated(error)) return
         call problem%matrix%multiply_stiffness(problem%reference(), force)
         relation%vector = problem%load - force
      end if
      ! Rows whose diagonal is not positive are scaled by its largest entry, or by 1 if that is not positive.
      unit = [(relation%matrix(i, i), i=1, size(unit))]
      if (problem%matrix%n_tangents == 2) unit = problem%matrix%augmentation**merge(-1, 1, relation%is_dual)
      if (.not. any(unit > 0.0_dp)) unit = 1.0_dp
      unit = sqrt(merge(unit, maxval(unit), unit > 0.0_dp))
      amount = maxval(abs(relation%vector/unit))
      if (.not. amount > 0.0_dp) amount = 1.0_dp
      allocate (relation%distance_unit, source=merge(amount*unit, amount/unit, relation%is_dual))
      allocate (relation%force_unit, source=merge(amount/unit, amount*unit, relation%is_dual))
      relation%vector = relation%vector/(amount*unit)
      m = size(problem%friction)
      relation%n_points = m
      do j = 1, size(unit)
         relation%matrix(:, j) = relation%matrix(:, j)/(unit*unit(j))
      end do
      relation%friction = problem%friction*relation%force_unit(:m)/relation%force_unit(m + 1:2*m)
      relation%slip_bound = problem%slip_bound/relation%force_unit(m + 1:2*m)
   end subroutine new_contact_relation

   !> The inverse of the symmetric part of H, if that is positive definite beyond rounding.
   pure subroutine contact_relation_invert(self, inverse, is_definite)
      class(contact_relation_t), intent(in) :: self !! the relation
      real(dp), allocatable, intent(out) :: inverse(:, :) !! the inverse, if there is one (2m, 2m)
      logical, intent(out) :: is_definite !! whether there is
      ! The square of a smaller pivot's root may be rounding alone.
      real(dp), parameter :: least_root = 1.0e-5_dp
      integer :: i, info

      inverse = 0.5_dp*(self%matrix + transpose(self%matrix))
      call cholesky_factor(inverse, info)
      is_definite = info == 0
      if (is_definite) is_definite = minval([(inverse(i, i), i=1, size(inverse, 1))]) > least_root
      if (is_definite) call cholesky_inverse(inverse)
   end subroutine contact_relation_invert

   !> The forces and distances for given states, dimensionless: the solution of 2m linear equations for the 2m
   !> components that the states do not prescribe.
   pure subroutine contact_relation_solve_states(self, states, force, distance, info)
      class(contact_relation_t), intent(in) :: self !! the relation
      type(active_set_t), intent(in) :: states !! state of every point
      real(dp), intent(out) :: force(:) !! lambda (2m) [-]
      real(dp), intent(out) :: distance(:) !! w (2m) [-]
      integer, intent(out) :: info !! 0, or nonzero where the states leave the system singular
      real(dp), allocatable :: matrix(:, :), factors(:, :)
      real(dp) :: unknown(2*self%n_points), right(2*self%n_points)
      logical :: has_force(2*self%n_points)
      integer :: m, p, t

      m = self%n_points
      allocate (matrix(2*m, 2*m))
      has_force = states%gives_force()
      do p = 1, 2*m
         call fill_column(p, has_force(p), matrix(:, p))
      end do
      right = self%vector
      do p = 1, m
         if (states%slip_direction(p) == 0) cycle
         t = m + p
         call fill_column(t, .true., unknown)
         right = right - states%slip_direction(p)*self%slip_bound(p)*unknown
         if (states%is_closed(p)) matrix(:, p) = matrix(:, p) + states%slip_direction(p)*self%friction(p)*unknown
      end do
      unknown = right
      factors = matrix
      call lu_solve(factors, unknown, info)
      force = 0.0_dp
      distance = 0.0_dp
      if (info /= 0) return
      ! One step of refinement.
      right = right - matmul(matrix, unknown)
      call lu_solve(matrix, right, info)
      unknown = unknown + right
      force = merge(unknown, 0.0_dp, has_force)
      distance = merge(0.0_dp, unknown, has_force)
      associate (direction => states%slip_direction)
         where (direction /= 0) force(m + 1:) = direction*(self%slip_bound + self%friction*force(:m))
      end associate

   contains

      !> The column of a force or distance in the relation `y + H x = h`.
      pure subroutine fill_column(i, is_force, column)
         integer, intent(in) :: i !! index of the component
         logical, intent(in) :: is_force !! whether its force is meant, else its distance
         real(dp), intent(out) :: column(:) !! the column (2m)

         if (is_force .eqv. self%is_dual) then
            column = self%matrix(:, i)
         else
            column = 0.0_dp
            column(i) = 1.0_dp
         end if
      end subroutine fill_column

   end subroutine contact_relation_solve_states

   !> The largest violation of the contact law by forces and distances in given states: tension, penetration, excess of
   !> friction or slip against the direction, over the largest force or distance, at least 1 [-].
   pure real(dp) function contact_relation_violation(self, states, force, distance) result(violation)
      class(contact_relation_t), intent(in) :: self !! the relation
      type(active_set_t), intent(in) :: states !! state of every point (m)
      real(dp), intent(in) :: force(:) !! lambda (2m) [-]
      real(dp), intent(in) :: distance(:) !! w (2m) [-]
      real(dp) :: excess
      integer :: m, p, t

      m = self%n_points
      violation = 0.0_dp
      do p = 1, m
         t = m + p
         excess = merge(-force(p), distance(p), states%is_closed(p))
         if (states%slip_direction(p) == 0) then
            excess = max(excess, abs(force(t)) - self%slip_bound(p) - self%friction(p)*max(0.0_dp, force(p)))
         else
            excess = max(excess, -states%slip_direction(p)*distance(t))
         end if
         violation = max(violation, excess)
      end do
      violation = violation/max(1.0_dp, maxval(abs(force)), maxval(abs(distance)))
   end function contact_relation_violation

   !> Finds a solution; a basis is the choice of the variable of each pair that may differ from zero.
   !>
   !> Numbers of the matrix and of the right-hand side should be about 1: what is far below counts as zero.
   pure subroutine lemke_pivoting(matrix, right, cover, is_z_basic, z, outcome, error, effort)
      real(dp), intent(in) :: matrix(:, :) !! M (n, n)
      real(dp), intent(in) :: right(:) !! q (n)
      real(dp), intent(in) :: cover(:) !! c, positive (n)
      logical, intent(out) :: is_z_basic(:) !! whether z_i is basic at the end, w_i nonbasic then (n)
      real(dp), intent(out) :: z(:) !! z at the end, with the rounding errors of all pivots (n)
      integer, intent(out) :: outcome !! `pivoting_solved`, `pivoting_ray` or `pivoting_stopped`
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(effort_t), intent(inout), optional :: effort
         !! gains a product with M for each pivot, and a factorization for each tableau made anew
      integer, parameter :: pivots_per_row = 50
      type(tableau_t) :: tableau
      integer :: i, n_pivots, row, column, entering, leaving

      z = 0.0_dp
      is_z_basic = .false.
      outcome = pivoting_solved
      if (all(right >= 0.0_dp)) return
      call new_tableau(tableau, matrix, right, cover, error)
      if (allocated(error)) return
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
            call refresh(tableau, matrix, right, cover, error)
            if (allocated(error)) return
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
         if (row > 0) z(i) = tableau%entry(row, tableau%n + 2)
      end do
   end subroutine lemke_pivoting

   !> Makes the first tableau of Lemke's method, in which the variables w are basic.
   pure subroutine new_tableau(tableau, matrix, right, cover, error)
      type(tableau_t), intent(out) :: tableau !! the tableau
      real(dp), intent(in) :: matrix(:, :) !! M (n, n)
      real(dp), intent(in) :: right(:) !! q (n)
      real(dp), intent(in) :: cover(:) !! c (n)
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer :: i, n

      n = size(right)
      tableau%n = n
      call allocate_matrix(tableau%entry, n, n + 2, "the tableau of Lemke's method", error)
      if (allocated(error)) return
      tableau%entry(:, :n) = matrix
      tableau%entry(:, n + 1) = cover
      tableau%entry(:, n + 2) = right
      tableau%basic = [(i, i=1, n)]
      tableau%nonbasic = [(n + i, i=1, n + 1)]
      tableau%place = [(i, i=1, n), (-i, i=1, n + 1)]
   end subroutine new_tableau

   !> Makes the nonbasic variable of a column basic and the basic one of a row nonbasic.
   pure subroutine exchange(tableau, row, column)
      type(tableau_t), intent(inout) :: tableau !! the tableau
      integer, intent(in) :: row !! the row
      integer, intent(in) :: column !! the column
      real(dp) :: pivot_row(tableau%n + 2), pivot_column(tableau%n), pivot
      integer :: j, leaving

      associate (entry => tableau%entry)
         pivot = entry(row, column)
         pivot_column = entry(:, column)
         pivot_row = -entry(row, :)/pivot
         pivot_row(column) = 1.0_dp/pivot
         pivot_column(row) = 0.0_dp
         do j = 1, tableau%n + 2
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

   !> Recomputes the tableau from the data, with the largest pivot of each column.
   pure subroutine refresh(tableau, matrix, right, cover, error)
      type(tableau_t), intent(inout) :: tableau !! the tableau; its basis stays
      real(dp), intent(in) :: matrix(:, :) !! M (n, n)
      real(dp), intent(in) :: right(:) !! q (n)
      real(dp), intent(in) :: cover(:) !! c (n)
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(tableau_t) :: fresh
      logical :: may_leave(size(right))
      integer :: i, row

      call new_tableau(fresh, matrix, right, cover, error)
      if (allocated(error)) return
      may_leave = tableau%place(:fresh%n) < 0
      do i = fresh%n + 1, 2*fresh%n + 1
         if (tableau%place(i) < 0) cycle
         row = maxloc(abs(fresh%entry(:, -fresh%place(i))), dim=1, mask=may_leave)
         may_leave(row) = .false.
         call exchange(fresh, row, -fresh%place(i))
      end do
      tableau = fresh
   end subroutine refresh

   !> The row whose variable is the first to reach zero as the variable of a column grows; 0 if none does. Of ties z_0
   !> is preferred, then the lexicographic order decides.
   pure integer function leaving_row(tableau, column) result(row)
      type(tableau_t), intent(in) :: tableau !! the tableau
      integer, intent(in) :: column !! the column
      logical :: is_candidate(tableau%n)
      real(dp) :: factor(tableau%n), value(tableau%n), least
      integer :: k, place

      row = 0
      factor = -tableau%entry(:, column)
      is_candidate = factor > pivot_rounding*max(1.0_dp, maxval(abs(factor)))
      if (.not. any(is_candidate)) return
      factor = merge(factor, 1.0_dp, is_candidate)
      value = max(0.0_dp, tableau%entry(:, tableau%n + 2))/factor
      least = minval(value, mask=is_candidate)
      is_candidate = is_candidate .and. value <= least + sum_rounding*max(1.0_dp, least)
      row = tableau%place(2*tableau%n + 1)
      if (is_candidate(row)) return
      do k = 1, tableau%n
         if (count(is_candidate) == 1) exit
         ! Increments of the basic variables under a small growth of q_k.
         place = tableau%place(k)
         if (place < 0) then
            value = -tableau%entry(:, -place)/factor
         else
            value = 0.0_dp
            value(place) = 1.0_dp/factor(place)
         end if
         least = minval(value, mask=is_candidate)
         is_candidate = is_candidate .and. value <= least + sum_rounding*max(1.0_dp, abs(least))
      end do
      row = findloc(is_candidate, .true., dim=1)
   end function leaving_row

end module amontons_contact_relation
