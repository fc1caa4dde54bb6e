!> One deck from its file to its files, as the program does it.
module amontons_c_deck
   use amontons_config, only: config_t, read_config
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_reduced_report, only: write_reduced_report
   use amontons_report, only: write_report
   use amontons_result, only: certificate_limit, result_t, status_not_converged
   use amontons_solve_case, only: solve_case, workshop_t
   use amontons_solve_reduced, only: reduced_result_t, solve_reduced
   use amontons_solve_sweep, only: solve_sweep, sweep_result_t
   use amontons_sweep_monitor, only: sweep_monitor_t
   use amontons_sweep_report, only: write_sweep_report
   use amontons_sweep_tally, only: case_converged
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: run_deck, verdict

contains

   !> Solves a deck and writes its files.
   subroutine run_deck(deck, directory, name, status, message)
      character(*), intent(in) :: deck !! name of the deck
      character(*), intent(in) :: directory !! output directory, made if it is not there
      character(:), allocatable, intent(out) :: name !! name of the case; empty if the deck is refused
      integer, intent(out) :: status !! exit status that the program would have
      character(:), allocatable, intent(out) :: message !! what went wrong; empty if nothing did
      type(config_t) :: config
      type(error_t), allocatable :: error

      name = ''
      call read_config(config, deck, error)
      if (.not. allocated(error)) then
         name = config%name
         if (config%reduced%is_given) then
            call run_reduced(config, directory, status, message, error)
         else if (config%sweep%is_given()) then
            call run_sweep(config, directory, status, message, error)
         else
            call run_case(config, directory, status, message, error)
         end if
      end if
      if (allocated(error)) then
         status = error%kind
         message = error%message
      end if
      if (len(message) > 0 .and. index(message, deck) /= 1) message = deck//': '//message
   end subroutine run_deck

   !> Solves a body and writes its files.
   subroutine run_case(config, directory, status, message, error)
      type(config_t), intent(in) :: config !! the case
      character(*), intent(in) :: directory !! output directory
      integer, intent(out) :: status !! 0 or `status_not_converged`
      character(:), allocatable, intent(out) :: message !! what a solution lacks; empty if nothing
      type(error_t), allocatable, intent(out) :: error !! the case cannot be solved, or its files not be written
      type(workshop_t) :: workshop
      type(result_t) :: result

      call solve_case(workshop, config, result, error)
      if (.not. allocated(error)) call write_report(directory, config, workshop%body, result, error)
      if (allocated(error)) return
      call verdict(result%solution%is_converged, result%solution%residual, result%certificate%largest(), &
         config%method%tolerance, status, message)
   end subroutine run_case

   !> Solves a reduced problem and writes its files.
   subroutine run_reduced(config, directory, status, message, error)
      type(config_t), intent(in) :: config !! the case
      character(*), intent(in) :: directory !! output directory
      integer, intent(out) :: status !! 0 or `status_not_converged`
      character(:), allocatable, intent(out) :: message !! what a solution lacks; empty if nothing
      type(error_t), allocatable, intent(out) :: error !! the problem cannot be solved, or its files not be written
      type(reduced_result_t) :: result

      call solve_reduced(config, result, error)
      if (.not. allocated(error)) call write_reduced_report(directory, config, result, error)
      if (allocated(error)) return
      call verdict(result%solution%is_converged, result%solution%residual, result%check%largest(), &
         config%method%tolerance, status, message)
   end subroutine run_reduced

   !> Solves the cases of a sweep and writes its files.
   subroutine run_sweep(config, directory, status, message, error)
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: directory !! output directory
      integer, intent(out) :: status !! 0 or `status_not_converged`
      character(:), allocatable, intent(out) :: message !! what the solutions lack; empty if nothing
      type(error_t), allocatable, intent(out) :: error !! the sweep cannot be solved, or its files not be written
      type(workshop_t) :: workshop
      type(sweep_monitor_t) :: monitor
      type(sweep_result_t) :: result

      call solve_sweep(workshop, config, directory, monitor, result, error)
      if (.not. allocated(error)) call write_sweep_report(directory, config, workshop%body, result, error)
      if (allocated(error)) return
      associate (tally => result%tally)
         call verdict(.true., tally%residual, result%certified%certificate%largest(), config%method%tolerance, status, &
            message)
         if (tally%n_outcomes(case_converged) == tally%n_cases) return
         status = status_not_converged
         message = to_text(tally%n_cases - tally%n_outcomes(case_converged))//' of '//to_text(tally%n_cases)// &
            ' cases of the sweep are not solved'
      end associate
   end subroutine run_sweep

   !> Judges a solution as the program does.
   pure subroutine verdict(is_converged, residual, violation, tolerance, status, message)
      logical, intent(in) :: is_converged !! whether the method converged
      real(dp), intent(in) :: residual !! its residual [-]
      real(dp), intent(in) :: violation !! largest violation in the certificate [-]
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]
      integer, intent(out) :: status !! 0 or `status_not_converged`
      character(:), allocatable, intent(out) :: message !! what the solution lacks; empty if nothing

      status = status_not_converged
      if (.not. is_converged) then
         message = 'not converged: residual '//to_text(residual)//' where at most '//to_text(tolerance)// &
            ' was asked for'
      else if (.not. violation <= certificate_limit(tolerance)) then
         message = 'the certificate FAILED: largest violation '//to_text(violation)
      else
         status = 0
         message = ''
      end if
   end subroutine verdict

end module amontons_c_deck
