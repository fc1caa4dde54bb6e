!> The condensation of a body: from its factorized stiffness to the contact problem, and back to all displacements.
!>
!> The contact unknowns c are the Schur variables of K + alpha E (E the identity on c), whose Schur complement is
!> S + alpha I, S = K_cc - K_ci K_ii^-1 K_ic; alpha is 0 for a body that its supports hold. The condensed load is
!> q = f_c - K_ci K_ii^-1 f_i (theory, section 3).
!> This is the paper's static condensation, "computing u from (2.1) and substituting u into (2.2)", without K^-1 and
!> for bodies whose K is singular, as that of its own example is (erratum 6).
!> Where a point is a cell of constant multipliers, S and q are condensed once more, to the mean displacements.
!>
!> For a slender body with a long contact line S would take far more time and memory than the body: it is left a band
!> matrix of the whole body then.
!>
!> The choice between a dense condensed stiffness and a band matrix of the whole body, and the order of that band.
!>
!> The condensation of displacements v to rows w = C v: the least energy of all v with the same w.
!>
!> Of `min v.S v/2 - q.v with C v = w` the value is w.T w/2 - p.w + const, with T = G^-1 - R, p = G^-1 C M^-1 q,
!> G = C M^-1 C^T and M = S + C^T R C for any diagonal R that makes M definite. Equilibrium S v = q - C^T lambda is then
!> `T w = p - lambda`, exactly, also where S is only semidefinite: the kernel of T is C times that of S. Motions r of
!> this kernel that no row notices, C r = 0, take no part: M gains a multiple of r r^T for each, which changes neither T
!> nor p, and leaves out their displacements.
!>
!> Rows that depend on each other, as those of a corner between two obstacles, get springs between the body and the
!> multipliers: w = C v - E lambda with E = s R^-1 and a share s. Then T = (G_s^-1 - R)/(1 - s) and p = G_s^-1 C M^-1 q
!> with G_s = (1 - s) G + s R^-1, the kernel of T is the same, and S v = q - C^T lambda exactly. The solution of the
!> contact problem takes the springs out again (`solve_components`).
module amontons_condensation
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_condenser, only: cholesky_t, condenser_t
   use amontons_constraints, only: constraints_t, dof_map_t
   use amontons_contact_operator, only: band_stiffness_t, contact_operator_t, new_band_operator, new_band_stiffness, &
      new_stiffness_operator
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: allocate_matrix, cholesky_factor, cholesky_inverse, cholesky_solve, small_inverse, &
      squares, triangular_solve
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp
   use amontons_new_cholesky, only: new_cholesky
   use amontons_sparse_matrix, only: entries_t, half_bandwidth, reverse_cuthill_mckee, sparse_matrix_t
   implicit none (type, external)
   private

   public :: condensation_names, condensation_options_t, condensation_t, condensed_load_t, find_band_order, &
      may_suit_band, new_condensation, new_distributed_condensation, new_flexibility, &
      new_row_condensation, row_condensation_t

   !> Largest rounding error of the square of a row that depends on others [-].
   real(dp), parameter, public :: dependent_row = 1.0e-12_dp
   !> Share of the compliance of such rows that springs have between body and multipliers. The means over a few cells
   !> may follow rigid motions only, and then have no stiffness; other means have a larger share.
   real(dp), parameter, public :: spring_share = 1.0e-3_dp

   !> The condensation of displacements to rows w = C v: it condenses loads and recovers displacements.
   type :: row_condensation_t
      real(dp) :: least_augmentation = 0.0_dp !! a small share of the least entry of R [F/L]
      type(entries_t), private :: rows !! C (r, n) [-]
      real(dp), allocatable, private :: factor(:, :) !! Cholesky factor of M (n, n)
      real(dp), allocatable, private :: of_rows(:, :) !! Cholesky factor of G_s (r, r)
      real(dp), private :: share = 0.0_dp !! s: 0 where the rows are independent [-]
      real(dp), allocatable :: softness(:) !! E, not allocated where the rows are independent (r) [L/F]
   contains
      procedure :: condense => row_condensation_condense
      procedure :: expand => row_condensation_expand
   end type row_condensation_t

   !> Time of an operation on a band matrix over that of one on a dense matrix; a round number.
   real(dp), parameter :: slowness = 50.0_dp

   !> Forms of the condensed stiffness, as a deck writes them; the first one chooses the faster of the other two.
   character(5), parameter :: condensation_names(*) = [character(5) :: 'auto', 'dense', 'band']

   !> Options of the condensation.
   type :: condensation_options_t
      character(13) :: factorization = 'auto' !! one of `factorization_names`
      character(5) :: form = 'auto' !! form of the condensed stiffness, one of `condensation_names`
   end type condensation_options_t

   !> A condensed load q, with the vectors that `recover` needs of the load.
   type :: condensed_load_t
      real(dp), allocatable :: load(:) !! q on (u_N; u_T) of the points (components m) [F]
      real(dp), allocatable, private :: partial(:)
         !! partial result of the condenser; with a band, the load itself (n)
      real(dp), allocatable, private :: contact_load(:) !! q on the contact unknowns and those behind them (n_schur) [F]
   contains
      procedure :: add => condensed_load_add
   end type condensed_load_t

   !> The factorized body and the map between contact unknowns and normal and tangential displacements.
   type :: condensation_t
      class(condenser_t), allocatable :: condenser !! of K, or of K + D_c for a body that supports alone do not hold
      real(dp), allocatable, private :: diagonal(:)
         !! D_c: diagonal entries of K of the contact unknowns and those behind them (n_schur) [F/L]
      type(contact_operator_t), pointer :: matrix => null() !! S, which the contact problems of the body point to
      integer, private :: n_unknowns = 0 !! number of contact unknowns
      logical, allocatable :: is_locked(:) !! whether each unknown behind these stays at 0, and is not eliminated
      integer, allocatable, private :: eliminated(:) !! places of those that are
      real(dp), allocatable, private :: whole(:, :)
         !! Schur complement with them; not allocated without any (n_schur, n_schur) [F/L]
      real(dp), allocatable, private :: own_factor(:, :) !! Cholesky factor of their block S_ee
      real(dp), allocatable, private :: lifting(:, :) !! S_ee^-1 S_ec (eliminated, n_unknowns) [-]
      integer, allocatable, private :: unknown(:, :)
         !! the place of each point's displacements among the contact unknowns or, with cells, the rows of C; 0 for none
         !! (components, m)
      real(dp), allocatable, private :: map(:, :, :)
         !! unknowns of a point = map (u_N, u_T) (components, components, m) [-]
      ! Allocatable: gfortran 12 does not empty the list of a condensation that is made anew.
      type(entries_t), allocatable, private :: rows !! C, unless all points have own unknowns (any, n_unknowns) [-]
      integer, allocatable, private :: next(:) !! the point that follows along the line of its set, 0 for none (m)
      real(dp), allocatable :: unnoticed(:, :)
         !! rigid motions of the contact unknowns that no row of C notices; none unless they are set (n_unknowns, any)
         !! [-]
      type(row_condensation_t), private :: to_rows !! the condensation to C v, if there are rows
      real(dp), allocatable :: softness(:)
         !! springs between (u_N; u_T) and the multipliers; not allocated where rows are independent (components m)
         !! [L/F]
      logical :: is_held = .true. !! whether supports alone hold the body
   contains
      procedure :: condense_load => condensation_condense_load
      procedure :: condense_stiffness => condensation_condense_stiffness
      procedure :: recover => condensation_recover
      procedure, private :: eliminate => condensation_eliminate
      procedure, private :: reduced => condensation_reduced
      final :: condensation_free
   end type condensation_t

