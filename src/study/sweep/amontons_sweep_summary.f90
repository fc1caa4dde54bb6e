!> NAME.summary.json of a sweep: what became of its cases together, in numbers that a script reads.
module amontons_sweep_summary
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_document, only: document_t, json_logical, json_number, json_string
   use amontons_kinds, only: dp
   use amontons_outcome_words, only: outcome_names, solution_word, word_no_equilibrium, word_solved
   use amontons_quantity, only: quantity_t, scales
   use amontons_report, only: add_head, certificate_member, last_members, member, quantities_member, size_counts
   use amontons_result, only: certificate_limit
   use amontons_solve_sweep, only: sweep_result_t
   use amontons_sweep, only: sweep_t
   use amontons_sweep_statistics, only: ranked_quantities, sweep_statistics_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: new_sweep_summary

contains

   !> Makes the summary.
   subroutine new_sweep_summary(summary, config, body, result)
      type(document_t), intent(out) :: summary !! the summary
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result

      associate (statistics => result%statistics, certified => result%certified)
         call add_head(summary, config, config%method%method, outcome_word(result), certified%warnings)
         if (statistics%outcome() == word_no_equilibrium) call summary%add(member('message', json_string( &
            'no case has an equilibrium: contact and friction cannot balance the loads of any')))
         call summary%add(member('iterations', to_text(statistics%n_iterations)))
         call summary%add(member('sweep', '{'//sweep_text(result)//'}'))
         call summary%add(member('quantities', '['//quantities_text(config%sweep)//']'))
         if (statistics%residual_case > 0) then
            call summary%add(member('residual', json_number(statistics%residual)))
            call summary%add(member('extremes', '{'//extremes_text(body, config%sweep, statistics)//'}'))
            call add_certificate(summary, result)
         end if
         if (certified%condition > 0.0_dp) call summary%record(member('condition', json_number(certified%condition)))
         call summary%add(member('counts', '{'//size_counts(body)//'}'))
         call summary%record(last_members(certified%timings))
      end associate
   end subroutine new_sweep_summary

   !> What became of the sweep in a word.
   pure function outcome_word(result) result(word)
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: word

      word = result%statistics%outcome()
      if (word == word_solved) word = solution_word(.true., result%certified%certificate%largest() &
         <= certificate_limit(result%certified%method%tolerance))
   end function outcome_word

   !> Adds the certificate of the case with the largest error estimate, and how accurate its stresses are.
   subroutine add_certificate(summary, result)
      type(document_t), intent(inout) :: summary !! the summary
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (certificate => result%certified%certificate)
         text = certificate_member(certificate%violations(), certificate_limit(result%certified%method%tolerance), &
            certificate%energies(), '"case": '//to_text(result%statistics%worst_case)//', ')
         if (result%has_certificate) then
            call summary%add(text, [1.0_dp, 1.0_dp, scales([certificate%violations(), certificate%energies()])])
         else
            call summary%record(text)
         end if
         if (.not. allocated(result%certified%error_estimate)) return
         associate (accuracy => result%certified%error_estimate%quantities())
            if (result%has_certificate) then
               call summary%add(quantities_member('accuracy', accuracy))
            else
               call summary%record(quantities_member('accuracy', accuracy))
            end if
         end associate
      end associate
   end subroutine add_certificate

   !> Counts of the cases, and how fast they were solved.
   pure function sweep_text(result) result(text)
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      text = '"cases": '//to_text(result%statistics%n_cases)
      do i = 1, size(outcome_names)
         text = text//', "'//trim(outcome_names(i))//'": '//to_text(result%statistics%n_outcomes(i))
      end do
      text = text//', "done_earlier": '//to_text(result%n_resumed)//', "cases_per_second": '// &
         json_number(result%cases_per_second())
   end function sweep_text

   !> What varies: name, number of values, the least and the greatest of them.
   pure function quantities_text(sweep) result(text)
      type(sweep_t), intent(in) :: sweep !! the sweep
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(sweep%axes)
         if (i > 1) text = text//', '
         associate (axis => sweep%axes(i))
            text = text//'{"name": '//json_string(axis%label())// &
               ', "values": '//to_text(size(axis%values))// &
               ', "least": '//json_number(minval(axis%values))// &
               ', "greatest": '//json_number(maxval(axis%values))// &
               ', "paired": '//json_logical(axis%is_paired)//'}'
         end associate
      end do
   end function quantities_text

   !> Extremes of the cases that converged.
   pure function extremes_text(body, sweep, statistics) result(text)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      character(:), allocatable :: text
      type(quantity_t), allocatable :: list(:)
      integer :: i

      text = ''
      list = ranked_quantities(body, sweep)
      do i = 1, size(list)
         if (i > 1) text = text//', '
         text = text//'"'//trim(list(i)%key)//'": {"least": '//json_number(statistics%least(i))//', "least_case": '// &
            to_text(statistics%least_case(i))//', "greatest": '//json_number(statistics%greatest(i))// &
            ', "greatest_case": '//to_text(statistics%greatest_case(i))//'}'
      end do
   end function extremes_text

end module amontons_sweep_summary
