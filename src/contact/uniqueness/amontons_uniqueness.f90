!> How many solutions a contact problem has: a friction coefficient below which it has one, whatever its loads and gaps,
!> and every solution of a small problem.
!>
!> Section 5 of doc/theory.md has the proofs of the coefficient. The paper requires small friction in (P2), where the
!> slip bound is given and no requirement is needed (errata 1 and 2). For few points the bound is exact and found from
!> the signs of the determinants of all combinations of states. For more points it is sufficient, an estimate of the
!> effect of friction through the coupling of normal and tangential directions.
!>
!> All solutions: a point is in one of a few states, each of which is two linear equations and some inequalities. The
!> points take their states one after the other; the equations are eliminated on the way, so that the inequalities of
!> the points so far are known in terms of the points to come, and a branch ends as soon as one of them cannot hold.
!>
!> Affine functions are in the rows of a matrix, the constant in column 0: elimination of unknowns by equations, and
!> what inequalities allow. Numbers should be about 1.
module amontons_uniqueness
   use amontons_contact_problem, only: active_set_t, contact_problem_t
   use amontons_contact_relation, only: contact_relation_t, lemke_pivoting, new_contact_relation, pivoting_solved
   use amontons_dense, only: cholesky_factor, cholesky_inverse, cholesky_solve, symmetric_multiply, &
      transposed_product, triangular_solve
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_rounding, only: computed_rounding, difference_rounding, pivot_rounding, sum_rounding
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: all_solutions_t, eliminate, find_all_solutions, has_extent, most_points, new_uniqueness, uniqueness_t

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


   !> Most points that all combinations of states are tried for: with Coulomb friction, a point has four states.
   integer, parameter :: most_points = 12
   !> Most points with a given slip bound: a point has six states then, since open ones may slip or stick.
   integer, parameter :: most_points_with_bound = 9

   !> Smallest pivot that is used while further points follow, whose equations may have larger ones; the last point uses
   !> any that is not a rounding error.
   real(dp), parameter :: small_pivot = 1.0e-7_dp

   !> Rounding error of a value that was computed with a pivot just above `small_pivot`.
   real(dp), parameter :: loose = difference_rounding/small_pivot

   !> All solutions of a contact problem.
   type :: all_solutions_t
      integer :: n = 0 !! number of solutions found
      real(dp), allocatable :: force(:, :) !! lambda of each solution (2m, n) [F]
      real(dp), allocatable :: displacement(:, :) !! v of each solution (2m, n) [L]
      integer, allocatable :: status(:, :) !! status of every point in each solution (m, n)
      logical, allocatable :: is_isolated(:) !! whether no other solution is near; not known of the others (n)
      logical :: has_family = .false.
         !! whether some states hold for a whole family of solutions, of which only corners are among those found
   end type all_solutions_t

   !> The state of a search.
   type :: search_t
      type(contact_relation_t) :: relation !! the problem without units
      type(all_solutions_t) :: found !! the solutions so far, without units; distances in the place of displacements
      real(dp), allocatable :: lower(:) !! least value that each x can have in a solution, point by point (2m)
      real(dp), allocatable :: upper(:) !! its largest value (2m)
      type(active_set_t) :: states !! states of the points so far (m)
   end type search_t

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
      else if (problem%n_points > 0 .and. problem%matrix%n <= most_rows .and. .not. allocated(problem%softness)) then
         call bound_friction(uniqueness, problem)
      end if
      ! Without Coulomb friction the problem is a convex program, and S determines the forces, but for those that points
      ! which depend on each other share.
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
      real(dp), parameter :: caution = 1.0_dp - 1.0e-6_dp
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
      call triangular_solve(n, n, factor, difference)
      difference = transpose(difference)
      call triangular_solve(n, n, factor, difference)
      gamma = sqrt(largest_eigenvalue(difference))
      gamma = max(gamma, sum_rounding)
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
      real(dp), parameter :: resolution = 1.0e-4_dp ! a bound is written with three digits
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

   !> Finds all solutions of a contact problem of at most `most_points` points.
   !>
   !> If matrices of states are singular, solutions may form families (polyhedra); the result reports whether there are
   !> any.
   subroutine find_all_solutions(solutions, problem, error, skew_part)
      type(all_solutions_t), intent(out) :: solutions !! the solutions
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(error_t), allocatable, intent(out) :: error !! the problem has too many points, or memory ran out
      real(dp), intent(in), optional :: skew_part(:, :)
         !! skew part of the compliance of a reduced problem (2m, 2m) [L/F]
      type(search_t) :: search
      integer :: j, most, i, m
      real(dp), allocatable :: rows(:, :), inverse(:, :), center(:), reach(:)
      real(dp), parameter :: unbounded = huge(1.0_dp)/1.0e10_dp
      logical :: is_definite

      most = merge(most_points_with_bound, most_points, any(problem%slip_bound > 0.0_dp))
      if (problem%matrix%n_tangents == 2) then
         call new_error(error, input_refused, 'all solutions can be found in the plane only: friction in space is '// &
            'no linear complementarity problem')
      else if (allocated(problem%softness)) then
         call new_error(error, input_refused, 'all solutions cannot be found where contact points depend on each '// &
            'other, as at a corner between two obstacles or on a rigid set: their forces have no single value')
      else if (problem%n_points > most) then
         call new_error(error, input_refused, 'all solutions can be found with at most '//to_text(most)// &
            ' contact points'//trim(merge(' where a slip bound is given', repeat(' ', 28), most < most_points))// &
            ', this problem has '//to_text(problem%n_points))
      end if
      if (.not. allocated(error)) call new_contact_relation(search%relation, problem, error)
      if (allocated(error)) return
      if (present(skew_part)) then
         associate (relation => search%relation)
            do j = 1, size(skew_part, 2)
               relation%matrix(:, j) = relation%matrix(:, j) &
                  + skew_part(:, j)*relation%force_unit(j)/relation%distance_unit
            end do
         end associate
      end if
      m = problem%n_points
      ! Bounds of x over all solutions. Distances and forces do no negative work on each other, x^T y >= 0, hence
      ! x^T H x <= x^T h: an ellipsoid if H is definite.
      allocate (search%lower(2*m), source=-unbounded)
      allocate (search%upper(2*m), source=unbounded)
      call search%relation%invert(inverse, is_definite)
      if (is_definite) then
         center = matmul(inverse, search%relation%vector)
         associate (energy => dot_product(center, search%relation%vector))
            reach = [(sqrt(max(0.0_dp, inverse(i, i)*energy)), i=1, 2*m)]
         end associate
         associate (order => [(i, m + i, i=1, m)])
            search%lower = 0.5_dp*(center(order) - reach(order)) - loose
            search%upper = 0.5_dp*(center(order) + reach(order)) + loose
         end associate
      end if
      ! Normal forces are not negative, normal distances not positive.
      if (search%relation%is_dual) then
         search%lower(1::2) = max(0.0_dp, search%lower(1::2))
      else
         search%upper(1::2) = min(0.0_dp, search%upper(1::2))
      end if
      allocate (search%states%is_closed(m), source=.false.)
      allocate (search%states%slip_direction(m), source=0)
      allocate (search%found%force(2*m, 0), search%found%displacement(2*m, 0), search%found%is_isolated(0))
      associate (order => [(i, m + i, i=1, m)], relation => search%relation)
         allocate (rows(2*m, 0:2*m))
         rows(:, 0) = relation%vector(order)
         rows(:, 1:) = -relation%matrix(order, order)
      end associate
      if (m > 0) then
         call descend(search, m, rows, 0)
      else
         call keep_if_new(search, rows(:, 0), rows(:, 0), .true.)
      end if
      solutions = search%found
      allocate (solutions%status(m, solutions%n))
      do i = 1, solutions%n
         solutions%force(:, i) = solutions%force(:, i)*search%relation%force_unit
         solutions%displacement(:, i) = solutions%displacement(:, i)*search%relation%distance_unit + problem%reference()
         solutions%status(:, i) = problem%status(solutions%displacement(:, i), solutions%force(:, i))
      end do
   end subroutine find_all_solutions

   !> Tries every state of a point after the states of the points before it are chosen.
   recursive subroutine descend(search, point, rows, n_pending)
      type(search_t), intent(inout) :: search !! the search
      integer, intent(in) :: point !! the point, from m down to 1
      real(dp), intent(in) :: rows(:, 0:)
         !! affine functions of the x of the points up to this one and of the pending unknowns: their y, inequalities
         !! (at least 0), and in the last rows the pending equations
      integer, intent(in) :: n_pending !! number of pending unknowns and equations, which no pivot was found for
      integer :: normal, direction

      do normal = 0, 1
         search%states%is_closed(point) = normal == 1
         do direction = -1, 1
            ! Without any slip bound one state covers all slips.
            if (direction /= 1 .and. .not. has_slip_bound(search, point)) cycle
            search%states%slip_direction(point) = direction
            call eliminate_point(search, point, rows, n_pending)
         end do
      end do
   end subroutine descend

   !> Whether friction can hold a point in its present state.
   pure logical function has_slip_bound(search, point)
      type(search_t), intent(in) :: search !! the search
      integer, intent(in) :: point !! the point

      has_slip_bound = search%relation%slip_bound(point) > 0.0_dp &
         .or. (search%states%is_closed(point) .and. search%relation%friction(point) > 0.0_dp)
   end function has_slip_bound

   !> Eliminates the unknowns of a point in its present state, and continues with the next point unless an inequality
   !> cannot hold.
   recursive subroutine eliminate_point(search, point, rows, n_pending)
      type(search_t), intent(inout) :: search !! the search
      integer, intent(in) :: point !! the point
      real(dp), intent(in) :: rows(:, 0:) !! as in `descend`
      integer, intent(in) :: n_pending !! number of pending unknowns and equations
      real(dp) :: inequalities(3, 0:ubound(rows, 2)), equations(2, 0:ubound(rows, 2))
      real(dp) :: next(size(rows, 1) + 3, 0:ubound(rows, 2))
      integer :: n_new, n_left, n_old, n_rows, n_unknowns
      logical :: is_possible, is_singular

      call point_conditions(search, point, rows, inequalities, n_new, equations)
      n_unknowns = 2*point - 2
      n_old = size(rows, 1) - n_pending - 2
      n_rows = n_old + n_new
      next(:n_unknowns, :) = rows(:n_unknowns, :)
      next(n_unknowns + 1:n_old, :) = rows(n_unknowns + 3:n_old + 2, :)
      next(n_old + 1:n_rows, :) = inequalities(:n_new, :)
      next(n_rows + 1:n_rows + n_pending, :) = rows(n_old + 3:, :)
      next(n_rows + n_pending + 1:n_rows + n_pending + 2, :) = equations
      call eliminate(next(:n_rows + n_pending + 2, :), n_unknowns, n_pending + 2, n_left, &
         merge(pivot_rounding, small_pivot, point == 1), is_possible, is_singular)
      if (.not. is_possible .or. (is_singular .and. search%found%has_family)) return
      associate (n_columns => n_unknowns + n_left)
         if (cannot_hold(search, next(n_unknowns + 1:n_rows, :n_columns), n_unknowns)) return
         if (point > 1) then
            call descend(search, point - 1, next(:n_rows + n_left, :n_columns), n_left)
         else if (n_left == 0) then
            call keep_solution(search)
         else
            search%found%has_family = has_extent(next(:n_rows, :n_columns))
         end if
      end associate
   end subroutine eliminate_point

   !> The inequalities and the two equations of a point in its present state.
   pure subroutine point_conditions(search, point, rows, inequalities, n_inequalities, equations)
      type(search_t), intent(in) :: search !! the search
      integer, intent(in) :: point !! the point
      real(dp), intent(in) :: rows(:, 0:) !! as in `descend`
      real(dp), intent(out) :: inequalities(:, 0:) !! affine functions that must not be negative (3, 0:n)
      integer, intent(out) :: n_inequalities !! how many of them there are
      real(dp), intent(out) :: equations(:, 0:) !! affine functions that must be zero (2, 0:n)
      real(dp), dimension(2, 0:ubound(rows, 2)) :: force, distance
      real(dp) :: bound(0:ubound(rows, 2))
      integer :: direction

      force = 0.0_dp
      force(1, 2*point - 1) = 1.0_dp
      force(2, 2*point) = 1.0_dp
      distance = rows(2*point - 1:2*point, :)
      if (.not. search%relation%is_dual) then
         distance = force
         force = rows(2*point - 1:2*point, :)
      end if
      direction = search%states%slip_direction(point)
      bound = 0.0_dp
      bound(0) = search%relation%slip_bound(point)
      if (search%states%is_closed(point)) then
         bound = bound + search%relation%friction(point)*force(1, :)
         inequalities(1, :) = force(1, :)
         equations(1, :) = distance(1, :)
      else
         inequalities(1, :) = -distance(1, :)
         equations(1, :) = force(1, :)
      end if
      if (direction == 0) then
         inequalities(2, :) = bound - force(2, :)
         inequalities(3, :) = bound + force(2, :)
         equations(2, :) = distance(2, :)
         n_inequalities = 3
      else
         inequalities(2, :) = direction*distance(2, :)
         equations(2, :) = force(2, :) - direction*bound
         n_inequalities = merge(2, 1, has_slip_bound(search, point))
      end if
   end subroutine point_conditions

   !> Whether an inequality fails for all unknowns within their bounds.
   pure logical function cannot_hold(search, inequalities, n_unknowns)
      type(search_t), intent(in) :: search !! the search
      real(dp), intent(in) :: inequalities(:, 0:) !! the inequalities
      integer, intent(in) :: n_unknowns !! number of unknowns with bounds; pending ones follow
      real(dp) :: most(size(inequalities, 1))
      integer :: j

      most = inequalities(:, 0)
      do j = 1, ubound(inequalities, 2)
         associate (factor => inequalities(:, j))
            if (j <= n_unknowns) then
               where (abs(factor) > pivot_rounding) most = most + max(factor*search%lower(j), factor*search%upper(j))
            else
               where (abs(factor) > pivot_rounding) most = huge(most)/2.0_dp
            end if
         end associate
      end do
      cannot_hold = any(most < -loose)
   end function cannot_hold

   !> Solves the equations of the present states again from the data, and keeps the solution unless it violates an
   !> inequality or is known.
   pure subroutine keep_solution(search)
      type(search_t), intent(inout) :: search !! the search
      type(active_set_t) :: states
      real(dp) :: force(2*search%relation%n_points), distance(2*search%relation%n_points), bound, margin
      integer :: info, m, p

      m = search%relation%n_points
      states = search%states
      associate (relation => search%relation)
         call relation%solve_states(states, force, distance, info)
         if (info /= 0) return
         ! Without any slip bound the direction is that of the slip.
         where (.not. relation%slip_bound + relation%friction*merge(1.0_dp, 0.0_dp, states%is_closed) > 0.0_dp)
            states%slip_direction = nint(sign(1.0_dp, distance(m + 1:)))
         end where
         if (relation%violation(states, force, distance) > computed_rounding) return
         ! The least of the numbers that the states ask to be positive: above zero, no other states hold nearby. Slips
         ! that no friction resists may have either sign.
         margin = huge(margin)
         do p = 1, m
            margin = min(margin, merge(force(p), -distance(p), states%is_closed(p)))
            bound = relation%slip_bound(p) + relation%friction(p)*max(0.0_dp, force(p))
            if (states%slip_direction(p) == 0) then
               margin = min(margin, bound - abs(force(m + p)))
            else if (bound > 0.0_dp) then
               margin = min(margin, states%slip_direction(p)*distance(m + p))
            end if
         end do
         call keep_if_new(search, force, distance, margin > loose)
      end associate
   end subroutine keep_solution

   !> Keeps a pair of forces and distances unless it is known: a point between two states is found in either.
   pure subroutine keep_if_new(search, force, distance, is_isolated)
      type(search_t), intent(inout) :: search !! the search
      real(dp), intent(in) :: force(:) !! lambda (2m) [-]
      real(dp), intent(in) :: distance(:) !! w (2m) [-]
      logical, intent(in) :: is_isolated !! whether no other solution is near
      integer :: i, n

      associate (found => search%found)
         n = found%n
         do i = 1, n
            if (maxval(abs(found%force(:, i) - force)) > loose*max(1.0_dp, maxval(abs(force)))) cycle
            if (maxval(abs(found%displacement(:, i) - distance)) > loose*max(1.0_dp, maxval(abs(distance)))) cycle
            return
         end do
         found%force = reshape([found%force, force], [size(force), n + 1])
         found%displacement = reshape([found%displacement, distance], [size(distance), n + 1])
         found%is_isolated = [found%is_isolated, is_isolated]
         found%n = n + 1
      end associate
   end subroutine keep_if_new

   !> Eliminates unknowns by the equations in the last rows, the largest pivot first; equations without a pivot are kept
   !> for the points that follow.
   pure subroutine eliminate(rows, n_kept, n_equations, n_left, least_pivot, is_possible, is_singular)
      real(dp), intent(inout) :: rows(:, 0:)
         !! the rows; on return equations and unknowns that are left follow those before them without gaps
      integer, intent(in) :: n_kept !! number of the first unknowns, which are not to be eliminated
      integer, intent(in) :: n_equations !! number of equations, and of the unknowns to be eliminated
      integer, intent(out) :: n_left !! number of equations and unknowns that are left
      real(dp), intent(in) :: least_pivot !! least pivot
      logical, intent(out) :: is_possible !! false if an equation that is left contradicts itself
      logical, intent(out) :: is_singular !! whether an equation that is left is empty for any of the points to come
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
         if (any(abs(rows(i, 1:n_kept + n_left)) > pivot_rounding)) cycle
         is_singular = .true.
         is_possible = is_possible .and. abs(rows(i, 0)) <= loose
      end do
   end subroutine eliminate

   !> Whether more than one point fulfills the inequalities: whether a linear function of the unknowns with irregular
   !> coefficients has different values on them. Its extremes are linear programs, whose optimality conditions are
   !> complementarity problems.
   pure logical function has_extent(inequalities)
      real(dp), intent(in) :: inequalities(:, 0:) !! constants and factors of the inequalities (k, 0:n)
      real(dp), parameter :: far = 1.0e3_dp, golden = 0.61803398874989485_dp
      real(dp), dimension(size(inequalities, 1) + 2*ubound(inequalities, 2)) :: right, cover, z
      real(dp) :: matrix(size(right), size(right)), slope(ubound(inequalities, 2)), extreme(2)
      type(error_t), allocatable :: error
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
         right(n + 1:upper) = inequalities(:, 0) + computed_rounding - far*sum(inequalities(:, 1:), dim=2)
         do i = 1, n
            matrix(upper + i, i) = -1.0_dp
         end do
         right(upper + 1:) = 2.0_dp*far
      end associate
      matrix(:n, n + 1:) = -transpose(matrix(n + 1:, :n))
      do direction = 1, 2
         right(:n) = merge(slope, -slope, direction == 1)
         call lemke_pivoting(matrix, right, cover, is_basic, z, outcome, error)
         if (allocated(error) .or. outcome /= pivoting_solved) return
         extreme(direction) = dot_product(slope, z(:n))
      end do
      has_extent = extreme(2) - extreme(1) > sqrt(computed_rounding)
   end function has_extent

end module amontons_uniqueness
