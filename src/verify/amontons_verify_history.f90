!> The files of a history checked against its deck and each other: every step is solved again, from the anchors that the
!> step before has left, to the time that its row states. Rows, states, contact points and grids are written again from
!> these steps; the files of the last one are restored and judged on the full model like those of a case.
module amontons_verify_history
   use amontons_agreement, only: first_disagreement
   use amontons_collection, only: case_entries
   use amontons_collection_check, only: compare_collection
   use amontons_config, only: config_t
   use amontons_contact_check, only: law_scales_t
   use amontons_contact_method, only: contact_method_t
   use amontons_csv_table, only: csv_table_t, read_csv_table
   use amontons_document_check, only: compare_line
   use amontons_error, only: error_t
   use amontons_history, only: is_shown
   use amontons_history_milestone, only: read_start
   use amontons_history_model, only: history_model_t
   use amontons_history_table, only: a_force, a_length, cycle_kinds, cycle_row, cycles_header, &
      history_header, history_kinds, history_row, n_kinds, number_alone, point_kinds, points_header, points_rows, &
      states_header
   use amontons_history_walk, only: has_balance, history_walk_t, new_history_walk
   use amontons_kinds, only: dp
   use amontons_open_choices, only: follow_place, follow_statuses, hovers, states_agree, step_scales
   use amontons_result, only: certificate_limit, result_t
   use amontons_solve_case, only: cache_t
   use amontons_solve_history, only: history_result_t, new_step_result, prepare_history
   use amontons_stepper, only: step_state_t
   use amontons_summary_file, only: summary_file_t
   use amontons_text, only: newline, read_reals, to_text
   use amontons_verify_case, only: check_grids, verify_result
   use amontons_verify_history_end, only: check_end, solve_again, verify_answer
   implicit none (type, external)
   private

   public :: verify_history

   !> A table while its rows are computed again.
   type :: stated_table_t
      character(:), allocatable :: path !! name of the file
      character(:), allocatable :: header !! its first line
      type(csv_table_t) :: csv !! its rows; none where it is not written
      real(dp), allocatable :: scales(:) !! what each column but the last is measured by
      real(dp) :: largest(n_kinds) = 0.0_dp !! the largest number of each kind
      integer :: n_compared = 0 !! how many rows were compared
   end type stated_table_t

   !> The tables of a history while its steps are taken again.
   type :: stated_t
      character(:), allocatable :: stem !! directory and name of the case
      type(stated_table_t) :: steps !! NAME.history.csv
      type(stated_table_t) :: points !! NAME.points.csv
      type(stated_table_t) :: cycles !! NAME.cycles.csv
      type(stated_table_t) :: states !! NAME.states.csv
      character(:), allocatable :: entries !! what the collection of the grids has so far
   end type stated_t

