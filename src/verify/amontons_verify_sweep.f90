!> Verification of the files of a sweep with its deck and with each other: every case is solved again, from the neighbor
!> that the run had it start from. Rows and grids are compared with these solutions, and the worst case is certified
!> again; summary and listing are made from the numbers in the rows.
module amontons_verify_sweep
   use amontons_body, only: body_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_document, only: document_t, read_status_runs, status_runs
   use amontons_error, only: error_t
   use amontons_file_check, only: compare_collection, compare_line, csv_table_t, read_csv_table, verified_case_t
   use amontons_kinds, only: dp
   use amontons_load_family, only: acting_t
   use amontons_manifest, only: case_entries
   use amontons_result, only: outcome_names, outcome_not_converged, outcome_numbers, outcome_solved, result_t
   use amontons_result_warnings, only: add_conditioning, add_tallied_warnings, lacks_points
   use amontons_solve_case, only: cache_t, condense_case, take_no_equilibrium
   use amontons_study, only: study_monitor_t
   use amontons_sweep_chunk, only: append_row, case_keys, case_result_t, chunk_length, chunk_t, condense_task, &
      find_stored_numbers, new_chunk, prepare_sweep, read_warnings, solve_chunks, sweep_header, sweep_task_t
   use amontons_sweep_study, only: evaluate_case, n_documents, new_sweep_summary, sweep_documents, sweep_result_t
   use amontons_system, only: file_name_t, list_directory
   use amontons_terminal, only: phase_solve
   use amontons_text, only: read_integer, to_text
   use amontons_verify_case, only: check_grids, follow_statuses, scales_of, verify_answer
   implicit none (type, external)
   private

   public :: verify_sweep

   !> Place of the sum of the normal forces among the numbers of a case, behind three lengths.
   integer, parameter :: normal_force = 4

   !> A case as stated in its row.
   type :: row_t
      integer :: number = 0 !! its number
      integer, allocatable :: status(:) !! statuses of the contact points (m)
      type(case_result_t) :: result !! numbers that are kept, and residual
   end type row_t

   !> A sweep whose cases are solved again, with its table.
   type :: retrace_t
      type(sweep_task_t) :: task !! the cases
      type(sweep_result_t) :: result !! what listing and summary show, from the rows
      type(csv_table_t) :: table !! the rows
      character(:), allocatable :: entries !! entries of the collection of grids so far
   end type retrace_t

