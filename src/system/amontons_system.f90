!> Services of the operating system: directories, renaming, memory, time; and checksums of files and texts, which detect
!> accidental changes: the number that `cksum` of POSIX prints, a cyclic redundancy check of 32 bits over the bytes and
!> their number. A checksum can be read after any addition.
module amontons_system
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int32_t, c_int64_t, c_long, c_long_long, c_null_char, &
      c_null_ptr, c_ptr
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: absolute_path, action, append_to_file, available_memory_mb, check_code, checksum_t, close_file, cut_file, &
      error_text, file_checksum, file_name_t, list_directory, make_directory, number_action, path_action, &
      peak_memory_mb, remove_directory, remove_file, rename_file, resident_memory_mb, return_large_arrays, &
      return_memory, text_checksum, wall_seconds

   !> Name of a file.
   type :: file_name_t
      character(:), allocatable :: text !! the name
   end type file_name_t

   ! allow(assumed-size): C takes an address without a shape
   abstract interface
      !> An action without arguments.
      subroutine action() bind(c)
         implicit none (type, external)
      end subroutine action

      !> An action with a whole number.
      subroutine number_action(number) bind(c)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value, intent(in) :: number !! the number
      end subroutine number_action

      !> An action on a file or directory.
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
   !> Closes an open file by the system's number of it; a negative one stands for none.
   procedure(number_action), bind(c, name='amontons_close_file') :: close_file
   procedure(memory), bind(c, name='amontons_peak_memory') :: c_peak_memory
   procedure(memory), bind(c, name='amontons_resident_memory') :: c_resident_memory
   procedure(memory), bind(c, name='amontons_available_memory') :: c_available_memory
   !> Makes the allocator return large arrays to the system as soon as they are deallocated. To be called by the
   !> program; the library does not change the memory management of its user.
   procedure(action), bind(c, name='amontons_return_large_arrays') :: return_large_arrays
   !> Returns freed memory to the system.
   procedure(action), bind(c, name='amontons_return_memory') :: return_memory

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

   !> The checksum of some bytes, and their number; more bytes can be added.
   type :: checksum_t
      private
      integer(c_int32_t) :: remainder = 0_c_int32_t !! remainder of the bytes' polynomial, 32 bits without sign
      integer(c_int64_t), public :: n_bytes = 0_c_int64_t !! number of bytes
   contains
      generic, public :: add => add_text, add_numbers
      procedure :: add_numbers => checksum_add_numbers
      procedure :: add_text => checksum_add_text
      procedure, public :: value => checksum_value
   end type checksum_t

   ! allow(assumed-size): C takes an address without a shape
   interface
      pure subroutine c_add_to_checksum(remainder, bytes, n_bytes) bind(c, name='amontons_add_to_checksum')
         import :: c_char, c_int32_t, c_int64_t
         implicit none (type, external)
         integer(c_int32_t), intent(inout) :: remainder
         character(c_char), intent(in) :: bytes(*)
         integer(c_int64_t), value :: n_bytes
      end subroutine c_add_to_checksum

      pure function c_checksum_value(remainder, n_bytes) bind(c, name='amontons_checksum_value') result(value)
         import :: c_int32_t, c_int64_t
         implicit none (type, external)
         integer(c_int32_t), value :: remainder
         integer(c_int64_t), value :: n_bytes
         integer(c_int64_t) :: value
      end function c_checksum_value

      function c_checksum_of_file(path, most, remainder, n_bytes) bind(c, name='amontons_checksum_of_file') &
         result(code)
         import :: c_char, c_int, c_int32_t, c_int64_t
         implicit none (type, external)
         character(c_char), intent(in) :: path(*)
         integer(c_int64_t), value :: most
         integer(c_int32_t), intent(inout) :: remainder
         integer(c_int64_t), intent(inout) :: n_bytes
         integer(c_int) :: code
      end function c_checksum_of_file
   end interface

