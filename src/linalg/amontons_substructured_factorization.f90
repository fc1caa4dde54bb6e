!> Substructured Cholesky: the body cut in parts that several threads factorise at the same time.
!>
!> The unknowns are those of each part, then the interface, which couples the parts, then the trailing ones; interface
!> and trailing ones together are the top. A part p eliminates its own unknowns with its boundary b, the unknowns of the
!> top it couples to, last: its Schur complement is S_p = K_bb - K_bp K_pp^-1 K_pb. The top has the Schur complement
!> K_tt + sum over p of (S_p - K_bb), which is factorised as a dense matrix.
!>
!> The cut depends on the matrix alone and sums run in a fixed order, so results do not depend on the number of threads.
module amontons_substructured_factorization
   use amontons_dense, only: cholesky_factor_tiled
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_factorization, only: factorization_t
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dgemv, dtrsv
   use amontons_sparse_factorization, only: sparse_factorization_t
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_substructures, only: cut_t, n_parts, new_cut, part_unknowns
   use amontons_text, only: to_text
   use amontons_threads, only: hold_threads, n_threads, release_threads, thread_state_t
   implicit none (type, external)
   private

   public :: substructured_factorization_t

   !> A part of the body. Its own unknowns have consecutive positions.
   type :: part_t
      type(sparse_factorization_t), allocatable :: factorization !! its factor, with the boundary trailing
      integer :: first = 1 !! position of its first unknown
      integer :: n_own = 0 !! number of unknowns of its own
      integer, allocatable :: boundary(:) !! place in the top of each boundary unknown, ascending
      real(dp), allocatable :: schur(:, :) !! Schur complement on the boundary, while the top is made
      type(error_t), allocatable :: error !! what went wrong in its thread
   end type part_t

   !> A vector of one part.
   type :: part_vector_t
      real(dp), allocatable :: y(:) !! by position in the part's factorisation
   end type part_vector_t

   !> The parts, and the factor of the top.
   type, extends(factorization_t) :: substructured_factorization_t
      private
      type(part_t), allocatable :: parts(:) !! The parts.
      integer :: n_top = 0 !! Number of unknowns of the top.
      type(sparse_matrix_t) :: top_matrix !! K_tt minus each K_bb, from `analyze` to `complete`.
      real(dp), allocatable :: top(:, :) !! The factor of the top, in the lower triangle (n_top, n_top).
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

   !> Cuts the matrix and analyses the parts.
   subroutine substructured_analyze(self, matrix, n_trailing, error)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_trailing !! how many unknowns, the last ones, are eliminated last
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(thread_state_t) :: threads
      type(cut_t) :: cut
      integer :: p

      call new_cut(cut, matrix, n_trailing)
      self%n_top = size(cut%top)
      if (allocated(self%top)) deallocate (self%top)
      if (allocated(self%parts)) deallocate (self%parts)
      allocate (self%parts(n_parts))

      call hold_threads(threads, 1)
      !$omp parallel do default(none) schedule(static, 1) num_threads(min(n_parts, n_threads())) &
      !$omp shared(self, matrix, cut)
      do p = 1, n_parts
         call analyze_part(self%parts(p), p, matrix, cut)
      end do
      !$omp end parallel do
      call release_threads(threads)
      do p = 1, n_parts
         if (.not. allocated(self%parts(p)%error)) cycle
         error = self%parts(p)%error
         return
      end do
      call order_parts(self, matrix, n_trailing, cut)
      call prepare_top(self, matrix, cut%top)
   end subroutine substructured_analyze

   !> Analyses a part.
   subroutine analyze_part(part, p, matrix, cut)
      type(part_t), intent(inout) :: part !! the part
      integer, intent(in) :: p !! its number
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      type(cut_t), intent(in) :: cut !! the cut
      type(sparse_matrix_t) :: own_matrix
      integer, allocatable :: own(:)

      call part_unknowns(cut, p, own, part%boundary)
      part%n_own = size(own)
      call matrix%extract([own, cut%top(part%boundary)], own_matrix, part%error)
      if (allocated(part%error)) return
      allocate (part%factorization)
      call part%factorization%analyze(own_matrix, size(part%boundary), part%error)
   end subroutine analyze_part

   !> Sets the order of elimination, which is that of the parts, and adds up what they need.
   subroutine order_parts(self, matrix, n_trailing, cut)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation, its parts analysed
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: n_trailing !! number of trailing unknowns
      type(cut_t), intent(in) :: cut !! the cut
      integer, allocatable :: order(:), own(:)
      integer(int64) :: n_work_entries
      integer :: p, k, first

      allocate (order(matrix%n))
      first = 1
      n_work_entries = 0
      do p = 1, n_parts
         associate (part => self%parts(p))
            own = pack([(k, k=1, matrix%n)], cut%part_of == p)
            part%first = first
            order(first:first + part%n_own - 1) = own(part%factorization%order(:part%n_own))
            first = first + part%n_own
            n_work_entries = n_work_entries + max(part%factorization%n_work_entries, &
               size(part%boundary, kind=int64)**2)
         end associate
      end do
      order(first:) = cut%top
      call self%set_order(matrix, n_trailing, order)
      self%n_work_entries = n_work_entries
      self%n_flops = sum([(self%parts(p)%factorization%n_flops, p=1, n_parts)]) + real(self%n_top, dp)**3/3.0_dp
   end subroutine order_parts

   !> Makes K_tt without the entries that the parts bring along, once for each part that does.
   subroutine prepare_top(self, matrix, top)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation, its parts analysed
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix K
      integer, intent(in) :: top(:) !! the unknowns of the top
      type(error_t), allocatable :: error
      logical, allocatable :: has(:)
      real(dp), allocatable :: factor(:)
      integer(int64) :: at
      integer :: p, j

      call matrix%extract(top, self%top_matrix, error)
      allocate (factor(size(self%top_matrix%row, kind=int64)), source=1.0_dp)
      allocate (has(self%n_top))
      do p = 1, n_parts
         has = .false.
         has(self%parts(p)%boundary) = .true.
         do j = 1, self%n_top
            if (.not. has(j)) cycle
            do at = self%top_matrix%column_start(j), self%top_matrix%column_start(j + 1) - 1
               if (has(self%top_matrix%row(at))) factor(at) = factor(at) - 1.0_dp
            end do
         end do
      end do
      self%top_matrix%value = factor*self%top_matrix%value
   end subroutine prepare_top

   !> Computes the factors of the parts and that of the top.
   subroutine substructured_complete(self, error)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      type(thread_state_t) :: threads
      integer :: p, info

      call hold_threads(threads, 1)
      !$omp parallel do default(none) schedule(static, 1) num_threads(min(n_parts, n_threads())) shared(self)
      do p = 1, n_parts
         call complete_part(self%parts(p))
      end do
      !$omp end parallel do
      info = 0
      call check_parts(self, error)
      if (.not. allocated(error)) call sum_top(self, error)
      if (.not. allocated(error)) call cholesky_factor_tiled(self%top, info)
      call release_threads(threads)
      if (allocated(error)) return
      if (info > 0) then
         call self%refuse(self%n - self%n_top + info, error)
      else
         call check_top(self, error)
      end if
   end subroutine substructured_complete

   !> Computes the factor and the Schur complement of a part.
   subroutine complete_part(part)
      type(part_t), intent(inout) :: part !! the part, analysed
      integer :: status

      call part%factorization%complete(part%error)
      if (allocated(part%error)) return
      allocate (part%schur(size(part%boundary), size(part%boundary)), stat=status)
      if (status /= 0) then
         call new_error(part%error, system_failure, 'memory ran out for the Schur complement of '// &
            to_text(size(part%boundary))//' unknowns') ! not raised: no test may use up memory
         return
      end if
      call part%factorization%schur_complement(part%schur)
   end subroutine complete_part

   !> Hands on the error of the first part that has one, a refused pivot by its number in the whole matrix.
   subroutine check_parts(self, error)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation, its parts completed
      type(error_t), allocatable, intent(out) :: error !! a part is not positive definite, or memory ran out
      integer :: p, unknown

      do p = 1, n_parts
         if (.not. allocated(self%parts(p)%error)) cycle
         associate (part => self%parts(p))
            unknown = part%factorization%refused_unknown
            if (unknown > part%n_own) then
               call self%refuse(self%n - self%n_top + part%boundary(unknown - part%n_own), error)
            else if (unknown > 0) then
               call self%refuse(part%first - 1 + findloc(part%factorization%order, unknown, dim=1), error)
            else
               error = part%error
            end if
         end associate
         return
      end do
   end subroutine check_parts

   !> Adds up the Schur complement of the top, part after part.
   subroutine sum_top(self, error)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation, its parts completed
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer(int64) :: at
      integer :: p, i, j, status

      allocate (self%top(self%n_top, self%n_top), stat=status)
      if (status /= 0) then
         call new_error(error, system_failure, 'memory ran out for the interface of '//to_text(self%n_top)// &
            ' unknowns') ! not raised: no test may use up memory
         return
      end if
      self%top = 0.0_dp
      do j = 1, self%n_top
         do at = self%top_matrix%column_start(j), self%top_matrix%column_start(j + 1) - 1
            self%top(self%top_matrix%row(at), j) = self%top_matrix%value(at)
         end do
      end do
      self%top_matrix = sparse_matrix_t()
      do p = 1, n_parts
         associate (boundary => self%parts(p)%boundary, schur => self%parts(p)%schur)
            do j = 1, size(boundary)
               do i = j, size(boundary)
                  self%top(boundary(i), boundary(j)) = self%top(boundary(i), boundary(j)) + schur(i, j)
               end do
            end do
         end associate
         deallocate (self%parts(p)%schur)
      end do
   end subroutine sum_top

   !> Refuses pivots of the top that have shrunk to rounding errors. Those of the parts have passed.
   subroutine check_top(self, error)
      class(substructured_factorization_t), intent(inout) :: self !! the factorisation
      type(error_t), allocatable, intent(out) :: error !! a pivot is not larger than its rounding error
      integer :: j

      call self%check_pivots([sqrt(self%diagonal(:self%n - self%n_top)), (self%top(j, j), j=1, self%n_top)], error)
   end subroutine check_top

   !> Does the forward steps of the first columns.
   subroutine substructured_substitute_forward(self, n_steps, y)
      class(substructured_factorization_t), intent(in) :: self !! the factorisation
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      type(part_vector_t) :: local(n_parts)
      type(thread_state_t) :: threads
      integer :: p, n_interior, m

      n_interior = self%n - self%n_top
      call hold_threads(threads, 1)
      !$omp parallel do default(none) schedule(static, 1) num_threads(min(n_parts, n_threads())) &
      !$omp shared(self, n_steps, y, local)
      do p = 1, n_parts
         call forward_part(self%parts(p), n_steps, y, local(p)%y)
      end do
      !$omp end parallel do
      call release_threads(threads)
      do p = 1, n_parts
         associate (part => self%parts(p))
            associate (place => n_interior + part%boundary(part%factorization%trailing_order))
               y(place) = y(place) + local(p)%y(part%n_own + 1:)
            end associate
         end associate
      end do
      m = n_steps - n_interior
      if (m <= 0) return
      call dtrsv('L', 'N', 'N', m, self%top, self%n_top, y(n_interior + 1:), 1)
      if (m < self%n_top) call dgemv('N', self%n_top - m, m, -1.0_dp, self%top(m + 1, 1), self%n_top, &
         y(n_interior + 1:), 1, 1.0_dp, y(n_steps + 1:), 1)
   end subroutine substructured_substitute_forward

   !> Does the forward steps of a part.
   subroutine forward_part(part, n_steps, y, local)
      type(part_t), intent(in) :: part !! the part
      integer, intent(in) :: n_steps !! how many columns of the whole
      real(dp), intent(inout) :: y(:) !! the vector of the whole; the part's own unknowns are changed
      real(dp), allocatable, intent(out) :: local(:) !! the part's vector; its boundary holds what the top gains

      allocate (local(part%factorization%n))
      local(:part%n_own) = y(part%first:part%first + part%n_own - 1)
      local(part%n_own + 1:) = 0.0_dp
      call part%factorization%substitute_forward(n_part_steps(part, n_steps), local)
      y(part%first:part%first + part%n_own - 1) = local(:part%n_own)
   end subroutine forward_part

   !> Does the backward steps of the first columns.
   subroutine substructured_substitute_backward(self, n_steps, y)
      class(substructured_factorization_t), intent(in) :: self !! the factorisation
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position (n)
      type(thread_state_t) :: threads
      integer :: p, n_interior, m

      n_interior = self%n - self%n_top
      m = n_steps - n_interior
      if (m > 0) then
         if (m < self%n_top) call dgemv('T', self%n_top - m, m, -1.0_dp, self%top(m + 1, 1), self%n_top, &
            y(n_steps + 1:), 1, 1.0_dp, y(n_interior + 1:), 1)
         call dtrsv('L', 'T', 'N', m, self%top, self%n_top, y(n_interior + 1:), 1)
      end if
      call hold_threads(threads, 1)
      !$omp parallel do default(none) schedule(static, 1) num_threads(min(n_parts, n_threads())) &
      !$omp shared(self, n_steps, y, n_interior)
      do p = 1, n_parts
         call backward_part(self%parts(p), n_steps, n_interior, y)
      end do
      !$omp end parallel do
      call release_threads(threads)
   end subroutine substructured_substitute_backward

   !> Does the backward steps of a part.
   subroutine backward_part(part, n_steps, n_interior, y)
      type(part_t), intent(in) :: part !! the part
      integer, intent(in) :: n_steps !! how many columns of the whole
      integer, intent(in) :: n_interior !! how many unknowns come before the top
      real(dp), intent(inout) :: y(:) !! the vector of the whole; the part's own unknowns are changed
      real(dp), allocatable :: local(:)

      allocate (local(part%factorization%n))
      local(:part%n_own) = y(part%first:part%first + part%n_own - 1)
      local(part%n_own + 1:) = y(n_interior + part%boundary(part%factorization%trailing_order))
      call part%factorization%substitute_backward(n_part_steps(part, n_steps), local)
      y(part%first:part%first + part%n_own - 1) = local(:part%n_own)
   end subroutine backward_part

   !> How many of the first columns of L are a part's own.
   pure integer function n_part_steps(part, n_steps)
      type(part_t), intent(in) :: part !! the part
      integer, intent(in) :: n_steps !! how many columns

      n_part_steps = max(0, min(part%n_own, n_steps - part%first + 1))
   end function n_part_steps

   !> Copies the last block of the top's factor.
   subroutine substructured_trailing_factor(self, l22)
      class(substructured_factorization_t), intent(in) :: self !! the factorisation
      real(dp), contiguous, intent(out) :: l22(:, :)
         !! lower triangular, zeros above, by trailing position (n_trailing, n_trailing)
      integer :: j, n_interface

      n_interface = self%n_top - self%n_trailing
      do j = 1, self%n_trailing
         l22(:j - 1, j) = 0.0_dp
         l22(j:, j) = self%top(n_interface + j:, n_interface + j)
      end do
   end subroutine substructured_trailing_factor

   !> The number of stored entries of the parts and of the top.
   pure function substructured_n_factor_entries(self) result(n_entries)
      class(substructured_factorization_t), intent(in) :: self !! the factorisation
      integer(int64) :: n_entries
      integer :: p

      n_entries = int(self%n_top, int64)**2
      do p = 1, n_parts
         n_entries = n_entries + self%parts(p)%factorization%n_factor_entries()
      end do
   end function substructured_n_factor_entries

   !> The word `substructured`.
   pure function substructured_name() result(name)
      character(:), allocatable :: name

      name = 'substructured'
   end function substructured_name

end module amontons_substructured_factorization
