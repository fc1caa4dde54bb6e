!> OUTPUT/batch.csv: one row for each deck of a batch, whatever its outcome; the tally of a run; and recognition of
!> results that need not be computed again (`--skip-unchanged`): those of the same deck, with the same input files, from
!> this version of the program; solved, certified, and with all files unchanged.
!>
!> Several runs may use one folder at the same time: each replaces the rows of its own decks, and all others are kept.
!> The file is read and rewritten while the folder is locked. A deck is identified by its file, irrespective of the path
!> by which it is named.
module amontons_batch_table
   use amontons_config, only: config_t
   use amontons_document, only: field
   use amontons_error, only: error_t, fault_list_t, warning_list_t
   use amontons_input_file, only: read_text_file
   use amontons_kinds, only: dp
   use amontons_manifest, only: manifest_list_t, manifest_t, read_summary
   use amontons_output_file, only: file_lock_t, lock_directory, output_file_t, write_text_file
   use amontons_quantity, only: quantity_t, value_of
   use amontons_report, only: member_value
   use amontons_study, only: outcome_t, word_no_equilibrium, word_not_certified, word_not_converged, word_solved
   use amontons_system, only: absolute_path, make_directory
   use amontons_text, only: newline, put_text, read_real, replaced, scientific, to_text
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: find_unchanged, tally_text, update_batch_table

   !> A row of the table.
   type :: row_t
      character(:), allocatable :: deck !! name of the deck
      character(:), allocatable :: name !! name of its case
      character(:), allocatable :: word !! its outcome
      character(:), allocatable :: status !! its exit status
      character(:), allocatable :: text !! the row, its line end included; empty for one that is removed
   end type row_t

   !> Numbers in the table of a deck with a result.
   character(20), parameter :: number_keys(*) = [character(20) :: 'iterations', 'residual', 'max_contact_pressure', &
      'max_von_mises', 'max_displacement', 'normal_force', 'tangential_force']
   !> Outcomes in the words of the table.
   character(17), parameter :: outcome_words(*) = [character(17) :: word_solved, 'checked', 'unchanged', &
      word_no_equilibrium, word_not_converged, word_not_certified, 'refused', 'numerical_failure', 'system_failure', &
      'interrupted']
   !> Outcomes without result files.
   character(17), parameter :: words_without_results(*) = [character(17) :: 'refused', 'numerical_failure', &
      'system_failure', 'interrupted']
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

   !> Inserts the rows of decks into the table.
   subroutine update_batch_table(directory, outcomes, notes, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(outcome_t), intent(in) :: outcomes(:) !! what became of the decks
      type(warning_list_t), intent(inout) :: notes !! gains the decks whose results were replaced by those of another
      type(error_t), allocatable, intent(out) :: error !! the table cannot be written
      type(output_file_t) :: file
      type(file_lock_t) :: lock
      type(row_t), allocatable :: rows(:)
      character(:), allocatable :: text
      integer :: i, n, length
      logical :: has_folder, has_deck

      call make_directory(directory, error)
      if (allocated(error)) return
      call lock_directory(lock, directory//'/')
      call read_rows(directory//'/batch.csv', size(outcomes), rows, n)
      ! Failed decks that are not in their folder any more are removed: nothing is left of them.
      do i = 1, n
         if (has_results(rows(i)%word)) cycle
         inquire (file=rows(i)%deck, exist=has_deck)
         if (has_deck) cycle
         inquire (file=rows(i)%deck(:scan(rows(i)%deck, '/', back=.true.))//'.', exist=has_folder)
         if (has_folder .and. rows(i)%deck /= '-') rows(i)%text = ''
      end do
      do i = 1, size(outcomes)
         call put_row(rows, n, outcomes(i), notes)
      end do
      length = 0
      allocate (character(sum([(len(rows(i)%text), i=1, n)])) :: text)
      do i = 1, n
         call put_text(text, length, rows(i)%text)
      end do
      call write_text_file(file, directory//'/batch.csv', header()//text, error)
      if (.not. allocated(error)) call file%commit(error)
      call lock%release()
   end subroutine update_batch_table

   !=batch.csv `deck`, `case` | | name of the deck as it was given, and of its case; the case is empty where the deck
   !=   was refused
   !=batch.csv `outcome` | | `solved`, `no_equilibrium`, `not_converged`, `not_certified`, `refused`,
   !=   `numerical_failure`, `system_failure`, `interrupted` ([what they mean](#exit-status-and-outcomes)) or `replaced`
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

   !> Reads the existing rows; none if there is no table, or one of another version.
   subroutine read_rows(path, n_more, rows, n)
      character(*), intent(in) :: path !! name of the table
      integer, intent(in) :: n_more !! number of rows that may be added
      type(row_t), allocatable, intent(out) :: rows(:) !! the rows, and room for more
      integer, intent(out) :: n !! number of rows
      type(error_t), allocatable :: error
      character(:), allocatable :: text
      integer :: first, last, i

      call read_text_file(path, text, error)
      if (allocated(error)) text = ''
      if (index(text, header()) /= 1 .or. index(text, newline, back=.true.) /= len(text)) text = header()
      n = -1
      do i = 1, len(text)
         if (text(i:i) == newline) n = n + 1
      end do
      allocate (rows(n + n_more))
      first = len(header()) + 1
      do i = 1, n
         last = first + index(text(first:), newline) - 1
         call new_row(rows(i), text(first:last))
         first = last + 1
      end do
   end subroutine read_rows

   !> Makes a row of batch.csv from its line of text.
   pure subroutine new_row(row, line)
      type(row_t), intent(out) :: row !! the row
      character(*), intent(in) :: line !! its text, the line end included
      integer :: next

      next = 1
      call take_field(line, next, row%deck)
      call take_field(line, next, row%name)
      call take_field(line, next, row%word)
      call take_field(line, next, row%status)
      row%text = line
   end subroutine new_row

   !> Reads the next field of a line of batch.csv.
   pure subroutine take_field(line, next, value)
      character(*), intent(in) :: line !! the row
      integer, intent(inout) :: next !! position of the field; that of the next one on return
      character(:), allocatable, intent(out) :: value !! the field, without its quotes
      integer :: first
      logical :: is_quoted

      first = next
      is_quoted = .false.
      do while (next < len(line))
         if (line(next:next) == '"') is_quoted = .not. is_quoted
         if (line(next:next) == ',' .and. .not. is_quoted) exit
         next = next + 1
      end do
      value = line(first:next - 1)
      if (index(value, '"') == 1) value = replaced(value(2:len(value) - 1), '""', '"')
      next = next + 1
   end subroutine take_field

   !> Replaces the row of a deck, or appends one. A deck whose results are unchanged keeps its row.
   subroutine put_row(rows, n, outcome, notes)
      type(row_t), intent(inout) :: rows(:) !! the rows, and room for more
      integer, intent(inout) :: n !! number of rows
      type(outcome_t), intent(in) :: outcome !! the outcome of the deck
      type(warning_list_t), intent(inout) :: notes !! gains the decks whose results were replaced
      character(:), allocatable :: deck, sentence, text
      integer :: i, at
      logical :: is_there

      deck = one_line(outcome%deck)
      at = 0
      do i = 1, n
         if (len(rows(i)%text) == 0) cycle
         if (rows(i)%deck == deck) then
            at = i
         else if (is_same_file(rows(i)%deck, deck)) then
            rows(i)%text = ''
         else if (rows(i)%name == outcome%name .and. has_results(rows(i)%word) .and. has_results(outcome%word) .and. &
            outcome%word /= 'unchanged') then
            ! Notes that the results of a deck were replaced by those of another one with the same case name.
            inquire (file=rows(i)%deck, exist=is_there)
            if (.not. is_there) then
               rows(i)%text = ''
            else if (rows(i)%word /= 'replaced') then
               sentence = "its results were replaced by those of '"//deck//"', which has the same case name '"// &
                  rows(i)%name//"'; give each its own &case name"
               rows(i)%word = 'replaced'
               rows(i)%text = field(rows(i)%deck)//','//field(rows(i)%name)//','//rows(i)%word//','//rows(i)%status// &
                  repeat(',', size(number_keys) + 2)//field(sentence)//newline
               call notes%add(rows(i)%deck//': warning: '//sentence)
            end if
         end if
      end do
      if (at == 0) then
         n = n + 1
         at = n
      else if (outcome%word == 'unchanged' .and. rows(at)%word == word_solved) then
         return
      end if
      ! The row of a deck.
      text = field(one_line(outcome%deck))//','//field(outcome%name)//','
      if (outcome%word == 'unchanged') then
         text = text//word_solved
      else
         text = text//outcome%word
      end if
      text = text//','//to_text(outcome%status)
      do i = 1, size(number_keys)
         text = text//','
         if (.not. allocated(outcome%numbers)) cycle
         if (.not. any(outcome%numbers%key == number_keys(i))) cycle
         if (i == 1) text = text//to_text(nint(value_of(outcome%numbers, number_keys(i))))
         if (i > 1) text = text//to_text(value_of(outcome%numbers, number_keys(i)))
      end do
      text = text//','//scientific(outcome%seconds)//','//field(one_line(outcome%message))//newline
      call new_row(rows(at), text)
   end subroutine put_row

   !> Whether an outcome has result files.
   pure logical function has_results(word)
      character(*), intent(in) :: word !! the outcome

      has_results = all(words_without_results /= word)
   end function has_results

   !> Whether two names of decks refer to one file. Files are compared only if the last parts of their names are equal.
   logical function is_same_file(first, second)
      character(*), intent(in) :: first !! a name
      character(*), intent(in) :: second !! another one
      logical :: is_there

      is_same_file = first(scan(first, '/', back=.true.) + 1:) == second(scan(second, '/', back=.true.) + 1:)
      if (.not. is_same_file) return
      inquire (file=first, exist=is_there)
      is_same_file = is_there
      if (is_there) is_same_file = absolute_path(first) == absolute_path(second)
   end function is_same_file

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

end module amontons_batch_table
