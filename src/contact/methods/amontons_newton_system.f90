!> The abstract linear system of a Newton step, what an active set leads to; and the one in the displacements, on the
!> condensed stiffness S.
!>
!> Newton's linear system in the displacements of a whole slender body, whose condensed stiffness is never made; and a
!> start for Newton's method on it.
!>
!> The rows of K u = f that hold an unknown displacement, the interior's among them; closed u_N and sticking u_T are
!> known, and a closed sliding point has its tangential row less phi times its normal one. It gives the same steps as
!> the condensed stiffness does.
!>
!> Newton's linear system in the forces, on a compliance A, dense or sparse.
!>
!> A normal force of a closed point and a tangential one of a sticking point are unknown: a row of `A lambda = B` each,
!> of no distance and of no slip, holds them. The others follow from the law. On a dense compliance an active set that
!> differs from the factorized one in few rows is solved by that factorization and a small system of these rows.
module amontons_newton_system
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_band_matrix, only: band_lu_t, new_band_matrix
   use amontons_contact_problem, only: active_set_t, contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, effort_t
   use amontons_dense, only: add_product, allocate_matrix, cholesky_factor, cholesky_solve, lu_factor, lu_solve, &
      lu_solve_transposed, transposed_product
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_friction_law, only: bounded
   use amontons_kinds, only: dp, int64
   use amontons_sparse_lu, only: sparse_lu_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: band_stiffness_system_t, compliance_system_t, newton_system_t, sparse_compliance_system_t, &
      spring_start_t, stiffness_system_t

   !> A way to solve the linear equations of an active set. It may keep what serves the next active set as well.
   type, abstract :: newton_system_t
      type(effort_t) :: effort !! what the steps took so far
      type(error_t), allocatable :: error !! memory ran out; no step was made then
      real(dp) :: first_regularization = 1.0_dp !! regularization, as part of the diagonal in the first step [-]
      real(dp) :: min_regularization = 0.0_dp !! least regularization in any step [-]
   contains
      procedure(solve_interface), deferred :: solve
   end type newton_system_t

   abstract interface
      !> Solves the equations of an active set, a proximal step: `regularization` times the diagonal, times the
      !> step, is added to them, so that an active set which leaves them singular still gives a step.
      subroutine solve_interface(self, problem, active_set, regularization, displacement, force, imbalance, info)
         import :: active_set_t, contact_problem_t, dp, newton_system_t
         implicit none (type, external)
         class(newton_system_t), intent(inout) :: self !! the system
         type(contact_problem_t), intent(in) :: problem !! the problem, the same in all steps
         type(active_set_t), intent(in) :: active_set !! state of each point
         real(dp), intent(in) :: regularization !! regularization, as part of the diagonal [-]
         real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
         real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
         real(dp), intent(out) :: imbalance !! largest violation of the equilibrium by the pair after the step [F]
         integer, intent(out) :: info !! 0, or nonzero where the system has no finite solution; no step is made then
      end subroutine solve_interface
   end interface

   !> The rows of `S v = q - lambda` that hold an unknown displacement, with lambda_N of a closed sliding point
   !> eliminated by its own row.
   type, extends(newton_system_t) :: stiffness_system_t
      private
      real(dp), allocatable :: diagonal(:) !! Diagonal of S (2m) [F/L].
   contains
      procedure, public :: solve => stiffness_system_solve
   end type stiffness_system_t

   !> The equations of one active set, by position.
   type :: equations_t
      logical, allocatable :: is_known(:) !! whether the displacement is known (n)
      real(dp), allocatable :: known(:) !! the known displacements, 0 else (n) [L]
      real(dp), allocatable :: stiffening(:) !! what is added to the diagonal (n) [F/L]
      real(dp), allocatable :: load(:) !! loads, with what goes with the stiffening (n) [F]
      real(dp), allocatable :: slope(:) !! how many times the normal row is taken off a point's tangential one (m) [-]
      real(dp), allocatable :: coupling(:) !! stiffness of a point's slip against its normal displacement (m) [F/L]
   end type equations_t

   !> The system, with room for its factors.
   type, extends(newton_system_t) :: band_stiffness_system_t
      private
      type(band_lu_t) :: factors !! the factors of the last active set
   contains
      procedure, public :: solve => band_stiffness_system_solve
      procedure :: solve_softened => band_stiffness_system_solve_softened
      procedure :: solve_equations => band_stiffness_system_solve_equations
   end type band_stiffness_system_t

   !> A first pair of forces and displacements found in a way that lets fronts of opening or sliding pass, which
   !> Newton's steps move by a few points each: by springs between the points and the obstacle, so soft at first that
   !> the ends of the line feel each other, and so hard at last that neighbors hardly do.
   type, extends(contact_method_t) :: spring_start_t
   contains
      procedure :: solve => spring_start_solve
   end type spring_start_t

   !> The active set that is factorized, and its unknowns; an extension holds the factors.
   type, abstract, extends(newton_system_t) :: force_system_t
      type(active_set_t) :: base !! The active set that is factorized.
      real(dp) :: regularization = -1.0_dp !! Regularization of the factorization; -1 if there is none [-].
      integer, allocatable :: unknown(:) !! The forces that are unknown in it.
      real(dp), allocatable :: diagonal(:) !! Diagonal of A, where it is zero the largest of all (2m) [L/F].
      real(dp), private :: spread = 100.0_dp
         !! How many times the regularization that is wanted it may be; with less it is no use, with much more slow [-].
      integer, private :: least_order = 200
         !! Below this order a new factorization costs no more than the bookkeeping of an update.
      integer, private :: n_changed = 0 !! Number of rows that have changed since.
      integer, allocatable, private :: changed(:) !! These rows.
      real(dp), allocatable, private :: response(:, :)
         !! Solutions of the factorized system for a unit in each of these rows.
      real(dp), allocatable, private :: row(:, :) !! These rows of A.
   contains
      procedure, private :: apply => force_system_apply
      procedure, private :: begin => force_system_begin
      procedure, private :: correct => force_system_correct
      procedure(factorize_interface), deferred :: factorize
      procedure :: solve => force_system_solve
      procedure(solve_unknown_interface), deferred :: solve_unknown
      procedure, private :: update => force_system_update
   end type force_system_t

   abstract interface
      !> Factorizes the system of the base.
      subroutine factorize_interface(self, problem, info)
         import :: contact_problem_t, force_system_t
         implicit none (type, external)
         class(force_system_t), intent(inout) :: self !! the system, its base and unknowns known
         type(contact_problem_t), intent(in) :: problem !! the problem
         integer, intent(out) :: info !! 0, or nonzero where the system is singular
      end subroutine factorize_interface

      !> Solves the factorized system for its unknown forces.
      subroutine solve_unknown_interface(self, right, info)
         import :: dp, force_system_t
         implicit none (type, external)
         class(force_system_t), intent(in) :: self !! the system
         real(dp), contiguous, intent(inout) :: right(:, :) !! right-hand sides, the solutions on return
         integer, intent(out) :: info !! 0, or nonzero where the system is singular
      end subroutine solve_unknown_interface

   end interface

   !> The system on a dense compliance A: a row for each force, an unknown one that of `A lambda = B`, the others that
   !> of the law which gives them.
   type, extends(force_system_t) :: compliance_system_t
      private
      logical :: is_symmetric = .false. !! Whether no point slides with friction, so that its matrix is symmetric.
      real(dp), allocatable :: entries(:)
         !! Cholesky factor, or triangular factors of the transposed matrix, and room: memory is costly to get anew.
      integer, allocatable :: pivots(:) !! Their row exchanges.
   contains
      procedure, public :: factorize => compliance_system_factorize
      procedure, public :: solve_unknown => compliance_system_solve_unknown
   end type compliance_system_t

   !> The rows of `A lambda = B` of the unknown forces, on a sparse compliance A, which stays sparse.
   type, extends(force_system_t) :: sparse_compliance_system_t
      private
      type(sparse_lu_t) :: factors !! Triangular factors of its transposed matrix.
   contains
      procedure, public :: factorize => sparse_compliance_system_factorize
      procedure, public :: solve_unknown => sparse_compliance_system_solve_unknown
   end type sparse_compliance_system_t

   !> Changed rows, as a part of the order, that an update may have: more cost as much as a new factorization.
   integer, parameter :: part = 6

