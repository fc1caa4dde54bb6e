!> NAME.lst of a reduced problem, in the form of a deck's listing.
module amontons_reduced_listing
   use amontons_config, only: config_t
   use amontons_friction_law, only: status_names
   use amontons_kinds, only: dp
   use amontons_listing_parts, only: head_text, method_text, outcome_text, residual_text, status_counts, times_text, &
      violations_text, warnings_text
   use amontons_listing_text, only: columns, heading, line, right, scientific, short
   use amontons_reduced_check, only: reduced_check_t
   use amontons_reduced_system, only: reduced_system_t
   use amontons_result, only: certificate_limit
   use amontons_solutions_report, only: solutions_text, uniqueness_text
   use amontons_solve_reduced, only: reduced_result_t
   use amontons_text, only: as_lines, to_text
   use amontons_timings, only: phase_read, phase_recover, phase_solve
   implicit none (type, external)
   private

   public :: reduced_listing_text

contains

   !> The whole listing.
   pure function reduced_listing_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      text = head_text(config)//warnings_text(result%warnings)//problem_text(config, result%system)// &
         solution_text(config, result)//check_text(config, result%check)//points_text(result)// &
         times_text(result%timings, [phase_read, phase_solve, phase_recover])
   end function reduced_listing_text

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

      associate (solution => result%solution)
         text = heading('Solution')//line('Method', method_text(config))//outcome_text(solution)// &
            residual_text(solution, config%method%tolerance)// &
            uniqueness_text(result%uniqueness, result%system%friction)// &
            line('Contacts', status_counts(solution%status))// &
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
      character(*), parameter :: names(*) = [character(17) :: 'Penetration', 'Tension', 'Friction excess', &
         'Complementarity', 'Slip below bound', 'Wrong dissipation']

      text = heading('Check on the problem as read (violations, each over its natural scale)')// &
         violations_text(names, [check%penetration, check%tension, check%friction_excess, check%complementarity, &
         check%slip_below_bound, check%wrong_dissipation], certificate_limit(config%method%tolerance))
   end function check_text

   !> The table of contacts.
   pure function points_text(result) result(text)
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      character(80) :: rows(0:result%system%n_contacts)
      integer :: p

      write (rows(0), '(a7, 4a13, 2x, a)') 'point', 'gap', 'slip', 'normal force', 'tang. force', 'status'
      associate (u => result%system%u, r => result%system%r)
         do p = 1, result%system%n_contacts
            rows(p) = right(to_text(p), 7)//columns([u(2*p - 1:2*p), r(2*p - 1:2*p)])//'  '// &
               status_names(result%solution%status(p))
         end do
      end associate
      text = heading('Contacts (u and r as in the file: a tangential force opposes its slip)')//as_lines(rows)
   end function points_text

end module amontons_reduced_listing
