!> All solutions of a small contact problem, by trying every combination of statuses.
module enumeration
   use amontons_contact_problem, only: contact_problem_t
   use amontons_dense, only: lu_solve
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: find_solutions

   !> Rounding errors of systems of 16 unknowns with condition numbers below 1e4.
   real(dp), parameter :: rounding = 1.0e-10_dp

contains

   !> Finds the distinct solutions (v; lambda).
   subroutine find_solutions(solutions, problem)
      real(dp), allocatable, intent(out) :: solutions(:, :) !! v (2m), then lambda (2m) of each solution (4m, n)
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp) :: pair(4*problem%n_points)
      integer :: status(problem%n_points), trial, p

      allocate (solutions(size(pair), 0))
      do trial = 0, 4**problem%n_points - 1
         status = [(1 + modulo(trial/4**(p - 1), 4), p=1, problem%n_points)]
         call solve_statuses(pair, problem, status)
         if (.not. is_admissible(pair, problem, status)) cycle
         if (is_known(pair, solutions)) cycle
         solutions = reshape([solutions, pair], [size(pair), size(solutions, 2) + 1])
      end do
   end subroutine find_solutions

   !> Solves what given statuses turn the problem into: S v + lambda = q, or
   !> v + A lambda = v_free, and two equations for each point.
   subroutine solve_statuses(pair, problem, status)
      real(dp), intent(out) :: pair(:) !! v, then lambda; huge if the statuses leave them undetermined (4m)
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: status(:) !! the statuses (m)
      real(dp) :: matrix(size(pair), size(pair))
      integer :: i, m, n, p, info

      m = problem%n_points
      n = 2*m
      matrix = 0.0_dp
      pair = 0.0_dp
      if (.not. problem%matrix%has_stiffness()) then
         matrix(:n, n + 1:) = problem%matrix%compliance%block([(i, i=1, n)], [(i, i=1, n)])
         pair(:n) = problem%free_displacement
      else
         matrix(:n, n + 1:) = problem%matrix%stiffness%values
         pair(:n) = problem%load
      end if
      do i = 1, n
         matrix(i, i) = 1.0_dp
      end do
      if (problem%matrix%has_stiffness()) matrix(:n, :) = cshift(matrix(:n, :), n, dim=2)
      do p = 1, m
         if (status(p) == open_point) then
            matrix(n + p, n + p) = 1.0_dp
         else
            matrix(n + p, p) = 1.0_dp
            pair(n + p) = problem%gap(p)
         end if
         matrix(n + m + p, merge(m + p, n + m + p, status(p) == stick_point)) = 1.0_dp
         if (status(p) == slip_plus) matrix(n + m + p, n + p) = -problem%friction(p)
         if (status(p) == slip_minus) matrix(n + m + p, n + p) = problem%friction(p)
      end do
      call lu_solve(matrix, pair, info)
      if (info /= 0) pair = huge(1.0_dp)
   end subroutine solve_statuses

   !> Whether a pair fulfills the inequalities that belong to its statuses.
   pure logical function is_admissible(pair, problem, status)
      real(dp), intent(in) :: pair(:) !! v, then lambda (4m)
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: status(:) !! the statuses (m)
      ! Samples have displacements and forces of about 1; what is so large comes from a singular system.
      real(dp), parameter :: too_large = 1.0e6_dp
      integer :: m, p

      m = problem%n_points
      is_admissible = all(abs(pair) < too_large)
      if (.not. is_admissible) return
      do p = 1, m
         associate (u_n => pair(p), u_t => pair(m + p), force_n => pair(2*m + p), force_t => pair(3*m + p))
            select case (status(p))
            case (open_point)
               is_admissible = is_admissible .and. u_n <= problem%gap(p) + rounding
            case (stick_point)
               is_admissible = is_admissible .and. force_n >= -rounding &
                  .and. abs(force_t) <= problem%friction(p)*force_n + rounding
            case (slip_plus)
               is_admissible = is_admissible .and. force_n >= -rounding .and. u_t >= -rounding
            case default
               is_admissible = is_admissible .and. force_n >= -rounding .and. u_t <= rounding
            end select
         end associate
      end do
   end function is_admissible

   !> Whether a pair was found before: a point between two statuses counts as either.
   pure logical function is_known(pair, solutions)
      real(dp), intent(in) :: pair(:) !! v, then lambda (4m)
      real(dp), intent(in) :: solutions(:, :) !! what was found before (4m, n)
      integer :: i

      is_known = .false.
      do i = 1, size(solutions, 2)
         is_known = is_known .or. maxval(abs(solutions(:, i) - pair)) < 100.0_dp*rounding
      end do
   end function is_known

end module enumeration
