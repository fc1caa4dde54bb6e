!> The condensation of a body: from its factorised stiffness to the contact problem, and back to all displacements.
!>
!> With the contact unknowns c last, the trailing block of the Cholesky factor of K + alpha E (E the identity on c) is
!> the Cholesky factor of S + alpha I, S = K_cc - K_ci K_ii^-1 K_ic; alpha is 0 for a body that its supports hold.
!> A forward substitution gives q = f_c - K_ci K_ii^-1 f_i, a backward one all displacements (theory, section 3).
module amontons_condensation
   use amontons_constraints, only: constraints_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dof_map, only: dof_map_t
   use amontons_error, only: error_t
   use amontons_factorization, only: factorization_t
   use amontons_kinds, only: dp
   use amontons_new_factorization, only: analyze_matrix
   use amontons_sparse_matrix, only: sparse_matrix_t
   implicit none (type, external)
   private

   public :: condensation_t, new_condensation

   !> The factorised body and the map between contact unknowns and normal and tangential displacements.
   type :: condensation_t
      class(factorization_t), allocatable :: factorization !! of K + alpha E
      real(dp) :: alpha = 0.0_dp !! shift on the contact unknowns [F/L]
      real(dp), allocatable, private :: partial(:) !! the load after the forward substitution (n)
      integer, allocatable, private :: unknown(:, :) !! the point's places among the contact unknowns, 0 for none (2, m)
      real(dp), allocatable, private :: map(:, :, :) !! unknowns of a point = map (u_N, u_T) (2, 2, m) [-]
   contains
      procedure :: condense_load => condensation_condense_load
      procedure :: condense_stiffness => condensation_condense_stiffness
      procedure :: recover => condensation_recover
   end type condensation_t

