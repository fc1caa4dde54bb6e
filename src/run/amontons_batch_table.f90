!> OUTPUT/batch.csv: one row for each deck of a batch, whatever its outcome; the tally of a run; and recognition of
!> results that need not be computed again (`--skip-unchanged`): those of the same deck, with the same input files, from
!> this version of the program; solved, certified, and with all files unchanged.
!>
!> Several runs may use one folder at the same time: each replaces the rows of its own decks and cases, and all others
!> are kept. The file is read and rewritten while the folder is locked.
module amontons_batch_table
   use amontons_config, only: config_t
   use amontons_document, only: field
   use amontons_error, only: error_t, fault_list_t, warning_list_t
   use amontons_input_file, only: read_text_file
   use amontons_kinds, only: dp
   use amontons_manifest, only: manifest_t, read_summary
   use amontons_output_file, only: file_lock_t, lock_directory, output_file_t, write_text_file
   use amontons_quantity, only: quantity_t, value_of
   use amontons_report, only: member_value
   use amontons_study, only: outcome_t, word_no_equilibrium, word_not_certified, word_not_converged, word_solved
   use amontons_system, only: file_name_t, make_directory
   use amontons_text, only: line_end, newline, occurrences, put_text, read_real, replaced, scientific, to_text
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: find_unchanged, tally_text, update_batch_table

   !> Numbers in the table of a deck with a result.
   character(20), parameter :: number_keys(*) = [character(20) :: 'iterations', 'residual', 'max_contact_pressure', &
      'max_von_mises', 'max_displacement', 'normal_force', 'tangential_force']
   !> Outcomes in the words of the table.
   character(17), parameter :: outcome_words(*) = [character(17) :: word_solved, 'checked', 'unchanged', &
      word_no_equilibrium, word_not_converged, word_not_certified, 'refused', 'numerical_failure', 'system_failure', &
      'interrupted']
   !> Outcomes in the words of the tally.
   character(19), parameter :: outcome_labels(*) = [character(19) :: 'solved', 'OK', 'unchanged', &
      'without equilibrium', 'not converged', 'not certified', 'refused', 'failed numerically', 'not written', &
      'interrupted']

