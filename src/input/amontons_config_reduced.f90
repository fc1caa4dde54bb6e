!> The problem that a deck names in the place of a body: a reduced one, from a file.
module amontons_config_reduced
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: describe_problem, reduced_source_t

   !> The group of the problem.
   type(group_t), parameter, public :: problem_group = group_t('problem')
   !> Kinds of problems, as a deck writes them.
   character(7), parameter :: kind_names(2) = [character(7) :: 'body', 'reduced']

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

   !> Describes `&problem`.
   subroutine describe_problem(visitor, reduced)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(reduced_source_t), intent(inout) :: reduced !! the reduced problem, if there is one
      character(len(kind_names)) :: kind
      logical :: has_kind, has_file

      kind = kind_names(merge(2, 1, reduced%is_given))
      has_kind = reduced%is_given
      has_file = is_filled(reduced%path)
      call visitor%open_group(problem_group)
      call visitor%word(key_t('kind', 'a body, described by the groups below; or a reduced problem from a file'), &
         kind, kind_names, has_kind)
      call visitor%text(key_t('file', "with `kind = 'reduced'`: name of its file, seen from the deck's folder", &
         is_file=.true., is_filled=.true., also='filename path'), reduced%path, has_file)
      call visitor%real(key_t('friction', "with `kind = 'reduced'`: Coulomb's coefficient of all contacts, in the"// &
         " place of the file's", default="the file's", at_least=0.0_dp, also='mu'), reduced%friction, &
         reduced%has_friction)
      call visitor%close_group()
      reduced%file = reduced%path
      reduced%is_given = kind == 'reduced'
      call visitor%locate('file', reduced%origin)
      if (visitor%is_judging()) then
         call visitor%only('file', reduced%is_given, "kind = 'reduced'")
         call visitor%only('friction', reduced%is_given, "kind = 'reduced'")
         call visitor%require(has_file .or. .not. reduced%is_given, 'kind', "kind = 'reduced' needs file = 'PROBLEM'")
      else if (visitor%place > 0) then
         ! A body that is missing here is not missed as well.
         reduced%is_given = reduced%is_given .or. visitor%deck%count_groups('mesh') == 0
      end if
   end subroutine describe_problem

end module amontons_config_reduced
