!> What a deck says of what a sweep or a history leaves besides its table.
module amontons_config_output
   use amontons_deck_visitor, only: deck_visitor_t, group_t, key_t
   use amontons_history, only: fretting_names, history_t
   use amontons_kinds, only: dp
   use amontons_sweep, only: key_result_names, sweep_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: describe_output

   !> The group of what is written.
   type(group_t), parameter, public :: output_group = group_t('output')

contains

   !> Describes `&output`: what a sweep or a history leaves besides its table.
   subroutine describe_output(visitor, sweep, history)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(sweep_t), intent(inout) :: sweep !! the sweep
      type(history_t), intent(inout) :: history !! the history
      character(len(key_result_names)) :: key_results
      integer :: fields_every
      logical :: has_fields, has_key_results

      fields_every = max(sweep%fields_every, history%fields_every)
      has_fields = fields_every > 0
      call visitor%open_group(output_group)
      call visitor%whole(key_t('fields_every', 'with `&sweep` or `&history`: the fields of case or step 1 and of'// &
         ' every so-many-th behind it are written as `.vtu`', default='none', at_least=1.0_dp, &
         also='out every frequency'), fields_every, has_fields)
      has_key_results = sweep%has_body_results
      key_results = key_result_names(merge(2, 1, sweep%has_body_results))
      call visitor%word(key_t('key_results', 'with `&sweep`: the key results of each case, those of the contact'// &
         ' points or all, with the largest von Mises stress and displacement of the body, which take longer', &
         default="`'contact'`"), key_results, key_result_names, has_key_results)
      sweep%has_body_results = key_results == key_result_names(2)
      call describe_steps(visitor, history)
      call visitor%close_group()
      if (sweep%is_given()) sweep%fields_every = fields_every
      if (history%is_given) history%fields_every = fields_every
      call visitor%only('fields_every', sweep%is_given() .or. history%is_given, 'a deck with &sweep or &history')
      call visitor%only('key_results', sweep%is_given(), 'a deck with &sweep')
      call visitor%only('points_every', history%is_given, 'a deck with &history')
      call visitor%only('states_every', history%is_given, 'a deck with &history')
      call visitor%only('probe', history%is_given, 'a deck with &history')
      call visitor%only('fretting', history%is_given, 'a deck with &history')
      if (allocated(history%probes)) call visitor%require(modulo(size(history%probes), 2) == 0, 'probe', &
         'probe needs two coordinates for each node, found '//to_text(size(history%probes))//' numbers')
   end subroutine describe_output

   !> Describes what a history leaves of its steps.
   subroutine describe_steps(visitor, history)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(history_t), intent(inout) :: history !! the history
      character(len(fretting_names)) :: fretting
      logical :: has_points, has_states, has_probes, has_fretting

      has_points = history%points_every > 0
      has_states = history%states_every > 0
      has_probes = history%n_probes() > 0
      call visitor%whole(key_t('points_every', 'with `&history`: the contact points of step 1 and of every'// &
         ' so-many-th step behind it are written as a table', default='none', at_least=1.0_dp), history%points_every, &
         has_points)
      call visitor%whole(key_t('states_every', 'with `&history`: all that another history needs to `start` from'// &
         ' step 1 or from a so-many-th step behind it is written', default='none', at_least=1.0_dp), &
         history%states_every, has_states)
      call visitor%list(key_t('probe', 'with `&history`: coordinates of nodes, x and y in turn, whose displacements'// &
         ' the table of the history shows', 'L', default='none', also='probes'), history%probes, has_probes)
      has_fretting = history%has_fretting
      fretting = fretting_names(merge(2, 1, history%has_fretting))
      call visitor%word(key_t('fretting', 'with `&history`: whether the stress along the surface and the parameters'// &
         ' of Ruiz and of Smith, Watson and Topper are computed at each contact point', default="`'none'`"), fretting, &
         fretting_names, has_fretting)
      history%has_fretting = fretting == fretting_names(2)
   end subroutine describe_steps

end module amontons_config_output
