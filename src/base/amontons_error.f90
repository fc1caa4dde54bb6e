!> The error value: what a procedure hands back when it cannot do its work.
!>
!> A procedure that can fail ends its argument list with `type(error_t), allocatable, intent(out) :: error`.
!> Allocated means failed, and the caller returns at once.
module amontons_error
   implicit none (type, external)
   private

   public :: error_t, new_error, input_refused, numerical_failure, system_failure

   !> The input is at fault: a deck, a mesh, an argument.
   integer, parameter :: input_refused = 1
   !> The numbers are at fault: a matrix is not positive definite, no contact forces balance the loads.
   integer, parameter :: numerical_failure = 2
   !> The machine is at fault: a file cannot be written, memory ran out.
   integer, parameter :: system_failure = 3

   !> A failure, told in the user's words.
   type :: error_t
      integer :: kind = system_failure
         !! Whose fault it is: `input_refused`, `numerical_failure` or `system_failure`; also the program's exit status.
      character(:), allocatable :: message !! What, where and what was expected; several faults stand on several lines.
   end type error_t

contains

   !> Makes an error value.
   pure subroutine new_error(error, kind, message)
      type(error_t), allocatable, intent(out) :: error !! the error, allocated on return
      integer, intent(in) :: kind !! `input_refused`, `numerical_failure` or `system_failure`
      character(*), intent(in) :: message !! what, where, what was expected

      allocate (error)
      error%kind = kind
      error%message = message
   end subroutine new_error

end module amontons_error
