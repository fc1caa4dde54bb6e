!> Condensation of a symmetric positive definite system, the interface between contact and the library that factorizes a
!> body; and condensation by a Cholesky factor with the Schur variables eliminated last, whatever library computes the
!> factor.
!>
!> The Schur variables c are the last unknowns of the matrix K, the interior i are the others. A condenser makes S =
!> K_cc - K_ci K_ii^-1 K_ic, for any load b the condensed load q = b_c - K_ci K_ii^-1 b_i, and from the Schur variables
!> v, given or found by S v = q, all unknowns. How and where it stores its factors is private to it.
!>
!> P K P^T = L L^T, where P puts unknown `order(k)` in position k and keeps the Schur variables last. The last block of
!> L is the Cholesky factor of the Schur complement S, and a forward substitution that stops before this block leaves
!> the condensed load in place of the load on the Schur variables.
module amontons_condenser
   use amontons_dense, only: fill_upper
   use amontons_error, only: error_t, new_error, numerical_failure, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dlacn2, dlauum
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_system, only: available_memory_mb, return_memory
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: cholesky_t, condenser_t, known_solutions

   !> A condenser. Procedures called after `complete` only read it, so several threads may use it at the same time.
   type, abstract :: condenser_t
      character(:), allocatable :: name !! The word for its kind; like all that follows, known after `analyze`.
      integer :: n = 0 !! Number of unknowns.
      integer :: n_schur = 0 !! Number of Schur variables.
      integer(int64) :: n_factor_entries = 0 !! Entries of the factor, stored zeros included.
      integer(int64) :: n_work_entries = 0 !! Numbers that `complete` holds for a while, beside the factor's.
      real(dp) :: n_flops = 0.0_dp !! Floating-point operations of `complete`.
      real(dp) :: matrix_norm = 0.0_dp !! 1-norm of the matrix.
      real(dp), allocatable :: schur_diagonal(:)
         !! Diagonal entries of the Schur variables, where it assembles the matrix itself.
      real(dp), allocatable :: known_load(:, :)
         !! The matrix times its known solutions, from where it was seen until its factor is tested by them (n, 2).
      integer :: refused_unknown = 0 !! An unknown that the factor does not determine, 0 for none.
   contains
      procedure(complete), deferred :: complete
      procedure(schur_complement), deferred :: schur_complement
      procedure(condense), deferred :: condense
      procedure(expand_all), deferred :: expand_all
      procedure(solve), deferred :: solve
      procedure :: expand => condenser_expand
      procedure :: check_memory => condenser_check_memory
      procedure :: memory_mb => condenser_memory_mb
      procedure :: condition => condenser_condition
      procedure :: check_solutions => condenser_check_solutions
      procedure :: refuse => condenser_refuse
   end type condenser_t

   abstract interface
      !> Computes the factor of the matrix that was analyzed.
      subroutine complete(self, error)
         import :: condenser_t, error_t
         implicit none (type, external)
         class(condenser_t), intent(inout) :: self !! the condenser
         type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      end subroutine complete

      !> The Schur complement S.
      subroutine schur_complement(self, s)
         import :: condenser_t, dp
         implicit none (type, external)
         class(condenser_t), intent(in) :: self !! the condenser
         real(dp), contiguous, intent(out) :: s(:, :)
            !! S, both triangles, Schur variables in matrix order (n_schur, n_schur)
      end subroutine schur_complement

      !> Eliminates the interior from a load.
      subroutine condense(self, b, partial, q)
         import :: condenser_t, dp
         implicit none (type, external)
         class(condenser_t), intent(in) :: self !! the condenser
         real(dp), intent(in) :: b(:) !! the load (n)
         real(dp), contiguous, intent(out) :: partial(:) !! partial result for `expand` (n)
         real(dp), intent(out) :: q(:) !! the condensed load, Schur variables in matrix order (n_schur)
      end subroutine condense

      !> Computes all unknowns from the Schur variables under several loads, K_ii x_i = b_i - K_ic v, with one pass over
      !> the factor.
      subroutine expand_all(self, partial, v, x)
         import :: condenser_t, dp
         implicit none (type, external)
         class(condenser_t), intent(in) :: self !! the condenser
         real(dp), contiguous, intent(in) :: partial(:, :) !! partial results of `condense` (n, loads)
         real(dp), contiguous, intent(in) :: v(:, :) !! the Schur variables in matrix order (n_schur, loads)
         real(dp), contiguous, intent(out) :: x(:, :) !! all unknowns (n, loads), the last ones equal to v
      end subroutine expand_all

      !> Solves K x = b.
      subroutine solve(self, b, x)
         import :: condenser_t, dp
         implicit none (type, external)
         class(condenser_t), intent(in) :: self !! the condenser
         real(dp), intent(in) :: b(:) !! right-hand side (n)
         real(dp), intent(out) :: x(:) !! the solution (n)
      end subroutine solve
   end interface

   !> A Cholesky factorization.
   type, abstract, extends(condenser_t) :: cholesky_t
      integer, allocatable :: order(:) !! Position k holds unknown order(k) (n).
      integer, allocatable :: schur_order(:) !! Their k-th position holds Schur variable schur_order(k) (n_schur).
      type(sparse_matrix_t) :: matrix !! P K P^T, until `complete` has put it where the factor will be.
   contains
      procedure(analyze), deferred :: analyze
      procedure(substitute_forward), deferred :: substitute_forward
      procedure(substitute_backward), deferred :: substitute_backward
      procedure(schur_factor), deferred :: schur_factor
      procedure :: solve => cholesky_solve
      procedure :: schur_complement => cholesky_schur_complement
      procedure :: condense => cholesky_condense
      procedure :: expand_all => cholesky_expand_all
      procedure :: set_order => cholesky_set_order
      procedure :: check_factor => cholesky_check_factor
   end type cholesky_t

   abstract interface
      !> Orders a matrix and finds the size of its factor. Copies what it needs of the matrix, so that the caller may
      !> deallocate it before `complete`.
      subroutine analyze(self, matrix, n_schur, error)
         import :: cholesky_t, error_t, sparse_matrix_t
         implicit none (type, external)
         class(cholesky_t), intent(inout) :: self !! the factorization
         type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
         integer, intent(in) :: n_schur !! number of Schur variables, which are the last unknowns
         type(error_t), allocatable, intent(out) :: error !! memory ran out
      end subroutine analyze

      !> Performs the steps of a forward substitution that belong to the first columns of L.
      subroutine substitute_forward(self, n_steps, y)
         import :: cholesky_t, dp
         implicit none (type, external)
         class(cholesky_t), intent(in) :: self !! the factorization
         integer, intent(in) :: n_steps !! number of columns, at least those of the interior
         real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      end subroutine substitute_forward

      !> Performs the steps of backward substitutions that belong to the first columns of L, for several vectors. An
      !> implementation with blocks of columns reads each block once for all vectors.
      subroutine substitute_backward(self, n_steps, y)
         import :: cholesky_t, dp
         implicit none (type, external)
         class(cholesky_t), intent(in) :: self !! the factorization
         integer, intent(in) :: n_steps !! number of columns, at least those of the interior
         real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)
      end subroutine substitute_backward

      !> The last block of L, the Cholesky factor of the Schur complement.
      subroutine schur_factor(self, l22)
         import :: cholesky_t, dp
         implicit none (type, external)
         class(cholesky_t), intent(in) :: self !! the factorization
         real(dp), contiguous, intent(out) :: l22(:, :)
            !! lower triangular, zeros above, in the order `schur_order` (n_schur, n_schur)
      end subroutine schur_factor
   end interface

