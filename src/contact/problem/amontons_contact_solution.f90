!> The solution of a contact problem with the record of the method's iterations; and the abstract contact method with
!> the options of all methods.
module amontons_contact_solution
   use amontons_contact_problem, only: contact_problem_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: open_point
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: contact_method_t, contact_solution_t, dual_method_t, effort_t, method_options_t, new_contact_solution

   !> The work of a method: products with matrices, and factorizations. A product with a part of S or A counts by the
   !> size of the part, and so does an update by a few of its columns; triangular solutions are not counted.
   type :: effort_t
      real(dp) :: n_products = 0.0_dp !! products of S or A with a vector [-]
      integer :: n_factorizations = 0 !! factorizations of a dense or sparse matrix, of any order
   contains
      procedure :: add => effort_add
      procedure :: factorize => effort_factorize
      procedure :: multiply => effort_multiply
   end type effort_t

   !> Forces, displacements and statuses of the contact points. A method starts from the forces and displacements that
   !> it finds here, and replaces them by its result.
   type :: contact_solution_t
      real(dp), allocatable :: force(:) !! lambda = (lambda_N; lambda_T) (n) [F]
      real(dp), allocatable :: displacement(:) !! v = (u_N; u_T) (n) [L]
      real(dp), allocatable :: retained(:, :)
         !! displacements and contact forces of the nodes that the body is condensed to; allocated where bodies slide
         !! far (retained rows, 2) [L], [F]
      real(dp), allocatable :: posed(:, :)
         !! shift and turn of each piece that turns, and force and moment that its rigid set exerts on it; allocated
         !! beside these (6, pieces) [L], [rad], [F], [F L]
      real(dp), allocatable :: pushed(:, :)
         !! force on the rigid obstacle of each contact set, and moment about its pivot; allocated beside these
         !! (4, sets) [F], [F L]
      integer, allocatable :: status(:) !! status of each point, see `amontons_friction_law` (m)
      logical :: is_converged = .false. !! whether the residual is at most the tolerance
      logical :: is_at_rest = .false. !! whether the method stopped because its forces no longer changed
      integer :: n_iterations = 0 !! number of iterations done
      type(effort_t) :: effort !! work of the iterations
      real(dp) :: residual = huge(1.0_dp) !! residual of this pair (v, lambda) [-]
      real(dp) :: force_scale = 0.0_dp !! the force that it is a share of, where it was measured [F]
      real(dp), allocatable :: history(:) !! residual after each iteration (at least n_iterations) [-]
   contains
      procedure :: body_displacement => contact_solution_body_displacement
      procedure :: body_force => contact_solution_body_force
      procedure :: prepend => contact_solution_prepend
      procedure :: is_stagnant => contact_solution_is_stagnant
      procedure :: measure => contact_solution_measure
      procedure :: take_better => contact_solution_take_better
      procedure :: reset => contact_solution_reset
      procedure :: record_residual => contact_solution_record_residual
      procedure :: record => contact_solution_record
   end type contact_solution_t

   !> The choice of a method and its options; options that a method does not use have no effect. All are of fixed size,
   !> so that they can be copied between ranks.
   type :: method_options_t
      real(dp) :: tolerance = 1.0e-10_dp !! residual that counts as solved [-]
      integer :: max_iterations = 1000 !! most iterations, of the method's own kind
      character(24) :: method = 'auto' !! one of `method_names`
      character(24) :: variant = 'exact' !! of splitting: one of its `variant_names`
      character(24) :: space = 'dual' !! of psor: one of its `space_names`
      character(24) :: box = 'auto' !! of splitting and fixed_point: one of `box_names`
      character(24) :: local = 'point' !! of psor: one of `local_names`
      character(24) :: acceleration = 'none' !! of psor: one of `acceleration_names`
      real(dp) :: omega = 1.0_dp !! of psor: relaxation, above 0 and below 2 [-]
   end type method_options_t

   !> A method with its options. A new method is one new extension of this type.
   type, abstract, extends(method_options_t) :: contact_method_t
   contains
      procedure :: prepare => contact_method_prepare
      procedure(solve_interface), deferred :: solve
   end type contact_method_t

   !> A method that works on the compliance.
   type, abstract, extends(contact_method_t) :: dual_method_t
   contains
      procedure :: prepare => dual_method_prepare
   end type dual_method_t

   abstract interface
      !> Solves a contact problem from the forces and displacements in `solution`. Not converged is a result, reported
      !> in `solution%is_converged`.
      subroutine solve_interface(self, problem, solution, error)
         import :: contact_method_t, contact_problem_t, contact_solution_t, error_t
         implicit none (type, external)
         class(contact_method_t), intent(in) :: self !! the method
         type(contact_problem_t), intent(in) :: problem !! the problem; its operator may gain dense matrices
         type(contact_solution_t), intent(inout) :: solution !! starting point; the result on return
         type(error_t), allocatable, intent(out) :: error !! the problem's data are unusable, or memory ran out
      end subroutine solve_interface
   end interface

