!> Error estimate of a solved case: from its displacements and contact forces the error of its stresses, with what is
!> known on the boundary: loads, free sides, and the contact stresses.
module amontons_case_error
   use amontons_body, only: body_t
   use amontons_boundary, only: boundary_line_t, new_boundary_line
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_load_case, only: load_case_t
   use amontons_recovery_tables, only: known_tractions_t, new_recovery_tables, recovery_tables_t
   use amontons_stress_field, only: error_estimate_t, new_error_estimate, new_recovered_stress, recovered_stress_t
   use amontons_surface, only: surface_t
   implicit none (type, external)
   private

   public :: estimate_error, prepare_estimates

contains

   !> Makes the tables that estimates of a body share, unless it has them.
   subroutine prepare_estimates(body)
      type(body_t), intent(inout) :: body !! the body; gains the tables

      if (allocated(body%recovery)) return
      allocate (body%recovery)
      call new_recovery_tables(body%recovery, body%mesh, body%materials, body%constraints, body%springs)
   end subroutine prepare_estimates

   !> Estimates the error of the stresses of a load case's solution, with the tables of the body where it has them.
   subroutine estimate_error(estimate, body, load_case, displacement, force)
      type(error_estimate_t), intent(out) :: estimate !! the estimate
      type(body_t), intent(in), target :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      type(recovery_tables_t), allocatable, target :: own
      type(recovery_tables_t), pointer :: tables
      type(known_tractions_t) :: tractions
      type(recovered_stress_t) :: recovered

      if (allocated(body%recovery)) then
         tables => body%recovery
      else
         allocate (own)
         call new_recovery_tables(own, body%mesh, body%materials, body%constraints, body%springs)
         tables => own
      end if
      tractions = tables%sides
      call tractions%add_loads(body%mesh, load_case%loads, load_case%factor)
      call set_contact_tractions(tractions, body, load_case, force)
      call new_recovered_stress(recovered, tables%patches, body%mesh, body%materials, tractions%side, displacement, &
         load_case%thermal_strain)
      call new_error_estimate(estimate, body%mesh, body%materials, displacement, tables%patches, recovered, &
         load_case%thermal_strain)
   end subroutine estimate_error

   !> Sets the tractions on the sides of the contact sets: the force on each node over its area. What a master bears
   !> and what ties transmit is not known side by side.
   subroutine set_contact_tractions(tractions, body, load_case, force)
      type(known_tractions_t), intent(inout) :: tractions !! the sides of the boundary
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its contact sets
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      real(dp), allocatable :: traction(:, :), on_nodes(:, :)
      logical, allocatable :: is_joined(:)
      type(boundary_line_t) :: line
      type(error_t), allocatable :: error
      integer :: i

      on_nodes = body%zone%rows%forces(force, body%mesh%n_nodes)
      do i = 1, size(load_case%contacts)
         traction = on_nodes
         ! The contact zone was made of these lines, so they are sound.
         call new_boundary_line(line, body%mesh, load_case%contacts(i)%set, error, body%materials)
         call divide_by_area(traction, line)
         call tractions%add_nodal(body%mesh, body%constraints, load_case%contacts(i)%set, traction)
      end do
      allocate (is_joined(body%mesh%n_nodes), source=.false.)
      do i = 1, size(body%zone%pairs)
         if (body%zone%pairs(i)%is_set()) call mark_sides(is_joined, body%zone%pairs(i)%master, &
            body%zone%pairs(i)%segments%master)
      end do
      is_joined = is_joined .and. any(abs(on_nodes) > 0.0_dp, dim=1)
      do i = 1, size(body%ties)
         call mark_sides(is_joined, body%ties(i)%master, body%ties(i)%segments%master)
         call mark_sides(is_joined, body%ties(i)%slave, body%ties(i)%segments%slave)
      end do
      call tractions%forget(is_joined)
   end subroutine set_contact_tractions

   !> Makes tractions of the forces on the nodes of a line. On the axis of revolution a corner of a quadratic side has
   !> no area: its traction continues those of the two nodes beside it linearly. Nothing acts on sides that lie on it.
   pure subroutine divide_by_area(traction, line)
      real(dp), intent(inout) :: traction(:, :)
         !! forces on the nodes of the mesh, and on return, on those of the line, over their areas (2, n_nodes) [F/L^2]
      type(boundary_line_t), intent(in) :: line !! the line
      ! Areas that are rounding errors of those of the other nodes.
      real(dp), parameter :: negligible = 1.0e-10_dp
      logical :: is_bare(line%n_nodes)
      integer :: k, way, nearest(2)

      is_bare = line%area <= negligible*maxval(line%area)
      do k = 1, line%n_nodes
         if (.not. is_bare(k)) traction(:, line%node(k)) = traction(:, line%node(k))/line%area(k)
      end do
      do k = 1, line%n_nodes
         if (.not. is_bare(k)) cycle
         way = merge(1, -1, line%next(k) > 0)
         nearest = k + [way, 2*way]
         if (any(nearest < 1 .or. nearest > line%n_nodes)) cycle
         if (any(is_bare(nearest))) cycle
         traction(:, line%node(k)) = 2.0_dp*traction(:, line%node(nearest(1))) - traction(:, line%node(nearest(2)))
      end do
   end subroutine divide_by_area

   !> Marks the corners of sides of a surface.
   pure subroutine mark_sides(is_marked, surface, sides)
      logical, intent(inout) :: is_marked(:) !! the marks of the nodes (n_nodes)
      type(surface_t), intent(in) :: surface !! the surface
      integer, intent(in) :: sides(:) !! numbers of sides; one may occur more than once
      integer :: i

      do i = 1, size(sides)
         is_marked(surface%side(:2, sides(i))) = .true.
      end do
   end subroutine mark_sides

end module amontons_case_error
