!> Newton's linear system in the forces, on a dense compliance A.
!>
!> Each force has one row: an unknown one that of `A lambda = B`, the others that of the law which gives them. An
!> active set that differs from the factorized one in few rows is solved by that factorization and a small system of
!> these rows.
module amontons_compliance_system
   use amontons_active_set, only: active_set_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_dense, only: add_product, cholesky_factor, cholesky_solve, lu_factor, lu_solve, lu_solve_transposed, &
      transposed_product
   use amontons_force_system, only: force_system_t
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: compliance_system_t

   !> The system, its factorization and what has changed since.
   type, extends(force_system_t) :: compliance_system_t
      private
      logical :: is_symmetric = .false. !! Whether no point slides with friction, so that its matrix is symmetric.
      real(dp), allocatable :: entries(:)
         !! Cholesky factor, or triangular factors of the transposed matrix, and room: memory is costly to get anew.
      integer, allocatable :: pivots(:) !! Their row exchanges.
      integer :: n_changed = 0 !! Number of rows that have changed since.
      integer, allocatable :: changed(:) !! These rows.
      real(dp), allocatable :: response(:, :) !! Solutions of the factorized system for a unit in each of these rows.
      real(dp), allocatable :: row(:, :) !! These rows of A.
   contains
      procedure, public :: prepare => compliance_system_prepare
      procedure, public :: solve_forces => compliance_system_solve_forces
      procedure :: apply => compliance_system_apply
      procedure :: factorize => compliance_system_factorize
      procedure :: update => compliance_system_update
   end type compliance_system_t

   !> Below this order a new factorization costs no more than the bookkeeping of an update.
   integer, parameter :: least_order = 200
   !> Changed rows, as a part of the order, that an update may have: more cost as much as a new factorization.
   integer, parameter :: part = 6

