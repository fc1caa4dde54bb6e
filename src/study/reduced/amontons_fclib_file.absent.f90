!> FCLIB's HDF5 files in a build without the HDF5 library: they are refused, and none is written.
module amontons_fclib_file
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_output_file, only: output_file_t
   use amontons_reduced_system, only: reduced_system_t
   implicit none (type, external)
   private

   public :: has_fclib, read_fclib_file, write_fclib_file

   !> Whether this build reads and writes FCLIB files.
   logical, parameter :: has_fclib = .false.
   !> Why such a file is refused.
   character(*), parameter :: reason = ': this program was built without the HDF5 library, which FCLIB files need; '// &
      'build it with libhdf5-dev installed'

contains

   !> Refuses to read a file.
   pure subroutine read_fclib_file(system, name, error)
      type(reduced_system_t), intent(out) :: system !! without contacts
      character(*), intent(in) :: name !! name of the file
      type(error_t), allocatable, intent(out) :: error !! the reason

      system%n_contacts = 0
      call new_error(error, input_refused, name//reason)
   end subroutine read_fclib_file

   !> Refuses to write a file.
   subroutine write_fclib_file(file, path, system, title, error)
      type(output_file_t), intent(out) :: file !! no file
      character(*), intent(in) :: path !! name of the file
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      character(*), intent(in) :: title !! name of the case, for the file's information
      type(error_t), allocatable, intent(out) :: error !! the reason

      if (system%n_contacts >= 0) call new_error(error, input_refused, title//path//reason)
      if (allocated(error)) call file%discard()
   end subroutine write_fclib_file

end module amontons_fclib_file
