!> Substructured Cholesky: condensation from the pieces of a dissection upwards, on several threads.
!>
!> The rows of a substructure are its own unknowns p and its boundary b. Its matrix is the part of K that p brings,
!> plus what its two parts have left on their boundaries; eliminating p leaves S = F_bb - F_bp F_pp^-1 F_pb on its own
!> boundary. This is the multifrontal method (Duff and Reid, ACM Trans. Math. Softw. 9, 1983); its fronts are our
!> substructures. The last substructure, the top, has the trailing unknowns among its own and no boundary.
!>
!> Sums run in the order of the substructures, so results do not depend on the number of threads.
module amontons_substructured_factorization
   use amontons_dense, only: cholesky_factor_tiled
   use amontons_dissection, only: dissection_t, new_dissection
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_factorization, only: factorization_t
   use amontons_frontal_matrix, only: add_to_boundary, add_to_own, eliminate_own, fill_own, n_remaining
   use amontons_graph, only: graph_t, new_graph
   use amontons_kinds, only: dp, int64
   use amontons_ordering, only: graph_places
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_substructure_steps, only: go_backward, go_forward
   use amontons_substructures, only: new_substructures, substructures_t
   use amontons_text, only: to_text
   use amontons_threads, only: hold_threads, n_threads, release_threads, thread_state_t
   implicit none (type, external)
   private

   public :: substructured_factorization_t

   !> What a substructure leaves on its boundary until the next larger one takes it up.
   type :: remainder_t
      real(dp), allocatable :: s(:) !! as `amontons_frontal_matrix` has it (n_remaining(n_boundary))
      integer :: refused = 0 !! position of the first pivot that was not positive, here or in the parts; 0 for none
      logical :: is_short = .false. !! whether memory ran out, here or in the parts
   end type remainder_t

   !> The columns of L in the blocks of the substructures.
   type, extends(factorization_t) :: substructured_factorization_t
      private
      type(substructures_t) :: substructures !! The substructures.
      type(sparse_matrix_t) :: matrix !! P K P^T with the rows of the substructures, from `analyze` to `complete`.
      real(dp), allocatable :: value(:) !! The blocks: the columns of each substructure on its rows (n_rows, n_own).
   contains
      procedure, public :: analyze => substructured_analyze
      procedure, public :: complete => substructured_complete
      procedure, public :: substitute_forward => substructured_substitute_forward
      procedure, public :: substitute_backward => substructured_substitute_backward
      procedure, public :: trailing_factor => substructured_trailing_factor
      procedure, public :: n_factor_entries => substructured_n_factor_entries
      procedure, public, nopass :: name => substructured_name
   end type substructured_factorization_t

