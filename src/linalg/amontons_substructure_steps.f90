!> The steps of a substitution through substructures: forward from the parts to the top, backward from it.
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
      real(dp), contiguous, intent(inout) :: gain(:) !! what the boundaries gain
      integer :: i, part

      if (.not. substructures%is_large(k)) then
         do i = substructures%first_below(k), k
            call step_forward(substructures, value, i, n_steps, y, gain)
         end do
         return
      end if
      do i = 1, 2
         part = substructures%part(i, k)
         if (part == 0) cycle
         !$omp task default(none) shared(substructures, value, n_steps, y, gain) firstprivate(part)
         call go_forward(substructures, value, part, n_steps, y, gain)
         !$omp end task
      end do
      !$omp taskwait
      call step_forward(substructures, value, k, n_steps, y, gain)
   end subroutine go_forward

   !> Does the forward steps of one substructure.
   subroutine step_forward(substructures, value, k, n_steps, y, gain)
      type(substructures_t), intent(in) :: substructures !! the substructures
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the substructure
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), contiguous, intent(inout) :: gain(:) !! what the boundaries gain
      real(dp) :: x(substructures%n_rows(k))
      integer(int64) :: at
      integer :: i, part

      associate (n_own => substructures%n_own(k), first => substructures%first(k), &
         start => substructures%boundary_start)
         x(:n_own) = y(first:first + n_own - 1)
         x(n_own + 1:) = 0.0_dp
         do i = 1, 2
            part = substructures%part(i, k)
            if (part == 0) cycle
            do at = start(part), start(part + 1) - 1
               x(substructures%place(at)) = x(substructures%place(at)) + gain(at)
            end do
         end do
         call forward_columns(size(x), min(n_own, n_steps - first + 1), value(substructures%block_start(k):), x)
         y(first:first + n_own - 1) = x(:n_own)
         gain(start(k):start(k + 1) - 1) = x(n_own + 1:)
      end associate
   end subroutine step_forward

   !> Does the backward steps of a substructure, and then those of its parts.
   recursive subroutine go_backward(substructures, value, k, n_steps, y, known)
      type(substructures_t), intent(in) :: substructures !! the substructures
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the substructure
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), contiguous, intent(inout) :: known(:) !! the vector on the boundaries
      integer :: i, part

      if (.not. substructures%is_large(k)) then
         do i = k, substructures%first_below(k), -1
            call step_backward(substructures, value, i, n_steps, y, known)
         end do
         return
      end if
      call step_backward(substructures, value, k, n_steps, y, known)
      do i = 1, 2
         part = substructures%part(i, k)
         if (part == 0) cycle
         !$omp task default(none) shared(substructures, value, n_steps, y, known) firstprivate(part)
         call go_backward(substructures, value, part, n_steps, y, known)
         !$omp end task
      end do
      !$omp taskwait
   end subroutine go_backward

   !> Does the backward steps of one substructure.
   subroutine step_backward(substructures, value, k, n_steps, y, known)
      type(substructures_t), intent(in) :: substructures !! the substructures
      real(dp), contiguous, intent(in) :: value(:) !! their blocks
      integer, intent(in) :: k !! number of the substructure
      integer, intent(in) :: n_steps !! how many columns
      real(dp), contiguous, intent(inout) :: y(:) !! the vector by position
      real(dp), contiguous, intent(inout) :: known(:) !! the vector on the boundaries
      real(dp) :: x(substructures%n_rows(k))
      integer :: i, part

      associate (n_own => substructures%n_own(k), first => substructures%first(k), &
         start => substructures%boundary_start)
         x(:n_own) = y(first:first + n_own - 1)
         x(n_own + 1:) = known(start(k):start(k + 1) - 1)
         call backward_columns(size(x), min(n_own, n_steps - first + 1), value(substructures%block_start(k):), x)
         y(first:first + n_own - 1) = x(:n_own)
         do i = 1, 2
            part = substructures%part(i, k)
            if (part > 0) known(start(part):start(part + 1) - 1) = &
               x(substructures%place(start(part):start(part + 1) - 1))
         end do
      end associate
   end subroutine step_backward

end module amontons_substructure_steps
