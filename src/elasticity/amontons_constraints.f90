!> The supports of a body: which directions of which nodes are held, and at which displacements; sets of nodes that move
!> as rigid bodies; elastic foundations, which are springs along sides with stiffnesses along normal and tangent; and
!> the numbers of the unknowns, the free displacement components, with those of chosen nodes last.
!>
!> Displacements of some nodes are not unknowns themselves: those of the slave of a pair follow from the displacements
!> of other nodes and from unknowns of their own, u = P y. For most nodes u = y. The own unknown of a corner of a slave
!> is its relative displacement w, that of a middle node between two corners its deviation from their mean. The own
!> unknown of a bonded node is fixed at 0. Stiffness and load of the unknowns are P^T K P and P^T f, computed element by
!> element.
module amontons_constraints
   use amontons_boundary, only: new_patch, patch_t
   use amontons_dense, only: vector_product
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face, only: face_t, set_faces
   use amontons_frame, only: new_frame, new_frames
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t, on_axis
   use amontons_mesh, only: find_set, mesh_t
   use amontons_rigid_set, only: new_rigid_set, rigid_face_t, rigid_set_t
   use amontons_text, only: place_text
   implicit none (type, external)
   private

   public :: constraints_t, dof_map_t, new_constraints, new_dof_map, new_foundation, new_support, spring_side_t, &
      substitution_t, support_t, supported_components

   !> The components of a displacement that a support may prescribe: x, y, z, outward normal, tangent (in space all
   !> tangents), around the axis, and the angle of a rotation about it.
   character(6), parameter :: supported_components(*) = [character(6) :: 'ux', 'uy', 'uz', 'un', 'ut', 'utheta', 'turn']
   !> Their indices; the first ones are the coordinates.
   integer, parameter, public :: along_normal = 4, along_tangent = 5
   integer, parameter :: along_z = 3, around_axis = 6, by_turn = 7

   !> A prescribed displacement or an elastic foundation of a boundary set, or a prescribed displacement of the node at
   !> a point.
   type :: support_t
      character(:), allocatable :: name !! its name, by which a load history refers to it; empty without one
      character(:), allocatable :: set !! name of the boundary set; empty for a support at a point
      real(dp) :: point(3) = 0.0_dp !! coordinates of the node [L]; read when `set` is empty
      logical :: is_held(size(supported_components)) = .false. !! which components are prescribed
      real(dp) :: displacement(size(supported_components)) = 0.0_dp !! their values; that of a turn an angle [L], [rad]
      real(dp) :: spring(2) = 0.0_dp !! stress per displacement along normal and tangent of the set [F/L^3]
      type(rigid_face_t) :: rigid
         !! whether sets, separated by commas in `set`, move as one rigid body; the first components are those of
         !! `rigid_components` then
      logical :: is_jump = .false. !! whether the first component is the jump of the preload of the same name
      real(dp) :: lock_time = huge(1.0_dp)
         !! of a rigid set or preload: time of a history from which on its free motions are locked [-]
      character(:), allocatable :: origin !! where the support was specified, for messages: 'deck.nml:12: '
   contains
      procedure :: is_driven => support_is_driven
   end type support_t

   !> The directions that the supports hold, node by node. Each node has an orthonormal frame; its displacement is the
   !> sum of what a load case prescribes and of free parts along the axes of the frame.
   type :: constraints_t
      logical, allocatable :: is_free(:, :)
         !! whether the node can move along each axis of its frame (components, n_nodes)
      real(dp), allocatable :: frame(:, :, :)
         !! the axes as columns; in a twisted body the last one is the direction around the axis of revolution
         !! (components, components, n_nodes) [-]
      type(rigid_set_t), allocatable :: rigid(:)
         !! sets that move as rigid bodies: the own unknowns of their leading nodes are those of the motion; the
         !! components of all others count as held
      integer, allocatable :: rigid_of(:) !! the set that each node belongs to, 0 for none (n_nodes)
      real(dp), allocatable :: place(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      integer, allocatable :: holder(:, :)
         !! number of the support that holds each of them; 0 for none (components, n_nodes)
      real(dp), allocatable :: skew(:, :, :)
         !! components of the direction of that support along the other axes, over that along this one, which is the
         !! second index (components, components, n_nodes) [-]
   contains
      procedure :: free_projector => constraints_free_projector
      procedure :: held_direction => constraints_held_direction
      procedure :: contact_frames => constraints_contact_frames
      procedure :: fixed_tangents => constraints_fixed_tangents
      procedure :: is_turned => constraints_is_turned
      procedure :: is_twisted => constraints_is_twisted
      procedure :: leaves_free => constraints_leaves_free
      procedure :: supported_part => constraints_supported_part
      procedure :: rigid_moves => constraints_rigid_moves
      procedure :: spread_resultants => constraints_spread_resultants
      procedure, private :: hold => constraints_hold
   end type constraints_t

   !> Largest length of the name of a rigid set.
   integer, parameter, public :: longest_name = 16

   !> Components of a unit vector below this limit count as 0: mesh files carry about eight digits, so that directions
   !> which should agree differ in the last of them.
   real(dp), parameter, public :: negligible = 1.0e-6_dp

   !> The springs of one side: a small stiffness on its nodes.
   type :: spring_side_t
      integer :: support = 0 !! number of the support
      integer :: number = 0 !! number of the element's side
      integer, allocatable :: node(:) !! its nodes
      real(dp), allocatable :: stiffness(:, :, :, :) !! stiffness (components, nodes, components, nodes) [F/L]
   end type spring_side_t

   !> The rows of P of the nodes whose displacements are substituted: those of node i from `start(i)` to `start(i + 1) -
   !> 1`, none where u = y.
   type :: substitution_t
      integer, allocatable :: start(:) !! not allocated where no node is substituted (n_nodes + 1)
      integer, allocatable :: node(:) !! node whose own unknowns take part
      real(dp), allocatable :: block(:, :, :) !! how: u = sum block y (components, components, blocks) [-]
      logical, allocatable :: is_bonded(:, :)
         !! whether the own unknowns of a node are held at 0, or at a prescribed jump (components, n_nodes)
   contains
      procedure :: displacement => substitution_displacement
      procedure :: element_nodes => substitution_element_nodes
      procedure :: forces => substitution_forces
      procedure :: is_substituted => substitution_is_substituted
      procedure :: own_nodes_of_elements => substitution_own_nodes_of_elements
      procedure :: copy_part => substitution_copy_part
      procedure :: transform => substitution_transform
   end type substitution_t

   !> The number of the unknown of each component of each node.
   type :: dof_map_t
      integer :: n_dofs = 0 !! number of unknowns
      integer :: n_schur = 0 !! number of unknowns of the nodes that are numbered last
      integer :: n_lockable = 0
         !! number of the last ones, which belong to no contact point and which a history may lock
      integer, allocatable :: dof(:, :)
         !! unknown of the component along each axis of a node's frame, 0 if held (components, n_nodes)
      type(substitution_t) :: substitution !! displacements of the nodes in terms of the unknowns
   end type dof_map_t

contains

   !> Makes a support of a boundary set, without held components yet.
   pure subroutine new_support(support, set)
      type(support_t), intent(out) :: support !! the support
      character(*), intent(in) :: set !! name of the boundary set

      support%name = ''
      support%set = set
      support%origin = ''
   end subroutine new_support

   !> Applies all supports to the nodes of a mesh. Supports that hold the same components make the same constraints,
   !> whatever displacements they prescribe. A support that needs no normal holds all nodes of its set, otherwise those
   !> of its sides.
   subroutine new_constraints(constraints, prescribed, mesh, supports, error, materials)
      type(constraints_t), intent(out) :: constraints !! the constraints
      real(dp), allocatable, intent(out) :: prescribed(:, :) !! prescribed displacements (components, n_nodes) [L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(support_t), intent(in) :: supports(:) !! the supports
      type(error_t), allocatable, intent(out) :: error !! a set or node is missing, or supports contradict each other
      type(materials_t), intent(in), optional :: materials
         !! the materials, which say whether the body is twisted; it is not without them
      type(patch_t) :: patch
      logical :: is_done
      integer :: i, set

      call begin_constraints(constraints, prescribed, mesh, materials)
      do i = 1, size(supports)
         if (.not. supports(i)%is_driven()) cycle
         if (any([(supports(set)%is_driven() .and. supports(set)%name == supports(i)%name, set=1, i - 1)])) then
            call new_error(error, input_refused, supports(i)%origin//"another rigid set or preload has the name '"// &
               supports(i)%name//"'; give rigid sets as one: set = 'A, B'")
            return
         end if
         if (supports(i)%rigid%is_given) call add_rigid_set(constraints, prescribed, mesh, supports(i), i, error)
         if (allocated(error)) return
      end do
      do i = 1, size(supports)
         associate (support => supports(i))
            if (support%is_driven()) cycle
            is_done = len(support%set) == 0
            if (is_done) call hold_nodes(constraints, prescribed, mesh, &
               [mesh%nearest_node(support%point(:size(mesh%coordinates, 1)))], support, i, error)
            set = find_set(mesh%node_sets, support%set)
            if (set > 0 .and. .not. any(support%is_held(along_normal:along_tangent)) .and. &
               any(support%is_held)) then
               call hold_nodes(constraints, prescribed, mesh, mesh%node_sets(set)%node, support, i, error)
               ! Where it covers sides, they are held as a whole: a refined mesh has more nodes on them.
               is_done = allocated(error) .or. find_set(mesh%sets, support%set) == 0
            end if
            if (.not. is_done) call new_patch(patch, mesh, support%set, error)
            if (.not. (is_done .or. allocated(error))) call hold_nodes(constraints, prescribed, mesh, patch%node, &
               support, i, error, patch%normal)
            if (.not. allocated(error)) cycle
            error%message = support%origin//error%message
            return
         end associate
      end do
   end subroutine new_constraints

   !> Makes constraints in which all nodes are free, except around the axis those on the axis of a twisted body.
   pure subroutine begin_constraints(constraints, prescribed, mesh, materials)
      type(constraints_t), intent(inout) :: constraints !! the constraints
      real(dp), allocatable, intent(out) :: prescribed(:, :) !! prescribed displacements, 0 (components, n_nodes) [L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in), optional :: materials !! as in `new_constraints`
      integer :: n_components, axis

      n_components = size(mesh%coordinates, 1)
      if (present(materials)) n_components = materials%n_components()
      allocate (constraints%is_free(n_components, mesh%n_nodes), source=.true.)
      allocate (constraints%frame(n_components, n_components, mesh%n_nodes), prescribed(n_components, mesh%n_nodes), &
         source=0.0_dp)
      do axis = 1, n_components
         constraints%frame(axis, axis, :) = 1.0_dp
      end do
      allocate (constraints%holder(n_components, mesh%n_nodes), source=0)
      allocate (constraints%skew(n_components, n_components, mesh%n_nodes), source=0.0_dp)
      allocate (constraints%rigid_of(mesh%n_nodes), source=0)
      constraints%place = mesh%coordinates
      if (constraints%is_twisted()) constraints%is_free(3, :) = .not. on_axis(mesh, materials)
      allocate (constraints%rigid(0))
   end subroutine begin_constraints

   !> Whether the support holds no nodes but prescribes the motion of a rigid set or the jump of a preload.
   elemental logical function support_is_driven(self) result(is_driven)
      class(support_t), intent(in) :: self !! the support

      is_driven = self%rigid%is_given .or. self%is_jump
   end function support_is_driven

   !> Adds a set that moves as a rigid body.
   subroutine add_rigid_set(constraints, prescribed, mesh, support, number, error)
      type(constraints_t), intent(inout) :: constraints !! the constraints
      real(dp), intent(inout) :: prescribed(:, :) !! prescribed displacements, own unknowns (components, n_nodes) [L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(support_t), intent(in) :: support !! the set, and the prescribed part of its motion
      integer, intent(in) :: number !! its number
      type(error_t), allocatable, intent(out) :: error !! a set is missing, or has a node of another rigid one
      type(rigid_set_t) :: rigid
      integer :: shared, k

      call new_rigid_set(rigid, mesh, support%set, support%rigid, size(prescribed, 1), error)
      if (.not. allocated(error)) then
         shared = findloc(constraints%rigid_of(rigid%node) > 0, .true., dim=1)
         if (shared > 0) call new_error(error, input_refused, 'the node at '// &
            place_text(mesh%coordinates(:, rigid%node(shared)))//' belongs to two rigid sets; give them as one: '// &
            "set = 'A, B'")
         if (all(.not. constraints%is_free(size(prescribed, 1), rigid%node))) call new_error(error, input_refused, &
            'the rigid set lies on the axis of revolution and cannot turn')
      end if
      if (allocated(error)) error%message = support%origin//error%message
      if (allocated(error)) return
      constraints%is_free(:, rigid%node) = .false.
      do k = 1, size(rigid%component)
         associate (component => rigid%component(k))
            constraints%is_free(rigid%axis(k), rigid%lead(k)) = .not. support%is_held(component)
            prescribed(rigid%axis(k), rigid%lead(k)) = merge(support%displacement(component), 0.0_dp, &
               support%is_held(component))*merge(rigid%length, 1.0_dp, component > 3)
         end associate
      end do
      constraints%rigid = [constraints%rigid, rigid]
      constraints%rigid_of(rigid%node) = size(constraints%rigid)
      constraints%holder(:, rigid%node) = number
   end subroutine add_rigid_set

   !> Checks that a support agrees with the rigid motion of the set that its node belongs to.
   subroutine check_on_rigid(constraints, prescribed, mesh, node, direction, displacement, error)
      type(constraints_t), intent(in) :: constraints !! the constraints
      real(dp), intent(in) :: prescribed(:, :) !! prescribed displacements, own unknowns (components, n_nodes) [L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: direction(:) !! unit vector along which the support holds the node (components) [-]
      real(dp), intent(in) :: displacement !! the prescribed displacement along the direction [L]
      type(error_t), allocatable, intent(out) :: error !! the motion along the direction is free, or another one
      real(dp) :: block(size(direction), size(direction), 2), moved(size(direction))

      associate (rigid => constraints%rigid(constraints%rigid_of(node)))
         block = rigid%displacement(mesh%coordinates(:, node))
         moved = matmul(block(:, :, 1), prescribed(:, rigid%carrier(1))) &
            + matmul(block(:, :, 2), prescribed(:, rigid%carrier(2)))
         if (constraints%rigid_moves(node, direction)) then
            call new_error(error, input_refused, 'the support holds the node at '// &
               place_text(mesh%coordinates(:, node))//' of a rigid set; prescribe ux, uy or '// &
               'turn of the &rigid instead')
         else if (abs(dot_product(direction, moved) - displacement) > negligible*(abs(displacement) &
            + norm2(moved))) then
            call new_error(error, input_refused, 'the support contradicts the motion of the rigid set at the node '// &
               place_text(mesh%coordinates(:, node)))
         end if
      end associate
   end subroutine check_on_rigid

   !> Whether a node belongs to a rigid set that may move it along a direction.
   pure logical function constraints_rigid_moves(self, node, direction) result(moves)
      class(constraints_t), intent(in) :: self !! the constraints
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: direction(:) !! unit vector, in the plane or with that around the axis [-]
      real(dp), allocatable :: block(:, :, :)

      moves = self%rigid_of(node) > 0
      if (.not. moves) return
      associate (rigid => self%rigid(self%rigid_of(node)))
         block = rigid%displacement(self%place(:, node))
         block = block(:size(direction), :, :)
         moves = any(abs([matmul(direction, block(:, :, 1)), matmul(direction, block(:, :, 2))]) > negligible &
            .and. [self%is_free(:, rigid%carrier(1)), self%is_free(:, rigid%carrier(2))])
      end associate
   end function constraints_rigid_moves

   !> Replaces resultants on the own unknowns of rigid sets by equivalent forces on their nodes.
   pure subroutine constraints_spread_resultants(self, forces)
      class(constraints_t), intent(in) :: self !! the constraints
      real(dp), intent(inout) :: forces(:, :)
         !! forces on the nodes' own unknowns; of rigid sets on return forces on nodes (components, n_nodes) [F]
      integer :: i, k

      do i = 1, size(self%rigid)
         associate (rigid => self%rigid(i))
            forces(:, rigid%carrier) = rigid%carrier_forces([(forces(rigid%axis(k), rigid%lead(k)) &
               *merge(rigid%length, 1.0_dp, rigid%component(k) > 3), k=1, size(rigid%axis))])
         end associate
      end do
   end subroutine constraints_spread_resultants

   !> Refuses components that a body has not.
   pure subroutine check_components(support, n_dim, is_twisted, error)
      type(support_t), intent(in) :: support !! the support
      integer, intent(in) :: n_dim !! number of dimensions
      logical, intent(in) :: is_twisted !! whether the body is twisted
      type(error_t), allocatable, intent(out) :: error !! it prescribes such a component

      if (any(support%is_held(around_axis:)) .and. .not. is_twisted) then
         call new_error(error, input_refused, 'utheta and turn need twist = .true. in &material')
      else if (support%is_held(along_z) .and. n_dim == 2) then
         call new_error(error, input_refused, 'uz needs a solid')
      else if (support%is_held(along_tangent) .and. n_dim == 3 .and. &
         abs(support%displacement(along_tangent)) > 0.0_dp) then
         call new_error(error, input_refused, 'ut of a solid must be 0: it has no direction; give ux, uy and uz')
      end if
   end subroutine check_components

   !> Holds the prescribed components of nodes.
   subroutine hold_nodes(constraints, prescribed, mesh, nodes, support, number, error, normal)
      type(constraints_t), intent(inout) :: constraints !! the constraints
      real(dp), intent(inout) :: prescribed(:, :) !! prescribed displacements (components, n_nodes) [L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: nodes(:) !! the nodes; 0 for none at the point of the support
      type(support_t), intent(in) :: support !! the support
      integer, intent(in) :: number !! its number
      type(error_t), allocatable, intent(out) :: error !! no node, or the supports contradict each other at one
      real(dp), intent(in), optional :: normal(:, :)
         !! outward normal at each; without it normal and tangential components do not exist (n_dim, nodes) [-]
      ! Behind the components the second tangent in space.
      real(dp) :: direction(size(prescribed, 1), size(supported_components) + 1), displacement
      real(dp) :: frame(size(prescribed, 1), size(prescribed, 1)), given(size(supported_components) + 1)
      logical :: is_held(size(given)), is_consistent
      integer :: component, i, n_dim

      n_dim = size(mesh%coordinates, 1)
      given = [support%displacement, 0.0_dp]
      is_held = [support%is_held, n_dim == 3 .and. support%is_held(along_tangent)]
      call check_components(support, n_dim, constraints%is_twisted(), error)
      if (any(nodes == 0)) then
         call new_error(error, input_refused, 'no node at the point '//place_text(support%point(:n_dim)))
      end if
      if (allocated(error)) return
      direction = 0.0_dp
      do i = 1, n_dim
         direction(i, i) = 1.0_dp
      end do
      direction(n_dim + 1:, around_axis:by_turn) = 1.0_dp
      do i = 1, size(nodes)
         if (present(normal)) frame = new_frame(normal(:, i), size(frame, 1))
         if (present(normal)) direction(:, along_normal:along_tangent) = frame(:, :2)
         if (present(normal) .and. n_dim == 3) direction(:, size(is_held)) = frame(:, 3)
         do component = 1, size(is_held)
            if (.not. is_held(component)) cycle
            displacement = given(component)
            if (component == by_turn) displacement = displacement*mesh%coordinates(1, nodes(i))
            if (any(component == [around_axis, by_turn])) then
               ! On the axis the displacement around it is 0, whether or not a support holds it.
               if (constraints%holder(3, nodes(i)) == 0 .and. .not. constraints%is_free(3, nodes(i))) cycle
            end if
            if (constraints%rigid_of(nodes(i)) > 0) then
               call check_on_rigid(constraints, prescribed, mesh, nodes(i), direction(:, component), displacement, &
                  error)
               if (allocated(error)) return
               cycle
            end if
            call constraints%hold(prescribed(:, nodes(i)), nodes(i), direction(:, component), displacement, number, &
               is_consistent)
            if (.not. is_consistent) exit
         end do
         if (component > size(is_held)) cycle
         call new_error(error, input_refused, 'the support contradicts an earlier one at the node '// &
            place_text(mesh%coordinates(:, nodes(i))))
         return
      end do
   end subroutine hold_nodes

   !> Holds a node in one direction: direction . u = displacement.
   pure subroutine constraints_hold(self, prescribed, node, direction, displacement, support, is_consistent)
      class(constraints_t), intent(inout) :: self !! the constraints
      real(dp), intent(inout) :: prescribed(:) !! prescribed displacement of the node (components) [L]
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: direction(:) !! unit vector (components) [-]
      real(dp), intent(in) :: displacement !! the prescribed displacement along the direction [L]
      integer, intent(in) :: support !! number of the support
      logical, intent(out) :: is_consistent !! whether no earlier support holds it elsewhere along this direction
      real(dp) :: missing, share(size(direction))
      real(dp), allocatable :: toward(:)
      integer, allocatable :: aslant(:)
      integer :: axis

      missing = displacement - dot_product(direction, prescribed)
      associate (frame => self%frame(:, :, node))
         ! The free axes that are not normal to the direction; the first of several is turned along it.
         share = matmul(direction, frame)
         aslant = pack([(axis, axis=1, size(share))], self%is_free(:, node) .and. abs(share) > negligible)
         is_consistent = size(aslant) > 0 .or. abs(missing) <= negligible*(abs(displacement) + norm2(prescribed))
         if (size(aslant) == 0) return
         toward = share(aslant)
         if (size(aslant) < size(share)) toward = toward/norm2(toward)
         if (size(aslant) > 1) frame(:, aslant) = matmul(frame(:, aslant), new_frame(toward, size(aslant)))
         axis = aslant(1)
         share = matmul(direction, frame)
         self%is_free(axis, node) = .false.
         self%holder(axis, node) = support
         self%skew(:, axis, node) = share/share(axis)
         self%skew(axis, axis, node) = 0.0_dp
         prescribed = prescribed + frame(:, axis)*missing/share(axis)
      end associate
   end subroutine constraints_hold

   !> The part of a motion on which the forces of some supports do work: the work of the reactions on this part is that
   !> of these supports on the motion. A support acts along the directions that it holds; a direction that an earlier
   !> support holds belongs to that one (components, n_nodes) [L].
   pure function constraints_supported_part(self, supports, motion) result(part)
      class(constraints_t), intent(in) :: self !! the constraints
      integer, intent(in) :: supports(:) !! numbers of the supports
      real(dp), intent(in) :: motion(:, :) !! the motion (components, n_nodes) [L]
      real(dp), allocatable :: part(:, :)
      real(dp), dimension(size(motion, 1)) :: along, work, share
      logical :: acts(size(motion, 1))
      integer :: axis, node

      allocate (part(size(motion, 1), size(motion, 2)), source=0.0_dp)
      do node = 1, size(motion, 2)
         acts = [(any(supports == self%holder(axis, node)), axis=1, size(acts))]
         if (.not. any(acts)) cycle
         along = matmul(motion(:, node), self%frame(:, :, node))
         work = merge(along + matmul(along, self%skew(:, :, node)), 0.0_dp, acts)
         ! Directions have parts along axes held before: each round settles one more of these.
         share = work
         do axis = 2, size(share)
            share = work - matmul(share, self%skew(:, :, node))
         end do
         part(:, node) = matmul(self%frame(:, :, node), share)
      end do
   end function constraints_supported_part

   !> The frames of a surface with given normals at some nodes. Where a support leaves a solid one tangent to slip
   !> along, it is the first (n_components, n_components, nodes) [-].
   pure function constraints_contact_frames(self, nodes, normals) result(frames)
      class(constraints_t), intent(in) :: self !! the constraints
      integer, intent(in) :: nodes(:) !! the nodes
      real(dp), intent(in) :: normals(:, :) !! unit normals of the surface there (n_dim, nodes) [-]
      real(dp) :: frames(size(self%is_free, 1), size(self%is_free, 1), size(nodes)), along(3)
      integer :: held, i

      frames = new_frames(normals, size(frames, 1))
      if (size(normals, 1) == 2) return
      do i = 1, size(nodes)
         associate (is_free => self%is_free(:, nodes(i)), normal => normals(:, i))
            if (count(is_free) /= 2) cycle
            held = findloc(is_free, .false., dim=1)
            along = vector_product(self%frame(:, held, nodes(i)), normal)
            ! Held along the normal, the node is no contact point.
            if (.not. norm2(along) > negligible) cycle
            frames(:, 2, i) = along/norm2(along)
            frames(:, 3, i) = vector_product(normal, frames(:, 2, i))
         end associate
      end do
   end function constraints_contact_frames

   !> Along which tangents of a surface supports bear the shear at nodes, alone or with their rigid sets: along all but
   !> as many of the first as they leave directions free besides one, which is for the normal; and around the axis if
   !> they hold it (n_components - 1, nodes).
   pure function constraints_fixed_tangents(self, nodes, frames) result(is_fixed)
      class(constraints_t), intent(in) :: self !! the constraints
      integer, intent(in) :: nodes(:) !! the nodes
      real(dp), intent(in) :: frames(:, :, :)
         !! normal and tangents at each as columns (n_components, n_components, nodes) [-]
      logical :: is_fixed(size(frames, 2) - 1, size(nodes))
      integer :: i, k

      do i = 1, size(nodes)
         do k = 1, size(is_fixed, 1)
            associate (n_dim => size(self%place, 1), is_free => self%is_free(:, nodes(i)))
               is_fixed(k, i) = merge(count(is_free(:n_dim)) <= k, .not. is_free(k + 1), k < n_dim) &
                  .and. .not. self%rigid_moves(nodes(i), frames(:, k + 1, i))
            end associate
         end do
      end do
   end function constraints_fixed_tangents

   !> Whether the supports leave a node free in some direction that is not perpendicular to a given one, alone or with
   !> its rigid set.
   pure logical function constraints_leaves_free(self, node, direction) result(is_free)
      class(constraints_t), intent(in) :: self !! the constraints
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: direction(:) !! unit vector (n_dim) [-]

      associate (n => size(direction))
         is_free = any(self%is_free(:n, node) .and. abs(matmul(direction, self%frame(:n, :n, node))) > negligible)
      end associate
      if (self%rigid_of(node) > 0) is_free = self%rigid_moves(node, direction)
   end function constraints_leaves_free

   !> The projector on the directions in which supports leave a node free (components, components) [-].
   pure function constraints_free_projector(self, node) result(projector)
      class(constraints_t), intent(in) :: self !! the constraints
      integer, intent(in) :: node !! the node
      real(dp), dimension(size(self%is_free, 1), size(self%is_free, 1)) :: projector
      integer :: axis

      projector = 0.0_dp
      do axis = 1, size(projector, 1)
         associate (along => self%frame(:, axis, node))
            if (self%is_free(axis, node)) projector = projector &
               + spread(along, 2, size(along))*spread(along, 1, size(along))
         end associate
      end do
   end function constraints_free_projector

   !> The unit vector along which a node is held that is free across it [-].
   pure function constraints_held_direction(self, node) result(direction)
      class(constraints_t), intent(in) :: self !! the constraints
      integer, intent(in) :: node !! the node
      real(dp) :: direction(2)

      direction = self%frame(:2, merge(1, 2, self%is_free(2, node)), node)
   end function constraints_held_direction

   !> Whether the body is twisted: displacements have a component around the axis besides those along the coordinates.
   pure logical function constraints_is_twisted(self) result(is_twisted)
      class(constraints_t), intent(in) :: self !! the constraints

      is_twisted = size(self%is_free, 1) > size(self%place, 1)
   end function constraints_is_twisted

   !> Whether the frame of a node has other axes than those of the coordinates.
   pure logical function constraints_is_turned(self, node) result(is_turned)
      class(constraints_t), intent(in) :: self !! the constraints
      integer, intent(in) :: node !! the node

      is_turned = any(abs(self%frame(2:, 1, node)) > 0.0_dp) .or. any(abs(self%frame(3:, 2, node)) > 0.0_dp)
   end function constraints_is_turned

   !> Makes the springs of elastic foundations, the integral of N_i N_j (k_n n n^T + k_t (1 - n n^T)) over each face.
   pure subroutine new_foundation(springs, mesh, materials, supports, error)
      type(spring_side_t), allocatable, intent(out) :: springs(:) !! the springs, face by face
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(support_t), intent(in) :: supports(:) !! the supports, with their spring moduli
      type(error_t), allocatable, intent(out) :: error !! a support names a set that the mesh has not
      type(face_t), allocatable :: faces(:)
      type(spring_side_t), allocatable :: more(:)
      real(dp) :: normal(materials%n_components()), modulus(size(normal), size(normal))
      integer :: i, j, k, l, point

      allocate (springs(0))
      do i = 1, size(supports)
         if (.not. any(supports(i)%spring > 0.0_dp)) cycle
         call set_faces(faces, mesh, supports(i)%set, error, materials)
         if (allocated(error)) error%message = supports(i)%origin//error%message
         if (allocated(error)) return
         allocate (more(size(faces)))
         do k = 1, size(more)
            associate (spring => more(k), face => faces(k), along_normal => supports(i)%spring(1), &
               across => supports(i)%spring(2))
               spring%support = i
               spring%number = face%number
               spring%node = face%node(:face%n_nodes)
               allocate (spring%stiffness(size(normal), face%n_nodes, size(normal), face%n_nodes), source=0.0_dp)
               do point = 1, size(face%area)
                  normal = 0.0_dp
                  normal(:size(face%outward, 1)) = face%outward(:, point)/face%length(point)
                  do j = 1, size(normal)
                     modulus(:, j) = face%area(point)*(along_normal - across)*normal*normal(j)
                     modulus(j, j) = modulus(j, j) + face%area(point)*across
                  end do
                  do j = 1, face%n_nodes
                     do l = 1, face%n_nodes
                        spring%stiffness(:, l, :, j) = spring%stiffness(:, l, :, j) &
                           + face%values(l, point)*face%values(j, point)*modulus
                     end do
                  end do
               end do
            end associate
         end do
         springs = [springs, more]
         deallocate (more)
      end do
   end subroutine new_foundation

   !> Numbers the free components node by node; the given nodes come last, in the order given.
   pure subroutine new_dof_map(dof_map, constraints, last_nodes, substitution)
      type(dof_map_t), intent(out) :: dof_map !! the numbers
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: last_nodes(:) !! nodes whose unknowns come last
      type(substitution_t), intent(in), optional :: substitution
         !! nodes whose displacements are no unknowns; all are without it
      logical :: is_last(size(constraints%is_free, 2)), is_free(size(constraints%is_free, 1), &
         size(constraints%is_free, 2))
      integer, allocatable :: order(:)
      integer :: axis, i, node

      is_free = constraints%is_free
      if (present(substitution)) then
         dof_map%substitution = substitution
         if (allocated(substitution%is_bonded)) is_free = is_free .and. .not. substitution%is_bonded
      end if
      is_last = .false.
      is_last(last_nodes) = .true.
      allocate (dof_map%dof(size(is_free, 1), size(is_last)), source=0)
      order = [pack([(node, node=1, size(is_last))], .not. is_last), last_nodes]
      do i = 1, size(order)
         do axis = 1, size(is_free, 1)
            if (.not. is_free(axis, order(i))) cycle
            dof_map%n_dofs = dof_map%n_dofs + 1
            dof_map%dof(axis, order(i)) = dof_map%n_dofs
         end do
      end do
      dof_map%n_schur = count(is_free(:, last_nodes))
   end subroutine new_dof_map

   !> Whether the displacement of any of some nodes is substituted.
   pure logical function substitution_is_substituted(self, nodes) result(is_substituted)
      class(substitution_t), intent(in) :: self !! the substitution
      integer, intent(in) :: nodes(:) !! the nodes
      integer :: i

      is_substituted = .false.
      if (.not. allocated(self%start)) return
      do i = 1, size(nodes)
         is_substituted = is_substituted .or. self%start(nodes(i) + 1) > self%start(nodes(i))
      end do
   end function substitution_is_substituted

   !> P y: the displacements of all nodes.
   pure function substitution_displacement(self, own) result(displacement)
      class(substitution_t), intent(in) :: self !! the substitution
      real(dp), intent(in) :: own(:, :) !! y, the nodes' own unknowns (components, n_nodes) [L]
      real(dp), allocatable :: displacement(:, :)
      integer :: node, i

      displacement = own
      if (.not. allocated(self%start)) return
      do node = 1, size(own, 2)
         if (self%start(node) == self%start(node + 1)) cycle
         displacement(:, node) = 0.0_dp
         do i = self%start(node), self%start(node + 1) - 1
            displacement(:, node) = displacement(:, node) + matmul(self%block(:, :, i), own(:, self%node(i)))
         end do
      end do
   end function substitution_displacement

   !> P^T f: nodal forces on the nodes' own unknowns.
   pure function substitution_forces(self, forces) result(own)
      class(substitution_t), intent(in) :: self !! the substitution
      real(dp), intent(in) :: forces(:, :) !! f, nodal forces (components, n_nodes) [F]
      real(dp), allocatable :: own(:, :)
      integer :: node, i

      own = forces
      if (.not. allocated(self%start)) return
      do node = 1, size(own, 2)
         if (self%start(node) < self%start(node + 1)) own(:, node) = 0.0_dp
      end do
      do node = 1, size(own, 2)
         do i = self%start(node), self%start(node + 1) - 1
            own(:, self%node(i)) = own(:, self%node(i)) + matmul(forces(:, node), self%block(:, :, i))
         end do
      end do
   end function substitution_forces

   !> The nodes whose own unknowns the displacements of some nodes depend on, each once.
   pure function substitution_element_nodes(self, nodes) result(own_nodes)
      class(substitution_t), intent(in) :: self !! the substitution
      integer, intent(in) :: nodes(:) !! the nodes
      integer, allocatable :: own_nodes(:)
      integer :: i, k

      allocate (own_nodes(0))
      do i = 1, size(nodes)
         if (.not. self%is_substituted(nodes(i:i))) then
            if (all(own_nodes /= nodes(i))) own_nodes = [own_nodes, nodes(i)]
            cycle
         end if
         do k = self%start(nodes(i)), self%start(nodes(i) + 1) - 1
            if (all(own_nodes /= self%node(k))) own_nodes = [own_nodes, self%node(k)]
         end do
      end do
   end function substitution_element_nodes

   !> The nodes whose own unknowns the displacements of each element depend on.
   pure subroutine substitution_own_nodes_of_elements(self, start, node, own_start, own_node)
      class(substitution_t), intent(in) :: self !! the substitution
      integer, intent(in) :: start(:) !! where the nodes of each element begin (n_elements + 1)
      integer, intent(in) :: node(:) !! the nodes of the elements
      integer, allocatable, intent(out) :: own_start(:) !! where those of each element begin (n_elements + 1)
      integer, allocatable, intent(out) :: own_node(:) !! the nodes whose own unknowns take part
      integer, allocatable :: own(:)
      integer :: element, turn

      if (.not. allocated(self%start)) then
         own_start = start
         own_node = node
         return
      end if
      allocate (own_start(size(start)))
      ! Counted first, then listed.
      do turn = 1, 2
         own_start(1) = 1
         do element = 1, size(start) - 1
            own = node(start(element):start(element + 1) - 1)
            if (self%is_substituted(own)) own = self%element_nodes(own)
            own_start(element + 1) = own_start(element) + size(own)
            if (turn == 2) own_node(own_start(element):own_start(element + 1) - 1) = own
         end do
         if (turn == 1) allocate (own_node(own_start(size(start)) - 1))
      end do
   end subroutine substitution_own_nodes_of_elements

   !> Copies the substitution of a part of a body, with the part's own node numbers.
   pure subroutine substitution_copy_part(self, body, nodes, number)
      class(substitution_t), intent(inout) :: self !! that of the part; nothing yet, nor later if it substitutes none
      type(substitution_t), intent(in) :: body !! that of the body
      integer, intent(in) :: nodes(:) !! nodes of the part whose displacements are of interest: its first ones
      integer, intent(in) :: number(:) !! number in the part of each node of the body
      integer, allocatable :: row(:)
      integer :: i, k

      if (.not. body%is_substituted(nodes)) return
      allocate (self%start(maxval(number) + 1))
      self%start(1) = 1
      do i = 1, size(nodes)
         self%start(i + 1) = self%start(i) + body%start(nodes(i) + 1) - body%start(nodes(i))
      end do
      self%start(size(nodes) + 2:) = self%start(size(nodes) + 1)
      row = [((k, k=body%start(nodes(i)), body%start(nodes(i) + 1) - 1), i=1, size(nodes))]
      self%node = number(body%node(row))
      self%block = body%block(:, :, row)
   end subroutine substitution_copy_part

   !> The rows of P of some nodes and components, with the columns of the nodes of `element_nodes` (components nodes,
   !> components own_nodes) [-].
   pure function substitution_transform(self, nodes, own_nodes, first, last) result(transform)
      class(substitution_t), intent(in) :: self !! the substitution
      integer, intent(in) :: nodes(:) !! the nodes
      integer, intent(in) :: own_nodes(:) !! the nodes whose own unknowns they are made of
      integer, intent(in) :: first !! the first of the components
      integer, intent(in) :: last !! the last of them
      real(dp), allocatable :: transform(:, :)
      integer :: i, k, j, n, axis

      n = last - first + 1
      allocate (transform(n*size(nodes), n*size(own_nodes)), source=0.0_dp)
      do i = 1, size(nodes)
         if (.not. self%is_substituted(nodes(i:i))) then
            j = findloc(own_nodes, nodes(i), dim=1)
            do axis = 0, n - 1
               transform(n*i - axis, n*j - axis) = 1.0_dp
            end do
            cycle
         end if
         do k = self%start(nodes(i)), self%start(nodes(i) + 1) - 1
            j = findloc(own_nodes, self%node(k), dim=1)
            associate (block => transform(n*(i - 1) + 1:n*i, n*(j - 1) + 1:n*j))
               block = block + self%block(first:last, first:last, k)
            end associate
         end do
      end do
   end function substitution_transform

end module amontons_constraints