contains

   !> Makes a solution at rest: no forces, no displacements.
   pure subroutine new_contact_solution(solution, n_points, n_tangents)
      type(contact_solution_t), intent(out) :: solution !! the solution
      integer, intent(in) :: n_points !! number of contact points
      integer, intent(in) :: n_tangents !! number of tangential directions of a point

      allocate (solution%force((1 + n_tangents)*n_points), source=0.0_dp)
      solution%displacement = solution%force
      allocate (solution%status(n_points), source=open_point)
      allocate (solution%history(0))
   end subroutine new_contact_solution

   !> Displacements that the body is condensed to: those of the points, or of the nodes of sets that slide far (retained
   !> rows) [L].
   pure function contact_solution_body_displacement(self) result(displacement)
      class(contact_solution_t), intent(in) :: self !! the solution
      real(dp), allocatable :: displacement(:)

      displacement = self%displacement
      if (allocated(self%retained)) displacement = self%retained(:, 1)
   end function contact_solution_body_displacement

   !> Contact forces along these displacements (retained rows) [F].
   pure function contact_solution_body_force(self) result(force)
      class(contact_solution_t), intent(in) :: self !! the solution
      real(dp), allocatable :: force(:)

      force = self%force
      if (allocated(self%retained)) force = self%retained(:, 2)
   end function contact_solution_body_force

   !> Begins a new record; forces and displacements remain as the starting point.
   pure subroutine contact_solution_reset(self)
      class(contact_solution_t), intent(inout) :: self !! the solution

      self%is_converged = .false.
      self%is_at_rest = .false.
      self%n_iterations = 0
      self%effort = effort_t()
      self%residual = huge(self%residual)
      if (allocated(self%history)) deallocate (self%history)
      allocate (self%history(0))
   end subroutine contact_solution_reset

   !> Records the pair (v, lambda) at the end of an iteration: residual, statuses, whether it is a solution.
   pure subroutine contact_solution_record(self, problem, displacement, force, tolerance, may_continue)
      class(contact_solution_t), intent(inout) :: self !! the solution
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: displacement(:) !! v (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      real(dp), intent(in) :: tolerance !! the residual that counts as solved [-]
      logical, intent(out) :: may_continue !! false when solved, or when the numbers have left the finite range

      self%displacement = displacement
      self%force = force
      call self%measure(problem)
      call self%record_residual(self%residual)
      self%is_converged = self%residual <= tolerance
      may_continue = .not. self%is_converged .and. self%residual < huge(self%residual)
   end subroutine contact_solution_record

   !> Computes residual and statuses of the present pair.
   pure subroutine contact_solution_measure(self, problem)
      class(contact_solution_t), intent(inout) :: self !! the solution
      type(contact_problem_t), intent(in) :: problem !! the problem

      call problem%measure(self%displacement, self%force, self%residual, self%force_scale)
      call self%effort%multiply(1.0_dp)
      self%status = problem%status(self%displacement, self%force)
   end subroutine contact_solution_measure

   !> Whether the smallest of the last residuals is more than a given share of the smallest residual before them.
   pure logical function contact_solution_is_stagnant(self, limit, decrease) result(is_stagnant)
      class(contact_solution_t), intent(in) :: self !! the solution
      integer, intent(in) :: limit !! number of residuals that count as the last ones
      real(dp), intent(in) :: decrease !! the part that it should be at the most [-]
      integer :: n

      n = self%n_iterations - limit
      is_stagnant = n > 0
      if (is_stagnant) is_stagnant = minval(self%history(n + 1:n + limit)) > decrease*minval(self%history(:n))
   end function contact_solution_is_stagnant

   !> Replaces the pair, with its residual and statuses, by that of another solution if it is better; the record is
   !> kept.
   pure subroutine contact_solution_take_better(self, other)
      class(contact_solution_t), intent(inout) :: self !! the solution
      type(contact_solution_t), intent(in) :: other !! the other solution

      if (.not. other%residual < self%residual) return
      self%force = other%force
      self%displacement = other%displacement
      self%status = other%status
      self%residual = other%residual
   end subroutine contact_solution_take_better

   !> Puts the iterations of the solution that this one started from before its own.
   pure subroutine contact_solution_prepend(self, first)
      class(contact_solution_t), intent(inout) :: self !! the solution
      type(contact_solution_t), intent(in) :: first !! the one that it started from

      self%history = [first%history(:first%n_iterations), self%history(:self%n_iterations)]
      self%n_iterations = size(self%history)
      call self%effort%add(first%effort)
   end subroutine contact_solution_prepend

   !> Counts an iteration with the residual that the method itself computes. Such a residual never means converged.
   pure subroutine contact_solution_record_residual(self, residual)
      class(contact_solution_t), intent(inout) :: self !! the solution
      real(dp), intent(in) :: residual !! residual after the iteration [-]

      self%n_iterations = self%n_iterations + 1
      if (self%n_iterations > size(self%history)) then
         self%history = [self%history, spread(0.0_dp, 1, self%n_iterations)]
      end if
      self%history(self%n_iterations) = residual
   end subroutine contact_solution_record_residual

   !> Adds the work of a part of the method.
   pure subroutine effort_add(self, part)
      class(effort_t), intent(inout) :: self !! the effort
      type(effort_t), intent(in) :: part !! that of the part

      self%n_products = self%n_products + part%n_products
      self%n_factorizations = self%n_factorizations + part%n_factorizations
   end subroutine effort_add

   !> Counts a factorization, if it was made.
   pure subroutine effort_factorize(self, is_made)
      class(effort_t), intent(inout) :: self !! the effort
      logical, intent(in) :: is_made !! whether a matrix is factorized

      if (is_made) self%n_factorizations = self%n_factorizations + 1
   end subroutine effort_factorize

   !> Adds matrix-vector products to the effort of a method.
   pure subroutine effort_multiply(self, n_products)
      class(effort_t), intent(inout) :: self !! the effort
      real(dp), intent(in) :: n_products !! number of products, in units of one with the whole matrix [-]

      self%n_products = self%n_products + n_products
   end subroutine effort_multiply

   !> Makes the dense matrices that every solution by this method needs, for all problems on an operator. The default
   !> needs none.
   subroutine contact_method_prepare(self, problem, error)
      class(contact_method_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! a problem on the operator
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite, or memory ran out

      associate (unused => self, unused_problem => problem)
      end associate
   end subroutine contact_method_prepare

   !> Makes the compliance A, which dual methods need, once for all problems on the operator.
   subroutine dual_method_prepare(self, problem, error)
      class(dual_method_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! a problem on the operator
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite, or memory ran out

      associate (unused => self)
      end associate
      call problem%matrix%prepare_compliance(error)
   end subroutine dual_method_prepare

end module amontons_contact_solution
