!> The center of the proximal steps by which methods in the forces solve a body that only contact holds, and the
!> acceleration of iterations that change forces and center.
module amontons_proximal_center
   use amontons_acceleration, only: acceleration_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_effort, only: effort_t
   use amontons_friction_law, only: bounded
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: accelerate, proximal_center_t

   !> Where the proximal steps of a body that only contact holds are counted from.
   type :: proximal_center_t
      real(dp), allocatable :: place(:) !! the displacements (2m) [L]
      real(dp), allocatable :: step(:) !! the last step from them (2m) [L]
      real(dp) :: ahead = 0.0_dp !! how many steps the last move went ahead [-]
   contains
      procedure :: move => proximal_center_move
   end type proximal_center_t

contains

   !> Moves the center of the proximal steps to the displacements just found, and these along with it. Where steps
   !> follow each other in one direction and hardly become shorter, the body travels to its obstacles: ahead by what is
   !> left of such steps if each is the same part of the one before (Aitken), at most twice as far as the last time.
   pure subroutine proximal_center_move(self, problem, displacement, effort)
      class(proximal_center_t), intent(inout) :: self !! the center
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(inout) :: displacement(:) !! v of the old center, and then of the new one (2m) [L]
      type(effort_t), intent(inout) :: effort !! gains that of the product
      real(dp), parameter :: steady = 0.9_dp, deviation = 0.1_dp
      real(dp), dimension(size(displacement)) :: step, product
      real(dp) :: ratio, ahead

      step = displacement - self%place
      ahead = 0.0_dp
      if (allocated(self%step)) then
         ratio = dot_product(step, self%step)/max(dot_product(self%step, self%step), tiny(1.0_dp))
         if (ratio > steady .and. norm2(step - ratio*self%step) < deviation*norm2(step)) then
            ahead = min(2.0_dp*self%ahead + 1.0_dp, 1.0_dp/max(1.0_dp - ratio, epsilon(1.0_dp)))
         end if
      end if
      self%ahead = ahead
      self%step = step
      step = (1.0_dp + ahead)*step
      self%place = self%place + step
      call problem%matrix%compliance%multiply(problem%matrix%proximal_parameter*step, product)
      displacement = displacement + product
      call effort%multiply(1.0_dp)
   end subroutine proximal_center_move

   !> Goes on from a combination of the last iterations, cut to the contact law, where that is better than the last one.
   subroutine accelerate(acceleration, problem, start, force, place, displacement, solution)
      type(acceleration_t), intent(inout) :: acceleration !! the last iterations
      type(contact_problem_t), intent(in) :: problem !! the problem, its compliance prepared
      real(dp), intent(in) :: start(:) !! forces, and the center times alpha, before the iteration (4m) [F]
      real(dp), intent(inout) :: force(:) !! lambda after it (2m) [F]
      real(dp), intent(inout) :: place(:) !! the next center (2m) [L]
      real(dp), intent(inout) :: displacement(:) !! v of these forces and this center (2m) [L]
      type(contact_solution_t), intent(inout) :: solution !! its residual is that after the iteration
      real(dp) :: proposal(3*size(force)), next(size(force)), moved(size(force)), image(3*size(force))
      logical :: is_given
      integer :: m, n

      m = problem%n_points
      n = 2*m
      image = [force, problem%matrix%proximal_parameter*place, displacement]
      call acceleration%extrapolate(start, image, proposal, is_given)
      if (.not. is_given) return
      next(:m) = max(0.0_dp, proposal(:m))
      next(m + 1:) = bounded(proposal(m + 1:n), problem%bound(next(:m)))
      call problem%matrix%compliance%multiply(next - proposal(:n), moved)
      moved = proposal(2*n + 1:) - moved
      call solution%effort%multiply(2.0_dp)
      if (problem%residual(moved, next) < problem%residual(displacement, force)) then
         force = next
         displacement = moved
         if (.not. problem%matrix%is_held) place = proposal(n + 1:2*n)/problem%matrix%proximal_parameter
      else
         call acceleration%forget()
      end if
   end subroutine accelerate

end module amontons_proximal_center
