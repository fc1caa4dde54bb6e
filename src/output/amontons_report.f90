!> The files of a solved case: all of them, each whole, or none.
module amontons_report
   use amontons_accuracy_text, only: convergence_table_text
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_contact_table, only: add_point_table, column_t, contact_columns, pair_names
   use amontons_contact_vtu, only: write_contact_vtu
   use amontons_document, only: document_t
   use amontons_earlier_files, only: find_earlier_files
   use amontons_error, only: error_t
   use amontons_listing, only: new_listing
   use amontons_manifest, only: manifest_t, with_manifest
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_result, only: result_t
   use amontons_solutions_report, only: solutions_table_text
   use amontons_summary, only: new_summary
   use amontons_system, only: file_name_t, make_directory
   use amontons_timings, only: phase_write
   use amontons_vtu, only: write_vtu
   implicit none (type, external)
   private

   public :: case_documents, study_files_t, write_report

   !> The files that a study of several steps adds to those of the last one.
   type :: study_files_t
      type(output_file_t), allocatable :: files(:) !! the finished files
      type(manifest_t) :: manifest !! what it has in a folder of its own, and what it has read
   end type study_files_t

contains

   !> Writes NAME.lst, NAME.contact.csv, NAME.vtu, NAME.contact.vtu and NAME.summary.json, NAME.deck.nml if there is a
   !> deck, and NAME.solutions.csv if all solutions are known. The files are renamed when all are complete.
   subroutine write_report(directory, label, body, result, error, study)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(case_label_t), intent(in) :: label !! what the case is called: a configuration, or `new_case_label`
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(study_files_t), intent(in), optional :: study !! the files of a study of several steps
      type(output_file_t), allocatable :: files(:)
      type(study_files_t) :: added
      type(file_name_t), allocatable :: earlier(:)
      type(manifest_t) :: manifest

      call make_directory(directory, error)
      if (allocated(error)) return
      if (present(study)) added = study
      if (.not. allocated(added%files)) allocate (added%files(0))
      call write_files(files, manifest, directory//'/'//label%name, label, body, result, added, error)
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, label%name, manifest)
      call commit_files(files, error, earlier)
   end subroutine write_report

   !> Makes the text files of a case, but for the summary.
   subroutine case_documents(documents, label, body, result)
      type(document_t), allocatable, intent(out) :: documents(:) !! the files
      class(case_label_t), intent(in) :: label !! what the case is called
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      character(:), allocatable :: deck

      deck = label%deck_text()
      allocate (documents(2 + count([len(deck) > 0, allocated(result%convergence), allocated(result%all_solutions)])))
      call new_listing(documents(1), label, body, result)
      call contact_columns(columns, body, result)
      call add_point_table(documents(2), columns, result%solution%status, &
         pair_names(body%zone, result%load_case%contacts))
      if (len(deck) > 0) then
         documents(3)%ending = '.deck.nml'
         call documents(3)%add(deck)
      end if
      if (allocated(result%convergence)) then
         associate (next => documents(3 + count([len(deck) > 0])))
            next%ending = '.convergence.csv'
            call next%record(convergence_table_text(result%convergence))
         end associate
      end if
      if (.not. allocated(result%all_solutions)) return
      associate (last => documents(size(documents)))
         last%ending = '.solutions.csv'
         call last%record(solutions_table_text(result%all_solutions, result%load_case%free_gap))
      end associate
   end subroutine case_documents

   !> Writes all files under their temporary names; the summary last, since it tells the time of writing.
   subroutine write_files(files, manifest, stem, label, body, result, study, error)
      type(output_file_t), allocatable, intent(out) :: files(:) !! the finished files, the summary last
      type(manifest_t), intent(out) :: manifest !! their manifest
      character(*), intent(in) :: stem !! directory and name of the case
      class(case_label_t), intent(in) :: label !! what the case is called
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(inout) :: result !! the result; gains the time of writing
      type(study_files_t), intent(in) :: study !! the files of a study of several steps
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(document_t), allocatable :: documents(:)
      type(document_t) :: summary
      integer :: i, n

      call case_documents(documents, label, body, result)
      n = size(documents)
      allocate (files(n + size(study%files) + 3))
      files(n + 3:size(files) - 1) = study%files
      manifest = study%manifest
      do i = 1, n
         call write_text_file(files(i), stem//documents(i)%ending, documents(i)%text(), error)
         if (allocated(error)) return
      end do
      call write_vtu(files(n + 1), stem//'.vtu', label%units, body, result, error)
      if (allocated(error)) return
      call write_contact_vtu(files(n + 2), stem//'.contact.vtu', label%units, body, result, error)
      if (allocated(error)) return
      call manifest%add_outputs(files, '', error)
      if (result%has_reduced_files .and. .not. allocated(error)) call manifest%add_reduced(stem, error)
      if (allocated(error)) return
      call manifest%add_inputs(body%mesh, result%load_case%contacts, result%load_case%loads)
      call result%timings%begin(phase_write)
      call new_summary(summary, label, body, result)
      call write_text_file(files(size(files)), stem//summary%ending, with_manifest(summary%text(), manifest), error)
   end subroutine write_files

end module amontons_report
