!> Numbers of a load history besides those of its last step: where its work went, what its last cycle took, and what the
!> contact sets carry in a step.
module amontons_history_results
   use amontons_body, only: body_t
   use amontons_history, only: history_t
   use amontons_history_model, only: step_state_t
   use amontons_history_walk, only: n_cycle_numbers, n_plain_numbers
   use amontons_key_results, only: contact_peaks, resultants
   use amontons_kinds, only: dp
   use amontons_quantity, only: quantity_t
   implicit none (type, external)
   private

   public :: contact_numbers, cycle_results, energies_of

contains

   !> Pressure, shear and slip, and the forces, of all contact sets in a state. The slip is that since rest, on the
   !> obstacle.
   pure function contact_numbers(body, state) result(list)
      type(body_t), intent(in) :: body !! the body
      type(step_state_t), intent(in) :: state !! the state
      type(quantity_t), allocatable :: list(:)

      associate (solution => state%solution)
         list = [contact_peaks(body, solution%displacement(body%zone%n_points + 1:) - state%instant%motion, &
            solution%force, solution%status, 0.0_dp), resultants(solution%force)]
      end associate
   end function contact_numbers

   !> Where the work of the history went; the error is that of the size of the steps.
   pure function energies_of(state) result(list)
      type(step_state_t), intent(in) :: state !! the last state
      type(quantity_t), allocatable :: list(:)

      list = [quantity_t('work_loads', 'Work of loads', state%load_work), &
         quantity_t('work_supports', 'Work of supports', state%support_work), &
         quantity_t('work_obstacles', 'Work of obstacles', state%obstacle_work), &
         quantity_t('strain_energy', 'Strain energy', state%strain_energy), &
         quantity_t('dissipation', 'Dissipation', sum(state%dissipation)), &
         quantity_t('energy_error', 'Energy error', state%energy_error())]
      list%dimension = 'F L'
   end function energies_of

   !> What the last cycle took, and its largest parameters of fretting where the deck asks for them; nothing without a
   !> cycle.
   pure function cycle_results(history, cycles) result(list)
      type(history_t), intent(in) :: history !! the history
      real(dp), intent(in) :: cycles(:, :) !! the cycles that ended (n_cycle_numbers, n)
      type(quantity_t), allocatable :: list(:)

      allocate (list(0))
      if (size(cycles, 2) == 0) return
      associate (last => cycles(:, size(cycles, 2)))
         list = [quantity_t('cycle_dissipation', 'Dissipation of cycle', last(7), dimension='F L')]
         if (history%has_fretting) list = [list, &
            quantity_t('max_ruiz_1', 'Ruiz 1', last(n_plain_numbers + 1), dimension='F/L'), &
            quantity_t('max_ruiz_2', 'Ruiz 2', last(n_plain_numbers + 2), dimension='F^2/L^3'), &
            quantity_t('max_swt', 'SWT', last(n_cycle_numbers), dimension='F/L^2')]
      end associate
   end function cycle_results

end module amontons_history_results
