!> The files of a solved reduced problem checked against each other: u = W r + q and the contact law are computed again
!> from the problem as it is read and the forces in NAME.contact.csv.
module amontons_verify_reduced
   use amontons_agreement, only: agree, contradiction
   use amontons_config, only: config_t
   use amontons_contact_check, only: check_statuses, contact_table_t, law_scales_t, read_point_rows
   use amontons_error, only: error_t
   use amontons_json, only: truth
   use amontons_kinds, only: dp
   use amontons_reduced_check, only: new_reduced_check, reduced_check_t
   use amontons_reduced_report, only: reduced_header
   use amontons_reduced_system, only: reduced_system_t
   use amontons_result, only: certificate_limit
   use amontons_solve_reduced, only: prepare_reduced, reduced_result_t
   use amontons_summary_check, only: summary_check_t
   use amontons_summary_members, only: warnings_array
   use amontons_text, only: to_text
   use amontons_warning_list, only: warning_list_t
   implicit none (type, external)
   private

   public :: verify_reduced

contains

   !> Checks the files of a reduced problem.
   subroutine verify_reduced(summary, config, stem, is_certified)
      type(summary_check_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(config_t), intent(in) :: config !! the case as its effective deck has it
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(out) :: is_certified !! whether it converged and the contact law holds
      type(reduced_result_t) :: result
      type(reduced_check_t) :: check
      type(contact_table_t) :: table
      type(error_t), allocatable :: error
      character(:), allocatable :: fault
      logical :: is_converged

      is_certified = .false.
      call prepare_reduced(config, result, error)
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      call read_table(table, stem//'.contact.csv', result%system%n_contacts, fault)
      if (len(fault) > 0) then
         call summary%faults%add(stem//'.contact.csv', fault)
         return
      end if
      is_converged = summary%value('', 'converged') == 'true'
      associate (system => result%system, limit => certificate_limit(config%method%tolerance))
         call system%set_solution(table%force, 1.0_dp)
         call check_displacements(summary, system, table, stem//'.contact.csv')
         call new_reduced_check(check, system)
         if (is_converged .and. system%n_contacts > 0) call check_statuses(summary%faults, stem//'.contact.csv', &
            .true., table, system%friction, spread(0.0_dp, 1, system%n_contacts), &
            spread(.false., 1, system%n_contacts), law_scales_t(limit*length_scale(system), &
            limit*maxval(abs(system%r))))
         call check_summary(summary, check, system, table, limit, result%warnings)
         is_certified = is_converged .and. check%largest() <= limit
      end associate
   end subroutine verify_reduced

   !> Reads the table of contacts; the tangential forces turn to the direction of the slip.
   subroutine read_table(table, path, n_contacts, fault)
      type(contact_table_t), intent(out) :: table !! what it states
      character(*), intent(in) :: path !! name of the file
      integer, intent(in) :: n_contacts !! number of contacts
      character(:), allocatable, intent(out) :: fault !! why it cannot be read; empty if it can
      real(dp) :: numbers(4, n_contacts)

      allocate (table%status(n_contacts))
      call read_point_rows(path, reduced_header, numbers, table%status, fault)
      if (len(fault) > 0) return
      table%gap = numbers(1, :)
      table%slip = numbers(2, :)
      table%force = [numbers(3, :), -numbers(4, :)]
   end subroutine read_table

   !> Compares the displacements with those that the forces make.
   subroutine check_displacements(summary, system, table, path)
      type(summary_check_t), intent(inout) :: summary !! gains the faults
      type(reduced_system_t), intent(in) :: system !! the problem, the forces of the table and their displacements
      type(contact_table_t), intent(in) :: table !! what the table states
      character(*), intent(in) :: path !! its name
      integer :: p

      do p = 1, system%n_contacts
         if (.not. agree(table%gap(p), system%u(2*p - 1), length_scale(system))) call summary%faults%add( &
            path//':'//to_text(p + 1), contradiction('gap of point '//to_text(p), table%gap(p), system%u(2*p - 1)))
         if (.not. agree(table%slip(p), system%u(2*p), length_scale(system))) call summary%faults%add( &
            path//':'//to_text(p + 1), contradiction('slip of point '//to_text(p), table%slip(p), system%u(2*p)))
      end do
   end subroutine check_displacements

   !> Largest displacement, with forces or without [L].
   pure real(dp) function length_scale(system)
      type(reduced_system_t), intent(in) :: system !! the problem and its solution

      length_scale = max(maxval(abs(system%u)), maxval(abs(system%q)))
   end function length_scale

   !> Checks the numbers of the summary.
   subroutine check_summary(summary, check, system, table, limit, warnings)
      type(summary_check_t), intent(inout) :: summary !! the summary; gains the faults
      type(reduced_check_t), intent(in) :: check !! the violations of the contact law
      type(reduced_system_t), intent(in) :: system !! the problem and the forces
      type(contact_table_t), intent(in) :: table !! the table of contacts
      real(dp), intent(in) :: limit !! what every violation must stay below [-]
      type(warning_list_t), intent(in) :: warnings !! what is doubtful about the problem

      call summary%expect_text('', 'warnings', warnings_array(warnings))
      call summary%expect_text('certificate', 'passed', truth(check%largest() <= limit))
      call summary%expect_number('certificate', 'limit', limit, 0.0_dp)
      call summary%expect_number('certificate', 'penetration', check%penetration, 1.0_dp)
      call summary%expect_number('certificate', 'tension', check%tension, 1.0_dp)
      call summary%expect_number('certificate', 'friction_excess', check%friction_excess, 1.0_dp)
      call summary%expect_number('certificate', 'complementarity', check%complementarity, 1.0_dp)
      call summary%expect_number('certificate', 'slip_below_bound', check%slip_below_bound, 1.0_dp)
      call summary%expect_number('certificate', 'wrong_dissipation', check%wrong_dissipation, 1.0_dp)
      call summary%expect_text('problem', 'entries', to_text(size(system%entry)))
      call summary%expect_number('problem', 'largest_compliance', system%largest, 0.0_dp)
      call summary%expect_number('problem', 'asymmetry', system%asymmetry, system%largest)
      call summary%expect_contact(table%status, system%r(1::2), system%r(2::2))
   end subroutine check_summary

end module amontons_verify_reduced
