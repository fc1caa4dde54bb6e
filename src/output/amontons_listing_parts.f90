!> What the listings of decks, sweeps and reduced problems have in common: the head, the method and what became of it,
!> the verdict, the times.
module amontons_listing_parts
   use amontons_case_label, only: case_label_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_kinds, only: dp
   use amontons_listing_text, only: flush_right, heading, labeled, pair_text, scientific, short_text, with_unit
   use amontons_methods, only: method_options_t
   use amontons_quantity, only: quantity_t
   use amontons_text, only: counted, newline, to_text
   use amontons_timings, only: phase_names, timings_t
   use amontons_version, only: version
   use amontons_warning_list, only: warning_list_t
   implicit none (type, external)
   private

   public :: closed_text, head_text, method_text, outcome_text, quantities_text, residual_text, status_counts, &
      times_text, violations_text, warnings_text

contains

   !> Program, case and deck.
   pure function head_text(label) result(text)
      class(case_label_t), intent(in) :: label !! what the case is called
      character(:), allocatable :: text

      text = 'Amontons '//version//': plane contact with Coulomb friction by the dual method'//newline//newline// &
         labeled('Case', label%name)//labeled('Title', label%title)
      if (allocated(label%file)) text = text//labeled('Deck', label%file)
      if (len(label%units) > 0) text = text//labeled('Units', label%units)
   end function head_text

   !> The method with the options that it uses.
   pure function method_text(method) result(text)
      type(method_options_t), intent(in) :: method !! the method and its options
      character(:), allocatable :: text

      text = trim(method%method)
      select case (text)
      case ('splitting')
         text = text//', variant '//trim(method%variant)//', quadratic programs by '//trim(method%box)
      case ('fixed_point')
         text = text//', quadratic programs by '//trim(method%box)
      case ('psor')
         text = text//', omega '//short_text(method%omega)//', '//trim(method%space)//' space, local '// &
            trim(method%local)//', acceleration '//trim(method%acceleration)
      case default
         continue
      end select
   end function method_text

   !> Whether the method converged, and what its answer is worth if it did not.
   pure function outcome_text(solution) result(text)
      type(contact_solution_t), intent(in) :: solution !! the solution and its record
      character(:), allocatable :: text

      if (solution%is_converged) then
         text = labeled('Converged', 'yes, in '//counted(solution%n_iterations, 'iteration'))
         return
      end if
      text = labeled('Converged', 'NO: stopped after '//counted(solution%n_iterations, 'iteration')// &
         '; the results below are not the solution')
      if (solution%is_at_rest) text = text// &
         labeled('Note', 'iteration stagnated at a wrong answer: the forces do not satisfy the contact law')
   end function outcome_text

   !> The residual, at the end and after each iteration; of many iterations about twenty.
   pure function residual_text(solution, tolerance) result(text)
      type(contact_solution_t), intent(in) :: solution !! the solution and its record
      real(dp), intent(in) :: tolerance !! tolerance of the contact method [-]
      character(:), allocatable :: text
      integer, parameter :: n_lines = 20
      integer :: i, stride

      text = labeled('Residual', scientific(solution%residual)//', tolerance '//scientific(tolerance))// &
         labeled('Residual history', 'iteration, residual')
      stride = max(1, solution%n_iterations/n_lines)
      do i = 1, solution%n_iterations
         if (i /= 1 .and. i /= solution%n_iterations .and. mod(i, stride) /= 0) cycle
         text = text//labeled('', flush_right(to_text(i), len('iteration'))//'  '//scientific(solution%history(i)))
      end do
   end function residual_text

   !> How many points have each status.
   pure function status_counts(status) result(text)
      integer, intent(in) :: status(:) !! statuses of the points
      character(:), allocatable :: text

      text = to_text(count(status == open_point))//' open, '//to_text(count(status == slip_plus))//' slip+, '// &
         to_text(count(status == slip_minus))//' slip-, '//to_text(count(status == stick_point))//' stick'
   end function status_counts

   !> How many points are closed.
   pure function closed_text(status) result(text)
      integer, intent(in) :: status(:) !! statuses of the points
      character(:), allocatable :: text

      text = to_text(count(status /= open_point))//' of '//to_text(size(status))//' points closed'
   end function closed_text

   !> What a solution must fulfil, a line on each violation, and the verdict.
   pure function violations_text(violations, limit) result(text)
      type(quantity_t), intent(in) :: violations(:) !! the violations, each over its natural scale [-]
      real(dp), intent(in) :: limit !! what each may be at most [-]
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(violations)
         text = text//labeled(violations(i)%label, scientific(violations(i)%value)//trim(merge('        ', '  FAILED', &
            violations(i)%value <= limit)))
      end do
      text = text//labeled('Verdict', trim(merge('passed', 'FAILED', all(violations%value <= limit)))// &
         ': every violation must be at most '//scientific(limit))
   end function violations_text

   !> The warnings, a line each.
   pure function warnings_text(warnings) result(text)
      type(warning_list_t), intent(in) :: warnings !! the warnings
      character(:), allocatable :: text
      integer :: i

      text = heading('Warnings')
      if (warnings%n() == 0) text = text//labeled('Warnings', 'none')
      do i = 1, warnings%n()
         text = text//labeled('Warning', warnings%item(i))
      end do
   end function warnings_text

   !> Quantities, a line each.
   pure function quantities_text(quantities, units) result(text)
      type(quantity_t), intent(in) :: quantities(:) !! the quantities
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text, number
      integer :: i

      text = ''
      do i = 1, size(quantities)
         associate (quantity => quantities(i))
            number = with_unit(short_text(quantity%value), units, trim(quantity%dimension))
            if (quantity%has_place) number = number//' at '//pair_text(quantity%place)
            text = text//labeled(quantity%label, number)
         end associate
      end do
   end function quantities_text

   !> Where the time went, and the end of the listing.
   pure function times_text(timings, phases) result(text)
      type(timings_t), intent(in) :: timings !! the times
      integer, intent(in) :: phases(:) !! the phases to be listed
      character(:), allocatable :: text
      character(10) :: seconds
      integer :: i

      text = heading('Time [s]')
      do i = 1, size(phases)
         write (seconds, '(f10.4)') timings%seconds(phases(i))
         text = text//labeled(trim(phase_names(phases(i))), seconds)
      end do
      text = text//newline//'End of listing'//newline
   end function times_text

end module amontons_listing_parts
