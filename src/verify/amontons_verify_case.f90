!> The files of a solved case checked against each other: equilibrium, kinematics, contact law and certificate are
!> computed again from the deck, the mesh, the displacements in NAME.vtu and the forces in NAME.contact.csv.
!>
!> No matrix is assembled and none factorized, and no method runs: the forces of the elements come from their
!> displacements, one by one.
module amontons_verify_case
   use amontons_certificate, only: new_certificate
   use amontons_config, only: config_t
   use amontons_contact_check, only: check_contact_rows, check_statuses, contact_table_t, law_scales_t, &
      new_law_scales, read_contact_rows
   use amontons_contact_vtu, only: n_line_cells, show_contact_line
   use amontons_error, only: error_t
   use amontons_json, only: truth
   use amontons_kinds, only: dp
   use amontons_lengths, only: new_lengths
   use amontons_listing, only: certificate_text, points_text, resultants_text, zones_text
   use amontons_listing_check, only: check_section
   use amontons_listing_model, only: loads_text, model_text
   use amontons_listing_parts, only: warnings_text
   use amontons_result, only: certificate_limit, result_t
   use amontons_result_warnings, only: add_result_warnings
   use amontons_solve_case, only: cache_t, prepare_case
   use amontons_summary_check, only: summary_check_t
   use amontons_summary_members, only: warnings_array
   use amontons_text, only: to_text
   use amontons_text_file, only: read_text_file
   use amontons_vtk_check, only: new_vtk_check, read_displacement, vtk_check_t
   use amontons_vtu, only: show_body
   implicit none (type, external)
   private

   public :: check_grids, verify_case

