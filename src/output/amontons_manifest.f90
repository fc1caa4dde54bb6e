!> The manifest of a summary: sizes and checksums of the files that were written with it and of those that were read,
!> and, as its last member, the checksum of the summary itself. With it `--verify` finds accidental changes, also of
!> numbers that do not follow from others. `cksum FILE` prints the same numbers.
!>
!> Files that an earlier run of a case left in its directory and that the new one does not write again (grids of other
!> cases of a sweep or steps of a history, all solutions, a reduced problem) are removed, so that the files of a case
!> are those of one run. These files are named by the manifest of the earlier run. Other files with the name of the case
!> are kept, as are files that have changed since, or that the new run has read.
!>
!> Collections for ParaView list the grids of several cases as time steps. A case is a step of the collection, its time
!> is the number of the case, or the pseudo-time of a history; body and contact line are parts of the step.
module amontons_manifest
   use amontons_contact_set, only: contact_t
   use amontons_document, only: json_string
   use amontons_error, only: error_t, fault_list_t
   use amontons_input_file, only: read_text_file
   use amontons_kinds, only: dp, int64
   use amontons_loads, only: load_t
   use amontons_mesh, only: mesh_t
   use amontons_output_file, only: output_file_t
   use amontons_system, only: absolute_path, checksum_t, file_checksum, file_name_t, text_checksum
   use amontons_text, only: append_text, newline, replaced, to_text, xml_escaped
   implicit none (type, external)
   private

   public :: case_entries, collection_head, collection_tail, find_earlier_files, manifest_t, &
      read_manifest, read_summary, with_manifest

   !> Text before and after the checksum of the summary.
   character(*), parameter :: before_checksum = '  "checksum": ', behind_checksum = newline//'}'//newline

   !> Text before the number of files that were read and are in no list.
   character(*), parameter :: unlisted = '  "unlisted_inputs": '

   !> Name, size and checksum of a file.
   type :: manifest_file_t
      character(:), allocatable :: name !! its name: seen from the output directory if written, as it was read otherwise
      integer(int64) :: n_bytes = 0_int64 !! its size
      integer(int64) :: checksum = 0_int64 !! its checksum
   contains
      procedure :: fault => manifest_file_fault
   end type manifest_file_t

   !> A list of files.
   type :: manifest_list_t
      type(manifest_file_t), allocatable :: files(:) !! the files, and room for more
      integer :: n = 0 !! number of files
   contains
      procedure :: append => manifest_list_append
      procedure :: append_known => manifest_list_append_known
      procedure :: check => manifest_list_check
   end type manifest_list_t

   !> The files of a case.
   type :: manifest_t
      type(manifest_list_t) :: outputs !! those written
      type(manifest_list_t) :: inputs !! those read: mesh, tables, reduced problem
      integer :: n_unlisted = 0 !! number of files read that cannot be read again, such as pipes
   contains
      procedure :: add_case => manifest_add_case
      procedure :: add_input => manifest_add_input
      procedure :: add_inputs => manifest_add_inputs
      procedure :: add_outputs => manifest_add_outputs
      procedure :: add_written => manifest_add_written
      procedure :: fingerprint => manifest_fingerprint
   end type manifest_t

   !> The lines of a collection before its cases.
   character(*), parameter :: collection_head = '<?xml version="1.0"?>'//newline// &
      '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">'//newline//'  <Collection>'//newline
   !> The lines of a collection after its cases.
   character(*), parameter :: collection_tail = '  </Collection>'//newline//'</VTKFile>'//newline

