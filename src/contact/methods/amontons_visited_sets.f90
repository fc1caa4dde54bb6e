!> The active sets that Newton's steps have been at, so that they do not go around in a circle.
!>
!> A step may change the states of many points at once, and the next one change them back. Where a step would return to
!> an active set, it changes the state of one point alone, the last one that leads to a new active set (after Murty's
!> principal pivoting, which changes the last index that is infeasible and ends for every P-matrix).
module amontons_visited_sets
   use amontons_active_set, only: active_set_t
   use amontons_kinds, only: dp, int64
   implicit none (type, external)
   private

   public :: visited_sets_t

   !> Active sets since the residual last fell.
   type :: visited_sets_t
      private
      integer(int64), allocatable :: key(:) !! a number for each of them
      real(dp) :: residual = huge(1.0_dp) !! the least residual so far [-]
   contains
      procedure :: avoid => visited_sets_avoid
      procedure :: note_residual => visited_sets_note_residual
   end type visited_sets_t

contains

   !> Forgets the active sets where the residual falls: what leads on is no circle.
   pure subroutine visited_sets_note_residual(self, residual)
      class(visited_sets_t), intent(inout) :: self !! the active sets
      real(dp), intent(in) :: residual !! residual after a step [-]
      real(dp), parameter :: decrease = 0.9_dp

      if (allocated(self%key) .and. .not. residual < decrease*self%residual) return
      self%residual = min(residual, self%residual)
      if (allocated(self%key)) deallocate (self%key)
      allocate (self%key(0))
   end subroutine visited_sets_note_residual

   !> Adds the active set that a step leads to; changes it if it is there already. If the change of no single point
   !> leads to a new one, it stays: the regularization has to lead on then.
   pure subroutine visited_sets_avoid(self, active_set, last, is_repeated)
      class(visited_sets_t), intent(inout) :: self !! the active sets
      type(active_set_t), intent(inout) :: active_set !! the active set that a step leads to
      type(active_set_t), intent(in) :: last !! the active set before it
      logical, intent(out) :: is_repeated !! whether it is there already
      type(active_set_t) :: trial
      integer :: p

      is_repeated = .false.
      if (active_set%equals(last)) return
      is_repeated = any(self%key == key_of(active_set))
      if (is_repeated) then
         do p = size(last%is_closed), 1, -1
            trial = last
            trial%is_closed(p) = active_set%is_closed(p)
            trial%slip_direction(p) = active_set%slip_direction(p)
            if (trial%equals(last)) cycle
            if (all(self%key /= key_of(trial))) exit
            ! The way from one direction of slip to the other leads through sticking.
            if (trial%slip_direction(p)*last%slip_direction(p) >= 0) cycle
            trial%slip_direction(p) = 0
            if (all(self%key /= key_of(trial))) exit
         end do
         if (p > 0) active_set = trial
      end if
      self%key = [self%key, key_of(active_set)]
   end subroutine visited_sets_avoid

   !> A number that tells active sets apart, all but surely.
   pure integer(int64) function key_of(active_set) result(key)
      type(active_set_t), intent(in) :: active_set !! the active set
      integer(int64), parameter :: factor = 8121341234567_int64
      integer :: p

      key = 0
      do p = 1, size(active_set%is_closed)
         associate (state => active_set%slip_direction(p) + merge(2, 5, active_set%is_closed(p)))
            key = ieor(ishftc(key, 7), factor*state + p)
         end associate
      end do
   end function key_of

end module amontons_visited_sets
