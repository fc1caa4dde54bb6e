!> NAME.summary.json: the result in numbers that a script reads.
module amontons_summary
   use amontons_accuracy_text, only: convergence_member
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_document, only: document_t
   use amontons_json, only: json_number, json_string, quantity_members
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp, int64
   use amontons_quantity, only: quantity_t, scales
   use amontons_result, only: certificate_limit, outcome_word, result_t
   use amontons_summary_members, only: add_head, certificate_member, effort_members, last_members, member, &
      quantities_member, size_counts, status_counts, uniqueness_member
   use amontons_text, only: to_text
   use amontons_zone_edges, only: interval_t
   implicit none (type, external)
   private

   public :: new_summary

contains

   !> Makes the summary.
   subroutine new_summary(summary, label, body, result)
      type(document_t), intent(out) :: summary !! the summary
      class(case_label_t), intent(in) :: label !! what the case is called
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result

      associate (solution => result%solution, certificate => result%certificate)
         call add_head(summary, label, result%method%method, outcome_word(result), result%warnings)
         if (allocated(result%answer)) then
            call summary%add(member('message', json_string(result%answer)))
            call summary%add(member('counts', '{'//size_counts(body)//'}'))
            call summary%record(last_members(result%timings))
            return
         end if
         call summary%append(result%study_members)
         call summary%record(effort_members(solution))
         if (result%method_error >= 0.0_dp) call summary%record(member('method_error', &
            json_number(result%method_error)))
         if (any(result%load_case%contacts%partition%is_constant)) call summary%add(member('inf_sup', &
            json_number(minval(body%inf_sup))))
         if (result%condition > 0.0_dp) call summary%record(member('condition', json_number(result%condition)))
         call summary%add(certificate_member(certificate%violations(), certificate_limit(result%method%tolerance), &
            certificate%energies()), [1.0_dp, scales([certificate%violations(), certificate%energies()])])
         call summary%record(uniqueness_member(result%uniqueness))
         call summary%add(quantities_member('key_results', result%key_results), scales(result%key_results))
         call summary%add(member('counts', '{'//size_counts(body)//', '//status_counts(solution%status)//'}'))
         call summary%record(member('factor', '{"entries": '//to_text(result%factor%n_entries)//', "flops": '// &
            to_text(nint(result%factor%n_flops, int64))//'}'))
         call summary%add(quantities_member('lengths', result%lengths%quantities()))
         call summary%add(intervals_member('closed_zones', result%closed), [maxval(abs(body%zone%position))])
         call summary%add(intervals_member('stick_zones', result%stuck), [maxval(abs(body%zone%position))])
         call summary%add(quantities_member('resultants', resultants(solution%force)), &
            scales(resultants(solution%force)))
         if (allocated(result%error_estimate)) call summary%add(quantities_member('accuracy', &
            result%error_estimate%quantities()))
         if (allocated(result%convergence)) call summary%add(convergence_member(result%convergence))
         call summary%record(last_members(result%timings))
      end associate
   end subroutine new_summary

   !> Parts of the contact line as a member.
   pure function intervals_member(name, intervals) result(text)
      character(*), intent(in) :: name !! its name
      type(interval_t), intent(in) :: intervals(:) !! the parts
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(intervals)
         associate (ends => intervals(i)%ends)
            text = text//', {"set": '//to_text(intervals(i)%set)//', '//quantity_members([ &
               quantity_t('length', '', intervals(i)%length), &
               quantity_t('start_x', '', ends(1, 1)), quantity_t('start_y', '', ends(2, 1)), &
               quantity_t('end_x', '', ends(1, 2)), quantity_t('end_y', '', ends(2, 2))])//'}'
         end associate
      end do
      text = member(name, '['//text(min(3, len(text) + 1):)//']')
   end function intervals_member

end module amontons_summary
