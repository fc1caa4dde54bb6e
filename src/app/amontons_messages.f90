!> Messages of a run: results on standard output, errors on standard error, and the progress of a sweep or history on
!> the status line. A signal may interrupt the run. And the texts of --help, --version and --reference: the options, the
!> build, the groups of a deck and their keys.
module amontons_messages
   use, intrinsic :: iso_fortran_env, only: compiler_version
   use amontons_command_line, only: command_line_t
   use amontons_config, only: reference_text
   use amontons_distributed, only: mpi_text
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_study, only: outcome_t, study_monitor_t
   use amontons_suitesparse, only: suitesparse_text
   use amontons_system, only: file_name_t, wall_seconds
   use amontons_terminal, only: hold_interrupts, is_interrupted, note_work, print_line, release_interrupts, &
      standard_error, standard_output
   use amontons_text, only: as_lines, newline, to_text
   use amontons_threads, only: blas_text, n_threads, openmp_date
   use amontons_version, only: build_type, version
   implicit none (type, external)
   private

   public :: help_text, print_error, print_info, print_outcome, print_reference, progress_t, version_text

   !> The monitor of a study that shows its progress. From the first report until `finish`, SIGINT and SIGTERM stop the
   !> study after the current case or step.
   type, extends(study_monitor_t) :: progress_t
      private
      character(6) :: things = '' !! noun of the last report; blank before the first one
      real(dp) :: start = 0.0_dp !! when the first report about them came [s]
      integer :: n_before = 0 !! number of them done then
   contains
      procedure, public :: finish => progress_finish
      procedure, public :: is_stopped => progress_is_stopped
      procedure, public :: report => progress_report
   end type progress_t

