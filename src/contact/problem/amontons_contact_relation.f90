!> A contact problem as one linear relation `y = h - H x` between forces and distances, in numbers about 1, for the
!> methods that decide point by point which condition of the law is in force.
!>
!> w = (u_N - d; u_T - a) are the distances. In the dual form x is the force, y = w, H = A and h = B; in the primal form
!> x = w, y is the force, H = S and h = q - S (d; a). Either way H is positive semidefinite; it is scaled to the
!> diagonal 1, which turns every force and every distance into one unit, and with it the friction.
module amontons_contact_relation
   use amontons_active_set, only: active_set_t
   use amontons_contact_operator, only: contact_operator_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_dense, only: allocate_matrix, cholesky_factor, cholesky_inverse, lu_solve
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: contact_relation_t, new_contact_relation

   !> The relation between forces and distances, with the friction of every point; all without units.
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

contains

   !> The relation of a contact problem: primal where it has a stiffness, dual where it is a reduced problem.
   subroutine new_contact_relation(relation, problem, error)
      type(contact_relation_t), intent(out) :: relation !! the relation
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(contact_operator_t) :: copy
      real(dp) :: force(2*problem%n_points)
      integer :: i

      relation%is_dual = .not. problem%matrix%has_stiffness()
      if (relation%is_dual) then
         associate (a => problem%matrix%compliance)
            call allocate_matrix(relation%matrix, a%n, a%n, 'the contact points', error)
            if (allocated(error)) return
            call a%fill_block([(i, i=1, a%n)], [(i, i=1, a%n)], relation%matrix)
         end associate
         relation%vector = problem%dual_load(problem%free_displacement)
      else
         call problem%matrix%copy_dense(copy, error)
         if (allocated(error)) return
         call move_alloc(copy%stiffness%values, relation%matrix)
         call problem%matrix%multiply_stiffness(problem%reference(), force)
         relation%vector = problem%load - force
      end if
      call scale_relation(relation, problem%friction, problem%slip_bound)
   end subroutine new_contact_relation

   !> Scales a relation `y = h - H x` to the diagonal 1.
   pure subroutine scale_relation(relation, friction, slip_bound)
      type(contact_relation_t), intent(inout) :: relation !! the relation, with units; without on return
      real(dp), intent(in) :: friction(:) !! Coulomb coefficient phi (m) [-]
      real(dp), intent(in) :: slip_bound(:) !! given slip bound g (m) [F]
      real(dp) :: unit(size(relation%vector)), amount
      integer :: j, m

      unit = sqrt(diagonal_units(relation%matrix))
      amount = maxval(abs(relation%vector/unit))
      if (.not. amount > 0.0_dp) amount = 1.0_dp
      allocate (relation%distance_unit, source=merge(amount*unit, amount/unit, relation%is_dual))
      allocate (relation%force_unit, source=merge(amount/unit, amount*unit, relation%is_dual))
      relation%vector = relation%vector/(amount*unit)
      m = size(friction)
      relation%n_points = m
      do j = 1, 2*m
         relation%matrix(:, j) = relation%matrix(:, j)/(unit*unit(j))
      end do
      relation%friction = friction*relation%force_unit(:m)/relation%force_unit(m + 1:)
      relation%slip_bound = slip_bound/relation%force_unit(m + 1:)
   end subroutine scale_relation

   !> The diagonal as it scales; where it is not positive, its largest entry, or 1 if there is none.
   pure function diagonal_units(matrix) result(unit)
      real(dp), intent(in) :: matrix(:, :) !! the matrix (n, n)
      real(dp) :: unit(size(matrix, 1))
      integer :: i

      do i = 1, size(unit)
         unit(i) = matrix(i, i)
      end do
      if (.not. any(unit > 0.0_dp)) unit = 1.0_dp
      unit = merge(unit, maxval(unit), unit > 0.0_dp)
   end function diagonal_units

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

   !> The forces and distances that given states lead to, without units: 2m linear equations for the 2m of them that the
   !> states leave open.
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
         call take_column(p, has_force(p), matrix(:, p))
      end do
      right = self%vector
      do p = 1, m
         if (states%slip_direction(p) == 0) cycle
         t = m + p
         call take_column(t, .true., unknown)
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

      !> The column that a force or a distance has in the relation `y + H x = h`.
      pure subroutine take_column(i, is_force, column)
         integer, intent(in) :: i !! which component
         logical, intent(in) :: is_force !! whether its force is meant, else its distance
         real(dp), intent(out) :: column(:) !! the column (2m)

         if (is_force .eqv. self%is_dual) then
            column = self%matrix(:, i)
         else
            column = 0.0_dp
            column(i) = 1.0_dp
         end if
      end subroutine take_column

   end subroutine contact_relation_solve_states

   !> How far forces and distances are from the inequalities of their states: the largest tension, penetration, excess
   !> of friction or slip against the direction, over the largest force or distance, 1 at least [-].
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

end module amontons_contact_relation
