!> The state of the contact points: what one case or step hands to the next.
module amontons_state
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: new_state, state_t

   !> Forces, displacements and statuses of the contact points: where the next case of the same body starts.
   type :: state_t
      character(:), allocatable :: case_name !! name of the case whose state it is
      real(dp), allocatable :: force(:) !! lambda = (lambda_N; lambda_T) (2m) [F]
      real(dp), allocatable :: displacement(:) !! v = (u_N; u_T) (2m) [L]
      integer, allocatable :: status(:) !! status of each point, see `amontons_friction_law` (m)
   contains
      procedure :: start => state_start
   end type state_t

contains

   !> The state that a solution leaves.
   pure subroutine new_state(state, case_name, solution)
      type(state_t), intent(out) :: state !! the state
      character(*), intent(in) :: case_name !! name of the case
      type(contact_solution_t), intent(in) :: solution !! its solution

      state%case_name = case_name
      state%force = solution%force
      state%displacement = solution%displacement
      state%status = solution%status
   end subroutine new_state

   !> A solution that starts from this state.
   pure subroutine state_start(self, solution)
      class(state_t), intent(in) :: self !! the state
      type(contact_solution_t), intent(out) :: solution !! the solution

      call new_contact_solution(solution, size(self%status))
      solution%force = self%force
      solution%displacement = self%displacement
      solution%status = self%status
   end subroutine state_start

end module amontons_state
