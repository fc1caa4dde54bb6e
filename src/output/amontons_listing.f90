!> NAME.lst: the listing, which an engineer reads top to bottom and needs nothing else; and what the listings of decks,
!> sweeps and reduced problems have in common: the head, the method and what became of it, the verdict, the times.
module amontons_listing
   use amontons_accuracy_text, only: convergence_text
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_certificate, only: certificate_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_contact_table, only: column_t, contact_columns, points_text
   use amontons_document, only: document_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp
   use amontons_listing_model, only: model_text
   use amontons_listing_text, only: flush_right, heading, labeled, pair_text, scientific, short_text, with_unit
   use amontons_methods, only: method_options_t
   use amontons_quantity, only: quantity_t
   use amontons_result, only: certificate_limit, result_t
   use amontons_solutions_report, only: solutions_text, uniqueness_text
   use amontons_text, only: counted, newline, to_text
   use amontons_timings, only: phase_assemble, phase_condense, phase_factorize, phase_names, phase_read, &
      phase_recover, phase_solve, timings_t
   use amontons_version, only: version
   use amontons_warning_list, only: warning_list_t
   use amontons_zone_edges, only: interval_t
   implicit none (type, external)
   private

   public :: certificate_text, closed_text, factorization_text, head_text, listed_phases, method_text, new_listing, &
      outcome_text, quantities_text, residual_text, status_counts, times_text, violations_text, warnings_text

   !> The phases that lie behind a deck when its listing is written.
   integer, parameter :: listed_phases(*) = [phase_read, phase_assemble, phase_factorize, phase_condense, phase_solve, &
      phase_recover]

contains

   !> Makes the listing.
   subroutine new_listing(listing, label, body, result)
      type(document_t), intent(out) :: listing !! the listing
      class(case_label_t), intent(in) :: label !! what the case is called
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)

      listing%ending = '.lst'
      call listing%record(head_text(label))
      associate (solution => result%solution)
         if (.not. allocated(result%answer)) call listing%add(heading('Key results')// &
            quantities_text(result%key_results, label%units)//counts_text(solution%status), &
            [maxval([force_scale(result), result%key_results%scale])])
         call listing%add(warnings_text(result%warnings))
         call listing%add(model_text(body, result%load_case, label%units))
         if (allocated(result%answer)) call listing%add(heading('Solution')//'  '//result%answer//newline)
         if (allocated(result%answer)) return
         call contact_columns(columns, body, result)
         call listing%append(result%study_listing)
         call listing%record(solution_text(body, result))
         if (allocated(result%convergence)) call listing%add(convergence_text(result%convergence, label%units))
         if (body%zone%n_points > 0) call listing%add(zones_text(result, label%units), [line_scale(body)])
         call listing%add(resultants_text(result, label%units), [force_scale(result)])
         call listing%add(certificate_text(result%certificate, result%method%tolerance), [1.0_dp])
         if (allocated(result%error_estimate)) call listing%add( &
            heading('Accuracy (energy norm of the stress error)')// &
            quantities_text(result%error_estimate%quantities(), label%units))
         if (body%zone%n_points > 0) call listing%add(points_text('Contact points (normal: compression positive; '// &
            'tangential: positive along t)', columns, solution%status, label%units), &
            [0.0_dp, pack(columns%scale, columns%label /= ''), 0.0_dp])
      end associate
      call listing%record(times_text(result%timings, listed_phases))
   end subroutine new_listing

   !> The contact points by status; nothing where there are none.
   pure function counts_text(status) result(text)
      integer, intent(in) :: status(:) !! statuses of the points
      character(:), allocatable :: text

      text = ''
      if (size(status) > 0) text = labeled('Points', to_text(size(status))//': '//status_counts(status))
   end function counts_text

   !> What places along the contact line are measured by [L].
   pure real(dp) function line_scale(body) result(scale)
      type(body_t), intent(in) :: body !! the body

      scale = max(0.0_dp, maxval(abs(body%zone%position)))
   end function line_scale

   !> What sums of forces and energies are measured by.
   pure real(dp) function force_scale(result) result(scale)
      type(result_t), intent(in) :: result !! the result

      scale = max(sum(abs(result%load_case%force)), sum(abs(result%solution%force)), result%certificate%strain_energy)
   end function force_scale

   !> How the contact problem was solved.
   function solution_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (solution => result%solution)
         text = heading('Solution')//labeled('Method', method_text(result%method))// &
            labeled('Factorization', factorization_text(result))
         if (allocated(result%started_from)) text = text//labeled('Started from', 'case '//result%started_from)
         text = text//outcome_text(solution)
         if (result%method_error >= 0.0_dp) text = text//labeled('Error of method', scientific(result%method_error)// &
            ' of the largest contact force, against the exact solution')
         text = text//residual_text(solution, result%method%tolerance)// &
            uniqueness_text(result%uniqueness, &
            merge(0.0_dp, result%load_case%friction, body%zone%is_tangent_fixed))
         if (allocated(result%all_solutions)) text = text// &
            solutions_text(result%all_solutions, solution%force)
      end associate
   end function solution_text

   !> The factorization in use, its size, and the case it was made for.
   pure function factorization_text(result) result(text)
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      text = ''
      if (allocated(result%factor%name)) text = result%factor%name//', '//to_text(result%factor%n_entries)//' entries'
      if (allocated(result%shared_with)) text = text//', shared with case '//result%shared_with
   end function factorization_text

   !> Counts and lengths of the open, slip and stick zones.
   pure function zones_text(result, units) result(text)
      type(result_t), intent(in) :: result !! the result
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      text = heading('Contact line')//counts_text(result%solution%status)// &
         quantities_text(result%lengths%quantities(), units)// &
         intervals_text('Closed zone', result%closed, units)//intervals_text('Stick zone', result%stuck, units)
   end function zones_text

   !> Parts of the contact line, a line each.
   pure function intervals_text(label, intervals, units) result(text)
      character(*), intent(in) :: label !! what they are
      type(interval_t), intent(in) :: intervals(:) !! the parts
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(intervals)
         text = text//labeled(label, pair_text(intervals(i)%ends(:, 1))//' to '//pair_text(intervals(i)%ends(:, 2))// &
            with_unit(', length '//short_text(intervals(i)%length), units, 'L'))
      end do
   end function intervals_text

   !> Resultants of all forces.
   pure function resultants_text(result, units) result(text)
      type(result_t), intent(in) :: result !! the result
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text

      associate (certificate => result%certificate)
         text = heading('Resultants')// &
            labeled('Loads', with_unit(pair_text(certificate%load), units, 'F'))// &
            labeled('Support reactions', with_unit(pair_text(certificate%reaction), units, 'F'))// &
            labeled('Contact forces', with_unit(pair_text(certificate%contact), units, 'F'))// &
            quantities_text([resultants(result%solution%force), certificate%energies()], units)
      end associate
   end function resultants_text

   !> The certificate in words.
   pure function certificate_text(certificate, tolerance) result(text)
      type(certificate_t), intent(in) :: certificate !! the certificate
      real(dp), intent(in) :: tolerance !! tolerance of the contact method [-]
      character(:), allocatable :: text

      text = heading('Checks on the full model (relative errors)') &
         //violations_text(certificate%violations(), certificate_limit(tolerance))
   end function certificate_text

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

   !> What a solution must fulfill, a line on each violation, and the verdict.
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

end module amontons_listing
