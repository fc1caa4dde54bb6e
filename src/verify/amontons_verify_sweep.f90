!> The files of a sweep checked against each other: rows, summary and listing are written again from the values of the
!> deck and from what the rows state. A row holds no displacements: where the fields of its case are not kept, its
!> forces and its residual cannot be computed again without solving the case, and are only checksummed.
module amontons_verify_sweep
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_csv_table, only: csv_table_t, read_csv_table
   use amontons_document, only: document_t
   use amontons_document_check, only: compare_document, compare_line
   use amontons_error, only: error_t
   use amontons_key_results, only: lengths_t, new_lengths
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t
   use amontons_result_warnings, only: add_conditioning, lacks_points
   use amontons_row_text, only: read_status_runs, status_runs
   use amontons_solve_case, only: prepare_case, cache_t
   use amontons_solve_sweep, only: sweep_result_t
   use amontons_summary_file, only: summary_file_t
   use amontons_sweep_report, only: n_documents, sweep_documents
   use amontons_sweep_statistics, only: case_converged, case_keys, case_result_t, outcome_names
   use amontons_sweep_summary, only: new_sweep_summary
   use amontons_sweep_table, only: append_row, read_warnings, sweep_header
   use amontons_text, only: read_integer, to_text
   use amontons_timings, only: phase_solve
   use amontons_verify_fields, only: field_case_t, verify_fields
   implicit none (type, external)
   private

   public :: verify_sweep

