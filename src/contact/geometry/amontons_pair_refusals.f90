!> Checks of the contact points of a pair of surfaces: in the pair, the mesh and the supports, out a refusal.
module amontons_pair_refusals
   use amontons_constraints, only: constraints_t
   use amontons_contact_rows, only: turned
   use amontons_element, only: side_shapes
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t, new_side_table, side_element, side_place, side_table_t
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_mortar_points, only: mortar_points_t
   use amontons_mortar_segments, only: meet_side
   use amontons_surface, only: cross_product
   use amontons_text, only: place_text, short_text
   implicit none (type, external)
   private

   public :: check_ends, check_overlap, held_slave_text

contains

   !> Refuses a side of the slave that has no multiplier at either end and faces a part of the master that may move
   !> along the normal, or, where shear may act, the same along the tangent: nothing would be transmitted there. Where
   !> earlier sets have both ends the side is taken to be theirs, unless that leaves no point.
   pure subroutine check_ends(pair, remedy, needs_shear, constraints, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, its points corners
      character(*), intent(in) :: remedy !! what to do where supports hold the slave
      logical, intent(in) :: needs_shear !! whether shear may act: friction, or bonded surfaces
      type(constraints_t), intent(in) :: constraints !! the supports
      type(error_t), allocatable, intent(out) :: error !! there is such a side
      ! Between the normal and the tangent of the surface.
      real(dp), parameter :: aslant = 0.707_dp
      real(dp) :: axes(2, 2)
      logical :: is_held(2, 2), lacks(2, 2)
      integer :: i, k, p

      do i = 1, size(pair%segments)
         associate (points => pair%point_of(:, pair%segments(i)%slave), &
            nodes => pair%slave%side(:2, pair%segments(i)%slave), &
            facing => pair%master%side(:2, pair%segments(i)%master))
            axes(:, 1) = pair%slave%normal(:, 3, pair%segments(i)%slave)
            do k = 1, 2
               p = points(k)
               is_held(k, :) = any(pair%held_node == nodes(k))
               lacks(k, :) = p == 0
               if (p == 0) cycle
               is_held(k, 2) = pair%is_tangent_fixed(p)
               lacks(k, 2) = pair%is_tangent_fixed(p)
               axes(:, 1) = pair%normal(:, p)
            end do
            axes(:, 2) = turned(axes(:, 1))
            do k = 1, merge(2, 1, needs_shear)
               if (.not. (all(lacks(:, k)) .and. any(is_held(:, k)))) cycle
               if (.not. (constraints%leaves_free(facing(1), axes(:, k)) .or. &
                  constraints%leaves_free(facing(2), axes(:, k)))) cycle
               call new_error(error, input_refused, held_slave_text(pair, &
                  pair%slave%corner(:, 3, pair%segments(i)%slave), merge('force', 'shear', &
                  abs(dot_product(axes(:, k), pair%slave%normal(:, 3, pair%segments(i)%slave))) > aslant), remedy))
               return
            end do
         end associate
      end do
      if (size(pair%node) == 0) call new_error(error, input_refused, "no node of '"//pair%set//"' that faces '"// &
         pair%against//"' is left: supports hold them, or they belong to earlier sets")
   end subroutine check_ends

   !> Says that a part of a slave has no displacements left that contact forces could act on.
   pure function held_slave_text(pair, position, what, remedy) result(text)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      real(dp), intent(in) :: position(2) !! where the part is [L]
      character(*), intent(in) :: what !! what cannot act: force or shear
      character(*), intent(in) :: remedy !! what to do about it
      character(:), allocatable :: text

      text = "supports hold the slave '"//pair%set//"' at "//place_text(position)//': no '//what// &
         " could act between it and '"//pair%against//"' there; "//remedy
   end function held_slave_text

   !> Refuses meshes that overlap by more than half of a side, or by more than one of the bodies is thick there: what
   !> lies beyond a thin wall was not pressed into it.
   pure subroutine check_overlap(pair, points, mesh, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_points_t), intent(in) :: points !! its integrals
      type(mesh_t), intent(in) :: mesh !! the mesh of both
      type(error_t), allocatable, intent(out) :: error !! they do
      ! What the digits of mesh files leave of a gap of 0, over the longest side.
      real(dp), parameter :: rounding = 1.0e-6_dp
      character(:), allocatable :: overlap
      real(dp) :: thickness
      integer :: q

      if (size(points%quadrature%gap) == 0) return
      ! Of places that differ by rounding alone the first.
      q = findloc(points%quadrature%gap <= (1.0_dp - rounding)*minval(points%quadrature%gap), .true., dim=1)
      if (q == 0) return
      associate (depth => -points%quadrature%gap(q), position => points%quadrature%position(:, q))
         if (depth <= rounding*pair%slave%longest) return
         overlap = "'"//pair%set//"' and '"//pair%against//"' overlap by up to "//short_text(depth)// &
            ' before any load (side at '//place_text(position)//'), '
         if (depth > 0.5_dp*pair%slave%longest) then
            call new_error(error, input_refused, overlap//'more than half a side: give extra_gap for an '// &
               "interference, or gap = 'touching'")
            return
         end if
         thickness = wall_thickness(mesh, position, -points%quadrature%normal(:, q), depth)
         if (thickness < depth) call new_error(error, input_refused, overlap//'through a wall of '// &
            short_text(thickness)//': move the bodies to their own sides of it, or give a smaller search')
      end associate
   end subroutine check_overlap

   !> How thick the body is that begins at a place: the way to the first boundary that it leaves by, huge for none
   !> within a depth. Sides more than 25 degrees aslant belong to corners, which are thin at their tip.
   pure real(dp) function wall_thickness(mesh, position, direction, depth) result(thickness)
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: position(2) !! the place, on the boundary of a body [L]
      real(dp), intent(in) :: direction(2) !! the way into it, a unit vector [-]
      real(dp), intent(in) :: depth !! how far to look [L]
      ! The surfaces that overlap themselves lie at both ends of the way; 0.906 is the cosine of 25 degrees.
      real(dp), parameter :: at_an_end = 1.0e-6_dp, aslant = 0.906_dp
      type(side_table_t) :: table
      real(dp) :: corner(2, 3), xi(2), values(3), slopes(3), way, along(2)
      integer :: overlapping(2), number, i, k

      thickness = huge(1.0_dp)
      call new_side_table(table, mesh, overlapping)
      do i = 1, table%n_sides
         number = table%boundary(i)
         if (number == 0) cycle
         associate (nodes => mesh%side(side_element(number), side_place(number)))
            corner(:, :2) = mesh%coordinates(:, nodes(:2))
            corner(:, 3) = 0.5_dp*(corner(:, 1) + corner(:, 2))
            if (nodes(3) > 0) corner(:, 3) = mesh%coordinates(:, nodes(3))
         end associate
         xi = meet_side(corner, position, direction)
         do k = 1, 2
            if (abs(xi(k)) > 1.0_dp) cycle
            call side_shapes(.true., xi(k), values, slopes)
            along = matmul(corner, slopes)
            way = dot_product(matmul(corner, values) - position, direction)
            if (way <= at_an_end*depth .or. way >= (1.0_dp - at_an_end)*depth) cycle
            if (abs(cross_product(along, direction)) > aslant*norm2(along)) thickness = min(thickness, way)
         end do
      end do
   end function wall_thickness

end module amontons_pair_refusals
