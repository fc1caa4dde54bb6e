!> Forces and statuses of the contact points, read back and held against the contact law.
!>
!> In a step of a history the law leaves open, so that another factorization, or another machine, may find it otherwise
!> than the files state: the status of a point on a bound of the law, and where a body is that no contact force holds.
!> There the files are followed.
module amontons_contact_check
   use amontons_body, only: body_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_csv_table, only: csv_table_t, read_csv_table
   use amontons_document, only: read_status_runs
   use amontons_error, only: fault_list_t
   use amontons_file_check, only: first_disagreement
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, status_names, stick_point
   use amontons_history_files, only: a_force, a_length, an_energy, n_kinds
   use amontons_kinds, only: dp
   use amontons_stepper, only: step_state_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: check_statuses, contact_state_t, follow_place, follow_statuses, hovers, law_scales_t, new_law_scales, &
      read_points, states_agree, step_scales

   !> Gaps, slips, forces and statuses of the contact points.
   type :: contact_state_t
      real(dp), allocatable :: gap(:) !! distance to the obstacle (m) [L]
      real(dp), allocatable :: slip(:) !! tangential displacement (m) [L]
      real(dp), allocatable :: force(:) !! normal forces, then tangential ones along the slip (2m) [F]
      integer, allocatable :: status(:) !! statuses (m)
   end type contact_state_t

   !> Lengths and forces that count as zero beside the displacements and the forces of a case.
   type :: law_scales_t
      real(dp) :: length = 0.0_dp !! displacements up to this count as none [L]
      real(dp) :: force = 0.0_dp !! forces up to this count as none [F]
   end type law_scales_t

contains

   !> Finds the lengths and forces that count as zero beside the displacements and the forces of a case.
   pure function new_law_scales(limit, displacement, force_scale) result(scales)
      real(dp), intent(in) :: limit !! the share that counts as none [-]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: force_scale !! what the certificate measures contact forces by [F]
      type(law_scales_t) :: scales

      scales%length = limit*maxval(abs(displacement))
      scales%force = limit*force_scale
   end function new_law_scales

   !> Reads forces and statuses from a table of contact points.
   subroutine read_points(path, n_points, force, status, fault)
      character(*), intent(in) :: path !! name of the file
      integer, intent(in) :: n_points !! number of contact points
      real(dp), allocatable, intent(out) :: force(:) !! normal forces, then tangential ones (2 n_points) [F]
      integer, allocatable, intent(out) :: status(:) !! the statuses (n_points)
      character(:), allocatable, intent(out) :: fault !! why it cannot be read; empty if it can
      type(csv_table_t) :: rows
      integer :: p, columns(3), i

      allocate (force(2*n_points), status(n_points))
      call read_csv_table(rows, path, fault=fault)
      if (len(fault) == 0 .and. rows%n_rows /= n_points) fault = to_text(rows%n_rows)//' rows, but there are '// &
         to_text(n_points)//' contact points'
      if (len(fault) > 0) return
      columns = [rows%column('normal_force'), rows%column('tangential_force'), rows%column('status')]
      if (any(columns == 0)) fault = 'the first line is not the header of this table'
      do p = 1, n_points
         if (len(fault) > 0) return
         call rows%get_number(p, columns(1), force(p), fault)
         call rows%get_number(p, columns(2), force(n_points + p), fault)
         ! Each status is one of the known names.
         status(p) = 0
         do i = 1, size(status_names)
            if (rows%field(p, columns(3)) == trim(status_names(i))) status(p) = i
         end do
         if (status(p) == 0 .and. len(fault) == 0) fault = 'line '//to_text(p + 1)//": expected a status, found '"// &
            rows%field(p, columns(3))//"'"
      end do
   end subroutine read_points

   !> Holds the statuses of a converged case against the contact law, point by point.
   subroutine check_statuses(faults, path, has_rows, points, friction, slip_bound, is_tangent_fixed, scales)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: path !! name of the file
      logical, intent(in) :: has_rows !! whether it has a line for each point, behind one of names
      type(contact_state_t), intent(in) :: points !! gaps, slips, forces and statuses
      real(dp), intent(in) :: friction(:) !! Coulomb coefficients (m) [-]
      real(dp), intent(in) :: slip_bound(:) !! given bounds of the tangential force (m) [F]
      logical, intent(in) :: is_tangent_fixed(:) !! whether a support bears the shear (m)
      type(law_scales_t), intent(in) :: scales !! what counts as none
      character(:), allocatable :: place, wrong
      real(dp) :: bound, direction, slip
      integer :: p

      do p = 1, size(points%status)
         associate (status => points%status(p), gap => points%gap(p), normal => points%force(p), &
            tangential => points%force(size(points%status) + p))
            bound = merge(0.0_dp, slip_bound(p) + friction(p)*max(0.0_dp, normal), is_tangent_fixed(p))
            slip = merge(0.0_dp, points%slip(p), is_tangent_fixed(p))
            direction = merge(1.0_dp, merge(-1.0_dp, 0.0_dp, status == slip_minus), status == slip_plus)
            ! Conditions on the gap and the normal force come before those on the slip.
            wrong = ''
            if (abs(tangential) > bound + scales%force) wrong = 'the tangential force is above its bound'
            if (status == stick_point .and. abs(slip) > scales%length) wrong = 'it moves along the obstacle'
            if (direction*slip < -scales%length) wrong = 'it moves the other way'
            if (abs(direction) > 0.0_dp .and. direction*tangential < bound - scales%force) wrong = &
               'the tangential force is not at its bound'
            if (normal < -scales%force) wrong = 'the normal force pulls'
            if (gap < -scales%length) wrong = 'it is behind the obstacle'
            if (status == open_point .and. normal > scales%force) wrong = 'it bears a normal force'
            if (status /= open_point .and. gap > scales%length) wrong = 'there is a gap'
            if (len(wrong) == 0) cycle
            place = path
            if (has_rows) place = path//':'//to_text(p + 1)
            call faults%add(place, 'point '//to_text(p)//" is '"//trim(status_names(status))//"', but "//wrong)
         end associate
      end do
   end subroutine check_statuses

   !> Lengths and forces that count as zero in a step: a share of the largest force of a point, or of the mean of the
   !> largest force of the history; and of the largest displacement, or of that of all points under the largest force.
   !> Where a body hovers, any gap may be another one.
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
            first_disagreement(found%instant%anchor, computed%instant%anchor, length) == 0 .and. &
            first_disagreement(found%accumulated_slip, computed%accumulated_slip, length) == 0 .and. &
            first_disagreement(found%dissipation, computed%dissipation, energy) == 0 .and. &
            first_disagreement(found%worn, computed%worn, force*length) == 0 .and. &
            first_disagreement([found%load_work, found%support_work, found%obstacle_work, found%strain_energy], &
            [computed%load_work, computed%support_work, computed%obstacle_work, computed%strain_energy], energy) == 0
      end associate
   end function states_agree

end module amontons_contact_check
