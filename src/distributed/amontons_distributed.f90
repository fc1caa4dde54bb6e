!> The run on several ranks as the rest of the program uses it, and the condenser of a body whose elements, matrix and
!> factor are spread over the ranks; builds without MPI have another module of this name.
!>
!> The condenser object is on rank 0, which gives the orders; the other ranks follow them. Each rank holds the stiffness
!> of its subdomain and its part of MUMPS's factor; rank 0 also has the order of elimination and the Schur complement.
!> There is one such condenser at a time. Sums depend on the number of ranks in their last digits.
!>
!> A subdomain has the elements that one rank owns by its share of the order of elimination. The order is found from the
!> mesh, without a matrix.
!>
!> After rank 0 has shared its condenser, another rank has one of the same body: it receives the Schur complement from
!> rank 0, and the results of the loads that rank 0 condenses. Both condense the same loads in the same sequence.
!>
!> The procedures of `rank_work_t` are called on all ranks at the same time, after an order of rank 0. On rank 0 the
!> arguments are those of the body; on the others they are not used.
module amontons_distributed
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use amontons_assembly, only: assemble_stiffness
   use amontons_condenser, only: condenser_t, known_solutions
   use amontons_constraints, only: constraints_t, dof_map_t, spring_side_t
   use amontons_dissection, only: dissection_t, new_dissection
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_lapack, only: dpotrf, dpotrs
   use amontons_material, only: materials_t
   use amontons_mesh, only: coloring_t, mesh_t, new_coloring
   use amontons_mumps, only: mumps_t, mumps_text, new_mumps_error
   use amontons_ranks, only: agree, all_ranks, begin_ranks, broadcast, channel_t, end_ranks, gather_columns, &
      give_order, has_begun, n_ranks, next_order, on_all_ranks, rank, sum_on_machine
   use amontons_sparse_matrix, only: graph_t, new_graph, new_sparse_pattern, sparse_matrix_t
   use amontons_system, only: available_memory_mb, return_memory
   use amontons_text, only: to_text
   use amontons_threads, only: n_threads, use_blas_threads
   implicit none (type, external)
   private

   public :: all_ranks, begin_ranks, broadcast, channel_t, check_room, dismiss_ranks, end_ranks, first_free_order, &
      follow_order, give_order, mpi_text, n_ranks, new_distributed_condenser, next_order, on_all_ranks, &
      order_end, rank, share_condenser

   !> A subdomain, with its own numbers of nodes, elements and unknowns.
   type :: subdomain_t
      type(mesh_t) :: mesh !! its elements, and their nodes
      type(materials_t) :: materials !! the materials
      type(spring_side_t), allocatable :: springs(:) !! springs along sides: on rank 0 those of the body, else none
      type(coloring_t) :: coloring !! colors of the elements
      type(constraints_t) :: constraints !! the frames of the nodes
      type(dof_map_t) :: dof_map !! numbers of the unknowns, and what displacements of slaves are made of
      integer, allocatable :: node(:)
         !! the node of the body that each node is: those of elements and springs, then others whose unknowns take part
      integer, allocatable :: unknown(:) !! the unknown of the body that each unknown is
   contains
      procedure :: pass => subdomain_pass
      procedure :: prepare => subdomain_prepare
   end type subdomain_t

   !> Orders of rank 0. Numbers from the last of these on are orders of modules above this one.
   enum, bind(c)
      enumerator :: order_end, order_take, order_analyze, order_check_memory, order_factorize, order_condense, &
         order_forward, order_backward, order_free, first_free_order
   end enum

   !> Tasks for which memory may run out before the factorization.
   character(*), parameter :: assembly = 'the assembly of the stiffness', the_factor = 'the distributed factor'

   !> The part of the present body that a rank holds.
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
      procedure :: factorize => rank_work_factorize
   end type rank_work_t

   !> The part of the present body that this rank holds, if a body is spread.
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
      procedure, public :: expand_all => distributed_expand_all
      procedure, public :: solve => distributed_solve
      final :: distributed_free
   end type distributed_condenser_t

