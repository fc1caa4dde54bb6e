!> Verification of the files of a history with its deck and with each other: all steps are taken again, and what a run
!> writes of each is compared with what was written: rows, contact points, states, cycles and grids. The files of the
!> last step are restored and verified on the full model like those of a case. A history that ended early must end there
!> again.
module amontons_verify_history
   use amontons_body, only: body_t
   use amontons_document, only: document_t, read_status_runs
   use amontons_error, only: error_t, fault_list_t
   use amontons_file_check, only: agree, compare_document, csv_table_t, read_csv_table, verified_case_t
   use amontons_history_files, only: a_force, a_length, a_moment, history_files_t, n_kinds, number_alone
   use amontons_history_model, only: history_model_t
   use amontons_history_study, only: add_history_results, describe_history, history_result_t, new_step_result, &
      prepare_history, start_history, take_steps, worst_names
   use amontons_kinds, only: dp
   use amontons_manifest, only: case_entries, collection_tail
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

   !> The files of a history that was solved before: its tables grow in memory, and are then compared with the files.
   type, extends(history_files_t) :: history_check_t
      character(:), allocatable :: stem !! directory and name of the case
      type(csv_table_t) :: stated !! the table of the steps as the file has it
      integer :: n_steps = 0 !! number of steps taken
      type(law_scales_t) :: scales !! lengths and forces that count as zero
      type(fault_list_t) :: faults !! what does not agree
   contains
      procedure :: add_fields => history_check_add_fields
      procedure :: add_step => history_check_add_step
      procedure :: compare => history_check_compare
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
            call check%prepare(model, cache%body, stepping, '', case%config)
            call read_steps(check, case, model, cache)
            if (check%faults%n == 0) call take_steps(cache, model, check, monitor, result, error)
            if (check%faults%n == 0 .and. stepping%n_steps > 0) call check%compare(model, cache)
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

   !> Reads the table of the steps, and finds what counts as zero. Without a first step there is none.
   subroutine read_steps(check, case, model, cache)
      type(history_check_t), intent(inout) :: check !! the files; gain the table
      type(verified_case_t), intent(in) :: case !! the history
      type(history_model_t), intent(in) :: model !! the history
      type(cache_t), intent(in) :: cache !! the body
      character(:), allocatable :: fault
      real(dp) :: largest(n_kinds)

      check%stem = case%stem
      if (len(case%value('', 'message')) > 0) return
      associate (table => check%tables(1), stated => check%stated)
         call read_csv_table(stated, case%stem//table%ending, table%header, size(table%kinds), fault)
         if (len(fault) > 0) then
            call check%faults%add(case%stem//table%ending, fault)
         else
            largest = largest_numbers(stated%text(len(table%header) + 1:), table%kinds)
            check%scales = scales_of(model%solver%method%tolerance, largest(a_force), &
               cache%problem%matrix%augmentation)
         end if
      end associate
   end subroutine read_steps

   !> The largest magnitudes of the numbers of each kind in rows of a table; 1 of numbers that stand alone.
   pure function largest_numbers(rows, kinds) result(largest)
      character(*), intent(in) :: rows !! the rows, whole lines
      integer, intent(in) :: kinds(:) !! kinds of its columns; none of a text that is no table
      real(dp) :: largest(n_kinds), value
      integer :: first, k, last
      logical :: is_number

      largest = 0.0_dp
      largest(number_alone) = 1.0_dp
      first = merge(1, len(rows) + 1, size(kinds) > 0)
      k = 0
      do while (first <= len(rows))
         last = first + scan(rows(first:), ','//newline) - 2
         k = 1 + modulo(k, size(kinds))
         if (kinds(k) /= number_alone) then
            call read_real(rows(first:last), value, is_number)
            largest(kinds(k)) = max(largest(kinds(k)), abs(value))
         end if
         first = last + 2
      end do
   end function largest_numbers

   !> Adds the rows of a step, with the iterations and statuses that the file states; the history ends where that does.
   subroutine history_check_add_step(self, model, body, stepping)
      class(history_check_t), intent(inout) :: self !! the files; gain the rows, and the faults
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      type(time_stepping_t), intent(inout) :: stepping
         !! the time stepping at the end of the step; gains iterations and statuses of the row
      integer :: status(body%zone%n_points), n_iterations
      logical :: ok

      self%n_steps = self%n_steps + 1
      associate (n => self%n_steps, stated => self%stated, solution => stepping%state%solution, &
         path => self%stem//self%tables(1)%ending)
         if (n > stated%n_rows) then
            call self%faults%add(path, 'it ends before the history: a step to '// &
               to_text(stepping%state%instant%time)//' is possible')
         else
            call read_integer(stated%field(n, stated%column('iterations')), n_iterations, ok)
            if (ok) stepping%n_iterations = stepping%n_iterations + n_iterations - solution%n_iterations
            if (ok) solution%n_iterations = n_iterations
            call read_status_runs(status, stated%field(n, stated%column('statuses')), ok)
            if (ok) call follow_statuses(self%faults, solution, path//':'//to_text(n + 1), status, body, &
               model%solver%loads, stepping%state%instant, self%scales)
         end if
      end associate
      call self%history_files_t%add_step(model, body, stepping)
      if (self%faults%n > 0) stepping%is_ended = .true.
   end subroutine history_check_add_step

   !> Compares the grids of a step with its result.
   subroutine history_check_add_fields(self, body, number, time, result, error)
      class(history_check_t), intent(inout) :: self !! the files; gain the faults and the entry of the grids
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the step
      character(*), intent(in) :: time !! its time
      type(result_t), intent(in) :: result !! its result
      type(error_t), allocatable, intent(out) :: error !! never

      call check_grids(self%faults, self%units, body, result, self%stem//'.history/'//to_text(number))
      call self%checkpoint%add_rows(self%grids_table, case_entries(time, self%folder//to_text(number)))
   end subroutine history_check_add_fields

   !> Nothing is put on the disk.
   logical function history_check_is_due(self) result(is_due)
      class(history_check_t), intent(in) :: self !! the files

      is_due = .false.
      associate (unused => self)
      end associate
   end function history_check_is_due

   !> Compares the tables, and the collection of the grids, with the files.
   subroutine history_check_compare(self, model, cache)
      class(history_check_t), intent(inout) :: self !! the files; gain the faults
      type(history_model_t), intent(in) :: model !! the history
      type(cache_t), intent(in) :: cache !! the body
      type(document_t) :: document
      character(:), allocatable :: rows
      real(dp) :: largest(n_kinds)
      integer :: i

      do i = 1, size(self%tables)
         associate (table => self%tables(i), stiffness => sum(cache%problem%matrix%augmentation))
            rows = self%checkpoint%rows(i)
            largest = largest_numbers(rows, table%kinds)
            ! Forces may balance each other.
            largest(a_moment) = max(largest(a_moment), largest(a_force)*model%solver%size_of_body)
            if (stiffness > 0.0_dp) largest(a_length) = max(largest(a_length), largest(a_force)/stiffness)
            if (i == self%grids_table) rows = rows//collection_tail
            document = document_t()
            document%ending = table%ending
            call document%add(table%header//rows, [largest(table%kinds), 0.0_dp])
            call compare_document(self%faults, self%stem, document)
         end associate
      end do
   end subroutine history_check_compare

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
