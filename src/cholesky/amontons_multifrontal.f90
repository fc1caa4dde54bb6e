!> Multifrontal Cholesky in the order of a nested dissection, on several threads.
!>
!> The matrix of a front is what its pivot columns p have of K, plus the contribution blocks of its children;
!> eliminating p leaves its own contribution block, F_rr - F_rp F_pp^-1 F_pr on its row structure r (Duff and Reid, ACM
!> Trans. Math. Softw. 9, 1983). This is static condensation, from the leaves of the dissection upwards. The last front,
!> the root, has the Schur variables among its pivots and no row structure. A contribution block is a lower triangle in
!> panels of columns, each panel full from the first row of its first column on.
!>
!> A substitution goes forward from the leaves to the root, backward from it. A front passes a number for each item of
!> its row structure to its parent on a stack: in the order of elimination the children of a front are the last that
!> have put something there. Large subtrees, on threads of their own, have stacks of their own.
!>
!> Sums run in the order of the fronts, so results do not depend on the number of threads.
module amontons_multifrontal
   use amontons_condenser, only: cholesky_t
   use amontons_dense, only: cholesky_factor_tiled
   use amontons_dissection, only: backward_columns, dissection_t, forward_columns, fronts_t, new_dissection, new_fronts
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dgemm, dpotrf, dsyrk, dtrsm
   use amontons_sparse_matrix, only: graph_places, graph_t, new_graph, sparse_matrix_t
   use amontons_text, only: to_text
   use amontons_threads, only: limit_nested_threads, n_threads, restore_nested_threads, thread_state_t
   implicit none (type, external)
   private

   public :: contribution_size, eliminate_pivots, multifrontal_t

   !> Number of columns of a panel; measured, like the two below.
   integer, parameter :: panel = 256
   !> Lower triangles of at most this order are computed as full matrices.
   integer, parameter :: narrow = 96
   !> So many columns are factorized at once.
   integer, parameter :: few = 24
   !> Number of products in a substitution from which threads are worth waiting for each other, on a busy machine long.
   integer, parameter :: worth_threads = 2000000

   !> The contribution block of a front, which is added to its parent.
   type :: contribution_t
      real(dp), allocatable :: s(:) !! the contribution block (contribution_size(n_structure))
      integer :: refused = 0 !! position of the first pivot that was not positive, here or below; 0 for none
      logical :: is_short = .false. !! whether memory ran out, here or below
   end type contribution_t

   !> The columns of L in the blocks of the fronts.
   type, extends(cholesky_t) :: multifrontal_t
      private
      type(fronts_t) :: fronts !! The fronts.
      real(dp), allocatable :: value(:) !! The blocks: the pivot columns of each front on its rows (n_rows, n_pivots).
   contains
      procedure, public :: analyze => multifrontal_analyze
      procedure, public :: complete => multifrontal_complete
      procedure, public :: substitute_forward => multifrontal_substitute_forward
      procedure, public :: substitute_backward => multifrontal_substitute_backward
      procedure, public :: schur_factor => multifrontal_schur_factor
   end type multifrontal_t

