!> The condenser of a body whose elements, matrix and factor are spread over the ranks of a run.
!>
!> It lives on rank 0 and gives the orders; the other ranks follow them. Each holds the stiffness of its
!> subdomain and its part of MUMPS's factor; rank 0 has the order of elimination and the Schur complement too. There is
!> one such condenser at a time. Sums depend on the number of ranks in their last digits.
!>
!> Another rank may have a condenser of the same body, too, once rank 0 has shared its own: it has the Schur complement
!> from there, and takes part in what rank 0 condenses to learn the result. Both condense the same loads in the same
!> sequence.
module amontons_distributed_condenser
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use amontons_condenser, only: condenser_t
   use amontons_constraints, only: constraints_t, dof_map_t, spring_side_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dpotrf, dpotrs
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_rank_work, only: check_room, rank_work_t
   use amontons_ranks, only: all_ranks, broadcast, give_order, line_t, n_ranks, next_order, rank
   use amontons_subdomain, only: assembly_mb, find_owners, find_positions, new_subdomain, subdomain_t
   use amontons_system, only: return_memory
   implicit none (type, external)
   private

   public :: dismiss_ranks, distributed_condenser_t, first_free_order, follow_order, new_distributed_condenser, &
      order_end, share_condenser

   !> Orders of rank 0. Those from the last of these on are for a room above this one.
   enum, bind(c)
      enumerator :: order_end, order_take, order_analyze, order_check_memory, order_factorize, order_condense, &
         order_forward, order_backward, order_free, first_free_order
   end enum

   !> What a machine may lack the memory for before it factorizes.
   character(*), parameter :: assembly = 'the assembly of the stiffness'

   !> What this rank has of the body at hand, if one is spread.
   type(rank_work_t), allocatable :: work

   !> A condenser over the ranks.
   type, extends(condenser_t) :: distributed_condenser_t
      private
      real(dp), allocatable :: s(:) !! The upper triangle of the Schur complement, column after column; of rank 0.
   contains
      procedure, public :: check_memory => distributed_check_memory
      procedure, public :: memory_mb => distributed_memory_mb
      procedure, public :: complete => distributed_complete
      procedure, public :: schur_complement => distributed_schur_complement
      procedure, public :: condense => distributed_condense
      procedure, public :: expand => distributed_expand
      procedure, public :: expand_all => distributed_expand_all
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
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns; the last ones are the Schur variables
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer, allocatable :: position(:)
      real(dp), allocatable :: sums(:, :)

      condenser%name = 'distributed'
      condenser%n = dof_map%n_dofs
      condenser%n_schur = dof_map%n_schur
      if (rank > 0) then
         call pass_regularization(condenser)
         return
      end if
      call find_positions(position, mesh, dof_map, error)
      if (allocated(error)) return
      allocate (work)
      allocate (work%subdomain)
      call spread_body(work%subdomain, position, mesh, materials, springs, constraints, dof_map, error)
      if (allocated(error)) return
      allocate (sums(2, condenser%n), source=0.0_dp)
      call work%assemble(sums, error)
      if (allocated(error)) return
      if (.not. is_held) condenser%regularization = sum(sums(1, :))/condenser%n
      associate (schur_sums => sums(2, condenser%n - condenser%n_schur + 1:))
         schur_sums = schur_sums + condenser%regularization
      end associate
      ! The largest sum would pass over one that is no number.
      condenser%matrix_norm = maxval(sums(2, :)) + 0.0_dp*sum(sums(2, :))
      deallocate (sums)
      call give_order(order_analyze)
      call work%analyze(condenser%n_schur, condenser%regularization, position, error)
      associate (report => work%mumps%report)
         condenser%n_factor_entries = report%n_entries
         condenser%n_flops = report%n_flops
      end associate
   end subroutine new_distributed_condenser

   !> Gives every rank its subdomain. Rank 0 has the springs, and the nodes of all Schur variables.
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
      integer :: i

      call give_order(order_take)
      call find_owners(owner, n_ranks, position, mesh, dof_map)
      megabytes = assembly_mb(owner, n_ranks, mesh)
      call broadcast(megabytes)
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

   !> Has the other ranks make condensers of the same body, which they do at this time; for rank 0. One that is not
   !> spread each of them condenses by itself.
   subroutine share_condenser(condenser)
      class(condenser_t), intent(inout) :: condenser !! the condenser, complete; unchanged
      integer :: j

      select type (condenser)
      type is (distributed_condenser_t)
         call pass_regularization(condenser)
         do j = 1, condenser%n_schur
            call broadcast(condenser%s(triangle(j - 1) + 1:triangle(j)))
         end do
      end select
   end subroutine share_condenser

   !> Passes from rank 0 how a condenser has regularized the matrix.
   subroutine pass_regularization(condenser)
      type(distributed_condenser_t), intent(inout) :: condenser !! the condenser
      real(dp) :: regularization(1)

      regularization = condenser%regularization
      call broadcast(regularization)
      condenser%regularization = regularization(1)
   end subroutine pass_regularization

   !> Follows an order that rank 0 gives for its condenser; for the other ranks.
   subroutine follow_order(order)
      integer, intent(in) :: order !! the order, below `first_free_order` and not `order_end`
      type(error_t), allocatable :: error
      real(dp), allocatable :: none(:, :), condensed(:, :)
      integer :: no_position(0)

      allocate (none(2, 0))
      select case (order)
      case (order_take)
         if (allocated(work)) deallocate (work)
         allocate (work)
         call take_subdomain(error)
         if (.not. allocated(error)) call work%assemble(none, error)
      case (order_analyze)
         call work%analyze(0, 0.0_dp, no_position, error)
      case (order_check_memory)
         call work%check_memory(error)
      case (order_factorize)
         call work%factorize(0, none, error)
      case (order_condense)
         call follow_condensing(condensed)
      case (order_forward, order_backward)
         call work%mumps%solve(order == order_backward, none, none)
      case default  ! order_free
         call work%mumps%free()
         deallocate (work)
      end select
   end subroutine follow_order

   !> Takes part in condensing a load, and learns the result; for the other ranks.
   subroutine follow_condensing(condensed)
      real(dp), allocatable, intent(inout) :: condensed(:, :) !! the condensed load (n_schur, 1)
      real(dp), allocatable :: none(:, :)
      type(line_t) :: line

      allocate (none(0, 0))
      call work%mumps%solve(.false., none, none)
      line = line_t(all_ranks, .false.)
      call line%pass(condensed)
   end subroutine follow_condensing

   !> Takes a rank's subdomain, if there is memory for it.
   subroutine take_subdomain(error)
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice for assembly
      real(dp) :: megabytes(0:n_ranks - 1)

      call broadcast(megabytes)
      call check_room(assembly, megabytes(rank), error)
      if (allocated(error)) return
      allocate (work%subdomain)
      call work%subdomain%pass(line_t(0, .false.))
   end subroutine take_subdomain

   !> Ends the service of the other ranks.
   subroutine dismiss_ranks()
      call give_order(order_end)
   end subroutine dismiss_ranks

   !> Refuses a factor that the memory of the machines cannot hold.
   subroutine distributed_check_memory(self, error)
      class(distributed_condenser_t), intent(in) :: self !! the condenser, the matrix analyzed
      type(error_t), allocatable, intent(out) :: error !! memory does not suffice

      ! On the other ranks there is nothing to do that rank 0 has not had them do.
      if (rank > 0) return
      call give_order(order_check_memory)
      call work%check_memory(error)
      associate (unused => self)
      end associate
   end subroutine distributed_check_memory

   !> The memory that `complete` takes on the rank where it takes most [MB].
   pure real(dp) function distributed_memory_mb(self) result(memory_mb)
      class(distributed_condenser_t), intent(in) :: self !! the condenser, the matrix analyzed

      memory_mb = work%mumps%report%largest_mb
      associate (unused => self)
      end associate
   end function distributed_memory_mb

   !> Factorizes the matrix.
   subroutine distributed_complete(self, error)
      class(distributed_condenser_t), intent(inout) :: self !! the condenser
      type(error_t), allocatable, intent(out) :: error !! the matrix is not positive definite, or memory ran out

      real(dp), allocatable :: schur(:, :)
      integer :: j

      if (rank > 0) return
      call give_order(order_factorize)
      call work%factorize(self%n_schur, schur, error)
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

   !> The Schur complement. Where rank 0 shares it, all ranks make theirs at the same time.
   subroutine distributed_schur_complement(self, s)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), contiguous, intent(out) :: s(:, :) !! S, both triangles (n_schur, n_schur)
      integer :: j

      do j = 1, self%n_schur
         if (rank == 0) s(:j, j) = self%s(triangle(j - 1) + 1:triangle(j))
         if (rank > 0) call broadcast(s(:j, j))
         s(j, :j) = s(:j, j)
      end do
   end subroutine distributed_schur_complement

   !> Eliminates the interior from a load.
   subroutine distributed_condense(self, b, partial, q)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), intent(in) :: b(:) !! the load (n)
      real(dp), contiguous, intent(out) :: partial(:) !! what `expand` needs of the load: the load (n)
      real(dp), intent(out) :: q(:) !! the condensed load (n_schur)
      real(dp), allocatable :: load(:, :), condensed(:, :)
      type(line_t) :: line

      partial = b
      if (self%n_schur == 0) return
      if (rank == 0) then
         load = reshape(b, [self%n, 1])
         allocate (condensed(self%n_schur, 1))
         call half_solve(order_condense, load, condensed)
         line = line_t(all_ranks, .true.)
         call line%pass(condensed)
      else if (next_order() == order_condense) then
         call follow_condensing(condensed)
      end if
      q = condensed(:, 1)
   end subroutine distributed_condense

   !> All unknowns from the Schur variables.
   subroutine distributed_expand(self, partial, v, x)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), intent(in) :: partial(:) !! the load (n)
      real(dp), intent(in) :: v(:) !! the Schur variables (n_schur)
      real(dp), intent(out) :: x(:) !! all unknowns (n)
      real(dp), allocatable :: columns(:, :)

      columns = reshape(partial, [self%n, 1])
      call expand_columns(self, reshape(v, [self%n_schur, 1]), columns)
      x = columns(:, 1)
   end subroutine distributed_expand

   !> All unknowns from the Schur variables under several loads.
   subroutine distributed_expand_all(self, partial, v, x)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), contiguous, intent(in) :: partial(:, :) !! the loads (n, loads)
      real(dp), contiguous, intent(in) :: v(:, :) !! the Schur variables (n_schur, loads)
      real(dp), contiguous, intent(out) :: x(:, :) !! all unknowns (n, loads)

      x = partial
      call expand_columns(self, v, x)
   end subroutine distributed_expand_all

   !> Makes all unknowns of loads. MUMPS remembers only those that it condensed last: these are condensed again.
   subroutine expand_columns(condenser, v, x)
      class(distributed_condenser_t), intent(in) :: condenser !! the condenser
      real(dp), intent(in) :: v(:, :) !! the Schur variables (n_schur, loads)
      real(dp), contiguous, intent(inout) :: x(:, :) !! the loads; all unknowns on return (n, loads)
      real(dp), allocatable :: of_schur(:, :)

      of_schur = v
      ! The cases of a sweep may ask for their displacements from several threads.
      !$omp critical (amontons_ranks_at_work)
      if (condenser%n_schur > 0) call half_solve(order_forward, x, of_schur)
      of_schur = v
      call half_solve(order_backward, x, of_schur)
      !$omp end critical (amontons_ranks_at_work)
      x(condenser%n - condenser%n_schur + 1:, :) = v
      ! What comes now, stresses and their errors, is where rank 0 holds most.
      call return_memory()
   end subroutine expand_columns

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
   subroutine half_solve(order, all_unknowns, of_schur)
      integer, intent(in) :: order !! which half, and whether other ranks learn the result of the first one
      real(dp), contiguous, intent(inout) :: all_unknowns(:, :) !! the loads, or all unknowns on return (n, loads)
      real(dp), contiguous, intent(inout) :: of_schur(:, :)
         !! the condensed loads, or the Schur variables (n_schur, loads)

      call give_order(order)
      call work%mumps%solve(order == order_backward, all_unknowns, of_schur)
      if (work%mumps%report%code >= 0) return
      all_unknowns = ieee_value(1.0_dp, ieee_quiet_nan)
      of_schur = ieee_value(1.0_dp, ieee_quiet_nan)
   end subroutine half_solve

   !> Frees what all ranks hold.
   subroutine distributed_free(self)
      type(distributed_condenser_t), intent(inout) :: self !! the condenser

      if (rank > 0 .or. self%n == 0 .or. .not. allocated(work)) return
      call give_order(order_free)
      call work%mumps%free()
      deallocate (work)
   end subroutine distributed_free

end module amontons_distributed_condenser
