!> What another rank does for a room above this one: it follows the orders that are not for a condenser.
module amontons_rank_service
   implicit none (type, external)
   private

   public :: first_service_order, rank_service_t

   !> The orders of a service count from here.
   integer, parameter :: first_service_order = 100

   !> A service of the ranks besides rank 0.
   type, abstract :: rank_service_t
   contains
      procedure(follow_procedure), deferred :: follow
   end type rank_service_t

   abstract interface
      !> Follows an order of rank 0.
      subroutine follow_procedure(self, order)
         import :: rank_service_t
         implicit none (type, external)
         class(rank_service_t), intent(inout) :: self !! the service
         integer, intent(in) :: order !! the order, `first_service_order` or above
      end subroutine follow_procedure
   end interface

end module amontons_rank_service
