!> The files of a history, which grow with its steps: NAME.history.csv has a row for each step, NAME.points.csv one for
!> each contact point of selected steps, NAME.states.csv one with everything that is needed to continue after a step,
!> NAME.history.pvd the grids of selected steps, NAME.cycles.csv a row for each cycle.
!>
!> The tables are those of a checkpoint: a run that was interrupted is continued after the last rows saved. The progress
!> is a list of numbers, from which another history may start as well.
! allow(S271): gfortran 12 fails if the modules are in order
module amontons_history_files
   use amontons_case_label, only: case_label_t
   use amontons_body, only: body_t
   use amontons_checkpoint, only: archive_t, checkpoint_t, new_checkpoint
   use amontons_document, only: field, status_runs
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_friction_law, only: status_names, tangential_norm
   use amontons_history, only: history_t, is_shown
   use amontons_history_model, only: history_model_t, new_step_state, step_state_t
   use amontons_input_file, only: read_text_file
   use amontons_key_results, only: lengths_t, new_lengths, resultants, wear_results
   use amontons_kinds, only: dp
   use amontons_manifest, only: case_entries, collection_head, collection_tail, manifest_t
   use amontons_output_file, only: output_file_t, remove_temporaries
   use amontons_quantity, only: quantity_t
   use amontons_result, only: result_t
   use amontons_system, only: make_directory
   use amontons_text, only: as_lines, comma_separated, line_end, longest_decimal, newline, put_decimals, put_integer, &
      read_reals, replaced, to_text
   use amontons_time_stepping, only: cycle_outcomes, n_parameters, n_plain_numbers, parameter_names, time_stepping_t
   use amontons_vtu, only: write_grids
   implicit none (type, external)
   private

   public :: history_files_t, history_table_t, history_tables, read_start, step_numbers

   !> Content of a table: the steps.
   integer, parameter :: of_steps = 1
   !> Content of a table: the contact points of steps.
   integer, parameter :: of_points = 2
   !> Content of a table: the states at the end of steps.
   integer, parameter :: of_states = 3
   !> Content of a table: the grids of steps.
   integer, parameter :: of_grids = 4
   !> Content of a table: the cycles.
   integer, parameter :: of_cycles = 5

   !> Kind of a column: a number compared by its own size, or by 1.
   integer, parameter, public :: number_alone = 1
   !> Kind of a column: forces.
   integer, parameter, public :: a_force = 2
   !> Kind of a column: displacements, slips, gaps.
   integer, parameter, public :: a_length = 3
   !> Kind of a column: energies and works.
   integer, parameter :: an_energy = 4
   !> Kind of a column: moments.
   integer, parameter, public :: a_moment = 5
   !> The first of the kinds of columns whose scale is their own largest number.
   integer, parameter :: own_scale = 6
   !> Number of kinds.
   integer, parameter, public :: n_kinds = own_scale + 7
   !> The kinds of the columns of fretting parameters.
   integer, parameter :: parameter_kinds(n_parameters) = [own_scale + 1, own_scale + 2, own_scale + 3, own_scale + 4, &
      number_alone]

   !> A table.
   type :: history_table_t
      integer :: content = of_steps !! its content, one of `of_steps` ...
      character(:), allocatable :: ending !! suffix of its file name, after the name of the case
      character(:), allocatable :: header !! its first lines
      integer, allocatable :: kinds(:) !! kind of each column; `number_alone` for words
      real(dp), allocatable, private :: row(:)
         !! numbers of a row, and room for more; where it is allocated, columns leave their numbers, not their names
      integer, private :: n = 0 !! number of numbers of the row
   contains
      procedure, private :: add => history_table_add
      procedure, private :: add_quantities => history_table_add_quantities
   end type history_table_t

   !> The files of a history, under temporary names until the history is reported.
   type :: history_files_t
      character(:), allocatable :: directory !! output directory, a slash behind it
      character(:), allocatable :: name !! name of the case
      character(:), allocatable :: folder !! folder of the grids in it, a slash behind it
      type(checkpoint_t) :: checkpoint !! the tables as they grow
      type(history_table_t), allocatable :: tables(:) !! what they have, in the same order
      integer :: grids_table = 0 !! which of them lists the grids; 0 without grids
      character(:), allocatable :: units !! names of the units of the case
      type(manifest_t) :: grids !! the manifest of the grids
   contains
      procedure :: add_fields => history_files_add_fields
      procedure :: add_step => history_files_add_step
      procedure :: finish => history_files_finish
      procedure :: is_due => history_files_is_due
      procedure :: open => history_files_open
      procedure :: prepare => history_files_prepare
   end type history_files_t

