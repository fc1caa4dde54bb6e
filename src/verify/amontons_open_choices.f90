!> What the contact law leaves open in a step of a history, so that another factorization, or another machine, may find
!> it otherwise than the files state: the status of a point on a bound of the law, and where a body is that no contact
!> force holds. There the files are followed.
module amontons_open_choices
   use amontons_agreement, only: first_disagreement
   use amontons_body, only: body_t
   use amontons_contact_check, only: check_statuses, contact_state_t, law_scales_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_fault_list, only: fault_list_t
   use amontons_history_table, only: a_force, a_length, an_energy, n_kinds
   use amontons_kinds, only: dp
   use amontons_row_text, only: read_status_runs
   use amontons_stepper, only: step_state_t
   implicit none (type, external)
   private

   public :: follow_place, follow_statuses, hovers, states_agree, step_scales

contains

   !> What counts as none in a step: a share of the largest force of a point, or of the mean of the largest force of the
   !> history; and of the largest displacement, or of that of all points under the largest force. Where a body hovers,
   !> any gap may be another one.
   pure function step_scales(limit, largest_force, problem, body, state) result(scales)
      real(dp), intent(in) :: limit !! the share [-]
      real(dp), intent(in) :: largest_force !! the largest resultant of the history [F]
      type(contact_problem_t), intent(in) :: problem !! the contact problem of the step
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state at its end
      type(law_scales_t) :: scales

      scales%force = limit*max(largest_force/problem%n_points, maxval(abs(state%solution%force)))
      scales%length = limit*max(largest_force/sum(problem%augmentation()), maxval(abs(state%solution%displacement)))
      if (hovers(state, body, scales)) scales%length = huge(scales%length)
   end function step_scales

   !> Whether a body that supports leave free bears no contact force in a state.
   pure logical function hovers(state, body, scales)
      type(step_state_t), intent(in) :: state !! the state
      type(body_t), intent(in) :: body !! the body
      type(law_scales_t), intent(in) :: scales !! what counts as none

      hovers = any(body%motions%n_free > 0) .and. all(abs(state%solution%force) <= scales%force)
   end function hovers

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

   !> Takes over from a row how far a body that hovered had to go until it met its obstacle. The loads did half
   !> as much more or less work on the way, the mean of none and all.
   subroutine follow_place(state, closing_loss, before, body, scales)
      type(step_state_t), intent(inout) :: state !! the state at the end of the step
      real(dp), intent(in) :: closing_loss !! the loss of the step as its row states it [F L]
      type(step_state_t), intent(in) :: before !! the state at its beginning
      type(body_t), intent(in) :: body !! the body
      type(law_scales_t), intent(in) :: scales !! what counts as none

      if (.not. hovers(before, body, scales)) return
      if (.not. (state%closing_loss > 0.0_dp .and. closing_loss > 0.0_dp)) return
      state%load_work = state%load_work + 0.5_dp*(closing_loss - state%closing_loss)
      state%indicator = state%indicator*(closing_loss/state%closing_loss)
      state%closing_loss = closing_loss
   end subroutine follow_place

   !> Whether two states agree.
   pure logical function states_agree(found, computed, largest, is_hovering)
      type(step_state_t), intent(in) :: found !! a state as a file has it
      type(step_state_t), intent(in) :: computed !! the state that was computed
      real(dp), intent(in) :: largest(n_kinds) !! the largest number of each kind among the steps
      logical, intent(in) :: is_hovering !! whether the place of the body is open
      real(dp) :: length

      length = max(largest(a_length), maxval(abs(computed%solution%displacement)))
      associate (force => largest(a_force)/size(computed%slip), energy => largest(an_energy))
         states_agree = first_disagreement(found%solution%force, computed%solution%force, force) == 0 .and. &
            (is_hovering .or. first_disagreement(found%solution%displacement, computed%solution%displacement, &
            length) == 0) .and. &
            first_disagreement(found%anchor, computed%anchor, length) == 0 .and. &
            first_disagreement(found%accumulated_slip, computed%accumulated_slip, length) == 0 .and. &
            first_disagreement(found%dissipation, computed%dissipation, energy) == 0 .and. &
            first_disagreement(found%worn, computed%worn, force*length) == 0 .and. &
            first_disagreement([found%load_work, found%support_work, found%obstacle_work, found%strain_energy], &
            [computed%load_work, computed%support_work, computed%obstacle_work, computed%strain_energy], energy) == 0
      end associate
   end function states_agree

end module amontons_open_choices
