!> Finite motions, called poses, of rigid obstacles and of the pieces of a body in the plane that may turn far.
!>
!> Where contact slides far, a piece that one rigid set alone supports, or nothing, has a frame of its own. Its nodes
!> are at x = X + d(X) + R u, with the displacement d of the pose, its rotation R and small elastic displacements u. So
!> stiffness and flexibility of the piece are those at rest. The pose is that of the rigid set; of a piece without one
!> it is the motion of its contact nodes that leaves the least squares of u there.
module amontons_pose
   use amontons_constraints, only: constraints_t, spring_side_t
   use amontons_frame, only: turned
   use amontons_kinds, only: dp
   use amontons_rigid_motion, only: rigid_motions_t
   implicit none (type, external)
   private

   public :: elastic_part, find_turning_pieces, pose_t, stated_poses, turn_forth, turn_vectors, turning_piece_t, &
      whole_displacement

   !> A finite motion: in the plane a rotation about the pivot, and then a shift.
   type :: pose_t
      real(dp) :: shift(3) = 0.0_dp !! shift along x, y and z [L]
      real(dp) :: turn = 0.0_dp !! angle, counterclockwise [rad]
      real(dp) :: pivot(2) = 0.0_dp !! pivot of the rotation [L]
   contains
      procedure :: displacement => pose_displacement
      procedure :: is_at_rest => pose_is_at_rest
      procedure :: origin => pose_origin
      procedure :: rotated => pose_rotated
   end type pose_t

   !> A piece of a body in the plane that may turn far.
   type :: turning_piece_t
      integer, allocatable :: node(:) !! its nodes
      integer, allocatable :: reference(:) !! the nodes whose motion is its pose
      real(dp) :: point(2) = 0.0_dp !! the pivot: the point of its rigid set, or the mean of the reference nodes [L]
      integer :: rigid = 0 !! number of its rigid set, 0 without one
      integer :: driven(3) = 0 !! the numbers of this set's motions among the driven motions of the body
      logical :: is_held(3) = .false. !! which of these motions supports prescribe
   contains
      procedure :: pose => turning_piece_pose
      procedure :: thrust => turning_piece_thrust
      procedure :: unit_motion => turning_piece_unit_motion
   end type turning_piece_t

