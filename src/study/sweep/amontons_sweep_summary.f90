!> NAME.summary.json of a sweep: what became of its cases together, in numbers that a script reads.
module amontons_sweep_summary
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_json, only: number, string, truth
   use amontons_kinds, only: dp
   use amontons_solve_sweep, only: sweep_result_t
   use amontons_summary, only: certificate_text
   use amontons_summary_members, only: head_members, last_members, member, size_counts
   use amontons_sweep, only: sweep_t
   use amontons_sweep_statistics, only: case_converged, outcome_names, quantity_labels, sweep_statistics_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: extremes_text, sweep_summary_text

contains

   !> The whole summary.
   function sweep_summary_text(config, body, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (statistics => result%statistics)
         text = head_members(config, statistics%n_outcomes(case_converged) == statistics%n_cases, &
            result%certified%warnings) &
            //member('iterations', to_text(statistics%n_iterations)) &
            //member('sweep', '{'//sweep_text(result)//'}') &
            //member('quantities', '['//quantities_text(config%sweep)//']')
         if (statistics%residual_case > 0) text = text//member('residual', number(statistics%residual)) &
            //member('extremes', '{'//extremes_text(statistics)//'}') &
            //member('certificate', '{"case": '//to_text(statistics%worst_case)//', ' &
            //certificate_text(result%certified%certificate, config%method%tolerance)//'}')
         if (result%certified%condition > 0.0_dp) text = text &
            //member('condition', number(result%certified%condition))
         text = text//member('counts', '{'//size_counts(body)//'}')//last_members(result%certified%timings)
      end associate
   end function sweep_summary_text

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
         number(result%cases_per_second())
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
            text = text//'{"name": '//string(axis%label())// &
               ', "values": '//to_text(size(axis%values))// &
               ', "least": '//number(minval(axis%values))// &
               ', "greatest": '//number(maxval(axis%values))// &
               ', "paired": '//truth(axis%is_paired)//'}'
         end associate
      end do
   end function quantities_text

   !> Extremes of the cases that converged.
   pure function extremes_text(statistics) result(text)
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(quantity_labels)
         if (i > 1) text = text//', '
         text = text//'"'//trim(quantity_labels(i))//'": {"least": '//number(statistics%least(i))// &
            ', "least_case": '//to_text(statistics%least_case(i))//', "greatest": '//number(statistics%greatest(i))// &
            ', "greatest_case": '//to_text(statistics%greatest_case(i))//'}'
      end do
   end function extremes_text

end module amontons_sweep_summary
