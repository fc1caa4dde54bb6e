!> NAME.lst of a reduced problem, in the form of a deck's listing.
module amontons_reduced_listing
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, status_names, stick_point
   use amontons_kinds, only: dp
   use amontons_listing, only: history_text, method_text
   use amontons_listing_text, only: heading, line, newline, scientific, short
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_reduced_check, only: reduced_check_t
   use amontons_reduced_system, only: reduced_system_t
   use amontons_result, only: certificate_limit
   use amontons_solutions_report, only: solutions_text, uniqueness_text
   use amontons_solve_reduced, only: reduced_result_t
   use amontons_text, only: to_text
   use amontons_timings, only: phase_read, phase_recover, phase_solve
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: write_reduced_listing

contains

   !> Writes the listing under its temporary name.
   subroutine write_reduced_listing(file, path, config, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(a)', iostat=status, advance='no') head_text(config)//problem_text(config, result%system) &
         //solution_text(config, result)//check_text(config, result%check)
      if (status == 0) call write_points(file%unit, result, status)
      if (status == 0) write (file%unit, '(a)', iostat=status) times_text(result)
      call file%finish(status, error)
   end subroutine write_reduced_listing

   !> Program, case and deck.
   pure function head_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      text = 'Amontons '//version//': plane contact with Coulomb friction by the dual method'//newline//newline// &
         line('Case', config%name)//line('Title', config%title)//line('Deck', config%file)
   end function head_text

   !> What the file holds.
   pure function problem_text(config, system) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      character(:), allocatable :: text

      text = heading('Reduced problem u = W r + q')//line('File', config%reduced%file)//line('Form', system%form)// &
         line('Contacts', to_text(system%n_contacts))
      if (system%n_contacts == 0) return
      text = text//line('Matrix W', to_text(size(system%entry))//' entries, '// &
         trim(merge('used as dense ', 'used as sparse', system%is_dense())))// &
         line('Diagonal of W', 'up to '//short(system%largest))// &
         line('Largest q', short(maxval(abs(system%q))))
      if (maxval(system%friction) > minval(system%friction)) then
         text = text//line('Friction', short(minval(system%friction))//' to '//short(maxval(system%friction)))
      else
         text = text//line('Friction', short(system%friction(1)))
      end if
      if (config%reduced%has_friction) text = text//line('', "the deck's, in the place of the file's")
      if (system%asymmetry > 0.0_dp) text = text//line('Note', 'W differs from its transpose by up to '// &
         scientific(system%asymmetry)//'; the forces below solve the problem with W as it stands in the file')
   end function problem_text

   !> How the problem was solved.
   pure function solution_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (solution => result%solution, status => result%solution%status)
         text = heading('Solution')//line('Method', method_text(config))
         if (solution%is_converged) then
            text = text//line('Converged', 'yes, in '//to_text(solution%n_iterations)//' iterations')
         else
            text = text//line('Converged', 'NO: stopped after '//to_text(solution%n_iterations)// &
               ' iterations; the results below are not the solution')
         end if
         if (solution%is_at_rest .and. .not. solution%is_converged) text = text// &
            line('Note', 'the forces came to rest at a wrong answer: they do not fulfil the contact law')
         text = text//line('Residual', scientific(solution%residual)//', tolerance ' &
            //scientific(config%method%tolerance))//history_text(solution)// &
            uniqueness_text(result%uniqueness, result%system%friction)// &
            line('Contacts', to_text(count(status == open_point))//' open, '// &
            to_text(count(status == slip_plus))//' slip+, '//to_text(count(status == slip_minus))//' slip-, '// &
            to_text(count(status == stick_point))//' stick')// &
            line('Sum of forces', 'normal '//short(sum(result%system%r(1::2)))//', tangential '// &
            short(sum(result%system%r(2::2))))
         if (allocated(result%all_solutions)) text = text//solutions_text(result%all_solutions, &
            [result%system%r(1::2), result%system%r(2::2)])
      end associate
   end function solution_text

   !> The check in words.
   pure function check_text(config, check) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_check_t), intent(in) :: check !! the violations
      character(:), allocatable :: text
      real(dp) :: limit

      limit = certificate_limit(config%method%tolerance)
      text = heading('Check on the problem as read (violations, each over its natural scale)')
      call add('Penetration', check%penetration)
      call add('Tension', check%tension)
      call add('Friction excess', check%friction_excess)
      call add('Complementarity', check%complementarity)
      call add('Slip below bound', check%slip_below_bound)
      call add('Wrong dissipation', check%wrong_dissipation)
      text = text//line('Verdict', trim(merge('passed', 'FAILED', check%largest() <= limit))// &
         ': every violation must be at most '//scientific(limit))

   contains

      !> Adds a line on one violation.
      pure subroutine add(name, value)
         character(*), intent(in) :: name !! what is checked
         real(dp), intent(in) :: value !! the violation [-]

         text = text//line(name, scientific(value)//trim(merge('        ', '  FAILED', value <= limit)))
      end subroutine add

   end function check_text

   !> Writes the table of contacts.
   subroutine write_points(unit, result, status)
      integer, intent(in) :: unit !! the unit to write to
      type(reduced_result_t), intent(in) :: result !! the result
      integer, intent(out) :: status !! status of the last write statement
      integer :: p

      write (unit, '(a, a7, 4a13, 2x, a)', iostat=status) &
         heading('Contacts (u and r as in the file: a tangential force opposes its slip)'), 'point', 'gap', 'slip', &
         'normal force', 'tang. force', 'status'
      if (status /= 0) return
      associate (u => result%system%u, r => result%system%r)
         do p = 1, result%system%n_contacts
            write (unit, '(i7, 4es13.5, 2x, a)', iostat=status) p, u(2*p - 1), u(2*p), r(2*p - 1), &
               r(2*p), trim(status_names(result%solution%status(p)))
            if (status /= 0) return
         end do
      end associate
   end subroutine write_points

   !> Where the time went.
   pure function times_text(result) result(text)
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (seconds => result%timings%seconds)
         text = heading('Time [s]')//line('read', short(seconds(phase_read)))// &
            line('solve', short(seconds(phase_solve)))//line('recover', short(seconds(phase_recover)))// &
            newline//'End of listing'
      end associate
   end function times_text

end module amontons_reduced_listing
