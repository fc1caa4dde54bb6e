!> Rigid motions of the pieces of a body, and those that its supports leave free.
module amontons_rigid_motion
   use amontons_cone, only: null_vectors
   use amontons_constraints, only: constraints_t, spring_side_t
   use amontons_dense, only: symmetric_eigenvectors, vector_product
   use amontons_element, only: n_corners
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t, number_pieces, side_element, side_place
   use amontons_rounding, only: first_largest, input_rounding
   use amontons_text, only: place_text, to_text
   implicit none (type, external)
   private

   public :: displacement_of_nodes, largest_motion, new_rigid_motions, orthonormal_modes, resting_motions, &
      rigid_motions_t

   !> The free rigid motions of a piece: combinations of the translations and the rotations about its middle (in a
   !> twisted body about the axis) and, where joints divide it into parts, of the motions of these parts relative to
   !> each other. A joint is a free jump, along which a part translates, or a hinge, about which it turns: a node of
   !> elements that share no side there. Hinges are looked for in the plane alone: elements of a solid hold together by
   !> what they share, and the factorization notices those that turn about a node or an edge.
   type :: rigid_motions_t
      integer :: n_free = 0 !! number of independent free motions, at most n_motions and one more for each joint
      integer :: n_motions = 3 !! number of translations and rotations: 3, in space 6
      real(dp), allocatable :: mode(:, :)
         !! translations, rotations and joints of each free motion (n_motions + joints, n_free)
      real(dp), allocatable :: center(:) !! the middle of the piece (n_dim) [L]
      real(dp) :: radius = 1.0_dp !! half the piece's diagonal, the length that scales rotations [L]
      integer, allocatable :: node(:) !! the nodes of the piece, ascending
      logical :: is_whole = .true. !! whether the piece is the whole body
      integer :: n_components = 2 !! number of components of a displacement
      integer :: n_joints = 0 !! number of joints
      integer :: n_jumps = 0 !! number of jumps, which come first among them
      real(dp), allocatable :: joint(:, :) !! direction of each jump [-], position of each hinge [L] (n_dim, n_joints)
      integer, allocatable :: part(:) !! the part that each node belongs to; not allocated without joints (n_nodes)
      real(dp), allocatable :: way(:, :, :)
         !! translations and rotations of each part per joint (n_motions, n_joints, parts) [-]
   contains
      procedure :: describe => rigid_motions_describe
      procedure :: displacement => rigid_motions_displacement
      procedure :: unit_motions => rigid_motions_unit_motions
   end type rigid_motions_t

