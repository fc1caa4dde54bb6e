!> NAME.sweep.csv: one row per case of a sweep, every number with the digits that it needs to be read back.
!>
!> Threads make rows side by side, without any function that returns a text: gfortran 12 keeps the length of such a text
!> in a place that all threads share.
module amontons_sweep_table
   use amontons_document, only: field
   use amontons_outcome_words, only: outcome_names
   use amontons_result_warnings, only: case_warning_names
   use amontons_sweep, only: sweep_t
   use amontons_sweep_statistics, only: case_result_t
   use amontons_text, only: longest_decimal, newline, put_decimals
   implicit none (type, external)
   private

   public :: append_row, read_warnings, sweep_header

contains

   !> The header.
   pure function sweep_header(sweep, keys) result(text)
      type(sweep_t), intent(in) :: sweep !! the sweep
      character(*), intent(in) :: keys(:) !! names of the numbers that are kept of a case
      character(:), allocatable :: text
      integer :: i

      text = 'case'
      do i = 1, size(sweep%axes)
         text = text//','//field(sweep%axes(i)%label())
      end do
      do i = 1, size(keys)
         text = text//','//trim(keys(i))
      end do
      text = text//',residual,iterations,outcome,warnings,statuses'//newline
   end function sweep_header

   !> Appends the row of a case; what a case without a solution has no number for is left empty.
   pure subroutine append_row(rows, sweep, number, result, runs)
      character(:), allocatable, intent(inout) :: rows !! the rows so far
      type(sweep_t), intent(in) :: sweep !! the sweep
      integer, intent(in) :: number !! number of the case
      type(case_result_t), intent(in) :: result !! its result
      character(*), intent(in) :: runs !! its `status_runs`
      character((longest_decimal + 1)*(size(sweep%axes) + size(result%quantity) + 2)) :: numbers
      character(11) :: iterations
      integer :: length

      write (iterations, '(i0)') result%n_iterations
      write (numbers, '(i0)') number
      length = len_trim(numbers)
      call put_decimals(numbers, length, sweep%values(number))
      if (result%has_solution) then
         call put_decimals(numbers, length, [result%quantity, result%residual])
         rows = rows//numbers(:length)//','//trim(iterations)//','//trim(outcome_names(result%outcome))//','
         call append_warnings(rows, result%is_warned)
         rows = rows//','//runs//newline
      else
         rows = rows//numbers(:length)//repeat(',', size(result%quantity) + 2)//trim(iterations)//','// &
            trim(outcome_names(result%outcome))//',,'//newline
      end if
   end subroutine append_row

   !> Appends the names of warnings, blanks between them.
   pure subroutine append_warnings(rows, is_warned)
      character(:), allocatable, intent(inout) :: rows !! the rows so far
      logical, intent(in) :: is_warned(:) !! which of `case_warning_names`
      integer :: i
      logical :: is_first

      is_first = .true.
      do i = 1, size(is_warned)
         if (.not. is_warned(i)) cycle
         if (.not. is_first) rows = rows//' '
         rows = rows//trim(case_warning_names(i))
         is_first = .false.
      end do
   end subroutine append_warnings

   !> Reads warnings from their names; others are passed over.
   pure subroutine read_warnings(is_warned, names)
      logical, intent(out) :: is_warned(size(case_warning_names)) !! which of `case_warning_names`
      character(*), intent(in) :: names !! the names, blanks between them
      integer :: i

      do i = 1, size(is_warned)
         is_warned(i) = index(' '//names//' ', ' '//trim(case_warning_names(i))//' ') > 0
      end do
   end subroutine read_warnings

end module amontons_sweep_table
