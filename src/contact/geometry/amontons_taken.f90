!> What contact sets and ties have of the boundary. Later ones leave it alone.
module amontons_taken
   use amontons_boundary, only: patch_t
   use amontons_face, only: face_t
   use amontons_mesh, only: mesh_t, side_number
   implicit none (type, external)
   private

   public :: taken_t

   !> The nodes and faces that earlier sets have.
   type :: taken_t
      logical, allocatable :: node(:) !! which nodes they have (n_nodes)
      logical, allocatable :: face(:) !! which faces they have as a whole, by `side_number`
      logical :: is_slave_again = .false. !! whether a later set has the slave of the present one
   contains
      procedure :: add => taken_add
      procedure :: begin => taken_begin
      procedure :: has_all_beside => taken_has_all_beside
   end type taken_t

contains

   !> Begins with nothing taken.
   pure subroutine taken_begin(self, mesh)
      class(taken_t), intent(inout) :: self !! what sets have
      type(mesh_t), intent(in) :: mesh !! the mesh

      allocate (self%node(mesh%n_nodes), self%face(side_number(mesh%n_elements + 1, 0)), source=.false.)
   end subroutine taken_begin

   !> Adds a face, or the nodes of a part of one.
   pure subroutine taken_add(self, face, nodes, is_whole)
      class(taken_t), intent(inout) :: self !! what sets have
      type(face_t), intent(in) :: face !! the face
      integer, intent(in) :: nodes(:) !! those of its nodes that the set has; 0 is none
      logical, intent(in) :: is_whole !! whether the set has all of the face

      self%node(pack(nodes, nodes > 0)) = .true.
      self%face(face%number) = self%face(face%number) .or. is_whole
   end subroutine taken_add

   !> Which nodes of a patch earlier sets have together with all its faces beside them (nodes of the patch).
   pure function taken_has_all_beside(self, patch) result(has)
      class(taken_t), intent(in) :: self !! what sets have
      type(patch_t), intent(in) :: patch !! the patch
      logical :: has(patch%n_nodes), is_left(0:size(self%node))
      integer :: i

      is_left = .false.
      do i = 1, size(patch%faces)
         if (.not. self%face(patch%faces(i)%number)) is_left(patch%faces(i)%node) = .true.
      end do
      has = self%node(patch%node) .and. .not. is_left(patch%node)
   end function taken_has_all_beside

end module amontons_taken