contains

   !> Factorises the stiffness of a body.
   subroutine new_condensation(condensation, stiffness, kind, is_held, zone, constraints, dof_map, error)
      type(condensation_t), intent(out) :: condensation !! the factorised body
      type(sparse_matrix_t), intent(inout) :: stiffness !! K; given up before the factor is made, to save memory [F/L]
      character(*), intent(in) :: kind !! which factorisation, one of `factorization_names`
      logical, intent(in) :: is_held !! whether supports alone hold the body
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns, those of the points last
      type(error_t), allocatable, intent(out) :: error !! K is not positive definite, or memory ran out

      if (.not. is_held) then
         condensation%alpha = sum(stiffness%diagonal())/dof_map%n_dofs
         call stiffness%shift_diagonal(dof_map%n_dofs - dof_map%n_trailing + 1, dof_map%n_dofs, condensation%alpha)
      end if
      call analyze_matrix(condensation%factorization, kind, stiffness, dof_map%n_trailing, error)
      if (allocated(error)) return
      stiffness = sparse_matrix_t()
      call condensation%factorization%check_memory(error)
      if (allocated(error)) return
      call condensation%factorization%complete(error)
      if (allocated(error)) return
      call map_points(condensation, zone, constraints, dof_map)
   end subroutine new_condensation

   !> Finds the unknowns of every point and the map from (u_N, u_T) to them.
   !>
   !> A point that a support guides along one direction e has one unknown, u_N / (n . e); the support bears the
   !> tangential force, and u_T has no part in the problem.
   pure subroutine map_points(condensation, zone, constraints, dof_map)
      type(condensation_t), intent(inout) :: condensation !! the condensation
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      real(dp) :: frame(2, 2), normal(2)
      integer :: p, first, axis

      first = dof_map%n_dofs - dof_map%n_trailing
      allocate (condensation%unknown(2, zone%n_points), source=0)
      allocate (condensation%map(2, 2, zone%n_points), source=0.0_dp)
      do p = 1, zone%n_points
         frame = constraints%frame(zone%node(p))
         normal = zone%normal(:, p)
         if (zone%is_guided(p)) then
            axis = findloc(dof_map%dof(:, zone%node(p)) > 0, .true., dim=1)
            condensation%unknown(1, p) = dof_map%dof(axis, zone%node(p)) - first
            condensation%map(1, 1, p) = 1.0_dp/dot_product(normal, frame(:, axis))
         else
            condensation%unknown(:, p) = dof_map%dof(:, zone%node(p)) - first
            condensation%map(:, 1, p) = matmul(normal, frame)
            condensation%map(:, 2, p) = matmul([-normal(2), normal(1)], frame)
         end if
      end do
   end subroutine map_points

   !> The condensed stiffness S on (u_N; u_T). The tangential row of a guided point, which has no unknown, becomes that
   !> of a spring of its own that nothing loads: its slip and shear are zero.
   subroutine condensation_condense_stiffness(self, stiffness)
      class(condensation_t), intent(in) :: self !! the factorised body
      real(dp), allocatable, intent(out) :: stiffness(:, :) !! S (2m, 2m) [F/L]
      real(dp), allocatable :: schur(:, :)
      real(dp) :: block(2, 2)
      integer :: p, r, m, i, j

      m = size(self%unknown, 2)
      allocate (schur(count(self%unknown > 0), count(self%unknown > 0)), stiffness(2*m, 2*m))
      call self%factorization%schur_complement(schur)
      do i = 1, size(schur, 1)
         schur(i, i) = schur(i, i) - self%alpha
      end do
      do r = 1, m
         do p = 1, m
            block = 0.0_dp
            do j = 1, count(self%unknown(:, r) > 0)
               do i = 1, count(self%unknown(:, p) > 0)
                  block(i, j) = schur(self%unknown(i, p), self%unknown(j, r))
               end do
            end do
            block = matmul(transpose(self%map(:, :, p)), matmul(block, self%map(:, :, r)))
            stiffness([p, p + m], [r, r + m]) = block
         end do
         if (self%unknown(2, r) == 0) stiffness(r + m, r + m) = stiffness(r, r)
      end do
   end subroutine condensation_condense_stiffness

   !> Condenses a load to the contact points; `recover` then belongs to this load.
   subroutine condensation_condense_load(self, load, condensed)
      class(condensation_t), intent(inout) :: self !! the factorised body
      real(dp), intent(in) :: load(:) !! load on all unknowns (n) [F]
      real(dp), allocatable, intent(out) :: condensed(:) !! q on (u_N; u_T) (2m) [F]
      real(dp), allocatable :: q(:)
      integer :: p, m, n

      m = size(self%unknown, 2)
      if (.not. allocated(self%partial)) allocate (self%partial(size(load)))
      allocate (q(count(self%unknown > 0)))
      call self%factorization%condense(load, self%partial, q)
      allocate (condensed(2*m), source=0.0_dp)
      do p = 1, m
         n = count(self%unknown(:, p) > 0)
         condensed([p, p + m]) = matmul(q(self%unknown(:n, p)), self%map(:n, :, p))
      end do
   end subroutine condensation_condense_load

   !> All unknowns from the displacements of the contact points, for the load condensed last.
   subroutine condensation_recover(self, displacement, unknowns)
      class(condensation_t), intent(in) :: self !! the factorised body
      real(dp), intent(in) :: displacement(:) !! (u_N; u_T) without prescribed parts (2m) [L]
      real(dp), allocatable, intent(out) :: unknowns(:) !! all unknowns (n) [L]
      real(dp) :: v(count(self%unknown > 0))
      integer :: p, m, n

      m = size(self%unknown, 2)
      do p = 1, m
         n = count(self%unknown(:, p) > 0)
         v(self%unknown(:n, p)) = matmul(self%map(:n, :, p), displacement([p, p + m]))
      end do
      allocate (unknowns(size(self%partial)))
      call self%factorization%expand(self%partial, v, unknowns)
   end subroutine condensation_recover

end module amontons_condensation
