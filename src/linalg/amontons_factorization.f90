!> The factorisation seam: Cholesky with the trailing unknowns eliminated last, whatever library makes the factor.
!>
!> P K P^T = L L^T, where P puts unknown `order(k)` in position k and keeps the last `n_trailing` unknowns last.
!> With the unknowns split into interior i and trailing c, the last block of L is the Cholesky factor of the Schur
!> complement S = K_cc - K_ci K_ii^-1 K_ic, and a forward substitution that stops before this block leaves
!> q = b_c - K_ci K_ii^-1 b_i in place of b_c.
module amontons_factorization
   use amontons_dense, only: fill_upper
   use amontons_error, only: error_t, new_error, numerical_failure, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dlacn2, dlauum
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_system, only: available_memory_mb, return_memory
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: factorization_t

   !> A Cholesky factorisation. The substitutions only read it, so several threads may use one at the same time.
   type, abstract :: factorization_t
      integer :: n = 0 !! Number of unknowns.
      integer :: n_trailing = 0 !! How many of them, the last ones, are eliminated last.
      integer, allocatable :: order(:) !! Position k holds unknown order(k) (n).
      integer, allocatable :: trailing_order(:)
         !! Trailing position k holds trailing unknown trailing_order(k) (n_trailing).
      real(dp) :: n_flops = 0.0_dp !! Floating-point operations of `complete`, known after `analyze`.
      integer(int64) :: n_work_entries = 0 !! Numbers that `complete` holds for a while, beside the factor's.
      integer :: refused_unknown = 0 !! The unknown whose pivot was not positive, 0 for none.
      real(dp), allocatable :: diagonal(:) !! Diagonal of P K P^T, from `analyze` to `complete` (n).
      real(dp) :: matrix_norm = 0.0_dp !! 1-norm of the matrix, from `analyze_matrix`.
   contains
      procedure(analyze), deferred :: analyze
      procedure(complete), deferred :: complete
      procedure(substitute), deferred :: substitute_forward
      procedure(substitute), deferred :: substitute_backward
      procedure(trailing_factor), deferred :: trailing_factor
      procedure(n_factor_entries), deferred :: n_factor_entries
      procedure(name), deferred, nopass :: name
      procedure :: factorize => factorization_factorize
      procedure :: check_memory => factorization_check_memory
      procedure :: memory_mb => factorization_memory_mb
      procedure :: forward => factorization_forward
      procedure :: backward => factorization_backward
      procedure :: solve => factorization_solve
      procedure :: schur_complement => factorization_schur_complement
      procedure :: condense => factorization_condense
      procedure :: expand => factorization_expand
      procedure :: condition => factorization_condition
      procedure :: least_refused_condition => factorization_least_refused_condition
      procedure :: set_order => factorization_set_order
      procedure :: check_pivots => factorization_check_pivots
      procedure :: refuse => factorization_refuse
   end type factorization_t

   abstract interface
      !> Orders a symmetric positive definite matrix and finds the size of its factor. Takes what it needs of the
      !> matrix, which the caller may give up before `complete`.
      subroutine analyze(self, matrix, n_trailing, error)
         import :: error_t, factorization_t, sparse_matrix_t
         implicit none (type, external)
         class(factorization_t), intent(inout) :: self !! the factorisation
         type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
         integer, intent(in) :: n_trailing !! how many unknowns, the last ones, are eliminated last
         type(error_t), allocatable, intent(out) :: error !! memory ran out
      end subroutine analyze

      !> Computes the factor of the matrix that was analysed.
      subroutine complete(self, error)
         import :: error_t, factorization_t
         implicit none (type, external)
         class(factorization_t), intent(inout) :: self !! the factorisation
         type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      end subroutine complete

      !> Does the steps of a substitution that belong to the first columns of L.
      subroutine substitute(self, n_steps, y)
         import :: dp, factorization_t
         implicit none (type, external)
         class(factorization_t), intent(in) :: self !! the factorisation
         integer, intent(in) :: n_steps !! how many columns, at least those before the trailing ones
         real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      end subroutine substitute

      !> The last block of L, the Cholesky factor of the Schur complement.
      subroutine trailing_factor(self, l22)
         import :: dp, factorization_t
         implicit none (type, external)
         class(factorization_t), intent(in) :: self !! the factorisation
         real(dp), contiguous, intent(out) :: l22(:, :)
            !! lower triangular, zeros above, by trailing position (n_trailing, n_trailing)
      end subroutine trailing_factor

      !> The number of entries of L that are stored, known after `analyze`.
      pure function n_factor_entries(self) result(n_entries)
         import :: factorization_t, int64
         implicit none (type, external)
         class(factorization_t), intent(in) :: self !! the factorisation
         integer(int64) :: n_entries
      end function n_factor_entries

      !> The word for this kind of factorisation.
      pure function name()
         implicit none (type, external)
         character(:), allocatable :: name
      end function name
   end interface

