!> The program: reads the command line, runs the decks, ends with the exit status.
program main
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: compiler_version, error_unit, output_unit
   use amontons_command_line, only: command_line_t, help_text, read_command_line
   use amontons_error, only: error_t
   use amontons_reference, only: tell_reference
   use amontons_run, only: run_decks
   use amontons_threads, only: n_threads, set_threads
   use amontons_version, only: version
   implicit none (type, external)

   interface
      !> Ends the process quietly: `stop` with a status would print it.
      subroutine c_exit(status) bind(c, name='exit')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: status !! exit status
      end subroutine c_exit
   end interface

   type(command_line_t) :: command_line
   type(error_t), allocatable :: error
   integer :: status

   call read_command_line(command_line, error)
   if (allocated(error)) then
      write (error_unit, '(a)') error%message
      status = error%kind
   else if (command_line%is_help) then
      write (output_unit, '(a)') help_text()
      status = 0
   else if (command_line%is_version) then
      write (output_unit, '(a)') 'amontons '//version//' ('//compiler_version()//')'
      status = 0
   else if (command_line%is_reference) then
      call tell_reference(command_line%decks, status)
   else
      if (command_line%n_threads == 0) command_line%n_threads = n_threads()
      call set_threads(command_line%n_threads)
      call run_decks(command_line, status)
   end if
   flush (output_unit)
   call c_exit(int(status, c_int))

end program main
