!> Modified proportioning with reduced gradient projections (Dostal, Optimal Quadratic Programming Algorithms, 2009,
!> chapter 5): convex quadratic programs on a box with nothing but products.
!>
!> Conjugate gradients run on the components off their bounds; where a step would leave the box, it ends on the face it
!> meets and a projected gradient step of fixed length follows; where the gradient of the components held by their
!> bounds outweighs that of the others, these are let go. The variables are scaled to a unit diagonal, so that no unit
!> matters.
module amontons_mprgp
   use amontons_effort, only: effort_t
   use amontons_kinds, only: dp
   use amontons_symmetric_matrix, only: symmetric_matrix_t
   implicit none (type, external)
   private

   public :: box_violation, mprgp

   !> A program and the point that the way has come to, all scaled to a unit diagonal.
   type :: way_t
      real(dp), allocatable :: scale(:) !! what components are multiplied by to have their unit back (n)
      real(dp), allocatable :: linear(:) !! the linear term (n)
      real(dp), allocatable :: low(:) !! lower bounds (n)
      real(dp), allocatable :: high(:) !! upper bounds (n)
      real(dp), allocatable :: y(:) !! the point (n)
      real(dp), allocatable :: gradient(:) !! gradient of the objective there (n)
      real(dp), allocatable :: direction(:) !! conjugate direction, to be taken backwards (n)
      real(dp), allocatable :: image(:) !! product of the matrix with the direction measured last (n)
      real(dp) :: curvature = 0.0_dp !! of the objective along it
      integer :: n_products = 0 !! products done
      real(dp) :: norm = 1.0_dp !! largest curvature seen, per length squared
   end type way_t

