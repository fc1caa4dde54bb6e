!> Pairs of blocks on unequal meshes, one on the other.
module sample_pairs
   use amontons_constraints, only: support_t
   use amontons_contact_set, only: contact_t, new_contact
   use amontons_error, only: error_t
   use amontons_generated_mesh, only: new_rectangle_mesh, rectangle_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t
   use amontons_mesh, only: mesh_t
   use amontons_mesh_file, only: append_mesh, name_mesh
   use sample_bodies, only: support_at_point, support_on_set, traction_on_set
   use sample_meshes, only: rotation, turn
   implicit none (type, external)
   private

   public :: block_mesh, pair_contact, pair_of_blocks, sheared_blocks, symmetric_supports

contains

   !> A rectangle named so, somewhere.
   subroutine block_mesh(mesh, name, origin, extent, cells, element)
      type(mesh_t), intent(out) :: mesh !! the mesh
      character(*), intent(in) :: name !! its name
      real(dp), intent(in) :: origin(2) !! its lower left corner [L]
      real(dp), intent(in) :: extent(2) !! width and height [L]
      integer, intent(in) :: cells(2) !! number of cells along x and y
      character(*), intent(in) :: element !! kind of element
      type(rectangle_t) :: rectangle
      type(error_t), allocatable :: error

      rectangle = rectangle_t(extent, cells, diagonal='right')
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

   !> The blocks under constant pressure and shear, all turned: in plane stress the displacement is
   !> (0.3 p x + 2.6 s y, -p y)/E. Both ends of the lower block's top are held along x, so that they are guided along
   !> their normal, aslant to it or along the tangent.
   subroutine sheared_blocks(mesh, expected, supports, loads, elements, turned_by)
      type(mesh_t), intent(out) :: mesh !! the mesh of both
      real(dp), allocatable, intent(out) :: expected(:, :) !! the displacement (2, n_nodes) [L]
      type(support_t), allocatable, intent(out) :: supports(:) !! the supports
      type(load_t), allocatable, intent(out) :: loads(:) !! the loads
      character(*), intent(in) :: elements(2) !! kinds of elements of the lower and the upper block
      real(dp), intent(in) :: turned_by !! angle [degrees]
      real(dp), parameter :: pressure = 10.0_dp, shear = 1.0_dp
      character(8), parameter :: sides(2) = [character(8) :: '.left', '.right']
      character(8), parameter :: blocks(2) = [character(8) :: 'lower', 'upper']
      real(dp) :: to(2, 2), at(2)
      integer :: i, k

      call pair_of_blocks(mesh, elements(1), elements(2), [4, 3])
      to = rotation(turned_by)
      allocate (supports(4), loads(6))
      allocate (expected(2, mesh%n_nodes))
      associate (x => mesh%coordinates(1, :), y => mesh%coordinates(2, :))
         expected(1, :) = (0.3_dp*pressure*x + 2.6_dp*shear*y)/1000.0_dp
         expected(2, :) = -pressure*y/1000.0_dp
      end associate
      expected = matmul(to, expected)
      supports(2) = support_on_set('lower.bottom', [4], [0.0_dp])
      ! Not below an end, where two nodes held alike would make a plane of symmetry.
      at = [0.75_dp, 0.0_dp]
      supports(1) = support_at_point(matmul(to, at), [1, 2], matmul(to, [0.3_dp*pressure*at(1), 0.0_dp]/1000.0_dp))
      do i = 1, 2
         ! The first of two nodes there: that of the lower block.
         at = [3.0_dp*(i - 1), 1.0_dp]
         supports(2 + i) = support_at_point(matmul(to, at), [1], [dot_product(to(1, :), &
            [0.3_dp*pressure*at(1) + 2.6_dp*shear, -pressure]/1000.0_dp)])
         do k = 1, 2
            loads(2*i + k - 2) = traction_on_set(trim(blocks(i))//trim(sides(k)), &
               matmul(to, [0.0_dp, shear*(2*k - 3)]))
         end do
      end do
      loads(5) = traction_on_set('upper.top', matmul(to, [shear, -pressure]))
      loads(6) = traction_on_set('lower.bottom', matmul(to, [-shear, 0.0_dp]))
      call turn(mesh, turned_by)
   end subroutine sheared_blocks

   !> Both blocks guided at x = 0, the lower one at y = 0, too.
   function symmetric_supports() result(supports)
      type(support_t) :: supports(3)

      supports(1) = support_on_set('lower.left', [1], [0.0_dp])
      supports(2) = support_on_set('upper.left', [1], [0.0_dp])
      supports(3) = support_on_set('lower.bottom', [2], [0.0_dp])
   end function symmetric_supports

end module sample_pairs
