!> Files of reduced problems: the text of Siconos. FCLIB's HDF5 files are converted to it first, outside this program.
module amontons_reduced_file
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_input_file, only: input_file_t, new_input_file
   use amontons_output_file, only: commit_files, output_file_t
   use amontons_reduced_system, only: reduced_system_t
   use amontons_siconos_text, only: read_siconos_text, write_siconos_text
   use amontons_system, only: make_directory
   implicit none (type, external)
   private

   public :: read_reduced_file, write_reduced_file

   !> The first bytes of every HDF5 file.
   character(*), parameter :: hdf5_signature = char(137)//'HDF'//achar(13)//achar(10)//achar(26)//achar(10)

contains

   !> Reads a reduced problem.
   subroutine read_reduced_file(system, file, error)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file, and where
      type(input_file_t) :: input

      call new_input_file(input, file, error)
      if (allocated(error)) return
      if (index(input%text, hdf5_signature) == 1) then
         call new_error(error, input_refused, file//': this is an HDF5 file; convert it from FCLIB to text first: '// &
            'python -m amontons fclib '//file//' problem.dat')
      else
         call read_siconos_text(system, input)
         call move_alloc(input%error, error)
      end if
   end subroutine read_reduced_file

   !> Writes NAME.reduced.dat.
   subroutine write_reduced_file(directory, name, system, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      character(*), intent(in) :: name !! name of the case
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      type(output_file_t) :: files(1)

      call make_directory(directory, error)
      if (allocated(error)) return
      call write_siconos_text(files(1), directory//'/'//name//'.reduced.dat', system, error)
      call commit_files(files, error)
   end subroutine write_reduced_file

end module amontons_reduced_file
