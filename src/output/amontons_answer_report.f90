!> The files of a case without a state to show: its answer is that there is no equilibrium, or that the first step of
!> its history did not converge.
module amontons_answer_report
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_document, only: document_t
   use amontons_earlier_files, only: find_earlier_files
   use amontons_error, only: error_t
   use amontons_json, only: json_string
   use amontons_listing_model, only: model_text
   use amontons_listing_parts, only: head_text, warnings_text
   use amontons_listing_text, only: heading
   use amontons_manifest, only: manifest_t, with_manifest
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_result, only: outcome_word, result_t
   use amontons_summary_members, only: add_head, last_members, member, size_counts
   use amontons_system, only: file_name_t, make_directory
   use amontons_text, only: newline
   implicit none (type, external)
   private

   public :: answer_documents, write_answer

contains

   !> Writes NAME.lst, NAME.deck.nml and NAME.summary.json; what an earlier run of the case left besides is removed.
   subroutine write_answer(directory, label, body, result, sentence, error, others)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(case_label_t), intent(in) :: label !! what the case is called
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the load case and its warnings
      character(*), intent(in) :: sentence !! the answer
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(manifest_t), intent(in), optional :: others !! what was read besides mesh, obstacles and loads
      type(document_t) :: listing, summary
      type(output_file_t) :: files(3)
      type(file_name_t), allocatable :: earlier(:)
      type(manifest_t) :: manifest
      character(:), allocatable :: stem

      call make_directory(directory, error)
      if (allocated(error)) return
      if (present(others)) manifest = others
      stem = directory//'/'//label%name
      call answer_documents(listing, summary, label, body, result, sentence)
      call write_text_file(files(1), stem//listing%ending, listing%text(), error)
      if (.not. allocated(error)) call write_text_file(files(2), stem//'.deck.nml', label%deck_text(), error)
      if (.not. allocated(error)) call manifest%add_outputs(files, '', error)
      if (.not. allocated(error)) then
         call manifest%add_inputs(body%mesh, result%load_case%contacts, result%load_case%loads)
         call write_text_file(files(3), stem//summary%ending, with_manifest(summary%text(), manifest), error)
      end if
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, label%name, manifest)
      call commit_files(files, error, earlier)
   end subroutine write_answer

   !> Makes the listing and the summary.
   subroutine answer_documents(listing, summary, label, body, result, sentence)
      type(document_t), intent(out) :: listing !! the listing: model, loads and the answer
      type(document_t), intent(out) :: summary !! the summary
      class(case_label_t), intent(in) :: label !! what the case is called
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the load case and its warnings
      character(*), intent(in) :: sentence !! the answer

      listing%ending = '.lst'
      call listing%record(head_text(label))
      call listing%add(warnings_text(result%warnings))
      call listing%add(model_text(body, result%load_case, label%units))
      call listing%add(heading('Solution')//'  '//sentence//newline)
      call add_head(summary, label, result%method%method, outcome_word(result), result%warnings)
      call summary%add(member('message', json_string(sentence)))
      call summary%add(member('counts', '{'//size_counts(body)//'}'))
      call summary%record(last_members(result%timings))
   end subroutine answer_documents

end module amontons_answer_report
