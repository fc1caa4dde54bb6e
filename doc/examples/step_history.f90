!> Takes a history step by step, with loads of its own. Usage: step_history DECK
program step_history
   use amontons, only: dp, error_t
   use amontons_decks, only: config_t, load_stepper_t, new_load_stepper, read_config
   implicit none (type, external)
   character(1000) :: deck
   type(config_t) :: config
   type(load_stepper_t) :: stepper
   type(error_t), allocatable :: error
   real(dp), allocatable :: state(:), after(:), columns(:)
   integer, allocatable :: status(:)
   real(dp), parameter :: push(*) = [0.0_dp, 10.0_dp, 15.0_dp, 5.0_dp]
   logical :: is_converged
   integer :: i, corner

   call get_command_argument(1, deck)
   call read_config(config, trim(deck), error)
   if (.not. allocated(error)) call new_load_stepper(stepper, config, error)
   if (allocated(error)) error stop 'no stepper'
   ! The numbers of a step are named in one text, with commas between them: 'time,factor_F,...'.
   corner = index(','//stepper%columns//',', ',ux_1,')
   corner = 1 + count([(stepper%columns(i:i) == ',', i=1, corner - 1)])
   allocate (state(stepper%n_state), source=0.0_dp) ! at rest
   do i = 1, size(push)
      ! What changes: factor_F, factor_f; the state before in, the state after out.
      call stepper%step(real(i, dp), [push(i), 1.0_dp], state, after, columns, status, is_converged, error)
      if (allocated(error) .or. .not. is_converged) error stop 'no solution'
      state = after
      print '(a, f5.1, a, f12.9)', 'push ', push(i), ', displacement of the corner ', columns(corner)
   end do

end program step_history
