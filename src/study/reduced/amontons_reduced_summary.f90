!> NAME.summary.json of a reduced problem: the members of a deck's summary that it has, and those of the problem.
module amontons_reduced_summary
   use amontons_config, only: config_t
   use amontons_document, only: document_t
   use amontons_json, only: json_number, json_string
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t, scales
   use amontons_result, only: certificate_limit
   use amontons_solve_reduced, only: reduced_result_t
   use amontons_summary_members, only: add_head, certificate_member, effort_members, last_members, member, &
      quantities_member, status_counts, uniqueness_member
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: new_reduced_summary

contains

   !> Makes the summary.
   subroutine new_reduced_summary(summary, config, result)
      type(document_t), intent(out) :: summary !! the summary
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      type(quantity_t) :: no_quantities(0), sums(2)

      associate (solution => result%solution, system => result%system)
         sums = resultants([system%r(1::2), system%r(2::2)])
         call add_head(summary, config, config%method%method, trim(merge('converged    ', 'not_converged', &
            solution%is_converged)), result%warnings)
         call summary%record(effort_members(solution))
         call summary%add(member('problem', '{"file": '//json_string(config%reduced%path)//', "form": '// &
            json_string(system%form)//', "entries": '//to_text(size(system%entry))//', "largest_compliance": '// &
            json_number(system%largest)//', "asymmetry": '//json_number(system%asymmetry)//'}'), [system%largest])
         call summary%add(certificate_member(result%check%violations(), certificate_limit(config%method%tolerance), &
            no_quantities), [1.0_dp])
         call summary%record(uniqueness_member(result%uniqueness))
         call summary%add(member('counts', '{"contact_points": '//to_text(system%n_contacts)//', '// &
            status_counts(solution%status)//'}'))
         call summary%add(quantities_member('resultants', sums), scales(sums))
         call summary%record(last_members(result%timings))
      end associate
   end subroutine new_reduced_summary

end module amontons_reduced_summary
