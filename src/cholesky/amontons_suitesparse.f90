!> Sparse Cholesky by CHOLMOD's supernodal method in the order of CAMD: an independent implementation with another
!> method and another order, to which the program's own ones are compared.
module amontons_suitesparse
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_int, c_int64_t, c_null_char, c_null_ptr, &
      c_ptr
   use amontons_condenser, only: cholesky_t
   use amontons_dissection, only: backward_columns, forward_columns
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_sparse_matrix, only: graph_t, new_graph, sparse_matrix_t
   use amontons_text, only: to_text
   use amontons_threads, only: limit_nested_threads, restore_nested_threads, thread_state_t
   implicit none (type, external)
   private

   public :: has_suitesparse, minimum_degree, new_sparse_cholesky, suitesparse_text

   !> Whether this build has SuiteSparse.
   logical, parameter :: has_suitesparse = .true.

   !> The factor in supernodes: runs of columns with one row structure, each a dense block. CHOLMOD owns the arrays.
   !>
   !> What the arrays hold counts from 0: supernode k has the columns `column(k)` to `column(k+1) - 1`; its rows,
   !> its own columns first, are `row(row_start(k) + 1)` to `row(row_start(k+1))`; its block starts at
   !> `value(value_start(k) + 1)`.
   type, extends(cholesky_t) :: sparse_cholesky_t
      private
      type(c_ptr) :: handle = c_null_ptr !! CHOLMOD's side of the factorization.
      integer(int64), pointer, contiguous :: column(:) => null() !! First column of each supernode, and n.
      integer(int64), pointer, contiguous :: row_start(:) => null() !! Where the rows of each supernode start.
      integer(int64), pointer, contiguous :: value_start(:) => null() !! Where the block of each supernode starts.
      integer(int64), pointer, contiguous :: row(:) => null() !! Rows of the supernodes.
      real(dp), pointer, contiguous :: value(:) => null() !! Blocks of the supernodes.
   contains
      procedure, public :: analyze => sparse_analyze
      procedure, public :: complete => sparse_complete
      procedure, public :: substitute_forward => sparse_substitute_forward
      procedure, public :: substitute_backward => sparse_substitute_backward
      procedure, public :: schur_factor => sparse_schur_factor
      procedure :: get_block => sparse_get_block
      final :: sparse_free
   end type sparse_cholesky_t

   !> The factor as CHOLMOD returns it.
   type, bind(c) :: supernodes_t
      integer(c_int64_t) :: n_supernodes !! Number of supernodes.
      integer(c_int64_t) :: n_entries !! Number of stored entries.
      type(c_ptr) :: column !! First column of each supernode, and n.
      type(c_ptr) :: row_start !! Where the rows of each supernode start.
      type(c_ptr) :: value_start !! Where the block of each supernode starts.
      type(c_ptr) :: row !! Rows of the supernodes.
      type(c_ptr) :: value !! Blocks of the supernodes.
   end type supernodes_t

   integer(c_int), parameter :: done = 0, not_positive_definite = 1

   ! allow(assumed-size): C takes an address without a shape
   interface
      subroutine c_suitesparse_text(text, size) bind(c, name='amontons_suitesparse_text')
         import :: c_char, c_int
         implicit none (type, external)
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_int), value :: size
      end subroutine c_suitesparse_text

      function camd_order(n, start, neighbor, constraint, order) bind(c, name='amontons_camd_order') result(code)
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: n
         integer(c_int64_t), intent(in) :: start(*), neighbor(*), constraint(*)
         integer(c_int64_t), intent(out) :: order(*)
         integer(c_int) :: code
      end function camd_order

      function cholmod_analyze(n, column_start, row, value, handle, n_entries, n_work_entries, &
         n_flops) &
         bind(c, name='amontons_cholmod_analyze') result(code)
         import :: c_double, c_int, c_int64_t, c_ptr
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: n
         integer(c_int64_t), intent(inout) :: column_start(*), row(*)
         real(c_double), intent(inout) :: value(*)
         type(c_ptr), intent(inout) :: handle
         integer(c_int64_t), intent(inout) :: n_entries, n_work_entries
         real(c_double), intent(inout) :: n_flops
         integer(c_int) :: code
      end function cholmod_analyze

      function cholmod_factorize(handle, n, column_start, row, value, supernodes, failed) &
         bind(c, name='amontons_cholmod_factorize') result(code)
         import :: c_double, c_int, c_int64_t, c_ptr, supernodes_t
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         integer(c_int64_t), value, intent(in) :: n
         integer(c_int64_t), intent(inout) :: column_start(*), row(*)
         real(c_double), intent(inout) :: value(*)
         type(supernodes_t), intent(inout) :: supernodes
         integer(c_int64_t), intent(inout) :: failed
         integer(c_int) :: code
      end function cholmod_factorize

      subroutine cholmod_free(handle) bind(c, name='amontons_cholmod_free')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
      end subroutine cholmod_free
   end interface

