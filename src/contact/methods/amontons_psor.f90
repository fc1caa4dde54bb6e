!> Projected successive over-relaxation: point by point, each component (or the point as a whole) cut to its bound on
!> the spot, with the slip bound phi lambda_N of the moment. omega = 1 is projected Gauss-Seidel.
!>
!> Sweeps can be accelerated: where a proposal of Anderson's or Aitken's has a smaller residual than the sweep, the way
!> goes on from there.
module amontons_psor
   use amontons_acceleration, only: acceleration_t, new_acceleration
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_relaxation, only: new_relaxation, relaxation_t
   implicit none (type, external)
   private

   public :: psor_t, space_names

   !> The spaces that sweeps can be done in, as a deck writes them.
   character(6), parameter :: space_names(2) = [character(6) :: 'dual', 'primal']

   !> Projected SOR in the forces (`dual`, on A) or in the displacements (`primal`, on S). A reduced problem has the
   !> dual space only.
   type, extends(contact_method_t) :: psor_t
   contains
      procedure :: prepare => psor_prepare
      procedure :: solve => psor_solve
   end type psor_t

contains

   !> Whether to sweep in the forces.
   pure logical function is_dual_for(self, problem) result(is_dual)
      class(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem

      is_dual = self%space == 'dual' .or. .not. problem%matrix%has_stiffness()
   end function is_dual_for

   !> Makes the matrix that is swept over.
   subroutine psor_prepare(self, problem, error)
      class(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! a problem on the operator
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite (dual sweeps), or no memory

      if (is_dual_for(self, problem)) then
         call problem%matrix%prepare_compliance(error)
      else
         call problem%matrix%prepare_stiffness(error)
      end if
   end subroutine psor_prepare

   !> Sweeps until the residual is small.
   subroutine psor_solve(self, problem, solution, error)
      class(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(contact_solution_t), intent(inout) :: solution !! start and result
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite (dual sweeps)
      integer, parameter :: n_until_refresh = 100
      type(acceleration_t) :: acceleration
      type(relaxation_t) :: sweep, before
      integer :: i
      logical :: is_dual, may_continue

      call solution%reset()
      is_dual = is_dual_for(self, problem)
      call solution%effort%factorize(is_dual .and. .not. allocated(problem%matrix%compliance))
      call self%prepare(problem, error)
      if (allocated(error)) return
      call new_relaxation(sweep, problem, is_dual, self%local == 'block', self%omega, solution)
      call new_acceleration(acceleration, self%acceleration)
      do i = 1, self%max_iterations
         before = sweep
         call sweep%advance(problem)
         call judge(self, problem, sweep, solution, may_continue)
         if (.not. may_continue) exit
         if (mod(i, n_until_refresh) == 0) call sweep%refresh(problem)
         if (is_dual .and. .not. problem%matrix%is_held) call sweep%move_center(problem)
         call accelerate(acceleration, problem, before, sweep)
      end do
      call solution%effort%add(sweep%effort)
   end subroutine psor_solve

   !> Takes down the residual after a sweep. The sweep knows it without a product; it is computed independently where it
   !> is small enough, and at the end.
   pure subroutine judge(self, problem, sweep, solution, may_continue)
      type(psor_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(relaxation_t), intent(inout) :: sweep !! the sweep; free of rounding if its residual was computed
      type(contact_solution_t), intent(inout) :: solution !! gains the residual, and the pair at the end
      logical, intent(out) :: may_continue !! whether to sweep on
      real(dp) :: displacement(2*problem%n_points), force(2*problem%n_points), residual
      logical :: is_last

      residual = sweep%scaled_residual(problem)
      is_last = solution%n_iterations + 1 >= self%max_iterations .or. residual >= huge(residual)
      may_continue = .true.
      if (residual > self%tolerance .and. .not. is_last) then
         call solution%record_residual(residual)
         return
      end if
      call sweep%pair(problem, displacement, force)
      call solution%record(problem, displacement, force, self%tolerance, may_continue)
      call sweep%refresh(problem)
   end subroutine judge

   !> Goes on from what the acceleration proposes if its residual is smaller.
   pure subroutine accelerate(acceleration, problem, before, sweep)
      type(acceleration_t), intent(inout) :: acceleration !! the acceleration
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(relaxation_t), intent(in) :: before !! where the sweep began
      type(relaxation_t), intent(inout) :: sweep !! where it ended
      type(relaxation_t) :: proposed
      real(dp) :: proposal(3*size(sweep%unknown))
      integer :: n
      logical :: is_given

      if (acceleration%depth == 0) return
      n = size(sweep%unknown)
      ! The parameter turns the center into a force. Where it is 0, or displacements are swept, the center stays.
      call acceleration%extrapolate([before%unknown, problem%matrix%proximal_parameter*before%center], &
         [sweep%unknown, problem%matrix%proximal_parameter*sweep%center, sweep%residual], proposal, is_given)
      if (.not. is_given) return
      proposed = sweep
      proposed%unknown = proposal(:n)
      if (problem%matrix%proximal_parameter > 0.0_dp) proposed%center = &
         proposal(n + 1:2*n)/problem%matrix%proximal_parameter
      proposed%residual = proposal(2*n + 1:)
      call proposed%admit(problem, sweep%unknown)
      if (proposed%scaled_residual(problem) < sweep%scaled_residual(problem)) then
         sweep = proposed
      else
         sweep%effort = proposed%effort
         call acceleration%forget()
      end if
   end subroutine accelerate

end module amontons_psor
