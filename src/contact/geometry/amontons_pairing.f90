!> What a deck says of two deformable bodies that meet: the pairing of a contact set with the boundary of another body,
!> and a tie.
module amontons_pairing
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: gap_names, new_tie, pairing_t, tie_t

   !> Where the gaps of a pair come from, as a deck writes it: from the meshes, or 0 where the bodies face each other.
   character(8), parameter :: gap_names(*) = [character(8) :: 'mesh', 'touching']

   !> The other body of a contact set. The set is the slave, which carries the multipliers; the other body's boundary is
   !> the master.
   type :: pairing_t
      character(:), allocatable :: against
         !! name of the master's boundary set; empty or not allocated for a rigid obstacle
      real(dp) :: search = 0.0_dp
         !! how far the master may be along the slave's normal, either way; 0 for twice the longest side [L]
      character(8) :: gap = 'mesh' !! where gaps come from, one of `gap_names`
      logical :: is_tied = .false. !! whether the surfaces are bonded
   contains
      procedure :: has_mesh_gap => pairing_has_mesh_gap
      procedure :: is_pair => pairing_is_pair
      procedure :: label => pairing_label
   end type pairing_t

   !> A boundary set bonded to that of another body: no gap, no slip.
   type :: tie_t
      character(:), allocatable :: set !! name of the slave's boundary set
      character(:), allocatable :: to !! name of the master's boundary set
      real(dp) :: search = 0.0_dp
         !! how far the master may be along the slave's normal, either way; 0 for twice the longest side [L]
      character(:), allocatable :: origin !! where the tie was specified, for messages: 'deck.nml:12: '
   end type tie_t

contains

   !> Makes a tie.
   pure subroutine new_tie(tie, set, to)
      type(tie_t), intent(out) :: tie !! the tie
      character(*), intent(in) :: set !! name of the slave's boundary set
      character(*), intent(in) :: to !! name of the master's boundary set

      tie%set = set
      tie%to = to
      tie%origin = ''
   end subroutine new_tie

   !> What a contact set is called together with what it is paired with: SLAVE/MASTER, and SET without another body.
   pure function pairing_label(self, set) result(label)
      class(pairing_t), intent(in) :: self !! the pairing
      character(*), intent(in) :: set !! name of the contact set
      character(:), allocatable :: label

      label = set
      if (self%is_pair()) label = label//'/'//self%against
   end function pairing_label

   !> Whether there is another deformable body.
   elemental logical function pairing_is_pair(self) result(is_pair)
      class(pairing_t), intent(in) :: self !! the pairing

      is_pair = .false.
      if (allocated(self%against)) is_pair = len(self%against) > 0
   end function pairing_is_pair

   !> Whether gaps come from the meshes of two deformable bodies.
   elemental logical function pairing_has_mesh_gap(self) result(has_mesh_gap)
      class(pairing_t), intent(in) :: self !! the pairing

      has_mesh_gap = self%is_pair() .and. self%gap == gap_names(1)
   end function pairing_has_mesh_gap

end module amontons_pairing
