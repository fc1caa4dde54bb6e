!> Newton's linear system in the forces, on a sparse compliance A, which stays sparse.
module amontons_sparse_compliance_system
   use amontons_active_set, only: active_set_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_force_system, only: force_system_t
   use amontons_kinds, only: dp
   use amontons_sparse_lu, only: sparse_lu_t
   implicit none (type, external)
   private

   public :: sparse_compliance_system_t

   !> The rows of `A lambda = B` of the unknown forces.
   type, extends(force_system_t) :: sparse_compliance_system_t
      private
      type(sparse_lu_t) :: factors !! Triangular factors of its transposed matrix.
   contains
      procedure, public :: prepare => sparse_compliance_system_prepare
      procedure, public :: solve_forces => sparse_compliance_system_solve_forces
      procedure :: factorize => sparse_compliance_system_factorize
      procedure :: serves => sparse_compliance_system_serves
   end type sparse_compliance_system_t

contains

   !> Factorizes the system of an active set, unless it is the one that is factorized.
   subroutine sparse_compliance_system_prepare(self, problem, active_set, regularization, info)
      class(sparse_compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a sparse compliance
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A that is wanted [-]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular

      info = 0
      if (.not. self%serves(active_set, regularization)) call self%factorize(problem, active_set, regularization, info)
   end subroutine sparse_compliance_system_prepare

   !> Solves the factorized system.
   subroutine sparse_compliance_system_solve_forces(self, problem, active_set, load, center, force, info)
      class(sparse_compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a sparse compliance
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: load(:) !! dual load B (2m) [L]
      real(dp), intent(in) :: center(:) !! lambda before the step (2m) [F]
      real(dp), intent(out) :: force(:) !! lambda after it (2m) [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      real(dp), allocatable :: right(:)

      info = 0
      associate (m => problem%n_points, unknown => self%unknown)
         force(:m) = 0.0_dp
         force(m + 1:) = active_set%slip_direction*problem%slip_bound
         right = load(unknown) + self%regularization*self%diagonal(unknown)*center(unknown)
         if (any(abs(force) > 0.0_dp)) right = right - product_rows(problem, unknown, force)
         if (size(right) > 0) call self%factors%solve_transposed(right, info)
         force(unknown) = right
         force(m + 1:) = force(m + 1:) + active_set%slip_direction*problem%friction*force(:m)
      end associate
   end subroutine sparse_compliance_system_solve_forces

   !> Some rows of the product A x [L].
   pure function product_rows(problem, rows, x) result(product)
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: rows(:) !! numbers of the rows
      real(dp), intent(in) :: x(:) !! the vector (2m)
      real(dp) :: product(size(rows))
      integer :: i

      product = [(problem%compliance%column_product(rows(i), x), i=1, size(rows))]
   end function product_rows

   !> Whether the factorization is that of an active set, with a regularization that is neither too small nor so large
   !> that steps are slow.
   pure logical function sparse_compliance_system_serves(self, active_set, regularization) result(serves)
      class(sparse_compliance_system_t), intent(in) :: self !! the system
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A that is wanted [-]
      real(dp), parameter :: spread = 10.0_dp

      serves = self%regularization >= regularization .and. self%regularization <= spread*regularization
      if (serves) serves = self%base%equals(active_set)
   end function sparse_compliance_system_serves

   !> Factorizes the system of an active set.
   subroutine sparse_compliance_system_factorize(self, problem, active_set, regularization, info)
      class(sparse_compliance_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of A [-]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      integer, allocatable :: row(:), column(:)
      real(dp), allocatable :: value(:)
      integer :: place(2*problem%n_points), i, k, m, n, point

      m = problem%n_points
      call self%begin(problem, active_set, regularization)
      place = 0
      place(self%unknown) = [(i, i=1, size(self%unknown))]
      ! The entries of a sliding point's tangential row go where its normal force stands.
      associate (a => problem%compliance)
         allocate (row(size(a%row) + size(self%unknown)), column(size(a%row) + size(self%unknown)), &
            value(size(a%row) + size(self%unknown)))
         n = 0
         do i = 1, size(self%unknown)
            call append(i, regularization*self%diagonal(self%unknown(i)))
            do k = a%first(self%unknown(i)), a%first(self%unknown(i) + 1) - 1
               if (place(a%row(k)) > 0) then
                  call append(place(a%row(k)), a%entry(k))
               else if (a%row(k) > m) then
                  point = a%row(k) - m
                  if (place(point) > 0) call append(place(point), &
                     active_set%slip_direction(point)*problem%friction(point)*a%entry(k))
               end if
            end do
         end do
      end associate
      info = 0
      call self%effort%factorize(size(self%unknown) > 0)
      if (size(self%unknown) > 0) call self%factors%factorize(size(self%unknown), row(:n), column(:n), value(:n), info)
      if (info /= 0) self%regularization = -1.0_dp

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
