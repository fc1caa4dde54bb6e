!> Solves a deck, writes its files and looks at the result. Usage: solve_deck DECK DIRECTORY
program solve_deck
   use, intrinsic :: iso_fortran_env, only: error_unit
   use amontons, only: error_t, result_t
   use amontons_decks, only: cache_t, config_t, read_config, solve_case, write_report
   implicit none (type, external)
   character(1000) :: deck, directory
   type(config_t) :: config
   type(cache_t) :: cache
   type(result_t) :: result
   type(error_t), allocatable :: error

   call get_command_argument(1, deck)
   call get_command_argument(2, directory)

   call read_config(config, trim(deck), error)
   if (.not. allocated(error)) call solve_case(cache, config, result, error)
   if (.not. allocated(error)) call write_report(trim(directory), config, cache%body, result, error)
   if (allocated(error)) then
      write (error_unit, '(a)') error%message
      stop error%kind, quiet=.true.
   end if

   print '(2a)', config%name, merge(': solved       ', ': NOT CONVERGED', result%solution%is_converged)
   print '(a, f6.2)', 'open ', result%lengths%open
   print '(a, f6.2)', 'slip ', result%lengths%slip
   print '(a, f6.2)', 'stick', result%lengths%stick
   print '(a, es8.1)', 'largest violation in the certificate', result%certificate%largest()

end program solve_deck
