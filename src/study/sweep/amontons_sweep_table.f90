!> The rows of a sweep: what is kept of a case, NAME.sweep.csv, and what is known of all cases together: how many
!> converged, and the extremes of their results.
!>
!> Threads make rows side by side, without any function that returns a text: gfortran 12 keeps the length of such a text
!> in a place that all threads share.
module amontons_sweep_table
   use amontons_body, only: body_t
   use amontons_checkpoint, only: milestone_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_contact_zone, only: contact_zone_t
   use amontons_document, only: field
   use amontons_error, only: warning_list_t
   use amontons_key_results, only: body_peaks_at_rest, contact_peaks, find_zones, lengths_t, new_lengths, resultants, &
      set_results
   use amontons_kinds, only: dp, int64
   use amontons_quantity, only: expanded, quantity_t
   use amontons_result, only: outcome_names, outcome_no_equilibrium, outcome_not_converged, outcome_solved
   use amontons_result_warnings, only: case_warning_names, case_warning_sentence
   use amontons_sweep, only: sweep_t
   use amontons_text, only: longest_decimal, newline, put_decimals, to_text
   use amontons_zone_edges, only: interval_t
   implicit none (type, external)
   private

   public :: append_row, case_keys, case_quantities, case_result_t, outcome_labels, ranked_quantities, read_warnings, &
      set_numbers, sweep_header, sweep_statistics_t

   !> Names of the outcomes, as listings have them.
   character(14), parameter :: outcome_labels(3) = [character(14) :: 'Converged', 'NOT CONVERGED', 'No equilibrium']

   !> What is kept of one case.
   type :: case_result_t
      integer :: outcome = outcome_not_converged !! what became of it
      logical :: has_solution = .false. !! whether there are numbers to tell, and all are finite
      real(dp), allocatable :: quantity(:) !! the numbers that `case_keys` names
      real(dp) :: residual = 0.0_dp !! residual of the contact problem [-]
      real(dp) :: force_error = 0.0_dp !! what residual and rounding errors are of its forces [-]
      integer :: n_iterations = 0 !! iterations, of all attempts
      logical :: is_warned(size(case_warning_names)) = .false. !! what is doubtful about it, if it converged
   end type case_result_t

   !> Counts and extremes of the first cases of a sweep. Extremes are those of converged cases.
   type, extends(milestone_t) :: sweep_statistics_t
      integer :: n_cases = 0 !! number of cases
      integer :: n_outcomes(size(outcome_names)) = 0 !! number of cases of each outcome
      integer(int64) :: n_iterations = 0 !! sum of their iterations
      real(dp) :: residual = -1.0_dp !! largest residual; -1 without a case [-]
      integer :: residual_case = 0 !! the case that has it
      real(dp) :: force_error = -1.0_dp !! largest error estimate of a converged case; -1 without a case [-]
      integer :: worst_case = 0 !! the first case that has it
      real(dp), allocatable :: least(:) !! least value of each number of a case; not allocated without a case
      integer, allocatable :: least_case(:) !! the first case that has it
      real(dp), allocatable :: greatest(:) !! greatest value of each number of a case
      integer, allocatable :: greatest_case(:) !! the first case that has it
      integer :: n_warned(size(case_warning_names)) = 0 !! number of cases that each warning is about
      integer :: warned_case(size(case_warning_names)) = 0 !! the first of them
   contains
      procedure :: add => sweep_statistics_add
      procedure :: add_warnings => sweep_statistics_add_warnings
      procedure :: append => sweep_statistics_append
      procedure :: is_answered => sweep_statistics_is_answered
      procedure :: outcome => sweep_statistics_outcome
      procedure :: read => sweep_statistics_read
      procedure :: text => sweep_statistics_text
   end type sweep_statistics_t

