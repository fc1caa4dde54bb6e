!> The files of a solved case checked against each other: its result is restored from the deck, the mesh, the
!> displacements in NAME.vtu and the forces and statuses in NAME.contact.csv, and written again: every file must say the
!> same.
!>
!> No matrix is assembled and none factorized, and no method runs: the forces of the elements come from their
!> displacements, one by one.
module amontons_verify_case
   use amontons_answer_report, only: answer_documents
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_contact_check, only: check_statuses, contact_state_t, new_law_scales, read_points
   use amontons_contact_solution, only: new_contact_solution
   use amontons_contact_vtu, only: n_line_cells, n_line_points, show_contact_line
   use amontons_document, only: document_t
   use amontons_document_check, only: compare_document
   use amontons_error, only: error_t
   use amontons_fault_list, only: fault_list_t
   use amontons_report, only: case_documents
   use amontons_result, only: certificate_limit, result_t
   use amontons_result_warnings, only: add_result_warnings
   use amontons_solve_case, only: cache_t, prepare_case, solve_case
   use amontons_solve_load_case, only: judge
   use amontons_summary, only: new_summary
   use amontons_summary_file, only: summary_file_t
   use amontons_vtk_check, only: new_vtk_check, read_displacement, vtk_check_t
   use amontons_vtu, only: show_body
   implicit none (type, external)
   private

   public :: check_grids, check_law, restore_displacement, verify_case, verify_result

contains

   !> Checks the files of a case.
   subroutine verify_case(summary, cache, config, stem, is_certified)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case as its effective deck has it
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(out) :: is_certified !! whether it converged and its certificate passes
      type(result_t) :: result
      type(document_t) :: listing, answer
      type(error_t), allocatable :: error

      is_certified = .false.
      ! That friction does not hold a body follows from a solution alone.
      if (summary%value('', 'outcome') == '"no_equilibrium"') then
         call solve_case(cache, config, result, error)
      else
         call prepare_case(cache, config, result, error)
      end if
      if (result%has_no_equilibrium) then
         call answer_documents(listing, answer, config, cache%body, result, error%message)
         call compare_document(summary%faults, stem, answer)
         call compare_document(summary%faults, stem, listing)
         is_certified = .true.
         return
      end if
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      call verify_result(summary, cache%body, config, stem, result, is_certified)
   end subroutine verify_case

   !> Checks the files of a load case, which may be a step of a history.
   subroutine verify_result(summary, body, config, stem, result, is_certified)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(body_t), intent(in) :: body !! the body
      type(config_t), intent(in) :: config !! the case as its effective deck has it
      character(*), intent(in) :: stem !! directory and name of the case
      type(result_t), intent(inout) :: result !! the load case; gains what the files state, and what follows
      logical, intent(out) :: is_certified !! whether it converged and its certificate passes
      character(:), allocatable :: fault

      is_certified = .false.
      call new_contact_solution(result%solution, body%zone%n_points)
      call read_points(stem//'.contact.csv', body%zone%n_points, result%solution%force, &
         result%solution%status, fault)
      if (len(fault) > 0) call summary%faults%add(stem//'.contact.csv', fault)
      if (len(fault) > 0) return
      call restore_displacement(result, body, stem//'.vtu', fault)
      if (len(fault) > 0) call summary%faults%add(stem//'.vtu', fault)
      if (len(fault) > 0) return
      ! The last step of a history that ended early has converged.
      result%solution%is_converged = summary%value('', 'converged') == 'true' .or. .not. result%is_complete
      result%condition = summary%number('', 'condition')
      call judge(result, body)
      call add_result_warnings(result, body)
      if (result%solution%is_converged) call check_law(summary%faults, body, result, stem//'.contact.csv', .true.)
      call check_texts(summary%faults, config, body, result, stem)
      call check_grids(summary%faults, config%units, body, result, stem)
      is_certified = result%solution%is_converged .and. &
         result%certificate%largest() <= certificate_limit(config%method%tolerance)
   end subroutine verify_result

   !> Reads the displacements of the nodes, and finds those of the contact points.
   subroutine restore_displacement(result, body, path, fault)
      type(result_t), intent(inout) :: result !! the load case; gains the displacements
      type(body_t), intent(in) :: body !! the body
      character(*), intent(in) :: path !! name of the grid of the body
      character(:), allocatable, intent(out) :: fault !! why they cannot be read; empty if they can
      integer :: m

      call read_displacement(path, body%mesh%n_nodes, result%displacement, fault)
      if (len(fault) > 0) return
      m = body%zone%n_points
      result%solution%displacement = body%zone%rows%displacement(result%displacement)
      ! What supports prescribe is no unknown of the contact problem.
      result%solution%displacement(:m) = result%solution%displacement(:m) + &
         (result%load_case%free_gap - result%load_case%gap)
   end subroutine restore_displacement

   !> Writes the texts again and compares.
   subroutine check_texts(faults, config, body, result, stem)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result as it was restored
      character(*), intent(in) :: stem !! directory and name of the case
      type(document_t), allocatable :: documents(:)
      type(document_t) :: summary
      integer :: i

      call new_summary(summary, config, body, result)
      call compare_document(faults, stem, summary)
      call case_documents(documents, config, body, result)
      do i = size(documents), 1, -1
         call compare_document(faults, stem, documents(i))
      end do
   end subroutine check_texts

   !> Checks all that the two grids show: mesh, stresses, contact quantities.
   subroutine check_grids(faults, units, body, result, stem)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: units !! names of the units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result as it was restored
      character(*), intent(in) :: stem !! directory and name of the case
      type(vtk_check_t) :: check

      call new_vtk_check(check, stem//'.vtu', units, body%mesh%n_nodes, body%mesh%n_elements)
      call show_body(check, body, result)
      call check%close()
      call faults%append(check%faults)
      call new_vtk_check(check, stem//'.contact.vtu', units, n_line_points(body%zone), n_line_cells(body%zone))
      call show_contact_line(check, body, result)
      call check%close()
      call faults%append(check%faults)
   end subroutine check_grids

   !> Holds the statuses of a converged case against the contact law.
   subroutine check_law(faults, body, result, path, has_rows)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result as it was restored
      character(*), intent(in) :: path !! name of the file that states forces and statuses
      logical, intent(in) :: has_rows !! whether it has a line for each point, behind one of names
      integer :: m

      m = body%zone%n_points
      if (m == 0) return
      associate (load_case => result%load_case, solution => result%solution)
         call check_statuses(faults, path, has_rows, contact_state_t(load_case%free_gap - solution%displacement(:m), &
            solution%displacement(m + 1:) - load_case%anchor, solution%force, solution%status), &
            load_case%friction, load_case%slip_bound, &
            body%zone%is_tangent_fixed, new_law_scales(certificate_limit(result%method%tolerance), &
            result%displacement, result%certificate%force_scale))
      end associate
   end subroutine check_law

end module amontons_verify_case
