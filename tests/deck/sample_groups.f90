!> Groups with a key of each type, described as those of a case are, for the tests of this folder.
module sample_groups
   use amontons_deck_visitor, only: deck_visitor_t, group_t, key_t
   use amontons_kinds, only: dp
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: all_groups, describe_sample, load_sample_t, mesh_sample_t

   !> The groups.
   type(group_t), parameter :: mesh_group = group_t('mesh', is_shared=.true.), &
      load_group = group_t('load', is_repeatable=.true.), output_group = group_t('output'), &
      all_groups(*) = [mesh_group, load_group, output_group]

   !> A group that stands once.
   type :: mesh_sample_t
      real(dp) :: young = 0.5_dp !! a number
      real(dp) :: traction(2) = [0.0_dp, 0.25_dp] !! two numbers
      integer :: cells(2) = [1, 2] !! two whole numbers
      integer :: steps = 3 !! a whole number
      character(:), allocatable :: title !! a text
      character(8) :: element = 'tri3' !! a word
   contains
      procedure :: shown => mesh_sample_shown
   end type mesh_sample_t

   !> A group that may stand more than once.
   type :: load_sample_t
      real(dp) :: pressure = 1.0_dp !! a number that must be given
      real(dp), allocatable :: ends(:) !! a list
      character(:), allocatable :: origin !! where it stands
   end type load_sample_t

contains

   !> Describes the groups.
   subroutine describe_sample(visitor, mesh, loads)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(mesh_sample_t), intent(inout) :: mesh !! the group that stands once
      type(load_sample_t), allocatable, intent(inout) :: loads(:) !! the groups that may be repeated
      logical :: has_ends
      integer :: i

      call visitor%open_group(mesh_group)
      call visitor%real(key_t('young', 'a modulus', 'F/L²', above=0.0_dp, also='e modulus'), mesh%young)
      call visitor%reals(key_t('traction', 'a force', is_nonzero=.true.), mesh%traction)
      call visitor%wholes(key_t('cells', 'numbers of cells'), mesh%cells)
      call visitor%whole(key_t('steps', 'a number of steps', default='three', at_least=1.0_dp, also='n'), mesh%steps)
      call visitor%text(key_t('title', 'what it is about'), mesh%title)
      call visitor%word(key_t('element', 'a shape'), mesh%element, [character(5) :: 'tri3', 'quad4'])
      call visitor%close_group()
      if (visitor%is_judging()) call visitor%only('steps', mesh%element == 'tri3', "element = 'tri3'")
      if (.not. allocated(loads)) allocate (loads(visitor%deck%count_groups('load')))
      do i = 1, size(loads)
         has_ends = allocated(loads(i)%ends)
         call visitor%open_group(load_group)
         call visitor%real(key_t('pressure', 'a pressure', is_required=.true., is_shared=.true.), loads(i)%pressure)
         call visitor%list(key_t('ends', 'ends', above=0.0_dp, is_ascending=.true.), loads(i)%ends, has_ends)
         call visitor%close_group()
         call visitor%locate('pressure', loads(i)%origin)
      end do
      call visitor%open_group(output_group)
      call visitor%close_group()
   end subroutine describe_sample

   !> The values of the group that stands once, bars between them.
   function mesh_sample_shown(self) result(values)
      class(mesh_sample_t), intent(in) :: self !! the group
      character(:), allocatable :: values

      values = to_text(self%young)//'|'//to_text(self%traction(1))//' '//to_text(self%traction(2))//'|'// &
         to_text(self%cells(1))//' '//to_text(self%cells(2))//'|'//to_text(self%steps)//'|'//self%title//'|'// &
         trim(self%element)
   end function mesh_sample_shown

end module sample_groups