contains

   !> Dissects the matrix and finds the substructures.
   subroutine substructured_analyze(self, matrix, n_trailing, error)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_trailing !! how many unknowns, the last ones, are eliminated last
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(graph_t) :: graph
      type(dissection_t) :: dissection
      integer, allocatable :: order(:)

      if (allocated(self%value)) deallocate (self%value)
      call new_graph(graph, matrix, n_trailing)
      if (allocated(matrix%place)) then
         call new_dissection(dissection, graph, matrix%place(:, graph%first_unknown(:graph%n - graph%n_trailing)))
      else
         call new_dissection(dissection, graph, graph_places(graph))
      end if
      allocate (order(matrix%n))
      call graph%expand(dissection%order, order)
      call self%set_order(matrix, n_trailing, order)
      call matrix%permute(order, self%matrix, error)
      if (allocated(error)) return
      call new_substructures(self%substructures, graph, dissection, self%matrix)
      call count_work(self)
   end subroutine substructured_analyze

   !> Adds up the operations, and the numbers that are held for a while: what waits on boundaries to be taken up when
   !> the two parts of the top are worked on at the same time. More threads need little more, since parts shrink as
   !> their number grows.
   subroutine count_work(self)
      type(substructured_factorization_t), intent(inout) :: self !! the factorisation, its substructures known
      integer(int64) :: most(0:self%substructures%n), left(0:self%substructures%n)
      integer :: k, part(2)
      real(dp) :: n_own, n_boundary

      most(0) = 0
      left(0) = 0
      self%n_flops = 0.0_dp
      do k = 1, self%substructures%n
         part = self%substructures%part(:, k)
         n_own = self%substructures%n_own(k)
         n_boundary = self%substructures%n_boundary(k)
         left(k) = n_remaining(self%substructures%n_boundary(k))
         most(k) = max(most(part(1)), left(part(1)) + most(part(2)), left(k) + sum(left(part)))
         self%n_flops = self%n_flops + n_own**3/3.0_dp + n_own**2*n_boundary + n_own*n_boundary**2
      end do
      self%n_work_entries = sum(most(part))
   end subroutine count_work

   !> Computes the blocks of the substructures.
   subroutine substructured_complete(self, error)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      type(remainder_t), allocatable :: remainders(:)
      type(thread_state_t) :: threads
      integer :: status

      associate (top => self%substructures%n)
         allocate (self%value(self%n_factor_entries()), remainders(0:top), stat=status)
         if (status /= 0) then
            call report_shortage(self, error)
            return
         end if
         call hold_threads(threads, 1)
         call fill(self%substructures, self%matrix, self%value)
         self%matrix = sparse_matrix_t()
         !$omp parallel default(none) num_threads(n_threads()) shared(self, remainders)
         !$omp single
         call condense(self%substructures, top, self%value, remainders)
         !$omp end single
         !$omp end parallel
         if (.not. remainders(top)%is_short .and. remainders(top)%refused == 0) then
            call factorize_top(self, remainders(top)%refused)
         end if
         call release_threads(threads)
         if (remainders(top)%is_short) then
            call report_shortage(self, error)
         else if (remainders(top)%refused > 0) then
            call self%refuse(remainders(top)%refused, error)
         else
            call self%check_pivots(pivots(self), error)
         end if
      end associate
   end subroutine substructured_complete

   !> Reports that memory ran out.
   pure subroutine report_shortage(self, error)
      type(substructured_factorization_t), intent(in) :: self !! the factorisation
      type(error_t), allocatable, intent(out) :: error !! the report

      call new_error(error, system_failure, 'memory ran out while factorising '//to_text(self%n)// &
         ' unknowns, whose factor alone takes '//to_text(8*self%n_factor_entries()/1000000)// &
         ' MB') ! not raised: no test may use up memory
   end subroutine report_shortage

   !> Fills the blocks with the columns of the matrix.
   subroutine fill(substructures, matrix, value)
      type(substructures_t), intent(in) :: substructures !! the substructures
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      real(dp), contiguous, intent(out) :: value(:) !! the blocks
      integer :: k

      !$omp parallel do default(none) schedule(dynamic, 256) num_threads(n_threads()) &
      !$omp shared(substructures, matrix, value)
      do k = 1, substructures%n
         call fill_own(matrix, substructures%first(k), substructures%n_rows(k), substructures%n_own(k), &
            value(substructures%block_start(k):substructures%block_start(k + 1) - 1))
      end do
      !$omp end parallel do
   end subroutine fill

   !> Condenses a substructure, its parts first; the top is only put together.
   recursive subroutine condense(substructures, k, value, remainders)
      type(substructures_t), intent(in) :: substructures !! the substructures
      integer, intent(in) :: k !! number of the substructure
      real(dp), intent(inout) :: value(:) !! the blocks; those of the substructure and its parts are filled
      type(remainder_t), intent(inout) :: remainders(0:) !! what the substructures leave
      integer :: i

      if (.not. substructures%is_large(k)) then
         do i = substructures%first_below(k), k
            call eliminate(substructures, i, value, remainders)
         end do
         return
      end if
      associate (part => substructures%part(:, k))
         if (part(1) > 0) then
            !$omp task default(none) shared(substructures, value, remainders, k)
            call condense(substructures, substructures%part(1, k), value, remainders)
            !$omp end task
         end if
         if (part(2) > 0) call condense(substructures, part(2), value, remainders)
         !$omp taskwait
      end associate
      call eliminate(substructures, k, value, remainders)
   end subroutine condense

   !> Adds to the matrix of a substructure what its parts have left, and eliminates its own unknowns, but not those of
   !> the top.
   subroutine eliminate(substructures, k, value, remainders)
      type(substructures_t), intent(in) :: substructures !! the substructures
      integer, intent(in) :: k !! number of the substructure
      real(dp), intent(inout) :: value(:) !! the blocks
      type(remainder_t), intent(inout) :: remainders(0:) !! takes up those of the parts, gains that of the substructure
      integer :: i, info, status

      associate (n_own => substructures%n_own(k), n_boundary => substructures%n_boundary(k), &
         first => substructures%block_start(k), past => substructures%block_start(k + 1), &
         part => substructures%part(:, k), start => substructures%boundary_start)
         remainders(k)%is_short = any(remainders(part)%is_short)
         remainders(k)%refused = merge(remainders(part(1))%refused, remainders(part(2))%refused, &
            remainders(part(1))%refused > 0)
         if (remainders(k)%is_short .or. remainders(k)%refused > 0) return
         do i = 1, 2
            if (part(i) == 0) cycle
            associate (place => substructures%place(start(part(i)):start(part(i) + 1) - 1))
               call add_to_own(place, remainders(part(i))%s, n_own, n_own + n_boundary, value(first:past - 1))
            end associate
         end do
         if (k < substructures%n) then
            allocate (remainders(k)%s(n_remaining(n_boundary)), stat=status)
            remainders(k)%is_short = status /= 0
            if (status /= 0) return
            call eliminate_own(n_own + n_boundary, n_own, value(first:past - 1), remainders(k)%s, info)
            if (info > 0) remainders(k)%refused = substructures%first(k) + info - 1
         end if
         do i = 1, 2
            if (part(i) == 0) cycle
            associate (place => substructures%place(start(part(i)):start(part(i) + 1) - 1))
               if (k < substructures%n) call add_to_boundary(place, remainders(part(i))%s, n_own, n_boundary, &
                  remainders(k)%s)
            end associate
            deallocate (remainders(part(i))%s)
         end do
      end associate
   end subroutine eliminate

   !> Factorises the top, on all threads.
   subroutine factorize_top(self, refused)
      type(substructured_factorization_t), intent(inout) :: self !! the factorisation, the top put together
      integer, intent(out) :: refused !! position of the first pivot that is not positive; 0 for none

      associate (top => self%substructures%n, s => self%substructures)
         call factorize_matrix(s%n_own(top), self%value(s%block_start(top):), refused)
         if (refused > 0) refused = s%first(top) - 1 + refused
      end associate
   end subroutine factorize_top

   !> Factorises numbers as a matrix, column after column.
   subroutine factorize_matrix(n, matrix, refused)
      integer, intent(in) :: n !! order of the matrix
      real(dp), intent(inout) :: matrix(n, n) !! the matrix, its factor on return
      integer, intent(out) :: refused !! number of the first pivot that is not positive; 0 for none

      call cholesky_factor_tiled(matrix, refused)
   end subroutine factorize_matrix

   !> The diagonal of L.
   pure function pivots(self)
      type(substructured_factorization_t), intent(in) :: self !! the factorisation
      real(dp) :: pivots(self%n)
      integer(int64) :: at
      integer :: j, k

      do k = 1, self%substructures%n
         at = self%substructures%block_start(k)
         do j = self%substructures%first(k), self%substructures%first(k + 1) - 1
            pivots(j) = self%value(at)
            at = at + self%substructures%n_rows(k) + 1
         end do
      end do
   end function pivots

   !> Does the forward steps of the first columns.
   subroutine substructured_substitute_forward(self, n_steps, y)
      class(substructured_factorization_t), intent(in) :: self !! the factorisation
      integer, intent(in) :: n_steps !! how many columns, at least those before the trailing ones
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      real(dp) :: boundary(0)
      type(thread_state_t) :: threads

      ! The top has no boundary.
      call hold_threads(threads, 1)
      !$omp parallel default(none) num_threads(n_threads()) shared(self, n_steps, y, boundary)
      !$omp single
      call go_forward(self%substructures, self%value, self%substructures%n, n_steps, y, boundary)
      !$omp end single
      !$omp end parallel
      call release_threads(threads)
   end subroutine substructured_substitute_forward

   !> Does the backward steps of the first columns.
   subroutine substructured_substitute_backward(self, n_steps, y)
      class(substructured_factorization_t), intent(in) :: self !! the factorisation
      integer, intent(in) :: n_steps !! how many columns, at least those before the trailing ones
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      real(dp) :: boundary(0)
      type(thread_state_t) :: threads

      ! The top has no boundary.
      call hold_threads(threads, 1)
      !$omp parallel default(none) num_threads(n_threads()) shared(self, n_steps, y, boundary)
      !$omp single
      call go_backward(self%substructures, self%value, self%substructures%n, n_steps, y, boundary)
      !$omp end single
      !$omp end parallel
      call release_threads(threads)
   end subroutine substructured_substitute_backward

   !> Copies the last block of the top's factor.
   subroutine substructured_trailing_factor(self, l22)
      class(substructured_factorization_t), intent(in) :: self !! the factorisation
      real(dp), contiguous, intent(out) :: l22(:, :)
         !! lower triangular, zeros above, by trailing position (n_trailing, n_trailing)
      integer(int64) :: at
      integer :: j

      associate (n_top => self%substructures%n_own(self%substructures%n))
         do j = 1, self%n_trailing
            l22(:j - 1, j) = 0.0_dp
            at = self%substructures%block_start(self%substructures%n) &
               + (n_top - self%n_trailing + j - 1)*(n_top + 1_int64)
            l22(j:, j) = self%value(at:at + self%n_trailing - j)
         end do
      end associate
   end subroutine substructured_trailing_factor

   !> The number of stored entries, the unused ones above the diagonal included.
   pure function substructured_n_factor_entries(self) result(n_entries)
      class(substructured_factorization_t), intent(in) :: self !! the factorisation
      integer(int64) :: n_entries

      n_entries = self%substructures%block_start(self%substructures%n + 1) - 1
   end function substructured_n_factor_entries

   !> The word `substructured`.
   pure function substructured_name() result(name)
      character(:), allocatable :: name

      name = 'substructured'
   end function substructured_name

end module amontons_substructured_factorization
