!> OUTPUT/batch.csv: one row for each deck of a batch, whatever became of it; and the tally of a run.
!>
!> Several runs may work on one folder at the same time: each replaces the rows of its own decks, and all others stay.
!> The file is read and written again while the folder is locked, and it is replaced as a whole.
module amontons_batch_table
   use amontons_error, only: error_t
   use amontons_file_lock, only: file_lock_t, lock_directory
   use amontons_listing_text, only: scientific
   use amontons_outcome, only: outcome_t
   use amontons_output_file, only: output_file_t, write_text_file
   use amontons_quantity, only: value_of
   use amontons_row_text, only: field
   use amontons_system, only: make_directory
   use amontons_text, only: newline, to_text
   use amontons_text_file, only: read_text_file
   implicit none (type, external)
   private

   public :: tally_text, update_batch_table

   !> Numbers of a result that the table has, where there is a result.
   character(20), parameter :: number_keys(*) = [character(20) :: 'iterations', 'residual', 'max_contact_pressure', &
      'max_von_mises', 'max_displacement', 'normal_force', 'tangential_force']
   !> Outcomes, as the table has them.
   character(17), parameter :: outcome_words(*) = [character(17) :: 'solved', 'checked', 'unchanged', &
      'no_equilibrium', 'not_converged', 'not_certified', 'refused', 'numerical_failure', 'system_failure', &
      'interrupted']
   !> Outcomes, as the tally has them.
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

   !> Puts the rows of decks into the table.
   subroutine update_batch_table(directory, outcomes, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(outcome_t), intent(in) :: outcomes(:) !! what became of the decks
      type(error_t), allocatable, intent(out) :: error !! the table cannot be written
      type(output_file_t) :: file
      type(file_lock_t) :: lock
      character(:), allocatable :: text
      integer :: i

      call make_directory(directory, error)
      if (allocated(error)) return
      call lock_directory(lock, directory//'/')
      call read_rows(directory//'/batch.csv', text)
      do i = 1, size(outcomes)
         call put_row(text, outcomes(i))
      end do
      call write_text_file(file, directory//'/batch.csv', header()//text, error)
      if (.not. allocated(error)) call file%commit(error)
      call lock%release()
   end subroutine update_batch_table

   !> The first line.
   pure function header() result(text)
      character(:), allocatable :: text
      integer :: i

      text = 'deck,case,outcome,exit_status'
      do i = 1, size(number_keys)
         text = text//','//trim(number_keys(i))
      end do
      text = text//',seconds,message'//newline
   end function header

   !> Reads the rows that are there; none where there is no table, or one of another version.
   subroutine read_rows(path, rows)
      character(*), intent(in) :: path !! name of the table
      character(:), allocatable, intent(out) :: rows !! the rows, lines of text
      type(error_t), allocatable :: error

      call read_text_file(path, rows, error)
      if (.not. allocated(error)) then
         if (index(rows, header()) == 1 .and. rows(len(rows):) == newline) then
            rows = rows(len(header()) + 1:)
            return
         end if
      end if
      rows = ''
   end subroutine read_rows

   !> Replaces the row of a deck, or appends it. A deck whose results are unchanged keeps its row.
   pure subroutine put_row(rows, outcome)
      character(:), allocatable, intent(inout) :: rows !! the rows
      type(outcome_t), intent(in) :: outcome !! what became of the deck
      character(:), allocatable :: start
      integer :: first, last

      start = field(outcome%deck)//','
      first = index(newline//rows, newline//start)
      if (first == 0) then
         rows = rows//row_text(outcome)
         return
      end if
      if (outcome%word == 'unchanged' .and. index(rows(first:), start//field(outcome%name)//',solved,') == 1) return
      last = first + index(rows(first:), newline) - 1
      rows = rows(:first - 1)//row_text(outcome)//rows(last + 1:)
   end subroutine put_row

   !> The row of a deck. Its message is one line.
   pure function row_text(outcome) result(text)
      type(outcome_t), intent(in) :: outcome !! what became of the deck
      character(:), allocatable :: text
      integer :: i

      text = field(outcome%deck)//','//field(outcome%name)//','
      if (outcome%word == 'unchanged') then
         text = text//'solved'
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
   end function row_text

   !> A text of several lines as one.
   pure function one_line(lines) result(text)
      character(*), intent(in) :: lines !! the lines
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, len(lines)
         if (lines(i:i) == newline) then
            text = text//'; '
         else
            text = text//lines(i:i)
         end if
      end do
   end function one_line

end module amontons_batch_table