contains

   !> Number of entries of a contribution block.
   pure integer(int64) function contribution_size(n_structure)
      integer, intent(in) :: n_structure !! number of unknowns in the row structure

      contribution_size = row_0(n_structure, n_structure) + n_structure
   end function contribution_size

   !> Position that row 0 of a column of a contribution block would have.
   pure integer(int64) function row_0(n, j)
      integer, intent(in) :: n !! order of the contribution block
      integer, intent(in) :: j !! number of the column
      integer(int64) :: before

      before = (j - 1)/panel*panel
      row_0 = before*n - before*(before - panel)/2 + (j - 1 - before)*(n - before) - before
   end function row_0

   !> Adds the contribution block of a child to the pivot columns of its parent.
   pure subroutine add_to_pivots(row, s, n_pivots, n_rows, block)
      integer, intent(in) :: row(:) !! row of the parent of each row of the child's block
      real(dp), contiguous, intent(in) :: s(:) !! the child's block
      integer, intent(in) :: n_pivots !! number of pivot columns
      integer, intent(in) :: n_rows !! number of rows of the parent
      real(dp), contiguous, intent(inout) :: block(:) !! the pivot columns
      integer :: run_end(size(row)), j

      run_end = run_ends(row)
      do j = 1, size(row)
         if (row(j) > n_pivots) exit
         call add_column(row, run_end, j, row_0(size(row), j), s, (row(j) - 1)*int(n_rows, int64), block)
      end do
   end subroutine add_to_pivots

   !> Adds the contribution block of a child to that of its parent.
   pure subroutine add_to_contribution(row, s, n_pivots, n_structure, sum)
      integer, intent(in) :: row(:) !! row of the parent of each row of the child's block
      real(dp), contiguous, intent(in) :: s(:) !! the child's block
      integer, intent(in) :: n_pivots !! number of pivot columns of the parent
      integer, intent(in) :: n_structure !! number of items of its row structure
      real(dp), contiguous, intent(inout) :: sum(:) !! the parent's block
      integer :: run_end(size(row)), j

      run_end = run_ends(row)
      do j = count(row <= n_pivots) + 1, size(row)
         call add_column(row, run_end, j, row_0(size(row), j), s, row_0(n_structure, row(j) - n_pivots) - n_pivots, sum)
      end do
   end subroutine add_to_contribution

   !> For each row the end of the run of consecutive rows that it belongs to.
   pure function run_ends(row) result(run_end)
      integer, intent(in) :: row(:) !! the rows
      integer :: run_end(size(row))
      integer :: i

      do i = size(row), 1, -1
         run_end(i) = i
         if (i == size(row)) cycle
         if (row(i + 1) == row(i) + 1) run_end(i) = run_end(i + 1)
      end do
   end function run_ends

   !> Adds a column of a child's block, from its diagonal on, to a column of the parent.
   pure subroutine add_column(row, run_end, j, s_0, s, sum_0, sum)
      integer, intent(in) :: row(:) !! row of the parent of each row of the child's block
      integer, intent(in) :: run_end(:) !! where the run of each ends
      integer, intent(in) :: j !! number of the column
      integer(int64), intent(in) :: s_0 !! where its row 0 would be
      real(dp), contiguous, intent(in) :: s(:) !! the child's block
      integer(int64), intent(in) :: sum_0 !! where row 0 of the parent's column would be
      real(dp), contiguous, intent(inout) :: sum(:) !! what gains it
      integer :: i, last

      i = j
      do while (i <= size(row))
         last = run_end(i)
         associate (to => sum_0 + row(i))
            sum(to:to + last - i) = sum(to:to + last - i) + s(s_0 + i:s_0 + last)
         end associate
         i = last + 1
      end do
   end subroutine add_column

   !> Factorizes the pivot columns, L_11 L_11^T = F_pp and L_21 = F_bp L_11^-T, and computes the contribution block
   !> -L_21 L_21^T.
   pure subroutine eliminate_pivots(n_rows, n_pivots, block, s, info)
      integer, intent(in) :: n_rows !! number of rows
      integer, intent(in) :: n_pivots !! number of pivot columns
      real(dp), intent(inout) :: block(n_rows, n_pivots) !! the pivot columns
      real(dp), intent(out) :: s(contribution_size(n_rows - n_pivots)) !! the contribution block
      integer, intent(out) :: info !! 0, or which column has a pivot that is not positive
      integer(int64) :: at
      integer :: j, lds

      call factorize_columns(n_rows, n_rows, n_pivots, block, info)
      if (info > 0) return
      do j = 1, n_rows - n_pivots, panel
         lds = n_rows - n_pivots - j + 1
         at = row_0(n_rows - n_pivots, j) + j
         if (lds <= narrow) then
            ! In so small a matrix the upper triangle costs less than the bookkeeping of leaving it out.
            call dgemm('N', 'T', lds, lds, n_pivots, -1.0_dp, block(n_pivots + j, 1), n_rows, block(n_pivots + j, 1), &
               n_rows, 0.0_dp, s(at), lds)
         else
            call dsyrk('L', 'N', min(panel, lds), n_pivots, -1.0_dp, block(n_pivots + j, 1), n_rows, 0.0_dp, s(at), lds)
         end if
         if (lds > panel) call dgemm('N', 'T', lds - panel, panel, n_pivots, -1.0_dp, block(n_pivots + j + panel, 1), &
            n_rows, block(n_pivots + j, 1), n_rows, 0.0_dp, s(at + panel), lds)
      end do
   end subroutine eliminate_pivots

   !> Factorizes columns recursively: the left half, its update of the right half, the right half. Most of the work is
   !> then products of matrices, which are the fastest operations of a BLAS.
   pure recursive subroutine factorize_columns(ld, n_rows, n, l, info)
      integer, intent(in) :: ld !! distance between columns
      integer, intent(in) :: n_rows !! number of rows
      integer, intent(in) :: n !! number of columns
      real(dp), intent(inout) :: l(ld, n) !! the columns; on return those of L
      integer, intent(out) :: info !! 0, or which column has a pivot that is not positive
      integer :: half

      if (n <= few) then
         call dpotrf('L', n, l, ld, info)
         if (info == 0 .and. n_rows > n) call dtrsm('R', 'L', 'T', 'N', n_rows - n, n, 1.0_dp, l, ld, l(n + 1, 1), ld)
         return
      end if
      half = n/2
      call factorize_columns(ld, n_rows, half, l, info)
      if (info > 0) return
      call dgemm('N', 'T', n_rows - half, n - half, half, -1.0_dp, l(half + 1, 1), ld, l(half + 1, 1), ld, 1.0_dp, &
         l(half + 1, half + 1), ld)
      call factorize_columns(ld, n_rows - half, n - half, l(half + 1, half + 1), info)
      if (info > 0) info = info + half
   end subroutine factorize_columns

   !> Performs the forward substitution of a front after that of its descendants.
   recursive subroutine forward_subtree(fronts, value, k, n_steps, y, gain)
      type(fronts_t), intent(in) :: fronts !! the fronts
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: n_steps !! number of columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), contiguous, intent(out) :: gain(:) !! sums for its row structure (n_structure)
      real(dp) :: stack(fronts%stack_size(k))
      integer :: i, middle, top

      top = 0
      if (fronts%is_large(k)) then
         associate (child => fronts%child(:, k))
            middle = fronts%n_structure(child(1))
            top = middle + fronts%n_structure(child(2))
            if (child(1) > 0) then
               !$omp task default(none) shared(fronts, value, n_steps, y, stack, k, middle)
               call forward_subtree(fronts, value, fronts%child(1, k), n_steps, y, stack(:middle))
               !$omp end task
            end if
            if (child(2) > 0) call forward_subtree(fronts, value, child(2), n_steps, y, stack(middle + 1:top))
            !$omp taskwait
         end associate
      else
         do i = fronts%first_descendant(k), k - 1
            call forward_front(fronts, value, i, n_steps, y, stack, top)
         end do
      end if
      call forward_front(fronts, value, k, n_steps, y, stack, top)
      gain = stack(:top)
   end subroutine forward_subtree

   !> Performs the forward substitution of one front.
   subroutine forward_front(fronts, value, k, n_steps, y, stack, top)
      type(fronts_t), intent(in) :: fronts !! the fronts
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: n_steps !! number of columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), intent(inout) :: stack(:) !! what row structures gain: that of its children is replaced by its own
      integer, intent(inout) :: top !! number of stack entries in use
      real(dp) :: x(fronts%n_rows(k))
      integer(int64) :: at
      integer :: i, from

      associate (n_pivots => fronts%n_pivots(k), first => fronts%first(k), child => fronts%child(:, k))
         x(:n_pivots) = y(first:first + n_pivots - 1)
         x(n_pivots + 1:) = 0.0_dp
         top = top - sum(fronts%n_structure(child))
         from = top
         do i = 1, 2
            if (child(i) == 0) cycle
            do at = fronts%structure_start(child(i)), fronts%structure_start(child(i) + 1) - 1
               from = from + 1
               x(fronts%parent_row(at)) = x(fronts%parent_row(at)) + stack(from)
            end do
         end do
         ! Most loads are on the boundary: of many fronts inside the body nothing is left to do.
         if (.not. all(abs(x(:n_pivots)) <= 0.0_dp)) then
            call forward_columns(size(x), min(n_pivots, n_steps - first + 1), value(fronts%block_start(k):), x)
            y(first:first + n_pivots - 1) = x(:n_pivots)
         end if
         stack(top + 1:top + size(x) - n_pivots) = x(n_pivots + 1:)
         top = top + size(x) - n_pivots
      end associate
   end subroutine forward_front

   !> Performs the backward substitution of a front and then that of its descendants, for several vectors at once.
   recursive subroutine backward_subtree(fronts, value, k, n_steps, y, known)
      type(fronts_t), intent(in) :: fronts !! the fronts
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: n_steps !! number of columns
      real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)
      real(dp), contiguous, intent(in) :: known(:, :) !! the vectors on the row structure (vectors, n_structure)
      real(dp) :: stack(size(y, 2), fronts%stack_size(k))
      integer :: i, middle, top

      top = size(known, 2)
      stack(:, :top) = known
      call backward_front(fronts, value, k, n_steps, y, stack, top)
      if (fronts%is_large(k)) then
         associate (child => fronts%child(:, k))
            middle = fronts%n_structure(child(1))
            if (child(1) > 0) then
               !$omp task default(none) shared(fronts, value, n_steps, y, stack, k, middle)
               call backward_subtree(fronts, value, fronts%child(1, k), n_steps, y, stack(:, :middle))
               !$omp end task
            end if
            if (child(2) > 0) call backward_subtree(fronts, value, child(2), n_steps, y, stack(:, middle + 1:top))
            !$omp taskwait
         end associate
      else
         do i = k - 1, fronts%first_descendant(k), -1
            call backward_front(fronts, value, i, n_steps, y, stack, top)
         end do
      end if
   end subroutine backward_subtree

   !> Performs the backward substitution of one front.
   subroutine backward_front(fronts, value, k, n_steps, y, stack, top)
      type(fronts_t), intent(in) :: fronts !! the fronts
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: n_steps !! number of columns
      real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)
      real(dp), intent(inout) :: stack(:, :)
         !! the vectors on row structures: its own is replaced by those of its children (vectors, any)
      integer, intent(inout) :: top !! number of stack entries in use
      real(dp) :: x(fronts%n_rows(k), size(y, 2))
      integer(int64) :: at
      integer :: i, v

      associate (n_pivots => fronts%n_pivots(k), first => fronts%first(k), child => fronts%child(:, k))
         top = top - (size(x, 1) - n_pivots)
         do v = 1, size(y, 2)
            x(:n_pivots, v) = y(first:first + n_pivots - 1, v)
            x(n_pivots + 1:, v) = stack(v, top + 1:top + size(x, 1) - n_pivots)
         end do
         call backward_columns(size(x, 1), min(n_pivots, n_steps - first + 1), size(y, 2), &
            value(fronts%block_start(k):), x)
         do v = 1, size(y, 2)
            y(first:first + n_pivots - 1, v) = x(:n_pivots, v)
         end do
         do i = 1, 2
            if (child(i) == 0) cycle
            do at = fronts%structure_start(child(i)), fronts%structure_start(child(i) + 1) - 1
               top = top + 1
               stack(:, top) = x(fronts%parent_row(at), :)
            end do
         end do
      end associate
   end subroutine backward_front

   !> Dissects the matrix and finds the fronts.
   subroutine multifrontal_analyze(self, matrix, n_schur, error)
      class(multifrontal_t), intent(inout) :: self !! the factorization
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! number of Schur variables, which are the last unknowns
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(graph_t) :: graph
      type(dissection_t) :: dissection
      integer, allocatable :: order(:)

      self%name = 'multifrontal'
      call new_graph(graph, matrix, n_schur)
      if (allocated(matrix%place)) then
         call new_dissection(dissection, graph, matrix%place(:, graph%first_unknown(:graph%n - graph%n_schur)))
      else
         call new_dissection(dissection, graph, graph_places(graph))
      end if
      allocate (order(matrix%n))
      call graph%expand(dissection%order, order)
      call self%set_order(matrix, n_schur, order, error)
      if (allocated(error)) return
      call new_fronts(self%fronts, graph, dissection)
      call count_work(self)
   end subroutine multifrontal_analyze

   !> Counts the operations, and the entries that are held temporarily: contribution blocks that wait for their parents,
   !> on several threads while the two children of the root are processed at the same time. More than two need little
   !> more, since subtrees shrink as their number grows.
   subroutine count_work(self)
      type(multifrontal_t), intent(inout) :: self !! the factorization, its fronts known
      integer(int64) :: most(0:self%fronts%n), left(0:self%fronts%n)
      integer :: k, child(2)
      real(dp) :: n_pivots, n_structure

      most(0) = 0
      left(0) = 0
      self%n_factor_entries = self%fronts%block_start(self%fronts%n + 1) - 1
      self%n_flops = 0.0_dp
      do k = 1, self%fronts%n
         child = self%fronts%child(:, k)
         n_pivots = self%fronts%n_pivots(k)
         n_structure = self%fronts%n_structure(k)
         left(k) = contribution_size(self%fronts%n_structure(k))
         most(k) = max(most(child(1)), left(child(1)) + most(child(2)), left(k) + sum(left(child)))
         self%n_flops = self%n_flops + n_pivots**3/3.0_dp + n_pivots**2*n_structure + n_pivots*n_structure**2
      end do
      self%n_work_entries = merge(sum(most(child)), most(self%fronts%n), n_threads() > 1)
   end subroutine count_work

   !> Computes the blocks of the fronts.
   subroutine multifrontal_complete(self, error)
      class(multifrontal_t), intent(inout) :: self !! the factorization
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      type(contribution_t), allocatable :: contributions(:)
      type(thread_state_t) :: threads
      integer :: info, status

      associate (root => self%fronts%n)
         allocate (contributions(0:root))
         allocate (self%value(self%n_factor_entries), stat=status)
         contributions(root)%is_short = status /= 0
         if (status == 0) then
            call limit_nested_threads(threads, 1)
            call self%fronts%find_rows(self%matrix)
            call fill_fronts(self%fronts, self%matrix, self%value)
            self%matrix = sparse_matrix_t()
            !$omp parallel default(none) num_threads(n_threads()) shared(self, contributions)
            !$omp single
            call eliminate_subtree(self%fronts, root, self%value, contributions)
            !$omp end single
            !$omp end parallel
            if (.not. contributions(root)%is_short .and. contributions(root)%refused == 0) then
               call cholesky_factor_tiled(self%fronts%n_pivots(root), self%value(self%fronts%block_start(root):), info)
               if (info > 0) contributions(root)%refused = self%fronts%first(root) + info - 1
            end if
            call restore_nested_threads(threads)
         end if
         if (contributions(root)%is_short) then
            ! not raised: no test may use up memory
            call new_error(error, system_failure, 'memory ran out while factorizing '//to_text(self%n)// &
               ' unknowns, whose factor alone takes '//to_text(8*self%n_factor_entries/1000000)//' MB')
         else if (contributions(root)%refused > 0) then
            call self%refuse(self%order(contributions(root)%refused), error)
         else
            call self%check_factor(error)
         end if
      end associate
   end subroutine multifrontal_complete

   !> Sets the blocks of the fronts to the entries of the matrix.
   subroutine fill_fronts(fronts, matrix, value)
      type(fronts_t), intent(in) :: fronts !! the fronts
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix on the rows of the fronts
      real(dp), contiguous, intent(out) :: value(:) !! the blocks
      integer(int64) :: at, to
      integer :: j, k

      !$omp parallel do default(none) schedule(dynamic, 256) num_threads(n_threads()) private(at, j, to) &
      !$omp shared(fronts, matrix, value)
      do k = 1, fronts%n
         value(fronts%block_start(k):fronts%block_start(k + 1) - 1) = 0.0_dp
         do j = fronts%first(k), fronts%first(k + 1) - 1
            to = fronts%block_start(k) - 1 + int(j - fronts%first(k), int64)*fronts%n_rows(k)
            do at = matrix%column_start(j), matrix%column_start(j + 1) - 1
               value(to + matrix%row(at)) = matrix%value(at)
            end do
         end do
      end do
      !$omp end parallel do
   end subroutine fill_fronts

   !> Eliminates the pivots of a front after those of its descendants; the root is only assembled.
   recursive subroutine eliminate_subtree(fronts, k, value, contributions)
      type(fronts_t), intent(in) :: fronts !! the fronts
      integer, intent(in) :: k !! number of the front
      real(dp), contiguous, intent(inout) :: value(:) !! the blocks; those of the front and its descendants are filled
      type(contribution_t), intent(inout) :: contributions(0:) !! contribution blocks of the fronts
      integer :: i

      if (.not. fronts%is_large(k)) then
         do i = fronts%first_descendant(k), k
            call eliminate_front(fronts, i, value, contributions)
         end do
         return
      end if
      associate (child => fronts%child(:, k))
         if (child(1) > 0) then
            !$omp task default(none) shared(fronts, value, contributions, k)
            call eliminate_subtree(fronts, fronts%child(1, k), value, contributions)
            !$omp end task
         end if
         if (child(2) > 0) call eliminate_subtree(fronts, child(2), value, contributions)
         !$omp taskwait
      end associate
      call eliminate_front(fronts, k, value, contributions)
   end subroutine eliminate_subtree

   !> Adds the contribution blocks of its children to a front, and eliminates its pivots; those of the root are left.
   subroutine eliminate_front(fronts, k, value, contributions)
      type(fronts_t), intent(in) :: fronts !! the fronts
      integer, intent(in) :: k !! number of the front
      real(dp), contiguous, intent(inout) :: value(:) !! the blocks
      type(contribution_t), intent(inout) :: contributions(0:) !! those of the children are taken up
      integer :: i, info, status

      associate (n_pivots => fronts%n_pivots(k), n_structure => fronts%n_structure(k), child => fronts%child(:, k), &
         first => fronts%block_start(k), past => fronts%block_start(k + 1), start => fronts%structure_start, &
         own => contributions(k))
         own%is_short = any(contributions(child)%is_short)
         own%refused = merge(contributions(child(1))%refused, contributions(child(2))%refused, &
            contributions(child(1))%refused > 0)
         if (own%is_short .or. own%refused > 0) return
         do i = 1, 2
            if (child(i) == 0) cycle
            associate (row => fronts%parent_row(start(child(i)):start(child(i) + 1) - 1))
               call add_to_pivots(row, contributions(child(i))%s, n_pivots, n_pivots + n_structure, &
                  value(first:past - 1))
            end associate
         end do
         if (k < fronts%n) then
            allocate (own%s(contribution_size(n_structure)), stat=status)
            own%is_short = status /= 0
            if (status /= 0) return
            call eliminate_pivots(n_pivots + n_structure, n_pivots, value(first:past - 1), own%s, info)
            if (info > 0) own%refused = fronts%first(k) + info - 1
         end if
         do i = 1, 2
            if (child(i) == 0) cycle
            associate (row => fronts%parent_row(start(child(i)):start(child(i) + 1) - 1))
               if (k < fronts%n) call add_to_contribution(row, contributions(child(i))%s, n_pivots, n_structure, own%s)
            end associate
            deallocate (contributions(child(i))%s)
         end do
      end associate
   end subroutine eliminate_front

   !> Performs the forward substitution of the first columns.
   subroutine multifrontal_substitute_forward(self, n_steps, y)
      class(multifrontal_t), intent(in) :: self !! the factorization
      integer, intent(in) :: n_steps !! number of columns, at least those of the interior
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)

      call substitute(self, .true., n_steps, 1, y)
   end subroutine multifrontal_substitute_forward

   !> Performs the backward substitution of the first columns, with one pass over the factor.
   subroutine multifrontal_substitute_backward(self, n_steps, y)
      class(multifrontal_t), intent(in) :: self !! the factorization
      integer, intent(in) :: n_steps !! number of columns, at least those of the interior
      real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)

      call substitute(self, .false., n_steps, size(y, 2), y)
   end subroutine multifrontal_substitute_backward

   !> Performs the forward or backward substitution of the first columns, large subtrees as tasks for other threads.
   subroutine substitute(self, is_forward, n_steps, n_vectors, y)
      type(multifrontal_t), intent(in) :: self !! the factorization
      logical, intent(in) :: is_forward !! whether the steps are those with L, of one vector; else with its transpose
      integer, intent(in) :: n_steps !! number of columns, at least those of the interior
      integer, intent(in) :: n_vectors !! number of vectors
      real(dp), intent(inout) :: y(self%n, n_vectors) !! the vectors by position
      real(dp) :: none(n_vectors, 0)
      type(thread_state_t) :: threads

      ! The root has no row structure.
      call limit_nested_threads(threads, 1)
      !$omp parallel default(none) num_threads(n_threads()) if (self%n_factor_entries*n_vectors >= worth_threads) &
      !$omp shared(self, is_forward, n_steps, y, none)
      !$omp single
      if (is_forward) then
         call forward_subtree(self%fronts, self%value, self%fronts%n, n_steps, y(:, 1), none(1, :))
      else
         call backward_subtree(self%fronts, self%value, self%fronts%n, n_steps, y, none)
      end if
      !$omp end single
      !$omp end parallel
      call restore_nested_threads(threads)
   end subroutine substitute

   !> Copies the last block of the root's factor.
   subroutine multifrontal_schur_factor(self, l22)
      class(multifrontal_t), intent(in) :: self !! the factorization
      real(dp), contiguous, intent(out) :: l22(:, :)
         !! lower triangular, zeros above, in the order `schur_order` (n_schur, n_schur)
      integer(int64) :: at
      integer :: j

      associate (root => self%fronts%n, n => self%fronts%n_pivots(self%fronts%n))
         do j = 1, self%n_schur
            l22(:j - 1, j) = 0.0_dp
            at = self%fronts%block_start(root) + (n - self%n_schur + j - 1)*(n + 1_int64)
            l22(j:, j) = self%value(at:at + self%n_schur - j)
         end do
      end associate
   end subroutine multifrontal_schur_factor

end module amontons_multifrontal
