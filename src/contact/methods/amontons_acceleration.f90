!> Acceleration of iterations x -> G(x) (Anderson, J. ACM 12, 1965): the next point is the combination of the last
!> images G(x) for which the same combination of the steps G(x) - x is smallest.
!>
!> With one difference of steps this is Aitken's extrapolation along the last step (Irons and Tuck, Int. J. Numer. Meth.
!> Eng. 1, 1969). Quantities that depend linearly on a point are combined in the same way, without being recomputed.
!>
!> Methods in the forces solve a body that only contact holds by proximal steps from a center, which moves with them.
module amontons_acceleration
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, effort_t
   use amontons_dense, only: cholesky_factor_regularized, cholesky_solve
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: accelerate, acceleration_names, acceleration_t, new_acceleration, proximal_center_t

   !> The kinds, as a deck writes them.
   character(8), parameter :: acceleration_names(3) = [character(8) :: 'none', 'aitken', 'anderson']
   !> Number of differences of steps that each kind uses; ten gained little over five.
   integer, parameter :: depths(3) = [0, 1, 5]

   !> The last images and steps of an iteration.
   type :: acceleration_t
      integer :: depth = 0 !! largest number of differences in use; 0 for no acceleration
      integer :: n_kept = 0 !! number of images kept
      real(dp), allocatable, private :: image(:, :)
         !! images with their dependent quantities, oldest first (n, depth + 1)
      real(dp), allocatable, private :: step(:, :)
         !! steps that led to these images, without the dependent quantities (k, depth + 1)
   contains
      procedure :: extrapolate => acceleration_extrapolate
      procedure :: forget => acceleration_forget
   end type acceleration_t

   !> The center of the proximal steps of a body that only contact holds.
   type :: proximal_center_t
      real(dp), allocatable :: place(:) !! the displacements (2m) [L]
      real(dp), allocatable :: step(:) !! the last step from them (2m) [L]
      real(dp) :: ahead = 0.0_dp !! length of the last move ahead, in steps [-]
   contains
      procedure :: move => proximal_center_move
   end type proximal_center_t

contains

   !> Makes an acceleration without previous steps.
   pure subroutine new_acceleration(acceleration, name)
      type(acceleration_t), intent(out) :: acceleration !! the acceleration
      character(*), intent(in) :: name !! one of `acceleration_names`

      acceleration%depth = depths(findloc(acceleration_names == name, .true., dim=1))
   end subroutine new_acceleration

   !> Removes all previous steps, for example after one that led to a larger residual.
   pure subroutine acceleration_forget(self)
      class(acceleration_t), intent(inout) :: self !! the acceleration

      self%n_kept = 0
   end subroutine acceleration_forget

   !> Adds the step from a point to its image, and proposes the next point.
   pure subroutine acceleration_extrapolate(self, point, image, proposal, is_given)
      class(acceleration_t), intent(inout) :: self !! the acceleration
      real(dp), intent(in) :: point(:) !! the point, in one unit (k)
      real(dp), intent(in) :: image(:) !! its image, followed by quantities that depend linearly on it (n)
      real(dp), intent(out) :: proposal(:) !! a combination of the images so far (n)
      logical, intent(out) :: is_given !! whether there is a proposal
      real(dp) :: difference(size(point), self%depth), norm(self%depth)
      real(dp), allocatable :: normal(:, :), right(:)
      logical :: is_regularized
      integer :: i, n

      is_given = .false.
      if (self%depth == 0) return
      if (.not. allocated(self%image)) then
         allocate (self%image(size(image), self%depth + 1), self%step(size(point), self%depth + 1))
      end if
      if (self%n_kept > self%depth) then
         do i = 1, self%depth
            self%image(:, i) = self%image(:, i + 1)
            self%step(:, i) = self%step(:, i + 1)
         end do
      end if
      self%n_kept = min(self%n_kept + 1, self%depth + 1)
      self%image(:, self%n_kept) = image
      self%step(:, self%n_kept) = image(:size(point)) - point
      n = self%n_kept - 1
      if (n == 0) return
      do i = 1, n
         difference(:, i) = self%step(:, i + 1) - self%step(:, i)
         norm(i) = norm2(difference(:, i))
      end do
      if (any(norm(:n) <= tiny(1.0_dp))) return
      ! Differences are scaled to equal length; otherwise the old, large ones would dominate.
      normal = matmul(transpose(difference(:, :n)), difference(:, :n))/(spread(norm(:n), 1, n)*spread(norm(:n), 2, n))
      right = matmul(self%step(:, n + 1), difference(:, :n))/norm(:n)
      call cholesky_factor_regularized(normal, spread(1.0_dp, 1, n), is_regularized)
      call cholesky_solve(normal, right)
      proposal = image
      do i = 1, n
         proposal = proposal - right(i)/norm(i)*(self%image(:, i + 1) - self%image(:, i))
      end do
      is_given = .true.
   end subroutine acceleration_extrapolate

   !> Moves the center of the proximal steps to the displacements just found, and subtracts the move from these. If
   !> successive moves have one direction and hardly become shorter, the body travels towards its obstacles: the center
   !> is then moved ahead by the limit of the geometric series of the moves (Aitken), at most twice as far as the last
   !> time.
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

   !> Replaces the iterate by the combination of the last ones, cut to the contact law, if its residual is smaller.
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
      integer :: n

      n = size(force)
      image = [force, problem%matrix%proximal_parameter*place, displacement]
      call acceleration%extrapolate(start, image, proposal, is_given)
      if (.not. is_given) return
      next = problem%cut(proposal(:n))
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

end module amontons_acceleration
