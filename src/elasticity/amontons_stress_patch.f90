!> The polynomial of a patch of elements that fits their stresses where these are most accurate, and the tractions known
!> at their sides on the boundary.
module amontons_stress_patch
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_element, only: n_corners
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_traction_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: add_stresses, fit_polynomial, frame_t, max_terms, n_kind_terms, patch_t, samples_t, spread_patch

   !> Terms of the largest polynomial: 1, x, y, x^2, x y, y^2, x^2 y, x y^2, x^2 y^2.
   integer, parameter :: max_terms = 9
   !> Terms of the polynomial of each kind of element: linear; quadratic, of quadrilaterals in x and in y.
   integer, parameter :: n_kind_terms(*) = [3, 3, 6, 9, 9]

   !> Moments of points up to the second order: 1, x, y, x^2, x y, y^2.
   integer, parameter :: n_moments = 6

   !> Weight of a sample of the elements that a patch grew by: far samples determine what near ones leave open, no more.
   real(dp), parameter :: far_weight = 0.1_dp

   !> Coordinates of a patch in which its nodes spread alike in all directions, and along which the sides of its
   !> elements lie where the terms depend on that: neither slender nor turned elements need another treatment.
   type :: frame_t
      real(dp) :: center(2) = 0.0_dp !! mean of the nodes [L]
      real(dp) :: scale(2, 2) = 0.0_dp !! what the distance from there is multiplied by [1/L]
      integer :: n_terms = 1 !! terms of the polynomial
   end type frame_t

   !> The polynomial of a patch.
   type :: patch_t
      type(frame_t) :: frame !! its coordinates
      real(dp) :: coefficient(4, max_terms) = 0.0_dp !! of the stresses xx, yy, xy, zz (component, term) [F/L^2]
   end type patch_t

   !> Stresses at the points of the elements where they are most accurate.
   type :: samples_t
      integer, allocatable :: start(:) !! where the samples of an element begin (n_elements + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (2, n_samples) [L]
      real(dp), allocatable :: stress(:, :) !! stress xx, yy, xy, zz (4, n_samples) [F/L^2]
   end type samples_t

contains

   !> Sets the coordinates of a patch from the corners of its elements.
   pure subroutine spread_patch(frame, mesh, elements)
      type(frame_t), intent(inout) :: frame !! the coordinates; have their number of terms
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: elements(:) !! its elements
      real(dp) :: covariance(3), distance(2), origin(2), mean(2)
      integer :: i, k, n

      origin = mesh%coordinates(:, mesh%node(mesh%node_start(elements(1))))
      mean = 0.0_dp
      covariance = 0.0_dp
      n = 0
      do i = 1, size(elements)
         do k = mesh%node_start(elements(i)), &
            mesh%node_start(elements(i)) + n_corners(mesh%element_kind(elements(i))) - 1
            n = n + 1
            distance(1) = mesh%coordinates(1, mesh%node(k)) - origin(1)
            distance(2) = mesh%coordinates(2, mesh%node(k)) - origin(2)
            mean = mean + distance
            covariance(1) = covariance(1) + distance(1)**2
            covariance(2) = covariance(2) + distance(1)*distance(2)
            covariance(3) = covariance(3) + distance(2)**2
         end do
      end do
      mean = mean/n
      covariance = covariance/n - [mean(1)*mean, mean(2)**2]
      frame%center = origin + mean
      ! The inverse of the Cholesky factor of the covariance.
      frame%scale(1, 1) = 1.0_dp/sqrt(covariance(1))
      distance(1) = covariance(2)*frame%scale(1, 1)
      frame%scale(2, 2) = 1.0_dp/sqrt(covariance(3) - distance(1)**2)
      frame%scale(2, 1) = -distance(1)*frame%scale(1, 1)*frame%scale(2, 2)
      frame%scale(1, 2) = 0.0_dp
      if (frame%n_terms == max_terms) call turn_frame(frame%scale, mesh, elements)
   end subroutine spread_patch

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

   !> Fits the polynomial of a patch, unless the samples do not determine it.
   pure subroutine fit_polynomial(patch, samples, elements, n_near, tractions, node, is_determined)
      type(patch_t), intent(inout) :: patch !! the patch; gains its coefficients
      type(samples_t), intent(in) :: samples !! the stresses
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      integer, intent(in) :: node !! the node
      logical, intent(out) :: is_determined
         !! whether there is a sample more than terms and the matrix is well conditioned; always for a constant
      real(dp) :: normal(max_terms, max_terms), right(4, max_terms)
      integer :: n_samples

      associate (n => patch%frame%n_terms)
         if (n == 3) then
            call sum_linear_samples(normal, right, n_samples, patch%frame, samples, elements, n_near)
         else
            call sum_samples(normal, right, n_samples, patch%frame, n, samples, elements, n_near)
         end if
         is_determined = n == 1 .or. n_samples > n
         if (is_determined) call solve_normal(patch%coefficient, n, normal, right, is_determined)
         if (.not. is_determined .or. size(tractions) == 0) return
         call fit_tractions(patch, normal(:n, :n), transpose(right(:3, :n)), tractions, node)
      end associate
   end subroutine fit_polynomial

   !> Sums the normal equations of the samples of a patch.
   pure subroutine sum_samples(normal, right, n_samples, frame, n, samples, elements, n_near)
      real(dp), intent(out) :: normal(max_terms, max_terms) !! the lower triangle of their matrix
      real(dp), intent(out) :: right(4, max_terms) !! their right-hand sides (component, term) [F/L^2]
      integer, intent(out) :: n_samples !! number of samples
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      integer, intent(in) :: n !! terms of the polynomial
      type(samples_t), intent(in) :: samples !! the stresses
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: p(max_terms), weight
      integer :: i, j, k

      normal(:n, :n) = 0.0_dp
      right(:, :n) = 0.0_dp
      n_samples = 0
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            n_samples = n_samples + 1
            call find_terms(frame, n, samples%position(:, k), p)
            do j = 1, n
               normal(j:n, j) = normal(j:n, j) + (weight*p(j))*p(j:n)
               right(:, j) = right(:, j) + (weight*p(j))*samples%stress(:, k)
            end do
         end do
      end do
   end subroutine sum_samples

   !> Does the same for linear polynomials, which almost all patches of linear triangles have: written out, it takes a
   !> fifth of the time.
   pure subroutine sum_linear_samples(normal, right, n_samples, frame, samples, elements, n_near)
      real(dp), intent(out) :: normal(max_terms, max_terms) !! as in `sum_samples`
      real(dp), intent(out) :: right(4, max_terms) !! as in `sum_samples` [F/L^2]
      integer, intent(out) :: n_samples !! number of samples
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      type(samples_t), intent(in) :: samples !! the stresses
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: p(max_terms), weight, wx, wy, sums(n_moments)
      integer :: i, k

      sums = 0.0_dp
      right(:, :3) = 0.0_dp
      n_samples = 0
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            n_samples = n_samples + 1
            call find_terms(frame, 3, samples%position(:, k), p)
            wx = weight*p(2)
            wy = weight*p(3)
            sums(1) = sums(1) + weight
            sums(2) = sums(2) + wx
            sums(3) = sums(3) + wy
            sums(4) = sums(4) + wx*p(2)
            sums(5) = sums(5) + wx*p(3)
            sums(6) = sums(6) + wy*p(3)
            right(:, 1) = right(:, 1) + weight*samples%stress(:, k)
            right(:, 2) = right(:, 2) + wx*samples%stress(:, k)
            right(:, 3) = right(:, 3) + wy*samples%stress(:, k)
         end do
      end do
      normal(:3, 1) = sums(:3)
      normal(2:3, 2) = sums(4:5)
      normal(3, 3) = sums(6)
   end subroutine sum_linear_samples

   !> Solves the normal equations of a patch, unless their matrix is badly conditioned. They are few: BLAS would take
   !> longer to be called than this takes.
   pure subroutine solve_normal(x, n, normal, right, is_determined)
      real(dp), intent(inout) :: x(4, max_terms) !! the solution (component, term) [F/L^2]
      integer, intent(in) :: n !! number of equations
      real(dp), intent(in) :: normal(max_terms, max_terms) !! the lower triangle of the matrix
      real(dp), intent(in) :: right(4, max_terms) !! the right-hand sides (component, term) [F/L^2]
      logical, intent(out) :: is_determined !! whether the matrix is well conditioned
      ! The samples of a regular patch leave pivots of a few hundredths of their number, a row too few of them leaves 0.
      real(dp), parameter :: least_pivot = 1.0e-4_dp
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

   !> Fits the stresses xx, yy and xy to the samples and, with a large weight, to known tractions. What the fit leaves
   !> is measured by the norm of the tensor, in which xy counts twice, so that the axes do not matter.
   pure subroutine fit_tractions(patch, normal, right, tractions, node)
      type(patch_t), intent(inout) :: patch !! the patch; gains their coefficients
      real(dp), intent(in) :: normal(:, :) !! the lower triangle of the normal matrix of the samples
      real(dp), intent(in) :: right(:, :) !! its right-hand sides (term, component)
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      integer, intent(in) :: node !! the node
      real(dp), parameter :: of_tensor(3) = [1.0_dp, 1.0_dp, 2.0_dp]
      real(dp) :: matrix(3*patch%frame%n_terms, 3*patch%frame%n_terms), joint(3*patch%frame%n_terms, 1)
      integer :: i, n, info

      n = patch%frame%n_terms
      matrix = 0.0_dp
      do i = 1, 3
         matrix((i - 1)*n + 1:i*n, (i - 1)*n + 1:i*n) = of_tensor(i)*normal
         joint((i - 1)*n + 1:i*n, 1) = of_tensor(i)*right(:, i)
      end do
      call add_tractions(matrix, joint(:, 1), patch%frame, normal(1, 1), tractions, node)
      call cholesky_factor(matrix, info)
      call cholesky_solve(matrix, joint)
      patch%coefficient(:3, :n) = transpose(reshape(joint, [n, 3]))
   end subroutine fit_tractions

   !> Adds the equations of known tractions to the normal equations of a patch: at the middle of each side, and at the
   !> node, where two sides that go on smoothly have the mean of their normals.
   pure subroutine add_tractions(matrix, right, frame, n_samples, tractions, node)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions
      integer, intent(in) :: node !! the node
      type(known_traction_t) :: smooth
      integer :: i, place(2)

      do i = 1, size(tractions)
         call add_traction(matrix, right, frame, n_samples, tractions(i), 2)
      end do
      place = 0
      do i = 1, min(2, size(tractions))
         place(i) = merge(1, 3, tractions(i)%corner(1) == node)
      end do
      if (size(tractions) == 2) then
         if (tractions(1)%goes_on(tractions(2), place)) then
            smooth = tractions(1)%mean(tractions(2), place)
            call add_traction(matrix, right, frame, n_samples, smooth, 2)
            return
         end if
      end if
      do i = 1, min(2, size(tractions))
         call add_traction(matrix, right, frame, n_samples, tractions(i), place(i))
      end do
   end subroutine add_tractions

   !> Adds the known tractions at a place of a side to the normal equations.
   pure subroutine add_traction(matrix, right, frame, n_samples, side, place)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: side !! the side
      integer, intent(in) :: place !! 1, 2 or 3: first corner, middle, second corner
      ! Each equation weighs as much as ten times all samples: it holds to a few percent of what they say against it.
      real(dp), parameter :: weight = 10.0_dp
      real(dp) :: row(size(right)), direction(2), p(max_terms)
      integer :: i, n

      n = frame%n_terms
      call find_terms(frame, n, side%position(:, place), p)
      associate (normal => side%normal(:, place))
         do i = 1, 2
            if (.not. side%is_known(i)) cycle
            direction = normal
            if (i == 2) direction = [-normal(2), normal(1)]
            row(:n) = direction(1)*normal(1)*p(:n)
            row(n + 1:2*n) = direction(2)*normal(2)*p(:n)
            row(2*n + 1:) = (direction(1)*normal(2) + direction(2)*normal(1))*p(:n)
            matrix = matrix + weight*n_samples*spread(row, 2, 3*n)*spread(row, 1, 3*n)
            right = right + weight*n_samples*row*dot_product(direction, side%traction(:, place))
         end do
      end associate
   end subroutine add_traction

   !> Adds multiples of the stresses of a patch's polynomial at points.
   pure subroutine add_stresses(frame, coefficient, n_points, position, weight, stress)
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: coefficient(4, frame%n_terms) !! coefficients of its polynomial (component, term) [F/L^2]
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(in) :: position(2, n_points) !! the points [L]
      real(dp), intent(in) :: weight(n_points) !! what the stress at each is multiplied by [-]
      real(dp), intent(inout) :: stress(4, n_points) !! xx, yy, xy, zz; gains the multiples [F/L^2]
      real(dp) :: p(max_terms), sum(4)
      integer :: i, point

      do point = 1, n_points
         call find_terms(frame, frame%n_terms, position(:, point), p)
         sum = coefficient(:, 1)
         if (frame%n_terms > 1) sum = sum + p(2)*coefficient(:, 2) + p(3)*coefficient(:, 3)
         do i = 4, frame%n_terms
            sum = sum + p(i)*coefficient(:, i)
         end do
         stress(:, point) = stress(:, point) + weight(point)*sum
      end do
   end subroutine add_stresses

end module amontons_stress_patch
