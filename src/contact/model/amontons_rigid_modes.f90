!> Rigid-body modes that supports leave free, as displacements of the contact points.
module amontons_rigid_modes
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: symmetric_eigenvectors
   use amontons_kinds, only: dp
   use amontons_rigid_motion, only: rigid_motions_t
   implicit none (type, external)
   private

   public :: common_motions, find_rigid_modes, largest_motion

contains

   !> The displacements of the points under each free rigid motion of each piece. Without coordinates all nodes that a
   !> point is made of lie where the point is: of a pair, as if the bodies met there. What rotations do along the
   !> normals then no longer depends on the facets of the master, nor on the gap, which is along the normal.
   pure subroutine find_rigid_modes(modes, zone, motions, coordinates)
      real(dp), allocatable, intent(out) :: modes(:, :) !! (u_N; u_T) of the points under each motion (2m, motions) [-]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions of each piece
      real(dp), intent(in), optional :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      logical, allocatable :: is_inside(:)
      real(dp) :: position(2)
      integer :: i, j, k, p

      allocate (modes(2*zone%n_points, sum(motions%n_free)), source=0.0_dp)
      allocate (is_inside(maxval([0, zone%rows%node])))
      k = 0
      do j = 1, size(motions)
         is_inside = .false.
         is_inside(pack(motions(j)%node, motions(j)%node <= size(is_inside))) = .true.
         do p = 1, zone%n_points
            do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
               if (.not. is_inside(zone%rows%node(i))) cycle
               position = zone%position(:, p)
               if (present(coordinates)) position = coordinates(:, zone%rows%node(i))
               call add_motion(modes, k, motions(j), position, zone, p, i)
            end do
         end do
         k = k + motions(j)%n_free
      end do
   end subroutine find_rigid_modes

   !> Adds the part that the motion of a node has in that of a point.
   pure subroutine add_motion(modes, n_before, motions, position, zone, point, part)
      real(dp), intent(inout) :: modes(:, :) !! (u_N; u_T) of the points under each motion (2m, motions) [-]
      integer, intent(in) :: n_before !! how many motions other pieces have before
      type(rigid_motions_t), intent(in) :: motions !! the free motions of the node's piece
      real(dp), intent(in) :: position(2) !! where the node is [L]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: point !! the point
      integer, intent(in) :: part !! which part of the zone's rows is that of the node
      real(dp) :: motion(2, motions%n_free)
      integer :: i

      motion = motions%displacement(position)
      do i = 1, motions%n_free
         associate (mode => modes(:, n_before + i), m => zone%n_points)
            mode(point) = mode(point) + dot_product(zone%rows%part(:, part), motion(:, i))
            ! The contact problem does not know the slip that a support prevents.
            if (.not. zone%is_tangent_fixed(point)) mode(m + point) = mode(m + point) &
               + dot_product(zone%rows%tangent(:, part), motion(:, i))
         end associate
      end do
   end subroutine add_motion

   !> Combinations of the free motions of all pieces that no contact point notices (motions, any) [-].
   function common_motions(modes) result(amounts)
      real(dp), intent(in) :: modes(:, :) !! displacements of the points under each motion, from `find_rigid_modes`
      real(dp), allocatable :: amounts(:, :)
      ! Squares of displacements have half of the digits, and meshes of curves meet to a few. A motion moves the points
      ! of the body by about 1.
      real(dp), parameter :: negligible = 1.0e-12_dp
      real(dp) :: values(size(modes, 2))
      integer :: info

      amounts = matmul(transpose(modes), modes)
      if (size(amounts) == 0) return
      call symmetric_eigenvectors(amounts, values, info)
      amounts = amounts(:, :count(values <= negligible*max(values(size(values)), 0.5_dp*size(modes, 1))))
   end function common_motions

   !> Names a combination of the free motions of some pieces by that of the piece that moves most.
   pure function largest_motion(motions, amounts) result(text)
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions of each piece
      real(dp), intent(in) :: amounts(:) !! amount of each, piece after piece (n_free of all)
      character(:), allocatable :: text
      integer :: first(size(motions) + 1), i

      first(1) = 1
      do i = 1, size(motions)
         first(i + 1) = first(i) + motions(i)%n_free
      end do
      i = maxloc([(norm2(amounts(first(i):first(i + 1) - 1)), i=1, size(motions))], dim=1)
      text = motions(i)%describe(amounts(first(i):first(i + 1) - 1))
   end function largest_motion

end module amontons_rigid_modes
