!> Recognition of results that need not be computed again (`--skip-unchanged`): those of the same deck, with the same
!> input files, from this version of the program; solved, certified, and with all files unchanged.
module amontons_unchanged
   use amontons_batch_table, only: number_keys
   use amontons_config, only: config_t
   use amontons_error, only: error_t, fault_list_t
   use amontons_input_file, only: read_text_file
   use amontons_kinds, only: dp
   use amontons_manifest, only: manifest_list_t, manifest_t, read_summary
   use amontons_quantity, only: quantity_t
   use amontons_report, only: member_value
   use amontons_text, only: newline, read_real
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: find_unchanged

contains

   !> Finds out whether solving a deck again would reproduce the existing files.
   subroutine find_unchanged(is_unchanged, numbers, config, directory)
      logical, intent(out) :: is_unchanged !! whether it would
      type(quantity_t), allocatable, intent(out) :: numbers(:) !! numbers of its result, if it would
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: directory !! output directory
      type(manifest_t) :: manifest
      type(error_t), allocatable :: error
      type(fault_list_t) :: faults
      character(:), allocatable :: summary, fault, deck, stem

      is_unchanged = .false.
      stem = directory//'/'//config%name
      call read_summary(manifest, summary, stem//'.summary.json', fault)
      if (len(fault) > 0) return
      if (index(summary, newline//'  "version": "'//version//'",'//newline) == 0) return
      if (index(summary, newline//'  "converged": true,'//newline) == 0) return
      if (index(summary, '"passed": true') == 0) return
      call read_text_file(stem//'.deck.nml', deck, error)
      if (allocated(error)) return
      if (deck /= config%deck_text()) return
      call manifest%outputs%check(faults, directory//'/')
      call manifest%inputs%check(faults, '')
      is_unchanged = faults%n == 0 .and. lists_inputs(config, manifest%inputs)
      if (is_unchanged) numbers = summary_numbers(summary)
   end subroutine find_unchanged

   !> Numbers of a result from its summary; for a sweep the largest over its cases.
   pure function summary_numbers(summary) result(numbers)
      character(*), intent(in) :: summary !! the summary
      type(quantity_t), allocatable :: numbers(:)
      character(*), parameter :: sections(*) = [character(12) :: 'load_history', '', 'key_results', 'resultants']
      character(:), allocatable :: value
      real(dp) :: number
      logical :: ok
      integer :: i, k

      allocate (numbers(0))
      do i = 1, size(number_keys)
         do k = 1, size(sections)
            value = member_value(summary, trim(sections(k)), trim(number_keys(i)))
            call read_real(value, number, ok)
            if (ok) exit
         end do
         ! Sums of forces of a sweep are no results of one case.
         if (.not. ok .and. index(number_keys(i), 'max_') == 1) then
            value = largest_of_cases(summary, trim(number_keys(i)))
            call read_real(value, number, ok)
         end if
         if (ok) numbers = [numbers, quantity_t(number_keys(i), '', number)]
      end do
   end function summary_numbers

   !> The largest value of a number over the cases of a sweep, from its summary; empty if it has none.
   pure function largest_of_cases(summary, key) result(value)
      character(*), intent(in) :: summary !! the summary
      character(*), intent(in) :: key !! name of the number
      character(:), allocatable :: value, extremes
      integer :: first

      value = ''
      extremes = member_value(summary, '', 'extremes')
      first = index(extremes, '"'//key//'": {')
      if (first == 0) return
      first = first + index(extremes(first:), '"greatest": ') + len('"greatest": ') - 1
      value = extremes(first:first + index(extremes(first:), ',') - 2)
   end function largest_of_cases

   !> Whether every file that a deck names is listed. A pipe is never listed.
   logical function lists_inputs(config, inputs)
      type(config_t), intent(in) :: config !! the deck
      type(manifest_list_t), intent(in) :: inputs !! the files that were read
      integer :: i

      lists_inputs = .true.
      if (config%reduced%is_given) then
         call check(lists_inputs, inputs, config%reduced%path)
         return
      end if
      do i = 1, size(config%meshes)
         call check(lists_inputs, inputs, config%meshes(i)%file)
      end do
      do i = 1, size(config%contacts)
         associate (contact => config%contacts(i))
            call check(lists_inputs, inputs, contact%friction%file)
            call check(lists_inputs, inputs, contact%slip_bound%file)
            call check(lists_inputs, inputs, contact%extra_gap%file)
            call check(lists_inputs, inputs, contact%obstacle%file)
         end associate
      end do
      do i = 1, size(config%loads)
         call check(lists_inputs, inputs, config%loads(i)%temperature_file)
      end do
      call check(lists_inputs, inputs, config%history%start)
      if (.not. allocated(config%history%steps)) return
      do i = 1, size(config%history%steps)
         call check(lists_inputs, inputs, config%history%steps(i)%file)
      end do
   end function lists_inputs

   !> Checks that a file, if one is named, is among those that are listed.
   pure subroutine check(lists_inputs, inputs, path)
      logical, intent(inout) :: lists_inputs !! becomes false if the file is not listed
      type(manifest_list_t), intent(in) :: inputs !! the files that were read
      character(:), allocatable, intent(in) :: path !! its name; empty or not allocated for none
      integer :: i

      if (.not. allocated(path)) return
      if (len(path) > 0) lists_inputs = lists_inputs .and. any([(inputs%files(i)%name == path, i=1, inputs%n)])
   end subroutine check

end module amontons_unchanged
