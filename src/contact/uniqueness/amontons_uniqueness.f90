!> A friction coefficient below which a contact problem has one solution, whatever its loads and gaps; section 5 of
!> doc/theory.md has the proofs. The paper requires small friction in (P2), where the slip bound is given and no
!> requirement is needed (errata 1 and 2).
!>
!> For few points the bound is exact and found from the signs of the determinants of all combinations of states. For
!> more points it is sufficient, an estimate of the effect of friction through the coupling of normal and tangential
!> directions.
module amontons_uniqueness
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_relation, only: contact_relation_t, new_contact_relation
   use amontons_dense, only: cholesky_factor, cholesky_inverse, cholesky_solve, symmetric_multiply, &
      transposed_product, triangular_solve
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: new_uniqueness, uniqueness_t

   !> The friction below which the solution is unique, as far as it is known.
   type :: uniqueness_t
      logical :: has_bound = .false. !! whether a bound was found
      logical :: is_exact = .false. !! whether there are loads with several solutions just above the bound
      logical :: is_for_any = .false. !! whether the solution is unique whatever the friction
      real(dp) :: friction = 0.0_dp
         !! the largest coefficient for which the solution is unique, those of all points being in the ratios of the
         !! problem, equal if it has none [-]
      logical :: is_unique = .false. !! whether the problem itself is below the bound
      real(dp), allocatable :: ratio(:) !! friction of each point over the largest that the bound was found for (m) [-]
      logical, allocatable :: has_slip_bound(:) !! whether each point had a given slip bound (m)
   end type uniqueness_t

   !> A bound above this coefficient is reported as no bound.
   real(dp), parameter :: any_friction = 1.0e6_dp