contains

   !> Finds the rigid motions of each piece of a body that violate no support: the kernel of the Gram matrix of its held
   !> directions.
   subroutine new_rigid_motions(motions, mesh, outer, constraints, springs, is_axisymmetric, bonds, jumps)
      type(rigid_motions_t), allocatable, intent(out) :: motions(:) !! the free motions of each piece
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: outer(:) !! numbers of the element sides on its boundary
      type(constraints_t), intent(in) :: constraints !! the supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides; they hold what they resist
      logical, intent(in) :: is_axisymmetric
         !! whether only the translation along the axis (y) and, of a twisted body, the rotation about it are rigid ones
      integer, intent(in) :: bonds(:, :)
         !! pairs of nodes that hold together, too, and the free jump of the first one against the second, 0 for none
         !! (3, bonds)
      real(dp), intent(in) :: jumps(:, :) !! direction of each jump, a unit vector (n_dim, jumps) [-]
      ! Held directions are known to about 1e-6; a square of that is noise in the Gram matrix.
      real(dp), parameter :: negligible = 1.0e-12_dp
      type(mesh_t) :: parted
      integer, allocatable :: piece(:), part(:), start(:), node(:), links(:, :)
      real(dp), allocatable :: gram(:, :), values(:)
      logical, allocatable :: is_joint(:)
      integer :: info, k, n_parts, n_pieces, p

      ! Around an axis elements that share a node alone resist that the angle between them changes.
      call part_at_hinges(parted, links, mesh, outer(:merge(0, size(outer), is_axisymmetric .or. &
         size(mesh%coordinates, 1) == 3)), bonds, size(jumps, 2))
      call number_pieces(parted, piece, n_pieces, links(:2, :))
      call fill_bins(start, node, piece(:mesh%n_nodes), n_pieces)
      is_joint = links(3, :) > 0
      call number_pieces(parted, part, n_parts, reshape(pack(links(:2, :), spread(.not. is_joint, 1, 2)), &
         [2, count(.not. is_joint)]))
      ! A hinge within a part turns nothing.
      is_joint = is_joint .and. .not. (links(3, :) > size(jumps, 2) .and. part(links(1, :)) == part(links(2, :)))
      links = reshape(pack(links, spread(is_joint, 1, 3)), [3, count(is_joint)])
      allocate (motions(n_pieces))
      do p = 1, n_pieces
         motions(p)%node = node(start(p):start(p + 1) - 1)
         motions(p)%is_whole = n_pieces == 1
         motions(p)%n_components = size(constraints%is_free, 1)
         associate (lowest => minval(mesh%coordinates(:, motions(p)%node), dim=2), &
            highest => maxval(mesh%coordinates(:, motions(p)%node), dim=2))
            motions(p)%center = 0.5_dp*(lowest + highest)
            motions(p)%n_motions = merge(6, 3, size(lowest) == 3)
            motions(p)%radius = 0.5_dp*norm2(highest - lowest)
         end associate
         is_joint = piece(links(1, :)) == p
         call divide_piece(motions(p), gram, part, mesh%coordinates, reshape(pack(links, spread(is_joint, 1, 3)), &
            [3, count(is_joint)]), jumps)
         call add_held_directions(gram, motions(p), piece(:mesh%n_nodes) == p, mesh%coordinates, constraints, springs)
         if (is_axisymmetric) then
            gram(1, 1) = gram(1, 1) + real(size(motions(p)%node), dp)
            if (motions(p)%n_components == 2) gram(3, 3) = gram(3, 3) + real(size(motions(p)%node), dp)
            do k = 1, motions(p)%n_joints
               gram(3 + k, 3 + k) = gram(3 + k, 3 + k) + motions(p)%joint(1, k)**2*real(size(motions(p)%node), dp)
            end do
         end if
         values = [(0.0_dp, k=1, size(gram, 1))]
         call symmetric_eigenvectors(gram, values, info)
         motions(p)%n_free = count(values <= negligible*max(values(size(values)), tiny(values)))
         motions(p)%mode = gram(:, :motions(p)%n_free)
      end do
   end subroutine new_rigid_motions

   !> Adds the directions in which supports and springs hold a piece to their Gram matrix.
   pure subroutine add_held_directions(gram, motions, is_here, coordinates, constraints, springs)
      real(dp), intent(inout) :: gram(:, :) !! Gram matrix of the directions held (motions, motions)
      type(rigid_motions_t), intent(in) :: motions !! the piece
      logical, intent(in) :: is_here(:) !! whether each node belongs to it (n_nodes)
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      type(constraints_t), intent(in) :: constraints !! the supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides; they hold what they resist
      real(dp), allocatable :: row(:), motion(:, :), unit(:, :)
      real(dp) :: largest
      integer :: axis, i, k, n

      n = size(gram, 1)
      do i = 1, size(motions%node)
         associate (node => motions%node(i))
            if (constraints%rigid_of(node) > 0 .or. all(constraints%is_free(:, node))) cycle
            do axis = 1, motions%n_components
               if (constraints%is_free(axis, node)) cycle
               unit = motions%unit_motions(coordinates(:, node), node)
               row = matmul(constraints%frame(:, axis, node), unit)
               do k = 1, n
                  gram(:, k) = gram(:, k) + row*row(k)
               end do
            end do
         end associate
      end do
      do i = 1, size(constraints%rigid)
         associate (rigid => constraints%rigid(i))
            if (.not. is_here(rigid%node(1))) cycle
            if (allocated(motion)) deallocate (motion)
            allocate (motion(motions%n_motions, n), source=0.0_dp)
            unit = motions%unit_motions(rigid%point, rigid%node(1))
            k = size(rigid%point)
            motion(:k, :) = unit(:k, :)
            do k = k + 1, motions%n_motions
               motion(k, k) = rigid%length/motions%radius
            end do
            if (n > 3 .and. motions%n_motions == 3) motion(3, 4:) = motion(3, 3) &
               *motions%way(3, :, motions%part(rigid%node(1)))
            do axis = 1, motions%n_motions
               if (constraints%is_free(rigid%axis(axis), rigid%lead(axis))) cycle
               gram = gram + spread(motion(axis, :), 1, n)*spread(motion(axis, :), 2, n)
            end do
         end associate
      end do
      ! The directions that springs resist, whatever their stiffness.
      do i = 1, size(springs)
         associate (spring => springs(i))
            if (.not. is_here(spring%node(1))) cycle
            largest = maxval(abs(spring%stiffness))
            if (.not. largest > 0.0_dp) cycle
            if (allocated(motion)) deallocate (motion)
            allocate (motion(motions%n_components*size(spring%node), n))
            do k = 1, size(spring%node)
               motion(motions%n_components*(k - 1) + 1:motions%n_components*k, :) = motions%unit_motions( &
                  coordinates(:, spring%node(k)), spring%node(k))
            end do
            gram = gram + matmul(transpose(motion), matmul(reshape(spring%stiffness/largest, &
               [size(motion, 1), size(motion, 1)]), motion))
         end associate
      end do
   end subroutine add_held_directions

   !> Gives each element a node of its own where elements meet that share no side at a node: one that is linked firmly
   !> to those of the elements that share a side with it there, and by a hinge to the node.
   subroutine part_at_hinges(parted, links, mesh, outer, bonds, n_jumps)
      type(mesh_t), intent(out) :: parted !! the elements on these nodes, which have no coordinates
      integer, allocatable, intent(out) :: links(:, :)
         !! the bonds, and links of the further nodes: two nodes, and the number of the joint or 0 (3, links)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: outer(:) !! numbers of the element sides on its boundary
      integer, intent(in) :: bonds(:, :) !! pairs of nodes that hold together, and number of the jump (3, bonds)
      integer, intent(in) :: n_jumps !! number of jumps
      integer, allocatable :: before(:), beside(:, :)
      integer :: n_begun(mesh%n_nodes), last(mesh%n_nodes), side(3), element, first, i, k, n
      logical :: is_bonded(mesh%n_nodes)

      parted%n_nodes = mesh%n_nodes
      parted%n_elements = mesh%n_elements
      parted%node_start = mesh%node_start
      parted%node = mesh%node
      links = bonds
      ! As many sides of the boundary begin at a node as groups of elements share sides there.
      n_begun = 0
      do i = 1, size(outer)
         side = mesh%side(side_element(outer(i)), side_place(outer(i)))
         n_begun(side(1)) = n_begun(side(1)) + 1
      end do
      if (all(n_begun < 2)) return
      is_bonded = .false.
      is_bonded(bonds(1, :)) = .true.
      is_bonded(bonds(2, :)) = .true.
      allocate (before(0), beside(2, 0))
      last = 0
      do element = 1, mesh%n_elements
         first = mesh%node_start(element)
         n = n_corners(mesh%element_kind(element))
         do i = 0, n - 1
            associate (node => mesh%node(first + i))
               if (n_begun(node) < 2) cycle
               parted%n_nodes = parted%n_nodes + 1
               parted%node(first + i) = parted%n_nodes
               k = size(before) + 1
               before = [before, last(node)]
               beside = reshape([beside, mesh%node(first + modulo([i - 1, i + 1], n))], [2, k])
               call add(node, merge(n_jumps + k, 0, last(node) > 0 .or. is_bonded(node)))
               last(node) = k
               k = before(k)
               do while (k > 0)
                  if (any(beside(:, k) == beside(:, last(node)) .or. beside(:, k) == beside([2, 1], last(node)))) then
                     call add(mesh%n_nodes + k, 0)
                  end if
                  k = before(k)
               end do
            end associate
         end do
      end do

   contains

      !> Links the last node.
      subroutine add(node, joint)
         integer, intent(in) :: node !! another node
         integer, intent(in) :: joint !! number of the hinge, 0 for a firm link

         links = reshape([links, node, parted%n_nodes, joint], [3, size(links, 2) + 1])
      end subroutine add

   end subroutine part_at_hinges

   !> Finds the joints of a piece and how its parts move in them, and holds in the Gram matrix what they do not allow.
   !> Where the two sides of a jump are joined in another way, it cannot move; where those of a hinge are joined by
   !> others, the parts turn together in these, or not at all.
   subroutine divide_piece(motions, gram, part, coordinates, links, jumps)
      type(rigid_motions_t), intent(inout) :: motions !! the piece; gains the parts
      real(dp), allocatable, intent(out) :: gram(:, :) !! Gram matrix of the directions held (motions, motions)
      integer, intent(in) :: part(:) !! the part that each node belongs to
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      integer, intent(in) :: links(:, :) !! pairs of nodes of the piece, and number of the joint between them (3, links)
      real(dp), intent(in) :: jumps(:, :) !! direction of each jump (n_dim, jumps) [-]
      integer, allocatable :: number(:)
      logical, allocatable :: is_known(:), is_used(:)
      real(dp), allocatable :: way(:, :)
      real(dp) :: motion(motions%n_motions)
      logical :: is_changed
      integer :: i, k, n, side(2)

      allocate (number(0))
      do i = 1, size(links, 2)
         if (all(number /= links(3, i))) number = [number, links(3, i)]
      end do
      motions%n_joints = size(number)
      motions%n_jumps = count(number <= size(jumps, 2))
      n = motions%n_motions
      allocate (gram(n + size(number), n + size(number)), source=0.0_dp)
      if (size(number) == 0) return
      motions%part = part(:size(coordinates, 2))
      allocate (motions%joint(size(jumps, 1), size(number)), motions%way(n, size(number), maxval(part)), source=0.0_dp)
      allocate (is_known(maxval(part)), is_used(size(number)), source=.false.)
      is_known(part(motions%node(1))) = .true.
      is_used(:motions%n_jumps) = .true.
      is_changed = .true.
      do while (is_changed)
         is_changed = .false.
         do i = 1, size(links, 2)
            side = part(links(:2, i))
            if (is_known(side(1)) .eqv. is_known(side(2))) cycle
            is_changed = .true.
            is_used(number_of(i)) = .true.
            k = merge(1, 2, is_known(side(2)))
            motions%way(:, :, side(k)) = motions%way(:, :, side(3 - k))
            motions%way(:, number_of(i), side(k)) = motions%way(:, number_of(i), side(k)) &
               + merge(1, -1, k == 1)*motion_of(i)
            is_known(side(k)) = .true.
         end do
      end do
      do i = 1, size(links, 2)
         k = number_of(i)
         way = motions%way(:, :, part(links(1, i))) - motions%way(:, :, part(links(2, i)))
         motion = motion_of(i)
         if (k <= motions%n_jumps) then
            motions%joint(:, k) = motion(:size(jumps, 1))
            way(:, k) = way(:, k) - motion
         else
            ! The displacement at the hinge, whatever the rotation.
            motions%joint(:, k) = coordinates(:, links(1, i))
            way = way - spread(motion, 2, size(way, 2))*spread(way(3, :), 1, n)
         end if
         gram(n + 1:, n + 1:) = gram(n + 1:, n + 1:) + matmul(transpose(way), way)
      end do
      do k = 1, size(number)
         if (.not. is_used(k)) gram(n + k, n + k) = 1.0_dp
      end do

   contains

      !> The joint of a link among those of the piece.
      pure integer function number_of(link)
         integer, intent(in) :: link !! number of the link

         number_of = findloc(number, links(3, link), dim=1)
      end function number_of

      !> The relative motion that a joint allows: along the jump, or a rotation about the hinge (n_motions) [-].
      pure function motion_of(link)
         integer, intent(in) :: link !! number of the link
         real(dp) :: motion_of(motions%n_motions)

         if (links(3, link) <= size(jumps, 2)) then
            motion_of = 0.0_dp
            motion_of(:size(jumps, 1)) = jumps(:, links(3, link))
         else
            associate (arm => (coordinates(:, links(1, link)) - motions%center)/motions%radius)
               motion_of = [arm(2), -arm(1), 1.0_dp]
            end associate
         end if
      end function motion_of

   end subroutine divide_piece

   !> Displacement of a point under the translations, the rotations and the joints (components, n_motions + joints) [-].
   pure function rigid_motions_unit_motions(self, point, node) result(displacement)
      class(rigid_motions_t), intent(in) :: self !! center, radius and parts
      real(dp), intent(in) :: point(:) !! coordinates (n_dim) [L]
      integer, intent(in) :: node !! the node that moves with it
      real(dp) :: displacement(self%n_components, self%n_motions + self%n_joints)
      integer :: k

      displacement = 0.0_dp
      do k = 1, size(point)
         displacement(k, k) = 1.0_dp
      end do
      if (size(point) == 3) then
         do k = 1, 3
            displacement(:, 3 + k) = vector_product(displacement(:, k), point - self%center)/self%radius
         end do
      else if (self%n_components == 2) then
         displacement(:, 3) = [-(point(2) - self%center(2)), point(1) - self%center(1)]/self%radius
      else
         displacement(3, 3) = point(1)/self%radius
      end if
      do k = 1, self%n_joints
         associate (way => self%way(:, k, self%part(node)))
            associate (n => self%n_motions + k)
               displacement(:size(point), n) = way(:size(point))
               if (self%n_components == 2) displacement(:, n) = displacement(:, n) + way(3)*displacement(:, 3)
            end associate
         end associate
      end do
   end function rigid_motions_unit_motions

   !> Displacement of a point under each free motion (components, n_free) [-].
   pure function rigid_motions_displacement(self, point, node) result(displacement)
      class(rigid_motions_t), intent(in) :: self !! the free motions
      real(dp), intent(in) :: point(:) !! coordinates (n_dim) [L]
      integer, intent(in) :: node !! the node that moves with it
      real(dp) :: displacement(self%n_components, self%n_free)

      displacement = matmul(self%unit_motions(point, node), self%mode)
   end function rigid_motions_displacement

   !> The displacements of all nodes under a combination of the free motions of all pieces (components, n_nodes) [L].
   pure function displacement_of_nodes(motions, coordinates, amounts) result(displacement)
      type(rigid_motions_t), intent(in) :: motions(:) !! the motions of each piece
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (n_dim, n_nodes) [L]
      real(dp), intent(in) :: amounts(:) !! amount of each, piece after piece (n_free of all) [L]
      real(dp), allocatable :: displacement(:, :)
      integer :: first, i, k

      allocate (displacement(motions(1)%n_components, size(coordinates, 2)), source=0.0_dp)
      first = 0
      do k = 1, size(motions)
         if (motions(k)%n_free == 0) cycle
         associate (node => motions(k)%node, own => amounts(first + 1:first + motions(k)%n_free))
            first = first + motions(k)%n_free
            if (.not. any(abs(own) > 0.0_dp)) cycle
            do i = 1, size(node)
               displacement(:, node(i)) = matmul(motions(k)%displacement(coordinates(:, node(i)), node(i)), own)
            end do
         end associate
      end do
   end function displacement_of_nodes

   !> An orthonormal basis of the displacements of points under the motions of a piece (rows, any) [-].
   pure function orthonormal_modes(modes) result(basis)
      real(dp), intent(in) :: modes(:, :) !! the displacements under each motion (rows, motions) [-]
      real(dp), allocatable :: basis(:, :)
      real(dp) :: own(size(modes, 1)), length
      integer :: k, turn

      allocate (basis(size(modes, 1), 0))
      do k = 1, size(modes, 2)
         own = modes(:, k)
         length = norm2(own)
         ! The first time leaves rounding errors of the components along the others.
         do turn = 1, 2
            own = own - matmul(basis, matmul(own, basis))
         end do
         if (norm2(own) <= input_rounding*max(1.0_dp, length)) cycle
         basis = reshape([basis, own/norm2(own)], [size(own), size(basis, 2) + 1])
      end do
   end function orthonormal_modes

   !> The combinations of motions that leave all points at rest (motions, any) [-].
   pure function resting_motions(modes) result(motions)
      real(dp), intent(in) :: modes(:, :) !! displacements of the points under each motion (rows, motions) [-]
      real(dp), allocatable :: motions(:, :)
      integer :: i

      motions = null_vectors(modes, input_rounding*[(max(1.0_dp, norm2(modes(:, i))), i=1, size(modes, 2))])
   end function resting_motions

   !> Text describing a combination of the free motions of some pieces by that of the piece that moves most; of amounts
   !> that differ by rounding only, the first counts.
   pure function largest_motion(motions, amounts) result(text)
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions of each piece
      real(dp), intent(in) :: amounts(:) !! amount of each, piece after piece (n_free of all)
      character(:), allocatable :: text
      real(dp) :: amount(size(motions))
      integer :: first(size(motions) + 1), i

      first(1) = 1
      do i = 1, size(motions)
         first(i + 1) = first(i) + motions(i)%n_free
         amount(i) = norm2(amounts(first(i):first(i + 1) - 1))
      end do
      i = max(1, first_largest(amount))
      text = motions(i)%describe(amounts(first(i):first(i + 1) - 1))
   end function largest_motion

   !> Text describing a combination of the free motions, with the position of the piece if the body has several.
   pure function rigid_motions_describe(self, amounts) result(text)
      class(rigid_motions_t), intent(in) :: self !! the free motions
      real(dp), intent(in) :: amounts(:) !! amount of each free motion (n_free)
      character(:), allocatable :: text
      real(dp), allocatable :: motion(:)
      integer :: k
      logical, allocatable :: is_shown(:)

      motion = matmul(self%mode, amounts)
      motion = motion/maxval(abs(motion))
      ! By more than the last of four digits.
      is_shown = abs(nint(1.0e4_dp*motion)) > 1
      text = 'the body'
      if (.not. self%is_whole) text = 'the piece around '//place_text(self%center)
      if (any(is_shown(self%n_motions + self%n_jumps + 1:))) then
         k = maxloc(abs(motion(4 + self%n_jumps:)), dim=1) + self%n_jumps
         text = 'a part of '//text//' is free to turn about the node at '//place_text(self%joint(:, k))// &
            ', which alone joins it to another part'
         return
      end if
      text = text//' is free to'
      if (self%n_motions == 6) then
         if (any(is_shown(:3))) text = text//' translate along '//direction_text(motion(:3))
         if (all([any(is_shown(:3)), any(is_shown(4:6))])) text = text//' and'
         if (any(is_shown(4:6))) text = text//' rotate about '//direction_text(motion(4:6))
      else
         if (any(is_shown(:2))) text = text//' translate along ('//short(motion(1))//', '//short(motion(2))//')'
         if (is_shown(3) .and. any(is_shown(:2))) text = text//' and'
         if (is_shown(3) .and. self%n_components > 2) then
            text = text//' rotate about the axis'
         else if (is_shown(3)) then
            text = text//' rotate '//trim(merge('counter-clockwise', 'clockwise        ', motion(3) > 0.0_dp))
         end if
      end if
      if (any(is_shown(self%n_motions + 1:))) then
         if (any(is_shown(:self%n_motions))) text = text//' and'
         text = text//' move along the preload on one side of it'
      end if
   end function rigid_motions_describe

   !> A direction in space: the name of its axis or, where it has none, three components.
   pure function direction_text(direction) result(text)
      real(dp), intent(in) :: direction(3) !! the direction, of any length
      character(:), allocatable :: text
      character(3), parameter :: axes = 'xyz'
      real(dp) :: scaled(3)
      integer :: k, largest

      largest = maxloc(abs(direction), dim=1)
      scaled = direction/abs(direction(largest))
      if (count(abs(nint(1.0e4_dp*scaled)) > 1) == 1) then
         text = axes(largest:largest)
      else
         text = '('//short(scaled(1))
         do k = 2, 3
            text = text//', '//short(scaled(k))
         end do
         text = text//')'
      end if
   end function direction_text

   !> A number rounded to four decimals, for reading.
   pure function short(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_text(real(nint(1.0e4_dp*value), dp)/1.0e4_dp)
   end function short

end module amontons_rigid_motion
