!> Verification of the files of a history with its deck and with each other: all steps are taken again, and what a run
!> writes of each is compared with what was written: rows, contact points, states, cycles and grids. The files of the
!> last step are restored and verified on the full model like those of a case. A history that ended early must end there
!> again.
module amontons_verify_history
   use amontons_body, only: body_t
   use amontons_document, only: read_status_runs
   use amontons_error, only: error_t, fault_list_t
   use amontons_file_check, only: agree, compare_collection, compare_line, csv_table_t, read_csv_table, verified_case_t
   use amontons_history_files, only: a_force, a_length, a_moment, history_files_t, history_tables, n_kinds, &
      number_alone, of_grids, table_rows
   use amontons_history_model, only: history_model_t
   use amontons_history_study, only: add_history_results, describe_history, history_result_t, new_step_result, &
      prepare_history, start_history, take_steps, worst_names
   use amontons_kinds, only: dp
   use amontons_manifest, only: case_entries
   use amontons_quantity, only: largest_t
   use amontons_result, only: outcome_no_equilibrium, result_t
   use amontons_solve_case, only: cache_t, take_no_equilibrium
   use amontons_study, only: study_monitor_t
   use amontons_text, only: newline, read_integer, read_real, to_text
   use amontons_time_stepping, only: time_stepping_t
   use amontons_verify_case, only: check_grids, follow_statuses, law_scales_t, scales_of, verify_answer, verify_result
   implicit none (type, external)
   private

   public :: verify_history

   !> The files of a history that was solved before: they are compared with its steps instead of written.
   type, extends(history_files_t) :: history_check_t
      character(:), allocatable :: stem !! directory and name of the case
      type(csv_table_t), allocatable :: stated(:) !! the rows of each table; none of that of the grids
      real(dp), allocatable :: largest(:, :) !! the largest number of each kind in each table (n_kinds, tables)
      integer, allocatable :: n_compared(:) !! number of rows compared of each table
      type(law_scales_t) :: scales !! lengths and forces that count as zero
      type(fault_list_t) :: faults !! what does not agree
      character(:), allocatable :: entries !! entries of the collection of grids so far
   contains
      procedure :: add_fields => history_check_add_fields
      procedure :: add_step => history_check_add_step
      procedure :: finish_tables => history_check_finish_tables
      procedure :: is_due => history_check_is_due
   end type history_check_t

