!> What the listing and the summary say of a history.
module amontons_history_report
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_history, only: history_t, moved_things, steps_t
   use amontons_json, only: number, string, truth
   use amontons_kinds, only: dp
   use amontons_lengths, only: lengths_t, new_lengths
   use amontons_listing_text, only: columns, heading, line, right, scientific, short
   use amontons_solve_history, only: history_result_t, worst_step_t
   use amontons_stepper, only: step_state_t
   use amontons_summary_members, only: member
   use amontons_text, only: as_lines, to_text
   implicit none (type, external)
   private

   public :: history_listing, history_members

contains

   !> The section of the listing.
   function history_listing(config, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(history_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      associate (history => config%history, walk => result%walk)
         text = heading('Load history')
         do i = 1, size(history%steps)
            text = text//line('Changes', steps_text(history%steps(i)))
         end do
         text = text//constant_loads_text(config)
         if (len(walk%fault) > 0) text = text//line('INCOMPLETE', walk%fault)
         text = text//line('Steps', to_text(walk%n_steps)//', row by row in '//config%name//'.history.csv')
         if (history%has_start()) text = text//line('Start', history%start)
         if (result%n_resumed > 0) text = text//line('Resumed', 'behind step '//to_text(result%n_resumed)// &
            ' of an interrupted run')
         if (result%checkpoint%is_anew) text = text//line('Note', 'an interrupted run had left steps of another'// &
            ' deck; all steps were taken anew')
         if (walk%n_given_up > 0) text = text//line('Halved', to_text(walk%n_given_up)//' steps')
         text = text//line('Iterations', to_text(walk%n_iterations)//', '// &
            short(real(walk%n_iterations, dp)/max(1, walk%n_steps))//' per step')// &
            worst_text('Largest residual', result%residual)//worst_text('Energy identities', result%imbalance)// &
            worst_text('Step indicator', result%indicator)//line('Certified', to_text(result%n_certified)// &
            ' steps; largest violation '//scientific(result%violation%value)//' in step '// &
            to_text(result%violation%step))
         text = text//balance_text(walk%state)//times_table(history, result%reached)
         text = text//heading('Last step (slips count from its beginning, displacements from rest)')
      end associate
   end function history_listing

   !> What changes, and between which numbers.
   pure function steps_text(steps) result(text)
      type(steps_t), intent(in) :: steps !! the change
      character(:), allocatable :: text
      integer :: k

      text = trim(moved_things(steps%target))//" '"//steps%name//"'"
      do k = 1, steps%n_numbers()
         if (allocated(steps%table)) then
            text = text//range_text(steps%label(k), steps%table(1 + k, :))
         else
            text = text//range_text(steps%label(k), steps%values(k, :))
         end if
      end do
   end function steps_text

   !> A number's name and range.
   pure function range_text(label, values) result(text)
      character(*), intent(in) :: label !! its name
      real(dp), intent(in) :: values(:) !! its values
      character(:), allocatable :: text

      text = '; '//label//' from '//short(minval(values))//' to '//short(maxval(values))
   end function range_text

   !> Says which loads act in full from the first time on.
   pure function constant_loads_text(config) result(text)
      type(config_t), intent(in) :: config !! the deck
      character(:), allocatable :: text
      integer :: i, k, n

      text = ''
      n = 0
      do i = 1, size(config%loads)
         if (.not. any([(config%history%steps(k)%target == 1 .and. config%history%steps(k)%name &
            == config%loads(i)%name, k=1, size(config%history%steps))])) n = n + 1
      end do
      if (n > 0) text = line('Note', to_text(n)//' load(s) without &steps act in full from the first time on')
   end function constant_loads_text

   !> The largest of a number over all steps.
   pure function worst_text(label, worst) result(text)
      character(*), intent(in) :: label !! what it is
      type(worst_step_t), intent(in) :: worst !! the largest
      character(:), allocatable :: text

      text = line(label, scientific(worst%value))
      if (worst%step > 0) text = line(label, scientific(worst%value)//' in step '//to_text(worst%step))
   end function worst_text

   !> Where the work of the history went.
   pure function balance_text(state) result(text)
      type(step_state_t), intent(in) :: state !! the last state
      character(:), allocatable :: text

      text = heading('Energies of the history')// &
         line('Work of loads', short(state%load_work))// &
         line('Work of supports', short(state%support_work))// &
         line('Work of obstacles', short(state%obstacle_work))// &
         line('Strain energy', short(state%strain_energy))// &
         line('Dissipation', short(sum(state%dissipation)))// &
         line('Energy error', short(state%energy_error())//' (work less strain energy and dissipation; it vanishes'// &
         ' with the size of the steps)')
   end function balance_text

   !> The states at the times of the deck, with what the time since the one before took.
   pure function times_table(history, reached) result(text)
      type(history_t), intent(in) :: history !! the history
      real(dp), intent(in) :: reached(:, :) !! the times, each with what is known of it
      character(:), allocatable :: text
      character(140) :: rows(0:size(reached, 2))
      real(dp) :: before(2)
      integer :: i

      write (rows(0), '(9a13)') history%name(:min(12, len(history%name))), 'open', 'slip', 'stick', 'normal force', &
         'tang. force', 'strain energy', 'work', 'dissipated'
      before = 0.0_dp
      do i = 1, size(reached, 2)
         rows(i) = columns([reached(:7, i), reached(8:, i) - before])
         before = reached(8:, i)
      end do
      text = heading('States at the times of the deck (work and dissipation: since the time before)')//as_lines(rows)
   end function times_table

   !> The members of the summary.
   function history_members(config, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(history_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i, k

      associate (walk => result%walk, state => result%walk%state)
         text = '{"complete": '//truth(len(walk%fault) == 0)//', "end": '//string(walk%fault)//', "steps": '// &
            to_text(walk%n_steps)//', "steps_done_earlier": '//to_text(result%n_resumed)//', "steps_given_up": '// &
            to_text(walk%n_given_up)//', "iterations": '//to_text(walk%n_iterations)//', "changes": ['
         do i = 1, size(config%history%steps)
            do k = 1, config%history%steps(i)%n_numbers()
               if (i > 1 .or. k > 1) text = text//', '
               text = text//string(config%history%steps(i)%label(k))
            end do
         end do
         text = text//'], "time": '//number(state%instant%time)//', "work_loads": '//number(state%load_work)// &
            ', "work_supports": '//number(state%support_work)//', "work_obstacles": '//number(state%obstacle_work)// &
            ', "strain_energy": '//number(state%strain_energy)//', "dissipation": '//number(sum(state%dissipation))// &
            ', "energy_error": '//number(state%energy_error())
      end associate
      text = member('load_history', text//worst_members('residual', result%residual)// &
         worst_members('energy_identities', result%imbalance)//worst_members('step_indicator', result%indicator)// &
         worst_members('violation', result%violation)//'}')
   end function history_members

   !> The largest of a number over all steps, behind others.
   pure function worst_members(name, worst) result(text)
      character(*), intent(in) :: name !! what it is
      type(worst_step_t), intent(in) :: worst !! the largest
      character(:), allocatable :: text

      text = ', "'//name//'": '//number(worst%value)//', "'//name//'_step": '//to_text(worst%step)
   end function worst_members

end module amontons_history_report
