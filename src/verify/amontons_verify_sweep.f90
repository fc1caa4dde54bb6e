!> Verification of the files of a sweep against each other: rows, summary and listing are made again from the values of
!> the deck and the numbers in the rows. A row has no displacements: if the fields of its case are not kept, its forces
!> and its residual cannot be computed without solving the case, and are protected by checksums only. Grids are verified
!> like those of a single case: the result is restored from the displacements of one and the stresses of the other, and
!> everything that they show, and the row of the case, is computed again.
module amontons_verify_sweep
   use amontons_body, only: body_t
   use amontons_contact_solution, only: new_contact_solution
   use amontons_csv_table, only: csv_table_t, read_csv_table
   use amontons_document, only: document_t, read_status_runs, status_runs
   use amontons_error, only: error_t
   use amontons_file_check, only: compare_collection, compare_line, read_array, verified_case_t
   use amontons_key_results, only: body_peaks, lengths_t, new_lengths
   use amontons_kinds, only: dp
   use amontons_manifest, only: case_entries
   use amontons_quantity, only: expanded, quantity_t, scales
   use amontons_result, only: certificate_limit, outcome_names, outcome_not_converged, outcome_numbers, &
      outcome_solved, result_t
   use amontons_result_warnings, only: add_conditioning, lacks_points
   use amontons_solve_case, only: cache_t, evaluate
   use amontons_sweep_chunk, only: append_row, case_keys, case_quantities, case_result_t, new_case, prepare_sweep, &
      read_warnings, sweep_header, sweep_task_t
   use amontons_sweep_study, only: n_documents, new_sweep_summary, sweep_documents, sweep_result_t
   use amontons_system, only: file_name_t, list_directory
   use amontons_terminal, only: phase_solve
   use amontons_text, only: read_integer, to_text
   use amontons_verify_case, only: check_grids, check_law, restore_displacement
   use amontons_vtu, only: n_line_points
   implicit none (type, external)
   private

   public :: verify_sweep

   !> A case as stated in its row.
   type :: row_t
      integer :: number = 0 !! its number
      integer, allocatable :: status(:) !! statuses of the contact points (m)
      type(case_result_t) :: result !! numbers that are kept, and residual
      character(:), allocatable :: text !! the row
      character(:), allocatable :: header !! the header of the table, without its line end
   end type row_t

