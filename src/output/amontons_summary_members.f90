!> What the summaries of decks, sweeps and reduced problems have in common: members of a JSON object, a line each.
module amontons_summary_members
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_json, only: number, number_members, numbers, string, truth
   use amontons_kinds, only: dp
   use amontons_system, only: peak_memory_mb
   use amontons_text, only: newline, to_text
   use amontons_timings, only: phase_names, timings_t
   use amontons_uniqueness, only: uniqueness_t
   use amontons_version, only: version
   use amontons_warning_list, only: warning_list_t
   implicit none (type, external)
   private

   public :: effort_members, head_members, last_members, member, resultants_member, size_counts, status_counts, &
      uniqueness_member, warnings_array

contains

   !> A member with others behind it.
   pure function member(name, value) result(text)
      character(*), intent(in) :: name !! its name
      character(*), intent(in) :: value !! its value in JSON
      character(:), allocatable :: text

      text = '  "'//name//'": '//value//','//newline
   end function member

   !> The beginning of the object: which case, and whether it was solved.
   pure function head_members(config, is_converged, warnings) result(text)
      type(config_t), intent(in) :: config !! the case
      logical, intent(in) :: is_converged !! whether all that was to be solved is solved
      type(warning_list_t), intent(in) :: warnings !! what is doubtful about it
      character(:), allocatable :: text

      text = '{'//newline//member('case', string(config%name))//member('title', string(config%title)) &
         //member('version', string(version))//member('method', string(config%method%method)) &
         //member('converged', truth(is_converged))//member('warnings', warnings_array(warnings))
   end function head_members

   !> Warnings as a JSON array of texts.
   pure function warnings_array(warnings) result(text)
      type(warning_list_t), intent(in) :: warnings !! the warnings
      character(:), allocatable :: text
      integer :: i

      text = '['
      do i = 1, warnings%n()
         if (i > 1) text = text//', '
         text = text//string(warnings%item(i))
      end do
      text = text//']'
   end function warnings_array

   !> What the method spent, and what it reached.
   pure function effort_members(solution) result(text)
      type(contact_solution_t), intent(in) :: solution !! the solution and its record
      character(:), allocatable :: text

      text = member('iterations', to_text(solution%n_iterations)) &
         //member('products', number(solution%effort%n_products)) &
         //member('factorizations', to_text(solution%effort%n_factorizations)) &
         //member('residual', number(solution%residual)) &
         //member('history', '['//numbers(solution%history(:solution%n_iterations))//']')
   end function effort_members

   !> What is known of uniqueness.
   pure function uniqueness_member(uniqueness) result(text)
      type(uniqueness_t), intent(in) :: uniqueness !! the bound
      character(:), allocatable :: text, bound

      bound = 'null'
      if (uniqueness%has_bound .and. .not. uniqueness%is_for_any) bound = number(uniqueness%friction)
      text = member('uniqueness', '{"guaranteed": '//truth(uniqueness%is_unique)//', "friction_below": '//bound &
         //', "exact": '//truth(uniqueness%is_exact)//'}')
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

   !> Sums of the contact forces.
   pure function resultants_member(normal, tangential) result(text)
      real(dp), intent(in) :: normal(:) !! normal forces [F]
      real(dp), intent(in) :: tangential(:) !! tangential forces [F]
      character(:), allocatable :: text

      text = member('resultants', '{'//number_members([character(16) :: 'normal_force', 'tangential_force'], &
         [sum(normal), sum(tangential)])//'}')
   end function resultants_member

   !> Times and memory, and the end of the object.
   function last_members(timings) result(text)
      type(timings_t), intent(in) :: timings !! the times
      character(:), allocatable :: text

      text = member('seconds', '{'//number_members(phase_names, timings%seconds)//', "total": ' &
         //number(sum(timings%seconds))//'}') &
         //'  "peak_memory_mb": '//number(peak_memory_mb())//newline//'}'//newline
   end function last_members

end module amontons_summary_members