contains

   !> Makes a factorization without a matrix.
   subroutine new_sparse_cholesky(cholesky, error)
      class(cholesky_t), allocatable, intent(out) :: cholesky !! the factorization
      type(error_t), allocatable, intent(out) :: error !! never allocated

      allocate (sparse_cholesky_t :: cholesky)
   end subroutine new_sparse_cholesky

   !> The versions of SuiteSparse and of CHOLMOD in it.
   function suitesparse_text() result(text)
      character(:), allocatable :: text
      character(100) :: buffer

      call c_suitesparse_text(buffer, len(buffer, c_int))
      text = buffer(:index(buffer, c_null_char) - 1)
   end function suitesparse_text

   !> Approximate minimum degree order: little fill.
   subroutine minimum_degree(matrix, n_schur, order, error)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: n_schur !! number of Schur variables, which come last
      integer, intent(out) :: order(:) !! position k holds unknown order(k) (n)
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(graph_t) :: graph
      integer(int64), allocatable :: constraint(:), graph_order(:)

      call new_graph(graph, matrix, n_schur)
      allocate (constraint(graph%n), source=0_int64)
      allocate (graph_order(graph%n))
      ! The sets in use must be numbered from 0.
      if (graph%n_schur < graph%n) constraint(graph%n - graph%n_schur + 1:) = 1
      graph%start = graph%start - 1
      graph%neighbor = graph%neighbor - 1
      if (camd_order(int(graph%n, int64), graph%start, graph%neighbor, constraint, graph_order) /= 0) then
         ! not raised: no test may use up the machine's memory
         call new_error(error, system_failure, 'memory ran out while ordering '//to_text(matrix%n)//' unknowns')
         return
      end if
      call graph%expand(int(graph_order) + 1, order)
   end subroutine minimum_degree

   !> Orders a matrix for little fill and finds the shape of its factor.
   subroutine sparse_analyze(self, matrix, n_schur, error)
      class(sparse_cholesky_t), intent(inout) :: self !! the factorization
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! number of Schur variables, which are the last unknowns
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer, allocatable :: order(:)
      integer(int64), allocatable :: column_start(:), row(:)
      type(thread_state_t) :: threads
      integer(c_int) :: code

      self%name = 'sparse'
      allocate (order(matrix%n))
      call minimum_degree(matrix, n_schur, order, error)
      if (allocated(error)) return
      call self%set_order(matrix, n_schur, order, error)
      if (allocated(error)) return
      column_start = self%matrix%column_start - 1
      row = self%matrix%row - 1_int64
      call limit_nested_threads(threads)
      code = cholmod_analyze(int(self%n, int64), column_start, row, self%matrix%value, self%handle, &
         self%n_factor_entries, self%n_work_entries, self%n_flops)
      call restore_nested_threads(threads)
      ! not raised: no test may use up the machine's memory
      if (code /= done) call new_error(error, system_failure, 'memory ran out while analyzing '//to_text(self%n)// &
         ' unknowns')
   end subroutine sparse_analyze

   !> Computes the factor of the matrix that was analyzed.
   subroutine sparse_complete(self, error)
      class(sparse_cholesky_t), intent(inout) :: self !! the factorization
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      integer(int64), allocatable :: column_start(:), row(:)
      type(supernodes_t) :: supernodes
      type(thread_state_t) :: threads
      integer(c_int64_t) :: failed
      integer(c_int) :: code

      column_start = self%matrix%column_start - 1
      row = self%matrix%row - 1_int64
      call limit_nested_threads(threads)
      code = cholmod_factorize(self%handle, int(self%n, int64), column_start, row, self%matrix%value, supernodes, &
         failed)
      call restore_nested_threads(threads)
      self%matrix = sparse_matrix_t()
      select case (code)
      case (done)
         ! The components show CHOLMOD's arrays.
         call c_f_pointer(supernodes%column, self%column, [supernodes%n_supernodes + 1])
         call c_f_pointer(supernodes%row_start, self%row_start, [supernodes%n_supernodes + 1])
         call c_f_pointer(supernodes%value_start, self%value_start, [supernodes%n_supernodes + 1])
         call c_f_pointer(supernodes%row, self%row, [self%row_start(supernodes%n_supernodes + 1)])
         call c_f_pointer(supernodes%value, self%value, [supernodes%n_entries])
         call self%check_factor(error)
      case (not_positive_definite)
         call self%refuse(self%order(failed + 1), error)
      case default
         ! not raised: no test may use up the machine's memory
         call new_error(error, system_failure, 'memory ran out while factorizing '//to_text(self%n)// &
            ' unknowns, whose factor alone takes '//to_text(8*self%n_factor_entries/1000000)//' MB')
      end select
   end subroutine sparse_complete

   !> Performs the forward substitution of the first columns.
   subroutine sparse_substitute_forward(self, n_steps, y)
      class(sparse_cholesky_t), intent(in) :: self !! the factorization
      integer, intent(in) :: n_steps !! number of columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      real(dp), allocatable :: x(:)
      integer(int64) :: at, rows
      integer :: first, i, k, n_columns, n_rows

      allocate (x(self%n))
      do k = 1, size(self%column) - 1
         if (self%column(k) >= n_steps) exit
         call self%get_block(k, n_steps, first, n_columns, n_rows, at, rows)
         x(:n_columns) = y(first:first + n_columns - 1)
         x(n_columns + 1:n_rows) = 0.0_dp
         call forward_columns(n_rows, n_columns, self%value(at:at + int(n_rows, int64)*n_columns - 1), x)
         y(first:first + n_columns - 1) = x(:n_columns)
         do i = n_columns + 1, n_rows
            y(self%row(rows + i) + 1) = y(self%row(rows + i) + 1) + x(i)
         end do
      end do
   end subroutine sparse_substitute_forward

   !> Performs the backward substitution of the first columns.
   subroutine sparse_substitute_backward(self, n_steps, y)
      class(sparse_cholesky_t), intent(in) :: self !! the factorization
      integer, intent(in) :: n_steps !! number of columns
      real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)
      real(dp), allocatable :: x(:, :)
      integer(int64) :: at, rows
      integer :: first, k, n_columns, n_rows, v

      allocate (x(self%n, size(y, 2)))
      do k = size(self%column) - 1, 1, -1
         if (self%column(k) >= n_steps) cycle
         call self%get_block(k, n_steps, first, n_columns, n_rows, at, rows)
         do v = 1, size(y, 2)
            x(:n_rows, v) = y(self%row(rows + 1:rows + n_rows) + 1, v)
            call backward_columns(n_rows, n_columns, 1, self%value(at:at + int(n_rows, int64)*n_columns - 1), x(:, v))
         end do
         y(first:first + n_columns - 1, :) = x(:n_columns, :)
      end do
   end subroutine sparse_substitute_backward

   !> The part of a supernode that lies in the first columns of L.
   pure subroutine sparse_get_block(self, k, n_steps, first, n_columns, n_rows, at, rows)
      class(sparse_cholesky_t), intent(in) :: self !! the factorization
      integer, intent(in) :: k !! number of the supernode
      integer, intent(in) :: n_steps !! how many columns of L count
      integer, intent(out) :: first !! its first column
      integer, intent(out) :: n_columns !! how many of its columns count
      integer, intent(out) :: n_rows !! its number of rows, the distance between columns in `value`
      integer(int64), intent(out) :: at !! where its block starts in `value`
      integer(int64), intent(out) :: rows !! its rows start after this place in `row`

      first = int(self%column(k)) + 1
      n_columns = min(int(self%column(k + 1)), n_steps) - first + 1
      n_rows = int(self%row_start(k + 1) - self%row_start(k))
      at = self%value_start(k) + 1
      rows = self%row_start(k)
   end subroutine sparse_get_block

   !> Copies the last block of L out of the supernodes; the first one may reach into the interior.
   subroutine sparse_schur_factor(self, l22)
      class(sparse_cholesky_t), intent(in) :: self !! the factorization
      real(dp), contiguous, intent(out) :: l22(:, :)
         !! lower triangular, zeros above, in the order `schur_order` (n_schur, n_schur)
      integer(int64) :: at, rows
      integer :: first, i, j, k, n_columns, n_interior, n_rows

      n_interior = self%n - self%n_schur
      l22 = 0.0_dp
      do k = size(self%column) - 1, 1, -1
         if (self%column(k + 1) <= n_interior) exit
         call self%get_block(k, self%n, first, n_columns, n_rows, at, rows)
         do j = max(first, n_interior + 1), first + n_columns - 1
            at = self%value_start(k) + 1 + (j - first)*int(n_rows, int64)
            do i = j - first + 1, n_rows
               l22(self%row(rows + i) + 1 - n_interior, j - n_interior) = self%value(at + i - 1)
            end do
         end do
      end do
   end subroutine sparse_schur_factor

   !> Frees the memory of CHOLMOD.
   subroutine sparse_free(self)
      type(sparse_cholesky_t), intent(inout) :: self !! the factorization

      call cholmod_free(self%handle)
   end subroutine sparse_free

end module amontons_suitesparse
