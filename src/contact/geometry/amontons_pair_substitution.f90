!> The displacements of slaves in terms of those of the masters, by which the relative displacements w of pairs become
!> unknowns, and are 0 between bonded surfaces; and the pairs of bonded surfaces.
!>
!> With dual functions the row of a slave's corner p contains no other corner that is a point, `w_p = c_p u_p + sum c_q
!> u_q`, so that it can be solved for u_p; or, beside an end of the master within a side, one whose row does not contain
!> p. On a quadratic side this holds in hierarchical unknowns, in which that of a middle node is its deviation from the
!> mean of the corners.
module amontons_pair_substitution
   use amontons_boundary, only: new_patch, patch_t
   use amontons_constraints, only: constraints_t, substitution_t
   use amontons_contact_rows, only: contact_rows_t
   use amontons_contact_set, only: contact_t, pairing_t, tie_t
   use amontons_dense, only: small_inverse
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_frame, only: new_frame
   use amontons_kinds, only: dp
   use amontons_mortar_pair, only: integrate_pair, mortar_pair_t, mortar_points_t, new_mortar_pair, &
      take_facing_sides
   use amontons_pair_checks, only: check_ends
   use amontons_rounding, only: input_rounding, sum_rounding
   use amontons_surface, only: meshed_body_t
   use amontons_taken, only: taken_t
   use amontons_text, only: place_text
   implicit none (type, external)
   private

   public :: bonds_of, join_corners, new_pair_substitution, new_tied_pairs

   !> The displacement of a node as a sum of unknowns of nodes and displacements of nodes, each times a block.
   type :: sum_t
      integer, allocatable :: node(:) !! the nodes
      real(dp), allocatable :: block(:, :, :)
         !! factors of the nodes' displacements or unknowns (components, components, nodes) [-]
      logical, allocatable :: is_own(:) !! whether the own unknowns of the node are meant; else its displacement
      integer :: visit = 0 !! 0: not looked at, 1: being resolved, 2: all are own unknowns
      integer :: line = 0 !! the first node of the slave's line; 0 for nodes that are no corners of a slave
   contains
      procedure :: add => sum_add
   end type sum_t

contains

   !> Makes the substitution of all ties and pairs whose points are corners, ties first, and of rigid sets.
   subroutine new_pair_substitution(substitution, ties, pairs, rows, frame, constraints, coordinates, error)
      type(substitution_t), intent(out) :: substitution !! the substitution
      type(mortar_pair_t), intent(in) :: ties(:) !! the pairs that are bonded, so that w = 0
      type(mortar_pair_t), intent(in) :: pairs(:) !! the others
      type(contact_rows_t), intent(in) :: rows !! rows of the points on rigid obstacles that are means over nodes
      real(dp), intent(in) :: frame(:, :, :) !! their normals and tangents (n_components, n_components, any) [-]
      type(constraints_t), intent(in) :: constraints !! the supports
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes, for messages (n_dim, n_nodes) [L]
      type(error_t), allocatable, intent(out) :: error
         !! a middle node is held otherwise than the corners beside it, or pairs make a ring
      type(sum_t), allocatable :: sums(:)
      type(mortar_pair_t) :: means
      integer :: i, k, fault, node, n
      integer, allocatable :: no_ends(:, :)

      n = size(constraints%is_free, 1)
      allocate (sums(size(coordinates, 2)))
      allocate (substitution%is_bonded(n, size(sums)), source=.false.)
      fault = 0
      do i = 1, size(ties)
         substitution%is_bonded(:, ties(i)%node) = .true.
         if (ties(i)%is_jump_free) then
            associate (own => constraints%frame(:, :, ties(i)%lead))
               substitution%is_bonded(:, ties(i)%lead) = abs(matmul(ties(i)%jump(:n), own)) < 0.5_dp
            end associate
         end if
         call add_pair(sums, ties(i), .true., constraints, fault)
      end do
      do i = 1, size(pairs)
         if (.not. allocated(pairs(i)%segments) .or. allocated(pairs(i)%cells)) cycle
         call add_pair(sums, pairs(i), .false., constraints, fault)
      end do
      means%node = rows%node(rows%start(:size(frame, 3)))
      means%frame = frame
      allocate (no_ends(2, size(sums)), source=0)
      do i = 1, size(means%node)
         call solve_row(sums(means%node(i)), rows, i, means, no_ends, .false., constraints)
         if (size(coordinates, 1) == 2) cycle
         associate (middle => means%node(i), ends => rows%node(rows%start(i) + 1:rows%start(i + 1) - 1))
            if (any([(holds_more(constraints, middle, ends(k)), k=1, size(ends))])) fault = middle
         end associate
      end do
      do i = 1, size(constraints%rigid)
         associate (rigid => constraints%rigid(i))
            do node = 1, size(rigid%node)
               sums(rigid%node(node)) = sum_t(rigid%carrier(:2), rigid%displacement(coordinates(:, rigid%node(node))), &
                  [.true., .true.])
            end do
         end associate
      end do
      if (fault > 0) then
         call new_error(error, input_refused, 'a support holds the middle node at '// &
            place_text(coordinates(:, fault))//' otherwise than the corners beside it: hold these, too')
         return
      end if
      do i = 1, size(sums)
         if (allocated(sums(i)%node) .and. fault == 0) call resolve(sums, i, fault)
      end do
      if (fault > 0) then
         call new_error(error, input_refused, 'the node at '//place_text(coordinates(:, fault))// &
            ' is slave and master in a ring of pairs: exchange set and against of one')
         return
      end if
      if (.not. any([(allocated(sums(i)%node), i=1, size(sums))])) return
      allocate (substitution%start(size(sums) + 1))
      substitution%start(1) = 1
      do i = 1, size(sums)
         if (.not. allocated(sums(i)%node)) allocate (sums(i)%node(0))
         substitution%start(i + 1) = substitution%start(i) + size(sums(i)%node)
      end do
      allocate (substitution%node(substitution%start(size(sums) + 1) - 1))
      allocate (substitution%block(n, n, size(substitution%node)))
      do i = 1, size(sums)
         associate (first => substitution%start(i), last => substitution%start(i + 1) - 1)
            if (last < first) cycle
            substitution%node(first:last) = sums(i)%node
            substitution%block(:, :, first:last) = sums(i)%block
         end associate
      end do
   end subroutine new_pair_substitution

   !> Whether supports hold a middle node in a direction in which a corner beside it is free.
   pure logical function holds_more(constraints, middle, corner)
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: middle !! the middle node
      integer, intent(in) :: corner !! the corner

      associate (free => constraints%free_projector(corner))
         holds_more = any(abs(matmul(constraints%free_projector(middle), free) - free) > input_rounding)
      end associate
   end function holds_more

   !> Adds the sums of the middle nodes beside points (own unknown plus the mean of the corners), and then those of the
   !> corners.
   subroutine add_pair(sums, pair, is_tied, constraints, fault)
      type(sum_t), intent(inout) :: sums(:) !! the sums so far (nodes)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      logical, intent(in) :: is_tied !! whether it is bonded
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(inout) :: fault !! a middle node that is held otherwise than the corners beside it, 0 for none
      real(dp), dimension(size(constraints%is_free, 1), size(constraints%is_free, 1)) :: half
      integer :: side, k, i, beside(2)
      type(mortar_points_t) :: points
      integer, allocatable :: ends(:, :)

      if (fault > 0) return
      allocate (ends(2, size(sums)), source=0)
      do side = 1, pair%slave%n_sides
         associate (n => pair%slave%n_corners(side))
            do i = n + 1, pair%slave%n_nodes(side)
               beside = 1 + modulo([i - n - 1, i - n], n)
               associate (middle => pair%slave%side(i, side), corner => pair%slave%side(beside, side))
                  if (all(pair%point_of(beside, side) == 0) .or. constraints%rigid_of(middle) > 0) cycle
                  ends(:, middle) = corner
                  half = 0.5_dp*constraints%free_projector(middle)
                  if (any([(pair%point_of(beside(k), side) > 0 .and. holds_more(constraints, middle, corner(k)), &
                     k=1, 2)])) fault = middle
                  if (allocated(sums(middle)%node)) cycle
                  call sums(middle)%add(middle, diagonal(spread(1.0_dp, 1, size(half, 1))), .true.)
                  call sums(middle)%add(corner(1), half, .false.)
                  call sums(middle)%add(corner(2), half, .false.)
               end associate
            end do
         end associate
      end do
      if (fault > 0) return
      call integrate_pair(points, pair, pair%segments, is_again=.false.)
      if (size(pair%slave%corner, 1) == 3) ends(:, pack(pair%node, constraints%rigid_of(pair%node) == 0)) = -1
      do i = 1, size(pair%node)
         if (constraints%rigid_of(pair%node(i)) > 0) cycle
         call solve_row(sums(pair%node(i)), points%rows, i, pair, ends, is_tied, constraints)
         sums(pair%node(i))%line = pair%patch%node(1)
      end do
   end subroutine add_pair

   !> Solves the row of a corner for the displacement of the corner.
   pure subroutine solve_row(corner, rows, p, pair, ends, is_tied, constraints)
      type(sum_t), intent(inout) :: corner !! its displacement
      type(contact_rows_t), intent(in) :: rows !! the rows of the points
      integer, intent(in) :: p !! number of the point
      type(mortar_pair_t), intent(in) :: pair !! the pair
      integer, intent(in) :: ends(:, :)
         !! the corners beside each middle node beside points, 0 for others and nodes of rigid sets, -1 for points in
         !! space, of which a row contains its own alone, and what supports prescribe of others (2, n_nodes)
      logical, intent(in) :: is_tied !! whether w = 0
      type(constraints_t), intent(in) :: constraints !! the supports
      type(sum_t) :: row
      real(dp), dimension(size(constraints%is_free, 1), size(constraints%is_free, 1)) :: along, free, half, share, push
      real(dp) :: own(size(constraints%is_free, 1))
      integer :: i, k, n, n_dim

      n = size(own)
      n_dim = size(constraints%place, 1)
      do i = rows%start(p), rows%start(p + 1) - 1
         associate (node => rows%node(i))
            ! Along the normal and the tangents.
            share = diagonal([(dot_product(rows%block(:, k, i), pair%frame(:, k, p)), k=1, n)])
            call row%add(node, share, ends(1, node) > 0)
            half = 0.5_dp*share
            ! In space all directions have the same share: it may be given along any axes.
            if (n_dim == 3) half = matmul(half, constraints%free_projector(node))
            do k = 1, 2
               if (ends(k, node) > 0) call row%add(ends(k, node), half, .false.)
            end do
         end associate
      end do
      free = constraints%free_projector(pair%node(p))
      own = 0.0_dp
      do i = 1, size(row%node)
         if (row%node(i) /= pair%node(p)) cycle
         own = [(row%block(k, k, i), k=1, n)]
         if (n_dim == 3) own = sum(free*row%block(:, :, i))/sum(free**2)
      end do
      along = along_guide(pair, p, is_tied, constraints)
      do i = 1, size(row%node)
         if (row%node(i) == pair%node(p) .or. maxval(abs(row%block(:, :, i))) <= sum_rounding) cycle
         if (n_dim == 2) then
            call corner%add(row%node(i), times_axes(along, pair%frame(:, :, p), -[(row%block(k, k, i), k=1, n)]/own), &
               row%is_own(i))
         else if (row%is_own(i) .or. ends(1, row%node(i)) == 0) then
            call corner%add(row%node(i), matmul(along, -row%block(:, :, i)/own(1)), row%is_own(i))
         else
            ! Of another point only what supports prescribe is left.
            share = row%block(:, :, i) - matmul(row%block(:, :, i), constraints%free_projector(row%node(i)))
            if (maxval(abs(share)) > sum_rounding) call corner%add(row%node(i), matmul(along, -share/own(1)), .true.)
         end if
      end do
      push = times_axes(free, pair%frame(:, :, p), 1.0_dp/own)
      call corner%add(pair%node(p), diagonal(spread(1.0_dp, 1, n)) - free + push, .true.)
      ! The jump is the own unknown of one corner and moves all others as well.
      if (pair%lead == 0 .or. pair%lead == pair%node(p)) return
      call corner%add(pair%lead, matmul(push, spread(pair%jump(:n), 2, n)*spread(pair%jump(:n), 1, n)), .true.)
   end subroutine solve_row

   !> What of the displacement of a corner follows from that by the other terms of its row: all of it or, if a support
   !> guides the corner along an axis, the length along the axis with the same normal component (for bonded surfaces
   !> with the same component along the axis) (components, components) [-].
   pure function along_guide(pair, p, is_tied, constraints) result(along)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      integer, intent(in) :: p !! number of the point
      logical, intent(in) :: is_tied !! whether w = 0
      type(constraints_t), intent(in) :: constraints !! the supports
      real(dp) :: along(size(constraints%is_free, 1), size(constraints%is_free, 1))
      integer, allocatable :: axes(:), columns(:)
      integer :: k, n

      n = size(along, 1)
      along = constraints%free_projector(pair%node(p))
      if (size(constraints%place, 1) == 2 .and. .not. (is_tied .or. all(constraints%is_free(:2, pair%node(p))))) then
         associate (axis => constraints%frame(:2, merge(1, 2, constraints%is_free(1, pair%node(p))), pair%node(p)), &
            normal => pair%frame(:2, 1, p))
            along(:2, :2) = spread(axis, 2, 2)*spread(normal, 1, 2)/dot_product(axis, normal)
         end associate
      else if (allocated(pair%is_fixed) .and. .not. (is_tied .or. all(constraints%is_free(:, pair%node(p))))) then
         associate (own_axes => constraints%frame(:, :, pair%node(p)), frame => pair%frame(:, :, p))
            axes = pack([(k, k=1, n)], constraints%is_free(:, pair%node(p)))
            columns = pack([(k, k=1, n)], [.true., .not. pair%is_fixed(:, p)])
            along = matmul(own_axes(:, axes), matmul(small_inverse(matmul(transpose(frame(:, columns)), &
               own_axes(:, axes))), transpose(frame(:, columns))))
         end associate
      end if
   end function along_guide

   !> A diagonal matrix (components, components) [-].
   pure function diagonal(entries) result(matrix)
      real(dp), intent(in) :: entries(:) !! its entries (components)
      real(dp) :: matrix(size(entries), size(entries))
      integer :: i

      matrix = 0.0_dp
      do i = 1, size(entries)
         matrix(i, i) = entries(i)
      end do
   end function diagonal

   !> The product of a matrix with the symmetric one that has a normal and its tangents as eigenvectors and given
   !> eigenvalues (components, components) [-].
   pure function times_axes(matrix, frame, factor) result(product)
      real(dp), intent(in) :: matrix(:, :) !! the matrix (components, components)
      real(dp), intent(in) :: frame(:, :) !! normal and tangents as columns (components, components) [-]
      real(dp), intent(in) :: factor(:) !! the eigenvalues (components) [-]
      real(dp) :: product(size(factor), size(factor))
      integer :: k, n

      n = size(factor)
      product = factor(1)*matrix
      do k = 2, n
         ! Nothing is added if the tangential function equals the normal one.
         if (abs(factor(k) - factor(1)) > 0.0_dp) product = product + (factor(k) - factor(1))*matmul(matrix, &
            spread(frame(:, k), 2, n)*spread(frame(:, k), 1, n))
      end do
   end function times_axes

   !> Adds a term to the sum that a displacement of a slave is; terms of the same node are merged.
   pure subroutine sum_add(self, node, block, is_own)
      class(sum_t), intent(inout) :: self !! the sum
      integer, intent(in) :: node !! the node
      real(dp), intent(in) :: block(:, :) !! factor of the term (components, components) [-]
      logical, intent(in) :: is_own !! whether its own unknowns are meant; else its displacement
      integer :: k

      if (.not. allocated(self%node)) allocate (self%node(0), self%is_own(0), &
         self%block(size(block, 1), size(block, 1), 0))
      do k = 1, size(self%node)
         if (self%node(k) == node .and. (self%is_own(k) .eqv. is_own)) then
            self%block(:, :, k) = self%block(:, :, k) + block
            return
         end if
      end do
      self%node = [self%node, node]
      self%is_own = [self%is_own, is_own]
      self%block = reshape([self%block, block], [shape(block), size(self%node)])
   end subroutine sum_add

   !> Substitutes the sums of the displacements in a sum, until it contains unknowns only, or also the displacements of
   !> corners of the same slave that are being resolved: rows contain those of both corners of a side that is covered
   !> in part. The own displacement is eliminated.
   recursive subroutine resolve(sums, node, fault)
      type(sum_t), intent(inout) :: sums(:) !! the sums, not allocated for a node without one (nodes)
      integer, intent(in) :: node !! the node to resolve
      integer, intent(inout) :: fault !! a node that depends on itself through other bodies, 0 for none
      real(dp), dimension(size(sums(node)%block, 1), size(sums(node)%block, 1)) :: rest
      type(sum_t) :: expanded, resolved
      integer :: i, k, other

      if (sums(node)%visit > 0) return
      sums(node)%visit = 1
      do i = 1, size(sums(node)%node)
         associate (total => sums(node))
            other = total%node(i)
            if (total%is_own(i) .or. .not. allocated(sums(other)%node)) then
               call expanded%add(other, total%block(:, :, i), .true.)
               cycle
            end if
            call resolve(sums, other, fault)
            if (fault > 0) return
            if (sums(other)%visit == 1) then
               call expanded%add(other, total%block(:, :, i), .false.)
               cycle
            end if
            do k = 1, size(sums(other)%node)
               call expanded%add(sums(other)%node(k), matmul(total%block(:, :, i), sums(other)%block(:, :, k)), &
                  sums(other)%is_own(k))
            end do
         end associate
      end do
      rest = diagonal(spread(1.0_dp, 1, size(rest, 1)))
      do i = 1, size(expanded%node)
         if (expanded%is_own(i)) cycle
         if (expanded%node(i) == node) rest = rest - expanded%block(:, :, i)
         if (sums(expanded%node(i))%line /= sums(node)%line) fault = node
      end do
      ! The least part of a side that faces the master is `input_rounding`.
      if (abs(rest(1, 1)*rest(2, 2) - rest(1, 2)*rest(2, 1)) < 0.1_dp*input_rounding**2) fault = node
      if (fault > 0) return
      rest(:2, :2) = small_inverse(rest(:2, :2))
      rest(3:, 3:) = 1.0_dp/rest(3:, 3:)
      do i = 1, size(expanded%node)
         if (expanded%node(i) == node .and. .not. expanded%is_own(i)) cycle
         call resolved%add(expanded%node(i), matmul(rest, expanded%block(:, :, i)), expanded%is_own(i))
      end do
      resolved%line = sums(node)%line
      resolved%visit = merge(2, 0, all(resolved%is_own))
      sums(node) = resolved
   end subroutine resolve

   !> Finds where the bonded boundary sets face each other.
   subroutine new_tied_pairs(pairs, taken, ties, body, error)
      type(mortar_pair_t), allocatable, intent(out) :: pairs(:) !! the pair of each tie
      type(taken_t), intent(out) :: taken !! what the ties have
      type(tie_t), intent(in) :: ties(:) !! the ties
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(error_t), allocatable, intent(out) :: error !! as of `new_mortar_pair`
      type(pairing_t) :: pairing
      integer :: i, k

      allocate (pairs(size(ties)))
      pairing%is_tied = .true.
      call taken%begin(body%mesh)
      do i = 1, size(ties)
         pairing%against = ties(i)%to
         pairing%search = ties(i)%search
         taken%is_slave_again = any([(ties(k)%set == ties(i)%set, k=i + 1, size(ties))])
         call new_mortar_pair(pairs(i), ties(i)%set, pairing, body, taken, error)
         if (.not. allocated(error)) call follow_guides(pairs(i), body%constraints)
         if (.not. allocated(error)) call check_ends(pairs(i), 'exchange set and to', .true., body%constraints, error)
         if (allocated(error)) error%message = ties(i)%origin//error%message
         if (allocated(error)) return
         call take_facing_sides(taken, pairs(i))
         if (ties(i)%has_jump) call find_jump(pairs(i), body%constraints, error)
         if (allocated(error)) error%message = ties(i)%origin//error%message
         if (allocated(error)) return
      end do
   end subroutine new_tied_pairs

   !> Joins in the plane the corner at the end of a tie to that of the master at the same place, where both bodies have
   !> contact sets of nodal multipliers on a wall: its contact point is then that of the body in one piece. Its neighbor
   !> on the side has the multiplier of the side.
   subroutine join_corners(ties, partner, area, contacts, body)
      type(mortar_pair_t), intent(inout) :: ties(:) !! the ties, with their points; gain the partners
      integer, allocatable, intent(out) :: partner(:)
         !! the node that each node shares its contact points with: itself, or that which it is joined to (n_nodes)
      real(dp), allocatable, intent(out) :: area(:)
         !! areas of the nodes on the contact sets that have more than one linear side (n_nodes) [L^2]
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      real(dp), parameter :: least_cosine = 0.7_dp ! the walls of both continue as one line
      real(dp) :: normal(2, body%mesh%n_nodes)
      integer, allocatable :: facing(:)
      type(patch_t) :: patch
      type(error_t), allocatable :: fault
      integer :: i, k, place

      allocate (area(body%mesh%n_nodes), source=0.0_dp)
      partner = [(i, i=1, size(area))]
      if (size(body%mesh%coordinates, 1) == 3) return
      normal = 0.0_dp
      do i = 1, merge(size(contacts), 0, size(ties) > 0)
         if (contacts(i)%pairing%is_pair() .or. contacts(i)%partition%is_constant) cycle
         call new_patch(patch, body%mesh, contacts(i)%set, fault, body%materials)
         ! A missing set is reported later. A single linear side keeps the ends that no other set has.
         if (patch%n_nodes <= 2) cycle
         area(patch%node) = area(patch%node) + patch%area
         normal(:, patch%node) = patch%normal
      end do
      do i = 1, size(ties)
         associate (tie => ties(i))
            facing = [tie%master%side(:2, :)]
            do k = 1, merge(size(tie%node), 0, tie%lead == 0)
               associate (node => tie%node(k), beside => findloc(tie%point_of, k))
                  if (count(tie%point_of == k) /= 1 .or. tie%point_of(3 - beside(1), beside(2)) == 0 .or. &
                     .not. all(body%constraints%is_free(:, node))) cycle
                  place = findloc(hypot(body%mesh%coordinates(1, facing) - body%mesh%coordinates(1, node), &
                     body%mesh%coordinates(2, facing) - body%mesh%coordinates(2, node)) &
                     <= input_rounding*tie%slave%longest .and. matmul(normal(:, node), normal(:, facing)) &
                     > least_cosine, .true., dim=1)
                  if (place == 0) cycle
                  tie%partner(k) = facing(place)
                  tie%point_of(beside(1), beside(2)) = 0
                  where (partner == node) partner = partner(facing(place))
               end associate
            end do
         end associate
      end do
   end subroutine join_corners

   !> Finds the direction of the jump of a preload, and the corner whose unknown the jump is: one that can move along
   !> it.
   pure subroutine find_jump(pair, constraints, error)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its points; gains direction and corner
      type(constraints_t), intent(in) :: constraints !! the supports
      type(error_t), allocatable, intent(out) :: error !! supports hold all corners along it, or guide them aslant
      real(dp), allocatable :: jump(:)
      integer :: i, n_dim

      n_dim = size(constraints%place, 1)
      allocate (jump(size(constraints%is_free, 1)), source=0.0_dp)
      do i = 1, pair%slave%n_sides
         associate (corner => pair%slave%corner(:, :, i))
            if (n_dim == 2) jump(:2) = jump(:2) + norm2(corner(:, 2) - corner(:, 1))*pair%slave%normal(:, 3, i)
         end associate
      end do
      if (n_dim == 3) jump = matmul(pair%patch%normal, pair%patch%area)
      jump = jump/norm2(jump)
      pair%jump(:n_dim) = jump(:n_dim)
      do i = 1, size(pair%node)
         if (norm2(matmul(constraints%free_projector(pair%node(i)), jump) - jump) > input_rounding) cycle
         pair%lead = pair%node(i)
         ! A free corner is better: the jump then has an axis of its own.
         if (all(constraints%is_free(:n_dim, pair%lead))) return
      end do
      if (pair%lead == 0) call new_error(error, input_refused, "preload: supports hold all nodes of '"//pair%set// &
         "' along its normal, or guide them aslant")
   end subroutine find_jump

   !> Turns the axes of bonded points in the plane that supports guide, and those of their neighbors, to the guide and
   !> the direction across it, in place of normal and tangent.
   pure subroutine follow_guides(pair, constraints)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its points
      type(constraints_t), intent(in) :: constraints !! the supports
      integer :: p, i, k

      do p = 1, size(pair%node)
         if (.not. pair%is_fixed(1, p) .or. size(pair%slave%corner, 1) == 3) cycle
         associate (node => pair%node(p))
            pair%frame(:, :, p) = new_frame(constraints%frame(:2, merge(1, 2, constraints%is_free(1, node)), node), &
               size(pair%frame, 1))
         end associate
         do i = 1, size(pair%point_of, 2)
            do k = 1, 2
               if (pair%point_of(k, i) /= p .or. pair%point_of(3 - k, i) == 0) cycle
               associate (other => pair%point_of(3 - k, i))
                  if (.not. pair%is_fixed(1, other)) pair%frame(:, :, other) = pair%frame(:, :, p)
               end associate
            end do
         end do
      end do
   end subroutine follow_guides

   !> Pairs of nodes that move together in a rigid motion: of surfaces that face each other the corners of each
   !> segment's two sides, and those of rigid sets; and the number of the pair if there is a free jump between the two,
   !> 0 elsewhere (3, any).
   pure function bonds_of(pairs, constraints) result(bonds)
      type(mortar_pair_t), intent(in) :: pairs(:) !! the pairs of surfaces; some may be none
      type(constraints_t), intent(in) :: constraints !! the supports, with the rigid sets
      integer, allocatable :: bonds(:, :)
      integer :: i, k

      allocate (bonds(3, 0))
      do i = 1, size(pairs)
         if (.not. pairs(i)%is_set()) cycle
         associate (pair => pairs(i), jump => merge(i, 0, pairs(i)%is_jump_free))
            ! In space one corner of each face stands for all.
            associate (slave => pair%slave%side(:2, pair%segments%slave), &
               master => pair%master%side(:2, pair%segments%master))
               bonds = reshape([bonds, ([slave(1, k), master(1, k), jump, slave(2, k), master(1, k), jump, &
                  master(:, k), 0], k=1, size(pair%segments))], [3, size(bonds, 2) + 3*size(pair%segments)])
            end associate
         end associate
      end do
      do i = 1, size(constraints%rigid)
         associate (rigid => constraints%rigid(i))
            bonds = reshape([bonds, ([rigid%carrier(1), rigid%node(k), 0], k=1, size(rigid%node))], &
               [3, size(bonds, 2) + size(rigid%node)])
         end associate
      end do
   end function bonds_of

end module amontons_pair_substitution
