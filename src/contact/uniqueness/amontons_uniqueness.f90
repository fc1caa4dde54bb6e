!> A friction below which a contact problem has one solution, whatever its loads and gaps; section 5 of doc/theory.md
!> has the proofs. The paper asks for small friction in (P2), where the slip bound is given and none is needed (errata 1
!> and 2).
!>
!> Of few points the exact bound is found: the signs of the determinants that all combinations of states lead to. Of
!> more points a sufficient one, `amontons_uniqueness_estimate`.
module amontons_uniqueness
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_relation, only: contact_relation_t, new_contact_relation
   use amontons_dense, only: cholesky_factor, cholesky_inverse
   use amontons_kinds, only: dp
   use amontons_uniqueness_estimate, only: estimated_bound
   implicit none (type, external)
   private

   public :: new_uniqueness, uniqueness_t

   !> What is known of the friction below which the solution is unique.
   type :: uniqueness_t
      logical :: has_bound = .false. !! whether a bound was found
      logical :: is_exact = .false. !! whether there are loads with several solutions just above the bound
      logical :: is_for_any = .false. !! whether the solution is unique whatever the friction
      real(dp) :: friction = 0.0_dp
         !! the largest coefficient for which the solution is unique, those of all points being in the ratios of the
         !! problem, equal if it has none [-]
      logical :: is_unique = .false. !! whether the problem itself is below the bound
   end type uniqueness_t

   !> A bound above this coefficient is none.
   real(dp), parameter :: any_friction = 1.0e6_dp

