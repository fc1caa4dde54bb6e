!> Pairs of blocks on unequal meshes, one on the other.
module sample_pairs
   use amontons_constraints, only: support_t
   use amontons_contact_zone, only: contact_t, new_contact
   use amontons_error, only: error_t
   use amontons_joined_mesh, only: append_mesh, name_mesh
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   use amontons_rectangle, only: new_rectangle_mesh, rectangle_t
   use sample_bodies, only: support_on_set
   implicit none (type, external)
   private

   public :: block_mesh, pair_contact, pair_of_blocks, symmetric_supports

contains

   !> A rectangle named so, somewhere.
   subroutine block_mesh(mesh, name, origin, size, cells, element)
      type(mesh_t), intent(out) :: mesh !! the mesh
      character(*), intent(in) :: name !! its name
      real(dp), intent(in) :: origin(2) !! its lower left corner [L]
      real(dp), intent(in) :: size(2) !! width and height [L]
      integer, intent(in) :: cells(2) !! number of cells along x and y
      character(*), intent(in) :: element !! kind of element
      type(rectangle_t) :: rectangle
      type(error_t), allocatable :: error

      rectangle = rectangle_t(size, cells, diagonal='right')
      rectangle%element = trim(element)
      call new_rectangle_mesh(mesh, rectangle, error)
      mesh%coordinates = mesh%coordinates + spread(origin, 2, mesh%n_nodes)
      call name_mesh(mesh, name)
   end subroutine block_mesh

   !> A block from x = 0 to 3 on another one, each of height 1, whose meshes do not match.
   subroutine pair_of_blocks(mesh, lower, upper, cells)
      type(mesh_t), intent(out) :: mesh !! the mesh of both
      character(*), intent(in) :: lower !! kind of element of the lower block
      character(*), intent(in) :: upper !! kind of element of the upper block
      integer, intent(in) :: cells(2) !! cells along x of the lower and the upper block
      type(mesh_t) :: other
      type(error_t), allocatable :: error

      call block_mesh(mesh, 'lower', [0.0_dp, 0.0_dp], [3.0_dp, 1.0_dp], [cells(1), 1], lower)
      call block_mesh(other, 'upper', [0.0_dp, 1.0_dp], [3.0_dp, 1.0_dp], [cells(2), 1], upper)
      call append_mesh(mesh, other, error)
   end subroutine pair_of_blocks

   !> A contact set against another one.
   function pair_contact(set, against, friction) result(contact)
      character(*), intent(in) :: set !! the slave
      character(*), intent(in) :: against !! the master
      real(dp), intent(in) :: friction !! Coulomb coefficient
      type(contact_t) :: contact

      call new_contact(contact, set, friction)
      contact%pairing%against = against
      contact%origin = 'deck.nml:12: '
   end function pair_contact

   !> Both blocks guided at x = 0, the lower one at y = 0, too.
   function symmetric_supports() result(supports)
      type(support_t) :: supports(3)

      supports(1) = support_on_set('lower.left', [1], [0.0_dp])
      supports(2) = support_on_set('upper.left', [1], [0.0_dp])
      supports(3) = support_on_set('lower.bottom', [2], [0.0_dp])
   end function symmetric_supports

end module sample_pairs
