!> Checks of pairs: contact points that do not go with its mesh or supports are refused, and bodies that overlap by more
!> than an interference fit does.
module amontons_pair_checks
   use amontons_constraints, only: constraints_t
   use amontons_element, only: side_shapes
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face, only: place_side
   use amontons_frame, only: new_frame
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t, outer_sides, side_element, side_place
   use amontons_mortar_pair, only: mortar_pair_t, mortar_points_t
   use amontons_obstacle, only: cross_product
   use amontons_rounding, only: angle_rounding, exceeds, first_largest, input_rounding
   use amontons_surface, only: meet_side
   use amontons_text, only: place_text, short_text
   implicit none (type, external)
   private

   public :: check_ends, check_overlap, guided_alone, held_slave_text

contains

   !> Refuses meshes that overlap by more than half of a side, or by more than the thickness of one of the bodies there:
   !> an overlap beyond a thin wall is no interference fit.
   pure subroutine check_overlap(pair, points, mesh, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_points_t), intent(in) :: points !! its integrals
      type(mesh_t), intent(in) :: mesh !! the mesh of both
      type(error_t), allocatable, intent(out) :: error !! they do
      character(:), allocatable :: overlap
      real(dp) :: thickness
      integer :: q

      q = first_largest(-points%quadrature%gap)
      if (q == 0) return
      associate (depth => -points%quadrature%gap(q), position => points%quadrature%position(:, q))
         if (depth <= input_rounding*pair%slave%longest) return
         overlap = "'"//pair%set//"' and '"//pair%against//"' overlap by up to "//short_text(depth)// &
            ' before any load (side at '//place_text(position)//'), '
         if (exceeds(depth, 0.5_dp*pair%slave%longest)) then
            call new_error(error, input_refused, overlap//'more than half a side: give extra_gap for an '// &
               "interference, or gap = 'touching'")
            return
         end if
         if (size(position) == 3) return
         thickness = wall_thickness(mesh, position, -points%quadrature%normal(:, q), depth)
         if (thickness < depth) call new_error(error, input_refused, overlap//'through a wall of '// &
            short_text(thickness)//': move the bodies to their own sides of it, or give a smaller search')
      end associate
   end subroutine check_overlap

   !> The thickness of the body at a position: the distance to the first boundary where a ray leaves it, huge if there
   !> is none within a given depth. Sides inclined by more than 25 degrees are ignored: near a corner the thickness goes
   !> to 0.
   pure real(dp) function wall_thickness(mesh, position, direction, depth) result(thickness)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: position(2) !! the place, on the boundary of a body [L]
      real(dp), intent(in) :: direction(2) !! the way into it, a unit vector [-]
      real(dp), intent(in) :: depth !! largest thickness of interest [L]
      real(dp), parameter :: aslant = 0.906_dp ! the cosine of 25 degrees
      integer, allocatable :: outer(:)
      real(dp) :: corner(2, 3), normal(2, 3), xi(2), values(3), slopes(3), way, along(2)
      integer :: i, k

      thickness = huge(1.0_dp)
      outer = outer_sides(mesh)
      do i = 1, size(outer)
         call place_side(corner, normal, mesh%side(side_element(outer(i)), side_place(outer(i))), mesh%coordinates)
         xi = meet_side(corner, position, direction)
         do k = 1, 2
            if (abs(xi(k)) > 1.0_dp) cycle
            call side_shapes(.true., xi(k), values, slopes)
            along = matmul(corner, slopes)
            way = dot_product(matmul(corner, values) - position, direction)
            ! The surfaces that overlap themselves lie at both ends of the way.
            if (way <= input_rounding*depth .or. .not. exceeds(depth, way)) cycle
            if (abs(cross_product(along, direction)) > aslant*norm2(along)) thickness = min(thickness, way)
         end do
      end do
   end function wall_thickness

   !> Refuses a side of the slave that has no multiplier at any corner and faces a part of the master that may move
   !> along the normal or, where shear may act, along the tangent: no force would be transmitted there. A side of which
   !> earlier sets have all corners is left to them, unless that leaves no point. In space no bonded corner may be
   !> guided alone.
   pure subroutine check_ends(pair, remedy, needs_shear, constraints, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, its points corners
      character(*), intent(in) :: remedy !! advice for the message if supports hold the slave
      logical, intent(in) :: needs_shear !! whether shear may act: friction, or bonded surfaces
      type(constraints_t), intent(in) :: constraints !! the supports
      type(error_t), allocatable, intent(out) :: error !! there is such a side
      ! Between the normal and the tangent of the surface.
      real(dp), parameter :: aslant = 0.707_dp
      real(dp) :: frame(size(constraints%is_free, 1), size(constraints%is_free, 1))
      logical, dimension(size(pair%point_of, 1), 2) :: is_held, lacks
      integer :: i, k, m, p
      logical :: is_alone(size(pair%node))

      m = size(pair%slave%corner, 1)
      is_alone = guided_alone(pair, constraints)
      do i = 1, size(pair%segments)
         associate (side => pair%segments(i)%slave, slave => pair%slave, other => pair%segments(i)%master, &
            c => pair%slave%n_corners(pair%segments(i)%slave), middle => size(pair%slave%normal, 2))
            frame = new_frame(slave%normal(:, middle, side), size(frame, 1))
            do k = 1, c
               p = pair%point_of(k, side)
               is_held(k, :) = any(pair%held_node == slave%side(k, side))
               lacks(k, :) = p == 0
               if (p == 0) cycle
               is_held(k, 2) = pair%is_fixed(1, p)
               lacks(k, 2) = pair%is_fixed(1, p)
               frame = pair%frame(:, :, p)
               if (.not. (needs_shear .and. m == 3)) cycle
               if (.not. is_alone(p)) cycle
               call new_error(error, input_refused, held_slave_text(pair, slave%corner(:, k, side), 'shear', remedy))
               return
            end do
            do k = 1, merge(2, 1, needs_shear .and. m == 2)
               if (.not. (all(lacks(:c, k)) .and. any(is_held(:c, k)))) cycle
               if (.not. any([(constraints%leaves_free(pair%master%side(p, other), frame(:m, k)), &
                  p=1, pair%master%n_corners(other))])) cycle
               call new_error(error, input_refused, held_slave_text(pair, &
                  slave%corner(:, size(slave%corner, 2), side), merge('force', 'shear', &
                  abs(dot_product(frame(:m, k), slave%normal(:, middle, side))) > aslant), remedy))
               return
            end do
         end associate
      end do
      if (size(pair%node) == 0) call new_error(error, input_refused, "no node of '"//pair%set//"' that faces '"// &
         pair%against//"' is left: supports hold them, or they belong to ties, preloads or earlier sets; refine '"// &
         pair%set//"', or "//remedy)
   end subroutine check_ends

   !> Which points in space supports guide, but no corner of the sides of the master that they face, in the same plane
   !> of symmetry: there bodies end at the plane, and no shear acts (n).
   pure function guided_alone(pair, constraints) result(is_alone)
      type(mortar_pair_t), intent(in) :: pair !! the pair, its points corners
      type(constraints_t), intent(in) :: constraints !! the supports
      logical :: is_alone(size(pair%node))
      integer :: i, j, k, t

      is_alone = size(pair%slave%corner, 1) == 3 .and. any(pair%is_fixed, dim=1)
      do i = 1, size(pair%segments)
         associate (slave => pair%segments(i)%slave, master => pair%master, other => pair%segments(i)%master)
            do k = 1, pair%slave%n_corners(slave)
               associate (p => pair%point_of(k, slave), place => pair%slave%corner(:, k, slave))
                  if (p == 0) cycle
                  do j = 1, merge(master%n_corners(other), 0, is_alone(p))
                     is_alone(p) = is_alone(p) .and. .not. all([(.not. pair%is_fixed(t, p) .or. &
                        (abs(dot_product(master%corner(:, j, other) - place, pair%frame(:, 1 + t, p))) &
                        <= angle_rounding*master%longest .and. &
                        .not. constraints%leaves_free(master%side(j, other), pair%frame(:, 1 + t, p))), &
                        t=1, size(pair%is_fixed, 1))])
                  end do
               end associate
            end do
         end associate
      end do
   end function guided_alone

   !> The message that supports hold a part of a slave, so that contact forces do no work there.
   pure function held_slave_text(pair, position, what, remedy) result(text)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      real(dp), intent(in) :: position(:) !! position of the part (n_dim) [L]
      character(*), intent(in) :: what !! noun for what cannot act: force or shear
      character(*), intent(in) :: remedy !! advice for the message
      character(:), allocatable :: text

      text = "supports hold the slave '"//pair%set//"' at "//place_text(position)//': no '//what// &
         " could act between it and '"//pair%against//"' there; "//remedy
   end function held_slave_text

end module amontons_pair_checks
