!> NAME.lst: the listing, which an engineer reads top to bottom and needs nothing else.
module amontons_listing
   use amontons_body, only: body_t
   use amontons_certificate, only: certificate_t
   use amontons_conditioning, only: conditioning_text
   use amontons_config, only: config_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_contact_table, only: contact_point_t, new_contact_point
   use amontons_error, only: error_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_kinds, only: dp
   use amontons_listing_model, only: loads_text, model_text
   use amontons_listing_text, only: heading, line, newline, pair, right, scientific, short
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_result, only: certificate_limit, result_t
   use amontons_solutions_report, only: solutions_text, uniqueness_text
   use amontons_text, only: to_text
   use amontons_timings, only: phase_names
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: certificate_text, condition_text, factorization_text, head_text, history_text, method_text, &
      times_text, write_listing

contains

   !> Writes the listing under its temporary name.
   subroutine write_listing(file, path, config, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(a)', iostat=status, advance='no') head_text(config)//model_text(config, body) &
         //loads_text(config)//solution_text(config, body, result)//zones_text(body, result) &
         //resultants_text(body, result)//certificate_text(config, result%certificate)//condition_text(body, result)
      if (status == 0) call write_points(file%unit, body, result, status)
      if (status == 0) write (file%unit, '(a)', iostat=status) times_text(result)
      call file%finish(status, error)
   end subroutine write_listing

   !> Program, case and deck.
   pure function head_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      text = 'Amontons '//version//': plane contact with Coulomb friction by the dual method'//newline//newline// &
         line('Case', config%name)//line('Title', config%title)//line('Deck', config%file)
   end function head_text

   !> How the contact problem was solved.
   function solution_text(config, body, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (solution => result%solution)
         text = heading('Solution')//line('Method', method_text(config))
         text = text//line('Factorisation', factorization_text(body, result))
         if (allocated(result%started_from)) text = text//line('Started from', 'case '//result%started_from)
         if (solution%is_converged) then
            text = text//line('Converged', 'yes, in '//to_text(solution%n_iterations)//' iterations')
         else
            text = text//line('Converged', 'NO: stopped after '//to_text(solution%n_iterations)// &
               ' iterations; the results below are not the solution')
         end if
         if (solution%is_at_rest .and. .not. solution%is_converged) text = text// &
            line('Note', 'the forces came to rest at a wrong answer: they do not fulfil the contact law')
         if (result%method_error >= 0.0_dp) text = text//line('Error of method', scientific(result%method_error)// &
            ' of the largest contact force, against the exact solution')
         text = text//line('Residual', scientific(solution%residual)//', tolerance ' &
            //scientific(config%method%tolerance))//history_text(solution)// &
            uniqueness_text(result%uniqueness, body%problem%friction)
         if (allocated(result%all_solutions)) text = text// &
            solutions_text(result%all_solutions, solution%force)
      end associate
   end function solution_text

   !> The factorisation in use, its size, and the case it was made for.
   function factorization_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (factorization => body%condensation%factorization)
         text = factorization%name()//', '//to_text(factorization%n_factor_entries())//' entries'
      end associate
      if (allocated(result%shared_with)) text = text//', shared with case '//result%shared_with
   end function factorization_text

   !> The residual after each iteration; of many iterations about twenty.
   pure function history_text(solution) result(text)
      type(contact_solution_t), intent(in) :: solution !! the solution and its record
      character(:), allocatable :: text
      integer, parameter :: n_lines = 20
      integer :: i, stride

      text = line('Residual history', 'iteration, residual')
      stride = max(1, solution%n_iterations/n_lines)
      do i = 1, solution%n_iterations
         if (i /= 1 .and. i /= solution%n_iterations .and. mod(i, stride) /= 0) cycle
         text = text//line('', right(to_text(i), len('iteration'))//'  '//scientific(solution%history(i)))
      end do
   end function history_text

   !> The method with the options that it uses.
   pure function method_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      associate (method => config%method)
         text = method%method
         select case (text)
         case ('splitting')
            text = text//', variant '//method%variant//', quadratic programs by '//method%box
         case ('fixed_point')
            text = text//', quadratic programs by '//method%box
         case ('psor')
            text = text//', omega '//short(method%omega)//', '//method%space//' space, local '//method%local// &
               ', acceleration '//method%acceleration
         case default
            continue
         end select
      end associate
   end function method_text

   !> Counts and lengths of the open, sliding and sticking parts.
   pure function zones_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (status => result%solution%status, lengths => result%lengths)
         text = heading('Contact line')// &
            line('Points', to_text(body%zone%n_points)//': '//to_text(count(status == open_point))//' open, '// &
            to_text(count(status == slip_plus))//' slip+, '//to_text(count(status == slip_minus))//' slip-, '// &
            to_text(count(status == stick_point))//' stick')// &
            line('Separated length', short(lengths%separated))// &
            line('Sliding length', short(lengths%sliding))// &
            line('Sticking length', short(lengths%sticking))
      end associate
   end function zones_text

   !> Resultants of all forces.
   pure function resultants_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (certificate => result%certificate, force => result%solution%force, m => body%zone%n_points)
         text = heading('Resultants')// &
            line('Loads', pair(certificate%load))// &
            line('Support reactions', pair(certificate%reaction))// &
            line('Contact forces', pair(certificate%contact))// &
            line('Normal, tangential', short(sum(force(:m)))//', '//short(sum(force(m + 1:))))// &
            line('Strain energy', short(certificate%strain_energy))// &
            line('Work of friction', short(certificate%dissipation))
      end associate
   end function resultants_text

   !> The certificate in words.
   pure function certificate_text(config, certificate) result(text)
      type(config_t), intent(in) :: config !! the case
      type(certificate_t), intent(in) :: certificate !! the certificate
      character(:), allocatable :: text
      real(dp) :: limit

      limit = certificate_limit(config%method%tolerance)
      text = heading('Certificate on the full model (violations, each over its natural scale)')
      call check('Equilibrium', certificate%equilibrium)
      call check('Penetration', certificate%penetration)
      call check('Tension', certificate%tension)
      call check('Friction excess', certificate%friction_excess)
      call check('Complementarity', certificate%complementarity)
      call check('Wrong dissipation', certificate%wrong_dissipation)
      call check('Resultant', certificate%resultant)
      call check('Moment', certificate%moment)
      call check('Energy balance', certificate%energy)
      if (certificate%has_duality_gap) call check('Duality gap', certificate%duality_gap)
      text = text//line('Verdict', trim(merge('passed', 'FAILED', certificate%largest() <= limit))// &
         ': every violation must be at most '//scientific(limit))

   contains

      !> Adds a line on one violation.
      pure subroutine check(name, value)
         character(*), intent(in) :: name !! what is checked
         real(dp), intent(in) :: value !! the violation [-]

         text = text//line(name, scientific(value)//trim(merge('        ', '  FAILED', value <= limit)))
      end subroutine check

   end function certificate_text

   !> The condition of the stiffness where rounding shows, and what makes it poor.
   pure function condition_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text, reasons

      text = ''
      if (.not. result%condition > 0.0_dp) return
      text = line('Condition number', 'about '//scientific(result%condition)//', of the stiffness: rounding may cost ' &
         //to_text(min(16, nint(log10(result%condition))))//' of 16 digits')
      reasons = conditioning_text(body%mesh, body%materials, body%springs)
      if (len(reasons) > 0) text = text//line('', reasons(3:))
   end function condition_text

   !> Writes the table of contact points.
   subroutine write_points(unit, body, result, status)
      integer, intent(in) :: unit !! the unit to write to
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      integer, intent(out) :: status !! status of the last write statement
      type(contact_point_t) :: point
      integer :: p

      write (unit, '(a, a7, 8a13, 2x, a)', iostat=status) &
         heading('Contact points (forces and stresses: compression and shear along the slip positive)'), 'point', &
         'x', 'y', 'gap', 'slip', 'normal force', 'tang. force', 'norm. stress', 'tang. stress', 'status'
      if (status /= 0) return
      do p = 1, body%zone%n_points
         call new_contact_point(point, body, result, p)
         write (unit, '(i7, 8es13.5, 2x, a)', iostat=status) p, point%position, point%gap, point%slip, &
            point%normal_force, point%tangential_force, point%normal_stress, point%tangential_stress, point%status
         if (status /= 0) return
      end do
   end subroutine write_points

   !> Where the time went.
   pure function times_text(result) result(text)
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      character(16) :: seconds
      integer :: i

      text = heading('Time [s]')
      do i = 1, size(phase_names) - 1
         write (seconds, '(f10.4)') result%timings%seconds(i)
         text = text//line(trim(phase_names(i)), trim(seconds))
      end do
      text = text//newline//'End of listing'
   end function times_text

end module amontons_listing
