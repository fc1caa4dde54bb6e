!> What the listing and the summary say of a history.
module amontons_history_report
   use amontons_config, only: config_t
   use amontons_cycle_watch, only: cycle_outcomes, n_cycle_numbers, n_plain_numbers
   use amontons_document, only: document_t, json_logical, json_number, json_string, quantity_members
   use amontons_history, only: history_t, moved_things, steps_t
   use amontons_kinds, only: dp
   use amontons_listing, only: quantities_text
   use amontons_quantity, only: quantity_t
   use amontons_report, only: member
   use amontons_solve_history, only: history_result_t, worst_step_t
   use amontons_stepper, only: step_state_t
   use amontons_text, only: columns, counted, flush_right, heading, labeled, n_characters, newline, scientific, &
      short_text, to_text, unit_of, with_unit
   implicit none (type, external)
   private

   public :: describe_history

contains

   !> Says in listing and summary of the last step what the history was, and how far its steps are from being solved.
   subroutine describe_history(result, config)
      type(history_result_t), intent(inout) :: result !! the history; its last step gains the texts and the violation
      type(config_t), intent(in) :: config !! the deck
      type(quantity_t), allocatable :: energies(:)
      real(dp) :: force, length, energy

      result%last%earlier_violation = max(result%violation%value, result%imbalance%value)
      energies = energies_of(result%walk%state)
      associate (state => result%walk%state)
         force = max(sum(abs(state%solution%force)), maxval(abs(result%reached(5:6, :))))
         length = max(0.0_dp, maxval(abs(state%solution%displacement)), maxval(abs(result%cycles(9:10, :))))
         energy = max(maxval(abs(energies%value)), maxval(abs(result%reached(7:, :))))
      end associate
      call list_history(result%last%study_listing, config, result, force, length, energy)
      call result%last%study_members%add(history_members(config, result), [spread(energy, 1, size(energies)), 0.0_dp])
   end subroutine describe_history

   !> Makes the section of the listing.
   subroutine list_history(section, config, result, force, length, energy)
      type(document_t), intent(inout) :: section !! gains the section
      type(config_t), intent(in) :: config !! the deck
      type(history_result_t), intent(in) :: result !! the history
      real(dp), intent(in) :: force !! the largest force [F]
      real(dp), intent(in) :: length !! the largest displacement [L]
      real(dp), intent(in) :: energy !! the largest energy [F L]
      character(:), allocatable :: text
      integer :: i

      associate (history => config%history, walk => result%walk)
         text = heading('Load history')
         do i = 1, size(history%steps)
            text = text//labeled('Changes', steps_text(history%steps(i)))
         end do
         text = text//constant_loads_text(config)
         if (len(walk%fault) > 0) text = text//labeled('INCOMPLETE', walk%fault)
         text = text//labeled('Steps', to_text(walk%n_steps)//', row by row in '//config%name//'.history.csv')
         if (history%has_start()) text = text//labeled('Start', history%start)
         if (result%n_resumed > 0) text = text//labeled('Resumed', 'behind step '//to_text(result%n_resumed)// &
            ' of an interrupted run')
         if (walk%n_given_up > 0) text = text//labeled('Halved', to_text(walk%n_given_up)//' steps')
         text = text//labeled('Iterations', to_text(walk%n_iterations)//', '// &
            short_text(real(walk%n_iterations, dp)/max(1, walk%n_steps))//' per step')// &
            worst_text('Largest residual', result%residual)//worst_text('Energy identities', result%imbalance)// &
            worst_text('Step indicator', result%indicator)//labeled('Certified', counted(result%n_certified, 'step')// &
            '; largest violation '//scientific(result%violation%value)//' in step '// &
            to_text(result%violation%step))
         call section%add(text)
         text = ''
         if (result%checkpoint%is_anew) text = labeled('Note', 'an interrupted run had left steps of another'// &
            ' deck; all steps were taken anew')
         call section%record(text)
         text = heading('Energies of the history')//quantities_text(energies_of(walk%state), config%units)
         call section%add(text(:len(text) - 1)//' (work less strain energy and dissipation; it vanishes with the'// &
            ' size of the steps)'//newline//from_rest_text(result%error_from_rest(history), energy, config%units), &
            [energy])
         call section%add(times_table(history, result%reached, config%units), [0.0_dp, spread(0.0_dp, 1, 3), &
            spread(force, 1, 2), spread(energy, 1, 3)])
         call section%add(cycles_table(config, result%cycles), [0.0_dp, 0.0_dp, energy, energy, length, length, &
            1.0_dp])
         call section%add(fretting_text(config, result%cycles))
         call section%add( &
            heading('Last step (max. slip and slips since rest, on the obstacle; stick and slip of the step)'))
      end associate
   end subroutine list_history

   !> The part of the energy error that no size of the steps changes, where there is one.
   pure function from_rest_text(from_rest, energy, units) result(text)
      real(dp), intent(in) :: from_rest !! the energy error of the first step from rest [F L]
      real(dp), intent(in) :: energy !! the largest energy [F L]
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      real(dp), parameter :: rounding = 1.0e-12_dp

      text = ''
      if (abs(from_rest) > rounding*energy) text = labeled('of it at first', with_unit(short_text(from_rest), units, &
         'F L')//' (in the step from rest to the first time, which is not divided)')
   end function from_rest_text

   !> What changes, and between which numbers.
   pure function steps_text(steps) result(text)
      type(steps_t), intent(in) :: steps !! the change
      character(:), allocatable :: text
      integer :: k

      text = trim(moved_things(steps%target))//" '"//steps%name//"'"
      do k = 1, steps%n_numbers()
         text = text//range_text(steps%label(k), steps%table(1 + k, :))
      end do
   end function steps_text

   !> A number's name and range.
   pure function range_text(label, values) result(text)
      character(*), intent(in) :: label !! its name
      real(dp), intent(in) :: values(:) !! its values
      character(:), allocatable :: text

      text = '; '//label//' from '//short_text(minval(values))//' to '//short_text(maxval(values))
   end function range_text

   !> Says which loads act in full from the first time on.
   pure function constant_loads_text(config) result(text)
      type(config_t), intent(in) :: config !! the deck
      character(:), allocatable :: text
      integer :: i, k, n

      text = ''
      n = 0
      do i = 1, size(config%loads)
         if (.not. any([(config%history%steps(k)%target == 1 .and. config%history%steps(k)%name &
            == config%loads(i)%name, k=1, size(config%history%steps))])) n = n + 1
      end do
      if (n > 0) text = labeled('Note', 'in full from the first time on: '//counted(n, 'load')//' without &steps')
   end function constant_loads_text

   !> The largest of a number over all steps.
   pure function worst_text(label, worst) result(text)
      character(*), intent(in) :: label !! what it is
      type(worst_step_t), intent(in) :: worst !! the largest
      character(:), allocatable :: text

      text = labeled(label, scientific(worst%value))
      if (worst%step > 0) text = labeled(label, scientific(worst%value)//' in step '//to_text(worst%step))
   end function worst_text

   !> Where the work of the history went; the error is that of the size of the steps.
   pure function energies_of(state) result(list)
      type(step_state_t), intent(in) :: state !! the last state
      type(quantity_t), allocatable :: list(:)

      list = [quantity_t('work_loads', 'Work of loads', state%load_work), &
         quantity_t('work_supports', 'Work of supports', state%support_work), &
         quantity_t('work_obstacles', 'Work of obstacles', state%obstacle_work), &
         quantity_t('strain_energy', 'Strain energy', state%strain_energy), &
         quantity_t('dissipation', 'Dissipation', sum(state%dissipation)), &
         quantity_t('energy_error', 'Energy error', state%energy_error())]
      list%dimension = 'F L'
   end function energies_of

   !> The states at the times of the deck, with what the time since the one before took.
   pure function times_table(history, reached, units) result(text)
      type(history_t), intent(in) :: history !! the history
      real(dp), intent(in) :: reached(:, :) !! the times, each with what is known of it
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      character(13), parameter :: labels(*) = [character(13) :: 'open', 'slip', 'stick', 'normal force', &
         'tang. force', 'strain energy', 'work', 'dissipated']
      character(3), parameter :: dimensions(size(labels)) = [character(3) :: 'L', 'L', 'L', 'F', 'F', 'F L', 'F L', &
         'F L']
      real(dp) :: before(2)
      integer :: i, width

      width = column_width(units)
      text = heading('States at the times of the deck (work and dissipation: since the time before)')// &
         table_head(history%name(:min(12, len(history%name))), labels, dimensions, units)
      before = 0.0_dp
      do i = 1, size(reached, 2)
         text = text//columns([reached(:7, i), reached(8:, i) - before], width)//newline
         before = reached(8:, i)
      end do
   end function times_table

   !> Width of the columns of a table: of numbers with six digits, or of a unit with a long name.
   pure integer function column_width(units) result(width)
      character(*), intent(in) :: units !! names of the units of the case

      width = max(14, 1 + n_characters(unit_of(units, 'F L')))
   end function column_width

   !> The first line of a table and, where there are units, the second.
   pure function table_head(first, labels, dimensions, units) result(text)
      character(*), intent(in) :: first !! what the first column is called, which is measured in nothing
      character(*), intent(in) :: labels(:) !! what the others are called
      character(*), intent(in) :: dimensions(:) !! what they are measured in
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer :: i

      text = flush_right(first, column_width(units))
      do i = 1, size(labels)
         text = text//flush_right(trim(labels(i)), column_width(units))
      end do
      text = text//newline
      if (len_trim(units) == 0) return
      text = text//repeat(' ', column_width(units))
      do i = 1, size(dimensions)
         text = text//flush_right(unit_of(units, trim(dimensions(i))), column_width(units))
      end do
      text = trim(text)//newline
   end function table_head

   !> The cycles: of many the last ones, since these are like each other or not.
   pure function cycles_table(config, cycles) result(text)
      type(config_t), intent(in) :: config !! the deck
      real(dp), intent(in) :: cycles(:, :) !! the cycles that ended (n_cycle_numbers, n)
      character(:), allocatable :: text
      integer, parameter :: most_shown = 20
      character(10), parameter :: labels(*) = [character(10) :: 'end', 'work', 'dissipated', 'max. slip', &
         'max. drift', 'd dissip.', 'd forces', 'outcome']
      character(3), parameter :: dimensions(size(labels)) = [character(3) :: '', 'F L', 'F L', 'L', 'L', '', '', '']
      integer :: i, n, n_passed

      text = ''
      n = size(cycles, 2)
      if (n == 0) return
      n_passed = max(0, n - most_shown)
      text = heading('Cycles (d: changes from the one before, over the larger)')//table_head('cycle', labels, &
         dimensions, config%units)
      do i = n_passed + 1, n
         text = text//flush_right(to_text(nint(cycles(1, i))), column_width(config%units)) &
            //columns(cycles([3, 5, 7, 9, 10, 11, 12], i), column_width(config%units)) &
            //flush_right(trim(outcome_name(cycles(:, i))), column_width(config%units))//newline
      end do
      if (n_passed > 0) text = text//labeled('Note', 'the first '//to_text(n_passed)//' of '//to_text(n)// &
         ' cycles are in '//config%name//'.cycles.csv')
   end function cycles_table

   !> The parameters of fretting of the last cycle.
   pure function fretting_text(config, cycles) result(text)
      type(config_t), intent(in) :: config !! the deck
      real(dp), intent(in) :: cycles(:, :) !! the cycles that ended (n_cycle_numbers, n)
      character(:), allocatable :: text
      integer :: n

      text = ''
      n = size(cycles, 2)
      if (n > 0 .and. config%history%has_fretting) text = heading('Fretting, last cycle (largest of all points)')// &
         labeled('Ruiz 1', with_unit(short_text(cycles(n_plain_numbers + 1, n)), config%units, 'F/L'))// &
         labeled('Ruiz 2', with_unit(short_text(cycles(n_plain_numbers + 2, n)), config%units, 'F^2/L^3'))// &
         labeled('SWT', with_unit(short_text(cycles(n_cycle_numbers, n)), config%units, 'F/L^2'))
   end function fretting_text

   !> What a cycle is.
   pure function outcome_name(cycle) result(name)
      real(dp), intent(in) :: cycle(:) !! the numbers of the cycle
      character(len(cycle_outcomes)) :: name

      name = cycle_outcomes(nint(cycle(n_plain_numbers)))
   end function outcome_name

   !> The member of the cycles: how many, what the last one is, and since which one all are that.
   function cycles_member(history, cycles) result(text)
      type(history_t), intent(in) :: history !! the history
      real(dp), intent(in) :: cycles(:, :) !! the cycles that ended (n_cycle_numbers, n)
      character(:), allocatable :: text
      integer :: n, since

      text = ''
      n = size(cycles, 2)
      if (n == 0) return
      since = n
      do while (since > 1)
         if (nint(cycles(n_plain_numbers, since - 1)) /= nint(cycles(n_plain_numbers, n))) exit
         since = since - 1
      end do
      text = ', "cycles": '//to_text(n)//', "cycle_outcome": '//json_string(trim(outcome_name(cycles(:, n))))// &
         ', "cycle_outcome_since": '//to_text(nint(cycles(1, since)))//', "cycle_dissipation": '// &
         json_number(cycles(7, n))
      if (history%has_fretting) text = text//', "max_ruiz_1": '//json_number(cycles(n_plain_numbers + 1, n))// &
         ', "max_ruiz_2": '//json_number(cycles(n_plain_numbers + 2, n))//', "max_swt": '// &
         json_number(cycles(n_cycle_numbers, n))
   end function cycles_member

   !> The members of the summary.
   function history_members(config, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(history_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i, k

      associate (walk => result%walk, state => result%walk%state)
         text = '{'//quantity_members(energies_of(state))//', "complete": '//json_logical(len(walk%fault) == 0)// &
            ', "end": '//json_string(walk%fault)
         if (len(walk%fault) > 0) text = text//', "end_time": '//json_number(walk%fault_time)
         text = text//', "steps": '//to_text(walk%n_steps)//', "steps_done_earlier": '// &
            to_text(result%n_resumed)//', "steps_given_up": '// &
            to_text(walk%n_given_up)//', "iterations": '//to_text(walk%n_iterations)//', "changes": ['
         do i = 1, size(config%history%steps)
            do k = 1, config%history%steps(i)%n_numbers()
               if (i > 1 .or. k > 1) text = text//', '
               text = text//json_string(config%history%steps(i)%label(k))
            end do
         end do
         text = text//'], "time": '//json_number(state%instant%time)
      end associate
      text = member('load_history', text//worst_members('residual', result%residual)// &
         worst_members('energy_identities', result%imbalance)//worst_members('step_indicator', result%indicator)// &
         worst_members('violation', result%violation)// &
         cycles_member(config%history, result%cycles)//'}')
   end function history_members

   !> The largest of a number over all steps, behind others.
   pure function worst_members(name, worst) result(text)
      character(*), intent(in) :: name !! what it is
      type(worst_step_t), intent(in) :: worst !! the largest
      character(:), allocatable :: text

      text = ', "'//name//'": '//json_number(worst%value)//', "'//name//'_step": '//to_text(worst%step)
   end function worst_members

end module amontons_history_report
