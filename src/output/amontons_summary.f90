!> NAME.summary.json, the result in numbers that a script reads; and members of a JSON object, a line each, that the
!> summaries of decks, sweeps and reduced problems have in common.
module amontons_summary
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_convergence, only: refined_quantity_t, verdict_names
   use amontons_document, only: document_t, json_logical, json_number, json_numbers, json_string, quantity_members
   use amontons_error, only: warning_list_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp, int64
   use amontons_outcome_words, only: has_converged
   use amontons_quantity, only: quantity_t, scales
   use amontons_result, only: certificate_limit, outcome_word, result_t
   use amontons_system, only: peak_memory_mb
   use amontons_terminal, only: phase_names, timings_t
   use amontons_text, only: newline, to_text
   use amontons_uniqueness, only: uniqueness_t
   use amontons_version, only: version
   use amontons_zone_edges, only: interval_t
   implicit none (type, external)
   private

   public :: add_head, certificate_member, effort_members, last_members, member, member_value, new_summary, &
      quantities_member, size_counts, status_counts, uniqueness_member

contains

   !> A member with others behind it.
   pure function member(name, value) result(text)
      character(*), intent(in) :: name !! its name
      character(*), intent(in) :: value !! its value in JSON
      character(:), allocatable :: text

      text = '  "'//name//'": '//value//','//newline
   end function member

   !> Adds the beginning of the object: which case, and whether it was solved.
   pure subroutine add_head(summary, label, method, outcome, warnings)
      type(document_t), intent(inout) :: summary !! gains the members
      class(case_label_t), intent(in) :: label !! what the case is called
      character(*), intent(in) :: method !! the contact method
      character(*), intent(in) :: outcome !! what became of it, a word of `amontons_outcome_words`
      type(warning_list_t), intent(in) :: warnings !! what is doubtful about it
      character(:), allocatable :: text
      integer :: i

      summary%ending = '.summary.json'
      call summary%add('{'//newline//member('case', json_string(label%name))//member('title', &
         json_string(label%title)) //member('units', json_string(label%units)))
      call summary%record(member('version', json_string(version)))
      call summary%add(member('method', json_string(trim(method))))
      call summary%add(member('outcome', json_string(outcome))//member('converged', &
         json_logical(has_converged(outcome))))
      text = ''
      do i = 1, warnings%n()
         if (i > 1) text = text//', '
         text = text//json_string(warnings%item(i))
      end do
      call summary%add(member('warnings', '['//text//']'))
   end subroutine add_head

   !> What the method spent, and what it reached.
   pure function effort_members(solution) result(text)
      type(contact_solution_t), intent(in) :: solution !! the solution and its record
      character(:), allocatable :: text

      text = member('iterations', to_text(solution%n_iterations)) &
         //member('products', json_number(solution%effort%n_products)) &
         //member('factorizations', to_text(solution%effort%n_factorizations)) &
         //member('residual', json_number(solution%residual)) &
         //member('residual_history', '['//json_numbers(solution%history(:solution%n_iterations))//']')
   end function effort_members

   !> What is known of uniqueness.
   pure function uniqueness_member(uniqueness) result(text)
      type(uniqueness_t), intent(in) :: uniqueness !! the bound
      character(:), allocatable :: text, bound

      bound = 'null'
      if (uniqueness%has_bound .and. .not. uniqueness%is_for_any) bound = json_number(uniqueness%friction)
      text = member('uniqueness', '{"guaranteed": '//json_logical(uniqueness%is_unique)//', "friction_below": '//bound &
         //', "exact": '//json_logical(uniqueness%is_exact)//'}')
   end function uniqueness_member

   !> Sizes of the model, for the member `counts`.
   pure function size_counts(body) result(text)
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable :: text

      text = '"nodes": '//to_text(body%mesh%n_nodes)//', "elements": '//to_text(body%mesh%n_elements) &
         //', "dofs": '//to_text(body%dof_map%n_dofs)//', "contact_points": '//to_text(body%zone%n_points)
   end function size_counts

   !> How many points are open, stick and slip, for the member `counts`.
   pure function status_counts(status) result(text)
      integer, intent(in) :: status(:) !! statuses of the points
      character(:), allocatable :: text

      text = '"open": '//to_text(count(status == open_point))//', "stick": '//to_text(count(status == stick_point)) &
         //', "slip": '//to_text(count(status == slip_plus .or. status == slip_minus))
   end function status_counts

   !> Quantities as a member.
   pure function quantities_member(name, quantities) result(text)
      character(*), intent(in) :: name !! its name
      type(quantity_t), intent(in) :: quantities(:) !! the quantities
      character(:), allocatable :: text

      text = member(name, '{'//quantity_members(quantities)//'}')
   end function quantities_member

   !> What a solution must fulfill, as a member: the verdict, the limit, the violations, and numbers that go with them.
   pure function certificate_member(violations, limit, others, head) result(text)
      type(quantity_t), intent(in) :: violations(:) !! the violations [-]
      real(dp), intent(in) :: limit !! what each may be at most [-]
      type(quantity_t), intent(in) :: others(:) !! the other numbers
      character(*), intent(in), optional :: head !! members that stand before these
      character(:), allocatable :: text

      text = ''
      if (present(head)) text = head
      text = member('certificate', '{'//text//'"passed": '//json_logical(all(violations%value <= limit))//', '// &
         quantity_members([quantity_t('limit', '', limit), violations, others])//'}')
   end function certificate_member

   !> Times and memory, and the end of the object.
   function last_members(timings) result(text)
      type(timings_t), intent(in) :: timings !! the times
      character(:), allocatable :: text
      integer :: i

      text = quantities_member('seconds', [(quantity_t(phase_names(i), '', timings%seconds(i)), &
         i=1, size(phase_names)), quantity_t('total', '', sum(timings%seconds))]) &
         //'  "peak_memory_mb": '//json_number(peak_memory_mb())//newline//'}'//newline
   end function last_members

   !> The text of a member's value, in a summary that was read, up to the comma or bracket behind it;
   !> empty if there is no such member.
   pure function member_value(summary, section, name) result(value)
      character(*), intent(in) :: summary !! the summary
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: name !! its name
      character(:), allocatable :: value
      integer :: first, last

      value = ''
      if (len(section) == 0) then
         first = index(summary, newline//'  "'//name//'": ') + 1
         last = first + index(summary(first:), newline) - 2
      else
         first = index(summary, newline//'  "'//section//'": {') + 1
         last = first + index(summary(first:), newline) - 2
         if (first > 1) first = first + index(summary(first:last), '"'//name//'": ') - 1
      end if
      if (first < 2 .or. summary(first:first) == newline .or. last < first) return
      first = first + index(summary(first:last), '": ') + 2
      if (len(section) > 0) last = first + scan(summary(first:last), ',}') - 2
      if (len(section) == 0 .and. summary(last:last) == ',') last = last - 1
      value = summary(first:last)
   end function member_value

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

   !> The numbers of a case on refined meshes as a member.
   pure function convergence_member(list) result(text)
      type(refined_quantity_t), intent(in) :: list(:) !! the numbers
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(list)
         associate (judged => list(i)%convergence)
            if (i > 1) text = text//', '
            text = text//json_string(trim(list(i)%quantity%key))//': {"values": ['//json_numbers(judged%value)// &
               '], "verdict": '//json_string(trim(verdict_names(judged%verdict)))//', '//quantity_members([ &
               quantity_t('order', '', judged%order), quantity_t('extrapolated', '', judged%extrapolated), &
               quantity_t('error_bar', '', judged%bar)])//'}'
         end associate
      end do
      text = member('convergence', '{'//text//'}')
   end function convergence_member

end module amontons_summary