contains

   !> Finds the position of each unknown in the order of a nested dissection, the Schur variables last.
   subroutine find_positions(position, mesh, dof_map, error)
      integer, allocatable, intent(out) :: position(:) !! position of each unknown (n_dofs)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(sparse_matrix_t) :: coupling
      type(graph_t) :: graph
      type(dissection_t) :: dissection
      integer, allocatable :: node(:), node_of(:), item(:), order(:), start(:), own_node(:)
      integer :: n_schur, k, axis, last

      ! The nodes that have unknowns, in the order of these; the first unknown of a node stands for it.
      allocate (node_of(dof_map%n_dofs), source=0)
      do k = 1, mesh%n_nodes
         axis = findloc(dof_map%dof(:, k) > 0, .true., dim=1)
         if (axis > 0) node_of(dof_map%dof(axis, k)) = k
      end do
      node = pack(node_of, node_of > 0)
      n_schur = count(node_of(dof_map%n_dofs - dof_map%n_schur + 1:) > 0)
      allocate (item(mesh%n_nodes), source=0)
      do k = 1, size(node)
         item(node(k)) = k
      end do
      ! Only which nodes couple is of interest.
      call dof_map%substitution%own_nodes_of_elements(mesh%node_start, mesh%node, start, own_node)
      call new_sparse_pattern(coupling, size(node), start, item(own_node), error)
      if (allocated(error)) return
      deallocate (start, own_node)
      deallocate (coupling%value)
      call new_graph(graph, coupling, n_schur)
      coupling = sparse_matrix_t()
      call new_dissection(dissection, graph, mesh%coordinates(:, node(graph%first_unknown(:graph%n - graph%n_schur))))
      allocate (order(size(node)), position(dof_map%n_dofs))
      call graph%expand(dissection%order, order)
      last = 0
      do k = 1, size(order)
         do axis = 1, size(dof_map%dof, 1)
            associate (dof => dof_map%dof(axis, node(order(k))))
               if (dof == 0) cycle
               last = last + 1
               position(dof) = last
            end associate
         end do
      end do
   end subroutine find_positions

   !> Finds the rank that owns each element: the one whose share of the order of elimination contains the first unknown
   !> of the element to be eliminated. A rank owns whole subtrees of the dissection where possible, so that subdomains
   !> are compact. The shares are equal except that of rank 0: this holds mesh, loads and the last front for all
   !> unknowns of the body in addition, while each unknown of a share takes about 190 bytes until it is factorized. Its
   !> share is smaller by so much that all ranks hold about the same.
   pure subroutine find_owners(owner, n_ranks, position, mesh, dof_map)
      integer, allocatable, intent(out) :: owner(:) !! the rank of each element
      integer, intent(in) :: n_ranks !! number of ranks
      integer, intent(in) :: position(:) !! position of each unknown
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      ! Further memory of rank 0, over that of a share, measured on two ranks and two million unknowns.
      real(dp), parameter :: burden = 0.57_dp
      integer, allocatable :: node_start(:), node(:)
      integer :: i, k, axis, first, n_own

      n_own = int(max(0.0_dp, 1.0_dp - burden*(n_ranks - 1))*size(position)/n_ranks)
      call dof_map%substitution%own_nodes_of_elements(mesh%node_start, mesh%node, node_start, node)
      allocate (owner(mesh%n_elements), source=0)
      do i = 1, mesh%n_elements
         first = size(position)
         do k = node_start(i), node_start(i + 1) - 1
            do axis = 1, size(dof_map%dof, 1)
               associate (dof => dof_map%dof(axis, node(k)))
                  if (dof > 0) first = min(first, position(dof))
               end associate
            end do
         end do
         if (first > n_own .and. n_ranks > 1) owner(i) = 1 + int((first - n_own - 1)*int(n_ranks - 1, int64) &
            /(size(position) - n_own))
      end do
   end subroutine find_owners

   !> The memory for the stiffness of each rank's elements during assembly, estimated as that of their element matrices:
   !> 12 bytes for each entry of a triangle, in a triangular matrix of the subdomain in which shared entries are merged
   !> [MB].
   pure function assembly_mb(owner, n_ranks, mesh, n_components)
      integer, intent(in) :: owner(:) !! the rank of each element
      integer, intent(in) :: n_ranks !! number of ranks
      type(mesh_t), intent(in) :: mesh !! the mesh of the body
      integer, intent(in) :: n_components !! number of components of a displacement
      real(dp) :: assembly_mb(0:n_ranks - 1)
      integer :: n, i

      assembly_mb = 0.0_dp
      do i = 1, size(owner)
         n = n_components*(mesh%node_start(i + 1) - mesh%node_start(i))
         assembly_mb(owner(i)) = assembly_mb(owner(i)) + 12.0e-6_dp*(n*(n + 1)/2)
      end do
   end function assembly_mb

   !> Cuts a subdomain out of a body: elements, nodes and unknowns.
   pure subroutine new_subdomain(subdomain, elements, springs, last_nodes, number, mesh, dof_map)
      type(subdomain_t), intent(out) :: subdomain !! the subdomain; to be prepared where it is used
      integer, intent(in) :: elements(:) !! its elements
      type(spring_side_t), intent(in) :: springs(:) !! its springs
      integer, intent(in) :: last_nodes(:) !! further nodes whose unknowns it has
      integer, intent(inout) :: number(:) !! work space, zero on entry and on return (n_nodes)
      type(mesh_t), intent(in) :: mesh !! the mesh of the body
      type(dof_map_t), intent(in) :: dof_map !! numbers of its unknowns
      integer, allocatable :: start(:), node(:)
      integer :: n_displaced, i

      associate (own => subdomain%mesh)
         own%n_elements = size(elements)
         own%element_kind = mesh%element_kind(elements)
         allocate (own%node_start(size(elements) + 1))
         own%node_start(1) = 1
         do i = 1, size(elements)
            own%node_start(i + 1) = own%node_start(i) + mesh%node_start(elements(i) + 1) - mesh%node_start(elements(i))
         end do
         allocate (own%node(own%node_start(size(elements) + 1) - 1))
         do i = 1, size(elements)
            own%node(own%node_start(i):own%node_start(i + 1) - 1) = &
               mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i) + 1) - 1)
         end do
      end associate
      allocate (subdomain%node(0))
      call number_nodes(subdomain%node, number, [subdomain%mesh%node, (springs(i)%node, i=1, size(springs))])
      ! After those whose displacements are of interest come those whose unknowns these are made of.
      n_displaced = size(subdomain%node)
      call dof_map%substitution%own_nodes_of_elements([(i, i=1, n_displaced + 1)], subdomain%node, start, node)
      call number_nodes(subdomain%node, number, [node, last_nodes])
      subdomain%mesh%n_nodes = size(subdomain%node)
      subdomain%mesh%node = number(subdomain%mesh%node)
      subdomain%mesh%coordinates = mesh%coordinates(:, subdomain%node)
      subdomain%dof_map%dof = dof_map%dof(:, subdomain%node)
      call subdomain%dof_map%substitution%copy_part(dof_map%substitution, subdomain%node(:n_displaced), number)
      subdomain%springs = springs
      do i = 1, size(springs)
         subdomain%springs(i)%node = number(springs(i)%node)
      end do
      number(subdomain%node) = 0
   end subroutine new_subdomain

   !> Gives consecutive numbers to nodes that have none yet.
   pure subroutine number_nodes(node, number, more)
      integer, allocatable, intent(inout) :: node(:) !! the numbered nodes
      integer, intent(inout) :: number(:) !! their numbers, 0 for none (n_nodes)
      integer, intent(in) :: more(:) !! nodes, some many times, some numbered
      integer, allocatable :: new(:)
      integer :: i, n

      allocate (new(size(more)))
      n = 0
      do i = 1, size(more)
         if (number(more(i)) > 0) cycle
         n = n + 1
         new(n) = more(i)
         number(more(i)) = size(node) + n
      end do
      node = [node, new(:n)]
   end subroutine number_nodes

   !> Passes a subdomain, with all that its assembly needs, from rank 0 to its owner.
   subroutine subdomain_pass(self, channel)
      class(subdomain_t), intent(inout) :: self !! the subdomain
      type(channel_t), intent(in) :: channel !! the channel between the ranks
      real(dp), allocatable :: blocks(:, :), numbers(:, :)
      integer, allocatable :: is(:, :)
      integer :: i, n, n_blocks

      associate (mesh => self%mesh)
         call channel%pass(mesh%n_elements)
         call channel%pass(mesh%coordinates)
         call channel%pass(mesh%element_kind)
         call channel%pass(mesh%node_start)
         call channel%pass(mesh%node)
      end associate
      call channel%pass(self%node)
      call channel%pass(self%dof_map%dof)
      n = size(self%dof_map%dof, 1)
      if (channel%is_sender) blocks = reshape(self%constraints%frame, [n*n, size(self%node)])
      call channel%pass(blocks)
      self%constraints%frame = reshape(blocks, [n, n, size(self%node)])
      associate (substitution => self%dof_map%substitution)
         n_blocks = 0
         if (allocated(substitution%node)) n_blocks = size(substitution%node)
         call channel%pass(n_blocks)
         if (n_blocks > 0) then
            call channel%pass(substitution%start)
            call channel%pass(substitution%node)
            if (channel%is_sender) blocks = reshape(substitution%block, [n*n, n_blocks])
            call channel%pass(blocks)
            substitution%block = reshape(blocks, [n, n, n_blocks])
         end if
      end associate
      call channel%pass(self%materials%of_element)
      if (channel%is_sender) then
         associate (list => self%materials%list)
            numbers = reshape([(list(i)%thickness, list(i)%lambda, list(i)%mu, list(i)%law, i=1, size(list))], &
               [3 + size(list(1)%law), size(list)])
            is = merge(1, 0, reshape([list%is_b_bar, list%is_axisymmetric, list%is_twisted], [size(list), 3]))
         end associate
      end if
      call channel%pass(numbers)
      call channel%pass(is)
      if (channel%is_sender) return
      allocate (self%materials%list(size(is, 1)))
      do i = 1, size(is, 1)
         associate (material => self%materials%list(i))
            material%thickness = numbers(1, i)
            material%lambda = numbers(2, i)
            material%mu = numbers(3, i)
            material%law = reshape(numbers(4:, i), shape(material%law))
            material%is_b_bar = is(i, 1) > 0
            material%is_axisymmetric = is(i, 2) > 0
            material%is_twisted = is(i, 3) > 0
            material%n_components = n
         end associate
      end do
      self%mesh%n_nodes = size(self%node)
      allocate (self%springs(0))
   end subroutine subdomain_pass

   !> Numbers the unknowns of the subdomain and colors its elements.
   subroutine subdomain_prepare(self)
      class(subdomain_t), intent(inout) :: self !! the subdomain
      integer :: i, axis

      associate (dof_map => self%dof_map)
         allocate (self%unknown(count(dof_map%dof > 0)))
         do i = 1, size(dof_map%dof, 2)
            do axis = 1, size(dof_map%dof, 1)
               if (dof_map%dof(axis, i) == 0) cycle
               dof_map%n_dofs = dof_map%n_dofs + 1
               self%unknown(dof_map%n_dofs) = dof_map%dof(axis, i)
               dof_map%dof(axis, i) = dof_map%n_dofs
            end do
         end do
      end associate
      ! Of many ranks and few elements a rank may have none.
      if (self%mesh%n_elements > 0) call new_coloring(self%coloring, self%mesh)
   end subroutine subdomain_prepare

   !> The text of --version about MPI.
   function mpi_text() result(text)
      character(:), allocatable :: text

      text = 'yes, MUMPS '//mumps_text()
   end function mpi_text

   !> Spreads a body over the ranks, assembles its stiffness and analyzes it.
   subroutine new_distributed_condenser(condenser, is_held, mesh, materials, springs, constraints, dof_map, error)
      class(condenser_t), allocatable, intent(out) :: condenser !! the condenser
      logical, intent(in) :: is_held !! whether supports alone hold the body
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! memory ran out, or there are no ranks
      type(distributed_condenser_t), allocatable :: made
      integer, allocatable :: position(:), owner(:), elements(:), last_nodes(:), number(:)
      real(dp), allocatable :: sums(:, :), shift(:)
      real(dp) :: megabytes(0:n_ranks - 1)
      integer :: i, k

      if (.not. has_begun) then
         call new_error(error, input_refused, "factorization = 'distributed' is for a run on several ranks: "// &
            'mpiexec -n 2 amontons ...')
         return
      end if
      allocate (made)
      made%name = 'distributed'
      made%n = dof_map%n_dofs
      made%n_schur = dof_map%n_schur
      if (rank > 0) then
         call pass_diagonal(made)
         call move_alloc(made, condenser)
         return
      end if
      call find_positions(position, mesh, dof_map, error)
      if (allocated(error)) return
      allocate (work)
      allocate (work%subdomain)
      ! Gives every rank its subdomain. Rank 0 has the springs, and the nodes of all Schur variables.
      call give_order(order_take)
      call find_owners(owner, n_ranks, position, mesh, dof_map)
      megabytes = assembly_mb(owner, n_ranks, mesh, materials%n_components())
      call broadcast(megabytes)
      call check_room(assembly, megabytes(0), error)
      if (allocated(error)) return
      last_nodes = pack([(i, i=1, mesh%n_nodes)], any(dof_map%dof > made%n - made%n_schur, dim=1))
      allocate (number(mesh%n_nodes), source=0)
      do i = n_ranks - 1, 0, -1
         elements = pack([(k, k=1, mesh%n_elements)], owner == i)
         associate (own => work%subdomain)
            if (i > 0) then
               call new_subdomain(own, elements, springs(:0), last_nodes(:0), number, mesh, dof_map)
            else
               call new_subdomain(own, elements, springs, last_nodes, number, mesh, dof_map)
            end if
            own%materials%list = materials%list
            own%materials%of_element = materials%of_element(elements)
            own%constraints%frame = constraints%frame(:, :, own%node)
            if (i > 0) call own%pass(channel_t(i, .true.))
         end associate
      end do
      allocate (sums(4, made%n), source=0.0_dp)
      call work%assemble(sums, error)
      if (allocated(error)) return
      made%schur_diagonal = sums(1, made%n - made%n_schur + 1:)
      shift = merge(0.0_dp, made%schur_diagonal, is_held)
      associate (schur_sums => sums(2, made%n - made%n_schur + 1:))
         schur_sums = schur_sums + shift
      end associate
      made%known_load = transpose(sums(3:, :))
      associate (unknown => [(i, i=made%n - made%n_schur + 1, made%n)])
         made%known_load(unknown, :) = made%known_load(unknown, :) + spread(shift, 2, 2)*known_solutions(unknown)
      end associate
      ! The largest sum would pass over one that is no number.
      made%matrix_norm = maxval(sums(2, :)) + 0.0_dp*sum(sums(2, :))
      deallocate (sums)
      call give_order(order_analyze)
      call work%analyze(shift, position, error)
      made%n_factor_entries = work%mumps%report%n_entries
      made%n_flops = work%mumps%report%n_flops
      call move_alloc(made, condenser)
   end subroutine new_distributed_condenser

   !> Makes condensers of the same body on the other ranks, which call it at the same time as rank 0. A body that is not
   !> spread is condensed by each rank itself.
   subroutine share_condenser(condenser)
      class(condenser_t), intent(inout) :: condenser !! the condenser, complete; unchanged
      integer :: j

      select type (condenser)
      type is (distributed_condenser_t)
         call pass_diagonal(condenser)
         do j = 1, condenser%n_schur
            call broadcast(condenser%s(triangle(j - 1) + 1:triangle(j)))
         end do
      end select
   end subroutine share_condenser

   !> Passes the diagonal entries of a condenser's Schur variables from rank 0.
   subroutine pass_diagonal(condenser)
      type(distributed_condenser_t), intent(inout) :: condenser !! the condenser

      if (rank > 0) allocate (condenser%schur_diagonal(condenser%n_schur))
      call broadcast(condenser%schur_diagonal)
   end subroutine pass_diagonal

   !> Follows an order of rank 0 about its condenser; called on the other ranks.
   subroutine follow_order(order)
      integer, intent(in) :: order !! the order, below `first_free_order` and not `order_end`
      type(error_t), allocatable :: error
      real(dp), allocatable :: none(:, :), condensed(:, :)
      real(dp) :: megabytes(0:n_ranks - 1)
      integer :: no_position(0)
      type(channel_t) :: channel

      allocate (none(4, 0))
      select case (order)
      case (order_take)
         if (allocated(work)) deallocate (work)
         allocate (work)
         call broadcast(megabytes)
         call check_room(assembly, megabytes(rank), error)
         if (allocated(error)) return
         allocate (work%subdomain)
         call work%subdomain%pass(channel_t(0, .false.))
         call work%assemble(none, error)
      case (order_analyze)
         call work%analyze(none(1, :), no_position, error)
      case (order_check_memory)
         call check_room(the_factor, work%mumps%report%own_mb, error)
      case (order_factorize)
         call work%factorize(0, none, error)
      case (order_condense)
         call work%mumps%solve(.false., none, none)
         channel = channel_t(all_ranks, .false.)
         call channel%pass(condensed)
      case (order_forward, order_backward)
         call work%mumps%solve(order == order_backward, none, none)
      case default  ! order_free
         call work%mumps%free()
         deallocate (work)
      end select
   end subroutine follow_order

   !> Ends the service loop of the other ranks.
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
      call check_room(the_factor, work%mumps%report%own_mb, error)
      associate (unused => self)
      end associate
   end subroutine distributed_check_memory

   !> The memory that `complete` takes, on the rank where it takes most [MB].
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

      real(dp), allocatable :: schur(:, :), solutions(:, :)
      integer :: j

      if (rank > 0) return
      call give_order(order_factorize)
      call work%factorize(self%n_schur, schur, error)
      if (allocated(error)) return
      allocate (self%s(triangle(self%n_schur)))
      do j = 1, self%n_schur
         self%s(triangle(j - 1) + 1:triangle(j)) = schur(:j, j)
      end do
      ! MUMPS takes any pivot that is not exactly 0.
      allocate (solutions, mold=self%known_load)
      call self%expand_all(self%known_load, known_solutions([(j, j=self%n - self%n_schur + 1, self%n)]), solutions)
      call new_mumps_error(work%mumps%report, error)
      if (.not. allocated(error)) call self%check_solutions(solutions, error)
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
      real(dp), allocatable :: load(:, :), condensed(:, :), none(:, :)
      type(channel_t) :: channel

      partial = b
      if (self%n_schur == 0) return
      if (rank == 0) then
         load = reshape(b, [self%n, 1])
         allocate (condensed(self%n_schur, 1))
         call half_solve(order_condense, load, condensed)
         channel = channel_t(all_ranks, .true.)
         call channel%pass(condensed)
      else if (next_order() == order_condense) then
         allocate (none(0, 0))
         call work%mumps%solve(.false., none, none)
         channel = channel_t(all_ranks, .false.)
         call channel%pass(condensed)
      end if
      q = condensed(:, 1)
   end subroutine distributed_condense

   !> Computes all unknowns from the Schur variables under several loads. MUMPS keeps only the last loads that it
   !> condensed, so these are condensed again.
   subroutine distributed_expand_all(self, partial, v, x)
      class(distributed_condenser_t), intent(in) :: self !! the condenser
      real(dp), contiguous, intent(in) :: partial(:, :) !! the loads (n, loads)
      real(dp), contiguous, intent(in) :: v(:, :) !! the Schur variables (n_schur, loads)
      real(dp), contiguous, intent(out) :: x(:, :) !! all unknowns (n, loads)
      real(dp), allocatable :: of_schur(:, :)

      x = partial
      of_schur = v
      ! The cases of a sweep may ask for their displacements from several threads.
      !$omp critical (amontons_ranks_at_work)
      if (self%n_schur > 0) call half_solve(order_forward, x, of_schur)
      of_schur = v
      call half_solve(order_backward, x, of_schur)
      !$omp end critical (amontons_ranks_at_work)
      x(self%n - self%n_schur + 1:, :) = v
      ! What comes now, stresses and their errors, is where rank 0 holds most.
      call return_memory()
   end subroutine distributed_expand_all

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

   !> Performs the forward or backward half of a solution on all ranks. If memory runs out the result is NaN, which the
   !> caller refuses.
   subroutine half_solve(order, all_unknowns, of_schur)
      integer, intent(in) :: order !! order for the half; another one if other ranks need the result of the first half
      real(dp), contiguous, intent(inout) :: all_unknowns(:, :) !! the loads, or all unknowns on return (n, loads)
      real(dp), contiguous, intent(inout) :: of_schur(:, :)
         !! the condensed loads, or the Schur variables (n_schur, loads)

      call give_order(order)
      call work%mumps%solve(order == order_backward, all_unknowns, of_schur)
      if (work%mumps%report%code >= 0) return
      all_unknowns = ieee_value(1.0_dp, ieee_quiet_nan)
      of_schur = ieee_value(1.0_dp, ieee_quiet_nan)
   end subroutine half_solve

   !> Frees the memory on all ranks.
   subroutine distributed_free(self)
      type(distributed_condenser_t), intent(inout) :: self !! the condenser

      if (rank > 0 .or. self%n == 0 .or. .not. allocated(work)) return
      call give_order(order_free)
      call work%mumps%free()
      deallocate (work)
   end subroutine distributed_free

   !> Assembles the stiffness of the subdomain, and on rank 0 the diagonal of the whole matrix, the sums of magnitudes
   !> of its columns and its products with the known solutions; where subdomains meet, the magnitudes are those of the
   !> parts.
   subroutine rank_work_assemble(self, sums, error)
      class(rank_work_t), intent(inout) :: self !! the work; its subdomain not prepared yet
      real(dp), intent(inout) :: sums(:, :)
         !! diagonal entry, sum of magnitudes and two products of each column (4, n) [F/L]
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp), allocatable :: own(:, :), known(:, :)
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
         allocate (own(4, matrix%n), source=0.0_dp)
         known = transpose(known_solutions(self%subdomain%unknown))
         call matrix%multiply(known, own(3:, :))
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

   !> Analyzes the matrix with MUMPS; rank 0 adds a shift to the diagonal entries of the Schur variables.
   subroutine rank_work_analyze(self, shift, position, error)
      class(rank_work_t), intent(inout) :: self !! the work, its subdomain assembled
      real(dp), intent(in) :: shift(:) !! addition to the diagonal entries of the Schur variables (n_schur) [F/L]
      integer, intent(inout) :: position(:) !! position of each unknown (n)
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer(int64) :: at
      integer :: j, n

      n = size(position)
      associate (matrix => self%stiffness, unknown => self%unknown)
         allocate (self%column(size(matrix%row, kind=int64)))
         do j = 1, matrix%n
            at = matrix%column_start(j)
            if (rank == 0 .and. unknown(j) > n - size(shift)) matrix%value(at) = matrix%value(at) &
               + shift(unknown(j) - n + size(shift))
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
      call self%mumps%analyze(n, self%row, self%column, size(shift), position, error)
   end subroutine rank_work_analyze

   !> Refuses a task for which the memory of a machine does not suffice for all of its ranks.
   subroutine check_room(what, own_mb, error)
      character(*), intent(in) :: what !! the task that takes the memory
      real(dp), intent(in) :: own_mb !! memory of the task on this rank [MB]
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

end module amontons_distributed