contains

   !> Verifies the files of a sweep.
   subroutine verify_sweep(case, cache)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults of all files, and the verdict
      type(cache_t), intent(inout) :: cache !! the last body, replaced if the sweep needs another
      type(retrace_t) :: again
      type(document_t) :: documents(n_documents), summary
      type(error_t), allocatable :: error
      character(:), allocatable :: fault
      logical :: is_done, ok

      associate (result => again%result, certified => again%result%certified, statistics => again%result%statistics)
         call prepare_sweep(again%task, cache, case%solved, certified, error)
         if (.not. allocated(error)) call condense_case(cache, case%solved, certified, error)
         if (.not. allocated(error)) call condense_task(again%task, cache%body, cache%problem, error)
         call take_no_equilibrium(certified, error)
         call verify_answer(case, cache, certified, error, is_done)
         if (is_done) return
         call read_rows(case, again, cache%body, fault)
         call case%fault('.sweep.csv', fault)
         if (len(fault) > 0) return
         result%n_resumed = nint(case%number('sweep', 'done_earlier'))
         certified%timings%seconds(phase_solve) = case%number('seconds', 'solve')
         ! The error estimates by which the certified case was chosen are rounding errors, others on another machine.
         statistics%force_error%at = 0
         if (statistics%residual%at > 0) call read_integer(case%value('certificate', 'case'), &
            statistics%force_error%at, ok)
         call solve_rows(case, again, cache)
         certified%condition = case%number('', 'condition')
         if (allocated(certified%displacement)) then
            call add_conditioning(certified, cache%body)
         else if (statistics%residual%at > 0) then
            call case%fault('.summary.json', "certificate.case is '"//case%value('certificate', 'case')// &
               "', which is not a converged case")
         end if
         call add_tallied_warnings(certified%warnings, statistics%warned, statistics%n_cases, 'case', cache%body%zone)
         call check_surplus(case, again%entries)
         if (len(again%entries) > 0) call compare_collection(case%faults, case%stem//'.sweep.pvd', again%entries)
         call sweep_documents(documents, case%config, cache%body, result)
         call new_sweep_summary(summary, case%config, cache%body, result)
         call case%compare(documents, summary)
         ! Every case has its answer: a solution, or that there is no equilibrium.
         case%is_certified = sum(statistics%n_outcomes([outcome_not_converged, outcome_numbers])) == 0 .and. &
            (statistics%residual%at == 0 .or. case%value('certificate', 'passed') == 'true')
      end associate
   end subroutine verify_sweep

   !> Reads all rows, and collects their statistics.
   subroutine read_rows(case, again, body, fault)
      type(verified_case_t), intent(in) :: case !! the sweep
      type(retrace_t), intent(inout) :: again !! gains the table and the statistics
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable, intent(out) :: fault !! the fault, as a sentence; empty if there is none
      type(row_t) :: row
      integer :: number

      associate (sweep => case%config%sweep, table => again%table)
         call read_csv_table(table, case%stem//'.sweep.csv', sweep_header(sweep, case_keys(body, sweep)), 6 + &
            size(sweep%axes) + again%task%n_quantities, fault)
         if (len(fault) == 0 .and. table%n_rows /= sweep%n_cases()) fault = to_text(table%n_rows)// &
            ' rows, but the deck has '//to_text(sweep%n_cases())//' cases'
         do number = 1, table%n_rows
            if (len(fault) > 0) return
            call read_row(row, again, number, body%zone%n_points, fault)
            if (len(fault) > 0) return
            if (row%result%outcome == outcome_solved .and. row%result%residual > case%config%method%tolerance) then
               fault = 'line '//to_text(number + 1)//': the residual of a converged case is above the tolerance'
            end if
            call again%result%statistics%add(row%result)
         end do
      end associate
   end subroutine read_rows

   !> Reads the numbers of a case from its row.
   subroutine read_row(row, again, number, n_points, fault)
      type(row_t), intent(out) :: row !! the row
      type(retrace_t), intent(in) :: again !! the sweep with its table
      integer, intent(in) :: number !! number of the case
      integer, intent(in) :: n_points !! number of contact points
      character(:), allocatable, intent(inout) :: fault !! the fault, as a sentence; empty if there is none
      character(:), allocatable :: runs
      integer :: first, i
      logical :: ok

      first = size(again%task%sweep%axes) + 2
      row%number = number
      allocate (row%status(n_points))
      associate (table => again%table, result => row%result, n_quantities => again%task%n_quantities)
         result%quantity = spread(0.0_dp, 1, n_quantities)
         result%scale = result%quantity
         ! Behind the quantities: residual, iterations, outcome, warnings, statuses.
         runs = table%field(number, first + n_quantities + 4)
         call read_warnings(result%is_warned, table%field(number, first + n_quantities + 3))
         ! A body without contact points has no statuses.
         result%has_solution = len(table%field(number, first)) > 0
         result%outcome = findloc(outcome_names == table%field(number, first + n_quantities + 2), .true., dim=1)
         call read_integer(table%field(number, first + n_quantities + 1), result%n_iterations, ok)
         if (.not. ok .or. result%outcome == 0) fault = 'line '//to_text(number + 1)//': no iterations or no outcome'
         if (len(fault) > 0 .or. .not. result%has_solution) return
         do i = 1, n_quantities
            call table%get_number(number, first + i - 1, result%quantity(i), fault)
         end do
         call table%get_number(number, first + n_quantities, result%residual, fault)
         call read_status_runs(row%status, runs, ok)
         if (.not. ok) fault = 'line '//to_text(number + 1)//": '"//runs//"' are not the statuses of "// &
            to_text(n_points)//' contact points'
      end associate
   end subroutine read_row

   !> Solves all cases again, on all threads, and compares rows and grids.
   subroutine solve_rows(case, again, cache)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults
      type(retrace_t), intent(inout) :: again !! the sweep with its table; gains the certificate of the worst case
      type(cache_t), intent(in) :: cache !! the body
      ! Number of chunks that are solved side by side: all their solutions are in memory.
      integer, parameter :: n_together = 8
      type(study_monitor_t) :: monitor
      type(chunk_t) :: chunks(n_together)
      integer :: first, k, n

      again%entries = ''
      do first = 0, again%table%n_rows - 1, n_together*chunk_length
         n = min(n_together, (again%table%n_rows - first - 1)/chunk_length + 1)
         do k = 1, n
            call new_chunk(chunks(k), first + (k - 1)*chunk_length, again%table%n_rows)
            chunks(k)%keeps_solutions = .true.
         end do
         call solve_chunks(again%task, cache%body, cache%problem, monitor, chunks(:n))
         do k = 1, n
            if (chunks(k)%is_broken()) then
               call case%fault('.sweep.csv', chunks(k)%fault)
               return
            end if
            call compare_chunk(case, again, cache, chunks(k))
         end do
      end do
   end subroutine solve_rows

   !> Compares the rows of a chunk, and the grids of its cases.
   subroutine compare_chunk(case, again, cache, chunk)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults
      type(retrace_t), intent(inout) :: again !! the sweep with its table; gains the certificate of the worst case
      type(cache_t), intent(in) :: cache !! the body
      type(chunk_t), intent(inout) :: chunk !! the chunk, solved; its solutions gain the statuses of the rows
      type(row_t) :: rows(chunk%last - chunk%first + 1)
      type(acting_t) :: acting
      character(:), allocatable :: fault
      integer :: i
      logical :: follows, is_shown

      fault = ''
      follows = .false.
      associate (loads => again%task%solver%loads, body => cache%body, statistics => again%result%statistics)
         call loads%at_rest(acting)
         do i = 1, size(rows)
            associate (row => rows(i), solved => chunk%results(i), solution => chunk%solutions(i))
               call read_row(row, again, chunk%first + i - 1, body%zone%n_points, fault)
               if (solved%outcome /= outcome_solved .or. row%result%outcome /= outcome_solved) cycle
               acting%factor(2:) = again%task%sweep%values(row%number)
               follows = follows .or. any(row%status /= solution%status)
               call follow_statuses(case%faults, solution, case%stem//'.sweep.csv:'//to_text(row%number + 1), &
                  row%status, body, loads, acting, scales_of(case%config%method%tolerance, &
                  statistics%extremes(normal_force, 2)%value, cache%problem%matrix%augmentation))
               solved%is_warned(2:3) = lacks_points(row%status)
               is_shown = case%config%sweep%has_fields(row%number, row%number)
               if (is_shown .or. row%number == statistics%force_error%at) call check_case(case, again, body, &
                  row%number, is_shown, solution)
            end associate
         end do
         if (follows) call find_stored_numbers(again%task, body, chunk, chunk%solutions)
         do i = 1, size(rows)
            call compare_row(case, again, body, rows(i), chunk%results(i))
         end do
      end associate
   end subroutine compare_chunk

   !> Compares a row with the solution of its case.
   subroutine compare_row(case, again, body, row, solved)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults
      type(retrace_t), intent(in) :: again !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(row_t), intent(in) :: row !! the row
      type(case_result_t), intent(in) :: solved !! the result of its case, solved again
      real(dp), parameter :: many = 100.0_dp
      type(case_result_t) :: computed
      character(:), allocatable :: fault, text, runs
      logical :: is_lost

      computed = solved
      if (allocated(again%result%statistics%extremes)) computed%scale = max(computed%scale, &
         maxval(abs(again%result%statistics%extremes%value), dim=2))
      computed%residual = row%result%residual
      computed%n_iterations = row%result%n_iterations
      ! Two solutions to the tolerance may differ by more than rounding.
      computed%scale = many*computed%scale
      runs = ''
      if (computed%has_solution) call status_runs(runs, row%status, body%zone%set)
      text = ''
      call append_row(text, case%config%sweep, row%number, computed, runs)
      call compare_line(fault, again%table%row(row%number), text(:len(text) - 1), again%table%header, &
         [spread(0.0_dp, 1, 1 + size(case%config%sweep%axes)), computed%scale, 0.0_dp], 0.0_dp, is_lost)
      call case%fault('.sweep.csv:'//to_text(row%number + 1), fault)
   end subroutine compare_row

   !> Evaluates the solution of a case on the full model: compares its grids, and takes the certificate of the worst
   !> case.
   subroutine check_case(case, again, body, number, is_shown, solution)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults
      type(retrace_t), intent(inout) :: again !! the sweep; gains the entry of the grids, and the worst case
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the case
      logical, intent(in) :: is_shown !! whether it has grids
      type(contact_solution_t), intent(in) :: solution !! its solution, with the statuses of its row
      type(result_t) :: result
      type(error_t), allocatable :: error

      call evaluate_case(result, again%task, body, number, solution, error)
      if (allocated(error)) then
         call case%fault('.sweep.csv:'//to_text(number + 1), error%message)
         return
      end if
      associate (grid => '.sweep/'//to_text(number))
         if (is_shown) then
            again%entries = again%entries//case_entries(to_text(number), case%config%name//grid)
            call check_grids(case%faults, case%config%units, body, result, case%stem//grid)
         end if
      end associate
      if (number /= again%result%statistics%force_error%at) return
      again%result%certified%displacement = result%displacement
      again%result%certified%certificate = result%certificate
      if (allocated(result%error_estimate)) again%result%certified%error_estimate = result%error_estimate
   end subroutine check_case

   !> Reports grids that do not belong to this sweep, for example from an interrupted one of the same name.
   subroutine check_surplus(case, entries)
      type(verified_case_t), intent(inout) :: case !! the sweep; gains the faults
      character(*), intent(in) :: entries !! entries of the collection of its grids
      type(file_name_t), allocatable :: files(:)
      type(error_t), allocatable :: error
      integer :: i

      ! A missing grid is reported where it is read.
      call list_directory(files, case%stem//'.sweep', error)
      if (allocated(error)) return
      do i = 1, size(files)
         associate (name => files(i)%text)
            if (index(name//'/', '.vtu/') > 0 .and. index(entries, '.sweep/'//name//'"') == 0) then
               call case%fault('.sweep/'//name, 'not a grid of this sweep')
            end if
         end associate
      end do
   end subroutine check_surplus

end module amontons_verify_sweep
