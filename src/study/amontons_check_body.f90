!> The check of a deck with a body: everything that can be wrong with it, and what solving it would take.
module amontons_check_body
   use amontons_body, only: body_t, estimate_body, estimate_t
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_outcome, only: outcome_t
   use amontons_result, only: result_t
   use amontons_solve_case, only: cache_t, prepare_case
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: check_body

contains

   !> Checks a deck with a body and reports its size.
   subroutine check_body(config, cases, cache, outcome, error)
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: cases !! the cases it has, as they are reported: ', 12 cases'; empty for one
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the deck needs another
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck
      type(result_t) :: result
      type(estimate_t) :: estimate

      call prepare_case(cache, config, result, error)
      if (allocated(error)) return
      call estimate_body(cache%body, config%condensation, result%timings, estimate, error)
      if (allocated(error)) return
      outcome%warnings = result%warnings
      outcome%text = config%name//': deck OK; '//size_text(cache%body)//cases//'; '//estimate_text(estimate)
   end subroutine check_body

   !> The size of a body.
   pure function size_text(body) result(text)
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable :: text

      text = to_text(body%mesh%n_nodes)//' nodes, '//to_text(body%mesh%n_elements)//' elements, '// &
         to_text(body%dof_map%n_dofs)//' unknowns, '//to_text(body%zone%n_points)//' contact points'
   end function size_text

   !> What solving it would take.
   pure function estimate_text(estimate) result(text)
      type(estimate_t), intent(in) :: estimate !! what solving the deck would take
      character(:), allocatable :: text

      if (estimate%half_width > 0) then
         text = 'band contact matrix of '//to_text(estimate%n_rows)//' rows with half width '// &
            to_text(estimate%half_width)
      else
         text = 'dense contact matrix of '//to_text(estimate%n_rows)//' rows'
      end if
      text = text//', '//estimate%factorization//' factor of '//to_text(estimate%n_entries)//' entries, about '// &
         to_text(ceiling(estimate%memory_mb))//' MB of memory'
      if (estimate%n_ranks > 1) text = text//' on each of '//to_text(estimate%n_ranks)//' ranks at most'
      if (estimate%memory_mb > estimate%available_mb) text = text//', but only '// &
         to_text(floor(estimate%available_mb))//' MB are available'
   end function estimate_text

end module amontons_check_body
