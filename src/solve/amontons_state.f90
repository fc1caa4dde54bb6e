!> The state of the contact points: what one case hands to the next, one mesh to a finer one.
module amontons_state
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_contact_zone, only: contact_zone_t
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
      integer, allocatable :: set(:) !! which contact set each point belongs to (m)
      real(dp), allocatable :: position(:, :) !! coordinates of the points (2, m) [L]
      real(dp), allocatable :: area(:) !! their tributary areas (m) [L^2]
   contains
      procedure :: prolong => state_prolong
      procedure :: start => state_start
   end type state_t

contains

   !> The state that a solution leaves.
   pure subroutine new_state(state, case_name, solution, zone)
      type(state_t), intent(out) :: state !! the state
      character(*), intent(in) :: case_name !! name of the case
      type(contact_solution_t), intent(in) :: solution !! its solution
      type(contact_zone_t), intent(in) :: zone !! its contact points

      state%case_name = case_name
      state%force = solution%force
      state%displacement = solution%displacement
      state%status = solution%status
      state%set = zone%set
      state%position = zone%position
      state%area = zone%area
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

   !> A solution that starts from this state on another mesh of the same body: stresses and displacements of a point are
   !> linear between the two points of the state that are nearest in its set.
   pure subroutine state_prolong(self, solution, zone)
      class(state_t), intent(in) :: self !! the state
      type(contact_solution_t), intent(out) :: solution !! the solution
      type(contact_zone_t), intent(in) :: zone !! the contact points of the other mesh
      real(dp) :: distance(size(self%status)), share(2)
      integer :: nearest(2), m, n, p, k

      m = size(self%status)
      n = zone%n_points
      call new_contact_solution(solution, n)
      do p = 1, n
         distance = merge(hypot(self%position(1, :) - zone%position(1, p), self%position(2, :) - zone%position(2, p)), &
            huge(1.0_dp), self%set == zone%set(p))
         if (.not. any(self%set == zone%set(p))) cycle
         do k = 1, 2
            nearest(k) = minloc(distance, dim=1)
            share(3 - k) = distance(nearest(k))
            distance(nearest(k)) = huge(1.0_dp)
         end do
         ! A state of one point alone has no second one: its distance is that of other sets.
         share = share/sum(share)
         do k = 1, 2
            associate (q => nearest(k))
               solution%displacement([p, n + p]) = solution%displacement([p, n + p]) &
                  + share(k)*self%displacement([q, m + q])
               if (self%area(q) > 0.0_dp) solution%force([p, n + p]) = solution%force([p, n + p]) &
                  + share(k)*zone%area(p)/self%area(q)*self%force([q, m + q])
            end associate
         end do
         solution%status(p) = self%status(nearest(1))
      end do
   end subroutine state_prolong

end module amontons_state
