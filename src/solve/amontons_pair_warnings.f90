!> What is doubtful about pairs of bodies before they are solved.
module amontons_pair_warnings
   use amontons_kinds, only: dp
   use amontons_listing_text, only: short_text
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_surface, only: surface_t
   use amontons_text, only: counted, to_text
   use amontons_warning_list, only: warning_list_t
   implicit none (type, external)
   private

   public :: add_gap_warnings, add_idle_sides, add_pair_warnings, mean_length

contains

   !> Adds the warnings on a pair, in contact or bonded.
   pure subroutine add_pair_warnings(warnings, pair)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(mortar_pair_t), intent(in) :: pair !! the pair
      ! Sides of the slave that are longer than the master's by this factor spoil the contact.
      real(dp), parameter :: coarse = 1.5_dp
      character(:), allocatable :: name
      real(dp) :: lengths(2), depths(2)

      name = pair%label//': '
      if (size(pair%open_node) > 0) call warnings%add(name//'left open: '// &
         counted(size(pair%open_node), 'node')//' of the slave, without a master within '// &
         warnings%number(pair%search, 'L'))
      if (pair%sliver_side > 0) then
         associate (at => pair%slave%corner(:, 3, pair%sliver_side))
            call warnings%add(name//'the side at '//warnings%place(at)//' is covered to '// &
               short_text(pair%sliver_share)//' of its length; it is left out')
         end associate
      end if
      call add_idle_sides(warnings, name, pair%idle_side)
      lengths = [mean_length(pair%slave), mean_length(pair%master)]
      if (lengths(1) > coarse*lengths(2)) call warnings%add(name//'the slave is coarser than the master (sides '// &
         short_text(lengths(1))//' against '//warnings%number(lengths(2), 'L')//'): exchange both sets for a '// &
         'sharper contact')
      depths = [pair%slave%material(1)%thickness, pair%master%material(1)%thickness]
      if (.not. pair%slave%material(1)%is_plane_stress) return
      if (abs(depths(1) - depths(2)) > epsilon(1.0_dp)*depths(1)) call warnings%add(name//'the thicknesses differ ('// &
         short_text(depths(1))//', '//warnings%number(depths(2), 'L')//'): forces are matched, stresses '// &
         'are those of the slave')
   end subroutine add_pair_warnings

   !> Warns of sides that earlier sets leave without a point.
   pure subroutine add_idle_sides(warnings, name, places)
      type(warning_list_t), intent(inout) :: warnings !! gains the warning
      character(*), intent(in) :: name !! how the warning begins
      real(dp), intent(in) :: places(:, :) !! middles of the sides (2, sides) [L]

      if (size(places, 2) > 0) call warnings%add(name//'nothing acts on '//counted(size(places, 2), 'side')// &
         ', the first at '//warnings%place(places(:, 1))//': both ends belong to ties or to contact sets named '// &
         'before; refine the mesh there, or name this set first')
   end subroutine add_idle_sides

   !> Adds the warnings on the gaps that the meshes of a pair in contact have.
   pure subroutine add_gap_warnings(warnings, pair, gap, extra_gap)
      type(warning_list_t), intent(inout) :: warnings !! gains the warnings
      type(mortar_pair_t), intent(in) :: pair !! the pair
      real(dp), intent(in) :: gap(:) !! gaps of its points, with what the deck adds [L]
      real(dp), intent(in) :: extra_gap !! what the deck adds [L]
      ! What the digits of mesh files leave of a gap of 0, over the longest side.
      real(dp), parameter :: rounding = 1.0e-6_dp
      ! Gaps larger than the bulge of sides by this factor are well resolved.
      real(dp), parameter :: resolved = 10.0_dp
      character(:), allocatable :: name
      real(dp) :: bulge, overlap

      if (size(gap) == 0) return
      name = pair%label//': '
      bulge = largest_bulge(pair%slave) + largest_bulge(pair%master)
      overlap = maxval(extra_gap - gap)
      if (bulge > rounding*pair%slave%longest .and. maxval(abs(gap)) < resolved*bulge) then
         call warnings%add(name//'gaps and interference of up to '// &
            warnings%number(maxval(abs(gap)), 'L')//' are not much larger than the distance between the two '// &
            'polygons ('//warnings%number(bulge, 'L')//"): refine, use quadratic elements, or gap = 'touching'")
      else if (overlap > rounding*pair%slave%longest) then
         call warnings%add(name//'the meshes overlap by up to '// &
            warnings%number(overlap, 'L')//' before any load: give '// &
            "extra_gap for an interference, or gap = 'touching'")
      end if
   end subroutine add_gap_warnings

   !> Mean length of the sides of a surface [L].
   pure real(dp) function mean_length(surface)
      type(surface_t), intent(in) :: surface !! the surface

      mean_length = sum(norm2(surface%corner(:, 2, :) - surface%corner(:, 1, :), dim=1))/surface%n_sides
   end function mean_length

   !> How far the curve that straight sides stand for bulges out of them at most: their length times the angle between
   !> the normals at both ends, over 8. Curved sides follow it [L].
   pure real(dp) function largest_bulge(surface) result(bulge)
      type(surface_t), intent(in) :: surface !! the surface
      integer :: i

      bulge = 0.0_dp
      do i = 1, surface%n_sides
         if (surface%side(3, i) > 0) cycle
         bulge = max(bulge, norm2(surface%corner(:, 2, i) - surface%corner(:, 1, i)) &
            *norm2(surface%normal(:, 2, i) - surface%normal(:, 1, i))/8.0_dp)
      end do
   end function largest_bulge

end module amontons_pair_warnings