contains

   !> Finds the pieces of a plane body that one rigid set alone supports, or nothing; those with a rigid set come first.
   pure subroutine find_turning_pieces(pieces, motions, constraints, springs, coordinates, contact_node)
      type(turning_piece_t), allocatable, intent(out) :: pieces(:) !! the pieces
      type(rigid_motions_t), intent(in) :: motions(:) !! all pieces of the body, and what they are free to do
      type(constraints_t), intent(in) :: constraints !! the supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      integer, intent(in) :: contact_node(:) !! the nodes of contact sets
      type(turning_piece_t) :: piece
      logical :: is_here(size(coordinates, 2))
      integer :: i, k

      allocate (pieces(0))
      do k = 1, size(motions)
         associate (nodes => motions(k)%node)
            if (motions(k)%n_joints > 0) cycle
            is_here = .false.
            is_here(nodes) = .true.
            if (any([(any(is_here(springs(i)%node)), i=1, size(springs))])) cycle
            piece%rigid = maxval(constraints%rigid_of(nodes))
            if (any((constraints%rigid_of(nodes) == 0 .or. constraints%rigid_of(nodes) /= piece%rigid) .and. &
               .not. all(constraints%is_free(:, nodes), dim=1))) cycle
            piece%node = nodes
            piece%reference = pack(contact_node, is_here(contact_node))
            piece%is_held = .false.
            if (piece%rigid > 0) then
               associate (rigid => constraints%rigid(piece%rigid))
                  piece%reference = rigid%node
                  piece%point = rigid%point
                  piece%is_held = [(.not. constraints%is_free(rigid%axis(i), rigid%lead(i)), i=1, 3)]
               end associate
               pieces = [piece, pieces]
            else if (size(piece%reference) > 1) then
               piece%point = sum(coordinates(:, piece%reference), dim=2)/size(piece%reference)
               pieces = [pieces, piece]
            end if
         end associate
      end do
   end subroutine find_turning_pieces

   !> Whether it moves nothing.
   elemental logical function pose_is_at_rest(self) result(is_at_rest)
      class(pose_t), intent(in) :: self !! the pose

      is_at_rest = .not. (any(abs(self%shift) > 0.0_dp) .or. abs(self%turn) > 0.0_dp)
   end function pose_is_at_rest

   !> Displacement of a point. 1 - cos is written as a square of a sine, so that small angles keep their digits (n_dim)
   !> [L].
   pure function pose_displacement(self, position) result(displacement)
      class(pose_t), intent(in) :: self !! the pose
      real(dp), intent(in) :: position(:) !! initial position of the point (n_dim) [L]
      real(dp) :: displacement(size(position))

      displacement = self%shift(:size(position))
      associate (arm => position(:2) - self%pivot)
         displacement(:2) = displacement(:2) + sin(self%turn)*turned(arm) - 2.0_dp*sin(0.5_dp*self%turn)**2*arm
      end associate
   end function pose_displacement

   !> Where a point was at rest (n_dim) [L].
   pure function pose_origin(self, position) result(origin)
      class(pose_t), intent(in) :: self !! the pose
      real(dp), intent(in) :: position(:) !! where it is now (n_dim) [L]
      real(dp) :: origin(size(position))
      type(pose_t) :: back

      back%turn = -self%turn
      back%pivot = self%pivot
      origin = position - self%shift(:size(position))
      origin = origin + back%displacement(origin)
   end function pose_origin

   !> A vector turned with the pose, or turned back.
   pure function pose_rotated(self, vector, is_back) result(rotated)
      class(pose_t), intent(in) :: self !! the pose
      real(dp), intent(in) :: vector(2) !! the vector
      logical, intent(in) :: is_back !! whether to turn it back
      real(dp) :: rotated(2)

      rotated = cos(self%turn)*vector + merge(-1.0_dp, 1.0_dp, is_back)*sin(self%turn)*turned(vector)
   end function pose_rotated

   !> The pose of displaced nodes: the nearest motion of its reference nodes, in the least squares (Kabsch). Of the
   !> turns that differ by full ones it is the one nearest to another.
   pure type(pose_t) function turning_piece_pose(self, coordinates, displacement, near) result(pose)
      class(turning_piece_t), intent(in) :: self !! the piece
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: displacement(:, :) !! their displacements (2, n_nodes) [L]
      real(dp), intent(in) :: near !! the turn that it is near to [rad]
      real(dp), parameter :: full = 8.0_dp*atan(1.0_dp)
      real(dp) :: middle(2), moved(2), along, across
      integer :: i

      associate (n => size(self%reference))
         middle = sum(coordinates(:, self%reference), dim=2)/n
         moved = sum(displacement(:, self%reference), dim=2)/n
         along = 0.0_dp
         across = 0.0_dp
         do i = 1, n
            associate (arm => coordinates(:, self%reference(i)) - middle, way => displacement(:, self%reference(i)) &
               - moved)
               along = along + dot_product(arm, arm + way)
               across = across + dot_product(turned(arm), way)
            end associate
         end do
      end associate
      pose%pivot = self%point
      pose%turn = atan2(across, along)
      pose%turn = pose%turn + full*anint((near - pose%turn)/full)
      pose%shift(:2) = moved - pose%displacement(middle)
   end function turning_piece_pose

   !> The displacements of the nodes of a piece in a unit of one of its motions, in the frame of the piece; 0 at others
   !> (2, n_nodes) [-], [L]. Arms are those of the strained shape; a piece without a rigid set can be in equilibrium
   !> only with those at rest.
   pure function turning_piece_unit_motion(self, pose, axis, coordinates, elastic) result(field)
      class(turning_piece_t), intent(in) :: self !! the piece
      type(pose_t), intent(in) :: pose !! its pose
      integer, intent(in) :: axis !! the motion: along x, along y, turn about its point
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: elastic(:, :) !! their displacements in the frame of the piece (2, n_nodes) [L]
      real(dp) :: field(2, size(coordinates, 2))
      integer :: i

      field = 0.0_dp
      do i = 1, size(self%node)
         associate (node => self%node(i))
            field(:, node) = turned(coordinates(:, node) - self%point + merge(elastic(:, node), 0.0_dp, self%rigid > 0))
            if (axis < 3) field(:, node) = pose%rotated([real(dp) :: 2 - axis, axis - 1], is_back=.true.)
         end associate
      end do
   end function turning_piece_unit_motion

   !> Force along x and y that the rigid set of a piece exerts on it, and moment about its point (3) [F], [F L].
   pure function turning_piece_thrust(self, pose, coordinates, elastic, reaction, contact) result(thrust)
      class(turning_piece_t), intent(in) :: self !! the piece
      type(pose_t), intent(in) :: pose !! its pose
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: elastic(:, :) !! their displacements in the frame of the piece (2, n_nodes) [L]
      real(dp), intent(in) :: reaction(:, :) !! its reactions, from stresses of the shape at rest (2, n_nodes) [F]
      real(dp), intent(in) :: contact(:, :) !! contact forces, in the frame of the piece (2, n_nodes) [F]
      real(dp) :: thrust(3)
      integer :: axis

      do axis = 1, 3
         thrust(axis) = sum(self%unit_motion(pose, axis, coordinates, elastic)*reaction)
      end do
      if (self%rigid > 0) thrust(3) = thrust(3) - sum(elastic(1, self%node)*contact(2, self%node) &
         - elastic(2, self%node)*contact(1, self%node))
   end function turning_piece_thrust

   !> The poses of pieces from their shifts and turns.
   pure function stated_poses(pieces, posed) result(poses)
      type(turning_piece_t), intent(in) :: pieces(:) !! the pieces that turn
      real(dp), intent(in) :: posed(:, :) !! shift along x and y, turn (at least 3, pieces) [L], [rad]
      type(pose_t) :: poses(size(pieces))
      integer :: k

      poses = [(pose_t([posed(:2, k), 0.0_dp], posed(3, k), pieces(k)%point), k=1, size(pieces))]
   end function stated_poses

   !> The elastic displacements u of all nodes, in the frames of their pieces (components, n_nodes) [L].
   pure function elastic_part(pieces, poses, coordinates, displacement) result(elastic)
      type(turning_piece_t), intent(in) :: pieces(:) !! the pieces that turn
      type(pose_t), intent(in) :: poses(:) !! their poses
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (components, n_nodes) [L]
      real(dp) :: elastic(size(displacement, 1), size(displacement, 2))
      integer :: i, k

      elastic = displacement
      do k = 1, size(pieces)
         do i = 1, size(pieces(k)%node)
            associate (node => pieces(k)%node(i))
               elastic(:, node) = poses(k)%rotated(displacement(:, node) - poses(k)%displacement(coordinates(:, &
                  node)), is_back=.true.)
            end associate
         end do
      end do
   end function elastic_part

   !> The displacements of all nodes from elastic ones (components, n_nodes) [L].
   pure function whole_displacement(pieces, poses, coordinates, elastic) result(displacement)
      type(turning_piece_t), intent(in) :: pieces(:) !! the pieces that turn
      type(pose_t), intent(in) :: poses(:) !! their poses
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: elastic(:, :) !! elastic displacements, in the frames of pieces (components, n_nodes) [L]
      real(dp) :: displacement(size(elastic, 1), size(elastic, 2))
      integer :: i, k

      displacement = elastic
      do k = 1, size(pieces)
         do i = 1, size(pieces(k)%node)
            associate (node => pieces(k)%node(i))
               displacement(:, node) = poses(k)%displacement(coordinates(:, node)) &
                  + poses(k)%rotated(elastic(:, node), is_back=.false.)
            end associate
         end do
      end do
   end function whole_displacement

   !> Turns vectors at the nodes with their pieces, or back into the frames of these.
   pure subroutine turn_vectors(pieces, poses, vectors, is_back)
      type(turning_piece_t), intent(in) :: pieces(:) !! the pieces that turn
      type(pose_t), intent(in) :: poses(:) !! their poses
      real(dp), intent(inout) :: vectors(:, :) !! the vectors (components, n_nodes)
      logical, intent(in) :: is_back !! whether to turn them back
      integer :: i, k

      do k = 1, size(pieces)
         do i = 1, size(pieces(k)%node)
            associate (vector => vectors(:, pieces(k)%node(i)))
               vector = poses(k)%rotated(vector, is_back)
            end associate
         end do
      end do
   end subroutine turn_vectors

   !> Turns stresses into the axes of the body.
   pure subroutine turn_forth(pieces, poses, of_node, stress)
      type(turning_piece_t), intent(in) :: pieces(:) !! the pieces that turn
      type(pose_t), intent(in) :: poses(:) !! their poses
      integer, intent(in) :: of_node(:) !! a node of the piece that each stress is in (any)
      real(dp), intent(inout) :: stress(:, :) !! stresses (xx, yy, zz, xy, ...) (n_strains, any) [F/L^2]
      integer :: piece_of(maxval([0, of_node])), i, k

      piece_of = 0
      do k = 1, size(pieces)
         piece_of(pack(pieces(k)%node, pieces(k)%node <= size(piece_of))) = k
      end do
      do i = 1, size(of_node)
         if (piece_of(of_node(i)) == 0) cycle
         associate (s => stress(:, i), c => cos(poses(piece_of(of_node(i)))%turn), d => sin(poses(piece_of(of_node( &
            i)))%turn))
            s(:4) = [c**2*s(1) + d**2*s(2) - 2.0_dp*c*d*s(4), d**2*s(1) + c**2*s(2) + 2.0_dp*c*d*s(4), s(3), &
               c*d*(s(1) - s(2)) + (c**2 - d**2)*s(4)]
         end associate
      end do
   end subroutine turn_forth

end module amontons_pose
