!> Cases made from the text of a deck, for the tests of this folder.
module sample_cases
   use amontons_config, only: config_t, read_config
   use amontons_error, only: error_t
   use amontons_result, only: result_t
   use amontons_solve_case, only: cache_t, solve_case
   implicit none (type, external)
   private

   public :: block, deck_file, nl, read_case, solve_text

   !> End of a line.
   character, parameter :: nl = new_line('a')
   !> Name of the file that the decks pass through; messages begin with it.
   character(*), parameter :: deck_file = 'sample_case.nml'
   !> A block, 4 x 2, without supports, loads or contact, on the first two lines of a deck.
   character(*), parameter :: block = '&mesh size = 4.0, 2.0  cells = 8, 4 /'//nl// &
      '&material young = 100.0  poisson = 0.25 /'//nl

contains

   !> Reads a case from the text of a deck.
   subroutine read_case(config, text, error)
      type(config_t), intent(out) :: config !! the case
      character(*), intent(in) :: text !! the text
      type(error_t), allocatable, intent(out) :: error !! what is wrong with it
      integer :: unit

      open (newunit=unit, file=deck_file, status='replace', action='write', access='stream', form='unformatted')
      write (unit) text
      close (unit)
      call read_config(config, deck_file, error)
      open (newunit=unit, file=deck_file, status='old', action='read')
      close (unit, status='delete')
   end subroutine read_case

   !> Solves the case of the text of a deck.
   subroutine solve_text(cache, text, result, error)
      type(cache_t), intent(inout) :: cache !! the body at hand
      character(*), intent(in) :: text !! the text
      type(result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the text or the case
      type(config_t) :: config

      call read_case(config, text, error)
      if (allocated(error)) return
      call solve_case(cache, config, result, error)
   end subroutine solve_text

end module sample_cases
