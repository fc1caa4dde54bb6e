!> What a deck says of the case as a whole: what it is called, and its units; a reduced problem from a file, in the
!> place of a body; the accuracy of its results, an error estimate and the same case on finer meshes; what a sweep or a
!> history leaves besides its table.
module amontons_config_case
   use amontons_case_label, only: case_label_t
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_history, only: fretting_names, history_t
   use amontons_kinds, only: dp
   use amontons_sweep, only: key_result_names, sweep_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: accuracy_options_t, describe_accuracy, describe_case, describe_output, describe_problem, &
      reduced_source_t

   !> The group of the case.
   type(group_t), parameter, public :: case_group = group_t('case')

   !> The group of the accuracy.
   type(group_t), parameter, public :: accuracy_group = group_t('accuracy')
   !> How errors are estimated, as a deck writes it.
   character(8), parameter :: estimate_names(2) = [character(8) :: 'recovery', 'none']
   !> Fewest refinements that show an order of convergence.
   integer, parameter :: fewest_refinements = 2

   !> What is asked of the accuracy.
   type :: accuracy_options_t
      character(8) :: estimate = 'recovery' !! one of `estimate_names`
      integer :: n_refinements = 0 !! on how many meshes, each refined from the one before, the case is solved again
   contains
      procedure :: wants_estimate => accuracy_wants_estimate
   end type accuracy_options_t

   !> The group of what is written.
   type(group_t), parameter, public :: output_group = group_t('output')

   !> The group of the problem.
   type(group_t), parameter, public :: problem_group = group_t('problem')
   !> Kinds of problems, as a deck writes them.
   character(7), parameter :: kind_names(2) = [character(7) :: 'body', 'reduced']

   !> Where a reduced problem comes from.
   type :: reduced_source_t
      logical :: is_given = .false. !! whether the problem is a reduced one
      character(:), allocatable :: file !! name of its file, as messages tell it
      character(:), allocatable :: path !! name of its file from the root on
      character(:), allocatable :: origin !! where the file was named, for messages: 'deck.nml:12: '; may be empty
      logical :: has_friction = .false. !! whether `friction` takes the place of the file's coefficients
      real(dp) :: friction = 0.0_dp !! Coulomb coefficient of all contacts [-]
   end type reduced_source_t

contains

   !> Describes `&case`: name and title.
   subroutine describe_case(visitor, label)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      class(case_label_t), intent(inout) :: label !! what the case is called; its file is set
      ! File names end at 255 characters; temporary ones add up to 30 to the name.
      integer, parameter :: longest_name = 200
      character, parameter :: blank = ' '
      integer :: i, last_point
      logical :: has_units

      if (.not. allocated(label%name)) then
         label%name = label%file(index(label%file, '/', back=.true.) + 1:)
         last_point = index(label%name, '.', back=.true.)
         if (last_point > 1) label%name = label%name(:last_point - 1)
      end if
      call visitor%open_group(case_group)
      call visitor%text(key_t('name', 'name of the case and of its files; 1 to 200 characters, without `/`', &
         default="name of the deck's file without its folder and last extension", also='job id'), label%name)
      call visitor%text(key_t('title', 'what the case is about, for the listing', also='heading description'), &
         label%title)
      has_units = is_filled(label%units)
      call visitor%text(key_t('units', "names of the units of length, force and stress, as `'mm, N, MPa'`, to label"// &
         ' listing, grids, figures and report; nothing is converted', default='none', is_filled=.true., also='unit'), &
         label%units, has_units)
      call visitor%close_group()
      call visitor%require(.not. has_units .or. are_units(label%units), 'units', &
         "units must name a length, a force and, if you like, a stress: 'mm, N, MPa'")
      if (len_trim(label%name) == 0 .or. len(label%name) > longest_name .or. &
         any([(label%name(i:i) < blank .or. label%name(i:i) == '/', i=1, len(label%name))])) then
         call visitor%deck%fault(visitor%place, 'name', 'name must be usable as a file name: 1 to '// &
            to_text(longest_name)//" characters without '/' and control characters")
      end if
   end subroutine describe_case

   !> Whether a text is two or three names of units, commas between them.
   pure logical function are_units(text)
      character(*), intent(in) :: text !! the text
      integer :: i, n_commas

      n_commas = 0
      are_units = .true.
      do i = 1, len(text)
         if (text(i:i) /= ',') cycle
         n_commas = n_commas + 1
         are_units = are_units .and. len_trim(text(:i - 1)) > scan(text(:i - 1), ',', back=.true.)
      end do
      are_units = are_units .and. len_trim(text) > scan(text, ',', back=.true.) .and. (n_commas == 1 .or. n_commas == 2)
   end function are_units

   !> Describes `&accuracy`.
   subroutine describe_accuracy(visitor, accuracy, has_many_cases)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(accuracy_options_t), intent(inout) :: accuracy !! what is asked
      logical, intent(in) :: has_many_cases !! whether the deck has a sweep or a history
      logical :: is_given

      is_given = accuracy%n_refinements > 0
      call visitor%open_group(accuracy_group)
      call visitor%word(key_t('estimate', 'estimate of the error of the stresses of every element: by recovered'// &
         ' stresses, or none, which saves some time', also='error'), accuracy%estimate, estimate_names)
      call visitor%whole(key_t('refinements', 'the case is solved on its mesh and on so many refined ones, and the'// &
         ' key results get error bars', default='none', at_least=real(fewest_refinements, dp), also='refine levels'), &
         accuracy%n_refinements, is_given)
      call visitor%close_group()
      call visitor%only('refinements', .not. has_many_cases, 'a deck without &sweep and &history')
   end subroutine describe_accuracy

   !> Whether errors are estimated.
   pure logical function accuracy_wants_estimate(self)
      class(accuracy_options_t), intent(in) :: self !! what is asked

      accuracy_wants_estimate = self%estimate == estimate_names(1)
   end function accuracy_wants_estimate

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

   !> Describes `&problem`.
   subroutine describe_problem(visitor, reduced)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(reduced_source_t), intent(inout) :: reduced !! the reduced problem, if there is one
      character(len(kind_names)) :: kind
      logical :: has_kind, has_file

      kind = kind_names(merge(2, 1, reduced%is_given))
      has_kind = reduced%is_given
      has_file = is_filled(reduced%path)
      call visitor%open_group(problem_group)
      call visitor%word(key_t('kind', 'a body, described by the groups below; or a reduced problem from a file'), &
         kind, kind_names, has_kind)
      call visitor%text(key_t('file', "with `kind = 'reduced'`: name of its file, seen from the deck's folder", &
         is_file=.true., is_filled=.true., also='filename path'), reduced%path, has_file)
      call visitor%real(key_t('friction', "with `kind = 'reduced'`: Coulomb's coefficient of all contacts, in the"// &
         " place of the file's", default="the file's", at_least=0.0_dp, also='mu'), reduced%friction, &
         reduced%has_friction)
      call visitor%close_group()
      reduced%file = reduced%path
      reduced%is_given = kind == 'reduced'
      call visitor%locate('file', reduced%origin)
      if (visitor%is_judging()) then
         call visitor%only('file', reduced%is_given, "kind = 'reduced'")
         call visitor%only('friction', reduced%is_given, "kind = 'reduced'")
         call visitor%require(has_file .or. .not. reduced%is_given, 'kind', "kind = 'reduced' needs file = 'PROBLEM'")
      else if (visitor%place > 0) then
         ! A body that is missing here is not missed as well.
         reduced%is_given = reduced%is_given .or. visitor%deck%count_groups('mesh') == 0
      end if
   end subroutine describe_problem

end module amontons_config_case
