!> What is known of the cases of a sweep together: how many converged, and the extremes of their results.
module amontons_sweep_statistics
   use amontons_contact_solution, only: contact_solution_t
   use amontons_kinds, only: dp, int64
   use amontons_lengths, only: lengths_t
   use amontons_result_warnings, only: case_warning_names, case_warning_sentences
   use amontons_text, only: to_text
   use amontons_warning_list, only: warning_list_t
   implicit none (type, external)
   private

   public :: case_result_t, new_case_result, outcome_names, quantity_labels, sweep_statistics_t

   !> Outcome of a case that converged.
   integer, parameter, public :: case_converged = 1
   !> Outcome of a case whose residual stayed above the tolerance.
   integer, parameter, public :: case_not_converged = 2
   !> Outcome of a case whose loads no contact forces can balance.
   integer, parameter, public :: case_flies_off = 3
   !> Names of the outcomes, as the result files write them.
   character(13), parameter :: outcome_names(3) = [character(13) :: 'converged', 'not_converged', 'flies_off']
   !> Number of quantities whose extremes are kept.
   integer, parameter :: n_quantities = 5
   !> Names of these quantities, as the result files write them.
   character(16), parameter :: quantity_labels(n_quantities) = [character(16) :: 'open_length', 'slip_length', &
      'stick_length', 'normal_force', 'tangential_force']

   !> What is kept of one case.
   type :: case_result_t
      integer :: outcome = case_not_converged !! what became of it
      logical :: has_solution = .false. !! whether there are numbers to tell, and all are finite
      real(dp) :: quantity(n_quantities) = 0.0_dp
         !! lengths open, slip, stick [L]; sums of normal and of tangential forces [F]
      real(dp) :: residual = 0.0_dp !! residual of the contact problem [-]
      real(dp) :: error_estimate = 0.0_dp !! what residual and rounding errors are of its forces [-]
      integer :: n_iterations = 0 !! iterations, of all attempts
      logical :: is_warned(size(case_warning_names)) = .false. !! what is doubtful about it, if it converged
   end type case_result_t

   !> Counts and extremes of the first cases of a sweep. Extremes are those of converged cases.
   type :: sweep_statistics_t
      integer :: n_cases = 0 !! number of cases
      integer :: n_outcomes(size(outcome_names)) = 0 !! number of cases of each outcome
      integer(int64) :: n_iterations = 0 !! sum of their iterations
      real(dp) :: residual = -1.0_dp !! largest residual; -1 without a case [-]
      integer :: residual_case = 0 !! the case that has it
      real(dp) :: error_estimate = -1.0_dp !! largest error estimate of a converged case; -1 without a case [-]
      integer :: worst_case = 0 !! the first case that has it
      real(dp) :: least(n_quantities) = huge(1.0_dp) !! least value of each quantity [L, F]
      integer :: least_case(n_quantities) = 0 !! the first case that has it
      real(dp) :: greatest(n_quantities) = -huge(1.0_dp) !! greatest value of each quantity [L, F]
      integer :: greatest_case(n_quantities) = 0 !! the first case that has it
      integer :: n_warned(size(case_warning_names)) = 0 !! number of cases that each warning is about
      integer :: warned_case(size(case_warning_names)) = 0 !! the first of them
   contains
      procedure :: add => sweep_statistics_add
      procedure :: add_warnings => sweep_statistics_add_warnings
      procedure :: read => sweep_statistics_read
      procedure :: text => sweep_statistics_text
   end type sweep_statistics_t

