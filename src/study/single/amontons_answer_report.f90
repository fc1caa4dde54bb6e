!> The files of a case whose answer is that there is no equilibrium.
module amontons_answer_report
   use amontons_body, only: body_t
   use amontons_config, only: config_t, effective_deck
   use amontons_directory, only: file_name_t
   use amontons_earlier_files, only: find_earlier_files
   use amontons_error, only: error_t
   use amontons_json, only: string
   use amontons_listing_model, only: loads_text, model_text
   use amontons_listing_parts, only: head_text, warnings_text
   use amontons_listing_text, only: heading
   use amontons_manifest, only: manifest_t, with_manifest
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_result, only: result_t
   use amontons_summary_members, only: head_members, last_members, member, size_counts
   use amontons_system, only: make_directory
   use amontons_text, only: newline
   implicit none (type, external)
   private

   public :: answer_text, write_answer

contains

   !> Writes NAME.lst, NAME.deck.nml and NAME.summary.json; what an earlier run of the case left besides is removed.
   subroutine write_answer(directory, config, body, result, sentence, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the load case and its warnings
      character(*), intent(in) :: sentence !! the answer
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(3)
      type(file_name_t), allocatable :: earlier(:)
      type(manifest_t) :: manifest
      character(:), allocatable :: stem

      call make_directory(directory, error)
      if (allocated(error)) return
      stem = directory//'/'//config%name
      call write_text_file(files(1), stem//'.lst', answer_listing(config, body, result, sentence), error)
      if (.not. allocated(error)) call write_text_file(files(2), stem//'.deck.nml', effective_deck(config), error)
      if (.not. allocated(error)) call manifest%add_outputs(files, '', error)
      if (.not. allocated(error)) then
         call manifest%add_inputs(config)
         call write_text_file(files(3), stem//'.summary.json', &
            with_manifest(answer_summary(config, body, result, sentence), manifest), error)
      end if
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, config%name, manifest)
      call commit_files(files, error, earlier)
   end subroutine write_answer

   !> The listing: model, loads, and the answer.
   function answer_listing(config, body, result, sentence) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the load case and its warnings
      character(*), intent(in) :: sentence !! the answer
      character(:), allocatable :: text

      text = head_text(config)//answer_text(config, body, result, sentence)
   end function answer_listing

   !> The listing without its head.
   function answer_text(config, body, result, sentence) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the load case and its warnings
      character(*), intent(in) :: sentence !! the answer
      character(:), allocatable :: text

      text = warnings_text(result%warnings)//model_text(config, body, result%load_case)//loads_text(config)// &
         heading('Solution')//'  '//sentence//newline
   end function answer_text

   !> The summary, without its manifest.
   function answer_summary(config, body, result, sentence) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the warnings, and where the time went
      character(*), intent(in) :: sentence !! the answer
      character(:), allocatable :: text

      text = head_members(config, .false., result%warnings)//member('outcome', string('no_equilibrium'))// &
         member('message', string(sentence))//member('counts', '{'//size_counts(body)//'}')// &
         last_members(result%timings)
   end function answer_summary

end module amontons_answer_report
