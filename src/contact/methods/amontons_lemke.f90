!> Lemke's pivoting on the plane problem, which Coulomb's law makes a linear complementarity problem: a finite method,
!> exact but for rounding, for problems of up to some hundreds of points.
!>
!> The tangential law is split at its two bounds: s_1 = g + phi lambda_N - lambda_T >= 0 and s_2 = g + phi lambda_N +
!> lambda_T >= 0 face the two directions of slip, u_T - a = w_1 - w_2, w_1 >= 0 against s_1, w_2 >= 0 against s_2. With
!> p = d - u_N against lambda_N these are 3m pairs. In the dual form (A) the variables are z = (lambda_N, s_1, w_2), in
!> the primal form (S) z = (p, w_1, w_2); no proximal iteration is needed there. Section 6 of doc/theory.md proves that
!> with the covering vectors below the pivots end in a solution for friction of any size, unless a rigid motion exists
!> (dual: forces without effect) that the loads can drive.
module amontons_lemke
   use amontons_contact_problem, only: active_set_t, contact_problem_t
   use amontons_contact_relation, only: contact_relation_t, lemke_pivoting, new_contact_relation
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, effort_t
   use amontons_dense, only: allocate_matrix
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: lemke_t

   !> Largest number of points: each pivot goes through the tableau of 3m x 3m numbers.
   integer, parameter :: max_points = 1000

   !> Lemke's pivoting; an iteration is a run of all pivots from one covering vector.
   type, extends(contact_method_t) :: lemke_t
   contains
      procedure :: solve => lemke_solve
   end type lemke_t

