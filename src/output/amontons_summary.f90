!> NAME.summary.json: the result in numbers that a script reads.
module amontons_summary
   use amontons_body, only: body_t
   use amontons_certificate, only: certificate_t
   use amontons_config, only: config_t
   use amontons_json, only: number, number_members, truth
   use amontons_kinds, only: dp, int64
   use amontons_result, only: certificate_limit, result_t
   use amontons_summary_members, only: effort_members, head_members, last_members, member, resultants_member, &
      size_counts, status_counts, uniqueness_member
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: certificate_text, summary_text

contains

   !> The whole summary.
   function summary_text(config, body, result, study) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(*), intent(in) :: study !! members on a study of several steps; empty for a single case
      character(:), allocatable :: text

      associate (solution => result%solution, condenser => body%condensation%condenser)
         text = head_members(config, solution%is_converged, result%warnings)//study//effort_members(solution)
         if (result%method_error >= 0.0_dp) text = text//member('method_error', number(result%method_error))
         if (any(config%contacts%partition%is_constant)) text = text//member('inf_sup', number(minval(body%inf_sup)))
         if (result%condition > 0.0_dp) text = text//member('condition', number(result%condition))
         text = text//member('certificate', '{'//certificate_text(result%certificate, config%method%tolerance)//'}') &
            //uniqueness_member(result%uniqueness) &
            //member('counts', '{'//size_counts(body)//', '//status_counts(solution%status) &
            //', "factor_entries": '//to_text(condenser%n_factor_entries) &
            //', "factor_flops": '//to_text(nint(condenser%n_flops, int64))//'}') &
            //member('lengths', '{'//number_members([character(12) :: 'open_length', 'slip_length', 'stick_length'], &
            [result%lengths%open, result%lengths%slip, result%lengths%stick])//'}') &
            //resultants_member(solution%force(:body%zone%n_points), solution%force(body%zone%n_points + 1:)) &
            //last_members(result%timings)
      end associate
   end function summary_text

   !> The members of the certificate.
   pure function certificate_text(certificate, tolerance) result(text)
      type(certificate_t), intent(in) :: certificate !! the certificate
      real(dp), intent(in) :: tolerance !! tolerance of the contact method [-]
      character(:), allocatable :: text

      text = '"passed": '//truth(certificate%largest() <= certificate_limit(tolerance))//', '// &
         number_members([character(17) :: 'limit', 'equilibrium', 'penetration', 'tension', 'friction_excess', &
         'complementarity', 'slip_below_bound', 'wrong_dissipation', 'resultant', 'moment', 'energy'], &
         [certificate_limit(tolerance), certificate%equilibrium, certificate%penetration, certificate%tension, &
         certificate%friction_excess, certificate%complementarity, certificate%slip_below_bound, &
         certificate%wrong_dissipation, certificate%resultant, certificate%moment, certificate%energy])
      if (certificate%has_duality_gap) text = text//', "duality_gap": '//number(certificate%duality_gap)
      text = text//', '//number_members([character(13) :: 'strain_energy', 'dissipation'], &
         [certificate%strain_energy, certificate%dissipation])
   end function certificate_text

end module amontons_summary
