!> What pairs of surfaces are refused for once their points are known.
module amontons_pair_checks
   use amontons_constraints, only: constraints_t
   use amontons_contact_rows, only: turned
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_listing_text, only: place_text, short_text
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_mortar_points, only: mortar_points_t
   implicit none (type, external)
   private

   public :: check_ends, check_overlap, held_slave_text

contains

   !> Refuses a side of the slave that has no multiplier at either end and faces a part of the master that may move
   !> along the normal, or, where shear may act, the same along the tangent: nothing would be transmitted there. Where
   !> earlier sets have both ends the side is taken to be theirs, unless that leaves no point.
   pure subroutine check_ends(pair, set, against, remedy, needs_shear, constraints, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair, its points corners
      character(*), intent(in) :: set !! name of the slave's set
      character(*), intent(in) :: against !! name of the master's set
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
               call new_error(error, input_refused, held_slave_text(set, against, &
                  pair%slave%corner(:, 3, pair%segments(i)%slave), merge('force', 'shear', &
                  abs(dot_product(axes(:, k), pair%slave%normal(:, 3, pair%segments(i)%slave))) > aslant), remedy))
               return
            end do
         end associate
      end do
      if (size(pair%node) == 0) call new_error(error, input_refused, "no node of '"//set//"' that faces '"// &
         against//"' is left: supports hold them, or they belong to earlier sets")
   end subroutine check_ends

   !> Says that a part of a slave has no displacements left that contact forces could act on.
   pure function held_slave_text(set, against, position, what, remedy) result(text)
      character(*), intent(in) :: set !! name of the slave's set
      character(*), intent(in) :: against !! name of the master's set
      real(dp), intent(in) :: position(2) !! where the part is [L]
      character(*), intent(in) :: what !! what cannot act: force or shear
      character(*), intent(in) :: remedy !! what to do about it
      character(:), allocatable :: text

      text = "supports hold the slave '"//set//"' at "//place_text(position)//': no '//what// &
         " could act between it and '"//against//"' there; "//remedy
   end function held_slave_text

   !> Refuses meshes that overlap by more than half of a side.
   pure subroutine check_overlap(pair, points, set, against, error)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      type(mortar_points_t), intent(in) :: points !! its integrals
      character(*), intent(in) :: set !! name of the slave's set
      character(*), intent(in) :: against !! name of the master's set
      type(error_t), allocatable, intent(out) :: error !! they do
      integer :: q

      if (size(points%quadrature%gap) == 0) return
      q = minloc(points%quadrature%gap, dim=1)
      if (points%quadrature%gap(q) >= -0.5_dp*pair%slave%longest) return
      call new_error(error, input_refused, "'"//set//"' and '"//against//"' overlap by up to "// &
         short_text(-points%quadrature%gap(q))//' before any load (side at '// &
         place_text(points%quadrature%position(:, q))//'), more than half a side: give extra_gap for an '// &
         "interference, or gap = 'touching'")
   end subroutine check_overlap

end module amontons_pair_checks
