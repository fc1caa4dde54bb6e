!> Parts of the rows of tables: names as fields, the statuses of all contact points in one field.
!>
!> Threads make rows side by side, without any function that returns a text: gfortran 12 keeps the length of such a text
!> in a place that all threads share.
module amontons_row_text
   use amontons_text, only: read_integer, replaced
   implicit none (type, external)
   private

   public :: field, read_status_runs, status_runs

   !> Letters of the statuses, in the order of their numbers in `amontons_friction_law`.
   character(*), parameter :: letters = 'os+-'

contains

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

   !> A text as a field of the table, in quotes where it needs them.
   pure function field(value) result(text)
      character(*), intent(in) :: value !! the text
      character(:), allocatable :: text

      text = value
      if (scan(value, ',"') > 0) text = '"'//replaced(value, '"', '""')//'"'
   end function field

end module amontons_row_text
