!> The seal of a summary: sizes and checksums of the files that were written with it and of those that were read, and,
!> as its last member, the checksum of the summary itself. `--verify` finds by it what was changed, even where no number
!> follows from the others.
module amontons_seal
   use amontons_checksum, only: checksum_length, checksum_t, file_checksum, text_checksum
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_fclib_file, only: has_fclib
   use amontons_json, only: string
   use amontons_kinds, only: int64
   use amontons_output_file, only: output_file_t
   use amontons_text, only: newline, to_text
   implicit none (type, external)
   private

   public :: read_seal, seal_t, sealed_file_t, sealed_text

   !> What stands before the checksum of the summary, and behind it.
   character(*), parameter :: before_checksum = '  "checksum": "', behind_checksum = '"'//newline//'}'//newline

   !> What is known of a file.
   type :: sealed_file_t
      character(:), allocatable :: name !! its name: seen from the output directory if written, as it was read otherwise
      integer(int64) :: n_bytes = 0_int64 !! its size
      character(checksum_length) :: checksum = '' !! its checksum
   end type sealed_file_t

   !> The files of a case.
   type :: seal_t
      type(sealed_file_t), allocatable :: files(:) !! those written
      type(sealed_file_t), allocatable :: inputs(:) !! those read: mesh, tables, reduced problem
   contains
      procedure :: add_inputs => seal_add_inputs
      procedure :: add_outputs => seal_add_outputs
      procedure :: add_reduced => seal_add_reduced
      procedure :: add_written => seal_add_written
   end type seal_t

