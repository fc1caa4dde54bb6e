!> The steps of a substitution through fronts: forward from the leaves to the root, backward from it.
!>
!> What a front hands to its parent, a number for each item of its row structure, waits on a stack: in the order of
!> elimination the children of a front are the last that have put something there. Large subtrees, on threads of their
!> own, have stacks of their own.
module amontons_front_substitution
   use amontons_fronts, only: fronts_t
   use amontons_kinds, only: dp, int64
   use amontons_supernode, only: backward_columns, forward_columns
   implicit none (type, external)
   private

   public :: backward_subtree, forward_subtree

contains

   !> Does the forward steps of a front, those of its descendants first.
   recursive subroutine forward_subtree(fronts, value, k, n_steps, y, gain)
      type(fronts_t), intent(in) :: fronts !! the fronts
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), contiguous, intent(out) :: gain(:) !! what its row structure gains (n_structure)
      real(dp) :: stack(fronts%stack_size(k))
      integer :: i, middle, top

      top = 0
      if (fronts%is_large(k)) then
         associate (child => fronts%child(:, k))
            middle = fronts%n_structure(child(1))
            top = middle + fronts%n_structure(child(2))
            if (child(1) > 0) then
               !$omp task default(none) shared(fronts, value, n_steps, y, stack, k, middle)
               call forward_subtree(fronts, value, fronts%child(1, k), n_steps, y, stack(:middle))
               !$omp end task
            end if
            if (child(2) > 0) call forward_subtree(fronts, value, child(2), n_steps, y, stack(middle + 1:top))
            !$omp taskwait
         end associate
      else
         do i = fronts%first_descendant(k), k - 1
            call forward_front(fronts, value, i, n_steps, y, stack, top)
         end do
      end if
      call forward_front(fronts, value, k, n_steps, y, stack, top)
      gain = stack(:top)
   end subroutine forward_subtree

   !> Does the forward steps of one front.
   subroutine forward_front(fronts, value, k, n_steps, y, stack, top)
      type(fronts_t), intent(in) :: fronts !! the fronts
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), intent(inout) :: stack(:) !! what row structures gain: that of its children is replaced by its own
      integer, intent(inout) :: top !! how much of the stack is in use
      real(dp) :: x(fronts%n_rows(k))
      integer(int64) :: at
      integer :: i, from

      associate (n_pivots => fronts%n_pivots(k), first => fronts%first(k), child => fronts%child(:, k))
         x(:n_pivots) = y(first:first + n_pivots - 1)
         x(n_pivots + 1:) = 0.0_dp
         top = top - sum(fronts%n_structure(child))
         from = top
         do i = 1, 2
            if (child(i) == 0) cycle
            do at = fronts%structure_start(child(i)), fronts%structure_start(child(i) + 1) - 1
               from = from + 1
               x(fronts%parent_row(at)) = x(fronts%parent_row(at)) + stack(from)
            end do
         end do
         ! Most loads are on the boundary: of many fronts inside the body nothing is left to do.
         if (.not. all(abs(x(:n_pivots)) <= 0.0_dp)) then
            call forward_columns(size(x), min(n_pivots, n_steps - first + 1), value(fronts%block_start(k):), x)
            y(first:first + n_pivots - 1) = x(:n_pivots)
         end if
         stack(top + 1:top + size(x) - n_pivots) = x(n_pivots + 1:)
         top = top + size(x) - n_pivots
      end associate
   end subroutine forward_front

   !> Does the backward steps of a front, and then those of its descendants, for several vectors at once.
   recursive subroutine backward_subtree(fronts, value, k, n_steps, y, known)
      type(fronts_t), intent(in) :: fronts !! the fronts
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)
      real(dp), contiguous, intent(in) :: known(:, :) !! the vectors on the row structure (vectors, n_structure)
      real(dp) :: stack(size(y, 2), fronts%stack_size(k))
      integer :: i, middle, top

      top = size(known, 2)
      stack(:, :top) = known
      call backward_front(fronts, value, k, n_steps, y, stack, top)
      if (fronts%is_large(k)) then
         associate (child => fronts%child(:, k))
            middle = fronts%n_structure(child(1))
            if (child(1) > 0) then
               !$omp task default(none) shared(fronts, value, n_steps, y, stack, k, middle)
               call backward_subtree(fronts, value, fronts%child(1, k), n_steps, y, stack(:, :middle))
               !$omp end task
            end if
            if (child(2) > 0) call backward_subtree(fronts, value, child(2), n_steps, y, stack(:, middle + 1:top))
            !$omp taskwait
         end associate
      else
         do i = k - 1, fronts%first_descendant(k), -1
            call backward_front(fronts, value, i, n_steps, y, stack, top)
         end do
      end if
   end subroutine backward_subtree

   !> Does the backward steps of one front.
   subroutine backward_front(fronts, value, k, n_steps, y, stack, top)
      type(fronts_t), intent(in) :: fronts !! the fronts
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the front
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:, :) !! the vectors by position (n, vectors)
      real(dp), intent(inout) :: stack(:, :)
         !! the vectors on row structures: its own is replaced by those of its children (vectors, any)
      integer, intent(inout) :: top !! how much of the stack is in use
      real(dp) :: x(fronts%n_rows(k), size(y, 2))
      integer(int64) :: at
      integer :: i, v

      associate (n_pivots => fronts%n_pivots(k), first => fronts%first(k), child => fronts%child(:, k))
         top = top - (size(x, 1) - n_pivots)
         do v = 1, size(y, 2)
            x(:n_pivots, v) = y(first:first + n_pivots - 1, v)
            x(n_pivots + 1:, v) = stack(v, top + 1:top + size(x, 1) - n_pivots)
         end do
         call backward_columns(size(x, 1), min(n_pivots, n_steps - first + 1), size(y, 2), &
            value(fronts%block_start(k):), x)
         do v = 1, size(y, 2)
            y(first:first + n_pivots - 1, v) = x(:n_pivots, v)
         end do
         do i = 1, 2
            if (child(i) == 0) cycle
            do at = fronts%structure_start(child(i)), fronts%structure_start(child(i) + 1) - 1
               top = top + 1
               stack(:, top) = x(fronts%parent_row(at), :)
            end do
         end do
      end associate
   end subroutine backward_front

end module amontons_front_substitution
