!> Whether the bodies of a pair overlap by more than an interference fit does.
module amontons_pair_overlap
   use amontons_element, only: side_shapes
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face, only: place_side
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t, outer_sides, side_element, side_place
   use amontons_mortar_pair, only: mortar_pair_t, mortar_points_t
   use amontons_obstacle, only: cross_product
   use amontons_rounding, only: exceeds, first_largest, input_rounding
   use amontons_surface, only: meet_side
   use amontons_text, only: place_text, short_text
   implicit none (type, external)
   private

   public :: check_overlap

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

end module amontons_pair_overlap
