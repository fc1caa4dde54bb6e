!> The coordinates of a patch of elements, in which a polynomial is fitted to their stresses, and its terms.
module amontons_patch_frame
   use amontons_element, only: n_corners
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: far_weight, find_terms, frame_t, is_linear, max_terms, n_kind_terms, place_patch, samples_t, solve_normal

   !> Terms of the largest polynomial: 1, x, y, x^2, x y, y^2, x^2 y, x y^2, x^2 y^2.
   integer, parameter :: max_terms = 9
   !> Terms of the polynomial of each kind of element: linear; quadratic, of quadrilaterals in x and in y.
   integer, parameter :: n_kind_terms(*) = [3, 3, 6, 9, 9]

   !> Weight of a sample of the elements that a patch grew by: far samples determine what near ones leave open, no more.
   real(dp), parameter :: far_weight = 0.1_dp

   !> Least pivot for each sample. Those of a regular patch leave a few hundredths, a row too few of them leaves 0.
   real(dp), parameter :: least_pivot = 1.0e-4_dp

   !> Coordinates of a patch in which its nodes spread alike in all directions, and along which the sides of its
   !> elements lie where the terms depend on that: neither slender nor turned elements need another treatment. Where the
   !> polynomial is linear, they spread the samples so: the normal matrix is a multiple of the identity.
   type :: frame_t
      real(dp) :: center(2) = 0.0_dp !! mean of the points that are spread [L]
      real(dp) :: scale(2, 2) = 0.0_dp !! what the distance from there is multiplied by [1/L]
      integer :: n_terms = 1 !! terms of the polynomial
   end type frame_t

   !> The points of the elements where their stresses are most accurate.
   type :: samples_t
      integer, allocatable :: start(:) !! where the samples of an element begin (n_elements + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (2, n_samples) [L]
   end type samples_t

   !> Moments of points about one of them.
   type :: moments_t
      real(dp) :: origin(2) = 0.0_dp !! the point [L]
      real(dp) :: weight = 0.0_dp !! sum of the weights [-]
      real(dp) :: first(2) = 0.0_dp !! of the distances along x and y [L]
      real(dp) :: second(3) = 0.0_dp !! of their products xx, xy, yy [L^2]
   contains
      procedure :: add => moments_add
      procedure :: covariance => moments_covariance
   end type moments_t

contains

   !> Whether a polynomial has no terms of the second order.
   elemental logical function is_linear(frame)
      type(frame_t), intent(in) :: frame !! coordinates and terms of its patch

      is_linear = frame%n_terms <= 3
   end function is_linear

   !> Sets the coordinates of a patch, if its samples determine the polynomial.
   pure subroutine place_patch(frame, is_determined, mesh, samples, elements, n_near)
      type(frame_t), intent(inout) :: frame !! the coordinates; have their number of terms
      logical, intent(out) :: is_determined
         !! whether there is a sample more than terms and the matrix is well conditioned; always for a constant
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(samples_t), intent(in) :: samples !! the samples of all elements
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: normal(max_terms, max_terms), right(4, max_terms), unused(4, max_terms)
      type(moments_t) :: moments

      is_determined = frame%n_terms == 1
      if (is_determined) then
         frame%center = samples%position(:, samples%start(elements(1)))
         frame%scale = 0.0_dp
         return
      end if
      if (sum(samples%start(elements + 1) - samples%start(elements)) <= frame%n_terms) return
      call spread_corners(frame, mesh, elements)
      if (is_linear(frame)) then
         call sum_moments(moments, samples, elements, n_near)
         is_determined = are_spread(moments, frame%scale)
         if (is_determined) call spread_points(frame, moments)
      else
         call sum_products(normal, frame, samples, elements, n_near)
         right = 0.0_dp
         call solve_normal(unused, frame%n_terms, normal, right, is_determined)
      end if
   end subroutine place_patch

   !> Sums the moments of the samples of a patch.
   pure subroutine sum_moments(moments, samples, elements, n_near)
      type(moments_t), intent(out) :: moments !! the moments
      type(samples_t), intent(in) :: samples !! the samples of all elements
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      integer :: i, k

      moments%origin = samples%position(:, samples%start(elements(1)))
      do i = 1, size(elements)
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            call moments%add(samples%position(1, k), samples%position(2, k), merge(1.0_dp, far_weight, i <= n_near))
         end do
      end do
   end subroutine sum_moments

   !> Sets the coordinates of a patch from the corners of its elements.
   pure subroutine spread_corners(frame, mesh, elements)
      type(frame_t), intent(inout) :: frame !! the coordinates; have their number of terms
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: elements(:) !! its elements
      type(moments_t) :: moments
      integer :: first, i, k

      moments%origin = mesh%coordinates(:, mesh%node(mesh%node_start(elements(1))))
      do i = 1, size(elements)
         first = mesh%node_start(elements(i))
         do k = first, first + n_corners(mesh%element_kind(elements(i))) - 1
            call moments%add(mesh%coordinates(1, mesh%node(k)), mesh%coordinates(2, mesh%node(k)), 1.0_dp)
         end do
      end do
      call spread_points(frame, moments)
      if (frame%n_terms == max_terms) call turn_frame(frame%scale, mesh, elements)
   end subroutine spread_corners

   !> Adds a point.
   pure subroutine moments_add(self, x, y, weight)
      class(moments_t), intent(inout) :: self !! the moments of other points
      real(dp), intent(in) :: x !! coordinate of the point [L]
      real(dp), intent(in) :: y !! its other coordinate [L]
      real(dp), intent(in) :: weight !! its weight [-]

      associate (dx => x - self%origin(1), dy => y - self%origin(2))
         self%weight = self%weight + weight
         self%first = self%first + weight*[dx, dy]
         self%second = self%second + weight*[dx*dx, dx*dy, dy*dy]
      end associate
   end subroutine moments_add

   !> The covariance of the points: xx, xy, yy [L^2].
   pure function moments_covariance(self) result(covariance)
      class(moments_t), intent(in) :: self !! the moments of the points
      real(dp) :: covariance(3)

      associate (mean => self%first/self%weight)
         covariance = self%second/self%weight - [mean(1)*mean, mean(2)**2]
      end associate
   end function moments_covariance

   !> Whether points spread in all directions, in coordinates in which the corners of their elements do: whether the
   !> pivots of 1, x and y are large enough.
   pure logical function are_spread(moments, scale)
      type(moments_t), intent(in) :: moments !! the moments of the points
      real(dp), intent(in) :: scale(2, 2) !! what distances are multiplied by, a lower triangle [1/L]
      real(dp) :: c(3), xx, xy, yy

      c = moments%covariance()
      xx = scale(1, 1)**2*c(1)
      xy = scale(1, 1)*(scale(2, 1)*c(1) + scale(2, 2)*c(2))
      yy = scale(2, 1)**2*c(1) + 2.0_dp*scale(2, 1)*scale(2, 2)*c(2) + scale(2, 2)**2*c(3)
      are_spread = xx > least_pivot
      if (are_spread) are_spread = yy - xy**2/xx > least_pivot
   end function are_spread

   !> Sets coordinates in which some points spread alike in all directions.
   pure subroutine spread_points(frame, moments)
      type(frame_t), intent(inout) :: frame !! the coordinates
      type(moments_t), intent(in) :: moments !! the moments of the points, which are not in a line
      real(dp) :: c(3), slope

      c = moments%covariance()
      frame%center = moments%origin + moments%first/moments%weight
      ! The inverse of the Cholesky factor of the covariance.
      frame%scale(1, 1) = 1.0_dp/sqrt(c(1))
      slope = c(2)*frame%scale(1, 1)
      frame%scale(2, 2) = 1.0_dp/sqrt(c(3) - slope**2)
      frame%scale(2, 1) = -slope*frame%scale(1, 1)*frame%scale(2, 2)
      frame%scale(1, 2) = 0.0_dp
   end subroutine spread_points

   !> Turns the coordinates of a patch until the sides of its quadrilaterals lie along the axes: in the mean of their
   !> fourth powers as complex numbers, which are alike for sides along either axis, in either sense.
   pure subroutine turn_frame(scale, mesh, elements)
      real(dp), intent(inout) :: scale(2, 2) !! what distances are multiplied by [1/L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: elements(:) !! the elements of the patch
      complex(dp) :: direction
      real(dp) :: side(2), angle
      integer :: i, k, n

      direction = 0.0_dp
      do i = 1, size(elements)
         n = n_corners(mesh%element_kind(elements(i)))
         if (n < 4) cycle
         associate (corner => mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i)) + n - 1))
            do k = 1, n
               side = matmul(scale, mesh%coordinates(:, corner(1 + mod(k, n))) - mesh%coordinates(:, corner(k)))
               direction = direction + cmplx(side(1), side(2), dp)**4
            end do
         end associate
      end do
      angle = 0.25_dp*atan2(direction%im, direction%re)
      scale = matmul(reshape([cos(angle), -sin(angle), sin(angle), cos(angle)], [2, 2]), scale)
   end subroutine turn_frame

   !> Sums the products of the terms of a patch over its samples.
   pure subroutine sum_products(normal, frame, samples, elements, n_near)
      real(dp), intent(out) :: normal(max_terms, max_terms) !! the lower triangle of their matrix
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      type(samples_t), intent(in) :: samples !! the samples of all elements
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: p(max_terms), weight
      integer :: i, j, k

      associate (n => frame%n_terms)
         normal(:n, :n) = 0.0_dp
         do i = 1, size(elements)
            weight = merge(1.0_dp, far_weight, i <= n_near)
            do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
               call find_terms(frame, n, samples%position(:, k), p)
               do j = 1, n
                  normal(j:n, j) = normal(j:n, j) + (weight*p(j))*p(j:n)
               end do
            end do
         end do
      end associate
   end subroutine sum_products

   !> The terms of a patch's polynomial at a point; nothing behind the last.
   pure subroutine find_terms(frame, n, position, p)
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      integer, intent(in) :: n !! number of terms
      real(dp), intent(in) :: position(2) !! the point [L]
      real(dp), intent(inout) :: p(max_terms) !! the terms, the first always 1
      real(dp) :: x, y, distance(2)

      distance = position - frame%center
      x = frame%scale(1, 1)*distance(1) + frame%scale(1, 2)*distance(2)
      y = frame%scale(2, 1)*distance(1) + frame%scale(2, 2)*distance(2)
      p(1) = 1.0_dp
      p(2) = x
      p(3) = y
      if (n > 3) p(4:) = [x*x, x*y, y*y, x*x*y, x*y*y, x*x*y*y]
   end subroutine find_terms

   !> Solves the normal equations of a patch, unless their matrix is badly conditioned. They are few: BLAS would take
   !> longer to be called than this takes.
   pure subroutine solve_normal(x, n, normal, right, is_determined)
      real(dp), intent(inout) :: x(4, max_terms) !! the solution (component, term) [F/L^2]
      integer, intent(in) :: n !! number of equations
      real(dp), intent(in) :: normal(max_terms, max_terms) !! the lower triangle of the matrix
      real(dp), intent(in) :: right(4, max_terms) !! the right-hand sides (component, term) [F/L^2]
      logical, intent(out) :: is_determined !! whether the matrix is well conditioned
      ! The factors of L D L^T: below the diagonal L D, behind it the reciprocals of D.
      real(dp) :: factor(max_terms, max_terms), reciprocal(max_terms), entry
      integer :: i, j, k

      do j = 1, n
         do i = j, n
            factor(i, j) = normal(i, j)
         end do
         x(:, j) = right(:, j)
         do k = 1, j - 1
            entry = factor(j, k)*reciprocal(k)
            do i = j, n
               factor(i, j) = factor(i, j) - entry*factor(i, k)
            end do
            x(:, j) = x(:, j) - entry*x(:, k)
         end do
         is_determined = factor(j, j) > least_pivot*normal(1, 1)
         if (.not. is_determined) return
         reciprocal(j) = 1.0_dp/factor(j, j)
      end do
      do j = n, 1, -1
         do k = j + 1, n
            x(:, j) = x(:, j) - factor(k, j)*x(:, k)
         end do
         x(:, j) = reciprocal(j)*x(:, j)
      end do
   end subroutine solve_normal

end module amontons_patch_frame