contains

   !> Computes all unknowns from the Schur variables under one load.
   subroutine condenser_expand(self, partial, v, x)
      class(condenser_t), intent(in) :: self !! the condenser
      real(dp), intent(in) :: partial(:) !! partial result of `condense` (n)
      real(dp), intent(in) :: v(:) !! the Schur variables in matrix order (n_schur)
      real(dp), intent(out) :: x(:) !! all unknowns (n), the last ones equal to v
      real(dp), allocatable :: columns(:, :)

      allocate (columns(self%n, 1))
      call self%expand_all(reshape(partial, [self%n, 1]), reshape(v, [self%n_schur, 1]), columns)
      x = columns(:, 1)
   end subroutine condenser_expand

   !> The memory that `complete` takes [MB].
   pure real(dp) function condenser_memory_mb(self)
      class(condenser_t), intent(in) :: self !! the condenser, the matrix analyzed

      condenser_memory_mb = 8.0e-6_dp*real(self%n_factor_entries + self%n_work_entries, dp)
   end function condenser_memory_mb

   !> Refuses a factor that does not fit in memory, before anything is allocated for it. Memory freed after the analysis
   !> is first returned to the system.
   subroutine condenser_check_memory(self, error)
      class(condenser_t), intent(in) :: self !! the condenser, the matrix analyzed
      type(error_t), allocatable, intent(out) :: error !! not enough memory

      call return_memory()
      if (self%memory_mb() <= available_memory_mb()) return
      call new_error(error, system_failure, 'not enough memory: the '//self%name//' factor of '// &
         to_text(self%n)//' unknowns needs '//to_text(nint(self%memory_mb(), int64))//' MB, and '// &
         to_text(nint(available_memory_mb(), int64))//' MB are available')
   end subroutine condenser_check_memory

   !> Estimates the condition number in the 1-norm from four or five solutions, by Higham's estimator of the norm of
   !> the inverse: a lower bound, rarely less than a third of the number.
   real(dp) function condenser_condition(self) result(condition)
      class(condenser_t), intent(in) :: self !! the condenser, complete
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
   end function condenser_condition

   !> Two arbitrary vectors between -1.25 and 1.25, which no motion of a body resembles: fractions of multiples of the
   !> square of the number of the unknown, in whole numbers, so that all ranks find the same (unknowns, 2).
   pure function known_solutions(unknown) result(solutions)
      integer, intent(in) :: unknown(:) !! numbers of the unknowns
      real(dp) :: solutions(size(unknown), 2)
      ! The fractions of the golden ratio and of the root of 2, times 2**31.
      integer(int64), parameter :: period = 2_int64**31, factor(2) = [1327217885_int64, 889516853_int64]
      integer :: i

      do i = 1, 2
         solutions(:, i) = 2.5_dp*real(iand(factor(i)*iand(int(unknown, int64)**2, period - 1), period - 1), dp) &
            /real(period, dp) - 1.25_dp
      end do
   end function known_solutions

   !> Refuses a factor that does not give the known solutions back. That of a singular matrix has a pivot of rounding
   !> errors, which may be as large as a small one and of either sign, and returns its kernel times a number of order 1.
   !> One number may be small by chance, two of them are not: the larger one was above 0.19 in all mechanisms, below
   !> 4e-4 in rods 2000 times as long as wide, and about 1e-2 where parts of a body differ by 1e12 in stiffness.
   pure subroutine condenser_check_solutions(self, solutions, error)
      class(condenser_t), intent(inout) :: self !! the condenser; loses the known loads
      real(dp), intent(in) :: solutions(:, :) !! what its factor makes of these (n, 2)
      type(error_t), allocatable, intent(out) :: error !! the matrix is singular to rounding
      real(dp), parameter :: most = 0.1_dp ! between these numbers
      integer :: i

      deallocate (self%known_load)
      associate (off => abs(solutions - known_solutions([(i, i=1, self%n)])))
         if (.not. all(off <= most)) call self%refuse(maxloc(maxval(off, dim=2), dim=1), error)
      end associate
   end subroutine condenser_check_solutions

   !> Refuses the matrix at an unknown.
   pure subroutine condenser_refuse(self, unknown, error)
      class(condenser_t), intent(inout) :: self !! the condenser
      integer, intent(in) :: unknown !! an unknown whose pivot is not positive, or whose error is the largest
      type(error_t), allocatable, intent(out) :: error !! the message, with the number of the unknown

      self%refused_unknown = unknown
      call new_error(error, numerical_failure, 'the matrix is not positive definite, or singular to rounding: '// &
         'unknown '//to_text(unknown)//' of '//to_text(self%n)//' is not determined')
   end subroutine condenser_refuse

   !> Sets the order of elimination and takes the matrix in this order; for `analyze`.
   subroutine cholesky_set_order(self, matrix, n_schur, order, error)
      class(cholesky_t), intent(inout) :: self !! the factorization
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! number of Schur variables
      integer, intent(in) :: order(:) !! position k holds unknown order(k) (n)
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp), allocatable :: solutions(:, :), products(:, :)
      integer :: i

      self%n = size(order)
      self%n_schur = n_schur
      self%order = order
      self%schur_order = order(self%n - n_schur + 1:) - (self%n - n_schur)
      self%matrix_norm = matrix%norm()
      ! gfortran 12 passes a transposed function as if it were contiguous.
      solutions = transpose(known_solutions([(i, i=1, self%n)]))
      allocate (products, mold=solutions)
      call matrix%multiply(solutions, products)
      self%known_load = transpose(products)
      call matrix%permute(order, self%matrix, error)
   end subroutine cholesky_set_order

   !> Solves K x = b.
   subroutine cholesky_solve(self, b, x)
      class(cholesky_t), intent(in) :: self !! the factorization
      real(dp), intent(in) :: b(:) !! right-hand side (n)
      real(dp), intent(out) :: x(:) !! the solution (n)
      real(dp), allocatable :: y(:, :)

      allocate (y(self%n, 1))
      y(:, 1) = b(self%order)
      call self%substitute_forward(self%n, y(:, 1))
      call self%substitute_backward(self%n, y)
      x(self%order) = y(:, 1)
   end subroutine cholesky_solve

   !> The Schur complement S = L22 L22^T of the matrix that was factorized.
   subroutine cholesky_schur_complement(self, s)
      class(cholesky_t), intent(in) :: self !! the factorization
      real(dp), contiguous, intent(out) :: s(:, :)
         !! S, both triangles, Schur variables in matrix order (n_schur, n_schur)
      real(dp), allocatable :: diagonal(:)
      integer :: i, j, m, info

      m = self%n_schur
      call self%schur_factor(s)
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
      associate (order => self%schur_order(m:1:-1))
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
   end subroutine cholesky_schur_complement

   !> Eliminates the interior from a load by the forward substitution of the interior.
   subroutine cholesky_condense(self, b, partial, q)
      class(cholesky_t), intent(in) :: self !! the factorization
      real(dp), intent(in) :: b(:) !! the load (n)
      real(dp), contiguous, intent(out) :: partial(:) !! the vector after the forward substitution (n)
      real(dp), intent(out) :: q(:) !! the condensed load, Schur variables in matrix order (n_schur)
      integer :: n_interior

      n_interior = self%n - self%n_schur
      partial = b(self%order)
      call self%substitute_forward(n_interior, partial)
      q(self%schur_order) = partial(n_interior + 1:)
   end subroutine cholesky_condense

   !> Computes all unknowns from the Schur variables by the backward substitution of the interior, with one pass over
   !> the factor.
   subroutine cholesky_expand_all(self, partial, v, x)
      class(cholesky_t), intent(in) :: self !! the factorization
      real(dp), contiguous, intent(in) :: partial(:, :) !! partial results of `condense` (n, loads)
      real(dp), contiguous, intent(in) :: v(:, :) !! the Schur variables in matrix order (n_schur, loads)
      real(dp), contiguous, intent(out) :: x(:, :) !! all unknowns (n, loads)
      real(dp), allocatable :: work(:, :)
      integer :: n_interior

      n_interior = self%n - self%n_schur
      allocate (work, source=partial)
      work(n_interior + 1:, :) = v(self%schur_order, :)
      call self%substitute_backward(n_interior, work)
      x(self%order, :) = work
   end subroutine cholesky_expand_all

   !> Tests a complete factor by its known solutions.
   subroutine cholesky_check_factor(self, error)
      class(cholesky_t), intent(inout) :: self !! the factorization
      type(error_t), allocatable, intent(out) :: error !! the matrix is singular to rounding
      real(dp), allocatable :: y(:, :), solutions(:, :)
      integer :: i

      y = self%known_load(self%order, :)
      do i = 1, size(y, 2)
         call self%substitute_forward(self%n, y(:, i))
      end do
      call self%substitute_backward(self%n, y)
      allocate (solutions, mold=y)
      solutions(self%order, :) = y
      call self%check_solutions(solutions, error)
   end subroutine cholesky_check_factor

end module amontons_condenser