contains

   !> Factorises a symmetric positive definite matrix.
   subroutine factorization_factorize(self, matrix, n_trailing, error)
      class(factorization_t), intent(inout) :: self !! the factorisation
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_trailing !! how many unknowns, the last ones, are eliminated last
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory is short

      call self%analyze(matrix, n_trailing, error)
      if (allocated(error)) return
      call self%check_memory(error)
      if (allocated(error)) return
      call self%complete(error)
   end subroutine factorization_factorize

   !> The memory that `complete` takes [MB].
   pure real(dp) function factorization_memory_mb(self)
      class(factorization_t), intent(in) :: self !! the factorisation, analysed

      factorization_memory_mb = 8.0e-6_dp*real(self%n_factor_entries() + self%n_work_entries, dp)
   end function factorization_memory_mb

   !> Refuses a factor that the memory cannot hold, before anything is allocated for it. What the analysis has freed
   !> goes back to the system first.
   subroutine factorization_check_memory(self, error)
      class(factorization_t), intent(in) :: self !! the factorisation, analysed
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice

      call return_memory()
      if (self%memory_mb() <= available_memory_mb()) return
      call new_error(error, system_failure, 'memory does not suffice: the '//self%name()//' factor of '// &
         to_text(self%n)//' unknowns needs '//to_text(nint(self%memory_mb(), int64))//' MB, and '// &
         to_text(nint(available_memory_mb(), int64))//' MB are available')
   end subroutine factorization_check_memory

   !> The forward substitution y = L^-1 P b.
   subroutine factorization_forward(self, b, y)
      class(factorization_t), intent(in) :: self !! the factorisation
      real(dp), intent(in) :: b(:) !! right-hand side by unknown (n)
      real(dp), contiguous, intent(out) :: y(:) !! the result by position (n)

      y = b(self%order)
      call self%substitute_forward(self%n, y)
   end subroutine factorization_forward

   !> The backward substitution x = P^T L^-T y.
   subroutine factorization_backward(self, y, x)
      class(factorization_t), intent(in) :: self !! the factorisation
      real(dp), intent(in) :: y(:) !! the vector by position (n)
      real(dp), intent(out) :: x(:) !! the result by unknown (n)
      real(dp), allocatable :: work(:)

      allocate (work, source=y)
      call self%substitute_backward(self%n, work)
      x(self%order) = work
   end subroutine factorization_backward

   !> Solves K x = b.
   subroutine factorization_solve(self, b, x)
      class(factorization_t), intent(in) :: self !! the factorisation
      real(dp), intent(in) :: b(:) !! right-hand side (n)
      real(dp), intent(out) :: x(:) !! the solution (n)
      real(dp), allocatable :: y(:)

      allocate (y(self%n))
      call self%forward(b, y)
      call self%backward(y, x)
   end subroutine factorization_solve

   !> The Schur complement S = L22 L22^T of the matrix that was factorised, on its trailing unknowns.
   subroutine factorization_schur_complement(self, s)
      class(factorization_t), intent(in) :: self !! the factorisation
      real(dp), contiguous, intent(out) :: s(:, :)
         !! S, both triangles, trailing unknowns in matrix order (n_trailing, n_trailing)
      real(dp), allocatable :: diagonal(:)
      integer :: i, j, m, info

      m = self%n_trailing
      call self%trailing_factor(s)
      ! LAPACK has U U^T in place but not L L^T; with rows and columns reversed L22 is such a U. The lower triangle is
      ! turned into the upper one, and the result, in matrix order, back into the lower one.
      diagonal = [(s(i, i), i=1, m)]
      do j = 1, m
         do i = 1, j - 1
            s(i, j) = s(m + 1 - i, m + 1 - j)
         end do
         s(j, j) = diagonal(m + 1 - j)
      end do
      call dlauum('U', m, s, max(1, m), info)
      diagonal = [(s(i, i), i=1, m)]
      associate (order => self%trailing_order(m:1:-1))
         do j = 1, m
            do i = 1, j - 1
               s(max(order(i), order(j)), min(order(i), order(j))) = s(i, j)
            end do
         end do
         do j = 1, m
            s(order(j), order(j)) = diagonal(j)
         end do
      end associate
      call fill_upper(s)
   end subroutine factorization_schur_complement

   !> Eliminates the interior from a load: q = b_c - K_ci K_ii^-1 b_i.
   subroutine factorization_condense(self, b, partial, q)
      class(factorization_t), intent(in) :: self !! the factorisation
      real(dp), intent(in) :: b(:) !! the load (n)
      real(dp), contiguous, intent(out) :: partial(:) !! the forward substitution of the interior, for `expand` (n)
      real(dp), intent(out) :: q(:) !! the condensed load, trailing unknowns in matrix order (n_trailing)
      integer :: n_interior

      n_interior = self%n - self%n_trailing
      partial = b(self%order)
      call self%substitute_forward(n_interior, partial)
      q(self%trailing_order) = partial(n_interior + 1:)
   end subroutine factorization_condense

   !> The whole solution from that of the trailing unknowns: K_ii x_i = b_i - K_ic v.
   subroutine factorization_expand(self, partial, v, x)
      class(factorization_t), intent(in) :: self !! the factorisation
      real(dp), intent(in) :: partial(:) !! what `condense` made of the load (n)
      real(dp), intent(in) :: v(:) !! the trailing unknowns in matrix order (n_trailing)
      real(dp), intent(out) :: x(:) !! all unknowns (n), the trailing ones equal to v
      real(dp), allocatable :: work(:)
      integer :: n_interior

      n_interior = self%n - self%n_trailing
      allocate (work, source=partial)
      work(n_interior + 1:) = v(self%trailing_order)
      call self%substitute_backward(n_interior, work)
      x(self%order) = work
   end subroutine factorization_expand

   !> Estimates the condition number in the 1-norm with four or five solutions, by Higham's estimator of the norm of the
   !> inverse: a bound from below, rarely less than a third of the number.
   real(dp) function factorization_condition(self) result(condition)
      class(factorization_t), intent(in) :: self !! the factorisation, made by `analyze_matrix` and `complete`
      real(dp), allocatable :: v(:), x(:), y(:)
      real(dp) :: inverse_norm
      integer, allocatable :: signs(:)
      integer :: next, state(3)

      allocate (v(self%n), x(self%n), y(self%n), signs(self%n))
      next = 0
      inverse_norm = 0.0_dp
      do
         call dlacn2(self%n, v, x, signs, inverse_norm, next, state)
         if (next == 0) exit
         call self%solve(x, y)
         x = y
      end do
      condition = self%matrix_norm*inverse_norm
   end function factorization_condition

   !> The least condition number of a matrix that `check_pivots` refuses: its norm is at least the diagonal entry, that
   !> of its inverse at least the inverse of the pivot.
   pure real(dp) function factorization_least_refused_condition(self) result(condition)
      class(factorization_t), intent(in) :: self !! the factorisation

      condition = 1.0_dp/(epsilon(1.0_dp)*self%n)
   end function factorization_least_refused_condition

   !> Sets the order of elimination and keeps the diagonal for the check of the pivots; for makers of factorisations.
   pure subroutine factorization_set_order(self, matrix, n_trailing, order)
      class(factorization_t), intent(inout) :: self !! the factorisation
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_trailing !! number of trailing unknowns
      integer, intent(in) :: order(:) !! position k holds unknown order(k) (n)

      self%n = size(order)
      self%n_trailing = n_trailing
      self%order = order
      self%trailing_order = order(self%n - n_trailing + 1:) - (self%n - n_trailing)
      self%diagonal = matrix%value(matrix%column_start(order))
      self%n_work_entries = 0
      self%refused_unknown = 0
   end subroutine factorization_set_order

   !> Refuses a factor whose pivots have shrunk to rounding errors: its matrix is singular.
   pure subroutine factorization_check_pivots(self, pivots, error)
      class(factorization_t), intent(inout) :: self !! the factorisation
      real(dp), intent(in) :: pivots(:) !! the diagonal of L by position (n)
      type(error_t), allocatable, intent(out) :: error !! a pivot is not larger than its rounding error
      integer :: position

      do position = 1, self%n
         if (pivots(position)**2 > epsilon(1.0_dp)*self%n*self%diagonal(position)) cycle
         call self%refuse(position, error)
         return
      end do
      deallocate (self%diagonal)
   end subroutine factorization_check_pivots

   !> Reports that the matrix is not positive definite.
   pure subroutine factorization_refuse(self, position, error)
      class(factorization_t), intent(inout) :: self !! the factorisation
      integer, intent(in) :: position !! position of the first pivot that is not positive
      type(error_t), allocatable, intent(out) :: error !! what is wrong, naming the unknown

      self%refused_unknown = self%order(position)
      call new_error(error, numerical_failure, 'the matrix is not positive definite: the pivot of unknown '// &
         to_text(self%refused_unknown)//' of '//to_text(self%n)//' is not positive')
   end subroutine factorization_refuse

end module amontons_factorization