contains

   !> Prints a line unless the run is quiet.
   subroutine print_info(command_line, text, error)
      type(command_line_t), intent(in) :: command_line !! the options
      character(*), intent(in) :: text !! the line
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more

      if (.not. command_line%asks('--quiet')) call print_line(standard_output, text, error)
   end subroutine print_info

   !> Prints the result line of a deck and its warnings, one line each, unless the run is quiet; and then the error, if
   !> any.
   subroutine print_outcome(command_line, outcome, error)
      type(command_line_t), intent(in) :: command_line !! the options
      type(outcome_t), intent(in) :: outcome !! the outcome of the deck
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more
      character(:), allocatable :: lines
      integer :: i

      if (len(outcome%text) > 0) then
         lines = outcome%text
         do i = 1, outcome%warnings%n()
            lines = lines//newline//outcome%name//': warning: '//outcome%warnings%item(i)
         end do
         call print_info(command_line, lines, error)
         if (allocated(error)) error%message = outcome%deck//': '//error%message
      end if
      if (len(outcome%message) > 0) call print_error(outcome%message)
   end subroutine print_outcome

   !> Prints an error message of one or several lines on standard error.
   subroutine print_error(text)
      character(*), intent(in) :: text !! the lines
      type(error_t), allocatable :: unheard

      ! Where standard error is closed, the exit status alone reports the error.
      call print_line(standard_error, text, unheard)
   end subroutine print_error

   !> Whether a signal has asked the program to stop.
   logical function progress_is_stopped(self) result(is_stopped)
      class(progress_t), intent(in) :: self !! the watch

      is_stopped = is_interrupted()
      associate (unused => self)
      end associate
   end function progress_is_stopped

   !> Shows the progress of the study, its speed and the time left: '128 of 861 cases, 10500 per second, 0:00:12 left'.
   subroutine progress_report(self, n_done, n_cases, things)
      class(progress_t), intent(inout) :: self !! the watch
      integer, intent(in) :: n_done !! cases done
      integer, intent(in) :: n_cases !! all cases
      character(*), intent(in) :: things !! noun for the items: 'cases', 'steps' or 'fields'
      real(dp), parameter :: longest = 3.6e8_dp, hundred = 100.0_dp
      character(:), allocatable :: text
      character(8) :: minutes
      real(dp) :: rate, seconds
      integer :: left

      if (self%things == '') call hold_interrupts()
      if (self%things /= things) then
         self%things = things
         self%n_before = n_done
         self%start = wall_seconds()
      end if
      text = to_text(n_done)//' of '//to_text(n_cases)//' '//things
      seconds = wall_seconds() - self%start
      if (n_done > self%n_before .and. seconds > 0.0_dp) then
         rate = (n_done - self%n_before)/seconds
         left = nint(min(longest, (n_cases - n_done)/rate))
         write (minutes, '(i2.2, ":", i2.2)') mod(left/60, 60), mod(left, 60)
         if (rate >= hundred) then
            text = text//', '//to_text(nint(rate))
         else
            text = text//', '//to_text(real(nint(rate*hundred), dp)/hundred)
         end if
         text = text//' per second, '//to_text(left/3600)//':'//trim(minutes)//' left'
      end if
      call note_work(text, is_timed=.false.)
   end subroutine progress_report

   !> Stops watching for signals.
   subroutine progress_finish(self)
      class(progress_t), intent(inout) :: self !! the watch

      if (self%things /= '') call release_interrupts()
   end subroutine progress_finish

   !> The text of --help: usage, files, options, a first deck and how to run it.
   pure function help_text() result(text)
      character(:), allocatable :: text
      integer, parameter :: width = 82

      text = as_lines([character(width) :: &
         'amontons: contact with Coulomb friction by the dual method', &
         '', &
         'Usage: amontons [options] DECK...', &
         '       amontons [options] --reduced FILE...', &
         '       amontons [options] --verify DIR...', &
         '', &
         'Solves the case of each deck (- is standard input) and writes, in the output', &
         'directory,', &
         '  NAME.lst           the listing', &
         '  NAME.contact.csv   gap, slip, forces, stresses and status of every point', &
         '  NAME.summary.json  residual, certificate, lengths, resultants, times', &
         '  NAME.vtu           mesh, displacements and stresses for ParaView', &
         '  NAME.contact.vtu   the contact line for ParaView', &
         '  NAME.deck.nml      the deck with all defaults in place', &
         'A deck with a sweep leaves a listing, a summary, its deck and', &
         '  NAME.sweep.csv     one row for each case', &
         '  NAME.sweep.pvd     the cases whose fields it asks for, for ParaView', &
         'A deck with a history leaves the files of its last step and', &
         '  NAME.history.csv   one row for each step', &
         '  NAME.history.pvd   the steps whose fields it asks for, for ParaView', &
         '  NAME.points.csv    the contact points of the steps it asks for', &
         '  NAME.cycles.csv    one row for each cycle it marks', &
         'and several decks leave', &
         '  cases.pvd          all their cases, for ParaView', &
         '  batch.csv          a row for each deck: outcome, message, key numbers', &
         'Decks whose mesh, material, supports and contact sets agree share one', &
         'factorization when they follow each other.', &
         '', &
         'Options:', &
         '  --output DIR     where the files go (made if missing; default: the current', &
         '                   directory); -o too', &
         '  --set KEY=VALUE  take VALUE for a key of the decks: --set contact.friction=0.5,', &
         '                   --set "support(2).set=left"; may be repeated', &
         '  --refine N       solve on N refined meshes too, each of half the element', &
         '                   size: error bars of the key results (accuracy.refinements)', &
         '  --check          check the decks and print their sizes; solve and write nothing', &
         '  --quiet          print nothing but errors; -q too', &
         '  --progress       lines on the work under way to standard error where it is no', &
         '                   terminal but a log', &
         '  --skip-unchanged skip decks whose results are there already, from the same deck,', &
         '                   files and version; adds its rows to batch.csv', &
         '  --threads N      threads to use (default: OMP_NUM_THREADS, or all cores); -t too', &
         '  --reduced        the files are reduced problems u = W r + q (Siconos text), not', &
         '                   decks', &
         '  --write-reduced  write the reduced problem of each case too: NAME.reduced.dat', &
         '                   (Siconos text)', &
         '  --all-solutions  find every solution of problems of at most 12 contact points:', &
         '                   NAME.solutions.csv', &
         '  --verify         verify the results in directories from their files alone: that', &
         '                   no byte was changed, and that they follow from deck and mesh', &
         '  --reference      print every key of a deck with its values, unit, default and', &
         '                   meaning, or those of groups: amontons --reference mesh contact', &
         '  --help           print this text; -h too', &
         '  --version        print the version and how the program was built', &
         '  --               what follows are decks', &
         '', &
         'A first deck, block.nml: a block 4 by 2 is pressed on a floor and drawn along it.', &
         '', &
         '  &mesh size = 4.0, 2.0  cells = 16, 8 /', &
         '  &material young = 100.0  poisson = 0.25 /', &
         "  &support set = 'right'  ux = 0.1 /", &
         "  &load set = 'top'  pressure = 1.0 /", &
         "  &contact set = 'bottom'  friction = 0.3 /", &
         '', &
         'Examples:', &
         '  amontons block.nml                       solve it; read block.lst first', &
         '  amontons --check block.nml               check it and print its size', &
         '  amontons --output results --quiet *.nml  a batch; only errors are printed', &
         "  sed 's/0.3/0.5/' block.nml | amontons -  a deck from another program: stdin.lst", &
         '  amontons --write-reduced block.nml       its contact problem for other solvers', &
         '', &
         'Exit status: 0 solved; 1 input refused; 2 no equilibrium, or numerical failure;', &
         '3 cannot write, or an internal fault; 4 not converged or not certified, a case of', &
         'a sweep or a step of a history included (files are written and marked); 5 a sweep', &
         'or a history was interrupted (the same command goes on with it). The largest of', &
         'all decks counts. More: man amontons'])
      text = text(:len(text) - 1)
   end function help_text

   !> The text of --version: the version, and the properties of the build that a bug report should include.
   function version_text() result(text)
      character(:), allocatable :: text
      integer, parameter :: build_width = 200

      text = as_lines([character(build_width) :: &
         'amontons '//version, &
         'compiler     '//compiler_version(), &
         'build type   '//build_type, &
         'BLAS         '//blas_text(), &
         'SuiteSparse  '//suitesparse_text(), &
         'MPI          '//mpi_text(), &
         'OpenMP       '//to_text(openmp_date)//', '//to_text(n_threads())//' threads'])
      text = text(:len(text) - 1)
   end function version_text

   !> Prints the reference of the named groups, or of all groups if no name is given.
   subroutine print_reference(groups, status, error)
      type(file_name_t), intent(in) :: groups(:) !! names of the groups
      integer, intent(out) :: status !! exit status
      type(error_t), allocatable, intent(out) :: error !! standard output takes no more
      type(error_t), allocatable :: unknown
      character(:), allocatable :: name, text
      integer :: i

      status = 0
      name = ''
      do i = 1, max(1, size(groups))
         if (size(groups) > 0) name = groups(i)%text
         call reference_text(name, text, unknown)
         if (allocated(unknown)) then
            call print_error('amontons: '//unknown%message)
            status = max(status, unknown%kind)
         else
            call print_line(standard_output, repeat(newline, merge(1, 0, i > 1))//text, error)
            if (allocated(error)) return
         end if
      end do
   end subroutine print_reference

end module amontons_messages
