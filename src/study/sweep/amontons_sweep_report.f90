!> The files of a sweep: all of them, each whole, or none.
module amontons_sweep_report
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_document, only: document_t
   use amontons_error, only: error_t
   use amontons_manifest, only: find_earlier_files, manifest_t, with_manifest
   use amontons_output_file, only: commit_files, hold_signals, output_file_t, release_signals, write_text_file
   use amontons_solve_sweep, only: sweep_result_t
   use amontons_sweep_listing, only: new_sweep_listing
   use amontons_sweep_summary, only: new_sweep_summary
   use amontons_system, only: file_name_t
   use amontons_terminal, only: phase_write
   implicit none (type, external)
   private

   public :: n_documents, sweep_documents, write_sweep_report

   !> Number of files that every sweep leaves, the table not counted.
   integer, parameter :: n_files = 3
   !> Number of those that are made of text and are not the summary.
   integer, parameter :: n_documents = 2

contains

   !> Writes NAME.lst, NAME.deck.nml and NAME.summary.json and gives NAME.sweep.csv and, where there are fields,
   !> NAME.sweep.pvd their names. Names change hands only after every file is complete; the checkpoint goes last.
   subroutine write_sweep_report(directory, config, body, result, error)
      character(*), intent(in) :: directory !! output directory
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(inout) :: result !! the result of all cases; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(n_files + merge(1, 0, allocated(result%collection)))
      type(file_name_t), allocatable :: earlier(:)
      type(output_file_t) :: table
      type(manifest_t) :: manifest
      character(:), allocatable :: stem

      if (allocated(result%collection)) files(n_files) = result%collection
      stem = directory//'/'//config%name
      call write_files(files, manifest, stem, config, body, result, error)
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, config%name, manifest)
      call hold_signals()
      call result%checkpoint%table_file(table, 1, stem//'.sweep.csv')
      if (.not. allocated(error)) call table%commit(error)
      call commit_files(files, error, earlier)
      if (.not. allocated(error)) call result%checkpoint%remove()
      call result%checkpoint%close()
      call release_signals()
   end subroutine write_sweep_report

   !> Makes the text files of a sweep, but for the table and the summary.
   subroutine sweep_documents(documents, config, body, result)
      type(document_t), intent(out) :: documents(n_documents) !! the files
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result of all cases

      call new_sweep_listing(documents(1), config, body, result)
      documents(2)%ending = '.deck.nml'
      call documents(2)%add(config%deck_text())
   end subroutine sweep_documents

   !> Writes all files under their temporary names; the summary last, since it tells the time of writing.
   subroutine write_files(files, manifest, stem, config, body, result, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, the summary last
      type(manifest_t), intent(out) :: manifest !! their manifest
      character(*), intent(in) :: stem !! directory and name of the case
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(document_t) :: documents(n_documents), summary
      integer :: i

      call sweep_documents(documents, config, body, result)
      do i = 1, size(documents)
         call write_text_file(files(i), stem//documents(i)%ending, documents(i)%text(), error)
         if (allocated(error)) return
      end do
      manifest = result%grids
      call manifest%add_outputs(files, '', error)
      if (allocated(error)) return
      associate (load_case => result%certified%load_case, table => result%checkpoint%checksum(1))
         call manifest%outputs%append_known(config%name//'.sweep.csv', table%n_bytes, table%value())
         call manifest%add_inputs(body%mesh, load_case%contacts, load_case%loads)
      end associate
      call result%certified%timings%begin(phase_write)
      call new_sweep_summary(summary, config, body, result)
      call write_text_file(files(size(files)), stem//summary%ending, with_manifest(summary%text(), manifest), error)
   end subroutine write_files

end module amontons_sweep_report
