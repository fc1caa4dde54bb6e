!> The files of a solved case: all of them, each whole, or none.
module amontons_report
   use amontons_body, only: body_t
   use amontons_config, only: config_t, effective_deck
   use amontons_contact_table, only: contact_table_text
   use amontons_contact_vtu, only: write_contact_vtu
   use amontons_directory, only: file_name_t
   use amontons_earlier_files, only: find_earlier_files
   use amontons_error, only: error_t
   use amontons_listing, only: listing_text
   use amontons_manifest, only: manifest_t, with_manifest
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_result, only: result_t
   use amontons_solutions_report, only: solutions_table_text
   use amontons_summary, only: summary_text
   use amontons_system, only: make_directory
   use amontons_timings, only: phase_write
   use amontons_vtu, only: write_vtu
   implicit none (type, external)
   private

   public :: study_files_t, write_report

   !> Number of files that every case leaves.
   integer, parameter :: n_files = 6

   !> What a study of several steps adds to the files of its last one.
   type :: study_files_t
      character(:), allocatable :: listing !! its section of the listing
      character(:), allocatable :: summary !! its members of the summary
      type(output_file_t), allocatable :: files(:) !! its finished files
      type(manifest_t) :: grids !! the manifest of what it has in a folder of its own
   end type study_files_t

contains

   !> Writes NAME.lst, NAME.contact.csv, NAME.vtu, NAME.contact.vtu, NAME.deck.nml and NAME.summary.json, and
   !> NAME.solutions.csv if all solutions are known. Names change hands only after every file is complete.
   subroutine write_report(directory, config, body, result, error, study)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(study_files_t), intent(in), optional :: study !! what a study of several steps adds
      type(output_file_t), allocatable :: files(:)
      type(study_files_t) :: added
      type(file_name_t), allocatable :: earlier(:)
      type(manifest_t) :: manifest

      call make_directory(directory, error)
      if (allocated(error)) return
      if (present(study)) then
         added = study
      else
         added%listing = ''
         added%summary = ''
         allocate (added%files(0))
      end if
      allocate (files(n_files + merge(1, 0, allocated(result%all_solutions)) + size(added%files)))
      call write_files(files, manifest, directory//'/'//config%name, config, body, result, added, error)
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, config%name, manifest)
      call commit_files(files, error, earlier)
   end subroutine write_report

   !> Writes all files under their temporary names; the summary last, since it tells the time of writing.
   subroutine write_files(files, manifest, stem, config, body, result, study, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, the summary last
      type(manifest_t), intent(out) :: manifest !! their manifest
      character(*), intent(in) :: stem !! directory and name of the case
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(inout) :: result !! the result; gains the time of writing
      type(study_files_t), intent(in) :: study !! what a study of several steps adds
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written

      files(size(files) - size(study%files):size(files) - 1) = study%files
      manifest = study%grids
      call write_text_file(files(1), stem//'.lst', listing_text(config, body, result, study%listing), error)
      if (allocated(error)) return
      call write_text_file(files(2), stem//'.contact.csv', contact_table_text(body, result), error)
      if (allocated(error)) return
      call write_vtu(files(3), stem//'.vtu', body, result, error)
      if (allocated(error)) return
      call write_contact_vtu(files(4), stem//'.contact.vtu', body, result, error)
      if (allocated(error)) return
      call write_text_file(files(5), stem//'.deck.nml', effective_deck(config), error)
      if (allocated(error)) return
      if (allocated(result%all_solutions)) then
         call write_text_file(files(n_files), stem//'.solutions.csv', solutions_table_text(result%all_solutions, &
            result%load_case%free_gap), error)
         if (allocated(error)) return
      end if
      call manifest%add_outputs(files, '', error)
      if (result%has_reduced_files .and. .not. allocated(error)) call manifest%add_reduced(stem, error)
      if (allocated(error)) return
      call manifest%add_inputs(config)
      call result%timings%begin(phase_write)
      call write_text_file(files(size(files)), stem//'.summary.json', &
         with_manifest(summary_text(config, body, result, study%summary), manifest), error)
   end subroutine write_files

end module amontons_report
