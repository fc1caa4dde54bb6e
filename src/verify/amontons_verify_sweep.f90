!> The files of a sweep checked against each other: values, lengths and counts of every row, and what the summary tells
!> of the rows together. A row holds no displacements: where the fields of its case are not kept, its forces and its
!> residual cannot be computed again without solving the case, and are only checksummed.
module amontons_verify_sweep
   use amontons_agreement, only: agree, contradiction
   use amontons_config, only: config_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_csv_table, only: csv_table_t, read_csv_table
   use amontons_error, only: error_t
   use amontons_json, only: truth
   use amontons_kinds, only: dp
   use amontons_lengths, only: lengths_t, new_lengths
   use amontons_result, only: result_t
   use amontons_result_warnings, only: add_conditioning, lacks_points
   use amontons_solve_case, only: cache_t, prepare_case
   use amontons_summary_check, only: summary_check_t
   use amontons_summary_members, only: warnings_array
   use amontons_sweep_summary, only: extremes_text
   use amontons_sweep_table, only: append_row, read_status_runs, read_warnings, status_runs, sweep_header
   use amontons_sweep_statistics, only: case_converged, case_result_t, outcome_names, quantity_labels, &
      sweep_statistics_t
   use amontons_text, only: newline, read_integer, to_text
   use amontons_verify_fields, only: field_case_t, verify_fields
   implicit none (type, external)
   private

   public :: verify_sweep

   !> Columns behind the values that vary: quantities, residual, iterations, outcome, warnings, statuses.
   integer, parameter :: n_quantities = size(quantity_labels), n_columns = n_quantities + 5

