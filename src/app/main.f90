!> The program: reads the command line, runs the decks, returns the exit status. In an MPI run rank 0 does so, and the
!> other ranks serve it.
program main
   use, intrinsic :: iso_c_binding, only: c_int
   use amontons_command_line, only: command_line_t, read_command_line
   use amontons_distributed, only: begin_ranks, dismiss_ranks, end_ranks, n_ranks, rank
   use amontons_error, only: error_t
   use amontons_messages, only: help_text, print_error, print_reference, version_text
   use amontons_run_decks, only: run_decks, verify_directories
   use amontons_sweep_ranks, only: serve
   use amontons_system, only: number_action, return_large_arrays
   use amontons_terminal, only: prepare_process, print_line, standard_output
   use amontons_threads, only: n_threads, set_threads
   implicit none (type, external)

   !> Ends the process with an exit status, without output: `stop` would print it.
   procedure(number_action), bind(c, name='exit') :: c_exit
   !> Ends the process with a sentence where the BLAS has no room on some of so many threads.
   procedure(number_action), bind(c, name='amontons_require_blas_room') :: require_blas_room

   type(command_line_t) :: command_line
   type(error_t), allocatable :: error
   integer :: length, status

   call prepare_process()
   call return_large_arrays()
   call begin_ranks()
   call read_command_line(command_line, error)
   ! A rank among several has one thread by default; elsewhere 0 stands for the value of OMP_NUM_THREADS, or all cores.
   call get_environment_variable('OMP_NUM_THREADS', length=length)
   if (command_line%n_threads == 0) command_line%n_threads = merge(1, n_threads(), n_ranks > 1 .and. length == 0)
   call require_blas_room(1_c_int)
   call set_threads(command_line%n_threads)
   if (rank == 0) then
      status = 0
      if (.not. allocated(error)) then
         if (command_line%asks('--help')) then
            call print_line(standard_output, help_text(), error)
         else if (command_line%asks('--version')) then
            call print_line(standard_output, version_text(), error)
         else if (command_line%asks('--reference')) then
            call print_reference(command_line%decks, status, error)
         else if (command_line%asks('--verify')) then
            call verify_directories(command_line, status)
         else
            call run_decks(command_line, status)
         end if
      end if
      if (allocated(error)) then
         call print_error(error%message)
         status = error%kind
      end if
      call dismiss_ranks()
   else
      call serve()
      status = 0
   end if
   call end_ranks()
   call c_exit(int(status, c_int))

end program main
