!> Verification of the files of a history with its deck and with each other: every step is solved again, from the
!> anchors of the step before to the time in its row. Rows, states, contact points and grids are made again from these
!> steps; the files of the last step are restored and verified on the full model like those of a case. If the history
!> ended early, the step without equilibrium is tried again.
!>
!> Where the contact law has several answers, another factorization or machine may find another one than the
!> files state: the status of a point on a bound of the law, and the position of a body that no contact force holds.
!> There the files are followed.
module amontons_verify_history
   use amontons_body, only: body_t
   use amontons_document, only: read_status_runs
   use amontons_error, only: error_t, fault_list_t
   use amontons_file_check, only: agree, compare_collection, compare_line, csv_table_t, first_disagreement, &
      read_csv_table, verified_case_t
   use amontons_history, only: is_shown
   use amontons_history_files, only: a_force, a_length, an_energy, history_table_t, history_tables, &
      n_kinds, number_alone, of_grids, of_states, table_rows
   use amontons_history_model, only: history_model_t, instant_t, step_state_t, take_step
   use amontons_history_study, only: add_history_results, describe_history, history_result_t, new_step_result, &
      of_identities, of_indicator, of_violation, prepare_history, start_history, worst_names
   use amontons_kinds, only: dp
   use amontons_manifest, only: case_entries
   use amontons_quantity, only: largest_t
   use amontons_result, only: certificate_limit, outcome_no_equilibrium, result_t
   use amontons_result_warnings, only: end_of_set
   use amontons_solve_case, only: cache_t, take_no_equilibrium
   use amontons_text, only: newline, read_reals, to_text
   use amontons_time_stepping, only: new_time_stepping, time_stepping_t
   use amontons_verify_case, only: check_grids, check_statuses, law_scales_t, state_of, verify_answer, verify_result
   implicit none (type, external)
   private

   public :: verify_history

   !> A table with the number of its rows that are compared.
   type, extends(history_table_t) :: stated_table_t
      type(csv_table_t) :: csv !! its rows
      real(dp) :: largest(n_kinds) = 0.0_dp !! the largest number of each kind
      integer :: n_compared = 0 !! number of rows compared
   end type stated_table_t

   !> A history whose steps are taken again, with its tables.
   type :: retrace_t
      type(history_model_t) :: model !! the history
      type(history_result_t) :: result !! the steps so far
      type(stated_table_t), allocatable :: tables(:) !! its tables, that of the steps first
      type(largest_t) :: indicator !! largest energy error of a step over its energies, of the rows
      character(:), allocatable :: entries !! entries of the collection of grids so far
   end type retrace_t

