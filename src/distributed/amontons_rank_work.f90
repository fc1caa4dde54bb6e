!> What each rank does for the body at hand: assembly of its subdomain, its part of the factorization.
!>
!> Every procedure here is called on all ranks at the same time: rank 0 has given the order for it. Rank 0's arguments
!> are those of the body; on the others they are of no use.
module amontons_rank_work
   use amontons_assembly, only: assemble_stiffness
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_mumps, only: mumps_t
   use amontons_ranks, only: agree, gather_columns, rank, sum_on_machine
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_subdomain, only: subdomain_t
   use amontons_system, only: available_memory_mb, return_memory
   use amontons_text, only: to_text
   use amontons_threads, only: n_threads, use_blas_threads
   implicit none (type, external)
   private

   public :: check_room, rank_work_t

   !> What a rank has of the body at hand.
   type :: rank_work_t
      type(subdomain_t), allocatable :: subdomain !! its elements, until they are assembled
      type(sparse_matrix_t) :: stiffness !! their stiffness, until it is analyzed [F/L]
      integer, allocatable :: unknown(:) !! the unknown of the body that each of its rows is
      integer, allocatable :: row(:) !! row in the body's matrix of each entry, until it is factorized
      integer, allocatable :: column(:) !! column of each entry
      real(dp), allocatable :: value(:) !! value of each entry [F/L]
      type(mumps_t) :: mumps !! the factorization
   contains
      procedure :: assemble => rank_work_assemble
      procedure :: analyze => rank_work_analyze
      procedure :: check_memory => rank_work_check_memory
      procedure :: factorize => rank_work_factorize
   end type rank_work_t

contains

   !> Assembles the stiffness of the subdomain, and on rank 0 the sums that tell of the whole matrix: its diagonal, and
   !> the magnitudes of each column; where subdomains meet, those of their parts.
   subroutine rank_work_assemble(self, sums, error)
      class(rank_work_t), intent(inout) :: self !! the work; its subdomain not prepared yet
      real(dp), intent(inout) :: sums(:, :) !! diagonal entry and sum of magnitudes of each column (2, n) [F/L]
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp), allocatable :: own(:, :)
      integer(int64) :: at
      integer :: j

      call self%subdomain%prepare()
      associate (domain => self%subdomain)
         call assemble_stiffness(self%stiffness, domain%mesh, domain%materials, domain%springs, domain%coloring, &
            domain%constraints, domain%dof_map, error)
      end associate
      call agree(error)
      if (allocated(error)) return
      associate (matrix => self%stiffness)
         if (allocated(matrix%place)) deallocate (matrix%place)
         allocate (own(2, matrix%n), source=0.0_dp)
         do j = 1, matrix%n
            own(1, j) = matrix%value(matrix%column_start(j))
            own(2, j) = own(2, j) + abs(own(1, j))
            do at = matrix%column_start(j) + 1, matrix%column_start(j + 1) - 1
               own(2, [j, matrix%row(at)]) = own(2, [j, matrix%row(at)]) + abs(matrix%value(at))
            end do
         end do
      end associate
      call move_alloc(self%subdomain%unknown, self%unknown)
      deallocate (self%subdomain)
      call gather_columns(own, self%unknown, sums)
   end subroutine rank_work_assemble

   !> Has MUMPS analyze the matrix, rank 0's share of which has the Schur variables on its diagonal shifted.
   subroutine rank_work_analyze(self, n_schur, shift, position, error)
      class(rank_work_t), intent(inout) :: self !! the work, its subdomain assembled
      integer, intent(in) :: n_schur !! number of Schur variables
      real(dp), intent(in) :: shift !! what is added to their diagonal entries [F/L]
      integer, intent(inout) :: position(:) !! position of each unknown (n)
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer(int64) :: at
      integer :: j, n

      n = size(position)
      associate (matrix => self%stiffness, unknown => self%unknown)
         allocate (self%column(size(matrix%row, kind=int64)))
         do j = 1, matrix%n
            at = matrix%column_start(j)
            if (rank == 0 .and. unknown(j) > n - n_schur) matrix%value(at) = matrix%value(at) + shift
            do at = matrix%column_start(j), matrix%column_start(j + 1) - 1
               self%column(at) = unknown(j)
               matrix%row(at) = unknown(matrix%row(at))
            end do
         end do
         call move_alloc(matrix%row, self%row)
         call move_alloc(matrix%value, self%value)
      end associate
      self%stiffness = sparse_matrix_t()
      deallocate (self%unknown)
      call self%mumps%analyze(n, self%row, self%column, n_schur, position, error)
   end subroutine rank_work_analyze

   !> Refuses a factor that the memory of a machine cannot hold for all of its ranks.
   subroutine rank_work_check_memory(self, error)
      class(rank_work_t), intent(inout) :: self !! the work, the matrix analyzed
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice

      call check_room('the distributed factor', self%mumps%report%own_mb, error)
   end subroutine rank_work_check_memory

   !> Refuses what the memory of a machine cannot hold for all of its ranks.
   subroutine check_room(what, own_mb, error)
      character(*), intent(in) :: what !! what takes the memory
      real(dp), intent(in) :: own_mb !! how much it takes on this rank [MB]
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice
      real(dp) :: wanted

      call return_memory()
      wanted = sum_on_machine(own_mb)
      if (wanted > available_memory_mb()) call new_error(error, system_failure, 'memory does not suffice: '//what// &
         ' needs '//to_text(nint(wanted, int64))//' MB on the machine of rank '//to_text(rank)//', and '// &
         to_text(nint(available_memory_mb(), int64))//' MB are available; use more machines')
      call agree(error)
   end subroutine check_room

   !> Factorizes the matrix; the Schur complement comes to rank 0.
   subroutine rank_work_factorize(self, n_schur, schur, error)
      class(rank_work_t), intent(inout) :: self !! the work, the matrix analyzed
      integer, intent(in) :: n_schur !! number of Schur variables
      real(dp), allocatable, intent(out) :: schur(:, :) !! the Schur complement (n_schur, n_schur) [F/L]
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out
      integer :: status

      allocate (schur(n_schur, n_schur), stat=status)
      ! not raised: no test may use up the machine's memory
      if (status /= 0) call new_error(error, system_failure, 'memory ran out for the condensed stiffness of '// &
         to_text(n_schur)//' rows')
      call agree(error)
      if (allocated(error)) return
      call use_blas_threads(n_threads())
      call self%mumps%factorize(self%value, schur, error)
      call use_blas_threads(1)
      deallocate (self%row, self%column, self%value)
      call return_memory()
   end subroutine rank_work_factorize

end module amontons_rank_work
