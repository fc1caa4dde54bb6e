!> The files of a solved reduced problem checked against each other: u = W r + q and the contact law are computed again
!> from the problem as it is read and the forces in NAME.contact.csv, and all files written again.
module amontons_verify_reduced
   use amontons_config, only: config_t
   use amontons_contact_check, only: check_statuses, contact_state_t, law_scales_t, read_points
   use amontons_contact_solution, only: new_contact_solution
   use amontons_document, only: document_t
   use amontons_document_check, only: compare_document
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_reduced_check, only: new_reduced_check
   use amontons_reduced_report, only: reduced_documents
   use amontons_reduced_summary, only: new_reduced_summary
   use amontons_result, only: certificate_limit
   use amontons_solve_reduced, only: prepare_reduced, reduced_result_t
   use amontons_summary_file, only: summary_file_t
   implicit none (type, external)
   private

   public :: verify_reduced

contains

   !> Checks the files of a reduced problem.
   subroutine verify_reduced(summary, config, stem, is_certified)
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(config_t), intent(in) :: config !! the case as its effective deck has it
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(out) :: is_certified !! whether it converged and the contact law holds
      type(reduced_result_t) :: result
      type(document_t), allocatable :: documents(:)
      type(document_t) :: rewritten
      type(error_t), allocatable :: error
      character(:), allocatable :: fault
      integer :: i

      is_certified = .false.
      call prepare_reduced(config, result, error)
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      associate (system => result%system, solution => result%solution)
         call new_contact_solution(solution, system%n_contacts)
         call read_points(stem//'.contact.csv', system%n_contacts, solution%force, solution%status, fault)
         if (len(fault) > 0) call summary%faults%add(stem//'.contact.csv', fault)
         if (len(fault) > 0) return
         ! The tangential forces turn to the direction of the slip.
         solution%force(system%n_contacts + 1:) = -solution%force(system%n_contacts + 1:)
         solution%is_converged = summary%value('', 'converged') == 'true'
         call system%set_solution(solution%force, 1.0_dp)
         call new_reduced_check(result%check, system)
         if (solution%is_converged) call check_law(summary, config, result, stem//'.contact.csv')
         call new_reduced_summary(rewritten, config, result)
         call compare_document(summary%faults, stem, rewritten)
         call reduced_documents(documents, config, result)
         do i = size(documents), 1, -1
            call compare_document(summary%faults, stem, documents(i))
         end do
         is_certified = solution%is_converged .and. &
            result%check%largest() <= certificate_limit(config%method%tolerance)
      end associate
   end subroutine verify_reduced

   !> Holds the statuses of a converged case against the contact law.
   subroutine check_law(summary, config, result, path)
      type(summary_file_t), intent(inout) :: summary !! gains the faults
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result as it was restored
      character(*), intent(in) :: path !! name of the table
      type(contact_state_t) :: points
      integer :: n

      n = result%system%n_contacts
      if (n == 0) return
      associate (system => result%system, limit => certificate_limit(config%method%tolerance))
         points%gap = system%u(1::2)
         points%slip = system%u(2::2)
         points%force = result%solution%force
         points%status = result%solution%status
         call check_statuses(summary%faults, path, .true., points, system%friction, spread(0.0_dp, 1, n), &
            spread(.false., 1, n), law_scales_t(limit*maxval(abs([system%u, system%q])), limit*maxval(abs(system%r))))
      end associate
   end subroutine check_law

end module amontons_verify_reduced
