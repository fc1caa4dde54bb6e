!> The condensation of displacements v to rows w = C v: the least energy of all v with the same w.
!>
!> Of `min v.S v/2 - q.v with C v = w` the value is w.T w/2 - p.w + const, with T = G^-1 - rho I, p = G^-1 C M^-1 q,
!> G = C M^-1 C^T and M = S + rho C^T C for any rho that makes M definite. Equilibrium S v = q - C^T lambda is then
!> `T w = p - lambda`, exactly, also where S is only semidefinite: the kernel of T is C times that of S. Motions r of
!> this kernel that no row notices, C r = 0, take no part: M gains a multiple of r r^T for each, which changes neither T
!> nor p, and leaves out their displacements.
module amontons_row_condensation
   use amontons_dense, only: cholesky_factor, cholesky_inverse, cholesky_solve
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: new_row_condensation, row_condensation_t

   !> What condenses loads and recovers displacements.
   type :: row_condensation_t
      real(dp), allocatable :: stiffness(:, :) !! T (r, r) [F/L]
      real(dp), allocatable, private :: rows(:, :) !! C (r, n) [-]
      real(dp), allocatable, private :: factor(:, :) !! Cholesky factor of M (n, n)
      real(dp), allocatable, private :: lifting(:, :) !! G^-1 C M^-1, the v of unit w, transposed (r, n) [-]
   contains
      procedure :: condense => row_condensation_condense
      procedure :: expand => row_condensation_expand
   end type row_condensation_t

contains

   !> Condenses a stiffness.
   pure subroutine new_row_condensation(condensation, stiffness, rows, is_definite, unnoticed, error)
      type(row_condensation_t), intent(out) :: condensation !! the condensation
      real(dp), intent(in) :: stiffness(:, :) !! S (n, n) [F/L]
      real(dp), intent(in) :: rows(:, :) !! C (r, n), of full rank [-]
      logical, intent(in) :: is_definite !! whether S is definite, so that rho = 0
      real(dp), intent(in) :: unnoticed(:, :) !! the motions r (n, any) [-]
      type(error_t), allocatable, intent(out) :: error
         !! the rows are dependent, or leave another part of S's kernel free
      real(dp), allocatable :: flexibility(:, :), gram(:, :)
      real(dp) :: rho, trace
      integer :: i, info

      rho = 0.0_dp
      condensation%factor = stiffness
      condensation%rows = rows
      if (.not. is_definite) then
         ! Both parts of M then have diagonals of one size, which keeps its condition near that of S.
         trace = sum([(stiffness(i, i), i=1, size(stiffness, 1))])
         rho = trace/sum(rows**2)
         condensation%factor = stiffness + rho*matmul(transpose(rows), rows)
         if (size(unnoticed, 2) > 0) condensation%factor = condensation%factor &
            + trace/sum(unnoticed**2)*matmul(unnoticed, transpose(unnoticed))
      end if
      call cholesky_factor(condensation%factor, info)
      if (info /= 0) then
         call new_error(error, numerical_failure, 'the condensed stiffness of the contact nodes is not positive '// &
            'definite: neither supports nor the cells of constant multipliers hold the body')
         return
      end if
      flexibility = transpose(rows)
      call cholesky_solve(condensation%factor, flexibility)
      gram = matmul(rows, flexibility)
      gram = 0.5_dp*(gram + transpose(gram))
      call cholesky_factor(gram, info)
      if (info /= 0) then
         call new_error(error, numerical_failure, 'the constant multipliers are not independent on this mesh: make '// &
            'their cells larger')
         return
      end if
      condensation%lifting = transpose(flexibility)
      call cholesky_solve(gram, condensation%lifting)
      call cholesky_inverse(gram)
      do i = 1, size(gram, 1)
         gram(i, i) = gram(i, i) - rho
      end do
      call move_alloc(gram, condensation%stiffness)
   end subroutine new_row_condensation

   !> The condensed load p of a load q.
   pure function row_condensation_condense(self, load) result(condensed)
      class(row_condensation_t), intent(in) :: self !! the condensation
      real(dp), intent(in) :: load(:) !! q (n) [F]
      real(dp), allocatable :: condensed(:)

      condensed = matmul(self%lifting, load)
   end function row_condensation_condense

   !> The displacements v of least energy with C v = w.
   pure function row_condensation_expand(self, load, values) result(displacement)
      class(row_condensation_t), intent(in) :: self !! the condensation
      real(dp), intent(in) :: load(:) !! q (n) [F]
      real(dp), intent(in) :: values(:) !! w (r) [L]
      real(dp), allocatable :: displacement(:)

      displacement = load
      call cholesky_solve(self%factor, displacement)
      displacement = displacement + matmul(values - matmul(self%rows, displacement), self%lifting)
   end function row_condensation_expand

end module amontons_row_condensation
