!> NAME.history.csv, NAME.points.csv and NAME.states.csv: a row for each step of a history, one for each contact point
!> of some, and one with all that a history needs to go on behind a step.
module amontons_history_table
   use amontons_body, only: body_t
   use amontons_cycle_watch, only: cycle_outcomes, n_cycle_numbers, n_plain_numbers
   use amontons_decimal, only: longest_decimal
   use amontons_fretting, only: n_parameters, parameter_names
   use amontons_friction_law, only: status_names
   use amontons_history, only: history_t
   use amontons_history_model, only: history_model_t
   use amontons_history_walk, only: history_walk_t
   use amontons_key_results, only: lengths_t, new_lengths
   use amontons_kinds, only: dp
   use amontons_row_text, only: field, status_runs
   use amontons_stepper, only: step_state_t
   use amontons_text, only: comma_separated, newline, put_decimals, to_text
   implicit none (type, external)
   private

   public :: cycle_kinds, cycle_row, cycles_header, history_header, history_kinds, history_row, point_kinds, &
      points_header, points_rows, states_header, states_row, step_numbers

   !> A kind of number: one that is measured by itself, or by 1.
   integer, parameter, public :: number_alone = 1
   !> A kind of number: a force.
   integer, parameter, public :: a_force = 2
   !> A kind of number: a displacement, a slip, a gap.
   integer, parameter, public :: a_length = 3
   !> A kind of number: an energy or a work.
   integer, parameter, public :: an_energy = 4
   !> The first of the kinds that are measured by the largest number of their own column.
   integer, parameter :: own_scale = 5
   !> Number of kinds.
   integer, parameter, public :: n_kinds = own_scale + 4
   !> Numbers that every step has besides those of its changes and probes, in the order of `history_row`.
   character(20), parameter :: labels(*) = [character(20) :: 'open_length', 'slip_length', 'stick_length', &
      'normal_force', 'tangential_force', 'work_loads', 'work_supports', 'work_obstacles', 'strain_energy', &
      'dissipation_step', 'dissipation', 'closing_loss', 'step_indicator', 'energy_error', 'max_slip', &
      'max_slip_accumulated', 'residual']
   !> What kind of number each of these is: of what scale.
   integer, parameter :: kinds(size(labels)) = [number_alone, number_alone, number_alone, a_force, a_force, an_energy, &
      an_energy, an_energy, an_energy, an_energy, an_energy, an_energy, number_alone, an_energy, a_length, a_length, &
      number_alone]
   !> The same of the columns of the contact points, step and time among them.
   integer, parameter :: plain_point_kinds(*) = [number_alone, number_alone, number_alone, a_force, a_force, a_length, &
      a_length, a_length, a_length, an_energy, own_scale]
   !> The same of the parameters of fretting.
   integer, parameter :: parameter_kinds(n_parameters) = [own_scale + 1, own_scale, own_scale + 2, own_scale + 3, &
      number_alone]
   !> The columns of the cycles, outcome and fretting left out.
   character(*), parameter :: cycle_labels = 'cycle,begin,end,steps,work,strain_energy_change,dissipation,'// &
      'energy_error,max_slip_accumulated,max_drift,dissipation_change,force_change,drift_change'
   !> What kind of number each of these is.
   integer, parameter :: plain_cycle_kinds(n_plain_numbers - 1) = [number_alone, number_alone, number_alone, &
      number_alone, an_energy, an_energy, an_energy, an_energy, a_length, a_length, number_alone, number_alone, &
      a_length]
   !> Numbers of each contact set, where there are several, in the order of `set_numbers`.
   character(16), parameter :: set_labels(*) = [character(16) :: 'open_length', 'slip_length', 'stick_length', &
      'normal_force', 'tangential_force']
   !> What kind of number each of these is.
   integer, parameter :: set_kinds(size(set_labels)) = [number_alone, number_alone, number_alone, a_force, a_force]
   !> What the states have of each contact point.
   character(23), parameter :: state_labels(*) = [character(23) :: 'normal_force', 'tangential_force', &
      'normal_displacement', 'tangential_displacement', 'anchor', 'slip_accumulated', 'dissipation', 'worn']
   !> The columns of the contact points behind step and time.
   character(*), parameter :: point_labels = 'point,normal_force,tangential_force,gap,slip,slip_step,'// &
      'slip_accumulated,dissipation,wear_integral'

