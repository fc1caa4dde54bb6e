!> NAME.history.csv, NAME.points.csv and NAME.states.csv: a row for each step of a history, one for each contact point
!> of some, and one with all that a history needs to go on behind a step.
module amontons_history_table
   use amontons_body, only: body_t
   use amontons_decimal, only: longest_decimal
   use amontons_friction_law, only: status_names
   use amontons_history, only: history_t
   use amontons_history_model, only: history_model_t
   use amontons_history_walk, only: history_walk_t
   use amontons_kinds, only: dp
   use amontons_lengths, only: lengths_t, new_lengths
   use amontons_row_text, only: field, status_runs
   use amontons_stepper, only: step_state_t
   use amontons_text, only: comma_separated, newline, put_decimals, to_text
   implicit none (type, external)
   private

   public :: history_header, history_kinds, history_row, point_kinds, points_header, points_rows, states_header, &
      states_row, step_numbers

   !> A kind of number: one that is measured by itself, or by 1.
   integer, parameter, public :: number_alone = 1
   !> A kind of number: a force.
   integer, parameter, public :: a_force = 2
   !> A kind of number: a displacement, a slip, a gap.
   integer, parameter, public :: a_length = 3
   !> A kind of number: an energy or a work.
   integer, parameter, public :: an_energy = 4
   !> Number of kinds.
   integer, parameter, public :: n_kinds = 4
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
   integer, parameter :: point_kinds(*) = [number_alone, number_alone, number_alone, a_force, a_force, a_length, &
      a_length, a_length, a_length, an_energy, number_alone]
   !> What the states have of each contact point.
   character(23), parameter :: state_labels(*) = [character(23) :: 'normal_force', 'tangential_force', &
      'normal_displacement', 'tangential_displacement', 'anchor', 'slip_accumulated', 'dissipation', 'worn']
   !> The columns of the contact points behind step and time.
   character(*), parameter :: point_labels = 'point,normal_force,tangential_force,gap,slip,slip_step,'// &
      'slip_accumulated,dissipation,wear_integral,status'

contains

   !> The header of the steps.
   pure function history_header(history) result(text)
      type(history_t), intent(in) :: history !! the history
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
      do i = 1, history%n_probes()
         write (number, '(i0)') i
         text = text//',ux_'//trim(number)//',uy_'//trim(number)
      end do
      text = text//',iterations,statuses'//newline
   end function history_header

   !> What kind of number each column of the steps has, but for the last one, the statuses.
   pure function history_kinds(history) result(list)
      type(history_t), intent(in) :: history !! the history
      integer, allocatable :: list(:)
      integer :: i

      list = [spread(number_alone, 1, 2 + sum([(history%steps(i)%n_numbers(), i=1, size(history%steps))])), kinds, &
         spread(a_length, 1, 2*history%n_probes()), number_alone]
   end function history_kinds

   !> The numbers of a step between its number and its iterations.
   pure function step_numbers(model, body, state) result(numbers)
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state at its end
      real(dp), allocatable :: numbers(:)
      type(lengths_t) :: lengths

      call new_lengths(lengths, body%zone, state%solution%status)
      associate (force => state%solution%force, m => body%zone%n_points)
         numbers = [state%instant%time, state%instant%numbers, lengths%open, lengths%slip, lengths%stick, &
            sum(force(:m)), sum(force(m + 1:)), state%load_work, state%support_work, state%obstacle_work, &
            state%strain_energy, state%step_dissipation, sum(state%dissipation), state%closing_loss, state%indicator, &
            state%energy_error(), max(0.0_dp, maxval(abs(state%slip))), max(0.0_dp, maxval(state%accumulated_slip)), &
            state%solution%residual, model%probed(state%instant%factor, state%solution%displacement)]
      end associate
   end function step_numbers

   !> The row of a step.
   pure function history_row(model, body, number, state) result(row)
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the step
      type(step_state_t), intent(in) :: state !! the state at its end
      character(:), allocatable :: row
      character((longest_decimal + 1)*(size(state%instant%numbers) + size(labels) + 2*size(model%probe) + 2)) :: numbers
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

      text = 'step,'//history%name//','//point_labels//newline
   end function points_header

   !> The rows of the contact points of a step. The slip is the way along the tangent that a point has gone on the
   !> obstacle, the gap what is left of it.
   pure function points_rows(model, body, number, state) result(rows)
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the step
      type(step_state_t), intent(in) :: state !! the state at its end
      character(:), allocatable :: rows
      character(13*(longest_decimal + 1)*body%zone%n_points) :: buffer
      real(dp) :: gap(body%zone%n_points)
      character(24) :: numbers
      integer :: p, m, length, first

      m = body%zone%n_points
      gap = state%instant%gap - matmul(model%energies%prescribed(:m, :), state%instant%factor) &
         - state%solution%displacement(:m)
      length = 0
      do p = 1, m
         write (numbers, '(i0)') number
         first = length + 1
         length = length + len_trim(numbers)
         buffer(first:length) = trim(numbers)
         call put_decimals(buffer, length, [state%instant%time])
         write (numbers, '(a, i0)') ',', p
         first = length + 1
         length = length + len_trim(numbers)
         buffer(first:length) = trim(numbers)
         call put_decimals(buffer, length, [state%solution%force(p), state%solution%force(m + p), gap(p), &
            state%solution%displacement(m + p) - state%instant%motion(p), state%slip(p), state%accumulated_slip(p), &
            state%dissipation(p), state%worn(p)/body%zone%area(p)])
         numbers = ','//status_names(state%solution%status(p))
         first = length + 1
         length = length + len_trim(numbers) + 1
         buffer(first:length) = trim(numbers)//newline
      end do
      rows = buffer(:length)
   end function points_rows

   !> The header of the states.
   pure function states_header(history, n_points) result(text)
      type(history_t), intent(in) :: history !! the history
      integer, intent(in) :: n_points !! number of contact points
      character(:), allocatable :: text
      character(12) :: number
      integer :: i, p

      text = 'step,steps_given_up,iterations,length,'//history%name// &
         ',work_loads,work_supports,work_obstacles,residual,iterations_step'
      do i = 1, size(state_labels)
         do p = 1, n_points
            write (number, '(i0)') p
            text = text//','//trim(state_labels(i))//'_'//trim(number)
         end do
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