contains

   !> What is kept of a case: lengths, sums of forces, key results of the contact points and, if they are asked for, of
   !> the body.
   pure function case_quantities(body, solution, friction, slip_bound, free_gap, peaks) result(list)
      type(body_t), intent(in) :: body !! the body
      type(contact_solution_t), intent(in) :: solution !! the solution
      real(dp), intent(in) :: friction(:) !! Coulomb coefficients of the points (m) [-]
      real(dp), intent(in) :: slip_bound(:) !! given bounds of their tangential forces (m) [F]
      real(dp), intent(in) :: free_gap(:) !! their gaps without displacements, d (m) [L]
      type(quantity_t), intent(in) :: peaks(:) !! `body_peaks`, or nothing
      type(quantity_t), allocatable :: list(:)
      type(interval_t), allocatable :: closed(:), stuck(:)
      type(lengths_t) :: lengths

      call new_lengths(lengths, body%zone, solution%status)
      associate (gap => free_gap - solution%displacement(:size(solution%status)), &
         slip => solution%displacement(size(solution%status) + 1:))
         call find_zones(closed, stuck, body, solution%force, solution%status, &
            slip_bound + friction*solution%force(:size(friction)), [gap, slip], solution%displacement)
         list = [lengths%quantities(), resultants(solution%force), contact_peaks(body, slip, solution%force, &
            solution%status, maxval(abs(solution%displacement))), &
            set_results(body, solution%force, closed, stuck), peaks]
      end associate
   end function case_quantities

   !> The names of the numbers that are kept of a case, in the order of the columns of NAME.sweep.csv.
   pure function case_keys(body, sweep) result(keys)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      character(32), allocatable :: keys(:)
      type(quantity_t), allocatable :: list(:)

      list = expanded(ranked_quantities(body, sweep))
      keys = list%key
   end function case_keys

   !> What cases can be ranked by: all that is kept of a case but the places. The values are those of a case that
   !> nothing loads.
   pure function ranked_quantities(body, sweep) result(list)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(quantity_t), allocatable :: list(:), peaks(:)
      type(contact_solution_t) :: solution
      real(dp) :: zeros(body%zone%n_points)

      call new_contact_solution(solution, body%zone%n_points)
      zeros = 0.0_dp
      peaks = body_peaks_at_rest()
      if (.not. sweep%has_body_results) peaks = peaks(:0)
      list = case_quantities(body, solution, zeros, zeros, zeros, peaks)
   end function ranked_quantities

   !> Sets the numbers of a case from its solution.
   pure subroutine set_numbers(result, body, solution, friction, slip_bound, free_gap, peaks)
      type(case_result_t), intent(inout) :: result !! what is kept; gains the numbers
      type(body_t), intent(in) :: body !! the body
      type(contact_solution_t), intent(in) :: solution !! the solution
      real(dp), intent(in) :: friction(:) !! Coulomb coefficients of the points (m) [-]
      real(dp), intent(in) :: slip_bound(:) !! given bounds of their tangential forces (m) [F]
      real(dp), intent(in) :: free_gap(:) !! their gaps without displacements, d (m) [L]
      type(quantity_t), intent(in) :: peaks(:) !! `body_peaks`, or nothing
      type(quantity_t), allocatable :: list(:)

      list = expanded(case_quantities(body, solution, friction, slip_bound, free_gap, peaks))
      result%quantity = list%value
      result%has_solution = all(abs(result%quantity) <= huge(1.0_dp)) .and. result%residual < huge(1.0_dp)
      if (result%has_solution) return
      ! What leaves the range of numbers is no solution, however small its residual.
      result%outcome = outcome_not_converged
      result%is_warned = .false.
   end subroutine set_numbers

   !> Adds the next case.
   pure subroutine sweep_statistics_add(self, result)
      class(sweep_statistics_t), intent(inout) :: self !! the statistics
      type(case_result_t), intent(in) :: result !! what is kept of the case
      type(sweep_statistics_t) :: one

      one%n_cases = 1
      one%n_outcomes(result%outcome) = 1
      one%n_iterations = result%n_iterations
      if (result%outcome == outcome_solved) then
         one%residual = result%residual
         one%residual_case = 1
         one%force_error = result%force_error
         one%worst_case = 1
         one%least = result%quantity
         one%greatest = result%quantity
         one%least_case = spread(1, 1, size(result%quantity))
         one%greatest_case = one%least_case
         one%n_warned = merge(1, 0, result%is_warned)
         one%warned_case = one%n_warned
      end if
      call self%append(one)
   end subroutine sweep_statistics_add

   !> Appends the statistics of the next cases, numbered from 1 there. Of equal cases the first counts.
   pure subroutine sweep_statistics_append(self, next)
      class(sweep_statistics_t), intent(inout) :: self !! the statistics
      type(sweep_statistics_t), intent(in) :: next !! those of the next cases
      integer :: n

      n = self%n_cases
      self%n_cases = n + next%n_cases
      self%n_outcomes = self%n_outcomes + next%n_outcomes
      self%n_iterations = self%n_iterations + next%n_iterations
      if (next%residual_case == 0) return
      where (self%n_warned == 0 .and. next%n_warned > 0) self%warned_case = n + next%warned_case
      self%n_warned = self%n_warned + next%n_warned
      if (self%residual_case == 0 .or. next%residual > self%residual) then
         self%residual = next%residual
         self%residual_case = n + next%residual_case
      end if
      if (self%worst_case == 0 .or. next%force_error > self%force_error) then
         self%force_error = next%force_error
         self%worst_case = n + next%worst_case
      end if
      if (.not. allocated(self%least)) then
         self%least = next%least
         self%greatest = next%greatest
         self%least_case = n + next%least_case
         self%greatest_case = n + next%greatest_case
      end if
      where (next%least < self%least)
         self%least = next%least
         self%least_case = n + next%least_case
      end where
      where (next%greatest > self%greatest)
         self%greatest = next%greatest
         self%greatest_case = n + next%greatest_case
      end where
   end subroutine sweep_statistics_append

   !> Adds a warning for each that cases of the sweep deserve.
   pure subroutine sweep_statistics_add_warnings(self, zone, warnings)
      class(sweep_statistics_t), intent(in) :: self !! the statistics
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      integer :: i

      do i = 1, size(case_warning_names)
         if (self%n_warned(i) > 0) call warnings%add(to_text(self%n_warned(i))//' of '//to_text(self%n_cases)// &
            ' cases, case '//to_text(self%warned_case(i))//' the first: '//case_warning_sentence(i, zone))
      end do
   end subroutine sweep_statistics_add_warnings

   !> Whether every case has its answer: a solution, or that there is no equilibrium.
   pure logical function sweep_statistics_is_answered(self) result(is_answered)
      class(sweep_statistics_t), intent(in) :: self !! the statistics

      is_answered = self%n_outcomes(outcome_not_converged) == 0
   end function sweep_statistics_is_answered

   !> What became of the cases together, in a word: one that did not converge counts first, no equilibrium only where no
   !> case has one.
   pure function sweep_statistics_outcome(self) result(word)
      class(sweep_statistics_t), intent(in) :: self !! the statistics
      character(:), allocatable :: word

      if (self%n_outcomes(outcome_not_converged) > 0) then
         word = trim(outcome_names(outcome_not_converged))
      else if (self%n_outcomes(outcome_solved) == 0) then
         word = trim(outcome_names(outcome_no_equilibrium))
      else
         word = trim(outcome_names(outcome_solved))
      end if
   end function sweep_statistics_outcome

   !> The statistics as a line that `read` understands.
   pure function sweep_statistics_text(self) result(text)
      class(sweep_statistics_t), intent(in) :: self !! the statistics
      character(:), allocatable :: text
      integer :: n, i

      n = 0
      if (allocated(self%least)) n = size(self%least)
      text = to_text(self%n_cases)//' '//to_text(n)//' '//to_text(self%n_iterations)
      do i = 1, size(outcome_names)
         text = text//' '//to_text(self%n_outcomes(i))
      end do
      text = text//' '//to_text(self%residual_case)//' '//to_text(self%residual) &
         //' '//to_text(self%worst_case)//' '//to_text(self%force_error)
      do i = 1, size(case_warning_names)
         text = text//' '//to_text(self%n_warned(i))//' '//to_text(self%warned_case(i))
      end do
      do i = 1, n
         text = text//' '//to_text(self%least_case(i))//' '//to_text(self%least(i)) &
            //' '//to_text(self%greatest_case(i))//' '//to_text(self%greatest(i))
      end do
   end function sweep_statistics_text

   !> Reads a statistics from its line.
   pure subroutine sweep_statistics_read(self, text, ok)
      class(sweep_statistics_t), intent(inout) :: self !! the statistics
      character(*), intent(in) :: text !! the line
      logical, intent(out) :: ok !! whether it is the line of a statistics
      integer :: n, status, i

      read (text, *, iostat=status) self%n_cases, n
      ! Each number takes at least two characters.
      ok = status == 0 .and. n >= 0 .and. n < len(text)
      if (.not. ok) return
      if (allocated(self%least)) deallocate (self%least, self%greatest, self%least_case, self%greatest_case)
      if (n > 0) allocate (self%least(n), self%greatest(n), self%least_case(n), self%greatest_case(n))
      read (text, *, iostat=status) self%n_cases, n, self%n_iterations, self%n_outcomes, self%residual_case, &
         self%residual, self%worst_case, self%force_error, &
         (self%n_warned(i), self%warned_case(i), i=1, size(case_warning_names)), &
         (self%least_case(i), self%least(i), self%greatest_case(i), self%greatest(i), i=1, n)
      ok = status == 0
   end subroutine sweep_statistics_read

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
