!> The condenser of a body whose elements, matrix and factor are spread over the ranks of a run.
!>
!> It lives on rank 0 and gives the orders; the other ranks follow them. Each holds the stiffness of its
!> subdomain and its part of MUMPS's factor; rank 0 has the order of elimination and the Schur complement too. There is
!> one such condenser at a time. Sums depend on the number of ranks in their last digits.
module amontons_distributed_condenser
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use amontons_condenser, only: condenser_t
   use amontons_constraints, only: constraints_t, spring_side_t
   use amontons_dof_map, only: dof_map_t
   use amontons_elimination_order, only: find_positions
   use amontons_error, only: error_t
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dpotrf, dpotrs
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_rank_work, only: check_room, rank_work_t
   use amontons_ranks, only: give_order, line_t, n_ranks
   use amontons_subdomain, only: assembly_mb, find_owners, new_subdomain, subdomain_t
   use amontons_system, only: return_memory
   implicit none (type, external)
   private

   public :: dismiss_ranks, distributed_condenser_t, first_free_order, follow_order, new_distributed_condenser, &
      order_end

   !> Orders of rank 0. Those from the last of these on are for a room above this one.
   enum, bind(c)
      enumerator :: order_end, order_take, order_analyze, order_check_memory, order_factorize, order_condense, &
         order_expand, order_free, first_free_order
   end enum

   !> What a machine may lack the memory for before it factorizes.
   character(*), parameter :: assembly = 'the assembly of the stiffness'

   !> A condenser over the ranks.
   type, extends(condenser_t) :: distributed_condenser_t
      private
      type(rank_work_t), pointer :: work => null() !! What rank 0 does itself.
      real(dp), allocatable :: s(:) !! The upper triangle of the Schur complement, column after column.
   contains
      procedure, public :: check_memory => distributed_check_memory
      procedure, public :: memory_mb => distributed_memory_mb
      procedure, public :: complete => distributed_complete
      procedure, public :: schur_complement => distributed_schur_complement
      procedure, public :: condense => distributed_condense
      procedure, public :: expand => distributed_expand
      procedure, public :: solve => distributed_solve
      final :: distributed_free
   end type distributed_condenser_t