contains

   !> Solves a contact problem; the starting point has no effect.
   subroutine lemke_solve(self, problem, solution, error)
      class(lemke_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! the result
      type(error_t), allocatable, intent(out) :: error !! the problem has too many points
      ! If rounding errors make a path fail, another covering vector rarely fails too.
      integer, parameter :: n_covers = 5
      ! M of the pairs is 3m x 3m, S and A are 2m x 2m.
      real(dp), parameter :: size_of_pairs = 2.25_dp
      type(contact_relation_t) :: relation
      type(contact_solution_t) :: best
      type(effort_t) :: effort
      type(active_set_t) :: states
      real(dp), dimension(2*problem%n_points) :: force, distance, displacement
      integer :: trial, outcome, info, m, i
      logical :: is_singular, may_continue, is_z_basic(3*problem%n_points)
      real(dp) :: right(3*problem%n_points), z(3*problem%n_points), cover(3*problem%n_points)
      real(dp), allocatable :: matrix(:, :)
      ! Steps by the golden section fill an interval evenly.
      real(dp), parameter :: golden = 0.61803398874989485_dp

      if (problem%matrix%n_tangents == 2) then
         call new_error(error, input_refused, 'the method lemke is for the plane: friction in space is no linear '// &
            'complementarity problem')
      else if (problem%n_points > max_points) then
         call new_error(error, input_refused, 'the method lemke takes at most '//to_text(max_points)// &
            ' contact points, this problem has '//to_text(problem%n_points))
      end if
      if (allocated(error)) return
      m = problem%n_points
      call solution%reset()
      best = solution
      if (problem%is_unloaded()) then
         ! Rest solves it; the path would begin with all points closed, whatever their gaps.
         force = 0.0_dp
         displacement = 0.0_dp
         if (allocated(problem%free_displacement)) displacement = problem%free_displacement
         call solution%record(problem, displacement, force, self%tolerance, may_continue)
         return
      end if
      call new_contact_relation(relation, problem, error)
      if (.not. allocated(error)) call allocate_matrix(matrix, 3*problem%n_points, 3*problem%n_points, &
         "the pairs of Lemke's method", error)
      if (allocated(error)) return
      call solution%effort%multiply(1.0_dp)
      if (relation%is_dual) then
         call dual_pairs(relation, matrix, right)
      else
         call primal_pairs(relation, matrix, right)
      end if
      do trial = 1, min(n_covers, self%max_iterations)
         effort = effort_t()
         ! A covering vector: it pulls the points off and along +t (dual), or presses them on and raises the slip bound
         ! (primal). Its numbers are irregular, so that the path does not pass through degenerate vertices of symmetric
         ! problems.
         m = relation%n_points
         cover = 1.0_dp + modulo([(golden*i*trial, i=1, 3*m)], 1.0_dp)
         if (relation%is_dual) then
            ! Forces in their cones must not work on it: phi c_T < c_N.
            cover(m + 1:2*m) = 0.25_dp*cover(m + 1:2*m)/(1.0_dp + relation%friction)
         else
            cover(m + 1:) = cover(m + 1:) + [relation%friction*cover(:m), relation%friction*cover(:m)]
         end if
         call lemke_pivoting(matrix, right, cover, is_z_basic, z, outcome, error, effort)
         if (allocated(error)) return
         states%is_closed = is_z_basic(:m) .eqv. relation%is_dual
         ! Without any bound both may be zero; either direction is then equivalent.
         states%slip_direction = merge(1, merge(-1, 0, is_z_basic(2*m + 1:)), &
            is_z_basic(m + 1:2*m) .neqv. relation%is_dual)
         ! The states, not the numbers of the tableau, are the result: one fresh system has one rounding error.
         call relation%solve_states(states, force, distance, info)
         call effort%factorize(.true.)
         is_singular = info /= 0
         effort%n_products = size_of_pairs*effort%n_products
         force = force*relation%force_unit
         displacement = distance*relation%distance_unit + problem%reference()
         if (.not. (is_singular .or. relation%is_dual)) call refine(relation, states, problem, displacement, force, &
            effort)
         call solution%effort%add(effort)
         call solution%record(problem, displacement, force, self%tolerance, may_continue)
         if (solution%is_converged) return
         if (solution%residual < best%residual) best = solution
      end do
      call solution%take_better(best)
   end subroutine lemke_solve

   !> Removes rounding errors of displacements and forces that the states do not determine: distances of open points may
   !> have errors as large as gaps, while displacements and forces are small.
   pure subroutine refine(relation, states, problem, displacement, force, effort)
      type(contact_relation_t), intent(in) :: relation !! the relation, in its primal form
      type(active_set_t), intent(in) :: states !! the states of the points
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(inout) :: displacement(:) !! v (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda (2m) [F]
      type(effort_t), intent(inout) :: effort !! gains that of the product and of the system
      type(contact_relation_t) :: defect
      real(dp), dimension(2*problem%n_points) :: imbalance, missing_force, missing_distance
      integer :: info

      call problem%matrix%multiply_stiffness(displacement, imbalance)
      call effort%multiply(1.0_dp)
      defect = relation
      defect%vector = (problem%load - imbalance - force)/relation%force_unit
      defect%slip_bound = 0.0_dp
      call defect%solve_states(states, missing_force, missing_distance, info)
      call effort%factorize(.true.)
      if (info /= 0) return
      displacement = displacement + missing_distance*relation%distance_unit
      force = force + missing_force*relation%force_unit
   end subroutine refine

   !> The complementarity problem of the dual form: p, w_1 and s_2 in terms of lambda_N, s_1 and w_2.
   pure subroutine dual_pairs(relation, matrix, right)
      type(contact_relation_t), intent(in) :: relation !! the relation w = B - A lambda
      real(dp), intent(out) :: matrix(:, :) !! M (3m, 3m)
      real(dp), intent(out) :: right(:) !! q (3m)
      integer :: m, k

      m = relation%n_points
      matrix = 0.0_dp
      associate (a => relation%matrix, friction => relation%friction, bound => relation%slip_bound)
         ! lambda_T = g + phi lambda_N - s_1
         do k = 1, m
            matrix(:m, k) = a(:m, k) + friction(k)*a(:m, m + k)
            matrix(m + 1:2*m, k) = -a(m + 1:, k) - friction(k)*a(m + 1:, m + k)
            matrix(:m, m + k) = -a(:m, m + k)
            matrix(m + 1:2*m, m + k) = a(m + 1:, m + k)
            matrix(m + k, 2*m + k) = 1.0_dp
            matrix(2*m + k, k) = 2.0_dp*friction(k)
            matrix(2*m + k, m + k) = -1.0_dp
         end do
         right(:m) = matmul(a(:m, m + 1:), bound) - relation%vector(:m)
         right(m + 1:2*m) = relation%vector(m + 1:) - matmul(a(m + 1:, m + 1:), bound)
         right(2*m + 1:) = 2.0_dp*bound
      end associate
   end subroutine dual_pairs

   !> The complementarity problem of the primal form: lambda_N, s_1 and s_2 in terms of p, w_1 and w_2.
   pure subroutine primal_pairs(relation, matrix, right)
      type(contact_relation_t), intent(in) :: relation !! the relation lambda = r - S w
      real(dp), intent(out) :: matrix(:, :) !! M (3m, 3m)
      real(dp), intent(out) :: right(:) !! q (3m)
      real(dp) :: normal(3*relation%n_points), tangential(3*relation%n_points)
      integer :: m, k

      m = relation%n_points
      associate (s => relation%matrix, r => relation%vector, friction => relation%friction)
         do k = 1, m
            normal = [s(k, :m), -s(k, m + 1:), s(k, m + 1:)]
            tangential = [s(m + k, :m), -s(m + k, m + 1:), s(m + k, m + 1:)]
            matrix(k, :) = normal
            matrix(m + k, :) = friction(k)*normal - tangential
            matrix(2*m + k, :) = friction(k)*normal + tangential
         end do
         right(:m) = r(:m)
         right(m + 1:2*m) = relation%slip_bound + friction*r(:m) - r(m + 1:)
         right(2*m + 1:) = relation%slip_bound + friction*r(:m) + r(m + 1:)
      end associate
   end subroutine primal_pairs

end module amontons_lemke
