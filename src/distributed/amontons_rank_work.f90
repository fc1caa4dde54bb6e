!> What each rank does for the body at hand: assembly of its subdomain, its part of the factorization, nodal forces.
!>
!> Every procedure here is called on all ranks at the same time: rank 0 has given the order for it. Rank 0's arguments
!> are those of the body; on the others they are of no use.
module amontons_rank_work
   use amontons_assembly, only: assemble_stiffness, internal_forces
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_mumps, only: mumps_t
   use amontons_ranks, only: agree, gather_columns, line_t, n_ranks, rank, scatter_columns, sum_on_machine
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_subdomain, only: subdomain_t
   use amontons_system, only: available_memory_mb, return_memory
   use amontons_text, only: to_text
   use amontons_threads, only: n_threads, use_blas_threads
   implicit none (type, external)
   private

   public :: rank_work_t

   !> What a rank has of the body at hand.
   type :: rank_work_t
      type(subdomain_t) :: subdomain !! its elements
      type(sparse_matrix_t) :: stiffness !! their stiffness, until it is analyzed [F/L]
      integer, allocatable :: row(:) !! row in the body's matrix of each entry, until it is factorized
      integer, allocatable :: column(:) !! column of each entry
      real(dp), allocatable :: value(:) !! value of each entry [F/L]
      type(mumps_t) :: mumps !! the factorization
   contains
      procedure :: assemble => rank_work_assemble
      procedure :: analyze => rank_work_analyze
      procedure :: check_memory => rank_work_check_memory
      procedure :: factorize => rank_work_factorize
      procedure :: forces => rank_work_forces
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
      call gather_columns(own, self%subdomain%unknown, sums)
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
      associate (matrix => self%stiffness, unknown => self%subdomain%unknown)
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
      call self%subdomain%forget_unknowns()
      call self%mumps%analyze(n, self%row, self%column, n_schur, position, error)
   end subroutine rank_work_analyze

   !> Refuses a factor that the memory of a machine cannot hold for all of its ranks.
   subroutine rank_work_check_memory(self, error)
      class(rank_work_t), intent(inout) :: self !! the work, the matrix analyzed
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice
      real(dp) :: wanted

      call return_memory()
      wanted = sum_on_machine(self%mumps%report%own_mb)
      if (wanted > available_memory_mb()) call new_error(error, system_failure, 'memory does not suffice: the '// &
         'distributed factor needs '//to_text(nint(wanted, int64))//' MB on the machine of rank '//to_text(rank)// &
         ', and '//to_text(nint(available_memory_mb(), int64))//' MB are available; use more machines')
      call agree(error)
   end subroutine rank_work_check_memory

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

   !> Adds up the nodal forces that the stresses of all subdomains amount to.
   subroutine rank_work_forces(self, forces, displacement, thermal_strain)
      class(rank_work_t), intent(inout) :: self !! the work
      real(dp), intent(inout) :: forces(:, :) !! nodal forces, zero on entry (2, n_nodes) [F]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: thermal_strain(:, :)
         !! strain of free thermal expansion in the order of the body's `mesh%node`, or none (1, any) [-]
      real(dp), allocatable :: u(:, :), heat(:, :), own(:, :)
      integer, allocatable :: item(:)
      integer :: n_heated

      n_heated = size(thermal_strain)
      call tell_all(n_heated)
      associate (domain => self%subdomain)
         call scatter_columns(u, domain%node, displacement)
         if (n_heated > 0) then
            item = domain%items()
            call scatter_columns(heat, item, thermal_strain)
            call internal_forces(own, domain%mesh, domain%materials, domain%springs, domain%coloring, u, heat(1, :))
         else
            call internal_forces(own, domain%mesh, domain%materials, domain%springs, domain%coloring, u)
         end if
         call gather_columns(own, domain%node, forces)
      end associate
   end subroutine rank_work_forces

   !> Tells all ranks a number of rank 0.
   subroutine tell_all(number)
      integer, intent(inout) :: number !! the number
      type(line_t) :: line
      integer :: i

      if (rank > 0) then
         line = line_t(0, .false.)
         call line%pass(number)
      else
         do i = 1, n_ranks - 1
            line = line_t(i, .true.)
            call line%pass(number)
         end do
      end if
   end subroutine tell_all

end module amontons_rank_work