contains

   !> Checks the files of a sweep.
   subroutine verify_sweep(summary, cache, config, stem, is_certified)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the sweep needs another
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(out) :: is_certified !! whether all cases converged and the certificate passes
      type(sweep_result_t) :: result
      type(field_case_t), allocatable :: cases(:)
      type(error_t), allocatable :: error
      logical, allocatable :: has_converged(:)
      character(:), allocatable :: fault

      is_certified = .false.
      call prepare_case(cache, config, result%certified, error)
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      result%certified%condition = summary%number('', 'condition')
      call add_conditioning(result%certified, cache%body)
      call restore_rows(result, cases, has_converged, config, cache%body, stem//'.sweep.csv', fault)
      call result%statistics%add_warnings(cache%body%zone, result%certified%warnings)
      if (len(fault) > 0) then
         call summary%faults%add(stem//'.sweep.csv', fault)
         return
      end if
      result%n_resumed = nint(summary%number('sweep', 'done_earlier'))
      result%certified%timings%seconds(phase_solve) = summary%number('seconds', 'solve')
      call find_certified(summary, has_converged, result%statistics%worst_case)
      ! As the certificate, it takes the whole model and is only recorded.
      if (config%accuracy%wants_estimate() .and. result%statistics%worst_case > 0) then
         allocate (result%certified%error_estimate)
      end if
      call verify_fields(summary, result, cache%body, config, stem, cases)
      call check_texts(summary, config, cache%body, result, stem)
      is_certified = result%statistics%is_answered() .and. (result%statistics%residual_case == 0 .or. &
         summary%value('certificate', 'passed') == 'true')
   end subroutine verify_sweep

   !> Reads the rows, writes each again and compares.
   subroutine restore_rows(result, cases, has_converged, config, body, path, fault)
      type(sweep_result_t), intent(inout) :: result !! gains the statistics
      type(field_case_t), allocatable, intent(out) :: cases(:) !! the cases that converged and whose fields are kept
      logical, allocatable, intent(out) :: has_converged(:) !! whether each case has converged
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      character(*), intent(in) :: path !! name of the table
      character(:), allocatable, intent(out) :: fault !! what is wrong; empty if nothing is
      type(csv_table_t) :: rows
      character(:), allocatable :: header
      integer :: i, n, n_quantities

      header = sweep_header(config%sweep, case_keys(body, config%sweep))
      n_quantities = size(case_keys(body, config%sweep))
      call read_csv_table(rows, path, header(:len(header) - 1), 6 + size(config%sweep%axes) + n_quantities, fault)
      if (len(fault) == 0 .and. rows%n_rows /= config%sweep%n_cases()) fault = to_text(rows%n_rows)// &
         ' rows, but the deck has '//to_text(config%sweep%n_cases())//' cases'
      if (len(fault) > 0) return
      allocate (cases(config%sweep%n_fields() + 1), has_converged(rows%n_rows))
      n = 0
      do i = 1, rows%n_rows
         associate (case => cases(n + 1))
            case%number = i
            if (.not. allocated(case%status)) allocate (case%status(body%zone%n_points))
            call read_row(rows, i, size(config%sweep%axes) + 2, n_quantities, case%result, case%status, fault)
            if (len(fault) == 0) call compare_row(rows%row(i), config, body, case, fault)
            if (len(fault) > 0) return
            call result%statistics%add(case%result)
            has_converged(i) = case%result%outcome == case_converged
            case%row = rows%row(i)
            if (config%sweep%has_fields(i, i) .and. has_converged(i)) n = n + 1
         end associate
      end do
      cases = cases(:n)
   end subroutine restore_rows

   !> Reads what a row states of its case.
   subroutine read_row(rows, row, first, n_quantities, result, status, fault)
      type(csv_table_t), intent(in) :: rows !! the table
      integer, intent(in) :: row !! which row
      integer, intent(in) :: first !! column of the first quantity
      integer, intent(in) :: n_quantities !! number of quantities
      type(case_result_t), intent(out) :: result !! what is kept of the case
      integer, intent(out) :: status(:) !! statuses of its points, if it has a solution
      character(:), allocatable, intent(inout) :: fault !! what is wrong; empty if nothing is
      character(:), allocatable :: runs
      integer :: i
      logical :: ok

      result%quantity = spread(0.0_dp, 1, n_quantities)
      runs = rows%field(row, first + n_quantities + 4)
      call read_warnings(result%is_warned, rows%field(row, first + n_quantities + 3))
      associate (at_iterations => first + n_quantities + 1)
         ! A body without contact points has no statuses.
         result%has_solution = len(rows%field(row, first)) > 0
         result%outcome = findloc(outcome_names == rows%field(row, at_iterations + 1), .true., dim=1)
         call read_integer(rows%field(row, at_iterations), result%n_iterations, ok)
         if (.not. ok .or. result%outcome == 0) fault = 'line '//to_text(row + 1)//': no iterations or no outcome'
         if (len(fault) > 0 .or. .not. result%has_solution) return
         do i = 1, n_quantities
            call rows%get_number(row, first + i - 1, result%quantity(i), fault)
         end do
         call rows%get_number(row, first + n_quantities, result%residual, fault)
         call read_status_runs(status, runs, ok)
         if (.not. ok) fault = 'line '//to_text(row + 1)//": '"//runs//"' are not the statuses of "// &
            to_text(size(status))//' contact points'
      end associate
   end subroutine read_row

   !> Compares a row with the values of its case and the lengths that follow from its statuses.
   subroutine compare_row(stated, config, body, case, fault)
      character(*), intent(in) :: stated !! the row
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(field_case_t), intent(in) :: case !! the case as the row states it
      character(:), allocatable, intent(inout) :: fault !! gains what is wrong
      type(case_result_t) :: computed
      type(lengths_t) :: lengths
      type(quantity_t) :: parts(3)
      character(:), allocatable :: text, runs, header
      logical :: is_lost

      computed = case%result
      runs = ''
      if (computed%has_solution) then
         call new_lengths(lengths, body%zone, case%status)
         parts = lengths%quantities()
         computed%quantity(:size(parts)) = parts%value
         call status_runs(runs, case%status, body%zone%set)
      end if
      text = ''
      call append_row(text, config%sweep, case%number, computed, runs)
      header = sweep_header(config%sweep, case_keys(body, config%sweep))
      call compare_line(fault, stated, text(:len(text) - 1), header(:len(header) - 1), [0.0_dp], 0.0_dp, is_lost)
      if (len(fault) == 0 .and. case%result%outcome == case_converged .and. &
         .not. case%result%residual <= config%method%tolerance) fault = &
         'the residual of a converged case is above the tolerance'
      if (len(fault) == 0 .and. case%result%outcome == case_converged .and. &
         any(case%result%is_warned(2:3) .neqv. lacks_points(case%status))) fault = &
         'its warnings do not follow from its statuses'
      if (len(fault) > 0) fault = 'line '//to_text(case%number + 1)//': '//fault
   end subroutine compare_row

   !> Finds the case that the summary says is certified. No file has the error estimates, but it has converged.
   subroutine find_certified(summary, has_converged, certified)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the fault
      logical, intent(in) :: has_converged(:) !! whether each case has converged
      integer, intent(out) :: certified !! number of the case; 0 if none has converged
      logical :: ok

      certified = 0
      if (.not. any(has_converged)) return
      call read_integer(summary%value('certificate', 'case'), certified, ok)
      if (ok) ok = certified >= 1 .and. certified <= size(has_converged)
      if (ok) ok = has_converged(certified)
      if (.not. ok) call summary%faults%add(summary%path, "certificate.case is '"// &
         summary%value('certificate', 'case')//"', which is not a converged case")
   end subroutine find_certified

   !> Writes the texts again and compares.
   subroutine check_texts(summary, config, body, result, stem)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result as it was restored
      character(*), intent(in) :: stem !! directory and name of the case
      type(document_t) :: documents(n_documents), rewritten
      integer :: i

      call sweep_documents(documents, config, body, result)
      do i = 1, n_documents
         call compare_document(summary%faults, stem, documents(i))
      end do
      call new_sweep_summary(rewritten, config, body, result)
      call compare_document(summary%faults, stem, rewritten)
   end subroutine check_texts

end module amontons_verify_sweep
