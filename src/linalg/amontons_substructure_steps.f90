!> The steps of a substitution through substructures: forward from the parts to the top, backward from it.
!>
!> What a substructure hands to the next one, on its boundary, waits on a stack: in the order of elimination the parts
!> of a substructure are the last that have put something there. Large parts, on threads of their own, have own stacks.
module amontons_substructure_steps
   use amontons_kinds, only: dp, int64
   use amontons_substructures, only: substructures_t
   use amontons_supernode, only: backward_columns, forward_columns
   implicit none (type, external)
   private

   public :: go_backward, go_forward

contains

   !> Does the forward steps of a substructure, those of its parts first.
   recursive subroutine go_forward(substructures, value, k, n_steps, y, gain)
      type(substructures_t), intent(in) :: substructures !! the substructures
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the substructure
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), contiguous, intent(out) :: gain(:) !! what its boundary gains (n_boundary)
      real(dp) :: stack(substructures%n_waiting(k))
      integer :: i, middle, top

      top = 0
      if (substructures%is_large(k)) then
         associate (part => substructures%part(:, k))
            middle = substructures%n_boundary(part(1))
            top = middle + substructures%n_boundary(part(2))
            if (part(1) > 0) then
               !$omp task default(none) shared(substructures, value, n_steps, y, stack, k, middle)
               call go_forward(substructures, value, substructures%part(1, k), n_steps, y, stack(:middle))
               !$omp end task
            end if
            if (part(2) > 0) call go_forward(substructures, value, part(2), n_steps, y, stack(middle + 1:top))
            !$omp taskwait
         end associate
      else
         do i = substructures%first_below(k), k - 1
            call step_forward(substructures, value, i, n_steps, y, stack, top)
         end do
      end if
      call step_forward(substructures, value, k, n_steps, y, stack, top)
      gain = stack(:top)
   end subroutine go_forward

   !> Does the forward steps of one substructure.
   subroutine step_forward(substructures, value, k, n_steps, y, stack, top)
      type(substructures_t), intent(in) :: substructures !! the substructures
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the substructure
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), intent(inout) :: stack(:) !! what boundaries gain: that of its parts is replaced by its own
      integer, intent(inout) :: top !! how much of the stack is in use
      real(dp) :: x(substructures%n_rows(k))
      integer(int64) :: at
      integer :: i, from

      associate (n_own => substructures%n_own(k), first => substructures%first(k), part => substructures%part(:, k))
         x(:n_own) = y(first:first + n_own - 1)
         x(n_own + 1:) = 0.0_dp
         top = top - sum(substructures%n_boundary(part))
         from = top
         do i = 1, 2
            if (part(i) == 0) cycle
            do at = substructures%boundary_start(part(i)), substructures%boundary_start(part(i) + 1) - 1
               from = from + 1
               x(substructures%place(at)) = x(substructures%place(at)) + stack(from)
            end do
         end do
         call forward_columns(size(x), min(n_own, n_steps - first + 1), value(substructures%block_start(k):), x)
         y(first:first + n_own - 1) = x(:n_own)
         stack(top + 1:top + size(x) - n_own) = x(n_own + 1:)
         top = top + size(x) - n_own
      end associate
   end subroutine step_forward

   !> Does the backward steps of a substructure, and then those of its parts.
   recursive subroutine go_backward(substructures, value, k, n_steps, y, known)
      type(substructures_t), intent(in) :: substructures !! the substructures
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the substructure
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), contiguous, intent(in) :: known(:) !! the vector on the boundary (n_boundary)
      real(dp) :: stack(substructures%n_waiting(k))
      integer :: i, middle, top

      top = size(known)
      stack(:top) = known
      call step_backward(substructures, value, k, n_steps, y, stack, top)
      if (substructures%is_large(k)) then
         associate (part => substructures%part(:, k))
            middle = substructures%n_boundary(part(1))
            if (part(1) > 0) then
               !$omp task default(none) shared(substructures, value, n_steps, y, stack, k, middle)
               call go_backward(substructures, value, substructures%part(1, k), n_steps, y, stack(:middle))
               !$omp end task
            end if
            if (part(2) > 0) call go_backward(substructures, value, part(2), n_steps, y, stack(middle + 1:top))
            !$omp taskwait
         end associate
      else
         do i = k - 1, substructures%first_below(k), -1
            call step_backward(substructures, value, i, n_steps, y, stack, top)
         end do
      end if
   end subroutine go_backward

   !> Does the backward steps of one substructure.
   subroutine step_backward(substructures, value, k, n_steps, y, stack, top)
      type(substructures_t), intent(in) :: substructures !! the substructures
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the substructure
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), intent(inout) :: stack(:) !! the vector on boundaries: that on its own is replaced by those of its parts
      integer, intent(inout) :: top !! how much of the stack is in use
      real(dp) :: x(substructures%n_rows(k))
      integer(int64) :: at
      integer :: i

      associate (n_own => substructures%n_own(k), first => substructures%first(k), part => substructures%part(:, k))
         top = top - (size(x) - n_own)
         x(:n_own) = y(first:first + n_own - 1)
         x(n_own + 1:) = stack(top + 1:top + size(x) - n_own)
         call backward_columns(size(x), min(n_own, n_steps - first + 1), value(substructures%block_start(k):), x)
         y(first:first + n_own - 1) = x(:n_own)
         do i = 1, 2
            if (part(i) == 0) cycle
            do at = substructures%boundary_start(part(i)), substructures%boundary_start(part(i) + 1) - 1
               top = top + 1
               stack(top) = x(substructures%place(at))
            end do
         end do
      end associate
   end subroutine step_backward

end module amontons_substructure_steps
