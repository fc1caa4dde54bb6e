!> The files of a solved reduced problem: all of them, each whole, or none.
module amontons_reduced_report
   use amontons_config, only: config_t, effective_deck
   use amontons_directory, only: file_name_t
   use amontons_earlier_files, only: find_earlier_files
   use amontons_error, only: error_t
   use amontons_friction_law, only: status_names
   use amontons_kinds, only: dp
   use amontons_manifest, only: manifest_t, with_manifest
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_reduced_listing, only: reduced_listing_text
   use amontons_reduced_summary, only: reduced_summary_text
   use amontons_solutions_report, only: solutions_table_text
   use amontons_solve_reduced, only: reduced_result_t
   use amontons_system, only: make_directory
   use amontons_text, only: as_lines, comma_separated, newline, to_text
   use amontons_timings, only: phase_write
   implicit none (type, external)
   private

   public :: reduced_header, write_reduced_report

   !> The header of the table.
   character(*), parameter :: reduced_header = 'point,gap,slip,normal_force,tangential_force,status'

   !> Number of files that every reduced problem leaves.
   integer, parameter :: n_files = 4

contains

   !> Writes NAME.lst, NAME.contact.csv, NAME.deck.nml and NAME.summary.json, and NAME.solutions.csv if all solutions
   !> are known. Names change hands only after every file is complete.
   subroutine write_reduced_report(directory, config, result, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(n_files + merge(1, 0, allocated(result%all_solutions)))
      type(file_name_t), allocatable :: earlier(:)
      type(manifest_t) :: manifest

      call make_directory(directory, error)
      if (allocated(error)) return
      call write_files(files, manifest, directory//'/'//config%name, config, result, error)
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, config%name, manifest)
      call commit_files(files, error, earlier)
   end subroutine write_reduced_report

   !> Writes all files under their temporary names; the summary last, since it tells the time of writing.
   subroutine write_files(files, manifest, stem, config, result, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, the summary last
      type(manifest_t), intent(out) :: manifest !! their manifest
      character(*), intent(in) :: stem !! directory and name of the case
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written

      call write_text_file(files(1), stem//'.lst', reduced_listing_text(config, result), error)
      if (allocated(error)) return
      call write_text_file(files(2), stem//'.contact.csv', table_text(result), error)
      if (allocated(error)) return
      call write_text_file(files(3), stem//'.deck.nml', effective_deck(config), error)
      if (allocated(error)) return
      if (allocated(result%all_solutions)) then
         call write_text_file(files(n_files), stem//'.solutions.csv', solutions_table_text(result%all_solutions, &
            spread(0.0_dp, 1, result%system%n_contacts)), error)
         if (allocated(error)) return
      end if
      call manifest%add_outputs(files, '', error)
      if (result%has_reduced_files .and. .not. allocated(error)) call manifest%add_reduced(stem, error)
      if (allocated(error)) return
      call manifest%add_inputs(config)
      call result%timings%begin(phase_write)
      call write_text_file(files(size(files)), stem//'.summary.json', with_manifest(reduced_summary_text(config, &
         result), manifest), error)
   end subroutine write_files

   !> The table: one row per contact.
   pure function table_text(result) result(text)
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      character(150) :: rows(result%system%n_contacts)
      integer :: p

      associate (u => result%system%u, r => result%system%r)
         do p = 1, result%system%n_contacts
            rows(p) = to_text(p)//','//comma_separated([u(2*p - 1:2*p), r(2*p - 1:2*p)])//','// &
               status_names(result%solution%status(p))
         end do
      end associate
      text = reduced_header//newline//as_lines(rows)
   end function table_text

end module amontons_reduced_report
