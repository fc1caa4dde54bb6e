!> Newton's linear system in the forces, on a sparse compliance A, which stays sparse.
module amontons_sparse_compliance_system
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_active_set, only: active_set_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_kinds, only: dp
   use amontons_newton_system, only: newton_system_t
   use amontons_sparse_lu, only: sparse_lu_t
   implicit none (type, external)
   private

   public :: sparse_compliance_system_t

   !> The rows of `A lambda = B` that hold no distance and no slip, with the unknown forces: the normal ones of closed
   !> points and the tangential ones of sticking points.
   type, extends(newton_system_t) :: sparse_compliance_system_t
      private
      type(active_set_t) :: base !! The guess that is factorised.
      real(dp) :: share = -1.0_dp !! Share of the diagonal in the factorisation.
      integer, allocatable :: unknown(:) !! The forces that are unknown in it.
      real(dp), allocatable :: diagonal(:) !! Diagonal of A, where it is zero the largest of all (2m).
      type(sparse_lu_t) :: factors !! Triangular factors of its transposed matrix.
   contains
      procedure, public :: solve => sparse_compliance_system_solve
      procedure :: factorize => sparse_compliance_system_factorize
      procedure :: serves => sparse_compliance_system_serves
   end type sparse_compliance_system_t

contains

   !> Solves for the forces, then takes the displacements from them.
   subroutine sparse_compliance_system_solve(self, problem, guess, share, displacement, force, imbalance, info)
      class(sparse_compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a sparse compliance
      type(active_set_t), intent(in) :: guess !! state of each point
      real(dp), intent(in) :: share !! share of the diagonal of A [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      real(dp), intent(out) :: imbalance !! 0: the displacements are those of the forces [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp) :: load(size(force)), solution(size(force))
      real(dp), allocatable :: right(:)

      imbalance = 0.0_dp
      info = 0
      if (.not. self%serves(guess, share)) call self%factorize(problem, guess, share, info)
      if (info /= 0) return
      load = problem%dual_load(displacement)
      associate (m => problem%n_points, unknown => self%unknown)
         solution = 0.0_dp
         solution(m + 1:) = guess%sense*problem%slip_bound
         right = load(unknown) + self%share*self%diagonal(unknown)*force(unknown)
         if (any(abs(solution) > 0.0_dp)) right = right - product_rows(problem, unknown, solution)
         if (size(right) > 0) call self%factors%solve_transposed(right, info)
         solution(unknown) = right
         solution(m + 1:) = solution(m + 1:) + guess%sense*problem%friction*solution(:m)
      end associate
      if (.not. all(ieee_is_finite(solution))) info = 1
      if (info /= 0) return
      force = solution
      displacement = problem%displacement(load, force)
      call self%effort%multiply(1.0_dp)
   end subroutine sparse_compliance_system_solve

   !> Some rows of the product A x [L].
   pure function product_rows(problem, rows, x) result(product)
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: rows(:) !! numbers of the rows
      real(dp), intent(in) :: x(:) !! the vector (2m)
      real(dp) :: product(size(rows))
      integer :: i

      product = [(problem%compliance%column_product(rows(i), x), i=1, size(rows))]
   end function product_rows

   !> Whether the factorisation is that of a guess, with a share of the diagonal that is neither too small nor so large
   !> that steps are slow.
   pure logical function sparse_compliance_system_serves(self, guess, share) result(serves)
      class(sparse_compliance_system_t), intent(in) :: self !! the system
      type(active_set_t), intent(in) :: guess !! state of each point
      real(dp), intent(in) :: share !! share of the diagonal of A that is wanted [-]
      real(dp), parameter :: spread = 10.0_dp

      serves = self%share >= share .and. self%share <= spread*share
      if (serves) serves = all(self%base%is_closed .eqv. guess%is_closed) .and. all(self%base%sense == guess%sense)
   end function sparse_compliance_system_serves

   !> Factorises the system of a guess.
   subroutine sparse_compliance_system_factorize(self, problem, guess, share, info)
      class(sparse_compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: guess !! state of each point
      real(dp), intent(in) :: share !! share of the diagonal of A [-]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      integer, allocatable :: row(:), column(:)
      real(dp), allocatable :: value(:)
      integer :: place(2*problem%n_points), i, k, m, n, point

      m = problem%n_points
      if (.not. allocated(self%diagonal)) self%diagonal = 1.0_dp/problem%augmentation()
      self%base = guess
      self%share = share
      self%unknown = pack([(i, i=1, 2*m)], [guess%is_closed, guess%sense == 0])
      place = 0
      place(self%unknown) = [(i, i=1, size(self%unknown))]
      ! The entries of a sliding point's tangential row go where its normal force stands.
      associate (a => problem%compliance)
         allocate (row(size(a%row) + size(self%unknown)), column(size(a%row) + size(self%unknown)), &
            value(size(a%row) + size(self%unknown)))
         n = 0
         do i = 1, size(self%unknown)
            call append(i, share*self%diagonal(self%unknown(i)))
            do k = a%first(self%unknown(i)), a%first(self%unknown(i) + 1) - 1
               if (place(a%row(k)) > 0) then
                  call append(place(a%row(k)), a%entry(k))
               else if (a%row(k) > m) then
                  point = a%row(k) - m
                  if (place(point) > 0) call append(place(point), guess%sense(point)*problem%friction(point)*a%entry(k))
               end if
            end do
         end do
      end associate
      info = 0
      call self%effort%factorize(size(self%unknown) > 0)
      if (size(self%unknown) > 0) call self%factors%factorize(size(self%unknown), row(:n), column(:n), value(:n), info)
      if (info /= 0) self%share = -1.0_dp

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

end module amontons_sparse_compliance_system
