!> The results in a directory, verified from the files alone: nothing is known of the run that wrote them.
!>
!> Two questions are asked of every case. Is each file, the mesh and the tables included, byte by byte the one that was
!> written? And do the files agree with each other: does what the displacements and the contact forces say follow from
!> the deck and the mesh, and do the tables, grids, listing and summary say the same? Checksums answer
!> the first and find accidents; recomputation answers the second and finds wrong numbers.
module amontons_verify
   use amontons_checksum, only: checksum_t, file_checksum
   use amontons_config, only: config_t, read_config
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_fault_list, only: fault_list_t
   use amontons_json, only: json_string
   use amontons_manifest, only: read_summary, manifest_t, manifest_file_t
   use amontons_solve_case, only: cache_t
   use amontons_summary_file, only: summary_file_t
   use amontons_system, only: file_name_t, list_directory
   use amontons_text, only: to_text
   use amontons_verify_case, only: verify_case
   use amontons_verify_history, only: verify_history
   use amontons_verify_reduced, only: verify_reduced
   use amontons_verify_sweep, only: verify_sweep
   implicit none (type, external)
   private

   public :: find_cases, verdict_t, verify_files

   character(*), parameter :: summary_suffix = '.summary.json'
   !> What names of other files end with that tell of a case whose summary is missing.
   character(12), parameter :: other_suffixes(*) = [character(12) :: '.deck.nml', '.contact.csv', '.contact.vtu', &
      '.sweep.csv']

   !> What was found of a case.
   type :: verdict_t
      logical :: is_verified = .false. !! whether its files are as they were written and agree with each other
      logical :: is_certified = .false. !! whether, moreover, it converged and its certificate passes
      character(:), allocatable :: remark !! what could not be looked at, for the verdict; mostly empty
      character(:), allocatable :: faults !! what is wrong, a line of text for each file or number; empty if nothing
   end type verdict_t