contains

   !> Absolute path of a file; the name itself if there is no such file.
   function absolute_path(path) result(absolute)
      character(*), intent(in) :: path !! the name
      character(:), allocatable :: absolute
      character(4096) :: buffer

      call c_absolute_path(path//c_null_char, buffer, len(buffer, c_int))
      absolute = buffer(:index(buffer, c_null_char) - 1)
   end function absolute_path

   !> Makes a directory and its parents, unless they exist.
   subroutine make_directory(path, error)
      character(*), intent(in) :: path !! name of the directory
      type(error_t), allocatable, intent(out) :: error !! the directory cannot be made

      call check_code(c_make_directory(path//c_null_char), path//': cannot make this directory', error)
   end subroutine make_directory

   !> Replaces a file by another, atomically: a reader sees the old one or the new one.
   subroutine rename_file(from, to, error, directory)
      character(*), intent(in) :: from !! the file's present name
      character(*), intent(in) :: to !! the file's new name; what had it before is replaced
      type(error_t), allocatable, intent(out) :: error !! the file cannot be renamed
      integer(c_int), intent(in), optional :: directory
         !! the system's number of the directory of both where that is open, which may itself get another name; else -1
      integer(c_int) :: open_directory

      open_directory = -1
      if (present(directory)) open_directory = directory
      call check_code(c_rename(open_directory, from//c_null_char, to//c_null_char), &
         to//': cannot put this file in place', error)
   end subroutine rename_file

   !> Makes an error of an error number of the system.
   subroutine check_code(code, sentence, error)
      integer(c_int), intent(in) :: code !! the number; 0 without an error
      character(*), intent(in) :: sentence !! what failed
      type(error_t), allocatable, intent(out) :: error !! the number is not 0

      if (code /= 0) call new_error(error, system_failure, sentence//': '//error_text(int(code)))
   end subroutine check_code

   !> The system's message for an error number.
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
      ! One that cannot be removed stays: no result depends on it.
      if (code /= 0) return
   end subroutine remove_file

   !> Removes a directory if it is empty.
   subroutine remove_directory(path)
      character(*), intent(in) :: path !! name of the directory
      integer :: code

      code = int(c_remove_directory(path//c_null_char))
      ! One that cannot be removed stays: no result depends on it.
      if (code /= 0) return
   end subroutine remove_directory

   !> Truncates a file to a number of bytes.
   subroutine cut_file(path, n_bytes, error)
      character(*), intent(in) :: path !! name of the file
      integer(int64), intent(in) :: n_bytes !! number of bytes to be kept
      type(error_t), allocatable, intent(out) :: error !! the file cannot be cut

      call check_code(c_truncate(path//c_null_char, int(n_bytes, c_long)), path//': cannot cut this file', error)
   end subroutine cut_file

   !> Appends bytes to a file, or writes a new one. On return they are on the disk, so that they survive a power
   !> failure.
   subroutine append_to_file(path, is_new, bytes, error)
      character(*), intent(in) :: path !! name of the file, which is no link
      logical, intent(in) :: is_new !! whether the file is made; nothing may have its name
      character(*), intent(in) :: bytes !! the bytes
      type(error_t), allocatable, intent(out) :: error !! not all of them could be written

      call check_code(c_append(path//c_null_char, merge(1_c_int, 0_c_int, is_new), bytes, len(bytes, c_long)), &
         path//': cannot write this file', error)
   end subroutine append_to_file

   !> The largest memory of this process so far [MB].
   real(dp) function peak_memory_mb()
      peak_memory_mb = real(c_peak_memory(), dp)*1024.0e-6_dp
   end function peak_memory_mb

   !> The present memory of this process, 0 if the system does not report it [MB].
   real(dp) function resident_memory_mb()
      resident_memory_mb = real(c_resident_memory(), dp)*1024.0e-6_dp
   end function resident_memory_mb

   !> The memory that this process can still get, huge if the system does not report it [MB].
   real(dp) function available_memory_mb()
      integer(c_long_long) :: kibibytes

      kibibytes = c_available_memory()
      available_memory_mb = merge(huge(1.0_dp), real(kibibytes, dp)*1024.0e-6_dp, kibibytes < 0)
   end function available_memory_mb

   !> Wall-clock time since an arbitrary fixed moment [s].
   real(dp) function wall_seconds()
      integer(int64) :: ticks, rate

      call system_clock(ticks, rate)
      wall_seconds = real(ticks, dp)/real(rate, dp)
   end function wall_seconds

   !> The names in a directory, without its path, in alphabetical order.
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

   !> Adds a text.
   pure subroutine checksum_add_text(self, text)
      class(checksum_t), intent(inout) :: self !! the checksum of the bytes before it
      character(*), intent(in) :: text !! the text

      call c_add_to_checksum(self%remainder, text, len(text, c_int64_t))
      self%n_bytes = self%n_bytes + len(text, c_int64_t)
   end subroutine checksum_add_text

   !> Adds the bytes of some numbers.
   pure subroutine checksum_add_numbers(self, numbers)
      class(checksum_t), intent(inout) :: self !! the checksum of the bytes before them
      real(dp), intent(in) :: numbers(:) !! the numbers

      call self%add_text(transfer(numbers, repeat(' ', size(numbers)*storage_size(numbers)/8)))
   end subroutine checksum_add_numbers

   !> The checksum, from 0 to 2**32 - 1.
   pure function checksum_value(self) result(value)
      class(checksum_t), intent(in) :: self !! the checksum
      integer(int64) :: value

      value = c_checksum_value(self%remainder, self%n_bytes)
   end function checksum_value

   !> The checksum of a text.
   pure function text_checksum(text) result(value)
      character(*), intent(in) :: text !! the text
      integer(int64) :: value
      type(checksum_t) :: checksum

      call checksum%add(text)
      value = checksum%value()
   end function text_checksum

   !> The checksum of a file, or of its first bytes.
   subroutine file_checksum(checksum, path, error, most_bytes)
      type(checksum_t), intent(out) :: checksum !! the checksum of as many bytes as there are
      character(*), intent(in) :: path !! name of the file
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read
      integer(int64), intent(in), optional :: most_bytes !! largest number of bytes; by default those of the whole file
      integer(c_int64_t) :: most

      most = huge(most)
      if (present(most_bytes)) most = most_bytes
      call check_code(c_checksum_of_file(path//c_null_char, most, checksum%remainder, checksum%n_bytes), &
         path//': cannot read this file', error)
   end subroutine file_checksum

end module amontons_system