contains

   !> Computes the friction bound of a contact problem, which depends only on the body and on the ratios of the friction
   !> coefficients.
   subroutine new_uniqueness(uniqueness, problem, known)
      type(uniqueness_t), intent(out) :: uniqueness !! the bound
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(uniqueness_t), intent(in), optional :: known
         !! the bound of another load case of the same body, which may serve again, or none
      ! Cholesky factors of so many rows take about a second together.
      integer, parameter :: most_rows = 1000
      real(dp) :: ratio(problem%n_points)
      logical :: is_known

      ratio = problem%friction
      if (.not. any(ratio > 0.0_dp)) ratio = 1.0_dp
      uniqueness%ratio = ratio/maxval(ratio)
      uniqueness%has_slip_bound = problem%slip_bound > 0.0_dp
      is_known = present(known)
      if (is_known) is_known = allocated(known%ratio)
      if (is_known) is_known = size(known%ratio) == problem%n_points
      if (is_known) is_known = all(abs(known%ratio - uniqueness%ratio) <= 0.0_dp) &
         .and. all(known%has_slip_bound .eqv. uniqueness%has_slip_bound)
      if (is_known) then
         uniqueness = known
      else if (problem%n_points > 0 .and. problem%matrix%n <= most_rows) then
         call bound_friction(uniqueness, problem)
      end if
      ! Without Coulomb friction the problem is a convex program, and S determines the forces.
      uniqueness%is_unique = problem%matrix%has_stiffness() .and. .not. any(problem%friction > 0.0_dp)
      if (uniqueness%has_bound) uniqueness%is_unique = uniqueness%is_unique .or. uniqueness%is_for_any &
         .or. maxval(problem%friction) < uniqueness%friction
   end subroutine new_uniqueness

   !> Finds the exact bound for few points in the plane, otherwise the estimate.
   subroutine bound_friction(uniqueness, problem)
      type(uniqueness_t), intent(inout) :: uniqueness !! the ratios; gains the bound
      type(contact_problem_t), intent(in) :: problem !! the problem
      ! Four states for each point and fifty halvings: a tenth of a second.
      integer, parameter :: most_points_exact = 7
      type(contact_relation_t) :: relation
      type(error_t), allocatable :: error
      real(dp), allocatable :: inverse(:, :), friction(:)
      logical :: is_definite

      ! Memory has room for the few points.
      call new_contact_relation(relation, problem, error)
      if (allocated(error)) return
      associate (m => problem%n_points)
         friction = uniqueness%ratio*relation%force_unit(:m)/relation%force_unit(m + 1:2*m)
      end associate
      call relation%invert(inverse, is_definite)
      uniqueness%is_exact = is_definite .and. relation%n_points <= most_points_exact .and. &
         problem%matrix%n_tangents == 1
      if (uniqueness%is_exact) then
         if (relation%is_dual) inverse = relation%matrix
         uniqueness%friction = exact_bound(inverse, friction, uniqueness%has_slip_bound)
      else if (.not. relation%is_dual) then
         uniqueness%friction = estimated_bound(relation%matrix, friction)
      else if (is_definite) then
         uniqueness%friction = estimated_bound(inverse, friction)
      end if
      uniqueness%has_bound = uniqueness%friction > 0.0_dp
      uniqueness%is_for_any = uniqueness%friction >= any_friction
   end subroutine bound_friction

   !> The smallest multiple of given coefficients at which the determinant of some combination of states is not
   !> positive.
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

      !> Eliminates one unknown by one row and continues with the remaining points.
      pure recursive logical function stays_positive(column, row, pivot, matrix)
         real(dp), intent(in) :: column(:) !! column of the unknown, at least (rest)
         real(dp), intent(in) :: row(:) !! the row (rest)
         real(dp), intent(in) :: pivot !! the pivot
         real(dp), intent(in) :: matrix(:, :) !! rows and columns of the others (rest, rest)

         stays_positive = pivot > 0.0_dp
         if (stays_positive) stays_positive = are_positive(matrix - spread(column(:rest), 2, rest)* &
            spread(row/pivot, 1, rest), friction, has_slip_bound)
      end function stays_positive

   end function are_positive

   !> A multiple of given coefficients below which the solution is unique, from norms; 0 if rigid motions with slip are
   !> free. With kappa and gamma of section 5 of doc/theory.md, kappa < gamma + 1/gamma (2 if gamma > 1).
   pure real(dp) function estimated_bound(s, friction) result(bound)
      real(dp), intent(in) :: s(:, :) !! S, positive semidefinite (2m, 2m), in space (3m, 3m) [-]
      real(dp), intent(in) :: friction(:) !! phi (m) [-]
      ! Rounding error of the estimate, and of a coupling of 0.
      real(dp), parameter :: caution = 1.0_dp - 1.0e-6_dp, rounding = 1.0e-12_dp
      real(dp) :: gamma
      ! Free rigid motions along the normals are in the kernel of S_11 and of S_21: any small number holds them.
      real(dp), parameter :: hold = 1.0e-11_dp, least_root = 1.0e-4_dp
      real(dp), allocatable :: factor(:, :), cross(:, :), mixed(:, :), difference(:, :)
      real(dp), allocatable :: compliance(:, :), stiffness(:, :), weight(:), weights(:)
      integer, allocatable :: rows(:)
      integer :: i, info, k, m, n

      bound = 0.0_dp
      ! The normal displacements are eliminated: S_T = S_22 - S_21 S_11^+ S_12.
      m = size(friction)
      n = size(s, 1) - m
      factor = s(:m, :m)
      do i = 1, m
         factor(i, i) = (1.0_dp + hold)*factor(i, i)
      end do
      call cholesky_factor(factor, info)
      if (info /= 0) return
      cross = s(:m, m + 1:)
      mixed = cross
      call cholesky_solve(factor, mixed)
      allocate (difference(n, n))
      call transposed_product(cross, mixed, difference)
      factor = s(m + 1:, m + 1:) - difference
      call cholesky_factor(factor, info)
      if (info /= 0) return
      if (.not. all([(factor(i, i) > least_root*sqrt(s(m + i, m + i)), i=1, n)])) return
      ! L^-1 S_21 S_11^+ S_12 L^-T
      call triangular_solve(factor, difference)
      difference = transpose(difference)
      call triangular_solve(factor, difference)
      gamma = sqrt(largest_eigenvalue(difference))
      gamma = max(gamma, rounding)
      ! kappa is the square root of the product of the largest eigenvalues of D A_22 D and of D^-1 Phi S_11 Phi D^-1,
      ! A_22 = S_T^-1, on the points with friction. The diagonal D, one number for each point, balances the two.
      call cholesky_inverse(factor)
      associate (rough => pack([(i, i=1, m)], friction > 0.0_dp))
         rows = [(rough + i, i=0, n - m, m)]
         compliance = factor(rows, rows)
         stiffness = s(rough, rough)
         weight = [(friction(rough(i))*sqrt(stiffness(i, i)*(n/m)/sum([(factor(k, k), k=rough(i), n, m)])), &
            i=1, size(rough))]
         weights = [(weight, i=0, n - m, m)]
         do i = 1, size(rows)
            compliance(:, i) = compliance(:, i)*sqrt(weights)*sqrt(weights(i))
         end do
         do i = 1, size(rough)
            stiffness(:, i) = stiffness(:, i)*friction(rough)/sqrt(weight)*friction(rough(i))/sqrt(weight(i))
         end do
      end associate
      bound = caution*merge(gamma + 1.0_dp/gamma, 2.0_dp, gamma < 1.0_dp) &
         /sqrt(largest_eigenvalue(compliance)*largest_eigenvalue(stiffness))
   end function estimated_bound

   !> An upper bound of the largest eigenvalue of a positive semidefinite matrix: a Cholesky factor proves that no
   !> eigenvalue is larger. Power iterations provide the trial values.
   pure real(dp) function largest_eigenvalue(matrix) result(above)
      real(dp), contiguous, intent(in) :: matrix(:, :) !! the matrix (n, n)
      real(dp), parameter :: resolution = 1.0e-4_dp
      integer, parameter :: n_powers = 60
      real(dp) :: vector(size(matrix, 1)), image(size(matrix, 1)), below, middle, step
      integer :: i

      vector = [(1.0_dp + modulo(i, 7), i=1, size(vector))]
      below = 0.0_dp
      do i = 1, n_powers
         vector = vector/norm2(vector)
         call symmetric_multiply(matrix, vector, image)
         below = dot_product(vector, image)
         if (.not. below > 0.0_dp) exit
         vector = image
      end do
      below = max(below, epsilon(below)*maxval(abs(matrix)))
      above = below
      if (.not. below > 0.0_dp) return
      step = resolution
      above = (1.0_dp + step)*below
      do while (.not. is_above(above))
         below = above
         step = 4.0_dp*step
         above = (1.0_dp + step)*below
      end do
      do while (above - below > 2.0_dp*resolution*above)
         middle = 0.5_dp*(below + above)
         if (is_above(middle)) then
            above = middle
         else
            below = middle
         end if
      end do

   contains

      !> Whether a number is larger than every eigenvalue.
      pure logical function is_above(number)
         real(dp), intent(in) :: number !! the number
         real(dp) :: difference(size(matrix, 1), size(matrix, 1))
         integer :: k, info

         difference = -matrix
         do k = 1, size(matrix, 1)
            difference(k, k) = difference(k, k) + number
         end do
         call cholesky_factor(difference, info)
         is_above = info == 0
      end function is_above

   end function largest_eigenvalue

end module amontons_uniqueness