contains

   !> Factorizes the stiffness of a body.
   subroutine new_condensation(condensation, stiffness, options, is_held, zone, constraints, dof_map, error)
      type(condensation_t), intent(out) :: condensation !! the factorized body
      type(sparse_matrix_t), intent(inout) :: stiffness !! K; given up before the factor is made, to save memory [F/L]
      type(condensation_options_t), intent(in) :: options !! options of the condensation
      logical, intent(in) :: is_held !! whether supports alone hold the body
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns, those of the points last
      type(error_t), allocatable, intent(out) :: error !! K is not finite or positive definite, or memory ran out
      class(cholesky_t), allocatable :: cholesky
      type(band_stiffness_t), allocatable :: band
      type(error_t), allocatable :: band_error
      integer, allocatable :: order(:)
      integer :: i

      condensation%diagonal = stiffness%diagonal()
      call map_unknowns(condensation, sum(condensation%diagonal), is_held, zone, constraints, dof_map, error)
      if (allocated(error)) return
      if (dof_map%n_lockable == 0) call find_band_order(stiffness, options%form, zone, order)
      if (allocated(order)) then
         allocate (band)
         call new_band_stiffness(band, stiffness, order, condensation%unknown, condensation%map, band_error)
         if (.not. allocated(band_error)) call new_band_operator(condensation%matrix, band, is_held)
      end if
      condensation%diagonal = condensation%diagonal(dof_map%n_dofs - dof_map%n_schur + 1:)
      do i = 1, merge(0, dof_map%n_schur, is_held)
         associate (unknown => dof_map%n_dofs - dof_map%n_schur + i)
            call stiffness%shift_diagonal(unknown, unknown, condensation%diagonal(i))
         end associate
      end do
      call new_cholesky(cholesky, trim(options%factorization), stiffness, merge(0, dof_map%n_schur, allocated(order)), &
         error)
      if (allocated(error)) return
      call move_alloc(cholesky, condensation%condenser)
      stiffness = sparse_matrix_t()
      call condensation%condenser%check_memory(error)
      if (allocated(error)) return
      call condensation%condenser%complete(error)
      if (allocated(error)) return
      if (allocated(band_error)) call move_alloc(band_error, error)
   end subroutine new_condensation

   !> Makes the condensation of a body that is spread over ranks of its condenser.
   subroutine new_distributed_condensation(condensation, condenser, is_held, zone, constraints, dof_map, error)
      type(condensation_t), intent(out) :: condensation !! the factorized body
      class(condenser_t), allocatable, intent(inout) :: condenser !! has the stiffness; moved into the condensation
      logical, intent(in) :: is_held !! whether supports alone hold the body
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns, those of the points last
      type(error_t), allocatable, intent(out) :: error !! as of `new_condensation`

      call move_alloc(condenser, condensation%condenser)
      condensation%diagonal = condensation%condenser%schur_diagonal
      call map_unknowns(condensation, condensation%condenser%matrix_norm, is_held, zone, constraints, dof_map, error)
      if (.not. allocated(error)) call condensation%condenser%check_memory(error)
      if (.not. allocated(error)) call condensation%condenser%complete(error)
   end subroutine new_distributed_condensation

   !> Maps the contact unknowns to the points.
   subroutine map_unknowns(condensation, size_of_stiffness, is_held, zone, constraints, dof_map, error)
      type(condensation_t), intent(inout) :: condensation !! gains the maps
      real(dp), intent(in) :: size_of_stiffness !! a norm of K, or the sum of its diagonal [F/L]
      logical, intent(in) :: is_held !! whether supports alone hold the body
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! K is not finite
      real(dp), allocatable :: transform(:, :)
      real(dp), dimension(size(dof_map%dof, 1), size(dof_map%dof, 1)) :: of_own
      logical :: is_fixed(zone%n_rows)
      integer, allocatable :: own(:), axes(:)
      integer :: p, i, k, n_own, axis, l, column, first

      if (.not. ieee_is_finite(size_of_stiffness)) then
         call new_error(error, numerical_failure, 'the stiffness leaves the range of double precision (1.8e308): '// &
            'choose units that make lengths and moduli smaller')
         return
      end if
      condensation%is_held = is_held
      allocate (condensation%matrix)
      condensation%n_unknowns = dof_map%n_schur - dof_map%n_lockable
      allocate (condensation%unnoticed(condensation%n_unknowns, 0))
      allocate (condensation%is_locked(dof_map%n_lockable), source=.false.)
      associate (n => size(dof_map%dof, 1))
         allocate (condensation%unknown(n, zone%n_points), source=0)
         allocate (condensation%map(n, n, zone%n_points), source=0.0_dp)
      end associate
      if (.not. all(zone%is_own)) then
         ! The rows of C on the contact unknowns. A slip that a support prevents has no row.
         is_fixed = [spread(.false., 1, zone%n_points), transpose(zone%is_fixed)]
         n_own = size(dof_map%dof, 1)
         do p = 1, zone%n_points
            do k = 1, n_own
               condensation%map(k, k, p) = 1.0_dp
               if (.not. is_fixed(p + (k - 1)*zone%n_points)) condensation%unknown(k, p) = &
                  maxval(condensation%unknown) + 1
            end do
         end do
         condensation%next = spread(0, 1, zone%n_points)
         if (allocated(zone%line)) condensation%next = zone%line%next
         allocate (condensation%rows)
         do p = 1, zone%n_points
            do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
               own = dof_map%substitution%element_nodes(zone%rows%node(i:i))
               transform = dof_map%substitution%transform(zone%rows%node(i:i), own, 1, n_own)
               do k = 1, size(own)
                  of_own = matmul(transpose(transform(:, n_own*(k - 1) + 1:n_own*k)), &
                     zone%rows%block(:, :, i))
                  do axis = 1, n_own
                     if (dof_map%dof(axis, own(k)) == 0) cycle
                     column = dof_map%dof(axis, own(k)) - dof_map%n_dofs + dof_map%n_schur
                     ! Coefficients of other nodes' unknowns in the row of a point with unknowns of its own are rounding
                     ! errors below this share.
                     if (column < 1 .or. column > condensation%n_unknowns) cycle
                     do l = 1, n_own
                        call condensation%rows%add(condensation%unknown(l, p), column, &
                           dot_product(of_own(:, l), constraints%frame(:, axis, own(k))))
                     end do
                  end do
               end do
            end do
         end do
      else
         ! The unknowns of every point and the map from (u_N, u_T) to them. A point that supports guide along one
         ! direction e has one unknown, u_N / (n . e); they bear the tangential force, and u_T has no part in the
         ! problem. One that is guided in a plane has two, for u_N and the slip along that plane.
         first = dof_map%n_dofs - dof_map%n_schur
         do p = 1, zone%n_points
            associate (frame => constraints%frame(:, :, zone%node(p)), map => condensation%map(:, :, p), &
               unknown => condensation%unknown(:, p))
               unknown = max(0, dof_map%dof(:, zone%node(p)) - first)
               map = matmul(transpose(frame), zone%frame(:, :, p))
               if (.not. any(zone%is_fixed(:size(zone%position, 1) - 1, p))) cycle
               axes = pack([(k, k=1, size(map, 1))], unknown > 0)
               own = pack([(k, k=1, size(map, 1))], [.true., .not. zone%is_fixed(:, p)])
               map = 0.0_dp
               map(own, own) = small_inverse(matmul(transpose(zone%frame(:, own, p)), frame(:, axes)))
               own = unpack(unknown(axes), [.true., .not. zone%is_fixed(:, p)], 0)
               unknown = own
            end associate
         end do
      end if
   end subroutine map_unknowns

   !> Makes the condensed stiffness S on (u_N; u_T), unless it is a band. The tangential row of a point whose slip a
   !> support prevents becomes that of a spring of its own that nothing loads: its slip and shear are zero.
   subroutine condensation_condense_stiffness(self, error)
      class(condensation_t), intent(inout) :: self !! the factorized body; gains S
      type(error_t), allocatable, intent(out) :: error !! the cells of constant multipliers are too small, or no memory
      real(dp), allocatable :: schur(:, :), stiffness(:, :), column(:)
      real(dp) :: least
      integer :: p, r, m, n, n_schur, i, j, k, row

      if (allocated(self%matrix%band)) return
      n = size(self%unknown, 1)
      m = size(self%unknown, 2)
      n_schur = self%n_unknowns + size(self%is_locked)
      call allocate_matrix(schur, n_schur, n_schur, 'the contact unknowns', error)
      if (allocated(error)) return
      if (allocated(self%whole)) then
         schur(:, :) = self%whole
      else
         call self%condenser%schur_complement(schur)
         if (.not. self%is_held) then
            do i = 1, size(schur, 1)
               schur(i, i) = schur(i, i) - self%diagonal(i)
            end do
         end if
      end if
      if (size(self%is_locked) > 0) call self%eliminate(schur, error)
      if (allocated(error)) return
      least = 0.0_dp
      if (allocated(self%rows)) then
         call new_row_condensation(self%to_rows, schur, self%diagonal(:size(schur, 1)), self%rows, self%unknown, &
            self%next, self%unnoticed, error)
         if (allocated(error)) return
         least = self%to_rows%least_augmentation
         if (allocated(self%softness)) deallocate (self%softness)
         if (allocated(self%to_rows%softness)) self%softness = [([(merge(self%to_rows%softness(max(1, &
            self%unknown(k, p))), 0.0_dp, self%unknown(k, p) > 0), p=1, m)], k=1, n)]
      end if
      call allocate_matrix(stiffness, n*m, n*m, 'the contact points', error)
      if (allocated(error)) return
      stiffness(:, :) = 0.0_dp
      allocate (column(size(schur, 1)))
      do r = 1, m
         do k = 0, n - 1
            column = 0.0_dp
            do j = 1, n
               if (self%unknown(j, r) > 0) column = column + schur(:, self%unknown(j, r))*self%map(j, k + 1, r)
            end do
            do p = 1, m
               do i = 1, n
                  row = self%unknown(i, p)
                  if (row == 0) cycle
                  do j = 0, n - 1
                     stiffness(p + j*m, r + k*m) = stiffness(p + j*m, r + k*m) + self%map(i, j + 1, p)*column(row)
                  end do
               end do
            end do
            if (self%unknown(k + 1, r) == 0) stiffness(r + k*m, r + k*m) = stiffness(r, r)
         end do
      end do
      call new_stiffness_operator(self%matrix, stiffness, self%is_held, n - 1, least)
   end subroutine condensation_condense_stiffness

   !> Eliminates the unknowns that belong to no contact point and are not locked. The Schur complement with all of them
   !> is kept, so that locking some takes no factorization.
   pure subroutine condensation_eliminate(self, schur, error)
      class(condensation_t), intent(inout) :: self !! the factorized body
      real(dp), allocatable, intent(inout) :: schur(:, :)
         !! the Schur complement with all of them (n_schur, n_schur); on return without any (n_unknowns, n_unknowns)
         !! [F/L]
      type(error_t), allocatable, intent(out) :: error !! nothing holds them
      integer :: i, info

      if (.not. allocated(self%whole)) self%whole = schur
      self%eliminated = pack([(self%n_unknowns + i, i=1, size(self%is_locked))], .not. self%is_locked)
      self%own_factor = schur(self%eliminated, self%eliminated)
      self%lifting = schur(self%eliminated, :self%n_unknowns)
      call cholesky_factor(self%own_factor, info)
      ! not raised: what neither supports nor contact hold was refused before
      if (info /= 0) call new_error(error, numerical_failure, 'nothing holds a rigid set or preload')
      if (allocated(error)) return
      call cholesky_solve(self%own_factor, self%lifting)
      schur = schur(:self%n_unknowns, :self%n_unknowns) - matmul(schur(:self%n_unknowns, self%eliminated), self%lifting)
   end subroutine condensation_eliminate

   !> The load on the contact unknowns after the elimination of those behind them.
   pure function condensation_reduced(self, load) result(reduced)
      class(condensation_t), intent(in) :: self !! the factorized body
      real(dp), intent(in) :: load(:) !! q on all of them (n_schur) [F]
      real(dp), allocatable :: reduced(:)

      reduced = load(:self%n_unknowns)
      if (size(self%is_locked) > 0) reduced = reduced - matmul(load(self%eliminated), self%lifting)
   end function condensation_reduced

   !> Frees the operator of the body and the dense matrices in it.
   subroutine condensation_free(self)
      type(condensation_t), intent(inout) :: self !! the condensation

      if (associated(self%matrix)) deallocate (self%matrix)
   end subroutine condensation_free

   !> Condenses a load to the contact points: q = f_c - K_ci K_ii^-1 f_i in the directions of the points.
   subroutine condensation_condense_load(self, load, condensed)
      class(condensation_t), intent(in) :: self !! the factorized body
      real(dp), intent(in) :: load(:) !! load on all unknowns (n) [F]
      type(condensed_load_t), intent(out) :: condensed !! the condensed load
      real(dp), allocatable :: q(:)
      integer :: p, m, i, k

      m = size(self%unknown, 2)
      if (allocated(self%matrix%band)) then
         condensed%partial = load
         condensed%contact_load = load(size(load) - self%n_unknowns + 1:)
      else
         allocate (condensed%partial(size(load)), condensed%contact_load(self%n_unknowns + size(self%is_locked)))
         call self%condenser%condense(load, condensed%partial, condensed%contact_load)
      end if
      q = self%reduced(condensed%contact_load)
      if (allocated(self%rows)) q = self%to_rows%condense(q)
      allocate (condensed%load(size(self%unknown)), source=0.0_dp)
      do p = 1, m
         do i = 1, size(self%unknown, 1)
            if (self%unknown(i, p) == 0) cycle
            do k = 0, size(self%unknown, 1) - 1
               condensed%load(p + k*m) = condensed%load(p + k*m) + q(self%unknown(i, p))*self%map(i, k + 1, p)
            end do
         end do
      end do
      if (.not. allocated(self%matrix%band)) return
      condensed%load = self%matrix%band%condensed(load(:size(load) - self%n_unknowns), condensed%load)
   end subroutine condensation_condense_load

   !> Adds a multiple of another condensed load of the same body; condensation is linear.
   pure subroutine condensed_load_add(self, factor, other)
      class(condensed_load_t), intent(inout) :: self !! the condensed load
      real(dp), intent(in) :: factor !! factor of the other load [-]
      type(condensed_load_t), intent(in) :: other !! the other load

      self%load = self%load + factor*other%load
      self%partial = self%partial + factor*other%partial
      self%contact_load = self%contact_load + factor*other%contact_load
   end subroutine condensed_load_add

   !> Computes all unknowns from the displacements of the contact points under several loads, with one pass over the
   !> factor.
   subroutine condensation_recover(self, condensed, displacement, unknowns)
      class(condensation_t), intent(in) :: self !! the factorized body
      type(condensed_load_t), intent(in) :: condensed(:) !! the condensed loads
      real(dp), intent(in) :: displacement(:, :) !! (u_N; u_T) without prescribed parts (components m, loads) [L]
      real(dp), allocatable, intent(out) :: unknowns(:, :) !! all unknowns (n, loads) [L]
      real(dp), allocatable :: partial(:, :), v(:, :), own(:)
      real(dp) :: of_points(count(self%unknown > 0))
      integer :: k, l, m, n, p

      n = self%condenser%n
      m = size(self%unknown, 2)
      allocate (unknowns(n, size(condensed)), partial(n, size(condensed)))
      allocate (v(self%n_unknowns + size(self%is_locked), size(condensed)), source=0.0_dp)
      do k = 1, size(condensed)
         partial(:, k) = condensed(k)%partial
         do p = 1, m
            do l = 1, size(self%unknown, 1)
               if (self%unknown(l, p) > 0) of_points(self%unknown(l, p)) = dot_product(self%map(l, :, p), &
                  displacement(p::m, k))
            end do
         end do
         if (allocated(self%rows)) then
            v(:self%n_unknowns, k) = self%to_rows%expand(self%reduced(condensed(k)%contact_load), of_points)
         else
            v(:self%n_unknowns, k) = of_points
         end if
         if (size(self%is_locked) > 0) then
            own = condensed(k)%contact_load(self%eliminated)
            call cholesky_solve(self%own_factor, own)
            v(self%eliminated, k) = own - matmul(self%lifting, v(:self%n_unknowns, k))
         end if
         if (allocated(self%matrix%band)) unknowns(:, k) = [self%matrix%band%interior_displacement( &
            partial(:n - self%n_unknowns, k), displacement(:, k)), v(:, k)]
      end do
      if (.not. allocated(self%matrix%band)) call self%condenser%expand_all(partial, v, unknowns)
   end subroutine condensation_recover

   !> Finds an order that makes K a narrow band, if S is to be represented by the band matrix of the whole body: on
   !> request, or if Newton's method is much faster with it. A step takes about 4 n w^2 operations with n rows of half
   !> width w, against 2/3 m^3 faster ones, or a few times as many, with a dense S; w is at least about the number of
   !> unknowns per contact point. With few points the friction bound is computed, which needs a dense S anyway; cells of
   !> constant multipliers cannot be represented in a band.
   pure subroutine find_band_order(matrix, form, zone, order)
      type(sparse_matrix_t), intent(in) :: matrix !! K [F/L]
      character(*), intent(in) :: form !! which form of S, one of `condensation_names`
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, allocatable, intent(out) :: order(:) !! position k holds unknown order(k); allocated if it suits (n)

      if (.not. may_suit_band(matrix%n, form, zone)) return
      allocate (order(matrix%n))
      call reverse_cuthill_mckee(matrix, 0, order)
      if (form == 'band') return
      associate (half_width => real(half_bandwidth(matrix, order), dp))
         if (slowness*matrix%n*half_width**2 > real(zone%n_points, dp)**3) deallocate (order)
      end associate
   end subroutine find_band_order

   !> Whether the number of unknowns permits a band at all.
   pure logical function may_suit_band(n_unknowns, form, zone)
      integer, intent(in) :: n_unknowns !! number of unknowns
      character(*), intent(in) :: form !! which form of S, one of `condensation_names`
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, parameter :: least_points = 501

      may_suit_band = form /= 'dense' .and. all(zone%is_own) .and. zone%n_tangents == 1
      associate (n => real(n_unknowns, dp), m => real(zone%n_points, dp))
         if (form == 'auto') may_suit_band = may_suit_band .and. zone%n_points >= least_points &
            .and. .not. slowness*n*(n/m)**2 > m**3
      end associate
   end function may_suit_band

   !> Inverts S, of a body with free motions S and a multiple of their squares, part by part: bodies have no entries in
   !> common.
   pure subroutine new_flexibility(flexibility, matrix, n_points, motions, error)
      real(dp), allocatable, intent(out) :: flexibility(:, :) !! the inverse (n, n) [L/F]
      type(contact_operator_t), intent(in) :: matrix !! S (n, n), dense [F/L]
      integer, intent(in) :: n_points !! number of points that it is of
      real(dp), intent(in) :: motions(:, :) !! the free motions, orthonormal (n, any) [-]
      type(error_t), allocatable, intent(out) :: error !! S is not positive definite beside them, or memory ran out
      real(dp), allocatable :: own(:, :)
      integer, allocatable :: part(:), rows(:)
      real(dp) :: mean
      integer :: i, info, k, n_parts

      call allocate_matrix(flexibility, matrix%n, matrix%n, 'the nodes of the contact sets', error)
      if (allocated(error)) return
      flexibility(:, :) = 0.0_dp
      call matrix%find_parts(n_points, part, n_parts)
      associate (stiffness => matrix%stiffness%values)
         mean = sum([(stiffness(i, i), i=1, matrix%n)])/max(1, matrix%n)
         do k = 1, n_parts
            rows = pack([(i, i=1, matrix%n)], part([(1 + modulo(i - 1, n_points), i=1, matrix%n)]) == k)
            own = stiffness(rows, rows)
            do i = 1, size(rows)
               own(:, i) = own(:, i) + mean*matmul(motions(rows, :), motions(rows(i), :))
            end do
            call cholesky_factor(own, info)
            if (info == 0) call cholesky_inverse(own)
            ! not raised: what neither supports nor contact hold was refused before
            if (info /= 0) call new_error(error, numerical_failure, 'the condensed stiffness of the contact nodes '// &
               'is not positive definite')
            if (allocated(error)) return
            flexibility(rows, rows) = own
         end do
      end associate
   end subroutine new_flexibility

   !> Condenses the stiffness S to rows w = C v: G = C M^-1 C^T with M = S + C^T R C.
   pure subroutine new_row_condensation(condensation, stiffness, whole, rows, of_point, next, unnoticed, error)
      type(row_condensation_t), intent(out) :: condensation !! the condensation
      real(dp), allocatable, intent(inout) :: stiffness(:, :) !! S (n, n); T on return (r, r) [F/L]
      real(dp), intent(in) :: whole(:) !! diagonal of the stiffness that S was condensed from (n) [F/L]
      type(entries_t), intent(in) :: rows !! C (r, n) [-]
      integer, intent(in) :: of_point(:, :) !! the rows of each point, 0 for none (components, m)
      integer, intent(in) :: next(:) !! the point that follows along the line of its set, 0 for none (m)
      real(dp), intent(in) :: unnoticed(:, :) !! the motions r (n, any) [-]
      type(error_t), allocatable, intent(out) :: error
         !! the rows leave another part of S's kernel free, or memory ran out
      ! Of the stiffest row of the same point or of one next to it.
      real(dp), parameter :: least_share = 1.0e-3_dp
      real(dp), allocatable :: half(:, :), own(:), rho(:)
      real(dp), dimension(0:size(next)) :: stiffest, around
      integer :: i, k, n, r, info

      n = size(stiffness, 1)
      r = maxval(of_point)
      call allocate_matrix(half, n, r, 'the cells', error)
      if (.not. allocated(error)) call allocate_matrix(condensation%of_rows, r, r, 'the cells', error)
      if (allocated(error)) return
      ! The independence of the rows is tested without S, with whose large condition number rounding would decide.
      half(:, :) = 0.0_dp
      do i = 1, rows%n
         half(rows%column(i), rows%row(i)) = half(rows%column(i), rows%row(i)) + rows%value(i)
      end do
      do i = 1, r
         condensation%of_rows(:, i) = rows%multiply(half(:, i), r)
      end do
      call cholesky_factor(condensation%of_rows, info)
      if (info == 0) info = findloc([(condensation%of_rows(i, i)**2 <= dependent_row*sum(half(:, i)**2), i=1, r)], &
         .true., dim=1)
      if (info /= 0) condensation%share = spring_share
      condensation%rows = rows
      ! Each row is as stiff as the unknowns that it has: the condition of M is then near that of S, and better if only
      ! soft springs hold the body, and no digits of a soft body are lost beside a stiff one.
      own = [(stiffness(i, i), i=1, n)]
      ! All that is left in S of a rigid set that nothing holds is rounding.
      own = max(own, max(condensation%share, sqrt(epsilon(own)))*whole)
      rho = 1.0_dp/[(sum(half(:, i)**2/own), i=1, r)]
      ! A loose body on two mortar points has no stiffness along their normals.
      stiffest = 0.0_dp
      do i = 1, size(next)
         do k = 1, size(of_point, 1)
            if (of_point(k, i) > 0) stiffest(i) = max(stiffest(i), rho(of_point(k, i)))
         end do
      end do
      around = stiffest
      do i = 1, size(next)
         around(i) = max(around(i), stiffest(next(i)))
         around(next(i)) = max(around(next(i)), stiffest(i))
      end do
      do i = 1, size(next)
         do k = 1, size(of_point, 1)
            if (of_point(k, i) > 0) rho(of_point(k, i)) = max(rho(of_point(k, i)), least_share*around(i))
         end do
      end do
      condensation%least_augmentation = spring_share*minval(rho)
      call move_alloc(stiffness, condensation%factor)
      associate (m => condensation%factor)
         do i = 1, rows%n
            m(:, rows%column(i)) = m(:, rows%column(i)) + rho(rows%row(i))*rows%value(i)*half(:, rows%row(i))
         end do
         if (size(unnoticed, 2) > 0) then
            do i = 1, n
               m(:, i) = m(:, i) + sum(own)/sum(unnoticed**2)*matmul(unnoticed, unnoticed(i, :))
            end do
         end if
         call cholesky_factor(m, info)
         if (info /= 0) then
            call new_error(error, numerical_failure, 'the condensed stiffness of the contact nodes is not positive '// &
               'definite: neither supports nor contact points hold the body')
            return
         end if
         ! G = H^T H with H = L^-1 C^T.
         call triangular_solve(n, r, m, half)
      end associate
      call squares(n, r, half, condensation%of_rows)
      deallocate (half)
      if (condensation%share > 0.0_dp) then
         condensation%softness = condensation%share/rho
         condensation%of_rows(:, :) = (1.0_dp - condensation%share)*condensation%of_rows
         do i = 1, r
            condensation%of_rows(i, i) = condensation%of_rows(i, i) + condensation%softness(i)
         end do
      end if
      call cholesky_factor(condensation%of_rows, info)
      ! not raised: dependent rows have springs
      if (info /= 0) then
         call new_error(error, numerical_failure, 'the contact points are not independent of each other')
         return
      end if
      call allocate_matrix(stiffness, r, r, 'the cells', error)
      if (allocated(error)) return
      stiffness(:, :) = condensation%of_rows
      call cholesky_inverse(stiffness)
      do i = 1, r
         stiffness(i, i) = stiffness(i, i) - rho(i)
      end do
      stiffness(:, :) = stiffness/(1.0_dp - condensation%share)
   end subroutine new_row_condensation

   !> Condenses a load q on the displacements v to the load p = G^-1 C M^-1 q on the means w = C v [F].
   pure function row_condensation_condense(self, load) result(condensed)
      class(row_condensation_t), intent(in) :: self !! the condensation
      real(dp), intent(in) :: load(:) !! q (n) [F]
      real(dp), allocatable :: condensed(:)
      real(dp) :: displacement(size(load))

      displacement = load
      call cholesky_solve(self%factor, displacement)
      condensed = self%rows%multiply(displacement, size(self%of_rows, 1))
      call cholesky_solve(self%of_rows, condensed)
   end function row_condensation_condense

   !> The displacements v of least energy with C v = w: M v = q + C^T G^-1 (w - C M^-1 q) [L].
   pure function row_condensation_expand(self, load, values) result(displacement)
      class(row_condensation_t), intent(in) :: self !! the condensation
      real(dp), intent(in) :: load(:) !! q (n) [F]
      real(dp), intent(in) :: values(:) !! w (r) [L]
      real(dp), allocatable :: displacement(:)
      real(dp) :: force(size(values))

      displacement = load
      call cholesky_solve(self%factor, displacement)
      force = values - (1.0_dp - self%share)*self%rows%multiply(displacement, size(values))
      call cholesky_solve(self%of_rows, force)
      displacement = load + self%rows%multiply_transposed(force, size(load))
      call cholesky_solve(self%factor, displacement)
   end function row_condensation_expand

end module amontons_condensation
