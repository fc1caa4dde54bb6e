!> The files of a solved case: all of them, each whole, or none.
module amontons_report
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_contact_table, only: add_point_table, column_t, contact_columns, pair_names
   use amontons_convergence, only: refined_quantity_t, verdict_names
   use amontons_document, only: document_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_listing, only: new_listing, solutions_table_text
   use amontons_manifest, only: find_earlier_files, manifest_t, with_manifest
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_result, only: result_t
   use amontons_summary, only: new_summary
   use amontons_system, only: file_name_t, make_directory
   use amontons_terminal, only: phase_write
   use amontons_text, only: comma_separated, newline, to_text
   use amontons_vtu, only: write_case_grids
   implicit none (type, external)
   private

   public :: case_documents, commit_case, study_files_t, write_documents, write_report

   !> The files that a study of several steps adds to those of the last one.
   type :: study_files_t
      type(output_file_t), allocatable :: files(:) !! the finished files
      type(manifest_t) :: manifest !! what it has in a folder of its own, and what it has read
   end type study_files_t

contains

   !> Writes NAME.lst, NAME.contact.csv, NAME.vtu, NAME.contact.vtu and NAME.summary.json, NAME.deck.nml if there is a
   !> deck, and NAME.solutions.csv if all solutions are known; without a state to show only listing, deck and summary.
   !> The files are renamed when all are complete.
   subroutine write_report(directory, label, body, result, error, study)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(case_label_t), intent(in) :: label !! what the case is called: a configuration, or `new_case_label`
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(study_files_t), intent(in), optional :: study !! the files of a study of several steps
      type(document_t), allocatable :: documents(:)
      type(document_t) :: summary
      type(output_file_t), allocatable :: files(:)
      type(study_files_t) :: added
      character(:), allocatable :: stem
      integer :: n, n_grids

      call make_directory(directory, error)
      if (allocated(error)) return
      if (present(study)) added = study
      if (.not. allocated(added%files)) allocate (added%files(0))
      call case_documents(documents, label, body, result)
      n = size(documents)
      n_grids = merge(0, 2, allocated(result%answer))
      allocate (files(n + n_grids + size(added%files) + 1))
      files(n + n_grids + 1:size(files) - 1) = added%files
      stem = directory//'/'//label%name
      call write_documents(files, stem, documents, error)
      if (n_grids > 0 .and. .not. allocated(error)) call write_case_grids(files(n + 1:n + n_grids), stem, label%units, &
         body, result, error)
      call added%manifest%add_case(files, stem, result%has_reduced_files, error)
      if (.not. allocated(error)) then
         call added%manifest%add_inputs(body%mesh, result%load_case%contacts, result%load_case%loads)
         call result%timings%begin(phase_write)
         call new_summary(summary, label, body, result)
      end if
      call commit_case(files, added%manifest, directory, label%name, summary, error)
   end subroutine write_report

   !> Writes texts under their temporary names.
   subroutine write_documents(files, stem, documents, error)
      type(output_file_t), intent(inout) :: files(:) !! the files; the first ones become those of the texts
      character(*), intent(in) :: stem !! directory and name of the case
      type(document_t), intent(in) :: documents(:) !! the texts
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      integer :: i

      do i = 1, size(documents)
         call write_text_file(files(i), stem//documents(i)%ending, documents(i)%text(), error)
         if (allocated(error)) return
      end do
   end subroutine write_documents

   !> Writes the summary, which comes last, since it tells the time of writing, and gives all files their names; what an
   !> earlier run of the case left besides is removed.
   subroutine commit_case(files, manifest, directory, name, summary, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, the last one to become the summary
      type(manifest_t), intent(in) :: manifest !! the manifest of the others, and of what was read
      character(*), intent(in) :: directory !! output directory
      character(*), intent(in) :: name !! name of the case
      type(document_t), intent(in) :: summary !! the summary
      type(error_t), allocatable, intent(inout) :: error
         !! why the files are not complete, if they are not: they are then discarded; or why one cannot be written
      type(file_name_t), allocatable :: earlier(:)

      if (.not. allocated(error)) call write_text_file(files(size(files)), directory//'/'//name//summary%ending, &
         with_manifest(summary%text(), manifest), error)
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, name, manifest)
      call commit_files(files, error, earlier)
   end subroutine commit_case

   !> Makes the text files of a case, but for the summary.
   subroutine case_documents(documents, label, body, result)
      type(document_t), allocatable, intent(out) :: documents(:) !! the files
      class(case_label_t), intent(in) :: label !! what the case is called
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      character(:), allocatable :: deck, text
      integer :: n, i

      deck = label%deck_text()
      allocate (documents(1 + count([.not. allocated(result%answer), len(deck) > 0, allocated(result%convergence), &
         allocated(result%all_solutions)])))
      call new_listing(documents(1), label, body, result)
      n = 1
      if (.not. allocated(result%answer)) then
         n = n + 1
         call contact_columns(columns, body, result)
         call add_point_table(documents(n), columns, result%solution%status, &
            pair_names(body%zone, result%load_case%contacts))
      end if
      if (len(deck) > 0) then
         n = n + 1
         documents(n)%ending = '.deck.nml'
         call documents(n)%add(deck)
      end if
      if (allocated(result%convergence)) then
         n = n + 1
         documents(n)%ending = '.convergence.csv'
         ! NAME.convergence.csv: a row for each number, a column for each mesh.
         text = 'quantity'
         do i = 1, size(result%convergence(1)%convergence%value)
            text = text//',mesh_'//to_text(i)
         end do
         text = text//',verdict,order,extrapolated,error_bar'//newline
         do i = 1, size(result%convergence)
            associate (judged => result%convergence(i)%convergence)
               text = text//trim(result%convergence(i)%quantity%key)//','//comma_separated(judged%value)//','// &
                  trim(verdict_names(judged%verdict))//','//comma_separated([judged%order, judged%extrapolated, &
                  judged%bar])//newline
            end associate
         end do
         call documents(n)%add(text)
      end if
      if (.not. allocated(result%all_solutions)) return
      documents(n + 1)%ending = '.solutions.csv'
      call documents(n + 1)%record(solutions_table_text(result%all_solutions, result%load_case%free_gap))
   end subroutine case_documents

end module amontons_report