contains

   !=cycles.csv `cycle`, `begin`, `end`, `steps` | – | number of the cycle as `cycles` counts, pseudo-times of its
   !=   beginning and end, number of its steps
   !=cycles.csv `work`, `strain_energy_change`, `dissipation` | F L | of all loads, supports and obstacles; end less
   !=   beginning; what friction took
   !=cycles.csv `energy_error` | F L | `work` less the other two
   !=cycles.csv `max_slip_accumulated` | L | largest sum of the slips of a point in the cycle, each counted positive
   !=cycles.csv `max_drift` | L | largest slip from its beginning to its end
   !=cycles.csv `dissipation_change`, `force_change` | – | dissipation less that of the cycle before, over the larger;
   !=   largest difference of a contact force between beginning and end, over the largest force
   !=cycles.csv `drift_change` | L | largest difference of a point's drift from that in the cycle before
   !=cycles.csv `max_ruiz_1`, `max_ruiz_2`, `max_swt` | F/L, F²/L³, F/L² | with `fretting`: largest of all points
   !=cycles.csv `outcome` | – | `first`, `shakedown`, `steady`, `ratcheting` or `changing`: [what it
   !=   is](guide.md#cycles)
   !> Describes the tables of a history, that of the steps first.
   pure subroutine history_tables(tables, model, body, n_noted)
      type(history_table_t), allocatable, intent(out) :: tables(:) !! the tables
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: n_noted !! how many numbers a state notes of the cycle under way
      character(*), parameter :: endings(*) = [character(12) :: '.history.csv', '.points.csv', '.states.csv', &
         '.history.pvd', '.cycles.csv']
      character(*), parameter :: state_labels(*) = [character(23) :: 'status', 'normal_force', 'tangential_force', &
         'normal_displacement', 'tangential_displacement', 'anchor', 'slip_accumulated', 'dissipation', 'worn', &
         'added_gap', 'wear_depth']
      integer, parameter :: state_kinds(size(state_labels)) = [number_alone, a_force, a_force, a_length, a_length, &
         a_length, a_length, an_energy, an_energy, own_scale + 7, own_scale + 7]
      ! Which of these have a second tangent, around the axis of a twisted body.
      integer, parameter :: directed(*) = [3, 5, 6]
      type(step_state_t) :: rest
      integer, allocatable :: contents(:)
      character(6) :: second
      logical :: in_space
      integer :: axis, i, k, p

      in_space = size(body%zone%position, 1) == 3
      second = merge('_theta', '_2    ', body%materials%is_twisted())
      associate (history => model%history)
         contents = pack([of_steps, of_points, of_states, of_grids, of_cycles], [.true., history%points_every > 0, &
            history%states_every > 0, history%fields_every > 0, size(model%cycle_times) > 0])
         allocate (tables(size(contents)))
         do i = 1, size(tables)
            tables(i)%content = contents(i)
            tables(i)%ending = trim(endings(contents(i)))
            tables(i)%header = ''
            allocate (tables(i)%kinds(0))
            select case (contents(i))
            case (of_steps)
               call new_step_state(rest, model, body)
               rest%instant%numbers = spread(0.0_dp, 1, 3*size(history%steps))
               call tables(i)%add('step', number_alone)
               call add_step(tables(i), model, body, rest)
               call tables(i)%add('iterations,statuses', number_alone)
            case (of_points)
               call tables(i)%add('step,'//history%name//',point', number_alone)
               call tables(i)%add('x,y'//trim(merge(',z', '  ', in_space))//',area', own_scale)
               call tables(i)%add('normal_force,tangential_force', a_force)
               if (in_space) call tables(i)%add('force_x,force_y,force_z', a_force)
               if (body%materials%is_twisted()) call tables(i)%add('tangential_force_theta', a_force)
               call tables(i)%add('contact_pressure,contact_shear', own_scale + 5)
               if (body%materials%is_twisted()) call tables(i)%add('contact_shear_theta', own_scale + 5)
               call tables(i)%add('gap,slip', a_length)
               if (body%materials%is_twisted()) call tables(i)%add('slip_theta', a_length)
               if (in_space) call tables(i)%add('slip_x,slip_y,slip_z', a_length)
               call tables(i)%add('slip_step,slip_accumulated', a_length)
               call tables(i)%add('dissipation', an_energy)
               call tables(i)%add('wear_integral', own_scale + 6)
               call tables(i)%add('wear_depth', own_scale + 7)
               do k = 1, merge(n_parameters, 0, history%has_fretting)
                  call tables(i)%add(trim(parameter_names(k)), parameter_kinds(k))
               end do
               call tables(i)%add('status', number_alone)
            case (of_states)
               call tables(i)%add('step,steps_given_up,iterations,length,noted,'//history%name, number_alone)
               call tables(i)%add('work_loads,work_supports,work_obstacles', an_energy)
               call tables(i)%add('carried_force', a_force)
               call tables(i)%add('carried_energy', an_energy)
               call tables(i)%add('residual,iterations_step', number_alone)
               do k = 1, size(body%lockable)
                  call tables(i)%add('lock_'//to_text(k), number_alone)
               end do
               do k = 1, size(state_labels)
                  do axis = 1, merge(body%zone%n_tangents, 1, any(k == directed))
                     do p = 1, body%zone%n_points
                        call tables(i)%add(trim(state_labels(k))//trim(merge(second, '      ', axis == 2))//'_'// &
                           to_text(p), state_kinds(k))
                     end do
                  end do
               end do
               do k = 1, n_noted
                  call tables(i)%add('noted_'//to_text(k), own_scale)
               end do
            case (of_cycles)
               call tables(i)%add('cycle,begin,end,steps', number_alone)
               call tables(i)%add('work,strain_energy_change,dissipation,energy_error', an_energy)
               call tables(i)%add('max_slip_accumulated,max_drift', a_length)
               call tables(i)%add('dissipation_change,force_change', number_alone)
               call tables(i)%add('drift_change', a_length)
               do k = 2, merge(n_parameters - 1, 0, history%has_fretting)
                  call tables(i)%add('max_'//trim(parameter_names(k)), parameter_kinds(k))
               end do
               call tables(i)%add('outcome', number_alone)
            case default
               tables(i)%header = collection_head
            end select
            if (contents(i) /= of_grids) tables(i)%header = tables(i)%header//newline
         end do
      end associate
   end subroutine history_tables

   !> Adds columns of one kind to the table of the steps: to its header, or their numbers to the present row.
   pure subroutine history_table_add(self, names, kind, values, number)
      class(history_table_t), intent(inout) :: self !! the table
      character(*), intent(in) :: names !! names of the columns, commas between them; or a single one in quotes
      integer, intent(in) :: kind !! their kind
      real(dp), intent(in), optional :: values(:) !! their numbers in a row
      integer, intent(in), optional :: number !! suffix of all names, after a `_`; none with 0
      character(:), allocatable :: all
      integer :: i, n

      if (allocated(self%row) .and. present(values)) then
         self%row(self%n + 1:self%n + size(values)) = values
         self%n = self%n + size(values)
         return
      end if
      n = 1
      if (index(names, '"') /= 1) n = 1 + count([(names(i:i) == ',', i=1, len(names))])
      all = names
      if (present(number)) then
         if (number > 0) all = replaced(names, ',', '_'//to_text(number)//',')//'_'//to_text(number)
      end if
      if (len(self%header) > 0) self%header = self%header//','
      self%header = self%header//all
      self%kinds = [self%kinds, spread(kind, 1, n)]
   end subroutine history_table_add

   !> Adds a column for each of some quantities.
   pure subroutine history_table_add_quantities(self, quantities, values)
      class(history_table_t), intent(inout) :: self !! the table
      type(quantity_t), intent(in) :: quantities(:) !! the quantities, for their names and dimensions
      real(dp), intent(in) :: values(:) !! their numbers in a row
      character(3), parameter :: dimensions(*) = [character(3) :: '', 'L', 'F', 'F L', 'L^3']
      integer, parameter :: kinds(*) = [number_alone, a_length, a_force, a_moment, own_scale]
      integer :: i

      if (allocated(self%row)) call self%add('', number_alone, values)
      do i = 1, merge(0, size(quantities), allocated(self%row))
         call self%add(field(trim(quantities(i)%key)), &
            kinds(findloc(dimensions == quantities(i)%dimension, .true., dim=1)))
      end do
   end subroutine history_table_add_quantities

   !=history.csv `step` | – | number of the step, from 1
   !=history.csv `time` | – | the pseudo-time at its end; called as `name` of `&history` says
   !=history.csv `factor_NAME`, `shift_x_NAME`, `shift_y_NAME`, `turn_NAME`, `friction_factor_NAME` | –, L, rad | a
   !=   column for each number of each `&steps`, in the deck's order; `shift_z_NAME` of a solid in the place of
   !=   `turn_NAME`; `motion_factor_NAME` of a support where the load of its name, as that of a rigid set, has `&steps`,
   !=   too
   !=history.csv `open_length`, `slip_length`, `stick_length` | L | as in [Lengths](#lengths); `open_area`, `slip_area`,
   !=   `stick_area` [L²] of a solid
   !=history.csv `normal_force`, `tangential_force` | F | sums over the contact points, of a solid the latter of
   !=   magnitudes
   !=history.csv `work_loads`, `work_supports`, `work_obstacles` | F L | work done on the body since rest by loads,
   !=   moving supports and moving obstacles
   !=history.csv `strain_energy` | F L | of body and elastic foundations, $\tfrac12 u \cdot K u$; a temperature counts
   !=   as the load that causes the same displacements, and its work as that of this load
   !=history.csv `dissipation_step`, `dissipation` | F L | what friction took in the step, and since rest
   !=history.csv `closing_loss` | F L | sum of normal force times gap at the beginning of the step
   !=history.csv `step_indicator` | – | energy error of the step over its energies
   !=history.csv `energy_error` | F L | works less strain energy and dissipation: vanishes with the length of the steps
   !=history.csv `max_slip_step`, `max_slip_accumulated` | L | largest slip of the step; largest sum of the slips of all
   !=   steps, each counted positive
   !=history.csv `residual` | – | of the step's contact problem
   !=history.csv `open_length_1`, `slip_length_1`, `stick_length_1`, `normal_force_1`, `tangential_force_1`,
   !=   `open_length_2`, ... | L, F | the same of each contact set, where there are several
   !=history.csv `ux_1`, `uy_1`, ... | L | displacements of the nodes at `probe`; of a twisted body `utheta_1`, of a
   !=   solid `uz_1`, too
   !=history.csv `reaction_x_NAME`, `force_normal_NAME`, `tie_x_NAME`, ... | F, F L | [forces by name](#forces-by-name),
   !=   all of their components
   !=history.csv `max_wear_depth`, `wear_volume_NAME`, ... | L, L³ | with `wear`: largest depth worn so far, volume that
   !=   each contact set or pair by name has lost
   !=history.csv `iterations` | – | of the step
   !=history.csv `statuses` | – | along the contact lines as run lengths, as in a [sweep](#namesweepcsv)
   !> Adds the columns of a step between its number and its iterations.
   pure subroutine add_step(table, model, body, state)
      type(history_table_t), intent(inout) :: table !! the table
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state at the end of the step, or at rest
      type(quantity_t), allocatable :: worn(:)
      integer :: i, k, n

      call table%add(model%history%name, number_alone, [state%instant%time])
      n = 0
      do i = 1, size(model%history%steps)
         do k = 1, model%history%steps(i)%n_numbers()
            n = n + 1
            call table%add(field(model%history%steps(i)%label(k, size(body%mesh%coordinates, 1))), number_alone, &
               state%instant%numbers(n:n))
         end do
      end do
      call add_contact_set(table, body, state, 0)
      call table%add('work_loads,work_supports,work_obstacles,strain_energy,dissipation_step,dissipation,'// &
         'closing_loss', an_energy, [state%load_work, state%support_work, state%obstacle_work, state%strain_energy, &
         state%step_dissipation, sum(state%dissipation), state%closing_loss])
      call table%add('step_indicator', number_alone, [state%indicator])
      call table%add('energy_error', an_energy, [state%energy_error()])
      call table%add('max_slip_step,max_slip_accumulated', a_length, max(0.0_dp, [maxval(tangential_norm(state%slip, &
         size(state%worn))), maxval(state%accumulated_slip)]))
      call table%add('residual', number_alone, [state%solution%residual])
      ! A single contact set has the numbers of all.
      do i = 1, merge(size(body%zone%pairs), 0, size(body%zone%pairs) > 1)
         call add_contact_set(table, body, state, i)
      end do
      call table%add_quantities(model%probe_names, model%probed(body, state))
      call table%add_quantities(model%named, state%named)
      worn = wear_results(body, model%solver%loads%base%contacts, state%wear_depth)
      call table%add_quantities(worn, worn%value)
   end subroutine add_step

   !> Adds zone lengths and sums of contact forces of all contact sets, or of one.
   pure subroutine add_contact_set(table, body, state, set)
      type(history_table_t), intent(inout) :: table !! the table
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state at the end of a step, or at rest
      integer, intent(in) :: set !! number of the contact set; 0 for all
      type(lengths_t) :: lengths
      type(quantity_t) :: forces(2)

      call new_lengths(lengths, body%zone, state%solution%status, set)
      call table%add(trim(merge('open_area,slip_area,stick_area      ', 'open_length,slip_length,stick_length', &
         lengths%are_areas)), number_alone, [lengths%open, lengths%slip, lengths%stick], set)
      forces = resultants(merge(state%solution%force, 0.0_dp, [spread(set == 0 .or. body%zone%set == set, 2, 1 &
         + body%zone%n_tangents)]), body%zone%n_points, lengths%are_areas)
      call table%add('normal_force,tangential_force', a_force, forces%value, set)
   end subroutine add_contact_set

   !> The rows that the last step adds to a table; empty for that of the grids.
   function table_rows(table, model, body, stepping) result(rows)
      type(history_table_t), intent(in) :: table !! the table
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      type(time_stepping_t), intent(in) :: stepping !! the time stepping at the end of the step
      character(:), allocatable :: rows, runs
      real(dp), allocatable :: numbers(:)

      rows = ''
      select case (table%content)
      case (of_steps)
         call status_runs(runs, stepping%state%solution%status, body%zone%set)
         rows = to_text(stepping%n_steps)//','//comma_separated(step_numbers(table, model, body, stepping%state))// &
            ','//to_text(stepping%state%solution%n_iterations)//','//runs//newline
      case (of_points)
         if (is_shown(stepping%n_steps, model%history%points_every)) rows = points_rows(model, body, stepping)
      case (of_states)
         if (.not. is_shown(stepping%n_steps, model%history%states_every)) return
         numbers = stepping%numbers()
         rows = to_text(stepping%n_steps)//','//comma_separated(numbers(2:))//newline
      case (of_cycles)
         if (.not. stepping%record%is_finished) return
         numbers = stepping%record%numbers
         rows = to_text(nint(numbers(1)))//','//comma_separated(numbers(2:3))//','//to_text(nint(numbers(4)))//','// &
            comma_separated(numbers(5:n_plain_numbers - 1))
         if (model%history%has_fretting) rows = rows//','//comma_separated(numbers(n_plain_numbers + 1:))
         rows = rows//','//trim(cycle_outcomes(nint(numbers(n_plain_numbers))))//newline
      case default
         continue
      end select
   end function table_rows

   !> Numbers of a row of NAME.history.csv, those between the columns `step` and `iterations`.
   pure function step_numbers(table, model, body, state) result(numbers)
      type(history_table_t), intent(in) :: table !! the table of the steps
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state at its end
      real(dp), allocatable :: numbers(:)
      type(history_table_t) :: again

      allocate (again%row(size(table%kinds)))
      call add_step(again, model, body, state)
      numbers = again%row(:again%n)
   end function step_numbers

   !=points.csv `step`, `time`, `point` | – | number and pseudo-time of the step, number of the point
   !=points.csv `area` | L² | area that the point represents: its length times the thickness, or all around the axis
   !=points.csv `x`, `y`, `normal_force`, `tangential_force`, `contact_pressure`, `contact_shear`, `gap`, `status` | |
   !=   as in [`NAME.contact.csv`](#namecontactcsv), at the end of the step
   !=points.csv `slip` | L | tangential displacement less that of the obstacle, since rest; points that a support guides
   !=   along one direction count as not slipping here and in the next columns, while `NAME.contact.csv` has their
   !=   tangential displacement in `slip`
   !=points.csv `slip_step`, `slip_accumulated` | L | slip of the step; sum of the slips of all steps, each counted
   !=   positive
   !=points.csv `dissipation` | F L | what friction took at the point since rest
   !=points.csv `wear_integral` | F/L | $\int p\, \lvert ds \rvert$ since rest: times a wear coefficient [L²/F] the
   !=   [wear depth](guide.md#wear) after Archard; it counts the way on the obstacle also where a support holds the
   !=   point along its tangent
   !=points.csv `wear_depth` | L | depth worn by the key `wear` of `&contact`, the step included; the next step has it
   !=   in its gap
   !=points.csv `surface_stress`, `ruiz_1`, `ruiz_2`, `swt`, `swt_angle` | F/L², F/L, F²/L³, F/L², rad | with
   !=   `fretting`: stress along the surface, in a solid the larger principal stress in it, and
   !=   [parameters](guide.md#fretting) of the cycle so far
   !=points.csv `tangential_force_theta`, `contact_shear_theta`, `slip_theta` | F, F/L², L | of a twisted body: the same
   !=   around the axis; `slip_step` is then a length
   !=points.csv `z`, `force_x`, `force_y`, `force_z`, `slip_x`, `slip_y`, `slip_z` | L, F, L | of a solid: force of the
   !=   obstacle on the body, and slip since rest; `tangential_force`, `contact_shear`, `slip` and `slip_step` are then
   !=   magnitudes
   !> The rows of the contact points of a step. The slip is the distance that a point has moved on the obstacle along
   !> its tangent, the gap is the remaining one.
   pure function points_rows(model, body, stepping) result(rows)
      type(history_model_t), intent(in) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(time_stepping_t), intent(in) :: stepping !! the time stepping at the end of the step
      character(:), allocatable :: rows, start, lines(:)
      real(dp), allocatable :: record(:, :), forces(:, :), slips(:, :), nodal(:), shears(:, :)
      real(dp) :: gap(body%zone%n_points)
      integer :: p, m, n, length

      m = body%zone%n_points
      record = stepping%point_record(body)
      start = to_text(stepping%n_steps)//','//to_text(stepping%state%instant%time)//','
      allocate (character(len(start) + (18 + size(record, 2))*(longest_decimal + 1)) :: lines(m))
      associate (state => stepping%state, zone => body%zone)
         gap = model%solver%loads%gap_of(state%instant) - state%solution%displacement(:m)
         ! Along each tangent; in space magnitudes, and the vectors behind them.
         n = merge(1, zone%n_tangents, size(zone%position, 1) == 3)
         slips = reshape(state%solution%displacement(m + 1:) - state%instant%motion, [m, zone%n_tangents])
         forces = reshape(state%solution%force(m + 1:), shape(slips))
         nodal = zone%nodal_forces(state%solution%force)
         shears = reshape(nodal(m + 1:), shape(slips))
         if (n < zone%n_tangents) shears = reshape(tangential_norm([shears], m), [m, 1])
         if (n < zone%n_tangents) then
            forces = reshape([tangential_norm([forces], m), -transpose(zone%global_vectors(state%solution%force))], &
               [m, 4])
            slips = reshape([tangential_norm([slips], m), transpose(zone%global_vectors([0.0_dp*gap, slips]))], [m, 4])
         end if
         do p = 1, m
            lines(p) = start
            length = len(start)
            call put_integer(lines(p), length, p)
            call put_decimals(lines(p), length, [zone%position(:, p), zone%area(p), state%solution%force(p), &
               forces(p, :), nodal(p)/zone%area(p), shears(p, :)/zone%area(p), gap(p), slips(p, :), &
               record(p, :)])
            lines(p)(length + 1:) = ','//status_names(state%solution%status(p))
         end do
      end associate
      rows = as_lines(lines)
   end function points_rows

   !> Describes the tables that the deck asks for, still without files.
   subroutine history_files_prepare(self, model, body, stepping, directory, label)
      class(history_files_t), intent(inout) :: self !! the files
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      type(time_stepping_t), intent(in) :: stepping !! the time stepping at its start
      character(*), intent(in) :: directory !! output directory
      class(case_label_t), intent(in) :: label !! name, title and units of the case
      integer :: i

      self%directory = directory//'/'
      self%name = label%name
      self%folder = label%name//'.history/'
      self%units = label%units
      call new_checkpoint(self%checkpoint, directory//'/'//label%name//'.history')
      call history_tables(self%tables, model, body, size(stepping%record%saved_numbers()))
      self%grids_table = findloc(self%tables%content, of_grids, dim=1)
      do i = 1, size(self%tables)
         call self%checkpoint%add_table(self%directory//self%name//self%tables(i)%ending//'.part', &
            self%tables(i)%header)
      end do
   end subroutine history_files_prepare

   !> Opens the files; they continue those of an interrupted run of the same history.
   subroutine history_files_open(self, key, progress, error)
      class(history_files_t), intent(inout) :: self !! the files, prepared
      character(*), intent(in) :: key !! everything that the history depends on, lines of text
      type(archive_t), allocatable, intent(out) :: progress
         !! the progress of an earlier run; not allocated if there is none
      type(error_t), allocatable, intent(out) :: error !! they cannot be written

      call make_directory(self%directory, error)
      if (.not. allocated(error) .and. self%grids_table > 0) call make_directory(self%directory//self%folder, error)
      if (.not. allocated(error)) call self%checkpoint%open(key, progress, error)
      if (.not. allocated(error) .and. self%grids_table > 0) call remove_temporaries(self%directory//self%folder)
   end subroutine history_files_open

   !> Adds the rows of a step to all tables.
   subroutine history_files_add_step(self, model, body, stepping)
      class(history_files_t), intent(inout) :: self !! the files
      type(history_model_t), intent(in) :: model !! the history
      type(body_t), intent(in) :: body !! the body
      type(time_stepping_t), intent(inout) :: stepping !! the time stepping at the end of the step; left as it is
      integer :: i

      do i = 1, size(self%tables)
         call self%checkpoint%add_rows(i, table_rows(self%tables(i), model, body, stepping))
      end do
   end subroutine history_files_add_step

   !> Whether the rows should be put on the disk.
   logical function history_files_is_due(self) result(is_due)
      class(history_files_t), intent(in) :: self !! the files

      is_due = self%checkpoint%is_due()
   end function history_files_is_due

   !> Writes the grids of a step and adds them to the collection.
   subroutine history_files_add_fields(self, body, number, time, result, error)
      class(history_files_t), intent(inout) :: self !! the files, with fields
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the step
      character(*), intent(in) :: time !! its time
      type(result_t), intent(in) :: result !! its result
      type(error_t), allocatable, intent(out) :: error !! a grid cannot be written

      call write_grids(self%grids, self%units, self%directory, self%folder//to_text(number), body, result, error)
      if (.not. allocated(error)) call self%checkpoint%add_rows(self%grids_table, case_entries(time, &
         self%folder//to_text(number)))
   end subroutine history_files_add_fields

   !> Completes the tables, which still have temporary names. Grids of an interrupted run are listed without being
   !> written again.
   subroutine history_files_finish(self, model, n_steps, n_resumed, finished, manifest, error)
      class(history_files_t), intent(inout) :: self !! the files
      type(history_model_t), intent(in) :: model !! the history
      integer, intent(in) :: n_steps !! number of its last step
      integer, intent(in) :: n_resumed !! number of the last step of an earlier run
      type(output_file_t), allocatable, intent(out) :: finished(:) !! the finished tables
      type(manifest_t), intent(out) :: manifest !! the manifest of the grids
      type(error_t), allocatable, intent(out) :: error !! not everything could be written
      integer :: table, number

      if (self%grids_table > 0) call self%checkpoint%end_table(self%grids_table, collection_tail, error)
      do number = 1, min(n_steps, n_resumed)
         if (allocated(error)) return
         if (.not. is_shown(number, model%history%fields_every)) cycle
         associate (stem => self%directory//self%folder//to_text(number))
            call self%grids%add_written(stem//'.vtu', stem//'.vtu', self%folder, error)
            if (.not. allocated(error)) call self%grids%add_written(stem//'.contact.vtu', &
               stem//'.contact.vtu', self%folder, error)
         end associate
      end do
      if (allocated(error)) return
      manifest = self%grids
      allocate (finished(size(self%tables)))
      do table = 1, size(finished)
         call self%checkpoint%table_file(finished(table), table, self%directory//self%name//self%tables(table)%ending)
      end do
   end subroutine history_files_finish

   !> Reads the state from which a history starts.
   subroutine read_start(numbers, history, error)
      real(dp), allocatable, intent(out) :: numbers(:) !! the numbers
      type(history_t), intent(in) :: history !! the history, with a start
      type(error_t), allocatable, intent(out) :: error !! there is no such state
      character(:), allocatable :: text
      integer :: first
      logical :: ok

      call read_text_file(history%start, text, error)
      if (allocated(error)) return
      if (history%start_step > 0) then
         first = index(text, newline//to_text(history%start_step)//',') + 1
      else
         first = index(text(:len(text) - 1), newline, back=.true.) + 1
      end if
      ok = index(text, 'step,') == 1
      if (ok .and. history%start_step > 0 .and. first == 1) then
         call new_error(error, input_refused, history%start//': it has no state of step '// &
            to_text(history%start_step)//', only of '//steps_text(text))
         return
      end if
      if (ok) call read_reals(text(first:line_end(text, first)), numbers, ok)
      if (.not. ok) call new_error(error, input_refused, history%start//': expected states of a history, as'// &
         ' NAME.states.csv has them')
   end subroutine read_start

   !> Text listing the steps whose states a file has; of many the first ones and the last.
   pure function steps_text(states) result(text)
      character(*), intent(in) :: states !! contents of the file
      character(:), allocatable :: text
      integer, parameter :: most_named = 12
      integer, allocatable :: starts(:)
      integer :: i, n

      starts = pack([(i, i=1, len(states) - 1)], [(states(i:i) == newline, i=1, len(states) - 1)]) + 1
      n = size(starts)
      text = ''
      do i = 1, n
         if (n > most_named .and. i > most_named - 2 .and. i < n) cycle
         if (n > most_named .and. i == n) text = text//', ...'
         if (i > 1) text = text//', '
         text = text//states(starts(i):starts(i) + index(states(starts(i):)//',', ',') - 2)
      end do
   end function steps_text

end module amontons_history_files
