!> NAME.summary.json of a reduced problem: the members of a deck's summary that it has, and those of the problem.
module amontons_reduced_summary
   use amontons_config, only: config_t
   use amontons_json, only: number, number_members, string, truth
   use amontons_result, only: certificate_limit
   use amontons_solve_reduced, only: reduced_result_t
   use amontons_summary_members, only: effort_members, head_members, last_members, member, resultants_member, &
      status_counts, uniqueness_member
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: reduced_summary_text

contains

   !> The whole summary.
   function reduced_summary_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (solution => result%solution, system => result%system)
         text = head_members(config, solution%is_converged, result%warnings)//effort_members(solution) &
            //member('problem', '{"file": '//string(config%reduced%file)//', "form": '//string(system%form) &
            //', "entries": '//to_text(size(system%entry))//', "largest_compliance": '//number(system%largest) &
            //', "asymmetry": '//number(system%asymmetry)//'}') &
            //member('certificate', '{'//certificate_text(config, result)//'}') &
            //uniqueness_member(result%uniqueness) &
            //member('counts', '{"contact_points": '//to_text(system%n_contacts)//', '//status_counts(solution%status) &
            //'}')//resultants_member(system%r(1::2), system%r(2::2))//last_members(result%timings)
      end associate
   end function reduced_summary_text

   !> The members of the certificate.
   pure function certificate_text(config, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (check => result%check, limit => certificate_limit(config%method%tolerance))
         text = '"passed": '//truth(check%largest() <= limit)//', '// &
            number_members([character(17) :: 'limit', 'penetration', 'tension', 'friction_excess', 'complementarity', &
            'slip_below_bound', 'wrong_dissipation'], [limit, check%penetration, check%tension, &
            check%friction_excess, check%complementarity, check%slip_below_bound, check%wrong_dissipation])
      end associate
   end function certificate_text

end module amontons_reduced_summary
