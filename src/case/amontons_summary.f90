!> NAME.summary.json: the result in numbers that a script reads.
module amontons_summary
   use amontons_body, only: body_t
   use amontons_certificate, only: certificate_t
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_kinds, only: dp, int64
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_result, only: certificate_limit, result_t
   use amontons_system, only: peak_memory_mb
   use amontons_text, only: to_text
   use amontons_timings, only: phase_names, timings_t
   use amontons_uniqueness, only: uniqueness_t
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: certificate_text, number, numbers, seconds_text, string, truth, uniqueness_members, write_summary

   character(*), parameter :: newline = new_line('a')

contains

   !> Writes the summary under its temporary name.
   subroutine write_summary(file, path, config, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(a)', iostat=status) summary_text(config, body, result)
      call file%finish(status, error)
   end subroutine write_summary

   !> The summary as JSON.
   function summary_text(config, body, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (solution => result%solution)
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
            '  "history": ['//numbers(solution%history(:solution%n_iterations))//'],'//newline
         if (result%method_error >= 0.0_dp) text = text//'  "method_error": '//number(result%method_error)//','//newline
         if (any(config%contacts%partition%is_constant)) text = text// &
            '  "inf_sup": '//number(minval(body%inf_sup))//','//newline
         if (result%condition > 0.0_dp) text = text//'  "condition": '//number(result%condition)//','//newline
         text = text// &
            '  "certificate": {'//certificate_text(result%certificate, config%method%tolerance)//'},'//newline// &
            '  "uniqueness": {'//uniqueness_members(result%uniqueness)//'},'//newline// &
            '  "counts": {"nodes": '//to_text(body%mesh%n_nodes)//', "elements": '//to_text(body%mesh%n_elements)// &
            ', "dofs": '//to_text(body%dof_map%n_dofs)//', "contact_points": '//to_text(body%zone%n_points)// &
            ', "open": '//to_text(count(solution%status == open_point))// &
            ', "stick": '//to_text(count(solution%status == stick_point))// &
            ', "slip": '//to_text(count(solution%status == slip_plus .or. solution%status == slip_minus))// &
            ', "factor_entries": '//to_text(body%condensation%factorization%n_factor_entries())// &
            ', "factor_flops": '//to_text(nint(body%condensation%factorization%n_flops, int64))//'},'//newline// &
            '  "lengths": {"separated": '//number(result%lengths%separated)// &
            ', "sliding": '//number(result%lengths%sliding)// &
            ', "sticking": '//number(result%lengths%sticking)//'},'//newline// &
            '  "resultants": {"normal": '//number(sum(solution%force(:body%zone%n_points)))// &
            ', "tangential": '//number(sum(solution%force(body%zone%n_points + 1:)))//'},'//newline// &
            '  "seconds": {'//seconds_text(result%timings)//'},'//newline// &
            '  "peak_memory_mb": '//number(peak_memory_mb())//newline//'}'
      end associate
   end function summary_text

   !> The members of the certificate.
   function certificate_text(certificate, tolerance) result(text)
      type(certificate_t), intent(in) :: certificate !! the certificate
      real(dp), intent(in) :: tolerance !! tolerance of the contact method [-]
      character(:), allocatable :: text

      text = '"passed": '//truth(certificate%largest() <= certificate_limit(tolerance))// &
         ', "limit": '//number(certificate_limit(tolerance))// &
         ', "equilibrium": '//number(certificate%equilibrium)// &
         ', "penetration": '//number(certificate%penetration)// &
         ', "tension": '//number(certificate%tension)// &
         ', "friction_excess": '//number(certificate%friction_excess)// &
         ', "complementarity": '//number(certificate%complementarity)// &
         ', "wrong_dissipation": '//number(certificate%wrong_dissipation)// &
         ', "resultant": '//number(certificate%resultant)// &
         ', "moment": '//number(certificate%moment)// &
         ', "energy": '//number(certificate%energy)
      if (certificate%has_duality_gap) text = text//', "duality_gap": '//number(certificate%duality_gap)
      text = text// &
         ', "strain_energy": '//number(certificate%strain_energy)// &
         ', "dissipation": '//number(certificate%dissipation)
   end function certificate_text

   !> The members on uniqueness.
   pure function uniqueness_members(uniqueness) result(text)
      type(uniqueness_t), intent(in) :: uniqueness !! the bound
      character(:), allocatable :: text

      text = '"guaranteed": '//truth(uniqueness%is_unique)//', "friction_below": '
      if (uniqueness%has_bound .and. .not. uniqueness%is_for_any) then
         text = text//number(uniqueness%friction)
      else
         text = text//'null'
      end if
      text = text//', "exact": '//truth(uniqueness%is_exact)
   end function uniqueness_members

   !> The times of all phases.
   pure function seconds_text(timings) result(text)
      type(timings_t), intent(in) :: timings !! the times
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(phase_names)
         text = text//'"'//trim(phase_names(i))//'": '//number(timings%seconds(i))//', '
      end do
      text = text//'"total": '//number(sum(timings%seconds))
   end function seconds_text

   !> A finite real as a JSON number; null otherwise.
   pure function number(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      if (abs(value) <= huge(value)) then
         text = to_text(value)
      else
         text = 'null'
      end if
   end function number

   !> Reals as the elements of a JSON array.
   pure function numbers(values) result(text)
      real(dp), intent(in) :: values(:) !! the numbers
      character(:), allocatable :: text
      ! A separator, and the longest number: '-1.2345678901234567e-308'.
      integer, parameter :: longest = 26
      integer :: i, length

      allocate (character(longest*size(values)) :: text)
      length = 0
      do i = 1, size(values)
         associate (element => ', '//number(values(i)))
            text(length + 1:length + len(element)) = element
            length = length + len(element)
         end associate
      end do
      text = text(3:length)
   end function numbers

   !> A logical as JSON.
   pure function truth(value) result(text)
      logical, intent(in) :: value !! the value
      character(:), allocatable :: text

      text = trim(merge('true ', 'false', value))
   end function truth

   !> A text as a JSON string. Of the control characters only tabs can stand in a deck.
   pure function string(value) result(text)
      character(*), intent(in) :: value !! the text
      character(:), allocatable :: text
      character, parameter :: tab = achar(9)
      integer :: i, length

      text = repeat('"', 2*len(value) + 2)
      length = 1
      do i = 1, len(value)
         if (scan(value(i:i), '"\'//tab) > 0) then
            length = length + 1
            text(length:length) = '\'
         end if
         length = length + 1
         text(length:length) = merge('t', value(i:i), value(i:i) == tab)
      end do
      text = text(:length)//'"'
   end function string

end module amontons_summary
