!> NAME.lst: the listing, which an engineer reads top to bottom and needs nothing else.
module amontons_listing
   use amontons_body, only: body_t
   use amontons_certificate, only: certificate_t
   use amontons_config, only: config_t
   use amontons_contact_table, only: contact_point_t, new_contact_point
   use amontons_kinds, only: dp
   use amontons_listing_model, only: loads_text, model_text
   use amontons_listing_parts, only: head_text, method_text, outcome_text, residual_text, status_counts, times_text, &
      violations_text, warnings_text
   use amontons_listing_text, only: columns, heading, line, pair, right, scientific, short
   use amontons_result, only: certificate_limit, result_t
   use amontons_solutions_report, only: solutions_text, uniqueness_text
   use amontons_text, only: as_lines, to_text
   use amontons_timings, only: phase_assemble, phase_condense, phase_factorize, phase_read, phase_recover, phase_solve
   implicit none (type, external)
   private

   public :: certificate_text, factorization_text, listed_phases, listing_text, points_text, resultants_text, zones_text

   !> The phases that lie behind a deck when its listing is written.
   integer, parameter :: listed_phases(*) = [phase_read, phase_assemble, phase_factorize, phase_condense, phase_solve, &
      phase_recover]

contains

   !> The whole listing.
   function listing_text(config, body, result, study) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(*), intent(in) :: study !! what a study of several steps says of them; empty for a single case
      character(:), allocatable :: text

      text = head_text(config)//warnings_text(result%warnings)//model_text(config, body, result%load_case)// &
         loads_text(config)//study//solution_text(config, body, result)//zones_text(body, result)// &
         resultants_text(body, result)//certificate_text(config, result%certificate)//points_text(body, result)// &
         times_text(result%timings, listed_phases)
   end function listing_text

   !> How the contact problem was solved.
   function solution_text(config, body, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (solution => result%solution)
         text = heading('Solution')//line('Method', method_text(config))
         text = text//line('Factorization', factorization_text(body, result))
         if (allocated(result%started_from)) text = text//line('Started from', 'case '//result%started_from)
         text = text//outcome_text(solution)
         if (result%method_error >= 0.0_dp) text = text//line('Error of method', scientific(result%method_error)// &
            ' of the largest contact force, against the exact solution')
         text = text//residual_text(solution, config%method%tolerance)// &
            uniqueness_text(result%uniqueness, &
            merge(0.0_dp, result%load_case%friction, body%zone%is_tangent_fixed))
         if (allocated(result%all_solutions)) text = text// &
            solutions_text(result%all_solutions, solution%force)
      end associate
   end function solution_text

   !> The factorization in use, its size, and the case it was made for.
   function factorization_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (condenser => body%condensation%condenser)
         text = condenser%name//', '//to_text(condenser%n_factor_entries)//' entries'
      end associate
      if (allocated(result%shared_with)) text = text//', shared with case '//result%shared_with
   end function factorization_text

   !> Counts and lengths of the open, slip and stick zones.
   pure function zones_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (lengths => result%lengths)
         text = heading('Contact line')// &
            line('Points', to_text(body%zone%n_points)//': '//status_counts(result%solution%status))// &
            line('Open length', short(lengths%open))// &
            line('Slip length', short(lengths%slip))// &
            line('Stick length', short(lengths%stick))
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
      character(*), parameter :: names(*) = [character(17) :: 'Equilibrium', 'Penetration', 'Tension', &
         'Friction excess', 'Complementarity', 'Slip below bound', 'Wrong dissipation', 'Resultant', 'Moment', &
         'Energy balance', 'Duality gap']
      real(dp), allocatable :: violations(:)

      violations = [certificate%equilibrium, certificate%penetration, certificate%tension, &
         certificate%friction_excess, certificate%complementarity, certificate%slip_below_bound, &
         certificate%wrong_dissipation, certificate%resultant, certificate%moment, certificate%energy]
      if (certificate%has_duality_gap) violations = [violations, certificate%duality_gap]
      text = heading('Certificate on the full model (violations, each over its natural scale)') &
         //violations_text(names, violations, certificate_limit(config%method%tolerance))
   end function certificate_text

   !> The table of contact points.
   pure function points_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      character(132) :: rows(0:body%zone%n_points)
      type(contact_point_t) :: point
      integer :: p

      write (rows(0), '(a7, 8a13, 2x, a)') 'point', 'x', 'y', 'gap', 'slip', 'normal force', 'tang. force', &
         'pressure', 'shear', 'status'
      do p = 1, body%zone%n_points
         call new_contact_point(point, body, result, p)
         rows(p) = right(to_text(p), 7)//columns([point%position, point%gap, point%slip, point%normal_force, &
            point%tangential_force, point%pressure, point%shear])//'  '//point%status
      end do
      text = heading('Contact points (forces and stresses: compression and shear along the slip positive)') &
         //as_lines(rows)
   end function points_text

end module amontons_listing