contains

   !> The tally of a run: '50 decks: 47 solved, 2 refused, 1 without equilibrium'.
   pure function tally_text(outcomes, n_decks) result(text)
      type(outcome_t), intent(in) :: outcomes(:) !! what became of the decks that were tried
      integer, intent(in) :: n_decks !! number of decks
      character(:), allocatable :: text
      character(:), allocatable :: separator
      integer :: i, k, n

      text = to_text(n_decks)//' decks'
      separator = ': '
      do i = 1, size(outcome_words)
         n = count([(outcomes(k)%word == outcome_words(i), k=1, size(outcomes))])
         if (n == 0) cycle
         text = text//separator//to_text(n)//' '//trim(outcome_labels(i))
         separator = ', '
      end do
      if (size(outcomes) < n_decks) text = text//separator//to_text(n_decks - size(outcomes))//' not tried'
   end function tally_text

   !> Inserts the rows of decks into the table. The row of a deck takes the place of its earlier one, and of that of
   !> another deck whose result files it has replaced; a deck whose results are unchanged keeps its row.
   subroutine update_batch_table(directory, outcomes, notes, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(outcome_t), intent(in) :: outcomes(:) !! what became of the decks
      type(warning_list_t), intent(inout) :: notes !! gains the decks whose results were replaced by those of another
      type(error_t), allocatable, intent(out) :: error !! the table cannot be written
      type(output_file_t) :: file
      type(file_lock_t) :: lock
      type(file_name_t), allocatable :: rows(:)
      character(:), allocatable :: text, deck, name, other
      integer :: i, k, n, first, at, length

      call make_directory(directory, error)
      if (allocated(error)) return
      call lock_directory(lock, directory//'/')
      call read_text_file(directory//'/batch.csv', text, error)
      if (allocated(error)) text = ''
      if (index(text, header()) /= 1 .or. index(text, newline, back=.true.) /= len(text)) text = header()
      n = occurrences(text, newline) - 1
      allocate (rows(n + size(outcomes)))
      first = len(header()) + 1
      do i = 1, n
         rows(i)%text = text(first:line_end(text, first))
         first = first + len(rows(i)%text) + 1
      end do
      do i = 1, size(outcomes)
         deck = field(one_line(outcomes(i)%deck))
         name = field(outcomes(i)%name)
         at = 0
         do k = 1, n
            other = cell(rows(k)%text, 1)
            if (other == deck) then
               at = k
            else if (cell(rows(k)%text, 2) == name .and. has_results(cell(rows(k)%text, 3)) .and. &
               has_results(outcomes(i)%word)) then
               rows(k)%text = ''
               if (outcomes(i)%word /= 'unchanged') call notes%add(other//': warning: its results were replaced by '// &
                  "those of '"//one_line(outcomes(i)%deck)//"', which has the same case name '"//outcomes(i)%name// &
                  "'; give each its own &case name")
            end if
         end do
         if (at > 0 .and. outcomes(i)%word == 'unchanged') then
            if (cell(rows(at)%text, 3) == word_solved) cycle
         end if
         if (at == 0) n = n + 1
         if (at == 0) at = n
         rows(at)%text = row_text(outcomes(i))
      end do
      deallocate (text)
      allocate (character(sum([(len(rows(i)%text) + 1, i=1, n)])) :: text)
      length = 0
      do i = 1, n
         if (len(rows(i)%text) > 0) call put_text(text, length, rows(i)%text//newline)
      end do
      call write_text_file(file, directory//'/batch.csv', header()//text(:length), error)
      if (.not. allocated(error)) call file%commit(error)
      call lock%release()
   end subroutine update_batch_table

   !=batch.csv `deck`, `case` | | name of the deck as it was given, and of its case; the case is empty where the deck
   !=   was refused
   !=batch.csv `outcome` | | `solved`, `no_equilibrium`, `not_converged`, `not_certified`, `refused`,
   !=   `numerical_failure`, `system_failure` or `interrupted` ([what they mean](#exit-status-and-outcomes))
   !=batch.csv `exit_status` | | the status that the deck alone gives
   !=batch.csv `iterations`, `residual` | – | of the contact method; of a sweep and a history all iterations and the
   !=   largest residual
   !=batch.csv `max_contact_pressure`, `max_von_mises`, `max_displacement`, `normal_force`, `tangential_force` | stress,
   !=   length, force | [key results](#key-results) of a single case, and of the last step of a history; of a sweep the
   !=   greatest of all cases, sums of forces empty
   !=batch.csv `seconds` | s | time of the deck
   !=batch.csv `message` | | what went wrong, in one line
   !> The first line of batch.csv, with the names of its columns.
   pure function header() result(text)
      character(:), allocatable :: text
      integer :: i

      text = 'deck,case,outcome,exit_status'
      do i = 1, size(number_keys)
         text = text//','//trim(number_keys(i))
      end do
      text = text//',seconds,message'//newline
   end function header

   !> A field of a row, in its quotes if it has any.
   pure function cell(row, column) result(text)
      character(*), intent(in) :: row !! the row
      integer, intent(in) :: column !! number of its column
      character(:), allocatable :: text
      integer :: first, last, i
      logical :: is_quoted

      last = 0
      do i = 1, column
         first = last + 1
         is_quoted = .false.
         do last = first, len(row)
            if (row(last:last) == '"') is_quoted = .not. is_quoted
            if (row(last:last) == ',' .and. .not. is_quoted) exit
         end do
      end do
      text = row(first:last - 1)
   end function cell

   !> The row of a deck, without a line end.
   pure function row_text(outcome) result(text)
      type(outcome_t), intent(in) :: outcome !! the outcome of the deck
      character(:), allocatable :: text
      integer :: i

      text = outcome%word
      if (text == 'unchanged') text = word_solved
      text = field(one_line(outcome%deck))//','//field(outcome%name)//','//text//','//to_text(outcome%status)
      do i = 1, size(number_keys)
         text = text//','
         if (.not. allocated(outcome%numbers)) cycle
         if (.not. any(outcome%numbers%key == number_keys(i))) cycle
         if (i == 1) text = text//to_text(nint(value_of(outcome%numbers, number_keys(i))))
         if (i > 1) text = text//to_text(value_of(outcome%numbers, number_keys(i)))
      end do
      text = text//','//scientific(outcome%seconds)//','//field(one_line(outcome%message))
   end function row_text

   !> Whether an outcome has result files.
   pure logical function has_results(word)
      character(*), intent(in) :: word !! the outcome

      has_results = all(['refused          ', 'numerical_failure', 'system_failure   ', 'interrupted      '] /= word)
   end function has_results

   !> A text of several lines joined to one line.
   pure function one_line(lines) result(text)
      character(*), intent(in) :: lines !! the lines
      character(:), allocatable :: text

      text = replaced(lines, newline, '; ')
   end function one_line

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
      is_unchanged = faults%n == 0 .and. manifest%n_unlisted == 0
      if (is_unchanged) numbers = summary_numbers(summary)
   end subroutine find_unchanged

   !> Numbers of a result from its summary; for a sweep the largest over its cases.
   pure function summary_numbers(summary) result(numbers)
      character(*), intent(in) :: summary !! the summary
      type(quantity_t), allocatable :: numbers(:)
      character(*), parameter :: sections(*) = [character(12) :: 'load_history', '', 'key_results', 'resultants'], &
         greatest = '"greatest": '
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
         value = member_value(summary, '', 'extremes')
         k = index(value, '"'//trim(number_keys(i))//'": {')
         if (.not. ok .and. k > 0 .and. index(number_keys(i), 'max_') == 1) then
            k = k + index(value(k:), greatest) + len(greatest) - 1
            call read_real(value(k:k + index(value(k:), ',') - 2), number, ok)
         end if
         if (ok) numbers = [numbers, quantity_t(number_keys(i), '', number)]
      end do
   end function summary_numbers

end module amontons_batch_table