contains

   !> The header of the steps.
   pure function history_header(history, n_sets) result(text)
      type(history_t), intent(in) :: history !! the history
      integer, intent(in) :: n_sets !! number of contact sets
      character(:), allocatable :: text
      character(12) :: number
      integer :: i, k

      text = 'step,'//history%name
      do i = 1, size(history%steps)
         do k = 1, history%steps(i)%n_numbers()
            text = text//','//field(history%steps(i)%label(k))
         end do
      end do
      do i = 1, size(labels)
         text = text//','//trim(labels(i))
      end do
      do i = 1, several(n_sets)
         write (number, '(i0)') i
         do k = 1, size(set_labels)
            text = text//','//trim(set_labels(k))//'_'//trim(number)
         end do
      end do
      do i = 1, history%n_probes()
         write (number, '(i0)') i
         text = text//',ux_'//trim(number)//',uy_'//trim(number)
      end do
      text = text//',iterations,statuses'//newline
   end function history_header

   !> What kind of number each column of the steps has, but for the last one, the statuses.
   pure function history_kinds(history, n_sets) result(list)
      type(history_t), intent(in) :: history !! the history
      integer, intent(in) :: n_sets !! number of contact sets
      integer, allocatable :: list(:)
      integer :: i, k

      list = [spread(number_alone, 1, 2 + sum([(history%steps(i)%n_numbers(), i=1, size(history%steps))])), kinds, &
         [((set_kinds(k), k=1, size(set_kinds)), i=1, several(n_sets))], &
         spread(a_length, 1, 2*history%n_probes()), number_alone]
   end function history_kinds

   !> For how many contact sets there are numbers of each: a single one has those of all.
   pure integer function several(n_sets)
      integer, intent(in) :: n_sets !! number of contact sets

      several = merge(n_sets, 0, n_sets > 1)
   end function several

   !> The numbers of a step between its number and its iterations.
   pure function step_numbers(model, body, state) result(numbers)
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state at its end
      real(dp), allocatable :: numbers(:)
      type(lengths_t) :: lengths
      integer :: i

      call new_lengths(lengths, body%zone, state%solution%status)
      associate (force => state%solution%force, m => body%zone%n_points)
         numbers = [state%instant%time, state%instant%numbers, lengths%open, lengths%slip, lengths%stick, &
            sum(force(:m)), sum(force(m + 1:)), state%load_work, state%support_work, state%obstacle_work, &
            state%strain_energy, state%step_dissipation, sum(state%dissipation), state%closing_loss, state%indicator, &
            state%energy_error(), max(0.0_dp, maxval(abs(state%slip))), max(0.0_dp, maxval(state%accumulated_slip)), &
            state%solution%residual]
      end associate
      do i = 1, several(size(body%zone%pairs))
         numbers = [numbers, set_numbers(body, state, i)]
      end do
      numbers = [numbers, model%probed(state%instant%factor, state%solution%displacement)]
   end function step_numbers

   !> The numbers of one contact set.
   pure function set_numbers(body, state, set) result(numbers)
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state at the end of a step
      integer, intent(in) :: set !! the contact set
      real(dp) :: numbers(size(set_labels))
      type(lengths_t) :: lengths

      call new_lengths(lengths, body%zone, state%solution%status, set)
      associate (force => state%solution%force, m => body%zone%n_points, is_meant => body%zone%set == set)
         numbers = [lengths%open, lengths%slip, lengths%stick, sum(force(:m), mask=is_meant), &
            sum(force(m + 1:), mask=is_meant)]
      end associate
   end function set_numbers

   !> The row of a step.
   pure function history_row(model, body, number, state) result(row)
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the step
      type(step_state_t), intent(in) :: state !! the state at its end
      character(:), allocatable :: row
      character((longest_decimal + 1)*(size(state%instant%numbers) + size(labels) + 2*size(model%probe) + 2 &
         + size(set_labels)*several(size(body%zone%pairs)))) :: numbers
      character(:), allocatable :: runs
      character(12) :: iterations
      integer :: length

      write (numbers, '(i0)') number
      write (iterations, '(i0)') state%solution%n_iterations
      length = len_trim(numbers)
      call put_decimals(numbers, length, step_numbers(model, body, state))
      call status_runs(runs, state%solution%status, body%zone%set)
      row = numbers(:length)//','//trim(iterations)//','//runs//newline
   end function history_row

   !> The header of the contact points.
   pure function points_header(history) result(text)
      type(history_t), intent(in) :: history !! the history
      character(:), allocatable :: text

      text = 'step,'//history%name//','//point_labels
      if (history%has_fretting) text = text//','//parameter_labels(1)
      text = text//',status'//newline
   end function points_header

   !> The names of the parameters of fretting from a given one on.
   pure function parameter_labels(first) result(text)
      integer, intent(in) :: first !! the first of them
      character(:), allocatable :: text
      integer :: i

      text = trim(parameter_names(first))
      do i = first + 1, n_parameters
         text = text//','//trim(parameter_names(i))
      end do
   end function parameter_labels

   !> What kind of number each column of the contact points has, but for the last one, the status.
   pure function point_kinds(history) result(list)
      type(history_t), intent(in) :: history !! the history
      integer, allocatable :: list(:)

      list = plain_point_kinds
      if (history%has_fretting) list = [list, parameter_kinds]
   end function point_kinds

   !> The header of the cycles.
   pure function cycles_header(history) result(text)
      type(history_t), intent(in) :: history !! the history
      character(:), allocatable :: text

      text = cycle_labels
      if (history%has_fretting) text = text//',max_ruiz_1,max_ruiz_2,max_swt'
      text = text//',outcome'//newline
   end function cycles_header

   !> What kind of number each column of the cycles has, but for the last one, the outcome.
   pure function cycle_kinds(history) result(list)
      type(history_t), intent(in) :: history !! the history
      integer, allocatable :: list(:)

      list = plain_cycle_kinds
      if (history%has_fretting) list = [list, parameter_kinds(2:4)]
   end function cycle_kinds

   !> The row of a cycle.
   pure function cycle_row(history, numbers) result(row)
      type(history_t), intent(in) :: history !! the history
      real(dp), intent(in) :: numbers(n_cycle_numbers) !! the numbers of the cycle
      character(:), allocatable :: row

      row = to_text(nint(numbers(1)))//','//comma_separated(numbers(2:3))//','//to_text(nint(numbers(4)))//','// &
         comma_separated(numbers(5:n_plain_numbers - 1))
      if (history%has_fretting) row = row//','//comma_separated(numbers(n_plain_numbers + 1:))
      row = row//','//trim(cycle_outcomes(nint(numbers(n_plain_numbers))))//newline
   end function cycle_row

   !> The rows of the contact points of a step. The slip is the way along the tangent that a point has gone on the
   !> obstacle, the gap what is left of it.
   pure function points_rows(model, body, walk) result(rows)
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(history_walk_t), intent(in) :: walk !! the way, at the end of the step
      character(:), allocatable :: rows, buffer
      real(dp), allocatable :: record(:, :)
      real(dp) :: gap(body%zone%n_points)
      integer :: p, m, length

      m = body%zone%n_points
      record = walk%point_record(body)
      allocate (character((9 + size(record, 2))*(longest_decimal + 1)*m) :: buffer)
      length = 0
      associate (state => walk%state)
         gap = state%instant%gap - matmul(model%energies%prescribed(:m, :), state%instant%factor) &
            - state%solution%displacement(:m)
         do p = 1, m
            call put_text(buffer, length, to_text(walk%n_steps))
            call put_decimals(buffer, length, [state%instant%time])
            call put_text(buffer, length, ','//to_text(p))
            call put_decimals(buffer, length, [state%solution%force(p), state%solution%force(m + p), gap(p), &
               state%solution%displacement(m + p) - state%instant%motion(p), record(p, :)])
            call put_text(buffer, length, ','//trim(status_names(state%solution%status(p)))//newline)
         end do
      end associate
      rows = buffer(:length)
   end function points_rows

   !> Puts a text behind what another holds so far.
   ! allow(C072): the text is the caller's, who knows its room
   pure subroutine put_text(text, length, more)
      character(*), intent(inout) :: text !! the text, with room for more
      integer, intent(inout) :: length !! how much of it is filled
      character(*), intent(in) :: more !! what is put behind

      text(length + 1:length + len(more)) = more
      length = length + len(more)
   end subroutine put_text

   !> The header of the states.
   pure function states_header(history, n_points, n_noted) result(text)
      type(history_t), intent(in) :: history !! the history
      integer, intent(in) :: n_points !! number of contact points
      integer, intent(in) :: n_noted !! how many numbers are noted of the cycle under way
      character(:), allocatable :: text
      character(12) :: number
      integer :: i, p

      text = 'step,steps_given_up,iterations,length,noted,'//history%name// &
         ',work_loads,work_supports,work_obstacles,residual,iterations_step'
      do i = 1, size(state_labels)
         do p = 1, n_points
            write (number, '(i0)') p
            text = text//','//trim(state_labels(i))//'_'//trim(number)
         end do
      end do
      do i = 1, n_noted
         write (number, '(i0)') i
         text = text//',noted_'//trim(number)
      end do
      text = text//newline
   end function states_header

   !> The row of a state: what a history needs to go on from there.
   pure function states_row(walk) result(row)
      type(history_walk_t), intent(in) :: walk !! the way
      character(:), allocatable :: row
      real(dp), allocatable :: numbers(:)

      numbers = walk%numbers()
      row = to_text(walk%n_steps)//','//comma_separated(numbers(2:))//newline
   end function states_row

end module amontons_history_table
