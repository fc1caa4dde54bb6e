!> The warning on bodies of revolution that nothing holds at their axis.
module amontons_axis_warning
   use amontons_body, only: body_t
   use amontons_error, only: warning_list_t
   use amontons_kinds, only: dp
   use amontons_material, only: on_axis
   use amontons_text, only: counted
   implicit none (type, external)
   private

   public :: add_free_axis

contains

   !> Warns of nodes on the axis of revolution that no support holds there: the body may open a hole along its axis.
   pure subroutine add_free_axis(warnings, body)
      type(warning_list_t), intent(inout) :: warnings !! gains the warning
      type(body_t), intent(in) :: body !! the body
      real(dp), parameter :: radial(2) = [1.0_dp, 0.0_dp]
      integer :: n_free, node

      associate (is_on_axis => on_axis(body%mesh, body%materials))
         n_free = count([(is_on_axis(node) .and. body%constraints%leaves_free(node, radial), &
            node=1, body%mesh%n_nodes)])
      end associate
      if (n_free > 0) call warnings%add(counted(n_free, 'node')//' on the axis of revolution '// &
         trim(merge('is ', 'are', n_free == 1))//' not held radially; add a support with ux = 0.0')
   end subroutine add_free_axis

end module amontons_axis_warning
