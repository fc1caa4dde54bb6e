!> The grids of the cases of a sweep checked as those of a single case are: from the displacements of the one and the
!> stresses of the other the result is restored, and all that they show, and the row of the case, are computed again.
module amontons_verify_fields
   use amontons_body, only: body_t
   use amontons_collection, only: case_entries
   use amontons_collection_check, only: compare_collection
   use amontons_config, only: config_t
   use amontons_contact_solution, only: new_contact_solution
   use amontons_contact_vtu, only: n_line_points
   use amontons_document_check, only: compare_line
   use amontons_error, only: error_t
   use amontons_key_results, only: body_peaks
   use amontons_kinds, only: dp
   use amontons_quantity, only: expanded, quantity_t, scales
   use amontons_result, only: certificate_limit, result_t
   use amontons_row_text, only: status_runs
   use amontons_solve_load_case, only: judge
   use amontons_solve_sweep, only: sweep_result_t
   use amontons_summary_file, only: summary_file_t
   use amontons_sweep_model, only: new_sweep_loads, sweep_model_t
   use amontons_sweep_statistics, only: case_keys, case_quantities, case_result_t
   use amontons_sweep_table, only: append_row, sweep_header
   use amontons_system, only: file_name_t, list_directory
   use amontons_text, only: as_lines, read_integer, to_text
   use amontons_verify_case, only: check_grids, check_law, restore_displacement
   use amontons_vtk_check, only: read_array
   implicit none (type, external)
   private

   public :: field_case_t, verify_fields

   !> A case whose fields are kept, as its row tells of it.
   type :: field_case_t
      integer :: number = 0 !! its number
      integer, allocatable :: status(:) !! statuses of the contact points (m)
      type(case_result_t) :: result !! numbers that are kept, and residual
      character(:), allocatable :: row !! the row
   end type field_case_t

