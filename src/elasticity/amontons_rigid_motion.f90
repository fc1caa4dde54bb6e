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

   public :: new_rigid_motions, rigid_motions_t

   !> The free rigid motions of a piece: combinations of the translations and the rotation about its middle.
   type :: rigid_motions_t
      integer :: n_free = 0 !! number of independent free motions, 0 to 3
      real(dp), allocatable :: mode(:, :) !! translation x, translation y, rotation of each free motion (3, n_free)
      real(dp) :: center(2) = 0.0_dp !! the middle of the piece [L]
      real(dp) :: radius = 1.0_dp !! half the piece's diagonal, the length that scales the rotation [L]
      integer, allocatable :: node(:) !! the nodes of the piece, ascending
      logical :: is_whole = .true. !! whether the piece is the whole body
   contains
      procedure :: describe => rigid_motions_describe
      procedure :: displacement => rigid_motions_displacement
   end type rigid_motions_t

contains

   !> Finds the rigid motions of each piece of a body that violate no support: the kernel of the Gram matrix of its held
   !> directions.
   subroutine new_rigid_motions(motions, mesh, constraints, springs, is_axisymmetric, bonds)
      type(rigid_motions_t), allocatable, intent(out) :: motions(:) !! the free motions of each piece
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides; they hold what they resist
      logical, intent(in) :: is_axisymmetric !! whether only the translation along the axis (y) is a rigid motion
      integer, intent(in), optional :: bonds(:, :) !! pairs of nodes that hold together, too (2, bonds)
      ! Held directions are known to about 1e-6; a square of that is noise in the Gram matrix.
      real(dp), parameter :: negligible = 1.0e-12_dp
      ! A quadratic side has three nodes.
      integer, parameter :: most_components = 6
      integer, allocatable :: piece(:), start(:), node(:)
      real(dp) :: gram(3, 3), values(3), frame(2, 2), row(3), motion(most_components, 3), largest
      integer :: axis, i, info, k, n_pieces, p

      call number_pieces(mesh, piece, n_pieces, bonds)
      call fill_bins(start, node, piece, n_pieces)
      allocate (motions(n_pieces))
      do p = 1, n_pieces
         motions(p)%node = node(start(p):start(p + 1) - 1)
         motions(p)%is_whole = n_pieces == 1
         associate (lowest => minval(mesh%coordinates(:, motions(p)%node), dim=2), &
            highest => maxval(mesh%coordinates(:, motions(p)%node), dim=2))
            motions(p)%center = 0.5_dp*(lowest + highest)
            motions(p)%radius = 0.5_dp*norm2(highest - lowest)
         end associate
         gram = 0.0_dp
         do i = start(p), start(p + 1) - 1
            if (constraints%rigid_of(node(i)) > 0) cycle
            frame = constraints%frame(node(i))
            do axis = 1, 2
               if (constraints%is_free(axis, node(i))) cycle
               row = matmul(frame(:, axis), unit_motions(motions(p), mesh%coordinates(:, node(i))))
               do k = 1, 3
                  gram(:, k) = gram(:, k) + row*row(k)
               end do
            end do
         end do
         do i = 1, size(constraints%rigid)
            associate (rigid => constraints%rigid(i))
               if (piece(rigid%node(1)) /= p) cycle
               motion(:2, :) = unit_motions(motions(p), rigid%point)
               motion(3, :) = [0.0_dp, 0.0_dp, rigid%length/motions(p)%radius]
               do axis = 1, 3
                  if (constraints%is_free(merge(axis, 1, axis < 3), rigid%lead(merge(1, 2, axis < 3)))) cycle
                  gram = gram + spread(motion(axis, :), 1, 3)*spread(motion(axis, :), 2, 3)
               end do
            end associate
         end do
         ! The directions that springs resist, whatever their stiffness.
         do i = 1, size(springs)
            associate (side => springs(i), n => 2*springs(i)%n_nodes)
               if (piece(side%node(1)) /= p) cycle
               largest = maxval(abs(side%stiffness))
               if (.not. largest > 0.0_dp) cycle
               do k = 1, side%n_nodes
                  motion(2*k - 1:2*k, :) = unit_motions(motions(p), mesh%coordinates(:, side%node(k)))
               end do
               gram = gram + matmul(transpose(motion(:n, :)), matmul(side%stiffness(:n, :n)/largest, motion(:n, :)))
            end associate
         end do
         if (is_axisymmetric) then
            gram(1, 1) = gram(1, 1) + real(size(motions(p)%node), dp)
            gram(3, 3) = gram(3, 3) + real(size(motions(p)%node), dp)
         end if
         call symmetric_eigenvectors(gram, values, info)
         motions(p)%n_free = count(values <= negligible*max(values(3), tiny(values)))
         motions(p)%mode = gram(:, :motions(p)%n_free)
      end do
   end subroutine new_rigid_motions

   !> Displacement of a point under the two translations and the rotation (2, 3) [-].
   pure function unit_motions(motions, point) result(displacement)
      type(rigid_motions_t), intent(in) :: motions !! center and radius
      real(dp), intent(in) :: point(2) !! coordinates [L]
      real(dp) :: displacement(2, 3)

      displacement(:, 1) = [1.0_dp, 0.0_dp]
      displacement(:, 2) = [0.0_dp, 1.0_dp]
      displacement(:, 3) = [-(point(2) - motions%center(2)), point(1) - motions%center(1)]/motions%radius
   end function unit_motions

   !> Displacement of a point under each free motion (2, n_free) [-].
   pure function rigid_motions_displacement(self, point) result(displacement)
      class(rigid_motions_t), intent(in) :: self !! the free motions
      real(dp), intent(in) :: point(2) !! coordinates [L]
      real(dp) :: displacement(2, self%n_free)

      displacement = matmul(unit_motions(self, point), self%mode)
   end function rigid_motions_displacement

   !> Names a combination of the free motions in words, and the piece where there are others.
   pure function rigid_motions_describe(self, amounts) result(text)
      class(rigid_motions_t), intent(in) :: self !! the free motions
      real(dp), intent(in) :: amounts(:) !! amount of each free motion (n_free)
      character(:), allocatable :: text
      ! Less is not shown by four digits.
      real(dp), parameter :: negligible = 1.0e-4_dp
      real(dp) :: motion(3)

      motion = matmul(self%mode, amounts)
      motion = motion/maxval(abs(motion))
      text = 'the body'
      if (.not. self%is_whole) text = 'the piece around '//place_text(self%center)
      text = text//' is free to'
      if (norm2(motion(1:2)) > negligible) text = text//' translate along ('//short(motion(1))//', '// &
         short(motion(2))//')'
      if (abs(motion(3)) > negligible) then
         if (norm2(motion(1:2)) > negligible) text = text//' and'
         text = text//' rotate '//trim(merge('counter-clockwise', 'clockwise        ', motion(3) > 0.0_dp))
      end if
   end function rigid_motions_describe

   !> A number rounded to four decimals, for reading.
   pure function short(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text

      text = to_text(real(nint(1.0e4_dp*value), dp)/1.0e4_dp)
   end function short

end module amontons_rigid_motion
