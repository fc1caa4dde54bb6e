!> Verification of the results in a directory from the files alone, without any knowledge of the run that wrote them.
!>
!> Two questions are answered for every case. Is each file, the mesh and the tables included, unchanged byte by byte?
!> And do the files agree with each other: do the results follow from the displacements, the contact forces, the deck
!> and the mesh, and do tables, grids, listing and summary state the same? Checksums answer the first question and find
!> accidents; recomputation answers the second and finds wrong numbers.
module amontons_verify
   use amontons_config, only: read_config
   use amontons_document, only: json_string
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_file_check, only: verified_case_t
   use amontons_manifest, only: manifest_t, read_summary
   use amontons_solve_case, only: cache_t
   use amontons_system, only: file_name_t, list_directory
   use amontons_verify_case, only: verify_case, verify_reduced
   use amontons_verify_history, only: verify_history
   use amontons_verify_sweep, only: verify_sweep
   implicit none (type, external)
   private

   public :: find_cases, verdict_t, verify_files

   !> Suffixes of the files of a case: that of its summary, and those by which a case without one is found.
   character(13), parameter :: suffixes(*) = [character(13) :: '.summary.json', '.deck.nml', '.contact.csv', &
      '.contact.vtu', '.sweep.csv']

   !> The verdict on the files of a case.
   type :: verdict_t
      logical :: is_verified = .false. !! whether its files are as they were written and agree with each other
      logical :: is_certified = .false. !! whether, moreover, it converged and its certificate passes
      character(:), allocatable :: remark !! text on what could not be checked, for the verdict; mostly empty
      character(:), allocatable :: faults !! faults, a line of text for each file or number; empty if there are none
   end type verdict_t

contains

   !> Finds the cases in a directory, in the order of the names of their summaries.
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
      do k = 1, size(suffixes)
         do i = 1, size(files)
            call claim(names, n, files(i)%text, trim(suffixes(k)))
         end do
      end do
      names = names(:n)
      if (n == 0) call new_error(error, input_refused, directory//': there are no results in this directory')
   end subroutine find_cases

   !> Adds the case that a file belongs to, unless the case, or one to which the file belongs as well, is known.
   pure subroutine claim(names, n, file, suffix)
      type(file_name_t), intent(inout) :: names(:) !! names of the cases
      integer, intent(inout) :: n !! number of cases so far
      character(*), intent(in) :: file !! name of the file
      character(*), intent(in) :: suffix !! the suffix
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
      type(verdict_t), intent(out) :: verdict !! the verdict
      type(cache_t), intent(inout) :: cache !! the last body: cases that agree in it share it
      character(*), intent(in) :: directory !! the directory
      character(*), intent(in) :: name !! name of the case
      type(verified_case_t) :: case
      type(manifest_t) :: manifest
      type(error_t), allocatable :: error
      character(:), allocatable :: fault

      case%stem = directory//'/'//name
      verdict%remark = ''
      call read_summary(manifest, case%summary, case%stem//suffixes(1), fault)
      call case%fault(suffixes(1), fault)
      call manifest%outputs%check(case%faults, directory//'/')
      call manifest%inputs%check(case%faults, '')
      if (allocated(case%summary)) then
         if (case%faults%n == 0 .and. index(case%summary, '"name": '//json_string(name//'.deck.nml')//',') == 0) then
            ! Where there is no deck, the summary is trusted.
            case%is_certified = case%value('', 'converged') == 'true' .and. &
               case%value('certificate', 'passed') == 'true'
            verdict%remark = ' by checksums alone; no deck: nothing was recomputed'
         else
            ! Checks the files of a case that comes from a deck against each other.
            call read_config(case%config, case%stem//'.deck.nml', error)
            if (allocated(error)) then
               call case%fault('.deck.nml', error%message)
            else
               case%solved = case%config
               if (case%solved%condensation%factorization == 'distributed') case%solved%condensation%factorization &
                  = 'auto'
               if (case%config%name /= name) call case%fault('.deck.nml', "it is the deck of case '"// &
                  case%config%name//"'")
               if (case%config%reduced%is_given) then
                  call verify_reduced(case)
               else if (case%config%history%is_given) then
                  call verify_history(case, cache)
               else if (case%config%sweep%is_given()) then
                  call verify_sweep(case, cache)
               else
                  call verify_case(case, cache)
               end if
            end if
         end if
      end if
      verdict%is_certified = case%is_certified
      verdict%is_verified = case%faults%n == 0
      verdict%faults = case%faults%text()
   end subroutine verify_files

end module amontons_verify
