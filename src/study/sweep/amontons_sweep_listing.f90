!> NAME.lst of a sweep: the model, what varies, and what became of the cases together.
module amontons_sweep_listing
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_document, only: document_t
   use amontons_kinds, only: dp
   use amontons_listing, only: certificate_text, factorization_text, head_text, listed_phases, method_text, &
      model_text, quantities_text, times_text, warnings_text
   use amontons_outcome_words, only: outcome_solved
   use amontons_quantity, only: quantity_t
   use amontons_solve_sweep, only: sweep_result_t
   use amontons_sweep, only: sweep_axis_t, sweep_t, swept_load
   use amontons_sweep_statistics, only: outcome_labels, ranked_quantities, sweep_statistics_t
   use amontons_text, only: counted, flush_right, heading, labeled, newline, scientific, short_text, to_text, &
      with_unit
   implicit none (type, external)
   private

   public :: new_sweep_listing

contains

   !> Makes the listing.
   subroutine new_sweep_listing(listing, config, body, result)
      type(document_t), intent(out) :: listing !! the listing
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result

      listing%ending = '.lst'
      call listing%record(head_text(config))
      associate (certified => result%certified, statistics => result%statistics)
         call listing%add(warnings_text(certified%warnings))
         call listing%add(model_text(body, certified%load_case, config%units)//sweep_text(config))
         call listing%record(solution_text(config, result))
         if (statistics%residual_case > 0) then
            call listing%add(extremes_text(ranked_quantities(body, config%sweep), statistics, config%units))
            call add_certificate(listing, result, config%units)
         end if
         call listing%record(times_text(certified%timings, listed_phases))
      end associate
   end subroutine new_sweep_listing

   !> Adds the certificate of the case with the largest error estimate, and how accurate its stresses are.
   subroutine add_certificate(listing, result, units)
      type(document_t), intent(inout) :: listing !! the listing
      type(sweep_result_t), intent(in) :: result !! the result
      character(*), intent(in) :: units !! names of the units
      character(:), allocatable :: text

      text = certificate_text(result%certified%certificate, result%certified%method%tolerance)// &
         labeled('Worst case', to_text(result%statistics%worst_case)//', by the estimated error of its forces')
      if (allocated(result%certified%error_estimate)) text = text//heading('Accuracy of the worst case '// &
         '(energy norm of the stress error)')//quantities_text(result%certified%error_estimate%quantities(), units)
      if (result%has_certificate) then
         call listing%add(text, [1.0_dp])
      else
         call listing%record(text)
      end if
   end subroutine add_certificate

   !> What varies, and in which combination.
   pure function sweep_text(config) result(text)
      type(config_t), intent(in) :: config !! the deck
      character(:), allocatable :: text
      integer :: i

      text = heading('Sweep')
      do i = 1, size(config%sweep%axes)
         associate (axis => config%sweep%axes(i))
            text = text//labeled(trim(merge('along with', 'vary      ', axis%is_paired)), axis_text(axis))
         end associate
      end do
      text = text//labeled('Cases', to_text(config%sweep%n_cases())//', row by row in '//config%name//'.sweep.csv')
      if (config%sweep%n_fields() > 0) text = text//labeled('Fields', 'of '//to_text(config%sweep%n_fields())// &
         ' cases, those that converged, in '//config%name//'.sweep.pvd')
   end function sweep_text

   !> A quantity and its values; of many values the first and the last ones.
   pure function axis_text(axis) result(text)
      type(sweep_axis_t), intent(in) :: axis !! the quantity
      character(:), allocatable :: text
      integer, parameter :: n_shown = 8
      integer :: i

      if (axis%target == swept_load) then
         text = "factor of load '"//axis%name//"': "
      else
         text = axis%label()//': '
      end if
      text = text//counted(size(axis%values), 'value')//', '
      do i = 1, size(axis%values)
         if (i == n_shown .and. size(axis%values) > n_shown) text = text//'... '
         if (i >= n_shown .and. i < size(axis%values)) cycle
         text = text//short_text(axis%values(i))
         if (i < size(axis%values)) text = text//', '
      end do
   end function axis_text

   !> How the cases were solved.
   function solution_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      associate (statistics => result%statistics)
         text = heading('Solution')//labeled('Method', method_text(config%method))// &
            labeled('Factorization', factorization_text(result%certified))// &
            labeled('Converged', to_text(statistics%n_outcomes(outcome_solved))//' of '//to_text(statistics%n_cases)// &
            ' cases')
         do i = 1, size(outcome_labels)
            if (i /= outcome_solved .and. statistics%n_outcomes(i) > 0) text = text// &
               labeled(trim(outcome_labels(i)), counted(statistics%n_outcomes(i), 'case'))
         end do
         text = text//labeled('Iterations', to_text(statistics%n_iterations)//', '// &
            scientific(real(statistics%n_iterations, dp)/max(1, statistics%n_cases))//' per case')
         if (statistics%residual_case > 0) text = text//labeled('Largest residual', scientific(statistics%residual)// &
            ' in case '//to_text(statistics%residual_case)//', tolerance '//scientific(config%method%tolerance))
         if (result%n_resumed > 0) text = text//labeled('Done earlier', counted(result%n_resumed, 'case'))
         if (result%checkpoint%is_anew) text = text// &
            labeled('Note', 'the rows of an interrupted run are damaged or '// &
            'of another deck or version: all cases were solved again')
         text = text//labeled('Cases per second', short_text(result%cases_per_second()))
         if (result%n_sharing > 1) text = text//labeled('Solved by', counted(result%n_sharing, 'rank'))
      end associate
   end function solution_text

   !> Extremes of the cases that converged.
   pure function extremes_text(list, statistics, units) result(text)
      type(quantity_t), intent(in) :: list(:) !! what cases are ranked by
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer, parameter :: width = 14
      integer :: name_width, i

      name_width = maxval(len_trim(list%key))
      text = heading('Extremes of the cases that converged')//repeat(' ', name_width + 2)// &
         flush_right('least', width)// &
         flush_right('in case', width)//flush_right('greatest', width)//flush_right('in case', width)//newline
      do i = 1, size(list)
         text = text//'  '//list(i)%key(:name_width)//with_unit(flush_right(short_text(statistics%least(i)), width)// &
            flush_right(to_text(statistics%least_case(i)), width)// &
            flush_right(short_text(statistics%greatest(i)), width)// &
            flush_right(to_text(statistics%greatest_case(i)), width), units, trim(list(i)%dimension))//newline
      end do
   end function extremes_text

end module amontons_sweep_listing