contains

   !> Checks the files of a sweep.
   subroutine verify_sweep(summary, cache, config, stem, is_certified)
      type(summary_check_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the sweep needs another
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(out) :: is_certified !! whether all cases converged and the certificate passes
      type(result_t) :: result
      type(csv_table_t) :: rows
      type(sweep_statistics_t) :: statistics
      type(field_case_t), allocatable :: cases(:)
      type(error_t), allocatable :: error
      character(:), allocatable :: header, fault
      logical, allocatable :: has_converged(:)
      integer :: certified, i, n

      is_certified = .false.
      call prepare_case(cache, config, result, error)
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      call summary%take_condition(result%condition)
      call add_conditioning(result, cache%body)
      header = sweep_header(config%sweep)
      call read_csv_table(rows, stem//'.sweep.csv', header(:len(header) - 1), &
         1 + size(config%sweep%axes) + n_columns, fault)
      if (len(fault) == 0 .and. rows%n_rows /= config%sweep%n_cases()) fault = to_text(rows%n_rows)// &
         ' rows, but the deck has '//to_text(config%sweep%n_cases())//' cases'
      allocate (cases(config%sweep%n_fields() + 1))
      allocate (has_converged(rows%n_rows))
      n = 0
      do i = 1, merge(rows%n_rows, 0, len(fault) == 0)
         call check_row(rows, i, config, cache%body%zone, cases(n + 1), fault)
         if (len(fault) > 0) exit
         call statistics%add(cases(n + 1)%result)
         has_converged(i) = cases(n + 1)%result%outcome == case_converged
         if (config%sweep%has_fields(i, i) .and. has_converged(i)) n = n + 1
      end do
      if (len(fault) > 0) then
         call summary%faults%add(stem//'.sweep.csv', fault)
         return
      end if
      call statistics%add_warnings(result%warnings)
      call summary%expect_text('', 'warnings', warnings_array(result%warnings))
      call check_summary(summary, cache, statistics)
      call find_certified(summary, has_converged, certified)
      call verify_fields(summary, cache, result%load_case, config, stem, cases(:n), certified)
      is_certified = statistics%n_outcomes(case_converged) == statistics%n_cases .and. &
         summary%value('certificate', 'passed') == 'true'
   end subroutine verify_sweep

   !> Checks a row: its lengths against its statuses, and that it is written as the program writes what it tells.
   subroutine check_row(rows, row, config, zone, case, fault)
      type(csv_table_t), intent(in) :: rows !! the table
      integer, intent(in) :: row !! which row
      type(config_t), intent(in) :: config !! the deck
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(field_case_t), intent(out) :: case !! the case as the row tells of it
      character(:), allocatable, intent(inout) :: fault !! what is wrong; empty if nothing is
      character(:), allocatable :: runs, text

      case%number = row
      allocate (case%status(zone%n_points))
      associate (result => case%result)
         call read_row(rows, row, size(config%sweep%axes) + 2, result, case%status, fault)
         if (len(fault) > 0) return
         runs = ''
         if (result%has_solution) then
            call check_lengths(row, result%quantity(:3), zone, case%status, fault)
            call status_runs(runs, case%status, zone%set)
            if (result%outcome == case_converged) result%is_warned(2:3) = lacks_points(case%status)
         end if
         if (result%outcome == case_converged .and. .not. result%residual <= config%method%tolerance) fault = &
            'line '//to_text(row + 1)//': the residual of a converged case is above the tolerance'
         text = ''
         call append_row(text, config%sweep, row, result, runs)
         if (len(fault) == 0 .and. rows%row(row)//newline /= text) fault = 'line '//to_text(row + 1)// &
            ': its values, or its form, are not those of case '//to_text(row)
      end associate
   end subroutine check_row

   !> Reads what a row tells of its case.
   subroutine read_row(rows, row, first, result, status, fault)
      type(csv_table_t), intent(in) :: rows !! the table
      integer, intent(in) :: row !! which row
      integer, intent(in) :: first !! column of the first quantity
      type(case_result_t), intent(out) :: result !! what is kept of the case
      integer, intent(out) :: status(:) !! statuses of its points, if it has a solution
      character(:), allocatable, intent(inout) :: fault !! what is wrong; empty if nothing is
      character(:), allocatable :: runs
      integer :: i
      logical :: ok

      runs = rows%field(row, first + n_quantities + 4)
      call read_warnings(result%is_warned, rows%field(row, first + n_quantities + 3))
      associate (at_iterations => first + n_quantities + 1)
         result%has_solution = len(runs) > 0
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

   !> Compares the lengths of a row with its statuses.
   pure subroutine check_lengths(row, stated, zone, status, fault)
      integer, intent(in) :: row !! which row
      real(dp), intent(in) :: stated(3) !! lengths open, slip, stick [L]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: status(:) !! their statuses
      character(:), allocatable, intent(inout) :: fault !! gains what is wrong
      type(lengths_t) :: lengths
      real(dp) :: computed(3)
      integer :: i

      call new_lengths(lengths, zone, status)
      computed = [lengths%open, lengths%slip, lengths%stick]
      do i = 1, 3
         if (agree(stated(i), computed(i), sum(computed)) .or. len(fault) > 0) cycle
         fault = 'line '//to_text(row + 1)//': '//contradiction(trim(quantity_labels(i)), stated(i), &
            computed(i))
      end do
   end subroutine check_lengths

   !> Checks what the summary tells of all rows together.
   subroutine check_summary(summary, cache, statistics)
      type(summary_check_t), intent(inout) :: summary !! the summary; gains the faults
      type(cache_t), intent(in) :: cache !! the body
      type(sweep_statistics_t), intent(in) :: statistics !! what the rows tell together
      integer :: i

      call summary%expect_text('', 'converged', truth(statistics%n_outcomes(case_converged) == statistics%n_cases))
      call summary%expect_text('', 'iterations', to_text(statistics%n_iterations))
      call summary%expect_text('sweep', 'cases', to_text(statistics%n_cases))
      do i = 1, size(outcome_names)
         call summary%expect_text('sweep', trim(outcome_names(i)), to_text(statistics%n_outcomes(i)))
      end do
      call summary%expect_text('counts', 'nodes', to_text(cache%body%mesh%n_nodes))
      call summary%expect_text('counts', 'elements', to_text(cache%body%mesh%n_elements))
      call summary%expect_text('counts', 'dofs', to_text(cache%body%dof_map%n_dofs))
      call summary%expect_text('counts', 'contact_points', to_text(cache%body%zone%n_points))
      if (statistics%residual_case == 0) return
      call summary%expect_number('', 'residual', statistics%residual, 0.0_dp)
      call summary%expect_text('', 'extremes', '{'//extremes_text(statistics)//'}')
   end subroutine check_summary

   !> Finds the case that the summary says is certified. No file has the error estimates, but it has converged.
   subroutine find_certified(summary, has_converged, certified)
      type(summary_check_t), intent(inout) :: summary !! the summary; gains the fault
      logical, intent(in) :: has_converged(:) !! whether each case has converged
      integer, intent(out) :: certified !! number of the case; 0 if none has converged
      logical :: ok

      certified = 0
      if (.not. any(has_converged)) return
      call read_integer(summary%value('certificate', 'case'), certified, ok)
      if (ok) ok = certified >= 1 .and. certified <= size(has_converged)
      if (ok) ok = has_converged(certified)
      if (.not. ok) call summary%faults%add(summary%path, "certificate.case is '"// &
         summary%value('certificate', 'case')//"', which is no case that has converged")
   end subroutine find_certified

end module amontons_verify_sweep
