!> The two grids of one case or step in a folder of many: mesh and contact line.
module amontons_grids
   use amontons_body, only: body_t
   use amontons_collection, only: collection_t
   use amontons_contact_vtu, only: write_contact_vtu
   use amontons_error, only: error_t
   use amontons_output_file, only: commit_files, output_file_t
   use amontons_result, only: result_t
   use amontons_vtu, only: write_vtu
   implicit none (type, external)
   private

   public :: write_grids

contains

   !> Writes the two grids of a case or step, and gives them their names.
   subroutine write_grids(collection, directory, folder, name, body, result, error)
      type(collection_t), intent(inout) :: collection !! its manifest gains them
      character(*), intent(in) :: directory !! output directory, a slash behind it
      character(*), intent(in) :: folder !! folder of the grids in it, a slash behind it
      character(*), intent(in) :: name !! name of the files without endings
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(2)

      call write_vtu(files(1), directory//folder//name//'.vtu', collection%units, body, result, error)
      if (.not. allocated(error)) call write_contact_vtu(files(2), directory//folder//name//'.contact.vtu', &
         collection%units, body, result, error)
      if (.not. allocated(error)) call collection%grids%add_outputs(files, folder, error)
      call commit_files(files, error)
   end subroutine write_grids

end module amontons_grids
