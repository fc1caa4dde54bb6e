!> The problem that a deck names in the place of a body: a reduced one, from a file.
module amontons_config_reduced
   use amontons_deck, only: deck_t
   use amontons_deck_rules, only: origin_of, require
   use amontons_kinds, only: dp
   use amontons_number_table, only: beside
   use amontons_system, only: absolute_path
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: read_problem, reduced_source_t

   !> Kinds of problems, as a deck writes them.
   character(7), parameter :: kind_names(2) = [character(7) :: 'body', 'reduced']
   !> Groups that describe a body.
   character(8), parameter :: body_groups(*) = [character(8) :: 'mesh', 'material', 'support', 'load', 'contact', &
      'sweep']

   !> Where a reduced problem comes from.
   type :: reduced_source_t
      logical :: is_given = .false. !! whether the problem is a reduced one
      character(:), allocatable :: file !! name of its file, as messages tell it
      character(:), allocatable :: path !! name of its file from the root on
      character(:), allocatable :: origin !! where the file was named, for messages: 'deck.nml:12: '; may be empty
      logical :: has_friction = .false. !! whether `friction` takes the place of the file's coefficients
      real(dp) :: friction = 0.0_dp !! Coulomb coefficient of all contacts [-]
   end type reduced_source_t

contains

   !> Reads `&problem`.
   subroutine read_problem(reduced, deck)
      type(reduced_source_t), intent(out) :: reduced !! the reduced problem, if there is one
      type(deck_t), intent(inout) :: deck !! the deck
      character(:), allocatable :: kind
      integer :: group
      logical :: has_file

      group = deck%group('problem')
      kind = trim(kind_names(1))
      reduced%file = ''
      call deck%get_word(group, 'kind', kind, kind_names)
      call deck%get(group, 'file', reduced%file, has_file)
      call deck%get(group, 'friction', reduced%friction, reduced%has_friction)
      call deck%refuse_unknown(group)
      reduced%is_given = kind == 'reduced'
      call require(deck, group, 'friction', reduced%friction >= 0.0_dp, 'be at least 0, found '// &
         to_text(reduced%friction))
      if (group > 0 .and. .not. deck%is_understood(group)) then
         ! A body that is missing here is not missed as well.
         reduced%is_given = reduced%is_given .or. deck%group('mesh') == 0
         return
      end if
      reduced%origin = origin_of(deck, group, 'file')
      if (.not. reduced%is_given) then
         call require(deck, group, 'file', .not. has_file, "go with kind 'reduced'")
         call require(deck, group, 'friction', .not. reduced%has_friction, "go with kind 'reduced'")
      else
         call check_reduced(reduced, deck, group, has_file)
         if (len_trim(reduced%file) > 0) reduced%file = absolute_path(beside(deck%file, reduced%file))
         reduced%path = reduced%file
      end if
   end subroutine read_problem

   !> Checks what a deck says of a reduced problem, and that it describes no body beside it.
   subroutine check_reduced(reduced, deck, group, has_file)
      type(reduced_source_t), intent(in) :: reduced !! the reduced problem
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      logical, intent(in) :: has_file !! whether the file is given
      integer, allocatable :: groups(:)
      integer :: i, j

      if (.not. has_file) call deck%fault(group, 'kind', "&problem of kind 'reduced' needs a file")
      call require(deck, group, 'file', len_trim(reduced%file) > 0 .or. .not. has_file, 'name a reduced problem')
      do i = 1, size(body_groups)
         groups = deck%groups(trim(body_groups(i)))
         do j = 1, size(groups)
            call deck%fault(groups(j), '', '&'//trim(body_groups(i))//" does not go with &problem kind 'reduced'")
         end do
      end do
   end subroutine check_reduced

end module amontons_config_reduced
