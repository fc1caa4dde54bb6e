!> Rigid motions of the pieces of a body, and those that its supports leave free.
module amontons_rigid_motion
   use amontons_constraints, only: constraints_t, spring_side_t
   use amontons_dense, only: symmetric_eigenvectors
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t, number_pieces
   use amontons_text, only: place_text, to_text
   implicit none (type, external)
   private

   public :: displacement_of_nodes, new_rigid_motions, rigid_motions_t

   !> The free rigid motions of a piece: combinations of the translations and the rotation about its middle (in a
   !> twisted body about the axis) and, where free jumps divide it into parts, of the translations of these parts
   !> relative to each other.
   type :: rigid_motions_t
      integer :: n_free = 0 !! number of independent free motions, 0 to 3, and one more for each jump
      real(dp), allocatable :: mode(:, :)
         !! translation x, translation y, rotation and jumps of each free motion (3 + jumps, n_free)
      real(dp) :: center(2) = 0.0_dp !! the middle of the piece [L]
      real(dp) :: radius = 1.0_dp !! half the piece's diagonal, the length that scales the rotation [L]
      integer, allocatable :: node(:) !! the nodes of the piece, ascending
      logical :: is_whole = .true. !! whether the piece is the whole body
      integer :: n_components = 2 !! number of components of a displacement
      integer :: n_jumps = 0 !! number of jumps
      integer, allocatable :: part(:) !! the part that each node belongs to; not allocated without jumps (n_nodes)
      real(dp), allocatable :: way(:, :, :) !! how far each part moves per jump (2, jumps, parts) [-]
   contains
      procedure :: describe => rigid_motions_describe
      procedure :: displacement => rigid_motions_displacement
      procedure :: unit_motions => rigid_motions_unit_motions
   end type rigid_motions_t

