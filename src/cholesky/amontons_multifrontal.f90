!> Multifrontal Cholesky in the order of a nested dissection, on several threads.
!>
!> The matrix of a front is what its pivot columns p have of K, plus the contribution blocks of its children;
!> eliminating p leaves its own contribution block, F_rr - F_rp F_pp^-1 F_pr on its row structure r (Duff and Reid, ACM
!> Trans. Math. Softw. 9, 1983). This is static condensation, from the leaves of the dissection upwards. The last front,
!> the root, has the Schur variables among its pivots and no row structure.
!>
!> Sums run in the order of the fronts, so results do not depend on the number of threads.
module amontons_multifrontal
   use amontons_cholesky, only: cholesky_t
   use amontons_dense, only: cholesky_factor_tiled
   use amontons_dissection, only: dissection_t, new_dissection
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_front_substitution, only: backward_subtree, forward_subtree
   use amontons_frontal_matrix, only: add_to_contribution, add_to_pivots, contribution_size, eliminate_pivots, &
      fill_pivots
   use amontons_fronts, only: fronts_t, new_fronts
   use amontons_graph, only: graph_places, graph_t, new_graph
   use amontons_kinds, only: dp, int64
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_text, only: to_text
   use amontons_threads, only: limit_nested_threads, n_threads, restore_nested_threads, thread_state_t
   implicit none (type, external)
   private

   public :: multifrontal_t

   !> What a front leaves to its parent.
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

   !> Dissects the matrix and finds the fronts.
   subroutine multifrontal_analyze(self, matrix, n_schur, error)
      class(multifrontal_t), intent(inout) :: self !! the factorization
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_schur !! how many unknowns, the last ones, are Schur variables
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(graph_t) :: graph
      type(dissection_t) :: dissection
      integer, allocatable :: order(:)

      self%name = 'multifrontal'
      if (allocated(self%value)) deallocate (self%value)
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

   !> Adds up the operations, and the numbers that are held for a while: contribution blocks that wait for their parents
   !> when the two children of the root are worked on at the same time. More threads need little more, since subtrees
   !> shrink as their number grows.
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
      self%n_work_entries = sum(most(child))
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
         status = 0
         if (.not. allocated(self%value)) allocate (self%value(self%n_factor_entries), stat=status)
         contributions(root)%is_short = status /= 0
         if (status == 0) then
            call limit_nested_threads(threads, 1)
            call self%fronts%find_rows(self%matrix)
            call fill(self%fronts, self%matrix, self%value)
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
            call self%refuse(contributions(root)%refused, error)
         else
            call self%check_pivots(pivots(self), error)
         end if
      end associate
   end subroutine multifrontal_complete

   !> Fills the blocks with the columns of the matrix.
   subroutine fill(fronts, matrix, value)
      type(fronts_t), intent(in) :: fronts !! the fronts
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix on the rows of the fronts
      real(dp), contiguous, intent(out) :: value(:) !! the blocks
      integer :: k

      !$omp parallel do default(none) schedule(dynamic, 256) num_threads(n_threads()) shared(fronts, matrix, value)
      do k = 1, fronts%n
         call fill_pivots(matrix, fronts%first(k), fronts%n_rows(k), fronts%n_pivots(k), &
            value(fronts%block_start(k):fronts%block_start(k + 1) - 1))
      end do
      !$omp end parallel do
   end subroutine fill

   !> Eliminates the pivots of a front, those of its descendants first; the root is only put together.
   recursive subroutine eliminate_subtree(fronts, k, value, contributions)
      type(fronts_t), intent(in) :: fronts !! the fronts
      integer, intent(in) :: k !! number of the front
      real(dp), intent(inout) :: value(:) !! the blocks; those of the front and its descendants are filled
      type(contribution_t), intent(inout) :: contributions(0:) !! what the fronts leave
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

   !> Adds to the matrix of a front what its children have left, and eliminates its pivots, but not those of the root.
   subroutine eliminate_front(fronts, k, value, contributions)
      type(fronts_t), intent(in) :: fronts !! the fronts
      integer, intent(in) :: k !! number of the front
      real(dp), intent(inout) :: value(:) !! the blocks
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

   !> The diagonal of L.
   pure function pivots(self)
      type(multifrontal_t), intent(in) :: self !! the factorization
      real(dp) :: pivots(self%n)
      integer(int64) :: at
      integer :: j, k

      do k = 1, self%fronts%n
         at = self%fronts%block_start(k)
         do j = self%fronts%first(k), self%fronts%first(k + 1) - 1
            pivots(j) = self%value(at)
            at = at + self%fronts%n_rows(k) + 1
         end do
      end do
   end function pivots

   !> Does the forward steps of the first columns.
   subroutine multifrontal_substitute_forward(self, n_steps, y)
      class(multifrontal_t), intent(in) :: self !! the factorization
      integer, intent(in) :: n_steps !! how many columns, at least those of the interior
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)

      call substitute(self, .true., n_steps, 1, y)
   end subroutine multifrontal_substitute_forward

   !> Does the backward steps of the first columns, with one pass over the factor.
   subroutine multifrontal_substitute_backward(self, n_steps, y)
      class(multifrontal_t), intent(in) :: self !! the factorization
      integer, intent(in) :: n_steps !! how many columns, at least those of the interior
      real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)

      call substitute(self, .false., n_steps, size(y, 2), y)
   end subroutine multifrontal_substitute_backward

   !> Does the steps of the first columns, forward or backward, large subtrees on threads of their own.
   subroutine substitute(self, is_forward, n_steps, n_vectors, y)
      type(multifrontal_t), intent(in) :: self !! the factorization
      logical, intent(in) :: is_forward !! whether the steps are those with L, of one vector; else with its transpose
      integer, intent(in) :: n_steps !! how many columns, at least those of the interior
      integer, intent(in) :: n_vectors !! how many vectors
      real(dp), intent(inout) :: y(self%n, n_vectors) !! the vectors by position
      real(dp) :: none(n_vectors, 0)
      type(thread_state_t) :: threads

      ! The root has no row structure.
      call limit_nested_threads(threads, 1)
      !$omp parallel default(none) num_threads(n_threads()) shared(self, is_forward, n_steps, y, none)
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