contains

   !> Solves for the displacements, then takes the forces from the equilibrium.
   subroutine stiffness_system_solve(self, problem, active_set, regularization, displacement, force, imbalance, info)
      class(stiffness_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a stiffness
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of S [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      real(dp), intent(out) :: imbalance !! largest violation of S v = q - lambda by the pair after the step [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), allocatable :: matrix(:, :), right(:)
      integer, allocatable :: unknown(:)
      real(dp) :: load(size(force)), slope(problem%n_points)
      integer :: m, n, i, point
      real(dp) :: known(2*problem%n_points)

      m = problem%n_points
      if (.not. allocated(self%diagonal)) self%diagonal = problem%augmentation()
      unknown = pack([(i, i=1, 2*m)], .not. active_set%gives_force())
      n = size(unknown)
      slope = merge(problem%friction*active_set%slip_direction, 0.0_dp, active_set%is_closed)
      known = merge(problem%reference(), 0.0_dp, active_set%gives_force())
      load = 0.0_dp
      if (any(abs(known) > 0.0_dp)) then
         call problem%matrix%multiply_stiffness(known, load)
         call self%effort%multiply(1.0_dp)
      end if
      load = problem%load - load
      load(m + 1:) = load(m + 1:) - active_set%slip_direction*problem%slip_bound
      info = 1
      call allocate_matrix(matrix, n, n, "Newton's unknowns", self%error)
      if (allocated(self%error)) return
      allocate (right(n))
      call problem%matrix%stiffness%fill_block(unknown, unknown, matrix)
      do i = 1, n
         matrix(i, i) = matrix(i, i) + regularization*self%diagonal(unknown(i))
         right(i) = load(unknown(i)) + regularization*self%diagonal(unknown(i))*displacement(unknown(i))
      end do
      do i = 1, n
         point = unknown(i) - m
         if (point < 1) cycle
         if (.not. abs(slope(point)) > 0.0_dp) cycle
         matrix(i, :) = matrix(i, :) - slope(point)*problem%matrix%stiffness%values(unknown, point)
         right(i) = right(i) - slope(point)*load(point)
      end do
      call self%effort%factorize(n > 0)
      call lu_solve(matrix, right, info)
      if (.not. all(ieee_is_finite(right))) info = 1
      if (info /= 0) return
      displacement = problem%reference()
      displacement(unknown) = right
      call problem%matrix%multiply_stiffness(displacement, force)
      force = problem%load - force
      call active_set%impose(problem, force, imbalance)
      call self%effort%multiply(1.0_dp)
   end subroutine stiffness_system_solve

   !> Finds the pair of the hardest springs.
   subroutine spring_start_solve(self, problem, solution, error)
      class(spring_start_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, on a band
      type(contact_solution_t), intent(inout) :: solution !! the result
      type(error_t), allocatable, intent(out) :: error !! never allocated; kept for the common interface
      real(dp), parameter :: hardest = 10.0_dp, factor = 10.0_dp
      integer, parameter :: most_steps = 4
      type(band_stiffness_system_t) :: system
      type(active_set_t) :: active_set, last
      real(dp), dimension(2*problem%n_points) :: rho, next, force, no_force
      real(dp) :: scale, hardness
      integer :: step, info, m

      m = problem%n_points
      call solution%reset()
      rho = problem%augmentation()
      scale = problem%force_scale()
      no_force = 0.0_dp
      call active_set%assume_stick(problem, rho, scale)
      hardness = 1.0_dp/real(m, dp)**2
      do while (hardness <= hardest)
         do step = 1, most_steps
            call system%solve_softened(problem, active_set, hardness*rho, next, force, info)
            if (info /= 0 .or. solution%n_iterations >= self%max_iterations) exit
            solution%displacement = next
            call solution%record_residual(problem%violation(next, force)/scale)
            last = active_set
            call active_set%update(problem, hardness*rho, next, no_force)
            if (active_set%equals(last)) exit
         end do
         ! Forces of the springs, cut to the contact law: Newton's first active set is that of these springs.
         solution%force = hardness*rho*(solution%displacement - problem%reference())
         hardness = factor*hardness
      end do
      solution%force(:m) = max(0.0_dp, solution%force(:m))
      solution%force(m + 1:) = bounded(solution%force(m + 1:), problem%bound(solution%force(:m)))
      solution%effort = system%effort
      call solution%measure(problem)
   end subroutine spring_start_solve

   !> Solves for the displacements, then takes the forces from the equilibrium.
   subroutine band_stiffness_system_solve(self, problem, active_set, regularization, displacement, force, imbalance, &
      info)
      class(band_stiffness_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a band stiffness
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of S [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      real(dp), intent(out) :: imbalance !! largest violation of the equilibrium by the pair after the step [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      type(equations_t) :: equations
      real(dp), allocatable :: x(:), balanced(:)
      integer :: m

      m = problem%n_points
      imbalance = 0.0_dp
      associate (band => problem%matrix%band, place => problem%matrix%band%place)
         call new_equations(equations, problem, active_set%slip_direction)
         equations%is_known(place) = active_set%gives_force()
         equations%known(place) = merge(problem%reference(), 0.0_dp, equations%is_known(place))
         equations%stiffening(place) = regularization*band%diagonal
         equations%load(place) = equations%load(place) + regularization*band%diagonal*displacement
         equations%slope = merge(problem%friction*active_set%slip_direction, 0.0_dp, active_set%is_closed)
         call self%solve_equations(problem, equations, x, info)
         if (info /= 0) return
         displacement = x(place)
         allocate (balanced(size(x)))
         call band%whole%multiply(x, balanced)
         balanced(place) = balanced(place) - problem%load
         force = -balanced(place)
         balanced(place) = 0.0_dp
         call active_set%impose(problem, force, imbalance)
         imbalance = max(imbalance, maxval(abs(balanced)))
      end associate
      call self%effort%multiply(1.0_dp)
   end subroutine band_stiffness_system_solve

   !> Solves with springs between the points and the obstacle.
   subroutine band_stiffness_system_solve_softened(self, problem, active_set, springs, displacement, force, info)
      class(band_stiffness_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a band stiffness
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: springs(:) !! stiffness of the springs (2m) [F/L]
      real(dp), intent(out) :: displacement(:) !! v (2m) [L]
      real(dp), intent(out) :: force(:) !! lambda (2m) [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      type(equations_t) :: equations
      real(dp), allocatable :: x(:)
      integer :: m

      m = problem%n_points
      associate (place => problem%matrix%band%place)
         call new_equations(equations, problem, active_set%slip_direction)
         equations%stiffening(place) = merge(springs, 0.0_dp, active_set%gives_force())
         equations%load(place) = equations%load(place) + equations%stiffening(place)*problem%reference()
         equations%coupling = active_set%slip_direction*problem%friction*equations%stiffening(place(:m))
         equations%load(place(m + 1:)) = equations%load(place(m + 1:)) + equations%coupling*problem%gap
         call self%solve_equations(problem, equations, x, info)
         displacement = x(place)
         call problem%matrix%band%whole%multiply(x, equations%load)
         force = problem%load - equations%load(place)
      end associate
   end subroutine band_stiffness_system_solve_softened

   !> The equations of a body that nothing touches, but for the given slip bounds.
   pure subroutine new_equations(equations, problem, direction)
      type(equations_t), intent(out) :: equations !! the equations
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: direction(:) !! sign of the slip of each point, 0 if it sticks (m)

      associate (n => problem%matrix%band%whole%n, m => problem%n_points)
         allocate (equations%is_known(n), source=.false.)
         allocate (equations%known(n), equations%stiffening(n), equations%load(n), source=0.0_dp)
         allocate (equations%slope(m), equations%coupling(m), source=0.0_dp)
         equations%load(problem%matrix%band%place) = problem%load - [spread(0.0_dp, 1, m), direction*problem%slip_bound]
      end associate
   end subroutine new_equations

   !> Solves the equations, with one step of refinement: the condition of a slender body is high.
   subroutine band_stiffness_system_solve_equations(self, problem, equations, x, info)
      class(band_stiffness_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(equations_t), intent(in) :: equations !! the equations
      real(dp), allocatable, intent(out) :: x(:) !! all displacements by position (n) [L]
      integer, intent(out) :: info !! 0, or nonzero where the equations have no finite solution
      real(dp), allocatable :: right(:)

      call fill_matrix(self%factors, problem, equations)
      call self%factors%factorize(info)
      call self%effort%factorize(.true.)
      x = equations%known
      if (info /= 0) return
      right = load_residual(problem, equations, x)
      call self%factors%solve(right)
      x = x + right
      right = load_residual(problem, equations, x)
      call self%factors%solve(right)
      x = x + right
      if (.not. all(ieee_is_finite(x))) info = 1
   end subroutine band_stiffness_system_solve_equations

   !> Fills the matrix; the rows and columns of known displacements are those of the unit matrix.
   pure subroutine fill_matrix(matrix, problem, equations)
      type(band_lu_t), intent(inout) :: matrix !! the matrix
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(equations_t), intent(in) :: equations !! the equations
      integer :: i, j, p

      associate (whole => problem%matrix%band%whole, is_known => equations%is_known)
         ! A tangential row reaches as far as its normal one.
         call new_band_matrix(matrix, whole%n, whole%width + problem%matrix%band%reach)
         do j = 1, whole%n
            if (is_known(j)) then
               call matrix%add(j, j, 1.0_dp)
               cycle
            end if
            call matrix%add(j, j, whole%entry(1, j) + equations%stiffening(j))
            do i = j + 1, min(whole%n, j + whole%width)
               if (is_known(i)) cycle
               call matrix%add(i, j, whole%entry(i - j + 1, j))
               call matrix%add(j, i, whole%entry(i - j + 1, j))
            end do
         end do
      end associate
      associate (whole => problem%matrix%band%whole, is_known => equations%is_known, slope => equations%slope, &
         normal => problem%matrix%band%place(:problem%n_points), &
         tangential => problem%matrix%band%place(problem%n_points + 1:))
         do p = 1, problem%n_points
            if (abs(equations%coupling(p)) > 0.0_dp) call matrix%add(tangential(p), normal(p), equations%coupling(p))
            if (.not. abs(slope(p)) > 0.0_dp) cycle
            do j = max(1, normal(p) - whole%width), min(whole%n, normal(p) + whole%width)
               if (.not. is_known(j)) call matrix%add(tangential(p), j, -slope(p)*whole%element(normal(p), j))
            end do
         end do
      end associate
   end subroutine fill_matrix

   !> What given displacements leave of the load; 0 where they are known (n) [F].
   pure function load_residual(problem, equations, x)
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(equations_t), intent(in) :: equations !! the equations
      real(dp), intent(in) :: x(:) !! all displacements by position (n) [L]
      real(dp) :: load_residual(size(x))
      integer :: m

      m = problem%n_points
      associate (normal => problem%matrix%band%place(:m), tangential => problem%matrix%band%place(m + 1:))
         call problem%matrix%band%whole%multiply(x, load_residual)
         load_residual(tangential) = load_residual(tangential) &
            - equations%slope*(load_residual(normal) - problem%load(:m))
         load_residual = equations%load - load_residual - equations%stiffening*x
         load_residual(tangential) = load_residual(tangential) - equations%coupling*x(normal)
      end associate
      where (equations%is_known) load_residual = 0.0_dp
   end function load_residual

   !> Solves for the forces, then takes the displacements from them.
   subroutine force_system_solve(self, problem, active_set, regularization, displacement, force, imbalance, info)
      class(force_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      real(dp), intent(out) :: imbalance !! 0: the displacements are those of the forces [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), allocatable :: right(:, :)
      real(dp), dimension(size(force)) :: load, solution, known
      logical :: is_updated

      imbalance = 0.0_dp
      info = 0
      call self%update(problem, active_set, regularization, is_updated)
      if (allocated(self%error)) return
      if (.not. is_updated) call self%begin(problem, active_set, regularization, info)
      if (info /= 0) return
      load = problem%dual_load(displacement)
      solution = [spread(0.0_dp, 1, problem%n_points), self%base%slip_direction*problem%slip_bound]
      known = 0.0_dp
      if (any(abs(solution) > 0.0_dp)) then
         call problem%matrix%compliance%multiply(solution, known)
         call self%effort%multiply(1.0_dp)
      end if
      associate (unknown => self%unknown)
         allocate (right(size(unknown), 1))
         right(:, 1) = load(unknown) - known(unknown) + self%regularization*self%diagonal(unknown)*force(unknown)
         call self%solve_unknown(right, info)
         solution(unknown) = right(:, 1)
      end associate
      call self%apply(problem, solution)
      if (info == 0) call self%correct(problem, active_set, load, force, solution, info)
      if (.not. all(ieee_is_finite(solution))) info = 1
      if (info /= 0) return
      force = solution
      displacement = problem%displacement(load, force)
      call self%effort%multiply(1.0_dp)
   end subroutine force_system_solve

   !> Factorizes the system of an active set.
   subroutine force_system_begin(self, problem, active_set, regularization, info)
      class(force_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A [-]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      integer :: i, n

      n = 2*problem%n_points
      if (.not. allocated(self%diagonal)) then
         self%diagonal = 1.0_dp/problem%augmentation()
         allocate (self%changed(n), self%response(n, 0), self%row(n, 0))
         if (problem%matrix%compliance%is_sparse()) then
            self%spread = 10.0_dp
            self%least_order = huge(1)
         end if
      end if
      self%n_changed = 0
      self%base = active_set
      self%regularization = regularization
      self%unknown = pack([(i, i=1, n)], active_set%gives_force())
      call self%effort%factorize(size(self%unknown) > 0)
      call self%factorize(problem, info)
      if (info /= 0) self%regularization = -1.0_dp
   end subroutine force_system_begin

   !> Adds to the tangential forces of sliding points what their normal forces cause in the factorized active set.
   pure subroutine force_system_apply(self, problem, force)
      class(force_system_t), intent(in) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(inout) :: force(:) !! lambda (2m) [F]

      associate (m => problem%n_points)
         force(m + 1:) = force(m + 1:) + self%base%slip_direction*problem%friction*force(:m)
      end associate
   end subroutine force_system_apply

   !> Takes up the rows in which an active set differs from the factorized one, unless a new factorization is better,
   !> as it always is of a sparse compliance.
   subroutine force_system_update(self, problem, active_set, regularization, is_updated)
      class(force_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A that is wanted [-]
      logical, intent(out) :: is_updated !! whether the factorization serves the active set
      integer, allocatable :: differing(:), new(:)
      integer :: i, n
      real(dp), allocatable :: columns(:, :), rows(:, :)

      is_updated = self%regularization >= regularization .and. self%regularization <= self%spread*regularization
      if (.not. is_updated) return
      differing = pack([(i, i=1, 2*problem%n_points)], [self%base%is_closed .neqv. active_set%is_closed, &
         self%base%slip_direction /= active_set%slip_direction])
      n = self%n_changed
      new = pack(differing, [(.not. any(self%changed(:n) == differing(i)), i=1, size(differing))])
      if (size(new) == 0) return
      is_updated = size(self%unknown) >= self%least_order .and. part*(n + size(new)) <= size(self%unknown)
      if (.not. is_updated) return
      if (n + size(new) > size(self%response, 2)) then
         associate (n_forces => 2*problem%n_points, room => 2*(n + size(new)))
            call allocate_matrix(columns, n_forces, room, 'changed contact forces', self%error)
            if (.not. allocated(self%error)) call allocate_matrix(rows, n_forces, room, 'changed contact forces', &
               self%error)
         end associate
         is_updated = .not. allocated(self%error)
         if (.not. is_updated) return
         columns(:, :n) = self%response(:, :n)
         call move_alloc(columns, self%response)
         rows(:, :n) = self%row(:, :n)
         call move_alloc(rows, self%row)
      end if
      self%changed(n + 1:n + size(new)) = new
      do i = 1, size(new)
         self%row(:, n + i) = problem%matrix%compliance%values(:, new(i))
      end do
      self%n_changed = n + size(new)
      call unit_responses(self, problem, n + 1)
   end subroutine force_system_update

   !> Solves the factorized system for a unit in each changed row from one on.
   subroutine unit_responses(self, problem, first)
      class(force_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: first !! the first changed row to do
      real(dp), allocatable :: right(:, :)
      integer :: place(2*problem%n_points), i, m, k, r, info

      m = problem%n_points
      place = 0
      place(self%unknown) = [(i, i=1, size(self%unknown))]
      allocate (right(size(self%unknown), self%n_changed - first + 1), source=0.0_dp)
      do k = first, self%n_changed
         r = self%changed(k)
         self%response(:, k) = 0.0_dp
         associate (column => right(:, k - first + 1))
            if (place(r) > 0) then
               column(place(r)) = 1.0_dp
            else
               self%response(r, k) = 1.0_dp
               column = -self%row(self%unknown, k)
               if (r <= m) column = column - self%base%slip_direction(r)*problem%friction(r) &
                  *problem%matrix%compliance%values(self%unknown, m + r)
            end if
         end associate
      end do
      call self%solve_unknown(right, info)
      do k = first, self%n_changed
         self%response(self%unknown, k) = right(:, k - first + 1)
         call self%apply(problem, self%response(:, k))
      end do
   end subroutine unit_responses

   !> Corrects the forces of the factorized active set so that the changed rows hold as well.
   subroutine force_system_correct(self, problem, active_set, load, center, force, info)
      class(force_system_t), intent(in) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: load(:) !! dual load B (2m) [L]
      real(dp), intent(in) :: center(:) !! lambda before the step (2m) [F]
      real(dp), intent(inout) :: force(:) !! lambda of the factorized active set, corrected on return (2m) [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp) :: matrix(self%n_changed, self%n_changed), right(self%n_changed), product(self%n_changed)
      real(dp) :: slope(problem%n_points)
      logical :: is_unknown(size(force))
      integer :: m, k, r

      info = 0
      if (self%n_changed == 0) return
      m = problem%n_points
      slope = active_set%slip_direction*problem%friction
      is_unknown = active_set%gives_force()
      associate (n => self%n_changed)
         call transposed_product(self%row(:, :n), self%response(:, :n), matrix)
         product = matmul(force, self%row(:, :n))
         do k = 1, n
            r = self%changed(k)
            if (is_unknown(r)) then
               matrix(k, :) = matrix(k, :) + self%regularization*self%diagonal(r)*self%response(r, :n)
               right(k) = load(r) - product(k) + self%regularization*self%diagonal(r)*(center(r) - force(r))
            else if (r <= m) then
               matrix(k, :) = self%response(r, :n)
               right(k) = -force(r)
            else
               matrix(k, :) = self%response(r, :n) - slope(r - m)*self%response(r - m, :n)
               right(k) = active_set%slip_direction(r - m)*problem%slip_bound(r - m) - force(r) &
                  + slope(r - m)*force(r - m)
            end if
         end do
         call lu_solve(matrix, right, info)
         if (info /= 0) return
         call add_product(self%response(:, :n), right, force)
      end associate
   end subroutine force_system_correct

   !> Factorizes the system of the base.
   subroutine compliance_system_factorize(self, problem, info)
      class(compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), allocatable :: entries(:)
      integer :: n

      if (.not. allocated(self%entries)) allocate (self%entries(0))
      n = size(self%unknown)
      if (size(self%entries, kind=int64) < int(n, int64)**2) then
         deallocate (self%entries)
         allocate (self%entries(int(n, int64)**2), stat=info)
         if (info /= 0) then
            call new_error(self%error, system_failure, 'not enough memory: a dense matrix of '//to_text(n)// &
               ' unknown contact forces needs '//to_text(nint(8.0e-6_dp*real(n, dp)**2, int64))//' MB')
            return
         end if
      end if
      self%is_symmetric = .not. any(self%base%is_closed .and. self%base%slip_direction /= 0 &
         .and. problem%friction > 0.0_dp)
      ! No argument may hold what another one writes.
      call move_alloc(self%entries, entries)
      call factorize_entries(self, problem, n, entries, info)
      call move_alloc(entries, self%entries)
   end subroutine compliance_system_factorize

   !> Writes the transposed matrix of the active set to the first of its entries, and makes its factor of it.
   subroutine factorize_entries(self, problem, n, factor, info)
      class(compliance_system_t), intent(inout) :: self !! the system, without its entries; gains the row exchanges
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: n !! order of the matrix
      real(dp), intent(out) :: factor(n, n) !! the factor
      integer, intent(out) :: info !! 0, or nonzero where the matrix is singular
      real(dp) :: slopes(problem%n_points)
      integer :: i, j

      slopes = self%base%slip_direction*problem%friction
      associate (a => problem%matrix%compliance%values, unknown => self%unknown, m => problem%n_points)
         do i = 1, n
            do j = 1, n
               factor(j, i) = a(unknown(j), unknown(i))
            end do
            do j = 1, count(unknown <= m)
               factor(j, i) = factor(j, i) + slopes(unknown(j))*a(m + unknown(j), unknown(i))
            end do
            factor(i, i) = factor(i, i) + self%regularization*self%diagonal(unknown(i))
         end do
      end associate
      if (self%is_symmetric) then
         call cholesky_factor(factor, info)
      else
         call lu_factor(factor, self%pivots, info)
      end if
   end subroutine factorize_entries

   !> Solves the factorized system for its unknown forces.
   subroutine compliance_system_solve_unknown(self, right, info)
      class(compliance_system_t), intent(in) :: self !! the system
      real(dp), contiguous, intent(inout) :: right(:, :) !! right-hand sides, the solutions on return
      integer, intent(out) :: info !! 0, as a factor that was made is not singular

      info = 0
      call solve_entries(self, size(right, 1), self%entries, right)
   end subroutine compliance_system_solve_unknown

   !> Solves with the first of the entries as a matrix.
   subroutine solve_entries(self, n, factor, right)
      class(compliance_system_t), intent(in) :: self !! the system
      integer, intent(in) :: n !! order of the matrix
      real(dp), intent(in) :: factor(n, n) !! the factor
      real(dp), contiguous, intent(inout) :: right(:, :) !! right-hand sides, the solutions on return

      if (self%is_symmetric) then
         call cholesky_solve(factor, right)
      else
         call lu_solve_transposed(factor, self%pivots, right)
      end if
   end subroutine solve_entries

   !> Solves the factorized system.
   subroutine sparse_compliance_system_solve_unknown(self, right, info)
      class(sparse_compliance_system_t), intent(in) :: self !! the system
      real(dp), contiguous, intent(inout) :: right(:, :) !! right-hand side, the solution on return
      integer, intent(out) :: info !! 0, or nonzero where the system is singular

      info = 0
      if (size(right) > 0) call self%factors%solve_transposed(right(:, 1), info)
   end subroutine sparse_compliance_system_solve_unknown

   !> Factorizes the system of the base.
   subroutine sparse_compliance_system_factorize(self, problem, info)
      class(sparse_compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      integer, allocatable :: row(:), column(:)
      real(dp), allocatable :: value(:)
      integer :: place(2*problem%n_points), i, k, m, n, point

      m = problem%n_points
      place = 0
      place(self%unknown) = [(i, i=1, size(self%unknown))]
      ! The entries of a sliding point's tangential row go where its normal force stands.
      associate (a => problem%matrix%compliance)
         allocate (row(size(a%row) + size(self%unknown)), column(size(a%row) + size(self%unknown)), &
            value(size(a%row) + size(self%unknown)))
         n = 0
         do i = 1, size(self%unknown)
            call append(i, self%regularization*self%diagonal(self%unknown(i)))
            do k = a%first(self%unknown(i)), a%first(self%unknown(i) + 1) - 1
               if (place(a%row(k)) > 0) then
                  call append(place(a%row(k)), a%entry(k))
               else if (a%row(k) > m) then
                  point = a%row(k) - m
                  if (place(point) > 0) call append(place(point), &
                     self%base%slip_direction(point)*problem%friction(point)*a%entry(k))
               end if
            end do
         end do
      end associate
      info = 0
      if (size(self%unknown) > 0) call self%factors%factorize(size(self%unknown), row(:n), column(:n), value(:n), info)

   contains

      !> Appends an entry to the present column.
      subroutine append(in_row, entry)
         integer, intent(in) :: in_row !! its row
         real(dp), intent(in) :: entry !! its value

         n = n + 1
         row(n) = in_row
         column(n) = i
         value(n) = entry
      end subroutine append

   end subroutine sparse_compliance_system_factorize

end module amontons_newton_system