contains

   !> Spreads a body over the ranks, assembles its stiffness and analyzes it.
   subroutine new_distributed_condenser(condenser, is_held, mesh, materials, springs, constraints, dof_map, error)
      type(distributed_condenser_t), intent(inout) :: condenser !! the condenser; nothing yet
      logical, intent(in) :: is_held !! whether supports alone hold the body
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns; the trailing ones are the Schur variables
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer, allocatable :: position(:)
      real(dp), allocatable :: sums(:, :)

      condenser%name = 'distributed'
      condenser%n = dof_map%n_dofs
      condenser%n_schur = dof_map%n_schur
      call find_positions(position, mesh, dof_map, error)
      if (allocated(error)) return
      allocate (condenser%work)
      allocate (condenser%work%subdomain)
      call spread_body(condenser%work%subdomain, position, mesh, materials, springs, constraints, dof_map, error)
      if (allocated(error)) return
      allocate (sums(2, condenser%n), source=0.0_dp)
      call condenser%work%assemble(sums, error)
      if (allocated(error)) return
      if (.not. is_held) condenser%regularization = sum(sums(1, :))/condenser%n
      associate (schur_sums => sums(2, condenser%n - condenser%n_schur + 1:))
         schur_sums = schur_sums + condenser%regularization
      end associate
      ! The largest sum would pass over one that is no number.
      condenser%matrix_norm = maxval(sums(2, :)) + 0.0_dp*sum(sums(2, :))
      deallocate (sums)
      call give_order(order_analyze)
      call condenser%work%analyze(condenser%n_schur, condenser%regularization, position, error)
      associate (report => condenser%work%mumps%report)
         condenser%n_factor_entries = report%n_entries
         condenser%n_flops = report%n_flops
      end associate
   end subroutine new_distributed_condenser

   !> Gives every rank its subdomain. Rank 0 has the springs, and the nodes of all trailing unknowns.
   subroutine spread_body(own, position, mesh, materials, springs, constraints, dof_map, error)
      type(subdomain_t), intent(out) :: own !! that of rank 0
      integer, intent(in) :: position(:) !! position of each unknown in the order of elimination
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice for assembly
      real(dp) :: megabytes(0:n_ranks - 1)
      integer, allocatable :: owner(:), all_elements(:), elements(:), last_nodes(:), number(:)
      type(line_t) :: line
      integer :: i

      call give_order(order_take)
      call find_owners(owner, n_ranks, position, mesh, dof_map)
      megabytes = assembly_mb(owner, n_ranks, mesh)
      do i = 1, n_ranks - 1
         line = line_t(i, .true.)
         call line%pass(megabytes(i))
      end do
      call check_room(assembly, megabytes(0), error)
      if (allocated(error)) return
      all_elements = [(i, i=1, mesh%n_elements)]
      last_nodes = pack([(i, i=1, mesh%n_nodes)], any(dof_map%dof > dof_map%n_dofs - dof_map%n_schur, dim=1))
      allocate (number(mesh%n_nodes), source=0)
      do i = n_ranks - 1, 0, -1
         elements = pack(all_elements, owner == i)
         if (i > 0) then
            call new_subdomain(own, elements, springs(:0), last_nodes(:0), number, mesh, dof_map)
         else
            call new_subdomain(own, elements, springs, last_nodes, number, mesh, dof_map)
         end if
         call own%take_properties(elements, materials, constraints)
         if (i > 0) call own%pass(line_t(i, .true.))
      end do
   end subroutine spread_body

   !> Follows an order that rank 0 gives for its condenser; for the other ranks.
   subroutine follow_order(work, order)
      type(rank_work_t), allocatable, intent(inout) :: work !! what this rank has of the body at hand, if there is one
      integer, intent(in) :: order !! the order, below `first_free_order` and not `order_end`
      type(error_t), allocatable :: error
      real(dp), allocatable :: none(:, :)
      real(dp) :: nothing(0)
      integer :: no_position(0)

      allocate (none(2, 0))
      select case (order)
      case (order_take)
         if (allocated(work)) deallocate (work)
         allocate (work)
         call take_subdomain(work, error)
         if (.not. allocated(error)) call work%assemble(none, error)
      case (order_analyze)
         call work%analyze(0, 0.0_dp, no_position, error)
      case (order_check_memory)
         call work%check_memory(error)
      case (order_factorize)
         call work%factorize(0, none, error)
      case (order_condense)
         call work%mumps%solve(.false., nothing, nothing)
      case (order_expand)
         call work%mumps%solve(.true., nothing, nothing)
      case default  ! order_free
         call work%mumps%free()
         deallocate (work)
      end select
   end subroutine follow_order

   !> Takes a rank's subdomain, if there is memory for it.
   subroutine take_subdomain(work, error)
      type(rank_work_t), intent(inout) :: work !! gains the subdomain
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice for assembly
      type(line_t) :: line
      real(dp) :: megabytes

      line = line_t(0, .false.)
      call line%pass(megabytes)
      call check_room(assembly, megabytes, error)
      if (allocated(error)) return
      allocate (work%subdomain)
      call work%subdomain%pass(line)
   end subroutine take_subdomain

   !> Ends the service of the other ranks.
   subroutine dismiss_ranks()
      call give_order(order_end)
   end subroutine dismiss_ranks

   !> Refuses a factor that the memory of the machines cannot hold.
   subroutine distributed_check_memory(self, error)
      class(distributed_condenser_t), intent(in) :: self !! the condenser, the matrix analyzed
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice

      call give_order(order_check_memory)
      call self%work%check_memory(error)
   end subroutine distributed_check_memory

   !> The memory that `complete` takes on the rank where it takes most [MB].
   pure real(dp) function distributed_memory_mb(self) result(memory_mb)
      class(distributed_condenser_t), intent(in) :: self !! the condenser, the matrix analyzed

      memory_mb = self%work%mumps%report%largest_mb
   end function distributed_memory_mb

   !> Factorizes the matrix.
   subroutine distributed_complete(self, error)
      class(distributed_condenser_t), intent(inout) :: self !! the condenser
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out

      real(dp), allocatable :: schur(:, :)
      integer :: j

      call give_order(order_factorize)
      call self%work%factorize(self%n_schur, schur, error)
      if (allocated(error)) return
      allocate (self%s(triangle(self%n_schur)))
      do j = 1, self%n_schur
         self%s(triangle(j - 1) + 1:triangle(j)) = schur(:j, j)
      end do
   end subroutine distributed_complete

   !> Number of entries of the triangle of a symmetric matrix.
   pure integer(int64) function triangle(n)
      integer, intent(in) :: n !! order of the matrix

      triangle = int(n, int64)*(n + 1)/2
   end function triangle

   !> The Schur complement, of which MUMPS fills the lower triangle by rows.
   subroutine distributed_schur_complement(self, s)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), contiguous, intent(out) :: s(:, :) !! S, both triangles (n_schur, n_schur)
      integer :: j

      do j = 1, self%n_schur
         s(:j, j) = self%s(triangle(j - 1) + 1:triangle(j))
         s(j, :j) = s(:j, j)
      end do
   end subroutine distributed_schur_complement

   !> Eliminates the interior from a load.
   subroutine distributed_condense(self, b, partial, q)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), intent(in) :: b(:) !! the load (n)
      real(dp), contiguous, intent(out) :: partial(:) !! what `expand` needs of the load: the load (n)
      real(dp), intent(out) :: q(:) !! the condensed load (n_schur)
      real(dp), allocatable :: work(:), condensed(:)

      partial = b
      work = b
      allocate (condensed(self%n_schur))
      call half_solve(self, .false., work, condensed)
      q = condensed
   end subroutine distributed_condense

   !> All unknowns from the Schur variables. MUMPS remembers one load only: this one is condensed again.
   subroutine distributed_expand(self, partial, v, x)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), intent(in) :: partial(:) !! the load (n)
      real(dp), intent(in) :: v(:) !! the Schur variables (n_schur)
      real(dp), intent(out) :: x(:) !! all unknowns (n)
      real(dp), allocatable :: work(:), of_schur(:)

      work = partial
      allocate (of_schur(self%n_schur))
      ! The cases of a sweep may ask for their displacements from several threads.
      !$omp critical (amontons_ranks_at_work)
      call half_solve(self, .false., work, of_schur)
      of_schur = v
      call half_solve(self, .true., work, of_schur)
      !$omp end critical (amontons_ranks_at_work)
      x = work
      x(self%n - self%n_schur + 1:) = v
      ! What comes now, stresses and their errors, is where rank 0 holds most.
      deallocate (work)
      call return_memory()
   end subroutine distributed_expand

   !> Solves K x = b.
   subroutine distributed_solve(self, b, x)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), intent(in) :: b(:) !! right-hand side (n)
      real(dp), intent(out) :: x(:) !! the solution (n)
      real(dp), allocatable :: partial(:), v(:, :), factor(:, :)
      integer :: info

      allocate (partial(self%n), v(self%n_schur, 1), factor(self%n_schur, self%n_schur))
      call self%condense(b, partial, v(:, 1))
      call self%schur_complement(factor)
      call dpotrf('L', self%n_schur, factor, self%n_schur, info)
      call dpotrs('L', self%n_schur, 1, factor, self%n_schur, v, self%n_schur, info)
      call self%expand(partial, v(:, 1), x)
   end subroutine distributed_solve

   !> Half of a solution on all ranks. Where memory runs out the result is no number, which the caller refuses.
   subroutine half_solve(self, is_backward, all_unknowns, of_schur)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      logical, intent(in) :: is_backward !! which half
      real(dp), contiguous, intent(inout) :: all_unknowns(:) !! the load, or all unknowns on return (n)
      real(dp), contiguous, intent(inout) :: of_schur(:) !! the condensed load, or the Schur variables (n_schur)

      if (self%n_schur == 0 .and. .not. is_backward) return
      call give_order(merge(order_expand, order_condense, is_backward))
      call self%work%mumps%solve(is_backward, all_unknowns, of_schur)
      if (self%work%mumps%report%code >= 0) return
      all_unknowns = ieee_value(1.0_dp, ieee_quiet_nan)
      of_schur = all_unknowns(1)
   end subroutine half_solve

   !> Frees what all ranks hold.
   subroutine distributed_free(self)
      type(distributed_condenser_t), intent(inout) :: self !! the condenser

      if (.not. associated(self%work)) return
      call give_order(order_free)
      call self%work%mumps%free()
      deallocate (self%work)
   end subroutine distributed_free

end module amontons_distributed_condenser