contains

   !> Finds the rigid motions of each piece of a body that violate no support: the kernel of the Gram matrix of its held
   !> directions.
   subroutine new_rigid_motions(motions, mesh, constraints, springs, is_axisymmetric, bonds, jumps)
      type(rigid_motions_t), allocatable, intent(out) :: motions(:) !! the free motions of each piece
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides; they hold what they resist
      logical, intent(in) :: is_axisymmetric
         !! whether only the translation along the axis (y) and, of a twisted body, the rotation about it are rigid ones
      integer, intent(in) :: bonds(:, :)
         !! pairs of nodes that hold together, too, and the free jump of the first one against the second, 0 for none
         !! (3, bonds)
      real(dp), intent(in) :: jumps(:, :) !! direction of each jump, a unit vector (2, jumps) [-]
      ! Held directions are known to about 1e-6; a square of that is noise in the Gram matrix.
      real(dp), parameter :: negligible = 1.0e-12_dp
      ! A quadratic side of a twisted body has three nodes of three components.
      integer, parameter :: most_components = 9
      integer, allocatable :: piece(:), start(:), node(:)
      real(dp), allocatable :: gram(:, :), values(:), row(:), motion(:, :), unit(:, :)
      real(dp) :: frame(size(constraints%is_free, 1), size(constraints%is_free, 1)), largest
      integer :: axis, i, info, k, n_jumps, n_pieces, p

      n_jumps = 0
      if (any(bonds(3, :) > 0)) n_jumps = size(jumps, 2)
      call number_pieces(mesh, piece, n_pieces, bonds(:2, :))
      call fill_bins(start, node, piece, n_pieces)
      allocate (motions(n_pieces), gram(3 + n_jumps, 3 + n_jumps), values(3 + n_jumps))
      allocate (motion(most_components, 3 + n_jumps), source=0.0_dp)
      do p = 1, n_pieces
         motions(p)%node = node(start(p):start(p + 1) - 1)
         motions(p)%is_whole = n_pieces == 1
         motions(p)%n_components = size(constraints%is_free, 1)
         associate (lowest => minval(mesh%coordinates(:, motions(p)%node), dim=2), &
            highest => maxval(mesh%coordinates(:, motions(p)%node), dim=2))
            motions(p)%center = 0.5_dp*(lowest + highest)
            motions(p)%radius = 0.5_dp*norm2(highest - lowest)
         end associate
         gram = 0.0_dp
         if (n_jumps > 0) call divide_piece(motions(p), gram, mesh, bonds, jumps)
         do i = start(p), start(p + 1) - 1
            if (constraints%rigid_of(node(i)) > 0 .or. all(constraints%is_free(:, node(i)))) cycle
            frame = constraints%frame(node(i))
            do axis = 1, motions(p)%n_components
               if (constraints%is_free(axis, node(i))) cycle
               unit = motions(p)%unit_motions(mesh%coordinates(:, node(i)), node(i))
               row = matmul(frame(:, axis), unit)
               do k = 1, size(row)
                  gram(:, k) = gram(:, k) + row*row(k)
               end do
            end do
         end do
         do i = 1, size(constraints%rigid)
            associate (rigid => constraints%rigid(i))
               if (piece(rigid%node(1)) /= p) cycle
               unit = motions(p)%unit_motions(rigid%point, rigid%node(1))
               motion(:2, :) = unit(:2, :)
               motion(3, :) = 0.0_dp
               motion(3, 3) = rigid%length/motions(p)%radius
               do axis = 1, 3
                  if (constraints%is_free(rigid%axis(axis), rigid%lead(axis))) cycle
                  gram = gram + spread(motion(axis, :), 1, size(gram, 1))*spread(motion(axis, :), 2, size(gram, 1))
               end do
            end associate
         end do
         ! The directions that springs resist, whatever their stiffness.
         do i = 1, size(springs)
            associate (spring => springs(i), n => motions(p)%n_components)
               if (piece(spring%node(1)) /= p) cycle
               largest = maxval(abs(spring%stiffness))
               if (.not. largest > 0.0_dp) cycle
               do k = 1, size(spring%node)
                  motion(n*(k - 1) + 1:n*k, :) = motions(p)%unit_motions(mesh%coordinates(:, spring%node(k)), &
                     spring%node(k))
               end do
               associate (along => motion(:n*size(spring%node), :))
                  gram = gram + matmul(transpose(along), matmul(reshape(spring%stiffness/largest, &
                     [size(along, 1), size(along, 1)]), along))
               end associate
            end associate
         end do
         if (is_axisymmetric) then
            gram(1, 1) = gram(1, 1) + real(size(motions(p)%node), dp)
            if (motions(p)%n_components == 2) gram(3, 3) = gram(3, 3) + real(size(motions(p)%node), dp)
            do k = 1, n_jumps
               gram(3 + k, 3 + k) = gram(3 + k, 3 + k) + jumps(1, k)**2*real(size(motions(p)%node), dp)
            end do
         end if
         call symmetric_eigenvectors(gram, values, info)
         motions(p)%n_free = count(values <= negligible*max(values(size(values)), tiny(values)))
         motions(p)%mode = gram(:, :motions(p)%n_free)
      end do
   end subroutine new_rigid_motions

   !> Finds the parts into which free jumps divide a piece, and how each part moves under the jumps. Jumps that cannot
   !> move, because their two sides are also joined in another way or belong to other pieces, are held in the Gram
   !> matrix.
   subroutine divide_piece(motions, gram, mesh, bonds, jumps)
      type(rigid_motions_t), intent(inout) :: motions !! the piece; gains the parts
      real(dp), intent(inout) :: gram(:, :) !! Gram matrix of the directions held (3 + jumps, 3 + jumps)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: bonds(:, :) !! pairs of nodes, and the jump of the first one against the second (3, bonds)
      real(dp), intent(in) :: jumps(:, :) !! direction of each jump (2, jumps) [-]
      logical :: is_here(mesh%n_nodes), is_mine(size(jumps, 2)), is_changed
      logical, allocatable :: is_known(:)
      real(dp) :: way(2, size(jumps, 2))
      integer :: i, k, n_parts, side(2)

      call number_pieces(mesh, motions%part, n_parts, reshape(pack(bonds(:2, :), spread(bonds(3, :) == 0, 1, 2)), &
         [2, count(bonds(3, :) == 0)]))
      motions%n_jumps = size(jumps, 2)
      allocate (motions%way(2, motions%n_jumps, n_parts), source=0.0_dp)
      is_here = .false.
      is_here(motions%node) = .true.
      is_mine = .false.
      allocate (is_known(n_parts), source=.false.)
      is_known(motions%part(motions%node(1))) = .true.
      is_changed = .true.
      do while (is_changed)
         is_changed = .false.
         do i = 1, size(bonds, 2)
            if (bonds(3, i) == 0 .or. .not. is_here(bonds(1, i))) cycle
            is_mine(bonds(3, i)) = .true.
            side = motions%part(bonds(:2, i))
            if (is_known(side(1)) .eqv. is_known(side(2))) cycle
            is_changed = .true.
            k = merge(1, 2, is_known(side(2)))
            motions%way(:, :, side(k)) = motions%way(:, :, side(3 - k))
            motions%way(:, bonds(3, i), side(k)) = motions%way(:, bonds(3, i), side(k)) &
               + merge(jumps(:, bonds(3, i)), -jumps(:, bonds(3, i)), k == 1)
            is_known(side(k)) = .true.
         end do
      end do
      do i = 1, size(bonds, 2)
         if (bonds(3, i) == 0 .or. .not. is_here(bonds(1, i))) cycle
         way = motions%way(:, :, motions%part(bonds(1, i))) - motions%way(:, :, motions%part(bonds(2, i)))
         way(:, bonds(3, i)) = way(:, bonds(3, i)) - jumps(:, bonds(3, i))
         gram(4:, 4:) = gram(4:, 4:) + matmul(transpose(way), way)
      end do
      do k = 1, size(is_mine)
         if (.not. is_mine(k)) gram(3 + k, 3 + k) = 1.0_dp
      end do
   end subroutine divide_piece

   !> Displacement of a point under the two translations, the rotation and the jumps (components, 3 + jumps) [-].
   pure function rigid_motions_unit_motions(self, point, node) result(displacement)
      class(rigid_motions_t), intent(in) :: self !! center, radius and parts
      real(dp), intent(in) :: point(2) !! coordinates [L]
      integer, intent(in) :: node !! the node that moves with it
      real(dp) :: displacement(self%n_components, 3 + self%n_jumps)

      displacement = 0.0_dp
      displacement(1, 1) = 1.0_dp
      displacement(2, 2) = 1.0_dp
      if (self%n_components == 2) then
         displacement(:, 3) = [-(point(2) - self%center(2)), point(1) - self%center(1)]/self%radius
      else
         displacement(3, 3) = point(1)/self%radius
      end if
      if (self%n_jumps > 0) displacement(:2, 4:) = self%way(:, :, self%part(node))
   end function rigid_motions_unit_motions

   !> Displacement of a point under each free motion (components, n_free) [-].
   pure function rigid_motions_displacement(self, point, node) result(displacement)
      class(rigid_motions_t), intent(in) :: self !! the free motions
      real(dp), intent(in) :: point(2) !! coordinates [L]
      integer, intent(in) :: node !! the node that moves with it
      real(dp) :: displacement(self%n_components, self%n_free)

      displacement = matmul(self%unit_motions(point, node), self%mode)
   end function rigid_motions_displacement

   !> The displacements of all nodes under a combination of the free motions of all pieces (components, n_nodes) [L].
   pure function displacement_of_nodes(motions, coordinates, amounts) result(displacement)
      type(rigid_motions_t), intent(in) :: motions(:) !! the motions of each piece
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: amounts(:) !! amount of each, piece after piece (n_free of all) [L]
      real(dp), allocatable :: displacement(:, :)
      integer :: first, i, k

      allocate (displacement(motions(1)%n_components, size(coordinates, 2)), source=0.0_dp)
      first = 0
      do k = 1, size(motions)
         if (motions(k)%n_free == 0) cycle
         associate (node => motions(k)%node)
            do i = 1, size(node)
               displacement(:, node(i)) = matmul(motions(k)%displacement(coordinates(:, node(i)), node(i)), &
                  amounts(first + 1:first + motions(k)%n_free))
            end do
            first = first + motions(k)%n_free
         end associate
      end do
   end function displacement_of_nodes

   !> Text describing a combination of the free motions, with the position of the piece if the body has several.
   pure function rigid_motions_describe(self, amounts) result(text)
      class(rigid_motions_t), intent(in) :: self !! the free motions
      real(dp), intent(in) :: amounts(:) !! amount of each free motion (n_free)
      character(:), allocatable :: text
      ! Less is not shown by four digits.
      real(dp), parameter :: negligible = 1.0e-4_dp
      real(dp), allocatable :: motion(:)

      motion = matmul(self%mode, amounts)
      motion = motion/maxval(abs(motion))
      text = 'the body'
      if (.not. self%is_whole) text = 'the piece around '//place_text(self%center)
      text = text//' is free to'
      if (norm2(motion(1:2)) > negligible) text = text//' translate along ('//short(motion(1))//', '// &
         short(motion(2))//')'
      if (abs(motion(3)) > negligible) then
         if (norm2(motion(1:2)) > negligible) text = text//' and'
         if (self%n_components > 2) then
            text = text//' rotate about the axis'
         else
            text = text//' rotate '//trim(merge('counter-clockwise', 'clockwise        ', motion(3) > 0.0_dp))
         end if
      end if
      if (any(abs(motion(4:)) > negligible)) then
         if (maxval(abs(motion(:3))) > negligible) text = text//' and'
         text = text//' move along the preload on one side of it'
      end if
   end function rigid_motions_describe

   !> A number rounded to four decimals, for reading.
   pure function short(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_text(real(nint(1.0e4_dp*value), dp)/1.0e4_dp)
   end function short

end module amontons_rigid_motion
