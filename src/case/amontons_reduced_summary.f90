!> NAME.summary.json of a reduced problem: the members of a deck's summary that it has, and those of the problem.
module amontons_reduced_summary
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_result, only: certificate_limit
   use amontons_solve_reduced, only: reduced_result_t
   use amontons_summary, only: number, numbers, string, truth, uniqueness_members
   use amontons_system, only: peak_memory_mb
   use amontons_text, only: to_text
   use amontons_timings, only: phase_names
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: write_reduced_summary

   character(*), parameter :: newline = new_line('a')

contains

   !> Writes the summary under its temporary name.
   subroutine write_reduced_summary(file, path, config, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(a)', iostat=status) summary_text(config, result)
      call file%finish(status, error)
   end subroutine write_reduced_summary

   !> The summary as JSON.
   function summary_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      associate (solution => result%solution, system => result%system)
         text = '{'//newline// &
            '  "case": '//string(config%name)//','//newline// &
            '  "title": '//string(config%title)//','//newline// &
            '  "version": '//string(version)//','//newline// &
            '  "method": '//string(config%method%method)//','//newline// &
            '  "converged": '//truth(solution%is_converged)//','//newline// &
            '  "iterations": '//to_text(solution%n_iterations)//','//newline// &
            '  "products": '//number(solution%effort%n_products)//','//newline// &
            '  "factorizations": '//to_text(solution%effort%n_factorizations)//','//newline// &
            '  "residual": '//number(solution%residual)//','//newline// &
            '  "history": ['//numbers(solution%history(:solution%n_iterations))//'],'//newline// &
            '  "problem": {"file": '//string(config%reduced%file)//', "form": '//string(system%form)// &
            ', "entries": '//to_text(size(system%entry))//', "largest_compliance": '//number(system%largest)// &
            ', "asymmetry": '//number(system%asymmetry)//'},'//newline// &
            '  "certificate": {'//certificate_text(config, result)//'},'//newline// &
            '  "uniqueness": {'//uniqueness_members(result%uniqueness)//'},'//newline// &
            '  "counts": {"contact_points": '//to_text(system%n_contacts)// &
            ', "open": '//to_text(count(solution%status == open_point))// &
            ', "stick": '//to_text(count(solution%status == stick_point))// &
            ', "slip": '//to_text(count(solution%status == slip_plus .or. solution%status == slip_minus))// &
            '},'//newline// &
            '  "resultants": {"normal": '//number(sum(system%r(1::2)))// &
            ', "tangential": '//number(sum(system%r(2::2)))//'},'//newline// &
            '  "seconds": {'
         do i = 1, size(phase_names)
            text = text//'"'//trim(phase_names(i))//'": '//number(result%timings%seconds(i))//', '
         end do
         text = text//'"total": '//number(sum(result%timings%seconds))//'},'//newline// &
            '  "peak_memory_mb": '//number(peak_memory_mb())//newline//'}'
      end associate
   end function summary_text

   !> The members of the certificate.
   function certificate_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (check => result%check, limit => certificate_limit(config%method%tolerance))
         text = '"passed": '//truth(check%largest() <= limit)//', "limit": '//number(limit)// &
            ', "penetration": '//number(check%penetration)// &
            ', "tension": '//number(check%tension)// &
            ', "friction_excess": '//number(check%friction_excess)// &
            ', "complementarity": '//number(check%complementarity)// &
            ', "slip_below_bound": '//number(check%slip_below_bound)// &
            ', "wrong_dissipation": '//number(check%wrong_dissipation)
      end associate
   end function certificate_text

end module amontons_reduced_summary