contains

   !> Adds finished files, under their final names.
   subroutine manifest_add_outputs(self, files, folder, error)
      class(manifest_t), intent(inout) :: self !! the manifest
      type(output_file_t), intent(in) :: files(:) !! the files; those not yet begun are passed over
      character(*), intent(in) :: folder !! where in the output directory they are: '', or with a slash behind it
      type(error_t), allocatable, intent(out) :: error !! one cannot be read
      integer :: i

      do i = 1, size(files)
         if (.not. allocated(files(i)%temporary_path)) cycle
         call self%add_written(files(i)%temporary_path, files(i)%path, folder, error)
         if (allocated(error)) return
      end do
   end subroutine manifest_add_outputs

   !> Adds a file of this run to the manifest, with its size and checksum.
   subroutine manifest_add_written(self, path, final_path, folder, error)
      class(manifest_t), intent(inout) :: self !! the manifest
      character(*), intent(in) :: path !! its present name
      character(*), intent(in) :: final_path !! the name that it will have
      character(*), intent(in) :: folder !! where in the output directory it is: '', or with a slash behind it
      type(error_t), allocatable, intent(out) :: error !! it cannot be read

      call self%outputs%append(path, folder//final_path(index(final_path, '/', back=.true.) + 1:), error)
      if (.not. allocated(error)) return
      ! Users do not know the temporary name.
      error%message = final_path//': cannot write this file'//error%message(index(error%message, ': ', back=.true.):)
   end subroutine manifest_add_written

   !> Adds the finished files of a case, and that of its reduced problem, which is written before them.
   subroutine manifest_add_case(self, files, stem, has_reduced, error)
      class(manifest_t), intent(inout) :: self !! the manifest
      type(output_file_t), intent(in) :: files(:) !! the files; those not yet begun are passed over
      character(*), intent(in) :: stem !! directory and name of the case
      logical, intent(in) :: has_reduced !! whether the reduced problem was written
      type(error_t), allocatable, intent(inout) :: error !! why they are not finished; or one cannot be read

      if (.not. allocated(error)) call self%add_outputs(files, '', error)
      if (has_reduced .and. .not. allocated(error)) call self%add_written(stem//'.reduced.dat', stem//'.reduced.dat', &
         '', error)
   end subroutine manifest_add_case

   !> Adds the files that were read for a body; the deck itself is not among them, since the effective deck holds its
   !> contents.
   subroutine manifest_add_inputs(self, mesh, contacts, loads)
      class(manifest_t), intent(inout) :: self !! the manifest
      type(mesh_t), intent(in) :: mesh !! the mesh of the body
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      type(load_t), intent(in) :: loads(:) !! the loads
      integer :: i

      do i = 1, mesh%files%n()
         call self%add_input(mesh%files%item(i))
      end do
      do i = 1, size(contacts)
         if (allocated(contacts(i)%friction%file)) call self%add_input(contacts(i)%friction%file)
         if (allocated(contacts(i)%slip_bound%file)) call self%add_input(contacts(i)%slip_bound%file)
         if (allocated(contacts(i)%extra_gap%file)) call self%add_input(contacts(i)%extra_gap%file)
         if (allocated(contacts(i)%obstacle%file)) call self%add_input(contacts(i)%obstacle%file)
      end do
      do i = 1, size(loads)
         if (allocated(loads(i)%temperature_file)) call self%add_input(loads(i)%temperature_file)
      end do
   end subroutine manifest_add_inputs

   !> A text that is equal for two runs of a deck only if the files agree that it names: they may have changed although
   !> the deck has not. What a pipe had is known by the mesh alone.
   function manifest_fingerprint(self, mesh, contacts, loads) result(text)
      class(manifest_t), intent(in) :: self !! files that were read, but for those of the body
      type(mesh_t), intent(in) :: mesh !! the mesh of the body
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      type(load_t), intent(in) :: loads(:) !! the loads
      character(:), allocatable :: text
      type(manifest_t) :: manifest
      type(checksum_t) :: checksum
      integer :: i

      manifest%inputs = self%inputs
      call manifest%add_inputs(mesh, contacts, loads)
      call checksum%add([mesh%coordinates, real(mesh%node, dp)])
      do i = 1, manifest%inputs%n
         call checksum%add(to_text(manifest%inputs%files(i)%checksum)//newline)
      end do
      text = to_text(checksum%value())
   end function manifest_fingerprint

   !> Adds a file that was read, if there is one. A file that cannot be read again, such as a pipe, is only counted.
   subroutine manifest_add_input(self, path)
      class(manifest_t), intent(inout) :: self !! the manifest
      character(*), intent(in) :: path !! its name; empty for none
      type(error_t), allocatable :: unreadable

      if (len(path) > 0) call self%inputs%append(path, path, unreadable)
      if (allocated(unreadable)) self%n_unlisted = self%n_unlisted + 1
   end subroutine manifest_add_input

   !> Appends a file with its present size and checksum.
   subroutine manifest_list_append(self, path, name, error)
      class(manifest_list_t), intent(inout) :: self !! the list
      character(*), intent(in) :: path !! present path of the file
      character(*), intent(in) :: name !! its name in the list
      type(error_t), allocatable, intent(out) :: error !! it cannot be read
      type(checksum_t) :: checksum

      call file_checksum(checksum, path, error)
      if (.not. allocated(error)) call self%append_known(name, checksum%n_bytes, checksum%value())
   end subroutine manifest_list_append

   !> Appends a file with known size and checksum. Sweeps may have many thousands of grids: a full list grows by
   !> doubling.
   pure subroutine manifest_list_append_known(self, name, n_bytes, checksum)
      class(manifest_list_t), intent(inout) :: self !! the list
      character(*), intent(in) :: name !! name of the file in it
      integer(int64), intent(in) :: n_bytes !! its size
      integer(int64), intent(in) :: checksum !! its checksum

      if (.not. allocated(self%files)) allocate (self%files(8))
      if (self%n == size(self%files)) self%files = [self%files, self%files]
      self%n = self%n + 1
      self%files(self%n)%name = name
      self%files(self%n)%n_bytes = n_bytes
      self%files(self%n)%checksum = checksum
   end subroutine manifest_list_append_known

   !> The difference between a file and its entry, as a sentence; empty if there is none.
   function manifest_file_fault(self, path) result(fault)
      class(manifest_file_t), intent(in) :: self !! its size and checksum
      character(*), intent(in) :: path !! where it is
      character(:), allocatable :: fault
      type(error_t), allocatable :: error
      type(checksum_t) :: checksum

      fault = ''
      call file_checksum(checksum, path, error)
      if (allocated(error)) then
         fault = error%message(len(path) + 3:)
      else if (checksum%n_bytes /= self%n_bytes) then
         fault = 'it was changed: '//to_text(checksum%n_bytes)//' bytes, but '//to_text(self%n_bytes)//' were written'
      else if (checksum%value() /= self%checksum) then
         fault = 'it was changed: its checksum is '//to_text(checksum%value())//', but '//to_text(self%checksum)// &
            ' when it was written'
      end if
   end function manifest_file_fault

   !> Reports all files that differ from their entries.
   subroutine manifest_list_check(self, faults, folder)
      class(manifest_list_t), intent(in) :: self !! the list
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: folder !! directory of the names, with a slash; empty for the present folder
      character(:), allocatable :: fault
      integer :: i

      do i = 1, self%n
         fault = self%files(i)%fault(folder//self%files(i)%name)
         if (len(fault) > 0) call faults%add(folder//self%files(i)%name, fault)
      end do
   end subroutine manifest_list_check

   !> A summary extended by its manifest, as lines.
   function with_manifest(text, manifest) result(complete)
      character(*), intent(in) :: text !! the summary, an object with a member on its last line but one
      type(manifest_t), intent(in) :: manifest !! the manifest
      character(:), allocatable :: complete

      complete = text(:index(text, newline//'}', back=.true.) - 1)//','//newline// &
         '  "files": ['//list_text(manifest%outputs)//'],'//newline// &
         '  "inputs": ['//list_text(manifest%inputs)//'],'//newline
      if (manifest%n_unlisted > 0) complete = complete//unlisted//to_text(manifest%n_unlisted)//','//newline
      complete = complete//before_checksum//to_text(text_checksum(complete))//behind_checksum
   end function with_manifest

   !> A list of files as elements of a JSON array.
   pure function list_text(list) result(text)
      type(manifest_list_t), intent(in) :: list !! the files
      character(:), allocatable :: text
      integer :: i, n

      text = ''
      n = 0
      do i = 1, list%n
         call append_text(text, n, newline//'    {"name": '//json_string(list%files(i)%name)//', "bytes": '// &
            to_text(list%files(i)%n_bytes)//', "checksum": '//to_text(list%files(i)%checksum)//'},')
      end do
      ! There is no comma behind the last one.
      text = text(:max(0, n - 1))
   end function list_text

   !> Reads a summary and its manifest.
   subroutine read_summary(manifest, text, path, fault)
      type(manifest_t), intent(out) :: manifest !! the manifest; empty if there is a fault
      character(:), allocatable, intent(out) :: text !! the summary; not allocated if it cannot be read
      character(*), intent(in) :: path !! name of the file
      character(:), allocatable, intent(out) :: fault !! how it differs from what was written; empty if it does not
      type(checksum_t) :: checksum
      type(error_t), allocatable :: error

      ! A pipe is not opened: reading it may wait for a writer.
      call file_checksum(checksum, path, error)
      if (.not. allocated(error)) call read_text_file(path, text, error)
      if (allocated(error)) then
         if (allocated(text)) deallocate (text)
         fault = error%message(len(path) + 3:)
      else if (checksum%n_bytes /= len(text)) then
         ! The reader of texts passes over a mark before UTF-8 text.
         fault = 'it was changed: bytes precede it'
      else
         call read_manifest(manifest, text, fault)
      end if
   end subroutine read_summary

   !> Checks the manifest of a summary and reads it.
   subroutine read_manifest(manifest, text, fault)
      type(manifest_t), intent(out) :: manifest !! the manifest
      character(*), intent(in) :: text !! the summary, all of its bytes
      character(:), allocatable, intent(out) :: fault !! how it differs from what was written; empty if it does not
      integer :: last

      last = index(text, before_checksum, back=.true.) - 1
      if (last < 0) then
         fault = 'no checksum of its own: truncated, or written by an earlier version of the program'
      else if (index(text(last + 1:), before_checksum//'"') == 1) then
         fault = 'written by an earlier version of the program, with checksums of another kind'
      else if (text(max(1, len(text) - len(behind_checksum) + 1):) /= behind_checksum) then
         fault = 'it does not end as it was written'
      else if (text(last + 1:) /= before_checksum//to_text(text_checksum(text(:last)))//behind_checksum) then
         fault = 'it was changed: its own checksum is '//to_text(text_checksum(text(:last)))
      else
         fault = ''
         call read_list(manifest%outputs, text, '  "files": [')
         call read_list(manifest%inputs, text, '  "inputs": [')
         if (index(text, newline//unlisted) > 0) manifest%n_unlisted = 1
      end if
   end subroutine read_manifest

   !> Reads a list of files, one per line, from the unchanged text of a summary.
   pure subroutine read_list(list, text, head)
      type(manifest_list_t), intent(inout) :: list !! the list
      character(*), intent(in) :: text !! the summary
      character(*), intent(in) :: head !! the line before the list
      character(*), parameter :: before_name = '    {"name": "', before_bytes = '", "bytes": ', &
         before_digits = ', "checksum": '
      integer(int64) :: n_bytes, checksum
      integer :: first, at_bytes, at_digits, status

      first = index(text, newline//head//newline)
      if (first == 0) return
      first = first + len(newline//head//newline)
      do
         associate (line => text(first:first + index(text(first:), newline) - 2))
            at_bytes = index(line, before_bytes, back=.true.)
            at_digits = index(line, before_digits, back=.true.)
            if (index(line, before_name) /= 1 .or. at_bytes == 0 .or. at_digits < at_bytes) return
            read (line(at_bytes + len(before_bytes):at_digits - 1), *, iostat=status) n_bytes
            if (status /= 0) return
            read (line(at_digits + len(before_digits):index(line, '}', back=.true.) - 1), *, iostat=status) checksum
            if (status /= 0) return
            ! Quotes and backslashes are escaped by a backslash.
            call list%append_known(replaced(replaced(line(len(before_name) + 1:at_bytes - 1), '\"', '"'), '\\', '\'), &
               n_bytes, checksum)
            first = first + len(line) + 1
         end associate
      end do
   end subroutine read_list

   !> Finds the files of an earlier run that are to be removed.
   subroutine find_earlier_files(files, directory, name, manifest)
      type(file_name_t), allocatable, intent(out) :: files(:) !! the files, with their directory
      character(*), intent(in) :: directory !! output directory
      character(*), intent(in) :: name !! name of the case
      type(manifest_t), intent(in) :: manifest !! the manifest of the new results
      type(manifest_t) :: earlier
      character(:), allocatable :: summary, fault, path
      integer :: i, n, slash, k
      logical :: is_of_case, is_removable

      ! Where it cannot be read, or it was changed, nothing is named.
      call read_summary(earlier, summary, directory//'/'//name//'.summary.json', fault)
      allocate (files(earlier%outputs%n))
      n = 0
      do i = 1, earlier%outputs%n
         associate (file => earlier%outputs%files(i))
            ! A summary of another program may name any file.
            slash = index(file%name, '/', back=.true.)
            is_of_case = index(file%name, name//'.') == 1 .and. slash == 0 .or. &
               file%name(:slash) == name//'.sweep/' .or. file%name(:slash) == name//'.history/'
            if (.not. is_of_case) cycle
            if (any([(manifest%outputs%files(k)%name == file%name, k=1, manifest%outputs%n)])) cycle
            ! What has changed since, or the new run has read, is kept.
            path = directory//'/'//file%name
            is_removable = len(file%fault(path)) == 0
            do k = 1, manifest%inputs%n
               if (absolute_path(manifest%inputs%files(k)%name) == absolute_path(path)) is_removable = .false.
            end do
            if (.not. is_removable) cycle
            n = n + 1
            files(n)%text = directory//'/'//file%name
         end associate
      end do
      files = files(:n)
   end subroutine find_earlier_files

   !> The lines of a case in a collection.
   pure function case_entries(time, stem) result(lines)
      character(*), intent(in) :: time !! its time
      character(*), intent(in) :: stem !! name of its files without endings, seen from the folder of the collection
      character(:), allocatable :: lines, head

      head = '    <DataSet timestep="'//time//'" part="'
      lines = head//'0" name="body" file="'//xml_escaped(stem)//'.vtu"/>'//newline// &
         head//'1" name="contact line" file="'//xml_escaped(stem)//'.contact.vtu"/>'//newline
   end function case_entries

end module amontons_manifest