contains

   !> Checks the files of a history.
   subroutine verify_history(summary, cache, config, stem, is_certified)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the history needs another
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(out) :: is_certified
         !! whether its last step is certified and it is complete, or the next one has no equilibrium
      class(contact_method_t), allocatable :: method
      type(history_model_t) :: model
      type(history_result_t) :: result
      type(stated_t) :: stated
      type(config_t) :: solved
      type(error_t), allocatable :: error
      integer :: n_faults

      is_certified = .false.
      ! What was spread over ranks is checked on however many there are.
      solved = config
      if (solved%condensation%factorization == 'distributed') solved%condensation%factorization = 'auto'
      call prepare_history(cache, solved, method, model, result%last, error)
      if (.not. allocated(error)) call begin(result%walk, cache, model, error)
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      n_faults = summary%faults%n
      if (len(summary%value('', 'message')) > 0) then
         call verify_answer(summary, cache, model, method, config, stem, result, is_certified)
         return
      end if
      call read_tables(summary, stated, model, cache, size(result%walk%watch%noted()), stem)
      if (summary%faults%n == n_faults) call retrace(summary, stated, cache, model, method, config, result)
      if (summary%faults%n > n_faults) return
      call result%add_jumps()
      result%last%is_complete = summary%value('load_history', 'complete') == 'true'
      result%last%has_no_equilibrium = summary%value('', 'outcome') == '"no_equilibrium"'
      associate (state => result%walk%state)
         call model%load_case(cache%body, state%instant, state%anchor, result%last%load_case, error)
         ! not raised: the step itself had this load case
         if (allocated(error)) return
         result%last%slip_record = result%walk%point_record(cache%body)
      end associate
      call verify_result(summary, cache%body, config, stem, result%last, is_certified)
      if (result%last%is_complete) return
      call check_end(summary, cache, model, method, result%walk%state, result%last%has_no_equilibrium)
      is_certified = is_certified .and. result%last%has_no_equilibrium
   end subroutine verify_history

   !> Goes to where the history begins.
   subroutine begin(walk, cache, model, error)
      type(history_walk_t), intent(out) :: walk !! the way
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      type(error_t), allocatable, intent(out) :: error !! there is no such start
      real(dp), allocatable :: start(:)

      call new_history_walk(walk, model, cache%body)
      if (.not. model%history%has_start()) return
      call read_start(start, model%history, error)
      if (.not. allocated(error)) call walk%restore(model, cache%body, cache%problem, start, error)
   end subroutine begin

   !> Reads the tables, and finds what their numbers are measured by.
   subroutine read_tables(summary, stated, model, cache, n_noted, stem)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(inout) :: stated !! gains the tables
      type(history_model_t), intent(in) :: model !! the history
      type(cache_t), intent(in) :: cache !! the body
      integer, intent(in) :: n_noted !! how many numbers a state notes of its cycle
      character(*), intent(in) :: stem !! directory and name of the case

      stated%stem = stem
      stated%entries = ''
      associate (history => model%history, n_sets => size(cache%body%zone%pairs), &
         stiffness => sum(cache%problem%augmentation()))
         call read_table(summary, stated%steps, stem//'.history.csv', history_header(history, n_sets), &
            history_kinds(history, n_sets), stiffness)
         if (history%points_every > 0) call read_table(summary, stated%points, stem//'.points.csv', &
            points_header(history), point_kinds(history), stiffness)
         if (size(model%cycle_times) > 0) call read_table(summary, stated%cycles, stem//'.cycles.csv', &
            cycles_header(history), cycle_kinds(history), stiffness)
         if (history%states_every > 0) call read_table(summary, stated%states, stem//'.states.csv', &
            states_header(history, cache%body%zone%n_points, n_noted))
      end associate
   end subroutine read_tables

   !> Reads a table.
   subroutine read_table(summary, table, path, header, kinds, stiffness)
      type(summary_file_t), intent(inout) :: summary !! gains the fault
      type(stated_table_t), intent(out) :: table !! the table; without rows if it cannot be read
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: header !! its first line, with its end
      integer, intent(in), optional :: kinds(:) !! the kind of each column but the last; of any number without them
      real(dp), intent(in), optional :: stiffness !! stiffness of all contact points together, with kinds [F/L]
      character(:), allocatable :: fault

      table%path = path
      table%header = header(:len(header) - 1)
      if (present(kinds)) then
         call read_csv_table(table%csv, path, table%header, size(kinds) + 1, fault)
         call find_largest(table%largest, table%csv, kinds, stiffness)
         table%scales = table%largest(kinds)
      else
         call read_csv_table(table%csv, path, table%header, fault=fault)
      end if
      if (len(fault) == 0) return
      call summary%faults%add(path, fault)
      table%csv%n_rows = 0
   end subroutine read_table

   !> Finds the largest number of each kind, which the others are measured by. Displacements are at least that of all
   !> contact points under the largest force: less is rounding, as slips are where nothing slips.
   subroutine find_largest(largest, table, kinds, stiffness)
      real(dp), intent(out) :: largest(n_kinds) !! the largest number of each kind
      type(csv_table_t), intent(in) :: table !! the table
      integer, intent(in) :: kinds(:) !! the kind of each column
      real(dp), intent(in) :: stiffness !! stiffness of all contact points together [F/L]
      real(dp) :: value
      character(:), allocatable :: fault
      integer :: i, k

      largest = 0.0_dp
      largest(number_alone) = 1.0_dp
      fault = ''
      do i = 1, table%n_rows
         do k = 1, size(kinds)
            if (kinds(k) == number_alone) cycle
            ! What is no number differs from what is computed.
            call table%get_number(i, k, value, fault)
            largest(kinds(k)) = max(largest(kinds(k)), abs(value))
         end do
      end do
      if (stiffness > 0.0_dp) largest(a_length) = max(largest(a_length), largest(a_force)/stiffness)
   end subroutine find_largest

   !> Takes the steps again, row by row, up to the first one that disagrees.
   subroutine retrace(summary, stated, cache, model, method, config, result)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(inout) :: stated !! the tables
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(config_t), intent(in) :: config !! the deck
      type(history_result_t), intent(inout) :: result !! the way where it begins; gains the steps
      integer :: row, n_faults

      n_faults = summary%faults%n
      do row = 1, stated%steps%csv%n_rows
         call take_stated_step(summary, stated, row, cache, model, method, result)
         if (summary%faults%n > n_faults) return
         if (is_shown(result%walk%n_steps, model%history%points_every)) call compare_rows(summary, stated%points, &
            points_rows(model, cache%body, result%walk), row)
         if (summary%faults%n == n_faults .and. result%walk%watch%is_finished) call compare_rows(summary, &
            stated%cycles, cycle_row(model%history, result%walk%watch%numbers), row)
         if (summary%faults%n == n_faults) call compare_state(summary, stated, cache, model, method, &
            result%walk)
         if (summary%faults%n > n_faults) return
         if (is_shown(result%walk%n_steps, model%history%fields_every)) call compare_fields(summary, stated, row, &
            cache, model, config, result%walk)
      end do
      call compare_end(summary, stated%points)
      call compare_end(summary, stated%cycles)
      call compare_end(summary, stated%states)
      if (model%history%fields_every > 0) call compare_collection(summary%faults, &
         stated%stem//'.history.pvd', stated%entries)
   end subroutine retrace

   !> Takes a step to the time that its row states, and compares the row.
   subroutine take_stated_step(summary, stated, row, cache, model, method, result)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(in) :: stated !! the tables
      integer, intent(in) :: row !! row of the step
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(history_result_t), intent(inout) :: result !! the way; gains the step
      type(step_state_t) :: next
      character(:), allocatable :: fault, text
      real(dp) :: numbers(3)
      logical :: is_lost

      fault = ''
      associate (steps => stated%steps%csv, times => model%history%times)
         call steps%get_number(row, 2, numbers(1), fault)
         call steps%get_number(row, steps%column('residual'), numbers(2), fault)
         call steps%get_number(row, size(stated%steps%scales), numbers(3), fault)
         if (len(fault) == 0 .and. .not. (numbers(1) >= result%walk%state%instant%time .and. &
            numbers(1) <= times(size(times)))) fault = 'the times do not ascend within the history'
      end associate
      if (len(fault) == 0 .and. .not. numbers(2) <= method%tolerance) fault = 'the residual is above the tolerance'
      if (len(fault) == 0) call solve_as_stated(next, fault, stated%steps, row, cache, model, method, &
         result%walk%state)
      if (len(fault) == 0) then
         call result%walk%note(model, next)
         result%walk%is_jump = .not. has_balance(next, model%history)
         call result%note_step(cache%body, model%history)
         ! What the method took is its own affair.
         next%solution%residual = numbers(2)
         next%solution%n_iterations = nint(numbers(size(numbers)))
         text = history_row(model, cache%body, result%walk%n_steps, next)
         call compare_line(fault, stated%steps%csv%row(row), text(:len(text) - 1), stated%steps%header, &
            stated%steps%scales, 0.0_dp, is_lost)
      end if
      if (len(fault) > 0) call summary%faults%add(stated%steps%path//':'//to_text(row + 1), fault)
   end subroutine take_stated_step

   !> Solves a step again, and follows its row where the law leaves it several answers.
   subroutine solve_as_stated(next, fault, steps, row, cache, model, method, before)
      type(step_state_t), intent(out) :: next !! the state at the end of the step
      character(:), allocatable, intent(inout) :: fault !! gains why there is none
      type(stated_table_t), intent(in) :: steps !! the table of steps
      integer, intent(in) :: row !! row of the step
      type(cache_t), intent(inout) :: cache !! the body, its contact problem left as that of the step
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(step_state_t), intent(in) :: before !! the state at its beginning
      real(dp) :: time, closing_loss

      call steps%csv%get_number(row, 2, time, fault)
      call steps%csv%get_number(row, steps%csv%column('closing_loss'), closing_loss, fault)
      if (len(fault) == 0) call solve_again(next, fault, cache, model, method, before, time)
      if (len(fault) > 0 .or. cache%body%zone%n_points == 0) return
      associate (scales => scales_of(steps, cache, method, next))
         call follow_statuses(next, steps%csv%field(row, steps%csv%column('statuses')), cache%problem, cache%body, &
            scales)
         call follow_place(next, closing_loss, before, cache%body, scales)
      end associate
   end subroutine solve_as_stated

   !> What counts as none in a step.
   pure type(law_scales_t) function scales_of(steps, cache, method, state) result(scales)
      type(stated_table_t), intent(in) :: steps !! the table of steps
      type(cache_t), intent(in) :: cache !! the body, its contact problem that of the step
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(step_state_t), intent(in) :: state !! the state at its end

      scales = step_scales(certificate_limit(method%tolerance), steps%largest(a_force), cache%problem, cache%body, &
         state)
   end function scales_of

   !> Compares the next rows of a table with what they should be.
   subroutine compare_rows(summary, table, rows, row)
      type(summary_file_t), intent(inout) :: summary !! gains the fault
      type(stated_table_t), intent(inout) :: table !! the table
      character(*), intent(in) :: rows !! what should stand there, lines of text
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
            call compare_line(fault, table%csv%row(table%n_compared), rows(first:last), table%header, table%scales, &
               0.0_dp, is_lost)
         end if
         if (len(fault) > 0) call summary%faults%add(table%path//':'//to_text(table%n_compared + 1), fault)
         if (len(fault) > 0) return
         first = last + 2
      end do
   end subroutine compare_rows

   !> Finds rows behind those that the steps have.
   subroutine compare_end(summary, table)
      type(summary_file_t), intent(inout) :: summary !! gains the fault
      type(stated_table_t), intent(in) :: table !! the table, all steps compared

      if (table%n_compared < table%csv%n_rows) call summary%faults%add(table%path, &
         'there are more rows than the steps have')
   end subroutine compare_end

   !> Compares a state from which a history can go on.
   subroutine compare_state(summary, stated, cache, model, method, walk)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(inout) :: stated !! the tables
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(history_walk_t), intent(in) :: walk !! the way, at the end of the step
      type(history_walk_t) :: found
      type(error_t), allocatable :: error
      real(dp), allocatable :: numbers(:)
      logical :: is_same

      if (.not. is_shown(walk%n_steps, model%history%states_every)) return
      stated%states%n_compared = stated%states%n_compared + 1
      associate (states => stated%states)
         is_same = states%n_compared <= states%csv%n_rows
         if (is_same) call read_reals(states%csv%row(states%n_compared), numbers, is_same)
      end associate
      if (is_same) then
         call new_history_walk(found, model, cache%body)
         call found%restore(model, cache%body, cache%problem, numbers, error)
         is_same = .not. allocated(error)
      end if
      if (is_same) is_same = found%n_steps == walk%n_steps
      if (is_same) is_same = states_agree(found%state, walk%state, stated%steps%largest, hovers(walk%state, &
         cache%body, scales_of(stated%steps, cache, method, walk%state))) .and. &
         first_disagreement(found%watch%noted(), walk%watch%noted()) == 0
      if (.not. is_same) call summary%faults%add(stated%states%path//':'//to_text(stated%states%n_compared + 1), &
         'it is not the state of step '//to_text(walk%n_steps))
   end subroutine compare_state

   !> Compares the grids of a step.
   subroutine compare_fields(summary, stated, row, cache, model, config, walk)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(inout) :: stated !! the tables; gains the entries of the collection
      integer, intent(in) :: row !! row of the step
      type(cache_t), intent(in) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      type(config_t), intent(in) :: config !! the deck
      type(history_walk_t), intent(in) :: walk !! the way, at the end of the step
      type(result_t) :: step
      type(error_t), allocatable :: error
      character(:), allocatable :: name, number

      number = stated%steps%csv%field(row, 1)
      step%wants_error_estimate = config%accuracy%wants_estimate()
      call new_step_result(step, cache, model, walk, error)
      ! not raised: the numbers of the step were finite
      if (allocated(error)) return
      call check_grids(summary%faults, config%units, cache%body, step, stated%stem//'.history/'//number)
      name = stated%stem(index(stated%stem, '/', back=.true.) + 1:)
      stated%entries = stated%entries//case_entries(stated%steps%csv%field(row, 2), name//'.history/'//number)
   end subroutine compare_fields

end module amontons_verify_history
