!> The pairs of surfaces that are bonded.
module amontons_tied_pairs
   use amontons_constraints, only: constraints_t
   use amontons_contact_set, only: pairing_t, tie_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_mortar_pair, only: mortar_pair_t, new_mortar_pair, take_facing_sides
   use amontons_pair_refusals, only: check_ends
   use amontons_surface, only: meshed_body_t
   implicit none (type, external)
   private

   public :: new_tied_pairs

contains

   !> Finds where the bonded boundary sets face each other.
   subroutine new_tied_pairs(pairs, follower, ties, body, error)
      type(mortar_pair_t), allocatable, intent(out) :: pairs(:) !! the pair of each tie
      integer, intent(inout) :: follower(:)
         !! the nodes of slaves, see `amontons_mortar_pair`; gains those of the ties (nodes)
      type(tie_t), intent(in) :: ties(:) !! the ties
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(error_t), allocatable, intent(out) :: error !! as of `new_mortar_pair`
      type(pairing_t) :: pairing
      integer :: i

      allocate (pairs(size(ties)))
      pairing%is_tied = .true.
      do i = 1, size(ties)
         pairing%against = ties(i)%to
         pairing%search = ties(i)%search
         call new_mortar_pair(pairs(i), ties(i)%set, pairing, body, follower, error)
         if (.not. allocated(error)) call follow_guides(pairs(i), body%constraints)
         if (.not. allocated(error)) call check_ends(pairs(i), 'exchange set and to', .true., &
            body%constraints, error)
         if (allocated(error)) error%message = ties(i)%origin//error%message
         if (allocated(error)) return
         call take_facing_sides(follower, pairs(i))
      end do
   end subroutine new_tied_pairs

   !> Counts displacements of bonded points that supports guide, and those of their neighbors, along the guide and
   !> across it, in the place of normal and tangent.
   pure subroutine follow_guides(pair, constraints)
      type(mortar_pair_t), intent(inout) :: pair !! the pair, with its points
      type(constraints_t), intent(in) :: constraints !! the supports
      real(dp) :: frame(2, 2)
      integer :: p, i, k

      do p = 1, size(pair%node)
         if (.not. pair%is_tangent_fixed(p)) cycle
         frame = constraints%frame(pair%node(p))
         pair%normal(:, p) = merge(frame(:, 1), frame(:, 2), constraints%is_free(1, pair%node(p)))
         do i = 1, size(pair%point_of, 2)
            do k = 1, 2
               if (pair%point_of(k, i) /= p .or. pair%point_of(3 - k, i) == 0) cycle
               if (.not. pair%is_tangent_fixed(pair%point_of(3 - k, i))) pair%normal(:, pair%point_of(3 - k, i)) = &
                  pair%normal(:, p)
            end do
         end do
      end do
   end subroutine follow_guides

end module amontons_tied_pairs