contains

   !> Verifies the files of a history. The verdict is that the last step is certified and the history complete, or that
   !> the next step has no equilibrium.
   subroutine verify_history(case, cache)
      type(verified_case_t), intent(inout) :: case !! the history; gains the faults of all files, and the verdict
      type(cache_t), intent(inout) :: cache !! the last body, replaced if the history needs another
      type(retrace_t) :: again
      type(result_t) :: step
      type(error_t), allocatable :: error
      integer :: n_faults, n_iterations, stated
      real(dp), allocatable :: start(:)
      logical :: is_done

      call prepare_history(cache, case%solved, again%model, again%result%last, error)
      if (.not. allocated(error)) call start_history(again%result, cache, again%model, start, error)
      call take_no_equilibrium(again%result%last, error)
      associate (stepping => again%result%stepping, last => again%result%last)
         if (len(case%value('', 'message')) > 0 .and. .not. (allocated(error) .or. allocated(last%answer))) then
            call stepping%advance(again%model, cache%body, cache%problem)
            call again%result%record_end()
         end if
         call verify_answer(case, cache, last, error, is_done)
         if (is_done) return
         n_faults = case%faults%n
         again%entries = ''
         call read_tables(case, again, cache)
         if (case%faults%n == n_faults) call repeat_steps(case, again, cache)
         if (case%faults%n > n_faults) return
         call again%result%add_warnings(cache%body)
         call new_step_result(step, cache, again%model, stepping, error)
         ! not raised: the numbers of the step were finite
         if (allocated(error)) return
         call again%result%record_certificate(step%certificate%largest())
         last%load_case = step%load_case
         last%slip_record = step%slip_record
         n_iterations = stepping%n_iterations
         call try_next_step(case, again, cache)
         call again%result%record_end()
         ! Takes what only the run knew from the summary, and numbers of the size of rounding, which are others on
         ! another machine, as far as they can be true.
         associate (result => again%result, stepping => again%result%stepping)
            call adopt_stated_worst(case, of_identities, stepping%n_steps, result%worst(of_identities))
            result%worst(of_indicator) = again%indicator
            call adopt_stated_worst(case, of_violation, stepping%n_steps, result%worst(of_violation))
            stated = nint(case%number('load_history', 'steps_done_earlier'))
            if (stated > 0 .and. stated <= stepping%n_steps) result%n_resumed = stated
            ! The iterations of steps that were given up are in no row.
            stated = nint(case%number('load_history', 'iterations'))
            if (stepping%n_rejected > 0 .or. len(stepping%fault) > 0) stepping%n_iterations = max(stated, n_iterations)
         end associate
         call add_history_results(again%result, again%model, cache%body)
         call describe_history(again%result, case%config)
         call verify_result(case, cache%body, last)
         if (.not. last%is_complete) case%is_certified = case%is_certified .and. last%outcome == outcome_no_equilibrium
      end associate
   end subroutine verify_history

   !> Reads the tables of a history, and finds the scales of their numbers.
   subroutine read_tables(case, again, cache)
      type(verified_case_t), intent(inout) :: case !! the history; gains the faults
      type(retrace_t), intent(inout) :: again !! the history where it begins; gains the tables
      type(cache_t), intent(in) :: cache !! the body
      type(history_table_t), allocatable :: tables(:)
      character(:), allocatable :: fault, unread
      real(dp) :: value, stiffness
      integer :: i, k, row

      call history_tables(tables, again%model, cache%body, size(again%result%stepping%record%saved_numbers()))
      allocate (again%tables(size(tables)))
      do i = 1, size(tables)
         associate (table => again%tables(i))
            table%history_table_t = tables(i)
            if (table%content == of_grids) cycle
            call read_csv_table(table%csv, case%stem//table%ending, table%header, size(table%kinds), fault)
            table%header = table%header(:len(table%header) - 1)
            call case%fault(table%ending, fault)
            if (len(fault) == 0) then
               table%largest(number_alone) = 1.0_dp
               unread = ''
               do row = 1, table%csv%n_rows
                  do k = 1, size(table%kinds)
                     if (table%kinds(k) == number_alone) cycle
                     ! A field that is not a number differs from the computed one.
                     call table%csv%get_number(row, k, value, unread)
                     table%largest(table%kinds(k)) = max(table%largest(table%kinds(k)), abs(value))
                  end do
               end do
               stiffness = sum(cache%problem%matrix%augmentation)
               if (stiffness > 0.0_dp) table%largest(a_length) = max(table%largest(a_length), &
                  table%largest(a_force)/stiffness)
            end if
         end associate
      end do
   end subroutine read_tables

   !> Takes the steps again, row by row, up to the first one that does not agree.
   subroutine repeat_steps(case, again, cache)
      type(verified_case_t), intent(inout) :: case !! the history; gains the faults
      type(retrace_t), intent(inout) :: again !! the history where it begins; gains the steps
      type(cache_t), intent(inout) :: cache !! the body
      type(result_t) :: step
      type(error_t), allocatable :: error
      integer :: row, i, n_faults
      type(step_state_t) :: next
      character(:), allocatable :: fault
      real(dp) :: numbers(4)
      logical :: leads_there

      n_faults = case%faults%n
      do row = 1, again%tables(1)%csv%n_rows
         ! Takes a step to the time that its row states, and compares the row.
         fault = ''
         associate (steps => again%tables(1), times => again%model%history%times, stepping => again%result%stepping)
            call steps%csv%get_number(row, 2, numbers(1), fault)
            call steps%csv%get_number(row, steps%csv%column('residual'), numbers(2), fault)
            call steps%csv%get_number(row, size(steps%kinds) - 1, numbers(3), fault)
            call steps%csv%get_number(row, steps%csv%column('step_indicator'), numbers(4), fault)
            if (len(fault) == 0 .and. .not. (numbers(1) >= stepping%state%instant%time .and. &
               numbers(1) <= times(size(times)))) fault = 'the times do not ascend within the history'
            if (len(fault) == 0 .and. .not. numbers(2) <= again%model%solver%method%tolerance) fault = &
               'the residual is above the tolerance'
            if (len(fault) == 0) then
               call stepping%shorten_to(again%model%history, numbers(1), leads_there)
               if (leads_there) then
                  call solve_as_stated(next, fault, again, row, cache)
               else
                  fault = 'no step of this history leads to the time '//to_text(numbers(1))
               end if
            end if
            if (len(fault) == 0) then
               ! Iterations and residual of the run are recorded, not computed again.
               next%solution%residual = numbers(2)
               next%solution%n_iterations = nint(numbers(3))
               stepping%n_iterations = stepping%n_iterations + next%solution%n_iterations
               call stepping%accept(again%model, next)
               call again%result%record_step(cache%body, again%model)
               call again%indicator%update(numbers(4), stepping%n_steps)
               call compare_rows(case, steps, table_rows(steps%history_table_t, again%model, cache%body, stepping), row)
            end if
            call case%fault(steps%ending//':'//to_text(row + 1), fault)
         end associate
         do i = 2, size(again%tables)
            if (case%faults%n > n_faults) return
            select case (again%tables(i)%content)
            case (of_states)
               call compare_state(case, again, i, cache)
            case (of_grids)
               call compare_fields(case, again, row, cache)
            case default
               call compare_rows(case, again%tables(i), table_rows(again%tables(i)%history_table_t, again%model, &
                  cache%body, again%result%stepping), row)
            end select
         end do
         if (case%faults%n > n_faults) return
         associate (result => again%result, number => again%result%stepping%n_steps)
            ! The run certified this step, like those with grids.
            if (result%warned(end_of_set)%last == number .and. &
               .not. is_shown(number, again%model%history%fields_every)) then
               call new_step_result(step, cache, again%model, result%stepping, error)
               ! not raised: the numbers of the step were finite
               if (allocated(error)) return
               call again%result%record_certificate(step%certificate%largest())
            end if
         end associate
      end do
      ! Compares the collections of grids, and reports rows of tables that belong to no step.
      do i = 2, size(again%tables)
         associate (table => again%tables(i))
            if (table%content == of_grids) then
               call compare_collection(case%faults, case%stem//table%ending, again%entries)
            else if (table%n_compared < table%csv%n_rows) then
               call case%fault(table%ending, 'there are more rows than the steps have')
            end if
         end associate
      end do
   end subroutine repeat_steps

   !> Solves a step again, and follows its row where the law has several answers.
   subroutine solve_as_stated(next, fault, again, row, cache)
      type(step_state_t), intent(out) :: next !! the state at the end of the step
      character(:), allocatable, intent(inout) :: fault !! gains why there is none
      type(retrace_t), intent(inout) :: again !! the history, at the beginning of the step
      integer, intent(in) :: row !! row of the step
      type(cache_t), intent(inout) :: cache !! the body, its contact problem left as that of the step
      type(instant_t) :: instant
      type(error_t), allocatable :: error
      real(dp) :: time, closing_loss
      type(law_scales_t) :: scales
      type(fault_list_t) :: faults
      integer, allocatable :: status(:)
      logical :: is_read

      associate (csv => again%tables(1)%csv)
         call csv%get_number(row, 2, time, fault)
         call csv%get_number(row, csv%column('closing_loss'), closing_loss, fault)
         if (len(fault) == 0) call again%model%enter_step(cache%body, cache%problem, again%result%stepping%state, error)
         if (len(fault) == 0 .and. .not. allocated(error)) call again%model%at(cache%body, time, instant, error)
         if (allocated(error)) fault = error%message
         if (len(fault) > 0) return
         call take_step(next, again%model, cache%body, cache%problem, again%result%stepping%state, instant)
         if (len(next%reason) > 0) then
            fault = next%reason
         else if (.not. next%solution%is_converged) then
            fault = 'the step does not converge again'
         end if
         if (len(fault) > 0 .or. cache%body%zone%n_points == 0) return
         scales = scales_of(again, cache, next)
         ! Takes the statuses of the row for those of the step if forces, gaps and slips of the step allow them.
         allocate (status(cache%problem%n_points))
         call read_status_runs(status, csv%field(row, csv%column('statuses')), is_read)
         if (is_read) then
            associate (solution => next%solution, problem => cache%problem)
               call check_statuses(faults, '', .false., state_of(problem%gap - solution%displacement(:size(status)), &
                  merge(0.0_dp, next%slip, cache%body%zone%is_slip_fixed), solution%force, status), &
                  problem%friction, problem%slip_bound, cache%body%zone%is_shear_fixed, scales)
               if (faults%n == 0) solution%status = status
            end associate
         end if
         ! Takes over from the row how far a body that hovered had to go until it met its obstacle. The loads did half
         ! as much more or less work on the way, the mean of none and all.
         if (.not. hovers(again%result%stepping%state, cache%body, scales)) return
         if (.not. (next%closing_loss > 0.0_dp .and. closing_loss > 0.0_dp)) return
         next%load_work = next%load_work + 0.5_dp*(closing_loss - next%closing_loss)
         next%indicator = next%indicator*(closing_loss/next%closing_loss)
         next%closing_loss = closing_loss
      end associate
   end subroutine solve_as_stated

   !> Lengths and forces that count as zero in a step: a share of the largest force of a point, or of the mean of the
   !> largest force of the history; and of the largest displacement, or of that of all points under the largest force.
   !> If the body hovers, every gap counts as zero.
   pure type(law_scales_t) function scales_of(again, cache, state) result(scales)
      type(retrace_t), intent(in) :: again !! the history
      type(cache_t), intent(in) :: cache !! the body, its contact problem that of the step
      type(step_state_t), intent(in) :: state !! the state at its end
      real(dp) :: limit, largest_force

      limit = certificate_limit(again%model%solver%method%tolerance)
      largest_force = again%tables(1)%largest(a_force)
      scales%force = limit*max(largest_force/cache%problem%n_points, maxval(abs(state%solution%force)))
      scales%length = limit*max(largest_force/sum(cache%problem%matrix%augmentation), &
         maxval(abs(state%solution%displacement)))
      if (hovers(state, cache%body, scales)) scales%length = huge(scales%length)
   end function scales_of

   !> Whether a body that supports leave free has no normal force in a state. A given slip bound may hold it.
   pure logical function hovers(state, body, scales)
      type(step_state_t), intent(in) :: state !! the state
      type(body_t), intent(in) :: body !! the body
      type(law_scales_t), intent(in) :: scales !! lengths and forces that count as zero

      hovers = any(body%motions%n_free > 0) .and. all(abs(state%solution%force(:body%zone%n_points)) <= scales%force)
   end function hovers

   !> Compares the next rows of a table with the expected ones.
   subroutine compare_rows(case, table, rows, row)
      type(verified_case_t), intent(inout) :: case !! the history; gains the fault
      type(stated_table_t), intent(inout) :: table !! the table
      character(*), intent(in) :: rows !! the expected lines of text
      integer, intent(in) :: row !! row of the step
      character(:), allocatable :: fault
      integer :: first, last
      logical :: is_lost

      first = 1
      do while (first < len(rows))
         last = first + index(rows(first:), newline) - 2
         table%n_compared = table%n_compared + 1
         if (table%n_compared > table%csv%n_rows) then
            fault = 'rows of step '//to_text(row)//' are missing'
         else
            call compare_line(fault, table%csv%row(table%n_compared), rows(first:last), table%header, &
               table%largest(table%kinds(:size(table%kinds) - 1)), 0.0_dp, is_lost)
         end if
         call case%fault(table%ending//':'//to_text(table%n_compared + 1), fault)
         if (len(fault) > 0) return
         first = last + 2
      end do
   end subroutine compare_rows

   !> Whether two states of a history agree to rounding.
   pure logical function states_agree(found, computed, again, is_hovering)
      type(step_state_t), intent(in) :: found !! a state as a file has it
      type(step_state_t), intent(in) :: computed !! the state that was computed
      type(retrace_t), intent(in) :: again !! the history, with the largest number of each kind among the steps
      logical, intent(in) :: is_hovering !! whether the place of the body is open
      real(dp) :: length

      length = max(again%tables(1)%largest(a_length), maxval(abs(computed%solution%displacement)))
      associate (force => again%tables(1)%largest(a_force)/size(computed%worn), &
         energy => again%tables(1)%largest(an_energy))
         ! What touches without a force may be open.
         states_agree = (is_hovering .or. (all(found%solution%status == computed%solution%status) .and. &
            first_disagreement(found%solution%displacement, computed%solution%displacement, length) == 0)) .and. &
            first_disagreement([found%solution%force, found%carried_force], &
            [computed%solution%force, computed%carried_force], force) == 0 .and. &
            first_disagreement(found%instant%anchor, computed%instant%anchor, length) == 0 .and. &
            first_disagreement(found%accumulated_slip, computed%accumulated_slip, length) == 0 .and. &
            first_disagreement(found%dissipation, computed%dissipation, energy) == 0 .and. &
            first_disagreement(found%worn, computed%worn, force*length) == 0 .and. &
            first_disagreement([found%wear_depth, found%instant%added_gap], [computed%wear_depth, &
            computed%instant%added_gap], maxval(again%model%wear)*force*length) == 0 .and. &
            first_disagreement([found%load_work, found%support_work, found%obstacle_work, found%strain_energy, &
            found%carried_energy], [computed%load_work, computed%support_work, computed%obstacle_work, &
            computed%strain_energy, computed%carried_energy], energy) == 0
      end associate
   end function states_agree

   !> Compares a state in NAME.states.csv with the state that was computed.
   subroutine compare_state(case, again, number, cache)
      type(verified_case_t), intent(inout) :: case !! the history; gains the faults
      type(retrace_t), intent(inout) :: again !! the history, at the end of the step
      integer, intent(in) :: number !! number of the table of states
      type(cache_t), intent(inout) :: cache !! the body
      type(time_stepping_t) :: found
      type(error_t), allocatable :: error
      ! Columns of what is counted or recorded: step, steps given up, iterations (known if none was), length, noted,
      ! residual and iterations of the step.
      integer, parameter :: exact(*) = [1, 2, 3, 4, 5, 12, 13]
      real(dp), allocatable :: numbers(:), own(:)
      logical :: is_same, is_hovering
      integer :: first

      associate (stepping => again%result%stepping, table => again%tables(number))
         if (.not. is_shown(stepping%n_steps, again%model%history%states_every)) return
         table%n_compared = table%n_compared + 1
         is_same = table%n_compared <= table%csv%n_rows
         if (is_same) call read_reals(table%csv%row(table%n_compared), numbers, is_same)
         if (is_same) then
            call new_time_stepping(found, again%model, cache%body)
            call found%restore(again%model, cache%body, cache%problem, numbers, error)
            is_same = .not. allocated(error)
         end if
         if (is_same) then
            own = stepping%numbers()
            first = table%csv%column('status_1')
            is_hovering = hovers(stepping%state, cache%body, scales_of(again, cache, stepping%state))
            associate (status => found%state%solution%status)
               is_same = all(abs(numbers(exact) - own(exact)) <= 0.0_dp .or. (exact == 3 .and. own(2) > 0.0_dp)) .and. &
                  (is_hovering .or. all(abs(numbers(first:first + size(status) - 1) - status) <= 0.0_dp))
            end associate
         end if
         if (is_same) is_same = states_agree(found%state, stepping%state, again, is_hovering) .and. &
            first_disagreement(found%record%saved_numbers(), stepping%record%saved_numbers()) == 0
         if (.not. is_same) call case%fault(table%ending//':'//to_text(table%n_compared + 1), &
            'it is not the state of step '//to_text(stepping%n_steps))
      end associate
   end subroutine compare_state

   !> Compares the grids of a step with its solution.
   subroutine compare_fields(case, again, row, cache)
      type(verified_case_t), intent(inout) :: case !! the history; gains the faults
      type(retrace_t), intent(inout) :: again !! the history, at the end of the step; gains the entries
      integer, intent(in) :: row !! row of the step
      type(cache_t), intent(in) :: cache !! the body
      type(result_t) :: step
      type(error_t), allocatable :: error
      character(:), allocatable :: folder

      if (.not. is_shown(again%result%stepping%n_steps, again%model%history%fields_every)) return
      step%wants_error_estimate = case%config%accuracy%wants_estimate()
      call new_step_result(step, cache, again%model, again%result%stepping, error)
      ! not raised: the numbers of the step were finite
      if (allocated(error)) return
      call again%result%record_certificate(step%certificate%largest())
      associate (csv => again%tables(1)%csv)
         folder = '.history/'//csv%field(row, 1)
         call check_grids(case, cache%body, step, case%stem//folder)
         again%entries = again%entries//case_entries(csv%field(row, 2), &
            case%stem(index(case%stem, '/', back=.true.) + 1:)//folder)
      end associate
   end subroutine compare_fields

   !> Tries a step after the last row: it must fail, unless all times are reached.
   subroutine try_next_step(case, again, cache)
      type(verified_case_t), intent(inout) :: case !! the history; gains the fault
      type(retrace_t), intent(inout) :: again !! the history, at the end of the last step; gains why there is no other
      type(cache_t), intent(inout) :: cache !! the body
      real(dp) :: last_time

      associate (stepping => again%result%stepping)
         if (stepping%is_ended) return
         last_time = stepping%state%instant%time
         call stepping%advance(again%model, cache%body, cache%problem)
         if (stepping%is_ended .and. stepping%state%instant%time <= last_time) return
         call case%fault(again%tables(1)%ending, 'it ends before the history: a step to '// &
            to_text(stepping%state%instant%time)//' is possible')
      end associate
   end subroutine try_next_step

   !> Takes the largest number of all steps from the summary, if it agrees within rounding.
   subroutine adopt_stated_worst(case, number, n_steps, worst)
      type(verified_case_t), intent(in) :: case !! the history
      integer, intent(in) :: number !! index of the number in `worst_names`
      integer, intent(in) :: n_steps !! number of the last step
      type(largest_t), intent(inout) :: worst !! the number as it was computed again
      real(dp), parameter :: rounding = 1.0e-8_dp
      type(largest_t) :: stated

      associate (name => worst_names(number))
         stated = largest_t(case%number('load_history', trim(name)), &
            nint(case%number('load_history', trim(name)//'_step')))
      end associate
      if (.not. agree(stated%value, worst%value, 1.0_dp)) return
      ! Of numbers that are rounding any may be the largest.
      if (worst%value <= rounding .and. stated%at > 0 .and. stated%at <= n_steps) worst%at = stated%at
      worst%value = stated%value
   end subroutine adopt_stated_worst

end module amontons_verify_history
