!> NAME.sweep.csv: one row per case of a sweep, every number with the digits that it needs to be read back.
!>
!> Threads make rows side by side, without any function that returns a text: gfortran 12 keeps the length of such a text
!> in a place that all threads share.
module amontons_sweep_table
   use amontons_decimal, only: longest_decimal
   use amontons_sweep, only: sweep_t
   use amontons_sweep_statistics, only: case_result_t, outcome_names
   use amontons_text, only: csv_field, newline, put_decimals, read_integer
   implicit none (type, external)
   private

   public :: append_row, read_status_runs, status_runs, sweep_header

   !> Letters of the statuses, in the order of their numbers in `amontons_friction_law`.
   character(*), parameter :: letters = 'os+-'

contains

   !> The header.
   pure function sweep_header(sweep, keys) result(text)
      type(sweep_t), intent(in) :: sweep !! the sweep
      character(*), intent(in) :: keys(:) !! names of the numbers that are kept of a case
      character(:), allocatable :: text
      integer :: i

      text = 'case'
      do i = 1, size(sweep%axes)
         text = text//','//csv_field(sweep%axes(i)%label())
      end do
      do i = 1, size(keys)
         text = text//','//trim(keys(i))
      end do
      text = text//',residual,iterations,outcome,statuses'//newline
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
         rows = rows//numbers(:length)//','//trim(iterations)//','//trim(outcome_names(result%outcome))//','//runs &
            //newline
      else
         rows = rows//numbers(:length)//repeat(',', size(result%quantity) + 2)//trim(iterations)//','// &
            trim(outcome_names(result%outcome))//','//newline
      end if
   end subroutine append_row

   !> The statuses along the contact lines as run lengths, `4o 12+ 17s`: o open, s stick, + and - slip; a bar stands
   !> between two contact sets.
   pure subroutine status_runs(runs, status, set)
      character(:), allocatable, intent(out) :: runs !! the run lengths
      integer, intent(in) :: status(:) !! status of each point (m)
      integer, intent(in) :: set(:) !! contact set of each point (m)
      character(16) :: run
      integer :: first, p

      runs = ''
      first = 1
      do p = 1, size(status)
         if (p < size(status)) then
            if (status(p + 1) == status(p) .and. set(p + 1) == set(p)) cycle
         end if
         write (run, '(i0, a)') p - first + 1, letters(status(p):status(p))
         runs = runs//trim(run)
         first = p + 1
         if (p == size(status)) exit
         if (set(p + 1) /= set(p)) runs = runs//' |'
         runs = runs//' '
      end do
   end subroutine status_runs

   !> Reads statuses from their run lengths.
   pure subroutine read_status_runs(status, runs, ok)
      integer, intent(out) :: status(:) !! status of each point (m)
      character(*), intent(in) :: runs !! the run lengths
      logical, intent(out) :: ok !! whether they are those of m points
      integer :: first, last, length, n, state

      status = 0
      n = 0
      first = 1
      ok = .true.
      do while (ok .and. first <= len(runs))
         last = first + index(runs(first:)//' ', ' ') - 2
         if (runs(first:last) /= '|') then
            call read_integer(runs(first:last - 1), length, ok)
            state = index(letters, runs(max(last, 1):max(last, 1)))
            ok = ok .and. state > 0 .and. length > 0 .and. length <= size(status) - n
            if (ok) status(n + 1:n + length) = state
            if (ok) n = n + length
         end if
         first = last + 2
      end do
      ok = ok .and. n == size(status)
   end subroutine read_status_runs

end module amontons_sweep_table
