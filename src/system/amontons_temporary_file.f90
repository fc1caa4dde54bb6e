!> Temporary files that no signal leaves behind.
module amontons_temporary_file
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use amontons_directory, only: file_name_t, list_directory
   use amontons_error, only: error_t, new_error, system_failure
   use amontons_system, only: error_text, remove_file
   implicit none (type, external)
   private

   public :: create_temporary, forget_temporary, hold_signals, release_signals, remove_temporaries

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      !> From here to `release_signals` no signal ends the program: files change hands together. Pairs may be nested.
      subroutine hold_signals() bind(c, name='amontons_hold_signals')
         implicit none (type, external)
      end subroutine hold_signals

      !> Ends what `hold_signals` began; a signal that came meanwhile now ends the program.
      subroutine release_signals() bind(c, name='amontons_release_signals')
         implicit none (type, external)
      end subroutine release_signals

      function c_create_temporary(path, text, size) bind(c, name='amontons_create_temporary') result(code)
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_int), value :: size
         integer(c_int) :: code
      end function c_create_temporary

      subroutine c_forget_temporary(name) bind(c, name='amontons_forget_temporary')
         import :: c_char
         implicit none (type, external)
         character(c_char), intent(in) :: name(*)
      end subroutine c_forget_temporary
   end interface

contains

   !> Makes an empty file beside a final name. A signal that ends the program removes it, until it is forgotten.
   subroutine create_temporary(path, name, error)
      character(*), intent(in) :: path !! the final name
      character(:), allocatable, intent(out) :: name !! name of the file, not to be foreseen; not allocated on failure
      type(error_t), allocatable, intent(out) :: error !! the file cannot be made
      character(4096) :: buffer
      integer :: code

      code = int(c_create_temporary(path//c_null_char, buffer, len(buffer, c_int)))
      if (code == 0) then
         name = buffer(:index(buffer, c_null_char) - 1)
      else
         call new_error(error, system_failure, path//': cannot write this file: '//error_text(code))
      end if
   end subroutine create_temporary

   !> Leaves a file alone that has been renamed or removed.
   subroutine forget_temporary(name)
      character(*), intent(in) :: name !! name of the file

      call c_forget_temporary(name//c_null_char)
   end subroutine forget_temporary

   !> Removes the temporary grids that a run which was killed has left in its folder.
   subroutine remove_temporaries(folder)
      character(*), intent(in) :: folder !! the folder, a slash behind it; nobody else writes grids into it
      type(file_name_t), allocatable :: names(:)
      type(error_t), allocatable :: error
      integer :: i

      call list_directory(names, folder, error)
      if (allocated(error)) return
      do i = 1, size(names)
         if (is_temporary_grid(names(i)%text)) call remove_file(folder//names(i)%text)
      end do
   end subroutine remove_temporaries

   !> Whether a file has the name of a temporary grid: 12.vtu.0a1b2c3d.tmp or 12.contact.vtu.0a1b2c3d.tmp.
   pure logical function is_temporary_grid(name)
      character(*), intent(in) :: name !! name of the file
      integer, parameter :: n_behind = len('.0a1b2c3d.tmp')
      integer :: point, first

      point = index(name, '.')
      first = len(name) - n_behind + 1
      is_temporary_grid = .false.
      if (point < 2 .or. first <= point) return
      if (name(point:first - 1) /= '.vtu' .and. name(point:first - 1) /= '.contact.vtu') return
      is_temporary_grid = verify(name(:point - 1), '0123456789') == 0 .and. name(first:first) == '.' .and. &
         verify(name(first + 1:len(name) - 4), '0123456789abcdef') == 0 .and. name(len(name) - 3:) == '.tmp'
   end function is_temporary_grid

end module amontons_temporary_file