contains

   !> Computes the bound of a contact problem.
   pure subroutine new_uniqueness(uniqueness, problem)
      type(uniqueness_t), intent(out) :: uniqueness !! the bound
      type(contact_problem_t), intent(inout) :: problem !! the problem; gains a dense stiffness if it has few points
      ! Cholesky factors of so many rows take about a second together.
      integer, parameter :: most_points = 500
      type(contact_relation_t) :: relation
      real(dp) :: friction(problem%n_points)

      ! Without Coulomb friction the problem is a convex program, and S determines the forces.
      uniqueness%is_unique = .not. (problem%is_reduced() .or. any(problem%friction > 0.0_dp))
      if (problem%n_points < 1 .or. problem%n_points > most_points) return
      call problem%prepare_stiffness()
      call new_contact_relation(relation, problem)
      friction = problem%friction
      if (.not. any(friction > 0.0_dp)) friction = 1.0_dp
      associate (m => problem%n_points, largest => maxval(friction))
         call bound_friction(uniqueness, relation, &
            friction/largest*relation%force_unit(:m)/relation%force_unit(m + 1:))
      end associate
      if (.not. uniqueness%has_bound) return
      uniqueness%is_for_any = uniqueness%friction >= any_friction
      if (uniqueness%is_for_any .or. maxval(problem%friction) < uniqueness%friction) uniqueness%is_unique = .true.
   end subroutine new_uniqueness

   !> Finds the exact bound where there are few points, else the estimate.
   pure subroutine bound_friction(uniqueness, relation, friction)
      type(uniqueness_t), intent(inout) :: uniqueness !! gains the bound
      type(contact_relation_t), intent(in) :: relation !! the problem
      real(dp), intent(in) :: friction(:) !! coefficients whose largest multiple is asked for (m) [-]
      ! Four states for each point and fifty halvings: a tenth of a second.
      integer, parameter :: most_points_exact = 7
      real(dp), allocatable :: inverse(:, :)
      logical :: is_definite

      call invert(relation%matrix, inverse, is_definite)
      uniqueness%is_exact = is_definite .and. relation%n_points <= most_points_exact
      if (uniqueness%is_exact) then
         if (relation%is_dual) inverse = relation%matrix
         uniqueness%friction = exact_bound(inverse, friction, relation%slip_bound > 0.0_dp)
      else if (.not. relation%is_dual) then
         uniqueness%friction = estimated_bound(relation%matrix, friction)
      else if (is_definite) then
         uniqueness%friction = estimated_bound(inverse, friction)
      end if
      uniqueness%has_bound = uniqueness%friction > 0.0_dp
   end subroutine bound_friction

   !> The inverse of a symmetric matrix with the diagonal 1, if it is positive definite beyond rounding.
   pure subroutine invert(matrix, inverse, is_definite)
      real(dp), intent(in) :: matrix(:, :) !! the matrix (n, n)
      real(dp), allocatable, intent(out) :: inverse(:, :) !! its inverse (n, n)
      logical, intent(out) :: is_definite !! whether there is one
      ! The square of a smaller pivot's root may be rounding alone.
      real(dp), parameter :: least_root = 1.0e-5_dp
      integer :: i, info

      inverse = matrix
      call cholesky_factor(inverse, info)
      is_definite = info == 0
      if (is_definite) is_definite = minval([(inverse(i, i), i=1, size(inverse, 1))]) > least_root
      if (is_definite) call cholesky_inverse(inverse)
   end subroutine invert

   !> The least multiple of given coefficients at which the determinant of some states is no longer positive.
   pure real(dp) function exact_bound(a, friction, has_slip_bound) result(bound)
      real(dp), intent(in) :: a(:, :) !! A, positive definite (2m, 2m) [-]
      real(dp), intent(in) :: friction(:) !! phi, the largest of them about 1 (m) [-]
      logical, intent(in) :: has_slip_bound(:) !! whether a given slip bound lets open points stick (m)
      integer, parameter :: n_halvings = 50
      real(dp) :: above, middle, by_point(size(a, 1), size(a, 2))
      integer :: order(size(a, 1)), i, j, m

      m = size(friction)
      order = [((i + j*m, j=0, 1), i=1, m)]
      by_point = a(order, order)
      bound = 0.0_dp
      above = 1.0_dp
      do while (are_positive(by_point, above*friction, has_slip_bound))
         bound = above
         if (bound > any_friction) return
         above = 2.0_dp*above
      end do
      do i = 1, n_halvings
         middle = 0.5_dp*(bound + above)
         if (are_positive(by_point, middle*friction, has_slip_bound)) then
            bound = middle
         else
            above = middle
         end if
      end do
   end function exact_bound

   !> Whether the determinants of all combinations of states are positive. The points settle their states from the last
   !> to the first; since the others may all be open, each elimination has to have a positive pivot of its own.
   pure recursive logical function are_positive(a, friction, has_slip_bound) result(is_positive)
      real(dp), intent(in) :: a(:, :)
         !! A of the points without a state, after the elimination of the others; normal and tangential row of each
         !! point follow each other (2r, 2r)
      real(dp), intent(in) :: friction(:) !! phi, at least (r)
      logical, intent(in) :: has_slip_bound(:) !! whether a given slip bound lets open points stick, at least (r)
      integer :: n, t, rest, direction

      is_positive = .true.
      t = size(a, 1)
      if (t == 0) return
      n = t - 1
      rest = t - 2
      associate (others => a(:rest, :rest), phi => friction(t/2))
         is_positive = are_positive(others, friction, has_slip_bound)
         do direction = -1, 1, 2
            if (is_positive) is_positive = stays_positive(a(:, n) + direction*phi*a(:, t), a(n, :rest), &
               a(n, n) + direction*phi*a(n, t), others)
         end do
         if (is_positive .and. has_slip_bound(t/2)) is_positive = stays_positive(a(:, t), a(t, :rest), a(t, t), others)
         if (.not. is_positive) return
         ! Stick: the normal row, and then the tangential one.
         is_positive = a(n, n) > 0.0_dp
         if (.not. is_positive) return
         associate (ratio => a(:, n)/a(n, n))
            is_positive = stays_positive(a(:, t) - ratio*a(n, t), a(t, :rest) - a(t, n)*a(n, :rest)/a(n, n), &
               a(t, t) - a(t, n)*a(n, t)/a(n, n), others - spread(ratio(:rest), 2, rest)*spread(a(n, :rest), 1, rest))
         end associate
      end associate

   contains

      !> Eliminates one unknown by one row and asks for the rest.
      pure recursive logical function stays_positive(column, row, pivot, matrix)
         real(dp), intent(in) :: column(:) !! column of the unknown, at least (rest)
         real(dp), intent(in) :: row(:) !! the row (rest)
         real(dp), intent(in) :: pivot !! where row and column meet
         real(dp), intent(in) :: matrix(:, :) !! rows and columns of the others (rest, rest)

         stays_positive = pivot > 0.0_dp
         if (stays_positive) stays_positive = are_positive(matrix - spread(column(:rest), 2, rest)* &
            spread(row/pivot, 1, rest), friction, has_slip_bound)
      end function stays_positive

   end function are_positive

end module amontons_uniqueness
