!> What a directory holds.
module amontons_directory
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char, c_null_ptr, c_ptr
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_system, only: error_text
   implicit none (type, external)
   private

   public :: file_name_t, list_directory

   !> Name of a file.
   type :: file_name_t
      character(:), allocatable :: text !! the name
   end type file_name_t

   ! allow(assumed-size): C takes an address and knows no shape
   interface
      function c_list_directory(path, names, n_names, length) bind(c, name='amontons_list_directory') result(code)
         import :: c_char, c_int, c_long, c_ptr
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         type(c_ptr), intent(out) :: names
         integer(c_int), intent(out) :: n_names
         integer(c_long), intent(out) :: length
         integer(c_int) :: code
      end function c_list_directory

      subroutine c_take_names(names, text, length) bind(c, name='amontons_take_names')
         import :: c_char, c_long, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: names
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_long), value :: length
      end subroutine c_take_names
   end interface

contains

   !> The names of all that a directory holds, without their directory, in alphabetical order.
   subroutine list_directory(names, path, error)
      type(file_name_t), allocatable, intent(out) :: names(:) !! the names
      character(*), intent(in) :: path !! name of the directory
      type(error_t), allocatable, intent(out) :: error !! it cannot be read
      type(c_ptr) :: list
      character(:), allocatable :: text
      integer(c_long) :: length
      integer(c_int) :: n_names
      integer :: code, first, last, i

      list = c_null_ptr
      n_names = 0
      length = 0
      code = int(c_list_directory(path//c_null_char, list, n_names, length))
      if (code /= 0) then
         call new_error(error, input_refused, path//': cannot read this directory: '//error_text(code))
         return
      end if
      allocate (character(length) :: text)
      call c_take_names(list, text, length)
      allocate (names(n_names))
      first = 1
      do i = 1, n_names
         last = first + index(text(first:), c_null_char) - 2
         names(i)%text = text(first:last)
         first = last + 2
      end do
   end subroutine list_directory

end module amontons_directory