contains

   !> Adds the files that are finished, under the names that they will have.
   subroutine seal_add_outputs(self, files, folder, error)
      class(seal_t), intent(inout) :: self !! the seal
      type(output_file_t), intent(in) :: files(:) !! the files; those not yet begun are passed over
      character(*), intent(in) :: folder !! where in the output directory they are: '', or with a slash behind it
      type(error_t), allocatable, intent(out) :: error !! one cannot be read
      integer :: i

      if (.not. allocated(self%files)) allocate (self%files(0))
      do i = 1, size(files)
         if (.not. allocated(files(i)%temporary_path)) cycle
         call self%add_written(files(i)%temporary_path, files(i)%path, folder, error)
         if (allocated(error)) return
      end do
   end subroutine seal_add_outputs

   !> Adds a file that was written.
   subroutine seal_add_written(self, path, final_path, folder, error)
      class(seal_t), intent(inout) :: self !! the seal
      character(*), intent(in) :: path !! its present name
      character(*), intent(in) :: final_path !! the name that it will have
      character(*), intent(in) :: folder !! where in the output directory it is: '', or with a slash behind it
      type(error_t), allocatable, intent(out) :: error !! it cannot be read

      if (.not. allocated(self%files)) allocate (self%files(0))
      call append_file(self%files, path, folder//final_path(index(final_path, '/', back=.true.) + 1:), error)
      if (.not. allocated(error)) return
      ! Nobody knows the temporary name.
      error%message = final_path//': cannot write this file'//error%message(index(error%message, ': ', back=.true.):)
   end subroutine seal_add_written

   !> Adds the files of a reduced problem, which are written before the others.
   subroutine seal_add_reduced(self, stem, error)
      class(seal_t), intent(inout) :: self !! the seal
      character(*), intent(in) :: stem !! directory and name of the case
      type(error_t), allocatable, intent(out) :: error !! one cannot be read

      call self%add_written(stem//'.reduced.dat', stem//'.reduced.dat', '', error)
      if (has_fclib .and. .not. allocated(error)) call self%add_written(stem//'.reduced.hdf5', &
         stem//'.reduced.hdf5', '', error)
   end subroutine seal_add_reduced

   !> Adds the files that a case was read from; the effective deck holds what its deck said. A file that cannot be read
   !> again, a pipe or one that is gone, is left out: the results are worth keeping.
   subroutine seal_add_inputs(self, config)
      class(seal_t), intent(inout) :: self !! the seal
      type(config_t), intent(in) :: config !! the case
      integer :: i

      allocate (self%inputs(0))
      if (config%reduced%is_given) then
         call add(config%reduced%path)
         return
      end if
      call add(config%mesh_file)
      do i = 1, size(config%contacts)
         associate (contact => config%contacts(i))
            if (allocated(contact%friction%file)) call add(contact%friction%file)
            if (allocated(contact%slip_bound%file)) call add(contact%slip_bound%file)
            if (allocated(contact%obstacle%file)) call add(contact%obstacle%file)
         end associate
      end do

   contains

      !> Adds one of them, if there is one.
      subroutine add(path)
         character(*), intent(in) :: path !! its name; empty for none
         type(error_t), allocatable :: unreadable

         if (len(path) > 0) call append_file(self%inputs, path, path, unreadable)
      end subroutine add

   end subroutine seal_add_inputs

   !> Appends a file to a list.
   subroutine append_file(list, path, name, error)
      type(sealed_file_t), allocatable, intent(inout) :: list(:) !! the list
      character(*), intent(in) :: path !! where the file is now
      character(*), intent(in) :: name !! the name in the list
      type(error_t), allocatable, intent(out) :: error !! it cannot be read
      type(sealed_file_t) :: file
      type(checksum_t) :: checksum

      call file_checksum(checksum, path, error)
      if (allocated(error)) return
      file%name = name
      file%n_bytes = checksum%n_bytes
      file%checksum = checksum%digits()
      call append(list, file)
   end subroutine append_file

   !> Appends to a list.
   pure subroutine append(list, file)
      type(sealed_file_t), allocatable, intent(inout) :: list(:) !! the list
      type(sealed_file_t), intent(in) :: file !! what to append
      type(sealed_file_t), allocatable :: longer(:)
      integer :: i

      ! gfortran 12 loses the length of a text that a structure constructor puts into an array constructor.
      allocate (longer(size(list) + 1))
      do i = 1, size(list)
         longer(i)%n_bytes = list(i)%n_bytes
         longer(i)%checksum = list(i)%checksum
         call move_alloc(list(i)%name, longer(i)%name)
      end do
      longer(size(longer)) = file
      call move_alloc(longer, list)
   end subroutine append

   !> A summary with its seal, lines with their ends.
   function sealed_text(text, seal) result(sealed)
      character(*), intent(in) :: text !! the summary, an object with a member on its last line but one
      type(seal_t), intent(in) :: seal !! the seal
      character(:), allocatable :: sealed

      sealed = text(:index(text, newline//'}', back=.true.) - 1)//','//newline// &
         '  "files": ['//list_text(seal%files)//'],'//newline// &
         '  "inputs": ['//list_text(seal%inputs)//'],'//newline
      sealed = sealed//before_checksum//text_checksum(sealed)//behind_checksum
   end function sealed_text

   !> A list of files as elements of a JSON array.
   pure function list_text(list) result(text)
      type(sealed_file_t), intent(in) :: list(:) !! the files
      character(:), allocatable :: text
      character(:), allocatable :: line, longer
      integer :: i, n

      allocate (character(0) :: text)
      n = 0
      do i = 1, size(list)
         line = newline//'    {"name": '//string(list(i)%name)//', "bytes": '//to_text(list(i)%n_bytes)// &
            ', "checksum": "'//list(i)%checksum//'"},'
         ! A sweep may have many thousand files: the text grows by doubling.
         if (n + len(line) > len(text)) then
            allocate (character(2*(n + len(line))) :: longer)
            longer(:n) = text(:n)
            call move_alloc(longer, text)
         end if
         text(n + 1:n + len(line)) = line
         n = n + len(line)
      end do
      ! There is no comma behind the last one.
      text = text(:max(0, n - 1))
   end function list_text

   !> Checks the seal of a summary and reads it.
   subroutine read_seal(seal, text, fault)
      type(seal_t), intent(out) :: seal !! the seal
      character(*), intent(in) :: text !! the summary, all of its bytes
      character(:), allocatable, intent(out) :: fault !! why it is not what was written; empty if it is
      integer :: last

      allocate (seal%files(0), seal%inputs(0))
      last = index(text, before_checksum, back=.true.) - 1
      if (last < 0) then
         fault = 'it carries no checksum of its own: it is cut short, or of an earlier version of the program'
      else if (len(text) /= last + len(before_checksum) + checksum_length + len(behind_checksum)) then
         fault = 'it does not end as it was written'
      else if (text(last + 1:) /= before_checksum//text_checksum(text(:last))//behind_checksum) then
         fault = 'it was changed: its own checksum is '//text_checksum(text(:last))
      else
         fault = ''
         call read_list(seal%files, text, '  "files": [')
         call read_list(seal%inputs, text, '  "inputs": [')
      end if
   end subroutine read_seal

   !> Reads a list of files, one on a line, from a summary that is as it was written.
   pure subroutine read_list(list, text, head)
      type(sealed_file_t), allocatable, intent(inout) :: list(:) !! the list
      character(*), intent(in) :: text !! the summary
      character(*), intent(in) :: head !! the line before the list
      character(*), parameter :: before_name = '    {"name": "', before_bytes = '", "bytes": ', &
         before_digits = ', "checksum": "'
      type(sealed_file_t) :: file
      integer :: first, at_bytes, at_digits, status

      first = index(text, newline//head//newline)
      if (first == 0) return
      first = first + len(newline//head//newline)
      do
         associate (line => text(first:first + index(text(first:), newline) - 2))
            at_bytes = index(line, before_bytes, back=.true.)
            at_digits = index(line, before_digits, back=.true.)
            if (index(line, before_name) /= 1 .or. at_bytes == 0 .or. at_digits < at_bytes) return
            file%name = unescaped(line(len(before_name) + 1:at_bytes - 1))
            read (line(at_bytes + len(before_bytes):at_digits - 1), *, iostat=status) file%n_bytes
            file%checksum = line(at_digits + len(before_digits):)
            if (status == 0) call append(list, file)
            first = first + len(line) + 1
         end associate
      end do
   end subroutine read_list

   !> What a JSON string stands for, of those that `string` makes.
   pure function unescaped(literal) result(text)
      character(*), intent(in) :: literal !! the string, without the quotes around it
      character(:), allocatable :: text
      integer :: i

      text = ''
      i = 1
      do while (i <= len(literal))
         if (literal(i:i) == '\' .and. i < len(literal)) then
            i = i + 1
            text = text//merge(achar(9), literal(i:i), literal(i:i) == 't')
         else
            text = text//literal(i:i)
         end if
         i = i + 1
      end do
   end function unescaped

end module amontons_seal
