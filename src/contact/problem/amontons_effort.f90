!> The effort that a contact method has spent: products with matrices, and factorizations.
module amontons_effort
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: effort_t

   !> What has been spent. A product with a part of the matrix S or A counts by the size of the part, so does an update
   !> by a few of its columns; triangular solves are not counted.
   type :: effort_t
      real(dp) :: n_products = 0.0_dp !! products of S or A with a vector [-]
      integer :: n_factorizations = 0 !! factorizations of a dense or sparse matrix, of any order
   contains
      procedure :: add => effort_add
      procedure :: factorize => effort_factorize
      procedure :: multiply => effort_multiply
   end type effort_t

contains

   !> Adds the effort of a part of the way.
   pure subroutine effort_add(self, part)
      class(effort_t), intent(inout) :: self !! the effort
      type(effort_t), intent(in) :: part !! that of the part

      self%n_products = self%n_products + part%n_products
      self%n_factorizations = self%n_factorizations + part%n_factorizations
   end subroutine effort_add

   !> Counts a factorization, if there is one.
   pure subroutine effort_factorize(self, is_made)
      class(effort_t), intent(inout) :: self !! the effort
      logical, intent(in) :: is_made !! whether a matrix is factorized

      if (is_made) self%n_factorizations = self%n_factorizations + 1
   end subroutine effort_factorize

   !> Counts products.
   pure subroutine effort_multiply(self, n_products)
      class(effort_t), intent(inout) :: self !! the effort
      real(dp), intent(in) :: n_products !! how many products with the whole matrix they are worth [-]

      self%n_products = self%n_products + n_products
   end subroutine effort_multiply

end module amontons_effort