contains

   !> Verifies the files of a sweep.
   subroutine verify_sweep(case, cache)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults of all files, and the verdict
      type(cache_t), intent(inout) :: cache !! the last body, replaced if the sweep needs another
      type(sweep_task_t) :: task
      type(sweep_result_t) :: result
      type(document_t) :: documents(n_documents), summary
      type(row_t), allocatable :: rows(:)
      type(error_t), allocatable :: error
      logical, allocatable :: has_converged(:)
      character(:), allocatable :: fault
      logical :: ok

      call prepare_sweep(task, cache, case%config, result%certified, error)
      if (allocated(error)) then
         call case%fault('.deck.nml', error%message)
         return
      end if
      result%certified%condition = case%number('', 'condition')
      call add_conditioning(result%certified, cache%body)
      call restore_rows(case, result, rows, has_converged, cache%body, fault)
      call result%statistics%add_warnings(cache%body%zone, result%certified%warnings)
      call case%fault('.sweep.csv', fault)
      if (len(fault) > 0) return
      result%n_resumed = nint(case%number('sweep', 'done_earlier'))
      result%certified%timings%seconds(phase_solve) = case%number('seconds', 'solve')
      ! No file has the error estimates by which the certified case was chosen.
      result%statistics%worst_case = 0
      if (any(has_converged)) then
         call read_integer(case%value('certificate', 'case'), result%statistics%worst_case, ok)
         if (ok) ok = result%statistics%worst_case >= 1 .and. result%statistics%worst_case <= size(has_converged)
         if (ok) ok = has_converged(result%statistics%worst_case)
         if (.not. ok) call case%fault('.summary.json', "certificate.case is '"//case%value('certificate', 'case')// &
            "', which is not a converged case")
      end if
      ! As the certificate, it takes the whole model and is only recorded.
      if (case%config%accuracy%wants_estimate() .and. result%statistics%worst_case > 0) then
         allocate (result%certified%error_estimate)
      end if
      call verify_fields(case, task, result, cache%body, rows)
      call sweep_documents(documents, case%config, cache%body, result)
      call new_sweep_summary(summary, case%config, cache%body, result)
      call case%compare(documents, summary)
      ! Every case has its answer: a solution, or that there is no equilibrium.
      case%is_certified = sum(result%statistics%n_outcomes([outcome_not_converged, outcome_numbers])) == 0 .and. &
         (result%statistics%residual_case == 0 .or. case%value('certificate', 'passed') == 'true')
   end subroutine verify_sweep

   !> Reads the rows, makes each again and compares them.
   subroutine restore_rows(case, result, rows, has_converged, body, fault)
      type(verified_case_t), intent(in) :: case !! the sweep
      type(sweep_result_t), intent(inout) :: result !! gains the statistics
      type(row_t), allocatable, intent(out) :: rows(:) !! the rows of cases that converged and whose fields are kept
      logical, allocatable, intent(out) :: has_converged(:) !! whether each case has converged
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable, intent(out) :: fault !! the fault, as a sentence; empty if there is none
      type(csv_table_t) :: table
      character(:), allocatable :: header
      integer :: i, n, n_quantities
      type(case_result_t) :: computed
      type(lengths_t) :: lengths
      type(quantity_t) :: parts(3)

      associate (sweep => case%config%sweep)
         n_quantities = size(case_keys(body, sweep))
         header = sweep_header(sweep, case_keys(body, sweep))
         header = header(:len(header) - 1)
         call read_csv_table(table, case%stem//'.sweep.csv', header, 6 + size(sweep%axes) + n_quantities, fault)
         if (len(fault) == 0 .and. table%n_rows /= sweep%n_cases()) fault = to_text(table%n_rows)// &
            ' rows, but the deck has '//to_text(sweep%n_cases())//' cases'
         if (len(fault) > 0) return
         allocate (rows(sweep%n_fields() + 1), has_converged(table%n_rows))
         n = 0
         do i = 1, table%n_rows
            associate (row => rows(n + 1))
               row%number = i
               row%text = table%row(i)
               row%header = header
               if (.not. allocated(row%status)) allocate (row%status(body%zone%n_points))
               call read_row(row, table, size(sweep%axes) + 2, n_quantities, fault)
               if (len(fault) == 0) then
                  ! A row must state the values of its case, and the lengths that follow from its statuses.
                  computed = row%result
                  if (computed%has_solution) then
                     call new_lengths(lengths, body%zone, row%status)
                     parts = lengths%quantities()
                     computed%quantity(:size(parts)) = parts%value
                  end if
                  call compare_row(case, row, body, computed, [0.0_dp], fault)
                  if (row%result%outcome == outcome_solved) then
                     if (len(fault) == 0 .and. .not. row%result%residual <= case%config%method%tolerance) fault = &
                        'the residual of a converged case is above the tolerance'
                     if (len(fault) == 0 .and. any(row%result%is_warned(2:3) .neqv. lacks_points(row%status))) fault = &
                        'its warnings do not follow from its statuses'
                  end if
                  if (len(fault) > 0) fault = 'line '//to_text(row%number + 1)//': '//fault
               end if
               if (len(fault) > 0) return
               call result%statistics%add(row%result)
               has_converged(i) = row%result%outcome == outcome_solved
               if (sweep%has_fields(i, i) .and. has_converged(i)) n = n + 1
            end associate
         end do
         rows = rows(:n)
      end associate
   end subroutine restore_rows

   !> Reads the numbers of a case from its row.
   subroutine read_row(row, table, first, n_quantities, fault)
      type(row_t), intent(inout) :: row !! the row, its number known; gains what it states
      type(csv_table_t), intent(in) :: table !! the table
      integer, intent(in) :: first !! column of the first quantity
      integer, intent(in) :: n_quantities !! number of quantities
      character(:), allocatable, intent(inout) :: fault !! the fault, as a sentence; empty if there is none
      character(:), allocatable :: runs
      integer :: i
      logical :: ok

      row%result = case_result_t()
      row%result%quantity = spread(0.0_dp, 1, n_quantities)
      runs = table%field(row%number, first + n_quantities + 4)
      call read_warnings(row%result%is_warned, table%field(row%number, first + n_quantities + 3))
      associate (at_iterations => first + n_quantities + 1, result => row%result)
         ! A body without contact points has no statuses.
         result%has_solution = len(table%field(row%number, first)) > 0
         result%outcome = findloc(outcome_names == table%field(row%number, at_iterations + 1), .true., dim=1)
         call read_integer(table%field(row%number, at_iterations), result%n_iterations, ok)
         if (.not. ok .or. result%outcome == 0) fault = 'line '//to_text(row%number + 1)// &
            ': no iterations or no outcome'
         if (len(fault) > 0 .or. .not. result%has_solution) return
         do i = 1, n_quantities
            call table%get_number(row%number, first + i - 1, result%quantity(i), fault)
         end do
         call table%get_number(row%number, first + n_quantities, result%residual, fault)
         call read_status_runs(row%status, runs, ok)
         if (.not. ok) fault = 'line '//to_text(row%number + 1)//": '"//runs//"' are not the statuses of "// &
            to_text(size(row%status))//' contact points'
      end associate
   end subroutine read_row

   !> Compares a row with that of a result.
   subroutine compare_row(case, row, body, computed, row_scales, fault)
      type(verified_case_t), intent(in) :: case !! the sweep
      type(row_t), intent(in) :: row !! the row
      type(body_t), intent(in) :: body !! the body
      type(case_result_t), intent(in) :: computed !! the expected text
      real(dp), intent(in) :: row_scales(:) !! scale of the first, second ... number, if larger than the number itself
      character(:), allocatable, intent(out) :: fault !! the fault, as a sentence; empty if there is none
      character(:), allocatable :: text, runs
      logical :: is_lost

      runs = ''
      if (computed%has_solution) call status_runs(runs, row%status, body%zone%set)
      text = ''
      call append_row(text, case%config%sweep, row%number, computed, runs)
      call compare_line(fault, row%text, text(:len(text) - 1), row%header, row_scales, 0.0_dp, is_lost)
   end subroutine compare_row

   !> Verifies the fields of a sweep: every grid, the collection, and that there are no other grids.
   subroutine verify_fields(case, task, sweep, body, rows)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults
      type(sweep_task_t), intent(in) :: task !! its cases
      type(sweep_result_t), intent(inout) :: sweep !! its result; gains the certificate, if its case has fields
      type(body_t), intent(in) :: body !! the body
      type(row_t), intent(in) :: rows(:) !! the rows of the cases that converged and whose fields are kept
      type(result_t) :: result
      character(:), allocatable :: entries, number
      integer :: i

      sweep%has_certificate = .false.
      call check_surplus(case, rows%number)
      if (size(rows) == 0) return
      entries = ''
      do i = 1, size(rows)
         result%method = case%config%method
         result%wants_error_estimate = case%config%accuracy%wants_estimate()
         call new_case(result%load_case, task, body, rows(i)%number)
         call check_fields(case, result, body, rows(i))
         number = to_text(rows(i)%number)
         entries = entries//case_entries(number, case%config%name//'.sweep/'//number)
         if (rows(i)%number /= sweep%statistics%worst_case .or. .not. allocated(result%displacement)) cycle
         sweep%certified%certificate = result%certificate
         if (allocated(result%error_estimate)) sweep%certified%error_estimate = result%error_estimate
         sweep%has_certificate = .true.
      end do
      call compare_collection(case%faults, case%stem//'.sweep.pvd', entries)
   end subroutine verify_fields

   !> Reports grids that do not belong to this sweep, for example from an interrupted one of the same name.
   subroutine check_surplus(case, numbers)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults
      integer, intent(in) :: numbers(:) !! numbers of the cases whose grids should be there
      type(file_name_t), allocatable :: files(:)
      type(error_t), allocatable :: error
      logical, allocatable :: has_grids(:)
      integer :: i, number
      logical :: ok

      ! A missing grid is reported where it is read.
      call list_directory(files, case%stem//'.sweep', error)
      if (allocated(error)) return
      allocate (has_grids(0:maxval([0, numbers])), source=.false.)
      has_grids(numbers) = .true.
      do i = 1, size(files)
         associate (name => files(i)%text)
            if (index(name//'/', '.vtu/') == 0) cycle
            call read_integer(name(:index(name, '.') - 1), number, ok)
            if (ok) ok = number >= 0 .and. number < size(has_grids)
            if (ok) ok = has_grids(number) .and. (name == to_text(number)//'.vtu' .or. &
               name == to_text(number)//'.contact.vtu')
            if (.not. ok) call case%fault('.sweep/'//name, 'not a grid of this sweep')
         end associate
      end do
   end subroutine check_surplus

   !> Verifies the two grids of a case, and its row with them.
   subroutine check_fields(case, result, body, row)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults
      type(result_t), intent(inout) :: result !! the load case; gains what the grids state
      type(body_t), intent(in) :: body !! the body
      type(row_t), intent(in) :: row !! the row
      character(:), allocatable :: fault, grid
      character(*), parameter :: stress_names(0:2) = [character(19) :: 'contact_pressure', 'contact_shear', &
         'contact_shear_theta']
      real(dp), allocatable :: stress(:)
      real(dp) :: limit
      integer :: k
      type(case_result_t) :: computed
      type(quantity_t), allocatable :: list(:), numbers(:), peaks(:)

      grid = '.sweep/'//to_text(row%number)
      limit = certificate_limit(case%config%method%tolerance)
      call new_contact_solution(result%solution, body%zone%n_points, body%zone%n_tangents)
      call restore_displacement(result, body, case%stem//grid//'.vtu', fault)
      call case%fault(grid//'.vtu', fault)
      if (len(fault) > 0) return
      ! Restores the contact forces from the stresses on the contact line.
      allocate (stress(n_line_points(body%zone)))
      do k = 0, body%zone%n_tangents
         call read_array(case%stem//grid//'.contact.vtu', trim(stress_names(k)), 1, stress, fault)
         call case%fault(grid//'.contact.vtu', fault)
         if (len(fault) > 0) return
         associate (m => body%zone%n_points)
            result%solution%force(k*m + 1:(k + 1)*m) = stress(:m)*body%zone%area
         end associate
      end do
      result%solution%status = row%status
      call evaluate(result, body)
      call check_grids(case, body, result, case%stem//grid)
      if (.not. result%certificate%largest() <= limit) call case%fault(grid//'.vtu', &
         'equilibrium or contact law is violated by '//to_text(result%certificate%largest())// &
         ', more than the limit of '//to_text(limit))
      call check_law(case%faults, body, result, case%stem//grid//'.contact.vtu', .false.)
      ! The row must state the numbers that follow from the grids.
      computed = row%result
      allocate (peaks(0))
      if (case%config%sweep%has_body_results) peaks = body_peaks(body%mesh, result%displacement, result%stress%node)
      if (case%config%sweep%has_forces) peaks = [peaks, result%certificate%named]
      list = case_quantities(body, result%solution, result%load_case%friction, result%load_case%slip_bound, &
         result%load_case%free_gap, peaks)
      numbers = expanded(list)
      computed%quantity = numbers%value
      call compare_row(case, row, body, computed, [spread(0.0_dp, 1, 1 + size(case%config%sweep%axes)), scales(list), &
         0.0_dp], fault)
      call case%fault('.sweep.csv:'//to_text(row%number + 1), fault)
   end subroutine check_fields

end module amontons_verify_sweep
