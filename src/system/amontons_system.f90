!> What the program asks of the operating system: directories, renaming, memory, time.
module amontons_system
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_long_long, c_null_char, c_null_ptr, c_ptr
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: absolute_path, append_to_file, available_memory_mb, cut_file, error_text, file_name_t, list_directory, &
      make_directory, peak_memory_mb, remove_directory, remove_file, rename_file, resident_memory_mb, &
      return_large_arrays, return_memory, wall_seconds

   !> Name of a file.
   type :: file_name_t
      character(:), allocatable :: text !! the name
   end type file_name_t

   ! allow(assumed-size): C takes an address and knows no shape
   abstract interface
      !> Does something with a file or directory.
      function path_action(path) bind(c) result(code)
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*) !! its name, with a zero behind it
         integer(c_int) :: code
      end function path_action

      !> A size of memory.
      function memory() bind(c) result(kibibytes)
         import :: c_long_long
         implicit none (type, external)
         integer(c_long_long) :: kibibytes
      end function memory
   end interface

   procedure(path_action), bind(c, name='amontons_make_directory') :: c_make_directory
   procedure(path_action), bind(c, name='unlink') :: c_remove
   procedure(path_action), bind(c, name='rmdir') :: c_remove_directory
   procedure(memory), bind(c, name='amontons_peak_memory') :: c_peak_memory
   procedure(memory), bind(c, name='amontons_resident_memory') :: c_resident_memory
   procedure(memory), bind(c, name='amontons_available_memory') :: c_available_memory

   ! allow(assumed-size): see above
   interface
      subroutine c_absolute_path(path, text, size) bind(c, name='amontons_absolute_path')
         import :: c_char, c_int
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_int), value :: size
      end subroutine c_absolute_path

      function c_rename(directory, from, to) bind(c, name='amontons_rename') result(code)
         import :: c_char, c_int
         implicit none (type, external)
         integer(c_int), value :: directory
         character(c_char), intent(in) :: from(*), to(*)
         integer(c_int) :: code
      end function c_rename

      function c_truncate(path, n_bytes) bind(c, name='amontons_truncate') result(code)
         import :: c_char, c_int, c_long
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_long), value :: n_bytes
         integer(c_int) :: code
      end function c_truncate

      function c_append(path, is_new, bytes, n_bytes) bind(c, name='amontons_append') result(code)
         import :: c_char, c_int, c_long
         implicit none (type, external)
         character(c_char), intent(in) :: path(*), bytes(*)
         integer(c_int), value :: is_new
         integer(c_long), value :: n_bytes
         integer(c_int) :: code
      end function c_append

      subroutine c_error_text(code, text, size) bind(c, name='amontons_error_text')
         import :: c_char, c_int
         implicit none (type, external)
         integer(c_int), value :: code, size
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
      end subroutine c_error_text

      !> From now on large arrays go back to the system as soon as they are freed. For the program to call; the library
      !> leaves its user's memory alone.
      subroutine return_large_arrays() bind(c, name='amontons_return_large_arrays')
         implicit none (type, external)
      end subroutine return_large_arrays

      !> Gives memory that was freed back to the system.
      subroutine return_memory() bind(c, name='amontons_return_memory')
         implicit none (type, external)
      end subroutine return_memory

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

   !> Name of a file from the root on; the name as it is where there is no such file.
   function absolute_path(path) result(absolute)
      character(*), intent(in) :: path !! the name
      character(:), allocatable :: absolute
      character(4096) :: buffer

      call c_absolute_path(path//c_null_char, buffer, len(buffer, c_int))
      absolute = buffer(:index(buffer, c_null_char) - 1)
   end function absolute_path

   !> Makes a directory and its parents; one that exists already is fine.
   subroutine make_directory(path, error)
      character(*), intent(in) :: path !! name of the directory
      type(error_t), allocatable, intent(out) :: error !! the directory cannot be made
      character(:), allocatable :: c_path
      integer :: code

      c_path = path//c_null_char
      code = int(c_make_directory(c_path))
      if (code /= 0) call new_error(error, system_failure, &
         path//': cannot make this directory: '//error_text(code))
   end subroutine make_directory

   !> Puts a file in the place of another, in one step: a reader sees the old one or the new one.
   subroutine rename_file(from, to, error, directory)
      character(*), intent(in) :: from !! the file's present name
      character(*), intent(in) :: to !! the file's new name; what had it before is replaced
      type(error_t), allocatable, intent(out) :: error !! the file cannot be renamed
      integer(c_int), intent(in), optional :: directory
         !! the system's number of the directory of both where that is open, which may itself get another name; else -1
      integer(c_int) :: open_directory
      integer :: code

      open_directory = -1
      if (present(directory)) open_directory = directory
      code = int(c_rename(open_directory, from//c_null_char, to//c_null_char))
      if (code /= 0) call new_error(error, system_failure, to//': cannot put this file in place: '//error_text(code))
   end subroutine rename_file

   !> The system's words for an error number.
   function error_text(code) result(text)
      integer, intent(in) :: code !! the number
      character(:), allocatable :: text
      character(256) :: buffer

      call c_error_text(int(code, c_int), buffer, len(buffer, c_int))
      text = buffer(:index(buffer, c_null_char) - 1)
   end function error_text

   !> Removes a file if it is there.
   subroutine remove_file(path)
      character(*), intent(in) :: path !! name of the file
      integer :: code

      code = int(c_remove(path//c_null_char))
      if (code /= 0) return
   end subroutine remove_file

   !> Removes a directory if it holds nothing.
   subroutine remove_directory(path)
      character(*), intent(in) :: path !! name of the directory
      integer :: code

      code = int(c_remove_directory(path//c_null_char))
      if (code /= 0) return
   end subroutine remove_directory

   !> Cuts a file behind a number of bytes.
   subroutine cut_file(path, n_bytes, error)
      character(*), intent(in) :: path !! name of the file
      integer(int64), intent(in) :: n_bytes !! how many of its bytes stay
      type(error_t), allocatable, intent(out) :: error !! the file cannot be cut
      integer :: code

      code = int(c_truncate(path//c_null_char, int(n_bytes, c_long)))
      if (code /= 0) call new_error(error, system_failure, path//': cannot cut this file: '//error_text(code))
   end subroutine cut_file

   !> Writes bytes to the end of a file, or to a new one. On return they are on the disk, so that not even a power
   !> failure loses them.
   subroutine append_to_file(path, is_new, bytes, error)
      character(*), intent(in) :: path !! name of the file, which is no link
      logical, intent(in) :: is_new !! whether the file is made; nothing may have its name
      character(*), intent(in) :: bytes !! the bytes
      type(error_t), allocatable, intent(out) :: error !! not all of them could be written
      integer :: code

      code = int(c_append(path//c_null_char, merge(1_c_int, 0_c_int, is_new), bytes, len(bytes, c_long)))
      if (code /= 0) call new_error(error, system_failure, path//': cannot write this file: '//error_text(code))
   end subroutine append_to_file

   !> The most memory this process ever held [MB].
   real(dp) function peak_memory_mb()
      peak_memory_mb = real(c_peak_memory(), dp)*1024.0e-6_dp
   end function peak_memory_mb

   !> The memory this process holds now, 0 where the system does not tell [MB].
   real(dp) function resident_memory_mb()
      resident_memory_mb = real(c_resident_memory(), dp)*1024.0e-6_dp
   end function resident_memory_mb

   !> The memory this process can still get, a huge number where the system does not tell [MB].
   real(dp) function available_memory_mb()
      integer(c_long_long) :: kibibytes

      kibibytes = c_available_memory()
      available_memory_mb = merge(huge(1.0_dp), real(kibibytes, dp)*1024.0e-6_dp, kibibytes < 0)
   end function available_memory_mb

   !> Wall-clock time since some fixed moment [s].
   real(dp) function wall_seconds()
      integer(int64) :: ticks, rate

      call system_clock(ticks, rate)
      wall_seconds = real(ticks, dp)/real(rate, dp)
   end function wall_seconds

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

end module amontons_system