contains

   !> Finds the cases whose files a directory holds, in the order of the names of their summaries.
   subroutine find_cases(names, directory, error)
      type(file_name_t), allocatable, intent(out) :: names(:) !! names of the cases
      character(*), intent(in) :: directory !! the directory
      type(error_t), allocatable, intent(out) :: error !! it cannot be read, or holds no results
      type(file_name_t), allocatable :: files(:)
      integer :: i, k, n

      call list_directory(files, directory, error)
      if (allocated(error)) return
      allocate (names(size(files)))
      n = 0
      do i = 1, size(files)
         call claim(names, n, files(i)%text, summary_suffix)
      end do
      do i = 1, size(files)
         do k = 1, size(other_suffixes)
            call claim(names, n, files(i)%text, trim(other_suffixes(k)))
         end do
      end do
      names = names(:n)
      if (n == 0) call new_error(error, input_refused, directory//': there are no results in this directory')
   end subroutine find_cases

   !> Adds the case that a file belongs to, unless the case is known, or the file is one of a known case.
   pure subroutine claim(names, n, file, suffix)
      type(file_name_t), intent(inout) :: names(:) !! names of the cases
      integer, intent(inout) :: n !! number of cases so far
      character(*), intent(in) :: file !! name of the file
      character(*), intent(in) :: suffix !! what it may end with
      integer :: i, length

      length = len(file) - len(suffix)
      if (length < 1) return
      if (file(length + 1:) /= suffix) return
      do i = 1, n
         associate (name => names(i)%text)
            if (file(:length) == name .and. length == len(name)) return
            ! The grid of case a.contact is a.contact.vtu.
            if (index(file, name//'.') == 1 .and. len(name) > length) return
         end associate
      end do
      n = n + 1
      names(n)%text = file(:length)
   end subroutine claim

   !> Verifies the files of a case.
   subroutine verify_files(verdict, cache, directory, name)
      type(verdict_t), intent(out) :: verdict !! what was found
      type(cache_t), intent(inout) :: cache !! the body at hand: cases that agree in it share it
      character(*), intent(in) :: directory !! the directory
      character(*), intent(in) :: name !! name of the case
      type(summary_file_t) :: summary
      character(:), allocatable :: stem

      stem = directory//'/'//name
      verdict%remark = ''
      summary%path = stem//summary_suffix
      call check_manifest(summary, directory)
      if (allocated(summary%text)) then
         if (summary%faults%n == 0 .and. index(summary%text, '"name": '//json_string(name//'.deck.nml')//',') == 0) then
            call trust_summary(verdict, summary, 'no deck: nothing was recomputed')
         else
            call verify_contents(verdict, summary, cache, stem, name)
         end if
      end if
      verdict%is_verified = summary%faults%n == 0
      verdict%faults = summary%faults%text()
   end subroutine verify_files

   !> Checks the files of a case that comes from a deck against each other.
   subroutine verify_contents(verdict, summary, cache, stem, name)
      type(verdict_t), intent(inout) :: verdict !! gains whether the case converged and its certificate passes
      type(summary_file_t), intent(inout) :: summary !! the summary; gains the faults
      type(cache_t), intent(inout) :: cache !! the body at hand
      character(*), intent(in) :: stem !! directory and name of the case
      character(*), intent(in) :: name !! name of the case
      type(config_t) :: config
      type(error_t), allocatable :: error

      call read_config(config, stem//'.deck.nml', error)
      if (allocated(error)) then
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      if (config%name /= name) call summary%faults%add(stem//'.deck.nml', "it is the deck of case '"//config%name//"'")
      if (config%reduced%is_given) then
         call verify_reduced(summary, config, stem, verdict%is_certified)
      else if (config%history%is_given) then
         call verify_history(summary, cache, config, stem, verdict%is_certified)
      else if (config%sweep%is_given()) then
         call verify_sweep(summary, cache, config, stem, verdict%is_certified)
      else
         call verify_case(summary, cache, config, stem, verdict%is_certified)
      end if
   end subroutine verify_contents

   !> Takes from the summary whether a case converged and its certificate passes, where only checksums are compared.
   subroutine trust_summary(verdict, summary, reason)
      type(verdict_t), intent(inout) :: verdict !! gains this, and a remark
      type(summary_file_t), intent(in) :: summary !! the summary
      character(*), intent(in) :: reason !! why no more is done

      verdict%is_certified = summary%value('', 'converged') == 'true' .and. &
         summary%value('certificate', 'passed') == 'true'
      verdict%remark = ' by checksums alone; '//reason
   end subroutine trust_summary

   !> Reads the summary and compares every file with its manifest.
   subroutine check_manifest(summary, directory)
      type(summary_file_t), intent(inout) :: summary !! gains the text, if it can be read, and the faults
      character(*), intent(in) :: directory !! the directory of the results
      type(manifest_t) :: manifest
      character(:), allocatable :: fault
      integer :: i

      call read_summary(manifest, summary%text, summary%path, fault)
      if (len(fault) > 0) call summary%faults%add(summary%path, fault)
      do i = 1, manifest%outputs%n
         associate (file => manifest%outputs%files(i))
            call check_file(summary%faults, directory//'/'//file%name, file)
         end associate
      end do
      do i = 1, manifest%inputs%n
         associate (file => manifest%inputs%files(i))
            call check_file(summary%faults, file%name, file)
         end associate
      end do
   end subroutine check_manifest

   !> Compares a file with its manifest.
   subroutine check_file(faults, path, listed)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: path !! name of the file
      type(manifest_file_t), intent(in) :: listed !! what is known of it
      type(error_t), allocatable :: error
      type(checksum_t) :: checksum

      call file_checksum(checksum, path, error)
      if (allocated(error)) then
         call faults%add(path, error%message(len(path) + 3:))
      else if (checksum%n_bytes /= listed%n_bytes) then
         call faults%add(path, 'it was changed: '//to_text(checksum%n_bytes)//' bytes, but '// &
            to_text(listed%n_bytes)//' were written')
      else if (checksum%value() /= listed%checksum) then
         call faults%add(path, 'it was changed: its checksum is '//to_text(checksum%value())//', but '// &
            to_text(listed%checksum)//' when it was written')
      end if
   end subroutine check_file

end module amontons_verify
