!> What displacements and contact forces leave unbalanced in the whole body, and the displacements of all nodes from
!> those of the contact points. Rigid motions cause no elastic forces: they are recovered apart from the rest.
! allow(S271): gfortran 12 fails if the modules are in order
module amontons_equilibrium
   use amontons_assembly, only: from_unknowns, to_unknowns
   use amontons_body, only: body_t
   use amontons_condensation, only: condensed_load_t
   use amontons_cone, only: least_squares
   use amontons_kinds, only: dp
   use amontons_rigid_motion, only: displacement_of_nodes, rigid_motions_t
   use amontons_load_family, only: load_case_t, recover_displacement
   use amontons_rounding, only: sum_rounding
   implicit none (type, external)
   private

   public :: imbalance_of_points, recover_with_travel, travel_of_nodes

contains

   !> Computes the displacements of all nodes from the solution of the contact problem. The free rigid motion in it is
   !> recovered apart from the rest, which so keeps its digits; a step of refinement follows.
   subroutine recover_with_travel(displacement, body, load_case, solution, force)
      real(dp), allocatable, intent(out) :: displacement(:, :) !! displacements of all nodes (components, n_nodes) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case, condensed
      real(dp), intent(in) :: solution(:) !! displacements v of the contact problem (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp) :: amounts(size(body%rigid_modes, 2))

      amounts = 0.0_dp
      if (.not. body%is_motion_strained) amounts = least_squares(body%rigid_modes, solution)
      call recover_displacement(displacement, body, load_case, solution - matmul(body%rigid_modes, amounts), force)
      displacement = displacement + displacement_of_nodes(body%motions, body%mesh%coordinates, amounts)
      call refine_displacement(displacement, body, load_case, force)
   end subroutine recover_with_travel

   !> Improves displacements by a step of iterative refinement with those of the contact points as they are, if the
   !> others need it and it leaves less imbalance. A stiff body that supports move by far more than it is strained would
   !> otherwise keep forces of rounding size, as large as those of a soft body that it presses.
   subroutine refine_displacement(displacement, body, load_case, force)
      real(dp), allocatable, intent(inout) :: displacement(:, :) !! displacements of all nodes (components, n_nodes) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      type(condensed_load_t) :: rest
      real(dp), allocatable :: lacking(:), strained(:), refined(:, :), unknowns(:, :)

      lacking = imbalance(body, load_case, displacement, force)
      if (norm2(lacking) <= sum_rounding*max(load_case%uncanceled(1), norm2(force))) return
      call body%condensation%condense_load(lacking, rest)
      strained = 0.0_dp*force
      if (allocated(body%condensation%softness)) strained = -body%condensation%softness*rest%load
      call body%condensation%recover([rest], spread(strained, 2, 1), unknowns)
      refined = displacement + from_unknowns(unknowns(:, 1), 0.0_dp*displacement, body%constraints, body%dof_map)
      if (norm2(imbalance(body, load_case, refined, force)) < norm2(lacking)) displacement = refined
   end subroutine refine_displacement

   !> The load q - S v - lambda that contact displacements and forces leave unbalanced, from the strains of the whole
   !> body: S itself, and q, have the rounding errors of the factorization (n_rows) [F].
   function imbalance_of_points(body, load_case, solution, force) result(lacking)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case, condensed
      real(dp), intent(in) :: solution(:)
         !! displacements v of the contact problem, which may be counted from a free rigid motion (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), allocatable :: lacking(:)
      type(condensed_load_t) :: rest
      real(dp), allocatable :: displacement(:, :)

      call recover_displacement(displacement, body, load_case, solution, force)
      call body%condensation%condense_load(imbalance(body, load_case, displacement, force), rest)
      lacking = rest%load
   end function imbalance_of_points

   !> Loads and contact forces less the forces of stresses and springs on all unknowns (n) [F].
   function imbalance(body, load_case, displacement, force)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), allocatable :: imbalance(:), internal(:, :)

      call body%internal_forces(internal, displacement, load_case%element_load)
      imbalance = to_unknowns(load_case%force + body%retained%rows%forces(force, body%mesh%n_nodes) &
         - internal, body%constraints, body%dof_map)
   end function imbalance

   !> The rigid motion of each piece that is closest to the displacements of its nodes, by least squares (components,
   !> n_nodes) [L].
   function travel_of_nodes(free, coordinates, displacement) result(travel)
      type(rigid_motions_t), intent(in) :: free(:) !! the motions of each piece that are free
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (components, n_nodes) [L]
      real(dp), allocatable :: travel(:, :)
      real(dp), allocatable :: modes(:, :)
      integer :: i, j, n

      allocate (travel, source=0.0_dp*displacement)
      do j = 1, size(free)
         associate (motions => free(j))
            if (motions%n_free == 0) cycle
            n = size(displacement, 1)
            allocate (modes(n*size(motions%node), motions%n_free))
            do i = 1, size(motions%node)
               modes(n*(i - 1) + 1:n*i, :) = motions%displacement(coordinates(:, motions%node(i)), motions%node(i))
            end do
            travel(:, motions%node) = reshape(matmul(modes, least_squares(modes, &
               reshape(displacement(:, motions%node), [size(modes, 1)]))), [n, size(motions%node)])
            deallocate (modes)
         end associate
      end do
   end function travel_of_nodes

end module amontons_equilibrium