contains

   !> Verifies the files of a history. The verdict is that the last step is certified and the history complete, or that
   !> the next step has no equilibrium.
   subroutine verify_history(case, cache)
      type(verified_case_t), intent(inout) :: case !! the history; gains the faults of all files, and the verdict
      type(cache_t), intent(inout) :: cache !! the last body, replaced if the history needs another
      type(history_model_t) :: model
      type(history_result_t) :: result
      type(history_check_t) :: check
      type(study_monitor_t) :: monitor
      type(result_t) :: step
      type(error_t), allocatable :: error
      integer :: k, stated
      real(dp), allocatable :: start(:)
      logical :: is_done

      call prepare_history(cache, case%solved, model, result%last, error)
      if (.not. allocated(error)) call start_history(result, cache, model, start, error)
      call take_no_equilibrium(result%last, error)
      associate (last => result%last, stepping => result%stepping)
         if (.not. (allocated(error) .or. allocated(last%answer))) then
            call new_history_check(check, case, model, cache, size(stepping%record%saved_numbers()))
            if (check%faults%n == 0) call take_steps(cache, model, check, monitor, result, error)
            if (check%faults%n == 0) call check%finish_tables(stepping%n_steps)
            call case%faults%append(check%faults)
            if (check%faults%n > 0) return
            call result%record_end()
         end if
         call verify_answer(case, cache, last, error, is_done)
         if (is_done) return
         call new_step_result(step, cache, model, stepping, error)
         ! not raised: the numbers of the step were finite
         if (allocated(error)) return
         call result%record_certificate(step%certificate%largest())
         last%load_case = step%load_case
         last%slip_record = step%slip_record
         ! Takes what only the run knew from the summary, and numbers of the size of rounding, which are others on
         ! another machine, as far as they can be true.
         do k = 1, size(worst_names)
            call adopt_stated_worst(case, k, stepping%n_steps, result%worst(k))
         end do
         stated = nint(case%number('load_history', 'steps_done_earlier'))
         if (stated > 0 .and. stated <= stepping%n_steps) result%n_resumed = stated
         call add_history_results(result, model, cache%body)
         call describe_history(result, case%config)
         call verify_result(case, cache%body, last)
         if (.not. last%is_complete) case%is_certified = case%is_certified .and. last%outcome == outcome_no_equilibrium
      end associate
   end subroutine verify_history

   !> Reads the tables of a history, and finds the scales of their numbers. Without a first step there are none.
   subroutine new_history_check(check, case, model, cache, n_noted)
      type(history_check_t), intent(out) :: check !! the tables
      type(verified_case_t), intent(in) :: case !! the history
      type(history_model_t), intent(in) :: model !! the history
      type(cache_t), intent(in) :: cache !! the body
      integer, intent(in) :: n_noted !! how many numbers a state notes of the cycle under way
      character(:), allocatable :: fault, text
      real(dp) :: value, stiffness
      integer :: i, k, row, first, length
      logical :: is_number

      check%stem = case%stem
      check%name = case%config%name
      check%folder = check%name//'.history/'
      check%units = case%config%units
      check%entries = ''
      call history_tables(check%tables, model, cache%body, n_noted)
      allocate (check%stated(size(check%tables)))
      check%n_compared = spread(0, 1, size(check%tables))
      allocate (check%largest(n_kinds, size(check%tables)), source=0.0_dp)
      check%largest(number_alone, :) = 1.0_dp
      if (len(case%value('', 'message')) > 0) return
      stiffness = sum(cache%problem%matrix%augmentation)
      do i = 1, size(check%tables)
         associate (table => check%tables(i), largest => check%largest(:, i))
            if (table%content == of_grids) cycle
            call read_csv_table(check%stated(i), case%stem//table%ending, table%header, size(table%kinds), fault)
            if (len(fault) > 0) call check%faults%add(case%stem//table%ending, fault)
            if (len(fault) > 0) cycle
            do row = 1, check%stated(i)%n_rows
               text = check%stated(i)%row(row)//','
               first = 1
               do k = 1, size(table%kinds)
                  length = index(text(first:), ',') - 1
                  ! A field that is not a number differs from the computed one.
                  call read_real(text(first:first + length - 1), value, is_number)
                  if (is_number .and. table%kinds(k) /= number_alone) largest(table%kinds(k)) = &
                     max(largest(table%kinds(k)), abs(value))
                  first = first + length + 1
               end do
            end do
            ! Forces may balance each other.
            largest(a_moment) = max(largest(a_moment), largest(a_force)*model%solver%size_of_body)
            if (stiffness > 0.0_dp) largest(a_length) = max(largest(a_length), largest(a_force)/stiffness)
         end associate
      end do
      check%scales = scales_of(model%solver%method%tolerance, check%largest(a_force, 1), &
         cache%problem%matrix%augmentation)
   end subroutine new_history_check

   !> Compares the rows of a step; the history ends at the first step that does not agree.
   subroutine history_check_add_step(self, model, body, stepping)
      class(history_check_t), intent(inout) :: self !! the tables; gain the faults
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      type(time_stepping_t), intent(inout) :: stepping
         !! the time stepping at the end of the step; gains iterations and statuses of the row
      integer :: status(body%zone%n_points), i, n, n_iterations
      logical :: ok

      n = self%n_compared(1) + 1
      associate (steps => self%stated(1), solution => stepping%state%solution, &
         path => self%stem//self%tables(1)%ending)
         if (n > steps%n_rows) then
            call self%faults%add(path, 'it ends before the history: a step to '// &
               to_text(stepping%state%instant%time)//' is possible')
         else
            call read_integer(steps%field(n, steps%column('iterations')), n_iterations, ok)
            if (ok) stepping%n_iterations = stepping%n_iterations + n_iterations - solution%n_iterations
            if (ok) solution%n_iterations = n_iterations
            call read_status_runs(status, steps%field(n, steps%column('statuses')), ok)
            if (ok) call follow_statuses(self%faults, solution, path//':'//to_text(n + 1), status, body, &
               model%solver%loads, stepping%state%instant, self%scales)
            do i = 1, size(self%tables)
               if (self%tables(i)%content /= of_grids) call compare_rows(self, i, &
                  table_rows(self%tables(i), model, body, stepping))
            end do
         end if
      end associate
      if (self%faults%n > 0) stepping%is_ended = .true.
   end subroutine history_check_add_step

   !> Compares the next rows of a table with the expected ones.
   subroutine compare_rows(check, number, rows)
      type(history_check_t), intent(inout) :: check !! the tables; gain the fault
      integer, intent(in) :: number !! number of the table
      character(*), intent(in) :: rows !! the expected lines of text
      character(:), allocatable :: fault
      integer :: first, last
      logical :: is_lost

      associate (stated => check%stated(number), table => check%tables(number), n => check%n_compared(number))
         first = 1
         do while (first < len(rows))
            last = first + index(rows(first:), newline) - 2
            n = n + 1
            if (n > stated%n_rows) then
               fault = 'rows are missing'
            else
               call compare_line(fault, stated%row(n), rows(first:last), stated%header, &
                  check%largest(table%kinds(:size(table%kinds) - 1), number), 0.0_dp, is_lost)
            end if
            if (len(fault) > 0) call check%faults%add(check%stem//table%ending//':'//to_text(n + 1), fault)
            if (len(fault) > 0) return
            first = last + 2
         end do
      end associate
   end subroutine compare_rows

   !> Compares the grids of a step with its result.
   subroutine history_check_add_fields(self, body, number, time, result, error)
      class(history_check_t), intent(inout) :: self !! the files; gain the faults and the entry of the grids
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the step
      character(*), intent(in) :: time !! its time
      type(result_t), intent(in) :: result !! its result
      type(error_t), allocatable, intent(out) :: error !! never

      call check_grids(self%faults, self%units, body, result, self%stem//'.history/'//to_text(number))
      self%entries = self%entries//case_entries(time, self%folder//to_text(number))
   end subroutine history_check_add_fields

   !> Nothing is put on the disk.
   logical function history_check_is_due(self) result(is_due)
      class(history_check_t), intent(in) :: self !! the files

      is_due = .false.
      associate (unused => self)
      end associate
   end function history_check_is_due

   !> Compares the collection of grids, and reports rows of tables that belong to no step.
   subroutine history_check_finish_tables(self, n_steps)
      class(history_check_t), intent(inout) :: self !! the files; gain the faults
      integer, intent(in) :: n_steps !! number of steps
      integer :: i

      do i = 1, merge(size(self%tables), 0, n_steps > 0)
         associate (path => self%stem//self%tables(i)%ending)
            if (self%tables(i)%content == of_grids) then
               call compare_collection(self%faults, path, self%entries)
            else if (self%n_compared(i) < self%stated(i)%n_rows) then
               call self%faults%add(path, 'there are more rows than the steps have')
            end if
         end associate
      end do
   end subroutine history_check_finish_tables

   !> Takes the largest number of all steps from the summary, if it agrees within rounding.
   subroutine adopt_stated_worst(case, number, n_steps, worst)
      type(verified_case_t), intent(in) :: case !! the history
      integer, intent(in) :: number !! index of the number in `worst_names`
      integer, intent(in) :: n_steps !! number of the last step
      type(largest_t), intent(inout) :: worst !! the number as it was computed again
      type(largest_t) :: stated

      associate (name => worst_names(number))
         stated = largest_t(case%number('load_history', trim(name)), &
            nint(case%number('load_history', trim(name)//'_step')))
      end associate
      if (.not. agree(stated%value, worst%value, 1.0_dp)) return
      ! Of numbers that are rounding any may be the largest.
      if (agree(worst%value, 0.0_dp, 1.0_dp) .and. stated%at > 0 .and. stated%at <= n_steps) worst%at = stated%at
      worst%value = stated%value
   end subroutine adopt_stated_worst

end module amontons_verify_history
