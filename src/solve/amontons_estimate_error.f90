!> The error of a solved case's stresses, estimated with what is known on the boundary: loads, free sides, and the
!> contact stresses.
module amontons_estimate_error
   use amontons_body, only: body_t
   use amontons_boundary, only: boundary_line_t, new_boundary_line
   use amontons_error, only: error_t
   use amontons_error_estimate, only: error_estimate_t, new_error_estimate
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_tractions_t, new_known_tractions
   use amontons_load_case, only: load_case_t
   use amontons_stress_recovery, only: new_recovered_stress, recovered_stress_t
   implicit none (type, external)
   private

   public :: estimate_error

contains

   !> Estimates the error of the stresses of a load case's solution.
   subroutine estimate_error(estimate, body, load_case, displacement, force)
      type(error_estimate_t), intent(out) :: estimate !! the estimate
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its loads
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      type(known_tractions_t) :: tractions
      type(recovered_stress_t) :: recovered

      call new_known_tractions(tractions, body%mesh, body%constraints, body%springs, load_case%loads)
      call set_contact_tractions(tractions, body, load_case, force)
      call new_recovered_stress(recovered, body%mesh, body%materials, tractions%side, displacement, &
         load_case%thermal_strain)
      call new_error_estimate(estimate, body%mesh, body%materials, displacement, recovered, &
         load_case%thermal_strain)
   end subroutine estimate_error

   !> Sets the tractions on the sides of the contact sets: the force on each node over its area.
   subroutine set_contact_tractions(tractions, body, load_case, force)
      type(known_tractions_t), intent(inout) :: tractions !! the sides of the boundary
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its contact sets
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      real(dp), allocatable :: traction(:, :)
      type(boundary_line_t) :: line
      type(error_t), allocatable :: error
      integer :: i, k

      do i = 1, size(load_case%contacts)
         traction = body%zone%rows%forces(force, body%mesh%n_nodes)
         ! The contact zone was made of these lines, so they are sound.
         call new_boundary_line(line, body%mesh, load_case%contacts(i)%set, error, body%materials)
         do k = 1, line%n_nodes
            associate (node => line%node(k))
               traction(:, node) = traction(:, node)/max(line%area(k), tiny(1.0_dp))
            end associate
         end do
         call tractions%set_nodal(body%mesh, body%constraints, load_case%contacts(i)%set, traction)
      end do
   end subroutine set_contact_tractions

end module amontons_estimate_error