contains

   !> Minimizes 1/2 x^T A x - b^T x on lower <= x <= upper from a starting point, for a part of the rows of A. If the
   !> program has no minimum (A singular and the box open there), the way ends where that is found.
   pure subroutine mprgp(a, rows, b, lower, upper, accuracy, x, effort)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix, positive semidefinite
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program, n in all
      real(dp), intent(in) :: b(:) !! the linear term (n)
      real(dp), intent(in) :: lower(:) !! lower bounds (n)
      real(dp), intent(in) :: upper(:) !! upper bounds, at least the lower ones (n)
      real(dp), intent(in) :: accuracy !! the `box_violation` that is small enough
      real(dp), intent(inout) :: x(:) !! where to start, and the minimizer (n)
      type(effort_t), intent(inout) :: effort !! gains that of the way
      type(way_t) :: way
      real(dp) :: face(size(b)), chopped(size(b))
      logical :: is_bounded
      integer :: step

      associate (rho => a%reciprocal_diagonal())
         way%scale = sqrt(rho(rows(1):rows(2)))
      end associate
      way%linear = way%scale*b
      ! A bound that is none must not overflow.
      way%low = max(lower, -huge(1.0_dp)*min(1.0_dp, way%scale))/way%scale
      way%high = min(upper, huge(1.0_dp)*min(1.0_dp, way%scale))/way%scale
      way%y = min(max(x/way%scale, way%low), way%high)
      way%gradient = product_of(a, rows, way%scale, way%y) - way%linear
      way%n_products = 1
      way%direction = free_part(way%y, way%gradient, way%low, way%high)
      do step = 1, 1000 + 10*size(b)
         if (violation_of(way) <= accuracy) then
            ! The gradient at hand was carried from step to step: believe a fresh one only.
            way%gradient = product_of(a, rows, way%scale, way%y) - way%linear
            way%n_products = way%n_products + 1
            if (violation_of(way) <= accuracy) exit
            way%direction = free_part(way%y, way%gradient, way%low, way%high)
         end if
         face = free_part(way%y, way%gradient, way%low, way%high)
         chopped = chopped_part(way%y, way%gradient, way%low, way%high)
         if (dot_product(chopped, chopped) <= &
            dot_product(reduced_part(way%y, face, way%low, way%high, way%norm), face)) then
            call take_step(a, rows, way, is_bounded)
         else
            way%direction = chopped
            call take_step(a, rows, way, is_bounded)
            way%direction = free_part(way%y, way%gradient, way%low, way%high)
         end if
         if (.not. is_bounded) exit
      end do
      call effort%multiply(way%n_products*(real(size(b), dp)/a%n)**2)
      x = min(max(way%scale*way%y, lower), upper)
   end subroutine mprgp

   !> Steps along the direction to the least objective, and makes the next direction conjugate; or to the end of the
   !> box, and expands the face met there.
   pure subroutine take_step(a, rows, way, is_bounded)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program
      type(way_t), intent(inout) :: way !! program and point
      logical, intent(out) :: is_bounded !! false if the objective falls without end; the point then stays
      real(dp) :: face(size(way%y)), length, room

      way%image = product_of(a, rows, way%scale, way%direction)
      way%n_products = way%n_products + 1
      way%curvature = dot_product(way%direction, way%image)
      way%norm = max(way%norm, norm2(way%image)/max(norm2(way%direction), tiny(1.0_dp)))
      length = huge(length)
      ! A curvature that rounding may have left is none.
      if (way%curvature > 10.0_dp*epsilon(1.0_dp)*way%norm*dot_product(way%direction, way%direction)) then
         length = dot_product(way%gradient, way%direction)/way%curvature
      end if
      room = least_room(way%y, way%direction, way%low, way%high)
      is_bounded = min(length, room) < huge(length)
      if (.not. is_bounded) return
      way%y = min(max(way%y - min(length, room)*way%direction, way%low), way%high)
      way%gradient = way%gradient - min(length, room)*way%image
      if (length <= room) then
         face = free_part(way%y, way%gradient, way%low, way%high)
         way%direction = face - dot_product(face, way%image)/way%curvature*way%direction
      else
         call expand(a, rows, way)
      end if
   end subroutine take_step

   !> A projected gradient step on the face at hand, as long as the largest curvature seen allows; a move that meets a
   !> larger one than twice that is taken anew.
   pure subroutine expand(a, rows, way)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program
      type(way_t), intent(inout) :: way !! program and point
      real(dp), dimension(size(way%y)) :: face, old, old_gradient, move
      real(dp) :: used

      face = free_part(way%y, way%gradient, way%low, way%high)
      old = way%y
      old_gradient = way%gradient
      do
         used = way%norm
         way%y = min(max(old - face/used, way%low), way%high)
         way%gradient = product_of(a, rows, way%scale, way%y) - way%linear
         way%n_products = way%n_products + 1
         move = way%y - old
         way%norm = max(way%norm, dot_product(move, way%gradient - old_gradient)/ &
            max(dot_product(move, move), tiny(1.0_dp)))
         if (.not. way%norm > 2.0_dp*used) exit
      end do
      way%direction = free_part(way%y, way%gradient, way%low, way%high)
   end subroutine expand

   !> The product of the matrix, scaled to a unit diagonal, with a vector (n).
   pure function product_of(a, rows, scale, vector) result(product)
      type(symmetric_matrix_t), intent(in) :: a !! the matrix
      integer, intent(in) :: rows(2) !! the first and the last of its rows in the program
      real(dp), intent(in) :: scale(:) !! the scales (n)
      real(dp), intent(in) :: vector(:) !! the vector (n)
      real(dp) :: product(size(vector))

      call a%part_multiply(rows, rows, scale*vector, product)
      product = scale*product
   end function product_of

   !> The violation of the point at hand.
   pure real(dp) function violation_of(way)
      type(way_t), intent(in) :: way !! program and point

      violation_of = box_violation(way%y, way%gradient, way%low, way%high, way%scale)
   end function violation_of

   !> How far a point is from the minimizer: the largest move of a component that a step down its own parabola makes.
   pure real(dp) function box_violation(y, gradient, low, high, scale) result(violation)
      real(dp), intent(in) :: y(:) !! the point, scaled to a unit diagonal (n)
      real(dp), intent(in) :: gradient(:) !! the gradient there (n)
      real(dp), intent(in) :: low(:) !! lower bounds (n)
      real(dp), intent(in) :: high(:) !! upper bounds (n)
      real(dp), intent(in) :: scale(:) !! what scaled components are multiplied by (n)

      violation = 0.0_dp
      if (size(y) > 0) violation = maxval(scale*abs(y - min(max(y - gradient, low), high)))
   end function box_violation

   !> The gradient of the components off their bounds.
   elemental real(dp) function free_part(y, gradient, low, high)
      real(dp), intent(in) :: y !! the component
      real(dp), intent(in) :: gradient !! derivative of the objective
      real(dp), intent(in) :: low !! lower bound
      real(dp), intent(in) :: high !! upper bound

      free_part = merge(gradient, 0.0_dp, y > low .and. y < high)
   end function free_part

   !> The gradient of the components that would leave their bound inwards.
   elemental real(dp) function chopped_part(y, gradient, low, high)
      real(dp), intent(in) :: y !! the component
      real(dp), intent(in) :: gradient !! derivative of the objective
      real(dp), intent(in) :: low !! lower bound
      real(dp), intent(in) :: high !! upper bound

      chopped_part = 0.0_dp
      if (y <= low .and. y < high) chopped_part = min(0.0_dp, gradient)
      if (y >= high .and. y > low) chopped_part = max(0.0_dp, gradient)
   end function chopped_part

   !> The free gradient, as far as a step of length 1/norm against it stays in the box.
   elemental real(dp) function reduced_part(y, face, low, high, norm)
      real(dp), intent(in) :: y !! the component
      real(dp), intent(in) :: face !! its free gradient
      real(dp), intent(in) :: low !! lower bound
      real(dp), intent(in) :: high !! upper bound
      real(dp), intent(in) :: norm !! largest curvature seen

      reduced_part = face
      if (face > 0.0_dp) reduced_part = min(face, norm*min(y - low, huge(y)/norm))
      if (face < 0.0_dp) reduced_part = max(face, norm*max(y - high, -huge(y)/norm))
   end function reduced_part

   !> The longest step against a direction that stays in the box; the largest number if none ends it.
   pure real(dp) function least_room(y, along, low, high) result(room)
      real(dp), intent(in) :: y(:) !! the point (n)
      real(dp), intent(in) :: along(:) !! the direction (n)
      real(dp), intent(in) :: low(:) !! lower bounds (n)
      real(dp), intent(in) :: high(:) !! upper bounds (n)
      ! A bound beyond this was not meant as one.
      real(dp), parameter :: far = sqrt(huge(1.0_dp))
      integer :: i

      room = huge(room)
      do i = 1, size(y)
         if (along(i) > 0.0_dp .and. low(i) > -far) room = min(room, (y(i) - low(i))/along(i))
         if (along(i) < 0.0_dp .and. high(i) < far) room = min(room, (y(i) - high(i))/along(i))
      end do
   end function least_room

end module amontons_mprgp