contains

   !> Checks the fields of a sweep: every grid, the collection, and that no other grids are among them.
   subroutine verify_fields(summary, sweep, body, config, stem, cases)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults
      type(sweep_result_t), intent(inout) :: sweep !! the sweep; gains the certificate, if its case has fields
      type(body_t), intent(in) :: body !! the body
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! directory and name of the case
      type(field_case_t), intent(in) :: cases(:) !! the cases that converged and whose fields are kept
      type(sweep_model_t) :: model
      type(result_t) :: result
      type(error_t), allocatable :: error
      character(:), allocatable :: entries(:), longest
      integer :: i

      sweep%has_certificate = .false.
      call check_surplus(summary, stem//'.sweep', cases%number)
      if (size(cases) == 0) return
      call new_sweep_loads(model, body, sweep%certified%load_case, config, error)
      if (allocated(error)) then
         ! not raised: the same loads were made when the case was prepared
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      do i = 1, size(cases)
         result%method = config%method
         result%wants_error_estimate = config%accuracy%wants_estimate()
         call model%load_case(config%sweep%values(cases(i)%number), result%load_case)
         call check_case(summary, result, body, config, stem, cases(i))
         if (cases(i)%number /= sweep%statistics%worst_case .or. .not. allocated(result%displacement)) cycle
         sweep%certified%certificate = result%certificate
         if (allocated(result%error_estimate)) sweep%certified%error_estimate = result%error_estimate
         sweep%has_certificate = .true.
      end do
      longest = entry_of(maxval(cases%number))
      allocate (character(len(longest)) :: entries(size(cases)))
      do i = 1, size(cases)
         entries(i) = entry_of(cases(i)%number)
      end do
      call compare_collection(summary%faults, stem//'.sweep.pvd', as_lines(entries))

   contains

      !> The lines of a case in the collection, without the end of the last one.
      pure function entry_of(number) result(lines)
         integer, intent(in) :: number !! number of the case
         character(:), allocatable :: lines

         lines = case_entries(to_text(number), stem(index(stem, '/', back=.true.) + 1:)//'.sweep/'//to_text(number))
         lines = lines(:len(lines) - 1)
      end function entry_of

   end subroutine verify_fields

   !> Tells of grids that are none of this sweep, as an interrupted one of the same name may leave them.
   subroutine check_surplus(summary, folder, numbers)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      character(*), intent(in) :: folder !! the folder of the grids
      integer, intent(in) :: numbers(:) !! numbers of the cases whose grids should be there
      type(file_name_t), allocatable :: files(:)
      type(error_t), allocatable :: error
      logical, allocatable :: has_grids(:)
      integer :: i, number
      logical :: ok

      ! What is missing is told when it is read.
      call list_directory(files, folder, error)
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
            if (.not. ok) call summary%faults%add(folder//'/'//name, 'not a grid of this sweep')
         end associate
      end do
   end subroutine check_surplus

   !> Checks the two grids of a case.
   subroutine check_case(summary, result, body, config, stem, case)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(result_t), intent(inout) :: result !! the load case; gains what the grids state
      type(body_t), intent(in) :: body !! the body
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! directory and name of the sweep
      type(field_case_t), intent(in) :: case !! the case
      character(:), allocatable :: fault, grid
      real(dp) :: limit

      grid = stem//'.sweep/'//to_text(case%number)
      limit = certificate_limit(config%method%tolerance)
      call new_contact_solution(result%solution, body%zone%n_points)
      call restore_displacement(result, body, grid//'.vtu', fault)
      if (len(fault) > 0) call summary%faults%add(grid//'.vtu', fault)
      if (len(fault) > 0) return
      call restore_force(result, body, grid//'.contact.vtu', fault)
      if (len(fault) > 0) call summary%faults%add(grid//'.contact.vtu', fault)
      if (len(fault) > 0) return
      result%solution%status = case%status
      call judge(result, body)
      call check_grids(summary%faults, config%units, body, result, grid)
      if (.not. result%certificate%largest() <= limit) call summary%faults%add(grid//'.vtu', &
         'equilibrium or contact law is violated by '//to_text(result%certificate%largest())// &
         ', more than the limit of '//to_text(limit))
      call check_law(summary%faults, body, result, grid//'.contact.vtu', .false.)
      call check_row(summary, result, body, config, stem//'.sweep.csv', case)
   end subroutine check_case

   !> Restores the contact forces from the stresses on the contact line.
   subroutine restore_force(result, body, path, fault)
      type(result_t), intent(inout) :: result !! gains the forces
      type(body_t), intent(in) :: body !! the body
      character(*), intent(in) :: path !! name of the grid of the contact line
      character(:), allocatable, intent(out) :: fault !! why they cannot be read; empty if they can
      real(dp), allocatable :: pressure(:), shear(:)

      allocate (pressure(n_line_points(body%zone)), shear(n_line_points(body%zone)))
      call read_array(path, 'contact_pressure', 1, pressure, fault)
      if (len(fault) > 0) return
      call read_array(path, 'contact_shear', 1, shear, fault)
      associate (m => body%zone%n_points, zone => body%zone)
         result%solution%force = [pressure(:m)*zone%area, shear(:m)*zone%shear_area]
      end associate
   end subroutine restore_force

   !> Compares the row of a case with the numbers that follow from its grids.
   subroutine check_row(summary, result, body, config, path, case)
      type(summary_file_t), intent(inout) :: summary !! gains the fault
      type(result_t), intent(in) :: result !! what the grids state
      type(body_t), intent(in) :: body !! the body
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: path !! name of the table
      type(field_case_t), intent(in) :: case !! the case and its row
      type(case_result_t) :: computed
      type(quantity_t), allocatable :: list(:), numbers(:), peaks(:)
      character(:), allocatable :: text, runs, header, fault
      logical :: is_lost

      computed = case%result
      allocate (peaks(0))
      if (config%sweep%has_body_results) peaks = body_peaks(body%mesh, result%displacement, result%stress%node)
      list = case_quantities(body, result%solution, result%load_case%friction, result%load_case%slip_bound, &
         result%load_case%free_gap, peaks)
      numbers = expanded(list)
      computed%quantity = numbers%value
      call status_runs(runs, case%status, body%zone%set)
      text = ''
      call append_row(text, config%sweep, case%number, computed, runs)
      header = sweep_header(config%sweep, case_keys(body, config%sweep))
      call compare_line(fault, case%row, text(:len(text) - 1), header(:len(header) - 1), &
         [spread(0.0_dp, 1, 1 + size(config%sweep%axes)), scales(list), 0.0_dp], 0.0_dp, is_lost)
      if (len(fault) > 0) call summary%faults%add(path//':'//to_text(case%number + 1), fault)
   end subroutine check_row

end module amontons_verify_fields
