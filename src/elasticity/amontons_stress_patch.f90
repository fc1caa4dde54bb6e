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

   public :: fit_polynomial, n_kind_terms, patch_t, samples_t, spread_patch

   !> Terms of the largest polynomial: 1, x, y, x^2, x y, y^2, x^2 y, x y^2, x^2 y^2.
   integer, parameter :: max_terms = 9
   !> Terms of the polynomial of each kind of element: linear; quadratic, of quadrilaterals in x and in y.
   integer, parameter :: n_kind_terms(*) = [3, 3, 6, 9, 9]

   !> Weight of a sample of the elements that a patch grew by: far samples determine what near ones leave open, no more.
   real(dp), parameter :: far_weight = 0.1_dp

   !> The polynomial of a patch, in coordinates in which its nodes spread alike in all directions, and along which the
   !> sides of its elements lie where the terms depend on that: neither slender nor turned elements need another
   !> treatment than others.
   type :: patch_t
      real(dp) :: center(2) = 0.0_dp !! mean of the nodes [L]
      real(dp) :: frame(2, 2) = 0.0_dp !! what the distance from there is multiplied by [1/L]
      integer :: n_terms = 1 !! terms of the polynomial
      real(dp) :: coefficient(4, max_terms) = 0.0_dp !! of the stresses xx, yy, xy, zz (component, term) [F/L^2]
   contains
      procedure :: add_stress => patch_add_stress
   end type patch_t

   !> Stresses at the points of the elements where they are most accurate.
   type :: samples_t
      integer, allocatable :: start(:) !! where the samples of an element begin (n_elements + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (2, n_samples) [L]
      real(dp), allocatable :: stress(:, :) !! stress xx, yy, xy, zz (4, n_samples) [F/L^2]
   end type samples_t

contains

   !> Sets the coordinates of a patch from the corners of its elements.
   pure subroutine spread_patch(patch, mesh, elements)
      type(patch_t), intent(inout) :: patch !! the patch
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
            distance = mesh%coordinates(:, mesh%node(k)) - origin
            mean = mean + distance
            covariance(:2) = covariance(:2) + distance(1)*distance
            covariance(3) = covariance(3) + distance(2)**2
         end do
      end do
      mean = mean/n
      covariance = covariance/n - [mean(1)*mean, mean(2)**2]
      patch%center = origin + mean
      ! The inverse of the Cholesky factor of the covariance.
      patch%frame(1, 1) = 1.0_dp/sqrt(covariance(1))
      distance(1) = covariance(2)*patch%frame(1, 1)
      patch%frame(2, 2) = 1.0_dp/sqrt(covariance(3) - distance(1)**2)
      patch%frame(2, 1) = -distance(1)*patch%frame(1, 1)*patch%frame(2, 2)
      patch%frame(1, 2) = 0.0_dp
      if (patch%n_terms == max_terms) call turn_frame(patch%frame, mesh, elements)
   end subroutine spread_patch

   !> Turns the coordinates of a patch until the sides of its quadrilaterals lie along the axes: in the mean of their
   !> fourth powers as complex numbers, which are alike for sides along either axis, in either sense.
   pure subroutine turn_frame(frame, mesh, elements)
      real(dp), intent(inout) :: frame(2, 2) !! the coordinates
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
               side = matmul(frame, mesh%coordinates(:, corner(1 + mod(k, n))) - mesh%coordinates(:, corner(k)))
               direction = direction + cmplx(side(1), side(2), dp)**4
            end do
         end associate
      end do
      angle = 0.25_dp*atan2(direction%im, direction%re)
      frame = matmul(reshape([cos(angle), -sin(angle), sin(angle), cos(angle)], [2, 2]), frame)
   end subroutine turn_frame

   !> The terms of a patch's polynomial at a point; nothing behind the last.
   pure subroutine find_terms(patch, position, p)
      type(patch_t), intent(in) :: patch !! the patch
      real(dp), intent(in) :: position(2) !! the point [L]
      real(dp), intent(inout) :: p(max_terms) !! the terms, the first always 1
      real(dp) :: x, y, distance(2)

      distance = position - patch%center
      x = patch%frame(1, 1)*distance(1) + patch%frame(1, 2)*distance(2)
      y = patch%frame(2, 1)*distance(1) + patch%frame(2, 2)*distance(2)
      p(1) = 1.0_dp
      p(2) = x
      p(3) = y
      if (patch%n_terms > 3) p(4:) = [x*x, x*y, y*y, x*x*y, x*y*y, x*x*y*y]
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

      call sum_samples(normal, right, n_samples, patch, samples, elements, n_near)
      associate (n => patch%n_terms)
         is_determined = n == 1 .or. n_samples > n
         if (is_determined) call solve_normal(patch, normal, right, is_determined)
         if (.not. is_determined .or. size(tractions) == 0) return
         call fit_tractions(patch, normal(:n, :n), transpose(right(:3, :n)), tractions, node)
      end associate
   end subroutine fit_polynomial

   !> Sums the normal equations of the samples of a patch.
   pure subroutine sum_samples(normal, right, n_samples, patch, samples, elements, n_near)
      real(dp), intent(out) :: normal(max_terms, max_terms) !! the lower triangle of their matrix
      real(dp), intent(out) :: right(4, max_terms) !! their right-hand sides (component, term) [F/L^2]
      integer, intent(out) :: n_samples !! number of samples
      type(patch_t), intent(in) :: patch !! the patch
      type(samples_t), intent(in) :: samples !! the stresses
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: p(max_terms), weight
      integer :: i, j, k, n

      n = patch%n_terms
      normal(:n, :n) = 0.0_dp
      right(:, :n) = 0.0_dp
      n_samples = 0
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            n_samples = n_samples + 1
            call find_terms(patch, samples%position(:, k), p)
            do j = 1, n
               normal(j:n, j) = normal(j:n, j) + (weight*p(j))*p(j:n)
               right(:, j) = right(:, j) + (weight*p(j))*samples%stress(:, k)
            end do
         end do
      end do
   end subroutine sum_samples

   !> Solves the normal equations of a patch, unless their matrix is badly conditioned. They are few: BLAS would take
   !> longer to be called than this takes.
   pure subroutine solve_normal(patch, normal, right, is_determined)
      type(patch_t), intent(inout) :: patch !! the patch; gains its coefficients
      real(dp), intent(in) :: normal(max_terms, max_terms) !! the lower triangle of the matrix
      real(dp), intent(in) :: right(4, max_terms) !! the right-hand sides (component, term) [F/L^2]
      logical, intent(out) :: is_determined !! whether the matrix is well conditioned
      ! The samples of a regular patch leave pivots of a few hundredths of their number, a row too few of them leaves 0.
      real(dp), parameter :: least_pivot = 1.0e-4_dp
      real(dp) :: factor(max_terms, max_terms)
      integer :: j, k, n

      n = patch%n_terms
      associate (x => patch%coefficient)
         do j = 1, n
            factor(j:n, j) = normal(j:n, j)
            x(:, j) = right(:, j)
            do k = 1, j - 1
               factor(j:n, j) = factor(j:n, j) - factor(j, k)*factor(j:n, k)
               x(:, j) = x(:, j) - factor(j, k)*x(:, k)
            end do
            is_determined = factor(j, j) > least_pivot*normal(1, 1)
            if (.not. is_determined) return
            factor(j:n, j) = factor(j:n, j)/sqrt(factor(j, j))
            x(:, j) = x(:, j)/factor(j, j)
         end do
         do j = n, 1, -1
            do k = j + 1, n
               x(:, j) = x(:, j) - factor(k, j)*x(:, k)
            end do
            x(:, j) = x(:, j)/factor(j, j)
         end do
      end associate
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
      real(dp) :: matrix(3*patch%n_terms, 3*patch%n_terms), joint(3*patch%n_terms, 1)
      integer :: i, n, info

      n = patch%n_terms
      matrix = 0.0_dp
      do i = 1, 3
         matrix((i - 1)*n + 1:i*n, (i - 1)*n + 1:i*n) = of_tensor(i)*normal
         joint((i - 1)*n + 1:i*n, 1) = of_tensor(i)*right(:, i)
      end do
      call add_tractions(matrix, joint(:, 1), patch, normal(1, 1), tractions, node)
      call cholesky_factor(matrix, info)
      call cholesky_solve(matrix, joint)
      patch%coefficient(:3, :n) = transpose(reshape(joint, [n, 3]))
   end subroutine fit_tractions

   !> Adds the equations of known tractions to the normal equations of a patch: at the middle of each side, and at the
   !> node, where two sides that go on smoothly have the mean of their normals.
   pure subroutine add_tractions(matrix, right, patch, n_samples, tractions, node)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(patch_t), intent(in) :: patch !! the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions
      integer, intent(in) :: node !! the node
      type(known_traction_t) :: smooth
      integer :: i, place(2)

      do i = 1, size(tractions)
         call add_traction(matrix, right, patch, n_samples, tractions(i), 2)
      end do
      place = 0
      do i = 1, min(2, size(tractions))
         place(i) = merge(1, 3, tractions(i)%corner(1) == node)
      end do
      if (size(tractions) == 2) then
         if (tractions(1)%goes_on(tractions(2), place)) then
            smooth = tractions(1)%mean(tractions(2), place)
            call add_traction(matrix, right, patch, n_samples, smooth, 2)
            return
         end if
      end if
      do i = 1, min(2, size(tractions))
         call add_traction(matrix, right, patch, n_samples, tractions(i), place(i))
      end do
   end subroutine add_tractions

   !> Adds the known tractions at a place of a side to the normal equations.
   pure subroutine add_traction(matrix, right, patch, n_samples, side, place)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(patch_t), intent(in) :: patch !! the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: side !! the side
      integer, intent(in) :: place !! 1, 2 or 3: first corner, middle, second corner
      ! Each equation weighs as much as ten times all samples: it holds to a few percent of what they say against it.
      real(dp), parameter :: weight = 10.0_dp
      real(dp) :: row(size(right)), direction(2), p(max_terms)
      integer :: i, n

      n = patch%n_terms
      call find_terms(patch, side%position(:, place), p)
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

   !> Adds a multiple of the stress of a patch's polynomial at a point.
   pure subroutine patch_add_stress(self, position, weight, stress)
      class(patch_t), intent(in) :: self !! the patch
      real(dp), intent(in) :: position(2) !! the point [L]
      real(dp), intent(in) :: weight !! what the stress is multiplied by [-]
      real(dp), intent(inout) :: stress(4) !! xx, yy, xy, zz; gains the multiple [F/L^2]
      real(dp) :: p(max_terms)
      integer :: i

      call find_terms(self, position, p)
      do i = 1, self%n_terms
         stress = stress + (weight*p(i))*self%coefficient(:, i)
      end do
   end subroutine patch_add_stress

end module amontons_stress_patch