contains

   !> Factorizes the system of an active set, unless few rows have changed since another one was factorized.
   subroutine compliance_system_prepare(self, problem, active_set, regularization, info)
      class(compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a dense compliance
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A that is wanted [-]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      logical :: is_updated

      info = 0
      call self%update(problem, active_set, regularization, is_updated)
      if (.not. is_updated) call self%factorize(problem, active_set, regularization, info)
   end subroutine compliance_system_prepare

   !> Solves the factorized system, then corrects its forces for the rows that have changed since.
   subroutine compliance_system_solve_forces(self, problem, active_set, load, center, force, info)
      class(compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a dense compliance
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: load(:) !! dual load B (2m) [L]
      real(dp), intent(in) :: center(:) !! lambda before the step (2m) [F]
      real(dp), intent(out) :: force(:) !! lambda after it (2m) [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular

      info = 0
      call base_solution(self, problem, load, center, force)
      if (any(abs(self%base%slip_direction*problem%slip_bound) > 0.0_dp)) call self%effort%multiply(1.0_dp)
      if (self%n_changed > 0) call correct(self, problem, active_set, load, center, force, info)
   end subroutine compliance_system_solve_forces

   !> Factorizes the system of an active set.
   subroutine compliance_system_factorize(self, problem, active_set, regularization, info)
      class(compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A [-]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), allocatable :: entries(:)
      integer :: n

      n = 2*problem%n_points
      if (.not. allocated(self%changed)) then
         allocate (self%changed(n), self%response(n, 0), self%row(n, 0), self%entries(0))
      end if
      call self%begin(problem, active_set, regularization)
      self%n_changed = 0
      n = size(self%unknown)
      if (size(self%entries, kind=int64) < int(n, int64)**2) then
         deallocate (self%entries)
         allocate (self%entries(int(n, int64)**2))
      end if
      self%is_symmetric = .not. any(active_set%is_closed .and. active_set%slip_direction /= 0 &
         .and. problem%friction > 0.0_dp)
      ! No argument may hold what another one writes.
      call move_alloc(self%entries, entries)
      call factorize_entries(self, problem, n, entries, info)
      call move_alloc(entries, self%entries)
      call self%effort%factorize(n > 0)
      if (info /= 0) self%regularization = -1.0_dp
   end subroutine compliance_system_factorize

   !> Writes the factor of the active set, as a matrix, to the first of its entries.
   subroutine factorize_entries(self, problem, n, factor, info)
      class(compliance_system_t), intent(inout) :: self !! the system, without its entries; gains the row exchanges
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: n !! order of the matrix
      real(dp), intent(out) :: factor(n, n) !! the factor
      integer, intent(out) :: info !! 0, or nonzero where the matrix is singular

      call gather(self, problem, factor)
      if (self%is_symmetric) then
         call cholesky_factor(factor, info)
      else
         call lu_factor(factor, self%pivots, info)
      end if
   end subroutine factorize_entries

   !> Writes the transposed matrix of the active set to be factorized.
   pure subroutine gather(self, problem, matrix)
      class(compliance_system_t), intent(in) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), contiguous, intent(out) :: matrix(:, :) !! the transposed matrix
      real(dp) :: slopes(problem%n_points)
      integer :: i, j, m, n_normal

      m = problem%n_points
      n_normal = count(self%unknown <= m)
      slopes = self%base%slip_direction*problem%friction
      associate (a => problem%compliance%values, unknown => self%unknown)
         do i = 1, size(unknown)
            do j = 1, size(unknown)
               matrix(j, i) = a(unknown(j), unknown(i))
            end do
            do j = 1, n_normal
               matrix(j, i) = matrix(j, i) + slopes(unknown(j))*a(m + unknown(j), unknown(i))
            end do
            matrix(i, i) = matrix(i, i) + self%regularization*self%diagonal(unknown(i))
         end do
      end associate
   end subroutine gather

   !> Takes up the rows in which an active set differs from the factorized one, unless a new factorization is better.
   subroutine compliance_system_update(self, problem, active_set, regularization, is_updated)
      class(compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A that is wanted [-]
      logical, intent(out) :: is_updated !! whether the factorization serves the active set
      ! A factorization with less than the regularization wanted is no use, one with much more is slow.
      real(dp), parameter :: spread = 100.0_dp
      integer, allocatable :: differing(:), new(:)
      integer :: i, n

      is_updated = self%regularization >= regularization .and. self%regularization <= spread*regularization
      if (.not. is_updated) return
      differing = pack([(i, i=1, 2*problem%n_points)], [self%base%is_closed .neqv. active_set%is_closed, &
         self%base%slip_direction /= active_set%slip_direction])
      n = self%n_changed
      new = pack(differing, [(.not. any(self%changed(:n) == differing(i)), i=1, size(differing))])
      if (size(new) == 0) return
      is_updated = size(self%unknown) >= least_order .and. part*(n + size(new)) <= size(self%unknown)
      if (.not. is_updated) return
      call reserve(self, 2*problem%n_points, n + size(new))
      self%changed(n + 1:n + size(new)) = new
      do i = 1, size(new)
         self%row(:, n + i) = problem%compliance%values(:, new(i))
      end do
      self%n_changed = n + size(new)
      call unit_responses(self, problem, n + 1)
   end subroutine compliance_system_update

   !> Makes room for changed rows.
   pure subroutine reserve(self, n_forces, n_rows)
      class(compliance_system_t), intent(inout) :: self !! the system
      integer, intent(in) :: n_forces !! number of forces 2m
      integer, intent(in) :: n_rows !! number of rows there must be room for
      real(dp), allocatable :: columns(:, :)
      integer :: n

      n = self%n_changed
      if (n_rows <= size(self%response, 2)) return
      allocate (columns(n_forces, 2*n_rows))
      columns(:, :n) = self%response(:, :n)
      call move_alloc(columns, self%response)
      allocate (columns(n_forces, 2*n_rows))
      columns(:, :n) = self%row(:, :n)
      call move_alloc(columns, self%row)
   end subroutine reserve

   !> Solves the factorized system for a unit in each changed row from one on.
   subroutine unit_responses(self, problem, first)
      class(compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: first !! the first changed row to do
      real(dp), allocatable :: right(:, :)
      integer :: place(2*problem%n_points), i, m, k, r

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
               if (r <= m) column = column - slope(problem, self%base, r) &
                  *problem%compliance%values(self%unknown, m + r)
            end if
         end associate
      end do
      call base_solve(self, right)
      do k = first, self%n_changed
         self%response(self%unknown, k) = right(:, k - first + 1)
         call self%apply(problem, self%response(:, k))
      end do
   end subroutine unit_responses

   !> Solves the factorized system for its unknown forces.
   subroutine base_solve(self, right)
      class(compliance_system_t), intent(in) :: self !! the system
      real(dp), contiguous, intent(inout) :: right(:, :) !! right-hand sides, the solutions on return

      call solve_entries(self, size(right, 1), self%entries, right)
   end subroutine base_solve

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

   !> The slope of lambda_T over lambda_N that an active set gives a point [-].
   pure real(dp) function slope(problem, active_set, point)
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      integer, intent(in) :: point !! the point

      slope = active_set%slip_direction(point)*problem%friction(point)
   end function slope

   !> Adds to the tangential forces of sliding points what their normal forces cause in the factorized active set.
   pure subroutine compliance_system_apply(self, problem, force)
      class(compliance_system_t), intent(in) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(inout) :: force(:) !! lambda (2m) [F]

      associate (m => problem%n_points)
         force(m + 1:) = force(m + 1:) + self%base%slip_direction*problem%friction*force(:m)
      end associate
   end subroutine compliance_system_apply

   !> The forces that the factorized active set leads to.
   subroutine base_solution(self, problem, load, center, force)
      class(compliance_system_t), intent(in) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: load(:) !! dual load B (2m) [L]
      real(dp), intent(in) :: center(:) !! lambda before the step (2m) [F]
      real(dp), intent(out) :: force(:) !! lambda after it (2m) [F]
      real(dp) :: right(size(self%unknown), 1), known(size(force))

      associate (m => problem%n_points)
         force(:m) = 0.0_dp
         force(m + 1:) = self%base%slip_direction*problem%slip_bound
         known = 0.0_dp
         if (any(abs(force) > 0.0_dp)) call problem%compliance%multiply(force, known)
      end associate
      right(:, 1) = load(self%unknown) - known(self%unknown) &
         + self%regularization*self%diagonal(self%unknown)*center(self%unknown)
      call base_solve(self, right)
      force(self%unknown) = right(:, 1)
      call self%apply(problem, force)
   end subroutine base_solution

   !> Corrects the forces of the factorized active set so that the changed rows hold as well.
   subroutine correct(self, problem, active_set, load, center, force, info)
      class(compliance_system_t), intent(in) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: load(:) !! dual load B (2m) [L]
      real(dp), intent(in) :: center(:) !! lambda before the step (2m) [F]
      real(dp), intent(inout) :: force(:) !! lambda of the factorized active set, corrected on return (2m) [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp) :: matrix(self%n_changed, self%n_changed), right(self%n_changed), product(self%n_changed)
      integer :: m, k, r

      m = problem%n_points
      associate (n => self%n_changed)
         call transposed_product(self%row(:, :n), self%response(:, :n), matrix)
         product = matmul(force, self%row(:, :n))
         do k = 1, n
            r = self%changed(k)
            if (is_unknown(active_set, m, r)) then
               matrix(k, :) = matrix(k, :) + self%regularization*self%diagonal(r)*self%response(r, :n)
               right(k) = load(r) - product(k) + self%regularization*self%diagonal(r)*(center(r) - force(r))
            else if (r <= m) then
               matrix(k, :) = self%response(r, :n)
               right(k) = -force(r)
            else
               matrix(k, :) = self%response(r, :n) - slope(problem, active_set, r - m)*self%response(r - m, :n)
               right(k) = active_set%slip_direction(r - m)*problem%slip_bound(r - m) - force(r) &
                  + slope(problem, active_set, r - m)*force(r - m)
            end if
         end do
         call lu_solve(matrix, right, info)
         if (info /= 0) return
         call add_product(self%response(:, :n), right, force)
      end associate
   end subroutine correct

   !> Whether a force is unknown in an active set: a normal one of a closed point, a tangential one of a sticking point.
   pure logical function is_unknown(active_set, n_points, force)
      type(active_set_t), intent(in) :: active_set !! state of each point
      integer, intent(in) :: n_points !! number of points m
      integer, intent(in) :: force !! number of the force

      if (force <= n_points) then
         is_unknown = active_set%is_closed(force)
      else
         is_unknown = active_set%slip_direction(force - n_points) == 0
      end if
   end function is_unknown

end module amontons_compliance_system
