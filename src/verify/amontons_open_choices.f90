!> What the contact law leaves open in a step of a history, so that another factorization, or another machine, may find
!> it otherwise than the files state: the status of a point on a bound of the law, and where a body is that no contact
!> force holds. There the files are followed.
module amontons_open_choices
   use amontons_body, only: body_t
   use amontons_contact_check, only: check_statuses, contact_state_t, law_scales_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_fault_list, only: fault_list_t
   use amontons_kinds, only: dp
   use amontons_row_text, only: read_status_runs
   use amontons_stepper, only: step_state_t
   implicit none (type, external)
   private

   public :: follow_place, follow_statuses, step_scales

contains

   !> What counts as none in a step: a share of the largest force of the history, and of the largest displacement, or of
   !> what such a force does to the stiffest point.
   pure function step_scales(limit, largest_force, problem, state) result(scales)
      real(dp), intent(in) :: limit !! the share [-]
      real(dp), intent(in) :: largest_force !! the largest force of the history [F]
      type(contact_problem_t), intent(in) :: problem !! the contact problem of the step
      type(step_state_t), intent(in) :: state !! the state at its end
      type(law_scales_t) :: scales

      scales%force = limit*max(largest_force, maxval(abs(state%solution%force)))
      scales%length = max(limit*maxval(abs(state%solution%displacement)), scales%force/maxval(problem%augmentation()))
   end function step_scales

   !> Takes the statuses of a row for those of a step if forces, gaps and slips of the step allow them.
   subroutine follow_statuses(state, runs, problem, body, scales)
      type(step_state_t), intent(inout) :: state !! the state at the end of the step
      character(*), intent(in) :: runs !! the statuses as the row states them
      type(contact_problem_t), intent(in) :: problem !! the contact problem of the step
      type(body_t), intent(in) :: body !! the body
      type(law_scales_t), intent(in) :: scales !! what counts as none
      type(fault_list_t) :: faults
      integer :: status(problem%n_points)
      logical :: is_read

      call read_status_runs(status, runs, is_read)
      if (.not. is_read) return
      associate (solution => state%solution, m => problem%n_points)
         call check_statuses(faults, '', .false., contact_state_t(problem%gap - solution%displacement(:m), state%slip, &
            solution%force, status), problem%friction, problem%slip_bound, body%zone%is_tangent_fixed, scales)
         if (faults%n == 0) solution%status = status
      end associate
   end subroutine follow_statuses

   !> Takes over from a row how far a body that nothing pressed had to go until it met its obstacle. The loads did half
   !> as much more or less work on the way, the mean of none and all.
   subroutine follow_place(state, closing_loss, before, body, scales)
      type(step_state_t), intent(inout) :: state !! the state at the end of the step
      real(dp), intent(in) :: closing_loss !! the loss of the step as its row states it [F L]
      type(step_state_t), intent(in) :: before !! the state at its beginning
      type(body_t), intent(in) :: body !! the body
      type(law_scales_t), intent(in) :: scales !! what counts as none

      if (all(body%motions%n_free == 0) .or. any(abs(before%solution%force) > scales%force)) return
      if (.not. (state%closing_loss > 0.0_dp .and. closing_loss > 0.0_dp)) return
      state%load_work = state%load_work + 0.5_dp*(closing_loss - state%closing_loss)
      state%indicator = state%indicator*(closing_loss/state%closing_loss)
      state%closing_loss = closing_loss
   end subroutine follow_place

end module amontons_open_choices
