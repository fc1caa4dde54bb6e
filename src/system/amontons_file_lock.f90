!> Locks that keep two runs from working on the same files. They end with the process at the latest.
module amontons_file_lock
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_system, only: error_text
   implicit none (type, external)
   private

   public :: file_lock_t, lock_directory, lock_file

   !> A lock, or none.
   type :: file_lock_t
      private
      integer(c_int), public :: file = -1 !! the system's number of the open file; -1 for none
   contains
      procedure, public :: release => file_lock_release
   end type file_lock_t

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      function c_lock_path(path, lock) bind(c, name='amontons_lock_path') result(code)
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_int), intent(inout) :: lock
         integer(c_int) :: code
      end function c_lock_path

      function c_lock_directory(path) bind(c, name='amontons_lock_directory') result(lock)
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_int) :: lock
      end function c_lock_directory

      function c_would_block() bind(c, name='amontons_would_block') result(code)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: code
      end function c_would_block

      subroutine c_unlock(lock) bind(c, name='amontons_unlock')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: lock
      end subroutine c_unlock
   end interface

contains

   !> Locks a file, which is made if it is not there; it must keep its name and never be replaced while it is locked.
   subroutine lock_file(lock, path, error)
      type(file_lock_t), intent(out) :: lock !! the lock
      character(*), intent(in) :: path !! name of the file
      type(error_t), allocatable, intent(out) :: error !! another run has it, or the file cannot be made
      integer(c_int) :: code

      code = c_lock_path(path//c_null_char, lock%file)
      if (code == c_would_block()) then
         call new_error(error, input_refused, path//': another run is writing this file; wait until it ends, or '// &
            'choose another directory with --output')
      else if (code /= 0) then
         call new_error(error, system_failure, path//': cannot write this file: '//error_text(int(code)))
      end if
   end subroutine lock_file

   !> Locks a directory for the short time that files in it change hands; goes without where that cannot be.
   subroutine lock_directory(lock, path)
      type(file_lock_t), intent(out) :: lock !! the lock
      character(*), intent(in) :: path !! name of the directory

      lock%file = c_lock_directory(path//c_null_char)
   end subroutine lock_directory

   !> Ends the lock.
   subroutine file_lock_release(self)
      class(file_lock_t), intent(inout) :: self !! the lock, none on return

      call c_unlock(self%file)
      self%file = -1
   end subroutine file_lock_release

end module amontons_file_lock
