!> The files of a solved reduced problem: all of them, each whole, or none.
module amontons_reduced_report
   use amontons_config, only: config_t
   use amontons_contact_table, only: add_point_table, column_t
   use amontons_document, only: document_t
   use amontons_earlier_files, only: find_earlier_files
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_manifest, only: manifest_t, with_manifest
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_reduced_listing, only: new_reduced_listing, reduced_columns
   use amontons_reduced_summary, only: new_reduced_summary
   use amontons_solutions_report, only: solutions_table_text
   use amontons_solve_reduced, only: reduced_result_t
   use amontons_system, only: file_name_t, make_directory
   use amontons_timings, only: phase_write
   implicit none (type, external)
   private

   public :: reduced_documents, write_reduced_report

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

   !> Makes the text files of a reduced problem, but for the summary.
   subroutine reduced_documents(documents, config, result)
      type(document_t), allocatable, intent(out) :: documents(:) !! the files
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      character(0) :: no_names(0)

      allocate (documents(3 + merge(1, 0, allocated(result%all_solutions))))
      call new_reduced_listing(documents(1), config, result)
      call reduced_columns(columns, result)
      call add_point_table(documents(2), columns, result%solution%status, no_names)
      documents(3)%ending = '.deck.nml'
      call documents(3)%add(config%deck_text())
      if (.not. allocated(result%all_solutions)) return
      documents(4)%ending = '.solutions.csv'
      call documents(4)%record(solutions_table_text(result%all_solutions, spread(0.0_dp, 1, result%system%n_contacts)))
   end subroutine reduced_documents

   !> Writes all files under their temporary names; the summary last, since it tells the time of writing.
   subroutine write_files(files, manifest, stem, config, result, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, the summary last
      type(manifest_t), intent(out) :: manifest !! their manifest
      character(*), intent(in) :: stem !! directory and name of the case
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(document_t), allocatable :: documents(:)
      type(document_t) :: summary
      integer :: i

      call reduced_documents(documents, config, result)
      do i = 1, size(documents)
         call write_text_file(files(i), stem//documents(i)%ending, documents(i)%text(), error)
         if (allocated(error)) return
      end do
      call manifest%add_outputs(files, '', error)
      if (result%has_reduced_files .and. .not. allocated(error)) call manifest%add_reduced(stem, error)
      if (allocated(error)) return
      call manifest%add_input(config%reduced%path)
      call result%timings%begin(phase_write)
      call new_reduced_summary(summary, config, result)
      call write_text_file(files(size(files)), stem//summary%ending, with_manifest(summary%text(), manifest), error)
   end subroutine write_files

end module amontons_reduced_report
