!> The files of a history checked against its deck and each other: every step is solved again, from the anchors that the
!> step before has left, to the time that its row states. Rows, states, contact points and grids are written again from
!> these steps; the files of the last one are restored and judged on the full model like those of a case.
module amontons_verify_history
   use amontons_agreement, only: first_disagreement
   use amontons_collection, only: case_entries, collection_head, collection_tail
   use amontons_config, only: config_t
   use amontons_contact_method, only: contact_method_t
   use amontons_csv_table, only: csv_table_t, read_csv_table
   use amontons_document_check, only: compare_line
   use amontons_error, only: error_t
   use amontons_history, only: is_shown
   use amontons_history_milestone, only: read_start
   use amontons_history_model, only: history_model_t, instant_t
   use amontons_history_table, only: history_header, history_kinds, history_row, n_kinds, number_alone, point_kinds, &
      points_header, points_rows, states_header
   use amontons_history_walk, only: has_balance, history_walk_t, new_history_walk
   use amontons_kinds, only: dp
   use amontons_result, only: result_t
   use amontons_solve_case, only: cache_t
   use amontons_solve_history, only: history_result_t, new_step_result, prepare_history
   use amontons_stepper, only: step_state_t, take_step
   use amontons_summary_file, only: summary_file_t
   use amontons_text, only: newline, read_reals, to_text
   use amontons_text_file, only: read_text_file
   use amontons_verify_case, only: check_grids, verify_result
   implicit none (type, external)
   private

   public :: verify_history

   !> The tables of a history while its steps are taken again.
   type :: stated_t
      character(:), allocatable :: stem !! directory and name of the case
      type(csv_table_t) :: steps !! NAME.history.csv
      type(csv_table_t) :: points !! NAME.points.csv
      type(csv_table_t) :: states !! NAME.states.csv
      integer :: n_points = 0 !! rows of the contact points that were compared
      integer :: n_states = 0 !! rows of the states that were compared
      real(dp), allocatable :: step_scales(:) !! what each column of the steps is measured by
      real(dp), allocatable :: point_scales(:) !! the same of the contact points
      character(:), allocatable :: entries !! what the collection of the grids has so far
   end type stated_t