contains

   !> Checks the files of a case.
   subroutine verify_case(summary, cache, config, stem, is_certified)
      type(summary_check_t), intent(inout) :: summary !! the summary; gains the faults of all files
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case as its effective deck has it
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(out) :: is_certified !! whether it converged and its certificate passes
      type(result_t) :: result
      type(contact_table_t) :: table
      type(error_t), allocatable :: error
      character(:), allocatable :: fault

      is_certified = .false.
      call prepare_case(cache, config, result, error)
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      associate (body => cache%body)
         call read_displacement(stem//'.vtu', body%mesh%n_nodes, result%displacement, fault)
         if (len(fault) > 0) call summary%faults%add(stem//'.vtu', fault)
         if (len(fault) > 0) return
         call read_contact_rows(table, stem//'.contact.csv', body%zone%n_points, fault)
         if (len(fault) > 0) call summary%faults%add(stem//'.contact.csv', fault)
         if (len(fault) > 0) return
         result%solution%force = table%force
         result%solution%displacement = [result%load_case%free_gap - table%gap, table%slip]
         result%solution%status = table%status
         result%solution%is_converged = summary%value('', 'converged') == 'true'
         call new_certificate(result%certificate, body, result%load_case, result%displacement, result%solution%force)
         call new_lengths(result%lengths, body%zone, result%solution%status)
         call summary%take_condition(result%condition)
         call add_result_warnings(result, body)
      end associate
      call check_points(summary, cache, config, result, table, stem)
      call check_summary(summary, cache, config, result)
      call check_grids(summary, cache, result, stem)
      call check_listing(summary, cache, config, result, stem//'.lst')
      is_certified = result%solution%is_converged .and. &
         result%certificate%largest() <= certificate_limit(config%method%tolerance)
   end subroutine verify_case

   !> Checks the table of contact points.
   subroutine check_points(summary, cache, config, result, table, stem)
      type(summary_check_t), intent(inout) :: summary !! gains the faults
      type(cache_t), intent(in) :: cache !! the body
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(in) :: result !! what the files state
      type(contact_table_t), intent(in) :: table !! the table
      character(*), intent(in) :: stem !! directory and name of the case
      type(law_scales_t) :: scales

      if (size(table%status) == 0) return
      call check_contact_rows(summary%faults, stem//'.contact.csv', table, cache%body, result%load_case%gap, &
         result%displacement)
      if (.not. result%solution%is_converged) return
      scales = new_law_scales(certificate_limit(config%method%tolerance), result%displacement, &
         result%certificate%force_scale)
      associate (load_case => result%load_case)
         call check_statuses(summary%faults, stem//'.contact.csv', .true., table, load_case%friction, &
            load_case%slip_bound, cache%body%zone%is_tangent_fixed, scales)
      end associate
   end subroutine check_points

   !> Checks the numbers of the summary.
   subroutine check_summary(summary, cache, config, result)
      type(summary_check_t), intent(inout) :: summary !! the summary; gains the faults
      type(cache_t), intent(in) :: cache !! the body
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(in) :: result !! what the files state
      integer :: m

      associate (body => cache%body, force => result%solution%force, limit => &
         certificate_limit(config%method%tolerance))
         m = body%zone%n_points
         call summary%expect_text('', 'warnings', warnings_array(result%warnings))
         call summary%expect_text('certificate', 'passed', truth(result%certificate%largest() <= limit))
         call summary%expect_number('certificate', 'limit', limit, 0.0_dp)
         call summary%expect_certificate(result%certificate)
         if (any(config%contacts%partition%is_constant)) then
            call summary%expect_number('', 'inf_sup', minval(body%inf_sup), 1.0_dp)
         end if
         call summary%expect_text('counts', 'nodes', to_text(body%mesh%n_nodes))
         call summary%expect_text('counts', 'elements', to_text(body%mesh%n_elements))
         call summary%expect_text('counts', 'dofs', to_text(body%dof_map%n_dofs))
         call summary%expect_contact(result%solution%status, force(:m), force(m + 1:))
         call summary%expect_number('lengths', 'open_length', result%lengths%open, 0.0_dp)
         call summary%expect_number('lengths', 'slip_length', result%lengths%slip, 0.0_dp)
         call summary%expect_number('lengths', 'stick_length', result%lengths%stick, 0.0_dp)
      end associate
   end subroutine check_summary

   !> Checks all that the two grids show: mesh, stresses, contact quantities.
   subroutine check_grids(summary, cache, result, stem)
      type(summary_check_t), intent(inout) :: summary !! gains the faults
      type(cache_t), intent(in) :: cache !! the body
      type(result_t), intent(in) :: result !! what the files state
      character(*), intent(in) :: stem !! directory and name of the case
      type(vtk_check_t) :: check

      associate (body => cache%body)
         call new_vtk_check(check, stem//'.vtu', body%mesh%n_nodes, body%mesh%n_elements)
         call show_body(check, body, result)
         call check%close()
         call summary%faults%append(check%faults)
         call new_vtk_check(check, stem//'.contact.vtu', body%zone%n_points, n_line_cells(body%zone))
         call show_contact_line(check, body, result)
         call check%close()
         call summary%faults%append(check%faults)
      end associate
   end subroutine check_grids

   !> Checks the sections of the listing that follow from other files.
   subroutine check_listing(summary, cache, config, result, path)
      type(summary_check_t), intent(inout) :: summary !! gains the faults
      type(cache_t), intent(in) :: cache !! the body
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(in) :: result !! what the files state
      character(*), intent(in) :: path !! name of the listing
      character(:), allocatable :: listing
      type(error_t), allocatable :: error

      call read_text_file(path, listing, error)
      if (allocated(error)) then
         call summary%faults%add(path, 'cannot be read')
         return
      end if
      associate (body => cache%body, faults => summary%faults, force => sum(abs(result%load_case%force)))
         call check_section(faults, path, listing, warnings_text(result%warnings), 0.0_dp)
         call check_section(faults, path, listing, model_text(config, body, result%load_case)//loads_text(config), &
            0.0_dp)
         call check_section(faults, path, listing, zones_text(body, result), 0.0_dp)
         call check_section(faults, path, listing, resultants_text(body, result), &
            max(force, sum(abs(result%solution%force)), result%certificate%strain_energy))
         call check_section(faults, path, listing, certificate_text(config, result%certificate), 1.0_dp)
         call check_section(faults, path, listing, points_text(body, result), 0.0_dp)
      end associate
   end subroutine check_listing

end module amontons_verify_case