contains

   !> Takes what is kept of a solved case from its solution.
   pure subroutine new_case_result(result, solution, lengths)
      type(case_result_t), intent(out) :: result !! what is kept
      type(contact_solution_t), intent(in) :: solution !! the solution
      type(lengths_t), intent(in) :: lengths !! its lengths

      associate (m => size(solution%status), force => solution%force)
         result%quantity = [lengths%open, lengths%slip, lengths%stick, sum(force(:m)), sum(force(m + 1:))]
      end associate
      result%residual = solution%residual
      result%n_iterations = solution%n_iterations
      result%has_solution = all(abs(result%quantity) <= huge(1.0_dp)) .and. result%residual < huge(1.0_dp)
      if (solution%is_converged) result%outcome = case_converged
   end subroutine new_case_result

   !> Adds the next case.
   pure subroutine sweep_statistics_add(self, result)
      class(sweep_statistics_t), intent(inout) :: self !! the statistics
      type(case_result_t), intent(in) :: result !! what is kept of the case
      integer :: i

      self%n_cases = self%n_cases + 1
      self%n_outcomes(result%outcome) = self%n_outcomes(result%outcome) + 1
      self%n_iterations = self%n_iterations + result%n_iterations
      if (result%outcome /= case_converged) return
      if (result%residual > self%residual) then
         self%residual = result%residual
         self%residual_case = self%n_cases
      end if
      where (result%is_warned .and. self%n_warned == 0) self%warned_case = self%n_cases
      where (result%is_warned) self%n_warned = self%n_warned + 1
      if (result%error_estimate > self%error_estimate) then
         self%error_estimate = result%error_estimate
         self%worst_case = self%n_cases
      end if
      do i = 1, n_quantities
         if (result%quantity(i) < self%least(i)) then
            self%least(i) = result%quantity(i)
            self%least_case(i) = self%n_cases
         end if
         if (result%quantity(i) > self%greatest(i)) then
            self%greatest(i) = result%quantity(i)
            self%greatest_case(i) = self%n_cases
         end if
      end do
   end subroutine sweep_statistics_add

   !> Adds a warning for each that cases of the sweep deserve.
   pure subroutine sweep_statistics_add_warnings(self, warnings)
      class(sweep_statistics_t), intent(in) :: self !! the statistics
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      integer :: i

      do i = 1, size(case_warning_names)
         if (self%n_warned(i) > 0) call warnings%add(to_text(self%n_warned(i))//' of '//to_text(self%n_cases)// &
            ' cases, case '//to_text(self%warned_case(i))//' the first: '//trim(case_warning_sentences(i)))
      end do
   end subroutine sweep_statistics_add_warnings

   !> The statistics as a line that `read` understands.
   pure function sweep_statistics_text(self) result(text)
      class(sweep_statistics_t), intent(in) :: self !! the statistics
      character(:), allocatable :: text
      integer :: i

      text = to_text(self%n_cases)//' '//to_text(self%n_iterations)
      do i = 1, size(outcome_names)
         text = text//' '//to_text(self%n_outcomes(i))
      end do
      text = text//' '//to_text(self%residual_case)//' '//to_text(self%residual) &
         //' '//to_text(self%worst_case)//' '//to_text(self%error_estimate)
      do i = 1, n_quantities
         text = text//' '//to_text(self%least_case(i))//' '//to_text(self%least(i)) &
            //' '//to_text(self%greatest_case(i))//' '//to_text(self%greatest(i))
      end do
      do i = 1, size(case_warning_names)
         text = text//' '//to_text(self%n_warned(i))//' '//to_text(self%warned_case(i))
      end do
   end function sweep_statistics_text

   !> Reads a statistics from its line.
   pure subroutine sweep_statistics_read(self, text, ok)
      class(sweep_statistics_t), intent(inout) :: self !! the statistics
      character(*), intent(in) :: text !! the line
      logical, intent(out) :: ok !! whether it is the line of a statistics
      integer :: status, i

      read (text, *, iostat=status) self%n_cases, self%n_iterations, self%n_outcomes, self%residual_case, &
         self%residual, self%worst_case, self%error_estimate, &
         (self%least_case(i), self%least(i), self%greatest_case(i), self%greatest(i), i=1, n_quantities), &
         (self%n_warned(i), self%warned_case(i), i=1, size(case_warning_names))
      ok = status == 0
   end subroutine sweep_statistics_read

end module amontons_sweep_statistics