contains

   !> Checks the files of a history.
   subroutine verify_history(summary, cache, config, stem, is_certified)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the history needs another
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(out) :: is_certified !! whether it is complete, and its last step certified
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
      if (solved%factorization == 'distributed') solved%factorization = 'auto'
      call prepare_history(cache, solved, method, model, result%last, error)
      if (.not. allocated(error)) call begin(result%walk, cache, model, error)
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      n_faults = summary%faults%n
      call read_tables(summary, stated, model, cache, stem)
      if (summary%faults%n == n_faults) call retrace(summary, stated, cache, model, method, config, result)
      if (summary%faults%n > n_faults) return
      call result%add_jumps()
      result%last%is_complete = summary%value('load_history', 'complete') == 'true'
      associate (state => result%walk%state)
         call model%load_case(cache%body, state%instant, state%anchor, result%last%load_case, error)
         ! not raised: the step itself had this load case
         if (allocated(error)) return
         result%last%slip_record = state%slip_record(cache%body)
      end associate
      call verify_result(summary, cache%body, config, stem, result%last, is_certified)
      is_certified = is_certified .and. result%last%is_complete
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
   subroutine read_tables(summary, stated, model, cache, stem)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(inout) :: stated !! gains the tables
      type(history_model_t), intent(in) :: model !! the history
      type(cache_t), intent(in) :: cache !! the body
      character(*), intent(in) :: stem !! directory and name of the case

      stated%stem = stem
      stated%entries = collection_head
      associate (history => model%history)
         call read_table(summary, stated%steps, stem//'.history.csv', history_header(history), &
            size(history_kinds(history)) + 1)
         call find_scales(stated%step_scales, stated%steps, history_kinds(history))
         if (history%points_every > 0) then
            call read_table(summary, stated%points, stem//'.points.csv', points_header(history), size(point_kinds) + 1)
            call find_scales(stated%point_scales, stated%points, point_kinds)
         end if
         if (history%states_every > 0) call read_table(summary, stated%states, stem//'.states.csv', &
            states_header(history, cache%body%zone%n_points))
      end associate
   end subroutine read_tables

   !> Reads a table.
   subroutine read_table(summary, table, path, header, n_columns)
      type(summary_file_t), intent(inout) :: summary !! gains the fault
      type(csv_table_t), intent(out) :: table !! the table; without rows if it cannot be read
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: header !! its first line
      integer, intent(in), optional :: n_columns !! number of its columns
      character(:), allocatable :: fault

      call read_csv_table(table, path, header(:len(header) - 1), n_columns, fault)
      if (len(fault) == 0) return
      call summary%faults%add(path, fault)
      table%n_rows = 0
   end subroutine read_table

   !> Finds what the numbers of each column are measured by: the largest of their kind.
   subroutine find_scales(scales, table, kinds)
      real(dp), allocatable, intent(out) :: scales(:) !! the scale of each column
      type(csv_table_t), intent(in) :: table !! the table
      integer, intent(in) :: kinds(:) !! the kind of each column
      real(dp) :: largest(n_kinds), value
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
      scales = largest(kinds)
   end subroutine find_scales

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
      do row = 1, stated%steps%n_rows
         call take_stated_step(summary, stated, row, cache, model, method, result)
         if (summary%faults%n == n_faults) call compare_points(summary, stated, cache, model, result%walk)
         if (summary%faults%n == n_faults) call compare_state(summary, stated, cache, model, result%walk)
         if (summary%faults%n > n_faults) return
         if (is_shown(result%walk%n_steps, model%history%fields_every)) call compare_fields(summary, stated, row, &
            cache, model, config, result%walk%state)
      end do
      if (stated%n_points < stated%points%n_rows) call summary%faults%add(stated%stem//'.points.csv', &
         'there are more rows than the steps have')
      if (stated%n_states < stated%states%n_rows) call summary%faults%add(stated%stem//'.states.csv', &
         'there are more rows than the steps have')
      if (model%history%fields_every > 0) call compare_collection_text(summary, stated)
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
      character(:), allocatable :: fault
      real(dp) :: numbers(3)

      fault = ''
      associate (steps => stated%steps, times => model%history%times)
         call steps%get_number(row, 2, numbers(1), fault)
         call steps%get_number(row, steps%column('residual'), numbers(2), fault)
         call steps%get_number(row, size(stated%step_scales), numbers(3), fault)
         if (len(fault) == 0 .and. .not. (numbers(1) >= result%walk%state%instant%time .and. &
            numbers(1) <= times(size(times)))) fault = 'the times do not ascend within the history'
      end associate
      if (len(fault) == 0 .and. .not. numbers(2) <= method%tolerance) fault = 'the residual is above the tolerance'
      if (len(fault) == 0) call solve_again(next, fault, cache, model, method, result%walk%state, numbers(1))
      if (len(fault) == 0) then
         result%walk%state = next
         result%walk%n_steps = result%walk%n_steps + 1
         result%walk%is_jump = .not. has_balance(next, model%history)
         call result%note_step(cache%body, model%history)
         ! What the method took is its own affair.
         next%solution%residual = numbers(2)
         next%solution%n_iterations = nint(numbers(size(numbers)))
         call compare_row(fault, stated, row, cache, model, result%walk%n_steps, next)
      end if
      if (len(fault) > 0) call summary%faults%add(stated%stem//'.history.csv:'//to_text(row + 1), fault)
   end subroutine take_stated_step

   !> Solves a step again.
   subroutine solve_again(next, fault, cache, model, method, before, time)
      type(step_state_t), intent(out) :: next !! the state at its end
      character(:), allocatable, intent(inout) :: fault !! gains why it has none
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      class(contact_method_t), intent(in) :: method !! the deck's method
      type(step_state_t), intent(in) :: before !! the state at its beginning
      real(dp), intent(in) :: time !! the time that it leads to [-]
      type(instant_t) :: instant
      type(error_t), allocatable :: error

      call model%at(cache%body, time, instant, error)
      if (.not. allocated(error)) call take_step(next, model, cache%body, cache%problem, method, before, instant, error)
      if (allocated(error)) then
         fault = error%message
      else if (.not. next%solution%is_converged) then
         fault = 'the step does not converge again'
      end if
   end subroutine solve_again

   !> Compares the row of a step.
   subroutine compare_row(fault, stated, row, cache, model, number, state)
      character(:), allocatable, intent(inout) :: fault !! gains what does not agree
      type(stated_t), intent(in) :: stated !! the tables
      integer, intent(in) :: row !! the row
      type(cache_t), intent(in) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      integer, intent(in) :: number !! number of the step
      type(step_state_t), intent(in) :: state !! the state at the end of the step
      character(:), allocatable :: text, header
      logical :: is_lost

      text = history_row(model, cache%body, number, state)
      header = history_header(model%history)
      call compare_line(fault, stated%steps%row(row), text(:len(text) - 1), header(:len(header) - 1), &
         stated%step_scales, 0.0_dp, is_lost)
   end subroutine compare_row

   !> Compares the rows of the contact points of a step.
   subroutine compare_points(summary, stated, cache, model, walk)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(inout) :: stated !! the tables
      type(cache_t), intent(in) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      type(history_walk_t), intent(in) :: walk !! the way, at the end of the step
      character(:), allocatable :: rows, header, fault
      integer :: first, last
      logical :: is_lost

      if (.not. is_shown(walk%n_steps, model%history%points_every)) return
      rows = points_rows(model, cache%body, walk%n_steps, walk%state)
      header = points_header(model%history)
      first = 1
      do while (first < len(rows))
         last = first + index(rows(first:), newline) - 2
         stated%n_points = stated%n_points + 1
         if (stated%n_points > stated%points%n_rows) then
            fault = 'rows of step '//to_text(walk%n_steps)//' are missing'
         else
            call compare_line(fault, stated%points%row(stated%n_points), rows(first:last), &
               header(:len(header) - 1), stated%point_scales, 0.0_dp, is_lost)
         end if
         if (len(fault) > 0) call summary%faults%add(stated%stem//'.points.csv:'//to_text(stated%n_points + 1), fault)
         if (len(fault) > 0) return
         first = last + 2
      end do
   end subroutine compare_points

   !> Compares a state from which a history can go on.
   subroutine compare_state(summary, stated, cache, model, walk)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(inout) :: stated !! the tables
      type(cache_t), intent(inout) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      type(history_walk_t), intent(in) :: walk !! the way, at the end of the step
      type(history_walk_t) :: found
      type(error_t), allocatable :: error
      real(dp), allocatable :: numbers(:)
      logical :: is_same

      if (.not. is_shown(walk%n_steps, model%history%states_every)) return
      stated%n_states = stated%n_states + 1
      is_same = stated%n_states <= stated%states%n_rows
      if (is_same) call read_reals(stated%states%row(stated%n_states), numbers, is_same)
      if (is_same) then
         call new_history_walk(found, model, cache%body)
         call found%restore(model, cache%body, cache%problem, numbers, error)
         is_same = .not. allocated(error)
      end if
      if (is_same) is_same = found%n_steps == walk%n_steps
      if (is_same) is_same = agree_all(found%state, walk%state)
      if (.not. is_same) call summary%faults%add(stated%stem//'.states.csv:'//to_text(stated%n_states + 1), &
         'it is not the state of step '//to_text(walk%n_steps))
   end subroutine compare_state

   !> Whether two states agree.
   pure logical function agree_all(found, computed)
      type(step_state_t), intent(in) :: found !! a state as a file has it
      type(step_state_t), intent(in) :: computed !! the state that was computed

      associate (v => computed%solution%displacement, works => [computed%load_work, computed%support_work, &
         computed%obstacle_work, computed%strain_energy])
         agree_all = first_disagreement(found%solution%force, computed%solution%force) == 0 .and. &
            first_disagreement(found%solution%displacement, v) == 0 .and. &
            first_disagreement(found%anchor, computed%anchor, maxval(abs(v))) == 0 .and. &
            first_disagreement(found%accumulated_slip, computed%accumulated_slip, maxval(abs(v))) == 0 .and. &
            first_disagreement(found%dissipation, computed%dissipation, maxval(abs(works))) == 0 .and. &
            first_disagreement(found%worn, computed%worn) == 0 .and. &
            first_disagreement([found%load_work, found%support_work, found%obstacle_work, found%strain_energy], &
            works) == 0
      end associate
   end function agree_all

   !> Compares the grids of a step.
   subroutine compare_fields(summary, stated, row, cache, model, config, state)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(stated_t), intent(inout) :: stated !! the tables; gains the entries of the collection
      integer, intent(in) :: row !! row of the step
      type(cache_t), intent(in) :: cache !! the body
      type(history_model_t), intent(in) :: model !! the history
      type(config_t), intent(in) :: config !! the deck
      type(step_state_t), intent(in) :: state !! the state at the end of the step
      type(result_t) :: step
      type(error_t), allocatable :: error
      character(:), allocatable :: name, number

      number = stated%steps%field(row, 1)
      call new_step_result(step, cache, model, state, error)
      ! not raised: the numbers of the step were finite
      if (allocated(error)) return
      call check_grids(summary%faults, config%units, cache%body, step, stated%stem//'.history/'//number)
      name = stated%stem(index(stated%stem, '/', back=.true.) + 1:)
      stated%entries = stated%entries//case_entries(stated%steps%field(row, 2), name//'.history/'//number)
   end subroutine compare_fields

   !> Compares the collection of the grids.
   subroutine compare_collection_text(summary, stated)
      type(summary_file_t), intent(inout) :: summary !! gains the fault
      type(stated_t), intent(in) :: stated !! the tables and the entries
      character(:), allocatable :: text
      type(error_t), allocatable :: error
      logical :: is_same

      call read_text_file(stated%stem//'.history.pvd', text, error)
      is_same = .not. allocated(error)
      if (is_same) is_same = text == stated%entries//collection_tail
      if (.not. is_same) call summary%faults%add(stated%stem//'.history.pvd', &
         'it does not list the grids of the steps at their times')
   end subroutine compare_collection_text

end module amontons_verify_history
