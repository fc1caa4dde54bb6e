!> NAME.summary.json of a sweep: what became of its cases together, in numbers that a script reads.
module amontons_sweep_summary
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_solve_sweep, only: sweep_result_t
   use amontons_summary, only: certificate_text, number, seconds_text, string, truth
   use amontons_sweep, only: sweep_t
   use amontons_sweep_tally, only: case_converged, outcome_names, quantity_labels, sweep_tally_t
   use amontons_system, only: peak_memory_mb
   use amontons_text, only: to_text
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: write_sweep_summary

   character(*), parameter :: newline = new_line('a')

contains

   !> Writes the summary under its temporary name.
   subroutine write_sweep_summary(file, path, config, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(a)', iostat=status) summary_text(config, body, result)
      call file%finish(status, error)
   end subroutine write_sweep_summary

   !> The summary as JSON.
   function summary_text(config, body, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (tally => result%tally)
         text = '{'//newline// &
            '  "case": '//string(config%name)//','//newline// &
            '  "title": '//string(config%title)//','//newline// &
            '  "version": '//string(version)//','//newline// &
            '  "method": '//string(config%method%method)//','//newline// &
            '  "converged": '//truth(tally%n_outcomes(case_converged) == tally%n_cases)//','//newline// &
            '  "iterations": '//to_text(tally%n_iterations)//','//newline// &
            '  "sweep": {'//sweep_text(result)//'},'//newline// &
            '  "quantities": ['//quantities_text(config%sweep)//'],'//newline
         if (tally%residual_case > 0) text = text// &
            '  "residual": '//number(tally%residual)//','//newline// &
            '  "extremes": {'//extremes_text(tally)//'},'//newline// &
            '  "certificate": {"case": '//to_text(tally%residual_case)//', '// &
            certificate_text(result%certified%certificate, config%method%tolerance)//'},'//newline
         if (result%certified%condition > 0.0_dp) text = text// &
            '  "condition": '//number(result%certified%condition)//','//newline
         text = text// &
            '  "counts": {"nodes": '//to_text(body%mesh%n_nodes)//', "elements": '//to_text(body%mesh%n_elements)// &
            ', "dofs": '//to_text(body%dof_map%n_dofs)//', "contact_points": '//to_text(body%zone%n_points)// &
            '},'//newline// &
            '  "seconds": {'//seconds_text(result%certified%timings)//'},'//newline// &
            '  "peak_memory_mb": '//number(peak_memory_mb())//newline//'}'
      end associate
   end function summary_text

   !> Counts of the cases, and how fast they were solved.
   pure function sweep_text(result) result(text)
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      text = '"cases": '//to_text(result%tally%n_cases)
      do i = 1, size(outcome_names)
         text = text//', "'//trim(outcome_names(i))//'": '//to_text(result%tally%n_outcomes(i))
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
   pure function extremes_text(tally) result(text)
      type(sweep_tally_t), intent(in) :: tally !! counts and extremes
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(quantity_labels)
         if (i > 1) text = text//', '
         text = text//'"'//trim(quantity_labels(i))//'": {"least": '//number(tally%least(i))//', "least_case": '// &
            to_text(tally%least_case(i))//', "greatest": '//number(tally%greatest(i))//', "greatest_case": '// &
            to_text(tally%greatest_case(i))//'}'
      end do
   end function extremes_text

end module amontons_sweep_summary
