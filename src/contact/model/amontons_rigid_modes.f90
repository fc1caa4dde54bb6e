!> What the contact points see of the rigid motions that supports leave free.
module amontons_rigid_modes
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: symmetric_eigenvectors
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp
   use amontons_rigid_motion, only: rigid_motions_t
   implicit none (type, external)
   private

   public :: check_common_motion, find_modes_at_points, find_rigid_modes, largest_motion

contains

   !> The displacements of the points under each free rigid motion of each piece.
   subroutine find_rigid_modes(modes, zone, motions, coordinates)
      real(dp), allocatable, intent(out) :: modes(:, :) !! (u_N; u_T) of the points under each motion (2m, motions) [-]
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions of each piece
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), allocatable :: field(:, :, :)
      real(dp) :: at_node(2, 3)
      integer :: i, j, k, m

      m = zone%n_points
      allocate (modes(2*m, sum(motions%n_free)), field(2, size(coordinates, 2), 3))
      k = 0
      do i = 1, size(motions)
         associate (motion => motions(i))
            field = 0.0_dp
            do j = 1, size(motion%node)
               at_node(:, :motion%n_free) = motion%displacement(coordinates(:, motion%node(j)))
               field(:, motion%node(j), :motion%n_free) = at_node(:, :motion%n_free)
            end do
            do j = 1, motion%n_free
               k = k + 1
               modes(:, k) = zone%rows%displacement(field(:, :, j))
               ! The contact problem does not know the slip that a support prevents.
               modes(m + 1:, k) = merge(0.0_dp, modes(m + 1:, k), zone%is_tangent_fixed)
            end do
         end associate
      end do
   end subroutine find_rigid_modes

   !> The same as if all nodes that a point is made of lay where the point is: of a pair, as if the bodies met there.
   !> What rotations then do along the normals no longer depends on the facets of the master, nor on the gap, which is
   !> along the normal.
   pure subroutine find_modes_at_points(modes, zone, motions)
      real(dp), allocatable, intent(out) :: modes(:, :) !! (u_N; u_T) of the points under each motion (2m, motions) [-]
      type(contact_zone_t), intent(in) :: zone !! the contact points, each of a node
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions of each piece
      logical, allocatable :: is_inside(:)
      integer :: i, j, k, p

      allocate (modes(2*zone%n_points, sum(motions%n_free)), source=0.0_dp)
      allocate (is_inside(maxval([0, zone%rows%node])))
      k = 0
      do j = 1, size(motions)
         is_inside = .false.
         is_inside(pack(motions(j)%node, motions(j)%node <= size(is_inside))) = .true.
         do p = 1, zone%n_points
            associate (motion => motions(j)%displacement(zone%position(:, p)), m => zone%n_points, &
               last => k + motions(j)%n_free)
               do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
                  if (.not. is_inside(zone%rows%node(i))) cycle
                  modes(p, k + 1:last) = modes(p, k + 1:last) + matmul(zone%rows%part(:, i), motion)
                  if (.not. zone%is_tangent_fixed(p)) modes(m + p, k + 1:last) = modes(m + p, k + 1:last) &
                     + matmul(zone%rows%along(i), motion)
               end do
            end associate
         end do
         k = k + motions(j)%n_free
      end do
   end subroutine find_modes_at_points

   !> Refuses pieces that can move together so that no contact point notices.
   subroutine check_common_motion(motions, modes, error)
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions of each piece
      real(dp), intent(in) :: modes(:, :) !! the displacements of the points under each, from `find_rigid_modes`
      type(error_t), allocatable, intent(out) :: error !! they can; names the motion of one of them
      ! Squares of displacements have half of the digits, and meshes of curves meet to a few.
      real(dp), parameter :: negligible = 1.0e-12_dp
      real(dp), allocatable :: gram(:, :), values(:)
      integer :: info

      if (all(motions%n_free == 0)) return
      allocate (gram, source=matmul(transpose(modes), modes))
      allocate (values(size(gram, 1)))
      call symmetric_eigenvectors(gram, values, info)
      if (info /= 0 .or. values(1) > negligible*values(size(values))) return
      call new_error(error, numerical_failure, 'nothing holds the bodies together against a common motion: '// &
         largest_motion(motions, gram(:, 1))//'; contact between them cannot; add a support')
   end subroutine check_common_motion

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
