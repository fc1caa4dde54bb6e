!> The active set of a contact problem: an assumption of what every point does, which turns the contact law into
!> linear equations.
!>
!> Closed: u_N = d. Open: lambda_N = 0. Stick: u_T = a. Slip along s = +1 or -1: lambda_T = s (g + phi lambda_N).
module amontons_active_set
   use amontons_contact_problem, only: contact_problem_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: active_set_t

   !> What is assumed of every point.
   type :: active_set_t
      logical, allocatable :: is_closed(:) !! whether it touches (m)
      integer, allocatable :: slip_direction(:) !! sign of its slip, 0 if it sticks (m)
   contains
      procedure :: equals => active_set_equals
      procedure :: gives_force => active_set_gives_force
      procedure :: update => active_set_update
      procedure :: assume_stick => active_set_assume_stick
      procedure :: impose => active_set_impose
   end type active_set_t

contains

   !> Assumes that every point touches and sticks, but for those so far off that to pull them to the nearest point's gap
   !> alone takes more force than there is; a point without any slip bound has nothing to stick by.
   pure subroutine active_set_assume_stick(self, problem, rho, force_scale)
      class(active_set_t), intent(inout) :: self !! the active set
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: rho(:) !! stiffness that turns displacements into forces (2m) [F/L]
      real(dp), intent(in) :: force_scale !! the force that residuals are measured by [F]

      self%is_closed = rho(:problem%n_points)*(problem%gap - minval(problem%gap)) <= problem%n_points*force_scale
      self%slip_direction = merge(0, 1, problem%friction + problem%slip_bound > 0.0_dp)
   end subroutine active_set_assume_stick

   !> Makes it that of a pair (v, lambda), by the side of the law that its augmented forces lie on.
   pure subroutine active_set_update(self, problem, rho, displacement, force)
      class(active_set_t), intent(inout) :: self !! the active set
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: rho(:) !! stiffness that turns displacements into forces (2m) [F/L]
      real(dp), intent(in) :: displacement(:) !! v (2m) [L]
      real(dp), intent(in) :: force(:) !! lambda (2m) [F]
      real(dp) :: augmented(2*problem%n_points), bound(problem%n_points)

      augmented = force + rho*(displacement - problem%reference())
      associate (m => problem%n_points)
         bound = problem%bound(augmented(:m))
         self%is_closed = augmented(:m) > 0.0_dp
         self%slip_direction = merge(nint(sign(1.0_dp, augmented(m + 1:))), 0, abs(augmented(m + 1:)) > bound)
         where (.not. bound > 0.0_dp) self%slip_direction = 1
      end associate
   end subroutine active_set_update

   !> Puts what an active set says of the forces into those that are in equilibrium with displacements.
   pure subroutine active_set_impose(self, problem, force, imbalance)
      class(active_set_t), intent(in) :: self !! the active set
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(inout) :: force(:) !! q - S v, and then lambda (2m) [F]
      real(dp), intent(out) :: imbalance !! the largest change by that [F]
      real(dp) :: balanced(size(force))
      integer :: m

      m = problem%n_points
      balanced = force
      where (.not. self%is_closed) force(:m) = 0.0_dp
      associate (direction => self%slip_direction)
         where (direction /= 0) force(m + 1:) = direction*(problem%slip_bound + problem%friction*force(:m))
      end associate
      imbalance = max(0.0_dp, maxval(abs(force - balanced)))
   end subroutine active_set_impose

   !> Of which components the force is unknown and the displacement given: the normal ones of closed points, the
   !> tangential ones of sticking points; of the others it is the displacement that is unknown (2m).
   pure function active_set_gives_force(self) result(gives_force)
      class(active_set_t), intent(in) :: self !! the active set
      logical, allocatable :: gives_force(:)

      gives_force = [self%is_closed, self%slip_direction == 0]
   end function active_set_gives_force

   !> Whether two active sets are the same.
   pure logical function active_set_equals(self, other) result(equals)
      class(active_set_t), intent(in) :: self !! the active set
      type(active_set_t), intent(in) :: other !! the other

      equals = all(self%is_closed .eqv. other%is_closed) .and. all(self%slip_direction == other%slip_direction)
   end function active_set_equals

end module amontons_active_set
